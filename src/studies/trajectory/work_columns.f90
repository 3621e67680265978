!> The columns of a trajectory that contain the work of effects.
module spintop_work_columns
    use spintop_kinds, only: dp
    use spintop_loads, only: work_damping, work_drag, work_friction, work_rotor, work_torque, work_vibration
    use spintop_motion_view, only: motion_view_t
    use spintop_trajectory_column, only: trajectory_column_t
    implicit none
    private
    public :: work_columns

contains

    !> These columns, in the order of the table's documentation.
    function work_columns() result(columns)
        type(trajectory_column_t), allocatable :: columns(:)
        columns = [ &
            trajectory_column_t('work', 'J', 'work of all effects since the start', 'energy', value_of_work, &
                                is_default=.true., needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_damping', 'J', 'work of viscous damping', 'energy', value_of_work_damping, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_friction', 'J', 'work of dry friction', 'energy', value_of_work_friction, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_drag', 'J', 'work of the air', 'energy', value_of_work_drag, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_vibration', 'J', 'work of the moving pivot', 'energy', value_of_work_vibration, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_torque', 'J', 'work of given torques', 'energy', value_of_work_torque, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_rotor', 'J', 'work of the drive of the rotor', 'energy', value_of_work_rotor, &
                                needs_effects=.true., needs_work=.true.)]
    end function work_columns

    !> Work of all effects, J.
    real(dp) function value_of_work(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = sum(now%work)
    end function value_of_work

    !> Work of viscous damping, J.
    real(dp) function value_of_work_damping(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%work(work_damping)
    end function value_of_work_damping

    !> Work of dry friction, J.
    real(dp) function value_of_work_friction(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%work(work_friction)
    end function value_of_work_friction

    !> Work of the air, J.
    real(dp) function value_of_work_drag(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%work(work_drag)
    end function value_of_work_drag

    !> Work of the moving pivot, J.
    real(dp) function value_of_work_vibration(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%work(work_vibration)
    end function value_of_work_vibration

    !> Work of given torques, J.
    real(dp) function value_of_work_torque(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%work(work_torque)
    end function value_of_work_torque

    !> Work of the drive of the rotor, J.
    real(dp) function value_of_work_rotor(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%work(work_rotor)
    end function value_of_work_rotor

end module spintop_work_columns
