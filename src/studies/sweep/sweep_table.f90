!> The table of a sweep: its columns (case, swept parameters, status, quantities, notes), the cells of
!> a row, and the file that takes them.
module spintop_sweep_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_compare, only: is_finite
    use spintop_errors, only: error_t
    use spintop_growing_table, only: growing_table_t
    use spintop_job, only: job_t
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_netcdf_table, only: netcdf_table_t
    use spintop_nutation, only: class_names
    use spintop_parameter_print, only: print_namelist
    use spintop_provenance, only: describe_provenance, fact_count, fact_t, gather_facts
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_shard, only: shard_t
    use spintop_status, only: status_names, status_non_finite, status_ok
    use spintop_sweep_axes, only: axes_t, combine_grid
    use spintop_sweep_columns, only: quantities, q_energy_error_max, q_motion_class, q_phi_end, q_psi_end, q_t_end, &
        q_theta_end, sweep_columns
    use spintop_sweep_notes, only: note_names, note_t
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_words, table_column_t
    use spintop_table_head, only: comment_lines, table_head
    use spintop_text, only: string_t
    implicit none
    private
    public :: describe_table, start_table, reserve_rows, put_row

    !> The column with the number of the case.
    character(*), parameter :: case_column = 'case'
    !> Quantities that every case has which ends well.
    integer, parameter :: always_defined(*) = [q_t_end, q_theta_end, q_phi_end, q_psi_end, q_energy_error_max]

