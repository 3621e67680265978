!> The segment of a rest: a body that lies still under dry friction keeps its attitude until other torques exceed the friction.
module spintop_lying_still
    use spintop_fixed_step, only: grid_time
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_status, only: status_ok
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: resting_t

    !> Rest: the attitude is kept.
    type, extends(stepper_t) :: resting_t
    contains
        procedure :: begin => begin_rest
        procedure :: advance => lie
        procedure :: state_within
    end type resting_t

contains

    !> Brings the body to rest in its attitude.
    subroutine begin_rest(self, status)
        class(resting_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        self%y = self%formulation%action%at_rest(self%t, self%y, 0.0_dp)
        self%slope = 0
        status = status_ok
    end subroutine begin_rest

    !> Rests until the torques exceed the friction, or to the end; with a fixed step size over one step.
    subroutine lie(self, status)
        class(resting_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: t, peak

        t = self%t_end
        if (self%formulation%action%may_slip) then
            t = min(t, self%t + self%formulation%action%pause(self%t))
            peak = t
            if (.not. excess(self%formulation, self%y, t) > 0) peak = highest(self%formulation, self%y, self%t, t)
            if (excess(self%formulation, self%y, peak) > 0) t = root(self%formulation, self%y, self%t, peak)
        end if
        if (self%controls%steps > 0) then
            self%grid = self%grid + 1
            t = grid_time(self)
        end if
        self%t_last = self%t
        self%y_last = self%y
        self%y = self%formulation%action%at_rest(t, self%y, 0.0_dp)
        self%t = t
        self%counts%steps = self%counts%steps + 1
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
    function state_within(self, t) result(y)
        class(resting_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        y = self%formulation%action%at_rest(t, self%y_last, 0.0_dp)
    end function state_within

end module spintop_lying_still
