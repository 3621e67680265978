!> Probabilities of Gaussian numbers: of each, of the sum of their squares, and of a mean over its estimated error; and by them
!> whether residuals are noise: whether each is like the one before or like others far from it, a period, a drift.
module spintop_probability
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: normal_quantile, chi_square_tail, student_quantile
    public :: von_neumann_ratio, find_correlation, find_period, find_drift

    !> Coefficients of the three rational approximations of `normal_quantile`: near the middle, in the tails, and far in the tails.
    real(dp), parameter :: top_middle(8) = [ &
        3.3871328727963666080e0_dp, 1.3314166789178437745e2_dp, 1.9715909503065514427e3_dp, 1.3731693765509461125e4_dp, &
        4.5921953931549871457e4_dp, 6.7265770927008700853e4_dp, 3.3430575583588128105e4_dp, 2.5090809287301226727e3_dp]
    real(dp), parameter :: bottom_middle(8) = [ &
        1.0_dp, 4.2313330701600911252e1_dp, 6.8718700749205790830e2_dp, 5.3941960214247511077e3_dp, &
        2.1213794301586595867e4_dp, 3.9307895800092710610e4_dp, 2.8729085735721942674e4_dp, 5.2264952788528545610e3_dp]
    real(dp), parameter :: top_tail(8) = [ &
        1.42343711074968357734e0_dp, 4.63033784615654529590e0_dp, 5.76949722146069140550e0_dp, 3.64784832476320460504e0_dp, &
        1.27045825245236838258e0_dp, 2.41780725177450611770e-1_dp, 2.27238449892691845833e-2_dp, 7.74545014278341407640e-4_dp]
    real(dp), parameter :: bottom_tail(8) = [ &
        1.0_dp, 2.05319162663775882187e0_dp, 1.67638483018380384940e0_dp, 6.89767334985100004550e-1_dp, &
        1.48103976427480074590e-1_dp, 1.51986665636164571966e-2_dp, 5.47593808499534494600e-4_dp, 1.05075007164441684324e-9_dp]
    real(dp), parameter :: top_far(8) = [ &
        6.65790464350110377720e0_dp, 5.46378491116411436990e0_dp, 1.78482653991729133580e0_dp, 2.96560571828504891230e-1_dp, &
        2.65321895265761230930e-2_dp, 1.24266094738807843860e-3_dp, 2.71155556874348757815e-5_dp, 2.01033439929228813265e-7_dp]
    real(dp), parameter :: bottom_far(8) = [ &
        1.0_dp, 5.99832206555887937690e-1_dp, 1.36929880922735805310e-1_dp, 1.48753612908506148525e-2_dp, &
        7.86869131145613259100e-4_dp, 1.84631831751005468180e-5_dp, 1.42151175831644588870e-7_dp, 2.04426310338993978564e-15_dp]

