!> The start that a scene describes: attitude and angular velocity.
module spintop_start_of_scene
    use spintop_kinds, only: dp, degree, epsilon_dp
    use spintop_compare, only: is_zero
    use spintop_attitude, only: rates_from_omega, omega_from_rates, quaternion_from_angles, &
        angles_from_quaternion
    use spintop_body, only: body_t
    use spintop_body_of_scene, only: is_set
    use spintop_motion, only: motion_t
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_steady_motion, only: steady_rates, steady_rates_at_spin
    use spintop_text, only: to_text
    implicit none
    private
    public :: make_start, attitude_parameters

    !> The parameters that the attitude depends on.
    character(*), parameter :: attitude_parameters(7) = [character(18) :: 'initial.phi', 'initial.theta', &
        'initial.psi', 'initial.phi_deg', 'initial.theta_deg', 'initial.psi_deg', 'initial.quaternion']

    character(*), parameter :: angle_names(3) = [character(13) :: &
        'initial.phi', 'initial.theta', 'initial.psi']
    !> Distance from 1 of the length of a quaternion that is read as rounding.
    real(dp), parameter :: unit_slack = 1.0e-6_dp
    !> That of a unit quaternion whose elements are rounded: it is taken as given.
    real(dp), parameter :: rounding_of_length = 4 * epsilon_dp

contains

    !> The start of a scene, with what is wrong about it. Where the body is not known,
    !> only what does not depend on it is checked. With `same_attitude` that of `start` is kept.
    subroutine make_start(scene, body, body_is_known, start, problems, same_attitude)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        logical, intent(in) :: body_is_known
        type(motion_t), intent(inout) :: start
        type(problems_t), intent(inout) :: problems
        logical, intent(in), optional :: same_attitude
        logical :: keep

        keep = .false.
        if (present(same_attitude)) keep = same_attitude
        if (.not. keep) then
            start = motion_t()
            call take_attitude(scene, start, problems)
        end if
        if (all(is_set(scene%omega))) then
            call take_omega(scene, start, problems)
        else
            call take_rates(scene, body, body_is_known, start, problems)
        end if
    end subroutine make_start

    !> Attitude from the angles, in radians or degrees, or from the quaternion.
    subroutine take_attitude(scene, start, problems)
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
                    ! Threads make cases: see `status_names`.
                    !$omp critical (texts)
                    call problems%add('initial.quaternion', 'the quaternion has the length ' // to_text(length) // ', not 1', &
                                      'an attitude is a unit quaternion: divide it by its length')
                    !$omp end critical (texts)
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
    end subroutine take_attitude

    !> Angular velocity in body axes.
    subroutine take_omega(scene, start, problems)
        type(scene_t), intent(in) :: scene
        type(motion_t), intent(inout) :: start
        type(problems_t), intent(inout) :: problems
        if (any(is_set(scene%rate)) .or. is_set(scene%omega3) .or. is_set(scene%spin_ratio) &
            .or. scene%steady_precession /= 'none') then
            call problems%add('initial.omega', 'the angular velocity is given twice', &
                              'give either omega(3), or the rates with omega3 or spin_ratio')
        end if
        start%omega = scene%omega
        start%gives_omega = .true.
        start%rate = rates_from_omega(start%angle, start%omega)
    end subroutine take_omega

    !> Rates of the angles, the spin in one of three ways, precession by hand or steady.
    subroutine take_rates(scene, body, body_is_known, start, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        logical, intent(in) :: body_is_known
        type(motion_t), intent(inout) :: start
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
            if (body%mgl() <= 0) then
                call problems%add('initial.spin_ratio', 'm g l is not positive, so omega3 over &
                    &sqrt(4 m g l/I3) means nothing', 'give omega3 or psi_rate')
                return
            end if
            omega3 = scene%spin_ratio * sqrt(4 * body%mgl() / body%inertia(3))
        end if

        start%rate = merge(scene%rate, 0.0_dp, is_set(scene%rate))
        if (scene%steady_precession /= 'none' .and. .not. problems%any()) then
            call take_steady_rate(scene, body, by_omega3, omega3, start, problems)
            if (problems%any()) return
        end if
        if (by_omega3) start%rate(3) = omega3 - start%rate(1) * cos(start%angle(2))
        start%omega = omega_from_rates(start%angle, start%rate)
        if (by_omega3) start%omega(3) = omega3
        start%gives_omega = .false.
        start%gives_omega3 = by_omega3
    end subroutine take_rates

    !> phi' of steady precession (Eq 25).
    subroutine take_steady_rate(scene, body, by_omega3, omega3, start, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        logical, intent(in) :: by_omega3
        real(dp), intent(in) :: omega3
        type(motion_t), intent(inout) :: start
        type(problems_t), intent(inout) :: problems
        real(dp) :: rates(2)
        integer :: count, wanted

        if (is_set(scene%rate(1))) then
            call problems%add('initial.phi_rate', 'steady_precession computes phi_rate', 'leave one out')
        end if
        if (.not. is_zero(start%rate(2))) then
            call problems%add('initial.theta_rate', 'the inclination of steady precession is constant', &
                              'leave theta_rate out')
        end if
        if (.not. body%is_lagrange()) then
            call problems%add('initial.steady_precession', 'steady precession is computed for an undamped &
                &symmetric top about body z', 'give the rates themselves')
        end if
        if (problems%any()) return
        if (by_omega3) then
            call steady_rates(body, start%angle(2), omega3, rates, count)
        else
            call steady_rates_at_spin(body, start%angle(2), start%rate(3), rates, count)
        end if
        wanted = merge(1, 2, scene%steady_precession == 'slow')
        ! The cosine of a right angle is not zero but the rounding of the angle.
        if (abs(cos(start%angle(2))) <= epsilon_dp) count = min(count, 1)
        if (count == 0) then
            call problems%add('initial.steady_precession', 'the spin is too slow for steady precession at &
                &this inclination', 'it needs omega3^2 >= 4 I1 m g l cos(theta)/I3^2')
        else if (count < wanted) then
            call problems%add('initial.steady_precession', 'there is no fast precession of an axis that &
                &is horizontal', "take 'slow'")
        else
            start%rate(1) = rates(wanted)
        end if
    end subroutine take_steady_rate

end module spintop_start_of_scene
