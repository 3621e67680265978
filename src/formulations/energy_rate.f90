!> The energy-rate equations (the paper's scenario 1): theta' itself from the energy, Eq 46.
!>
!> They hold between two turning points of theta. There theta' = 0 is a rest state of the equation,
!> though not of the top: a start on it departs by Taylor's series, and the end is reported.
module spintop_energy_rate
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_compare, only: is_zero
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_symmetric_top, only: symmetric_top_t, at_pole
    use spintop_status, only: status_ok, status_pole, status_outside
    implicit none
    private
    public :: energy_rate_t

    !> State y = (phi, theta, psi).
    type, extends(formulation_t) :: energy_rate_t
        private
        type(symmetric_top_t) :: top = symmetric_top_t()
        !> Sign of theta' on this branch; 0 for steady precession.
        real(dp) :: branch = 1
        !> Whether the start is a turning point.
        logical :: starts_at_rest = .false.
    contains
        procedure, nopass :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: time_left
        procedure :: depart
        procedure :: arrive
    end type energy_rate_t

contains

    !> Name and properties.
    pure function info()
        type(formulation_info_t) :: info
        info = formulation_info_t('energy_rate', &
            "(phi, theta, psi) with theta' from the energy, to the next turning point (Eq 46, scenario 1)", 3)
    end function info

    !> Constants of the motion, the branch, and the initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(energy_rate_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(out) :: y(max_states)
        integer, intent(out) :: status
        !> Rounding of theta'' in units of the spacing of its terms.
        real(dp), parameter :: rounding = 16
        real(dp) :: pull, terms

        self%body = body
        call self%top%set(body, start)
        y = 0
        y(1:3) = start%angle
        self%cyclic([1, 3]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
        pull = start%rate(2)
        self%starts_at_rest = is_zero(pull)
        if (self%starts_at_rest) then
            pull = self%top%theta_acceleration(start%angle(2), start%rate(1))
            terms = abs(start%rate(1)) * (abs(start%rate(1)) + abs(self%top%a)) + self%top%beta / 2
            terms = terms * abs(sin(start%angle(2)))
            if (abs(pull) <= rounding * epsilon_dp * terms) pull = 0
        end if
        self%branch = sign(1.0_dp, pull)
        if (is_zero(pull)) self%branch = 0
    end subroutine prepare

    !> Eqs 41, 46 and 44; outside where the radicand of Eq 46 is negative.
    pure subroutine derivative(self, y, dy, status)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: dy(max_states)
        integer, intent(out) :: status
        real(dp) :: radicand

        dy = 0
        status = status_pole
        if (at_pole(y(2))) return
        radicand = merge(0.0_dp, self%top%speed_budget(y(2)), is_zero(self%branch))
        status = status_outside
        if (radicand < 0) return
        dy(1) = self%top%precession_rate(y(2))
        dy(2) = self%branch * sqrt(radicand)
        dy(3) = self%top%omega3 - dy(1) * cos(y(2))
        status = status_ok
    end subroutine derivative

    !> The motion, with theta'' of Eq 42 (half the derivative of the radicand by theta).
    pure type(motion_t) function motion(self, t, y, near)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3)
        real(dp) :: dy(max_states)
        integer :: status
        associate (unused => near)
        end associate
        call self%derivative(y, dy, status)
        if (status == status_outside) dy = at_turning_point(self, y)
        motion = self%top%complete(t, y(1:3), dy(1:3), &
                                   self%top%phi_acceleration(y(2), dy(1), dy(2)), &
                                   self%top%theta_acceleration(y(2), dy(1)))
    end function motion

    !> The rates where theta' = 0.
    pure function at_turning_point(self, y) result(dy)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp) :: dy(max_states)
        dy = 0
        dy(1) = self%top%precession_rate(y(2))
        dy(3) = self%top%omega3 - dy(1) * cos(y(2))
    end function at_turning_point

    !> -theta'/theta'' while theta slows down.
    pure real(dp) function time_left(self, y)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp) :: dy(max_states), acceleration
        integer :: status
        time_left = huge(1.0_dp)
        if (is_zero(self%branch)) return
        call self%derivative(y, dy, status)
        if (status == status_outside) time_left = 0
        if (status /= status_ok) return
        acceleration = self%branch * self%top%theta_acceleration(y(2), dy(1))
        if (acceleration < 0) time_left = abs(dy(2)) / (-acceleration)
    end function time_left

    !> Leaves a turning point by theta = theta0 + theta'' h^2/2, phi and psi to the order beyond.
    pure subroutine depart(self, y, h, departed)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states), h
        logical, intent(out) :: departed
        !> Share of the fastest time scale that a departure of own choice takes.
        real(dp), parameter :: share = 1.0e-3_dp
        real(dp) :: dy(max_states)

        departed = self%starts_at_rest .and. .not. is_zero(self%branch)
        if (.not. departed) return
        dy = at_turning_point(self, y)
        if (is_zero(h)) h = share / sqrt(self%top%beta + self%top%a**2 + dy(1)**2)
        call leave_turning_point(self, dy, h, y)
    end subroutine depart

    !> Finds the turning angle by Newton's method on the radicand, the time to it with the next
    !> term of the series, and goes there as it would go back.
    pure subroutine arrive(self, y, left)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states)
        real(dp), intent(out) :: left
        integer, parameter :: newton_steps = 3
        real(dp) :: dy(max_states), back(max_states), turning
        integer :: i

        left = self%time_left(y)
        turning = y(2)
        do i = 1, newton_steps
            turning = turning - self%top%speed_budget(turning) &
                / (2 * self%top%theta_acceleration(turning, self%top%precession_rate(turning)))
        end do
        back = y
        back(2) = turning
        dy = at_turning_point(self, back)
        left = left * (1 - self%top%theta_stiffness(turning, dy(1)) * left**2 / 3)
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
        rise = self%top%theta_acceleration(y(2), dy(1)) * h**2 / 2
        bend = self%top%phi_acceleration(y(2), dy(1), rise * h / 3)
        y(1) = y(1) + h * dy(1) + bend
        y(3) = y(3) + h * dy(3) - bend * cos(y(2)) + dy(1) * sin(y(2)) * rise * h / 3
        y(2) = y(2) + rise
    end subroutine leave_turning_point

end module spintop_energy_rate
