!> Steady motion of a symmetric top: precession at a constant inclination and spin, and the sleeping top,
!> which is upright and spins about the vertical. And the paper's formulas for a fast top that is released at rest, which
!> are approximations (Eqs 29-32 and 54): they hold where (I3 omega3)^2 is much greater than 2 I1 mgl; the paper's own
!> criterion, I3 omega3^2/2 much greater than 2 mgl (Eqs 28, 53), lacks the factor I3/I1.
module spintop_steady_motion
    use spintop_kinds, only: dp, no_number, pi
    use spintop_compare, only: is_finite, is_zero
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_effects, only: braking_effects
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_non_finite, status_unsuitable
    use spintop_validity, only: plain_body_status
    implicit none
    private
    public :: steady_rates, steady_rates_at_spin, critical_omega3, sleeps_slowly, fast_top_t, fast_top

    !> Approximate motion of a fast top; infinite or zero where a divisor vanishes.
    type :: fast_top_t
        !> Range of cos(theta), Eq 29.
        real(dp) :: delta_u
        !> Nutation frequency, rad/s, Eq 30.
        real(dp) :: nutation_rate
        !> Mean precession rate, rad/s, Eq 32.
        real(dp) :: precession_rate
        !> Nutations in a full turn of precession, Eq 54.
        real(dp) :: nutations_per_turn
        !> Time of a full turn at the mean precession rate, s ("T_p").
        real(dp) :: precession_period
        !> (I3 omega3)^2/(2 I1 mgl): large for a fast top.
        real(dp) :: ratio
        !> I3 omega3^2/(4 mgl): the paper's measure.
        real(dp) :: ratio_of_paper
    end type fast_top_t

contains

    !> Rates of steady precession at an inclination for a given axial angular velocity, rad/s: the roots of I1
    !> cos(theta) p^2 - I3 omega3 p + mgl = 0, slow one first (Eq 25). `count` is their number: 0 below the
    !> smallest possible omega3, 1 where the fast one is infinite. `status` is `status_ok`, the status of a
    !> body that is not valid, `status_unsuitable` (not an undamped symmetric top) or `status_non_finite`; the
    !> rates are then NaN and `count` is 0.
    pure subroutine steady_rates(body, theta, omega3, rates, count, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: theta, omega3 !! rad, rad/s
        real(dp), intent(out) :: rates(2) !! precession rates, rad/s, slow one first
        integer, intent(out) :: count !! number of rates
        integer, intent(out), optional :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call precession_roots(body%inertia(1) * cos(theta), body%inertia(3) * omega3, &
                              body%mgl(), rates, count)
        call check(body, [theta, omega3], rates, count, status)
    end subroutine steady_rates

    !> The same for a given spin rate psi', where omega3 = psi' + p cos(theta).
    pure subroutine steady_rates_at_spin(body, theta, spin_rate, rates, count, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: theta, spin_rate !! rad, rad/s
        real(dp), intent(out) :: rates(2) !! precession rates, rad/s, slow one first
        integer, intent(out) :: count !! number of rates
        integer, intent(out), optional :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call precession_roots((body%inertia(1) - body%inertia(3)) * cos(theta), &
                              body%inertia(3) * spin_rate, body%mgl(), rates, count)
        call check(body, [theta, spin_rate], rates, count, status)
    end subroutine steady_rates_at_spin

    !> Sets the rates to NaN if the body is not such a top, the data are not finite, or a rate overflows.
    pure subroutine check(body, data, rates, count, status)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: data(2)
        real(dp), intent(inout) :: rates(2)
        integer, intent(inout) :: count
        integer, intent(out), optional :: status
        integer :: found
        found = plain_body_status(body)
        if (is_ok(found) .and. .not. body%is_lagrange()) found = status_unsuitable
        if (is_ok(found) .and. .not. all(is_finite([data, rates]))) found = status_non_finite
        if (.not. is_ok(found)) then
            rates = no_number
            count = 0
        end if
        if (present(status)) status = found
    end subroutine check

    !> Threshold spin of the sleeping top: the least omega3 at which an upright symmetric top is stable,
    !> sqrt(4 mgl I1)/I3, rad/s. Upright is the centre of mass, on whichever side of the pivot body z has it.
    pure real(dp) function critical_omega3(body)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        critical_omega3 = 2 * sqrt(abs(body%mgl()) * body%inertia(1)) / body%inertia(3)
    end function critical_omega3

    !> Whether a top is exactly upright, its centre of mass above the pivot, and spins about the vertical with less than the
    !> threshold: by the equations it stays so at any spin, also where effects only brake it.
    pure logical function sleeps_slowly(body, motion)
        type(body_t), intent(in) :: body !! mass properties and effects of the body
        type(motion_t), intent(in) :: motion !! the motion at an instant
        real(dp) :: gamma(3)
        gamma = vertical_from_quaternion(motion%quaternion)
        sleeps_slowly = body%is_symmetric() .and. body%mgl() * gamma(3) > 0 &
            .and. all(is_zero([gamma(1:2), motion%omega(1:2)]))
        if (.not. sleeps_slowly) return
        if (allocated(body%effects)) sleeps_slowly = body%effects%only(braking_effects)
        sleeps_slowly = sleeps_slowly .and. abs(motion%omega(3)) < critical_omega3(body)
    end function sleeps_slowly

    !> Roots of a p^2 - b p + c = 0 with c >= 0, without cancellation. The root that stays finite for a = 0
    !> comes first.
    pure subroutine precession_roots(a, b, c, roots, count)
        real(dp), intent(in) :: a, b, c
        real(dp), intent(out) :: roots(2)
        integer, intent(out) :: count
        real(dp) :: discriminant, larger

        roots = 0
        count = 0
        discriminant = b**2 - 4 * a * c
        if (discriminant < 0) return
        larger = b + sign(sqrt(discriminant), b)
        if (is_zero(larger)) return
        roots(1) = 2 * c / larger
        count = 1
        if (is_zero(a)) return
        roots(2) = larger / (2 * a)
        count = 2
    end subroutine precession_roots

    !> The formulas for a start at inclination `theta` with axial angular velocity `omega3`.
    elemental type(fast_top_t) function fast_top(body, theta, omega3) result(motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: theta, omega3 !! inclination at the start, rad; axial angular velocity, rad/s
        associate (mgl => body%mgl(), i1 => body%inertia(1), i3 => body%inertia(3))
            motion%delta_u = (i1 / i3) * (2 * mgl / (i3 * omega3**2)) * sin(theta)**2
            motion%nutation_rate = i3 * omega3 / i1
            motion%precession_rate = mgl / (i3 * omega3)
            motion%nutations_per_turn = (i3 * omega3)**2 / (i1 * mgl)
            motion%precession_period = 2 * pi * i3 * omega3 / mgl
            motion%ratio = (i3 * omega3)**2 / (2 * i1 * mgl)
            motion%ratio_of_paper = i3 * omega3**2 / (4 * mgl)
        end associate
    end function fast_top

end module spintop_steady_motion
