!> Integrates a motion from its start to the end of the span, and passes it to an observer.
module spintop_integration
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: stop_is_wanted
    use spintop_kinds, only: dp, no_number
    use spintop_body, only: body_t
    use spintop_events, only: event_search_t
    use spintop_motion, only: motion_t
    use spintop_observer, only: observer_t
    use spintop_run, only: run_t
    use spintop_formulation, only: formulation_t
    use spintop_stepper, only: stepper_t, counts_t
    use spintop_suitability, only: call_status
    use spintop_status, only: is_ok, status_at_rest, status_ok, status_step_limit
    implicit none
    private
    public :: integrate, observer_t, outcome_t

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
        class(stepper_t), intent(in) :: stepper !! the method with its settings; a copy of it runs
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end !! length of the span, s
        real(dp), target, intent(in) :: samples(:) !! s after the start, whatever its `t`
        class(observer_t), target, intent(inout) :: observer !! receives the motion
        type(outcome_t), intent(out) :: outcome !! status, time reached and cost
        class(event_search_t), target, intent(inout), optional :: search !! search for events
        class(stepper_t), allocatable, target :: method
        type(run_t), target :: run
        integer :: status
        logical :: ends

        outcome%status = call_status(stepper, formulation, body, start, t_end, samples)
        if (is_ok(outcome%status) .and. present(search)) outcome%status = search%check()
        if (.not. is_ok(outcome%status)) return
        ends = .false.
        allocate (method, source=stepper)
        method%formulation => formulation
        method%t_end = t_end
        run%formulation => formulation
        run%method => method
        run%stepper => method
        run%observer => observer
        if (present(search)) run%search => search
        run%samples => samples
        run%last = size(samples)
        call run%begin(body, start, status)
        do while (is_ok(status) .and. run%stepper%t < t_end .and. .not. observer%has_enough)
            if (run%stepper%is_spent() .or. is_stopped(run%stepper%counts%steps)) then
                status = status_step_limit
                exit
            end if
            if (allocated(run%segments)) then
                call run%segments%advance(method, run%stepper, status)
            else
                call method%advance(status)
            end if
            if (is_ok(status) .and. present(search)) then
                call run%find_events_in_step(status, ends)
                if (ends) exit
            end if
            if (is_ok(status) .and. run%stepper%t >= run%due) call run%observe_until(run%stepper%t)
            if (formulation%has_ends) call run%check_arrival(status)
            if (is_ok(status) .and. allocated(run%segments)) call run%end_step(status, ends)
            if (ends) exit
        end do
        outcome%status = status
        outcome%t = run%stepper%t
        outcome%counts = run%stepper%counts
        associate (follower => run%follower)
            outcome%doubtful_passages = merge(follower%given_passed%doubtful, follower%passed%doubtful, body%given%differ)
        end associate
        if (allocated(run%segments)) then
            if (run%segments%rest%is_resting) then
                outcome%t_stuck = run%segments%rest%t_stuck
                if (is_ok(status) .and. .not. ends) outcome%status = status_at_rest
            end if
        end if
        if (ends) outcome%t = search%t
    end subroutine integrate

    !> Whether the caller of the library wants the run to stop; it is asked after some steps.
    logical function is_stopped(steps)
        integer(int64), intent(in) :: steps
        integer(int64), parameter :: steps_a_question = 16
        is_stopped = mod(steps, steps_a_question) == 0
        if (is_stopped) is_stopped = stop_is_wanted()
    end function is_stopped

end module spintop_integration
