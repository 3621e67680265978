!> Body z in a pole, and beside one: what the precession rate is there, and where nobody can tell.
module spintop_poles
    use spintop_kinds, only: dp
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: polar_precession_rate, precession_is_lost, through_pole

    !> A pole that is passed at a smaller distance is passed through, rad.
    real(dp), parameter :: through_pole = 1.0e-12_dp
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

end module spintop_poles
