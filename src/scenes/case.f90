!> A case: what a scene means, in numbers ready to compute with: the body, its start (attitude and angular
!> velocity), and the time span. Threads make cases, so texts are made without functions of deferred length: see `status_names`.
module spintop_case
    use spintop_kinds, only: dp, pi, degree, epsilon_dp, is_zero, is_finite
    use spintop_attitude, only: angles_from_quaternion, attitude_circular_t, circular_of_attitude, omega_from_circular, &
        quaternion_from_angles, rates_from_omega
    use spintop_body, only: body_t
    use spintop_body_turn, only: body_turn_t, find_body_turn
    use spintop_body_of_scene, only: make_body
    use spintop_effects_of_scene, only: make_effects
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, find_nutation
    use spintop_parameters, only: given, is_set
    use spintop_problems, only: problems_t
    use spintop_quantities, only: kinetic_energy
    use spintop_scene_keys, only: scene_t
    use spintop_effects_keys, only: effects_scene_t
    use spintop_status, only: is_ok
    use spintop_steady_motion, only: steady_rates, steady_rates_at_spin
    use spintop_text, only: fixed_text
    use spintop_validity, only: underflows
    implicit none
    private
    public :: case_t, kept_parts_t, make_case, attitude_parameters

    !> The parameters on which the attitude depends.
    character(*), parameter :: attitude_parameters(7) = [character(18) :: 'initial.phi', 'initial.theta', &
        'initial.psi', 'initial.phi_deg', 'initial.theta_deg', 'initial.psi_deg', 'initial.quaternion']

    character(*), parameter :: angle_names(3) = [character(13) :: &
        'initial.phi', 'initial.theta', 'initial.psi']
    !> Largest deviation of the norm of a quaternion from 1 that counts as rounding of its digits.
    real(dp), parameter :: unit_slack = 1.0e-6_dp
    !> The same for a unit quaternion whose elements are rounded doubles: it is used as given.
    real(dp), parameter :: rounding_of_length = 4 * epsilon_dp

    !> A body, its start, and the time span.
    type :: case_t
        !> Body and start in the axes of the computation.
        type(body_t) :: body
        type(motion_t) :: start
        !> Body and start in the axes in which they were given, and the rotation from these.
        type(body_t) :: given_body
        type(motion_t) :: given_start
        type(body_turn_t) :: turn
        !> Sines and cosines of the given attitude.
        type(attitude_circular_t) :: circular
        !> Time span, s.
        real(dp) :: t_end = 0
    end type case_t

    !> Parts of a case that are those of the scene already: the body, the attitude of the start; and one that nobody asks
    !> for, the length of a span of nutations where these have a closed form.
    type :: kept_parts_t
        logical :: body = .false., attitude = .false., nutations = .false.
    end type kept_parts_t

