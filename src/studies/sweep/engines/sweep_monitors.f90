!> The monitors that measure the quantities of a sweep along the motions in lanes.
module spintop_sweep_monitors
    use spintop_body, only: body_t
    use spintop_energy_lanes, only: energy_lanes_t
    use spintop_event_text, only: column_event_t
    use spintop_kinds, only: dp, no_number
    use spintop_lane_watch, only: count_turns, keep_extremes, lane_watch_t
    use spintop_lyapunov, only: growth_lanes_t
    use spintop_measures, only: measures_t, watch_turning, watches
    use spintop_motion, only: motion_t
    use spintop_stepper, only: controls_t
    use spintop_sweep_quantities, only: precession_period, watched_for
    use spintop_sweep_result, only: kinds_of_work, of_energy, of_lyapunov, of_period, of_singular
    use spintop_sweep_stop, only: stop_monitor
    use spintop_taylor_lanes, only: lane_monitor_t, lanes, monitor_slot_t, taylor_lanes_t
    use spintop_watched_quantities, only: watched_t
    implicit none
    private
    public :: create_monitors

    !> The end of a motion is the period if it is by no more than this, relatively, before it.
    real(dp), parameter :: rounding = 4 * epsilon(1.0_dp)

    !> Watches the azimuth.
    type, extends(lane_monitor_t) :: azimuth_lanes_t
        !> The period, s, of lanes that have not reached it; of others it is beyond all times. phi at the start, and its change
        !> in the period, rad.
        real(dp), dimension(lanes), private :: period = huge(1.0_dp), start = 0, azimuth = no_number
    contains
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type azimuth_lanes_t

contains

    !> Creates the monitors for the work and for the events.
    subroutine create_monitors(wanted, controls, events, stop_after, slots)
        logical, intent(in) :: wanted(kinds_of_work) !! what is to be computed
        type(controls_t), intent(in) :: controls !! settings of the method
        type(column_event_t), intent(in) :: events(:) !! the events that end the motion, `ends_in_lanes`
        integer, intent(in) :: stop_after !! number of events after which the motion ends
        type(monitor_slot_t), allocatable, intent(out) :: slots(:) !! the monitors
        type(growth_lanes_t) :: growth
        integer :: n, k
        allocate (slots(4 + watches))
        n = 0
        ! First, so that the others see the motion up to its end.
        if (size(events) > 0) call append(stop_monitor(events, stop_after))
        if (wanted(of_period)) call append(azimuth_lanes_t())
        associate (of => watched_for(wanted))
            do k = 1, size(of)
                call append(lane_watch_t(watched_t(of(k)), merge(count_turns, keep_extremes, of(k) == watch_turning)))
            end do
        end associate
        if (wanted(of_energy)) call append(energy_lanes_t())
        if (wanted(of_lyapunov) .or. wanted(of_singular)) then
            call growth%set(controls, is_singular=wanted(of_singular), with_exponent=wanted(of_lyapunov))
            call append(growth)
        end if
        slots = slots(:n)

    contains

        !> Appends a monitor to the list.
        subroutine append(monitor)
            class(lane_monitor_t), intent(in) :: monitor
            n = n + 1
            allocate (slots(n)%monitor, source=monitor)
        end subroutine append

    end subroutine create_monitors

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
        self%start(lane) = start%angle(1)
        self%azimuth(lane) = no_number
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
                self%azimuth(lane) = angles(1) - self%start(lane)
                self%period(lane) = huge(1.0_dp)
            end do
        end associate
    end subroutine observe

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, last, found)
        class(azimuth_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(motion_t), intent(in) :: last !! the motion at the end
        type(measures_t), intent(inout) :: found !! what is measured of the case
        found%azimuth = self%azimuth(lane)
        self%period(lane) = huge(1.0_dp)
    end subroutine finish

end module spintop_sweep_monitors
