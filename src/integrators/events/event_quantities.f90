!> The quantities of events, whose passages through levels are searched for: their values along a path.
module spintop_event_quantities
    use spintop_bracket, only: bracket_t
    use spintop_compare, only: is_equal, is_finite
    use spintop_event, only: event_t
    use spintop_instants, only: is_short
    use spintop_kinds, only: dp
    use spintop_level_side, only: side_t, sign_of, turns_far
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t
    use spintop_five_values, only: root_between, rounding_of
    use spintop_path, only: path_t
    use spintop_status, only: is_ok
    implicit none
    private
    public :: event_quantities_t

    !> Quantities of a motion, one for each event. An extension defines them.
    type, abstract :: event_quantities_t
        !> The events to search for, with one quantity each.
        type(event_t), allocatable :: events(:)
        !> Whether a quantity takes the angles or their rates from the motion; otherwise they are not computed there.
        logical :: needs_angles = .true.
        !> Whether `quantities_of_several` gives all quantities; then none needs the angles.
        logical :: takes_several = .false.
        !> Workspace.
        real(dp), allocatable :: one(:)
        !> The motion at the instants that were computed last at once, and the quantities.
        type(motions_t), private :: ahead
        real(dp), allocatable, private :: several(:, :)
    contains
        procedure(quantities), deferred :: quantities
        procedure :: quantities_of_several
        procedure :: begin_quantities
        procedure :: value_at
        procedure :: find_passage
        procedure :: find_quarters
        procedure :: measure_rounding
    end type event_quantities_t

    integer, parameter :: half = instants / 2
    !> The rounding error is measured over this fraction of an interval.
    real(dp), parameter :: rounding_share = 2.0_dp**(-12)

    !> A correction of a time by more than this fraction of what it is known to does not converge.
    real(dp), parameter :: convergent = 0.05_dp
    !> Largest number of corrections, and the margin for the error of the last.
    integer, parameter :: most_corrections = 5
    real(dp), parameter :: margin = 16
    !> Times so few spacings apart have no polynomial between them.
    real(dp), parameter :: fewest_spacings = 4096

    abstract interface
        !> The quantities of all events. While a quantity is not finite, its events are not found.
        subroutine quantities(self, motion, values)
            import :: event_quantities_t, motion_t, dp
            class(event_quantities_t), intent(inout) :: self
            type(motion_t), intent(in) :: motion !! the motion at an instant
            real(dp), intent(out) :: values(:) !! one value for each event
        end subroutine quantities
    end interface

