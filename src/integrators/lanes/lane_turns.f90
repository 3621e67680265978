!> Turning points of theta along the motions in lanes: how many, when the first and the last were, and how far the motion went.
module spintop_lane_turns
    use spintop_attitude, only: nearest_turn
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, pi
    use spintop_lane_azimuth, only: changes_to, largest_turn, sharp
    use spintop_lane_series, only: parts
    use spintop_lane_steps, only: states_at
    use spintop_motion, only: motion_t, passages_t
    use spintop_pole_passages, only: half_turns
    use spintop_quantities, only: angular_acceleration
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    use spintop_turning_record, only: interrupt, lower, turning_points_t, turns_at, upper
    implicit none
    private
    public :: lane_turns_t

    !> The turning points of each kind. In place of theta they have a measure that grows with it: tan(theta/2) up to a right angle,
    !> and then 2 - cot(theta/2).
    type :: lane_turns_t
        type(turning_points_t), private :: turns(upper:lower, lanes)
        !> Whether the start is one, and what it was.
        logical, private :: starts_turning(lanes) = .false.
        type(motion_t), private :: start(lanes)
    contains
        procedure :: begin
        procedure :: record
        procedure :: turning_points
    end type lane_turns_t

contains

    !> A case begins in a lane.
    pure subroutine begin(self, lane, body, start)
        class(lane_turns_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        self%turns(:, lane) = turning_points_t()
        self%starts_turning(lane) = turns_at(start, angular_acceleration(body, start))
        self%start(lane) = start
    end subroutine begin

    !> Records turning points at shares `u` of the step: a lower one where `slope` of Gamma3' is positive, an upper one where it
    !> is negative, none where it is zero. One of noise interrupts the count.
    pure subroutine record(self, run, u, slope, is_noise)
        class(lane_turns_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes) !! roots as fractions of the step; signs of the slope
        logical, intent(in) :: is_noise(lanes) !! whether a root is one of noise
        real(dp) :: t(lanes), other(lanes), x(lanes, parts), across, measure
        type(passages_t) :: passed(lanes)
        integer :: i

        t = u * (run%now%t - run%now%t_last)
        call states_at(run%order, run%c, t, x)
        call find_other(run, t, slope, x, other, passed)
        do i = 1, lanes
            if (.not. abs(slope(i)) > 0) cycle
            associate (turns => self%turns(merge(lower, upper, slope(i) > 0), i))
                across = x(i, 4)**2 + x(i, 5)**2
                measure = sqrt(across) / (1 + abs(x(i, 6)))
                call widen(turns%theta, merge(measure, 2 - measure, x(i, 6) >= 0))
                call widen(turns%rate, (x(i, 1) * x(i, 4) + x(i, 2) * x(i, 5)) / across)
                if (is_noise(i)) then
                    self%starts_turning(i) = .false.
                    call interrupt(self%turns(:, i))
                else if (.not. turns%has_ended) then
                    turns%last = time_and_angles(run%now%t_last(i) + t(i), run%now%side_last(i), x(i, :), other(i), passed(i))
                    if (turns%n == 0) turns%first = turns%last
                    turns%n = turns%n + 1
                end if
            end associate
        end do
    end subroutine record

    !> Widens a range to a value; what is not finite and comes first stays.
    pure subroutine widen(range, value)
        real(dp), intent(inout) :: range(2)
        real(dp), intent(in) :: value
        logical :: is_first
        is_first = range(1) > range(2)
        if (is_first .or. value < range(1)) range(1) = value
        if (is_first .or. value > range(2)) range(2) = value
    end subroutine widen

    !> Time, phi and psi without the half turns at poles. Where a state is in a pole, only the other angle is known.
    pure function time_and_angles(t, side, state, other, passed) result(values)
        real(dp), intent(in) :: t, side, state(parts), other
        type(passages_t), intent(in) :: passed
        real(dp) :: values(3), half, known
        half = state(7) / 2
        known = other
        if (.not. passed%arrived) known = nearest_turn(half - atan2(state(4), state(5)), other)
        values = [t, [side * (half + known), half - known] - pi * half_turns(passed)]
    end function time_and_angles

    !> The other angle and the passages through poles at the times t after the beginning of the step, where they are wanted:
    !> from the nearer end that it is followed from with certainty, or else by a walk.
    pure subroutine find_other(run, t, wanted, state, other, passed)
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: t(lanes), wanted(lanes), state(lanes, parts)
        real(dp), intent(out) :: other(lanes)
        type(passages_t), intent(out) :: passed(lanes)
        real(dp), dimension(lanes) :: from_last, from_then, doubt
        integer :: i

        associate (now => run%now)
            call changes_to(state, now%other_last, from_last)
            call changes_to(state, now%other_then, from_then)
            !$omp simd
            do i = 1, lanes
                other(i) = now%other_then(i) + from_then(i)
                doubt(i) = merge(0.0_dp, 1.0_dp, .not. abs(wanted(i)) > 0 .or. (abs(from_then(i)) <= sharp &
                                 .and. (now%t(i) - now%t_last(i) - t(i))**2 * now%rate(i) <= largest_turn**2))
                other(i) = merge(other(i), now%other_last(i) + from_last(i), doubt(i) < 1)
                doubt(i) = merge(0.0_dp, doubt(i), abs(from_last(i)) <= sharp &
                                 .and. t(i)**2 * now%rate(i) <= largest_turn**2)
            end do
            passed = run%passed
            do i = 1, lanes
                if (.not. abs(wanted(i)) > 0) cycle
                if (doubt(i) > 0 .or. run%is_in_pole(i, state(i, 4:5))) then
                    call run%find_other_angle(i, now%t_last(i) + t(i), other(i), passed(i))
                end if
            end do
        end associate
    end subroutine find_other

    !> The turning points of the case in a lane, which is at its end.
    pure function turning_points(self, lane) result(turns)
        class(lane_turns_t), intent(in) :: self
        integer, intent(in) :: lane !! index of the lane
        type(turning_points_t) :: turns(upper:lower)
        integer :: kind
        turns = self%turns(:, lane)
        do kind = upper, lower
            if (.not. turns(kind)%theta(1) > turns(kind)%theta(2)) turns(kind)%theta = inclined(turns(kind)%theta)
        end do
        ! A start at a turning point is one of the other kind than the first.
        if (.not. self%starts_turning(lane) .or. all(turns%n == 0)) return
        kind = merge(lower, upper, turns(upper)%n == 0)
        if (all(turns%n > 0) .and. turns(lower)%first(1) < turns(upper)%first(1)) kind = lower
        call turns(upper + lower - kind)%add_before(self%start(lane))
    end function turning_points

    !> theta of the measure of it.
    elemental real(dp) function inclined(measure) result(theta)
        real(dp), intent(in) :: measure
        theta = merge(2 * atan(measure), pi - 2 * atan(2 - measure), measure <= 1)
    end function inclined

end module spintop_lane_turns
