!> Bodies and starts that several suites use, runs of a stepper without an observer, step by step, and what the tests measure
!> on them.
module runs
    use tested
    use observers, only: recorder_t
    implicit none
    private
    public :: controls_at, make_stepper, observe_motion, set_out, unit_body, run_t, propagate, propagate_from, reference_state
    public :: smooth_body, smooth_start, prepare_smooth, prepare_state, start_from, exact_start, advance_to
    public :: observed_order, flow, formulations_for, total_energy, slow_top, slow_start, paper_wheel, upright_theta

    !> Inclination at which both examples are released, rad.
    real(dp), parameter :: upright_theta = pi / 16

    !> How a run ended.
    type :: run_t
        integer :: status = status_ok
        real(dp) :: t = 0, y(max_states) = 0
        type(counts_t) :: counts
        !> Steps whose time is not that of the grid of fixed step size.
        integer :: off_grid = 0
    end type run_t

contains

    !> Body of Example 1; `length` is from the pivot to the centre of mass (default sqrt(3)/2 m).
    pure type(body_t) function slow_top(length) result(body)
        real(dp), intent(in), optional :: length
        body%mass = 1
        body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
        body%centre_of_mass = [0.0_dp, 0.0_dp, sqrt(0.75_dp)]
        if (present(length)) body%centre_of_mass(3) = length
        body%gravity = 9.81_dp
    end function slow_top

    !> Start of Example 1: released at pi/16 with a spin rate of 1 rad/s.
    pure type(motion_t) function slow_start() result(start)
        start = motion_from_angles(0.0_dp, [0.0_dp, upright_theta, 0.0_dp], [0.0_dp, 0.0_dp, 1.0_dp])
    end function slow_start

    !> Body of Example 2 with the moments of inertia that the author used: those about the centre.
    pure type(body_t) function paper_wheel() result(body)
        real(dp), parameter :: radius = 0.1_dp, thickness = 0.01_dp, density = 7800
        body%mass = density * pi * radius**2 * thickness
        body%inertia(1:2) = body%mass * (3 * radius**2 + thickness**2) / 12
        body%inertia(3) = body%mass * radius**2 / 2
        body%centre_of_mass = [0.0_dp, 0.0_dp, 1.0_dp]
        body%gravity = 9.81_dp
    end function paper_wheel

    !> Follows any body from its start by a method, at a tolerance (0: its own) or with so many steps, under a formulation
    !> (`rigid_body`), to a time (the last of some times), and keeps what is seen at these; returns how the run ended.
    integer function observe_motion(method, body, start, times, tolerance, seen, form, steps, project, search, outcome, &
                                    t_end, absolute, max_steps, fixed_point, limit) result(status)
        character(*), intent(in) :: method
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: times(:), tolerance
        type(recorder_t), intent(out) :: seen
        character(*), intent(in), optional :: form
        integer, intent(in), optional :: steps, project, max_steps, limit !! `limit` ends the run after so many motions
        class(event_search_t), intent(inout), optional :: search
        type(outcome_t), intent(out), optional :: outcome
        real(dp), intent(in), optional :: t_end, absolute
        logical, intent(in), optional :: fixed_point
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        type(outcome_t) :: own_outcome
        real(dp) :: end
        end = maxval(times)
        if (present(t_end)) end = t_end
        if (present(limit)) seen%limit = limit
        if (present(form)) then
            call create_formulation(form, formulation, body=body)
        else
            call create_formulation('rigid_body', formulation, body=body)
        end if
        call make_stepper(method, stepper, steps, absolute=absolute, max_steps=max_steps, project=project, fixed_point=fixed_point)
        if (tolerance > 0) stepper%controls%relative_tolerance = tolerance
        if (tolerance > 0 .and. .not. present(absolute)) stepper%controls%absolute_tolerance = tolerance
        call integrate(formulation, stepper, body, start, end, times, seen, own_outcome, search)
        status = own_outcome%status
        if (present(outcome)) outcome = own_outcome
    end function observe_motion

    !> The method of that name, with its settings changed; `tolerance` is the relative and the absolute one.
    subroutine make_stepper(name, stepper, steps, tolerance, relative, absolute, max_steps, project, fixed_point, table)
        character(*), intent(in) :: name
        class(stepper_t), allocatable, intent(out) :: stepper
        integer, intent(in), optional :: steps, max_steps, project
        real(dp), intent(in), optional :: tolerance, relative, absolute
        logical, intent(in), optional :: fixed_point
        character(*), intent(in), optional :: table
        call create_stepper(name, stepper)
        if (present(steps)) stepper%controls%steps = steps
        if (present(tolerance)) stepper%controls%relative_tolerance = tolerance
        if (present(tolerance)) stepper%controls%absolute_tolerance = tolerance
        if (present(relative)) stepper%controls%relative_tolerance = relative
        if (present(absolute)) stepper%controls%absolute_tolerance = absolute
        if (present(max_steps)) stepper%controls%max_steps = max_steps
        if (present(project)) stepper%controls%project = project
        if (present(fixed_point)) stepper%controls%fixed_point = fixed_point
        if (present(table)) stepper%controls%table = table
    end subroutine make_stepper

    !> A copy of a method that has begun a run from a state.
    subroutine set_out(stepper, formulation, y, t_end, running, status)
        class(stepper_t), intent(in) :: stepper
        class(formulation_t), target, intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), t_end
        class(stepper_t), allocatable, intent(out) :: running
        integer, intent(out) :: status
        allocate (running, source=stepper)
        running%y = y
        running%t_end = t_end
        running%formulation => formulation
        call running%begin(status)
    end subroutine set_out

    !> Goes on step by step up to a time or beyond, or until a step fails.
    subroutine advance_to(running, t, status)
        class(stepper_t), intent(inout) :: running
        real(dp), intent(in) :: t
        integer, intent(out) :: status
        status = status_ok
        do while (status == status_ok .and. running%t < t)
            call running%advance(status)
        end do
    end subroutine advance_to

    !> Controls at a tolerance.
    pure type(controls_t) function controls_at(tolerance) result(controls)
        real(dp), intent(in) :: tolerance
        controls%relative_tolerance = tolerance
        controls%absolute_tolerance = tolerance
    end function controls_at

    !> A body of unit mass in unit gravity.
    pure type(body_t) function unit_body(inertia, centre_of_mass) result(body)
        real(dp), intent(in) :: inertia(3), centre_of_mass(3)
        body = body_t(gravity=1.0_dp, inertia=inertia, centre_of_mass=centre_of_mass)
    end function unit_body

    !> A top that turns smoothly, away from the poles.
    pure type(body_t) function smooth_body() result(body)
        body = body_t(inertia=[1.0_dp, 1.0_dp, 0.8_dp], centre_of_mass=[0.0_dp, 0.0_dp, 0.5_dp], gravity=2.0_dp)
    end function smooth_body

    !> Its start, in the midst of a nutation.
    pure type(motion_t) function smooth_start() result(start)
        start = motion_from_angles(0.0_dp, [0.1_dp, 1.0_dp, 0.3_dp], [0.3_dp, 0.2_dp, 1.0_dp])
    end function smooth_start

    !> The smooth top under a formulation.
    subroutine prepare_smooth(name, formulation, y)
        character(*), intent(in) :: name
        class(formulation_t), allocatable, intent(out) :: formulation
        real(dp), intent(out) :: y(max_states)
        call prepare_state(name, smooth_body(), smooth_start(), formulation, y)
    end subroutine prepare_smooth

    !> A body under a formulation that takes it and its start.
    subroutine prepare_state(name, body, start, formulation, y)
        character(*), intent(in) :: name
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        class(formulation_t), allocatable, intent(out) :: formulation
        real(dp), intent(out) :: y(max_states)
        integer :: status
        call create_formulation(name, formulation, body=body)
        call formulation%prepare(body, start, y, status)
        if (status /= status_ok) error stop 'runs: the formulation does not take the body or its start'
    end subroutine prepare_state

    !> A start from quaternion and angular velocity.
    pure type(motion_t) function start_from(quaternion, omega) result(start)
        real(dp), intent(in) :: quaternion(4), omega(3) !! attitude, and rad/s in body axes
        start = motion_from_quaternion(0.0_dp, quaternion, omega, [0.0_dp, 0.0_dp, 0.0_dp])
    end function start_from

    !> The same, whose numbers are data without rounding.
    pure type(motion_t) function exact_start(quaternion, omega) result(start)
        real(dp), intent(in) :: quaternion(4), omega(3)
        start = start_from(quaternion, omega)
        start%gives_quaternion = .true.
        start%gives_omega = .true.
    end function exact_start

    !> Propagates the state `y` over `t_end` seconds, back if that is negative, or until it fails.
    type(run_t) function propagate(stepper, formulation, y, t_end) result(run)
        class(stepper_t), intent(in) :: stepper
        class(formulation_t), target, intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), t_end
        class(stepper_t), allocatable :: running
        allocate (running, source=stepper)
        call propagate_from(stepper, formulation, y, t_end, running, run)
    end function propagate

    !> The same in a workspace that may have been used before.
    subroutine propagate_from(stepper, formulation, y, t_end, running, run)
        class(stepper_t), intent(in) :: stepper
        class(formulation_t), target, intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), t_end
        class(stepper_t), intent(inout) :: running
        type(run_t), intent(out) :: run
        real(dp) :: grid_time

        running%formulation => formulation
        running%t = 0
        running%y = y
        running%rest = 0
        running%t_end = t_end
        running%grid = 0
        running%counts = counts_t()
        call running%begin(run%status)
        do while (run%status == status_ok .and. abs(running%t) < abs(t_end))
            call running%advance(run%status)
            if (run%status /= status_ok .or. stepper%controls%steps == 0) cycle
            grid_time = t_end * running%counts%steps / stepper%controls%steps
            if (abs(running%t - grid_time) > 2 * spacing(grid_time)) run%off_grid = run%off_grid + 1
        end do
        run%t = running%t
        run%y = running%y
        run%counts = running%counts
    end subroutine propagate_from

    !> The state after `t_end` seconds, to rounding.
    function reference_state(formulation, y, t_end) result(y_end)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), t_end
        real(dp) :: y_end(max_states)
        class(stepper_t), allocatable :: stepper
        type(run_t) :: run
        call make_stepper('arkode_erk', stepper, steps=400, table='arkode_fehlberg_13_7_8')
        run = propagate(stepper, formulation, y, t_end)
        y_end = run%y
    end function reference_state

    !> Kinetic and potential energy, J.
    pure real(dp) function total_energy(body, motion)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        total_energy = kinetic_energy(body, motion) + potential_energy(body, motion)
    end function total_energy

    !> The formulations under which a method is tested: all that offer it what it needs, or `lagrange`.
    function formulations_for(stepper) result(names)
        class(stepper_t), intent(in) :: stepper
        character(16), allocatable :: names(:)
        type(formulation_info_t), allocatable :: infos(:)
        logical, allocatable :: suitable(:)
        integer :: i
        allocate (infos, source=formulation_infos())
        allocate (suitable(size(infos)))
        if (stepper%info%needs == structure_none) then
            suitable = infos%name == 'lagrange'
        else
            suitable = [(infos(i)%offers(stepper%info%needs), i=1, size(infos))]
        end if
        allocate (names, source=pack(infos%name, suitable))
    end function formulations_for

    !> Order of convergence of a method with a fixed step size: steps are halved until the error is
    !> small and two orders in turn, each from two errors, are alike; or the error is tiny.
    real(dp) function observed_order(method, table, formulation, y) result(order)
        character(*), intent(in) :: method, table
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states)
        real(dp), parameter :: t_end = 4, small = 1.0e-8_dp, tiny = 1.0e-12_dp, alike = 0.4_dp
        integer, parameter :: most_steps = 1024
        class(stepper_t), allocatable :: stepper
        type(run_t) :: run
        real(dp) :: exact(max_states), error, previous, previous_order

        exact = reference_state(formulation, y, t_end)
        call make_stepper(method, stepper, steps=12, table=table)
        error = 1
        order = 0
        do
            previous = error
            previous_order = order
            run = propagate(stepper, formulation, y, t_end)
            error = norm2(run%y - exact)
            if (run%status /= status_ok) error = 1
            order = log(previous / error) / log(2.0_dp)
            if (error < small .and. (abs(order - previous_order) < alike .or. error < tiny)) exit
            if (stepper%controls%steps >= most_steps) exit
            stepper%controls%steps = 2 * stepper%controls%steps
        end do
    end function observed_order

    !> The state a short time h later, by one classical Runge-Kutta step of equations without the time.
    function flow(formulation, y, h) result(y_new)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states), h
        real(dp) :: y_new(max_states), k(max_states, 4)
        integer :: status
        call formulation%derivative(0.0_dp, y, k(:, 1), status)
        call formulation%derivative(0.0_dp, y + h / 2 * k(:, 1), k(:, 2), status)
        call formulation%derivative(0.0_dp, y + h / 2 * k(:, 2), k(:, 3), status)
        call formulation%derivative(0.0_dp, y + h * k(:, 3), k(:, 4), status)
        y_new = y + h / 6 * (k(:, 1) + 2 * k(:, 2) + 2 * k(:, 3) + k(:, 4))
    end function flow

end module runs
