!> Published benchmark tops: the true value of each quantity, the published figure with its error, and the fastest setting
!> of this program that is a hundred times better.
!>
!> The true value is that of a motion in quadruple precision. Where there is an exact solution the two are compared.
module spintop_benchmark_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_benchmark_cases, only: benchmark_t, benchmarks, figure_t, figures
    use spintop_benchmark_columns, only: benchmark_columns, benchmark_row_t, add_row
    use spintop_case, only: case_t, make_case
    use spintop_clock, only: seconds
    use spintop_compare, only: is_finite
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, internal_error
    use spintop_exit_codes, only: exit_failed, exit_ok
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_compared_methods, only: method_choice_t, set_adaptive, set_steps, find_cases
    use spintop_methods, only: method_infos
    use spintop_motion, only: motion_t
    use spintop_motion_view, only: motion_view_t
    use spintop_options, only: options_t
    use spintop_plan, only: plan_t
    use spintop_planning, only: make_plan
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_reference_motion, only: find_reference, reference_t
    use spintop_scene_keys, only: scene_t
    use spintop_scene_of_settings, only: make_scene_of_settings
    use spintop_scene_words, only: kind_benchmark, reference_exact, reference_quadruple, study_kinds
    use spintop_status, only: is_good_end, is_ok, status_meaning
    use spintop_stepper, only: counts_t, method_info_t
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_study_head, only: study_head
    use spintop_summary, only: rounded, summary_t
    use spintop_table_file, only: table_file_t
    use spintop_text, only: counted, string_t, to_text
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trajectory_columns, only: find_trajectory_column, trajectory_column_t
    use spintop_trial_time, only: time_trial
    implicit none
    private
    public :: benchmark_study_t

    !> Published benchmarks and their figures.
    type, extends(study_t) :: benchmark_study_t
        private
        !> Indices in the catalogue.
        integer, allocatable :: chosen(:)
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: cases
        procedure :: check
        procedure :: explain
        procedure :: run
    end type benchmark_study_t

    !> A computation with one setting of one method.
    type :: attempt_t
        type(method_choice_t) :: choice
        character(24) :: setting = ''
        character(16) :: formulation = ''
        real(dp), allocatable :: values(:)
        real(dp) :: error = no_number, time = no_number
        type(counts_t) :: counts
    end type attempt_t

    !> The methods that are tried: the fastest of each family.
    character(*), parameter :: tried_methods(*) = [character(12) :: 'taylor', 'dop853', 'ode45', 'splitting_4', 'splitting_8', &
        'gauss_8', 'rk4']
    !> Tolerances of adaptive methods are powers of ten down to this one; the others take 25, 50, ... equal steps.
    integer, parameter :: least_power = -15, first_steps = 25, most_doublings = 11
    !> The goal is this part of the error of a published figure; without one, an error of 1e-10.
    real(dp), parameter :: better = 1.0e-2_dp, goal_without_figure = 1.0e-10_dp
    !> Timed computations of a setting.
    integer, parameter :: repeats = 3

