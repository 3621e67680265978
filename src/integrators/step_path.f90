!> The motion within the last step of a run, by dense output, with angles that are followed through every turn, and the work of
!> effects along it.
module spintop_step_path
    use spintop_body, only: body_t
    use spintop_events, only: path_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t
    use spintop_stepper, only: stepper_t
    use spintop_turn_counter, only: new_turn_counter, turn_counter_t
    implicit none
    private
    public :: follower_t, step_path_t, work_account_t, follow_from, go_to, motion_of_follower, walk_to

    !> The work since the start.
    type :: work_account_t
        !> Whether work is counted.
        logical :: is_open = .false.
        !> Time up to which it is counted, s, and the work until then by its parts, J.
        real(dp) :: t = 0, total(works) = 0
        !> Compensation term of the sums (Kahan).
        real(dp), private :: rest(works) = 0
    contains
        procedure :: go_to => count_until
    end type work_account_t

    !> Nodes and weights of the Gauss-Legendre rule of 8 points on [-1, 1]. The series of a Taylor step converges over nearly
    !> twice its length, so the error is at the level of rounding.
    integer, parameter :: pairs = instants / 2
    real(dp), parameter :: positive(pairs) = [ &
        0.18343464249564980494_dp, 0.52553240991632898582_dp, 0.79666647741362673959_dp, 0.96028985649753623168_dp]
    real(dp), parameter :: node(instants) = [positive, -positive]
    real(dp), parameter :: weight(pairs) = [ &
        0.36268378337836198297_dp, 0.31370664587788728734_dp, 0.22238103445337447054_dp, 0.10122853629037625915_dp]

    !> The angles, followed through every step, or constant.
    type :: follower_t
        real(dp) :: t = 0, y(max_states) = 0
        !> Angles near those of the motion in the axes of the computation, rad.
        real(dp) :: near(3) = 0
        type(turn_counter_t) :: turns
        !> Whether the last instant of these is complete, with the angular acceleration, for a body that may meet a pole.
        logical :: knows_rate = .false.
        logical :: is_idle = .false.
        class(formulation_t), pointer :: formulation => null()
    end type follower_t

    !> The motion within the last step, by dense output.
    type, extends(path_t) :: step_path_t
        class(stepper_t), pointer :: stepper => null()
        !> The work of effects up to the start of the step, if it is wanted.
        type(work_account_t), pointer :: account => null()
        !> Angles at the start of the step, and at the two latest times of evaluation. They are followed to a
        !> new time from the latest of these before it.
        type(follower_t) :: seen(3)
    contains
        procedure :: at => motion_in_step
        procedure :: at_several => attitudes_in_step
        procedure :: begin_step
        procedure :: work_until => work_in_step
        procedure :: is_spent => step_is_spent
    end type step_path_t

    !> A pole that is passed within this fraction of a step is passed on an arbitrary side.
    real(dp), parameter :: shortest_pace = 1.0e-12_dp

