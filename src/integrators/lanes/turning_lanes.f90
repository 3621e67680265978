!> Turning points of theta along the motions in lanes: the roots of the polynomial of Gamma3' in each step.
module spintop_turning_lanes
    use spintop_kinds, only: dp, pi
    use spintop_attitude, only: nearest_turn
    use spintop_body, only: body_t
    use spintop_compare, only: is_zero
    use spintop_constancy, only: driven_rate
    use spintop_formulation, only: max_series_order
    use spintop_instants, only: greatest_fall_rate
    use spintop_lane_azimuth, only: changes_to, largest_turn, sharp
    use spintop_lane_series, only: parts
    use spintop_motion, only: motion_t, passages_t
    use spintop_pole_passages, only: half_turns
    use spintop_quantities, only: angular_acceleration, axis_height_rate
    use spintop_root_monitor, only: find_height_rates, of_interval, root_monitor_t, states_at
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    use spintop_turning_record, only: turning_points_t, turns_at, upper, lower
    implicit none
    private
    public :: turning_lanes_t

    !> Places of a turning point in the lanes: time, side, other angle, whether that is known although the state is in a pole,
    !> half turns of phi and psi at poles, state.
    integer, parameter :: at_time = 1, at_side = 2, at_other = 3, at_arrived = 4, at_half_turns = 4, at_state = 6, &
        places = at_state + parts

    !> Of one kind in all lanes; `inclination` is a measure that grows with theta (see there).
    type :: lane_turns_t
        !> Numbers of those counted, and of those whose extremes were taken; whether the count has ended (`turning_points_t`).
        real(dp) :: n(lanes) = 0, seen(lanes) = 0
        logical :: is_interrupted(lanes) = .false., has_ended(lanes) = .false.
        real(dp) :: first(lanes, places) = 0, last(lanes, places) = 0
        real(dp), dimension(lanes) :: inclination_min = 0, inclination_max = 0, rate_min = 0, rate_max = 0
    end type lane_turns_t

    !> Watches the turning points; `turns` is of each kind and case.
    type, extends(root_monitor_t) :: turning_lanes_t
        type(turning_points_t), allocatable :: turns(:, :)
        type(lane_turns_t), private :: lane(upper:lower)
        logical, private :: starts_turning(lanes) = .false.
        type(motion_t), private :: start(lanes)
    contains
        procedure :: prepare
        procedure :: begin
        procedure :: find_polynomials
        procedure :: record_roots
        procedure :: finish
    end type turning_lanes_t

