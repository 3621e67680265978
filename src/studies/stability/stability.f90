!> The stability study: how each method fares on motions that are hard to follow.
!>
!> Every method runs every case; the motion is compared with the exact one, or with one computed in
!> quadruple precision. One row a case and method says what the errors are, how far the invariants
!> drift, what it cost, and what to think of it.
module spintop_stability
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t, make_case
    use spintop_clock, only: seconds
    use spintop_errors, only: error_t, exit_failed, internal_error
    use spintop_formulation, only: structure_quadruple
    use spintop_hard_cases, only: hard_cases
    use spintop_job, only: job_t, options_t
    use spintop_kinds, only: dp
    use spintop_lyapunov, only: find_lyapunov
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_parameter_print, only: print_namelist
    use spintop_plan, only: plan_t, make_plan
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_provenance, only: describe_provenance, fact_count, fact_t, gather_facts
    use spintop_reference_kinds, only: reference_auto
    use spintop_reference_motion, only: reference_t, find_reference
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_scene, only: scene_t
    use spintop_stability_plan, only: own_case, scene_of_case, scene_of_trial
    use spintop_status, only: status_name, status_ok
    use spintop_study_column, only: study_column_t
    use spintop_summary, only: summary_t, rounded
    use spintop_table_file, only: table_file_t
    use spintop_table_head, only: table_head
    use spintop_text, only: string_t, to_text
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: run_trial, trial_t
    use spintop_verdict, only: explain_trial, judge_trial, verdict_meaning, verdict_names, verdict_unsuitable
    implicit none
    private
    public :: run_stability, stability_columns

    !> The columns, in the order of the table.
    type(study_column_t), parameter :: stability_columns(*) = [ &
        study_column_t('case', '', 'case of the catalogue'), &
        study_column_t('method', '', 'method'), &
        study_column_t('formulation', '', 'formulation of the equations of motion'), &
        study_column_t('verdict', '', 'verdict on the computed motion'), &
        study_column_t('orientation_error', 'rad', 'largest rotation angle from the reference attitude'), &
        study_column_t('tip_error', '', 'largest distance of the axis tip from that of the reference'), &
        study_column_t('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)'), &
        study_column_t('lz_error', '', 'largest error of the vertical momentum, over its scale'), &
        study_column_t('l3_error', '', 'largest error of the momentum about body z, over the same scale'), &
        study_column_t('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion'), &
        study_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data'), &
        study_column_t('steps', '', 'steps'), &
        study_column_t('rejected', '', 'rejected steps'), &
        study_column_t('evaluations', '', 'RHS evaluations'), &
        study_column_t('time_s', 's', 'computing time'), &
        study_column_t('status', '', 'status of the run'), &
        study_column_t('t', 's', 'time reached'), &
        study_column_t('upright_growth', '1/s', 'largest growth rate of the top sleeping upright with this spin'), &
        study_column_t('lyapunov_exponent', '1/s', 'mean growth rate of perturbations over the span'), &
        study_column_t('reference', '', 'reference of the comparison'), &
        study_column_t('reference_error', 'rad', 'difference between two computations of the reference'), &
        study_column_t('reason', '', 'reason of the verdict')]

    !> What is said of a case whatever the method.
    type :: case_facts_t
        character(24) :: name = ''
        type(case_t) :: case
        type(reference_t) :: reference
        !> Growth rates, 1/s; not a number where there is none.
        real(dp) :: upright_growth = 0, lyapunov_exponent = 0
    end type case_facts_t

    integer, parameter :: no_verdict = 0
    !> Times at which a motion is compared; the steps of the catalogue are multiples of the intervals.
    integer, parameter :: samples = 41

