!> The exact solution in circular functions, for k^2 <= 1/2: all motions except those that stay near the
!> upright for a long time.
!>
!> Jacobi's theta functions have the nome q = exp(-pi K'/K) <= 0.0433. Textbooks compute the positions of the
!> poles with incomplete elliptic integrals. Here X = 2 q cosh(2 v) of a position i v is the solution of an
!> equation, similar to a quadratic one, in the data; this is accurate also where the axis passes a pole.
!> Whittaker and Watson, A Course of Modern Analysis, chapter XXI; Klein and Sommerfeld, chapter VI.
module spintop_circular_form
    use spintop_kinds, only: dp, xp, pi_xp
    use spintop_theta_functions, only: linear_chain, nome, theta3_constant, quotient, theta_clock_t, theta_values_t
    use spintop_circular_functions, only: find_sine_and_cosine
    use spintop_turning_points, only: turning_points_t
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
    type :: circular_form_t
        private
        !> U = upper_least - [sin(z)^2 upper_even + i sin(2z) upper_odd] and L = lower_least - [cos(z)^2
        !> lower_even + i sin(2z) lower_odd], relative to their minima at z = 0 and at |z| = pi/2. The minima
        !> may be zero, so that no digit is lost close to a pole.
        real(dp) :: upper_least = 1, lower_least = 1
        !> Coefficients of the polynomials; the rest is W = theta_4 = divisor, sn W = sin(z) sn and
        !> cn W = cos(z) cn.
        real(dp) :: powers(rows, 0:last) = 0
    end type circular_form_t

    !> Position of a pole of the sphere in the argument, from X = 2 q cosh(2 v): w = q exp(2 v) and q^2/w = q
    !> exp(-2 v).
    type :: pole_t
        real(xp) :: sums(last + 1) = 0         !! w^n + (q^2/w)^n
        real(xp) :: differences(last + 1) = 0  !! w^n - (q^2/w)^n
        real(xp) :: norm = 1                   !! the pole's theta function at u = u2 (u1)
        real(xp) :: slope = 0                  !! its logarithmic derivative there
    end type pole_t

    integer, parameter :: n_(last + 1) = [1, 2, 3, 4]
    integer, parameter :: alternating(last + 1) = [-1, 1, -1, 1]

