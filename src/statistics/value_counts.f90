!> How often values of each size occur, for quantiles of any number of values in bounded memory.
!>
!> A double falls in the cell that its sign, its exponent and the first bits of its significand name, so
!> that a cell is narrow relative to its values, whatever their size. Cells of one sign and exponent are
!> a page, which takes memory once a value falls in it. Counts are integers: they do not depend on the
!> order of the values, nor on how these are divided among partial counts.
module spintop_value_counts
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, no_number
    use spintop_state_stream, only: state_stream_t
    implicit none
    private
    public :: value_counts_t

    integer, parameter :: significand_bits = 52
    !> Sign bit and exponent of a double are below.
    integer, parameter :: exponents = 4096
    !> Pages at first.
    integer, parameter :: pages_at_first = 16

    !> Counts of values in bins.
    type :: value_counts_t
        private
        !> First bits of the significand that tell cells apart.
        integer :: bits = 12
        !> Pages in use; of each its bin, its sign and exponent, and the page with the next larger values in the bin (0: none).
        integer :: pages = 0
        integer(int64), allocatable :: bin_of(:)
        integer, allocatable :: exponent_of(:), next_of(:)
        !> Values in cell i of page k.
        integer(int64), allocatable :: counts(:, :)
        !> The page with the smallest values of each bin (0: none).
        integer, allocatable :: first_of(:)
        !> The pages of bin 1, which is that of most values where there are no others (0: none).
        integer, allocatable :: pages_of_first(:)
    contains
        procedure :: start
        procedure :: add
        procedure :: merge_with
        procedure :: list_cells
        procedure :: quantiles
        procedure :: store_or_restore
    end type value_counts_t

