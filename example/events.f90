!> The turning points of an asymmetric, damped body: events that are found to rounding within the steps.
module turning_points
    use spintop, only: axis_height_rate, dp, event_t, event_search_t, formulation_t, max_states, motion_t, observer_t
    implicit none

    !> Prints every event, and ends the motion at the sixth.
    type, extends(event_search_t) :: turning_points_t
        integer :: found = 0
    contains
        procedure :: quantities
        procedure :: handle_event
    end type turning_points_t

    !> Keeps the last motion: that at the event that ends the run.
    type, extends(observer_t) :: last_motion_t
        type(motion_t) :: motion
    contains
        procedure :: observe
    end type last_motion_t

contains

    subroutine quantities(self, motion, values)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        real(dp), intent(out) :: values(:)
        values(:size(self%events)) = axis_height_rate(motion)
    end subroutine quantities

    subroutine handle_event(self, number, motion)
        class(turning_points_t), intent(inout) :: self
        integer, intent(in) :: number
        type(motion_t), intent(in) :: motion
        self%found = self%found + 1
        self%has_enough = self%found == 6
        print '(2a, f14.10, a, f13.10)', trim(self%events(number)%name), ' point at', motion%t, ' s: theta =', motion%angle(2)
    end subroutine handle_event

    subroutine observe(self, formulation, t, y, near)
        class(last_motion_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        self%motion = formulation%motion(t, y, near)
    end subroutine observe
end module turning_points

program events
    use spintop
    use turning_points, only: last_motion_t, turning_points_t
    implicit none
    type(body_t) :: body
    class(formulation_t), allocatable :: formulation
    class(stepper_t), allocatable :: stepper
    type(turning_points_t) :: search
    type(last_motion_t) :: last
    type(outcome_t) :: outcome
    real(dp) :: no_samples(0)

    body%inertia = [0.9_dp, 0.7_dp, 0.25_dp]
    body%centre_of_mass = [0.05_dp, 0.0_dp, 0.8_dp]
    body%damping = 0.01_dp
    allocate (search%events(2))
    search%events%name = [character(7) :: 'lowest', 'highest']
    search%events%direction = [1, -1] ! the rate of the height rises through zero, or falls
    call create_formulation('rigid_body', formulation)
    call create_stepper('taylor', stepper)
    stepper%controls%relative_tolerance = 1.0e-13_dp
    call integrate(formulation, stepper, body, &
                   motion_from_angles(0.0_dp, [0.0_dp, 0.5_dp, 0.0_dp], [0.0_dp, 0.5_dp, 20.0_dp]), &
                   60.0_dp, no_samples, last, outcome, search)
    print '(2a, f8.4, a, f9.4, a)', status_name(outcome%status), ', ended at', outcome%t, ' s: phi =', last%motion%angle(1), ' rad'
end program events
