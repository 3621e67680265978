!> Integrates a motion from its start to the end of the span, and passes it to an observer.
module spintop_integration
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_event, only: occasion_knot, occasion_none
    use spintop_events, only: event_watch_t
    use spintop_motion, only: motion_t
    use spintop_observer, only: observer_t
    use spintop_rest, only: rest_t
    use spintop_step_path, only: follower_t, step_path_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_stepper, only: stepper_t, workspace_t, counts_t
    use spintop_work_account, only: work_account_t
    use spintop_suitability, only: call_status
    use spintop_status, only: status_ok, status_at_rest, status_outside, status_step_too_small, &
        status_step_limit, status_turning_point, status_not_converged, status_too_many_events
    implicit none
    private
    public :: integrate, observer_t, outcome_t

    !> A run in progress: formulation, stepper, workspace, and the samples not yet shown.
    type :: run_t
        class(formulation_t), pointer :: formulation => null()
        class(stepper_t), pointer :: stepper => null()
        class(workspace_t), pointer :: work => null()
        class(observer_t), pointer :: observer => null()
        real(dp), pointer :: samples(:) => null()
        !> Index of the first sample that was not shown, and the number of samples.
        integer :: next = 1, last = 0
        !> Time of the last motion that was shown, s.
        real(dp) :: shown = -1
        type(follower_t) :: follower
        !> Rest under dry friction and breaks of the right-hand side, and the work of effects; of no use without these.
        type(rest_t) :: rest
        type(work_account_t) :: account
    contains
        procedure :: begin => begin_run
        procedure :: take_step
        procedure :: end_step
        procedure :: look_for_events
        procedure :: look_to_knots
        procedure :: meet_occasion
        procedure :: show_until
        procedure :: show_end
        procedure :: show_within
        procedure :: show
        procedure :: leave_rest
        procedure :: show_departure
        procedure :: check_arrival
    end type run_t

    !> Outcome of a run.
    type :: outcome_t
        !> `status_ok`, or the reason for an early end, from `spintop_status`.
        integer :: status = status_ok
        !> Time reached, s: that of the event that ended the run, if there was one.
        real(dp) :: t = 0
        !> With `status_at_rest` the time at which dry friction stopped the body, s.
        real(dp) :: t_stuck = 0
        !> Cost of the run.
        type(counts_t) :: counts
    end type outcome_t

    !> With less than this share of the time gone left, a run arrives at the end of its equations;
    !> with less than `close`, one that is stuck has arrived too. Shares of the span would be none of the
    !> motion, which may be as much shorter as one likes.
    real(dp), parameter :: arrival = 1.0e-4_dp, close = 1.0e-2_dp
    !> A sample of a fixed-step method within this fraction of a step is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp

