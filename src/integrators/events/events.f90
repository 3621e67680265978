!> Events of a motion: the instants at which quantities of it pass levels.
!>
!> A watch looks along the motion at instants so close that between two of them the attitude turns by
!> less than `largest_turn` (`spintop_instants`), and the axis whose poles matter (`pole_axis`) goes less
!> than that share of its distance from the vertical: Euler angles and their rates vary as fast as that
!> ratio. Between two instants each quantity is halved in time until a parabola shows that it is monotone, or away from its
!> level (`spintop_five_values`). So any number of passages between two instants is found. What is not: a
!> level touched and not passed, to the rounding of the quantity, which is measured where it matters; a
!> quantity that is equal to its level within rounding never passes it. The start itself is no event.
!>
!> Each evaluation counts as work: the search ends where the path allows no more.
module spintop_events
    use spintop_kinds, only: dp, pi
    use spintop_body, only: body_t
    use spintop_bracket, only: bracket_t
    use spintop_compare, only: is_equal, is_finite
    use spintop_five_values, only: passes_at_most_once, rounding_of
    use spintop_instants, only: is_short, next_instant
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_bad_events
    use spintop_passages, only: passages_t
    use spintop_path, only: path_t
    implicit none
    private
    public :: event_t, event_watch_t, path_t

    !> An event to look for, and the number of its occurrences.
    type :: event_t
        !> Name in tables.
        character(80) :: name = ''
        !> The quantity rises through the level (1) or falls through it (-1).
        integer :: direction = 1
        !> The value to pass, in the unit of the quantity.
        real(dp) :: level = 0
        !> The levels are `level` + 2 pi n, for every whole n.
        logical :: every_turn = .false.
        !> The levels are 2 pi, 4 pi, ..., each met once, the next when the one before was.
        logical :: turn_by_turn = .false.
        !> Events so far.
        integer :: count = 0
    end type event_t

    !> On which side of its level a quantity is.
    type :: side_t
        real(dp) :: level = huge(1.0_dp)
        !> 1 above, -1 below, 0 not known; since when it is known, and how far the quantity was.
        integer :: sign = 0
        real(dp) :: t = 0, distance = 0
        !> Nearer than this is on neither side: rounding, where it was measured.
        real(dp) :: rounding = 0
        logical :: is_measured = .false.
        !> Largest distance at the instants of the piece.
        real(dp) :: farthest = 0
    end type side_t

    !> Looks for events. What extends it says which quantities they are of, and what becomes of them.
    type, abstract :: event_watch_t
        !> What to look for: a quantity each.
        type(event_t), allocatable :: events(:)
        !> Set by `meet` to end the motion.
        logical :: has_enough = .false.
        !> Body axis by whose passages of the vertical quantities vary fast; zero if none does.
        real(dp) :: pole_axis(3) = 0
        !> Time up to which the motion was looked at, s: that of the event which ended it.
        real(dp) :: t = 0
        !> The motion then.
        type(motion_t) :: here
        !> The quantities then, and their sides.
        real(dp), allocatable, private :: values(:)
        type(side_t), allocatable, private :: sides(:)
        real(dp), private :: t_begin = 0, fall_rate = 0, soon = 0
    contains
        procedure(quantities), deferred :: quantities
        procedure(meet), deferred :: meet
        procedure :: check
        procedure :: begin
        procedure :: look
        procedure, private :: search
        procedure, private :: aim
        procedure, private :: refine
        procedure, private :: measure_rounding
        procedure, private :: take_side
        procedure, private :: find_root
        procedure, private :: value_at
    end type event_watch_t

    abstract interface
        !> The quantities of all events; where one is not finite no event of it is found.
        subroutine quantities(self, motion, values)
            import :: event_watch_t, motion_t, dp
            class(event_watch_t), intent(inout) :: self
            type(motion_t), intent(in) :: motion
            real(dp), intent(out) :: values(:)
        end subroutine quantities

        !> The motion at event `number` of the list, in rising order of time.
        subroutine meet(self, number, motion)
            import :: event_watch_t, motion_t
            class(event_watch_t), intent(inout) :: self
            integer, intent(in) :: number
            type(motion_t), intent(in) :: motion
        end subroutine meet
    end interface

    !> An event sooner after the start than this share of the time of a radian is the start, and a value this
    !> close to the level there, relatively, is at the level.
    real(dp), parameter :: start_share = 1.0e-9_dp, start_rounding = 16 * epsilon(1.0_dp)
    !> A piece halved so often has its rounding measured, over this share of the piece.
    integer, parameter :: rounding_depth = 8
    real(dp), parameter :: rounding_share = 2.0_dp**(-12)
    !> An angle that turns farther between two instants was not followed.
    real(dp), parameter :: farthest_turn = 1.5_dp * pi

