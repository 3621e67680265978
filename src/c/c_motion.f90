!> A motion that is asked for its columns at any times: in closed form, or integrated up to the last of them. It does not
!> change after it was prepared, so threads may share it.
module spintop_c_motion
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_kinds, only: dp, no_number
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t
    use spintop_row_maker, only: row_maker_t
    use spintop_status, only: is_good_end, is_ok, status_bad_samples, status_non_finite, status_ok, status_step_limit
    use spintop_stepper, only: looks_per_step
    use spintop_trajectory_columns, only: trajectory_column_t
    implicit none
    private
    public :: asked_motion_t

    !> A motion, and the columns for which it is asked.
    type :: asked_motion_t
        !> Number of the columns.
        integer :: columns = 0
        type(case_t), private :: case
        type(plan_t), private :: plan
        type(exact_motion_t), private :: exact
        !> Why there is no exact motion, if there is none.
        integer, private :: status = status_ok
        !> Gives the values of the columns; each call uses a copy.
        type(row_maker_t), private :: maker
        !> Whether phi or psi is among the columns.
        logical, private :: counts_turns = .false.
    contains
        procedure :: prepare
        procedure :: find
    end type asked_motion_t

    !> Puts the motion at each sample into a row.
    type, extends(observer_t) :: sampler_t
        type(row_maker_t) :: maker
        real(dp), pointer, contiguous :: samples(:) => null(), cells(:, :) => null()
        !> The row.
        real(dp), allocatable :: values(:)
        !> Index of the next sample, how far a sample of a fixed-step method may be from its step, and whether one was
        !> between steps.
        integer :: next = 1
        real(dp) :: slack = 0
        logical :: has_missed = .false.
        !> Time of a motion with an undefined value; infinite if there was none.
        real(dp) :: t_undefined = huge(1.0_dp)
    contains
        procedure :: observe
        procedure :: set_row
    end type sampler_t

    !> A sample of a fixed-step method within this fraction of a step is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp

