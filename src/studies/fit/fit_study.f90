!> The fit as a kind of study: numbers of the input from measurements of the motion, by least squares.
module spintop_fit_study
    use spintop_errors, only: error_t, exit_failed, exit_ok
    use spintop_fit_data, only: measurements_t, read_measurements
    use spintop_fit_model, only: fit_model_t
    use spintop_fit_search, only: check_measurements, far_above, finish_search, information, judge, judgement_t, search_minimum, &
        search_t
    use spintop_fit_unknowns, only: find_unknowns, unknowns_t
    use spintop_intervals, only: compare_with, describe_minimum, estimate_t
    use spintop_job, only: job_t, study_head
    use spintop_kinds, only: dp, is_finite, no_number
    use spintop_least_squares, only: minimum_t, robust_deviation
    use spintop_study, only: options_t, study_t
    use spintop_parameters, only: is_set
    use spintop_planning, only: plan_t
    use spintop_probability, only: student_quantile
    use spintop_problems, only: problems_t
    use spintop_process, only: seconds
    use spintop_residuals, only: loss_names, loss_squares
    use spintop_row_block, only: text_buffer_t
    use spintop_scene_keys, only: scene_t
    use spintop_study_column, only: categorical, column => study_column_t
    use spintop_summary, only: rounded, summary_t
    use spintop_table_column, only: column_t
    use spintop_journaled_table, only: stem_of, table_file_t
    use spintop_text, only: append, counted, escaped, string_t, to_text
    implicit none
    private
    public :: fit_study_t, residual_path, fit_columns

    !> Digits of standard errors in the summary.
    integer, parameter :: error_digits = 3
    !> Half the probability outside the intervals; the quantile that belongs to a known standard deviation.
    real(dp), parameter :: tail = 0.025_dp, normal_quantile = 1.9599639845400542_dp

    !> Measurements, and the sought numbers.
    type, extends(study_t) :: fit_study_t
        private
        type(measurements_t), allocatable :: measured(:)
        type(unknowns_t) :: sought
    contains
        procedure :: check
        procedure :: run
        procedure :: forecast
    end type fit_study_t

    !> The columns of the table of parameters, before those of the covariance.
    type(column), parameter :: fit_columns(*) = [ &
        column('parameter', '', 'sought parameter of the input', 'fit', traits=categorical), &
        column('unit', '', 'its unit, which is that of the next five columns', 'fit', traits=categorical), &
        column('estimate', '', 'value with the least sum of squares', 'fit'), &
        column('standard_error', '', 'standard error of the estimate, by the linear model', 'fit'), &
        column('lower', '', 'lower end of the 95 % profile interval', 'fit'), &
        column('upper', '', 'upper end of the 95 % profile interval', 'fit'), &
        column('start', '', 'value of the input, where the search began', 'fit'), &
        column('singular_value', '', 'singular values of the scaled Jacobian, from the largest: one per row', 'fit')]

