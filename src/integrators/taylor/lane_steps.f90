!> The steps of many bodies in lanes, from the Taylor coefficients of their motions: how long they are, where
!> they end, and how the angle is followed that the states leave out. Each lane for itself, without
!> branches.
module spintop_lane_steps
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, pi
    use spintop_lane_series, only: lanes, parts, rows
    use spintop_stepper, only: controls_t
    use spintop_taylor, only: safety, largest_growth, smallest_spacings, stretch
    implicit none
    private
    public :: choose_durations, add_terms, follow, terms_at, closest_to_pole, changes_to, pole_bend
    public :: step_underflow, non_finite, changes_side, turns_far, border

    !> s Gamma3 at which a lane changes its side: beyond the middle, so that a body near it does not change in
    !> every step, and far from the singularity of xi.
    real(dp), parameter :: border = -0.2_dp
    !> Rotation of the body over which the other angle changes by less than half a turn, rad.
    real(dp), parameter, public :: largest_turn = pi / 2
    !> A larger change of the other angle indicates a pole, rad.
    real(dp), parameter, public :: sharp = 2
    !> A chord between two points z whose arguments differ by x, up to `sharp`, stays away from zero by cos(x/2) times the
    !> smaller of both magnitudes, and the path over a time h leaves it by |z''| h^2/8 at most. So it passes zero on the
    !> side of its chord while |z''| h^2 is at most this less x^2, times that magnitude.
    real(dp), parameter, public :: straight = 8

    !> Reasons for which a lane takes no step: its size underflows or no more steps are allowed; a number is
    !> not finite.
    integer(int64), parameter :: step_underflow = 1, non_finite = 2
    !> Reasons to examine a lane after a step: it changes its side; it rotated too far to be followed.
    integer(int64), parameter :: changes_side = 1, turns_far = 2
    !> No reason. As wide as the numbers beside which they are found, so that both are in one vector.
    integer(int64), parameter :: no_reason = 0

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

    !> The change of the states after the times t, divided by these.
    pure subroutine terms_at(order, c, t, change)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order), t(lanes)
            !! Taylor coefficients; times since the beginning of the step, s
        real(dp), intent(out) :: change(lanes, parts) !! changes of the states over the times
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

    !> Follows the other angle over the steps, where that is certain; `doubt` says where not,
    !> and where the side is to be changed, `most` its largest value. Where a whole step is too long, it
    !> is looked at in two parts. `rate` is the square of the angular velocity, the larger of both ends, or
    !> of what stands for it where the axis circles about a pole, rad^2/s^2.
    pure subroutine follow(order, c, duration, side, in_pole2, state, other, rate, doubt, most)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order), duration(lanes), side(lanes), in_pole2(lanes), state(lanes, parts)
            !! Taylor coefficients; durations, s; sides; squares of the distances from a pole within which a place is in it;
            !! states at the end of the step
        real(dp), intent(inout) :: other(lanes) !! the other angles, rad
        real(dp), intent(out) :: rate(lanes) !! squares of the angular velocity, rad^2/s^2
        integer(int64), intent(out) :: doubt(lanes), most
            !! `changes_side`, `turns_far` or 0, and the largest of these
        real(dp), dimension(lanes) :: change, part, first, second, between, circling, bend
        real(dp) :: middle(lanes, parts), longest, nearest
        integer :: i

        call changes_to(state, other, change)
        call find_circling(order, c, duration, change, circling, bend)
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
            bend(i) = merge(duration(i)**2 * bend(i) - (straight - change(i)**2) * sqrt(nearest), 0.0_dp, &
                            abs(change(i)) <= sharp)
            bend(i) = merge(1.0_dp, bend(i), nearest <= in_pole2(i))
            most = max(most, doubt(i))
        end do
        if (most >= turns_far) then
            !$omp simd
            do i = 1, lanes
                part(i) = merge(0.5_dp, closest_to_pole(c(i, 4:5, 0), state(i, 4:5)), abs(change(i)) <= sharp)
            end do
            call terms_at(order, c, part * duration, middle)
            middle = middle * spread(part * duration, 2, parts) + c(:, :parts, 0)
            call changes_to(middle, other, first)
            between = other + first
            call changes_to(state, between, second)
            !$omp simd private(longest)
            do i = 1, lanes
                longest = max(part(i), 1 - part(i)) * duration(i)
                ! Where the whole step will do, both ways give the same.
                change(i) = first(i) + second(i)
                doubt(i) = merge(doubt(i), merge(no_reason, changes_side, side(i) * state(i, 6) >= border), &
                                 longest**2 * rate(i) > largest_turn**2 &
                                 .or. max(abs(first(i)), abs(second(i))) > sharp &
                                 .or. middle(i, 4)**2 + middle(i, 5)**2 <= in_pole2(i))
            end do
        end if
        most = 0
        !$omp simd reduction(max: most)
        do i = 1, lanes
            doubt(i) = merge(doubt(i), turns_far, bend(i) <= 0)
            most = max(most, doubt(i))
            other(i) = other(i) + merge(0.0_dp, change(i), doubt(i) >= turns_far)
        end do
    end subroutine follow

    !> Next to a pole the axis may circle about it while the body hardly turns. With the derivatives z1, z2, z3 of
    !> z = (Gamma2 + i Gamma1) exp(-i xi/2), which turns as the other angle does, its way over the step h is about
    !> straight as long as (|z2| + h |z3|) h^2 is at most |z| + h |z1|. `circling` is the square of the angular velocity
    !> that would limit the step alike, and `bend` is the larger of |z2| and |z2 + h z3| where it matters.
    pure subroutine find_circling(order, c, h, change, circling, bend)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order), h(lanes), change(lanes)
        real(dp), intent(out) :: circling(lanes), bend(lanes)
        !> A step is divided into so many at most.
        real(dp), parameter :: share = largest_turn**2, most_parts = 16
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
            bend(i) = merge(bend(i), 0.0_dp, x0 * x1 + y0 * y1 < 0 .and. change(i) * (x0 * y1 - y0 * x1) > 0)
            circling(i) = share * ((abs(x2) + abs(y2)) + h(i) * (abs(x3) + abs(y3))) &
                / max((abs(x0) + abs(y0)) + h(i) * (abs(x1) + abs(y1)), tiny(k))
            circling(i) = min(circling(i), (most_parts * largest_turn / max(h(i), sqrt(tiny(k))))**2)
        end do
    end subroutine find_circling

    !> The same bound of |z''| in one lane, over a time h.
    pure real(dp) function pole_bend(c, h) result(bend)
        real(dp), intent(in) :: c(rows, 0:3) !! Taylor coefficients of the lane
        real(dp), intent(in) :: h !! s
        real(dp) :: k
        complex(dp) :: z(0:3), spin, second, third
        k = c(7, 1) / 2
        z = cmplx(c(5, :), c(4, :), dp)
        spin = cmplx(0.0_dp, -k, dp)
        second = 2 * z(2) + 2 * spin * z(1) + spin**2 * z(0)
        third = 6 * z(3) + 6 * spin * z(2) + 3 * spin**2 * z(1) + spin**3 * z(0)
        bend = max(abs(second), abs(second + h * third))
    end function pole_bend

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

end module spintop_lane_steps
