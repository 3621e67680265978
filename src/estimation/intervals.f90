!> What a least-squares fit says of its parameters: covariance, identifiability, and profile intervals (Bates and Watts,
!> Nonlinear Regression Analysis, 1988, chapter 6).
module spintop_intervals
    use spintop_compare, only: is_finite
    use spintop_kinds, only: dp, no_number, pi
    use spintop_lapack, only: dgesvd
    use spintop_least_squares, only: find_jacobian, minimize, minimum_t, residuals_t
    implicit none
    private
    public :: estimate_t, describe_minimum, student_quantile

    !> Relative size of what counts as zero in the scaled Jacobian, and as an effect of a parameter on the data.
    real(dp), parameter :: singular = 1.0e-9_dp
    !> The profile is followed to an end until it is met to this part of the width, in so many steps at most.
    real(dp), parameter :: end_slack = 1.0e-4_dp
    integer, parameter :: most_steps = 30
    !> Factor of the rounding of the residuals, which is that of what they are differences of, below
    !> which the profile is lost in rounding.
    real(dp), parameter :: lost = 100

    !> The parameters and their uncertainty.
    type :: estimate_t
        real(dp), allocatable :: x(:), standard_error(:), covariance(:, :)
        !> Ends of the 95 % intervals; the end of the range of the parameter, or infinite if it has none, where the profile does
        !> not rise enough; those of the linear model where
        !> the residuals are at rounding or at the precision of the model, NaN where they were not sought.
        real(dp), allocatable :: lower(:), upper(:)
        !> Singular values of the Jacobian whose columns are divided by their norms, from the largest; a small one tells
        !> of a combination of parameters that the data do not determine.
        real(dp), allocatable :: singular_values(:)
        !> Standard deviation of the residuals: given (1), or estimated from them, and then not below their rounding.
        real(dp) :: deviation = 1
        logical :: is_identifiable = .false.
    end type estimate_t

