!> The table of a sweep: its columns (case, swept parameters, status, quantities, notes), and the file that
!> takes its rows.
module spintop_sweep_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_finite
    use spintop_row_table, only: row_table_t
    use spintop_job, only: job_t, study_head
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_nutation, only: class_names
    use spintop_parameters, only: unset_integer
    use spintop_row_block, only: row_block_t
    use spintop_scene_keys, only: combine_grid
    use spintop_statistics_output, only: result_columns
    use spintop_statistics_table, only: statistics_table_t
    use spintop_status, only: is_good_end, status_names, status_non_finite
    use spintop_study_column, only: always, proof_group, study_column_t
    use spintop_sweep_engine, only: slot_t
    use spintop_sweep_quantities, only: explain_missing
    use spintop_sweep_result, only: at_motion_class, at_proof, note_names, note_no_turns_known, proof_cells
    use spintop_table_column, only: column_of_integers, column_of_notes, status_column, table_column_t
    use spintop_table_head, only: shard_t
    implicit none
    private
    public :: describe_table, describe_columns, cells_of_row, add_rows

    !> Name of the column with the number of the case.
    character(*), parameter :: case_column = 'case'

contains

    !> The table of a job in its format, not yet started, and its header as text: tables with equal headers
    !> are equal. The header of a part is the header of the whole, after a line that names the part.
    subroutine describe_table(job, shard, table, head)
        type(job_t), intent(in) :: job !! the job
        type(shard_t), intent(in) :: shard !! the part
        class(row_table_t), allocatable, intent(out) :: table !! not yet started
        character(:), allocatable, intent(out) :: head !! the header
        type(statistics_table_t), allocatable :: with_statistics
        type(table_column_t), allocatable :: columns(:)
        integer :: i

        if (job%statistics%is_wanted) then
            allocate (with_statistics)
            with_statistics%keeps_rows = job%keeps_rows()
            with_statistics%plan = job%statistics
            with_statistics%is_part = shard%is_part()
            with_statistics%result_path = job%files%table
            if (job%keeps_rows()) with_statistics%result_path = job%files%statistics
            ! In a variable, since gfortran 12 fails at the result of a function as an argument of a class.
            allocate (columns, source=result_columns(with_statistics%plan))
            with_statistics%result_head = study_head(job, columns, part=shard%beginning(job%axes%cases))
            if (.not. job%keeps_rows()) head = with_statistics%result_head
            call move_alloc(with_statistics, table)
        else
            allocate (row_table_t :: table)
        end if
        call describe_columns(job, table%columns)
        if (job%input%scene%format == 'netcdf' .and. job%keeps_rows()) then
            allocate (table%netcdf)
            table%netcdf%axes = [netcdf_axis_t(case_column, int(job%axes%cases))]
            if (job%axes%combination == combine_grid) table%netcdf%axes = &
                [(netcdf_axis_t(job%axes%axis(i)%name, job%axes%axis(i)%count), i=1, size(job%axes%axis))]
            if (job%input%scene%compression /= unset_integer) table%netcdf%compression = job%input%scene%compression
        end if
        if (job%keeps_rows()) head = study_head(job, table%columns, part=shard%beginning(job%axes%cases))
    end subroutine describe_table

    !> What the cells of a row are; `add_rows` has them in this order.
    subroutine describe_columns(job, columns)
        type(job_t), intent(in) :: job !! the job
        type(table_column_t), allocatable, intent(out) :: columns(:) !! one for each cell
        integer :: i, axes

        axes = size(job%axes%axis)
        allocate (columns(cells_of_row(job)))
        columns(1) = table_column_t(case_column, '', 'number of the case', column_of_integers)
        do i = 1, axes
            columns(1 + i)%column_t = job%axis_column(i)
            if (job%axes%combination == combine_grid) columns(1 + i)%axis = i
        end do
        columns(axes + 2) = table_column_t(status_column, '', 'ok, or the reason of the failure')
        call columns(axes + 2)%set_words([status_names])
        do i = 1, size(job%columns)
            associate (source => job%columns(i)%source, column => columns(axes + 2 + i))
                column%column_t = job%columns(i)%column_t
                if (source == at_motion_class) call column%set_words([character(len(class_names)) :: 'none', class_names])
                if (source == at_proof) call column%set_words(proof_cells)
            end associate
        end do
        columns(size(columns) - 2 * job%sensitivities%count:size(columns) - 1)%column_t = job%sensitivities%table_columns()
        columns(size(columns)) = table_column_t('notes', '', 'reasons why quantities do not exist')
        call columns(size(columns))%set_words(note_names, column_of_notes)
    end subroutine describe_columns

    !> Cells of a row: number of the case, swept parameters, status, quantities, sensitivities, notes.
    pure integer function cells_of_row(job) result(cells)
        type(job_t), intent(in) :: job !! the job
        cells = size(job%axes%axis) + size(job%columns) + 2 * job%sensitivities%count + 3
    end function cells_of_row

    !> Adds the rows of cases to a block. What a case does not have is a NaN with a note; what overflowed is a
    !> failure.
    subroutine add_rows(columns, first, parameters, slots, rows)
        type(study_column_t), intent(in) :: columns(:) !! the columns
        integer(int64), intent(in) :: first !! number of the first case
        real(dp), intent(in) :: parameters(:, :) !! the swept ones of each case
        type(slot_t), intent(inout) :: slots(:) !! the cases of the block
        type(row_block_t), intent(inout) :: rows !! the rows of the block
        real(dp) :: sizes(size(columns))
        logical :: is_infinite
        integer :: place(size(columns)), i, k, axes, final_status

        sizes = columns%size
        axes = size(parameters, 1)
        place = columns%source
        associate (cells => rows%cells(:, rows%rows + 1:rows%rows + size(slots)))
            do k = 1, size(slots)
                associate (slot => slots(k), values => cells(axes + 3:axes + 2 + size(columns), k))
                    final_status = slot%status
                    values = slot%result%of(place) / sizes
                    if (is_good_end(final_status) .and. .not. all(abs(values) <= huge(values))) then
                        ! It is a failure where a quantity is infinite, or one undefined that every case has; an infinite bound
                        ! says itself what it is. What else the case lacks is noted.
                        do i = 1, size(columns)
                            if (is_finite(values(i))) cycle
                            is_infinite = abs(values(i)) > huge(values)
                            if (columns(i)%group == proof_group .and. is_infinite) cycle
                            if (columns(i)%missing > 0) call explain_missing(columns(i)%missing, slot%case, slot%note)
                            if (columns(i)%group == proof_group) cycle
                            if (is_infinite .or. columns(i)%is(always)) final_status = status_non_finite
                        end do
                    end if
                    cells(1, k) = real(first + k - 1, dp)
                    cells(2:axes + 1, k) = parameters(:, k)
                    cells(axes + 2, k) = final_status
                    cells(size(cells, 1), k) = slot%note%flags
                    if (slot%note%has(note_no_turns_known)) rows%doubtful = rows%doubtful + 1
                    rows%rows = rows%rows + 1
                    call rows%set_note(slot%note%text)
                    rows%counts(final_status) = rows%counts(final_status) + 1
                end associate
            end do
        end associate
    end subroutine add_rows

end module spintop_sweep_table
