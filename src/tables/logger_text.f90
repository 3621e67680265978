!> The text of a table as a logger, or another program, wrote it: where its names are, in which units, and what separates cells.
!> It is made a table of commas and points byte by byte, so that lines and columns of messages stay true.
!>
!>     call form%find_names(text)
!>     call form%rewrite(path, columns, text, error)
module spintop_logger_text
    use spintop_dates, only: is_date
    use spintop_errors, only: error_t, input_error
    use spintop_kinds, only: dp
    use spintop_literals, only: is_number_cell
    use spintop_text, only: append, end_of_line, lower_case, replace_all, string_t, to_text
    use spintop_units, only: convert_unit, own_spelling
    implicit none
    private
    public :: logger_text_t, logger_column_t, split_unit

    character, parameter :: tab = achar(9)
    character(*), parameter :: blanks = ' ' // tab // achar(13)
    !> What may separate cells; blanks where nothing else does.
    character, parameter :: separators(*) = [tab, ';', ',', '|', ' ']
    !> The names of a table are among so many lines at its beginning.
    integer, parameter :: most_lines = 1000

    !> A column: its name, that without the unit, and the unit; its first cell.
    type :: logger_column_t
        character(:), allocatable :: name, stem, unit, cell
        !> The column that it becomes, whether the input maps it, and the size of its unit in that of the column (0: not used).
        character(:), allocatable :: column
        logical :: is_mapped = .false.
        real(dp) :: size = 0
    end type logger_column_t

    !> What is known of a text.
    type :: logger_text_t
        type(logger_column_t), allocatable :: columns(:)
        !> What separates cells, and whether decimals have commas.
        character :: separator = ','
        logical :: has_commas = .false.
        !> Whether there are no rows; nothing else is known then.
        logical :: is_empty = .false.
        integer, private :: line_of_names = 0, line_of_units = 0
    contains
        procedure :: find_names
        procedure :: rewrite
        procedure :: describe
        procedure, private :: set_columns
    end type logger_text_t

