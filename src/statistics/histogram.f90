!> Histograms of the values of columns: intervals of nearly equal widths, whose ends are ends of the cells in which
!> the values were counted, so that the numbers of values are exact.
module spintop_histogram
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t, moments_t
    use spintop_kinds, only: dp
    use spintop_value_counts, only: value_counts_t
    implicit none
    private
    public :: histogram_t, make_histogram

    !> Maximum number of intervals.
    integer, parameter, public :: most_intervals = 100

    !> Neighbouring intervals, from the minimum to the maximum.
    type :: histogram_t
        real(dp), allocatable :: from(:), to(:)
        !> Values in each interval.
        integer(int64), allocatable :: counts(:)
    end type histogram_t

contains

    !> The histogram of a column over all cases; without intervals if no case has a value.
    subroutine make_histogram(accumulators, column, histogram)
        type(accumulators_t), intent(in) :: accumulators !! the statistics
        integer, intent(in) :: column !! number of the column of numbers
        type(histogram_t), intent(out) :: histogram !! at most `most_intervals` intervals
        type(value_counts_t) :: cells
        type(moments_t) :: all
        real(dp), allocatable :: lower(:), upper(:)
        integer(int64), allocatable :: counts(:)
        integer :: i, k, here

        call accumulators%counts_over_all(column, cells)
        call cells%list_cells(lower, upper, counts)
        all = accumulators%over_all(column)
        allocate (histogram%from(most_intervals), histogram%to(most_intervals))
        allocate (histogram%counts(most_intervals), source=0_int64)
        k = 0
        here = 0
        do i = 1, size(counts)
            ! A cell belongs to the interval in which its lower end lies.
            if (k == 0 .or. interval(lower(i)) > here) then
                here = interval(lower(i))
                k = k + 1
                histogram%from(k) = lower(i)
            end if
            histogram%to(k) = upper(i)
            histogram%counts(k) = histogram%counts(k) + counts(i)
        end do
        histogram%from = histogram%from(:k)
        histogram%to = histogram%to(:k)
        histogram%counts = histogram%counts(:k)
        if (k == 0) return
        histogram%from(1) = all%minimum
        histogram%to(k) = all%maximum

    contains

        !> The interval of a value, of so many of equal width.
        pure integer function interval(value)
            real(dp), intent(in) :: value
            real(dp) :: share
            ! Halves, for the range may be larger than the largest number.
            share = (value / 2 - all%minimum / 2) / max(all%maximum / 2 - all%minimum / 2, tiny(share))
            interval = min(max(int(share * most_intervals) + 1, 1), most_intervals)
        end function interval

    end subroutine make_histogram

end module spintop_histogram
