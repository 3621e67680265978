!> Events of a motion: the instants at which quantities of it pass levels.
!>
!> The motion is searched in intervals so short that the quantities vary smoothly in them: in one of them the attitude turns by
!> less than `largest_turn`, and an axis moves by less than the fraction `largest_way` of its distance from the vertical.
!> Polynomials through values there show by their coefficients in Bernstein form whether a quantity is monotone, or does not
!> reach its level; else the interval is halved, first in the polynomial, and where its error hides the answer by new values.
!> Any number of passages is therefore found. The following are not events: a level that is touched and not passed, to the
!> rounding error of the quantity, which is measured where it matters; passages of one that equals its level within rounding
!> errors; the start. Each evaluation counts as work; the search ends when the path allows no more.
module spintop_events
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_bernstein, only: coarse, fine, halve, interpolation, interpolation_t, root_of, value_at
    use spintop_body, only: body_t
    use spintop_bracket, only: bracket_t
    use spintop_kinds, only: dp, pi, is_equal, is_finite, cross
    use spintop_event, only: event_quantities_t, event_t, find_constant, find_noise, greatest_fall_rate, margin, occasion_none, &
        path_t, rounding_distance, time_of_start
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t
    use spintop_pole_passages, only: through_pole
    use spintop_status, only: is_ok, status_ok, status_bad_events
    implicit none
    private
    public :: event_t, event_search_t, path_t

    !> The side of its level on which a quantity is.
    type :: side_t
        real(dp) :: level = huge(1.0_dp)
        !> 1 above, -1 below, 0 unknown; the latest time at which it was known, and the distance from the level then.
        integer :: sign = 0
        real(dp) :: t = 0, distance = 0
        !> Whether the quantity is at the level, and constant to rounding.
        logical :: is_constant = .false.
        !> Whether the quantity was beyond its noise since the last passage, and between that and the one before. If so, the
        !> next passage counts. Before it ever was, nothing passes: it is at its level, on no side.
        logical :: is_clear = .false., was_clear = .true., was_ever_clear = .false.
        !> Whether there was a passage that counts in the interval; how many passages were found before it.
        logical :: has_passed = .false.
        integer :: found_before = 0
    end type side_t

    !> A passage by the quantity of an event; one that does not count has the negative number of the event.
    type :: passage_t
        integer :: event
        real(dp) :: t !! s
    end type passage_t

    !> Searches for events. An extension defines the quantities, and what happens at an event.
    type, extends(event_quantities_t), abstract :: event_search_t
        !> Set by `handle_event` to end the motion.
        logical :: has_enough = .false.
        !> The search ends where one of the events has happened so often: then it is full.
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
        !> Whether `handle_event` is called, with `is_noise`, at passages too that do not count, because the quantity was within
        !> its noise since the one before.
        logical :: takes_noise = .false., is_noise = .false.
        !> For `handle_event`: the work of effects from the start to the event, by its parts, J.
        real(dp) :: work(works) = 0
        !> The motion at that time; if `needs_angles`, with the angles and their rates.
        type(motion_t) :: here
        !> The quantities at that time, and their sides.
        real(dp), allocatable, private :: values(:)
        type(side_t), allocatable, private :: sides(:)
        !> The motion at the end of the interval that is searched, and the noise of the quantities there, once it is known.
        type(motion_t), private :: there
        real(dp), allocatable, private :: noise(:)
        logical, private :: knows_noise = .false.
        !> Passages in the interval, the first `n_passages` of these.
        integer, private :: n_passages = 0
        type(passage_t), allocatable, private :: passages(:)
        !> Interpolation by a coarse polynomial, and by a fine one.
        type(interpolation_t), private :: proxies(2)
        real(dp), private :: t_begin = 0, fall_rate = 0, soon = 0
    contains
        procedure(handle_event), deferred :: handle_event
        procedure :: check
        procedure :: begin
        procedure :: find_events
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

    !> Maximum rotation of the attitude in an interval, rad, and maximum path of the axis relative to its distance from the
    !> vertical.
    real(dp), parameter :: largest_turn = 1.6_dp, largest_way = 0.8_dp
    !> An interval of so many spacings of the time is not divided.
    real(dp), parameter :: least_spacings = 8
    !> Passages for which there is room at first.
    integer, parameter :: first_room = 16
    !> A coarse polynomial suffices in an interval no longer than this part of the longest.
    real(dp), parameter :: short = 0.35_dp
    !> An angle that changes by more in an interval was not followed.
    real(dp), parameter :: farthest_turn = 1.5_dp * pi
    !> A value so close to a level at which the search begins, relatively, is at the level.
    real(dp), parameter :: start_rounding = 16 * epsilon(1.0_dp)
    !> The rounding error is measured over this fraction of an interval.
    real(dp), parameter :: rounding_share = 2.0_dp**(-12)
    !> A polynomial is hidden by its error if it is no more than so many times that; an error is rounding if it is no more than so
    !> many times that over such a fraction.
    real(dp), parameter :: as_small = 8
    !> Errors by no larger a factor apart are alike; so many in a row, while the interval is halved, are those at a jump.
    real(dp), parameter :: alike = 1.5_dp
    integer, parameter :: most_alike = 4
    !> How well the place is to be known at which a polynomial passes zero, and around which the quantity is nearly a straight line:
    !> fractions of the interval.
    real(dp), parameter :: guess = 1.0e-8_dp, around = 1.0e-3_dp

