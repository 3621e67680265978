!> Zeros of a function between five equidistant values: at most one, or possibly more.
!>
!> The parabola through the first, the middle and the last value is compared with the other two: what
!> it misses there bounds, with a margin, what it misses elsewhere, as long as the function is smooth on
!> the scale of the piece. Where it is not, what is missed is no smaller than the function changes.
module spintop_five_values
    use spintop_kinds, only: dp
    implicit none
    private
    public :: passes_at_most_once, rounding_of

    !> Margins on what the parabola misses, and on its slope.
    real(dp), parameter :: margin = 4, slope_margin = 12

contains

    !> Whether the function passes zero at most once on the piece: it is monotone, or stays away from
    !> zero. Not so where a value is undefined.
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

    !> Bound on the rounding of a function, from values so close together that it is linear between
    !> them but for rounding: their fourth differences.
    pure real(dp) function rounding_of(values) result(bound)
        real(dp), intent(in) :: values(9) !! at equal distances
        real(dp) :: differences(5), lowest
        integer :: i, rank

        differences = abs(values(1:5) - 4 * values(2:6) + 6 * values(3:7) - 4 * values(4:8) + values(5:9))
        ! Their median: a jump between two values is in some of them only.
        do rank = 1, 3
            i = minloc(differences, dim=1)
            lowest = differences(i)
            differences(i) = huge(1.0_dp)
        end do
        ! The fourth difference of independent errors e is sqrt(70) e. What a parabola misses of them alone is
        ! less than the bound with its margin, so that no piece is too noisy for the one and not for the other.
        bound = max(8 * lowest, 16 * epsilon(1.0_dp) * maxval(abs(values)))
    end function rounding_of

end module spintop_five_values
