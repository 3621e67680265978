!> The exact solution of many undamped symmetric tops together, in double precision.
!>
!> The cases are processed in strips by the stages of `exact_strip`: the solution in circular
!> functions (`circular_form`), up to k^2 = 0.99, in loops that the compiler vectorizes. A case that these
!> loops may not compute to `block_accuracy` is computed by the scalar routine, which works in extended
!> precision and in all forms. The result of a case has the same bits at every position in a block and for all
!> neighbours.
!>
!>     block%n = 2;  block%theta(1:2) = ...
!>     call block%compute(wants_end=.true., wants_period=.false.)
!>     if (is_ok(block%status(1))) then; ... = block%theta_max(1)
module spintop_exact_block
    use spintop_kinds, only: dp, pi, is_finite
    use spintop_circular_functions, only: find_circular, find_inclinations
    use spintop_body, only: body_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t, motion_from_angles
    use spintop_quantities, only: kinetic_energy, potential_energy
    use spintop_exact_strip, only: strip_t, strip_length, largest_nome, place_pole, find_roots, find_roots_of_moving, find_moduli, &
        find_nome, find_start_phases, find_phases
    use spintop_pole_passages, only: through_pole
    use spintop_status, only: is_ok, status_bad_input, status_non_finite, status_ok
    implicit none
    private
    public :: exact_block_t, block_size, block_accuracy

    !> Largest error of a quantity, relative or in radians, whichever is larger, in addition to the effect of
    !> a change of all rates (or of the time) by four rounding errors.
    real(dp), parameter :: block_accuracy = 5.0e-13_dp

    !> Smallest ratio of b - a (b + a), the closeness of the axis to a pole, to the terms whose difference it
    !> is.
    real(dp), parameter :: least_difference = 1.0e-2_dp

    !> Maximum number of cases.
    integer, parameter :: block_size = 512

    !> Cases to be computed together, one per element of each array, SI units and radians. A thread keeps one block, sets `n`
    !> and the data, and calls `compute`.
    type :: exact_block_t
        !> Number of cases, up to `block_size`.
        integer :: n = 0
        !> Data: moments of inertia about the pivot (kg m^2), m g l (N m), inclination (rad), rates of phi and
        !> theta (rad/s), angular velocity about the body axis (rad/s), phi and psi (rad), end of the span
        !> (s), and a time for which phi is needed (s).
        real(dp), dimension(block_size) :: inertia1, inertia3, mgl, theta, phi_rate, theta_rate, &
            omega3, phi, psi, t_end, t_period
        !> Turning angles (rad), cos(theta_max), and cos(theta_min) - cos(theta_max) without cancellation.
        real(dp), dimension(block_size) :: theta_min, theta_max, u_min, delta_u
        !> Nutation period (s), change of phi per nutation (rad), mean precession rate, and the value of phi'
        !> that is largest in magnitude (rad/s).
        real(dp), dimension(block_size) :: period, precession, precession_rate, phi_rate_max
        !> Angles (rad) and nutation rate (rad/s) at `t_end`, and the change of energy since the start,
        !> relative to the kinetic energy at the start plus m g l.
        real(dp), dimension(block_size) :: theta_end, phi_end, psi_end, theta_rate_end, energy_error
        !> Change of phi from the start to `t_period`, rad.
        real(dp), dimension(block_size) :: phi_at_period
        !> Status of each case: `status_ok`, a status of `prepare_exact_motion`, or `status_non_finite` if a
        !> result is not finite. The period and the change of phi per period may be infinite (on the
        !> separatrix, and for an axis at rest).
        integer, dimension(block_size) :: status = status_ok
        !> Number of cases that were computed by the scalar routine.
        integer :: fallbacks = 0
    contains
        procedure :: compute
    end type exact_block_t

