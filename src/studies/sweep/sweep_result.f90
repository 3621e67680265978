!> What a sweep has to compute, and what it computes of a case: a number per column of its table, NaN for what
!> does not exist or was not asked for. Notes on a case name the quantities that do not exist, and the reasons.
module spintop_sweep_result
    use spintop_certificate, only: proof_words
    use spintop_kinds, only: dp, nan => no_number
    implicit none
    private
    public :: at_theta_min, at_theta_max, at_delta_u, at_delta_u_fast_top, at_nutation_period, at_nutation_rate
    public :: at_nutation_rate_fast_top, at_precession_per_nutation, at_precession_rate, at_precession_rate_fast_top
    public :: at_nutations_per_turn, at_nutations_per_turn_fast_top, at_precession_period, at_azimuth_after_period
    public :: at_nutations_in_period, at_phi_rate_max, at_fast_top_ratio, at_com_z_min, at_theta_end, at_phi_end
    public :: at_psi_end, at_theta_rate_end, at_energy_error_max, at_orientation_error, at_inherent_error
    public :: at_evaluations, at_motion_class, at_spin_per_nutation, at_theta_rate_max, at_force_max, at_force_z_min
    public :: at_force_z_max, at_t_end, at_t_stuck, at_critical_omega3, at_sleeping_ratio, at_growth_rate
    public :: at_lyapunov_exponent, at_largest_singular_value, at_upright_multiplier, at_momentum_period
    public :: at_momentum_turn, at_momentum_turn_geometric, at_momentum_axis, at_omega_max, at_theta_end_bound
    public :: at_phi_end_bound, at_psi_end_bound, at_proof
    public :: sweep_result_t, value_count, proof_cells, kinds_of_work, set_of, asks_for_span, of_nutation, of_range
    public :: of_whole, of_measured, of_fastest, of_lowest, of_details, of_class, of_nutation_rate, of_force
    public :: of_vertical_force, of_fast_top, of_period, of_end, of_turns, of_energy, of_oracle, of_inherent
    public :: of_cost, of_growth, of_lyapunov, of_singular, of_multiplier, of_free, of_proof, of_threshold
    public :: of_geometric, only_without_effects, note_t, note_names, note_no_period, note_no_turns
    public :: note_no_nutation, note_no_class, note_no_fast_top, note_no_details, note_no_azimuth, note_no_stop
    public :: note_no_growth, note_no_lyapunov, note_no_singular, note_no_exact_motion, note_no_precession_period
    public :: note_not_free, note_no_momentum_period, note_no_derivative, note_no_multiplier, note_not_stuck
    public :: note_nothing_to_bound, note_no_threshold, note_no_turns_known

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

    !> The quantities of a case: their places among its values, in the order of the columns (spintop_sweep_columns).
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
    !> Number of values of a case, as many as there are columns.
    integer, parameter :: value_count = at_proof

    integer, private :: k
    !> What a case has as long as nothing is computed: no class, and no proof.
    real(dp), parameter :: nothing(value_count) = [(merge(0.0_dp, nan, k == at_motion_class .or. k == at_proof), k=1, value_count)]

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
