!> Rows of a table of friction within a step, which ends just beyond the row that the angular velocity passes first. A series
!> has the polynomial between two rows, and goes on with it beyond them, so that its state there is right; a step of another
!> method that leads across a row is wrong as a whole, and is taken again.
module spintop_friction_rows
    use spintop_effects_action, only: row_interval_t
    use spintop_formulation, only: max_states
    use spintop_kinds, only: dp
    use spintop_motions, only: instants
    use spintop_reversals, only: end_step_at
    use spintop_status, only: is_ok
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: end_at_row

    !> A time at which a row is passed is found up to so many spacings of the time.
    real(dp), parameter :: spacings = 4
    !> A row within this share of a step is passed at its beginning: the step is as good as behind it.
    real(dp), parameter :: shortest = 1.0e-6_dp

contains

    !> Ends a step just after the first instant at which the angular velocity is beyond a row.
    subroutine end_at_row(stepper, is_series, status)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        logical, intent(in) :: is_series !! whether the step is by series
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(row_interval_t) :: rows
        real(dp) :: spin(2), t, y(max_states)
        integer :: row
        logical :: passes

        rows = stepper%formulation%action%interval_of_rows(stepper%t_last, stepper%y_last)
        if (.not. is_series) then
            ! States within a step cost evaluations of f, and few steps come near a row.
            spin(1) = stepper%formulation%action%spin_of_rows(stepper%t_last, stepper%y_last)
            spin(2) = stepper%formulation%action%spin_of_rows(stepper%t, stepper%y)
            if (min(rows%upper - maxval(spin), minval(spin) - rows%lower) > abs(spin(2) - spin(1))) return
        end if
        t = stepper%t_last
        ! One row may be passed at the beginning.
        do row = 1, 2
            call find_row(stepper, rows, t, y, passes)
            if (.not. passes) return
            if (is_series) then
                call end_step_at(stepper, t, y, status)
                return
            else if (t - stepper%t_last > shortest * (stepper%t - stepper%t_last)) then
                call take_again(stepper, t, status)
                return
            end if
            rows = stepper%formulation%action%interval_of_rows(t, y)
        end do
    end subroutine end_at_row

    !> Finds the first instant from `t` on at which the angular velocity is beyond the rows, and the state then.
    subroutine find_row(stepper, rows, t, y, passes)
        class(stepper_t), intent(inout) :: stepper
        type(row_interval_t), intent(in) :: rows
        real(dp), intent(inout) :: t
        real(dp), intent(out) :: y(max_states)
        logical, intent(out) :: passes
        real(dp) :: lower, upper, times(0:instants), states(0:instants, max_states), spin(0:instants)
        integer :: i, peak

        passes = .false.
        i = 0
        lower = t
        upper = stepper%t
        do while (upper - lower > spacings * spacing(upper))
            times = lower + (upper - lower) * [(real(i, dp) / instants, i=0, instants)]
            times(instants) = upper
            states(0, :) = stepper%state_within(lower)
            call stepper%states_within(times(1:), states(1:, :))
            do i = 0, instants
                spin(i) = stepper%formulation%action%spin_of_rows(times(i), states(i, :))
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
        passes = i > 0 .and. upper < stepper%t
        if (.not. passes) return
        t = upper
        y = states(i, :)
    end subroutine find_row

    !> Takes a step again, up to a time within it.
    subroutine take_again(stepper, t, status)
        class(stepper_t), intent(inout) :: stepper
        real(dp), intent(in) :: t
        integer, intent(out) :: status
        stepper%t = stepper%t_last
        stepper%y = stepper%y_last
        stepper%rest = 0
        stepper%t_end = t
        call stepper%begin(status)
        if (.not. is_ok(status)) return
        stepper%h = t - stepper%t
        call stepper%advance(status)
    end subroutine take_again

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
