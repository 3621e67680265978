!> Rows that threads finish in any order, written in the order of their blocks.
!>
!>     call queue%start(room=8)
!>     call queue%hand_in(block, rows, table, accepted)   ! by one thread at a time
!>
!> A thread whose rows are not accepted is too far ahead: it waits and hands them in again.
module spintop_row_queue
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_table_file, only: table_file_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: row_queue_t

    type :: row_queue_t
        !> Blocks written so far: all up to this number.
        integer(int64) :: written = 0
        !> The first error in writing; after it nothing more is written.
        type(error_t), allocatable :: error
        !> Blocks that came early, in a ring.
        type(text_buffer_t), allocatable, private :: waiting(:)
        logical, allocatable, private :: is_waiting(:)
    contains
        procedure :: start
        procedure :: hand_in
    end type row_queue_t

contains

    !> Starts an empty queue with room for so many blocks.
    subroutine start(self, room)
        class(row_queue_t), intent(inout) :: self
        integer, intent(in) :: room
        self%written = 0
        allocate (self%waiting(room), self%is_waiting(room))
        self%is_waiting = .false.
    end subroutine start

    !> Takes the rows of a block (counted from 1) and writes what is complete. The rows handed in
    !> come back empty where they were accepted.
    subroutine hand_in(self, block, rows, table, accepted)
        class(row_queue_t), intent(inout) :: self
        integer(int64), intent(in) :: block
        type(text_buffer_t), intent(inout) :: rows
        type(table_file_t), intent(inout) :: table
        logical, intent(out) :: accepted
        integer :: place

        accepted = block - self%written <= size(self%waiting)
        if (.not. accepted) return
        place = place_of(self, block)
        call self%waiting(place)%swap(rows)
        self%is_waiting(place) = .true.
        do
            place = place_of(self, self%written + 1)
            if (.not. self%is_waiting(place)) exit
            if (.not. allocated(self%error)) call table%put_block(self%waiting(place), self%error)
            self%is_waiting(place) = .false.
            self%written = self%written + 1
        end do
    end subroutine hand_in

    pure integer function place_of(self, block)
        type(row_queue_t), intent(in) :: self
        integer(int64), intent(in) :: block
        place_of = int(mod(block - 1, size(self%waiting, kind=int64))) + 1
    end function place_of

end module spintop_row_queue
