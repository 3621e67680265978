!> Power of effects on a body at several instants at once, those of a quadrature: each number is a vector over the instants,
!> so that all are computed by the same instructions. The equations are those of `spintop_loads`.
module spintop_powers
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, is_zero
    use spintop_effects, only: effects_t, kernel_effects
    use spintop_loads, only: find_loads, loads_t, work_damping, work_drag, work_rotor, work_torque, work_vibration, works
    use spintop_motions, only: instants
    implicit none
    private
    public :: find_powers

contains

    !> Power of each part of the work, W.
    pure subroutine find_powers(body, effects, t, q, momentum, power)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(effects_t), intent(in) :: effects !! effects on the body
        real(dp), intent(in) :: t(instants), q(instants, 4), momentum(instants, 3) !! s; attitudes; P, J s
        real(dp), intent(out) :: power(instants, works) !! of each part at each instant
        real(dp) :: rows(instants, 3, 3), total(instants, 3), omega(instants, 3), given(instants, 3), space(instants, 3)
        type(loads_t) :: loads
        integer :: i, m

        if (.not. effects%only(kernel_effects)) then
            do i = 1, instants
                call find_loads(body, effects, t(i), q(i, :), momentum(i, :), loads)
                power(i, :) = loads%power()
            end do
            return
        end if
        power = 0
        do m = 1, 3
            total(:, m) = (momentum(:, m) - (effects%rotor_momentum(m) + effects%rotor_torque(m) * t)) / body%inertia(m)
        end do
        omega = total
        associate (frame => effects%frame_rate, push => effects%vibration_amplitude, torque => effects%torque_space)
            if (.not. all(is_zero([frame, push, torque]))) call find_rows(q, rows)
            if (any(abs(frame) > 0)) then
                call repeat_vector(-frame, space)
                call add_in_body(rows, space, omega)
            end if
            if (any(abs(push) > 0)) power(:, work_vibration) = power_of_vibration(body, effects, t, rows, omega)
            call repeat_vector(effects%torque_body, given)
            if (any(abs(torque) > 0)) then
                call repeat_vector(torque, space)
                call add_in_body(rows, space, given)
            end if
        end associate
        do m = 1, 3
            power(:, work_damping) = power(:, work_damping) - body%damping(m) * omega(:, m)**2
            power(:, work_torque) = power(:, work_torque) + given(:, m) * omega(:, m)
            power(:, work_rotor) = power(:, work_rotor) - effects%rotor_torque(m) * total(:, m)
        end do
        if (any(effects%drag_moment > 0)) call add_drag_moment(effects, omega, power(:, work_drag))
        if (effects%drag_force > 0) call add_drag_force(body, effects, omega, power(:, work_drag))
    end subroutine find_powers

    !> Space x, y, z in body axes, (instant, component, axis of space).
    pure subroutine find_rows(q, rows)
        real(dp), intent(in) :: q(instants, 4)
        real(dp), intent(out) :: rows(instants, 3, 3)
        real(dp) :: twice
        integer :: i
        !$omp simd private(twice)
        do i = 1, instants
            twice = 2 / ((q(i, 1)**2 + q(i, 4)**2) + (q(i, 2)**2 + q(i, 3)**2))
            rows(i, 1, 1) = twice * (q(i, 1)**2 + q(i, 2)**2) - 1
            rows(i, 2, 1) = twice * (q(i, 2) * q(i, 3) - q(i, 1) * q(i, 4))
            rows(i, 3, 1) = twice * (q(i, 2) * q(i, 4) + q(i, 1) * q(i, 3))
            rows(i, 1, 2) = twice * (q(i, 2) * q(i, 3) + q(i, 1) * q(i, 4))
            rows(i, 2, 2) = twice * (q(i, 1)**2 + q(i, 3)**2) - 1
            rows(i, 3, 2) = twice * (q(i, 3) * q(i, 4) - q(i, 1) * q(i, 2))
            rows(i, 1, 3) = twice * (q(i, 2) * q(i, 4) - q(i, 1) * q(i, 3))
            rows(i, 2, 3) = twice * (q(i, 3) * q(i, 4) + q(i, 1) * q(i, 2))
            rows(i, 3, 3) = twice * (q(i, 1)**2 + q(i, 4)**2) - 1
        end do
    end subroutine find_rows

    !> A vector at all instants.
    pure subroutine repeat_vector(a, b)
        real(dp), intent(in) :: a(3)
        real(dp), intent(out) :: b(instants, 3)
        integer :: m
        do m = 1, 3
            b(:, m) = a(m)
        end do
    end subroutine repeat_vector

    !> Adds a vector in space axes to one in body axes.
    pure subroutine add_in_body(rows, space, sum)
        real(dp), intent(in) :: rows(instants, 3, 3), space(instants, 3)
        real(dp), intent(inout) :: sum(instants, 3)
        integer :: m
        do m = 1, 3
            sum(:, m) = sum(:, m) + (space(:, 1) * rows(:, m, 1) + space(:, 2) * rows(:, m, 2) + space(:, 3) * rows(:, m, 3))
        end do
    end subroutine add_in_body

    !> Power of the moment m a x r, where a = z'' + 2 O x z' + O x (O x z) with z = A cos(W t + f).
    pure function power_of_vibration(body, effects, t, rows, omega) result(power)
        type(body_t), intent(in) :: body
        type(effects_t), intent(in) :: effects
        real(dp), intent(in) :: t(instants), rows(instants, 3, 3), omega(instants, 3)
        real(dp), dimension(instants) :: power, cosine, sine
        real(dp), dimension(instants, 3) :: place, velocity, push, in_body
        integer :: m

        cosine = cos(effects%vibration_rate * t)
        sine = sin(effects%vibration_rate * t)
        associate (size => effects%vibration_amplitude, rate => effects%vibration_rate, o => effects%frame_rate, &
                   r => body%centre_of_mass)
            do m = 1, 3
                associate (c => cos(effects%vibration_phase(m)), s => sin(effects%vibration_phase(m)))
                    place(:, m) = size(m) * (cosine * c - sine * s)
                    velocity(:, m) = -size(m) * rate * (sine * c + cosine * s)
                end associate
            end do
            push = -rate**2 * place
            if (any(abs(o) > 0)) push = push + cross_all(o, 2 * velocity + cross_all(o, place))
            in_body = 0
            call add_in_body(rows, push, in_body)
            in_body = -cross_all(r, in_body)
        end associate
        power = body%mass * (in_body(:, 1) * omega(:, 1) + in_body(:, 2) * omega(:, 2) + in_body(:, 3) * omega(:, 3))
    end function power_of_vibration

    !> The vector product of a vector and the vectors at the instants.
    pure function cross_all(a, b) result(c)
        real(dp), intent(in) :: a(3), b(instants, 3)
        real(dp) :: c(instants, 3)
        c(:, 1) = a(2) * b(:, 3) - a(3) * b(:, 2)
        c(:, 2) = a(3) * b(:, 1) - a(1) * b(:, 3)
        c(:, 3) = a(1) * b(:, 2) - a(2) * b(:, 1)
    end function cross_all

    !> Adds the power of the moment -k |w|^(p-1) w of the air.
    pure subroutine add_drag_moment(effects, omega, power)
        type(effects_t), intent(in) :: effects
        real(dp), intent(in) :: omega(instants, 3)
        real(dp), intent(inout) :: power(instants)
        real(dp) :: square(instants), drag(instants)
        square = omega(:, 1)**2 + omega(:, 2)**2 + omega(:, 3)**2
        drag = sqrt(square)
        if (.not. is_zero(effects%drag_exponent - 2)) drag = drag**(effects%drag_exponent - 1)
        associate (k => effects%drag_moment)
            power = power - drag * (k(1) * omega(:, 1)**2 + k(2) * omega(:, 2)**2 + k(3) * omega(:, 3)**2)
        end associate
    end subroutine add_drag_moment

    !> Adds the power of the force -c |v| v on the centre of mass.
    pure subroutine add_drag_force(body, effects, omega, power)
        type(body_t), intent(in) :: body
        type(effects_t), intent(in) :: effects
        real(dp), intent(in) :: omega(instants, 3)
        real(dp), intent(inout) :: power(instants)
        real(dp) :: v(instants, 3), square(instants)
        v = cross_all(body%centre_of_mass, omega)
        square = v(:, 1)**2 + v(:, 2)**2 + v(:, 3)**2
        power = power - effects%drag_force * sqrt(square) * square
    end subroutine add_drag_force

end module spintop_powers
