!> Number of zeros of a function between five equidistant values: at most one, or possibly more.
!>
!> The parabola through the first, the middle and the last value is compared with the other two values. Its
!> errors there bound its errors elsewhere, with a margin, if the function is smooth on the scale of the
!> interval. If it is not, these errors are as large as the changes of the function.
module spintop_five_values
    use spintop_kinds, only: dp
    implicit none
    private
    public :: passes_at_most_once, rounding_of

    !> Margins for the errors of the parabola, and of its slope.
    real(dp), parameter :: margin = 4, slope_margin = 12

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
