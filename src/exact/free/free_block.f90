!> The exact motion of many free bodies together, in double precision.
!>
!> The cases are processed in strips by the stages of `free_strip` and `free_turns`, in loops that the compiler
!> vectorizes. A case that these loops may not compute accurately (close to the separatrix, about one fixed axis, past
!> a pole) is computed by the scalar routine, which works in extended precision and in all forms. The result of a case
!> has the same bits at every position in a block and for all neighbours.
!>
!>     block%n = 2;  block%inertia(1:2, :) = ...
!>     call block%compute(wants_end=.true., counts_turns=.false.)
!>     if (is_ok(block%status(1))) then; ... = block%constants(1)%period
module spintop_free_block
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, pi
    use spintop_array_functions, only: find_inclinations
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_exact_cases, only: block_size
    use spintop_exact_motion, only: exact_motion_t
    use spintop_free_motion, only: free_constants_t, prepare_free_motion
    use spintop_exact_pole, only: strip_length
    use spintop_free_strip, only: find_argument, find_axes, find_constants, find_rotation, find_series, find_values, &
        free_strip_t
    use spintop_free_turns, only: chord_angle, count_turns, find_attitude, free_attitude_t, prepare_attitude
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_status, only: is_ok, status_bad_input, status_non_finite, status_ok, status_step_limit
    implicit none
    private
    public :: free_block_t, block_size, free_block_accuracy

    !> Largest error of an attitude, rad, in addition to the effect of a change of all rates (or of the time) by eight
    !> rounding errors.
    real(dp), parameter :: free_block_accuracy = 1.0e-13_dp

    !> More chords are not followed in strips.
    real(dp), parameter :: most_chords = 1.0e6_dp

    !> Cases to be computed together, one per row of each array, SI units and radians.
    type :: free_block_t
        !> Number of cases, up to `block_size`.
        integer :: n = 0
        !> Data: moments of inertia, angular velocity in body axes, quaternion and angles at the start, and the end of the
        !> span, s.
        real(dp) :: inertia(block_size, 3) = 1, omega(block_size, 3) = 0, quaternion(block_size, 4) = 0, &
            angle(block_size, 3) = 0, t_end(block_size) = 0
        !> Largest number of steps in which turns are counted.
        integer(int64) :: most_steps(block_size) = huge(1_int64)
        !> What does not depend on time.
        type(free_constants_t) :: constants(block_size)
        !> At `t_end`: attitude, angular velocity in body axes, rad/s, angles, and nutation rate, rad/s.
        real(dp) :: quaternion_end(block_size, 4), omega_end(block_size, 3), angle_end(block_size, 3)
        real(dp) :: theta_rate_end(block_size)
        !> `status_ok`, a status of `prepare_exact_motion`, `status_step_limit`, or `status_non_finite`.
        integer :: status(block_size) = status_ok
        !> Number of cases that were computed by the scalar routine.
        integer :: fallbacks = 0
    contains
        procedure :: compute
    end type free_block_t

