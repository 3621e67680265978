!> Variational equations: the state (Gamma, P) and tangent vectors, integrated by the Euler-Poisson
!> equations and their linearisation, also of a body whose pivot vibrates along the vertical:
!>
!>     Gamma' = Gamma x w,   P' = P x w + m (g + a(t)) Gamma x r - d w,   w = (P - h)/I,   a = -W^2 A cos(W t + f)
!>
!> P contains the constant momentum h of a rotor. The method is that of Taylor series: the terms of the equations are products
!> of two factors, so that coefficients follow by Cauchy products (Jorba and Zou, Experimental Mathematics 14, 2005). The step
!> size follows from the last coefficients of the state and of every tangent vector; no step is rejected, and steps may go
!> either way in time.
module spintop_tangent_flow
    use spintop_kinds, only: dp, pi, is_finite, cross
    use spintop_body, only: body_t
    use spintop_effects, only: effect_lift, effect_rotor
    use spintop_euler_poisson, only: state_units
    use spintop_status, only: is_ok, status_bad_input, status_non_finite, status_step_limit, status_step_too_small, &
        status_unsuitable
    use spintop_validity, only: body_status
    implicit none
    private
    public :: propagate_tangents, drive_period

    !> Default maximum number of steps.
    integer, parameter :: step_limit = 1000000
    !> Degree of the series; and tolerance of its last terms, relative to the state.
    integer, parameter :: order = 24
    real(dp), parameter :: tolerance = 1.0e-17_dp
    !> Smallest step in units of the spacing of the time left.
    real(dp), parameter :: smallest_spacings = 16

