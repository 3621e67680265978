!> The steps of many bodies in lanes, from the Taylor coefficients of their motions: how long they are, and where they end. Each
!> lane for itself, by lane_steps.h.
!>
!> And the angle that the states of lanes leave out, (s phi - psi)/2: followed over a step in all lanes where its change is certain,
!> and along a step of one lane in paces short enough to resolve its turns, on the side on which the axis passes a pole, or
!> through it. See "At a pole" in doc/theory.md.
module spintop_lane_steps
    use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: nearest_turn
    use spintop_kernel_types, only: lane_body_t
    use spintop_kinds, only: dp, pi
    use spintop_lane_series, only: lanes, parts, rows
    use spintop_motion, only: passages_t
    use spintop_motions, only: instants
    use spintop_pole_passages, only: settle_passage, way_t
    implicit none
    private
    public :: choose_durations, end_before_reversals, add_steps, rows_at, step_underflow, non_finite
    public :: lane_numbers_t, follow, walk, watch_poles, turns_far, border, largest_turn, sharp

    !> Reasons for which a lane takes no step: its size underflows or no more steps are allowed; a number is
    !> not finite.
    integer(int64), parameter :: step_underflow = 1, non_finite = 2

    !> A step is halved so often before a drag reverses, at the most; and once more.
    integer, parameter :: most_halvings = 30

    !> The numbers of the lanes.
    type, bind(C) :: lane_numbers_t
        !> Current time, time before the last step, and end of the span, s. A lane at its end stays there.
        real(c_double), dimension(lanes) :: t = 0, t_last = 0, t_end = 0
        !> The last step, wanted and taken, s, and the largest angular velocity, rad/s.
        real(c_double), dimension(lanes) :: h = 0, duration = 0, scale = 1
        !> The side s; (s phi - psi)/2 to 2e-5, continuous along the motion, rad; -1 where the
        !> quaternion is the negative of that of the angles.
        real(c_double), dimension(lanes) :: side = 1, other = 0, sense = 1
        !> The side in the last step, and the other angle where it began and where it ended.
        real(c_double), dimension(lanes) :: side_last = 1, other_last = 0, other_then = 0
        !> Square of the angular velocity, the larger of both ends of the step, rad^2/s^2.
        real(c_double), dimension(lanes) :: rate = 0
        !> A bound of what bends the way of the other angle about a pole (`find_circling`), 1/s^2.
        real(c_double), dimension(lanes) :: bend = 0
        !> (omega, Gamma, xi) at `t`, and its compensation term (Kahan): the state is state + rest.
        real(c_double), dimension(lanes, parts) :: state = 0, rest = 0
        !> How far off a pole is passed through, rad; the square of the distance at which a place is in a pole; how far off the
        !> motion may be, rad.
        real(c_double), dimension(lanes) :: reach = 0, in_pole2 = 0, error = 0
        type(lane_body_t) :: body = lane_body_t()
    end type lane_numbers_t

    !> s Gamma3 at which a lane changes its side: beyond the middle, so that a body near it does not change in
    !> every step, and far from the singularity of xi.
    real(dp), parameter :: border = -0.2_dp
    !> Rotation of the body over which the other angle changes by less than half a turn, rad.
    real(dp), parameter :: largest_turn = pi / 2
    !> A larger change of the other angle indicates a pole, rad.
    real(dp), parameter :: sharp = 2
    !> A chord between two points z whose arguments differ by x, up to `sharp`, stays away from zero by cos(x/2) times the
    !> smaller of both magnitudes, and the path over a time h leaves it by |z''| h^2/8 at most. So it passes zero on the
    !> side of its chord while |z''| h^2 is at most this less x^2, times that magnitude.
    real(dp), parameter :: straight = 8

    !> Reasons to examine a lane after a step: it changes its side; it rotated too far to be followed.
    integer(int64), parameter :: changes_side = 1, turns_far = 2
    !> No reason. As wide as the numbers beside which they are found, so that both are in one vector.
    integer(int64), parameter :: no_reason = 0

    !> A pole that is passed within this fraction of a step is passed on an arbitrary side.
    real(dp), parameter :: shortest_pace = 1.0e-12_dp

    interface
        !> Durations of the steps, s: until one of the last two terms of the series reaches the tolerance, relative to the magnitude
        !> of omega, to the unit vector and to a radian. The absolute tolerance is a fraction of the largest angular velocity,
        !> `scale`, and in radians. A step is at most `growth` times the last one, shorter than allowed by the factor `safety`, and
        !> stretched to the end of the span if the factor `stretch` suffices.
        pure subroutine choose_durations(order, absolute, relative, growth, safety, stretch, shortest, most, c, scale, t, t_end, &
                                         steps, h, duration, trouble) bind(C, name='spintop_choose_durations')
            import :: c_double, c_int, c_int64_t
            integer(c_int), value :: order !! order of the series
            integer(c_int64_t), value :: most !! maximum number of steps
            real(c_double), value :: absolute, relative, growth, safety, stretch, shortest
                !! tolerances; factors; the shortest step, as a share of the time
            real(c_double), dimension(*), intent(in) :: c, scale, t, t_end
                !! Taylor coefficients; largest angular velocity, rad/s; time and end of the span, s
            integer(c_int64_t), intent(in) :: steps(*) !! number of steps so far
            real(c_double), dimension(*), intent(inout) :: h, duration !! last step sizes, replaced by these; durations, s
            integer(c_int64_t), intent(inout) :: trouble(*) !! `step_underflow`, `non_finite` or 0
        end subroutine choose_durations

        !> The states at times after the beginning of the step, or the angular velocities alone.
        pure subroutine rows_at(many, order, c, t, states) bind(C, name='spintop_rows_at')
            import :: c_double, c_int
            integer(c_int), value :: many, order !! `parts` or 3; order of the series
            real(c_double), intent(in) :: c(*), t(*) !! Taylor coefficients (lane, row, term); times, s
            real(c_double), intent(inout) :: states(*) !! what they are then (lane, row)
        end subroutine rows_at

        !> Adds to the states their change over the steps. Lanes whose step has no length stay as they are.
        pure subroutine add_steps(order, c, duration, t_end, t_last, t, state, rest) bind(C, name='spintop_add_steps')
            import :: c_double, c_int
            integer(c_int), value :: order !! order of the series
            real(c_double), dimension(*), intent(in) :: c, duration, t_end !! coefficients; lengths of steps, ends of spans, s
            real(c_double), dimension(*), intent(inout) :: t_last, t, state, rest
                !! time before the step, and time reached, s; states and their compensation terms
        end subroutine add_steps
    end interface

