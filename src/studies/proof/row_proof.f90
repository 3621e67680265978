!> The proof of the numbers of rows: which bounds are wanted, those of the last row, and how many rows are proved.
module spintop_row_proof
    use spintop_body, only: body_t
    use spintop_certificate, only: certificate_t, last_reason, proof_count, proof_names, proof_reasons, proved
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: row_proof_t, wanted_proofs

    !> Bounds of one row after the other of a motion.
    type :: row_proof_t
        !> Which quantities are to be proved, and whether proved numbers replace the computed ones.
        logical :: wanted(proof_count) = .false., certified = .false.
        !> Bounds of the last row, and reasons why they are infinite.
        real(dp) :: bounds(proof_count) = 0
        integer :: reasons(proof_count) = proved
        !> Number of rows by their outcome (`proof_reasons`).
        integer :: rows(0:last_reason) = 0
        !> The time of the first row that is not proved, s.
        real(dp) :: first_unproved = huge(1.0_dp)
        type(certificate_t), private :: certificate = certificate_t()
    contains
        procedure :: open
        procedure :: prove
        procedure :: outcome
        procedure :: is_proved
        procedure :: summary
        procedure :: close
    end type row_proof_t

contains

    !> Which quantities are to be proved for a table with these columns: those with a bound; also those that are printed,
    !> if these are to be certified, or if there is a column `proof` without bounds.
    pure function wanted_proofs(names, certified, suffix) result(wanted)
        character(*), intent(in) :: names(:) !! of the columns
        logical, intent(in) :: certified !! whether proved numbers replace the computed ones
        character(*), intent(in) :: suffix !! what follows the name of a quantity in that of its column
        logical :: wanted(proof_count)
        integer :: i
        wanted = [(any(names == trim(proof_names(i)) // suffix // '_bound'), i=1, proof_count)]
        if (.not. certified .and. (any(wanted) .or. .not. any(names == 'proof'))) return
        wanted = [(wanted(i) .or. any(names == trim(proof_names(i)) // suffix), i=1, proof_count)]
    end function wanted_proofs

    !> Prepares the proof of a motion as it was given. Without wanted quantities nothing is done.
    subroutine open(self, wanted, certified, body, start, radii)
        class(row_proof_t), intent(inout) :: self
        logical, intent(in) :: wanted(proof_count) !! which quantities are to be proved
        logical, intent(in) :: certified !! whether proved numbers replace the computed ones
        type(body_t), intent(in) :: body !! mass properties, as given
        type(motion_t), intent(in) :: start !! attitude and rates, as given
        real(dp), intent(in) :: radii(:) !! of the data (spintop_uncertainties)
        self%wanted = wanted
        self%certified = certified
        if (any(wanted)) call self%certificate%open(body, start, radii)
    end subroutine open

    !> Proves the numbers of a row, and replaces them where they are to be certified.
    subroutine prove(self, t, printed)
        class(row_proof_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(inout) :: printed(proof_count) !! the numbers
        call self%certificate%bound(t, self%wanted, printed, self%bounds, self%reasons, self%certified)
        self%rows(self%outcome()) = self%rows(self%outcome()) + 1
        if (.not. self%is_proved()) self%first_unproved = min(self%first_unproved, t)
    end subroutine prove

    !> `proved`, or the reason of the first wanted quantity that is not.
    pure integer function outcome(self)
        class(row_proof_t), intent(in) :: self
        integer :: i
        outcome = proved
        do i = 1, proof_count
            if (self%wanted(i)) outcome = self%reasons(i)
            if (outcome /= proved) return
        end do
    end function outcome

    !> Whether all wanted numbers of the last row are proved.
    pure logical function is_proved(self)
        class(row_proof_t), intent(in) :: self
        is_proved = self%outcome() == proved
    end function is_proved

    !> How many rows are proved, and why others are not.
    function summary(self) result(text)
        class(row_proof_t), intent(in) :: self
        character(:), allocatable :: text
        integer :: i
        text = to_text(self%rows(proved)) // ' rows proved'
        do i = proved + 1, last_reason
            if (self%rows(i) > 0) text = text // ', ' // to_text(self%rows(i)) // ' unproved (' // trim(proof_reasons(i)) // ')'
        end do
        if (self%first_unproved < huge(1.0_dp)) text = text // ', the first at t = ' // to_text(self%first_unproved)
    end function summary

    !> Gives the memory of the balls back.
    subroutine close(self)
        class(row_proof_t), intent(inout) :: self
        call self%certificate%close()
    end subroutine close

end module spintop_row_proof
