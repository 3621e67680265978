!> Conditions on the coefficients of methods: of a Runge-Kutta method one for each rooted tree (Hairer, Norsett and Wanner I,
!> II.2); of a splitting method, kick, drift, kick, ..., kick.
module order_conditions
    use spintop_kinds, only: dp
    implicit none
    private
    public :: order_residual, highest_order, word_residual, nystrom_residual

    !> Highest orders that are checked here, and more than the number of trees up to them.
    integer, parameter :: highest_order = 8, highest_nystrom = 9, all_trees = 400

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

    !> Largest violation of the conditions up to an order, for any two flows: the product of the
    !> exponentials of the two parts is that of their sum. In the free algebra of two letters the
    !> coefficient of each word of n letters is then 1/n!.
    real(dp) function word_residual(kick, drift, order) result(residual)
        real(dp), intent(in) :: kick(0:), drift(:)
        integer, intent(in) :: order
        !> Words in binary, the first letter foremost, after a leading 1: 1 is the empty word.
        real(dp) :: coefficient(2**(order + 1) - 1)
        integer :: i, length
        coefficient = 0
        coefficient(1) = 1
        call multiply(kick(0), 1)
        do i = 1, size(drift)
            call multiply(drift(i), 0)
            call multiply(kick(i), 1)
        end do
        residual = 0
        do length = 1, order
            residual = max(residual, maxval(abs(coefficient(2**length:2**(length + 1) - 1) - 1 / gamma(length + 1.0_dp))))
        end do

    contains

        !> Multiplies by exp(x letter), on the right.
        subroutine multiply(x, letter)
            real(dp), intent(in) :: x
            integer, intent(in) :: letter
            real(dp) :: total, power
            integer :: word, rest, n
            ! Longer words first: they depend on shorter ones.
            do word = size(coefficient), 1, -1
                total = coefficient(word)
                power = 1
                rest = word
                n = 0
                do while (rest > 1 .and. mod(rest, 2) == letter)
                    n = n + 1
                    power = power * x / n
                    rest = rest / 2
                    total = total + power * coefficient(rest)
                end do
                coefficient(word) = total
            end do
        end subroutine multiply

    end function word_residual

    !> The same for y'' = g(y), where only special Nystrom trees matter (Hairer, Norsett and Wanner I,
    !> II.14): a root with rates as leaves, and with branches that are such trees, two steps away.
    real(dp) function nystrom_residual(kick, drift, order) result(residual)
        real(dp), intent(in) :: kick(0:), drift(:)
        integer, intent(in) :: order
        !> Of each tree: its number of nodes; the factor of t^(nodes - 1) in its elementary
        !> differential along the exact solution, and that twice integrated at the kicks.
        integer :: nodes(all_trees), trees, n
        real(dp) :: factor(all_trees), twice(0:size(drift), all_trees), place(0:size(drift))

        place(0) = 0
        do n = 1, size(drift)
            place(n) = place(n - 1) + drift(n)
        end do
        trees = 0
        residual = abs(place(size(drift)) - 1)
        do n = 1, min(order, highest_nystrom)
            call plant(n - 1, (trees), spread(1.0_dp, 1, size(drift) + 1), 1.0_dp)
        end do

    contains

        !> Adds all trees whose root has `left` more nodes, each branch a tree up to number `last`,
        !> besides those that the weights and the factor stand for.
        recursive subroutine plant(left, last, weight, branches)
            integer, intent(in) :: left, last
            real(dp), intent(in) :: weight(0:), branches
            integer :: i
            call add_tree(weight * place**left, branches)
            do i = last, 1, -1
                if (nodes(i) >= left) cycle
                call plant(left - nodes(i) - 1, i, weight * twice(:, i), branches * factor(i) / (nodes(i) * (nodes(i) + 1)))
            end do
        end subroutine plant

        subroutine add_tree(weight, branches)
            real(dp), intent(in) :: weight(0:), branches
            integer :: i
            trees = trees + 1
            nodes(trees) = n
            factor(trees) = branches
            do i = 0, size(drift)
                twice(i, trees) = sum(kick(:i) * (place(i) - place(:i)) * weight(:i))
            end do
            residual = max(residual, abs(sum(kick * weight) - branches / n))
            if (n == order) return
            residual = max(residual, abs(sum(kick * (1 - place) * weight) - branches / (n * (n + 1))))
        end subroutine add_tree

    end function nystrom_residual

end module order_conditions
