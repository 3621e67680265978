!> The columns of a sweep table that prove its numbers: upper bounds of their errors (spintop_certificate).
module spintop_sweep_proof_columns
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_of_phi, proof_of_psi, proof_of_theta
    use spintop_study_column, only: proof_group
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_notes, only: note_nothing_to_bound, note_t
    use spintop_sweep_result, only: of_end, of_proof, set_of
    implicit none
    private
    public :: sweep_proof_columns

contains

    !> The columns, in the order of the documentation.
    function sweep_proof_columns() result(columns)
        type(sweep_column_t), allocatable :: columns(:)
        columns = [ &
            sweep_column_t('theta_end_bound', 'rad', 'upper bound of the error of theta_end, proved', &
                           proof_group, set_of([of_proof, of_end]), explain=explain_no_number, proof_of=proof_of_theta), &
            sweep_column_t('phi_end_bound', 'rad', 'upper bound of the error of phi_end, proved', &
                           proof_group, set_of([of_proof, of_end]), explain=explain_no_number, proof_of=proof_of_phi), &
            sweep_column_t('psi_end_bound', 'rad', 'upper bound of the error of psi_end, proved', &
                           proof_group, set_of([of_proof, of_end]), explain=explain_no_number, proof_of=proof_of_psi), &
            sweep_column_t('proof', '', 'proved, or unproved if a bound is infinite (categorical)', &
                           proof_group, set_of([of_proof]), is_proof=.true.)]
    end function sweep_proof_columns

    !> Notes that there is nothing to bound.
    subroutine explain_no_number(case, note)
        type(case_t), intent(in) :: case
        type(note_t), intent(inout) :: note
        if (note%flags == 0) call note%add(note_nothing_to_bound)
    end subroutine explain_no_number

end module spintop_sweep_proof_columns
