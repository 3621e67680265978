!> The paper's equations of a symmetric top in Euler angles: those of Euler in five variables (Provatidis 2012, Eqs 35-40), those
!> of Lagrange in four (Eqs 41-45), which may have theta' reset from the energy after each step (scenario 2), and the energy-rate
!> equations in three, with theta' from the energy (scenario 1, Eq 46).
!>
!> The last ones hold between two turning points of theta. At a turning point theta' = 0 is an equilibrium of the equation, though
!> not of the top. A motion leaves a start there by a Taylor series, and ends with a status at the next one.
module spintop_euler_angles
    use spintop_attitude, only: omega_rate_from_accelerations, quaternion_from_angles
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, pi, epsilon_dp, is_zero
    use spintop_formulation, only: formulation_info_t, formulation_t, max_invariants, max_states
    use spintop_motion, only: motion_from_angles, motion_t
    use spintop_quantities, only: motion_scales, motion_scales_t
    use spintop_status, only: is_ok, status_ok, status_outside, status_pole
    implicit none
    private
    public :: euler_angles_t, of_euler, of_lagrange, of_lagrange_energy, of_energy_rate

    !> Euler's equations of a state y = (phi, phi', theta, theta', psi); those of Lagrange, y = (phi, theta, theta', psi), with both
    !> momenta constant, also with theta' reset after each step; the energy-rate equations, y = (phi, theta, psi).
    integer, parameter :: of_euler = 1, of_lagrange = 2, of_lagrange_energy = 3, of_energy_rate = 4
    !> Index in the state of phi, phi', theta, theta', psi; 0 if it has none.
    integer, parameter :: places(5, of_euler:of_energy_rate) = &
        reshape([1, 2, 3, 4, 5, 1, 0, 2, 3, 4, 1, 0, 2, 3, 4, 1, 0, 2, 0, 3], [5, 4])

    !> Constants of the motion of a symmetric top.
    type, extends(formulation_t) :: euler_angles_t
        !> Which equations.
        integer :: kind = of_euler
        !> Spin rate about the axis, rad/s, constant; a = I3 omega3/I1, rad/s; beta = 2 mgl/I1, 1/s^2.
        real(dp) :: omega3 = 0, a = 0, beta = 0
        !> At the start: inclination, precession phi' sin^2 theta, and squared speed of the axis.
        real(dp) :: theta0 = 0, swing0 = 0, speed0 = 0
        !> Sign of the quaternion of the start, of the two of its attitude, against that of its angles.
        real(dp) :: sheet = 1
        !> Of the energy-rate equations: sign of theta', 0 for steady precession; whether the start is a turning point; the
        !> inclination amid the two poles between which the motion is, rad.
        real(dp) :: direction = 1
        logical :: starts_at_rest = .false.
        real(dp) :: middle = pi / 2
    contains
        procedure :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: invariants
        procedure :: reset_speed
        procedure :: time_left
        procedure :: depart
        procedure :: arrive
    end type euler_angles_t

