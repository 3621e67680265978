!> The residuals of measurements of a motion as a function of numbers of its scene.
module spintop_fit_model
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: stop_is_wanted
    use spintop_case, only: case_t, make_case
    use spintop_fit_data, only: columns_of_motion, gauss_nodes, key_of, measurements_t, read_sensors
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp, is_equal, is_finite, no_number, pi
    use spintop_least_squares, only: residuals_t, robust_deviation
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: given, is_set, parameter_table_t
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_scene_keys, only: describe_scene, scene_t
    use spintop_sensitivity, only: sensitive_key_t
    use spintop_status, only: is_good_end
    use spintop_study_column, only: study_column_t
    implicit none
    private
    public :: fit_model_t

    !> Measurements, and the motion that is to explain them. It must not be copied.
    type, extends(residuals_t) :: fit_model_t
        type(measurements_t) :: measured
        !> Number of leading rows that are explained.
        integer :: rows = 0
        !> Ranges in which the numbers are sought, (:, 1) to (:, 2), if they are set.
        real(dp), allocatable :: ranges(:, :)
        !> Where rows are few, what holds the numbers: their values, and the size of a residual per change that matters.
        real(dp), allocatable, private :: held_at(:)
        real(dp), private :: hold = 0
        !> The columns of the motion: those that are measured, and what the mounting of a sensor mixes with them.
        type(study_column_t), allocatable, private :: columns(:)
        !> Places of the components of vectors that the mounting turns.
        integer, allocatable, private :: turned(:, :)
        !> The scene of the last evaluation, and what it means.
        type(scene_t), allocatable, private :: scene
        type(case_t), private :: case
        type(plan_t), private :: plan
        !> The sought numbers in the scene, and changes of them that matter, whatever their values; 0 for numbers of which the
        !> sign cannot change, where those in proportion to the value do.
        type(number_slot_t), allocatable, private :: slots(:)
        real(dp), allocatable, private :: scales(:)
        !> Where the body is symmetric, and I2 is not sought, the sought I1 is also I2.
        logical, private :: ties_inertia = .false.
        !> Absolute tolerance of the plan.
        real(dp), private :: absolute_tolerance = 0
        !> Which of the sought numbers is theta at the start; 0 for none.
        integer, private :: theta = 0
        !> Whether the start is described from the other side of the pole than in the input.
        logical :: is_mirrored = .false.
        !> The progress that is shown, of so many parts.
        type(progress_t) :: progress
        integer(int64) :: parts = 1000
    contains
        procedure :: prepare
        procedure :: use_rows
        procedure :: weigh
        procedure :: plan_with_another
        procedure :: is_at_pole
        procedure :: mirror
        procedure :: evaluate
        procedure :: predict
        procedure :: differences
        procedure :: step_scale
        procedure :: limited
        procedure :: ends
        procedure :: coarsen
    end type fit_model_t

