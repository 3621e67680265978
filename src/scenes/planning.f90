!> The plan of a scene: the model and the method that compute it, steps and rows, and the reasons for them; the automatic
!> choice of a method, and its settings.
module spintop_planning
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_arkode, only: arkode_table_names
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_effects_of_scene, only: warn_of_effects
    use spintop_formulation, only: formulation_info_t, structure_names, structure_split, formulation_t
    use spintop_formulations, only: create_formulation, formulation_infos
    use spintop_kinds, only: dp
    use spintop_methods, only: can_run, create_stepper, exact_info, has_structure, holds_for, passes_turns, projection_status
    use spintop_own_butcher_tables, only: create_method
    use spintop_parameters, only: is_set, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    use spintop_status, only: is_ok, status_meaning
    use spintop_stepper, only: controls_t, project_nothing, project_unit, projection_names, stepper_t
    use spintop_text, only: to_text, join, did_you_mean, lower_case, string_t
    implicit none
    private
    public :: plan_t, make_plan, recommend_adaptive, recommend_steps, known_for, sample_time, sample_times

    !> Maximum ratio of the absolute to the relative tolerance, if only the latter is given. It is the ratio
    !> of the defaults of MATLAB, 1e-3 and 1e-6. In MATLAB itself a small relative tolerance alone has little
    !> effect, because the absolute one does not change.
    real(dp), parameter :: absolute_share = 1.0e-3_dp

    !> Description of the bodies for which `body_t%is_lagrange` is true, and of those that have a closed form.
    character(*), parameter :: known_for = 'an undamped symmetric top with its centre of mass on &
        &body z, at or above the pivot', free_body = 'an undamped body without gravitational torque', &
        solvable_effects = 'a rotor with constant momentum on the axis of an undamped symmetric top, and the rotation of &
        &the Earth at a pole', &
        solved_for = known_for // ', and ' // free_body
    !> The default formulations.
    character(*), parameter :: of_symmetric_tops = 'space_frame', of_any_body = 'rigid_body '

    !> A method, the smallest tolerance for which it is recommended, and the reason.
    type :: recommendation_t
        character(20) :: method
        real(dp) :: least
        character(96) :: why
    end type recommendation_t

    !> The first one is used that the equations support and whose smallest tolerance is not above the
    !> requested one.
    type(recommendation_t), parameter :: recommendations(*) = [ &
        recommendation_t('taylor', 1.0e-15_dp, 'the cheapest at any tolerance where the equations have a power series'), &
        recommendation_t('taylor_quadruple', 0.0_dp, 'double precision cannot reach a tolerance below 1e-15'), &
        recommendation_t('dop853', 0.0_dp, 'the cheapest at any tolerance where the equations have no power series')]

    !> For a fixed step size: symmetric tops whose equations can be split, and others.
    type(recommendation_t), parameter :: for_split_tops = recommendation_t( &
        'splitting_6', 0.0_dp, 'the cheapest with a fixed step size for tops that can be split, without energy drift'), &
        for_steps = recommendation_t('dop853', 0.0_dp, 'the cheapest with a fixed step size, of high order')

    character, parameter :: axis_letters(3) = ['x', 'y', 'z']

    !> Number of rows of a trajectory of an adaptive method, if it is not given.
    integer, parameter :: default_samples = 1001
    !> Maximum number of fixed steps.
    real(dp), parameter :: most_steps = 1.0e9_dp
    !> A span that is this close to an integer number of steps has that number.
    real(dp), parameter :: step_slack = 1.0e-9_dp

    !> The settings of a computation.
    type :: plan_t
        !> Whether the exact solution is used, without formulation and stepper.
        logical :: exact = .false.
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        !> Largest fixed step size, s; 0 if the number of steps is given.
        real(dp) :: step = 0
        !> Number of rows of the table.
        integer :: samples = default_samples
        !> Maximum work of a case, in steps (`controls_t`).
        integer(int64) :: max_steps = 1000000
        !> Selected model and method, and the reasons, in sentences.
        character(:), allocatable :: model, method, reason
    contains
        procedure :: fit_steps
        procedure :: has_too_many_steps
        procedure :: is_adaptive
        procedure :: formulation_name
    end type plan_t

