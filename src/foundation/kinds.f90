!> Number kinds, constants, exact comparisons and products of vectors: what every module needs.
module spintop_kinds
    use, intrinsic :: iso_fortran_env, only: int64, real64, real128
    implicit none
    private
    public :: dp, xp, qp, pi, pi_xp, degree, epsilon_dp, no_number, is_zero, is_equal, is_finite, cross, skew

    !> Working precision of every public quantity.
    integer, parameter :: dp = real64
    !> Extended precision (80 bits on x86) for phases that grow with time.
    integer, parameter :: xp = selected_real_kind(18)
    !> Quadruple precision, for reference motions.
    integer, parameter :: qp = real128

    real(dp), parameter :: pi = acos(-1.0_dp)
    !> The same in extended precision.
    real(xp), parameter :: pi_xp = 3.14159265358979323846264338327950288_xp
    !> One degree in radians.
    real(dp), parameter :: degree = pi / 180
    !> Spacing of numbers in working precision, relative to 1: 2.2e-16.
    real(dp), parameter :: epsilon_dp = epsilon(1.0_dp)
    !> A quiet NaN: the value of a quantity that does not exist.
    real(dp), parameter :: no_number = transfer(int(z'7FF8000000000000', int64), 1.0_dp)

contains

    !> Whether x is exactly zero (of either sign).
    elemental logical function is_zero(x)
        real(dp), intent(in) :: x !! any number, also infinite or NaN
        is_zero = abs(x) <= 0
    end function is_zero

    !> Whether two numbers are exactly equal.
    elemental logical function is_equal(a, b)
        real(dp), intent(in) :: a, b !! the two numbers
        is_equal = a <= b .and. a >= b
    end function is_equal

    !> Whether x is neither infinite nor a NaN.
    elemental logical function is_finite(x)
        real(dp), intent(in) :: x !! any number, also infinite or NaN
        is_finite = abs(x) <= huge(x)
    end function is_finite

    !> Vector product a x b.
    pure function cross(a, b) result(c)
        real(dp), intent(in) :: a(3), b(3) !! vectors
        real(dp) :: c(3)
        c(1) = a(2) * b(3) - a(3) * b(2)
        c(2) = a(3) * b(1) - a(1) * b(3)
        c(3) = a(1) * b(2) - a(2) * b(1)
    end function cross

    !> The matrix of the vector product: skew(a) b = a x b.
    pure function skew(a) result(matrix)
        real(dp), intent(in) :: a(3) !! vector
        real(dp) :: matrix(3, 3)
        matrix(:, 1) = [0.0_dp, a(3), -a(2)]
        matrix(:, 2) = [-a(3), 0.0_dp, a(1)]
        matrix(:, 3) = [a(2), -a(1), 0.0_dp]
    end function skew

end module spintop_kinds
