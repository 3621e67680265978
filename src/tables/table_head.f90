!> The header of a table: `#` lines with metadata, and the names of the columns. Two tables with equal headers
!> come from the same program, build and input.
module spintop_table_head
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: input_file_t
    use spintop_row_block, only: text_buffer_t
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: table_head, comment_lines, read_head, first_line_of, compare_heads, value_of, is_netcdf
    public :: format_key, table_format, check_format
    public :: shard_t, read_shard, read_shard_line, most_shards

    !> Format of the tables that this program writes, and its key in the header. The number increases when a
    !> column is renamed or its meaning changes, or the header changes. Tables of version 0.1.0 have no number.
    character(*), parameter :: format_key = 'format', table_format = '1'

    character, parameter :: nl = new_line('a')
    !> Maximum number of bytes of a line that a message quotes.
    integer, parameter :: longest_line = 200

    !> Maximum number of parts of a sweep.
    integer, parameter :: most_shards = 1000000

    !> Part `number` of `count` of a study, which the first line of its table names; by default the whole sweep.
    type :: shard_t
        integer :: number = 1, count = 1
    contains
        procedure :: is_part
        procedure :: first
        procedure :: last
        procedure :: suffix
        procedure :: line
        procedure :: beginning
    end type shard_t

contains

    !> The header: comment lines and the names of the columns.
    function table_head(comments, columns) result(head)
        type(string_t), intent(in) :: comments(:) !! without the `#`
        character(*), intent(in) :: columns(:) !! names of the columns
        character(:), allocatable :: head
        type(text_buffer_t) :: names
        integer :: i
        do i = 1, size(columns)
            call names%add_name(columns(i))
        end do
        call names%end_row()
        head = comment_lines(comments) // names%contents()
    end function table_head

    !> Comment lines as in tables.
    function comment_lines(lines) result(text)
        type(string_t), intent(in) :: lines(:) !! lines of text
        character(:), allocatable :: text
        integer :: i
        text = ''
        do i = 1, size(lines)
            text = text // trim('# ' // lines(i)%text) // nl
        end do
    end function comment_lines

    !> The header of a table in a file.
    subroutine read_head(path, head, error)
        character(*), intent(in) :: path !! path of the table
        character(:), allocatable, intent(out) :: head !! the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer, parameter :: largest_head = 16 * 1024 * 1024, piece = 64 * 1024
        type(input_file_t) :: file
        character(:), allocatable :: block
        integer :: length, first, break

        head = ''
        first = 1
        allocate (character(piece) :: block)
        call file%open(path, error, is_text=.true.)
        if (allocated(error)) return
        do
            call file%read(block, length, error)
            if (allocated(error) .or. length == 0 .or. len(head) > largest_head) exit
            head = head // block(:length)
            do
                break = index(head(first:), nl)
                if (break == 0) exit
                if (head(first:first) /= '#') then
                    head = head(:first + break - 1)
                    call file%close()
                    return
                end if
                first = first + break
            end do
        end do
        call file%close()
        if (.not. allocated(error)) error = input_error(path // ' is not a table: it has no line with column names')
    end subroutine read_head

    !> Whether a file begins as one in a format of NetCDF; false as well if it cannot be read.
    logical function is_netcdf(path)
        character(*), intent(in) :: path !! path of the file
        type(input_file_t) :: file
        type(error_t), allocatable :: error
        character(4) :: magic
        integer :: length
        length = 0
        call file%open(path, error)
        if (.not. allocated(error)) call file%read(magic, length, error)
        call file%close()
        is_netcdf = .false.
        if (length == len(magic)) is_netcdf = magic(:3) == 'CDF' .or. magic(2:) == 'HDF'
    end function is_netcdf

    !> An error if a table of this program has another format than this version writes. Tables from elsewhere
    !> have no format.
    subroutine check_format(path, text, error)
        character(*), intent(in) :: path !! path of the table, for the message
        character(*), intent(in) :: text !! the table, or its header
        type(error_t), allocatable, intent(out) :: error !! not allocated if the format is the right one
        character(:), allocatable :: head, found
        integer :: length, break

        length = 0
        do while (length < len(text))
            if (text(length + 1:length + 1) /= '#') exit
            break = index(text(length + 1:), nl)
            if (break == 0) exit
            length = length + break
        end do
        head = text(:length)
        if (value_of('program', head) == '') return
        found = value_of(format_key, head)
        if (found == table_format) return
        if (found == '') found = '0 (' // value_of('program', head) // ')'
        error = input_error(path // ' is a table of format ' // found // '; this program reads format ' // &
                            table_format // ': write the table again with this version')
    end subroutine check_format

    !> The value of a key in a header; '' if it has none.
    pure function value_of(key, head) result(value)
        character(*), intent(in) :: key, head !! the key, and the header
        character(:), allocatable :: value
        integer :: first
        value = ''
        first = index(nl // head, nl // '# ' // key // ': ')
        if (first == 0) return
        value = head(first + len('# ' // key // ': '):)
        value = value(:index(value // nl, nl) - 1)
    end function value_of

    !> The first line of a header, without its `# `.
    pure function first_line_of(head) result(line)
        character(*), intent(in) :: head !! a header
        character(:), allocatable :: line
        line = head(3:index(head // nl, nl) - 1)
    end function first_line_of

    !> The first line in which two headers differ, except for their dates and how a motion ended, ready to print;
    !> '' if they are equal.
    pure function compare_heads(first_head, first_name, second_head, second_name) result(difference)
        character(*), intent(in) :: first_head, second_head !! headers
        character(*), intent(in) :: first_name, second_name !! what they are called in print
        character(:), allocatable :: difference, first, second
        integer :: i, line

        difference = ''
        first = without(without(first_head, 'date'), 'status')
        second = without(without(second_head, 'date'), 'status')
        if (len(first) == len(second) .and. first == second) return
        line = 1
        do i = 1, min(len(first), len(second))
            if (first(i:i) /= second(i:i)) exit
            if (first(i:i) == nl) line = i + 1
        end do
        difference = nl // '    ' // first_name // ': ' // line_at(first, line) // &
                     nl // '    ' // second_name // ': ' // line_at(second, line)
    end function compare_heads

    !> A header without the line of a key.
    pure function without(head, key) result(text)
        character(*), intent(in) :: head, key
        character(:), allocatable :: text
        integer :: at
        text = head
        at = index(head, nl // '# ' // key // ': ')
        if (at > 0) text = head(:at) // head(at + index(head(at + 1:), nl) + 1:)
    end function without

    !> The line that begins at a position, without the mark of a comment.
    pure function line_at(text, first) result(line)
        character(*), intent(in) :: text
        integer, intent(in) :: first
        character(:), allocatable :: line
        if (first > len(text)) then
            line = '(ends here)'
        else
            line = text(first:first + index(text(first:) // nl, nl) - 2)
            if (index(line, '#') == 1) line = trim(adjustl(line(2:)))
            if (len(line) > longest_line) line = line(:longest_line) // '...'
        end if
    end function line_at

    !> Whether it is a part, and not the whole.
    pure logical function is_part(self)
        class(shard_t), intent(in) :: self
        is_part = self%count > 1
    end function is_part

    !> First case of the part, for a number of cases. The parts are consecutive, and their sizes differ by at
    !> most one case.
    pure integer(int64) function first(self, cases)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! number of cases of the whole sweep
        first = last_before(self%number, self%count, cases) + 1
    end function first

    !> Last case of the part; less than the first if there are more parts than cases.
    pure integer(int64) function last(self, cases)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! number of cases of the whole sweep
        last = last_before(self%number + 1, self%count, cases)
    end function last

    !> Number of cases before part `number`.
    pure integer(int64) function last_before(number, count, cases)
        integer, intent(in) :: number, count
        integer(int64), intent(in) :: cases
        last_before = (number - 1) * (cases / count) + min(number - 1_int64, mod(cases, int(count, int64)))
    end function last_before

    !> Suffix of the name of its table: `.2-of-3`.
    pure function suffix(self)
        class(shard_t), intent(in) :: self
        character(:), allocatable :: suffix
        suffix = ''
        if (self%is_part()) suffix = '.' // to_text(self%number) // '-of-' // to_text(self%count)
    end function suffix

    !> The first line of its table.
    pure function line(self, cases)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! of the whole
        character(:), allocatable :: line
        line = 'no cases'
        if (self%last(cases) >= self%first(cases)) then
            line = 'cases ' // to_text(self%first(cases)) // ' to ' // to_text(self%last(cases))
        end if
        line = 'part ' // to_text(self%number) // ' of ' // to_text(self%count) // ': ' // line // ' of ' // to_text(cases)
    end function line

    !> What its table begins with: the first line, or '' if it is the whole.
    pure function beginning(self, cases) result(text)
        class(shard_t), intent(in) :: self
        integer(int64), intent(in) :: cases !! of the whole
        character(:), allocatable :: text
        text = ''
        if (self%is_part()) text = self%line(cases)
    end function beginning

    !> Reads `I/N`.
    subroutine read_shard(text, shard, valid)
        character(*), intent(in) :: text !! `I/N`
        type(shard_t), intent(out) :: shard !! the part, if the text is valid
        logical, intent(out) :: valid !! whether it is valid
        integer :: slash, status

        slash = index(text, '/')
        valid = slash > 1 .and. slash < len(text) .and. verify(text, '0123456789/') == 0 &
                .and. index(text, '/', back=.true.) == slash
        if (.not. valid) return
        read (text(:slash - 1), *, iostat=status) shard%number
        if (status == 0) read (text(slash + 1:), *, iostat=status) shard%count
        valid = status == 0 .and. shard%number >= 1 .and. shard%number <= shard%count &
                .and. shard%count <= most_shards
    end subroutine read_shard

    !> Reads the first line of the table of a part.
    subroutine read_shard_line(text, shard, cases, valid)
        character(*), intent(in) :: text !! the first line, without its `# `
        type(shard_t), intent(out) :: shard !! the part, if the line is valid
        integer(int64), intent(out) :: cases !! of the whole
        logical, intent(out) :: valid !! whether it is valid
        character(32) :: words(4)
        integer :: status, status_of_cases

        cases = 0
        words = ''
        shard = shard_t()
        read (text, *, iostat=status) words ! part I of N:
        call read_shard(trim(words(2)) // '/' // words(4)(:index(words(4) // ':', ':') - 1), shard, valid)
        read (text(index(text, ' ', back=.true.) + 1:), *, iostat=status_of_cases) cases
        ! Only a line that this program would write is accepted.
        if (valid) valid = status == 0 .and. status_of_cases == 0 .and. shard%line(cases) == text
    end subroutine read_shard_line

end module spintop_table_head
