!> Conditions on the coefficients of a Runge-Kutta method (Hairer, Norsett and Wanner I, II.2).
module order_conditions
    use spintop_kinds, only: dp
    implicit none
    private
    public :: order_residual, highest_order

    !> Highest order that is checked here.
    integer, parameter :: highest_order = 5
    !> Conditions up to each order.
    integer, parameter :: conditions(highest_order) = [1, 2, 4, 8, 17]

contains

    !> Largest violation of the conditions up to an order, of the method with rows a(i, :) and
    !> weights b. With `place` the weights are those of dense output at that fraction of a step.
    pure real(dp) function order_residual(a, b, order, place) result(residual)
        real(dp), intent(in) :: a(:, :), b(:)
        integer, intent(in) :: order
        real(dp), intent(in), optional :: place
        integer, parameter :: density(17) = &
            [1, 2, 3, 6, 4, 8, 12, 24, 5, 10, 15, 30, 20, 20, 40, 60, 120]
        integer, parameter :: tree_order(17) = [1, 2, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5, 5]
        real(dp) :: c(size(b)), ac(size(b)), acc(size(b)), aac(size(b)), weights(17), s
        integer :: last

        c = sum(a, dim=2)
        ac = matmul(a, c)
        acc = matmul(a, c**2)
        aac = matmul(a, ac)
        weights = [sum(b), &
                   dot_product(b, c), &
                   dot_product(b, c**2), dot_product(b, ac), &
                   dot_product(b, c**3), dot_product(b, c * ac), dot_product(b, acc), &
                   dot_product(b, aac), &
                   dot_product(b, c**4), dot_product(b, c**2 * ac), dot_product(b, c * acc), &
                   dot_product(b, c * aac), dot_product(b, ac**2), &
                   dot_product(b, matmul(a, c**3)), dot_product(b, matmul(a, c * ac)), &
                   dot_product(b, matmul(a, acc)), dot_product(b, matmul(a, aac))]
        s = 1
        if (present(place)) s = place
        last = conditions(min(order, highest_order))
        residual = maxval(abs(weights(:last) - s**tree_order(:last) / density(:last)))
    end function order_residual

end module order_conditions
