!> The theta functions of a free rigid body in hyperbolic functions, close to the separatrix and on it.
module spintop_free_hyperbolic_series
    use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
    use spintop_kinds, only: dp, xp, pi_xp
    use spintop_free_theta, only: free_values_t, last_elliptic, most_iterations, normalize, sum_a, sum_b
    use spintop_theta_functions, only: nome, theta3_constant, inverse_sc
    implicit none
    private
    public :: hyperbolic_series_t, prepare_hyperbolic_series

    !> Index of the last term of a series.
    integer, parameter :: last = 3

    !> The series in hyperbolic functions.
    type :: hyperbolic_series_t
        private
        real(xp) :: start = 0, rate = 0, phase_rate = 0
        real(xp) :: side = 1, q = 0, p = 0
        !> Half a period of the argument (0: it never repeats), and the angle mu.
        real(xp) :: half_period = 0, mu = 0
        !> cos (2n+1) mu and sin (2n+1) mu.
        real(dp), dimension(0:last) :: cosines = 1, sines = 0
        !> Factors of sn, cn, dn.
        real(dp) :: factor(3) = 0
    contains
        procedure :: evaluate => evaluate_hyperbolic
        procedure :: period => hyperbolic_period
        procedure :: turn => hyperbolic_turn
    end type hyperbolic_series_t

contains

    !> Sets up the hyperbolic series; the arguments are those of the circular one.
    pure subroutine prepare_hyperbolic_series(series, k, complement, frequency, r, spin, side, across, along)
        type(hyperbolic_series_t), intent(out) :: series !! the series
        real(xp), intent(in) :: k, complement !! modulus and complementary modulus
        real(xp), intent(in) :: frequency !! rate of the argument of the elliptic functions, rad/s
        real(xp), intent(in) :: r, spin !! a/(1+c), and twice the steady part of the phase's rate, rad/s
        real(xp), intent(in) :: side !! +1 or -1: about the axis of largest or smallest inertia
        real(xp), intent(in) :: across, along !! a b sn and a b cn at the start
        real(xp) :: q, mu, theta3, above, below, step, cosh_sum
        integer :: n

        q = nome(complement**2, k)
        theta3 = theta3_constant(q)
        series%side = side
        series%q = q
        series%p = sqrt(q)
        series%rate = frequency / (2 * theta3**2)
        if (q > 0) series%half_period = -log(q) / 2
        mu = atan(r)
        do n = 1, most_iterations
            step = (mu - atan2(r * sum_b(series%p, mu), sum_a(series%p, mu))) / (1 + 4 * q * sin(2 * mu)**2)
            mu = mu - step
            if (abs(step) <= 4 * epsilon(mu) * abs(mu)) exit
        end do
        series%mu = mu
        above = 0
        below = 0
        do n = 0, last_elliptic
            above = above + (2 * n + 1) * series%p**(n * (n + 1)) * sin((2 * n + 1) * mu)
            below = below + series%p**(n * (n + 1)) * cos((2 * n + 1) * mu)
        end do
        series%phase_rate = spin / 2 + side * series%rate * above / below
        series%start = hyperbolic_start(series, complement, abs(across), along)
        if (across < 0) series%start = -series%start
        do n = 0, last
            series%cosines(n) = real(cos((2 * n + 1) * mu), dp)
            series%sines(n) = real(sin((2 * n + 1) * mu), dp)
        end do
        cosh_sum = 1 + q**2 + q**6 + q**12
        series%factor = real([cosh_sum / (sqrt(k) * theta3), 1 / sqrt(k), cosh_sum / theta3], dp)
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

    !> The period of the momentum in the body, s; infinite on the separatrix.
    pure real(xp) function hyperbolic_period(self) result(period)
        class(hyperbolic_series_t), intent(in) :: self
        period = 2 * self%half_period / self%rate
        if (.not. self%q > 0) period = ieee_value(1.0_dp, ieee_positive_inf)
    end function hyperbolic_period

    !> Angle by which axis z turns about the momentum in a period, rad.
    pure real(xp) function hyperbolic_turn(self) result(turn)
        class(hyperbolic_series_t), intent(in) :: self
        turn = 2 * self%phase_rate * self%period() + self%side * (2 * pi_xp - 8 * self%mu)
    end function hyperbolic_turn

    !> The theta functions at a time since the start, s.
    pure subroutine evaluate_hyperbolic(self, elapsed, values)
        class(hyperbolic_series_t), intent(in) :: self
        real(xp), intent(in) :: elapsed !! time since the start, s
        type(free_values_t), intent(out) :: values !! attitude and momentum
        complex(dp) :: upper, lower
        real(xp) :: z, halves
        real(dp) :: decay, ratio, power, sine, cosine, p, side, flip
        integer :: n

        z = self%start + self%rate * elapsed
        halves = 0
        if (self%q > 0) halves = anint(z / self%half_period)
        z = z - halves * self%half_period
        flip = merge(1, -1, modulo(halves, 2.0_xp) < 0.5_xp)
        side = real(self%side, dp)
        p = real(self%p, dp)
        ! All sums are scaled by exp(-|z|).
        decay = exp(-2 * abs(real(z, dp)))
        ratio = 0
        if (p > 0) ratio = p / decay
        upper = 0
        lower = 0
        do n = 0, last
            power = p**(n * n) * ratio**n
            cosine = power * (1 + decay**(2 * n + 1)) / 2
            sine = sign(power * rise((2 * n + 1) * abs(real(z, dp))) / 2, real(z, dp))
            upper = upper + cmplx(self%cosines(n) * cosine, -side * self%sines(n) * sine, dp)
            lower = lower + (-1)**n * cmplx(self%cosines(n) * sine, -side * self%sines(n) * cosine, dp)
        end do
        call normalize(self%phase_rate * elapsed - 2 * self%side * self%mu * halves, upper, flip * lower, values)
        call evaluate_elliptic(self, real(2 * z, dp), flip, values%elliptic)
    end subroutine evaluate_hyperbolic

    !> cn, sn and dn at y = 2z, |y| <= half a period.
    pure subroutine evaluate_elliptic(self, y, flip, elliptic)
        class(hyperbolic_series_t), intent(in) :: self
        real(dp), intent(in) :: y, flip
        real(dp), intent(out) :: elliptic(3)
        real(dp) :: q, decay, ratio, power, sine, cosine, theta3, theta4, even
        integer :: n
        q = real(self%q, dp)
        decay = exp(-2 * abs(y))
        ratio = 0
        if (q > 0) ratio = q / decay
        sine = 0
        cosine = 0
        do n = 0, last
            power = q**(n * n) * ratio**n
            cosine = cosine + power * (1 + decay**(2 * n + 1)) / 2
            sine = sine + (-1)**n * power * rise((2 * n + 1) * abs(y)) / 2
        end do
        sine = sign(sine, y)
        theta3 = exp(-abs(y))
        theta4 = theta3
        do n = 1, last
            ! q^(n^2) cosh(2 n y) exp(-|y|), twice
            even = exp(-abs(y)) * q**(n * n - n) * ratio**n * (1 + decay**(2 * n))
            theta3 = theta3 + even
            theta4 = theta4 + (-1)**n * even
        end do
        elliptic = self%factor * [flip * theta4, flip * sine, theta3] / cosine
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

end module spintop_free_hyperbolic_series
