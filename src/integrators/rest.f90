!> Steps of a body with effects whose right-hand side is not smooth everywhere: steps end at knots of torques and where
!> dry friction brings the body to rest; there it lies until other torques exceed the friction; and where the motion
!> has no Taylor series, a Runge-Kutta step leads on.
module spintop_rest
    use spintop_archive, only: archive_t
    use spintop_dop853, only: dop853_t
    use spintop_dop853_table, only: dop853_table
    use spintop_event, only: occasion_none, occasion_slip, occasion_stuck
    use spintop_formulation, only: formulation_t, max_states, structure_none, structure_series
    use spintop_kinds, only: dp
    use spintop_status, only: status_non_finite, status_ok, status_step_too_small
    use spintop_lying, only: lying_t
    use spintop_motions, only: instants
    use spintop_reversals, only: end_before_reversal, end_step, may_reverse
    use spintop_stepper, only: method_info_t, stepper_t
    implicit none
    private
    public :: rest_t

    !> What happens beside the steps of the method.
    type :: rest_t
        !> Whether the body lies still, since the time `t_stuck`, s.
        logical :: is_resting = .false.
        real(dp) :: t_stuck = 0
        !> What happened at the end of the last step: the body came to rest, or began to move.
        integer :: occasion = occasion_none
        !> Whether the last step was one of another stepper, and that stepper.
        logical :: is_other = .false.
        class(stepper_t), allocatable :: stepper
        !> Whether the next step must be one of another stepper: at its beginning there is no series.
        logical, private :: leads_on = .false.
        !> Whether the angular velocity surely kept its direction, and more than half of its magnitude, in the last step.
        logical, private :: goes_on = .false.
        !> Largest angular velocity so far, rad/s, and deceleration, rad/s^2, where it was looked at.
        real(dp), private :: largest = 0, steepest = 0
        !> What `find_slowing` found last, and when, s: the end of a step is the beginning of the next.
        real(dp), private :: seen_at = -1, seen_speed = 0, seen_slowing = 0, seen_across = 0
    contains
        procedure :: begin
        procedure :: advance
        procedure :: settle
        procedure :: carry
        procedure, private :: advance_by_other
        procedure, private :: lead_on
        procedure, private :: check_rest
        procedure, private :: find_slowing
        procedure, private :: latest_end
        procedure, private :: check_direction
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
    !> Tolerance of the steps where there is no series, if that of the method is not smaller; and the smallest, for steps in
    !> double precision.
    real(dp), parameter :: crossing_tolerance = 1.0e-12_dp, finest_tolerance = 1.0e-14_dp
    !> Part of its own first step that the other stepper takes: its estimate may not see what a bend in the step errs.
    real(dp), parameter :: first_part = 0.1_dp

