!> The roots of the cubic that bounds the nutation, without cancellation.
!>
!> With u = u0 + y the nutation obeys u'^2 = f = beta y^3 + G2 y^2 + G1 y + G0, whose roots are
!> u1 <= u0 <= u2 <= 1 <= u3. Symbols as in `regular_start`; `closed_form.h` says how they are found.
module spintop_turning_points
    use, intrinsic :: iso_c_binding, only: c_long_double
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_regular_start, only: regular_start_t, find_regular_start
    use spintop_status, only: is_ok
    use spintop_validity, only: body_status, start_status
    implicit none
    private
    public :: turning_points_t, cubic_t, roots_t, find_turning_points, find_checked_points

    !> What the closed form needs of a start: a, beta, 1 - u0, 1 + u0, phi0' sin(theta0)^2, K0, b - a, b + a, u0', and the
    !> coefficients of the cubic.
    type, bind(C) :: cubic_t
        real(c_long_double) :: a = 0, beta = 0, one_minus_u = 0, one_plus_u = 2, turn = 0, swing_squared = 0, &
            b_minus_a = 0, b_plus_a = 0, u_rate = 0, g0 = 0, g1 = 0, g2 = 0
    end type cubic_t

    !> Differences of the roots; those with beta in the name stay finite without gravity.
    type, bind(C) :: roots_t
        !> u1 - u0 <= 0, u2 - u0 >= 0, beta (u3 - u0), and u2 - u1.
        real(c_long_double) :: y1 = 0, y2 = 0, beta_y3 = 0, u2_minus_u1 = 0
        !> 1 - u1, 1 - u2, 1 + u1, 1 + u2.
        real(c_long_double) :: one_minus_u1 = 0, one_minus_u2 = 0, one_plus_u1 = 2, one_plus_u2 = 2
        !> beta (u3 - 1), beta (u3 - u1), beta (1 + u3), rad^2/s^2.
        real(c_long_double) :: beta_u3_minus_1 = 0, beta_u3_minus_u1 = 0, beta_u3_plus_1 = 0
        !> Modulus squared k^2, its complement k'^2, and k'.
        real(c_long_double) :: k_squared = 0, complement_squared = 1, complement = 1
        !> Rate of the argument of the elliptic functions, rad/s.
        real(c_long_double) :: frequency = 0
        !> Inverses of 1 - u1, 1 + u2, beta (u3 - u1) and beta (1 + u3); 0 of 0.
        real(c_long_double) :: per_one_minus_u1 = 0, per_one_plus_u2 = 0, per_beta_u3_minus_u1 = 0, per_beta_u3_plus_1 = 0
        !> Square roots of beta (u3 - 1), of (1 - u1) (1 - u2), and of the last inverse.
        real(c_long_double) :: root_of_beta_u3_minus_1 = 0, root_of_upper_distances = 0, root_of_per_beta_u3_plus_1 = 0
    end type roots_t

    !> The start with its cubic.
    type, extends(regular_start_t) :: turning_points_t
        type(cubic_t) :: cubic
        type(roots_t) :: roots
    end type turning_points_t

    interface
        pure subroutine find_roots(cubic, roots) bind(C, name='spintop_find_roots')
            import :: cubic_t, roots_t
            type(cubic_t), intent(in) :: cubic
            type(roots_t), intent(out) :: roots
        end subroutine find_roots
    end interface

contains

    !> The turning points of unchecked data. `status` is one of `find_regular_start` or of `spintop_validity`.
    pure subroutine find_checked_points(body, start, points, status, rotor)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(turning_points_t), intent(out) :: points !! the start and its turning points
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(in), optional :: rotor !! constant momentum of a rotor about body z, kg m^2/s
        call find_regular_start(body, start, points%regular_start_t, status, rotor)
        if (is_ok(status)) status = body_status(body)
        if (is_ok(status)) status = start_status(start, body)
        if (is_ok(status)) call set_turning_points(points)
    end subroutine find_checked_points

    !> Finds the turning points of a start.
    pure type(turning_points_t) function find_turning_points(start) result(points)
        type(regular_start_t), intent(in) :: start !! the start in regular quantities
        points%regular_start_t = start
        call set_turning_points(points)
    end function find_turning_points

    !> Sets the turning points of the start. In place: a copy of numbers that were just stored in extended precision waits for
    !> each of them.
    pure subroutine set_turning_points(points)
        type(turning_points_t), intent(inout) :: points
        associate (u0 => points%u, a => points%a, beta => points%beta, k0 => points%swing_squared)
            points%cubic = cubic_t(a, beta, points%one_minus_u, points%one_plus_u, points%turn, k0, points%b_minus_a, &
                points%b_plus_a, points%u_rate, points%u_rate**2, -2 * u0 * k0 - beta * points%sine_squared + 2 * a * points%turn, &
                2 * beta * u0 - k0 - a**2)
        end associate
        call find_roots(points%cubic, points%roots)
    end subroutine set_turning_points

end module spintop_turning_points
