!> The residuals of measurements of a motion as a function of numbers of its scene.
module spintop_fit_model
    use spintop_case, only: case_t, make_case
    use spintop_compare, only: is_equal, is_finite
    use spintop_event_recorder, only: event_recorder_t
    use spintop_exact_path, only: exact_path_t
    use spintop_fit_data, only: measurements_t
    use spintop_formulation, only: formulation_info_t
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp, no_number
    use spintop_least_squares, only: residuals_t
    use spintop_motion, only: motion_t
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t
    use spintop_plan, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_row_maker, only: row_maker_t
    use spintop_scene, only: describe_scene, scene_t
    use spintop_sensitivity, only: sensitive_key_t
    use spintop_stepper, only: looks_per_step
    use spintop_status, only: is_good_end, status_ok
    implicit none
    private
    public :: fit_model_t

    !> Measurements, and the motion that is to explain them. It must not be copied.
    type, extends(residuals_t) :: fit_model_t
        type(measurements_t) :: measured
        !> The scene of the last evaluation, and what it means.
        type(scene_t), allocatable, private :: scene
        type(case_t), private :: case
        type(plan_t), private :: plan
        !> The sought numbers in the scene, and changes of them that matter, whatever their values; 0 for numbers of which the
        !> sign cannot change, where those in proportion to the value do.
        type(number_slot_t), allocatable, private :: slots(:)
        real(dp), allocatable, private :: scales(:)
        !> In equations of a symmetric top the sought I1 is also I2.
        logical, private :: ties_inertia = .false.
        !> Absolute tolerance of the plan.
        real(dp), private :: absolute_tolerance = 0
        type(row_maker_t), private :: maker
    contains
        procedure :: prepare
        procedure :: plan_with_another
        procedure :: evaluate
        procedure :: predict
        procedure :: step_scale
        procedure :: limited
        procedure :: ends
        procedure :: coarsen
    end type fit_model_t

