!> Attitude and its rates: Euler angles z-x-z (Goldstein), unit quaternion, body axes.
!>
!> Angles are `angle = (phi, theta, psi)`, precession, inclination, spin; the quaternion has its
!> scalar first and turns body into space axes. Conventions: Provatidis (2012), Eqs 1-10.
module spintop_attitude
    use spintop_compare, only: is_zero
    use spintop_kinds, only: dp, pi, xp
    use spintop_small_turn, only: half_turn
    implicit none
    private
    public :: quaternion_from_angles, angles_from_quaternion
    public :: omega_from_rates, rates_from_omega, omega_rate_from_accelerations
    public :: quaternion_product, conjugate_quaternion, to_space, vertical_from_quaternion
    public :: rotation_angle, nearest_turn, follow_angles, rotation_minus_one

    !> pi in extended precision.
    real(xp), parameter :: half_of_turn = acos(-1.0_xp)

contains

    !> Unit quaternion of the angles.
    pure function quaternion_from_angles(angle) result(q)
        real(dp), intent(in) :: angle(3)
        real(dp) :: q(4), plus(2), minus(2)
        plus = circular_of_half(angle(1), angle(3))
        minus = circular_of_half(angle(1), -angle(3))
        associate (half => angle(2) / 2)
            q = [cos(half) * plus(1), sin(half) * minus(1), sin(half) * minus(2), cos(half) * plus(2)]
        end associate
    end function quaternion_from_angles

    !> cos((a + b)/2) and sin((a + b)/2): of many turns the rounding of the sum would be all that matters.
    pure function circular_of_half(a, b) result(circular)
        real(dp), intent(in) :: a, b
        real(dp) :: circular(2), total, part, lost, c, s
        total = a + b
        part = total - a
        lost = ((a - (total - part)) + (b - part)) / 2 ! of the sum by its rounding, exactly (Knuth)
        c = cos(total / 2)
        s = sin(total / 2)
        circular = [c - lost * s, s + lost * c]
    end function circular_of_half

    !> Angles of a quaternion (of any length, either sign): theta in [0, pi]; phi and psi are the
    !> values next to those of `near`, so they stay continuous along a motion. At a pole only
    !> phi + psi or phi - psi exists; the other combination is kept from `near`.
    pure function angles_from_quaternion(q, near) result(angle)
        real(dp), intent(in) :: q(4), near(3)
        real(dp) :: angle(3), upper, lower
        real(xp) :: plus, minus, offset(2), flipped(2)

        upper = hypot(q(1), q(4))
        lower = hypot(q(2), q(3))
        ! In extended precision, so that many turns are rounded once: in the result.
        plus = (real(near(1), xp) + near(3)) / 2
        minus = (real(near(1), xp) - near(3)) / 2
        offset = 0
        if (upper > 0) offset(1) = least_turn(atan2(q(4), q(1)) - plus)
        if (lower > 0) offset(2) = least_turn(atan2(q(3), q(2)) - minus)
        ! q and -q are one attitude: both half angles, where they exist, may move by pi together.
        flipped = merge(least_turn(offset + half_of_turn), 0.0_xp, [upper, lower] > 0)
        if (sum(abs(flipped)) < sum(abs(offset))) offset = flipped
        plus = plus + offset(1)
        minus = minus + offset(2)
        angle = [real(plus + minus, dp), 2 * atan2(lower, upper), real(plus - minus, dp)]
    end function angles_from_quaternion

    !> Carries angles over a time h from the attitude `q_last`, which has them, to the attitude `q`:
    !> phi and psi continuous, whatever the number of turns between, and to rounding; theta is kept.
    !> Both quaternions are of one continuous motion, of any length; `omega_last` and `omega` are the
    !> angular velocities in body axes, rad/s. `sure` means that the axis passed no pole so closely
    !> that it is not clear on which side: phi and psi may then be a whole turn off, to and fro.
    !> Turns by thousands of radians at once are not followed.
    pure subroutine follow_angles(q_last, omega_last, q, omega, h, angle, sure)
        real(dp), intent(in) :: q_last(4), omega_last(3), q(4), omega(3), h
        real(dp), intent(inout) :: angle(3)
        logical, intent(out) :: sure
        !> Turn over which the half angles are compared directly, rad: they change by less than half
        !> a turn even if the axis passes a pole.
        real(dp), parameter :: largest_turn = pi / 2
        !> Change of a half angle by more than that shows a pole, rad.
        real(dp), parameter :: sharp = 2
        !> A longer turn is not followed: a computation that takes it in one step does not resolve the
        !> turns between.
        real(dp), parameter :: endless_turn = 1.0e4_dp
        real(dp) :: turn, half(2), change(2), here(4), there(4)
        integer :: pieces, i

        sure = .true.
        turn = h * sqrt(max(sum(omega_last**2), sum(omega**2)))
        if (.not. turn <= endless_turn) then
            angle = angles_from_quaternion(q, angle)
            return
        end if
        half = [angle(1) + angle(3), angle(1) - angle(3)] / 2
        pieces = max(1, ceiling(turn / largest_turn))
        here = q_last
        ! A longer turn goes one half of the time with the first angular velocity, the other with
        ! the second.
        do i = 1, pieces
            if (i == pieces) then
                there = q
            else if (2 * i <= pieces) then
                there = quaternion_product(q_last, turn_by(omega_last * (h * i / pieces)))
            else
                there = quaternion_product(q, turn_by(omega * (h * (i - pieces) / pieces)))
            end if
            change = half_angle_change(here, there)
            half = half + change
            sure = sure .and. all(abs(change) < sharp)
            here = there
        end do
        angle = [half(1) + half(2), angle(2), half(1) - half(2)]
        ! At a pole one half angle begins anew, with the next turn of the axis.
        if (all(is_zero(q_last(1:4:3))) .or. all(is_zero(q_last(2:3)))) then
            angle = angles_from_quaternion(q, angle)
        end if
    end subroutine follow_angles

    !> Change of (phi + psi)/2 and (phi - psi)/2 between two attitudes, each by less than half a
    !> turn, rad; zero where it does not exist.
    pure function half_angle_change(p, q) result(change)
        real(dp), intent(in) :: p(4), q(4)
        real(dp) :: change(2)
        real(dp) :: along(2), across(2)
        along = [q(1) * p(1) + q(4) * p(4), q(2) * p(2) + q(3) * p(3)]
        across = [q(4) * p(1) - q(1) * p(4), q(3) * p(2) - q(2) * p(3)]
        change = 0
        where (abs(along) + abs(across) > 0) change = atan2(across, along)
    end function half_angle_change

    !> Unit quaternion of a turn about the direction of a vector by its length, rad.
    pure function turn_by(vector) result(q)
        real(dp), intent(in) :: vector(3)
        real(dp) :: q(4)
        q = rotation_minus_one(vector)
        q(1) = q(1) + 1
    end function turn_by

    !> The same less the quaternion 1: its products are the changes of an attitude by the turn.
    pure function rotation_minus_one(vector) result(q)
        real(dp), intent(in) :: vector(3)
        real(dp) :: q(4), sinc, drop
        call half_turn(sum((vector / 2)**2), sinc, drop)
        q = [drop, vector * (sinc / 2)]
    end function rotation_minus_one

    !> The value next to `near` among `angle` + 2 pi n, rad.
    elemental real(dp) function nearest_turn(angle, near)
        real(dp), intent(in) :: angle, near
        nearest_turn = real(near + least_turn(real(angle, xp) - near), dp)
    end function nearest_turn

    !> The value next to zero among `angle` + 2 pi n, rad.
    elemental real(xp) function least_turn(angle)
        real(xp), intent(in) :: angle
        least_turn = angle - 2 * half_of_turn * anint(angle / (2 * half_of_turn))
    end function least_turn

    !> Angular velocity in body axes of the rates of the angles, rad/s.
    pure function omega_from_rates(angle, rate) result(omega)
        real(dp), intent(in) :: angle(3), rate(3)
        real(dp) :: omega(3)
        omega(1) = rate(1) * sin(angle(2)) * sin(angle(3)) + rate(2) * cos(angle(3))
        omega(2) = rate(1) * sin(angle(2)) * cos(angle(3)) - rate(2) * sin(angle(3))
        omega(3) = rate(1) * cos(angle(2)) + rate(3)
    end function omega_from_rates

    !> Rates of the angles of an angular velocity in body axes, rad/s. Not finite at a pole, where
    !> phi and psi do not exist separately.
    pure function rates_from_omega(angle, omega) result(rate)
        real(dp), intent(in) :: angle(3), omega(3)
        real(dp) :: rate(3)
        rate(1) = (omega(1) * sin(angle(3)) + omega(2) * cos(angle(3))) / sin(angle(2))
        rate(2) = omega(1) * cos(angle(3)) - omega(2) * sin(angle(3))
        rate(3) = omega(3) - rate(1) * cos(angle(2))
    end function rates_from_omega

    !> Time derivative of the body angular velocity, rad/s^2, from the second derivatives of phi
    !> and theta and from that of omega3 (Eq 51).
    pure function omega_rate_from_accelerations(angle, rate, phi_acceleration, &
                                                theta_acceleration, omega3_rate) result(omega_rate)
        real(dp), intent(in) :: angle(3), rate(3)
        real(dp), intent(in) :: phi_acceleration, theta_acceleration, omega3_rate
        real(dp) :: omega_rate(3)
        real(dp) :: along, across
        ! Components on the line of nodes and across it, both before the turn by psi.
        along = theta_acceleration + rate(1) * rate(3) * sin(angle(2))
        across = phi_acceleration * sin(angle(2)) + rate(1) * rate(2) * cos(angle(2)) &
                 - rate(2) * rate(3)
        omega_rate(1) = across * sin(angle(3)) + along * cos(angle(3))
        omega_rate(2) = across * cos(angle(3)) - along * sin(angle(3))
        omega_rate(3) = omega3_rate
    end function omega_rate_from_accelerations

    !> Product p q of two quaternions: first the turn q, then p.
    pure function quaternion_product(p, q) result(r)
        real(dp), intent(in) :: p(4), q(4)
        real(dp) :: r(4)
        r(1) = p(1) * q(1) - p(2) * q(2) - p(3) * q(3) - p(4) * q(4)
        r(2) = p(1) * q(2) + p(2) * q(1) + p(3) * q(4) - p(4) * q(3)
        r(3) = p(1) * q(3) - p(2) * q(4) + p(3) * q(1) + p(4) * q(2)
        r(4) = p(1) * q(4) + p(2) * q(3) - p(3) * q(2) + p(4) * q(1)
    end function quaternion_product

    !> Conjugate: the inverse turn of a unit quaternion.
    pure function conjugate_quaternion(q) result(r)
        real(dp), intent(in) :: q(4)
        real(dp) :: r(4)
        r = [q(1), -q(2), -q(3), -q(4)]
    end function conjugate_quaternion

    !> A vector of body axes in space axes.
    pure function to_space(q, v) result(w)
        real(dp), intent(in) :: q(4), v(3)
        real(dp) :: w(3), r(4)
        r = quaternion_product(quaternion_product(q, [0.0_dp, v]), conjugate_quaternion(q))
        w = r(2:4)
    end function to_space

    !> Upward vertical in body axes, "Gamma".
    pure function vertical_from_quaternion(q) result(gamma)
        real(dp), intent(in) :: q(4)
        real(dp) :: gamma(3)
        gamma(1) = 2 * (q(2) * q(4) - q(1) * q(3))
        gamma(2) = 2 * (q(3) * q(4) + q(1) * q(2))
        gamma(3) = (q(1)**2 + q(4)**2) - (q(2)**2 + q(3)**2)
    end function vertical_from_quaternion

    !> Rotation angle between two attitudes, rad, in [0, pi]; exact to rounding for small turns.
    pure real(dp) function rotation_angle(p, q)
        real(dp), intent(in) :: p(4), q(4)
        real(dp) :: r(4)
        r = quaternion_product(conjugate_quaternion(p), q)
        rotation_angle = 2 * atan2(norm2(r(2:4)), abs(r(1)))
    end function rotation_angle

end module spintop_attitude
