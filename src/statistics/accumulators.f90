!> Statistics of columns, gathered case by case: number, mean, standard deviation, extremes, quantiles and
!> counts of words, over all cases or over bins of one or two quantities; and what Sobol' indices follow from.
!>
!> They do not depend on the order in which cases are added, nor on how cases are divided among accumulators that
!> are merged: counts are integers, extremes exact, sums as in spintop_order_free_sum.
module spintop_accumulators
    use, intrinsic :: iso_c_binding, only: c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_order_free_sum, only: add_powers, exact_sum_t
    use spintop_kinds, only: dp, no_number, qp
    use spintop_sobol_indices, only: case_groups_t
    use spintop_state_stream, only: state_stream_t
    use spintop_value_counts, only: value_counts_t
    implicit none
    private
    public :: accumulators_t, moments_t
    public :: bins_t, even_bins, bins_around

    !> Bins of one quantity: neighbouring intervals between edges. Bin i holds the values from edge(i) to below edge(i+1); the
    !> last one has its upper edge, too.
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
        procedure :: place
    end type bins_t

    !> What is gathered of one column in one bin.
    type :: moments_t
        !> Cases that have a value.
        integer(int64) :: count = 0
        type(exact_sum_t) :: values, squares
        real(dp) :: minimum = huge(1.0_dp), maximum = -huge(1.0_dp)
        !> The first case of those that have the extreme.
        integer(int64) :: case_of_minimum = 0, case_of_maximum = 0
    contains
        procedure :: add => add_values
        procedure :: merge_with => merge_moments
        procedure :: mean_and_deviation
    end type moments_t

    !> The statistics of columns of numbers and columns of words.
    type :: accumulators_t
        integer(int64) :: bin_count = 1
        !> Cases of each bin, and those of them that failed. After the last bin come the cases that are in none.
        integer(int64), allocatable :: cases(:), failed(:)
        !> Of column i in bin k: `moments(i, k)`.
        type(moments_t), allocatable :: moments(:, :)
        !> Of word j of all columns of words, one after the other, in bin k: `words(j, k)`.
        integer(int64), allocatable :: words(:, :)
        !> Of each column of numbers, over all cases or by bin.
        type(value_counts_t), allocatable :: sizes(:)
        logical :: by_bin = .false.
        !> For Sobol' indices of the columns of numbers over all cases; without factors if none are wanted.
        type(case_groups_t) :: groups
        !> Of no meaning: what `fetch` reads would not be read otherwise.
        integer(int64), private :: fetched = 0
    contains
        procedure :: start
        procedure :: fetch
        procedure :: add
        procedure :: merge_with
        procedure :: store_or_restore
        procedure :: moments_of
        procedure :: quantiles
        procedure :: counts_over_all
    end type accumulators_t

    !> Bits of a cell's significand for quantiles over all cases, and of each bin.
    integer, parameter, public :: bits_over_all = 12, bits_by_bin = 7

