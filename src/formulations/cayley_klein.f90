!> The symmetric top as two separate oscillators, for the Cayley-Klein parameters without the spin.
!>
!> With alpha = (q0 + i q3) exp(-i sigma t/2) and beta = (q1 + i q2) exp(i sigma t/2), where
!> sigma = omega3 (I1 - I3)/I1, b = 2 m g l/I1, a = I3 omega3/I1, E = theta'^2 + sin^2(theta) phi'^2 +
!> b cos(theta) and A+- = (E +- b + a^2)/4:
!>     alpha'' = (b |alpha|^2 - b/2 - A+) alpha,  beta'' = (b/2 - b |beta|^2 - A-) beta.
!> No attitude is singular. |alpha|^2 + |beta|^2 = 1 holds for the exact solution only.
!>
!> Drift and kick are those of any such pair of equations y'' = g(y): y moves at its rate, the rate
!> changes by g at rest. Splitting methods are then symplectic Runge-Kutta-Nystrom methods.
module spintop_cayley_klein
    use spintop_kinds, only: dp, xp
    use spintop_attitude, only: follow_angles, conjugate_quaternion, quaternion_product, &
        vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants, max_series_order, &
        max_states, structure_series, structure_split
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_status, only: status_ok
    implicit none
    private
    public :: cayley_klein_t

    !> State y = (Re alpha, Re beta, Im beta, Im alpha) and their rates, in the order of a quaternion.
    type, extends(formulation_t) :: cayley_klein_t
        private
        !> sigma, b, A+ + b/2 and b/2 - A-.
        real(dp) :: sigma = 0, b = 0, upper = 0, lower = 0
        !> sigma with the digits that its phase needs.
        real(xp) :: spin_rate = 0
    contains
        procedure, nopass :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: drift
        procedure :: kick
        procedure :: compose
        procedure :: motion
        procedure :: follow
        procedure :: invariants
        procedure :: series
    end type cayley_klein_t

