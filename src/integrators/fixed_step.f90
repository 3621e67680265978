!> Methods that go through the span in equal steps.
module spintop_fixed_step
    use spintop_kinds, only: dp
    use spintop_compare, only: is_finite
    use spintop_formulation, only: formulation_t, max_states
    use spintop_stepper, only: stepper_t, workspace_t
    use spintop_status, only: status_ok, status_outside, status_non_finite, status_step_too_small
    implicit none
    private
    public :: fixed_step_t, begin_on_grid, advance_on_grid, grid_time, off_grid, share_of_time_left

    !> Mark in `workspace_t%grid` of a run that has left the grid of equal steps.
    integer, parameter :: off_grid = -1
    !> Near the end of its equations a run may take this share of the time left in one step.
    real(dp), parameter :: share_of_time_left = 0.25_dp

    !> A method with one step formula and the grid t_begin + n (t_end - t_begin)/steps.
    type, extends(stepper_t), abstract :: fixed_step_t
    contains
        procedure :: new_workspace
        procedure :: begin => begin_on_grid
        procedure :: advance => advance_on_grid
        procedure :: interpolate
        procedure(step), deferred :: step
    end type fixed_step_t

    abstract interface
        !> The state a time `h` after `work%y`, whose slope is `work%slope`.
        subroutine step(self, formulation, work, h, y_new, status)
            import :: fixed_step_t, formulation_t, workspace_t, dp, max_states
            class(fixed_step_t), intent(in) :: self
            class(formulation_t), intent(in) :: formulation
            class(workspace_t), intent(inout) :: work
            real(dp), intent(in) :: h
            real(dp), intent(out) :: y_new(max_states)
            integer, intent(out) :: status
        end subroutine step
    end interface

contains

    !> A plain workspace.
    subroutine new_workspace(self, work)
        class(fixed_step_t), intent(in) :: self
        class(workspace_t), allocatable, intent(out) :: work
        associate (unused => self)
        end associate
        allocate (work)
    end subroutine new_workspace

    !> Takes the first slope and, for equal steps, sets their size.
    subroutine begin_on_grid(self, formulation, work, status)
        class(fixed_step_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        integer, intent(out) :: status

        if (self%controls%steps > 0) work%h = (work%t_end - work%t_begin) / self%controls%steps
        call work%evaluate(formulation, work%y, work%slope, status)
    end subroutine begin_on_grid

    !> One step: on the grid while the equations last, in ever shorter ones as they end.
    subroutine advance_on_grid(self, formulation, work, status)
        class(fixed_step_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        integer, intent(out) :: status
        real(dp) :: h, t_new, y_new(max_states), slope(max_states)
        logical :: changed

        h = min(work%h, share_of_time_left * formulation%time_left(work%y))
        if (h < work%h) work%grid = off_grid
        do
            if (work%grid == off_grid) then
                t_new = min(work%t + h, work%t_end)
                h = t_new - work%t
            else
                work%grid = work%grid + 1
                t_new = grid_time(work, self%controls%steps)
            end if
            call self%step(formulation, work, h, y_new, status)
            if (status == status_ok .and. .not. all(is_finite(y_new))) status = status_non_finite
            if (status == status_ok) call work%evaluate(formulation, y_new, slope, status)
            if (status /= status_outside) exit
            work%grid = off_grid
            work%counts%rejected = work%counts%rejected + 1
            h = h / 2
            if (h <= 2 * spacing(work%t)) status = status_step_too_small
            if (status == status_step_too_small) exit
        end do
        if (status /= status_ok) return
        call work%settle(formulation, t_new, y_new, changed)
        if (changed) call work%evaluate(formulation, work%y, slope, status)
        work%slope = slope
    end subroutine advance_on_grid

    !> Time of the grid point that a run in so many equal steps has reached, without summing steps.
    pure real(dp) function grid_time(work, steps)
        class(workspace_t), intent(in) :: work
        integer, intent(in) :: steps
        grid_time = work%t_end
        if (work%grid < steps) then
            grid_time = work%t_begin + (work%t_end - work%t_begin) * work%grid / steps
        end if
    end function grid_time

    !> Only the ends of a step are known.
    function interpolate(self, formulation, work, t) result(y)
        class(fixed_step_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        real(dp), intent(in) :: t
        real(dp) :: y(max_states)
        associate (unused => self, also_unused => formulation)
        end associate
        y = work%y
        if (t < work%t) y = work%y_last
    end function interpolate

end module spintop_fixed_step
