!> Probabilities of Gaussian numbers: of the sum of their squares, and of a mean over its estimated error.
module spintop_probability
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: chi_square_tail, student_quantile

contains

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
        integer :: i

        angle = atan2(t, sqrt(real(freedom, dp)))
        total = 0
        if (mod(freedom, 2) == 1) then
            term = cos(angle)
            do i = 2, freedom - 1, 2
                total = total + term
                term = term * cos(angle)**2 * i / (i + 1)
            end do
            total = 2 / pi * (angle + sin(angle) * total)
        else
            term = 1
            do i = 1, freedom - 1, 2
                total = total + term
                term = term * cos(angle)**2 * i / (i + 1)
            end do
            total = sin(angle) * total
        end if
        tail_of = (1 - total) / 2
    end function tail_of

end module spintop_probability
