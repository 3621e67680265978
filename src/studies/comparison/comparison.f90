!> What the studies that compare methods have in common: problems, each with a reference motion, on which every method runs with
!> every setting. A kind of comparison says which problems there are, judges each attempt, and makes rows of them. A method is
!> named `method` or `method/formulation`.
!>
!> Problems do not depend on each other, and are dealt out to the ranks in turn. Their rows are in the order of the problems.
module spintop_comparison
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_arkode, only: arkode_table, arkode_table_t
    use spintop_case, only: case_t
    use spintop_process, only: seconds
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, exit_failed, exit_ok
    use spintop_formulation, only: structure_quadruple, formulation_info_t
    use spintop_formulations, only: formulation_infos
    use spintop_job, only: job_t, compare_with_writer, study_head
    use spintop_kinds, only: dp, no_number
    use spintop_methods, only: method_aliases
    use spintop_namelist, only: read_override
    use spintop_study, only: options_t, study_t
    use spintop_parameters, only: parameter_table_t, is_set, unset, unset_integer
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_ranks, only: ranks_t
    use spintop_trial, only: reference_t, trial_t
    use spintop_row_block, only: text_buffer_t
    use spintop_scene_keys, only: describe_scene, scene_t
    use spintop_status, only: is_ok, last_status, status_ok
    use spintop_stepper, only: method_info_t, project_nothing, projection_names
    use spintop_suggestions, only: own_name
    use spintop_summary, only: rounded, summary_t
    use spintop_journaled_table, only: table_file_t
    use spintop_text, only: split, string_t, did_you_mean, to_text
    implicit none
    private
    public :: comparison_t, problem_t, attempt_t, make_scene_of_settings, method_choice_t, setting_t, add_methods
    public :: find_cases, set_method

    !> A method with a formulation.
    type :: method_choice_t
        type(method_info_t) :: method
        character(16) :: formulation = 'auto'
    end type method_choice_t

    !> A number of steps of fixed size, or a relative tolerance; with neither, the method has its own.
    type :: setting_t
        integer :: steps = unset_integer
        real(dp) :: tolerance = unset
    contains
        procedure :: text => setting_text
    end type setting_t

    !> A motion that methods compute.
    type :: problem_t
        character(:), allocatable :: name
        type(scene_t) :: scene
        type(case_t) :: case
        type(reference_t) :: reference
        !> How the reference ended.
        integer :: status = status_ok
    end type problem_t

    !> A method with a setting on a problem.
    type :: attempt_t
        type(method_choice_t) :: choice
        type(setting_t) :: setting
        !> The number of the choice.
        integer :: number = 0
        !> The formulation that was taken.
        character(16) :: formulation = ''
        !> Why the method cannot run; or a reason that the kind of comparison gives.
        character(:), allocatable :: reason
        !> Whether the same method and formulation came before, and whether it is that of the reference.
        logical :: is_repeated = .false., is_reference = .false.
        !> Whether it becomes a row, and whether the method needs no further settings.
        logical :: is_kept = .false., is_enough = .false.
        !> Whether it is a numerical method, and not the exact solution; whether method = 'auto' selects it for this tolerance;
        !> whether no other is both faster and more accurate.
        logical :: is_stepped = .true., is_auto = .false., is_front = .false.
        type(trial_t) :: trial
        !> Shortest computing time, s.
        real(dp) :: time = no_number
        !> The verdict on it.
        integer :: verdict = 0
        !> Its values of the quantities of the problem, and the largest error of them.
        real(dp), allocatable :: values(:)
        real(dp) :: error = no_number
    contains
        procedure :: name => name_of_attempt
        procedure :: begin_cells
    end type attempt_t

    !> A kind of comparison, with its plan and what it counts.
    type, abstract, extends(study_t) :: comparison_t
        type(method_choice_t), allocatable :: choices(:)
        !> The attempts on the current problem that become rows.
        type(attempt_t), allocatable :: attempts(:)
        !> Number of runs with each status, and of problems on which none succeeded.
        integer(int64) :: ends(0:last_status) = 0, failures = 0
        !> How often each method had each verdict.
        integer(int64), allocatable :: verdicts(:, :)
        !> Lines of the header after the columns, and whether the lines of the summary so far stand below the table.
        type(string_t), allocatable :: remarks(:)
        logical :: ends_in_words = .false.
        type(progress_t) :: progress
        !> Attempts on each problem, as far as they are known, and those done.
        integer(int64) :: attempts_each = 1, done = 0
    contains
        procedure :: run
        procedure :: try_all
        procedure :: count_attempts
        procedure :: count_end
        procedure(settings_i), deferred :: settings
        procedure(compare_i), deferred :: compare
        procedure(judge_i), deferred :: judge
        procedure :: summarize
    end type comparison_t

    abstract interface
        !> The settings of a method on a problem.
        function settings_i(self, choice, problem) result(settings)
            import :: comparison_t, method_choice_t, problem_t, setting_t
            class(comparison_t), intent(in) :: self
            type(method_choice_t), intent(in) :: choice !! method and formulation
            type(problem_t), intent(in) :: problem !! the problem
            type(setting_t), allocatable :: settings(:)
        end function settings_i

        !> Makes a problem, tries all methods on it, and makes its rows as text.
        subroutine compare_i(self, job, number, cells, summary, error)
            import :: comparison_t, job_t, text_buffer_t, summary_t, error_t, int64
            class(comparison_t), intent(inout) :: self
            type(job_t), intent(in) :: job !! the job
            integer(int64), intent(in) :: number !! of the problem
            type(text_buffer_t), intent(inout) :: cells !! the rows are appended; there may be none
            type(summary_t), intent(inout) :: summary !! lines are added
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine compare_i

        !> Runs a planned attempt, and decides whether it becomes a row.
        subroutine judge_i(self, problem, scene, plan, attempt)
            import :: comparison_t, problem_t, scene_t, plan_t, attempt_t
            class(comparison_t), intent(inout) :: self
            type(problem_t), intent(in) :: problem !! the problem
            type(scene_t), intent(in) :: scene !! its scene with the method and the setting
            type(plan_t), intent(inout) :: plan !! the plan of that scene; without errors if the attempt has no reason
            type(attempt_t), intent(inout) :: attempt !! completed by this procedure
        end subroutine judge_i
    end interface

