!> The symmetric top in space axes: angular momentum and the attitude without the spin.
!>
!> The momentum about the vertical is constant, and the spin about the axis, relative to axes that
!> turn with the angular velocity L/I1, is linear in time. It is split off: q = p exp(k sigma t/2).
!> What is left is bilinear, has no trigonometric functions and no singular attitude. With the axis
!> e, a quadratic form of p, L' = m g l (-e2, e1, 0) and e' = L x e/I1.
module spintop_space_frame
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp, qp, xp
    use spintop_attitude, only: conjugate_quaternion, to_space, half_turn
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants, max_series_order, max_states
    use spintop_kernel_types, only: symmetric_top_t, acceleration_rest, acceleration_share
    use spintop_motion, only: motion_t
    use spintop_quadruple_start, only: quadruple_attitude, quadruple_omega, vector
    use spintop_quantities, only: motion_scales_t, motion_scales
    use spintop_status, only: status_ok
    implicit none
    private
    public :: space_frame_t

    !> State y = (L1, L2, p0, p1, p2, p3).
    type, extends(formulation_t) :: space_frame_t
        private
        !> Momentum about the vertical.
        real(dp) :: vertical = 0
        real(dp) :: mgl = 0, i1 = 1
        !> Constants of the series.
        type(symmetric_top_t) :: top = symmetric_top_t()
    contains
        procedure :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: kinematics
        procedure :: invariants
        procedure :: expand
        procedure :: quadruple_start
        procedure :: expand_quadruple
        procedure :: drift
        procedure :: kick
    end type space_frame_t

    interface
        pure subroutine c_expand(order, top, state, share, share_rest, c) bind(C, name='spintop_expand_top')
            import :: c_double, c_int, symmetric_top_t
            integer(c_int), value :: order
            type(symmetric_top_t), intent(in) :: top
            real(c_double), intent(in) :: state(*), share(*), share_rest(*)
            real(c_double), intent(out) :: c(*)
        end subroutine c_expand
    end interface

