!> What a sweep has to compute, and what it computes of a case: a number for each of its columns, NaN for what does not exist or
!> was not asked for. Notes on a case name the quantities that do not exist, and the reasons.
!>
!> A column is a place among the quantities of a case, and a line of the registry, which says what the column needs. The help,
!> the choice of columns, the units in the header and the cells derive from the registry.
module spintop_sweep_result
    use spintop_certificate, only: proof_words
    use spintop_kinds, only: dp, nan => no_number
    use spintop_study_column, only: always, by_default, categorical, column => study_column_t, compares, is_end, proof_group
    implicit none
    public
    private :: dp, nan, proof_words, always, by_default, categorical, column, &
        compares, is_end, proof_group, k, nothing, clear, add, explain, has

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

    !> What several columns need.
    integer, parameter, private :: range_of_theta = 2**of_nutation + 2**of_range, end_and_turns = 2**of_end + 2**of_turns, &
        whole_nutation = 2**of_nutation + 2**of_whole + 2**of_measured, end_and_bounds = 2**of_end + 2**of_proof, &
        measured_nutation = 2**of_nutation + 2**of_measured, details = 2**of_details + 2**of_measured, whole = 2**of_whole, &
        formulas = 2**of_fast_top, the_end = 2**of_end, threshold = 2**of_threshold, constants = 2**of_free

    !> The quantities of a case: their places among its values.
    enum, bind(C)
        enumerator :: at_theta_min = 1
        enumerator :: at_theta_max, at_delta_u, at_delta_u_fast_top, at_nutation_period, at_nutation_rate
        enumerator :: at_nutation_rate_fast_top, at_precession_per_nutation, at_precession_rate
        enumerator :: at_precession_rate_fast_top, at_nutations_per_turn, at_nutations_per_turn_fast_top
        enumerator :: at_precession_period, at_azimuth_after_period, at_nutations_in_period, at_phi_rate_max
        enumerator :: at_fast_top_ratio, at_com_z_min, at_theta_end, at_phi_end, at_psi_end
        enumerator :: at_theta_rate_end, at_energy_error_max, at_orientation_error, at_inherent_error
        enumerator :: at_evaluations, at_motion_class, at_spin_per_nutation, at_theta_rate_max, at_force_max
        enumerator :: at_force_z_min, at_force_z_max, at_t_end, at_t_stuck, at_critical_omega3
        enumerator :: at_sleeping_ratio, at_growth_rate, at_lyapunov_exponent, at_largest_singular_value
        enumerator :: at_upright_multiplier, at_momentum_period, at_momentum_turn
        enumerator :: at_momentum_turn_geometric, at_momentum_axis, at_omega_max, at_theta_end_bound
        enumerator :: at_phi_end_bound, at_psi_end_bound, at_proof
    end enum
    !> Number of values of a case.
    integer, parameter :: value_count = at_proof

    integer :: k
    !> What a case has as long as nothing is computed: no class, and no proof.
    real(dp), parameter :: nothing(value_count) = &
        [(merge(0.0_dp, nan, k == at_motion_class .or. k == at_proof), k=1, value_count)]

    !> The quantities of a case; their units and meanings are those of the columns.
    type :: sweep_result_t
        real(dp) :: of(value_count) = nothing
    end type sweep_result_t

    !> Why a case lacks what is measured by equations without effects.
    character(*), parameter :: only_without_effects = &
        'it is not measured for bodies with effects that do not only shift phi and psi'

    !> Indices of the notes in the list below, in this order.
    enum, bind(C)
        enumerator :: note_no_period = 1
        enumerator :: note_no_turns, note_no_nutation, note_no_class, note_no_fast_top, note_no_details
        enumerator :: note_no_azimuth, note_no_stop, note_no_growth, note_no_lyapunov
        enumerator :: note_no_singular, note_no_exact_motion, note_no_precession_period
        enumerator :: note_not_free, note_no_momentum_period, note_no_derivative, note_no_multiplier
        enumerator :: note_not_stuck, note_nothing_to_bound, note_no_threshold, note_no_turns_known
    end enum

    !> The notes, without the reason in a case.
    character(*), parameter :: note_names(note_no_turns_known) = [character(40) :: &
        'no nutation period', 'no nutations per turn', 'no full nutation in the span', 'no class', &
        'no fast-top formulas', 'no class and extremes', 'no azimuth after a period', &
        'stop_at did not occur in the span', 'no growth rate', &
        'no Lyapunov exponent', 'no largest singular value', 'no exact solution for comparison', &
        'no precession period T_p', 'not a free body', 'no period of the momentum', &
        'a derivative does not converge', 'no multipliers of a vibration', 'not stopped by dry friction', &
        'a bound of a number that does not exist', 'no threshold of a sleeping top', &
        'phi and psi may be off by whole turns']

    !> The notes on a case.
    type :: note_t
        !> A bit for each note of the list, from the lowest.
        integer :: flags = 0
        !> All notes as sentences; not allocated if there are none.
        character(:), allocatable :: text
    contains
        procedure :: clear
        procedure :: add
        procedure :: explain
        procedure :: has
    end type note_t

    !> The registry of the columns, in the order of the documentation.
    type(column), parameter, private :: registry(*) = [ &
        column('theta_min', 'rad', 'minimum nutation angle', 'nutation', at_theta_min, by_default, needs=range_of_theta), &
        column('theta_max', 'rad', 'maximum nutation angle', 'nutation', at_theta_max, by_default, needs=range_of_theta), &
        column('delta_u', '', 'range of cos(theta)', 'nutation', at_delta_u, by_default, needs=range_of_theta), &
        column('delta_u_fast_top', '', 'the same by Eq 29', 'fast_top', at_delta_u_fast_top, by_default, needs=formulas), &
        column('nutation_period', 's', 'nutation period', 'nutation', at_nutation_period, by_default, needs=whole_nutation), &
        column('nutation_rate', 'rad/s', '2 pi over the nutation period', &
               'nutation', at_nutation_rate, by_default, needs=whole_nutation), &
        column('nutation_rate_fast_top', 'rad/s', 'the same by Eq 30', &
               'fast_top', at_nutation_rate_fast_top, by_default, needs=formulas), &
        column('precession_per_nutation', 'rad', 'change of phi in a nutation, without the half turns at exact passages of a &
               &pole', 'nutation', at_precession_per_nutation, by_default, needs=whole_nutation), &
        column('precession_rate', 'rad/s', 'mean precession rate', &
               'nutation', at_precession_rate, by_default, needs=whole_nutation), &
        column('precession_rate_fast_top', 'rad/s', 'the same by Eq 32', &
               'fast_top', at_precession_rate_fast_top, by_default, needs=formulas), &
        column('nutations_per_turn', '', 'nutations per full turn of precession', &
               'nutation', at_nutations_per_turn, by_default, needs=whole_nutation), &
        column('nutations_per_turn_fast_top', '', 'the same by Eq 54', &
               'fast_top', at_nutations_per_turn_fast_top, by_default, needs=formulas), &
        column('precession_period', 's', 'T_p = 2 pi I3 omega3/(m g l) of the paper', &
               'fast_top', at_precession_period, by_default, needs=formulas), &
        column('azimuth_after_period_deg', 'deg', 'change of phi after T_p', &
               'period', at_azimuth_after_period, by_default, needs=2**of_period + 2**of_turns), &
        column('nutations_in_period', '', 'nutations in T_p', &
               'nutation', at_nutations_in_period, by_default, needs=whole_nutation, missing=note_no_precession_period), &
        column('phi_rate_max', 'rad/s', 'precession rate that is largest in magnitude', &
               'nutation', at_phi_rate_max, by_default, needs=measured_nutation + 2**of_fastest), &
        column('fast_top_ratio', '', '(I3 omega3)^2/(2 I1 m g l), large for a fast top', &
               'fast_top', at_fast_top_ratio, by_default, needs=formulas), &
        column('com_z_min', 'm', 'minimum height of the centre of mass above the pivot', &
               'nutation', at_com_z_min, by_default, needs=measured_nutation + 2**of_lowest), &
        column('theta_end', 'rad', 'inclination at the end of the span', 'end', at_theta_end, by_default + always, needs=the_end), &
        column('phi_end', 'rad', 'precession angle at the end of the span', &
               'end', at_phi_end, by_default + always, needs=end_and_turns), &
        column('psi_end', 'rad', 'spin angle at the end of the span', &
               'end', at_psi_end, by_default + always, needs=end_and_turns), &
        column('theta_rate_end', 'rad/s', 'nutation rate at the end of the span', &
               'end', at_theta_rate_end, by_default, needs=the_end), &
        column('energy_error_max', '', 'largest relative energy error at the ends of steps (exact: one step)', &
               'energy', at_energy_error_max, by_default + always, needs=2**of_energy), &
        column('orientation_error', 'rad', 'rotation angle from the exact attitude at the end', &
               'oracle', at_orientation_error, by_default + compares, needs=2**of_oracle, missing=note_no_exact_motion), &
        column('inherent_error', 'rad', 'error of that attitude due to rounding of the data', &
               'inherent', at_inherent_error, 0, needs=2**of_inherent, missing=note_no_exact_motion), &
        column('evaluations', '', 'RHS evaluations', 'cost', at_evaluations, by_default, needs=2**of_cost), &
        column('motion_class', '', 'loop, cusp, wave, steady, ... (categorical)', &
               'details', at_motion_class, categorical, needs=details + whole + 2**of_class), &
        column('spin_per_nutation', 'rad', 'change of psi in a nutation, without the half turns at exact passages of a pole', &
               'details', at_spin_per_nutation, 0, needs=details + whole), &
        column('theta_rate_max', 'rad/s', 'largest magnitude of the nutation rate', &
               'details', at_theta_rate_max, 0, needs=details + 2**of_nutation_rate), &
        column('force_max', 'N', 'maximum support force', 'details', at_force_max, 0, needs=details + 2**of_force), &
        column('force_z_min', 'N', 'minimum vertical support force', &
               'details', at_force_z_min, 0, needs=details + 2**of_vertical_force), &
        column('force_z_max', 'N', 'maximum vertical support force', &
               'details', at_force_z_max, 0, needs=details + 2**of_vertical_force), &
        column('t_end', 's', 'end of the span, or time of the event that ended the motion', &
               'end', at_t_end, by_default + is_end + always, needs=the_end), &
        column('t_stuck', 's', 'time at which dry friction stopped the body, to the end of the span', &
               'end', at_t_stuck, 0, needs=the_end, missing=note_not_stuck), &
        column('critical_omega3', 'rad/s', 'omega3 from which the sleeping top is stable, 2 sqrt(m g l I1)/I3, for its inertia and &
               &weight', 'sleeping', at_critical_omega3, 0, needs=threshold, missing=note_no_threshold), &
        column('sleeping_ratio', '', 'magnitude of omega3 at the start, with h/I3 of a rotor, over critical_omega3', &
               'sleeping', at_sleeping_ratio, 0, needs=threshold, missing=note_no_threshold), &
        column('growth_rate', '1/s', 'growth rate of perturbations of a steady motion', &
               'growth', at_growth_rate, 0, needs=2**of_growth), &
        column('lyapunov_exponent', '1/s', 'mean growth rate of a perturbation, with equal components except along Gamma', &
               'lyapunov', at_lyapunov_exponent, 0, needs=2**of_lyapunov), &
        column('largest_singular_value', '', 'largest singular value of the tangent map over the span, in the scales of &
               &the motion', 'singular', at_largest_singular_value, 0, needs=2**of_singular), &
        column('upright_multiplier', '', 'largest Floquet multiplier with the centre of mass above the pivot, vibrated &
               &vertically', 'multiplier', at_upright_multiplier, 0, needs=2**of_multiplier), &
        column('momentum_period', 's', 'period of the angular momentum in a free body', &
               'free', at_momentum_period, 0, needs=constants), &
        column('momentum_turn', 'rad', 'turn about the momentum in that period', 'free', at_momentum_turn, 0, needs=constants), &
        column('momentum_turn_geometric', 'rad', 'geometric phase, momentum_turn less 2 E momentum_period/L', &
               'free', at_momentum_turn_geometric, 0, needs=constants + 2**of_geometric), &
        column('momentum_axis', '', 'body axis about which the angular momentum circulates (1, 2, 3)', &
               'free', at_momentum_axis, 0, needs=constants), &
        column('omega_max', 'rad/s', 'maximum angular velocity of a free body', 'free', at_omega_max, 0, needs=constants), &
        column('theta_end_bound', 'rad', 'upper bound of the error of theta_end, proved', &
               proof_group, at_theta_end_bound, 0, needs=end_and_bounds, missing=note_nothing_to_bound), &
        column('phi_end_bound', 'rad', 'upper bound of the error of phi_end, proved', &
               proof_group, at_phi_end_bound, 0, needs=end_and_bounds, missing=note_nothing_to_bound), &
        column('psi_end_bound', 'rad', 'upper bound of the error of psi_end, proved', &
               proof_group, at_psi_end_bound, 0, needs=end_and_bounds, missing=note_nothing_to_bound), &
        column('proof', '', 'proved, or unproved if a bound is infinite (categorical)', &
               proof_group, at_proof, categorical, needs=2**of_proof)]

    !> All columns. A variable, since flang 19 fails at components of constants.
    type(column), protected :: sweep_columns(size(registry)) = registry

contains

    !> What columns need, as flags.
    pure function work_for(columns) result(wanted)
        type(column), intent(in) :: columns(:) !! the columns
        logical :: wanted(kinds_of_work)
        integer :: i
        wanted = [(any(btest(columns%needs, i)), i=1, kinds_of_work)]
    end function work_for

    !> Whether anything depends on the span of a motion whose nutation has a closed form.
    pure logical function asks_for_span(wanted)
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        asks_for_span = any(wanted([of_period, of_end, of_energy, of_oracle, of_cost, of_inherent])) .or. &
            any(wanted(of_growth:of_multiplier))
    end function asks_for_span

    !> Removes all notes.
    subroutine clear(self)
        class(note_t), intent(inout) :: self
        self%flags = 0
        if (allocated(self%text)) deallocate (self%text)
    end subroutine clear

    !> Adds a note of the list, with its reason in this case.
    subroutine add(self, note, reason)
        class(note_t), intent(inout) :: self
        integer, intent(in) :: note !! index of the note
        character(*), intent(in), optional :: reason !! reason in this case
        self%flags = ibset(self%flags, note - 1)
        if (present(reason)) then
            call self%explain(trim(note_names(note)) // ': ' // reason)
        else
            call self%explain(trim(note_names(note)))
        end if
    end subroutine add

    !> Whether a note of the list is present.
    pure logical function has(self, note)
        class(note_t), intent(in) :: self
        integer, intent(in) :: note !! index of the note
        has = btest(self%flags, note - 1)
    end function has

    !> Adds a sentence that is not in the list.
    subroutine explain(self, sentence)
        class(note_t), intent(inout) :: self
        character(*), intent(in) :: sentence !! a sentence
        if (allocated(self%text)) then
            self%text = self%text // '; ' // sentence
        else
            self%text = sentence
        end if
    end subroutine explain

end module spintop_sweep_result
