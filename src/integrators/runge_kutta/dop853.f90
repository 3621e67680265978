!> The Dormand-Prince method of order 8 with error estimate, step control and dense output: DOP853 of Hairer,
!> Norsett and Wanner (Solving Ordinary Differential Equations I, 2nd edition, 1993, sections II.4 to II.6);
!> also with a fixed step size.
!>
!> The state is summed with compensation, so that small steps at tight tolerances lose no digits.
module spintop_dop853
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp
    use spintop_dop853_table, only: dop853_table_t, main_stages, new_slope, all_stages
    use spintop_fixed_step, only: fixed_step_t, advance_on_grid, begin_on_grid, longest_step
    use spintop_formulation, only: formulation_info_t, max_aside, max_states
    use spintop_motions, only: instants
    use spintop_runge_kutta, only: stage_sum
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_step_too_small
    use spintop_stepper, only: run_state_t, smallest_step
    implicit none
    private
    public :: dop853_t

    !> Fraction of the step that the error estimate allows, and bounds of its change from step to step.
    real(dp), parameter :: safety = 0.9_dp, largest_growth = 6, largest_cut = 1.0_dp / 3
    !> Power of the error estimate in the step size.
    real(dp), parameter :: power = 8
    !> By which powers of the error of a step, and of that before it, the next one changes: the control that DOP853 offers
    !> with BETA = 0.04 (section IV.2 of volume II). Without the second one, a step in five of a body that spins fast is
    !> rejected.
    real(dp), parameter :: by_last_error = 0.04_dp, by_error = 1 / power - 0.2_dp * by_last_error
    !> Logarithm to base 2 of the least error before a step that counts, 1e-4; also that before the first step.
    real(dp), parameter :: least_error = -13.287712379549449_dp

    !> The method, with its coefficients.
    type, extends(fixed_step_t) :: dop853_t
        type(dop853_table_t) :: table
        real(dp) :: k(max_states, all_stages) = 0
        !> What stages that are found at once leave for those after them.
        real(dp) :: aside(max_aside, all_stages) = 0
        !> Terms of the dense output, once it was needed in the last step.
        real(dp) :: term(max_states, 8) = 0
        logical :: has_terms = .false.
        !> Number of components in use: the error is their root mean square.
        integer :: states = max_states
        !> Logarithm to base 2 of the error of the last step, in units of the tolerance.
        real(dp) :: last_error = least_error
    contains
        procedure :: begin
        procedure :: advance
        procedure :: step
        procedure :: state_within
        procedure :: states_within
    end type dop853_t

    interface
        !> The change of the state over a step, the state after it, the logarithm of its error, and by which factor the next
        !> step is larger.
        real(c_double) function c_sum(since, stages, weights, k, y, rest, h, absolute, relative, states, most, share, &
                                      change, y_new, growth) bind(C, name='spintop_sum_stages')
            import :: c_double, c_int
            integer(c_int), value :: since, stages, states
            real(c_double), value :: h, most, share
            real(c_double), intent(in) :: weights(*), k(*), y(*), rest(*), absolute(*), relative(*)
            real(c_double), intent(out) :: change(*), y_new(*), growth
        end function c_sum
    end interface

