!> The threads and ranks that compute the rows of many cases. Each thread takes a block of cases, computes it and
!> hands in its rows, until no block is left; the rows are written in the order of the cases. Threads know nothing
!> of each other; the other ranks exchange their blocks with a thread of the writer (see `spintop_ranks`). One more
!> thread of the writer, mostly asleep, sees that written rows are kept by the journal in time, even while all others
!> compute for long, and ends the process after a signal when they are.
!>
!> Texts are made by one thread at a time (see `status_names`): in the critical sections `queue`, which workers may use, too.
!>
!>     call team%assemble(ranks, cases, 512)       ! in all ranks
!>     call team%compute(workers, table)           ! in all ranks; in the writer the table is then written
module spintop_thread_team
    use, intrinsic :: iso_c_binding, only: c_bool
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: current, refuse_if_stopped
    use spintop_process, only: pause_for, processor_seconds, seconds, end_by_signal, end_is_wanted, peak_memory, &
        set_journal_thread
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_progress, only: progress_t
    use spintop_ranks, only: ranks_t, signed_off
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_journaled_table, only: journal_entry_t
    use spintop_text, only: to_text
    !$ use omp_lib, only: omp_get_max_threads, omp_get_num_threads, omp_get_thread_num
    implicit none
    private
    public :: team_t, block_worker_t, blocks_ahead
    public :: work_of_making, work_of_computing, work_of_formatting, work_of_writing, memory_in_use
    public :: row_queue_t, retry_later, none_left

    !> Number of blocks per thread that a fast thread may be ahead of a slow one, or of a writing one; and the
    !> time it waits then, s.
    integer, parameter :: blocks_ahead = 16
    real(dp), parameter :: pause_when_ahead = 2.0e-4_dp

    !> Time that the writer waits if there is no message of another rank, s.
    real(dp), parameter :: pause_of_writer = 5.0e-5_dp

    !> Time between two looks of the journal thread, s.
    real(dp), parameter :: pause_of_journal_thread = 2.0e-3_dp

    !> What is done with a case, of which a worker counts the costs; the team also counts those of writing, and the memory.
    integer, parameter :: work_of_making = 1, work_of_computing = 2, work_of_formatting = 3, work_of_writing = 4, &
        memory_in_use = 5

    !> Computes blocks of cases in a thread.
    type, abstract :: block_worker_t
        !> Time of the processor, s.
        real(dp) :: costs(work_of_formatting) = 0
    contains
        procedure(compute_rows), deferred :: compute_rows
    end type block_worker_t

    abstract interface
        !> Computes the rows of some cases.
        subroutine compute_rows(self, first, last, rows)
            import :: block_worker_t, int64, row_block_t
            class(block_worker_t), target, intent(inout) :: self
            integer(int64), intent(in) :: first, last !! first and last case
            type(row_block_t), intent(inout) :: rows !! their rows
        end subroutine compute_rows
    end interface

    !> Returned instead of a number: the threads are too far ahead of the slowest block, or all blocks are
    !> assigned.
    integer(int64), parameter :: retry_later = 0, none_left = -1

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
    type :: row_queue_t
        !> The first error of writing. After it nothing more is written, and no number is assigned.
        type(error_t), allocatable :: error
        !> Number of blocks; of those assigned so far, and of those written so far.
        integer(int64), private :: blocks = 0, taken = 0, written = 0
        !> Blocks that arrived early, in a ring.
        type(row_block_t), allocatable, private :: waiting(:)
        logical, allocatable, private :: is_waiting(:)
        !> Whether a thread is writing a block. Only one may do so, because of the order of the rows.
        logical :: in_write = .false.
    contains
        procedure :: start
        procedure :: claim_next
        procedure :: hand_in
        procedure :: begin_write
        procedure :: write_next
        procedure :: end_write
    end type row_queue_t

    !> Those who compute cases, and what they share.
    type :: team_t
        type(ranks_t) :: ranks
        !> First and last case to compute.
        integer(int64), private :: cases(2) = [1, 0]
        integer, private :: cases_of_block = 1
        !> Threads of this rank that compute, those of all ranks (known to the writer), and those that serve
        !> other ranks.
        integer :: threads = 1, all_threads = 1
        integer, private :: servers = 0
        !> Threads of this rank that still compute or serve.
        integer, private :: active = 0
        !> Blocks to compute, and rows that wait to be written.
        type(row_queue_t) :: queue
        type(progress_t) :: progress
        !> Time of all threads, s; and the peak memory of all ranks, bytes.
        real(dp) :: costs(memory_in_use) = 0
    contains
        procedure :: assemble
        procedure :: compute
        procedure :: in_words
    end type team_t

