!> Explicit Runge-Kutta methods with a fixed step size, and Butcher tables, among them Dormand-Prince 5(4).
module spintop_runge_kutta
    use spintop_fixed_step, only: fixed_step_t
    use spintop_formulation, only: max_states
    use spintop_kinds, only: dp
    use spintop_status, only: is_ok, status_ok
    implicit none
    private
    public :: butcher_t, max_stages, explicit_table, classical_table, dormand_prince_table, runge_kutta_t, stage_sum

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

    !> One step of the method. Its first stage is the known slope.
    subroutine step(self, h, change, status)
        class(runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: k(max_states, max_stages)
        integer :: i

        status = status_ok
        change = 0
        k(:, 1) = self%slope
        do i = 2, self%table%stages
            call self%evaluate(self%t + self%table%c(i) * h, &
                               self%y + h * stage_sum(k, self%table%a(:, i), i - 1), k(:, i), status)
            if (.not. is_ok(status)) return
        end do
        change = h * stage_sum(k, self%table%b, self%table%stages)
    end subroutine step

    !> Sum of the first n stages with the weights given.
    pure function stage_sum(k, weight, n) result(total)
        real(dp), intent(in) :: k(max_states, max_stages), weight(max_stages) !! slopes at the stages, and their weights
        integer, intent(in) :: n !! number of stages
        real(dp) :: total(max_states)
        integer :: i
        total = 0
        do i = 1, n
            total = total + weight(i) * k(:, i)
        end do
    end function stage_sum

end module spintop_runge_kutta
