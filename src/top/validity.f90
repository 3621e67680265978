!> Checks of bodies and motions for all public procedures of the library.
!>
!> A violated triangle inequality is not refused here: Example 2 of the paper violates it about the centre of
!> mass, and its equations have a solution.
module spintop_validity
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_attitude, only: omega_from_rates, quaternion_from_angles
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_motion, only: motion_t
    use spintop_status, only: status_ok, status_non_finite, status_bad_body, status_bad_start, status_unsuitable
    implicit none
    private
    public :: body_status, plain_body_status, motion_status, start_status

    !> Rotation angle, rad, up to which quaternion and angles count as the same attitude, and relative
    !> difference up to which omega and rates count as the same velocity: data of six digits pass.
    real(dp), parameter :: slack = 2.0e-6_dp
    !> Closer to a pole, sin(theta) below this, rates are not compared: they cancel, or do not exist.
    real(dp), parameter :: near_pole = 1.0e-3_dp
    !> Still closer, the rates of phi and psi may overflow.
    real(dp), parameter :: at_pole = 1.0e-150_dp

contains

    !> `status_ok` for a body of finite numbers with a positive mass and without negative moments of inertia
    !> or damping coefficients, and with valid effects; else `status_non_finite` or `status_bad_body`. Single moments may be zero (a
    !> thin rod): `can_run` decides which equations hold for such a body.
    pure integer function body_status(body) result(status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        associate (a => body%inertia, r => body%centre_of_mass, d => body%damping)
            ! Zero times a number is zero unless the number is infinite or NaN: one comparison checks all.
            if (.not. abs(0 * body%mass + 0 * body%gravity + sum(0 * a) + sum(0 * r) + sum(0 * d)) <= 0) then
                status = status_non_finite
            else if (.not. body%mass > 0 .or. min(a(1), a(2), a(3)) < 0 .or. min(d(1), d(2), d(3)) < 0) then
                status = status_bad_body
            else
                status = status_ok
                if (allocated(body%effects)) status = merge(status_ok, status_bad_body, body%effects%is_valid())
            end if
        end associate
    end function body_status

    !> The same where the equations hold for bodies without effects only: `status_unsuitable` for others.
    pure integer function plain_body_status(body) result(status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        status = body_status(body)
        if (status == status_ok .and. allocated(body%effects)) status = status_unsuitable
    end function plain_body_status

    !> `status_ok` for a motion with finite time, angles, angular velocity and quaternion whose angles and
    !> quaternion describe one attitude; else `status_non_finite` or `status_bad_start`. The quaternion may
    !> have any nonzero norm. Rates are checked by `start_status`.
    pure integer function motion_status(motion) result(status)
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: length, along, allowed
        associate (q => motion%quaternion, angle => motion%angle, omega => motion%omega)
            status = status_non_finite
            if (.not. abs(0 * motion%t + sum(0 * angle) + sum(0 * omega) + sum(0 * q)) <= 0) return
            status = status_bad_start
            length = sqrt(sum(q**2))
            ! Squares of a quaternion that is not near a unit one might overflow.
            if (.not. abs(length - 1) < 0.5_dp) length = norm2(q)
            if (.not. length > 0) return
            along = dot_product(q / length, quaternion_from_angles(angle))
            ! Large angles have large rounding errors.
            allowed = slack + 4 * epsilon_dp * (abs(angle(1)) + abs(angle(2)) + abs(angle(3)))
            ! The cosine of half of the rotation angle between them.
            if (1 - abs(along) > allowed**2 / 8 + 8 * epsilon_dp) return
        end associate
        status = status_ok
    end function motion_status

    !> The same for a start whose rates may be used: they must be finite except at a pole, and agree with the
    !> angular velocity except near a pole.
    pure integer function start_status(start) result(status)
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp) :: sine, difference(3), allowed
        status = motion_status(start)
        if (status /= status_ok) return
        sine = abs(sin(start%angle(2)))
        if (.not. all(is_finite(start%rate))) then
            if (sine > at_pole) status = status_non_finite
        else if (sine > near_pole) then
            associate (rate => start%rate, omega => start%omega)
                difference = omega_from_rates(start%angle, rate) - omega
                allowed = slack + 4 * epsilon_dp * abs(start%angle(3))
                ! Bounds of the norms, which take longer, mostly suffice.
                if (sum(abs(difference)) <= allowed * max(abs(omega(1)), abs(omega(2)), abs(omega(3)))) return
                if (norm2(difference) > allowed * (norm2(omega) + norm2(rate))) status = status_bad_start
            end associate
        end if
    end function start_status

end module spintop_validity
