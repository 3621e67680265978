!> Attitude and its rates: Euler angles z-x-z (Goldstein), unit quaternion, body axes.
!>
!> Angles are `angle = (phi, theta, psi)`: precession, inclination, spin. The quaternion has its scalar part
!> first and transforms body axes to space axes. Conventions: Provatidis (2012), Eqs 1-10.
module spintop_attitude
    use spintop_kinds, only: dp, xp, pi, pi_xp, is_zero
    implicit none
    private
    public :: quaternion_from_angles, angles_from_quaternion
    public :: omega_from_rates, rates_from_omega, omega_rate_from_accelerations
    public :: attitude_circular_t, circular_of_attitude, omega_from_circular
    public :: quaternion_product, conjugate_quaternion, to_space, vertical_from_quaternion
    public :: rotation_angle, nearest_turn, follow_angles, may_meet_pole, rotation_minus_one, beside_pole, square_to_pole
    public :: half_turn

    !> Body z is beside a pole at smaller distances from it, rad: it may be passing through it (spintop_pole_passages).
    real(dp), parameter :: beside_pole = 1.0e-9_dp

    !> Largest square of an angle for which the Taylor series, with as many terms, are exact to rounding.
    real(dp), parameter :: largest_square = 1
    !> (-1)^k/(2 k + 1)! and (-1)^k/(2 k)!: sin(x)/x and cos(x) are the sums of these times x^(2 k).
    real(dp), parameter :: s1 = -1 / 6.0_dp, s2 = -s1 / 20, s3 = -s2 / 42, s4 = -s3 / 72, &
        s5 = -s4 / 110, s6 = -s5 / 156, s7 = -s6 / 210, s8 = -s7 / 272, s9 = -s8 / 342
    real(dp), parameter :: c1 = -1 / 2.0_dp, c2 = -c1 / 12, c3 = -c2 / 30, c4 = -c3 / 56, &
        c5 = -c4 / 90, c6 = -c5 / 132, c7 = -c6 / 182, c8 = -c7 / 240, c9 = -c8 / 306

    !> Sines and cosines of theta and psi, on which the angular velocity in body axes depends.
    type :: attitude_circular_t
        real(dp) :: sine_theta = 0, cosine_theta = 1, sine_psi = 0, cosine_psi = 1
    end type attitude_circular_t

