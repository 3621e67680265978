!> The exact motion of many symmetric tops without damping at once, in double precision.
!>
!> The closed solution in circular functions (see `circular_form`, its symbols and those of
!> `turning_points`) as stages, each a loop over lanes that becomes vector instructions: neither
!> branches nor calls inside, few divisions and square roots. With terms up to the fifth multiple of
!> the argument the series serve up to k^2 = 0.99. A case that the stages cannot give to
!> `block_accuracy` goes to the scalar routine, which works in extended precision and in all forms.
!>
!> A case has the same bits wherever it stands in a block and whatever its neighbours are.
!>
!> Sources: Klein and Sommerfeld, Ueber die Theorie des Kreisels, chapter VI; Whittaker and Watson,
!> A Course of Modern Analysis, chapters XXI and XXII.
module spintop_exact_block
    use spintop_kinds, only: dp, pi
    use spintop_array_functions, only: find_circular, find_inclinations, find_arguments, &
        largest_angle
    use spintop_body, only: body_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t, motion_from_angles
    use spintop_quantities, only: kinetic_energy, potential_energy
    use spintop_status, only: status_ok, status_non_finite
    implicit none
    private
    public :: exact_block_t, block_size, block_accuracy

    !> Cases in a block.
    integer, parameter :: block_size = 512
    !> Largest error of a quantity, relative or in radians, whichever is larger, besides the
    !> rounding of long phases: a few epsilon times the angle turned.
    real(dp), parameter :: block_accuracy = 5.0e-13_dp

    !> Lanes that go through the stages together: their intermediate results fit the first cache.
    integer, parameter :: lanes = 64
    !> Largest nome for which the series below are complete, to 3e-14.
    real(dp), parameter :: largest_nome = 0.27_dp
    !> Least part that b - a (b + a) may keep of the terms it is the difference of. It tells how
    !> close the axis comes to a pole.
    real(dp), parameter :: least_difference = 1.0e-2_dp
    !> Least square of a theta function, relative to its largest: around its zero, a pole of the
    !> sphere, phi and psi turn fast.
    real(dp), parameter :: least_theta = 1.0e-5_dp
    !> Steps of Laguerre's method to the highest root, and the largest last one, relative to it.
    integer, parameter :: laguerre_steps = 4
    real(dp), parameter :: largest_last_step = 1.0e-6_dp
    !> Least k'^2 of a motion whose roots come from Laguerre's method: the upper two close up.
    real(dp), parameter :: least_gap = 0.03_dp
    !> Steps of Newton's method to a pole's position, and the largest last one.
    real(dp), parameter :: largest_newton_step = 1.0e-7_dp

    !> Cases, one per element of each array, SI units and radians. A thread that has many cases
    !> keeps one block, sets `n` and the data, and calls `compute`.
    type :: exact_block_t
        !> Number of cases, up to `block_size`.
        integer :: n = 0
        !> Data: moments of inertia about the pivot (kg m^2), m g l (N m), inclination (rad), rates
        !> of phi and theta (rad/s), angular velocity about the body axis (rad/s), phi and psi
        !> (rad), end of the span (s), and a time at which phi is wanted (s).
        real(dp), dimension(block_size) :: inertia1, inertia3, mgl, theta, phi_rate, theta_rate, &
            omega3, phi, psi, t_end, t_period
        !> Turning angles (rad), cos(theta_max), and cos(theta_min) - cos(theta_max) without
        !> cancellation.
        real(dp), dimension(block_size) :: theta_min, theta_max, u_min, delta_u
        !> Nutation period (s), what it adds to phi (rad), mean precession rate, and the value of
        !> phi' largest in size (rad/s).
        real(dp), dimension(block_size) :: period, precession, precession_rate, phi_rate_max
        !> Angles (rad) and nutation rate (rad/s) at `t_end`, and by how much the energy of this
        !> motion differs from that of the start, relative to the start's kinetic energy plus m g l.
        real(dp), dimension(block_size) :: theta_end, phi_end, psi_end, theta_rate_end, energy_error
        !> phi at `t_period` less phi at the start, rad.
        real(dp), dimension(block_size) :: phi_at_period
        !> How each case ended: `status_ok`, or why `prepare_exact_motion` refused it; its results
        !> then mean nothing.
        integer, dimension(block_size) :: status = status_ok
        !> Cases that went to the scalar routine.
        integer :: fallbacks = 0
    contains
        procedure :: compute
        procedure, private :: fill_last_strip
        procedure, private :: compute_alone
    end type exact_block_t

    !> One pole of the sphere, seen by the motion: its theta function
    !>
    !>     Theta = nearest + 2 h even(c) + i side odd(c) sin 2z
    !>
    !> with polynomials `even` and `odd` in c; c = cos 2z and h = sin(z)^2 for theta = pi,
    !> c = -cos 2z and h = cos(z)^2 for theta = 0. Written from its least value for digits close to
    !> the pole.
    type :: pole_t
        !> What its position X follows from ("eps"), X, A/B of X, and sqrt(k') rho.
        real(dp), dimension(lanes) :: excess, position, ratio, scale
        !> Theta where the axis is farthest ("S") and nearest, the latter at first relative to S.
        real(dp), dimension(lanes) :: farthest, nearest
        !> The derivatives of both ("D S" and "D' S'").
        real(dp), dimension(lanes) :: slope_farthest, slope_nearest
        real(dp), dimension(lanes, 0:4) :: even, odd
        !> Sign of the turn about the pole.
        real(dp), dimension(lanes) :: side
        !> Factor of |Theta|^2 in 1 + u or 1 - u, but for a common one.
        real(dp), dimension(lanes) :: weight
        !> Theta at an instant, and its argument.
        real(dp), dimension(lanes) :: re, im, argument
    end type pole_t

    !> A strip of cases on its way through the stages.
    type :: strip_t
        !> More than 0 for a case that the stages may not serve well.
        real(dp), dimension(lanes) :: doubt
        !> a, beta, 1 - u0, 1 + u0, phi0' sin(theta0)^2, K0, b - a, b + a.
        real(dp), dimension(lanes) :: a, beta, sh, ch, turn, k0, b_minus_a, b_plus_a
        !> Coefficients of the cubic in y = u - u0; its roots y1 and y2, their difference, and
        !> beta y3.
        real(dp), dimension(lanes) :: g0, g1, g2, y1, y2, d, beta_y3
        !> 1 - u1, 1 - u2, 1 + u1, 1 + u2 and two inverses; sqrt(beta (u3 - 1)),
        !> sqrt(m1 d2), sqrt(m1 p2), sqrt(beta (u3 - u1)), sqrt(beta (1 + u3)) and two inverses.
        real(dp), dimension(lanes) :: m1, d2, p1, p2, per_m1, per_p2
        real(dp), dimension(lanes) :: root_bd3, root_md, bu, root_bu, root_b1, per_bu, per_b1
        !> Moduli k^2, k', sqrt(k'), and the nome.
        real(dp), dimension(lanes) :: k2, kc, root_kc, q
        !> Sines and cosines of both turning angles.
        real(dp), dimension(lanes) :: sine_min, cosine_min, sine_max, cosine_max
        !> Argument at the start and its rate; mean rates of phi and psi.
        real(dp), dimension(lanes) :: z0, zeta, phi_speed, psi_speed
        !> arg Theta+ + arg Theta- and arg Theta+ - arg Theta- at the start.
        real(dp), dimension(lanes) :: phi_start, psi_start
        !> Factor of theta'.
        real(dp), dimension(lanes) :: swing
        type(pole_t) :: bottom, top
        !> At an instant: the argument, sin(z)^2, cos(z)^2, sin 2z, both sums as above.
        real(dp), dimension(lanes) :: z, sine2, cosine2, sine_of_2z, phi_now, psi_now
        real(dp), dimension(lanes) :: sine_now, cosine_now
    end type strip_t