contains

    !> Properties of studies of benchmarks.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_benchmark)), 'a study of benchmarks', 'studies of benchmarks', '', &
                            'published benchmark tops: true values, and the errors of the published figures', &
                            has_parts=.true., has_case=.false.)
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        columns = benchmark_columns
    end function columns

    !> Number of benchmarks.
    integer(int64) function cases(self, job)
        class(benchmark_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        cases = size(self%chosen)
    end function cases

    !> Finds the benchmarks.
    subroutine check(self, job, problems, diagnostics)
        class(benchmark_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        integer :: i

        associate (names => job%input%scene%benchmark_cases)
            call find_cases('benchmark.cases', 'benchmark', names, benchmarks%name, self%chosen, problems)
            if (all(names == '')) self%chosen = [(i, i=1, size(benchmarks))]
        end associate
    end subroutine check

    !> Number of benchmarks.
    function explain(self, job) result(phrase)
        class(benchmark_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        phrase = 'the figures of ' // to_text(size(self%chosen)) // ' published benchmarks'
    end function explain

    !> Runs the benchmarks, or a part of them, and writes their table; the study fails if one has no reference.
    subroutine run(self, job, options, summary, code, error)
        class(benchmark_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_file_t) :: file
        type(string_t) :: no_lines(0)
        type(progress_t) :: progress
        real(dp) :: began
        character(:), allocatable :: part
        integer(int64) :: all, first, last
        integer :: i, status

        began = seconds()
        code = exit_ok
        all = size(self%chosen)
        first = options%shard%first(all)
        last = options%shard%last(all)
        part = options%shard%beginning(all)
        call file%create(job%files%table, study_head(job, benchmark_columns, part=part), error)
        if (allocated(error)) return
        call summary%headline(job%input%path // ': ' // to_text(last - first + 1) // ' benchmarks -> ' // job%files%table)
        if (part /= '') call summary%add('shard', part)
        call progress%start(job%name, 'benchmarks', last - first + 1, options%quiet, options%progress)
        do i = int(first), int(last)
            call run_benchmark(benchmarks(self%chosen(i)), file, summary, status, error)
            if (allocated(error)) exit
            if (.not. is_ok(status)) code = exit_failed
            call progress%update(i - first + 1)
        end do
        call progress%finish()
        if (.not. allocated(error)) call file%finish(no_lines, error)
        if (allocated(error)) call file%discard()
        call summary%add('time', rounded(seconds() - began) // ' s')
    end subroutine run

    !> The rows of a benchmark.
    subroutine run_benchmark(benchmark, file, summary, status, error)
        type(benchmark_t), intent(in) :: benchmark
        type(table_file_t), intent(inout) :: file
        type(summary_t), intent(inout) :: summary
        integer, intent(out) :: status
        type(error_t), allocatable, intent(out) :: error
        type(scene_t), allocatable :: scene
        type(case_t) :: case
        type(problems_t) :: problems
        type(figure_t), allocatable :: wanted(:)
        type(attempt_t), allocatable :: attempts(:)
        type(text_buffer_t) :: cells
        real(dp), allocatable :: truth(:), truth_error(:), goals(:)
        integer :: k

        allocate (scene)
        call make_scene_of_settings(benchmark%settings, scene, error)
        if (allocated(error)) return
        call make_case(scene, case, problems)
        if (problems%any()) then
            error = internal_error('benchmark ' // trim(benchmark%name) // ': ' // problems%first())
            return
        end if
        wanted = pack(figures, figures%benchmark == benchmark%name)
        call find_truth(scene, case, wanted, truth, truth_error, status)
        if (.not. is_ok(status)) then
            call summary%add(benchmark%name, 'no reference: ' // status_meaning(status))
            return
        end if
        goals = merge(better * abs(wanted%published - truth) / max(1.0_dp, abs(truth)), goal_without_figure, &
                      is_finite(wanted%published))
        call try_methods(scene, case, wanted, truth, goals, attempts)
        do k = 1, size(wanted)
            call cells%clear()
            call add_row(row_of(benchmark, case, wanted(k), k, truth(k), truth_error(k), goals(k), attempts), cells)
            call file%append(cells%contents(), error)
            if (allocated(error)) return
        end do
        call summary%add(benchmark%name, in_words(wanted, truth))
    end subroutine run_benchmark

    !> The true values of some quantities, and their differences from those of the exact solution; without one, the
    !> difference of two computations in quadruple precision, rad.
    subroutine find_truth(scene, case, wanted, truth, truth_error, status)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(figure_t), intent(in) :: wanted(:)
        real(dp), allocatable, intent(out) :: truth(:), truth_error(:)
        integer, intent(out) :: status
        type(reference_t) :: reference, exact

        call find_reference(case, 2, reference_quadruple, int(scene%max_steps, int64), reference, status)
        if (.not. is_ok(status)) return
        truth = values_of(case, reference%motions(2), wanted)
        truth_error = spread(reference%uncertainty, 1, size(wanted))
        if (.not. case%body%has_closed_form()) return
        call find_reference(case, 2, reference_exact, int(scene%max_steps, int64), exact, status)
        if (is_ok(status)) truth_error = abs(values_of(case, exact%motions(2), wanted) - truth)
    end subroutine find_truth

    !> The values of some quantities of a motion, which is in the axes of the computation.
    function values_of(case, motion, wanted) result(values)
        type(case_t), intent(in) :: case
        type(motion_t), intent(in) :: motion
        type(figure_t), intent(in) :: wanted(:)
        real(dp) :: values(size(wanted))
        type(motion_view_t) :: view
        type(motion_t) :: seen
        type(trajectory_column_t) :: column
        logical :: found
        integer :: k

        call view%set(case)
        seen = motion
        seen%given_angle = case%start%given_angle
        call view%set_motion(seen, as_computed=.true.)
        do k = 1, size(wanted)
            call find_trajectory_column(trim(wanted(k)%column), column, found)
            values(k) = column%value(view)
            if (column%name(1:1) == 'q') values(k) = sign(values(k), wanted(k)%published)
        end do
    end function values_of

    !> The settings of all methods, up to the one that satisfies all goals.
    subroutine try_methods(scene, case, wanted, truth, goals, attempts)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(figure_t), intent(in) :: wanted(:)
        real(dp), intent(in) :: truth(:), goals(:)
        type(attempt_t), allocatable, intent(out) :: attempts(:)
        type(attempt_t) :: attempt
        type(method_info_t), allocatable :: known(:)
        integer :: i, k, settings

        allocate (known, source=method_infos())
        allocate (attempts(0))
        do i = 1, size(tried_methods)
            attempt%choice%method = known(findloc(known%name == tried_methods(i), .true., dim=1))
            settings = merge(-least_power - 2, most_doublings + 1, attempt%choice%method%adaptive)
            do k = 1, settings
                call try_setting(scene, case, wanted, truth, maxval(goals), k, attempt)
                if (.not. is_finite(attempt%error)) cycle
                attempts = [attempts, attempt]
                if (attempt%error <= minval(goals)) exit
            end do
        end do
    end subroutine try_methods

    !> One setting of a method: its values and errors and, if it satisfies the largest goal, its time. The error stays NaN if
    !> the method does not run.
    subroutine try_setting(scene, case, wanted, truth, goal, k, attempt)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(figure_t), intent(in) :: wanted(:)
        real(dp), intent(in) :: truth(:), goal
        integer, intent(in) :: k
        type(attempt_t), intent(inout) :: attempt
        type(scene_t), allocatable :: own
        type(plan_t) :: plan
        type(problems_t) :: problems
        type(motion_t) :: motion
        real(dp) :: tolerance, first
        integer :: status

        attempt%error = no_number
        allocate (own, source=scene)
        if (attempt%choice%method%adaptive) then
            tolerance = 10.0_dp**(-2 - k)
            call set_adaptive(own, attempt%choice, tolerance)
            attempt%setting = 'tolerance ' // to_text(tolerance)
        else
            call set_steps(own, attempt%choice, first_steps * 2**(k - 1))
            attempt%setting = 'steps ' // to_text(first_steps * 2**(k - 1))
        end if
        own%samples = 2
        call make_plan(own, case, plan, problems)
        if (problems%any()) return
        attempt%formulation = plan%formulation_name()
        call time_trial(case, plan, huge(tolerance), 1, first, attempt%counts, motion, status)
        if (.not. is_good_end(status)) return
        attempt%values = values_of(case, motion, wanted)
        attempt%error = maxval(abs(attempt%values - truth) / max(1.0_dp, abs(truth)))
        attempt%time = first
        if (attempt%error <= goal) call time_trial(case, plan, first, repeats, attempt%time, attempt%counts)
    end subroutine try_setting

    !> The row of a quantity, with the fastest attempt that satisfies its goal.
    function row_of(benchmark, case, figure, k, truth, truth_error, goal, attempts) result(row)
        type(benchmark_t), intent(in) :: benchmark
        type(case_t), intent(in) :: case
        type(figure_t), intent(in) :: figure
        integer, intent(in) :: k
        real(dp), intent(in) :: truth, truth_error, goal
        type(attempt_t), intent(in) :: attempts(:)
        type(benchmark_row_t) :: row
        integer :: best

        row%benchmark = benchmark%name
        row%source = benchmark%source
        row%quantity = figure%column
        row%t = case%t_end
        row%published = figure%published
        row%published_method = figure%method
        row%truth = truth
        row%truth_error = truth_error
        row%reference = 'quadruple'
        if (case%body%has_closed_form()) row%reference = 'quadruple and exact'
        row%goal = goal
        best = minloc(attempts%time, dim=1, mask=attempts%error <= goal)
        if (best == 0) return
        row%method = attempts(best)%choice%method%name
        row%formulation = attempts(best)%formulation
        row%setting = attempts(best)%setting
        row%value = attempts(best)%values(k)
        row%error = attempts(best)%error
        row%evaluations = attempts(best)%counts%evaluations
        row%time = attempts(best)%time
    end function row_of

    !> The largest error of the published figures of a benchmark.
    function in_words(wanted, truth) result(text)
        type(figure_t), intent(in) :: wanted(:)
        real(dp), intent(in) :: truth(:)
        character(:), allocatable :: text
        logical :: has_figure(size(wanted))
        integer :: worst

        has_figure = is_finite(wanted%published)
        text = counted(size(wanted), 'quantity', 'quantities') // ' without a published figure'
        if (.not. any(has_figure)) return
        worst = maxloc(abs(wanted%published - truth), dim=1, mask=has_figure)
        text = counted(count(has_figure), 'published figure') // '; largest error ' &
               // rounded(abs(wanted(worst)%published - truth(worst)), 2) // ' in ' // trim(wanted(worst)%column) &
               // ' (' // trim(wanted(worst)%method) // ')'
    end function in_words

end module spintop_benchmark_study
