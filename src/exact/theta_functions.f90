!> Theta functions of the exact solution: the part that its two forms (circular and hyperbolic) share.
!>
!> Both write the Cayley-Klein components as a steady rotation times a ratio of theta functions of an
!> argument z that grows uniformly with time,
!>
!>     upper = amplitude exp(i phase) U(z)/W(z),    phase = constant + rate t
!>
!> (lower alike), and u = u1 + (u2-u1) sn^2. They differ in the series for U, L, W: one form in
!> circular functions of z, for k^2 <= 1/2, one in hyperbolic functions, for k^2 > 1/2, of the
!> complementary modulus. So every nome is at most exp(-pi) = 0.0433, and a few terms of a series suffice
!> for extended precision.
!> Source: Whittaker and Watson, A Course of Modern Analysis, chapters XXI and XXII.
module spintop_theta_functions
    use, intrinsic :: iso_c_binding, only: c_double, c_long_double
    use spintop_kinds, only: dp, xp
    implicit none
    private
    public :: theta_clock_t, theta_values_t, nome, theta3_constant, series_b, inverse_sc, quotient
    public :: linear_chain

    !> Growth of argument and phases with time: the quantities that must not lose digits over long spans.
    type, bind(C) :: theta_clock_t
        !> z at the start; dz/dt, rad/s.
        real(c_long_double) :: start = 0, rate = 0
        !> Growth of z in one nutation (0: never repeats), its half and its inverse.
        real(c_long_double) :: period = 0, half_period = 0, per_period = 0
        !> Rates of the phases of upper and lower without +-(omega3 - a)/2, and their sum, the mean precession
        !> rate between poles, rad/s.
        real(c_long_double) :: upper_rate = 0, lower_rate = 0, sum_rate = 0
        !> Additional change of the phases per nutation, rad.
        real(c_long_double) :: upper_step = 0, lower_step = 0
        !> Factors of U/W and L/W.
        real(c_double) :: upper_amplitude = 1, lower_amplitude = 0
    end type theta_clock_t

    !> The theta functions at one argument. Without initial values, because it is filled for every sample.
    type :: theta_values_t
        !> U and L, and their derivatives with respect to z.
        complex(dp) :: upper, lower, upper_slope, lower_slope
        !> W and its derivative.
        real(dp) :: divisor, divisor_slope
        !> Jacobi's elliptic functions.
        real(dp) :: sn, cn
    end type theta_values_t

    interface
        !> Nome q = exp(-pi K'/K) from k^2 <= 0.971 and the complementary modulus k' = sqrt(1 - k^2).
        pure real(c_long_double) function nome(k_squared, complement) bind(C, name='spintop_nome')
            import :: c_long_double
            real(c_long_double), value :: k_squared, complement
        end function nome
    end interface

contains

    !> x_0 to x_last of x_(n+1) = x x_n - q^2 x_(n-1): sums W^n + V^n and the like, W + V = x and W V = q^2.
    pure function linear_chain(x, q, first, second, last) result(chain)
        real(xp), intent(in) :: x, q !! the sum, and the root of the product
        real(xp), intent(in) :: first, second !! x_0 and x_1
        integer, intent(in) :: last !! index of the last one
        real(xp) :: chain(0:last)
        integer :: n
        chain(0) = first
        chain(1) = second
        do n = 1, last - 1
            chain(n + 1) = x * chain(n) - q**2 * chain(n - 1)
        end do
    end function linear_chain

    !> The constant theta_3(q) = 1 + 2 sum q^(n^2).
    elemental real(xp) function theta3_constant(q)
        real(xp), intent(in) :: q !! nome
        theta3_constant = 1 + 2 * (q + q**4 + q**9 + q**16 + q**25)
    end function theta3_constant

    !> B = 1 + sum (-1)^n q^(n(n+1)) B_n(c), B_n = sin((2n+1)v)/sin(v), c = cos(2v).
    elemental real(xp) function series_b(q, c)
        real(xp), intent(in) :: q !! nome
        real(xp), intent(in) :: c !! cos(2v), or cosh(2z) with v = i z
        real(xp) :: b1, b2
        b1 = 2 * c + 1
        b2 = 2 * c * b1 - 1
        series_b = 1 - q**2 * (b1 - q**4 * (b2 - q**6 * (2 * c * b2 - b1)))
    end function series_b

    !> The argument z <= H/2 at which sn/cn = `target`, by Newton's method in s = sinh(z):
    !> s B(c) theta_3 = target C(0) theta_4(c) with c = cosh(2z) = 1 + 2 s^2.
    pure real(xp) function inverse_sc(q, target) result(z)
        real(xp), intent(in) :: q !! nome q' of the complementary modulus, 0 on the separatrix
        real(xp), intent(in) :: target !! sn/cn, at most that at half of the quarter period
        integer, parameter :: most_iterations = 60
        real(xp) :: s, c, scaled, root, theta4, theta4_slope, b, b_slope, step
        integer :: n

        scaled = target * (1 + q**2 + q**6 + q**12) / theta3_constant(q)
        ! sinh(H/2) = (q^(-1/4) - q^(1/4))/2 bounds the result.
        s = target
        root = sqrt(sqrt(q))
        if (2 * s * root > 1 - root**2) s = (1 - root**2) / (2 * root)
        do n = 1, most_iterations
            c = 1 + 2 * s**2
            theta4 = 1 - 2 * (q * c - q**4 * (2 * c**2 - 1) + q**9 * c * (4 * c**2 - 3))
            theta4_slope = -2 * (q - q**4 * 4 * c + q**9 * (12 * c**2 - 3))
            b = series_b(q, c)
            b_slope = -2 * q**2 * (1 - q**4 * (4 * c + 1))
            step = -(s * b - scaled * theta4) / (b + 4 * s * (s * b_slope - scaled * theta4_slope))
            s = s + step
            if (abs(step) <= 2 * epsilon(s) * abs(s)) exit
        end do
        z = asinh(s)
    end function inverse_sc

    !> a/b, with 0/0 = 0: the limits of the exact solution at rest, at a pole and without gravity.
    elemental real(xp) function quotient(a, b)
        real(xp), intent(in) :: a, b !! the two numbers
        quotient = 0
        if (abs(a) > 0) quotient = a / b
    end function quotient

end module spintop_theta_functions
