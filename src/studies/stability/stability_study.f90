!> The stability study: every method on motions that are difficult to integrate.
!>
!> Every method runs every case. The motion is compared with the exact solution, or with a motion in quadruple
!> precision. One row per case and method contains the errors, the drifts of the invariants, the cost and a
!> verdict.
module spintop_stability_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t, make_case
    use spintop_clock, only: seconds
    use spintop_dealt_rows, only: compare_with_writer, row_source_t, write_dealt
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, internal_error
    use spintop_exit_codes, only: exit_failed, exit_ok
    use spintop_formulation, only: structure_quadruple
    use spintop_hard_cases, only: hard_cases
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_lyapunov, only: find_lyapunov
    use spintop_compared_methods, only: method_choice_t
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_options, only: options_t
    use spintop_plan, only: plan_t
    use spintop_planning, only: make_plan
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_ranks, only: ranks_t
    use spintop_scene_words, only: kind_stability, reference_auto, study_kinds
    use spintop_reference_motion, only: reference_t, find_reference
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_scene_keys, only: scene_t
    use spintop_stability_columns, only: add_row, stability_row_t, stability_columns
    use spintop_stability_plan, only: make_stability_plan, own_case, scene_of_case, scene_of_trial, stability_plan_t
    use spintop_status, only: is_ok, last_status, status_meaning, status_ok
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_study_head, only: study_head
    use spintop_summary, only: summary_t, rounded
    use spintop_table_file, only: table_file_t
    use spintop_text, only: string_t, to_text
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: errors_t, run_trial, trial_t
    use spintop_verdict, only: explain_trial, judge_trial, verdict_meaning, verdict_names, verdict_no_reference, verdict_unsuitable
    implicit none
    private
    public :: stability_study_t

    !> Methods on motions that are difficult to integrate.
    type, extends(study_t) :: stability_study_t
        private
        type(stability_plan_t) :: plan
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: cases
        procedure :: check
        procedure :: explain
        procedure :: run
    end type stability_study_t

    !> Quantities of a case that do not depend on the method.
    type :: case_facts_t
        character(24) :: name = ''
        type(case_t) :: case
        type(reference_t) :: reference
        !> How the reference ended; without it no method is tried.
        integer :: status = status_ok
        !> Growth rates, 1/s; NaN if they do not exist.
        real(dp) :: upright_growth = 0, lyapunov_exponent = 0
    end type case_facts_t

    !> The cases of a study, each with a row for each of its methods.
    type, extends(row_source_t) :: case_rows_t
        type(job_t), pointer :: job => null()
        type(stability_plan_t) :: plan
        type(progress_t) :: progress
        !> Number of trials done, and how often each method has each verdict.
        integer(int64) :: trials = 0
        integer(int64), allocatable :: verdicts(:, :)
        !> Number of runs with each status, and of cases without a reference, or on which every run failed.
        integer(int64) :: ends(0:last_status) = 0, failed_cases(1) = 0
    contains
        procedure :: make => make_case_rows
    end type case_rows_t

    !> Fewest and most intervals between the times at which a motion is compared, as far as the steps allow it.
    integer, parameter :: fewest_intervals = 40, most_intervals = 1000

