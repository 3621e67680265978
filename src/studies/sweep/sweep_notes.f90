!> Notes on a case of a sweep: the quantities that do not exist, and the reasons.
module spintop_sweep_notes
    implicit none
    private
    public :: only_without_effects
    public :: note_t, note_names
    public :: note_no_period, note_no_turns, note_no_nutation, note_no_class, note_no_fast_top, note_no_details, &
        note_no_azimuth, note_no_stop, note_no_growth, note_no_lyapunov, note_no_singular, &
        note_no_exact_motion, note_no_precession_period, note_not_free, &
        note_no_momentum_period, note_no_derivative, note_no_multiplier, note_not_stuck, &
        note_nothing_to_bound, note_no_threshold, note_no_turns_known

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

end module spintop_sweep_notes
