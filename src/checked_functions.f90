!> Functions of the public interface that return no status. They check their arguments, and return NaN for a
!> body, a motion or a number that is not valid. Loops inside the library call the unchecked functions of the
!> same names.
module spintop_checked_functions
    use spintop_kinds, only: dp, no_number, is_finite
    use spintop_body, only: body_t
    use spintop_euler_poisson, only: unchecked_state => euler_poisson_state
    use spintop_motion, only: motion_t
    use spintop_quantities, only: unchecked_kinetic => kinetic_energy, &
        unchecked_potential => potential_energy, unchecked_vertical => vertical_momentum, &
        unchecked_axial => axial_momentum, unchecked_residuals => euler_residuals, unchecked_tip => axis_tip, &
        unchecked_height_rate => axis_height_rate, unchecked_force => support_force
    use spintop_steady_motion, only: unchecked_critical => critical_omega3, fast_top_t, &
        unchecked_fast_top => fast_top
    use spintop_status, only: is_ok
    use spintop_validity, only: body_status, motion_status
    implicit none
    private
    public :: kinetic_energy, potential_energy, vertical_momentum, axial_momentum, euler_residuals, support_force
    public :: axis_tip, axis_height_rate, euler_poisson_state, critical_omega3, fast_top

contains

    !> Kinetic energy, J.
    pure real(dp) function kinetic_energy(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        kinetic_energy = unchecked_kinetic(body, checked(motion, body))
    end function kinetic_energy

    !> Potential energy above the height of the pivot, J.
    pure real(dp) function potential_energy(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        potential_energy = unchecked_potential(body, checked(motion, body))
    end function potential_energy

    !> Angular momentum about the vertical, kg m^2/s ("c1" of Eq 41).
    pure real(dp) function vertical_momentum(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        vertical_momentum = unchecked_vertical(body, checked(motion, body))
    end function vertical_momentum

    !> Angular momentum about body z, kg m^2/s.
    pure real(dp) function axial_momentum(body, motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        axial_momentum = unchecked_axial(body, checked(motion, body))
    end function axial_momentum

    !> Residual of Euler's equations, I omega' + omega x I omega - torque, N m. The first two components are
    !> R1 and R2 of Eq 51.
    pure function euler_residuals(body, motion) result(residual)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude, angular velocity and acceleration at an instant
        real(dp) :: residual(3)
        residual = unchecked_residuals(body, checked(motion, body))
    end function euler_residuals

    !> Support force on the body in space axes, N (Eqs 47-50 for any rigid body).
    pure function support_force(body, motion) result(force)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude, angular velocity and acceleration at an instant
        real(dp) :: force(3)
        force = unchecked_force(body, checked(motion, body))
    end function support_force

    !> Tip of the axis in space axes: the unit vector from the pivot to the centre of mass, or
    !> along body z where both coincide.
    pure function axis_tip(body, motion) result(tip)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: tip(3)
        tip = unchecked_tip(body, checked(motion, body))
    end function axis_tip

    !> Rate of the height of body z, cos(theta), 1/s: zero at the turning points of theta.
    pure real(dp) function axis_height_rate(motion) result(rate)
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        rate = unchecked_height_rate(checked(motion))
    end function axis_height_rate

    !> The state (Gamma, Pi) of a motion: upward vertical and angular momentum, kg m^2/s, in body axes.
    pure function euler_poisson_state(body, motion) result(x)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: x(6)
        x = unchecked_state(body, checked(motion, body))
    end function euler_poisson_state

    !> Threshold spin omega3 of the sleeping top, above which it is stable, rad/s: sqrt(4 mgl I1)/I3. NaN also for a
    !> body that is not an undamped symmetric top with its centre of mass on or above the pivot.
    pure real(dp) function critical_omega3(body)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        critical_omega3 = no_number
        if (is_top(body)) critical_omega3 = unchecked_critical(body)
    end function critical_omega3

    !> The paper's formulas for a fast top that is released at rest at inclination `theta`, rad, with
    !> axial angular velocity `omega3`, rad/s. NaN also for a body that is not an undamped symmetric top;
    !> infinite where a divisor vanishes.
    elemental type(fast_top_t) function fast_top(body, theta, omega3) result(motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: theta, omega3 !! inclination at the start, rad; axial angular velocity, rad/s
        motion = fast_top_t(no_number, no_number, no_number, no_number, no_number, no_number, no_number)
        if (is_top(body) .and. is_finite(theta + omega3)) motion = unchecked_fast_top(body, theta, omega3)
    end function fast_top

    !> The motion, its quaternion scaled to unit norm. NaN if it, or the body, is not valid: so is then what is computed of it.
    pure type(motion_t) function checked(motion, body)
        type(motion_t), intent(in) :: motion
        type(body_t), intent(in), optional :: body
        integer :: status
        status = motion_status(motion, body)
        if (present(body)) status = max(status, body_status(body))
        checked = motion
        checked%quaternion = motion%quaternion / norm2(motion%quaternion)
        if (is_ok(status)) return
        checked%quaternion = no_number
        checked%omega = no_number
    end function checked

    !> Whether a body is an undamped symmetric top.
    pure logical function is_top(body)
        type(body_t), intent(in) :: body
        is_top = is_ok(body_status(body))
        if (is_top) is_top = body%is_lagrange() .and. body%inertia(1) > 0
    end function is_top

end module spintop_checked_functions
