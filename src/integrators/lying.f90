!> The stepper of a body that lies still under dry friction: it keeps the attitude until other torques exceed the friction.
module spintop_lying
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_status, only: status_ok
    use spintop_stepper, only: stepper_t, workspace_t
    implicit none
    private
    public :: lying_t

    !> Rest: the attitude is kept.
    type, extends(stepper_t) :: lying_t
    contains
        procedure :: new_workspace
        procedure :: begin => begin_rest
        procedure :: advance => lie
        procedure :: state_within
    end type lying_t

contains

    !> A workspace.
    subroutine new_workspace(self, work)
        class(lying_t), intent(in) :: self
        class(workspace_t), allocatable, intent(out) :: work !! workspace of the type that the method needs
        associate (unused => self)
        end associate
        allocate (workspace_t :: work)
    end subroutine new_workspace

    !> Nothing to prepare.
    subroutine begin_rest(self, formulation, work, status)
        class(lying_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        associate (unused => self, also_unused => formulation)
        end associate
        work%slope = 0
        status = status_ok
    end subroutine begin_rest

    !> Lies still until the torques exceed the friction, or to the end; with a fixed step size over one step.
    subroutine lie(self, formulation, work, status)
        class(lying_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: t, peak

        t = work%t_end
        if (formulation%action%may_slip) then
            t = min(t, work%t + formulation%action%pause(work%t))
            peak = t
            if (.not. excess(formulation, work%y, t) > 0) peak = highest(formulation, work%y, work%t, t)
            if (excess(formulation, work%y, peak) > 0) t = root(formulation, work%y, work%t, peak)
        end if
        if (self%controls%steps > 0) then
            work%grid = work%grid + 1
            t = work%t_end
            if (work%grid < self%controls%steps) t = work%t_begin + (work%t_end - work%t_begin) * work%grid / self%controls%steps
        end if
        work%t_last = work%t
        work%y_last = work%y
        work%y = formulation%action%at_rest(t, work%y, 0.0_dp)
        work%t = t
        work%counts%steps = work%counts%steps + 1
        status = status_ok
    end subroutine lie

    !> By how much the torques exceed the friction at a time, N m, with the attitude of a state.
    real(dp) function excess(formulation, y, time)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), time
        excess = formulation%action%excess(time, formulation%action%at_rest(time, y, 0.0_dp))
    end function excess

    !> The time between two times at which they exceed it most, by golden sections; the later one where a parabola has no peak
    !> between them that may reach the friction.
    real(dp) function highest(formulation, y, before, after)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), before, after
        real(dp), parameter :: golden = 0.61803398874989485_dp, resolved = 1.0e-8_dp
        real(dp) :: low, high, x(2), f(2), ends(2), middle, bend

        highest = after
        ends = [excess(formulation, y, before), excess(formulation, y, after)]
        middle = excess(formulation, y, before + (after - before) / 2)
        bend = 2 * middle - sum(ends)
        if (.not. abs(ends(2) - ends(1)) < 2 * bend .or. middle + bend < 0) return
        low = before
        high = after
        x = [high - golden * (high - low), low + golden * (high - low)]
        f = [excess(formulation, y, x(1)), excess(formulation, y, x(2))]
        do while (high - low > resolved * (after - before))
            if (f(1) < f(2)) then
                low = x(1)
                x = [x(2), low + golden * (high - low)]
                f = [f(2), excess(formulation, y, x(2))]
            else
                high = x(2)
                x = [high - golden * (high - low), x(1)]
                f = [excess(formulation, y, x(1)), f(1)]
            end if
            if (.not. (x(1) > low .and. x(2) < high)) exit
        end do
        highest = x(merge(1, 2, f(1) > f(2)))
    end function highest

    !> The first time at which they exceed it between two times, of which they do at the second, by bisection, just beyond.
    real(dp) function root(formulation, y, before, after)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), before, after
        real(dp) :: low, middle
        low = before
        root = after
        do
            middle = low + (root - low) / 2
            if (.not. (middle > low .and. middle < root)) exit
            if (excess(formulation, y, middle) > 0) then
                root = middle
            else
                low = middle
            end if
        end do
    end function root

    !> The state at rest.
    function state_within(self, formulation, work, t) result(y)
        class(lying_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        associate (unused => self)
        end associate
        y = formulation%action%at_rest(t, work%y_last, 0.0_dp)
    end function state_within

end module spintop_lying
