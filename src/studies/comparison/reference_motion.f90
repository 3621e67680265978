!> The reference for computed motions: the exact solution where it exists, else a motion in quadruple
!> precision, whose convergence is measured; or a motion from a table.
module spintop_reference_motion
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, epsilon_dp, no_number
    use spintop_attitude, only: rotation_angle
    use spintop_case, only: case_t
    use spintop_conditioning, only: conditioning_t, prepare_conditioning
    use spintop_effects_of_scene, only: read_columns
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_files, only: path_from
    use spintop_formulation, only: formulation_t, max_states
    use spintop_formulations, only: create_formulation
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_loaded_table, only: table_t
    use spintop_methods, only: create_stepper
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_planning, only: plan_t, sample_time, sample_times
    use spintop_problems, only: problems_t
    use spintop_process, only: seconds
    use spintop_scene_keys, only: reference_auto, reference_exact
    use spintop_status, only: is_good_end, is_ok, status_ok
    use spintop_text, only: to_text
    implicit none
    private
    public :: reference_t, collector_t, collect_motions, find_reference, check_reference, read_motion

    !> A reference motion at equally spaced times.
    type :: reference_t
        type(motion_t), allocatable :: motions(:)
        !> Inherent error of the attitude, rad, at each time.
        real(dp), allocatable :: floor(:)
        !> Source of the motion.
        character(24) :: source = ''
        !> Whether it was computed in quadruple precision.
        logical :: is_computed = .false.
        !> Difference of two computations, rad; zero for the exact solution, NaN for a stored motion.
        real(dp) :: uncertainty = 0
        !> The method of an independent computation, and the difference from it, rad; blank and NaN if that
        !> computation failed.
        character(24) :: check = ''
        real(dp) :: disagreement = 0
    end type reference_t

    !> Keeps every motion, and the time that this takes, s.
    type, extends(observer_t) :: collector_t
        type(motion_t), allocatable :: motions(:)
        integer :: count = 0
        real(dp) :: collecting = 0
    contains
        procedure :: observe
    end type collector_t

    !> The source of what is known in closed form.
    character(*), parameter :: exact_solution = 'exact solution'
    !> Tolerances of a computed reference, and of the computation it is compared with.
    real(dp), parameter :: fine = 1.0e-24_dp, coarse = 1.0e-20_dp
    !> Tolerance of an independent computation: the smallest one of its arithmetic.
    real(dp), parameter :: finest = 1.0e-15_dp

    !> The columns of a stored motion.
    character(*), parameter :: columns(*) = [character(6) :: &
        't', 'q0', 'q1', 'q2', 'q3', 'omega1', 'omega2', 'omega3']
    !> Tolerance of times relative to the span, and of norms of quaternions.
    real(dp), parameter :: time_slack = 1.0e-12_dp, unit_slack = 1.0e-9_dp

