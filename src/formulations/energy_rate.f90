!> The energy-rate equations (scenario 1 of the paper): theta' from the energy, Eq 46.
!>
!> They hold between two turning points of theta. At a turning point theta' = 0 is an equilibrium of the
!> equation, though not of the top. A motion leaves a start there by a Taylor series, and ends with a status
!> at the next one.
module spintop_energy_rate
    use spintop_body, only: body_t
    use spintop_compare, only: is_zero
    use spintop_euler_angles, only: at_pole, euler_angles_t
    use spintop_formulation, only: formulation_info_t, max_states
    use spintop_kinds, only: dp, epsilon_dp, pi
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_ok, status_outside, status_pole
    implicit none
    private
    public :: energy_rate_t

    !> State y = (phi, theta, psi).
    type, extends(euler_angles_t) :: energy_rate_t
        private
        !> Sign of theta'; 0 for steady precession.
        real(dp) :: direction = 1
        !> Whether the start is a turning point.
        logical :: starts_at_rest = .false.
        !> Inclination amid the two poles between which the motion is, rad.
        real(dp) :: middle = pi / 2
    contains
        procedure :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: time_left
        procedure :: depart
        procedure :: arrive
    end type energy_rate_t

contains

    !> Name and properties.
    pure function info(self)
        class(energy_rate_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('energy_rate', &
            "(phi, theta, psi) with theta' from the energy, to the next turning point (Eq 46, scenario 1)", 3)
    end function info

    !> Constants of the motion, the branch that the start lies on, and the initial state.
    pure subroutine prepare(self, body, start, y, status)
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
    end subroutine prepare

    !> Eqs 41, 46 and 44; outside where the radicand of Eq 46 is negative, and beyond a pole, which only a step
    !> over the turning point before it comes to.
    pure subroutine derivative(self, t, y, dy, status)
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
    end subroutine derivative

    !> The motion, with theta'' of Eq 42 (half the derivative of the radicand by theta).
    pure type(motion_t) function motion(self, t, y, near)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        call self%derivative(t, y, dy, status)
        if (status == status_outside) dy = at_turning_point(self, y)
        motion = self%complete(t, y(1:3), dy(1:3), self%phi_acceleration(y(2), dy(1), dy(2)), &
                               self%theta_acceleration(y(2), dy(1)))
    end function motion

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

end module spintop_energy_rate
