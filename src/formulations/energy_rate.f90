!> The energy-rate equations (scenario 1 of the paper): theta' from the energy, Eq 46.
!>
!> They hold between two turning points of theta. At a turning point theta' = 0 is an equilibrium of the
!> equation, though not of the top. A motion leaves a start there by a Taylor series, and ends with a status
!> at the next one.
module spintop_energy_rate
    use spintop_kinds, only: dp, epsilon_dp, pi
    use spintop_compare, only: is_zero
    use spintop_body, only: body_t
    use spintop_capabilities, only: ends_t, max_states
    use spintop_motion, only: motion_t
    use spintop_formulation, only: formulation_t, formulation_info_t
    use spintop_symmetric_top, only: symmetric_top_t, at_pole
    use spintop_status, only: status_ok, status_pole, status_outside
    implicit none
    private
    public :: energy_rate_t

    !> A motion of theta between two turning points.
    type :: branch_t
        type(symmetric_top_t) :: top = symmetric_top_t()
        !> Sign of theta'; 0 for steady precession.
        real(dp) :: direction = 1
        !> Whether the start is a turning point.
        logical :: starts_at_rest = .false.
        !> Inclination amid the two poles between which the motion is, rad.
        real(dp) :: middle = pi / 2
    contains
        procedure :: set
        procedure :: rates
        procedure :: at_turning_point
        procedure :: leave_turning_point
    end type branch_t

    !> State y = (phi, theta, psi).
    type, extends(formulation_t) :: energy_rate_t
        private
        type(branch_t) :: branch = branch_t()
    contains
        procedure, nopass :: describe
        procedure :: prepare
        procedure :: slope
        procedure :: motion
    end type energy_rate_t

    interface energy_rate_t
        module procedure new_energy_rate
    end interface energy_rate_t

    !> The turning points.
    type, extends(ends_t) :: turning_points_t
        private
        type(branch_t) :: branch = branch_t()
    contains
        procedure :: set => set_ends
        procedure :: time_left
        procedure :: depart
        procedure :: arrive
    end type turning_points_t

