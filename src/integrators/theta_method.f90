!> One-stage implicit methods (the paper's Appendix D): backward Euler, Galerkin, Crank-Nicolson.
!>
!> All solve one stage z = base + h gamma f(z). The theta method
!> y+ = y + h [(1-alpha) f(y) + alpha f(y+)] has base = y + h (1-alpha) f(y), gamma = alpha and
!> y+ = z; the implicit midpoint rule y+ = y + h f((y+y+)/2) has base = y, gamma = 1/2 and
!> y+ = 2 z - y.
module spintop_theta_method
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_stepper, only: workspace_t
    use spintop_fixed_step, only: fixed_step_t
    use spintop_lapack, only: dgetrf, dgetrs
    use spintop_status, only: status_ok, status_not_converged
    implicit none
    private
    public :: theta_method_t

    !> A theta method, or the implicit midpoint rule.
    type, extends(fixed_step_t) :: theta_method_t
        !> Weight of the new slope, 0 < alpha <= 1.
        real(dp) :: alpha = 0.5_dp
        !> Take the slope at the middle of the step (alpha = 1/2).
        logical :: at_midpoint = .false.
    contains
        procedure :: step
    end type theta_method_t

    !> Iterations after which a stage counts as not converged.
    integer, parameter :: newton_limit = 30, fixed_point_limit = 200
    !> A correction of this size relative to the state is rounding.
    real(dp), parameter :: rounding = 4 * epsilon_dp
    !> An iteration that no longer shrinks its correction has converged if it is below this.
    real(dp), parameter :: acceptable = 1.0e-10_dp

contains

    !> One step of the method.
    subroutine step(self, formulation, work, h, change, status)
        class(theta_method_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        real(dp), intent(in) :: h
        real(dp), intent(out) :: change(max_states)
        integer, intent(out) :: status
        real(dp) :: base(max_states), z(max_states)

        base = work%y
        if (.not. self%at_midpoint) base = base + h * (1 - self%alpha) * work%slope
        z = base + h * self%alpha * work%slope
        if (self%controls%fixed_point) then
            call solve_by_fixed_point(formulation, work, base, h * self%alpha, z, status)
        else
            call solve_by_newton(formulation, work, base, h * self%alpha, z, status)
        end if
        change = z - work%y
        if (self%at_midpoint) change = 2 * change
    end subroutine step

    !> Solves z = base + g f(z) by repeated insertion, from the guess in z.
    subroutine solve_by_fixed_point(formulation, work, base, g, z, status)
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        real(dp), intent(in) :: base(max_states), g
        real(dp), intent(inout) :: z(max_states)
        integer, intent(out) :: status
        real(dp) :: slope(max_states), z_new(max_states), correction, previous
        integer :: iteration

        previous = huge(1.0_dp)
        do iteration = 1, fixed_point_limit
            call work%evaluate(formulation, z, slope, status)
            if (status /= status_ok) return
            z_new = base + g * slope
            correction = relative_size(z_new - z, z_new)
            z = z_new
            if (has_converged(correction, previous)) return
            previous = correction
        end do
        status = status_not_converged
    end subroutine solve_by_fixed_point

    !> Solves z = base + g f(z) by Newton's method with the Jacobian at the guess in z, taken anew
    !> where the corrections shrink slowly.
    subroutine solve_by_newton(formulation, work, base, g, z, status)
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        real(dp), intent(in) :: base(max_states), g
        real(dp), intent(inout) :: z(max_states)
        integer, intent(out) :: status
        !> Contraction a step above which a new Jacobian pays.
        real(dp), parameter :: slow = 0.1_dp
        type(formulation_info_t) :: info
        real(dp) :: slope(max_states), matrix(max_states, max_states), residual(max_states, 1)
        real(dp) :: correction, previous
        integer :: pivots(max_states), iteration, n, failure
        logical :: refresh

        info = formulation%info()
        n = info%states
        previous = huge(1.0_dp)
        refresh = .true.
        do iteration = 1, newton_limit
            call work%evaluate(formulation, z, slope, status)
            if (status /= status_ok) return
            residual(:, 1) = base + g * slope - z
            if (refresh) then
                call stage_matrix(formulation, work, n, z, slope, g, matrix, status)
                if (status /= status_ok) return
                call dgetrf(n, n, matrix, max_states, pivots, failure)
                if (failure /= 0) exit
            end if
            call dgetrs('N', n, 1, matrix, max_states, pivots, residual, max_states, failure)
            z = z + residual(:, 1)
            correction = relative_size(residual(:, 1), z)
            if (has_converged(correction, previous)) return
            refresh = correction > slow * previous
            previous = correction
        end do
        status = status_not_converged
    end subroutine solve_by_newton

    !> The matrix 1 - g df/dy by forward differences at z, where f is `slope`.
    subroutine stage_matrix(formulation, work, n, z, slope, g, matrix, status)
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        integer, intent(in) :: n
        real(dp), intent(in) :: z(max_states), slope(max_states), g
        real(dp), intent(out) :: matrix(max_states, max_states)
        integer, intent(out) :: status
        real(dp) :: moved(max_states), slope_moved(max_states), shift
        integer :: j

        work%counts%jacobians = work%counts%jacobians + 1
        do j = 1, n
            moved = z
            moved(j) = z(j) + sqrt(epsilon_dp) * max(abs(z(j)), sqrt(epsilon_dp))
            shift = moved(j) - z(j)
            call work%evaluate(formulation, moved, slope_moved, status)
            if (status /= status_ok) return
            matrix(:, j) = -g * (slope_moved - slope) / shift
            matrix(j, j) = matrix(j, j) + 1
        end do
    end subroutine stage_matrix

    !> Whether an iteration has reached rounding, or stands still close to it.
    pure logical function has_converged(correction, previous)
        real(dp), intent(in) :: correction, previous
        has_converged = correction <= rounding &
            .or. (correction >= previous .and. correction <= acceptable)
    end function has_converged

    !> Largest component of a correction relative to the state (absolute for components below 1).
    pure real(dp) function relative_size(correction, z)
        real(dp), intent(in) :: correction(max_states), z(max_states)
        relative_size = maxval(abs(correction) / max(abs(z), 1.0_dp))
    end function relative_size

end module spintop_theta_method