contains

    !> Selects model and method for a case of the scene, and checks that they can be combined.
    subroutine make_plan(scene, case, plan, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(case_t), intent(in) :: case !! the case that is planned: its body decides the method, its span the steps
        type(plan_t), intent(out) :: plan !! model, method and settings; valid without errors in `problems`
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        integer :: status

        call choose_method(scene, case%body, plan, problems)
        plan%max_steps = scene%max_steps
        if (problems%any()) return
        if (case%turn%is_shifted()) then
            plan%reason = plan%reason // ' The rotor on the axis and the rotation of the frame about the vertical only add &
                &constants to the rates of phi and psi, so the motion is computed as that of a top without them.'
        end if
        if (case%turn%to_principal_axes) then
            plan%reason = plan%reason // ' The body is rotated internally to its principal axes. The results are rotated back.'
        else if (case%turn%axis > 0) then
            plan%reason = plan%reason // ' The body is rotated internally: its symmetry axis, body ' &
                // axis_letters(case%turn%axis) // ', becomes z, with the centre of mass above the &
                &pivot. The results are rotated back.'
        end if
        if (plan%exact) then
            if (scene%samples /= unset_integer) plan%samples = scene%samples
            return
        end if
        call choose_formulation(scene, case%body, plan, problems)
        call read_controls(scene, plan, problems)
        call read_projection(scene, case%body, plan, problems)
        if (problems%any()) return
        call warn_of_effects(case%body, case%t_end, plan%stepper%controls%steps > 0 .or. plan%step > 0, problems)
        call set_samples(scene, case, plan, problems)
        if (problems%any()) return
        status = can_run(plan%stepper, plan%formulation, case%body)
        if (.not. is_ok(status)) call problems%add('integration', status_meaning(status), &
                                                   'see what goes together in doc/methods.md')
    end subroutine make_plan

    !> The named method, or the cheapest adequate one.
    subroutine choose_method(scene, body, plan, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: settings(8) = [character(18) :: 'formulation', 'steps', 'step', 'table', &
            'relative_tolerance', 'absolute_tolerance', 'solver', 'project']
        logical :: are_given(size(settings))
        character(:), allocatable :: name
        integer :: i

        select case (scene%method)
        case (exact_info%name)
            plan%exact = .true.
            plan%reason = 'The input names the exact solution.'
            if (allocated(body%effects)) then
                call problems%add('integration.method', 'with effects the exact solution exists only for ' // solvable_effects, &
                                  "use method = 'auto'")
            else if (.not. body%has_closed_form()) then
                call problems%add('integration.method', 'the exact solution exists only for ' // solved_for, &
                                  "use method = 'auto'")
            end if
        case ('auto')
            call choose_automatically(scene, body, plan)
        case default
            call create_method(scene, plan%stepper)
            plan%reason = 'The input names method ' // trim(scene%method) // '.'
        end select
        if (allocated(plan%stepper)) then
            plan%method = trim(plan%stepper%info%name) // ': ' // trim(plan%stepper%info%what)
        else
            plan%method = trim(exact_info%name)
        end if
        if (.not. plan%exact) return
        plan%model = 'closed form of a symmetric top in theta functions'
        if (.not. body%is_lagrange()) plan%model = 'closed form of a free body in theta functions'
        ! Settings that the exact solution does not use are errors if the input names that.
        are_given = [scene%formulation /= 'auto', scene%steps /= unset_integer, is_set(scene%step), scene%table /= '', &
                     is_set(scene%relative_tolerance), is_set(scene%absolute_tolerance), scene%solver /= 'newton', &
                     scene%project /= projection_names(project_nothing)]
        do i = 1, size(settings)
            if (.not. are_given(i)) cycle
            name = 'integration.' // trim(settings(i))
            if (scene%method == exact_info%name) then
                call problems%add(name, 'the exact solution does not use ' // name, 'omit it')
            else
                call problems%warn(name, name // ' is not used: the motion is computed in closed form, to rounding', &
                                   'omit it, or name a method to have the motion integrated')
                plan%reason = plan%reason // ' ' // name // ' is not used.'
            end if
        end do
    end subroutine choose_method

    !> The named formulation, or the default one; and whether body and method go with it.
    subroutine choose_formulation(scene, body, plan, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        type(formulation_info_t) :: info
        type(formulation_info_t), allocatable :: forms(:)
        character(:), allocatable :: name
        logical :: suits
        integer :: i

        suits = .false.
        if (scene%formulation == 'auto') then
            if (body%is_lagrange()) then
                call create_formulation(of_symmetric_tops, plan%formulation)
                info = plan%formulation%info()
                suits = has_structure(info, plan%stepper%info)
            end if
            if (suits) then
                plan%reason = plan%reason // ' The equations are those of ' // of_symmetric_tops // ', &
                    &regular at the poles and cheap for a spin of any speed.'
            else
                call create_formulation(trim(of_any_body), plan%formulation, body=body)
                plan%reason = plan%reason // ' The equations are those of ' // trim(of_any_body) // ', which hold for any &
                    &body in any attitude.'
            end if
        else
            call create_formulation(trim(scene%formulation), plan%formulation, body=body)
            plan%reason = plan%reason // ' The input names formulation ' // trim(scene%formulation) // '.'
        end if
        info = plan%formulation%info()
        plan%model = trim(info%name) // ': ' // trim(info%what)
        if (allocated(body%effects) .and. .not. info%takes_effects) then
            call problems%add('integration.formulation', 'formulation ' // trim(info%name) // ' does not hold for a body &
                              &with effects, but for ' // solvable_effects, "use formulation = 'rigid_body'")
        else if (.not. holds_for(info, body)) then
            call problems%add('integration.formulation', 'formulation ' // trim(info%name) // ' holds for ' &
                              // known_for, 'I1 = I2, no damping, no centre of mass off body z')
        end if
        ! A method may need more of the equations than y' = f(t, y), or be caught by them.
        name = 'method ' // trim(plan%stepper%info%name)
        associate (method => plan%stepper%info)
            if (allocated(body%effects) .and. .not. has_structure(info, method)) then
                call problems%add('integration.method', name // ' needs equations with ' // &
                                  trim(structure_names(method%needs)) // ', and those with these effects have none', &
                                  "use method = 'auto'")
            else if (.not. has_structure(info, method)) then
                allocate (forms, source=formulation_infos())
                call problems%add('integration.formulation', name // ' needs a formulation with ' // &
                                  trim(structure_names(method%needs)) // ', and ' // trim(info%name) // ' has none', &
                    'these have: ' // join(pack(forms%name, [(has_structure(forms(i), method), i=1, size(forms))]), ', '))
            else if (.not. passes_turns(info, method)) then
                call problems%add('integration.method', name // ' stays at the first turning point of theta, because &
                    &theta_rate is reset from the energy after each step in ' // trim(info%name) // ': with more steps it &
                    &converges to a wrong motion', "use a method of order 2 or more, such as 'rk4', or formulation = 'lagrange'")
            end if
        end associate
    end subroutine choose_formulation

    !> Number of rows; with a fixed step size rows are at steps.
    subroutine set_samples(scene, case, plan, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        integer :: wanted, below

        call plan%fit_steps(case%t_end)
        if (plan%has_too_many_steps(case%t_end)) then
            call problems%add('integration.step', 'the span has more than ' // to_text(plan%stepper%controls%steps) // &
                              ' steps of this size', 'increase step')
        end if
        if (plan%is_adaptive()) then
            if (scene%samples /= unset_integer) plan%samples = scene%samples
            return
        end if
        associate (steps => plan%stepper%controls%steps)
            plan%samples = steps + 1
            ! If an event ends the motion, every step is a row.
            if (scene%samples == unset_integer .or. scene%stop_at /= '') return
            wanted = scene%samples - 1
            plan%samples = scene%samples
            if (mod(steps, wanted) == 0) return
            below = (steps / wanted) * wanted
            call problems%add('span.samples', 'rows of a method with a fixed step size are at its steps, and ' // &
                to_text(wanted) // ' intervals do not divide ' // to_text(steps) // ' steps', &
                'nearest number of steps: ' // to_text(merge(below, below + wanted, &
                below > 0 .and. steps - below <= below + wanted - steps)) // &
                '; nearest number of samples: ' // to_text(nearest_divisor(steps, wanted) + 1))
        end associate
    end subroutine set_samples

    !> The divisor of a number that is nearest to another number.
    pure integer function nearest_divisor(number, near) result(divisor)
        integer, intent(in) :: number, near
        integer :: distance
        divisor = number
        if (near >= number) return
        do distance = 0, number
            divisor = near - distance
            if (divisor >= 1) then
                if (mod(number, divisor) == 0) return
            end if
            divisor = near + distance
            if (mod(number, divisor) == 0) return
        end do
        divisor = 1
    end function nearest_divisor

    !> Reads what a scene says of steps, tolerances, solver and table, as far as the method of the plan takes it. A relative
    !> tolerance that is given takes the absolute one along; zero stands for the finest one.
    subroutine read_controls(scene, plan, problems)
        type(scene_t), intent(in) :: scene
        type(plan_t), intent(inout) :: plan !! with its method
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: method

        method = 'method ' // trim(plan%stepper%info%name)
        associate (info => plan%stepper%info, controls => plan%stepper%controls)
            if (scene%steps /= unset_integer .and. is_set(scene%step)) then
                call problems%add('integration.step', 'the steps are given twice', 'give steps or step')
            else if (wants_steps(scene) .and. .not. info%fixed_step) then
                call problems%add(merge('integration.steps', 'integration.step ', scene%steps /= unset_integer), &
                                  method // ' is adaptive, and does not use steps or step', 'give relative_tolerance')
            else if (.not. wants_steps(scene) .and. .not. info%adaptive) then
                call problems%add('integration', method // ' has a fixed step size, and neither steps nor step is given', &
                                  'give steps or step')
            end if
            if (scene%steps /= unset_integer) controls%steps = scene%steps
            if (is_set(scene%step)) plan%step = scene%step

            if (info%relative_tolerance > 0) controls%relative_tolerance = info%relative_tolerance
            if (info%absolute_tolerance > 0) controls%absolute_tolerance = info%absolute_tolerance
            call read_tolerance('integration.relative_tolerance', scene%relative_tolerance, controls%relative_tolerance)
            if (.not. controls%relative_tolerance > 0) controls%relative_tolerance = info%finest_tolerance
            if (controls%relative_tolerance < info%finest_tolerance) call problems%add('integration.relative_tolerance', &
                method // ' cannot reach a tolerance below ' // to_text(info%finest_tolerance), "method = 'taylor_quadruple' can")
            if (is_set(scene%relative_tolerance)) controls%absolute_tolerance = &
                min(controls%absolute_tolerance, absolute_share * controls%relative_tolerance)
            call read_tolerance('integration.absolute_tolerance', scene%absolute_tolerance, controls%absolute_tolerance)

            controls%fixed_point = scene%solver == 'fixed_point'
            if (controls%fixed_point .and. .not. info%implicit) call problems%add('integration.solver', &
                method // ' is explicit and needs no solver', 'omit it')
            controls%table = lower_case(scene%table)
            if (scene%table /= '') call check_butcher_table()
            if (controls%steps > 0 .or. plan%step > 0) then
                plan%method = plan%method // ', fixed step size'
            else
                plan%method = plan%method // ', relative tolerance ' // to_text(controls%relative_tolerance) &
                              // ', absolute ' // to_text(controls%absolute_tolerance)
            end if
            if (controls%table /= '') plan%method = plan%method // ', table ' // trim(controls%table)
        end associate

    contains

        !> A tolerance that is given is for adaptive methods.
        subroutine read_tolerance(name, given, tolerance)
            character(*), intent(in) :: name
            real(dp), intent(in) :: given
            real(dp), intent(inout) :: tolerance
            if (.not. is_set(given)) return
            tolerance = given
            if (wants_steps(scene) .or. .not. plan%stepper%info%adaptive) call problems%add(name, &
                method // ' with a fixed step size does not use tolerances', 'omit it')
        end subroutine read_tolerance

        !> A Butcher table is for ARKODE, and must be one of its tables.
        subroutine check_butcher_table()
            type(string_t), allocatable :: known(:)
            character(:), allocatable :: nearest
            integer :: i

            if (.not. plan%stepper%info%takes_table) then
                call problems%add('integration.table', method // ' does not use a Butcher table', 'omit it')
                return
            end if
            allocate (known, source=arkode_table_names(plan%stepper%info%implicit))
            do i = 1, size(known)
                if (known(i)%text == lower_case(scene%table)) return
            end do
            nearest = did_you_mean(scene%table, known)
            if (nearest /= '') nearest = nearest // ' '
            call problems%add('integration.table', method // " has no table '" // trim(scene%table) // "'", &
                              nearest // 'it has ' // join(known, ', '))
        end subroutine check_butcher_table

    end subroutine read_controls

    !> Whether a scene asks for fixed steps.
    pure logical function wants_steps(scene)
        type(scene_t), intent(in) :: scene
        wants_steps = scene%steps /= unset_integer .or. is_set(scene%step)
    end function wants_steps

    !> What is projected after each step.
    subroutine read_projection(scene, body, plan, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: key = 'integration.project'
        type(formulation_info_t) :: info
        integer :: kind

        info = plan%formulation%info()
        kind = findloc(projection_names, scene%project, dim=1) - 1
        plan%stepper%controls%project = kind
        if (.not. is_ok(projection_status(kind, info, body))) then
            if (kind == project_unit) then
                call problems%add(key, 'formulation ' // trim(info%name) // ' has no quaternion', &
                                  "omit it, or use formulation = 'rigid_body'")
            else if (allocated(body%effects)) then
                call problems%add(key, 'a body with effects conserves neither energy nor momentum', "use project = 'unit'")
            else if (info%invariants == 0) then
                call problems%add(key, 'formulation ' // trim(info%name) // ' conserves its invariants by construction', 'omit it')
            else
                call problems%add(key, 'a damped body conserves neither energy nor momentum', "use project = 'unit'")
            end if
        end if
        if (kind /= project_nothing) then
            plan%method = plan%method // ', projected after each step (' // trim(projection_names(kind)) // ')'
        end if
    end subroutine read_projection

    !> Chooses the closed form where the body has one and the input does not ask for steps, else the cheapest method, and says
    !> why.
    subroutine choose_automatically(scene, body, plan)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        character(*), parameter :: default_with_table = 'arkode_erk'

        plan%exact = body%has_closed_form() .and. scene%formulation == 'auto' .and. scene%table == '' .and. &
                     .not. wants_steps(scene)
        if (plan%exact) then
            plan%reason = 'The body is ' // known_for
            if (.not. body%is_lagrange()) plan%reason = 'The body is ' // free_body
            plan%reason = plan%reason // ', so the motion is computed in closed form: &
                &accurate to rounding at any time, at a cost that does not depend on the time span, without steps.'
            return
        end if
        if (body%has_closed_form()) then
            plan%reason = 'The input names a formulation, a table or steps, so the motion is integrated numerically, although &
                &a closed form exists.'
        else if (allocated(body%effects)) then
            plan%reason = 'The body has effects (&effects), so there is no closed form and the motion is integrated &
                &numerically; a closed form exists only with ' // solvable_effects // '. Splitting methods, projection onto &
                &invariants and quantities of the undisturbed top are excluded.'
        else
            plan%reason = 'The body is neither ' // known_for // ' nor ' // free_body // ', so there is no closed form and the &
                &motion is integrated numerically.'
        end if
        if (scene%table == '') then
            call choose_default(scene, body, plan)
        else
            call create_stepper(default_with_table, plan%stepper)
            plan%reason = plan%reason // ' ' // default_with_table // ' uses the named table.'
        end if
    end subroutine choose_automatically

    !> The cheapest adaptive stepper or, on request, the cheapest one with a fixed step size, for the named formulation or
    !> the default one of methods that it supports.
    subroutine choose_default(scene, body, plan)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(controls_t), parameter :: defaults = controls_t()
        class(formulation_t), allocatable :: formulation
        character(len(scene%formulation)) :: name
        character(:), allocatable :: why
        real(dp) :: tolerance

        name = scene%formulation
        if (name == 'auto') name = merge(of_symmetric_tops, of_any_body, body%is_lagrange())
        call create_formulation(trim(name), formulation, body=body)
        tolerance = defaults%relative_tolerance
        ! Zero is the finest tolerance of the method, whichever it is.
        if (is_set(scene%relative_tolerance) .and. scene%relative_tolerance > 0) tolerance = scene%relative_tolerance
        if (wants_steps(scene)) then
            call recommend_steps(formulation%info(), plan%stepper, why)
        else
            call recommend_adaptive(tolerance, formulation%info(), plan%stepper, why)
        end if
        plan%reason = plan%reason // ' ' // trim(plan%stepper%info%name) // ' is the default: ' // why // '.'
    end subroutine choose_default

    !> The stepper for a tolerance with these equations.
    subroutine recommend_adaptive(tolerance, info, stepper, why)
        real(dp), intent(in) :: tolerance !! relative tolerance
        type(formulation_info_t), intent(in) :: info !! properties of the formulation
        class(stepper_t), allocatable, intent(out) :: stepper !! the recommended method
        character(:), allocatable, intent(out) :: why !! reason for the recommendation
        integer :: i

        do i = 1, size(recommendations)
            if (tolerance < recommendations(i)%least) cycle
            call create_stepper(recommendations(i)%method, stepper)
            why = trim(recommendations(i)%why)
            if (has_structure(info, stepper%info)) return
        end do
    end subroutine recommend_adaptive

    !> The stepper for a fixed step size with these equations.
    subroutine recommend_steps(info, stepper, why)
        type(formulation_info_t), intent(in) :: info !! properties of the formulation
        class(stepper_t), allocatable, intent(out) :: stepper !! the recommended method
        character(:), allocatable, intent(out) :: why !! reason for the recommendation
        type(recommendation_t) :: recommendation
        recommendation = for_steps
        if (info%symmetric_only .and. info%offers(structure_split)) recommendation = for_split_tops
        call create_stepper(recommendation%method, stepper)
        why = trim(recommendation%why)
    end subroutine recommend_steps

    !> Number of steps of fixed size in a span, if their largest size is given, and the limit on the work of a case, which does
    !> not count them. Where they are too many, the limit stays that of adaptive methods, and ends the case.
    pure subroutine fit_steps(self, t_end)
        class(plan_t), intent(inout) :: self
        real(dp), intent(in) :: t_end !! length of the span, s
        if (self%step > 0) then
            self%stepper%controls%steps = max(1, ceiling(min(t_end / self%step * (1 - step_slack), &
                                                             most_steps)))
        end if
        associate (controls => self%stepper%controls)
            controls%max_steps = self%max_steps
            if (.not. self%has_too_many_steps(t_end)) controls%max_steps = self%max_steps + controls%steps
        end associate
    end subroutine fit_steps

    !> Whether a span has more steps of the given size than any run takes.
    pure logical function has_too_many_steps(self, t_end)
        class(plan_t), intent(in) :: self
        real(dp), intent(in) :: t_end !! length of the span, s
        has_too_many_steps = self%step > 0 .and. t_end > most_steps * self%step
    end function has_too_many_steps

    !> Whether rows may lie between steps.
    pure logical function is_adaptive(self)
        class(plan_t), intent(in) :: self
        is_adaptive = self%exact
        if (allocated(self%stepper)) is_adaptive = self%stepper%controls%steps == 0
    end function is_adaptive

    !> Name of the formulation; '' if there is none.
    function formulation_name(self) result(name)
        class(plan_t), intent(in) :: self
        character(16) :: name
        type(formulation_info_t) :: info
        name = ''
        if (.not. allocated(self%formulation)) return
        info = self%formulation%info()
        name = info%name
    end function formulation_name

    !> Time of row `i` of `samples` equally spaced rows from 0 to `t_end`, both included.
    elemental real(dp) function sample_time(t_end, samples, i)
        real(dp), intent(in) :: t_end !! end of the span, s
        integer, intent(in) :: samples, i !! number of rows, and index of the row, from 1
        sample_time = t_end
        if (i < samples) sample_time = t_end * (i - 1) / (samples - 1)
    end function sample_time

    !> The times of all rows.
    pure function sample_times(t_end, samples) result(times)
        real(dp), intent(in) :: t_end !! end of the span, s
        integer, intent(in) :: samples !! number of rows
        real(dp), allocatable :: times(:)
        integer :: i
        times = [(sample_time(t_end, samples, i), i=1, samples)]
    end function sample_times

end module spintop_planning