contains

    !> The formulation with its ends.
    function new_energy_rate() result(new)
        type(energy_rate_t) :: new
        allocate (turning_points_t :: new%ends)
    end function new_energy_rate

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('energy_rate', &
            "(phi, theta, psi) with theta' from the energy, to the next turning point (Eq 46, scenario 1)", 3)
    end function describe

    !> Constants of the motion, the branch, and the initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(energy_rate_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        self%body = body
        call self%branch%set(body, start)
        call self%set_capabilities(body, start)
        y = 0
        y(1:3) = start%angle
        self%cyclic([1, 3]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare

    !> Constants of the motion, and the branch that the start lies on.
    pure subroutine set(self, body, start)
        class(branch_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        !> Rounding error of theta'', relative to the spacing of its terms.
        real(dp), parameter :: rounding = 16
        real(dp) :: pull, terms

        call self%top%set(body, start)
        self%middle = pi * (anint(start%angle(2) / pi - 0.5_dp) + 0.5_dp)
        pull = start%rate(2)
        self%starts_at_rest = is_zero(pull)
        if (self%starts_at_rest) then
            pull = self%top%theta_acceleration(start%angle(2), start%rate(1))
            terms = abs(start%rate(1)) * (abs(start%rate(1)) + abs(self%top%a)) + self%top%beta / 2
            terms = terms * abs(sin(start%angle(2)))
            if (abs(pull) <= rounding * epsilon_dp * terms) pull = 0
        end if
        self%direction = sign(1.0_dp, pull)
        if (is_zero(pull)) self%direction = 0
    end subroutine set

    !> The right-hand side.
    pure subroutine slope(self, y, dy, status)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call self%branch%rates(y, dy, status)
    end subroutine slope

    !> Eqs 41, 46 and 44; outside where the radicand of Eq 46 is negative, and beyond a pole, which only a step
    !> over the turning point before it comes to.
    pure subroutine rates(self, y, dy, status)
        class(branch_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: dy(max_states)
        integer, intent(out) :: status
        real(dp) :: radicand

        dy = 0
        status = status_pole
        if (at_pole(y(2))) return
        radicand = merge(0.0_dp, self%top%speed_budget(y(2)), is_zero(self%direction))
        status = status_outside
        if (radicand < 0 .or. abs(y(2) - self%middle) > pi / 2) return
        dy(1) = self%top%precession_rate(y(2))
        dy(2) = self%direction * sqrt(radicand)
        dy(3) = self%top%omega3 - dy(1) * cos(y(2))
        status = status_ok
    end subroutine rates

    !> The motion, with theta'' of Eq 42 (half the derivative of the radicand by theta).
    pure type(motion_t) function motion(self, t, y, near)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        associate (unused => near)
        end associate
        call self%branch%rates(y, dy, status)
        if (status == status_outside) dy = self%branch%at_turning_point(y)
        associate (top => self%branch%top)
            motion = top%complete(t, y(1:3), dy(1:3), top%phi_acceleration(y(2), dy(1), dy(2)), &
                                  top%theta_acceleration(y(2), dy(1)))
        end associate
    end function motion

    !> The rates where theta' = 0.
    pure function at_turning_point(self, y) result(dy)
        class(branch_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp) :: dy(max_states)
        dy = 0
        dy(1) = self%top%precession_rate(y(2))
        dy(3) = self%top%omega3 - dy(1) * cos(y(2))
    end function at_turning_point

    !> The branch.
    pure subroutine set_ends(self, body, start)
        class(turning_points_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        call self%branch%set(body, start)
    end subroutine set_ends

    !> Estimate -theta'/theta'' of the time to the next turning point while theta slows down.
    pure real(dp) function time_left(self, y)
        class(turning_points_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp) :: dy(max_states), acceleration
        integer :: status
        time_left = huge(1.0_dp)
        if (is_zero(self%branch%direction)) return
        call self%branch%rates(y, dy, status)
        if (status == status_outside) time_left = 0
        if (status /= status_ok) return
        acceleration = self%branch%direction * self%branch%top%theta_acceleration(y(2), dy(1))
        if (acceleration < 0) time_left = abs(dy(2)) / (-acceleration)
    end function time_left

    !> Leaves a turning point: theta = theta0 + theta'' h^2/2, with phi and psi to the next order.
    pure subroutine depart(self, y, h, departed)
        class(turning_points_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states), h
            !! state, and time of the departure, s; 0 on entry: chosen by this procedure
        logical, intent(out) :: departed !! whether the state is one after a departure
        !> Time of a departure without a given h, relative to the fastest time scale.
        real(dp), parameter :: share = 1.0e-3_dp
        real(dp) :: dy(max_states)

        departed = self%branch%starts_at_rest .and. .not. is_zero(self%branch%direction)
        if (.not. departed) return
        dy = self%branch%at_turning_point(y)
        if (is_zero(h)) h = share / sqrt(self%branch%top%beta + self%branch%top%a**2 + dy(1)**2)
        call self%branch%leave_turning_point(dy, h, y)
    end subroutine depart

    !> Goes to the turning point: the angle by Newton's method for the radicand, the time to it with the next
    !> term of the series.
    pure subroutine arrive(self, y, left)
        class(turning_points_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states)
        real(dp), intent(out) :: left
        integer, parameter :: newton_steps = 3
        real(dp) :: dy(max_states), back(max_states), turning
        integer :: i

        left = self%time_left(y)
        turning = y(2)
        do i = 1, newton_steps
            turning = turning - self%branch%top%speed_budget(turning) &
                / (2 * self%branch%top%theta_acceleration(turning, self%branch%top%precession_rate(turning)))
        end do
        back = y
        back(2) = turning
        dy = self%branch%at_turning_point(back)
        left = left * (1 - self%branch%top%theta_stiffness(turning, dy(1)) * left**2 / 3)
        call self%branch%leave_turning_point(dy, -left, back)
        y(1) = y(1) + (y(1) - back(1))
        y(2) = turning
        y(3) = y(3) + (y(3) - back(3))
    end subroutine arrive

    !> Moves a state at a turning point, where the rates are `dy`, by a short time h.
    pure subroutine leave_turning_point(self, dy, h, y)
        class(branch_t), intent(in) :: self
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
