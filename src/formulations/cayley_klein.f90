!> The symmetric top as two oscillators without coupling, for the Cayley-Klein parameters without the spin.
!>
!> With alpha = (q0 + i q3) exp(-i sigma t/2) and beta = (q1 + i q2) exp(i sigma t/2), where
!> sigma = omega3 (I1 - I3)/I1, b = 2 m g l/I1, a = I3 omega3/I1, E = theta'^2 + sin^2(theta) phi'^2 +
!> b cos(theta) and A+- = (E +- b + a^2)/4:
!>     alpha'' = (b |alpha|^2 - b/2 - A+) alpha,  beta'' = (b/2 - b |beta|^2 - A-) beta.
!> No attitude is singular. |alpha|^2 + |beta|^2 = 1 holds for the exact solution only.
!>
!> Drift and kick are those of equations y'' = g(y): the drift moves y with its rate, the kick changes the
!> rate by g at constant y. Splitting methods are then symplectic Runge-Kutta-Nystrom methods.
module spintop_cayley_klein
    use spintop_kinds, only: dp, xp
    use spintop_attitude, only: conjugate_quaternion, quaternion_product, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_capabilities, only: flows_t, max_series_order, max_states, series_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_status, only: status_ok
    implicit none
    private
    public :: cayley_klein_t

    !> The stiffnesses of the two oscillators: b, A+ + b/2 and b/2 - A-.
    type :: oscillators_t
        real(dp) :: b = 0, upper = 0, lower = 0
    contains
        procedure :: set
        procedure :: acceleration
    end type oscillators_t

    !> State y = (Re alpha, Re beta, Im beta, Im alpha) and their rates, in the order of a quaternion.
    type, extends(formulation_t) :: cayley_klein_t
        private
        type(oscillators_t) :: pair = oscillators_t()
        !> sigma in extended precision, for its phase.
        real(xp) :: spin_rate = 0
    contains
        procedure, nopass :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: find_turning
        procedure :: invariants
    end type cayley_klein_t

    interface cayley_klein_t
        module procedure new_cayley_klein
    end interface cayley_klein_t

    !> Drift and kick.
    type, extends(flows_t) :: oscillator_flows_t
        private
        type(oscillators_t) :: pair = oscillators_t()
    contains
        procedure :: set => set_flows
        procedure :: drift
        procedure :: kick
        procedure :: compose
    end type oscillator_flows_t

    !> The Taylor series of the motion.
    type, extends(series_t) :: oscillator_series_t
        private
        type(oscillators_t) :: pair = oscillators_t()
    contains
        procedure :: set => set_series
        procedure :: expand
    end type oscillator_series_t

