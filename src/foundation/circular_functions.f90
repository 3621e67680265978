!> Circular functions of one reduced angle, and the argument of a complex number, which the exact solution evaluates at every
!> sample: several times faster than the general functions of the run-time library.
!>
!> Errors below 3e-16: relative of `find_sine_and_cosine` and `argument`, absolute of `unit`. Reduction by quadrants after
!> W. J. Cody and W. Waite, Software Manual for the Elementary Functions, 1980; the arctangent by a polynomial that interpolates at
!> Chebyshev points, weighted for relative error.
module spintop_circular_functions
    use spintop_kinds, only: dp, xp, pi, pi_xp
    implicit none
    private
    public :: find_sine_and_cosine, argument, unit, nearest_whole

    !> (sin(x) - x)/x^3 and (cos(x) - 1 + x^2/2)/x^4 in powers of x^2: Taylor series, complete to
    !> 1e-18 for |x| <= pi/4.
    real(dp), parameter :: sine_series(0:7) = [real(dp) :: &
        -1 / 6.0_dp, 1 / 120.0_dp, -1 / 5040.0_dp, 1 / 362880.0_dp, -1 / 39916800.0_dp, &
        1 / 6227020800.0_dp, -1 / 1307674368000.0_dp, 1 / 355687428096000.0_dp]
    real(dp), parameter :: cosine_series(0:6) = [real(dp) :: &
        1 / 24.0_dp, -1 / 720.0_dp, 1 / 40320.0_dp, -1 / 3628800.0_dp, 1 / 479001600.0_dp, &
        -1 / 87178291200.0_dp, 1 / 20922789888000.0_dp]

    !> (atan(x) - x)/x^3 in powers of x^2, interpolated at Chebyshev points for |x| <= tan(pi/8).
    real(dp), parameter :: arctangent_series(0:10) = [ &
        -3.3333333333333330156e-1_dp, 1.9999999999995516545e-1_dp, -1.4285714284665684761e-1_dp, &
        1.1111111015187018721e-1_dp, -9.0909045753064890845e-2_dp, 7.6921831253768920895e-2_dp, &
        -6.6645105255089365988e-2_dp, 5.8581409048663282818e-2_dp, -5.0854078345894842573e-2_dp, &
        3.9230447784793095235e-2_dp, -1.9175404711104933678e-2_dp]

    !> tan(pi/8)
    real(dp), parameter :: tangent_of_eighth = sqrt(2.0_dp) - 1

    !> Bound of the remainder of the reduction by quadrants, a little above pi/4. It matters only for phases so
    !> large that no digit of the remainder is correct.
    real(dp), parameter :: largest_remainder = 0.79_dp

contains

    !> sin(x) and cos(x) for |x| <= pi/4.
    pure subroutine find_sine_and_cosine(x, sine, cosine)
        real(dp), intent(in) :: x !! angle, rad, |x| <= pi/4
        real(dp), intent(out) :: sine, cosine !! sin(x) and cos(x)
        real(dp) :: s, s2
        s = x * x
        s2 = s * s
        ! The terms are summed in pairs, which the processor evaluates in parallel.
        associate (a => sine_series, c => cosine_series)
            sine = x + x * s * ((a(0) + s * a(1)) + s2 * ((a(2) + s * a(3)) &
                + s2 * ((a(4) + s * a(5)) + s2 * (a(6) + s * a(7)))))
            cosine = 1 - (s / 2 - s2 * ((c(0) + s * c(1)) + s2 * ((c(2) + s * c(3)) &
                + s2 * ((c(4) + s * c(5)) + s2 * c(6)))))
        end associate
    end subroutine find_sine_and_cosine

    !> exp(i phase), the phase first reduced by quadrants.
    pure complex(dp) function unit(phase)
        real(xp), intent(in) :: phase !! the angle, rad
        real(xp) :: quadrants
        real(dp) :: remainder, sine, cosine, turned

        quadrants = nearest_whole(phase * (2 / pi_xp))
        remainder = real(phase - quadrants * (pi_xp / 2), dp)
        remainder = max(-largest_remainder, min(largest_remainder, remainder))
        call find_sine_and_cosine(remainder, sine, cosine)
        ! For -2 to 2 quadrants, 1 - |turned| and turned (2 - |turned|) are cosine and sine.
        turned = real(quadrants - 4 * nearest_whole(quadrants / 4), dp)
        unit = cmplx(1 - abs(turned), turned * (2 - abs(turned)), dp) * cmplx(cosine, sine, dp)
    end function unit

    !> The angle of a complex number, rad; 0 of zero.
    pure real(dp) function argument(z) result(angle)
        complex(dp), intent(in) :: z !! a complex number
        real(dp) :: x, y, least, most, slope, s, s2, s4
        logical :: is_steep

        x = abs(real(z, dp))
        y = abs(aimag(z))
        least = min(x, y)
        most = max(x, y, tiny(x))
        ! Above 22.5 degrees, the complement to 45 degrees is used.
        is_steep = least > tangent_of_eighth * most
        slope = merge(least - most, least, is_steep) / merge(least + most, most, is_steep)
        s = slope * slope
        s2 = s * s
        s4 = s2 * s2
        associate (a => arctangent_series)
            angle = merge(pi / 4, 0.0_dp, is_steep) + (slope + slope * s &
                * (((a(0) + s * a(1)) + s2 * (a(2) + s * a(3))) &
                   + s4 * (((a(4) + s * a(5)) + s2 * (a(6) + s * a(7))) &
                           + s4 * ((a(8) + s * a(9)) + s2 * a(10)))))
        end associate
        angle = merge(pi / 2 - angle, angle, y > x)
        angle = sign(merge(pi - angle, angle, real(z, dp) < 0), aimag(z))
    end function argument

    !> Nearest integer, by adding and subtracting a large number: several times faster than `anint`, a library call for this
    !> kind, which is used for larger numbers only.
    pure real(xp) function nearest_whole(x)
        real(xp), intent(in) :: x !! the number to round
        real(xp), parameter :: large = 1.5_xp * 2.0_xp**(digits(1.0_xp) - 1), too_large = large / 3
        if (abs(x) < too_large) then
            nearest_whole = (x + large) - large
        else
            nearest_whole = anint(x)
        end if
    end function nearest_whole

end module spintop_circular_functions
