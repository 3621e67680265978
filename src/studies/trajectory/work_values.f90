!> Values of the columns of a trajectory that contain the work of effects.
module spintop_work_values
    use spintop_kinds, only: dp
    use spintop_loads, only: work_damping, work_drag, work_friction, work_rotor, work_torque, work_vibration
    use spintop_motion_view, only: motion_view_t
    implicit none
    private
    public :: value_of_work, value_of_work_damping, value_of_work_friction, value_of_work_drag
    public :: value_of_work_vibration, value_of_work_torque, value_of_work_rotor

contains

    !> Work of all effects, J.
    real(dp) function value_of_work(now) result(value)
        type(motion_view_t), intent(inout) :: now !! the motion, with its work
        value = sum(now%work)
    end function value_of_work

    !> Work of viscous damping, J.
    real(dp) function value_of_work_damping(now) result(value)
        type(motion_view_t), intent(inout) :: now !! the motion, with its work
        value = now%work(work_damping)
    end function value_of_work_damping

    !> Work of dry friction, J.
    real(dp) function value_of_work_friction(now) result(value)
        type(motion_view_t), intent(inout) :: now !! the motion, with its work
        value = now%work(work_friction)
    end function value_of_work_friction

    !> Work of the air, J.
    real(dp) function value_of_work_drag(now) result(value)
        type(motion_view_t), intent(inout) :: now !! the motion, with its work
        value = now%work(work_drag)
    end function value_of_work_drag

    !> Work of the moving pivot, J.
    real(dp) function value_of_work_vibration(now) result(value)
        type(motion_view_t), intent(inout) :: now !! the motion, with its work
        value = now%work(work_vibration)
    end function value_of_work_vibration

    !> Work of given torques, J.
    real(dp) function value_of_work_torque(now) result(value)
        type(motion_view_t), intent(inout) :: now !! the motion, with its work
        value = now%work(work_torque)
    end function value_of_work_torque

    !> Work of the drive of the rotor, J.
    real(dp) function value_of_work_rotor(now) result(value)
        type(motion_view_t), intent(inout) :: now !! the motion, with its work
        value = now%work(work_rotor)
    end function value_of_work_rotor

end module spintop_work_values
