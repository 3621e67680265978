!> Merges the parts of a sweep: their tables, the statistics beside these, or statistics alone.
module spintop_statistics_merge
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_checksum, only: checksum_width
    use spintop_errors, only: error_t, input_error
    use spintop_merge, only: merge_tables, order_parts
    use spintop_netcdf_table, only: head_of_table
    use spintop_statistics_file, only: is_statistics, read_statistics
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_statistics_table, only: write_statistics
    use spintop_table_file, only: refuse_to_discard_idle, stem_of
    use spintop_table_head, only: read_head
    use spintop_text, only: string_t
    implicit none
    private
    public :: merge_parts, state_beside, statistics_beside

    character, parameter :: nl = new_line('a')

contains

    !> The path of the statistics of a part, beside its table.
    pure function state_beside(table) result(path)
        character(*), intent(in) :: table !! path of the table
        character(:), allocatable :: path
        path = stem_of(table) // '.statistics.state'
    end function state_beside

    !> The path of the statistics beside a whole table.
    pure function statistics_beside(table) result(path)
        character(*), intent(in) :: table !! path of the table
        character(:), allocatable :: path
        path = stem_of(table)
        if (table == path // '.nc') then
            path = path // '.statistics.nc'
        else
            path = path // '.statistics.csv'
        end if
    end function statistics_beside

    !> Merges the parts of a sweep, given in any order, into what a single run would have written, byte for byte:
    !> tables with the statistics beside them, if there are any, or the statistics of sweeps without rows.
    subroutine merge_parts(path, parts, cases, error)
        character(*), intent(in) :: path !! path of the whole
        type(string_t), intent(in) :: parts(:) !! paths of the parts
        integer(int64), intent(out) :: cases !! in the whole
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(string_t), allocatable :: states(:)
        character(:), allocatable :: head
        integer(int64) :: same
        integer :: i

        cases = 0
        if (is_statistics(parts(1)%text)) then
            call merge_statistics(path, parts, cases, error)
            return
        end if
        allocate (states(size(parts)))
        do i = 1, size(parts)
            states(i)%text = state_beside(parts(i)%text)
        end do
        call head_of_table(parts(1)%text, head, error)
        if (allocated(error)) return
        if (index(head, '&statistics' // nl) > 0) then
            call compare_with_table(states(1)%text, parts(1)%text, error)
            if (allocated(error)) return
        end if
        call merge_tables(path, parts, cases, error)
        if (allocated(error) .or. index(head, '&statistics' // nl) == 0) return
        call merge_statistics(statistics_beside(path), states, same, error)
    end subroutine merge_parts

    !> An error unless statistics are those of the table of a part: both have the same program, build and input.
    subroutine compare_with_table(state, table, error)
        character(*), intent(in) :: state, table
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: head, other
        call head_of_table(table, head, error)
        if (.not. allocated(error)) call read_head(state, other, error)
        if (allocated(error)) return
        if (before_columns(head) == before_columns(other)) return
        error = input_error('cannot merge ' // state // ': it is not of the same sweep as ' // table)
    end subroutine compare_with_table

    !> A header without its columns.
    pure function before_columns(head) result(text)
        character(*), intent(in) :: head
        character(:), allocatable :: text
        text = head(:index(head, '# columns:' // nl))
    end function before_columns

    !> Merges statistics of all parts.
    subroutine merge_statistics(path, parts, cases, error)
        character(*), intent(in) :: path
        type(string_t), intent(in) :: parts(:)
        integer(int64), intent(out) :: cases
        type(error_t), allocatable, intent(out) :: error
        type(statistics_plan_t) :: plan, other_plan
        type(accumulators_t) :: whole, other
        character(checksum_width) :: checksum
        character(:), allocatable :: head
        integer, allocatable :: part_at(:)
        integer :: i

        call order_parts(path, parts, head, cases, part_at, error)
        if (.not. allocated(error)) call refuse_to_discard_idle(path, error)
        do i = 1, size(parts)
            if (allocated(error)) return
            if (.not. is_statistics(parts(i)%text)) then
                error = input_error('cannot merge ' // parts(i)%text // ': it contains no statistics')
            else if (i == 1) then
                call read_statistics(parts(1)%text, plan, whole, checksum, error)
            else
                call read_statistics(parts(i)%text, other_plan, other, checksum, error)
                if (.not. allocated(error)) call whole%merge_with(other)
            end if
        end do
        if (.not. allocated(error)) call write_statistics(path, head, .false., plan, whole, error)
    end subroutine merge_statistics

end module spintop_statistics_merge
