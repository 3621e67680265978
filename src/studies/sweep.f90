!> The sweep study: a case for each combination of the axes, one row each, on all cores. Blocks of
!> cases are computed in any order, by threads that know nothing of each other; a queue has their
!> rows written in the order of the cases.
module spintop_sweep
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_errors, only: error_t
    use spintop_growing_table, only: growing_table_t
    use spintop_job, only: job_t, options_t
    use spintop_journal, only: journal_entry_t
    use spintop_parameter_print, only: print_namelist
    use spintop_progress, only: progress_t
    use spintop_provenance, only: describe_provenance
    use spintop_row_block, only: row_block_t
    use spintop_row_queue, only: row_queue_t
    use spintop_shard, only: shard_t
    use spintop_status, only: status_ok, status_name, status_meaning, last_status
    use spintop_summary, only: summary_t, rounded
    use spintop_sweep_columns, only: sweep_column_t, sweep_columns
    use spintop_sweep_worker, only: sweep_worker_t, size_of_block
    use spintop_system, only: host_name, peak_memory, pause_for, replace_file, seconds, utc_now
    use spintop_table_head, only: comment_lines, table_head
    use spintop_text, only: join, string_t, to_text
    !$ use omp_lib, only: omp_get_num_threads
    implicit none
    private
    public :: run_sweep

    !> Blocks a thread that a fast thread may be ahead of a slow one, and how long it waits then, s.
    integer, parameter :: blocks_ahead = 8
    real(dp), parameter :: pause_when_ahead = 1.0e-4_dp

    !> Seconds spent by all threads together on making, computing, formatting and writing cases.
    type :: times_t
        real(dp) :: making = 0, computing = 0, formatting = 0, writing = 0
    end type times_t

