!> Extremes of the support force of an undamped symmetric top over a nutation.
!>
!> The magnitude of the force at O depends on the inclination alone. With the symmetry axis e the centre
!> of mass has the acceleration l e'' (Newton and Euler's equations),
!>
!>     e'' = -K e + a e x e' - (beta/2) (z - u e),    K = |e'|^2 = K0 - beta (u-u0),
!>
!> so that both the vertical force and the square of the total force are quadratic in u.
module spintop_force_extremes
    use spintop_kinds, only: dp, xp, is_finite
    use spintop_status, only: is_ok, status_non_finite
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_turning_points, only: turning_points_t, find_checked_points
    implicit none
    private
    public :: force_extremes_t, find_force_extremes

    !> Extremes of the support force over a nutation, N.
    type :: force_extremes_t
        !> Smallest and largest upward force.
        real(dp) :: lowest_vertical = 0, highest_vertical = 0
        !> Largest magnitude of the force.
        real(dp) :: largest = 0
    end type force_extremes_t

contains

    !> Finds the extremes for a start. `status` as in `prepare_exact_motion`.
    pure subroutine find_force_extremes(body, start, extremes, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(force_extremes_t), intent(out) :: extremes !! extremes of the support force, N
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(turning_points_t) :: points
        real(xp) :: vertical(3), turning_y

        call find_checked_points(body, start, points, status)
        if (.not. is_ok(status)) return
        associate (y1 => points%roots%y1, y2 => points%roots%y2)
            vertical(1:2) = [vertical_force(body, points, y1), vertical_force(body, points, y2)]
            vertical(3) = vertical(1)
            ! u'' = f'(u)/2 has its minimum where f'' = 0, if the motion reaches that point.
            if (points%beta > 0) then
                turning_y = -points%cubic%g2 / (3 * points%beta)
                if (turning_y > y1 .and. turning_y < y2) then
                    vertical(3) = vertical_force(body, points, turning_y)
                end if
            end if
            extremes%lowest_vertical = real(minval(vertical), dp)
            extremes%highest_vertical = real(maxval(vertical), dp)
            ! The square of the force is convex in u, so its maximum is at a turning point.
            extremes%largest = real(max(total_force(body, points, y1), &
                                        total_force(body, points, y2)), dp)
        end associate
        if (.not. is_finite(extremes%lowest_vertical + extremes%highest_vertical + extremes%largest)) then
            status = status_non_finite
        end if
    end subroutine find_force_extremes

    !> Upward force at u = u0 + y, N: m (g + l u''), u'' = f'(u)/2.
    pure real(xp) function vertical_force(body, start, y) result(force)
        type(body_t), intent(in) :: body
        type(turning_points_t), intent(in) :: start
        real(xp), intent(in) :: y
        force = body%mass * (body%gravity + body%centre_of_mass(3) &
                             * (3 * start%beta * y**2 + 2 * start%cubic%g2 * y + start%cubic%g1) / 2)
    end function vertical_force

    !> Magnitude of the force at u = u0 + y, N: its part along the axis, m (g u - l K), and that across.
    pure real(xp) function total_force(body, start, y) result(force)
        type(body_t), intent(in) :: body
        type(turning_points_t), intent(in) :: start
        real(xp), intent(in) :: y
        real(xp) :: u, sine_squared, swing_squared, turn, length, along, weight, lift
        length = body%centre_of_mass(3)
        u = start%u + y
        sine_squared = (start%one_minus_u - y) * (start%one_plus_u + y)
        swing_squared = start%swing_squared - start%beta * y
        turn = start%turn - start%a * y
        along = body%gravity * u - length * swing_squared
        weight = body%gravity - length * start%beta / 2
        lift = length * start%a
        ! Across: weight (z - u e) + lift e x e', with (e x e').z = phi' sin(theta)^2.
        force = body%mass * sqrt(max(along**2 + weight**2 * sine_squared &
                                     + 2 * weight * lift * turn + lift**2 * swing_squared, 0.0_xp))
    end function total_force

end module spintop_force_extremes
