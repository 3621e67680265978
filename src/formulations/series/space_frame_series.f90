!> Power series of the motion of a symmetric top in space axes, in double and quadruple precision.
module spintop_space_frame_series
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_attitude, only: to_space
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_series_order, max_states, quadruple_series_t, series_t
    use spintop_kernel_types, only: symmetric_top_t
    use spintop_kinds, only: dp, qp
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants
    use spintop_quadruple_start, only: quadruple_attitude, quadruple_omega
    use spintop_series_shares, only: acceleration_rest, acceleration_share
    use spintop_small_turn, only: half_turn
    implicit none
    private
    public :: space_frame_series_t, space_frame_quadruple_t

    !> The Taylor series of the motion.
    type, extends(series_t) :: space_frame_series_t
        private
        type(symmetric_top_t) :: top = symmetric_top_t()
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
        procedure :: y_start
        procedure :: expand => expand_quadruple
    end type space_frame_quadruple_t

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

    !> Constants of the series.
    pure subroutine set_series(self, body, start)
        class(space_frame_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp) :: momentum(3)
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%top = symmetric_top_t(body%inertia(1), body%mgl() / body%inertia(1), momentum(3) / body%inertia(1))
    end subroutine set_series

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
    !> (Whittaker, Analytical Dynamics, chapter VI). The coefficients are those of D times the changes of L and p, and in the
    !> place of v those of D, so that steps may be several times longer. At the finest tolerances D is 1: see top_series.h.
    pure subroutine expand(self, t, y, order, coefficient)
        class(space_frame_series_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        integer, intent(in) :: order !! order of the highest coefficient
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        call c_expand(order, self%top, y, acceleration_share, acceleration_rest, coefficient)
    end subroutine expand

    !> Divides by the denominator, and rotates L back to axes at rest.
    pure subroutine unfold(self, y, h, change)
        class(space_frame_series_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step; time in it, s
        real(dp), intent(inout) :: change(max_states) !! of the variables of the series, then of the state
        real(dp) :: angle, sinc, drop, l1, l2

        change(:6) = change(:6) / (1 + change(7))
        change(7:) = 0
        angle = self%top%turn_rate * h / 2
        call half_turn(angle**2, sinc, drop)
        l1 = y(1) + change(1)
        l2 = y(2) + change(2)
        change(1) = change(1) + (drop * l1 - angle * sinc * l2)
        change(2) = change(2) + (drop * l2 + angle * sinc * l1)
    end subroutine unfold

    !> The same at several instants.
    pure subroutine unfold_several(self, y, h, change)
        class(space_frame_series_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h(instants) !! state at the beginning of the step; times in it, s
        real(dp), intent(inout) :: change(instants, max_states) !! of the variables of the series, then of the state
        real(dp) :: here(max_states)
        integer :: i
        do i = 1, instants
            here = change(i, :)
            call self%unfold(y, h(i), here)
            change(i, :) = here
        end do
    end subroutine unfold_several

    !> Keeps body and start.
    pure subroutine set_quadruple(self, body, start)
        class(space_frame_quadruple_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%body = body
        self%start = start
    end subroutine set_quadruple

    !> The state at the start.
    pure function y_start(self)
        class(space_frame_quadruple_t), intent(in) :: self
        real(qp) :: y_start(max_states), momentum(3)
        momentum = space_momentum(self%body, self%start)
        y_start = [momentum(1:2), quadruple_attitude(self%start), 0.0_qp, 0.0_qp]
    end function y_start

    !> Momentum in space axes, for the attitude of a quaternion of any norm. Near the upright the difference of that about
    !> the vertical from that about the axis determines the motion.
    pure function space_momentum(body, start)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(qp) :: space_momentum(3), q(4), momentum(3)
        q = quadruple_attitude(start)
        momentum = real(body%inertia, qp) * quadruple_omega(start)
        space_momentum = [ &
            (q(1)**2 + q(2)**2 - q(3)**2 - q(4)**2) * momentum(1) + 2 * (q(2) * q(3) - q(1) * q(4)) * momentum(2) &
                + 2 * (q(2) * q(4) + q(1) * q(3)) * momentum(3), &
            2 * (q(2) * q(3) + q(1) * q(4)) * momentum(1) + (q(1)**2 - q(2)**2 + q(3)**2 - q(4)**2) * momentum(2) &
                + 2 * (q(3) * q(4) - q(1) * q(2)) * momentum(3), &
            2 * ((q(2) * q(4) - q(1) * q(3)) * momentum(1) + (q(3) * q(4) + q(1) * q(2)) * momentum(2)) &
                + (q(1)**2 + q(4)**2 - q(2)**2 - q(3)**2) * momentum(3)] / sum(q**2)
    end function space_momentum

    !> Taylor coefficients of the motion in quadruple precision.
    pure subroutine expand_quadruple(self, t, y, order, coefficient)
        class(space_frame_quadruple_t), intent(in) :: self
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

end module spintop_space_frame_series
