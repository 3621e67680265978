!> A queue of blocks of rows, which are computed in any order and written in the order of their cases. It
!> assigns the numbers of the blocks, from 1, and keeps blocks that arrive early. A thread that finds a block
!> due writes it, while the others continue to compute.
!>
!>     call queue%start(room=8, blocks=100)     ! these by one thread at a time
!>     call queue%claim_next(number)            ! a block to compute, or retry_later, or none_left
!>     call queue%hand_in(number, block)
!>     call queue%begin_write(is_due)           ! whether a block is to be written by the caller
!>     call queue%write_next(table, error)      ! if so this, without holding up the others, and
!>     call queue%end_write(error)              ! this
module spintop_row_queue
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    implicit none
    private
    public :: row_queue_t, retry_later, none_left

    !> Returned instead of a number: the threads are too far ahead of the slowest block, or all blocks are
    !> assigned.
    integer(int64), parameter :: retry_later = 0, none_left = -1

    !> Blocks to compute, and blocks that wait for earlier ones to be written.
    type :: row_queue_t
        !> The first error of writing. After it nothing more is written, and no number is assigned.
        type(error_t), allocatable :: error
        !> Number of blocks; of those assigned so far, and of those written so far.
        integer(int64), private :: blocks = 0, taken = 0, written = 0
        !> Blocks that arrived early, in a ring.
        type(row_block_t), allocatable, private :: waiting(:)
        logical, allocatable, private :: is_waiting(:)
        !> Whether a thread is writing a block. Only one may do so, because of the order of the rows.
        logical, private :: in_write = .false.
    contains
        procedure :: start
        procedure :: claim_next
        procedure :: hand_in
        procedure :: begin_write
        procedure :: write_next
        procedure :: end_write
        procedure :: is_writing
    end type row_queue_t

contains

    !> Starts an empty queue for a number of blocks, with room for some that arrive early.
    subroutine start(self, room, blocks)
        class(row_queue_t), intent(inout) :: self
        integer, intent(in) :: room !! number of blocks that arrive early
        integer(int64), intent(in) :: blocks !! number of blocks
        self%blocks = blocks
        self%taken = 0
        self%written = 0
        allocate (self%waiting(room), self%is_waiting(room))
        self%is_waiting = .false.
    end subroutine start

    !> Assigns the next number. There is room for the rows of all assigned blocks.
    subroutine claim_next(self, number)
        class(row_queue_t), intent(inout) :: self
        integer(int64), intent(out) :: number !! number of a block, or `retry_later`, or `none_left`
        if (allocated(self%error) .or. self%taken == self%blocks) then
            number = none_left
        else if (self%taken - self%written == size(self%waiting)) then
            number = retry_later
        else
            self%taken = self%taken + 1
            number = self%taken
        end if
    end subroutine claim_next

    !> Accepts an assigned block that was computed, and returns an empty one.
    subroutine hand_in(self, number, block)
        class(row_queue_t), intent(inout) :: self
        integer(int64), intent(in) :: number !! number of the block
        type(row_block_t), intent(inout) :: block !! the computed block on entry; an empty one on return
        integer :: place
        place = place_of(self, number)
        call self%waiting(place)%swap(block)
        self%is_waiting(place) = .true.
    end subroutine hand_in

    !> Whether the next block has arrived and no thread is writing; then the caller must write it.
    subroutine begin_write(self, is_due)
        class(row_queue_t), intent(inout) :: self
        logical, intent(out) :: is_due !! whether the caller must write a block
        is_due = self%is_waiting(place_of(self, self%written + 1)) .and. .not. (self%in_write .or. allocated(self%error))
        if (is_due) self%in_write = .true.
    end subroutine begin_write

    !> Writes the next block. No other thread uses it; its place becomes free when the writing has ended.
    subroutine write_next(self, table, error)
        class(row_queue_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table !! the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: place
        place = place_of(self, self%written + 1)
        call table%append(self%waiting(place), error)
        call self%waiting(place)%clear()
    end subroutine write_next

    !> Ends the writing of a block, successful or not.
    subroutine end_write(self, error)
        class(row_queue_t), intent(inout) :: self
        type(error_t), allocatable, intent(inout) :: error !! that of `write_next`; moved into the queue
        self%written = self%written + 1
        self%is_waiting(place_of(self, self%written)) = .false.
        self%in_write = .false.
        if (.not. allocated(self%error)) call move_alloc(error, self%error)
    end subroutine end_write

    !> Whether a thread is writing a block.
    pure logical function is_writing(self)
        class(row_queue_t), intent(in) :: self
        is_writing = self%in_write
    end function is_writing

    !> Position of a block in the ring.
    pure integer function place_of(self, number)
        type(row_queue_t), intent(in) :: self
        integer(int64), intent(in) :: number
        place_of = int(mod(number - 1, size(self%waiting, kind=int64))) + 1
    end function place_of

end module spintop_row_queue
