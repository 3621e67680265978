!> Quantities of a symmetric top's motion that do not depend on time: range of the nutation angle, period,
!> change of phi and psi per nutation, largest rates, and the class of the motion.
module spintop_nutation
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_positive_inf
    use spintop_kinds, only: dp, xp, pi, pi_xp, epsilon_dp, is_finite
    use spintop_status, only: is_ok, status_non_finite
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: in_pole, through_pole
    use spintop_theta_functions, only: quotient
    use spintop_turning_points, only: turning_points_t, find_checked_points
    use spintop_theta_motion, only: theta_motion_t, regime_resting
    implicit none
    private
    public :: nutation_t, find_nutation, describe_nutation, is_defined, whole_half_turns, class_name, class_names, class_meanings
    public :: class_loop, class_cusp, class_wave, class_steady, class_sleeping, class_hanging
    public :: class_separatrix, class_libration, class_circulation, class_upright, last_class

    !> Classes of motion. `class_meanings` has a phrase for each.
    integer, parameter :: class_loop = 1, class_cusp = 2, class_wave = 3, class_steady = 4, class_sleeping = 5, class_hanging = 6, &
        class_separatrix = 7, class_libration = 8, class_circulation = 9, class_upright = 10, last_class = 10

    !> Names of the classes in tables.
    character(*), parameter :: class_names(last_class) = [character(16) :: 'loop', 'cusp', 'wave', &
        'steady', 'sleeping', 'hanging', 'separatrix', 'libration', 'circulation', 'upright']

    !> A phrase that explains each.
    character(*), parameter :: class_meanings(last_class) = [character(80) :: &
        'the precession reverses in every nutation', &
        'the precession comes to rest at the upper turning angle', &
        'the precession keeps its direction', &
        'steady precession: the inclination is constant', &
        'the axis rests upright, and is stable there', &
        'the axis rests hanging', &
        'separatrix: the axis approaches the upright asymptotically', &
        'plane pendulum, oscillating', &
        'plane pendulum, rotating over the top', &
        'the axis rests upright, below the threshold of a sleeping top, and is unstable']

    !> The complete quantities of a motion, SI units and radians.
    type :: nutation_t
        !> One of the class constants.
        integer :: class = class_sleeping
        !> Whether the axis passes through theta = 0, pi (spintop_pole_passages).
        logical :: passes_top = .false., passes_bottom = .false.
        !> Turning angles.
        real(dp) :: theta_min = 0, theta_max = 0
        !> cos(theta_min) - cos(theta_max), without cancellation.
        real(dp) :: delta_u = 0
        !> Nutation period, s; infinite on the separatrix and for an unstable upright.
        real(dp) :: period = 0
        !> Change of phi and psi per nutation, rad. Half turns at an exact passage of a pole,
        !> where phi and psi jump, are left out.
        real(dp) :: precession = 0, spin = 0
        !> Mean rates of phi and psi, rad/s.
        real(dp) :: precession_rate = 0, spin_rate = 0
        !> The value of phi' that is largest in magnitude, rad/s.
        real(dp) :: phi_rate_max = 0
        !> Largest theta', rad/s.
        real(dp) :: theta_rate_max = 0
        !> Modulus squared k^2 of the elliptic functions and its complement 1 - k^2.
        real(dp) :: k_squared = 0, complement_squared = 1
    end type nutation_t

    !> Tolerance of the classification for rounding errors of the data, in units of their largest terms.
    real(xp), parameter :: data_rounding = 8 * epsilon_dp

