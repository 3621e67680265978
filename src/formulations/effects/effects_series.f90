!> Power series of the motion of a body with effects, in double precision: see effects_series.inc.
module spintop_effects_series
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_series_order, max_states, series_t
    use spintop_effects, only: effects_t, harmonic_t
    use spintop_kinds, only: dp, no_number, wp => dp
    use spintop_motion, only: motion_t
    use spintop_smooth_effects_series, only: smooth_series_t
    use spintop_torque_table, only: max_degree
    implicit none
    private
    public :: effects_series_t

    !> The Taylor series of the motion.
    type, extends(series_t) :: effects_series_t
        private
        type(smooth_series_t) :: smooth
        type(body_t) :: body
        type(effects_t) :: effects
    contains
        procedure :: set
        procedure :: expand
    end type effects_series_t

    include 'effects_series_terms.inc'

contains

    include 'effects_series.inc'

    !> Constants of the series.
    pure subroutine set(self, body, start)
        class(effects_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%body = body
        self%effects = effects_t()
        if (allocated(body%effects)) self%effects = body%effects
        call self%smooth%set(body, self%effects)
    end subroutine set

    !> Taylor coefficients of the motion, by the general recurrence where the effects are not analytic.
    pure subroutine expand(self, t, y, order, coefficient)
        class(effects_series_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        integer, intent(in) :: order !! order of the highest coefficient
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        logical :: exists
        exists = self%smooth%holds
        if (exists) call self%smooth%find(t, y, order, coefficient, exists)
        if (.not. exists) call find_series(self%body, self%effects, t, y, order, coefficient)
    end subroutine expand

end module spintop_effects_series
