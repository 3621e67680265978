!> Polynomials over the unit interval in Bernstein form, and those of a step in lanes as arrays (lane, term from 0 on), with
!> their products, by lane_products.h, and where they pass zero, by lane_roots.h.
!>
!> Such a polynomial lies between its smallest and its largest coefficient, and passes zero in the interval as often as its
!> coefficients change sign, or an even number of times less (Descartes; Farouki, Computer Aided Geometric Design 29, 2012). Its
!> first and its last coefficient are its values at the ends; each difference of neighbours is a coefficient of its slope, but for
!> a factor. No change of sign, or one, is certain; an interval with more is halved.
module spintop_bernstein
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_bracket, only: bracket_t
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: per_binomial
    use spintop_kinds, only: dp, no_number, pi
    implicit none
    private
    public :: halve, root_of, value_at, interpolation_t, interpolation, coarse, fine, find_changes, refine_root, &
        find_roots, most_roots, rounding, multiply, square, multiply_slopes

    !> Degrees of interpolation.
    integer, parameter :: coarse = 4, fine = 8
    !> The last terms of the series by Chebyshev's polynomials, times so much, bound the error of a polynomial: what it leaves out,
    !> and the rounding of the values. Of three terms one at least is as large as the rounding; of a coarse polynomial the one
    !> before the last says little of those left out, and the third nothing.
    real(dp), parameter :: of_last(3) = [16, 16, 16], of_last_coarse(3) = [16, 2, 0]
    !> The bound is at least so many times the largest value.
    real(dp), parameter :: least_error = 32 * epsilon(1.0_dp)
    !> A polynomial with a larger bound than this fraction of the largest value is useless.
    real(dp), parameter :: useless = 0.25_dp

    !> Interpolation by a polynomial of a degree n at the places (1 - cos(pi i/n))/2, i = 0 .. n, by Chebyshev and Lobatto. The
    !> coefficients are those of degree `fine`.
    type :: interpolation_t
        integer :: degree = fine
        real(dp) :: place(0:fine) = 0
        !> The coefficients differ from the straight line between the first and the last value by less than so many times the sum
        !> of the differences of the values from it, less the bound of the error.
        real(dp) :: bend = 0
        !> Weights of the values, by columns, in the coefficients and in the last terms.
        real(dp), private :: weight(0:fine, 0:fine) = 0, last(3, 0:fine) = 0
    contains
        procedure :: find_polynomial
    end type interpolation_t

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

    !> Interpolation of degree `coarse` or `fine`.
    pure type(interpolation_t) function interpolation(degree) result(self)
        integer, intent(in) :: degree !! the degree
        real(dp) :: c(0:fine), share(3)
        integer :: i, m

        self%degree = degree
        self%place(:degree) = [(sin(pi * i / (2 * degree))**2, i=0, degree)]
        do i = 0, degree
            ! The product of (u - u_m)/(u_i - u_m), and of 1 = 1 - u + u, in terms of (1 - u)^(n - k) u^k.
            c = 0
            c(0) = 1
            do m = 0, degree
                if (m == i) cycle
                associate (u => self%place(m), width => self%place(i) - self%place(m))
                    c(1:) = (c(:fine - 1) * (1 - u) - c(1:) * u) / width
                    c(0) = -c(0) * u / width
                end associate
            end do
            do m = degree + 1, fine
                c(1:) = c(1:) + c(:fine - 1)
            end do
            self%weight(:, i) = c * per_binomial(:fine, fine)
            share = merge(of_last_coarse, of_last, degree == coarse) * (-1)**i * 2 / degree
            if (i == 0 .or. i == degree) share = share / 2
            self%last(:, i) = share * [0.5_dp, cos(pi * i / degree), cos(2 * pi * i / degree)]
        end do
        self%bend = maxval(abs(self%weight(:, 1:degree - 1))) + maxval(abs(self%last(:, 1:degree - 1)))
    end function interpolation

    !> The polynomial through values, and a bound of its error. If it is useless, the bound is not below any of its coefficients;
    !> if a value is not finite, all coefficients but those at the ends are no numbers.
    pure subroutine find_polynomial(self, values, b, error)
        class(interpolation_t), intent(in) :: self
        real(dp), intent(in) :: values(0:) !! at the places
        real(dp), intent(out) :: b(0:fine), error !! the coefficients; the bound
        real(dp) :: last(3), largest
        integer :: i

        b = 0
        last = 0
        do i = 0, self%degree
            b = b + self%weight(:, i) * values(i)
            last = last + self%last(:, i) * values(i)
        end do
        largest = maxval(abs(values(:self%degree)))
        b(0) = values(0)
        b(fine) = values(self%degree)
        error = max(abs(last(1)), abs(last(2)), abs(last(3)), least_error * largest)
        if (sum(abs(values(:self%degree))) <= huge(1.0_dp)) then
            if (error > useless * largest) error = max(error, maxval(abs(b)))
        else
            b(1:fine - 1) = no_number
            error = huge(1.0_dp)
        end if
    end subroutine find_polynomial

    !> Both halves of a polynomial, by de Casteljau.
    pure subroutine halve(b, left, right)
        real(dp), intent(in) :: b(0:) !! coefficients
        real(dp), intent(out) :: left(0:), right(0:) !! those over the first and over the second half
        integer :: j, k, n
        n = ubound(b, 1)
        right(:n) = b
        left(0) = b(0)
        do k = 1, n
            do j = 0, n - k
                right(j) = (right(j) + right(j + 1)) / 2
            end do
            left(k) = right(0)
        end do
    end subroutine halve

    !> The value of a polynomial at a place.
    pure real(dp) function value_at(b, u) result(value)
        real(dp), intent(in) :: b(0:), u !! coefficients, and the place
        real(dp) :: power
        integer :: k, n
        n = ubound(b, 1)
        power = 1
        value = b(0)
        do k = 1, n
            power = power * u
            value = value * (1 - u) + power * b(k) / per_binomial(k, n)
        end do
    end function value_at

    !> The place at which a polynomial passes zero that has different signs at the ends.
    pure real(dp) function root_of(b, tolerance) result(u)
        real(dp), intent(in) :: b(0:), tolerance !! coefficients; how well it is to be known
        type(bracket_t) :: bracket
        call bracket%begin(0.0_dp, b(0), 1.0_dp, b(ubound(b, 1)), tolerance)
        do while (.not. bracket%found)
            call bracket%add_value(value_at(b, bracket%trial))
        end do
        u = bracket%trial
    end function root_of

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

end module spintop_bernstein
