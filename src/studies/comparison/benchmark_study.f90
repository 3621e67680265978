!> Published benchmark tops: the true value of each quantity, the published figure with its error, and the fastest setting
!> of this program that is a hundred times better.
!>
!> The true value is that of a motion in quadruple precision. Where there is an exact solution the two are compared.
module spintop_benchmark_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_benchmark_cases, only: benchmarks, figure_t, figures
    use spintop_case, only: case_t, make_case
    use spintop_kinds, only: dp, no_number, is_finite
    use spintop_comparison, only: add_methods, find_cases, method_choice_t, setting_t, attempt_t, comparison_t, &
        make_scene_of_settings, problem_t
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, internal_error
    use spintop_job, only: job_t
    use spintop_methods, only: method_infos
    use spintop_motion, only: motion_t
    use spintop_row_block, only: text_buffer_t
    use spintop_trajectory_columns, only: motion_view_t, trajectory_columns, value_of
    use spintop_planning, only: plan_t
    use spintop_problems, only: problems_t
    use spintop_reference_motion, only: find_reference, reference_t
    use spintop_scene_keys, only: scene_t, reference_exact, reference_quadruple
    use spintop_status, only: is_good_end, is_ok, status_meaning
    use spintop_study_column, only: categorical, column => study_column_t, place_of
    use spintop_summary, only: rounded, summary_t
    use spintop_text, only: counted, to_text
    use spintop_trial, only: time_trial
    implicit none
    private
    public :: benchmark_study_t, benchmark_columns

    !> Published benchmarks and their figures.
    type, extends(comparison_t) :: benchmark_study_t
        !> Indices in the catalogue.
        integer, allocatable :: places(:)
        !> The quantities of the current benchmark, their true values, and the errors that are allowed for.
        type(figure_t), allocatable :: wanted(:)
        real(dp), allocatable :: truth(:), goals(:)
    contains
        procedure :: check
        procedure :: settings
        procedure :: compare
        procedure :: judge
    end type benchmark_study_t

    !> The methods that are tried: the fastest of each family.
    character(*), parameter :: tried_methods(*) = [character(12) :: 'taylor', 'dop853', 'ode45', 'splitting_4', 'splitting_8', &
        'gauss_8', 'rk4']
    !> Tolerances of adaptive methods are powers of ten down to this one; the others take 25, 50, ... equal steps.
    integer, parameter :: least_power = -15, first_steps = 25, most_doublings = 11
    !> The goal is this part of the error of a published figure; without one, an error of 1e-10.
    real(dp), parameter :: better = 1.0e-2_dp, goal_without_figure = 1.0e-10_dp
    !> Timed computations of a setting.
    integer, parameter :: repeats = 3

    !> All columns, in the order of the table.
    type(column), parameter :: benchmark_columns(*) = [ &
        column('benchmark', '', 'benchmark of the catalogue', 'benchmark', traits=categorical), &
        column('quantity', '', 'column of trajectories at the end of the span', 'benchmark', traits=categorical), &
        column('t', 's', 'end of the span', 'benchmark'), &
        column('truth', '', 'true value, in the unit of that column', 'truth'), &
        column('truth_error', '', 'difference of two computations of it', 'truth'), &
        column('reference', '', 'how it was computed', 'truth', traits=categorical), &
        column('published', '', 'published figure (nan: none)', 'published'), &
        column('published_error', '', 'its difference from the true value', 'published'), &
        column('published_method', '', 'who published it, with which method', 'published', traits=categorical), &
        column('goal', '', 'a hundredth of that difference, over max(1, true value); 1e-10 without a figure', 'best'), &
        column('method', '', 'fastest method whose errors are within the goal', 'best', traits=categorical), &
        column('formulation', '', 'its formulation', 'best', traits=categorical), &
        column('setting', '', 'its setting', 'best', traits=categorical), &
        column('value', '', 'its value', 'best'), &
        column('error', '', 'its largest error of all quantities of the benchmark, over max(1, true value)', 'best'), &
        column('evaluations', '', 'its RHS evaluations', 'best'), &
        column('time_s', 's', 'its computing time', 'best'), &
        column('source', '', 'where the benchmark was published', 'benchmark', traits=categorical)]