contains

    !> Prepares clock and series of a motion with k^2 <= 1/2.
    pure subroutine prepare_circular_form(points, clock, form)
        type(turning_points_t), intent(in) :: points !! turning points of the motion
        type(theta_clock_t), intent(out) :: clock !! growth of argument and phases with time
        type(circular_form_t), intent(out) :: form !! the theta functions of the motion
        type(pole_t) :: bottom, top
        real(xp) :: q, theta3, theta4, upper_sign, lower_sign, x

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

            upper_sign = sign(1.0_xp, points%b_plus_a)
            lower_sign = sign(1.0_xp, points%b_minus_a)
            clock%upper_rate = quotient(points%b_plus_a, 2 * p2) &
                               + upper_sign * clock%rate * bottom%slope
            clock%lower_rate = quotient(points%b_minus_a, 2 * m1) &
                               + lower_sign * clock%rate * top%slope
            clock%sum_rate = clock%upper_rate + clock%lower_rate
            ! A fast top precesses slowly: the two rates nearly cancel.
            if (d2 > m1 / 4) clock%sum_rate = (points%turn - points%a * points%y2) / (p2 * d2) &
                + clock%rate * (upper_sign * bottom%slope - lower_sign * slope_at_top(q, top))

            clock%upper_amplitude = real(sqrt(p2 / 2) * theta3 / bottom%norm, dp)
            clock%lower_amplitude = real(sqrt(m1 / 2) * theta4 / top%norm, dp)
            form%upper_least = real(sqrt(quotient(p1 * kc, p2)) * bottom%norm, dp)
            form%lower_least = real(quotient(sqrt(d2) * top%norm, sqrt(m1 * kc)), dp)
            clock%start = start_argument(points, q)
        end associate

        call tabulate(q, bottom, top, upper_sign, lower_sign, theta3, theta4, form%powers)
    end subroutine prepare_circular_form

    !> Turns the Fourier series of the theta functions into polynomials in cos 2z.
    pure subroutine tabulate(q, bottom, top, upper_sign, lower_sign, theta3, theta4, table)
        real(xp), intent(in) :: q, upper_sign, lower_sign, theta3, theta4
        type(pole_t), intent(in) :: bottom, top
        real(dp), intent(inout) :: table(rows, 0:last)
        !> A polynomial in -cos 2z: where z is counted from the top.
        integer, parameter :: flip(0:last) = [1, -1, 1, -1], twice(last) = [2, 4, 6]
        real(dp), dimension(last) :: up_even, up_odd, low_even, low_odd, w
        real(dp) :: terms(0:last)
        real(xp) :: power
        integer :: n

        ! U = constant + sum [up_even cos 2nz - i up_odd sin 2nz], W = 1 + sum w cos 2nz; L as U,
        ! its even part counted from the top.
        do n = 1, last
            power = alternating(n) * q**(n * n - n)
            up_even(n) = real(power * bottom%sums(n), dp)
            up_odd(n) = real(power * upper_sign * bottom%differences(n), dp)
            low_even(n) = real(power * top%sums(n), dp)
            low_odd(n) = real(alternating(n) * power * lower_sign * top%differences(n), dp)
            w(n) = real(2 * alternating(n) * q**(n * n), dp)
        end do
        table(upper_even, :) = of_squares(up_even)
        table(upper_odd, :) = of_sines(up_odd)
        table(lower_even, :) = flip * of_squares(low_even)
        table(lower_odd, :) = of_sines(low_odd)
        table(upper_even_slope, :) = of_sines(twice * up_even)
        table(upper_odd_slope, :) = of_cosines(0.0_dp, twice * up_odd)
        table(lower_even_slope, :) = of_sines(twice * alternating(:last) * low_even)
        table(lower_odd_slope, :) = of_cosines(0.0_dp, twice * low_odd)
        table(divisor, :) = of_cosines(1.0_dp, w)
        table(divisor_slope, :) = of_sines(twice * w)

        ! sn W = theta_3/theta_2 sum (-1)^n q^(n(n+1)) sin (2n+1)z, in which
        ! sin (2n+1)z = sin z [1 + 2 sum_{m<=n} cos 2mz]. cn likewise from the top.
        do n = 0, last
            terms(n) = flip(n) * real(q**(n * (n + 1)) * theta3 / (1 + q**2 + q**6 + q**12), dp)
        end do
        table(sn, :) = of_cosines(sum(terms), &
                                  2 * [sum(terms(1:)), terms(2) + terms(3), terms(3)])
        table(cn, :) = real(theta4 / theta3, dp) * flip * table(sn, :)
    end subroutine tabulate

    !> constant + sum a(n) cos 2nz in powers of cos 2z.
    pure function of_cosines(constant, a) result(powers)
        real(dp), intent(in) :: constant, a(last)
        real(dp) :: powers(0:last)
        powers = [constant - a(2), a(1) - 3 * a(3), 2 * a(2), 4 * a(3)]
    end function of_cosines

    !> sum a(n) sin 2nz / sin 2z in powers of cos 2z.
    pure function of_sines(a) result(powers)
        real(dp), intent(in) :: a(last)
        real(dp) :: powers(0:last)
        powers = [a(1) - a(3), 2 * a(2), 4 * a(3), 0.0_dp]
    end function of_sines

    !> 2 sum a(n) sin(nz)^2 / sin(z)^2 in powers of cos 2z.
    pure function of_squares(a) result(powers)
        real(dp), intent(in) :: a(last)
        real(dp) :: powers(0:last)
        powers = [2 * a(1) + 4 * a(2) + 2 * a(3), 4 * a(2) + 8 * a(3), 8 * a(3), 0.0_dp]
    end function of_squares

    !> z at the start: 0 at the lower turning point u1, pi/2 at the upper one, negative on the way
    !> down.
    pure real(xp) function start_argument(points, q) result(z)
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
        if (points%u_rate < 0) z = -z
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
        a = linear_chain(x, q, 1.0_xp, x - q, last + 1)
        b = linear_chain(x, q, 1.0_xp, x + q, last + 1)
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
        real(xp) :: chain(0:last + 1)

        chain = linear_chain(x, q, 2.0_xp, x, last + 1)
        pole%sums = chain(1:)
        ! Not sqrt(X^2 - 4 q^2): that loses half the digits near v = 0.
        chain = linear_chain(x, q, 0.0_xp, (x + 2 * q) * scale * ratio_of_thetas(q, x), last + 1)
        pole%differences = chain(1:)
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
