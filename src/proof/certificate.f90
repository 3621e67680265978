!> Proved bounds of printed numbers of a symmetric top without damping. Balls (FLINT) enclose the exact motion of the
!> data, which are doubles; the bound of a number is at least its distance from the true value.
!>
!>     call certificate%open(body, start)
!>     call certificate%bound(t, wanted, printed, bounds, reasons)
!>     call certificate%close()
!>
!> All balls are behind the interface of ball_certificate.c. A build without FLINT has balls_absent.c, which proves
!> nothing.
module spintop_certificate
    use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
    use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_null_ptr, c_ptr
    use spintop_body, only: body_t
    use spintop_compare, only: is_equal, is_finite, is_zero
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: certificate_t, has_balls, balls_missing, balls_hint
    public :: proof_of_q0, proof_of_q1, proof_of_q2, proof_of_q3, proof_of_theta, proof_of_phi, proof_of_psi
    public :: proof_of_period, proof_of_precession, proof_of_orientation, proof_count, proof_names
    public :: proved, proof_reasons, last_reason, most_proof_bits

    !> The quantities that have bounds, in the order of balls.h.
    integer, parameter :: proof_of_q0 = 1, proof_of_q1 = 2, proof_of_q2 = 3, proof_of_q3 = 4, proof_of_theta = 5, &
        proof_of_phi = 6, proof_of_psi = 7, proof_of_period = 8, proof_of_precession = 9, proof_of_orientation = 10, &
        proof_count = 10
    !> Their names in tables.
    character(*), parameter :: proof_names(proof_count) = [character(23) :: 'q0', 'q1', 'q2', 'q3', 'theta', 'phi', &
        'psi', 'nutation_period', 'precession_per_nutation', 'orientation']

    !> Outcomes: proved, or the reason why not; those up to `no_library` are in balls.h.
    integer, parameter :: proved = 0, no_library = 7, no_top = 8, other_axis = 9, given_quaternion = 10, no_memory = 11
    integer, parameter :: last_reason = no_memory
    character(*), parameter :: proof_reasons(0:last_reason) = [character(88) :: &
        'proved', &
        'the ball is still too wide at the highest precision', &
        'phi and psi do not exist, or jump at an exact passage of a pole', &
        'the upright axis does not oscillate, so there is no period', &
        'the balls do not decide a sign', &
        'the balls do not separate the roots of the cubic (the separatrix)', &
        'the balls do not decide a phase', &
        'this build has no FLINT', &
        'the body is not an undamped symmetric top about body z', &
        'the symmetry axis is body x or y', &
        'the start is given by a quaternion or by omega', &
        'not enough memory']

    !> What is said where bounds are asked for in a build without FLINT.
    character(*), parameter :: balls_missing = 'this build has no FLINT, which certifies digits'
    character(*), parameter :: balls_hint = 'SPINTOP_FLINT=1 scripts/run ... makes a build with FLINT'

    !> The largest precision that is tried, bits.
    integer, parameter :: most_proof_bits = 16384
    !> Numbers that describe a motion in balls.h.
    integer, parameter :: data_count = 11

    !> The exact motion of a top in balls.
    type :: certificate_t
        private
        type(c_ptr) :: balls = c_null_ptr
        !> Why there are no balls.
        integer :: reason = no_library
        !> Bits of the last answer.
        integer, public :: bits = 0
    contains
        procedure :: open
        procedure :: bound
        procedure :: close
    end type certificate_t

    interface
        function c_open(value, radius, spin_is_omega3) result(balls) bind(C, name='spintop_proof_open')
            import :: c_double, c_int, c_ptr
            real(c_double), intent(in) :: value(*), radius(*)
            integer(c_int), value :: spin_is_omega3
            type(c_ptr) :: balls
        end function c_open

        subroutine c_close(balls) bind(C, name='spintop_proof_close')
            import :: c_ptr
            type(c_ptr), value :: balls
        end subroutine c_close

        function c_bound(balls, t, wanted, certified, most_bits, printed, bounds, reasons) result(bits) &
            bind(C, name='spintop_proof_bounds')
            import :: c_double, c_int, c_ptr
            type(c_ptr), value :: balls
            real(c_double), value :: t
            integer(c_int), intent(in) :: wanted(*)
            integer(c_int), value :: certified, most_bits
            real(c_double), intent(inout) :: printed(*)
            real(c_double), intent(out) :: bounds(*)
            integer(c_int), intent(out) :: reasons(*)
            integer(c_int) :: bits
        end function c_bound

        pure function c_library() result(there) bind(C, name='spintop_proof_library')
            import :: c_int
            integer(c_int) :: there
        end function c_library
    end interface

