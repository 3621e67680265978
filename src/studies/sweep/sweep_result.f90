!> What a sweep has to compute, and what it computes of a case: a number per column of its table, NaN for what
!> does not exist or was not asked for.
module spintop_sweep_result
    use spintop_certificate, only: proof_count, proof_of_phi, proof_of_psi, proof_of_theta, proof_words
    use spintop_kinds, only: dp, nan => no_number
    use spintop_nutation_recorder, only: no_class
    implicit none
    private
    public :: sweep_result_t, value_count, proof_cells, kinds_of_work, set_of, asks_for_span, of_nutation, of_range, of_whole, &
        of_measured, of_fastest, of_lowest, of_details, of_class, of_nutation_rate, of_force, of_vertical_force, &
        of_fast_top, of_period, of_end, of_turns, of_energy, of_oracle, of_inherent, of_cost, of_growth, of_lyapunov, &
        of_singular, of_multiplier, of_free, of_proof, of_threshold, of_geometric

    !> Whether the bounds of a case are proved: `none` without a result.
    character(*), parameter :: proof_cells(0:2) = [character(8) :: 'none', proof_words]

    !> What is to be computed, as indices of what is wanted: groups of quantities, and those that take a search of their own
    !> where they are measured along the motion. Those of the stability of the motion are side by side.
    integer, parameter :: of_nutation = 1           !! extremes and means of the nutation
    integer, parameter :: of_range = 2              !! the range of theta
    integer, parameter :: of_whole = 3              !! what needs a whole nutation
    integer, parameter :: of_measured = 4           !! more of the nutation, which is measured unless the body is symmetric
    integer, parameter :: of_fastest = 5            !! the largest precession rate
    integer, parameter :: of_lowest = 6             !! the minimum height of the centre of mass
    integer, parameter :: of_details = 7            !! more of the whole nutation, and extremes of rates and forces
    integer, parameter :: of_class = 8              !! the class of the motion
    integer, parameter :: of_nutation_rate = 9      !! the largest nutation rate
    integer, parameter :: of_force = 10             !! the largest force
    integer, parameter :: of_vertical_force = 11    !! the extremes of the vertical force
    integer, parameter :: of_fast_top = 12          !! the paper's formulas
    integer, parameter :: of_period = 13            !! the azimuth after a period
    integer, parameter :: of_end = 14               !! the end of the span
    integer, parameter :: of_turns = 15             !! phi and psi with all their turns
    integer, parameter :: of_energy = 16            !! the largest energy error
    integer, parameter :: of_oracle = 17            !! the comparison with the exact motion
    integer, parameter :: of_inherent = 18          !! the accuracy that the data allow
    integer, parameter :: of_cost = 19              !! the cost
    integer, parameter :: of_growth = 20            !! the stability of the start
    integer, parameter :: of_lyapunov = 21          !! the Lyapunov exponent
    integer, parameter :: of_singular = 22          !! the largest singular value
    integer, parameter :: of_multiplier = 23        !! the Floquet multipliers over a period of the vibration
    integer, parameter :: of_free = 24              !! the constants of a free motion
    integer, parameter :: of_proof = 25             !! bounds of the errors
    integer, parameter :: of_threshold = 26         !! the threshold of the sleeping top
    integer, parameter :: of_geometric = 27         !! the geometric phase of a free motion
    integer, parameter :: kinds_of_work = of_geometric

    !> Number of values in the list of a result, as many as there are columns.
    integer, parameter :: value_count = 49

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
        real(dp) :: momentum_period = nan, momentum_turn = nan, momentum_turn_geometric = nan
        real(dp) :: momentum_axis = nan, omega_max = nan
        real(dp) :: critical_omega3 = nan, sleeping_ratio = nan
        real(dp) :: growth_rate = nan
        real(dp) :: lyapunov_exponent = nan
        real(dp) :: largest_singular_value = nan, upright_multiplier = nan
        integer :: motion_class = no_class
        !> Bounds of the errors, by quantity (spintop_certificate), and the index in `proof_cells`.
        real(dp) :: bounds(proof_count) = nan
        integer :: proof = 0
    contains
        procedure :: list
    end type sweep_result_t

contains

    !> What is wanted, as flags.
    pure function set_of(members) result(wanted)
        integer, intent(in) :: members(:) !! indices of groups, such as `of_end`
        logical :: wanted(kinds_of_work)
        integer :: i
        wanted = [(any(members == i), i=1, kinds_of_work)]
    end function set_of

    !> Whether anything depends on the span of a motion whose nutation has a closed form.
    pure logical function asks_for_span(wanted)
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        asks_for_span = any(wanted([of_period, of_end, of_energy, of_oracle, of_cost, of_inherent])) .or. &
            any(wanted(of_growth:of_multiplier))
    end function asks_for_span

    !> All values, in the order of the columns (spintop_sweep_columns).
    pure function list(self) result(values)
        class(sweep_result_t), intent(in) :: self
        real(dp) :: values(value_count)
        values = [self%theta_min, self%theta_max, self%delta_u, self%delta_u_fast_top, self%nutation_period, &
                  self%nutation_rate, self%nutation_rate_fast_top, self%precession_per_nutation, self%precession_rate, &
                  self%precession_rate_fast_top, self%nutations_per_turn, self%nutations_per_turn_fast_top, &
                  self%precession_period, self%azimuth_after_period_deg, self%nutations_in_period, self%phi_rate_max, &
                  self%fast_top_ratio, self%com_z_min, self%theta_end, self%phi_end, self%psi_end, self%theta_rate_end, &
                  self%energy_error_max, self%orientation_error, self%inherent_error, self%evaluations, &
                  real(self%motion_class, dp), self%spin_per_nutation, self%theta_rate_max, self%force_max, &
                  self%force_z_min, self%force_z_max, self%t_end, self%t_stuck, self%critical_omega3, &
                  self%sleeping_ratio, self%growth_rate, self%lyapunov_exponent, self%largest_singular_value, &
                  self%upright_multiplier, &
                  self%momentum_period, self%momentum_turn, self%momentum_turn_geometric, self%momentum_axis, self%omega_max, &
                  self%bounds([proof_of_theta, proof_of_phi, proof_of_psi]), real(self%proof, dp)]
    end function list

end module spintop_sweep_result
