!> The columns of a sweep table that are quantities of its cases: a line of the registry each. The help, the choice of
!> columns, the units in the header and the cells derive from it.
!>
!> A line says what the column needs, which is computed for a case where it is wanted. The value of the column is that in its
!> place in the list of the results of the case (spintop_sweep_result).
module spintop_sweep_columns
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_of_phi, proof_of_psi, proof_of_theta
    use spintop_kinds, only: dp
    use spintop_study_column, only: chosen_column_t, study_column_t, proof_group
    use spintop_sweep_result, only: note_t, note_nothing_to_bound, of_nutation, of_range, of_whole, of_measured, &
        of_fastest, of_lowest, of_details, of_class, of_nutation_rate, of_force, of_vertical_force, of_fast_top, &
        of_period, of_end, of_turns, of_energy, of_oracle, of_inherent, of_cost, of_growth, of_lyapunov, &
        of_singular, of_multiplier, of_threshold, kinds_of_work, set_of, of_free, of_geometric, of_proof
    use spintop_sweep_quantities, only: explain_no_exact_motion, explain_no_period, explain_not_stuck
    use spintop_sweep_stability, only: explain_no_threshold
    implicit none
    private
    public :: sweep_columns, columns_at, work_for, sweep_column_t, sweep_free_columns, sweep_proof_columns

    !> A column of a sweep.
    type, extends(study_column_t) :: sweep_column_t
        !> What is to be computed for it (spintop_sweep_result).
        logical :: needs(kinds_of_work) = .false.
        !> Its place in the list of all columns, and of its value in that of a result.
        integer :: place = 0
        !> It is in the table when the input names no columns: it costs no more than the rest.
        logical :: is_default = .false.
        !> It is the end of the motion.
        logical :: is_end = .false.
        !> Every case has it that ends well.
        logical :: always_exists = .false.
        !> It is a class of motion, and not a number.
        logical :: is_class = .false.
        !> It is a word that tells whether the bounds are proved.
        logical :: is_proof = .false.
        !> The quantity (spintop_certificate) that it contains, or whose bound it is; 0 if there is none.
        integer :: proof_of = 0
        !> Notes why a case lacks it, where nothing else that comes with it does.
        procedure(explain_i), pointer, nopass :: explain => null()
        !> In a table: the quantity is the number in it times the size of its unit.
        real(dp) :: size = 1
    end type sweep_column_t

    abstract interface
        !> Adds a note if there is something to add.
        subroutine explain_i(case, note)
            import :: case_t, note_t
            implicit none
            type(case_t), intent(in) :: case
            type(note_t), intent(inout) :: note
        end subroutine explain_i
    end interface

    !> What several columns need.
    integer, parameter :: range_of_theta(*) = [of_nutation, of_range], end_and_turns(*) = [of_end, of_turns], &
        whole_nutation(*) = [of_nutation, of_whole, of_measured]