contains

    !> Finds the line of names: the first one above a row with as many cells, or above units and such a row; else the first one.
    !> Names may stand in a comment.
    subroutine find_names(self, text)
        class(logger_text_t), intent(out) :: self
        character(*), intent(in) :: text !! the file
        type(string_t), allocatable :: lines(:), names(:)
        logical, allocatable :: is_comment(:)
        integer :: first, last, i, k, pass, next

        last = -1
        allocate (lines(0))
        do while (last + 2 <= len(text) .and. size(lines) < most_lines)
            first = last + 2
            last = end_of_line(text, first)
            call append(lines, text(first:last))
        end do
        is_comment = [(is_remark(lines(i)%text) .or. verify(lines(i)%text, blanks) == 0, i=1, size(lines))]
        do pass = 1, 2
            do i = 1, size(lines)
                if (is_comment(i) .neqv. pass == 2) cycle
                next = next_row(i)
                if (next == 0) exit
                if (pass == 2 .and. next > i + 1) cycle ! the last one has the names
                do k = 1, size(separators)
                    if (are_names(i, next, separators(k))) return
                end do
            end do
        end do
        i = next_row(0)
        self%is_empty = next_row(i) == 0
        if (self%is_empty) return
        k = 1
        do while (index(lines(i)%text, separators(k)) == 0 .and. separators(k) /= ' ')
            k = k + 1
        end do
        call cut_line(lines(i)%text, separators(k), .true., names)
        call self%set_columns(i, 0, separators(k), names, [string_t ::], [string_t ::])

    contains

        !> The line of the next row; 0 if there is none.
        integer function next_row(after)
            integer, intent(in) :: after
            next_row = after + findloc(is_comment(after + 1:), .false., dim=1)
            if (next_row == after) next_row = 0
        end function next_row

        !> Whether a line has the names of the row or of the units in another line; if so, they are set.
        logical function are_names(line, row, separator)
            integer, intent(in) :: line, row
            character, intent(in) :: separator
            type(string_t), allocatable :: cells(:), units(:)
            integer :: below
            are_names = .false.
            call cut_line(lines(line)%text, separator, .true., names)
            if (size(names) < 2 .or. looks_like_row(names, size(names))) return
            call cut_line(lines(row)%text, separator, .false., cells)
            below = 0
            allocate (units(0))
            if (are_units(cells)) below = next_row(row)
            if (below > 0) then
                call move_alloc(cells, units)
                call cut_line(lines(below)%text, separator, .false., cells)
            end if
            are_names = looks_like_row(cells, size(names))
            if (are_names) call self%set_columns(line, merge(row, 0, below > 0), separator, names, units, cells)
        end function are_names

    end subroutine find_names

    !> Sets the lines, the separator and the columns.
    subroutine set_columns(self, line, line_of_units, separator, names, units, cells)
        class(logger_text_t), intent(inout) :: self
        integer, intent(in) :: line, line_of_units
        character, intent(in) :: separator
        type(string_t), intent(in) :: names(:), units(:), cells(:) !! there may be no units below the names, and no cells
        integer :: i
        self%line_of_names = line
        self%line_of_units = line_of_units
        self%separator = separator
        allocate (self%columns(size(names)))
        do i = 1, size(names)
            associate (column => self%columns(i))
                column%name = names(i)%text
                column%column = column%name
                call split_unit(column%name, column%stem, column%unit)
                if (i <= size(units)) then
                    if (without_brackets(units(i)%text) /= '') column%unit = without_brackets(units(i)%text)
                end if
                column%cell = ''
                if (i <= size(cells)) column%cell = cells(i)%text
            end associate
        end do
    end subroutine set_columns

    !> Makes a table of commas and points of the text, line by line; what is neither names nor row becomes a comment.
    subroutine rewrite(self, path, columns, text, error)
        class(logger_text_t), intent(inout) :: self
        character(*), intent(in) :: path !! of the file, for messages
        type(logger_column_t), intent(in) :: columns(:) !! those that are used are numbers, or dates
        character(*), intent(inout) :: text !! the file, and the table
        type(error_t), allocatable, intent(out) :: error !! decimals of numbers have commas and points
        logical :: has(2), is_number(size(columns))
        integer :: first, last, start, line, n, i

        is_number = [(columns(i)%size > 0 .and. .not. is_date(columns(i)%cell), i=1, size(columns))]
        has = .false.
        last = -1
        line = 0
        do
            first = last + 2
            if (first > len(text)) exit
            last = end_of_line(text, first)
            line = line + 1
            start = first + verify(text(first:last), blanks) - 1
            if (start < first) cycle
            if (line == self%line_of_names) then
                text(first:first + after_mark(text(first:last)) - 2) = ''
                call separate(text(first:last), self%separator, .true., [logical ::], has, n)
            else if (line < self%line_of_names .or. line == self%line_of_units .or. is_remark(text(first:last))) then
                text(start:start) = '#'
                cycle
            else
                call separate(text(first:last), self%separator, .false., is_number, has, n)
            end if
            if (n == size(is_number) + 1) then
                start = first - 1 + verify(text(first:last), blanks, back=.true.)
                if (text(start:start) == ',') text(start:start) = ' '
            end if
            if (.not. all(has)) cycle
            error = input_error(path // ':' // to_text(line) // ': numbers have both decimal commas and points: write points')
            return
        end do
        self%has_commas = has(1)
    end subroutine rewrite

    !> What separates cells and decimals.
    function describe(self) result(text)
        class(logger_text_t), intent(in) :: self
        character(:), allocatable :: text
        text = "'" // self%separator // "'"
        if (self%separator == tab) text = 'tabs'
        if (self%separator == ' ') text = 'blanks'
        text = text // ' between cells'
        if (self%has_commas) text = text // ', decimal commas'
    end function describe

    !> Whether cells are a row of numbers, dates and empty cells, of at most one word for two of them; a separator may follow it.
    logical function looks_like_row(cells, n)
        type(string_t), intent(in) :: cells(:)
        integer, intent(in) :: n !! number of columns
        character(:), allocatable :: cell
        integer :: i, numbers, words
        looks_like_row = .false.
        if (size(cells) == n + 1) looks_like_row = cells(n + 1)%text == ''
        looks_like_row = looks_like_row .or. size(cells) == n
        if (.not. looks_like_row) return
        numbers = 0
        words = 0
        do i = 1, n
            cell = replace_all(cells(i)%text, ',', '.')
            if (is_number_cell(cell) .or. is_date(cell)) then
                numbers = numbers + 1
            else if (cell /= '') then
                words = words + 1
            end if
        end do
        looks_like_row = numbers > words
    end function looks_like_row

    !> Whether cells are units, as in a line below the names.
    logical function are_units(cells)
        type(string_t), intent(in) :: cells(:)
        character(:), allocatable :: problem, unit
        real(dp) :: factor
        integer :: i
        are_units = .false.
        do i = 1, size(cells)
            unit = own_spelling(without_brackets(cells(i)%text), '')
            if (any(unit == [character(1) :: '', '-', '1'])) cycle
            call convert_unit(unit, unit, factor, problem)
            are_units = problem == '' .or. index(lower_case(unit), 'hh:mm') == 1
            if (.not. are_units) return
        end do
    end function are_units

    !> Whether a line is a comment.
    pure logical function is_remark(line)
        character(*), intent(in) :: line
        integer :: start
        start = max(1, verify(line, blanks))
        is_remark = scan(line(start:min(start, len(line))), '#%!') > 0 .or. index(line(start:), '//') == 1
    end function is_remark

    !> The cells of a line, without blanks and quotes.
    subroutine cut_line(line, separator, of_names, cells)
        character(*), intent(in) :: line
        character, intent(in) :: separator
        logical, intent(in) :: of_names !! whether they are names, after which a separator may follow
        type(string_t), allocatable, intent(out) :: cells(:)
        character(:), allocatable :: plain, parted
        logical :: has(2)
        integer :: i, n, at, after

        plain = line
        if (of_names) plain(:after_mark(line) - 1) = ''
        parted = plain
        has = .false.
        call separate(parted, separator, of_names, [logical ::], has, n)
        if (of_names .and. n > 1) then
            if (verify(parted(index(parted, ',', back=.true.) + 1:), blanks) == 0) n = n - 1
        end if
        allocate (cells(n))
        at = 1
        do i = 1, n
            after = index(parted(at:), ',')
            after = merge(at + after - 1, len(parted) + 1, after > 0)
            cells(i)%text = stripped(plain(at:after - 1))
            at = after + 1
        end do
    end subroutine cut_line

    !> The first byte behind the mark of a comment.
    pure integer function after_mark(line) result(at)
        character(*), intent(in) :: line
        at = 1
        if (is_remark(line)) at = verify(line // 'x', blanks // '#%!/')
    end function after_mark

    !> A text without blanks around it, and without quotes around these.
    pure function stripped(text) result(cell)
        character(*), intent(in) :: text
        character(:), allocatable :: cell
        cell = text(max(1, verify(text, blanks)):verify(text, blanks, back=.true.))
        if (len(cell) < 2) return
        if (cell(1:1) == '"' .and. cell(len(cell):) == '"') cell = trim(adjustl(cell(2:len(cell) - 1)))
    end function stripped

    !> Makes commas of the separators of a line, and points of its other commas.
    pure subroutine separate(line, separator, of_names, is_number, has, cells)
        character(*), intent(inout) :: line
        character, intent(in) :: separator
        logical, intent(in) :: of_names !! whether a cell may have blanks before and inside of brackets
        logical, intent(in) :: is_number(:) !! which cells are numbers
        logical, intent(inout) :: has(:) !! whether there are commas, and points, in these
        integer, intent(out) :: cells !! number of cells
        character(:), allocatable :: around
        logical :: is_quoted, is_end
        character :: c
        integer :: i, next, brackets

        around = blanks
        if (separator == tab) around = ' ' // achar(13)
        cells = 1
        is_quoted = .false.
        brackets = 0
        do i = max(1, verify(line, around)), verify(line, around, back=.true.)
            c = line(i:i)
            if (c == '"') is_quoted = .not. is_quoted
            if (scan(c, '([') > 0) brackets = brackets + 1
            if (scan(c, ')]') > 0) brackets = brackets - 1
            is_end = c == separator
            if (separator == ' ') then
                is_end = scan(c, blanks) > 0 .and. scan(line(max(1, i - 1):max(1, i - 1)), blanks // ',') == 0
                if (is_end .and. of_names) then
                    next = i - 1 + verify(line(i:), blanks)
                    is_end = brackets <= 0 .and. scan(line(next:next), '([') == 0
                end if
            end if
            if (is_end .and. .not. is_quoted) then
                line(i:i) = ','
                cells = cells + 1
                cycle
            end if
            if (c == ',') line(i:i) = '.'
            if (cells > size(is_number)) cycle
            if (is_number(cells)) has = has .or. [c == ',', c == '.']
        end do
    end subroutine separate

    !> Splits a name with its unit: `gx (dps)`, `gx [dps]`, `gx / dps`, `gx, dps`.
    pure subroutine split_unit(name, stem, unit)
        character(*), intent(in) :: name !! of a column of a file
        character(:), allocatable, intent(out) :: stem, unit !! the unit is '' if there is none
        integer :: from

        stem = name
        unit = ''
        from = max(index(name, ' / '), index(name, ', '))
        if (scan(name, ')]', back=.true.) == len(name)) from = scan(name, '([', back=.true.)
        if (from < 2) return
        unit = without_brackets(name(from:))
        stem = name(:verify(name(:from - 1), ' /,', back=.true.))
    end subroutine split_unit

    !> A unit without brackets, or what else separates it from a name.
    pure function without_brackets(text) result(unit)
        character(*), intent(in) :: text
        character(:), allocatable :: unit
        unit = text(max(1, verify(text, ' /,([')):verify(text, ' )]', back=.true.))
    end function without_brackets

end module spintop_logger_text
