!> The adaptive Dormand-Prince pair 5(4) with MATLAB's step control: ode45. Its Butcher table is in
!> butcher.f90.
module spintop_ode45
    use spintop_kinds, only: dp
    use spintop_compare, only: is_finite
    use spintop_formulation, only: formulation_t, max_states
    use spintop_stepper, only: stepper_t, workspace_t
    use spintop_fixed_step, only: longest_step
    use spintop_butcher, only: butcher_t, max_stages
    use spintop_runge_kutta, only: stage_sum
    use spintop_status, only: status_ok, status_non_finite, status_step_too_small
    implicit none
    private
    public :: ode45_t

    !> An embedded Runge-Kutta pair whose last stage is the first one of the next step.
    type, extends(stepper_t) :: ode45_t
        type(butcher_t) :: table
    contains
        procedure :: new_workspace
        procedure :: begin
        procedure :: advance
        procedure :: state_within
    end type ode45_t

    !> Keeps the stages of the last step for dense output.
    type, extends(workspace_t) :: ode45_workspace_t
        real(dp) :: k(max_states, max_stages) = 0
    end type ode45_workspace_t

    !> Largest step relative to the span.
    real(dp), parameter :: largest_share = 0.1_dp
    !> Smallest step in units of the spacing of the time.
    real(dp), parameter :: smallest_spacings = 16

contains

    !> A workspace with room for the stages.
    subroutine new_workspace(self, work)
        class(ode45_t), intent(in) :: self
        class(workspace_t), allocatable, intent(out) :: work !! workspace of the type that the method needs
        associate (unused => self)
        end associate
        allocate (ode45_workspace_t :: work)
    end subroutine new_workspace

    !> First slope and MATLAB's first step size.
    subroutine begin(self, formulation, work, status)
        class(ode45_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: steepest

        call self%set_weight(formulation, work)
        call work%evaluate(formulation, work%t, work%y, work%slope, status)
        if (status /= status_ok) return
        work%h = largest_share * (work%t_end - work%t_begin)
        steepest = maxval(abs(work%slope) / work%weight%matlab_magnitude(work%y, work%y)) &
                   / (0.8_dp * self%controls%relative_tolerance**power(self))
        if (work%h * steepest > 1) work%h = 1 / steepest
    end subroutine begin

    !> One accepted step; rejected steps are counted.
    subroutine advance(self, formulation, work, status)
        class(ode45_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        select type (work)
        class is (ode45_workspace_t)
            call advance_stages(self, formulation, work, status)
        end select
    end subroutine advance

    !> `advance`, with access to the stages.
    subroutine advance_stages(self, formulation, work, status)
        class(ode45_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(ode45_workspace_t), intent(inout) :: work
        integer, intent(out) :: status
        real(dp) :: h, h_smallest, h_left, t_new, y_new(max_states), error, growth
        logical :: first_trial, changed

        h_smallest = smallest_spacings * spacing(work%t)
        h_left = longest_step(formulation, work%y)
        work%h = min(max(work%h, h_smallest), largest_share * (work%t_end - work%t_begin))
        first_trial = .true.
        do
            h = min(work%h, h_left)
            t_new = work%t + h
            ! A step that nearly reaches the end is stretched to the end.
            if (1.1_dp * h >= work%t_end - work%t .and. h < h_left) t_new = work%t_end
            t_new = min(t_new, work%t_end)
            h = t_new - work%t
            call try_step(self, formulation, work, h, y_new, error, status)
            if (status == status_ok .and. error <= self%controls%relative_tolerance) exit
            work%counts%rejected = work%counts%rejected + 1
            if (h <= h_smallest) then
                if (status == status_ok) status = status_step_too_small
                return
            end if
            if (status /= status_ok) then
                work%h = h / 2
            else if (first_trial) then
                work%h = h * max(0.1_dp, 0.8_dp &
                                 * (self%controls%relative_tolerance / error)**power(self))
            else
                work%h = h / 2
            end if
            work%h = max(work%h, h_smallest)
            first_trial = .false.
        end do
        call work%settle(formulation, t_new, y_new, changed)
        work%slope = work%k(:, self%table%stages)
        if (changed) call work%evaluate(formulation, work%t, work%y, work%slope, status)
        if (first_trial) then
            growth = 1.25_dp * (error / self%controls%relative_tolerance)**power(self)
            work%h = h / max(growth, 0.2_dp)
        end if
    end subroutine advance_stages

    !> One trial of size h: the new state, and the error of the embedded method in units in which the relative
    !> tolerance is the limit.
    subroutine try_step(self, formulation, work, h, y_new, error, status)
        class(ode45_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(ode45_workspace_t), intent(inout) :: work
        real(dp), intent(in) :: h
        real(dp), intent(out) :: y_new(max_states), error
        integer, intent(out) :: status
        integer :: i

        error = huge(1.0_dp)
        y_new = work%y
        work%k(:, 1) = work%slope
        do i = 2, self%table%stages
            y_new = work%y + h * stage_sum(work%k, self%table%a(:, i), i - 1)
            call work%evaluate(formulation, work%t + self%table%c(i) * h, y_new, work%k(:, i), status)
            if (status /= status_ok) return
        end do
        error = h * maxval(abs(stage_sum(work%k, self%table%error, self%table%stages)) &
                           / work%weight%matlab_magnitude(work%y, y_new))
        if (.not. is_finite(error)) status = status_non_finite
    end subroutine try_step

    !> Exponent of the error in the step size.
    pure real(dp) function power(self)
        class(ode45_t), intent(in) :: self
        power = 1.0_dp / self%table%order
    end function power

    !> Dense output of order 4 within the last step.
    function state_within(self, formulation, work, t) result(y)
        class(ode45_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), s, weight(max_stages)
        associate (unused => formulation)
        end associate
        y = work%y
        select type (work)
        class is (ode45_workspace_t)
            s = (t - work%t_last) / (work%t - work%t_last)
            weight = matmul(s**[1, 2, 3, 4], self%table%dense)
            y = work%y_last + (work%t - work%t_last) &
                * stage_sum(work%k, weight, self%table%stages)
        end select
    end function state_within

end module spintop_ode45
