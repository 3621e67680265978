!> Integrates a motion from its start to the end of the span, and passes it to an observer: steps, the samples that are shown,
!> and the search for events. Within the last step the motion is that of dense output, with angles that are followed through every
!> turn, and the work of effects along it.
module spintop_integration
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_body, only: body_t
    use spintop_caller, only: stop_is_wanted
    use spintop_event, only: find_noise_of_steps, margin, noise_of_tolerance, occasion_knot, occasion_none
    use spintop_events, only: event_search_t, path_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp, no_number
    use spintop_loads, only: works
    use spintop_methods, only: call_status
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t
    use spintop_segments, only: segments_t
    use spintop_status, only: is_ok, status_at_rest, status_not_converged, status_ok, status_outside, &
        status_step_limit, status_step_too_small, status_too_many_events, status_turning_point
    use spintop_stepper, only: counts_t, project_invariants, stepper_t
    use spintop_turn_counter, only: new_turn_counter, turn_counter_t
    implicit none
    private
    public :: integrate, observer_t, outcome_t, follower_t, follow_from, go_to

    !> Receives the motion at the sample times.
    type, abstract :: observer_t
        !> Set by the observer to end the run.
        logical :: has_enough = .false.
        !> Whether phi and psi count their turns, which requires an evaluation in every step; otherwise the
        !> angles are the values nearest to those of the start.
        logical :: counts_turns = .true.
        !> Whether the end of each step is observed too.
        logical :: sees_steps = .false.
        !> Whether the work of effects is wanted; then it is set before each motion is observed, J, by its parts.
        logical :: wants_work = .false.
        real(dp) :: work(works) = 0
        !> Where the body was given in other axes, the angles there, set before each motion is observed, rad.
        real(dp) :: given_angle(3) = 0
    contains
        procedure(observe), deferred :: observe
    end type observer_t

    abstract interface
        !> Receives the state `y` of a formulation at time `t`, and angles near those of the motion. The times
        !> are increasing.
        subroutine observe(self, formulation, t, y, near)
            import :: observer_t, formulation_t, dp, max_states
            class(observer_t), intent(inout) :: self
            class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
            real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        end subroutine observe
    end interface

    !> The work since the start.
    type :: work_account_t
        !> Whether work is counted.
        logical :: is_open = .false.
        !> Time up to which it is counted, s, and the work until then by its parts, J.
        real(dp) :: t = 0, total(works) = 0
        !> Compensation term of the sums (Kahan).
        real(dp), private :: rest(works) = 0
    contains
        procedure :: go_to => count_until
    end type work_account_t

    !> Nodes and weights of the Gauss-Legendre rule of 8 points on [-1, 1]. The series of a Taylor step converges over nearly
    !> twice its length, so the error is at the level of rounding.
    integer, parameter :: pairs = instants / 2
    real(dp), parameter :: positive(pairs) = [ &
        0.18343464249564980494_dp, 0.52553240991632898582_dp, 0.79666647741362673959_dp, 0.96028985649753623168_dp]
    real(dp), parameter :: node(instants) = [positive, -positive]
    real(dp), parameter :: weight(pairs) = [ &
        0.36268378337836198297_dp, 0.31370664587788728734_dp, 0.22238103445337447054_dp, 0.10122853629037625915_dp]

    !> The angles, followed through every step, or constant.
    type :: follower_t
        real(dp) :: t = 0, y(max_states) = 0
        !> Angles near those of the motion in the axes of the computation, rad.
        real(dp) :: near(3) = 0
        type(turn_counter_t) :: turns
        !> Whether the last instant of these is complete, with the angular acceleration, for a body that may meet a pole.
        logical :: knows_rate = .false.
        logical :: is_idle = .false.
        class(formulation_t), pointer :: formulation => null()
    end type follower_t

    !> The motion within the last step, by dense output.
    type, extends(path_t) :: step_path_t
        class(stepper_t), pointer :: stepper => null()
        !> The work of effects up to the start of the step, if it is wanted.
        type(work_account_t), pointer :: account => null()
        !> Angles at the start of the step, and at the two latest times of evaluation. They are followed to a
        !> new time from the latest of these before it.
        type(follower_t) :: seen(3)
    contains
        procedure :: at => motion_in_step
        procedure :: at_several => attitudes_in_step
        procedure :: begin_step
        procedure :: work_until => work_in_step
        procedure :: is_spent => step_is_spent
    end type step_path_t

    !> A pole that is passed within this fraction of a step is passed on an arbitrary side.
    real(dp), parameter :: shortest_pace = 1.0e-12_dp

    !> A run in progress: formulation, stepper, and the samples not yet shown.
    type :: run_t
        !> The method, and what steps through the segment: the method, or what leads on where f is not smooth.
        class(stepper_t), pointer :: method => null(), stepper => null()
        class(observer_t), pointer :: observer => null()
        !> The search for events, if there is one, along the last step.
        class(event_search_t), pointer :: search => null()
        type(step_path_t), allocatable :: path
        real(dp), pointer :: samples(:) => null()
        !> Index of the first sample that was not shown, and the number of samples.
        integer :: next = 1, last = 0
        !> Time of the last motion that was shown, and from which on a step is one to look at, s: that of the next sample, or
        !> any if the angles are followed, or an observer or a search for events sees each step.
        real(dp) :: shown = -1, due = -huge(1.0_dp)
        !> How much a sample may lie behind the end of a step of a fixed-step method and be shown there, s.
        real(dp) :: slack = 0
        logical :: looks_at_steps = .true.
        type(follower_t) :: follower
        !> What a step adds to the error of the motion, rad, at the most.
        real(dp) :: error_of_step = 0
        !> The smooth segments of the motion of a body with effects, and the work of these.
        type(segments_t), allocatable :: segments
        type(work_account_t) :: account
    end type run_t

    !> With less than this share of the time gone left, a run arrives at the end of its equations;
    !> with less than `close`, one that is stuck has arrived too. Shares of the span would be none of the
    !> motion, which may be as much shorter as one likes.
    real(dp), parameter :: arrival = 1.0e-4_dp, close = 1.0e-2_dp
    !> A sample of a fixed-step method within this fraction of a step is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp

    !> Outcome of a run.
    type :: outcome_t
        !> `status_ok`, or the reason for an early end, from `spintop_status`.
        integer :: status = status_ok
        !> Time reached, s: that of the event that ended the run, if there was one.
        real(dp) :: t = 0
        !> Time at which dry friction stopped the body, if it is at rest in the end, s; NaN of a body that moves.
        real(dp) :: t_stuck = no_number
        !> How often body z passed a pole at a distance within the error of the motion: phi and psi may be off by whole turns,
        !> in the axes in which the body was given.
        integer :: doubtful_passages = 0
        !> Cost of the run.
        type(counts_t) :: counts
    contains
        procedure :: end_time
    end type outcome_t

