!> The theta functions of many motions from their starts, in vector loops.
!>
!> The two poles of the sphere have fixed positions in the complex argument of a motion. Their position, the
!> expansion about it and the value at an instant are loops over a strip of them, with terms up to the fifth multiple of the
!> argument, which suffice for nomes up to 0.27 (the next term is q^30).
!>
!> The stages of `turning_points` and `circular_form` in double precision. Each is a loop over a strip without
!> branches and calls and with few divisions and square roots: where several quotients are needed, the product
!> of all divisors is inverted once. Symbols as there; with u = u0 + y the nutation obeys u'^2 = beta y^3 + g2
!> y^2 + g1 y + g0.
module spintop_exact_strip
    use spintop_kinds, only: dp, pi
    use spintop_circular_functions, only: find_circular, find_arguments, largest_angle
    use spintop_theta_functions, only: nome_coefficients
    implicit none
    private
    public :: strip_t, find_roots, find_roots_of_moving, find_moduli, find_nome
    public :: find_start_phases, find_phases, strip_length, largest_nome, place_pole

    !> Motions in one loop: a multiple of every vector length, and few enough that intermediate results fit
    !> into the first-level cache.
    integer, parameter :: strip_length = 64
    !> Largest nome for which the series are complete, to 1e-15.
    real(dp), parameter :: largest_nome = 0.27_dp

    !> Largest second step of Newton's method for a position; the remaining error is a millionth of it.
    real(dp), parameter :: largest_second_step = 1.0e-6_dp

    !> One pole of the sphere, seen by the motions: its theta function
    !>
    !>     Theta(z) = nearest + 2 h even(c) +- i side odd(c) sin 2z
    !>
    !> with polynomials `even` and `odd` in c, where c = cos 2z, h = sin(z)^2 and + for theta = pi
    !> (z = 0 at the lower turning point), c = -cos 2z, h = cos(z)^2 and - for theta = 0. Written
    !> from its least value, for digits close to the pole.
    type :: pole_t
        !> The right-hand side for its position ("eps"), the position X = 2 q cosh(2 v), A/B of X, and
        !> sqrt(k') rho.
        real(dp), dimension(strip_length) :: excess, position, ratio, scale
        !> Theta where the axis is farthest ("S") and nearest. Before the expansion the latter is relative to
        !> the former.
        real(dp), dimension(strip_length) :: farthest, nearest
        !> Their logarithmic derivatives times their values ("D S", "D' S'").
        real(dp), dimension(strip_length) :: slope_farthest, slope_nearest
        real(dp), dimension(strip_length, 0:4) :: even, odd
        !> Sign of the rotation about the pole.
        real(dp), dimension(strip_length) :: side
        !> Factor of |Theta|^2 in 1 + u (1 - u), except for a common factor.
        real(dp), dimension(strip_length) :: weight
        !> Theta at an instant, its imaginary part without the sign, and its argument.
        real(dp), dimension(strip_length) :: re, im, argument
    end type pole_t

    !> Steps of Laguerre's method for an outer root, and its largest last step relative to the root; the
    !> remaining error is about the third power of that.
    integer, parameter :: laguerre_steps = 4
    real(dp), parameter :: largest_last_step = 1.0e-6_dp

    !> Smallest squared theta function, relative to its maximum: near its zero, the pole, phi and psi vary
    !> fast.
    real(dp), parameter :: least_theta = 1.0e-5_dp

    !> The motions of a strip.
    type :: strip_t
        !> Positive where the stages may not reach the specified accuracy.
        real(dp), dimension(strip_length) :: doubt
        !> a, beta, 1 - u0, 1 + u0, phi0' sin(theta0)^2, K0, b - a, b + a.
        real(dp), dimension(strip_length) :: a, beta, sh, ch, turn, k0, b_minus_a, b_plus_a
        !> Coefficients of the cubic; its roots y1 and y2, their difference, and beta y3.
        real(dp), dimension(strip_length) :: g0, g1, g2, y1, y2, d, beta_y3
        !> 1 - u1, 1 - u2, 1 + u1, 1 + u2, and two inverses.
        real(dp), dimension(strip_length) :: m1, d2, p1, p2, per_m1, per_p2
        !> beta (u3 - u1), its root and inverse; the root and inverse of beta (1 + u3);
        !> beta (u3 - 1) and its root; sqrt((1 - u1)(1 - u2)).
        real(dp), dimension(strip_length) :: bu, root_bu, per_bu, root_b1, per_b1, bd3, root_bd3, root_md
        !> k^2, k', sqrt(k'), and the nome.
        real(dp), dimension(strip_length) :: k2, kc, root_kc, q
        !> The poles theta = pi, below the motion, and theta = 0, above it.
        type(pole_t) :: bottom, top
        !> Argument of the theta functions at the start and its rate, mean rates of phi and psi, and
        !> a factor of theta'.
        real(dp), dimension(strip_length) :: z0, zeta, phi_speed, psi_speed, swing
        !> Sine and cosine of theta_min, sine of theta_max.
        real(dp), dimension(strip_length) :: sine_min, cosine_min, sine_max
        !> Sum and difference of the theta functions' arguments, as they turn phi and psi, at the
        !> start and at an instant.
        real(dp), dimension(strip_length) :: phi_start, psi_start, phi_now, psi_now
        !> At the instant: the argument z, sin(z)^2, cos(z)^2 and sin 2z.
        real(dp), dimension(strip_length) :: z, sine2, cosine2, sine_of_2z
    end type strip_t

