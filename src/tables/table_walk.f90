!> Reads the cells of a CSV table one by one, with their places for messages.
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
    use spintop_files, only: path_from, read_file
    use spintop_kinds, only: dp
    use spintop_literals, only: read_real
    use spintop_table_end, only: check_table_text
    use spintop_table_head, only: check_format
    implicit none
    private
    public :: table_walk_t, table_cursor_t

    !> Maximum size of a table, bytes.
    integer, parameter :: largest_table = 2**30 - 1
    character(*), parameter :: blanks = ' ' // achar(9) // achar(13)

    !> A place in a table.
    type :: table_cursor_t
        !> The line: its number, its first and its last byte.
        integer :: line = 0, first = 1, last = 0
        !> The cell: its first and last byte, without blanks and quotes; and the beginning of the next cell,
        !> more than one byte after the line if there is none.
        integer :: from = 1, to = 0, next = 1
        !> Whether quotes are around the whole cell, or absent.
        logical :: is_quoted_well = .true.
    end type table_cursor_t

    !> The state of reading a table.
    type :: table_walk_t
        character(:), allocatable :: path, text
        type(table_cursor_t) :: at
        !> Number of the table among the sources of the diagnostics, if it has errors.
        integer :: source = 0
        !> Whether it has the last line of a complete table. Then it is as it was written.
        logical :: has_end = .false.
        !> How it differs from what was written, where that is no error; '' if it does not.
        character(:), allocatable :: damage
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

    !> Opens a table whose path is relative to the folder of an input, and moves to its first line. A file
    !> that cannot be read is an error; errors of its text are added to the diagnostics.
    subroutine open(self, input, path, diagnostics, has_lines, error, takes_damaged)
        class(table_walk_t), intent(out) :: self
        character(*), intent(in) :: input !! path of the input
        character(*), intent(in) :: path !! path of the table, relative to the folder of `input`
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        logical, intent(out) :: has_lines !! whether there is a line with cells
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: takes_damaged !! whether a table that differs from what was written is no error
        character(:), allocatable :: problem

        has_lines = .false.
        self%damage = ''
        self%path = path_from(input, path)
        call read_file(self%path, largest_table, self%text, error, may_wait=.true., is_text=.true.)
        if (.not. allocated(error)) call check_format(self%path, self%text, error)
        if (allocated(error)) return
        if (index(self%text, achar(0)) > 0) then
            call self%refuse(diagnostics, 'not a text file: it has NUL bytes', 'expected a CSV table')
            return
        end if
        call check_table_text(self%text, self%has_end, problem)
        self%damage = problem
        if (present(takes_damaged)) then
            if (takes_damaged) problem = ''
        end if
        if (problem /= '') then
            call self%refuse(diagnostics, 'the table ' // problem, 'if this is intended, remove its last line')
            return
        end if
        has_lines = self%next_line()
        if (has_lines) return
        self%at = table_cursor_t()
        call self%refuse(diagnostics, 'the table is empty', 'expected a line of names')
    end subroutine open

    !> Moves to the next line with cells; false if there is none.
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

    !> Moves to the next cell.
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
                ! A comma inside quotes does not separate cells.
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

    !> Reads the number in the cell; `problem` and `hint` describe an error.
    subroutine read_number(self, name, value, problem, hint)
        class(table_walk_t), intent(in) :: self
        character(*), intent(in) :: name !! of the column
        real(dp), intent(out) :: value !! the value, if there is no problem
        character(:), allocatable, intent(out) :: problem, hint
            !! what is wrong, and what is expected; '' without an error
        call read_real(self%cell(), value, problem, hint)
        if (self%at%to < self%at%from) problem = 'no value for ' // name
        if (.not. self%at%is_quoted_well) problem = 'quotes must be around the whole cell'
    end subroutine read_number

    !> Reports an error in the cell, or in the table if no line was reached.
    subroutine refuse(self, diagnostics, message, hint)
        class(table_walk_t), intent(inout) :: self
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        character(*), intent(in) :: message, hint !! what is wrong, and what is expected
        if (self%source == 0) call diagnostics%add_source(self%path, self%text, self%source)
        associate (at => self%at)
            call diagnostics%error(place_t(self%source, at%line, at%from - at%first + 1, &
                                           max(1, at%to - at%from + 1)), message, hint)
        end associate
    end subroutine refuse

end module spintop_table_walk
