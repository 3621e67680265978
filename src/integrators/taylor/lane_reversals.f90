!> Lanes in which a drag may reverse within a step.
module spintop_lane_reversals
    use spintop_kinds, only: dp
    use spintop_lane_series, only: lanes
    implicit none
    private
    public :: find_reversals

contains

    !> Finds the lanes whose angular velocity, or velocity of the dragged centre of mass, turns by more than a right angle in
    !> half of the coming step, under a drag with cusps: it may reverse there, and the series goes on with the drag of the old
    !> direction.
    pure subroutine find_reversals(last, c, duration, r, reverses)
        integer, intent(in) :: last !! order of the series
        real(dp), contiguous, intent(in) :: c(:, :, 0:) !! their coefficients: lane, variable, order
        real(dp), intent(in) :: duration(lanes) !! coming step, s
        real(dp), intent(in) :: r(lanes, 3) !! centre of mass that is dragged, m; 0 if none is
        logical, intent(out) :: reverses(lanes) !! whether that happens
        !> Square of the sine of an angle between angular velocity and centre of mass that is lost in rounding.
        real(dp), parameter :: lost = 1.0e-13_dp
        real(dp) :: h, m1, m2, m3, e1, e2, e3, before, after, along, square
        integer :: k, i

        ! As in `terms_at` of spintop_lane_steps: scalar sums stay in registers.
        !$omp simd private(h, m1, m2, m3, e1, e2, e3, before, after, along, square, k)
        do i = 1, lanes
            h = duration(i)
            m1 = c(i, 1, last)
            m2 = c(i, 2, last)
            m3 = c(i, 3, last)
            e1 = m1
            e2 = m2
            e3 = m3
            do k = 1, max(last, 1)
                m1 = m1 * (h / 2) + c(i, 1, last - k)
                m2 = m2 * (h / 2) + c(i, 2, last - k)
                m3 = m3 * (h / 2) + c(i, 3, last - k)
                e1 = e1 * h + c(i, 1, last - k)
                e2 = e2 * h + c(i, 2, last - k)
                e3 = e3 * h + c(i, 3, last - k)
            end do
            before = m1 * c(i, 1, 0) + m2 * c(i, 2, 0) + m3 * c(i, 3, 0)
            after = m1 * e1 + m2 * e2 + m3 * e3
            reverses(i) = before < 0 .or. after < 0
            ! (w x r) . (w' x r) = (w . w') r^2 - (w . r) (w' . r)
            square = r(i, 1)**2 + r(i, 2)**2 + r(i, 3)**2
            along = m1 * r(i, 1) + m2 * r(i, 2) + m3 * r(i, 3)
            before = before * square - along * (c(i, 1, 0) * r(i, 1) + c(i, 2, 0) * r(i, 2) + c(i, 3, 0) * r(i, 3))
            after = after * square - along * (e1 * r(i, 1) + e2 * r(i, 2) + e3 * r(i, 3))
            reverses(i) = reverses(i) .or. min(before, after) < -lost * along**2
        end do
    end subroutine find_reversals

end module spintop_lane_reversals
