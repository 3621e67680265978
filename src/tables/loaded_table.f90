!> A table in memory, read from a CSV file: names of the columns, and the cells as text or as numbers.
!>
!>     call read_table(path, table, error)
!>     if (.not. allocated(error)) call table%read_column('theta', theta, error)
module spintop_loaded_table
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, input_error
    use spintop_kinds, only: dp, no_number
    use spintop_literals, only: is_number_cell
    use spintop_suggestions, only: suggest_word
    use spintop_table_walk, only: table_cursor_t, table_walk_t
    use spintop_text, only: abbreviate, escaped, string_t, to_text
    implicit none
    private
    public :: read_table, table_t

    !> A table in memory.
    type :: table_t
        !> Names of the columns.
        type(string_t), allocatable :: names(:)
        !> The cells as text: columns, rows.
        type(string_t), allocatable :: cells(:, :)
        !> Whether it has the last line of a complete table.
        logical :: has_end = .false.
        !> How it differs from what was written, where that is no error; '' if it does not.
        character(:), allocatable :: damage
        !> Its text without the rows: header, names of the columns, and lines at the end such as the status.
        character(:), allocatable :: frame
        !> The file, and the line of each row, for messages.
        character(:), allocatable, private :: path
        integer, allocatable, private :: lines(:)
    contains
        procedure :: column
        procedure :: words
        procedure :: read_column
        procedure :: place_of_row
    end type table_t

contains

    !> Reads a CSV table, such as the program writes. What is not valid is an error with its line and column:
    !> another format, an empty file, a name that is missing or repeated, a row with another number of cells.
    subroutine read_table(path, table, error, takes_damaged)
        character(*), intent(in) :: path !! path of the file
        type(table_t), intent(out) :: table !! the table; without columns if there is an error
        type(error_t), allocatable, intent(out) :: error !! it cannot be read, or is not a table
        logical, intent(in), optional :: takes_damaged !! whether a table that differs from what was written is no error
        type(table_walk_t) :: walk
        type(diagnostics_t) :: diagnostics
        logical :: has_lines

        call walk%open('', path, diagnostics, has_lines, error, takes_damaged)
        if (allocated(error)) return
        table%has_end = walk%has_end
        table%damage = walk%damage
        table%path = path
        if (has_lines) call read_names(walk, table%names, diagnostics)
        if (.not. diagnostics%has_errors()) call read_rows(walk, table, diagnostics)
        call diagnostics%raise(error)
        if (allocated(error)) table = table_t()
    end subroutine read_table

    !> Reads the line of names.
    subroutine read_names(walk, names, diagnostics)
        type(table_walk_t), intent(inout) :: walk
        type(string_t), allocatable, intent(out) :: names(:)
        type(diagnostics_t), intent(inout) :: diagnostics
        character(*), parameter :: hint = 'the line of names has one name per column'
        type(table_cursor_t) :: head
        integer :: columns, i, k

        head = walk%at
        columns = 0
        do while (walk%has_cell())
            call walk%next_cell()
            columns = columns + 1
        end do
        walk%at = head
        allocate (names(columns))
        do i = 1, columns
            call walk%next_cell()
            names(i)%text = walk%cell()
            if (.not. walk%at%is_quoted_well) then
                call walk%refuse(diagnostics, 'quotes must be around the whole cell', hint)
            else if (names(i)%text == '') then
                call walk%refuse(diagnostics, 'column ' // to_text(i) // ' has no name', hint)
            else if (any([(names(k)%text == names(i)%text, k=1, i - 1)])) then
                call walk%refuse(diagnostics, 'there are two columns ' // abbreviate(names(i)%text), hint)
            end if
        end do
    end subroutine read_names

    !> Reads the rows, up to the first that is not valid.
    subroutine read_rows(walk, table, diagnostics)
        type(table_walk_t), intent(inout) :: walk
        type(table_t), intent(inout) :: table
        type(diagnostics_t), intent(inout) :: diagnostics
        character(*), parameter :: hint = 'a row has a cell for each column'
        type(table_cursor_t) :: head
        integer :: rows, row, last, i

        head = walk%at
        rows = 0
        last = head%last
        do while (walk%next_line())
            rows = rows + 1
            last = walk%at%last
        end do
        table%frame = walk%text(:min(head%last + 1, len(walk%text))) // walk%text(last + 2:)
        walk%at = head
        allocate (table%cells(size(table%names), rows), table%lines(rows))
        do row = 1, rows
            if (.not. walk%next_line()) exit
            table%lines(row) = walk%at%line
            do i = 1, size(table%names)
                if (.not. walk%has_cell()) then
                    call walk%refuse(diagnostics, 'the row ends before ' // abbreviate(table%names(i)%text), hint)
                    return
                end if
                call walk%next_cell()
                if (.not. walk%at%is_quoted_well) then
                    call walk%refuse(diagnostics, 'quotes must be around the whole cell', hint)
                    return
                end if
                table%cells(i, row)%text = walk%cell()
            end do
            if (walk%has_cell()) then
                call walk%next_cell()
                call walk%refuse(diagnostics, 'the row has more cells than the table has columns', hint)
                return
            end if
        end do
    end subroutine read_rows

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
        integer :: i
        i = index_of(self, name)
        if (i > 0) then
            allocate (cells, source=self%cells(i, :))
        else
            allocate (cells(0))
        end if
    end function words

    !> The numbers of a column, or an error: there is no such column, or a cell is not a number.
    subroutine read_column(self, name, values, error, takes_empty)
        class(table_t), intent(in) :: self
        character(*), intent(in) :: name !! name of the column
        real(dp), allocatable, intent(out) :: values(:) !! `nan` and `inf` are numbers, as tables contain them
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: takes_empty !! whether an empty cell is NaN, and no error
        logical :: is_number, takes
        integer :: column, row

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
        allocate (values(size(self%lines)))
        do row = 1, size(values)
            associate (cell => self%cells(column, row))
                call read_cell(cell%text, values(row), is_number)
                if (is_number .or. allocated(error) .or. (takes .and. cell%text == '')) cycle
                error = input_error(self%place_of_row(row) // ": '" // &
                                    escaped(abbreviate(cell%text)) // "' in column " // name // ' is not a number')
            end associate
        end do
    end subroutine read_column

    !> The file and the line of a row, for messages.
    function place_of_row(self, row) result(place)
        class(table_t), intent(in) :: self
        integer, intent(in) :: row !! its number
        character(:), allocatable :: place
        place = escaped(self%path) // ':' // to_text(self%lines(row))
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

    !> The number in a cell; NaN also if it is none.
    subroutine read_cell(text, value, is_number)
        character(*), intent(in) :: text
        real(dp), intent(out) :: value
        logical, intent(out) :: is_number
        integer :: status
        ! List-directed reading alone takes `/`, `2*3` and more.
        is_number = is_number_cell(text)
        if (is_number) then
            read (text, *, iostat=status) value
            is_number = status == 0 .and. (abs(value) <= huge(value) .or. scan(text, 'nN') > 0) ! 1e999 is too large
        end if
        if (.not. is_number) value = no_number
    end subroutine read_cell

end module spintop_loaded_table
