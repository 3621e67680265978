!> How a case of a sweep ends at an event (`stop_at`): a motion in closed form is searched beforehand, in lanes a monitor looks
!> for the events that are roots of polynomials, and a motion that is integrated by itself ends as a trajectory does.
module spintop_sweep_stop
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_kinds, only: dp, pi, is_equal, is_zero
    use spintop_event_recorder, only: event_recorder_t, exact_path_t
    use spintop_event_text, only: column_event_t
    use spintop_lane_watch, only: lane_watch_t
    use spintop_measures, only: quantities, watch_nothing, watch_theta, watch_turning
    use spintop_status, only: is_ok, status_ok, status_step_limit, status_too_many_events
    use spintop_stepper, only: looks_per_step
    use spintop_watched_quantities, only: watched_t
    implicit none
    private
    public :: stop_exactly, ends_in_lanes, stop_monitor

    !> Least sine of an inclination whose passages are found by its cosine.
    real(dp), parameter :: least_sine = 1.0e-3_dp

contains

    !> Ends the span of a case at the n-th of the events. `event_occurred` reports whether there was one, `status` whether the
    !> allowed work was sufficient.
    subroutine stop_exactly(case, events, n, max_steps, status, event_occurred)
        type(case_t), intent(inout) :: case !! its span is set to the time of the event
        type(column_event_t), intent(in) :: events(:) !! the events
        integer, intent(in) :: n !! number of the event that ends the motion
        integer(int64), intent(inout) :: max_steps !! remaining work of the case
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        logical, intent(out) :: event_occurred !! whether the n-th event occurred within the span
        ! These objects are large, and a thread may have a small stack.
        type(exact_path_t), allocatable :: path
        type(event_recorder_t), allocatable :: recorder

        event_occurred = .false.
        allocate (path, recorder)
        call path%begin(case, looks_per_step * max_steps, status)
        if (.not. is_ok(status)) then
            ! The kernel reports the status.
            status = status_ok
            return
        end if
        call recorder%set(events, n, case)
        call recorder%begin(case%body, path%exact%at(0.0_dp))
        call recorder%judge(case%body, case%start)
        call recorder%find_events(path, case%t_end)
        max_steps = max_steps - path%looks / looks_per_step
        event_occurred = recorder%has_enough
        if (.not. event_occurred .and. recorder%t < case%t_end) status = &
            merge(status_too_many_events, status_step_limit, &
                recorder%is_full)
        if (event_occurred) case%t_end = recorder%t
    end subroutine stop_exactly

    !> Whether a monitor finds the events that end the motions: passages of one value of a column that is an angle or a
    !> form of the motion, or turning points, of a body in the axes in which it was given.
    pure logical function ends_in_lanes(events, case)
        type(column_event_t), intent(in) :: events(:) !! the events, each of which ends the motion
        type(case_t), intent(in) :: case !! the case: its axes and effects decide which columns are forms of the motion
        integer :: i
        ends_in_lanes = size(events) == 0
        if (ends_in_lanes .or. case%turn%is_turned()) return
        do i = 1, size(events)
            associate (event => events(i)%event)
                if (events(i)%column%name /= events(1)%column%name) return
                if (event%every_turn .neqv. events(1)%event%every_turn) return
                if (event%turn_by_turn .neqv. events(1)%event%turn_by_turn) return
                if (.not. is_equal(event%level, events(1)%event%level)) return
                select case (events(i)%column%passing)
                case (watch_nothing)
                    return
                case (watch_theta)
                    ! Near a pole cos(theta) does not determine theta.
                    if (.not. (event%level > 0 .and. event%level < pi .and. sin(event%level) > least_sine)) return
                case (watch_turning)
                    if (.not. is_zero(event%level)) return
                end select
                if (allocated(case%body%effects) .and. quantities(events(i)%column%passing)%needs_plain_body) return
            end associate
        end do
        ends_in_lanes = .true.
    end function ends_in_lanes

    !> The monitor for events that end the motions at the n-th of them.
    pure type(lane_watch_t) function stop_monitor(events, n)
        type(column_event_t), intent(in) :: events(:) !! the events, `ends_in_lanes`
        integer, intent(in) :: n !! number of events after which the motion ends
        associate (event => events(1)%event, column => events(1)%column)
            stop_monitor = lane_watch_t(of=watched_t(column%passing, column%component, event%level), wanted=n, &
                                        rising=any(events%event%direction > 0), falling=any(events%event%direction < 0), &
                                        every_turn=event%every_turn, turn_by_turn=event%turn_by_turn)
        end associate
    end function stop_monitor

end module spintop_sweep_stop
