!> The error of numerical methods against the exact motion, and the error that no method can avoid.
module error_meter
    use spintop, only: axis_tip, body_t, dp, exact_motion_t, formulation_t, max_states, observer_t
    implicit none

    !> Measures how far the axis of the body is from the exact one.
    type, extends(observer_t) :: error_meter_t
        type(body_t) :: body
        type(exact_motion_t) :: exact
        real(dp) :: largest = 0
    contains
        procedure :: observe
    end type error_meter_t

contains

    subroutine observe(self, formulation, t, y, near)
        class(error_meter_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        self%largest = max(self%largest, norm2(axis_tip(self%body, formulation%motion(t, y, near)) &
                                               - axis_tip(self%body, self%exact%at(t))))
    end subroutine observe
end module error_meter

program accuracy
    use error_meter, only: error_meter_t
    use spintop
    implicit none
    real(dp), parameter :: span = 6 ! s
    type(body_t) :: body
    type(motion_t) :: start
    type(exact_motion_t) :: exact
    integer :: status

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
    body%centre_of_mass(3) = sqrt(0.75_dp)
    start = motion_from_angles(0.0_dp, [0.0_dp, 1.0_dp, 0.0_dp], [0.0_dp, 0.0_dp, 10.0_dp])
    call prepare_exact_motion(body, start, exact, status)
    if (status /= status_ok) error stop 'there is no exact motion'
    call print_results('rk4', 600)
    call print_results('rk4', 1200)
    call print_results('splitting_6', 72)
    call print_results('splitting_6', 144)
    call print_results('taylor', 0)
    print '(a, es9.2, a)', 'inherent error:', inherent_error(body, start, span), ' rad'

contains

    !> Integrates with a number of equal steps, or (0) with steps that the method chooses.
    subroutine print_results(method, steps)
        character(*), intent(in) :: method
        integer, intent(in) :: steps
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        type(error_meter_t) :: meter
        type(outcome_t) :: outcome
        integer :: i

        meter%body = body
        meter%exact = exact
        call create_formulation('space_frame', formulation)
        call create_stepper(method, stepper)
        stepper%controls%steps = steps
        stepper%controls%relative_tolerance = 1.0e-13_dp
        call integrate(formulation, stepper, body, start, span, [(span * i / 24, i=1, 24)], meter, outcome)
        if (outcome%status /= status_ok) error stop 'the method failed'
        print '(a11, i6, a, es9.2)', method, outcome%counts%steps, ' steps: largest error of the axis', meter%largest
    end subroutine print_results
end program accuracy
