!> The side of its level on which the quantity of an event is, and the level that it aims at.
module spintop_level_side
    use spintop_compare, only: is_equal, is_finite
    use spintop_event, only: event_t
    use spintop_five_values, only: passes_at_most_once
    use spintop_kinds, only: dp, pi
    implicit none
    private
    public :: side_t, turns_far, sign_of

    !> The side of its level on which a quantity is.
    type :: side_t
        real(dp) :: level = huge(1.0_dp)
        !> 1 above, -1 below, 0 unknown; the time since which it is known, and the distance from the level
        !> then.
        integer :: sign = 0
        real(dp) :: t = 0, distance = 0
        !> Distance below which the side is unknown: the rounding error, where it was measured.
        real(dp) :: rounding = 0
        !> Largest distance at the instants of the interval.
        real(dp) :: farthest = 0
        !> Whether the quantity is at the level, and constant to rounding.
        logical :: is_constant = .false.
        !> Whether the quantity was beyond its noise since the last passage, and between that and the one before. If so, the
        !> next passage counts. Before it ever was, nothing passes: it is at its level, on no side.
        logical :: is_clear = .false., was_clear = .true., was_ever_clear = .false.
        !> Whether there was a passage that counts in the interval; how many passages were found before it.
        logical :: has_passed = .false.
        integer :: found_before = 0
    contains
        procedure :: aim
        procedure :: advance_if_staying
    end type side_t

    !> A start value so close to the level, relatively, is at the level.
    real(dp), parameter :: start_rounding = 16 * epsilon(1.0_dp)
    !> An angle that changes by more between two instants was not followed.
    real(dp), parameter :: farthest_turn = 1.5_dp * pi

contains

    !> Selects the level of the event for an interval: of several levels the one nearest to the quantity.
    pure subroutine aim(self, event, t, values)
        class(side_t), intent(inout) :: self
        type(event_t), intent(in) :: event !! the event
        real(dp), intent(in) :: t, values(5) !! beginning of the interval, s; the quantity at equal distances in it
        real(dp) :: level, middle
        integer :: i

        level = event%level
        middle = values(1) + (values(5) - values(1)) / 2
        if (event%every_turn .and. is_finite(middle)) level = level + 2 * pi * anint((middle - level) / (2 * pi))
        if (event%turn_by_turn) level = 2 * pi * (event%count + 1)
        if (.not. is_equal(level, self%level)) then
            self%level = level
            self%sign = 0
            self%t = t
            self%distance = values(1) - level
            self%rounding = 0
            if (abs(self%distance) > start_rounding * (abs(values(1)) + abs(level))) self%sign = sign_of(self%distance)
        end if
        self%farthest = -huge(1.0_dp)
        do i = 1, 5
            if (abs(values(i) - level) <= huge(1.0_dp)) self%farthest = max(self%farthest, abs(values(i) - level))
        end do
    end subroutine aim

    !> Whether the quantity surely stays on its side of the only level of the event in an interval; if it does, its end, at
    !> time b, is taken.
    pure subroutine advance_if_staying(self, event, b, values, stays)
        class(side_t), intent(inout) :: self
        type(event_t), intent(in) :: event !! the event
        real(dp), intent(in) :: b, values(5) !! s; the quantity at equal distances in the interval
        logical, intent(out) :: stays !! whether it does
        real(dp) :: distance(5)
        stays = .not. (event%every_turn .or. event%turn_by_turn .or. self%sign == 0)
        if (.not. stays) return
        distance = self%sign * (values - self%level)
        stays = min(distance(1), distance(2), distance(3), distance(4), distance(5)) > self%rounding
        if (stays) stays = passes_at_most_once(distance)
        if (.not. stays) return
        self%rounding = 0
        self%t = b
        self%distance = values(5) - self%level
    end subroutine advance_if_staying

    !> Whether an angle with turns changes too much between two instants to be followed.
    elemental logical function turns_far(event, before, after)
        type(event_t), intent(in) :: event !! the event
        real(dp), intent(in) :: before, after !! its quantity at the two instants
        turns_far = (event%every_turn .or. event%turn_by_turn) .and. abs(after - before) > farthest_turn
    end function turns_far

    !> 1 or -1.
    elemental integer function sign_of(x)
        real(dp), intent(in) :: x !! a number that is not zero
        sign_of = merge(1, -1, x > 0)
    end function sign_of

end module spintop_level_side
