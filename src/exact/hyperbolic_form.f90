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

    !> Coefficients of the theta functions of one motion. All are scaled by exp(-|z|): with
    !> p = q' exp(2|z|) <= 1, a term in cosh 2nz or cosh (2n+1)z goes with p^n.
    type :: hyperbolic_form_t
        private
        !> K pi/(2 K'): z at the upper turning point; huge on the separatrix.
        real(dp) :: half_period = huge(1.0_dp)
        !> W = sum_n divisor(n) p^n cosh (2n+1)z.
        real(dp) :: divisor(0:last) = 0
        !> U = sum_n p^n [upper_even(n) cosh (2n+1)z + i upper_odd(n) sinh (2n+1)z].
        real(dp), dimension(0:last) :: upper_even = 0, upper_odd = 0
        !> L = exp(-|z|) + sum_n p^n [lower_even(n) cosh 2nz + i lower_odd(n) sinh 2nz].
        real(dp), dimension(last) :: lower_even = 0, lower_odd = 0
        !> cn W = cn_scale [exp(-|z|) + sum_n (-p)^n cn(n) cosh 2nz], sn W = sn_scale Sh(z).
        real(dp) :: cn(last) = 0, cn_scale = 1, sn_scale = 1
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
                form%half_period = real(clock%half_period, dp)
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
        form%cn_scale = real(cosh_sum_at_0 / (sqrt(k) * theta3), dp)
        do n = 0, last
            form%divisor(n) = real(q**(n * n), dp)
            form%upper_even(n) = real(q**(n * n) * bottom%cosines(2 * n + 1), dp)
            form%upper_odd(n) = real(q**(n * n) * upper_sign * bottom%sines(2 * n + 1), dp)
        end do
        do n = 1, last
            form%lower_even(n) = real(2 * q**(n * n - n) * top%cosines(2 * n), dp)
            form%lower_odd(n) = real(2 * q**(n * n - n) * lower_sign * top%sines(2 * n), dp)
            form%cn(n) = real(2 * (-1)**n * q**(n * n - n), dp)
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

    !> The theta functions at the argument z, |z| <= the half period, all scaled by exp(-|z|).
    pure subroutine evaluate_hyperbolic_form(form, z, theta)
        type(hyperbolic_form_t), intent(in) :: form
        real(dp), intent(in) :: z
        type(theta_values_t), intent(out) :: theta
        real(dp) :: decay, decay2, p, power, cosh_n, sinh_n, sinh_sum, theta4
        integer :: n

        decay = exp(-abs(z))
        decay2 = decay**2
        p = exp(2 * (abs(z) - form%half_period))

        theta%upper = 0
        theta%upper_slope = 0
        theta%lower_slope = 0
        theta%divisor = 0
        theta%divisor_slope = 0
        sinh_sum = 0
        power = 1
        do n = 0, last
            cosh_n = power * (1 + decay2**(2 * n + 1)) / 2
            sinh_n = sign(power * (1 - decay2**(2 * n + 1)) / 2, z)
            theta%divisor = theta%divisor + form%divisor(n) * cosh_n
            theta%divisor_slope = theta%divisor_slope + (2 * n + 1) * form%divisor(n) * sinh_n
            sinh_sum = sinh_sum + (-1)**n * form%divisor(n) * sinh_n
            theta%upper = theta%upper + cmplx(form%upper_even(n) * cosh_n, &
                                              form%upper_odd(n) * sinh_n, dp)
            theta%upper_slope = theta%upper_slope + (2 * n + 1) &
                * cmplx(form%upper_even(n) * sinh_n, form%upper_odd(n) * cosh_n, dp)
            power = power * p
        end do

        theta%lower = decay
        theta4 = decay
        power = decay
        do n = 1, last
            power = power * p
            cosh_n = power * (1 + decay2**(2 * n)) / 2
            sinh_n = sign(power * (1 - decay2**(2 * n)) / 2, z)
            theta%lower = theta%lower + cmplx(form%lower_even(n) * cosh_n, &
                                              form%lower_odd(n) * sinh_n, dp)
            theta%lower_slope = theta%lower_slope + 2 * n &
                * cmplx(form%lower_even(n) * sinh_n, form%lower_odd(n) * cosh_n, dp)
            theta4 = theta4 + form%cn(n) * cosh_n
        end do
        theta%sn = form%sn_scale * sinh_sum / theta%divisor
        theta%cn = form%cn_scale * theta4 / theta%divisor
    end subroutine evaluate_hyperbolic_form

end module spintop_hyperbolic_form
