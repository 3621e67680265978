!> The columns of a trajectory that contain the readings of an accelerometer at the centre of mass.
module spintop_accelerometer_columns
    use spintop_kinds, only: dp
    use spintop_motion_view, only: motion_view_t
    use spintop_trajectory_column, only: trajectory_column_t
    implicit none
    private
    public :: accelerometer_columns

contains

    !> These columns, in the order of the table's documentation.
    function accelerometer_columns() result(columns)
        type(trajectory_column_t), allocatable :: columns(:)
        columns = [ &
            trajectory_column_t('accelerometer1', 'm/s^2', 'reading of an accelerometer at the centre of mass, body x', &
                                'force', value_of_accelerometer1), &
            trajectory_column_t('accelerometer2', 'm/s^2', 'reading of an accelerometer at the centre of mass, body y', &
                                'force', value_of_accelerometer2), &
            trajectory_column_t('accelerometer3', 'm/s^2', 'reading of an accelerometer at the centre of mass, body z', &
                                'force', value_of_accelerometer3)]
    end function accelerometer_columns

    !> Reading along body x, m/s^2.
    real(dp) function value_of_accelerometer1(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = reading_along(1, now)
    end function value_of_accelerometer1

    !> Reading along body y, m/s^2.
    real(dp) function value_of_accelerometer2(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = reading_along(2, now)
    end function value_of_accelerometer2

    !> Reading along body z, m/s^2.
    real(dp) function value_of_accelerometer3(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = reading_along(3, now)
    end function value_of_accelerometer3

    !> Reading along a body axis, m/s^2.
    real(dp) function reading_along(axis, now) result(value)
        integer, intent(in) :: axis
        type(motion_view_t), intent(in) :: now
        real(dp) :: reading(3)
        reading = now%accelerometer()
        value = reading(axis)
    end function reading_along

end module spintop_accelerometer_columns