contains

    !> All columns, in the order of the documentation.
    function sweep_columns() result(columns)
        type(sweep_column_t), allocatable :: columns(:)
        integer :: i
        columns = [ &
            sweep_column_t('theta_min', 'rad', 'minimum nutation angle', 'nutation', set_of(range_of_theta), &
                           is_default=.true.), &
            sweep_column_t('theta_max', 'rad', 'maximum nutation angle', 'nutation', set_of(range_of_theta), &
                           is_default=.true.), &
            sweep_column_t('delta_u', '', 'range of cos(theta)', 'nutation', set_of(range_of_theta), is_default=.true.), &
            sweep_column_t('delta_u_fast_top', '', 'the same by Eq 29', 'fast_top', set_of([of_fast_top]), &
                           is_default=.true.), &
            sweep_column_t('nutation_period', 's', 'nutation period', &
                           'nutation', set_of(whole_nutation), is_default=.true.), &
            sweep_column_t('nutation_rate', 'rad/s', '2 pi over the nutation period', &
                           'nutation', set_of(whole_nutation), is_default=.true.), &
            sweep_column_t('nutation_rate_fast_top', 'rad/s', 'the same by Eq 30', 'fast_top', set_of([of_fast_top]), &
                           is_default=.true.), &
            sweep_column_t('precession_per_nutation', 'rad', &
                           'change of phi in a nutation, without the half turns at exact passages of a pole', &
                           'nutation', set_of(whole_nutation), is_default=.true.), &
            sweep_column_t('precession_rate', 'rad/s', 'mean precession rate', &
                           'nutation', set_of(whole_nutation), is_default=.true.), &
            sweep_column_t('precession_rate_fast_top', 'rad/s', 'the same by Eq 32', 'fast_top', set_of([of_fast_top]), &
                           is_default=.true.), &
            sweep_column_t('nutations_per_turn', '', 'nutations per full turn of precession', &
                           'nutation', set_of(whole_nutation), is_default=.true.), &
            sweep_column_t('nutations_per_turn_fast_top', '', 'the same by Eq 54', 'fast_top', set_of([of_fast_top]), &
                           is_default=.true.), &
            sweep_column_t('precession_period', 's', 'T_p = 2 pi I3 omega3/(m g l) of the paper', &
                           'fast_top', set_of([of_fast_top]), is_default=.true.), &
            sweep_column_t('azimuth_after_period_deg', 'deg', 'change of phi after T_p', &
                           'period', set_of([of_period, of_turns]), is_default=.true.), &
            sweep_column_t('nutations_in_period', '', 'nutations in T_p', &
                           'nutation', set_of(whole_nutation), is_default=.true., explain=explain_no_period), &
            sweep_column_t('phi_rate_max', 'rad/s', 'precession rate that is largest in magnitude', &
                           'nutation', set_of([of_nutation, of_fastest, of_measured]), is_default=.true.), &
            sweep_column_t('fast_top_ratio', '', '(I3 omega3)^2/(2 I1 m g l), large for a fast top', &
                           'fast_top', set_of([of_fast_top]), is_default=.true.), &
            sweep_column_t('com_z_min', 'm', 'minimum height of the centre of mass above the pivot', &
                           'nutation', set_of([of_nutation, of_lowest, of_measured]), is_default=.true.), &
            sweep_column_t('theta_end', 'rad', 'inclination at the end of the span', 'end', set_of([of_end]), &
                           is_default=.true., always_exists=.true., proof_of=proof_of_theta), &
            sweep_column_t('phi_end', 'rad', 'precession angle at the end of the span', &
                           'end', set_of(end_and_turns), is_default=.true., always_exists=.true., proof_of=proof_of_phi), &
            sweep_column_t('psi_end', 'rad', 'spin angle at the end of the span', &
                           'end', set_of(end_and_turns), is_default=.true., always_exists=.true., proof_of=proof_of_psi), &
            sweep_column_t('theta_rate_end', 'rad/s', 'nutation rate at the end of the span', 'end', set_of([of_end]), &
                           is_default=.true.), &
            sweep_column_t('energy_error_max', '', 'largest relative energy error at the ends of steps (exact: one step)', &
                           'energy', set_of([of_energy]), is_default=.true., always_exists=.true.), &
            sweep_column_t('orientation_error', 'rad', 'rotation angle from the exact attitude at the end', &
                           'oracle', set_of([of_oracle]), is_default=.true., explain=explain_no_exact_motion), &
            sweep_column_t('inherent_error', 'rad', 'error of that attitude due to rounding of the data', &
                           'inherent', set_of([of_inherent]), explain=explain_no_exact_motion), &
            sweep_column_t('evaluations', '', 'RHS evaluations', 'cost', set_of([of_cost]), is_default=.true.), &
            sweep_column_t('motion_class', '', 'loop, cusp, wave, steady, ... (categorical)', &
                           'details', set_of([of_details, of_measured, of_whole, of_class]), is_class=.true.), &
            sweep_column_t('spin_per_nutation', 'rad', &
                           'change of psi in a nutation, without the half turns at exact passages of a pole', &
                           'details', set_of([of_details, of_measured, of_whole])), &
            sweep_column_t('theta_rate_max', 'rad/s', 'largest magnitude of the nutation rate', &
                           'details', set_of([of_details, of_measured, of_nutation_rate])), &
            sweep_column_t('force_max', 'N', 'maximum support force', &
                           'details', set_of([of_details, of_measured, of_force])), &
            sweep_column_t('force_z_min', 'N', 'minimum vertical support force', &
                           'details', set_of([of_details, of_measured, of_vertical_force])), &
            sweep_column_t('force_z_max', 'N', 'maximum vertical support force', &
                           'details', set_of([of_details, of_measured, of_vertical_force])), &
            sweep_column_t('t_end', 's', 'end of the span, or time of the event that ended the motion', &
                           'end', set_of([of_end]), is_default=.true., is_end=.true., always_exists=.true.), &
            sweep_column_t('t_stuck', 's', 'time at which dry friction stopped the body, to the end of the span', &
                           'end', set_of([of_end]), explain=explain_not_stuck), &
            stability_columns(), sweep_free_columns(), sweep_proof_columns()]
        columns%place = [(i, i=1, size(columns))]
    end function sweep_columns

    !> The columns of the stability of the motion.
    function stability_columns() result(columns)
        type(sweep_column_t), allocatable :: columns(:)
        columns = [ &
            sweep_column_t('critical_omega3', 'rad/s', &
                           'omega3 from which the sleeping top is stable, 2 sqrt(m g l I1)/I3, for its inertia and weight', &
                           'sleeping', set_of([of_threshold]), explain=explain_no_threshold), &
            sweep_column_t('sleeping_ratio', '', &
                           'magnitude of omega3 at the start, with h/I3 of a rotor, over critical_omega3', &
                           'sleeping', set_of([of_threshold]), explain=explain_no_threshold), &
            sweep_column_t('growth_rate', '1/s', 'growth rate of perturbations of a steady motion', &
                           'growth', set_of([of_growth])), &
            sweep_column_t('lyapunov_exponent', '1/s', &
                           'mean growth rate of a perturbation, with equal components except along Gamma', &
                           'lyapunov', set_of([of_lyapunov])), &
            sweep_column_t('largest_singular_value', '', &
                           'largest singular value of the tangent map over the span, in the scales of the motion', &
                           'singular', set_of([of_singular])), &
            sweep_column_t('upright_multiplier', '', &
                           'largest Floquet multiplier with the centre of mass above the pivot, vibrated vertically', &
                           'multiplier', set_of([of_multiplier]))]
    end function stability_columns

    !> The columns of a table.
    function columns_at(chosen) result(columns)
        type(chosen_column_t), intent(in) :: chosen(:) !! as they were chosen
        type(sweep_column_t), allocatable :: columns(:), known(:)
        ! Not on the stack, which may be small.
        allocate (known, source=sweep_columns())
        columns = known(chosen%place)
        columns%name = chosen%name
        columns%unit = chosen%unit
        columns%size = chosen%size
    end function columns_at

    !> What columns need, as flags.
    pure function work_for(columns) result(wanted)
        type(sweep_column_t), intent(in) :: columns(:) !! the columns
        logical :: wanted(kinds_of_work)
        integer :: i
        wanted = [(any(columns%needs(i)), i=1, kinds_of_work)]
    end function work_for

    !> The columns, in the order of the documentation.
    function sweep_free_columns() result(columns)
        type(sweep_column_t), allocatable :: columns(:)
        columns = [ &
            sweep_column_t('momentum_period', 's', 'period of the angular momentum in a free body', &
                           'free', set_of([of_free])), &
            sweep_column_t('momentum_turn', 'rad', 'turn about the momentum in that period', 'free', set_of([of_free])), &
            sweep_column_t('momentum_turn_geometric', 'rad', 'geometric phase, momentum_turn less 2 E momentum_period/L', &
                           'free', set_of([of_free, of_geometric])), &
            sweep_column_t('momentum_axis', '', 'body axis about which the angular momentum circulates (1, 2, 3)', &
                           'free', set_of([of_free])), &
            sweep_column_t('omega_max', 'rad/s', 'maximum angular velocity of a free body', 'free', set_of([of_free]))]
    end function sweep_free_columns

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

end module spintop_sweep_columns
