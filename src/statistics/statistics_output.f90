!> The tables of statistics, CSV or NetCDF: that of the bins, and beside it that of the histograms, and that of the Sobol'
!> indices if there are any. In NetCDF they have one dimension, the row; numbers of cases, which may be larger than an
!> integer there, are reals.
module spintop_statistics_output
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_errors, only: error_t
    use spintop_histogram, only: histogram_t, make_histogram
    use spintop_kinds, only: dp
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_netcdf_table, only: check_netcdf_table, netcdf_layout_t, netcdf_table_t
    use spintop_row_block, only: row_block_t
    use spintop_sobol_indices, only: sobol_index_t
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_statistics_result, only: index_columns, result_columns, result_row
    use spintop_status, only: last_status
    use spintop_table_column, only: column_of_integers, column_of_reals, table_column_t
    use spintop_table_end, only: check_table
    use spintop_table_file, only: stem_of, table_file_t
    use spintop_table_head, only: is_netcdf, table_head
    use spintop_text, only: string_t
    implicit none
    private
    public :: path_beside, write_statistics_tables, check_statistics_tables

    character, parameter :: nl = new_line('a')
    !> Rows that are written at once.
    integer, parameter :: rows_at_once = 1000
    !> The end of the name of a table of statistics, before that of its format.
    character(*), parameter :: ending = '.statistics'

    !> A table that is being written, under another name until it is complete.
    type :: result_file_t
        type(error_t), allocatable :: error
        logical, private :: is_netcdf = .false.
        type(table_column_t), allocatable, private :: columns(:)
        type(table_file_t), private :: text
        type(netcdf_table_t), private :: netcdf
        type(row_block_t), private :: block
    contains
        procedure :: create
        procedure :: add
        procedure :: finish
    end type result_file_t

