!> The result of statistics as rows of a table: the first of all cases, then one of each bin. And the columns of the
!> Sobol' indices.
module spintop_statistics_result
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t, moments_t, summary_of_column_t
    use spintop_histogram, only: most_intervals
    use spintop_kinds, only: dp, no_number
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_table_column, only: column_of_integers, column_of_reals, table_column_t
    use spintop_text, only: replace_all, to_text
    implicit none
    private
    public :: result_columns, result_row, columns_before, index_columns, bytes_of_result

    !> Columns of a binned quantity (value, and ends of the bin), columns of counts of a bin, and columns of a
    !> column of numbers beside its quantiles.
    integer, parameter :: columns_of_over = 3, columns_of_cases = 2, columns_of_number = 7

contains

    !> The columns of the table of Sobol' indices, which has a row for each column and factor.
    function index_columns(plan) result(columns)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(table_column_t), allocatable :: columns(:)
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
    end function index_columns

    !> Number of columns that tell the bin, before those that tell of its cases.
    pure integer function columns_before(plan)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        columns_before = 1 + columns_of_over * size(plan%over)
    end function columns_before

    !> The columns of the result.
    function result_columns(plan) result(columns)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(table_column_t), allocatable :: columns(:)
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
            call add_number(plan%numbers(i))
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

        subroutine add_number(number)
            type(table_column_t), intent(in) :: number
            character(:), allocatable :: name
            integer :: q
            name = trim(number%name)
            call add(name // '_count', '', 'cases that have a value of ' // name, column_of_integers)
            call add(name // '_mean', number%unit, 'mean: ' // number%what, column_of_reals)
            call add(name // '_deviation', number%unit, 'standard deviation of ' // name // ', over n - 1', column_of_reals)
            call add(name // '_min', number%unit, 'minimum of ' // name, column_of_reals)
            call add(name // '_min_case', '', 'first case with it; 0 if there is none', column_of_integers)
            call add(name // '_max', number%unit, 'maximum of ' // name, column_of_reals)
            call add(name // '_max_case', '', 'first case with it; 0 if there is none', column_of_integers)
            do q = 1, size(plan%shares)
                call add(name // '_q' // to_text(plan%shares(q)), number%unit, 'quantile of ' // name // '; ' &
                         // trim(merge('relative error below 0.004 ', 'relative error below 0.0002', plan%by_bin)) &
                         // merge('                   ', ', of all cases only', plan%by_bin), column_of_reals)
            end do
        end subroutine add_number

        subroutine add(name, unit, what, kind)
            character(*), intent(in) :: name, unit, what
            integer, intent(in) :: kind
            n = n + 1
            columns(n)%name = name
            columns(n)%unit = unit
            columns(n)%what = what
            columns(n)%kind = kind
        end subroutine add

    end function result_columns

    !> The cells of the row of a bin, or, for bin 0, of all cases.
    subroutine result_row(plan, accumulators, bin, cells)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(inout) :: accumulators !! the statistics; only sorted
        integer(int64), intent(in) :: bin !! number of the bin, or 0
        real(dp), intent(out) :: cells(:) !! as many as there are columns
        type(moments_t) :: moments
        type(summary_of_column_t) :: summary
        integer(int64) :: words(plan%word_count()), rest
        integer :: i, n, place

        cells(1) = real(bin, dp)
        n = 1
        rest = bin - 1
        do i = 1, size(plan%over)
            associate (bins => plan%over(i)%bins)
                if (bin == 0) then
                    cells(n + 1:n + columns_of_over) = no_number
                else
                    place = int(mod(rest, int(bins%count(), int64))) + 1
                    rest = rest / bins%count()
                    cells(n + 1:n + columns_of_over) = [bins%value(place), bins%edge(place), bins%edge(place + 1)]
                end if
            end associate
            n = n + columns_of_over
        end do
        if (bin == 0) then
            cells(n + 1:n + 2) = real([sum(accumulators%cases), sum(accumulators%failed)], dp)
            words = sum(accumulators%words, dim=2)
        else
            cells(n + 1:n + 2) = real([accumulators%cases(bin), accumulators%failed(bin)], dp)
            words = accumulators%words(:, bin)
        end if
        n = n + columns_of_cases
        do i = 1, size(plan%numbers)
            if (bin == 0) then
                moments = accumulators%over_all(i)
            else
                moments = accumulators%moments(i, bin)
            end if
            summary = moments%summary()
            cells(n + 1:n + columns_of_number) = [real(summary%count, dp), summary%mean, summary%deviation, &
                summary%minimum, real(summary%case_of_minimum, dp), summary%maximum, real(summary%case_of_maximum, dp)]
            n = n + columns_of_number
            call accumulators%quantiles(i, bin, plan%shares, cells(n + 1:n + size(plan%shares)))
            n = n + size(plan%shares)
        end do
        cells(n + 1:) = real(words, dp)
    end subroutine result_row

    !> Bytes of all tables of a result, at most and about: those of bins, histograms and Sobol' indices.
    real(dp) function bytes_of_result(plan) result(bytes)
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        integer, parameter :: cells_of_interval = 4
        real(dp), parameter :: bytes_of_double = 8, bytes_of_text = 18
        real(dp) :: cells
        cells = 1
        if (size(plan%over) > 0) cells = cells + real(plan%bin_count(), dp)
        cells = cells * size(result_columns(plan)) + size(plan%numbers) * most_intervals * cells_of_interval
        if (plan%has_indices()) cells = cells + size(plan%numbers) * size(plan%factors) * size(index_columns(plan))
        bytes = cells * merge(bytes_of_double, bytes_of_text, plan%is_netcdf)
    end function bytes_of_result

end module spintop_statistics_result