contains

    !> Runs the study and writes its table.
    subroutine run_stability(job, options, summary, error)
        type(job_t), intent(inout) :: job
        type(options_t), intent(in) :: options
        type(summary_t), intent(out) :: summary
        type(error_t), allocatable, intent(out) :: error
        type(table_file_t) :: file
        type(progress_t) :: progress
        type(fact_t) :: facts(fact_count)
        type(string_t), allocatable :: input(:), header(:)
        type(string_t) :: no_trailer(0)
        integer :: verdicts(size(job%stability%methods), size(verdict_names))
        integer :: i
        real(dp) :: began

        began = seconds()
        verdicts = 0
        call print_namelist(job%table, input)
        call gather_facts(job%scene%title, 'those of the column formulation', 'those of the column method', &
                          dated=.true., facts=facts)
        call describe_provenance(facts, input, stability_columns%name, stability_columns%unit, &
                                 stability_columns%what, header)
        call explain_verdicts(header)
        call file%create(job%output, table_head(header, stability_columns%name), error)
        if (allocated(error)) return
        associate (plan => job%stability)
            call progress%start(job%name, 'trials', size(plan%cases, kind=int64) * size(plan%methods), &
                                options%quiet, options%progress)
            do i = 1, size(plan%cases)
                call run_case(job, i, file, progress, verdicts, error)
                if (allocated(error)) exit
            end do
        end associate
        call progress%finish()
        if (.not. allocated(error)) call file%finish(no_trailer, error)
        if (allocated(error)) then
            call file%discard()
            return
        end if
        call summarize(job, verdicts, seconds() - began, summary)
    end subroutine run_stability

    !> Says in the head of the table what its verdicts mean.
    subroutine explain_verdicts(header)
        type(string_t), allocatable, intent(inout) :: header(:)
        type(string_t) :: line
        integer :: k
        do k = 1, size(verdict_names)
            line%text = 'verdict ' // trim(verdict_names(k)) // ': ' // verdict_meaning(k)
            header = [header, line]
        end do
    end subroutine explain_verdicts

    !> All methods on case number i of the plan.
    subroutine run_case(job, i, file, progress, verdicts, error)
        type(job_t), intent(in) :: job
        integer, intent(in) :: i
        type(table_file_t), intent(inout) :: file
        type(progress_t), intent(inout) :: progress
        integer, intent(inout) :: verdicts(:, :)
        type(error_t), allocatable, intent(out) :: error
        type(scene_t), allocatable :: scene
        type(case_facts_t), allocatable :: facts
        type(text_buffer_t) :: row
        character(40) :: tried(size(job%stability%methods))
        integer :: k, verdict

        allocate (scene, facts)
        facts%name = own_case
        if (job%stability%cases(i) > 0) facts%name = hard_cases(job%stability%cases(i))%name
        call scene_of_case(job%scene, job%stability%cases(i), scene, error)
        if (.not. allocated(error)) call find_facts(scene, facts, error)
        if (allocated(error)) return
        tried = ''
        do k = 1, size(job%stability%methods)
            call row%clear()
            call run_method(job, scene, facts, k, tried, row, verdict)
            if (verdict == no_verdict) cycle
            verdicts(k, verdict) = verdicts(k, verdict) + 1
            call file%put(row%contents(), error)
            if (allocated(error)) return
            call progress%update((i - 1) * size(job%stability%methods, kind=int64) + k)
        end do
    end subroutine run_case

    !> The case of a scene, what it is compared with, and how deviations from it grow.
    subroutine find_facts(scene, facts, error)
        type(scene_t), intent(in) :: scene
        type(case_facts_t), intent(inout) :: facts
        type(error_t), allocatable, intent(out) :: error
        type(problems_t) :: problems
        type(motion_t) :: sleeping
        complex(dp) :: eigenvalues(6)
        real(dp) :: exponents(1)
        integer :: status

        call make_case(scene, facts%case, problems)
        if (problems%any()) then
            error = internal_error('stability: case ' // trim(facts%name) // ': ' // problems%first())
            return
        end if
        associate (case => facts%case)
            call find_reference(case, samples, reference_auto, int(scene%max_steps, int64), facts%reference, status)
            if (status /= status_ok) then
                error = error_t(exit_failed, 'stability: case ' // trim(facts%name) // ' has no reference: ' &
                                // status_name(status))
                return
            end if
            facts%upright_growth = ieee_value(0.0_dp, ieee_quiet_nan)
            if (case%body%is_lagrange()) then
                sleeping = motion_from_quaternion(0.0_dp, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], &
                                                  [0.0_dp, 0.0_dp, case%start%omega(3)], case%start%angle)
                call find_equilibrium_eigenvalues(case%body, sleeping, eigenvalues, status)
                if (status == status_ok) facts%upright_growth = maxval(real(eigenvalues, dp))
            end if
            facts%lyapunov_exponent = ieee_value(0.0_dp, ieee_quiet_nan)
            call find_lyapunov(case%body, case%start, case%t_end, exponents, status, &
                               max_steps=min(scene%max_steps, huge(1) - 1))
            if (status == status_ok) facts%lyapunov_exponent = exponents(1)
        end associate
    end subroutine find_facts

    !> One method on a case, as a row. There is none, and no verdict, for what was tried already or
    !> would be compared with itself.
    subroutine run_method(job, case_scene, facts, k, tried, row, verdict)
        type(job_t), intent(in) :: job
        type(scene_t), intent(in) :: case_scene
        type(case_facts_t), intent(in) :: facts
        integer, intent(in) :: k
        character(*), intent(inout) :: tried(:) !! methods with their formulations
        type(text_buffer_t), intent(inout) :: row
        integer, intent(out) :: verdict
        type(scene_t) :: scene
        type(plan_t) :: plan
        type(problems_t) :: problems
        type(trial_t) :: trial
        character(16) :: formulation
        character(:), allocatable :: reason, ending
        real(dp) :: floor

        floor = maxval(facts%reference%floor)
        scene = case_scene
        associate (choice => job%stability%methods(k))
            call scene_of_trial(job%scene, scene, choice)
            call make_plan(scene, facts%case, plan, problems)
            formulation = choice%formulation
            if (allocated(plan%formulation)) formulation = plan%model(:index(plan%model, ':') - 1)
            verdict = no_verdict
            if (facts%reference%is_computed .and. choice%method%needs == structure_quadruple) return
            tried(k) = trim(choice%method%name) // '/' // formulation
            if (any(tried(:k - 1) == tried(k))) return
            if (problems%any()) then
                verdict = verdict_unsuitable
                reason = problems%first()
                ending = verdict_names(verdict)
            else
                call run_trial(facts%case, plan, facts%reference, trial)
                verdict = judge_trial(trial, floor)
                reason = explain_trial(trial, verdict)
                ending = status_name(trial%status)
            end if
            call row%put_text(facts%name)
            call row%put_text(choice%method%name)
        end associate
        call row%put_text(formulation)
        call row%put_text(verdict_names(verdict))
        associate (errors => trial%errors, counts => trial%counts)
            call row%put_reals([errors%orientation, errors%tip, errors%energy, errors%vertical, &
                                errors%axial, errors%quaternion, floor])
            call row%put_integer(counts%steps)
            call row%put_integer(counts%rejected)
            call row%put_integer(counts%evaluations)
        end associate
        call row%put_reals([trial%time])
        call row%put_text(trim(ending))
        call row%put_reals([trial%t, facts%upright_growth, facts%lyapunov_exponent])
        call row%put_text(facts%reference%source)
        call row%put_reals([facts%reference%uncertainty])
        call row%put_text(reason)
        call row%end_row()
    end subroutine run_method

    !> What each method has done, in a line.
    subroutine summarize(job, verdicts, time, summary)
        type(job_t), intent(in) :: job
        integer, intent(in) :: verdicts(:, :)
        real(dp), intent(in) :: time
        type(summary_t), intent(inout) :: summary
        character(36) :: name
        integer :: k

        call summary%headline(job%input // ': stability of ' // to_text(size(verdicts, 1)) // ' methods on ' &
                              // to_text(size(job%stability%cases)) // ' cases -> ' // job%output)
        do k = 1, size(verdict_names)
            call summary%add(verdict_names(k), verdict_meaning(k))
        end do
        do k = 1, size(verdicts, 1)
            associate (choice => job%stability%methods(k))
                name = choice%method%name
                if (choice%formulation /= 'auto') name = trim(name) // '/' // choice%formulation
            end associate
            call summary%add('', name // counts_of(verdicts(k, :)))
        end do
        call summary%add('time', rounded(time) // ' s')
    end subroutine summarize

    !> How often each verdict was given.
    function counts_of(verdicts) result(text)
        integer, intent(in) :: verdicts(:)
        character(:), allocatable :: text
        integer :: k
        text = ''
        do k = 1, size(verdicts)
            if (verdicts(k) == 0) cycle
            if (text /= '') text = text // ', '
            text = text // to_text(verdicts(k)) // ' ' // trim(verdict_names(k))
        end do
    end function counts_of

end module spintop_stability
