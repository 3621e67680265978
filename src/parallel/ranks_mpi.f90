#ifdef SPINTOP_MPI
!> Ranks by MPI. An error in MPI itself ends all ranks (its default), and so does the end of a rank that has
!> not called `end_ranks`.
submodule(spintop_ranks) ranks_mpi
    use mpi_f08, only: MPI_Allreduce, MPI_Bcast, MPI_Comm_rank, MPI_Comm_size, MPI_Finalize, MPI_Init_thread, &
        MPI_Iprobe, MPI_Recv, MPI_Reduce, MPI_Send, MPI_Status, MPI_ANY_SOURCE, MPI_CHARACTER, MPI_COMM_WORLD, &
        MPI_DOUBLE_PRECISION, MPI_IN_PLACE, MPI_INTEGER, MPI_INTEGER8, MPI_MIN, MPI_STATUS_IGNORE, MPI_SUM, &
        MPI_THREAD_SERIALIZED
    use spintop_errors, only: input_error
    implicit none

    integer, parameter :: writer = 0
    !> Kinds of message: the numbers before the rows of a block, the rows as text, the answer, what is gathered of the rows.
    integer, parameter :: tag_block = 1, tag_text = 2, tag_answer = 3, tag_statistics_cells = 4
    !> Numbers that are sent before the rows: number of the block, bytes of text, numbers for each row and rows of what is
    !> gathered, doubtful rows; then the number of rows with each status.
    integer, parameter :: numbers_before = 5

contains

    module procedure start_ranks
        integer :: level
        call MPI_Init_thread(MPI_THREAD_SERIALIZED, level)
        call MPI_Comm_rank(MPI_COMM_WORLD, ranks%number)
        call MPI_Comm_size(MPI_COMM_WORLD, ranks%count)
        if (level < MPI_THREAD_SERIALIZED) then
            error = input_error('spintop: the MPI library does not support MPI_THREAD_SERIALIZED')
        end if
    end procedure start_ranks

    module procedure end_ranks
        call MPI_Finalize()
    end procedure end_ranks

    module procedure agree
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
        call broadcast(message, first)
        error = error_t(code, message)
    end procedure agree

    module procedure broadcast_numbers
        if (self%count == 1) return
        call MPI_Bcast(numbers, size(numbers), MPI_INTEGER8, writer, MPI_COMM_WORLD)
    end procedure broadcast_numbers

    module procedure broadcast_text
        if (self%count > 1) call broadcast(text, writer)
    end procedure broadcast_text

    module procedure reduce
        real(dp) :: sums(size(values))
        call MPI_Reduce(values, sums, size(values), MPI_DOUBLE_PRECISION, MPI_SUM, writer, MPI_COMM_WORLD)
        if (self%is_writer()) values = sums
    end procedure reduce

    module procedure exchange
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
    end procedure exchange

    module procedure sign_off
        type(row_block_t) :: no_rows
        integer(int64) :: number
        number = signed_off
        call self%exchange(number, no_rows)
    end procedure sign_off

    module procedure receive
        type(MPI_Status) :: status
        integer(int64) :: numbers(numbers_before + size(rows%counts))
        character(:), allocatable :: text

        call rows%clear()
        number = 0
        rank = self%number
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
    end procedure receive

    module procedure answer
        call MPI_Send(number, 1, MPI_INTEGER8, rank, tag_answer, MPI_COMM_WORLD)
    end procedure answer

    !> Broadcasts a text of one rank to all.
    subroutine broadcast(text, from)
        character(:), allocatable, intent(inout) :: text
        integer, intent(in) :: from
        character(:), allocatable :: copy
        integer :: length

        length = len(text)
        call MPI_Bcast(length, 1, MPI_INTEGER, from, MPI_COMM_WORLD)
        allocate (character(length) :: copy)
        copy(:) = text
        call MPI_Bcast(copy, length, MPI_CHARACTER, from, MPI_COMM_WORLD)
        call move_alloc(copy, text)
    end subroutine broadcast

end submodule ranks_mpi
#endif
