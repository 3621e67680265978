!> Carries a motion from its start to the end of the span and shows it to an observer on the way.
module spintop_integration
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_stepper, only: stepper_t, workspace_t, counts_t
    use spintop_status, only: status_ok, status_outside, status_step_too_small, &
        status_step_limit, status_turning_point, status_not_converged
    implicit none
    private
    public :: integrate, observer_t, outcome_t

    !> Looks at the motion at the sample times.
    type, abstract :: observer_t
        !> Set by the observer to end the run.
        logical :: has_enough = .false.
    contains
        procedure(observe), deferred :: observe
    end type observer_t

    abstract interface
        !> The state `y` of a formulation at time `t`; the times come in rising order.
        subroutine observe(self, formulation, t, y)
            import :: observer_t, formulation_t, dp, max_states
            class(observer_t), intent(inout) :: self
            class(formulation_t), intent(in) :: formulation
            real(dp), intent(in) :: t, y(max_states)
        end subroutine observe
    end interface

    !> How a run ended.
    type :: outcome_t
        integer :: status = status_ok
        !> Time reached, s.
        real(dp) :: t = 0
        type(counts_t) :: counts
    end type outcome_t

    !> With less than this share of the time gone left, a run arrives at the end of its equations;
    !> with less than `near` of the span, one that is stuck has arrived too.
    real(dp), parameter :: arrival = 1.0e-4_dp, near = 1.0e-2_dp
    !> A sample of a fixed-step method this share of a step away is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp

contains

    !> Integrates a formulation from its start over `t_end` seconds. The observer sees the sample
    !> times (rising, from 0 to t_end): all of them by dense output of an adaptive method, those
    !> that are steps of a fixed-step one; and the turning point where the equations end at one.
    subroutine integrate(formulation, stepper, body, start, t_end, samples, observer, outcome)
        class(formulation_t), intent(inout) :: formulation
        class(stepper_t), intent(in) :: stepper
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end, samples(:)
        class(observer_t), intent(inout) :: observer
        type(outcome_t), intent(out) :: outcome
        class(workspace_t), allocatable :: work
        integer :: next, status

        call stepper%new_workspace(work)
        work%t_end = t_end
        next = 1
        call formulation%prepare(body, start, work%y, status)
        if (status == status_ok) call check_start(formulation, work, status)
        if (status == status_ok) then
            call show_until(0.0_dp)
            call leave_rest(formulation, stepper, work, samples, next, observer)
            call stepper%begin(formulation, work, status)
            call show_until(work%t)
        end if
        do while (status == status_ok .and. work%t < t_end .and. .not. observer%has_enough)
            if (work%counts%steps >= stepper%controls%max_steps) then
                status = status_step_limit
                exit
            end if
            call stepper%advance(formulation, work, status)
            if (status == status_ok) call show_until(work%t)
            call check_arrival(formulation, work, observer, status)
        end do
        outcome%status = status
        outcome%t = work%t
        outcome%counts = work%counts

    contains

        !> Shows the samples not yet shown up to a time within the last step.
        subroutine show_until(t)
            real(dp), intent(in) :: t
            real(dp) :: slack, shown
            slack = 0
            if (stepper%controls%steps > 0) slack = grid_slack * t_end / stepper%controls%steps
            do while (next <= size(samples) .and. .not. observer%has_enough)
                if (samples(next) > t + slack) exit
                shown = samples(next)
                if (abs(shown - t) <= slack) then
                    call observer%observe(formulation, work%t, work%y)
                else if (stepper%controls%steps == 0) then
                    call observer%observe(formulation, shown, stepper%interpolate(work, shown))
                end if
                next = next + 1
            end do
        end subroutine show_until

    end subroutine integrate

    !> The right-hand side must exist at the start.
    subroutine check_start(formulation, work, status)
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        integer, intent(out) :: status
        real(dp) :: slope(max_states)
        call work%evaluate(formulation, work%y, slope, status)
    end subroutine check_start

    !> Leaves a start on which the equations alone would rest: the first step of a fixed-step
    !> method, or a short time before an adaptive one begins.
    subroutine leave_rest(formulation, stepper, work, samples, next, observer)
        class(formulation_t), intent(in) :: formulation
        class(stepper_t), intent(in) :: stepper
        class(workspace_t), intent(inout) :: work
        real(dp), intent(in) :: samples(:)
        integer, intent(inout) :: next
        class(observer_t), intent(inout) :: observer
        real(dp) :: h, y(max_states)
        logical :: departed

        h = 0
        if (stepper%controls%steps > 0) h = work%t_end / stepper%controls%steps
        y = work%y
        call formulation%depart(y, h, departed)
        if (.not. departed) return
        if (h > work%t_end) then
            h = work%t_end
            y = work%y
            call formulation%depart(y, h, departed)
        end if
        if (stepper%controls%steps == 0) then
            do while (next <= size(samples) .and. .not. observer%has_enough)
                if (samples(next) >= h) exit
                call observe_departure(samples(next))
                next = next + 1
            end do
        end if
        work%y = y
        work%t = h
        work%grid = 1
        work%counts%steps = 1

    contains

        subroutine observe_departure(t)
            real(dp), intent(in) :: t
            real(dp) :: time, y_then(max_states)
            logical :: unused
            time = t
            y_then = work%y
            call formulation%depart(y_then, time, unused)
            call observer%observe(formulation, t, y_then)
        end subroutine observe_departure

    end subroutine leave_rest

    !> Ends a run that has come to where its equations end: at the turning point, not beyond.
    subroutine check_arrival(formulation, work, observer, status)
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        class(observer_t), intent(inout) :: observer
        integer, intent(inout) :: status
        real(dp) :: left, y(max_states)

        left = formulation%time_left(work%y)
        select case (status)
        case (status_ok)
            if (left > arrival * work%t) return
        case (status_outside, status_step_too_small, status_not_converged)
            if (left > near * work%t_end) return
        case default
            return
        end select
        y = work%y
        call formulation%arrive(y, left)
        if (work%t + left > work%t_end) return
        work%y = y
        work%t = work%t + left
        status = status_turning_point
        call observer%observe(formulation, work%t, work%y)
    end subroutine check_arrival

end module spintop_integration
