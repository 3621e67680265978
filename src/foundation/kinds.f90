!> Number kinds, and constants that every module needs.
module spintop_kinds
    use, intrinsic :: iso_fortran_env, only: int64, real64, real128
    implicit none
    private
    public :: dp, xp, qp, pi, pi_xp, degree, epsilon_dp, no_number

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

end module spintop_kinds
