!> One motion computed by one method, compared with a reference; and the time that it takes. The reference is the exact solution
!> where it exists, else a motion in quadruple precision, whose convergence is measured; or a motion from a table.
module spintop_trial
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: rotation_angle, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_conditioning, only: conditioning_t, prepare_conditioning
    use spintop_effects_of_scene, only: read_columns
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_files, only: path_from
    use spintop_formulation, only: formulation_t, max_states
    use spintop_formulations, only: create_formulation
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_kinds, only: dp, epsilon_dp, no_number, pi, is_finite
    use spintop_loaded_table, only: table_t
    use spintop_methods, only: create_stepper
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_planning, only: plan_t, sample_time, sample_times
    use spintop_pole_passages, only: through_pole
    use spintop_problems, only: problems_t
    use spintop_process, only: seconds
    use spintop_quantities, only: axial_momentum, axis_tip, energy_scale, kinetic_energy, potential_energy, &
        vertical_momentum
    use spintop_scene_keys, only: reference_auto, reference_exact
    use spintop_status, only: is_good_end, is_ok, status_ok
    use spintop_stepper, only: counts_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: reference_t, find_reference, check_reference, read_motion, trial_t, run_trial, time_trial, no_errors, &
        error_orientation, error_tip, error_energy, error_lz, error_l3, error_norm, error_phi, error_theta, error_psi, &
        error_phi_rate, error_theta_rate, error_psi_rate

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
    !> Tolerances of a computed reference, of that it is compared with, and of an independent one (the least of its arithmetic).
    real(dp), parameter :: fine = 1.0e-24_dp, coarse = 1.0e-20_dp, finest = 1.0e-15_dp

    !> The columns of a stored motion.
    character(*), parameter :: columns(*) = [character(6) :: &
        't', 'q0', 'q1', 'q2', 'q3', 'omega1', 'omega2', 'omega3']
    !> Tolerance of times relative to the span, and of norms of quaternions.
    real(dp), parameter :: time_slack = 1.0e-12_dp, unit_slack = 1.0e-9_dp

    !> Magnitudes of the differences from the reference, as places in a list: the rotation angle between the attitudes, rad, and
    !> the distance of the axis tips; the error of the energy over (kinetic energy at the start + m g |r|), those of the momenta
    !> about the vertical and about body z over (momentum at the start + square root of m g |r| times the largest inertia); the
    !> norm error abs(q) - 1 of the quaternion; phi, theta, psi, rad, phi and psi within half a turn, and their rates, rad/s.
    enum, bind(C)
        enumerator :: error_orientation = 1, error_tip, error_energy, error_lz, error_l3, error_norm
        enumerator :: error_phi, error_theta, error_psi, error_phi_rate, error_theta_rate, error_psi_rate
    end enum
    !> The errors before the first comparison. In a pole only theta exists; what never did is NaN.
    real(dp), parameter :: no_errors(error_psi_rate) = [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, no_number, no_number, &
                                                        no_number, no_number, no_number, no_number]

    !> Result of a computation.
    type :: trial_t
        integer :: status = status_ok
        !> Time reached, s.
        real(dp) :: t = 0
        !> Largest errors at the times of the reference, and errors at the last time reached.
        real(dp), dimension(size(no_errors)) :: errors = no_errors, last = no_errors
        type(counts_t) :: counts
        !> Computing time without comparisons, s.
        real(dp) :: time = 0
    end type trial_t

    !> Keeps the last motion, and the state that it is made of.
    type, extends(observer_t) :: arrival_t
        type(motion_t) :: motion
        real(dp) :: t = 0, y(max_states) = 0, near(3) = 0
    contains
        procedure :: observe => observe_arrival
    end type arrival_t

    !> Minimum duration of a measurement, which consists of consecutive calls, and approximate maximum of all
    !> repeats together, s.
    real(dp), parameter :: shortest = 2.0e-4_dp, longest = 2.0_dp

