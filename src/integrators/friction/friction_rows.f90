!> Rows of a table of friction within a step by series: the series has the polynomial between two rows, and goes on with it
!> beyond them. Such a step ends just beyond the row that the angular velocity passes first.
module spintop_friction_rows
    use spintop_effects_action, only: row_interval_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_motions, only: instants
    use spintop_reversals, only: end_step_at
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: end_at_row

    !> A time at which a row is passed is found up to so many spacings of the time.
    real(dp), parameter :: spacings = 4

contains

    !> Ends a step just after the first instant at which the angular velocity is beyond a row.
    subroutine end_at_row(formulation, stepper, status)
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(row_interval_t) :: rows
        real(dp) :: lower, upper, times(0:instants), y(0:instants, max_states), spin(0:instants)
        integer :: i, peak

        rows = formulation%action%interval_of_rows(stepper%t_last, stepper%y_last)
        lower = stepper%t_last
        upper = stepper%t
        do while (upper - lower > spacings * spacing(upper))
            times = lower + (upper - lower) * [(real(i, dp) / instants, i=0, instants)]
            times(instants) = upper
            y(0, :) = stepper%state_within(formulation, lower)
            call stepper%states_within(formulation, times(1:), y(1:, :))
            do i = 0, instants
                spin(i) = formulation%action%spin_of_rows(times(i), y(i, :))
            end do
            i = findloc(spin(1:) > rows%upper .or. spin(1:) < rows%lower, .true., dim=1)
            if (i > 0) then
                lower = times(i - 1)
                upper = times(i)
                cycle
            end if
            peak = place_of_peak(spin, rows)
            if (peak == 0) return
            lower = times(peak - 1)
            upper = times(peak + 1)
        end do
        if (i > 0 .and. upper < stepper%t) call end_step_at(formulation, stepper, upper, y(i, :), status)
    end subroutine end_at_row

    !> The inner instant at which the angular velocity is an extreme that may pass a row before or after it; 0 if there is none.
    pure integer function place_of_peak(spin, rows) result(peak)
        real(dp), intent(in) :: spin(0:instants)
        type(row_interval_t), intent(in) :: rows
        real(dp) :: rise, fall
        do peak = 1, instants - 1
            rise = spin(peak) - min(spin(peak - 1), spin(peak + 1))
            fall = max(spin(peak - 1), spin(peak + 1)) - spin(peak)
            if (min(spin(peak) - spin(peak - 1), spin(peak) - spin(peak + 1)) >= 0 .and. spin(peak) + rise > rows%upper) return
            if (max(spin(peak) - spin(peak - 1), spin(peak) - spin(peak + 1)) <= 0 .and. spin(peak) - fall < rows%lower) return
        end do
        peak = 0
    end function place_of_peak

end module spintop_friction_rows