contains

    !> Name and properties.
    pure function info()
        type(formulation_info_t) :: info
        info = formulation_info_t('cayley_klein', &
            'two oscillators for the Cayley-Klein parameters, for symmetric tops; no pole is singular', &
            8, singular_at_poles=.false., invariants=5, quaternion=1)
        info%offers([structure_split, structure_series]) = .true.
    end function info

    !> Constants of the motion and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(cayley_klein_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(out) :: y(max_states)
        integer, intent(out) :: status
        type(motion_scales_t) :: scales
        real(dp) :: a, energy, gamma(3)
        self%body = body
        a = body%inertia(3) * start%omega(3) / body%inertia(1)
        self%spin_rate = (real(body%inertia(1), xp) - body%inertia(3)) * start%omega(3) / body%inertia(1)
        self%sigma = real(self%spin_rate, dp)
        self%b = 2 * body%mgl() / body%inertia(1)
        gamma = vertical_from_quaternion(start%quaternion)
        energy = sum(start%omega(1:2)**2) + self%b * gamma(3)
        self%upper = (energy + self%b + a**2) / 4 + self%b / 2
        self%lower = self%b / 2 - (energy - self%b + a**2) / 4
        y(1:4) = start%quaternion
        y(5:8) = quaternion_product(start%quaternion, [0.0_dp, start%omega(1:2) / 2, a / 2])
        scales = motion_scales(body, start)
        self%scale(1:4) = 0.5_dp
        self%scale(5:8) = scales%rate / 2
        status = status_ok
    end subroutine prepare

    !> The two oscillators.
    pure subroutine derivative(self, y, dy, status)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: dy(max_states)
        integer, intent(out) :: status
        dy(1:4) = y(5:8)
        dy(5:8) = acceleration(self, y(1:4), 1.0_dp)
        status = status_ok
    end subroutine derivative

    !> How the rates of the amplitudes change within a time h at rest.
    pure function acceleration(self, amplitude, h) result(change)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: amplitude(4), h
        real(dp) :: change(4), stiffness(2)
        stiffness(1) = self%b * (amplitude(1)**2 + amplitude(4)**2) - self%upper
        stiffness(2) = self%lower - self%b * (amplitude(2)**2 + amplitude(3)**2)
        change = stiffness([1, 2, 2, 1]) * (h * amplitude)
    end function acceleration

    !> Amplitudes move at their rates.
    pure subroutine drift(self, y, h, change)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        associate (unused => self)
        end associate
        change(1:4) = change(1:4) + h * (y(5:8) + change(5:8))
    end subroutine drift

    !> Rates change.
    pure subroutine kick(self, y, h, change)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        change(5:8) = change(5:8) + acceleration(self, y(1:4) + change(1:4), h)
    end subroutine kick

    !> Drifts and kicks in turn: calls would cost several times what they do. The two oscillators go
    !> side by side, in vectors of two real and of two imaginary parts.
    pure subroutine compose(self, y, h, kicks, drifts, change)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h, kicks(0:), drifts(:)
        real(dp), intent(out) :: change(max_states)
        real(dp), dimension(2) :: strength, offset, re, im, re_rate, im_rate
        real(dp), dimension(2) :: re_moved, im_moved, re_kicked, im_kicked, stiffness
        integer :: i
        re = y(1:2)
        im = y(4:3:-1)
        re_rate = y(5:6)
        im_rate = y(8:7:-1)
        strength = [self%b, -self%b]
        offset = [-self%upper, self%lower]
        re_moved = 0
        im_moved = 0
        stiffness = strength * (re**2 + im**2) + offset
        re_kicked = stiffness * (h * kicks(0) * re)
        im_kicked = stiffness * (h * kicks(0) * im)
        do i = 1, size(drifts)
            re_moved = re_moved + h * drifts(i) * (re_rate + re_kicked)
            im_moved = im_moved + h * drifts(i) * (im_rate + im_kicked)
            stiffness = strength * ((re + re_moved)**2 + (im + im_moved)**2) + offset
            re_kicked = re_kicked + stiffness * (h * kicks(i) * (re + re_moved))
            im_kicked = im_kicked + stiffness * (h * kicks(i) * (im + im_moved))
        end do
        change(1:2) = re_moved
        change(4:3:-1) = im_moved
        change(5:6) = re_kicked
        change(8:7:-1) = im_kicked
    end subroutine compose

    !> The motion. The oscillators are a motion of their own, of the same axis, that lacks the spin
    !> by sigma t: with its quaternion p, 2 conj(p) p'/|p|^2 is its angular velocity.
    pure type(motion_t) function motion(self, t, y, near)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3)
        real(dp) :: dy(max_states), spin(4), q(4), omega(3), rate(4), acceleration(4)
        real(xp) :: half
        integer :: status

        half = self%spin_rate * t / 2
        spin = [real(cos(half), dp), 0.0_dp, 0.0_dp, real(sin(half), dp)]
        call self%derivative(y, dy, status)
        q = quaternion_product(y(1:4) / norm2(y(1:4)), spin)
        rate = quaternion_product(y(5:8) / norm2(y(1:4)), spin) &
               + quaternion_product(q, [0.0_dp, 0.0_dp, 0.0_dp, self%sigma / 2])
        acceleration = quaternion_product(dy(5:8) / norm2(y(1:4)), spin) &
            + quaternion_product(2 * rate, [0.0_dp, 0.0_dp, 0.0_dp, self%sigma / 2]) &
            + (self%sigma / 2)**2 * q
        omega = twice_vector(q, rate)
        motion = motion_from_quaternion(t, q, omega, near)
        motion%norm_error = norm2(y(1:4)) - 1
        motion%omega_rate = twice_vector(q, acceleration)
    end function motion

    !> Vector part of 2 conj(q) r.
    pure function twice_vector(q, r) result(v)
        real(dp), intent(in) :: q(4), r(4)
        real(dp) :: v(3), product(4)
        product = quaternion_product(conjugate_quaternion(q), r)
        v = 2 * product(2:4)
    end function twice_vector

    !> Angles of a later state; the spin split off turns psi by sigma t.
    pure subroutine follow(self, t_last, y_last, t, y, angle, sure)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: t_last, y_last(max_states), t, y(max_states)
        real(dp), intent(inout) :: angle(3)
        logical, intent(out) :: sure
        call follow_angles(y_last(1:4), twice_vector(y_last(1:4), y_last(5:8)), &
                           y(1:4), twice_vector(y(1:4), y(5:8)), t - t_last, angle, sure)
        angle(3) = angle(3) + self%sigma * (t - t_last)
    end subroutine follow

    !> Squared length of the quaternion and half its rate, momenta over I1 about the axis and the
    !> vertical, and twice the energy over I1, of the motion without its spin.
    pure subroutine invariants(self, y, values)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: values(max_invariants)
        real(dp) :: omega(3), gamma(3), length
        length = norm2(y(1:4))
        omega = twice_vector(y(1:4) / length, y(5:8) / length)
        gamma = vertical_from_quaternion(y(1:4) / length)
        values(1) = length**2
        values(2) = dot_product(y(1:4), y(5:8))
        values(3) = omega(3)
        values(4) = dot_product(omega, gamma)
        values(5) = sum(omega(1:2)**2) + self%b * gamma(3)
    end subroutine invariants

    !> Taylor coefficients of the motion, by Cauchy's rule for products: the stiffnesses from the
    !> squares of the amplitudes, then their products with the amplitudes.
    pure subroutine series(self, y, order, coefficient)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order)
        real(dp) :: stiffness(4, 0:max_series_order), square(4), pull(4), share
        integer :: k, j, i

        coefficient(:, 0) = y
        associate (c => coefficient)
            do k = 0, order - 1
                square = 0
                do j = 0, k
                    !$omp simd
                    do i = 1, 4
                        square(i) = square(i) + c(i, j) * c(i, k - j)
                    end do
                end do
                stiffness(1, k) = self%b * (square(1) + square(4))
                stiffness(2, k) = -self%b * (square(2) + square(3))
                if (k == 0) stiffness(1:2, k) = stiffness(1:2, k) + [-self%upper, self%lower]
                stiffness(3, k) = stiffness(2, k)
                stiffness(4, k) = stiffness(1, k)
                pull = 0
                do j = 0, k
                    !$omp simd
                    do i = 1, 4
                        pull(i) = pull(i) + stiffness(i, j) * c(i, k - j)
                    end do
                end do
                share = 1.0_dp / (k + 1)
                c(1:4, k + 1) = share * c(5:8, k)
                c(5:8, k + 1) = share * pull
            end do
        end associate
    end subroutine series

end module spintop_cayley_klein
