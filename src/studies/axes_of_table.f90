!> The axes of a sweep from a CSV table: parameters as columns, a case in each row.
!>
!>     # drawn elsewhere
!>     initial.spin_ratio, "top.inertia(2)"
!>     0.5,                0.875
!>
!> Blank lines and lines that begin with `#` count for nothing, nor do blanks around a cell; double
!> quotes may stand around a whole cell.
module spintop_axes_of_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_axes_of_scene, only: count_axes, find_swept
    use spintop_checksum, only: checksum_t, checksum_text, add_to_checksum
    use spintop_diagnostics, only: diagnostics_t, place_t
    use spintop_errors, only: error_t
    use spintop_literals, only: read_real
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_sweep_axes, only: axes_t, combination_names, combine_grid, combine_zip
    use spintop_system, only: read_file
    implicit none
    private
    public :: read_axes

    !> No table may be larger (bytes).
    integer, parameter :: largest_table = 2**30 - 1
    character(*), parameter :: blanks = ' ' // achar(9) // achar(13)
    character(*), parameter :: byte_order_mark = char(239) // char(187) // char(191)

    !> A place in a table.
    type :: cursor_t
        !> The line: its number, its first byte and its last.
        integer :: line = 0, first = 1, last = 0
        !> The cell: its first and last byte, without blanks and quotes; and where the next one
        !> begins, more than one byte behind the line if there is none.
        integer :: from = 1, to = 0, next = 1
        !> Quotes stand around the whole cell, or nowhere.
        logical :: is_quoted_well = .true.
    end type cursor_t

    !> A walk through the cells of a table.
    type :: walk_t
        character(:), allocatable :: path, text
        type(cursor_t) :: at
        !> Number of the table among the sources of the diagnostics, once something is wrong with it.
        integer :: source = 0
    contains
        procedure :: next_line
        procedure :: next_cell
        procedure :: has_cell
        procedure :: cell
        procedure :: refuse
    end type walk_t

