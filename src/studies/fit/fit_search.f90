!> The search of a fit. A sum of squares over many turns of a motion has many minima, and only a start that predicts the turns
!> within half of one leads to the right one. So the search begins with the first rows, whose minimum is wide, and doubles their
!> span: each fit predicts the turns of the next. Where the end of it does not explain the measurements, it begins elsewhere.
module spintop_fit_search
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_fit_judgement, only: judge, judgement_t
    use spintop_fit_model, only: fit_model_t
    use spintop_kinds, only: dp, pi
    use spintop_least_squares, only: minimize, minimum_t
    use spintop_losses, only: loss_huber, loss_squares, loss_t
    use spintop_robust, only: minimize_loss, robust_deviation
    use spintop_sobol_sequence, only: sobol_sequence_t
    use spintop_parameters, only: is_set
    implicit none
    private
    public :: search_t, search_minimum, finish_search, first_rows, period_of, far_above

    !> The first window has so many periods of the motion, and readings per sought parameter. The search in a window ends where
    !> no more than this part of the sum of squares can be gained; its loss is found in so many rounds.
    real(dp), parameter :: first_periods = 2
    integer, parameter :: readings_per_parameter = 3, rounds = 2
    !> The standard deviations of the columns are found in so many searches at most.
    integer, parameter :: most_weighings = 10
    real(dp), parameter :: window_goal = 1.0e-3_dp
    !> In a window the parameters are held within about this part of where the search began.
    real(dp), parameter :: held_within = 0.05_dp
    !> The span of a window is so many times that of the one before; where that fails, so many times.
    real(dp), parameter :: growth = 2, slow_growth = 1.4_dp, at_once = huge(1.0_dp)
    !> All rows lead from the start to what is left to gain of the sum of squares, in so many steps at most.
    !> That is the better way if the sum is smaller by this part.
    real(dp), parameter :: direct_goal = 1.0e-5_dp, smaller = 1.0e-8_dp
    integer, parameter :: direct_steps = 10
    !> Other starts are within these parts of the values, in turn, if no range is given.
    real(dp), parameter :: widths(3) = [0.02_dp, 0.05_dp, 0.1_dp]
    !> Residuals that are so far above the errors of the motion are those of the measurements.
    real(dp), parameter :: far_above = 1.0e3_dp

    !> A search, and what it did.
    type :: search_t
        !> The loss, the largest number of starts, and whether it begins with the first rows.
        integer :: kind = 1, most = 1
        logical :: has_windows = .true.
        !> Period of the motion where the search begins, s.
        real(dp) :: period = 0
        !> Starts and windows that were tried, and all evaluations and steps.
        integer :: searches = 1, windows = 0, evaluations = 0, steps = 0
        !> Where the searches of all rows began and ended, and the best of their ends with what the model was there.
        real(dp), allocatable :: places(:, :)
        type(minimum_t) :: best
        real(dp) :: least_misfit = 0
        type(loss_t) :: loss
        real(dp), allocatable :: sigma(:, :)
        logical :: is_mirrored = .false.
        !> Span of the first window, s.
        real(dp) :: first_span = 0
    end type search_t

