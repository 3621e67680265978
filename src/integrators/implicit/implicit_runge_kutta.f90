!> Implicit methods with a fixed step size: Gauss-Legendre and theta methods (the paper's Appendix D).
!>
!> Their stages are solved to rounding by Newton's method with one Jacobian for all stages, which is kept
!> while it converges, or by fixed-point iteration. If Newton's method fails, the solution is continued from
!> step size zero (`spintop_stage_continuation`).
module spintop_implicit_runge_kutta
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_compare, only: is_equal
    use spintop_fixed_step, only: fixed_step_t, begin_on_grid
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_implicit_tables, only: implicit_table_t, max_implicit_stages, max_modes
    use spintop_lapack, only: zgetrf, zgetrs
    use spintop_stage_continuation, only: follow_stages, solve_from_near
    use spintop_stage_equations, only: acceptable, find_jacobian, find_residual, largest, negligible, sure, &
        units_of_stages
    use spintop_status, only: is_ok, status_non_finite, status_not_converged, status_ok, status_outside
    implicit none
    private
    public :: implicit_runge_kutta_t

    !> An implicit method given by its table.
    type, extends(fixed_step_t) :: implicit_runge_kutta_t
        type(implicit_table_t) :: table
        !> Number of components in use.
        integer :: states = max_states
        !> Increments of the stages of the last step, and its size, s; 0 before the first step.
        real(dp) :: z(max_states, max_implicit_stages) = 0, h_stages = 0
        !> Factors of Newton's matrices, and the step size to which they belong, s; 0 if there are none.
        complex(dp) :: factors(max_states, max_states, max_modes) = 0
        integer :: pivots(max_states, max_modes) = 0
        real(dp) :: h_factors = 0
    contains
        procedure :: begin
        procedure :: step
    end type implicit_runge_kutta_t

    !> Number of iterations after which a step has not converged.
    integer, parameter :: newton_limit = 30, fixed_point_limit = 200
    !> Corrections that no longer decrease are due to rounding if they are below the first value; for
    !> fixed-point iteration, below the second. Larger ones may also be due to the Jacobian.
    real(dp), parameter :: rounding = 64 * epsilon_dp, rounding_of_insertion = 1.0e-12_dp
    !> Growth of corrections that rounding errors may cause.
    real(dp), parameter :: jitter = 10
    !> Contraction above which a new Jacobian is worthwhile.
    real(dp), parameter :: slow = 0.05_dp

contains

    !> First slope; data of an earlier run are discarded.
    subroutine begin(self, formulation, status)
        class(implicit_runge_kutta_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(formulation_info_t) :: info

        info = formulation%info()
        self%states = info%states
        self%h_stages = 0
        self%h_factors = 0
        call begin_on_grid(self, formulation, status)
    end subroutine begin

    !> One step of the method. The initial guess of the stages is the polynomial of the last step. If it
    !> fails, the slope is the guess, with a new Jacobian; if that fails too, continuation is used.
    subroutine step(self, formulation, h, change, status)
        class(implicit_runge_kutta_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: z(max_states, max_implicit_stages)
        integer :: i

        change = 0
        status = status_not_converged
        if (is_equal(self%h_stages, h)) then
            z = matmul(self%z, self%table%ahead)
            call solve_stages(self, formulation, h, z, status)
        end if
        if (.not. is_ok(status)) then
            self%h_factors = 0
            do i = 1, max_implicit_stages
                z(:, i) = self%table%node(i) * h * self%slope
            end do
            call solve_stages(self, formulation, h, z, status)
            if (.not. self%controls%fixed_point .and. all(status /= [status_ok, status_outside])) then
                call follow_stages(self%table, formulation, self%run_state_t, h, z, status)
            end if
        end if
        if (.not. is_ok(status)) return
        self%z = z
        self%h_stages = h
        change = matmul(z, self%table%last)
    end subroutine step

    !> Solves the equations of the stages from the guess in z. Newton's corrections must be smaller than the
    !> guess, and each smaller than the last one, by half with a new Jacobian: an iteration without
    !> contraction may find a solution, but rarely the one that is connected to the state. Cyclic variables
    !> follow from the others and are ignored in this test.
    subroutine solve_stages(self, formulation, h, z, status)
        class(implicit_runge_kutta_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: h
        real(dp), intent(inout) :: z(max_states, max_implicit_stages)
        integer, intent(out) :: status
        real(dp) :: correction(max_states, max_implicit_stages), units(max_states)
        real(dp) :: size, previous, smallest, core, core_previous, contraction
        integer :: iteration, idle
        logical :: newton, is_new

        newton = .not. self%controls%fixed_point
        units = units_of_stages(formulation, self%y, z)
        previous = largest(z, units)
        core_previous = largest(z, units, .not. formulation%cyclic)
        smallest = huge(1.0_dp)
        idle = 0
        is_new = .false.
        do iteration = 1, merge(newton_limit, fixed_point_limit, newton)
            call find_residual(self%table, formulation, self%run_state_t, h, z, correction, status)
            if (status == status_non_finite) exit
            if (.not. is_ok(status)) return
            if (newton .and. .not. is_equal(self%h_factors, h)) is_new = .true.
            if (newton) call newton_correction(self%table, formulation, self, h, z, correction, status)
            if (.not. is_ok(status)) return
            z = z + correction
            size = largest(correction, units)
            if (size <= negligible) return
            core = largest(correction, units, .not. formulation%cyclic)
            contraction = merge(sure, 1.0_dp, is_new .and. iteration > 1)
            if (newton .and. .not. core < contraction * core_previous .and. core > acceptable) exit
            if (newton .and. iteration > 1) then
                ! This is the expected magnitude of the next correction.
                if (size * (size / previous) <= negligible) return
                if (size > slow * previous) self%h_factors = 0
            end if
            ! Fixed-point corrections may alternate in magnitude; those of Newton's method do not.
            idle = merge(0, idle + 1, size < smallest)
            smallest = min(smallest, size)
            if (newton .and. idle > 0 .and. size <= acceptable) then
                if (size > rounding) call solve_from_near(self%table, formulation, self%run_state_t, h, z, status)
                return
            end if
            if (idle > 1 .and. smallest <= rounding_of_insertion .and. size <= jitter * smallest) return
            previous = size
            core_previous = core
        end do
        status = status_not_converged
    end subroutine solve_stages

    !> Computes Newton's correction from the residual. With one Jacobian J for all stages the equations
    !> decouple along the eigenvectors of the coefficients a (Butcher, BIT 16, 1976): for each eigenvalue
    !> lambda the matrix is 1 - h lambda J.
    subroutine newton_correction(table, formulation, self, h, z, correction, status)
        type(implicit_table_t), intent(in) :: table
        class(formulation_t), intent(in) :: formulation
        class(implicit_runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h, z(max_states, max_implicit_stages)
        real(dp), intent(inout) :: correction(max_states, max_implicit_stages)
        integer, intent(out) :: status
        complex(dp) :: mode(max_states)
        real(dp) :: residual(max_states, max_implicit_stages), unit(max_states)
        integer :: i, k, failure

        status = status_ok
        if (.not. is_equal(self%h_factors, h)) then
            call factor_matrices(table, formulation, self, h, z, status)
            if (.not. is_ok(status)) return
        end if
        unit = formulation%units()
        do i = 1, table%stages
            residual(:, i) = correction(:, i) / unit
        end do
        correction = 0
        do k = 1, table%modes
            mode = matmul(residual(:, :table%stages), table%to_modes(:table%stages, k))
            call zgetrs('N', self%states, 1, self%factors(:, :, k), max_states, self%pivots(:, k), &
                        mode, max_states, failure)
            do i = 1, table%stages
                correction(:, i) = correction(:, i) + real(table%from_modes(k, i) * mode, dp) * unit
            end do
        end do
    end subroutine newton_correction

    !> Factors the matrices 1 - h lambda J in units of the state, with the Jacobian in the middle of the stages.
    subroutine factor_matrices(table, formulation, self, h, z, status)
        type(implicit_table_t), intent(in) :: table
        class(formulation_t), intent(in) :: formulation
        class(implicit_runge_kutta_t), intent(inout) :: self
        real(dp), intent(in) :: h, z(max_states, max_implicit_stages)
        integer, intent(out) :: status
        real(dp) :: jacobian(max_states, max_states)
        integer :: i, k, failure

        self%h_factors = 0
        call find_jacobian(formulation, self%run_state_t, self%t + sum(table%node) / table%stages * h, &
                           self%y + sum(z, dim=2) / table%stages, jacobian, status)
        if (.not. is_ok(status)) return
        do k = 1, table%modes
            self%factors(:, :, k) = -h * table%eigenvalue(k) * jacobian
            do i = 1, self%states
                self%factors(i, i, k) = self%factors(i, i, k) + 1
            end do
            call zgetrf(self%states, self%states, self%factors(:, :, k), max_states, &
                        self%pivots(:, k), failure)
            if (failure /= 0) status = status_not_converged
        end do
        if (is_ok(status)) self%h_factors = h
    end subroutine factor_matrices

end module spintop_implicit_runge_kutta
