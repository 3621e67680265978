!> Measures quantities along the motions in lanes, from the Taylor polynomials of each step.
!>
!> A monitor exists for each quantity of a motion that is needed between the ends of its steps. It keeps its own
!> numbers for each lane, and at the end of a case stores its result. The numbers of a lane do not depend on
!> the other lanes.
module spintop_lane_monitor
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_taylor_lanes, only: taylor_lanes_t
    implicit none
    private
    public :: lane_monitor_t, monitor_slot_t

    !> Monitors one family of quantities in all lanes.
    type, abstract :: lane_monitor_t
    contains
        procedure(prepare), deferred :: prepare
        procedure(begin), deferred :: begin
        procedure(observe), deferred :: observe
        procedure(finish), deferred :: finish
    end type lane_monitor_t

    !> An element of a list of monitors.
    type :: monitor_slot_t
        class(lane_monitor_t), allocatable :: monitor
    end type monitor_slot_t

    abstract interface
        !> Makes room for so many cases, of which nothing is known yet.
        subroutine prepare(self, cases)
            import :: lane_monitor_t
            class(lane_monitor_t), intent(inout) :: self
            integer, intent(in) :: cases !! number of cases
        end subroutine prepare

        !> A case begins in a lane.
        subroutine begin(self, run, lane, body, start)
            import :: body_t, lane_monitor_t, motion_t, taylor_lanes_t
            class(lane_monitor_t), intent(inout) :: self
            type(taylor_lanes_t), intent(in) :: run !! the lanes
            integer, intent(in) :: lane !! index of the lane
            type(body_t), intent(in) :: body !! mass properties of the body
            type(motion_t), intent(in) :: start !! the motion at the start
        end subroutine begin

        !> All lanes have taken a step, from `t_last` to `t`; lanes at rest took one of no length. A monitor may end a
        !> lane within the step (`stop`): those behind it in the list see the step up to there.
        subroutine observe(self, run)
            import :: lane_monitor_t, taylor_lanes_t
            class(lane_monitor_t), intent(inout) :: self
            type(taylor_lanes_t), intent(inout) :: run !! the lanes
        end subroutine observe

        !> The case in a lane is at its end.
        subroutine finish(self, run, lane, case)
            import :: lane_monitor_t, taylor_lanes_t
            class(lane_monitor_t), intent(inout) :: self
            type(taylor_lanes_t), intent(in) :: run !! the lanes
            integer, intent(in) :: lane, case !! index of the lane, and of its case
        end subroutine finish
    end interface

end module spintop_lane_monitor
