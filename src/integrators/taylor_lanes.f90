!> Taylor's method for many rigid bodies at once, one in each lane of a vector.
!>
!> What is carried: the angular velocity omega and two unit vectors of space, the upward vertical
!> Gamma and the horizontal axis X, all in body axes,
!>
!>     I omega' = (I omega) x omega + m g Gamma x r - damping omega,
!>     Gamma' = Gamma x omega,   X' = X x omega
!>
!> (Euler and Poisson). The attitude is regular everywhere, and all terms are linear or products of
!> two components: fifteen of them, fewer than with a quaternion (twenty). Coefficients of products
!> follow Cauchy's rule. Each lane has a time, a step size and an end of its own: its numbers are the
!> same whatever the other lanes hold.
module spintop_taylor_lanes
    use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_attitude, only: horizontal_from_quaternion, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_non_finite, status_step_limit, status_step_too_small
    use spintop_stepper, only: controls_t
    use spintop_taylor, only: taylor_order, safety, largest_growth, smallest_spacings, stretch
    implicit none
    private
    public :: taylor_lanes_t, lanes, parts

    !> Bodies at once: as many as the widest vectors of today's processors hold numbers.
    integer, parameter :: lanes = 8
    !> Components of a state: omega, Gamma, X.
    integer, parameter :: parts = 9

    !> Why a lane takes no step: too small a step or no more allowed; numbers that are not finite.
    real(dp), parameter :: is_stuck = 1, is_wild = 2

    !> Numbers in a cache line, and in the coefficients of all lanes.
    integer, parameter :: line = 8, coefficients = lanes * parts * (max_series_order + 1)

    !> The lanes: `set`, `load` some, then `advance` all and look at `t`, `t_end` and `status`.
    type :: taylor_lanes_t
        integer :: order = 0
        !> Time reached, before the last step, and at the end of the span, s. A lane that has come to
        !> its end rests there.
        real(dp), dimension(lanes) :: t = 0, t_last = 0, t_end = 0
        !> (omega, Gamma, X) at `t`.
        real(dp) :: state(lanes, parts) = 0
        !> `status_ok`, or why a lane goes no further.
        integer :: status(lanes) = status_ok
        integer(int64) :: steps(lanes) = 0
        type(controls_t), private :: controls
        !> (I2 - I3)/I1 and cyclic; 1/I; damping/I; moment of the weight m g r.
        real(dp), dimension(lanes, 3), private :: coupling = 0, mobility = 0, decay = 0, moment = 0
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
        procedure :: at
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
        real(dp) :: q(4)

        q = start%quaternion / norm2(start%quaternion)
        self%t(lane) = 0
        self%t_last(lane) = 0
        self%t_end(lane) = t_end
        self%h(lane) = t_end
        self%steps(lane) = 0
        self%state(lane, :) = [start%omega, vertical_from_quaternion(q), horizontal_from_quaternion(q)]
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
        real(dp) :: duration(lanes), trouble(lanes)
        integer :: lane

        call expand(self%order, self%coupling, self%mobility, self%decay, self%moment, self%state, &
                    self%room(self%first))
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
    end subroutine advance

    !> The state of a lane at a time within its last step.
    pure function at(self, lane, t) result(state)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: t
        real(dp) :: state(parts)
        integer :: k, place
        state = 0
        do k = self%order, 0, -1
            place = self%first + lane - 1 + lanes * parts * k
            state = state * (t - self%t_last(lane)) + self%room(place:place + lanes * (parts - 1):lanes)
        end do
    end function at

    !> Taylor coefficients of the motion.
    pure subroutine expand(order, coupling, mobility, decay, moment, state, c)
        integer, intent(in) :: order
        real(dp), dimension(lanes, 3), intent(in) :: coupling, mobility, decay, moment
        real(dp), intent(in) :: state(lanes, parts)
        real(dp), intent(inout) :: c(lanes, parts, 0:order)
        real(dp) :: w1, w2, w3, w12, w23, w31
        real(dp) :: g1, g2, g3, g12, g21, g23, g32, g31, g13
        real(dp) :: x1, x2, x3, x12, x21, x23, x32, x31, x13
        real(dp) :: share
        integer :: k, j, i

        c(:, :, 0) = state
        do k = 0, order - 1
            share = 1.0_dp / (k + 1)
            !$omp simd private(w1, w2, w3, w12, w23, w31, g1, g2, g3, g12, g21, g23, g32, g31, g13, &
            !$omp x1, x2, x3, x12, x21, x23, x32, x31, x13, j)
            do i = 1, lanes
                ! Sums in registers: as arrays they would go to memory and back with every term.
                w12 = 0
                w23 = 0
                w31 = 0
                g12 = 0
                g21 = 0
                g23 = 0
                g32 = 0
                g31 = 0
                g13 = 0
                x12 = 0
                x21 = 0
                x23 = 0
                x32 = 0
                x31 = 0
                x13 = 0
                do j = 0, k
                    w1 = c(i, 1, j)
                    w2 = c(i, 2, j)
                    w3 = c(i, 3, j)
                    w12 = w12 + w1 * c(i, 2, k - j)
                    w23 = w23 + w2 * c(i, 3, k - j)
                    w31 = w31 + w3 * c(i, 1, k - j)
                    g1 = c(i, 4, k - j)
                    g2 = c(i, 5, k - j)
                    g3 = c(i, 6, k - j)
                    g12 = g12 + g1 * w2
                    g21 = g21 + g2 * w1
                    g23 = g23 + g2 * w3
                    g32 = g32 + g3 * w2
                    g31 = g31 + g3 * w1
                    g13 = g13 + g1 * w3
                    x1 = c(i, 7, k - j)
                    x2 = c(i, 8, k - j)
                    x3 = c(i, 9, k - j)
                    x12 = x12 + x1 * w2
                    x21 = x21 + x2 * w1
                    x23 = x23 + x2 * w3
                    x32 = x32 + x3 * w2
                    x31 = x31 + x3 * w1
                    x13 = x13 + x1 * w3
                end do
                c(i, 1, k + 1) = share * (coupling(i, 1) * w23 - decay(i, 1) * c(i, 1, k) + mobility(i, 1) &
                    * (c(i, 5, k) * moment(i, 3) - c(i, 6, k) * moment(i, 2)))
                c(i, 2, k + 1) = share * (coupling(i, 2) * w31 - decay(i, 2) * c(i, 2, k) + mobility(i, 2) &
                    * (c(i, 6, k) * moment(i, 1) - c(i, 4, k) * moment(i, 3)))
                c(i, 3, k + 1) = share * (coupling(i, 3) * w12 - decay(i, 3) * c(i, 3, k) + mobility(i, 3) &
                    * (c(i, 4, k) * moment(i, 2) - c(i, 5, k) * moment(i, 1)))
                c(i, 4, k + 1) = share * (g23 - g32)
                c(i, 5, k + 1) = share * (g31 - g13)
                c(i, 6, k + 1) = share * (g12 - g21)
                c(i, 7, k + 1) = share * (x23 - x32)
                c(i, 8, k + 1) = share * (x31 - x13)
                c(i, 9, k + 1) = share * (x12 - x21)
            end do
        end do
    end subroutine expand

    !> How long the steps last, s: until one of the last two terms of the series reaches the
    !> tolerance, relative to the largest component of omega, and to the unit vectors. `h` holds the
    !> steps wanted: the last, then these. `trouble` is zero for lanes that are well.
    pure subroutine choose_durations(order, controls, c, t, t_end, steps, h, duration, trouble)
        integer, intent(in) :: order
        type(controls_t), intent(in) :: controls
        real(dp), intent(in) :: c(lanes, parts, 0:order), t(lanes), t_end(lanes)
        integer(int64), intent(in) :: steps(lanes)
        real(dp), intent(inout) :: h(lanes)
        real(dp), intent(out) :: duration(lanes), trouble(lanes)
        real(dp) :: absolute, relative, of_rate, of_vectors, last, before
        integer(int64) :: max_steps
        integer :: i

        max_steps = controls%max_steps
        absolute = controls%absolute_tolerance
        relative = controls%relative_tolerance
        of_vectors = 1 / (absolute + relative)
        !$omp simd private(of_rate, last, before)
        do i = 1, lanes
            ! A velocity that passes zero is as large as it was or will be a step away.
            of_rate = 1 / (absolute + relative * ((abs(c(i, 1, 0)) + abs(c(i, 2, 0)) + abs(c(i, 3, 0))) &
                + (abs(c(i, 1, 1)) + abs(c(i, 2, 1)) + abs(c(i, 3, 1))) * h(i)))
            last = of_rate * (abs(c(i, 1, order)) + abs(c(i, 2, order)) + abs(c(i, 3, order))) &
                + of_vectors * ((abs(c(i, 4, order)) + abs(c(i, 5, order)) + abs(c(i, 6, order))) &
                                + (abs(c(i, 7, order)) + abs(c(i, 8, order)) + abs(c(i, 9, order))))
            before = of_rate * (abs(c(i, 1, order - 1)) + abs(c(i, 2, order - 1)) + abs(c(i, 3, order - 1))) &
                + of_vectors * ((abs(c(i, 4, order - 1)) + abs(c(i, 5, order - 1)) + abs(c(i, 6, order - 1))) &
                                + (abs(c(i, 7, order - 1)) + abs(c(i, 8, order - 1)) + abs(c(i, 9, order - 1))))
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
        real(dp), intent(in) :: c(lanes, parts, 0:order), duration(lanes), t_end(lanes)
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

end module spintop_taylor_lanes
