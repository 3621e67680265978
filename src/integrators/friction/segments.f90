!> The span of a body with effects as segments in which its motion is smooth. The method steps through most of them. A
!> Runge-Kutta step leads across an instant at which the motion has no series; while dry friction holds the body, it lies
!> still.
!>
!> A segment ends at a knot of a table of torques, just beyond a row of one of friction, at rest, where the torques exceed the
!> friction, or before a vector reverses on whose direction the torques depend. What steps through the next one begins there.
!>
!> Friction has the direction of the angular velocity, so f jumps where that vanishes; dry friction holds the body there if it can
!> balance the other torques. A step towards rest ends half-way there, as far as the deceleration tells, until what is left of the
!> angular velocity is negligible.
!>
!> A step ends where the equations are not analytic: before a vector vanishes of which effects have the direction or the
!> magnitude, the angular velocity under friction and drag, the velocity of a dragged centre of mass, the support force; and just
!> beyond the row of a table of friction that the angular velocity passes first.
!>
!> A series, in which a direction is constant or a magnitude has its sign, goes on beyond a zero; such a step ends before. It has
!> the polynomial between two rows, and goes on with it beyond them, so that its state there is right; a step of another method
!> that leads across a row is wrong as a whole, and is taken again.
module spintop_segments
    use spintop_runge_kutta, only: dop853_t, dop853_table
    use spintop_effects_action, only: direction_force, direction_omega, directions, reach_t, row_interval_t, turning_t
    use spintop_event, only: occasion_none, occasion_slip, occasion_stuck
    use spintop_fixed_step, only: grid_time
    use spintop_formulation, only: formulation_t, max_states, structure_none, structure_series
    use spintop_kinds, only: dp
    use spintop_motions, only: instants
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_step_too_small
    use spintop_stepper, only: method_info_t, stepper_t
    implicit none
    private
    public :: segments_t

    !> A body whose angular velocity is below this share of its largest value comes to rest.
    real(dp), parameter :: nearly_still = 1.0e-8_dp
    !> The same share of what remains of an angular velocity in a plane motion that reverses.
    real(dp), parameter :: rounding = 1.0e-13_dp
    !> A plane motion under drag turns where it slows down at least with this share of its largest deceleration: a
    !> motion that dies away does not.
    real(dp), parameter :: turning = 1.0e-6_dp
    !> Steps to rest are limited to this share of the time left; a vector that changes by less than that share of it is far from a
    !> reversal.
    real(dp), parameter :: share_to_rest = 0.5_dp, small_change = 0.5_dp

    !> A time at which a vector reverses, or a row is passed, is found up to so many spacings of the time.
    real(dp), parameter :: spacings = 4
    !> A vector that is not below this share of what it was at the beginning of the step passes zero at a distance. There the
    !> series has a small radius of convergence; a step to this part of the way is well within.
    real(dp), parameter :: vanishing = 1.0e-12_dp, part_of_way = 0.5_dp
    !> The cosine of the largest angle by which the support force turns in a step: where it passes zero at a distance it turns
    !> by half a turn, and the terms of a step that leads across do not tell.
    real(dp), parameter :: turned = 0.5_dp
    !> A row within this share of a step is passed at its beginning: the step is as good as behind it.
    real(dp), parameter :: shortest = 1.0e-6_dp

    !> Rest: the attitude is kept.
    type, extends(stepper_t) :: resting_t
    contains
        procedure :: begin => begin_rest
        procedure :: advance => lie
        procedure :: state_within
    end type resting_t

    !> What leads through a segment: the method, a Runge-Kutta step, or rest.
    integer, parameter :: by_method = 0, by_runge_kutta = 1, by_rest = 2

    !> The segment of a run, and what leads through others.
    type :: segments_t
        !> Whether the body is at rest, since the time `t_stuck`, s.
        logical :: is_resting = .false.
        real(dp) :: t_stuck = 0
        !> What happened at the end of the last step: the body came to rest, or began to move.
        integer :: occasion = occasion_none
        !> Whether the torques jumped at the end of the last step, whose time is that of the jump.
        logical :: passes_jump = .false.
        integer, private :: kind = by_method
        !> Whether the next segment must be a Runge-Kutta step: at its beginning there is no series.
        logical, private :: must_cross = .false.
        !> Whether the angular velocity surely kept its direction, and more than half of its magnitude, in the last step.
        logical, private :: keeps_direction = .false.
        !> Whether the method steps by series, which end where a motion reverses without dry friction, too.
        logical, private :: has_series = .false.
        !> Largest angular velocity so far, rad/s, and deceleration, rad/s^2, where they were computed.
        real(dp), private :: largest = 0, steepest = 0
        !> What was seen last: the end of a step is the beginning of the next. A deceleration that does not matter is zero.
        type(turning_t), private :: seen
        type(resting_t), private :: lying
        type(dop853_t), private :: crossing
    contains
        procedure :: begin
        procedure :: advance
        procedure :: end_step
    end type segments_t

    !> Tolerance of the steps where there is no series, if that of the method is not smaller; and the smallest, for steps in
    !> double precision.
    real(dp), parameter :: crossing_tolerance = 1.0e-12_dp, finest_tolerance = 1.0e-14_dp
    !> Part of its own first step that the Runge-Kutta method takes: its estimate may not see what a bend in the step errs.
    real(dp), parameter :: first_part = 0.1_dp

