!> Explicit Runge-Kutta methods by their Butcher tables: with a fixed step size, and the adaptive Dormand-Prince pair 5(4) with
!> MATLAB's step control, ode45.
module spintop_runge_kutta
    use spintop_kinds, only: dp, is_finite
    use spintop_fixed_step, only: fixed_step_t, longest_step
    use spintop_formulation, only: max_states
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_step_too_small
    use spintop_stepper, only: run_state_t, smallest_step, stepper_t
    implicit none
    private
    public :: butcher_t, max_stages, explicit_table, classical_table, dormand_prince_table, runge_kutta_t, ode45_t, &
        stage_sum

    !> Maximum number of stages of a table.
    integer, parameter :: max_stages = 7

    !> Coefficients of an explicit Runge-Kutta method
    !> k_i = f(t + c_i h, y + h sum_j a_ij k_j), y+ = y + h sum_i b_i k_i.
    type :: butcher_t
        integer :: stages = 0
        integer :: order = 0
        !> a(j, i) multiplies k_j in stage i: columns are stages.
        real(dp) :: a(max_stages, max_stages) = 0
        real(dp) :: b(max_stages) = 0
        !> Where the stages lie in the step.
        real(dp) :: c(max_stages) = 0
        !> b minus the weights of the embedded method; zero if there is none.
        real(dp) :: error(max_stages) = 0
        !> Dense output: the weight of k_i at the fraction s of a step is sum_p dense(p, i) s^p.
        real(dp) :: dense(4, max_stages) = 0
    end type butcher_t

    !> An explicit Runge-Kutta method given by its Butcher table.
    type, extends(fixed_step_t) :: runge_kutta_t
        type(butcher_t) :: table
    contains
        procedure :: step
    end type runge_kutta_t

    !> An embedded Runge-Kutta pair whose last stage is the first one of the next step.
    type, extends(stepper_t) :: ode45_t
        type(butcher_t) :: table
        real(dp) :: k(max_states, max_stages) = 0
    contains
        procedure :: begin => begin_ode45
        procedure :: advance => advance_ode45
        procedure :: state_within => state_within_ode45
    end type ode45_t

    !> Largest step relative to the span.
    real(dp), parameter :: largest_share = 0.1_dp

