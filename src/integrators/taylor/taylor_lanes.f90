!> Taylor's method for many rigid bodies at once, one in each lane of a vector.
!>
!> Each lane has a time, a step size and an end of its own: its numbers are the same whatever the
!> other lanes hold. Carried are omega, Gamma and the angle chi = phi + s psi (`spintop_lane_series`).
!> A lane whose body leaves one side for the other changes s between two steps. The other half angle,
!> (phi - s psi)/2, follows from Gamma but for its turns, which are counted on the way.
module spintop_taylor_lanes
    use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, pi
    use spintop_attitude, only: nearest_turn, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_lane_series, only: expand, lanes, parts, quotient
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_status, only: status_ok, status_non_finite, status_step_limit, status_step_too_small
    use spintop_stepper, only: controls_t
    use spintop_taylor, only: order_for, safety, largest_growth, smallest_spacings, stretch
    implicit none
    private
    public :: taylor_lanes_t, lanes

    !> s Gamma3 at which a lane changes its side: past the middle, so that a body about there does
    !> not do so with every step, and far from where chi is singular.
    real(dp), parameter :: border = -0.2_dp
    !> Turn of the body over which the other half angle changes by less than half a turn, rad.
    real(dp), parameter :: largest_turn = pi / 2
    !> Change of a half angle by more than that shows a pole, rad.
    real(dp), parameter :: sharp = 2
    !> A pole passed within this share of a step is passed on either side.
    real(dp), parameter :: shortest_pace = 1.0e-12_dp

    !> Why a lane takes no step: too small a step or no more allowed; numbers that are not finite.
    real(dp), parameter :: step_underflow = 1, non_finite = 2
    !> Why a lane is looked at after a step: it changes its side; it turned too far to be followed.
    real(dp), parameter :: changes_side = 1, turns_far = 2

    !> Numbers in a cache line, and in the coefficients of all lanes.
    integer, parameter :: line = 8, coefficients = lanes * quotient * (max_series_order + 1)

    !> The lanes: `set`, `load` some, then `advance` all and look at `t`, `t_end` and `status`.
    type :: taylor_lanes_t
        integer :: order = 0
        !> Time reached, before the last step, and at the end of the span, s. A lane that has come to
        !> its end rests there.
        real(dp), dimension(lanes) :: t = 0, t_last = 0, t_end = 0
        !> (omega, Gamma, chi) at `t`, and the side s.
        real(dp) :: state(lanes, parts) = 0, side(lanes) = 1
        !> (phi - s psi)/2 to 2e-5, continuous along the motion, rad.
        real(dp) :: other(lanes) = 0
        !> `status_ok`, or why a lane goes no further.
        integer :: status(lanes) = status_ok
        integer(int64) :: steps(lanes) = 0
        type(controls_t), private :: controls
        !> (I2 - I3)/I1 and cyclic; 1/I; damping/I; gravitational torque m g r.
        real(dp), dimension(lanes, 3), private :: coupling = 0, mobility = 0, decay = 0, moment = 0
        !> -1 where the quaternion is the negative of that of the angles.
        real(dp), private :: sense(lanes) = 1
        !> Compensation term of the state (Kahan): the state is state + rest.
        real(dp), private :: rest(lanes, parts) = 0
        !> The last step, s, and the largest angular velocity, rad/s.
        real(dp), dimension(lanes), private :: h = 0, scale = 1
        !> Room for the coefficients of the last step, which begin at a cache line: otherwise each
        !> vector would lie in two, and a step take half as long again.
        real(dp), private :: room(coefficients + line - 1) = 0
        integer, private :: first = 1
    contains
        procedure :: set
        procedure :: load
        procedure :: advance
        procedure :: motion
        procedure, private :: walk
        procedure, private :: change_side
    end type taylor_lanes_t

    !> Orders that cost least, by measurement: lower ones than of one body by itself, as there are always other
    !> lanes to be computed while a term waits for the last.
    real(dp), parameter :: order_at_one = 9, order_a_digit = 0.92_dp

