!> The adaptive Dormand-Prince pair 5(4) with MATLAB's step control: ode45. Its Butcher table is in
!> butcher.f90.
module spintop_ode45
    use spintop_kinds, only: dp
    use spintop_compare, only: is_finite
    use spintop_formulation, only: max_states
    use spintop_stepper, only: stepper_t
    use spintop_fixed_step, only: longest_step
    use spintop_runge_kutta, only: butcher_t, max_stages, stage_sum
    use spintop_status, only: is_ok, status_non_finite, status_step_too_small
    implicit none
    private
    public :: ode45_t

    !> An embedded Runge-Kutta pair whose last stage is the first one of the next step.
    type, extends(stepper_t) :: ode45_t
        type(butcher_t) :: table
        real(dp) :: k(max_states, max_stages) = 0
    contains
        procedure :: begin
        procedure :: advance
        procedure :: state_within
    end type ode45_t

    !> Largest step relative to the span.
    real(dp), parameter :: largest_share = 0.1_dp
    !> Smallest step in units of the spacing of the time.
    real(dp), parameter :: smallest_spacings = 16

contains

    !> First slope and MATLAB's first step size.
    subroutine begin(self, status)
        class(ode45_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: steepest

        call self%set_weight()
        call self%evaluate(self%t, self%y, self%slope, status)
        if (.not. is_ok(status)) return
        self%h = largest_share * (self%t_end - self%t_begin)
        steepest = maxval(abs(self%slope) / self%weight%matlab_magnitude(self%y, self%y)) &
                   / (0.8_dp * self%controls%relative_tolerance**power(self))
        if (self%h * steepest > 1) self%h = 1 / steepest
    end subroutine begin

    !> One accepted step; rejected steps are counted.
    subroutine advance(self, status)
        class(ode45_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, h_smallest, h_left, t_new, y_new(max_states), error, growth
        logical :: first_trial, changed

        h_smallest = smallest_spacings * spacing(self%t)
        h_left = longest_step(self%formulation, self%y)
        self%h = min(max(self%h, h_smallest), largest_share * (self%t_end - self%t_begin))
        first_trial = .true.
        do
            h = min(self%h, h_left)
            t_new = self%t + h
            ! A step that nearly reaches the end is stretched to the end.
            if (1.1_dp * h >= self%t_end - self%t .and. h < h_left) t_new = self%t_end
            t_new = min(t_new, self%t_end)
            h = t_new - self%t
            call try_step(self, h, y_new, error, status)
            if (is_ok(status) .and. error <= self%controls%relative_tolerance) exit
            self%counts%rejected = self%counts%rejected + 1
            if (h <= h_smallest) then
                if (is_ok(status)) status = status_step_too_small
                return
            end if
            if (.not. is_ok(status)) then
                self%h = h / 2
            else if (first_trial) then
                self%h = h * max(0.1_dp, 0.8_dp &
                                 * (self%controls%relative_tolerance / error)**power(self))
            else
                self%h = h / 2
            end if
            self%h = max(self%h, h_smallest)
            first_trial = .false.
        end do
        call self%accept_step(t_new, y_new, changed)
        self%slope = self%k(:, self%table%stages)
        if (changed) call self%evaluate(self%t, self%y, self%slope, status)
        if (first_trial) then
            growth = 1.25_dp * (error / self%controls%relative_tolerance)**power(self)
            self%h = h / max(growth, 0.2_dp)
        end if
    end subroutine advance

    !> One trial of size h: the new state, and the error of the embedded method in units in which the relative
    !> tolerance is the limit.
    subroutine try_step(self, h, y_new, error, status)
        class(ode45_t), intent(inout) :: self
        real(dp), intent(in) :: h
        real(dp), intent(out) :: y_new(max_states), error
        integer, intent(out) :: status
        integer :: i

        error = huge(1.0_dp)
        y_new = self%y
        self%k(:, 1) = self%slope
        do i = 2, self%table%stages
            y_new = self%y + h * stage_sum(self%k, self%table%a(:, i), i - 1)
            call self%evaluate(self%t + self%table%c(i) * h, y_new, self%k(:, i), status)
            if (.not. is_ok(status)) return
        end do
        error = h * maxval(abs(stage_sum(self%k, self%table%error, self%table%stages)) &
                           / self%weight%matlab_magnitude(self%y, y_new))
        if (.not. is_finite(error)) status = status_non_finite
    end subroutine try_step

    !> Exponent of the error in the step size.
    pure real(dp) function power(self)
        class(ode45_t), intent(in) :: self
        power = 1.0_dp / self%table%order
    end function power

    !> Dense output of order 4 within the last step.
    function state_within(self, t) result(y)
        class(ode45_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), s, weight(max_stages)
        y = self%y
        s = (t - self%t_last) / (self%t - self%t_last)
        weight = matmul(s**[1, 2, 3, 4], self%table%dense)
        y = self%y_last + (self%t - self%t_last) &
            * stage_sum(self%k, weight, self%table%stages)
    end function state_within

end module spintop_ode45