contains

    !> Name and properties.
    pure function info(self)
        class(euler_angles_t), intent(in) :: self
        type(formulation_info_t) :: info
        select case (self%kind)
        case (of_euler)
            info = formulation_info_t('euler', &
                "Euler's equations, (phi, phi', theta, theta', psi) by a 2x2 system (Eqs 35-40)", 5, invariants=2)
        case (of_lagrange)
            info = formulation_info_t('lagrange', &
                "Lagrange's equations, (phi, theta, theta', psi) with both momenta constant (Eqs 41-45)", 4, invariants=1)
        case (of_lagrange_energy)
            info = formulation_info_t('lagrange_energy', &
                "lagrange, with theta' reset from the energy after each step (Eq 46, scenario 2)", 4, resets_speed=.true.)
        case (of_energy_rate)
            info = formulation_info_t('energy_rate', &
                "(phi, theta, psi) with theta' from the energy, to the next turning point (Eq 46, scenario 1)", 3)
        end select
    end function info

    !> Constants of the motion, and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(euler_angles_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        real(dp) :: values(5), scale(5)
        self%body = body
        self%omega3 = start%omega(3)
        self%a = body%inertia(3) * self%omega3 / body%inertia(1)
        self%beta = 2 * body%mgl() / body%inertia(1)
        self%theta0 = start%angle(2)
        self%swing0 = body%inertia(1) * start%rate(1) * sin(start%angle(2))**2
        self%speed0 = start%rate(2)**2 + (sin(start%angle(2)) * start%rate(1))**2
        self%sheet = sign(1.0_dp, dot_product(start%quaternion, quaternion_from_angles(start%angle)))
        if (self%has_ends) call choose_branch(self, start)
        scales = motion_scales(body, start)
        values = [start%angle(1), start%rate(1), start%angle(2), start%rate(2), start%angle(3)]
        scale = [1.0_dp, scales%rate, 1.0_dp, scales%rate, 1.0_dp]
        y = 0
        associate (place => places(:, self%kind))
            y(pack(place, place > 0)) = pack(values, place > 0)
            self%scale(pack(place, place > 0)) = pack(scale, place > 0)
            self%cyclic(place([1, 5])) = .true.
        end associate
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare

    !> The branch of the energy-rate equations that a start lies on.
    pure subroutine choose_branch(self, start)
        class(euler_angles_t), intent(inout) :: self
        type(motion_t), intent(in) :: start
        !> Rounding error of theta'', relative to the spacing of its terms.
        real(dp), parameter :: rounding = 16
        real(dp) :: pull, terms

        self%middle = pi * (anint(start%angle(2) / pi - 0.5_dp) + 0.5_dp)
        pull = start%rate(2)
        self%starts_at_rest = is_zero(pull)
        if (self%starts_at_rest) then
            pull = theta_acceleration(self, start%angle(2), start%rate(1))
            terms = abs(start%rate(1)) * (abs(start%rate(1)) + abs(self%a)) + self%beta / 2
            terms = terms * abs(sin(start%angle(2)))
            if (abs(pull) <= rounding * epsilon_dp * terms) pull = 0
        end if
        self%direction = sign(1.0_dp, pull)
        if (is_zero(pull)) self%direction = 0
    end subroutine choose_branch

    !> y': Euler's equations, or Eqs 41, 42 or 46, and 44. The energy-rate equations are outside where the radicand of Eq 46 is
    !> negative, and beyond a pole, which only a step over the turning point before it comes to.
    pure subroutine derivative(self, t, y, dy, status)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or why there is none (spintop_status)
        real(dp) :: radicand

        dy = 0
        status = status_pole
        if (at_pole(y(places(3, self%kind)))) return
        select case (self%kind)
        case (of_euler)
            call solve_euler(self, y, dy)
        case (of_energy_rate)
            radicand = merge(0.0_dp, speed_budget(self, y(2)), is_zero(self%direction))
            status = status_outside
            if (radicand < 0 .or. abs(y(2) - self%middle) > pi / 2) return
            dy = at_turning_point(self, y)
            dy(2) = self%direction * sqrt(radicand)
        case default
            dy(1) = precession_rate(self, y(2))
            dy(2) = y(3)
            dy(3) = theta_acceleration(self, y(2), dy(1))
            dy(4) = self%omega3 - dy(1) * cos(y(2))
        end select
        status = status_ok
    end subroutine derivative

    !> Solves the first two of Euler's equations for phi'' and theta'' (Eqs 36-40).
    pure subroutine solve_euler(self, y, dy)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(inout) :: dy(max_states)
        real(dp) :: s3, c3, s5, c5, psi_rate, mgl, a(2, 2), b(2), determinant

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
    end subroutine solve_euler

    !> The motion, with the second derivatives of phi and theta: those of Euler's equations, of Eq 42 (half the derivative of the
    !> radicand of Eq 46 by theta), and from Eq 41.
    pure type(motion_t) function motion(self, t, y, near)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states), angle(3), rate(3), accelerations(2)
        integer :: status
        call self%derivative(t, y, dy, status)
        if (status == status_outside) dy = at_turning_point(self, y)
        associate (place => places(:, self%kind))
            angle = y(place([1, 3, 5]))
            rate = dy(place([1, 3, 5]))
        end associate
        if (self%kind == of_euler) then
            accelerations = dy([2, 4])
        else
            accelerations = [phi_acceleration(self, angle(2), rate(1), rate(2)), theta_acceleration(self, angle(2), rate(1))]
        end if
        motion = motion_from_angles(t, angle, rate)
        motion%quaternion = self%sheet * motion%quaternion
        motion%omega(3) = self%omega3
        motion%omega_rate = omega_rate_from_accelerations(angle, rate, accelerations(1), accelerations(2), 0.0_dp)
    end function motion

    !> Twice the energy over I1, without the part of the spin; with Euler's equations also the momentum about the vertical over I1.
    pure subroutine invariants(self, y, values)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        real(dp) :: phi_rate
        values = 0
        if (self%kind == of_energy_rate) return
        associate (theta => y(places(3, self%kind)), theta_rate => y(places(4, self%kind)))
            if (self%kind == of_euler) then
                phi_rate = y(2)
                values(2) = phi_rate * sin(theta)**2 + self%a * cos(theta)
            else
                phi_rate = precession_rate(self, theta)
            end if
            values(1) = theta_rate**2 + (sin(theta) * phi_rate)**2 + self%beta * cos(theta)
        end associate
    end subroutine invariants

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
                       - (precession_rate(self, theta) * sin(theta))**2
    end function speed_budget

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

    !> A negative radicand is clipped. A theta' that has this energy to rounding stays: near a turning point
    !> the root knows it to half of the digits only.
    pure subroutine reset_speed(self, y, clipped)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states) !! state (phi, theta, theta', psi)
        logical, intent(out) :: clipped !! whether the radicand was negative
        real(dp) :: radicand
        radicand = speed_budget(self, y(2))
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
        phi_rate = precession_rate(self, theta)
        rounding = units * epsilon_dp * (self%speed0 + (phi_rate * sin(theta))**2 &
                                         + abs(self%beta * cosine_drop(theta, self%theta0)) &
                                         + abs(2 * theta * theta_acceleration(self, theta, phi_rate)))
    end function budget_rounding

    !> The rates where theta' = 0.
    pure function at_turning_point(self, y) result(dy)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp) :: dy(max_states)
        dy = 0
        dy(1) = precession_rate(self, y(2))
        dy(3) = self%omega3 - dy(1) * cos(y(2))
    end function at_turning_point

    !> Estimate -theta'/theta'' of the time to the next turning point while theta slows down, s, where the equations end; its
    !> error goes with its cube. `huge` where they do not end.
    pure real(dp) function time_left(self, y)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp) :: dy(max_states), acceleration
        integer :: status
        time_left = huge(1.0_dp)
        if (is_zero(self%direction)) return
        call self%derivative(0.0_dp, y, dy, status)
        if (status == status_outside) time_left = 0
        if (.not. is_ok(status)) return
        acceleration = self%direction * theta_acceleration(self, y(2), dy(1))
        if (acceleration < 0) time_left = abs(dy(2)) / (-acceleration)
    end function time_left

    !> Leaves a start at a turning point, where the right-hand side alone would stay for ever: theta = theta0 + theta'' h^2/2,
    !> with phi and psi to the next order.
    pure subroutine depart(self, y, h, departed)
        class(euler_angles_t), intent(in) :: self
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
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states) !! state, then that at the turning point
        real(dp), intent(out) :: left !! time to it, s
        integer, parameter :: newton_steps = 3
        real(dp) :: dy(max_states), back(max_states), turning
        integer :: i

        left = self%time_left(y)
        turning = y(2)
        do i = 1, newton_steps
            turning = turning - speed_budget(self, turning) &
                / (2 * theta_acceleration(self, turning, precession_rate(self, turning)))
        end do
        back = y
        back(2) = turning
        dy = at_turning_point(self, back)
        left = left * (1 - theta_stiffness(self, turning, dy(1)) * left**2 / 3)
        call leave_turning_point(self, dy, -left, back)
        y(1) = y(1) + (y(1) - back(1))
        y(2) = turning
        y(3) = y(3) + (y(3) - back(3))
    end subroutine arrive

    !> Moves a state at a turning point, where the rates are `dy`, by a short time h.
    pure subroutine leave_turning_point(self, dy, h, y)
        class(euler_angles_t), intent(in) :: self
        real(dp), intent(in) :: dy(max_states), h
        real(dp), intent(inout) :: y(max_states)
        real(dp) :: rise, bend
        rise = theta_acceleration(self, y(2), dy(1)) * h**2 / 2
        bend = phi_acceleration(self, y(2), dy(1), rise * h / 3)
        y(1) = y(1) + h * dy(1) + bend
        y(3) = y(3) + h * dy(3) - bend * cos(y(2)) + dy(1) * sin(y(2)) * rise * h / 3
        y(2) = y(2) + rise
    end subroutine leave_turning_point

end module spintop_euler_angles