contains

    !> Looks at the start.
    subroutine begin(self, formulation, stepper)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(stepper_t), intent(in) :: stepper !! the method, at the start
        real(dp) :: speed, slowing, across
        call formulation%action%find_speed(stepper%t, stepper%y, speed, slowing, across)
        self%largest = speed
        if (.not. speed > 0) call self%check_rest(formulation, stepper%t, stepper%y)
    end subroutine begin

    !> The angular velocity and how fast it decreases; zero where nothing depends on its direction: without dry friction, but
    !> for series under a drag, which end near where the motion turns.
    subroutine find_slowing(self, formulation, stepper, t, y, speed, slowing)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        class(stepper_t), intent(in) :: stepper
        real(dp), intent(in) :: t, y(max_states)
        real(dp), intent(out) :: speed, slowing
        real(dp) :: across
        if (.not. abs(t - self%seen_at) > 0) then
            speed = self%seen_speed
            slowing = self%seen_slowing
            return
        end if
        call formulation%action%find_speed(t, y, speed, slowing, across)
        self%largest = max(self%largest, speed)
        self%steepest = max(self%steepest, slowing)
        if (.not. (formulation%action%may_stick &
                   .or. (needs_series(stepper) .and. slowing > turning * self%steepest))) slowing = 0
        self%seen_at = t
        self%seen_speed = speed
        self%seen_slowing = slowing
        self%seen_across = across
    end subroutine find_slowing

    !> The time up to which a step from a state may reach: half of that to rest.
    real(dp) function latest_end(self, formulation, stepper, t, y)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        class(stepper_t), intent(in) :: stepper
        real(dp), intent(in) :: t, y(max_states)
        real(dp) :: speed, slowing
        latest_end = huge(t)
        call self%find_slowing(formulation, stepper, t, y, speed, slowing)
        if (slowing > 0 .and. speed > 0) latest_end = t + share * speed / slowing
    end function latest_end

    !> Notes whether the angular velocity, and the velocity on which drag depends, are far from any reversal in a step by series:
    !> they change by less than `share` of their magnitude, as all terms of its series together are less. Then the step is also
    !> shorter than that to `latest_end`.
    subroutine check_direction(self, formulation, stepper)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        class(stepper_t), intent(inout) :: stepper
        real(dp) :: span, change(max_states), speed, reach, narrowest, speed_now
        logical :: is_known

        call stepper%bound_changes(change, is_known)
        self%goes_on = .false.
        if (.not. is_known) return
        span = stepper%t - stepper%t_last
        call formulation%action%find_reach(stepper%t_last, stepper%y_last, span, change, speed, reach, narrowest)
        self%goes_on = reach < share * min(speed, narrowest)
        if (.not. self%goes_on .and. narrowest >= 0 .and. reach < share * speed) self%goes_on = .not. turns_back()
        if (.not. self%goes_on) return
        call formulation%action%find_reach(stepper%t, stepper%y, 0.0_dp, change, speed_now, reach, narrowest)
        self%largest = max(self%largest, speed, speed_now)
        self%steepest = max(self%steepest, (speed - speed_now) / span)

    contains

        !> Whether the velocity on which drag depends reverses.
        logical function turns_back()
            real(dp) :: t(0:instants), y(0:instants, max_states)
            integer :: i
            t = stepper%t_last + span * [(real(i, dp) / instants, i=0, instants)]
            y(0, :) = stepper%y_last
            call stepper%states_within(formulation, t(1:), y(1:, :))
            turns_back = formulation%action%drag_turns(t, y)
        end function turns_back

    end subroutine check_direction

    !> Whether a method steps by series.
    pure logical function needs_series(stepper)
        class(stepper_t), intent(in) :: stepper
        needs_series = stepper%info%needs /= structure_none .and. stepper%controls%steps == 0
    end function needs_series

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

    !> Takes a step, by the method or by another stepper.
    subroutine advance(self, formulation, stepper, status)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(stepper_t), intent(inout) :: stepper !! the method
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: t_end
        logical :: may_turn, looks_back

        self%is_other = self%is_resting
        self%goes_on = .false.
        if (self%is_resting) then
            if (allocated(self%stepper)) deallocate (self%stepper)
            allocate (lying_t :: self%stepper)
            self%stepper%controls = stepper%controls
            call self%advance_by_other(formulation, stepper, 1.0_dp, status)
            return
        end if
        ! Whether the step is looked at when it is done, which is cheap; its state can be had at any time in double precision.
        may_turn = formulation%action%may_turn .and. needs_series(stepper)
        looks_back = may_turn .and. stepper%info%needs == structure_series .and. .not. formulation%action%may_stick
        t_end = stepper%t_end
        if (stepper%controls%steps == 0) then
            stepper%t_end = min(t_end, formulation%action%next_knot(stepper%t))
            if (formulation%action%may_stick .or. (may_turn .and. .not. looks_back)) then
                stepper%t_end = min(stepper%t_end, self%latest_end(formulation, stepper, stepper%t, stepper%y))
            end if
        end if
        if (self%leads_on) then
            call self%lead_on(formulation, stepper, status)
        else
            call stepper%advance(formulation, status)
            if (needs_series(stepper)) call keep_direction()
            if (needs_series(stepper) .and. (status == status_non_finite .or. status == status_step_too_small)) then
                call self%lead_on(formulation, stepper, status)
            end if
        end if
        stepper%t_end = t_end

    contains

        !> Ends a step by series before the body comes to rest or reverses.
        subroutine keep_direction()
            real(dp) :: latest, y(max_states)
            if (looks_back) then
                if (status == status_ok) call self%check_direction(formulation, stepper)
                if (self%goes_on) return
                if (status == status_ok) then
                    latest = self%latest_end(formulation, stepper, stepper%t_last, stepper%y_last)
                    if (latest < stepper%t) then
                        y = stepper%state_within(formulation, latest)
                        call end_step(formulation, stepper, latest, y, status)
                    end if
                else
                    stepper%t_end = min(stepper%t_end, self%latest_end(formulation, stepper, stepper%t, stepper%y))
                end if
            end if
            if (status /= status_ok) return
            if (.not. may_reverse(formulation, stepper)) return
            call end_before_reversal(formulation, stepper, self%leads_on, status)
        end subroutine keep_direction

    end subroutine advance

    !> Takes a Runge-Kutta step, where there is no series.
    subroutine lead_on(self, formulation, stepper, status)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        class(stepper_t), intent(in) :: stepper
        integer, intent(out) :: status
        self%leads_on = .false.
        self%is_other = .true.
        if (allocated(self%stepper)) deallocate (self%stepper)
        allocate (self%stepper, source=dop853_t(table=dop853_table(), info=method_info_t('dop853')))
        associate (own => self%stepper%controls, given => stepper%controls)
            own%relative_tolerance = max(finest_tolerance, min(crossing_tolerance, given%relative_tolerance))
            own%absolute_tolerance = max(finest_tolerance, min(crossing_tolerance, given%absolute_tolerance))
        end associate
        call self%advance_by_other(formulation, stepper, first_part, status)
    end subroutine lead_on

    !> Takes a step of the other stepper from the state of the method: a part of its first step, if the size is its own.
    subroutine advance_by_other(self, formulation, stepper, part, status)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        class(stepper_t), intent(in) :: stepper
        real(dp), intent(in) :: part
        integer, intent(out) :: status
        self%stepper%t_begin = stepper%t_begin
        self%stepper%t_end = stepper%t_end
        self%stepper%t = stepper%t
        self%stepper%y = stepper%y
        self%stepper%grid = stepper%grid
        self%stepper%counts = stepper%counts
        call self%stepper%begin(formulation, status)
        self%stepper%h = part * self%stepper%h
        if (status == status_ok) call self%stepper%advance(formulation, status)
    end subroutine advance_by_other

    !> Takes the state of another stepper over, and finds out whether the body comes to rest, or begins to move.
    subroutine settle(self, formulation, stepper, status)
        class(rest_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(stepper_t), intent(inout) :: stepper !! the method
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: speed, slowing, left, allowed
        logical :: begins, was_resting

        was_resting = self%is_resting
        begins = self%is_other
        if (self%is_other) then
            stepper%t = self%stepper%t
            stepper%y = self%stepper%y
            stepper%grid = self%stepper%grid
            stepper%counts = self%stepper%counts
            stepper%rest = 0
            self%is_other = .false.
        end if
        if (formulation%action%may_stick .or. &
            (formulation%action%may_turn .and. needs_series(stepper) .and. .not. self%goes_on)) then
            call self%find_slowing(formulation, stepper, stepper%t, stepper%y, speed, slowing)
            if (speed > 0) then
                self%is_resting = .false.
                allowed = nearly_still * self%largest
                if (stepper%controls%steps > 0) allowed = max(allowed, slowing * stepper%h)
                if (slowing > 0 .and. speed <= allowed .and. &
                    (formulation%action%may_stick .or. self%seen_across <= rounding * self%largest)) then
                    left = min(speed / slowing, stepper%t_end - stepper%t)
                    call stop_at_rest(left)
                end if
            else
                call self%check_rest(formulation, stepper%t, stepper%y)
            end if
        end if
        self%occasion = occasion_none
        if (self%is_resting .and. .not. was_resting) self%occasion = occasion_stuck
        if (was_resting .and. .not. self%is_resting) self%occasion = occasion_slip
        if (begins .and. .not. self%is_resting .and. stepper%t < stepper%t_end) call stepper%begin(formulation, status)

    contains

        !> Brings the body to rest after `left` seconds; with a fixed step size only where friction holds it.
        subroutine stop_at_rest(left)
            real(dp), intent(in) :: left
            real(dp) :: y(max_states)
            self%seen_at = -1
            y = formulation%action%at_rest(stepper%t + left, stepper%y, left)
            call self%check_rest(formulation, stepper%t + left, y)
            if (stepper%controls%steps > 0) then
                if (self%is_resting) stepper%y = y
                return
            end if
            stepper%t = stepper%t + left
            stepper%y = y
            stepper%rest = 0
            begins = .true.
        end subroutine stop_at_rest

    end subroutine settle

    !> Carries the state at the end of a step: there is no other stepper then.
    subroutine carry(self, archive)
        class(rest_t), intent(inout) :: self
        type(archive_t), intent(inout) :: archive !! stores the state, or gives it back
        call archive%carry(self%is_resting)
        call archive%carry(self%t_stuck)
        call archive%carry(self%occasion)
        call archive%carry(self%leads_on)
        call archive%carry(self%largest)
        call archive%carry(self%steepest)
        call archive%carry(self%seen_at)
        call archive%carry(self%seen_speed)
        call archive%carry(self%seen_slowing)
        call archive%carry(self%seen_across)
    end subroutine carry

end module spintop_rest