contains

    !> `status_ok`, or `status_bad_events` if one has no direction or a level that is not finite.
    pure integer function check(self) result(status)
        class(event_watch_t), intent(in) :: self
        status = status_ok
        if (.not. allocated(self%events)) return
        if (.not. all(abs(self%events%direction) == 1 .and. is_finite(self%events%level))) status = status_bad_events
    end function check

    !> Begins at a motion of the body.
    subroutine begin(self, body, motion)
        class(event_watch_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        real(dp) :: arm(3)
        associate (r => body%centre_of_mass)
            arm = sqrt([r(2)**2 + r(3)**2, r(3)**2 + r(1)**2, r(1)**2 + r(2)**2])
        end associate
        ! The weight accelerates the body by less than the square of this.
        self%fall_rate = sqrt(norm2(body%mass * body%gravity * arm / body%inertia))
        self%t_begin = motion%t
        self%t = motion%t
        self%here = motion
        self%soon = start_share / max(norm2(motion%omega) + 2 * self%fall_rate, tiny(1.0_dp))
        self%has_enough = .false.
        if (.not. allocated(self%events)) allocate (self%events(0))
        self%events%count = 0
        if (allocated(self%values)) deallocate (self%values, self%sides)
        allocate (self%values(size(self%events)), self%sides(size(self%events)))
        call self%quantities(motion, self%values)
    end subroutine begin

    !> Looks at the path from where it was looked at last up to a time, or up to the event that ends
    !> the motion, or as far as the path allows.
    subroutine look(self, path, t)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(in) :: t
        type(motion_t) :: there
        real(dp) :: pace

        if (.not. t > self%t) return
        call path%at(t, there)
        ! A body that turns slowly at both ends may have fallen and risen between.
        pace = max(norm2(self%here%omega), norm2(there%omega)) + 2 * self%fall_rate
        do while (self%t < t .and. .not. self%has_enough)
            if (path%is_spent()) exit
            call self%search(path, next_instant(self%here, self%pole_axis, self%t, t, pace))
        end do
    end subroutine look

    !> Looks for passages from the instant looked at last to the next, `last` or sooner, and meets them
    !> in order. One so soon after the start is the start.
    subroutine search(self, path, last)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(in) :: last
        type(passages_t) :: found
        type(motion_t) :: motion, there
        real(dp) :: b, values(size(self%events), 5)
        integer :: k, i, before

        values(:, 1) = self%values
        b = last
        do
            call path%at(b, there)
            call self%quantities(there, values(:, 5))
            if (is_short(self%t, b) .or. .not. any(turns_far(self%events, values(:, 1), values(:, 5)))) exit
            if (path%is_spent()) return
            b = self%t + (b - self%t) / 2
        end do
        do i = 2, 4
            call path%at(self%t + (b - self%t) * (i - 1) / 4, motion)
            call self%quantities(motion, values(:, i))
        end do
        do k = 1, size(self%events)
            before = found%n
            call self%aim(path, k, b, values(k, :))
            call self%refine(path, k, self%t, b, values(k, :) - self%sides(k)%level, 0, found)
            call found%merge_from(before + 1)
        end do
        if (path%is_spent()) return
        do i = 1, found%n
            if (found%t(i) - self%t_begin <= self%soon) cycle
            call path%at(found%t(i), motion)
            k = found%event(i)
            self%events(k)%count = self%events(k)%count + 1
            call self%meet(k, motion)
            if (.not. self%has_enough) cycle
            self%t = found%t(i)
            self%here = motion
            return
        end do
        self%t = b
        self%here = there
        self%values = values(:, 5)
    end subroutine search

    !> Whether an angle whose turns matter turns too far between two instants to be followed.
    elemental logical function turns_far(event, before, after)
        type(event_t), intent(in) :: event
        real(dp), intent(in) :: before, after
        turns_far = (event%every_turn .or. event%turn_by_turn) .and. abs(after - before) > farthest_turn
    end function turns_far

    !> Chooses the level of event `k` for the piece that ends at `b`: of many the one next to the
    !> quantity, whose five values are given.
    subroutine aim(self, path, k, b, values)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: b, values(5)
        real(dp) :: level, middle

        associate (event => self%events(k), side => self%sides(k))
            level = event%level
            middle = values(1) + (values(5) - values(1)) / 2
            if (event%every_turn .and. is_finite(middle)) level = level + 2 * pi * anint((middle - level) / (2 * pi))
            if (event%turn_by_turn) level = 2 * pi * (event%count + 1)
            if (.not. is_equal(level, side%level)) then
                side = side_t(level=level, t=self%t, distance=values(1) - level)
                if (abs(side%distance) > start_rounding * (abs(values(1)) + abs(level))) then
                    side%sign = sign_of(side%distance)
                end if
            end if
            side%farthest = maxval(abs(values - level), mask=is_finite(values))
            side%is_measured = .false.
            if (any(abs(values - level) <= side%rounding)) then
                call self%measure_rounding(path, k, b)
            else
                side%rounding = 0
            end if
        end associate
    end subroutine aim

    !> Divides the piece from `a` to `b` until the quantity of event `k` passes its level at most once in
    !> each part, and takes them in order. `g` is how far it is from the level at five instants.
    recursive subroutine refine(self, path, k, a, b, g, depth, found)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k, depth
        real(dp), intent(in) :: a, b, g(5)
        type(passages_t), intent(inout) :: found
        real(dp) :: quarter

        if (path%is_spent()) return
        if (depth == rounding_depth .and. .not. self%sides(k)%is_measured) call self%measure_rounding(path, k, b)
        if (passes_at_most_once(g) .or. is_short(a, b) .or. .not. any(is_finite(g)) &
            .or. all(abs(g) <= self%sides(k)%rounding)) then
            call self%take_side(path, k, b, g(5), found)
            return
        end if
        quarter = (b - a) / 4
        call self%refine(path, k, a, a + 2 * quarter, [g(1), distance_at(0.5_dp), g(2), distance_at(1.5_dp), g(3)], &
                         depth + 1, found)
        call self%refine(path, k, a + 2 * quarter, b, [g(3), distance_at(2.5_dp), g(4), distance_at(3.5_dp), g(5)], &
                         depth + 1, found)

    contains

        real(dp) function distance_at(quarters)
            real(dp), intent(in) :: quarters
            distance_at = self%value_at(path, k, a + quarters * quarter) - self%sides(k)%level
        end function distance_at

    end subroutine refine

    !> Measures the rounding of the quantity of event `k` at the begin of the piece that ends at `b`.
    subroutine measure_rounding(self, path, k, b)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: b
        real(dp) :: values(9), gap
        integer :: i

        associate (side => self%sides(k), a => self%t)
            side%is_measured = .true.
            side%rounding = 0
            gap = max(rounding_share * (b - a), 2 * spacing(max(abs(a), abs(b))))
            if (8 * gap > b - a) return
            do i = 1, 9
                values(i) = self%value_at(path, k, a + gap * (i - 1))
            end do
            if (all(is_finite(values))) side%rounding = rounding_of(values)
        end associate
    end subroutine measure_rounding

    !> Takes the side of the level on which the quantity of event `k` is at a time; if it is another than
    !> before, there is a passage between.
    subroutine take_side(self, path, k, t, distance, found)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: t, distance
        type(passages_t), intent(inout) :: found
        integer :: new_sign

        associate (side => self%sides(k))
            if (.not. is_finite(distance)) then
                side%sign = 0
                return
            end if
            if (.not. abs(distance) > side%rounding) return
            new_sign = sign_of(distance)
            if (side%sign == -new_sign .and. self%events(k)%direction == new_sign) then
                call self%find_root(path, k, t, distance, found)
            end if
            side%sign = new_sign
            side%t = t
            side%distance = distance
        end associate
    end subroutine take_side

    !> Adds the passage of event `k` between the instant at which its side was known last and `b`, where
    !> it is another, to those found; a jump to and from infinity is none.
    subroutine find_root(self, path, k, b, distance, found)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: b, distance
        type(passages_t), intent(inout) :: found
        type(bracket_t) :: bracket
        real(dp) :: value

        associate (side => self%sides(k))
            call bracket%begin(side%t, side%distance, b, distance, spacing(max(abs(side%t), abs(b))))
            do while (.not. bracket%found)
                value = self%value_at(path, k, bracket%trial)
                if (.not. is_finite(value)) return
                call bracket%take(value - side%level)
            end do
            if (abs(bracket%residual) > 2 * side%farthest) return
        end associate
        call found%add(k, max(bracket%trial, self%t))
    end subroutine find_root

    !> The quantity of event `k` at a time.
    real(dp) function value_at(self, path, k, t) result(value)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: t
        type(motion_t) :: motion
        real(dp) :: values(size(self%events))
        call path%at(t, motion)
        call self%quantities(motion, values)
        value = values(k)
    end function value_at

    !> 1 or -1.
    elemental integer function sign_of(x)
        real(dp), intent(in) :: x
        sign_of = merge(1, -1, x > 0)
    end function sign_of

end module spintop_events
