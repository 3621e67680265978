!> Circular functions of one reduced angle, and the argument of a complex number, which the exact solution evaluates at every
!> sample: several times faster than the general functions of the run-time library; and circular functions and their inverses for
!> arrays, in loops that the compiler vectorizes.
!>
!> Errors of one angle below 3e-16: relative of `find_sine_and_cosine` and `argument`, absolute of `unit`; of arrays below 4e-16,
!> relative or, where a result passes zero for no zero argument, absolute. Reduction by quadrants after W. J. Cody and W. Waite,
!> Software Manual for the Elementary Functions, 1980; sine and cosine of arrays after S. L. Moshier, Cephes, 1984; inverse
!> functions by polynomials that interpolate at Chebyshev points, weighted for relative error.
module spintop_circular_functions
    use spintop_kinds, only: dp, xp, pi, pi_xp
    implicit none
    private
    public :: find_sine_and_cosine, argument, unit, nearest_whole, find_circular, find_inclinations, find_arguments, largest_angle

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

    !> Largest angle of `find_circular`, rad. Up to this many quadrants, their products with the parts of pi/2
    !> below are exact.
    real(dp), parameter :: largest_angle = 1.0e6_dp

    !> pi/2 in three parts, of which the first two have 33 bits each.
    real(dp), parameter :: quadrant_parts(3) = [1.57079632673412561417e+00_dp, &
        6.07710050630396597660e-11_dp, 2.02226624879595063154e-21_dp]
    !> Adding and subtracting this number rounds to the nearest integer. A compiler cancels the two operations
    !> with -fassociative-math, which in Fortran requires -fno-signed-zeros and -fno-trapping-math together.
    real(dp), parameter :: large_dp = 1.5_dp * 2.0_dp**(digits(1.0_dp) - 1)

    !> (sin(x) - x)/x^3 and (cos(x) - 1 + x^2/2)/x^4 in powers of x^2, |x| <= pi/4.
    real(dp), parameter :: sines(0:5) = [ &
        -1.66666666666666307295e-1_dp, 8.33333333332211858878e-3_dp, &
        -1.98412698295895385996e-4_dp, 2.75573136213857245213e-6_dp, &
        -2.50507477628578072866e-8_dp, 1.58962301576546568060e-10_dp]
    real(dp), parameter :: cosines(0:5) = [ &
        4.16666666666665929218e-2_dp, -1.38888888888730564116e-3_dp, &
        2.48015872888517045348e-5_dp, -2.75573141792967388112e-7_dp, &
        2.08757008419747316778e-9_dp, -1.13585365213876817300e-11_dp]
    !> (asin(x) - x)/x^3 in powers of x^2, x^2 <= 1/2, and (atan(x) - x)/x^3, x^2 <= 1.
    real(dp), parameter :: arcsine_series(0:17) = [ &
        1.666666666666665973e-1_dp, 7.5000000000089830992e-2_dp, 4.4642857123584317665e-2_dp, &
        3.0381946078091729255e-2_dp, 2.237208630080291823e-2_dp, 1.735473074310072254e-2_dp, &
        1.392982304950698164e-2_dp, 1.1985573693236659085e-2_dp, 5.8918391706459316219e-3_dp, &
        3.3824737239370569738e-2_dp, -1.1748189448551343117e-1_dp, 4.6582250545970970697e-1_dp, &
        -1.2587114905041766454_dp, 2.5735641402980041908_dp, -3.7416733040668143429_dp, &
        3.7317131630629642036_dp, -2.2780256277459811242_dp, 6.6295611442812767717e-1_dp]
    real(dp), parameter :: arctangents(0:19) = [ &
        -3.3333333333333330252e-1_dp, 1.9999999999997532204e-1_dp, -1.4285714285384131545e-1_dp, &
        1.1111111093490828096e-1_dp, -9.0909085908919342252e-2_dp, 7.692298971033216917e-2_dp, &
        -6.6665646992891042112e-2_dp, 5.8815068777936560666e-2_dp, -5.257973334284110807e-2_dp, &
        4.7377495795277789723e-2_dp, -4.2603566326016521328e-2_dp, 3.7494868125352471116e-2_dp, &
        -3.127718906699638479e-2_dp, 2.3696731580048622013e-2_dp, -1.5535152475414176125e-2_dp, &
        8.3689311784501621357e-3_dp, -3.49588597391630952e-3_dp, 1.0496035084968515073e-3_dp, &
        -1.9996189377901382062e-4_dp, 1.8061954618612152202e-5_dp]

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

    !> sin(x)^2 and cos(x)^2, each to full relative precision, and sin(2x), |x| <= `largest_angle`.
    pure subroutine find_circular(n, x, sine_squared, cosine_squared, sine_of_double)
        integer, intent(in) :: n !! number of elements
        real(dp), intent(in) :: x(n) !! angles, rad
        real(dp), intent(out) :: sine_squared(n), cosine_squared(n), sine_of_double(n)
            !! sin(x)^2, cos(x)^2 and sin(2 x)
        real(dp) :: quadrants, half, odd, r, r2, sine, cosine
        integer :: i
        !$omp simd private(quadrants, half, odd, r, r2, sine, cosine)
        do i = 1, n
            quadrants = (x(i) * (2 / pi) + large_dp) - large_dp
            r = ((x(i) - quadrants * quadrant_parts(1)) - quadrants * quadrant_parts(2)) &
                - quadrants * quadrant_parts(3)
            r2 = r * r
            sine = r + r * r2 * (sines(0) + r2 * (sines(1) + r2 * (sines(2) &
                + r2 * (sines(3) + r2 * (sines(4) + r2 * sines(5))))))
            cosine = 1 - (r2 / 2 - r2 * r2 * (cosines(0) + r2 * (cosines(1) + r2 &
                * (cosines(2) + r2 * (cosines(3) + r2 * (cosines(4) + r2 &
                * cosines(5)))))))
            ! 1 for odd quadrants, which exchange sine and cosine, else 0.
            half = quadrants / 2
            odd = 2 * abs(half - ((half + large_dp) - large_dp))
            sine_squared(i) = merge(cosine * cosine, sine * sine, odd > 0)
            cosine_squared(i) = merge(sine * sine, cosine * cosine, odd > 0)
            sine_of_double(i) = 2 * (1 - 2 * odd) * (sine * cosine)
        end do
    end subroutine find_circular

    !> Inclinations in [0, pi] from their sines (>= 0) and cosines, rad.
    pure subroutine find_inclinations(n, sine, cosine, angle)
        integer, intent(in) :: n !! number of elements
        real(dp), intent(in) :: sine(n), cosine(n) !! sines and cosines of the angles
        real(dp), intent(out) :: angle(n) !! results, rad
        real(dp) :: x, t, t2, even, odd, a
        integer :: i, k
        !$omp simd private(x, t, t2, even, odd, a, k)
        do i = 1, n
            x = min(sine(i), abs(cosine(i)))
            t = x * x
            t2 = t * t
            even = 0
            odd = 0
            do k = 16, 0, -2
                even = arcsine_series(k) + t2 * even
                odd = arcsine_series(k + 1) + t2 * odd
            end do
            a = x + x * t * (even + t * odd)
            a = merge(a, pi / 2 - a, sine(i) <= abs(cosine(i)))
            angle(i) = merge(pi - a, a, cosine(i) < 0)
        end do
    end subroutine find_inclinations

    !> Arguments in [-pi/2, pi/2] of re + i im with re >= 0, rad; NaN for 0.
    pure subroutine find_arguments(n, re, im, angle)
        integer, intent(in) :: n !! number of elements
        real(dp), intent(in) :: re(n), im(n) !! real and imaginary parts
        real(dp), intent(out) :: angle(n) !! results, rad
        real(dp) :: x, t, t2, even, odd, a
        integer :: i, k
        !$omp simd private(x, t, t2, even, odd, a, k)
        do i = 1, n
            x = min(re(i), abs(im(i))) / max(re(i), abs(im(i)))
            t = x * x
            t2 = t * t
            even = 0
            odd = 0
            do k = 18, 0, -2
                even = arctangents(k) + t2 * even
                odd = arctangents(k + 1) + t2 * odd
            end do
            a = x + x * t * (even + t * odd)
            angle(i) = sign(merge(a, pi / 2 - a, abs(im(i)) <= re(i)), im(i))
        end do
    end subroutine find_arguments

end module spintop_circular_functions
