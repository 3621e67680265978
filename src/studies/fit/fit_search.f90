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
        integer :: searches = 0, windows = 0, evaluations = 0, steps = 0
        !> The parameters that explain the measurements where they are held near the start.
        real(dp), allocatable :: held(:)
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

    !> Finds the parameters that explain the measurements.
    subroutine search_minimum(model, start, search, minimum)
        type(fit_model_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: start(:) !! where the search begins
        type(search_t), intent(inout) :: search !! how to search; what was tried
        type(minimum_t), intent(out) :: minimum !! the best that was found
        type(minimum_t) :: other
        type(sobol_sequence_t) :: sequence
        type(loss_t) :: loss
        real(dp) :: sigma(size(model%measured%sigma, 1), size(model%measured%sigma, 2))
        real(dp) :: fractions(size(start)), x(size(start)), width, least_misfit, other_misfit
        integer :: i, k

        call search_from(model, start, search, minimum)
        if (explains(model, minimum)) return
        loss = model%loss
        sigma = model%measured%sigma
        least_misfit = huge(least_misfit)
        if (minimum%has_converged) least_misfit = misfit(model, minimum%x)
        call sequence%start(size(start), 0_int64)
        do i = 1, search%most - 1
            call sequence%find_point(int(i, int64), fractions)
            width = widths(1 + mod(i - 1, size(widths)))
            do k = 1, size(x)
                x(k) = start(k) + width * (2 * fractions(k) - 1) * model%step_scale(k, start(k))
                associate (range => model%ranges(k, :))
                    if (all(is_set(range))) x(k) = range(1) + fractions(k) * (range(2) - range(1))
                end associate
                x(k) = model%limited(k, x(k))
            end do
            call search_from(model, x, search, other)
            if (.not. other%has_converged) cycle
            other_misfit = misfit(model, other%x)
            if (minimum%has_converged .and. .not. other_misfit < least_misfit) cycle
            minimum = other
            least_misfit = other_misfit
            loss = model%loss
            sigma = model%measured%sigma
            if (explains(model, minimum)) exit
        end do
        model%loss = loss
        model%measured%sigma = sigma
        call model%use_rows(size(model%measured%t))
    end subroutine search_minimum

    !> How badly parameters explain the measurements: the logarithm of the deviation of each reading, by the median, so that
    !> minima with other weights of the columns can be compared.
    real(dp) function misfit(model, x)
        type(fit_model_t), intent(inout) :: model
        real(dp), intent(in) :: x(:)
        real(dp) :: readings(size(model%measured%columns), size(model%measured%t))
        real(dp) :: differences(size(readings, 1), size(readings, 2))
        real(dp), allocatable :: residuals(:)
        logical :: is_valid
        integer :: i

        misfit = huge(misfit)
        call model%predict(x, readings, is_valid)
        if (.not. is_valid) return
        differences = model%differences(readings)
        misfit = 0
        if (model%measured%knows_sigma) differences = differences / model%measured%sigma
        do i = 1, size(readings, 1)
            residuals = pack(differences(i, :), model%measured%is_there(i, :))
            misfit = misfit + size(residuals) * log(max(robust_deviation(residuals, 0), tiny(misfit)))
        end do
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

    !> Searches from one start: window by window, then all rows.
    subroutine search_from(model, start, search, minimum)
        type(fit_model_t), intent(inout) :: model
        real(dp), intent(in) :: start(:)
        type(search_t), intent(inout) :: search
        type(minimum_t), intent(out) :: minimum
        real(dp) :: x(size(start))
        integer :: rows

        search%searches = search%searches + 1
        x = start
        associate (t => model%measured%t, all_rows => size(model%measured%t))
            rows = all_rows
            if (search%has_windows) rows = first_rows(model, search%period, size(start))
            search%first_span = t(rows) - t(1)
            do while (search%has_windows)
                call search_in_window(model, rows, start, x, search)
                if (rows == all_rows) exit
                rows = min(max(count(t - t(1) <= 2 * (t(rows) - t(1))), rows + 1), all_rows)
            end do
            call model%use_rows(all_rows)
            search%held = x
        end associate
        call finish_search(model, x, search, minimum)
    end subroutine search_from

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
