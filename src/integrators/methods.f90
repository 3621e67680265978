!> The registry of methods: one entry each; lists, help, checks and tests derive from it. It is built once,
!> at the first question, and shared by all threads.
!>
!> And the compatibility of methods, formulations and bodies. `can_run` is the one place that decides it, for `integrate`, for the
!> plans of the program and for tests. The single conditions are separate procedures, for detailed messages.
module spintop_methods
    use spintop_arkode, only: arkode_t, arkode_table, arkode_table_t
    use spintop_body, only: body_t
    use spintop_errors, only: error_t, input_error
    use spintop_formulation, only: formulation_info_t, formulation_t, structure_group, structure_none, structure_quadruple, &
        structure_split
    use spintop_geometric, only: commutator_free_t, munthe_kaas_t, splitting_t, splitting_table
    use spintop_implicit_runge_kutta, only: gauss_table, implicit_runge_kutta_t, theta_table
    use spintop_kinds, only: dp, is_zero
    use spintop_motion, only: motion_t
    use spintop_runge_kutta, only: classical_table, dop853_t, dop853_table, dormand_prince_table, explicit_table, ode45_t, &
        runge_kutta_t
    use spintop_status, only: is_ok, status_bad_projection, status_bad_samples, status_bad_span, status_bad_steps, &
        status_bad_table, status_bad_tolerance, status_no_fixed_steps, status_no_steps, status_no_structure, status_ok, &
        status_stuck_at_turn, status_unknown_name, status_unsuitable
    use spintop_stepper, only: controls_t, method_info_t, project_invariants, project_nothing, project_unit, stepper_t
    use spintop_taylor, only: taylor_info, taylor_t, taylor_quadruple_t
    use spintop_validity, only: body_status, start_status
    implicit none
    private
    public :: method_infos, create_stepper, register_method, exact_info, method_aliases
    public :: can_run, holds_for, has_structure, passes_turns, projection_status, controls_status, call_status

    !> The exact solution, which has no steps, as an entry in the list of methods.
    type(method_info_t), parameter :: exact_info = method_info_t( &
        'exact', 'closed-form solution of the undamped symmetric top and of the free body: any time, no steps', &
        family='closed form')

    !> Room for so many.
    integer, parameter :: most = 64

    type :: entry_t
        class(stepper_t), allocatable :: prototype
    end type entry_t

    !> The methods by name, in the order in which they are listed.
    type :: registry_t
        integer :: size = 0
        type(entry_t) :: entry(most)
        !> The family of the methods that are added.
        character(24) :: family = ''
    contains
        procedure :: add
    end type registry_t

    type(registry_t), target :: registry

    !> Each `other=own`: another name, and the name here.
    character(*), parameter :: method_aliases(*) = [character(40) :: &
        'rk45=ode45', 'rkdp=ode45', 'rkdp45=ode45', 'dopri=ode45', 'dopri5=ode45', 'dormand_prince=ode45', &
        'dp5=ode45', 'rkf45=ode45', 'dop8=dop853', 'dopri8=dop853', 'dopri853=dop853', 'rk8=dop853', &
        'dp8=dop853', 'ode78=dop853', 'ode89=dop853', 'ode87=dop853', &
        'euler=euler_forward', 'explicit_euler=euler_forward', 'forward_euler=euler_forward', &
        'implicit_euler=euler_backward', 'backward_euler=euler_backward', &
        'rk=rk4', 'runge_kutta=rk4', 'runge_kutta_4=rk4', 'classical=rk4', 'midpoint=rk2', &
        'crank_nicolson=crank_nicolson_1', 'cn=crank_nicolson_1', 'cn1=crank_nicolson_1', &
        'cn2=crank_nicolson_2', 'trapezoidal=crank_nicolson_1', 'trapezoid=crank_nicolson_1', &
        'implicit_midpoint=crank_nicolson_2', 'gauss_2=crank_nicolson_2', 'gauss=gauss_4', &
        'gauss_legendre=gauss_4', 'gl4=gauss_4', 'gl6=gauss_6', 'gl8=gauss_8', 'rkmk=rkmk_4', 'rkmk4=rkmk_4', &
        'verlet=splitting_2', 'leapfrog=splitting_2', 'stoermer=splitting_2', 'strang=splitting_2', &
        'dirk=arkode_dirk', 'sdirk=arkode_dirk', 'erk=arkode_erk', 'arkode=arkode_erk', 'closed_form=exact', &
        'analytic=exact', 'analytical=exact', 'default=auto', 'automatic=auto']