contains

    !> The formulation with all that it offers.
    function new_cayley_klein() result(new)
        type(cayley_klein_t) :: new
        allocate (oscillator_flows_t :: new%flows)
        allocate (oscillator_series_t :: new%series)
    end function new_cayley_klein

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('cayley_klein', &
            'two oscillators for the Cayley-Klein parameters, for symmetric tops; long spans need a projection', &
            8, singular_at_poles=.false., invariants=5, quaternion=1)
    end function describe

    !> The stiffnesses of a motion.
    pure subroutine set(self, body, start)
        class(oscillators_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp) :: a, energy, gamma(3)
        a = body%inertia(3) * start%omega(3) / body%inertia(1)
        self%b = 2 * body%mgl() / body%inertia(1)
        gamma = vertical_from_quaternion(start%quaternion)
        energy = sum(start%omega(1:2)**2) + self%b * gamma(3)
        self%upper = (energy + self%b + a**2) / 4 + self%b / 2
        self%lower = self%b / 2 - (energy - self%b + a**2) / 4
    end subroutine set

    !> Change of the rates of the amplitudes over a time h at constant amplitudes.
    pure function acceleration(self, amplitude, h) result(change)
        class(oscillators_t), intent(in) :: self
        real(dp), intent(in) :: amplitude(4), h
        real(dp) :: change(4), stiffness(2)
        stiffness(1) = self%b * (amplitude(1)**2 + amplitude(4)**2) - self%upper
        stiffness(2) = self%lower - self%b * (amplitude(2)**2 + amplitude(3)**2)
        change = stiffness([1, 2, 2, 1]) * (h * amplitude)
    end function acceleration

    !> Constants of the motion and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(cayley_klein_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        real(dp) :: a
        self%body = body
        call self%pair%set(body, start)
        call self%set_capabilities(body, start)
        a = body%inertia(3) * start%omega(3) / body%inertia(1)
        self%spin_rate = (real(body%inertia(1), xp) - body%inertia(3)) * start%omega(3) / body%inertia(1)
        self%sigma = real(self%spin_rate, dp)
        y(1:4) = start%quaternion
        y(5:8) = quaternion_product(start%quaternion, [0.0_dp, start%omega(1:2) / 2, a / 2])
        scales = motion_scales(body, start)
        self%scale(1:4) = 0.5_dp
        self%scale(5:8) = scales%rate / 2
        status = status_ok
    end subroutine prepare

    !> The two oscillators.
    pure subroutine derivative(self, t, y, dy, status)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        dy(1:4) = y(5:8)
        dy(5:8) = self%pair%acceleration(y(1:4), 1.0_dp)
        status = status_ok
    end subroutine derivative

    !> The motion. The oscillators describe a motion of the same axis whose spin differs by sigma t. If p is
    !> its quaternion, its angular velocity is 2 conj(p) p'/|p|^2.
    pure type(motion_t) function motion(self, t, y, near)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states), spin(4), q(4), omega(3), rate(4), acceleration(4)
        real(xp) :: half
        integer :: status

        half = self%spin_rate * t / 2
        spin = [real(cos(half), dp), 0.0_dp, 0.0_dp, real(sin(half), dp)]
        call self%derivative(t, y, dy, status)
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

    !> The angular velocity of the attitude in the state, and its rate.
    pure subroutine find_turning(self, t, y, omega, rate)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in body axes, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        omega = twice_vector(y(1:4), y(5:8))
        if (present(rate)) rate = twice_vector(y(1:4), self%pair%acceleration(y(1:4), 1.0_dp))
    end subroutine find_turning

    !> Squared norm of the quaternion and half its rate, momenta over I1 about the axis and the vertical, and
    !> twice the energy over I1, of the motion without its spin.
    pure subroutine invariants(self, y, values)
        class(cayley_klein_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        real(dp) :: omega(3), gamma(3), length
        length = norm2(y(1:4))
        omega = twice_vector(y(1:4) / length, y(5:8) / length)
        gamma = vertical_from_quaternion(y(1:4) / length)
        values(1) = length**2
        values(2) = dot_product(y(1:4), y(5:8))
        values(3) = omega(3)
        values(4) = dot_product(omega, gamma)
        values(5) = sum(omega(1:2)**2) + self%pair%b * gamma(3)
    end subroutine invariants

    !> Constants of the flows.
    pure subroutine set_flows(self, body, start)
        class(oscillator_flows_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        call self%pair%set(body, start)
    end subroutine set_flows

    !> The amplitudes move with their rates.
    pure subroutine drift(self, y, h, change)
        class(oscillator_flows_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        change(1:4) = change(1:4) + h * (y(5:8) + change(5:8))
    end subroutine drift

    !> The rates change, at constant amplitudes.
    pure subroutine kick(self, y, h, change)
        class(oscillator_flows_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        change(5:8) = change(5:8) + self%pair%acceleration(y(1:4) + change(1:4), h)
    end subroutine kick

    !> Drifts and kicks in turn, without calls, which would cost several times as much. The two oscillators
    !> are computed together, in vectors of two real and of two imaginary parts.
    pure subroutine compose(self, y, h, kicks, drifts, change)
        class(oscillator_flows_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h, kicks(0:), drifts(:)
        real(dp), intent(out) :: change(max_states)
        real(dp), dimension(2) :: strength, offset, re, im, re_rate, im_rate
        real(dp), dimension(2) :: re_moved, im_moved, re_kicked, im_kicked, stiffness
        integer :: i
        re = y(1:2)
        im = y(4:3:-1)
        re_rate = y(5:6)
        im_rate = y(8:7:-1)
        strength = [self%pair%b, -self%pair%b]
        offset = [-self%pair%upper, self%pair%lower]
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

    !> Constants of the series.
    pure subroutine set_series(self, body, start)
        class(oscillator_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        call self%pair%set(body, start)
    end subroutine set_series

    !> Taylor coefficients of the motion by Cauchy products: first the stiffnesses from the squared
    !> amplitudes, then their products with the amplitudes.
    pure subroutine expand(self, t, y, order, coefficient)
        class(oscillator_series_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
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
                stiffness(1, k) = self%pair%b * (square(1) + square(4))
                stiffness(2, k) = -self%pair%b * (square(2) + square(3))
                if (k == 0) stiffness(1:2, k) = stiffness(1:2, k) + [-self%pair%upper, self%pair%lower]
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
    end subroutine expand

end module spintop_cayley_klein
