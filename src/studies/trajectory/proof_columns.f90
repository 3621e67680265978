!> The columns of a trajectory table that prove its numbers: upper bounds of their errors (spintop_certificate).
module spintop_proof_columns
    use spintop_certificate, only: proof_count, proof_of_orientation, proof_of_phi, proof_of_psi, proof_of_q0, proof_of_q1, &
        proof_of_q2, proof_of_q3, proof_of_theta
    use spintop_kinds, only: dp
    use spintop_motion_view, only: motion_view_t
    use spintop_study_column, only: proof_group
    use spintop_trajectory_column, only: longest, trajectory_column_t
    implicit none
    private
    public :: proof_columns

contains

    !> The columns, in the order of the documentation.
    function proof_columns() result(columns)
        type(trajectory_column_t), allocatable :: columns(:)
        columns = [ &
            trajectory_column_t('q0_bound', '', 'upper bound of the error of q0, proved', &
                                proof_group, put_bounds, proof_of_q0), &
            trajectory_column_t('q1_bound', '', 'upper bound of the error of q1, proved', &
                                proof_group, put_bounds, proof_of_q1), &
            trajectory_column_t('q2_bound', '', 'upper bound of the error of q2, proved', &
                                proof_group, put_bounds, proof_of_q2), &
            trajectory_column_t('q3_bound', '', 'upper bound of the error of q3, proved', &
                                proof_group, put_bounds, proof_of_q3), &
            trajectory_column_t('theta_bound', 'rad', 'upper bound of the error of theta, proved', &
                                proof_group, put_bounds, proof_of_theta), &
            trajectory_column_t('phi_bound', 'rad', 'upper bound of the error of phi, proved', &
                                proof_group, put_bounds, proof_of_phi), &
            trajectory_column_t('psi_bound', 'rad', 'upper bound of the error of psi, proved', &
                                proof_group, put_bounds, proof_of_psi), &
            trajectory_column_t('orientation_bound', 'rad', &
                                'upper bound of the rotation angle from the true attitude, proved', &
                                proof_group, put_bounds, proof_of_orientation), &
            trajectory_column_t('proof', '', 'proved, or unproved if a bound of the row is infinite', &
                                proof_group, put_proof, 1, is_proof=.true.)]
    end function proof_columns

    !> One for each quantity (spintop_certificate).
    subroutine put_bounds(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:proof_count) = now%proof%bounds
    end subroutine put_bounds

    !> 1 where all bounds of the row are proved, else 0.
    subroutine put_proof(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = merge(1, 0, now%proof%is_proved())
    end subroutine put_proof

end module spintop_proof_columns
