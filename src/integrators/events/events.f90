!> Events of a motion: the instants at which quantities of it pass levels.
!>
!> The motion is evaluated at instants so close that between two of them the attitude turns by less than `largest_turn`
!> (`spintop_instants`), and the axis whose poles matter (`pole_axis`) moves by less than that fraction of its distance from
!> the vertical, because Euler angles and their rates vary on this scale. Each interval is halved until a parabola shows that
!> the quantity is monotone, or does not reach its level (`spintop_five_values`). Any number of passages between two instants
!> is therefore found. The following are not events: a level that is touched and not passed, to the rounding error of the
!> quantity, which is measured where it matters; passages of one that equals its level within rounding errors; the start.
!> Each evaluation counts as work; the search ends when the path allows no more.
module spintop_events
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_compare, only: is_equal, is_finite
    use spintop_constancy, only: find_constant, find_noise, margin, rounding_distance
    use spintop_event, only: event_t, occasion_none
    use spintop_event_quantities, only: event_quantities_t
    use spintop_five_values, only: passes_at_most_once
    use spintop_instants, only: greatest_fall_rate, is_short, next_instant, time_of_start
    use spintop_level_side, only: side_t, sign_of
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_bad_events
    use spintop_passages, only: passages_t
    use spintop_path, only: path_t
    implicit none
    private
    public :: event_t, event_search_t, path_t

    !> Searches for events. An extension defines the quantities, and what happens at an event.
    type, extends(event_quantities_t), abstract :: event_search_t
        !> Set by `handle_event` to end the motion.
        logical :: has_enough = .false.
        !> The search ends where one of the events has happened so often, or where there is no memory for those
        !> found: then the search is full.
        integer :: most_events = huge(1)
        logical :: is_full = .false.
        !> Whether phi and psi count their turns up to events; otherwise they are the values nearest to those of the start.
        logical :: needs_turns = .true.
        !> How far the motion may be from that without errors of the method, relatively; 0 if there are none.
        real(dp) :: method_noise = 0
        !> Body axis near whose passages of the vertical the quantities vary fast; zero if there is none.
        real(dp) :: pole_axis(3) = 0
        !> Time up to which the motion was searched, s: that of the event that ended it.
        real(dp) :: t = 0
        !> For `handle_event`: the work of effects from the start to the event, by its parts, J.
        real(dp) :: work(works) = 0
        !> The motion at that time; if `needs_angles`, with the angles and their rates.
        type(motion_t) :: here
        !> The quantities at that time, and their sides.
        real(dp), allocatable, private :: values(:)
        !> The motion at the end of the interval that is searched, and the noise of the quantities there, once it is known.
        type(motion_t), private :: there
        real(dp), allocatable, private :: noise(:)
        logical, private :: knows_noise = .false.
        !> Workspace: the quantities at five instants.
        real(dp), allocatable, private :: five(:, :)
        type(side_t), allocatable, private :: sides(:), sides_before(:)
        real(dp), private :: t_begin = 0, fall_rate = 0, soon = 0
    contains
        procedure(handle_event), deferred :: handle_event
        procedure :: handle_doubtful_event
        procedure :: check
        procedure :: begin
        procedure :: judge
        procedure :: find_events
        procedure :: knows
        procedure :: record_occasion
    end type event_search_t

    abstract interface
        !> Called at event `number` of the list, in increasing order of time.
        subroutine handle_event(self, number, motion)
            import :: event_search_t, motion_t
            class(event_search_t), intent(inout) :: self
            integer, intent(in) :: number !! index of the event in `events`
            type(motion_t), intent(in) :: motion !! the motion at the event
        end subroutine handle_event
    end interface

    !> Each time after so many halvings of an interval the rounding error is measured.
    integer, parameter :: rounding_depth = 8

