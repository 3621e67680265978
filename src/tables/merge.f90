!> Joins the tables of the parts of a sweep.
module spintop_merge
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: input_file_t
    use spintop_interrupted_run, only: refuse_to_discard_idle
    use spintop_shard, only: read_shard_line, shard_t
    use spintop_table_file, only: table_file_t
    use spintop_table_head, only: check_format, compare_heads, first_line_of, read_head
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: merge_tables, order_parts

    !> Bytes that are copied at once.
    integer, parameter :: block_size = 1024 * 1024

    character, parameter :: nl = new_line('a')

contains

    !> Joins the tables of all parts of a sweep, given in any order, into the table that a single run would
    !> have written, byte for byte. Nothing is written unless the parts belong to the same sweep and each
    !> occurs once.
    subroutine merge_tables(path, parts, cases, error)
        character(*), intent(in) :: path !! path of the whole table
        type(string_t), intent(in) :: parts(:) !! paths of the tables of the parts
        integer(int64), intent(out) :: cases !! in the whole table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_file_t) :: table
        type(string_t), allocatable :: no_lines(:)
        type(shard_t) :: shard
        character(:), allocatable :: head
        integer, allocatable :: part_at(:)
        integer :: i

        call order_parts(path, parts, head, cases, part_at, error)
        if (.not. allocated(error)) call refuse_to_discard_idle(path, error)
        if (allocated(error)) return
        call table%create(path, head, error)
        do i = 1, size(part_at)
            if (allocated(error)) exit
            shard = shard_t(i, size(part_at))
            call copy_rows(parts(part_at(i))%text, len(head) + len('# ' // shard%line(cases) // nl), &
                           shard%last(cases) - shard%first(cases) + 1, table, error)
        end do
        allocate (no_lines(0))
        if (.not. allocated(error)) call table%finish(no_lines, error)
        if (allocated(error)) call table%discard()
    end subroutine merge_tables

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
        character(:), allocatable :: this_head, line, difference
        integer(int64) :: cases_here
        logical :: valid
        integer :: i

        cases = 0
        do i = 1, size(parts)
            associate (part => parts(i)%text)
                if (part == path) then
                    error = input_error('cannot merge into ' // path // ': it is also one of the parts')
                    return
                end if
                call read_head(part, this_head, error)
                if (.not. allocated(error)) call check_format(part, this_head, error)
                if (allocated(error)) return
                line = first_line_of(this_head)
                call read_shard_line(line, shard, cases_here, valid)
                if (.not. valid) then
                    error = input_error('cannot merge ' // part // ': it is not a part of a sweep (it does not begin &
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
                    error = input_error('cannot merge ' // part // ': it is a part of another sweep than ' // &
                                        parts(1)%text // difference)
                else if (part_at(shard%number) > 0) then
                    error = input_error('cannot merge ' // part // ': it is part ' // to_text(shard%number) // &
                                        ', as is ' // parts(part_at(shard%number))%text)
                end if
                if (allocated(error)) return
                part_at(shard%number) = i
            end associate
        end do
        if (any(part_at == 0)) then
            error = input_error('cannot merge into ' // path // ': missing of ' // to_text(size(part_at)) // &
                                ' parts: ' // missing())
        end if

    contains

        !> Numbers of the missing parts; the first few if there are many.
        function missing() result(text)
            character(:), allocatable :: text
            integer, parameter :: enough = 20
            integer :: number, found
            text = ''
            found = 0
            do number = 1, size(part_at)
                if (part_at(number) > 0) cycle
                found = found + 1
                if (found > enough) exit
                if (found > 1) text = text // ', '
                text = text // to_text(number)
            end do
            if (found > enough) text = text // ', ...'
        end function missing

    end subroutine order_parts

    !> Adds the rows of a part to the table. A part that is shorter or longer than expected is refused.
    subroutine copy_rows(part, head_length, rows, table, error)
        character(*), intent(in) :: part
        integer, intent(in) :: head_length
        integer(int64), intent(in) :: rows !! expected number of rows of the part
        type(table_file_t), intent(inout) :: table
        type(error_t), allocatable, intent(out) :: error
        type(input_file_t) :: file
        character(:), allocatable :: block
        character :: last
        integer(int64) :: found
        integer :: length, i

        found = 0
        last = nl
        allocate (character(max(block_size, head_length)) :: block)
        call file%open(part, error)
        if (.not. allocated(error)) call file%read(block(:head_length), length, error)
        do while (.not. allocated(error))
            call file%read(block, length, error)
            if (allocated(error) .or. length == 0) exit
            do i = 1, length
                if (block(i:i) == nl) found = found + 1
            end do
            last = block(length:length)
            call table%put(block(:length), error)
        end do
        call file%close()
        if (allocated(error)) return
        if (found /= rows .or. last /= nl) then
            error = input_error('cannot merge ' // part // ': it has ' // to_text(found) // ' complete rows, not ' // &
                                to_text(rows))
        end if
    end subroutine copy_rows

end module spintop_merge