contains

    !> Creates a table for so many rows.
    subroutine create(self, path, head, columns, rows, is_netcdf)
        class(result_file_t), intent(out) :: self
        character(*), intent(in) :: path, head !! path of the table, and its header
        type(table_column_t), intent(in) :: columns(:)
        integer(int64), intent(in) :: rows
        logical, intent(in) :: is_netcdf
        type(netcdf_layout_t) :: layout

        self%is_netcdf = is_netcdf
        self%columns = columns
        call self%block%reserve(size(columns), rows_at_once)
        if (is_netcdf) then
            where (self%columns%kind == column_of_integers) self%columns%kind = column_of_reals
            layout%axes = [netcdf_axis_t('row', int(rows))]
            if (columns(1)%kind == column_of_integers) layout%axes(1)%name = columns(1)%name
            if (columns(1)%kind == column_of_integers) self%columns(1)%axis = 1
            call self%netcdf%create(path, head, self%columns, layout, self%error)
        else
            call self%text%create_beside(path, head, self%error)
        end if
    end subroutine create

    !> Adds a row.
    subroutine add(self, cells)
        class(result_file_t), intent(inout) :: self
        real(dp), intent(in) :: cells(:)
        if (self%block%rows == rows_at_once) call pass_on(self)
        self%block%rows = self%block%rows + 1
        self%block%cells(:, self%block%rows) = cells
    end subroutine add

    !> Writes the rows of the block, and empties it.
    subroutine pass_on(self)
        class(result_file_t), intent(inout) :: self
        if (allocated(self%error)) then
            continue
        else if (self%is_netcdf) then
            call self%netcdf%add_rows(self%block%cells(:, :self%block%rows))
        else
            call self%block%format(self%columns)
            call self%text%append(self%block%text%contents(), self%error)
        end if
        call self%block%clear()
    end subroutine pass_on

    !> Finishes the table, or removes it if there is an error.
    subroutine finish(self, error)
        class(result_file_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(string_t) :: no_lines(0)
        call pass_on(self)
        if (self%is_netcdf) then
            if (.not. allocated(self%error)) call self%netcdf%finish(self%error)
        else
            if (.not. allocated(self%error)) call self%text%finish(no_lines, self%error)
            call self%text%discard()
        end if
        call move_alloc(self%error, error)
    end subroutine finish

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
        type(accumulators_t), intent(inout) :: accumulators !! the statistics; only sorted
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_column_t), allocatable :: columns(:)
        type(result_file_t) :: file
        real(dp), allocatable :: cells(:)
        integer(int64) :: bin, last

        call write_histograms(path_beside(path, 'histogram'), head, plan, accumulators, error)
        if (.not. allocated(error) .and. plan%has_indices()) then
            call write_indices(path_beside(path, 'indices'), head, plan, accumulators, error)
        end if
        if (allocated(error)) return
        columns = result_columns(plan)
        last = merge(plan%bin_count(), 0_int64, size(plan%over) > 0)
        call file%create(path, head, columns, last + 1, plan%is_netcdf)
        allocate (cells(size(columns)))
        do bin = 0, last
            if (allocated(file%error)) exit
            call result_row(plan, accumulators, bin, cells)
            call file%add(cells)
        end do
        call file%finish(error)
    end subroutine write_statistics_tables

    !> Writes the table of histograms: the intervals of each column.
    subroutine write_histograms(path, head, plan, accumulators, error)
        character(*), intent(in) :: path, head
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        type(error_t), allocatable, intent(out) :: error
        type(table_column_t) :: columns(4)
        type(histogram_t) :: histograms(size(plan%numbers))
        type(result_file_t) :: file
        integer :: i, k

        columns = [table_column_t('column', '', 'the column of the sweep'), &
                   table_column_t('from', '', 'lower end of an interval, in the unit of the column'), &
                   table_column_t('to', '', 'its upper end; intervals without values between two others are left out'), &
                   table_column_t('cases', '', 'cases with a value in it', column_of_integers)]
        call columns(1)%set_words(plan%numbers%name)
        do i = 1, size(histograms)
            call make_histogram(accumulators, i, histograms(i))
        end do
        call file%create(path, head_of(columns, head), columns, &
                         sum([(size(histograms(i)%counts, kind=int64), i=1, size(histograms))]), plan%is_netcdf)
        do i = 1, size(histograms)
            associate (histogram => histograms(i))
                do k = 1, size(histogram%counts)
                    call file%add([real(i - 1, dp), histogram%from(k), histogram%to(k), real(histogram%counts(k), dp)])
                end do
            end associate
        end do
        call file%finish(error)
    end subroutine write_histograms

    !> Writes the table of Sobol' indices: the factors of each column.
    subroutine write_indices(path, head, plan, accumulators, error)
        character(*), intent(in) :: path, head
        type(statistics_plan_t), intent(in) :: plan
        type(accumulators_t), intent(in) :: accumulators
        type(error_t), allocatable, intent(out) :: error
        type(table_column_t), allocatable :: columns(:)
        type(sobol_index_t) :: index
        type(result_file_t) :: file
        integer :: i, k

        columns = index_columns(plan)
        call file%create(path, head_of(columns, head), columns, size(plan%numbers) * size(plan%factors, kind=int64), &
                         plan%is_netcdf)
        do i = 1, size(plan%numbers)
            associate (indices => accumulators%groups%indices(i))
                do k = 1, size(plan%factors)
                    call indices%estimate(k, index)
                    call file%add([real(i - 1, dp), real(k - 1, dp), &
                                   index%first, index%first - index%first_error, index%first + index%first_error, &
                                   index%total, index%total - index%total_error, index%total + index%total_error, &
                                   real(sum(indices%added), dp), real(indices%left_out, dp)])
                end do
            end associate
        end do
        call file%finish(error)
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

    !> Checks that all tables are complete, and as they were written.
    subroutine check_statistics_tables(path, plan, problem)
        character(*), intent(in) :: path !! path of the table of the bins
        type(statistics_plan_t), intent(in) :: plan !! what was gathered
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        call check(path)
        if (problem == '') call check(path_beside(path, 'histogram'))
        if (problem == '' .and. plan%has_indices()) call check(path_beside(path, 'indices'))

    contains

        subroutine check(table)
            character(*), intent(in) :: table
            integer(int64) :: no_counts(0:last_status)
            no_counts = 0
            if (is_netcdf(table)) then
                call check_netcdf_table(table, problem, no_counts)
            else
                call check_table(table, problem)
            end if
        end subroutine check

    end subroutine check_statistics_tables

end module spintop_statistics_output
