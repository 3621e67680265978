!> The start of a symmetric top in quantities that stay regular at the poles.
!>
!> Symbols: u = cos(theta); a = I3 omega3 / I1; beta = 2 m g l / I1; b = Lz / I1; the attitude as
!> the two Cayley-Klein components (Klein and Sommerfeld, Ueber die Theorie des Kreisels, 1897)
!>
!>     upper = q0 + i q3 = cos(theta/2) exp(i (phi + psi)/2)
!>     lower = q1 + i q2 = sin(theta/2) exp(i (phi - psi)/2)
!>
!> which vanish at theta = pi and at theta = 0. With the transverse angular velocity swing = omega1 + i omega2 they obey
!>
!>     upper' = i omega3/2 upper - lower conj(swing)/2,   lower' = upper swing/2 - i omega3/2 lower
module spintop_regular_start
    use spintop_kinds, only: dp, xp, pi, is_finite
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_unsuitable
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: regular_start_t, find_regular_start, rates_describe

    !> The data of the closed form from body and start, in extended precision.
    type :: regular_start_t
        !> s
        real(xp) :: time = 0
        !> (I3 omega3 + h)/I1 with the momentum h of a rotor, 2 mgl/I1 and omega3: rad/s, rad^2/s^2, rad/s.
        real(xp) :: a = 0, beta = 0, omega3 = 0
        !> u, 1 - u, 1 + u and 1 - u^2, each to full relative precision.
        real(xp) :: u = 1, one_minus_u = 0, one_plus_u = 2, sine_squared = 0
        !> du/dt = -theta' sin(theta), rad/s.
        real(xp) :: u_rate = 0
        !> omega1^2 + omega2^2 = theta'^2 + (phi' sin(theta))^2, rad^2/s^2.
        real(xp) :: swing_squared = 0
        !> phi' sin(theta)^2 = b - a u, rad/s.
        real(xp) :: turn = 0
        !> b - a and b + a, rad/s: zero where theta = 0 and theta = pi can be reached.
        real(xp) :: b_minus_a = 0, b_plus_a = 0
        !> The Cayley-Klein components, and their rates without the spin that is linear in time
        !> (half = (omega3 - a)/2): upper' - i half upper and lower' + i half lower.
        complex(xp) :: upper = 1, lower = 0, upper_rate = 0, lower_rate = 0
        !> (phi + psi)/2 and (phi - psi)/2, rad, with all their turns.
        real(xp) :: upper_phase = 0, lower_phase = 0
        !> Whether the quaternion of the start has the opposite sign of the components (q and -q are the same
        !> attitude).
        logical :: turns_against_angles = .false.
    contains
        procedure :: half
    end type regular_start_t

    !> If the rates of phi and psi exceed the angular velocity by this factor, they cancel each other (the
    !> axis is close to a pole), and the angular velocity is more accurate.
    real(dp), parameter :: cancelling_ratio = 16

    complex(xp), parameter :: i = (0.0_xp, 1.0_xp)

