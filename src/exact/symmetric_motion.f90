!> The exact solution of a symmetric top without damping (Lagrange top).
!>
!> After its preparation it gives the motion at any time, forward or backward, at a cost and with an accuracy
!> that do not depend on the time span. The attitude is a product of theta functions (Jacobi 1850; Klein and
!> Sommerfeld 1898). They are regular at the poles, and nothing has to be integrated or unwrapped.
!>
!>     call prepare_symmetric_motion(body, start, exact, status)
!>     motion = exact%at(t)
!>
!> The remaining rounding error is that of rate times time. The constants and the phases are therefore in
!> extended precision; only the reduced phases are in double precision.
module spintop_symmetric_motion
    use spintop_kinds, only: dp, xp, pi_xp, is_finite
    use spintop_status, only: is_ok, status_non_finite
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_circular_functions, only: argument
    use spintop_turning_points, only: find_checked_points
    use spintop_theta_functions, only: theta_values_t
    use spintop_theta_motion, only: regime_resting
    use spintop_nutation, only: describe_nutation, is_defined
    use spintop_symmetric_attitude, only: attitude_t, find_angles_of_attitude, find_attitude, find_thetas, symmetric_motion_t
    implicit none
    private
    public :: symmetric_motion_t, prepare_symmetric_motion, symmetric_at, symmetric_angles, symmetric_quaternion

    complex(dp), parameter :: i = (0.0_dp, 1.0_dp)

