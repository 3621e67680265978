!> Checks of bodies and motions: the one place that decides, for every public procedure of the library,
!> whether they are valid.
!>
!> A violated triangle inequality is not refused here: the paper's Example 2 violates it about the centre
!> of mass, and its equations still have a solution.
module spintop_validity
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_attitude, only: omega_from_rates, quaternion_from_angles
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_non_finite, status_bad_body, status_bad_start
    implicit none
    private
    public :: body_status, motion_status, start_status, no_number

    !> A quiet NaN: what a function returns that has no status and no value.
    real(dp), parameter :: no_number = transfer([0, 2146959360], 1.0_dp)

    !> Rotation angle, rad, up to which quaternion and angles are the same attitude, and relative
    !> difference up to which omega and rates are the same velocity: data of six digits.
    real(dp), parameter :: slack = 2.0e-6_dp
    !> Closer to a pole, as sin(theta), rates are not compared: they cancel, or do not exist.
    real(dp), parameter :: near_pole = 1.0e-3_dp
    !> Still closer, the rates of phi and psi may overflow.
    real(dp), parameter :: at_pole = 1.0e-150_dp

contains

    !> `status_ok` for a body of finite numbers with a positive mass and without negative moments of
    !> inertia or damping coefficients; else `status_non_finite` or `status_bad_body`. Single moments
    !> may be zero (a thin rod): which equations hold for such a body is for others to say.
    pure integer function body_status(body) result(status)
        type(body_t), intent(in) :: body
        associate (a => body%inertia, r => body%centre_of_mass, d => body%damping)
            ! Zero times a number is zero, but not if it is infinite or a NaN: one comparison for all.
            if (.not. abs(0 * body%mass + 0 * body%gravity + sum(0 * a) + sum(0 * r) + sum(0 * d)) <= 0) then
                status = status_non_finite
            else if (.not. body%mass > 0 .or. min(a(1), a(2), a(3)) < 0 .or. min(d(1), d(2), d(3)) < 0) then
                status = status_bad_body
            else
                status = status_ok
            end if
        end associate
    end function body_status

    !> `status_ok` for a motion of finite time, angles, angular velocity and quaternion that describe
    !> one attitude; else `status_non_finite` or `status_bad_start`. The quaternion may have any length
    !> but zero. Rates are looked at by `start_status`.
    pure integer function motion_status(motion) result(status)
        type(motion_t), intent(in) :: motion
        real(dp) :: length, along, allowed
        associate (q => motion%quaternion, angle => motion%angle, omega => motion%omega)
            status = status_non_finite
            if (.not. abs(0 * motion%t + sum(0 * angle) + sum(0 * omega) + sum(0 * q)) <= 0) return
            status = status_bad_start
            length = norm2(q)
            if (.not. length > 0) return
            along = dot_product(q / length, quaternion_from_angles(angle))
            ! Large angles have large roundings.
            allowed = slack + 4 * epsilon_dp * (abs(angle(1)) + abs(angle(2)) + abs(angle(3)))
            ! The cosine of half of the rotation angle between them.
            if (1 - abs(along) > allowed**2 / 8 + 8 * epsilon_dp) return
        end associate
        status = status_ok
    end function motion_status

    !> The same for a start of which rates may be used, too: these are finite, but at a pole, and,
    !> but near a pole, those of the angular velocity.
    pure integer function start_status(start) result(status)
        type(motion_t), intent(in) :: start
        real(dp) :: sine
        status = motion_status(start)
        if (status /= status_ok) return
        sine = abs(sin(start%angle(2)))
        if (.not. all(is_finite(start%rate))) then
            if (sine > at_pole) status = status_non_finite
        else if (sine > near_pole) then
            associate (rate => start%rate, omega => start%omega)
                if (norm2(omega_from_rates(start%angle, rate) - omega) &
                    > (slack + 4 * epsilon_dp * abs(start%angle(3))) * (norm2(omega) + norm2(rate))) status = status_bad_start
            end associate
        end if
    end function start_status

end module spintop_validity