contains

    !> Name and properties.
    pure function info(self)
        class(space_frame_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('space_frame', &
            'momentum in space axes and quaternion without spin, for symmetric tops; no pole is singular', &
            6, singular_at_poles=.false., invariants=3, quaternion=3)
        info%offers = .true.
    end function info

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
        self%start = start
        self%attitude = 3
        self%turns_in_space = .true.
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%vertical = momentum(3)
        self%i1 = body%inertia(1)
        self%sigma = (real(body%inertia(1), xp) - body%inertia(3)) * start%omega(3) / body%inertia(1)
        self%splits_as_nystrom = .true.
        self%mgl = body%mgl()
        self%top = symmetric_top_t(self%i1, self%mgl / self%i1, self%vertical / self%i1)
        self%of_denominator = 6
        self%turn_rate = self%top%turn_rate
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
        real(dp) :: w(3), pull

        ! The products are written out: with function calls a step would take twice the time.
        associate (p0 => y(3), p1 => y(4), p2 => y(5), p3 => y(6))
            w = [y(1:2), self%vertical] / (2 * self%i1)
            pull = 2 * self%mgl / ((p0**2 + p3**2) + (p1**2 + p2**2))
            dy(1) = -pull * (p2 * p3 - p0 * p1)
            dy(2) = pull * (p1 * p3 + p0 * p2)
            dy(3) = -(w(1) * p1 + w(2) * p2 + w(3) * p3)
            dy(4) = w(1) * p0 + w(2) * p3 - w(3) * p2
            dy(5) = w(2) * p0 + w(3) * p1 - w(1) * p3
            dy(6) = w(3) * p0 + w(1) * p2 - w(2) * p1
            dy(7:8) = 0
        end associate
        status = status_ok
    end subroutine derivative

    !> The angular velocity L/I1 in the axes of p and, if it is wanted, its rate L'/I1. That of the body in space axes is
    !> L/I1 + sigma e.
    pure subroutine kinematics(self, t, y, omega, rate)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in the axes of p, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        real(dp) :: dy(max_states), back(4), scale
        integer :: status
        back = conjugate_quaternion(y(3:6))
        scale = sum(back**2) * self%i1
        omega = to_space(back, [y(1:2), self%vertical]) / scale
        if (.not. present(rate)) return
        call self%derivative(t, y, dy, status)
        rate = to_space(back, [dy(1:2), 0.0_dp]) / scale
    end subroutine kinematics

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

    !> In the drift, the top without weight, L is constant and p turns about it; the kick is the gravitational
    !> torque at rest. (The split of Dullweber, Leimkuhler and McLachlan, J. Chem. Phys. 107, 1997, in
    !> the axes in which free symmetric tops turn uniformly.)
    !>
    !> p rotates by the angle h |L|/I1 about L: p+ = exp(h (0, L)/(2 I1)) p.
    pure subroutine drift(self, y, h, change)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states) !! since the beginning of the step; the effect is added
        real(dp) :: w1, w2, w3, p0, p1, p2, p3, drop, scale, sinc

        scale = h / (2 * self%i1)
        w1 = scale * (y(1) + change(1))
        w2 = scale * (y(2) + change(2))
        w3 = scale * self%vertical
        call half_turn(w1**2 + w2**2 + w3**2, sinc, drop)
        p0 = y(3) + change(3)
        p1 = y(4) + change(4)
        p2 = y(5) + change(5)
        p3 = y(6) + change(6)
        change(3) = change(3) + (drop * p0 - sinc * (w1 * p1 + w2 * p2 + w3 * p3))
        change(4) = change(4) + (drop * p1 + sinc * (w1 * p0 + w2 * p3 - w3 * p2))
        change(5) = change(5) + (drop * p2 + sinc * (w2 * p0 + w3 * p1 - w1 * p3))
        change(6) = change(6) + (drop * p3 + sinc * (w3 * p0 + w1 * p2 - w2 * p1))
    end subroutine drift

    !> L changes by the gravitational torque.
    pure subroutine kick(self, y, h, change)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states) !! since the beginning of the step; the effect is added
        real(dp) :: p(4), pull
        p = y(3:6) + change(3:6)
        pull = 2 * h * self%mgl / ((p(1)**2 + p(4)**2) + (p(2)**2 + p(3)**2))
        change(1) = change(1) - pull * (p(3) * p(4) - p(1) * p(2))
        change(2) = change(2) + pull * (p(2) * p(4) + p(1) * p(3))
    end subroutine kick

    !> Taylor coefficients of the motion, with L in axes that turn about the vertical with L_z/(2 I1).
    !>
    !> Let m = m g l/I1, w = L/I1, and u = e3 = u0 + v/m the height of the axis. With the constants of the
    !> motion at their values in the state, the equations, differentiated once more, are linear except for v:
    !>     L'' = (m u0 - w3^2/4) L + v L,
    !>     p'' = ((m u0 - w.w/2)/2 -+ m/2) p + v p,  - for p0 and p3, + for p1 and p2,
    !>     v'' = v''(0) + (4 m u0 - w.w) v + 3 v^2,
    !> with w.w at the start. (w.w/2 + m u and w.e are constant, k x e = k e + u and e p = p k as
    !> quaternions.) So a term needs one product only, with v, and a coefficient but the last but one: top_series.h.
    !>
    !> No factor may be rounded in these in the same way in every step, but not in the first derivatives: constants of the
    !> motion would drift. So at the finest tolerances the factors of the linear terms are sums of two numbers.
    !>
    !> These series converge as far as to the next complex time at which the motion has a pole. As elliptic functions and their
    !> integrals, the variables are quotients with a common denominator D, (log D)'' = -v/2, of functions that have no poles
    !> (Whittaker, Analytical Dynamics, chapter VI). The coefficients in the place of v are those of D, and D times the changes of
    !> L and p is summed, so that steps may be several times longer. At the finest tolerances D is not used: see top_series.h.
    pure subroutine expand(self, t, y, order, coefficient)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        integer, intent(in) :: order !! order of the highest coefficient
        real(dp), intent(out) :: coefficient(max_states, 0:order) !! column k is the coefficient of h^k
        call c_expand(order, self%top, y, acceleration_share, acceleration_rest, coefficient)
    end subroutine expand

    !> The state at the start.
    pure function quadruple_start(self) result(y)
        class(space_frame_t), intent(in) :: self
        real(qp) :: y(max_states), momentum(3)
        momentum = space_momentum(self%body, self%start)
        y = [momentum(1:2), quadruple_attitude(self%start), 0.0_qp, 0.0_qp]
    end function quadruple_start

    !> Momentum in space axes, for the attitude of a quaternion of any norm. Near the upright the difference of that about
    !> the vertical from that about the axis determines the motion.
    pure function space_momentum(body, start)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(qp) :: space_momentum(3), q(4), momentum(3)
        q = quadruple_attitude(start)
        momentum = real(body%inertia, qp) * quadruple_omega(start)
        associate (u => q(2:4))
            space_momentum = ((q(1)**2 - sum(u**2)) * momentum + 2 * (dot_product(u, momentum) * u + q(1) * vector(u, momentum))) &
                / sum(q**2)
        end associate
    end function space_momentum

    !> Taylor coefficients of the motion in quadruple precision.
    pure subroutine expand_quadruple(self, t, y, order, coefficient)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(qp), intent(in) :: y(max_states) !! state in quadruple precision
        integer, intent(in) :: order !! order of the highest coefficient
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        real(qp) :: momentum(3), by_l1(4), by_l2(4), by_p0(2), by_p3(2), half, vertical, pull
        integer :: k, j

        half = 1 / (2 * real(self%body%inertia(1), qp))
        momentum = space_momentum(self%body, self%start)
        vertical = momentum(3) * half
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
