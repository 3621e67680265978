!> The exact solution in hyperbolic functions, for k^2 > 1/2: motions that stay near the upright for a
!> long time, up to and including the separatrix.
!>
!> Jacobi's imaginary transformation of the circular form: the nome q' = exp(-pi K/K') <= 0.0433
!> belongs to the complementary modulus and is zero on the separatrix.
!> Whittaker and Watson, A Course of Modern Analysis, sections 21.51 and 22.
module spintop_hyperbolic_form
    use spintop_kinds, only: dp, xp
    use spintop_theta_functions, only: inverse_sc, nome, series_b, theta3_constant, theta_clock_t, theta_values_t
    use spintop_turning_points, only: turning_points_t
    implicit none
    private
    public :: hyperbolic_form_t, prepare_hyperbolic_form, evaluate_hyperbolic_form

    !> Index of the last term of a series; the next term is below 2e-22.
    integer, parameter :: last = 3

    !> Rows of the table of coefficients: series in z from the lower turning point, and series in y = H - |z|
    !> from the upper one, H = pi K/(2 K'). All are evaluated together; the number of rows fills a vector
    !> register.
    integer, parameter :: upper_even = 1, upper_odd = 2, upper_even_slope = 3, &
        upper_odd_slope = 4, divisor = 5, divisor_slope = 6, sn = 7
    integer, parameter :: lower_even = 1, lower_odd = 2, lower_even_slope = 3, &
        lower_odd_slope = 4, cn = 5
    integer, parameter :: rows = 8

    !> Sums scaled by exp(-x). With e = exp(-2x) and p = q'/e, both at most 1,
    !>     sum a(n) p^n exp(-(2n+1)x) cosh (2n+1)x            = near(p) + e far(e)
    !>     sum a(n) p^n exp(-(2n+1)x) sinh (2n+1)x / (1 - e)  = near(p) + e far(e)
    type :: sums_t
        real(dp), dimension(rows, 0:last) :: near = 0, far = 0
    end type sums_t

    !> The theta functions of one motion, scaled by exp(-|z|); odd sums have the sign of z.
    type :: hyperbolic_form_t
        private
        !> U = upper_even + i upper_odd, W = divisor, sn W = sn.
        type(sums_t) :: by_z
        !> L = exp(-|z|) lower_turn [lower_even - i lower_odd] on the way from u1 to u2, its conjugate on the
        !> way back; cn W = exp(-|z|) cn.
        type(sums_t) :: by_y
        complex(dp) :: lower_turn = 1
        !> exp(-H)
        real(dp) :: half_decay = 0
    end type hyperbolic_form_t

    !> Position of a pole of the sphere: the imaginary argument i v.
    type :: pole_t
        real(xp) :: v = 0
        !> cos(nv) and sin(nv).
        real(xp), dimension(2 * last + 1) :: cosines = 1, sines = 0
        !> theta_3(v) = 1 + 2 sum q^(n^2) cos 2nv, and its logarithmic derivative.
        real(xp) :: norm = 1, slope = 0
    end type pole_t

    integer, parameter :: n_(last) = [1, 2, 3]
    integer, parameter :: squares(0:last) = [0, 1, 4, 9], odd(0:last) = [1, 3, 5, 7]
    integer, parameter :: alternating(0:last) = [1, -1, 1, -1]

contains

    !> Sets up clock and series of a motion with k^2 > 1/2.
    pure subroutine prepare_hyperbolic_form(points, clock, form)
        type(turning_points_t), intent(in) :: points !! turning points of the motion
        type(theta_clock_t), intent(out) :: clock !! growth of argument and phases with time
        type(hyperbolic_form_t), intent(out) :: form !! the theta functions of the motion
        real(xp) :: q, k, theta3, cosh_sum_at_0, upper_sign, lower_sign
        type(pole_t) :: bottom, top

        associate (kc2 => points%roots%complement_squared, m1 => points%roots%one_minus_u1, &
                   p2 => points%roots%one_plus_u2)
            k = sqrt(points%roots%k_squared)
            q = nome(kc2, k)
            theta3 = theta3_constant(q)
            cosh_sum_at_0 = 1 + q**2 + q**6 + q**12
            clock%rate = points%roots%frequency / theta3**2
            if (q > 0) then
                clock%half_period = -log(q) / 2
                clock%period = 2 * clock%half_period
                clock%per_period = 1 / clock%period
            end if

            bottom = pole_at(q, sqrt(k * points%roots%beta_u3_minus_u1), &
                             sqrt(points%beta * points%roots%one_plus_u1))
            top = pole_at(q, sqrt(k * points%roots%beta_u3_minus_1), &
                          sqrt(points%beta * points%roots%one_minus_u2))

            upper_sign = sign(1.0_xp, points%b_plus_a)
            lower_sign = sign(1.0_xp, points%b_minus_a)
            clock%upper_rate = points%b_plus_a / (2 * p2) &
                               + upper_sign * clock%rate * bottom%slope
            clock%lower_rate = points%b_minus_a / (2 * m1) &
                               + lower_sign * clock%rate * top%slope
            clock%sum_rate = clock%upper_rate + clock%lower_rate
            clock%upper_step = 2 * upper_sign * bottom%v
            clock%lower_step = 2 * lower_sign * top%v
            clock%upper_amplitude = real(sqrt(p2 / 2) * theta3 / bottom%norm, dp)
            clock%lower_amplitude = real(sqrt(m1 / 2) * cosh_sum_at_0 / top%norm, dp)
            clock%start = start_argument(points, q, clock%half_period)
        end associate

        form%lower_turn = cmplx(2 * top%cosines(1), 2 * lower_sign * top%sines(1), dp)
        form%half_decay = real(sqrt(q), dp)
        associate (powers => q**squares, up => upper_sign * bottom%sines(odd), &
                   low => lower_sign * top%sines(odd))
            call add_even(form%by_z, upper_even, q, powers * bottom%cosines(odd))
            call add_odd(form%by_z, upper_odd, q, powers * up)
            call add_odd(form%by_z, upper_even_slope, q, odd * powers * bottom%cosines(odd))
            call add_even(form%by_z, upper_odd_slope, q, odd * powers * up)
            call add_even(form%by_z, divisor, q, powers)
            call add_odd(form%by_z, divisor_slope, q, odd * powers)
            call add_odd(form%by_z, sn, q, alternating * powers / sqrt(k))

            call add_even(form%by_y, lower_even, q, powers * top%cosines(odd))
            call add_odd(form%by_y, lower_odd, q, powers * low)
            call add_odd(form%by_y, lower_even_slope, q, odd * powers * top%cosines(odd))
            call add_even(form%by_y, lower_odd_slope, q, odd * powers * low)
            call add_odd(form%by_y, cn, q, &
                         alternating * powers * (2 * cosh_sum_at_0 / (sqrt(k) * theta3)))
        end associate
    end subroutine prepare_hyperbolic_form

    !> Adds the sum of a(n) p^n (1 + e^(2n+1))/2, where p e = q.
    pure subroutine add_even(sums, row, q, a)
        type(sums_t), intent(inout) :: sums
        integer, intent(in) :: row
        real(xp), intent(in) :: q, a(0:last)
        integer :: n
        do n = 0, last
            sums%near(row, n) = real(a(n) / 2, dp)
            sums%far(row, n) = real(a(n) * q**n / 2, dp)
        end do
    end subroutine add_even

    !> Adds the sum of a(n) p^n (1 - e^(2n+1))/2 over 1 - e, that is of
    !> a(n)/2 [p^n + q p^(n-1) + ... + q^n + q^n e + ... + q^n e^n].
    pure subroutine add_odd(sums, row, q, a)
        type(sums_t), intent(inout) :: sums
        integer, intent(in) :: row
        real(xp), intent(in) :: q, a(0:last)
        real(xp) :: near, far
        integer :: n
        near = 0
        far = 0
        do n = last, 0, -1
            near = a(n) / 2 + q * near
            sums%near(row, n) = real(near, dp)
            sums%far(row, n) = real(far, dp)
            far = far + q**n * a(n) / 2
        end do
    end subroutine add_odd

    !> A pole from tan(v) = opposite A(v) / (adjacent B(v)). The ratio of theta functions A/B depends so
    !> weakly on v that each iteration gains two digits or more.
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

    !> z at the start: 0 at the lower turning point u1, half a period at the upper one, negative
    !> on the way down.
    pure real(xp) function start_argument(points, q, half_period) result(z)
        type(turning_points_t), intent(in) :: points
        real(xp), intent(in) :: q, half_period

        associate (y1 => points%roots%y1, y2 => points%roots%y2, kc => points%roots%complement)
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
        if (points%u_rate < 0) z = -z
    end function start_argument

    !> The theta functions at the argument z, |z| <= H, scaled by exp(-|z|).
    pure subroutine evaluate_hyperbolic_form(form, z, from_top, theta)
        type(hyperbolic_form_t), intent(in) :: form !! the theta functions
        real(dp), intent(in) :: z, from_top  !! from_top: H - |z|, to full relative precision
        type(theta_values_t), intent(out) :: theta !! values of the theta functions
        complex(dp) :: lower, lower_slope
        real(dp) :: values(rows), decay, climb, e, p, odd_z, odd_y

        ! exp(-|z|) and exp(-y): the one that is closer to 1 is computed directly, the other from it.
        if (abs(z) < from_top) then
            decay = exp(-abs(z))
            climb = 0
            if (form%half_decay > 0) climb = form%half_decay / decay
        else
            climb = exp(-from_top)
            decay = form%half_decay / climb
        end if
        e = decay**2
        p = climb**2

        odd_z = sign(rise(abs(z), decay), z)
        call sum_series(form%by_z, e, p, values)
        theta%divisor = values(divisor)
        theta%divisor_slope = odd_z * values(divisor_slope)
        theta%upper = cmplx(values(upper_even), odd_z * values(upper_odd), dp)
        theta%upper_slope = cmplx(odd_z * values(upper_even_slope), values(upper_odd_slope), dp)
        theta%sn = odd_z * values(sn) / theta%divisor

        odd_y = rise(from_top, climb)
        call sum_series(form%by_y, p, e, values)
        lower = cmplx(values(lower_even), -odd_y * values(lower_odd), dp)
        lower_slope = lower + cmplx(-odd_y * values(lower_even_slope), values(lower_odd_slope), dp)
        theta%lower = decay * form%lower_turn * lower
        theta%lower_slope = decay * form%lower_turn * lower_slope
        if (z < 0) then
            theta%lower = conjg(theta%lower)
            theta%lower_slope = -conjg(theta%lower_slope)
        end if
        theta%cn = decay * odd_y * values(cn) / theta%divisor
    end subroutine evaluate_hyperbolic_form

    !> All sums at e and p.
    pure subroutine sum_series(sums, e, p, values)
        type(sums_t), intent(in) :: sums
        real(dp), intent(in) :: e, p
        real(dp), intent(out) :: values(rows)
        associate (a => sums%near, b => sums%far)
            values = a(:, 0) + p * (a(:, 1) + p * (a(:, 2) + p * a(:, 3))) &
                + e * (b(:, 0) + e * (b(:, 1) + e * (b(:, 2) + e * b(:, 3))))
        end associate
    end subroutine sum_series

    !> 1 - exp(-2x), x >= 0, from the decay exp(-x), to full relative precision.
    pure real(dp) function rise(x, decay)
        real(dp), intent(in) :: x, decay
        rise = 1 - decay**2
        ! 2 exp(-x) sinh(x)
        if (x < 0.25_dp) rise = 2 * decay * x * (1 + x**2 / 6 * (1 + x**2 / 20 * (1 + x**2 / 42 &
            * (1 + x**2 / 72 * (1 + x**2 / 110)))))
    end function rise

end module spintop_hyperbolic_form
