!> The trajectory study: one motion, one table.
module spintop_trajectory_study
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_count, proof_of_q0
    use spintop_process, only: seconds, stop_watching_signals
    use spintop_errors, only: error_t, exit_internal, exit_ok
    use spintop_event_recorder, only: event_columns, event_recorder_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_row_table, only: refusal, remove_leftovers
    use spintop_integration, only: outcome_t
    use spintop_job, only: job_t, study_head
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_motion_rows, only: compute_motion, writer_t, find_sensitivities
    use spintop_study, only: options_t, study_t
    use spintop_planning, only: sample_time
    use spintop_problems, only: problems_t
    use spintop_row_proof, only: row_proof_t, wanted_proofs
    use spintop_scene_keys, only: scene_t
    use spintop_status, only: code_of, is_good_end, is_ok, status_meaning, status_name
    use spintop_steady_motion, only: sleeps_slowly
    use spintop_study_column, only: study_column_t
    use spintop_summary, only: decimal, rounded, slow_sleeper, summary_t
    use spintop_table_end, only: check_table
    use spintop_text, only: string_t, to_text, escaped
    use spintop_uncertainties, only: data_radii
    implicit none
    private
    public :: trajectory_study_t

    !> One motion, one table.
    type, extends(study_t) :: trajectory_study_t
    contains
        procedure :: check
        procedure :: run
        procedure :: forecast
    end type trajectory_study_t

    !> The proof of the first part of the motion is measured: a part that takes so long, s, or all of it.
    real(dp), parameter :: long_enough = 0.1_dp
    integer, parameter :: halvings = 10

    !> Each time is the minimum of several repeats, each of several calls.
    integer, parameter :: repeats = 7, setups = 50, samples = 500

