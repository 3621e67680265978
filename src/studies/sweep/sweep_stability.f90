!> What a sweep table says of the stability of a case.
module spintop_sweep_stability
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_lyapunov, only: find_lyapunov
    use spintop_relative_equilibrium, only: find_equilibrium_eigenvalues
    use spintop_status, only: status_ok, status_unsuitable, status_meanings
    use spintop_sweep_columns, only: quantities, group_growth, group_lyapunov, sweep_groups, &
        q_growth_rate, q_lyapunov_exponent
    use spintop_sweep_notes, only: note_t, note_no_growth, note_no_lyapunov
    implicit none
    private
    public :: put_stability

contains

    !> The growth rate at a relative equilibrium, and the largest Lyapunov exponent.
    subroutine put_stability(case, wanted, values, note)
        type(case_t), intent(in) :: case
        logical, intent(in) :: wanted(sweep_groups)
        real(dp), intent(inout) :: values(quantities)
        type(note_t), intent(inout) :: note
        complex(dp) :: eigenvalues(6)
        real(dp) :: exponents(1)
        integer :: status

        if (wanted(group_growth)) then
            call find_equilibrium_eigenvalues(case%body, case%start, eigenvalues, status)
            if (status == status_ok) then
                values(q_growth_rate) = maxval(real(eigenvalues, dp))
            else if (status == status_unsuitable) then
                call note%add(note_no_growth, 'the start is not at rest, sleeping or steady')
            else
                call note%add(note_no_growth, trim(status_meanings(status)))
            end if
        end if
        if (wanted(group_lyapunov)) then
            call find_lyapunov(case%body, case%start, case%t_end, exponents, status)
            if (status == status_ok) then
                values(q_lyapunov_exponent) = exponents(1)
            else
                call note%add(note_no_lyapunov, trim(status_meanings(status)))
            end if
        end if
    end subroutine put_stability

end module spintop_sweep_stability