contains

    !> The registry. Who finds it unbuilt builds it; the others wait for that.
    function known_methods() result(known)
        type(registry_t), pointer :: known
        !$omp critical (methods_registry)
        if (registry%size == 0) call list_methods(registry)
        !$omp end critical (methods_registry)
        known => registry
    end function known_methods

    !> Fills the registry: what there is, stands here, by families.
    subroutine list_methods(known)
        type(registry_t), intent(out) :: known
        known%family = 'explicit Runge-Kutta'
        call known%add(runge_kutta_t(table=explicit_table(1, [real(dp) ::], [1.0_dp]), info=method_info_t( &
            'euler_forward', 'explicit Euler method', order=1, fixed_step=.true., caught_by_reset=.true.)))
        call known%add(runge_kutta_t(table=explicit_table(2, [0.5_dp], [0.0_dp, 1.0_dp]), info=method_info_t( &
            'rk2', 'explicit midpoint rule (the paper, Appendix C)', order=2, fixed_step=.true.)))
        call known%add(runge_kutta_t(table=classical_table(), info=method_info_t( &
            'rk4', 'classical Runge-Kutta method (Kutta 1901)', order=4, fixed_step=.true.)))
        known%family = 'implicit Runge-Kutta'
        call known%add(implicit_runge_kutta_t(table=theta_table(0.5_dp), info=method_info_t( &
            'crank_nicolson_1', 'trapezoidal rule (the paper, Appendix D)', &
            order=2, fixed_step=.true., implicit=.true., symmetric=.true.)))
        call known%add(implicit_runge_kutta_t(table=gauss_table(1), info=method_info_t( &
            'crank_nicolson_2', 'implicit midpoint rule, the Gauss-Legendre method of order 2 (Appendix D)', &
            order=2, fixed_step=.true., implicit=.true., symmetric=.true.)))
        call known%add(implicit_runge_kutta_t(table=theta_table(2.0_dp / 3), info=method_info_t( &
            'galerkin', 'theta method with alpha = 2/3 (Appendix D)', &
            order=1, fixed_step=.true., implicit=.true.)))
        call known%add(implicit_runge_kutta_t(table=theta_table(1.0_dp), info=method_info_t( &
            'euler_backward', 'implicit Euler method (Appendix D)', &
            order=1, fixed_step=.true., implicit=.true., caught_by_reset=.true.)))
        known%family = 'Gauss-Legendre'
        call known%add(implicit_runge_kutta_t(table=gauss_table(2), info=method_info_t( &
            'gauss_4', 'Gauss-Legendre collocation with 2 stages, symplectic', &
            order=4, fixed_step=.true., implicit=.true., symmetric=.true.)))
        call known%add(implicit_runge_kutta_t(table=gauss_table(3), info=method_info_t( &
            'gauss_6', 'Gauss-Legendre collocation with 3 stages, symplectic', &
            order=6, fixed_step=.true., implicit=.true., symmetric=.true.)))
        call known%add(implicit_runge_kutta_t(table=gauss_table(4), info=method_info_t( &
            'gauss_8', 'Gauss-Legendre collocation with 4 stages, symplectic', &
            order=8, fixed_step=.true., implicit=.true., symmetric=.true.)))
        known%family = 'Lie group'
        call known%add(munthe_kaas_t(table=classical_table(), info=method_info_t( &
            'rkmk_4', 'Runge-Kutta-Munthe-Kaas method on the rotation group', &
            order=4, fixed_step=.true., needs=structure_group)))
        call known%add(commutator_free_t(info=method_info_t( &
            'commutator_free_4', 'commutator-free method of Celledoni, Marthinsen and Owren', &
            order=4, fixed_step=.true., needs=structure_group)))
        known%family = 'splitting'
        call known%add(splitting_t(table=splitting_table(2, [.false., .true.]), info=method_info_t( &
            'splitting_2', 'kick, drift, kick (Stoermer, Verlet, Strang)', &
            order=2, fixed_step=.true., symmetric=.true., needs=structure_split)))
        call known%add(splitting_t(table=splitting_table(4, [.false., .true.]), info=method_info_t( &
            'splitting_4', 'splitting of Blanes and Moan (2002), or of Suzuki (1990)', &
            order=4, fixed_step=.true., symmetric=.true., needs=structure_split)))
        call known%add(splitting_t(table=splitting_table(6, [.false., .true.]), info=method_info_t( &
            'splitting_6', 'splitting of Blanes and Moan (2002), or of Kahan and Li (1997)', &
            order=6, fixed_step=.true., symmetric=.true., needs=structure_split)))
        call known%add(splitting_t(table=splitting_table(8, [.false., .true.]), info=method_info_t( &
            'splitting_8', 'splitting of Kahan and Li (1997)', &
            order=8, fixed_step=.true., symmetric=.true., needs=structure_split)))
        known%family = 'embedded Runge-Kutta'
        call known%add(ode45_t(table=dormand_prince_table(), info=method_info_t( &
            'ode45', "Dormand-Prince 5(4) with MATLAB's step control", order=5, adaptive=.true., &
            relative_tolerance=1.0e-3_dp, absolute_tolerance=1.0e-6_dp, refine=4)))
        call known%add(dop853_t(table=dop853_table(), info=method_info_t( &
            'dop853', 'Dormand-Prince 8(5,3) of Hairer, Norsett and Wanner', order=8, &
            fixed_step=.true., adaptive=.true.)))
        known%family = 'Taylor series'
        call known%add(taylor_t(info=taylor_info))
        call known%add(taylor_quadruple_t(info=method_info_t( &
            'taylor_quadruple', 'Taylor series of order 30 in quadruple precision, for reference motions', &
            order=30, adaptive=.true., needs=structure_quadruple, relative_tolerance=1.0e-26_dp, &
            absolute_tolerance=1.0e-29_dp, finest_tolerance=1.0e-31_dp)))
        known%family = 'embedded Runge-Kutta'
        call known%add(arkode_t(info=method_info_t( &
            'arkode_erk', 'explicit Runge-Kutta of SUNDIALS ARKODE', &
            fixed_step=.true., adaptive=.true., takes_table=.true.)))
        call known%add(arkode_t(info=method_info_t( &
            'arkode_dirk', 'diagonally implicit Runge-Kutta of SUNDIALS ARKODE', &
            fixed_step=.true., adaptive=.true., implicit=.true., takes_table=.true.)))
    end subroutine list_methods

    !> Adds a method.
    subroutine add(self, prototype)
        class(registry_t), intent(inout) :: self
        class(stepper_t), intent(in) :: prototype
        self%size = self%size + 1
        allocate (self%entry(self%size)%prototype, source=prototype)
        self%entry(self%size)%prototype%info%family = self%family
    end subroutine add

    !> Adds a method of your own, which inputs may then name as any other. Call it before anything runs in threads.
    subroutine register_method(prototype, error)
        class(stepper_t), intent(in) :: prototype !! the method with its properties `info` and default settings
        type(error_t), allocatable, intent(out) :: error !! why it cannot be added; not allocated on success
        character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz', others = '0123456789_'
        type(registry_t), pointer :: known
        character(:), allocatable :: name
        integer :: i

        known => known_methods()
        name = trim(prototype%info%name)
        associate (info => prototype%info)
            if (verify(info%name(1:1), letters) > 0 .or. verify(name, letters // others) > 0) then
                error = input_error("'" // name // "' is no name of a method: info%name begins with a letter, and has small &
                                    &letters, digits and _")
            else if (any([(known%entry(i)%prototype%info%name == name, i=1, known%size)]) .or. name == exact_info%name .or. &
                     name == 'auto') then
                error = input_error('there is a method ' // name // ' already: info%name is another name')
            else if (.not. (info%fixed_step .or. info%adaptive)) then
                error = input_error('method ' // name // ' has neither info%fixed_step nor info%adaptive: set what it has')
            else if (known%size == most) then
                error = input_error('there is no room for another method')
            else
                known%family = 'own'
                call known%add(prototype)
            end if
        end associate
    end subroutine register_method

    !> Names and properties of all methods.
    function method_infos() result(infos)
        type(method_info_t), allocatable :: infos(:)
        type(registry_t), pointer :: known
        integer :: i
        known => known_methods()
        allocate (infos(known%size))
        do i = 1, known%size
            infos(i) = known%entry(i)%prototype%info
        end do
    end function method_infos

    !> The method of a name, with default settings; not allocated, with `status_unknown_name`, if there is
    !> none.
    subroutine create_stepper(name, stepper, status)
        character(*), intent(in) :: name !! as in an input
        class(stepper_t), allocatable, intent(out) :: stepper !! not allocated if the name is unknown
        integer, intent(out), optional :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(registry_t), pointer :: known
        integer :: i
        known => known_methods()
        do i = 1, known%size
            if (known%entry(i)%prototype%info%name /= name) cycle
            allocate (stepper, source=known%entry(i)%prototype)
            exit
        end do
        if (present(status)) status = merge(status_ok, status_unknown_name, allocated(stepper))
    end subroutine create_stepper

    !> Whether a stepper, with its settings, can integrate a formulation for a body: `status_ok`, or the first
    !> of
    !>
    !> * `status_unsuitable`: the equations do not hold for the body;
    !> * `status_no_structure`: the method needs more of them than y' = f(t, y), and they do not offer it;
    !> * `status_stuck_at_turn`: the method would be caught at the first turning point of theta;
    !> * `status_bad_projection`: there is nothing to project on;
    !> * a status of the settings of the method, such as `status_no_steps`.
    integer function can_run(stepper, formulation, body) result(status)
        class(stepper_t), intent(in) :: stepper !! the method with its settings
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(formulation_info_t) :: form
        form = formulation%info()
        if (.not. holds_for(form, body)) then
            status = status_unsuitable
        else if (.not. has_structure(form, stepper%info)) then
            status = status_no_structure
        else if (.not. passes_turns(form, stepper%info)) then
            status = status_stuck_at_turn
        else
            status = projection_status(stepper%controls%project, form, body)
            if (is_ok(status)) status = controls_status(stepper%info, stepper%controls)
        end if
    end function can_run

    !> Whether the equations hold for a body.
    pure logical function holds_for(form, body)
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        if (form%symmetric_only) then
            holds_for = body%is_lagrange() .and. body%inertia(1) > 0
        else
            holds_for = all(body%inertia > 0)
        end if
        if (allocated(body%effects)) holds_for = holds_for .and. form%takes_effects
    end function holds_for

    !> Whether the equations offer the structure that a method needs.
    pure logical function has_structure(form, method)
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(method_info_t), intent(in) :: method !! properties of the method
        has_structure = method%needs == structure_none
        if (.not. has_structure) has_structure = form%offers(method%needs)
    end function has_structure

    !> Whether a method passes the turning points of theta with these equations.
    !>
    !> With theta' = v reset from the energy after each step, v^2 = 2 a d at a distance d from a turning point
    !> where theta'' = -a. A step of size h of a method with sum b_i c_i = c takes x = v/(a h) to
    !> sqrt((x - 1)^2 + 2 c - 1), with the sign of x - 1. For c = 1/2, every method of order 2 or more, this
    !> is |x - 1|: the turning point is passed. For c = 0 (explicit Euler) the root vanishes at once, and
    !> v = 0 does not move theta. For c = 1 (implicit Euler) x tends to 1 from above, where theta rests until
    !> rounding errors move it. In between (c = 2/3, `galerkin`) it is passed.
    pure logical function passes_turns(form, method)
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(method_info_t), intent(in) :: method !! properties of the method
        passes_turns = .not. (form%resets_speed .and. method%caught_by_reset)
    end function passes_turns

    !> `status_ok`, or `status_bad_projection` if there is nothing to project on: no quaternion, or no
    !> invariants. A damped body conserves only the norm of the quaternion.
    pure integer function projection_status(kind, form, body) result(status)
        integer, intent(in) :: kind !! as in `spintop_stepper`
        type(formulation_info_t), intent(in) :: form !! properties of the formulation
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        logical :: possible
        select case (kind)
        case (project_nothing)
            possible = .true.
        case (project_unit)
            possible = form%quaternion > 0
        case (project_invariants)
            possible = form%invariants > 0 .and. all(is_zero(body%damping))
        case default
            possible = .false.
        end select
        status = merge(status_ok, status_bad_projection, possible)
    end function projection_status

    !> `status_ok`, or the status of settings that are not valid for a method.
    pure integer function controls_status(method, controls) result(status)
        type(method_info_t), intent(in) :: method !! properties of the method
        type(controls_t), intent(in) :: controls !! settings of the method
        type(arkode_table_t) :: table
        status = status_ok
        associate (relative => controls%relative_tolerance, absolute => controls%absolute_tolerance)
            if (.not. (relative > 0 .and. relative <= huge(relative) .and. absolute > 0 .and. absolute <= huge(absolute))) then
                status = status_bad_tolerance
            else if (controls%steps < 0 .or. controls%max_steps <= 0) then
                status = status_bad_steps
            else if (controls%steps > 0 .and. .not. method%fixed_step) then
                status = status_no_fixed_steps
            else if (controls%steps == 0 .and. .not. method%adaptive) then
                status = status_no_steps
            else if (controls%steps == 0 .and. relative < method%finest_tolerance) then
                status = status_bad_tolerance
            end if
        end associate
        if (.not. is_ok(status) .or. controls%table == '') return
        table = arkode_table(controls%table, method%implicit)
        if (.not. method%takes_table .or. table%stages == 0) status = status_bad_table
    end function controls_status

    !> Status of a call of `integrate`: that of `can_run`, and of the body, the start, the end of the span and
    !> the sample times, which increase from 0 to that end at most.
    integer function call_status(stepper, formulation, body, start, t_end, samples) result(status)
        class(stepper_t), intent(in) :: stepper !! the method with its settings
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t_end, samples(:) !! end of the span, and the sample times, s
        status = body_status(body)
        if (is_ok(status)) status = start_status(start, body)
        if (is_ok(status) .and. .not. (t_end >= 0 .and. t_end <= huge(t_end))) status = status_bad_span
        if (.not. (all(samples >= 0 .and. samples <= t_end) .and. all(samples(2:) >= samples(:size(samples) - 1)))) then
            if (is_ok(status)) status = status_bad_samples
        end if
        if (is_ok(status)) status = can_run(stepper, formulation, body)
    end function call_status

end module spintop_methods
