!> Rows of a table as text in memory, independent of any file. Each thread may have its own.
!>
!>     call rows%add_integer(number)
!>     call rows%add_reals(values)
!>     call rows%add_text('ok')
!>     call rows%end_row()
module spintop_text_buffer
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_text, only: real_width, write_integer, write_reals
    implicit none
    private
    public :: text_buffer_t

    !> Rows of a table as text.
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
        procedure :: clear
    end type text_buffer_t

contains

    !> Adds real cells, in the shortest form that gives the same bits when it is read; `nan` and `inf` if not
    !> finite.
    subroutine add_reals(self, values)
        class(text_buffer_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: values(:) !! numbers
        integer :: written

        if (size(values) == 0) return
        call start_cell(self)
        call reserve(self, (real_width + 1) * size(values))
        call write_reals(values, self%room(self%length + 1:), written)
        self%length = self%length + written
    end subroutine add_reals

    !> Adds an integer cell.
    subroutine add_integer(self, value)
        class(text_buffer_t), intent(inout) :: self
        integer(int64), intent(in) :: value !! the content of the cell
        integer :: written
        call start_cell(self)
        call reserve(self, real_width)
        call write_integer(value, self%room(self%length + 1:), written)
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
        call reserve(self, len(text))
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
    subroutine clear(self)
        class(text_buffer_t), intent(inout) :: self
        self%length = 0
        self%in_row = .false.
    end subroutine clear

    subroutine start_cell(self)
        class(text_buffer_t), intent(inout) :: self
        if (self%in_row) call self%append(',')
        self%in_row = .true.
    end subroutine start_cell

    !> Makes room for more bytes.
    subroutine reserve(self, more)
        class(text_buffer_t), intent(inout) :: self
        integer, intent(in) :: more
        character(:), allocatable :: larger
        integer, parameter :: least = 4096

        if (.not. allocated(self%room)) allocate (character(least) :: self%room)
        if (self%length + more <= len(self%room)) return
        allocate (character(2 * (self%length + more)) :: larger)
        larger(:self%length) = self%room(:self%length)
        call move_alloc(larger, self%room)
    end subroutine reserve

end module spintop_text_buffer
