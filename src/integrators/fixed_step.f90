!> Methods with a fixed step size.
module spintop_fixed_step
    use spintop_kinds, only: dp, is_equal
    use spintop_formulation, only: formulation_t, max_states, structure_split
    use spintop_lapack, only: dgetrf, dgetrs
    use spintop_status, only: is_ok, status_non_finite, status_outside, status_step_too_small
    use spintop_stepper, only: run_state_t, stepper_t
    implicit none
    private
    public :: grid_stepper_t, fixed_step_t, begin_on_grid, advance_on_grid, grid_time, longest_step

    !> Highest level, and degree of its polynomial.
    integer, parameter :: max_level = 4, max_degree = max_level + 3
    !> Maximum number of coefficients that are determined by the conditions at the nodes and at the end of the
    !> step.
    integer, parameter :: max_unknowns = max_level + 2

    !> The polynomial of one step, and the factors for its computation.
    type :: dense_output_t
        !> Highest level in use; -1 before the order of the method is known.
        integer :: level = -1
        !> Factors of the conditions of each level.
        real(dp) :: factors(max_unknowns, max_unknowns, 0:max_level) = 0
        integer :: pivots(max_unknowns, 0:max_level) = 0
        !> The polynomial is sum_k coefficient(:, k) s^k, with s = 0 .. 1 over the step.
        real(dp) :: coefficient(max_states, 0:max_degree) = 0
        integer :: degree = 3
    contains
        procedure :: set_order
        procedure :: fit
        procedure :: at
    end type dense_output_t

    !> Value of `grid` for a run that has left the grid of fixed step size.
    integer, parameter :: off_grid = -1
    !> Near the end of its equations a run steps by at most this fraction of the time left.
    real(dp), parameter :: share_of_time_left = 0.25_dp

    !> A method that can follow the grid t_begin + n (t_end - t_begin)/steps. It keeps the polynomial of the last step after dense
    !> output was needed.
    type, extends(stepper_t), abstract :: grid_stepper_t
        type(dense_output_t) :: dense = dense_output_t()
        !> End of the step to which the polynomial belongs, s.
        real(dp) :: t_fitted = -huge(1.0_dp)
    contains
        procedure :: begin => begin_on_grid
        procedure :: advance => advance_on_grid
        procedure(try_step), deferred :: try_step
        procedure :: state_within
    end type grid_stepper_t

    !> A method with one step formula.
    type, extends(grid_stepper_t), abstract :: fixed_step_t
    contains
        procedure :: try_step => try_formula
        procedure(step), deferred :: step
    end type fixed_step_t

    abstract interface
        !> A step of the size `h` to the time `t_new`. After `status_outside`, which leaves the state as it is,
        !> a shorter one is tried.
        subroutine try_step(self, h, t_new, status)
            import :: grid_stepper_t, formulation_t, dp
            class(grid_stepper_t), intent(inout) :: self
            real(dp), intent(in) :: h, t_new !! size of the step, and the time at its end, s
            integer, intent(out) :: status !! `status_ok`, or why there is no such step
        end subroutine try_step

        !> Change of the state over a time `h`. `slope` is the slope for methods whose steps start from it.
        subroutine step(self, h, change, status)
            import :: fixed_step_t, formulation_t, dp, max_states
            class(fixed_step_t), intent(inout) :: self
            real(dp), intent(in) :: h !! step size, s
            real(dp), intent(out) :: change(max_states) !! change of the state
            integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        end subroutine step
    end interface

