!> The search of a fit. A sum of squares over many turns of a motion has many minima, and only a start that predicts the turns
!> within half of one leads to the right one. So the search begins with the first rows, whose minimum is wide, and doubles their
!> span: each fit predicts the turns of the next. Where the end of it does not explain the measurements, it begins elsewhere.
!> What is odd about the measurements is told before.
module spintop_fit_search
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_fit_data, only: measurements_t
    use spintop_fit_model, only: fit_model_t
    use spintop_kinds, only: dp, pi
    use spintop_least_squares, only: minimize, minimize_loss, minimum_t, robust_deviation
    use spintop_parameters, only: is_set
    use spintop_probability, only: chi_square_tail, find_correlation, find_drift, find_period, von_neumann_ratio
    use spintop_problems, only: problems_t
    use spintop_residuals, only: loss_huber, loss_squares, loss_t
    use spintop_scene_keys, only: fit_scene_t, sensors_t
    use spintop_sobol_sequence, only: sobol_sequence_t
    use spintop_summary, only: rounded
    use spintop_text, only: to_text, append, string_t
    implicit none
    private
    public :: search_t, search_minimum, finish_search, far_above, check_measurements, judgement_t, judge, information

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
        !> Starts and windows that were tried, and all evaluations and steps.
        integer :: searches = 1, windows = 0, evaluations = 0, steps = 0
        !> Where the searches of all rows began and ended, and the best of their ends with what the model was there.
        real(dp), allocatable :: places(:, :)
        type(minimum_t) :: best
        real(dp) :: least_misfit = 0
        type(loss_t) :: loss
        type(measurements_t), allocatable :: measured(:)
        logical, allocatable :: is_mirrored(:)
        !> Span of the first window, of the run with the shortest one, s.
        real(dp) :: first_span = 0
    end type search_t

    !> Periods of the motion between rows beyond which turns are lost, and beyond which the unit of time is doubted where none
    !> are measured: spins are slow in rows of a logger. Radians in all rows below which it is doubted.
    real(dp), parameter :: most_periods = 3, many_periods = 30, least_turn = 0.1_dp
    !> A column turns if it scatters by this part of its measurements within these periods. It is lost if the start leaves this
    !> part in the first rows: turns that are not predicted leave more.
    real(dp), parameter :: turning = 0.5_dp, unexplained = 0.5_dp
    !> An angle theta may be so far outside of [0, pi], by noise or an offset.
    real(dp), parameter :: slack_of_theta = 0.5_dp

    !> A row stands out by so many standard deviations, and more where few rows give them. Rows that stand out have spoiled least
    !> squares where this part of the sum of squares is theirs.
    real(dp), parameter :: standing_out = 6, spoiling = 0.2_dp
    !> Residuals are no noise where the ratio of von Neumann is so far from its mean, 2, and this number of its standard
    !> deviations.
    real(dp), parameter :: far = 1, significant = 4
    !> Nor where far neighbours are correlated by so much, and not by chance. Residuals are cut at so many standard deviations.
    real(dp), parameter :: correlated = 0.04_dp, cut = 3
    !> The sum of squares is too large where it is so many times what is expected and has at most this probability; the
    !> probability below which standard deviations are doubted.
    real(dp), parameter :: too_large = 1.1_dp, impossible = 1.0e-6_dp, doubtful = 1.0e-3_dp
    !> A period or a drift is named that noise has with this probability, or that is so many standard errors.
    real(dp), parameter :: seldom = 1.0e-4_dp, clear_drift = 5

    !> What was found.
    type :: judgement_t
        !> Whether the fit does not explain the measurements, and what stands out then.
        logical :: is_poor = .false.
        character(:), allocatable :: reason
        !> What is odd about the residuals, a sentence each.
        type(string_t), allocatable :: warnings(:)
        !> The sum of squares and its degrees of freedom, where standard deviations are known, and its probability.
        real(dp) :: chi2 = 0, probability = 1
        integer :: freedom = 0
    end type judgement_t

