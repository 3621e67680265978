!> Explicit Runge-Kutta methods with a fixed step size.
module spintop_runge_kutta
    use spintop_kinds, only: dp
    use spintop_formulation, only: max_states
    use spintop_fixed_step, only: fixed_step_t
    use spintop_butcher, only: butcher_t, max_stages
    use spintop_status, only: is_ok, status_ok
    implicit none
    private
    public :: runge_kutta_t, stage_sum

    !> An explicit Runge-Kutta method given by its Butcher table.
    type, extends(fixed_step_t) :: runge_kutta_t
        type(butcher_t) :: table
    contains
        procedure :: step
    end type runge_kutta_t

contains

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
