!> Energies, momenta, residuals and the axis of a motion of any rigid body.
module spintop_quantities
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_euler_poisson, only: euler_poisson_rate, euler_poisson_state
    use spintop_loads, only: acceleration, frame_energy, loads_t, momentum_rate, total_momentum
    use spintop_attitude, only: to_space, vertical_from_quaternion
    use spintop_support_force, only: loads_of
    use spintop_vectors, only: cross
    implicit none
    private
    public :: kinetic_energy, potential_energy, energy_scale, vertical_momentum, axial_momentum
    public :: euler_residuals, axis_tip, axis_height_rate
    public :: kovalevskaya_integral, goryachev_integral, angular_acceleration

contains

    !> Kinetic energy, J.
    pure real(dp) function kinetic_energy(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        kinetic_energy = dot_product(body%inertia, motion%omega**2) / 2
        if (body%has_products()) kinetic_energy = dot_product(body%momentum(motion%omega), motion%omega) / 2
    end function kinetic_energy

    !> Potential energy above the height of the pivot, J, with that of the motion of the frame.
    pure real(dp) function potential_energy(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        potential_energy = body%mass * body%gravity &
            * dot_product(body%centre_of_mass, vertical_from_quaternion(motion%quaternion))
        if (.not. allocated(body%effects)) return
        potential_energy = potential_energy + frame_energy(body, motion%t, motion%quaternion)
    end function potential_energy

    !> Scale of energy errors, J: kinetic energy at the start + m g |r|; positive also for a body at rest
    !> without weight.
    pure real(dp) function energy_scale(body, start)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        energy_scale = max(kinetic_energy(body, start) + body%mass * body%gravity * norm2(body%centre_of_mass), &
                           tiny(1.0_dp))
    end function energy_scale

    !> Angular momentum about the vertical, kg m^2/s ("c1" of Eq 41).
    pure real(dp) function vertical_momentum(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        vertical_momentum = dot_product(total_momentum(body, motion%t, motion%quaternion, motion%omega), &
                                        vertical_from_quaternion(motion%quaternion))
    end function vertical_momentum

    !> Angular momentum about body z, kg m^2/s.
    pure real(dp) function axial_momentum(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: momentum(3)
        momentum = total_momentum(body, motion%t, motion%quaternion, motion%omega)
        axial_momentum = momentum(3)
    end function axial_momentum

    !> Kovalevskaya's integral |(omega1 + i omega2)^2 - nu (Gamma1 + i Gamma2)|^2 with nu = m g (x + i y)/I3, 1/s^4. It is
    !> constant for I1 = I2 = 2 I3 and z = 0 (S. Kovalevskaya, Sur le probleme de la rotation d'un corps solide autour d'un
    !> point fixe, Acta Math. 12, 1889).
    pure real(dp) function kovalevskaya_integral(body, motion) result(integral)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        complex(dp) :: rate, nu, vertical
        real(dp) :: gamma(3), moment(3)
        gamma = vertical_from_quaternion(motion%quaternion)
        moment = body%weight_moment()
        nu = cmplx(moment(1), moment(2), dp) / body%inertia(3)
        vertical = cmplx(gamma(1), gamma(2), dp)
        rate = cmplx(motion%omega(1), motion%omega(2), dp)
        integral = abs(rate**2 - nu * vertical)**2
    end function kovalevskaya_integral

    !> The integral of Goryachev and Chaplygin omega3 (omega1^2 + omega2^2) - (nu1 omega1 + nu2 omega2) Gamma3 with nu =
    !> m g r/I3, 1/s^3. It is constant for I1 = I2 = 4 I3 and z = 0 if the vertical momentum vanishes (Chaplygin 1901).
    pure real(dp) function goryachev_integral(body, motion) result(integral)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: gamma(3), moment(3)
        gamma = vertical_from_quaternion(motion%quaternion)
        moment = body%weight_moment()
        associate (omega => motion%omega)
            integral = omega(3) * (omega(1)**2 + omega(2)**2) &
                       - dot_product(moment(1:2), omega(1:2)) / body%inertia(3) * gamma(3)
        end associate
    end function goryachev_integral

    !> Residual of Euler's equations, I omega' + omega x I omega - torque, N m; with effects, of those for P'. The first
    !> two components are R1 and R2 of Eq 51.
    pure function euler_residuals(body, motion) result(residual)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude, angular velocity and acceleration at an instant
        real(dp) :: residual(3)
        type(loads_t) :: loads
        if (allocated(body%effects)) then
            call loads_of(body, motion, loads)
            residual = momentum_rate(body, motion%quaternion, motion%omega, motion%omega_rate) - loads%rate
            return
        end if
        residual = body%inertia * motion%omega_rate &
                   + cross(motion%omega, body%inertia * motion%omega) &
                   + body%damping * motion%omega &
                   - body%torque(vertical_from_quaternion(motion%quaternion))
        if (body%has_products()) residual = body%momentum(motion%omega_rate) &
                                            + cross(motion%omega, body%momentum(motion%omega)) &
                                            + body%damping * motion%omega &
                                            - body%torque(vertical_from_quaternion(motion%quaternion))
    end function euler_residuals

    !> Tip of the axis in space axes: the unit vector from the pivot to the centre of mass, or
    !> along body z where both coincide.
    pure function axis_tip(body, motion) result(tip)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: tip(3)
        tip = [0.0_dp, 0.0_dp, 1.0_dp]
        if (norm2(body%centre_of_mass) > 0) tip = body%centre_of_mass / norm2(body%centre_of_mass)
        tip = to_space(motion%quaternion, tip)
    end function axis_tip

    !> Rate of the height of body z, cos(theta), 1/s: zero at the turning points of theta, smooth at the
    !> poles. It is exactly zero where it is only a rounding error.
    pure real(dp) function axis_height_rate(motion) result(rate)
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        !> Rounding error of gamma and omega across body z, relative to their magnitudes.
        real(dp), parameter :: rounding = 8 * epsilon(1.0_dp)
        real(dp) :: gamma(3)
        gamma = vertical_from_quaternion(motion%quaternion)
        associate (omega => motion%omega)
            rate = gamma(1) * omega(2) - gamma(2) * omega(1)
            if (abs(rate) <= rounding * hypot(gamma(1), gamma(2)) * hypot(omega(1), omega(2))) rate = 0
        end associate
    end function axis_height_rate

    !> The angular acceleration of a body in principal axes, with all effects on it, rad/s^2.
    pure function angular_acceleration(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: angular_acceleration(3), rate(6)
        type(loads_t) :: loads
        if (allocated(body%effects)) then
            call loads_of(body, motion, loads)
            angular_acceleration = acceleration(body, loads)
        else
            rate = euler_poisson_rate(body, euler_poisson_state(body, motion))
            angular_acceleration = rate(4:6) / body%inertia
        end if
    end function angular_acceleration

end module spintop_quantities