contains

    !> Computes all cases of the block: the quantities without time, and with `wants_end` the motion at `t_end`, with
    !> all turns of phi and psi if `counts_turns`. If `n` is not a possible number of cases, nothing is computed and
    !> every status is `status_bad_input`.
    subroutine compute(self, wants_end, counts_turns)
        class(free_block_t), intent(inout) :: self
        logical, intent(in) :: wants_end !! whether the motion at `t_end` is needed
        logical, intent(in) :: counts_turns !! whether phi and psi have all their turns
        type(free_strip_t), allocatable :: strip
        type(free_attitude_t), allocatable :: attitude
        integer :: place(strip_length), first, n, i

        self%fallbacks = 0
        if (self%n < 0 .or. self%n > block_size) then
            self%status = status_bad_input
            return
        end if
        allocate (strip, attitude)
        do first = 1, self%n, strip_length
            ! The last strip is filled with copies of the last case.
            place = min([(first + i, i=0, strip_length - 1)], self%n)
            n = min(strip_length, self%n - first + 1)
            strip%inertia = self%inertia(place, :)
            strip%omega = self%omega(place, :)
            call find_axes(strip)
            call find_constants(strip)
            call find_series(strip)
            call find_argument(strip)
            call describe_motion(self, place(:n), strip)
            if (wants_end) then
                attitude%start = self%quaternion(place, :)
                call describe_end(self, place, n, counts_turns, strip, attitude)
            end if
            self%status(place(:n)) = status_ok
            do i = 1, n
                if (strip%doubt(i) > 0) call compute_alone(self, place(i), wants_end, counts_turns)
            end do
        end do
    end subroutine compute

    !> The quantities without time.
    subroutine describe_motion(block, place, strip)
        type(free_block_t), intent(inout) :: block
        integer, intent(in) :: place(:)  !! of the cases of the strip
        type(free_strip_t), intent(inout) :: strip
        real(dp), dimension(strip_length) :: period, turn, least, greatest, low, high
        real(dp), dimension(strip_length, 2) :: sine, cosine
        real(dp) :: q3, q10, q21, g, small, above, dn
        logical :: x_is_3, z_is_3, against(strip_length)
        integer :: k

        !$omp simd private(q3, q10, q21, g, small, above, dn, x_is_3, z_is_3)
        do k = 1, strip_length
            associate (q => strip%q(k), a => strip%a(k), b => strip%b(k), c => strip%c(k), inertia => strip%inertia)
                q3 = q**3
                q10 = q3**3 * q
                q21 = q10**2 * q
                g = (strip%y(k) + strip%root(k)) / 2
                small = q / g
                above = 2 * small - q3 * (2 * g**3 + 4 * small**3) + q10 * (4 * g**5 + 6 * small**5) &
                        - q21 * (6 * g**7 + 8 * small**7)
                period(k) = 2 * pi / strip%rate(k)
                turn(k) = period(k) * (strip%momentum(k) / inertia(k, 1) &
                    + strip%side(k) * strip%rate(k) * (strip%slope(k) - above / strip%below(k)))
                dn = strip%complement(k) * c
                greatest(k) = strip%momentum(k) * sqrt((a / inertia(k, 1))**2 + (c / inertia(k, 3))**2)
                least(k) = strip%momentum(k) * sqrt((b / inertia(k, 2))**2 + (dn / inertia(k, 3))**2)
                x_is_3 = strip%axis(k, 1) > 2.5_dp
                z_is_3 = strip%axis(k, 3) > 2.5_dp
                ! Of the smallest angle between body z and the momentum, then of the largest, if z points along it.
                sine(k, 1) = merge(a, merge(c, dn, x_is_3), z_is_3)
                cosine(k, 1) = merge(c, merge(a, b, x_is_3), z_is_3)
                sine(k, 2) = merge(b, sine(k, 1), z_is_3)
                cosine(k, 2) = merge(dn, -cosine(k, 1), z_is_3)
                strip%doubt(k) = merge(strip%doubt(k), 1.0_dp, abs(period(k) + turn(k) + greatest(k)) <= huge(g))
            end associate
        end do
        call find_inclinations(strip_length, sine(:, 1), cosine(:, 1), low)
        call find_inclinations(strip_length, sine(:, 2), cosine(:, 2), high)
        against = nint(strip%axis(:, 3)) == 3 .and. strip%signs(:, 3) < 0
        do k = 1, size(place)
            block%constants(place(k)) = free_constants_t(least(k), greatest(k), [low(k), high(k)], period(k), turn(k), &
                                                         nint(strip%axis(k, 3)))
            if (against(k)) block%constants(place(k))%axis_angle = pi - [high(k), low(k)]
        end do
    end subroutine describe_motion

    !> The motion at the end of the span.
    subroutine describe_end(block, place, n, counts_turns, strip, attitude)
        type(free_block_t), intent(inout) :: block
        integer, intent(in) :: place(strip_length), n  !! of the cases of the strip, and how many of them are not copies
        logical, intent(in) :: counts_turns
        type(free_strip_t), intent(inout) :: strip
        type(free_attitude_t), intent(inout) :: attitude
        real(dp), dimension(strip_length, 2) :: rotation
        real(dp), dimension(strip_length, 3) :: along, omega
        real(dp), dimension(strip_length) :: duration, chords, sine, cosine, theta, theta_rate
        real(dp) :: u, w
        integer :: j, k

        duration = block%t_end(place)
        strip%turn = strip%start
        call find_values(strip, .false.)
        call prepare_attitude(strip, attitude)
        call find_rotation(strip%rate * duration, rotation, strip%doubt)
        strip%turn(:, 1) = strip%start(:, 1) * rotation(:, 1) - strip%start(:, 2) * rotation(:, 2)
        strip%turn(:, 2) = strip%start(:, 2) * rotation(:, 1) + strip%start(:, 1) * rotation(:, 2)
        call find_rotation(strip%phase_rate * duration, strip%phase, strip%doubt)
        call find_values(strip, .true.)
        call find_attitude(strip, attitude)
        along(:, 1) = strip%side * strip%a
        along(:, 2) = strip%b
        along(:, 3) = strip%c
        do j = 1, 3
            along(:, j) = strip%signs(:, j) * (strip%momentum * along(:, j) / strip%inertia(:, j)) * strip%elliptic(:, j)
        end do
        do j = 1, 3
            omega(:, j) = merge(along(:, 1), merge(along(:, 2), along(:, 3), nint(strip%axis(:, 2)) == j), &
                                nint(strip%axis(:, 1)) == j)
        end do
        do k = 1, strip_length
            associate (q => attitude%now)
                u = sqrt(q(k, 1)**2 + q(k, 4)**2)
                w = sqrt(q(k, 2)**2 + q(k, 3)**2)
                sine(k) = 2 * u * w
                cosine(k) = (u - w) * (u + w)
                ! cos(psi) and sin(psi) are the parts of (q0 + i q3) (q1 - i q2).
                theta_rate(k) = (omega(k, 1) * (q(k, 1) * q(k, 2) + q(k, 4) * q(k, 3)) &
                                 - omega(k, 2) * (q(k, 4) * q(k, 2) - q(k, 1) * q(k, 3))) / (u * w)
            end associate
        end do
        call find_inclinations(strip_length, sine, cosine, theta)
        block%quaternion_end(place(:n), :) = attitude%now(:n, :)
        block%omega_end(place(:n), :) = omega(:n, :)
        block%theta_rate_end(place(:n)) = theta_rate(:n)
        chords = max(1.0_dp, aint(block%constants(place)%greatest_rate * duration / chord_angle) + 1)
        if (counts_turns) strip%doubt = merge(strip%doubt, 1.0_dp, chords <= min(most_chords, real(block%most_steps(place), dp)))
        call count_turns(strip, attitude, duration, chords, counts_turns)
        along(:, 1) = block%angle(place, 1) + (attitude%angle(:, 1) + attitude%angle(:, 2))
        along(:, 2) = theta
        along(:, 3) = block%angle(place, 3) + (attitude%angle(:, 1) - attitude%angle(:, 2))
        block%angle_end(place(:n), :) = along(:n, :)
        strip%doubt = merge(strip%doubt, 1.0_dp, duration >= 0 .and. abs(theta_rate + sum(along, 2)) <= huge(u))
    end subroutine describe_end

    !> Computes a case by the scalar routine.
    subroutine compute_alone(self, i, wants_end, counts_turns)
        class(free_block_t), intent(inout) :: self
        integer, intent(in) :: i !! the case
        logical, intent(in) :: wants_end, counts_turns
        type(body_t) :: body
        type(motion_t) :: start, motion
        type(exact_motion_t) :: exact
        integer(int64) :: steps

        self%fallbacks = self%fallbacks + 1
        body%gravity = 0
        body%inertia = self%inertia(i, :)
        start = motion_from_quaternion(0.0_dp, self%quaternion(i, :), self%omega(i, :), self%angle(i, :))
        allocate (exact%free)
        call prepare_free_motion(body, start, exact%free, self%status(i))
        if (.not. is_ok(self%status(i))) return
        self%constants(i) = exact%free%free_constants_t
        if (.not. wants_end) return
        steps = 0
        if (counts_turns) then
            call exact%follow(start, self%t_end(i), motion, steps, self%most_steps(i))
        else
            motion = exact%at(self%t_end(i))
        end if
        self%quaternion_end(i, :) = motion%quaternion
        self%omega_end(i, :) = motion%omega
        self%angle_end(i, :) = motion%angle
        self%theta_rate_end(i) = motion%rate(2)
        if (.not. all(is_finite([motion%angle, motion%omega]))) then
            self%status(i) = merge(status_step_limit, status_non_finite, steps >= self%most_steps(i))
        end if
    end subroutine compute_alone

end module spintop_free_block