contains

    !> The table of a job in the format it asks for, not yet started, and its head as text: tables
    !> with the same head are the same. That of a part has the head of the whole below a line that
    !> tells the part.
    subroutine describe_table(job, shard, table, head)
        type(job_t), intent(in) :: job
        type(shard_t), intent(in) :: shard
        class(row_table_t), allocatable, intent(out) :: table
        character(:), allocatable, intent(out) :: head
        type(fact_t) :: facts(fact_count)
        type(string_t), allocatable :: input(:), header(:), part(:)

        if (job%scene%format == 'netcdf') then
            allocate (netcdf_table_t :: table)
        else
            allocate (growing_table_t :: table)
        end if
        call describe_columns(job, table%columns)
        call gather(job, facts, input)
        call describe_provenance(facts, input, table%columns%name, table%columns%unit, table%columns%what, header)
        allocate (part(merge(1, 0, shard%is_part())))
        if (shard%is_part()) part(1)%text = shard%line(job%axes%cases)
        head = comment_lines(part) // table_head(header, table%columns%name)
    end subroutine describe_table

    !> Starts the table, or goes on with one (`resume`) of the same head; what an interrupted run has left is
    !> discarded only if that is asked for (`restart`).
    subroutine start_table(job, resume, restart, head, table, error)
        type(job_t), intent(in) :: job
        logical, intent(in) :: resume, restart
        character(*), intent(in) :: head
        class(row_table_t), intent(inout) :: table
        type(error_t), allocatable, intent(out) :: error
        type(fact_t) :: facts(fact_count)
        type(string_t), allocatable :: input(:)

        select type (table)
        type is (growing_table_t)
            call table%start(job%output, head, resume, restart, error)
        type is (netcdf_table_t)
            call gather(job, facts, input)
            call table%start(job%output, facts, input, grid_of(job%axes), error)
        end select
    end subroutine start_table

    !> Where the table comes from, and the resolved input.
    subroutine gather(job, facts, input)
        type(job_t), intent(in) :: job
        type(fact_t), intent(out) :: facts(fact_count)
        type(string_t), allocatable, intent(out) :: input(:)
        call print_namelist(job%table, input)
        call gather_facts(job%scene%title, job%plan%model, job%plan%method, dated=.false., facts=facts)
    end subroutine gather

    !> The grid of the cases: that of the axes, or one case after the other.
    function grid_of(axes) result(grid)
        type(axes_t), intent(in) :: axes
        type(netcdf_axis_t), allocatable :: grid(:)
        integer :: i
        if (axes%combination == combine_grid) then
            allocate (grid(size(axes%axis)))
            do i = 1, size(grid)
                grid(i) = netcdf_axis_t(axes%axis(i)%name, axes%axis(i)%count)
            end do
        else
            allocate (grid(1))
            grid(1) = netcdf_axis_t(case_column, int(axes%cases))
        end if
    end function grid_of

    !> What the cells of a row are; `put_row` has them in this order.
    subroutine describe_columns(job, columns)
        type(job_t), intent(in) :: job
        type(table_column_t), allocatable, intent(out) :: columns(:)
        integer :: i, axes

        axes = size(job%axes%axis)
        allocate (columns(axes + size(job%columns) + 3))
        columns(1) = table_column_t(case_column, '', 'number of the case', column_of_integers)
        do i = 1, axes
            associate (name => job%axes%axis(i)%name, column => columns(1 + i))
                associate (parameter => job%table%parameters(job%axes%place_of(i, job%table)))
                    column = table_column_t(name, parameter%unit, parameter%what)
                    if (job%axes%combination == combine_grid) column%axis = i
                end associate
            end associate
        end do
        columns(axes + 2) = table_column_t('status', '', 'ok, or what failed', column_of_words)
        call take_words([status_names], columns(axes + 2))
        do i = 1, size(job%columns)
            associate (quantity => sweep_columns(job%columns(i)), column => columns(axes + 2 + i))
                column = table_column_t(quantity%name, quantity%unit, quantity%what)
                if (job%columns(i) /= q_motion_class) cycle
                column%kind = column_of_words
                call take_words([character(len(class_names)) :: 'none', class_names], column)
            end associate
        end do
        columns(size(columns)) = table_column_t('notes', '', 'why a quantity does not exist', column_of_notes)
        call take_words(note_names, columns(size(columns)))
    end subroutine describe_columns

    subroutine take_words(words, column)
        character(*), intent(in) :: words(:)
        type(table_column_t), intent(inout) :: column
        integer :: i
        allocate (column%words(size(words)))
        do i = 1, size(words)
            column%words(i)%text = trim(words(i))
        end do
    end subroutine take_words

    !> Empties a block, with room for so many rows.
    subroutine reserve_rows(job, count, rows)
        type(job_t), intent(in) :: job
        integer, intent(in) :: count
        type(row_block_t), intent(inout) :: rows
        call rows%reserve(size(job%axes%axis) + size(job%columns) + 3, count)
    end subroutine reserve_rows

    !> Adds the row of a case to a block.
    subroutine put_row(job, number, parameters, status, values, note, rows)
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: number !! of the case
        real(dp), intent(in) :: parameters(:) !! the swept ones
        integer, intent(in) :: status
        real(dp), intent(in) :: values(quantities)
        type(note_t), intent(in) :: note
        type(row_block_t), intent(inout) :: rows
        integer :: i, told

        ! What a case does not have is a NaN with a note; what overflowed is a failure.
        told = status
        if (status == status_ok .and. overflowed(job, values)) told = status_non_finite
        rows%rows = rows%rows + 1
        associate (cells => rows%cells(:, rows%rows), axes => size(parameters))
            cells(1) = real(number, dp)
            cells(2:axes + 1) = parameters
            cells(axes + 2) = told
            ! As an assignment of arrays this takes memory from the heap for each row.
            do i = 1, size(job%columns)
                cells(axes + 2 + i) = values(job%columns(i))
            end do
            cells(size(cells)) = note%flags
        end associate
        call rows%set_note(note%text)
        rows%counts(told) = rows%counts(told) + 1
    end subroutine put_row

    !> Whether a quantity of the table is infinite, or the end of the motion undefined.
    pure logical function overflowed(job, values)
        type(job_t), intent(in) :: job
        real(dp), intent(in) :: values(quantities)
        integer :: i
        overflowed = .false.
        do i = 1, size(job%columns)
            associate (value => values(job%columns(i)))
                overflowed = overflowed .or. abs(value) > huge(value)
                if (any(job%columns(i) == always_defined)) overflowed = overflowed .or. .not. is_finite(value)
            end associate
        end do
    end function overflowed

end module spintop_sweep_table
