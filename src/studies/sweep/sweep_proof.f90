!> The proof of the numbers of a case of a sweep: upper bounds of their errors, and certified digits.
module spintop_sweep_proof
    use spintop_certificate, only: proof_count, proof_of_phi, proof_of_psi, proof_of_theta, proof_reasons, proof_words
    use spintop_compare, only: is_finite
    use spintop_kinds, only: dp
    use spintop_row_proof, only: row_proof_t
    use spintop_scene_keys, only: scene_t
    use spintop_study_column, only: proof_group
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_engine, only: slot_t
    use spintop_sweep_result, only: proof_cells
    use spintop_uncertainties, only: data_radii
    implicit none
    private
    public :: sweep_proofs, prove_case

    !> The quantities of sweeps that have bounds.
    integer, parameter :: quantities(3) = [proof_of_theta, proof_of_phi, proof_of_psi]

contains

    !> Which quantities are to be proved for a table with these columns: those with a bound; also those that are printed,
    !> if these are to be certified, or if there is a column `proof` without bounds.
    pure function sweep_proofs(columns, certified) result(wanted)
        type(sweep_column_t), intent(in) :: columns(:) !! of the table
        logical, intent(in) :: certified !! whether proved numbers replace the computed ones
        logical :: wanted(proof_count)
        integer :: i
        wanted = [(any(columns%group == proof_group .and. columns%proof_of == i), i=1, proof_count)]
        if (.not. certified .and. (any(wanted) .or. .not. any(columns%is_proof))) return
        wanted = [(any(columns%proof_of == i), i=1, proof_count)]
    end function sweep_proofs

    !> Bounds of the wanted numbers of a case, which has ended well. What the case does not have needs no proof.
    subroutine prove_case(slot, wanted, scene)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        logical, intent(in) :: wanted(proof_count) !! which quantities are to be proved
        type(scene_t), intent(in) :: scene !! contents of the input
        type(row_proof_t) :: proof
        real(dp) :: printed(proof_count)

        associate (case => slot%case, values => slot%result)
            printed = 0
            printed(quantities) = [values%theta_end, values%phi_end, values%psi_end]
            call proof%open(wanted .and. is_finite(printed), scene%certified, case%given_body, case%given_start, &
                            data_radii(scene))
            call proof%prove(merge(values%t_end, case%t_end, is_finite(values%t_end)), printed)
            call proof%close()
            if (scene%certified) then
                values%theta_end = printed(proof_of_theta)
                values%phi_end = printed(proof_of_phi)
                values%psi_end = printed(proof_of_psi)
            end if
            where (proof%wanted) values%bounds = proof%bounds
            values%proof = findloc(proof_cells, proof_words(merge(1, 0, proof%is_proved())), dim=1) - 1
            if (.not. proof%is_proved()) call slot%note%explain('unproved: ' // trim(proof_reasons(proof%outcome())))
        end associate
    end subroutine prove_case

end module spintop_sweep_proof
