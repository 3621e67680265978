!> The steps of many bodies in lanes, from the Taylor coefficients of their motions: how long they are, and where they end.
!> Each lane for itself, without branches.
module spintop_lane_steps
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_lane_series, only: lanes, parts, rows
    use spintop_motions, only: instants
    use spintop_stepper, only: controls_t, smallest_spacings
    use spintop_taylor, only: largest_growth, safety, stretch
    implicit none
    private
    public :: choose_durations, end_before_reversals, add_terms, states_at, step_underflow, non_finite

    !> Reasons for which a lane takes no step: its size underflows or no more steps are allowed; a number is
    !> not finite.
    integer(int64), parameter :: step_underflow = 1, non_finite = 2
    !> No reason. As wide as the numbers beside which they are found, so that both are in one vector.
    integer(int64), parameter :: no_reason = 0

    !> A step is halved so often before a drag reverses, at the most; and once more.
    integer, parameter :: most_halvings = 30

contains

    !> Durations of the steps, s: until one of the last two terms of the series reaches the tolerance, relative
    !> to the magnitude of omega, to the unit vector and to a radian. The absolute tolerance is a fraction of the
    !> largest angular velocity, `scale`, and in radians. `trouble` is zero for lanes that can step.
    pure subroutine choose_durations(order, controls, c, scale, t, t_end, steps, h, duration, trouble, worst)
        integer, intent(in) :: order !! order of the series
        type(controls_t), intent(in) :: controls !! tolerances and maximum number of steps
        real(dp), intent(in) :: c(lanes, rows, 0:order), scale(lanes), t(lanes), t_end(lanes)
            !! Taylor coefficients; largest angular velocity, rad/s; time and end of the span, s
        integer(int64), intent(in) :: steps(lanes) !! number of steps so far
        real(dp), intent(inout) :: h(lanes) !! step sizes of the last step, replaced by those of this one, s
        real(dp), intent(out) :: duration(lanes) !! durations of the steps, s
        integer(int64), intent(out) :: trouble(lanes), worst
            !! `step_underflow`, `non_finite` or 0, and the largest of these
        real(dp) :: absolute, relative, of_attitude, of_last, of_before
        real(dp), dimension(lanes) :: of_rate, last, before
        integer(int64) :: max_steps
        integer :: i

        max_steps = controls%max_steps
        absolute = controls%absolute_tolerance
        relative = controls%relative_tolerance
        of_attitude = 1 / (absolute + relative)
        of_last = -1.0_dp / order
        of_before = -1.0_dp / (order - 1)
        ! In one loop the compiler makes no vectors of this.
        !$omp simd
        do i = 1, lanes
            ! A velocity that passes zero is as large as it was or will be a step away.
            of_rate(i) = 1 / (absolute * scale(i) + relative * ((abs(c(i, 1, 0)) + abs(c(i, 2, 0)) + abs(c(i, 3, 0))) &
                + min((abs(c(i, 1, 1)) + abs(c(i, 2, 1)) + abs(c(i, 3, 1))) * h(i), scale(i))))
        end do
        !$omp simd
        do i = 1, lanes
            last(i) = of_rate(i) * (abs(c(i, 1, order)) + abs(c(i, 2, order)) + abs(c(i, 3, order))) &
                + of_attitude * (abs(c(i, 4, order)) + abs(c(i, 5, order)) + abs(c(i, 6, order)) &
                                 + abs(c(i, 7, order)))
            before(i) = of_rate(i) * (abs(c(i, 1, order - 1)) + abs(c(i, 2, order - 1)) + abs(c(i, 3, order - 1))) &
                + of_attitude * (abs(c(i, 4, order - 1)) + abs(c(i, 5, order - 1)) + abs(c(i, 6, order - 1)) &
                                 + abs(c(i, 7, order - 1)))
        end do
        !$omp simd
        do i = 1, lanes
            h(i) = min(largest_growth * h(i), safety * power_of_two( &
                min(of_last * binary_logarithm(last(i)), of_before * binary_logarithm(before(i)))))
        end do
        !$omp simd
        do i = 1, lanes
            duration(i) = merge(t_end(i) - t(i), h(i), stretch * h(i) >= t_end(i) - t(i))
        end do
        !$omp simd
        do i = 1, lanes
            trouble(i) = merge(no_reason, step_underflow, h(i) > smallest_spacings * epsilon(t) * t(i))
            trouble(i) = merge(trouble(i), step_underflow, steps(i) < max_steps)
            trouble(i) = merge(trouble(i), non_finite, last(i) + before(i) <= huge(t))
        end do
        worst = maxval(trouble)
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
            + unit * s * (1 + square * (1.0_dp / 3 + square * (1.0_dp / 5 + square * (1.0_dp / 7))))
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
            + f * (1.0_dp / 24 + f * (1.0_dp / 120 + f * (1.0_dp / 720))))))))
    end function power_of_two

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

        call find_rates(order, c, duration / 2, middle)
        call find_rates(order, c, duration, last)
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
            call find_rates(order, c, duration * k / instants, w)
            v = cross_of(w, r)
            turns = turns .or. product_of(v, before) < least
            before = v
        end do
    end subroutine find_turns

    !> The angular velocities after some time: as by `states_at`, without the rest.
    pure subroutine find_rates(order, c, t, w)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order), t(lanes)
        real(dp), intent(out) :: w(lanes, 3)
        real(dp) :: w1, w2, w3
        integer :: i, k
        !$omp simd private(w1, w2, w3, k)
        do i = 1, lanes
            w1 = c(i, 1, order)
            w2 = c(i, 2, order)
            w3 = c(i, 3, order)
            do k = 1, max(order, 1)
                w1 = w1 * t(i) + c(i, 1, order - k)
                w2 = w2 * t(i) + c(i, 2, order - k)
                w3 = w3 * t(i) + c(i, 3, order - k)
            end do
            w(i, 1) = w1
            w(i, 2) = w2
            w(i, 3) = w3
        end do
    end subroutine find_rates

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

    !> Adds to the states their change over the steps, by Horner's rule, summed with compensation
    !> (Kahan, Comm. ACM 8, 1965). Lanes whose step has no length stay as they are.
    pure subroutine add_terms(order, c, duration, t_end, t_last, t, state, rest, steps)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order), duration(lanes), t_end(lanes)
            !! Taylor coefficients; durations of the steps and ends of the spans, s
        real(dp), dimension(lanes), intent(inout) :: t_last, t !! time before the step, and time reached, s
        real(dp), dimension(lanes, parts), intent(inout) :: state, rest !! states and their compensation terms
        integer(int64), intent(inout) :: steps(lanes) !! number of steps so far
        real(dp) :: exact(lanes), change(lanes, parts), total, new
        integer :: m, i

        !$omp simd
        do i = 1, lanes
            t_last(i) = t(i)
            t(i) = merge(t_end(i), t(i) + duration(i), duration(i) >= t_end(i) - t(i))
            exact(i) = t(i) - t_last(i)
            steps(i) = steps(i) + merge(1_int64, 0_int64, duration(i) > 0)
        end do
        call terms_at(order, c, exact, change)
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

    !> The states at the times t after the beginning of the step.
    pure subroutine states_at(order, c, t, states)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order), t(lanes) !! Taylor coefficients; times, s
        real(dp), intent(out) :: states(lanes, parts) !! states then
        integer :: i, m
        call terms_at(order, c, t, states)
        do m = 1, parts
            !$omp simd
            do i = 1, lanes
                states(i, m) = c(i, m, 0) + t(i) * states(i, m)
            end do
        end do
    end subroutine states_at

    !> The change of the states after the times t, divided by these.
    pure subroutine terms_at(order, c, t, change)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order), t(lanes)
        real(dp), intent(out) :: change(lanes, parts)
        real(dp) :: x1, x2, x3, x4, x5, x6, x7
        integer :: i, k

        ! Scalar sums stay in registers; arrays would be stored and loaded with every term.
        !$omp simd private(x1, x2, x3, x4, x5, x6, x7, k)
        do i = 1, lanes
            x1 = c(i, 1, order)
            x2 = c(i, 2, order)
            x3 = c(i, 3, order)
            x4 = c(i, 4, order)
            x5 = c(i, 5, order)
            x6 = c(i, 6, order)
            x7 = c(i, 7, order)
            ! No loop becomes vectors that counts down, or may have no trip.
            do k = 1, max(order - 1, 1)
                x1 = x1 * t(i) + c(i, 1, order - k)
                x2 = x2 * t(i) + c(i, 2, order - k)
                x3 = x3 * t(i) + c(i, 3, order - k)
                x4 = x4 * t(i) + c(i, 4, order - k)
                x5 = x5 * t(i) + c(i, 5, order - k)
                x6 = x6 * t(i) + c(i, 6, order - k)
                x7 = x7 * t(i) + c(i, 7, order - k)
            end do
            change(i, 1) = x1
            change(i, 2) = x2
            change(i, 3) = x3
            change(i, 4) = x4
            change(i, 5) = x5
            change(i, 6) = x6
            change(i, 7) = x7
        end do
    end subroutine terms_at

end module spintop_lane_steps
