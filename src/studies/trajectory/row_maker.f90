!> The rows of a trajectory table, and the quantities of events: values of chosen columns.
module spintop_row_maker
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_motion_view, only: motion_view_t
    use spintop_trajectory_columns, only: trajectory_column_t
    implicit none
    private
    public :: row_maker_t

    !> Gives the values of columns, motion by motion.
    type :: row_maker_t
        private
        type(trajectory_column_t), allocatable :: columns(:)
        type(motion_view_t) :: view
    contains
        procedure :: set
        procedure :: row
        procedure :: is_defined
        procedure :: come_near
    end type row_maker_t

contains

    !> Takes the columns of the rows, and the case. Columns that need an exact motion are for bodies that
    !> have one.
    subroutine set(self, columns, case)
        class(row_maker_t), intent(inout) :: self
        type(trajectory_column_t), intent(in) :: columns(:) !! the columns
        type(case_t), intent(in) :: case !! body, start and span
        self%columns = columns
        call self%view%set(case)
    end subroutine set

    !> The row of a motion, which is in the axes of the computation; all but the errors are those of the
    !> body as it was given. That of the start (`is_start`) is told as it was given.
    function row(self, computed, is_start) result(values)
        class(row_maker_t), intent(inout) :: self
        type(motion_t), intent(in) :: computed !! the motion in the axes of the computation
        logical, intent(in), optional :: is_start !! whether it is the start
        real(dp) :: values(size(self%columns))
        logical :: at_start
        integer :: i
        at_start = .false.
        if (present(is_start)) at_start = is_start
        call self%view%look(computed, at_start)
        do i = 1, size(self%columns)
            values(i) = self%columns(i)%value(self%view)
        end do
    end function row

    !> Whether the last row, given, is finite, but for what does not exist at a pole.
    pure logical function is_defined(self, values)
        class(row_maker_t), intent(in) :: self
        real(dp), intent(in) :: values(:) !! the values
        logical :: at_pole
        integer :: i
        is_defined = all(is_finite(values))
        if (is_defined) return
        at_pole = abs(sin(self%view%near(2))) <= 4 * epsilon(1.0_dp)
        do i = 1, size(values)
            if (is_finite(values(i))) cycle
            if (.not. (at_pole .and. self%columns(i)%ends_at_poles)) return
        end do
        is_defined = .true.
    end function is_defined

    !> The angles of the next row are continuous with those of another maker's last one.
    subroutine come_near(self, other)
        class(row_maker_t), intent(inout) :: self
        class(row_maker_t), intent(in) :: other !! the other object of this type
        self%view%near = other%view%near
    end subroutine come_near

end module spintop_row_maker
