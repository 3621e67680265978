!> The quantities of the stability of a case in a sweep table.
module spintop_sweep_stability
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_lyapunov, only: find_largest_singular_value, find_lyapunov
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_status, only: status_ok, status_non_finite, status_step_limit, status_unsuitable, status_meanings
    use spintop_sweep_notes, only: note_t, note_no_growth, note_no_lyapunov, note_no_singular
    use spintop_sweep_result, only: sweep_result_t, sweep_work_t
    implicit none
    private
    public :: put_stability

contains

    !> The growth rate at a relative equilibrium, the Lyapunov exponent, and the largest singular value.
    !> `status` reports work that was not finished, or overflow.
    subroutine put_stability(case, wanted, max_steps, values, status, note)
        type(case_t), intent(in) :: case !! body, start and span
        type(sweep_work_t), intent(in) :: wanted !! selected groups of quantities
        integer(int64), intent(inout) :: max_steps !! remaining work of the case
        type(sweep_result_t), intent(inout) :: values !! the quantities of the case
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(note_t), intent(inout) :: note !! notes on the case
        complex(dp) :: eigenvalues(6)
        real(dp) :: value(1)
        integer :: how, steps

        status = status_ok
        if (wanted%growth) then
            call find_equilibrium_eigenvalues(case%body, case%start, eigenvalues, how)
            if (how == status_ok) then
                values%growth_rate = maxval(real(eigenvalues, dp))
            else if (how == status_unsuitable) then
                call note%add(note_no_growth, 'the start is not at rest, sleeping or steady')
            else
                call note%add(note_no_growth, trim(status_meanings(how)))
            end if
        end if
        if (wanted%lyapunov) then
            call find_lyapunov(case%body, case%start, case%t_end, value, how, max_steps=most_steps(), steps=steps)
            call take(values%lyapunov_exponent, note_no_lyapunov)
        end if
        if (wanted%singular) then
            call find_largest_singular_value(case%body, case%start, case%t_end, value(1), how, most_steps(), steps)
            call take(values%largest_singular_value, note_no_singular)
        end if

    contains

        integer function most_steps()
            most_steps = int(max(0_int64, min(max_steps, int(huge(1) - 1, int64))))
        end function most_steps

        !> Stores a value, or notes the reason why there is none.
        subroutine take(quantity, reason)
            real(dp), intent(inout) :: quantity
            integer, intent(in) :: reason
            max_steps = max_steps - steps
            if (how == status_ok) then
                quantity = value(1)
            else
                call note%add(reason, trim(status_meanings(how)))
                if (how == status_step_limit .or. how == status_non_finite) status = how
            end if
        end subroutine take

    end subroutine put_stability

end module spintop_sweep_stability