contains

    !> Counts the work up to a time within the last step.
    subroutine count_until(self, stepper, t)
        class(work_account_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! the method, after the step
        real(dp), intent(in) :: t !! time within the last step, s
        real(dp) :: half, times(instants), y(instants, max_states), power(instants, works), sum, change, new
        integer :: part

        if (.not. t > self%t) return
        half = (t - self%t) / 2
        times = self%t + half + node * half
        call stepper%states_within(times, y)
        call stepper%formulation%action%find_powers(times, y, power)
        do part = 1, works
            sum = dot_product(weight, power(:pairs, part) + power(pairs + 1:, part))
            change = half * sum + self%rest(part)
            new = self%total(part) + change
            self%rest(part) = change - (new - self%total(part))
            self%total(part) = new
        end do
        self%t = t
    end subroutine count_until

    !> The motion at a time within the last step. Without angles nothing is followed.
    subroutine motion_in_step(self, t, motion, with_angles)
        class(step_path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time within the last step, s
        type(motion_t), intent(out) :: motion !! at that time
        logical, intent(in), optional :: with_angles !! whether angles are needed
        type(follower_t) :: follower
        real(dp) :: y(max_states)
        logical :: follows
        follows = .true.
        if (present(with_angles)) follows = with_angles
        self%stepper%counts%looks = self%stepper%counts%looks + 1
        y = self%stepper%interpolate(t)
        if (follows) then
            follower = self%seen(max(1, count(self%seen%t <= t)))
            call walk_to(follower, self%stepper, t, y)
            motion = motion_of_follower(follower)
            if (t > self%seen(3)%t) self%seen(2:3) = [self%seen(3), follower]
        else
            motion = self%stepper%formulation%motion_without_angles(t, y)
            motion%given_angle = self%seen(1)%turns%last%angle
        end if
    end subroutine motion_in_step

    !> The same at several instants.
    subroutine attitudes_in_step(self, t, used, motions)
        class(step_path_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times within the last step, s
        integer, intent(in) :: used !! how many of them are different: those that count as work
        type(motions_t), intent(out) :: motions !! the motion at these times
        real(dp) :: y(instants, max_states)
        self%stepper%counts%looks = self%stepper%counts%looks + used
        call self%stepper%states_within(t, y)
        call self%stepper%formulation%find_motions(t, y, motions)
    end subroutine attitudes_in_step

    !> Begins with the last step, at the beginning of which the angles are known. Where it is a series its terms bound the
    !> angular velocity.
    subroutine begin_step(self, stepper, follower)
        class(step_path_t), intent(inout) :: self
        class(stepper_t), pointer, intent(in) :: stepper !! what took the step
        type(follower_t), intent(in) :: follower !! the angles
        real(dp) :: change(max_states)
        self%stepper => stepper
        self%seen = follower
        change = stepper%bound_of_changes()
        self%greatest_rate = 0
        associate (first => stepper%formulation%momentum)
            if (first == 0 .or. .not. all(change < huge(change))) return
            self%greatest_rate = sqrt(sum(((abs(stepper%y_last(first:first + 2)) + change(first:first + 2)) &
                                           / stepper%formulation%body%inertia)**2))
        end associate
    end subroutine begin_step

    !> The work of effects up to a time within the last step.
    function work_in_step(self, t) result(work)
        class(step_path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time within the last step, s
        real(dp) :: work(works)
        type(work_account_t) :: account
        work = 0
        if (.not. associated(self%account)) return
        account = self%account
        call account%go_to(self%stepper, t)
        work = account%total
    end function work_in_step

    !> Whether the allowed work of the case is used up.
    logical function step_is_spent(self)
        class(step_path_t), intent(in) :: self
        step_is_spent = self%stepper%is_spent()
    end function step_is_spent

    !> The angles at the start of a motion, from where they are followed unless they are `idle`.
    type(follower_t) function follow_from(formulation, body, start, y, is_idle) result(self)
        class(formulation_t), pointer, intent(in) :: formulation !! the equations of motion
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: y(max_states) !! the state there
        logical, intent(in) :: is_idle !! whether angles stay as they are
        type(motion_t) :: first
        self%formulation => formulation
        self%is_idle = is_idle
        self%y = y
        self%near = start%angle
        if (is_idle) then
            self%turns%last%angle = start%given_angle
            return
        end if
        self%turns = new_turn_counter(body, start)
        if (body%given%differ) then
            first = formulation%motion_without_angles(0.0_dp, y)
            first%given_angle = start%given_angle
            call self%turns%start_at(first)
        else if (formulation%attitude > 0) then
            call formulation%find_attitude(0.0_dp, y, self%turns%last)
            self%turns%spin = real(formulation%sigma, dp)
        end if
    end function follow_from

    !> Moves to a later time and state; if `sure` is present, only where the turns are certain.
    subroutine go_to(self, t, y, sure)
        type(follower_t), intent(inout) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        logical, intent(out), optional :: sure !! whether the turns are certain
        type(motion_t) :: next
        logical :: is_sure, meets_pole

        is_sure = .true.
        meets_pole = .false.
        associate (formulation => self%formulation, turns => self%turns)
            if (.not. self%is_idle .and. turns%axes%differ) then
                next = formulation%motion_without_angles(t, y)
                call turns%advance(next, is_sure, is_forced=.not. present(sure))
            else if (.not. self%is_idle .and. formulation%attitude > 0) then
                next%t = t
                next%quaternion = y(formulation%attitude:formulation%attitude + 3)
                call formulation%kinematics(t, y, next%omega)
                meets_pole = turns%may_meet_pole(next)
                if (meets_pole) then
                    if (.not. self%knows_rate) call formulation%find_attitude(self%t, self%y, turns%last)
                    call formulation%find_attitude(t, y, next)
                end if
                call turns%advance(next, is_sure, is_forced=.not. present(sure), meets_pole=meets_pole)
                self%near = turns%last%angle
            end if
        end associate
        if (present(sure)) sure = is_sure
        if (present(sure) .and. .not. is_sure) return
        self%knows_rate = meets_pole
        self%t = t
        self%y = y
    end subroutine go_to

    !> Moves to a state within the last step, in small increments where the axis passes a pole and the states
    !> in between are known.
    recursive subroutine walk_to(self, stepper, t, y)
        type(follower_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! the method that took the step
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp) :: middle
        logical :: sure

        call go_to(self, t, y, sure)
        if (sure) return
        if (t - self%t <= max(shortest_pace * (stepper%t - stepper%t_last), 2 * spacing(t)) .or. stepper%is_spent()) then
            call go_to(self, t, y)
        else
            middle = self%t + (t - self%t) / 2
            stepper%counts%looks = stepper%counts%looks + 1
            call walk_to(self, stepper, middle, stepper%interpolate(middle))
            call walk_to(self, stepper, t, y)
        end if
    end subroutine walk_to

    !> The motion at the time of the follower.
    type(motion_t) function motion_of_follower(self) result(motion)
        type(follower_t), intent(in) :: self
        motion = self%formulation%motion(self%t, self%y, self%near)
        motion%given_angle = self%turns%last%angle
        motion%passed = self%turns%last%passed
        ! In a pole the attitude does not tell phi and psi.
        if (motion%passed%arrived .and. .not. self%turns%axes%differ) motion%angle(1:3:2) = self%near(1:3:2)
    end function motion_of_follower

end module spintop_step_path
