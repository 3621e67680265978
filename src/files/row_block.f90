!> Rows of consecutive cases, as one thread hands them to another.
module spintop_row_block
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_status, only: last_status
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: row_block_t

    type :: row_block_t
        type(text_buffer_t) :: text
        !> Rows of each status.
        integer(int64) :: counts(0:last_status) = 0
    contains
        procedure :: clear
        procedure :: swap
    end type row_block_t

contains

    !> Empties the block, but keeps its memory.
    subroutine clear(self)
        class(row_block_t), intent(inout) :: self
        call self%text%clear()
        self%counts = 0
    end subroutine clear

    !> Exchanges the rows with another block.
    subroutine swap(self, other)
        class(row_block_t), intent(inout) :: self
        type(row_block_t), intent(inout) :: other
        integer(int64) :: counts(0:last_status)
        call self%text%swap(other%text)
        counts = self%counts
        self%counts = other%counts
        other%counts = counts
    end subroutine swap

end module spintop_row_block
