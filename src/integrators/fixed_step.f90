!> Methods with a fixed step size.
module spintop_fixed_step
    use spintop_kinds, only: dp
    use spintop_compare, only: is_equal
    use spintop_dense_output, only: dense_output_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_stepper, only: stepper_t, workspace_t
    use spintop_status, only: status_ok, status_outside, status_non_finite, status_step_too_small
    implicit none
    private
    public :: fixed_step_t, grid_workspace_t, begin_on_grid, advance_on_grid, grid_time, off_grid
    public :: share_of_time_left

    !> Mark in `workspace_t%grid` of a run that has left the grid of fixed step size.
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
        procedure :: starts_from_slope
    end type fixed_step_t

    !> Keeps the polynomial of the last step, once a time within it was asked for.
    type, extends(workspace_t) :: grid_workspace_t
        type(dense_output_t) :: dense
        !> End of the step that the polynomial is of, s.
        real(dp) :: t_fitted = -huge(1.0_dp)
    end type grid_workspace_t

    abstract interface
        !> How the state `work%y`, whose slope is `work%slope` for methods that start from it, changes
        !> within a time `h`.
        subroutine step(self, formulation, work, h, change, status)
            import :: fixed_step_t, formulation_t, workspace_t, dp, max_states
            class(fixed_step_t), intent(in) :: self
            class(formulation_t), intent(in) :: formulation
            class(workspace_t), intent(inout) :: work
            real(dp), intent(in) :: h
            real(dp), intent(out) :: change(max_states)
            integer, intent(out) :: status
        end subroutine step
    end interface

contains

    !> A workspace with room for dense output.
    subroutine new_workspace(self, work)
        class(fixed_step_t), intent(in) :: self
        class(workspace_t), allocatable, intent(out) :: work
        associate (unused => self)
        end associate
        allocate (grid_workspace_t :: work)
    end subroutine new_workspace

    !> Whether steps start from the slope; if not, slopes are taken for dense output only.
    pure logical function starts_from_slope(self)
        class(fixed_step_t), intent(in) :: self
        associate (unused => self)
        end associate
        starts_from_slope = .true.
    end function starts_from_slope

    !> Takes the first slope and, for a fixed step size, sets it.
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
        real(dp) :: h, t_new, change(max_states), slope(max_states)
        logical :: changed, sloped

        sloped = self%starts_from_slope()
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
            call self%step(formulation, work, h, change, status)
            ! Not by is_finite, as in `evaluate`.
            if (status == status_ok .and. .not. all(abs(change) <= huge(1.0_dp))) then
                status = status_non_finite
            end if
            if (status == status_ok .and. sloped) then
                call work%evaluate(formulation, work%y + (change + work%rest), slope, status)
            end if
            if (status /= status_outside) exit
            work%grid = off_grid
            work%counts%rejected = work%counts%rejected + 1
            h = h / 2
            if (h <= 2 * spacing(work%t)) status = status_step_too_small
            if (status == status_step_too_small) exit
        end do
        if (status /= status_ok) return
        call work%settle_change(formulation, t_new, change, changed)
        if (.not. sloped) return
        if (changed) call work%evaluate(formulation, work%y, slope, status)
        work%slope = slope
    end subroutine advance_on_grid

    !> Time of the grid point that a run in so many steps of fixed size has reached, without summing steps.
    pure real(dp) function grid_time(work, steps)
        class(workspace_t), intent(in) :: work
        integer, intent(in) :: steps
        grid_time = work%t_end
        if (work%grid < steps) then
            grid_time = work%t_begin + (work%t_end - work%t_begin) * work%grid / steps
        end if
    end function grid_time

    !> The state at a time within the last step, to the order of the method (at least 4, at most 8).
    function interpolate(self, formulation, work, t) result(y)
        class(fixed_step_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        real(dp), intent(in) :: t
        real(dp) :: y(max_states)
        integer :: status

        y = work%y
        if (t >= work%t) return
        select type (work)
        class is (grid_workspace_t)
            if (.not. is_equal(work%t_fitted, work%t)) then
                if (.not. self%starts_from_slope()) then
                    call work%evaluate(formulation, work%y_last, work%slope_last, status)
                    call work%evaluate(formulation, work%y, work%slope, status)
                end if
                call work%dense%set_order(self%order())
                call work%dense%fit(formulation, work, work%slope_last)
                work%t_fitted = work%t
            end if
            y = work%dense%at((t - work%t_last) / (work%t - work%t_last))
        end select
    end function interpolate

end module spintop_fixed_step