contains

    !> Integrates a formulation from its start over `t_end` seconds. The observer receives the motion at the
    !> sample times (increasing, from 0 to t_end): an adaptive method has dense output for all of them, a
    !> fixed-step method gives those that are steps. If the equations end at a turning point, the observer
    !> receives that too. `watch` searches for events; the motion at an event that ends the run is shown last.
    !>
    !> The arguments are checked first (`call_status`, `event_watch_t%check`). An invalid call returns the
    !> reason as status, and the observer receives nothing.
    subroutine integrate(formulation, stepper, body, start, t_end, samples, observer, outcome, watch)
        class(formulation_t), target, intent(inout) :: formulation
            !! the equations of motion; prepared by this procedure
        class(stepper_t), target, intent(in) :: stepper !! the method with its settings
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end !! length of the span, s
        real(dp), target, intent(in) :: samples(:) !! s after the start, whatever its `t`
        class(observer_t), target, intent(inout) :: observer !! receives the motion
        type(outcome_t), intent(out) :: outcome !! status, time reached and cost
        class(event_watch_t), intent(inout), optional :: watch !! search for events
        class(workspace_t), allocatable, target :: work
        type(run_t), target :: run
        type(step_path_t) :: path
        integer :: status
        logical :: ends

        outcome%status = call_status(stepper, formulation, body, start, t_end, samples)
        if (outcome%status == status_ok .and. present(watch)) outcome%status = watch%check()
        if (outcome%status /= status_ok) return
        ends = .false.
        call stepper%new_workspace(work)
        work%t_end = t_end
        run%formulation => formulation
        run%stepper => stepper
        run%work => work
        run%observer => observer
        run%samples => samples
        run%last = size(samples)
        call run%begin(body, start, path, status, watch)
        do while (status == status_ok .and. work%t < t_end .and. .not. observer%has_enough)
            if (work%is_spent(stepper%controls%max_steps)) then
                status = status_step_limit
                exit
            end if
            if (allocated(formulation%action)) then
                call run%take_step(path, status)
            else
                call stepper%advance(formulation, work, status)
            end if
            if (status == status_ok .and. present(watch)) then
                call run%look_for_events(path, watch, status, ends)
                if (ends) exit
            end if
            if (status == status_ok) call run%show_until(run%work%t)
            call run%check_arrival(status)
            if (allocated(formulation%action)) call run%end_step(stepper, work, path, status, ends, watch)
            if (ends) exit
        end do
        outcome%status = status
        outcome%t = run%work%t
        if (run%rest%is_resting .and. status == status_ok .and. .not. ends) outcome%status = status_at_rest
        outcome%t_stuck = run%rest%t_stuck
        if (ends) outcome%t = watch%t
        outcome%counts = work%counts
    end subroutine integrate

    !> Begins the run: the state at the start, the samples there, and the search for events.
    subroutine begin_run(self, body, start, path, status, watch)
        class(run_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        type(step_path_t), intent(inout) :: path !! the path that `watch` searches
        integer, intent(out) :: status
        class(event_watch_t), intent(inout), optional :: watch
        logical :: is_idle

        associate (formulation => self%formulation, stepper => self%stepper, work => self%work)
            call formulation%prepare(body, start, work%y, status)
            if (status == status_ok) call check_start(formulation, work, status)
            if (status /= status_ok) return
            call work%projection%begin(stepper%controls%project, formulation, work%y)
            if (allocated(formulation%action)) then
                call self%rest%begin(formulation, work)
                self%account%is_open = self%observer%wants_work .and. formulation%action%does_work
            end if
            is_idle = .not. self%observer%counts_turns
            if (present(watch)) is_idle = is_idle .and. .not. watch%needs_turns
            self%follower = follower_t(0.0_dp, work%y, start%angle, is_idle)
            call self%show_until(0.0_dp)
            call self%leave_rest()
            call stepper%begin(formulation, work, status)
            call self%show_until(work%t)
            if (.not. present(watch)) return
            path%formulation => self%formulation
            path%stepper => self%stepper
            path%work => self%work
            call watch%begin(body, formulation%motion(work%t, work%y, self%follower%angle))
        end associate
    end subroutine begin_run

    !> Takes a step of a body with effects: at rest, across a point without a series, or by the method itself. Run and
    !> path have the stepper that took it.
    subroutine take_step(self, path, status)
        class(run_t), target, intent(inout) :: self
        type(step_path_t), intent(inout) :: path
        integer, intent(out) :: status
        call self%rest%advance(self%formulation, self%stepper, self%work, status)
        if (.not. self%rest%is_other) return
        self%stepper => self%rest%stepper
        self%work => self%rest%work
        path%stepper => self%stepper
        path%work => self%work
    end subroutine take_step

    !> Ends such a step: the work up to there, and whether the body has come to rest, which may end the run. After a
    !> step of another stepper the method begins anew.
    subroutine end_step(self, stepper, work, path, status, ends, watch)
        class(run_t), intent(inout) :: self
        class(stepper_t), target, intent(in) :: stepper !! the method
        class(workspace_t), target, intent(inout) :: work !! its workspace
        type(step_path_t), intent(inout) :: path
        integer, intent(inout) :: status
        logical, intent(out) :: ends
        class(event_watch_t), intent(inout), optional :: watch
        ends = .false.
        if (status == status_ok .and. self%account%is_open) then
            call self%account%go_to(self%formulation, self%stepper, self%work, self%work%t)
        end if
        self%stepper => stepper
        self%work => work
        path%stepper => stepper
        path%work => work
        if (status == status_ok) call self%rest%settle(self%formulation, stepper, work, status)
        if (status == status_ok .and. self%rest%occasion /= occasion_none) call self%meet_occasion(ends, watch)
    end subroutine end_step

    !> Meets the events of rest and departure at the end of a step. The work of the last instant before rest, the square
    !> of a negligible angular velocity, is zero.
    subroutine meet_occasion(self, ends, watch)
        class(run_t), intent(inout) :: self
        logical, intent(out) :: ends
        class(event_watch_t), intent(inout), optional :: watch
        ends = .false.
        associate (work => self%work)
            self%account%t = max(self%account%t, work%t)
            if (work%t > self%follower%t) call self%follower%go_to(self%formulation, work%t, work%y)
            if (present(watch)) then
                call watch%happen(self%rest%occasion, self%formulation%motion(work%t, work%y, self%follower%angle))
                ends = watch%has_enough
            end if
            if (self%shown < work%t .and. (ends .or. .not. work%t < work%t_end)) call self%show()
        end associate
    end subroutine meet_occasion

    !> Looks for events in the last step. The run ends at one that ends the motion, or as far as the
    !> steps that are allowed suffice for the search, and the events that can be counted.
    subroutine look_for_events(self, path, watch, status, ends)
        class(run_t), intent(inout) :: self
        type(step_path_t), intent(inout) :: path
        class(event_watch_t), intent(inout) :: watch
        integer, intent(inout) :: status
        logical, intent(out) :: ends
        path%seen = self%follower
        if (allocated(self%formulation%action) .and. watch%knows(occasion_knot)) call self%look_to_knots(path, watch)
        if (.not. watch%has_enough) call watch%look(path, self%work%t)
        ends = watch%has_enough
        if (.not. ends .and. (path%is_spent() .or. watch%is_full) .and. watch%t < self%work%t) then
            status = merge(status_too_many_events, status_step_limit, watch%is_full)
            ends = .true.
        end if
        if (ends) call self%show_end(watch%t)
    end subroutine look_for_events

    !> Looks for events up to each row of a table of torques in the last step, and meets those of the row.
    subroutine look_to_knots(self, path, watch)
        class(run_t), intent(inout) :: self
        type(step_path_t), intent(inout) :: path
        class(event_watch_t), intent(inout) :: watch
        type(motion_t) :: motion
        real(dp) :: knot
        do while (.not. watch%has_enough)
            knot = self%formulation%action%next_knot(watch%t)
            if (knot > self%work%t) exit
            call watch%look(path, knot)
            if (watch%has_enough .or. watch%t < knot) exit
            call path%at(knot, motion)
            call watch%happen(occasion_knot, motion)
        end do
    end subroutine look_to_knots

    !> Shows the samples up to a time within the last step.
    subroutine show_until(self, t)
        class(run_t), intent(inout) :: self
        real(dp), intent(in) :: t
        real(dp) :: slack
        associate (samples => self%samples, next => self%next, work => self%work, steps => self%stepper%controls%steps)
            slack = 0
            if (steps > 0) slack = grid_slack * work%t_end / steps
            do while (next <= self%last .and. .not. self%observer%has_enough)
                if (samples(next) > t + slack) exit
                if (abs(samples(next) - t) <= slack) then
                    call self%follower%walk_to(self%formulation, self%stepper, work, work%t, work%y)
                    call self%show()
                else if (steps == 0) then
                    call self%show_within(samples(next))
                end if
                next = next + 1
            end do
            call self%follower%walk_to(self%formulation, self%stepper, work, work%t, work%y)
        end associate
    end subroutine show_until

    !> Shows the remaining samples, and the end, of a run that ends within the last step.
    subroutine show_end(self, t)
        class(run_t), intent(inout) :: self
        real(dp), intent(in) :: t
        do while (self%next <= self%last .and. .not. self%observer%has_enough)
            if (self%samples(self%next) >= t) exit
            if (self%stepper%controls%steps == 0) call self%show_within(self%samples(self%next))
            self%next = self%next + 1
        end do
        call self%show_within(t)
    end subroutine show_end

    !> Shows the motion at a time within the last step.
    subroutine show_within(self, t)
        class(run_t), intent(inout) :: self
        real(dp), intent(in) :: t
        call self%follower%walk_to(self%formulation, self%stepper, self%work, t, &
                                   self%stepper%interpolate(self%formulation, self%work, t))
        call self%show()
    end subroutine show_within

    !> Shows the motion at the time of the follower.
    subroutine show(self)
        class(run_t), intent(inout) :: self
        if (self%account%is_open) then
            call self%account%go_to(self%formulation, self%stepper, self%work, self%follower%t)
            self%observer%work = self%account%total
        end if
        call self%observer%observe(self%formulation, self%follower%t, self%follower%y, self%follower%angle)
        self%shown = self%follower%t
    end subroutine show

    !> Checks that the derivative exists at the start.
    subroutine check_start(formulation, work, status)
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        integer, intent(out) :: status
        real(dp) :: slope(max_states)
        call work%evaluate(formulation, work%t, work%y, slope, status)
    end subroutine check_start

    !> Leaves a start at which the right-hand side vanishes although the motion does not rest: by the first
    !> step of a fixed-step method, or by a short time before an adaptive one begins.
    subroutine leave_rest(self)
        class(run_t), intent(inout) :: self
        real(dp) :: h, y(max_states)
        logical :: departed

        if (.not. allocated(self%formulation%ends)) return
        associate (work => self%work, steps => self%stepper%controls%steps)
            h = 0
            if (steps > 0) h = work%t_end / steps
            y = work%y
            call self%formulation%ends%depart(y, h, departed)
            if (.not. departed) return
            if (h > work%t_end) then
                h = work%t_end
                y = work%y
                call self%formulation%ends%depart(y, h, departed)
            end if
            do while (steps == 0 .and. self%next <= self%last .and. .not. self%observer%has_enough)
                if (self%samples(self%next) >= h) exit
                call self%show_departure(self%samples(self%next))
                self%next = self%next + 1
            end do
            work%y = y
            work%t = h
            work%grid = 1
            work%counts%steps = 1
        end associate
    end subroutine leave_rest

    !> Shows the motion at a time shortly after such a start.
    subroutine show_departure(self, t)
        class(run_t), intent(inout) :: self
        real(dp), intent(in) :: t
        real(dp) :: time, y_then(max_states)
        logical :: unused
        time = t
        y_then = self%work%y
        call self%formulation%ends%depart(y_then, time, unused)
        call self%follower%go_to(self%formulation, t, y_then)
        call self%show()
    end subroutine show_departure

    !> Ends a run that is close to the end of its equations: at the turning point, not beyond.
    subroutine check_arrival(self, status)
        class(run_t), intent(inout) :: self
        integer, intent(inout) :: status
        real(dp) :: left, y(max_states)

        if (.not. allocated(self%formulation%ends)) return
        associate (formulation => self%formulation, work => self%work)
            left = formulation%ends%time_left(work%y)
            select case (status)
            case (status_ok)
                if (left > arrival * work%t) return
            case (status_outside, status_step_too_small, status_not_converged)
                if (left > close * work%t) return
            case default
                return
            end select
            y = work%y
            call formulation%ends%arrive(y, left)
            if (work%t + left > work%t_end) return
            work%y = y
            work%t = work%t + left
            status = status_turning_point
            call self%follower%go_to(formulation, work%t, work%y)
            call self%show()
        end associate
    end subroutine check_arrival

end module spintop_integration
