!> The fit as a kind of study: numbers of the input from measurements of the motion, by least squares.
module spintop_fit_study
    use spintop_clock, only: seconds
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, exit_failed, exit_ok
    use spintop_fit_data, only: measurements_t, read_measurements
    use spintop_fit_model, only: fit_model_t
    use spintop_fit_table, only: fit_columns, residual_path, write_estimates, write_residuals
    use spintop_fit_warnings, only: find_warnings, warn_of_measurements
    use spintop_intervals, only: describe_minimum, estimate_t, student_quantile
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_least_squares, only: minimum_t
    use spintop_options, only: options_t
    use spintop_parameters, only: is_set
    use spintop_plain_text, only: escaped
    use spintop_plan, only: plan_t
    use spintop_problems, only: problems_t
    use spintop_robust, only: huber_bound, minimize_loss, robust_deviation
    use spintop_scene, only: scene_t
    use spintop_scene_fit, only: fit_scene_t, loss_huber, loss_names
    use spintop_scene_words, only: kind_fit, study_kinds
    use spintop_sensitivity, only: sensitive_key_t, sensitivities_t
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_summary, only: rounded, summary_t
    use spintop_text, only: append, counted, string_t, to_text
    implicit none
    private
    public :: fit_study_t

    !> Half the probability outside the intervals; the quantile that belongs to a known standard deviation.
    real(dp), parameter :: tail = 0.025_dp, normal_quantile = 1.9599639845400542_dp

    !> Residuals that are so far above the errors of the motion are those of the measurements.
    real(dp), parameter :: far_above = 1.0e3_dp

    !> Measurements, and the sought numbers.
    type, extends(study_t) :: fit_study_t
        private
        type(measurements_t) :: measured
        type(sensitivities_t) :: sought
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: check
        procedure :: explain
        procedure :: run
    end type fit_study_t

