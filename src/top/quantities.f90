!> Energies, momenta, residuals, the support force and the axis of a motion of any rigid body; and the scales of a motion, in
!> which its errors are measured, so that they do not depend on the units of mass, length and time.
module spintop_quantities
    use spintop_kinds, only: dp, cross
    use spintop_body, only: body_t
    use spintop_body_turn, only: turn_to_principal_axes
    use spintop_motion, only: motion_t
    use spintop_euler_poisson, only: euler_poisson_rate, euler_poisson_state
    use spintop_loads, only: acceleration, find_loads, frame_energy, loads_t, momentum_rate, total_momentum
    use spintop_attitude, only: conjugate_quaternion, quaternion_product, to_space, vertical_from_quaternion
    implicit none
    private
    public :: kinetic_energy, potential_energy, energy_scale, vertical_momentum, axial_momentum
    public :: euler_residuals, axis_tip, axis_height_rate
    public :: kovalevskaya_integral, goryachev_integral, angular_acceleration
    public :: support_force, specific_force, motion_scales_t, motion_scales

    !> Scales of a motion.
    type :: motion_scales_t
        !> Largest angular velocity, rad/s, and angular momentum, kg m^2/s; above zero.
        real(dp) :: rate = 1, momentum = 1
    end type motion_scales_t

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
        residual = body%momentum(motion%omega_rate) + cross(motion%omega, body%momentum(motion%omega)) &
                   + body%damping * motion%omega - body%torque(vertical_from_quaternion(motion%quaternion))
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
        type(loads_t), intent(out) :: loads
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

    !> Bounds from the energy, which does not increase. They are exact for an undamped symmetric top that
    !> reaches its lowest point, and an order of magnitude for other bodies. A body at rest has the scales of
    !> its small oscillation; without gravitational torque either, those of a rotation at 1 rad/s.
    pure type(motion_scales_t) function motion_scales(body, start) result(scales)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! any instant of the motion: attitude and angular velocity
        real(dp) :: pull, fall, energy, spin, across, middle, largest, moment(3)
        logical :: is_lagrange

        moment = body%weight_moment()
        is_lagrange = body%is_lagrange()
        if (is_lagrange) then
            pull = abs(moment(3))
        else
            pull = norm2(moment)
        end if
        fall = pull + dot_product(moment, vertical_from_quaternion(start%quaternion))
        associate (inertia => body%inertia, omega => start%omega)
            if (is_lagrange) then
                spin = omega(3)
                energy = sum(inertia(1:2) * omega(1:2)**2) / 2 + max(fall, 0.0_dp)
                across = sqrt(max(2 * energy, pull) / inertia(1))
                scales%rate = hypot(across, spin)
                scales%momentum = hypot(inertia(1) * across, inertia(3) * spin)
            else
                largest = maxval(inertia)
                middle = sum(inertia) - largest - minval(inertia)
                energy = sum(inertia * omega**2) / 2 + max(fall, 0.0_dp)
                scales%rate = max(norm2(omega), sqrt(max(2 * energy, pull) / middle))
                scales%momentum = sqrt(max(2 * energy, pull) * largest)
            end if
            if (.not. scales%rate > 0) then
                scales%rate = 1
                scales%momentum = maxval(inertia)
            end if
        end associate
    end function motion_scales

end module spintop_quantities