contains

    !> Unit quaternion of the angles.
    pure function quaternion_from_angles(angle) result(q)
        real(dp), intent(in) :: angle(3) !! phi, theta, psi, rad
        real(dp) :: q(4), plus(2), minus(2)
        plus = circular_of_half(angle(1), angle(3))
        minus = circular_of_half(angle(1), -angle(3))
        associate (half => angle(2) / 2)
            q = [cos(half) * plus(1), sin(half) * minus(1), sin(half) * minus(2), cos(half) * plus(2)]
        end associate
    end function quaternion_from_angles

    !> cos((a + b)/2) and sin((a + b)/2), with the rounding error of a + b corrected: after many turns it
    !> would dominate.
    pure function circular_of_half(a, b) result(circular)
        real(dp), intent(in) :: a, b
        real(dp) :: circular(2), total, part, lost, c, s
        total = a + b
        part = total - a
        lost = ((a - (total - part)) + (b - part)) / 2 ! half the rounding error of the sum, exact (Knuth)
        c = cos(total / 2)
        s = sin(total / 2)
        circular = [c - lost * s, s + lost * c]
    end function circular_of_half

    !> Angles of a quaternion (of any norm, either sign). theta is in [0, pi]; phi and psi are the values
    !> nearest to those of `near`, so they are continuous along a motion. At a pole only phi + psi or phi -
    !> psi exists; the other combination is taken from `near`.
    pure function angles_from_quaternion(q, near) result(angle)
        real(dp), intent(in) :: q(4), near(3) !! quaternion, and angles near the result, rad
        real(dp) :: angle(3), upper, lower
        real(xp) :: plus, minus, offset(2), flipped(2)

        upper = hypot(q(1), q(4))
        lower = hypot(q(2), q(3))
        ! In extended precision: the result is rounded once, for any number of turns.
        plus = (real(near(1), xp) + near(3)) / 2
        minus = (real(near(1), xp) - near(3)) / 2
        offset = 0
        if (upper > 0) offset(1) = least_turn(atan2(q(4), q(1)) - plus)
        if (lower > 0) offset(2) = least_turn(atan2(q(3), q(2)) - minus)
        ! q and -q are the same attitude: both half angles, where they exist, may change by pi together.
        flipped = merge(offset - sign(pi_xp, offset), 0.0_xp, [upper, lower] > 0)
        if (sum(abs(flipped)) < sum(abs(offset))) offset = flipped
        plus = plus + offset(1)
        minus = minus + offset(2)
        angle = [real(plus + minus, dp), 2 * atan2(lower, upper), real(plus - minus, dp)]
    end function angles_from_quaternion

    !> Continues angles over a time h, from the attitude `q_last` to the attitude `q`. phi and psi stay
    !> continuous to rounding, for any number of turns in between; theta is not changed. Both quaternions
    !> belong to one continuous motion and may have any norm. `sure` is false if the axis passes so close to a
    !> pole, or circles about it, that the side is not certain; phi and psi may then be wrong by whole turns of
    !> opposite sign. Rotations by thousands of radians at once are not followed.
    pure subroutine follow_angles(q_last, omega_last, q, omega, h, angle, sure, beside, omega_rate)
        real(dp), intent(in) :: q_last(4), omega_last(3), q(4), omega(3)
            !! quaternion and angular velocity in body axes, rad/s, at the beginning; the same at the end
        real(dp), intent(in) :: h !! time, s
        real(dp), intent(inout) :: angle(3)
            !! phi, theta, psi at the earlier state on entry, at the later one on return, rad
        logical, intent(out) :: sure, beside !! whether the turns are certain; whether body z is beside a pole at the end
        real(dp), intent(in), optional :: omega_rate(3, 2)
            !! rates of the angular velocity at the beginning and the end, rad/s^2; needed where the axis may
            !! meet a pole (`may_meet_pole`), and not used elsewhere
        !> Largest rotation angle for which half angles are compared directly, rad: they change by less than
        !> half a turn even if the axis passes a pole.
        real(dp), parameter :: largest_turn = pi / 2
        !> A larger change of a half angle indicates a pole, rad: its cosine is negative, and larger in magnitude.
        real(dp), parameter :: sharp = 2
        !> A larger rotation is not followed: a step of this size does not resolve the turns.
        real(dp), parameter :: endless_turn = 1.0e4_dp
        real(dp) :: turn, half(2), here(4), there(4), bend(2)
        complex(dp), dimension(2) :: change, pair
        logical :: is_bent
        integer :: pieces, i

        sure = .true.
        beside = min(sum(q(1:4:3)**2), sum(q(2:3)**2)) < (beside_pole / 2)**2 * sum(q**2)
        turn = h * sqrt(max(sum(omega_last**2), sum(omega**2)))
        if (.not. turn <= endless_turn) then
            angle = angles_from_quaternion(q, angle)
            return
        end if
        half = [angle(1) + angle(3), angle(1) - angle(3)] / 2
        pieces = max(1, ceiling(turn / largest_turn))
        here = q_last
        pair = 1
        is_bent = .false.
        if (present(omega_rate)) is_bent = may_meet_pole(q_last, omega_last, q, omega, h)
        if (is_bent) then
            bend(1) = h * sqrt(max(sum((omega(1:2) - omega_last(1:2))**2), &
                                h**2 * maxval(sum(omega_rate(1:2, :)**2, 1))))
            bend(2) = h * max(abs(omega(3) - omega_last(3)), h * maxval(abs(omega_rate(3, :))))
        end if
        ! A larger rotation is divided in two: half of the time with the first angular velocity, half with the
        ! second.
        do i = 1, pieces
            if (i == pieces) then
                there = q
            else if (2 * i <= pieces) then
                there = quaternion_product(q_last, turn_by(omega_last * (h * i / pieces)))
            else
                there = quaternion_product(q, turn_by(omega * (h * (i - pieces) / pieces)))
            end if
            change = half_angle_change(here, there)
            sure = sure .and. all(change%re > 0 .or. change%re**2 <= cos(sharp)**2 * (change%re**2 + change%im**2))
            ! Two changes by less than a quarter of a turn are one by less than half a turn: one arctangent does.
            if (mod(i, 2) == 0 .and. all(pair%re > 0 .and. change%re > 0)) then
                pair = pair * change
            else
                half = half + argument_of(pair)
                pair = change
            end if
            if (sure .and. is_bent) then
                sure = keeps_off(here(1:4:3), there(1:4:3), here(2:3), bend) &
                       .and. keeps_off(here(2:3), there(2:3), here(1:4:3), bend)
            end if
            here = there
        end do
        half = half + argument_of(pair)
        angle = [half(1) + half(2), angle(2), half(1) - half(2)]
        ! At a pole one half angle does not exist; it starts anew.
        if (all(is_zero(q_last(1:4:3))) .or. all(is_zero(q_last(2:3)))) then
            angle = angles_from_quaternion(q, angle)
        end if
    end subroutine follow_angles

    !> Changes of (phi + psi)/2 and (phi - psi)/2 between two attitudes, as complex numbers whose arguments they are, each by less
    !> than half a turn; zero where the half angle does not exist.
    pure function half_angle_change(p, q) result(change)
        real(dp), intent(in) :: p(4), q(4)
        complex(dp) :: change(2)
        change(1) = cmplx(q(1) * p(1) + q(4) * p(4), q(4) * p(1) - q(1) * p(4), dp)
        change(2) = cmplx(q(2) * p(2) + q(3) * p(3), q(3) * p(2) - q(2) * p(3), dp)
    end function half_angle_change

    !> Argument of a complex number, rad; zero of zero.
    elemental real(dp) function argument_of(z)
        complex(dp), intent(in) :: z
        argument_of = 0
        if (abs(z%re) + abs(z%im) > 0) argument_of = atan2(z%im, z%re)
    end function argument_of

    !> Whether the axis is so close to a pole at one of two attitudes, or moves so far in between, that it may pass
    !> the pole or circle about it, or whether it is beside one. Each part of a quaternion moves at half the angular
    !> velocity; twice that is admitted.
    pure logical function may_meet_pole(q_last, omega_last, q, omega, h)
        real(dp), intent(in) :: q_last(4), omega_last(3), q(4), omega(3), h
            !! quaternion and angular velocity in body axes, rad/s, at the beginning; the same at the end;
            !! time, s
        real(dp) :: reach, least
        reach = max(h**2 * max(sum(omega_last**2), sum(omega**2)), beside_pole**2) * max(sum(q_last**2), sum(q**2))
        least = min(q_last(1)**2 + q_last(4)**2, q_last(2)**2 + q_last(3)**2, q(1)**2 + q(4)**2, q(2)**2 + q(3)**2)
        may_meet_pole = .not. least > reach
    end function may_meet_pole

    !> Whether a part of the quaternion, the point whose argument is a half angle, stays clear of zero on its way
    !> between two places. With a constant angular velocity the way is less than a quarter of an ellipse about zero,
    !> on the far side of the chord. Accelerations bend it: those across body z by `bend(1)`/16 of the other part,
    !> those about it by `bend(2)`/16 of this part; twice that is admitted. A part that is zero in the
    !> first place has no argument there.
    pure logical function keeps_off(from, to, other, bend)
        real(dp), intent(in) :: from(2), to(2), other(2), bend(2)
        real(dp), parameter :: admitted = 0.125_dp
        real(dp) :: along, squares(2), bent
        squares = [sum(from**2), sum(to**2)]
        along = dot_product(from, to)
        bent = admitted * (bend(1) * sqrt(sum(other**2)) + bend(2) * sqrt(squares(1)))
        if (along < minval(squares)) then
            ! The point of the chord that is closest to zero lies between its ends.
            keeps_off = abs(from(1) * to(2) - from(2) * to(1)) > bent * sqrt(sum((to - from)**2))
        else
            keeps_off = sqrt(minval(squares)) > bent
        end if
        keeps_off = keeps_off .or. is_zero(squares(1))
    end function keeps_off

    !> Unit quaternion of the rotation about a vector by the norm of the vector, rad.
    pure function turn_by(vector) result(q)
        real(dp), intent(in) :: vector(3)
        real(dp) :: q(4)
        q = rotation_minus_one(vector)
        q(1) = q(1) + 1
    end function turn_by

    !> The same quaternion minus 1. Its product with an attitude is the change of the attitude.
    pure function rotation_minus_one(vector) result(q)
        real(dp), intent(in) :: vector(3) !! rotation vector, rad
        real(dp) :: q(4), sinc, drop
        call half_turn(sum((vector / 2)**2), sinc, drop)
        q = [drop, vector * (sinc / 2)]
    end function rotation_minus_one

    !> The value nearest to `near` among `angle` + 2 pi n, rad.
    elemental real(dp) function nearest_turn(angle, near)
        real(dp), intent(in) :: angle, near !! angles, rad
        nearest_turn = real(near + least_turn(real(angle, xp) - near), dp)
    end function nearest_turn

    !> The value nearest to zero among `angle` + 2 pi n, rad.
    elemental real(xp) function least_turn(angle)
        real(xp), intent(in) :: angle
        least_turn = angle
        if (.not. abs(angle) < pi_xp) least_turn = angle - 2 * pi_xp * anint(angle / (2 * pi_xp))
    end function least_turn

    !> Angular velocity in body axes from the rates of the angles, rad/s.
    pure function omega_from_rates(angle, rate) result(omega)
        real(dp), intent(in) :: angle(3), rate(3) !! phi, theta, psi, rad, and their rates, rad/s
        real(dp) :: omega(3)
        omega = omega_from_circular(circular_of_attitude(angle), rate)
    end function omega_from_rates

    !> The same from the sines and cosines, for many rates at one attitude.
    pure function omega_from_circular(circular, rate) result(omega)
        type(attitude_circular_t), intent(in) :: circular !! of the attitude
        real(dp), intent(in) :: rate(3) !! rates of phi, theta, psi, rad/s
        real(dp) :: omega(3)
        associate (c => circular)
            omega(1) = rate(1) * c%sine_theta * c%sine_psi + rate(2) * c%cosine_psi
            omega(2) = rate(1) * c%sine_theta * c%cosine_psi - rate(2) * c%sine_psi
            omega(3) = rate(1) * c%cosine_theta + rate(3)
        end associate
    end function omega_from_circular

    !> Sines and cosines of an attitude.
    pure type(attitude_circular_t) function circular_of_attitude(angle) result(circular)
        real(dp), intent(in) :: angle(3) !! phi, theta, psi, rad
        circular = attitude_circular_t(sin(angle(2)), cos(angle(2)), sin(angle(3)), cos(angle(3)))
    end function circular_of_attitude

    !> Rates of the angles from an angular velocity in body axes, rad/s. Not finite at a pole, where phi and
    !> psi do not exist separately.
    pure function rates_from_omega(angle, omega) result(rate)
        real(dp), intent(in) :: angle(3), omega(3) !! phi, theta, psi, rad, and angular velocity in body axes, rad/s
        real(dp) :: rate(3)
        rate(1) = (omega(1) * sin(angle(3)) + omega(2) * cos(angle(3))) / sin(angle(2))
        rate(2) = omega(1) * cos(angle(3)) - omega(2) * sin(angle(3))
        rate(3) = omega(3) - rate(1) * cos(angle(2))
    end function rates_from_omega

    !> Time derivative of the body angular velocity, rad/s^2, from the second derivatives of phi
    !> and theta and from that of omega3 (Eq 51).
    pure function omega_rate_from_accelerations(angle, rate, phi_acceleration, &
                                                theta_acceleration, omega3_rate) result(omega_rate)
        real(dp), intent(in) :: angle(3), rate(3) !! phi, theta, psi, rad, and their rates, rad/s
        real(dp), intent(in) :: phi_acceleration, theta_acceleration, omega3_rate !! rad/s^2
        real(dp) :: omega_rate(3)
        real(dp) :: along, across
        ! Components along the line of nodes and across it, both before the rotation by psi.
        along = theta_acceleration + rate(1) * rate(3) * sin(angle(2))
        across = phi_acceleration * sin(angle(2)) + rate(1) * rate(2) * cos(angle(2)) &
                 - rate(2) * rate(3)
        omega_rate(1) = across * sin(angle(3)) + along * cos(angle(3))
        omega_rate(2) = across * cos(angle(3)) - along * sin(angle(3))
        omega_rate(3) = omega3_rate
    end function omega_rate_from_accelerations

    !> Product p q of two quaternions: the rotation q followed by the rotation p.
    pure function quaternion_product(p, q) result(r)
        real(dp), intent(in) :: p(4), q(4) !! quaternions, scalar part first
        real(dp) :: r(4)
        r(1) = p(1) * q(1) - p(2) * q(2) - p(3) * q(3) - p(4) * q(4)
        r(2) = p(1) * q(2) + p(2) * q(1) + p(3) * q(4) - p(4) * q(3)
        r(3) = p(1) * q(3) - p(2) * q(4) + p(3) * q(1) + p(4) * q(2)
        r(4) = p(1) * q(4) + p(2) * q(3) - p(3) * q(2) + p(4) * q(1)
    end function quaternion_product

    !> Conjugate: the inverse rotation of a unit quaternion.
    pure function conjugate_quaternion(q) result(r)
        real(dp), intent(in) :: q(4) !! quaternion, scalar part first
        real(dp) :: r(4)
        r = [q(1), -q(2), -q(3), -q(4)]
    end function conjugate_quaternion

    !> Transforms a vector from body axes to space axes.
    pure function to_space(q, v) result(w)
        real(dp), intent(in) :: q(4), v(3) !! quaternion from body to space axes, and vector in body axes
        real(dp) :: w(3), r1, r2, r3, r4
        ! The product q (0, v) q* written out: with function calls it would take three times the time.
        r1 = -q(2) * v(1) - q(3) * v(2) - q(4) * v(3)
        r2 = q(1) * v(1) + q(3) * v(3) - q(4) * v(2)
        r3 = q(1) * v(2) - q(2) * v(3) + q(4) * v(1)
        r4 = q(1) * v(3) + q(2) * v(2) - q(3) * v(1)
        w(1) = -r1 * q(2) + r2 * q(1) - r3 * q(4) + r4 * q(3)
        w(2) = -r1 * q(3) + r2 * q(4) + r3 * q(1) - r4 * q(2)
        w(3) = -r1 * q(4) - r2 * q(3) + r3 * q(2) + r4 * q(1)
    end function to_space

    !> Square of the distance of body z from the nearer pole, rad^2, where that is small.
    pure real(dp) function square_to_pole(q) result(square)
        real(dp), intent(in) :: q(4) !! quaternion of any norm, scalar part first
        square = 4 * min(sum(q(1:4:3)**2), sum(q(2:3)**2)) / sum(q**2)
    end function square_to_pole

    !> Upward vertical in body axes, "Gamma".
    pure function vertical_from_quaternion(q) result(gamma)
        real(dp), intent(in) :: q(4) !! quaternion, scalar part first
        real(dp) :: gamma(3)
        gamma(1) = 2 * (q(2) * q(4) - q(1) * q(3))
        gamma(2) = 2 * (q(3) * q(4) + q(1) * q(2))
        gamma(3) = (q(1)**2 + q(4)**2) - (q(2)**2 + q(3)**2)
    end function vertical_from_quaternion

    !> Rotation angle between two attitudes, rad, in [0, pi]; exact to rounding for small turns.
    pure real(dp) function rotation_angle(p, q)
        real(dp), intent(in) :: p(4), q(4) !! unit quaternions, scalar part first
        real(dp) :: r(4)
        r = quaternion_product(conjugate_quaternion(p), q)
        rotation_angle = 2 * atan2(norm2(r(2:4)), abs(r(1)))
    end function rotation_angle

    !> Sine and cosine of half a rotation angle, as splitting methods need them, from the square of the angle x: `sinc` =
    !> sin(x)/x and `drop` = cos(x) - 1 without cancellation.
    pure subroutine half_turn(square, sinc, drop)
        real(dp), intent(in) :: square !! square of the angle x, rad^2
        real(dp), intent(out) :: sinc, drop !! sin(x)/x and cos(x) - 1
        real(dp) :: x, x4, x8

        if (square > largest_square) then
            x = sqrt(square)
            sinc = sin(x) / x
            drop = -2 * sin(x / 2)**2
        else
            ! In the order of Estrin: half the latency of Horner's.
            x4 = square**2
            x8 = x4**2
            sinc = ((1 + s1 * square) + (s2 + s3 * square) * x4) &
                   + x8 * (((s4 + s5 * square) + (s6 + s7 * square) * x4) + x8 * (s8 + s9 * square))
            drop = square * (((c1 + c2 * square) + (c3 + c4 * square) * x4) &
                + x8 * (((c5 + c6 * square) + (c7 + c8 * square) * x4) + x8 * c9))
        end if
    end subroutine half_turn

end module spintop_attitude
