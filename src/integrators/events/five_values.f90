!> Number of zeros of a function between five equidistant values: at most one, or possibly more.
!>
!> The parabola through the first, the middle and the last value is compared with the other two values. Its
!> errors there bound its errors elsewhere, with a margin, if the function is smooth on the scale of the
!> interval. If it is not, these errors are as large as the changes of the function.
module spintop_five_values
    use spintop_kinds, only: dp
    implicit none
    private
    public :: passes_at_most_once, root_between, rounding_of

    !> Margins for the errors of the parabola, and of its slope.
    real(dp), parameter :: margin = 4, slope_margin = 12
    !> Steps by Newton's method to the zero of a polynomial.
    integer, parameter :: newton_steps = 3

contains

    !> Whether the function has at most one zero in the interval: it is monotone, or it stays away from zero.
    !> False if a value is undefined.
    pure logical function passes_at_most_once(g)
        real(dp), intent(in) :: g(5) !! values at equal distances
        real(dp) :: slope, bend, missed, lowest

        ! g(3) + slope x + bend x^2, x = -1 .. 1
        slope = (g(5) - g(1)) / 2
        bend = (g(1) - g(3)) / 2 + (g(5) - g(3)) / 2
        missed = max(abs(g(2) - (g(3) - slope / 2 + bend / 4)), abs(g(4) - (g(3) + slope / 2 + bend / 4)))
        passes_at_most_once = abs(slope) - 2 * abs(bend) > slope_margin * missed
        if (passes_at_most_once) return
        if (.not. (all(g > 0) .or. all(g < 0))) return
        lowest = minval(abs(g))
        if (abs(slope) < 2 * abs(bend)) lowest = min(lowest, sign(1.0_dp, g(3)) * (g(3) - slope / bend * slope / 4))
        passes_at_most_once = lowest > margin * missed
    end function passes_at_most_once

    !> The zero, between two neighbours of the values, of the polynomial of degree 4 through all five: its place, and the
    !> slope there, both by the distance of two values.
    pure subroutine root_between(g, i, place, slope)
        real(dp), intent(in) :: g(5) !! values at the places 0, 1, 2, 3, 4
        integer, intent(in) :: i !! the zero lies between the values i and i + 1, which have opposite signs
        real(dp), intent(out) :: place, slope !! where it is; the slope
        real(dp) :: c(0:4), x, value
        integer :: n

        c(0) = g(3)
        c(1) = (8 * (g(4) - g(2)) - (g(5) - g(1))) / 12
        c(2) = (16 * (g(2) + g(4)) - (g(1) + g(5)) - 30 * g(3)) / 24
        c(3) = ((g(5) - g(1)) - 2 * (g(4) - g(2))) / 12
        c(4) = ((g(1) + g(5)) - 4 * (g(2) + g(4)) + 6 * g(3)) / 24
        x = i - 3 + g(i) / (g(i) - g(i + 1))
        do n = 1, newton_steps
            slope = c(1) + x * (2 * c(2) + x * (3 * c(3) + x * 4 * c(4)))
            value = c(0) + x * (c(1) + x * (c(2) + x * (c(3) + x * c(4))))
            x = min(max(x - value / slope, i - 3.0_dp), i - 2.0_dp)
        end do
        place = x + 2
    end subroutine root_between

    !> Bound of the rounding error of a function, from values so close together that the function is linear
    !> between them except for rounding errors: their fourth differences.
    pure real(dp) function rounding_of(values) result(bound)
        real(dp), intent(in) :: values(9) !! at equal distances
        real(dp) :: differences(5), lowest
        integer :: i, rank

        differences = abs(values(1:5) - 4 * values(2:6) + 6 * values(3:7) - 4 * values(4:8) + values(5:9))
        ! The median: a jump between two values affects only some of them.
        do rank = 1, 3
            i = minloc(differences, dim=1)
            lowest = differences(i)
            differences(i) = huge(1.0_dp)
        end do
        ! The fourth difference of independent errors e is sqrt(70) e. The error of a parabola due to them
        ! alone is less than the bound with its margin, so that no interval is too noisy for one test and not
        ! for the other.
        bound = max(8 * lowest, 16 * epsilon(1.0_dp) * maxval(abs(values)))
    end function rounding_of

end module spintop_five_values
