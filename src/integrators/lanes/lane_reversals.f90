!> Lanes in which a drag may reverse within a step, so that its series would go on with the drag of the old direction.
module spintop_lane_reversals
    use spintop_kinds, only: dp
    use spintop_lane_series, only: lanes, rows
    use spintop_motions, only: instants
    implicit none
    private
    public :: find_reversals, end_before_reversals

    !> A step is halved so often before a reversal, at the most; and once more.
    integer, parameter :: most_halvings = 30

contains

    !> Finds the lanes whose angular velocity turns by more than a right angle in half of the coming step.
    pure subroutine find_reversals(order, c, duration, reverses)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order) !! their coefficients: lane, variable, order
        real(dp), intent(in) :: duration(lanes) !! coming step, s
        logical, intent(out) :: reverses(lanes) !! whether that happens
        real(dp) :: middle(lanes, 3), last(lanes, 3)

        call find_rates(order, c, duration / 2, middle)
        call find_rates(order, c, duration, last)
        reverses = product_of(middle, c(:, 1:3, 0)) < 0 .or. product_of(middle, last) < 0
    end subroutine find_reversals

    !> Ends the coming step of lanes before the velocity of a dragged centre of mass turns by more than a right angle in an eighth
    !> of it. A motion that passes such a point at a distance goes on by short steps.
    pure subroutine end_before_reversals(order, c, r, duration, reverses)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order) !! their coefficients: lane, variable, order
        real(dp), intent(in) :: r(lanes, 3) !! centre of mass that is dragged, m; 0 if none is
        real(dp), intent(inout) :: duration(lanes) !! coming step, s
        logical, intent(out) :: reverses(lanes) !! lanes in which no step is short enough
        logical :: is_halved(lanes)
        integer :: i

        is_halved = .false.
        do i = 0, most_halvings
            call find_turns(order, c, duration, r, reverses)
            if (.not. any(reverses)) exit
            is_halved = is_halved .or. reverses
            where (reverses) duration = duration / 2
        end do
        where (is_halved) duration = duration / 2
    end subroutine end_before_reversals

    !> Whether the velocity of a dragged centre of mass turns so much.
    pure subroutine find_turns(order, c, duration, r, turns)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order)
        real(dp), intent(in) :: duration(lanes), r(lanes, 3)
        logical, intent(out) :: turns(lanes)
        !> Square of the sine of an angle between angular velocity and centre of mass that is lost in rounding.
        real(dp), parameter :: lost = 1.0e-26_dp
        real(dp) :: w(lanes, 3), v(lanes, 3), before(lanes, 3), least(lanes)
        integer :: k

        w = c(:, 1:3, 0)
        before = cross_of(w, r)
        least = -lost * product_of(w, w) * product_of(r, r)
        turns = .false.
        do k = 1, instants
            call find_rates(order, c, duration * k / instants, w)
            v = cross_of(w, r)
            turns = turns .or. product_of(v, before) < least
            before = v
        end do
    end subroutine find_turns

    !> The angular velocities after some time.
    pure subroutine find_rates(order, c, h, w)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order)
        real(dp), intent(in) :: h(lanes)
        real(dp), intent(out) :: w(lanes, 3)
        real(dp) :: w1, w2, w3
        integer :: i, k
        ! As in `terms_at` of spintop_lane_steps: scalar sums stay in registers.
        !$omp simd private(w1, w2, w3, k)
        do i = 1, lanes
            w1 = c(i, 1, order)
            w2 = c(i, 2, order)
            w3 = c(i, 3, order)
            do k = 1, max(order, 1)
                w1 = w1 * h(i) + c(i, 1, order - k)
                w2 = w2 * h(i) + c(i, 2, order - k)
                w3 = w3 * h(i) + c(i, 3, order - k)
            end do
            w(i, 1) = w1
            w(i, 2) = w2
            w(i, 3) = w3
        end do
    end subroutine find_rates

    pure function product_of(a, b) result(product)
        real(dp), intent(in) :: a(lanes, 3), b(lanes, 3)
        real(dp) :: product(lanes)
        product = a(:, 1) * b(:, 1) + a(:, 2) * b(:, 2) + a(:, 3) * b(:, 3)
    end function product_of

    pure function cross_of(a, b) result(product)
        real(dp), intent(in) :: a(lanes, 3), b(lanes, 3)
        real(dp) :: product(lanes, 3)
        product(:, 1) = a(:, 2) * b(:, 3) - a(:, 3) * b(:, 2)
        product(:, 2) = a(:, 3) * b(:, 1) - a(:, 1) * b(:, 3)
        product(:, 3) = a(:, 1) * b(:, 2) - a(:, 2) * b(:, 1)
    end function cross_of

end module spintop_lane_reversals