contains

    !> Adds lines on all problems; none unless the kind overrides this.
    subroutine summarize(self, summary)
        class(comparison_t), intent(in) :: self
        type(summary_t), intent(inout) :: summary !! lines are added
    end subroutine summarize

    !> Runs all methods on all problems, or on those of a part, and writes the table. Only the writer has a summary. A failed run
    !> is a result; the study fails if all runs on a problem do, or if it has no reference.
    subroutine run(self, job, options, summary, code, error)
        class(comparison_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_file_t) :: file
        type(ranks_t) :: ranks ! alone, unless they share the problems
        type(string_t), allocatable :: words(:)
        character(:), allocatable :: head
        integer(int64) :: first, last
        integer :: i, axes
        real(dp), allocatable :: counted(:)
        real(dp) :: began

        began = seconds()
        code = exit_ok
        if (self%info%shares_ranks) ranks = options%ranks
        first = options%shard%first(self%count)
        last = options%shard%last(self%count)
        axes = 0
        if (allocated(job%axes%axis)) axes = size(job%axes%axis)
        head = study_head(job, [self%columns%column_t, (job%axis_column(i), i=1, axes)], self%remarks, &
                          options%shard%line(self%count))
        call compare_with_writer(ranks, head, error)
        if (allocated(error)) return
        if (ranks%is_writer()) call file%create(job%files%table, head, error)
        call ranks%agree(error)
        if (allocated(error)) return
        call self%progress%start(job%name, 'trials', (last - first + 1) * self%attempts_each / ranks%count, &
                                 options%quiet .or. .not. ranks%is_writer(), options%progress)
        call summary%headline(job%input%path // ': ' // self%phrase // ' -> ' // job%files%table)
        call write_dealt(self, job, first, last, ranks, file, summary, error)
        if (ranks%count > 1 .and. .not. allocated(error)) then ! the writer gets the sums over all ranks
            if (.not. allocated(self%verdicts)) allocate (self%verdicts(0, 0))
            counted = real([self%failures, self%ends, reshape(self%verdicts, [size(self%verdicts)])], dp)
            call ranks%reduce(counted)
            self%failures = nint(counted(1), int64)
            self%ends = nint(counted(2:size(self%ends) + 1), int64)
            self%verdicts = reshape(nint(counted(size(self%ends) + 2:), int64), shape(self%verdicts))
        end if
        call self%progress%finish()
        call summary%add_failures('runs', self%ends)
        allocate (words(merge(size(summary%lines) - 1, 0, self%ends_in_words)))
        do i = 1, size(words)
            words(i)%text = 'in words: ' // summary%sentence(i + 1)
        end do
        if (ranks%is_writer()) then
            if (.not. allocated(error)) call file%finish(words, error)
            if (allocated(error)) call file%discard()
        end if
        if (allocated(error) .or. .not. ranks%is_writer()) then
            deallocate (summary%lines)
            return
        end if
        call self%summarize(summary)
        if (options%shard%is_part()) call summary%add('shard', options%shard%line(self%count))
        call summary%add('time', rounded(seconds() - began) // ' s')
        if (self%failures > 0) code = exit_failed
    end subroutine run

    !> Tries each method with each of its settings on a problem; `attempts` are those that become rows.
    subroutine try_all(self, problem)
        class(comparison_t), intent(inout) :: self
        type(problem_t), intent(in) :: problem !! the problem
        type(setting_t), allocatable :: settings(:)
        type(scene_t), allocatable :: scene
        type(attempt_t), allocatable :: attempt ! it is large, and a thread may have a small stack
        type(plan_t), allocatable :: plan
        type(problems_t) :: problems
        character(40) :: tried(size(self%choices))
        integer :: i, k

        if (allocated(self%attempts)) deallocate (self%attempts)
        allocate (self%attempts(0))
        tried = ''
        do i = 1, size(self%choices)
            settings = self%settings(self%choices(i), problem)
            do k = 1, size(settings)
                if (allocated(attempt)) deallocate (attempt)
                allocate (attempt)
                attempt%choice = self%choices(i)
                attempt%setting = settings(k)
                attempt%number = i
                if (allocated(plan)) deallocate (plan)
                allocate (plan)
                scene = problem%scene
                call set_method(scene, attempt%choice, attempt%setting)
                problems = problems_t()
                call make_plan(scene, problem%case, plan, problems)
                attempt%reason = problems%first()
                attempt%formulation = attempt%choice%formulation
                attempt%is_stepped = .not. plan%exact
                if (plan%exact) attempt%formulation = 'closed_form'
                if (allocated(plan%formulation)) attempt%formulation = plan%formulation_name()
                attempt%is_reference = problem%reference%is_computed .and. attempt%choice%method%needs == structure_quadruple
                tried(i) = attempt%name()
                attempt%is_repeated = any(tried(:i - 1) == tried(i))
                call self%judge(problem, scene, plan, attempt)
                if (attempt%is_kept) self%attempts = [self%attempts, attempt]
                self%done = self%done + 1
                call self%progress%update(self%done)
                if (attempt%is_enough) exit
            end do
        end do
    end subroutine try_all

    !> Counts the attempts on each problem, where their settings do not depend on it.
    subroutine count_attempts(self)
        class(comparison_t), intent(inout) :: self
        type(problem_t), allocatable :: any_problem ! it is large, and a thread may have a small stack
        type(setting_t), allocatable :: settings(:)
        integer :: i
        allocate (any_problem)
        self%attempts_each = 0
        do i = 1, size(self%choices)
            settings = self%settings(self%choices(i), any_problem)
            self%attempts_each = self%attempts_each + size(settings)
        end do
    end subroutine count_attempts

    !> Method and formulation.
    pure function name_of_attempt(self) result(name)
        class(attempt_t), intent(in) :: self
        character(:), allocatable :: name
        name = trim(self%choice%method%name) // '/' // trim(self%formulation)
    end function name_of_attempt

    !> Adds the cells with which rows begin: the problem, method and formulation.
    subroutine begin_cells(self, problem, cells)
        class(attempt_t), intent(in) :: self
        character(*), intent(in) :: problem !! its name
        type(text_buffer_t), intent(inout) :: cells !! the cells are appended
        call cells%add_text(problem)
        call cells%add_text(self%choice%method%name)
        call cells%add_text(self%formulation)
    end subroutine begin_cells

    !> Counts how the runs on a problem ended; it is a failure if there were some, and none reached the end.
    subroutine count_end(self, ran)
        class(comparison_t), intent(inout) :: self
        logical, intent(in) :: ran(:) !! which of the attempts were run
        integer :: i
        do i = 1, size(ran)
            associate (status => self%attempts(i)%trial%status)
                if (ran(i)) self%ends(status) = self%ends(status) + 1
            end associate
        end do
        if (any(ran) .and. .not. any(ran .and. is_ok(self%attempts%trial%status))) self%failures = self%failures + 1
    end subroutine count_end

    !> The scene of a catalogue: its settings, `group.key=value`, separated by semicolons, are those of an input.
    subroutine make_scene_of_settings(settings, scene, error)
        character(*), intent(in) :: settings !! the settings
        type(scene_t), target, intent(out) :: scene !! the scene
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(parameter_table_t) :: table
        type(diagnostics_t) :: diagnostics
        type(string_t), allocatable :: list(:)
        integer :: i

        call describe_scene(scene, table)
        call split(trim(settings), ';', list)
        do i = 1, size(list)
            call read_override(list(i)%text, table, diagnostics)
        end do
        call diagnostics%raise(error)
    end subroutine make_scene_of_settings

    !> Makes the rows of the problems from `first` to `last`, each in one of the ranks, in turn. All ranks call it. An error in one
    !> of them is that of all.
    subroutine write_dealt(self, job, first, last, ranks, file, summary, error)
        class(comparison_t), intent(inout) :: self
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: first, last !! none if last < first
        type(ranks_t), intent(in) :: ranks
        type(table_file_t), intent(inout) :: file !! the table, which the writer has begun
        type(summary_t), intent(inout) :: summary
        type(error_t), allocatable, intent(out) :: error
        type(string_t), allocatable :: rows(:)
        type(text_buffer_t) :: cells
        integer :: i

        allocate (rows(max(0_int64, last - first + 1)))
        do i = 1, size(rows)
            rows(i)%text = ''
            if (mod(i - 1, ranks%count) /= ranks%number .or. allocated(error)) cycle
            call cells%clear()
            call self%compare(job, first + i - 1, cells, summary, error)
            rows(i)%text = cells%contents()
            if (ranks%count == 1 .and. .not. allocated(error)) call file%append(rows(i)%text, error)
        end do
        do i = 1, merge(0, size(rows), ranks%count == 1)
            call ranks%broadcast(rows(i)%text, from=mod(i - 1, ranks%count))
            if (ranks%is_writer() .and. .not. allocated(error)) call file%append(rows(i)%text, error)
        end do
        call ranks%agree(error)
    end subroutine write_dealt

    !> Finds the named methods, and adds them to the choices. A method without a formulation is combined with
    !> each of `formulations`.
    subroutine add_methods(key, names, known, formulations, choices, problems)
        character(*), intent(in) :: key !! parameter with the list of names
        character(*), intent(in) :: names(:) !! blank ones are skipped
        type(method_info_t), intent(in) :: known(:) !! all methods
        character(*), intent(in) :: formulations(:) !! names of formulations for methods without one
        type(method_choice_t), allocatable, intent(inout) :: choices(:) !! the choices are appended
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(formulation_info_t), allocatable :: forms(:)
        character(16) :: formulation
        integer :: i, k, slash, place

        allocate (forms, source=formulation_infos())
        do i = 1, size(names)
            if (names(i) == '') cycle
            slash = index(trim(names(i)) // '/', '/')
            place = findloc(known%name == names(i)(:slash - 1), .true., dim=1)
            if (place == 0 .and. names(i)(:slash - 1) == 'exact') then
                call problems%add(key // '(' // to_text(i) // ')', 'the exact solution is not among the compared methods', &
                                  'name methods of integration')
            else if (place == 0) then
                call refuse_name(key // '(' // to_text(i) // ')', 'method', names(i)(:slash - 1), known%name, problems)
            else if (slash < len_trim(names(i))) then
                formulation = names(i)(slash + 1:)
                if (.not. any(forms%name == formulation)) then
                    call refuse_name(key // '(' // to_text(i) // ')', 'formulation', trim(formulation), forms%name, problems)
                end if
                choices = [choices, method_choice_t(known(place), formulation)]
            else
                choices = [choices, (method_choice_t(known(place), formulations(k)), k=1, size(formulations))]
            end if
        end do
    end subroutine add_methods

    !> Finds the named cases of a catalogue: the place of each; 0 for one that does not exist, which is reported.
    subroutine find_cases(key, noun, names, known, places, problems)
        character(*), intent(in) :: key, noun !! parameter with the list of names; what they should be, such as 'case'
        character(*), intent(in) :: names(:), known(:) !! blank ones are skipped; those of the catalogue
        integer, allocatable, intent(out) :: places(:) !! in the catalogue
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        integer :: i, place

        allocate (places(0))
        do i = 1, size(names)
            if (names(i) == '') cycle
            place = findloc(known == names(i), .true., dim=1)
            if (place == 0) call refuse_name(key // '(' // to_text(i) // ')', noun, trim(names(i)), known, problems)
            places = [places, place]
        end do
    end subroutine find_cases

    !> Sets a method with its setting in a scene. Keys of &integration that the method does not use are cleared.
    pure subroutine set_method(scene, choice, setting)
        type(scene_t), intent(inout) :: scene !! method and setting are set
        type(method_choice_t), intent(in) :: choice !! method and formulation
        type(setting_t), intent(in) :: setting !! its steps or tolerance
        scene%method = choice%method%name
        scene%formulation = choice%formulation
        scene%step = unset
        scene%steps = setting%steps
        scene%relative_tolerance = setting%tolerance
        if (setting%steps /= unset_integer .or. .not. choice%method%adaptive) scene%absolute_tolerance = unset
        if (setting%steps == unset_integer .and. .not. choice%method%adaptive) scene%project = projection_names(project_nothing)
        if (.not. choice%method%takes_table) scene%table = ''
        if (.not. choice%method%implicit) scene%solver = 'newton'
    end subroutine set_method

    !> Description of a setting.
    function setting_text(self) result(text)
        class(setting_t), intent(in) :: self
        character(:), allocatable :: text
        text = '-'
        if (self%steps /= unset_integer) text = 'steps ' // to_text(self%steps)
        if (is_set(self%tolerance)) text = 'tolerance ' // to_text(self%tolerance)
    end function setting_text

    !> Reports a case, method or formulation that does not exist.
    subroutine refuse_name(key, noun, name, known, problems)
        character(*), intent(in) :: key, noun, name, known(:)
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: with_tables(2) = [character(11) :: 'arkode_erk', 'arkode_dirk']
        character(:), allocatable :: hint
        type(arkode_table_t) :: table
        integer :: i
        hint = ''
        if (noun == 'method') hint = own_name(name, method_aliases)
        if (hint /= '') hint = did_you_mean(hint, [character(len(hint)) :: hint])
        do i = 1, merge(size(with_tables), 0, noun == 'method')
            table = arkode_table(name, i == 2)
            if (table%stages > 0) hint = "it is a table: name '" // trim(with_tables(i)) // &
                                         "', and give integration.table = '" // name // "'"
        end do
        if (hint == '') hint = did_you_mean(name, known)
        if (hint == '') hint = '`spintop list ' // noun // 's` shows them all'
        call problems%add(key, 'there is no ' // noun // " '" // name // "'", hint)
    end subroutine refuse_name

end module spintop_comparison
