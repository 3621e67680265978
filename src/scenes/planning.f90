!> The plan of a scene: the model and the method that compute it, and the reasons for them.
module spintop_planning
    use spintop_automatic_method, only: choose_automatically, known_for, of_any_body, of_symmetric_tops, &
        solvable_effects, solved_for
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_effects_of_scene, only: warn_of_effects
    use spintop_formulation, only: formulation_info_t, structure_names
    use spintop_formulations, only: create_formulation, formulation_infos
    use spintop_methods, only: exact_info
    use spintop_parameters, only: is_set, unset_integer
    use spintop_plan_controls, only: read_controls, read_projection
    use spintop_projection, only: projection_names, project_nothing
    use spintop_problems, only: problems_t
    use spintop_plan, only: plan_t
    use spintop_scene_keys, only: scene_t
    use spintop_status, only: is_ok, status_meaning
    use spintop_stepper, only: method_info_t
    use spintop_suitability, only: can_run, has_structure, holds_for, passes_turns
    use spintop_own_butcher_tables, only: create_method
    use spintop_text, only: to_text, join
    implicit none
    private
    public :: make_plan

    character, parameter :: axis_letters(3) = ['x', 'y', 'z']

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
        if (plan%exact) then
            plan%model = 'closed form of a symmetric top in theta functions'
            if (.not. body%is_lagrange()) plan%model = 'closed form of a free body in theta functions'
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

        !> Reports a setting that the exact solution does not use: an error if that was named.
        subroutine refuse(name, given)
            character(*), intent(in) :: name
            logical, intent(in) :: given
            if (.not. given) return
            if (scene%method == exact_info%name) then
                call problems%add(name, 'the exact solution does not use ' // name, 'omit it')
            else
                call problems%warn(name, name // ' is not used: the motion is computed in closed form, to rounding', &
                                   'omit it, or name a method to have the motion integrated')
                plan%reason = plan%reason // ' ' // name // ' is not used.'
            end if
        end subroutine refuse

    end subroutine choose_method

    !> The named formulation, or the default one.
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
        call check_method(plan%stepper%info, info, allocated(body%effects), problems)
    end subroutine choose_formulation

    !> A method may need more of the equations than y' = f(t, y), or be caught by them.
    subroutine check_method(method, form, has_effects, problems)
        type(method_info_t), intent(in) :: method
        type(formulation_info_t), intent(in) :: form
        logical, intent(in) :: has_effects
        type(problems_t), intent(inout) :: problems
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i

        if (has_effects .and. .not. has_structure(form, method)) then
            call problems%add('integration.method', 'method ' // trim(method%name) // ' needs equations with ' &
                              // trim(structure_names(method%needs)) // ', and those with these effects have none', &
                              "use method = 'auto'")
        else if (.not. has_structure(form, method)) then
            allocate (forms, source=formulation_infos())
            call problems%add('integration.formulation', 'method ' // trim(method%name) // ' needs a formulation &
                &with ' // trim(structure_names(method%needs)) // ', and ' // trim(form%name) // ' has none', &
                'these have: ' // join(pack(forms%name, [(has_structure(forms(i), method), i=1, size(forms))]), ', '))
        else if (.not. passes_turns(form, method)) then
            call problems%add('integration.method', 'method ' // trim(method%name) // ' stays at the first turning &
                &point of theta, because theta_rate is reset from the energy after each step in ' // &
                trim(form%name) // ': with more steps it converges to a wrong motion', &
                "use a method of order 2 or more, such as 'rk4', or formulation = 'lagrange'")
        end if
    end subroutine check_method

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

end module spintop_planning
