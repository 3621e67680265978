!> The Dormand-Prince method of order 8 with error estimate, step control and dense output: DOP853 of Hairer,
!> Norsett and Wanner (Solving Ordinary Differential Equations I, 2nd edition, 1993, sections II.4 to II.6);
!> also with a fixed step size.
!>
!> The state is summed with compensation, so that small steps at tight tolerances lose no digits.
module spintop_dop853
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_capabilities, only: max_aside
    use spintop_kinds, only: dp
    use spintop_dop853_table, only: dop853_table_t, main_stages, new_slope, all_stages
    use spintop_fixed_step, only: fixed_step_t, advance_on_grid, begin_on_grid, longest_step
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_motions, only: instants
    use spintop_status, only: status_ok, status_non_finite, status_step_too_small
    use spintop_stepper, only: workspace_t
    implicit none
    private
    public :: dop853_t

    !> Fraction of the step that the error estimate allows, and bounds of its change from step to step.
    real(dp), parameter :: safety = 0.9_dp, largest_growth = 6, largest_cut = 1.0_dp / 3
    !> Smallest step in units of the spacing of the time.
    real(dp), parameter :: smallest_spacings = 16
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
    contains
        procedure :: new_workspace
        procedure :: begin
        procedure :: advance
        procedure :: step
        procedure :: state_within
        procedure :: states_within
    end type dop853_t

    !> Keeps the stages of the last step for dense output.
    type, extends(workspace_t) :: dop853_workspace_t
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
    end type dop853_workspace_t

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

    !> A workspace with room for the stages.
    subroutine new_workspace(self, work)
        class(dop853_t), intent(in) :: self
        class(workspace_t), allocatable, intent(out) :: work !! workspace of the type that the method needs
        associate (unused => self)
        end associate
        allocate (dop853_workspace_t :: work)
    end subroutine new_workspace

    !> First slope and, unless the step size is fixed, first step size.
    subroutine begin(self, formulation, work, status)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(formulation_info_t) :: info

        select type (work)
        class is (dop853_workspace_t)
            work%has_terms = .false.
            work%last_error = least_error
            info = formulation%info()
            work%states = info%states
        end select
        call self%set_weight(formulation, work)
        call begin_on_grid(self, formulation, work, status)
        if (self%controls%steps == 0 .and. status == status_ok) then
            work%h = first_step(formulation, work)
        end if
    end subroutine begin

    !> A step for which Euler's method has an error of about 1% of the state; then, from the curvature found
    !> with it, one for the order of this method. Times are relative to the time in which the state would
    !> change by its scale, so that the unit of time does not matter, nor that a variable is zero at the start.
    real(dp) function first_step(formulation, work) result(h)
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        real(dp), parameter :: share = 0.01_dp
        real(dp) :: span, allowed(max_states), slope(max_states), size, steepness, unit, bend
        integer :: status

        span = work%t_end - work%t
        h = span
        allowed = work%weight%allowed(work%weight%scale, work%weight%scale)
        size = norm2(work%weight%scale / allowed)
        steepness = norm2(work%slope / allowed)
        if (.not. steepness > 0) return
        unit = size / steepness
        h = min(share * unit, span)
        call work%evaluate(formulation, work%t + h, work%y + h * work%slope, slope, status)
        if (status /= status_ok) return
        bend = max(norm2((slope - work%slope) / allowed) / h * unit**2, size)
        h = min(span, 100 * h, unit * (share / bend)**(1 / power))
    end function first_step

    !> One step: of the grid, or one that the error estimate accepts; rejected steps are counted.
    subroutine advance(self, formulation, work, status)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        select type (work)
        class is (dop853_workspace_t)
            work%has_terms = .false.
            if (self%controls%steps > 0) then
                call advance_on_grid(self, formulation, work, status)
            else
                call advance_adaptively(self, formulation, work, status)
            end if
        end select
    end subroutine advance

    !> A step of the size that the error estimate allows.
    subroutine advance_adaptively(self, formulation, work, status)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(dop853_workspace_t), intent(inout) :: work
        integer, intent(out) :: status
        real(dp) :: h, h_smallest, h_left, t_new, error, growth
        real(dp), dimension(max_states) :: change, y_new, slope
        logical :: was_rejected, changed, at_once

        at_once = finds_at_once(formulation)
        h_left = longest_step(formulation, work%y)
        h_smallest = smallest_step(work%h, work%t)
        work%h = max(work%h, h_smallest)
        was_rejected = .false.
        do
            h = min(work%h, h_left)
            t_new = work%t + h
            ! A step that nearly reaches the end is stretched to the end.
            if (1.01_dp * h >= work%t_end - work%t .and. h < h_left) t_new = work%t_end
            t_new = min(t_new, work%t_end)
            h = t_new - work%t
            work%k(:, 1) = work%slope
            call find_stages(self, formulation, work, work%t, work%y, h, 2, merge(new_slope, main_stages, at_once), status)
            error = 0
            if (status == status_ok) then
                associate (w => work%weight)
                    error = c_sum(self%table%since(new_slope), main_stages, self%table%sums, work%k, work%y, work%rest, h, &
                                  w%absolute, w%relative, work%states, by_last_error * work%last_error, by_error, &
                                  change, y_new, growth)
                end associate
                if (.not. error <= huge(error)) status = status_non_finite
            end if
            ! The slope at the new state must exist: it begins the next step.
            if (status == status_ok .and. error <= 0) then
                slope = work%k(:, new_slope)
                if (.not. at_once) call work%evaluate(formulation, t_new, y_new, slope, status)
            end if
            if (status == status_ok .and. error <= 0) exit
            work%counts%rejected = work%counts%rejected + 1
            h_smallest = smallest_step(h, work%t)
            if (h <= h_smallest) then
                if (status == status_ok) status = status_step_too_small
                return
            end if
            growth = 0.5_dp
            if (status == status_ok) growth = max(largest_cut, safety * 2**(-by_error * error))
            work%h = max(h * growth, h_smallest)
            was_rejected = .true.
        end do
        call work%settle_change(formulation, t_new, change, changed)
        work%slope = slope
        if (changed) call work%evaluate(formulation, work%t, work%y, work%slope, status)
        growth = min(largest_growth, max(largest_cut, safety * growth))
        if (was_rejected) growth = min(growth, 1.0_dp)
        work%h = h * growth
        work%last_error = max(error, least_error)
    end subroutine advance_adaptively

    !> Size of the smallest step at a time, exactly only if a step of size h might be smaller: `spacing` takes longer than
    !> the control of a step.
    pure real(dp) function smallest_step(h, t)
        real(dp), intent(in) :: h, t
        smallest_step = smallest_spacings * max(epsilon(t) * t, tiny(t))
        if (h <= smallest_step) smallest_step = smallest_spacings * spacing(t)
    end function smallest_step

    !> The stages of a step of size h, and the change of the state over it.
    subroutine step(self, formulation, work, h, change, status)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        change = 0
        status = status_ok
        select type (work)
        class is (dop853_workspace_t)
            work%k(:, 1) = work%slope
            call find_stages(self, formulation, work, work%t, work%y, h, 2, main_stages, status)
            if (status /= status_ok) return
            change = h * (weighted(work%k, self%table%b, main_stages) &
                          + weighted(work%k, self%table%b_rest, main_stages))
        end select
    end subroutine step

    !> Stages of a step of size h from a time and a state: at once where the formulation offers this.
    subroutine find_stages(self, formulation, work, t, y, h, from, to, status)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(dop853_workspace_t), intent(inout) :: work
        real(dp), intent(in) :: t, y(max_states), h
        integer, intent(in) :: from, to
        integer, intent(out) :: status
        real(dp) :: stage(max_states)
        integer :: i

        status = status_ok
        if (finds_at_once(formulation)) then
            call formulation%stages%find(from, to, t, y, h, all_stages, self%table%a, self%table%since, self%table%c, &
                                         work%k, work%aside)
            work%counts%evaluations = work%counts%evaluations + (to - from + 1)
            ! What is no number in a stage is none in those after it.
            if (.not. is_finite(work%k(:, to))) status = status_non_finite
            return
        end if
        do i = from, to
            stage = moved(y, h, work%k, self%table%a(:, i), i - 1)
            call work%evaluate(formulation, t + self%table%c(i) * h, stage, work%k(:, i), status)
            if (status /= status_ok) return
        end do
    end subroutine find_stages

    !> Whether all components are finite: no difference of one from itself is NaN.
    pure logical function is_finite(x)
        real(dp), intent(in) :: x(max_states)
        real(dp) :: zero(max_states)
        zero = x - x
        is_finite = ((zero(1) + zero(5)) + (zero(2) + zero(6))) + ((zero(3) + zero(7)) + (zero(4) + zero(8))) >= 0
    end function is_finite

    !> Whether a formulation finds all stages of a step in one call.
    pure logical function finds_at_once(formulation)
        class(formulation_t), intent(in) :: formulation
        finds_at_once = allocated(formulation%stages)
        if (finds_at_once) finds_at_once = formulation%stages%holds
    end function finds_at_once

    !> Sum of the first n stages with the weights given.
    pure function weighted(k, weight, n) result(total)
        real(dp), intent(in) :: k(max_states, all_stages), weight(all_stages)
        integer, intent(in) :: n
        real(dp) :: total(max_states)
        integer :: i, j
        total = 0
        do i = 1, n
            ! Without this order of loops gfortran vectorizes over the stages, which is three times slower.
            !$omp simd
            do j = 1, max_states
                total(j) = total(j) + weight(i) * k(j, i)
            end do
        end do
    end function weighted

    !> The state plus h times a weighted sum of the first n stages.
    pure function moved(y, h, k, weight, n) result(stage)
        real(dp), intent(in) :: y(max_states), h, k(max_states, all_stages), weight(all_stages)
        integer, intent(in) :: n
        real(dp) :: stage(max_states), total(max_states)
        integer :: j
        total = weighted(k, weight, n)
        !$omp simd
        do j = 1, max_states
            stage(j) = y(j) + h * total(j)
        end do
    end function moved

    !> Dense output of order 7 within the last step.
    function state_within(self, formulation, work, t) result(y)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), s
        integer :: i

        y = work%y
        select type (work)
        class is (dop853_workspace_t)
            if (.not. work%has_terms) call find_terms(self, formulation, work)
            s = (t - work%t_last) / (work%t - work%t_last)
            y = 0
            do i = 8, 1, -1
                y = work%term(:, i) + y * merge(s, 1 - s, mod(i, 2) == 1)
            end do
        end select
    end function state_within

    !> The same at several times, all by the same instructions.
    subroutine states_within(self, formulation, work, t, y)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        real(dp), intent(in) :: t(instants) !! times, s
        real(dp), intent(out) :: y(instants, max_states) !! states
        real(dp) :: s(instants), left(instants), c(8)
        integer :: m

        y = 0
        select type (work)
        class is (dop853_workspace_t)
            if (.not. work%has_terms) call find_terms(self, formulation, work)
            s = (t - work%t_last) / (work%t - work%t_last)
            left = 1 - s
            do m = 1, max_states
                c = work%term(m, :)
                y(:, m) = c(1) + s * (c(2) + left * (c(3) + s * (c(4) + left * (c(5) &
                          + s * (c(6) + left * (c(7) + s * c(8)))))))
            end do
        end select
    end subroutine states_within

    !> The terms of the dense output of the last step, with three more stages. If one of these does not exist,
    !> the cubic Hermite polynomial is used.
    subroutine find_terms(self, formulation, work)
        class(dop853_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(dop853_workspace_t), intent(inout) :: work
        real(dp) :: h
        integer :: i, from, status

        h = work%t - work%t_last
        work%has_terms = .true.
        work%k(:, new_slope) = work%slope
        work%term(:, 1) = work%y_last
        work%term(:, 2) = work%y - work%y_last
        work%term(:, 3) = h * work%k(:, 1) - work%term(:, 2)
        work%term(:, 4) = work%term(:, 2) - h * work%slope - work%term(:, 3)
        work%term(:, 5:8) = 0
        ! Stages that are found at once depend on what that of the slope leaves aside, which was not found on a grid.
        from = new_slope + 1
        if (self%controls%steps > 0 .and. finds_at_once(formulation)) from = new_slope
        call find_stages(self, formulation, work, work%t_last, work%y_last, h, from, all_stages, status)
        if (status /= status_ok) return
        do i = 1, 4
            work%term(:, 4 + i) = h * weighted(work%k, self%table%dense(:, i), all_stages)
        end do
    end subroutine find_terms

end module spintop_dop853
