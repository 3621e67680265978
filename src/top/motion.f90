!> The motion of a top at one instant, in all descriptions.
module spintop_motion
    use spintop_kinds, only: dp
    use spintop_attitude, only: quaternion_from_angles, angles_from_quaternion, &
        omega_from_rates, rates_from_omega
    implicit none
    private
    public :: motion_t, passages_t, motion_from_angles, motion_from_quaternion

    !> The passages of body z through the upper and the lower pole so far (spintop_pole_passages): whether their number is
    !> odd; and whether body z has arrived in a pole, and not yet left it. How often it passed a pole at a distance within the
    !> error of the motion, so that nobody knows on which side, and whether it is so close.
    type :: passages_t
        logical :: odd(2) = .false., arrived = .false., is_close = .false.
        integer :: doubtful = 0
    contains
        procedure :: watch
    end type passages_t

    !> Attitude, velocity and acceleration of a top at an instant.
    type :: motion_t
        !> Time, s.
        real(dp) :: t = 0
        !> phi, theta, psi, rad; phi and psi continuous over any number of turns.
        real(dp) :: angle(3) = 0
        !> Rates of the angles, rad/s (phi and psi: not finite at a pole).
        real(dp) :: rate(3) = 0
        !> Angular velocity in body axes, rad/s.
        real(dp) :: omega(3) = 0
        !> Its time derivative in body axes, rad/s^2.
        real(dp) :: omega_rate(3) = 0
        !> Unit quaternion, scalar first, body to space.
        real(dp) :: quaternion(4) = [1, 0, 0, 0]
        !> Norm error abs(q) - 1 of the computed quaternion; 0 if the motion was computed by other means.
        real(dp) :: norm_error = 0
        !> phi, theta, psi in the axes in which the body was given, or angles near them, rad; only where these differ from
        !> the axes of the computation (spintop_given_axes).
        real(dp) :: given_angle(3) = 0
        !> Passages through the poles, in the axes in which the body was given.
        type(passages_t) :: passed = passages_t()
        !> For a start: which quantities were given and are exact. The others are computed from them and
        !> rounded. With `gives_quaternion` the quaternion is exact, not the angles; with `gives_omega` omega,
        !> with `gives_omega3` omega3 alone, not the rates.
        logical :: gives_quaternion = .false., gives_omega = .false., gives_omega3 = .false.
        !> Whether the angles and rates are what was given, except for those that these flags say.
        logical :: is_given = .false.
    contains
    end type motion_t

    !> A quaternion whose squared norm differs from 1 by less is not scaled.
    real(dp), parameter :: unit_slack = 1.0e-6_dp

contains

    !> Counts the times that body z comes as close to a pole as the error of the motion.
    pure subroutine watch(self, square, error)
        class(passages_t), intent(inout) :: self
        real(dp), intent(in) :: square, error !! square of the distance of body z from a pole, rad^2; the error, rad
        logical :: was_close
        was_close = self%is_close
        self%is_close = square < error**2
        if (self%is_close .and. .not. was_close) self%doubtful = self%doubtful + 1
    end subroutine watch

    !> Motion from the angles and their rates; the acceleration is left zero.
    pure type(motion_t) function motion_from_angles(t, angle, rate) result(motion)
        real(dp), intent(in) :: t, angle(3), rate(3) !! time, s; phi, theta, psi, rad; their rates, rad/s
        motion%t = t
        motion%angle = angle
        motion%rate = rate
        motion%omega = omega_from_rates(angle, rate)
        motion%quaternion = quaternion_from_angles(angle)
        motion%is_given = .true.
    end function motion_from_angles

    !> Motion from a unit quaternion and the body angular velocity. phi and psi are the values nearest to
    !> those of `near` (phi, theta, psi). The acceleration is left zero. A quaternion whose norm is not 1 to
    !> six digits is scaled; a zero quaternion gives NaN.
    pure type(motion_t) function motion_from_quaternion(t, q, omega, near) result(motion)
        real(dp), intent(in) :: t, q(4), omega(3), near(3)
            !! time, s; unit quaternion; angular velocity in body axes, rad/s; angles near the result, rad
        motion%t = t
        motion%angle = angles_from_quaternion(q, near)
        motion%rate = rates_from_omega(motion%angle, omega)
        motion%omega = omega
        motion%quaternion = q
        if (.not. abs(dot_product(q, q) - 1) <= unit_slack) motion%quaternion = q / norm2(q)
    end function motion_from_quaternion

end module spintop_motion
