!> The residuals of measurements of a motion as a function of numbers of its scene.
module spintop_fit_model
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: stop_is_wanted
    use spintop_case, only: case_t, make_case
    use spintop_fit_data, only: columns_of_motion, gauss_nodes, measurements_t, read_sensors
    use spintop_fit_unknowns, only: key_of, unknowns_t
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp, is_equal, is_finite, no_number, pi
    use spintop_least_squares, only: residuals_t, robust_deviation
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: given, is_set, parameter_table_t, unset
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_scene_keys, only: describe_scene, most_columns, scene_t
    use spintop_status, only: is_good_end
    use spintop_study_column, only: study_column_t
    implicit none
    private
    public :: fit_model_t

    !> A motion that was computed: the numbers, and the readings of the sensors.
    type :: known_t
        real(dp), allocatable :: x(:), readings(:, :)
    end type known_t

    !> The motion of a run.
    type :: motion_t
        !> Its columns: those that are measured, and what the mounting of a sensor mixes with them.
        type(study_column_t), allocatable :: columns(:)
        !> Places of the components of vectors that the mounting turns.
        integer, allocatable :: turned(:, :)
        !> The scene of the last evaluation, what it means, and the numbers of the keys in it.
        type(scene_t), allocatable :: scene
        type(case_t) :: case
        type(number_slot_t), allocatable :: slots(:)
        !> The last two, and which is the older one: derivatives by the numbers of other runs need no other motion.
        type(known_t) :: known(2)
        integer :: older = 1
    end type motion_t

    !> Measurements of runs, and the motions that are to explain them. It must not be copied.
    type, extends(residuals_t) :: fit_model_t
        type(measurements_t), allocatable :: measured(:)
        !> Number of leading rows of each run that are explained, and the period of its motion where the search begins, s.
        integer, allocatable :: rows(:)
        real(dp), allocatable :: period(:)
        !> The sought numbers, and ranges in which they are sought, (:, 1) to (:, 2), if they are set.
        type(unknowns_t) :: sought
        real(dp), allocatable :: ranges(:, :)
        !> Where rows are few, what holds the numbers: their values, and the size of a residual per change that matters.
        real(dp), allocatable, private :: held_at(:)
        real(dp), private :: hold = 0
        type(motion_t), allocatable, private :: motions(:)
        type(plan_t), private :: plan
        !> Changes of the sought numbers that matter, whatever their values; 0 for numbers of which the sign cannot change, where
        !> those in proportion to the value do.
        real(dp), allocatable, private :: scales(:)
        !> Where the body is symmetric, the sought moment of inertia about x, and the sought damping, are also those about y,
        !> if these are the same in the input and not sought.
        logical, private :: ties_inertia = .false., ties_damping = .false.
        !> Absolute tolerance of the plan.
        real(dp), private :: absolute_tolerance = 0
        !> Which of the keys is theta at the start; 0 for none.
        integer, private :: theta = 0
        !> Whether the start of each run is described from the other side of the pole than in the input.
        logical, allocatable :: is_mirrored(:)
        !> The progress that is shown, of so many parts.
        type(progress_t) :: progress
        integer(int64) :: parts = 1000
    contains
        procedure :: prepare
        procedure :: use_rows
        procedure :: use_all_rows
        procedure :: weigh
        procedure :: plan_with_another
        procedure :: is_at_pole
        procedure :: mirror
        procedure :: evaluate
        procedure :: predict
        procedure :: step_scale
        procedure :: limited
        procedure :: ends
        procedure :: coarsen
    end type fit_model_t