contains

    !> `status_ok`, or `status_bad_events` if an event has another direction than -1, 0 or 1, or a level that is not finite.
    pure integer function check(self) result(status)
        class(event_search_t), intent(in) :: self
        status = status_ok
        if (.not. allocated(self%events)) return
        if (.not. all(abs(self%events%direction) <= 1 .and. is_finite(self%events%level))) status = status_bad_events
    end function check

    !> Called at a passage that does not count, because the quantity was within its noise since the one before.
    subroutine handle_doubtful_event(self, number, motion)
        class(event_search_t), intent(inout) :: self
        integer, intent(in) :: number !! index of the event in `events`
        type(motion_t), intent(in) :: motion !! the motion at the passage
    end subroutine handle_doubtful_event

    !> Begins at a motion of the body.
    subroutine begin(self, body, motion)
        class(event_search_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! the motion at the start
        integer :: i
        self%fall_rate = greatest_fall_rate(body)
        self%t_begin = motion%t
        self%t = motion%t
        self%here = motion
        self%soon = time_of_start(body, motion)
        self%has_enough = .false.
        self%is_full = .false.
        if (.not. allocated(self%events)) allocate (self%events(0))
        self%events%count = 0
        if (allocated(self%values)) deallocate (self%values, self%noise, self%sides, self%sides_before, self%five)
        i = size(self%events)
        allocate (self%values(i), self%noise(i), self%sides(i), self%sides_before(i), self%five(i, 5))
        call self%begin_quantities()
        call self%quantities(motion, self%values)
    end subroutine begin

    !> Judges which quantities are constant at their levels, and then have no events: after `begin`, of a motion of that body.
    subroutine judge(self, body, motion)
        class(event_search_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! the motion at the start
        call find_constant(self, body, motion, self%sides%is_constant)
    end subroutine judge

    !> Searches the path from the last instant to a time, or to the event that ends the motion, or as far as
    !> the path allows.
    subroutine find_events(self, path, t)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path !! the motion, which is evaluated as far as needed
        real(dp), intent(in) :: t !! time, s
        type(motion_t) :: there
        real(dp) :: pace, next
        logical :: knows_end

        if (all(self%events%occasion /= occasion_none)) self%t = max(self%t, t) ! no quantity is sought
        if (.not. t > self%t) return
        knows_end = .false.
        pace = path%greatest_rate
        if (.not. pace > 0) then
            knows_end = .not. self%takes_several
            call path%motion_at(t, self%needs_angles, there)
            ! A body that rotates slowly at both ends may have fallen and risen in between.
            pace = max(norm2(self%here%omega), norm2(there%omega)) + self%fall_rate * min(2.0_dp, self%fall_rate * (t - self%t))
        end if
        do while (self%t < t .and. .not. self%has_enough)
            if (path%is_spent() .or. self%is_full) exit
            next = next_instant(self%here, self%pole_axis, self%t, t, pace)
            if (knows_end .and. is_equal(next, t)) then
                call search(self, path, next, t, there)
            else
                call search(self, path, next, t)
            end if
        end do
    end subroutine find_events

    !> Whether an occasion is one of the events.
    pure logical function knows(self, occasion)
        class(event_search_t), intent(in) :: self
        integer, intent(in) :: occasion !! one of those of `spintop_event`
        knows = any(self%events%occasion == occasion)
    end function knows

    !> Records the events of an occasion, at the motion at that instant.
    subroutine record_occasion(self, occasion, motion, work)
        class(event_search_t), intent(inout) :: self
        integer, intent(in) :: occasion !! one of those of `spintop_event`
        type(motion_t), intent(in) :: motion !! the motion then
        real(dp), intent(in) :: work(works) !! the work of effects from the start to then, J
        integer :: k
        if (motion%t - self%t_begin <= self%soon) return
        self%work = work
        do k = 1, size(self%events)
            if (self%events(k)%occasion /= occasion) cycle
            self%is_full = self%events(k)%count >= self%most_events
            if (self%is_full) return
            self%events(k)%count = self%events(k)%count + 1
            call self%handle_event(k, motion)
        end do
        if (.not. self%has_enough) return
        self%t = motion%t
        self%here = motion
    end subroutine record_occasion

    !> Searches for passages from the last instant to the next one, `last` or earlier, and handles them in order. An event very
    !> soon after the start is the start. `motion_last` is the motion at `last`, if known.
    subroutine search(self, path, last, limit, motion_last)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(in) :: last, limit
        type(motion_t), intent(in), optional :: motion_last
        type(passages_t) :: found
        type(motion_t) :: motion
        real(dp) :: b
        integer :: k, i

        self%five(:, 1) = self%values
        b = last
        self%sides_before(:) = self%sides
        call find_passages(self, path, b, limit, found, motion_last)
        if (any(self%sides%has_passed .and. .not. self%sides%is_clear) .and. .not. is_short(self%t, b)) then
            ! One that may only touch its level: an interval that ends elsewhere shows both passages, or neither.
            self%sides(:) = self%sides_before
            found%n = 0
            b = self%t + (b - self%t) / 2
            call find_passages(self, path, b, limit, found)
        end if
        self%is_full = found%is_full
        if (path%is_spent() .or. self%is_full) return
        do i = 1, found%n
            if (found%t(i) - self%t_begin <= self%soon) cycle
            call path%at(found%t(i), motion)
            self%work = path%work_until(found%t(i))
            k = found%event(i)
            if (k < 0) call self%handle_doubtful_event(-k, motion)
            if (k < 0) cycle
            self%is_full = self%events(k)%count >= self%most_events
            if (self%is_full) return
            self%events(k)%count = self%events(k)%count + 1
            call self%handle_event(k, motion)
            if (.not. self%has_enough) cycle
            self%t = found%t(i)
            self%here = motion
            return
        end do
        self%t = b
        self%here = self%there
        self%values = self%five(:, 5)
    end subroutine search

    !> Finds the passages from the last instant to `b`, which may be moved to an earlier time, in order.
    subroutine find_passages(self, path, b, limit, found, motion_last)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(inout) :: b
        real(dp), intent(in) :: limit
        type(passages_t), intent(inout) :: found
        type(motion_t), intent(in), optional :: motion_last
        real(dp) :: values(5)
        logical :: is_near, stays
        integer :: k, before

        call self%find_quarters(path, self%t, b, limit, self%five, self%there, motion_last)
        if (path%is_spent()) return
        self%sides%has_passed = .false.
        self%knows_noise = .false.
        do k = 1, size(self%events)
            if (self%sides(k)%is_constant) cycle
            before = found%n
            values = self%five(k, :)
            call self%sides(k)%advance_if_staying(self%events(k), b, values, stays)
            if (stays .and. self%sides(k)%is_clear) cycle
            if (stays) call update_is_clear(self, path, k, self%t, b, values - self%sides(k)%level)
            if (stays) cycle
            call self%sides(k)%aim(self%events(k), self%t, values)
            is_near = any(abs(values - self%sides(k)%level) <= self%sides(k)%rounding)
            self%sides(k)%rounding = 0
            if (is_near) call self%measure_rounding(path, k, self%t, b, self%sides(k)%rounding)
            call refine(self, path, k, self%t, b, values - self%sides(k)%level, 0, found)
            call found%merge_from(before + 1)
        end do
    end subroutine find_passages

    !> Divides the interval from `a` to `b` until the quantity of event `k` passes its level at most once in
    !> each part, and takes the parts in order. `g` contains the distances from the level at five instants.
    recursive subroutine refine(self, path, k, a, b, g, depth, found)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k, depth
        real(dp), intent(in) :: a, b, g(5)
        type(passages_t), intent(inout) :: found
        real(dp) :: quarter

        if (path%is_spent()) return
        if (depth > 0 .and. mod(depth, rounding_depth) == 0) call self%measure_rounding(path, k, a, b, self%sides(k)%rounding)
        if (passes_at_most_once(g) .or. is_short(a, b) .or. .not. any(is_finite(g)) &
            .or. all(abs(g) <= self%sides(k)%rounding)) then
            call update_side(self, path, k, a, b, g, found)
            return
        end if
        quarter = (b - a) / 4
        call refine(self, path, k, a, a + 2 * quarter, [g(1), distance_at(0.5_dp), g(2), distance_at(1.5_dp), g(3)], &
                         depth + 1, found)
        call refine(self, path, k, a + 2 * quarter, b, [g(3), distance_at(2.5_dp), g(4), distance_at(3.5_dp), g(5)], &
                         depth + 1, found)

    contains

        real(dp) function distance_at(quarters)
            real(dp), intent(in) :: quarters
            distance_at = self%value_at(path, k, a + quarters * quarter) - self%sides(k)%level
        end function distance_at

    end subroutine refine

    !> Sets the side of the level on which the quantity of event `k` is at the end of the interval from `a` to `b`. If it
    !> differs from the last one, there is a passage in between.
    subroutine update_side(self, path, k, a, b, g, found)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: a, b, g(5)
        type(passages_t), intent(inout) :: found
        real(dp) :: t
        logical :: is_found
        integer :: new_sign

        associate (side => self%sides(k), distance => g(5))
            if (.not. is_finite(distance)) then
                side%sign = 0
                return
            end if
            if (.not. abs(distance) > side%rounding) return
            call update_is_clear(self, path, k, a, b, g)
            new_sign = sign_of(distance)
            if (side%sign == -new_sign .and. side%has_passed .and. .not. side%is_clear) then
                found%n = side%found_before ! the level is touched
                side%is_clear = .true.
                side%has_passed = .false.
            else if (side%sign == -new_sign) then
                side%has_passed = side%is_clear .and. side%was_clear
                side%found_before = found%n
                is_found = self%events(k)%direction /= -new_sign
                if (is_found) call self%find_passage(path, k, side, a, b, g, t, is_found)
                if (is_found) call found%add(merge(k, -k, side%has_passed), max(t, self%t))
                side%was_clear = side%is_clear .or. .not. side%was_ever_clear
                side%is_clear = .false.
            end if
            side%sign = new_sign
            side%t = b
            side%distance = distance
            call update_is_clear(self, path, k, a, b, g)
        end associate
    end subroutine update_side

    !> Notes whether the quantity of event `k` is beyond its noise, on its side, at one of five instants of the interval from `a`
    !> to `b`. As long as it never was, its noise may vary as fast as the quantity, and is taken where that is farthest from the
    !> level; later it is taken at the end of the interval of the search.
    subroutine update_is_clear(self, path, k, a, b, g)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: a, b, g(5)
        type(motion_t) :: motion
        real(dp) :: factor
        integer :: i

        factor = max(self%method_noise / rounding_distance, 1.0_dp)
        associate (side => self%sides(k))
            if (side%is_clear .or. side%sign == 0) return
            side%is_clear = side%was_ever_clear .and. .not. self%method_noise > 0
            if (side%is_clear) return
            i = maxloc(side%sign * g, dim=1, mask=is_finite(g))
            if (i == 0) return
            if (.not. side%sign * g(i) > 0) return
            if (.not. self%knows_noise) call find_noise(self, self%fall_rate, self%there, self%noise)
            self%knows_noise = .true.
            side%is_clear = side%sign * g(i) > factor * self%noise(k)
            if (side%was_ever_clear .or. .not. side%is_clear) return
            call path%motion_at(a + (b - a) * (i - 1) / 4, self%needs_angles, motion)
            call find_noise(self, self%fall_rate, motion, self%noise)
            self%knows_noise = .false.
            side%is_clear = side%sign * g(i) > margin * factor * self%noise(k)
            side%was_ever_clear = side%is_clear
        end associate
    end subroutine update_is_clear

end module spintop_events
