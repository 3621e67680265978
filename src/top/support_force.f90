!> The force of the support on a body, and what an accelerometer in it reads.
module spintop_support_force
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_body_turn, only: turn_to_principal_axes
    use spintop_motion, only: motion_t
    use spintop_loads, only: find_loads, loads_t, total_momentum
    use spintop_attitude, only: conjugate_quaternion, quaternion_product, to_space, vertical_from_quaternion
    use spintop_vectors, only: cross
    implicit none
    private
    public :: support_force, specific_force, loads_of

contains

    !> Support force on the body in space axes, N: the mass times the acceleration of the centre of mass,
    !> minus the weight (Eqs 47-50 for any rigid body).
    pure function support_force(body, motion) result(force)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude, angular velocity and acceleration at an instant
        real(dp) :: force(3)
        type(loads_t) :: loads
        if (allocated(body%effects)) then
            call loads_of(body, motion, loads)
            force = to_space(motion%quaternion, loads%force)
            return
        end if
        force = to_space(motion%quaternion, centre_acceleration(body, motion))
        force = body%mass * (force + [0.0_dp, 0.0_dp, body%gravity])
    end function support_force

    !> What an accelerometer at the centre of mass reads, in body axes: all forces but weight over the mass, m/s^2.
    pure function specific_force(body, motion) result(reading)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude, angular velocity and acceleration at an instant
        real(dp) :: reading(3)
        type(loads_t) :: loads
        if (allocated(body%effects)) then
            call loads_of(body, motion, loads)
            reading = (loads%force + loads%drag) / body%mass
            return
        end if
        reading = centre_acceleration(body, motion) + body%gravity * vertical_from_quaternion(motion%quaternion)
    end function specific_force

    !> Acceleration of the centre of mass in body axes, m/s^2, where the pivot is at rest.
    pure function centre_acceleration(body, motion) result(acceleration)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        real(dp) :: acceleration(3)
        associate (r => body%centre_of_mass, w => motion%omega)
            acceleration = cross(motion%omega_rate, r) + cross(w, cross(w, r))
        end associate
    end function centre_acceleration

    !> What acts on a body with effects in a motion: of a body that is given in other than principal axes, only the forces
    !> and the rate of the momentum are in its own axes.
    pure subroutine loads_of(body, motion, loads)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        type(loads_t), intent(out) :: loads !! forces and moments, and the rate of the momentum
        type(body_t) :: principal
        real(dp) :: p(4), q(4)
        if (body%has_products()) then
            call turn_to_principal_axes(body, principal, p)
            q = quaternion_product(motion%quaternion, conjugate_quaternion(p))
            call find_loads(principal, principal%effects, motion%t, q, &
                            total_momentum(principal, motion%t, q, to_space(p, motion%omega)), loads)
            loads%force = to_space(conjugate_quaternion(p), loads%force)
            loads%drag = to_space(conjugate_quaternion(p), loads%drag)
            loads%rate = to_space(conjugate_quaternion(p), loads%rate)
            return
        end if
        call find_loads(body, body%effects, motion%t, motion%quaternion, &
                        total_momentum(body, motion%t, motion%quaternion, motion%omega), loads)
    end subroutine loads_of

end module spintop_support_force
