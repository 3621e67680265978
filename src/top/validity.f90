!> Checks of bodies and motions for all public procedures of the library.
!>
!> A violated triangle inequality is not refused here: Example 2 of the paper violates it about the centre of
!> mass, and its equations have a solution.
module spintop_validity
    use spintop_kinds, only: dp, epsilon_dp, is_finite, pi
    use spintop_attitude, only: quaternion_from_angles, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_bad_body, status_bad_start, status_non_finite, status_ok, status_unsuitable
    implicit none
    private
    public :: body_status, plain_body_status, motion_status, start_status, underflows

    !> Rotation angle, rad, up to which quaternion and angles count as the same attitude, and relative
    !> difference up to which omega and rates count as the same velocity: data of six digits pass.
    real(dp), parameter :: slack = 2.0e-6_dp
    !> Closer to a pole, sin(theta) below this, rates are not compared: they cancel, or do not exist.
    real(dp), parameter :: near_pole = 1.0e-3_dp
    !> Still closer, the rates of phi and psi may overflow.
    real(dp), parameter :: at_pole = 1.0e-150_dp
    !> Smaller products lose digits, or vanish.
    real(dp), parameter :: least_product = 1.0e-290_dp

contains

    !> `status_ok` for a body of finite numbers in its principal axes with a positive mass, without negative moments of
    !> inertia or damping coefficients, with valid effects, and with a weight and its swing not lost to underflow; else
    !> `status_non_finite` or `status_bad_body`. Single moments may be zero (a thin rod): `can_run` decides which
    !> equations hold for such a body.
    pure integer function body_status(body) result(status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        associate (a => body%inertia, r => body%centre_of_mass, d => body%damping)
            ! Zero times a number is zero unless the number is infinite or NaN: one comparison checks all.
            if (.not. abs(0 * body%mass + 0 * body%gravity + sum(0 * a) + sum(0 * r) + sum(0 * d)) <= 0) then
                status = status_non_finite
            else if (.not. body%mass > 0 .or. min(a(1), a(2), a(3)) < 0 .or. min(d(1), d(2), d(3)) < 0 .or. &
                     body%has_products()) then
                status = status_bad_body
            else
                status = merge(status_bad_body, status_ok, underflows(body))
                if (allocated(body%effects)) then
                    if (.not. body%effects%is_valid()) status = status_bad_body
                end if
            end if
        end associate
    end function body_status

    !> Whether a product underflows, so that the body would move as if a datum were zero: of a body its weight times its
    !> distance, and that times the inertia; of the motion of a body without weight its kinetic energy, and the square of its
    !> momentum.
    pure logical function underflows(body, omega)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in), optional :: omega(3) !! angular velocity in body axes, rad/s
        real(dp) :: weight, pull, momentum(3)
        weight = abs(body%mass * body%gravity)
        pull = weight * max(abs(body%centre_of_mass(1)), abs(body%centre_of_mass(2)), abs(body%centre_of_mass(3)))
        underflows = .false.
        if (abs(body%gravity) > 0 .and. any(abs(body%centre_of_mass) > 0)) then
            underflows = min(weight, pull, pull * max(body%inertia(1), body%inertia(2), body%inertia(3))) < least_product
        else if (present(omega)) then
            momentum = abs(body%inertia * omega)
            underflows = any(abs(omega) > 0 .and. body%inertia > 0) .and. &
                (all(momentum * abs(omega) < least_product) .or. all(momentum**2 < least_product))
        end if
    end function underflows

    !> `body_status` where the equations hold for bodies without effects only: `status_unsuitable` for others.
    pure integer function plain_body_status(body) result(status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        status = body_status(body)
        if (is_ok(status) .and. allocated(body%effects)) status = status_unsuitable
    end function plain_body_status

    !> `status_ok` for a motion with finite time, angles, angular velocity and quaternion whose angles and
    !> quaternion describe one attitude, and whose energy is not lost to underflow; else `status_non_finite` or
    !> `status_bad_start`. The quaternion may have any nonzero norm. Rates are checked by `start_status`.
    pure integer function motion_status(motion, body) result(status)
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        type(body_t), intent(in), optional :: body !! the body that moves; without it its energy is not checked
        real(dp) :: of_angles(4)
        call check_motion(motion, body, of_angles, status)
    end function motion_status

    !> The status of a motion, and the quaternion of its angles.
    pure subroutine check_motion(motion, body, of_angles, status)
        type(motion_t), intent(in) :: motion
        type(body_t), intent(in), optional :: body
        real(dp), intent(out) :: of_angles(4)
        integer, intent(out) :: status
        real(dp) :: length, along, allowed
        associate (q => motion%quaternion, angle => motion%angle, omega => motion%omega)
            status = status_non_finite
            if (.not. abs(0 * motion%t + sum(0 * angle) + sum(0 * omega) + sum(0 * q)) <= 0) return
            status = status_bad_start
            length = sqrt(sum(q**2))
            ! Squares of a quaternion that is not near a unit one might overflow.
            if (.not. abs(length - 1) < 0.5_dp) length = norm2(q)
            if (.not. length > 0) return
            of_angles = quaternion_from_angles(angle)
            along = dot_product(q / length, of_angles)
            ! Large angles have large rounding errors.
            allowed = slack + 4 * epsilon_dp * (abs(angle(1)) + abs(angle(2)) + abs(angle(3)))
            ! The cosine of half of the rotation angle between them.
            if (1 - abs(along) > allowed**2 / 8 + 8 * epsilon_dp) return
        end associate
        if (present(body)) then
            if (underflows(body, motion%omega)) return
        end if
        status = status_ok
    end subroutine check_motion

    !> The same for a start whose rates may be used: they must be finite except at a pole, and agree with the
    !> angular velocity except near a pole.
    pure integer function start_status(start, body) result(status)
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(body_t), intent(in) :: body !! the body that moves
        real(dp) :: of_angles(4), vertical(3), sine, difference(3), allowed
        call check_motion(start, body, of_angles, status)
        if (.not. is_ok(status)) return
        vertical = vertical_from_quaternion(of_angles)
        sine = sqrt(vertical(1)**2 + vertical(2)**2)
        if (.not. (start%angle(2) >= 0 .and. start%angle(2) <= pi)) sine = sign(sine, sin(start%angle(2)))
        if (.not. all(is_finite(start%rate))) then
            if (abs(sine) > at_pole) status = status_non_finite
        else if (abs(sine) > near_pole) then
            associate (rate => start%rate, omega => start%omega)
                ! phi' is about the vertical, theta' about the line of nodes, psi' about body z.
                difference = rate(1) * vertical - omega
                difference(1:2) = difference(1:2) + rate(2) / sine * [vertical(2), -vertical(1)]
                difference(3) = difference(3) + rate(3)
                allowed = slack + 4 * epsilon_dp * abs(start%angle(3))
                ! Bounds of the norms, which take longer, mostly suffice.
                if (sum(abs(difference)) <= allowed * max(abs(omega(1)), abs(omega(2)), abs(omega(3)))) return
                if (norm2(difference) > allowed * (norm2(omega) + norm2(rate))) status = status_bad_start
            end associate
        end if
    end function start_status

end module spintop_validity
