!> The work-precision study: the cost of each method for each accuracy, on a given problem and machine.
!>
!> Every method runs with each of its settings. The motion is compared with a reference at equally spaced
!> times; a run to the end of the span without comparisons is timed. Rows are sorted by time. Swept parameters
!> make several problems of one input.
module spintop_precision_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t, make_case
    use spintop_clock, only: seconds
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_failed, exit_ok
    use spintop_formulation, only: structure_quadruple
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_options, only: options_t
    use spintop_plan, only: plan_t
    use spintop_planning, only: make_plan
    use spintop_precision_columns, only: mark_front, precision_columns, precision_row_t, precision_view_t, add_row, sort_rows
    use spintop_precision_plan, only: make_precision_plan, precision_plan_t, read_reference, set_setting
    use spintop_precision_summary, only: auto_tally_t, summarize_problem
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_reference_motion, only: check_reference, find_reference, reference_t
    use spintop_scene_keys, only: scene_t
    use spintop_scene_words, only: kind_precision, study_kinds
    use spintop_status, only: is_ok, last_status, status_meaning, status_ok
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_study_head, only: study_head
    use spintop_summary, only: summary_t, rounded
    use spintop_case_scene, only: case_scene_t
    use spintop_table_file, only: table_file_t
    use spintop_text, only: escaped, string_t, to_text
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trial, only: run_trial
    use spintop_trial_time, only: time_trial
    implicit none
    private
    public :: precision_study_t

    !> Methods and settings on one problem, or on each problem of the axes.
    type, extends(study_t) :: precision_study_t
        private
        type(precision_plan_t) :: plan
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: cases
        procedure :: check
        procedure :: explain
        procedure :: run
    end type precision_study_t

    !> Maximum number of problems that the summary describes one by one.
    integer, parameter :: most_told = 4