contains

    !> The quantities at several instants: what an extension that sets `takes_several` overrides.
    subroutine quantities_of_several(self, motions, values)
        class(event_quantities_t), intent(inout) :: self
        type(motions_t), intent(in) :: motions !! the motion at several instants
        real(dp), intent(out) :: values(:, :) !! a column for each event
        integer :: i
        do i = 1, instants
            call self%quantities(motions%motion(i), self%one)
            values(i, :) = self%one
        end do
    end subroutine quantities_of_several

    !> Makes room for the quantities of the events, and forgets what was known.
    subroutine begin_quantities(self)
        class(event_quantities_t), intent(inout) :: self
        if (allocated(self%one)) deallocate (self%one, self%several)
        allocate (self%one(size(self%events)), self%several(instants, size(self%events)))
        self%ahead%t = -huge(1.0_dp)
    end subroutine begin_quantities

    !> The quantity of event `k` at a time.
    real(dp) function value_at(self, path, k, t) result(value)
        class(event_quantities_t), intent(inout) :: self
        class(path_t), intent(inout) :: path !! the motion
        integer, intent(in) :: k !! number of the event
        real(dp), intent(in) :: t !! time, s
        type(motion_t) :: motion
        call path%motion_at(t, self%needs_angles, motion)
        call self%quantities(motion, self%one)
        value = self%one(k)
    end function value_at

    !> The time at which event `k` passes its level, between the instant at which its side was last known and the last of five
    !> equidistant ones, where the side differs. A jump from and to infinity is not a passage.
    subroutine find_passage(self, path, k, side, a, b, g, t, is_found)
        class(event_quantities_t), intent(inout) :: self
        class(path_t), intent(inout) :: path !! the motion
        integer, intent(in) :: k !! number of the event
        type(side_t), intent(in) :: side !! its level, and its side of it before
        real(dp), intent(in) :: a, b, g(5) !! first and last time, s; distances from the level at the five
        real(dp), intent(out) :: t !! the time of the passage, s
        logical, intent(out) :: is_found !! whether it is one
        type(bracket_t) :: bracket
        real(dp) :: before(2)
        integer :: i, last

        last = 0
        do i = 1, 4
            if (.not. abs(g(i)) > side%rounding) cycle
            if (sign_of(g(i)) == -side%sign) exit
            last = i
        end do
        is_found = last > 0 .and. last == i - 1
        if (is_found) call find_near(self, path, k, side%level, a, b, g, last, t, is_found)
        if (is_found) return
        before = [side%t, side%distance]
        if (last > 0) before = [a + (b - a) * (last - 1) / 4, g(last)]
        call bracket%begin(before(1), before(2), a + (b - a) * (i - 1) / 4, g(i), spacing(max(abs(side%t), abs(b))))
        do while (.not. bracket%found)
            call bracket%add_value(self%value_at(path, k, bracket%trial) - side%level)
        end do
        t = bracket%trial
        is_found = is_ok(bracket%status) .and. abs(bracket%residual) <= 2 * side%farthest
    end subroutine find_passage

    !> The time at which event `k` passes its level between the times i and i + 1 of five equidistant ones: the zero of the
    !> polynomial through the distances from the level, corrected by values of the quantity and the slope of the polynomial. How
    !> much smaller each correction is than the one before tells its error. Not found where they do not converge.
    subroutine find_near(self, path, k, level, a, b, g, i, t, is_found)
        class(event_quantities_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k, i
        real(dp), intent(in) :: level, a, b, g(5)
        real(dp), intent(out) :: t
        logical, intent(out) :: is_found
        real(dp) :: place, slope, width, last, change
        integer :: n

        width = (b - a) / 4
        last = 1
        is_found = .false.
        if (width <= fewest_spacings * spacing(max(abs(a), abs(b)))) return
        call root_between(g, i, place, slope)
        if (.not. (place >= i - 1 .and. place <= i)) return
        do n = 1, most_corrections
            t = a + width * place
            change = -(self%value_at(path, k, t) - level) / slope
            if (.not. abs(change) <= convergent * last) return
            place = min(max(place + change, i - 1.0_dp), real(i, dp))
            is_found = margin * width * abs(change) * (abs(change) / last) <= spacing(max(abs(a), abs(b)))
            if (is_found) exit
            last = abs(change)
        end do
        t = a + width * place
    end subroutine find_near

    !> The quantities at the quarters of the time from `a` to `b`, where those at `a` are known, and the motion at `b`, which is
    !> moved to an earlier time up to which no angle turns too far.
    subroutine find_quarters(self, path, a, b, limit, values, last, motion_last)
        class(event_quantities_t), intent(inout) :: self
        class(path_t), intent(inout) :: path !! the motion
        real(dp), intent(in) :: a, limit !! beginning of the interval, and the latest time to look at, s
        real(dp), intent(inout) :: b !! end of the interval, which may be moved, s
        real(dp), intent(inout) :: values(:, :) !! a row for each event
        type(motion_t), intent(out) :: last !! the motion at `b`
        type(motion_t), intent(in), optional :: motion_last !! the motion at `b`, if known
        type(motion_t) :: motion
        integer :: i

        if (self%takes_several) then
            call find_ahead(self, path, a, b, limit, values(:, 2:), last)
            return
        end if
        if (present(motion_last)) last = motion_last
        if (.not. present(motion_last)) call path%motion_at(b, self%needs_angles, last)
        do
            call self%quantities(last, values(:, 5))
            if (is_short(a, b) .or. .not. any(turns_far(self%events, values(:, 1), values(:, 5)))) exit
            if (path%is_spent()) return
            b = a + (b - a) / 2
            call path%motion_at(b, self%needs_angles, last)
        end do
        do i = 2, 4
            call path%motion_at(a + (b - a) * (i - 1) / 4, self%needs_angles, motion)
            call self%quantities(motion, values(:, i))
        end do
    end subroutine find_quarters

    !> The same without angles, by the same instructions for all, as for as long a time after `b`, if it ends before `limit`: these
    !> are kept for the next call. It moves `b` to the end of that time if this is not much earlier.
    subroutine find_ahead(self, path, a, b, limit, values, last)
        class(event_quantities_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(in) :: a, limit
        real(dp), intent(inout) :: b
        real(dp), intent(out) :: values(:, :)
        type(motion_t), intent(out) :: last
        real(dp) :: t(instants), slack
        integer :: first, i

        slack = 4 * spacing(limit)
        t = self%ahead%t
        if (is_equal(t(half), a) .and. t(instants) <= b + slack .and. t(instants) - a > 0.7_dp * (b - a)) then
            first = half + 1
            b = t(instants)
        else
            first = 1
            t(instants) = b
            if (b + (b - a) <= limit + slack) t(instants) = b + (b - a)
            if (t(instants) >= limit - slack) t(instants) = limit
            do i = 1, half - 1
                t(i) = a + (b - a) * i / half
                t(half + i) = b + (t(instants) - b) * i / half
            end do
            t(half) = b
            call path%at_several(t, merge(instants, half, t(instants) > b), self%ahead)
            call self%quantities_of_several(self%ahead, self%several)
        end if
        do i = 1, half
            values(:, i) = self%several(first - 1 + i, :)
        end do
        last = self%ahead%motion(first - 1 + half)
    end subroutine find_ahead

    !> Measures the rounding error of the quantity of event `k` at the beginning of the interval from `a` to `b`. It may be
    !> larger there than where it was measured before: near a pole it varies by orders of magnitude.
    subroutine measure_rounding(self, path, k, a, b, rounding)
        class(event_quantities_t), intent(inout) :: self
        class(path_t), intent(inout) :: path !! the motion
        integer, intent(in) :: k !! number of the event
        real(dp), intent(in) :: a, b !! ends of the interval, s
        real(dp), intent(inout) :: rounding !! the largest that was measured
        real(dp) :: values(9), gap
        integer :: i

        gap = max(rounding_share * (b - a), 2 * spacing(max(abs(a), abs(b))))
        if (8 * gap > b - a) return
        do i = 1, 9
            values(i) = self%value_at(path, k, a + gap * (i - 1))
        end do
        if (all(is_finite(values))) rounding = max(rounding, rounding_of(values))
    end subroutine measure_rounding

end module spintop_event_quantities