contains

    !> Finds the complete quantities of a start. `status` as in `prepare_exact_motion`.
    pure subroutine find_nutation(body, start, nutation, status, rotor)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(nutation_t), intent(out) :: nutation !! quantities of the nutation
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(in), optional :: rotor !! constant momentum of a rotor about body z, kg m^2/s
        type(theta_motion_t) :: motion
        call find_checked_points(body, start, motion%turning_points_t, status, rotor)
        if (.not. is_ok(status)) return
        call motion%set_form()
        nutation = describe_nutation(motion)
        if (.not. is_defined(nutation)) status = status_non_finite
    end subroutine find_nutation

    !> Whether no quantity has overflowed. Only the period, and changes per period, may be infinite.
    pure logical function is_defined(nutation)
        type(nutation_t), intent(in) :: nutation !! quantities of the nutation
        is_defined = is_finite(nutation%theta_min + nutation%theta_max + nutation%delta_u) .and. &
            is_finite(nutation%precession_rate) .and. is_finite(nutation%phi_rate_max)
    end function is_defined

    !> Name of a class as it stands in tables; 'unknown' for a number that is not a class.
    pure function class_name(class) result(name)
        integer, intent(in) :: class !! one of the class constants
        character(:), allocatable :: name
        name = 'unknown'
        if (class >= 1 .and. class <= last_class) name = trim(class_names(class))
    end function class_name

    !> The complete quantities of a motion whose theta functions are set up.
    pure type(nutation_t) function describe_nutation(points) result(nutation)
        type(theta_motion_t), intent(in) :: points !! the motion
        real(xp) :: rate_at_top, rate_at_bottom

        nutation%class = class_of(points)
        nutation%passes_top = points%regime /= regime_resting .and. (reaches_top(points) .or. &
            (passes_through(points%roots%one_minus_u2, points%roots%one_minus_u1) &
             .and. points%beta * points%roots%one_minus_u2 <= points%roots%beta_u3_minus_1))
        nutation%passes_bottom = points%regime /= regime_resting .and. (reaches_bottom(points) &
            .or. passes_through(points%roots%one_plus_u1, points%roots%one_plus_u2))
        nutation%theta_min = inclination(points%roots%one_minus_u2, points%roots%one_plus_u2)
        nutation%theta_max = inclination(points%roots%one_minus_u1, points%roots%one_plus_u1)
        nutation%delta_u = real(points%roots%u2_minus_u1, dp)
        nutation%k_squared = real(points%roots%k_squared, dp)
        nutation%complement_squared = real(points%roots%complement_squared, dp)

        if (points%regime == regime_resting) then
            nutation%theta_min = inclination(points%one_minus_u, points%one_plus_u)
            nutation%theta_max = nutation%theta_min
            nutation%delta_u = 0
            nutation%spin_rate = real(points%omega3, dp)
            nutation%period = ieee_value(1.0_dp, ieee_positive_inf)
            ! Without nutation the period is that of infinitely small nutations, which an unstable upright has not.
            if (points%roots%frequency > 0 .and. .not. is_separatrix(points)) then
                nutation%period = real(pi_xp / points%roots%frequency, dp)
            end if
            nutation%spin = whole_turn(nutation%spin_rate, nutation%period)
            return
        end if

        call add_precession(points, nutation)
        rate_at_top = phi_rate_at_top(points)
        rate_at_bottom = phi_rate_at_bottom(points)
        nutation%phi_rate_max = real(merge(rate_at_top, rate_at_bottom, &
                                           abs(rate_at_top) > abs(rate_at_bottom)), dp)
        nutation%theta_rate_max = largest_theta_rate(points)
    end function describe_nutation

    !> Period, and the change of phi and psi per period.
    pure subroutine add_precession(points, nutation)
        type(theta_motion_t), intent(in) :: points
        type(nutation_t), intent(inout) :: nutation
        real(xp) :: spin_rate, precession, spin, period, top_jump, bottom_jump

        spin_rate = 2 * points%half() + points%clock%upper_rate - points%clock%lower_rate
        if (points%clock%period > 0) then
            period = points%clock%period / points%clock%rate
            precession = points%clock%sum_rate * period + points%clock%upper_step + points%clock%lower_step
            spin = spin_rate * period + points%clock%upper_step - points%clock%lower_step
            top_jump = 0
            bottom_jump = 0
            if (nutation%passes_top) top_jump = sign(pi_xp, points%b_minus_a)
            if (nutation%passes_bottom) bottom_jump = sign(pi_xp, points%b_plus_a)
            precession = precession - top_jump - bottom_jump
            spin = spin + top_jump - bottom_jump
            if (.not. abs(points%beta) > 0) precession = whole_half_turns(real(precession, dp))
            if (is_plane(points)) precession = 0
            if (is_plane(points) .and. .not. abs(points%omega3) > 0) spin = 0
            nutation%period = real(period, dp)
            nutation%precession = real(precession, dp)
            nutation%spin = real(spin, dp)
            nutation%precession_rate = real(precession / period, dp)
            nutation%spin_rate = real(spin / period, dp)
        else
            ! On the separatrix the mean rates are those at the upright, reached in the limit.
            nutation%period = ieee_value(1.0_dp, ieee_positive_inf)
            nutation%precession_rate = real(points%clock%sum_rate, dp)
            nutation%spin_rate = real(spin_rate, dp)
            nutation%precession = whole_turn(nutation%precession_rate, nutation%period)
            nutation%spin = whole_turn(nutation%spin_rate, nutation%period)
        end if
    end subroutine add_precession

    !> The precession per nutation of a free top, rad, without rounding errors. Its axis circles the momentum once: phi comes
    !> back, or has one turn, or half a turn where the axis passes a pole.
    elemental real(dp) function whole_half_turns(precession)
        real(dp), intent(in) :: precession !! the same with rounding errors
        whole_half_turns = pi * anint(precession / pi)
    end function whole_half_turns

    !> Rate times period; zero where the rate is zero and the period infinite.
    elemental real(dp) function whole_turn(rate, period)
        real(dp), intent(in) :: rate, period
        whole_turn = 0
        if (abs(rate) > 0) whole_turn = rate * period
    end function whole_turn

    !> The class of a motion. Classes that are limits (cusp, steady, separatrix) apply within the rounding
    !> error of data in double precision.
    pure integer function class_of(points) result(class)
        type(theta_motion_t), intent(in) :: points
        real(xp) :: rates(2)

        if (points%regime == regime_resting) then
            class = class_steady
            if (points%one_minus_u < 1 .and. .not. points%sine_squared > 0) class = merge(class_sleeping, class_upright, &
                                                                                          points%a**2 >= 2 * points%beta)
            if (points%one_minus_u > 1 .and. .not. points%sine_squared > 0) class = class_hanging
        else if (is_separatrix(points)) then
            class = class_separatrix
        else if (is_plane(points)) then
            class = merge(class_circulation, class_libration, &
                          points%roots%beta_u3_minus_1 > points%beta * points%roots%one_minus_u2)
        else if (is_steady(points)) then
            class = class_steady
        else if (is_cusp(points)) then
            class = class_cusp
        else
            rates = [phi_rate_at_top(points), phi_rate_at_bottom(points)]
            class = merge(class_wave, class_loop, all(rates > 0) .or. all(rates < 0))
        end if
    end function class_of

    !> Whether the motion stays in a vertical plane: a = b = 0.
    elemental logical function is_plane(points)
        class(turning_points_t), intent(in) :: points
        is_plane = .not. abs(points%b_minus_a) + abs(points%b_plus_a) > 0
    end function is_plane

    !> Whether the two upper roots coincide (at u = 1), within the rounding error of the data.
    elemental logical function is_separatrix(points)
        class(turning_points_t), intent(in) :: points
        associate (beta => points%beta)
            is_separatrix = points%roots%k_squared > 0.5_xp .and. &
                beta * points%roots%one_minus_u2 + points%roots%beta_u3_minus_1 <= data_rounding &
                * (points%swing_squared + points%a**2 + beta * (2 + abs(points%roots%y1)))
        end associate
    end function is_separatrix

    !> Whether the inclination is constant within the rounding error of the data: no torque about the line
    !> of nodes, and no rate.
    elemental logical function is_steady(points)
        class(turning_points_t), intent(in) :: points
        real(xp) :: terms
        associate (u0 => points%u, k0 => points%swing_squared, s2 => points%sine_squared)
            terms = 2 * abs(u0) * k0 + points%beta * s2 + 2 * abs(points%a * points%turn)
            is_steady = abs(points%cubic%g1) <= data_rounding * terms .and. &
                4 * points%roots%frequency * abs(points%u_rate) <= data_rounding * terms
        end associate
    end function is_steady

    !> Whether the precession vanishes at the upper turning angle, within the rounding error of the data.
    elemental logical function is_cusp(points)
        class(turning_points_t), intent(in) :: points
        is_cusp = .not. reaches_top(points) .and. abs(points%turn - points%a * points%roots%y2) &
            <= data_rounding * (abs(points%turn) + abs(points%a) * points%sine_squared)
    end function is_cusp

    !> Whether the axis passes through a pole, by the convention of `spintop_pole_passages`: its way is nearly straight and
    !> misses the pole by no more than `through_pole`.
    elemental logical function passes_through(nearest, farthest)
        real(xp), intent(in) :: nearest, farthest !! the least and the largest 1 - u for the pole u = 1, 1 + u for u = -1
        passes_through = 2 * nearest <= through_pole**2 .and. nearest * in_pole**2 <= farthest
    end function passes_through

    !> Whether the axis passes through theta = 0: b = a within the rounding error of the data, and u2 = 1 (not
    !> u3 = 1, which lies above a motion that turns earlier).
    elemental logical function reaches_top(points)
        class(turning_points_t), intent(in) :: points
        reaches_top = abs(points%b_minus_a) <= data_rounding &
            * (abs(points%turn) + points%one_minus_u * abs(points%a)) &
            .and. points%beta * points%roots%one_minus_u2 <= points%roots%beta_u3_minus_1
    end function reaches_top

    !> Whether the axis passes through theta = pi: b = -a within the rounding error of the data.
    elemental logical function reaches_bottom(points)
        class(turning_points_t), intent(in) :: points
        reaches_bottom = abs(points%b_plus_a) <= data_rounding &
            * (abs(points%turn) + points%one_plus_u * abs(points%a))
    end function reaches_bottom

    !> phi' at u2, rad/s; through theta = 0 its limit.
    elemental real(xp) function phi_rate_at_top(points) result(rate)
        class(turning_points_t), intent(in) :: points
        if (reaches_top(points)) then
            rate = quotient(points%a, points%roots%one_plus_u2)
        else
            rate = (points%turn - points%a * points%roots%y2) / (points%roots%one_minus_u2 * points%roots%one_plus_u2)
        end if
    end function phi_rate_at_top

    !> phi' at u1, rad/s; through theta = pi its limit.
    elemental real(xp) function phi_rate_at_bottom(points) result(rate)
        class(turning_points_t), intent(in) :: points
        if (reaches_bottom(points)) then
            rate = quotient(-points%a, points%roots%one_minus_u1)
        else
            rate = (points%turn - points%a * points%roots%y1) / (points%roots%one_minus_u1 * points%roots%one_plus_u1)
        end if
    end function phi_rate_at_bottom

    !> Largest theta', rad/s. With x = sn^2, D = 1-u2, p = 1+u1 and d = u2-u1, theta'^2 is
    !> proportional to x (1-x) (1 - k^2 x) / ((D + d (1-x)) (p + d x)), whose logarithm is concave:
    !> the numerator of its derivative has one zero in [0, 1]. Newton's method within a bracket, for that derivative divided by
    !> d^2 times x (1-x), which is bounded.
    pure real(dp) function largest_theta_rate(points) result(rate)
        class(turning_points_t), intent(in) :: points
        integer, parameter :: most_iterations = 60
        real(dp), parameter :: tolerance = 1e-9_dp  ! The rate depends on the square of its error.
        real(dp) :: d, d2, m1, p1, p2, k2, top, bottom, x, next, low, high, slope, value
        integer :: n

        rate = 0
        d = real(points%roots%u2_minus_u1, dp)
        if (.not. d > 0) return
        k2 = real(points%roots%k_squared, dp)
        m1 = real(points%roots%one_minus_u1, dp)
        d2 = real(points%roots%one_minus_u2, dp)
        p1 = real(points%roots%one_plus_u1, dp)
        p2 = real(points%roots%one_plus_u2, dp)
        low = epsilon_dp**2
        high = 1 - epsilon_dp
        x = 0.5_dp
        do n = 1, most_iterations
            top = d2 + d * (1 - x)
            bottom = p1 + d * x
            value = p1 / bottom * (1 - x) - d2 / top * x - k2 * x * (1 - x) / (1 - k2 * x)
            slope = -p1 * p2 / bottom**2 - d2 * m1 / top**2 - k2 * ((1 - x)**2 - (1 - k2) * x**2) / (1 - k2 * x)**2
            if (value > 0) low = x
            if (value <= 0) high = x
            next = x - value / slope
            if (.not. (next > low .and. next < high)) next = (low + high) / 2
            if (abs(next - x) <= tolerance * min(x, 1 - x)) exit
            x = next
        end do
        top = d2 + d * (1 - x)
        bottom = p1 + d * x
        ! The products are formed in pairs, which are regular where the motion passes a pole.
        rate = 2 * real(points%roots%frequency, dp) * d * sqrt((1 - k2 * x) * (x / bottom) * ((1 - x) / top))
    end function largest_theta_rate

    !> Inclination from 1 - u and 1 + u, rad.
    elemental real(dp) function inclination(one_minus_u, one_plus_u)
        real(xp), intent(in) :: one_minus_u, one_plus_u
        inclination = 2 * atan2(sqrt(real(one_minus_u, dp)), sqrt(real(one_plus_u, dp)))
    end function inclination

end module spintop_nutation
