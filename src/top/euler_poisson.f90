!> The Euler-Poisson equations of any heavy body, damped or not, and their linearisation.
!>
!> The state x = (Gamma, Pi) contains the upward vertical and the angular momentum in body axes: Gamma' =
!> Gamma x omega, Pi' = Pi x omega + m g Gamma x r - d omega, omega = Pi/I. It omits only the azimuth, on
!> which nothing depends.
module spintop_euler_poisson
    use spintop_kinds, only: dp, cross, skew
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: euler_poisson_state, euler_poisson_rate, euler_poisson_matrix, momentum_coupling
    public :: invariant_gradients, turning_about, state_units

contains

    !> The state (Gamma, Pi) of a motion.
    pure function euler_poisson_state(body, motion) result(x)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: motion !! attitude and velocity at an instant
        real(dp) :: x(6)
        x(1:3) = vertical_from_quaternion(motion%quaternion / norm2(motion%quaternion))
        x(4:6) = body%inertia * motion%omega
    end function euler_poisson_state

    !> The right-hand side x' = f(x).
    pure function euler_poisson_rate(body, x) result(rate)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: x(6) !! state (Gamma, Pi): vertical, and angular momentum in kg m^2/s
        real(dp) :: rate(6)
        associate (omega => x(4:6) / body%inertia)
            rate(1:3) = cross(x(1:3), omega)
            rate(4:6) = cross(x(4:6), omega) + body%torque(x(1:3)) - body%damping * omega
        end associate
    end function euler_poisson_rate

    !> What couples the momenta in Pi x omega: 1/I3 - 1/I2 and cyclic, so that Pi1' = coupling_1 Pi2 Pi3 without
    !> torques; exactly zero for equal moments, so that a symmetric body keeps its momentum about the axis to
    !> the last digit.
    pure function momentum_coupling(body) result(coupling)
        type(body_t), intent(in) :: body !! inertia about its principal axes
        real(dp) :: coupling(3)
        associate (inertia => body%inertia)
            coupling(1) = (inertia(2) - inertia(3)) / inertia(2) / inertia(3)
            coupling(2) = (inertia(3) - inertia(1)) / inertia(3) / inertia(1)
            coupling(3) = (inertia(1) - inertia(2)) / inertia(1) / inertia(2)
        end associate
    end function momentum_coupling

    !> The matrix df/dx of the linearised equations.
    pure function euler_poisson_matrix(body, x) result(matrix)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: x(6) !! state (Gamma, Pi): vertical, and angular momentum in kg m^2/s
        real(dp) :: matrix(6, 6)
        integer :: i
        matrix(1:3, 1:3) = -skew(x(4:6) / body%inertia)
        matrix(4:6, 1:3) = -skew(body%weight_moment())
        matrix(1:3, 4:6) = skew(x(1:3))
        matrix(4:6, 4:6) = skew(x(4:6))
        do i = 1, 3
            matrix(3 + i, 3 + i) = matrix(3 + i, 3 + i) - body%damping(i)
            matrix(:, 3 + i) = matrix(:, 3 + i) / body%inertia(i)
        end do
        matrix(4:6, 4:6) = matrix(4:6, 4:6) + matrix(1:3, 1:3)
    end function euler_poisson_matrix

    !> Gradients of the possible invariants: |Gamma|^2/2, Pi . Gamma, the energy, and the momentum about the
    !> symmetry axis (zero if there is none).
    pure function invariant_gradients(body, x) result(gradients)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: x(6) !! state (Gamma, Pi): vertical, and angular momentum in kg m^2/s
        real(dp) :: gradients(6, 4)
        gradients = 0
        gradients(1:3, 1) = x(1:3)
        gradients(:, 2) = [x(4:6), x(1:3)]
        gradients(:, 3) = [body%weight_moment(), x(4:6) / body%inertia]
        gradients(4:6, 4) = body%symmetry_axis()
    end function invariant_gradients

    !> Rate of a state under a rotation about a body axis by 1 rad/s.
    pure function turning_about(axis, x) result(rate)
        real(dp), intent(in) :: axis(3), x(6) !! unit vector in body axes, and state (Gamma, Pi)
        real(dp) :: rate(6)
        rate = [cross(axis, x(1:3)), cross(axis, x(4:6))]
    end function turning_about

    !> Scales by which the components of a state are compared: 1 for the vertical; for the momentum, J s, that
    !> of the state or of the pendulum motion of the body.
    pure function state_units(body, x) result(unit)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: x(6) !! state (Gamma, Pi): vertical, and angular momentum in kg m^2/s
        real(dp) :: unit(6)
        unit(1:3) = 1
        unit(4:6) = max(norm2(x(4:6)), sqrt(norm2(body%weight_moment())) * sqrt(maxval(body%inertia)))
        if (.not. unit(4) > 0) unit = 1
    end function state_units

end module spintop_euler_poisson
