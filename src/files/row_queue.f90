!> Blocks of rows that are computed in any order, written in the order of their cases.
!>
!>     call queue%start(room=8)
!>     call queue%hand_in(number, block, table, accepted)   ! by one thread at a time
!>
!> A thread whose block is not accepted is too far ahead: it waits and hands it in again.
module spintop_row_queue
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_growing_table, only: growing_table_t
    use spintop_row_block, only: row_block_t
    implicit none
    private
    public :: row_queue_t

    type :: row_queue_t
        !> The first error in writing; after it nothing more is written.
        type(error_t), allocatable :: error
        !> Blocks written so far: all up to this number.
        integer(int64), private :: written = 0
        !> Blocks that came early, in a ring.
        type(row_block_t), allocatable, private :: waiting(:)
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

    !> Takes a block (its number counts from 1) and writes what is complete. The block handed in
    !> comes back empty where it was accepted.
    subroutine hand_in(self, number, block, table, accepted)
        class(row_queue_t), intent(inout) :: self
        integer(int64), intent(in) :: number
        type(row_block_t), intent(inout) :: block
        type(growing_table_t), intent(inout) :: table
        logical, intent(out) :: accepted
        integer :: place

        accepted = number - self%written <= size(self%waiting)
        if (.not. accepted) return
        place = place_of(self, number)
        call self%waiting(place)%swap(block)
        self%is_waiting(place) = .true.
        do
            place = place_of(self, self%written + 1)
            if (.not. self%is_waiting(place)) exit
            if (.not. allocated(self%error)) call table%put(self%waiting(place), self%error)
            call self%waiting(place)%clear()
            self%is_waiting(place) = .false.
            self%written = self%written + 1
        end do
    end subroutine hand_in

    pure integer function place_of(self, number)
        type(row_queue_t), intent(in) :: self
        integer(int64), intent(in) :: number
        place_of = int(mod(number - 1, size(self%waiting, kind=int64))) + 1
    end function place_of

end module spintop_row_queue
