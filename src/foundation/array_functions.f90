!> Circular functions and their inverses for arrays, in loops that the compiler vectorizes. The run-time
!> library of the compiler has scalar versions only.
!>
!> Errors below 4e-16, relative or, where a result passes zero for no zero argument, absolute.
!> Reduction by quadrants after W. J. Cody and W. Waite, Software Manual for the Elementary
!> Functions, 1980; sine and cosine after S. L. Moshier, Cephes, 1984; inverse functions by
!> polynomials that interpolate at Chebyshev points, weighted for relative error.
module spintop_array_functions
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: find_circular, find_inclinations, find_arguments, largest_angle

    !> Largest angle of `find_circular`, rad. Up to this many quadrants, their products with the parts of pi/2
    !> below are exact.
    real(dp), parameter :: largest_angle = 1.0e6_dp

    !> pi/2 in three parts, of which the first two have 33 bits each.
    real(dp), parameter :: quadrant_parts(3) = [1.57079632673412561417e+00_dp, &
        6.07710050630396597660e-11_dp, 2.02226624879595063154e-21_dp]
    !> Adding and subtracting this number rounds to the nearest integer. A compiler cancels the two operations
    !> with -fassociative-math, which in Fortran requires -fno-signed-zeros and -fno-trapping-math together.
    real(dp), parameter :: large = 1.5_dp * 2.0_dp**(digits(1.0_dp) - 1)

    !> (sin(x) - x)/x^3 and (cos(x) - 1 + x^2/2)/x^4 in powers of x^2, |x| <= pi/4.
    real(dp), parameter :: sine_series(0:5) = [ &
        -1.66666666666666307295e-1_dp, 8.33333333332211858878e-3_dp, &
        -1.98412698295895385996e-4_dp, 2.75573136213857245213e-6_dp, &
        -2.50507477628578072866e-8_dp, 1.58962301576546568060e-10_dp]
    real(dp), parameter :: cosine_series(0:5) = [ &
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
    real(dp), parameter :: arctangent_series(0:19) = [ &
        -3.3333333333333330252e-1_dp, 1.9999999999997532204e-1_dp, -1.4285714285384131545e-1_dp, &
        1.1111111093490828096e-1_dp, -9.0909085908919342252e-2_dp, 7.692298971033216917e-2_dp, &
        -6.6665646992891042112e-2_dp, 5.8815068777936560666e-2_dp, -5.257973334284110807e-2_dp, &
        4.7377495795277789723e-2_dp, -4.2603566326016521328e-2_dp, 3.7494868125352471116e-2_dp, &
        -3.127718906699638479e-2_dp, 2.3696731580048622013e-2_dp, -1.5535152475414176125e-2_dp, &
        8.3689311784501621357e-3_dp, -3.49588597391630952e-3_dp, 1.0496035084968515073e-3_dp, &
        -1.9996189377901382062e-4_dp, 1.8061954618612152202e-5_dp]

contains

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
            quadrants = (x(i) * (2 / pi) + large) - large
            r = ((x(i) - quadrants * quadrant_parts(1)) - quadrants * quadrant_parts(2)) &
                - quadrants * quadrant_parts(3)
            r2 = r * r
            sine = r + r * r2 * (sine_series(0) + r2 * (sine_series(1) + r2 * (sine_series(2) &
                + r2 * (sine_series(3) + r2 * (sine_series(4) + r2 * sine_series(5))))))
            cosine = 1 - (r2 / 2 - r2 * r2 * (cosine_series(0) + r2 * (cosine_series(1) + r2 &
                * (cosine_series(2) + r2 * (cosine_series(3) + r2 * (cosine_series(4) + r2 &
                * cosine_series(5)))))))
            ! 1 for odd quadrants, which exchange sine and cosine, else 0.
            half = quadrants / 2
            odd = 2 * abs(half - ((half + large) - large))
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
                even = arctangent_series(k) + t2 * even
                odd = arctangent_series(k + 1) + t2 * odd
            end do
            a = x + x * t * (even + t * odd)
            angle(i) = sign(merge(a, pi / 2 - a, abs(im(i)) <= re(i)), im(i))
        end do
    end subroutine find_arguments

end module spintop_array_functions
