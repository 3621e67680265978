!> The attitude of many free bodies along their motions, and the turns of phi and psi, in vector loops.
!>
!> The angles are those of two complex numbers: (phi + psi)/2 of q0 + i q3, (phi - psi)/2 of q1 + i q2. Their turns
!> are counted along short chords: a chord that passes zero at a larger distance than the path can leave it
!> turns about zero as the path does.
module spintop_free_turns
    use spintop_kinds, only: dp, pi
    use spintop_array_functions, only: find_arguments
    use spintop_exact_pole, only: strip_length
    use spintop_free_strip, only: find_rotation, find_values, free_strip_t
    implicit none
    private
    public :: free_attitude_t, prepare_attitude, find_attitude, count_turns, chord_angle

    !> Rotation in a chord, rad.
    real(dp), parameter :: chord_angle = 0.25_dp
    !> Distance by which a path of that rotation leaves its chord: h^2/8 times q'', which is less than |omega|^2/4 +
    !> |omega'|/2, and |omega'| is less than the largest |I_i - I_j|/I_k times |omega|^2/sqrt(3).
    real(dp), parameter :: steady_bend = chord_angle**2 / 8 / 4, moving_bend = chord_angle**2 / 8 / 2
    !> A start closer to a pole has no angles that could be followed here.
    real(dp), parameter :: near_pole = 1.0e-6_dp

    !> The attitudes of the motions of a strip.
    type :: free_attitude_t
        !> The attitude is this matrix times the quaternion relative to the momentum.
        real(dp), dimension(strip_length, 4, 4) :: matrix
        !> Attitude at the start, and now.
        real(dp), dimension(strip_length, 4) :: start, now
        !> (q0 + i q3) and (q1 + i q2) divided by those of the start, but for a factor, at the last chord's end; their
        !> turns so far, and their angles, rad.
        real(dp), dimension(strip_length, 4) :: last
        real(dp), dimension(strip_length, 2) :: turns, angle
    end type free_attitude_t

