!> The equations of an implicit step where Newton's method with one Jacobian fails: Newton's method with the
!> Jacobian of every stage in every iteration, and continuation in the step size.
!>
!> The required solution is the one that is connected to the state as the step size tends to zero (Deuflhard,
!> Newton Methods for Nonlinear Problems, 2004, 5.1). It is followed from step size zero, by increments so
!> small that Newton's method contracts at once and its correction is smaller than the prediction.
module spintop_stage_continuation
    use spintop_kinds, only: dp
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_implicit_tables, only: implicit_table_t, max_implicit_stages
    use spintop_lapack, only: dgetrf, dgetrs
    use spintop_stage_equations, only: acceptable, find_jacobian, find_residual, largest, negligible, sure, &
        units_of_stages
    use spintop_status, only: is_ok, status_not_converged, status_ok
    use spintop_stepper, only: run_state_t
    implicit none
    private
    public :: follow_stages, solve_from_near

    !> Maximum number of unknowns.
    integer, parameter :: max_unknowns = max_states * max_implicit_stages
    !> Number of iterations after which an increment is too large: the number of correct digits doubles each
    !> time.
    integer, parameter :: most_iterations = 10
    !> Largest increments of stages, in their units, that can approximate a motion: the range of an
    !> inclination is pi, that of a component of a quaternion 4, that of a rate 2.
    real(dp), parameter :: farthest = 2
    !> Smallest increment of the continuation, and maximum number of increments per step.
    real(dp), parameter :: shortest = 2.0_dp**(-12)
    integer, parameter :: most_stretches = 200

