!> Body z in a pole, and beside one: what the precession rate is there, and where nobody can tell.
module spintop_poles
    use spintop_attitude, only: conjugate_quaternion, to_space, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_effects, only: effect_drag, effect_friction, effect_lift
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_kinds, only: dp, cross
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: through_pole
    implicit none
    private
    public :: polar_precession_rate, precession_is_lost
    public :: reach_of, swings_over_poles, nearly_plane, exactly_plane

    !> A motion that is plane by its start passes through the poles if it misses them by less than this, rad: so far its
    !> rounding errors may have grown.
    real(dp), parameter :: reach_in_plane = 1.0e-2_dp
    !> Directions in a motion that is nearly plane, and in one that is plane to rounding, differ by no more from those of the
    !> plane, rad.
    real(dp), parameter :: nearly_plane = 1.0e-6_dp, exactly_plane = 1.0e-14_dp
    !> Closer to a pole than `near_pole`, rad, the precession rate is known at the nearest point of a way past the pole, and
    !> where the way misses it by more than `near_miss`: a million times its rounding.
    real(dp), parameter :: near_pole = 3.0e-5_dp, near_miss = 1.0e-9_dp

contains

    !> The limit of the precession rate where body z passes a pole, rad/s: of (Gamma1 omega1 + Gamma2 omega2)/(Gamma1^2 +
    !> Gamma2^2), in which both vanish as t^2. That of `rate` if body z does not move.
    pure real(dp) function polar_precession_rate(motion) result(rate)
        type(motion_t), intent(in) :: motion !! the motion in the pole, with its angular acceleration
        real(dp) :: gamma(3), across
        gamma = vertical_from_quaternion(motion%quaternion)
        associate (w => motion%omega, a => motion%omega_rate)
            across = w(1)**2 + w(2)**2
            rate = motion%rate(1)
            if (across > 0) rate = sign(0.5_dp, gamma(3)) * (w(3) + (w(1) * a(2) - w(2) * a(1)) / across)
        end associate
    end function polar_precession_rate

    !> Whether the precession rate is lost in rounding errors, where body z passes through a pole: the numerator of (Gamma1
    !> omega1 + Gamma2 omega2)/(Gamma1^2 + Gamma2^2) is the rate of body z times the distance at which it misses the pole.
    pure logical function precession_is_lost(gamma, omega)
        real(dp), intent(in) :: gamma(2), omega(2)
            !! components across body z of the upward vertical, and of the angular velocity, rad/s
        real(dp) :: sine, across
        sine = hypot(gamma(1), gamma(2))
        across = hypot(omega(1), omega(2))
        precession_is_lost = across > 0 .and. (sine <= through_pole .or. (sine <= near_pole .and. &
            abs(dot_product(gamma, omega)) <= min(near_miss, sine / 10) * across))
    end function precession_is_lost

    !> The horizontal principal axis about which a body turns in a plane motion, in body axes, if it does, as far as its weight
    !> and damping tell.
    pure subroutine find_swing_axis(body, start, nearly, axis, swings)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the start
        real(dp), intent(in) :: nearly !! how nearly, such as `nearly_plane` or `exactly_plane`
        real(dp), intent(out) :: axis(3) !! unit vector of the axis in body axes, if there is one
        logical, intent(out) :: swings !! whether there is such an axis
        real(dp) :: gamma(3), rate(6), change(3)
        swings = .false.
        axis = start%omega
        gamma = vertical_from_quaternion(start%quaternion)
        ! Most bodies turn about no horizontal axis, and this is asked for every case of a sweep.
        if (abs(dot_product(start%omega, gamma)) > 2 * nearly * sum(abs(start%omega))) return
        rate = euler_poisson_rate(body, [gamma, body%inertia * start%omega])
        change = rate(4:6) / body%inertia
        if (.not. norm2(axis) > 0) axis = change
        if (.not. norm2(axis) > 0) return
        axis = axis / norm2(axis)
        swings = abs(dot_product(axis, gamma)) <= nearly .and. norm2(cross(axis, change)) <= nearly * norm2(change) &
            .and. norm2(cross(axis, body%inertia * axis)) <= nearly * norm2(body%inertia)
    end subroutine find_swing_axis

    !> Whether a motion is nearly plane, about a principal axis at right angles to body z, which goes over the poles. There
    !> its nutation rate has an extreme at which the function that `nutation_slopes` gives, and that of the lanes, is all but
    !> zero; and its precession rate is zero, or larger than any that a computation resolves.
    pure logical function swings_over_poles(body, start, nearly)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the start
        real(dp), intent(in) :: nearly !! how nearly, such as `nearly_plane` or `exactly_plane`
        real(dp) :: axis(3)
        call find_swing_axis(body, start, nearly, axis, swings_over_poles)
        swings_over_poles = swings_over_poles .and. abs(axis(3)) <= nearly
    end function swings_over_poles

    !> The distance from a pole, rad, up to which a motion passes through it: in the axes of the computation and in those in
    !> which the body was given. Effects that may turn a plane motion out of its plane are taken to do so.
    pure function reach_of(body, start) result(reach)
        type(body_t), intent(in) :: body !! mass properties of the body, with its effects
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: reach(2), axis(3)
        logical :: swings
        reach = through_pole
        if (allocated(body%effects)) then
            if (.not. body%effects%only(effect_friction + effect_drag + effect_lift)) return
        end if
        call find_swing_axis(body, start, exactly_plane, axis, swings)
        if (.not. swings) return
        if (abs(axis(3)) <= exactly_plane) reach(1) = reach_in_plane
        if (.not. body%given%differ) return
        axis = to_space(conjugate_quaternion(body%given%p), axis)
        if (abs(axis(3)) <= exactly_plane) reach(2) = reach_in_plane
    end function reach_of

end module spintop_poles