contains

    !> The value below which a standard normal variable lies with probability `p`, accurate to about 1e-16, by algorithm
    !> AS 241 (M. J. Wichura, Applied Statistics 37, 1988, 477-484); -huge and huge for p <= 0 and p >= 1.
    elemental real(dp) function normal_quantile(p) result(x)
        real(dp), intent(in) :: p !! a probability
        real(dp) :: centred, r

        centred = p - 0.5_dp
        if (abs(centred) <= 0.425_dp) then
            r = 0.180625_dp - centred**2
            x = centred * polynomial(top_middle, r) / polynomial(bottom_middle, r)
            return
        end if
        r = min(p, 1 - p)
        if (.not. r > 0) then
            x = sign(huge(x), centred)
            return
        end if
        r = sqrt(-log(r))
        if (r <= 5) then
            x = polynomial(top_tail, r - 1.6_dp) / polynomial(bottom_tail, r - 1.6_dp)
        else
            x = polynomial(top_far, r - 5) / polynomial(bottom_far, r - 5)
        end if
        x = sign(x, centred)
    end function normal_quantile

    !> A polynomial of degree 7, from the constant term.
    pure real(dp) function polynomial(coefficients, x)
        real(dp), intent(in) :: coefficients(8), x
        integer :: i
        polynomial = coefficients(8)
        do i = 7, 1, -1
            polynomial = polynomial * x + coefficients(i)
        end do
    end function polynomial

    !> The probability that a sum of squares of so many Gaussian numbers of deviation 1 exceeds a value: the incomplete gamma
    !> function Q(freedom/2, x/2), by its series or its continued fraction (Abramowitz and Stegun 6.5.29 and 6.5.31).
    pure real(dp) function chi_square_tail(x, freedom) result(tail)
        real(dp), intent(in) :: x !! the value, at least 0
        integer, intent(in) :: freedom !! degrees of freedom, at least 1
        real(dp) :: a, z, term, total, b, c, d, factor, scale
        integer :: i

        a = freedom / 2.0_dp
        z = x / 2
        tail = 1
        if (.not. z > 0) return
        scale = exp(a * log(z) - z - log_gamma(a))
        if (z < a + 1) then
            term = 1 / a
            total = term
            do i = 1, huge(i) - 1
                term = term * z / (a + i)
                total = total + term
                if (term <= epsilon(term) * total) exit
            end do
            tail = max(1 - scale * total, 0.0_dp)
        else ! by the method of Lentz
            b = z + 1 - a
            c = 1 / tiny(c)
            d = 1 / b
            total = d
            do i = 1, huge(i) - 1
                b = b + 2
                d = 1 / (b - i * (i - a) * d)
                c = b - i * (i - a) / c
                factor = c * d
                total = total * factor
                if (abs(factor - 1) <= 2 * epsilon(factor)) exit
            end do
            tail = scale * total
        end if
    end function chi_square_tail

    !> The quantile of Student's distribution: the value that is exceeded with the probability `tail`.
    pure real(dp) function student_quantile(tail, freedom) result(t)
        real(dp), intent(in) :: tail !! between 0 and 1/2
        integer, intent(in) :: freedom !! degrees of freedom, at least 1
        real(dp) :: low, high
        integer :: i

        low = 0
        high = 1
        do i = 1, 1000
            if (tail_of(high, freedom) <= tail) exit
            high = 2 * high
        end do
        do i = 1, 60
            t = (low + high) / 2
            if (tail_of(t, freedom) > tail) then
                low = t
            else
                high = t
            end if
        end do
    end function student_quantile

    !> The probability that Student's t exceeds a value: with t = sqrt(nu) tan(x) the density is in proportion to
    !> cos(x)^(nu - 1), whose integral is a finite sum (Abramowitz and Stegun 26.7.3 and 26.7.4).
    pure real(dp) function tail_of(t, freedom)
        real(dp), intent(in) :: t
        integer, intent(in) :: freedom
        real(dp) :: angle, term, total
        integer :: i, odd

        angle = atan2(t, sqrt(real(freedom, dp)))
        odd = mod(freedom, 2)
        term = merge(cos(angle), 1.0_dp, odd == 1)
        total = 0
        do i = 1 + odd, freedom - 1, 2
            total = total + term
            term = term * cos(angle)**2 * i / (i + 1)
        end do
        total = sin(angle) * total
        if (odd == 1) total = 2 / pi * (angle + total)
        tail_of = (1 - total) / 2
    end function tail_of

    !> The ratio of the mean square of the differences of neighbours to the mean square (von Neumann 1941): 2 for noise, with a
    !> standard deviation of 2/sqrt(m); 2 also where there are too few residuals, or none but 0.
    pure real(dp) function von_neumann_ratio(residuals) result(ratio)
        real(dp), intent(in) :: residuals(:) !! in the order of time
        real(dp) :: size_of_residuals
        integer :: m
        m = size(residuals)
        ratio = 2
        size_of_residuals = norm2(residuals)
        if (m < 3 .or. .not. size_of_residuals > 0) return
        ratio = (norm2(residuals(2:) - residuals(:m - 1)) / size_of_residuals)**2
    end function von_neumann_ratio

    !> The correlation of residuals over many rows, which the short memory of a sensor does not have, but the period of a motion
    !> that is not explained: by the statistic of Ljung and Box (1978) of far neighbours.
    pure subroutine find_correlation(residuals, bound, strength, probability)
        real(dp), intent(in) :: residuals(:) !! in the order of time
        real(dp), intent(in) :: bound !! beyond which a residual is cut
        real(dp), intent(out) :: strength !! root mean square of the correlations, 0 to 1
        real(dp), intent(out) :: probability !! that noise has these correlations
        integer, parameter :: nearest = 11, farthest = 50, part = 4
        real(dp) :: r(size(residuals)), correlation, total, squares
        integer :: k, m, first, last

        m = size(residuals)
        strength = 0
        probability = 1
        last = min(farthest, m / part)
        first = min(nearest, last / 2)
        if (first < 1) return
        r = max(-bound, min(residuals, bound))
        r = r - sum(r) / m
        squares = sum(r**2)
        if (.not. squares > 0) return
        total = 0
        do k = first, last
            correlation = dot_product(r(:m - k), r(1 + k:)) / squares
            total = total + correlation**2 * (m * (m + 2.0_dp) / (m - k))
            strength = strength + correlation**2
        end do
        strength = sqrt(strength / (last - first + 1))
        probability = chi_square_tail(total, last - first + 1)
    end subroutine find_correlation

    !> The period that stands out of residuals, by the periodogram for any times (Scargle 1982).
    pure subroutine find_period(t, residuals, period, amplitude, probability)
        real(dp), intent(in) :: t(:) !! increasing times, s
        real(dp), intent(in) :: residuals(:) !! the residuals
        real(dp), intent(out) :: period, amplitude !! s; in the unit of the residuals
        real(dp), intent(out) :: probability !! that noise has such a period
        integer, parameter :: most_terms = 4000000 ! of all sums
        real(dp) :: variance, rate, shift, power, highest, c(size(t)), s(size(t))
        integer :: i, m, rates

        m = size(t)
        period = 0
        amplitude = 0
        probability = 1
        variance = sum(residuals**2) / max(m, 1)
        if (m < 8 .or. .not. variance > 0) return
        rates = min(m / 2, most_terms / m + 1)
        highest = 0
        do i = 2, 2 * rates ! twice as close as independent rates
            rate = pi * i / (t(m) - t(1))
            shift = atan2(sum(sin(2 * rate * (t - t(1)))), sum(cos(2 * rate * (t - t(1))))) / 2
            c = cos(rate * (t - t(1)) - shift)
            s = sin(rate * (t - t(1)) - shift)
            power = (sum(residuals * c)**2 / sum(c**2) + sum(residuals * s)**2 / max(sum(s**2), tiny(power))) / (2 * variance)
            if (power <= highest) cycle
            highest = power
            period = 2 * pi / rate
            amplitude = 2 * sqrt(power * variance / m)
        end do
        probability = min(rates * exp(-highest), 1.0_dp)
    end subroutine find_period

    !> The drift of residuals: the change of the line through them over all times.
    pure subroutine find_drift(t, residuals, drift, significance)
        real(dp), intent(in) :: t(:) !! times, s
        real(dp), intent(in) :: residuals(:) !! the residuals
        real(dp), intent(out) :: drift !! in the unit of the residuals
        real(dp), intent(out) :: significance !! the drift in its standard errors
        real(dp) :: place(size(t)), slope, scatter
        integer :: m
        m = size(t)
        drift = 0
        significance = 0
        if (m < 4) return
        place = t - sum(t) / m
        slope = sum(place * residuals) / sum(place**2)
        scatter = sum((residuals - sum(residuals) / m - slope * place)**2) / (m - 2)
        drift = slope * (t(m) - t(1))
        if (scatter > 0) significance = abs(slope) * norm2(place) / sqrt(scatter)
    end subroutine find_drift

end module spintop_probability
