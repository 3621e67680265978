!> The paper's equations of a symmetric top in Euler angles: those of Euler in five variables (Provatidis 2012, Eqs 35-40), those
!> of Lagrange in four (Eqs 41-45), which may have theta' reset from the energy after each step (scenario 2), and the energy-rate
!> equations in three, with theta' from the energy (scenario 1, Eq 46).
!>
!> The last ones hold between two turning points of theta. At a turning point theta' = 0 is an equilibrium of the equation, though
!> not of the top. A motion leaves a start there by a Taylor series, and ends with a status at the next one.
module spintop_euler_angles
    use spintop_attitude, only: omega_rate_from_accelerations, quaternion_from_angles
    use spintop_body, only: body_t
    use spintop_compare, only: is_zero
    use spintop_formulation, only: formulation_info_t, formulation_t, max_invariants, max_states
    use spintop_kinds, only: dp, epsilon_dp, pi
    use spintop_motion, only: motion_from_angles, motion_t
    use spintop_quantities, only: motion_scales, motion_scales_t
    use spintop_status, only: is_ok, status_ok, status_outside, status_pole
    implicit none
    private
    public :: euler_t, lagrange_t, energy_rate_t

    !> Constants of the motion of a symmetric top, and functions of them and of the angles.
    type, abstract, extends(formulation_t) :: euler_angles_t
        !> Spin rate about the axis, rad/s, constant; a = I3 omega3/I1, rad/s; beta = 2 mgl/I1, 1/s^2.
        real(dp) :: omega3 = 0, a = 0, beta = 0
        !> At the start: inclination, precession phi' sin^2 theta, and squared speed of the axis.
        real(dp) :: theta0 = 0, swing0 = 0, speed0 = 0
        !> Sign of the quaternion of the start, of the two of its attitude, against that of its angles.
        real(dp) :: sheet = 1
    contains
        procedure :: set_constants
        procedure :: precession_rate
        procedure :: theta_acceleration
        procedure :: theta_stiffness
        procedure :: phi_acceleration
        procedure :: speed_budget
        procedure :: complete
    end type euler_angles_t

    !> State y = (phi, phi', theta, theta', psi); omega3 is constant.
    type, extends(euler_angles_t) :: euler_t
    contains
        procedure :: info => info_of_euler
        procedure :: prepare => prepare_euler
        procedure :: derivative => derivative_of_euler
        procedure :: motion => motion_of_euler
        procedure :: invariants => invariants_of_euler
    end type euler_t

    !> State y = (phi, theta, theta', psi); both momenta are constants. After a step theta is kept, and theta' may be reset.
    type, extends(euler_angles_t) :: lagrange_t
    contains
        procedure :: info => info_of_lagrange
        procedure :: prepare => prepare_lagrange
        procedure :: derivative => derivative_of_lagrange
        procedure :: motion => motion_of_lagrange
        procedure :: invariants => invariants_of_lagrange
        procedure :: reset_speed
    end type lagrange_t

    !> State y = (phi, theta, psi).
    type, extends(euler_angles_t) :: energy_rate_t
        !> Sign of theta'; 0 for steady precession.
        real(dp) :: direction = 1
        !> Whether the start is a turning point.
        logical :: starts_at_rest = .false.
        !> Inclination amid the two poles between which the motion is, rad.
        real(dp) :: middle = pi / 2
    contains
        procedure :: info => info_of_energy_rate
        procedure :: prepare => prepare_of_energy_rate
        procedure :: derivative => derivative_of_energy_rate
        procedure :: motion => motion_of_energy_rate
        procedure :: time_left
        procedure :: depart
        procedure :: arrive
    end type energy_rate_t

contains

    !> Sets the constants from a body and its start.
    pure subroutine set_constants(self, body, start)
        class(euler_angles_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%body = body
        self%omega3 = start%omega(3)
        self%a = body%inertia(3) * self%omega3 / body%inertia(1)
        self%beta = 2 * body%mgl() / body%inertia(1)
        self%theta0 = start%angle(2)
        self%swing0 = body%inertia(1) * start%rate(1) * sin(start%angle(2))**2
        self%speed0 = start%rate(2)**2 + (sin(start%angle(2)) * start%rate(1))**2
        self%sheet = sign(1.0_dp, dot_product(start%quaternion, quaternion_from_angles(start%angle)))
    end subroutine set_constants

    !> phi' of Eq 41, rad/s: (c1 - I3 omega3 cos theta)/(I1 sin^2 theta). c1 is counted from the start, so
    !> that nothing cancels near the upright.
    pure real(dp) function precession_rate(self, theta)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: theta !! inclination, rad
        precession_rate = (self%swing0 + self%body%inertia(3) * self%omega3 * cosine_drop(theta, self%theta0)) &
                          / (self%body%inertia(1) * sin(theta)**2)
    end function precession_rate

    !> theta'' of Eq 42, rad/s^2.
    pure real(dp) function theta_acceleration(self, theta, phi_rate)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: theta, phi_rate !! inclination, rad; precession rate, rad/s
        theta_acceleration = sin(theta) &
                             * (phi_rate * (phi_rate * cos(theta) - self%a) + self%beta / 2)
    end function theta_acceleration

    !> Derivative of theta'' by theta along the curve of constant momenta, 1/s^2.
    pure real(dp) function theta_stiffness(self, theta, phi_rate)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: theta, phi_rate !! inclination, rad; precession rate, rad/s
        theta_stiffness = cos(theta) * (phi_rate * (phi_rate * cos(theta) - self%a) + self%beta / 2) &
                          - (self%a - 2 * phi_rate * cos(theta))**2 - (phi_rate * sin(theta))**2
    end function theta_stiffness

    !> phi'', rad/s^2: the time derivative of Eq 41.
    pure real(dp) function phi_acceleration(self, theta, phi_rate, theta_rate)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: theta, phi_rate, theta_rate !! inclination, rad; precession and nutation rate, rad/s
        phi_acceleration = theta_rate * (self%a - 2 * phi_rate * cos(theta)) / sin(theta)
    end function phi_acceleration

    !> theta'^2 at an inclination by conservation of energy (the radicand of Eq 46), rad^2/s^2, counted from
    !> the start; negative beyond a turning point.
    pure real(dp) function speed_budget(self, theta)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: theta !! inclination, rad
        speed_budget = self%speed0 + self%beta * cosine_drop(theta, self%theta0) &
                       - (self%precession_rate(theta) * sin(theta))**2
    end function speed_budget

    !> The motion for given angles and rates, with the second derivatives of phi and theta.
    pure type(motion_t) function complete(self, t, angle, rate, phi_acceleration, &
                                          theta_acceleration) result(motion)
        class(euler_angles_t), intent(in) :: self
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

    !> Name and properties.
    pure function info_of_euler(self) result(info)
        class(euler_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('euler', &
            "Euler's equations, (phi, phi', theta, theta', psi) by a 2x2 system (Eqs 35-40)", 5, &
            invariants=2)
    end function info_of_euler

    !> Constants of the motion and initial state.
    pure subroutine prepare_euler(self, body, start, y, status)
        class(euler_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        call self%set_constants(body, start)
        y = 0
        y(1:5) = [start%angle(1), start%rate(1), start%angle(2), start%rate(2), start%angle(3)]
        scales = motion_scales(body, start)
        self%scale(1:5) = [1.0_dp, scales%rate, 1.0_dp, scales%rate, 1.0_dp]
        self%cyclic([1, 5]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare_euler

    !> Solves the first two of Euler's equations for phi'' and theta'' (Eqs 36-40).
    pure subroutine derivative_of_euler(self, t, y, dy, status)
        class(euler_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: s3, c3, s5, c5, psi_rate, mgl, a(2, 2), b(2), determinant

        dy = 0
        status = status_pole
        if (at_pole(y(3))) return
        s3 = sin(y(3))
        c3 = cos(y(3))
        s5 = sin(y(5))
        c5 = cos(y(5))
        mgl = self%body%mgl()
        psi_rate = self%omega3 - y(2) * c3
        ! Divided by I1 and by I2: products of moments of inertia might underflow.
        associate (i1 => self%body%inertia(1), i2 => self%body%inertia(2), &
                   i3 => self%body%inertia(3), w3 => self%omega3)
            a(1, :) = [s5 * s3, c5]
            a(2, :) = [c5 * s3, -s5]
            b(1) = mgl / i1 * s3 * c5 &
                   - (c5 * s3 * y(2) * psi_rate + s5 * c3 * y(2) * y(4) - s5 * y(4) * psi_rate) &
                   - w3 * ((i3 - i2) / i1) * (c5 * s3 * y(2) - s5 * y(4))
            b(2) = -mgl / i2 * s3 * s5 &
                   - (c5 * c3 * y(2) * y(4) - s5 * s3 * y(2) * psi_rate - c5 * y(4) * psi_rate) &
                   + w3 * ((i3 - i1) / i2) * (s5 * s3 * y(2) + c5 * y(4))
        end associate
        determinant = a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)
        dy(1) = y(2)
        dy(2) = (b(1) * a(2, 2) - b(2) * a(1, 2)) / determinant
        dy(3) = y(4)
        dy(4) = (a(1, 1) * b(2) - a(2, 1) * b(1)) / determinant
        dy(5) = psi_rate
        status = status_ok
    end subroutine derivative_of_euler

    !> The motion, with phi'' and theta'' of the 2x2 system.
    pure type(motion_t) function motion_of_euler(self, t, y, near) result(motion)
        class(euler_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        call self%derivative(t, y, dy, status)
        motion = self%complete(t, [y(1), y(3), y(5)], [y(2), y(4), dy(5)], dy(2), dy(4))
    end function motion_of_euler

    !> Twice the energy over I1, and the momentum about the vertical over I1, without the part of the spin.
    pure subroutine invariants_of_euler(self, y, values)
        class(euler_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        values = 0
        values(1) = y(4)**2 + (sin(y(3)) * y(2))**2 + self%beta * cos(y(3))
        values(2) = y(2) * sin(y(3))**2 + self%a * cos(y(3))
    end subroutine invariants_of_euler

    !> Name and properties.
    pure function info_of_lagrange(self) result(info)
        class(lagrange_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('lagrange', &
            "Lagrange's equations, (phi, theta, theta', psi) with both momenta constant (Eqs 41-45)", &
            4, invariants=1)
        if (self%resets_speed) info = formulation_info_t('lagrange_energy', &
            "lagrange, with theta' reset from the energy after each step (Eq 46, scenario 2)", 4, resets_speed=.true.)
    end function info_of_lagrange

    !> Constants of the motion and initial state.
    pure subroutine prepare_lagrange(self, body, start, y, status)
        class(lagrange_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        call self%set_constants(body, start)
        y = 0
        y(1:4) = [start%angle(1), start%angle(2), start%rate(2), start%angle(3)]
        scales = motion_scales(body, start)
        self%scale(3) = scales%rate
        self%cyclic([1, 4]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare_lagrange

    !> Eqs 41, 42 and 44.
    pure subroutine derivative_of_lagrange(self, t, y, dy, status)
        class(lagrange_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        dy = 0
        status = status_pole
        if (at_pole(y(2))) return
        dy(1) = self%precession_rate(y(2))
        dy(2) = y(3)
        dy(3) = self%theta_acceleration(y(2), dy(1))
        dy(4) = self%omega3 - dy(1) * cos(y(2))
        status = status_ok
    end subroutine derivative_of_lagrange

    !> The motion, with theta'' of Eq 42 and phi'' from Eq 41.
    pure type(motion_t) function motion_of_lagrange(self, t, y, near) result(motion)
        class(lagrange_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        call self%derivative(t, y, dy, status)
        motion = self%complete(t, [y(1), y(2), y(4)], [dy(1), dy(2), dy(4)], &
                                   self%phi_acceleration(y(2), dy(1), dy(2)), dy(3))
    end function motion_of_lagrange

    !> Twice the energy over I1, without the part of the spin.
    pure subroutine invariants_of_lagrange(self, y, values)
        class(lagrange_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        values = 0
        values(1) = y(3)**2 + (sin(y(2)) * self%precession_rate(y(2)))**2 + self%beta * cos(y(2))
    end subroutine invariants_of_lagrange

    !> A negative radicand is clipped. A theta' that has this energy to rounding stays: near a turning point
    !> the root knows it to half of the digits only.
    pure subroutine reset_speed(self, y, clipped)
        class(lagrange_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states) !! state (phi, theta, theta', psi)
        logical, intent(out) :: clipped !! whether the radicand was negative
        real(dp) :: radicand
        radicand = self%speed_budget(y(2))
        clipped = .false.
        if (abs(radicand - y(3)**2) <= budget_rounding(self, y(2))) return
        y(3) = sign(sqrt(max(0.0_dp, radicand)), y(3))
        clipped = radicand < 0
    end subroutine reset_speed

    !> Rounding of `speed_budget`, rad^2/s^2: that of its terms, and what the rounding of theta makes of it.
    pure real(dp) function budget_rounding(self, theta) result(rounding)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: theta !! inclination, rad
        real(dp), parameter :: units = 4
        real(dp) :: phi_rate
        phi_rate = self%precession_rate(theta)
        rounding = units * epsilon_dp * (self%speed0 + (phi_rate * sin(theta))**2 &
                                         + abs(self%beta * cosine_drop(theta, self%theta0)) &
                                         + abs(2 * theta * self%theta_acceleration(theta, phi_rate)))
    end function budget_rounding

    !> Name and properties.
    pure function info_of_energy_rate(self) result(info)
        class(energy_rate_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('energy_rate', &
            "(phi, theta, psi) with theta' from the energy, to the next turning point (Eq 46, scenario 1)", 3)
    end function info_of_energy_rate

    !> Constants of the motion, the branch that the start lies on, and the initial state.
    pure subroutine prepare_of_energy_rate(self, body, start, y, status)
        class(energy_rate_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        !> Rounding error of theta'', relative to the spacing of its terms.
        real(dp), parameter :: rounding = 16
        real(dp) :: pull, terms

        call self%set_constants(body, start)
        self%middle = pi * (anint(start%angle(2) / pi - 0.5_dp) + 0.5_dp)
        pull = start%rate(2)
        self%starts_at_rest = is_zero(pull)
        if (self%starts_at_rest) then
            pull = self%theta_acceleration(start%angle(2), start%rate(1))
            terms = abs(start%rate(1)) * (abs(start%rate(1)) + abs(self%a)) + self%beta / 2
            terms = terms * abs(sin(start%angle(2)))
            if (abs(pull) <= rounding * epsilon_dp * terms) pull = 0
        end if
        self%direction = sign(1.0_dp, pull)
        if (is_zero(pull)) self%direction = 0
        y = 0
        y(1:3) = start%angle
        self%cyclic([1, 3]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare_of_energy_rate

    !> Eqs 41, 46 and 44; outside where the radicand of Eq 46 is negative, and beyond a pole, which only a step
    !> over the turning point before it comes to.
    pure subroutine derivative_of_energy_rate(self, t, y, dy, status)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! its rate
        integer, intent(out) :: status !! `status_ok`, or why there is none (spintop_status)
        real(dp) :: radicand

        dy = 0
        status = status_pole
        if (at_pole(y(2))) return
        radicand = merge(0.0_dp, self%speed_budget(y(2)), is_zero(self%direction))
        status = status_outside
        if (radicand < 0 .or. abs(y(2) - self%middle) > pi / 2) return
        dy(1) = self%precession_rate(y(2))
        dy(2) = self%direction * sqrt(radicand)
        dy(3) = self%omega3 - dy(1) * cos(y(2))
        status = status_ok
    end subroutine derivative_of_energy_rate

    !> The motion, with theta'' of Eq 42 (half the derivative of the radicand by theta).
    pure type(motion_t) function motion_of_energy_rate(self, t, y, near) result(motion)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        call self%derivative(t, y, dy, status)
        if (status == status_outside) dy = at_turning_point(self, y)
        motion = self%complete(t, y(1:3), dy(1:3), self%phi_acceleration(y(2), dy(1), dy(2)), &
                               self%theta_acceleration(y(2), dy(1)))
    end function motion_of_energy_rate

    !> The rates where theta' = 0.
    pure function at_turning_point(self, y) result(dy)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp) :: dy(max_states)
        dy = 0
        dy(1) = self%precession_rate(y(2))
        dy(3) = self%omega3 - dy(1) * cos(y(2))
    end function at_turning_point

    !> Estimate -theta'/theta'' of the time to the next turning point while theta slows down, s, where the equations end; its
    !> error goes with its cube. `huge` where they do not end.
    pure real(dp) function time_left(self, y)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp) :: dy(max_states), acceleration
        integer :: status
        time_left = huge(1.0_dp)
        if (is_zero(self%direction)) return
        call self%derivative(0.0_dp, y, dy, status)
        if (status == status_outside) time_left = 0
        if (.not. is_ok(status)) return
        acceleration = self%direction * self%theta_acceleration(y(2), dy(1))
        if (acceleration < 0) time_left = abs(dy(2)) / (-acceleration)
    end function time_left

    !> Leaves a start at a turning point, where the right-hand side alone would stay for ever: theta = theta0 + theta'' h^2/2,
    !> with phi and psi to the next order.
    pure subroutine depart(self, y, h, departed)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states), h
            !! state, and time of the departure, s; 0 on entry: chosen by this procedure
        logical, intent(out) :: departed !! whether the state is one after a departure
        !> Time of a departure without a given h, relative to the fastest time scale.
        real(dp), parameter :: share = 1.0e-3_dp
        real(dp) :: dy(max_states)

        departed = self%starts_at_rest .and. .not. is_zero(self%direction)
        if (.not. departed) return
        dy = at_turning_point(self, y)
        if (is_zero(h)) h = share / sqrt(self%beta + self%a**2 + dy(1)**2)
        call leave_turning_point(self, dy, h, y)
    end subroutine depart

    !> Goes to the turning point: the angle by Newton's method for the radicand, the time to it with the next
    !> term of the series.
    pure subroutine arrive(self, y, left)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states) !! state, then that at the turning point
        real(dp), intent(out) :: left !! time to it, s
        integer, parameter :: newton_steps = 3
        real(dp) :: dy(max_states), back(max_states), turning
        integer :: i

        left = self%time_left(y)
        turning = y(2)
        do i = 1, newton_steps
            turning = turning - self%speed_budget(turning) &
                / (2 * self%theta_acceleration(turning, self%precession_rate(turning)))
        end do
        back = y
        back(2) = turning
        dy = at_turning_point(self, back)
        left = left * (1 - self%theta_stiffness(turning, dy(1)) * left**2 / 3)
        call leave_turning_point(self, dy, -left, back)
        y(1) = y(1) + (y(1) - back(1))
        y(2) = turning
        y(3) = y(3) + (y(3) - back(3))
    end subroutine arrive

    !> Moves a state at a turning point, where the rates are `dy`, by a short time h.
    pure subroutine leave_turning_point(self, dy, h, y)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: dy(max_states), h
        real(dp), intent(inout) :: y(max_states)
        real(dp) :: rise, bend
        rise = self%theta_acceleration(y(2), dy(1)) * h**2 / 2
        bend = self%phi_acceleration(y(2), dy(1), rise * h / 3)
        y(1) = y(1) + h * dy(1) + bend
        y(3) = y(3) + h * dy(3) - bend * cos(y(2)) + dy(1) * sin(y(2)) * rise * h / 3
        y(2) = y(2) + rise
    end subroutine leave_turning_point

end module spintop_euler_angles