contains

    !> The table of a method whose rows below the first are given one after another: a stage lies where the sum of its row puts
    !> it.
    pure type(butcher_t) function explicit_table(order, rows, b) result(table)
        integer, intent(in) :: order !! order of the method
        real(dp), intent(in) :: rows(:), b(:) !! a21, a31, a32, ..., and the weights of the stages
        integer :: i, before
        table%stages = size(b)
        table%order = order
        table%b(:size(b)) = b
        before = 0
        do i = 2, size(b)
            table%a(:i - 1, i) = rows(before + 1:before + i - 1)
            table%c(i) = sum(table%a(:i - 1, i))
            before = before + i - 1
        end do
    end function explicit_table

    !> The classical Runge-Kutta method (Kutta 1901).
    pure type(butcher_t) function classical_table() result(table)
        table = explicit_table(4, [0.5_dp, 0.0_dp, 0.5_dp, 0.0_dp, 0.0_dp, 1.0_dp], [1, 2, 2, 1] / 6.0_dp)
    end function classical_table

    !> The Dormand-Prince pair 5(4) (J. Comp. Appl. Math. 6, 1980) with the interpolant of order 4 of Shampine
    !> (Math. Comp. 46, 1986), as in MATLAB's ode45. The last stage is the first one of the next step.
    pure type(butcher_t) function dormand_prince_table() result(table)
        table%stages = 7
        table%order = 5
        table%a(1:1, 2) = [1.0_dp / 5]
        table%a(1:2, 3) = [3.0_dp / 40, 9.0_dp / 40]
        table%a(1:3, 4) = [44.0_dp / 45, -56.0_dp / 15, 32.0_dp / 9]
        table%a(1:4, 5) = [19372.0_dp / 6561, -25360.0_dp / 2187, 64448.0_dp / 6561, -212.0_dp / 729]
        table%a(1:5, 6) = [9017.0_dp / 3168, -355.0_dp / 33, 46732.0_dp / 5247, 49.0_dp / 176, &
                           -5103.0_dp / 18656]
        table%a(1:6, 7) = [35.0_dp / 384, 0.0_dp, 500.0_dp / 1113, 125.0_dp / 192, &
                           -2187.0_dp / 6784, 11.0_dp / 84]
        table%b = table%a(:, 7)
        table%c = [0.0_dp, 1.0_dp / 5, 3.0_dp / 10, 4.0_dp / 5, 8.0_dp / 9, 1.0_dp, 1.0_dp]
        table%error = [71.0_dp / 57600, 0.0_dp, -71.0_dp / 16695, 71.0_dp / 1920, &
                       -17253.0_dp / 339200, 22.0_dp / 525, -1.0_dp / 40]
        table%dense(:, 1) = [1.0_dp, -183.0_dp / 64, 37.0_dp / 12, -145.0_dp / 128]
        table%dense(:, 3) = [0.0_dp, 1500.0_dp / 371, -1000.0_dp / 159, 1000.0_dp / 371]
        table%dense(:, 4) = [0.0_dp, -125.0_dp / 32, 125.0_dp / 12, -375.0_dp / 64]
        table%dense(:, 5) = [0.0_dp, 9477.0_dp / 3392, -729.0_dp / 106, 25515.0_dp / 6784]
        table%dense(:, 6) = [0.0_dp, -11.0_dp / 7, 11.0_dp / 3, -55.0_dp / 28]
        table%dense(:, 7) = [0.0_dp, 3.0_dp / 2, -4.0_dp, 5.0_dp / 2]
    end function dormand_prince_table

    !> One step of the method.
    subroutine step(self, h, change, status)
        class(runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: k(max_states, max_stages), y(max_states)
        change = 0
        call find_stages(self%run_state_t, self%table, h, k, y, status)
        if (is_ok(status)) change = h * stage_sum(k, self%table%b, self%table%stages)
    end subroutine step

    !> The stages of a step of size h, of which the first is the known slope, and the state of the last one.
    subroutine find_stages(run, table, h, k, y, status)
        class(run_state_t), intent(inout) :: run
        type(butcher_t), intent(in) :: table
        real(dp), intent(in) :: h
        real(dp), intent(inout) :: k(max_states, max_stages)
        real(dp), intent(out) :: y(max_states)
        integer, intent(out) :: status
        integer :: i
        status = status_ok
        y = run%y
        k(:, 1) = run%slope
        do i = 2, table%stages
            y = run%y + h * stage_sum(k, table%a(:, i), i - 1)
            call run%evaluate(run%t + table%c(i) * h, y, k(:, i), status)
            if (.not. is_ok(status)) return
        end do
    end subroutine find_stages

    !> Sum of the first n stages with the weights given.
    pure function stage_sum(k, weight, n) result(total)
        integer, intent(in) :: n !! number of stages
        real(dp), intent(in) :: k(max_states, n), weight(n) !! slopes at the stages, and their weights
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
    end function stage_sum

    !> First slope and MATLAB's first step size.
    subroutine begin_ode45(self, status)
        class(ode45_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: steepest

        call self%set_weight(self%controls%relative_tolerance, self%controls%absolute_tolerance)
        call self%evaluate(self%t, self%y, self%slope, status)
        if (.not. is_ok(status)) return
        self%h = largest_share * (self%t_end - self%t_begin)
        steepest = maxval(abs(self%slope) / max(abs(self%y), self%weight%threshold)) &
                   / (0.8_dp * self%controls%relative_tolerance**(1.0_dp / self%table%order))
        if (self%h * steepest > 1) self%h = 1 / steepest
    end subroutine begin_ode45

    !> One accepted step; rejected steps are counted.
    subroutine advance_ode45(self, status)
        class(ode45_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, h_smallest, h_left, t_new, y_new(max_states), error, growth, power
        logical :: first_trial, changed

        power = 1.0_dp / self%table%order
        h_smallest = smallest_step(0.0_dp, self%t)
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
            call find_stages(self%run_state_t, self%table, h, self%k, y_new, status)
            error = huge(1.0_dp)
            if (is_ok(status)) then
                ! In units in which the relative tolerance is the limit.
                error = h * maxval(abs(stage_sum(self%k, self%table%error, self%table%stages)) &
                                   / max(abs(self%y), abs(y_new), self%weight%threshold))
                if (.not. is_finite(error)) status = status_non_finite
            end if
            if (is_ok(status) .and. error <= self%controls%relative_tolerance) exit
            self%counts%rejected = self%counts%rejected + 1
            if (h <= h_smallest) then
                if (is_ok(status)) status = status_step_too_small
                return
            end if
            if (.not. is_ok(status)) then
                self%h = h / 2
            else if (first_trial) then
                self%h = h * max(0.1_dp, 0.8_dp * (self%controls%relative_tolerance / error)**power)
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
            growth = 1.25_dp * (error / self%controls%relative_tolerance)**power
            self%h = h / max(growth, 0.2_dp)
        end if
    end subroutine advance_ode45

    !> Dense output of order 4 within the last step.
    function state_within_ode45(self, t) result(y)
        class(ode45_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), s, weight(max_stages)
        s = (t - self%t_last) / (self%t - self%t_last)
        weight = matmul(s**[1, 2, 3, 4], self%table%dense)
        y = self%y_last + (self%t - self%t_last) &
            * stage_sum(self%k, weight, self%table%stages)
    end function state_within_ode45

end module spintop_runge_kutta
