!> Variational equations of a body whose pivot vibrates along the vertical: the state (Gamma, P) and tangent vectors
!> under a weight that varies with time.
!>
!>     Gamma' = Gamma x w,   P' = P x w + m (g + a(t)) Gamma x r - d w,   w = (P - h)/I,   a = -W^2 A cos(W t + f)
!>
!> P contains the constant momentum h of a rotor. The method is that of `spintop_tangent_flow`.
module spintop_driven_flow
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_effects, only: effect_lift, effect_rotor, effects_t
    use spintop_euler_poisson, only: state_units
    use spintop_kinds, only: dp, pi
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_step_limit, status_step_too_small
    use spintop_tangent_flow, only: order, product_of, smallest_spacings, step_limit, step_size
    use spintop_vectors, only: cross
    implicit none
    private
    public :: propagate_driven_tangents, is_driven, drive_period

contains

    !> Whether the effects on a body are a vertical vibration of its pivot and, perhaps, a rotor with constant momentum.
    pure logical function is_driven(body)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        is_driven = .false.
        if (allocated(body%effects)) is_driven = body%effects%only(effect_lift + effect_rotor) &
            .and. .not. body%effects%only(effect_rotor) .and. body%effects%vibration_rate > 0
    end function is_driven

    !> The period of such a vibration, s; 0 for other bodies.
    pure real(dp) function drive_period(body) result(period)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        period = 0
        if (is_driven(body)) period = 2 * pi / body%effects%vibration_rate
    end function drive_period

    !> Integrates the state `columns(:, 1)` and the tangent vectors in the other columns from the time 0 over `duration`
    !> seconds, of a body for which `is_driven`.
    pure subroutine propagate_driven_tangents(body, duration, columns, status, max_steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        real(dp), intent(in) :: duration !! s, positive
        real(dp), intent(inout) :: columns(:, :) !! column 1: state (Gamma, P); other columns: tangent vectors
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        real(dp) :: coefficient(6, size(columns, 2), 0:order), t, h
        integer :: step, most_steps, k

        most_steps = step_limit
        if (present(max_steps)) most_steps = max_steps
        status = status_ok
        t = 0
        do step = 1, most_steps
            if (.not. t < duration) return
            call expand(body, weight_series(body%gravity, body%effects, t), columns, coefficient)
            h = step_size(state_units(body, columns(:, 1)), coefficient, duration - t)
            if (.not. h > 0) status = status_non_finite
            if (h < duration - t .and. h < smallest_spacings * spacing(duration)) status = status_step_too_small
            if (.not. is_ok(status)) return
            columns = coefficient(:, :, order)
            do k = order - 1, 0, -1
                columns = columns * h + coefficient(:, :, k)
            end do
            if (.not. all(is_finite(columns))) status = status_non_finite
            if (.not. is_ok(status)) return
            t = merge(duration, t + h, h >= duration - t)
        end do
        if (t < duration) status = status_step_limit
    end subroutine propagate_driven_tangents

    !> Taylor coefficients of g + a at a time, m/s^(2 + k).
    pure function weight_series(gravity, effects, t) result(weight)
        real(dp), intent(in) :: gravity, t
        type(effects_t), intent(in) :: effects
        real(dp) :: weight(0:order), factor, phase
        integer :: k
        phase = effects%vibration_rate * t + effects%vibration_phase(3)
        factor = -effects%vibration_rate**2 * effects%vibration_amplitude(3)
        do k = 0, order
            select case (mod(k, 4))
            case (0)
                weight(k) = factor * cos(phase)
            case (1)
                weight(k) = -factor * sin(phase)
            case (2)
                weight(k) = -factor * cos(phase)
            case default
                weight(k) = factor * sin(phase)
            end select
            factor = factor * effects%vibration_rate / (k + 1)
        end do
        weight(0) = weight(0) + gravity
    end function weight_series

    !> Taylor coefficients of the state (first column) and of the tangent vectors (the others).
    pure subroutine expand(body, weight, columns, coefficient)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: weight(0:order), columns(:, :)
        real(dp), intent(out) :: coefficient(6, size(columns, 2), 0:order)
        real(dp) :: omega(3, size(columns, 2), 0:order), rate(6), pull(3)
        integer :: i, j, k

        coefficient(:, :, 0) = columns
        do k = 0, order - 1
            do i = 1, size(columns, 2)
                omega(:, i, k) = coefficient(4:6, i, k)
                if (i == 1 .and. k == 0) omega(:, i, k) = omega(:, i, k) - body%effects%rotor_momentum
                omega(:, i, k) = omega(:, i, k) / body%inertia
                rate = 0
                pull = 0
                do j = 0, k
                    pull = pull + weight(k - j) * coefficient(1:3, i, j)
                    rate = rate + product_of(coefficient(:, i, j), omega(:, 1, k - j))
                    ! The variation of a product.
                    if (i > 1) rate = rate + product_of(coefficient(:, 1, j), omega(:, i, k - j))
                end do
                rate(4:6) = rate(4:6) + body%mass * cross(pull, body%centre_of_mass) - body%damping * omega(:, i, k)
                coefficient(:, i, k + 1) = rate / (k + 1)
            end do
        end do
    end subroutine expand

end module spintop_driven_flow
