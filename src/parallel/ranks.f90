!> The processes of a run, its ranks. There are several if an MPI launcher starts a program that was built for
!> MPI. Rank 0 is the writer: only it writes files and messages. It assigns the blocks of a sweep, which the
!> other ranks compute.
!>
!> The writer                                     The others, each of their threads
!>
!>     call ranks%receive(rank, number, rows, is_there)    call ranks%exchange(number, rows)
!>     call ranks%answer(rank, number)                     ...
!>     ...                                                 number = signed_off     ! once a rank
!>                                                         call ranks%exchange(number, rows)
!>
!> In a build without MPI there is one process only, and nothing to broadcast or receive. An error in MPI itself ends all
!> ranks (its default), and so does the end of a rank that has not called `end_ranks`.
module spintop_ranks
    use, intrinsic :: iso_fortran_env, only: int64
#ifdef SPINTOP_MPI
    use mpi_f08, only: MPI_Allreduce, MPI_Bcast, MPI_Comm_rank, MPI_Comm_size, MPI_Finalize, MPI_Init_thread, &
        MPI_Iprobe, MPI_Recv, MPI_Reduce, MPI_Send, MPI_Status, MPI_ANY_SOURCE, MPI_CHARACTER, MPI_COMM_WORLD, &
        MPI_DOUBLE_PRECISION, MPI_IN_PLACE, MPI_INTEGER, MPI_INTEGER8, MPI_MIN, MPI_STATUS_IGNORE, MPI_SUM, &
        MPI_THREAD_SERIALIZED
#endif
    use spintop_errors, only: error_t, input_error
    use spintop_kinds, only: dp
    use spintop_row_block, only: row_block_t
    implicit none
    private
    public :: ranks_t, start_ranks, end_ranks, signed_off

    !> Sent to the writer instead of the number of a block by a rank that has sent all its blocks.
    integer(int64), parameter :: signed_off = -2

    integer, parameter :: writer = 0
    !> Kinds of message: the numbers before the rows of a block, the rows as text, the answer, what is gathered of the rows.
    integer, parameter :: tag_block = 1, tag_text = 2, tag_answer = 3, tag_statistics_cells = 4
    !> Numbers that are sent before the rows: number of the block, bytes of text, numbers for each row and rows of what is
    !> gathered, doubtful rows; then the number of rows with each status.
    integer, parameter :: numbers_before = 5

    !> By default a single process.
    type :: ranks_t
        integer :: number = 0 !! of this one
        integer :: count = 1  !! of all
    contains
        procedure :: is_writer
        procedure :: agree
        procedure :: broadcast
        procedure :: reduce
        procedure :: exchange
        procedure :: receive
        procedure :: answer
    end type ranks_t

contains

    !> Joins the other ranks; must be the first action of a program. It is an error if the MPI library
    !> does not allow the threads of a rank to call it in turn.
    subroutine start_ranks(ranks, error)
        type(ranks_t), intent(out) :: ranks !! the ranks of this run
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
#ifdef SPINTOP_MPI
        integer :: level
        call MPI_Init_thread(MPI_THREAD_SERIALIZED, level)
        call MPI_Comm_rank(MPI_COMM_WORLD, ranks%number)
        call MPI_Comm_size(MPI_COMM_WORLD, ranks%count)
        if (level < MPI_THREAD_SERIALIZED) then
            error = input_error('spintop: the MPI library does not support MPI_THREAD_SERIALIZED')
        end if
#endif
    end subroutine start_ranks

    !> Leaves the other ranks, after all have called this.
    subroutine end_ranks()
#ifdef SPINTOP_MPI
        call MPI_Finalize()
#endif
    end subroutine end_ranks

    !> Whether this is the rank that writes files and messages.
    pure logical function is_writer(self)
        class(ranks_t), intent(in) :: self
        is_writer = self%number == writer
    end function is_writer

    !> Broadcasts the error of the first rank that has one. All ranks call it.
    subroutine agree(self, error)
        class(ranks_t), intent(in) :: self
        type(error_t), allocatable, intent(inout) :: error
            !! of this rank on entry; of the first rank that has one on return
#ifdef SPINTOP_MPI
        integer :: first, code
        character(:), allocatable :: message

        if (self%count == 1) return
        first = self%count
        if (allocated(error)) first = self%number
        call MPI_Allreduce(MPI_IN_PLACE, first, 1, MPI_INTEGER, MPI_MIN, MPI_COMM_WORLD)
        if (first == self%count) return
        message = ''
        if (first == self%number) then
            message = error%message
            code = error%code
        end if
        call MPI_Bcast(code, 1, MPI_INTEGER, first, MPI_COMM_WORLD)
        call self%broadcast(message, first)
        error = error_t(code, message)
#endif
    end subroutine agree

    !> Broadcasts the text of the writer, or of another rank, to all. All ranks call it.
    subroutine broadcast(self, text, from)
        class(ranks_t), intent(in) :: self
        character(:), allocatable, intent(inout) :: text !! that of this rank on entry
        integer, intent(in), optional :: from !! number of the other rank
