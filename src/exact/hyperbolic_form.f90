!> The exact motion in hyperbolic functions, for k^2 > 1/2: motions that linger near the upright,
!> up to and including the separatrix, which takes forever.
!>
!> Jacobi's imaginary transformation of the circular form: the nome q' = exp(-pi K/K') <= 0.0433
!> belongs to the complementary modulus and is zero on the separatrix.
!> Whittaker and Watson, A Course of Modern Analysis, sections 21.51 and 22.
module spintop_hyperbolic_form
    use spintop_kinds, only: dp, xp
    use spintop_elliptic_series, only: nome, theta3_constant
    use spintop_regular_start, only: regular_start_t
    use spintop_turning_points, only: turning_points_t
    use spintop_theta_form, only: theta_clock_t, theta_values_t
    implicit none
    private
    public :: hyperbolic_form_t, prepare_hyperbolic_form, evaluate_hyperbolic_form

    !> Number of the last term of a series: the next adds at most 2e-22.
    integer, parameter :: last = 3

    !> Coefficients of the theta functions of one motion, for arguments z and y = H - |z| from the
    !> lower and from the upper turning point, H = pi K/(2 K'). All are scaled by exp(-|z|); with
    !> e = exp(-2|z|) and p = exp(-2y) = q'/e the terms go with powers of p and e, at most 1.
    type :: hyperbolic_form_t
        private
        !> W = sum_n powers(n) p^n cosh_(2n+1)(z), where cosh_m(z) = exp(-m|z|) cosh(mz).
        real(dp) :: powers(0:last) = 0
        !> U = sum_n p^n [upper_even(n) cosh_(2n+1)(z) + i upper_odd(n) sinh_(2n+1)(z)].
        real(dp), dimension(0:last) :: upper_even = 0, upper_odd = 0
        !> L = exp(-|z|) lower_turn
        !>     * sum_n e^n [lower_even(n) cosh_(2n+1)(y) - i lower_odd(n) sinh_(2n+1)(y)]
        !> on the way up, its conjugate on the way down.
        real(dp), dimension(0:last) :: lower_even = 0, lower_odd = 0
        complex(dp) :: lower_turn = 1
        !> sn W = sn_scale sum_n (-1)^n powers(n) p^n sinh_(2n+1)(z), and
        !> cn W = cn_scale exp(-|z|) sum_n (-1)^n powers(n) e^n sinh_(2n+1)(y).
        real(dp) :: sn_scale = 1, cn_scale = 1
    end type hyperbolic_form_t

    !> Where a pole of the sphere lies: at the imaginary argument i v.
    type :: pole_t
        real(xp) :: v = 0
        !> cos(nv) and sin(nv).
        real(xp), dimension(2 * last + 1) :: cosines = 1, sines = 0
        !> theta_3(v) = 1 + 2 sum q^(n^2) cos 2nv, and its logarithmic derivative.
        real(xp) :: norm = 1, slope = 0
    end type pole_t

    integer, parameter :: n_(last) = [1, 2, 3]
    integer, parameter :: odd(0:last) = [1, 3, 5, 7], alternating(0:last) = [1, -1, 1, -1]

contains

    !> Sets up clock and series of a motion with k^2 > 1/2.
    pure subroutine prepare_hyperbolic_form(start, points, clock, form)
        type(regular_start_t), intent(in) :: start
        type(turning_points_t), intent(in) :: points
        type(theta_clock_t), intent(out) :: clock
        type(hyperbolic_form_t), intent(out) :: form
        real(xp) :: q, k, theta3, cosh_sum_at_0, upper_sign, lower_sign
        type(pole_t) :: bottom, top
        integer :: n

        associate (kc2 => points%complement_squared, m1 => points%one_minus_u1, &
                   p2 => points%one_plus_u2)
            k = sqrt(points%k_squared)
            q = nome(kc2, k)
            theta3 = theta3_constant(q)
            cosh_sum_at_0 = 1 + q**2 + q**6 + q**12
            clock%rate = points%frequency / theta3**2
            if (q > 0) then
                clock%half_period = -log(q) / 2
                clock%period = 2 * clock%half_period
                clock%per_period = 1 / clock%period
            end if

            bottom = pole_at(q, sqrt(k * points%beta_u3_minus_u1), &
                             sqrt(start%beta * points%one_plus_u1))
            top = pole_at(q, sqrt(k * points%beta_u3_minus_1), &
                          sqrt(start%beta * points%one_minus_u2))

            upper_sign = sign(1.0_xp, start%b_plus_a)
            lower_sign = sign(1.0_xp, start%b_minus_a)
            clock%upper_rate = start%b_plus_a / (2 * p2) &
                               + upper_sign * clock%rate * bottom%slope
            clock%lower_rate = start%b_minus_a / (2 * m1) &
                               + lower_sign * clock%rate * top%slope
            clock%sum_rate = clock%upper_rate + clock%lower_rate
            clock%upper_step = 2 * upper_sign * bottom%v
            clock%lower_step = 2 * lower_sign * top%v
            clock%upper_amplitude = real(sqrt(p2 / 2) * theta3 / bottom%norm, dp)
            clock%lower_amplitude = real(sqrt(m1 / 2) * cosh_sum_at_0 / top%norm, dp)
            clock%start = start_argument(start, points, q, clock%half_period)
        end associate

        form%sn_scale = real(1 / sqrt(k), dp)
        form%cn_scale = real(2 * cosh_sum_at_0 / (sqrt(k) * theta3), dp)
        form%lower_turn = cmplx(2 * top%cosines(1), 2 * lower_sign * top%sines(1), dp)
        do n = 0, last
            associate (power => q**(n * n), m => 2 * n + 1)
                form%powers(n) = real(power, dp)
                form%upper_even(n) = real(power * bottom%cosines(m), dp)
                form%upper_odd(n) = real(power * upper_sign * bottom%sines(m), dp)
                form%lower_even(n) = real(power * top%cosines(m), dp)
                form%lower_odd(n) = real(power * lower_sign * top%sines(m), dp)
            end associate
        end do
    end subroutine prepare_hyperbolic_form

    !> A pole from tan(v) = opposite A(v) / (adjacent B(v)): the ratio of theta functions A/B
    !> depends so little on v that this iteration gains two digits and more a time.
    pure type(pole_t) function pole_at(q, opposite, adjacent) result(pole)
        real(xp), intent(in) :: q, opposite, adjacent
        integer, parameter :: most_iterations = 30
        real(xp) :: sine, cosine, c, previous
        integer :: n

        sine = opposite
        cosine = merge(adjacent, 1.0_xp, opposite > 0)
        c = 2
        do n = 1, most_iterations
            previous = c
            c = (cosine**2 - sine**2) / (cosine**2 + sine**2)
            if (abs(c - previous) <= epsilon(c)) exit
            sine = opposite * series_a(q, c)
            if (opposite > 0) cosine = adjacent * series_b(q, c)
        end do
        pole%v = atan2(sine, cosine)
        pole%sines(1) = sine / sqrt(sine**2 + cosine**2)
        pole%cosines(1) = cosine / sqrt(sine**2 + cosine**2)
        do n = 1, 2 * last
            pole%cosines(n + 1) = pole%cosines(n) * pole%cosines(1) - pole%sines(n) * pole%sines(1)
            pole%sines(n + 1) = pole%sines(n) * pole%cosines(1) + pole%cosines(n) * pole%sines(1)
        end do
        pole%norm = 1 + 2 * sum(q**(n_ * n_) * pole%cosines(2:2 * last:2))
        pole%slope = -4 * sum(n_ * q**(n_ * n_) * pole%sines(2:2 * last:2)) / pole%norm
    end function pole_at

    !> A = 1 + sum q^(n(n+1)) A_n(c), A_n = cos((2n+1)v)/cos(v), c = cos(2v).
    elemental real(xp) function series_a(q, c)
        real(xp), intent(in) :: q, c
        real(xp) :: a1, a2
        a1 = 2 * c - 1
        a2 = 2 * c * a1 - 1
        series_a = 1 + q**2 * (a1 + q**4 * (a2 + q**6 * (2 * c * a2 - a1)))
    end function series_a

    !> B = 1 + sum (-1)^n q^(n(n+1)) B_n(c), B_n = sin((2n+1)v)/sin(v), c = cos(2v).
    elemental real(xp) function series_b(q, c)
        real(xp), intent(in) :: q, c
        real(xp) :: b1, b2
        b1 = 2 * c + 1
        b2 = 2 * c * b1 - 1
        series_b = 1 - q**2 * (b1 - q**4 * (b2 - q**6 * (2 * c * b2 - b1)))
    end function series_b

    !> z at the start: 0 at the lower turning point u1, half a period at the upper one, negative
    !> on the way down.
    pure real(xp) function start_argument(start, points, q, half_period) result(z)
        type(regular_start_t), intent(in) :: start
        type(turning_points_t), intent(in) :: points
        real(xp), intent(in) :: q, half_period

        associate (y1 => points%y1, y2 => points%y2, kc => points%complement)
            if (.not. y1 < 0) then
                z = 0
            else if (.not. y2 > 0) then
                z = half_period
            else if (-y1 * kc <= y2) then
                z = inverse_sc(q, sqrt(-y1 / y2))
            else
                z = half_period - inverse_sc(q, sqrt(-y2 / y1) / kc)
            end if
        end associate
        if (start%u_rate < 0) z = -z
    end function start_argument

    !> The argument z <= H/2 at which sn/cn = `target`, by Newton's method in s = sinh(z):
    !> s B(c) theta_3 = target C(0) theta_4(c) with c = cosh(2z) = 1 + 2 s^2.
    pure real(xp) function inverse_sc(q, target) result(z)
        real(xp), intent(in) :: q, target
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

    !> The theta functions at the argument z, |z| <= H, all scaled by exp(-|z|).
    pure subroutine evaluate_hyperbolic_form(form, z, from_top, theta)
        type(hyperbolic_form_t), intent(in) :: form
        real(dp), intent(in) :: z, from_top  !! from_top: H - |z|, to full relative precision
        type(theta_values_t), intent(out) :: theta
        complex(dp) :: lower, lower_slope
        real(dp) :: decay, e, p, cosh_n(0:last), sinh_n(0:last), weight(0:last)

        decay = exp(-abs(z))
        e = decay**2
        p = exp(-2 * from_top)

        call scaled_hyperbolics(e, rise(abs(z), e), cosh_n, sinh_n)
        sinh_n = sign(sinh_n, z)
        weight = [1.0_dp, p, p**2, p**3]
        cosh_n = weight * cosh_n
        sinh_n = weight * sinh_n
        theta%divisor = dot_product(form%powers, cosh_n)
        theta%divisor_slope = dot_product(odd * form%powers, sinh_n)
        theta%upper = cmplx(dot_product(form%upper_even, cosh_n), &
                            dot_product(form%upper_odd, sinh_n), dp)
        theta%upper_slope = cmplx(dot_product(odd * form%upper_even, sinh_n), &
                                  dot_product(odd * form%upper_odd, cosh_n), dp)
        theta%sn = form%sn_scale * dot_product(alternating * form%powers, sinh_n) / theta%divisor

        call scaled_hyperbolics(p, rise(from_top, p), cosh_n, sinh_n)
        weight = [1.0_dp, e, e**2, e**3]
        cosh_n = weight * cosh_n
        sinh_n = weight * sinh_n
        lower = cmplx(dot_product(form%lower_even, cosh_n), &
                      -dot_product(form%lower_odd, sinh_n), dp)
        lower_slope = lower + cmplx(-dot_product(odd * form%lower_even, sinh_n), &
                                    dot_product(odd * form%lower_odd, cosh_n), dp)
        theta%lower = decay * form%lower_turn * lower
        theta%lower_slope = decay * form%lower_turn * lower_slope
        if (z < 0) then
            theta%lower = conjg(theta%lower)
            theta%lower_slope = -conjg(theta%lower_slope)
        end if
        theta%cn = form%cn_scale * decay * dot_product(alternating * form%powers, sinh_n) &
                   / theta%divisor
    end subroutine evaluate_hyperbolic_form

    !> exp(-mx) cosh(mx) and exp(-mx) sinh(mx) for m = 1, 3, 5, 7 and x >= 0, from e = exp(-2x) and
    !> 1 - e.
    pure subroutine scaled_hyperbolics(e, one_minus_e, cosh_n, sinh_n)
        real(dp), intent(in) :: e, one_minus_e
        real(dp), intent(out) :: cosh_n(0:last), sinh_n(0:last)
        cosh_n = (1 + [e, e**3, e**5, e**7]) / 2
        sinh_n(0) = one_minus_e / 2
        sinh_n(1) = sinh_n(0) * (1 + e * (1 + e))
        sinh_n(2) = sinh_n(1) + sinh_n(0) * e**3 * (1 + e)
        sinh_n(3) = sinh_n(2) + sinh_n(0) * e**5 * (1 + e)
    end subroutine scaled_hyperbolics

    !> 1 - e for e = exp(-2x), x >= 0, to full relative precision.
    elemental real(dp) function rise(x, e)
        real(dp), intent(in) :: x, e
        rise = 1 - e
        if (x < 0.25_dp) rise = 2 * sqrt(e) * sinh(x)
    end function rise

end module spintop_hyperbolic_form
