!> Taylor's method for many rigid bodies at once, one in each lane of a vector.
!>
!> What is carried: the angular velocity omega and the upward vertical Gamma in body axes, and an
!> angle chi that tells the rest of the attitude,
!>
!>     I omega' = (I omega) x omega + m g Gamma x r - damping omega,   Gamma' = Gamma x omega,
!>     chi = phi + s psi,   chi' = s omega3 + (omega1 Gamma1 + omega2 Gamma2)/(1 + s Gamma3)
!>
!> (Euler and Poisson; phi and psi are Euler's angles). With the side s = +1 the angle chi is regular
!> but where the body hangs upside down, with s = -1 but where it stands upright: a lane whose body
!> leaves one side for the other changes s between two steps. All terms are linear, or products of
!> two components and a quotient: twelve products, where a second vector in place of chi takes
!> fifteen and a quaternion twenty. The other half angle, (phi - s psi)/2, follows from Gamma but for
!> its turns, which are counted on the way. Each lane has a time, a step size and an end of its own:
!> its numbers are the same whatever the other lanes hold.
module spintop_taylor_lanes
    use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, qp, pi
    use spintop_attitude, only: nearest_turn, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_status, only: status_ok, status_non_finite, status_step_limit, status_step_too_small
    use spintop_stepper, only: controls_t
    use spintop_taylor, only: taylor_order, safety, largest_growth, smallest_spacings, stretch
    implicit none
    private
    public :: taylor_lanes_t, lanes, parts

    !> Bodies at once: as many as the widest vectors of today's processors hold numbers.
    integer, parameter :: lanes = 8
    !> Components of a state: omega, Gamma, chi; behind them stands the quotient in chi'.
    integer, parameter :: parts = 7, quotient = 8

    !> s Gamma3 at which a lane changes its side: past the middle, so that a body about there does
    !> not do so with every step, and far from where chi is singular.
    real(dp), parameter :: border = -0.2_dp
    !> Turn of the body over which the other half angle changes by less than half a turn, rad.
    real(dp), parameter :: largest_turn = pi / 2
    !> Change of a half angle by more than that shows a pole, rad.
    real(dp), parameter :: sharp = 2
    !> A pole passed within this share of a step is passed on either side.
    real(dp), parameter :: shortest_pace = 1.0e-12_dp

    integer, private :: divisor
    !> 1/k, and what it lacks: a share rounded alike in every step would make energy and momentum
    !> drift.
    real(dp), parameter :: share(*) = [(1.0_dp / divisor, divisor=1, max_series_order)]
    real(dp), parameter :: share_rest(*) = [(real(1 / real(divisor, qp) - 1.0_dp / divisor, dp), &
                                             divisor=1, max_series_order)]

    !> Why a lane takes no step: too small a step or no more allowed; numbers that are not finite.
    real(dp), parameter :: is_stuck = 1, is_wild = 2
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
        !> (phi - s psi)/2 but for a few millionths, continuous along the motion, rad.
        real(dp) :: other(lanes) = 0
        !> `status_ok`, or why a lane goes no further.
        integer :: status(lanes) = status_ok
        integer(int64) :: steps(lanes) = 0
        type(controls_t), private :: controls
        !> (I2 - I3)/I1 and cyclic; 1/I; damping/I; moment of the weight m g r.
        real(dp), dimension(lanes, 3), private :: coupling = 0, mobility = 0, decay = 0, moment = 0
        !> -1 where the quaternion is the negative of that of the angles.
        real(dp), private :: sense(lanes) = 1
        !> What rounding has cut from the state so far: the state is state + rest.
        real(dp), private :: rest(lanes, parts) = 0
        !> The last step, s.
        real(dp), private :: h(lanes) = 0
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

contains

    !> Makes all lanes empty. A copy of the lanes is to be set again.
    subroutine set(self, controls)
        class(taylor_lanes_t), intent(inout) :: self
        type(controls_t), intent(in) :: controls
        self%controls = controls
        self%order = taylor_order(controls%relative_tolerance)
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
        real(dp) :: t
        integer :: lane

        call expand(self%order, self%coupling, self%mobility, self%decay, self%moment, self%side, &
                    self%state, self%room(self%first))
        call choose_durations(self%order, self%controls, self%room(self%first), self%t, self%t_end, &
                              self%steps, self%h, duration, trouble)
        if (count(trouble > 0) > 0) then
            do lane = 1, lanes
                if (.not. (trouble(lane) > 0 .and. self%t(lane) < self%t_end(lane))) cycle
                self%status(lane) = status_non_finite
                if (trouble(lane) < is_wild) self%status(lane) = status_step_too_small
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
                call self%walk(lane, self%t(lane), rate(lane), t, self%other(lane))
            end if
            if (self%side(lane) * self%state(lane, 6) < border) call self%change_side(lane)
        end do
    end subroutine advance

    !> Follows the other half angle from `t` on to a time within the last step, in paces short enough
    !> to tell the turns of the body, and on which side its axis passes a pole. `rate` is the largest
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

    !> Taylor coefficients of the motion. Those of products follow Cauchy's rule, with the terms j and
    !> k - j side by side, so that each coefficient read serves twice. The quotient of the rate of
    !> turn, q = n/(1 + s Gamma3), has those of q = (n - s q Gamma3') / (1 + s Gamma3(0)), where
    !> Gamma3' is Gamma3 without its first.
    pure subroutine expand(order, coupling, mobility, decay, moment, side, state, c)
        integer, intent(in) :: order
        real(dp), dimension(lanes, 3), intent(in) :: coupling, mobility, decay, moment
        real(dp), intent(in) :: side(lanes), state(lanes, parts)
        real(dp), intent(inout) :: c(lanes, quotient, 0:order)
        real(dp) :: v1, v2, v3, e1, e2, e3, p, w1, w2, w3, g1, g2, g3, q
        real(dp) :: w12, w23, w31, g12, g21, g23, g32, g31, g13, n1, n2, qg
        real(dp) :: d1, d2, d3, twice, inverse(lanes)
        integer :: k, j, i

        c(:, :parts, 0) = state
        c(:, quotient, 0) = 0
        inverse = 1 / (1 + side * state(:, 6))
        do k = 0, order - 1
            ! A term in the middle stands beside itself: once too often.
            twice = mod(k, 2) - 1
            !$omp simd private(v1, v2, v3, e1, e2, e3, p, w1, w2, w3, g1, g2, g3, q, &
            !$omp w12, w23, w31, g12, g21, g23, g32, g31, g13, n1, n2, qg, d1, d2, d3, j)
            do i = 1, lanes
                ! Sums in registers: as arrays they would go to memory and back with every term.
                w1 = c(i, 1, k / 2)
                w2 = c(i, 2, k / 2)
                w3 = c(i, 3, k / 2)
                v1 = twice * w1
                v2 = twice * w2
                v3 = twice * w3
                g1 = c(i, 4, k / 2)
                g2 = c(i, 5, k / 2)
                g3 = c(i, 6, k / 2)
                w12 = v1 * w2
                w23 = v2 * w3
                w31 = v3 * w1
                g12 = g1 * v2
                g21 = g2 * v1
                g23 = g2 * v3
                g32 = g3 * v2
                g31 = g3 * v1
                g13 = g1 * v3
                n1 = g1 * v1
                n2 = g2 * v2
                qg = twice * g3 * c(i, quotient, k / 2)
                do j = 0, k / 2
                    v1 = c(i, 1, j)
                    v2 = c(i, 2, j)
                    v3 = c(i, 3, j)
                    e1 = c(i, 4, j)
                    e2 = c(i, 5, j)
                    e3 = c(i, 6, j)
                    p = c(i, quotient, j)
                    w1 = c(i, 1, k - j)
                    w2 = c(i, 2, k - j)
                    w3 = c(i, 3, k - j)
                    g1 = c(i, 4, k - j)
                    g2 = c(i, 5, k - j)
                    g3 = c(i, 6, k - j)
                    q = c(i, quotient, k - j)
                    w12 = w12 + v1 * w2 + w1 * v2
                    w23 = w23 + v2 * w3 + w2 * v3
                    w31 = w31 + v3 * w1 + w3 * v1
                    g12 = g12 + e1 * w2 + g1 * v2
                    g21 = g21 + e2 * w1 + g2 * v1
                    g23 = g23 + e2 * w3 + g2 * v3
                    g32 = g32 + e3 * w2 + g3 * v2
                    g31 = g31 + e3 * w1 + g3 * v1
                    g13 = g13 + e1 * w3 + g1 * v3
                    n1 = n1 + e1 * w1 + g1 * v1
                    n2 = n2 + e2 * w2 + g2 * v2
                    qg = qg + p * g3 + q * e3
                end do
                d1 = coupling(i, 1) * w23 - decay(i, 1) * c(i, 1, k) + mobility(i, 1) &
                    * (c(i, 5, k) * moment(i, 3) - c(i, 6, k) * moment(i, 2))
                d2 = coupling(i, 2) * w31 - decay(i, 2) * c(i, 2, k) + mobility(i, 2) &
                    * (c(i, 6, k) * moment(i, 1) - c(i, 4, k) * moment(i, 3))
                d3 = coupling(i, 3) * w12 - decay(i, 3) * c(i, 3, k) + mobility(i, 3) &
                    * (c(i, 4, k) * moment(i, 2) - c(i, 5, k) * moment(i, 1))
                c(i, 1, k + 1) = share(k + 1) * d1 + share_rest(k + 1) * d1
                c(i, 2, k + 1) = share(k + 1) * d2 + share_rest(k + 1) * d2
                c(i, 3, k + 1) = share(k + 1) * d3 + share_rest(k + 1) * d3
                d1 = g23 - g32
                d2 = g31 - g13
                d3 = g12 - g21
                c(i, 4, k + 1) = share(k + 1) * d1 + share_rest(k + 1) * d1
                c(i, 5, k + 1) = share(k + 1) * d2 + share_rest(k + 1) * d2
                c(i, 6, k + 1) = share(k + 1) * d3 + share_rest(k + 1) * d3
                ! A coefficient of the quotient that is not known yet counts as zero in the sums.
                q = (n1 + n2 - side(i) * qg) * inverse(i)
                d1 = side(i) * c(i, 3, k) + q
                c(i, 7, k + 1) = share(k + 1) * d1 + share_rest(k + 1) * d1
                c(i, quotient, k) = q
                c(i, quotient, k + 1) = 0
            end do
        end do
    end subroutine expand

    !> How long the steps last, s: until one of the last two terms of the series reaches the
    !> tolerance, relative to the size of omega, to the unit vector and to a radian. `h` holds the
    !> steps wanted: the last, then these. `trouble` is zero for lanes that are well.
    pure subroutine choose_durations(order, controls, c, t, t_end, steps, h, duration, trouble)
        integer, intent(in) :: order
        type(controls_t), intent(in) :: controls
        real(dp), intent(in) :: c(lanes, quotient, 0:order), t(lanes), t_end(lanes)
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
            of_rate = 1 / (absolute + relative * ((abs(c(i, 1, 0)) + abs(c(i, 2, 0)) + abs(c(i, 3, 0))) &
                + (abs(c(i, 1, 1)) + abs(c(i, 2, 1)) + abs(c(i, 3, 1))) * h(i)))
            last = of_rate * (abs(c(i, 1, order)) + abs(c(i, 2, order)) + abs(c(i, 3, order))) &
                + of_attitude * (abs(c(i, 4, order)) + abs(c(i, 5, order)) + abs(c(i, 6, order)) &
                                 + abs(c(i, 7, order)))
            before = of_rate * (abs(c(i, 1, order - 1)) + abs(c(i, 2, order - 1)) + abs(c(i, 3, order - 1))) &
                + of_attitude * (abs(c(i, 4, order - 1)) + abs(c(i, 5, order - 1)) + abs(c(i, 6, order - 1)) &
                                 + abs(c(i, 7, order - 1)))
            h(i) = min(largest_growth * h(i), safety * power_of_two( &
                -max(binary_logarithm(last) / order, binary_logarithm(before) / (order - 1))))
            duration(i) = merge(t_end(i) - t(i), h(i), stretch * h(i) >= t_end(i) - t(i))
            trouble(i) = merge(0.0_dp, is_stuck, h(i) > smallest_spacings * epsilon(t) * t(i) &
                               .and. steps(i) < max_steps)
            trouble(i) = merge(trouble(i), is_wild, last + before <= huge(t))
        end do
    end subroutine choose_durations

    !> Logarithm to base 2 by a parabola between powers of 2, to 0.01: enough for a step size, and
    !> made of vector instructions. Of zero: -1023.
    elemental real(dp) function binary_logarithm(x) result(y)
        real(dp), intent(in) :: x
        integer, parameter :: mantissa = digits(x) - 1
        integer(int64), parameter :: one = shiftl(int(maxexponent(x) - 1, int64), mantissa)
        real(dp) :: m
        integer(int64) :: bits
        bits = transfer(x, bits)
        m = transfer(ior(iand(bits, shiftl(1_int64, mantissa) - 1), one), m)
        y = real(shiftr(bits, mantissa) - (maxexponent(x) - 1), dp) + (m * (6 - m) - 5) / 3
    end function binary_logarithm

    !> Power of 2 by a parabola between whole numbers, to 0.2 %, |y| < 1000.
    elemental real(dp) function power_of_two(y) result(x)
        real(dp), intent(in) :: y
        integer, parameter :: mantissa = digits(x) - 1
        integer(int64) :: whole
        real(dp) :: f
        whole = int(y + maxexponent(x), int64)
        f = y + maxexponent(x) - real(whole, dp)
        x = transfer(shiftl(whole - 1, mantissa), x) * (1 + f * (2 + f) / 3)
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

    !> Follows the other half angle over the steps, where that is certain; `doubt` tells where not,
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