contains

    !> Prepares for a method of an order: the error within a step gets the same order.
    subroutine set_order(self, order)
        class(dense_output_t), intent(inout) :: self
        integer, intent(in) :: order !! order of the method
        integer :: level, node, k, failure

        self%level = max(0, min(order - 4, max_level))
        do level = 0, self%level
            associate (conditions => self%factors(:, :, level))
                ! The unknowns are the coefficients of s^2, s^3, ...: row 1 is the value at the end, row 2 the
                ! slope at the end, the other rows are the slopes inside.
                conditions(1, 1:level + 2) = 1
                do k = 2, level + 3
                    conditions(2, k - 1) = k
                    do node = 1, level
                        conditions(node + 2, k - 1) = k * place(node, level)**(k - 1)
                    end do
                end do
            end associate
            call dgetrf(level + 2, level + 2, self%factors(:, :, level), max_unknowns, &
                        self%pivots(:, level), failure)
        end do
    end subroutine set_order

    !> Position of a node in the step. An odd number of nodes is shifted: for symmetric nodes the slopes alone
    !> would determine the value at the end (Simpson's rule), and the conditions would be dependent.
    pure real(dp) function place(node, level)
        integer, intent(in) :: node, level
        place = (node - mod(level, 2) / 3.0_dp) / (level + 1)
    end function place

    !> Computes the polynomial of the last step of `run`, which began with the slope `slope_last`. If a slope
    !> inside does not exist, the degree reached so far is kept.
    subroutine fit(self, run, slope_last)
        class(dense_output_t), intent(inout) :: self
        class(run_state_t), intent(inout) :: run !! state of the run
        real(dp), intent(in) :: slope_last(max_states) !! slope at the beginning of the step
        real(dp) :: h, slope(max_states), conditions(max_unknowns, max_states)
        integer :: level, node, status, failure

        h = run%t - run%t_last
        self%coefficient = 0
        self%coefficient(:, 0) = run%y_last
        self%coefficient(:, 1) = h * slope_last
        do level = 0, self%level
            conditions(1, :) = run%y - run%y_last - h * slope_last
            conditions(2, :) = h * (run%slope - slope_last)
            do node = 1, level
                call run%evaluate(run%t_last + h * place(node, level), &
                                   self%at(place(node, level)), slope, status)
                if (.not. is_ok(status)) return
                conditions(node + 2, :) = h * (slope - slope_last)
            end do
            call dgetrs('N', level + 2, max_states, self%factors(:, :, level), max_unknowns, &
                        self%pivots(:, level), conditions, max_unknowns, failure)
            self%degree = level + 3
            self%coefficient(:, 2:self%degree) = transpose(conditions(1:level + 2, :))
        end do
    end subroutine fit

    !> The state at a fraction of the step.
    pure function at(self, fraction) result(y)
        class(dense_output_t), intent(in) :: self
        real(dp), intent(in) :: fraction !! position in the step, from 0 to 1
        real(dp) :: y(max_states)
        integer :: k
        y = self%coefficient(:, self%degree)
        do k = self%degree - 1, 0, -1
            y = y * fraction + self%coefficient(:, k)
        end do
    end function at

    !> Whether steps start from the slope; those by drift and kick do not, whose slopes are evaluated for dense output only.
    pure logical function starts_from_slope(self)
        class(grid_stepper_t), intent(in) :: self
        starts_from_slope = self%info%needs /= structure_split
    end function starts_from_slope

    !> Evaluates the first slope and, for a fixed step size, sets the size.
    subroutine begin_on_grid(self, status)
        class(grid_stepper_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        if (self%controls%steps > 0) self%h = (self%t_end - self%t_begin) / self%controls%steps
        self%t_fitted = -huge(self%t)
        self%dense%level = -1
        call self%evaluate(self%t, self%y, self%slope, status)
    end subroutine begin_on_grid

    !> One step: on the grid, or ever shorter ones where the equations end.
    subroutine advance_on_grid(self, status)
        class(grid_stepper_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, t_new

        h = min(self%h, longest_step(self%formulation, self%y))
        if (h < self%h) self%grid = off_grid
        do
            if (self%grid == off_grid) then
                t_new = min(self%t + h, self%t_end)
                h = t_new - self%t
            else
                self%grid = self%grid + 1
                t_new = grid_time(self)
            end if
            call self%try_step(h, t_new, status)
            if (status /= status_outside) return
            self%grid = off_grid
            h = h / 2
            if (h <= 2 * spacing(self%t)) exit
        end do
        status = status_step_too_small
    end subroutine advance_on_grid

    !> Longest step from a state: near the end of its equations, if they have one, a share of the time left.
    pure real(dp) function longest_step(formulation, y)
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(in) :: y(max_states) !! state
        longest_step = huge(longest_step)
        if (formulation%has_ends) longest_step = share_of_time_left * formulation%time_left(y)
    end function longest_step

    !> A step by the formula of the method. A method that starts from the slope needs one at the end, too.
    subroutine try_formula(self, h, t_new, status)
        class(fixed_step_t), intent(inout) :: self
        real(dp), intent(in) :: h, t_new !! step size, s, and time at its end, s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: change(max_states), slope(max_states)
        logical :: changed, sloped

        sloped = starts_from_slope(self)
        call self%step(h, change, status)
        ! Not with is_finite, as in `evaluate`.
        if (is_ok(status) .and. .not. all(abs(change) <= huge(1.0_dp))) status = status_non_finite
        if (is_ok(status) .and. sloped) call self%evaluate(t_new, self%y + (change + self%rest), slope, status)
        if (status == status_outside) self%counts%rejected = self%counts%rejected + 1
        if (.not. is_ok(status)) return
        call self%accept_change(t_new, change, changed)
        if (.not. sloped) return
        if (changed) call self%evaluate(t_new, self%y, slope, status)
        self%slope = slope
    end subroutine try_formula

    !> Time of the current grid point of a run with so many steps of fixed size, computed without summing
    !> steps.
    pure real(dp) function grid_time(self)
        class(stepper_t), intent(in) :: self !! the stepper, with its grid
        associate (steps => self%controls%steps)
            grid_time = self%t_end
            if (self%grid < steps) grid_time = self%t_begin + (self%t_end - self%t_begin) * self%grid / steps
        end associate
    end function grid_time

    !> The state within the last step, to the order of the method (at least 4, at most 8). The polynomial is fitted once.
    function state_within(self, t) result(y)
        class(grid_stepper_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        integer :: status

        if (.not. is_equal(self%t_fitted, self%t)) then
            if (.not. starts_from_slope(self)) then
                call self%evaluate(self%t_last, self%y_last, self%slope_last, status)
                call self%evaluate(self%t, self%y, self%slope, status)
            end if
            if (self%dense%level < 0) call self%dense%set_order(self%order())
            call self%dense%fit(self%run_state_t, self%slope_last)
            self%t_fitted = self%t
        end if
        y = self%dense%at((t - self%t_last) / (self%t - self%t_last))
    end function state_within

end module spintop_fixed_step
