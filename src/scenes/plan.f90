!> The plan of a scene: which model and which method carry it out, and why.
module spintop_plan
    use spintop_kinds, only: dp
    use spintop_arkode_tables, only: arkode_table_names
    use spintop_body, only: body_t
    use spintop_body_of_scene, only: is_set
    use spintop_case, only: case_t
    use spintop_formulation, only: formulation_info_t, formulation_t, structure_names
    use spintop_formulations, only: create_formulation, formulation_infos
    use spintop_methods, only: create_stepper, exact_info
    use spintop_parameters, only: unset_integer
    use spintop_projection, only: projection_names, project_nothing, project_unit, project_invariants
    use spintop_problems, only: problems_t
    use spintop_recommendation, only: recommend_adaptive, recommend_steps
    use spintop_run_plan, only: plan_t, sample_time, sample_times
    use spintop_scene, only: scene_t
    use spintop_status, only: status_ok, status_meaning
    use spintop_stepper, only: controls_t, method_info_t
    use spintop_suitability, only: can_run, has_structure, holds_for, passes_turns, projection_status
    use spintop_text, only: to_text, lower_case, nearest_word, string_t, join
    implicit none
    private
    public :: plan_t, make_plan, sample_time, sample_times

    !> Absolute over relative tolerance at most, where only the latter is given; their ratio in
    !> MATLAB's defaults, 1e-3 and 1e-6. With MATLAB itself a small relative tolerance alone does
    !> little, for the absolute one stays.
    real(dp), parameter :: absolute_share = 1.0e-3_dp

    !> The body that `body_t%is_lagrange` is about.
    character(*), parameter :: known_for = 'an undamped symmetric top with its centre of mass on &
        &body z, at or above the pivot'
    !> The default formulations.
    character(*), parameter :: of_symmetric_tops = 'space_frame', of_any_body = 'rigid_body '
    character, parameter :: axis_letters(3) = ['x', 'y', 'z']

