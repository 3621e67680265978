!> The sweep study: a case for each combination of the axes, one row each, on all cores. Blocks of
!> cases are computed in any order, by threads that know nothing of each other, in one process or in
!> many (see `spintop_ranks`); a queue has their rows written in the order of the cases.
module spintop_sweep
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: pause_for, seconds, utc_now
    use spintop_files, only: replace_file
    use spintop_kinds, only: dp
    use spintop_errors, only: error_t, input_error
    use spintop_job, only: job_t, options_t, shell_word
    use spintop_journal, only: journal_entry_t
    use spintop_process, only: watch_no_more, watch_signals, host_name, peak_memory
    use spintop_progress, only: progress_t
    use spintop_ranks, only: ranks_t, signed_off
    use spintop_row_block, only: row_block_t
    use spintop_row_queue, only: retry_later, none_left, row_queue_t
    use spintop_row_table, only: row_table_t
    use spintop_shard, only: shard_t
    use spintop_status, only: status_ok, status_name, status_meaning, last_status
    use spintop_summary, only: summary_t, rounded
    use spintop_sweep_table, only: describe_table, start_table
    use spintop_sweep_worker, only: sweep_worker_t, size_of_block
    use spintop_table_head, only: compare_heads
    use spintop_text, only: join, to_text
    !$ use omp_lib, only: omp_get_max_threads, omp_get_thread_num
    implicit none
    private
    public :: run_sweep

    !> Blocks a thread that a fast thread may be ahead of a slow one, or of one that writes, and how long
    !> it waits then, s.
    integer, parameter :: blocks_ahead = 16
    real(dp), parameter :: pause_when_ahead = 2.0e-4_dp

    !> How long the writer waits where no other rank has anything for it, s.
    real(dp), parameter :: pause_of_writer = 5.0e-5_dp

    !> First and last case where there are none.
    integer(int64), parameter :: no_cases(2) = [1, 0]

    !> Seconds spent by all threads together on making, computing, formatting and writing cases, and
    !> the largest memory of all ranks together in bytes.
    type :: costs_t
        real(dp) :: making = 0, computing = 0, formatting = 0, writing = 0, memory = 0
    end type costs_t