contains

    !> Reads the measurements, and plans the motions up to the last of them.
    subroutine check(self, job, problems)
        class(fit_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(scene_t), allocatable :: scene
        type(fit_model_t), allocatable, target :: model
        type(plan_t) :: plan
        type(problems_t) :: reasons
        character(:), allocatable :: hint
        integer :: unknown, readings, i, run
        logical :: knows_start
        real(dp) :: last

        knows_start = is_set(job%input%scene%fit%time_offset)
        call job%input%scene%fit%set_defaults()
        call read_measurements(job%input%path, job%input%scene%fit, self%measured, problems)
        call find_unknowns(job, self%measured, self%sought, problems)
        if (any(is_set([job%input%scene%nutations, job%input%scene%precessions])) .or. job%input%scene%stop_at /= '') then
            call problems%add('span', 'the span of a fit is that of its measurements', 'omit the group, or give t_end')
        end if
        if (problems%any()) return
        associate (fit => job%input%scene%fit, t_end => job%input%scene%t_end)
            last = maxval([(maxval(self%measured(run)%t), run=1, size(self%measured))]) + fit%time_offset + fit%averaged / 2
            if (.not. is_set(t_end)) t_end = last
            if (t_end < last) call problems%add('span.t_end', 'the last measurement is at t = ' // to_text(last) // ' s', &
                                                'omit t_end')
        end associate
        call job%make_first_case(scene, problems, planned=.true.)
        if (problems%any()) return
        ! The plan is one for all bodies that are sought: where the first has a closed form and others have none, all motions are
        ! integrated. A method or formulation that the input names stays, and must be for all.
        allocate (model)
        associate (names => self%sought%names)
            call model%prepare(job%input%scene, self%sought, job%case, job%plan, self%measured)
            do i = 1, size(names)
                call model%plan_with_another(i, plan, reasons)
                if (reasons%any()) then
                    hint = "use method = 'auto' and formulation = 'auto'"
                    if (names(i)%text == 'top.inertia(2)') hint = 'seek top.inertia(1), which stands for both, or ' // hint
                    call problems%add('fit.unknown', 'the body with another ' // names(i)%text // &
                                      ' has no motion by this method or formulation', hint)
                else if (job%plan%exact .and. .not. plan%exact) then
                    job%plan = plan
                end if
            end do
        end associate
        deallocate (model)
        if (problems%any()) return
        if (.not. job%plan%exact .and. .not. job%plan%is_adaptive()) then
            call problems%add('integration.method', 'a method with a fixed step size has no values at the times of the &
                &measurements', 'use an adaptive method')
        end if
        if (problems%any()) return
        unknown = size(self%sought%names)
        readings = sum(self%measured%size())
        self%phrase = 'a fit of ' // counted(unknown, 'parameter') // ' to ' // counted(readings, 'measurement') // &
                      ' at ' // counted(sum([(size(self%measured(run)%t), run=1, size(self%measured))]), 'time')
        if (size(self%measured) > 1) self%phrase = self%phrase // ' of ' // counted(size(self%measured), 'run')
        allocate (model)
        call model%prepare(job%input%scene, self%sought, job%case, job%plan, self%measured)
        do run = 1, size(self%measured)
            reasons = problems_t()
            call check_measurements(model, run, job%input%scene%fit, knows_start, reasons)
            call problems%add_all(reasons, self%measured(run)%label)
        end do
        if (readings <= unknown) then
            call problems%add('fit.data', to_text(readings) // ' measurements do not determine ' // &
                              to_text(unknown) // ' parameters and their errors', 'give more measurements')
        end if
    end subroutine check

    !> Fits the parameters; the study fails if the search does not converge, or the data do not determine them.
    subroutine run(self, job, options, summary, code, error)
        class(fit_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(fit_model_t), allocatable, target :: model
        type(search_t) :: search
        type(minimum_t) :: minimum
        type(estimate_t) :: estimate
        type(judgement_t) :: judgement
        type(string_t), allocatable :: warnings(:)
        character(:), allocatable :: ending, criterion
        real(dp) :: began, ends(2)
        integer :: i, k
        logical :: is_noisy

        began = seconds()
        code = exit_ok
        allocate (model)
        associate (names => self%sought%names)
            call model%prepare(job%input%scene, self%sought, job%case, job%plan, self%measured)
            search%kind = max(loss_squares, findloc(loss_names, job%input%scene%fit%loss, dim=1))
            search%most = job%input%scene%fit%searches
            search%has_windows = job%input%scene%fit%windows
            call model%progress%start(job%name, 'parts', model%parts, options%quiet, options%progress)
            call find_minimum(job%input%scene%fit%profile, model, search, minimum, estimate)
            call model%progress%finish()
            is_noisy = norm2(minimum%residuals) > far_above * sqrt(real(size(minimum%residuals), dp)) * &
                       estimate%error_of_model
            call judge(model, minimum, is_noisy, .true., judgement)
            do i = 1, merge(size(names), 0, judgement%is_poor)
                ends = model%ends(i)
                if (minimum%x(i) > ends(1) .and. minimum%x(i) < ends(2)) cycle
                judgement%reason = judgement%reason // '; ' // names(i)%text // ' is at the end of its range, ' // &
                                   to_text(minimum%x(i))
            end do
            ending = end_of_search(minimum, estimate, judgement, names)
            criterion = ''
            if (is_noisy .and. .not. model%loss%is_robust()) criterion = fixed(information(model, minimum), 2)
            if (ending /= 'ok') code = exit_failed
            call move_alloc(judgement%warnings, warnings)
            do k = 1, size(self%measured)
                if (model%is_mirrored(k)) call append(warnings, self%measured(k)%label // 'the start is beyond the pole: where &
                    &they are not sought, initial.phi and initial.psi differ from the input by half a turn, and initial.theta_rate &
                    &by its sign')
            end do
            do i = 1, size(names)
                if (.not. estimate%is_followed(i)) call append(warnings, 'the profile of ' // names(i)%text // ' could not be &
                    &followed: an end of its interval is that of the linear model')
            end do
            do i = 1, size(warnings)
                if (i > 1) job%late_warnings = job%late_warnings // new_line('a')
                job%late_warnings = job%late_warnings // escaped(job%input%path) // ': warning: ' // warnings(i)%text
            end do
            call write_estimates(job, self%sought, estimate, warnings, criterion, ending, error)
            do k = 1, size(self%measured)
                if (.not. allocated(error)) call write_residuals(job, model, k, minimum%x, ending, error)
            end do
        end associate
        if (allocated(error)) return
        call describe_fit(self, job, options, search, model, minimum, estimate, judgement, criterion, ending, seconds() - began, &
                          summary)
    end subroutine run

    !> Adds what was understood of the tables of measurements.
    subroutine forecast(self, job, options, summary)
        class(fit_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(inout) :: summary !! lines are added
        integer :: i
        do i = 1, size(self%measured)
            associate (run => self%measured(i))
                call summary%add('columns', run%label // run%notes(1)%text)
                call summary%add('clock', run%label // run%notes(2)%text)
            end associate
        end do
    end subroutine forecast

    !> Searches for the minimum, and from each place with a smaller sum of squares that a profile meets.
    subroutine find_minimum(wants_profile, model, search, minimum, estimate)
        logical, intent(in) :: wants_profile
        type(fit_model_t), target, intent(inout) :: model
        type(search_t), intent(inout) :: search
        type(minimum_t), intent(out) :: minimum
        type(estimate_t), intent(out) :: estimate
        integer, parameter :: most_searches = 10
        real(dp) :: level
        logical :: knows_sigma
        integer :: i

        knows_sigma = model%measured(1)%knows_sigma
        level = normal_quantile
        if (search%kind /= loss_squares .or. .not. knows_sigma) then
            level = student_quantile(tail, size(model%data) - size(model%sought%start))
        end if
        call search_minimum(model, model%sought%start, search, minimum)
        do i = 1, most_searches
            call describe_minimum(model, minimum, knows_sigma, wants_profile .and. minimum%has_converged, &
                                  level, estimate)
            if (.not. allocated(estimate%better)) exit
            call finish_search(model, [estimate%better], search, minimum)
        end do
        minimum%has_converged = minimum%has_converged .and. .not. allocated(estimate%better)
        do i = 1, size(search%places, 2)
            if (minimum%has_converged .and. estimate%is_identifiable) call compare_with(model, search%places(:, i), minimum, &
                level, estimate)
        end do
    end subroutine find_minimum

    !> How the search ended.
    function end_of_search(minimum, estimate, judgement, known) result(ending)
        type(minimum_t), intent(in) :: minimum
        type(estimate_t), intent(in) :: estimate
        type(judgement_t), intent(in) :: judgement
        type(string_t), intent(in) :: known(:) !! the names of the parameters
        character(:), allocatable :: ending
        character(:), allocatable :: names
        integer :: i

        ending = 'ok'
        names = ''
        do i = 1, size(known)
            if (.not. estimate%is_undetermined(i)) cycle
            if (names /= '') names = names // ', '
            names = names // known(i)%text
        end do
        if (.not. minimum%has_converged) then
            ending = 'not_converged: the search ended elsewhere than at a minimum'
        else if (judgement%is_poor) then
            ending = 'poor_fit: ' // judgement%reason
        else if (.not. estimate%is_identifiable) then
            ending = 'not_identifiable: the measurements do not determine ' // names
            if (.not. all(estimate%is_bounded)) ending = 'not_identifiable: the measurements give no bound for ' // names
        end if
    end function end_of_search

    !> The summary: the motion, the parameters with their intervals, the residuals, and how the search ended.
    subroutine describe_fit(self, job, options, search, model, minimum, estimate, judgement, criterion, ending, time, summary)
        type(fit_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job
        type(options_t), intent(in) :: options
        type(search_t), intent(in) :: search
        type(fit_model_t), intent(in) :: model
        type(minimum_t), intent(in) :: minimum
        type(estimate_t), intent(in) :: estimate
        type(judgement_t), intent(in) :: judgement
        character(*), intent(in) :: criterion, ending
        real(dp), intent(in) :: time
        type(summary_t), intent(inout) :: summary
        character(:), allocatable :: text
        integer :: i, m, n

        m = size(minimum%residuals)
        n = size(minimum%x)
        text = job%input%path // ': ' // self%phrase // ' -> ' // job%files%table
        do i = 1, size(self%measured)
            text = text // ', ' // residual_path(job%files%table, i)
        end do
        call summary%headline(text)
        call self%forecast(job, options, summary)
        call summary%describe_plan(job%plan)
        do i = 1, n
            associate (error => estimate%standard_error(i))
                text = ' = ' // as_exact(estimate%x(i), error) // ' +- ' // rounded(error, error_digits)
                if (job%input%scene%fit%profile) text = text // ', 95 %: ' // as_exact(estimate%lower(i), error) // ' to ' // &
                                                        as_exact(estimate%upper(i), error)
            end associate
            call summary%add(self%sought%names(i)%text, text)
        end do
        text = told_correlations(self%sought%names, estimate)
        if (text /= '') call summary%add('correlation', ' ' // text)
        if (self%measured(1)%knows_sigma) then
            call summary%add('chi2', rounded(judgement%chi2, 6) // ' for ' // to_text(judgement%freedom) // &
                             ' degrees of freedom, probability ' // rounded(judgement%probability, 3))
        else
            do i = 1, size(self%measured)
                text = self%measured(i)%label // 'standard deviation ' // told_deviations(model, i, minimum, estimate)
                if (i == size(self%measured)) text = text // ', ' // to_text(m - n) // ' degrees of freedom'
                call summary%add('residuals', text)
            end do
        end if
        if (model%loss%is_robust()) then
            call summary%add('loss', trim(loss_names(model%loss%kind)) // ': ' // &
                             to_text(count(abs(minimum%residuals) > model%loss%bound)) // ' of ' // to_text(m) // &
                             ' residuals are beyond its bound')
        end if
        if (criterion /= '') call summary%add('AIC', criterion)
        call summary%add('search', to_text(search%steps) // ' steps, ' // to_text(search%evaluations) // ' evaluations from ' // &
                         counted(search%searches, 'start') // ', first by ' // counted(search%windows, 'window') // &
                         ' from ' // rounded(search%first_span, 3) // ' s', is_detail=.true.)
        call summary%add('time', rounded(time) // ' s')
        call summary%add('status', ending)
    end subroutine describe_fit

    !> The pairs of parameters that hardly can be told apart, the strongest correlations first.
    function told_correlations(names, estimate) result(text)
        type(string_t), intent(in) :: names(:)
        type(estimate_t), intent(in) :: estimate
        character(:), allocatable :: text
        real(dp), parameter :: strong = 0.9_dp
        integer, parameter :: most = 5 ! pairs that are named
        real(dp) :: r(size(names), size(names))
        integer :: i, k, pair(2)

        r = 0
        do k = 2, size(names)
            do i = 1, k - 1
                r(i, k) = estimate%covariance(i, k) / (estimate%standard_error(i) * estimate%standard_error(k))
            end do
        end do
        text = ''
        do i = 1, min(most, count(abs(r) > strong))
            pair = maxloc(abs(r), mask=abs(r) > strong)
            if (i > 1) text = text // ', '
            text = text // names(pair(1))%text // ' and ' // names(pair(2))%text // ' ' // &
                   fixed(r(pair(1), pair(2)), 4)
            r(pair(1), pair(2)) = 0
        end do
        if (any(abs(r) > strong)) text = text // ', ' // counted(count(abs(r) > strong), 'more pair')
    end function told_correlations

    !> A number down to the last digit of its standard error; with nine digits where there is none.
    function as_exact(value, error) result(text)
        real(dp), intent(in) :: value, error
        character(:), allocatable :: text
        integer :: digits
        digits = 9
        if (abs(value) > 0 .and. is_finite(value) .and. error > 0 .and. is_finite(error)) then
            digits = error_digits + floor(log10(abs(value))) - floor(log10(error))
        end if
        text = rounded(value, min(max(digits, error_digits), 17))
    end function as_exact

    !> A number with so many decimals.
    function fixed(value, decimals) result(text)
        real(dp), intent(in) :: value
        integer, intent(in) :: decimals
        character(:), allocatable :: text
        character(32) :: buffer
        write (buffer, '(ss, f32.' // to_text(decimals) // ')') value
        text = trim(adjustl(buffer))
    end function fixed

    !> The standard deviations that were found of the columns of a run, with their units where those of some run differ.
    function told_deviations(model, run, minimum, estimate) result(text)
        type(fit_model_t), intent(in) :: model
        integer, intent(in) :: run
        type(minimum_t), intent(in) :: minimum
        type(estimate_t), intent(in) :: estimate
        character(:), allocatable :: text
        real(dp) :: deviation
        integer :: i

        deviation = estimate%deviation
        if (model%loss%is_robust()) deviation = robust_deviation(minimum%residuals, size(minimum%x))
        associate (measured => model%measured(run), first => model%measured(1)%sigma(1, 1))
            text = rounded(deviation * first, 6)
            if (.not. any([(any(abs(model%measured(i)%sigma - first) > 0), i=1, size(model%measured))])) return
            do i = 1, size(measured%columns)
                if (i == 1) text = ''
                if (i > 1) text = text // ', '
                text = text // trim(measured%columns(i)%name) // ' ' // rounded(deviation * measured%sigma(i, 1), 4)
                if (measured%columns(i)%unit /= '') text = text // ' ' // trim(measured%columns(i)%unit)
            end do
        end associate
    end function told_deviations

    !> Path of the table of residuals of a run: that of the first has no number.
    function residual_path(path, run) result(other)
        character(*), intent(in) :: path !! path of the table of parameters
        integer, intent(in) :: run !! which run
        character(:), allocatable :: other
        other = stem_of(path) // '.residuals'
        if (run > 1) other = other // to_text(run)
        other = other // '.csv'
    end function residual_path

    !> Writes the table of the parameters.
    subroutine write_estimates(job, sought, estimate, warnings, criterion, ending, error)
        type(job_t), intent(in) :: job !! the job
        type(unknowns_t), intent(in) :: sought !! the parameters
        type(estimate_t), intent(in) :: estimate !! their values and uncertainty
        type(string_t), intent(in) :: warnings(:) !! what is odd about the fit
        character(*), intent(in) :: criterion !! that of Akaike, or ''
        character(*), intent(in) :: ending !! how the search ended
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(column_t), allocatable :: columns(:)
        type(table_file_t) :: file
        type(text_buffer_t) :: cells
        type(string_t), allocatable :: trailer(:)
        integer :: i, n

        n = size(fit_columns)
        allocate (columns(n + size(sought%names)))
        columns(:n) = fit_columns%column_t
        do i = 1, size(sought%names)
            associate (name => sought%names(i)%text)
                columns(n + i) = column_t('covariance__' // name, '', 'covariance with ' // name)
            end associate
        end do
        do i = 1, size(warnings)
            call append(trailer, 'warning: ' // warnings(i)%text)
        end do
        if (criterion /= '') call append(trailer, 'AIC: ' // criterion)
        call append(trailer, 'status: ' // ending)
        call file%create(job%files%table, study_head(job, columns), error)
        if (allocated(error)) return
        do i = 1, size(sought%names)
            call cells%clear()
            call cells%add_name(sought%names(i)%text)
            call cells%add_text(sought%keys(sought%key(i))%unit)
            call cells%add_reals([estimate%x(i), estimate%standard_error(i), estimate%lower(i), estimate%upper(i), &
                                  sought%start(i), estimate%singular_values(i), estimate%covariance(i, :)])
            call cells%end_row()
            call file%append(cells%contents(), error)
            if (allocated(error)) exit
        end do
        if (.not. allocated(error)) call file%finish(trailer, error)
        if (allocated(error)) call file%discard()
    end subroutine write_estimates

    !> Writes the table of residuals of a run: the measurements, the values of the fitted motion, and their differences.
    subroutine write_residuals(job, model, run, x, ending, error)
        type(job_t), intent(in) :: job !! the job
        type(fit_model_t), intent(inout) :: model !! the measurements, and the motion
        integer, intent(in) :: run !! which run
        real(dp), intent(in) :: x(:) !! the parameters
        character(*), intent(in) :: ending !! how the search ended
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(column_t), allocatable :: columns(:)
        type(table_file_t) :: file
        type(string_t) :: trailer(1)
        real(dp), allocatable :: cells(:), values(:, :), differences(:, :)
        logical :: is_valid
        integer :: i

        associate (measured => model%measured(run))
            call model%predict(x, run, size(measured%t), values, is_valid)
            allocate (differences, source=measured%differences(values))
            allocate (columns(1 + 3 * size(measured%columns)), cells(1 + 3 * size(measured%columns)))
            columns(1) = column_t(measured%time%name, measured%time%unit, 'time')
            do i = 1, size(measured%columns)
                associate (own => measured%columns(i))
                    columns(3 * i - 1) = column_t(own%name, own%unit, 'measured: ' // trim(own%what))
                    columns(3 * i) = column_t(trim(own%name) // '_fit', own%unit, trim(own%name) // ' of the fitted motion')
                    columns(3 * i + 1) = column_t(trim(own%name) // '_residual', own%unit, 'measured less fitted')
                end associate
            end do
            trailer(1)%text = 'status: ' // ending
            call file%create(residual_path(job%files%table, run), study_head(job, columns), error)
            if (allocated(error)) return
            do i = 1, size(measured%t)
                ! Where there is no reading there is no residual.
                cells(1) = measured%given_times(i)
                cells(2::3) = measured%values(:, i)
                cells(3::3) = values(:, i)
                cells(4::3) = merge(differences(:, i), no_number, is_finite(measured%values(:, i)))
                call file%add_row(cells, error)
                if (allocated(error)) exit
            end do
        end associate
        if (.not. allocated(error)) call file%finish(trailer, error)
        if (allocated(error)) call file%discard()
    end subroutine write_residuals

end module spintop_fit_study