contains

    !> `status_ok`, or `status_bad_events` if an event has another direction than -1, 0 or 1, or a level that is not finite.
    pure integer function check(self) result(status)
        class(event_search_t), intent(in) :: self
        status = status_ok
        if (.not. allocated(self%events)) return
        if (.not. all(abs(self%events%direction) <= 1 .and. is_finite(self%events%level))) status = status_bad_events
    end function check

    !> Begins at a motion of the body. With a start of that motion it is judged which quantities are constant at their levels there,
    !> and then have no events.
    subroutine begin(self, body, motion, start)
        class(event_search_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! the motion where the search begins
        type(motion_t), intent(in), optional :: start !! the motion at the start
        integer :: n
        self%fall_rate = greatest_fall_rate(body)
        self%t_begin = motion%t
        self%t = motion%t
        self%here = motion
        self%soon = time_of_start(body, motion)
        self%has_enough = .false.
        self%is_full = .false.
        self%proxies = [interpolation(coarse), interpolation(fine)]
        if (.not. allocated(self%events)) allocate (self%events(0))
        self%events%count = 0
        if (allocated(self%values)) deallocate (self%values, self%noise, self%sides, self%passages)
        n = size(self%events)
        allocate (self%values(n), self%noise(n), self%sides(n))
        allocate (self%passages(first_room))
        call self%quantities(motion, self%values)
        if (present(start)) call find_constant(self, body, start, self%sides%is_constant)
    end subroutine begin

    !> Searches the path from the last instant to a time, or to the event that ends the motion, or as far as
    !> the path allows.
    subroutine find_events(self, path, t)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path !! the motion, which is evaluated as far as needed
        real(dp), intent(in) :: t !! time, s
        type(motion_t) :: last
        real(dp) :: pace, next, share
        logical :: knows_last

        if (all(self%events%occasion /= occasion_none)) self%t = max(self%t, t) ! no quantity is sought
        if (.not. t > self%t) return
        pace = path%greatest_rate
        knows_last = .not. pace > 0
        if (knows_last) then
            call path%at(t, last, self%needs_angles)
            ! A body that rotates slowly at both ends may have fallen and risen in between.
            pace = max(norm2(self%here%omega), norm2(last%omega)) + self%fall_rate * min(2.0_dp, self%fall_rate * (t - self%t))
        end if
        do while (self%t < t .and. .not. self%has_enough)
            if (path%is_spent() .or. self%is_full) exit
            call find_next_instant(self%here, self%pole_axis, self%t, t, pace, next, share)
            if (knows_last .and. is_equal(next, t)) then
                call search(self, path, next, share, last)
            else
                call search(self, path, next, share)
            end if
        end do
    end subroutine find_events

    !> The end of the interval that begins at time `now`, at most `last`; the body turns no faster than `pace`.
    pure subroutine find_next_instant(motion, axis, now, last, pace, next, share)
        type(motion_t), intent(in) :: motion     !! at time `now`
        real(dp), intent(in) :: axis(3)          !! of the body; zero if no axis matters
        real(dp), intent(in) :: now, last, pace  !! s, s, rad/s
        real(dp), intent(out) :: next, share     !! the end, s; how long the interval is, by the longest that might be
        real(dp) :: gap
        gap = min(time_near_pole(motion, axis), 4 * (last - now)) ! no larger number is needed
        if (is_finite(pace) .and. pace * gap > largest_turn) gap = largest_turn / pace
        gap = max(gap, 2 * least_spacings * spacing(max(abs(now), abs(last))))
        next = last
        if (last - now > gap) next = now + (last - now) / (aint((last - now) / gap) + 1)
        share = (next - now) / gap
    end subroutine find_next_instant

    !> Time in which a body axis moves by a fraction of its distance from the vertical, s: for this path s,
    !> the speed v and the acceleration a in space, the solution of v t + a t^2/2 = s. Practically infinite
    !> without an axis.
    pure real(dp) function time_near_pole(motion, axis) result(time)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: axis(3)
        real(dp) :: way, speed, acceleration, velocity(3), change(3)
        time = huge(1.0_dp)
        if (.not. any(abs(axis) > 0)) return
        way = largest_way * max(norm2(cross(vertical_from_quaternion(motion%quaternion), axis)), through_pole)
        velocity = cross(motion%omega, axis)
        change = cross(motion%omega_rate, axis) + cross(motion%omega, velocity)
        speed = sqrt(sum(velocity**2))
        acceleration = sqrt(sum(change**2))
        if (speed + acceleration > 0) time = 2 * way / (speed + sqrt(speed**2 + 2 * acceleration * way))
    end function time_near_pole

    !> Whether an interval of time is too short to be divided.
    pure logical function is_short(a, b)
        real(dp), intent(in) :: a, b !! ends of the interval, s
        is_short = b - a <= least_spacings * spacing(max(abs(a), abs(b)))
    end function is_short

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
            if (self%events(k)%occasion == occasion) call count_event(self, k, motion)
            if (self%is_full) return
        end do
        if (.not. self%has_enough) return
        self%t = motion%t
        self%here = motion
    end subroutine record_occasion

    !> Counts an event and handles it, unless the search is full.
    subroutine count_event(self, k, motion)
        class(event_search_t), intent(inout) :: self
        integer, intent(in) :: k
        type(motion_t), intent(in) :: motion
        self%is_full = self%events(k)%count >= self%most_events
        if (self%is_full) return
        self%events(k)%count = self%events(k)%count + 1
        call self%handle_event(k, motion)
    end subroutine count_event

    !> Searches for passages from the last instant to the next one, `next` or earlier, and handles them in order. An event very
    !> soon after the start is the start. `last` is the motion at `next`, if known.
    subroutine search(self, path, next, share, last)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(in) :: next, share
        type(motion_t), intent(in), optional :: last
        type(side_t) :: before(size(self%sides))
        type(motion_t) :: motion
        real(dp) :: b, values(size(self%events))
        integer :: i, n

        b = next
        before(:) = self%sides
        call find_passages(self, path, b, share, values, last)
        if (any(self%sides%has_passed .and. .not. self%sides%is_clear) .and. .not. is_short(self%t, b)) then
            ! One that may only touch its level: an interval that ends elsewhere shows both passages, or neither.
            self%sides(:) = before
            b = self%t + (b - self%t) / 2
            call find_passages(self, path, b, share / 2, values)
        end if
        if (path%is_spent()) return
        do n = 1, self%n_passages
            ! The earliest of those left; at the same time that of the event with the smallest number.
            i = minloc(self%passages(:self%n_passages)%t, dim=1)
            associate (t => self%passages(i)%t, k => self%passages(i)%event)
                if (t - self%t_begin > self%soon) then
                    call path%at(t, motion)
                    self%work = path%work_until(t)
                    if (k > 0) call count_event(self, k, motion)
                    self%is_noise = k < 0
                    if (self%is_noise .and. self%takes_noise) call self%handle_event(-k, motion)
                    self%is_noise = .false.
                    if (self%is_full) return
                    if (self%has_enough) then
                        self%t = t
                        self%here = motion
                        return
                    end if
                end if
                t = huge(1.0_dp)
            end associate
        end do
        self%t = b
        self%here = self%there
        self%values = values
    end subroutine search

    !> Finds the passages from the last instant to `b`, which is moved to an earlier time up to which no angle turns too far, and
    !> the quantities there.
    subroutine find_passages(self, path, b, share, last_values, last)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(inout) :: b
        real(dp), intent(in) :: share
        real(dp), intent(out) :: last_values(:)
        type(motion_t), intent(in), optional :: last
        real(dp) :: values(size(self%events), 0:fine), g(0:fine), error
        real(dp), dimension(size(self%events)) :: bend, near
        integer :: i, k, n

        self%n_passages = 0
        self%knows_noise = .false.
        self%sides%has_passed = .false.
        associate (proxy => self%proxies(merge(1, 2, share <= short)))
            n = proxy%degree
            values(:, 0) = self%values
            call look(self, path, self%t, b, proxy, values, self%there, last)
            do while (any(turns_far(self%events, values(:, 0), values(:, n))))
                if (is_short(self%t, b) .or. path%is_spent()) exit
                b = self%t + (b - self%t) / 2
                call look(self, path, self%t, b, proxy, values, self%there)
            end do
            last_values = values(:, n)
            if (path%is_spent()) return
            call aim(self%sides, self%events, self%t, values(:, 0), last_values)
            do i = 0, n
                values(:, i) = values(:, i) - self%sides%level
            end do
            bend = 0
            do i = 1, n - 1
                bend = bend + abs(values(:, i) - values(:, 0) - (values(:, n) - values(:, 0)) * proxy%place(i))
            end do
            near = min(self%sides%sign * values(:, 0), self%sides%sign * values(:, n))
            do k = 1, size(self%events)
                if (self%sides(k)%is_constant) cycle
                if (near(k) > proxy%bend * bend(k) .and. self%sides(k)%is_clear) then
                    ! Mostly a quantity is far from its level for how much it bends.
                    self%sides(k)%t = b
                    self%sides(k)%distance = values(k, n)
                    cycle
                end if
                call proxy%find_polynomial(values(k, :n), g, error)
                call refine(self, path, k, self%t, b, g, error, 0, huge(1.0_dp))
                if (abs(values(k, n)) > error) cycle
                ! The value at the end has no error but rounding.
                call sample(self, path, k, max(self%t, b - max((b - self%t) * rounding_share, 16 * spacing(b))), b, g, error)
                g = values(k, n)
                call update_side(self, path, k, b, b, g, error)
            end do
        end associate
    end subroutine find_passages

    !> The quantities at the places of interpolation from `a` to `b` but for the first, and the motion at the last, if it is not
    !> known.
    subroutine look(self, path, a, b, proxy, values, there, last)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        real(dp), intent(in) :: a, b
        type(interpolation_t), intent(in) :: proxy
        real(dp), intent(inout) :: values(:, 0:)
        type(motion_t), intent(out) :: there
        type(motion_t), intent(in), optional :: last
        type(motions_t) :: motions
        real(dp) :: t(instants), several(instants, size(values, 1))
        integer :: i, n

        n = proxy%degree
        t = b
        t(:n - 1) = a + (b - a) * proxy%place(1:n - 1)
        if (self%takes_several) then
            call path%at_several(t, n, motions)
            call self%quantities_of_several(motions, several)
            do i = 1, n
                values(:, i) = several(i, :)
            end do
            there = motions%motion(n)
            return
        end if
        do i = 1, n
            if (i == n .and. present(last)) then
                there = last
            else
                call path%at(t(i), there, self%needs_angles)
            end if
            call self%quantities(there, values(:, i))
        end do
    end subroutine look

    !> The polynomial of the distance of the quantity of event `k` from its level between two times, by new values.
    subroutine sample(self, path, k, a, b, g, error)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: a, b
        real(dp), intent(out) :: g(0:fine), error
        real(dp) :: values(size(self%events), 0:fine)
        type(motion_t) :: there
        call path%at(a, there, self%needs_angles)
        call self%quantities(there, values(:, 0))
        call look(self, path, a, b, self%proxies(2), values, there)
        call self%proxies(2)%find_polynomial(values(k, :) - self%sides(k)%level, g, error)
    end subroutine sample

    !> Selects the level of an event for an interval: of several levels the one nearest to the quantity.
    elemental subroutine aim(side, event, t, first, last)
        type(side_t), intent(inout) :: side
        type(event_t), intent(in) :: event
        real(dp), intent(in) :: t, first, last
        real(dp) :: level, middle

        level = event%level
        middle = first + (last - first) / 2
        if (event%every_turn .and. is_finite(middle)) level = level + 2 * pi * anint((middle - level) / (2 * pi))
        if (event%turn_by_turn) level = 2 * pi * (event%count + 1)
        if (.not. abs(level - side%level) > 0) return
        side%level = level
        side%t = t
        side%distance = first - level
        side%sign = 0
        if (abs(side%distance) > start_rounding * (abs(first) + abs(level))) side%sign = merge(1, -1, side%distance > 0)
    end subroutine aim

    !> Whether an angle with turns changes too much between two instants to be followed.
    elemental logical function turns_far(event, before, after)
        type(event_t), intent(in) :: event
        real(dp), intent(in) :: before, after
        turns_far = (event%every_turn .or. event%turn_by_turn) .and. abs(after - before) > farthest_turn
    end function turns_far

    !> Divides the interval from `a` to `b` until the quantity of event `k` passes its level at most once in each part, and takes
    !> the parts in order. `g` is the polynomial of the distance from the level, with a bound of its error. `steady` is how often
    !> in a row new values left an error that large, `error_before`; -1 if the polynomial is not through values in this interval.
    recursive subroutine refine(self, path, k, a, b, g, error, steady, error_before)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k, steady
        real(dp), intent(in) :: a, b, g(0:fine), error, error_before
        real(dp) :: middle, left(0:fine), right(0:fine), slopes(fine), rounding
        integer :: row

        middle = a + (b - a) / 2
        row = steady + 1
        if (.not. max(error, error_before) < alike * min(error, error_before)) row = 0
        slopes = g(1:) - g(:fine - 1)
        if (all(g > error) .or. all(g < -error) .or. all(slopes > error) .or. all(slopes < -error) .or. is_short(a, b) &
            .or. b - self%t_begin <= self%soon .or. .not. any(abs(g) <= huge(g))) then
            ! On one side, monotone, too short, the start itself, or nowhere finite.
            call update_side(self, path, k, a, b, g, error)
        else if (any(abs(g) > as_small * error)) then
            ! The halves of the polynomial tell more, without new values.
            call halve(g, left, right)
            call refine(self, path, k, a, middle, left, error, -1, error)
            call refine(self, path, k, middle, b, right, error, -1, error)
        else if (path%is_spent()) then
            return
        else if (steady < 0) then
            ! It is hidden by the error of an interval that is longer: one for this interval has a smaller error.
            call sample(self, path, k, a, b, left, rounding)
            call refine(self, path, k, a, b, left, rounding, 0, huge(1.0_dp))
        else if (row == most_alike) then
            ! A jump, of which the values at the ends tell enough.
            call update_side(self, path, k, a, b, g, 0.0_dp)
        else
            ! No side can be told where the error is that of rounding, as next to the beginning of the interval.
            call sample(self, path, k, a, max(a + (b - a) * rounding_share, a + 16 * spacing(b)), left, rounding)
            if (error <= as_small * rounding .and. rounding < huge(1.0_dp)) return
            call sample(self, path, k, a, middle, left, rounding)
            call refine(self, path, k, a, middle, left, rounding, row, error)
            call sample(self, path, k, middle, b, right, rounding)
            call refine(self, path, k, middle, b, right, rounding, row, error)
        end if
    end subroutine refine

    !> Sets the side of the level on which the quantity of event `k` is at the end of the interval from `a` to `b`, if it is
    !> further from it than the error. If it differs from the last one, there is a passage in between.
    subroutine update_side(self, path, k, a, b, g, error)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: a, b, g(0:fine), error
        real(dp) :: t
        logical :: is_found
        integer :: new_sign

        associate (side => self%sides(k), distance => g(fine))
            if (.not. abs(distance) <= huge(1.0_dp)) side%sign = 0
            if (.not. (abs(distance) > error .and. abs(distance) <= huge(1.0_dp))) return
            call update_is_clear(self, path, k, a, b, g)
            new_sign = merge(1, -1, distance > 0)
            if (side%sign == -new_sign .and. side%has_passed .and. .not. side%is_clear) then
                self%n_passages = side%found_before ! the level is touched
                side%is_clear = .true.
                side%has_passed = .false.
            else if (side%sign == -new_sign) then
                side%has_passed = side%is_clear .and. side%was_clear
                side%found_before = self%n_passages
                is_found = self%events(k)%direction /= -new_sign
                if (is_found) call find_passage(self, path, k, a, b, g, error, t, is_found)
                if (is_found) then
                    if (self%n_passages == size(self%passages)) self%passages = [self%passages, self%passages]
                    self%n_passages = self%n_passages + 1
                    self%passages(self%n_passages) = passage_t(merge(k, -k, side%has_passed), max(t, self%t))
                end if
                side%was_clear = side%is_clear .or. .not. side%was_ever_clear
                side%is_clear = .false.
            end if
            side%sign = new_sign
            side%t = b
            side%distance = distance
            call update_is_clear(self, path, k, a, b, g)
        end associate
    end subroutine update_side

    !> The time at which the quantity of event `k` passes its level, between the instant at which its side was last known and `b`,
    !> where it differs: by values of the quantity, first where the polynomial from `a` to `b` passes zero. A jump from and to
    !> infinity is not a passage.
    subroutine find_passage(self, path, k, a, b, g, error, t, is_found)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: a, b, g(0:fine), error
        real(dp), intent(out) :: t
        logical, intent(out) :: is_found
        type(bracket_t) :: bracket
        type(motion_t) :: motion
        real(dp) :: values(size(self%events)), distances(2), near(2), tolerance

        associate (side => self%sides(k))
            tolerance = spacing(max(abs(side%t), abs(b)))
            call bracket%begin(side%t, side%distance, b, g(fine), tolerance)
            ! The polynomial tells a part of the interval in which the passage is, if it is beyond its error at the ends of that.
            if (error > 0 .and. g(0) * g(fine) < 0) then
                t = root_of(g, guess)
                near = [max(t - around, 0.0_dp), min(t + around, 1.0_dp)]
                distances = [value_at(g, near(1)), value_at(g, near(2))]
                near = a + near * (b - a)
                t = a + t * (b - a)
                if (all(side%sign * [1, -1] * distances > error)) then
                    call bracket%begin(near(1), distances(1), near(2), distances(2), tolerance)
                end if
                if (.not. bracket%found .and. t > near(1) .and. t < near(2)) bracket%trial = t
            end if
            do while (.not. bracket%found)
                t = bracket%trial
                call path%at(t, motion, self%needs_angles)
                call self%quantities(motion, values)
                call bracket%add_value(values(k) - side%level)
                ! It would go on with one that differs by the tolerance at least.
                if (abs(bracket%trial - t) <= 1.5_dp * tolerance) exit
            end do
            if (bracket%found) t = bracket%trial
            is_found = is_ok(bracket%status) .and. abs(bracket%residual) <= 2 * max(abs(side%distance), maxval(abs(g)))
        end associate
    end subroutine find_passage

    !> Notes whether the quantity of event `k` is beyond its noise, on its side, at the ends or in the middle of the interval from
    !> `a` to `b`. As long as it never was, its noise may vary as fast as the quantity, and is taken where that is farthest from
    !> the level; later it is taken at the end of the interval of the search.
    subroutine update_is_clear(self, path, k, a, b, g)
        class(event_search_t), intent(inout) :: self
        class(path_t), intent(inout) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: a, b, g(0:fine)
        type(motion_t) :: motion
        real(dp) :: factor, far(3)
        integer :: i

        factor = max(self%method_noise / rounding_distance, 1.0_dp)
        associate (side => self%sides(k))
            if (side%is_clear .or. side%sign == 0) return
            side%is_clear = side%was_ever_clear .and. .not. self%method_noise > 0
            if (side%is_clear) return
            far = side%sign * [g(0), value_at(g, 0.5_dp), g(fine)]
            i = maxloc(far, dim=1, mask=far > 0 .and. far <= huge(far))
            if (i == 0) return
            if (.not. self%knows_noise) call find_noise(self, self%fall_rate, self%there, self%noise)
            self%knows_noise = .true.
            side%is_clear = far(i) > factor * self%noise(k)
            if (side%was_ever_clear .or. .not. side%is_clear) return
            call path%at(a + (b - a) * (i - 1) / 2, motion, self%needs_angles)
            call find_noise(self, self%fall_rate, motion, self%noise)
            self%knows_noise = .false.
            side%is_clear = far(i) > margin * factor * self%noise(k)
            side%was_ever_clear = side%is_clear
        end associate
    end subroutine update_is_clear

end module spintop_events
