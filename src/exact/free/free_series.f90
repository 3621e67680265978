!> The theta functions of a free rigid body: in circular functions while the complementary modulus is not small, and in
!> hyperbolic functions close to the separatrix and on it.
!>
!> With k and k' the modulus and the complementary modulus of the momentum's elliptic functions sn, cn, dn, the
!> attitude needs theta functions of the square of the nome (circular series, k' >= 0.17) or of the square root
!> of the complementary nome (hyperbolic series, k' below that, and k' = 0). So a few terms suffice for extended
!> precision.
!> Source: Whittaker and Watson, A Course of Modern Analysis, chapters XXI and XXII.
module spintop_free_series
    use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
    use spintop_kinds, only: dp, xp, pi_xp
    use spintop_circular_functions, only: unit
    use spintop_momentum_path, only: momentum_path_t
    use spintop_theta_functions, only: inverse_sc, linear_chain, nome, theta3_constant
    implicit none
    private
    public :: free_values_t, circular_series_t, prepare_circular_series, least_complement
    public :: hyperbolic_series_t, prepare_hyperbolic_series

    !> Index of the last term of series in powers n (n+1) of the nome of the elliptic functions.
    integer, parameter :: last_elliptic = 5
    !> Bound of the iterations for a constant; each gains two digits or more.
    integer, parameter :: most_iterations = 60

    !> The theta functions at one time: the Cayley-Klein components q0 + i q3 and q1 + i q2 relative to the momentum,
    !> and (cn, sn, dn).
    type :: free_values_t
        complex(dp) :: upper = 1, lower = 0
        real(dp) :: elliptic(3) = 0
    end type free_values_t

    !> Smallest k' of the circular series, 3 - sqrt(8): there both series have nomes of one size.
    real(xp), parameter :: least_complement = 0.17157287525380990239_xp

    !> Index of the last term of F+ and F-.
    integer, parameter :: last_circular = 4

    !> What both series have.
    type :: free_series_t
        !> The period of the momentum in the body, s; infinite on the separatrix.
        real(xp) :: period = 0
        !> Argument at the start, its rate, and that of the phase chi, rad/s.
        real(xp) :: start = 0, rate = 0, phase_rate = 0
        !> Factors of cn, sn and dn.
        real(dp) :: factor(3) = 0
    end type free_series_t

    !> The series in circular functions.
    type, extends(free_series_t) :: circular_series_t
        private
        !> Coefficients of cos 2nz and sin 2nz in F+, of sin (2n+1)z and cos (2n+1)z in F-.
        real(dp), dimension(0:last_circular) :: up_even = 0, up_odd = 0, low_odd = 0, low_even = 0
        !> Coefficients of sn, cn (odd multiples) and of the even theta functions.
        real(dp) :: powers(0:last_elliptic) = 0, squares(last_elliptic) = 0
    contains
        procedure :: evaluate => evaluate_circular
    end type circular_series_t

    !> Index of the last term of a series.
    integer, parameter :: last_hyperbolic = 3

    !> The series in hyperbolic functions.
    type, extends(free_series_t) :: hyperbolic_series_t
        private
        real(xp) :: side = 1, q = 0, p = 0
        !> Half a period of the argument (0: it never repeats), and the angle mu.
        real(xp) :: half_period = 0, mu = 0
        !> cos (2n+1) mu and sin (2n+1) mu.
        real(dp), dimension(0:last_hyperbolic) :: cosines = 1, sines = 0
    contains
        procedure :: evaluate => evaluate_hyperbolic
    end type hyperbolic_series_t

contains

    !> Sets up the circular series.
    pure subroutine prepare_circular_series(series, path)
        type(circular_series_t), intent(out) :: series !! the series
        type(momentum_path_t), intent(in) :: path !! the path of the momentum
        real(xp) :: q, y, s, x, theta3, t2
        real(xp), dimension(0:last_circular) :: even, mixed, odd, other
        integer :: n

        q = nome(path%modulus**2, path%complement)
        theta3 = theta3_constant(q)
        series%rate = path%frequency / theta3**2
        series%period = 2 * pi_xp / series%rate
        y = momentum_root(q, path%ratio)
        s = sqrt(y**2 + 4 * q)
        x = y**2 + 2 * q
        even = linear_chain(x, q, 2.0_xp, x, last_circular)
        mixed = linear_chain(x, q, 0.0_xp, y * s, last_circular)
        odd = linear_chain(x, q, y, y * (x + q), last_circular)
        other = linear_chain(x, q, s, s * (x - q), last_circular)
        even(0) = 1
        do n = 0, last_circular
            even(n) = (-1)**n * q**(2 * n**2 - n) * even(n)
            mixed(n) = (-1)**n * q**(2 * n**2 - n) * mixed(n)
            odd(n) = (-1)**n * q**(2 * n**2 + n) * odd(n)
            other(n) = (-1)**n * q**(2 * n**2 + n) * other(n)
        end do
        series%phase_rate = path%spin / 2 - path%side * series%rate * 2 * sum([(n * mixed(n), n=1, last_circular)]) / sum(even)
        series%start = argument_at(q, sqrt(path%complement) * path%a * path%part(2), path%b * path%part(1))
        series%up_even = real(even, dp)
        series%up_odd = real(path%side * mixed, dp)
        series%low_odd = real(other, dp)
        series%low_even = real(-path%side * odd, dp)

        series%powers = [(real(q**(n * (n + 1)), dp), n=0, last_elliptic)]
        series%squares = [(real(2 * q**(n * n), dp), n=1, last_elliptic)]
        t2 = sum([(q**(n * (n + 1)), n=0, last_elliptic)])
        series%factor = real([sqrt(path%complement) * theta3 / t2, theta3 / t2, sqrt(path%complement)], dp)
    end subroutine prepare_circular_series

    !> The number Y that solves sum (-1)^n q^(2n^2+n) o_n = r [1 + sum (-1)^n q^(2n^2-n) e_n], by Newton's method.
    pure real(xp) function momentum_root(q, r) result(y)
        real(xp), intent(in) :: q, r
        real(xp) :: u, x, left, right, step, e(0:last_circular), o(0:last_circular)
        integer :: n, iteration
        u = 1 - 2 * q**2
        y = 2 * r * u / (1 + sqrt(1 + 4 * q * r**2 * u))
        do iteration = 1, most_iterations
            x = y**2 + 2 * q
            e = linear_chain(x, q, 2.0_xp, x, last_circular)
            o = linear_chain(x, q, y, y * (x + q), last_circular)
            left = sum([((-1)**n * q**(2 * n**2 + n) * o(n), n=0, last_circular)])
            right = r * (1 + sum([((-1)**n * q**(2 * n**2 - n) * e(n), n=1, last_circular)]))
            step = (left - right) / (1 - 3 * q**3 * (y**2 + q) + 2 * q * r * y)
            y = y - step
            if (abs(step) <= 4 * epsilon(y) * abs(y)) exit
        end do
    end function momentum_root

    !> The argument z with tan z = opposite B/(adjacent A), theta functions of z itself: by Newton's method.
    pure real(xp) function argument_at(q, opposite, adjacent) result(z)
        real(xp), intent(in) :: q, opposite, adjacent
        real(xp) :: step
        integer :: iteration
        z = atan2(opposite, adjacent)
        do iteration = 1, most_iterations
            step = (z - atan2(opposite * sum_b(q, z), adjacent * sum_a(q, z))) / (1 + 4 * q**2 * sin(2 * z)**2)
            z = z - step
            if (abs(step) <= 4 * epsilon(z) * abs(z)) exit
        end do
    end function argument_at

    !> The theta functions at a time since the start, s.
    pure subroutine evaluate_circular(self, elapsed, values)
        class(circular_series_t), intent(in) :: self
        real(xp), intent(in) :: elapsed !! time since the start, s
        type(free_values_t), intent(out) :: values !! attitude and momentum
        complex(dp) :: turns(0:2 * last_elliptic + 1), upper, lower
        real(dp) :: theta3, theta4, sine, cosine
        integer :: n

        turns(1) = unit(self%start + self%rate * elapsed)
        turns(0) = 1
        do n = 1, 2 * last_elliptic
            turns(n + 1) = turns(n) * turns(1)
        end do
        upper = 0
        lower = 0
        do n = last_circular, 0, -1
            associate (even => turns(2 * n), odd => turns(2 * n + 1))
                upper = upper + cmplx(self%up_even(n) * real(even, dp), self%up_odd(n) * aimag(even), dp)
                lower = lower + cmplx(self%low_odd(n) * aimag(odd), self%low_even(n) * real(odd, dp), dp)
            end associate
        end do
        call normalize(self%phase_rate * elapsed, upper, lower, values)
        theta3 = 1
        theta4 = 1
        do n = 1, last_elliptic
            theta3 = theta3 + self%squares(n) * real(turns(2 * n), dp)
            theta4 = theta4 + (-1)**n * self%squares(n) * real(turns(2 * n), dp)
        end do
        sine = 0
        cosine = 0
        do n = 0, last_elliptic
            sine = sine + (-1)**n * self%powers(n) * aimag(turns(2 * n + 1))
            cosine = cosine + self%powers(n) * real(turns(2 * n + 1), dp)
        end do
        values%elliptic = self%factor * [cosine, sine, theta3] / theta4
    end subroutine evaluate_circular

    !> Sets up the hyperbolic series.
    pure subroutine prepare_hyperbolic_series(series, path)
        type(hyperbolic_series_t), intent(out) :: series !! the series
        type(momentum_path_t), intent(in) :: path !! the path of the momentum
        real(xp) :: q, mu, theta3, above, below, cosh_sum
        integer :: n

        q = nome(path%complement**2, path%modulus)
        theta3 = theta3_constant(q)
        series%side = path%side
        series%q = q
        series%p = sqrt(q)
        series%rate = path%frequency / (2 * theta3**2)
        series%period = ieee_value(1.0_dp, ieee_positive_inf)
        if (q > 0) then
            series%half_period = -log(q) / 2
            series%period = 2 * series%half_period / series%rate
        end if
        mu = argument_at(series%p, path%ratio, 1.0_xp)
        series%mu = mu
        above = 0
        below = 0
        do n = 0, last_elliptic
            above = above + (2 * n + 1) * series%p**(n * (n + 1)) * sin((2 * n + 1) * mu)
            below = below + series%p**(n * (n + 1)) * cos((2 * n + 1) * mu)
        end do
        series%phase_rate = path%spin / 2 + path%side * series%rate * above / below
        series%start = hyperbolic_start(series, path%complement, path%a * abs(path%part(2)), path%b * path%part(1))
        if (path%part(2) < 0) series%start = -series%start
        do n = 0, last_hyperbolic
            series%cosines(n) = real(cos((2 * n + 1) * mu), dp)
            series%sines(n) = real(sin((2 * n + 1) * mu), dp)
        end do
        cosh_sum = 1 + q**2 + q**6 + q**12
        series%factor = real([cosh_sum / (sqrt(path%modulus) * theta3), 1 / sqrt(path%modulus), cosh_sum / theta3], dp)
    end subroutine prepare_hyperbolic_series

    !> Half the argument at which sn/cn = across/along.
    pure real(xp) function hyperbolic_start(series, complement, across, along) result(z)
        type(hyperbolic_series_t), intent(in) :: series
        real(xp), intent(in) :: complement, across, along
        if (across**2 * complement <= along**2) then
            z = 0
            if (across > 0) z = inverse_sc(series%q, across / along) / 2
        else
            z = (series%half_period - inverse_sc(series%q, along / (complement * across))) / 2
        end if
    end function hyperbolic_start

    !> The theta functions at a time since the start, s.
    pure subroutine evaluate_hyperbolic(self, elapsed, values)
        class(hyperbolic_series_t), intent(in) :: self
        real(xp), intent(in) :: elapsed !! time since the start, s
        type(free_values_t), intent(out) :: values !! attitude and momentum
        complex(dp) :: upper, lower
        real(xp) :: z, halves
        real(dp), dimension(0:last_hyperbolic) :: cosine, sine
        real(dp) :: side, flip
        integer :: n

        z = self%start + self%rate * elapsed
        halves = 0
        if (self%q > 0) halves = anint(z / self%half_period)
        z = z - halves * self%half_period
        flip = merge(1, -1, modulo(halves, 2.0_xp) < 0.5_xp)
        side = real(self%side, dp)
        call find_terms(real(self%p, dp), real(z, dp), cosine, sine)
        upper = 0
        lower = 0
        do n = 0, last_hyperbolic
            upper = upper + cmplx(self%cosines(n) * cosine(n), -side * self%sines(n) * sine(n), dp)
            lower = lower + (-1)**n * cmplx(self%cosines(n) * sine(n), -side * self%sines(n) * cosine(n), dp)
        end do
        call normalize(self%phase_rate * elapsed - 2 * self%side * self%mu * halves, upper, flip * lower, values)
        call evaluate_elliptic(self, real(2 * z, dp), flip, values%elliptic)
    end subroutine evaluate_hyperbolic

    !> The terms q^(n^2+n) cosh (2n+1)x and q^(n^2+n) sinh (2n+1)x, scaled by exp(-|x|).
    pure subroutine find_terms(q, x, cosine, sine)
        real(dp), intent(in) :: q, x
        real(dp), dimension(0:last_hyperbolic), intent(out) :: cosine, sine
        real(dp) :: decay, ratio, power
        integer :: n
        decay = exp(-2 * abs(x))
        ratio = 0
        if (q > 0) ratio = q / decay
        do n = 0, last_hyperbolic
            power = q**(n * n) * ratio**n
            cosine(n) = power * (1 + decay**(2 * n + 1)) / 2
            sine(n) = sign(power * rise((2 * n + 1) * abs(x)) / 2, x)
        end do
    end subroutine find_terms

    !> cn, sn and dn at y = 2z, |y| <= half a period.
    pure subroutine evaluate_elliptic(self, y, flip, elliptic)
        class(hyperbolic_series_t), intent(in) :: self
        real(dp), intent(in) :: y, flip
        real(dp), intent(out) :: elliptic(3)
        real(dp), dimension(0:last_hyperbolic) :: cosine, sine
        real(dp) :: q, decay, ratio, theta3, theta4, even
        integer :: n
        q = real(self%q, dp)
        call find_terms(q, y, cosine, sine)
        decay = exp(-2 * abs(y))
        ratio = 0
        if (q > 0) ratio = q / decay
        theta3 = exp(-abs(y))
        theta4 = theta3
        do n = 1, last_hyperbolic
            ! q^(n^2) cosh(2 n y) exp(-|y|), twice
            even = exp(-abs(y)) * q**(n * n - n) * ratio**n * (1 + decay**(2 * n))
            theta3 = theta3 + even
            theta4 = theta4 + (-1)**n * even
        end do
        elliptic = self%factor * [flip * theta4, flip * (sine(0) - sine(1) + sine(2) - sine(3)), theta3] / sum(cosine)
    end subroutine evaluate_elliptic

    !> 1 - exp(-2x), x >= 0, to full relative precision.
    elemental real(dp) function rise(x)
        real(dp), intent(in) :: x
        if (x < 0.25_dp) then
            rise = 2 * exp(-x) * sinh(x)
        else
            rise = 1 - exp(-2 * x)
        end if
    end function rise

    !> A = 1 + sum (-1)^n p^(n^2+n) A_n, A_n = sin((2n+1)v)/sin(v).
    pure real(xp) function sum_a(p, v)
        real(xp), intent(in) :: p, v !! nome, and argument
        sum_a = alternating_sum(p, cos(2 * v), 1, -1)
    end function sum_a

    !> B = 1 + sum p^(n^2+n) B_n, B_n = cos((2n+1)v)/cos(v).
    pure real(xp) function sum_b(p, v)
        real(xp), intent(in) :: p, v !! nome, and argument
        sum_b = alternating_sum(p, cos(2 * v), -1, 1)
    end function sum_b

    !> 1 + sum signs^n p^(n^2+n) x_n, x_0 = 1, x_1 = 2f + offset, x_(n+1) = 2f x_n - x_(n-1).
    pure real(xp) function alternating_sum(p, f, offset, signs)
        real(xp), intent(in) :: p, f
        integer, intent(in) :: offset, signs
        real(xp) :: before, now, next
        integer :: n
        alternating_sum = 1
        before = 1
        now = 2 * f + offset
        do n = 1, last_elliptic
            alternating_sum = alternating_sum + signs**n * p**(n * (n + 1)) * now
            next = 2 * f * now - before
            before = now
            now = next
        end do
    end function alternating_sum

    !> exp(i chi) (F+, F-)/norm.
    pure subroutine normalize(chi, upper, lower, values)
        real(xp), intent(in) :: chi !! phase, rad; reduced before it is rounded
        complex(dp), intent(in) :: upper, lower !! F+ and F-
        type(free_values_t), intent(inout) :: values !! the components are set
        complex(dp) :: turn
        real(dp) :: norm
        turn = unit(chi)
        norm = sqrt(real(upper, dp)**2 + aimag(upper)**2 + real(lower, dp)**2 + aimag(lower)**2)
        values%upper = turn * upper / norm
        values%lower = turn * lower / norm
    end subroutine normalize

end module spintop_free_series
