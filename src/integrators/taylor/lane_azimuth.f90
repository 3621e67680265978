!> The angle that the states of lanes leave out, (s phi - psi)/2, followed along a step of one lane in paces short enough to
!> resolve its turns, on the side on which the axis passes a pole, or through it.
module spintop_lane_azimuth
    use spintop_kinds, only: dp
    use spintop_attitude, only: nearest_turn
    use spintop_lane_series, only: parts, rows
    use spintop_lane_steps, only: closest_to_pole, largest_turn, pole_bend, sharp, straight
    use spintop_motion, only: passages_t
    use spintop_pole_passages, only: settle_passage, way_t
    implicit none
    private
    public :: lane_step_t

    !> A step of one lane. Its procedures take the Taylor coefficients of the lane.
    type :: lane_step_t
        !> Order of the series.
        integer :: order = 0
        !> Times at its ends, s; the side; the largest angular velocity, rad/s.
        real(dp) :: t_last = 0, t = 0, side = 1, rate = 0
        !> How far off a pole is passed through, rad; the square of the distance at which a place is in a pole.
        real(dp) :: reach = 0, in_pole2 = 0
    contains
        procedure :: follow
        procedure, private :: walk
        procedure, private :: pass
        procedure, private :: way
    end type lane_step_t

    !> A pole that is passed within this fraction of a step is passed on an arbitrary side.
    real(dp), parameter :: shortest_pace = 1.0e-12_dp

contains

    !> Follows the other angle, and the passages through poles, from the beginning of the step to a time within it.
    pure subroutine follow(self, c, goal, other, passed)
        class(lane_step_t), intent(in) :: self
        real(dp), intent(in) :: c(rows, 0:self%order) !! Taylor coefficients of the lane
        real(dp), intent(in) :: goal !! time within the step, s
        real(dp), intent(inout) :: other !! the other angle, rad
        type(passages_t), intent(inout) :: passed !! the passages
        real(dp) :: t, gamma(2)
        t = self%t_last
        gamma = c(4:5, 0)
        call self%walk(c, goal, t, gamma, other, passed)
    end subroutine follow

    !> Follows the other angle from `t` and `gamma` = (Gamma1, Gamma2) on to a time within the last step, in paces
    !> short enough to resolve the turns of the body, and on which side its axis passes a pole, or that it passes through it.
    pure recursive subroutine walk(self, c, goal, t, gamma, other, passed)
        class(lane_step_t), intent(in) :: self
        real(dp), intent(in) :: c(rows, 0:self%order), goal
        real(dp), intent(inout) :: t, gamma(2), other
        type(passages_t), intent(inout) :: passed
        real(dp) :: now(4), new, pace, part, middle, bend
        logical :: is_sure
        integer :: k

        pace = goal - t
        if (.not. pace > 0) return
        associate (t_last => self%t_last, rate => self%rate)
            now = 0
            do k = self%order, 0, -1
                now = now * (goal - t_last) + c(4:parts, k)
            end do
            new = other
            if (any(abs(now(1:2)) > 0)) new = nearest_turn(now(4) / 2 - atan2(now(1), now(2)), other)
            bend = pole_bend(c(:, :3), self%t - t_last)
            is_sure = pace * rate <= largest_turn .and. abs(new - other) <= sharp &
                      .and. pace**2 * bend <= (straight - (new - other)**2) * sqrt(min(sum(gamma**2), sum(now(1:2)**2)))
            if (pace * rate <= largest_turn .and. (passed%arrived .or. .not. is_sure &
                                                   .or. sum(now(1:2)**2) <= self%in_pole2)) then
                call self%pass(c, t, goal, other, passed, new, is_sure)
            end if
            if (is_sure .or. pace <= max(shortest_pace * (self%t - t_last), 2 * spacing(goal))) then
                t = goal
                gamma = now(1:2)
                other = new
            else
                part = 0.5_dp
                if (pace * rate <= largest_turn .and. .not. passed%arrived) part = closest_to_pole(gamma, now(1:2))
                middle = t + part * pace
                ! Late in the motion a small part of the pace is less than the spacing of the time.
                if (.not. (middle > t .and. middle < goal)) middle = t + pace / 2
                call self%walk(c, middle, t, gamma, other, passed)
                call self%walk(c, goal, t, gamma, other, passed)
            end if
        end associate
    end subroutine walk

    !> Continues the other angle through a pole, if the axis passes through it or is in it.
    pure subroutine pass(self, c, t, goal, other, passed, new, is_sure)
        class(lane_step_t), intent(in) :: self
        real(dp), intent(in) :: c(rows, 0:self%order)
        real(dp), intent(in) :: t, goal, other !! times within the last step, s; the other angle at the first, rad
        type(passages_t), intent(inout) :: passed
        real(dp), intent(inout) :: new !! the other angle at the goal, rad
        logical, intent(inout) :: is_sure !! whether it is certain
        type(way_t) :: here, there
        real(dp) :: xi_here, xi_there, phi
        logical :: had_arrived, is_decided
        had_arrived = passed%arrived
        call self%way(c, t, here, xi_here)
        call self%way(c, goal, there, xi_there)
        associate (side => self%side)
            phi = side * (xi_here / 2 + other)
            call settle_passage(here, there, goal - t, self%reach, passed, phi, is_decided)
            if (is_decided) new = side * phi - xi_there / 2
        end associate
        is_sure = is_decided .or. (is_sure .and. .not. had_arrived)
    end subroutine pass

    !> The way of body z at a time within the last step, and xi there. With z = Gamma2 + i Gamma1 and s = 1 its place is
    !> exp(i xi) conj(z), with s = -1 the conjugate of that.
    pure subroutine way(self, c, t, there, xi)
        class(lane_step_t), intent(in) :: self
        real(dp), intent(in) :: c(rows, 0:self%order)
        real(dp), intent(in) :: t !! s
        type(way_t), intent(out) :: there
        real(dp), intent(out) :: xi !! rad
        real(dp) :: x(4, 0:2)
        complex(dp) :: z(0:2), turn, spin
        integer :: k
        x = 0
        do k = self%order, 0, -1
            x(:, 2) = x(:, 2) * (t - self%t_last) + x(:, 1)
            x(:, 1) = x(:, 1) * (t - self%t_last) + x(:, 0)
            x(:, 0) = x(:, 0) * (t - self%t_last) + c(4:parts, k)
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
        if (self%side > 0) return
        there%place = conjg(there%place)
        there%velocity = conjg(there%velocity)
        there%acceleration = conjg(there%acceleration)
    end subroutine way

end module spintop_lane_azimuth