contains

    !> The matrix, from the attitude at the start and the strip's values there.
    pure subroutine prepare_attitude(strip, attitude)
        type(free_strip_t), intent(in) :: strip !! with F+ and F- at the start
        type(free_attitude_t), intent(inout) :: attitude !! `start` is given
        real(dp) :: u0, u1, u2, u3, r1, r2, r3, r0, x, y, z, per, q0, q1, q2, q3
        integer :: j, k
        do j = 1, 4
            !$omp simd private(u0, u1, u2, u3, r0, r1, r2, r3, x, y, z, per, q0, q1, q2, q3)
            do k = 1, strip_length
                per = 1 / sqrt(strip%square(k))
                u0 = strip%upper(k, 1) * per
                u1 = -strip%lower(k, 1) * per
                u2 = -strip%lower(k, 2) * per
                u3 = -strip%upper(k, 2) * per
                ! Its product with the unit 1, i, j or k.
                r0 = merge(u0, 0.0_dp, j == 1) - merge(u1, 0.0_dp, j == 2) - merge(u2, 0.0_dp, j == 3) - merge(u3, 0.0_dp, j == 4)
                r1 = merge(u1, 0.0_dp, j == 1) + merge(u0, 0.0_dp, j == 2) - merge(u3, 0.0_dp, j == 3) + merge(u2, 0.0_dp, j == 4)
                r2 = merge(u2, 0.0_dp, j == 1) + merge(u3, 0.0_dp, j == 2) + merge(u0, 0.0_dp, j == 3) - merge(u1, 0.0_dp, j == 4)
                r3 = merge(u3, 0.0_dp, j == 1) - merge(u2, 0.0_dp, j == 2) + merge(u1, 0.0_dp, j == 3) + merge(u0, 0.0_dp, j == 4)
                r1 = strip%signs(k, 1) * r1
                r2 = strip%signs(k, 2) * r2
                r3 = strip%signs(k, 3) * r3
                x = on_axis(1.0_dp, strip%axis(k, 1), strip%axis(k, 2), r1, r2, r3)
                y = on_axis(2.0_dp, strip%axis(k, 1), strip%axis(k, 2), r1, r2, r3)
                z = on_axis(3.0_dp, strip%axis(k, 1), strip%axis(k, 2), r1, r2, r3)
                q0 = attitude%start(k, 1)
                q1 = attitude%start(k, 2)
                q2 = attitude%start(k, 3)
                q3 = attitude%start(k, 4)
                attitude%matrix(k, 1, j) = q0 * r0 - q1 * x - q2 * y - q3 * z
                attitude%matrix(k, 2, j) = q0 * x + q1 * r0 + q2 * z - q3 * y
                attitude%matrix(k, 3, j) = q0 * y - q1 * z + q2 * r0 + q3 * x
                attitude%matrix(k, 4, j) = q0 * z + q1 * y - q2 * x + q3 * r0
            end do
        end do
    end subroutine prepare_attitude

    !> The component along a body axis.
    pure real(dp) function on_axis(number, first, second, x, y, z)
        real(dp), value :: number !! of the body axis
        real(dp), value :: first, second !! numbers of the axes x and y
        real(dp), value :: x, y, z !! components along the axes x, y, z
        on_axis = merge(x, merge(y, z, abs(second - number) <= 0), abs(first - number) <= 0)
    end function on_axis

    !> The attitude now, from the strip's values and exp(i chi).
    pure subroutine find_attitude(strip, attitude)
        type(free_strip_t), intent(in) :: strip !! with F+, F- and exp(i chi) now
        type(free_attitude_t), intent(inout) :: attitude !! `now` is set
        real(dp) :: per, u0, u1, u2, u3
        integer :: k
        !$omp simd private(per, u0, u1, u2, u3)
        do k = 1, strip_length
            per = 1 / sqrt(strip%square(k))
            associate (m => attitude%matrix, now => attitude%now, c => strip%phase(k, 1), s => strip%phase(k, 2))
                u0 = (c * strip%upper(k, 1) - s * strip%upper(k, 2)) * per
                u3 = (s * strip%upper(k, 1) + c * strip%upper(k, 2)) * per
                u1 = (c * strip%lower(k, 1) - s * strip%lower(k, 2)) * per
                u2 = (s * strip%lower(k, 1) + c * strip%lower(k, 2)) * per
                now(k, 1) = m(k, 1, 1) * u0 + m(k, 1, 2) * u1 + m(k, 1, 3) * u2 + m(k, 1, 4) * u3
                now(k, 2) = m(k, 2, 1) * u0 + m(k, 2, 2) * u1 + m(k, 2, 3) * u2 + m(k, 2, 4) * u3
                now(k, 3) = m(k, 3, 1) * u0 + m(k, 3, 2) * u1 + m(k, 3, 3) * u2 + m(k, 3, 4) * u3
                now(k, 4) = m(k, 4, 1) * u0 + m(k, 4, 2) * u1 + m(k, 4, 3) * u2 + m(k, 4, 4) * u3
            end associate
        end do
    end subroutine find_attitude

    !> The change of (phi + psi)/2 and (phi - psi)/2 up to the time at which attitude and strip are now. With
    !> `all_turns` they have their turns; otherwise they are less than pi.
    pure subroutine count_turns(strip, attitude, duration, chords, all_turns)
        type(free_strip_t), intent(inout) :: strip !! doubtful where a path may pass zero
        type(free_attitude_t), intent(inout) :: attitude !! `angle` is set
        real(dp), intent(in) :: duration(strip_length) !! the time, s
        real(dp), intent(in) :: chords(strip_length) !! number of chords, each of at most `chord_angle`
        logical, intent(in) :: all_turns !! whether to count turns
        real(dp), dimension(strip_length, 4) :: arrival
        real(dp), dimension(strip_length, 2) :: along_z, along_chi
        real(dp), dimension(strip_length) :: active, bend, distance, angle
        integer :: n

        arrival = attitude%now
        attitude%turns = 0
        if (all_turns) then
            bend = steady_bend + moving_bend * coupling(strip)
            attitude%last = 0
            attitude%last(:, 1) = hypot_of(attitude%start(:, 1), attitude%start(:, 4))
            attitude%last(:, 3) = hypot_of(attitude%start(:, 2), attitude%start(:, 3))
            call find_rotation(strip%rate * duration / chords, along_z, strip%doubt)
            call find_rotation(strip%phase_rate * duration / chords, along_chi, strip%doubt)
            strip%turn = strip%start
            strip%phase(:, 1) = 1
            strip%phase(:, 2) = 0
            do n = 1, nint(maxval(merge(chords, 1.0_dp, strip%doubt <= 0))) - 1
                active = merge(1.0_dp, 0.0_dp, n < chords)
                call advance(strip%turn, along_z)
                call advance(strip%phase, along_chi)
                call find_values(strip, .false.)
                call find_attitude(strip, attitude)
                call count_passages(attitude, bend, active, strip%doubt)
            end do
            active = 1
            attitude%now = arrival
            call count_passages(attitude, bend, active, strip%doubt)
        else
            call divide_by_start(attitude, attitude%last)
        end if
        do n = 1, 2
            distance = abs(attitude%last(:, 2 * n - 1))
            call find_arguments(strip_length, distance, attitude%last(:, 2 * n), angle)
            where (attitude%last(:, 2 * n - 1) < 0) angle = sign(pi, attitude%last(:, 2 * n)) - angle
            attitude%angle(:, n) = angle + 2 * pi * attitude%turns(:, n)
        end do
        strip%doubt = merge(strip%doubt, 1.0_dp, min(hypot_of(attitude%start(:, 1), attitude%start(:, 4)), &
                                                     hypot_of(attitude%start(:, 2), attitude%start(:, 3))) > near_pole)
    end subroutine count_turns

    !> Largest |I_i - I_j|/I_k.
    pure function coupling(strip)
        type(free_strip_t), intent(in) :: strip
        real(dp) :: coupling(strip_length)
        associate (i => strip%inertia)
            coupling = max(abs(i(:, 2) - i(:, 3)) / i(:, 1), abs(i(:, 3) - i(:, 1)) / i(:, 2), abs(i(:, 1) - i(:, 2)) / i(:, 3))
        end associate
    end function coupling

    elemental real(dp) function hypot_of(x, y)
        real(dp), intent(in) :: x, y
        hypot_of = sqrt(x**2 + y**2)
    end function hypot_of

    !> Turns unit numbers by others.
    pure subroutine advance(number, by)
        real(dp), intent(inout) :: number(strip_length, 2)
        real(dp), intent(in) :: by(strip_length, 2)
        real(dp) :: re
        integer :: k
        !$omp simd private(re)
        do k = 1, strip_length
            re = number(k, 1) * by(k, 1) - number(k, 2) * by(k, 2)
            number(k, 2) = number(k, 2) * by(k, 1) + number(k, 1) * by(k, 2)
            number(k, 1) = re
        end do
    end subroutine advance

    !> Both complex numbers times the conjugates of the start's directions.
    pure subroutine divide_by_start(attitude, numbers)
        type(free_attitude_t), intent(in) :: attitude
        real(dp), intent(out) :: numbers(strip_length, 4)
        real(dp) :: per
        integer :: k
        !$omp simd private(per)
        do k = 1, strip_length
            associate (q => attitude%now, s => attitude%start)
                per = 1 / sqrt(s(k, 1)**2 + s(k, 4)**2)
                numbers(k, 1) = (q(k, 1) * s(k, 1) + q(k, 4) * s(k, 4)) * per
                numbers(k, 2) = (q(k, 4) * s(k, 1) - q(k, 1) * s(k, 4)) * per
                per = 1 / sqrt(s(k, 2)**2 + s(k, 3)**2)
                numbers(k, 3) = (q(k, 2) * s(k, 2) + q(k, 3) * s(k, 3)) * per
                numbers(k, 4) = (q(k, 3) * s(k, 2) - q(k, 2) * s(k, 3)) * per
            end associate
        end do
    end subroutine divide_by_start

    !> Counts the passages of the negative axis by a chord.
    pure subroutine count_passages(attitude, bend, active, doubt)
        type(free_attitude_t), intent(inout) :: attitude
        real(dp), intent(in) :: bend(strip_length), active(strip_length)
        real(dp), intent(inout) :: doubt(strip_length)
        real(dp), dimension(strip_length, 4) :: there
        real(dp) :: x, y, across, along, square, other, length, distance, count
        integer :: k, n
        call divide_by_start(attitude, there)
        do n = 1, 2
            !$omp simd private(x, y, across, along, square, other, length, distance, count)
            do k = 1, strip_length
                x = attitude%last(k, 2 * n - 1)
                y = attitude%last(k, 2 * n)
                across = x * there(k, 2 * n) - y * there(k, 2 * n - 1)
                along = x * there(k, 2 * n - 1) + y * there(k, 2 * n)
                square = x**2 + y**2
                other = there(k, 2 * n - 1)**2 + there(k, 2 * n)**2
                length = square + other - 2 * along
                ! The point of the chord that is closest to zero may lie between its ends.
                distance = merge(across**2 / length, min(square, other), along < min(square, other))
                count = merge(1.0_dp, 0.0_dp, y >= 0 .and. there(k, 2 * n) < 0 .and. across > 0) &
                        - merge(1.0_dp, 0.0_dp, y < 0 .and. there(k, 2 * n) >= 0 .and. across < 0)
                attitude%turns(k, n) = attitude%turns(k, n) + active(k) * count
                doubt(k) = merge(doubt(k), 1.0_dp, distance > bend(k)**2 .or. active(k) <= 0)
                attitude%last(k, 2 * n - 1) = merge(there(k, 2 * n - 1), x, active(k) > 0)
                attitude%last(k, 2 * n) = merge(there(k, 2 * n), y, active(k) > 0)
            end do
        end do
    end subroutine count_passages

end module spintop_free_turns
