!> What statistics are gathered of: the columns, the quantities over which there are bins, the quantiles. The
!> cells of a row are those of the table of all cases, whether or not that table is written.
module spintop_statistics_plan
    use, intrinsic :: iso_c_binding, only: c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t, bins_t, bits_by_bin, bits_over_all, moments_t
    use spintop_kinds, only: dp
    use spintop_sobol_indices, only: sobol_indices_t
    use spintop_state_stream, only: state_stream_t
    use spintop_table_column, only: table_column_t
    implicit none
    private
    public :: statistics_plan_t, binned_t

    !> A quantity over which there are bins.
    type :: binned_t
        type(table_column_t) :: column
        type(bins_t) :: bins
        !> Its cell in a row.
        integer :: cell = 0
    end type binned_t

    !> What is gathered.
    type :: statistics_plan_t
        !> Whether statistics are asked for at all.
        logical :: is_wanted = .false.
        type(binned_t), allocatable :: over(:) !! at most two
        !> The columns of numbers and those of words, and their cells in a row.
        type(table_column_t), allocatable :: numbers(:), categories(:)
        integer, allocatable :: cells_of_numbers(:), cells_of_categories(:)
        !> The cell with the status.
        integer :: status_cell = 0
        !> The quantiles, in [0, 1], and whether each bin has its own.
        real(dp), allocatable :: shares(:)
        logical :: by_bin = .false.
        !> The factors whose Sobol' indices are computed, and the groups of their design; no factors if none are.
        type(table_column_t), allocatable :: factors(:)
        integer(int64) :: groups = 0
        !> Whether the result is a NetCDF file.
        logical :: is_netcdf = .false.
    contains
        procedure :: bin_count
        procedure :: has_indices
        procedure :: word_count
        procedure :: bytes
        procedure :: bytes_of_bins
        procedure :: start
        procedure :: carry
    end type statistics_plan_t

    !> Bytes of a counter.
    integer, parameter :: byte = 8
    !> More groups than any sweep has: each number of them is a real.
    integer(int64), parameter :: most_groups = 2_int64**53
    !> Most columns of bins.
    integer, parameter :: most_over = 2
    !> What a column and a count take in the file at least.
    type(table_column_t), parameter :: any_column = table_column_t()
    integer, parameter :: bytes_of_column = len(any_column%name) + len(any_column%unit) + len(any_column%what), &
        bytes_of_count = storage_size(most_groups) / 8
    !> Exponents that the values of a column have, as a rule, where memory is estimated: those of one sign
    !> between 1/16 and 16.
    integer, parameter :: usual_exponents = 8, usual_exponents_of_bin = 1

