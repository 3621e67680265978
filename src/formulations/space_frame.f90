!> The symmetric top in space axes: angular momentum and the attitude without the spin.
!>
!> The momentum about the vertical is constant, and the spin about the axis, relative to axes that
!> turn with the angular velocity L/I1, is linear in time. It is split off: q = p exp(k sigma t/2).
!> What is left is bilinear, has no trigonometric functions and no singular attitude. With the axis
!> e, a quadratic form of p, L' = m g l (-e2, e1, 0) and e' = L x e/I1.
module spintop_space_frame
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp, epsilon_dp, qp, xp
    use spintop_attitude, only: follow_angles, may_meet_pole, conjugate_quaternion, quaternion_product, to_space
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_series_order, max_states, quadruple_series_t, series_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motions, only: instants
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_small_turn, only: half_turn
    use spintop_space_frame_flows, only: space_frame_flows_t, space_turns_t
    use spintop_status, only: status_ok
    use spintop_vectors, only: cross
    implicit none
    private
    public :: space_frame_t

    !> State y = (L1, L2, p0, p1, p2, p3).
    type, extends(formulation_t) :: space_frame_t
        private
        !> Momentum about the vertical, spin rate about the axis, and sigma, the separated part of the spin.
        real(dp) :: vertical = 0, omega3 = 0, sigma = 0
        !> sigma in extended precision, for its phase.
        real(xp) :: spin_rate = 0
        real(dp) :: mgl = 0, i1 = 1
    contains
        procedure, nopass :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: motion_without_angles
        procedure :: follow
        procedure :: invariants
    end type space_frame_t

    interface space_frame_t
        module procedure new_space_frame
    end interface space_frame_t

    !> The Taylor series of the motion.
    type, extends(series_t) :: space_frame_series_t
        private
        !> Momentum about the vertical, and the rate at which the axes turn about it, m g l/I1 and I1.
        real(dp) :: vertical = 0, turn_rate = 0, pull = 0, i1 = 1
        !> Factors of the products.
        real(dp) :: weight(max_states) = 0
    contains
        procedure :: set => set_series
        procedure :: expand
        procedure :: unfold
        procedure :: unfold_several
    end type space_frame_series_t

    !> That of the state itself in quadruple precision.
    type, extends(quadruple_series_t) :: space_frame_quadruple_t
        private
        type(body_t) :: body = body_t()
        type(motion_t) :: start = motion_t()
    contains
        procedure :: set => set_quadruple
        procedure :: expand => expand_quadruple
    end type space_frame_quadruple_t

    !> 1/((k + 1) (k + 2)), by which coefficient k of a second derivative becomes the next but one of the state.
    integer :: term
    real(dp), parameter :: share(0:max_series_order) = [(1.0_dp / ((term + 1) * (term + 2)), term=0, max_series_order)]

    interface
        pure subroutine c_expand(order, linear, weight, share, state, rate, fall, c) &
            bind(C, name='spintop_expand_top')
            import :: c_double, c_int
            integer(c_int), value :: order
            real(c_double), intent(in) :: linear(*), weight(*), share(*), state(*), rate(*)
            real(c_double), value :: fall
            real(c_double), intent(out) :: c(*)
        end subroutine c_expand
    end interface

