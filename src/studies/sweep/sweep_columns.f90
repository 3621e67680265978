!> The quantities of a sweep table: one row of the table below each; the help, the choice of
!> columns, the units in the header and the computation derive from it.
module spintop_sweep_columns
    implicit none
    private
    public :: sweep_column_t, sweep_columns
    public :: group_nutation, group_fast_top, group_period, group_end, group_energy, group_oracle, &
        group_cost, group_inherent, group_details, group_growth, group_lyapunov, group_singular, &
        sweep_groups, costly_groups

    public :: quantities
    public :: q_theta_min, q_theta_max, q_delta_u, q_delta_u_fast_top, q_nutation_period
    public :: q_nutation_rate, q_nutation_rate_fast_top, q_precession_per_nutation
    public :: q_precession_rate, q_precession_rate_fast_top, q_nutations_per_turn
    public :: q_nutations_per_turn_fast_top, q_precession_period, q_azimuth_after_period_deg
    public :: q_nutations_in_period, q_phi_rate_max, q_fast_top_ratio, q_com_z_min, q_theta_end
    public :: q_phi_end, q_psi_end, q_theta_rate_end, q_energy_error_max, q_orientation_error
    public :: q_inherent_error, q_evaluations, q_motion_class, q_spin_per_nutation
    public :: q_theta_rate_max, q_force_max, q_force_z_min, q_force_z_max, q_t_end, q_growth_rate
    public :: q_lyapunov_exponent, q_largest_singular_value

    !> What a table says of a quantity.
    type :: sweep_column_t
        character(28) :: name
        character(8) :: unit
        character(96) :: what
        !> Quantities of a group are computed together, when one of them is asked for.
        integer :: group
    end type sweep_column_t

    !> The whole nutation; the paper's formulas; the azimuth after a period; the end of the span;
    !> the largest energy error; the comparison with the exact motion; what it cost; the
    !> accuracy that the data allow; more of the whole nutation; stability of the start and of the
    !> motion.
    integer, parameter :: group_nutation = 1, group_fast_top = 2, group_period = 3, group_end = 4, &
        group_energy = 5, group_oracle = 6, group_cost = 7, group_inherent = 8, &
        group_details = 9, group_growth = 10, group_lyapunov = 11, group_singular = 12, &
        sweep_groups = group_singular
    !> What costs much more than the rest is for those who name it.
    integer, parameter :: costly_groups(*) = [group_inherent, group_details, group_growth, group_lyapunov, &
                                                group_singular]

    !> Places of the quantities in the table below, which has them in this order.
    enum, bind(C)
        enumerator :: q_theta_min = 1
        enumerator :: q_theta_max, q_delta_u, q_delta_u_fast_top, q_nutation_period
        enumerator :: q_nutation_rate, q_nutation_rate_fast_top, q_precession_per_nutation
        enumerator :: q_precession_rate, q_precession_rate_fast_top, q_nutations_per_turn
        enumerator :: q_nutations_per_turn_fast_top, q_precession_period
        enumerator :: q_azimuth_after_period_deg, q_nutations_in_period, q_phi_rate_max
        enumerator :: q_fast_top_ratio, q_com_z_min, q_theta_end, q_phi_end, q_psi_end
        enumerator :: q_theta_rate_end, q_energy_error_max, q_orientation_error, q_inherent_error
        enumerator :: q_evaluations, q_motion_class, q_spin_per_nutation, q_theta_rate_max
        enumerator :: q_force_max, q_force_z_min, q_force_z_max, q_t_end, q_growth_rate, q_lyapunov_exponent
        enumerator :: q_largest_singular_value
    end enum
    integer, parameter :: quantities = q_largest_singular_value

    !> All quantities, in the order of the table's documentation.
    type(sweep_column_t), parameter :: sweep_columns(quantities) = [ &
        sweep_column_t('theta_min', 'rad', 'minimum nutation angle', group_nutation), &
        sweep_column_t('theta_max', 'rad', 'maximum nutation angle', group_nutation), &
        sweep_column_t('delta_u', '', 'range of cos(theta)', group_nutation), &
        sweep_column_t('delta_u_fast_top', '', 'the same by Eq 29', group_fast_top), &
        sweep_column_t('nutation_period', 's', 'nutation period', group_nutation), &
        sweep_column_t('nutation_rate', 'rad/s', '2 pi over the nutation period', group_nutation), &
        sweep_column_t('nutation_rate_fast_top', 'rad/s', 'the same by Eq 30', group_fast_top), &
        sweep_column_t('precession_per_nutation', 'rad', &
                       'change of phi in a nutation, without the half turns at exact passages of a pole', group_nutation), &
        sweep_column_t('precession_rate', 'rad/s', 'mean precession rate', group_nutation), &
        sweep_column_t('precession_rate_fast_top', 'rad/s', 'the same by Eq 32', group_fast_top), &
        sweep_column_t('nutations_per_turn', '', 'nutations per full turn of precession', group_nutation), &
        sweep_column_t('nutations_per_turn_fast_top', '', 'the same by Eq 54', group_fast_top), &
        sweep_column_t('precession_period', 's', 'T_p = 2 pi I3 omega3/(m g l) of the paper', group_fast_top), &
        sweep_column_t('azimuth_after_period_deg', 'deg', 'change of phi after T_p', group_period), &
        sweep_column_t('nutations_in_period', '', 'nutations in T_p', group_nutation), &
        sweep_column_t('phi_rate_max', 'rad/s', 'precession rate that is largest in magnitude', group_nutation), &
        sweep_column_t('fast_top_ratio', '', '(I3 omega3)^2/(2 I1 m g l), large for a fast top', group_fast_top), &
        sweep_column_t('com_z_min', 'm', 'minimum height of the centre of mass above the pivot', group_nutation), &
        sweep_column_t('theta_end', 'rad', 'inclination at the end of the span', group_end), &
        sweep_column_t('phi_end', 'rad', 'precession angle at the end of the span', group_end), &
        sweep_column_t('psi_end', 'rad', 'spin angle at the end of the span', group_end), &
        sweep_column_t('theta_rate_end', 'rad/s', 'nutation rate at the end of the span', group_end), &
        sweep_column_t('energy_error_max', '', 'largest relative energy error in the span', group_energy), &
        sweep_column_t('orientation_error', 'rad', 'rotation angle from the exact attitude at the end', group_oracle), &
        sweep_column_t('inherent_error', 'rad', 'error of that attitude due to rounding of the data', group_inherent), &
        sweep_column_t('evaluations', '', 'RHS evaluations', group_cost), &
        sweep_column_t('motion_class', '', 'loop, cusp, wave, steady, ... (categorical)', group_details), &
        sweep_column_t('spin_per_nutation', 'rad', &
                       'change of psi in a nutation, without the half turns at exact passages of a pole', group_details), &
        sweep_column_t('theta_rate_max', 'rad/s', 'maximum nutation rate', group_details), &
        sweep_column_t('force_max', 'N', 'maximum support force', group_details), &
        sweep_column_t('force_z_min', 'N', 'minimum vertical support force', group_details), &
        sweep_column_t('force_z_max', 'N', 'maximum vertical support force', group_details), &
        sweep_column_t('t_end', 's', 'end of the span, or time of the event that ended the motion', group_end), &
        sweep_column_t('growth_rate', '1/s', 'growth rate of perturbations of a steady motion', group_growth), &
        sweep_column_t('lyapunov_exponent', '1/s', &
                       'mean growth rate of a perturbation, equal in all components but along Gamma', group_lyapunov), &
        sweep_column_t('largest_singular_value', '', &
                       'of the tangent map over the span, in the scales of the motion', &
                       group_singular)]

end module spintop_sweep_columns
