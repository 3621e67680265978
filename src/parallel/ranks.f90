!> The processes that a run consists of, its ranks. There are several where an MPI launcher starts a
!> program that was built for MPI. Rank 0 is the writer: it alone writes files and messages,
!> and it hands out the blocks of a sweep, which the others compute.
!>
!> The writer                                     The others, each of their threads
!>
!>     call ranks%receive(rank, number, rows, is_there)    call ranks%exchange(number, rows)
!>     call ranks%answer(rank, number)                     ...
!>     ...                                                 call ranks%sign_off()     ! once a rank
!>
!> What MPI does is in the submodule `ranks_mpi`; in a build without it `ranks_alone` is in its place.
module spintop_ranks
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_row_block, only: row_block_t
    implicit none
    private
    public :: ranks_t, start_ranks, end_ranks, signed_off

    !> What the writer receives in place of the number of a block from a rank that has signed off.
    integer(int64), parameter :: signed_off = -2

    !> By default a process that is alone.
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

        !> Joins the other ranks; the first thing a program does. It is an error where the threads of
        !> a rank may not take turns in calling MPI.
        module subroutine start_ranks(ranks, error)
            type(ranks_t), intent(out) :: ranks
            type(error_t), allocatable, intent(out) :: error
        end subroutine start_ranks

        !> Leaves the other ranks, when all have come here.
        module subroutine end_ranks()
        end subroutine end_ranks

        !> Broadcasts the error of the first rank that has one. All ranks call it.
        module subroutine agree(self, error)
            class(ranks_t), intent(in) :: self
            type(error_t), allocatable, intent(inout) :: error
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

        !> Gives the writer the sums over all ranks, and leaves the others what they have. All ranks
        !> call it.
        module subroutine reduce(self, values)
            class(ranks_t), intent(in) :: self
            real(dp), intent(inout) :: values(:)
        end subroutine reduce

        !> Hands the rows of a block to the writer (`number` > 0), and takes what it answers. Threads
        !> may call it at any time: they take turns.
        module subroutine exchange(self, number, rows)
            class(ranks_t), intent(in) :: self
            integer(int64), intent(inout) :: number
            type(row_block_t), intent(in) :: rows
        end subroutine exchange

        !> Signs this rank off: it has handed in all its blocks.
        module subroutine sign_off(self)
            class(ranks_t), intent(in) :: self
        end subroutine sign_off

        !> Takes what another rank has handed in, if there is such a rank: the number of a block and
        !> its rows, or none (`number` <= 0), or that it has `signed_off`. All but this wait for an answer.
        module subroutine receive(self, rank, number, rows, is_there)
            class(ranks_t), intent(in) :: self
            integer, intent(out) :: rank
            integer(int64), intent(out) :: number
            type(row_block_t), intent(inout) :: rows
            logical, intent(out) :: is_there
        end subroutine receive

        !> Answers a rank that waits.
        module subroutine answer(self, rank, number)
            class(ranks_t), intent(in) :: self
            integer, intent(in) :: rank
            integer(int64), intent(in) :: number
        end subroutine answer

    end interface

contains

    !> Whether this is the rank that writes files and messages.
    pure logical function is_writer(self)
        class(ranks_t), intent(in) :: self
        is_writer = self%number == 0
    end function is_writer

end module spintop_ranks
