!> Joins the parts of a study: their tables, the statistics beside these, or statistics alone.
module spintop_merge
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_accumulators, only: accumulators_t
    use spintop_checksum, only: checksum_width
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: input_file_t
    use spintop_netcdf_table, only: head_of_table, netcdf_table_t
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_statistics_output, only: path_beside, write_statistics_tables
    use spintop_statistics_plan, only: statistics_plan_t
    use spintop_statistics_table, only: is_statistics, read_statistics
    use spintop_table_end, only: check_table, table_check_t
    use spintop_journaled_table, only: refuse_to_discard, stem_of, table_file_t
    use spintop_table_head, only: check_format, compare_heads, first_line_of, is_netcdf, read_head, read_shard_line, &
        shard_t, value_of
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: merge_parts, merge_tables

    !> Bytes of text that are copied at once.
    integer, parameter :: block_size = 1024 * 1024

    character, parameter :: nl = new_line('a')

contains

    !> Merges the parts of a sweep, given in any order, into what a single run would have written, byte for byte:
    !> tables with the statistics beside them, if there are any, or the statistics of sweeps without rows.
    subroutine merge_parts(path, parts, cases, error)
        character(*), intent(in) :: path !! path of the whole
        type(string_t), intent(in) :: parts(:) !! paths of the parts
        integer(int64), intent(out) :: cases !! in the whole
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(string_t), allocatable :: states(:)
        character(:), allocatable :: head, other
        character(*), parameter :: columns_line = '# columns:' // nl ! behind it headers differ
        integer(int64) :: same
        integer :: i
        logical :: has_statistics

        cases = 0
        if (is_statistics(parts(1)%text)) then
            call merge_statistics(path, parts, cases, error)
            return
        end if
        allocate (states(size(parts)))
        do i = 1, size(parts)
            states(i)%text = stem_of(parts(i)%text) // '.statistics.state'
        end do
        call head_of_table(parts(1)%text, head, error)
        if (allocated(error)) return
        has_statistics = index(head, '&statistics' // nl) > 0
        if (has_statistics) then
            ! They are those of the tables: of the same program, build and input.
            call read_head(states(1)%text, other, error)
            if (allocated(error)) return
            if (head(:index(head, columns_line)) /= other(:index(other, columns_line))) then
                error = input_error('cannot merge ' // states(1)%text // ': it is not of the same sweep as ' // parts(1)%text)
                return
            end if
        end if
        call merge_tables(path, parts, cases, error)
        if (allocated(error) .or. .not. has_statistics) return
        call merge_statistics(path_beside(path, 'statistics'), states, same, error)
    end subroutine merge_parts

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
        if (.not. allocated(error)) call refuse_to_discard(path, error, is_ours=.false.)
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
        if (.not. allocated(error)) call write_statistics_tables(path, head, plan, whole, error)
    end subroutine merge_statistics

    !> Joins the tables of all parts of a study, given in any order, into the table that a single run would
    !> have written, byte for byte. Nothing is written unless the parts belong to the same study and each
    !> occurs once.
    subroutine merge_tables(path, parts, cases, error)
        character(*), intent(in) :: path !! path of the whole table
        type(string_t), intent(in) :: parts(:) !! paths of the tables of the parts
        integer(int64), intent(out) :: cases !! in the whole table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_file_t) :: table
        type(shard_t) :: shard
        character(:), allocatable :: head, remarks
        integer, allocatable :: part_at(:)
        integer(int64) :: rows
        integer :: head_length, i

        call order_parts(path, parts, head, cases, part_at, error)
        if (.not. allocated(error)) call refuse_to_discard(path, error, is_ours=.false.)
        if (allocated(error)) return
        if (is_netcdf(parts(1)%text)) then
            call merge_netcdf(path, parts, part_at, head, error)
            return
        end if
        remarks = ''
        call table%create(path, head, error)
        do i = 1, size(part_at)
            if (allocated(error)) exit
            shard = shard_t(i, size(part_at))
            head_length = len(head) + len('# ' // shard%line(cases) // nl)
            associate (part => parts(part_at(i))%text)
                rows = shard%last(cases) - shard%first(cases) + 1
                if (value_of('date', head) /= '') rows = -1 ! a case has any number of them
                call copy_part(part, head_length, rows, table, remarks, error)
            end associate
        end do
        if (.not. allocated(error)) call table%append(remarks, error)
        if (.not. allocated(error)) call table%finish([string_t ::], error)
        if (allocated(error)) call table%discard()
    end subroutine merge_tables

    !> Joins NetCDF tables: their rows are appended to a table of the whole.
    subroutine merge_netcdf(path, parts, part_at, head, error)
        character(*), intent(in) :: path, head
        type(string_t), intent(in) :: parts(:)
        integer, intent(in) :: part_at(:)
        type(error_t), allocatable, intent(out) :: error
        type(netcdf_table_t) :: part
        type(row_table_t) :: table
        type(row_block_t) :: block
        integer :: i

        do i = 1, size(part_at)
            call part%open(parts(part_at(i))%text, error)
            if (allocated(error)) exit
            if (i == 1) then
                table%netcdf = part%layout
                table%columns = part%columns
                table%has_journal = .false.
                call table%start(path, head, .false., .false., error)
            end if
            do while (part%next_rows(block%cells, error))
                block%rows = size(block%cells, 2)
                call table%format(block)
                call table%append(block, error)
                call block%clear()
            end do
            if (.not. allocated(error)) then
                if (part%problem() /= '') error = input_error('cannot merge ' // part%problem())
            end if
            call part%close()
            if (allocated(error)) exit
        end do
        if (.not. allocated(error)) call table%finish(error)
        if (allocated(error)) call table%discard()
    end subroutine merge_netcdf

    !> Identifies the parts. `head` is the header of the whole table: the header of the parts without the
    !> first line, which names the part.
    subroutine order_parts(path, parts, head, cases, part_at, error)
        character(*), intent(in) :: path !! path of the whole
        type(string_t), intent(in) :: parts(:) !! paths of the parts
        character(:), allocatable, intent(out) :: head !! header of the whole
        integer(int64), intent(out) :: cases !! in the whole
        integer, allocatable, intent(out) :: part_at(:) !! where each part stands among the paths
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(shard_t) :: shard
        character(:), allocatable :: this_head, line, difference, missing
        integer(int64) :: cases_here
        logical :: valid
        integer :: i
        integer, parameter :: enough = 20 ! parts that are named

        cases = 0
        do i = 1, size(parts)
            associate (part => parts(i)%text)
                if (part == path) then
                    error = input_error('cannot merge into ' // path // ': it is also one of the parts')
                    return
                end if
                call head_of_table(part, this_head, error)
                if (.not. allocated(error)) call check_format(part, this_head, error)
                if (allocated(error)) return
                line = first_line_of(this_head)
                call read_shard_line(line, shard, cases_here, valid)
                if (.not. valid) then
                    error = input_error('cannot merge ' // part // ': it is not a part of a study (it does not begin &
                                        &with "# part I of N: ...")')
                    return
                end if
                this_head = this_head(len('# ' // line // nl) + 1:)
                if (i == 1) then
                    head = this_head
                    cases = cases_here
                    allocate (part_at(shard%count))
                    part_at = 0
                end if
                difference = compare_heads(head, parts(1)%text, this_head, part)
                if (shard%count /= size(part_at) .or. cases_here /= cases .or. difference /= '') then
                    error = input_error('cannot merge ' // part // ': it is a part of another study than ' // &
                                        parts(1)%text // difference)
                else if (part_at(shard%number) > 0) then
                    error = input_error('cannot merge ' // part // ': it is part ' // to_text(shard%number) // &
                                        ', as is ' // parts(part_at(shard%number))%text)
                end if
                if (allocated(error)) return
                part_at(shard%number) = i
            end associate
        end do
        if (all(part_at > 0)) return
        missing = ''
        do i = 1, size(part_at)
            if (part_at(i) > 0) cycle
            if (count(part_at(:i) == 0) <= enough) missing = missing // ', ' // to_text(i)
        end do
        if (count(part_at == 0) > enough) missing = missing // ', ...'
        error = input_error('cannot merge into ' // path // ': missing of ' // to_text(size(part_at)) // ' parts: ' // missing(3:))
    end subroutine order_parts

    !> Adds the rows of a part to the table, and gathers the comment lines after them. A part that was cut or changed is
    !> refused, and so is one with another number of rows than expected.
    subroutine copy_part(part, head_length, rows, table, remarks, error)
        character(*), intent(in) :: part
        integer, intent(in) :: head_length
        integer(int64), intent(in) :: rows !! expected number of rows of the part; -1: any
        type(table_file_t), intent(inout) :: table
        character(:), allocatable, intent(inout) :: remarks
        type(error_t), allocatable, intent(out) :: error
        type(input_file_t) :: file
        type(table_check_t) :: check
        character(:), allocatable :: block, passed, problem
        integer :: length, of_head, comment

        of_head = head_length
        allocate (character(block_size) :: block)
        call file%open(part, error, is_text=.true.)
        do while (.not. allocated(error))
            call file%read(block, length, error)
            if (allocated(error) .or. length == 0) exit
            call check%pass(block(:length), passed)
            length = min(of_head, len(passed))
            of_head = of_head - length
            ! Rows, and comments, which come last.
            comment = index(nl // passed(length + 1:), nl // '#')
            if (comment == 0) comment = len(passed) - length + 1
            call table%append(passed(length + 1:length + comment - 1), error)
            remarks = remarks // passed(length + comment:)
        end do
        call file%close()
        if (allocated(error)) return
        problem = ''
        if (.not. check%is_right()) call check_table(part, problem)
        if (rows >= 0 .and. check%rows() /= rows) then
            if (problem /= '') problem = '; ' // problem
            problem = part // ': it has ' // to_text(check%rows()) // ' complete rows, not ' // to_text(rows) // problem
        end if
        if (problem /= '') error = input_error('cannot merge ' // problem)
    end subroutine copy_part

end module spintop_merge
