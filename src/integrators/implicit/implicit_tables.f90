!> Coefficients of the implicit methods: Gauss-Legendre methods of any order, and theta methods.
module spintop_implicit_tables
    use spintop_kinds, only: dp, xp
    use spintop_lapack, only: dgeev, dgetrf, dgetrs
    implicit none
    private
    public :: implicit_table_t, max_implicit_stages, max_modes, gauss_table, theta_table, general_table

    !> Maximum number of stages of a table.
    integer, parameter :: max_implicit_stages = 4
    !> Maximum number of eigenvalues of a with a nonnegative imaginary part.
    integer, parameter :: max_modes = (max_implicit_stages + mod(max_implicit_stages, 2)) / 2

    !> A collocation method for y' = f(t, y). Its stages lie at t + node_i h and y + z_i,
    !> z_i = h (first f(t, y) + sum_j a_ij f(t + node_j h, y + z_j)),
    !> and its polynomial of the step goes through y and all of them.
    type :: implicit_table_t
        integer :: stages = 0
        !> Nodes: positions of the stages in the step.
        real(dp) :: node(max_implicit_stages) = 0
        real(dp) :: a(max_implicit_stages, max_implicit_stages) = 0
        !> Weight of the slope at the beginning of the step.
        real(dp) :: first = 0
        !> The change of the state is sum_i last(i) z_i, the polynomial at the end of the step. In this form,
        !> without slopes, nothing cancels (Hairer, Lubich and Wanner, Geometric Numerical Integration,
        !> VIII.6).
        real(dp) :: last(max_implicit_stages) = 0
        !> Extrapolation of the polynomial to the next step of the same size: z_j is approximately sum_i
        !> ahead(i, j) z_i of this step.
        real(dp) :: ahead(max_implicit_stages, max_implicit_stages) = 0
        !> Eigenvalues of a, one of each conjugate pair. A real matrix over the stages is the real part of
        !> from_modes times its form in the eigenvectors, to which to_modes transforms.
        integer :: modes = 0
        complex(dp) :: eigenvalue(max_modes) = 0
        complex(dp) :: to_modes(max_implicit_stages, max_modes) = 0
        complex(dp) :: from_modes(max_modes, max_implicit_stages) = 0
    end type implicit_table_t

