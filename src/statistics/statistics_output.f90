!> The tables of statistics, CSV or NetCDF: that of the bins, a row of all cases and one of each bin; and beside it that of the
!> histograms, and that of the Sobol' indices if there are any. In NetCDF they have one dimension, the row; numbers of cases,
!> which may be larger than an integer there, are reals.
module spintop_statistics_output
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t, moments_t
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp, no_number
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_netcdf_table, only: check_whole_table, netcdf_layout_t, netcdf_table_t
    use spintop_row_block, only: row_block_t
    use spintop_sobol_indices, only: sobol_index_t
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_status, only: last_status
    use spintop_table_column, only: column_of_integers, column_of_reals, table_column_t
    use spintop_journaled_table, only: stem_of, table_file_t
    use spintop_table_head, only: table_head
    use spintop_text, only: replace_all, string_t, to_text
    use spintop_value_counts, only: value_counts_t
    implicit none
    private
    public :: path_beside, write_statistics_tables, check_statistics_tables, result_columns, columns_before, bytes_of_result
    public :: find_intervals, most_intervals

    !> Columns of a binned quantity (value, and ends of the bin), columns of counts of a bin, and columns of a
    !> column of numbers beside its quantiles.
    integer, parameter :: columns_of_over = 3, columns_of_cases = 2, columns_of_number = 7
    !> Columns of the tables of histograms and of Sobol' indices.
    integer, parameter :: cells_of_interval = 4, cells_of_index = 10
    character, parameter :: nl = new_line('a')
    !> Rows that are written at once.
    integer, parameter :: rows_at_once = 1000
    !> The end of the name of a table of statistics, before that of its format.
    character(*), parameter :: ending = '.statistics'

    !> Maximum number of intervals of a histogram.
    integer, parameter :: most_intervals = 100