contains

    !> Number of bins.
    pure integer(int64) function bin_count(self)
        class(statistics_plan_t), intent(in) :: self
        integer :: i
        bin_count = product([(size(self%over(i)%bins%value, kind=int64), i=1, size(self%over))])
    end function bin_count

    !> Whether Sobol' indices are computed.
    pure logical function has_indices(self)
        class(statistics_plan_t), intent(in) :: self
        has_indices = .false.
        if (allocated(self%factors)) has_indices = size(self%factors) > 0 .and. size(self%numbers) > 0
    end function has_indices

    !> Number of words of all columns of words together.
    pure integer function word_count(self)
        class(statistics_plan_t), intent(in) :: self
        integer :: i
        word_count = sum([(size(self%categories(i)%words), i=1, size(self%categories))])
    end function word_count

    !> Memory of the accumulators, about: that of quantiles depends on the values.
    pure real(dp) function bytes(self)
        class(statistics_plan_t), intent(in) :: self
        real(dp) :: of_quantiles
        of_quantiles = usual_exponents * 2.0_dp**bits_over_all
        if (self%by_bin) of_quantiles = (self%bin_count() + 1.0_dp) * usual_exponents_of_bin * 2.0_dp**bits_by_bin
        bytes = self%bytes_of_bins() + size(self%numbers) * byte * of_quantiles
    end function bytes

    !> Memory of the accumulators without that of quantiles.
    pure real(dp) function bytes_of_bins(self)
        class(statistics_plan_t), intent(in) :: self
        type(moments_t) :: moments
        type(sobol_indices_t) :: indices
        bytes_of_bins = (self%bin_count() + 1.0_dp) * (byte * (2 + self%word_count()) &
                                                       + size(self%numbers) * (storage_size(moments) / 8.0_dp))
        if (.not. self%has_indices()) return
        indices%factors = size(self%factors)
        bytes_of_bins = bytes_of_bins + real(byte, dp) * size(self%numbers) * indices%packed_size()
    end function bytes_of_bins

    !> Starts accumulators with no cases.
    subroutine start(self, accumulators)
        class(statistics_plan_t), intent(in) :: self
        type(accumulators_t), intent(out) :: accumulators !! ready for cases
        call accumulators%start(self%over%bins, size(self%numbers), self%word_count(), self%by_bin)
        if (self%has_indices()) call accumulators%groups%start(size(self%factors), self%groups, size(self%numbers))
    end subroutine start

    !> Writes a plan, or reads it: then it does not know the cells of a row.
    subroutine carry(self, stream)
        class(statistics_plan_t), target, intent(inout) :: self
        type(state_stream_t), intent(inout) :: stream !! the file
        logical :: is_valid
        integer :: i, n

        n = 0
        if (allocated(self%over)) n = size(self%over)
        call stream%carry_count(n, bytes_of_column)
        if (stream%is_read) allocate (self%over(n))
        do i = 1, n
            call carry_column(stream, self%over(i)%column)
            call stream%carry_list(self%over(i)%bins%edge)
            call stream%carry_list(self%over(i)%bins%value)
        end do
        call carry_columns(stream, self%numbers)
        call carry_columns(stream, self%categories)
        call stream%carry_list(self%shares)
        call stream%carry_flag(self%by_bin)
        call stream%carry_flag(self%is_netcdf)
        call carry_columns(stream, self%factors)
        call stream%carry_memory(c_loc(self%groups), storage_size(self%groups) / 8_int64)
        if (.not. stream%is_read .or. allocated(stream%error)) return
        self%is_wanted = .true.
        is_valid = size(self%over) <= most_over .and. &
                   all([(size(self%over(i)%bins%edge) == size(self%over(i)%bins%value) + 1, i=1, size(self%over))])
        if (is_valid .and. size(self%factors) > 0) then
            is_valid = self%has_indices() .and. self%groups >= 1 .and. self%groups <= most_groups
        end if
        if (.not. is_valid) call stream%refuse()
    end subroutine carry

    subroutine carry_columns(stream, columns)
        type(state_stream_t), intent(inout) :: stream
        type(table_column_t), allocatable, intent(inout) :: columns(:)
        integer :: i, n
        n = 0
        if (allocated(columns)) n = size(columns)
        call stream%carry_count(n, bytes_of_column)
        if (stream%is_read) allocate (columns(n))
        do i = 1, n
            call carry_column(stream, columns(i))
        end do
    end subroutine carry_columns

    subroutine carry_column(stream, column)
        type(state_stream_t), intent(inout) :: stream
        type(table_column_t), intent(inout) :: column
        integer :: k, n, length

        call stream%carry_text(column%name)
        call stream%carry_text(column%unit)
        call stream%carry_text(column%what)
        call stream%carry_count(column%kind, 1)
        n = 0
        if (allocated(column%words)) n = size(column%words)
        call stream%carry_count(n, bytes_of_count)
        if (stream%is_read) allocate (column%words(n))
        do k = 1, n
            length = 0
            if (.not. stream%is_read) length = len(column%words(k)%text)
            call stream%carry_count(length, 1)
            if (stream%is_read) column%words(k)%text = repeat(' ', length)
            call stream%carry_text(column%words(k)%text)
        end do
    end subroutine carry_column

end module spintop_statistics_plan