contains

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(turning_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%turns)) deallocate (self%turns)
        allocate (self%turns(upper:lower, cases))
        self%sign = 0
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(turning_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: slope
        integer :: kind
        self%driven(lane) = driven_rate(greatest_fall_rate(body), start%omega)
        do kind = upper, lower
            self%lane(kind)%n(lane) = 0
            self%lane(kind)%seen(lane) = 0
            self%lane(kind)%is_interrupted(lane) = .false.
            self%lane(kind)%has_ended(lane) = .false.
        end do
        slope = axis_height_rate(start)
        self%sign(lane) = merge(0.0_dp, sign(1.0_dp, slope), is_zero(slope))
        self%starts_turning(lane) = is_zero(slope)
        if (is_zero(slope)) self%starts_turning(lane) = turns_at(start, angular_acceleration(body, start))
        self%start(lane) = start
    end subroutine begin

    !> Gamma3'.
    subroutine find_polynomials(self, run, degree, a, noise)
        class(turning_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        degree = run%order - 1
        call find_height_rates(run%order, run%c, self%driven, degree, a, noise)
        call of_interval(degree, run%power, a)
    end subroutine find_polynomials

    !> Records the turning points at shares `u` of the step: a lower one where `slope` of Gamma3' is positive, an upper one
    !> where it is negative, none where it is zero.
    subroutine record_roots(self, run, u, slope)
        class(turning_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: t(lanes), other(lanes), at(lanes, places), inclination(lanes), rate(lanes), across
        type(passages_t) :: passed(lanes)
        integer :: i

        associate (now => run%now)
            t = u * (now%t - now%t_last)
            call states_at(run, t, at(:, at_state + 1:))
            call find_other(run, t, slope, at(:, at_state + 1:), other, passed)
            at(:, at_time) = now%t_last + t
            at(:, at_side) = now%side_last
            at(:, at_other) = other
            at(:, at_arrived) = merge(1.0_dp, 0.0_dp, passed%arrived)
            do i = 1, lanes
                at(i, at_half_turns + 1:at_half_turns + 2) = half_turns(passed(i))
            end do
        end associate
        !$omp simd private(across)
        do i = 1, lanes
            associate (w1 => at(i, at_state + 1), w2 => at(i, at_state + 2), g1 => at(i, at_state + 4), &
                       g2 => at(i, at_state + 5), g3 => at(i, at_state + 6))
                across = g1**2 + g2**2
                rate(i) = (w1 * g1 + w2 * g2) / across
                across = sqrt(across) / (1 + abs(g3))
                inclination(i) = merge(across, 2 - across, g3 >= 0)
            end associate
        end do
        call keep(self%lane(lower), max(slope, 0.0_dp), self%is_noise, at, inclination, rate)
        call keep(self%lane(upper), max(-slope, 0.0_dp), self%is_noise, at, inclination, rate)
        if (any(self%is_noise)) call interrupt(self)
    end subroutine record_roots

    !> Interrupts the count in lanes with a turning point within the noise of the motion.
    pure subroutine interrupt(self)
        class(turning_lanes_t), intent(inout) :: self
        logical :: ends
        integer :: lane
        do lane = 1, lanes
            if (.not. self%is_noise(lane)) cycle
            self%starts_turning(lane) = .false.
            ends = self%lane(upper)%n(lane) > 1 .or. self%lane(lower)%n(lane) > 1
            self%lane%is_interrupted(lane) = .true.
            self%lane%has_ended(lane) = ends
            if (.not. ends) self%lane%n(lane) = 0
        end do
    end subroutine interrupt

    !> Keeps turning points where `mask` is above zero. Those of noise are not counted.
    pure subroutine keep(turns, mask, is_noise, at, inclination, rate)
        type(lane_turns_t), intent(inout) :: turns
        real(dp), intent(in) :: mask(lanes), at(lanes, places), inclination(lanes), rate(lanes)
        logical, intent(in) :: is_noise(lanes)
        real(dp) :: counts(lanes) ! above zero, as `mask`
        logical :: is_first
        integer :: i, m

        counts = mask
        if (any(is_noise .or. turns%has_ended)) counts = merge(0.0_dp, mask, is_noise .or. turns%has_ended)
        do m = 1, places
            !$omp simd
            do i = 1, lanes
                turns%first(i, m) = merge(at(i, m), turns%first(i, m), counts(i) > 0 .and. .not. turns%n(i) > 0)
                turns%last(i, m) = merge(at(i, m), turns%last(i, m), counts(i) > 0)
            end do
        end do
        !$omp simd private(is_first)
        do i = 1, lanes
            is_first = mask(i) > 0 .and. .not. turns%seen(i) > 0
            turns%inclination_min(i) = merge(inclination(i), turns%inclination_min(i), is_first &
                                             .or. (mask(i) > 0 .and. inclination(i) < turns%inclination_min(i)))
            turns%inclination_max(i) = merge(inclination(i), turns%inclination_max(i), is_first &
                                             .or. (mask(i) > 0 .and. inclination(i) > turns%inclination_max(i)))
            turns%rate_min(i) = merge(rate(i), turns%rate_min(i), is_first &
                                      .or. (mask(i) > 0 .and. rate(i) < turns%rate_min(i)))
            turns%rate_max(i) = merge(rate(i), turns%rate_max(i), is_first &
                                      .or. (mask(i) > 0 .and. rate(i) > turns%rate_max(i)))
            turns%n(i) = turns%n(i) + merge(1.0_dp, 0.0_dp, counts(i) > 0)
            turns%seen(i) = turns%seen(i) + merge(1.0_dp, 0.0_dp, mask(i) > 0)
        end do
    end subroutine keep

    !> The other angle and the passages through poles at the times t after the beginning of the step, where they are wanted:
    !> from the nearer end that it is followed from with certainty, or else by a walk.
    subroutine find_other(run, t, wanted, state, other, passed)
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

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(turning_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        integer :: kind, other_kind
        do kind = upper, lower
            self%turns(kind, case) = unpacked(self%lane(kind), lane)
        end do
        if (.not. self%starts_turning(lane)) return
        ! A start at a turning point is one of the other kind than the first.
        associate (turns => self%turns(:, case))
            if (all(turns%n == 0)) return
            kind = upper
            if (turns(upper)%n == 0) kind = lower
            if (all(turns%n > 0) .and. turns(lower)%first(1) < turns(upper)%first(1)) kind = lower
            other_kind = upper + lower - kind
        end associate
        call self%turns(other_kind, case)%add_before(self%start(lane))
    end subroutine finish

    !> The turning points of one kind in a lane.
    pure type(turning_points_t) function unpacked(turns, lane)
        type(lane_turns_t), intent(in) :: turns
        integer, intent(in) :: lane
        unpacked%n = nint(turns%n(lane))
        unpacked%is_interrupted = turns%is_interrupted(lane)
        if (.not. turns%seen(lane) > 0) return
        unpacked%first = time_and_angles(turns%first(lane, :))
        unpacked%last = time_and_angles(turns%last(lane, :))
        unpacked%theta = [inclined(turns%inclination_min(lane)), inclined(turns%inclination_max(lane))]
        unpacked%rate = [turns%rate_min(lane), turns%rate_max(lane)]
    end function unpacked

    !> Time, phi and psi without the half turns at poles.
    pure function time_and_angles(at) result(values)
        real(dp), intent(in) :: at(places)
        real(dp) :: values(3), half, other
        half = at(at_state + 7) / 2
        other = at(at_other)
        if (.not. at(at_arrived) > 0) other = nearest_turn(half - atan2(at(at_state + 4), at(at_state + 5)), other)
        values = [at(at_time), [at(at_side) * (half + other), half - other] - pi * at(at_half_turns + 1:at_half_turns + 2)]
    end function time_and_angles

    !> theta of the measure of it: tan(theta/2) up to a right angle, and then 2 - cot(theta/2).
    pure real(dp) function inclined(measure) result(theta)
        real(dp), intent(in) :: measure
        theta = merge(2 * atan(measure), pi - 2 * atan(2 - measure), measure <= 1)
    end function inclined

end module spintop_turning_lanes
