!> The equations in Euler angles that the formulations of a symmetric top share.
module spintop_symmetric_top
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t, motion_from_angles
    use spintop_attitude, only: omega_rate_from_accelerations, quaternion_from_angles
    implicit none
    private
    public :: symmetric_top_t, energy_reset_t, at_pole

    !> Constants of the motion of a symmetric top, and functions of them and of the angles.
    type :: symmetric_top_t
        !> I1 (= I2) and I3 about the pivot, kg m^2.
        real(dp) :: i1 = 1, i3 = 1
        !> Spin rate about the axis, rad/s, constant.
        real(dp) :: omega3 = 0
        !> a = I3 omega3/I1, rad/s.
        real(dp) :: a = 0
        !> beta = 2 mgl/I1, 1/s^2.
        real(dp) :: beta = 0
        !> At the start: inclination, momentum I1 phi' sin^2 theta, and squared speed of the axis.
        real(dp) :: theta0 = 0, swing0 = 0, speed0 = 0
        !> Sign of the quaternion of the start, of the two of its attitude, against that of its angles.
        real(dp) :: sheet = 1
    contains
        procedure :: set
        procedure :: precession_rate
        procedure :: theta_acceleration
        procedure :: theta_stiffness
        procedure :: phi_acceleration
        procedure :: speed_budget
        procedure :: complete
    end type symmetric_top_t

    !> theta' = sign(theta') sqrt(max(0, radicand of Eq 46)) after each step, in the state of `lagrange_t`.
    type, extends(symmetric_top_t) :: energy_reset_t
    contains
        procedure :: apply
    end type energy_reset_t

contains

    !> Sets the constants from a body and its start.
    pure subroutine set(self, body, start)
        class(symmetric_top_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%i1 = body%inertia(1)
        self%i3 = body%inertia(3)
        self%omega3 = start%omega(3)
        self%a = self%i3 * self%omega3 / self%i1
        self%beta = 2 * body%mgl() / self%i1
        self%theta0 = start%angle(2)
        self%swing0 = self%i1 * start%rate(1) * sin(start%angle(2))**2
        self%speed0 = start%rate(2)**2 + (sin(start%angle(2)) * start%rate(1))**2
        self%sheet = sign(1.0_dp, dot_product(start%quaternion, quaternion_from_angles(start%angle)))
    end subroutine set

    !> phi' of Eq 41, rad/s: (c1 - I3 omega3 cos theta)/(I1 sin^2 theta). c1 is counted from the start, so
    !> that nothing cancels near the upright.
    pure real(dp) function precession_rate(self, theta)
        class(symmetric_top_t), intent(in) :: self
        real(dp), intent(in) :: theta !! inclination, rad
        precession_rate = (self%swing0 + self%i3 * self%omega3 * cosine_drop(theta, self%theta0)) &
                          / (self%i1 * sin(theta)**2)
    end function precession_rate

    !> theta'' of Eq 42, rad/s^2.
    pure real(dp) function theta_acceleration(self, theta, phi_rate)
        class(symmetric_top_t), intent(in) :: self
        real(dp), intent(in) :: theta, phi_rate !! inclination, rad; precession rate, rad/s
        theta_acceleration = sin(theta) &
                             * (phi_rate * (phi_rate * cos(theta) - self%a) + self%beta / 2)
    end function theta_acceleration

    !> Derivative of theta'' by theta along the curve of constant momenta, 1/s^2.
    pure real(dp) function theta_stiffness(self, theta, phi_rate)
        class(symmetric_top_t), intent(in) :: self
        real(dp), intent(in) :: theta, phi_rate !! inclination, rad; precession rate, rad/s
        theta_stiffness = cos(theta) * (phi_rate * (phi_rate * cos(theta) - self%a) + self%beta / 2) &
                          - (self%a - 2 * phi_rate * cos(theta))**2 - (phi_rate * sin(theta))**2
    end function theta_stiffness

    !> phi'', rad/s^2: the time derivative of Eq 41.
    pure real(dp) function phi_acceleration(self, theta, phi_rate, theta_rate)
        class(symmetric_top_t), intent(in) :: self
        real(dp), intent(in) :: theta, phi_rate, theta_rate !! inclination, rad; precession and nutation rate, rad/s
        phi_acceleration = theta_rate * (self%a - 2 * phi_rate * cos(theta)) / sin(theta)
    end function phi_acceleration

    !> theta'^2 at an inclination by conservation of energy (the radicand of Eq 46), rad^2/s^2, counted from
    !> the start; negative beyond a turning point.
    pure real(dp) function speed_budget(self, theta)
        class(symmetric_top_t), intent(in) :: self
        real(dp), intent(in) :: theta !! inclination, rad
        speed_budget = self%speed0 + self%beta * cosine_drop(theta, self%theta0) &
                       - (self%precession_rate(theta) * sin(theta))**2
    end function speed_budget

    !> Rounding of `speed_budget`, rad^2/s^2: that of its terms, and what the rounding of theta makes of it.
    pure real(dp) function budget_rounding(self, theta) result(rounding)
        class(symmetric_top_t), intent(in) :: self
        real(dp), intent(in) :: theta !! inclination, rad
        real(dp), parameter :: units = 4
        real(dp) :: phi_rate
        phi_rate = self%precession_rate(theta)
        rounding = units * epsilon_dp * (self%speed0 + (phi_rate * sin(theta))**2 &
                                         + abs(self%beta * cosine_drop(theta, self%theta0)) &
                                         + abs(2 * theta * self%theta_acceleration(theta, phi_rate)))
    end function budget_rounding

    !> A negative radicand is clipped. A theta' that has this energy to rounding stays: near a turning point
    !> the root knows it to half of the digits only.
    pure subroutine apply(self, y, clipped)
        class(energy_reset_t), intent(in) :: self
        real(dp), intent(inout) :: y(:) !! state (phi, theta, theta', psi)
        logical, intent(out) :: clipped !! whether the radicand was negative
        real(dp) :: radicand
        radicand = self%speed_budget(y(2))
        clipped = .false.
        if (abs(radicand - y(3)**2) <= budget_rounding(self, y(2))) return
        y(3) = sign(sqrt(max(0.0_dp, radicand)), y(3))
        clipped = radicand < 0
    end subroutine apply

    !> The motion for given angles and rates, with the second derivatives of phi and theta.
    pure type(motion_t) function complete(self, t, angle, rate, phi_acceleration, &
                                          theta_acceleration) result(motion)
        class(symmetric_top_t), intent(in) :: self
        real(dp), intent(in) :: t, angle(3), rate(3), phi_acceleration, theta_acceleration !! s; rad; rad/s; rad/s^2
        motion = motion_from_angles(t, angle, rate)
        motion%quaternion = self%sheet * motion%quaternion
        motion%omega(3) = self%omega3
        motion%omega_rate = omega_rate_from_accelerations(angle, rate, phi_acceleration, &
                                                          theta_acceleration, 0.0_dp)
    end function complete

    !> cos(theta0) - cos(theta), without cancellation.
    pure real(dp) function cosine_drop(theta, theta0)
        real(dp), intent(in) :: theta, theta0
        cosine_drop = 2 * sin((theta + theta0) / 2) * sin((theta - theta0) / 2)
    end function cosine_drop

    !> Whether sin(theta) is zero to the rounding of an angle.
    pure logical function at_pole(theta)
        real(dp), intent(in) :: theta !! inclination, rad
        at_pole = abs(sin(theta)) <= epsilon_dp
    end function at_pole

end module spintop_symmetric_top