contains

    !> Computes all cases of the block: the quantities of a whole nutation; with `wants_end` the
    !> motion at `t_end`; with `wants_period` phi at `t_period`.
    subroutine compute(self, wants_end, wants_period)
        class(exact_block_t), intent(inout) :: self
        logical, intent(in) :: wants_end, wants_period
        type(strip_t) :: strip
        integer :: first, i
        logical :: moves

        call self%fill_last_strip()
        self%fallbacks = 0
        do first = 1, self%n, lanes
            call describe_start(self, first, strip)
            call find_roots(strip)
            moves = any(strip%g0 > 0)
            if (moves) call find_roots_of_moving(strip)
            call find_moduli(strip)
            call find_nome(strip)
            call solve_position(strip%q, strip%bottom%excess, strip%bottom%position, strip%doubt)
            call solve_position(strip%q, strip%top%excess, strip%top%position, strip%doubt)
            call divide_thetas(strip%q, strip%bottom%position, strip%bottom%ratio)
            call divide_thetas(strip%q, strip%top%position, strip%top%ratio)
            call expand_pole(strip%q, strip%bottom)
            call expand_pole(strip%q, strip%top)
            call describe_nutation(self, first, strip)
            if (wants_end .or. wants_period) then
                if (moves) call find_start_argument(self, first, strip)
                call find_start_phases(strip, moves)
            end if
            if (wants_end) then
                call find_phases(strip, self%t_end(first:first + lanes - 1))
                call describe_end(self, first, strip)
            end if
            if (wants_period) then
                call find_phases(strip, self%t_period(first:first + lanes - 1))
                call describe_period(self, first, strip)
            end if
            self%status(first:first + lanes - 1) = status_ok
            if (.not. any(strip%doubt > 0)) cycle
            do i = first, min(first + lanes - 1, self%n)
                if (strip%doubt(i - first + 1) > 0) call self%compute_alone(i, wants_end, wants_period)
            end do
        end do
    end subroutine compute

    !> Fills the last strip with copies of the last case.
    subroutine fill_last_strip(self)
        class(exact_block_t), intent(inout) :: self
        integer :: last, n
        n = self%n
        if (n < 1) return
        last = (n + lanes - 1) / lanes * lanes
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
        real(dp), dimension(lanes) :: half, sine2, cosine2, sine
        real(dp) :: per_inertia, u0, s2
        integer :: i, j

        half = block%theta(first:first + lanes - 1) / 2
        call find_circular(lanes, half, sine2, cosine2, sine)
        !$omp simd private(per_inertia, u0, s2, j)
        do i = 1, lanes
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

    !> The roots for a start at a turning point: the cubic is y times a quadratic.
    subroutine find_roots(strip)
        type(strip_t), intent(inout) :: strip
        real(dp) :: half, per_half, other
        logical :: falls
        integer :: i
        !$omp simd private(half, per_half, other, falls)
        do i = 1, lanes
            associate (g1 => strip%g1(i), g2 => strip%g2(i), beta => strip%beta(i))
                half = (sqrt(max(g2**2 - 4 * beta * g1, 0.0_dp)) + abs(g2)) / 2
                falls = g2 <= 0
                ! One inverse serves both: 1/half, or 1/(half beta).
                per_half = 1 / merge(half, half * beta, falls)
                strip%beta_y3(i) = merge(half, -beta**2 * g1 * per_half, falls)
                other = merge(g1, -half**2, falls) * per_half
                strip%y1(i) = min(other, 0.0_dp)
                strip%y2(i) = max(other, 0.0_dp)
                strip%d(i) = abs(other)
                strip%z0(i) = merge(pi / 2, 0.0_dp, other < 0)
            end associate
        end do
    end subroutine find_roots

    !> The roots of the cases that start between turning points: the highest by Laguerre's method
    !> from that of the quadratic, which lies above it.
    subroutine find_roots_of_moving(strip)
        type(strip_t), intent(inout) :: strip
        real(dp) :: y, c0, c1, g, slope, curvature, step, per_y, product, total, d, larger, smaller
        logical :: moves
        integer :: i, n
        !$omp simd private(y, c0, c1, g, slope, curvature, step, per_y, product, total, d, larger, &
        !$omp smaller, moves)
        do i = 1, lanes
            associate (g0 => strip%g0(i), g1 => strip%g1(i), g2 => strip%g2(i), &
                       beta => strip%beta(i))
                c0 = beta**2 * g0
                c1 = beta * g1
                y = strip%beta_y3(i)
                step = 0
                do n = 1, laguerre_steps
                    g = c0 + y * (c1 + y * (g2 + y))
                    slope = c1 + y * (2 * g2 + y * 3)
                    curvature = 2 * g2 + 6 * y
                    step = 3 * g / (slope + sqrt(max(4 * slope**2 - 6 * g * curvature, 0.0_dp)))
                    y = y - step
                end do
                per_y = 1 / y
                product = -g0 * per_y
                total = (g1 - beta * product) * per_y
                d = sqrt(total**2 - 4 * product)
                larger = (total + sign(d, total)) / 2
                smaller = product / larger
                moves = g0 > 0
                strip%beta_y3(i) = merge(y, strip%beta_y3(i), moves)
                strip%y1(i) = merge(min(larger, smaller), strip%y1(i), moves)
                strip%y2(i) = merge(max(larger, smaller), strip%y2(i), moves)
                strip%d(i) = merge(d, strip%d(i), moves)
                strip%doubt(i) = merge(1.0_dp, strip%doubt(i), &
                    moves .and. (abs(step) > largest_last_step * y .or. &
                    y - beta * strip%y2(i) < least_gap * (y - beta * strip%y1(i))))
            end associate
        end do
    end subroutine find_roots_of_moving

    !> Distances of the roots, moduli, and the turning angles' sines and cosines.
    subroutine find_moduli(strip)
        type(strip_t), intent(inout) :: strip
        real(dp) :: bu, b1, bd3, larger, root, other_root, mp, bb, per_all, per_larger
        logical :: u3_farther
        integer :: i
        !$omp simd private(bu, b1, bd3, larger, root, other_root, mp, bb, per_all, per_larger, &
        !$omp u3_farther)
        do i = 1, lanes
            associate (beta => strip%beta(i), sh => strip%sh(i), ch => strip%ch(i), &
                       b_minus_a => strip%b_minus_a(i), b_plus_a => strip%b_plus_a(i), &
                       y1 => strip%y1(i), y2 => strip%y2(i), beta_y3 => strip%beta_y3(i), &
                       m1 => strip%m1(i), d2 => strip%d2(i), p1 => strip%p1(i), &
                       p2 => strip%p2(i), per_m1 => strip%per_m1(i), per_p2 => strip%per_p2(i), &
                       per_bu => strip%per_bu(i), per_b1 => strip%per_b1(i))
                m1 = sh - y1
                p2 = ch + y2
                bu = beta_y3 - beta * y1
                b1 = beta_y3 + beta * ch
                d2 = sh - y2
                bd3 = beta_y3 - beta * sh
                ! The larger of beta d2 and bd3 is exact; the other follows from f(1) = -(b-a)^2.
                u3_farther = bd3 > beta * d2
                larger = merge(bd3, m1 * d2, u3_farther)
                mp = m1 * p2
                bb = bu * b1
                per_all = 1 / (mp * bb * larger)
                per_larger = per_all * mp * bb
                per_all = per_all * larger
                per_m1 = per_all * bb * p2
                per_p2 = per_all * bb * m1
                per_bu = per_all * mp * b1
                per_b1 = per_all * mp * bu
                root = sqrt(larger)
                other_root = abs(b_minus_a) * root * per_larger
                strip%root_bd3(i) = merge(root, other_root, u3_farther)
                strip%root_md(i) = merge(other_root, root, u3_farther)
                bd3 = merge(bd3, other_root**2, u3_farther)
                d2 = merge(other_root**2 * per_m1, d2, u3_farther)
                p1 = b_plus_a**2 * per_p2 * per_b1

                strip%root_b1(i) = sqrt(b1)
                strip%k2(i) = beta * strip%d(i) * per_bu
                strip%kc(i) = sqrt((beta * d2 + bd3) * per_bu)
                strip%root_kc(i) = sqrt(strip%kc(i))
                strip%bu(i) = bu
            end associate
        end do
    end subroutine find_moduli

    !> Nome, and the data of both poles.
    subroutine find_nome(strip)
        type(strip_t), intent(inout) :: strip
        real(dp), parameter :: c(0:11) = [real(dp) :: 1, 2, 15, 150, 1707, 20910, 268616, 3567400, &
            48555069, 673458874, 9481557398.0_dp, 135119529972.0_dp]
        real(dp) :: plus_root, leading, t, series, root_bottom, root_top, sum_bottom, sum_top
        real(dp) :: factor, per_all, per_factor, per_sums
        integer :: i, n
        !$omp simd private(plus_root, leading, t, series, root_bottom, root_top, sum_bottom, &
        !$omp sum_top, factor, per_all, per_factor, per_sums)
        do i = 1, lanes
            associate (k2 => strip%k2(i), kc => strip%kc(i), root_kc => strip%root_kc(i), &
                       d => strip%d(i), m1 => strip%m1(i), d2 => strip%d2(i), &
                       p1 => strip%p1(i), p2 => strip%p2(i), q => strip%q(i), &
                       bottom => strip%bottom, top => strip%top)
                ! sqrt(k'/B1), sqrt(p1 p2 k') and sqrt(m1 d2 k').
                strip%root_bu(i) = sqrt(strip%bu(i))
                bottom%scale(i) = root_kc * strip%root_b1(i) * strip%per_b1(i)
                root_bottom = abs(strip%b_plus_a(i)) * bottom%scale(i)
                root_top = root_kc * strip%root_md(i)
                sum_bottom = p2 + p1 * kc + 2 * root_bottom
                sum_top = m1 * kc + d2 + 2 * root_top
                plus_root = (1 + root_kc)**2
                factor = (1 + kc) * plus_root

                per_all = 1 / (factor * kc * sum_bottom * sum_top)
                per_factor = per_all * kc * sum_bottom * sum_top
                per_sums = per_all * factor * kc

                leading = k2 / 2 * per_factor
                t = leading**4
                series = c(11)
                do n = 10, 0, -1
                    series = c(n) + t * series
                end do
                q = leading * series

                bottom%excess(i) = (d + p1 * k2 * plus_root * per_factor) * sum_top * per_sums
                top%excess(i) = d * (strip%root_bd3(i)**2 * strip%per_bu(i) + kc) &
                                * plus_root * per_factor * sum_bottom * per_sums
                bottom%scale(i) = bottom%scale(i) * strip%root_bu(i)
                top%scale(i) = root_kc * strip%root_bd3(i) * strip%root_bu(i) * strip%per_bu(i) &
                               * (per_all * factor * sum_bottom * sum_top)
                bottom%nearest(i) = root_bottom * strip%per_p2(i)
                top%nearest(i) = root_top * strip%per_m1(i) &
                                 * (per_all * factor * sum_bottom * sum_top)
                bottom%side(i) = sign(1.0_dp, strip%b_plus_a(i))
                top%side(i) = sign(1.0_dp, strip%b_minus_a(i))
            end associate
        end do
    end subroutine find_nome

    !> Solves sum_{n odd} q^(n^2-n) h_n = excess (1 + sum_{n even} q^(n^2-n) h_n) for X = h_1,
    !> h_n = 2 q^n cosh(2 n v): two steps of Newton's method, the second with a corrected inverse of
    !> the first one's slope.
    subroutine solve_position(q, excess, x, doubt)
        real(dp), intent(in) :: q(lanes), excess(lanes)
        real(dp), intent(out) :: x(lanes)
        real(dp), intent(inout) :: doubt(lanes)
        real(dp) :: q2, q4, q6, q12, q20, scale, r, y, y2, value, slope, per_slope
        integer :: i, n
        !$omp simd private(q2, q4, q6, q12, q20, scale, r, y, y2, value, slope, per_slope)
        do i = 1, lanes
            q2 = q(i)**2
            q4 = q2**2
            q6 = q2 * q4
            q12 = q6**2
            q20 = q12 * q4**2
            ! The quadratic X - excess (1 - 2 q^4 + q^2 X^2) = 0 by its series.
            scale = max(1 - 2 * q4, 0.2_dp)
            r = min(excess(i)**2 * q2 * scale, 0.2_dp)
            y = excess(i) * scale * (1 + r * (1 + r * (2 + r * (5 + r * (14 + r * 42)))))
            value = 0
            per_slope = 1
            do n = 1, 2
                y2 = y**2
                value = y * (1 + q6 * (y2 - 3 * q2) + q20 * (y2 * (y2 - 5 * q2) + 5 * q4)) &
                    - excess(i) * (1 + q2 * (y2 - 2 * q2) + q12 * (y2 * (y2 - 4 * q2) + 2 * q4))
                slope = 1 + 3 * q6 * (y2 - q2) + 5 * q20 * (y2 * (y2 - 3 * q2) + q4) &
                    - 2 * excess(i) * y * (q2 + 2 * q12 * (y2 - 2 * q2))
                if (n == 1) per_slope = 1 / slope
                if (n == 2) per_slope = per_slope * (2 - slope * per_slope)
                y = y - value * per_slope
            end do
            x(i) = y
            doubt(i) = merge(1.0_dp, doubt(i), abs(value) > largest_newton_step)
        end do
    end subroutine solve_position

    !> A/B with A = 1 + sum q^(n^2) a_n, a_1 = X - q, and B = 1 + sum (-1)^n q^(n^2) b_n,
    !> b_1 = X + q, both with x_(n+1) = X x_n - q^2 x_(n-1).
    subroutine divide_thetas(q, x, ratio)
        real(dp), intent(in) :: q(lanes), x(lanes)
        real(dp), intent(out) :: ratio(lanes)
        real(dp) :: q2, q4, q9, x2, a_odd, a_even, b_odd, b_even
        real(dp) :: a1, a2, a3, a4, b1, b2, b3, b4
        integer :: i
        !$omp simd private(q2, q4, q9, x2, a_odd, a_even, b_odd, b_even, a1, a2, a3, a4, b1, b2, b3, b4)
        do i = 1, lanes
            q2 = q(i)**2
            q4 = q2**2
            q9 = q4**2 * q(i)
            a1 = x(i) - q(i)
            b1 = x(i) + q(i)
            a2 = x(i) * a1 - q2
            b2 = x(i) * b1 - q2
            a3 = x(i) * a2 - q2 * a1
            b3 = x(i) * b2 - q2 * b1
            a4 = x(i) * a3 - q2 * a2
            b4 = x(i) * b3 - q2 * b2
            ratio(i) = (1 + q(i) * a1 + q4 * a2 + q9 * a3 + q4**4 * a4) &
                     / (1 - q(i) * b1 + q4 * b2 - q9 * b3 + q4**4 * b4)
        end do
    end subroutine divide_thetas

    !> The theta function of a pole from its position X.
    subroutine expand_pole(q, pole)
        real(dp), intent(in) :: q(lanes)
        type(pole_t), intent(inout) :: pole
        real(dp) :: q2, q6, q12, q20, x, x2, e1, e2, e3, e4, e5, o1, o2, o3, o4, o5
        integer :: i
        !$omp simd private(q2, q6, q12, q20, x, x2, e1, e2, e3, e4, e5, o1, o2, o3, o4, o5)
        do i = 1, lanes
            q2 = q(i)**2
            q6 = q2**3
            q12 = q6**2
            q20 = q12 * q6 * q2
            x = pole%position(i)
            ! W^n + V^n and W^n - V^n, of W + V = X; not sqrt(X^2 - 4 q^2), which loses digits.
            e1 = x
            e2 = x * e1 - 2 * q2
            e3 = x * e2 - q2 * e1
            e4 = x * e3 - q2 * e2
            e5 = x * e4 - q2 * e3
            o1 = (x + 2 * q(i)) * pole%scale(i) * pole%ratio(i)
            o2 = x * o1
            o3 = x * o2 - q2 * o1
            o4 = x * o3 - q2 * o2
            o5 = x * o4 - q2 * o3
            e2 = q2 * e2
            e3 = q6 * e3
            e4 = q12 * e4
            e5 = q20 * e5
            o2 = q2 * o2
            o3 = q6 * o3
            o4 = q12 * o4
            o5 = q20 * o5
            pole%farthest(i) = 1 + e1 + e2 + e3 + e4 + e5
            pole%nearest(i) = pole%nearest(i) * pole%farthest(i)
            pole%slope_farthest(i) = 2 * (o1 + 2 * o2 + 3 * o3 + 4 * o4 + 5 * o5)
            pole%slope_nearest(i) = 2 * (o1 - 2 * o2 + 3 * o3 - 4 * o4 + 5 * o5)
            ! sum (-1)^n e_n cos 2nz and sum (-1)^n o_n sin 2nz in powers of cos 2z.
            pole%even(i, 0) = e1 - 2 * e2 + e3 + e5
            pole%even(i, 1) = -2 * e2 + 4 * e3 - 4 * e5
            pole%even(i, 2) = 4 * e3 - 8 * e4 - 4 * e5
            pole%even(i, 3) = -8 * e4 + 16 * e5
            pole%even(i, 4) = 16 * e5
            pole%odd(i, 0) = o1 - o3 + o5
            pole%odd(i, 1) = -2 * o2 + 4 * o4
            pole%odd(i, 2) = 4 * o3 - 12 * o5
            pole%odd(i, 3) = -8 * o4
            pole%odd(i, 4) = 16 * o5
        end do
    end subroutine expand_pole

    !> Mean rates, and the quantities of a whole nutation.
    subroutine describe_nutation(block, first, strip)
        class(exact_block_t), intent(inout) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        real(dp) :: q, q2, q4, q6, q12, theta3, theta2, per_all, per_bottom, per_top, per_theta3
        real(dp) :: per_theta2, per_passing, upper_speed, lower_speed, per_both
        real(dp) :: top_turn, bottom_turn, top_rate, bottom_rate, root_mp
        logical :: fast
        integer :: i, j

        !$omp simd private(q, q2, q4, q6, q12, theta3, theta2, per_all, per_bottom, per_top, &
        !$omp per_theta3, per_theta2, per_passing, upper_speed, lower_speed, per_both, top_turn, &
        !$omp bottom_turn, top_rate, bottom_rate, root_mp, fast, j)
        do i = 1, lanes
            j = first - 1 + i
            associate (a => strip%a(i), turn => strip%turn(i), kc => strip%kc(i), &
                       y1 => strip%y1(i), y2 => strip%y2(i), &
                       m1 => strip%m1(i), d2 => strip%d2(i), p1 => strip%p1(i), &
                       p2 => strip%p2(i), per_m1 => strip%per_m1(i), per_p2 => strip%per_p2(i), &
                       b_minus_a => strip%b_minus_a(i), b_plus_a => strip%b_plus_a(i), &
                       zeta => strip%zeta(i), phi_speed => strip%phi_speed(i), &
                       bottom => strip%bottom, top => strip%top)
                q = strip%q(i)
                q2 = q**2
                q4 = q2**2
                q6 = q2 * q4
                q12 = q6**2
                theta3 = 1 + 2 * (q + q4 + q4**2 * q + q4**4 + q12**2 * q)
                theta2 = 1 + q2 + q6 + q12 + q12 * q6 * q2
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
                strip%swing(i) = 2 * strip%d(i) * (strip%root_bu(i) / 2) * kc * strip%root_kc(i) &
                                 * per_theta2

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
                strip%sine_max(i) = abs(b_plus_a) * strip%root_b1(i) * strip%per_b1(i) * root_mp * per_p2
                strip%cosine_max(i) = (p1 - m1) / 2
                block%u_min(j) = strip%cosine_max(i)
                block%delta_u(j) = strip%d(i)
                block%period(j) = 2 * pi * theta3**2 * strip%root_bu(i) * strip%per_bu(i)
                block%precession(j) = phi_speed * block%period(j)
                block%precession_rate(j) = phi_speed
                block%phi_rate_max(j) = merge(top_rate, bottom_rate, &
                                              abs(top_rate) > abs(bottom_rate))
                ! Comparisons that a NaN or an infinity fails, too.
                strip%doubt(i) = merge(strip%doubt(i), 1.0_dp, q <= largest_nome .and. &
                    abs(strip%sine_min(i) + strip%sine_max(i) + block%delta_u(j) &
                        + block%period(j) + block%precession(j) + block%phi_rate_max(j) &
                        + strip%psi_speed(i)) <= huge(q))
            end associate
        end do
        call find_inclinations(lanes, strip%sine_min, strip%cosine_min, &
                               block%theta_min(first:first + lanes - 1))
        call find_inclinations(lanes, strip%sine_max, strip%cosine_max, &
                               block%theta_max(first:first + lanes - 1))
    end subroutine describe_nutation

    !> The argument at the start of the cases that start between turning points: like a pole's
    !> position, with X = 2 q cos 2z.
    subroutine find_start_argument(block, first, strip)
        class(exact_block_t), intent(in) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        real(dp), dimension(lanes) :: excess, position, ratio, sine, cosine, angle
        real(dp) :: sn2, dn, per_plus, per_all
        integer :: i
        !$omp simd private(sn2, dn, per_plus, per_all)
        do i = 1, lanes
            associate (kc => strip%kc(i), k2 => strip%k2(i), d => strip%d(i))
                per_all = 1 / (d * (1 + kc))
                per_plus = per_all * d
                sn2 = -strip%y1(i) * per_all * (1 + kc)
                dn = sqrt(max(1 - k2 * sn2, 0.0_dp))
                excess(i) = merge(k2 * (per_plus - sn2) / (dn + strip%root_kc(i))**2, 0.0_dp, &
                                  strip%g0(i) > 0)
            end associate
        end do
        call solve_position(strip%q, excess, position, strip%doubt)
        call divide_thetas(strip%q, position, ratio)
        !$omp simd
        do i = 1, lanes
            sine(i) = strip%root_kc(i) * sqrt(-strip%y1(i)) * ratio(i)
            cosine(i) = sqrt(strip%y2(i))
        end do
        call find_arguments(lanes, cosine, sine, angle)
        !$omp simd
        do i = 1, lanes
            strip%z0(i) = merge(sign(angle(i), -block%theta_rate(first - 1 + i)), strip%z0(i), &
                                strip%g0(i) > 0)
        end do
    end subroutine find_start_argument

    !> Arguments of the theta functions at the start: none at a turning point.
    subroutine find_start_phases(strip, moves)
        type(strip_t), intent(inout) :: strip
        logical, intent(in) :: moves
        real(dp), parameter :: start(lanes) = 0
        strip%phi_start = 0
        strip%psi_start = 0
        if (.not. moves) return
        call find_phases(strip, start)
        strip%phi_start = merge(strip%phi_now, 0.0_dp, strip%g0 > 0)
        strip%psi_start = merge(strip%psi_now, 0.0_dp, strip%g0 > 0)
    end subroutine find_start_phases

    !> The theta functions of both poles at the given times.
    subroutine find_phases(strip, time)
        type(strip_t), intent(inout) :: strip
        real(dp), intent(in) :: time(lanes)
        integer :: i
        strip%z = strip%z0 + strip%zeta * time
        call find_circular(lanes, strip%z, strip%sine2, strip%cosine2, strip%sine_of_2z)
        call evaluate_pole(strip%bottom, strip%sine2, strip%cosine2, strip%sine_of_2z)
        call evaluate_pole(strip%top, strip%cosine2, strip%sine2, strip%sine_of_2z)
        call find_arguments(lanes, strip%bottom%re, strip%bottom%im, strip%bottom%argument)
        call find_arguments(lanes, strip%top%re, strip%top%im, strip%top%argument)
        !$omp simd
        do i = 1, lanes
            associate (bottom => strip%bottom, top => strip%top)
                strip%phi_now(i) = bottom%side(i) * bottom%argument(i) &
                                   - top%side(i) * top%argument(i)
                strip%psi_now(i) = bottom%side(i) * bottom%argument(i) &
                                   + top%side(i) * top%argument(i)
                strip%doubt(i) = merge(strip%doubt(i), 1.0_dp, &
                    abs(strip%z(i)) <= largest_angle .and. &
                    bottom%re(i)**2 + bottom%im(i)**2 > least_theta * bottom%farthest(i)**2 .and. &
                    top%re(i)**2 + top%im(i)**2 > least_theta * top%farthest(i)**2)
            end associate
        end do
    end subroutine find_phases

    !> Theta of a pole where `near` is sin(z)^2 or cos(z)^2 from it and `far` the other one.
    subroutine evaluate_pole(pole, near, far, sine_of_2z)
        type(pole_t), intent(inout) :: pole
        real(dp), intent(in) :: near(lanes), far(lanes), sine_of_2z(lanes)
        real(dp) :: c
        integer :: i
        !$omp simd private(c)
        do i = 1, lanes
            c = far(i) - near(i)
            pole%re(i) = pole%nearest(i) + 2 * near(i) * (pole%even(i, 0) + c * (pole%even(i, 1) &
                + c * (pole%even(i, 2) + c * (pole%even(i, 3) + c * pole%even(i, 4)))))
            pole%im(i) = sine_of_2z(i) * (pole%odd(i, 0) + c * (pole%odd(i, 1) &
                + c * (pole%odd(i, 2) + c * (pole%odd(i, 3) + c * pole%odd(i, 4)))))
        end do
    end subroutine evaluate_pole

    !> The motion at the end of the span.
    subroutine describe_end(block, first, strip)
        class(exact_block_t), intent(inout) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        real(dp) :: plus, minus, root, per_all, q2, q6, v, series, turn, y, theta_rate, sine_rate
        integer :: i, j
        !$omp simd private(plus, minus, root, per_all, q2, q6, v, series, turn, y, theta_rate, &
        !$omp sine_rate, j)
        do i = 1, lanes
            j = first - 1 + i
            associate (bottom => strip%bottom, top => strip%top, a => strip%a(i), &
                       sine => strip%sine_now(i), cosine => strip%cosine_now(i), &
                       beta => strip%beta(i), k0 => strip%k0(i))
                plus = bottom%weight(i) * (bottom%re(i)**2 + bottom%im(i)**2)
                minus = top%weight(i) * (top%re(i)**2 + top%im(i)**2)
                root = sqrt(plus * minus)
                per_all = 1 / ((plus + minus) * root)
                sine = 2 * plus * minus * per_all
                cosine = (plus - minus) * root * per_all

                ! u' is the theta function of twice the argument over theta_4(z)^4.
                q2 = strip%q(i)**2
                q6 = q2**3
                v = 4 * (strip%cosine2(i) - strip%sine2(i))**2
                series = 1 - q2 * (v - 1) + q6 * (v * (v - 3) + 1) &
                    - q6**2 * (v * (v * (v - 5) + 6) - 1) &
                    + q6**3 * q2 * (v * (v * (v * (v - 7) + 15) - 10) + 1)
                theta_rate = -strip%swing(i) * series * strip%sine_of_2z(i) * per_all

                plus = 2 * plus * root * per_all
                minus = 2 * minus * root * per_all
                turn = merge(strip%b_minus_a(i) + a * minus, strip%b_plus_a(i) - a * plus, &
                             cosine > 0)
                sine_rate = turn * (bottom%weight(i) * 0 + 1) / sine
                y = merge(strip%sh(i) - minus, plus - strip%ch(i), cosine > 0)
                block%theta_rate_end(j) = theta_rate
                block%energy_error(j) = abs(theta_rate**2 + sine_rate**2 - k0 + beta * y) &
                    / (k0 + a * block%omega3(j) + beta)
                block%phi_end(j) = block%phi(j) + (strip%phi_speed(i) * block%t_end(j) &
                    + (strip%phi_now(i) - strip%phi_start(i)))
                block%psi_end(j) = block%psi(j) + (strip%psi_speed(i) * block%t_end(j) &
                    + (strip%psi_now(i) - strip%psi_start(i)))
            end associate
        end do
        call find_inclinations(lanes, strip%sine_now, strip%cosine_now, &
                               block%theta_end(first:first + lanes - 1))
        !$omp simd private(j)
        do i = 1, lanes
            j = first - 1 + i
            strip%doubt(i) = merge(strip%doubt(i), 1.0_dp, &
                abs(block%theta_end(j) + block%theta_rate_end(j) + block%energy_error(j) &
                    + block%phi_end(j) + block%psi_end(j)) <= huge(0.0_dp))
        end do
    end subroutine describe_end

    !> phi after the other time.
    subroutine describe_period(block, first, strip)
        class(exact_block_t), intent(inout) :: block
        integer, intent(in) :: first
        type(strip_t), intent(inout) :: strip
        integer :: i, j
        !$omp simd private(j)
        do i = 1, lanes
            j = first - 1 + i
            block%phi_at_period(j) = strip%phi_speed(i) * block%t_period(j) &
                + (strip%phi_now(i) - strip%phi_start(i))
            strip%doubt(i) = merge(strip%doubt(i), 1.0_dp, &
                                   abs(block%phi_at_period(j)) <= huge(0.0_dp))
        end do
    end subroutine describe_period

    !> Computes case i by the scalar routine.
    subroutine compute_alone(self, i, wants_end, wants_period)
        class(exact_block_t), intent(inout) :: self
        integer, intent(in) :: i
        logical, intent(in) :: wants_end, wants_period
        type(body_t) :: body
        type(motion_t) :: start, motion
        type(exact_motion_t) :: exact
        real(dp) :: energy

        self%fallbacks = self%fallbacks + 1
        body%inertia = [self%inertia1(i), self%inertia1(i), self%inertia3(i)]
        body%gravity = self%mgl(i)
        body%centre_of_mass(3) = 1
        start = motion_from_angles(0.0_dp, [self%phi(i), self%theta(i), self%psi(i)], &
            [self%phi_rate(i), self%theta_rate(i), &
             self%omega3(i) - self%phi_rate(i) * cos(self%theta(i))])
        call prepare_exact_motion(body, start, exact, self%status(i))
        if (self%status(i) /= status_ok) return

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
    end subroutine compute_alone

end module spintop_exact_block
