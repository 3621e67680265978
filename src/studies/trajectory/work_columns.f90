!> The columns of a trajectory that contain the work of effects.
module spintop_work_columns
    use spintop_kinds, only: dp
    use spintop_loads, only: work_damping, work_drag, work_friction, work_rotor, work_torque, work_vibration, works
    use spintop_motion_view, only: motion_view_t
    use spintop_trajectory_column, only: longest, trajectory_column_t
    implicit none
    private
    public :: work_columns

contains

    !> These columns, in the order of the table's documentation.
    function work_columns() result(columns)
        type(trajectory_column_t), allocatable :: columns(:)
        columns = [ &
            trajectory_column_t('work', 'J', 'work of all effects since the start', 'energy', put_work, works + 1, &
                                is_default=.true., needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_damping', 'J', 'work of viscous damping', 'energy', put_work, work_damping, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_friction', 'J', 'work of dry friction', 'energy', put_work, work_friction, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_drag', 'J', 'work of the air', 'energy', put_work, work_drag, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_vibration', 'J', 'work of the moving pivot', 'energy', put_work, work_vibration, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_torque', 'J', 'work of given torques', 'energy', put_work, work_torque, &
                                needs_effects=.true., needs_work=.true.), &
            trajectory_column_t('work_rotor', 'J', 'work of the drive of the rotor', 'energy', put_work, work_rotor, &
                                needs_effects=.true., needs_work=.true.)]
    end function work_columns

    !> The parts, and their sum.
    subroutine put_work(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:works) = now%work
        vector(works + 1) = sum(now%work)
    end subroutine put_work

end module spintop_work_columns