contains

    !> Whether this build has FLINT.
    pure logical function has_balls()
        has_balls = c_library() /= 0
    end function has_balls

    !> Takes a motion: body and start in the axes in which they were given. The numbers of the data are exact, or known
    !> up to the radii, in the order of `numbers_of`.
    subroutine open(self, body, start, radii)
        class(certificate_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties, as given
        type(motion_t), intent(in) :: start !! attitude and rates, as given
        real(dp), intent(in), optional :: radii(data_count) !! radii of the data; default 0
        real(dp) :: radius(data_count)

        call self%close()
        radius = 0
        if (present(radii)) radius = radii
        self%reason = obstacle(body, start)
        if (self%reason /= proved) return
        self%balls = c_open(numbers_of(body, start), radius, merge(1_c_int, 0_c_int, start%gives_omega3))
        if (c_associated(self%balls)) return
        self%reason = merge(no_memory, no_library, has_balls())
    end subroutine open

    !> The data of a motion: I1, I3, m, g, l, phi, theta, psi and their rates, or omega3 in place of psi'.
    pure function numbers_of(body, start) result(numbers)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp) :: numbers(data_count)
        numbers = [body%inertia(1), body%inertia(3), body%mass, body%gravity, body%centre_of_mass(3), &
                   start%angle, start%rate(1:2), merge(start%omega(3), start%rate(3), start%gives_omega3)]
    end function numbers_of

    !> Why the motion cannot be enclosed; `proved` if it can.
    pure integer function obstacle(body, start) result(reason)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp) :: axis(3)
        reason = proved
        if (start%gives_quaternion .or. start%gives_omega) reason = given_quaternion
        if (.not. (body%is_symmetric() .and. all(is_zero(body%damping)))) then
            reason = no_top
            axis = body%symmetry_axis()
            if (all(is_zero(body%damping)) .and. (is_equal(abs(axis(1)), 1.0_dp) .or. is_equal(abs(axis(2)), 1.0_dp))) then
                reason = other_axis
            end if
        end if
        if (.not. all(is_finite(numbers_of(body, start)))) reason = no_top
    end function obstacle

    !> Bounds of the wanted ones of the printed numbers at a time. With `certified` these become the middles of their
    !> balls where they are proved. A number that is not proved has an infinite bound and a reason (`proof_reasons`).
    subroutine bound(self, t, wanted, printed, bounds, reasons, certified)
        class(certificate_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        logical, intent(in) :: wanted(proof_count) !! which are wanted
        real(dp), intent(inout) :: printed(proof_count) !! the printed numbers
        real(dp), intent(out) :: bounds(proof_count) !! upper bounds of their errors
        integer, intent(out) :: reasons(proof_count) !! `proved`, or why not
        logical, intent(in), optional :: certified !! whether the printed numbers are to be replaced
        integer(c_int) :: by_middles, found(proof_count)

        bounds = ieee_value(1.0_dp, ieee_positive_inf)
        reasons = merge(self%reason, proved, wanted)
        if (self%reason /= proved) return
        by_middles = 0
        if (present(certified)) by_middles = merge(1_c_int, 0_c_int, certified)
        self%bits = c_bound(self%balls, t, merge(1_c_int, 0_c_int, wanted), by_middles, &
                            int(most_proof_bits, c_int), printed, bounds, found)
        reasons = found
    end subroutine bound

    !> Gives the memory of the balls back.
    subroutine close(self)
        class(certificate_t), intent(inout) :: self
        if (c_associated(self%balls)) call c_close(self%balls)
        self%balls = c_null_ptr
        self%reason = no_library
    end subroutine close

end module spintop_certificate
