!> The work of effects along a motion: integrals of their power over the steps, by Gauss quadrature of the dense output.
!> They have the order of the method, and stand outside its error control.
module spintop_work_account
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_stepper, only: stepper_t, workspace_t
    implicit none
    private
    public :: work_account_t

    !> The work since the start.
    type :: work_account_t
        !> Whether work is counted.
        logical :: is_open = .false.
        !> Time up to which it is counted, s, and the work until then by its parts, J.
        real(dp) :: t = 0, total(works) = 0
        !> Compensation term of the sums (Kahan).
        real(dp), private :: rest(works) = 0
    contains
        procedure :: go_to
    end type work_account_t

    !> Positive nodes and weights of the Gauss-Legendre rule of 10 points on [-1, 1]. The series of a Taylor step
    !> converges over nearly twice its length, so the error is at the level of rounding.
    integer, parameter :: pairs = 5
    real(dp), parameter :: node(pairs) = [ &
        0.14887433898163121088_dp, 0.43339539412924719080_dp, 0.67940956829902440623_dp, &
        0.86506336668898451073_dp, 0.97390652851717172008_dp]
    real(dp), parameter :: weight(pairs) = [ &
        0.29552422471475287017_dp, 0.26926671930999635509_dp, 0.21908636251598204400_dp, &
        0.14945134915058059315_dp, 0.06667134430868813759_dp]

contains

    !> Counts the work up to a time within the last step.
    subroutine go_to(self, formulation, stepper, work, t)
        class(work_account_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(stepper_t), intent(in) :: stepper !! the method that took the step
        class(workspace_t), intent(inout) :: work !! its workspace
        real(dp), intent(in) :: t !! s
        real(dp) :: middle, half, sum(works), change(works), new(works)
        integer :: i

        if (.not. t > self%t) return
        middle = self%t + (t - self%t) / 2
        half = (t - self%t) / 2
        sum = 0
        do i = 1, pairs
            sum = sum + weight(i) * (power_at(middle - node(i) * half) + power_at(middle + node(i) * half))
        end do
        change = half * sum + self%rest
        new = self%total + change
        self%rest = change - (new - self%total)
        self%total = new
        self%t = t

    contains

        !> The power at a time.
        function power_at(time) result(power)
            real(dp), intent(in) :: time
            real(dp) :: power(works), y(max_states)
            y = stepper%interpolate(formulation, work, time)
            power = formulation%action%power(time, y)
        end function power_at

    end subroutine go_to

end module spintop_work_account
