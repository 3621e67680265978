!> What is odd about measurements, before a fit.
module spintop_fit_warnings
    use spintop_case, only: case_t
    use spintop_fit_data, only: measurements_t
    use spintop_fit_keys, only: fit_scene_t, sensors_t
    use spintop_fit_model, only: fit_model_t
    use spintop_fit_search, only: first_rows, period_of
    use spintop_kinds, only: dp, pi
    use spintop_problems, only: problems_t
    use spintop_robust, only: robust_deviation
    use spintop_summary, only: rounded
    use spintop_text, only: to_text
    implicit none
    private
    public :: check_measurements

    !> Periods of the motion between rows, and radians in all of them, beyond and below which the unit of time is doubted.
    real(dp), parameter :: most_periods = 3, least_turn = 0.1_dp
    !> A column turns if it scatters by this part of its measurements within these periods. It is lost if the start leaves this
    !> part in the first rows: turns that are not predicted leave more.
    real(dp), parameter :: turning = 0.5_dp, unexplained = 0.5_dp
    !> An angle theta may be so far outside of [0, pi], by noise or an offset.
    real(dp), parameter :: slack_of_theta = 0.5_dp

contains

    !> Checks that measurements are what they should be: angles in radians with all their turns, times in s from the start.
    subroutine check_measurements(measured, fit, knows_start, case, model, x, problems)
        type(measurements_t), intent(in) :: measured !! the measurements
        type(fit_scene_t), intent(in) :: fit !! the group of the input
        logical, intent(in) :: knows_start !! whether the input tells the time of the motion at t = 0 of the table
        type(case_t), intent(in) :: case !! body and start, where the search begins
        type(fit_model_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: x(:) !! the sought numbers, where the search begins
        type(problems_t), intent(inout) :: problems !! errors and warnings are added
        character(*), parameter :: unit = 'give the times in s, or name their unit, as in t_ms'
        character(:), allocatable :: message
        integer, allocatable :: rows(:)
        real(dp) :: period, interval, span
        integer :: i, k, n, lost

        n = size(measured%t)
        do i = 1, size(measured%columns)
            rows = pack([(k, k=1, n)], measured%is_there(i, :))
            if (size(rows) < 2) cycle
            call check_angles(measured, fit%sensors, i, rows, problems)
        end do
        if (n < 2 .or. problems%any()) return
        span = measured%t(n) - measured%t(1)
        if (measured%t(1) > span .and. .not. knows_start) then
            call problems%add('fit.data', 'the first row is at t = ' // rounded(measured%t(1)) // &
                              ' s, but the motion starts at 0', &
                              'give times since the start, or fit.time_offset: ' // to_text(-measured%t(1)) // &
                              ' where the motion starts with the first row, 0 where it starts before')
            return
        end if
        period = period_of(case)
        interval = span / (n - 1)
        if (interval > most_periods * period) then
            message = 'the rows are ' // rounded(interval) // ' s apart, which are ' // rounded(interval / period) // &
                      ' periods of the motion, of ' // rounded(period) // ' s'
            lost = lost_column(model, x, period)
            if (lost > 0) then
                call problems%add('fit.data', message // ', and the start does not predict the turns of ' // &
                                  trim(measured%columns(lost)%name), unit // '; or leave out the column')
            else
                call problems%warn('fit.data', message, unit)
            end if
        else if (2 * pi * span < least_turn * period) then
            call problems%warn('fit.data', 'all rows are within ' // rounded(span) // &
                               ' s, in which the motion hardly begins: it has a period of ' // rounded(period) // &
                               ' s', unit)
        end if
    end subroutine check_measurements

    !> A column whose readings turn between rows of the measurements, and that the start does not predict: no window of rows
    !> can lead to its turns. 0 if there is none.
    integer function lost_column(model, x, period) result(column)
        class(fit_model_t), intent(inout) :: model
        real(dp), intent(in) :: x(:), period
        integer, parameter :: instants = 100, least_rows = 12
        real(dp), allocatable :: t(:), readings(:, :), differences(:, :), in_periods(:, :)
        real(dp), allocatable :: rest(:)
        logical, allocatable :: is_there(:)
        real(dp) :: scatter
        integer :: i, rows, farthest
        logical :: is_valid, is_predicted

        rows = min(max(first_rows(model, period, size(x)), least_rows), size(model%measured%t))
        allocate (readings(size(model%measured%columns), rows), in_periods(size(model%measured%columns), instants))
        call model%predict(x, readings, is_predicted)
        allocate (differences, source=model%differences(readings))
        allocate (t, source=model%measured%t)
        model%measured%t = t(1) + most_periods * period / instants * [(i, i=1, instants)]
        call model%predict(x, in_periods, is_valid)
        model%measured%t = t
        do column = 1, size(readings, 1)
            is_there = model%measured%is_there(column, :)
            scatter = deviation(pack(model%measured%values(column, :), is_there))
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
        pure real(dp) function deviation(numbers)
            real(dp), intent(in) :: numbers(:)
            deviation = 0
            if (size(numbers) > 1) deviation = robust_deviation(numbers - sum(numbers) / size(numbers), 1)
        end function deviation

    end function lost_column

    !> Checks that the readings of an angle are in the unit of their column, and have all turns.
    subroutine check_angles(measured, sensors, i, rows, problems)
        type(measurements_t), intent(in) :: measured
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
                    call problems%add('fit.data', trim(column%name) // ' = ' // rounded(measured%values(i, rows(k))) // &
                                      ' in row ' // to_text(rows(k)) // ' is outside of [0, pi]', &
                                      'give it in radians, or name its unit, as in theta_deg, or its sensor')
                end if
            else if (any(column%quantity() == [character(3) :: 'phi', 'psi']) .and. .not. measured%turn(i) > 0) then
                k = wrapped_at(measured%t(rows), angles)
                if (k > 1) call problems%add('fit.data', trim(column%name) // ' jumps by almost a turn from row ' // &
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

end module spintop_fit_warnings
