!> The roots of the cubic that bounds the nutation, without cancellation.
!>
!> With u = u0 + y the nutation obeys u'^2 = f = beta y^3 + G2 y^2 + G1 y + G0, whose roots are
!> u1 <= u0 <= u2 <= 1 <= u3. The trigonometric formula of textbooks loses all digits of u2 - u1 for fast
!> tops; here every difference of roots that is needed is computed separately. Symbols as in `regular_start`.
module spintop_turning_points
    use spintop_kinds, only: dp, xp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_theta_functions, only: quotient
    use spintop_regular_start, only: regular_start_t, find_regular_start
    use spintop_status, only: is_ok
    use spintop_validity, only: body_status, start_status
    implicit none
    private
    public :: turning_points_t, find_turning_points, find_checked_points

    !> The start, and differences of the roots; those with beta in the name stay finite without gravity.
    type, extends(regular_start_t) :: turning_points_t
        !> u1 - u0 <= 0, u2 - u0 >= 0 and u2 - u1.
        real(xp) :: y1 = 0, y2 = 0, u2_minus_u1 = 0
        !> 1 - u1, 1 - u2, 1 + u1, 1 + u2.
        real(xp) :: one_minus_u1 = 0, one_minus_u2 = 0, one_plus_u1 = 2, one_plus_u2 = 2
        !> beta (u3 - 1), beta (u3 - u1), beta (1 + u3), rad^2/s^2.
        real(xp) :: beta_u3_minus_1 = 0, beta_u3_minus_u1 = 0, beta_u3_plus_1 = 0
        !> Modulus squared k^2, its complement k'^2, and k'.
        real(xp) :: k_squared = 0, complement_squared = 1, complement = 1
        !> Rate of the argument of the elliptic functions, rad/s.
        real(xp) :: frequency = 0
        !> Coefficients of the cubic f.
        real(xp) :: g0 = 0, g1 = 0, g2 = 0
    end type turning_points_t

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
        if (is_ok(status)) points = find_turning_points(points%regular_start_t)
    end subroutine find_checked_points

    !> Finds the turning points of a start.
    pure type(turning_points_t) function find_turning_points(start) result(points)
        type(regular_start_t), intent(in) :: start !! the start in regular quantities

        points%regular_start_t = start
        associate (u0 => start%u, a => start%a, beta => start%beta, s2 => start%sine_squared, &
                   k0 => start%swing_squared, g0 => points%g0, g1 => points%g1, g2 => points%g2)
            g0 = start%u_rate**2
            g1 = -2 * u0 * k0 - beta * s2 + 2 * a * start%turn
            g2 = 2 * beta * u0 - k0 - a**2
            if (upper_roots_are_close(points)) then
                call start_from_lowest(points)
            else
                call start_from_highest(points)
            end if

            points%one_plus_u1 = quotient(start%b_plus_a**2, &
                                          points%one_plus_u2 * points%beta_u3_plus_1)
            points%k_squared = quotient(beta * points%u2_minus_u1, points%beta_u3_minus_u1)
            points%complement_squared = quotient(beta * points%one_minus_u2 &
                + points%beta_u3_minus_1, points%beta_u3_minus_u1)
            points%complement = sqrt(points%complement_squared)
            points%frequency = sqrt(points%beta_u3_minus_u1) / 2
        end associate
    end function find_turning_points

    !> Whether the two upper roots are close together, so that an iteration for the highest one would be slow:
    !> the cubic is positive at its inflection, and the start is not itself a root.
    pure logical function upper_roots_are_close(points)
        type(turning_points_t), intent(in) :: points
        associate (beta => points%beta, g0 => points%g0, g1 => points%g1, g2 => points%g2)
            upper_roots_are_close = g0 > 0 .and. g2 * (2 * g2**2 - 9 * beta * g1) + 27 * beta**2 * g0 > 0
        end associate
    end function upper_roots_are_close

    !> The regular case: the highest root first, as Y3 = beta (u3 - u0), which is regular without gravity.
    pure subroutine start_from_highest(points)
        type(turning_points_t), intent(inout) :: points
        real(xp) :: root, discriminant, total, product, beta_1_minus_u2

        associate (beta => points%beta, y1 => points%y1, y2 => points%y2, g0 => points%g0, g1 => points%g1, g2 => points%g2)
            ! The larger root of Y^2 + G2 Y + beta G1: exact for a start at a turning point.
            discriminant = sqrt(max(g2**2 - 4 * beta * g1, 0.0_xp))
            if (g2 <= 0) then
                root = (discriminant - g2) / 2
            else
                root = -2 * beta * g1 / (g2 + discriminant)
            end if
            if (g0 > 0) then
                call walk_to_root([beta**2 * g0, beta * g1, g2, 1.0_xp], -1, root)
                product = -g0 / root
                total = (g1 - beta * product) / root
                points%u2_minus_u1 = sqrt(total**2 - 4 * product)
                if (total > 0) then
                    y2 = (total + points%u2_minus_u1) / 2
                    y1 = product / y2
                else
                    y1 = (total - points%u2_minus_u1) / 2
                    y2 = product / y1
                end if
            else
                y1 = min(quotient(g1, root), 0.0_xp)
                y2 = max(quotient(g1, root), 0.0_xp)
                points%u2_minus_u1 = y2 - y1
            end if

            points%one_minus_u1 = points%one_minus_u - y1
            points%one_minus_u2 = points%one_minus_u - y2
            points%one_plus_u2 = points%one_plus_u + y2
            points%beta_u3_minus_1 = root - beta * points%one_minus_u
            points%beta_u3_minus_u1 = root - beta * y1
            points%beta_u3_plus_1 = root + beta * points%one_plus_u

            ! f(1) = -(b-a)^2 relates the two distances from u = 1: the larger one is accurate.
            beta_1_minus_u2 = beta * points%one_minus_u2
            if (beta_1_minus_u2 >= points%beta_u3_minus_1) then
                points%beta_u3_minus_1 = quotient(points%b_minus_a**2, &
                                                  points%one_minus_u1 * points%one_minus_u2)
            else
                points%one_minus_u2 = quotient(points%b_minus_a**2, &
                                               points%one_minus_u1 * points%beta_u3_minus_1)
            end if
        end associate
    end subroutine start_from_highest

    !> Near a double upper root: the lowest root first, then the upper two from their sum and product.
    pure subroutine start_from_lowest(points)
        type(turning_points_t), intent(inout) :: points
        real(xp) :: y1, y3, excess, excess_error, other_error, product, larger, smaller
        real(xp) :: u3_minus_1

        associate (beta => points%beta, sh => points%one_minus_u, ch => points%one_plus_u, &
                   energy => points%swing_squared + points%a**2, g0 => points%g0, g1 => points%g1, g2 => points%g2)
            y1 = -ch
            call walk_to_root([g0, g1, g2, beta], 1, y1)

            ! u2 + u3 - 2 in two ways: the one with the smaller terms has less cancellation.
            excess_error = energy / beta + 2 - y1
            other_error = (abs(g1) - g0 / y1) / (-beta * y1) + 2 * sh
            if (other_error < excess_error) then
                excess = (g1 + g0 / y1) / (beta * y1) - 2 * sh
            else
                excess = energy / beta - 2 - y1
            end if
            points%one_minus_u1 = sh - y1
            product = points%b_minus_a**2 / (beta * points%one_minus_u1)
            larger = (abs(excess) + sqrt(excess**2 + 4 * product)) / 2
            smaller = quotient(product, larger)
            u3_minus_1 = merge(larger, smaller, excess >= 0)
            points%one_minus_u2 = merge(smaller, larger, excess >= 0)

            y3 = sh + u3_minus_1
            points%y1 = y1
            points%y2 = -g0 / (beta * y1 * y3)
            points%u2_minus_u1 = points%y2 - y1
            points%one_plus_u2 = ch + points%y2
            points%beta_u3_minus_1 = beta * u3_minus_1
            points%beta_u3_minus_u1 = beta * (y3 - y1)
            points%beta_u3_plus_1 = beta * (ch + y3)
        end associate
    end subroutine start_from_lowest

    !> Laguerre's method for an outermost real root of sum c(n) x^n, c(3) >= 0, from outside: upward to the
    !> lowest root (direction 1) or downward to the highest (direction -1). Only rounding errors carry an
    !> iterate past the root; the iteration then settles to relative precision, also for a root that is very
    !> small compared with the first guess.
    pure subroutine walk_to_root(c, direction, x)
        real(xp), intent(in) :: c(0:3)
        integer, intent(in) :: direction
        real(xp), intent(inout) :: x
        integer, parameter :: most_iterations = 60, most_returns = 3
        real(xp) :: g, slope, curvature, step
        integer :: n, returns
        returns = 0
        do n = 1, most_iterations
            g = c(0) + x * (c(1) + x * (c(2) + x * c(3)))
            slope = c(1) + x * (2 * c(2) + x * 3 * c(3))
            curvature = 2 * c(2) + 6 * c(3) * x
            step = -quotient(3 * g, slope + sqrt(max(4 * slope**2 - 6 * g * curvature, 0.0_xp)))
            x = x + step
            if (abs(step) <= epsilon(x) * abs(x)) exit
            if (direction * step < 0) returns = returns + 1
            if (returns > most_returns) exit
        end do
    end subroutine walk_to_root

end module spintop_turning_points