contains

    !> Computes all cases of the block: the quantities of a whole nutation; with `wants_end` the motion at
    !> `t_end`; with `wants_period` phi at `t_period`. If `n` is not a possible number of cases, nothing is
    !> computed and every status is `status_bad_input`.
    subroutine compute(self, wants_end, wants_period)
        class(exact_block_t), intent(inout) :: self
        logical, intent(in) :: wants_end, wants_period !! whether the motion at `t_end` and phi at `t_period` are needed
        type(strip_t) :: strip
        integer :: first, last, i
        logical :: moves, is_end

        self%fallbacks = 0
        if (self%n < 0 .or. self%n > block_size) then
            self%status = status_bad_input
            return
        end if
        call fill_last_strip(self)
        do first = 1, self%n, strip_length
            last = first + strip_length - 1
            call describe_start(self, first, strip)
            call find_roots(strip)
            moves = count(strip%g0 > 0) > 0 ! unlike any(), a loop that is vectorized
            if (moves) call find_roots_of_moving(strip)
            call find_moduli(strip)
            call find_nome(strip)
            call place_pole(strip%q, strip%bottom, strip%doubt)
            call place_pole(strip%q, strip%top, strip%doubt)
            call describe_nutation(self, first, strip)
            call find_turning_angles(self, first, strip, moves)
            if (wants_end .or. wants_period) then
                call find_start_phases(strip, self%theta_rate(first:last), moves)
            end if
            if (wants_end) then
                call find_phases(strip, self%t_end(first:last))
                call describe_end(self, first, strip)
            end if
            if (wants_period) then
                is_end = wants_end .and. count(abs(self%t_period(first:last) &
                                                   - self%t_end(first:last)) <= 0) == strip_length
                if (.not. is_end) call find_phases(strip, self%t_period(first:last))
                call describe_period(self, first, strip)
            end if

            self%status(first:last) = status_ok
            if (count(strip%doubt > 0) == 0) cycle
            do i = first, min(last, self%n)
                if (strip%doubt(i - first + 1) > 0) then
                    call compute_alone(self, i, wants_end, wants_period)
                end if
            end do
        end do
    end subroutine compute

    !> Fills the last strip with copies of the last case.
    subroutine fill_last_strip(self)
        class(exact_block_t), intent(inout) :: self
        integer :: last, n
        n = self%n
        if (n < 1) return
        last = (n + strip_length - 1) / strip_length * strip_length
        self%inertia1(n + 1:last) = self%inertia1(n)
        self%inertia3(n + 1:last) = self%inertia3(n)
        self%mgl(n + 1:last) = self%mgl(n)
        self%theta(n + 1:last) = self%theta(n)
        self%phi_rate(n + 1:last) = self%phi_rate(n)
        self%theta_rate(n + 1:last) = self%theta_rate(n)
        self%omega3(n + 1:last) = self%omega3(n)
        self%phi(n + 1:last) = self%phi(n)
        self%psi(n + 1:last) = self%psi(n)
        self%t_end(n + 1:last) = self%t_end(n)
        self%t_period(n + 1:last) = self%t_period(n)
    end subroutine fill_last_strip

    !> Start and constants of the motion, and the coefficients of the cubic.
    subroutine describe_start(block, first, strip)
        class(exact_block_t), intent(in) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        real(dp), dimension(strip_length) :: half, sine2, cosine2, sine
        real(dp) :: per_inertia, u0, s2
        integer :: i, j

        half = block%theta(first:first + strip_length - 1) / 2
        call find_circular(strip_length, half, sine2, cosine2, sine)
        !$omp simd private(per_inertia, u0, s2, j)
        do i = 1, strip_length
            j = first - 1 + i
            associate (inertia1 => block%inertia1(j), inertia3 => block%inertia3(j), &
                       mgl => block%mgl(j), theta => block%theta(j), omega3 => block%omega3(j), &
                       phi_rate => block%phi_rate(j), theta_rate => block%theta_rate(j), &
                       a => strip%a(i), beta => strip%beta(i), sh => strip%sh(i), &
                       ch => strip%ch(i), turn => strip%turn(i), k0 => strip%k0(i), &
                       b_minus_a => strip%b_minus_a(i), b_plus_a => strip%b_plus_a(i))
                per_inertia = 1 / inertia1
                a = inertia3 * omega3 * per_inertia
                beta = 2 * mgl * per_inertia
                sh = 2 * sine2(i)
                ch = 2 * cosine2(i)
                u0 = cosine2(i) - sine2(i)
                s2 = sh * ch
                turn = s2 * phi_rate
                k0 = theta_rate**2 + turn * phi_rate
                b_minus_a = sh * (ch * phi_rate - a)
                b_plus_a = ch * (sh * phi_rate + a)
                strip%g0(i) = s2 * theta_rate**2
                strip%g1(i) = s2 * (2 * phi_rate * (a - u0 * phi_rate) - beta) &
                              - 2 * u0 * theta_rate**2
                strip%g2(i) = 2 * beta * u0 - k0 - a**2
                strip%doubt(i) = merge(0.0_dp, 1.0_dp, &
                    inertia1 > 0 .and. inertia3 >= 0 .and. mgl >= 0 .and. &
                    theta > 0 .and. theta < pi .and. &
                    abs(b_minus_a) > least_difference * (abs(turn) + sh * abs(a)) .and. &
                    abs(b_plus_a) > least_difference * (abs(turn) + ch * abs(a)))
            end associate
        end do
    end subroutine describe_start

    !> Mean rates, and the quantities of a whole nutation.
    subroutine describe_nutation(block, first, strip)
        class(exact_block_t), intent(inout) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        real(dp) :: q, theta3, theta2, per_all, per_bottom, per_top, per_theta3, per_theta2, per_passing
        real(dp) :: upper_speed, lower_speed, per_both, top_turn, bottom_turn, top_rate, bottom_rate, root_mp
        logical :: fast
        integer :: i, j

        !$omp simd private(q, theta3, theta2, per_all, per_bottom, per_top, per_theta3, per_theta2, &
        !$omp per_passing, upper_speed, lower_speed, per_both, top_turn, bottom_turn, top_rate, &
        !$omp bottom_rate, root_mp, fast, j)
        do i = 1, strip_length
            j = first - 1 + i
            associate (a => strip%a(i), turn => strip%turn(i), kc => strip%kc(i), y1 => strip%y1(i), &
                       y2 => strip%y2(i), m1 => strip%m1(i), d2 => strip%d2(i), p1 => strip%p1(i), &
                       p2 => strip%p2(i), per_m1 => strip%per_m1(i), per_p2 => strip%per_p2(i), &
                       b_minus_a => strip%b_minus_a(i), b_plus_a => strip%b_plus_a(i), zeta => strip%zeta(i), &
                       phi_speed => strip%phi_speed(i), bottom => strip%bottom, top => strip%top)
                q = strip%q(i)
                theta3 = theta3_of(q)
                theta2 = theta2_of(q)
                ! A fast top precesses slowly, and its two speeds nearly cancel.
                fast = d2 > m1 / 4
                per_passing = merge(top%nearest(i), 1.0_dp, fast)
                per_all = 1 / (bottom%farthest(i) * top%farthest(i) * per_passing &
                               * theta3**2 * theta2)
                per_theta2 = per_all * bottom%farthest(i) * top%farthest(i) * per_passing &
                             * theta3**2
                per_theta3 = per_all * bottom%farthest(i) * top%farthest(i) * per_passing * theta2
                per_all = per_all * theta3**2 * theta2
                per_bottom = per_all * top%farthest(i) * per_passing
                per_top = per_all * bottom%farthest(i) * per_passing
                per_passing = per_all * bottom%farthest(i) * top%farthest(i)
                per_both = 1 / (d2 * p1)

                zeta = strip%root_bu(i) / 2 * per_theta3
                upper_speed = b_plus_a / 2 * per_p2 &
                    + bottom%side(i) * zeta * bottom%slope_farthest(i) * per_bottom
                lower_speed = b_minus_a / 2 * per_m1 &
                    + top%side(i) * zeta * top%slope_farthest(i) * per_top
                phi_speed = upper_speed + lower_speed
                phi_speed = merge((turn - a * y2) * per_p2 * p1 * per_both + zeta &
                    * (bottom%side(i) * bottom%slope_farthest(i) * per_bottom &
                       - top%side(i) * top%slope_nearest(i) * per_passing), phi_speed, fast)
                strip%psi_speed(i) = (block%omega3(j) - a) + (upper_speed - lower_speed)

                bottom%weight(i) = p2 * per_bottom**2
                top%weight(i) = m1 * kc * per_top**2
                strip%swing(i) = strip%d(i) * strip%root_bu(i) * kc * strip%root_kc(i) * per_theta2

                ! b - a u at the turning points, in the form that cancels least.
                top_turn = merge(turn - a * y2, b_minus_a + a * d2, &
                    abs(turn) + abs(a * y2) <= abs(b_minus_a) + abs(a) * d2)
                bottom_turn = merge(turn - a * y1, b_plus_a - a * p1, &
                    abs(turn) + abs(a * y1) <= abs(b_plus_a) + abs(a) * p1)
                top_rate = top_turn * per_p2 * p1 * per_both
                bottom_rate = bottom_turn * per_m1 * d2 * per_both

                root_mp = sqrt(m1 * p2)
                strip%sine_min(i) = strip%root_md(i) * root_mp * per_m1
                strip%cosine_min(i) = (p2 - d2) / 2
                strip%sine_max(i) = abs(b_plus_a) * strip%root_b1(i) * strip%per_b1(i) &
                                    * root_mp * per_p2
                block%u_min(j) = (p1 - m1) / 2
                block%delta_u(j) = strip%d(i)
                block%period(j) = 2 * pi * theta3**2 * strip%root_bu(i) * strip%per_bu(i)
                block%precession(j) = phi_speed * block%period(j)
                block%precession_rate(j) = phi_speed
                block%phi_rate_max(j) = merge(top_rate, bottom_rate, &
                                              abs(top_rate) > abs(bottom_rate))
                ! Passages through a pole are counted one by one. The comparison is also false for NaN and infinity.
                strip%doubt(i) = merge(strip%doubt(i), 1.0_dp, q <= largest_nome .and. &
                    min(strip%sine_min(i), strip%sine_max(i)) > through_pole .and. &
                    abs(strip%sine_min(i) + strip%sine_max(i) + block%delta_u(j) &
                        + block%period(j) + block%precession(j) + block%phi_rate_max(j) &
                        + strip%psi_speed(i)) <= huge(q))
            end associate
        end do
    end subroutine describe_nutation

    !> The theta constant theta_3 of a nome, in double precision up to `largest_nome`.
    pure real(dp) function theta3_of(q)
        real(dp), value :: q
        real(dp) :: q4, q12
        q4 = (q**2)**2
        q12 = (q**2 * q4)**2
        theta3_of = 1 + 2 * (q + q4 + q4**2 * q + q4**4 + q12**2 * q)
    end function theta3_of

    !> The theta constant theta_2 of a nome over 2 q^(1/4), in double precision up to `largest_nome`.
    pure real(dp) function theta2_of(q)
        real(dp), value :: q
        real(dp) :: q2, q6, q12
        q2 = q**2
        q6 = q2 * q2**2
        q12 = q6**2
        theta2_of = 1 + q2 + q6 + q12 + q12 * q6 * q2
    end function theta2_of

    !> Turning angles. If the start is at one of them, only the other is computed.
    subroutine find_turning_angles(block, first, strip, moves)
        class(exact_block_t), intent(inout) :: block
        integer, intent(in) :: first
        type(strip_t), intent(in) :: strip
        logical, intent(in) :: moves  !! whether some start is not at a turning point
        real(dp), dimension(strip_length) :: sine, cosine, angle, other
        integer :: i, j
        !$omp simd private(j)
        do i = 1, strip_length
            j = first - 1 + i
            other(i) = max(strip%g0(i), -strip%y1(i))
            sine(i) = merge(strip%sine_max(i), strip%sine_min(i), other(i) > 0)
            cosine(i) = merge(block%u_min(j), strip%cosine_min(i), other(i) > 0)
        end do
        call find_inclinations(strip_length, sine, cosine, angle)
        other = block%theta(first:first + strip_length - 1)
        if (moves) then
            call find_inclinations(strip_length, strip%sine_min, strip%cosine_min, sine)
            other = merge(sine, other, strip%g0 > 0)
        end if
        !$omp simd private(j)
        do i = 1, strip_length
            j = first - 1 + i
            block%theta_min(j) = min(angle(i), other(i))
            block%theta_max(j) = max(angle(i), other(i))
        end do
    end subroutine find_turning_angles

    !> The motion at the end of the span.
    subroutine describe_end(block, first, strip)
        class(exact_block_t), intent(inout) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        real(dp), dimension(strip_length) :: sine, cosine
        real(dp) :: plus, minus, root, per_all, q2, q6, v, series, turn, y, theta_rate
        integer :: i, j
        !$omp simd private(plus, minus, root, per_all, q2, q6, v, series, turn, y, theta_rate, j)
        do i = 1, strip_length
            j = first - 1 + i
            associate (bottom => strip%bottom, top => strip%top, a => strip%a(i), &
                       beta => strip%beta(i), k0 => strip%k0(i), speed => strip%psi_speed(i))
                ! 1 + u and 1 - u, but for a common factor: their sum is 2.
                plus = bottom%weight(i) * (bottom%re(i)**2 + bottom%im(i)**2)
                minus = top%weight(i) * (top%re(i)**2 + top%im(i)**2)
                root = sqrt(plus * minus)
                per_all = 1 / ((plus + minus) * root)
                sine(i) = 2 * plus * minus * per_all
                cosine(i) = (plus - minus) * root * per_all

                ! u' is a theta function of twice the argument, over theta_4(z)^4.
                q2 = strip%q(i)**2
                q6 = q2**3
                v = 4 * (strip%cosine2(i) - strip%sine2(i))**2
                series = 1 - q2 * (v - 1) + q6 * (v * (v - 3) + 1) &
                    - q6**2 * (v * (v * (v - 5) + 6) - 1) &
                    + q6**3 * q2 * (v * (v * (v * (v - 7) + 15) - 10) + 1)
                theta_rate = -strip%swing(i) * series * strip%sine_of_2z(i) * per_all

                ! phi' sin(theta)^2 from the nearer pole; phi' sin(theta) is this over the sine.
                turn = merge(strip%b_minus_a(i) + a * (2 * minus * root * per_all), &
                             strip%b_plus_a(i) - a * (2 * plus * root * per_all), cosine(i) > 0)
                y = merge(strip%sh(i) - 2 * minus * root * per_all, &
                          2 * plus * root * per_all - strip%ch(i), cosine(i) > 0)
                block%energy_error(j) = abs(theta_rate**2 - k0 + beta * y &
                    + (turn * (plus + minus)**2 * per_all / 2)**2) &
                    / (k0 + a * block%omega3(j) + beta)
                block%theta_rate_end(j) = theta_rate
                block%phi_end(j) = block%phi(j) + (strip%phi_speed(i) * block%t_end(j) &
                    + (strip%phi_now(i) - strip%phi_start(i)))
                block%psi_end(j) = block%psi(j) + (speed * block%t_end(j) &
                    + (strip%psi_now(i) - strip%psi_start(i)))
                ! The comparison is also false for infinity and NaN.
                strip%doubt(i) = merge(strip%doubt(i), 1.0_dp, &
                    abs(sine(i) + theta_rate + block%energy_error(j) &
                        + block%phi_end(j) + block%psi_end(j)) <= huge(y))
            end associate
        end do
        call find_inclinations(strip_length, sine, cosine, block%theta_end(first:first + strip_length - 1))
    end subroutine describe_end

    !> phi after the other time.
    subroutine describe_period(block, first, strip)
        class(exact_block_t), intent(inout) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        integer :: i, j
        !$omp simd private(j)
        do i = 1, strip_length
            j = first - 1 + i
            block%phi_at_period(j) = strip%phi_speed(i) * block%t_period(j) &
                + (strip%phi_now(i) - strip%phi_start(i))
            strip%doubt(i) = merge(strip%doubt(i), 1.0_dp, &
                                   abs(block%phi_at_period(j)) <= huge(0.0_dp))
        end do
    end subroutine describe_period

    !> Computes case i by the scalar routine: the quantities of a whole nutation; with `wants_end` the motion
    !> at `t_end`; with `wants_period` phi at `t_period`.
    subroutine compute_alone(self, i, wants_end, wants_period)
        class(exact_block_t), intent(inout) :: self
        integer, intent(in) :: i
        logical, intent(in) :: wants_end, wants_period
        type(body_t) :: body
        type(motion_t) :: start, motion
        type(exact_motion_t) :: exact
        real(dp) :: energy, total

        self%fallbacks = self%fallbacks + 1
        body%inertia = [self%inertia1(i), self%inertia1(i), self%inertia3(i)]
        body%gravity = self%mgl(i)
        body%centre_of_mass(3) = 1
        start = motion_from_angles(0.0_dp, [self%phi(i), self%theta(i), self%psi(i)], &
            [self%phi_rate(i), self%theta_rate(i), &
             self%omega3(i) - self%phi_rate(i) * cos(self%theta(i))])
        call prepare_exact_motion(body, start, exact, self%status(i))
        if (.not. is_ok(self%status(i))) return

        associate (nutation => exact%nutation)
            self%theta_min(i) = nutation%theta_min
            self%theta_max(i) = nutation%theta_max
            self%u_min(i) = cos(nutation%theta_max)
            self%delta_u(i) = nutation%delta_u
            self%period(i) = nutation%period
            self%precession(i) = nutation%precession
            self%precession_rate(i) = nutation%precession_rate
            self%phi_rate_max(i) = nutation%phi_rate_max
        end associate
        if (wants_end) then
            motion = exact%at(self%t_end(i))
            self%phi_end(i) = motion%angle(1)
            self%theta_end(i) = motion%angle(2)
            self%psi_end(i) = motion%angle(3)
            self%theta_rate_end(i) = motion%rate(2)
            energy = kinetic_energy(body, start) + potential_energy(body, start)
            self%energy_error(i) = abs(kinetic_energy(body, motion) &
                + potential_energy(body, motion) - energy)
            if (self%energy_error(i) > 0) self%energy_error(i) = self%energy_error(i) &
                / (kinetic_energy(body, start) + self%mgl(i))
        end if
        if (wants_period) then
            motion = exact%at(self%t_period(i))
            self%phi_at_period(i) = motion%angle(1) - self%phi(i)
        end if
        ! Only the period, and the change of phi per period, may be infinite.
        total = self%theta_min(i) + self%theta_max(i) + self%precession_rate(i) &
                + self%phi_rate_max(i)
        if (wants_end) total = total + self%theta_end(i) + self%phi_end(i) + self%psi_end(i) &
                               + self%theta_rate_end(i) + self%energy_error(i)
        if (wants_period) total = total + self%phi_at_period(i)
        if (.not. is_finite(total)) self%status(i) = status_non_finite
    end subroutine compute_alone

end module spintop_exact_block
