!> The work-precision study: the cost of each method for each accuracy, on a given problem and machine.
!>
!> Every method runs with each of its settings. The motion is compared with a reference at equally spaced times; a run to the end
!> of the span without comparisons is timed. Rows are sorted by time. Swept parameters make several problems of one input.
module spintop_precision_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t, make_case
    use spintop_comparison, only: add_methods, method_choice_t, setting_t, attempt_t, comparison_t, problem_t
    use spintop_errors, only: error_t
    use spintop_files, only: file_exists, path_from
    use spintop_formulation, only: structure_quadruple
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_methods, only: exact_info, method_infos
    use spintop_own_butcher_tables, only: infos_of_tables, names_of_methods
    use spintop_parameters, only: is_set, unset_integer
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_trial, only: check_reference, find_reference, read_motion, reference_t, error_energy, error_l3, error_lz, &
        error_norm, error_orientation, error_phi, error_tip, no_errors, run_trial, time_trial
    use spintop_row_block, only: text_buffer_t
    use spintop_scene_keys, only: scene_t, reference_auto, reference_exact, reference_names, table_prefix
    use spintop_status, only: is_ok, status_meaning, status_names
    use spintop_stepper, only: method_info_t
    use spintop_study_column, only: categorical, column => study_column_t
    use spintop_summary, only: duration, summary_t, rounded
    use spintop_sweep_axes, only: case_scene_t
    use spintop_text, only: append, did_you_mean, string_t, to_text
    implicit none
    private
    public :: precision_study_t, precision_columns, add_row, sort_rows, mark_front, summarize_problem, auto_tally_t

    !> Errors for which the cheapest method is reported, rad.
    real(dp), parameter :: wanted_errors(*) = [1.0e-3_dp, 1.0e-6_dp, 1.0e-9_dp, 1.0e-12_dp]
    integer, parameter :: nobody = 0
    !> A method is a good choice if its time is at most this multiple of the least time.
    real(dp), parameter :: near = 2

    !> Counts how often method = 'auto' is a good choice.
    type :: auto_tally_t
        private
        integer :: comparisons = 0, within = 0, missed = 0
        !> Largest ratio of its time to the least time, and the comparison in which it occurs.
        real(dp) :: worst = 1
        character(:), allocatable :: where
    contains
        procedure :: compare => compare_auto
        procedure :: summarize => summarize_auto
    end type auto_tally_t

    !> Methods and settings on one problem, or on each problem of the axes.
    type, extends(comparison_t) :: precision_study_t
        real(dp), allocatable :: tolerances(:)
        integer, allocatable :: steps(:)
        !> Whether methods with both variants use a fixed step size: the input names numbers of steps only.
        logical :: prefers_steps = .false.
        !> Number of times at which the motions are compared.
        integer :: samples = 0
        integer :: repeats = 0
        !> The kind of reference, and the stored reference if it was read from a table.
        integer :: reference = reference_auto
        type(reference_t), allocatable :: stored
        !> The methods that are omitted, each with the reason.
        type(string_t), allocatable, private :: omitted(:)
        type(auto_tally_t), private :: tally
    contains
        procedure :: check
        procedure :: choose
        procedure :: takes_steps
        procedure :: formulation
        procedure :: settings
        procedure :: compare
        procedure :: judge
        procedure :: summarize
    end type precision_study_t

    !> All columns, in the order of the table; those of the swept parameters follow.
    type(column), parameter :: precision_columns(*) = [ &
        column('problem', '', 'input, and case of it where a parameter is swept', 'trial', traits=categorical), &
        column('method', '', 'method', 'trial', traits=categorical), &
        column('formulation', '', 'formulation of the equations of motion', 'trial', traits=categorical), &
        column('setting', '', 'relative tolerance, or number of steps of fixed size', 'trial', traits=categorical), &
        column('orientation_error', 'rad', 'rotation angle from the reference attitude at the end', 'errors'), &
        column('tip_error', '', 'distance of the axis tip from that of the reference at the end', 'errors'), &
        column('error_max', 'rad', 'largest rotation angle from the reference attitude', 'errors'), &
        column('steps', '', 'steps', 'cost'), &
        column('rejected', '', 'rejected steps', 'cost'), &
        column('evaluations', '', 'RHS evaluations of that run; a Taylor series of order p counts as p', 'cost'), &
        column('time_s', 's', 'shortest computing time of the repeats, for the state at the end', 'cost'), &
        column('energy_error', '', 'largest energy error over (kinetic at start + m g |r|)', 'errors'), &
        column('status', '', 'status of the run', 'status', traits=categorical), &
        column('tip_error_max', '', 'largest distance of the axis tip from that of the reference', 'errors'), &
        column('jacobians', '', 'Jacobian evaluations', 'cost'), &
        column('lz_error', '', 'largest error of the vertical momentum, over its scale', 'errors'), &
        column('l3_error', '', 'largest error of the momentum about body z, over the same scale', 'errors'), &
        column('norm_error', '', 'largest norm error abs(q) - 1 of the quaternion', 'errors'), &
        column('phi_error', 'rad', 'error of phi at the end, within half a turn', 'angles'), &
        column('theta_error', 'rad', 'error of theta at the end', 'angles'), &
        column('psi_error', 'rad', 'error of psi at the end, within half a turn', 'angles'), &
        column('phi_rate_error', 'rad/s', 'error of the precession rate at the end', 'angles'), &
        column('theta_rate_error', 'rad/s', 'error of the nutation rate at the end', 'angles'), &
        column('psi_rate_error', 'rad/s', 'error of the spin rate at the end', 'angles'), &
        column('phi_error_max', 'rad', 'largest error of phi', 'angles'), &
        column('theta_error_max', 'rad', 'largest error of theta', 'angles'), &
        column('psi_error_max', 'rad', 'largest error of psi', 'angles'), &
        column('phi_rate_error_max', 'rad/s', 'largest error of the precession rate', 'angles'), &
        column('theta_rate_error_max', 'rad/s', 'largest error of the nutation rate', 'angles'), &
        column('psi_rate_error_max', 'rad/s', 'largest error of the spin rate', 'angles'), &
        column('inherent_error', 'rad', 'error of the attitude due to rounding of the data', 'errors'), &
        column('reference', '', 'reference of the comparison', 'reference', traits=categorical), &
        column('reference_error', 'rad', 'difference between two computations of the reference', 'reference'), &
        column('reference_check', 'rad', 'difference between the reference and an independent computation', 'reference'), &
        column('front', '', 'yes: no other numerical method is both faster and more accurate', 'choice', traits=categorical), &
        column('auto', '', "yes: method = 'auto' takes this method at this tolerance", 'choice', traits=categorical)]

    !> Default tolerances, numbers of steps, and repeats.
    real(dp), parameter :: default_tolerances(*) = [1.0e-3_dp, 1.0e-4_dp, 1.0e-5_dp, 1.0e-6_dp, 1.0e-7_dp, &
        1.0e-8_dp, 1.0e-9_dp, 1.0e-10_dp, 1.0e-11_dp, 1.0e-12_dp, 1.0e-13_dp, 1.0e-14_dp]
    integer, parameter :: default_steps(*) = [100, 200, 400, 800, 1600, 3200, 6400, 12800, 25600]
    integer, parameter :: default_repeats = 5
    !> Maximum number of problems that the summary describes one by one.
    integer(int64), parameter :: most_told = 4
    !> Maximum number of intervals between comparisons.
    integer, parameter :: most_intervals = 100

