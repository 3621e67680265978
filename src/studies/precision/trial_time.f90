!> Time of a case, for attitude and rates at the end of the span.
!>
!> It is the minimum of elapsed times: what else the processor does can only lengthen them. The processor time of a
!> thread is no such bound: a virtual machine takes the time that its host withheld from where it notices, and may
!> so count nothing for a short run.
module spintop_trial_time
    use spintop_clock, only: seconds
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t
    use spintop_stepper, only: counts_t
    implicit none
    private
    public :: time_trial

    !> Keeps the last motion, and the state that it is made of.
    type, extends(observer_t) :: arrival_t
        type(motion_t) :: motion
        real(dp) :: t = 0, y(max_states) = 0, near(3) = 0
    contains
        procedure :: observe
    end type arrival_t

    !> Minimum duration of a measurement, which consists of consecutive calls, and approximate maximum of all
    !> repeats together, s.
    real(dp), parameter :: shortest = 2.0e-4_dp, longest = 2.0_dp

contains

    !> The minimum time of `repeats` computations of a case with a plan, s. A similar computation, which took
    !> about `expected` seconds, should have run just before as a warm-up. If the repeats would take longer
    !> than two seconds there are fewer of them, but at least one. `counts` is the cost of one computation.
    subroutine time_trial(case, plan, expected, repeats, time, counts, motion, status)
        type(case_t), intent(in) :: case !! the case whose computation is timed
        type(plan_t), intent(inout) :: plan !! model, method and settings
        real(dp), intent(in) :: expected !! expected time of one computation, s
        integer, intent(in) :: repeats !! maximum number of measurements
        real(dp), intent(out) :: time !! minimum time, s
        type(counts_t), intent(out) :: counts !! cost of one computation
        type(motion_t), intent(out), optional :: motion !! the end of the span, in the axes of the computation
        integer, intent(out), optional :: status !! how the last computation ended (spintop_status)
        type(arrival_t) :: arrival
        real(dp) :: began, start
        integer :: calls, repeat, i, ended

        arrival%counts_turns = .false.
        calls = 1 + int(shortest / max(expected, shortest / 1000))
        time = huge(time)
        start = seconds()
        do repeat = 1, repeats
            began = seconds()
            do i = 1, calls
                call go(case, plan, arrival, counts, ended)
            end do
            time = min(time, (seconds() - began) / calls)
            if (seconds() - start > longest) exit
        end do
        if (present(motion)) then
            motion = arrival%motion
            if (.not. plan%exact) motion = plan%formulation%motion(arrival%t, arrival%y, arrival%near)
        end if
        if (present(status)) status = ended
    end subroutine time_trial

    !> Computes the state at the end of the span.
    subroutine go(case, plan, arrival, counts, status)
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        type(arrival_t), intent(inout) :: arrival
        type(counts_t), intent(out) :: counts
        integer, intent(out) :: status
        type(exact_motion_t) :: exact
        type(outcome_t) :: outcome

        if (plan%exact) then
            call prepare_exact_motion(case%body, case%start, exact, status)
            arrival%motion = exact%at(case%t_end)
        else
            call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, &
                           [case%t_end], arrival, outcome)
            counts = outcome%counts
            status = outcome%status
        end if
    end subroutine go

    !> Keeps the motion: attitude and rates, without the angles that describe the attitude.
    subroutine observe(self, formulation, t, y, near)
        class(arrival_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        self%motion = formulation%motion_without_angles(t, y)
        self%t = t
        self%y = y
        self%near = near
    end subroutine observe

end module spintop_trial_time
