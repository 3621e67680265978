!> What a stability study goes through: cases of the catalogue or of the input, and methods.
module spintop_stability_plan
    use spintop_body_of_scene, only: is_set
    use spintop_errors, only: error_t
    use spintop_formulation, only: structure_quadruple
    use spintop_hard_cases, only: hard_cases, make_scene
    use spintop_kinds, only: dp
    use spintop_method_choice, only: method_choice_t, refuse_name, set_adaptive, set_steps, take_methods
    use spintop_methods, only: method_infos
    use spintop_parameters, only: unset, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_stepper, only: method_info_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: stability_plan_t, make_stability_plan, scene_of_case, scene_of_trial
    public :: own_case

    !> The table to fill.
    type :: stability_plan_t
        !> Places in the catalogue; 0 is the input's own case.
        integer, allocatable :: cases(:)
        type(method_choice_t), allocatable :: methods(:)
    end type stability_plan_t

    !> Name of the input's own case.
    character(*), parameter :: own_case = 'input'
    !> Tolerances where the input gives none.
    real(dp), parameter :: default_tolerance = 1.0e-12_dp
    !> Equal steps of the input's own case where it gives none.
    integer, parameter :: default_steps = 8000
    !> What is tried besides each method under the formulation that suits the body.
    character(*), parameter :: more_choices(*) = [character(28) :: 'rk4/lagrange', 'rk4/euler', &
        'ode45/lagrange', 'ode45/euler', 'dop853/lagrange', 'dop853/euler', 'taylor/rigid_body', &
        'taylor/cayley_klein', 'splitting_8/rigid_body', 'splitting_8/cayley_klein']

contains

    !> The cases and methods named, or all of them.
    subroutine make_stability_plan(scene, plan, problems)
        type(scene_t), intent(in) :: scene
        type(stability_plan_t), intent(out) :: plan
        type(problems_t), intent(inout) :: problems
        integer :: i

        if (all(scene%stability_cases == '')) then
            plan%cases = pack([(i, i=1, size(hard_cases))], .not. hard_cases%is_long)
        else
            call take_cases(scene%stability_cases, plan%cases, problems)
        end if
        if (all(scene%stability_methods == '')) then
            call take_all_methods(plan%methods)
        else
            allocate (plan%methods(0))
            call take_methods('stability.methods', scene%stability_methods, method_infos(), ['auto'], plan%methods, &
                              problems)
        end if
    end subroutine make_stability_plan

    !> Finds the cases of the catalogue that are named.
    subroutine take_cases(names, cases, problems)
        character(*), intent(in) :: names(:)
        integer, allocatable, intent(out) :: cases(:)
        type(problems_t), intent(inout) :: problems
        integer :: i, place

        allocate (cases(0))
        do i = 1, size(names)
            if (names(i) == '') cycle
            place = findloc(hard_cases%name == names(i), .true., dim=1)
            if (place == 0 .and. names(i) /= own_case) then
                call refuse_name('stability.cases(' // to_text(i) // ')', 'case', trim(names(i)), &
                                 [character(24) :: hard_cases%name, own_case], problems)
            end if
            cases = [cases, place]
        end do
    end subroutine take_cases

    !> Every method under the formulation that suits the body, some of them under others too.
    subroutine take_all_methods(choices)
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
    end subroutine take_all_methods

    !> The scene of a case: of the catalogue, or (place 0) the input itself.
    subroutine scene_of_case(input, place, scene, error)
        type(scene_t), intent(in) :: input
        integer, intent(in) :: place
        type(scene_t), intent(out) :: scene
        type(error_t), allocatable, intent(out) :: error
        if (place > 0) then
            call make_scene(hard_cases(place), scene, error)
        else
            scene = input
            if (scene%steps == unset_integer) scene%steps = default_steps
        end if
    end subroutine scene_of_case

    !> The scene of a case under a method: methods with step control take the input's tolerances,
    !> the others the case's equal steps.
    subroutine scene_of_trial(input, scene, choice)
        type(scene_t), intent(in) :: input
        type(scene_t), intent(inout) :: scene
        type(method_choice_t), intent(in) :: choice
        real(dp) :: tolerance

        if (.not. choice%method%adaptive) then
            call set_steps(scene, choice, scene%steps)
        else if (choice%method%needs == structure_quadruple) then
            call set_adaptive(scene, choice, unset) ! it has finer tolerances of its own
        else
            tolerance = default_tolerance
            if (is_set(input%relative_tolerance)) tolerance = input%relative_tolerance
            scene%absolute_tolerance = input%absolute_tolerance
            call set_adaptive(scene, choice, tolerance)
        end if
    end subroutine scene_of_trial

end module spintop_stability_plan
