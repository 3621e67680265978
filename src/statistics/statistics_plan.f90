!> What statistics are gathered of: the columns, the quantities over which there are bins, the quantiles. The
!> cells of a row are those of the table of all cases, whether or not that table is written.
module spintop_statistics_plan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t, bits_by_bin, bits_over_all, moments_t
    use spintop_bins, only: bins_t
    use spintop_kinds, only: dp
    use spintop_sobol_indices, only: sobol_indices_t
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
    end type statistics_plan_t

    !> Bytes of a counter.
    integer, parameter :: byte = 8
    !> Exponents that the values of a column have, as a rule, where memory is estimated: those of one sign
    !> between 1/16 and 16.
    integer, parameter :: usual_exponents = 8, usual_exponents_of_bin = 1

contains

    !> Number of bins.
    pure integer(int64) function bin_count(self)
        class(statistics_plan_t), intent(in) :: self
        integer :: i
        bin_count = 1
        do i = 1, size(self%over)
            bin_count = bin_count * self%over(i)%bins%count()
        end do
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
        word_count = 0
        do i = 1, size(self%categories)
            word_count = word_count + size(self%categories(i)%words)
        end do
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

end module spintop_statistics_plan
