!> Reads the cells of a CSV table one by one, and knows the place of each for messages.
!>
!>     # drawn elsewhere
!>     initial.spin_ratio, "top.inertia(2)"
!>     0.5,                0.875
!>
!> Blank lines and lines that begin with `#` are ignored, and so are blanks around a cell; double
!> quotes may stand around a whole cell.
module spintop_table_walk
    use spintop_diagnostics, only: diagnostics_t, place_t
    use spintop_errors, only: error_t
    use spintop_files, only: read_file
    use spintop_kinds, only: dp
    use spintop_literals, only: read_real
    implicit none
    private
    public :: table_walk_t, table_cursor_t

    !> No table may be larger (bytes).
    integer, parameter :: largest_table = 2**30 - 1
    character(*), parameter :: blanks = ' ' // achar(9) // achar(13)
    character(*), parameter :: byte_order_mark = char(239) // char(187) // char(191)

    !> A place in a table.
    type :: table_cursor_t
        !> The line: its number, its first byte and its last.
        integer :: line = 0, first = 1, last = 0
        !> The cell: its first and last byte, without blanks and quotes; and where the next one
        !> begins, more than one byte behind the line if there is none.
        integer :: from = 1, to = 0, next = 1
        !> Quotes stand around the whole cell, or nowhere.
        logical :: is_quoted_well = .true.
    end type table_cursor_t

    !> A walk through the cells of a table.
    type :: table_walk_t
        character(:), allocatable :: path, text
        type(table_cursor_t) :: at
        !> Number of the table among the sources of the diagnostics, once something is wrong with it.
        integer :: source = 0
    contains
        procedure :: open
        procedure :: next_line
        procedure :: next_cell
        procedure :: has_cell
        procedure :: cell
        procedure :: read_number
        procedure :: refuse
    end type table_walk_t

contains

    !> Reads a table whose path is relative to the folder of an input, and goes to its first line. A file
    !> that cannot be read is an error; what is wrong with its text goes to the diagnostics.
    subroutine open(self, input, path, diagnostics, has_lines, error)
        class(table_walk_t), intent(out) :: self
        character(*), intent(in) :: input !! path of the input
        character(*), intent(in) :: path
        type(diagnostics_t), intent(inout) :: diagnostics
        logical, intent(out) :: has_lines
        type(error_t), allocatable, intent(out) :: error

        has_lines = .false.
        self%path = trim(path)
        if (self%path(1:1) /= '/') self%path = input(:index(input, '/', back=.true.)) // self%path
        call read_file(self%path, largest_table, self%text, error)
        if (allocated(error)) return
        if (index(self%text, byte_order_mark) == 1) self%at%last = len(byte_order_mark)
        if (index(self%text, achar(0)) > 0) then
            call self%refuse(diagnostics, 'not a text file: it has NUL bytes', 'expected a CSV table')
            return
        end if
        has_lines = self%next_line()
        if (has_lines) return
        self%at = table_cursor_t()
        call self%refuse(diagnostics, 'the table is empty', 'it begins with a line of names')
    end subroutine open

    !> Goes to the next line that holds cells; false if there is none.
    logical function next_line(self) result(found)
        class(table_walk_t), intent(inout) :: self
        integer :: length, start
        associate (at => self%at)
            do
                at%first = at%last + 1
                if (at%line > 0) at%first = at%first + 1 ! behind the line feed
                found = at%first <= len(self%text)
                if (.not. found) return
                length = index(self%text(at%first:), new_line('a')) - 1
                if (length < 0) length = len(self%text) - at%first + 1
                at%last = at%first + length - 1
                at%line = at%line + 1
                at%next = at%first
                start = at%first + verify(self%text(at%first:at%last), blanks) - 1
                if (start < at%first) cycle
                if (self%text(start:start) /= '#') return
            end do
        end associate
    end function next_line

    !> Whether the line has another cell.
    pure logical function has_cell(self)
        class(table_walk_t), intent(in) :: self
        has_cell = self%at%next <= self%at%last + 1
    end function has_cell

    !> Goes to the next cell.
    pure subroutine next_cell(self)
        class(table_walk_t), intent(inout) :: self
        integer :: closing, start, comma

        associate (at => self%at, text => self%text)
            at%from = at%next
            do while (is_in(blanks, at%from))
                at%from = at%from + 1
            end do
            start = at%from
            closing = 0
            if (is_in('"', start)) then
                ! A comma inside quotes parts no cells.
                closing = start + index(text(start + 1:at%last), '"')
                start = closing + 1
            end if
            comma = start + index(text(start:at%last), ',') - 1
            if (comma < start) comma = at%last + 1
            at%next = comma + 1
            at%to = at%from - 1 + verify(text(at%from:comma - 1), blanks, back=.true.)
            if (closing > 0) then
                at%is_quoted_well = closing == at%to .and. at%to > at%from
                if (at%is_quoted_well) then
                    at%from = at%from + 1
                    at%to = at%to - 1
                end if
            else
                at%is_quoted_well = index(text(at%from:at%to), '"') == 0
            end if
        end associate

    contains

        !> Whether a byte of the line is one of a set.
        pure logical function is_in(set, byte)
            character(*), intent(in) :: set
            integer, intent(in) :: byte
            is_in = byte <= self%at%last
            if (is_in) is_in = index(set, self%text(byte:byte)) > 0
        end function is_in

    end subroutine next_cell

    !> The text of the cell.
    pure function cell(self)
        class(table_walk_t), intent(in) :: self
        character(:), allocatable :: cell
        cell = self%text(self%at%from:self%at%to)
    end function cell

    !> The number in the cell, or what is wrong with it.
    subroutine read_number(self, name, value, problem, hint)
        class(table_walk_t), intent(in) :: self
        character(*), intent(in) :: name !! of the column
        real(dp), intent(out) :: value
        character(:), allocatable, intent(out) :: problem, hint
        call read_real(self%cell(), value, problem, hint)
        if (self%at%to < self%at%from) problem = 'no value for ' // name
        if (.not. self%at%is_quoted_well) problem = 'quotes stand around a whole cell or not at all'
    end subroutine read_number

    !> Shows what is wrong with the cell, or with the table where no line was reached.
    subroutine refuse(self, diagnostics, message, hint)
        class(table_walk_t), intent(inout) :: self
        type(diagnostics_t), intent(inout) :: diagnostics
        character(*), intent(in) :: message, hint
        if (self%source == 0) call diagnostics%add_source(self%path, self%text, self%source)
        associate (at => self%at)
            call diagnostics%error(place_t(self%source, at%line, at%from - at%first + 1, &
                                           max(1, at%to - at%from + 1)), message, hint)
        end associate
    end subroutine refuse

end module spintop_table_walk
