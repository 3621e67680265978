!> Theta functions of the exact motion: what its two forms (circular and hyperbolic) have in common.
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
    use spintop_kinds, only: dp, xp
    implicit none
    private
    public :: theta_clock_t, theta_values_t, nome, theta3_constant, quotient

    !> How argument and phases advance in time: all that must not lose digits over long spans.
    type :: theta_clock_t
        !> z at the start; dz/dt, rad/s.
        real(xp) :: start = 0, rate = 0
        !> Growth of z in one nutation (0: never repeats), its half and its inverse.
        real(xp) :: period = 0, half_period = 0, per_period = 0
        !> Rates of the phases of upper and lower less +-(omega3 - a)/2, and the sum of the two,
        !> the mean precession rate between poles, rad/s.
        real(xp) :: upper_rate = 0, lower_rate = 0, sum_rate = 0
        !> What a whole nutation adds to the phases besides, rad.
        real(xp) :: upper_step = 0, lower_step = 0
        !> Factors of U/W and L/W.
        real(dp) :: upper_amplitude = 1, lower_amplitude = 0
    end type theta_clock_t

    !> The theta functions at one argument. No initial values: it is filled for every sample.
    type :: theta_values_t
        !> U and L, and their derivatives with respect to z.
        complex(dp) :: upper, lower, upper_slope, lower_slope
        !> W and its derivative.
        real(dp) :: divisor, divisor_slope
        !> Jacobi's elliptic functions.
        real(dp) :: sn, cn
    end type theta_values_t

    !> Coefficients of the nome's series in the fourth power of its leading term: enough for
    !> extended precision up to k^2 = 1/2.
    real(xp), parameter :: nome_coefficients(0:5) = [real(xp) :: 1, 2, 15, 150, 1707, 20910]

contains

    !> Nome q = exp(-pi K'/K) from k^2 <= 1/2 and the complementary modulus k'.
    elemental real(xp) function nome(k_squared, complement) result(q)
        real(xp), intent(in) :: k_squared, complement
        real(xp) :: leading, t
        integer :: n
        leading = k_squared / (2 * (1 + complement) * (1 + sqrt(complement))**2)
        t = leading**4
        q = 0
        do n = ubound(nome_coefficients, 1), 0, -1
            q = nome_coefficients(n) + q * t
        end do
        q = leading * q
    end function nome

    !> The constant theta_3(q) = 1 + 2 q + 2 q^4 + 2 q^9 + ...
    elemental real(xp) function theta3_constant(q)
        real(xp), intent(in) :: q
        theta3_constant = 1 + 2 * (q + q**4 + q**9)
    end function theta3_constant

    !> a/b, where 0/0 is 0: the limits of the exact motion at rest, on a pole and without gravity.
    elemental real(xp) function quotient(a, b)
        real(xp), intent(in) :: a, b
        quotient = 0
        if (abs(a) > 0) quotient = a / b
    end function quotient

end module spintop_theta_functions