contains

    !> Properties of fits.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_fit)), 'a fit', 'fits', ', besides a covariance__KEY per sought parameter', &
                            'numbers of the input from measurements of the motion')
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        columns = fit_columns
    end function columns

    !> Reads the measurements, and plans the motion up to the last of them.
    subroutine check(self, job, problems, diagnostics)
        class(fit_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scene_t), allocatable :: scene
        integer :: unknown

        associate (unused => diagnostics)
        end associate
        call read_measurements(job%input, job%scene%fit, self%measured, problems)
        call find_unknown(self, job, problems)
        if (any(is_set([job%scene%nutations, job%scene%precessions])) .or. job%scene%stop_at /= '') then
            call problems%add('span', 'the span of a fit is that of its measurements', 'omit the group, or give t_end')
        end if
        if (problems%any()) return
        call take_span(self%measured%t, job%scene, problems)
        call job%make_first_case(scene, problems, planned=.true.)
        if (problems%any()) return
        call plan_for_all(self, job, problems)
        if (problems%any()) return
        call warn_of_measurements(self%measured, job%case, problems)
        if (.not. job%plan%exact .and. .not. job%plan%is_adaptive()) then
            call problems%add('integration.method', 'a method with a fixed step size has no values at the times of the &
                &measurements', 'use an adaptive method')
        end if
        unknown = size(self%sought%keys)
        if (size(self%measured%values) <= unknown) then
            call problems%add('fit.data', to_text(size(self%measured%values)) // ' measurements do not determine ' // &
                              to_text(unknown) // ' parameters and their errors', 'give more measurements')
        end if
    end subroutine check

    !> Makes the plan one for all bodies that are sought: where the first has a closed form and others have none, all motions
    !> are integrated. A method or formulation that the input names stays, and must be for all.
    subroutine plan_for_all(self, job, problems)
        class(fit_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job
        type(problems_t), intent(inout) :: problems
        type(fit_model_t), allocatable, target :: model
        type(plan_t) :: plan
        type(problems_t) :: reasons
        character(:), allocatable :: hint
        integer :: i, k

        allocate (model)
        associate (keys => self%sought%keys)
            call model%prepare(job%scene, keys, job%case, job%plan, self%measured)
            do i = 1, size(keys)
                call model%plan_with_another(i, [(keys(k)%slot%get(), k=1, size(keys))], plan, reasons)
                if (reasons%any()) then
                    hint = "use method = 'auto' and formulation = 'auto'"
                    if (keys(i)%name == 'top.inertia(2)') hint = 'seek top.inertia(1), which stands for both, or ' // hint
                    call problems%add('fit.unknown', 'the body with another ' // keys(i)%name // &
                                      ' has no motion by this method or formulation', hint)
                else if (job%plan%exact .and. .not. plan%exact) then
                    job%plan = plan
                end if
            end do
        end associate
    end subroutine plan_for_all

    !> Sets the end of the motion, or checks that it is not before the last measurement.
    subroutine take_span(t, scene, problems)
        real(dp), intent(in) :: t(:)
        type(scene_t), intent(inout) :: scene
        type(problems_t), intent(inout) :: problems
        associate (last => t(size(t)))
            if (.not. is_set(scene%t_end)) scene%t_end = last
            if (scene%t_end < last) call problems%add('span.t_end', 'the last measurement is at t = ' // to_text(last) // ' s', &
                                                      'omit t_end')
        end associate
    end subroutine take_span

    !> Finds the sought numbers.
    subroutine find_unknown(self, job, problems)
        class(fit_study_t), intent(inout) :: self
        type(job_t), target, intent(in) :: job
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: problem, hint
        integer :: i, key, found

        found = 0
        associate (names => job%scene%fit%unknown)
            do i = 1, size(names)
                if (names(i) == '') cycle
                call self%sought%find_key(trim(names(i)), job%table, job%axes, key, problem, hint)
                if (problem == '' .and. key <= found) then
                    problem = trim(names(i)) // ' is named twice'
                    hint = 'name it once'
                end if
                if (problem /= '') call problems%add('fit.unknown(' // to_text(i) // ')', problem, hint)
                found = max(found, key)
            end do
            if (all(names == '')) call problems%add('fit', 'nothing is sought', "give unknown = 'top.inertia(3)' and the like")
        end associate
    end subroutine find_unknown

    !> Numbers of parameters and measurements.
    function explain(self, job) result(phrase)
        class(fit_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        associate (unused => job)
        end associate
        phrase = 'a fit of ' // counted(size(self%sought%keys), 'parameter') // ' to ' // &
                 counted(size(self%measured%values), 'measurement') // ' at ' // counted(size(self%measured%t), 'time')
    end function explain

    !> Fits the parameters; the study fails if the search does not converge, or the data do not determine them.
    subroutine run(self, job, options, summary, code, error)
        class(fit_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(fit_model_t), allocatable, target :: model
        type(minimum_t) :: minimum
        type(estimate_t) :: estimate
        type(string_t), allocatable :: warnings(:)
        real(dp), allocatable :: start(:), values(:, :)
        character(:), allocatable :: ending
        real(dp) :: began
        integer :: i
        logical :: is_valid, is_noisy

        associate (unused => options)
        end associate
        began = seconds()
        code = exit_ok
        allocate (model)
        associate (keys => self%sought%keys, measured => self%measured)
            call model%prepare(job%scene, keys, job%case, job%plan, measured)
            start = [(keys(i)%slot%get(), i=1, size(keys))]
            call search(self, job%scene%fit, model, start, minimum, estimate)
            ending = end_of_search(minimum, estimate, keys)
            if (ending /= 'ok') code = exit_failed
            allocate (values, mold=measured%values)
            call model%predict(minimum%x, values, is_valid)
            is_noisy = is_valid .and. norm2(minimum%residuals) > far_above * sqrt(real(size(minimum%residuals), dp)) * &
                       estimate%error_of_model
            call find_warnings(measured, measured%values - values, size(keys), is_noisy, job%scene%fit%loss == &
                               loss_names(loss_huber), warnings)
            do i = 1, size(keys)
                if (.not. estimate%is_followed(i)) call append(warnings, 'the profile of ' // keys(i)%name // ' could not be &
                    &followed: an end of its interval is that of the linear model')
            end do
            do i = 1, size(warnings)
                if (i > 1) job%late_warnings = job%late_warnings // new_line('a')
                job%late_warnings = job%late_warnings // escaped(job%input) // ': warning: ' // warnings(i)%text
            end do
            call write_estimates(job, keys, start, estimate, warnings, ending, error)
            if (.not. allocated(error)) call write_residuals(job, measured, values, ending, error)
        end associate
        if (allocated(error)) return
        call describe_fit(self, job, minimum, estimate, ending, seconds() - began, summary)
    end subroutine run

    !> Searches for the minimum, and from each place with a smaller sum of squares that a profile meets.
    subroutine search(self, settings, model, start, minimum, estimate)
        class(fit_study_t), intent(in) :: self
        type(fit_scene_t), intent(in) :: settings
        type(fit_model_t), target, intent(inout) :: model
        real(dp), intent(in) :: start(:)
        type(minimum_t), intent(out) :: minimum
        type(estimate_t), intent(out) :: estimate
        integer, parameter :: most_searches = 10
        real(dp), allocatable :: from(:)
        real(dp) :: level
        integer :: i, m, evaluations, steps
        logical :: is_huber

        m = size(self%measured%values)
        is_huber = settings%loss == loss_names(loss_huber)
        level = normal_quantile
        if (is_huber .or. .not. self%measured%knows_sigma) level = student_quantile(tail, m - size(start))
        allocate (from, source=start)
        evaluations = 0
        steps = 0
        do i = 1, most_searches
            call minimize_loss(model, from, m, is_huber, self%measured%knows_sigma, minimum)
            evaluations = evaluations + minimum%evaluations
            steps = steps + minimum%steps
            call describe_minimum(model, minimum, self%measured%knows_sigma, settings%profile .and. minimum%has_converged, &
                                  level, estimate)
            if (.not. allocated(estimate%better)) exit
            from(:) = estimate%better
        end do
        minimum%has_converged = minimum%has_converged .and. .not. allocated(estimate%better)
        minimum%evaluations = evaluations
        minimum%steps = steps
    end subroutine search

    !> How the search ended.
    function end_of_search(minimum, estimate, keys) result(ending)
        type(minimum_t), intent(in) :: minimum
        type(estimate_t), intent(in) :: estimate
        type(sensitive_key_t), intent(in) :: keys(:)
        character(:), allocatable :: ending
        character(:), allocatable :: names
        integer :: i

        ending = 'ok'
        names = ''
        do i = 1, size(keys)
            if (.not. estimate%is_undetermined(i)) cycle
            if (names /= '') names = names // ', '
            names = names // keys(i)%name
        end do
        if (.not. minimum%has_converged) then
            ending = 'not_converged: the search ended elsewhere than at a minimum'
        else if (.not. estimate%is_identifiable) then
            ending = 'not_identifiable: the measurements do not determine ' // names
            if (.not. all(estimate%is_bounded)) ending = 'not_identifiable: the measurements give no bound for ' // names
        end if
    end function end_of_search

    !> The summary: the motion, the parameters with their intervals, the residuals, and how the search ended.
    subroutine describe_fit(self, job, minimum, estimate, ending, time, summary)
        type(fit_study_t), intent(in) :: self
        type(job_t), intent(in) :: job
        type(minimum_t), intent(in) :: minimum
        type(estimate_t), intent(in) :: estimate
        character(*), intent(in) :: ending
        real(dp), intent(in) :: time
        type(summary_t), intent(inout) :: summary
        real(dp) :: bound
        integer :: i, m, n

        m = size(self%measured%values)
        n = size(minimum%x)
        bound = huber_bound
        if (.not. self%measured%knows_sigma) bound = huber_bound * robust_deviation(minimum%residuals, n)
        call summary%headline(job%input // ': ' // self%explain(job) // ' -> ' // job%output // ', ' // residual_path(job%output))
        call summary%describe_plan(job%plan)
        do i = 1, n
            call summary%add(self%sought%keys(i)%name, ' = ' // rounded(estimate%x(i), 9) // ' +- ' // &
                             rounded(estimate%standard_error(i), 3) // ', 95 %: ' // rounded(estimate%lower(i), 9) // ' to ' // &
                             rounded(estimate%upper(i), 9))
        end do
        if (job%scene%fit%loss == loss_names(loss_huber)) then
            call summary%add('residuals', 'median standard deviation ' // rounded(robust_deviation(minimum%residuals, n), 6) // &
                             ', ' // to_text(m - n) // ' degrees of freedom')
            call summary%add('loss', 'huber: ' // to_text(count(abs(minimum%residuals) > bound)) // ' of ' // to_text(m) // &
                             ' residuals are beyond ' // to_text(huber_bound) // ' standard deviations')
        else if (self%measured%knows_sigma) then
            call summary%add('chi2', rounded(minimum%sum_of_squares, 6) // ' for ' // to_text(m - n) // ' degrees of freedom')
        else
            call summary%add('residuals', 'standard deviation ' // rounded(estimate%deviation, 6) // ', ' // to_text(m - n) // &
                             ' degrees of freedom')
        end if
        call summary%add('search', to_text(minimum%steps) // ' steps, ' // to_text(minimum%evaluations) // ' evaluations')
        call summary%add('time', rounded(time) // ' s')
        call summary%add('status', ending)
    end subroutine describe_fit

end module spintop_fit_study
