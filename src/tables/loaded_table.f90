!> Tables in memory. A CSV table that was read: names of the columns, and the cells as text or as numbers.
!>
!>     # drawn elsewhere
!>     initial.spin_ratio, "top.inertia(2)"
!>     0.5,                0.875
!>
!> Blank lines and lines that begin with `#` are ignored, and so are blanks around a cell; double quotes may stand around a
!> whole cell.
!>
!>     call read_table(path, table, error)
!>     if (.not. allocated(error)) call table%read_column('theta', theta, error)
!>
!> And a table that a run gives to a caller of the library, column by column.
module spintop_loaded_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_diagnostics, only: diagnostics_t, place_t
    use spintop_errors, only: error_t, input_error, internal_error
    use spintop_files, only: path_from, read_file
    use spintop_kinds, only: dp, no_number
    use spintop_literals, only: is_number_cell, read_real
    use spintop_row_block, only: row_block_t
    use spintop_suggestions, only: suggest_word
    use spintop_table_column, only: column_of_notes, column_of_words, column_t, table_column_t
    use spintop_table_end, only: check_table_text
    use spintop_table_head, only: check_format
    use spintop_text, only: abbreviate, end_of_line, escaped, lower_case, string_t, to_text
    implicit none
    private
    public :: read_table, table_t, largest_table
    public :: data_table_t, data_column_t, load_table

    !> Maximum size of a table, bytes.
    integer, parameter :: largest_table = 2**30 - 1
    character(*), parameter :: blanks = ' ' // achar(9) // achar(13)
    !> Cells of other programs where there is no number, in small letters.
    character(*), parameter :: not_there(*) = [character(4) :: '', '-', 'na', 'n/a', 'null', 'none']
    character(*), parameter :: whole = 'quotes must be around the whole cell'

    !> The place of a cell: its line, its position in that, and its first and last byte, without blanks and quotes.
    type :: cell_t
        integer :: line = 0, position = 1, from = 1, to = 0
    end type cell_t

    !> A table in memory.
    type :: table_t
        !> Names of the columns; not allocated if it has none.
        type(string_t), allocatable :: names(:)
        !> Whether it has the last line of a complete table.
        logical :: has_end = .false.
        !> How it differs from what was written, where that is no error; '' if it does not.
        character(:), allocatable :: damage
        !> Its text, and that without the rows: header, names of the columns, and lines at the end such as the status.
        character(:), allocatable :: text, frame
        !> Number of rows, and whether no error was found.
        integer :: rows = 0
        logical :: is_valid = .true.
        !> The file, for messages, and its number among the sources of the diagnostics, if it has errors.
        character(:), allocatable, private :: path
        integer, private :: source = 0
        !> The cells: columns, rows; row 0 has the names. And the end of the line of names.
        type(cell_t), allocatable, private :: cells(:, :)
        integer, private :: end_of_names = 0
    contains
        procedure :: open => open_table
        procedure :: read_rows
        procedure :: column
        procedure :: words
        procedure :: read_column
        procedure :: read_number
        procedure :: refuse
        procedure :: place_of_row
        procedure, private :: cut
        procedure, private :: complain
    end type table_t

    !> Notes with which a new one is compared: most rows have none, or that of a row before.
    integer, parameter :: latest_notes = 16

    !> A column of it: numbers, or words.
    type, extends(column_t) :: data_column_t
        !> The numbers; of a column of words the number of the word in `words`, from 0.
        real(dp), allocatable :: values(:)
        !> The words that occur, or may occur, without order; not allocated for a column of numbers.
        type(string_t), allocatable :: words(:)
        !> Whether its words are the notes of cases; and how many words there are, behind which is room for more.
        logical, private :: has_notes = .false.
        integer, private :: used = 0
    end type data_column_t

    !> A table, column by column: what a run gives to a caller of the library.
    type :: data_table_t
        !> What it is: `rows`, `events`, `statistics`, `histogram`, `indices`, `residuals`.
        character(16) :: name = ''
        integer(int64) :: rows = 0
        type(data_column_t), allocatable :: column(:)
        !> The text of its file without the rows: header, names of the columns, and lines at the end such as the status.
        character(:), allocatable :: frame
    contains
        procedure :: begin
        procedure :: add
    end type data_table_t