contains

    !> Half the rate of the spin that is linear in time, (omega3 - a)/2, rad/s.
    elemental real(xp) function half(self)
        class(regular_start_t), intent(in) :: self
        half = (self%omega3 - self%a) / 2
    end function half

    !> Converts body and start. `status` is `status_unsuitable` for a body that is not an undamped symmetric
    !> top, and `status_non_finite` for data that are not finite.
    pure subroutine find_regular_start(body, start, regular, status, rotor)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(regular_start_t), intent(out) :: regular !! the start in regular quantities
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(in), optional :: rotor !! constant momentum of a rotor about body z, kg m^2/s
        complex(xp) :: swing
        real(xp) :: inertia

        status = status_ok
        if (.not. body%is_lagrange() .or. .not. body%inertia(1) > 0 &
            .or. body%inertia(3) < 0) status = status_unsuitable
        if (.not. all(is_finite([start%t, start%angle, start%omega, start%quaternion])) &
            .or. .not. norm2(start%quaternion) > 0 &
            .or. .not. all(is_finite([body%inertia, body%mgl()]))) status = status_non_finite
        if (.not. is_ok(status)) return

        if (rates_describe(start)) then
            call set_from_angles(start, regular, swing)
        else
            call set_from_quaternion(start, regular, swing)
        end if
        associate (q => start%quaternion)
            regular%turns_against_angles = real(conjg(regular%upper) * cmplx(q(1), q(4), xp) &
                                                + conjg(regular%lower) * cmplx(q(2), q(3), xp), xp) < 0
        end associate

        inertia = body%inertia(1)
        regular%time = start%t
        regular%a = body%inertia(3) / inertia * regular%omega3
        if (present(rotor)) regular%a = regular%a + rotor / inertia
        regular%beta = 2 * real(body%mass, xp) * body%gravity * body%centre_of_mass(3) / inertia
        regular%b_minus_a = regular%turn - regular%one_minus_u * regular%a
        regular%b_plus_a = regular%turn + regular%one_plus_u * regular%a
        associate (a => regular%a, upper => regular%upper, lower => regular%lower)
            regular%upper_rate = (i * a * upper - lower * conjg(swing)) / 2
            regular%lower_rate = (upper * swing - i * a * lower) / 2
        end associate
        regular%upper_phase = (real(start%angle(1), xp) + start%angle(3)) / 2
        regular%lower_phase = (real(start%angle(1), xp) - start%angle(3)) / 2
    end subroutine find_regular_start

    !> Whether angles and rates are the more accurate description of the start; else quaternion and omega are.
    pure logical function rates_describe(start)
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        rates_describe = start%angle(2) >= 0 .and. start%angle(2) <= pi &
            .and. all(is_finite(start%rate)) &
            .and. maxval(abs(start%rate)) <= cancelling_ratio * maxval(abs(start%omega)) &
            .and. .not. (start%gives_quaternion .and. start%gives_omega)
    end function rates_describe

    pure subroutine set_from_angles(start, regular, swing)
        type(motion_t), intent(in) :: start
        type(regular_start_t), intent(inout) :: regular
        !> omega1 + i omega2, rad/s.
        complex(xp), intent(out) :: swing
        real(xp) :: theta, sine, half_sine, half_cosine, phi_rate, theta_rate
        complex(xp) :: upper_turn, lower_turn

        theta = start%angle(2)
        phi_rate = start%rate(1)
        theta_rate = start%rate(2)
        half_sine = sin(theta / 2)
        half_cosine = cos(theta / 2)
        ! The double nearest to pi means pi exactly, not an inclination 1e-16 away from it.
        if (start%angle(2) >= pi) half_cosine = 0
        sine = 2 * half_sine * half_cosine

        regular%one_minus_u = 2 * half_sine**2
        regular%one_plus_u = 2 * half_cosine**2
        regular%u = (regular%one_plus_u - regular%one_minus_u) / 2
        regular%sine_squared = sine**2
        regular%omega3 = start%rate(3) + phi_rate * regular%u
        if (start%gives_omega3 .or. start%gives_omega) regular%omega3 = start%omega(3)
        regular%u_rate = -sine * theta_rate
        regular%swing_squared = theta_rate**2 + (sine * phi_rate)**2
        regular%turn = regular%sine_squared * phi_rate

        upper_turn = unit((real(start%angle(1), xp) + start%angle(3)) / 2)
        lower_turn = unit((real(start%angle(1), xp) - start%angle(3)) / 2)
        regular%upper = half_cosine * upper_turn
        regular%lower = half_sine * lower_turn
        swing = cmplx(theta_rate, phi_rate * sine, xp) * lower_turn * conjg(upper_turn)
    end subroutine set_from_angles

    pure subroutine set_from_quaternion(start, regular, swing)
        type(motion_t), intent(in) :: start
        type(regular_start_t), intent(inout) :: regular
        !> omega1 + i omega2, rad/s.
        complex(xp), intent(out) :: swing
        complex(xp) :: along
        real(xp) :: q(4), length

        q = start%quaternion
        length = sqrt(sum(q**2))
        regular%upper = cmplx(q(1), q(4), xp) / length
        regular%lower = cmplx(q(2), q(3), xp) / length
        if (opposes_angles(start)) then
            regular%upper = -regular%upper
            regular%lower = -regular%lower
        end if
        swing = cmplx(start%omega(1), start%omega(2), xp)

        regular%one_minus_u = 2 * squared(regular%lower)
        regular%one_plus_u = 2 * squared(regular%upper)
        regular%u = (regular%one_plus_u - regular%one_minus_u) / 2
        regular%sine_squared = regular%one_minus_u * regular%one_plus_u
        regular%omega3 = start%omega(3)
        regular%swing_squared = squared(swing)
        ! The transverse angular velocity relative to the vertical in body axes, Gamma1 + i Gamma2.
        along = conjg(2 * i * regular%lower * conjg(regular%upper)) * swing
        regular%turn = real(along, xp)
        regular%u_rate = aimag(along)
    end subroutine set_from_quaternion

    !> Whether the quaternion has the sign opposite to that of the angles (q and -q are one
    !> attitude).
    pure logical function opposes_angles(start)
        type(motion_t), intent(in) :: start
        associate (q => start%quaternion, plus => (start%angle(1) + start%angle(3)) / 2, &
                   minus => (start%angle(1) - start%angle(3)) / 2)
            if (hypot(q(1), q(4)) > hypot(q(2), q(3))) then
                opposes_angles = q(1) * cos(plus) + q(4) * sin(plus) < 0
            else
                opposes_angles = q(2) * cos(minus) + q(3) * sin(minus) < 0
            end if
        end associate
    end function opposes_angles

    !> exp(i angle); the intrinsic function of a complex number takes longer.
    elemental complex(xp) function unit(angle)
        real(xp), intent(in) :: angle
        unit = cmplx(cos(angle), sin(angle), xp)
    end function unit

    elemental real(xp) function squared(z)
        complex(xp), intent(in) :: z
        squared = real(z, xp)**2 + aimag(z)**2
    end function squared

end module spintop_regular_start
