!> Balls of numbers of a motion, and which numbers are wanted.
module proofs
    use spintop_body, only: body_t
    use spintop_certificate
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    implicit none
    public
    private :: holds, reason

    integer, private :: number
    !> The quaternion; that and the angles; that, the angles and the angular velocity.
    logical, parameter :: of_quaternion(proof_count) = [(number <= proof_of_q3, number=1, proof_count)]
    logical, parameter :: of_attitude(proof_count) = [(number <= proof_of_psi, number=1, proof_count)]
    logical, parameter :: of_motion(proof_count) = [(number <= proof_of_psi .or. number >= proof_of_omega1, number=1, proof_count)]
    !> Places of phi, theta, psi.
    integer, parameter :: angles(3) = [proof_of_phi, proof_of_theta, proof_of_psi]

    !> Numbers of a motion at a time with their bounds.
    type :: proof_t
        real(dp) :: numbers(proof_count) = 0, bounds(proof_count) = 0
        integer :: reasons(proof_count) = proved, bits = 0
    contains
        procedure :: holds
        procedure :: reason
    end type proof_t

contains

    !> Bounds of the numbers of a body at a time; of certified ones, which take their places; for radii of the data.
    type(proof_t) function prove(body, start, t, wanted, numbers, certified, radii) result(proof)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t
        logical, intent(in) :: wanted(proof_count)
        real(dp), intent(in), optional :: numbers(:), radii(:) !! the first numbers; others are zero
        logical, intent(in), optional :: certified
        type(certificate_t) :: certificate
        if (present(numbers)) proof%numbers(:size(numbers)) = numbers
        call certificate%open(body, start, radii)
        call certificate%bound(t, wanted, proof%numbers, proof%bounds, proof%reasons, certified)
        proof%bits = certificate%bits
        call certificate%close()
    end function prove

    !> The numbers of a motion.
    pure function numbers_of(motion) result(numbers)
        type(motion_t), intent(in) :: motion
        real(dp) :: numbers(proof_count)
        numbers = 0
        numbers(proof_of_q0:proof_of_q3) = motion%quaternion
        numbers(angles) = motion%angle
        numbers(proof_of_omega1:proof_of_omega3) = motion%omega
    end function numbers_of

    !> Whether all that was wanted is proved.
    pure logical function holds(self)
        class(proof_t), intent(in) :: self
        holds = all(self%reasons == proved)
    end function holds

    !> Why the first number is not proved.
    function reason(self)
        class(proof_t), intent(in) :: self
        character(:), allocatable :: reason
        reason = trim(proof_reasons(self%reasons(1)))
    end function reason

end module proofs
