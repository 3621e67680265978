!> The equations of the stages of an implicit Runge-Kutta step, their derivatives, and the units of their
!> unknowns.
!>
!> The unknowns are the increments z of the stages over the state, so that small steps lose no digits.
module spintop_stage_equations
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_implicit_tables, only: implicit_table_t, max_implicit_stages
    use spintop_status, only: is_ok, status_ok
    use spintop_stepper, only: run_state_t
    implicit none
    private
    public :: find_residual, find_jacobian, units_of_stages, largest
    public :: negligible, acceptable, sure

    !> An iteration has converged to rounding if its correction, in units of the stages, is below the first
    !> value, or if it no longer decreases and is below the second.
    real(dp), parameter :: negligible = epsilon_dp / 128, acceptable = 1.0e-10_dp
    !> Contraction that shows that the solution is the nearby one.
    real(dp), parameter :: sure = 0.5_dp

contains

    !> Residual of the equations of the stages.
    subroutine find_residual(table, formulation, run, h, z, residual, status)
        type(implicit_table_t), intent(in) :: table !! the method
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        class(run_state_t), intent(inout) :: run !! state and slope at the beginning of the step
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(in) :: z(max_states, max_implicit_stages) !! increments of the stages
        real(dp), intent(out) :: residual(max_states, max_implicit_stages) !! in units of the state
        integer, intent(out) :: status !! that of the right-hand side
        real(dp) :: slope(max_states)
        integer :: i, j

        residual = 0
        status = status_ok
        do j = 1, table%stages
            call run%evaluate(formulation, run%t + table%node(j) * h, run%y + z(:, j), slope, status)
            if (.not. is_ok(status)) return
            do i = 1, table%stages
                residual(:, i) = residual(:, i) + table%a(i, j) * slope
            end do
        end do
        do i = 1, table%stages
            residual(:, i) = h * (residual(:, i) + table%first * run%slope) - z(:, i)
        end do
    end subroutine find_residual

    !> The Jacobian df/dy, in units of the state, by forward differences, accurate to several digits also where a component
    !> is zero. The equations do not depend on cyclic variables.
    subroutine find_jacobian(formulation, run, t, y, jacobian, status)
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        class(run_state_t), intent(inout) :: run !! counts the evaluations
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state at which the derivatives are taken
        real(dp), intent(out) :: jacobian(max_states, max_states) !! column j is df/dy_j, in `formulation%units()`, 1/s
        integer, intent(out) :: status !! that of the right-hand side
        !> Increment of a component relative to its magnitude, and the smallest magnitude used for this,
        !> relative to its scale.
        real(dp), parameter :: share = sqrt(epsilon_dp), least = sqrt(sqrt(epsilon_dp))
        real(dp) :: moved(max_states), slope(max_states), slope_moved(max_states), unit(max_states)
        type(formulation_info_t) :: info
        integer :: j

        info = formulation%info()
        unit = formulation%units()
        run%counts%jacobians = run%counts%jacobians + 1
        jacobian = 0
        call run%evaluate(formulation, t, y, slope, status)
        do j = 1, info%states
            if (.not. is_ok(status)) return
            if (formulation%cyclic(j)) cycle
            moved = y
            moved(j) = y(j) + share * max(abs(y(j)), least * formulation%scale(j))
            call run%evaluate(formulation, t, moved, slope_moved, status)
            jacobian(:, j) = (slope_moved - slope) / unit / ((moved(j) - y(j)) / unit(j))
        end do
    end subroutine find_jacobian

    !> The unit of the increments of each variable: the scale of the motion or, if they are larger, the
    !> increments or the variable itself. The magnitude of a cyclic variable is ignored.
    pure function units_of_stages(formulation, y, z) result(units)
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        real(dp), intent(in) :: y(max_states) !! state at the beginning of the step
        real(dp), intent(in) :: z(max_states, max_implicit_stages) !! increments of the stages
        real(dp) :: units(max_states)
        units = max(formulation%scale, maxval(abs(z), dim=2), merge(0.0_dp, abs(y), formulation%cyclic))
    end function units_of_stages

    !> Largest component of all stages, each in its unit; of the selected variables if there is a selection.
    pure real(dp) function largest(z, units, selection)
        real(dp), intent(in) :: z(max_states, max_implicit_stages) !! increments
        real(dp), intent(in) :: units(max_states) !! their units
        logical, intent(in), optional :: selection(max_states) !! the variables that count
        if (present(selection)) then
            largest = maxval(maxval(abs(z), dim=2) / units, mask=selection)
        else
            largest = maxval(maxval(abs(z), dim=2) / units)
        end if
    end function largest

end module spintop_stage_equations
