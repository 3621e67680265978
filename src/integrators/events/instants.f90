!> Intervals in which a motion is searched for events: so short that in one of them the attitude turns by less than
!> `largest_turn`, and an axis moves by less than the fraction `largest_way` of its distance from the vertical.
module spintop_instants
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_compare, only: is_finite
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: through_pole
    use spintop_vectors, only: cross
    implicit none
    private
    public :: greatest_fall_rate, find_next_instant, is_short, time_of_start

    !> Maximum rotation of the attitude in an interval, rad, and maximum path of the axis relative to its distance from the
    !> vertical.
    real(dp), parameter :: largest_turn = 1.6_dp, largest_way = 0.8_dp
    !> An interval of so many spacings of the time is not divided.
    real(dp), parameter :: least_spacings = 8
    !> An event sooner after the start than this fraction of the time of one radian is the start.
    real(dp), parameter :: start_share = 1.0e-9_dp

contains

    !> The time after the start within which an event is the start itself, s.
    pure real(dp) function time_of_start(body, start) result(time)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: pace
        pace = norm2(start%omega) + 2 * greatest_fall_rate(body)
        time = 0
        if (pace > 0) time = start_share / pace
    end function time_of_start

    !> A rate whose square the angular acceleration due to the weight does not exceed, rad/s.
    pure real(dp) function greatest_fall_rate(body) result(rate)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp) :: arm(3)
        associate (r => body%centre_of_mass)
            arm = sqrt([r(2)**2 + r(3)**2, r(3)**2 + r(1)**2, r(1)**2 + r(2)**2])
        end associate
        rate = sqrt(norm2(body%mass * body%gravity * arm / body%inertia))
    end function greatest_fall_rate

    !> The end of the interval that begins at time `now`, at most `last`; the body turns no faster than `pace`.
    pure subroutine find_next_instant(motion, axis, now, last, pace, next, share)
        type(motion_t), intent(in) :: motion     !! at time `now`
        real(dp), intent(in) :: axis(3)          !! of the body; zero if no axis matters
        real(dp), intent(in) :: now, last, pace  !! s, s, rad/s
        real(dp), intent(out) :: next, share     !! the end, s; how long the interval is, by the longest that might be
        real(dp) :: gap
        gap = min(time_near_pole(motion, axis), 4 * (last - now)) ! no larger number is needed
        if (is_finite(pace) .and. pace * gap > largest_turn) gap = largest_turn / pace
        gap = max(gap, 2 * least_spacings * spacing(max(abs(now), abs(last))))
        next = last
        if (last - now > gap) next = now + (last - now) / (aint((last - now) / gap) + 1)
        share = (next - now) / gap
    end subroutine find_next_instant

    !> Time in which a body axis moves by a fraction of its distance from the vertical, s: for this path s,
    !> the speed v and the acceleration a in space, the solution of v t + a t^2/2 = s. Practically infinite
    !> without an axis.
    pure real(dp) function time_near_pole(motion, axis) result(time)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: axis(3)
        real(dp) :: way, speed, acceleration, velocity(3), change(3)
        time = huge(1.0_dp)
        if (.not. any(abs(axis) > 0)) return
        way = largest_way * max(norm2(cross(vertical_from_quaternion(motion%quaternion), axis)), through_pole)
        velocity = cross(motion%omega, axis)
        change = cross(motion%omega_rate, axis) + cross(motion%omega, velocity)
        speed = sqrt(sum(velocity**2))
        acceleration = sqrt(sum(change**2))
        if (speed + acceleration > 0) time = 2 * way / (speed + sqrt(speed**2 + 2 * acceleration * way))
    end function time_near_pole

    !> Whether an interval of time is too short to be divided.
    pure logical function is_short(a, b)
        real(dp), intent(in) :: a, b !! ends of the interval, s
        is_short = b - a <= least_spacings * spacing(max(abs(a), abs(b)))
    end function is_short

end module spintop_instants