contains

    !> Sets the measurements, and the scene of their motion with the numbers that are sought.
    subroutine prepare(self, scene, keys, case, plan, measured)
        class(fit_model_t), target, intent(inout) :: self
        type(scene_t), intent(in) :: scene !! contents of the input
        type(sensitive_key_t), intent(in) :: keys(:) !! the sought numbers, in that scene
        type(case_t), intent(in) :: case !! the case of the scene, whose motion has the measured columns
        type(plan_t), intent(in) :: plan !! model and method
        type(measurements_t), intent(in) :: measured !! the measurements
        type(parameter_table_t) :: table
        character(:), allocatable :: problem
        real(dp) :: value
        integer :: seeks(size(keys)), i

        self%measured = measured
        call self%use_rows(size(measured%t))
        self%scene = scene
        call columns_of_motion(measured%columns, scene%fit%mounting, [(keys(i)%name(:min(8, len(keys(i)%name))) == 'mounting', &
                               i=1, size(keys))], self%columns, self%turned)
        self%scene%certified = .false.
        self%ranges = reshape([scene%fit%from(:size(keys)), scene%fit%to(:size(keys))], [size(keys), 2])
        self%case = case
        self%plan = plan
        call describe_scene(self%scene, table)
        allocate (self%slots(size(keys)), self%scales(size(keys)))
        do i = 1, size(keys)
            call table%find_number(key_of(keys(i)%name, self%scene%fit%sensors), self%slots(i), problem)
            value = abs(keys(i)%slot%get())
            self%scales(i) = 1
            if (value > 0 .and. .not. keys(i)%slot%accepts(-value)) self%scales(i) = &
                merge(value, 0.0_dp, keys(i)%slot%accepts(0.0_dp))
            if (any(keys(i)%name == [character(17) :: 'initial.theta', 'initial.theta_deg'])) self%theta = i
            if (keys(i)%name == 'offset.t') self%ranges(i, 1) = scene%fit%averaged / 2 - measured%t(1)
            seeks(i) = findloc(['top.inertia(1)', 'top.inertia(2)'] == keys(i)%name, .true., dim=1)
        end do
        self%ties_inertia = any(seeks == 1) .and. all(seeks /= 2) .and. is_equal(scene%inertia(1), scene%inertia(2))
        if (.not. plan%exact) then
            self%precision = plan%stepper%controls%relative_tolerance
            self%absolute_tolerance = plan%stepper%controls%absolute_tolerance
        end if
    end subroutine prepare

    !> Explains so many of the leading rows only. The sought numbers may be held near some values, by a residual each, so that
    !> rows which do not determine them do not lead them astray.
    subroutine use_rows(self, rows, held_at, hold)
        class(fit_model_t), intent(inout) :: self
        integer, intent(in) :: rows !! number of rows, all at most
        real(dp), intent(in), optional :: held_at(:) !! the values
        real(dp), intent(in), optional :: hold !! size of the residual of a change that matters, in units of the others
        self%rows = rows
        associate (measured => self%measured)
            self%data = pack(measured%values(:, :rows) / measured%sigma(:, :rows), measured%is_there(:, :rows))
        end associate
        if (allocated(self%held_at)) deallocate (self%held_at)
        if (.not. present(held_at)) return
        self%held_at = held_at
        self%hold = hold
        self%data = [self%data, 0 * held_at]
    end subroutine use_rows

    !> Estimates the standard deviation of each column, where they are not known, from the residuals at some values of the sought
    !> numbers, if all columns have enough readings; `change` is the largest relative change of one.
    subroutine weigh(self, x, is_robust, change)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:) !! the values
        logical, intent(in) :: is_robust !! whether by the median, which wrong readings do not spoil
        real(dp), intent(out) :: change !! 0 where the standard deviations stay
        real(dp), parameter :: least = 1.0e-13_dp, same = 1.0e-4_dp ! of the readings; of a standard deviation
        real(dp) :: readings(size(self%measured%columns), self%rows), differences(size(self%measured%columns), self%rows)
        real(dp) :: deviations(size(self%measured%columns))
        real(dp), allocatable :: residuals(:)
        logical :: is_valid
        integer :: i, enough

        change = 0
        if (self%measured%knows_sigma .or. size(deviations) == 1) return
        enough = 2 * size(x) + 10
        associate (measured => self%measured, rows => self%rows)
            if (any(count(measured%is_there(:, :rows), dim=2) < enough)) return
            call self%predict(x, readings, is_valid)
            if (.not. is_valid) return
            differences = self%differences(readings)
            do i = 1, size(deviations)
                residuals = pack(differences(i, :), measured%is_there(i, :rows))
                deviations(i) = norm2(residuals) / sqrt(real(size(residuals), dp))
                if (is_robust) deviations(i) = robust_deviation(residuals, size(x))
                deviations(i) = max(deviations(i), least * maxval(abs(measured%values(i, :)), mask=measured%is_there(i, :)), &
                                    tiny(change))
            end do
            change = maxval(abs(deviations / measured%sigma(:, 1) - 1))
            if (change < same) change = 0
            if (.not. change > 0) return
            measured%sigma = spread(deviations, 2, size(measured%t))
        end associate
        call self%use_rows((self%rows))
    end subroutine weigh

    !> Whether theta at the start is sought, and is that of a pole.
    pure logical function is_at_pole(self, x)
        class(fit_model_t), intent(in) :: self
        real(dp), intent(in) :: x(:) !! values of the sought numbers
        is_at_pole = .false.
        if (self%theta == 0) return
        associate (range => self%slots(self%theta)%range)
            is_at_pole = any(abs([range%lower, range%upper] - x(self%theta)) <= 0)
        end associate
    end function is_at_pole

    !> Describes a start in a pole from the other side: phi and psi differ by half a turn, and theta changes the other way.
    subroutine mirror(self, x)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(inout) :: x(:) !! values of the sought numbers, which change with what they describe
        real(dp) :: side
        integer :: i

        side = merge(-1, 1, self%is_mirrored)
        self%is_mirrored = .not. self%is_mirrored
        do i = 1, size(x)
            call self%slots(i)%set(x(i))
        end do
        associate (angle => self%scene%angle, degrees => self%scene%angle_deg, rate => self%scene%rate(2))
            where (.not. is_set(degrees)) angle = given(angle)
            where (is_set(angle)) angle = angle + side * [pi, 0.0_dp, pi]
            where (is_set(degrees)) degrees = degrees + side * [180, 0, 180]
            if (is_set(rate)) rate = -rate
        end associate
        x = [(self%slots(i)%get(), i=1, size(x))]
    end subroutine mirror

    !> The residuals at some values of the sought numbers, in units of the standard deviations: row by row.
    subroutine evaluate(self, x, residuals, is_valid)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:) !! values of the sought numbers, in their units
        real(dp), intent(out) :: residuals(:) !! measured less computed, in units of the standard deviations
        logical, intent(out) :: is_valid !! whether there is such a motion
        real(dp) :: readings(size(self%measured%columns), self%rows)
        integer :: i, n

        call self%progress%update(int(self%share * self%parts, int64))
        call self%predict(x, readings, is_valid)
        n = size(residuals)
        if (allocated(self%held_at)) n = n - size(x)
        associate (measured => self%measured, rows => self%rows)
            residuals(:n) = pack(-self%differences(readings) / measured%sigma(:, :rows), measured%is_there(:, :rows))
        end associate
        if (n == size(residuals)) return
        residuals(n + 1:) = self%hold * (x - self%held_at) / [(self%step_scale(i, self%held_at(i)), i=1, size(x))]
    end subroutine evaluate

    !> The measured readings less others, those of wrapped angles to the nearest turn; 0 where there is no reading.
    pure function differences(self, readings)
        class(fit_model_t), intent(in) :: self
        real(dp), intent(in) :: readings(:, :) !! columns, leading rows
        real(dp) :: differences(size(readings, 1), size(readings, 2))
        integer :: i
        associate (measured => self%measured, rows => size(readings, 2))
            differences = merge(measured%values(:, :rows) - readings, 0.0_dp, measured%is_there(:, :rows))
            do i = 1, size(readings, 1)
                associate (turn => measured%turn(i))
                    if (turn > 0) differences(i, :) = modulo(differences(i, :) + turn / 2, turn) - turn / 2
                end associate
            end do
        end associate
    end function differences

    !> The readings of the sensors in the leading rows.
    subroutine predict(self, x, readings, is_valid)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:) !! values of the sought numbers
        real(dp), intent(out) :: readings(:, :) !! columns, leading rows
        logical, intent(out) :: is_valid !! whether there is such a motion
        real(dp), allocatable :: t(:)
        type(writer_t), allocatable :: writer
        type(outcome_t) :: outcome
        type(problems_t) :: problems
        integer :: i

        readings = no_number
        is_valid = .false.
        if (stop_is_wanted() .or. .not. all([(self%slots(i)%accepts(x(i)), i=1, size(x))])) return
        call set_case(self, x, problems)
        if (problems%any()) return
        ! The instants of the motion at which the readings are its own, or over which they are averaged.
        associate (fit => self%scene%fit, rows => self%measured%t)
            t = fit%time_offset + rows(:size(readings, 2))
            if (fit%averaged > 0) t = [(fit%time_offset + rows(i) + fit%averaged / 2 * gauss_nodes, i=1, size(readings, 2))]
        end associate
        if (t(1) < 0) return
        self%case%t_end = t(size(t))
        if (self%plan%exact .and. .not. self%case%body%has_closed_form()) return
        allocate (writer)
        call writer%set_columns(self%columns, self%case, self%scene)
        allocate (writer%kept(size(self%columns), size(t)), source=no_number)
        if (self%plan%exact) writer%asked = t
        call compute_motion(self%case, self%plan, t, writer, outcome)
        is_valid = is_good_end(outcome%status) .and. all(is_finite(writer%kept))
        if (.not. is_valid) return
        call read_sensors(self%scene%fit, self%measured%sensor, self%measured%columns%size, self%turned, writer%kept, readings)
    end subroutine predict

    !> Makes the case with some values of the sought numbers.
    subroutine set_case(self, x, problems)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:)
        type(problems_t), intent(inout) :: problems
        integer :: i
        do i = 1, size(x)
            call self%slots(i)%set(x(i))
        end do
        if (self%ties_inertia) self%scene%inertia(2) = self%scene%inertia(1)
        call make_case(self%scene, self%case, problems)
    end subroutine set_case

    !> The plan of the motion in which one of the sought numbers has another value than `x`, above or below: a closed form, or
    !> equations of symmetric tops, may not be for such a body.
    subroutine plan_with_another(self, i, x, plan, problems)
        class(fit_model_t), intent(inout) :: self
        integer, intent(in) :: i !! which number
        real(dp), intent(in) :: x(:) !! values of the sought numbers, in their units
        type(plan_t), intent(out) :: plan !! the plan; valid without errors in `problems`
        type(problems_t), intent(out) :: problems !! why there is no such motion
        real(dp), parameter :: steps(2) = [1.0e-6_dp, -1.0e-6_dp]
        real(dp) :: moved(size(x))
        integer :: side, k

        do side = 1, size(steps)
            moved = x
            moved(i) = x(i) + steps(side) * self%step_scale(i, x(i))
            if (.not. all([(self%slots(k)%accepts(moved(k)), k=1, size(x))])) cycle
            problems = problems_t()
            call set_case(self, moved, problems)
            if (.not. problems%any()) call make_plan(self%scene, self%case, plan, problems)
            if (.not. problems%any()) return
        end do
    end subroutine plan_with_another

    !> A change of a sought number that matters.
    pure real(dp) function step_scale(self, i, x) result(step)
        class(fit_model_t), intent(in) :: self
        integer, intent(in) :: i !! which number
        real(dp), intent(in) :: x !! its value, in its unit
        step = max(abs(x), self%scales(i))
        if (.not. step > 0) step = 1
    end function step_scale

    !> The value in the range of a number that is nearest to another; beyond an open end that value itself.
    pure real(dp) function limited(self, i, x)
        class(fit_model_t), intent(in) :: self
        integer, intent(in) :: i !! which number
        real(dp), intent(in) :: x !! any value of the parameter, in its unit
        limited = self%slots(i)%range%nearest(x)
        if (is_set(self%ranges(i, 1))) limited = max(limited, self%ranges(i, 1))
        if (is_set(self%ranges(i, 2))) limited = min(limited, self%ranges(i, 2))
    end function limited

    !> The ends of the range of a number.
    pure function ends(self, i)
        class(fit_model_t), intent(in) :: self
        integer, intent(in) :: i !! which number
        real(dp) :: ends(2)
        ends = [self%slots(i)%range%lower, self%slots(i)%range%upper]
        if (is_set(self%ranges(i, 1))) ends(1) = max(ends(1), self%ranges(i, 1))
        if (is_set(self%ranges(i, 2))) ends(2) = min(ends(2), self%ranges(i, 2))
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