contains

    !> Follows the solution of the equations of the stages from step size zero. The status is
    !> `status_not_converged` if the solution ends, or turns back, before the full step size.
    subroutine follow_stages(table, formulation, run, h, z, status)
        type(implicit_table_t), intent(in) :: table !! the method
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        class(run_state_t), intent(inout) :: run !! state and slope at the beginning of the step
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: z(max_states, max_implicit_stages) !! increments of the stages
        integer, intent(out) :: status !! `status_ok`, or `status_not_converged`
        real(dp), dimension(max_states, max_implicit_stages) :: here, tangent
        real(dp) :: share, stretch
        integer :: attempt, i

        here = 0
        do i = 1, max_implicit_stages
            tangent(:, i) = table%node(i) * h * run%slope
        end do
        share = 0
        stretch = 1
        do attempt = 1, most_stretches
            stretch = min(stretch, 1 - share)
            z = here + stretch * tangent
            call iterate(table, formulation, run, (share + stretch) * h, stretch * tangent, z, status)
            if (is_ok(status)) then
                if (largest(z, formulation%scale, .not. formulation%cyclic) > farthest) exit
                if (.not. share + stretch < 1) return
                here = z
                share = share + stretch
                stretch = 2 * stretch
                ! The equations z = share h (first f(t, y) + ...), derived by the share.
                tangent = here / share
                if (formulation%depends_on_time) then
                    call add_time_derivative(table, formulation, run, share * h, h, here, tangent, status)
                    if (.not. is_ok(status)) exit
                end if
                call find_correction(table, formulation, run, share * h, here, tangent, status)
                if (.not. is_ok(status)) exit
            else
                stretch = stretch / 4
                if (stretch < shortest) exit
            end if
        end do
        status = status_not_converged
    end subroutine follow_stages

    !> Adds to the equations derived by the share what the times of the stages contribute:
    !> h sum_j a_ij df/dt(t + node_j h, y + z_j) node_j span.
    subroutine add_time_derivative(table, formulation, run, h, span, z, tangent, status)
        type(implicit_table_t), intent(in) :: table
        class(formulation_t), intent(in) :: formulation
        class(run_state_t), intent(inout) :: run
        real(dp), intent(in) :: h, span, z(max_states, max_implicit_stages)
        real(dp), intent(inout) :: tangent(max_states, max_implicit_stages)
        integer, intent(out) :: status
        real(dp) :: t, shift, slope(max_states), later(max_states)
        integer :: i, j

        status = status_ok
        do j = 1, table%stages
            t = run%t + table%node(j) * h
            shift = sqrt(epsilon(t)) * max(abs(t), abs(span))
            call run%evaluate(formulation, t, run%y + z(:, j), slope, status)
            if (is_ok(status)) call run%evaluate(formulation, t + shift, run%y + z(:, j), later, status)
            if (.not. is_ok(status)) return
            do i = 1, table%stages
                tangent(:, i) = tangent(:, i) &
                    + h * table%a(i, j) * table%node(j) * span * ((later - slope) / shift)
            end do
        end do
    end subroutine add_time_derivative

    !> Solves the equations of the stages to rounding, from increments that are accurate except for the last
    !> digits.
    subroutine solve_from_near(table, formulation, run, h, z, status)
        type(implicit_table_t), intent(in) :: table !! the method
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        class(run_state_t), intent(inout) :: run !! state and slope at the beginning of the step
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(inout) :: z(max_states, max_implicit_stages) !! increments of the stages
        integer, intent(out) :: status !! `status_ok`, or `status_not_converged`
        call iterate(table, formulation, run, h, z, z, status)
    end subroutine solve_from_near

    !> Newton's method from the guess in z. The first correction may not be larger than a fraction of `reach`,
    !> and each further one not larger than that fraction of the previous one, until only rounding errors are
    !> left. Cyclic variables follow from the others and are ignored in this test.
    subroutine iterate(table, formulation, run, h, reach, z, status)
        type(implicit_table_t), intent(in) :: table
        class(formulation_t), intent(in) :: formulation
        class(run_state_t), intent(inout) :: run
        real(dp), intent(in) :: h, reach(max_states, max_implicit_stages)
        real(dp), intent(inout) :: z(max_states, max_implicit_stages)
        integer, intent(out) :: status
        real(dp) :: correction(max_states, max_implicit_stages), units(max_states)
        real(dp) :: core, core_previous, magnitude, previous
        integer :: iteration

        units = units_of_stages(formulation, run%y, z)
        previous = huge(1.0_dp)
        core_previous = largest(reach, units, .not. formulation%cyclic)
        do iteration = 1, most_iterations
            call find_residual(table, formulation, run, h, z, correction, status)
            if (is_ok(status)) call find_correction(table, formulation, run, h, z, correction, status)
            if (.not. is_ok(status)) exit
            magnitude = largest(correction, units)
            core = largest(correction, units, .not. formulation%cyclic)
            if (.not. core <= max(sure * core_previous, acceptable)) exit
            z = z + correction
            if (magnitude <= negligible .or. magnitude >= previous .and. magnitude <= acceptable) return
            if (iteration > 1 .and. magnitude * (magnitude / previous) <= negligible) return
            previous = magnitude
            core_previous = core
        end do
        status = status_not_converged
    end subroutine iterate

    !> Computes Newton's correction from the residual, with the Jacobian of each stage: the equations
    !> correction_i - h sum_j a_ij J_j correction_j = residual_i.
    subroutine find_correction(table, formulation, run, h, z, correction, status)
        type(implicit_table_t), intent(in) :: table
        class(formulation_t), intent(in) :: formulation
        class(run_state_t), intent(inout) :: run
        real(dp), intent(in) :: h, z(max_states, max_implicit_stages)
        real(dp), intent(inout) :: correction(max_states, max_implicit_stages)
        integer, intent(out) :: status
        real(dp) :: matrix(max_unknowns, max_unknowns), unknown(max_unknowns, 1)
        real(dp) :: jacobian(max_states, max_states), unit(max_states)
        type(formulation_info_t) :: info
        integer :: pivots(max_unknowns), i, j, n, all_unknowns, failure

        info = formulation%info()
        n = info%states
        unit = formulation%units()
        all_unknowns = n * table%stages
        do j = 1, table%stages
            call find_jacobian(formulation, run, run%t + table%node(j) * h, run%y + z(:, j), jacobian, status)
            if (.not. is_ok(status)) return
            do i = 1, table%stages
                matrix((i - 1) * n + 1:i * n, (j - 1) * n + 1:j * n) = -h * table%a(i, j) * jacobian(:n, :n)
            end do
            unknown((j - 1) * n + 1:j * n, 1) = correction(:n, j) / unit(:n)
        end do
        do i = 1, all_unknowns
            matrix(i, i) = matrix(i, i) + 1
        end do
        status = status_not_converged
        call dgetrf(all_unknowns, all_unknowns, matrix, max_unknowns, pivots, failure)
        if (failure /= 0) return
        call dgetrs('N', all_unknowns, 1, matrix, max_unknowns, pivots, unknown, max_unknowns, failure)
        if (failure /= 0) return
        do j = 1, table%stages
            correction(:n, j) = unknown((j - 1) * n + 1:j * n, 1) * unit(:n)
        end do
        status = status_ok
    end subroutine find_correction

end module spintop_stage_continuation
