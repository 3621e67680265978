!> What the method of a plan takes: step size or tolerances, the solver of implicit steps, a Butcher table, and the
!> projection after each step.
module spintop_plan_controls
    use spintop_kinds, only: dp
    use spintop_arkode, only: arkode_table_names
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_info_t
    use spintop_parameters, only: is_set, unset_integer
    use spintop_problems, only: problems_t
    use spintop_projection, only: project_nothing, project_unit, projection_names
    use spintop_plan, only: plan_t
    use spintop_scene_keys, only: scene_t
    use spintop_status, only: is_ok
    use spintop_suitability, only: projection_status
    use spintop_text, only: join, did_you_mean, lower_case, string_t, to_text
    implicit none
    private
    public :: read_controls, read_projection

    !> Maximum ratio of the absolute to the relative tolerance, if only the latter is given. It is the ratio
    !> of the defaults of MATLAB, 1e-3 and 1e-6. In MATLAB itself a small relative tolerance alone has little
    !> effect, because the absolute one does not change.
    real(dp), parameter :: absolute_share = 1.0e-3_dp

contains

    !> Reads what a scene says of steps, tolerances, solver and table, as far as the method of the plan takes it.
    subroutine read_controls(scene, plan, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(plan_t), intent(inout) :: plan !! with its method
        type(problems_t), intent(inout) :: problems !! problems of the scene are added

        call read_steps(scene, plan, problems)
        call read_tolerances(scene, plan, problems)
        call read_solver(scene, plan, problems)
        call read_butcher_table(scene, plan, problems)
        associate (controls => plan%stepper%controls)
            if (controls%steps > 0 .or. plan%step > 0) then
                plan%method = plan%method // ', fixed step size'
            else
                plan%method = plan%method // ', relative tolerance ' // to_text(controls%relative_tolerance) &
                              // ', absolute ' // to_text(controls%absolute_tolerance)
            end if
            if (controls%table /= '') plan%method = plan%method // ', table ' // trim(controls%table)
        end associate
    end subroutine read_controls

    !> The number of fixed steps, or the largest of them, where the method takes such steps.
    subroutine read_steps(scene, plan, problems)
        type(scene_t), intent(in) :: scene
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems

        associate (info => plan%stepper%info)
            if (scene%steps /= unset_integer .and. is_set(scene%step)) then
                call problems%add('integration.step', 'the steps are given twice', 'give steps or step')
            else if (wants_steps(scene) .and. .not. info%fixed_step) then
                call problems%add(merge('integration.steps', 'integration.step ', scene%steps /= unset_integer), &
                                  method_of(plan) // ' is adaptive, and does not use steps or step', 'give relative_tolerance')
            else if (.not. wants_steps(scene) .and. .not. info%adaptive) then
                call problems%add('integration', method_of(plan) // ' has a fixed step size, and neither steps &
                    &nor step is given', 'give steps or step')
            end if
        end associate
        if (scene%steps /= unset_integer) plan%stepper%controls%steps = scene%steps
        if (is_set(scene%step)) plan%step = scene%step
    end subroutine read_steps

    !> Whether a scene asks for fixed steps.
    pure logical function wants_steps(scene)
        type(scene_t), intent(in) :: scene
        wants_steps = scene%steps /= unset_integer .or. is_set(scene%step)
    end function wants_steps

    !> The method of a plan in a message.
    function method_of(plan) result(text)
        type(plan_t), intent(in) :: plan
        character(:), allocatable :: text
        text = 'method ' // trim(plan%stepper%info%name)
    end function method_of

    !> The tolerances given, or those of the method's own. A relative one that is given takes the absolute one along; zero stands
    !> for the finest one.
    subroutine read_tolerances(scene, plan, problems)
        type(scene_t), intent(in) :: scene
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems

        associate (info => plan%stepper%info, controls => plan%stepper%controls)
            if (info%relative_tolerance > 0) controls%relative_tolerance = info%relative_tolerance
            if (info%absolute_tolerance > 0) controls%absolute_tolerance = info%absolute_tolerance
            call read_tolerance('integration.relative_tolerance', scene%relative_tolerance, controls%relative_tolerance)
            if (.not. controls%relative_tolerance > 0) controls%relative_tolerance = info%finest_tolerance
            if (controls%relative_tolerance < info%finest_tolerance) then
                call problems%add('integration.relative_tolerance', method_of(plan) // ' cannot reach a &
                    &tolerance below ' // to_text(info%finest_tolerance), "method = 'taylor_quadruple' can")
            end if
            if (is_set(scene%relative_tolerance)) controls%absolute_tolerance = &
                min(controls%absolute_tolerance, absolute_share * controls%relative_tolerance)
            call read_tolerance('integration.absolute_tolerance', scene%absolute_tolerance, controls%absolute_tolerance)
        end associate

    contains

        !> A tolerance that is given is for adaptive methods.
        subroutine read_tolerance(name, given, tolerance)
            character(*), intent(in) :: name
            real(dp), intent(in) :: given
            real(dp), intent(inout) :: tolerance
            if (.not. is_set(given)) return
            tolerance = given
            if (wants_steps(scene) .or. .not. plan%stepper%info%adaptive) then
                call problems%add(name, method_of(plan) // ' with a fixed step size does not use tolerances', 'omit it')
            end if
        end subroutine read_tolerance

    end subroutine read_tolerances

    !> The solver is for implicit steps.
    subroutine read_solver(scene, plan, problems)
        type(scene_t), intent(in) :: scene
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems

        plan%stepper%controls%fixed_point = scene%solver == 'fixed_point'
        if (plan%stepper%controls%fixed_point .and. .not. plan%stepper%info%implicit) then
            call problems%add('integration.solver', method_of(plan) // ' is explicit and needs no solver', 'omit it')
        end if
    end subroutine read_solver

    !> A Butcher table is for ARKODE, and must be one of its tables.
    subroutine read_butcher_table(scene, plan, problems)
        type(scene_t), intent(in) :: scene
        type(plan_t), intent(inout) :: plan
        type(problems_t), intent(inout) :: problems
        type(string_t), allocatable :: known(:)
        character(:), allocatable :: nearest
        integer :: i

        plan%stepper%controls%table = lower_case(scene%table)
        if (scene%table == '') return
        if (.not. plan%stepper%info%takes_table) then
            call problems%add('integration.table', method_of(plan) // ' does not use a Butcher table', 'omit it')
            return
        end if
        allocate (known, source=arkode_table_names(plan%stepper%info%implicit))
        do i = 1, size(known)
            if (known(i)%text == lower_case(scene%table)) return
        end do
        nearest = did_you_mean(scene%table, known)
        if (nearest /= '') nearest = nearest // ' '
        call problems%add('integration.table', method_of(plan) // ' has no table ''' // trim(scene%table) // '''', &
                          nearest // 'it has ' // join(known, ', '))
    end subroutine read_butcher_table

    !> What is projected after each step.
    subroutine read_projection(scene, body, plan, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(plan_t), intent(inout) :: plan !! model, method and settings
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
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

end module spintop_plan_controls
