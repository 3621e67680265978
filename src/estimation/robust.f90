!> The search by least squares, or with a robust loss. The standard deviation that such a loss needs is found with the
!> parameters where it is not known.
module spintop_robust
    use spintop_kinds, only: dp
    use spintop_least_squares, only: minimize, minimum_t
    use spintop_losses, only: loss_huber, loss_squares, loss_t, loss_tukey
    use spintop_residuals, only: residuals_t
    implicit none
    private
    public :: minimize_loss, robust_deviation

    !> The median of the magnitude of a Gaussian number in standard deviations.
    real(dp), parameter :: median_of_gaussian = 0.6744897501960817_dp
    !> The standard deviation is found in so many searches at most, to this part of it, and not below this part of the data.
    integer, parameter :: most_searches = 30
    real(dp), parameter :: same_deviation = 1.0e-4_dp, least_part = 1.0e-13_dp

contains

    !> Finds the least sum of the losses near `x`. Tukey's loss, which has more than one minimum, begins where Huber's ends.
    subroutine minimize_loss(model, x, m, kind, knows_deviation, minimum, goal)
        class(residuals_t), intent(inout) :: model !! the residuals; their loss is set
        real(dp), intent(in) :: x(:) !! the parameters at the beginning
        integer, intent(in) :: m !! number of residuals, more than parameters
        integer, intent(in) :: kind !! of the loss, one of `loss_squares` to `loss_tukey`
        logical, intent(in) :: knows_deviation !! whether the standard deviation of the residuals is 1
        type(minimum_t), intent(out) :: minimum !! where the search ended
        real(dp), intent(in), optional :: goal !! a search ends if no more than this part of the sum of squares can be gained
        integer :: evaluations, steps

        call settle(model, x, m, min(kind, loss_huber), knows_deviation, minimum, goal)
        if (kind /= loss_tukey .or. .not. minimum%has_converged) return
        evaluations = minimum%evaluations
        steps = minimum%steps
        call settle(model, [minimum%x], m, loss_tukey, knows_deviation, minimum, goal)
        minimum%evaluations = minimum%evaluations + evaluations
        minimum%steps = minimum%steps + steps
    end subroutine minimize_loss

    !> Finds the least sum of the losses of one kind, search by search until the standard deviation is that of the residuals.
    subroutine settle(model, x, m, kind, knows_deviation, minimum, goal)
        class(residuals_t), intent(inout) :: model
        real(dp), intent(in) :: x(:)
        integer, intent(in) :: m, kind
        logical, intent(in) :: knows_deviation
        type(minimum_t), intent(out) :: minimum
        real(dp), intent(in), optional :: goal
        real(dp), allocatable :: from(:), residuals(:)
        real(dp) :: deviation, last, least
        logical :: is_valid
        integer :: i, evaluations

        model%loss = loss_t(kind, 1.0_dp)
        is_valid = kind /= loss_squares .and. .not. knows_deviation
        allocate (residuals(m))
        if (is_valid) call model%evaluate(x, residuals, is_valid)
        if (.not. is_valid) then
            call minimize(model, x, m, spread(.true., 1, size(x)), minimum, goal)
            return
        end if
        allocate (from, source=x)
        evaluations = 1
        least = max(least_part * model%size_of_data() / sqrt(real(m, dp)), tiny(least))
        deviation = robust_deviation(residuals, size(x))
        do i = 1, most_searches
            last = max(deviation, least)
            model%loss = loss_t(kind, last)
            call minimize(model, from, m, spread(.true., 1, size(x)), minimum, goal)
            evaluations = evaluations + minimum%evaluations
            if (.not. minimum%has_converged) exit
            deviation = robust_deviation(minimum%residuals, size(x))
            if (abs(max(deviation, least) - last) <= same_deviation * last) exit
            from(:) = minimum%x
        end do
        minimum%evaluations = evaluations
    end subroutine settle

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
