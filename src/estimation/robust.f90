!> The search by least squares, or with Huber's loss, which bounds the effect of a residual: beyond 1.345 standard deviations
!> its loss is linear (Huber and Ronchetti, Robust Statistics, 2nd edition, 2009, chapter 7). With Gaussian residuals the
!> estimates have 95 % of the efficiency of least squares.
module spintop_robust
    use spintop_kinds, only: dp
    use spintop_least_squares, only: minimize, minimum_t
    use spintop_residuals, only: residuals_t
    implicit none
    private
    public :: huber_bound, minimize_loss, robust_deviation

    !> The bound in standard deviations, and the median of the magnitude of a Gaussian number in these.
    real(dp), parameter :: huber_bound = 1.345_dp, median_of_gaussian = 0.6744897501960817_dp
    !> The standard deviation is found in so many searches at most, to this part of it, and not below this part of the data.
    integer, parameter :: most_searches = 30
    real(dp), parameter :: same_deviation = 1.0e-4_dp, least_part = 1.0e-13_dp

contains

    !> Finds the least sum of squares near `x`, or the least of Huber's losses. The standard deviation that his loss needs is
    !> found with the parameters where it is not known, search by search.
    subroutine minimize_loss(model, x, m, is_huber, knows_deviation, minimum)
        class(residuals_t), intent(inout) :: model !! the residuals; their bound is set
        real(dp), intent(in) :: x(:) !! the parameters at the beginning
        integer, intent(in) :: m !! number of residuals, more than parameters
        logical, intent(in) :: is_huber !! whether the loss is that of Huber
        logical, intent(in) :: knows_deviation !! whether the standard deviation of the residuals is 1
        type(minimum_t), intent(out) :: minimum !! where the search ended
        real(dp), allocatable :: from(:), residuals(:)
        real(dp) :: deviation, last, least
        logical :: is_valid
        integer :: i, evaluations

        model%bound = huge(model%bound)
        if (is_huber .and. knows_deviation) model%bound = huber_bound
        is_valid = is_huber .and. .not. knows_deviation
        allocate (residuals(m))
        if (is_valid) call model%evaluate(x, residuals, is_valid)
        if (.not. is_valid) then
            call minimize(model, x, m, spread(.true., 1, size(x)), minimum)
            return
        end if
        allocate (from, source=x)
        evaluations = 1
        least = max(least_part * model%size_of_data() / sqrt(real(m, dp)), tiny(least))
        deviation = robust_deviation(residuals, size(x))
        do i = 1, most_searches
            last = max(deviation, least)
            model%bound = huber_bound * last
            call minimize(model, from, m, spread(.true., 1, size(x)), minimum)
            evaluations = evaluations + minimum%evaluations
            if (.not. minimum%has_converged) exit
            deviation = robust_deviation(minimum%residuals, size(x))
            if (abs(max(deviation, least) - last) <= same_deviation * last) exit
            from(:) = minimum%x
        end do
        minimum%evaluations = evaluations
    end subroutine minimize_loss

    !> The standard deviation of residuals by the median of their magnitudes, without the smallest, as many as parameters,
    !> which these can make vanish.
    pure real(dp) function robust_deviation(residuals, parameters) result(deviation)
        real(dp), intent(in) :: residuals(:) !! the residuals, more than parameters
        integer, intent(in) :: parameters !! number of parameters that were fitted
        associate (m => size(residuals))
            deviation = smallest(abs(residuals), min(parameters + (m - parameters + 1) / 2, m)) / median_of_gaussian
        end associate
    end function robust_deviation

    !> The k-th smallest of some numbers (Hoare's selection).
    pure real(dp) function smallest(numbers, k)
        real(dp), intent(in) :: numbers(:)
        integer, intent(in) :: k
        real(dp) :: x(size(numbers)), pivot, kept
        integer :: first, last, i, j

        x = numbers
        first = 1
        last = size(x)
        do while (first < last)
            pivot = x(k)
            i = first
            j = last
            do while (i <= j)
                do while (x(i) < pivot)
                    i = i + 1
                end do
                do while (pivot < x(j))
                    j = j - 1
                end do
                if (i > j) exit
                kept = x(i)
                x(i) = x(j)
                x(j) = kept
                i = i + 1
                j = j - 1
            end do
            if (j < k) first = i
            if (k < i) last = j
        end do
        smallest = x(k)
    end function smallest

end module spintop_robust