contains

    !> The Gauss-Legendre method of order 2 s with s stages (Kuntzmann 1961, Butcher 1964). The nodes are the
    !> roots of the Legendre polynomial P_s on the step. a_ij is the integral up to node i of the polynomial
    !> that is 1 at node j and 0 at the others. Its expansion in P_0 .. P_(s-1), whose discrete products at
    !> these nodes equal those of the integrals, is a sum without cancellation. One stage gives the implicit
    !> midpoint rule.
    type(implicit_table_t) function gauss_table(stages) result(table)
        integer, intent(in) :: stages !! number of stages
        real(xp) :: root(stages), weight(stages), legendre(-1:stages, stages), slope
        integer :: i, j, k

        do i = 1, stages
            root(i) = legendre_root(stages, i)
            legendre(:, i) = legendre_values(stages, root(i))
            slope = stages * legendre(stages - 1, i) / (1 - root(i)**2)
            weight(i) = 1 / ((1 - root(i)**2) * slope**2)
        end do
        table%stages = stages
        do j = 1, stages
            do i = 1, stages
                table%a(i, j) = real(weight(j) / 2 * sum([(legendre(k, j) &
                    * (legendre(k + 1, i) - legendre(k - 1, i)), k=0, stages - 1)]), dp)
            end do
        end do
        call lay_polynomial(table, (1 + root) / 2)
        call find_modes(table)
    end function gauss_table

    !> The theta method y+ = y + h [(1-alpha) f(y) + alpha f(y+)], 0 < alpha <= 1, whose only stage is at the
    !> end of the step.
    type(implicit_table_t) function theta_table(alpha) result(table)
        real(dp), intent(in) :: alpha !! weight of the slope at the end of the step
        table%stages = 1
        table%a(1, 1) = alpha
        table%first = 1 - alpha
        call lay_polynomial(table, [1.0_xp])
        call find_modes(table)
    end function theta_table

    !> Any implicit method. The first guess of its stages is on a straight line, because nodes may be equal or zero.
    subroutine general_table(a, b, c, table, is_regular)
        real(dp), intent(in) :: a(:, :), b(:), c(:) !! coefficients, weights and nodes; as many rows and columns as stages
        type(implicit_table_t), intent(out) :: table !! the table, if it is regular
        logical, intent(out) :: is_regular !! whether a can be inverted, and has as many eigenvectors as stages
        real(dp) :: factors(size(b), size(b)), weights(size(b), 1)
        integer :: pivots(size(b)), failure, i, n
        !> Smaller pivots, and eigenvectors that are closer to each other, are taken for rounding.
        real(dp), parameter :: smallest = 1.0e-10_dp

        n = size(b)
        factors = a
        weights(:, 1) = b
        is_regular = .false.
        call dgetrf(n, n, factors, n, pivots, failure)
        if (failure /= 0 .or. any(abs([(factors(i, i), i=1, n)]) < smallest)) return
        call dgetrs('T', n, 1, factors, n, pivots, weights, n, failure)
        table%stages = n
        table%node(:n) = c
        table%a(:n, :n) = a
        table%last(:n) = weights(:, 1)
        do i = 1, n
            table%ahead(:n, i) = c(i) * table%last(:n)
        end do
        call find_modes(table)
        is_regular = maxval(abs(table%to_modes)) < 1 / smallest
    end subroutine general_table

    !> Computes the polynomial that is zero at the beginning of the step and interpolates the stages.
    pure subroutine lay_polynomial(table, node)
        type(implicit_table_t), intent(inout) :: table
        real(xp), intent(in) :: node(:)
        integer :: i, j
        table%node(:size(node)) = real(node, dp)
        do i = 1, size(node)
            table%last(i) = real(basis(node, i, 1.0_xp), dp)
            do j = 1, size(node)
                table%ahead(i, j) = real(basis(node, i, 1 + node(j)) - basis(node, i, 1.0_xp), dp)
            end do
        end do
    end subroutine lay_polynomial

    !> The polynomial that is 1 at node i, and 0 at the others and at the beginning of the step.
    pure real(xp) function basis(node, i, place)
        real(xp), intent(in) :: node(:), place
        integer, intent(in) :: i
        integer :: k
        basis = place / node(i)
        do k = 1, size(node)
            if (k /= i) basis = basis * (place - node(k)) / (node(i) - node(k))
        end do
    end function basis

    !> Computes eigenvalues and eigenvectors of the coefficients a.
    subroutine find_modes(table)
        type(implicit_table_t), intent(inout) :: table
        integer, parameter :: n = max_implicit_stages
        real(dp) :: a(n, n), re(n), im(n), left(n, n), right(n, n), work(8 * n)
        complex(dp) :: u(n), v(n)
        integer :: j, s, failure

        s = table%stages
        a = table%a
        call dgeev('V', 'V', s, a, n, re, im, left, n, right, n, work, size(work), failure)
        do j = 1, s
            if (im(j) < 0) cycle
            u = left(:, j)
            v = right(:, j)
            if (im(j) > 0) then
                u = cmplx(left(:, j), left(:, j + 1), dp)
                v = cmplx(right(:, j), right(:, j + 1), dp)
            end if
            table%modes = table%modes + 1
            table%eigenvalue(table%modes) = cmplx(re(j), im(j), dp)
            table%to_modes(:s, table%modes) = conjg(u(:s)) / dot_product(u(:s), v(:s))
            ! The conjugate has the same real part.
            table%from_modes(table%modes, :s) = merge(2, 1, im(j) > 0) * v(:s)
        end do
    end subroutine find_modes

    !> Root i of the Legendre polynomial P_n, in increasing order, by Newton's method.
    pure real(xp) function legendre_root(n, i) result(x)
        integer, intent(in) :: n, i
        !> Each correction doubles the number of correct digits; the initial guess has at least two.
        integer, parameter :: enough = 6
        real(xp), parameter :: half_turn = acos(-1.0_xp)
        real(xp) :: p(-1:n)
        integer :: correction
        x = -cos(half_turn * (i - 0.25_xp) / (n + 0.5_xp))
        do correction = 1, enough
            p = legendre_values(n, x)
            x = x - p(n) * (1 - x**2) / (n * (p(n - 1) - x * p(n)))
        end do
    end function legendre_root

    !> Legendre polynomials P_0 .. P_n at x. Index -1 is the constant for which (P_(k+1) - P_(k-1))/(2k + 1),
    !> the integral of P_k from -1 to x, holds for k = 0 too.
    pure function legendre_values(n, x) result(p)
        integer, intent(in) :: n
        real(xp), intent(in) :: x
        real(xp) :: p(-1:n)
        integer :: k
        p(-1) = -1
        p(0) = 1
        p(1) = x
        do k = 1, n - 1
            p(k + 1) = ((2 * k + 1) * x * p(k) - k * p(k - 1)) / (k + 1)
        end do
    end function legendre_values

end module spintop_implicit_tables
