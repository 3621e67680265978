!> Power series of the motion of any rigid body with a fixed point, with effects or without, in quadruple precision: see
!> effects_series.inc.
module spintop_effects_series_quadruple
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_series_order, max_states, quadruple_series_t
    use spintop_effects, only: effects_t, harmonic_t
    use spintop_kinds, only: dp, no_number, wp => qp
    use spintop_motion, only: motion_t
    use spintop_quadruple_start, only: quadruple_attitude, quadruple_omega
    use spintop_torque_table, only: max_degree
    implicit none
    private
    public :: body_quadruple_t

    !> The Taylor series of the motion.
    type, extends(quadruple_series_t) :: body_quadruple_t
        private
        type(body_t) :: body
        type(motion_t) :: start
        type(effects_t) :: effects
    contains
        procedure :: set
        procedure :: y_start
        procedure :: expand
    end type body_quadruple_t

    include 'effects_series_terms.inc'

contains

    include 'effects_series.inc'

    !> Keeps body and start.
    pure subroutine set(self, body, start)
        class(body_quadruple_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%body = body
        self%start = start
        self%effects = effects_t()
        if (allocated(body%effects)) self%effects = body%effects
    end subroutine set

    !> The state at the start.
    pure function y_start(self)
        class(body_quadruple_t), intent(in) :: self
        real(wp) :: y_start(max_states), q(4), omega(3), o(3)
        o = frame_of(self%effects)
        q = quadruple_attitude(self%start)
        omega = quadruple_omega(self%start)
        if (any(abs(o) > 0)) omega = omega + 2 * (q(1)**2 * o - q(1) * vector(q(2:4), o) + q(2:4) * dot_product(q(2:4), o)) &
            / sum(q**2) - o
        y_start = [q, self%body%inertia * omega + self%effects%rotor_momentum, 0.0_wp]
    end function y_start

    !> Taylor coefficients of the motion.
    pure subroutine expand(self, t, y, order, coefficient)
        class(body_quadruple_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(wp), intent(in) :: y(max_states) !! state
        integer, intent(in) :: order !! order of the highest coefficient
        real(wp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        call find_series(self%body, self%effects, t, y, order, coefficient)
    end subroutine expand

end module spintop_effects_series_quadruple