contains

    !> Computes all cases, or those of one part, and writes the table; `counts` are the cases of each
    !> status. After an error the part of the table that is complete stays, where a later run can
    !> resume it. Only the writer among the ranks has a summary and counts.
    subroutine run_sweep(job, options, summary, counts, error)
        type(job_t), intent(inout) :: job
        type(options_t), intent(in) :: options
        type(summary_t), intent(out) :: summary
        integer(int64), intent(out) :: counts(0:last_status)
        type(error_t), allocatable, intent(out) :: error
        class(row_table_t), allocatable :: table
        type(progress_t) :: progress
        type(ranks_t) :: ranks
        type(row_queue_t) :: queue
        type(costs_t) :: costs
        character(:), allocatable :: head
        integer(int64) :: span(2)
        real(dp) :: began, moment, team(1)
        integer :: threads, servers

        counts = 0
        call describe_table(job, options%shard, table, head)
        call compare_with_writer(options%ranks, head, error)
        if (allocated(error)) return
        if (options%ranks%is_writer()) then
            call start_table(job, options%resume, options%restart, head, table, error)
            span = [options%shard%first(job%axes%cases) + table%rows(), options%shard%last(job%axes%cases)]
            if (allocated(error) .or. table%is_complete) span = no_cases
        end if
        call options%ranks%broadcast(span)
        ! The others take part where there is something to compute.
        ranks = options%ranks
        if (span(1) > span(2)) then
            if (.not. ranks%is_writer()) return
            ranks = ranks_t()
        end if
        if (allocated(error)) return
        if (table%is_complete) then
            call summary%headline(job%input // ': sweep -> ' // job%output)
            call summary%add('note', table%remark)
            return
        end if

        threads = 1
        !$ threads = omp_get_max_threads()
        team = threads
        call ranks%reduce(team)
        began = seconds()
        servers = 0
        if (ranks%is_writer()) then
            call progress%start(job%name, 'cases', table%rows() + span(2) - span(1) + 1, options%quiet, &
                                options%progress, before=table%rows())
            if (table%remark /= '') call progress%note(table%remark)
            call announce_signals(job, options, table, table%rows() + span(2) - span(1) + 1)
            call queue%start(blocks_ahead * nint(team(1)), (span(2) - span(1)) / size_of_block(job) + 1)
            if (ranks%count > 1) servers = 1
        end if
        !$omp parallel num_threads(threads + servers)
        if (this_thread() < servers) then
            call serve_others()
        else
            call compute_share()
        end if
        !$omp end parallel
        if (.not. ranks%is_writer()) call ranks%sign_off()
        call reduce_costs()
        if (.not. ranks%is_writer()) return
        call progress%finish()
        moment = seconds()
        call move_alloc(queue%error, error)
        if (.not. allocated(error)) call table%finish(error)
        call watch_no_more()
        if (allocated(error)) then
            call table%abandon(error)
            return
        end if
        costs%writing = costs%writing + (seconds() - moment)
        counts = table%counts
        call describe_sweep(job, options%shard, table, team_text(ranks%count, threads, nint(team(1))), &
                            seconds() - began, costs, summary)
        ! The table itself holds nothing that varies from run to run.
        call replace_file(job%log, join(summary%lines, new_line('a')) // new_line('a'), error)

    contains

        !> What each thread that computes does: takes the next block, computes it and hands it in, until
        !> none is left.
        subroutine compute_share()
            type(sweep_worker_t), allocatable, target :: worker
            type(row_block_t) :: rows
            integer(int64) :: number, start
            integer :: cases_of_block
            real(dp) :: moment, formatting

            cases_of_block = size_of_block(job)
            allocate (worker)
            ! One thread at a time: gfortran keeps the length of a function's text in static memory where the
            ! function is called (seen in 12 and 14), and this makes many texts.
            !$omp critical (texts)
            call worker%prepare(job)
            !$omp end critical (texts)
            formatting = 0
            number = retry_later
            do
                if (ranks%is_writer()) then
                    call exchange(number, rows)
                else
                    call ranks%exchange(number, rows)
                end if
                if (number == none_left) exit
                if (number == retry_later) then
                    call pause_for(pause_when_ahead)
                    cycle
                end if
                start = span(1) + (number - 1) * cases_of_block
                call worker%compute_rows(job, start, min(start + cases_of_block - 1, span(2)), rows)
                moment = seconds()
                call table%format(rows)
                formatting = formatting + (seconds() - moment)
            end do
            !$omp critical (queue)
            costs%making = costs%making + worker%making
            costs%computing = costs%computing + worker%computing
            costs%formatting = costs%formatting + worker%filling + formatting
            !$omp end critical (queue)
        end subroutine compute_share

        !> What a thread of the writer does for the other ranks: exchanges in their name, until all have
        !> signed off.
        subroutine serve_others()
            type(row_block_t) :: rows
            integer(int64) :: number
            integer :: rank, left
            logical :: is_there

            left = ranks%count - 1
            do while (left > 0)
                call ranks%receive(rank, number, rows, is_there)
                if (.not. is_there) then
                    call pause_for(pause_of_writer)
                else if (number == signed_off) then
                    left = left - 1
                else
                    call exchange(number, rows)
                    call ranks%answer(rank, number)
                end if
            end do
        end subroutine serve_others

        !> Hands in a block (`number` > 0), writes what is due, and takes the number of another.
        subroutine exchange(number, rows)
            integer(int64), intent(inout) :: number
            type(row_block_t), intent(inout) :: rows
            logical :: is_due

            !$omp critical (queue)
            if (number > 0) call queue%hand_in(number, rows)
            call queue%begin_write(is_due)
            !$omp end critical (queue)
            do while (is_due)
                call write_next(is_due)
            end do
            !$omp critical (queue)
            call queue%take(number)
            !$omp end critical (queue)
        end subroutine exchange

        !> Writes the next block and sees to the journal; `is_due` tells whether the one after it is due,
        !> too. Only the bookkeeping holds up the other threads.
        subroutine write_next(is_due)
            logical, intent(out) :: is_due
            type(journal_entry_t) :: entry
            type(error_t), allocatable :: problem
            real(dp) :: moment
            logical :: has_entry

            moment = seconds()
            call queue%write_next(table, problem)
            !$omp critical (queue)
            call queue%end_write(problem)
            ! These make texts: see `status_names`.
            !$omp critical (texts)
            call progress%update(table%rows())
            call table%take_entry(entry, has_entry, queue%error)
            !$omp end critical (texts)
            if (.not. has_entry) call queue%begin_write(is_due)
            costs%writing = costs%writing + (seconds() - moment)
            !$omp end critical (queue)
            if (.not. has_entry) return
            ! While the disk takes the entry others may write.
            moment = seconds()
            call table%keep_entry(entry, problem)
            !$omp critical (queue)
            call table%end_entry()
            if (.not. allocated(queue%error)) call move_alloc(problem, queue%error)
            call queue%begin_write(is_due)
            costs%writing = costs%writing + (seconds() - moment)
            !$omp end critical (queue)
        end subroutine write_next

        !> Adds the costs of the other ranks to those of the writer.
        subroutine reduce_costs()
            real(dp) :: parts(5)
            parts = [costs%making, costs%computing, costs%formatting, costs%writing, real(peak_memory(), dp)]
            call ranks%reduce(parts)
            costs = costs_t(parts(1), parts(2), parts(3), parts(4), parts(5))
        end subroutine reduce_costs

    end subroutine run_sweep

    !> A signal that ends the run tells how many of so many rows are kept, and how to resume it.
    subroutine announce_signals(job, options, table, rows)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        class(row_table_t), intent(in) :: table
        integer(int64), intent(in) :: rows
        character, parameter :: nl = new_line('a')
        character(:), allocatable :: command

        if (.not. table%is_resumable) then
            call watch_signals('', 'spintop: interrupted: nothing is kept of ' // job%output // nl, -1_int64)
            return
        end if
        command = 'the same command with --resume'
        if (options%ranks%count == 1 .and. allocated(options%command)) then
            command = options%command // ' --resume '
            if (index(job%input, '-') == 1) command = command // '-- '
            command = command // shell_word(job%input)
        end if
        call watch_signals('spintop: interrupted: ', ' of ' // to_text(rows) // ' rows of ' // job%output // &
                           ' are kept' // nl // 'to resume: ' // command // nl, table%rows())
    end subroutine announce_signals

    !> Number of the calling thread, from 0.
    integer function this_thread()
        this_thread = 0
        !$ this_thread = omp_get_thread_num()
    end function this_thread

    !> Who computes: `2 threads`, `4 ranks x 2 threads`, or `2 ranks, 24 threads` where they differ.
    function team_text(ranks, threads, all_threads) result(text)
        integer, intent(in) :: ranks, threads, all_threads !! threads of the writer, of all ranks
        character(:), allocatable :: text
        if (ranks == 1) then
            text = to_text(threads) // ' threads'
        else if (ranks * threads == all_threads) then
            text = to_text(ranks) // ' ranks x ' // to_text(threads) // ' threads'
        else
            text = to_text(ranks) // ' ranks, ' // to_text(all_threads) // ' threads'
        end if
    end function team_text

    !> Whether all ranks have the same build and input: their tables would have the same head.
    subroutine compare_with_writer(ranks, head, error)
        type(ranks_t), intent(in) :: ranks
        character(:), allocatable, intent(in) :: head
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: head_of_writer, problem
        head_of_writer = head
        call ranks%broadcast(head_of_writer)
        problem = compare_heads(head_of_writer, 'rank 0', head, 'rank ' // to_text(ranks%number))
        if (problem /= '') error = input_error('the ranks are not of one build and input' // problem)
        call ranks%agree(error)
    end subroutine compare_with_writer

    !> The summary: plan, cases by status, time by part.
    subroutine describe_sweep(job, shard, table, team, elapsed, costs, summary)
        type(job_t), intent(in) :: job
        type(shard_t), intent(in) :: shard
        class(row_table_t), intent(in) :: table
        character(*), intent(in) :: team !! that computed it
        real(dp), intent(in) :: elapsed
        type(costs_t), intent(in) :: costs
        type(summary_t), intent(out) :: summary
        integer(int64) :: computed
        integer :: status

        computed = table%rows() - sum(table%taken_over)
        call summary%headline(job%input // ': sweep of ' // to_text(job%axes%cases) // ' cases -> ' // job%output)
        if (shard%is_part()) call summary%add('shard', shard%line(job%axes%cases))
        call summary%describe_plan(job%plan)
        if (table%remark /= '') call summary%add('note', table%remark)
        call summary%add('ended', utc_now() // ' on ' // host_name())
        call summary%add('time', rounded(elapsed) // ' s on ' // team // ', ' &
            // rounded(computed / elapsed) // ' cases/s')
        call summary%add('parts', 'making cases ' // rounded(costs%making) // ' s, computing ' &
            // rounded(costs%computing) // ' s (' // rounded(computed / max(costs%computing, tiny(elapsed))) &
            // ' cases/s a thread), formatting ' // rounded(costs%formatting) &
            // ' s, all threads together; writing ' // rounded(costs%writing) // ' s')
        call summary%add('memory', rounded(costs%memory / 1.0e6_dp) // ' MB at most')
        do status = status_ok, last_status
            if (table%counts(status) == 0) cycle
            call summary%add('status', to_text(table%counts(status)) // ' ' // status_name(status) // ': ' &
                             // status_meaning(status))
        end do
    end subroutine describe_sweep

end module spintop_sweep
