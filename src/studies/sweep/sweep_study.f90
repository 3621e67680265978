!> The sweep as a kind of study: a case for each combination of the axes, one row each, on all cores, in one
!> process or in many. A team of threads and ranks computes the cases (`spintop_thread_team`); here its table is
!> begun, finished and summarized. What it will need, the size of its table, memory and time, shows a sample of its cases.
module spintop_sweep_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, exit_failed, exit_ok
    use spintop_files, only: host_name, remove_file, replace_file, utc_now
    use spintop_job, only: compare_with_writer, job_t
    use spintop_kinds, only: dp
    use spintop_study, only: options_t, study_t
    use spintop_problems, only: problems_t
    use spintop_process, only: peak_memory, processor_seconds, seconds, stop_watching_signals
    use spintop_ranks, only: ranks_t
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_scene_keys, only: scene_t
    use spintop_statistics_choice, only: choose_statistics
    use spintop_statistics_output, only: bytes_of_result
    use spintop_status, only: count_failed, is_good_end, last_status, status_meaning, status_name, status_ok
    use spintop_study_column, only: study_column_t
    use spintop_summary, only: duration, rounded, summary_t
    use spintop_sweep_result, only: asks_for_span, kinds_of_work, of_details, work_for
    use spintop_sweep_worker, only: cells_of_row, describe_columns, describe_table, size_of_block, sweep_rows_t
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_words
    use spintop_table_head, only: shard_t
    use spintop_text, only: join, string_t, strings_of, to_text
    use spintop_thread_team, only: blocks_ahead, memory_in_use, team_t, work_of_computing, work_of_formatting, &
        work_of_making, work_of_writing
    !$ use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: sweep_study_t, compute_cases

    !> The first sample: places in the range of the cases, and consecutive cases at each. Where whole blocks at so many places
    !> are fast, they are the sample: a case of a whole block costs less.
    integer, parameter :: few_places = 8, cases_at_place = 25, many_places = 64
    !> After this time no more places are computed, s.
    real(dp), parameter :: long_enough = 1
    !> Columns that make a case at least so many times as long are named.
    real(dp), parameter :: expensive = 1.5_dp

    !> What a sample has shown.
    type :: sample_t
        integer(int64) :: cases = 0, bytes = 0
        real(dp) :: time = 0
        !> Time of the processor, which other programs do not disturb, s.
        real(dp) :: work = 0
    end type sample_t

    !> A case for each combination of the axes, one row each.
    type, extends(study_t) :: sweep_study_t
    contains
        procedure :: check
        procedure :: run
        procedure :: complete
        procedure :: forecast
    end type sweep_study_t