contains

    !> Makes the case of a scene. It is complete if there are no errors in `problems`, which is empty at
    !> first. Parts of the case may be kept. If the body is not known, only what does not depend on it is checked.
    subroutine make_case(scene, case, problems, kept)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(case_t), intent(inout) :: case !! the case; complete without errors in `problems`
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(kept_parts_t), intent(in), optional :: kept !! the parts; none if it is absent
        type(kept_parts_t) :: keep
        logical :: body_is_known

        if (present(kept)) keep = kept
        if (.not. keep%body) then
            call make_body(scene, case%given_body, problems)
            if (.not. problems%any()) call make_effects(scene%effects, case%given_body, problems)
            if (.not. problems%any()) then
                case%turn = find_body_turn(case%given_body)
                case%body = case%turn%turned_body(case%given_body)
            end if
        end if
        body_is_known = .not. problems%any()
        if (.not. keep%attitude) then
            case%given_start = motion_t()
            call read_attitude(scene, case%given_start, problems)
            case%given_start%is_given = .true.
            case%circular = circular_of_attitude(case%given_start%angle)
        end if
        if (all(is_set(scene%omega))) then
            if (any(is_set(scene%rate)) .or. is_set(scene%omega3) .or. is_set(scene%spin_ratio) &
                .or. scene%steady_precession /= 'none') then
                call problems%add('initial.omega', 'the angular velocity is given twice', &
                                  'give either omega(3), or the rates with omega3 or spin_ratio')
            end if
            case%given_start%omega = scene%omega
            case%given_start%gives_omega = .true.
            case%given_start%rate = rates_from_omega(case%given_start%angle, scene%omega)
        else
            call read_rates(scene, case, body_is_known, problems)
        end if
        if (.not. problems%any()) call check_magnitudes(case, keep%body, problems)
        if (.not. problems%any()) then
            if (case%turn%is_turned()) then
                case%start = case%turn%turned_motion(case%given_start)
            else
                case%start = case%given_start
            end if
        end if
        call make_span(scene, case, keep%nutations, problems)
        if (.not. allocated(case%given_body%effects) .or. problems%any()) return
        call check_table_ends(scene%effects, case, problems)
    end subroutine make_case

    !> Reports a table of torques that ends before the motion, and one of friction that ends below the angular velocity of the
    !> start.
    subroutine check_table_ends(effects, case, problems)
        type(effects_scene_t), intent(in) :: effects
        type(case_t), intent(in) :: case
        type(problems_t), intent(inout) :: problems
        real(dp) :: last, spin
        if (allocated(case%given_body%effects%table)) then
            last = maxval(case%given_body%effects%table%knots)
            if (last < case%t_end) call problems%add('effects.torque_table', 'the table ends at t = ' // &
                trim(fixed_text(last)) // ', before the end of the span, ' // trim(fixed_text(case%t_end)), &
                'add rows, or shorten the span')
        end if
        if (.not. allocated(effects%friction_rates)) return
        last = maxval(effects%friction_rates)
        spin = abs(case%given_start%omega(3))
        if (spin > last) call problems%add('effects.friction_table', 'the table ends at omega3 = ' // &
            trim(fixed_text(last)) // ', below that of the start, ' // trim(fixed_text(spin)), &
            'add rows up to the largest angular velocity')
    end subroutine check_table_ends

    !> Attitude from the angles, in radians or degrees, or from the quaternion.
    subroutine read_attitude(scene, start, problems)
        type(scene_t), intent(in) :: scene
        type(motion_t), intent(inout) :: start
        type(problems_t), intent(inout) :: problems
        integer :: i

        if (all(is_set(scene%quaternion))) then
            if (any(is_set(scene%angle)) .or. any(is_set(scene%angle_deg))) then
                call problems%add('initial.quaternion', 'the attitude is given twice', &
                                  'give either the quaternion or the angles')
            end if
            associate (length => norm2(scene%quaternion))
                if (abs(length - 1) > unit_slack) then
                    call problems%add('initial.quaternion', 'the norm of the quaternion is ' // trim(fixed_text(length)) // &
                                      ', not 1', 'an attitude is a unit quaternion: divide it by its norm')
                    return
                end if
                start%quaternion = scene%quaternion
                if (abs(length - 1) > rounding_of_length) start%quaternion = scene%quaternion / length
                start%gives_quaternion = .true.
            end associate
            start%angle = angles_from_quaternion(start%quaternion, [0.0_dp, 0.0_dp, 0.0_dp])
            return
        end if
        do i = 1, 3
            if (is_set(scene%angle(i)) .and. is_set(scene%angle_deg(i))) then
                call problems%add(trim(angle_names(i)) // '_deg', 'the angle is given twice', &
                                  'give it either in radians or in degrees')
            else if (is_set(scene%angle(i))) then
                start%angle(i) = scene%angle(i)
            else if (is_set(scene%angle_deg(i))) then
                start%angle(i) = scene%angle_deg(i) * degree
            else if (i == 2) then
                call problems%add('initial', 'the attitude is not given', &
                                  'give theta, theta_deg or quaternion(4)')
            end if
        end do
        start%quaternion = quaternion_from_angles(start%angle)
    end subroutine read_attitude

    !> Rates of the angles: the spin in one of three ways, the precession given or steady.
    subroutine read_rates(scene, case, body_is_known, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(inout) :: case
        logical, intent(in) :: body_is_known
        type(problems_t), intent(inout) :: problems
        real(dp) :: omega3
        logical :: by_omega3

        if (count(is_set([scene%rate(3), scene%omega3, scene%spin_ratio])) > 1) then
            call problems%add(merge('initial.spin_ratio', 'initial.omega3    ', is_set(scene%spin_ratio)), &
                              'the spin is given twice', 'give one of psi_rate, omega3 and spin_ratio')
            return
        end if
        if (.not. body_is_known) return
        by_omega3 = is_set(scene%omega3) .or. is_set(scene%spin_ratio)
        if (is_set(scene%omega3)) omega3 = scene%omega3
        if (is_set(scene%spin_ratio)) then
            if (case%given_body%mgl() <= 0) then
                call problems%add('initial.spin_ratio', 'm g l is not positive, so omega3 over &
                    &sqrt(4 m g l/I3) is undefined', 'give omega3 or psi_rate')
                return
            end if
            omega3 = scene%spin_ratio * sqrt(4 * case%given_body%mgl() / case%given_body%inertia(3))
        end if

        associate (start => case%given_start)
            start%rate = given(scene%rate)
            ! Words of four letters are compared in place; the others are `slow` and `fast`.
            if (scene%steady_precession(:4) /= 'none' .and. .not. problems%any()) then
                call find_steady_rate(scene, case%given_body, case%turn, by_omega3, omega3, start, problems)
                if (problems%any()) return
            end if
            if (by_omega3) start%rate(3) = omega3 - start%rate(1) * case%circular%cosine_theta
            start%omega = omega_from_circular(case%circular, start%rate)
            if (by_omega3) start%omega(3) = omega3
            start%gives_omega = .false.
            start%gives_omega3 = by_omega3
        end associate
    end subroutine read_rates

    !> phi' of steady precession (Eq 25); with effects that only add constants to the rates of phi and psi, that of the top
    !> that moves with these rates.
    subroutine find_steady_rate(scene, given_body, turn, by_omega3, omega3, start, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: given_body
        type(body_turn_t), intent(in) :: turn
        logical, intent(in) :: by_omega3
        real(dp), intent(in) :: omega3
        type(motion_t), intent(inout) :: start
        type(problems_t), intent(inout) :: problems
        type(body_t) :: body
        real(dp) :: rates(2)
        integer :: count, wanted

        body = given_body
        if (turn%is_shifted() .and. turn%axis == 0 .and. .not. turn%to_principal_axes) body = turn%turned_body(given_body)
        if (is_set(scene%rate(1))) then
            call problems%add('initial.phi_rate', 'steady_precession computes phi_rate', 'omit one of them')
        end if
        if (.not. is_zero(start%rate(2))) then
            call problems%add('initial.theta_rate', 'the inclination of steady precession is constant', &
                              'omit theta_rate')
        end if
        if (.not. body%is_lagrange()) then
            call problems%add('initial.steady_precession', 'steady precession is computed for an undamped symmetric top &
                &about body z, without effects but a held rotor on its axis and the Earth at a pole', 'give the rates themselves')
        end if
        if (problems%any()) return
        if (by_omega3) then
            call steady_rates(body, start%angle(2), omega3 + turn%phi_shift * cos(start%angle(2)) + turn%psi_shift, rates, count)
        else
            call steady_rates_at_spin(body, start%angle(2), start%rate(3) + turn%psi_shift, rates, count)
        end if
        wanted = merge(1, 2, scene%steady_precession == 'slow')
        ! The cosine of a right angle is not zero but a rounding error.
        if (abs(cos(start%angle(2))) <= epsilon_dp) count = min(count, 1)
        if (count == 0) then
            call problems%add('initial.steady_precession', 'the spin is too slow for steady precession at &
                &this inclination', 'it needs omega3^2 >= 4 I1 m g l cos(theta)/I3^2')
        else if (count < wanted) then
            call problems%add('initial.steady_precession', 'a horizontal axis has no fast precession', "use 'slow'")
        else
            start%rate(1) = rates(wanted) - turn%phi_shift
        end if
    end subroutine find_steady_rate

    !> Reports mass properties, unless these are kept, and an energy outside the range of numbers.
    subroutine check_magnitudes(case, keeps_body, problems)
        type(case_t), intent(in) :: case
        logical, intent(in) :: keeps_body
        type(problems_t), intent(inout) :: problems
        associate (body => case%given_body, start => case%given_start)
            if (.not. keeps_body) then
                if (.not. (all(is_finite(body%weight_moment())) .and. all(is_finite(body%inertia)))) then
                    call problems%add('top', 'the weight times its distance, or the inertia, is outside the range of numbers', &
                                      'use moderate units')
                else if (underflows(body)) then
                    call problems%add('top', 'the weight times its distance (N m), or that times the inertia, is below 1e-290', &
                                      'use moderate units, or gravity = 0')
                end if
                if (problems%any()) return
            end if
            if (underflows(body, start%omega)) then
                call problems%add('initial', 'the kinetic energy (J), or the square of the angular momentum, is below 1e-290', &
                                  'use moderate units')
            else if (.not. is_finite(kinetic_energy(body, start))) then
                call problems%add('initial', 'the kinetic energy is outside the range of numbers', 'use moderate units')
            end if
        end associate
    end subroutine check_magnitudes

    !> The time span, given in seconds, in nutation periods, or in precession periods T_p of the paper.
    subroutine make_span(scene, case, keeps_nutations, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(inout) :: case
        logical, intent(in) :: keeps_nutations
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: ways = 'give exactly one of t_end, nutations and precessions'
        type(nutation_t) :: nutation
        real(dp) :: momentum
        integer :: status

        select case (count([is_set(scene%t_end), is_set(scene%nutations), is_set(scene%precessions)]))
        case (0)
            call problems%add('span', 'the time span is not given', ways)
            return
        case (2:)
            call problems%add(merge('span.precessions', 'span.nutations  ', is_set(scene%precessions)), &
                              'the time span is given more than once', ways)
            return
        end select
        if (is_set(scene%t_end)) case%t_end = scene%t_end
        if (problems%any()) return ! the other kinds of span need a body and a start
        if (is_set(scene%nutations)) then
            if (keeps_nutations .and. case%body%has_closed_nutation()) return
            if (.not. case%body%is_lagrange()) then
                call problems%add('span.nutations', 'the nutation period is known only for an undamped symmetric &
                    &top about body z', 'give t_end')
                return
            end if
            call find_nutation(case%body, case%start, nutation, status)
            case%t_end = scene%nutations * nutation%period
            if (.not. is_ok(status) .or. .not. is_finite(case%t_end)) then
                call problems%add('span.nutations', 'this motion has no finite nutation period', 'give t_end')
            end if
        else if (is_set(scene%precessions)) then
            momentum = case%body%inertia(3) * case%start%omega(3)
            if (allocated(case%body%effects)) then
                call problems%add('span.precessions', 'the period 2 pi I3 omega3/(m g l) is not that of a body with effects', &
                                  'give t_end')
            else if (is_zero(momentum) .or. is_zero(case%body%mgl())) then
                call problems%add('span.precessions', 'the period 2 pi I3 omega3/(m g l) needs a spin and a weight', 'give t_end')
            else
                case%t_end = scene%precessions * abs(2 * pi * momentum / case%body%mgl())
            end if
        end if
    end subroutine make_span

end module spintop_case