contains

    !> The reference of a case at `samples` equally spaced times, both ends included.
    subroutine find_reference(case, samples, kind, max_steps, reference, status)
        type(case_t), intent(in) :: case !! the case whose motion is the reference, over its span
        integer, intent(in) :: samples, kind !! number of times; kind of reference (`reference_names`)
        integer(int64), intent(in) :: max_steps !! for each computation of the reference
        type(reference_t), intent(out) :: reference !! the reference motion
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        character(*), parameter :: in_quadruple = 'taylor_quadruple'
        type(conditioning_t) :: conditioning
        type(motion_t), allocatable :: again(:), from_another(:)
        type(case_t) :: other
        real(dp) :: times(samples)
        integer :: i

        times = sample_times(case%t_end, samples)
        if (kind == reference_exact .or. (kind == reference_auto .and. case%body%has_closed_form())) then
            reference%source = exact_solution
            call compute(case, times, '', 0.0_dp, max_steps, reference%motions, status)
            if (is_ok(status)) call prepare_conditioning(case%body, case%start, conditioning, status)
            if (is_ok(status)) reference%floor = [(conditioning%floor_at(reference%motions(i)%t), i=1, samples)]
            return
        end if
        ! In quadruple precision, the same with a larger tolerance, and from a start whose numbers differ by one unit in the last
        ! place.
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

    !> Rotation angle between the attitudes of two motions, rad.
    elemental real(dp) function apart(first, second)
        type(motion_t), intent(in) :: first, second
        apart = rotation_angle(first%quaternion, second%quaternion)
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
    !> with equally spaced times from 0 to the end of the span. It must belong to the case.
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
        real(dp) :: start(4)
        integer :: i, rows

        call read_columns(path_from(input, path), key, columns, 0, table, values, problems)
        if (problems%any()) return
        associate (cells => transpose(values))
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
            if (problems%any()) return
            reference%source = path(index(path, '/', back=.true.) + 1:)
            ! In the axes of the computation; their accuracy is unknown.
            allocate (reference%motions(rows))
            reference%floor = spread(no_number, 1, rows)
            reference%uncertainty = no_number
            motion = case%given_start
            do i = 1, rows
                motion = motion_from_quaternion(cells(1, i), cells(2:5, i) / norm2(cells(2:5, i)), cells(6:8, i), motion%angle)
                reference%motions(i) = case%turn%turned_motion(motion)
            end do
        end associate
    end subroutine read_motion

    !> Computes a case with a plan, with steps at, or dense output for, the times of the reference, and compares the motions.
    subroutine run_trial(case, plan, reference, trial)
        type(case_t), intent(in) :: case !! the case to compute
        type(plan_t), intent(inout) :: plan !! model, method and settings
        type(reference_t), intent(in) :: reference !! the reference motion
        type(trial_t), intent(out) :: trial !! result of the computation
        type(collector_t) :: collector
        type(outcome_t) :: outcome
        real(dp) :: began, weight, momentum_scale
        integer :: i

        collector%counts_turns = .false.
        began = seconds()
        call collect_motions(case, plan, reference%motions%t, collector, outcome)
        trial%time = seconds() - began - collector%collecting
        trial%status = outcome%status
        if (is_good_end(outcome%status)) trial%status = status_ok
        trial%t = outcome%t
        trial%counts = outcome%counts
        weight = case%body%mass * case%body%gravity * norm2(case%body%centre_of_mass)
        ! A body at rest without weight has no momentum.
        momentum_scale = max(norm2(case%body%inertia * case%start%omega) + sqrt(weight) * sqrt(maxval(case%body%inertia)), &
                             tiny(weight))
        do i = 1, collector%count
            call compare(collector%motions(i), reference%motions(i))
        end do

    contains

        !> Compares a motion with that of the reference at its time; angles and rates in the axes in which the body was given.
        subroutine compare(motion, truth)
            type(motion_t), intent(in) :: motion, truth
            type(motion_t) :: computed, true
            real(dp) :: differences(size(no_errors)), gamma(3)
            logical :: exists(size(no_errors))

            associate (body => case%body, angles => differences(error_phi:error_psi))
                differences(error_orientation) = rotation_angle(truth%quaternion, motion%quaternion)
                differences(error_tip) = norm2(axis_tip(body, motion) - axis_tip(body, truth))
                differences(error_energy) = (energy(body, motion) - energy(body, truth)) / energy_scale(body, case%start)
                differences(error_lz) = (vertical_momentum(body, motion) - vertical_momentum(body, truth)) / momentum_scale
                differences(error_l3) = (axial_momentum(body, motion) - axial_momentum(body, truth)) / momentum_scale
                differences(error_norm) = motion%norm_error
                ! Angles of a state may have left 0 <= theta <= pi; those of the attitude have not.
                computed = motion_from_quaternion(motion%t, motion%quaternion, motion%omega, motion%angle)
                computed = case%turn%back(computed, case%given_start%angle)
                true = case%turn%back(truth, case%given_start%angle)
                differences(error_phi:) = [computed%angle - true%angle, computed%rate - true%rate]
                angles = angles - 2 * pi * anint(angles / (2 * pi))
            end associate
            exists = .true.
            exists(error_phi_rate:) = is_finite(true%rate)
            ! In a pole only theta exists.
            gamma = vertical_from_quaternion(true%quaternion)
            if (norm2(gamma(1:2)) <= through_pole) exists(error_phi:) = [.false., .true., .false., .false., .false., .false.]
            trial%last = merge(enlarged(no_errors, differences), no_errors, exists)
            where (exists) trial%errors = enlarged(trial%errors, trial%last)
        end subroutine compare

    end subroutine run_trial

    !> The larger of an error, which may not exist yet, and a difference, of which NaN counts as the largest.
    elemental real(dp) function enlarged(error, difference)
        real(dp), intent(in) :: error, difference
        enlarged = abs(difference)
        if (.not. is_finite(difference)) enlarged = huge(error)
        if (error > enlarged) enlarged = error
    end function enlarged

    !> Total energy, J.
    pure real(dp) function energy(body, motion)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        energy = kinetic_energy(body, motion) + potential_energy(body, motion)
    end function energy

    !> The minimum time of `repeats` computations of a case with a plan, s, for attitude and rates at the end of the span. It is
    !> that of elapsed times: what else the processor does can only lengthen them. The processor time of a thread is no such
    !> bound: a virtual machine takes the time that its host withheld from where it notices, and may so count nothing for a
    !> short run. A similar computation, which took about `expected` seconds, should have run just before as a warm-up. If the
    !> repeats would take longer than two seconds there are fewer of them, but at least one. `counts` is the cost of one.
    subroutine time_trial(case, plan, expected, repeats, time, counts, motion, status)
        type(case_t), intent(in) :: case !! the case whose computation is timed
        type(plan_t), intent(inout) :: plan !! model, method and settings
        real(dp), intent(in) :: expected !! expected time of one computation, s
        integer, intent(in) :: repeats !! maximum number of measurements
        real(dp), intent(out) :: time !! minimum time, s
        type(counts_t), intent(out) :: counts !! cost of one computation
        type(motion_t), intent(out), optional :: motion !! the end of the span, in the axes of the computation
        integer, intent(out), optional :: status !! how the last computation ended (spintop_status)
        type(exact_motion_t) :: exact
        type(arrival_t) :: arrival
        type(outcome_t) :: outcome
        real(dp) :: began, start
        integer :: calls, repeat, i, ended

        arrival%counts_turns = .false.
        calls = 1 + int(shortest / max(expected, shortest / 1000))
        time = huge(time)
        start = seconds()
        do repeat = 1, repeats
            began = seconds()
            do i = 1, calls
                if (plan%exact) then
                    call prepare_exact_motion(case%body, case%start, exact, ended)
                    arrival%motion = exact%at(case%t_end)
                else
                    call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, [case%t_end], arrival, &
                                   outcome)
                    ended = outcome%status
                end if
            end do
            time = min(time, (seconds() - began) / calls)
            if (seconds() - start > longest) exit
        end do
        counts = outcome%counts
        if (present(motion)) then
            motion = arrival%motion
            if (.not. plan%exact) motion = plan%formulation%motion(arrival%t, arrival%y, arrival%near)
        end if
        if (present(status)) status = ended
    end subroutine time_trial

    !> Keeps the motion: attitude and rates, without the angles that describe the attitude.
    subroutine observe_arrival(self, formulation, t, y, near)
        class(arrival_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        self%motion = formulation%motion_without_angles(t, y)
        self%t = t
        self%y = y
        self%near = near
    end subroutine observe_arrival

end module spintop_trial