contains

    !> Properties of work-precision studies.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_precision)), 'a work-precision study', 'work-precision studies', &
                            ', before the swept parameters', &
                            'error of each method and setting, against time and RHS evaluations', takes_axes=.true., &
                            has_parts=.true.)
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        columns = precision_columns
    end function columns

    !> Number of problems: one, or the cases of the axes.
    integer(int64) function cases(self, job)
        class(precision_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        cases = max(1_int64, job%axes%cases)
    end function cases

    !> Makes the first problem, the methods and their settings.
    subroutine check(self, job, problems, diagnostics)
        class(precision_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scene_t), allocatable :: first

        if (job%names_axes()) then
            call job%make_axes(problems, diagnostics)
            if (job%axes%cases == 0) return
        end if
        call job%make_first_case(first, problems, planned=.false.)
        if (.not. allocated(first)) return
        call make_precision_plan(first, self%plan, problems)
        if (problems%any()) return
        call read_reference(job%input%path, job%input%scene, job%case, self%plan, problems, diagnostics)
        if (.not. job%names_axes()) return
        if (allocated(self%plan%stored)) then
            call problems%add('work_precision.reference', 'a stored motion cannot be the reference of several cases', &
                              "use reference = 'auto'")
        end if
        call job%warn_of_bodies(problems)
    end subroutine check

    !> Number of trials of a problem.
    function explain(self, job) result(phrase)
        class(precision_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        phrase = 'errors and costs of ' // to_text(sum(self%plan%settings(self%plan%choices))) &
                 // ' methods and settings'
    end function explain

    !> Runs all trials, or those of a part, and writes the table; the study fails if no run on a problem reaches the
    !> end, as where the problem has no reference.
    subroutine run(self, job, options, summary, code, error)
        class(precision_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(case_scene_t), allocatable, target :: swept
        type(table_file_t) :: file
        type(progress_t) :: progress
        type(auto_tally_t) :: tally
        type(string_t), allocatable :: words(:)
        real(dp), allocatable :: values(:)
        real(dp) :: began
        integer(int64) :: first, last, k, trials
        integer(int64) :: ends(0:last_status)
        integer :: failures

        began = seconds()
        code = exit_ok
        failures = 0
        ends = 0
        first = options%shard%first(self%cases(job))
        last = options%shard%last(self%cases(job))
        call begin_table(job, options%shard%beginning(self%cases(job)), file, error)
        if (allocated(error)) return
        allocate (swept)
        call swept%copy(job%input%scene, job%axes)
        allocate (values(size(job%axes%axis)))
        trials = sum(self%plan%settings(self%plan%choices))
        call progress%start(job%name, 'trials', trials * last, options%quiet, options%progress, before=trials * (first - 1))
        call summary%headline('')
        do k = first, last
            if (size(values) > 0) values = job%axes%values_of(k)
            call swept%set_values(values)
            call run_problem(job, self%plan, swept%scene, name_of_problem(job, k), values, trials * (k - 1), file, &
                             progress, ends, failures, tally, summary, error)
            if (allocated(error)) exit
        end do
        call progress%finish()
        call summary%add_failures('runs', ends)
        words = in_words(summary)
        if (self%cases(job) > 1) call tally%summarize(summary)
        if (.not. allocated(error)) call file%finish(words, error)
        if (allocated(error)) then
            call file%discard()
            deallocate (summary%lines)
            return
        end if
        if (failures > 0) code = exit_failed
        summary%lines(1)%text = escaped(job%input%path // ': work-precision study, ' // to_text(sum(ends)) // ' rows -> ' // &
                                         job%files%table)
        if (options%shard%is_part()) call summary%add('shard', options%shard%line(self%cases(job)))
        call summary%add('time', rounded(seconds() - began) // ' s')
    end subroutine run

    !> The lines of a summary after its headline, for the end of the table.
    function in_words(summary) result(lines)
        type(summary_t), intent(in) :: summary
        type(string_t), allocatable :: lines(:)
        integer :: i
        allocate (lines(size(summary%lines) - 1))
        do i = 1, size(lines)
            lines(i)%text = 'in words: ' // summary%sentence(i + 1)
        end do
    end function in_words

    !> Starts the table: after its columns those of the swept parameters.
    subroutine begin_table(job, part, file, error)
        type(job_t), intent(in) :: job
        character(*), intent(in) :: part !! first line of the table of a part
        type(table_file_t), intent(inout) :: file
        type(error_t), allocatable, intent(out) :: error
        integer :: i
        call file%create(job%files%table, study_head(job, [precision_columns%column_t, &
            (job%axis_column(i), i=1, size(job%axes%axis))], part=part), error)
    end subroutine begin_table

    !> The input, with the number of the case if there are several.
    function name_of_problem(job, k) result(name)
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: k
        character(:), allocatable :: name
        name = job%name
        if (job%axes%cases > 0) name = name // '.' // to_text(k)
    end function name_of_problem

    !> Runs all methods on the problem of a scene.
    subroutine run_problem(job, study, scene, name, values, done, file, progress, ends, failures, tally, &
                           summary, error)
        type(job_t), intent(in) :: job
        type(precision_plan_t), intent(in) :: study !! methods and settings
        type(scene_t), intent(in) :: scene
        character(*), intent(in) :: name
        real(dp), intent(in) :: values(:) !! of the swept parameters
        integer(int64), intent(in) :: done !! number of earlier trials
        type(table_file_t), intent(inout) :: file
        type(progress_t), intent(inout) :: progress
        integer(int64), intent(inout) :: ends(0:last_status) !! number of runs with each status
        integer, intent(inout) :: failures !! number of problems on which no run reached the end
        type(auto_tally_t), intent(inout) :: tally
        type(summary_t), intent(inout) :: summary
        type(error_t), allocatable, intent(out) :: error
        type(case_t) :: case
        type(reference_t) :: reference
        type(precision_row_t), allocatable :: results(:)
        type(problems_t) :: problems
        type(precision_view_t) :: view
        type(auto_tally_t) :: own_tally
        type(text_buffer_t) :: text
        integer :: i, status

        call make_case(scene, case, problems)
        if (problems%any()) then
            call give_up('is omitted: ' // problems%first())
            return
        end if
        call prepare_reference(study, scene, case, reference, status)
        if (.not. is_ok(status)) then
            call give_up('has no reference: ' // status_meaning(status))
            return
        end if
        call run_methods(study, scene, case, reference, done, progress, results, summary)
        if (size(results) == 0) then
            call give_up('has no rows: every method is omitted')
            return
        end if
        call sort_rows(results)
        call mark_front(results)
        view%problem = name
        view%reference = reference
        do i = 1, size(results)
            call view%set_row(results(i))
            call add_row(view, values, text)
        end do
        call file%append(text%contents(), error)
        do i = 1, size(results)
            status = results(i)%trial%status
            ends(status) = ends(status) + 1
        end do
        if (.not. any(is_ok(results%trial%status))) failures = failures + 1
        call tally%compare(name, results)
        if (job%axes%cases > most_told) return
        call summarize_problem(name, results, reference, summary)
        call own_tally%compare(name, results)
        call own_tally%summarize(summary)

    contains

        !> Records that the problem has no rows.
        subroutine give_up(why)
            character(*), intent(in) :: why
            failures = failures + 1
            call summary%add('problem', name // ' ' // why)
        end subroutine give_up

    end subroutine run_problem

    !> The reference of a case.
    subroutine prepare_reference(study, scene, case, reference, status)
        type(precision_plan_t), intent(in) :: study !! methods and settings
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(reference_t), intent(out) :: reference
        integer, intent(out) :: status
        if (allocated(study%stored)) then
            reference = study%stored
            status = status_ok
        else
            call find_reference(case, study%samples, study%reference, int(scene%max_steps, int64), reference, status)
        end if
        if (is_ok(status)) call check_reference(case, int(scene%max_steps, int64), reference)
    end subroutine prepare_reference

    !> Computes a row for each method and setting.
    subroutine run_methods(study, scene, case, reference, done, progress, rows, summary)
        type(precision_plan_t), intent(in) :: study !! methods and settings
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(reference_t), intent(in) :: reference
        integer(int64), intent(in) :: done
        type(progress_t), intent(inout) :: progress
        type(precision_row_t), allocatable, intent(out) :: rows(:)
        type(summary_t), intent(inout) :: summary
        character(40) :: tried(size(study%choices))
        type(precision_row_t) :: row
        character(:), allocatable :: refusal, last_refusal
        integer(int64) :: tries
        integer :: i, k, n

        allocate (rows(sum(study%settings(study%choices))))
        n = 0
        tries = 0
        tried = ''
        do i = 1, size(study%choices)
            last_refusal = ''
            do k = 1, study%settings(study%choices(i))
                tries = tries + 1
                call run_setting(study, scene, case, reference, i, k, tried, row, refusal)
                if (refusal == '') then
                    n = n + 1
                    rows(n) = row
                else if (refusal /= last_refusal .and. done == 0) then
                    call summary%add('omitted', refusal)
                end if
                last_refusal = refusal
                call progress%update(done + tries)
            end do
        end do
        rows = rows(:n)
    end subroutine run_methods

    !> One method with one setting, or the reason why there is no row.
    subroutine run_setting(study, scene, case, reference, i, k, tried, row, refusal)
        type(precision_plan_t), intent(in) :: study !! methods and settings
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(reference_t), intent(in) :: reference
        integer, intent(in) :: i, k !! numbers of the method and of its setting
        character(*), intent(inout) :: tried(:) !! methods with their formulations
        type(precision_row_t), intent(out) :: row
        character(:), allocatable, intent(out) :: refusal
        type(scene_t), allocatable :: trial_scene
        type(problems_t) :: problems
        type(plan_t) :: plan

        refusal = ''
        allocate (trial_scene, source=scene)
        associate (choice => study%choices(i))
            call set_setting(study, choice, k, trial_scene)
            call make_plan(trial_scene, case, plan, problems)
            row%method = choice%method%name
            row%formulation = choice%formulation
            row%is_stepped = .not. plan%exact
            if (plan%exact) row%formulation = 'closed_form'
            if (allocated(plan%formulation)) row%formulation = plan%formulation_name()
            tried(i) = trim(row%method) // '/' // row%formulation
            if (problems%any()) then
                refusal = trim(tried(i)) // ': ' // problems%first()
            else if (any(tried(:i - 1) == tried(i))) then
                refusal = trim(tried(i)) // ': is already in the table'
            else if (reference%is_computed .and. choice%method%needs == structure_quadruple) then
                refusal = trim(tried(i)) // ': is the reference'
            else if (plan%exact .and. reference%source == 'exact solution') then
                refusal = trim(tried(i)) // ": is the reference; reference = 'quadruple' measures it"
            end if
            if (refusal /= '') return
            row%setting = study%setting_text(choice, k)
            row%is_auto = is_auto(trial_scene, case, plan, study%formulation())
        end associate
        call run_trial(case, plan, reference, row%trial)
        row%time = row%trial%time
        ! Evaluations are counted in the timed run, without the dense output for comparisons.
        if (is_ok(row%trial%status)) call time_trial(case, plan, row%trial%time, study%repeats, row%time, &
                                                           row%trial%counts)
    end subroutine run_setting

    !> Whether a plan is the one that would be selected for the tolerance of a scene with a formulation (or
    !> auto).
    logical function is_auto(scene, case, plan, formulation)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(plan_t), intent(in) :: plan
        character(*), intent(in) :: formulation
        type(scene_t), allocatable :: free_scene
        type(plan_t) :: free_plan
        type(problems_t) :: problems

        is_auto = plan%is_adaptive()
        if (.not. is_auto) return
        allocate (free_scene, source=scene)
        free_scene%method = 'auto'
        free_scene%formulation = formulation
        call make_plan(free_scene, case, free_plan, problems)
        is_auto = free_plan%model == plan%model
        if (is_auto .and. allocated(plan%stepper)) is_auto = free_plan%stepper%info%name == plan%stepper%info%name
    end function is_auto

end module spintop_precision_study
