!> Rows of consecutive cases, which one thread passes to another, as cells or as text.
module spintop_row_block
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_status, only: last_status
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_reals, column_of_words, &
        table_column_t
    use spintop_text, only: real_width, string_t, write_integer, write_reals
    implicit none
    private
    public :: row_block_t, text_buffer_t

    !> Rows of a table as text in memory, independent of any file. Each thread may have its own.
    !>
    !>     call rows%add_integer(number)
    !>     call rows%add_reals(values)
    !>     call rows%add_text('ok')
    !>     call rows%end_row()
    type :: text_buffer_t
        integer :: length = 0                !! number of bytes so far
        character(:), allocatable :: room    !! memory, which begins with them
        logical, private :: in_row = .false.
    contains
        procedure :: add_reals
        procedure :: add_integer
        procedure :: add_text
        procedure :: add_name
        procedure :: end_row
        procedure :: append
        procedure :: contents
        procedure :: clear => clear_text
    end type text_buffer_t

    !> Rows of consecutive cases, as cells or as text.
    type :: row_block_t
        !> Number of rows as cells; 0 after they were formatted as text.
        integer :: rows = 0
        !> The cell of column i in row k is `cells(i, k)`; see spintop_table_column.
        real(dp), allocatable :: cells(:, :)
        !> The notes of each row, of which the cells contain only bits; not allocated if there are none.
        type(string_t), allocatable :: notes(:)
        !> The rows as text.
        type(text_buffer_t) :: text
        !> What is gathered of each row for statistics, beside its cells or its text: of row k `statistics_cells(k, :)`.
        real(dp), allocatable :: statistics_cells(:, :)
        !> Number of rows of which these are there.
        integer :: statistics_rows = 0
        !> Number of rows with each status.
        integer(int64) :: counts(0:last_status) = 0
        !> Number of rows that a note makes doubtful.
        integer(int64) :: doubtful = 0
    contains
        procedure :: reserve
        procedure :: reserve_statistics_cells
        procedure :: clear
        procedure :: set_note
        procedure :: format
        procedure :: format_as_in_memory
        procedure :: swap
    end type row_block_t