contains

    !> Reads a CSV table, such as the program writes. What is not valid is an error with its line and column:
    !> another format, an empty file, a name that is missing or repeated, a row with another number of cells.
    subroutine read_table(path, table, error, takes_damaged)
        character(*), intent(in) :: path !! path of the file
        type(table_t), intent(out) :: table !! the table; without columns if there is an error
        type(error_t), allocatable, intent(out) :: error !! it cannot be read, or is not a table
        logical, intent(in), optional :: takes_damaged !! whether a table that differs from what was written is no error
        character(*), parameter :: hint = 'the line of names has one name per column'
        type(diagnostics_t) :: diagnostics
        integer :: i, k

        call table%open('', path, diagnostics, error, takes_damaged)
        if (.not. (allocated(error) .or. diagnostics%has_errors())) then
            associate (names => table%names)
                do i = 1, size(names)
                    if (names(i)%text == '') then
                        call table%refuse(diagnostics, i, 0, 'column ' // to_text(i) // ' has no name', hint)
                    else if (any([(names(k)%text == names(i)%text, k=1, i - 1)])) then
                        call table%refuse(diagnostics, i, 0, 'there are two columns ' // abbreviate(names(i)%text), hint)
                    end if
                end do
            end associate
            if (.not. diagnostics%has_errors()) call table%read_rows(diagnostics)
        end if
        if (.not. allocated(error)) call diagnostics%raise(error)
        if (allocated(error)) table = table_t()
    end subroutine read_table

    !> Opens a table whose path is relative to the folder of an input, and reads the names of its columns. A file
    !> that cannot be read is an error; errors of its text are added to the diagnostics.
    subroutine open_table(self, input, path, diagnostics, error, takes_damaged, text)
        class(table_t), intent(out) :: self
        character(*), intent(in) :: input !! path of the input
        character(*), intent(in) :: path !! path of the table, relative to the folder of `input`
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: takes_damaged !! whether a table that differs from what was written is no error
        character(*), intent(in), optional :: text !! what was read of the file
        type(cell_t), allocatable :: cells(:)
        character(:), allocatable :: problem
        integer :: line, first, last, n, bad, i

        self%damage = ''
        self%path = path_from(input, path)
        if (present(text)) then
            self%text = text
        else
            call read_file(self%path, largest_table, self%text, error, may_wait=.true., is_text=.true.)
        end if
        if (.not. allocated(error)) call check_format(self%path, self%text, error)
        if (allocated(error)) return
        if (index(self%text, achar(0)) > 0) then
            call self%complain(diagnostics, cell_t(), 'not a text file: it has NUL bytes', 'expected a CSV table')
            return
        end if
        call check_table_text(self%text, self%has_end, problem)
        self%damage = problem
        if (present(takes_damaged)) then
            if (takes_damaged) problem = ''
        end if
        if (problem /= '') then
            call self%complain(diagnostics, cell_t(), 'the table ' // problem, 'if this is intended, remove its last line')
            return
        end if
        line = 0
        last = -1
        if (.not. next_line(self%text, line, first, last)) then
            call self%complain(diagnostics, cell_t(), 'the table is empty', 'expected a line of names')
            return
        end if
        allocate (cells(1 + count([(self%text(i:i) == ',', i=first, last)])))
        call self%cut(line, first, last, cells, n, bad)
        allocate (self%names(n))
        do i = 1, n
            self%names(i)%text = self%text(cells(i)%from:cells(i)%to)
        end do
        allocate (self%cells(n, 0:0))
        self%cells(:, 0) = cells(:n)
        self%end_of_names = last
        if (bad > 0) call self%complain(diagnostics, cells(bad), whole, 'the line of names has one name per column')
    end subroutine open_table

    !> Reads the rows, up to the first that is not valid.
    subroutine read_rows(self, diagnostics)
        class(table_t), intent(inout) :: self
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        character(*), parameter :: hint = 'a row has a cell for each column'
        type(cell_t), allocatable :: names(:, :), cells(:)
        integer :: columns, rows, line, first, last, end_of_rows, n, bad

        columns = size(self%names)
        rows = 0
        line = self%cells(1, 0)%line
        last = self%end_of_names
        do while (next_line(self%text, line, first, last))
            rows = rows + 1
        end do
        call move_alloc(self%cells, names)
        allocate (self%cells(columns, 0:rows), cells(columns + 1))
        self%cells(:, 0) = names(:, 0)
        line = names(1, 0)%line
        last = self%end_of_names
        end_of_rows = last
        do while (next_line(self%text, line, first, last))
            call self%cut(line, first, last, cells, n, bad)
            if (bad > 0) then
                call self%complain(diagnostics, cells(bad), whole, hint)
            else if (n < columns) then
                call self%complain(diagnostics, cells(n), 'the row ends before ' // abbreviate(self%names(n + 1)%text), hint)
            else if (n > columns) then
                call self%complain(diagnostics, cells(n), 'the row has more cells than the table has columns', &
                                   hint // '; where commas separate, decimals have points')
            end if
            if (bad > 0 .or. n /= columns) return
            self%rows = self%rows + 1
            self%cells(:, self%rows) = cells(:columns)
            end_of_rows = last
        end do
        self%frame = self%text(:min(self%end_of_names + 1, len(self%text))) // self%text(end_of_rows + 2:)
    end subroutine read_rows

    !> Moves to the next line with cells; false if there is none.
    logical function next_line(text, line, first, last) result(found)
        character(*), intent(in) :: text
        integer, intent(inout) :: line, last !! number of the line, and its last byte: before and after
        integer, intent(out) :: first !! its first byte
        integer :: start
        do
            first = last + 2 ! behind the line feed
            found = first <= len(text)
            if (.not. found) return
            last = end_of_line(text, first)
            line = line + 1
            start = first + verify(text(first:last), blanks) - 1
            if (start < first) cycle
            if (text(start:start) /= '#') return
        end do
    end function next_line

    !> Finds the cells of a line, as many as there is room for. A comma inside quotes does not separate cells.
    subroutine cut(self, line, first, last, cells, n, bad)
        class(table_t), intent(in) :: self
        integer, intent(in) :: line, first, last !! number of the line, its first and last byte
        type(cell_t), intent(out) :: cells(:)
        integer, intent(out) :: n !! number of them
        integer, intent(out) :: bad !! the first whose quotes are not around the whole of it; 0 if there is none
        integer :: next, from, to, behind, comma, closing
        logical :: is_quoted

        n = 0
        bad = 0
        next = first
        associate (text => self%text)
            do while (next <= last + 1 .and. n < size(cells))
                from = verify(text(next:last), blanks)
                from = merge(next + from - 1, last + 1, from > 0)
                closing = 0
                is_quoted = .false.
                if (from <= last) is_quoted = text(from:from) == '"'
                if (is_quoted) closing = index(text(from + 1:last), '"')
                behind = from + closing + merge(1, 0, is_quoted)
                comma = index(text(behind:last), ',')
                comma = merge(behind + comma - 1, last + 1, comma > 0)
                to = from - 1 + verify(text(from:comma - 1), blanks, back=.true.)
                next = comma + 1
                n = n + 1
                if (is_quoted .and. closing > 0 .and. from + closing == to) then
                    cells(n) = cell_t(line, from - first + 2, from + 1, to - 1)
                else
                    cells(n) = cell_t(line, from - first + 1, from, to)
                    if (index(text(from:to), '"') > 0 .and. bad == 0) bad = n
                end if
            end do
        end associate
    end subroutine cut

    !> The numbers of a column; NaN where a cell is not a number, and no elements if there is no such column.
    function column(self, name) result(values)
        class(table_t), intent(in) :: self
        character(*), intent(in) :: name !! name of the column
        real(dp), allocatable :: values(:)
        type(error_t), allocatable :: ignored
        call self%read_column(name, values, ignored)
    end function column

    !> The cells of a column as text; no elements if there is no such column.
    function words(self, name) result(cells)
        class(table_t), intent(in) :: self
        character(*), intent(in) :: name !! name of the column
        type(string_t), allocatable :: cells(:)
        integer :: i, row
        i = index_of(self, name)
        allocate (cells(merge(self%rows, 0, i > 0)))
        do row = 1, size(cells)
            cells(row)%text = self%text(self%cells(i, row)%from:self%cells(i, row)%to)
        end do
    end function words

    !> The numbers of a column, or an error: there is no such column, or a cell is not a number.
    subroutine read_column(self, name, values, error, takes_empty)
        class(table_t), intent(in) :: self
        character(*), intent(in) :: name !! name of the column
        real(dp), allocatable, intent(out) :: values(:) !! `nan` and `inf` are numbers, as tables contain them
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: takes_empty !! whether an empty cell, or one of `not_there`, is NaN, and no error
        logical :: is_number, takes
        integer :: column, row, status

        column = index_of(self, name)
        if (column == 0) then
            allocate (values(0))
            error = input_error('no table was read')
            if (allocated(self%path)) error = input_error(escaped(self%path) // ': there is no column ' // &
                escaped(abbreviate(name)) // ': ' // suggest_word(name, self%names))
            return
        end if
        takes = .false.
        if (present(takes_empty)) takes = takes_empty
        allocate (values(self%rows))
        do row = 1, size(values)
            associate (cell => self%text(self%cells(column, row)%from:self%cells(column, row)%to), value => values(row))
                ! List-directed reading alone takes `/`, `2*3` and more.
                is_number = is_number_cell(cell)
                if (is_number) then
                    read (cell, *, iostat=status) value
                    is_number = status == 0 .and. (abs(value) <= huge(value) .or. scan(cell, 'nN') > 0) ! 1e999 is too large
                end if
                if (is_number) cycle
                value = no_number
                if (allocated(error) .or. (takes .and. any(lower_case(cell) == not_there))) cycle
                error = input_error(self%place_of_row(row) // ": '" // escaped(abbreviate(cell)) // "' in column " // name // &
                                    ' is not a number')
            end associate
        end do
    end subroutine read_column

    !> Reads a finite number; `problem` and `hint` describe an error.
    subroutine read_number(self, column, row, value, problem, hint)
        class(table_t), intent(in) :: self
        integer, intent(in) :: column, row
        real(dp), intent(out) :: value !! the value, if there is no problem
        character(:), allocatable, intent(out) :: problem, hint !! what is wrong, and what is expected; '' without an error
        associate (cell => self%cells(column, row))
            call read_real(self%text(cell%from:cell%to), value, problem, hint)
            if (cell%to < cell%from) problem = 'no value for ' // self%names(column)%text
        end associate
    end subroutine read_number

    !> Reports an error in a cell; row 0 has the names.
    subroutine refuse(self, diagnostics, column, row, message, hint)
        class(table_t), intent(inout) :: self
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        integer, intent(in) :: column, row
        character(*), intent(in) :: message, hint !! what is wrong, and what is expected
        call self%complain(diagnostics, self%cells(column, row), message, hint)
    end subroutine refuse

    !> Reports an error at a place.
    subroutine complain(self, diagnostics, cell, message, hint)
        class(table_t), intent(inout) :: self
        type(diagnostics_t), intent(inout) :: diagnostics
        type(cell_t), intent(in) :: cell
        character(*), intent(in) :: message, hint
        self%is_valid = .false.
        if (self%source == 0) call diagnostics%add_source(self%path, self%text, self%source)
        call diagnostics%error(place_t(self%source, cell%line, cell%position, max(1, cell%to - cell%from + 1)), message, hint)
    end subroutine complain

    !> The file and the line of a row, for messages.
    function place_of_row(self, row) result(place)
        class(table_t), intent(in) :: self
        integer, intent(in) :: row !! its number
        character(:), allocatable :: place
        place = escaped(self%path) // ':' // to_text(self%cells(1, row)%line)
    end function place_of_row

    !> Index of a column by its name; 0 if there is none.
    pure integer function index_of(self, name) result(place)
        class(table_t), intent(in) :: self
        character(*), intent(in) :: name
        integer :: i
        place = 0
        if (.not. allocated(self%names)) return
        do i = 1, size(self%names)
            if (self%names(i)%text == name) place = i
        end do
    end function index_of

    !> Begins a table of many cases, and makes room for all its rows.
    subroutine begin(self, columns, rows, error)
        class(data_table_t), intent(out) :: self
        type(table_column_t), intent(in) :: columns(:)
        integer(int64), intent(in) :: rows !! number of rows
        type(error_t), allocatable, intent(out) :: error !! there is not enough memory
        integer :: i, status
        real(dp) :: none

        self%name = 'rows'
        allocate (self%column(size(columns)))
        do i = 1, size(columns)
            associate (column => self%column(i))
                column%column_t = columns(i)%column_t
                if (columns(i)%kind == column_of_words) column%words = columns(i)%words
                column%has_notes = columns(i)%kind == column_of_notes
                if (column%has_notes) call find_word('', column, latest_notes, none)
                allocate (column%values(rows), stat=status)
            end associate
            if (status /= 0) then
                error = internal_error('not enough memory for a table of so many rows')
                return
            end if
        end do
    end subroutine begin

    !> Adds rows.
    subroutine add(self, block)
        class(data_table_t), intent(inout) :: self
        type(row_block_t), intent(in) :: block !! rows in their order, as cells
        integer :: i, k

        do i = 1, size(self%column)
            associate (column => self%column(i), first => self%rows)
                column%values(first + 1:first + block%rows) = block%cells(i, :block%rows)
                if (.not. column%has_notes) cycle
                column%values(first + 1:first + block%rows) = 0
                do k = 1, block%rows
                    if (.not. allocated(block%notes(k)%text)) cycle
                    call find_word(block%notes(k)%text, column, latest_notes, column%values(first + k))
                end do
            end associate
        end do
        self%rows = self%rows + block%rows
    end subroutine add

    !> Loads a CSV table that the program wrote, with the units and meanings of its columns.
    subroutine load_table(path, name, table, error)
        character(*), intent(in) :: path !! path of the file
        character(*), intent(in) :: name !! what it is
        type(data_table_t), intent(out) :: table !! the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_t) :: loaded
        integer :: i

        call read_table(path, loaded, error)
        if (allocated(error)) return
        call move_alloc(loaded%frame, table%frame)
        table%name = name
        allocate (table%column(size(loaded%names)))
        do i = 1, size(loaded%names)
            associate (column => table%column(i))
                column%name = loaded%names(i)%text
                call describe_column(table%frame, column)
                call read_cells(loaded, loaded%names(i)%text, column)
                table%rows = size(column%values)
            end associate
        end do
    end subroutine load_table

    !> Finds unit and meaning of a column in the header: `#     name [unit]: meaning`, after the line `# columns:`.
    pure subroutine describe_column(frame, column)
        character(*), intent(in) :: frame
        type(data_column_t), intent(inout) :: column
        character(:), allocatable :: key, line
        integer :: list, place, colon

        key = new_line('a') // '#     ' // trim(column%name)
        list = max(index(frame, '# columns:' // new_line('a')), 1)
        place = max(index(frame(list:), key // ': '), index(frame(list:), key // ' ['))
        if (place == 0) return
        line = frame(list + place - 1 + len(key):)
        line = line(:index(line // new_line('a'), new_line('a')) - 1)
        colon = index(line, ': ')
        if (colon == 0) return
        if (colon > 1) column%unit = line(3:index(line(:colon), ']', back=.true.) - 1)
        column%what = line(colon + 2:)
    end subroutine describe_column

    !> Reads the cells of a column: numbers if all are numbers, otherwise words.
    subroutine read_cells(loaded, name, column)
        type(table_t), intent(in) :: loaded
        character(*), intent(in) :: name
        type(data_column_t), intent(inout) :: column
        type(error_t), allocatable :: no_numbers
        type(string_t), allocatable :: cells(:)
        integer :: i

        call loaded%read_column(name, column%values, no_numbers)
        if (.not. allocated(no_numbers)) return
        allocate (cells, source=loaded%words(name))
        allocate (column%words(0))
        do i = 1, size(cells)
            call find_word(cells(i)%text, column, huge(i), column%values(i))
        end do
        column%words = column%words(:column%used)
    end subroutine read_cells

    !> Finds a word among the latest of a column, or adds it.
    subroutine find_word(word, column, latest, number)
        character(*), intent(in) :: word
        type(data_column_t), intent(inout) :: column
        integer, intent(in) :: latest !! number of words that are compared
        real(dp), intent(inout) :: number !! its number, from 0
        type(string_t), allocatable :: larger(:)
        integer :: k

        do k = column%used, max(1, column%used - latest), -1
            number = k - 1
            if (column%words(k)%text == word) return
        end do
        if (.not. allocated(column%words)) allocate (column%words(0))
        if (column%used == size(column%words)) then
            allocate (larger(max(1, 2 * column%used)))
            larger(:column%used) = column%words
            do k = column%used + 1, size(larger)
                larger(k)%text = ''
            end do
            call move_alloc(larger, column%words)
        end if
        number = column%used
        column%used = column%used + 1
        column%words(column%used)%text = word
    end subroutine find_word

end module spintop_loaded_table
