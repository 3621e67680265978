!> Steady motion of a symmetric top: precession at a constant inclination and spin, and the sleeping top,
!> which is upright and spins about the vertical. And the paper's formulas for a fast top that is released at rest, which
!> are approximations (Eqs 29-32 and 54): they hold where (I3 omega3)^2 is much greater than 2 I1 mgl; the paper's own
!> criterion, I3 omega3^2/2 much greater than 2 mgl (Eqs 28, 53), lacks the factor I3/I1.
!>
!> Permanent rotations of a heavy rigid body about the vertical (O. Staude, Ueber permanente Rotationsaxen bei der
!> Bewegung eines schweren Koerpers um einen festen Punkt, J. reine angew. Math. 113, 1894).
!>
!> A body rotates for ever about an axis that is vertical, omega = s Gamma, if s^2 I Gamma - m g r is along Gamma. Then
!> (I - p) Gamma = (m g/s^2) r with a number p: to every p belong one axis and one rate,
!>
!>     u = (I - p)^-1 r,   Gamma = u/|u|,   s^2 = m g |u|.
!>
!> For p from -infinity to infinity the axes are the directed half of Staude's cone Gamma . (I Gamma x r) = 0 about which
!> the body can rotate: from rest upright, over the principal axes p = I_k, where the rate is infinite, to rest hanging.
module spintop_steady_motion
    use spintop_kinds, only: dp, pi, no_number, is_finite, is_zero, cross
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_effects, only: braking_effects
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_bad_input, status_non_finite, status_ok, status_unsuitable
    use spintop_validity, only: plain_body_status
    implicit none
    private
    public :: steady_rates, steady_rates_at_spin, critical_omega3, sleeps_slowly, fast_top_t, fast_top
    public :: find_permanent_rotation, permanent_rate

    !> Tolerance of Staude's cone, relative to the terms that balance each other: ten digits suffice.
    real(dp), parameter :: slack = 1.0e-10_dp

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

    !> The permanent rotation of an undamped body with a parameter p of the cone: the vertical in body axes, and the rate.
    !> `status_unsuitable`: there is no weight torque, or the body is damped or not in principal axes;
    !> `status_bad_input`: p is not finite, or is the moment of inertia of a principal axis.
    pure subroutine find_permanent_rotation(body, parameter, vertical, rate, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: parameter !! p, kg m^2
        real(dp), intent(out) :: vertical(3), rate !! unit vector in body axes; s > 0, rad/s; -s is another rotation
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: solution(3), moment(3)

        vertical = no_number
        rate = no_number
        call check_body(body, status)
        if (is_ok(status) .and. .not. is_finite(parameter)) status = status_bad_input
        if (.not. is_ok(status)) return
        moment = body%weight_moment()
        solution = 0
        where (abs(moment) > 0) solution = moment / (body%inertia - parameter)
        if (.not. all(is_finite(solution)) .or. .not. norm2(solution) > 0) then
            status = status_bad_input
            return
        end if
        vertical = solution / norm2(solution)
        rate = sqrt(norm2(solution))
    end subroutine find_permanent_rotation

    !> The rate of the permanent rotation about an axis that is vertical, rad/s; 0 where the body rests upright or hanging.
    !> `status_unsuitable`: the axis is not on the cone, or its other direction has to be up, or any rate will do (a
    !> principal axis through the centre of mass), or as in `find_permanent_rotation`; `status_bad_input`: the axis is no
    !> vector of finite length.
    pure subroutine permanent_rate(body, axis, rate, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: axis(3) !! of any length, in body axes; its direction is up
        real(dp), intent(out) :: rate !! s >= 0, rad/s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: vertical(3), inertial(3), weight(3), square

        rate = no_number
        call check_body(body, status)
        if (.not. is_ok(status)) return
        status = status_bad_input
        if (.not. all(is_finite(axis)) .or. .not. norm2(axis) > 0) return
        vertical = axis / norm2(axis)
        ! s^2 (I Gamma x Gamma) = m g (r x Gamma)
        inertial = cross(body%inertia * vertical, vertical)
        weight = cross(body%weight_moment(), vertical)
        status = status_unsuitable
        if (norm2(weight) <= slack * norm2(body%weight_moment())) then
            if (norm2(inertial) <= slack * maxval(body%inertia)) return
            rate = 0
            status = status_ok
            return
        end if
        if (norm2(inertial) <= slack * maxval(body%inertia)) return
        square = dot_product(inertial, weight) / sum(inertial**2)
        if (norm2(square * inertial - weight) > slack * norm2(weight) .or. .not. square > 0) return
        rate = sqrt(square)
        status = status_ok
    end subroutine permanent_rate

    !> Whether there are such rotations.
    pure subroutine check_body(body, status)
        type(body_t), intent(in) :: body
        integer, intent(out) :: status
        status = plain_body_status(body)
        if (.not. is_ok(status)) return
        if (.not. (norm2(body%weight_moment()) > 0 .and. all(is_zero(body%damping)))) status = status_unsuitable
    end subroutine check_body

end module spintop_steady_motion
