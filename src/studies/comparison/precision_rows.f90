!> The rows of a work-precision study: their order, the front of the best ones, and in words the least cost of each accuracy and
!> the method that has it.
module spintop_precision_rows
    use spintop_comparison, only: attempt_t
    use spintop_kinds, only: dp
    use spintop_reference_motion, only: reference_t
    use spintop_status, only: is_ok
    use spintop_summary, only: summary_t, rounded
    use spintop_text, only: to_text
    implicit none
    private
    public :: sort_rows, mark_front, summarize_problem, auto_tally_t

    !> Errors for which the cheapest method is reported, rad.
    real(dp), parameter :: wanted_errors(*) = [1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp, 1.0e-12_dp]
    integer, parameter :: nobody = 0
    !> A method is a good choice if its time is at most this multiple of the least time.
    real(dp), parameter :: near = 2

    !> Counts how often method = 'auto' is a good choice.
    type :: auto_tally_t
        private
        integer :: comparisons = 0, within = 0, missed = 0
        !> Largest ratio of its time to the least time, and the comparison in which it occurs.
        real(dp) :: worst = 1
        character(:), allocatable :: where
    contains
        procedure :: compare => compare_auto
        procedure :: summarize => summarize_auto
    end type auto_tally_t

contains

    !> Sorts rows by time.
    pure subroutine sort_rows(rows)
        type(attempt_t), intent(inout) :: rows(:) !! rows of a problem
        type(attempt_t) :: row
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
        type(attempt_t), intent(inout) :: rows(:) !! rows of a problem, sorted by time
        real(dp) :: best
        integer :: i
        best = huge(best)
        do i = 1, size(rows)
            associate (row => rows(i))
                row%is_front = is_ok(row%trial%status) .and. row%trial%errors%orientation < best
                if (row%is_front .and. row%is_stepped) best = row%trial%errors%orientation
            end associate
        end do
    end subroutine mark_front

    !> Adds the results of a problem, whose rows are sorted by time.
    subroutine summarize_problem(problem, rows, reference, summary)
        character(*), intent(in) :: problem !! name of the problem
        type(attempt_t), intent(in) :: rows(:) !! rows of a problem, sorted by time
        type(reference_t), intent(in) :: reference !! the reference motion
        type(summary_t), intent(inout) :: summary !! lines are added
        integer :: i

        call summary%add('problem', problem // ', measured against ' // about(reference))
        if (any(rows%is_stepped) .and. .not. any(rows%is_stepped .and. is_ok(rows%trial%status))) then
            call summary%add('', 'no numerical method reaches the end of the span')
        else
            do i = 1, size(wanted_errors)
                call summary%add('', 'for ' // to_text(wanted_errors(i)) // ' ' // compared(rows, wanted_errors(i)))
            end do
        end if
        do i = 1, size(rows)
            if (rows(i)%is_stepped .or. .not. is_ok(rows(i)%trial%status)) cycle
            call summary%add('', 'the exact solution takes ' // duration(rows(i)%time) // ' at any time, with an error of ' &
                             // rounded(rows(i)%trial%errors%orientation) // ' rad')
        end do
    end subroutine summarize_problem

    !> The reference and its uncertainty.
    function about(reference) result(text)
        type(reference_t), intent(in) :: reference
        character(:), allocatable :: text
        text = with_article(reference%source)
        if (reference%is_computed) text = text // ' (two tolerances agree to ' // rounded(reference%uncertainty) // ' rad)'
        if (reference%check == '') then
            text = text // ', which could not be checked: the independent computation failed'
        else
            text = text // ', with which ' // with_article(reference%check) // ' agrees to ' &
                   // rounded(reference%disagreement) // ' rad'
        end if
    end function about

    !> The source of a motion, with an article.
    pure function with_article(source) result(text)
        character(*), intent(in) :: source
        character(:), allocatable :: text
        text = trim(source)
        if (source == 'exact solution') text = 'the ' // text
    end function with_article

    !> The cheapest numerical method for an error, and the ratio of its time to that of the next one.
    function compared(rows, error) result(text)
        type(attempt_t), intent(in) :: rows(:)
        real(dp), intent(in) :: error
        character(:), allocatable :: text
        integer :: best, next

        best = cheapest(rows, error, rows%is_stepped)
        if (best == nobody) then
            text = 'no method is accurate enough'
            return
        end if
        text = 'the cheapest is ' // rows(best)%name() // ', ' // rows(best)%setting%text() // ': ' &
               // duration(rows(best)%time)
        next = cheapest(rows, error, rows%is_stepped .and. rows%choice%method%name /= rows(best)%choice%method%name)
        if (next == nobody) then
            text = text // '; no other method is accurate enough'
        else
            text = text // ', ' // rounded(rows(next)%time / rows(best)%time, 2) // ' times cheaper than ' &
                   // rows(next)%name()
        end if
    end function compared

    !> Index of the first row, of rows sorted by time, that is in the mask and has no larger error; 0 if there
    !> is none.
    pure integer function cheapest(rows, error, mask)
        type(attempt_t), intent(in) :: rows(:)
        real(dp), intent(in) :: error
        logical, intent(in) :: mask(:)
        do cheapest = 1, size(rows)
            if (.not. mask(cheapest) .or. .not. is_ok(rows(cheapest)%trial%status)) cycle
            if (rows(cheapest)%trial%errors%orientation <= error) return
        end do
        cheapest = nobody
    end function cheapest

    !> Compares method = 'auto' with the cheapest method, for each error that some method reaches.
    subroutine compare_auto(self, problem, rows)
        class(auto_tally_t), intent(inout) :: self
        character(*), intent(in) :: problem !! name of the problem
        type(attempt_t), intent(in) :: rows(:) !! rows of a problem, sorted by time
        real(dp) :: ratio
        integer :: i, best, own

        do i = 1, size(wanted_errors)
            best = cheapest(rows, wanted_errors(i), spread(.true., 1, size(rows)))
            if (best == nobody .or. .not. any(rows%is_auto)) cycle
            own = cheapest(rows, wanted_errors(i), rows%is_auto)
            ratio = huge(ratio)
            if (own /= nobody) ratio = rows(own)%time / rows(best)%time
            self%comparisons = self%comparisons + 1
            if (own == nobody) self%missed = self%missed + 1
            if (ratio <= near) self%within = self%within + 1
            if (own == nobody .or. ratio <= self%worst) cycle
            self%worst = ratio
            self%where = problem // ', for ' // to_text(wanted_errors(i)) // ' where ' // rows(best)%name() &
                         // ' is the cheapest'
        end do
    end subroutine compare_auto

    !> Adds the results of the comparisons.
    subroutine summarize_auto(self, summary)
        class(auto_tally_t), intent(in) :: self
        type(summary_t), intent(inout) :: summary !! lines are added
        character(:), allocatable :: text
        if (self%comparisons == 0) return
        text = 'takes no more than ' // rounded(near, 1) // ' times as long as the cheapest method in ' &
               // to_text(self%within) // ' of ' // to_text(self%comparisons) // ' comparisons'
        if (self%worst > 1) text = text // ', at worst ' // rounded(self%worst, 3) // ' times (' // self%where // ')'
        if (self%missed > 0) text = text // '; in ' // to_text(self%missed) // ' it is not accurate enough'
        call summary%add('auto', text)
    end subroutine summarize_auto

    !> A time with a suitable unit.
    function duration(time) result(text)
        real(dp), intent(in) :: time
        character(:), allocatable :: text
        real(dp), parameter :: milli = 1.0e-3_dp, micro = 1.0e-6_dp
        if (time < milli) then
            text = rounded(time / micro, 3) // ' us'
        else if (time < 1) then
            text = rounded(time / milli, 3) // ' ms'
        else
            text = rounded(time, 3) // ' s'
        end if
    end function duration

end module spintop_precision_rows