#ifdef SPINTOP_MPI
        character(:), allocatable :: copy
        integer :: length, rank

        if (self%count == 1) return
        rank = writer
        if (present(from)) rank = from
        length = len(text)
        call MPI_Bcast(length, 1, MPI_INTEGER, rank, MPI_COMM_WORLD)
        allocate (character(length) :: copy)
        copy(:) = text
        call MPI_Bcast(copy, length, MPI_CHARACTER, rank, MPI_COMM_WORLD)
        call move_alloc(copy, text)
#endif
    end subroutine broadcast

    !> Sums values over all ranks: the writer gets the sums, the others keep their values. All ranks call it.
    subroutine reduce(self, values)
        class(ranks_t), intent(in) :: self
        real(dp), intent(inout) :: values(:) !! of this rank on entry; the sums in the writer on return
#ifdef SPINTOP_MPI
        real(dp) :: sums(size(values))
        call MPI_Reduce(values, sums, size(values), MPI_DOUBLE_PRECISION, MPI_SUM, writer, MPI_COMM_WORLD)
        if (self%is_writer()) values = sums
#endif
    end subroutine reduce

    !> Sends the rows of a block to the writer (`number` > 0), and receives the number of the next block.
    !> Threads may call it at any time; the calls are serialised.
    subroutine exchange(self, number, rows)
        class(ranks_t), intent(in) :: self
        integer(int64), intent(inout) :: number !! computed block on entry (0 for none), next block on return
        type(row_block_t), intent(in) :: rows !! the rows of the computed block
#ifdef SPINTOP_MPI
        integer(int64) :: numbers(numbers_before + size(rows%counts))
        integer :: length

        length = 0
        if (allocated(rows%statistics_cells)) length = size(rows%statistics_cells, 2)
        numbers = 0
        numbers(1) = number
        if (number > 0) numbers(2:) = [int([rows%text%length, length, rows%statistics_rows], int64), rows%doubtful, rows%counts]
        !$omp critical (ranks)
        call MPI_Send(numbers, size(numbers), MPI_INTEGER8, writer, tag_block, MPI_COMM_WORLD)
        if (number > 0) then
            ! A table that keeps no rows has no text.
            if (rows%text%length > 0) then
                call MPI_Send(rows%text%room, rows%text%length, MPI_CHARACTER, writer, tag_text, MPI_COMM_WORLD)
            end if
            if (rows%statistics_rows > 0) then
                call MPI_Send(rows%statistics_cells, length * rows%statistics_rows, MPI_DOUBLE_PRECISION, writer, &
                              tag_statistics_cells, MPI_COMM_WORLD)
            end if
        end if
        if (number /= signed_off) then
            call MPI_Recv(number, 1, MPI_INTEGER8, writer, tag_answer, MPI_COMM_WORLD, MPI_STATUS_IGNORE)
        end if
        !$omp end critical (ranks)
#endif
    end subroutine exchange

    !> Receives a message of another rank, if there is one: the number of a block and its rows, or no
    !> block (`number` <= 0), or `signed_off`. All senders but the last kind wait for an answer.
    subroutine receive(self, rank, number, rows, is_there)
        class(ranks_t), intent(in) :: self
        integer, intent(out) :: rank !! number of the rank
        integer(int64), intent(out) :: number !! number of the block, or `signed_off`
        type(row_block_t), intent(inout) :: rows !! the rows of the block
        logical, intent(out) :: is_there !! whether there is a message
#ifdef SPINTOP_MPI
        type(MPI_Status) :: status
        integer(int64) :: numbers(numbers_before + size(rows%counts))
        character(:), allocatable :: text
#endif

        call rows%clear()
        number = 0
        rank = self%number
        is_there = .false.
#ifdef SPINTOP_MPI
        call MPI_Iprobe(MPI_ANY_SOURCE, tag_block, MPI_COMM_WORLD, is_there, status)
        if (.not. is_there) return
        rank = status%MPI_SOURCE
        call MPI_Recv(numbers, size(numbers), MPI_INTEGER8, rank, tag_block, MPI_COMM_WORLD, MPI_STATUS_IGNORE)
        number = numbers(1)
        if (number <= 0) return
        if (numbers(2) > 0) then
            allocate (character(numbers(2)) :: text)
            call MPI_Recv(text, len(text), MPI_CHARACTER, rank, tag_text, MPI_COMM_WORLD, MPI_STATUS_IGNORE)
            call rows%text%append(text)
        end if
        if (numbers(4) > 0) then
            call rows%reserve_statistics_cells(int(numbers(3)), int(numbers(4)))
            call MPI_Recv(rows%statistics_cells, int(product(numbers(3:4))), MPI_DOUBLE_PRECISION, rank, tag_statistics_cells, &
                          MPI_COMM_WORLD, MPI_STATUS_IGNORE)
        end if
        rows%doubtful = numbers(numbers_before)
        rows%counts = numbers(numbers_before + 1:)
#endif
    end subroutine receive

    !> Answers a waiting rank.
    subroutine answer(self, rank, number)
        class(ranks_t), intent(in) :: self
        integer, intent(in) :: rank !! number of the rank
        integer(int64), intent(in) :: number !! number of the next block
#ifdef SPINTOP_MPI
        call MPI_Send(number, 1, MPI_INTEGER8, rank, tag_answer, MPI_COMM_WORLD)
#endif
    end subroutine answer

end module spintop_ranks
