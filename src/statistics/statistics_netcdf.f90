!> The result of statistics as a NetCDF file of the classic format with 64-bit offsets, by the CF conventions: every
!> column is a variable over the grid of the bins, with their middles as coordinates and their ends as bounds. A
!> variable `all_NAME` is that of all cases. The histogram of a column is a variable over its intervals.
module spintop_statistics_netcdf
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_errors, only: error_t
    use spintop_histogram, only: histogram_t, make_histogram
    use spintop_kinds, only: dp
    use spintop_netcdf_file, only: netcdf_contents_t, netcdf_file_t, whole_file, write_netcdf
    use spintop_netcdf_grid, only: netcdf_name
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_statistics_result, only: columns_before, index_cells, index_row, result_columns, result_row
    use spintop_table_column, only: column_of_reals, table_column_t
    use spintop_text, only: join, split, string_t
    implicit none
    private
    public :: write_statistics_netcdf

    character, parameter :: nl = new_line('a')
    !> Prefix of the variables of all cases.
    character(*), parameter :: of_all = 'all_'

    !> What the file contains.
    type, extends(netcdf_contents_t) :: statistics_contents_t
        character(:), allocatable :: head
        type(statistics_plan_t) :: plan
        type(table_column_t), allocatable :: columns(:)
        type(accumulators_t), pointer :: accumulators => null()
        type(histogram_t), allocatable :: histograms(:)
        !> The variables of each column: over the bins (-1: none), and of all cases.
        integer, allocatable :: of_bins(:), of_all(:)
        !> Those of each binned quantity: the middles, and the ends.
        integer, allocatable :: middles(:), ends(:)
        !> Those of each column of numbers: cases in its intervals, and the ends of these.
        integer, allocatable :: counts(:), intervals(:)
        !> The factors of Sobol' indices; and of each column the first-order indices with their bounds, the total ones with
        !> theirs, groups of cases that have values, and those that were left out.
        integer :: factor = -1
        integer, allocatable :: indices(:, :)
    contains
        procedure :: put => put_statistics
    end type statistics_contents_t