contains

    !> The path of a table beside a table of statistics, as NAME.histogram.csv.
    pure function path_beside(path, name) result(beside)
        character(*), intent(in) :: path !! path of the table of statistics
        character(*), intent(in) :: name !! what the other table contains
        character(:), allocatable :: beside, stem, format
        stem = stem_of(path)
        format = path(len(stem) + 1:)
        if (format == '') format = '.csv'
        if (len(stem) > len(ending)) then
            if (stem(len(stem) - len(ending) + 1:) == ending) stem = stem(:len(stem) - len(ending))
        end if
        beside = stem // '.' // name // format
    end function path_beside

    !> Writes all tables.
    subroutine write_statistics_tables(path, head, plan, accumulators, error)
        character(*), intent(in) :: path !! path of the table of the bins
        character(*), intent(in) :: head !! its header, ready to write
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(in) :: accumulators !! the statistics
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_column_t) :: of_intervals(cells_of_interval), of_indices(cells_of_index)
        real(dp), allocatable :: rows(:, :)
        integer(int64) :: last

        call make_histograms(plan, accumulators, of_intervals, rows)
        call write_table(path_beside(path, 'histogram'), head, of_intervals, plan, error, rows)
        if (.not. allocated(error) .and. plan%has_indices()) then
            call make_indices(plan, accumulators, of_indices, rows)
            call write_table(path_beside(path, 'indices'), head, of_indices, plan, error, rows)
        end if
        if (allocated(error)) return
        last = merge(plan%bin_count(), 0_int64, size(plan%over) > 0)
        call write_table(path, head, result_columns(plan), plan, error, accumulators=accumulators, last=last)
    end subroutine write_statistics_tables

    !> Writes a table, under another name until it is complete: of all cases and the bins to the last, or of the given rows,
    !> which stands beside it.
    subroutine write_table(path, head_of_bins, columns, plan, error, rows, accumulators, last)
        character(*), intent(in) :: path, head_of_bins !! path of the table, and the header of that of the bins
        type(table_column_t), intent(in) :: columns(:)
        type(statistics_plan_t), intent(in) :: plan
        type(error_t), allocatable, intent(out) :: error
        real(dp), intent(in), optional :: rows(:, :) !! the cell of column i in row k is `rows(i, k)`
        type(accumulators_t), intent(in), optional :: accumulators
        integer(int64), intent(in), optional :: last
        type(table_column_t) :: reals(size(columns))
        type(netcdf_layout_t) :: layout
        type(netcdf_table_t) :: netcdf
        type(table_file_t) :: text
        type(row_block_t) :: block
        type(string_t) :: no_lines(0), meanings(size(columns))
        character(*), parameter :: mark = '# columns:' // nl
        character(:), allocatable :: head
        integer(int64) :: all, first, k
        integer :: i

        head = head_of_bins
        if (present(rows)) then ! the same provenance, and other columns
            do i = 1, size(columns)
                meanings(i)%text = '    ' // trim(columns(i)%name) // ': ' // trim(columns(i)%what)
            end do
            head = head(:index(head, mark) - 1) // mark // table_head(meanings, columns%name)
            all = size(rows, 2)
        else
            all = last + 1
        end if
        if (plan%is_netcdf) then
            reals = columns
            where (columns%kind == column_of_integers) reals%kind = column_of_reals
            layout%axes = [netcdf_axis_t('row', int(all))]
            if (columns(1)%kind == column_of_integers) layout%axes(1)%name = columns(1)%name
            if (columns(1)%kind == column_of_integers) reals(1)%axis = 1
            call netcdf%create(path, head, reals, layout, error)
        else
            call text%create_beside(path, head, error)
        end if
        do first = 1, all, rows_at_once
            if (allocated(error)) exit
            call block%reserve(size(columns), rows_at_once)
            do k = first, min(first + rows_at_once - 1, all)
                block%rows = block%rows + 1
                if (present(rows)) block%cells(:, block%rows) = rows(:, k)
                if (.not. present(rows)) call find_row(plan, accumulators, k - 1, block%cells(:, block%rows))
            end do
            if (plan%is_netcdf) then
                call netcdf%add_rows(block%cells(:, :block%rows))
            else
                call block%format(columns)
                call text%append(block%text%contents(), error)
            end if
        end do
        if (plan%is_netcdf) then
            if (.not. allocated(error)) call netcdf%finish(error)
        else
            if (.not. allocated(error)) call text%finish(no_lines, error)
            call text%discard()
        end if
    end subroutine write_table

    !> The table of histograms, which has a row for each interval of a column.
    subroutine make_histograms(plan, accumulators, columns, rows)
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        type(table_column_t), intent(out) :: columns(cells_of_interval)
        real(dp), allocatable, intent(out) :: rows(:, :)
        real(dp) :: all(cells_of_interval, most_intervals * size(plan%numbers))
        integer :: i, n, more

        columns = [table_column_t('column', '', 'the column of the sweep'), &
                   table_column_t('from', '', 'lower end of an interval, in the unit of the column'), &
                   table_column_t('to', '', 'its upper end; intervals without values between two others are left out'), &
                   table_column_t('cases', '', 'cases with a value in it', column_of_integers)]
        call columns(1)%set_words(plan%numbers%name)
        n = 0
        do i = 1, size(plan%numbers)
            call find_intervals(accumulators, i, all(2:, n + 1:), more)
            all(1, n + 1:n + more) = i - 1
            n = n + more
        end do
        rows = all(:, :n)
    end subroutine make_histograms

    !> The table of Sobol' indices, which has a row for each column and factor.
    subroutine make_indices(plan, accumulators, columns, rows)
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        type(table_column_t), intent(out) :: columns(cells_of_index)
        real(dp), allocatable, intent(out) :: rows(:, :)
        type(sobol_index_t) :: index
        integer :: i, k, n

        columns = [table_column_t('column', '', 'the column of the sweep'), &
                   table_column_t('factor', '', 'the parameter of an axis'), &
                   table_column_t('first_order', '', 'share of the variance that is due to the factor alone'), &
                   table_column_t('first_order_low', '', 'lower end of its interval of 95 %'), &
                   table_column_t('first_order_high', '', 'upper end of its interval of 95 %'), &
                   table_column_t('total', '', 'share that is due to the factor with all its interactions'), &
                   table_column_t('total_low', '', 'lower end of its interval of 95 %'), &
                   table_column_t('total_high', '', 'upper end of its interval of 95 %'), &
                   table_column_t('groups', '', 'groups of cases that have values', column_of_integers), &
                   table_column_t('left_out', '', 'groups with a case that has no value', column_of_integers)]
        call columns(1)%set_words(plan%numbers%name)
        call columns(2)%set_words(plan%factors%name)
        allocate (rows(size(columns), size(plan%factors) * size(plan%numbers)))
        n = 0
        do i = 1, size(plan%numbers)
            associate (indices => accumulators%groups%indices(i))
                do k = 1, size(plan%factors)
                    call indices%estimate(k, index)
                    n = n + 1
                    rows(:, n) = [real(i - 1, dp), real(k - 1, dp), &
                                  index%first, index%first - index%first_error, index%first + index%first_error, &
                                  index%total, index%total - index%total_error, index%total + index%total_error, &
                                  real(sum(indices%added), dp), real(indices%left_out, dp)]
                end do
            end associate
        end do
    end subroutine make_indices

    !> Checks that all tables are complete, and as they were written.
    subroutine check_statistics_tables(path, plan, problem)
        character(*), intent(in) :: path !! path of the table of the bins
        type(statistics_plan_t), intent(in) :: plan !! what was gathered
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        integer(int64) :: no_counts(0:last_status)
        no_counts = 0
        call check_whole_table(path, problem, no_counts)
        if (problem == '') call check_whole_table(path_beside(path, 'histogram'), problem, no_counts)
        if (problem == '' .and. plan%has_indices()) call check_whole_table(path_beside(path, 'indices'), problem, no_counts)
    end subroutine check_statistics_tables

    !> Number of columns that tell the bin, before those that tell of its cases.
    pure integer function columns_before(plan)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        columns_before = 1 + columns_of_over * size(plan%over)
    end function columns_before

    !> The columns of the result.
    function result_columns(plan) result(columns)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(table_column_t), allocatable :: columns(:)
        character(:), allocatable :: name
        integer :: i, k, n

        n = columns_before(plan) + columns_of_cases + size(plan%numbers) * (columns_of_number + size(plan%shares)) &
            + plan%word_count()
        allocate (columns(n))
        n = 0
        call add('bin', '', 'number of the bin; 0 is all cases, those in no bin, too', column_of_integers)
        do i = 1, size(plan%over)
            associate (over => plan%over(i)%column)
                call add(trim(over%name), over%unit, 'middle of the bin: ' // over%what, column_of_reals)
                call add(trim(over%name) // '_from', over%unit, 'lower end of the bin', column_of_reals)
                call add(trim(over%name) // '_to', over%unit, 'upper end of the bin', column_of_reals)
            end associate
        end do
        call add('cases', '', 'number of cases', column_of_integers)
        call add('failed', '', 'number of those that failed, and are in none of the statistics', column_of_integers)
        do i = 1, size(plan%numbers)
            associate (number => plan%numbers(i))
                name = trim(number%name)
                call add(name // '_count', '', 'cases that have a value of ' // name, column_of_integers)
                call add(name // '_mean', number%unit, 'mean: ' // number%what, column_of_reals)
                call add(name // '_deviation', number%unit, 'standard deviation of ' // name // ', over n - 1', column_of_reals)
                call add(name // '_min', number%unit, 'minimum of ' // name, column_of_reals)
                call add(name // '_min_case', '', 'first case with it; 0 if there is none', column_of_integers)
                call add(name // '_max', number%unit, 'maximum of ' // name, column_of_reals)
                call add(name // '_max_case', '', 'first case with it; 0 if there is none', column_of_integers)
                do k = 1, size(plan%shares)
                    call add(name // '_q' // to_text(plan%shares(k)), number%unit, 'quantile of ' // name // '; ' &
                             // trim(merge('relative error below 0.004 ', 'relative error below 0.0002', plan%by_bin)) &
                             // merge('                   ', ', of all cases only', plan%by_bin), column_of_reals)
                end do
            end associate
        end do
        do i = 1, size(plan%categories)
            associate (category => plan%categories(i))
                do k = 1, size(category%words)
                    call add(trim(category%name) // '_' // replace_all(category%words(k)%text, ' ', '_'), '', &
                             'cases with ' // trim(category%name) // ' ' // category%words(k)%text, column_of_integers)
                end do
            end associate
        end do

    contains

        subroutine add(name, unit, what, kind)
            character(*), intent(in) :: name, unit, what
            integer, intent(in) :: kind
            n = n + 1
            columns(n) = table_column_t(name, unit, what, kind)
        end subroutine add

    end function result_columns

    !> The cells of the row of a bin, or, for bin 0, of all cases.
    subroutine find_row(plan, accumulators, bin, cells)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(in) :: accumulators !! the statistics
        integer(int64), intent(in) :: bin !! number of the bin, or 0
        real(dp), intent(out) :: cells(:) !! as many as there are columns
        type(moments_t) :: moments
        real(dp) :: extremes(2)
        integer(int64) :: words(plan%word_count()), rest, from, to
        integer :: i, n, place

        from = max(bin, 1_int64)
        to = merge(size(accumulators%cases, kind=int64), bin, bin == 0)
        cells(1) = real(bin, dp)
        n = 1
        rest = bin - 1
        do i = 1, size(plan%over)
            associate (bins => plan%over(i)%bins)
                if (bin == 0) then
                    cells(n + 1:n + columns_of_over) = no_number
                else
                    place = int(mod(rest, size(bins%value, kind=int64))) + 1
                    rest = rest / size(bins%value)
                    cells(n + 1:n + columns_of_over) = [bins%value(place), bins%edge(place), bins%edge(place + 1)]
                end if
            end associate
            n = n + columns_of_over
        end do
        cells(n + 1:n + 2) = real([sum(accumulators%cases(from:to)), sum(accumulators%failed(from:to))], dp)
        words = sum(accumulators%words(:, from:to), dim=2)
        n = n + columns_of_cases
        do i = 1, size(plan%numbers)
            moments = accumulators%moments_of(i, bin)
            extremes = merge([moments%minimum, moments%maximum], no_number, moments%count > 0)
            cells(n + 1:n + columns_of_number) = [real(moments%count, dp), moments%mean_and_deviation(), &
                extremes(1), real(moments%case_of_minimum, dp), extremes(2), real(moments%case_of_maximum, dp)]
            n = n + columns_of_number
            call accumulators%quantiles(i, bin, plan%shares, cells(n + 1:n + size(plan%shares)))
            n = n + size(plan%shares)
        end do
        cells(n + 1:) = real(words, dp)
    end subroutine find_row

    !> Bytes of all tables of a result, at most and about: those of bins, histograms and Sobol' indices.
    real(dp) function bytes_of_result(plan) result(bytes)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        real(dp), parameter :: bytes_of_double = 8, bytes_of_text = 18
        real(dp) :: cells
        cells = 1
        if (size(plan%over) > 0) cells = cells + real(plan%bin_count(), dp)
        cells = cells * size(result_columns(plan)) + size(plan%numbers) * most_intervals * cells_of_interval
        if (plan%has_indices()) cells = cells + size(plan%numbers) * size(plan%factors) * cells_of_index
        bytes = cells * merge(bytes_of_double, bytes_of_text, plan%is_netcdf)
    end function bytes_of_result

    !> The histogram of a column over all cases: neighbouring intervals of nearly equal widths, from the minimum to the maximum,
    !> whose ends are ends of the cells in which the values were counted, so that the numbers of values are exact.
    subroutine find_intervals(accumulators, column, intervals, found)
        type(accumulators_t), intent(in) :: accumulators !! the statistics
        integer, intent(in) :: column !! number of the column of numbers
        real(dp), intent(inout) :: intervals(:, :) !! of each its ends, and the number of values in it; at least `most_intervals`
        integer, intent(out) :: found !! number of intervals; 0 if no case has a value
        type(value_counts_t) :: cells
        type(moments_t) :: all
        real(dp), allocatable :: lower(:), upper(:)
        integer(int64), allocatable :: counts(:)
        integer :: i, here

        call accumulators%counts_over_all(column, cells)
        call cells%list_cells(1_int64, lower, upper, counts)
        all = accumulators%moments_of(column, 0_int64)
        found = 0
        here = 0
        do i = 1, size(counts)
            ! A cell belongs to the interval in which its lower end lies.
            if (found == 0 .or. interval(lower(i)) > here) then
                here = interval(lower(i))
                found = found + 1
                intervals(:, found) = [lower(i), 0.0_dp, 0.0_dp]
            end if
            intervals(2, found) = upper(i)
            intervals(3, found) = intervals(3, found) + counts(i)
        end do
        if (found == 0) return
        intervals(1, 1) = all%minimum
        intervals(2, found) = all%maximum

    contains

        !> The interval of a value, of so many of equal width.
        pure integer function interval(value)
            real(dp), intent(in) :: value
            real(dp) :: share
            ! Halves, for the range may be larger than the largest number.
            share = (value / 2 - all%minimum / 2) / max(all%maximum / 2 - all%minimum / 2, tiny(share))
            interval = min(max(int(share * most_intervals) + 1, 1), most_intervals)
        end function interval

    end subroutine find_intervals

end module spintop_statistics_output