contains

    !> Takes measurements, and the scene of their motion with the numbers that are sought.
    subroutine prepare(self, scene, keys, case, plan, measured)
        class(fit_model_t), target, intent(inout) :: self
        type(scene_t), intent(in) :: scene !! contents of the input
        type(sensitive_key_t), intent(in) :: keys(:) !! the sought numbers, in that scene
        type(case_t), intent(in) :: case !! body, start and span of the scene
        type(plan_t), intent(in) :: plan !! model and method
        type(measurements_t), intent(in) :: measured !! the measurements
        type(formulation_info_t) :: form
        type(parameter_table_t) :: table
        character(:), allocatable :: problem
        real(dp) :: value
        integer :: seeks(size(keys)), i

        seeks = 0
        self%measured = measured
        self%data = reshape(measured%values / spread(measured%sigma, 2, size(measured%t)), [size(measured%values)])
        self%scene = scene
        self%scene%certified = .false.
        self%case = case
        self%plan = plan
        call describe_scene(self%scene, table)
        allocate (self%slots(size(keys)), self%scales(size(keys)))
        do i = 1, size(keys)
            call table%find_number(keys(i)%name, self%slots(i), problem)
            value = abs(keys(i)%slot%get())
            self%scales(i) = 1
            if (value > 0 .and. .not. keys(i)%slot%accepts(-value)) then
                self%scales(i) = merge(value, 0.0_dp, keys(i)%slot%accepts(0.0_dp))
            end if
            if (keys(i)%name == 'top.inertia(1)') seeks(i) = 1
            if (keys(i)%name == 'top.inertia(2)') seeks(i) = 2
        end do
        self%ties_inertia = any(seeks == 1) .and. all(seeks /= 2) .and. is_equal(scene%inertia(1), scene%inertia(2))
        if (.not. plan%exact) then
            form = plan%formulation%info()
            self%ties_inertia = self%ties_inertia .and. form%symmetric_only
            self%precision = plan%stepper%controls%relative_tolerance
            self%absolute_tolerance = plan%stepper%controls%absolute_tolerance
        end if
        call self%maker%set(measured%columns, case)
    end subroutine prepare

    !> The residuals at some values of the sought numbers, in units of the standard deviations: column by column in time.
    subroutine evaluate(self, x, residuals, is_valid)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:) !! the values
        real(dp), intent(out) :: residuals(:) !! the residuals
        logical, intent(out) :: is_valid !! whether there is such a motion
        real(dp) :: values(size(self%measured%columns), size(self%measured%t))

        call self%predict(x, values, is_valid)
        associate (measured => self%measured)
            residuals = reshape((values - measured%values) / spread(measured%sigma, 2, size(measured%t)), [size(residuals)])
        end associate
    end subroutine evaluate

    !> The values of the measured columns at the measured times.
    subroutine predict(self, x, values, is_valid)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:) !! values of the sought numbers
        real(dp), intent(out) :: values(:, :) !! columns, times
        logical, intent(out) :: is_valid !! whether there is such a motion
        type(problems_t) :: problems

        values = no_number
        is_valid = .false.
        if (.not. accepts(self, x)) return
        call put(self, x, problems)
        if (problems%any()) return
        if (self%plan%exact) then
            if (self%case%body%has_closed_form()) call take_exactly(self, values)
        else
            call integrate_to_times(self, values)
        end if
        is_valid = all(is_finite(values))
    end subroutine predict

    !> Whether all numbers are in their ranges.
    pure logical function accepts(self, x)
        class(fit_model_t), intent(in) :: self
        real(dp), intent(in) :: x(:)
        integer :: i
        accepts = all([(self%slots(i)%accepts(x(i)), i=1, size(x))])
    end function accepts

    !> Makes the case with some values of the sought numbers.
    subroutine put(self, x, problems)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:)
        type(problems_t), intent(inout) :: problems
        integer :: i
        do i = 1, size(x)
            call self%slots(i)%put(x(i))
        end do
        if (self%ties_inertia) self%scene%inertia(2) = self%scene%inertia(1)
        call make_case(self%scene, self%case, problems)
    end subroutine put

    !> The plan of the motion in which one of the sought numbers has another value than `x`, above or below: a closed form, or
    !> equations of symmetric tops, may not be for such a body.
    subroutine plan_with_another(self, i, x, plan, problems)
        class(fit_model_t), intent(inout) :: self
        integer, intent(in) :: i !! which number
        real(dp), intent(in) :: x(:) !! the values
        type(plan_t), intent(out) :: plan !! the plan; valid without errors in `problems`
        type(problems_t), intent(out) :: problems !! why there is no such motion
        real(dp), parameter :: steps(2) = [1.0e-6_dp, -1.0e-6_dp]
        real(dp) :: moved(size(x))
        integer :: side

        do side = 1, size(steps)
            moved = x
            moved(i) = x(i) + steps(side) * self%step_scale(i, x(i))
            if (.not. accepts(self, moved)) cycle
            call plan_with(self, moved, plan, problems)
            if (.not. problems%any()) return
        end do
    end subroutine plan_with_another

    subroutine plan_with(self, x, plan, problems)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:)
        type(plan_t), intent(out) :: plan
        type(problems_t), intent(out) :: problems
        call put(self, x, problems)
        if (.not. problems%any()) call make_plan(self%scene, self%case, plan, problems)
    end subroutine plan_with

    !> The values of the exact solution.
    subroutine take_exactly(self, values)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(inout) :: values(:, :)
        type(exact_path_t) :: path
        type(motion_t) :: motion
        integer :: i, status

        call path%begin(self%case, looks_per_step * self%plan%max_steps + size(values, 2), status)
        if (status /= status_ok) return
        call self%maker%set(self%measured%columns, self%case)
        do i = 1, size(values, 2)
            if (self%maker%wants_angles_of(path%exact)) then
                call self%maker%put_exact_row(path%exact, self%measured%t(i), values(:, i))
                cycle
            end if
            call path%at(self%measured%t(i), motion)
            if (path%is_spent()) return
            values(:, i) = self%maker%row(motion)
        end do
    end subroutine take_exactly

    !> The values of a motion that is integrated.
    subroutine integrate_to_times(self, values)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(inout) :: values(:, :)
        type(writer_t), allocatable :: writer
        type(event_recorder_t), allocatable :: no_watch
        type(outcome_t) :: outcome
        real(dp) :: times(size(self%measured%t))

        allocate (writer)
        call writer%take_columns(self%measured%columns, self%case, self%scene)
        allocate (writer%kept(size(values, 1), size(values, 2)), source=no_number)
        times = self%measured%t
        call compute_motion(self%scene, self%case, self%plan, times, writer, outcome, no_watch)
        if (is_good_end(outcome%status)) values = writer%kept
    end subroutine integrate_to_times

    !> A change of a sought number that matters.
    pure real(dp) function step_scale(self, i, x) result(step)
        class(fit_model_t), intent(in) :: self
        integer, intent(in) :: i !! which number
        real(dp), intent(in) :: x !! its value
        step = max(abs(x), self%scales(i))
        if (.not. step > 0) step = 1
    end function step_scale

    !> The value in the range of a number that is nearest to another; beyond an open end that value itself.
    pure real(dp) function limited(self, i, x)
        class(fit_model_t), intent(in) :: self
        integer, intent(in) :: i !! which number
        real(dp), intent(in) :: x !! a value
        limited = self%slots(i)%nearest(x)
    end function limited

    !> The ends of the range of a number.
    pure function ends(self, i)
        class(fit_model_t), intent(in) :: self
        integer, intent(in) :: i !! which number
        real(dp) :: ends(2)
        ends = self%slots(i)%ends()
    end function ends

    !> Multiplies the tolerances of the plan by a factor; 1 restores them.
    subroutine coarsen(self, factor)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: factor !! at least 1
        associate (controls => self%plan%stepper%controls)
            controls%relative_tolerance = factor * self%precision
            controls%absolute_tolerance = factor * self%absolute_tolerance
        end associate
    end subroutine coarsen

end module spintop_fit_model
