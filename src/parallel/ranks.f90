!> The processes of a run, its ranks. There are several if an MPI launcher starts a program that was built for
!> MPI. Rank 0 is the writer: only it writes files and messages. It assigns the blocks of a sweep, which the
!> other ranks compute.
!>
!> The writer                                     The others, each of their threads
!>
!>     call ranks%receive(rank, number, rows, is_there)    call ranks%exchange(number, rows)
!>     call ranks%answer(rank, number)                     ...
!>     ...                                                 call ranks%sign_off()     ! once a rank
!>
!> The MPI calls are in the submodule `ranks_mpi`; a build without MPI has `ranks_alone` instead.
module spintop_ranks
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_row_block, only: row_block_t
    implicit none
    private
    public :: ranks_t, start_ranks, end_ranks, signed_off

    !> Received by the writer instead of the number of a block from a rank that has signed off.
    integer(int64), parameter :: signed_off = -2

    !> By default a single process.
    type :: ranks_t
        integer :: number = 0 !! of this one
        integer :: count = 1  !! of all
    contains
        procedure :: is_writer
        procedure :: agree
        generic :: broadcast => broadcast_numbers, broadcast_text
        procedure :: reduce
        procedure :: exchange
        procedure :: sign_off
        procedure :: receive
        procedure :: answer
        procedure, private :: broadcast_numbers
        procedure, private :: broadcast_text
    end type ranks_t

    interface

        !> Joins the other ranks; must be the first action of a program. It is an error if the MPI library
        !> does not allow the threads of a rank to call it in turn.
        module subroutine start_ranks(ranks, error)
            type(ranks_t), intent(out) :: ranks !! the ranks of this run
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine start_ranks

        !> Leaves the other ranks, after all have called this.
        module subroutine end_ranks()
        end subroutine end_ranks

        !> Broadcasts the error of the first rank that has one. All ranks call it.
        module subroutine agree(self, error)
            class(ranks_t), intent(in) :: self
            type(error_t), allocatable, intent(inout) :: error
                !! of this rank on entry; of the first rank that has one on return
        end subroutine agree

        !> Broadcasts the numbers of the writer to all ranks. All ranks call it.
        module subroutine broadcast_numbers(self, numbers)
            class(ranks_t), intent(in) :: self
            integer(int64), intent(inout) :: numbers(:)
        end subroutine broadcast_numbers

        !> Broadcasts the text of the writer to all ranks. All ranks call it.
        module subroutine broadcast_text(self, text)
            class(ranks_t), intent(in) :: self
            character(:), allocatable, intent(inout) :: text
        end subroutine broadcast_text

        !> Sums values over all ranks: the writer gets the sums, the others keep their values. All ranks call
        !> it.
        module subroutine reduce(self, values)
            class(ranks_t), intent(in) :: self
            real(dp), intent(inout) :: values(:) !! of this rank on entry; the sums in the writer on return
        end subroutine reduce

        !> Sends the rows of a block to the writer (`number` > 0), and receives the number of the next block.
        !> Threads may call it at any time; the calls are serialised.
        module subroutine exchange(self, number, rows)
            class(ranks_t), intent(in) :: self
            integer(int64), intent(inout) :: number !! computed block on entry (0 for none), next block on return
            type(row_block_t), intent(in) :: rows !! the rows of the computed block
        end subroutine exchange

        !> Signs this rank off, after it has sent all its blocks.
        module subroutine sign_off(self)
            class(ranks_t), intent(in) :: self
        end subroutine sign_off

        !> Receives a message of another rank, if there is one: the number of a block and its rows, or no
        !> block (`number` <= 0), or `signed_off`. All senders but the last kind wait for an answer.
        module subroutine receive(self, rank, number, rows, is_there)
            class(ranks_t), intent(in) :: self
            integer, intent(out) :: rank !! number of the rank
            integer(int64), intent(out) :: number !! number of the block, or `signed_off`
            type(row_block_t), intent(inout) :: rows !! the rows of the block
            logical, intent(out) :: is_there !! whether there is a message
        end subroutine receive

        !> Answers a waiting rank.
        module subroutine answer(self, rank, number)
            class(ranks_t), intent(in) :: self
            integer, intent(in) :: rank !! number of the rank
            integer(int64), intent(in) :: number !! number of the next block
        end subroutine answer

    end interface

contains

    !> Whether this is the rank that writes files and messages.
    pure logical function is_writer(self)
        class(ranks_t), intent(in) :: self
        is_writer = self%number == 0
    end function is_writer

end module spintop_ranks
