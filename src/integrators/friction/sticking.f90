!> Rest of a body with effects: where its angular velocity vanishes, dry friction holds it if it can balance the other torques.
!>
!> Friction has the direction of the angular velocity, so f jumps where that vanishes. A step towards rest ends half-way there,
!> as far as the deceleration tells, until what is left of the angular velocity is negligible.
module spintop_sticking
    use spintop_effects_action, only: turning_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: rest_t

    !> Whether the body rests, and how near it is to rest.
    type :: rest_t
        !> Whether the body is at rest, since the time `t_stuck`, s.
        logical :: is_resting = .false.
        real(dp) :: t_stuck = 0
        !> Whether the method steps by series, which end where a motion reverses without dry friction, too.
        logical :: has_series = .false.
        !> Largest angular velocity so far, rad/s, and deceleration, rad/s^2, where they were computed.
        real(dp), private :: largest = 0, steepest = 0
        !> What was seen last: the end of a step is the beginning of the next. A deceleration that does not matter is zero.
        type(turning_t), private :: seen
    contains
        procedure :: begin
        procedure :: latest_end
        procedure :: note_turning
        procedure :: detect_rest
    end type rest_t

    !> A body whose angular velocity is below this share of its largest value comes to rest.
    real(dp), parameter :: nearly_still = 1.0e-8_dp
    !> The same share of what remains of an angular velocity in a plane motion that reverses.
    real(dp), parameter :: rounding = 1.0e-13_dp
    !> A plane motion under drag turns where it slows down at least with this share of its largest deceleration: a
    !> motion that dies away does not.
    real(dp), parameter :: turning = 1.0e-6_dp
    !> Steps to rest are limited to this share of the time left.
    real(dp), parameter :: share = 0.5_dp

contains

    !> Examines the start.
    subroutine begin(self, stepper, has_series)
        class(rest_t), intent(inout) :: self
        class(stepper_t), intent(in) :: stepper !! the method, at the start
        logical, intent(in) :: has_series !! whether the method steps by series
        type(turning_t) :: start
        self%has_series = has_series
        start = stepper%formulation%action%turning_at(stepper%t, stepper%y)
        self%largest = start%speed
        if (.not. start%speed > 0) call check_rest(self, stepper%formulation, stepper%t, stepper%y)
    end subroutine begin

    !> Looks at the angular velocity. How fast it decreases is zero where nothing depends on its direction: without dry
    !> friction, but for series under a drag, which end near where the motion turns.
    subroutine set_motion(self, formulation, t, y)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states)
        if (.not. abs(t - self%seen%t) > 0) return
        self%seen = formulation%action%turning_at(t, y)
        self%largest = max(self%largest, self%seen%speed)
        self%steepest = max(self%steepest, self%seen%slowing)
        if (.not. (formulation%action%may_stick &
                   .or. (self%has_series .and. self%seen%slowing > turning * self%steepest))) self%seen%slowing = 0
    end subroutine set_motion

    !> The time up to which a step from a state may reach: half of that to rest.
    real(dp) function latest_end(self, formulation, t, y)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        latest_end = huge(t)
        call set_motion(self, formulation, t, y)
        if (self%seen%slowing > 0 .and. self%seen%speed > 0) latest_end = t + share * self%seen%speed / self%seen%slowing
    end function latest_end

    !> Notes the angular velocity at the ends of a step that was not looked at otherwise.
    pure subroutine note_turning(self, speed, span)
        class(rest_t), intent(inout) :: self
        real(dp), intent(in) :: speed(2), span !! magnitudes of the angular velocity, rad/s; length of the step, s
        self%largest = max(self%largest, speed(1), speed(2))
        self%steepest = max(self%steepest, (speed(1) - speed(2)) / span)
    end subroutine note_turning

    !> Notes whether friction holds a body that is at rest.
    subroutine check_rest(self, formulation, t, y)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states)
        logical :: was_resting
        was_resting = self%is_resting
        self%is_resting = formulation%action%may_stick
        if (self%is_resting) self%is_resting = .not. formulation%action%excess(t, y) > 0
        if (self%is_resting .and. .not. was_resting) self%t_stuck = t
    end subroutine check_rest

    !> Finds out at the end of a step whether the body is at rest. Where it is nearly, it is brought to rest: then `is_stopped`,
    !> and the time is the later one of rest. With a fixed step size that happens only where friction holds it, at that time.
    subroutine detect_rest(self, stepper, t_end, is_stopped)
        class(rest_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! what took the step
        real(dp), intent(in) :: t_end !! end of the span, s
        logical, intent(out) :: is_stopped !! whether the time and the state were changed
        real(dp) :: allowed, left, y(max_states)

        is_stopped = .false.
        call set_motion(self, stepper%formulation, stepper%t, stepper%y)
        if (.not. self%seen%speed > 0) then
            call check_rest(self, stepper%formulation, stepper%t, stepper%y)
            return
        end if
        self%is_resting = .false.
        associate (speed => self%seen%speed, slowing => self%seen%slowing, is_fixed => stepper%controls%steps > 0)
            allowed = nearly_still * self%largest
            if (is_fixed) allowed = max(allowed, slowing * stepper%h)
            if (.not. (slowing > 0 .and. speed <= allowed)) return
            if (.not. (stepper%formulation%action%may_stick .or. self%seen%across <= rounding * self%largest)) return
            left = min(speed / slowing, t_end - stepper%t)
            y = stepper%formulation%action%at_rest(stepper%t + left, stepper%y, left)
            call check_rest(self, stepper%formulation, stepper%t + left, y)
            if (self%is_resting .or. .not. is_fixed) stepper%y = y
            is_stopped = .not. is_fixed
        end associate
        self%seen%t = -1
        if (.not. is_stopped) return
        stepper%t = stepper%t + left
        stepper%rest = 0
    end subroutine detect_rest

end module spintop_sticking