contains

    !> Makes up the team for the cases from the first to the last; all ranks call it.
    subroutine assemble(self, ranks, cases, cases_of_block)
        class(team_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks !! the ranks of this run
        integer(int64), intent(in) :: cases(2) !! first and last case
        integer, intent(in) :: cases_of_block !! number of cases in a block
        real(dp) :: sum(1)

        self%ranks = ranks
        self%cases = cases
        self%cases_of_block = cases_of_block
        !$ self%threads = omp_get_max_threads()
        sum = self%threads
        call ranks%reduce(sum)
        self%all_threads = nint(sum(1))
        if (.not. ranks%is_writer()) return
        if (ranks%count > 1) self%servers = 1
        call self%queue%start(blocks_ahead * self%all_threads, (cases(2) - cases(1)) / cases_of_block + 1)
    end subroutine assemble

    !> Computes the cases; all ranks call it. In the writer their rows are then appended to the table, or `queue%error` tells
    !> why not, and the costs are those of all ranks.
    subroutine compute(self, workers, table)
        class(team_t), intent(inout) :: self
        class(block_worker_t), target, intent(inout) :: workers(:) !! one for each of `threads`, ready to compute
        class(row_table_t), intent(inout) :: table !! the table
        type(row_block_t) :: no_rows
        integer(int64) :: number
        integer :: journal_threads, threads, me

        journal_threads = merge(1, 0, self%ranks%is_writer() .and. table%is_resumable)
        !$omp parallel num_threads(self%threads + self%servers + journal_threads) copyin(current) private(me)
        me = 0
        !$ me = omp_get_thread_num()
        !$omp single
        self%active = self%threads + self%servers
        threads = 1
        !$ threads = omp_get_num_threads()
        ! Other ranks give the writer time.
        call set_journal_thread(logical(threads > self%active .or. .not. self%ranks%is_writer(), c_bool))
        !$omp end single
        if (me < self%servers) then
            call serve_others(self, table)
        else if (me < self%threads + self%servers) then
            call compute_share(self, workers(me - self%servers + 1), table)
        else
            call run_journal_thread(self, table)
        end if
        !$omp end parallel
        call set_journal_thread(.false._c_bool)
        if (end_is_wanted()) call end_on_signal(self, table)
        if (.not. self%ranks%is_writer()) then
            number = signed_off
            call self%ranks%exchange(number, no_rows)
        end if
        self%costs(memory_in_use) = real(peak_memory(), dp)
        call self%ranks%reduce(self%costs)
    end subroutine compute

    !> The loop of each computing thread: take the next block, compute it and pass it to the queue, until none
    !> is left.
    subroutine compute_share(self, worker, table)
        class(team_t), intent(inout) :: self
        class(block_worker_t), target, intent(inout) :: worker
        class(row_table_t), intent(inout) :: table
        type(row_block_t) :: rows
        integer(int64) :: number, first
        real(dp) :: moment

        number = retry_later
        do
            if (self%ranks%is_writer()) then
                call exchange_block(self, table, number, rows)
            else
                call self%ranks%exchange(number, rows)
            end if
            if (number == none_left) exit
            if (number == retry_later) then
                call pause_for(pause_when_ahead)
                cycle
            end if
            first = self%cases(1) + (number - 1) * self%cases_of_block
            call worker%compute_rows(first, min(first + self%cases_of_block - 1, self%cases(2)), rows)
            moment = processor_seconds()
            call table%format(rows)
            worker%costs(work_of_formatting) = worker%costs(work_of_formatting) + (processor_seconds() - moment)
        end do
        !$omp critical (queue)
        self%active = self%active - 1
        self%costs(:work_of_formatting) = self%costs(:work_of_formatting) + worker%costs
        !$omp end critical (queue)
    end subroutine compute_share

    !> The loop of a thread of the writer for the other ranks: exchanges blocks for them, until all have
    !> signed off.
    subroutine serve_others(self, table)
        class(team_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table
        type(row_block_t) :: rows
        integer(int64) :: number
        integer :: rank, left
        logical :: is_there

        left = self%ranks%count - 1
        do while (left > 0)
            call self%ranks%receive(rank, number, rows, is_there)
            if (.not. is_there) then
                call pause_for(pause_of_writer)
            else if (number == signed_off) then
                left = left - 1
            else
                call exchange_block(self, table, number, rows)
                call self%ranks%answer(rank, number)
            end if
        end do
        !$omp critical (queue)
        self%active = self%active - 1
        !$omp end critical (queue)
    end subroutine serve_others

    !> The loop of the journal thread, while others compute: an entry of the journal when it is due, and the end of the process
    !> after a signal.
    subroutine run_journal_thread(self, table)
        class(team_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table
        logical :: is_over

        do
            call pause_for(pause_of_journal_thread)
            !$omp critical (queue)
            is_over = self%active == 0
            !$omp end critical (queue)
            if (is_over) exit
            if (end_is_wanted()) call end_on_signal(self, table)
            call keep_entry_if_due(self, table)
        end do
    end subroutine run_journal_thread

    !> Keeps the written rows, if that is due and nobody is writing.
    subroutine keep_entry_if_due(self, table)
        class(team_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table
        type(journal_entry_t) :: entry
        logical :: has_entry

        !$omp critical (queue)
        has_entry = .false.
        if (.not. self%queue%in_write) call table%make_entry_if_due(entry, has_entry, self%queue%error)
        !$omp end critical (queue)
        if (has_entry) call keep(self, table, entry)
    end subroutine keep_entry_if_due

    !> Brings an entry to the disk, while others may write.
    subroutine keep(self, table, entry)
        class(team_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table
        type(journal_entry_t), intent(in) :: entry
        type(error_t), allocatable :: problem
        call table%keep_entry(entry, problem)
        !$omp critical (queue)
        call table%end_entry()
        if (.not. allocated(self%queue%error)) call move_alloc(problem, self%queue%error)
        !$omp end critical (queue)
    end subroutine keep

    !> Writes the blocks that are due, keeps all written rows, and ends the process by the signal that it got. Other
    !> threads compute meanwhile; what they have not handed in is lost.
    subroutine end_on_signal(self, table)
        class(team_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table
        logical :: is_busy

        if (self%ranks%is_writer() .and. table%is_resumable) then
            do
                call write_due(self, table)
                !$omp critical (queue)
                table%entry_wanted = .true.
                is_busy = self%queue%in_write .or. table%in_entry
                !$omp end critical (queue)
                call keep_entry_if_due(self, table)
                if (.not. is_busy) exit
                call pause_for(pause_of_journal_thread)
            end do
        end if
        call end_by_signal()
    end subroutine end_on_signal

    !> Passes a block to the queue (`number` > 0), writes blocks that are due, and takes the number of another
    !> block.
    subroutine exchange_block(self, table, number, rows)
        class(team_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table
        integer(int64), intent(inout) :: number
        type(row_block_t), intent(inout) :: rows

        !$omp critical (queue)
        call refuse_if_stopped(self%queue%error)
        if (number > 0) call self%queue%hand_in(number, rows)
        !$omp end critical (queue)
        call write_due(self, table)
        !$omp critical (queue)
        call self%queue%claim_next(number)
        !$omp end critical (queue)
    end subroutine exchange_block

    !> Writes the blocks that are due, and the journal if it is due. Other threads wait only for the bookkeeping.
    subroutine write_due(self, table)
        class(team_t), intent(inout) :: self
        class(row_table_t), intent(inout) :: table
        type(journal_entry_t) :: entry
        type(error_t), allocatable :: problem
        real(dp) :: moment
        logical :: is_due, has_entry

        do
            !$omp critical (queue)
            call self%queue%begin_write(is_due)
            !$omp end critical (queue)
            if (.not. is_due) exit
            moment = seconds()
            call self%queue%write_next(table, problem)
            !$omp critical (queue)
            call self%queue%end_write(problem)
            call self%progress%update(table%rows())
            call table%make_entry_if_due(entry, has_entry, self%queue%error)
            !$omp end critical (queue)
            if (has_entry) call keep(self, table, entry)
            !$omp atomic
            self%costs(work_of_writing) = self%costs(work_of_writing) + (seconds() - moment)
        end do
    end subroutine write_due

    !> The team for a reader, where it is the writer's: `2 threads`, `4 ranks x 2 threads`, or `2 ranks, 24 threads` where they
    !> differ.
    function in_words(self) result(text)
        class(team_t), intent(in) :: self
        character(:), allocatable :: text
        associate (ranks => self%ranks%count)
            if (ranks == 1) then
                text = to_text(self%threads) // ' threads'
            else if (ranks * self%threads == self%all_threads) then
                text = to_text(ranks) // ' ranks x ' // to_text(self%threads) // ' threads'
            else
                text = to_text(ranks) // ' ranks, ' // to_text(self%all_threads) // ' threads'
            end if
        end associate
    end function in_words

    !> Starts an empty queue for a number of blocks, with room for some that arrive early.
    subroutine start(self, room, blocks)
        class(row_queue_t), intent(inout) :: self
        integer, intent(in) :: room !! number of blocks that arrive early
        integer(int64), intent(in) :: blocks !! number of blocks
        self%blocks = blocks
        allocate (self%waiting(room))
        allocate (self%is_waiting(room), source=.false.)
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

    !> Position of a block in the ring.
    pure integer function place_of(self, number)
        type(row_queue_t), intent(in) :: self
        integer(int64), intent(in) :: number
        place_of = int(mod(number - 1, size(self%waiting, kind=int64))) + 1
    end function place_of

end module spintop_thread_team