contains

    !> Makes all lanes empty. A copy of the lanes is to be set again.
    subroutine set(self, controls)
        class(taylor_lanes_t), intent(inout) :: self
        type(controls_t), intent(in) :: controls
        self%controls = controls
        self%order = order_for(controls%relative_tolerance, order_at_one, order_a_digit)
        self%t = 0
        self%t_end = 0
        self%state = 0
        self%first = start_of_line(self%room)
    end subroutine set

    !> The first number of an array that begins a cache line.
    integer function start_of_line(room) result(first)
        real(dp), target, intent(in) :: room(:)
        integer(c_intptr_t) :: address
        integer, parameter :: bytes = storage_size(room) / 8
        address = transfer(c_loc(room(1)), address)
        first = 1 + int(modulo(-address / bytes, int(line, c_intptr_t)))
    end function start_of_line

    !> Puts a body and its start into a lane.
    pure subroutine load(self, lane, body, start, t_end)
        class(taylor_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end
        real(dp) :: q(4), vertical(3), side, half, turns
        type(motion_scales_t) :: scales

        scales = motion_scales(body, start)
        self%scale(lane) = scales%rate
        q = start%quaternion / norm2(start%quaternion)
        self%t(lane) = 0
        self%t_last(lane) = 0
        self%t_end(lane) = t_end
        self%h(lane) = t_end
        self%steps(lane) = 0
        vertical = vertical_from_quaternion(q)
        side = sign(1.0_dp, vertical(3))
        self%side(lane) = side
        half = merge(atan2(q(4), q(1)), atan2(q(3), q(2)), side > 0)
        turns = anint((half - (start%angle(1) + side * start%angle(3)) / 2) / pi)
        half = half - pi * turns
        self%sense(lane) = 1 - 2 * modulo(turns, 2.0_dp)
        self%state(lane, :) = [start%omega, vertical, 2 * half]
        self%other(lane) = half - side * start%angle(3)
        self%rest(lane, :) = 0
        associate (inertia => body%inertia)
            ! Exactly zero for equal moments, so that a symmetric body keeps its spin to the last digit.
            self%coupling(lane, :) = (cshift(inertia, 1) - cshift(inertia, 2)) / inertia
            self%mobility(lane, :) = 1 / inertia
            self%decay(lane, :) = body%damping / inertia
        end associate
        self%moment(lane, :) = body%weight_moment()
        self%status(lane) = status_ok
    end subroutine load

    !> One step in every lane, as long as the last terms of its series allow. A lane that can take
    !> none gets a status that says why, and an end where it is.
    subroutine advance(self)
        class(taylor_lanes_t), intent(inout) :: self
        real(dp), dimension(lanes) :: duration, trouble, rate, doubt
        real(dp) :: t, other
        integer :: lane

        call expand(self%order, self%coupling, self%mobility, self%decay, self%moment, self%side, &
                    self%state, self%room(self%first))
        call choose_durations(self%order, self%controls, self%room(self%first), self%scale, self%t, self%t_end, &
                              self%steps, self%h, duration, trouble)
        if (count(trouble > 0) > 0) then
            do lane = 1, lanes
                if (.not. (trouble(lane) > 0 .and. self%t(lane) < self%t_end(lane))) cycle
                self%status(lane) = status_non_finite
                if (trouble(lane) < non_finite) self%status(lane) = status_step_too_small
                if (self%steps(lane) >= self%controls%max_steps) self%status(lane) = status_step_limit
                self%t_end(lane) = self%t(lane)
                duration(lane) = 0
            end do
        end if
        call add_terms(self%order, self%room(self%first), duration, self%t_end, self%t_last, self%t, &
                       self%state, self%rest, self%steps)
        call follow(self%order, self%room(self%first), duration, self%side, self%state, self%other, rate, doubt)
        if (.not. any(doubt > 0)) return
        do lane = 1, lanes
            if (doubt(lane) >= turns_far) then
                t = self%t_last(lane)
                other = self%other(lane)
                call self%walk(lane, self%t(lane), rate(lane), t, other)
                self%other(lane) = other
            end if
            if (self%side(lane) * self%state(lane, 6) < border) call self%change_side(lane)
        end do
    end subroutine advance

    !> Follows the other half angle from `t` on to a time within the last step, in paces short enough
    !> to resolve the turns of the body, and on which side its axis passes a pole. `rate` is the largest
    !> angular velocity, rad/s.
    pure recursive subroutine walk(self, lane, goal, rate, t, other)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: goal, rate
        real(dp), intent(inout) :: t, other
        real(dp) :: now(4), new, pace
        integer :: k, place

        pace = goal - t
        if (.not. pace > 0) return
        now = 0
        do k = self%order, 0, -1
            place = self%first + lane - 1 + lanes * (3 + quotient * k)
            now = now * (goal - self%t_last(lane)) + self%room(place:place + 3 * lanes:lanes)
        end do
        new = other
        if (any(abs(now(1:2)) > 0)) new = nearest_turn(now(4) / 2 - self%side(lane) * atan2(now(1), now(2)), other)
        if ((pace * rate <= largest_turn .and. abs(new - other) <= sharp) &
            .or. pace <= max(shortest_pace * (self%t(lane) - self%t_last(lane)), 2 * spacing(goal))) then
            t = goal
            other = new
        else
            call self%walk(lane, t + pace / 2, rate, t, other)
            call self%walk(lane, goal, rate, t, other)
        end if
    end subroutine walk

    !> Describes the attitude in a lane by the angle of the other side.
    pure subroutine change_side(self, lane)
        class(taylor_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        associate (s => self%side(lane), chi => self%state(lane, 7), other => self%other(lane))
            associate (psi => atan2(self%state(lane, 4), self%state(lane, 5)), half => chi / 2)
                chi = 2 * nearest_turn(half - s * psi, other)
                other = half
            end associate
            s = -s
        end associate
        self%rest(lane, 7) = 0
    end subroutine change_side

    !> The motion in a lane, but for the acceleration.
    pure type(motion_t) function motion(self, lane)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane
        real(dp) :: q(4), near(3), along, half(2)

        associate (gamma => self%state(lane, 4:6), s => self%side(lane), chi => self%state(lane, 7))
            ! The two halves of the quaternion: that of chi, and the other, turned by s psi from it.
            along = sqrt((1 + s * gamma(3)) / 2)
            half = [cos(chi / 2), sin(chi / 2)]
            q([1, 4]) = along * half
            q([2, 3]) = [half(1) * gamma(2) + s * half(2) * gamma(1), &
                         half(2) * gamma(2) - s * half(1) * gamma(1)] / (2 * along)
            if (s < 0) q = q([2, 1, 4, 3])
            near = [chi / 2 + self%other(lane), 0.0_dp, s * (chi / 2 - self%other(lane))]
        end associate
        q = self%sense(lane) * q / norm2(q)
        motion = motion_from_quaternion(self%t(lane), q, self%state(lane, 1:3), near)
    end function motion

    !> How long the steps last, s: until one of the last two terms of the series reaches the
    !> tolerance, relative to the magnitude of omega, to the unit vector and to a radian; the absolute
    !> tolerance is a share of the largest angular velocity, `scale`, and in radians. `h` holds the
    !> steps wanted: the last, then these. `trouble` is zero for lanes that are well.
    pure subroutine choose_durations(order, controls, c, scale, t, t_end, steps, h, duration, trouble)
        integer, intent(in) :: order
        type(controls_t), intent(in) :: controls
        real(dp), intent(in) :: c(lanes, quotient, 0:order), scale(lanes), t(lanes), t_end(lanes)
        integer(int64), intent(in) :: steps(lanes)
        real(dp), intent(inout) :: h(lanes)
        real(dp), intent(out) :: duration(lanes), trouble(lanes)
        real(dp) :: absolute, relative, of_rate, of_attitude, last, before
        integer(int64) :: max_steps
        integer :: i

        max_steps = controls%max_steps
        absolute = controls%absolute_tolerance
        relative = controls%relative_tolerance
        of_attitude = 1 / (absolute + relative)
        !$omp simd private(of_rate, last, before)
        do i = 1, lanes
            ! A velocity that passes zero is as large as it was or will be a step away.
            of_rate = 1 / (absolute * scale(i) + relative * ((abs(c(i, 1, 0)) + abs(c(i, 2, 0)) + abs(c(i, 3, 0))) &
                + min((abs(c(i, 1, 1)) + abs(c(i, 2, 1)) + abs(c(i, 3, 1))) * h(i), scale(i))))
            last = of_rate * (abs(c(i, 1, order)) + abs(c(i, 2, order)) + abs(c(i, 3, order))) &
                + of_attitude * (abs(c(i, 4, order)) + abs(c(i, 5, order)) + abs(c(i, 6, order)) &
                                 + abs(c(i, 7, order)))
            before = of_rate * (abs(c(i, 1, order - 1)) + abs(c(i, 2, order - 1)) + abs(c(i, 3, order - 1))) &
                + of_attitude * (abs(c(i, 4, order - 1)) + abs(c(i, 5, order - 1)) + abs(c(i, 6, order - 1)) &
                                 + abs(c(i, 7, order - 1)))
            h(i) = min(largest_growth * h(i), safety * power_of_two( &
                -max(binary_logarithm(last) / order, binary_logarithm(before) / (order - 1))))
            duration(i) = merge(t_end(i) - t(i), h(i), stretch * h(i) >= t_end(i) - t(i))
            trouble(i) = merge(0.0_dp, step_underflow, h(i) > smallest_spacings * epsilon(t) * t(i) &
                               .and. steps(i) < max_steps)
            trouble(i) = merge(trouble(i), non_finite, last + before <= huge(t))
        end do
    end subroutine choose_durations

    !> Logarithm to base 2 to 4e-8, made of vector instructions: accurate enough that step sizes do not
    !> depend on the unit of time. Of zero: -1023.
    elemental real(dp) function binary_logarithm(x) result(y)
        real(dp), intent(in) :: x
        integer, parameter :: mantissa = digits(x) - 1
        integer(int64), parameter :: one = shiftl(int(maxexponent(x) - 1, int64), mantissa)
        real(dp), parameter :: root = sqrt(2.0_dp), unit = 2 / log(2.0_dp)
        real(dp) :: m, s, square
        integer(int64) :: bits
        bits = transfer(x, bits)
        m = transfer(ior(iand(bits, shiftl(1_int64, mantissa) - 1), one), m)
        s = (m - root) / (m + root)
        square = s**2
        y = (real(shiftr(bits, mantissa) - (maxexponent(x) - 1), dp) + 0.5_dp) &
            + unit * s * (1 + square * (1.0_dp / 3 + square * (1.0_dp / 5 + square / 7)))
    end function binary_logarithm

    !> Power of 2 to 2e-7, |y| < 1000, likewise.
    elemental real(dp) function power_of_two(y) result(x)
        real(dp), intent(in) :: y
        integer, parameter :: mantissa = digits(x) - 1
        integer(int64) :: whole
        real(dp), parameter :: root = sqrt(2.0_dp)
        real(dp) :: f
        whole = int(y + maxexponent(x), int64)
        f = (y + maxexponent(x) - real(whole, dp) - 0.5_dp) * log(2.0_dp)
        x = transfer(shiftl(whole - 1, mantissa), x) * (root * (1 + f * (1 + f * (1.0_dp / 2 + f * (1.0_dp / 6 &
            + f * (1.0_dp / 24 + f * (1.0_dp / 120 + f / 720)))))))
    end function power_of_two

    !> Adds to the states their change over the steps, by Horner's rule, summed with compensation
    !> (Kahan, Comm. ACM 8, 1965). Lanes whose step has no length stay as they are.
    pure subroutine add_terms(order, c, duration, t_end, t_last, t, state, rest, steps)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, quotient, 0:order), duration(lanes), t_end(lanes)
        real(dp), dimension(lanes), intent(inout) :: t_last, t
        real(dp), dimension(lanes, parts), intent(inout) :: state, rest
        integer(int64), intent(inout) :: steps(lanes)
        real(dp) :: exact(lanes), change(lanes, parts), total, new
        integer :: k, m, i

        !$omp simd
        do i = 1, lanes
            t_last(i) = t(i)
            t(i) = merge(t_end(i), t(i) + duration(i), duration(i) >= t_end(i) - t(i))
            exact(i) = t(i) - t_last(i)
            steps(i) = steps(i) + merge(1_int64, 0_int64, duration(i) > 0)
        end do
        change = 0
        do k = order, 1, -1
            do m = 1, parts
                !$omp simd
                do i = 1, lanes
                    change(i, m) = change(i, m) * exact(i) + c(i, m, k)
                end do
            end do
        end do
        do m = 1, parts
            !$omp simd private(total, new)
            do i = 1, lanes
                total = change(i, m) * exact(i) + rest(i, m)
                new = state(i, m) + total
                rest(i, m) = merge(total - (new - state(i, m)), rest(i, m), duration(i) > 0)
                state(i, m) = merge(new, state(i, m), duration(i) > 0)
            end do
        end do
    end subroutine add_terms

    !> Follows the other half angle over the steps, where that is certain; `doubt` says where not,
    !> and where the side is to be changed. `rate` is the angular velocity, the larger of both ends.
    pure subroutine follow(order, c, duration, side, state, other, rate, doubt)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, quotient, 0:order), duration(lanes), side(lanes), state(lanes, parts)
        real(dp), intent(inout) :: other(lanes)
        real(dp), intent(out) :: rate(lanes), doubt(lanes)
        real(dp) :: change
        integer :: i

        !$omp simd private(change)
        do i = 1, lanes
            change = state(i, 7) / 2 - side(i) * rough_angle(state(i, 4), state(i, 5)) - other(i)
            change = change - 2 * pi * anint(change / (2 * pi))
            ! At a pole there is no such angle, and it stays as it was.
            change = merge(change, 0.0_dp, abs(state(i, 4)) + abs(state(i, 5)) > 0)
            rate(i) = sqrt(max(c(i, 1, 0)**2 + c(i, 2, 0)**2 + c(i, 3, 0)**2, &
                               state(i, 1)**2 + state(i, 2)**2 + state(i, 3)**2))
            doubt(i) = merge(0.0_dp, changes_side, side(i) * state(i, 6) >= border)
            doubt(i) = merge(doubt(i), turns_far, duration(i) * rate(i) <= largest_turn &
                             .and. abs(change) <= sharp)
            other(i) = other(i) + merge(0.0_dp, change, doubt(i) >= turns_far)
        end do
    end subroutine follow

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

end module spintop_taylor_lanes