contains

    !> The formulation with all that it offers.
    function new_space_frame() result(new)
        type(space_frame_t) :: new
        allocate (space_frame_flows_t :: new%flows)
        allocate (space_turns_t :: new%group)
        allocate (space_frame_series_t :: new%series)
        allocate (space_frame_quadruple_t :: new%quadruple_series)
    end function new_space_frame

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('space_frame', &
            'momentum in space axes and quaternion without spin, for symmetric tops; no pole is singular', &
            6, singular_at_poles=.false., invariants=3, quaternion=3)
    end function describe

    !> Constants of the motion and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(space_frame_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        real(dp) :: momentum(3)
        self%body = body
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%vertical = momentum(3)
        self%omega3 = start%omega(3)
        self%i1 = body%inertia(1)
        self%spin_rate = (real(body%inertia(1), xp) - body%inertia(3)) * start%omega(3) / body%inertia(1)
        self%sigma = real(self%spin_rate, dp)
        self%mgl = body%mgl()
        call self%set_capabilities(body, start)
        y = 0
        y(1:2) = momentum(1:2)
        y(3:6) = start%quaternion
        scales = motion_scales(body, start)
        self%scale(1:2) = scales%momentum
        self%scale(3:6) = 0.5_dp
        status = status_ok
    end subroutine prepare

    !> p' = (0, L/(2 I1)) p, and the gravitational torque.
    pure subroutine derivative(self, t, y, dy, status)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: w1, w2, w3, pull

        associate (unused => t)
        end associate
        ! The products are written out: with function calls a step would take twice the time.
        associate (p0 => y(3), p1 => y(4), p2 => y(5), p3 => y(6))
            w1 = y(1) / (2 * self%i1)
            w2 = y(2) / (2 * self%i1)
            w3 = self%vertical / (2 * self%i1)
            pull = 2 * self%mgl / ((p0**2 + p3**2) + (p1**2 + p2**2))
            dy(1) = -pull * (p2 * p3 - p0 * p1)
            dy(2) = pull * (p1 * p3 + p0 * p2)
            dy(3) = -(w1 * p1 + w2 * p2 + w3 * p3)
            dy(4) = w1 * p0 + w2 * p3 - w3 * p2
            dy(5) = w2 * p0 + w3 * p1 - w1 * p3
            dy(6) = w3 * p0 + w1 * p2 - w2 * p1
            dy(7:8) = 0
        end associate
        status = status_ok
    end subroutine derivative

    !> The motion; the angular velocity in space axes is L/I1 + sigma e.
    pure type(motion_t) function motion(self, t, y, near)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        type(motion_t) :: here
        here = self%motion_without_angles(t, y, near)
        motion = motion_from_quaternion(t, here%quaternion, here%omega, near)
        motion%norm_error = here%norm_error
        motion%omega_rate = here%omega_rate
    end function motion

    !> The same without angles and their rates.
    pure function motion_without_angles(self, t, y, near) result(motion)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        type(motion_t) :: motion
        real(dp) :: dy(max_states), q(4), back(4), momentum(3), axis(3), omega(3), norm
        integer :: status

        associate (unused => near)
        end associate
        norm = sqrt(sum(y(3:6)**2))
        q = with_spin(self, t, y(3:6) / norm)
        back = conjugate_quaternion(q)
        momentum = [y(1:2), self%vertical]
        omega = to_space(back, momentum) / self%i1
        omega(3) = omega(3) + self%sigma
        motion%t = t
        motion%quaternion = q
        motion%omega = omega
        motion%norm_error = norm - 1
        call self%derivative(t, y, dy, status)
        axis = to_space(q, [0.0_dp, 0.0_dp, 1.0_dp])
        motion%omega_rate = to_space(back, [dy(1:2), 0.0_dp] + self%sigma * cross(momentum, axis)) / self%i1
    end function motion_without_angles

    !> Unit quaternion of the attitude, from that without the spin.
    pure function with_spin(self, t, p) result(q)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, p(4)
        real(dp) :: q(4)
        real(xp) :: half
        real(dp), parameter :: small = sqrt(epsilon_dp)
        real(dp) :: phase, rest, c, s, rest_c, rest_s
        ! After many turns a phase in double precision is not accurate enough: its rest is a rotation, mostly small.
        half = self%spin_rate * t / 2
        phase = real(half, dp)
        rest = real(half - phase, dp)
        c = cos(phase)
        s = sin(phase)
        rest_c = 1
        rest_s = rest
        if (abs(rest) > small) then
            rest_c = cos(rest)
            rest_s = sin(rest)
        end if
        q = quaternion_product(p, [c * rest_c - s * rest_s, 0.0_dp, 0.0_dp, s * rest_c + c * rest_s])
    end function with_spin

    !> Continues the angles to a later state; the separated spin changes psi by sigma t.
    pure subroutine follow(self, t_last, y_last, t, y, angle, sure)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t_last, y_last(max_states), t, y(max_states) !! times, s, and states at both ends
        real(dp), intent(inout) :: angle(3)
            !! phi, theta, psi at the earlier state on entry, at the later one on return, rad
        logical, intent(out) :: sure !! whether the turns are certain
        real(dp) :: omega_last(3), omega(3), rate(3, 2)
        ! The attitude without spin has these angles minus sigma t.
        angle(3) = angle(3) - self%sigma * t_last
        omega_last = without_spin(self, y_last)
        omega = without_spin(self, y)
        if (may_meet_pole(y_last(3:6), omega_last, y(3:6), omega, t - t_last)) then
            rate(:, 1) = without_spin_rate(self, t_last, y_last)
            rate(:, 2) = without_spin_rate(self, t, y)
            call follow_angles(y_last(3:6), omega_last, y(3:6), omega, t - t_last, angle, sure, rate)
        else
            call follow_angles(y_last(3:6), omega_last, y(3:6), omega, t - t_last, angle, sure)
        end if
        angle(3) = angle(3) + self%sigma * t
    end subroutine follow

    !> Angular velocity L/I1, in the axes of p.
    pure function without_spin(self, y) result(omega)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp) :: omega(3)
        omega = to_space(conjugate_quaternion(y(3:6)), [y(1:2), self%vertical]) / self%i1
    end function without_spin

    !> Its rate: that of L, L'/I1, in the axes of p.
    pure function without_spin_rate(self, t, y) result(rate)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        real(dp) :: rate(3), slope(max_states)
        integer :: status
        call self%derivative(t, y, slope, status)
        rate = to_space(conjugate_quaternion(y(3:6)), [slope(1:2), 0.0_dp]) / self%i1
    end function without_spin_rate

    !> Squared norm of the quaternion, energy of the motion without its spin, and momentum about the axis.
    pure subroutine invariants(self, y, values)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        real(dp) :: axis(3)
        axis = to_space(y(3:6) / norm2(y(3:6)), [0.0_dp, 0.0_dp, 1.0_dp])
        values = 0
        values(1) = sum(y(3:6)**2)
        values(2) = sum(y(1:2)**2) / (2 * self%i1) + self%mgl * axis(3)
        values(3) = y(1) * axis(1) + y(2) * axis(2) + self%vertical * axis(3)
    end subroutine invariants

    !> Constants of the series.
    pure subroutine set_series(self, body, start)
        class(space_frame_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp) :: momentum(3)
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%vertical = momentum(3)
        self%i1 = body%inertia(1)
        self%pull = body%mgl() / self%i1
        self%weight = self%pull * [1, 1, 1, 1, 1, 1, 3, 0]
        self%turn_rate = self%vertical / self%i1
    end subroutine set_series

    !> Taylor coefficients of the motion, with L in axes that turn about the vertical with L_z/(2 I1).
    !>
    !> Let m = m g l/I1, w = L/I1, and u = e3 = u0 + v the height of the axis. With the constants of the
    !> motion at their values in the state, the equations, differentiated once more, are linear except for v:
    !>     L'' = (m u0 - w3^2/4) L + m v L,
    !>     p'' = ((m u0 - w.w/2)/2 -+ m/2) p + m v p,  - for p0 and p3, + for p1 and p2,
    !>     v'' = v''(0) + (4 m u0 - w.w) v + 3 m v^2,
    !> with w.w at the start. (w.w/2 + m u and w.e are constant, k x e = k e + u and e p = p k as
    !> quaternions.) So a term needs one product only, with v, and a coefficient but the last but one: top_series.c.
    pure subroutine expand(self, t, y, order, coefficient)
        class(space_frame_series_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order)
        !> Rates of the state and of v, and the factors of their linear terms.
        real(dp) :: rate(max_states), linear(max_states)
        real(dp) :: m, w(3), axis(3), upper, lower, inverse, square, fall

        m = self%pull
        w = [y(1:2), self%vertical] / self%i1
        square = w(1)**2 + w(2)**2 + w(3)**2
        associate (p0 => y(3), p1 => y(4), p2 => y(5), p3 => y(6), unused => t)
            upper = p0**2 + p3**2
            lower = p1**2 + p2**2
            inverse = 1 / (upper + lower)
            axis = inverse * [2 * (p1 * p3 + p0 * p2), 2 * (p2 * p3 - p0 * p1), upper - lower]
            rate = [w(3) / 2 * y(2) - m * axis(2) * self%i1, &
                    m * axis(1) * self%i1 - w(3) / 2 * y(1), &
                    -(w(1) * p1 + w(2) * p2 + w(3) * p3) / 2, &
                    (w(1) * p0 + w(2) * p3 - w(3) * p2) / 2, &
                    (w(2) * p0 + w(3) * p1 - w(1) * p3) / 2, &
                    (w(3) * p0 + w(1) * p2 - w(2) * p1) / 2, &
                    w(1) * axis(2) - w(2) * axis(1), 0.0_dp]
        end associate
        linear = [m * axis(3) - w(3)**2 / 4, m * axis(3) - w(3)**2 / 4, &
                  m * inverse * [-lower, upper, upper, -lower] - square / 4, 4 * m * axis(3) - square, 0.0_dp]
        fall = w(3) * (w(1) * axis(1) + w(2) * axis(2)) - axis(3) * (w(1)**2 + w(2)**2) &
            - m * (axis(1)**2 + axis(2)**2)
        call c_expand(order, linear, self%weight, share, y, rate, fall, coefficient)
    end subroutine expand

    !> Rotates L back to axes at rest.
    pure subroutine unfold(self, y, h, change)
        class(space_frame_series_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states) !! of the variables of the series, then of the state
        real(dp) :: angle, sinc, drop, l1, l2

        angle = self%turn_rate * h / 2
        call half_turn(angle**2, sinc, drop)
        l1 = y(1) + change(1)
        l2 = y(2) + change(2)
        change(1) = change(1) + (drop * l1 - angle * sinc * l2)
        change(2) = change(2) + (drop * l2 + angle * sinc * l1)
    end subroutine unfold

    !> The same at several instants.
    pure subroutine unfold_several(self, y, h, change)
        class(space_frame_series_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h(instants)
        real(dp), intent(inout) :: change(instants, max_states) !! of the variables of the series, then of the state
        real(dp) :: here(max_states)
        integer :: i
        do i = 1, instants
            here = change(i, :)
            call self%unfold(y, h(i), here)
            change(i, :) = here
        end do
    end subroutine unfold_several

    !> Momentum about the vertical, for the attitude of a quaternion of any norm. Near the upright its
    !> difference from the momentum about the axis determines the motion.
    pure real(qp) function vertical_momentum(body, start)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(qp) :: q(4), momentum(3)
        q = start%quaternion
        momentum = real(body%inertia, qp) * start%omega
        vertical_momentum = (2 * ((q(2) * q(4) - q(1) * q(3)) * momentum(1) &
                                  + (q(3) * q(4) + q(1) * q(2)) * momentum(2)) &
                             + (q(1)**2 + q(4)**2 - q(2)**2 - q(3)**2) * momentum(3)) / sum(q**2)
    end function vertical_momentum

    !> Constants of the series in quadruple precision.
    pure subroutine set_quadruple(self, body, start)
        class(space_frame_quadruple_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        self%body = body
        self%start = start
    end subroutine set_quadruple

    !> Taylor coefficients of the motion in quadruple precision.
    pure subroutine expand_quadruple(self, t, y, order, coefficient)
        class(space_frame_quadruple_t), intent(in) :: self
        real(dp), intent(in) :: t
        real(qp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order)
        real(qp) :: by_l1(4), by_l2(4), by_p0(2), by_p3(2), half, vertical, pull
        integer :: k, j

        associate (unused => t)
        end associate
        half = 1 / (2 * real(self%body%inertia(1), qp))
        vertical = vertical_momentum(self%body, self%start) * half
        pull = 2 * real(self%body%mass, qp) * self%body%gravity * self%body%centre_of_mass(3) / sum(y(3:6)**2)
        coefficient(:, 0) = y
        associate (c => coefficient)
            do k = 0, order - 1
                by_l1 = 0
                by_l2 = 0
                by_p0 = 0
                by_p3 = 0
                do j = 0, k
                    by_l1 = by_l1 + c(1, j) * c(3:6, k - j)
                    by_l2 = by_l2 + c(2, j) * c(3:6, k - j)
                    by_p0 = by_p0 + c(3, j) * c(4:5, k - j)
                    by_p3 = by_p3 + c(6, j) * c(4:5, k - j)
                end do
                c(1, k + 1) = pull * (by_p0(1) - by_p3(2))
                c(2, k + 1) = pull * (by_p0(2) + by_p3(1))
                c(3, k + 1) = -half * (by_l1(2) + by_l2(3)) - vertical * c(6, k)
                c(4, k + 1) = half * (by_l1(1) + by_l2(4)) - vertical * c(5, k)
                c(5, k + 1) = half * (by_l2(1) - by_l1(4)) + vertical * c(4, k)
                c(6, k + 1) = half * (by_l1(3) - by_l2(2)) + vertical * c(3, k)
                c(7:8, k + 1) = 0
                c(:, k + 1) = c(:, k + 1) / (k + 1)
            end do
        end associate
    end subroutine expand_quadruple

end module spintop_space_frame