contains

    !> The period of a body on which nothing acts but a vertical vibration of its pivot and, perhaps, a rotor with constant
    !> momentum, s; 0 for other bodies.
    pure real(dp) function drive_period(body) result(period)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        period = 0
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            if (.not. effects%only(effect_lift + effect_rotor) .or. effects%only(effect_rotor)) return
            if (effects%vibration_rate > 0) period = 2 * pi / effects%vibration_rate
        end associate
    end function drive_period

    !> Integrates the state `columns(:, 1)` and the tangent vectors in the other columns from time 0 over `duration`
    !> seconds, of either sign, in at most `max_steps` steps. On failure they are those of the last step that
    !> succeeded. `status_bad_input`: the duration is not finite, or a column is not six finite numbers;
    !> `status_non_finite`, `status_bad_body`, `status_unsuitable`: the body is not valid, or has other effects.
    pure subroutine propagate_tangents(body, duration, columns, status, max_steps)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: duration !! s, of either sign
        real(dp), intent(inout) :: columns(:, :) !! column 1: state (Gamma, P); other columns: tangent vectors
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer, intent(in), optional :: max_steps !! maximum number of steps
        real(dp) :: coefficient(6, size(columns, 2), 0:order), total(6, size(columns, 2)), left, h
        integer :: step, most_steps, k

        most_steps = step_limit
        if (present(max_steps)) most_steps = max_steps
        status = status_bad_input
        if (.not. is_finite(duration) .or. size(columns, 1) /= 6 .or. size(columns, 2) < 1) return
        if (.not. all(is_finite(columns))) return
        status = body_status(body)
        if (is_ok(status) .and. allocated(body%effects) .and. .not. drive_period(body) > 0) status = status_unsuitable
        if (.not. is_ok(status)) return
        left = duration
        do step = 1, most_steps
            if (.not. abs(left) > 0) return
            if (allocated(body%effects)) then
                call expand(body, driven_weight(body, duration - left), body%effects%rotor_momentum, columns, coefficient)
            else
                call expand(body, [body%gravity], [0.0_dp, 0.0_dp, 0.0_dp], columns, coefficient)
            end if
            h = step_size(state_units(body, columns(:, 1)), coefficient, abs(left))
            if (.not. h > 0) status = status_non_finite
            if (h < abs(left) .and. h < smallest_spacings * spacing(left)) status = status_step_too_small
            ! The exact change of the time left, including its rounding.
            h = left - (left - sign(h, left))
            total = coefficient(:, :, order)
            do k = order - 1, 0, -1
                total = total * h + coefficient(:, :, k)
            end do
            if (.not. all(is_finite(total))) status = status_non_finite
            if (.not. is_ok(status)) return
            columns = total
            left = left - h
        end do
        if (abs(left) > 0) status = status_step_limit
    end subroutine propagate_tangents

    !> Taylor coefficients of g + a at a time, m/s^(2 + k).
    pure function driven_weight(body, t) result(weight)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: t
        real(dp) :: weight(order), factor
        integer :: k
        associate (effects => body%effects)
            factor = -effects%vibration_rate**2 * effects%vibration_amplitude(3)
            do k = 1, order
                weight(k) = factor * cos(effects%vibration_rate * t + effects%vibration_phase(3) + modulo(k - 1, 4) * (pi / 2))
                factor = factor * effects%vibration_rate / k
            end do
        end associate
        weight(1) = weight(1) + body%gravity
    end function driven_weight

    !> Taylor coefficients of the state (first column) and of the tangent vectors (the others).
    pure subroutine expand(body, weight, rotor, columns, coefficient)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: weight(0:), rotor(3), columns(:, :) !! the weight has one term where the pivot is at rest
        real(dp), intent(out) :: coefficient(6, size(columns, 2), 0:order)
        real(dp) :: omega(3, size(columns, 2), 0:order), rate(6), pull(3)
        integer :: i, j, k

        coefficient(:, :, 0) = columns
        do k = 0, order - 1
            do i = 1, size(columns, 2)
                omega(:, i, k) = coefficient(4:6, i, k)
                if (i == 1 .and. k == 0) omega(:, i, k) = omega(:, i, k) - rotor
                omega(:, i, k) = omega(:, i, k) / body%inertia
                pull = 0
                do j = 0, min(k, ubound(weight, 1))
                    pull = pull + weight(j) * coefficient(1:3, i, k - j)
                end do
                rate(1:3) = 0
                rate(4:6) = body%mass * cross(pull, body%centre_of_mass) - body%damping * omega(:, i, k)
                do j = 0, k
                    rate = rate + product_of(coefficient(:, i, j), omega(:, 1, k - j))
                    ! The variation of a product.
                    if (i > 1) rate = rate + product_of(coefficient(:, 1, j), omega(:, i, k - j))
                end do
                coefficient(:, i, k + 1) = rate / (k + 1)
            end do
        end do
    end subroutine expand

    !> (Gamma x omega, P x omega)
    pure function product_of(x, omega) result(rate)
        real(dp), intent(in) :: x(6), omega(3)
        real(dp) :: rate(6)
        rate(1:3) = cross(x(1:3), omega)
        rate(4:6) = cross(x(4:6), omega)
    end function product_of

    !> The step size, at most `longest`, at which the last two terms of each column reach the tolerance; NaN
    !> or 0 if there is none.
    pure real(dp) function step_size(unit, coefficient, longest) result(h)
        real(dp), intent(in) :: unit(6) !! scales of the components
        real(dp), intent(in) :: coefficient(:, :, 0:) !! Taylor coefficients of the columns
        real(dp), intent(in) :: longest !! largest size of the step, s
        real(dp) :: whole, term, rate, least
        integer :: i, k
        h = longest
        ! What a term may have lost that underflows, or products in it: they are multiplied by 1/I at most, which
        ! is the rate of the motion over its momentum.
        rate = maxval(abs(coefficient(:, 1, 1)) / unit)
        least = tiny(least) * max(1.0_dp, rate / minval(unit)) / minval(unit)
        do i = 1, size(coefficient, 2)
            whole = length(coefficient(:, i, 0) / unit)
            do k = order - 1, order
                term = max(length(coefficient(:, i, k) / unit), least)
                if (term > 0) h = min(h, (tolerance * whole / term)**(1.0_dp / k))
                if (.not. is_finite(term)) h = 0
            end do
        end do
    end function step_size

    !> Length of a vector, of which squares may underflow.
    pure real(dp) function length(x)
        real(dp), intent(in) :: x(6)
        real(dp) :: largest
        largest = maxval(abs(x))
        length = largest
        if (largest > 0 .and. is_finite(largest)) length = largest * norm2(x / largest)
    end function length

end module spintop_tangent_flow
