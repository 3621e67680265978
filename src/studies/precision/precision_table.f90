!> The rows of a work-precision table: their order, and the front of the best ones.
module spintop_precision_table
    use spintop_kinds, only: dp
    use spintop_status, only: status_ok
    use spintop_trial, only: trial_t
    implicit none
    private
    public :: precision_row_t, sort_rows, mark_front

    !> A method with a setting.
    type :: precision_row_t
        character(20) :: method = ''
        character(16) :: formulation = ''
        character(32) :: setting = ''
        type(trial_t) :: trial
        !> Minimum time of the repeats, s.
        real(dp) :: time = 0
        !> Whether it is a numerical method, and not the exact solution.
        logical :: is_stepped = .true.
        !> Whether method = 'auto' selects it for this tolerance.
        logical :: is_auto = .false.
        logical :: is_front = .false.
    end type precision_row_t

contains

    !> Sorts rows by time.
    pure subroutine sort_rows(rows)
        type(precision_row_t), intent(inout) :: rows(:) !! rows of a problem
        type(precision_row_t) :: row
        integer :: i, place
        do i = 2, size(rows)
            row = rows(i)
            place = i
            do while (place > 1)
                if (rows(place - 1)%time <= row%time) exit
                rows(place) = rows(place - 1)
                place = place - 1
            end do
            rows(place) = row
        end do
    end subroutine sort_rows

    !> Marks the rows, sorted by time, for which no numerical method is both faster and at least as accurate.
    pure subroutine mark_front(rows)
        type(precision_row_t), intent(inout) :: rows(:) !! rows of a problem, sorted by time
        real(dp) :: best
        integer :: i
        best = huge(best)
        do i = 1, size(rows)
            associate (row => rows(i))
                row%is_front = row%trial%status == status_ok .and. row%trial%errors%orientation < best
                if (row%is_front .and. row%is_stepped) best = row%trial%errors%orientation
            end associate
        end do
    end subroutine mark_front

end module spintop_precision_table