contains

    !> Properties of stability studies.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_stability)), 'a stability study', 'stability studies', '', &
                            'methods on a catalogue of hard motions, with a verdict on each', has_parts=.true., &
                            shares_ranks=.true., has_case=.false.)
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        columns = stability_columns
    end function columns

    !> Number of cases.
    integer(int64) function cases(self, job)
        class(stability_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        cases = size(self%plan%cases)
    end function cases

    !> Finds the cases and the methods; checks the case of the input if it is one of them.
    subroutine check(self, job, problems, diagnostics)
        class(stability_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scene_t), allocatable :: scene

        call make_stability_plan(job%input%scene, self%plan, problems)
        if (problems%any() .or. all(self%plan%cases > 0)) return
        call job%make_first_case(scene, problems, planned=.false.)
    end subroutine check

    !> Number of methods and cases.
    function explain(self, job) result(phrase)
        class(stability_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        phrase = 'the stability of ' // to_text(size(self%plan%methods)) // ' methods on ' &
                 // to_text(size(self%plan%cases)) // ' cases'
    end function explain

    !> Runs all methods on all cases, or on those of a part, in all ranks, and writes the table. Only the writer has a summary.
    !> A failed run is a result, not a failure of the study, unless every run on a case failed.
    subroutine run(self, job, options, summary, code, error)
        class(stability_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_file_t) :: file
        type(string_t) :: no_lines(0)
        type(case_rows_t) :: source
        character(:), allocatable :: head, part
        integer(int64) :: all, first, last
        real(dp) :: began

        began = seconds()
        code = exit_ok
        all = self%cases(job)
        first = options%shard%first(all)
        last = options%shard%last(all)
        part = options%shard%beginning(all)
        head = study_head(job, stability_columns, verdicts_in_words(), part)
        call compare_with_writer(options%ranks, head, error)
        if (allocated(error)) return
        if (options%ranks%is_writer()) call file%create(job%files%table, head, error)
        call options%ranks%agree(error)
        if (allocated(error)) return
        source%job => job
        source%plan = self%plan
        allocate (source%verdicts(size(self%plan%methods), size(verdict_names)), source=0_int64)
        if (options%ranks%is_writer()) then
            call source%progress%start(job%name, 'trials', (last - first + 1) * size(self%plan%methods) / options%ranks%count, &
                                       options%quiet, options%progress)
        end if
        call write_dealt(source, first, last, options%ranks, file, error)
        if (.not. allocated(error)) then
            call sum_over_ranks(options%ranks, size(source%verdicts), source%verdicts)
            call sum_over_ranks(options%ranks, size(source%ends), source%ends)
            call sum_over_ranks(options%ranks, size(source%failed_cases), source%failed_cases)
        end if
        if (options%ranks%is_writer()) then
            call source%progress%finish()
            if (.not. allocated(error)) call file%finish(no_lines, error)
            if (allocated(error)) call file%discard()
        end if
        if (allocated(error) .or. .not. options%ranks%is_writer()) return
        call summarize(job, last - first + 1, self%plan, source%verdicts, seconds() - began, summary)
        if (part /= '') call summary%add('shard', part)
        call summary%add_failures('runs', source%ends)
        if (source%failed_cases(1) > 0) code = exit_failed
    end subroutine run

    !> Sums numbers over all ranks; the writer gets the sums.
    subroutine sum_over_ranks(ranks, count, numbers)
        type(ranks_t), intent(in) :: ranks
        integer, intent(in) :: count
        integer(int64), intent(inout) :: numbers(count)
        real(dp) :: values(count)
        values = real(numbers, dp)
        call ranks%reduce(values)
        numbers = nint(values, int64)
    end subroutine sum_over_ranks

    !> The meanings of the verdicts, for the header of the table.
    function verdicts_in_words() result(lines)
        type(string_t) :: lines(size(verdict_names))
        integer :: k
        do k = 1, size(lines)
            lines(k)%text = 'verdict ' // trim(verdict_names(k)) // ': ' // verdict_meaning(k)
        end do
    end function verdicts_in_words

    !> Runs all methods on case `number` of the plan.
    subroutine make_case_rows(self, number, rows, error)
        class(case_rows_t), intent(inout) :: self
        integer(int64), intent(in) :: number
        character(:), allocatable, intent(out) :: rows
        type(error_t), allocatable, intent(out) :: error
        type(scene_t), allocatable :: scene
        type(case_facts_t), allocatable :: facts
        type(stability_row_t) :: row
        type(text_buffer_t) :: cells
        character(40) :: tried(size(self%plan%methods))
        logical :: is_new, has_run, has_end
        integer :: place, k

        rows = ''
        allocate (scene, facts)
        place = self%plan%cases(number)
        facts%name = own_case
        if (place > 0) facts%name = hard_cases(place)%name
        call scene_of_case(self%job%input%scene, place, scene, error)
        if (.not. allocated(error)) call find_facts(scene, facts, error)
        if (allocated(error)) return
        tried = ''
        has_run = .not. is_ok(facts%status)
        has_end = .false.
        do k = 1, size(self%plan%methods)
            call run_method(self%job, self%plan%methods(k), scene, facts, tried(:k), row, is_new)
            self%trials = self%trials + 1
            if (.not. is_new) cycle
            self%verdicts(k, row%verdict) = self%verdicts(k, row%verdict) + 1
            if (row%verdict /= verdict_unsuitable .and. is_ok(facts%status)) then
                self%ends(row%trial%status) = self%ends(row%trial%status) + 1
                has_run = .true.
                has_end = has_end .or. is_ok(row%trial%status)
            end if
            call add_row(row, cells)
            call self%progress%update(self%trials)
        end do
        rows = cells%contents()
        if (has_run .and. .not. has_end) self%failed_cases = self%failed_cases + 1
    end subroutine make_case_rows

    !> Number of intervals between the times at which a motion is compared: these are steps of fixed size, all of them if they
    !> are not too many.
    pure integer function intervals_of(steps) result(intervals)
        integer, intent(in) :: steps
        do intervals = min(steps, most_intervals), fewest_intervals, -1
            if (mod(steps, intervals) == 0) return
        end do
        intervals = steps
    end function intervals_of

    !> The case of a scene, its reference, and the growth rates of its perturbations.
    subroutine find_facts(scene, facts, error)
        type(scene_t), intent(in) :: scene
        type(case_facts_t), intent(inout) :: facts
        type(error_t), allocatable, intent(out) :: error
        type(problems_t) :: problems
        type(motion_t) :: sleeping
        complex(dp) :: eigenvalues(6)
        real(dp) :: exponent
        integer :: status

        call make_case(scene, facts%case, problems)
        if (problems%any()) then
            error = internal_error('stability: case ' // trim(facts%name) // ': ' // problems%first())
            return
        end if
        associate (case => facts%case)
            call find_reference(case, 1 + intervals_of(scene%steps), reference_auto, &
                                int(scene%max_steps, int64), facts%reference, facts%status)
            facts%upright_growth = no_number
            if (case%body%is_lagrange()) then
                sleeping = motion_from_quaternion(0.0_dp, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], &
                                                  [0.0_dp, 0.0_dp, case%start%omega(3)], case%start%angle)
                call find_equilibrium_eigenvalues(case%body, sleeping, eigenvalues, status)
                if (is_ok(status)) facts%upright_growth = maxval(real(eigenvalues, dp))
            end if
            facts%lyapunov_exponent = no_number
            call find_lyapunov(case%body, case%start, case%t_end, exponent, status, &
                               max_steps=min(scene%max_steps, huge(1) - 1))
            if (is_ok(status)) facts%lyapunov_exponent = exponent
        end associate
    end subroutine find_facts

    !> One method on a case. There is no row for a combination that was run already, or that would be compared with
    !> itself.
    subroutine run_method(job, choice, case_scene, facts, tried, row, is_new)
        type(job_t), intent(in) :: job
        type(method_choice_t), intent(in) :: choice
        type(scene_t), intent(in) :: case_scene
        type(case_facts_t), intent(in) :: facts
        character(*), intent(inout) :: tried(:) !! methods with their formulations, up to this one
        type(stability_row_t), intent(out) :: row
        logical, intent(out) :: is_new !! whether there is a row
        type(scene_t), allocatable :: scene
        type(plan_t) :: plan
        type(problems_t) :: problems
        integer :: k

        is_new = .false.
        scene = case_scene
        call scene_of_trial(job%input%scene, scene, choice)
        call make_plan(scene, facts%case, plan, problems)
        call begin_row(facts, row)
        row%method = choice%method%name
        row%formulation = choice%formulation
        if (allocated(plan%formulation)) row%formulation = plan%formulation_name()
        if (facts%reference%is_computed .and. choice%method%needs == structure_quadruple) return
        k = size(tried)
        tried(k) = trim(row%method) // '/' // row%formulation
        if (any(tried(:k - 1) == tried(k))) return
        is_new = .true.
        if (problems%any()) then
            row%verdict = verdict_unsuitable
            row%trial = no_trial()
            row%reason = problems%first()
        else if (.not. is_ok(facts%status)) then
            row%verdict = verdict_no_reference
            row%trial = no_trial()
            row%trial%status = facts%status
            row%reason = 'no reference: ' // status_meaning(facts%status)
        else
            call run_trial(facts%case, plan, facts%reference, row%trial)
            row%verdict = judge_trial(row%trial, row%inherent_error, row%reference_error)
            row%reason = explain_trial(row%trial, row%verdict)
        end if
    end subroutine run_method

    !> What the rows of a case have in common.
    subroutine begin_row(facts, row)
        type(case_facts_t), intent(in) :: facts
        type(stability_row_t), intent(inout) :: row
        row%case = facts%name
        if (is_ok(facts%status)) row%inherent_error = maxval(facts%reference%floor)
        row%upright_growth = facts%upright_growth
        row%lyapunov_exponent = facts%lyapunov_exponent
        row%reference = facts%reference%source
        row%reference_error = facts%reference%uncertainty
    end subroutine begin_row

    !> The trial of a method that was not run: it has no errors, no computing time and no end.
    pure type(trial_t) function no_trial() result(trial)
        trial%errors = errors_t(no_number, no_number, no_number, no_number, no_number, no_number)
        trial%time = no_number
        trial%t = no_number
    end function no_trial

    !> The results of each method in one line.
    subroutine summarize(job, cases, plan, verdicts, time, summary)
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: cases
        type(stability_plan_t), intent(in) :: plan
        integer(int64), intent(in) :: verdicts(:, :)
        real(dp), intent(in) :: time
        type(summary_t), intent(inout) :: summary
        character(36) :: name
        integer :: k

        call summary%headline(job%input%path // ': stability of ' // to_text(size(verdicts, 1)) // ' methods on ' &
                              // to_text(cases) // ' cases -> ' // job%files%table)
        do k = 1, size(verdict_names)
            if (k == verdict_no_reference .and. all(verdicts(:, k) == 0)) cycle
            call summary%add(verdict_names(k), verdict_meaning(k))
        end do
        do k = 1, size(verdicts, 1)
            associate (choice => plan%methods(k))
                name = choice%method%name
                if (choice%formulation /= 'auto') name = trim(name) // '/' // choice%formulation
            end associate
            call summary%add('', name // counts_of(verdicts(k, :)))
        end do
        call summary%add('time', rounded(time) // ' s')
    end subroutine summarize

    !> The number of occurrences of each verdict.
    function counts_of(verdicts) result(text)
        integer(int64), intent(in) :: verdicts(:)
        character(:), allocatable :: text
        integer :: k
        text = ''
        do k = 1, size(verdicts)
            if (verdicts(k) == 0) cycle
            if (text /= '') text = text // ', '
            text = text // to_text(verdicts(k)) // ' ' // trim(verdict_names(k))
        end do
    end function counts_of

end module spintop_stability_study
