!> Rest of a body with effects: where its angular velocity vanishes, dry friction holds it if it can balance the other torques.
!> Then it keeps its attitude until other torques exceed the friction.
!>
!> Friction has the direction of the angular velocity, so f jumps where that vanishes. A step towards rest ends half-way there,
!> as far as the deceleration tells, until what is left of the angular velocity is negligible.
module spintop_rest
    use spintop_effects_action, only: turning_t
    use spintop_fixed_step, only: grid_time
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_status, only: status_ok
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: rest_t, resting_t

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

    !> Rest: the attitude is kept.
    type, extends(stepper_t) :: resting_t
    contains
        procedure :: begin => begin_rest
        procedure :: advance => lie
        procedure :: state_within
    end type resting_t

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

    !> Brings the body to rest in its attitude.
    subroutine begin_rest(self, status)
        class(resting_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        self%y = self%formulation%action%at_rest(self%t, self%y, 0.0_dp)
        self%slope = 0
        status = status_ok
    end subroutine begin_rest

    !> Rests until the torques exceed the friction, or to the end; with a fixed step size over one step.
    subroutine lie(self, status)
        class(resting_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: t, peak

        t = self%t_end
        if (self%formulation%action%may_slip) then
            t = min(t, self%t + self%formulation%action%pause(self%t))
            peak = t
            if (.not. excess(self%formulation, self%y, t) > 0) peak = highest(self%formulation, self%y, self%t, t)
            if (excess(self%formulation, self%y, peak) > 0) t = root(self%formulation, self%y, self%t, peak)
        end if
        if (self%controls%steps > 0) then
            self%grid = self%grid + 1
            t = grid_time(self)
        end if
        self%t_last = self%t
        self%y_last = self%y
        self%y = self%formulation%action%at_rest(t, self%y, 0.0_dp)
        self%t = t
        self%counts%steps = self%counts%steps + 1
        status = status_ok
    end subroutine lie

    !> By how much the torques exceed the friction at a time, N m, with the attitude of a state.
    real(dp) function excess(formulation, y, time)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), time
        excess = formulation%action%excess(time, formulation%action%at_rest(time, y, 0.0_dp))
    end function excess

    !> The time between two times at which they exceed it most, by golden sections; the later one where a parabola has no peak
    !> between them that may reach the friction.
    real(dp) function highest(formulation, y, before, after)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), before, after
        real(dp), parameter :: golden = 0.61803398874989485_dp, resolved = 1.0e-8_dp
        real(dp) :: low, high, x(2), f(2), ends(2), middle, bend

        highest = after
        ends = [excess(formulation, y, before), excess(formulation, y, after)]
        middle = excess(formulation, y, before + (after - before) / 2)
        bend = 2 * middle - sum(ends)
        if (.not. abs(ends(2) - ends(1)) < 2 * bend .or. middle + bend < 0) return
        low = before
        high = after
        x = [high - golden * (high - low), low + golden * (high - low)]
        f = [excess(formulation, y, x(1)), excess(formulation, y, x(2))]
        do while (high - low > resolved * (after - before))
            if (f(1) < f(2)) then
                low = x(1)
                x = [x(2), low + golden * (high - low)]
                f = [f(2), excess(formulation, y, x(2))]
            else
                high = x(2)
                x = [high - golden * (high - low), x(1)]
                f = [excess(formulation, y, x(1)), f(1)]
            end if
            if (.not. (x(1) > low .and. x(2) < high)) exit
        end do
        highest = x(merge(1, 2, f(1) > f(2)))
    end function highest

    !> The first time at which they exceed it between two times, of which they do at the second, by bisection, just beyond.
    real(dp) function root(formulation, y, before, after)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), before, after
        real(dp) :: low, middle
        low = before
        root = after
        do
            middle = low + (root - low) / 2
            if (.not. (middle > low .and. middle < root)) exit
            if (excess(formulation, y, middle) > 0) then
                root = middle
            else
                low = middle
            end if
        end do
    end function root

    !> The state at rest.
    function state_within(self, t) result(y)
        class(resting_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        y = self%formulation%action%at_rest(t, self%y_last, 0.0_dp)
    end function state_within

end module spintop_rest
