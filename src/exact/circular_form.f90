!> The exact motion in circular functions, for k^2 <= 1/2: all but motions that linger near the
!> upright.
!>
!> Jacobi's theta functions of nome q = exp(-pi K'/K) <= 0.0433. Where textbooks place the poles
!> by incomplete elliptic integrals, here X = 2 q cosh(2 v) of their position i v follows from a
!> quadratic-like equation in the data, which keeps its digits also where the axis passes a pole.
!> Whittaker and Watson, A Course of Modern Analysis, chapter XXI; Klein and Sommerfeld, chapter VI.
module spintop_circular_form
    use spintop_kinds, only: dp, xp
    use spintop_elliptic_series, only: nome, theta3_constant, quotient, pi_xp
    use spintop_regular_start, only: regular_start_t
    use spintop_turning_points, only: turning_points_t
    use spintop_theta_form, only: theta_clock_t, theta_values_t
    implicit none
    private
    public :: circular_form_t, prepare_circular_form, evaluate_circular_form

    !> Highest multiple of 2z in the series: the next adds at most 4e-17.
    integer, parameter :: last = 3

    !> Coefficients of the theta functions of one motion.
    type :: circular_form_t
        private
        !> U = upper_least - sum [2 upper_even(n) sin(nz)^2 + i upper_odd(n) sin 2nz] and
        !> L = lower_least - sum [2 lower_even(n) sin(ny)^2 + i lower_odd(n) sin 2nz], where
        !> y = pi/2 - |z|: counted from their least values, at z = 0 and at y = 0, which may be
        !> zero, so that no digit is lost close to a pole.
        real(dp) :: upper_least = 1, lower_least = 1
        real(dp), dimension(last) :: upper_even = 0, upper_odd = 0, lower_even = 0, lower_odd = 0
        !> W = theta_4 = 1 + sum divisor(n) cos 2nz.
        real(dp) :: divisor(last) = 0
        !> sn = sum_n sn(n) sin (2n+1)z / W,  cn = sum_n cn(n) cos (2n+1)z / W.
        real(dp) :: sn(0:last) = [real(dp) :: 1, 0, 0, 0], cn(0:last) = [real(dp) :: 1, 0, 0, 0]
    end type circular_form_t

    !> Where a pole of the sphere lies in the argument, from X = 2 q cosh(2 v):
    !> w = q exp(2 v) and q^2/w = q exp(-2 v).
    type :: pole_t
        real(xp) :: sums(last + 1) = 0         !! w^n + (q^2/w)^n
        real(xp) :: differences(last + 1) = 0  !! w^n - (q^2/w)^n
        real(xp) :: norm = 1                   !! the pole's theta function at u = u2 (u1)
        real(xp) :: slope = 0                  !! its logarithmic derivative there
    end type pole_t

    integer, parameter :: n_(last + 1) = [1, 2, 3, 4]
    integer, parameter :: alternating(last + 1) = [-1, 1, -1, 1]

