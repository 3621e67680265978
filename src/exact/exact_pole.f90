!> The theta functions of many motions at once, in vector loops.
!>
!> The two poles of the sphere have fixed positions in the complex argument of a motion. Their position, the
!> expansion about it and the value at an instant are loops over a strip of them. The formulas are those of
!> `circular_form`, with terms up to the fifth multiple of the argument, which suffice for nomes up to 0.27
!> (the next term is q^30).
!>
!> Sources: Klein and Sommerfeld, Ueber die Theorie des Kreisels, chapter VI; Whittaker and Watson,
!> A Course of Modern Analysis, chapter XXI.
module spintop_exact_pole
    use spintop_kinds, only: dp
    implicit none
    private
    public :: pole_t, strip_length, largest_nome, place_pole, solve_position, divide_thetas, evaluate_pole

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

contains

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

end module spintop_exact_pole