contains

    !> Empties the block, and makes room for rows.
    subroutine reserve(self, columns, rows)
        class(row_block_t), intent(inout) :: self
        integer, intent(in) :: columns, rows !! numbers of columns and rows
        call self%clear()
        if (allocated(self%cells)) then
            if (size(self%cells, 1) == columns .and. size(self%cells, 2) >= rows) return
            deallocate (self%cells, self%notes)
        end if
        allocate (self%cells(columns, rows), self%notes(rows))
    end subroutine reserve

    !> Makes room for what is gathered of rows for statistics.
    subroutine reserve_statistics_cells(self, length, rows)
        class(row_block_t), intent(inout) :: self
        integer, intent(in) :: length, rows !! numbers for each row, and number of rows
        self%statistics_rows = rows
        if (allocated(self%statistics_cells)) then
            if (size(self%statistics_cells, 1) == rows .and. size(self%statistics_cells, 2) == length) return
            deallocate (self%statistics_cells)
        end if
        allocate (self%statistics_cells(rows, length))
    end subroutine reserve_statistics_cells

    !> Empties the block, and keeps its memory.
    subroutine clear(self)
        class(row_block_t), intent(inout) :: self
        self%rows = 0
        self%statistics_rows = 0
        call self%text%clear()
        self%counts = 0
        self%doubtful = 0
    end subroutine clear

    !> Sets the notes of the last row; none if `text` is not allocated. Few rows have notes, and those without
    !> cost no memory.
    subroutine set_note(self, text)
        class(row_block_t), intent(inout) :: self
        character(:), allocatable, intent(in) :: text !! notes; none if not allocated
        associate (note => self%notes(self%rows))
            if (allocated(text)) then
                note%text = text
            else if (allocated(note%text)) then
                deallocate (note%text)
            end if
        end associate
    end subroutine set_note

    !> Formats the cells as text, and discards them.
    subroutine format(self, columns)
        class(row_block_t), intent(inout) :: self
        type(table_column_t), intent(in) :: columns(:) !! the columns
        integer :: last(size(columns)), i, k

        ! Consecutive reals are formatted together, which is faster: this finds the last of the reals that
        ! begin with a column.
        do i = size(columns), 1, -1
            last(i) = i
            if (columns(i)%kind /= column_of_reals .or. i == size(columns)) cycle
            if (columns(i + 1)%kind == column_of_reals) last(i) = last(i + 1)
        end do
        do k = 1, self%rows
            i = 1
            do while (i <= size(columns))
                select case (columns(i)%kind)
                case (column_of_reals)
                    call self%text%add_reals(self%cells(i:last(i), k))
                case (column_of_integers)
                    call self%text%add_integer(nint(self%cells(i, k), int64))
                case (column_of_words)
                    call self%text%add_name(columns(i)%words(nint(self%cells(i, k)) + 1)%text)
                case (column_of_notes)
                    if (allocated(self%notes(k)%text)) then
                        call self%text%add_text(self%notes(k)%text)
                    else
                        call self%text%add_text('')
                    end if
                end select
                i = last(i) + 1
            end do
            call self%text%end_row()
        end do
        self%rows = 0
    end subroutine format

    !> Makes the cells text as they are in memory, and discards them.
    subroutine format_as_in_memory(self)
        class(row_block_t), intent(inout) :: self
        character(:), allocatable :: bytes
        if (self%rows == 0) return
        allocate (character(size(self%cells, 1) * self%rows * (storage_size(self%cells) / 8)) :: bytes)
        bytes = transfer(self%cells(:, :self%rows), bytes)
        call self%text%append(bytes)
        self%rows = 0
    end subroutine format_as_in_memory

    !> Exchanges the rows with another block.
    subroutine swap(self, other)
        class(row_block_t), intent(inout) :: self
        type(row_block_t), intent(inout) :: other !! the other block
        type(row_block_t) :: third
        call move(self, third)
        call move(other, self)
        call move(third, other)
    end subroutine swap

    !> Moves the rows of a block to another one, whose own rows are lost.
    subroutine move(from, to)
        class(row_block_t), intent(inout) :: from, to
        to%rows = from%rows
        to%counts = from%counts
        to%doubtful = from%doubtful
        to%statistics_rows = from%statistics_rows
        call move_alloc(from%cells, to%cells)
        call move_alloc(from%statistics_cells, to%statistics_cells)
        call move_alloc(from%notes, to%notes)
        to%text%length = from%text%length
        call move_alloc(from%text%room, to%text%room)
    end subroutine move

    !> Adds real cells, in the shortest form that gives the same bits when it is read; `nan` and `inf` if not
    !> finite.
    subroutine add_reals(self, values)
        class(text_buffer_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: values(:) !! numbers
        integer :: written

        if (size(values) == 0) return
        call start_cell(self)
        call make_room(self, (real_width + 1) * size(values))
        written = write_reals(values, size(values), self%room(self%length + 1:), len(self%room) - self%length)
        self%length = self%length + written
    end subroutine add_reals

    !> Adds an integer cell.
    subroutine add_integer(self, value)
        class(text_buffer_t), intent(inout) :: self
        integer(int64), intent(in) :: value !! the content of the cell
        integer :: written
        call start_cell(self)
        call make_room(self, real_width)
        written = write_integer(value, self%room(self%length + 1:), len(self%room) - self%length)
        self%length = self%length + written
    end subroutine add_integer

    !> Adds a text cell. A comma becomes a semicolon, a quote a back quote, and other characters that would
    !> break a table (`#`, line ends, control characters) a blank.
    subroutine add_text(self, text)
        class(text_buffer_t), intent(inout) :: self
        character(*), intent(in) :: text !! the content of the cell
        character(len(text)) :: cell
        integer :: i

        cell = text
        do i = 1, len(text)
            select case (text(i:i))
            case (',')
                cell(i:i) = ';'
            case ('''', '"')
                cell(i:i) = '`'
            case ('#', achar(0):achar(31), achar(127))
                cell(i:i) = ' '
            end select
        end do
        call start_cell(self)
        call self%append(trim(cell))
    end subroutine add_text

    !> Adds the name of a column or of a parameter as a cell, in quotes if it has a comma, as `part.place(2,1)` has
    !> (RFC 4180).
    subroutine add_name(self, name)
        class(text_buffer_t), intent(inout) :: self
        character(*), intent(in) :: name !! the name, or another word without quotes
        call start_cell(self)
        if (index(name, ',') > 0) call self%append('"')
        call self%append(trim(name))
        if (index(name, ',') > 0) call self%append('"')
    end subroutine add_name

    !> Ends the row.
    subroutine end_row(self)
        class(text_buffer_t), intent(inout) :: self
        call self%append(new_line('a'))
        self%in_row = .false.
    end subroutine end_row

    !> Adds a text without a change.
    subroutine append(self, text)
        class(text_buffer_t), intent(inout) :: self
        character(*), intent(in) :: text !! the text, which is not changed
        call make_room(self, len(text))
        self%room(self%length + 1:self%length + len(text)) = text
        self%length = self%length + len(text)
    end subroutine append

    !> All rows so far.
    function contents(self) result(text)
        class(text_buffer_t), intent(in) :: self
        character(:), allocatable :: text
        text = ''
        if (self%length > 0) text = self%room(:self%length)
    end function contents

    !> Empties the buffer, and keeps its memory.
    subroutine clear_text(self)
        class(text_buffer_t), intent(inout) :: self
        self%length = 0
        self%in_row = .false.
    end subroutine clear_text

    subroutine start_cell(self)
        class(text_buffer_t), intent(inout) :: self
        if (self%in_row) call self%append(',')
        self%in_row = .true.
    end subroutine start_cell

    !> Makes room for more bytes.
    subroutine make_room(self, more)
        class(text_buffer_t), intent(inout) :: self
        integer, intent(in) :: more
        character(:), allocatable :: larger
        integer, parameter :: least = 4096

        if (.not. allocated(self%room)) allocate (character(least) :: self%room)
        if (self%length + more <= len(self%room)) return
        allocate (character(2 * (self%length + more)) :: larger)
        larger(:self%length) = self%room(:self%length)
        call move_alloc(larger, self%room)
    end subroutine make_room

end module spintop_row_block