contains

    !> Starts with no cases.
    subroutine start(self, bins, columns, words, by_bin)
        class(accumulators_t), intent(out) :: self
        type(bins_t), intent(in) :: bins(:)   !! at most two; none: over all cases
        integer, intent(in) :: columns        !! columns of numbers
        integer, intent(in) :: words          !! words of all columns of words together
        logical, intent(in) :: by_bin         !! whether quantiles of each bin are wanted
        integer :: i

        self%bin_count = product([(size(bins(i)%value, kind=int64), i=1, size(bins))])
        allocate (self%cases(self%bin_count + 1), self%failed(self%bin_count + 1), source=0_int64)
        allocate (self%words(words, self%bin_count + 1), source=0_int64)
        allocate (self%moments(columns, self%bin_count + 1))
        self%by_bin = by_bin
        allocate (self%sizes(columns))
        call self%sizes%start(merge(bits_by_bin, bits_over_all, by_bin), merge(self%bin_count + 1, 1_int64, by_bin))
    end subroutine start

    !> Reads what was gathered in bins to which cases are to be added. Where these lie far apart in memory, reading them
    !> beforehand, none waiting for another, takes a part of the time of one after the other.
    subroutine fetch(self, bins)
        class(accumulators_t), intent(inout) :: self
        integer(int64), intent(in) :: bins(:) !! their numbers
        integer(int64) :: total
        integer :: i, k
        total = 0
        do k = 1, size(bins)
            total = total + self%cases(bins(k))
            do i = 1, size(self%moments, 1)
                ! The first and the last number, and one between them.
                associate (moments => self%moments(i, bins(k)))
                    total = total + moments%count + moments%case_of_maximum + merge(1, 0, moments%minimum > 0)
                end associate
            end do
        end do
        self%fetched = ieor(self%fetched, total)
    end subroutine fetch

    !> Adds consecutive cases of one bin.
    subroutine add(self, numbers, is_ok, bin, values, words)
        class(accumulators_t), intent(inout) :: self
        integer(int64), intent(in) :: numbers(:) !! numbers of the cases, increasing
        logical, intent(in) :: is_ok(:)      !! a case that failed has no values
        integer(int64), intent(in) :: bin    !! its number, one more than there are for none
        real(dp), intent(in) :: values(:, :) !! of each case those of the columns; one that is not finite is none
        integer, intent(in) :: words(:, :)   !! of each case, and column of words, its place among the words of all
        real(dp) :: there(size(numbers))
        integer(int64) :: whose(size(numbers))
        integer :: i, k, n

        self%cases(bin) = self%cases(bin) + size(numbers)
        self%failed(bin) = self%failed(bin) + count(.not. is_ok)
        do i = 1, size(words, 2)
            do k = 1, size(numbers)
                self%words(words(k, i), bin) = self%words(words(k, i), bin) + 1
            end do
        end do
        do i = 1, size(values, 2)
            n = count(is_ok .and. abs(values(:, i)) <= huge(values))
            if (n == size(numbers)) then
                call self%moments(i, bin)%add(numbers, values(:, i))
                call self%sizes(i)%add(merge(bin, 1_int64, self%by_bin), values(:, i))
            else if (n > 0) then
                whose(:n) = pack(numbers, is_ok .and. abs(values(:, i)) <= huge(values))
                there(:n) = pack(values(:, i), is_ok .and. abs(values(:, i)) <= huge(values))
                call self%moments(i, bin)%add(whose(:n), there(:n))
                call self%sizes(i)%add(merge(bin, 1_int64, self%by_bin), there(:n))
            end if
        end do
        if (self%groups%factors > 0) call self%groups%add(numbers, is_ok, transpose(values))
    end subroutine add

    !> Adds the cases of others, started alike.
    subroutine merge_with(self, other)
        class(accumulators_t), intent(inout) :: self
        type(accumulators_t), intent(in) :: other !! accumulators that were started alike; their cases are others

        self%cases = self%cases + other%cases
        self%words = self%words + other%words
        self%failed = self%failed + other%failed
        call self%moments%merge_with(other%moments)
        call self%sizes%merge_with(other%sizes)
        if (self%groups%factors > 0) call self%groups%merge_with(other%groups)
    end subroutine merge_with

    !> Carries all that was gathered.
    subroutine store_or_restore(self, stream)
        class(accumulators_t), target, intent(inout) :: self !! started alike if it is read
        type(state_stream_t), intent(inout) :: stream !! a file
        integer :: i
        call stream%carry_numbers(size(self%cases), self%cases)
        call stream%carry_numbers(size(self%failed), self%failed)
        call stream%carry_numbers(size(self%words), self%words)
        if (size(self%moments) > 0) call stream%carry_memory(c_loc(self%moments(1, 1)), size(self%moments) * &
                                                             (storage_size(self%moments) / 8_int64))
        do i = 1, size(self%sizes)
            call self%sizes(i)%store_or_restore(stream)
        end do
        if (self%groups%factors > 0) call self%groups%store_or_restore(stream)
    end subroutine store_or_restore

    !> The moments of a column in a bin, or, for bin 0, over all cases, those in no bin, too.
    pure type(moments_t) function moments_of(self, column, bin) result(moments)
        class(accumulators_t), intent(in) :: self
        integer, intent(in) :: column     !! number of the column
        integer(int64), intent(in) :: bin !! number of the bin, or 0
        integer(int64) :: i
        do i = max(bin, 1_int64), merge(self%bin_count + 1, bin, bin == 0)
            call moments%merge_with(self%moments(column, i))
        end do
    end function moments_of

    !> Quantiles of a column in a bin, or, for bin 0, over all cases; NaN where they are not gathered.
    subroutine quantiles(self, column, bin, shares, values)
        class(accumulators_t), intent(in) :: self
        integer, intent(in) :: column       !! number of the column
        integer(int64), intent(in) :: bin   !! number of the bin, or 0
        real(dp), intent(in) :: shares(:)   !! p, in [0, 1]
        real(dp), intent(out) :: values(:)  !! the quantiles, one for each share
        type(value_counts_t) :: counts
        type(moments_t) :: moments

        values = no_number
        if (bin == 0) then
            call self%counts_over_all(column, counts)
            call counts%quantiles(1_int64, shares, values)
        else if (self%by_bin) then
            call self%sizes(column)%quantiles(bin, shares, values)
        else
            return
        end if
        ! A cell may reach beyond the extremes, which are exact.
        moments = self%moments_of(column, bin)
        if (moments%count > 0) values = min(max(values, moments%minimum), moments%maximum)
    end subroutine quantiles

    !> How often values of each size occur in a column, over all cases.
    subroutine counts_over_all(self, column, counts)
        class(accumulators_t), intent(in) :: self
        integer, intent(in) :: column !! number of the column
        type(value_counts_t), intent(out) :: counts !! all in bin 1
        call counts%start(merge(bits_by_bin, bits_over_all, self%by_bin), 1_int64)
        call counts%merge_with(self%sizes(column), bin=1_int64)
    end subroutine counts_over_all

    !> Adds finite values.
    pure subroutine add_values(self, numbers, values)
        class(moments_t), intent(inout) :: self
        integer(int64), intent(in) :: numbers(:) !! numbers of the cases
        real(dp), intent(in) :: values(:)        !! a value of each
        integer :: k
        self%count = self%count + size(values)
        call add_powers(values, self%values, self%squares)
        do k = 1, size(values)
            ! Most values change nothing. The first of cases with the same extreme stays.
            if (values(k) > self%minimum .and. values(k) < self%maximum) cycle
            call update_extremes(self, values(k), numbers(k), values(k), numbers(k))
        end do
    end subroutine add_values

    !> Adds the values of others.
    elemental subroutine merge_moments(self, other)
        class(moments_t), intent(inout) :: self
        type(moments_t), intent(in) :: other !! moments of other cases of the same column and bin
        if (other%count == 0) return
        self%count = self%count + other%count
        call self%values%merge_with(other%values)
        call self%squares%merge_with(other%squares)
        call update_extremes(self, other%minimum, other%case_of_minimum, other%maximum, other%case_of_maximum)
    end subroutine merge_moments

    !> Updates the extremes; of cases with the same extreme the first counts.
    pure subroutine update_extremes(self, minimum, case_of_minimum, maximum, case_of_maximum)
        class(moments_t), intent(inout) :: self
        real(dp), intent(in) :: minimum, maximum
        integer(int64), intent(in) :: case_of_minimum, case_of_maximum
        if (minimum < self%minimum .or. self%case_of_minimum == 0 .or. &
            (minimum <= self%minimum .and. case_of_minimum < self%case_of_minimum)) then
            self%minimum = minimum
            self%case_of_minimum = case_of_minimum
        end if
        if (maximum > self%maximum .or. self%case_of_maximum == 0 .or. &
            (maximum >= self%maximum .and. case_of_maximum < self%case_of_maximum)) then
            self%maximum = maximum
            self%case_of_maximum = case_of_maximum
        end if
    end subroutine update_extremes

    !> The mean, and the standard deviation of a sample, over n - 1; NaN where they do not exist. Sum and sum of squares are
    !> exact to 2^-84, so that their difference keeps six digits of a deviation that is 1e-9 of the mean.
    pure function mean_and_deviation(self) result(found)
        class(moments_t), intent(in) :: self
        real(dp) :: found(2)
        real(qp) :: n, total, variance

        found = no_number
        if (self%count == 0) return
        n = self%count
        total = self%values%total()
        found(1) = real(total / n, dp)
        if (self%count == 1) return
        variance = (self%squares%total() - total * (total / n)) / (n - 1)
        found(2) = 0
        if (self%maximum > self%minimum) found(2) = real(sqrt(max(variance, 0.0_qp)), dp)
    end function mean_and_deviation

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

    !> The bin of a value; 0 where it has none, as NaN has.
    pure integer function place(self, value, guess)
        class(bins_t), intent(in) :: self
        real(dp), intent(in) :: value !! the value of the binned quantity; NaN is in no bin
        integer, intent(in), optional :: guess !! a bin in which it may be, or 0
        real(dp) :: x
        integer :: low, high, middle, n

        place = 0
        if (present(guess)) place = guess
        if (place > 0) then
            if (value >= self%edge(place) .and. value < self%edge(place + 1)) return
            place = 0
        end if
        n = size(self%value)
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

end module spintop_accumulators
