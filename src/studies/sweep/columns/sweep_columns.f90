!> The columns of a sweep table that are quantities of its cases: a line of the registry and a procedure each.
!> The help, the choice of columns, the units in the header and the cells derive from it.
!>
!> What a column needs is computed for a case by the procedure of its group. The column then fills its cells
!> for a block of cases at once, so that a sweep of many cases calls a procedure per block and not per cell.
module spintop_sweep_columns
    use spintop_kinds, only: dp
    use spintop_study_column, only: proof_group
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_free_columns, only: sweep_free_columns
    use spintop_sweep_proof_columns, only: sweep_proof_columns
    use spintop_sweep_quantities, only: explain_no_exact_motion, explain_no_inherent_error, explain_no_period, &
        explain_not_stuck
    use spintop_sweep_result, only: sweep_result_t, sweep_work_t
    implicit none
    private
    public :: sweep_columns, sweep_work_t, work_for

contains

    !> All columns, in the order of the documentation.
    function sweep_columns() result(columns)
        type(sweep_column_t), allocatable :: columns(:)
        columns = [ &
            sweep_column_t('theta_min', 'rad', 'minimum nutation angle', &
                           'nutation', fill_theta_min, is_default=.true.), &
            sweep_column_t('theta_max', 'rad', 'maximum nutation angle', &
                           'nutation', fill_theta_max, is_default=.true.), &
            sweep_column_t('delta_u', '', 'range of cos(theta)', 'nutation', fill_delta_u, is_default=.true.), &
            sweep_column_t('delta_u_fast_top', '', 'the same by Eq 29', 'fast_top', fill_delta_u_fast_top, is_default=.true.), &
            sweep_column_t('nutation_period', 's', 'nutation period', 'nutation', fill_nutation_period, is_default=.true.), &
            sweep_column_t('nutation_rate', 'rad/s', '2 pi over the nutation period', &
                           'nutation', fill_nutation_rate, is_default=.true.), &
            sweep_column_t('nutation_rate_fast_top', 'rad/s', 'the same by Eq 30', &
                           'fast_top', fill_nutation_rate_fast_top, is_default=.true.), &
            sweep_column_t('precession_per_nutation', 'rad', &
                           'change of phi in a nutation, without the half turns at exact passages of a pole', &
                           'nutation', fill_precession_per_nutation, is_default=.true.), &
            sweep_column_t('precession_rate', 'rad/s', 'mean precession rate', &
                           'nutation', fill_precession_rate, is_default=.true.), &
            sweep_column_t('precession_rate_fast_top', 'rad/s', 'the same by Eq 32', &
                           'fast_top', fill_precession_rate_fast_top, is_default=.true.), &
            sweep_column_t('nutations_per_turn', '', 'nutations per full turn of precession', &
                           'nutation', fill_nutations_per_turn, is_default=.true.), &
            sweep_column_t('nutations_per_turn_fast_top', '', 'the same by Eq 54', &
                           'fast_top', fill_nutations_per_turn_fast_top, is_default=.true.), &
            sweep_column_t('precession_period', 's', 'T_p = 2 pi I3 omega3/(m g l) of the paper', &
                           'fast_top', fill_precession_period, is_default=.true.), &
            sweep_column_t('azimuth_after_period_deg', 'deg', &
                           'change of phi after T_p', &
                           'period', fill_azimuth_after_period_deg, is_default=.true.), &
            sweep_column_t('nutations_in_period', '', 'nutations in T_p', &
                           'nutation', fill_nutations_in_period, is_default=.true., explain=explain_no_period), &
            sweep_column_t('phi_rate_max', 'rad/s', 'precession rate that is largest in magnitude', &
                           'nutation', fill_phi_rate_max, is_default=.true.), &
            sweep_column_t('fast_top_ratio', '', '(I3 omega3)^2/(2 I1 m g l), large for a fast top', &
                           'fast_top', fill_fast_top_ratio, is_default=.true.), &
            sweep_column_t('com_z_min', 'm', 'minimum height of the centre of mass above the pivot', &
                           'nutation', fill_com_z_min, is_default=.true.), &
            sweep_column_t('theta_end', 'rad', 'inclination at the end of the span', &
                           'end', fill_theta_end, is_default=.true., always_exists=.true.), &
            sweep_column_t('phi_end', 'rad', 'precession angle at the end of the span', &
                           'end', fill_phi_end, is_default=.true., always_exists=.true.), &
            sweep_column_t('psi_end', 'rad', 'spin angle at the end of the span', &
                           'end', fill_psi_end, is_default=.true., always_exists=.true.), &
            sweep_column_t('theta_rate_end', 'rad/s', 'nutation rate at the end of the span', &
                           'end', fill_theta_rate_end, is_default=.true.), &
            sweep_column_t('energy_error_max', '', 'largest relative energy error at the ends of steps (exact: one step)', &
                           'energy', fill_energy_error_max, is_default=.true., always_exists=.true.), &
            sweep_column_t('orientation_error', 'rad', 'rotation angle from the exact attitude at the end', &
                           'oracle', fill_orientation_error, is_default=.true., explain=explain_no_exact_motion), &
            sweep_column_t('inherent_error', 'rad', 'error of that attitude due to rounding of the data', &
                           'inherent', fill_inherent_error, explain=explain_no_inherent_error), &
            sweep_column_t('evaluations', '', 'RHS evaluations', 'cost', fill_evaluations, is_default=.true.), &
            sweep_column_t('motion_class', '', 'loop, cusp, wave, steady, ... (categorical)', &
                           'details', fill_motion_class, is_class=.true.), &
            sweep_column_t('spin_per_nutation', 'rad', &
                           'change of psi in a nutation, without the half turns at exact passages of a pole', &
                           'details', fill_spin_per_nutation), &
            sweep_column_t('theta_rate_max', 'rad/s', 'largest magnitude of the nutation rate', &
                           'details', fill_theta_rate_max), &
            sweep_column_t('force_max', 'N', 'maximum support force', 'details', fill_force_max), &
            sweep_column_t('force_z_min', 'N', 'minimum vertical support force', 'details', fill_force_z_min), &
            sweep_column_t('force_z_max', 'N', 'maximum vertical support force', 'details', fill_force_z_max), &
            sweep_column_t('t_end', 's', 'end of the span, or time of the event that ended the motion', &
                           'end', fill_t_end, is_default=.true., always_exists=.true.), &
            sweep_column_t('t_stuck', 's', 'time at which dry friction stopped the body, to the end of the span', &
                           'end', fill_t_stuck, explain=explain_not_stuck), &
            sweep_column_t('growth_rate', '1/s', 'growth rate of perturbations of a steady motion', &
                           'growth', fill_growth_rate), &
            sweep_column_t('lyapunov_exponent', '1/s', &
                           'mean growth rate of a perturbation, with equal components except along Gamma', &
                           'lyapunov', fill_lyapunov_exponent), &
            sweep_column_t('largest_singular_value', '', &
                           'largest singular value of the tangent map over the span, in the scales of the motion', &
                           'singular', fill_largest_singular_value), &
            sweep_column_t('upright_multiplier', '', &
                           'largest Floquet multiplier with the centre of mass above the pivot, vibrated vertically', &
                           'multiplier', fill_upright_multiplier), &
            sweep_free_columns(), sweep_proof_columns()]
    end function sweep_columns

    !> What columns need.
    pure type(sweep_work_t) function work_for(columns) result(work)
        type(sweep_column_t), intent(in) :: columns(:) !! the columns
        work%nutation = any(columns%group == 'nutation')
        work%fast_top = any(columns%group == 'fast_top')
        work%period = any(columns%group == 'period')
        work%end = any(columns%group == 'end')
        work%energy = any(columns%group == 'energy')
        work%oracle = any(columns%group == 'oracle')
        work%inherent = any(columns%group == 'inherent')
        work%cost = any(columns%group == 'cost')
        work%details = any(columns%group == 'details')
        work%growth = any(columns%group == 'growth')
        work%lyapunov = any(columns%group == 'lyapunov')
        work%singular = any(columns%group == 'singular')
        work%multiplier = any(columns%group == 'multiplier')
        ! The class of a motion derives from the largest precession rate.
        work%fastest = any(columns%name == 'phi_rate_max' .or. columns%name == 'motion_class')
        work%for_class = work%fastest .and. .not. any(columns%name == 'phi_rate_max')
        work%lowest = any(columns%name == 'com_z_min')
        work%free = any(columns%group == 'free')
        associate (in_range => columns%name == 'theta_min' .or. columns%name == 'theta_max' .or. columns%name == 'delta_u')
            work%range = any(in_range)
            work%measured = work%details .or. any(columns%group == 'nutation' .and. .not. in_range)
            ! The others of this group are extremes over the span.
            work%whole = any(columns%group == 'nutation' .and. &
                             .not. (in_range .or. columns%name == 'phi_rate_max' .or. columns%name == 'com_z_min'))
        end associate
        work%turns = work%period .or. any(columns%name == 'phi_end' .or. columns%name == 'psi_end')
        work%proof = any(columns%group == proof_group)
        ! A bound is that of a number.
        work%end = work%end .or. any(columns%group == proof_group .and. index(columns%name, '_end') > 0)
        associate (proves_nutation => any(columns%group == proof_group .and. index(columns%name, '_end') == 0))
            work%nutation = work%nutation .or. proves_nutation
            work%whole = work%whole .or. proves_nutation
        end associate
        work%whole = work%whole .or. any(columns%name == 'spin_per_nutation' .or. columns%name == 'motion_class')
        work%turning = work%whole .or. work%range
        work%nutation_rate = any(columns%name == 'theta_rate_max')
        work%vertical_force = any(columns%name == 'force_z_min' .or. columns%name == 'force_z_max')
        work%force = any(columns%name == 'force_max')
    end function work_for

    pure subroutine fill_theta_min(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%theta_min
    end subroutine fill_theta_min

    pure subroutine fill_theta_max(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%theta_max
    end subroutine fill_theta_max

    pure subroutine fill_delta_u(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%delta_u
    end subroutine fill_delta_u

    pure subroutine fill_delta_u_fast_top(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%delta_u_fast_top
    end subroutine fill_delta_u_fast_top

    pure subroutine fill_nutation_period(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%nutation_period
    end subroutine fill_nutation_period

    pure subroutine fill_nutation_rate(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%nutation_rate
    end subroutine fill_nutation_rate

    pure subroutine fill_nutation_rate_fast_top(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%nutation_rate_fast_top
    end subroutine fill_nutation_rate_fast_top

    pure subroutine fill_precession_per_nutation(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%precession_per_nutation
    end subroutine fill_precession_per_nutation

    pure subroutine fill_precession_rate(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%precession_rate
    end subroutine fill_precession_rate

    pure subroutine fill_precession_rate_fast_top(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%precession_rate_fast_top
    end subroutine fill_precession_rate_fast_top

    pure subroutine fill_nutations_per_turn(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%nutations_per_turn
    end subroutine fill_nutations_per_turn

    pure subroutine fill_nutations_per_turn_fast_top(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%nutations_per_turn_fast_top
    end subroutine fill_nutations_per_turn_fast_top

    pure subroutine fill_precession_period(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%precession_period
    end subroutine fill_precession_period

    pure subroutine fill_azimuth_after_period_deg(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%azimuth_after_period_deg
    end subroutine fill_azimuth_after_period_deg

    pure subroutine fill_nutations_in_period(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%nutations_in_period
    end subroutine fill_nutations_in_period

    pure subroutine fill_phi_rate_max(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%phi_rate_max
    end subroutine fill_phi_rate_max

    pure subroutine fill_fast_top_ratio(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%fast_top_ratio
    end subroutine fill_fast_top_ratio

    pure subroutine fill_com_z_min(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%com_z_min
    end subroutine fill_com_z_min

    pure subroutine fill_theta_end(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%theta_end
    end subroutine fill_theta_end

    pure subroutine fill_phi_end(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%phi_end
    end subroutine fill_phi_end

    pure subroutine fill_psi_end(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%psi_end
    end subroutine fill_psi_end

    pure subroutine fill_theta_rate_end(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%theta_rate_end
    end subroutine fill_theta_rate_end

    pure subroutine fill_energy_error_max(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%energy_error_max
    end subroutine fill_energy_error_max

    pure subroutine fill_orientation_error(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%orientation_error
    end subroutine fill_orientation_error

    pure subroutine fill_inherent_error(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%inherent_error
    end subroutine fill_inherent_error

    pure subroutine fill_evaluations(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%evaluations
    end subroutine fill_evaluations

    pure subroutine fill_motion_class(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%motion_class
    end subroutine fill_motion_class

    pure subroutine fill_spin_per_nutation(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%spin_per_nutation
    end subroutine fill_spin_per_nutation

    pure subroutine fill_theta_rate_max(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%theta_rate_max
    end subroutine fill_theta_rate_max

    pure subroutine fill_force_max(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%force_max
    end subroutine fill_force_max

    pure subroutine fill_force_z_min(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%force_z_min
    end subroutine fill_force_z_min

    pure subroutine fill_force_z_max(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%force_z_max
    end subroutine fill_force_z_max

    pure subroutine fill_t_end(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%t_end
    end subroutine fill_t_end

    pure subroutine fill_t_stuck(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%t_stuck
    end subroutine fill_t_stuck

    pure subroutine fill_growth_rate(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%growth_rate
    end subroutine fill_growth_rate

    pure subroutine fill_lyapunov_exponent(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%lyapunov_exponent
    end subroutine fill_lyapunov_exponent

    pure subroutine fill_largest_singular_value(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%largest_singular_value
    end subroutine fill_largest_singular_value

    pure subroutine fill_upright_multiplier(results, cells)
        type(sweep_result_t), intent(in) :: results(:)
        real(dp), intent(out) :: cells(:)
        cells = results%upright_multiplier
    end subroutine fill_upright_multiplier

end module spintop_sweep_columns
