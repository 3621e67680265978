!> Stability of periodic motions by Floquet multipliers.
module spintop_floquet
    use spintop_kinds, only: dp, no_number, is_finite, is_zero, cross
    use spintop_body, only: body_t
    use spintop_euler_poisson, only: euler_poisson_state, euler_poisson_rate, invariant_gradients, &
        turning_about, state_units
    use spintop_motion, only: motion_t
    use spintop_spectrum, only: find_spectrum
    use spintop_status, only: is_ok, status_bad_input, status_unsuitable
    use spintop_tangent_flow, only: drive_period, propagate_tangents
    use spintop_validity, only: body_status, motion_status
    implicit none
    private
    public :: find_multipliers, find_monodromy

    !> Largest distance of a motion from its start after a period, relative to its scale.
    real(dp), parameter :: slack = 1.0e-9_dp

contains

    !> Floquet multipliers of the motion that returns to its start after `period` seconds, but for a turn of
    !> the body about its axis of symmetry: each a factor by which a perturbation grows per
    !> period. Those that belong to invariants, symmetries and the time of the start are 1 and come
    !> last. The pivot of the body may vibrate along the vertical (`drive_period`); the period is then a multiple of
    !> that of the vibration. `status_unsuitable`: the motion does not return by then, or the body has other
    !> effects; `status_bad_input`: no positive period; `status_non_finite`, `status_bad_body`,
    !> `status_bad_start`: no body or no motion. A period of more than `max_steps` steps is abandoned.
    subroutine find_multipliers(body, start, period, multipliers, status, max_steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: period !! length of the period, s
        complex(dp), intent(out) :: multipliers(6) !! Floquet multipliers
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        real(dp) :: monodromy(6, 6), turn, x(6), forms(6, 4), directions(6, 2)

        multipliers = 1
        call find_monodromy(body, start, period, monodromy, turn, status, max_steps)
        if (.not. is_ok(status)) return
        x = state_of(body, start)
        forms = invariant_gradients(body, x)
        directions = 0
        if (.not. allocated(body%effects)) directions(:, 1) = euler_poisson_rate(body, x)
        directions(:, 2) = turning_about(axis_of(body), x)
        call find_spectrum(monodromy, state_units(body, x), 1.0_dp, forms, directions, multipliers, status)
    end subroutine find_multipliers

    !> The monodromy matrix, which maps a perturbation (of Gamma and Pi) over a period,
    !> and the turn about the axis of symmetry that closes the motion, rad; it is part of the matrix.
    !> `status` as in `find_multipliers`; both are NaN unless it is `status_ok` or `status_unsuitable`.
    subroutine find_monodromy(body, start, period, monodromy, turn, status, max_steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: period !! length of the period, s
        real(dp), intent(out) :: monodromy(6, 6), turn
            !! monodromy matrix, and rotation angle that closes the motion, rad
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        real(dp) :: columns(6, 7), x(6), unit(6), axis(3)
        integer :: i

        monodromy = no_number
        turn = no_number
        status = body_status(body)
        if (is_ok(status)) status = motion_status(start, body)
        if (is_ok(status) .and. .not. (period > 0 .and. is_finite(period))) status = status_bad_input
        if (is_ok(status) .and. .not. repeats(body, period)) status = status_unsuitable
        if (.not. is_ok(status)) return
        x = state_of(body, start)
        unit = state_units(body, x)
        columns = 0
        columns(:, 1) = x
        do i = 1, 6
            columns(i, i + 1) = 1
        end do
        call propagate_tangents(body, period, columns, status, max_steps)
        if (.not. is_ok(status)) return
        axis = axis_of(body)
        turn = closing_turn(axis, columns(:, 1) / unit, x / unit)
        do i = 1, 7
            columns(:, i) = [turned(axis, turn, columns(1:3, i)), turned(axis, turn, columns(4:6, i))]
        end do
        monodromy = columns(:, 2:)
        if (.not. norm2((columns(:, 1) - x) / unit) <= slack) status = status_unsuitable
    end subroutine find_monodromy

    !> Whether the equations are the same after a period: without effects at any time.
    pure logical function repeats(body, period)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: period
        real(dp) :: turns
        repeats = .not. allocated(body%effects)
        if (.not. drive_period(body) > 0) return
        turns = period / drive_period(body)
        repeats = turns > 0.5_dp .and. abs(turns - anint(turns)) <= slack
    end function repeats

    !> The state (Gamma, P) of a motion; P contains the momentum of a rotor.
    pure function state_of(body, motion) result(x)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        real(dp) :: x(6)
        x = euler_poisson_state(body, motion)
        if (allocated(body%effects)) x(4:6) = x(4:6) + body%effects%rotor_momentum
    end function state_of

    !> The axis of symmetry, which a rotor off it takes away; zero if there is none.
    pure function axis_of(body) result(axis)
        type(body_t), intent(in) :: body
        real(dp) :: axis(3)
        axis = body%symmetry_axis()
        if (.not. allocated(body%effects)) return
        if (.not. all(is_zero(cross(axis, body%effects%rotor_momentum)))) axis = 0
    end function axis_of

    !> The rotation angle about an axis that brings one state nearest to another, rad; 0 without an axis.
    pure real(dp) function closing_turn(axis, from, to) result(turn)
        real(dp), intent(in) :: axis(3), from(6), to(6)
        real(dp) :: rate(6)
        rate = turning_about(axis, from)
        turn = 0
        if (norm2(rate) > 0) turn = atan2(dot_product(to, rate), -dot_product(to, turning_about(axis, rate)))
    end function closing_turn

    !> A vector rotated about an axis (Rodrigues' formula).
    pure function turned(axis, angle, vector) result(image)
        real(dp), intent(in) :: axis(3), angle, vector(3)
        real(dp) :: image(3), sideways(3)
        sideways = cross(axis, vector)
        image = vector + sin(angle) * sideways + 2 * sin(angle / 2)**2 * cross(axis, sideways)
    end function turned

end module spintop_floquet
