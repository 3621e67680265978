!> The columns of a trajectory that contain the readings of an accelerometer at the centre of mass.
module spintop_accelerometer_columns
    use spintop_kinds, only: dp
    use spintop_motion_view, only: motion_view_t
    use spintop_trajectory_column, only: longest, trajectory_column_t
    implicit none
    private
    public :: accelerometer_columns

contains

    !> These columns, in the order of the table's documentation.
    function accelerometer_columns() result(columns)
        type(trajectory_column_t), allocatable :: columns(:)
        columns = [ &
            trajectory_column_t('accelerometer1', 'm/s^2', 'reading of an accelerometer at the centre of mass, body x', &
                                'force', put_accelerometer, 1), &
            trajectory_column_t('accelerometer2', 'm/s^2', 'reading of an accelerometer at the centre of mass, body y', &
                                'force', put_accelerometer, 2), &
            trajectory_column_t('accelerometer3', 'm/s^2', 'reading of an accelerometer at the centre of mass, body z', &
                                'force', put_accelerometer, 3)]
    end function accelerometer_columns

    subroutine put_accelerometer(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = now%accelerometer()
    end subroutine put_accelerometer

end module spintop_accelerometer_columns