contains

    !> Chooses model and method for a case of the scene and checks that they go together.
    subroutine make_plan(scene, case, plan, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(plan_t), intent(out) :: plan
        type(problems_t), intent(inout) :: problems
        integer :: status

        call choose_method(scene, case%body, plan, problems)
        plan%max_steps = scene%max_steps
        if (problems%any()) return
        if (case%turn%is_turned()) then
            plan%reason = plan%reason // ' The body is turned inside, so that its axis of symmetry, body ' &
                // axis_letters(case%turn%axis) // ', becomes z with the centre of mass above the &
                &pivot; the results are turned back.'
        end if
        if (plan%exact) then
            if (scene%samples /= unset_integer) plan%samples = scene%samples
            return
        end if
        call choose_formulation(scene, case%body, plan, problems)
        call take_controls(scene, plan, problems)
        call take_projection(scene, case%body, plan, problems)
        if (problems%any()) return
        call take_samples(scene, case, plan, problems)
        if (problems%any()) return
        status = can_run(plan%stepper, plan%formulation, case%body)
        if (status /= status_ok) call problems%add('integration', status_meaning(status), &
                                                   'see what goes together in doc/methods.md')
    end subroutine make_plan

    !> The method named, or the cheapest that is adequate.
    subroutine choose_method(scene, body, plan, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: default_with_table = 'arkode_erk'

        select case (scene%method)
        case (exact_info%name)
            plan%exact = .true.
            plan%reason = 'The exact motion was asked for.'
            if (.not. body%is_lagrange()) then
                call problems%add('integration.method', 'the exact motion is known for ' // known_for, &
                                  "take method = 'auto'")
            end if
        case ('auto')
            plan%exact = body%is_lagrange() .and. .not. any([scene%formulation /= 'auto', &
                scene%table /= '', scene%steps /= unset_integer, is_set(scene%step)])
            if (plan%exact) then
                plan%reason = 'The body is ' // known_for // ', so its motion is known in closed form: &
                    &good to rounding at any time, at a cost that does not depend on the time span. No step is taken.'
            else
                if (body%is_lagrange()) then
                    plan%reason = 'The input names a formulation, a table or steps, so the motion is integrated &
                        &step by step, though it is known in closed form.'
                else
                    plan%reason = 'The body is not ' // known_for // ', so there is no closed form and the motion &
                        &is integrated step by step.'
                end if
                if (scene%table == '') then
                    call choose_default(scene, body, plan)
                else
                    call create_stepper(default_with_table, plan%stepper)
                    plan%reason = plan%reason // ' ' // default_with_table // ' takes the table that was named.'
                end if
            end if
        case default
            call create_stepper(trim(scene%method), plan%stepper)
            plan%reason = 'Method ' // trim(scene%method) // ' was asked for.'
        end select
        if (allocated(plan%stepper)) then
            plan%method = trim(plan%stepper%info%name) // ': ' // trim(plan%stepper%info%what)
        else
            plan%method = trim(exact_info%name)
        end if
        if (plan%exact) then
            plan%model = 'closed form of a symmetric top in theta functions'
            call refuse('integration.formulation', scene%formulation /= 'auto')
            call refuse('integration.steps', scene%steps /= unset_integer)
            call refuse('integration.step', is_set(scene%step))
            call refuse('integration.table', scene%table /= '')
            call refuse('integration.relative_tolerance', is_set(scene%relative_tolerance))
            call refuse('integration.absolute_tolerance', is_set(scene%absolute_tolerance))
            call refuse('integration.solver', scene%solver /= 'newton')
            call refuse('integration.project', scene%project /= projection_names(project_nothing))
        end if

    contains

        !> What is given and the exact motion does not take: an error where that was asked for by name.
        subroutine refuse(name, given)
            character(*), intent(in) :: name
            logical, intent(in) :: given
            if (.not. given) return
            if (scene%method == exact_info%name) then
                call problems%add(name, 'the exact motion takes no ' // name, 'leave it out')
            else
                call problems%warn(name, name // ' is not used: the motion is computed in closed form, to rounding', &
                                   'leave it out, or name a method to have the motion integrated')
                plan%reason = plan%reason // ' ' // name // ' is not used.'
            end if
        end subroutine refuse

    end subroutine choose_method

    !> The cheapest stepper that chooses its own steps or, as wanted, takes equal ones.
    subroutine choose_default(scene, body, plan)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(controls_t), parameter :: defaults = controls_t()
        class(formulation_t), allocatable :: formulation
        character(:), allocatable :: why
        real(dp) :: tolerance

        tolerance = defaults%relative_tolerance
        if (is_set(scene%relative_tolerance)) tolerance = scene%relative_tolerance
        call create_formulation(trim(likely_formulation(scene, body)), formulation)
        if (scene%steps /= unset_integer .or. is_set(scene%step)) then
            call recommend_steps(formulation%info(), plan%stepper, why)
        else
            call recommend_adaptive(tolerance, formulation%info(), plan%stepper, why)
        end if
        plan%reason = plan%reason // ' ' // trim(plan%stepper%info%name) // ' is the default for that: ' // why // '.'
    end subroutine choose_default

    !> The formulation named, or the default one for methods that it can carry.
    pure function likely_formulation(scene, body) result(name)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        character(len(scene%formulation)) :: name
        name = scene%formulation
        if (name == 'auto') name = merge(of_symmetric_tops, of_any_body, body%is_lagrange())
    end function likely_formulation

    !> The formulation named, or the default one.
    subroutine choose_formulation(scene, body, plan, problems)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        type(formulation_info_t) :: info
        logical :: suits

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
                call create_formulation(trim(of_any_body), plan%formulation)
                plan%reason = plan%reason // ' The equations are those of ' // trim(of_any_body) // ', which hold for any &
                    &body in any attitude.'
            end if
        else
            call create_formulation(trim(scene%formulation), plan%formulation)
            plan%reason = plan%reason // ' Formulation ' // trim(scene%formulation) // ' was asked for.'
        end if
        info = plan%formulation%info()
        plan%model = trim(info%name) // ': ' // trim(info%what)
        if (.not. holds_for(info, body)) then
            call problems%add('integration.formulation', 'formulation ' // trim(info%name) // ' holds for ' &
                              // known_for, 'I1 = I2, no damping, no centre of mass off body z')
        end if
        call check_method(plan%stepper%info, info, problems)
    end subroutine choose_formulation

    !> A method may need more of the equations than y' = f(y), or be caught by them.
    subroutine check_method(method, form, problems)
        type(method_info_t), intent(in) :: method
        type(formulation_info_t), intent(in) :: form
        type(problems_t), intent(inout) :: problems
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i

        allocate (forms, source=formulation_infos())
        if (.not. has_structure(form, method)) then
            call problems%add('integration.formulation', 'method ' // trim(method%name) // ' needs equations that &
                &offer it ' // trim(structure_names(method%needs)) // ', and ' // trim(form%name) // ' has none', &
                'these have: ' // join(pack(forms%name, [(has_structure(forms(i), method), i=1, size(forms))]), ', '))
        else if (.not. passes_turns(form, method)) then
            call problems%add('integration.method', 'method ' // trim(method%name) // ' stays at the first turning &
                &point of theta for ever where theta_rate is reset from the energy after each step, as in ' // &
                trim(form%name) // ': with more steps it converges to a wrong motion', &
                "take a method of order 2 or more, such as 'rk4', or formulation = 'lagrange'")
        end if
    end subroutine check_method

    !> What is put back after each step.
    subroutine take_projection(scene, body, plan, problems)
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
        if (projection_status(kind, info, body) /= status_ok) then
            if (kind == project_unit) then
                call problems%add(key, 'formulation ' // trim(info%name) // ' holds no quaternion', &
                                  "leave it out, or take formulation = 'rigid_body'")
            else if (info%invariants == 0) then
                call problems%add(key, 'formulation ' // trim(info%name) // ' keeps its invariants by itself', 'leave it out')
            else
                call problems%add(key, 'a damped body keeps neither energy nor momentum', "take project = 'unit'")
            end if
        end if
        if (kind /= project_nothing) then
            plan%method = plan%method // ', projected after each step (' // trim(projection_names(kind)) // ')'
        end if
    end subroutine take_projection

    !> Steps, tolerances, tables and solver, as far as the method takes them.
    subroutine take_controls(scene, plan, problems)
        type(scene_t), intent(in) :: scene
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        logical :: wants_steps
        character(:), allocatable :: method

        associate (info => plan%stepper%info, controls => plan%stepper%controls)
            method = 'method ' // trim(info%name)
            wants_steps = scene%steps /= unset_integer .or. is_set(scene%step)
            if (scene%steps /= unset_integer .and. is_set(scene%step)) then
                call problems%add('integration.step', 'the steps are given twice', 'give steps or step')
            else if (wants_steps .and. .not. info%fixed_step) then
                call problems%add(merge('integration.steps', 'integration.step ', scene%steps /= unset_integer), &
                    method // ' chooses its own steps', 'give relative_tolerance')
            else if (.not. wants_steps .and. .not. info%adaptive) then
                call problems%add('integration', method // ' takes equal steps and their number is not given', &
                    'give steps or step')
            end if
            if (scene%steps /= unset_integer) controls%steps = scene%steps
            if (is_set(scene%step)) plan%step = scene%step
            if (info%relative_tolerance > 0) controls%relative_tolerance = info%relative_tolerance
            if (info%absolute_tolerance > 0) controls%absolute_tolerance = info%absolute_tolerance
            call take_tolerance('integration.relative_tolerance', scene%relative_tolerance, &
                                controls%relative_tolerance)
            if (controls%relative_tolerance < info%finest_tolerance) then
                call problems%add('integration.relative_tolerance', method // ' cannot keep a tolerance below ' // &
                    to_text(info%finest_tolerance), "method = 'taylor_quadruple' can")
            end if
            if (is_set(scene%relative_tolerance)) controls%absolute_tolerance = &
                min(controls%absolute_tolerance, absolute_share * controls%relative_tolerance)
            call take_tolerance('integration.absolute_tolerance', scene%absolute_tolerance, &
                                controls%absolute_tolerance)
            controls%max_steps = scene%max_steps
            controls%fixed_point = scene%solver == 'fixed_point'
            if (controls%fixed_point .and. .not. info%implicit) then
                call problems%add('integration.solver', method // ' has nothing to solve', 'leave it out')
            end if
            call check_table(info%takes_table, info%implicit)
            controls%table = lower_case(scene%table)
            if (controls%steps > 0 .or. plan%step > 0) then
                plan%method = plan%method // ', equal steps'
            else
                plan%method = plan%method // ', relative tolerance ' // to_text(controls%relative_tolerance) &
                              // ', absolute ' // to_text(controls%absolute_tolerance)
            end if
            if (controls%table /= '') plan%method = plan%method // ', table ' // trim(controls%table)
        end associate

    contains

        !> Tolerances are for adaptive methods.
        subroutine take_tolerance(name, given, tolerance)
            character(*), intent(in) :: name
            real(dp), intent(in) :: given
            real(dp), intent(inout) :: tolerance
            if (.not. is_set(given)) return
            tolerance = given
            if (wants_steps .or. .not. plan%stepper%info%adaptive) then
                call problems%add(name, method // ' with equal steps takes no tolerance', 'leave it out')
            end if
        end subroutine take_tolerance

        !> A Butcher table is for ARKODE, and must be one of its own.
        subroutine check_table(takes_table, implicit)
            logical, intent(in) :: takes_table, implicit
            type(string_t), allocatable :: known(:)
            character(:), allocatable :: nearest
            integer :: i
            if (scene%table == '') return
            if (.not. takes_table) then
                call problems%add('integration.table', method // ' takes no table', 'leave it out')
                return
            end if
            allocate (known, source=arkode_table_names(implicit))
            do i = 1, size(known)
                if (known(i)%text == lower_case(scene%table)) return
            end do
            nearest = nearest_word(trim(scene%table), known)
            if (nearest /= '') nearest = "did you mean '" // nearest // "'? "
            call problems%add('integration.table', method // ' has no table ''' // trim(scene%table) // '''', &
                              nearest // 'it has ' // join(known, ', '))
        end subroutine check_table

    end subroutine take_controls

    !> Number of rows; those of a fixed-step method lie on its steps.
    subroutine take_samples(scene, case, plan, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        integer :: wanted, below

        call plan%fit_steps(case%t_end)
        if (plan%stepper%controls%steps > plan%stepper%controls%max_steps) then
            call problems%add('integration.max_steps', 'a case takes ' // &
                to_text(plan%stepper%controls%steps) // ' steps, more than max_steps = ' // &
                to_text(plan%stepper%controls%max_steps), 'raise max_steps or take fewer steps')
        end if
        if (plan%is_adaptive()) then
            if (scene%samples /= unset_integer) plan%samples = scene%samples
            return
        end if
        associate (steps => plan%stepper%controls%steps)
            plan%samples = steps + 1
            ! Of a motion that an event ends every step is a row.
            if (scene%samples == unset_integer .or. scene%stop_at /= '') return
            wanted = scene%samples - 1
            plan%samples = scene%samples
            if (mod(steps, wanted) == 0) return
            below = (steps / wanted) * wanted
            call problems%add('span.samples', 'rows of a fixed-step method lie on its steps, and ' // &
                to_text(wanted) // ' intervals do not divide ' // to_text(steps) // ' steps', &
                'nearest number of steps: ' // to_text(merge(below, below + wanted, &
                below > 0 .and. steps - below <= below + wanted - steps)) // &
                '; nearest number of samples: ' // to_text(nearest_divisor(steps, wanted) + 1))
        end associate
    end subroutine take_samples

    !> The divisor of a number next to another number.
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

end module spintop_plan