contains

    !> Prepares a motion by its plan.
    subroutine prepare(self, case, plan, columns)
        class(asked_motion_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! body and start
        type(plan_t), intent(in) :: plan !! model and method
        type(trajectory_column_t), intent(in) :: columns(:) !! the columns
        self%case = case
        self%plan = plan
        self%columns = size(columns)
        self%counts_turns = any(columns%quantity() == 'phi' .or. columns%quantity() == 'psi')
        call self%maker%set(columns, self%case)
        if (plan%exact) call prepare_exact_motion(self%case%body, self%case%start, self%exact, self%status)
    end subroutine prepare

    !> Finds the columns at some times; those that are not reached are NaN.
    subroutine find(self, t, cells, status, t_reached)
        class(asked_motion_t), intent(in) :: self
        real(dp), target, contiguous, intent(in) :: t(:) !! the times, s
        real(dp), target, contiguous, intent(out) :: cells(:, :) !! a row for each time
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(out) :: t_reached !! up to there the motion was found, s
        type(sampler_t), target :: sampler

        cells = no_number
        t_reached = 0
        status = self%status
        if (.not. all(is_finite(t))) status = status_bad_samples
        if (.not. is_ok(status)) return
        sampler%samples => t
        sampler%cells => cells
        sampler%maker = self%maker
        allocate (sampler%values(self%columns))
        if (.not. self%plan%exact) then
            call integrate_motion(self, sampler, status, t_reached)
        else if (self%maker%wants_angles_of(self%exact)) then
            call evaluate_angles(self, sampler, status, t_reached)
        else
            call evaluate(self, sampler, status, t_reached)
        end if
        if (sampler%t_undefined < huge(1.0_dp)) then
            status = status_non_finite
            t_reached = sampler%t_undefined
        end if
    end subroutine find

    !> The exact solution at the times of the samples, for columns of angles and where no turns have to be counted.
    subroutine evaluate_angles(self, sampler, status, t_reached)
        type(asked_motion_t), intent(in) :: self
        type(sampler_t), intent(inout) :: sampler
        integer, intent(out) :: status
        real(dp), intent(out) :: t_reached
        integer :: i

        status = status_ok
        t_reached = 0
        do i = 1, size(sampler%samples)
            associate (t => sampler%samples(i))
                call sampler%maker%find_exact_row(self%exact, t, sampler%values)
                call store_row(sampler, t)
                if (sampler%has_enough) return
                t_reached = t
            end associate
        end do
    end subroutine evaluate_angles

    !> The same for all columns. phi and psi have all their turns.
    subroutine evaluate(self, sampler, status, t_reached)
        type(asked_motion_t), intent(in) :: self
        type(sampler_t), intent(inout) :: sampler
        integer, intent(out) :: status
        real(dp), intent(out) :: t_reached
        type(motion_t) :: last, motion
        integer(int64) :: looks, most_looks
        logical :: follows
        integer :: i

        status = status_ok
        t_reached = 0
        follows = self%exact%has_to_follow() .and. (self%counts_turns .or. .not. self%case%turn%exchanges_axes())
        last = self%case%start
        looks = 0
        most_looks = looks_per_step * self%plan%max_steps + size(sampler%samples)
        do i = 1, size(sampler%samples)
            if (follows) then
                call self%exact%follow(last, sampler%samples(i), motion, looks, most_looks)
                last = motion
            else
                motion = self%exact%at(sampler%samples(i))
            end if
            if (looks >= most_looks) then
                status = status_step_limit
                return
            end if
            call sampler%set_row(motion)
            if (sampler%has_enough) return
            t_reached = motion%t
        end do
    end subroutine evaluate

    !> The same by the method of the plan: a method with fixed steps takes them over the span of the input.
    subroutine integrate_motion(self, sampler, status, t_reached)
        type(asked_motion_t), intent(in) :: self
        type(sampler_t), target, intent(inout) :: sampler
        integer, intent(out) :: status
        real(dp), intent(out) :: t_reached
        class(formulation_t), allocatable :: formulation
        type(outcome_t) :: outcome
        real(dp) :: t_end

        t_end = sampler%samples(size(sampler%samples))
        if (.not. self%plan%is_adaptive()) then
            t_end = self%case%t_end
            sampler%slack = grid_slack * t_end / self%plan%stepper%controls%steps
        end if
        sampler%counts_turns = self%counts_turns
        allocate (formulation, source=self%plan%formulation)
        call integrate(formulation, self%plan%stepper, self%case%body, self%case%start, t_end, sampler%samples, sampler, outcome)
        status = outcome%status
        t_reached = outcome%t
        if (is_good_end(status) .and. sampler%has_missed) status = status_bad_samples
    end subroutine integrate_motion

    !> Puts a state of a formulation into the row of its sample.
    subroutine observe(self, formulation, t, y, near)
        class(sampler_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        type(motion_t) :: motion

        do while (self%next < size(self%samples))
            if (self%samples(self%next) >= t - self%slack) exit
            self%has_missed = .true.
            self%next = self%next + 1
        end do
        if (self%next > size(self%samples)) return
        ! The end of the equations, which is shown too, is not a sample.
        if (abs(self%samples(self%next) - t) > self%slack) return
        motion = formulation%motion(t, y, near)
        motion%given_angle = self%given_angle
        call self%set_row(motion)
        self%has_enough = self%has_enough .or. self%next > size(self%samples)
    end subroutine observe

    !> Makes the next row of a motion.
    subroutine set_row(self, motion)
        class(sampler_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion
        self%values(:) = self%maker%row(motion)
        call store_row(self, motion%t)
    end subroutine set_row

    !> Stores the row, which is of time t, in the cells of its sample.
    subroutine store_row(self, t)
        class(sampler_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        if (self%maker%is_defined(self%values)) then
            self%cells(self%next, :) = self%values
        else
            self%t_undefined = t
            self%has_enough = .true.
        end if
        self%next = self%next + 1
    end subroutine store_row

end module spintop_c_motion