contains

    !> Ends the coming steps before a drag reverses, as its series would go on with the drag of the old direction: where the
    !> angular velocity turns by more than a right angle in half of the step there is none; where the velocity of a dragged centre
    !> of mass does in an eighth of it, the step is halved. A motion that passes such a point at a distance goes on by short steps.
    pure subroutine end_before_reversals(order, c, has_cusps, r, duration, reverses)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order) !! their coefficients: lane, variable, order
        logical, intent(in) :: has_cusps(lanes) !! lanes with a drag that turns with the angular velocity at once
        real(dp), intent(in) :: r(lanes, 3) !! centre of mass that is dragged, m; 0 if none is
        real(dp), intent(inout) :: duration(lanes) !! coming step, s
        logical, intent(out) :: reverses(lanes) !! lanes in which no step is short enough
        real(dp), dimension(lanes, 3) :: middle, last
        logical :: turns(lanes), is_halved(lanes)
        integer :: i

        call rows_at(3, order, c, duration / 2, middle)
        call rows_at(3, order, c, duration, last)
        reverses = has_cusps .and. (product_of(middle, c(:, 1:3, 0)) < 0 .or. product_of(middle, last) < 0)
        if (.not. any(abs(r) > 0)) return
        is_halved = .false.
        do i = 0, most_halvings
            call find_turns(order, c, duration, r, turns)
            if (.not. any(turns)) exit
            is_halved = is_halved .or. turns
            where (turns) duration = duration / 2
        end do
        where (is_halved) duration = duration / 2
        reverses = reverses .or. turns
    end subroutine end_before_reversals

    !> Whether the velocity of a dragged centre of mass turns so much.
    pure subroutine find_turns(order, c, duration, r, turns)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order), duration(lanes), r(lanes, 3)
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
            call rows_at(3, order, c, duration * k / instants, w)
            v = cross_of(w, r)
            turns = turns .or. product_of(v, before) < least
            before = v
        end do
    end subroutine find_turns

    !> Scalar products of vectors in each lane.
    pure function product_of(a, b) result(product)
        real(dp), intent(in) :: a(lanes, 3), b(lanes, 3)
        real(dp) :: product(lanes)
        product = a(:, 1) * b(:, 1) + a(:, 2) * b(:, 2) + a(:, 3) * b(:, 3)
    end function product_of

    !> Vector products of these.
    pure function cross_of(a, b) result(product)
        real(dp), intent(in) :: a(lanes, 3), b(lanes, 3)
        real(dp) :: product(lanes, 3)
        product(:, 1) = a(:, 2) * b(:, 3) - a(:, 3) * b(:, 2)
        product(:, 2) = a(:, 3) * b(:, 1) - a(:, 1) * b(:, 3)
        product(:, 3) = a(:, 1) * b(:, 2) - a(:, 2) * b(:, 1)
    end function cross_of

    !> Follows the other angle over the steps, where that is certain; `doubt` says where not,
    !> and where the side is to be changed, `most` its largest value. Where a whole step is too long, it
    !> is looked at in two parts. `rate` is the square of the angular velocity, the larger of both ends, or
    !> of what stands for it where the axis circles about a pole, rad^2/s^2.
    pure subroutine follow(order, c, now, doubt, most)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order) !! Taylor coefficients
        type(lane_numbers_t), intent(inout) :: now !! the lanes at the end of the step
        integer(int64), intent(out) :: doubt(lanes), most
            !! `changes_side`, `turns_far` or 0, and the largest of these
        real(dp), dimension(lanes) :: change, part, first, second, between, circling, strays
        real(dp) :: middle(lanes, parts), longest, nearest
        integer :: i

        associate (duration => now%duration, side => now%side, in_pole2 => now%in_pole2, state => now%state, &
                   other => now%other, rate => now%rate, bend => now%bend)
            call changes_to(state, other, change)
            call find_circling(order, c, duration, change, circling, bend, strays)
            most = 0
            !$omp simd private(nearest) reduction(max: most)
            do i = 1, lanes
                nearest = min(c(i, 4, 0)**2 + c(i, 5, 0)**2, state(i, 4)**2 + state(i, 5)**2)
                rate(i) = max(c(i, 1, 0)**2 + c(i, 2, 0)**2 + c(i, 3, 0)**2, &
                              state(i, 1)**2 + state(i, 2)**2 + state(i, 3)**2, circling(i))
                doubt(i) = merge(no_reason, changes_side, side(i) * state(i, 6) >= border)
                doubt(i) = merge(doubt(i), turns_far, duration(i)**2 * rate(i) <= largest_turn**2 &
                                 .and. abs(change(i)) <= sharp)
                ! Positive where the path may pass zero on another side than its chord.
                strays(i) = merge(duration(i)**2 * strays(i) - (straight - change(i)**2) * sqrt(nearest), 0.0_dp, &
                                abs(change(i)) <= sharp)
                strays(i) = merge(1.0_dp, strays(i), nearest <= in_pole2(i))
                most = max(most, doubt(i))
            end do
            if (most >= turns_far) then
                !$omp simd
                do i = 1, lanes
                    part(i) = merge(0.5_dp, closest_to_pole(c(i, 4:5, 0), state(i, 4:5)), abs(change(i)) <= sharp)
                end do
                call rows_at(parts, order, c, part * duration, middle)
                call changes_to(middle, other, first)
                between = other + first
                call changes_to(state, between, second)
                !$omp simd private(longest)
                do i = 1, lanes
                    longest = max(part(i), 1 - part(i)) * duration(i)
                    change(i) = merge(change(i), first(i) + second(i), doubt(i) < turns_far)
                    doubt(i) = merge(doubt(i), merge(no_reason, changes_side, side(i) * state(i, 6) >= border), &
                                     doubt(i) < turns_far .or. longest**2 * rate(i) > largest_turn**2 &
                                     .or. max(abs(first(i)), abs(second(i))) > sharp &
                                     .or. middle(i, 4)**2 + middle(i, 5)**2 <= in_pole2(i))
                end do
            end if
            most = 0
            !$omp simd reduction(max: most)
            do i = 1, lanes
                doubt(i) = merge(doubt(i), turns_far, strays(i) <= 0)
                most = max(most, doubt(i))
                other(i) = other(i) + merge(0.0_dp, change(i), doubt(i) >= turns_far)
            end do
        end associate
    end subroutine follow

    !> Counts the passages of poles within the errors of the motions, at the ends of steps.
    pure subroutine watch_poles(error, state, passed)
        real(dp), intent(in) :: error(lanes), state(lanes, parts) !! how far off the motions may be, rad; states
        type(passages_t), intent(inout) :: passed(lanes) !! the passages
        real(dp) :: square(lanes), least
        integer :: i
        least = 1
        !$omp simd reduction(min: least)
        do i = 1, lanes
            square(i) = state(i, 4)**2 + state(i, 5)**2
            least = min(least, square(i) - error(i)**2)
        end do
        if (.not. (least < 0 .or. any(passed%is_close))) return
        do i = 1, lanes
            call passed(i)%watch(square(i), error(i))
        end do
    end subroutine watch_poles

    !> Next to a pole the axis may circle about it while the body hardly turns. With the derivatives z1, z2, z3 of
    !> z = (Gamma2 + i Gamma1) exp(-i xi/2), which turns as the other angle does, its way over the step h is about
    !> straight as long as (|z2| + h |z3|) h^2 is at most |z| + h |z1|. `circling` is the square of the angular velocity
    !> that would limit the step alike, and `bend` is the larger of |z2| and |z2 + h z3|, `strays` the same where it matters.
    pure subroutine find_circling(order, c, h, change, circling, bend, strays)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order), h(lanes), change(lanes)
        real(dp), intent(out) :: circling(lanes), bend(lanes), strays(lanes)
        !> A step is divided into so many at most.
        real(dp), parameter :: largest_turn2 = largest_turn**2, most_parts = 16
        real(dp) :: k, x0, y0, x1, y1, x2, y2, x3, y3
        integer :: i
        !$omp simd private(k, x0, y0, x1, y1, x2, y2, x3, y3)
        do i = 1, lanes
            k = c(i, 7, 1) / 2
            x0 = c(i, 5, 0)
            y0 = c(i, 4, 0)
            x1 = c(i, 5, 1) + k * y0
            y1 = c(i, 4, 1) - k * x0
            x2 = 2 * c(i, 5, 2) + 2 * k * c(i, 4, 1) - k**2 * x0
            y2 = 2 * c(i, 4, 2) - 2 * k * c(i, 5, 1) - k**2 * y0
            x3 = 6 * c(i, 5, 3) + 6 * k * c(i, 4, 2) - 3 * k**2 * c(i, 5, 1) - k**3 * y0
            y3 = 6 * c(i, 4, 3) - 6 * k * c(i, 5, 2) - 3 * k**2 * c(i, 4, 1) + k**3 * x0
            bend(i) = sqrt(max(x2**2 + y2**2, (x2 + h(i) * x3)**2 + (y2 + h(i) * y3)**2))
            ! A path that leaves zero, or that begins to turn the way that its ends suggest (z turns against the other
            ! angle), has not turned round zero the other way.
            strays(i) = merge(bend(i), 0.0_dp, x0 * x1 + y0 * y1 < 0 .and. change(i) * (x0 * y1 - y0 * x1) > 0)
            circling(i) = largest_turn2 * ((abs(x2) + abs(y2)) + h(i) * (abs(x3) + abs(y3))) &
                / max((abs(x0) + abs(y0)) + h(i) * (abs(x1) + abs(y1)), tiny(k))
            circling(i) = min(circling(i), (most_parts * largest_turn / max(h(i), sqrt(tiny(k))))**2)
        end do
    end subroutine find_circling

    !> Where a straight way from one (Gamma1, Gamma2) to another comes closest to the pole, as a share of the way,
    !> but not at an end.
    pure real(dp) function closest_to_pole(from, to) result(part)
        real(dp), intent(in) :: from(2), to(2) !! the two points (Gamma1, Gamma2)
        real(dp), parameter :: least = 1.0_dp / 16
        real(dp) :: way(2)
        way = to - from
        part = -(from(1) * way(1) + from(2) * way(2)) / max(way(1)**2 + way(2)**2, tiny(part))
        part = min(max(part, least), 1 - least)
    end function closest_to_pole

    !> Changes of the other angle from `other` to that of a state, to 2e-5, at most half a turn.
    pure subroutine changes_to(state, other, change)
        real(dp), intent(in) :: state(lanes, parts), other(lanes) !! states, and the other angles before, rad
        real(dp), intent(out) :: change(lanes) !! changes of the other angle, rad
        real(dp), parameter :: turn = 2 * pi
        real(dp) :: apart
        integer :: i
        !$omp simd private(apart)
        do i = 1, lanes
            apart = state(i, 7) / 2 - rough_angle(state(i, 4), state(i, 5)) - other(i)
            apart = apart - turn * anint(apart * (1 / turn))
            ! At a pole there is no such angle, and it stays as it was.
            change(i) = merge(apart, 0.0_dp, abs(state(i, 4)) + abs(state(i, 5)) > 0)
        end do
    end subroutine changes_to

    !> atan2(y, x) to 2e-5, made of vector instructions (Abramowitz and Stegun, 4.4.49).
    elemental real(dp) function rough_angle(y, x) result(angle)
        real(dp), intent(in) :: y, x
        real(dp) :: slope, square
        slope = min(abs(x), abs(y)) / max(abs(x), abs(y), tiny(x))
        square = slope**2
        angle = slope * (0.9998660_dp + square * (-0.3302995_dp + square * (0.1801410_dp &
            + square * (-0.0851330_dp + square * 0.0208351_dp))))
        angle = merge(pi / 2 - angle, angle, abs(y) > abs(x))
        angle = merge(pi - angle, angle, x < 0)
        angle = sign(angle, y)
    end function rough_angle

    !> Follows the other angle, and the passages through poles, from a time and place within the step on to a later one, in paces
    !> short enough to resolve the turns of the body, and on which side its axis passes a pole, or that it passes through it.
    pure recursive subroutine walk(now, lane, order, c, goal, looks, t, gamma, other, passed)
        type(lane_numbers_t), intent(in) :: now !! the lanes
        integer, intent(in) :: lane, order !! index of the lane; order of its series
        real(dp), intent(in) :: c(rows, 0:order), goal !! Taylor coefficients of the lane; time within the step, s
        integer(int64), intent(inout) :: looks !! how often the step may be looked at; without any left the turns are not known
        real(dp), intent(inout) :: t, gamma(2), other !! time, s; (Gamma1, Gamma2) then; the other angle, rad
        type(passages_t), intent(inout) :: passed !! the passages
        real(dp) :: place(4), new, pace, part, middle
        logical :: is_sure
        integer :: k

        pace = goal - t
        if (.not. (pace > 0 .and. looks > 0)) return
        looks = looks - 1
        associate (t_last => now%t_last(lane), rate => sqrt(now%rate(lane)))
            place = 0
            do k = order, 0, -1
                place = place * (goal - t_last) + c(4:parts, k)
            end do
            new = other
            if (any(abs(place(1:2)) > 0)) new = nearest_turn(place(4) / 2 - atan2(place(1), place(2)), other)
            is_sure = pace * rate <= largest_turn .and. abs(new - other) <= sharp .and. pace**2 * now%bend(lane) &
                      <= (straight - (new - other)**2) * sqrt(min(sum(gamma**2), sum(place(1:2)**2)))
            if (pace * rate <= largest_turn .and. (passed%arrived .or. .not. is_sure &
                                                   .or. sum(place(1:2)**2) <= now%in_pole2(lane))) then
                call pass(now, lane, order, c, t, goal, other, passed, new, is_sure)
            end if
            if (is_sure .or. pace <= max(shortest_pace * (now%t(lane) - t_last), 2 * spacing(goal))) then
                t = goal
                gamma = place(1:2)
                other = new
                call passed%watch(sum(gamma**2), now%error(lane))
            else
                part = 0.5_dp
                if (pace * rate <= largest_turn .and. .not. passed%arrived) part = closest_to_pole(gamma, place(1:2))
                middle = t + part * pace
                ! Late in the motion a small part of the pace is less than the spacing of the time.
                if (.not. (middle > t .and. middle < goal)) middle = t + pace / 2
                call walk(now, lane, order, c, middle, looks, t, gamma, other, passed)
                call walk(now, lane, order, c, goal, looks, t, gamma, other, passed)
            end if
        end associate
    end subroutine walk

    !> Continues the other angle through a pole, if the axis passes through it or is in it.
    pure subroutine pass(now, lane, order, c, t, goal, other, passed, new, is_sure)
        type(lane_numbers_t), intent(in) :: now
        integer, intent(in) :: lane, order
        real(dp), intent(in) :: c(rows, 0:order)
        real(dp), intent(in) :: t, goal, other !! times within the last step, s; the other angle at the first, rad
        type(passages_t), intent(inout) :: passed
        real(dp), intent(inout) :: new !! the other angle at the goal, rad
        logical, intent(inout) :: is_sure !! whether it is certain
        type(way_t) :: here, there
        real(dp) :: xi_here, xi_there, phi
        logical :: had_arrived, is_decided
        had_arrived = passed%arrived
        call way(now, lane, order, c, t, here, xi_here)
        call way(now, lane, order, c, goal, there, xi_there)
        associate (side => now%side_last(lane))
            phi = side * (xi_here / 2 + other)
            call settle_passage(here, there, goal - t, now%reach(lane), passed, phi, is_decided)
            if (is_decided) new = side * phi - xi_there / 2
        end associate
        is_sure = is_decided .or. (is_sure .and. .not. had_arrived)
    end subroutine pass

    !> The way of body z at a time within the last step, and xi there. With z = Gamma2 + i Gamma1 and s = 1 its place is
    !> exp(i xi) conj(z), with s = -1 the conjugate of that.
    pure subroutine way(now, lane, order, c, t, there, xi)
        type(lane_numbers_t), intent(in) :: now
        integer, intent(in) :: lane, order
        real(dp), intent(in) :: c(rows, 0:order)
        real(dp), intent(in) :: t !! time within the last step, s
        type(way_t), intent(out) :: there
        real(dp), intent(out) :: xi !! the angle that completes the attitude then, rad
        real(dp) :: x(4, 0:2)
        complex(dp) :: z(0:2), turn, spin
        integer :: k
        x = 0
        do k = order, 0, -1
            x(:, 2) = x(:, 2) * (t - now%t_last(lane)) + x(:, 1)
            x(:, 1) = x(:, 1) * (t - now%t_last(lane)) + x(:, 0)
            x(:, 0) = x(:, 0) * (t - now%t_last(lane)) + c(4:parts, k)
        end do
        x(:, 2) = 2 * x(:, 2)
        xi = x(4, 0)
        z = cmplx(x(2, :), -x(1, :), dp)
        turn = cmplx(cos(xi), sin(xi), dp)
        spin = cmplx(0.0_dp, x(4, 1), dp)
        there%place = turn * z(0)
        there%velocity = turn * (z(1) + spin * z(0))
        there%acceleration = turn * (z(2) + 2 * spin * z(1) + (spin**2 + cmplx(0.0_dp, x(4, 2), dp)) * z(0))
        there%is_up = x(3, 0) > 0
        if (now%side_last(lane) > 0) return
        there%place = conjg(there%place)
        there%velocity = conjg(there%velocity)
        there%acceleration = conjg(there%acceleration)
    end subroutine way

end module spintop_lane_steps
