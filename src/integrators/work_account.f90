!> The work of effects along a motion: integrals of their power over the steps, by Gauss quadrature of the dense output.
!> They have the order of the method, and stand outside its error control.
module spintop_work_account
    use spintop_formulation, only: max_states
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motions, only: instants
    use spintop_stepper, only: stepper_t
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

    !> Nodes and weights of the Gauss-Legendre rule of 8 points on [-1, 1]. The series of a Taylor step converges over nearly
    !> twice its length, so the error is at the level of rounding.
    integer, parameter :: pairs = instants / 2
    real(dp), parameter :: positive(pairs) = [ &
        0.18343464249564980494_dp, 0.52553240991632898582_dp, 0.79666647741362673959_dp, 0.96028985649753623168_dp]
    real(dp), parameter :: node(instants) = [positive, -positive]
    real(dp), parameter :: weight(pairs) = [ &
        0.36268378337836198297_dp, 0.31370664587788728734_dp, 0.22238103445337447054_dp, 0.10122853629037625915_dp]

contains

    !> Counts the work up to a time within the last step.
    subroutine go_to(self, stepper, t)
        class(work_account_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! the method, after the step
        real(dp), intent(in) :: t !! time within the last step, s
        real(dp) :: half, times(instants), y(instants, max_states), power(instants, works), sum, change, new
        integer :: part

        if (.not. t > self%t) return
        half = (t - self%t) / 2
        times = self%t + half + node * half
        call stepper%states_within(times, y)
        call stepper%formulation%action%find_powers(times, y, power)
        do part = 1, works
            sum = dot_product(weight, power(:pairs, part) + power(pairs + 1:, part))
            change = half * sum + self%rest(part)
            new = self%total(part) + change
            self%rest(part) = change - (new - self%total(part))
            self%total(part) = new
        end do
        self%t = t
    end subroutine go_to

end module spintop_work_account