contains

    !> Writes the file.
    subroutine write_statistics_netcdf(path, head, plan, accumulators, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: head !! header of the result as a table has it
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), target, intent(inout) :: accumulators !! the statistics; only sorted
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(statistics_contents_t) :: contents
        integer, parameter :: classic = -1
        integer :: i

        contents%head = head
        contents%plan = plan
        contents%accumulators => accumulators
        contents%columns = result_columns(plan)
        contents%columns%kind = column_of_reals
        allocate (contents%histograms(size(plan%numbers)))
        do i = 1, size(plan%numbers)
            call make_histogram(accumulators, i, contents%histograms(i))
        end do
        call write_netcdf(path, contents, classic, error)
    end subroutine write_statistics_netcdf

    !> Puts all to a file.
    subroutine put_statistics(self, file)
        class(statistics_contents_t), intent(inout) :: self
        type(netcdf_file_t), intent(inout) :: file !! the open file
        call add_facts(file, self%head)
        call define(self, file)
        call put_columns(self, file)
        if (self%plan%has_indices()) call put_indices(self, file)
    end subroutine put_statistics

    !> Adds the metadata of the header as attributes of the file.
    subroutine add_facts(file, head)
        type(netcdf_file_t), intent(inout) :: file
        character(*), intent(in) :: head
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: input
        integer :: i, colon

        call file%add_text(whole_file, 'Conventions', 'CF-1.8')
        call split(head, nl, lines, keeps_blanks=.true.)
        do i = 1, size(lines)
            if (lines(i)%text == '# input:') exit
            colon = index(lines(i)%text, ': ')
            if (colon > 0) call file%add_text(whole_file, lines(i)%text(len('# ') + 1:colon - 1), lines(i)%text(colon + 2:))
        end do
        input = ''
        do i = i + 1, size(lines)
            if (lines(i)%text == '# columns:') exit
            input = input // lines(i)%text(min(len('#     '), len(lines(i)%text)) + 1:) // nl
        end do
        if (input /= '') call file%add_text(whole_file, 'input', input(:len(input) - 1))
    end subroutine add_facts

    !> Defines dimensions and variables.
    subroutine define(self, file)
        type(statistics_contents_t), intent(inout) :: self
        type(netcdf_file_t), intent(inout) :: file
        character(:), allocatable :: name
        integer :: bins(size(self%plan%over)), end, intervals, i

        associate (plan => self%plan, columns => self%columns, before => columns_before(self%plan))
            self%of_bins = [(-1, i=1, size(columns))]
            self%of_all = self%of_bins
            self%middles = [(-1, i=1, size(bins))]
            self%ends = self%middles
            self%counts = [(-1, i=1, size(plan%numbers))]
            self%intervals = self%counts
            call file%add_dimension('end', 2, end)
            ! The first varies fastest, and stands last in the file.
            do i = size(bins), 1, -1
                call file%add_dimension(netcdf_name(plan%over(i)%column%name), plan%over(i)%bins%count(), bins(i))
            end do
            do i = 1, size(bins)
                name = netcdf_name(plan%over(i)%column%name)
                call add_variable(file, name, plan%over(i)%column, [bins(i)], self%middles(i))
                call file%add_text(self%middles(i), 'bounds', name // '_bounds')
                call add_variable(file, name // '_bounds', plan%over(i)%column, [end, bins(i)], self%ends(i))
            end do
            do i = before + 1, size(columns)
                name = netcdf_name(columns(i)%name)
                if (size(bins) > 0 .and. (plan%by_bin .or. index(columns(i)%name, '_q') == 0 .or. &
                                          columns(i)%what(:len('quantile')) /= 'quantile')) then
                    call add_variable(file, name, columns(i), bins, self%of_bins(i))
                end if
                call add_variable(file, of_all // name, columns(i), bins(:0), self%of_all(i))
            end do
            do i = 1, size(plan%numbers)
                if (size(self%histograms(i)%counts) == 0) cycle
                name = netcdf_name(plan%numbers(i)%name)
                call file%add_dimension(name // '_interval', size(self%histograms(i)%counts), intervals)
                call add_variable(file, name // '_interval_bounds', plan%numbers(i), [end, intervals], self%intervals(i))
                call add_variable(file, name // '_histogram', columns(before + 1), [intervals], self%counts(i))
            end do
            if (plan%has_indices()) call define_indices(self, file, end)
        end associate
    end subroutine define

    !> Defines the variables of the Sobol' indices: those of each column over the factors, whose names are the meanings
    !> of their numbers.
    subroutine define_indices(self, file, end)
        type(statistics_contents_t), intent(inout) :: self
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: end !! the dimension of the ends of an interval
        character(:), allocatable :: name, stem
        integer :: i, k, factor

        associate (plan => self%plan)
            call file%add_dimension('factor', size(plan%factors), factor)
            call add_variable(file, 'factor', table_column_t('factor', '', 'the parameter of an axis'), [factor], self%factor)
            call file%add_numbers(self%factor, 'flag_values', numbers_of_factors(plan), column_of_reals)
            call file%add_text(self%factor, 'flag_meanings', join(plan%factors%name, ' '))
            self%indices = reshape([(-1, i=1, 6 * size(plan%numbers))], [6, size(plan%numbers)])
            do k = 1, size(plan%numbers)
                name = trim(plan%numbers(k)%name)
                stem = netcdf_name(name)
                call add('_first_order', 'share of the variance of ' // name // ' that is due to a factor alone', 1, [factor])
                call file%add_text(self%indices(1, k), 'bounds', stem // '_first_order_bounds')
                call add('_first_order_bounds', 'interval of 95 %', 2, [end, factor])
                call add('_total', 'share of the variance of ' // name // ' that is due to a factor with all its interactions', &
                         3, [factor])
                call file%add_text(self%indices(3, k), 'bounds', stem // '_total_bounds')
                call add('_total_bounds', 'interval of 95 %', 4, [end, factor])
                call add('_groups', 'groups of cases that have values of ' // name, 5, [integer ::])
                call add('_groups_left_out', 'groups with a case that has no value of ' // name, 6, [integer ::])
            end do
        end associate

    contains

        subroutine add(suffix, what, i, dimensions)
            character(*), intent(in) :: suffix, what
            integer, intent(in) :: i, dimensions(:)
            type(table_column_t) :: column
            column%name = name
            column%what = what
            call add_variable(file, stem // suffix, column, dimensions, self%indices(i, k))
        end subroutine add

    end subroutine define_indices

    !> Adds a variable of reals, whatever the kind of its column in a table.
    subroutine add_variable(file, name, column, dimensions, variable)
        type(netcdf_file_t), intent(inout) :: file
        character(*), intent(in) :: name
        type(table_column_t), intent(in) :: column
        integer, intent(in) :: dimensions(:)
        integer, intent(out) :: variable
        call file%add_variable(name, table_column_t(column%name, column%unit, column%what), dimensions, variable)
    end subroutine add_variable

    !> The numbers of the factors, from 0.
    pure function numbers_of_factors(plan) result(numbers)
        type(statistics_plan_t), intent(in) :: plan
        real(dp) :: numbers(size(plan%factors))
        integer :: i
        numbers = [(real(i - 1, dp), i=1, size(plan%factors))]
    end function numbers_of_factors

    !> Puts the Sobol' indices.
    subroutine put_indices(self, file)
        type(statistics_contents_t), intent(in) :: self
        type(netcdf_file_t), intent(inout) :: file
        real(dp) :: cells(index_cells, size(self%plan%factors))
        integer :: i, k, n

        n = size(cells, 2)
        call file%put(self%factor, numbers_of_factors(self%plan), [1], [n])
        do k = 1, size(self%plan%numbers)
            do i = 1, n
                call index_row(self%accumulators, k, i, cells(:, i))
            end do
            associate (indices => self%indices(:, k))
                call file%put(indices(1), cells(1, :), [1], [n])
                call put_ends(file, indices(2), cells(2, :), cells(3, :))
                call file%put(indices(3), cells(4, :), [1], [n])
                call put_ends(file, indices(4), cells(5, :), cells(6, :))
                call file%put(indices(5), cells(7, :1), [1], [1])
                call file%put(indices(6), cells(8, :1), [1], [1])
            end associate
        end do
    end subroutine put_indices

    !> Puts bins, columns and histograms.
    subroutine put_columns(self, file)
        type(statistics_contents_t), intent(inout) :: self
        type(netcdf_file_t), intent(inout) :: file
        real(dp), allocatable :: cells(:, :)
        integer :: i, k, n, line

        associate (plan => self%plan, columns => self%columns)
            allocate (cells(size(columns), 1))
            call result_row(plan, self%accumulators, 0_int64, cells(:, 1))
            do i = columns_before(plan) + 1, size(columns)
                call file%put(self%of_all(i), cells(i, :), [1], [1])
            end do
            do i = 1, size(self%histograms)
                associate (histogram => self%histograms(i))
                    call file%put(self%counts(i), real(histogram%counts, dp), [1], [size(histogram%counts)])
                    call put_ends(file, self%intervals(i), histogram%from, histogram%to)
                end associate
            end do
            if (size(plan%over) == 0) return
            do i = 1, size(plan%over)
                associate (bins => plan%over(i)%bins)
                    call file%put(self%middles(i), bins%value, [1], [bins%count()])
                    call put_ends(file, self%ends(i), bins%edge(:bins%count()), bins%edge(2:))
                end associate
            end do
            n = plan%over(1)%bins%count()
            deallocate (cells)
            allocate (cells(size(columns), n))
            do line = 1, int(plan%bin_count() / n)
                do k = 1, n
                    call result_row(plan, self%accumulators, (line - 1_int64) * n + k, cells(:, k))
                end do
                do i = columns_before(plan) + 1, size(columns)
                    if (self%of_bins(i) < 0) cycle
                    if (size(plan%over) == 1) then
                        call file%put(self%of_bins(i), cells(i, :), [1], [n])
                    else
                        call file%put(self%of_bins(i), cells(i, :), [1, line], [n, 1])
                    end if
                end do
            end do
        end associate
    end subroutine put_columns

    !> Puts the ends of bins or intervals.
    subroutine put_ends(file, variable, from, to)
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: variable
        real(dp), intent(in) :: from(:), to(:)
        real(dp) :: both(2, size(from))
        both(1, :) = from
        both(2, :) = to
        call file%put(variable, reshape(both, [size(both)]), [1, 1], shape(both))
    end subroutine put_ends

end module spintop_statistics_netcdf
