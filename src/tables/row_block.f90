!> Rows of consecutive cases, as one thread hands them to another.
module spintop_row_block
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_status, only: last_status
    use spintop_text, only: string_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: row_block_t

    !> Rows of consecutive cases, as cells or as text.
    type :: row_block_t
        !> Rows that stand as cells; none where they were made to text.
        integer :: rows = 0
        !> The cells of column i in row k: `cells(i, k)`; see spintop_table_column.
        real(dp), allocatable :: cells(:, :)
        !> The notes of each row, which the cells have as bits only; not allocated where there are none.
        type(string_t), allocatable :: notes(:)
        !> The rows as text, for a table of texts.
        type(text_buffer_t) :: text
        !> Rows of each status.
        integer(int64) :: counts(0:last_status) = 0
    contains
        procedure :: reserve
        procedure :: clear
        procedure :: set_note
        procedure :: swap
    end type row_block_t

contains

    !> Empties the block, and sees that it has room.
    subroutine reserve(self, columns, rows)
        class(row_block_t), intent(inout) :: self
        integer, intent(in) :: columns, rows
        call self%clear()
        if (allocated(self%cells)) then
            if (size(self%cells, 2) >= rows) return
            deallocate (self%cells, self%notes)
        end if
        allocate (self%cells(columns, rows), self%notes(rows))
    end subroutine reserve

    !> Empties the block, but keeps its memory.
    subroutine clear(self)
        class(row_block_t), intent(inout) :: self
        self%rows = 0
        call self%text%clear()
        self%counts = 0
    end subroutine clear

    !> Sets the notes of the last row; none if `text` is not allocated. Few rows have any, and those
    !> that have none cost no memory.
    subroutine set_note(self, text)
        class(row_block_t), intent(inout) :: self
        character(:), allocatable, intent(in) :: text
        associate (note => self%notes(self%rows))
            if (allocated(text)) then
                note%text = text
            else if (allocated(note%text)) then
                deallocate (note%text)
            end if
        end associate
    end subroutine set_note

    !> Exchanges the rows with another block.
    subroutine swap(self, other)
        class(row_block_t), intent(inout) :: self
        type(row_block_t), intent(inout) :: other
        type(row_block_t) :: third
        call move(self, third)
        call move(other, self)
        call move(third, other)
    end subroutine swap

    !> Moves the rows of a block to another, whose own are lost.
    subroutine move(from, to)
        class(row_block_t), intent(inout) :: from, to
        to%rows = from%rows
        to%counts = from%counts
        call move_alloc(from%cells, to%cells)
        call move_alloc(from%notes, to%notes)
        call to%text%swap(from%text)
    end subroutine move

end module spintop_row_block
