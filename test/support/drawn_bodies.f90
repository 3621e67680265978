!> Bodies drawn at random, always the same: of any kind, free ones, and tops, also in other units.
module drawn_bodies
    use mechanics
    use spintop_random, only: uniform
    implicit none
    private
    public :: draw_case, draw_cases, draw_free, free_body
    public :: units_t, draw_symmetric, draw_general, body_in_units, start_in_units, reversed

    !> How many of the new units are one of the old.
    type :: units_t
        real(dp) :: mass = 1, length = 1, time = 1
    end type units_t

contains

    !> The case of a number: any shape and damping, slow and so fast that it turns several times in a step, released at
    !> rest, hanging, next to the poles.
    subroutine draw_case(i, body, start, t_end)
        integer, intent(in) :: i !! number of the case
        type(body_t), intent(out) :: body
        type(motion_t), intent(out) :: start
        real(dp), intent(out) :: t_end
        real(dp) :: x(12), angle(3), rate(3)
        integer :: k
        do k = 1, size(x)
            x(k) = modulo(sin(12.9898_dp * i + 78.233_dp * k) * 43758.5453_dp, 1.0_dp)
        end do
        body = unit_body(0.2_dp + 0.5_dp * (sum(x(1:3)) - 0.9_dp * x(1:3)), x(4:6) - [0.5_dp, 0.5_dp, 0.2_dp])
        body%damping = 0.02_dp * x(7) * body%inertia
        angle = [0.3_dp, 0.05_dp + 3 * x(8), -0.4_dp]
        rate = [2 * x(9) - 1, x(10) - 0.5_dp, 0.5_dp * 60**x(11)]
        if (mod(i, 5) == 0) rate(1:2) = 0
        if (mod(i, 11) == 0) angle(2) = 1.0e-3_dp
        if (mod(i, 13) == 0) angle(2) = pi - 1.0e-3_dp
        start = motion_from_angles(0.0_dp, angle, rate)
        t_end = 2 + 6 * x(12)
    end subroutine draw_case

    !> The first cases.
    subroutine draw_cases(bodies, starts, t_end)
        type(body_t), intent(out) :: bodies(:)
        type(motion_t), intent(out) :: starts(:)
        real(dp), intent(out) :: t_end(:)
        integer :: i
        do i = 1, size(bodies)
            call draw_case(i, bodies(i), starts(i), t_end(i))
        end do
    end subroutine draw_cases

    !> A body without gravity.
    type(body_t) function free_body(inertia) result(body)
        real(dp), intent(in) :: inertia(3) !! principal moments, kg m^2
        body%gravity = 0
        body%inertia = inertia
    end function free_body

    !> A drawn body in one of the regimes: any; near the separatrix; near a stable axis; nearly a sphere;
    !> nearly symmetric.
    subroutine draw_free(stream, n, body, start)
        type(random_stream_t), intent(inout) :: stream !! the numbers
        integer, intent(in) :: n !! its remainder by six is the regime
        type(body_t), intent(out) :: body !! the body
        type(motion_t), intent(out) :: start !! its start
        real(dp) :: inertia(3), omega(3), q(4), small
        small = 10.0_dp**(-15 * stream%share())
        inertia = stream%several(3, 1.0_dp, 2.0_dp)
        omega = stream%several(3, -3.0_dp, 3.0_dp)
        select case (mod(n, 6))
        case (1)
            ! On the separatrix but for a small part.
            inertia = [3, 4, 6]
            omega(1) = 2 * omega(3) * (1 + small)
        case (2)
            inertia = [0.5_dp, 0.7_dp, 0.9_dp]
            omega([1, 3]) = small * omega([1, 3])
        case (3)
            omega([1, 2]) = small * omega([1, 2])
        case (4)
            inertia = inertia(1) * [1.0_dp, 1 + small, 1 + small * inertia(3)]
        case (5)
            inertia(2) = inertia(1) * (1 + small)
        end select
        q = stream%several(4, -1.0_dp, 1.0_dp)
        body = free_body(inertia)
        start = start_from(q / norm2(q), omega)
    end subroutine draw_free

    !> Number `place` of the draw `number`, between two bounds.
    real(dp) function drawn(number, place, low, high)
        integer, intent(in) :: number, place
        real(dp), intent(in) :: low, high
        integer(int64), parameter :: seed = 20120071
        drawn = low + (high - low) * uniform(seed, int(number, int64), int(place, int64))
    end function drawn

    !> A symmetric top that stays away from the poles: its axis rises and falls about the horizontal.
    !> Every third is free of gravity torque.
    subroutine draw_symmetric(number, body, start)
        integer, intent(in) :: number
        type(body_t), intent(out) :: body
        type(motion_t), intent(out) :: start
        body%mass = drawn(number, 1, 0.5_dp, 2.0_dp)
        body%inertia(1:2) = drawn(number, 2, 0.5_dp, 1.5_dp)
        body%inertia(3) = body%inertia(1) * drawn(number, 3, 0.3_dp, 1.7_dp)
        body%centre_of_mass = [0.0_dp, 0.0_dp, drawn(number, 4, 0.02_dp, 0.1_dp)]
        if (mod(number, 3) == 0) body%centre_of_mass = 0
        start = motion_from_angles(0.0_dp, [drawn(number, 5, -3.0_dp, 3.0_dp), drawn(number, 6, 1.0_dp, 1.8_dp), &
            drawn(number, 7, -3.0_dp, 3.0_dp)], [drawn(number, 8, -0.6_dp, 0.6_dp), &
            drawn(number, 9, 0.1_dp, 0.3_dp), drawn(number, 10, 1.5_dp, 4.0_dp)])
    end subroutine draw_symmetric

    !> A body without symmetry, of any attitude, damped or not. Every third is free of gravity torque.
    subroutine draw_general(number, damped, body, start)
        integer, intent(in) :: number
        logical, intent(in) :: damped
        type(body_t), intent(out) :: body
        type(motion_t), intent(out) :: start
        integer :: i
        body%mass = drawn(number, 1, 0.5_dp, 2.0_dp)
        body%inertia = [(drawn(number, 1 + i, 0.7_dp, 1.3_dp), i=1, 3)]
        body%centre_of_mass = [(drawn(number, 4 + i, -0.1_dp, 0.1_dp), i=1, 3)]
        if (mod(number, 3) == 0) body%centre_of_mass = 0
        if (damped) body%damping = [(drawn(number, 7 + i, 0.0_dp, 0.2_dp), i=1, 3)]
        start = motion_from_angles(0.0_dp, [drawn(number, 11, -pi, pi), drawn(number, 12, 0.1_dp, 3.0_dp), &
            drawn(number, 13, -pi, pi)], [(drawn(number, 13 + i, -2.0_dp, 2.0_dp), i=1, 3)])
    end subroutine draw_general

    !> A body in other units.
    pure type(body_t) function body_in_units(body, units) result(other)
        type(body_t), intent(in) :: body
        type(units_t), intent(in) :: units
        other%mass = body%mass * units%mass
        other%inertia = body%inertia * (units%mass * units%length**2)
        other%centre_of_mass = body%centre_of_mass * units%length
        other%gravity = body%gravity * (units%length / units%time**2)
        other%damping = body%damping * (units%mass * units%length**2 / units%time)
    end function body_in_units

    !> A start in other units; its quaternion stays as it is to the last bit.
    pure type(motion_t) function start_in_units(start, units) result(other)
        type(motion_t), intent(in) :: start
        type(units_t), intent(in) :: units
        other = start
        other%t = start%t * units%time
        other%rate = start%rate / units%time
        other%omega = start%omega / units%time
        other%omega_rate = start%omega_rate / units%time**2
    end function start_in_units

    !> The motion as it would go back.
    elemental type(motion_t) function reversed(motion) result(back)
        type(motion_t), intent(in) :: motion
        back = motion
        back%t = 0
        back%rate = -motion%rate
        back%omega = -motion%omega
    end function reversed

end module drawn_bodies
