!> One top for C: an opaque object made from an input, and its motion at any times. `include/spintop.h` describes the
!> functions. An object does not change after it was made, so threads may share it; they do not wait for each other.
module spintop_c_top
    use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr, c_size_t
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_c_error, only: hand_error, hand_status
    use spintop_c_result, only: c_column_t, described_column_t
    use spintop_c_text, only: take_text
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite, is_zero
    use spintop_errors, only: error_t, input_error
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_kinds, only: dp, no_number
    use spintop_motion, only: motion_t
    use spintop_options, only: options_t
    use spintop_plan, only: plan_t
    use spintop_preparation, only: prepare_job, prepared_t
    use spintop_row_maker, only: row_maker_t
    use spintop_scene_words, only: kind_trajectory, study_kinds
    use spintop_status, only: status_bad_samples, status_non_finite, status_ok, status_step_limit
    use spintop_stepper, only: looks_per_step
    use spintop_trajectory_columns, only: trajectory_column_t, trajectory_columns
    implicit none
    private

    !> A top: its case and plan, and the columns of its motion.
    type :: top_t
        type(case_t) :: case
        type(plan_t) :: plan
        type(exact_motion_t) :: exact
        !> Gives the values of the columns; each call uses a copy.
        type(row_maker_t) :: maker
        !> Whether phi or psi is among the columns.
        logical :: counts_turns = .false.
        type(described_column_t), allocatable :: described(:)
        type(c_column_t), allocatable :: columns(:)
    end type top_t

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
        procedure :: put
        procedure :: put_values
    end type sampler_t

    !> A sample of a fixed-step method within this fraction of a step is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp

contains

    !> Makes a top.
    type(c_ptr) function make_top(input, name, error) bind(C, name='spintop_top_new') result(handle)
        type(c_ptr), value :: input, name !! the input of a trajectory, and its name in messages; a null name is `input`
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(top_t), pointer :: top
        type(error_t), allocatable :: problem

        handle = c_null_ptr
        allocate (top)
        !$omp critical (library)
        call prepare_top(input, name, top, problem)
        if (allocated(problem)) call hand_error(problem, error)
        !$omp end critical (library)
        if (allocated(problem)) then
            deallocate (top)
        else
            handle = c_loc(top)
        end if
    end function make_top

    subroutine prepare_top(input, name, top, error)
        type(c_ptr), intent(in) :: input, name
        type(top_t), target, intent(inout) :: top
        type(error_t), allocatable, intent(out) :: error
        type(prepared_t), allocatable, target :: prepared
        type(trajectory_column_t), allocatable :: known(:)
        type(options_t) :: options
        character(:), allocatable :: text, name_of_text
        integer :: status, i

        call take_text(input, text)
        call take_text(name, name_of_text)
        if (name_of_text == '') name_of_text = 'input'
        options%output = ''
        allocate (options%overrides(0), prepared)
        call prepare_job(name_of_text, options, prepared%job, prepared%study, error, text)
        if (allocated(error)) return
        if (prepared%job%scene%kind /= study_kinds(kind_trajectory) .or. size(prepared%job%events) > 0) then
            error = input_error(name_of_text // ': the input of a top is that of a trajectory without events')
            return
        end if
        if (prepared%job%sensitivities%count > 0) then
            error = input_error(name_of_text // ': output.columns: a top has no derivatives; run the input')
            return
        end if
        top%case = prepared%job%case
        top%plan = prepared%job%plan
        allocate (known, source=trajectory_columns())
        known = known(prepared%job%columns)
        top%counts_turns = any(known%name == 'phi' .or. known%name == 'psi')
        call top%maker%set(known, top%case)
        allocate (top%described(size(known)), top%columns(size(known)))
        do i = 1, size(known)
            call top%described(i)%describe(known(i)%column_t, top%columns(i))
        end do
        if (top%plan%exact) call prepare_exact_motion(top%case%body, top%case%start, top%exact, status)
    end subroutine prepare_top

    !> Number of columns of a top.
    integer(c_int) function count_columns(handle) bind(C, name='spintop_top_column_count') result(columns)
        type(c_ptr), value :: handle !! the top
        type(top_t), pointer :: top
        call c_f_pointer(handle, top)
        columns = size(top%columns)
    end function count_columns

    !> The columns of a top.
    type(c_ptr) function list_columns(handle) bind(C, name='spintop_top_columns') result(columns)
        type(c_ptr), value :: handle !! the top
        type(top_t), pointer :: top
        call c_f_pointer(handle, top)
        columns = c_loc(top%columns)
    end function list_columns

    !> Finds the motion of a top at some times, column by column.
    integer(c_int) function find_motion(handle, n, t, cells, error) bind(C, name='spintop_top_at') result(code)
        type(c_ptr), value :: handle !! the top
        integer(c_size_t), value :: n !! number of times
        type(c_ptr), value :: t, cells !! the times, s; the values of the first column, of the second, and so on
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(top_t), pointer :: top
        type(sampler_t), target :: sampler
        real(dp) :: t_reached
        integer :: status

        code = 0
        if (n == 0) return
        call c_f_pointer(handle, top)
        call c_f_pointer(t, sampler%samples, [n])
        call c_f_pointer(cells, sampler%cells, [n, size(top%columns, kind=c_size_t)])
        sampler%cells = no_number
        sampler%maker = top%maker
        allocate (sampler%values(size(top%columns)))
        if (.not. all(is_finite(sampler%samples))) then
            status = status_bad_samples
            t_reached = 0
        else if (top%plan%exact .and. top%maker%wants_angles_of(top%exact)) then
            call evaluate_angles(top, sampler, status, t_reached)
        else if (top%plan%exact) then
            call evaluate(top, sampler, status, t_reached)
        else
            call integrate_top(top, sampler, status, t_reached)
        end if
        if (sampler%t_undefined < huge(1.0_dp)) then
            status = status_non_finite
            t_reached = sampler%t_undefined
        end if
        code = hand_status(status, t_reached, error)
    end function find_motion

    !> The exact solution at the times of the samples, for columns of angles and where no turns have to be counted.
    subroutine evaluate_angles(top, sampler, status, t_reached)
        type(top_t), intent(in) :: top
        type(sampler_t), intent(inout) :: sampler
        integer, intent(out) :: status
        real(dp), intent(out) :: t_reached
        integer :: i

        status = status_ok
        t_reached = 0
        do i = 1, size(sampler%samples)
            associate (t => sampler%samples(i))
                call sampler%maker%put_exact_row(top%exact, t, is_zero(t), sampler%values)
                call sampler%put_values(t)
                if (sampler%has_enough) return
                t_reached = t
            end associate
        end do
    end subroutine evaluate_angles

    !> The same for all columns. phi and psi have all their turns.
    subroutine evaluate(top, sampler, status, t_reached)
        type(top_t), intent(in) :: top
        type(sampler_t), intent(inout) :: sampler
        integer, intent(out) :: status
        real(dp), intent(out) :: t_reached
        type(motion_t) :: last, motion
        integer(int64) :: looks, most_looks
        logical :: follows
        integer :: i

        status = status_ok
        t_reached = 0
        follows = top%exact%has_to_follow() .and. (top%counts_turns .or. .not. top%case%turn%exchanges_axes())
        last = top%case%start
        looks = 0
        most_looks = looks_per_step * top%plan%max_steps + size(sampler%samples)
        do i = 1, size(sampler%samples)
            if (follows) then
                call top%exact%follow(last, sampler%samples(i), motion, looks, most_looks)
                last = motion
            else
                motion = top%exact%at(sampler%samples(i))
            end if
            if (looks >= most_looks) then
                status = status_step_limit
                return
            end if
            call sampler%put(motion)
            if (sampler%has_enough) return
            t_reached = motion%t
        end do
    end subroutine evaluate

    !> The same by the method of the plan: a method with fixed steps takes them over the span of the input.
    subroutine integrate_top(top, sampler, status, t_reached)
        type(top_t), intent(in) :: top
        type(sampler_t), target, intent(inout) :: sampler
        integer, intent(out) :: status
        real(dp), intent(out) :: t_reached
        class(formulation_t), allocatable :: formulation
        type(outcome_t) :: outcome
        real(dp) :: t_end

        t_end = sampler%samples(size(sampler%samples))
        if (.not. top%plan%is_adaptive()) then
            t_end = top%case%t_end
            sampler%slack = grid_slack * t_end / top%plan%stepper%controls%steps
        end if
        sampler%counts_turns = top%counts_turns
        allocate (formulation, source=top%plan%formulation)
        call integrate(formulation, top%plan%stepper, top%case%body, top%case%start, t_end, sampler%samples, sampler, outcome)
        status = outcome%status
        t_reached = outcome%t
        if (status == status_ok .and. sampler%has_missed) status = status_bad_samples
    end subroutine integrate_top

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
        call self%put(motion)
        self%has_enough = self%has_enough .or. self%next > size(self%samples)
    end subroutine observe

    !> Puts a motion into the next row.
    subroutine put(self, motion)
        class(sampler_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion
        self%values(:) = self%maker%row(motion, is_start=is_zero(motion%t))
        call self%put_values(motion%t)
    end subroutine put

    !> Puts the row, which is of time t, into the cells of its sample.
    subroutine put_values(self, t)
        class(sampler_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        if (self%maker%is_defined(self%values)) then
            self%cells(self%next, :) = self%values
        else
            self%t_undefined = t
            self%has_enough = .true.
        end if
        self%next = self%next + 1
    end subroutine put_values

    !> Deletes a top.
    subroutine delete_top(handle) bind(C, name='spintop_top_delete')
        type(c_ptr), value :: handle !! the top; may be null
        type(top_t), pointer :: top
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        deallocate (top)
    end subroutine delete_top

end module spintop_c_top