contains

    !> Finds the benchmarks.
    subroutine check(self, job, problems, diagnostics)
        class(benchmark_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        integer :: i

        associate (names => job%input%scene%benchmark_cases)
            call find_cases('benchmark.cases', 'benchmark', names, benchmarks%name, self%places, problems)
            if (all(names == '')) self%places = [(i, i=1, size(benchmarks))]
        end associate
        allocate (self%choices(0))
        call add_methods('', tried_methods, method_infos(), ['auto'], self%choices, problems)
        self%count = size(self%places)
        call self%count_attempts()
        self%phrase = 'the figures of ' // to_text(self%count) // ' published benchmarks'
    end subroutine check

    !> The settings of a method, from coarse to fine.
    function settings(self, choice, problem)
        class(benchmark_study_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        type(problem_t), intent(in) :: problem !! the benchmark
        type(setting_t), allocatable :: settings(:)
        integer :: k
        if (choice%method%adaptive) then
            settings = [(setting_t(tolerance=10.0_dp**(-k)), k=3, -least_power)]
        else
            settings = [(setting_t(steps=first_steps * 2**k), k=0, most_doublings)]
        end if
    end function settings

    !> The rows of a benchmark.
    subroutine compare(self, job, number, cells, summary, error)
        class(benchmark_study_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        integer(int64), intent(in) :: number !! of the benchmark
        type(text_buffer_t), intent(inout) :: cells !! the rows are appended
        type(summary_t), intent(inout) :: summary !! lines are added
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(problem_t), allocatable :: problem
        type(problems_t) :: problems
        type(reference_t) :: exact
        character(:), allocatable :: text
        integer(int64) :: max_steps
        real(dp), allocatable :: truth_error(:)
        logical, allocatable :: has_figure(:)
        integer :: k

        allocate (problem)
        associate (benchmark => benchmarks(self%places(number)))
            problem%name = trim(benchmark%name)
            call make_scene_of_settings(benchmark%settings, problem%scene, error)
            if (allocated(error)) return
            problem%scene%samples = 2
            self%wanted = pack(figures, figures%benchmark == benchmark%name)
        end associate
        call make_case(problem%scene, problem%case, problems)
        if (problems%any()) then
            error = internal_error('benchmark ' // problem%name // ': ' // problems%first())
            return
        end if
        ! The true values, and their differences from those of the exact solution; without one, the difference of two computations
        ! in quadruple precision, rad.
        max_steps = problem%scene%max_steps
        call find_reference(problem%case, 2, reference_quadruple, max_steps, problem%reference, problem%status)
        if (is_ok(problem%status)) then
            self%truth = values_of(problem%case, problem%reference%motions(2), self%wanted)
            truth_error = spread(problem%reference%uncertainty, 1, size(self%wanted))
            if (problem%case%body%has_closed_form()) then
                call find_reference(problem%case, 2, reference_exact, max_steps, exact, problem%status)
                if (is_ok(problem%status)) truth_error = &
                    abs(values_of(problem%case, exact%motions(2), self%wanted) - self%truth)
            end if
        end if
        if (.not. is_ok(problem%status)) then
            self%failures = self%failures + 1
            call summary%add(problem%name, 'no reference: ' // status_meaning(problem%status))
            return
        end if
        self%goals = merge(better * abs(self%wanted%published - self%truth) / max(1.0_dp, abs(self%truth)), &
                           goal_without_figure, is_finite(self%wanted%published))
        call self%try_all(problem)
        do k = 1, size(self%wanted)
            call add_row(self, problem, benchmarks(self%places(number))%source, k, truth_error(k), cells)
        end do
        has_figure = is_finite(self%wanted%published)
        text = counted(size(self%wanted), 'quantity', 'quantities') // ' without a published figure'
        if (any(has_figure)) then
            k = maxloc(abs(self%wanted%published - self%truth), dim=1, mask=has_figure)
            text = counted(count(has_figure), 'published figure') // '; largest error ' &
                   // rounded(abs(self%wanted(k)%published - self%truth(k)), 2) // ' in ' // trim(self%wanted(k)%column) &
                   // ' (' // trim(self%wanted(k)%method) // ')'
        end if
        call summary%add(problem%name, text)
    end subroutine compare

    !> The values of some quantities of a motion, which is in the axes of the computation.
    function values_of(case, motion, wanted) result(values)
        type(case_t), intent(in) :: case
        type(motion_t), intent(in) :: motion
        type(figure_t), intent(in) :: wanted(:)
        real(dp) :: values(size(wanted))
        type(motion_view_t) :: view
        type(motion_t) :: seen
        integer :: k

        call view%set_case(case)
        seen = motion
        seen%given_angle = case%start%given_angle
        call view%set_motion(seen, as_computed=.true.)
        do k = 1, size(wanted)
            values(k) = value_of(trajectory_columns(place_of(trajectory_columns, wanted(k)%column)), view)
            if (wanted(k)%column(1:1) == 'q') values(k) = sign(values(k), wanted(k)%published)
        end do
    end function values_of

    !> One setting of a method: its values and errors and, if it satisfies the largest goal, its time. There are no finer ones if
    !> it satisfies all goals.
    subroutine judge(self, problem, scene, plan, attempt)
        class(benchmark_study_t), intent(inout) :: self
        type(problem_t), intent(in) :: problem !! the benchmark
        type(scene_t), intent(in) :: scene !! its scene with the method and the setting
        type(plan_t), intent(inout) :: plan !! the plan of that scene
        type(attempt_t), intent(inout) :: attempt !! completed by this procedure
        type(motion_t) :: motion
        real(dp) :: first
        integer :: status

        if (attempt%reason /= '') return
        call time_trial(problem%case, plan, huge(first), 1, first, attempt%trial%counts, motion, status)
        if (.not. is_good_end(status)) return
        attempt%values = values_of(problem%case, motion, self%wanted)
        attempt%error = maxval(abs(attempt%values - self%truth) / max(1.0_dp, abs(self%truth)))
        attempt%time = first
        if (attempt%error <= maxval(self%goals)) then
            call time_trial(problem%case, plan, first, repeats, attempt%time, attempt%trial%counts)
        end if
        attempt%is_kept = is_finite(attempt%error)
        attempt%is_enough = attempt%error <= minval(self%goals)
    end subroutine judge

    !> Adds the row of quantity `k`, with the fastest attempt that satisfies its goal.
    subroutine add_row(self, problem, source, k, truth_error, cells)
        class(benchmark_study_t), intent(in) :: self
        type(problem_t), intent(in) :: problem
        character(*), intent(in) :: source
        integer, intent(in) :: k
        real(dp), intent(in) :: truth_error
        type(text_buffer_t), intent(inout) :: cells
        type(attempt_t) :: best
        integer :: place

        place = minloc(self%attempts%time, dim=1, mask=self%attempts%error <= self%goals(k))
        if (place == 0) then
            best%values = spread(no_number, 1, size(self%wanted))
        else
            best = self%attempts(place)
        end if
        associate (figure => self%wanted(k), truth => self%truth(k))
            call cells%add_text(problem%name)
            call cells%add_text(figure%column)
            call cells%add_reals([problem%case%t_end, truth, truth_error])
            call cells%add_text(trim(merge('quadruple and exact', 'quadruple          ', problem%case%body%has_closed_form())))
            call cells%add_reals([figure%published, abs(figure%published - truth)])
            call cells%add_text(figure%method)
            call cells%add_reals([self%goals(k)])
        end associate
        call cells%add_text(best%choice%method%name)
        call cells%add_text(best%formulation)
        if (place == 0) then
            call cells%add_text('')
        else
            call cells%add_text(best%setting%text())
        end if
        call cells%add_reals([best%values(k), best%error])
        call cells%add_integer(best%trial%counts%evaluations)
        call cells%add_reals([best%time])
        call cells%add_text(source)
        call cells%end_row()
    end subroutine add_row

end module spintop_benchmark_study