contains

    !> Plans the first case; the others are made during the run.
    subroutine check(self, job, problems)
        class(sweep_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(scene_t), allocatable :: first

        if (job%axes%cases == 0) return
        call job%make_first_case(first, problems, planned=.true.)
        call job%warn_of_bodies(problems)
        self%count = job%axes%cases
        self%phrase = 'a sweep of ' // to_text(self%count) // ' cases, of which this is the first'
        if (job%first > 1) self%phrase = 'a sweep of ' // to_text(self%count) // ' cases, of which this is number ' // &
                                         to_text(job%first) // ', the first that can be computed'
    end subroutine check

    !> Computes all cases, or those of one part, and writes the table. After an error the part of the table that
    !> is complete stays, where a later run can resume it. Only the writer among the ranks has a summary, and a
    !> code that tells of the cases.
    subroutine run(self, job, options, summary, code, error)
        class(sweep_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        class(row_table_t), allocatable :: table
        type(team_t) :: team
        type(error_t), allocatable :: ignored
        integer(int64) :: cases(2), rows
        real(dp) :: began

        code = exit_ok
        call begin_table(job, options, table, cases, error)
        if (allocated(error)) return
        if (table%is_complete) then
            code = merge(exit_ok, exit_failed, count_failed(table%counts) == 0)
            call summary%headline(job%input%path // ': sweep -> ' // job%files%table)
            call summary%add('note', table%remark)
            call summary%add_failures('cases', table%counts)
            ! The run that made it may have been killed while it renamed its log.
            if (options%ranks%is_writer()) call remove_file(job%files%log // '.new', ignored)
            return
        end if
        began = seconds()
        ! If there is nothing to compute, the writer finishes the table alone.
        if (cases(1) > cases(2) .and. .not. options%ranks%is_writer()) return
        if (options%ranks%is_writer()) then
            rows = table%rows() + cases(2) - cases(1) + 1
            call team%progress%start(job%name, 'cases', rows, options%quiet, options%progress, before=table%rows())
            if (table%remark /= '') call team%progress%note(table%remark)
            call options%announce_signals(job%input%path, job%files%table, table, rows)
        end if
        call compute_cases(job, options%ranks, cases, table, team, code, error)
        call stop_watching_signals()
        if (allocated(error) .or. .not. team%ranks%is_writer()) return
        call describe_sweep(job, options%shard, table, team, seconds() - began, summary)
        ! The table itself contains nothing that varies from run to run.
        call replace_file(job%files%log, join(summary%lines%string_t, new_line('a')) // new_line('a'), error)
    end subroutine run

    !> Computes cases into a table that was begun, and finishes it, unless its rows could not all be written; after an error it
    !> is abandoned. All ranks call it, or the writer alone if there are no cases; only the writer knows the outcome.
    subroutine compute_cases(job, ranks, cases, table, team, code, error)
        type(job_t), target, intent(in) :: job !! the job
        type(ranks_t), intent(in) :: ranks !! the ranks of the run
        integer(int64), intent(in) :: cases(2) !! first and last case
        class(row_table_t), intent(inout) :: table !! the table
        type(team_t), intent(inout) :: team !! those who compute them, and their costs; its progress was started
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(sweep_rows_t), allocatable, target :: threads(:)
        real(dp) :: moment
        integer :: i

        code = exit_ok
        if (cases(1) <= cases(2)) then
            call team%assemble(ranks, cases, size_of_block(job))
        else
            call team%assemble(ranks_t(), cases, size_of_block(job))
        end if
        allocate (threads(team%threads))
        do i = 1, size(threads)
            call threads(i)%prepare(job)
        end do
        call team%compute(threads, table)
        if (.not. team%ranks%is_writer()) return
        call team%progress%finish()
        moment = seconds()
        call move_alloc(team%queue%error, error)
        if (.not. allocated(error)) call table%finish(error)
        if (allocated(error)) call table%abandon(error)
        team%costs(work_of_writing) = team%costs(work_of_writing) + (seconds() - moment)
        if (.not. allocated(error)) code = merge(exit_ok, exit_failed, count_failed(table%counts) == 0)
    end subroutine compute_cases

    !> Begins the table of a job or goes on with one, and finds the first and last case to compute, the same in all
    !> ranks; there are none where the table is complete, or the writer has an error.
    subroutine begin_table(job, options, table, cases, error)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        class(row_table_t), allocatable, intent(out) :: table
        integer(int64), intent(out) :: cases(2)
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: head, text

        cases = [1, 0] ! none
        call describe_table(job, options%shard, table, head)
        call compare_with_writer(options%ranks, head, error)
        if (allocated(error)) return
        if (options%ranks%is_writer()) then
            call table%start(job%files%table, head, options%resume, options%restart, error)
            if (.not. (allocated(error) .or. table%is_complete)) then
                cases = [options%shard%first(job%axes%cases) + table%rows(), options%shard%last(job%axes%cases)]
            end if
        end if
        text = to_text(cases(1)) // ' ' // to_text(cases(2))
        call options%ranks%broadcast(text)
        read (text, *) cases
    end subroutine begin_table

    !> The summary: plan, cases by status, times.
    subroutine describe_sweep(job, shard, table, team, elapsed, summary)
        type(job_t), intent(in) :: job
        type(shard_t), intent(in) :: shard
        class(row_table_t), intent(in) :: table
        type(team_t), intent(in) :: team
        real(dp), intent(in) :: elapsed
        type(summary_t), intent(out) :: summary
        character(:), allocatable :: outputs
        integer(int64) :: computed
        integer :: status

        outputs = job%files%table
        if (job%files%statistics /= '') outputs = outputs // ', ' // job%files%statistics
        computed = table%rows() - sum(table%taken_over)
        call summary%headline(job%input%path // ': sweep of ' // to_text(job%axes%cases) // ' cases -> ' // outputs)
        if (shard%is_part()) call summary%add('shard', shard%line(job%axes%cases))
        call summary%describe_plan(job%plan)
        if (table%remark /= '') call summary%add('note', table%remark)
        call summary%add('ended', utc_now() // ' on ' // host_name(), is_detail=.true.)
        call summary%add('time', rounded(elapsed) // ' s on ' // team%in_words() // ', ' &
            // rounded(computed / elapsed) // ' cases/s')
        associate (costs => team%costs)
            call summary%add('parts', 'making cases ' // rounded(costs(work_of_making)) // ' s, computing ' &
                // rounded(costs(work_of_computing)) // ' s (' &
                // rounded(computed / max(costs(work_of_computing), tiny(elapsed))) &
                // ' cases/s per thread), formatting ' // rounded(costs(work_of_formatting)) &
                // ' s, all threads together; writing ' // rounded(costs(work_of_writing)) // ' s', is_detail=.true.)
            call summary%add('memory', rounded(costs(memory_in_use) / 1.0e6_dp) // ' MB peak', is_detail=.true.)
        end associate
        do status = status_ok, last_status
            if (table%counts(status) == 0) cycle
            call summary%add('status', to_text(table%counts(status)) // ' ' // status_name(status) // ': ' &
                             // status_meaning(status), is_detail=.not. is_good_end(status))
        end do
        if (table%doubtful > 0) call summary%add('note', to_text(table%doubtful) // ' of the computed cases pass a pole within &
            &their error: phi and psi may be off by whole turns')
        call summary%add_failures('cases', table%counts)
    end subroutine describe_sweep

    !> Plans the statistics, and says whether cases are integrated.
    subroutine complete(self, job, problems)
        class(sweep_study_t), intent(in) :: self
        type(job_t), intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        logical :: work(kinds_of_work)
        call choose_statistics(job, problems)
        if (problems%any()) return
        work = work_for(job%columns)
        ! Beside the formulas of a fast top.
        if (.not. job%case%body%has_closed_nutation() .or. asks_for_span(work) .or. work(of_details)) return
        job%plan%reason = job%plan%reason // ' The selected columns need only the closed form of the nutation: no case is &
                                             &integrated.'
    end subroutine complete

    !> The table, memory and time, from a sample of the cases. At least one place of it is computed, however long that takes.
    subroutine forecast(self, job, options, summary)
        class(sweep_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job; unchanged at the end
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(inout) :: summary !! lines are added
        class(row_table_t), allocatable :: table
        type(sample_t) :: sample
        character(:), allocatable :: head
        integer(int64) :: first, cases
        integer :: threads
        real(dp) :: bytes, memory

        first = options%shard%first(job%axes%cases)
        cases = options%shard%last(job%axes%cases) - first + 1
        if (cases < 1) return
        call describe_table(job, options%shard, table, head)
        call compute_sample(job, first, cases, table, long_enough, sample)
        threads = options%threads
        !$ if (threads == 0) threads = omp_get_max_threads()
        threads = max(1, threads)
        bytes = real(sample%bytes, dp) / sample%cases
        memory = peak_memory() + real(blocks_ahead * threads, dp) * size_of_block(job) * (bytes + 8 * cells_of_row(job))
        if (job%statistics%is_wanted) memory = memory + job%statistics%bytes()
        if (job%keeps_rows()) then
            call summary%add('table', 'about ' // amount(len(head) + bytes * cases, 'B') // ', ' // rounded(bytes, 3) // &
                             ' bytes per case')
        end if
        if (job%statistics%is_wanted) then
            bytes = bytes_of_result(job%statistics)
            if (options%shard%is_part()) bytes = job%statistics%bytes()
            call summary%add('statistics', 'about ' // amount(len(head) + bytes, 'B') // ' at most')
        end if
        call summary%add('memory', 'about ' // amount(memory, 'B'))
        call summary%add('time', 'about ' // duration(sample%time / sample%cases * cases / threads, 2) // ' on ' // &
                         to_text(threads) // ' threads, from ' // to_text(sample%cases) // ' cases in ' // &
                         duration(sample%time, 2))
        if (job%sensitivities%count == 0) call name_expensive(job, first, cases, sample, summary)
    end subroutine forecast

    !> Adds a line on the columns that make the sweep expensive. Columns that need the same work are a group. A sample is computed
    !> with each group alone; where they differ, the slower half on a logarithmic scale is expensive, and a sample is computed
    !> without it.
    subroutine name_expensive(job, first, cases, all, summary)
        type(job_t), target, intent(inout) :: job
        integer(int64), intent(in) :: first, cases
        type(sample_t), intent(in) :: all !! the sample with all columns
        type(summary_t), intent(inout) :: summary
        type(string_t), allocatable :: names(:)
        type(study_column_t), allocatable :: chosen(:)
        integer :: i, k
        real(dp) :: time(size(job%columns)), ratio

        allocate (chosen, source=job%columns)
        do i = 1, size(chosen)
            do k = 1, i - 1
                if (chosen(k)%needs == chosen(i)%needs) exit
            end do
            if (k < i) then
                time(i) = time(k)
            else
                time(i) = time_with(pack(chosen, chosen%needs == chosen(i)%needs))
            end if
        end do
        if (maxval(time) < expensive * minval(time)) return
        associate (is_cheap => time < sqrt(minval(time) * maxval(time)))
            ratio = all%work / all%cases / time_with(pack(chosen, is_cheap))
            names = strings_of(chosen%name)
            if (ratio > expensive) call summary%add('columns', 'with ' // join(pack(names, .not. is_cheap), ', ') // &
                                                    ' a case takes ' // rounded(ratio, 2) // ' times as long as without')
        end associate

    contains

        !> Time of the processor for a case with these columns, s.
        real(dp) function time_with(some)
            type(study_column_t), intent(in) :: some(:)
            type(row_table_t) :: table
            type(sample_t) :: sample
            job%columns = some
            call describe_columns(job, table%columns)
            call compute_sample(job, first, cases, table, long_enough / size(chosen), sample)
            job%columns = chosen
            time_with = sample%work / sample%cases
        end function time_with

    end subroutine name_expensive

    !> Computes a sample from the whole range of the cases.
    subroutine compute_sample(job, first, cases, table, enough, sample)
        type(job_t), target, intent(in) :: job
        integer(int64), intent(in) :: first, cases
        class(row_table_t), intent(in) :: table
        real(dp), intent(in) :: enough !! after this time no more places are computed, s
        type(sample_t), intent(out) :: sample
        type(sweep_rows_t), allocatable, target :: thread
        integer :: block

        allocate (thread)
        call thread%prepare(job)
        block = size_of_block(job)
        call compute_places(few_places, min(cases_at_place, block))
        if (sample%time / sample%cases * block * many_places < enough) call compute_places(many_places, block)

    contains

        !> Computes consecutive cases in the middles of equal parts of the range.
        subroutine compute_places(places, wanted)
            integer, intent(in) :: places, wanted
            type(row_block_t) :: rows
            integer(int64) :: begin
            integer :: place, last_place, width
            real(dp) :: began, work_before
            sample = sample_t()
            width = int(min(cases, int(wanted, int64)))
            last_place = int(min(int(places, int64), cases / width))
            ! The first time also pays for what later ones find done.
            do place = 0, last_place
                begin = first + int(real(cases - width, dp) * (max(place, 1) - 0.5_dp) / last_place, int64)
                began = seconds()
                work_before = processor_seconds()
                call thread%compute_rows(begin, begin + width - 1, rows)
                if (place == 0 .and. seconds() - began < enough / few_places) cycle
                sample%bytes = sample%bytes + bytes_of(rows, table)
                sample%time = sample%time + (seconds() - began)
                sample%work = sample%work + (processor_seconds() - work_before)
                sample%cases = sample%cases + width
                if (sample%time > enough) exit
            end do
        end subroutine compute_places

    end subroutine compute_sample

    !> Bytes of rows in the table, by its format.
    integer(int64) function bytes_of(rows, table) result(bytes)
        type(row_block_t), intent(inout) :: rows
        class(row_table_t), intent(in) :: table
        integer, parameter :: bytes_of_double = 8, bytes_of_integer = 4
        integer :: i, each
        call table%format(rows)
        bytes = rows%text%length
        if (bytes > 0) return
        do i = 1, size(table%columns)
            select case (table%columns(i)%kind)
            case (column_of_integers, column_of_notes)
                each = bytes_of_integer
            case (column_of_words)
                each = 1
            case default
                each = bytes_of_double
                if (table%columns(i)%axis > 0) each = 0
            end select
            bytes = bytes + each * rows%rows
        end do
    end function bytes_of

    !> A large number with the prefix of its unit.
    function amount(value, unit) result(text)
        real(dp), intent(in) :: value
        character(*), intent(in) :: unit
        character(:), allocatable :: text
        character, parameter :: prefixes(0:6) = [' ', 'k', 'M', 'G', 'T', 'P', 'E']
        integer :: step
        step = min(ubound(prefixes, 1), max(0, int(log10(max(value, 1.0_dp)) / 3)))
        text = rounded(value / 1000.0_dp**step, 3) // ' ' // trim(prefixes(step)) // unit
    end function amount

end module spintop_sweep_study
