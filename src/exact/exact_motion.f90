!> The exact motion of a rigid body, where it has a closed form: that of an undamped symmetric top (Lagrange top)
!> or that of a free body.
!>
!>     call prepare_exact_motion(body, start, exact, status)
!>     motion = exact%at(2.0_dp)
module spintop_exact_motion
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, no_number, is_finite, is_zero
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_free_motion, only: free_motion_t, prepare_free_motion
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_non_finite, status_unsuitable
    use spintop_symmetric_motion, only: prepare_symmetric_motion, symmetric_angles, symmetric_at, symmetric_motion_t, &
        symmetric_quaternion
    use spintop_turn_counter, only: new_turn_counter, turn_counter_t
    implicit none
    private
    public :: exact_motion_t, prepare_exact_motion

    !> The exact solution for one body and one start. It does not change after its preparation, so threads may
    !> share it.
    type, extends(symmetric_motion_t) :: exact_motion_t
        !> The motion of a free body that is not a symmetric top.
        type(free_motion_t), allocatable :: free
        !> Where turns are counted along the motion: the counter at the start, and a bound of the angular velocity, rad/s.
        type(turn_counter_t), private :: turns
        real(dp), private :: greatest_rate = 0
    contains
        procedure :: at
        procedure :: find_angles
        procedure :: quaternion_at
        procedure :: has_to_follow
        procedure :: follow
    end type exact_motion_t