contains

    !> Makes the first problem, the methods and their settings.
    subroutine check(self, job, problems)
        class(precision_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(scene_t), allocatable :: first
        character(:), allocatable :: key
        integer :: i

        if (job%names_axes() .and. job%axes%cases == 0) return
        call job%make_first_case(first, problems, planned=.false.)
        if (.not. allocated(first)) return
        call self%choose(first, problems)
        if (problems%any()) return
        ! The reference is computed, or read from the table that the input names.
        key = 'work_precision.reference'
        associate (named => job%input%scene%precision_reference)
            if (self%reference == reference_exact .and. .not. job%case%body%has_closed_form()) then
                call problems%add(key, 'this body has no exact solution', "use reference = 'quadruple'")
            else if (did_you_mean(named, reference_names) /= '' .and. all(reference_names /= named) .and. &
                     .not. file_exists(path_from(job%input%path, trim(named)))) then
                call problems%add(key, "there is no reference or table '" // trim(named) // "'", &
                                  did_you_mean(named, reference_names))
            else if (all(reference_names /= named)) then
                allocate (self%stored)
                call read_motion(job%input%path, key, trim(named), job%case, self%stored, problems)
                if (allocated(self%stored%motions)) self%samples = size(self%stored%motions)
            else
                key = 'span.samples'
            end if
        end associate
        ! The times of comparison are steps of the methods with a fixed step size.
        i = findloc(mod(self%steps, self%samples - 1) == 0, .false., dim=1)
        if (i > 0 .and. .not. problems%any() .and. any(self%takes_steps(self%choices))) call problems%add(key, &
            'motions are compared at steps of the methods with a fixed step size, and ' // to_text(self%samples - 1) // &
            ' intervals do not divide ' // to_text(self%steps(i)) // ' steps', &
            'use a number of rows for which rows - 1 divides all work_precision.steps')
        self%count = max(1_int64, job%axes%cases)
        self%ends_in_words = .true.
        call self%count_attempts()
        self%phrase = 'errors and costs of ' // to_text(self%attempts_each) // ' methods and settings'
        if (.not. job%names_axes()) return
        if (allocated(self%stored)) then
            call problems%add('work_precision.reference', 'a stored motion cannot be the reference of several cases', &
                              "use reference = 'auto'")
        end if
        call job%warn_of_bodies(problems)
    end subroutine check

    !> The methods, formulations and settings that are named, or default ones.
    subroutine choose(self, scene, problems)
        class(precision_study_t), intent(inout) :: self
        type(scene_t), intent(in) :: scene !! contents of the input
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(method_info_t), allocatable :: known(:), own(:)
        character(len(scene%formulation)), allocatable :: formulations(:)
        character(len(scene%precision_methods)), allocatable :: names(:)
        character(*), parameter :: hint = 'give it in &work_precision', compares = 'a work-precision study compares ', &
            varies = 'a work-precision study varies the '
        integer :: i

        allocate (own, source=infos_of_tables(scene))
        allocate (known, source=[exact_info, method_infos(), own])
        if (allocated(self%remarks)) deallocate (self%remarks)
        do i = 1, size(own)
            call append(self%remarks, 'table ' // own(i)%name(len(table_prefix) + 1:) // ': order ' // to_text(own(i)%order))
        end do
        formulations = pack(scene%precision_formulations, scene%precision_formulations /= '')
        if (size(formulations) == 0) formulations = ['auto']
        names = names_of_methods(scene, scene%precision_methods)
        if (all(names == '')) names = pack(known%name, known%needs /= structure_quadruple)
        if (allocated(self%choices)) deallocate (self%choices)
        allocate (self%choices(0))
        call add_methods('work_precision.methods', names, known, formulations, self%choices, problems)
        self%tolerances = pack(scene%precision_tolerances, is_set(scene%precision_tolerances))
        if (size(self%tolerances) == 0) self%tolerances = default_tolerances
        self%steps = pack(scene%precision_steps, scene%precision_steps /= unset_integer)
        if (size(self%steps) == 0) self%steps = default_steps
        self%prefers_steps = any(scene%precision_steps /= unset_integer) .and. .not. any(is_set(scene%precision_tolerances))
        self%repeats = default_repeats
        if (scene%precision_repeats /= unset_integer) self%repeats = scene%precision_repeats
        i = findloc(reference_names == scene%precision_reference, .true., dim=1)
        self%reference = merge(i, reference_auto, i > 0)
        ! The most intervals that divide all numbers of steps.
        do i = most_intervals, 2, -1
            if (all(mod(self%steps, i) == 0)) exit
        end do
        self%samples = 1 + i
        if (scene%samples /= unset_integer) self%samples = scene%samples
        if (scene%method /= 'auto') call problems%add('integration.method', compares // 'methods', hint)
        if (scene%formulation /= 'auto') call problems%add('integration.formulation', compares // 'formulations', hint)
        if (scene%steps /= unset_integer) call problems%add('integration.steps', varies // 'steps', hint)
        if (is_set(scene%step)) call problems%add('integration.step', varies // 'steps', hint)
        if (is_set(scene%relative_tolerance)) call problems%add('integration.relative_tolerance', varies // 'tolerance', hint)
        if (scene%stop_at /= '') call problems%add('span.stop_at', &
                                                   'a work-precision study computes each motion to the end of its span', 'omit it')
    end subroutine choose

    !> Whether a method runs with numbers of steps of fixed size.
    elemental logical function takes_steps(self, choice)
        class(precision_study_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        takes_steps = choice%method%fixed_step .and. (self%prefers_steps .or. .not. choice%method%adaptive)
    end function takes_steps

    !> The formulation of all methods if it is the same, else auto.
    pure function formulation(self)
        class(precision_study_t), intent(in) :: self
        character(16) :: formulation
        formulation = 'auto'
        if (all(self%choices%formulation == self%choices(1)%formulation)) formulation = self%choices(1)%formulation
    end function formulation

    !> The settings of a method; they are the same for all problems.
    function settings(self, choice, problem)
        class(precision_study_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        type(problem_t), intent(in) :: problem !! the problem
        type(setting_t), allocatable :: settings(:)
        integer :: k
        if (self%takes_steps(choice)) then
            settings = [(setting_t(steps=self%steps(k)), k=1, size(self%steps))]
        else if (choice%method%adaptive) then
            settings = [(setting_t(tolerance=self%tolerances(k)), k=1, size(self%tolerances))]
        else
            settings = [setting_t()]
        end if
    end function settings

    !> Runs all methods on a problem: the input, or a case of its axes.
    subroutine compare(self, job, number, cells, summary, error)
        class(precision_study_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        integer(int64), intent(in) :: number !! of the problem
        type(text_buffer_t), intent(inout) :: cells !! the rows are appended
        type(summary_t), intent(inout) :: summary !! lines are added
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(case_scene_t), allocatable, target :: swept
        type(problem_t), allocatable :: problem
        type(problems_t) :: problems
        type(auto_tally_t) :: own_tally
        real(dp), allocatable :: values(:)
        integer(int64) :: max_steps
        integer :: i

        allocate (swept, problem)
        call swept%copy(job%input%scene, job%axes)
        values = [real(dp) ::]
        problem%name = job%name
        if (job%axes%cases > 0) then
            problem%name = problem%name // '.' // to_text(number)
            values = job%axes%values_of(number)
            call swept%set_values(values)
        end if
        problem%scene = swept%scene
        problem%scene%samples = self%samples
        call make_case(problem%scene, problem%case, problems)
        if (problems%any()) then
            call give_up('is omitted: ' // problems%first())
            return
        end if
        max_steps = problem%scene%max_steps
        if (allocated(self%stored)) then
            problem%reference = self%stored
        else
            call find_reference(problem%case, self%samples, self%reference, max_steps, problem%reference, problem%status)
        end if
        if (is_ok(problem%status)) then
            call check_reference(problem%case, max_steps, problem%reference)
        else
            call give_up('has no reference: ' // status_meaning(problem%status))
            return
        end if
        self%omitted = [string_t ::]
        call self%try_all(problem)
        do i = 1, size(self%omitted)
            if (number == 1) call summary%add('omitted', self%omitted(i)%text)
        end do
        if (size(self%attempts) == 0) then
            call give_up('has no rows: every method is omitted')
            return
        end if
        call sort_rows(self%attempts)
        call mark_front(self%attempts)
        do i = 1, size(self%attempts)
            call add_row(problem%name, self%attempts(i), problem%reference, values, cells)
        end do
        call self%count_end(spread(.true., 1, size(self%attempts)))
        call self%tally%compare(problem%name, self%attempts)
        if (job%axes%cases > most_told) return
        call summarize_problem(problem%name, self%attempts, problem%reference, summary)
        call own_tally%compare(problem%name, self%attempts)
        call own_tally%summarize(summary)

    contains

        !> Records that the problem has no rows.
        subroutine give_up(why)
            character(*), intent(in) :: why
            self%failures = self%failures + 1
            call summary%add('problem', problem%name // ' ' // why)
        end subroutine give_up

    end subroutine compare

    !> Runs a method with a setting, and times it; or notes why there is no row.
    subroutine judge(self, problem, scene, plan, attempt)
        class(precision_study_t), intent(inout) :: self
        type(problem_t), intent(in) :: problem !! the problem
        type(scene_t), intent(in) :: scene !! its scene with the method and the setting
        type(plan_t), intent(inout) :: plan !! the plan of that scene
        type(attempt_t), intent(inout) :: attempt !! completed by this procedure
        character(:), allocatable :: refusal
        integer :: i

        if (attempt%reason == '' .and. attempt%is_repeated) then
            attempt%reason = 'is already in the table'
        else if (attempt%reason == '' .and. attempt%is_reference) then
            attempt%reason = 'is the reference'
        else if (attempt%reason == '' .and. plan%exact .and. problem%reference%source == 'exact solution') then
            attempt%reason = "is the reference; reference = 'quadruple' measures it"
        end if
        attempt%is_kept = attempt%reason == ''
        if (.not. attempt%is_kept) then
            refusal = attempt%name() // ': ' // attempt%reason
            if (.not. any([(self%omitted(i)%text == refusal, i=1, size(self%omitted))])) call append(self%omitted, refusal)
            return
        end if
        attempt%is_auto = is_auto(scene, problem%case, plan, self%formulation())
        call run_trial(problem%case, plan, problem%reference, attempt%trial)
        attempt%time = attempt%trial%time
        ! Evaluations are counted in the timed run, without the dense output for comparisons.
        if (is_ok(attempt%trial%status)) call time_trial(problem%case, plan, attempt%trial%time, self%repeats, attempt%time, &
                                                         attempt%trial%counts)
    end subroutine judge

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

    !> How good a choice method = 'auto' is on all problems.
    subroutine summarize(self, summary)
        class(precision_study_t), intent(in) :: self
        type(summary_t), intent(inout) :: summary !! lines are added
        if (self%count > 1) call self%tally%summarize(summary)
    end subroutine summarize

    !> Adds a row, a cell per column, and the values of the swept parameters. A failed run has no errors.
    subroutine add_row(problem, row, reference, values, cells)
        character(*), intent(in) :: problem !! its name
        type(attempt_t), intent(in) :: row !! the row
        type(reference_t), intent(in) :: reference !! the reference motion
        real(dp), intent(in) :: values(:) !! of the swept parameters
        type(text_buffer_t), intent(inout) :: cells !! the row is appended
        real(dp), dimension(size(no_errors)) :: largest, last

        if (is_ok(row%trial%status)) then
            largest = row%trial%errors
            last = row%trial%last
        else
            largest = no_number
            last = no_number
        end if
        call row%begin_cells(problem, cells)
        call cells%add_text(row%setting%text())
        associate (counts => row%trial%counts)
            call cells%add_reals([last(error_orientation), last(error_tip), largest(error_orientation)])
            call cells%add_integer(counts%steps)
            call cells%add_integer(counts%rejected)
            call cells%add_integer(counts%evaluations)
            call cells%add_reals([row%time, largest(error_energy)])
            call cells%add_text(status_names(row%trial%status))
            call cells%add_reals([largest(error_tip)])
            call cells%add_integer(counts%jacobians)
        end associate
        call cells%add_reals(largest([error_lz, error_l3, error_norm]))
        call cells%add_reals([last(error_phi:), largest(error_phi:)])
        call cells%add_reals([maxval(reference%floor)])
        call cells%add_text(reference%source)
        call cells%add_reals([reference%uncertainty, reference%disagreement])
        call cells%add_text(merge('yes', 'no ', row%is_front))
        call cells%add_text(merge('yes', 'no ', row%is_auto))
        call cells%add_reals(values)
        call cells%end_row()
    end subroutine add_row

    !> Sorts rows by time.
    pure subroutine sort_rows(rows)
        type(attempt_t), intent(inout) :: rows(:) !! rows of a problem
        type(attempt_t) :: row
        integer :: i, place
        do i = 2, size(rows)
            row = rows(i)
            place = i
            do while (place > 1)
                if (rows(place - 1)%time <= row%time) exit
                rows(place) = rows(place - 1)
                place = place - 1
            end do
            rows(place) = row
        end do
    end subroutine sort_rows

    !> Marks the rows, sorted by time, for which no numerical method is both faster and at least as accurate.
    pure subroutine mark_front(rows)
        type(attempt_t), intent(inout) :: rows(:) !! rows of a problem, sorted by time
        real(dp) :: best
        integer :: i
        best = huge(best)
        do i = 1, size(rows)
            associate (row => rows(i))
                row%is_front = is_ok(row%trial%status) .and. row%trial%errors(error_orientation) < best
                if (row%is_front .and. row%is_stepped) best = row%trial%errors(error_orientation)
            end associate
        end do
    end subroutine mark_front

    !> Adds the results of a problem, whose rows are sorted by time.
    subroutine summarize_problem(problem, rows, reference, summary)
        character(*), intent(in) :: problem !! name of the problem
        type(attempt_t), intent(in) :: rows(:) !! rows of a problem, sorted by time
        type(reference_t), intent(in) :: reference !! the reference motion
        type(summary_t), intent(inout) :: summary !! lines are added
        character(*), parameter :: exact = 'exact solution'
        character(:), allocatable :: text
        integer :: i

        text = trim(merge('the ' // reference%source, reference%source // '    ', reference%source == exact))
        if (reference%is_computed) text = text // ' (two tolerances agree to ' // rounded(reference%uncertainty) // ' rad)'
        if (reference%check == '') then
            text = text // ', which could not be checked: the independent computation failed'
        else
            text = text // ', with which ' // trim(merge('the ' // reference%check, reference%check // '    ', &
                   reference%check == exact)) // ' agrees to ' // rounded(reference%disagreement) // ' rad'
        end if
        call summary%add('problem', problem // ', measured against ' // text)
        if (any(rows%is_stepped) .and. .not. any(rows%is_stepped .and. is_ok(rows%trial%status))) then
            call summary%add('', 'no numerical method reaches the end of the span')
        else
            do i = 1, size(wanted_errors)
                call summary%add('', 'for ' // to_text(wanted_errors(i)) // ' ' // compared(rows, wanted_errors(i)))
            end do
        end if
        do i = 1, size(rows)
            if (rows(i)%is_stepped .or. .not. is_ok(rows(i)%trial%status)) cycle
            call summary%add('', 'the exact solution takes ' // duration(rows(i)%time, 3) // ' at any time, with an error of ' &
                             // rounded(rows(i)%trial%errors(error_orientation)) // ' rad')
        end do
    end subroutine summarize_problem

    !> The cheapest numerical method for an error, and the ratio of its time to that of the next one.
    function compared(rows, error) result(text)
        type(attempt_t), intent(in) :: rows(:)
        real(dp), intent(in) :: error
        character(:), allocatable :: text
        integer :: best, next

        best = cheapest(rows, error, rows%is_stepped)
        if (best == nobody) then
            text = 'no method is accurate enough'
            return
        end if
        text = 'the cheapest is ' // rows(best)%name() // ', ' // rows(best)%setting%text() // ': ' &
               // duration(rows(best)%time, 3)
        next = cheapest(rows, error, rows%is_stepped .and. rows%choice%method%name /= rows(best)%choice%method%name)
        if (next == nobody) then
            text = text // '; no other method is accurate enough'
        else
            text = text // ', ' // rounded(rows(next)%time / rows(best)%time, 2) // ' times cheaper than ' &
                   // rows(next)%name()
        end if
    end function compared

    !> Index of the first row, of rows sorted by time, that is in the mask and has no larger error; 0 if there
    !> is none.
    pure integer function cheapest(rows, error, mask)
        type(attempt_t), intent(in) :: rows(:)
        real(dp), intent(in) :: error
        logical, intent(in) :: mask(:)
        do cheapest = 1, size(rows)
            if (.not. mask(cheapest) .or. .not. is_ok(rows(cheapest)%trial%status)) cycle
            if (rows(cheapest)%trial%errors(error_orientation) <= error) return
        end do
        cheapest = nobody
    end function cheapest

    !> Compares method = 'auto' with the cheapest method, for each error that some method reaches.
    subroutine compare_auto(self, problem, rows)
        class(auto_tally_t), intent(inout) :: self
        character(*), intent(in) :: problem !! name of the problem
        type(attempt_t), intent(in) :: rows(:) !! rows of a problem, sorted by time
        real(dp) :: ratio
        integer :: i, best, own

        do i = 1, size(wanted_errors)
            best = cheapest(rows, wanted_errors(i), spread(.true., 1, size(rows)))
            if (best == nobody .or. .not. any(rows%is_auto)) cycle
            own = cheapest(rows, wanted_errors(i), rows%is_auto)
            ratio = huge(ratio)
            if (own /= nobody) ratio = rows(own)%time / rows(best)%time
            self%comparisons = self%comparisons + 1
            if (own == nobody) self%missed = self%missed + 1
            if (ratio <= near) self%within = self%within + 1
            if (own == nobody .or. ratio <= self%worst) cycle
            self%worst = ratio
            self%where = problem // ', for ' // to_text(wanted_errors(i)) // ' where ' // rows(best)%name() &
                         // ' is the cheapest'
        end do
    end subroutine compare_auto

    !> Adds the results of the comparisons.
    subroutine summarize_auto(self, summary)
        class(auto_tally_t), intent(in) :: self
        type(summary_t), intent(inout) :: summary !! lines are added
        character(:), allocatable :: text
        if (self%comparisons == 0) return
        text = 'takes no more than ' // rounded(near, 1) // ' times as long as the cheapest method in ' &
               // to_text(self%within) // ' of ' // to_text(self%comparisons) // ' comparisons'
        if (self%worst > 1) text = text // ', at worst ' // rounded(self%worst, 3) // ' times (' // self%where // ')'
        if (self%missed > 0) text = text // '; in ' // to_text(self%missed) // ' it is not accurate enough'
        call summary%add('auto', text)
    end subroutine summarize_auto

end module spintop_precision_study
