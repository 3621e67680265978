!> Proved bounds of printed numbers of a motion. Balls (FLINT) enclose the exact motion of the data, which are doubles; the
!> bound of a number is at least its distance from the true value. Where phi and psi jump on a pole, their bounds leave
!> whole turns out. Symmetric tops without damping, with or without a rotor, and free bodies have a closed form; the motion of
!> any other body is enclosed step by step, where its equations are polynomials.
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
    use spintop_effects, only: effect_drive, effect_frame, effect_harmonic, effect_lift, effect_rotor, &
        effect_shake, effect_torque, effects_t, harmonic_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: certificate_t, has_balls, balls_missing, balls_hint
    public :: proof_of_q0, proof_of_q1, proof_of_q2, proof_of_q3, proof_of_theta, proof_of_phi, proof_of_psi
    public :: proof_of_period, proof_of_precession, proof_of_orientation, proof_of_momentum_period, proof_of_momentum_turn
    public :: proof_of_omega1, proof_of_omega3, proof_count, proof_names
    public :: proved, proof_words, proof_reasons, last_reason, radius_count, ball_effects

    !> The quantities that have bounds, in the order of balls.h.
    integer, parameter :: proof_of_q0 = 1, proof_of_q1 = 2, proof_of_q2 = 3, proof_of_q3 = 4, proof_of_theta = 5, &
        proof_of_phi = 6, proof_of_psi = 7, proof_of_period = 8, proof_of_precession = 9, proof_of_orientation = 10, &
        proof_of_momentum_period = 11, proof_of_momentum_turn = 12, proof_of_omega1 = 13, proof_of_omega3 = 15, proof_count = 15
    !> Their names in tables.
    character(*), parameter :: proof_names(proof_count) = [character(23) :: 'q0', 'q1', 'q2', 'q3', 'theta', 'phi', &
        'psi', 'nutation_period', 'precession_per_nutation', 'orientation', 'momentum_period', 'momentum_turn', 'omega1', &
        'omega2', 'omega3']

    !> Outcomes: proved, or the reason why not; those up to `no_library` are in balls.h.
    integer, parameter :: proved = 0, no_library = 12, not_polynomial = 13, no_principal_axes = 14, other_radii = 15, &
        no_numbers = 16, no_memory = 17
    integer, parameter :: last_reason = no_memory
    character(*), parameter :: proof_reasons(0:last_reason) = [character(88) :: &
        'proved', &
        'the ball is still too wide at the highest precision', &
        'phi and psi do not exist on a pole', &
        'the upright axis does not oscillate, so there is no period', &
        'body z is not an axis of symmetry, so theta is not periodic', &
        'the balls do not decide a sign', &
        'the balls do not decide on which side of the separatrix the motion is', &
        'the balls do not decide a phase', &
        'phi and psi turn too often for their turns to be counted', &
        'the momentum does not circulate in the body, or the body is not free', &
        'the motion takes too many steps', &
        'periods are proved of symmetric tops without damping and of free bodies only', &
        'this build has no FLINT', &
        'dry friction, drag of the air and tables of friction or torques are not enclosed', &
        'the body axes are not principal axes', &
        'the radii are not those of the numbers that give the start', &
        'a moment of inertia is zero, or a number is not finite', &
        'not enough memory']

    !> Whether a row is proved, as words of tables.
    character(*), parameter :: proof_words(0:1) = [character(8) :: 'unproved', 'proved']

    !> What is said where bounds are asked for in a build without FLINT.
    character(*), parameter :: balls_missing = 'this build has no FLINT, which certifies digits'
    character(*), parameter :: balls_hint = 'SPINTOP_FLINT=1 scripts/run ... makes a build with FLINT'

    !> The largest precision that is tried, bits.
    integer, parameter :: most_proof_bits = 16384
    !> Numbers that describe a motion in balls.h; how many of them may have radii: the first. Those from `first_of_any` on are of
    !> bodies without closed form: the centre of mass and damping.
    integer, parameter :: data_count = 64, radius_count = 26, first_of_any = 21, length_number = 5
    !> The effects that the equations in balls have: those whose equations are polynomials.
    integer, parameter :: ball_effects = effect_lift + effect_shake + effect_frame + effect_rotor + effect_drive + effect_torque &
        + effect_harmonic
    !> How the start and the body are given, as sums of these numbers of balls.h.
    integer, parameter :: by_omega3 = 1, by_omega = 2, by_quaternion = 4, free_body = 8, about_axis(3) = [16, 32, 0], &
        any_body = 64

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

    !> Prepares a motion: body and start in the axes in which they were given. The numbers of the data are exact, or known up to
    !> the radii, in the order of `numbers_of`; both equal moments of inertia of a top have the first radius.
    subroutine open(self, body, start, radii, by_steps)
        class(certificate_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties, as given
        type(motion_t), intent(in) :: start !! attitude and rates, as given
        real(dp), intent(in), optional :: radii(:) !! radii of the first data, at most radius_count; others are exact
        logical, intent(in), optional :: by_steps !! whether to go without the closed form, too; default not
        real(dp) :: radius(data_count)
        integer :: axis
        logical :: has_form

        call self%close()
        radius = 0
        if (present(radii)) radius(:size(radii)) = radii
        has_form = has_closed_form(body) .and. all(is_zero(radius(first_of_any:)))
        if (present(by_steps)) has_form = has_form .and. .not. by_steps
        axis = merge(axis_of(body), 3, has_form)
        if (axis /= 3) radius(1:2) = maxval(radius([1, 2, 12]))
        if (is_equal(body%inertia(1), body%inertia(2)) .and. has_form) radius([1, 12]) = maxval(radius([1, 12]))
        if (.not. has_form) then ! the length is that of the centre of mass
            radius(first_of_any + 2) = max(radius(first_of_any + 2), radius(length_number))
            radius(length_number) = 0
        end if
        self%reason = obstacle(body, start, radius, has_form)
        if (self%reason /= proved) return
        self%balls = c_open(numbers_of(body, start, axis), radius, int(way_of(body, start, axis, has_form), c_int))
        if (c_associated(self%balls)) return
        self%reason = merge(no_memory, no_library, has_balls())
    end subroutine open

    !> The data of a motion: I1, I3, m, g, l, phi, theta, psi and their rates, or omega3 in place of psi'; I2, omega,
    !> quaternion, the rotor's momentum. Of a top about body x or y, I3, l and the rotor are those of its axis. Then what other
    !> bodies have: centre of mass, damping, effects.
    pure function numbers_of(body, start, axis) result(numbers)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        integer, intent(in) :: axis
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
        numbers = [body%inertia(mod(axis, 3) + 1), body%inertia(axis), body%mass, body%gravity, body%centre_of_mass(axis), &
                   start%angle, rate, body%inertia(2), start%omega, start%quaternion, &
                   effects%rotor_momentum(axis), body%centre_of_mass, body%damping, frame, effects%earth_rate, &
                   effects%latitude, effects%rotor_momentum, &
                   effects%rotor_torque, effects%torque_body, effects%torque_space, effects%vibration_amplitude, &
                   effects%vibration_phase, effects%vibration_rate, in_body%amplitude, in_body%phase, in_body%rate, &
                   in_space%amplitude, in_space%phase, in_space%rate]
    end function numbers_of

    !> How the motion is given, for balls.h.
    pure integer function way_of(body, start, axis, has_form) result(way)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        integer, intent(in) :: axis
        logical, intent(in) :: has_form
        way = about_axis(axis)
        if (start%gives_omega3) way = way + by_omega3
        if (start%gives_omega) way = way + by_omega
        if (start%gives_quaternion) way = way + by_quaternion
        if (.not. has_form) way = way + any_body
        ! That of a symmetric body about z from its angles is a top without weight, of which phi and psi are known.
        if (moves_freely(body) .and. (.not. body%is_symmetric() .or. start%gives_omega .or. start%gives_quaternion)) then
            way = way + free_body
        end if
    end function way_of

    !> Whether the motion has a closed form: that of a top or of a free body, without damping.
    pure logical function has_closed_form(body)
        type(body_t), intent(in) :: body
        has_closed_form = all(is_zero(body%damping)) .and. (moves_freely(body) .or. is_top_about(body, axis_of(body)))
    end function has_closed_form

    !> Whether there is no moment of weight; products of small numbers may vanish without that.
    pure logical function is_weightless(body)
        type(body_t), intent(in) :: body
        is_weightless = is_zero(body%mass) .or. is_zero(body%gravity) .or. all(is_zero(body%centre_of_mass))
    end function is_weightless

    !> Whether nothing acts on the body, neither weight nor effects.
    pure logical function moves_freely(body)
        type(body_t), intent(in) :: body
        moves_freely = is_weightless(body) .and. .not. allocated(body%effects)
    end function moves_freely

    !> The body axis of a top, 3 for other bodies.
    pure integer function axis_of(body) result(axis)
        type(body_t), intent(in) :: body
        integer :: i
        axis = 3
        if (moves_freely(body)) return
        do i = 1, 3
            if (is_top_about(body, i)) axis = i
        end do
    end function axis_of

    !> Whether the body is a symmetric top about a body axis, and has no effects but a constant rotor on it.
    pure logical function is_top_about(body, axis)
        type(body_t), intent(in) :: body
        integer, intent(in) :: axis
        integer :: next, last
        next = mod(axis, 3) + 1
        last = mod(next, 3) + 1
        is_top_about = is_equal(body%inertia(next), body%inertia(last)) .and. all(is_zero(body%centre_of_mass([next, last])))
        if (is_top_about .and. allocated(body%effects)) is_top_about = body%effects%only(effect_rotor) &
            .and. all(is_zero(body%effects%rotor_momentum([next, last])))
    end function is_top_about

    !> Why the motion cannot be enclosed; `proved` if it can.
    pure integer function obstacle(body, start, radius, has_form) result(reason)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: radius(data_count)
        logical, intent(in) :: has_form
        reason = proved
        if ((start%gives_quaternion .and. any(radius(6:8) > 0)) .or. (start%gives_omega .and. any(radius(9:11) > 0)) &
            .or. (.not. start%gives_omega .and. any(radius(13:15) > 0))) reason = other_radii
        if (body%has_products()) reason = no_principal_axes
        if (allocated(body%effects)) then
            if (.not. body%effects%only(ball_effects)) reason = not_polynomial
        end if
        if (.not. all(is_finite(numbers_of(body, start, axis_of(body))))) reason = no_numbers
        if (.not. (all(body%inertia > 0) .or. (has_form .and. body%is_symmetric()))) reason = no_numbers
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
