!> Bins of one quantity: neighbouring intervals between edges.
module spintop_bins
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    implicit none
    private
    public :: bins_t, even_bins, bins_around, place_among

    !> Bin i holds the values from edge(i) to below edge(i+1); the last one has its upper edge, too.
    type :: bins_t
        !> Increasing; one more than there are bins.
        real(dp), allocatable :: edge(:)
        !> A representative value of each bin: its middle, or the value it was made around.
        real(dp), allocatable :: value(:)
        !> Whether the edges are equally spaced, or their logarithms.
        logical, private :: is_even = .false., is_log = .false.
        !> place = (x - origin) slope, x being the value or its logarithm.
        real(dp), private :: origin = 0, slope = 0
    contains
        procedure :: count => count_bins
        procedure :: place
    end type bins_t

contains

    !> So many bins of equal width, or of equal ratio of their edges.
    function even_bins(from, to, count, is_log) result(bins)
        real(dp), intent(in) :: from, to !! the outer edges, from < to; both above 0 if is_log
        integer, intent(in) :: count     !! >= 1
        logical, intent(in) :: is_log    !! whether the logarithms are equally spaced
        type(bins_t) :: bins
        integer :: i

        allocate (bins%edge(count + 1), bins%value(count))
        do i = 0, count
            bins%edge(i + 1) = between(real(i, dp) / count)
        end do
        bins%edge(count + 1) = to
        do i = 1, count
            bins%value(i) = between((i - 0.5_dp) / count)
        end do
        bins%is_even = .true.
        bins%is_log = is_log
        bins%origin = merge(log(max(from, tiny(from))), from, is_log)
        bins%slope = count / (merge(log(max(to, tiny(to))), to, is_log) - bins%origin)

    contains

        !> The edge, or the middle, at a share of the range.
        pure real(dp) function between(share)
            real(dp), intent(in) :: share
            if (is_log) then
                between = from**(1 - share) * to**share
            else
                between = from * (1 - share) + to * share
            end if
        end function between

    end function even_bins

    !> A bin around each of some values: the edges are midway, and as far beyond the first and the last.
    function bins_around(values) result(bins)
        real(dp), intent(in) :: values(:) !! increasing, at least one
        type(bins_t) :: bins
        integer :: n
        real(dp) :: below, above

        n = size(values)
        allocate (bins%value, source=values)
        allocate (bins%edge(n + 1), source=0.0_dp)
        bins%edge(2:n) = values(:n - 1) + (values(2:) - values(:n - 1)) / 2
        below = max(abs(values(1)), tiny(below))
        above = below
        if (n > 1) then
            below = (values(2) - values(1)) / 2
            above = (values(n) - values(n - 1)) / 2
        end if
        bins%edge(1) = values(1) - below
        bins%edge(n + 1) = values(n) + above
    end function bins_around

    !> Number of bins.
    pure integer function count_bins(self)
        class(bins_t), intent(in) :: self
        count_bins = size(self%value)
    end function count_bins

    !> The bin of a value; 0 where it has none, as NaN has.
    pure integer function place(self, value)
        class(bins_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value of the binned quantity; NaN is in no bin
        real(dp) :: x
        integer :: low, high, middle, n

        n = size(self%value)
        place = 0
        if (.not. (value >= self%edge(1) .and. value <= self%edge(n + 1))) return
        if (self%is_even) then
            ! A guess, which may be one beside the bin that the edges say.
            x = value
            if (self%is_log) x = log(value)
            place = int((x - self%origin) * self%slope) + 1
            place = min(max(place, 1), n)
            if (value < self%edge(place)) place = place - 1
            if (place < n) then
                if (value >= self%edge(place + 1)) place = place + 1
            end if
            return
        end if
        low = 1
        high = n + 1
        do while (high - low > 1)
            middle = (low + high) / 2
            if (value < self%edge(middle)) then
                high = middle
            else
                low = middle
            end if
        end do
        place = low
    end function place

    !> Number of the bin of values among the bins of one or two quantities, of which those of the first count fastest; one more
    !> than there are bins if it is in none.
    pure integer(int64) function place_among(bins, values) result(bin)
        type(bins_t), intent(in) :: bins(:) !! of each quantity
        real(dp), intent(in) :: values(:)   !! a value of each
        integer(int64) :: count
        integer :: i, place
        bin = 1
        count = 1
        do i = 1, size(bins)
            place = bins(i)%place(values(i))
            if (place == 0) bin = -huge(bin)
            if (bin > 0) bin = bin + (place - 1) * count
            count = count * bins(i)%count()
        end do
        if (bin < 0) bin = count + 1
    end function place_among

end module spintop_bins
