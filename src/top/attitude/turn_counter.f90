!> phi and psi with all their turns, and the passages of body z through the poles: counted from one instant of a motion to
!> the next, along the steps of a method, and along exact motions whose angles have no closed form.
!>
!>     turns = new_turn_counter(body, start)
!>     call turns%advance(next, sure, is_forced=.false.)  ! if sure turns%last is that instant; else one in between is needed
!>
!> The angles of two sets of body axes turn differently: where the axis of one set circles about the vertical that of the
!> other may not. They are counted in the axes in which the body was given.
module spintop_turn_counter
    use spintop_attitude, only: angles_from_quaternion, follow_angles, may_meet_pole, square_to_pole
    use spintop_body, only: body_t
    use spintop_given_axes, only: given_axes_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: pass_pole, through_pole
    use spintop_poles, only: reach_of
    implicit none
    private
    public :: turn_counter_t, new_turn_counter

    !> The turns up to an instant.
    type :: turn_counter_t
        !> The instant, as seen in the axes in which turns are counted, with phi, theta and psi there, and the passages.
        type(motion_t) :: last
        !> These axes, where they are not those of the computation.
        type(given_axes_t) :: axes
        !> What is left out of the spin of the attitudes that are counted, but not of psi, rad/s.
        real(dp) :: spin = 0
        !> How far off a pole is passed through, and how far off the motion may be, rad.
        real(dp) :: reach = through_pole, error = 0
    contains
        procedure :: start_at
        procedure :: may_meet_pole => may_meet_pole_before
        procedure :: advance
        procedure :: angle
    end type turn_counter_t

contains

    !> The turns of a body at the start of its motion.
    pure type(turn_counter_t) function new_turn_counter(body, start) result(turns)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: reach(2)
        reach = reach_of(body, start)
        turns%axes = body%given
        turns%reach = reach(merge(2, 1, body%given%differ))
        call turns%start_at(start)
    end function new_turn_counter

    !> Begins at an instant whose angles and passages are known.
    pure subroutine start_at(self, motion)
        class(turn_counter_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion, in the axes of the computation
        self%last = motion
        if (.not. self%axes%differ) return
        self%last = self%axes%seen(motion)
        self%last%angle = motion%given_angle
    end subroutine start_at

    !> Whether body z may meet a pole before an instant. Elsewhere `advance` needs neither unit quaternions nor accelerations.
    pure logical function may_meet_pole_before(self, next) result(may)
        class(turn_counter_t), intent(in) :: self
        type(motion_t), intent(in) :: next !! the instant, in the axes in which turns are counted
        associate (last => self%last)
            may = last%passed%arrived .or. self%reach > through_pole &
                .or. may_meet_pole(last%quaternion, last%omega, next%quaternion, next%omega, abs(next%t - last%t))
        end associate
    end function may_meet_pole_before

    !> Counts the turns up to the next instant of a motion. They are not sure if the body may rotate so far in between that its
    !> attitudes do not tell, or if body z may meet a pole on either side; then the counter stays where it is.
    pure subroutine advance(self, next, sure, is_forced, meets_pole)
        class(turn_counter_t), intent(inout) :: self
        type(motion_t), intent(inout) :: next
            !! the instant in the axes of the computation, whose angles are not used; on return as `last` will be
        logical, intent(out) :: sure !! whether the turns are certain
        logical, intent(in) :: is_forced !! whether the counter advances also where they are not
        logical, intent(in), optional :: meets_pole !! `may_meet_pole`, where that was asked before
        !> Rotation that attitudes tell in axes other than the principal ones, rad; one that is followed in no case.
        real(dp), parameter :: largest_turn = 1.0_dp, endless_turn = 1.0e4_dp
        real(dp) :: start(3), rates(3, 2), turn
        logical :: beside, passes, may_meet

        associate (last => self%last, h => abs(next%t - self%last%t))
            turn = 0
            if (self%axes%differ) then
                next = self%axes%seen(next)
                turn = h * sqrt(max(sum(last%omega**2), sum(next%omega**2)))
                ! Of both quaternions of an attitude, the one that the motion reaches.
                if (turn <= largest_turn .and. dot_product(last%quaternion, next%quaternion) < 0) next%quaternion = -next%quaternion
            end if
            next%passed = last%passed
            start = [last%angle(1:2), last%angle(3) - self%spin * last%t]
            next%angle = start
            if (present(meets_pole)) then
                may_meet = meets_pole
            else
                may_meet = self%may_meet_pole(next)
            end if
            if (may_meet) then
                rates(:, 1) = last%omega_rate
                rates(:, 2) = next%omega_rate
                call follow_angles(last%quaternion, last%omega, next%quaternion, next%omega, h, next%angle, sure, beside, rates)
                ! Where body z was in a pole or is beside one, or passes through it at a distance, a passage settles the angles.
                if (beside .or. next%passed%arrived .or. self%reach > through_pole .or. .not. sure) then
                    sure = sure .and. .not. next%passed%arrived
                    call pass_pole(last, next, self%reach, next%passed, start, passes)
                    if (passes) next%angle = start
                    sure = sure .or. passes
                end if
            else
                call follow_angles(last%quaternion, last%omega, next%quaternion, next%omega, h, next%angle, sure, beside)
            end if
            sure = sure .and. .not. (turn > largest_turn .and. turn <= endless_turn)
        end associate
        ! A plane motion passes through the poles.
        if (self%reach <= through_pole) call next%passed%watch(square_to_pole(next%quaternion), self%error)
        next%angle(3) = next%angle(3) + self%spin * next%t
        if (sure .or. is_forced) self%last = next
    end subroutine advance

    !> phi, theta and psi of the attitude, rad, with the turns that were counted. In a pole it does not tell them.
    pure function angle(self)
        class(turn_counter_t), intent(in) :: self
        real(dp) :: angle(3)
        angle = self%last%angle
        if (.not. self%last%passed%arrived) angle = angles_from_quaternion(self%last%quaternion, angle)
    end function angle

end module spintop_turn_counter