contains

    !> The roots for a start at a turning point, where the cubic is y times a quadratic, and the argument
    !> there.
    pure subroutine find_roots(strip)
        type(strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp) :: half, per_half, other
        logical :: falls
        integer :: i
        !$omp simd private(half, per_half, other, falls)
        do i = 1, strip_length
            associate (g1 => strip%g1(i), g2 => strip%g2(i), beta => strip%beta(i))
                half = (sqrt(max(g2**2 - 4 * beta * g1, 0.0_dp)) + abs(g2)) / 2
                falls = g2 <= 0
                ! 1/half, or 1/(half beta).
                per_half = 1 / merge(half, half * beta, falls)
                strip%beta_y3(i) = merge(half, -beta**2 * g1 * per_half, falls)
                other = merge(g1, -half**2, falls) * per_half
                strip%y1(i) = min(other, 0.0_dp)
                strip%y2(i) = max(other, 0.0_dp)
                strip%d(i) = abs(other)
                strip%d2(i) = strip%sh(i) - strip%y2(i)
                strip%bd3(i) = strip%beta_y3(i) - beta * strip%sh(i)
                strip%z0(i) = merge(pi / 2, 0.0_dp, other < 0)
            end associate
        end do
    end subroutine find_roots

    !> The roots for starts between turning points (g0 > 0): the highest by Laguerre's method, downwards from
    !> the root of the quadratic, and the other two from their sum and product. Where the upper two may be
    !> close together: the lowest, upwards from u = -1, and the distances of the others from u = 1.
    pure subroutine find_roots_of_moving(strip)
        type(strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp) :: c0, c1, c3, y, g, slope, curvature, step, per_y, product, total, d, larger
        real(dp) :: smaller, per_by, energy, y1, y2, y3, d2, d3, excess, low_g0, per_last
        real(dp) :: inflection
        integer :: i, n
        !$omp simd private(c0, c1, c3, y, g, slope, curvature, step, per_y, product, total, d, &
        !$omp larger, smaller, per_by, energy, y1, y2, y3, d2, d3, excess, low_g0, per_last, &
        !$omp inflection)
        do i = 1, strip_length
            associate (g0 => strip%g0(i), g1 => strip%g1(i), g2 => strip%g2(i), &
                       beta => strip%beta(i), sh => strip%sh(i), ch => strip%ch(i))
                ! Positive where the cubic is at its inflection: the upper two are the closer pair.
                inflection = merge(g2 * (2 * g2**2 - 9 * beta * g1) + 27 * beta**2 * g0, &
                                   0.0_dp, g0 > 0)
                ! In y from below, in beta y from above.
                c0 = merge(g0, beta**2 * g0, inflection > 0)
                c1 = merge(g1, beta * g1, inflection > 0)
                c3 = merge(beta, 1.0_dp, inflection > 0)
                y = merge(-ch, strip%beta_y3(i), inflection > 0)
                step = 0
                do n = 1, laguerre_steps
                    g = c0 + y * (c1 + y * (g2 + y * c3))
                    slope = c1 + y * (2 * g2 + y * 3 * c3)
                    curvature = 2 * g2 + 6 * y * c3
                    step = 3 * g / (slope + sqrt(max(4 * slope**2 - 6 * g * curvature, 0.0_dp)))
                    y = y - step
                end do
                step = merge(step, 0.0_dp, g0 > 0)
                strip%doubt(i) = merge(1.0_dp, strip%doubt(i), &
                                       abs(step) > largest_last_step * abs(y))

                per_y = 1 / y
                product = -g0 * per_y
                total = (g1 - beta * product) * per_y
                d = sqrt(max(total**2 - 4 * product, 0.0_dp))
                larger = (total + sign(d, total)) / 2
                smaller = product / larger

                ! u2 + u3 - 2 in two ways: the one with the smaller terms has less cancellation.
                y1 = y
                energy = strip%k0(i) + strip%a(i)**2
                low_g0 = g0 * per_y
                per_by = 1 / (beta * y1)
                excess = merge((g1 + low_g0) * per_by - 2 * sh, energy * y1 * per_by - 2 - y1, &
                    2 * sh - (abs(g1) - low_g0) * per_by < energy * y1 * per_by + 2 - y1)
                total = strip%b_minus_a(i)**2 / (beta * (sh - y1))
                d3 = (abs(excess) + sqrt(excess**2 + 4 * total)) / 2
                per_last = total / d3
                d2 = merge(per_last, d3, excess >= 0)
                d3 = merge(d3, per_last, excess >= 0)
                y3 = sh + d3
                y2 = -low_g0 / (beta * y3)

                y1 = merge(y1, min(larger, smaller), inflection > 0)
                y2 = merge(y2, max(larger, smaller), inflection > 0)
                d = merge(y2 - y1, d, inflection > 0)
                y = merge(beta * y3, y, inflection > 0)
                d2 = merge(d2, sh - y2, inflection > 0)
                d3 = merge(beta * d3, y - beta * sh, inflection > 0)
                strip%y1(i) = merge(y1, strip%y1(i), g0 > 0)
                strip%y2(i) = merge(y2, strip%y2(i), g0 > 0)
                strip%d(i) = merge(d, strip%d(i), g0 > 0)
                strip%beta_y3(i) = merge(y, strip%beta_y3(i), g0 > 0)
                strip%d2(i) = merge(d2, strip%d2(i), g0 > 0)
                strip%bd3(i) = merge(d3, strip%bd3(i), g0 > 0)
            end associate
        end do
    end subroutine find_roots_of_moving

    !> Distances of the roots, and the moduli.
    pure subroutine find_moduli(strip)
        type(strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp) :: b1, larger, root, other_root, mp, bb, per_all, per_larger
        logical :: u3_farther
        integer :: i
        !$omp simd private(b1, larger, root, other_root, mp, bb, per_all, per_larger, u3_farther)
        do i = 1, strip_length
            associate (beta => strip%beta(i), y1 => strip%y1(i), beta_y3 => strip%beta_y3(i), &
                       m1 => strip%m1(i), d2 => strip%d2(i), p2 => strip%p2(i), &
                       bu => strip%bu(i), bd3 => strip%bd3(i), per_m1 => strip%per_m1(i), &
                       per_p2 => strip%per_p2(i), per_bu => strip%per_bu(i), &
                       per_b1 => strip%per_b1(i))
                m1 = strip%sh(i) - y1
                p2 = strip%ch(i) + strip%y2(i)
                bu = beta_y3 - beta * y1
                b1 = beta_y3 + beta * strip%ch(i)
                ! Of the distances of u2 and u3 from 1 the larger is exact; the other one follows
                ! from f(1) = -(b-a)^2.
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
                other_root = abs(strip%b_minus_a(i)) * root * per_larger
                strip%root_bd3(i) = merge(root, other_root, u3_farther)
                strip%root_md(i) = merge(other_root, root, u3_farther)
                bd3 = merge(bd3, other_root**2, u3_farther)
                d2 = merge(other_root**2 * per_m1, d2, u3_farther)
                strip%p1(i) = strip%b_plus_a(i)**2 * per_p2 * per_b1

                strip%root_b1(i) = sqrt(b1)
                strip%k2(i) = beta * strip%d(i) * per_bu
                strip%kc(i) = sqrt((beta * d2 + bd3) * per_bu)
                strip%root_kc(i) = sqrt(strip%kc(i))
            end associate
        end do
    end subroutine find_moduli

    !> The nome, and the data for the positions of the poles.
    pure subroutine find_nome(strip)
        type(strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp) :: plus_root, leading, t, series, root_bottom, root_top, sum_bottom, sum_top
        real(dp) :: factor, per_all, per_factor, per_sums, per_kc
        integer :: i, n
        !$omp simd private(plus_root, leading, t, series, root_bottom, root_top, sum_bottom, &
        !$omp sum_top, factor, per_all, per_factor, per_sums, per_kc)
        do i = 1, strip_length
            associate (k2 => strip%k2(i), kc => strip%kc(i), root_kc => strip%root_kc(i), &
                       d => strip%d(i), root_bu => strip%root_bu(i), bottom => strip%bottom, &
                       top => strip%top)
                root_bu = sqrt(strip%bu(i))
                ! sqrt(k'/B1), sqrt(p1 p2 k') and sqrt(m1 d2 k').
                bottom%scale(i) = root_kc * strip%root_b1(i) * strip%per_b1(i)
                root_bottom = abs(strip%b_plus_a(i)) * bottom%scale(i)
                root_top = root_kc * strip%root_md(i)
                sum_bottom = strip%p2(i) + strip%p1(i) * kc + 2 * root_bottom
                sum_top = strip%m1(i) * kc + strip%d2(i) + 2 * root_top
                plus_root = (1 + root_kc)**2
                factor = (1 + kc) * plus_root

                per_all = 1 / (factor * kc * sum_bottom * sum_top)
                per_factor = per_all * kc * sum_bottom * sum_top
                per_kc = per_all * factor * sum_bottom * sum_top
                per_sums = per_all * factor * kc

                leading = k2 / 2 * per_factor
                t = leading**4
                series = nome_coefficients(11)
                do n = 10, 0, -1
                    series = nome_coefficients(n) + t * series
                end do
                strip%q(i) = leading * series

                bottom%excess(i) = (d + strip%p1(i) * k2 * plus_root * per_factor) &
                                   * sum_top * per_sums
                top%excess(i) = d * (strip%bd3(i) * strip%per_bu(i) + kc) &
                                * plus_root * per_factor * sum_bottom * per_sums
                bottom%scale(i) = bottom%scale(i) * root_bu
                top%scale(i) = root_kc * strip%root_bd3(i) * root_bu * strip%per_bu(i) * per_kc
                bottom%nearest(i) = root_bottom * strip%per_p2(i)
                top%nearest(i) = root_top * strip%per_m1(i) * per_kc
                bottom%side(i) = sign(1.0_dp, strip%b_plus_a(i))
                top%side(i) = sign(1.0_dp, strip%b_minus_a(i))
            end associate
        end do
    end subroutine find_nome

    !> The argument, and those of the theta functions, at the start; zero for a start at a turning point. The equation is that
    !> of the position of a pole, with X = 2 q cos 2z. The other motions are not affected, so that no case depends on its
    !> neighbours.
    pure subroutine find_start_phases(strip, theta_rate, moves)
        type(strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp), intent(in) :: theta_rate(strip_length) !! nutation rates at the start, rad/s
        logical, intent(in) :: moves  !! whether some start is between turning points
        real(dp), dimension(strip_length) :: excess, position, ratio, sine, cosine, angle, doubt_before
        real(dp) :: sn2, dn, per_plus, per_all
        integer :: i
        strip%phi_start = 0
        strip%psi_start = 0
        if (.not. moves) return
        doubt_before = strip%doubt
        !$omp simd private(sn2, dn, per_plus, per_all)
        do i = 1, strip_length
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
        do i = 1, strip_length
            sine(i) = strip%root_kc(i) * sqrt(-strip%y1(i)) * ratio(i)
            cosine(i) = sqrt(strip%y2(i))
        end do
        call find_arguments(strip_length, cosine, sine, angle)
        !$omp simd
        do i = 1, strip_length
            strip%z0(i) = merge(sign(angle(i), -theta_rate(i)), strip%z0(i), &
                                strip%g0(i) > 0)
        end do
        angle = 0
        call find_phases(strip, angle)
        strip%phi_start = merge(strip%phi_now, 0.0_dp, strip%g0 > 0)
        strip%psi_start = merge(strip%psi_now, 0.0_dp, strip%g0 > 0)
        strip%doubt = merge(strip%doubt, doubt_before, strip%g0 > 0)
    end subroutine find_start_phases

    !> The theta functions of both poles at the given times.
    pure subroutine find_phases(strip, time)
        type(strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp), intent(in) :: time(strip_length) !! time since the start, s
        integer :: i
        strip%z = strip%z0 + strip%zeta * time
        call find_circular(strip_length, strip%z, strip%sine2, strip%cosine2, strip%sine_of_2z)
        call evaluate_pole(strip%bottom, strip%sine2, strip%cosine2, strip%sine_of_2z)
        call evaluate_pole(strip%top, strip%cosine2, strip%sine2, strip%sine_of_2z)
        call find_arguments(strip_length, strip%bottom%re, strip%bottom%im, strip%bottom%argument)
        call find_arguments(strip_length, strip%top%re, strip%top%im, strip%top%argument)
        !$omp simd
        do i = 1, strip_length
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

    !> Position and expansion of a pole. Excess, scale, side and the relative `nearest` are set by the caller.
    pure subroutine place_pole(q, pole, doubt)
        real(dp), intent(in) :: q(strip_length) !! nomes
        type(pole_t), intent(inout) :: pole !! the pole
        real(dp), intent(inout) :: doubt(strip_length)  !! set where the position may be wrong
        call solve_position(q, pole%excess, pole%position, doubt)
        call divide_thetas(q, pole%position, pole%ratio)
        call expand_pole(q, pole)
    end subroutine place_pole

    !> Solves sum_{n odd} q^(n^2-n) h_n = excess (1 + sum_{n even} q^(n^2-n) h_n) for X = h_1, with h_n = 2
    !> q^n cosh(2 n v), by two steps of Newton's method. The first step omits terms that only the second one
    !> needs. The second corrects the inverse slope of the first instead of another division.
    pure subroutine solve_position(q, excess, x, doubt)
        real(dp), intent(in) :: q(strip_length), excess(strip_length) !! nomes, and right-hand sides
        real(dp), intent(out) :: x(strip_length) !! positions X = 2 q cosh(2 v)
        real(dp), intent(inout) :: doubt(strip_length)  !! set where two steps may not suffice
        real(dp) :: q2, q4, q6, q12, scale, r, y, y2, odd, even, slope, per_slope, step
        integer :: i
        !$omp simd private(q2, q4, q6, q12, scale, r, y, y2, odd, even, slope, per_slope, step)
        do i = 1, strip_length
            associate (eps => excess(i))
                q2 = q(i)**2
                q4 = q2**2
                q6 = q2 * q4
                q12 = q6**2
                ! The quadratic X - eps (1 - 2 q^4 + q^2 X^2) = 0 by its series.
                scale = 1 - 2 * q4
                r = min(eps**2 * q2 * scale, 0.2_dp)
                y = eps * scale * (1 + r * (1 + r * (2 + r * (5 + r * (14 + r * 42)))))

                y2 = y**2
                odd = y + y * q6 * (y2 - 3 * q2)
                even = 1 + q2 * (y2 - 2 * q2)
                slope = 1 + 3 * q6 * (y2 - q2) - 2 * eps * y * q2
                per_slope = 1 / slope
                y = y - (odd - eps * even) * per_slope

                y2 = y**2
                odd = y + y * (q6 * (y2 - 3 * q2) + q12 * q4**2 * (y2 * (y2 - 5 * q2) + 5 * q4))
                even = 1 + q2 * (y2 - 2 * q2) + q12 * (y2 * (y2 - 4 * q2) + 2 * q4)
                slope = 1 + 3 * q6 * (y2 - q2) - 2 * eps * y * (q2 + 2 * q12 * (y2 - 2 * q2))
                per_slope = per_slope * (2 - slope * per_slope)
                step = (odd - eps * even) * per_slope
                x(i) = y - step
                doubt(i) = merge(1.0_dp, doubt(i), abs(step) > largest_second_step)
            end associate
        end do
    end subroutine solve_position

    !> A/B of a position X: A = 1 + sum q^(n^2) a_n with a_1 = X - q, B = 1 + sum (-1)^n q^(n^2) b_n
    !> with b_1 = X + q, both by x_(n+1) = X x_n - q^2 x_(n-1), x_0 = 1.
    pure subroutine divide_thetas(q, x, ratio)
        real(dp), intent(in) :: q(strip_length), x(strip_length) !! nomes, and positions X = 2 q cosh(2 v)
        real(dp), intent(out) :: ratio(strip_length) !! A/B
        real(dp) :: q2, q4, q9, q16, a1, a2, a3, a4, b1, b2, b3, b4
        integer :: i
        !$omp simd private(q2, q4, q9, q16, a1, a2, a3, a4, b1, b2, b3, b4)
        do i = 1, strip_length
            q2 = q(i)**2
            q4 = q2**2
            q9 = q4**2 * q(i)
            q16 = q4**4
            a1 = x(i) - q(i)
            a2 = x(i) * a1 - q2
            a3 = x(i) * a2 - q2 * a1
            a4 = x(i) * a3 - q2 * a2
            b1 = x(i) + q(i)
            b2 = x(i) * b1 - q2
            b3 = x(i) * b2 - q2 * b1
            b4 = x(i) * b3 - q2 * b2
            ratio(i) = (1 + q(i) * a1 + q4 * a2 + q9 * a3 + q16 * a4) &
                     / (1 - q(i) * b1 + q4 * b2 - q9 * b3 + q16 * b4)
        end do
    end subroutine divide_thetas

    !> The theta function of a pole from its position.
    pure subroutine expand_pole(q, pole)
        real(dp), intent(in) :: q(strip_length)
        type(pole_t), intent(inout) :: pole
        real(dp) :: q2, q6, q12, q20, x, e1, e2, e3, e4, e5, o1, o2, o3, o4, o5
        integer :: i
        !$omp simd private(q2, q6, q12, q20, x, e1, e2, e3, e4, e5, o1, o2, o3, o4, o5)
        do i = 1, strip_length
            q2 = q(i)**2
            q6 = q2**3
            q12 = q6**2
            q20 = q12 * q6 * q2
            x = pole%position(i)
            ! W^n + V^n and W^n - V^n, of W + V = X. Not W - V = sqrt(X^2 - 4 q^2): that loses half
            ! the digits.
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
            ! Now times q^(n^2 - n).
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
            ! -sum (-1)^n e_n sin(nz)^2/sin(z)^2 and -sum (-1)^n o_n sin(2nz)/sin(2z) in powers of
            ! cos 2z.
            pole%even(i, 0) = e1 - 2 * e2 + e3 + e5
            pole%even(i, 1) = 4 * (e3 - e5) - 2 * e2
            pole%even(i, 2) = 4 * (e3 - e5) - 8 * e4
            pole%even(i, 3) = 16 * e5 - 8 * e4
            pole%even(i, 4) = 16 * e5
            pole%odd(i, 0) = o1 - o3 + o5
            pole%odd(i, 1) = 4 * o4 - 2 * o2
            pole%odd(i, 2) = 4 * o3 - 12 * o5
            pole%odd(i, 3) = -8 * o4
            pole%odd(i, 4) = 16 * o5
        end do
    end subroutine expand_pole

    !> Theta at an instant, of which sin 2z is given and sin(z)^2 and cos(z)^2: first the one that
    !> vanishes where the axis is nearest to the pole.
    pure subroutine evaluate_pole(pole, near, far, sine_of_2z)
        type(pole_t), intent(inout) :: pole !! the pole
        real(dp), intent(in) :: near(strip_length), far(strip_length), sine_of_2z(strip_length)
            !! sin(z)^2 or cos(z)^2, first the one that vanishes where the axis is nearest to the pole; sin(2
            !! z)
        real(dp) :: c
        integer :: i
        !$omp simd private(c)
        do i = 1, strip_length
            c = far(i) - near(i)
            pole%re(i) = pole%nearest(i) + 2 * near(i) * (pole%even(i, 0) + c * (pole%even(i, 1) &
                + c * (pole%even(i, 2) + c * (pole%even(i, 3) + c * pole%even(i, 4)))))
            pole%im(i) = sine_of_2z(i) * (pole%odd(i, 0) + c * (pole%odd(i, 1) &
                + c * (pole%odd(i, 2) + c * (pole%odd(i, 3) + c * pole%odd(i, 4)))))
        end do
    end subroutine evaluate_pole

end module spintop_exact_strip