contains

    !> Sets the measurements, and the scenes of their motions with the numbers that are sought.
    subroutine prepare(self, scene, sought, case, plan, measured)
        class(fit_model_t), target, intent(inout) :: self
        type(scene_t), intent(in) :: scene !! contents of the input
        type(unknowns_t), intent(in) :: sought !! the sought numbers, in that scene
        type(case_t), intent(in) :: case !! the case of the scene, whose motion has the measured columns
        type(plan_t), intent(in) :: plan !! model and method
        type(measurements_t), intent(in) :: measured(:) !! the measurements of each run
        type(parameter_table_t), allocatable :: table
        type(problems_t) :: problems
        character(:), allocatable :: problem
        real(dp) :: value
        integer :: i, k, run

        self%measured = measured
        self%sought = sought
        self%plan = plan
        call self%use_rows([(size(measured(run)%t), run=1, size(measured))])
        allocate (self%motions(size(measured)), self%period(size(measured)), self%scales(size(sought%key)))
        allocate (self%is_mirrored(size(measured)), source=.false.)
        allocate (self%ranges(size(sought%key), 2), source=unset)
        associate (keys => sought%keys)
            self%ties_inertia = ties('top.inertia', scene%inertia)
            self%ties_damping = ties('top.damping', scene%damping)
            do k = 1, size(keys)
                if (any(keys(k)%name == [character(17) :: 'initial.theta', 'initial.theta_deg'])) self%theta = k
            end do
            do i = 1, size(sought%key)
                associate (slot => keys(sought%key(i))%slot)
                    value = abs(sought%start(i))
                    self%scales(i) = 1
                    if (value > 0 .and. .not. slot%accepts(-value)) self%scales(i) = &
                        merge(value, 0.0_dp, slot%accepts(0.0_dp))
                end associate
            end do
            do run = 1, size(measured)
                associate (own => self%motions(run))
                    own%scene = scene
                    own%scene%certified = .false.
                    own%case = case
                    call columns_of_motion(measured(run)%columns, scene%fit%mounting, &
                                           [(index(keys(k)%name, 'mounting') == 1, k=1, size(keys))], own%columns, own%turned)
                    allocate (table)
                    call describe_scene(own%scene, table)
                    allocate (own%slots(size(keys)))
                    do k = 1, size(keys)
                        i = sought%places(k, run)
                        call table%find_number(key_of(keys(k)%name, own%scene%fit%sensors), own%slots(k), problem)
                        if (k <= sought%common) self%ranges(i, :) = [scene%fit%from(k), scene%fit%to(k)]
                        if (keys(k)%name == 'offset.t') self%ranges(i, 1) = &
                            max(scene%fit%averaged / 2 - measured(run)%t(1), self%ranges(i, 1))
                    end do
                    deallocate (table)
                end associate
                call set_case(self, sought%start, run, problems)
                self%period(run) = period_of(self%motions(run)%case)
            end do
        end associate
        if (.not. plan%exact) then
            self%precision = plan%stepper%controls%relative_tolerance
            self%absolute_tolerance = plan%stepper%controls%absolute_tolerance
        end if

    contains

        !> Whether a number about x of a symmetric body stands for that about y.
        pure logical function ties(name, values)
            character(*), intent(in) :: name
            real(dp), intent(in) :: values(3)
            ties = any_is(name // '(1)') .and. .not. any_is(name // '(2)') .and. is_equal(values(1), values(2)) .and. &
                   is_equal(case%given_body%inertia(1), case%given_body%inertia(2))
        end function ties

        !> Whether a key is sought.
        pure logical function any_is(name)
            character(*), intent(in) :: name
            integer :: n
            any_is = any([(sought%keys(n)%name == name, n=1, size(sought%keys))])
        end function any_is

    end subroutine prepare

    !> A period of a motion: that of the rotation or of small oscillations, the smaller one, s.
    real(dp) function period_of(case) result(period)
        type(case_t), intent(in) :: case !! body and start
        period = 2 * pi / max(norm2(case%start%omega), sqrt(norm2(case%body%weight_moment()) / minval(case%body%inertia)), &
                              tiny(period))
    end function period_of

    !> Explains so many of the leading rows only. The sought numbers may be held near some values, by a residual each, so that
    !> rows which do not determine them do not lead them astray.
    subroutine use_rows(self, rows, held_at, hold)
        class(fit_model_t), intent(inout) :: self
        integer, intent(in) :: rows(:) !! number of rows of each run, all at most
        real(dp), intent(in), optional :: held_at(:) !! the values
        real(dp), intent(in), optional :: hold !! size of the residual of a change that matters, in units of the others
        integer :: run
        self%rows = rows
        self%data = [real(dp) ::]
        do run = 1, size(rows)
            associate (measured => self%measured(run), n => rows(run))
                self%data = [self%data, pack(measured%values(:, :n) / measured%sigma(:, :n), measured%is_there(:, :n))]
            end associate
        end do
        if (allocated(self%held_at)) deallocate (self%held_at)
        if (.not. present(held_at)) return
        self%held_at = held_at
        self%hold = hold
        self%data = [self%data, 0 * held_at]
    end subroutine use_rows

    !> Explains all rows.
    subroutine use_all_rows(self)
        class(fit_model_t), intent(inout) :: self
        integer :: run
        call self%use_rows([(size(self%measured(run)%t), run=1, size(self%measured))])
    end subroutine use_all_rows

    !> Estimates the standard deviation of each column, where they are not known, from the residuals at some values of the sought
    !> numbers, if all columns have enough readings; `change` is the largest relative change of one.
    subroutine weigh(self, x, is_robust, change)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:) !! the values
        logical, intent(in) :: is_robust !! whether by the median, which wrong readings do not spoil
        real(dp), intent(out) :: change !! 0 where the standard deviations stay
        real(dp), parameter :: least = 1.0e-13_dp, same = 1.0e-4_dp ! of the readings; of a standard deviation
        real(dp) :: deviations(most_columns, size(self%measured))
        real(dp), allocatable :: readings(:, :), differences(:, :), residuals(:)
        logical :: is_valid
        integer :: i, run, parameters

        change = 0
        parameters = size(self%sought%keys)
        if (self%measured(1)%knows_sigma .or. sum([(size(self%measured(run)%columns), run=1, size(self%measured))]) == 1) return
        do run = 1, size(self%measured)
            if (any(count(self%measured(run)%is_there(:, :self%rows(run)), dim=2) < 2 * parameters + 10)) return
        end do
        do run = 1, size(self%measured)
            associate (measured => self%measured(run), rows => self%rows(run))
                call self%predict(x, run, rows, readings, is_valid)
                if (.not. is_valid) return
                differences = measured%differences(readings)
                do i = 1, size(measured%columns)
                    residuals = pack(differences(i, :), measured%is_there(i, :rows))
                    deviations(i, run) = norm2(residuals) / sqrt(real(size(residuals), dp))
                    if (is_robust) deviations(i, run) = robust_deviation(residuals, parameters)
                    deviations(i, run) = max(deviations(i, run), tiny(change), &
                                             least * maxval(abs(measured%values(i, :)), mask=measured%is_there(i, :)))
                    change = max(change, abs(deviations(i, run) / measured%sigma(i, 1) - 1))
                end do
            end associate
        end do
        if (change < same) change = 0
        if (.not. change > 0) return
        do run = 1, size(self%measured)
            associate (measured => self%measured(run))
                measured%sigma = spread(deviations(:size(measured%columns), run), 2, size(measured%t))
            end associate
        end do
        call self%use_rows([self%rows])
    end subroutine weigh

    !> The runs of which theta at the start is sought, and is that of a pole.
    pure function is_at_pole(self, x)
        class(fit_model_t), intent(in) :: self
        real(dp), intent(in) :: x(:) !! values of the sought numbers
        logical :: is_at_pole(size(self%measured))
        integer :: run
        is_at_pole = .false.
        if (self%theta == 0) return
        do run = 1, size(self%measured)
            associate (range => self%motions(run)%slots(self%theta)%range, theta => x(self%sought%places(self%theta, run)))
                is_at_pole(run) = any(abs([range%lower, range%upper] - theta) <= 0)
            end associate
        end do
    end function is_at_pole

    !> Describes starts in a pole from the other side: phi and psi differ by half a turn, and theta changes the other way.
    subroutine mirror(self, x, runs)
        class(fit_model_t), target, intent(inout) :: self
        real(dp), intent(inout) :: x(:) !! values of the sought numbers, which change with what they describe
        logical, intent(in) :: runs(:) !! which of the runs
        real(dp) :: side
        integer :: run

        do run = 1, size(runs)
            if (.not. runs(run)) cycle
            side = merge(-1, 1, self%is_mirrored(run))
            self%is_mirrored(run) = .not. self%is_mirrored(run)
            associate (places => self%sought%places(:, run), own => self%motions(run))
                call own%slots%set(x(places))
                associate (angle => own%scene%angle, degrees => own%scene%angle_deg, rate => own%scene%rate(2))
                    where (.not. is_set(degrees)) angle = given(angle)
                    where (is_set(angle)) angle = angle + side * [pi, 0.0_dp, pi]
                    where (is_set(degrees)) degrees = degrees + side * [180, 0, 180]
                    if (is_set(rate)) rate = -rate
                end associate
                x(places) = own%slots%get()
            end associate
        end do
        call forget(self)
    end subroutine mirror

    !> The residuals at some values of the sought numbers, in units of the standard deviations: run by run, row by row.
    subroutine evaluate(self, x, residuals, is_valid)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:) !! values of the sought numbers, in their units
        real(dp), intent(out) :: residuals(:) !! measured less computed, in units of the standard deviations
        logical, intent(out) :: is_valid !! whether there are such motions
        real(dp), allocatable :: readings(:, :)
        integer :: i, run, first, last

        call self%progress%update(int(self%share * self%parts, int64))
        last = 0
        do run = 1, size(self%measured)
            associate (measured => self%measured(run), rows => self%rows(run))
                call recall(self, x, run, readings, is_valid)
                if (.not. is_valid) exit
                first = last + 1
                last = last + count(measured%is_there(:, :rows))
                residuals(first:last) = pack(-measured%differences(readings) / measured%sigma(:, :rows), &
                                             measured%is_there(:, :rows))
            end associate
        end do
        if (.not. is_valid) residuals = no_number
        if (.not. is_valid .or. last == size(residuals)) return
        residuals(last + 1:) = self%hold * (x - self%held_at) / [(self%step_scale(i, self%held_at(i)), i=1, size(x))]
    end subroutine evaluate

    !> The readings in the rows of a run that are explained, which may be known.
    subroutine recall(self, x, run, readings, is_valid)
        class(fit_model_t), intent(inout) :: self
        real(dp), intent(in) :: x(:)
        integer, intent(in) :: run
        real(dp), allocatable, intent(out) :: readings(:, :)
        logical, intent(out) :: is_valid
        real(dp), allocatable :: own(:)
        integer :: i

        allocate (own, source=x(self%sought%places(:, run)))
        do i = 1, 2
            associate (known => self%motions(run)%known(i))
                if (.not. allocated(known%x)) cycle
                is_valid = size(known%readings, 2) == self%rows(run) .and. all(is_equal(known%x, own))
                if (is_valid) readings = known%readings
            end associate
            if (is_valid) exit
        end do
        if (i > 2) call self%predict(x, run, self%rows(run), readings, is_valid)
        if (.not. is_valid) return
        associate (motion => self%motions(run))
            if (i > 2) then
                i = motion%older
                motion%known(i) = known_t(own, readings)
            end if
            motion%older = 3 - i
        end associate
    end subroutine recall

    !> Forgets the motions that are known.
    subroutine forget(self)
        class(fit_model_t), intent(inout) :: self
        integer :: run
        do run = 1, size(self%motions)
            self%motions(run)%known = known_t()
        end do
    end subroutine forget

    !> The readings of the sensors in the leading rows of a run.
    subroutine predict(self, x, run, rows, readings, is_valid)
        class(fit_model_t), target, intent(inout) :: self
        real(dp), intent(in) :: x(:) !! values of the sought numbers
        integer, intent(in) :: run, rows !! which run; number of its rows
        real(dp), allocatable, intent(out) :: readings(:, :) !! columns, rows
        logical, intent(out) :: is_valid !! whether there is such a motion
        real(dp), allocatable :: t(:)
        type(writer_t), allocatable :: writer
        type(outcome_t) :: outcome
        type(problems_t) :: problems
        integer :: i

        associate (own => self%motions(run), measured => self%measured(run))
            allocate (readings(size(measured%columns), rows), source=no_number)
            is_valid = .false.
            if (stop_is_wanted() .or. .not. accepts(self, x, run)) return
            call set_case(self, x, run, problems)
            if (problems%any()) return
            ! The instants of the motion at which the readings are its own, or over which they are averaged.
            associate (fit => own%scene%fit)
                t = fit%time_offset + measured%t(:rows)
                if (fit%averaged > 0) t = [(fit%time_offset + measured%t(i) + fit%averaged / 2 * gauss_nodes, i=1, rows)]
            end associate
            if (t(1) < 0) return
            own%case%t_end = t(size(t))
            if (self%plan%exact .and. .not. own%case%body%has_closed_form()) return
            allocate (writer)
            call writer%set_columns(own%columns, own%case, own%scene)
            allocate (writer%kept(size(own%columns), size(t)), source=no_number)
            if (self%plan%exact) writer%asked = t
            call compute_motion(own%case, self%plan, t, writer, outcome)
            is_valid = is_good_end(outcome%status) .and. all(is_finite(writer%kept))
            if (.not. is_valid) return
            call read_sensors(own%scene%fit, measured%sensor, measured%columns%size, own%turned, writer%kept, readings)
        end associate
    end subroutine predict

    !> Whether the numbers of a run can have some values.
    pure logical function accepts(self, x, run)
        class(fit_model_t), intent(in) :: self
        real(dp), intent(in) :: x(:)
        integer, intent(in) :: run
        accepts = all(self%motions(run)%slots%accepts(x(self%sought%places(:, run))))
    end function accepts

    !> Makes the case of a run with some values of the sought numbers.
    subroutine set_case(self, x, run, problems)
        class(fit_model_t), target, intent(inout) :: self
        real(dp), intent(in) :: x(:)
        integer, intent(in) :: run
        type(problems_t), intent(inout) :: problems
        associate (own => self%motions(run))
            call own%slots%set(x(self%sought%places(:, run)))
            if (self%ties_inertia) own%scene%inertia(2) = own%scene%inertia(1)
            if (self%ties_damping) own%scene%damping(2) = own%scene%damping(1)
            call make_case(own%scene, own%case, problems)
        end associate
    end subroutine set_case

    !> The plan of the motion in which one of the sought numbers has another value than where the search begins, above or below: a
    !> closed form, or equations of symmetric tops, may not be for such a body.
    subroutine plan_with_another(self, i, plan, problems)
        class(fit_model_t), intent(inout) :: self
        integer, intent(in) :: i !! which number
        type(plan_t), intent(out) :: plan !! the plan; valid without errors in `problems`
        type(problems_t), intent(out) :: problems !! why there is no such motion
        real(dp), parameter :: steps(2) = [1.0e-6_dp, -1.0e-6_dp]
        real(dp) :: moved(size(self%sought%start))
        integer :: side, run

        ! The first run that has the number.
        do run = 1, size(self%measured)
            if (any(self%sought%places(:, run) == i)) exit
        end do
        do side = 1, size(steps)
            moved = self%sought%start
            moved(i) = moved(i) + steps(side) * self%step_scale(i, moved(i))
            if (.not. accepts(self, moved, run)) cycle
            problems = problems_t()
            call set_case(self, moved, run, problems)
            if (.not. problems%any()) call make_plan(self%motions(run)%scene, self%motions(run)%case, plan, problems)
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
        limited = self%motions(1)%slots(self%sought%key(i))%range%nearest(x)
        if (is_set(self%ranges(i, 1))) limited = max(limited, self%ranges(i, 1))
        if (is_set(self%ranges(i, 2))) limited = min(limited, self%ranges(i, 2))
    end function limited

    !> The ends of the range of a number.
    pure function ends(self, i)
        class(fit_model_t), intent(in) :: self
        integer, intent(in) :: i !! which number
        real(dp) :: ends(2)
        associate (range => self%motions(1)%slots(self%sought%key(i))%range)
            ends = [range%lower, range%upper]
        end associate
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
        call forget(self)
    end subroutine coarsen

end module spintop_fit_model
