!> The exact motion of many free bodies, in vector loops.
!>
!> The stages of `free_motion` and of its series in circular functions, in double precision. Each is a loop over
!> a strip without branches and calls. Symbols as there.
module spintop_free_strip
    use spintop_kinds, only: dp
    use spintop_array_functions, only: find_circular, largest_angle
    use spintop_exact_pole, only: strip_length
    use spintop_free_circular_series, only: least_complement
    use spintop_theta_functions, only: nome_coefficients
    implicit none
    private
    public :: free_strip_t, find_axes, find_constants, find_series, find_argument, find_rotation, find_values

    !> Iterations for Y and for the argument at the start; each gains two digits or more. A last step above this is
    !> doubtful.
    integer, parameter :: iterations = 8
    real(dp), parameter :: largest_last_step = 1.0e-14_dp
    !> Smallest k'.
    real(dp), parameter :: least = real(least_complement, dp)

    !> The motions of a strip.
    type :: free_strip_t
        !> Positive where the stages may not reach the specified accuracy.
        real(dp), dimension(strip_length) :: doubt
        !> Moments of inertia, angular velocity, number and sign of the axes x, y, z; side s and angular momentum.
        real(dp), dimension(strip_length, 3) :: inertia, omega, axis, signs
        real(dp), dimension(strip_length) :: side, momentum
        !> a, b, c, k', frequency, r = a/(1+c), rho, and a b sn and a b cn at the start.
        real(dp), dimension(strip_length) :: a, b, c, complement, k2, frequency, ratio, spin, across, along
        !> Nome, zeta, kappa; Y, S, the slope of F+ and a sum for the turn; the last step of an iteration.
        real(dp), dimension(strip_length) :: q, rate, phase_rate, y, root, slope, below, step
        !> Coefficients of F+ and F-, and factors of cn, sn, dn.
        real(dp), dimension(strip_length, 0:3) :: up_even, up_odd, low_odd, low_even
        real(dp), dimension(strip_length, 3) :: factor
        !> exp(i z) at the start and now, exp(i chi) now, and F+ and F- now, their squares' sum; cn, sn, dn.
        real(dp), dimension(strip_length, 2) :: start, turn, phase, upper, lower
        real(dp), dimension(strip_length) :: square
        real(dp), dimension(strip_length, 3) :: elliptic
    end type free_strip_t

