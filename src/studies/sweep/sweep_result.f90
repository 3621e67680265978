!> What a sweep computes of a case: a number per column of its table, NaN for what does not exist or was not
!> asked for.
module spintop_sweep_result
    use spintop_kinds, only: dp, nan => no_number
    use spintop_nutation_watch, only: no_class
    implicit none
    private
    public :: sweep_result_t

    !> The quantities of a case; their units and meanings are those of the columns.
    type :: sweep_result_t
        real(dp) :: theta_min = nan, theta_max = nan, delta_u = nan
        real(dp) :: delta_u_fast_top = nan
        real(dp) :: nutation_period = nan, nutation_rate = nan
        real(dp) :: nutation_rate_fast_top = nan
        real(dp) :: precession_per_nutation = nan, precession_rate = nan
        real(dp) :: precession_rate_fast_top = nan
        real(dp) :: nutations_per_turn = nan
        real(dp) :: nutations_per_turn_fast_top = nan, precession_period = nan
        real(dp) :: azimuth_after_period_deg = nan
        real(dp) :: nutations_in_period = nan, phi_rate_max = nan
        real(dp) :: fast_top_ratio = nan
        real(dp) :: com_z_min = nan
        real(dp) :: theta_end = nan, phi_end = nan, psi_end = nan, theta_rate_end = nan
        real(dp) :: energy_error_max = nan
        real(dp) :: orientation_error = nan
        real(dp) :: inherent_error = nan
        real(dp) :: evaluations = nan
        real(dp) :: spin_per_nutation = nan, theta_rate_max = nan, force_max = nan
        real(dp) :: force_z_min = nan, force_z_max = nan
        real(dp) :: t_end = nan, t_stuck = nan
        real(dp) :: growth_rate = nan
        real(dp) :: lyapunov_exponent = nan
        real(dp) :: largest_singular_value = nan
        integer :: motion_class = no_class
    end type sweep_result_t

end module spintop_sweep_result
