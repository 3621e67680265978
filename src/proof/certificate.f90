!> Proved bounds of printed numbers of a motion. Balls (FLINT) enclose the exact motion of the data, which are doubles, step by
!> step: that of any body whose equations are polynomials. The bound of a number is at least its distance from the true value.
!> Where phi and psi jump on a pole, their bounds leave whole turns out.
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
    use spintop_kinds, only: dp, is_finite
    use spintop_effects, only: effect_drive, effect_frame, effect_harmonic, effect_lift, effect_rotor, &
        effect_shake, effect_torque, effects_t, harmonic_t
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: certificate_t, has_balls, balls_missing, balls_hint
    public :: proof_of_q0, proof_of_q1, proof_of_q2, proof_of_q3, proof_of_theta, proof_of_phi, proof_of_psi
    public :: proof_of_orientation, proof_of_omega1, proof_of_omega3, proof_count, proof_names
    public :: proved, proof_words, proof_reasons, last_reason, radius_count, ball_effects

    !> The quantities that have bounds, in the order of balls.h.
    integer, parameter :: proof_of_q0 = 1, proof_of_q1 = 2, proof_of_q2 = 3, proof_of_q3 = 4, proof_of_theta = 5, &
        proof_of_phi = 6, proof_of_psi = 7, proof_of_orientation = 8, proof_of_omega1 = 9, proof_of_omega3 = 11, proof_count = 11
    !> Their names in tables.
    character(*), parameter :: proof_names(proof_count) = [character(11) :: 'q0', 'q1', 'q2', 'q3', 'theta', 'phi', &
        'psi', 'orientation', 'omega1', 'omega2', 'omega3']

    !> Outcomes: proved, or the reason why not; those up to `no_library` are in balls.h.
    integer, parameter :: proved = 0, no_library = 5, not_polynomial = 6, other_radii = 7, no_numbers = 8, &
        no_memory = 9
    integer, parameter :: last_reason = no_memory
    character(*), parameter :: proof_reasons(0:last_reason) = [character(90) :: &
        'proved', &
        'the ball is still too wide at the highest precision', &
        'phi and psi do not exist on a pole', &
        'a rate on a pole, or a moment of inertia that may be zero', &
        'the motion takes too many steps', &
        'this build has no FLINT', &
        'dry friction, drag of the air and tables of friction or torques are not enclosed', &
        'the radii are not those of the numbers that give the start', &
        'a moment of inertia is zero, or a number is not finite', &
        'not enough memory']

    !> Whether a row is proved, as words of tables.
    character(*), parameter :: proof_words(0:1) = [character(8) :: 'unproved', 'proved']

    !> What is said where bounds are asked for in a build without FLINT.
    character(*), parameter :: balls_missing = 'this build has no FLINT, which certifies digits'
    character(*), parameter :: balls_hint = 'SPINTOP_FLINT=1 scripts/setup installs it, and the next scripts/run builds with it'

    !> Numbers that describe a motion in balls.h; how many of them may have radii: the first.
    integer, parameter :: data_count = 65, radius_count = 27
    !> The effects that the equations in balls have: those whose equations are polynomials.
    integer, parameter :: ball_effects = effect_lift + effect_shake + effect_frame + effect_rotor + effect_drive + effect_torque &
        + effect_harmonic
    !> How the start is given, as sums of these numbers of balls.h.
    integer, parameter :: by_omega3 = 1, by_omega = 2, by_quaternion = 4

    !> The exact motion of a body in balls.
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
        function c_open(value, radius, given) result(balls) bind(C, name='spintop_proof_open')
            import :: c_double, c_int, c_ptr
            real(c_double), intent(in) :: value(*), radius(*)
            integer(c_int), value :: given
            type(c_ptr) :: balls
        end function c_open

        subroutine c_close(balls) bind(C, name='spintop_proof_close')
            import :: c_ptr
            type(c_ptr), value :: balls
        end subroutine c_close

        function c_bound(balls, t, wanted, certified, printed, bounds, reasons) result(bits) &
            bind(C, name='spintop_proof_bounds')
            import :: c_double, c_int, c_ptr
            type(c_ptr), value :: balls
            real(c_double), value :: t
            integer(c_int), intent(in) :: wanted(*)
            integer(c_int), value :: certified
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

    !> Prepares a motion: body and start in the axes in which they were given. The numbers of the data are exact, or known up to
    !> the radii, in the order of `numbers_of`.
    subroutine open(self, body, start, radii)
        class(certificate_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties, as given
        type(motion_t), intent(in) :: start !! attitude and rates, as given
        real(dp), intent(in), optional :: radii(:) !! radii of the first data, at most radius_count; others are exact
        real(dp) :: radius(data_count)
        integer :: way

        call self%close()
        radius = 0
        if (present(radii)) radius(:size(radii)) = radii
        self%reason = obstacle(body, start, radius)
        if (self%reason /= proved) return
        way = merge(by_omega3, 0, start%gives_omega3) + merge(by_omega, 0, start%gives_omega) &
              + merge(by_quaternion, 0, start%gives_quaternion)
        self%balls = c_open(numbers_of(body, start), radius, int(way, c_int))
        if (c_associated(self%balls)) return
        self%reason = merge(no_memory, no_library, has_balls())
    end subroutine open

    !> The data of a motion: inertia, m, g, phi, theta, psi and their rates, or omega3 in place of psi', omega, quaternion,
    !> centre of mass, damping, products of inertia, effects.
    pure function numbers_of(body, start) result(numbers)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp) :: numbers(data_count), rate(3), frame(3)
        type(effects_t) :: effects
        type(harmonic_t) :: in_body, in_space
        rate = start%rate
        if (start%gives_omega3) rate(3) = start%omega(3)
        if (start%gives_omega) rate = 0 ! they do not exist on a pole
        if (allocated(body%effects)) effects = body%effects
        if (allocated(effects%harmonic_body)) in_body = effects%harmonic_body
        if (allocated(effects%harmonic_space)) in_space = effects%harmonic_space
        frame = merge(0.0_dp, effects%frame_rate, abs(effects%earth_rate) > 0) ! which latitude and rate give
        numbers = [body%inertia, body%mass, body%gravity, start%angle, rate, start%omega, start%quaternion, &
                   body%centre_of_mass, body%damping, body%products, frame, effects%earth_rate, effects%latitude, &
                   effects%rotor_momentum, effects%rotor_torque, effects%torque_body, effects%torque_space, &
                   effects%vibration_amplitude, effects%vibration_phase, effects%vibration_rate, &
                   in_body%amplitude, in_body%phase, in_body%rate, in_space%amplitude, in_space%phase, in_space%rate]
    end function numbers_of

    !> Why the motion cannot be enclosed; `proved` if it can.
    pure integer function obstacle(body, start, radius) result(reason)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: radius(data_count)
        reason = proved
        if ((start%gives_quaternion .and. any(radius(6:8) > 0)) .or. (start%gives_omega .and. any(radius(9:11) > 0)) &
            .or. (.not. start%gives_omega .and. any(radius(12:14) > 0))) reason = other_radii
        if (allocated(body%effects)) then
            if (.not. body%effects%only(ball_effects)) reason = not_polynomial
        end if
        ! A thin rod has no moment about itself, where nothing turns it.
        if (.not. (all(is_finite(numbers_of(body, start))) .and. all(body%inertia(:2) > 0) &
                   .and. (body%inertia(3) > 0 .or. body%is_symmetric()))) reason = no_numbers
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
        self%bits = c_bound(self%balls, t, merge(1_c_int, 0_c_int, wanted), by_middles, printed, bounds, found)
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
