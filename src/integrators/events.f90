!> Events of a motion: the instants at which quantities of it pass levels.
!>
!> A watch looks along the motion, stretch by stretch, at instants so close that the attitude turns by
!> less than `largest_turn` between them. Between two instants a quantity that changes sides has passed
!> its level once; one that approaches it at the first and leaves it at the second may have passed it
!> twice, and the extremum between is sought. What cannot be seen: a level touched and not passed,
!> unless at an instant looked at, and three passages or more between two instants. The start itself is
!> no event.
module spintop_events
    use spintop_kinds, only: dp, pi
    use spintop_body, only: body_t
    use spintop_bracket, only: bracket_t
    use spintop_compare, only: is_finite, is_zero
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_bad_events
    implicit none
    private
    public :: event_t, event_watch_t, path_t

    !> What to look for, and how often it was met.
    type :: event_t
        !> As it stands in tables.
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

    !> A motion that can be had at any time within a stretch.
    type, abstract :: path_t
    contains
        procedure(at), deferred :: at
    end type path_t

    !> Looks for events. What extends it says which quantities they are of, and what becomes of them.
    type, abstract :: event_watch_t
        !> What to look for: a quantity each.
        type(event_t), allocatable :: events(:)
        !> Set by `meet` to end the motion.
        logical :: has_enough = .false.
        !> Time up to which the motion was looked at, s: that of the event which ended it.
        real(dp) :: t = 0
        !> The motion then.
        type(motion_t) :: here
        !> The quantities then.
        real(dp), allocatable, private :: values(:)
        real(dp), private :: t_begin = 0, fall_rate = 0
    contains
        procedure(quantities), deferred :: quantities
        procedure(meet), deferred :: meet
        procedure :: check
        procedure :: begin
        procedure :: look
        procedure, private :: values_at
        procedure, private :: search
        procedure, private :: pass
        procedure, private :: find_dip
        procedure, private :: find_root
    end type event_watch_t

    abstract interface
        !> The motion at a time.
        subroutine at(self, t, motion)
            import :: path_t, motion_t, dp
            class(path_t), intent(in) :: self
            real(dp), intent(in) :: t
            type(motion_t), intent(out) :: motion
        end subroutine at

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

    !> Passages between two instants.
    type :: passages_t
        integer :: n = 0
        integer, allocatable :: event(:)
        real(dp), allocatable :: t(:)
    contains
        procedure :: add
    end type passages_t

    !> Turn of the attitude between two instants at most, rad.
    real(dp), parameter :: largest_turn = 0.4_dp
    !> Share of the time between two instants over which slopes are taken at its ends.
    real(dp), parameter :: inset = 1.0e-3_dp
    !> An event sooner after the start than this share of the time of a radian is the start.
    real(dp), parameter :: start_share = 1.0e-9_dp
    !> Trials for an extremum: by then the golden section has come down to where the quantity changes by
    !> less than its rounding.
    integer, parameter :: most_trials = 40
    real(dp), parameter :: golden = 0.38196601125010515_dp

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
        self%has_enough = .false.
        if (.not. allocated(self%events)) allocate (self%events(0))
        self%events%count = 0
        if (allocated(self%values)) deallocate (self%values)
        allocate (self%values(size(self%events)))
        call self%quantities(motion, self%values)
    end subroutine begin

    !> Looks at the path from where it was looked at last up to a time, or up to the event that ends
    !> the motion.
    subroutine look(self, path, t)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(in) :: path
        real(dp), intent(in) :: t
        type(motion_t) :: there
        real(dp) :: first, pace
        integer :: pieces, i

        first = self%t
        if (.not. t > first) return
        call path%at(t, there)
        ! A body that turns slowly at both ends may have fallen and risen between.
        pace = max(norm2(self%here%omega), norm2(there%omega)) + 2 * self%fall_rate
        pieces = max(1, ceiling(min((t - first) * pace / largest_turn, 0.5_dp * huge(1))))
        do i = 1, pieces
            if (i < pieces) then
                call self%search(path, first + (t - first) * i / pieces, start_share / pace)
            else
                call self%search(path, t, start_share / pace)
            end if
            if (self%has_enough) return
        end do
    end subroutine look

    !> Looks for passages from the instant looked at last to the next, and meets them in order. One
    !> so soon after the start is the start.
    subroutine search(self, path, b, soon)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(in) :: path
        real(dp), intent(in) :: b, soon
        type(passages_t) :: found
        type(motion_t) :: motion
        real(dp), dimension(size(self%events)) :: after, before, at_end
        real(dp) :: a, values(4)
        integer :: k, turn, i

        a = self%t
        call self%values_at(path, a + inset * (b - a), after)
        call self%values_at(path, b - inset * (b - a), before)
        call self%values_at(path, b, at_end)
        do k = 1, size(self%events)
            values = [self%values(k), after(k), before(k), at_end(k)]
            if (.not. all(is_finite(values))) cycle
            associate (event => self%events(k))
                if (event%every_turn) then
                    do turn = floor((minval(values) - event%level) / (2 * pi)), &
                            ceiling((maxval(values) - event%level) / (2 * pi))
                        call self%pass(path, k, event%level + 2 * pi * turn, a, b, values, found)
                    end do
                else if (event%turn_by_turn) then
                    call self%pass(path, k, 2 * pi * (event%count + 1), a, b, values, found)
                else
                    call self%pass(path, k, event%level, a, b, values, found)
                end if
            end associate
        end do
        do i = 1, found%n
            if (found%t(i) - self%t_begin <= soon) cycle
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
        call path%at(b, self%here)
        self%values = at_end
    end subroutine search

    !> The quantities at a time.
    subroutine values_at(self, path, t, values)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(in) :: path
        real(dp), intent(in) :: t
        real(dp), intent(out) :: values(:)
        type(motion_t) :: motion
        call path%at(t, motion)
        call self%quantities(motion, values)
    end subroutine values_at

    !> Finds where quantity `k` passes a level between `a` and `b`, in the direction wanted; `values`
    !> are those at `a`, soon after, shortly before `b`, and at `b`. A level that is met at `b` is
    !> passed there; one that is met at `a` was.
    subroutine pass(self, path, k, level, a, b, values, found)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(in) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: level, a, b, values(4)
        type(passages_t), intent(inout) :: found
        real(dp) :: g(4), left, dip, depth
        integer :: side

        g = values - level
        left = a
        side = sign_of(g(1))
        if (side == 0) then
            left = a + inset * (b - a)
            g(1) = g(2)
            side = sign_of(g(1))
        end if
        if (side == 0) return
        if (side * sign_of(g(4)) > 0) then
            if (side * (g(2) - g(1)) >= 0 .or. side * (g(4) - g(3)) <= 0) return
            call self%find_dip(path, k, level, a, b, g, dip, depth)
            if (side * depth >= 0) return
            if (self%events(k)%direction == side) then
                call self%find_root(path, k, level, dip, depth, b, g(4), found)
            else
                call self%find_root(path, k, level, a, g(1), dip, depth, found)
            end if
        else if (self%events(k)%direction == -side) then
            call self%find_root(path, k, level, left, g(1), b, g(4), found)
        end if
    end subroutine pass

    !> The place of an extremum between `a` and `b` next to the level, or the first beyond the level
    !> that is found on the way to it. `g` is as in `pass`, of one sign.
    subroutine find_dip(self, path, k, level, a, b, g, dip, depth)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(in) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: level, a, b, g(4)
        real(dp), intent(out) :: dip, depth
        real(dp) :: side, low, high, inner, trial, value, slopes(2), values(size(self%events))
        integer :: i

        side = sign(1.0_dp, g(1))
        dip = merge(a, b, abs(g(1)) < abs(g(4)))
        depth = merge(g(1), g(4), abs(g(1)) < abs(g(4)))
        ! A curve bent away from the level stays before its tangents; where these meet before it, too.
        slopes = side * [g(2) - g(1), g(4) - g(3)] / inset
        if (side * (g(1) * slopes(2) - g(4) * slopes(1)) + slopes(1) * slopes(2) > 0) return
        low = a
        high = b
        inner = low + golden * (high - low)
        value = value_at(inner)
        do i = 1, most_trials
            if (side * value < side * depth) then
                dip = inner
                depth = value
            end if
            if (side * depth < 0) return
            ! The golden section of the longer side.
            if (high - inner > inner - low) then
                trial = inner + golden * (high - inner)
            else
                trial = inner - golden * (inner - low)
            end if
            call narrow(value_at(trial))
        end do

    contains

        real(dp) function value_at(t)
            real(dp), intent(in) :: t
            call self%values_at(path, t, values)
            value_at = values(k) - level
        end function value_at

        !> Takes the value at the trial: the lower of both stays inside.
        subroutine narrow(other)
            real(dp), intent(in) :: other
            if (side * other < side * value) then
                if (trial > inner) low = inner
                if (trial < inner) high = inner
                inner = trial
                value = other
            else
                if (trial > inner) high = trial
                if (trial < inner) low = trial
            end if
        end subroutine narrow

    end subroutine find_dip

    !> Adds the passage between `a` and `b`, where the quantity lies on both sides of the level, to
    !> those found; a jump to and from infinity is none.
    subroutine find_root(self, path, k, level, a, ga, b, gb, found)
        class(event_watch_t), intent(inout) :: self
        class(path_t), intent(in) :: path
        integer, intent(in) :: k
        real(dp), intent(in) :: level, a, ga, b, gb
        type(passages_t), intent(inout) :: found
        type(bracket_t) :: bracket
        real(dp) :: values(size(self%events))

        call bracket%begin(a, ga, b, gb, spacing(max(abs(a), abs(b))))
        do while (.not. bracket%found)
            call self%values_at(path, bracket%trial, values)
            if (.not. is_finite(values(k))) return
            call bracket%take(values(k) - level)
        end do
        if (abs(bracket%residual) <= max(abs(ga), abs(gb))) call found%add(k, bracket%trial)
    end subroutine find_root

    !> Adds a passage in its place by time.
    subroutine add(self, event, t)
        class(passages_t), intent(inout) :: self
        integer, intent(in) :: event
        real(dp), intent(in) :: t
        integer :: place
        if (self%n == 0) then
            allocate (self%event(0), self%t(0))
        end if
        place = count(self%t <= t)
        self%event = [self%event(:place), event, self%event(place + 1:)]
        self%t = [self%t(:place), t, self%t(place + 1:)]
        self%n = self%n + 1
    end subroutine add

    !> 1, -1, or 0 for zero.
    elemental integer function sign_of(x)
        real(dp), intent(in) :: x
        sign_of = merge(0, nint(sign(1.0_dp, x)), is_zero(x))
    end function sign_of

end module spintop_events
