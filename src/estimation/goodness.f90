!> Whether residuals are noise: whether each is like the one before or like others far from
!> it, a period, a drift.
module spintop_goodness
    use spintop_kinds, only: dp, pi
    use spintop_probability, only: chi_square_tail
    implicit none
    private
    public :: von_neumann_ratio, find_correlation, find_period, find_drift

contains

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

end module spintop_goodness
