!> What a least-squares fit says of its parameters: covariance, identifiability, and profile intervals (Bates and Watts,
!> Nonlinear Regression Analysis, 1988, chapter 6).
module spintop_intervals
    use spintop_kinds, only: dp, is_finite, no_number
    use spintop_lapack, only: dgesvd
    use spintop_least_squares, only: find_jacobian, minimize, minimum_t, refine_jacobian
    use spintop_residuals, only: loss_t, residuals_t
    implicit none
    private
    public :: estimate_t, describe_minimum, compare_with

    !> Derivatives of a few differences will do where the singular values exceed their errors by this factor, and where they
    !> exceed the relative error of an integration by the other: its derivatives may have a larger one.
    real(dp), parameter :: clear = 10, amplified = 1.0e4_dp
    !> The profile is followed to an end until it is met to this part of the width, in so many steps at most, of which the
    !> first few are short.
    real(dp), parameter :: end_slack = 1.0e-4_dp
    integer, parameter :: most_steps = 30, most_short_steps = 10
    !> It is given up after so many evaluations per parameter: where parameters are hardly told apart it is long and bent.
    integer, parameter :: most_evaluations = 80
    !> The search ended at another minimum where the profile has a sum of squares that is smaller by this part of the rise at
    !> an end.
    real(dp), parameter :: better_slack = 1.0e-2_dp
    !> Factor of the rounding of the residuals, which is that of what they are differences of, below
    !> which the profile is lost in rounding.
    real(dp), parameter :: lost = 100

    !> What is met at an end of a profile interval: the rise of the sum of squares that belongs to it, or the end of the
    !> range or of what has a motion; nothing, however far it is followed; no minima; a smaller sum of squares.
    integer, parameter :: end_met = 0, end_nowhere = 1, end_lost = 2, end_is_better = 3

    !> The parameters and their uncertainty.
    type :: estimate_t
        real(dp), allocatable :: x(:), standard_error(:), covariance(:, :)
        !> Ends of the 95 % intervals, in the range of the parameter; the end of that range, or infinite if it has none, where
        !> the profile does not rise enough; those of the linear model where the residuals are at rounding or at the precision
        !> of the model, where the profile cannot be followed, or where it is not wanted.
        real(dp), allocatable :: lower(:), upper(:)
        !> Singular values of the Jacobian whose columns are divided by their norms, from the largest; a small one tells
        !> of a combination of parameters that the data do not determine.
        real(dp), allocatable :: singular_values(:)
        !> Standard deviation of the residuals: given (1), or estimated from them, and then not below their rounding. With
        !> a robust loss it is that of Gaussian residuals with the same covariance of the estimates.
        real(dp) :: deviation = 1
        !> Rise of the root of the sum of squares over that of the minimum at a standard error.
        real(dp) :: rise = 1
        !> Whether the data determine all parameters; if not, which of them they do not.
        logical :: is_identifiable = .false.
        logical, allocatable :: is_undetermined(:)
        !> Errors of what the residuals are differences of: below these they are lost in rounding, or in an integration.
        real(dp) :: error_of_model = 0
        !> Whether the profile of each parameter has ends, and could be followed to them.
        logical, allocatable :: is_bounded(:), is_followed(:)
        !> Parameters with a smaller sum of squares, where a profile met them: the search ended at another minimum.
        real(dp), allocatable :: better(:)
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
        real(dp), allocatable :: jacobian(:, :), vectors(:, :), norms(:)
        real(dp) :: range, rounding, share
        integer :: k, m, n
        logical :: is_valid

        m = size(minimum%residuals)
        n = size(minimum%x)
        estimate%x = minimum%x
        allocate (estimate%standard_error(n), estimate%lower(n), estimate%upper(n), estimate%singular_values(n), &
                  source=no_number)
        allocate (estimate%is_bounded(n), estimate%is_followed(n), source=.true.)
        allocate (estimate%is_undetermined(n), source=.false.)
        allocate (estimate%covariance(n, n), source=no_number)
        allocate (jacobian(m, n), vectors(n, n), norms(n))
        call find_deviation(model%loss, minimum, knows_deviation, estimate%deviation, share)
        call find_derivatives(model, minimum, jacobian, norms, vectors, estimate, is_valid)
        if (.not. is_valid) return
        range = maxval([(norms(k) * model%step_scale(k, minimum%x(k)), k=1, n)]) / sqrt(real(m, dp))
        rounding = epsilon(rounding) * range
        if (.not. knows_deviation) estimate%deviation = max(estimate%deviation, rounding)
        estimate%rise = sqrt(share) * estimate%deviation
        estimate%error_of_model = max(lost * rounding, model%precision * range)
        if (.not. estimate%is_identifiable) return
        do k = 1, n
            vectors(k, :) = vectors(k, :) / (estimate%singular_values(k) * norms)
        end do
        estimate%covariance = estimate%deviation**2 * matmul(transpose(vectors), vectors)
        estimate%standard_error = [(sqrt(estimate%covariance(k, k)), k=1, n)]
        do k = 1, n
            if (wants_profile) model%share = max(model%share, (n + k - 1.0_dp) / (2 * n)) ! the search was the first half
            call find_interval(model, minimum, jacobian, level, k, wants_profile, estimate)
        end do
        do k = 1, n
            if (estimate%is_bounded(k)) cycle
            estimate%is_identifiable = .false.
            estimate%is_undetermined(k) = .true.
            estimate%standard_error(k) = no_number
            estimate%covariance(k, :) = no_number
            estimate%covariance(:, k) = no_number
        end do
    end subroutine describe_minimum

    !> Compares the intervals with parameters elsewhere. If these explain the measurements almost as well, but are far outside, the
    !> profiles did not find their way there, and the parameters are not determined. Almost: a minimum that noise alone makes is
    !> the best of many, and looks better than it is.
    subroutine compare_with(model, x, minimum, level, estimate)
        class(residuals_t), intent(inout) :: model !! the residuals
        real(dp), intent(in) :: x(:) !! the other parameters
        type(minimum_t), intent(in) :: minimum !! where the sum of squares is least
        real(dp), intent(in) :: level !! quantile that belongs to the intervals
        type(estimate_t), intent(inout) :: estimate !! parameters that are not determined are marked
        real(dp), parameter :: far = 4, almost = 6 ! in half widths of the interval; in standard errors
        real(dp) :: residuals(size(minimum%residuals)), lost_within(size(x)), rise
        logical :: is_valid
        integer :: k

        call model%evaluate(x, residuals, is_valid)
        if (.not. is_valid) return
        rise = sum(model%loss%bend(residuals)**2) - minimum%sum_of_squares
        if (rise > (almost * estimate%rise)**2) return
        lost_within = max(lost * epsilon(rise), model%precision) * [(model%step_scale(k, minimum%x(k)), k=1, size(x))]
        associate (width => max(estimate%upper - estimate%lower, 2 * level * estimate%standard_error), &
                   centre => (estimate%upper + estimate%lower) / 2)
            estimate%is_undetermined = estimate%is_undetermined .or. abs(x - centre) > far * (width / 2 + lost_within)
        end associate
        estimate%is_identifiable = .not. any(estimate%is_undetermined)
    end subroutine compare_with

    !> The standard deviation of the residuals, and the mean slope of their influence, 1 for least squares. With a robust loss the
    !> covariance of the estimates is that of Huber and Ronchetti (Robust Statistics, 2009, section 7.6, with the factor K^2).
    pure subroutine find_deviation(loss, minimum, knows_deviation, deviation, share)
        type(loss_t), intent(in) :: loss
        type(minimum_t), intent(in) :: minimum
        logical, intent(in) :: knows_deviation
        real(dp), intent(out) :: deviation, share
        real(dp) :: freedom, slopes(size(minimum%residuals)), scatter
        integer :: m, n

        m = size(minimum%residuals)
        n = size(minimum%x)
        freedom = max(m - n, 1)
        share = 1
        deviation = 1
        if (loss%is_robust()) then
            slopes = loss%influence_slope(minimum%residuals)
            share = max(sum(slopes), 1.0_dp) / m
            scatter = sum((slopes - share)**2) / m
            deviation = (1 + n * scatter / (m * share**2)) / share * &
                        sqrt(sum(loss%influence(minimum%residuals)**2) / freedom)
        else if (.not. knows_deviation) then
            deviation = sqrt(minimum%sum_of_squares / freedom)
        end if
    end subroutine find_deviation

    !> The Jacobian, the norms of its columns, the singular values and vectors (in rows) of the columns divided by their norms,
    !> and whether they are larger than their errors. Where that is not clear the derivatives are found again, with more work.
    subroutine find_derivatives(model, minimum, jacobian, norms, vectors, estimate, is_valid)
        class(residuals_t), intent(inout) :: model
        type(minimum_t), intent(in) :: minimum
        real(dp), intent(out) :: jacobian(:, :), norms(:), vectors(:, :)
        type(estimate_t), intent(inout) :: estimate
        logical, intent(out) :: is_valid
        real(dp), allocatable :: errors(:, :)
        integer :: i

        allocate (errors, mold=jacobian)
        call find_jacobian(model, minimum%x, [(i, i=1, size(minimum%x))], minimum%residuals, .true., jacobian, is_valid, errors)
        if (.not. is_valid) return
        call judge(clear, amplified * model%precision)
        if (estimate%is_identifiable) return
        call refine_jacobian(model, minimum%x, minimum%residuals, jacobian, errors)
        call judge(1.0_dp, 0.0_dp)

    contains

        !> Decomposes the Jacobian, and compares each singular value with its error: the change by the errors of the derivatives
        !> in the direction of its vector (Weyl's inequality).
        subroutine judge(factor, slack)
            real(dp), intent(in) :: factor, slack !! of the errors; added to them
            real(dp), parameter :: part = 0.05_dp ! of a combination, which has the size 1
            real(dp) :: divisors(size(norms)), bounds(size(norms)), scaled(size(jacobian, 1), size(norms)), unused(1, 1)
            real(dp) :: work(size(jacobian, 1) + 10 * size(norms))
            integer :: k, m, n, info

            m = size(jacobian, 1)
            n = size(norms)
            norms = norm2(jacobian, dim=1)
            divisors = merge(norms, 1.0_dp, norms > 0)
            scaled = jacobian / spread(divisors, 1, m)
            call dgesvd('N', 'A', m, n, scaled, m, estimate%singular_values, unused, 1, vectors, n, work, size(work), info)
            if (info /= 0) estimate%singular_values = no_number
            do k = 1, n
                bounds(k) = norm2(matmul(errors, abs(vectors(k, :)) / divisors)) + max(m, n) * epsilon(part)
            end do
            estimate%is_undetermined = .not. norms > norm2(errors, dim=1)
            do k = 1, n
                if (estimate%singular_values(k) > factor * bounds(k) + slack) cycle
                estimate%is_undetermined = estimate%is_undetermined .or. abs(vectors(k, :)) > part
            end do
            estimate%is_identifiable = .not. any(estimate%is_undetermined)
        end subroutine judge

    end subroutine find_derivatives

    !> The interval of a parameter, in its range: that of the linear model, or that to which the profile is followed.
    subroutine find_interval(model, minimum, jacobian, level, k, wants_profile, estimate)
        class(residuals_t), intent(inout) :: model
        type(minimum_t), intent(in) :: minimum
        real(dp), intent(in) :: jacobian(:, :), level
        integer, intent(in) :: k
        logical, intent(in) :: wants_profile
        type(estimate_t), intent(inout) :: estimate
        real(dp), allocatable :: better(:)
        real(dp) :: ends(2), place(2), range(2), width
        integer :: i, outcome

        range = model%ends(k)
        width = level * estimate%standard_error(k)
        if (wants_profile) width = max(width, spacing(minimum%x(k)))
        ends = minimum%x(k) + [-width, width]
        if (wants_profile .and. .not. (estimate%deviation <= estimate%error_of_model .or. allocated(estimate%better))) then
            do i = 1, 2
                call find_end(model, minimum, jacobian, estimate, k, sign(level, ends(i) - minimum%x(k)), place(i), outcome, &
                              better)
                if (outcome == end_is_better) call move_alloc(better, estimate%better)
                if (outcome == end_nowhere) then
                    place(i) = range(i)
                    estimate%is_bounded(k) = estimate%is_bounded(k) .and. abs(range(i)) < huge(range)
                    if (.not. abs(range(i)) < huge(range)) place(i) = 2 * range(i)
                end if
                estimate%is_followed(k) = estimate%is_followed(k) .and. (outcome == end_met .or. outcome == end_nowhere)
                if (outcome == end_met .or. outcome == end_nowhere) ends(i) = place(i)
                if (allocated(estimate%better)) exit
            end do
        end if
        estimate%lower(k) = max(ends(1), merge(range(1), ends(1), abs(range(1)) < huge(range)))
        estimate%upper(k) = min(ends(2), merge(range(2), ends(2), abs(range(2)) < huge(range)))
    end subroutine find_interval

    !> Finds the least sum of squares with a value of one parameter. The others begin on the line of the linear model, or where
    !> that leads to no motion, at the last place.
    subroutine minimize_others(model, minimum, jacobian, direction, k, value, rise_at_end, last, point)
        class(residuals_t), intent(inout) :: model
        type(minimum_t), intent(in) :: minimum
        real(dp), intent(in) :: jacobian(:, :), direction(:), value, rise_at_end, last(:)
        integer, intent(in) :: k
        type(minimum_t), intent(out) :: point
        real(dp) :: start(size(last))
        logical :: free(size(last))
        integer :: i, m

        m = size(minimum%residuals)
        free = .true.
        free(k) = .false.
        start = minimum%x + direction * (value - minimum%x(k))
        ! A curved profile is followed from its last point.
        if (abs(last(k) - minimum%x(k)) > 0) start = last + (last - minimum%x) * ((value - last(k)) / (last(k) - minimum%x(k)))
        start(k) = value
        start(:) = [(model%limited(i, start(i)), i=1, size(start))]
        call minimize(model, start, m, free, point, end_slack * rise_at_end / (minimum%sum_of_squares + rise_at_end), jacobian)
        if (point%sum_of_squares < huge(value)) return
        start = last
        start(k) = value
        call minimize(model, start, m, free, point)
    end subroutine minimize_others

    !> An end of the interval of a parameter: where the least sum of squares of the others, over the variance, exceeds the
    !> minimum by the square of the level. Its square root is almost linear in the parameter, which is followed by the
    !> method of regula falsi in the form of Illinois. The others begin on the line of the linear
    !> model, where they often need no step: the derivatives at the minimum tell.
    subroutine find_end(model, minimum, jacobian, estimate, k, level, place, outcome, better)
        class(residuals_t), intent(inout) :: model
        type(minimum_t), intent(in) :: minimum
        real(dp), intent(in) :: jacobian(:, :)
        type(estimate_t), intent(in) :: estimate
        integer, intent(in) :: k
        real(dp), intent(in) :: level !! negative for the lower end
        real(dp), intent(out) :: place
        integer, intent(out) :: outcome !! what is met there: one of `end_met` to `end_is_better`
        real(dp), allocatable, intent(out) :: better(:) !! parameters with a smaller sum of squares, if they are met
        type(minimum_t) :: point
        real(dp) :: last(size(minimum%x))
        real(dp) :: inside, outside, excess_inside, excess_outside, next, excess, root, rise_at_end
        integer :: i, n, evaluations
        logical :: is_at_end, exists

        outcome = end_lost
        evaluations = 0
        last = minimum%x
        associate (best => minimum%x(k), width => level * estimate%standard_error(k))
            inside = 0
            excess_inside = -abs(level)
            outside = 0
            excess_outside = -1
            next = width
            rise_at_end = (level * estimate%rise)**2
            do i = 1, most_steps
                is_at_end = abs(model%limited(k, best + next) - (best + next)) > 0
                if (is_at_end) next = model%limited(k, best + next) - best
                place = best + next
                call minimize_others(model, minimum, jacobian, estimate%covariance(:, k) / estimate%covariance(k, k), k, &
                                     place, rise_at_end, last, point)
                evaluations = evaluations + point%evaluations
                root = no_number
                exists = point%sum_of_squares < huge(root)
                associate (rise => point%sum_of_squares - minimum%sum_of_squares)
                    if (rise < -better_slack * rise_at_end) then
                        outcome = end_is_better
                        better = point%x
                        return
                    end if
                    if (point%has_converged) root = sqrt(max(rise, 0.0_dp)) / estimate%rise
                end associate
                excess = root - abs(level)
                if (abs(excess) <= end_slack * abs(level) .or. (is_at_end .and. excess < 0)) outcome = end_met
                if (outcome == end_met .or. evaluations > most_evaluations * size(minimum%x)) return
                if (.not. is_finite(excess)) then
                    if (excess_outside > 0) return
                    next = (inside + next) / 2
                    place = best + inside
                    if (.not. abs(next - inside) <= end_slack * abs(width)) cycle
                    ! Beyond this there is no motion, as at the open end of a range.
                    if (.not. exists) outcome = end_met
                    associate (ends => model%ends(k))
                        n = merge(1, 2, level < 0)
                        if (abs(ends(n) - place) <= end_slack * abs(width)) place = ends(n)
                    end associate
                    return
                end if
                if (excess > 0) then
                    if (excess_outside > 0) excess_inside = excess_inside / 2
                    outside = next
                    excess_outside = excess
                else
                    if (excess_outside > 0) excess_outside = excess_outside / 2
                    inside = next
                    excess_inside = excess
                    last = point%x
                end if
                if (excess_outside > 0) then
                    next = inside + (outside - inside) * excess_inside / (excess_inside - excess_outside)
                else
                    next = inside * min(max(abs(level) / max(root, tiny(root)), merge(1.01_dp, 2.0_dp, i < most_short_steps)), &
                                        3.0_dp)
                end if
            end do
        end associate
        if (.not. excess_outside > 0) outcome = end_nowhere
    end subroutine find_end

end module spintop_intervals
