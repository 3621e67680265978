!> The result of statistics as CSV: the table of the bins, and beside it that of the histograms, and that of the
!> Sobol' indices if there are any.
module spintop_statistics_csv
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_errors, only: error_t
    use spintop_histogram, only: histogram_t, make_histogram
    use spintop_row_block, only: row_block_t
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_statistics_result, only: index_cells, index_row, result_columns, result_row
    use spintop_table_column, only: column_of_integers, table_column_t
    use spintop_table_end, only: check_table
    use spintop_table_file, only: table_file_t
    use spintop_table_head, only: table_head
    use spintop_text, only: string_t
    implicit none
    private
    public :: path_beside, write_statistics_csv, check_statistics_csv

    character, parameter :: nl = new_line('a')
    !> Rows that are written at once.
    integer, parameter :: rows_at_once = 1000
    !> The end of the name of a table of statistics.
    character(*), parameter :: ending = '.statistics.csv'

contains

    !> The path of a table beside a table of statistics, as NAME.histogram.csv.
    pure function path_beside(path, name) result(beside)
        character(*), intent(in) :: path !! path of the table of statistics
        character(*), intent(in) :: name !! what the other table contains
        character(:), allocatable :: beside
        integer :: last
        last = len(path)
        if (index(path, '.csv', back=.true.) == len(path) - 3) last = len(path) - len('.csv')
        if (len(path) > len(ending)) then
            if (path(len(path) - len(ending) + 1:) == ending) last = len(path) - len(ending)
        end if
        beside = path(:last) // '.' // name // '.csv'
    end function path_beside

    !> Writes all tables, each under another name until it is complete.
    subroutine write_statistics_csv(path, head, plan, accumulators, error)
        character(*), intent(in) :: path !! path of the table
        character(*), intent(in) :: head !! its header, ready to write
        type(statistics_plan_t), intent(in) :: plan !! what is gathered
        type(accumulators_t), intent(inout) :: accumulators !! the statistics; only sorted
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_column_t), allocatable :: columns(:)
        type(table_file_t) :: file
        type(row_block_t) :: rows
        integer(int64) :: bin, last

        call write_histograms(path_beside(path, 'histogram'), head, plan, accumulators, error)
        if (.not. allocated(error) .and. plan%has_indices()) then
            call write_indices(path_beside(path, 'indices'), head, plan, accumulators, error)
        end if
        if (allocated(error)) return
        columns = result_columns(plan)
        call file%create_beside(path, head, error)
        last = merge(plan%bin_count(), 0_int64, size(plan%over) > 0)
        call rows%reserve(size(columns), rows_at_once)
        do bin = 0, last
            if (allocated(error)) exit
            rows%rows = rows%rows + 1
            call result_row(plan, accumulators, bin, rows%cells(:, rows%rows))
            if (rows%rows == rows_at_once .or. bin == last) call write_rows(file, columns, rows, error)
        end do
        call finish(file, error)
    end subroutine write_statistics_csv

    !> Writes the table of histograms: the intervals of each column.
    subroutine write_histograms(path, head, plan, accumulators, error)
        character(*), intent(in) :: path, head
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        type(error_t), allocatable, intent(out) :: error
        type(table_column_t) :: columns(4)
        type(histogram_t) :: histogram
        type(table_file_t) :: file
        type(row_block_t) :: rows
        integer :: i, k

        columns = [table_column_t('column', '', 'the column of the sweep'), &
                   table_column_t('from', '', 'lower end of an interval, in the unit of the column'), &
                   table_column_t('to', '', 'its upper end; intervals without values between two others are left out'), &
                   table_column_t('cases', '', 'cases with a value in it', column_of_integers)]
        call columns(1)%set_words(plan%numbers%name)
        call file%create_beside(path, head_of(columns, head), error)
        do i = 1, size(plan%numbers)
            if (allocated(error)) exit
            call make_histogram(accumulators, i, histogram)
            call rows%reserve(size(columns), max(1, size(histogram%counts)))
            do k = 1, size(histogram%counts)
                rows%cells(:, k) = [real(i - 1, kind(rows%cells)), histogram%from(k), histogram%to(k), &
                                    real(histogram%counts(k), kind(rows%cells))]
                rows%rows = k
            end do
            call write_rows(file, columns, rows, error)
        end do
        call finish(file, error)
    end subroutine write_histograms

    !> Writes the table of Sobol' indices: the factors of each column.
    subroutine write_indices(path, head, plan, accumulators, error)
        character(*), intent(in) :: path, head
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        type(error_t), allocatable, intent(out) :: error
        type(table_column_t) :: columns(2 + index_cells)
        type(table_file_t) :: file
        type(row_block_t) :: rows
        integer :: i, k

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
        call file%create_beside(path, head_of(columns, head), error)
        do i = 1, size(plan%numbers)
            if (allocated(error)) exit
            call rows%reserve(size(columns), size(plan%factors))
            do k = 1, size(plan%factors)
                rows%cells(1:2, k) = [i - 1, k - 1]
                call index_row(accumulators, i, k, rows%cells(3:, k))
                rows%rows = k
            end do
            call write_rows(file, columns, rows, error)
        end do
        call finish(file, error)
    end subroutine write_indices

    !> The header of a table beside that of the statistics: its provenance, and other columns.
    function head_of(columns, head) result(text)
        type(table_column_t), intent(in) :: columns(:)
        character(*), intent(in) :: head
        character(:), allocatable :: text
        character(*), parameter :: mark = '# columns:' // nl
        type(string_t) :: lines(size(columns))
        integer :: i
        do i = 1, size(columns)
            lines(i)%text = '    ' // trim(columns(i)%name) // ': ' // trim(columns(i)%what)
        end do
        text = head(:index(head, mark) - 1) // mark // table_head(lines, columns%name)
    end function head_of

    !> Writes rows, and empties their block.
    subroutine write_rows(file, columns, rows, error)
        type(table_file_t), intent(inout) :: file
        type(table_column_t), intent(in) :: columns(:)
        type(row_block_t), intent(inout) :: rows
        type(error_t), allocatable, intent(out) :: error
        call rows%format(columns)
        call file%append(rows%text%contents(), error)
        call rows%clear()
    end subroutine write_rows

    !> Finishes a table, or removes it if there is an error.
    subroutine finish(file, error)
        type(table_file_t), intent(inout) :: file
        type(error_t), allocatable, intent(inout) :: error
        type(string_t) :: no_lines(0)
        if (.not. allocated(error)) call file%finish(no_lines, error)
        call file%discard()
    end subroutine finish

    !> Checks that all tables are complete, and as they were written.
    subroutine check_statistics_csv(path, plan, problem)
        character(*), intent(in) :: path !! path of the table
        type(statistics_plan_t), intent(in) :: plan !! what was gathered
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        call check_table(path, problem)
        if (problem == '') call check_table(path_beside(path, 'histogram'), problem)
        if (problem == '' .and. plan%has_indices()) call check_table(path_beside(path, 'indices'), problem)
    end subroutine check_statistics_csv

end module spintop_statistics_csv