contains

    !> Begins the run: the state at the start, the samples there, and the search for events.
    subroutine begin_run(self, body, start, status)
        type(run_t), target, intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: noise, noise_of_step, h
        logical :: is_idle

        associate (formulation => self%method%formulation, stepper => self%method)
            call formulation%prepare(body, start, stepper%y, status)
            if (.not. is_ok(status)) return
            if (stepper%controls%project == project_invariants) call formulation%invariants(stepper%y, stepper%invariants)
            if (allocated(formulation%action)) then
                self%account%is_open = self%observer%wants_work .and. formulation%action%does_work
            end if
            is_idle = .not. self%observer%counts_turns
            if (associated(self%search)) is_idle = is_idle .and. .not. self%search%needs_turns
            self%follower = follow_from(self%method%formulation, body, start, stepper%y, is_idle)
            noise = noise_of_tolerance(stepper%controls%relative_tolerance, stepper%info%share)
            noise_of_step = noise
            if (stepper%controls%steps > 0) then
                h = stepper%t_end / stepper%controls%steps
                self%slack = grid_slack * h
                call find_noise_of_steps(body, start, h, stepper%order(), noise_of_step, noise)
            end if
            self%error_of_step = margin * noise_of_step
            self%looks_at_steps = .not. is_idle .or. associated(self%search) .or. self%observer%sees_steps &
                                  .or. allocated(formulation%action)
            if (formulation%has_ends) call leave_rest(self, status)
            ! The derivative must exist at the start.
            if (is_ok(status)) call stepper%begin(status)
            if (.not. is_ok(status)) return
            call observe_until(self, stepper%t)
            if (allocated(formulation%action)) then
                allocate (self%segments)
                call self%segments%begin(stepper, self%stepper, status)
            end if
            if (.not. associated(self%search)) return
            allocate (self%path)
            if (self%account%is_open) self%path%account => self%account
            self%search%method_noise = noise
            call self%search%begin(body, motion_of_follower(self%follower), start)
        end associate
    end subroutine begin_run

    !> Ends a step of a body with effects: the work up to there, and whether the body has come to rest, which may end the run.
    subroutine end_step(self, status, ends)
        type(run_t), target, intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of an end (spintop_status)
        logical, intent(out) :: ends !! whether the run ends here
        ends = .false.
        if (self%account%is_open) call self%account%go_to(self%stepper, self%stepper%t)
        call self%segments%end_step(self%method, self%stepper, status)
        ! The work of a last instant before rest or reversal, the square of a negligible angular velocity, is zero.
        self%account%t = max(self%account%t, self%stepper%t)
        if (is_ok(status) .and. self%segments%passes_jump) call observe_until(self, self%stepper%t)
        if (is_ok(status) .and. self%segments%occasion /= occasion_none) call handle_occasion(self, ends)
    end subroutine end_step

    !> Handles the events of rest and departure at the end of a step.
    subroutine handle_occasion(self, ends)
        type(run_t), intent(inout) :: self
        logical, intent(out) :: ends !! whether the run ends here
        type(motion_t) :: motion
        ends = .false.
        associate (stepper => self%stepper)
            if (stepper%t > self%follower%t) call go_to(self%follower, stepper%t, stepper%y)
            if (associated(self%search)) then
                motion = self%method%formulation%motion(stepper%t, stepper%y, self%follower%near)
                motion%given_angle = self%follower%turns%last%angle
                call self%search%record_occasion(self%segments%occasion, motion, self%account%total)
                ends = self%search%has_enough
            end if
            if (self%shown < stepper%t .and. (ends .or. .not. stepper%t < self%method%t_end)) call show(self)
        end associate
    end subroutine handle_occasion

    !> Finds the events in the last step. The run ends at one that ends the motion, or as far as the steps that are allowed
    !> suffice for the search, and the events that can be counted.
    subroutine find_events_in_step(self, status, ends)
        type(run_t), intent(inout) :: self
        integer, intent(inout) :: status !! `status_ok`, or the reason of an end (spintop_status)
        logical, intent(out) :: ends !! whether the run ends here
        associate (path => self%path, search => self%search)
            call path%begin_step(self%stepper, self%follower)
            if (allocated(self%segments) .and. any(search%events%occasion == occasion_knot)) call find_events_to_knots(self)
            if (.not. search%has_enough) call search%find_events(path, self%stepper%t)
            ends = search%has_enough
            if (.not. ends .and. (path%is_spent() .or. search%is_full) .and. search%t < self%stepper%t) then
                status = merge(status_too_many_events, status_step_limit, search%is_full)
                ends = .true.
            end if
        end associate
        if (.not. ends) return
        ! The samples before the end of the run, and the end.
        do while (self%next <= self%last .and. .not. self%observer%has_enough)
            if (self%samples(self%next) >= self%search%t) exit
            if (self%stepper%controls%steps == 0) call observe_within(self, self%samples(self%next))
            self%next = self%next + 1
        end do
        call observe_within(self, self%search%t)
    end subroutine find_events_in_step

    !> Finds the events up to each row of a table of torques in the last step, and records those of the row.
    subroutine find_events_to_knots(self)
        type(run_t), intent(inout) :: self
        type(motion_t) :: motion
        real(dp) :: knot
        associate (path => self%path, search => self%search)
            do while (.not. search%has_enough)
                knot = self%method%formulation%action%next_knot(search%t)
                if (knot > self%stepper%t) exit
                call search%find_events(path, knot)
                if (search%has_enough .or. search%t < knot) exit
                call path%at(knot, motion)
                call search%record_occasion(occasion_knot, motion, path%work_until(knot))
            end do
        end associate
    end subroutine find_events_to_knots

    !> Passes the samples up to a time within the last step to the observer, and its end to an observer of steps.
    subroutine observe_until(self, t)
        type(run_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        self%follower%turns%error = self%error_of_step * real(self%stepper%counts%steps, dp)
        associate (samples => self%samples, next => self%next, stepper => self%stepper, steps => self%stepper%controls%steps)
            do while (next <= self%last .and. .not. self%observer%has_enough)
                if (samples(next) > t + self%slack) exit
                if (abs(samples(next) - t) <= self%slack) then
                    call walk_to(self%follower, stepper, stepper%t, stepper%y)
                    call show(self)
                else if (steps == 0) then
                    call observe_within(self, samples(next))
                end if
                next = next + 1
            end do
            call walk_to(self%follower, stepper, stepper%t, stepper%y)
            if (self%observer%sees_steps .and. self%shown < stepper%t) call show(self)
        end associate
        self%due = -huge(self%due)
        if (self%looks_at_steps) return
        self%due = huge(self%due)
        if (self%next <= self%last) self%due = self%samples(self%next) - self%slack
    end subroutine observe_until

    !> Passes the motion at a time within the last step to the observer.
    subroutine observe_within(self, t)
        type(run_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        call walk_to(self%follower, self%stepper, t, self%stepper%interpolate(t))
        call show(self)
    end subroutine observe_within

    !> Passes the motion at the time of the follower to the observer.
    subroutine show(self)
        type(run_t), intent(inout) :: self
        if (self%account%is_open) then
            call self%account%go_to(self%stepper, self%follower%t)
            self%observer%work = self%account%total
        end if
        self%observer%given_angle = self%follower%turns%last%angle
        call self%observer%observe(self%method%formulation, self%follower%t, self%follower%y, self%follower%near)
        self%shown = self%follower%t
    end subroutine show

    !> Leaves a start at which the right-hand side vanishes although the motion does not rest: by the first
    !> step of a fixed-step method, or by a short time before an adaptive one begins.
    subroutine leave_rest(self, status)
        type(run_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, y(max_states), time, y_then(max_states)
        logical :: departed

        associate (stepper => self%stepper, steps => self%stepper%controls%steps)
            call stepper%evaluate(stepper%t, stepper%y, stepper%slope, status)
            if (.not. is_ok(status)) return
            call observe_until(self, 0.0_dp)
            h = 0
            if (steps > 0) h = stepper%t_end / steps
            y = stepper%y
            call self%method%formulation%depart(y, h, departed)
            if (.not. departed) return
            if (h > stepper%t_end) then
                h = stepper%t_end
                y = stepper%y
                call self%method%formulation%depart(y, h, departed)
            end if
            do while (steps == 0 .and. self%next <= self%last .and. .not. self%observer%has_enough)
                if (self%samples(self%next) >= h) exit
                time = self%samples(self%next)
                y_then = stepper%y
                call self%method%formulation%depart(y_then, time, departed)
                call go_to(self%follower, time, y_then)
                call show(self)
                self%next = self%next + 1
            end do
            stepper%y = y
            stepper%t = h
            stepper%grid = 1
            stepper%counts%steps = 1
        end associate
    end subroutine leave_rest

    !> Ends a run that is close to the end of its equations: at the turning point, not beyond.
    subroutine check_arrival(self, status)
        type(run_t), intent(inout) :: self
        integer, intent(inout) :: status !! `status_ok`, or the reason of an end (spintop_status)
        real(dp) :: left, y(max_states)

        associate (formulation => self%method%formulation, stepper => self%stepper)
            left = formulation%time_left(stepper%y)
            select case (status)
            case (status_ok)
                if (left > arrival * stepper%t) return
            case (status_outside, status_step_too_small, status_not_converged)
                if (left > close * stepper%t) return
            case default
                return
            end select
            y = stepper%y
            call formulation%arrive(y, left)
            if (stepper%t + left > stepper%t_end) return
            stepper%y = y
            stepper%t = stepper%t + left
            status = status_turning_point
            call go_to(self%follower, stepper%t, stepper%y)
            call show(self)
        end associate
    end subroutine check_arrival

    !> The time of the end of a motion: that at which it came to rest, s.
    pure real(dp) function end_time(self)
        class(outcome_t), intent(in) :: self
        end_time = self%t
        if (self%status == status_at_rest) end_time = self%t_stuck
    end function end_time

    !> Integrates a formulation from its start over `t_end` seconds. The observer receives the motion at the
    !> sample times (increasing, from 0 to t_end): an adaptive method has dense output for all of them, a
    !> fixed-step method gives those that are steps. If the equations end at a turning point, the observer
    !> receives that too. `search` searches for events; the motion at an event that ends the run is shown last.
    !>
    !> The arguments are checked first (`call_status`, `event_search_t%check`). An invalid call returns the
    !> reason as status, and the observer receives nothing.
    subroutine integrate(formulation, stepper, body, start, t_end, samples, observer, outcome, search)
        class(formulation_t), target, intent(inout) :: formulation
            !! the equations of motion; prepared by this procedure
        class(stepper_t), target, intent(inout) :: stepper !! the method with its settings, and then the end of its run
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end !! length of the span, s
        real(dp), target, intent(in) :: samples(:) !! s after the start, whatever its `t`
        class(observer_t), target, intent(inout) :: observer !! receives the motion
        type(outcome_t), intent(out) :: outcome !! status, time reached and cost
        class(event_search_t), target, intent(inout), optional :: search !! search for events
        type(run_t), target :: run
        integer :: status
        logical :: ends

        outcome%status = call_status(stepper, formulation, body, start, t_end, samples)
        if (is_ok(outcome%status) .and. present(search)) outcome%status = search%check()
        if (.not. is_ok(outcome%status)) return
        ends = .false.
        call stepper%start_over(formulation, t_end)
        run%method => stepper
        run%stepper => stepper
        run%observer => observer
        if (present(search)) run%search => search
        run%samples => samples
        run%last = size(samples)
        call begin_run(run, body, start, status)
        do while (is_ok(status) .and. run%stepper%t < t_end .and. .not. observer%has_enough)
            if (run%stepper%is_spent() .or. is_stopped(run%stepper%counts%steps)) then
                status = status_step_limit
                exit
            end if
            if (allocated(run%segments)) then
                call run%segments%advance(stepper, run%stepper, status)
            else
                call stepper%advance(status)
            end if
            if (is_ok(status) .and. present(search)) then
                call find_events_in_step(run, status, ends)
                if (ends) exit
            end if
            if (is_ok(status) .and. run%stepper%t >= run%due) call observe_until(run, run%stepper%t)
            if (formulation%has_ends) call check_arrival(run, status)
            if (is_ok(status) .and. allocated(run%segments)) call end_step(run, status, ends)
            if (ends) exit
        end do
        outcome%status = status
        outcome%t = run%stepper%t
        outcome%counts = run%stepper%counts
        outcome%doubtful_passages = run%follower%turns%last%passed%doubtful
        if (allocated(run%segments)) then
            if (run%segments%is_resting) then
                outcome%t_stuck = run%segments%t_stuck
                if (is_ok(status) .and. .not. ends) outcome%status = status_at_rest
            end if
        end if
        if (ends) outcome%t = search%t
        call stepper%finish()
    end subroutine integrate

    !> Whether the caller of the library wants the run to stop; it is asked after some steps.
    logical function is_stopped(steps)
        integer(int64), intent(in) :: steps
        integer(int64), parameter :: steps_a_question = 16
        is_stopped = mod(steps, steps_a_question) == 0
        if (is_stopped) is_stopped = stop_is_wanted()
    end function is_stopped

    !> Counts the work up to a time within the last step.
    subroutine count_until(self, stepper, t)
        class(work_account_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! the method, after the step
        real(dp), intent(in) :: t !! time within the last step, s
        real(dp) :: half, times(instants), y(instants, max_states), power(instants, works), sum, change, new
        integer :: part

        if (.not. t > self%t) return
        half = (t - self%t) / 2
        times = self%t + half + node * half
        call stepper%states_within(times, y)
        call stepper%formulation%action%find_powers(times, y, power)
        do part = 1, works
            sum = dot_product(weight, power(:pairs, part) + power(pairs + 1:, part))
            change = half * sum + self%rest(part)
            new = self%total(part) + change
            self%rest(part) = change - (new - self%total(part))
            self%total(part) = new
        end do
        self%t = t
    end subroutine count_until

    !> The motion at a time within the last step. Without angles nothing is followed.
    subroutine motion_in_step(self, t, motion, with_angles)
        class(step_path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time within the last step, s
        type(motion_t), intent(out) :: motion !! at that time
        logical, intent(in), optional :: with_angles !! whether angles are needed
        type(follower_t) :: follower
        real(dp) :: y(max_states)
        logical :: follows
        follows = .true.
        if (present(with_angles)) follows = with_angles
        self%stepper%counts%looks = self%stepper%counts%looks + 1
        y = self%stepper%interpolate(t)
        if (follows) then
            follower = self%seen(max(1, count(self%seen%t <= t)))
            call walk_to(follower, self%stepper, t, y)
            motion = motion_of_follower(follower)
            if (t > self%seen(3)%t) self%seen(2:3) = [self%seen(3), follower]
        else
            motion = self%stepper%formulation%motion_without_angles(t, y)
            motion%given_angle = self%seen(1)%turns%last%angle
        end if
    end subroutine motion_in_step

    !> The same at several instants.
    subroutine attitudes_in_step(self, t, used, motions)
        class(step_path_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times within the last step, s
        integer, intent(in) :: used !! how many of them are different: those that count as work
        type(motions_t), intent(out) :: motions !! the motion at these times
        real(dp) :: y(instants, max_states)
        self%stepper%counts%looks = self%stepper%counts%looks + used
        call self%stepper%states_within(t, y)
        call self%stepper%formulation%find_motions(t, y, motions)
    end subroutine attitudes_in_step

    !> Begins with the last step, at the beginning of which the angles are known. Where it is a series its terms bound the
    !> angular velocity.
    subroutine begin_step(self, stepper, follower)
        class(step_path_t), intent(inout) :: self
        class(stepper_t), pointer, intent(in) :: stepper !! what took the step
        type(follower_t), intent(in) :: follower !! the angles
        real(dp) :: change(max_states)
        self%stepper => stepper
        self%seen = follower
        change = stepper%bound_of_changes()
        self%greatest_rate = 0
        associate (first => stepper%formulation%momentum)
            if (first == 0 .or. .not. all(change < huge(change))) return
            self%greatest_rate = sqrt(sum(((abs(stepper%y_last(first:first + 2)) + change(first:first + 2)) &
                                           / stepper%formulation%body%inertia)**2))
        end associate
    end subroutine begin_step

    !> The work of effects up to a time within the last step.
    function work_in_step(self, t) result(work)
        class(step_path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time within the last step, s
        real(dp) :: work(works)
        type(work_account_t) :: account
        work = 0
        if (.not. associated(self%account)) return
        account = self%account
        call account%go_to(self%stepper, t)
        work = account%total
    end function work_in_step

    !> Whether the allowed work of the case is used up.
    logical function step_is_spent(self)
        class(step_path_t), intent(in) :: self
        step_is_spent = self%stepper%is_spent()
    end function step_is_spent

    !> The angles at the start of a motion, from where they are followed unless they are `idle`.
    type(follower_t) function follow_from(formulation, body, start, y, is_idle) result(self)
        class(formulation_t), pointer, intent(in) :: formulation !! the equations of motion
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: y(max_states) !! the state there
        logical, intent(in) :: is_idle !! whether angles stay as they are
        type(motion_t) :: first
        self%formulation => formulation
        self%is_idle = is_idle
        self%y = y
        self%near = start%angle
        if (is_idle) then
            self%turns%last%angle = start%given_angle
            return
        end if
        self%turns = new_turn_counter(body, start)
        if (body%given%differ) then
            first = formulation%motion_without_angles(0.0_dp, y)
            first%given_angle = start%given_angle
            call self%turns%start_at(first)
        else if (formulation%attitude > 0) then
            call formulation%find_attitude(0.0_dp, y, self%turns%last)
            self%turns%spin = real(formulation%sigma, dp)
        end if
    end function follow_from

    !> Moves to a later time and state; if `sure` is present, only where the turns are certain.
    subroutine go_to(self, t, y, sure)
        type(follower_t), intent(inout) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        logical, intent(out), optional :: sure !! whether the turns are certain
        type(motion_t) :: next
        logical :: is_sure, meets_pole

        is_sure = .true.
        meets_pole = .false.
        associate (formulation => self%formulation, turns => self%turns)
            if (.not. self%is_idle .and. turns%axes%differ) then
                next = formulation%motion_without_angles(t, y)
                call turns%advance(next, is_sure, is_forced=.not. present(sure))
            else if (.not. self%is_idle .and. formulation%attitude > 0) then
                next%t = t
                next%quaternion = y(formulation%attitude:formulation%attitude + 3)
                call formulation%kinematics(t, y, next%omega)
                meets_pole = turns%may_meet_pole(next)
                if (meets_pole) then
                    if (.not. self%knows_rate) call formulation%find_attitude(self%t, self%y, turns%last)
                    call formulation%find_attitude(t, y, next)
                end if
                call turns%advance(next, is_sure, is_forced=.not. present(sure), meets_pole=meets_pole)
                self%near = turns%last%angle
            end if
        end associate
        if (present(sure)) sure = is_sure
        if (present(sure) .and. .not. is_sure) return
        self%knows_rate = meets_pole
        self%t = t
        self%y = y
    end subroutine go_to

    !> Moves to a state within the last step, in small increments where the axis passes a pole and the states
    !> in between are known.
    recursive subroutine walk_to(self, stepper, t, y)
        type(follower_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! the method that took the step
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp) :: middle
        logical :: sure

        if (.not. t > self%t) return
        call go_to(self, t, y, sure)
        if (sure) return
        if (t - self%t <= max(shortest_pace * (stepper%t - stepper%t_last), 2 * spacing(t)) .or. stepper%is_spent()) then
            call go_to(self, t, y)
        else
            middle = self%t + (t - self%t) / 2
            stepper%counts%looks = stepper%counts%looks + 1
            call walk_to(self, stepper, middle, stepper%interpolate(middle))
            call walk_to(self, stepper, t, y)
        end if
    end subroutine walk_to

    !> The motion at the time of the follower.
    type(motion_t) function motion_of_follower(self) result(motion)
        type(follower_t), intent(in) :: self
        motion = self%formulation%motion(self%t, self%y, self%near)
        motion%given_angle = self%turns%last%angle
        motion%passed = self%turns%last%passed
        ! In a pole the attitude does not tell phi and psi.
        if (motion%passed%arrived .and. .not. self%turns%axes%differ) motion%angle(1:3:2) = self%near(1:3:2)
    end function motion_of_follower

end module spintop_integration
