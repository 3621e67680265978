!> What the two forms of the exact motion (circular and hyperbolic) have in common.
!>
!> Both write the Cayley-Klein components as a steady turn times a ratio of theta functions of an
!> argument z that grows evenly with time,
!>
!>     upper = amplitude exp(i phase) U(z)/W(z),    phase = constant + rate t
!>
!> (lower alike), and u = u1 + (u2-u1) sn^2. They differ in the series for U, L, W: one form in
!> circular functions of z, for k^2 <= 1/2, one in hyperbolic functions, for k^2 > 1/2.
module spintop_theta_form
    use spintop_kinds, only: dp, xp
    implicit none
    private
    public :: theta_clock_t, theta_values_t

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

end module spintop_theta_form
