!> The quantities of a sweep that monitors measure along the motions in lanes.
module spintop_sweep_monitors
    use spintop_azimuth_lanes, only: azimuth_lanes_t
    use spintop_event_text, only: column_event_t
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_energy_lanes, only: energy_lanes_t
    use spintop_lyapunov, only: growth_lanes_t
    use spintop_taylor_lanes, only: lane_monitor_t, monitor_slot_t
    use spintop_lane_watch, only: count_turns, keep_extremes, lane_watch_t, stop_motion
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t
    use spintop_nutation_recorder, only: nutation_of
    use spintop_quantities, only: angular_acceleration
    use spintop_status, only: is_ok, status_meanings, status_non_finite, status_step_limit
    use spintop_stepper, only: controls_t
    use spintop_sweep_stop, only: stop_monitor
    use spintop_sweep_notes, only: note_no_lyapunov, note_no_singular, note_no_stop, note_t
    use spintop_sweep_quantities, only: set_azimuth, set_measured_nutation
    use spintop_sweep_result, only: kinds_of_work, of_class, of_energy, of_fastest, of_force, of_lowest, &
        of_lyapunov, of_nutation_rate, of_period, of_range, of_singular, of_vertical_force, of_whole, sweep_result_t
    use spintop_turning_record, only: count_end, turning_points_t, upper, lower
    use spintop_watched_quantities, only: watch_centre_height, watch_nutation_rate, watch_precession_rate, watch_total_force, &
        watch_turning, watch_vertical_force, watched_t
    implicit none
    private
    public :: sweep_monitors_t

    !> Monitors for the work of a sweep; `slots` is passed to `integrate_many`.
    type :: sweep_monitors_t
        type(monitor_slot_t), allocatable :: slots(:)
    contains
        procedure :: create
        procedure :: store_quantities
    end type sweep_monitors_t

