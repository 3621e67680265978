!> Conditions on the coefficients of a Runge-Kutta method, one for each rooted tree (Hairer, Norsett
!> and Wanner I, II.2).
module order_conditions
    use spintop_kinds, only: dp
    implicit none
    private
    public :: order_residual, highest_order

    !> Highest order that is checked here, and number of trees up to it.
    integer, parameter :: highest_order = 8, all_trees = 200

contains

    !> Largest violation of the conditions up to an order, of the method with rows a(i, :) and
    !> weights b. With `place` the weights are those of dense output at that fraction of a step.
    real(dp) function order_residual(a, b, order, place) result(residual)
        real(dp), intent(in) :: a(:, :), b(:)
        integer, intent(in) :: order
        real(dp), intent(in), optional :: place
        !> Of each tree: its number of nodes, its density, and a times its elementary weights.
        integer :: nodes(all_trees), trees, n
        real(dp) :: density(all_trees), weights(size(b), all_trees), ones(size(b)), s

        s = 1
        if (present(place)) s = place
        ones = 1
        trees = 0
        residual = 0
        do n = 1, min(order, highest_order)
            call plant(n - 1, trees, ones, 1.0_dp)
        end do

    contains

        !> Adds all trees whose root has branches with `left` more nodes, each branch a tree up to
        !> number `last`, besides those that the product of weights and densities stands for.
        recursive subroutine plant(left, last, weight, branches)
            integer, intent(in) :: left, last
            real(dp), intent(in) :: weight(:), branches
            integer :: i
            if (left == 0) then
                trees = trees + 1
                nodes(trees) = n
                density(trees) = n * branches
                weights(:, trees) = matmul(a, weight)
                residual = max(residual, abs(dot_product(b, weight) - s**n / density(trees)))
                return
            end if
            do i = last, 1, -1
                if (nodes(i) > left) cycle
                call plant(left - nodes(i), i, weight * weights(:, i), branches * density(i))
            end do
        end subroutine plant

    end function order_residual

end module order_conditions
