!> What is odd about measurements, and about the residuals of a fit.
module spintop_fit_warnings
    use spintop_case, only: case_t
    use spintop_fit_data, only: measurements_t
    use spintop_kinds, only: dp, pi
    use spintop_problems, only: problems_t
    use spintop_robust, only: robust_deviation
    use spintop_summary, only: rounded
    use spintop_text, only: append, string_t, to_text
    implicit none
    private
    public :: warn_of_measurements, find_warnings

    !> Periods of the motion between rows, and radians in all of them, beyond and below which the unit of time is doubted;
    !> spans of the rows before the first.
    real(dp), parameter :: most_periods = 3, least_turn = 0.1_dp, most_spans = 100
    !> A row stands out by so many standard deviations, and more where few rows give them.
    real(dp), parameter :: standing_out = 6
    !> Residuals are no noise where the ratio of von Neumann is so far from its mean, 2, and this number of its standard
    !> deviations.
    real(dp), parameter :: far = 1, significant = 4

contains

    !> Warns of measurements that are not what they should be: wrapped angles, and times in another unit.
    subroutine warn_of_measurements(measured, case, problems)
        type(measurements_t), intent(in) :: measured !! the measurements
        type(case_t), intent(in) :: case !! body and start, where the search begins
        type(problems_t), intent(inout) :: problems !! warnings are added
        real(dp) :: rate, interval
        integer :: i, row, n

        n = size(measured%t)
        do i = 1, size(measured%columns)
            associate (column => measured%columns(i))
                if (all(column%name /= ['phi', 'psi'])) cycle
                row = wrapped_at(measured%values(i, :))
                if (row > 0) call problems%warn('fit.data', trim(column%name) // ' jumps by almost a turn from row ' // &
                    to_text(row - 1) // ' to row ' // to_text(row) // ', as a wrapped angle does', &
                    'give it with all its turns (in Python numpy.unwrap)')
            end associate
        end do
        if (n < 2) return
        associate (t => measured%t)
            interval = (t(n) - t(1)) / (n - 1)
            rate = max(norm2(case%start%omega), sqrt(norm2(case%body%weight_moment()) / minval(case%body%inertia)))
            if (rate * interval > 2 * pi * most_periods) then
                call problems%warn('fit.data', 'the rows are ' // rounded(interval) // ' s apart, which are ' // &
                                   rounded(rate * interval / (2 * pi)) // ' periods of the motion, of ' // &
                                   rounded(2 * pi / rate) // ' s', 'give the times in s')
            else if (rate * (t(n) - t(1)) < least_turn) then
                call problems%warn('fit.data', 'all rows are within ' // rounded(t(n) - t(1)) // &
                                   ' s, in which the motion hardly begins: it has a period of ' // rounded(2 * pi / rate) // &
                                   ' s', 'give the times in s')
            end if
            if (t(1) > most_spans * (t(n) - t(1))) then
                call problems%warn('fit.data', 'the first row is at t = ' // rounded(t(1)) // ' s, but the motion starts at 0', &
                                   'give times since the start')
            end if
        end associate
    end subroutine warn_of_measurements

    !> The row at which an angle was wrapped: where all values are within a turn, but steps are longer than a half, or where a
    !> step differs by a turn from its neighbours. 0 if there is none.
    pure integer function wrapped_at(angle) result(row)
        real(dp), intent(in) :: angle(:)
        real(dp) :: step(size(angle) - 1), near
        integer :: i, n

        row = 0
        n = size(step)
        step = angle(2:) - angle(:n)
        if (maxval(angle) - minval(angle) <= 2.1_dp * pi .and. (count(abs(step) > pi) > 1 .or. any(abs(step) > 1.6_dp * pi))) then
            row = maxloc(abs(step), dim=1) + 1
            return
        end if
        do i = 2, n - 1
            near = (step(i - 1) + step(i + 1)) / 2
            if (abs(step(i + 1) - step(i - 1)) > 1) cycle
            if (abs(abs(step(i) - near) - 2 * pi) > 0.5_dp) cycle
            row = i + 1
            return
        end do
    end function wrapped_at

    !> What is odd about residuals: rows that stand out, and those that follow each other, as the errors of the motion itself do.
    subroutine find_warnings(measured, residuals, parameters, is_noisy, is_robust, warnings)
        type(measurements_t), intent(in) :: measured !! the measurements
        real(dp), intent(in) :: residuals(:, :) !! measured less fitted: columns, times
        integer, intent(in) :: parameters !! number of sought parameters
        logical, intent(in) :: is_noisy !! whether the residuals are larger than the errors of the motion
        logical, intent(in) :: is_robust !! whether the loss is robust
        type(string_t), allocatable, intent(out) :: warnings(:) !! one sentence each
        integer :: i

        allocate (warnings(0))
        if (.not. is_noisy) return
        do i = 1, size(measured%columns)
            call add_outliers(trim(measured%columns(i)%name), measured%t, residuals(i, :), parameters, is_robust, warnings)
            call add_correlation(trim(measured%columns(i)%name), residuals(i, :), warnings)
        end do
    end subroutine find_warnings

    !> Names the row of a column with the largest residual, where it stands out of the others.
    subroutine add_outliers(name, t, residuals, parameters, is_robust, warnings)
        character(*), intent(in) :: name
        real(dp), intent(in) :: t(:), residuals(:)
        integer, intent(in) :: parameters
        logical, intent(in) :: is_robust
        type(string_t), allocatable, intent(inout) :: warnings(:)
        character(:), allocatable :: others, hint
        real(dp) :: deviation, limit
        integer :: row, more

        if (size(t) <= parameters + 3) return
        deviation = robust_deviation(residuals, parameters)
        limit = standing_out * (1 + 5.0_dp / (size(t) - parameters)) * deviation
        row = maxloc(abs(residuals), dim=1)
        if (.not. (abs(residuals(row)) > limit .and. deviation > 0)) return
        more = count(abs(residuals) > limit) - 1
        others = ''
        hint = "; remove what is wrong, or use loss = 'huber'"
        if (is_robust) hint = ''
        if (more > 0) others = ', and ' // to_text(more) // merge(' more row stands', ' more rows stand', more == 1) // ' out'
        call append(warnings, name // ' in row ' // to_text(row) // ', t = ' // to_text(t(row)) // &
                    ' s, is ' // rounded(abs(residuals(row)) / deviation, 3) // ' standard deviations from the motion' // &
                    others // hint)
    end subroutine add_outliers

    !> Warns of residuals that follow each other: by the ratio of the mean square of their differences to their mean square
    !> (von Neumann 1941), which is 2 for noise, with a standard deviation of 2/sqrt(m).
    subroutine add_correlation(name, residuals, warnings)
        character(*), intent(in) :: name
        real(dp), intent(in) :: residuals(:)
        type(string_t), allocatable, intent(inout) :: warnings(:)
        real(dp) :: ratio, size_of_residuals
        integer :: m

        m = size(residuals)
        size_of_residuals = norm2(residuals)
        if (m < 3 .or. .not. size_of_residuals > 0) return
        ratio = (norm2(residuals(2:) - residuals(:m - 1)) / size_of_residuals)**2
        if (abs(ratio - 2) <= max(far, significant * 2 / sqrt(real(m, dp)))) return
        call append(warnings, 'the residuals of ' // name // ' are no noise: each is like ' // &
                    trim(merge('the one before      ', 'minus the one before', ratio < 2)) // ' (ratio of von Neumann ' // &
                    rounded(ratio, 3) // ', 2 for noise); the model, the unit of a column or the start of the search may be &
                    &wrong, and the intervals do not hold')
    end subroutine add_correlation

end module spintop_fit_warnings