contains

    !> First slope and, unless the step size is fixed, first step size.
    subroutine begin(self, status)
        class(dop853_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(formulation_info_t) :: info

        self%has_terms = .false.
        self%last_error = least_error
        info = self%formulation%info()
        self%states = info%states
        call self%set_weight()
        call begin_on_grid(self, status)
        if (self%controls%steps == 0 .and. is_ok(status)) then
            self%h = first_step(self)
        end if
    end subroutine begin

    !> A step for which Euler's method has an error of about 1% of the state; then, from the curvature found
    !> with it, one for the order of this method. Times are relative to the time in which the state would
    !> change by its scale, so that the unit of time does not matter, nor that a variable is zero at the start.
    real(dp) function first_step(run) result(h)
        class(run_state_t), intent(inout) :: run
        real(dp), parameter :: share = 0.01_dp
        real(dp) :: span, allowed(max_states), slope(max_states), size, steepness, unit, bend
        integer :: status

        span = run%t_end - run%t
        h = span
        allowed = run%weight%allowed(run%weight%scale, run%weight%scale)
        size = norm2(run%weight%scale / allowed)
        steepness = norm2(run%slope / allowed)
        if (.not. steepness > 0) return
        unit = size / steepness
        h = min(share * unit, span)
        call run%evaluate(run%t + h, run%y + h * run%slope, slope, status)
        if (.not. is_ok(status)) return
        bend = max(norm2((slope - run%slope) / allowed) / h * unit**2, size)
        h = min(span, 100 * h, unit * (share / bend)**(1 / power))
    end function first_step

    !> One step: of the grid, or of a size that the error estimate accepts; rejected steps are counted.
    subroutine advance(self, status)
        class(dop853_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, h_smallest, h_left, t_new, error, growth
        real(dp), dimension(max_states) :: change, y_new, slope
        logical :: was_rejected, changed, at_once

        self%has_terms = .false.
        if (self%controls%steps > 0) then
            call advance_on_grid(self, status)
            return
        end if
        at_once = self%formulation%has_stages
        h_left = longest_step(self%formulation, self%y)
        h_smallest = smallest_step(self%h, self%t)
        self%h = max(self%h, h_smallest)
        was_rejected = .false.
        do
            h = min(self%h, h_left)
            t_new = self%t + h
            ! A step that nearly reaches the end is stretched to the end.
            if (1.01_dp * h >= self%t_end - self%t .and. h < h_left) t_new = self%t_end
            t_new = min(t_new, self%t_end)
            h = t_new - self%t
            self%k(:, 1) = self%slope
            call find_stages(self, self%t, self%y, h, 2, merge(new_slope, main_stages, at_once), status)
            error = 0
            if (is_ok(status)) then
                associate (w => self%weight)
                    error = c_sum(self%table%since(new_slope), main_stages, self%table%sums, self%k, self%y, self%rest, h, &
                                  w%absolute, w%relative, self%states, by_last_error * self%last_error, by_error, &
                                  change, y_new, growth)
                end associate
                if (.not. error <= huge(error)) status = status_non_finite
            end if
            ! The slope at the new state must exist: it begins the next step.
            if (is_ok(status) .and. error <= 0) then
                slope = self%k(:, new_slope)
                if (.not. at_once) call self%evaluate(t_new, y_new, slope, status)
            end if
            if (is_ok(status) .and. error <= 0) exit
            self%counts%rejected = self%counts%rejected + 1
            h_smallest = smallest_step(h, self%t)
            if (h <= h_smallest) then
                if (is_ok(status)) status = status_step_too_small
                return
            end if
            growth = 0.5_dp
            if (is_ok(status)) growth = max(largest_cut, safety * 2**(-by_error * error))
            self%h = max(h * growth, h_smallest)
            was_rejected = .true.
        end do
        call self%accept_change(t_new, change, changed)
        self%slope = slope
        if (changed) call self%evaluate(self%t, self%y, self%slope, status)
        growth = min(largest_growth, max(largest_cut, safety * growth))
        if (was_rejected) growth = min(growth, 1.0_dp)
        self%h = h * growth
        self%last_error = max(error, least_error)
    end subroutine advance

    !> The stages of a step of size h, and the change of the state over it.
    subroutine step(self, h, change, status)
        class(dop853_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        change = 0
        status = status_ok
        self%k(:, 1) = self%slope
        call find_stages(self, self%t, self%y, h, 2, main_stages, status)
        if (.not. is_ok(status)) return
        change = h * (stage_sum(self%k, self%table%b, main_stages) &
                      + stage_sum(self%k, self%table%b_rest, main_stages))
    end subroutine step

    !> Stages of a step of size h from a time and a state: at once where the formulation offers this.
    subroutine find_stages(self, t, y, h, from, to, status)
        class(dop853_t), intent(inout) :: self
        real(dp), intent(in) :: t, y(max_states), h
        integer, intent(in) :: from, to
        integer, intent(out) :: status
        real(dp) :: stage(max_states)
        integer :: i

        status = status_ok
        if (self%formulation%has_stages) then
            call self%formulation%find_stages(from, to, t, y, h, all_stages, self%table%a, self%table%since, self%table%c, &
                                         self%k, self%aside)
            self%counts%evaluations = self%counts%evaluations + (to - from + 1)
            ! What is no number in a stage is none in those after it.
            if (.not. is_finite(self%k(:, to))) status = status_non_finite
            return
        end if
        do i = from, to
            stage = y + h * stage_sum(self%k, self%table%a(:, i), i - 1)
            call self%evaluate(t + self%table%c(i) * h, stage, self%k(:, i), status)
            if (.not. is_ok(status)) return
        end do
    end subroutine find_stages

    !> Whether all components are finite: no difference of one from itself is NaN.
    pure logical function is_finite(x)
        real(dp), intent(in) :: x(max_states)
        real(dp) :: zero(max_states)
        zero = x - x
        is_finite = ((zero(1) + zero(5)) + (zero(2) + zero(6))) + ((zero(3) + zero(7)) + (zero(4) + zero(8))) >= 0
    end function is_finite

    !> Dense output of order 7 within the last step.
    function state_within(self, t) result(y)
        class(dop853_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), s
        integer :: i

        y = self%y
        if (.not. self%has_terms) call find_terms(self)
        s = (t - self%t_last) / (self%t - self%t_last)
        y = 0
        do i = 8, 1, -1
            y = self%term(:, i) + y * merge(s, 1 - s, mod(i, 2) == 1)
        end do
    end function state_within

    !> The same at several times, all by the same instructions.
    subroutine states_within(self, t, y)
        class(dop853_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times, s
        real(dp), intent(out) :: y(instants, max_states) !! states
        real(dp) :: s(instants), left(instants), c(8)
        integer :: m

        y = 0
        if (.not. self%has_terms) call find_terms(self)
        s = (t - self%t_last) / (self%t - self%t_last)
        left = 1 - s
        do m = 1, max_states
            c = self%term(m, :)
            y(:, m) = c(1) + s * (c(2) + left * (c(3) + s * (c(4) + left * (c(5) &
                      + s * (c(6) + left * (c(7) + s * c(8)))))))
        end do
    end subroutine states_within

    !> The terms of the dense output of the last step, with three more stages. If one of these does not exist,
    !> the cubic Hermite polynomial is used.
    subroutine find_terms(self)
        class(dop853_t), intent(inout) :: self
        real(dp) :: h
        integer :: i, from, status

        h = self%t - self%t_last
        self%has_terms = .true.
        self%k(:, new_slope) = self%slope
        self%term(:, 1) = self%y_last
        self%term(:, 2) = self%y - self%y_last
        self%term(:, 3) = h * self%k(:, 1) - self%term(:, 2)
        self%term(:, 4) = self%term(:, 2) - h * self%slope - self%term(:, 3)
        self%term(:, 5:8) = 0
        ! Stages that are found at once depend on what that of the slope leaves aside, which was not found on a grid.
        from = new_slope + 1
        if (self%controls%steps > 0 .and. self%formulation%has_stages) from = new_slope
        call find_stages(self, self%t_last, self%y_last, h, from, all_stages, status)
        if (.not. is_ok(status)) return
        do i = 1, 4
            self%term(:, 4 + i) = h * stage_sum(self%k, self%table%dense(:, i), all_stages)
        end do
    end subroutine find_terms

end module spintop_dop853
