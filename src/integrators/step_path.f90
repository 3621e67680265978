!> The motion within the last step of a run, by dense output, with angles that are followed through every turn, and the work of
!> effects along it.
module spintop_step_path
    use spintop_attitude, only: square_to_pole
    use spintop_events, only: path_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motion, only: motion_t, passages_t
    use spintop_motions, only: instants, motions_t
    use spintop_pole_passages, only: is_at_pole, settle_angles, through_pole
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: follower_t, step_path_t, work_account_t, go_to, motion_of_follower, walk_to

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
        real(dp) :: t = 0, y(max_states) = 0, angle(3) = 0
        !> Those in the axes in which the body was given, where they differ.
        real(dp) :: given_angle(3) = 0
        logical :: is_idle = .false.
        !> How far off a pole is passed through, rad, and the passages so far, in both kinds of axes.
        real(dp) :: reach(2) = 0
        !> How far off the motion may be, rad.
        real(dp) :: error = 0
        type(passages_t) :: passed = passages_t(), given_passed = passages_t()
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
            motion%given_angle = self%seen(1)%given_angle
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

    !> Moves to a later time and state.
    subroutine go_to(self, t, y)
        type(follower_t), intent(inout) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(follower_t) :: there
        logical :: sure
        call try(self, t, y, there, sure)
        self = there
    end subroutine go_to

    !> Moves to a state within the last step, in small increments where the axis passes a pole and the states
    !> in between are known.
    recursive subroutine walk_to(self, stepper, t, y)
        type(follower_t), intent(inout) :: self
        class(stepper_t), intent(inout) :: stepper !! the method that took the step
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(follower_t) :: there
        real(dp) :: middle
        logical :: sure

        if (self%is_idle) then
            self%t = t
            self%y = y
            return
        end if
        call try(self, t, y, there, sure)
        if (.not. sure) sure = t - self%t <= max(shortest_pace * (stepper%t - stepper%t_last), 2 * spacing(t)) &
                               .or. stepper%is_spent()
        if (sure) then
            self = there
        else
            middle = self%t + (t - self%t) / 2
            stepper%counts%looks = stepper%counts%looks + 1
            call walk_to(self, stepper, middle, stepper%interpolate(middle))
            call walk_to(self, stepper, t, y)
        end if
    end subroutine walk_to

    !> The follower at a later time and state.
    subroutine try(self, t, y, there, sure)
        type(follower_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        type(follower_t), intent(out) :: there
        logical, intent(out) :: sure  !! whether the turns are certain
        logical :: beside
        there = self
        there%t = t
        there%y = y
        sure = .true.
        if (self%is_idle) return
        call self%formulation%follow(self%t, self%y, t, y, there%angle, sure, beside)
        if (is_at_pole(sure, beside, self%passed, self%reach(1))) then
            call settle_angles(self%formulation%motion_without_angles(self%t, self%y), &
                               self%formulation%motion_without_angles(t, y), self%angle, self%reach(1), there%passed, &
                               there%angle, sure)
        end if
        ! Coordinates that are singular there keep their side of a pole. A plane motion passes through it.
        if (self%formulation%attitude > 0 .and. self%reach(1) <= through_pole) then
            call there%passed%watch(square_to_pole(y(self%formulation%attitude:self%formulation%attitude + 3)), self%error)
        end if
        if (self%formulation%body%given%differ) call try_given(self, there, sure)
    end subroutine try

    !> The same for the angles in the axes of the input.
    subroutine try_given(self, there, sure)
        type(follower_t), intent(in) :: self
        type(follower_t), intent(inout) :: there
        logical, intent(inout) :: sure
        type(motion_t) :: last, next
        logical :: also_sure
        last = self%formulation%motion_without_angles(self%t, self%y)
        last%given_angle = self%given_angle
        last%given_passed = self%given_passed
        next = self%formulation%motion_without_angles(there%t, there%y)
        call self%formulation%body%given%follow(last, next, self%reach(2), also_sure, &
                                           merge(self%error, 0.0_dp, self%reach(2) <= through_pole))
        there%given_angle = next%given_angle
        there%given_passed = next%given_passed
        sure = sure .and. also_sure
    end subroutine try_given

    !> The motion at the time of the follower.
    type(motion_t) function motion_of_follower(self) result(motion)
        type(follower_t), intent(in) :: self
        motion = self%formulation%motion(self%t, self%y, self%angle)
        ! In a pole the attitude does not tell phi and psi.
        if (self%passed%arrived) motion%angle(1:3:2) = self%angle(1:3:2)
        motion%given_angle = self%given_angle
        motion%passed = self%passed
        motion%given_passed = self%given_passed
    end function motion_of_follower

end module spintop_step_path