contains

    !> Starts with no values. A cell is 2**-bits wide relative to the values in it, or narrower: the relative error of a
    !> quantile, the middle of its cell, is at most half of that.
    impure elemental subroutine start(self, bits, bins)
        class(value_counts_t), intent(out) :: self
        integer, intent(in) :: bits !! 1 .. 20
        integer(int64), intent(in) :: bins !! number of bins
        self%bits = bits
        allocate (self%pages_of_first(0:exponents - 1), self%first_of(bins), source=0)
        allocate (self%bin_of(0), self%exponent_of(0), self%next_of(0), self%counts(2**bits, 0))
        call grow(self)
    end subroutine start

    !> Carries all counts, page by page: bin, exponent, counts.
    subroutine store_or_restore(self, stream)
        class(value_counts_t), intent(inout) :: self !! empty if they are read
        type(state_stream_t), intent(inout) :: stream !! a file
        integer(int64) :: place(2)
        integer :: k, n, page

        n = self%pages
        place = 0
        call stream%carry_count(n, 2**self%bits)
        do k = 1, n
            page = k
            if (.not. stream%is_read) place = [self%bin_of(page), int(self%exponent_of(page), int64)]
            call stream%carry_numbers(size(place), place)
            if (any(place < [1, 0]) .or. any(place > [size(self%first_of), exponents - 1])) call stream%refuse()
            if (allocated(stream%error)) return
            if (stream%is_read) call find_page(self, place(1), int(place(2)), page)
            call stream%carry_numbers(size(self%counts, 1), self%counts(:, page))
        end do
    end subroutine store_or_restore

    !> Counts finite values.
    subroutine add(self, bin, values)
        class(value_counts_t), intent(inout) :: self
        integer(int64), intent(in) :: bin !! number of the bin, from 1
        real(dp), intent(in) :: values(:) !! the values to count, all finite
        integer(int64) :: word
        integer :: i, page, cell, exponent, last

        last = -1
        page = 0
        do i = 1, size(values)
            ! A zero has no sign here.
            word = transfer(values(i) + 0.0_dp, word)
            cell = int(iand(shiftr(word, significand_bits - self%bits), 2_int64**self%bits - 1)) + 1
            exponent = int(shiftr(word, significand_bits))
            if (exponent /= last) then
                last = exponent
                page = 0
                if (bin == 1) page = self%pages_of_first(exponent)
                if (page == 0) call find_page(self, bin, exponent, page)
            end if
            self%counts(cell, page) = self%counts(cell, page) + 1
        end do
    end subroutine add

    !> Adds the counts of others, of the same resolution.
    impure elemental subroutine merge_with(self, other, bin)
        class(value_counts_t), intent(inout) :: self
        type(value_counts_t), intent(in) :: other !! counts of other values, of the same resolution
        integer(int64), intent(in), optional :: bin !! where all of them are added; otherwise each is in its own bin
        integer(int64) :: place
        integer :: k, page
        do k = 1, other%pages
            place = other%bin_of(k)
            if (present(bin)) place = bin
            call find_page(self, place, other%exponent_of(k), page)
            self%counts(:, page) = self%counts(:, page) + other%counts(:, k)
        end do
    end subroutine merge_with

    !> The cells of a bin that have values, in the order of these.
    subroutine list_cells(self, bin, lower, upper, counts)
        class(value_counts_t), intent(in) :: self
        integer(int64), intent(in) :: bin !! number of the bin, from 1
        real(dp), allocatable, intent(out) :: lower(:), upper(:) !! the ends of each cell, lower <= upper
        integer(int64), allocatable, intent(out) :: counts(:)    !! values in each cell
        real(dp) :: ends(2)
        integer :: i, n, page, cell

        n = 0
        page = self%first_of(bin)
        do while (page > 0)
            n = n + count(self%counts(:, page) > 0)
            page = self%next_of(page)
        end do
        allocate (lower(n), upper(n), counts(n))
        n = 0
        page = self%first_of(bin)
        do while (page > 0)
            do i = 1, size(self%counts, 1)
                cell = cell_in_order(self, i, page)
                if (self%counts(cell, page) == 0) cycle
                n = n + 1
                counts(n) = self%counts(cell, page)
                ends = [end_of_cell(self, page, cell - 1), end_of_cell(self, page, cell)]
                lower(n) = minval(ends)
                upper(n) = maxval(ends)
            end do
            page = self%next_of(page)
        end do
    end subroutine list_cells

    !> Quantiles of the values of a bin: for each share p the middle of the cell that has the value of rank
    !> ceiling(p n); NaN where there are no values.
    subroutine quantiles(self, bin, shares, values)
        class(value_counts_t), intent(in) :: self
        integer(int64), intent(in) :: bin !! number of the bin, from 1
        real(dp), intent(in) :: shares(:)   !! p, in [0, 1]
        real(dp), intent(out) :: values(:)  !! the quantiles, one for each share
        real(dp), allocatable :: lower(:), upper(:)
        integer(int64), allocatable :: counts(:)
        integer(int64) :: ranks(size(shares)), below
        real(dp) :: middle
        integer :: i

        call self%list_cells(bin, lower, upper, counts)
        values = no_number
        ranks = max(ceiling(shares * real(sum(counts), dp), int64), 1_int64)
        below = 0
        do i = 1, size(counts)
            middle = 0 ! that of the cell of zero
            if (abs(lower(i)) > 0) middle = lower(i) / 2 + upper(i) / 2
            where (ranks > below .and. ranks <= below + counts(i)) values = middle
            below = below + counts(i)
        end do
    end subroutine quantiles

    !> The cell of a page that has the values in place i: of negative values those of the largest significand are the smallest.
    pure integer function cell_in_order(self, i, page) result(cell)
        class(value_counts_t), intent(in) :: self
        integer, intent(in) :: i, page
        cell = merge(size(self%counts, 1) + 1 - i, i, self%exponent_of(page) >= exponents / 2)
    end function cell_in_order

    !> Place of a sign and exponent among the values.
    pure integer function order(exponent)
        integer, intent(in) :: exponent !! sign bit and biased exponent, as a double has them
        order = merge(exponents - 1 - exponent, exponents / 2 + exponent, exponent >= exponents / 2)
    end function order

    !> Where a cell ends that is the last of so many of a page.
    pure real(dp) function end_of_cell(self, page, cell) result(value)
        class(value_counts_t), intent(in) :: self
        integer, intent(in) :: page, cell
        integer(int64) :: word
        ! After the last cell of an exponent comes the first of the next one.
        word = shiftl(int(self%exponent_of(page), int64), significand_bits) + &
               shiftl(int(cell, int64), significand_bits - self%bits)
        value = transfer(word, value)
        if (.not. abs(value) <= huge(value)) value = sign(huge(value), value)
    end function end_of_cell

    !> The page of a bin and of a sign and exponent; a new one where it has none.
    subroutine find_page(self, bin, exponent, page)
        class(value_counts_t), intent(inout) :: self
        integer(int64), intent(in) :: bin
        integer, intent(in) :: exponent
        integer, intent(out) :: page
        integer :: before

        before = 0
        page = self%first_of(bin)
        do while (page > 0)
            if (self%exponent_of(page) == exponent) return
            if (order(self%exponent_of(page)) > order(exponent)) exit
            before = page
            page = self%next_of(page)
        end do
        if (self%pages == size(self%bin_of)) call grow(self)
        self%pages = self%pages + 1
        self%bin_of(self%pages) = bin
        self%exponent_of(self%pages) = exponent
        self%next_of(self%pages) = page
        page = self%pages
        if (before == 0) self%first_of(bin) = page
        if (before > 0) self%next_of(before) = page
        if (bin == 1) self%pages_of_first(exponent) = page
    end subroutine find_page

    !> Makes room for twice as many pages.
    subroutine grow(self)
        class(value_counts_t), intent(inout) :: self
        integer(int64), allocatable :: counts(:, :)
        integer :: more

        more = max(pages_at_first, self%pages)
        self%bin_of = [self%bin_of, spread(0_int64, 1, more)]
        self%exponent_of = [self%exponent_of, spread(0, 1, more)]
        self%next_of = [self%next_of, spread(0, 1, more)]
        allocate (counts(2**self%bits, self%pages + more), source=0_int64)
        counts(:, :self%pages) = self%counts
        call move_alloc(counts, self%counts)
    end subroutine grow

end module spintop_value_counts
