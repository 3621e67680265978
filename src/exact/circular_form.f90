!> The exact solution in circular functions, for k^2 <= 1/2: all motions except those that stay near the
!> upright for a long time. `closed_form.h` has the theory and the constants, which tops in lanes share.
module spintop_circular_form
    use, intrinsic :: iso_c_binding, only: c_double
    use spintop_kinds, only: dp
    use spintop_theta_functions, only: theta_clock_t, theta_values_t
    use spintop_circular_functions, only: find_sine_and_cosine
    use spintop_turning_points, only: cubic_t, roots_t
    implicit none
    private
    public :: circular_form_t, prepare_circular_form, evaluate_circular_form

    !> Highest multiple of 2z in the series; the next term is at most 4e-17.
    integer, parameter :: last = 3

    !> Rows of the table of coefficients, polynomials in cos 2z, which are evaluated together. Their number
    !> fills vector registers.
    integer, parameter :: upper_even = 1, upper_odd = 2, lower_even = 3, lower_odd = 4, &
        upper_even_slope = 5, upper_odd_slope = 6, lower_even_slope = 7, lower_odd_slope = 8, &
        sn = 9, cn = 10, divisor = 11, divisor_slope = 12, rows = 16

    !> The theta functions of one motion.
    type, bind(C) :: circular_form_t
        !> U = upper_least - [sin(z)^2 upper_even + i sin(2z) upper_odd] and L = lower_least - [cos(z)^2
        !> lower_even + i sin(2z) lower_odd], relative to their minima at z = 0 and at |z| = pi/2. The minima
        !> may be zero, so that no digit is lost close to a pole.
        real(c_double) :: upper_least = 1, lower_least = 1
        !> Coefficients of the polynomials; the rest is W = theta_4 = divisor, sn W = sin(z) sn and
        !> cn W = cos(z) cn.
        real(c_double) :: powers(rows, 0:last) = 0
    end type circular_form_t

    interface
        !> Prepares clock and series of a motion with k^2 <= 1/2.
        pure subroutine prepare_circular_form(cubic, roots, clock, form) bind(C, name='spintop_prepare_circular')
            import :: circular_form_t, cubic_t, roots_t, theta_clock_t
            type(cubic_t), intent(in) :: cubic !! the cubic of the motion
            type(roots_t), intent(in) :: roots !! its roots
            type(theta_clock_t), intent(out) :: clock !! growth of argument and phases with time
            type(circular_form_t), intent(out) :: form !! the theta functions of the motion
        end subroutine prepare_circular_form
    end interface

contains

    !> The theta functions at the argument z, |z| <= pi/2.
    pure subroutine evaluate_circular_form(form, z, from_top, theta)
        type(circular_form_t), intent(in) :: form !! the theta functions
        real(dp), intent(in) :: z, from_top  !! from_top: pi/2 - |z|, to full relative precision
        type(theta_values_t), intent(out) :: theta !! values of the theta functions
        real(dp) :: values(rows), sine, cosine, sine_2z, cosine_2z, near, far

        call find_sine_and_cosine(min(abs(z), from_top), near, far)
        sine = sign(merge(near, far, abs(z) <= from_top), z)
        cosine = merge(far, near, abs(z) <= from_top)
        cosine_2z = (cosine - sine) * (cosine + sine)
        sine_2z = 2 * sine * cosine
        values = form%powers(:, 0) + cosine_2z * (form%powers(:, 1) &
            + cosine_2z * (form%powers(:, 2) + cosine_2z * form%powers(:, 3)))

        theta%upper = cmplx(form%upper_least - sine**2 * values(upper_even), &
                            -sine_2z * values(upper_odd), dp)
        theta%lower = cmplx(form%lower_least - cosine**2 * values(lower_even), &
                            -sine_2z * values(lower_odd), dp)
        theta%upper_slope = -cmplx(sine_2z * values(upper_even_slope), values(upper_odd_slope), dp)
        theta%lower_slope = -cmplx(sine_2z * values(lower_even_slope), values(lower_odd_slope), dp)
        theta%divisor = values(divisor)
        theta%divisor_slope = -sine_2z * values(divisor_slope)
        theta%sn = sine * values(sn) / theta%divisor
        theta%cn = cosine * values(cn) / theta%divisor
    end subroutine evaluate_circular_form

end module spintop_circular_form