contains

    !> The reference of a case at `samples` equally spaced times, both ends included.
    subroutine find_reference(case, samples, kind, max_steps, reference, status)
        type(case_t), intent(in) :: case !! the case whose motion is the reference, over its span
        integer, intent(in) :: samples, kind !! number of times; kind of reference (`reference_names`)
        integer(int64), intent(in) :: max_steps !! for each computation of the reference
        type(reference_t), intent(out) :: reference !! the reference motion
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(conditioning_t) :: conditioning
        integer :: i

        if (kind == reference_exact .or. (kind == reference_auto .and. case%body%has_closed_form())) then
            reference%source = exact_solution
            call compute(case, sample_times(case%t_end, samples), '', 0.0_dp, max_steps, reference%motions, status)
            if (is_ok(status)) call prepare_conditioning(case%body, case%start, conditioning, status)
            if (is_ok(status)) reference%floor = [(conditioning%floor_at(reference%motions(i)%t), i=1, samples)]
        else
            call compute_twice(case, sample_times(case%t_end, samples), max_steps, reference, status)
        end if
    end subroutine find_reference

    !> Compares a reference with an independent computation: the exact solution or, for bodies without one, a
    !> Runge-Kutta method; for the exact solution, Taylor's method.
    subroutine check_reference(case, max_steps, reference)
        type(case_t), intent(in) :: case !! the case of the reference; its body decides which method checks it
        integer(int64), intent(in) :: max_steps !! for the independent computation
        type(reference_t), intent(inout) :: reference !! the result of the check is added
        type(motion_t), allocatable :: others(:)
        integer :: status

        if (case%body%has_closed_form() .and. reference%is_computed) then
            call compute(case, reference%motions%t, '', 0.0_dp, max_steps, others, status)
            reference%check = exact_solution
        else
            reference%check = 'dop853'
            if (case%body%has_closed_form()) reference%check = 'taylor'
            call compute(case, reference%motions%t, trim(reference%check), finest, max_steps, others, status)
        end if
        if (is_ok(status)) then
            reference%disagreement = maxval(apart(reference%motions, others))
        else
            reference%check = ''
            reference%disagreement = no_number
        end if
    end subroutine check_reference

    !> A motion in quadruple precision, the same with a larger tolerance, and one from a start whose numbers
    !> differ by one unit in the last place.
    subroutine compute_twice(case, times, max_steps, reference, status)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: times(:)
        integer(int64), intent(in) :: max_steps
        type(reference_t), intent(out) :: reference
        integer, intent(out) :: status
        type(motion_t), allocatable :: again(:), from_another(:)
        type(case_t) :: other
        character(*), parameter :: in_quadruple = 'taylor_quadruple'

        reference%source = 'quadruple precision'
        reference%is_computed = .true.
        call compute(case, times, in_quadruple, fine, max_steps, reference%motions, status)
        if (.not. is_ok(status)) return
        call compute(case, times, in_quadruple, coarse, max_steps, again, status)
        if (.not. is_ok(status)) return
        reference%uncertainty = maxval(apart(reference%motions, again))
        other = case
        other%start%omega = case%start%omega * (1 + epsilon_dp * [1, -1, 1])
        other%start%quaternion = case%start%quaternion * (1 + epsilon_dp * [1, -1, -1, 1])
        call compute(other, times, in_quadruple, coarse, max_steps, from_another, status)
        if (is_ok(status)) reference%floor = apart(again, from_another) / 2
    end subroutine compute_twice

    !> A motion by an adaptive method, or without a name by the exact solution.
    subroutine compute(case, times, method, tolerance, max_steps, motions, status)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: times(:), tolerance
        character(*), intent(in) :: method
        integer(int64), intent(in) :: max_steps
        type(motion_t), allocatable, intent(out) :: motions(:)
        integer, intent(out) :: status
        type(plan_t) :: plan
        type(collector_t) :: collector
        type(outcome_t) :: outcome

        plan%exact = method == ''
        if (.not. plan%exact) then
            call create_formulation('rigid_body', plan%formulation, body=case%body)
            call create_stepper(method, plan%stepper)
            plan%stepper%controls%relative_tolerance = tolerance
            plan%stepper%controls%absolute_tolerance = tolerance
            plan%stepper%controls%max_steps = max_steps
        end if
        call collect_motions(case, plan, times, collector, outcome)
        status = outcome%status
        if (is_good_end(status)) status = status_ok
        call move_alloc(collector%motions, motions)
    end subroutine compute

    !> Collects the motions of a case at some times up to the end of its span, in closed form or step by step.
    subroutine collect_motions(case, plan, times, collector, outcome)
        type(case_t), intent(in) :: case !! the case to compute
        type(plan_t), intent(inout) :: plan !! model, method and settings
        real(dp), intent(in) :: times(:) !! increasing, s
        type(collector_t), intent(inout) :: collector !! gets the motions
        type(outcome_t), intent(out) :: outcome !! how the motion ended
        type(exact_motion_t) :: exact
        integer :: i

        allocate (collector%motions(size(times)))
        if (.not. plan%exact) then
            call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, times, collector, outcome)
            return
        end if
        call prepare_exact_motion(case%body, case%start, exact, outcome%status)
        if (.not. is_ok(outcome%status)) return
        collector%motions = [(exact%at(times(i)), i=1, size(times))]
        collector%count = size(times)
        outcome%t = times(size(times))
    end subroutine collect_motions

    !> Rotation angles between the attitudes of two motions, rad.
    pure function apart(first, second) result(angle)
        type(motion_t), intent(in) :: first(:), second(:)
        real(dp) :: angle(size(first))
        integer :: i
        do i = 1, size(first)
            angle(i) = rotation_angle(first(i)%quaternion, second(i)%quaternion)
        end do
    end function apart

    !> Keeps the motion. The end of the equations, which is shown too, may be one more than the times.
    subroutine observe(self, formulation, t, y, near)
        class(collector_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        real(dp) :: began
        if (self%count == size(self%motions)) return
        began = seconds()
        self%count = self%count + 1
        self%motions(self%count) = formulation%motion(t, y, near)
        self%collecting = self%collecting + (seconds() - began)
    end subroutine observe

    !> Reads the reference motion of a case from a CSV table, such as a trajectory that was computed before or by another program,
    !> with equally spaced times from 0 to the end of the span.
    subroutine read_motion(input, key, path, case, reference, problems)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        character(*), intent(in) :: key !! parameter that holds the path
        character(*), intent(in) :: path !! path of the table, relative to the folder of `input`
        type(case_t), intent(in) :: case !! the case: the motion must have its start, its span and its axes
        type(reference_t), intent(out) :: reference !! the stored motion; without motions if there is a problem
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(table_t) :: table
        type(motion_t) :: motion
        real(dp), allocatable :: values(:, :)
        integer :: i

        call read_columns(path_from(input, path), key, columns, 0, table, values, problems)
        if (problems%any()) return
        associate (cells => transpose(values))
            call check_motion(cells, key, case, problems)
            if (problems%any()) return
            reference%source = path(index(path, '/', back=.true.) + 1:)
            ! In the axes of the computation; their accuracy is unknown.
            allocate (reference%motions(size(cells, 2)))
            reference%floor = spread(no_number, 1, size(cells, 2))
            reference%uncertainty = no_number
            motion = case%given_start
            do i = 1, size(cells, 2)
                motion = motion_from_quaternion(cells(1, i), cells(2:5, i) / norm2(cells(2:5, i)), cells(6:8, i), motion%angle)
                reference%motions(i) = case%turn%turned_motion(motion)
            end do
        end associate
    end subroutine read_motion

    !> Checks that the motion belongs to the case.
    subroutine check_motion(cells, key, case, problems)
        real(dp), intent(in) :: cells(:, :)
        character(*), intent(in) :: key
        type(case_t), intent(in) :: case
        type(problems_t), intent(inout) :: problems
        real(dp) :: start(4)
        integer :: i, rows

        rows = size(cells, 2)
        if (rows < 2) then
            call problems%add(key, 'the table has ' // to_text(rows) // ' rows', 'it needs at least the start and the end')
            return
        end if
        do i = 1, rows
            if (abs(cells(1, i) - sample_time(case%t_end, rows, i)) > time_slack * case%t_end) then
                call problems%add(key, 'row ' // to_text(i) // ' of the table is for t = ' // to_text(cells(1, i)) &
                                  // ', not ' // to_text(sample_time(case%t_end, rows, i)), &
                                  'its rows are equally spaced from 0 to the end of the span')
                return
            end if
        end do
        start = cells(2:5, 1) * sign(1.0_dp, dot_product(cells(2:5, 1), case%given_start%quaternion))
        if (any(abs(norm2(cells(2:5, :), dim=1) - 1) > unit_slack)) then
            call problems%add(key, 'the table has quaternions whose norm is not 1', 'an attitude is a unit quaternion')
        else if (norm2(start - case%given_start%quaternion) > unit_slack .or. &
                 norm2(cells(6:8, 1) - case%given_start%omega) > unit_slack * (1 + norm2(case%given_start%omega))) then
            call problems%add(key, 'the motion in the table has another start', 'use a table of this case')
        end if
    end subroutine check_motion

end module spintop_reference_motion