contains

    !> Sorts the axes: x, y, z in the order of their inertia, or against it.
    pure subroutine find_axes(strip)
        type(free_strip_t), intent(inout) :: strip !! inertia and omega in body axes on entry, along x, y, z on return
        real(dp) :: i1, i2, i3, w1, w2, w3, n1, n2, n3, parity, excess
        logical :: flips
        integer :: k
        !$omp simd private(i1, i2, i3, w1, w2, w3, n1, n2, n3, parity, excess, flips)
        do k = 1, strip_length
            i1 = strip%inertia(k, 1)
            i2 = strip%inertia(k, 2)
            i3 = strip%inertia(k, 3)
            w1 = strip%omega(k, 1)
            w2 = strip%omega(k, 2)
            w3 = strip%omega(k, 3)
            n1 = 1
            n2 = 2
            n3 = 3
            parity = 1
            call exchange(i1 > i2, i1, i2, w1, w2, n1, n2, parity)
            call exchange(i2 > i3, i2, i3, w2, w3, n2, n3, parity)
            call exchange(i1 > i2, i1, i2, w1, w2, n1, n2, parity)
            ! Its sign is the class of the motion, its zero the separatrix.
            excess = i3 * (i3 - i2) * w3**2 - i1 * (i2 - i1) * w1**2
            flips = excess < 0 .or. (excess <= 0 .and. i3 <= i2)
            call exchange(flips, i1, i3, w1, w3, n1, n3, parity)
            strip%inertia(k, 1) = i1
            strip%inertia(k, 2) = i2
            strip%inertia(k, 3) = i3
            strip%omega(k, 1) = w1
            strip%omega(k, 2) = w2
            strip%omega(k, 3) = w3
            strip%axis(k, 1) = n1
            strip%axis(k, 2) = n2
            strip%axis(k, 3) = n3
            strip%complement(k) = abs(excess)
            strip%side(k) = merge(-1.0_dp, 1.0_dp, flips)
            strip%signs(k, 1) = strip%side(k) * sign(1.0_dp, w1)
            strip%signs(k, 3) = sign(1.0_dp, w3)
            strip%signs(k, 2) = strip%signs(k, 1) * strip%signs(k, 3) * parity
        end do
    end subroutine find_axes

    !> Exchanges two axes on a condition.
    pure subroutine exchange(swaps, i1, i2, w1, w2, n1, n2, parity)
        logical, intent(in) :: swaps
        real(dp), intent(inout) :: i1, i2, w1, w2, n1, n2, parity
        real(dp) :: t
        t = merge(i2, i1, swaps)
        i2 = merge(i1, i2, swaps)
        i1 = t
        t = merge(w2, w1, swaps)
        w2 = merge(w1, w2, swaps)
        w1 = t
        t = merge(n2, n1, swaps)
        n2 = merge(n1, n2, swaps)
        n1 = t
        parity = merge(-parity, parity, swaps)
    end subroutine exchange

    !> The constants of the motion. A motion about one fixed axis, or close to the separatrix, is doubtful.
    pure subroutine find_constants(strip)
        type(free_strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp) :: lx, ly, lz, px, py, pz, total, d_xy, d_xz, d_yz, a, b, c, a2, b2, c2, ix, iy, iz, complement
        integer :: k
        !$omp simd private(lx, ly, lz, px, py, pz, total, d_xy, d_xz, d_yz, a, b, c, a2, b2, c2, ix, iy, iz, complement)
        do k = 1, strip_length
            ix = strip%inertia(k, 1)
            iy = strip%inertia(k, 2)
            iz = strip%inertia(k, 3)
            lx = ix * strip%omega(k, 1)
            ly = iy * strip%omega(k, 2)
            lz = iz * strip%omega(k, 3)
            total = sqrt(lx**2 + ly**2 + lz**2)
            px = abs(lx) / total
            py = strip%signs(k, 2) * ly / total
            pz = abs(lz) / total
            d_xy = abs(ix - iy) / (ix * iy)
            d_xz = abs(ix - iz) / (ix * iz)
            d_yz = abs(iy - iz) / (iy * iz)
            a2 = px**2 + py**2 * (d_yz / d_xz)
            b2 = py**2 + px**2 * (d_xz / d_yz)
            c2 = pz**2 + py**2 * (d_xy / d_xz)
            a = sqrt(a2)
            b = sqrt(b2)
            c = sqrt(c2)
            complement = sqrt(iz * strip%complement(k) / abs(iz - iy)) / (total * c)
            strip%a(k) = a
            strip%b(k) = b
            strip%c(k) = c
            strip%complement(k) = complement
            strip%k2(k) = b2 * d_xy / (d_xz * c2)
            strip%frequency(k) = total * c * sqrt(d_xz * d_yz)
            strip%ratio(k) = a / (1 + c)
            strip%spin(k) = total * (c / iz + strip%ratio(k) * a / ix)
            strip%across(k) = a * py
            strip%along(k) = b * px
            strip%momentum(k) = total
            ! Two components at least, and no quotient 0/0: also false for NaN and infinity.
            strip%doubt(k) = merge(0.0_dp, 1.0_dp, min(ix, iy, iz) > 0 .and. d_xz > 0 .and. d_yz > 0 .and. a > 0 &
                .and. c > 0 .and. complement >= least &
                .and. abs(strip%frequency(k) + strip%spin(k)) <= huge(total))
        end do
    end subroutine find_constants

    !> Nome, the number Y, the rates, and the coefficients of the series.
    pure subroutine find_series(strip)
        type(free_strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        integer :: n
        call find_nome(strip)
        do n = 1, iterations
            call improve_root(strip)
        end do
        call find_coefficients(strip)
    end subroutine find_series

    !> The nome, and a first approximation of Y.
    pure subroutine find_nome(strip)
        type(free_strip_t), intent(inout) :: strip
        real(dp) :: root_kc, leading, t, series, u
        integer :: k, n
        !$omp simd private(root_kc, leading, t, series, u, n)
        do k = 1, strip_length
            root_kc = sqrt(strip%complement(k))
            leading = strip%k2(k) / (2 * (1 + strip%complement(k)) * (1 + root_kc)**2)
            t = (leading**2)**2
            series = nome_coefficients(11)
            do n = 10, 0, -1
                series = nome_coefficients(n) + t * series
            end do
            strip%q(k) = leading * series
            strip%factor(k, 3) = root_kc
            u = 1 - 2 * strip%q(k)**2
            strip%y(k) = 2 * strip%ratio(k) * u / (1 + sqrt(1 + 4 * strip%q(k) * strip%ratio(k)**2 * u))
        end do
    end subroutine find_nome

    !> A step of Newton's method for Y.
    pure subroutine improve_root(strip)
        type(free_strip_t), intent(inout) :: strip
        real(dp) :: q, q2, q3, q6, x, y, e2, e3, o1, o2, o3
        integer :: k
        !$omp simd private(q, q2, q3, q6, x, y, e2, e3, o1, o2, o3)
        do k = 1, strip_length
            q = strip%q(k)
            y = strip%y(k)
            q2 = q * q
            q3 = q * q2
            q6 = q3 * q3
            x = y**2 + 2 * q
            e2 = x * x - 2 * q2
            e3 = x * e2 - q2 * x
            o1 = y * (x + q)
            o2 = x * o1 - q2 * y
            o3 = x * o2 - q2 * o1
            strip%below(k) = y - q3 * o1 + q6 * q2 * q2 * o2 - q6 * q6 * q6 * q3 * o3
            strip%step(k) = (strip%below(k) - strip%ratio(k) * (1 - q * x + q6 * e2 - q6 * q6 * q3 * e3)) &
                            / (1 - 3 * q3 * (y**2 + q) + 2 * q * strip%ratio(k) * y)
            strip%y(k) = y - strip%step(k)
        end do
    end subroutine improve_root

    !> The coefficients of the series, and the rates.
    pure subroutine find_coefficients(strip)
        type(free_strip_t), intent(inout) :: strip
        real(dp) :: q, q2, q3, q6, q10, q15, q21, x, y, s, side, e2, e3, m1, m2, m3, p1, p2, p3, o1, o2, o3, theta3, t2
        integer :: k
        !$omp simd private(q, q2, q3, q6, q10, q15, q21, x, y, s, side, e2, e3, m1, m2, m3, p1, p2, p3, o1, o2, o3, &
        !$omp theta3, t2)
        do k = 1, strip_length
            q = strip%q(k)
            y = strip%y(k)
            side = strip%side(k)
            q2 = q * q
            q3 = q * q2
            q6 = q3 * q3
            q10 = q6 * q2 * q2
            q15 = q6 * q6 * q3
            q21 = q15 * q6
            x = y**2 + 2 * q
            s = sqrt(y**2 + 4 * q)
            e2 = x * x - 2 * q2
            e3 = x * e2 - q2 * x
            m1 = y * s
            m2 = x * m1
            m3 = x * m2 - q2 * m1
            p1 = s * (x - q)
            p2 = x * p1 - q2 * s
            p3 = x * p2 - q2 * p1
            o1 = y * (x + q)
            o2 = x * o1 - q2 * y
            o3 = x * o2 - q2 * o1
            strip%up_even(k, 0) = 1
            strip%up_even(k, 1) = -q * x
            strip%up_even(k, 2) = q6 * e2
            strip%up_even(k, 3) = -q15 * e3
            strip%up_odd(k, 0) = 0
            strip%up_odd(k, 1) = -side * q * m1
            strip%up_odd(k, 2) = side * q6 * m2
            strip%up_odd(k, 3) = -side * q15 * m3
            strip%low_odd(k, 0) = s
            strip%low_odd(k, 1) = -q3 * p1
            strip%low_odd(k, 2) = q10 * p2
            strip%low_odd(k, 3) = -q21 * p3
            strip%low_even(k, 0) = -side * y
            strip%low_even(k, 1) = side * q3 * o1
            strip%low_even(k, 2) = -side * q10 * o2
            strip%low_even(k, 3) = side * q21 * o3
            theta3 = 1 + 2 * (q + q2 * q2 + q6 * q3 + q15 * q + q15 * q10)
            t2 = 1 / (1 + q2 + q6 + q6 * q6 + q10 * q10)
            strip%factor(k, 2) = theta3 * t2
            strip%factor(k, 1) = strip%factor(k, 3) * theta3 * t2
            strip%root(k) = s
            strip%slope(k) = 2 * (q * m1 - 2 * q6 * m2 + 3 * q15 * m3) / (1 - q * x + q6 * e2 - q15 * e3)
            strip%rate(k) = strip%frequency(k) / theta3**2
            strip%phase_rate(k) = strip%spin(k) / 2 + side * strip%rate(k) * strip%slope(k)
            strip%doubt(k) = merge(strip%doubt(k), 1.0_dp, abs(strip%step(k)) <= largest_last_step * y)
        end do
    end subroutine find_coefficients

    !> exp(i z) at the start.
    pure subroutine find_argument(strip)
        type(free_strip_t), intent(inout) :: strip !! the motions of the strip; results are added
        real(dp) :: length
        integer :: k, n
        !$omp simd private(length)
        do k = 1, strip_length
            strip%across(k) = strip%factor(k, 3) * strip%across(k)
            length = 1 / sqrt(strip%across(k)**2 + strip%along(k)**2)
            strip%start(k, 1) = strip%along(k) * length
            strip%start(k, 2) = strip%across(k) * length
        end do
        do n = 1, iterations
            call improve_argument(strip)
        end do
        strip%doubt = merge(strip%doubt, 1.0_dp, abs(strip%step) <= largest_last_step)
    end subroutine find_argument

    !> A step to the z with tan z = across B/(along A), theta functions of z itself.
    pure subroutine improve_argument(strip)
        type(free_strip_t), intent(inout) :: strip
        real(dp) :: q2, q6, q12, q20, c, s, f, a1, a2, a3, a4, b1, b2, b3, b4, x, y, d, sine, cosine, length
        integer :: k
        !$omp simd private(q2, q6, q12, q20, c, s, f, a1, a2, a3, a4, b1, b2, b3, b4, x, y, d, sine, cosine, length)
        do k = 1, strip_length
            c = strip%start(k, 1)
            s = strip%start(k, 2)
            q2 = strip%q(k)**2
            q6 = q2 * q2 * q2
            q12 = q6 * q6
            q20 = q12 * q6 * q2
            f = 2 * (c - s) * (c + s)
            a1 = f + 1
            b1 = f - 1
            a2 = f * a1 - 1
            b2 = f * b1 - 1
            a3 = f * a2 - a1
            b3 = f * b2 - b1
            a4 = f * a3 - a2
            b4 = f * b3 - b2
            x = strip%along(k) * (1 - q2 * a1 + q6 * a2 - q12 * a3 + q20 * a4)
            y = strip%across(k) * (1 + q2 * b1 + q6 * b2 + q12 * b3 + q20 * b4)
            ! The angle from there to here, which is small.
            d = (s * x - c * y) / sqrt(x**2 + y**2)
            d = (d + d**3 / 6) / (1 + 16 * q2 * (s * c)**2)
            sine = d - d**3 / 6
            cosine = 1 - d**2 / 2
            x = c * cosine + s * sine
            y = s * cosine - c * sine
            length = 1 / sqrt(x**2 + y**2)
            strip%start(k, 1) = x * length
            strip%start(k, 2) = y * length
            strip%step(k) = d
        end do
    end subroutine improve_argument

    !> exp(i angle) of angles, rad; large angles are doubtful.
    pure subroutine find_rotation(angle, rotation, doubt)
        real(dp), intent(in) :: angle(strip_length) !! the angles, rad
        real(dp), intent(out) :: rotation(strip_length, 2) !! cosine and sine
        real(dp), intent(inout) :: doubt(strip_length) !! set to 1 where the angle is too large
        real(dp), dimension(strip_length) :: half, sine2, cosine2, sine
        half = angle / 2
        call find_circular(strip_length, half, sine2, cosine2, sine)
        rotation(:, 1) = cosine2 - sine2
        rotation(:, 2) = sine
        doubt = merge(doubt, 1.0_dp, abs(half) <= largest_angle)
    end subroutine find_rotation

    !> F+ and F- at exp(i z), and with `wants_rates` cn, sn and dn.
    pure subroutine find_values(strip, wants_rates)
        type(free_strip_t), intent(inout) :: strip !! the motions of the strip; `turn` is exp(i z)
        logical, intent(in) :: wants_rates !! whether the elliptic functions are needed
        real(dp) :: c(9), s(9), q, q2, q4, q6, theta3, theta4, sine, cosine
        integer :: k, n
        !$omp simd private(c, s, n)
        do k = 1, strip_length
            c(1) = strip%turn(k, 1)
            s(1) = strip%turn(k, 2)
            do n = 1, 6
                c(n + 1) = c(n) * c(1) - s(n) * s(1)
                s(n + 1) = s(n) * c(1) + c(n) * s(1)
            end do
            strip%upper(k, 1) = strip%up_even(k, 0) + strip%up_even(k, 1) * c(2) + strip%up_even(k, 2) * c(4) &
                                + strip%up_even(k, 3) * c(6)
            strip%upper(k, 2) = strip%up_odd(k, 1) * s(2) + strip%up_odd(k, 2) * s(4) + strip%up_odd(k, 3) * s(6)
            strip%lower(k, 1) = strip%low_odd(k, 0) * s(1) + strip%low_odd(k, 1) * s(3) + strip%low_odd(k, 2) * s(5) &
                                + strip%low_odd(k, 3) * s(7)
            strip%lower(k, 2) = strip%low_even(k, 0) * c(1) + strip%low_even(k, 1) * c(3) + strip%low_even(k, 2) * c(5) &
                                + strip%low_even(k, 3) * c(7)
            strip%square(k) = strip%upper(k, 1)**2 + strip%upper(k, 2)**2 + strip%lower(k, 1)**2 + strip%lower(k, 2)**2
        end do
        if (.not. wants_rates) return
        !$omp simd private(c, s, q, q2, q4, q6, theta3, theta4, sine, cosine, n)
        do k = 1, strip_length
            c(1) = strip%turn(k, 1)
            s(1) = strip%turn(k, 2)
            do n = 1, 8
                c(n + 1) = c(n) * c(1) - s(n) * s(1)
                s(n + 1) = s(n) * c(1) + c(n) * s(1)
            end do
            q = strip%q(k)
            q2 = q * q
            q4 = q2 * q2
            q6 = q2 * q4
            theta3 = 2 * (q4 * c(4) + (q4 * q4)**2 * c(8))
            theta4 = 2 * (q * c(2) + q4 * q4 * q * c(6))
            sine = s(1) - q2 * s(3) + q6 * s(5) - q6 * q6 * s(7) + q6 * q6 * q6 * q2 * s(9)
            cosine = c(1) + q2 * c(3) + q6 * c(5) + q6 * q6 * c(7) + q6 * q6 * q6 * q2 * c(9)
            strip%elliptic(k, 1) = strip%factor(k, 1) * cosine / (1 + theta3 - theta4)
            strip%elliptic(k, 2) = strip%factor(k, 2) * sine / (1 + theta3 - theta4)
            strip%elliptic(k, 3) = strip%factor(k, 3) * (1 + theta3 + theta4) / (1 + theta3 - theta4)
        end do
    end subroutine find_values

end module spintop_free_strip