contains

    !> Prepares the exact solution of `body` from `start`. It uses angles and rates or, close to a pole,
    !> quaternion and omega. `status` is `status_ok`, `status_unsuitable` (not an undamped symmetric top),
    !> `status_non_finite`, `status_bad_body` or `status_bad_start`.
    pure subroutine prepare_symmetric_motion(body, start, exact, status, rotor)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(symmetric_motion_t), intent(inout) :: exact !! on entry as it is at first: to set it again would take time
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(in), optional :: rotor !! constant momentum of a rotor about body z, kg m^2/s

        call find_checked_points(body, start, exact%theta%turning_points_t, status, rotor)
        if (.not. is_ok(status)) return
        call exact%theta%set_form()
        exact%nutation = describe_nutation(exact%theta)
        exact%passes_pole = exact%nutation%passes_top .or. exact%nutation%passes_bottom
        associate (points => exact%theta)
            exact%upper = cmplx(points%upper, kind=dp)
            exact%lower = cmplx(points%lower, kind=dp)
            exact%omega3 = real(points%omega3, dp)
            exact%upper_phase = points%upper_phase
            exact%lower_phase = points%lower_phase
            ! An axis at rest: the body spins about it.
            exact%upper_rate = points%omega3 / 2
            exact%lower_rate = -points%omega3 / 2
            exact%difference_rate = points%omega3
        end associate
        if (exact%theta%regime /= regime_resting) call set_phases(exact)
        if (is_defined(exact%nutation) .and. is_finite(real(exact%upper_phase + exact%lower_phase, dp))) return
        status = status_non_finite
        block
            type(symmetric_motion_t) :: unprepared
            exact = unprepared
        end block
    end subroutine prepare_symmetric_motion

    !> Rates of the phases, and the constants that make the motion pass through the start.
    pure subroutine set_phases(exact)
        type(symmetric_motion_t), intent(inout) :: exact
        real(dp) :: z, from_top
        real(xp) :: nutations, upper_then, lower_then
        type(theta_values_t) :: theta

        associate (start => exact%theta, clock => exact%theta%clock)
            exact%upper_rate = start%half() + clock%upper_rate
            exact%lower_rate = -start%half() + clock%lower_rate
            exact%difference_rate = 2 * start%half() + clock%upper_rate - clock%lower_rate

            call exact%theta%locate(0.0_xp, z, from_top, nutations)
            exact%tops_before = nutations
            exact%bottoms_before = merge(nutations, nutations - 1, z >= 0)
            call exact%theta%evaluate(z, from_top, theta)
            exact%upper_phase = phase_constant(theta%upper, theta%upper_slope, clock%upper_rate, &
                                               start%upper, start%upper_rate)
            exact%lower_phase = phase_constant(theta%lower, theta%lower_slope, clock%lower_rate, &
                                               start%lower, start%lower_rate)

            ! Whole turns are added: phi and psi begin at their given values.
            upper_then = exact%upper_phase + argument(theta%upper)
            lower_then = exact%lower_phase + argument(theta%lower)
            exact%upper_phase = exact%upper_phase - nutations * clock%upper_step &
                + 2 * pi_xp * anint((start%upper_phase - upper_then) / (2 * pi_xp))
            exact%lower_phase = exact%lower_phase - nutations * clock%lower_step &
                + 2 * pi_xp * anint((start%lower_phase - lower_then) / (2 * pi_xp))
        end associate

    contains

        !> The angle A for which exp(i A) times the formula of a component gives the start. It uses value and
        !> rate together, because at a pole one of them may vanish.
        pure real(dp) function phase_constant(value, slope, rate, x, x_rate)
            complex(dp), intent(in) :: value, slope  !! of the theta function, by z
            real(xp), intent(in) :: rate             !! of the phase, rad/s
            complex(xp), intent(in) :: x, x_rate     !! the component at the start and its rate
            complex(dp) :: formula, formula_rate
            real(dp) :: z_rate
            z_rate = real(exact%theta%clock%rate, dp)
            formula = value / theta%divisor
            formula_rate = i * real(rate, dp) * formula + z_rate &
                * (slope - value * (theta%divisor_slope / theta%divisor)) / theta%divisor
            phase_constant = argument(real(exact%theta%roots%frequency, dp)**2 * conjg(formula) * cmplx(x, kind=dp) &
                                      + conjg(formula_rate) * cmplx(x_rate, kind=dp))
        end function phase_constant

    end subroutine set_phases

    !> The motion at time t, s, or at an array of times. Its attitude is NaN at a time that is not finite, and
    !> for a solution that was not prepared. At an exact passage of a pole the rates of phi and psi do not
    !> exist; the result is their limit for passages that approach the pole.
    elemental type(motion_t) function symmetric_at(self, t) result(motion)
        type(symmetric_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        type(attitude_t) :: attitude
        complex(dp) :: swing, swing_rate

        call find_attitude(self, t, attitude)
        swing = swing_of(self, attitude)
        swing_rate = -i * (self%omega3 - real(self%theta%a, dp)) * swing &
            + real(self%theta%beta, dp) * attitude%lower * conjg(attitude%upper)
        motion%t = t
        motion%quaternion = quaternion_of(self, attitude)
        motion%omega = [real(swing, dp), aimag(swing), self%omega3]
        motion%omega_rate = [real(swing_rate, dp), aimag(swing_rate), 0.0_dp]
        call find_angles_of_attitude(self, attitude, motion%angle, motion%rate)
    end function symmetric_at

    !> The angles and their rates at time t, s, as `at` gives them. Without the attitude it is faster.
    pure subroutine symmetric_angles(self, t, angle, rate)
        type(symmetric_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(out) :: angle(3), rate(3) !! phi, theta, psi, rad, and their rates, rad/s
        type(attitude_t) :: attitude
        call find_thetas(self, t, attitude)
        call find_angles_of_attitude(self, attitude, angle, rate)
    end subroutine symmetric_angles

    !> The unit quaternion at time t, s.
    pure function symmetric_quaternion(self, t) result(q)
        type(symmetric_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: q(4)
        type(attitude_t) :: attitude
        call find_attitude(self, t, attitude)
        q = quaternion_of(self, attitude)
    end function symmetric_quaternion

    !> The quaternion of an attitude, with the sign of that of the start.
    pure function quaternion_of(self, attitude) result(q)
        type(symmetric_motion_t), intent(in) :: self
        type(attitude_t), intent(in) :: attitude
        real(dp) :: q(4)
        q = [real(attitude%upper, dp), real(attitude%lower, dp), aimag(attitude%lower), aimag(attitude%upper)]
        if (self%theta%turns_against_angles) q = -q
    end function quaternion_of

    !> omega1 + i omega2 = 2 [conj(upper) lower' - conj(upper') lower], rad/s. The derivative of the divisor
    !> and the spin that is linear in time cancel and are omitted.
    pure complex(dp) function swing_of(self, now) result(swing)
        type(symmetric_motion_t), intent(in) :: self
        type(attitude_t), intent(in) :: now
        swing = 0
        if (self%theta%regime == regime_resting) return
        associate (clock => self%theta%clock, theta => now%theta)
            swing = 2 * conjg(now%upper_turn) * now%lower_turn &
                * (i * real(clock%sum_rate, dp) * conjg(theta%upper) * theta%lower &
                   + real(clock%rate, dp) * (conjg(theta%upper) * theta%lower_slope &
                                             - conjg(theta%upper_slope) * theta%lower))
        end associate
    end function swing_of

end module spintop_symmetric_motion
