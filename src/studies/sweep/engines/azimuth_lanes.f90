!> The change of phi in the precession period of each case, along the motions in lanes.
module spintop_azimuth_lanes
    use spintop_body, only: body_t
    use spintop_kinds, only: dp
    use spintop_taylor_lanes, only: lane_monitor_t, lanes, taylor_lanes_t
    use spintop_motion, only: motion_t
    use spintop_sweep_quantities, only: precession_period
    implicit none
    private
    public :: azimuth_lanes_t

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

contains

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

end module spintop_azimuth_lanes
