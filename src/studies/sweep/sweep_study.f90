!> The sweep as a kind of study: a case for each combination of the axes, one row each, on all cores, in one
!> process or in many. A team of threads and ranks computes the cases (`spintop_thread_team`); here its table is
!> begun, finished and summarized.
module spintop_sweep_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: seconds, utc_now
    use spintop_study_head, only: compare_with_writer
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_ok
    use spintop_files, only: replace_file
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_options, only: options_t
    use spintop_problems, only: problems_t
    use spintop_process, only: host_name, stop_watching_signals
    use spintop_ranks, only: ranks_t
    use spintop_row_table, only: row_table_t
    use spintop_scene_keys, only: scene_t
    use spintop_shard, only: shard_t
    use spintop_statistics_choice, only: choose_statistics
    use spintop_status, only: code_of, last_status, status_meaning, status_name, status_ok
    use spintop_study, only: study_t
    use spintop_summary, only: rounded, summary_t
    use spintop_sweep_columns, only: columns_at, work_for
    use spintop_sweep_forecast, only: forecast_sweep
    use spintop_sweep_result, only: asks_for_span, kinds_of_work, of_details
    use spintop_sweep_table, only: describe_table, start_table
    use spintop_sweep_rows, only: sweep_rows_t
    use spintop_sweep_worker, only: size_of_block
    use spintop_thread_team, only: team_t
    use spintop_text, only: join, to_text
    implicit none
    private
    public :: sweep_study_t, compute_cases

    !> First and last case of an empty range.
    integer(int64), parameter :: no_cases(2) = [1, 0]

    !> A case for each combination of the axes, one row each.
    type, extends(study_t) :: sweep_study_t
    contains
        procedure :: check
        procedure :: explain
        procedure :: run
        procedure :: complete
        procedure :: remark
        procedure :: forecast
    end type sweep_study_t

contains

    !> Plans the first case; the others are made during the run.
    subroutine check(self, job, problems, diagnostics)
        class(sweep_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scene_t), allocatable :: first

        call job%make_axes(problems, diagnostics)
        if (job%axes%cases == 0) return
        call job%make_first_case(first, problems, planned=.true.)
        call job%warn_of_bodies(problems)
    end subroutine check

    !> Number of cases.
    function explain(self, job) result(phrase)
        class(sweep_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase, which
        which = 'the first'
        if (job%first > 1) which = 'number ' // to_text(job%first) // ', the first that can be computed'
        phrase = 'a sweep of ' // to_text(job%axes%cases) // ' cases, of which this is ' // which
    end function explain

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
        integer(int64) :: cases(2)
        real(dp) :: began

        code = exit_ok
        call begin_table(job, options, table, cases, error)
        if (allocated(error)) return
        if (table%is_complete) then
            code = code_of(table%counts)
            call summary%headline(job%input%path // ': sweep -> ' // job%files%table)
            call summary%add('note', table%remark)
            call summary%add_failures('cases', table%counts)
            return
        end if
        began = seconds()
        ! If there is nothing to compute, the writer finishes the table alone.
        if (cases(1) > cases(2) .and. .not. options%ranks%is_writer()) return
        if (options%ranks%is_writer()) call announce(job, options, table, cases, team)
        call compute_cases(job, options%ranks, cases, table, team, code, error)
        call stop_watching_signals()
        if (allocated(error) .or. .not. team%ranks%is_writer()) return
        call describe_sweep(job, options%shard, table, team, seconds() - began, summary)
        ! The table itself contains nothing that varies from run to run.
        call replace_file(job%files%log, join(summary%lines, new_line('a')) // new_line('a'), error)
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
        team%costs%writing = team%costs%writing + (seconds() - moment)
        if (.not. allocated(error)) code = code_of(table%counts)
    end subroutine compute_cases

    !> Begins the table of a job or goes on with one, and finds the first and last case to compute, the same in all
    !> ranks; there are none where the table is complete, or the writer has an error.
    subroutine begin_table(job, options, table, cases, error)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        class(row_table_t), allocatable, intent(out) :: table
        integer(int64), intent(out) :: cases(2)
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: head

        cases = no_cases
        call describe_table(job, options%shard, table, head)
        call compare_with_writer(options%ranks, head, error)
        if (allocated(error)) return
        if (options%ranks%is_writer()) then
            call start_table(job, options%resume, options%restart, head, table, error)
            if (.not. (allocated(error) .or. table%is_complete)) then
                cases = [options%shard%first(job%axes%cases) + table%rows(), options%shard%last(job%axes%cases)]
            end if
        end if
        call options%ranks%broadcast(cases)
    end subroutine begin_table

    !> Starts the progress of the cases, and says what a signal that ends the run is to tell.
    subroutine announce(job, options, table, cases, team)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        class(row_table_t), intent(in) :: table
        integer(int64), intent(in) :: cases(2)
        type(team_t), intent(inout) :: team
        integer(int64) :: rows

        rows = table%rows() + cases(2) - cases(1) + 1
        call team%progress%start(job%name, 'cases', rows, options%quiet, options%progress, before=table%rows())
        if (table%remark /= '') call team%progress%note(table%remark)
        call options%announce_signals(job%input%path, job%files%table, table, rows)
    end subroutine announce

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
        call summary%add('ended', utc_now() // ' on ' // host_name())
        call summary%add('time', rounded(elapsed) // ' s on ' // team%in_words() // ', ' &
            // rounded(computed / elapsed) // ' cases/s')
        associate (costs => team%costs)
            call summary%add('parts', 'making cases ' // rounded(costs%making) // ' s, computing ' &
                // rounded(costs%computing) // ' s (' // rounded(computed / max(costs%computing, tiny(elapsed))) &
                // ' cases/s per thread), formatting ' // rounded(costs%formatting) &
                // ' s, all threads together; writing ' // rounded(costs%writing) // ' s')
            call summary%add('memory', rounded(costs%memory / 1.0e6_dp) // ' MB peak')
        end associate
        do status = status_ok, last_status
            if (table%counts(status) == 0) cycle
            call summary%add('status', to_text(table%counts(status)) // ' ' // status_name(status) // ': ' &
                             // status_meaning(status))
        end do
        if (table%doubtful > 0) call summary%add('note', to_text(table%doubtful) // ' of the computed cases pass a pole within &
            &their error: phi and psi may be off by whole turns')
        call summary%add_failures('cases', table%counts)
    end subroutine describe_sweep

    !> Plans the statistics.
    subroutine complete(self, job, problems)
        class(sweep_study_t), intent(in) :: self
        type(job_t), intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        call choose_statistics(job, problems)
    end subroutine complete

    !> Whether a sweep integrates its cases numerically.
    function remark(self, job) result(text)
        class(sweep_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: text
        logical :: work(kinds_of_work)
        text = ''
        if (.not. job%case%body%has_closed_nutation()) return
        work = work_for(columns_at(job%columns))
        ! Beside the formulas of a fast top.
        if (asks_for_span(work) .or. work(of_details)) return
        text = ' The selected columns need only the closed form of the nutation: no case is integrated.'
    end function remark

    !> The table, memory and time, from a sample of the cases.
    subroutine forecast(self, job, options, summary)
        class(sweep_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job; unchanged at the end
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(inout) :: summary !! lines are added
        call forecast_sweep(job, options, summary)
    end subroutine forecast

end module spintop_sweep_study