contains

    !> Reads the table of a scene. What is wrong in it goes to the diagnostics, what is wrong with the
    !> scene to the problems; the axes then have no cases. A checksum that the scene has not is put in.
    subroutine read_axes(input, scene, table, axes, problems, diagnostics)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        type(scene_t), intent(inout) :: scene
        type(parameter_table_t), intent(in) :: table
        type(axes_t), intent(out) :: axes
        type(problems_t), intent(inout) :: problems
        type(diagnostics_t), intent(inout) :: diagnostics
        type(walk_t) :: walk
        type(number_slot_t), allocatable :: slots(:)
        type(error_t), allocatable :: error
        type(checksum_t) :: sum
        logical :: refused

        call check_scene(scene, problems)
        walk%path = trim(scene%sweep_table)
        if (walk%path(1:1) /= '/') walk%path = input(:index(input, '/', back=.true.)) // walk%path
        call read_file(walk%path, largest_table, walk%text, error)
        if (allocated(error)) then
            call problems%add('sweep.table', error%message, 'its path is relative to the folder of the input')
            return
        end if
        call add_to_checksum(sum, walk%text)
        if (index(walk%text, byte_order_mark) == 1) walk%text = walk%text(len(byte_order_mark) + 1:)
        if (scene%sweep_table_checksum == '') then
            scene%sweep_table_checksum = checksum_text(sum)
        else if (scene%sweep_table_checksum /= checksum_text(sum)) then
            call problems%add('sweep.table_checksum', 'the table is another one: its checksum is ' &
                              // checksum_text(sum), 'leave the checksum out to have any table')
        end if
        call read_head(walk, table, axes, slots, diagnostics, refused)
        if (size(slots) > 0) call read_rows(walk, slots, axes, diagnostics, refused)
        if (refused .or. problems%any()) return
        call axes%combine(combine_zip, int(axes%axis(1)%count, int64), int(scene%seed, int64))
    end subroutine read_axes

    !> Nothing else may say what the cases are.
    subroutine check_scene(scene, problems)
        type(scene_t), intent(in) :: scene
        type(problems_t), intent(inout) :: problems
        if (count_axes(scene) > 0) then
            call problems%add('sweep.table', 'the cases are given twice', 'give either axes or a table')
        else if (scene%combine /= combination_names(combine_grid)) then
            call problems%add('sweep.combine', 'a table has its cases in its rows', 'leave it out')
        else if (scene%cases /= unset_integer) then
            call problems%add('sweep.cases', 'a table has its cases in its rows', 'leave it out')
        end if
    end subroutine check_scene

    !> Reads the line of names: an axis and a slot for each.
    subroutine read_head(walk, table, axes, slots, diagnostics, refused)
        type(walk_t), intent(inout) :: walk
        type(parameter_table_t), intent(in) :: table
        type(axes_t), intent(inout) :: axes
        type(number_slot_t), allocatable, intent(out) :: slots(:)
        type(diagnostics_t), intent(inout) :: diagnostics
        logical, intent(out) :: refused
        type(cursor_t) :: head
        character(:), allocatable :: problem, hint
        integer :: i, k, columns

        refused = .true.
        allocate (slots(0))
        if (index(walk%text, achar(0)) > 0) then
            call walk%refuse(diagnostics, 'not a text file: it has NUL bytes', 'a CSV table is expected')
            return
        end if
        if (.not. walk%next_line()) then
            walk%at = cursor_t()
            call walk%refuse(diagnostics, 'the table is empty', 'it begins with the names of parameters')
            return
        end if
        head = walk%at
        columns = 0
        do while (walk%has_cell())
            call walk%next_cell()
            columns = columns + 1
        end do
        walk%at = head
        deallocate (slots)
        allocate (axes%axis(columns), slots(columns))
        refused = .false.
        do i = 1, columns
            call walk%next_cell()
            axes%axis(i)%name = walk%cell()
            call find_swept(axes%axis(i)%name, table, slots(i), problem, hint)
            axes%axis(i)%whole = slots(i)%is_whole()
            if (any([(slots(k)%is_same(slots(i)), k=1, i - 1)])) then
                problem = axes%axis(i)%name // ' has two columns'
                hint = 'give it one'
            end if
            if (problem == '') cycle
            if (axes%axis(i)%name == '') problem = 'a column has no name'
            call walk%refuse(diagnostics, problem, hint)
            refused = .true.
        end do
    end subroutine read_head

    !> Reads the rows into the axes. Values of columns that were refused are not judged.
    subroutine read_rows(walk, slots, axes, diagnostics, refused)
        type(walk_t), intent(inout) :: walk
        type(number_slot_t), intent(in) :: slots(:)
        type(axes_t), intent(inout) :: axes
        type(diagnostics_t), intent(inout) :: diagnostics
        logical, intent(inout) :: refused
        character(*), parameter :: one_a_column = 'a row has a cell for each column'
        type(cursor_t) :: head
        character(:), allocatable :: problem, hint
        real(dp) :: value
        integer :: rows, row, i

        head = walk%at
        rows = 0
        do while (walk%next_line())
            rows = rows + 1
        end do
        if (rows == 0) then
            walk%at = head
            call walk%refuse(diagnostics, 'the table has no rows', 'each is a case')
            refused = .true.
            return
        end if
        do i = 1, size(slots)
            allocate (axes%axis(i)%listed(rows))
            axes%axis(i)%count = rows
        end do
        walk%at = head
        do row = 1, rows
            if (.not. walk%next_line()) exit
            do i = 1, size(slots)
                if (.not. walk%has_cell()) then
                    call fail('the row ends before ' // axes%axis(i)%name, one_a_column)
                    exit
                end if
                call walk%next_cell()
                call read_real(walk%cell(), value, problem, hint)
                if (walk%at%to < walk%at%from) problem = 'no value for ' // axes%axis(i)%name
                if (.not. walk%at%is_quoted_well) problem = 'quotes stand around a whole cell or not at all'
                ! A column that was refused has no rule.
                if (problem == '' .and. allocated(slots(i)%rule)) then
                    problem = slots(i)%refusal(value)
                    if (problem /= '') problem = axes%axis(i)%name // ' ' // problem
                end if
                if (problem /= '') call fail(problem, hint)
                axes%axis(i)%listed(row) = value
            end do
            if (i > size(slots) .and. walk%has_cell()) then
                call walk%next_cell()
                call fail('the row has more cells than the table has columns', one_a_column)
            end if
        end do

    contains

        subroutine fail(message, hint)
            character(*), intent(in) :: message, hint
            call walk%refuse(diagnostics, message, hint)
            refused = .true.
        end subroutine fail

    end subroutine read_rows

    !> Goes to the next line that holds cells; false if there is none.
    logical function next_line(self) result(found)
        class(walk_t), intent(inout) :: self
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
        class(walk_t), intent(in) :: self
        has_cell = self%at%next <= self%at%last + 1
    end function has_cell

    !> Goes to the next cell.
    pure subroutine next_cell(self)
        class(walk_t), intent(inout) :: self
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
            at%to = comma - 1
            do while (at%to >= at%from .and. is_in(blanks, at%to))
                at%to = at%to - 1
            end do
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
        class(walk_t), intent(in) :: self
        character(:), allocatable :: cell
        cell = self%text(self%at%from:self%at%to)
    end function cell

    !> Shows what is wrong with the cell, or with the table where no line was reached.
    subroutine refuse(self, diagnostics, message, hint)
        class(walk_t), intent(inout) :: self
        type(diagnostics_t), intent(inout) :: diagnostics
        character(*), intent(in) :: message, hint
        if (self%source == 0) call diagnostics%add_source(self%path, self%text, self%source)
        associate (at => self%at)
            call diagnostics%error(place_t(self%source, at%line, at%from - at%first + 1, &
                                           max(1, at%to - at%from + 1)), message, hint)
        end associate
    end subroutine refuse

end module spintop_axes_of_table