contains

    !> Plans the motion.
    subroutine check(self, job, problems)
        class(trajectory_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(scene_t), allocatable :: scene

        call job%make_first_case(scene, problems, planned=.true.)
        if (problems%any()) return
        self%phrase = 'a trajectory of ' // to_text(job%plan%samples) // ' rows over ' // to_text(job%case%t_end) // ' s'
        associate (body => job%case%body, start => job%case%start)
            if (sleeps_slowly(body, start)) call problems%warn('initial', slow_sleeper(body, start), &
                                                               'start with a tilt, such as 1e-6 rad, or spin faster')
        end associate
    end subroutine check

    !> The time that the proof takes, if anything is to be proved. A motion that amplifies errors takes longer in its later parts,
    !> which need more bits.
    subroutine forecast(self, job, options, summary)
        class(trajectory_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job; unchanged at the end
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(inout) :: summary !! lines are added
        type(row_proof_t) :: proof
        real(dp) :: printed(proof_count), began, time, part
        logical :: wanted(proof_count)
        integer :: i

        wanted = wanted_proofs(job%columns%quantity(), job%input%scene%certified, '')
        if (.not. any(wanted)) return
        printed = 0
        printed(proof_of_q0) = 1
        began = seconds()
        call proof%open(wanted, .false., job%case%given_body, job%case%given_start, data_radii(job%input%scene))
        do i = halvings, 0, -1
            part = 0.5_dp**i
            call proof%prove(part * job%case%t_end, printed)
            time = seconds() - began
            if (time > long_enough .or. .not. proof%is_proved()) exit
        end do
        call proof%close()
        if (proof%is_proved()) then
            call summary%add('proof', 'about ' // rounded(time / part) // ' s, from the first ' // &
                             decimal(part * job%case%t_end) // ' s of motion')
        else
            call summary%add('proof', 'at t = ' // decimal(part * job%case%t_end) // ': ' // proof%summary())
        end if
    end subroutine forecast

    !> Computes the motion, and writes its table. A motion that fails has the rows up to the failure.
    subroutine run(self, job, options, summary, code, error)
        class(trajectory_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(writer_t) :: writer
        type(event_recorder_t), allocatable, target :: recorder
        type(outcome_t) :: outcome
        real(dp), allocatable :: times(:), cells(:, :)
        character(:), allocatable :: problem
        real(dp) :: began, elapsed
        integer :: status, missing, i, n

        code = exit_ok
        missing = 0
        ! The exact solution computes the times one by one.
        allocate (times(merge(0, job%plan%samples, job%plan%exact)), stat=status)
        if (status /= 0) call refuse_size(job, 'the times of ', error)
        if (allocated(error)) return
        times = [(sample_time(job%case%t_end, size(times), i), i=1, size(times))]
        call begin_tables(job, options, writer, recorder, error)
        if (allocated(error)) return
        if (writer%table%is_complete) then
            status = findloc(writer%table%counts > 0, .true., dim=1) - 1
            code = code_of(status)
            if (job%files%events /= '') then
                call check_table(job%files%events, problem)
                if (problem == '') call remove_leftovers(job%files%events)
                if (problem /= '') error = refusal(job%files%events, problem)
            end if
            if (allocated(error)) return
            call summary%headline(job%input%path // ': trajectory -> ' // job%files%table)
            call summary%add('note', writer%table%remark)
            if (.not. is_good_end(status)) call summary%add('status', status_name(status) // ': ' // status_meaning(status))
            return
        end if
        began = seconds()
        call compute_motion(job%case, job%plan, times, writer, outcome, recorder, job%input%scene)
        if (allocated(writer%kept)) then
            ! The derivatives follow the columns of the table in the kept rows.
            n = size(job%columns)
            allocate (cells(2 * job%sensitivities%count, writer%rows))
            call find_sensitivities(job, writer%chosen(n + 1:), writer%kept(n + 1:, :writer%rows), cells, writer%error)
            missing = count(.not. abs(cells(1::2, :)) <= huge(1.0_dp))
            do i = 1, writer%rows
                if (.not. allocated(writer%error)) call writer%add_row([writer%kept(:n, i), cells(:, i)], writer%error)
            end do
        end if
        elapsed = seconds() - began
        code = code_of(outcome%status)
        call finish_tables(job, outcome, writer, recorder, error)
        if (allocated(error)) return
        call describe_run(job, options, writer%rows, outcome, elapsed, recorder, summary)
        if (writer%table%remark /= '') call summary%add('note', writer%table%remark)
        if (.not. (job%plan%exact .or. sleeps_slowly(job%case%body, job%case%start))) then
            associate (last => writer%last)
                if (sleeps_slowly(job%case%body, last)) call summary%add('note', 'in the end ' // slow_sleeper(job%case%body, last))
            end associate
        end if
        if (missing > 0) call summary%add('note', to_text(missing) // ' derivatives do not converge: they are nan')
        associate (proof => writer%columns%proof)
            if (any(proof%wanted)) call summary%add('proof', proof%summary())
            call proof%close()
        end associate
    end subroutine run

    !> Begins the table of the motion, and that of its events if there is to be one. `recorder` looks for the events; it is not
    !> allocated where there are none to look for. After an error there is no table.
    subroutine begin_tables(job, options, writer, recorder, error)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        type(writer_t), intent(inout) :: writer
        type(event_recorder_t), allocatable, target, intent(out) :: recorder
        type(error_t), allocatable, intent(out) :: error
        type(study_column_t), allocatable :: needed(:)
        integer :: status

        writer%total = job%plan%samples
        if (job%sensitivities%count == 0) then
            call writer%set_columns(job%columns, job%case, job%input%scene)
        else
            ! The rows are kept: the columns of the table, then those of which there are derivatives.
            allocate (needed, source=[job%columns, job%sensitivities%columns()])
            call writer%set_columns(needed, job%case, job%input%scene)
            allocate (writer%kept(size(needed), job%plan%samples), stat=status)
            if (status /= 0) call refuse_size(job, '', error)
            if (allocated(error)) return
        end if
        call writer%progress%start(job%name, 'rows', writer%total, options%quiet, options%progress)
        call writer%describe(job)
        call writer%start(options%resume, options%restart, error)
        if (allocated(error) .or. writer%table%is_complete) return
        if (size(job%events) > 0) then
            allocate (recorder)
            call recorder%set(job%events, job%stop_after, job%case)
            if (job%files%events /= '') call recorder%open_table(job%columns, job%case, job%input%scene, error, &
                job%files%events, study_head(job, [event_columns, job%columns%column_t]))
            if (allocated(error)) then
                call writer%table%discard()
                call recorder%file%discard()
                return
            end if
        end if
        associate (table => writer%table)
            if (table%remark /= '') call writer%progress%note(table%remark)
            call options%announce_signals(job%input%path, job%files%table, table, writer%total)
        end associate
    end subroutine begin_tables

    !> Finishes the tables with a line on how the motion ended; after an error they are discarded.
    subroutine finish_tables(job, outcome, writer, recorder, error)
        type(job_t), intent(in) :: job
        type(outcome_t), intent(in) :: outcome
        type(writer_t), intent(inout) :: writer
        type(event_recorder_t), allocatable, intent(inout) :: recorder
        type(error_t), allocatable, intent(out) :: error
        type(string_t) :: trailer(1)
        character(:), allocatable :: ending

        if (allocated(writer%error)) then
            call move_alloc(writer%error, error)
        else
            ! How it ended, and when if it is not complete.
            ending = status_name(outcome%status)
            if (.not. is_ok(outcome%status)) ending = ending // ' at t = ' // to_text(outcome%end_time())
            trailer(1)%text = 'status: ' // ending
            if (job%files%events /= '') call recorder%close_table(trailer, error)
            if (.not. allocated(error)) call writer%finish(ending, error)
        end if
        call stop_watching_signals()
        if (.not. allocated(error)) return
        call writer%table%discard()
        if (allocated(recorder)) call recorder%file%discard()
    end subroutine finish_tables

    !> The summary: plan, motion, events, cost, and how the motion ended.
    subroutine describe_run(job, options, rows, outcome, elapsed, recorder, summary)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        integer, intent(in) :: rows
        type(outcome_t), intent(in) :: outcome
        real(dp), intent(in) :: elapsed !! seconds that the motion took
        type(event_recorder_t), allocatable, intent(in) :: recorder
        type(summary_t), intent(inout) :: summary
        character(:), allocatable :: often
        real(dp) :: setup, sample

        call summary%headline(job%input%path // ': trajectory of ' // to_text(rows) // ' rows -> ' // job%files%table)
        call summary%describe_plan(job%plan)
        call summary%describe_motion(job%case)
        if (job%files%events /= '') call summary%add('events', to_text(recorder%rows) // ' -> ' // job%files%events)
        if (job%plan%exact .and. options%verbose) then
            call measure_exact_cost(job%case, setup, sample)
            call summary%add('cost', rounded(1.0e6_dp * setup) // ' us for the set-up, ' &
                             // rounded(1.0e6_dp * sample) // ' us per sample', is_detail=.true.)
        else if (.not. job%plan%exact) then
            call summary%describe_cost(outcome%counts, job%plan%stepper%info%refine)
        end if
        call summary%add('time', rounded(elapsed) // ' s for ' // decimal(outcome%t) // ' s of motion')
        associate (status => outcome%status)
            call summary%add('status', status_name(status) // ' at t = ' // to_text(outcome%end_time()) // ': ' &
                             // status_meaning(status))
            if (outcome%doubtful_passages > 0) call summary%add('note', to_text(outcome%doubtful_passages) // ' passages of a &
                &pole within the error of the motion: phi and psi may be off by whole turns')
            if (job%input%scene%stop_at == '' .or. .not. is_good_end(status)) return
        end associate
        if (recorder%ended_by > 0) then
            call summary%add('end', trim(recorder%events(recorder%ended_by)%name) // ' (stop_at)')
        else
            often = 'occurred fewer than ' // to_text(job%stop_after) // ' times'
            if (job%stop_after == 1) often = 'did not occur'
            call summary%add('end', "not at an event: '" // trim(job%input%scene%stop_at) // "' " // often // ' in the span')
        end if
    end subroutine describe_run

    !> The error of rows that the memory does not hold.
    subroutine refuse_size(job, what, error)
        type(job_t), intent(in) :: job
        character(*), intent(in) :: what !! of the rows
        type(error_t), allocatable, intent(out) :: error
        error = error_t(exit_internal, escaped(job%input%path) // ': not enough memory for ' // what // &
                        to_text(job%plan%samples) // ' rows; use fewer span.samples')
    end subroutine refuse_size

    !> Time of a preparation, and of one sample (angles, rates, quaternion, acceleration), s.
    subroutine measure_exact_cost(case, setup, sample)
        type(case_t), intent(in) :: case !! the case, whose body must have a closed form
        real(dp), intent(out) :: setup, sample !! time of a preparation, and of one sample, s
        type(exact_motion_t) :: exact
        type(motion_t) :: motion
        real(dp) :: began, unused
        integer :: repeat, i, status

        setup = huge(setup)
        sample = huge(sample)
        unused = 0
        do repeat = 1, repeats
            began = seconds()
            do i = 1, setups
                call prepare_exact_motion(case%body, case%start, exact, status)
            end do
            setup = min(setup, (seconds() - began) / setups)
            began = seconds()
            do i = 1, samples
                motion = exact%at(case%t_end * i / samples)
                unused = unused + motion%quaternion(1)
            end do
            sample = min(sample, (seconds() - began) / samples)
        end do
        ! The sum is used, so that the compiler does not remove the computation.
        if (unused > huge(unused)) sample = unused
    end subroutine measure_exact_cost

end module spintop_trajectory_study
