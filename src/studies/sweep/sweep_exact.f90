!> Cases of a sweep with a closed form, many at once.
module spintop_sweep_exact
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_conditioning, only: inherent_error
    use spintop_event_recorder, only: event_recorder_t
    use spintop_exact_path, only: exact_path_t
    use spintop_event_text, only: column_event_t
    use spintop_exact_block, only: exact_block_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, whole_half_turns
    use spintop_status, only: status_ok, status_step_limit, status_too_many_events, status_meanings
    use spintop_stepper, only: looks_per_step
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_quantities, only: find_free_constants, put_nutation, put_fast_top, put_azimuth, put_end, &
        put_details, precession_period, lowest_height
    use spintop_sweep_result, only: kinds_of_work, of_details, of_end, of_energy, of_fast_top, of_free, of_growth, &
        of_inherent, of_lowest, of_multiplier, of_nutation, of_period, of_turns, sweep_result_t
    use spintop_sweep_stability, only: put_stability
    implicit none
    private
    public :: load_lane, unload_lane, kernel_runs, stop_exactly

contains

    !> Puts a case into a lane of the block.
    subroutine load_lane(case, wanted, block, lane)
        type(case_t), intent(in) :: case !! body, start and span
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        type(exact_block_t), intent(inout) :: block !! the data of the lane are set
        integer, intent(in) :: lane !! number of the lane
        block%inertia1(lane) = case%body%inertia(1)
        block%inertia3(lane) = case%body%inertia(3)
        block%mgl(lane) = case%body%mgl()
        block%phi(lane) = case%start%angle(1)
        block%theta(lane) = case%start%angle(2)
        block%psi(lane) = case%start%angle(3)
        block%phi_rate(lane) = case%start%rate(1)
        block%theta_rate(lane) = case%start%rate(2)
        block%omega3(lane) = case%start%omega(3)
        block%t_end(lane) = case%t_end
        block%t_period(lane) = 0
        if (wanted(of_period)) block%t_period(lane) = precession_period(case%body, case%start)
    end subroutine load_lane

    !> Ends the span of a case at the n-th of the events. `came` reports whether it occurred, `status` whether
    !> the allowed work was sufficient.
    subroutine stop_exactly(case, events, n, max_steps, status, came)
        type(case_t), intent(inout) :: case !! its span is set to the time of the event
        type(column_event_t), intent(in) :: events(:) !! the events
        integer, intent(in) :: n !! number of the event that ends the motion
        integer(int64), intent(inout) :: max_steps !! remaining work of the case
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        logical, intent(out) :: came !! whether the event occurred
        ! These objects are large, and a thread may have a small stack.
        type(exact_path_t), allocatable :: path
        type(event_recorder_t), allocatable :: watch

        came = .false.
        allocate (path, watch)
        call path%begin(case, looks_per_step * max_steps, status)
        if (status /= status_ok) then
            ! The kernel reports the status.
            status = status_ok
            return
        end if
        call watch%set(events, n, case)
        call watch%begin(case%body, path%exact%at(0.0_dp))
        call watch%judge(case%body, case%start)
        call watch%look(path, case%t_end)
        max_steps = max_steps - path%looks / looks_per_step
        came = watch%has_enough
        if (.not. came .and. watch%t < case%t_end) status = merge(status_too_many_events, status_step_limit, watch%is_full)
        if (came) case%t_end = watch%t
    end subroutine stop_exactly

    !> Whether the selected groups need the kernel.
    pure logical function kernel_runs(wanted)
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        kernel_runs = (wanted(of_nutation) .or. wanted(of_period) .or. wanted(of_end) .or. wanted(of_energy))
    end function kernel_runs

    !> The quantities of the case in a lane of a computed block.
    subroutine unload_lane(case, block, lane, wanted, max_steps, values, status, note)
        type(case_t), intent(in) :: case !! body, start and span
        type(exact_block_t), intent(in) :: block !! a computed block
        integer, intent(in) :: lane !! number of the lane
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        integer(int64), intent(inout) :: max_steps !! remaining work of the case
        type(sweep_result_t), intent(inout) :: values !! the quantities of the case
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(note_t), intent(inout) :: note !! notes on the case
        integer(int64) :: limit

        limit = max_steps
        values = sweep_result_t()
        status = block%status(lane)
        if (status /= status_ok) then
            call note%explain(trim(status_meanings(status)))
            return
        end if
        if (wanted(of_nutation)) call unload_nutation(case, block, lane, wanted, values, note)
        if (wanted(of_fast_top)) call put_fast_top(case, values, note)
        if (wanted(of_period)) then
            call put_azimuth(block%t_period(lane) > 0, block%phi_at_period(lane), values, note)
        end if
        if (wanted(of_end) .or. wanted(of_energy)) then
            call unload_end(case, block, lane, wanted, max_steps, values, status)
            if (status /= status_ok) then
                call note%explain(trim(status_meanings(status)))
                return
            end if
        end if
        values%evaluations = 0
        values%orientation_error = 0
        if (wanted(of_details)) call put_details(case, values, note)
        if (wanted(of_free)) call find_free_constants(case, wanted, values, note)
        if (any(wanted(of_growth:of_multiplier))) then
            call put_stability(case, case%t_end, wanted, limit, values, note)
        end if
        if (wanted(of_inherent)) then
            values%inherent_error = inherent_error(case%body, case%start, case%t_end)
        end if
    end subroutine unload_lane

    !> The whole nutation.
    subroutine unload_nutation(case, block, lane, wanted, values, note)
        type(case_t), intent(in) :: case
        type(exact_block_t), intent(in) :: block
        integer, intent(in) :: lane
        logical, intent(in) :: wanted(kinds_of_work)
        type(sweep_result_t), intent(inout) :: values
        type(note_t), intent(inout) :: note
        type(nutation_t) :: nutation
        nutation%theta_min = block%theta_min(lane)
        nutation%theta_max = block%theta_max(lane)
        nutation%delta_u = block%delta_u(lane)
        nutation%period = block%period(lane)
        nutation%precession = block%precession(lane)
        nutation%precession_rate = block%precession_rate(lane)
        if (case%body%is_free()) then
            nutation%precession = whole_half_turns(nutation%precession)
            nutation%precession_rate = nutation%precession / nutation%period
        end if
        nutation%phi_rate_max = block%phi_rate_max(lane)
        if (wanted(of_lowest)) values%com_z_min = lowest_height(case, nutation%theta_max)
        call put_nutation(case, nutation, values, note)
    end subroutine unload_nutation

    !> The end of the span.
    subroutine unload_end(case, block, lane, wanted, max_steps, values, status)
        type(case_t), intent(in) :: case
        type(exact_block_t), intent(in) :: block
        integer, intent(in) :: lane
        logical, intent(in) :: wanted(kinds_of_work)
        integer(int64), intent(inout) :: max_steps
        type(sweep_result_t), intent(inout) :: values
        integer, intent(out) :: status
        type(motion_t) :: last
        call find_end(case, block, lane, wanted, max_steps, last, status)
        if (status == status_ok) call put_end(case, last, block%energy_error(lane), values)
    end subroutine unload_end

    !> The motion at the end of the span, as far as a sweep table needs it.
    subroutine find_end(case, block, lane, wanted, max_steps, motion, status)
        type(case_t), intent(in) :: case
        type(exact_block_t), intent(in) :: block
        integer, intent(in) :: lane
        logical, intent(in) :: wanted(kinds_of_work)
        integer(int64), intent(inout) :: max_steps
        type(motion_t), intent(out) :: motion
        integer, intent(out) :: status
        status = status_ok
        if (case%turn%exchanges_axes()) then
            call find_whole_end(case, wanted(of_turns), max_steps, motion, status)
        else
            motion%t = case%t_end
            motion%angle = [block%phi_end(lane), block%theta_end(lane), block%psi_end(lane)]
            motion%rate(2) = block%theta_rate_end(lane)
        end if
    end subroutine find_end

    !> The same with the whole attitude, which is needed for angles about another axis. Counting their turns is work of
    !> the case.
    subroutine find_whole_end(case, counts_turns, max_steps, motion, status)
        type(case_t), intent(in) :: case
        logical, intent(in) :: counts_turns
        integer(int64), intent(inout) :: max_steps
        type(motion_t), intent(out) :: motion
        integer, intent(out) :: status
        type(exact_motion_t) :: exact
        integer(int64) :: steps
        call prepare_exact_motion(case%body, case%start, exact, status)
        steps = 0
        if (counts_turns .and. status == status_ok) then
            call exact%follow(case%start, case%t_end, motion, steps, max_steps)
            if (steps >= max_steps) status = status_step_limit
            max_steps = max_steps - steps
        else
            motion = exact%at(case%t_end)
            status = status_ok
        end if
    end subroutine find_whole_end

end module spintop_sweep_exact
