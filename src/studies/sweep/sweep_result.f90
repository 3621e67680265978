!> What a sweep has to compute, and what it computes of a case: a number per column of its table, NaN for what
!> does not exist or was not asked for.
module spintop_sweep_result
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_certificate, only: proof_count, proof_words
    use spintop_kinds, only: dp, nan => no_number
    use spintop_nutation_watch, only: no_class
    implicit none
    private
    public :: sweep_result_t, sweep_work_t, proof_cells

    !> Whether the bounds of a case are proved: `none` without a result.
    character(*), parameter :: proof_cells(0:2) = [character(8) :: 'none', proof_words]

    !> What is to be computed: the groups, and the extremes of the nutation that take a search of their own where
    !> it is measured along the motion.
    type :: sweep_work_t
        logical :: nutation = .false. !! the whole nutation
        logical :: fast_top = .false. !! the paper's formulas
        logical :: period = .false. !! the azimuth after a period
        logical :: end = .false. !! the end of the span
        logical :: energy = .false. !! the largest energy error
        logical :: oracle = .false. !! the comparison with the exact motion
        logical :: inherent = .false. !! the accuracy that the data allow
        logical :: cost = .false. !! the cost
        logical :: details = .false. !! more of the whole nutation, and extremes of rates and forces
        logical :: whole = .false. !! what needs a whole nutation
        logical :: turning = .false. !! what follows from turning points
        logical :: growth = .false. !! the stability of the start
        logical :: lyapunov = .false. !! the Lyapunov exponent
        logical :: singular = .false. !! the largest singular value
        logical :: multiplier = .false. !! the Floquet multipliers over a period of the vibration
        logical :: fastest = .false. !! the largest precession rate
        logical :: for_class = .false. !! that rate for the class alone
        logical :: lowest = .false. !! the minimum height of the centre of mass
        logical :: nutation_rate = .false. !! the largest nutation rate
        logical :: vertical_force = .false. !! the extremes of the vertical force
        logical :: force = .false. !! the largest force
        logical :: free = .false. !! the constants of a free motion
        logical :: range = .false. !! the range of theta
        logical :: measured = .false. !! more of the nutation, which is measured unless the body is symmetric
        logical :: turns = .false. !! phi and psi with all their turns
        logical :: proof = .false. !! bounds of the errors
    contains
        procedure :: stability => wants_stability
    end type sweep_work_t

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
        real(dp) :: momentum_period = nan, momentum_turn = nan, momentum_axis = nan, omega_max = nan
        real(dp) :: growth_rate = nan
        real(dp) :: lyapunov_exponent = nan
        real(dp) :: largest_singular_value = nan, upright_multiplier = nan
        integer :: motion_class = no_class
        !> Bounds of the errors, by quantity (spintop_certificate), and the index in `proof_cells`.
        real(dp) :: bounds(proof_count) = nan
        integer :: proof = 0
        !> What is left to be found together for a block of cases (`put_perturbations`): the end of the motion, s, up to
        !> which the growth of perturbations and the inherent error are wanted, and the largest number of steps for each.
        real(dp) :: growth_until = 0, inherent_until = 0
        integer(int64) :: most_steps = 0
    end type sweep_result_t

contains

    !> Whether any quantity of the stability of the motion is wanted.
    pure logical function wants_stability(self)
        class(sweep_work_t), intent(in) :: self
        wants_stability = self%growth .or. self%lyapunov .or. self%singular .or. self%multiplier
    end function wants_stability

end module spintop_sweep_result
