!> The theta functions of a free rigid body in circular functions, while the complementary modulus is not small.
module spintop_free_circular_series
    use spintop_kinds, only: dp, xp, pi_xp
    use spintop_free_theta, only: free_values_t, last_elliptic, most_iterations, normalize, sum_a, sum_b, unit
    use spintop_theta_functions, only: linear_chain, nome, theta3_constant
    implicit none
    private
    public :: circular_series_t, prepare_circular_series, least_complement

    !> Smallest k' of the circular series, 3 - sqrt(8): there both series have nomes of one size.
    real(xp), parameter :: least_complement = 0.17157287525380990239_xp

    !> Index of the last term of F+ and F-.
    integer, parameter :: last = 4

    !> The series in circular functions.
    type :: circular_series_t
        private
        !> Argument at the start, its rate, and that of the phase chi, rad/s.
        real(xp) :: start = 0, rate = 0, phase_rate = 0
        !> Side s, and the nome.
        real(xp) :: side = 1, q = 0
        !> The number that solves the equation of the momentum, and its root S.
        real(xp) :: y = 0, root = 0, slope = 0
        !> Coefficients of cos 2nz and sin 2nz in F+, of sin (2n+1)z and cos (2n+1)z in F-.
        real(dp), dimension(0:last) :: up_even = 0, up_odd = 0, low_odd = 0, low_even = 0
        !> Coefficients of sn, cn (odd multiples) and of the even theta functions, and factors of sn, cn, dn.
        real(dp) :: powers(0:last_elliptic) = 0, squares(last_elliptic) = 0, factor(3) = 0
    contains
        procedure :: evaluate => evaluate_circular
        procedure :: period => circular_period
        procedure :: turn => circular_turn
    end type circular_series_t

contains

    !> Sets up the circular series.
    pure subroutine prepare_circular_series(series, k, complement, frequency, r, spin, side, across, along)
        type(circular_series_t), intent(out) :: series !! the series
        real(xp), intent(in) :: k, complement !! modulus and complementary modulus
        real(xp), intent(in) :: frequency !! rate of the argument of the elliptic functions, rad/s
        real(xp), intent(in) :: r, spin !! a/(1+c), and twice the steady part of the phase's rate, rad/s
        real(xp), intent(in) :: side !! +1 or -1: about the axis of largest or smallest inertia
        real(xp), intent(in) :: across, along !! a b sn and a b cn at the start
        real(xp) :: q, y, s, x, theta3, t2, even(0:last), mixed(0:last), odd(0:last), other(0:last)
        integer :: n

        q = nome(k**2, complement)
        theta3 = theta3_constant(q)
        series%side = side
        series%q = q
        series%rate = frequency / theta3**2
        y = momentum_root(q, r)
        s = sqrt(y**2 + 4 * q)
        x = y**2 + 2 * q
        even = linear_chain(x, q, 2.0_xp, x, last)
        mixed = linear_chain(x, q, 0.0_xp, y * s, last)
        odd = linear_chain(x, q, y, y * (x + q), last)
        other = linear_chain(x, q, s, s * (x - q), last)
        even(0) = 1
        do n = 0, last
            even(n) = (-1)**n * q**(2 * n**2 - n) * even(n)
            mixed(n) = (-1)**n * q**(2 * n**2 - n) * mixed(n)
            odd(n) = (-1)**n * q**(2 * n**2 + n) * odd(n)
            other(n) = (-1)**n * q**(2 * n**2 + n) * other(n)
        end do
        series%y = y
        series%root = s
        series%slope = -2 * sum([(n * mixed(n), n=1, last)]) / sum(even)
        series%phase_rate = spin / 2 + side * series%rate * series%slope
        series%start = argument_at_start(q, sqrt(complement) * across, along)
        series%up_even = real(even, dp)
        series%up_odd = real(side * mixed, dp)
        series%low_odd = real(other, dp)
        series%low_even = real(-side * odd, dp)

        series%powers = [(real(q**(n * (n + 1)), dp), n=0, last_elliptic)]
        series%squares = [(real(2 * q**(n * n), dp), n=1, last_elliptic)]
        t2 = sum([(q**(n * (n + 1)), n=0, last_elliptic)])
        series%factor = real([sqrt(complement) * theta3 / t2, theta3 / t2, sqrt(complement)], dp)
    end subroutine prepare_circular_series

    !> The number Y that solves sum (-1)^n q^(2n^2+n) o_n = r [1 + sum (-1)^n q^(2n^2-n) e_n], by Newton's method.
    pure real(xp) function momentum_root(q, r) result(y)
        real(xp), intent(in) :: q, r
        real(xp) :: u, x, left, right, step, e(0:last), o(0:last)
        integer :: n, iteration
        u = 1 - 2 * q**2
        y = 2 * r * u / (1 + sqrt(1 + 4 * q * r**2 * u))
        do iteration = 1, most_iterations
            x = y**2 + 2 * q
            e = linear_chain(x, q, 2.0_xp, x, last)
            o = linear_chain(x, q, y, y * (x + q), last)
            left = sum([((-1)**n * q**(2 * n**2 + n) * o(n), n=0, last)])
            right = r * (1 + sum([((-1)**n * q**(2 * n**2 - n) * e(n), n=1, last)]))
            step = (left - right) / (1 - 3 * q**3 * (y**2 + q) + 2 * q * r * y)
            y = y - step
            if (abs(step) <= 4 * epsilon(y) * abs(y)) exit
        end do
    end function momentum_root

    !> The argument z at which sn/cn is given: tan z = opposite B/(adjacent A), theta functions of z itself.
    pure real(xp) function argument_at_start(q, opposite, adjacent) result(z)
        real(xp), intent(in) :: q, opposite, adjacent
        real(xp) :: step
        integer :: iteration
        z = atan2(opposite, adjacent)
        do iteration = 1, most_iterations
            step = (z - atan2(opposite * sum_b(q, z), adjacent * sum_a(q, z))) / (1 + 4 * q**2 * sin(2 * z)**2)
            z = z - step
            if (abs(step) <= 4 * epsilon(z) * abs(z)) exit
        end do
    end function argument_at_start

    !> The period of the momentum in the body, s.
    pure real(xp) function circular_period(self) result(period)
        class(circular_series_t), intent(in) :: self
        period = 2 * pi_xp / self%rate
    end function circular_period

    !> Angle by which axis z turns about the momentum in a period, rad.
    pure real(xp) function circular_turn(self, steady) result(turn)
        class(circular_series_t), intent(in) :: self
        real(xp), intent(in) :: steady !! |L|/I_x, rad/s
        real(xp) :: above, below, g, small, o(0:last), x
        integer :: n
        g = (self%y + self%root) / 2
        small = 0
        if (g > 0) small = self%q / g
        x = self%y**2 + 2 * self%q
        o = linear_chain(x, self%q, self%y, self%y * (x + self%q), last)
        above = 0
        below = 0
        do n = 0, last
            above = above + (-1)**n * self%q**(2 * n**2 + n) &
                    * (2 * n * g**(2 * n + 1) + (2 * n + 2) * small**(2 * n + 1))
            below = below + (-1)**n * self%q**(2 * n**2 + n) * o(n)
        end do
        turn = self%period() * (steady + self%side * self%rate * (self%slope - above / below))
    end function circular_turn

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
        do n = last, 0, -1
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

end module spintop_free_circular_series