contains

    !> A period of the motion: that of the rotation or of small oscillations, the smaller one, s.
    real(dp) function period_of(case) result(period)
        type(case_t), intent(in) :: case !! body and start
        period = 2 * pi / max(norm2(case%start%omega), sqrt(norm2(case%body%weight_moment()) / minval(case%body%inertia)), &
                              tiny(period))
    end function period_of

    !> Finds the parameters that explain the measurements: the best minimum of those to which all rows lead from the start, and
    !> windows of rows, and if these do not explain the measurements, others. The model is that of the best one then.
    subroutine search_minimum(model, start, search, minimum)
        type(fit_model_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: start(:) !! where the search begins
        type(search_t), intent(inout) :: search !! how to search; what was tried
        type(minimum_t), intent(out) :: minimum !! the best that was found
        type(sobol_sequence_t) :: sequence
        real(dp) :: fractions(size(start)), x(size(start)), width
        integer :: i, k

        allocate (search%places(size(start), 0))
        search%first_span = maxval(model%measured%t) - minval(model%measured%t)
        call search_from(model, start, merge(growth, at_once, search%has_windows), search)
        if (search%has_windows) call look_around(model, start, search)
        call sequence%start(size(start), 0_int64)
        do i = 1, search%most - 1
            if (explains(model, search%best)) exit
            call sequence%find_point(int(i, int64), fractions)
            width = widths(1 + mod(i - 1, size(widths)))
            do k = 1, size(x)
                x(k) = start(k) + width * (2 * fractions(k) - 1) * model%step_scale(k, start(k))
                associate (range => model%ranges(k, :))
                    if (all(is_set(range))) x(k) = range(1) + fractions(k) * (range(2) - range(1))
                end associate
                x(k) = model%limited(k, x(k))
            end do
            search%searches = search%searches + 1
            call search_from(model, x, merge(growth, at_once, search%has_windows), search)
        end do
        minimum = search%best
    end subroutine search_minimum

    !> Looks for what the windows led away from: what all rows lead to at once; and windows that grow slowly.
    subroutine look_around(model, start, search)
        type(fit_model_t), intent(inout) :: model
        real(dp), intent(in) :: start(:)
        type(search_t), intent(inout) :: search
        type(minimum_t) :: other

        if (.not. model%is_mirrored) then
            call minimize(model, start, model%measured%size(), spread(.true., 1, size(start)), other, direct_goal, &
                          most=direct_steps * (size(start) + 1))
            search%evaluations = search%evaluations + other%evaluations
            search%steps = search%steps + other%steps
            search%places = reshape([search%places, other%x], [size(start), size(search%places, 2) + 1])
            if (other%sum_of_squares < (1 - smaller) * search%best%sum_of_squares) then
                call search_from(model, [other%x], at_once, search)
            end if
        end if
        if (.not. explains(model, search%best)) call search_from(model, start, slow_growth, search)
    end subroutine look_around

    !> Searches from a place, and on from a pole beyond it. The model is that of the best minimum then.
    subroutine search_from(model, place, growth, search)
        type(fit_model_t), intent(inout) :: model
        real(dp), intent(in) :: place(:)
        real(dp), intent(in) :: growth !! of the windows
        type(search_t), intent(inout) :: search
        real(dp) :: x(size(place))

        x = place
        if (model%is_mirrored) call model%mirror(x)
        x = place
        if (growth < at_once) call search_in_windows(model, x, growth, search)
        call model%use_rows(size(model%measured%t))
        call finish_at(model, x, search)
        if (model%is_at_pole(x)) then
            call model%mirror(x)
            call finish_at(model, x, search)
        end if
        model%share = max(model%share, 0.5_dp * search%searches / search%most)
        model%loss = search%loss
        model%measured%sigma = search%sigma
        call model%use_rows(size(model%measured%t))
        if (model%is_mirrored .neqv. search%is_mirrored) call model%mirror(x)
    end subroutine search_from

    !> Finds the minimum near a place, and keeps it if it is the best: a smaller misfit, or a minimum instead of a search that
    !> ended elsewhere.
    subroutine finish_at(model, x, search)
        type(fit_model_t), intent(inout) :: model
        real(dp), intent(inout) :: x(:)
        type(search_t), intent(inout) :: search
        real(dp), parameter :: same = 1.0e-6_dp ! of variances
        type(minimum_t) :: found
        real(dp) :: rise

        call finish_search(model, x, search, found)
        search%places = reshape([search%places, x, found%x], [size(x), size(search%places, 2) + 2])
        x = found%x
        rise = misfit(model, found, search%kind) - search%least_misfit
        if (allocated(search%sigma) .and. (rise > same .or. (rise > -same .and. (search%best%has_converged .or. &
            .not. found%has_converged)))) return
        search%best = found
        search%least_misfit = search%least_misfit + rise
        search%loss = model%loss
        search%sigma = model%measured%sigma
        search%is_mirrored = model%is_mirrored
    end subroutine finish_at

    !> How badly a minimum explains the measurements: the logarithm of its likelihood, so that minima with other weights of the
    !> columns can be compared.
    real(dp) function misfit(model, minimum, kind)
        type(fit_model_t), intent(in) :: model
        type(minimum_t), intent(in) :: minimum
        integer, intent(in) :: kind
        real(dp), parameter :: least = 1.0e-13_dp ! of the readings
        real(dp) :: deviation

        misfit = huge(misfit)
        if (.not. minimum%sum_of_squares < huge(misfit)) return
        associate (m => size(minimum%residuals), measured => model%measured)
            deviation = sqrt(minimum%sum_of_squares / m)
            if (kind /= loss_squares .and. .not. measured%knows_sigma) deviation = robust_deviation(minimum%residuals, 0)
            misfit = m * log(max(deviation, max(least, model%precision) * norm2(model%data) / sqrt(real(m, dp)), tiny(misfit)))
            if (.not. measured%knows_sigma) misfit = misfit + sum(count(measured%is_there, dim=2) * log(measured%sigma(:, 1)))
        end associate
    end function misfit

    !> Whether a minimum explains the measurements.
    logical function explains(model, minimum)
        type(fit_model_t), intent(inout) :: model
        type(minimum_t), intent(in) :: minimum
        type(judgement_t) :: judgement
        real(dp) :: readings(size(model%measured%columns), size(model%measured%t))
        logical :: is_valid, is_noisy

        explains = .false.
        if (.not. minimum%has_converged) return
        call model%predict(minimum%x, readings, is_valid)
        if (.not. is_valid) return
        is_noisy = norm2(minimum%residuals) > far_above * max(model%precision, epsilon(1.0_dp)) * norm2(model%data)
        call judge(model%measured, model%differences(readings), minimum, model%loss, is_noisy, .false., judgement)
        explains = .not. judgement%is_poor
    end function explains

    !> Moves the parameters to a place from which all rows lead to a minimum: window by window.
    subroutine search_in_windows(model, x, growth, search)
        type(fit_model_t), intent(inout) :: model
        real(dp), intent(inout) :: x(:)
        real(dp), intent(in) :: growth
        type(search_t), intent(inout) :: search
        real(dp) :: start(size(x))
        integer :: rows

        start = x
        associate (t => model%measured%t, all_rows => size(model%measured%t))
            rows = first_rows(model, search%period, size(start))
            search%first_span = t(rows) - t(1)
            do
                call search_in_window(model, rows, start, x, search)
                if (rows == all_rows) exit
                model%share = max(model%share, 0.5_dp * (search%searches - 1 + real(rows, dp) / all_rows) / search%most)
                rows = min(max(count(t - t(1) <= growth * (t(rows) - t(1))), rows + 1), all_rows)
            end do
        end associate
    end subroutine search_in_windows

    !> Finds the minimum of all rows from a place near it, and the standard deviation of each column, if they are not known.
    subroutine finish_search(model, x, search, minimum)
        type(fit_model_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: x(:) !! the place
        type(search_t), intent(inout) :: search !! how to search; what was tried
        type(minimum_t), intent(out) :: minimum !! the minimum
        real(dp) :: from(size(x)), change
        integer :: i

        from = x
        call model%weigh(from, search%kind /= loss_squares, change)
        do i = 1, most_weighings
            call minimize_loss(model, from, model%measured%size(), search%kind, model%measured%knows_sigma, minimum)
            search%evaluations = search%evaluations + minimum%evaluations
            search%steps = search%steps + minimum%steps
            if (.not. minimum%has_converged) exit
            from = minimum%x
            call model%weigh(from, search%kind /= loss_squares, change)
            if (.not. change > 0) exit
        end do
    end subroutine finish_search

    !> Number of rows in the first window.
    integer function first_rows(model, period, parameters) result(rows)
        type(fit_model_t), intent(in) :: model !! the residuals
        real(dp), intent(in) :: period !! of the motion, s
        integer, intent(in) :: parameters !! number of sought numbers
        associate (measured => model%measured)
            rows = count(measured%t - measured%t(1) <= first_periods * period)
            do while (rows < size(measured%t))
                if (count(measured%is_there(:, :rows)) >= readings_per_parameter * parameters) exit
                rows = rows + 1
            end do
            rows = min(max(rows, 2), size(measured%t))
        end associate
    end function first_rows

    !> Moves the parameters to the minimum in a window, roughly, with a loss that wrong rows do not spoil.
    subroutine search_in_window(model, rows, start, x, search)
        type(fit_model_t), intent(inout) :: model
        integer, intent(in) :: rows
        real(dp), intent(in) :: start(:)
        real(dp), intent(inout) :: x(:)
        type(search_t), intent(inout) :: search
        real(dp), allocatable :: residuals(:)
        real(dp) :: deviation, change
        type(minimum_t) :: minimum
        logical :: is_valid
        integer :: i

        search%windows = search%windows + 1
        do i = 1, rounds
            call model%use_rows(rows)
            call model%weigh(x, .true., change)
            if (allocated(residuals)) deallocate (residuals)
            allocate (residuals(size(model%data)))
            call model%evaluate(x, residuals, is_valid)
            search%evaluations = search%evaluations + 1
            if (.not. is_valid) return
            deviation = robust_deviation(residuals, size(x))
            if (.not. deviation > 0) return
            model%loss = loss_t(loss_huber, deviation)
            call model%use_rows(rows, start, deviation / held_within)
            call minimize(model, x, size(model%data), spread(.true., 1, size(x)), minimum, window_goal)
            search%evaluations = search%evaluations + minimum%evaluations
            search%steps = search%steps + minimum%steps
            if (minimum%sum_of_squares < huge(deviation)) x = minimum%x
        end do
    end subroutine search_in_window

end module spintop_fit_search
