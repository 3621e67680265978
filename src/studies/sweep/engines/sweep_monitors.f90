!> The quantities of a sweep that monitors measure along the motions in lanes.
module spintop_sweep_monitors
    use spintop_body, only: body_t
    use spintop_energy_lanes, only: energy_lanes_t
    use spintop_event_text, only: column_event_t
    use spintop_kinds, only: dp
    use spintop_energy_lanes, only: energy_lanes_t
    use spintop_lyapunov, only: growth_lanes_t
    use spintop_taylor_lanes, only: lane_monitor_t, monitor_slot_t
    use spintop_lane_watch, only: count_turns, keep_extremes, lane_watch_t, stop_motion
    use spintop_lyapunov, only: growth_lanes_t
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t
    use spintop_nutation_recorder, only: nutation_of
    use spintop_quantities, only: angular_acceleration
    use spintop_sweep_engine, only: slot_t
    use spintop_stepper, only: controls_t
    use spintop_sweep_quantities, only: set_azimuth, set_measured_nutation, precession_period
    use spintop_sweep_result, only: at_com_z_min, at_energy_error_max, at_theta_rate_max, at_force_max, &
        at_force_z_min, at_force_z_max, at_lyapunov_exponent, at_largest_singular_value, note_no_lyapunov, &
        note_no_singular, note_no_stop, kinds_of_work, of_class, of_energy, of_fastest, of_force, of_lowest, &
        of_lyapunov, of_nutation_rate, of_period, of_range, of_singular, of_vertical_force, of_whole, sweep_result_t
    use spintop_sweep_stop, only: stop_monitor
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    use spintop_turning_record, only: count_end, turning_points_t, upper, lower
    use spintop_watched_quantities, only: watch_centre_height, watch_nutation_rate, watch_precession_rate, &
        watch_total_force, watch_turning, watch_vertical_force, watched_t
    implicit none
    private
    public :: sweep_monitors_t, azimuth_lanes_t

    !> The end of a motion is the period if it is by no more than this, relatively, before it.
    real(dp), parameter :: rounding = 4 * epsilon(1.0_dp)

    !> Watches the azimuth.
    type, extends(lane_monitor_t) :: azimuth_lanes_t
        !> Whether the motion of each case reached the period, and its change of phi then, rad.
        logical, allocatable :: seen(:)
        real(dp), allocatable :: azimuth(:)
        !> The period, s, of lanes that have not reached it; of others it is beyond all times.
        real(dp), private :: period(lanes) = huge(1.0_dp)
        logical, private :: seen_in(lanes) = .false.
        real(dp), private :: azimuth_in(lanes) = 0
    contains
        procedure :: prepare
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type azimuth_lanes_t

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

    !> Sets the quantities measured of a case of the last run. Its status reports work on perturbations that was not
    !> finished, or overflow.
    subroutine store_quantities(self, wanted, i, last, slot)
        class(sweep_monitors_t), intent(in) :: self
        logical, intent(in) :: wanted(kinds_of_work) !! what is to be computed
        integer, intent(in) :: i !! number of the case in the run
        type(motion_t), intent(in) :: last !! the motion at the end
        type(slot_t), intent(inout) :: slot !! the case, and what is known of it
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
                    if (.not. monitor%event_occurred(i)) call slot%note%add(note_no_stop)
                case (keep_extremes)
                    call set_extreme(monitor, i, slot%result, rate)
                case (count_turns)
                    turns = monitor%turns(:, i)
                end select
            type is (azimuth_lanes_t)
                call set_azimuth(slot, monitor%seen(i), monitor%azimuth(i))
            type is (energy_lanes_t)
                slot%result%of(at_energy_error_max) = monitor%error_max(i)
            type is (growth_lanes_t)
                associate (found => monitor%growth(i))
                    if (monitor%is_singular) call slot%store_or_explain(at_largest_singular_value, found%singular, &
                                                                        found%singular_status, note_no_singular)
                    if (monitor%has_exponent) call slot%store_or_explain(at_lyapunov_exponent, found%exponent, &
                                                                         found%exponent_status, note_no_lyapunov)
                end associate
            end select
        end do
        if (wanted(of_whole) .or. wanted(of_range)) then
            call count_end(turns, slot%case%start, last, angular_acceleration(slot%case%body, last))
        end if
        ends = [slot%case%start%angle(2), last%angle(2)]
        if (wanted(of_fastest) .or. wanted(of_class)) then
            call nutation_of(turns, ends, nutation, is_whole, rate)
        else
            call nutation_of(turns, ends, nutation, is_whole)
        end if
        call set_measured_nutation(slot, wanted, nutation, is_whole, any(turns%is_interrupted))
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
            values%of(at_theta_rate_max) = monitor%largest(i)
        case (watch_centre_height)
            values%of(at_com_z_min) = monitor%least(i)
        case (watch_vertical_force)
            values%of(at_force_z_min) = monitor%least(i)
            values%of(at_force_z_max) = monitor%largest(i)
        case (watch_total_force)
            values%of(at_force_max) = monitor%largest(i)
        end select
    end subroutine set_extreme

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(azimuth_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%seen)) deallocate (self%seen, self%azimuth)
        allocate (self%seen(cases), source=.false.)
        allocate (self%azimuth(cases), source=0.0_dp)
        self%period = huge(1.0_dp)
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(azimuth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: period
        period = precession_period(body, start)
        self%period(lane) = merge(period, huge(period), period > 0)
        self%seen_in(lane) = .false.
        self%azimuth_in(lane) = -start%angle(1)
    end subroutine begin

    !> Records the azimuth in lanes that reached the period in the last step.
    subroutine observe(self, run)
        class(azimuth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp) :: angles(2)
        integer :: lane
        associate (now => run%now)
            if (.not. any(now%t * (1 + rounding) >= self%period)) return
            do lane = 1, lanes
                if (.not. now%t(lane) * (1 + rounding) >= self%period(lane)) cycle
                ! What the next step begins with is more accurate there.
                if (self%period(lane) > now%t(lane) .and. now%t(lane) < now%t_end(lane)) cycle
                angles = run%angles_at(lane, min(self%period(lane), now%t(lane)))
                self%azimuth_in(lane) = self%azimuth_in(lane) + angles(1)
                self%seen_in(lane) = .true.
                self%period(lane) = huge(1.0_dp)
            end do
        end associate
    end subroutine observe

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(azimuth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        self%seen(case) = self%seen_in(lane)
        self%azimuth(case) = self%azimuth_in(lane)
        self%period(lane) = huge(1.0_dp)
    end subroutine finish

end module spintop_sweep_monitors
