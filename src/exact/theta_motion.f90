!> Selects the form in which the exact solution of a case is evaluated.
module spintop_theta_motion
    use spintop_kinds, only: dp, xp
    use spintop_circular_functions, only: nearest_whole
    use spintop_turning_points, only: turning_points_t
    use spintop_theta_functions, only: theta_clock_t, theta_values_t
    use spintop_circular_form, only: circular_form_t, evaluate_circular_form, prepare_circular_form
    use spintop_hyperbolic_form, only: hyperbolic_form_t, prepare_hyperbolic_form, &
        evaluate_hyperbolic_form
    implicit none
    private
    public :: theta_motion_t
    public :: regime_resting, regime_circular, regime_hyperbolic

    !> The axis is at rest: upright, hanging, or anywhere without weight and angular velocity.
    integer, parameter :: regime_resting = 1
    !> k^2 <= 1/2: theta functions of the nome in circular functions of time.
    integer, parameter :: regime_circular = 2
    !> k^2 > 1/2, the separatrix included: the complementary nome in hyperbolic functions.
    integer, parameter :: regime_hyperbolic = 3

    !> Argument from the upper turning point on the separatrix, which it never reaches.
    real(dp), parameter :: never = 1e6_dp

    !> A motion by its start, its turning points and its theta functions. Immutable after its preparation.
    type, extends(turning_points_t) :: theta_motion_t
        integer :: regime = regime_resting
        type(theta_clock_t) :: clock
        type(circular_form_t), private :: circular
        type(hyperbolic_form_t), private :: hyperbolic
    contains
        procedure :: set_form
        procedure :: locate
        procedure :: evaluate
    end type theta_motion_t

contains

    !> Selects the form for turning points that are set, and prepares it.
    pure subroutine set_form(motion)
        class(theta_motion_t), intent(inout) :: motion
        logical :: at_rest, in_balance
        at_rest = .not. motion%swing_squared > 0
        in_balance = .not. motion%beta * motion%sine_squared > 0
        if ((at_rest .and. in_balance) .or. .not. motion%roots%frequency > 0) then
            motion%regime = regime_resting
        else if (motion%roots%k_squared <= 0.5_dp) then
            motion%regime = regime_circular
            call prepare_circular_form(motion%cubic, motion%roots, motion%clock, motion%circular)
        else
            motion%regime = regime_hyperbolic
            call prepare_hyperbolic_form(motion%turning_points_t, motion%clock, motion%hyperbolic)
        end if
    end subroutine set_form

    !> The argument at a time `elapsed` (s) after the start, reduced by whole nutations.
    pure subroutine locate(self, elapsed, z, from_top, nutations)
        class(theta_motion_t), intent(in) :: self
        real(xp), intent(in) :: elapsed !! time since the start, s
        real(dp), intent(out) :: z          !! within half a period of zero
        real(dp), intent(out) :: from_top   !! half a period minus |z|
        real(xp), intent(out) :: nutations  !! number of nutations subtracted
        real(xp) :: argument
        associate (clock => self%clock)
            argument = clock%start + clock%rate * elapsed
            nutations = 0
            from_top = never
            if (clock%period > 0) then
                nutations = nearest_whole(argument * clock%per_period)
                ! The bounds matter only for times so large that no digit of z is correct.
                argument = argument - nutations * clock%period
                argument = max(-clock%half_period, min(clock%half_period, argument))
                from_top = real(clock%half_period - abs(argument), dp)
            end if
            z = real(argument, dp)
        end associate
    end subroutine locate

    !> The theta functions at the reduced argument z.
    pure subroutine evaluate(self, z, from_top, theta)
        class(theta_motion_t), intent(in) :: self
        real(dp), intent(in) :: z, from_top  !! as `locate` gives them
        type(theta_values_t), intent(out) :: theta !! values of the theta functions
        if (self%regime == regime_circular) then
            call evaluate_circular_form(self%circular, z, from_top, theta)
        else
            call evaluate_hyperbolic_form(self%hyperbolic, z, from_top, theta)
        end if
    end subroutine evaluate

end module spintop_theta_motion
