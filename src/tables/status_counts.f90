!> How the cases, or the motion, of a complete CSV table ended.
module spintop_status_counts
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_status, only: last_status, status_number
    implicit none
    private
    public :: count_statuses, status_of_ending

    !> A comment below the rows that tells how a motion ended.
    character(*), parameter :: ending_key = '# status: '

contains

    !> Counts the rows with each status, and the comment that tells how a motion ended as a row.
    subroutine count_statuses(lines, column, counts)
        character(*), intent(in) :: lines !! whole lines of a table
        integer, intent(in) :: column !! number of the column of the statuses, all before which are numbers; 0 if there is none
        integer(int64), intent(inout) :: counts(0:last_status) !! increased by the number of rows with each status
        integer :: first, last, cell, i, status

        first = 1
        do while (first <= len(lines))
            last = first + index(lines(first:), new_line('a')) - 2
            status = -1
            if (index(lines(first:min(last, first + len(ending_key) - 1)), ending_key) == 1) then
                status = status_of_ending(lines(first + len(ending_key):last))
            else if (lines(first:first) /= '#' .and. column > 0) then
                cell = first
                do i = 2, column
                    cell = cell + index(lines(cell:last), ',')
                end do
                status = status_number(lines(cell:cell + index(lines(cell:last) // ',', ',') - 2))
            end if
            if (status >= 0) counts(status) = counts(status) + 1
            first = last + 2
        end do
    end subroutine count_statuses

    !> The status with whose name a text begins; -1 if there is none.
    pure integer function status_of_ending(text) result(status)
        character(*), intent(in) :: text !! such as `at_rest at t = 3.5`
        status = status_number(text(:scan(text // ' ', ' :') - 1))
    end function status_of_ending

end module spintop_status_counts
