!> How the cases, or the motion, of a complete CSV table ended.
!>
!>     call count_statuses(path, len(head), column, counts, error)
module spintop_status_counts
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_files, only: input_file_t
    use spintop_status, only: last_status, status_number
    implicit none
    private
    public :: count_statuses, status_of_ending

    !> Bytes that are read at once, and letters that are kept of a cell or of a comment.
    integer, parameter :: block_size = 65536, most_letters = 64
    !> A comment below the rows that tells how a motion ended.
    character(*), parameter :: ending_key = '# status: '

contains

    !> Counts the rows with each status, and the comment that tells how a motion ended as a row.
    subroutine count_statuses(path, head_length, column, counts, error)
        character(*), intent(in) :: path !! path of the table
        integer, intent(in) :: head_length !! bytes of its header
        integer, intent(in) :: column !! number of the column of the statuses, all before which are numbers; 0 if there is none
        integer(int64), intent(out) :: counts(0:last_status) !! number of rows with each status
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(input_file_t) :: file
        character(:), allocatable :: block
        character(most_letters) :: letters
        integer :: length, kept, cell, i

        counts = 0
        allocate (character(max(block_size, head_length)) :: block)
        call file%open(path, error)
        if (.not. allocated(error)) call file%read(block(:head_length), length, error)
        call begin_line()
        do while (.not. allocated(error))
            call file%read(block, length, error)
            if (allocated(error) .or. length == 0) exit
            do i = 1, length
                call look_at(block(i:i))
            end do
        end do
        call file%close()

    contains

        !> A comment is cell 0 of its line.
        subroutine look_at(letter)
            character, intent(in) :: letter
            if (letter == new_line('a')) then
                call end_line()
                call begin_line()
            else if (letter == ',' .and. cell > 0) then
                cell = cell + 1
                kept = 0
            else
                if (letter == '#' .and. cell == 1 .and. kept == 0) cell = 0
                if (cell > 1 .and. cell /= column) return
                kept = kept + 1
                if (kept <= most_letters .and. (cell == column .or. cell == 0)) letters(kept:kept) = letter
            end if
        end subroutine look_at

        subroutine begin_line()
            letters = ''
            kept = 0
            cell = 1
        end subroutine begin_line

        subroutine end_line()
            integer :: status
            status = status_number(letters)
            if (index(letters, ending_key) == 1) status = status_of_ending(letters(len(ending_key) + 1:))
            if (status >= 0) counts(status) = counts(status) + 1
        end subroutine end_line

    end subroutine count_statuses

    !> The status with whose name a text begins; -1 if there is none.
    pure integer function status_of_ending(text) result(status)
        character(*), intent(in) :: text !! such as `at_rest at t = 3.5`
        status = status_number(text(:scan(text // ' ', ' :') - 1))
    end function status_of_ending

end module spintop_status_counts