contains

    !> Computes all cases, or those of one part, and writes the table; `counts` are the cases of each
    !> status. After an error the part of the table that is complete stays, for a later run to resume.
    subroutine run_sweep(job, options, summary, counts, error)
        type(job_t), intent(inout) :: job
        type(options_t), intent(in) :: options
        type(summary_t), intent(out) :: summary
        integer(int64), intent(out) :: counts(0:last_status)
        type(error_t), allocatable, intent(out) :: error
        type(growing_table_t) :: table
        type(progress_t) :: progress
        type(row_queue_t) :: queue
        type(times_t) :: times
        character(:), allocatable :: head
        integer(int64) :: first, last, taken
        real(dp) :: began, moment
        integer :: threads

        counts = 0
        call describe_table(job, options%shard, head)
        call table%start(job%output, head, options%resume, error)
        if (allocated(error)) return
        if (table%is_complete) then
            call summary%headline(job%input // ': sweep -> ' // job%output)
            call summary%add('note', table%remark)
            return
        end if
        first = options%shard%first(job%axes%cases) + table%rows()
        last = options%shard%last(job%axes%cases)
        call progress%start(job%name, 'cases', table%rows() + last - first + 1, options%quiet, &
                            options%progress, before=table%rows())
        if (table%remark /= '') call progress%note(table%remark)
        taken = 0
        threads = 1
        began = seconds()
        !$omp parallel
        !$omp single
        !$ threads = omp_get_num_threads()
        call queue%start(blocks_ahead * threads)
        !$omp end single
        call compute_share()
        !$omp end parallel
        call progress%finish()
        moment = seconds()
        call move_alloc(queue%error, error)
        if (.not. allocated(error)) call table%finish(error)
        if (allocated(error)) then
            call table%abandon(error)
            return
        end if
        times%writing = times%writing + (seconds() - moment)
        counts = table%counts
        call describe_sweep(job, options%shard, table, threads, seconds() - began, times, summary)
        ! The table itself holds nothing that varies from run to run.
        call replace_file(job%log, join(summary%lines, new_line('a')) // new_line('a'), error)

    contains

        !> What each thread does: takes the next block, computes it and hands it in, until none is left.
        subroutine compute_share()
            type(sweep_worker_t), allocatable, target :: worker
            type(row_block_t) :: rows
            integer(int64) :: number, start
            integer :: cases_of_block
            logical :: is_over

            cases_of_block = size_of_block(job)
            allocate (worker)
            call worker%prepare(job)
            do
                !$omp critical (queue)
                taken = taken + 1
                number = taken
                is_over = allocated(queue%error)
                !$omp end critical (queue)
                start = first + (number - 1) * cases_of_block
                if (is_over .or. start > last) exit
                call worker%compute_rows(job, start, min(start + cases_of_block - 1, last), rows)
                call hand_in(number, rows)
            end do
            !$omp critical (queue)
            times%making = times%making + worker%making
            times%computing = times%computing + worker%computing
            times%formatting = times%formatting + worker%formatting
            !$omp end critical (queue)
        end subroutine compute_share

        !> Hands in a block, once it is not too far ahead of the others, and sees to the journal.
        subroutine hand_in(number, rows)
            integer(int64), intent(in) :: number
            type(row_block_t), intent(inout) :: rows
            type(journal_entry_t) :: entry
            type(error_t), allocatable :: problem
            real(dp) :: moment
            logical :: accepted, due

            do
                !$omp critical (queue)
                moment = seconds()
                call queue%hand_in(number, rows, table, accepted)
                if (accepted) then
                    ! These make texts: see `status_names`.
                    !$omp critical (texts)
                    call progress%update(table%rows())
                    call table%take_entry(entry, due, queue%error)
                    !$omp end critical (texts)
                end if
                times%writing = times%writing + (seconds() - moment)
                !$omp end critical (queue)
                if (accepted) exit
                call pause_for(pause_when_ahead)
            end do
            if (.not. due) return
            moment = seconds()
            call table%keep_entry(entry, problem)
            !$omp critical (queue)
            call table%end_entry()
            if (.not. allocated(queue%error)) call move_alloc(problem, queue%error)
            times%writing = times%writing + (seconds() - moment)
            !$omp end critical (queue)
        end subroutine hand_in

    end subroutine run_sweep

    !> The summary: plan, cases by status, time by part.
    subroutine describe_sweep(job, shard, table, threads, elapsed, times, summary)
        type(job_t), intent(in) :: job
        type(shard_t), intent(in) :: shard
        type(growing_table_t), intent(in) :: table
        integer, intent(in) :: threads
        real(dp), intent(in) :: elapsed
        type(times_t), intent(in) :: times
        type(summary_t), intent(out) :: summary
        integer(int64) :: computed
        integer :: status

        computed = table%rows() - sum(table%taken_over)
        call summary%headline(job%input // ': sweep of ' // to_text(job%axes%cases) // ' cases -> ' // job%output)
        if (shard%is_part()) call summary%add('shard', shard%line(job%axes%cases))
        call summary%describe_plan(job%plan)
        if (table%remark /= '') call summary%add('note', table%remark)
        call summary%add('ended', utc_now() // ' on ' // host_name())
        call summary%add('time', rounded(elapsed) // ' s on ' // to_text(threads) // ' threads, ' &
            // rounded(computed / elapsed) // ' cases/s')
        call summary%add('parts', 'making cases ' // rounded(times%making) // ' s, computing ' &
            // rounded(times%computing) // ' s (' // rounded(computed / max(times%computing, tiny(elapsed))) &
            // ' cases/s a thread), formatting ' // rounded(times%formatting) &
            // ' s, all threads together; writing ' // rounded(times%writing) // ' s')
        call summary%add('memory', rounded(peak_memory() / 1.0e6_dp) // ' MB at most')
        do status = status_ok, last_status
            if (table%counts(status) == 0) cycle
            call summary%add('status', to_text(table%counts(status)) // ' ' // status_name(status) // ': ' &
                             // status_meaning(status))
        end do
    end subroutine describe_sweep

    !> Head of the table: where it comes from, and its columns (case, swept parameters, status,
    !> quantities, notes). The table of a part has the head of the whole below a line that tells the part.
    subroutine describe_table(job, shard, head)
        type(job_t), intent(in) :: job
        type(shard_t), intent(in) :: shard
        character(:), allocatable, intent(out) :: head
        type(string_t), allocatable :: input(:), header(:), part(:)
        type(sweep_column_t), allocatable :: columns(:)
        integer :: i, axes

        axes = size(job%axes%axis)
        allocate (columns(axes + size(job%columns) + 3))
        columns(1) = sweep_column_t('case', '', 'number of the case', 0)
        do i = 1, axes
            associate (name => job%axes%axis(i)%name)
                associate (parameter => job%table%parameters(job%table%find(base_of(name))))
                    columns(1 + i) = sweep_column_t(name, parameter%unit, parameter%what, 0)
                end associate
            end associate
        end do
        columns(axes + 2) = sweep_column_t('status', '', 'ok, or what failed', 0)
        columns(axes + 3:size(columns) - 1) = sweep_columns(job%columns)
        columns(size(columns)) = sweep_column_t('notes', '', 'why a quantity does not exist', 0)
        call print_namelist(job%table, input)
        call describe_provenance(job%scene%title, job%plan%model, job%plan%method, input, columns%name, &
                                 columns%unit, columns%what, dated=.false., lines=header)
        allocate (part(merge(1, 0, shard%is_part())))
        if (shard%is_part()) part(1)%text = shard%line(job%axes%cases)
        head = comment_lines(part) // table_head(header, columns%name)
    end subroutine describe_table

    !> Name of a parameter without its subscript.
    pure function base_of(name) result(base)
        character(*), intent(in) :: name
        character(:), allocatable :: base
        base = name(:index(name // '(', '(') - 1)
    end function base_of

end module spintop_sweep
