!> The plan of a stability study: cases of the catalogue or of the input, and methods.
module spintop_stability_plan
    use spintop_errors, only: error_t
    use spintop_formulation, only: structure_quadruple
    use spintop_hard_cases, only: hard_cases, make_scene
    use spintop_kinds, only: dp
    use spintop_compared_methods, only: method_choice_t, set_adaptive, set_steps, find_cases, add_methods
    use spintop_methods, only: method_infos
    use spintop_parameters, only: is_set, unset, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    use spintop_stepper, only: method_info_t
    implicit none
    private
    public :: stability_plan_t, make_stability_plan, scene_of_case, scene_of_trial
    public :: own_case

    !> The rows of the table.
    type :: stability_plan_t
        !> Indices in the catalogue; 0 is the case of the input.
        integer, allocatable :: cases(:)
        type(method_choice_t), allocatable :: methods(:)
    end type stability_plan_t

    !> Name of the case of the input.
    character(*), parameter :: own_case = 'input'
    !> Default tolerance.
    real(dp), parameter :: default_tolerance = 1.0e-12_dp
    !> Default number of steps for the case of the input.
    integer, parameter :: default_steps = 8000
    !> Combinations that are run in addition to each method with the formulation that suits the body.
    character(*), parameter :: more_choices(*) = [character(28) :: 'rk4/lagrange', 'rk4/euler', &
        'ode45/lagrange', 'ode45/euler', 'dop853/lagrange', 'dop853/euler', 'taylor/rigid_body', &
        'splitting_8/rigid_body']

contains

    !> The named cases and methods, or all.
    subroutine make_stability_plan(scene, plan, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(stability_plan_t), intent(out) :: plan !! cases and methods; valid without errors in `problems`
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        character(*), parameter :: compares = 'a stability study compares methods and formulations', &
            hint = 'name them in stability.methods'
        integer :: i

        if (scene%stop_at /= '') then
            call problems%add('span.stop_at', 'a stability study computes each motion to the end of its span', 'omit it')
        end if
        if (scene%method /= 'auto') call problems%add('integration.method', compares, hint)
        if (scene%formulation /= 'auto') call problems%add('integration.formulation', compares, hint)
        if (all(scene%stability_cases == '')) then
            plan%cases = pack([(i, i=1, size(hard_cases))], .not. hard_cases%is_long)
        else
            call find_cases('stability.cases', 'case', scene%stability_cases, [character(24) :: hard_cases%name, own_case], &
                            plan%cases, problems)
            where (plan%cases > size(hard_cases)) plan%cases = 0 ! the case of the input
        end if
        if (all(scene%stability_methods == '')) then
            call choose_all_methods(plan%methods)
        else
            allocate (plan%methods(0))
            call add_methods('stability.methods', scene%stability_methods, method_infos(), ['auto'], plan%methods, &
                             problems)
        end if
    end subroutine make_stability_plan

    !> Every method with the formulation that suits the body, some also with others.
    subroutine choose_all_methods(choices)
        type(method_choice_t), allocatable, intent(out) :: choices(:)
        type(method_info_t), allocatable :: methods(:)
        integer :: i, k, slash

        allocate (methods, source=method_infos())
        allocate (choices(0))
        do i = 1, size(methods)
            choices = [choices, method_choice_t(methods(i))]
            do k = 1, size(more_choices)
                slash = index(more_choices(k), '/')
                if (more_choices(k)(:slash - 1) /= methods(i)%name) cycle
                choices = [choices, method_choice_t(methods(i), more_choices(k)(slash + 1:))]
            end do
        end do
    end subroutine choose_all_methods

    !> The scene of a case: of the catalogue, or (index 0) the input itself.
    subroutine scene_of_case(input, place, scene, error)
        type(scene_t), intent(in) :: input !! the scene of the input
        integer, intent(in) :: place !! index in the catalogue; 0 for the case of the input
        type(scene_t), intent(inout) :: scene !! becomes the scene of the case
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (place > 0) then
            call make_scene(hard_cases(place), scene, error)
        else
            scene = input
            if (scene%steps == unset_integer) scene%steps = default_steps
        end if
    end subroutine scene_of_case

    !> The scene of a case for a method: adaptive methods use the tolerances of the input, the others the
    !> number of steps of the case.
    subroutine scene_of_trial(input, scene, choice)
        type(scene_t), intent(in) :: input !! the scene of the input
        type(scene_t), intent(inout) :: scene !! method and setting are set
        type(method_choice_t), intent(in) :: choice !! method and formulation
        real(dp) :: tolerance

        if (.not. choice%method%adaptive) then
            call set_steps(scene, choice, scene%steps)
        else if (choice%method%needs == structure_quadruple) then
            call set_adaptive(scene, choice, unset) ! its default tolerances are smaller
        else
            tolerance = default_tolerance
            if (is_set(input%relative_tolerance)) tolerance = input%relative_tolerance
            scene%absolute_tolerance = input%absolute_tolerance
            call set_adaptive(scene, choice, tolerance)
        end if
    end subroutine scene_of_trial

end module spintop_stability_plan
