!> Polynomials of a step, one in each lane, as arrays (lane, term from 0 on): products, by lane_products.h, and over the step as
!> the unit interval where they pass zero, by lane_roots.h.
!>
!> No change of sign among the coefficients in Bernstein form (`spintop_bernstein`), or one, is certain; an interval with more
!> is halved.
module spintop_lane_polynomials
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_bernstein, only: halve, root_of
    use spintop_formulation, only: max_series_order
    use spintop_kinds, only: dp
    use spintop_series_shares, only: per_binomial
    implicit none
    private
    public :: find_changes, refine_root, find_roots, most_roots, rounding, multiply, square, multiply_slopes

    !> Rounding of a polynomial, in units of its terms.
    real(c_double), parameter :: rounding = 8 * epsilon(1.0_dp)
    !> Roots of one lane in one step that are found at most.
    integer, parameter :: most_roots = 32
    !> A root is bisected so often at most.
    integer, parameter :: most_halvings = 50

    interface
        !> The product of two series.
        pure subroutine multiply(degree, x, y, product) bind(C, name='spintop_multiply_lanes')
            import :: c_double, c_int
            integer(c_int), value :: degree !! last term of the product
            real(c_double), intent(in) :: x(*), y(*) !! coefficients of the series
            real(c_double), intent(inout) :: product(*) !! those of the product
        end subroutine multiply

        !> The square of a series.
        pure subroutine square(degree, x, product) bind(C, name='spintop_square_lanes')
            import :: c_double, c_int
            integer(c_int), value :: degree !! last term of the square
            real(c_double), intent(in) :: x(*) !! coefficients of the series
            real(c_double), intent(inout) :: product(*) !! those of the square
        end subroutine square

        !> The series of x' y - x y'.
        pure subroutine multiply_slopes(degree, x, y, product) bind(C, name='spintop_multiply_slopes')
            import :: c_double, c_int
            integer(c_int), value :: degree !! last term of the product
            real(c_double), intent(in) :: x(*), y(*) !! coefficients of the series, up to one more term
            real(c_double), intent(inout) :: product(*) !! those of the product
        end subroutine multiply_slopes

        !> Changes of sign among the Bernstein coefficients of the polynomials sum of a_k u^k, k = 0..n, for u from 0 to 1. Those up
        !> to `noise` have no sign.
        pure subroutine find_changes(n, per_binomial, rounding, a, noise, sign_before, changes, near) &
            bind(C, name='spintop_find_changes')
            import :: c_double, c_int
            integer(c_int), value :: n !! degree
            real(c_double), intent(in) :: per_binomial(*), a(*) !! 1 over the binomial coefficients; coefficients of the powers of u
            real(c_double), value :: rounding !! rounding of a polynomial, in units of its terms
            real(c_double), intent(inout) :: noise(*) !! bounds of the errors, to which the rounding of the terms is added
            real(c_double), intent(inout) :: sign_before(*)
                !! sign before the interval (1, -1, or 0 if unknown), replaced by the sign at its end
            real(c_double), intent(inout) :: changes(*), near(*)
                !! numbers of changes of sign; fractions of the interval at which a single one is
        end subroutine find_changes

        !> Refines roots by Newton's method.
        pure subroutine refine_root(n, iterations, still, a, u, doubt) bind(C, name='spintop_refine_root')
            import :: c_double, c_int
            integer(c_int), value :: n, iterations !! degree; number of iterations
            real(c_double), value :: still !! length of the last from which on the root is right to rounding
            real(c_double), intent(in) :: a(*) !! coefficients of the powers of u
            real(c_double), intent(inout) :: u(*), doubt(*) !! approximate roots; positive where the iteration did not converge
        end subroutine refine_root
    end interface

contains

    !> All roots of the polynomial of one lane in rising order, by halving; `sign_before` as in `find_changes`.
    !> At most `most_roots` are found.
    subroutine find_roots(a, noise, sign_before, roots, signs, found)
        real(dp), intent(in) :: a(0:), noise !! coefficients, and a bound of their rounding errors
        real(dp), intent(inout) :: sign_before !! sign before the interval, replaced by the sign at its end
        real(dp), intent(out) :: roots(most_roots) !! the roots as fractions of the interval
        real(dp), intent(out) :: signs(most_roots) !! of the slope at each
        integer, intent(out) :: found !! number of roots
        real(dp) :: b(0:max_series_order) ! of known size, on the stack
        integer :: n, j, k

        n = size(a) - 1
        b(:n) = per_binomial(:n, n) * a
        do k = 1, n
            do j = n, k, -1
                b(j) = b(j) + b(j - 1)
            end do
        end do
        found = 0
        call search(b(:n), 0.0_dp, 1.0_dp, 0)

    contains

        !> Roots in an interval, from its Bernstein coefficients.
        recursive subroutine search(b, from, to, depth)
            real(dp), intent(in) :: b(0:), from, to
            integer, intent(in) :: depth
            real(dp) :: left(0:max_series_order), right(0:max_series_order), now, carried
            integer :: j, changes, n

            n = size(b) - 1
            changes = 0
            carried = sign_before
            do j = 0, n
                now = merge(b(j), 0.0_dp, abs(b(j)) > noise)
                if (now * carried < 0) changes = changes + 1
                if (abs(now) > 0) carried = sign(1.0_dp, now)
            end do
            if (changes == 0 .or. found == most_roots) then
                sign_before = carried
                return
            end if
            if (depth == most_halvings .or. (changes == 1 .and. min(abs(b(0)), abs(b(n))) > noise)) then
                found = found + 1
                roots(found) = from
                if (changes == 1 .and. b(0) * b(n) < 0) roots(found) = from + (to - from) * root_of(b, epsilon(1.0_dp))
                signs(found) = carried
                sign_before = carried
                return
            end if
            call halve(b, left(:n), right(:n))
            call search(left(:n), from, (from + to) / 2, depth + 1)
            call search(right(:n), (from + to) / 2, to, depth + 1)
        end subroutine search

    end subroutine find_roots

end module spintop_lane_polynomials