contains

    !> Describes a minimum. The residuals are in units of their standard deviation, or of one that is common to all and not
    !> known.
    subroutine describe_minimum(model, minimum, knows_deviation, wants_profile, level, estimate)
        class(residuals_t), intent(inout) :: model !! the residuals
        type(minimum_t), intent(in) :: minimum !! where the sum of their squares is least
        logical, intent(in) :: knows_deviation !! whether their standard deviation is 1; otherwise it is estimated
        logical, intent(in) :: wants_profile !! whether the profile intervals are sought
        real(dp), intent(in) :: level !! quantile that belongs to the intervals: 1.96 for a known deviation
        type(estimate_t), intent(out) :: estimate !! the parameters and their uncertainty
        real(dp), allocatable :: jacobian(:, :), scaled(:, :), vectors(:, :), norms(:), effects(:)
        real(dp) :: range, rounding, width
        integer :: i, k, m, n
        logical :: is_valid

        m = size(minimum%residuals)
        n = size(minimum%x)
        estimate%x = minimum%x
        allocate (estimate%standard_error(n), estimate%lower(n), estimate%upper(n), estimate%singular_values(n))
        allocate (estimate%covariance(n, n), jacobian(m, n), vectors(n, n), effects(n))
        estimate%standard_error = no_number
        estimate%lower = no_number
        estimate%upper = no_number
        estimate%covariance = no_number
        estimate%singular_values = no_number
        if (.not. knows_deviation) estimate%deviation = sqrt(minimum%sum_of_squares / max(m - n, 1))
        call find_jacobian(model, minimum%x, [(i, i=1, n)], minimum%residuals, .true., jacobian, is_valid)
        if (.not. is_valid) return
        norms = norm2(jacobian, dim=1)
        effects(:) = [(norms(k) * model%step_scale(k, minimum%x(k)), k=1, n)]
        range = maxval(effects) / sqrt(real(m, dp))
        rounding = epsilon(rounding) * range
        if (.not. knows_deviation) estimate%deviation = max(estimate%deviation, rounding)
        scaled = jacobian
        do k = 1, n
            scaled(:, k) = jacobian(:, k) / merge(norms(k), 1.0_dp, norms(k) > 0)
        end do
        call decompose(scaled, estimate%singular_values, vectors)
        estimate%is_identifiable = all(effects > singular * max(maxval(effects), model%size_of_data)) &
            .and. estimate%singular_values(n) > singular * estimate%singular_values(1)
        if (.not. estimate%is_identifiable) return
        do k = 1, n
            vectors(k, :) = vectors(k, :) / (estimate%singular_values(k) * norms)
        end do
        estimate%covariance = estimate%deviation**2 * matmul(transpose(vectors), vectors)
        estimate%standard_error = [(sqrt(estimate%covariance(k, k)), k=1, n)]
        if (.not. wants_profile) return
        do k = 1, n
            if (estimate%deviation <= max(lost * rounding, model%precision * range)) then
                width = max(level * estimate%standard_error(k), spacing(minimum%x(k)))
                estimate%lower(k) = model%limited(k, minimum%x(k) - width)
                estimate%upper(k) = model%limited(k, minimum%x(k) + width)
                cycle
            end if
            call find_end(model, minimum, jacobian, estimate, k, -level, estimate%lower(k))
            call find_end(model, minimum, jacobian, estimate, k, level, estimate%upper(k))
        end do
    end subroutine describe_minimum

    !> The singular values and the right singular vectors (in rows) of a matrix with at least as many rows as columns.
    subroutine decompose(matrix, values, vectors)
        real(dp), intent(in) :: matrix(:, :)
        real(dp), intent(out) :: values(:), vectors(:, :)
        real(dp) :: copy(size(matrix, 1), size(matrix, 2)), work(size(matrix, 1) + 10 * size(matrix, 2)), unused(1, 1)
        integer :: info
        copy = matrix
        call dgesvd('N', 'A', size(copy, 1), size(copy, 2), copy, size(copy, 1), values, unused, 1, vectors, size(values), work, &
                    size(work), info)
        if (info /= 0) values = no_number
    end subroutine decompose

    !> An end of the interval of a parameter: where the least sum of squares of the others, over the variance, exceeds the
    !> minimum by the square of the level. Its square root is almost linear in the parameter, which is followed by the
    !> method of regula falsi in the form of Illinois; infinite if it is not met. The others begin on the line of the linear
    !> model, where they often need no step: the derivatives at the minimum tell.
    subroutine find_end(model, minimum, jacobian, estimate, k, level, place)
        class(residuals_t), intent(inout) :: model
        type(minimum_t), intent(in) :: minimum
        real(dp), intent(in) :: jacobian(:, :)
        type(estimate_t), intent(in) :: estimate
        integer, intent(in) :: k
        real(dp), intent(in) :: level !! negative for the lower end
        real(dp), intent(out) :: place
        type(minimum_t) :: point
        logical :: free(size(minimum%x))
        real(dp) :: inside, outside, excess_inside, excess_outside, next, excess, start(size(minimum%x)), root, rise_at_end
        integer :: i, n
        logical :: is_at_end

        free = .true.
        free(k) = .false.
        associate (best => minimum%x(k), width => level * estimate%standard_error(k))
            inside = 0
            excess_inside = -abs(level)
            outside = 0
            excess_outside = -1
            next = width
            rise_at_end = (level * estimate%deviation)**2
            do i = 1, most_steps
                is_at_end = abs(model%limited(k, best + next) - (best + next)) > 0
                if (is_at_end) next = model%limited(k, best + next) - best
                start = minimum%x + estimate%covariance(:, k) * (next / estimate%covariance(k, k))
                start(k) = best + next
                start(:) = [(model%limited(n, start(n)), n=1, size(start))]
                call minimize(model, start, size(minimum%residuals), free, point, &
                              end_slack * rise_at_end / (minimum%sum_of_squares + rise_at_end), jacobian)
                root = no_number
                associate (rise => point%sum_of_squares - minimum%sum_of_squares)
                    if (point%has_converged) root = sqrt(max(rise, 0.0_dp)) / estimate%deviation
                end associate
                excess = root - abs(level)
                place = best + next
                if (abs(excess) <= end_slack * abs(level) .or. (is_at_end .and. excess < 0)) return
                if (.not. is_finite(excess)) then
                    if (excess_outside > 0) exit
                    next = (inside + next) / 2
                    if (abs(next - inside) <= end_slack * abs(width)) exit
                    cycle
                end if
                if (excess > 0) then
                    if (excess_outside > 0) excess_inside = excess_inside / 2
                    outside = next
                    excess_outside = excess
                else
                    if (excess_outside > 0) excess_outside = excess_outside / 2
                    inside = next
                    excess_inside = excess
                end if
                if (excess_outside > 0) then
                    next = inside + (outside - inside) * excess_inside / (excess_inside - excess_outside)
                else
                    next = inside * min(max(abs(level) / max(root, tiny(root)), 1.01_dp), 3.0_dp)
                end if
            end do
        end associate
        place = sign(huge(place), level)
        place = 2 * place
    end subroutine find_end

    !> The quantile of Student's distribution: the value that is exceeded with the probability `tail`.
    pure real(dp) function student_quantile(tail, freedom) result(t)
        real(dp), intent(in) :: tail !! between 0 and 1/2
        integer, intent(in) :: freedom !! degrees of freedom, at least 1
        real(dp) :: low, high
        integer :: i

        low = 0
        high = 1
        do i = 1, 1000
            if (tail_of(high, freedom) <= tail) exit
            high = 2 * high
        end do
        do i = 1, 60
            t = (low + high) / 2
            if (tail_of(t, freedom) > tail) then
                low = t
            else
                high = t
            end if
        end do
    end function student_quantile

    !> The probability that Student's t exceeds a value: with t = sqrt(nu) tan(x) the density is in proportion to
    !> cos(x)^(nu - 1), whose integral is a finite sum (Abramowitz and Stegun 26.7.3 and 26.7.4).
    pure real(dp) function tail_of(t, freedom)
        real(dp), intent(in) :: t
        integer, intent(in) :: freedom
        real(dp) :: angle, term, total
        integer :: i

        angle = atan2(t, sqrt(real(freedom, dp)))
        total = 0
        if (mod(freedom, 2) == 1) then
            term = cos(angle)
            do i = 2, freedom - 1, 2
                total = total + term
                term = term * cos(angle)**2 * i / (i + 1)
            end do
            total = 2 / pi * (angle + sin(angle) * total)
        else
            term = 1
            do i = 1, freedom - 1, 2
                total = total + term
                term = term * cos(angle)**2 * i / (i + 1)
            end do
            total = sin(angle) * total
        end if
        tail_of = (1 - total) / 2
    end function tail_of

end module spintop_intervals