contains

    !> Sets up clock and series of a motion with k^2 <= 1/2.
    pure subroutine prepare_circular_form(start, points, clock, form)
        type(regular_start_t), intent(in) :: start
        type(turning_points_t), intent(in) :: points
        type(theta_clock_t), intent(out) :: clock
        type(circular_form_t), intent(out) :: form
        type(pole_t) :: bottom, top
        real(xp) :: q, theta3, theta4, theta2, upper_sign, lower_sign, power, x
        integer :: n

        associate (k2 => points%k_squared, kc => points%complement, d => points%u2_minus_u1, &
                   m1 => points%one_minus_u1, d2 => points%one_minus_u2, &
                   p1 => points%one_plus_u1, p2 => points%one_plus_u2, &
                   beta_u => points%beta_u3_minus_u1, beta_d3 => points%beta_u3_minus_1)
            q = nome(k2, kc)
            theta3 = theta3_constant(q)
            theta4 = sqrt(kc) * theta3
            clock%rate = points%frequency / theta3**2
            clock%period = pi_xp
            clock%half_period = pi_xp / 2
            clock%per_period = 1 / pi_xp

            ! The poles theta = pi, below the motion, and theta = 0, above it.
            x = solve_position(q, quotient(d + p1 * k2 / (1 + kc), &
                                           (sqrt(p2) + sqrt(p1 * kc))**2))
            bottom = pole_at(q, x, sqrt(kc) * sqrt(quotient(beta_u, points%beta_u3_plus_1)))
            x = solve_position(q, quotient(d * beta_d3 / beta_u + kc * d, &
                                           (1 + kc) * (sqrt(m1 * kc) + sqrt(d2))**2))
            top = pole_at(q, x, sqrt(kc) * sqrt(quotient(beta_d3, &
                                                         points%complement_squared * beta_u)))

            upper_sign = sign(1.0_xp, start%b_plus_a)
            lower_sign = sign(1.0_xp, start%b_minus_a)
            clock%upper_rate = quotient(start%b_plus_a, 2 * p2) &
                               + upper_sign * clock%rate * bottom%slope
            clock%lower_rate = quotient(start%b_minus_a, 2 * m1) &
                               + lower_sign * clock%rate * top%slope
            clock%sum_rate = clock%upper_rate + clock%lower_rate
            ! A fast top precesses slowly: the two rates nearly cancel.
            if (d2 > m1 / 4) clock%sum_rate = (start%turn - start%a * points%y2) / (p2 * d2) &
                + clock%rate * (upper_sign * bottom%slope - lower_sign * slope_at_top(q, top))

            clock%upper_amplitude = real(sqrt(p2 / 2) * theta3 / bottom%norm, dp)
            clock%lower_amplitude = real(sqrt(m1 / 2) * theta4 / top%norm, dp)
            form%upper_least = real(sqrt(quotient(p1 * kc, p2)) * bottom%norm, dp)
            form%lower_least = real(quotient(sqrt(d2) * top%norm, sqrt(m1 * kc)), dp)
            clock%start = start_argument(start, points, q)
        end associate

        theta2 = 1 + q**2 + q**6 + q**12
        do n = 1, last
            power = alternating(n) * q**(n * n - n)
            form%upper_even(n) = real(power * bottom%sums(n), dp)
            form%upper_odd(n) = real(power * upper_sign * bottom%differences(n), dp)
            form%lower_even(n) = real(power * top%sums(n), dp)
            form%lower_odd(n) = real(alternating(n) * power * lower_sign * top%differences(n), dp)
            form%divisor(n) = real(2 * alternating(n) * q**(n * n), dp)
        end do
        do n = 0, last
            form%cn(n) = real(q**(n * (n + 1)) * theta4 / theta2, dp)
            form%sn(n) = real((-1)**n * q**(n * (n + 1)) * theta3 / theta2, dp)
        end do
    end subroutine prepare_circular_form

    !> z at the start: 0 at the lower turning point u1, pi/2 at the upper one, negative on the way
    !> down.
    pure real(xp) function start_argument(start, points, q) result(z)
        type(regular_start_t), intent(in) :: start
        type(turning_points_t), intent(in) :: points
        real(xp), intent(in) :: q
        real(xp) :: sn2, dn, x, kc

        if (.not. points%y1 < 0) then
            z = 0
        else if (.not. points%y2 > 0) then
            z = pi_xp / 2
        else
            kc = points%complement
            sn2 = -points%y1 / points%u2_minus_u1
            dn = sqrt(1 - points%k_squared * sn2)
            ! The same equation as for the poles, with X = 2 q cos(2 z).
            x = solve_position(q, points%k_squared * (1 / (1 + kc) - sn2) / (dn + sqrt(kc))**2)
            z = atan(sqrt(kc) * sqrt(-points%y1 / points%y2) * ratio_of_thetas(q, x))
        end if
        if (start%u_rate < 0) z = -z
    end function start_argument

    !> Solves sum_{n odd} q^(n^2-n) h_n = excess (1 + sum_{n even} q^(n^2-n) h_n) for X = h_1,
    !> with h_n = 2 q^n cosh(2 n v), by Newton's method.
    pure real(xp) function solve_position(q, excess) result(x)
        real(xp), intent(in) :: q, excess
        integer, parameter :: most_iterations = 30
        real(xp) :: q2, q6, q12, odd, even, odd_slope, even_slope, step
        real(xp) :: scale, r
        integer :: n

        q2 = q**2
        q6 = q2**3
        q12 = q6**2
        ! The quadratic X - excess (1 - 2 q^4 + q^2 X^2) = 0 by its series.
        scale = max(1 - 2 * q2**2, 0.2_xp)
        r = min(excess**2 * q2 * scale, 0.2_xp)
        x = excess * scale * (1 + r * (1 + r * (2 + r * (5 + r * (14 + r * 42)))))
        do n = 1, most_iterations
            odd = x * (1 + q6 * (x**2 - 3 * q2))
            even = 1 + q2 * (x**2 - 2 * q2) + q12 * (x**4 - 4 * q2 * x**2 + 2 * q2**2)
            odd_slope = 1 + q6 * 3 * (x**2 - q2)
            even_slope = x * (2 * q2 + q12 * 4 * (x**2 - 2 * q2))
            step = -(odd - excess * even) / (odd_slope - excess * even_slope)
            x = x + step
            if (abs(step) <= 8 * epsilon(x) * abs(x)) exit
        end do
    end function solve_position

    !> A/B with A = 1 + sum q^(n^2) a_n and B = 1 + sum (-1)^n q^(n^2) b_n, the theta functions
    !> that carry sn/cn at the position X.
    pure real(xp) function ratio_of_thetas(q, x) result(ratio)
        real(xp), intent(in) :: q, x
        real(xp) :: a(0:last + 1), b(0:last + 1), numerator, denominator
        integer :: n
        a(0:1) = [1.0_xp, x - q]
        b(0:1) = [1.0_xp, x + q]
        do n = 1, last
            a(n + 1) = x * a(n) - q**2 * a(n - 1)
            b(n + 1) = x * b(n) - q**2 * b(n - 1)
        end do
        numerator = 1
        denominator = 1
        do n = 1, last + 1
            numerator = numerator + q**(n * n) * a(n)
            denominator = denominator + (-1)**n * q**(n * n) * b(n)
        end do
        ratio = numerator / denominator
    end function ratio_of_thetas

    !> A pole from its position X; `scale` is sqrt(k') times the pole's sc(i v) without its i.
    pure type(pole_t) function pole_at(q, x, scale) result(pole)
        real(xp), intent(in) :: q, x, scale
        real(xp) :: difference, w
        integer :: n

        ! Not sqrt(X^2 - 4 q^2): that loses half the digits near v = 0.
        difference = (x + 2 * q) * scale * ratio_of_thetas(q, x)
        w = (x + difference) / 2
        pole%sums(1) = w + quotient(q**2, w)
        pole%differences(1) = difference
        pole%sums(2) = x * pole%sums(1) - 2 * q**2
        pole%differences(2) = x * difference
        do n = 3, last + 1
            pole%sums(n) = x * pole%sums(n - 1) - q**2 * pole%sums(n - 2)
            pole%differences(n) = x * pole%differences(n - 1) - q**2 * pole%differences(n - 2)
        end do
        pole%norm = 1 + sum(q**(n_ * n_ - n_) * pole%sums)
        pole%slope = 2 * sum(n_ * q**(n_ * n_ - n_) * pole%differences) / pole%norm
    end function pole_at

    !> The logarithmic derivative of the upper pole's theta function at u2 instead of u1.
    pure real(xp) function slope_at_top(q, top) result(slope)
        real(xp), intent(in) :: q
        type(pole_t), intent(in) :: top
        slope = -2 * sum(alternating * n_ * q**(n_ * n_ - n_) * top%differences) &
                / (1 + sum(alternating * q**(n_ * n_ - n_) * top%sums))
    end function slope_at_top

    !> The theta functions at the argument z, |z| <= pi/2.
    pure subroutine evaluate_circular_form(form, z, from_top, theta)
        type(circular_form_t), intent(in) :: form
        real(dp), intent(in) :: z, from_top  !! from_top: pi/2 - |z|, to full relative precision
        type(theta_values_t), intent(out) :: theta
        real(dp), dimension(last) :: c, s, from_bottom_squared, from_top_squared
        real(dp) :: sine, cosine
        integer :: n

        if (abs(z) < from_top) then
            sine = sin(z)
            cosine = cos(z)
        else
            sine = sign(cos(from_top), z)
            cosine = sin(from_top)
        end if
        ! cos 2nz and sin 2nz; 2 sin(nz)^2 and 2 sin(n from_top)^2.
        c(1) = (cosine - sine) * (cosine + sine)
        s(1) = 2 * sine * cosine
        c(2) = 2 * c(1)**2 - 1
        s(2) = 2 * c(1) * s(1)
        c(3) = 2 * c(1) * c(2) - c(1)
        s(3) = 2 * c(1) * s(2) - s(1)
        from_bottom_squared = 2 * [sine, s(1), sine * (2 * c(1) + 1)]**2
        from_top_squared = 2 * [cosine, s(1), cosine * (2 * c(1) - 1)]**2

        theta%upper = cmplx(form%upper_least - dot_product(form%upper_even, from_bottom_squared), &
                            -dot_product(form%upper_odd, s), dp)
        theta%lower = cmplx(form%lower_least - dot_product(form%lower_even, from_top_squared), &
                            -dot_product(form%lower_odd, s), dp)
        theta%divisor = 1 + dot_product(form%divisor, c)
        theta%upper_slope = 0
        theta%lower_slope = 0
        theta%divisor_slope = 0
        do n = 1, last
            theta%upper_slope = theta%upper_slope - 2 * n * cmplx(form%upper_even(n) * s(n), &
                                                                  form%upper_odd(n) * c(n), dp)
            theta%lower_slope = theta%lower_slope - 2 * n &
                * cmplx(alternating(n) * form%lower_even(n) * s(n), form%lower_odd(n) * c(n), dp)
            theta%divisor_slope = theta%divisor_slope - 2 * n * form%divisor(n) * s(n)
        end do
        ! sin (2n+1)z and cos (2n+1)z, for n > 0, are sin z and cos z times a sum of cosines.
        theta%sn = sine / theta%divisor * (form%sn(0) + form%sn(1) * (2 * c(1) + 1) &
            + form%sn(2) * (2 * (c(2) + c(1)) + 1) + form%sn(3) * (2 * (c(3) + c(2) + c(1)) + 1))
        theta%cn = cosine / theta%divisor * (form%cn(0) + form%cn(1) * (2 * c(1) - 1) &
            + form%cn(2) * (2 * (c(2) - c(1)) + 1) + form%cn(3) * (2 * (c(3) - c(2) + c(1)) - 1))
    end subroutine evaluate_circular_form

end module spintop_circular_form
