!> What is odd about measurements, before a fit.
module spintop_fit_warnings
    use spintop_case, only: case_t
    use spintop_fit_data, only: measurements_t
    use spintop_fit_search, only: period_of
    use spintop_kinds, only: dp, pi
    use spintop_problems, only: problems_t
    use spintop_summary, only: rounded
    use spintop_text, only: to_text
    use spintop_trajectory_columns, only: trajectory_column_t
    implicit none
    private
    public :: check_measurements

    !> Periods of the motion between rows, and radians in all of them, beyond and below which the unit of time is doubted;
    !> spans of the rows before the first.
    real(dp), parameter :: most_periods = 3, least_turn = 0.1_dp, most_spans = 100
    !> An angle theta may be so far outside of [0, pi], by noise or an offset.
    real(dp), parameter :: slack_of_theta = 0.5_dp

contains

    !> Checks that measurements are what they should be: angles in radians with all their turns, times in s from the start.
    subroutine check_measurements(measured, case, time_offset, problems)
        type(measurements_t), intent(in) :: measured !! the measurements
        type(case_t), intent(in) :: case !! body and start, where the search begins
        real(dp), intent(in) :: time_offset !! time of the motion at t = 0 of the measurements, s
        type(problems_t), intent(inout) :: problems !! errors and warnings are added
        integer, allocatable :: rows(:)
        real(dp) :: period, interval
        integer :: i, k, n

        n = size(measured%t)
        do i = 1, size(measured%columns)
            rows = pack([(k, k=1, n)], measured%is_there(i, :))
            if (size(rows) < 2) cycle
            call check_angles(measured%columns(i), rows, measured%t(rows), measured%values(i, rows), &
                              measured%turn(i) > 0, problems)
        end do
        if (n < 2) return
        period = period_of(case)
        associate (t => measured%t)
            interval = (t(n) - t(1)) / (n - 1)
            if (interval > most_periods * period) then
                call problems%warn('fit.data', 'the rows are ' // rounded(interval) // ' s apart, which are ' // &
                                   rounded(interval / period) // ' periods of the motion, of ' // &
                                   rounded(period) // ' s', 'give the times in s, or name their unit, as in t_ms')
            else if (2 * pi * (t(n) - t(1)) < least_turn * period) then
                call problems%warn('fit.data', 'all rows are within ' // rounded(t(n) - t(1)) // &
                                   ' s, in which the motion hardly begins: it has a period of ' // rounded(period) // &
                                   ' s', 'give the times in s, or name their unit, as in t_ms')
            end if
            if (t(1) + time_offset > most_spans * (t(n) - t(1))) then
                call problems%add('fit.data', 'the first row is at t = ' // rounded(t(1)) // ' s, but the motion starts at 0', &
                                  'give times since the start, or fit.time_offset')
            end if
        end associate
    end subroutine check_measurements

    !> Checks that the readings of an angle are in the unit of their column, and have all turns.
    subroutine check_angles(column, rows, t, values, is_wrapped, problems)
        type(trajectory_column_t), intent(in) :: column
        integer, intent(in) :: rows(:) !! those with a reading
        real(dp), intent(in) :: t(:), values(:)
        logical, intent(in) :: is_wrapped !! whether turns are not needed
        type(problems_t), intent(inout) :: problems
        logical :: is_outside(size(values))
        integer :: k

        if (column%quantity() == 'theta') then
            is_outside = values * column%size < -slack_of_theta .or. values * column%size > pi + slack_of_theta
            k = findloc(is_outside, .true., dim=1)
            ! One such reading is wrong, many are in another unit.
            if (count(is_outside) > size(values) / 4) then
                call problems%add('fit.data', trim(column%name) // ' = ' // rounded(values(k)) // ' in row ' // &
                                  to_text(rows(k)) // ' is outside of [0, pi]', &
                                  'give it in radians, or name its unit, as in theta_deg')
            end if
        else if (any(column%quantity() == [character(3) :: 'phi', 'psi']) .and. .not. is_wrapped) then
            k = wrapped_at(t, values * column%size)
            if (k > 1) call problems%add('fit.data', trim(column%name) // ' jumps by almost a turn from row ' // &
                                         to_text(rows(k - 1)) // ' to row ' // to_text(rows(k)) // &
                                         ', as a wrapped angle does', "give fit.wrapped = '" // trim(column%name) // &
                                         "', or all its turns (in Python numpy.unwrap)")
        end if
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