contains

    !> Finds the parameters that explain the measurements: the best minimum of those to which all rows lead from the start, and
    !> windows of rows, and if these do not explain the measurements, others. The model is that of the best one then.
    subroutine search_minimum(model, start, search, minimum)
        type(fit_model_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: start(:) !! where the search begins
        type(search_t), intent(inout) :: search !! how to search; what was tried
        type(minimum_t), intent(out) :: minimum !! the best that was found
        type(sobol_sequence_t) :: sequence
        type(minimum_t) :: other
        real(dp) :: fractions(size(start)), x(size(start)), width
        integer :: i, k

        allocate (search%places(size(start), 0))
        search%first_span = shortest_span(model)
        call search_from(model, start, merge(growth, at_once, search%has_windows), search)
        if (search%has_windows) then
            ! What the windows led away from: what all rows lead to at once; and windows that grow slowly.
            if (.not. any(model%is_mirrored)) then
                call minimize(model, start, size(model%data), spread(.true., 1, size(start)), other, direct_goal, &
                              most=direct_steps * (size(start) + 1))
                search%evaluations = search%evaluations + other%evaluations
                search%steps = search%steps + other%steps
                search%places = reshape([search%places, other%x], [size(start), size(search%places, 2) + 1])
                if (other%sum_of_squares < (1 - smaller) * search%best%sum_of_squares) then
                    call search_from(model, [other%x], at_once, search)
                end if
            end if
            if (.not. explains(model, search%best)) call search_from(model, start, slow_growth, search)
        end if
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

    !> Searches from a place, and on from a pole beyond it. The model is that of the best minimum then.
    subroutine search_from(model, place, growth, search)
        type(fit_model_t), intent(inout) :: model
        real(dp), intent(in) :: place(:)
        real(dp), intent(in) :: growth !! of the windows
        type(search_t), intent(inout) :: search
        real(dp) :: x(size(place))
        integer :: rows(size(model%measured)), all_rows(size(model%measured)), run

        x = place
        call model%mirror(x, [model%is_mirrored])
        x = place
        if (growth < at_once) then
            all_rows = model%rows
            rows = [(first_rows(model, run), run=1, size(rows))]
            call model%use_rows(rows)
            search%first_span = shortest_span(model)
            ! Window by window to a place from which all rows lead to a minimum.
            do
                call search_in_window(model, rows, place, x, search)
                if (all(rows == all_rows)) exit
                model%share = max(model%share, 0.5_dp * (search%searches - 1 + real(sum(rows), dp) / sum(all_rows)) / search%most)
                do run = 1, size(rows)
                    associate (t => model%measured(run)%t)
                        rows(run) = min(max(count(t - t(1) <= growth * (t(rows(run)) - t(1))), rows(run) + 1), all_rows(run))
                    end associate
                end do
            end do
        end if
        call model%use_all_rows()
        call finish_at(model, x, search)
        if (any(model%is_at_pole(x))) then
            call model%mirror(x, model%is_at_pole(x))
            call finish_at(model, x, search)
        end if
        model%share = max(model%share, 0.5_dp * search%searches / search%most)
        model%loss = search%loss
        model%measured = search%measured
        call model%use_all_rows()
        call model%mirror(x, model%is_mirrored .neqv. search%is_mirrored)
    end subroutine search_from

    !> The shortest of the spans of the runs that are explained, s.
    pure real(dp) function shortest_span(model) result(span)
        type(fit_model_t), intent(in) :: model
        integer :: run
        span = minval([(model%measured(run)%t(model%rows(run)) - model%measured(run)%t(1), run=1, size(model%rows))])
    end function shortest_span

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
        if (allocated(search%measured) .and. (rise > same .or. (rise > -same .and. (search%best%has_converged .or. &
            .not. found%has_converged)))) return
        search%best = found
        search%least_misfit = search%least_misfit + rise
        search%loss = model%loss
        search%measured = model%measured
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
        integer :: run

        misfit = huge(misfit)
        if (.not. minimum%sum_of_squares < huge(misfit)) return
        associate (m => size(minimum%residuals), knows_sigma => model%measured(1)%knows_sigma)
            deviation = sqrt(minimum%sum_of_squares / m)
            if (kind /= loss_squares .and. .not. knows_sigma) deviation = robust_deviation(minimum%residuals, 0)
            misfit = m * log(max(deviation, max(least, model%precision) * norm2(model%data) / sqrt(real(m, dp)), tiny(misfit)))
            do run = 1, merge(0, size(model%measured), knows_sigma)
                associate (measured => model%measured(run))
                    misfit = misfit + sum(count(measured%is_there, dim=2) * log(measured%sigma(:, 1)))
                end associate
            end do
        end associate
    end function misfit

    !> The criterion of Akaike (1974), but for what is the same for all motions: minus twice the logarithm of the likelihood at a
    !> least sum of squares, plus twice the number of parameters.
    real(dp) function information(model, minimum)
        type(fit_model_t), intent(in) :: model !! the measurements
        type(minimum_t), intent(in) :: minimum !! the minimum
        information = minimum%sum_of_squares
        if (.not. model%measured(1)%knows_sigma) information = 2 * misfit(model, minimum, loss_squares)
        information = information + 2 * size(minimum%x)
    end function information

    !> Whether a minimum explains the measurements.
    logical function explains(model, minimum)
        type(fit_model_t), intent(inout) :: model
        type(minimum_t), intent(in) :: minimum
        type(judgement_t) :: judgement
        logical :: is_noisy

        explains = .false.
        if (.not. minimum%has_converged) return
        is_noisy = norm2(minimum%residuals) > far_above * max(model%precision, epsilon(1.0_dp)) * norm2(model%data)
        call judge(model, minimum, is_noisy, .false., judgement)
        explains = .not. judgement%is_poor
    end function explains

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
            call minimize_loss(model, from, size(model%data), search%kind, model%measured(1)%knows_sigma, minimum)
            search%evaluations = search%evaluations + minimum%evaluations
            search%steps = search%steps + minimum%steps
            if (.not. minimum%has_converged) exit
            from = minimum%x
            call model%weigh(from, search%kind /= loss_squares, change)
            if (.not. change > 0) exit
        end do
    end subroutine finish_search

    !> Number of rows of a run in the first window.
    integer function first_rows(model, run) result(rows)
        type(fit_model_t), intent(in) :: model !! the residuals
        integer, intent(in) :: run !! which run
        associate (measured => model%measured(run))
            rows = count(measured%t - measured%t(1) <= first_periods * model%period(run))
            do while (rows < size(measured%t))
                if (count(measured%is_there(:, :rows)) >= readings_per_parameter * size(model%sought%keys)) exit
                rows = rows + 1
            end do
            rows = min(max(rows, 2), size(measured%t))
        end associate
    end function first_rows

    !> Moves the parameters to the minimum in a window, roughly, with a loss that wrong rows do not spoil.
    subroutine search_in_window(model, rows, start, x, search)
        type(fit_model_t), intent(inout) :: model
        integer, intent(in) :: rows(:)
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

    !> Checks that the measurements of a run are what they should be: angles in radians with all their turns, times in s from the
    !> start.
    subroutine check_measurements(model, run, fit, knows_start, problems)
        type(fit_model_t), intent(inout) :: model !! the residuals
        integer, intent(in) :: run !! which run
        type(fit_scene_t), intent(in) :: fit !! the group of the input
        logical, intent(in) :: knows_start !! whether the input tells the time of the motion at t = 0 of the table
        type(problems_t), intent(inout) :: problems !! errors and warnings are added
        character(*), parameter :: unit = 'give the times in s, or name their unit, as in t_ms'
        character(:), allocatable :: message
        integer, allocatable :: rows(:)
        character(:), allocatable :: key
        real(dp) :: interval, span
        integer :: i, k, n, lost

        key = 'fit.data(' // to_text(run) // ')'
        associate (measured => model%measured(run), period => model%period(run))
            n = size(measured%t)
            do i = 1, size(measured%columns)
                rows = pack([(k, k=1, n)], measured%is_there(i, :))
                if (size(rows) < 2) cycle
                call check_angles(measured, key, fit%sensors, i, rows, problems)
            end do
            if (n < 2 .or. problems%any()) return
            span = measured%t(n) - measured%t(1)
            if (measured%t(1) > span .and. .not. knows_start) then
                call problems%add(key, 'the first row is at t = ' // rounded(measured%t(1)) // &
                                  ' s, but the motion starts at 0', &
                                  'give times since the start, or fit.time_offset: ' // to_text(-measured%t(1)) // &
                                  ' where the motion starts with the first row, 0 where it starts before')
                return
            end if
            if (fit%time_offset > span .and. abs(measured%t(1) - fit%time_offset) <= span) then
                call problems%add('fit.time_offset', 'it is added to the times of the table: the first row is then at ' // &
                                  rounded(measured%t(1) + fit%time_offset) // ' s of the motion', &
                                  'give ' // to_text(-measured%t(1)) // ' where the motion starts with the first row')
                return
            end if
            interval = span / (n - 1)
            if (interval > most_periods * period) then
                message = 'the rows are ' // rounded(interval) // ' s apart, which are ' // rounded(interval / period) // &
                          ' periods of the motion, of ' // rounded(period) // ' s'
                lost = lost_column(model, run)
                if (lost > 0) then
                    call problems%add(key, message // ', and the start does not predict the turns of ' // &
                                      trim(measured%columns(lost)%name), unit // '; or leave out the column')
                else if (interval > many_periods * period) then
                    call problems%warn(key, message, unit)
                end if
            else if (2 * pi * span < least_turn * period) then
                call problems%warn(key, 'all rows are within ' // rounded(span) // &
                                   ' s, in which the motion hardly begins: it has a period of ' // rounded(period) // &
                                   ' s', unit)
            end if
        end associate
    end subroutine check_measurements

    !> A column whose readings turn between rows of the measurements, and that the start does not predict: no window of rows
    !> can lead to its turns. 0 if there is none.
    integer function lost_column(model, run) result(column)
        class(fit_model_t), intent(inout) :: model
        integer, intent(in) :: run
        integer, parameter :: instants = 100, least_rows = 12
        real(dp), allocatable :: t(:), readings(:, :), differences(:, :), in_periods(:, :)
        real(dp), allocatable :: rest(:)
        logical, allocatable :: is_there(:)
        real(dp) :: scatter
        integer :: i, rows, farthest
        logical :: is_valid, is_predicted

        associate (measured => model%measured(run), start => model%sought%start)
            rows = min(max(first_rows(model, run), least_rows), size(measured%t))
            call model%predict(start, run, rows, readings, is_predicted)
            allocate (differences, source=measured%differences(readings))
            allocate (t, source=measured%t)
            measured%t = t(1) + most_periods * model%period(run) / instants * [(i, i=1, instants)]
            call model%predict(start, run, instants, in_periods, is_valid)
            measured%t = t
        end associate
        do column = 1, size(readings, 1)
            is_there = model%measured(run)%is_there(column, :)
            scatter = deviation(pack(model%measured(run)%values(column, :), is_there))
            if (.not. (is_valid .and. deviation(in_periods(column, :)) > turning * scatter)) cycle
            if (.not. is_predicted) return
            rest = pack(differences(column, :), is_there(:rows))
            if (size(rest) < 3) cycle
            ! Without an offset, and one wrong reading.
            farthest = maxloc(abs(rest - sum(rest) / size(rest)), dim=1)
            rest = [rest(:farthest - 1), rest(farthest + 1:)]
            rest = min(abs(rest - sum(rest) / size(rest)), 2 * scatter)
            if (norm2(rest) > unexplained * scatter * sqrt(real(size(rest), dp))) return
        end do
        column = 0

    contains

        !> The standard deviation of some numbers, which a few wrong ones do not change much.
        real(dp) function deviation(numbers)
            real(dp), intent(in) :: numbers(:)
            deviation = 0
            if (size(numbers) > 1) deviation = robust_deviation(numbers - sum(numbers) / size(numbers), 1)
        end function deviation

    end function lost_column

    !> Checks that the readings of an angle are in the unit of their column, and have all turns.
    subroutine check_angles(measured, key, sensors, i, rows, problems)
        type(measurements_t), intent(in) :: measured
        character(*), intent(in) :: key
        type(sensors_t), intent(in) :: sensors
        integer, intent(in) :: i !! number of the column
        integer, intent(in) :: rows(:) !! those with a reading
        type(problems_t), intent(inout) :: problems
        real(dp) :: angles(size(rows))
        logical :: is_outside(size(rows))
        integer :: k

        angles = measured%values(i, rows)
        associate (column => measured%columns(i), sensor => measured%sensor(i))
            if (sensor > 0) angles = (angles - sensors%offset(sensor)) / sensors%scale(sensor)
            angles = angles * column%size
            if (column%quantity() == 'theta') then
                is_outside = angles < -slack_of_theta .or. angles > pi + slack_of_theta
                k = findloc(is_outside, .true., dim=1)
                ! One such reading is wrong, many are in another unit.
                if (count(is_outside) > size(rows) / 4) then
                    call problems%add(key, trim(column%name) // ' = ' // rounded(measured%values(i, rows(k))) // &
                                      ' in row ' // to_text(rows(k)) // ' is outside of [0, pi]', &
                                      'give it in radians, or name its unit, as in theta_deg, or its sensor')
                end if
            else if (any(column%quantity() == [character(3) :: 'phi', 'psi']) .and. .not. measured%turn(i) > 0) then
                k = wrapped_at(measured%t(rows), angles)
                if (k > 1) call problems%add(key, trim(column%name) // ' jumps by almost a turn from row ' // &
                                             to_text(rows(k - 1)) // ' to row ' // to_text(rows(k)) // &
                                             ', as a wrapped angle does', "give fit.wrapped = '" // trim(column%name) // &
                                             "', or all its turns (in Python numpy.unwrap)")
            end if
        end associate
    end subroutine check_angles

    !> The row at which an angle was wrapped: where all values are within a turn, but steps are longer than a half, or where a
    !> step differs by a turn from its neighbours. Over gaps of the rows an angle may step by anything. 0 if there is none.
    pure integer function wrapped_at(t, angle) result(row)
        real(dp), intent(in) :: t(:), angle(:)
        real(dp), parameter :: gap = 1.5_dp ! in mean intervals
        real(dp) :: step(size(angle) - 1), near
        logical :: is_gap(size(angle) - 1)
        integer :: i, n

        row = 0
        n = size(step)
        if (n < 1) return
        is_gap = t(2:) - t(:n) > gap * (t(n + 1) - t(1)) / n
        step = merge(0.0_dp, angle(2:) - angle(:n), is_gap)
        if (maxval(angle) - minval(angle) <= 2.1_dp * pi .and. (count(abs(step) > pi) > 1 .or. any(abs(step) > 1.6_dp * pi))) then
            row = maxloc(abs(step), dim=1) + 1
            return
        end if
        do i = 2, n - 1
            if (any(is_gap(i - 1:i + 1))) cycle
            near = (step(i - 1) + step(i + 1)) / 2
            if (abs(step(i + 1) - step(i - 1)) > 1) cycle
            if (abs(abs(step(i) - near) - 2 * pi) > 0.5_dp) cycle
            row = i + 1
            return
        end do
    end function wrapped_at

    !> Judges a minimum: each run, and all together.
    subroutine judge(model, minimum, is_noisy, with_words, judgement)
        type(fit_model_t), intent(inout) :: model !! the measurements, and the loss that is least
        type(minimum_t), intent(in) :: minimum !! the parameters, and the residuals in units of their deviations
        logical, intent(in) :: is_noisy !! whether the residuals are larger than the errors of the motion
        logical, intent(in) :: with_words !! whether reason and warnings are wanted
        type(judgement_t), intent(out) :: judgement !! what was found
        real(dp), allocatable :: readings(:, :), differences(:, :), residuals(:), t(:)
        character(:), allocatable :: name
        integer, allocatable :: rows(:)
        integer :: i, k, run, parameters
        logical :: is_valid

        allocate (judgement%warnings(0))
        judgement%reason = ''
        if (model%measured(1)%knows_sigma) call judge_sizes(model, minimum, with_words, judgement)
        parameters = size(model%sought%keys)
        do run = 1, size(model%measured)
            associate (measured => model%measured(run))
                call model%predict(minimum%x, run, size(measured%t), readings, is_valid)
                judgement%is_poor = judgement%is_poor .or. .not. is_valid
                if (.not. (is_valid .and. is_noisy)) cycle
                differences = measured%differences(readings)
                do i = 1, size(differences, 1)
                    rows = pack([(k, k=1, size(differences, 2))], measured%is_there(i, :))
                    name = measured%label // trim(measured%columns(i)%name)
                    t = measured%t(rows)
                    residuals = differences(i, rows)
                    if (measured%knows_sigma) residuals = residuals / measured%sigma(i, rows)
                    call judge_order(name, t, residuals, with_words, judgement)
                    call judge_outliers()
                end do
            end associate
        end do
    contains

        !> The rows of a column that stand out of the others.
        subroutine judge_outliers()
            character(:), allocatable :: text, hint
            real(dp) :: deviation, limit
            integer :: farthest, more
            logical :: is_spoiled

            if (size(t) <= parameters + 3) return
            deviation = robust_deviation(residuals, parameters)
            limit = standing_out * (1 + 5.0_dp / (size(t) - parameters)) * deviation
            farthest = maxloc(abs(residuals), dim=1)
            if (.not. (abs(residuals(farthest)) > limit .and. deviation > 0)) return
            is_spoiled = .not. model%loss%is_robust() .and. &
                         sum(pack(residuals, abs(residuals) > limit)**2) > spoiling * sum(residuals**2)
            judgement%is_poor = judgement%is_poor .or. is_spoiled
            if (.not. with_words) return
            more = count(abs(residuals) > limit) - 1
            text = name // ' in row ' // to_text(rows(farthest)) // ', t = ' // to_text(t(farthest)) // ' s, is ' // &
                   rounded(abs(residuals(farthest)) / deviation, 3) // ' standard deviations from the motion'
            if (more > 0) then
                text = text // ', and ' // to_text(more) // trim(merge(' more row stands', ' more rows stand', more == 1)) // ' out'
            end if
            hint = "; remove what is wrong, or use loss = 'huber' or 'tukey'"
            if (model%loss%is_robust()) hint = ''
            if (is_spoiled) then
                call add_reason(judgement, text)
            else
                call append(judgement%warnings, text // hint)
            end if
        end subroutine judge_outliers

    end subroutine judge

    !> Residuals that are no noise: each like the one before, or minus that, or like others far from it.
    subroutine judge_order(name, t, residuals, with_words, judgement)
        character(*), intent(in) :: name
        real(dp), intent(in) :: t(:), residuals(:)
        logical, intent(in) :: with_words
        type(judgement_t), intent(inout) :: judgement
        real(dp) :: ratio, strength, chance, period, amplitude, probability, drift, significance
        character(:), allocatable :: text

        ratio = von_neumann_ratio(residuals)
        call find_correlation(residuals, cut * robust_deviation(residuals, 0), strength, chance)
        text = ''
        if (abs(ratio - 2) > max(far, significant * 2 / sqrt(real(size(residuals), dp)))) then
            text = 'each is like ' // trim(merge('the one before      ', 'minus the one before', ratio < 2)) // &
                   ' (ratio of von Neumann ' // rounded(ratio, 3) // ', 2 for noise)'
        else if (strength > correlated .and. chance < impossible) then
            text = 'they repeat themselves (far neighbours have a correlation of ' // rounded(strength, 2) // ')'
        end if
        if (text == '') return
        judgement%is_poor = .true.
        if (.not. with_words) return
        text = 'the residuals of ' // name // ' are no noise: ' // text
        call find_period(t, residuals, period, amplitude, probability)
        call find_drift(t, residuals, drift, significance)
        if (probability < seldom) text = text // ', with a period of ' // rounded(period, 3) // ' s'
        if (significance > clear_drift) text = text // ', with a drift'
        call add_reason(judgement, text)
    end subroutine judge_order

    !> Adds what stands out to the reason of a poor fit.
    subroutine add_reason(judgement, text)
        type(judgement_t), intent(inout) :: judgement
        character(*), intent(in) :: text
        judgement%is_poor = .true.
        if (judgement%reason /= '') judgement%reason = judgement%reason // '; '
        judgement%reason = judgement%reason // text
    end subroutine add_reason

    !> The sums of squares against the known standard deviations: of each run, and last of all, which are those of the judgement.
    subroutine judge_sizes(model, minimum, with_words, judgement)
        type(fit_model_t), intent(in) :: model
        type(minimum_t), intent(in) :: minimum
        logical, intent(in) :: with_words
        type(judgement_t), intent(inout) :: judgement
        real(dp) :: own
        integer :: run, first, last

        associate (measured => model%measured, m => size(minimum%residuals), n => size(minimum%x), common => model%sought%common)
            last = 0
            do run = 1, merge(size(measured), 0, size(measured) > 1)
                first = last + 1
                last = last + measured(run)%size()
                ! What is common takes degrees of freedom of each run in proportion to its readings.
                own = size(model%sought%keys) - common * (1 - (last - first + 1.0_dp) / m)
                call judge_size(minimum%residuals(first:last), nint(own), measured(run)%label, model%loss, with_words, judgement)
            end do
            call judge_size(minimum%residuals, n, '', model%loss, with_words, judgement)
        end associate
    end subroutine judge_sizes

    !> The sum of squares of some residuals. With a robust loss it is that of the deviation by the median.
    subroutine judge_size(residuals, n, label, loss, with_words, judgement)
        real(dp), intent(in) :: residuals(:)
        integer, intent(in) :: n !! number of parameters
        character(*), intent(in) :: label
        type(loss_t), intent(in) :: loss
        logical, intent(in) :: with_words
        type(judgement_t), intent(inout) :: judgement
        real(dp), parameter :: efficiency = 0.37_dp ! of a deviation by the median
        real(dp) :: per_freedom, share
        character(:), allocatable :: what
        logical :: is_poor

        share = 1
        judgement%freedom = max(size(residuals) - n, 1)
        judgement%chi2 = sum(residuals**2)
        if (loss%is_robust()) then
            judgement%chi2 = judgement%freedom * robust_deviation(residuals, n)**2
            share = efficiency
        end if
        per_freedom = judgement%chi2 / judgement%freedom
        judgement%probability = chi_square_tail(share * judgement%chi2, max(nint(share * judgement%freedom), 1))
        is_poor = per_freedom > too_large .and. judgement%probability < impossible
        judgement%is_poor = judgement%is_poor .or. is_poor
        if (.not. with_words) return
        what = label // 'chi2 is ' // rounded(per_freedom, 3) // ' per degree of freedom'
        if (is_poor) then
            call add_reason(judgement, what)
        else if (judgement%probability < doubtful .and. per_freedom > 1) then
            call append(judgement%warnings, what // ', which has a probability of ' // rounded(judgement%probability, 2) // &
                        ': the standard deviations are larger than sigma by a factor of ' // rounded(sqrt(per_freedom), 3))
        else if (1 - judgement%probability < doubtful) then
            call append(judgement%warnings, what // ': the standard deviations are smaller than sigma by a factor of ' // &
                        rounded(sqrt(per_freedom), 3))
        end if
    end subroutine judge_size

end module spintop_fit_search