contains

    !> Looks at the angular velocity. How fast it decreases is zero where nothing depends on its direction: without dry
    !> friction, but for series under a drag, which end near where the motion turns.
    subroutine set_motion(self, formulation, t, y)
        class(segments_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states)
        if (.not. abs(t - self%seen%t) > 0) return
        self%seen = formulation%action%turning_at(t, y)
        self%largest = max(self%largest, self%seen%speed)
        self%steepest = max(self%steepest, self%seen%slowing)
        if (.not. (formulation%action%may_stick &
                   .or. (self%has_series .and. self%seen%slowing > turning * self%steepest))) self%seen%slowing = 0
    end subroutine set_motion

    !> The time up to which a step from a state may reach: half of that to rest.
    real(dp) function half_way(self, formulation, t, y)
        class(segments_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        half_way = huge(t)
        call set_motion(self, formulation, t, y)
        if (self%seen%slowing > 0 .and. self%seen%speed > 0) half_way = t + share_to_rest * self%seen%speed / self%seen%slowing
    end function half_way

    !> Notes whether friction holds a body that is at rest.
    subroutine check_rest(self, formulation, t, y)
        class(segments_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states)
        logical :: was_resting
        was_resting = self%is_resting
        self%is_resting = formulation%action%may_stick
        if (self%is_resting) self%is_resting = .not. formulation%action%excess(t, y) > 0
        if (self%is_resting .and. .not. was_resting) self%t_stuck = t
    end subroutine check_rest

    !> Finds out at the end of a step whether the body is at rest. Where it is nearly, it is brought to rest: then `is_stopped`,
    !> and the time is the later one of rest. With a fixed step size that happens only where friction holds it, at that time.
    subroutine detect_rest(self, stepper, t_end, is_stopped)
        class(segments_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! what took the step
        real(dp), intent(in) :: t_end !! end of the span, s
        logical, intent(out) :: is_stopped !! whether the time and the state were changed
        real(dp) :: allowed, left, y(max_states)

        is_stopped = .false.
        call set_motion(self, stepper%formulation, stepper%t, stepper%y)
        if (.not. self%seen%speed > 0) then
            call check_rest(self, stepper%formulation, stepper%t, stepper%y)
            return
        end if
        self%is_resting = .false.
        associate (speed => self%seen%speed, slowing => self%seen%slowing, is_fixed => stepper%controls%steps > 0)
            allowed = nearly_still * self%largest
            if (is_fixed) allowed = max(allowed, slowing * stepper%h)
            if (.not. (slowing > 0 .and. speed <= allowed)) return
            if (.not. (stepper%formulation%action%may_stick .or. self%seen%across <= rounding * self%largest)) return
            left = min(speed / slowing, t_end - stepper%t)
            y = stepper%formulation%action%at_rest(stepper%t + left, stepper%y, left)
            call check_rest(self, stepper%formulation, stepper%t + left, y)
            if (self%is_resting .or. .not. is_fixed) stepper%y = y
            is_stopped = .not. is_fixed
        end associate
        self%seen%t = -1
        if (.not. is_stopped) return
        stepper%t = stepper%t + left
        stepper%rest = 0
    end subroutine detect_rest

    !> Brings the body to rest in its attitude.
    subroutine begin_rest(self, status)
        class(resting_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        self%y = self%formulation%action%at_rest(self%t, self%y, 0.0_dp)
        self%slope = 0
        status = status_ok
    end subroutine begin_rest

    !> Rests until the torques exceed the friction, or to the end; with a fixed step size over one step.
    subroutine lie(self, status)
        class(resting_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: t, peak
        logical :: changed

        t = self%t_end
        if (self%formulation%action%may_slip) then
            t = min(t, self%t + self%formulation%action%pause(self%t))
            peak = t
            if (.not. excess(self, t) > 0) peak = highest(self, t)
            if (excess(self, peak) > 0) t = root(self, peak)
        end if
        if (self%controls%steps > 0) then
            self%grid = self%grid + 1
            t = grid_time(self)
        end if
        call self%accept_step(t, self%formulation%action%at_rest(t, self%y, 0.0_dp), changed)
        status = status_ok
    end subroutine lie

    !> By how much the torques exceed the friction at a time, N m.
    real(dp) function excess(self, time)
        class(resting_t), intent(in) :: self
        real(dp), intent(in) :: time
        excess = self%formulation%action%excess(time, self%formulation%action%at_rest(time, self%y, 0.0_dp))
    end function excess

    !> The time up to a later one at which they exceed it most, by golden sections; the later one where a parabola has no peak
    !> before it that may reach the friction.
    real(dp) function highest(self, after)
        class(resting_t), intent(in) :: self
        real(dp), intent(in) :: after
        real(dp), parameter :: golden = 0.61803398874989485_dp, resolved = 1.0e-8_dp
        real(dp) :: low, high, x(2), f(2), ends(2), middle, bend

        highest = after
        ends = [excess(self, self%t), excess(self, after)]
        middle = excess(self, self%t + (after - self%t) / 2)
        bend = 2 * middle - sum(ends)
        if (.not. abs(ends(2) - ends(1)) < 2 * bend .or. middle + bend < 0) return
        low = self%t
        high = after
        x = [high - golden * (high - low), low + golden * (high - low)]
        f = [excess(self, x(1)), excess(self, x(2))]
        do while (high - low > resolved * (after - self%t))
            if (f(1) < f(2)) then
                low = x(1)
                x = [x(2), low + golden * (high - low)]
                f = [f(2), excess(self, x(2))]
            else
                high = x(2)
                x = [high - golden * (high - low), x(1)]
                f = [excess(self, x(1)), f(1)]
            end if
            if (.not. (x(1) > low .and. x(2) < high)) exit
        end do
        highest = x(merge(1, 2, f(1) > f(2)))
    end function highest

    !> The first time at which they exceed it, up to one at which they do, by bisection, just beyond.
    real(dp) function root(self, after)
        class(resting_t), intent(in) :: self
        real(dp), intent(in) :: after
        real(dp) :: low, middle
        low = self%t
        root = after
        do
            middle = low + (root - low) / 2
            if (.not. (middle > low .and. middle < root)) exit
            if (excess(self, middle) > 0) then
                root = middle
            else
                low = middle
            end if
        end do
    end function root

    !> The state at rest.
    function state_within(self, t) result(y)
        class(resting_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        y = self%formulation%action%at_rest(t, self%y_last, 0.0_dp)
    end function state_within

    !> Looks at the start, at which the method is, and begins the first segment.
    subroutine begin(self, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        class(stepper_t), target, intent(inout) :: method !! the method, at the start
        class(stepper_t), pointer, intent(inout) :: stepper !! what takes the first step: the method, unless the body rests
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(turning_t) :: start
        status = status_ok
        self%has_series = method%info%needs /= structure_none .and. method%controls%steps == 0
        start = method%formulation%action%turning_at(method%t, method%y)
        self%largest = start%speed
        if (.not. start%speed > 0) call check_rest(self, method%formulation, method%t, method%y)
        call self%lying%start_over(method%formulation, method%t_end)
        self%lying%controls = method%controls
        if (self%is_resting) call go_over(self, by_rest, method, stepper, status)
        if (.not. self%has_series) return
        self%crossing = dop853_t(table=dop853_table(), info=method_info_t('dop853'), controls=method%controls)
        associate (own => self%crossing%controls)
            own%relative_tolerance = max(finest_tolerance, min(crossing_tolerance, own%relative_tolerance))
            own%absolute_tolerance = max(finest_tolerance, min(crossing_tolerance, own%absolute_tolerance))
        end associate
        call self%crossing%start_over(method%formulation, method%t_end)
        self%crossing%invariants = method%invariants
    end subroutine begin

    !> Goes over to the next segment.
    subroutine go_over(self, kind, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        integer, intent(in) :: kind
        class(stepper_t), target, intent(inout) :: method
        class(stepper_t), pointer, intent(inout) :: stepper
        integer, intent(out) :: status
        class(stepper_t), pointer :: next

        self%must_cross = .false.
        if (kind /= self%kind) then
            self%kind = kind
            next => method
            if (kind == by_runge_kutta) next => self%crossing
            if (kind == by_rest) next => self%lying
            call next%go_on_from(stepper)
            stepper => next
        end if
        if (kind == by_runge_kutta) stepper%t_end = latest_end(self, stepper, method%t_end)
        call stepper%begin(status)
        if (kind == by_runge_kutta) stepper%h = first_part * stepper%h
    end subroutine go_over

    !> The time up to which a step may reach in which f is smooth: to a knot, or half-way to rest.
    real(dp) function latest_end(self, stepper, t_end)
        class(segments_t), intent(inout) :: self
        class(stepper_t), intent(in) :: stepper
        real(dp), intent(in) :: t_end
        latest_end = min(t_end, stepper%formulation%action%smooth_until(stepper%t))
        if (stepper%formulation%action%may_stick .or. (stepper%formulation%action%may_turn .and. self%has_series)) then
            latest_end = min(latest_end, half_way(self, stepper%formulation, stepper%t, stepper%y))
        end if
    end function latest_end

    !> Takes a step in the segment. Where the method has no series, its segment ends, and a Runge-Kutta step follows.
    subroutine advance(self, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        class(stepper_t), target, intent(inout) :: method !! the method
        class(stepper_t), pointer, intent(inout) :: stepper !! what takes the step
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        self%keeps_direction = .false.
        if (self%kind /= by_method .or. method%controls%steps > 0) then
            call stepper%advance(status)
            return
        end if
        call limit_step(self, method, status)
        if (.not. (self%has_series .and. (status == status_non_finite .or. status == status_step_too_small))) return
        call go_over(self, by_runge_kutta, method, stepper, status)
        if (is_ok(status)) call stepper%advance(status)
    end subroutine advance

    !> Takes a step of an adaptive method in which f is smooth. A step by series in double precision is looked at when it is
    !> done, which is cheap, as its state can be had at any time.
    subroutine limit_step(self, method, status)
        class(segments_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: method
        integer, intent(out) :: status
        real(dp) :: t_end, latest, speed(2)
        logical :: looks_back

        t_end = method%t_end
        associate (action => method%formulation%action)
            looks_back = action%may_turn .and. method%info%needs == structure_series .and. .not. action%may_stick
            if (looks_back) then
                method%t_end = min(t_end, action%smooth_until(method%t))
            else
                method%t_end = latest_end(self, method, t_end)
            end if
        end associate
        call method%advance(status)
        if (is_ok(status) .and. looks_back) then
            call check_direction(method, self%keeps_direction, speed)
            if (self%keeps_direction) then
                self%largest = max(self%largest, speed(1), speed(2))
                self%steepest = max(self%steepest, (speed(1) - speed(2)) / (method%t - method%t_last))
            else
                latest = half_way(self, method%formulation, method%t_last, method%y_last)
                if (latest < method%t) call end_step_at(method, latest, method%state_within(latest), status)
            end if
        end if
        if (is_ok(status) .and. self%has_series .and. .not. self%keeps_direction) then
            if (may_reverse(method)) call end_before_reversal(method, self%must_cross, status)
        end if
        if (is_ok(status) .and. method%formulation%action%has_rows) call end_at_row(method, self%has_series, status)
        method%t_end = t_end
    end subroutine limit_step

    !> Ends a step: finds out whether the body comes to rest, or begins to move, and goes over to the next segment if this one
    !> ends.
    subroutine end_step(self, method, stepper, status)
        class(segments_t), target, intent(inout) :: self
        class(stepper_t), target, intent(inout) :: method !! the method
        class(stepper_t), pointer, intent(inout) :: stepper !! what took the step, then what takes the next
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        logical :: was_resting, is_stopped
        real(dp) :: jump
        integer :: next

        status = status_ok
        was_resting = self%is_resting
        jump = stepper%t
        if (method%controls%steps == 0) jump = min(stepper%formulation%action%after_jump(stepper%t), method%t_end)
        self%passes_jump = jump > stepper%t
        if (self%passes_jump) stepper%t = jump
        is_stopped = .false.
        if (stepper%formulation%action%may_stick .or. &
            (stepper%formulation%action%may_turn .and. self%has_series .and. .not. self%keeps_direction)) then
            call detect_rest(self, stepper, method%t_end, is_stopped)
        end if
        self%occasion = occasion_none
        if (self%is_resting .and. .not. was_resting) self%occasion = occasion_stuck
        if (was_resting .and. .not. self%is_resting) self%occasion = occasion_slip
        next = merge(by_runge_kutta, by_method, self%must_cross)
        if (self%is_resting) next = by_rest
        if (next == self%kind .and. .not. (self%passes_jump .or. (is_stopped .and. next == by_method))) return
        if (stepper%t < method%t_end) call go_over(self, next, method, stepper, status)
    end subroutine end_step

    !> Ends a step earlier, at a time and in a state within it.
    subroutine end_step_at(stepper, t, y, status)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        logical :: changed
        stepper%t = t
        stepper%y = y
        stepper%rest = 0
        call stepper%project(changed)
        call stepper%begin(status)
    end subroutine end_step_at

    !> Whether the angular velocity, and the velocity on which drag depends, are far from any reversal in a step by series: all
    !> terms of its series together are less than `small_change` of their magnitude. Then the step is also shorter than half of
    !> the time to rest.
    subroutine check_direction(stepper, is_kept, speed)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        logical, intent(out) :: is_kept !! whether they are
        real(dp), intent(out) :: speed(2) !! magnitude of the angular velocity at the ends of the step, if they are, rad/s
        real(dp) :: span, change(max_states)
        type(reach_t) :: first, last

        speed = 0
        change = stepper%bound_of_changes()
        is_kept = .false.
        if (stepper%formulation%action%has_load .or. .not. all(change < huge(change))) return
        span = stepper%t - stepper%t_last
        first = stepper%formulation%action%reach_of(stepper%t_last, stepper%y_last, span, change)
        is_kept = first%change < small_change * min(first%speed, first%dragged)
        if (.not. is_kept .and. first%change < small_change * first%speed) is_kept = .not. turns_back()
        if (.not. is_kept) return
        last = stepper%formulation%action%reach_of(stepper%t, stepper%y, 0.0_dp, change)
        speed = [first%speed, last%speed]

    contains

        !> Whether the velocity on which drag depends reverses.
        logical function turns_back()
            real(dp) :: t(0:instants), y(0:instants, max_states)
            integer :: i
            t = stepper%t_last + span * [(real(i, dp) / instants, i=0, instants)]
            y(0, :) = stepper%y_last
            call stepper%states_within(t(1:), y(1:, :))
            turns_back = stepper%formulation%action%drag_turns(t, y)
        end function turns_back

    end subroutine check_direction

    !> Whether one of the vectors may vanish in a step: always under friction that is dry or depends on the support, and under a
    !> drag where one turns by more than a right angle in half of the step.
    logical function may_reverse(stepper)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        real(dp) :: middle, first(3, directions), at_middle(3, directions), last(3, directions)
        may_reverse = stepper%formulation%action%may_stick
        if (may_reverse .or. .not. stepper%formulation%action%may_turn) return
        middle = stepper%t_last + (stepper%t - stepper%t_last) / 2
        at_middle = stepper%formulation%action%directions_at(middle, stepper%interpolate(middle))
        first = stepper%formulation%action%directions_at(stepper%t_last, stepper%y_last)
        last = stepper%formulation%action%directions_at(stepper%t, stepper%y)
        may_reverse = norm2(at_middle(:, direction_force)) > 0 .or. which_reversed(first, first, at_middle) > 0 .or. &
            which_reversed(first, at_middle, last) > 0
    end function may_reverse

    !> Which vector reverses; 0 if none does: it differs by more than a right angle from what it was before, or, of the support
    !> force, by less from what it was at first.
    pure integer function which_reversed(first, before, now) result(which)
        real(dp), intent(in) :: first(3, directions), before(3, directions), now(3, directions)
        integer :: i
        which = findloc([(has_reversed(i, first, before, now), i=1, directions)], .true., dim=1)
    end function which_reversed

    pure logical function has_reversed(which, first, before, now)
        integer, intent(in) :: which
        real(dp), intent(in) :: first(3, directions), before(3, directions), now(3, directions)
        if (which == direction_force) then
            has_reversed = dot_product(first(:, which), now(:, which)) < turned * norm2(first(:, which)) * norm2(now(:, which))
        else
            has_reversed = dot_product(before(:, which), now(:, which)) < 0
        end if
    end function has_reversed

    !> Ends a step before a vector reverses in it. Where the angular velocity does, a plane motion comes to rest; that of a
    !> motion that is nearly plane reverses too, as far as its terms can tell. Where another vector vanishes, a step without
    !> series must follow, from there: `must_cross`. If that is the beginning of the step, the step is undone and the status
    !> is that of a step that is too small.
    subroutine end_before_reversal(stepper, must_cross, status)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        logical, intent(out) :: must_cross !! whether a step without series must follow
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: span, times(instants), y(instants, max_states), lower
        real(dp) :: first(3, directions), before(3, directions), now(3, directions)
        integer :: i, which

        must_cross = .false.
        span = stepper%t - stepper%t_last
        first = stepper%formulation%action%directions_at(stepper%t_last, stepper%y_last)
        do
            times = stepper%t_last + span * [(real(i, dp) / instants, i=1, instants)]
            call stepper%states_within(times, y)
            before = first
            do i = 1, instants
                now = stepper%formulation%action%directions_at(times(i), y(i, :))
                which = which_reversed(first, before, now)
                if (which > 0) exit
                before = now
            end do
            ! Not within the first part, or at once.
            if (i > 1 .or. which /= direction_omega .or. .not. times(1) > stepper%t_last) exit
            span = span / instants
        end do
        if (which == 0) return
        lower = stepper%t_last
        if (i > 1) lower = times(i - 1)
        if (which == direction_omega) then
            if (i > 1) call end_step_at(stepper, lower, y(i - 1, :), status)
            return
        end if
        call approach(stepper, which, first, lower, times(i), must_cross)
        if (lower - stepper%t_last > spacings * spacing(lower)) then
            call end_step_at(stepper, lower, stepper%state_within(lower), status)
        else
            must_cross = .false.
            stepper%t = stepper%t_last
            stepper%y = stepper%y_last
            stepper%rest = 0
            status = status_step_too_small
        end if
    end subroutine end_before_reversal

    !> Moves the lower of two times, between which a vector reverses, to the last at which it has not; if it does not vanish
    !> there, to a part of the way to that.
    subroutine approach(stepper, which, first, lower, upper, vanishes)
        class(stepper_t), intent(inout) :: stepper
        integer, intent(in) :: which
        real(dp), intent(in) :: first(3, directions)
        real(dp), intent(inout) :: lower
        real(dp), intent(in) :: upper
        logical, intent(out) :: vanishes
        real(dp) :: last, times(instants), y(instants, max_states), before(3, directions), now(3, directions)
        integer :: i

        last = upper
        before = stepper%formulation%action%directions_at(lower, stepper%state_within(lower))
        do while (last - lower > spacings * spacing(last))
            times = lower + (last - lower) * [(real(i, dp) / instants, i=1, instants)]
            times(instants) = last
            call stepper%states_within(times, y)
            do i = 1, instants - 1
                now = stepper%formulation%action%directions_at(times(i), y(i, :))
                if (has_reversed(which, first, before, now)) exit
            end do
            last = times(i)
            if (i > 1) lower = times(i - 1)
        end do
        now = stepper%formulation%action%directions_at(lower, stepper%state_within(lower))
        vanishes = norm2(now(:, which)) <= vanishing * norm2(first(:, which))
        if (.not. vanishes) lower = stepper%t_last + part_of_way * (lower - stepper%t_last)
    end subroutine approach

    !> Ends a step just after the first instant at which the angular velocity is beyond a row.
    subroutine end_at_row(stepper, is_series, status)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        logical, intent(in) :: is_series !! whether the step is by series
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(row_interval_t) :: rows
        real(dp) :: spin(2), t, y(max_states)
        integer :: row
        logical :: passes

        rows = stepper%formulation%action%interval_of_rows(stepper%t_last, stepper%y_last)
        if (.not. is_series) then
            ! States within a step cost evaluations of f, and few steps come near a row.
            spin(1) = stepper%formulation%action%spin_of_rows(stepper%t_last, stepper%y_last)
            spin(2) = stepper%formulation%action%spin_of_rows(stepper%t, stepper%y)
            if (min(rows%upper - maxval(spin), minval(spin) - rows%lower) > abs(spin(2) - spin(1))) return
        end if
        t = stepper%t_last
        ! One row may be passed at the beginning.
        do row = 1, 2
            call find_row(stepper, rows, t, y, passes)
            if (.not. passes) return
            if (is_series) then
                call end_step_at(stepper, t, y, status)
                return
            else if (t - stepper%t_last > shortest * (stepper%t - stepper%t_last)) then
                call take_again(stepper, t, status)
                return
            end if
            rows = stepper%formulation%action%interval_of_rows(t, y)
        end do
    end subroutine end_at_row

    !> Finds the first instant from `t` on at which the angular velocity is beyond the rows, and the state then.
    subroutine find_row(stepper, rows, t, y, passes)
        class(stepper_t), intent(inout) :: stepper
        type(row_interval_t), intent(in) :: rows
        real(dp), intent(inout) :: t
        real(dp), intent(out) :: y(max_states)
        logical, intent(out) :: passes
        real(dp) :: lower, upper, times(0:instants), states(0:instants, max_states), spin(0:instants)
        integer :: i, peak

        passes = .false.
        i = 0
        lower = t
        upper = stepper%t
        do while (upper - lower > spacings * spacing(upper))
            times = lower + (upper - lower) * [(real(i, dp) / instants, i=0, instants)]
            times(instants) = upper
            states(0, :) = stepper%state_within(lower)
            call stepper%states_within(times(1:), states(1:, :))
            do i = 0, instants
                spin(i) = stepper%formulation%action%spin_of_rows(times(i), states(i, :))
            end do
            i = findloc(spin(1:) > rows%upper .or. spin(1:) < rows%lower, .true., dim=1)
            if (i > 0) then
                lower = times(i - 1)
                upper = times(i)
                cycle
            end if
            peak = place_of_peak(spin, rows)
            if (peak == 0) return
            lower = times(peak - 1)
            upper = times(peak + 1)
        end do
        passes = i > 0 .and. upper < stepper%t
        if (.not. passes) return
        t = upper
        y = states(i, :)
    end subroutine find_row

    !> Takes a step again, up to a time within it.
    subroutine take_again(stepper, t, status)
        class(stepper_t), intent(inout) :: stepper
        real(dp), intent(in) :: t
        integer, intent(out) :: status
        stepper%t_end = t
        call end_step_at(stepper, stepper%t_last, stepper%y_last, status)
        if (.not. is_ok(status)) return
        stepper%h = t - stepper%t
        call stepper%advance(status)
    end subroutine take_again

    !> The inner instant at which the angular velocity is an extreme that may pass a row before or after it; 0 if there is none.
    pure integer function place_of_peak(spin, rows) result(peak)
        real(dp), intent(in) :: spin(0:instants)
        type(row_interval_t), intent(in) :: rows
        real(dp) :: rise, fall
        do peak = 1, instants - 1
            rise = spin(peak) - min(spin(peak - 1), spin(peak + 1))
            fall = max(spin(peak - 1), spin(peak + 1)) - spin(peak)
            if (min(spin(peak) - spin(peak - 1), spin(peak) - spin(peak + 1)) >= 0 .and. spin(peak) + rise > rows%upper) return
            if (max(spin(peak) - spin(peak - 1), spin(peak) - spin(peak + 1)) <= 0 .and. spin(peak) - fall < rows%lower) return
        end do
        peak = 0
    end function place_of_peak

end module spintop_segments