contains

    !> Prepares the exact solution of `body` from `start`. `status` is `status_unsuitable` for a body without
    !> closed form, or `status_non_finite`, `status_bad_body` or `status_bad_start`.
    !>
    !> With a rotor the body is a gyrostat, a carrier with a symmetric rotor whose momentum relative to the carrier is
    !> constant; the inertia is that of both. There is a closed form for a Lagrange top with the rotor on its
    !> axis: all of its equations hold with (I3 omega3 + h)/I1 instead of I3 omega3/I1.
    pure subroutine prepare_exact_motion(body, start, exact, status, rotor)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(exact_motion_t), intent(out) :: exact !! the exact solution; evaluated with `exact%at(t)`
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(in), optional :: rotor(3) !! constant momentum of a rotor, body axes, kg m^2/s
        if (present(rotor)) then
            status = merge(status_unsuitable, status_non_finite, all(is_finite(rotor)))
            if (.not. all(is_zero(rotor))) then
                if (is_finite(rotor(3)) .and. all(is_zero(rotor(1:2))) .and. body%is_lagrange()) then
                    call prepare_symmetric_motion(body, start, exact%symmetric_motion_t, status, rotor(3))
                end if
                return
            end if
        end if
        if (body%is_lagrange() .or. .not. body%is_free()) then
            call prepare_symmetric_motion(body, start, exact%symmetric_motion_t, status)
        else
            allocate (exact%free)
            call prepare_free_motion(body, start, exact%free, status)
            if (.not. is_ok(status)) deallocate (exact%free)
        end if
        if (.not. is_ok(status) .or. .not. (allocated(exact%free) .or. body%given%differ)) return
        exact%turns = new_turn_counter(body, start)
        exact%greatest_rate = greatest_rate(exact, body, start)
    end subroutine prepare_exact_motion

    !> A bound of the angular velocity in the given axes, rad/s. That across the axis of a top is largest where the axis
    !> hangs down.
    pure real(dp) function greatest_rate(exact, body, start)
        type(exact_motion_t), intent(in) :: exact
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp) :: height
        if (allocated(exact%free)) then
            greatest_rate = exact%free%greatest_rate
        else
            associate (gamma => vertical_from_quaternion(start%quaternion))
                height = 1 + gamma(3)
            end associate
            greatest_rate = sqrt(sum(start%omega**2) + 2 * body%mgl() * max(height, 0.0_dp) / body%inertia(1))
        end if
        greatest_rate = greatest_rate + abs(body%given%phi_shift) + abs(body%given%psi_shift)
    end function greatest_rate

    !> The motion at time t, s, or at an array of times. Its attitude is NaN at a time that is not finite, and
    !> for a solution that was not prepared. phi and psi have all their turns since the start; those of a free
    !> body that is not a symmetric top are the values nearest to the start, and `follow` counts their turns. Where the body
    !> was given in other axes, `given_angle` are the angles there at the start, and `follow` gives those of the time.
    elemental type(motion_t) function at(self, t) result(motion)
        class(exact_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        if (allocated(self%free)) then
            motion = self%free%at(t)
        else
            motion = symmetric_at(self%symmetric_motion_t, t)
        end if
        if (self%turns%axes%differ) motion%given_angle = self%turns%last%angle
    end function at

    !> The angles and their rates at time t, s, as `at` gives them. For a symmetric top this is faster.
    pure subroutine find_angles(self, t, angle, rate)
        class(exact_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(out) :: angle(3), rate(3) !! phi, theta, psi, rad, and their rates, rad/s
        type(motion_t) :: motion
        if (allocated(self%free)) then
            motion = self%free%at(t)
            angle = motion%angle
            rate = motion%rate
        else
            call symmetric_angles(self%symmetric_motion_t, t, angle, rate)
        end if
    end subroutine find_angles

    !> The unit quaternion at time t, s.
    pure function quaternion_at(self, t) result(q)
        class(exact_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: q(4)
        if (allocated(self%free)) then
            q = self%free%quaternion_at(t)
        else
            q = symmetric_quaternion(self%symmetric_motion_t, t)
        end if
    end function quaternion_at

    !> Whether turns of phi and psi are counted by `follow`. Otherwise `at` gives all of them.
    pure logical function has_to_follow(self)
        class(exact_motion_t), intent(in) :: self
        has_to_follow = allocated(self%free) .or. self%turns%axes%differ
    end function has_to_follow

    !> The motion at time t, s. The turns of phi and psi are those of `last`, an instant of the same solution, and
    !> those since then; where the body was given in other axes they are those of `given_angle`. For a free body, and in other
    !> axes, they are counted by steps of a fraction of a turn; if more than `most_steps` were needed, the angles are NaN.
    pure subroutine follow(self, last, t, motion, steps, most_steps)
        class(exact_motion_t), intent(in) :: self
        type(motion_t), intent(in) :: last !! an instant of the motion
        real(dp), intent(in) :: t !! time, s
        type(motion_t), intent(out) :: motion !! the motion at that time
        integer(int64), intent(inout) :: steps !! work so far, in instants computed before that time
        integer(int64), intent(in) :: most_steps !! bound of `steps`
        !> Rotation in a step, rad, and the smallest fraction of it that is tried where the axis meets a pole.
        real(dp), parameter :: longest = 0.5_dp, shortest = 1.0e-12_dp
        type(turn_counter_t) :: turns
        type(motion_t) :: next
        real(dp) :: pace, step
        logical :: sure

        motion = self%at(t)
        if (.not. self%has_to_follow()) return
        turns = self%turns
        call turns%start_at(last)
        pace = longest / max(self%greatest_rate, tiny(pace))
        step = pace
        do while (abs(t - turns%last%t) > 0)
            next = motion
            if (step < abs(t - turns%last%t)) then
                if (steps >= most_steps) then
                    motion%angle = no_number
                    motion%given_angle = no_number
                    return
                end if
                steps = steps + 1
                next = self%at(turns%last%t + sign(step, t - turns%last%t))
            end if
            call turns%advance(next, sure, is_forced=step < shortest * pace)
            if (sure .or. step < shortest * pace) then
                step = min(2 * step, pace)
            else
                step = min(step, abs(t - turns%last%t)) / 2
            end if
        end do
        motion%passed = turns%last%passed
        if (turns%axes%differ) then
            motion%given_angle = turns%angle()
        else
            motion%angle = turns%angle()
        end if
    end subroutine follow

end module spintop_exact_motion