contains

    !> Creates the monitors for the work and for the events.
    subroutine create(self, wanted, controls, events, stop_after)
        class(sweep_monitors_t), intent(inout) :: self
        logical, intent(in) :: wanted(kinds_of_work) !! what is to be computed
        type(controls_t), intent(in) :: controls !! settings of the method
        type(column_event_t), intent(in) :: events(:) !! the events that end the motion, `ends_in_lanes`
        integer, intent(in) :: stop_after !! number of events after which the motion ends
        type(growth_lanes_t) :: growth
        type(energy_lanes_t) :: energy
        if (allocated(self%slots)) deallocate (self%slots)
        allocate (self%slots(0))
        ! First, so that the others see the motion up to its end.
        if (size(events) > 0) call append(stop_monitor(events, stop_after))
        if (wanted(of_period)) call append(azimuth_lanes_t())
        if (wanted(of_whole) .or. wanted(of_range)) call append(lane_watch_t(watched_t(watch_turning), count_turns))
        if (wanted(of_fastest) .or. wanted(of_class)) call keep_extremes_of(watch_precession_rate)
        if (wanted(of_lowest)) call keep_extremes_of(watch_centre_height)
        if (wanted(of_nutation_rate)) call keep_extremes_of(watch_nutation_rate)
        if (wanted(of_vertical_force)) call keep_extremes_of(watch_vertical_force)
        if (wanted(of_force)) call keep_extremes_of(watch_total_force)
        if (wanted(of_energy)) call append(energy)
        if (wanted(of_lyapunov) .or. wanted(of_singular)) then
            call growth%set(controls, is_singular=wanted(of_singular), with_exponent=wanted(of_lyapunov))
            call append(growth)
        end if

    contains

        !> Appends a watch of the extremes of a quantity.
        subroutine keep_extremes_of(quantity)
            integer, intent(in) :: quantity
            call append(lane_watch_t(watched_t(quantity), keep_extremes))
        end subroutine keep_extremes_of

        !> Appends a monitor to the list.
        subroutine append(monitor)
            class(lane_monitor_t), intent(in) :: monitor
            type(monitor_slot_t), allocatable :: more(:)
            integer :: i
            allocate (more(size(self%slots) + 1))
            do i = 1, size(self%slots)
                call move_alloc(self%slots(i)%monitor, more(i)%monitor)
            end do
            allocate (more(size(more))%monitor, source=monitor)
            call move_alloc(more, self%slots)
        end subroutine append

    end subroutine create

    !> Sets the quantities measured of a case of the last run. `status` reports work on perturbations that was not
    !> finished, or overflow.
    subroutine store_quantities(self, case, wanted, i, last, values, status, note)
        class(sweep_monitors_t), intent(in) :: self
        type(case_t), intent(in) :: case !! the case whose quantities are set
        logical, intent(in) :: wanted(kinds_of_work) !! what is to be computed
        integer, intent(in) :: i !! number of the case in the run
        type(motion_t), intent(in) :: last !! the motion at the end
        type(sweep_result_t), intent(inout) :: values !! the quantities of the case
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(note_t), intent(inout) :: note !! notes on the case
        type(nutation_t) :: nutation
        type(turning_points_t) :: turns(upper:lower)
        real(dp) :: ends(2), rate
        logical :: is_whole
        integer :: k

        rate = 0
        do k = size(self%slots), 1, -1 ! the order of the notes
            select type (monitor => self%slots(k)%monitor)
            type is (lane_watch_t)
                select case (monitor%action)
                case (stop_motion)
                    if (.not. monitor%event_occurred(i)) call note%add(note_no_stop)
                case (keep_extremes)
                    call set_extreme(monitor, i, values, rate)
                case (count_turns)
                    turns = monitor%turns(:, i)
                end select
            type is (azimuth_lanes_t)
                call set_azimuth(monitor%seen(i), monitor%azimuth(i), values, note)
            type is (energy_lanes_t)
                values%energy_error_max = monitor%error_max(i)
            type is (growth_lanes_t)
                associate (found => monitor%growth(i))
                    if (monitor%is_singular) call store_or_explain(values%largest_singular_value, found%singular, &
                                                                   found%singular_status, note_no_singular)
                    if (monitor%has_exponent) call store_or_explain(values%lyapunov_exponent, found%exponent, &
                                                                    found%exponent_status, note_no_lyapunov)
                end associate
            end select
        end do
        if (wanted(of_whole) .or. wanted(of_range)) then
            call count_end(turns, case%start, last, angular_acceleration(case%body, last))
        end if
        ends = [case%start%angle(2), last%angle(2)]
        if (wanted(of_fastest) .or. wanted(of_class)) then
            call nutation_of(turns, ends, nutation, is_whole, rate)
        else
            call nutation_of(turns, ends, nutation, is_whole)
        end if
        call set_measured_nutation(case, wanted, nutation, is_whole, any(turns%is_interrupted), values, note)

    contains

        !> Stores a value, or notes the reason why there is none.
        subroutine store_or_explain(quantity, value, how, reason)
            real(dp), intent(inout) :: quantity
            real(dp), intent(in) :: value
            integer, intent(in) :: how, reason
            if (is_ok(how)) then
                quantity = value
            else
                call note%add(reason, trim(status_meanings(how)))
                if (how == status_step_limit .or. how == status_non_finite) status = how
            end if
        end subroutine store_or_explain

    end subroutine store_quantities

    !> Sets an extreme of a case of the last run; the precession rate is for the nutation.
    subroutine set_extreme(monitor, i, values, precession)
        type(lane_watch_t), intent(in) :: monitor
        integer, intent(in) :: i
        type(sweep_result_t), intent(inout) :: values
        real(dp), intent(inout) :: precession
        select case (monitor%of%quantity)
        case (watch_precession_rate)
            precession = monitor%largest(i)
        case (watch_nutation_rate)
            values%theta_rate_max = monitor%largest(i)
        case (watch_centre_height)
            values%com_z_min = monitor%least(i)
        case (watch_vertical_force)
            values%force_z_min = monitor%least(i)
            values%force_z_max = monitor%largest(i)
        case (watch_total_force)
            values%force_max = monitor%largest(i)
        end select
    end subroutine set_extreme

end module spintop_sweep_monitors
