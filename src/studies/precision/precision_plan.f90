!> The plan of a work-precision study: methods with formulations, each with its settings.
module spintop_precision_plan
    use spintop_case, only: case_t
    use spintop_diagnostics, only: diagnostics_t
    use spintop_formulation, only: structure_quadruple
    use spintop_kinds, only: dp
    use spintop_compared_methods, only: method_choice_t, set_adaptive, set_steps, add_methods
    use spintop_methods, only: exact_info, method_infos
    use spintop_parameters, only: is_set, unset, unset_integer
    use spintop_problems, only: problems_t
    use spintop_projection, only: project_nothing, projection_names
    use spintop_scene_words, only: reference_auto, reference_exact, reference_names
    use spintop_reference_motion, only: reference_t
    use spintop_scene_keys, only: scene_t
    use spintop_stepper, only: method_info_t
    use spintop_stored_motion, only: read_motion
    use spintop_own_butcher_tables, only: infos_of_tables, names_of_methods
    use spintop_text, only: to_text
    implicit none
    private
    public :: precision_plan_t, make_precision_plan, set_setting, read_reference

    !> The rows of the table.
    type :: precision_plan_t
        type(method_choice_t), allocatable :: choices(:)
        real(dp), allocatable :: tolerances(:)
        integer, allocatable :: steps(:)
        !> Whether methods with both variants use a fixed step size: the input names numbers of steps only.
        logical :: prefers_steps = .false.
        !> Number of times at which the motions are compared.
        integer :: samples = 0
        integer :: repeats = 0
        !> The kind of reference, and the stored reference if it was read from a table.
        integer :: reference = reference_auto
        type(reference_t), allocatable :: stored
    contains
        procedure :: settings
        procedure :: takes_steps
        procedure :: setting_text
        procedure :: formulation
    end type precision_plan_t

    !> Default tolerances, numbers of steps, and repeats.
    real(dp), parameter :: default_tolerances(*) = [1.0e-3_dp, 1.0e-4_dp, 1.0e-5_dp, 1.0e-6_dp, 1.0e-7_dp, &
        1.0e-8_dp, 1.0e-9_dp, 1.0e-10_dp, 1.0e-11_dp, 1.0e-12_dp, 1.0e-13_dp, 1.0e-14_dp]
    integer, parameter :: default_steps(*) = [100, 200, 400, 800, 1600, 3200, 6400, 12800, 25600]
    integer, parameter :: default_repeats = 5
    !> Maximum number of intervals between comparisons.
    integer, parameter :: most_intervals = 100

contains

    !> The methods, formulations and settings that are named, or default ones.
    subroutine make_precision_plan(scene, plan, problems)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(precision_plan_t), intent(out) :: plan !! methods and settings; valid without errors in `problems`
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(method_info_t), allocatable :: known(:)
        character(len(scene%formulation)), allocatable :: formulations(:)
        integer :: i

        allocate (known, source=[exact_info, method_infos(), infos_of_tables(scene)])
        formulations = pack(scene%precision_formulations, scene%precision_formulations /= '')
        if (size(formulations) == 0) formulations = ['auto']
        allocate (plan%choices(0))
        if (all(scene%precision_methods == '')) then
            call add_methods('work_precision.methods', pack(known%name, known%needs /= structure_quadruple), known, &
                             formulations, plan%choices, problems)
        else
            call add_methods('work_precision.methods', names_of_methods(scene, scene%precision_methods), known, formulations, &
                             plan%choices, problems)
        end if
        plan%tolerances = pack(scene%precision_tolerances, is_set(scene%precision_tolerances))
        if (size(plan%tolerances) == 0) plan%tolerances = default_tolerances
        plan%steps = pack(scene%precision_steps, scene%precision_steps /= unset_integer)
        if (size(plan%steps) == 0) plan%steps = default_steps
        plan%prefers_steps = any(scene%precision_steps /= unset_integer) .and. .not. any(is_set(scene%precision_tolerances))
        plan%repeats = default_repeats
        if (scene%precision_repeats /= unset_integer) plan%repeats = scene%precision_repeats
        i = findloc(reference_names == scene%precision_reference, .true., dim=1)
        if (i > 0) plan%reference = i
        plan%samples = 1 + common_intervals(plan%steps)
        if (scene%samples /= unset_integer) plan%samples = scene%samples
        call check(scene, problems)
    end subroutine make_precision_plan

    !> Reports settings that the study does not use.
    subroutine check(scene, problems)
        type(scene_t), intent(in) :: scene
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: hint = 'give it in &work_precision'

        call refuse('integration.method', scene%method /= 'auto', 'a work-precision study compares methods', hint)
        call refuse('integration.formulation', scene%formulation /= 'auto', &
                    'a work-precision study compares formulations', hint)
        call refuse('integration.steps', scene%steps /= unset_integer, 'a work-precision study varies the steps', hint)
        call refuse('integration.step', is_set(scene%step), 'a work-precision study varies the steps', hint)
        call refuse('integration.relative_tolerance', is_set(scene%relative_tolerance), &
                    'a work-precision study varies the tolerance', hint)
        call refuse('span.stop_at', scene%stop_at /= '', 'a work-precision study computes each motion to the end of its span', &
                    'omit it')

    contains

        subroutine refuse(key, given, message, hint)
            character(*), intent(in) :: key, message, hint
            logical, intent(in) :: given
            if (given) call problems%add(key, message, hint)
        end subroutine refuse

    end subroutine check

    !> Reads the reference motion of a case if the input names a table, and checks that the requested
    !> reference exists.
    subroutine read_reference(input, scene, case, plan, problems, diagnostics)
        character(*), intent(in) :: input !! path of the input
        type(scene_t), intent(in) :: scene !! contents of the input
        type(case_t), intent(in) :: case !! the case: whether its body has a closed form decides which references there are
        type(precision_plan_t), intent(inout) :: plan !! the stored reference is set
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        character(*), parameter :: key = 'work_precision.reference'

        if (plan%reference == reference_exact .and. .not. case%body%has_closed_form()) then
            call problems%add(key, 'this body has no exact solution', "use reference = 'quadruple'")
        else if (any(reference_names == scene%precision_reference)) then
            call check_steps('span.samples', plan, problems)
        else
            allocate (plan%stored)
            call read_motion(input, key, trim(scene%precision_reference), case, plan%stored, problems, diagnostics)
            if (.not. allocated(plan%stored%motions)) return
            plan%samples = size(plan%stored%motions)
            call check_steps(key, plan, problems)
        end if
    end subroutine read_reference

    !> Checks that the times of comparison are steps of the methods with a fixed step size.
    subroutine check_steps(key, plan, problems)
        character(*), intent(in) :: key !! parameter that determines the number of these times
        type(precision_plan_t), intent(in) :: plan
        type(problems_t), intent(inout) :: problems
        integer :: i

        if (.not. any(plan%takes_steps(plan%choices))) return
        associate (intervals => plan%samples - 1)
            i = findloc(mod(plan%steps, intervals) == 0, .false., dim=1)
            if (i == 0) return
            call problems%add(key, 'motions are compared at steps of the methods with a fixed step size, and ' &
                // to_text(intervals) // ' intervals do not divide ' // to_text(plan%steps(i)) // ' steps', &
                'use a number of rows for which rows - 1 divides all work_precision.steps')
        end associate
    end subroutine check_steps

    !> Number of settings of a method.
    elemental integer function settings(self, choice)
        class(precision_plan_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        settings = 1
        if (self%takes_steps(choice)) then
            settings = size(self%steps)
        else if (choice%method%adaptive) then
            settings = size(self%tolerances)
        end if
    end function settings

    !> Whether a method runs with numbers of steps of fixed size.
    elemental logical function takes_steps(self, choice)
        class(precision_plan_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        takes_steps = choice%method%fixed_step .and. (self%prefers_steps .or. .not. choice%method%adaptive)
    end function takes_steps

    !> The formulation of all methods if it is the same, else auto.
    pure function formulation(self)
        class(precision_plan_t), intent(in) :: self
        character(16) :: formulation
        formulation = 'auto'
        if (all(self%choices%formulation == self%choices(1)%formulation)) formulation = self%choices(1)%formulation
    end function formulation

    !> Sets a method with its setting number `k` in a scene. Keys of &integration that the method does not use
    !> are cleared.
    subroutine set_setting(plan, choice, k, scene)
        type(precision_plan_t), intent(in) :: plan !! methods and settings
        type(method_choice_t), intent(in) :: choice !! method and formulation
        integer, intent(in) :: k !! number of the setting
        type(scene_t), intent(inout) :: scene !! method and setting are set
        if (plan%takes_steps(choice)) then
            call set_steps(scene, choice, plan%steps(k))
        else if (choice%method%adaptive) then
            call set_adaptive(scene, choice, plan%tolerances(k))
        else
            call set_adaptive(scene, choice, unset)
            scene%absolute_tolerance = unset
            scene%project = projection_names(project_nothing)
        end if
        if (.not. choice%method%takes_table) scene%table = ''
        if (.not. choice%method%implicit) scene%solver = 'newton'
        scene%samples = plan%samples
    end subroutine set_setting

    !> Description of a setting.
    function setting_text(self, choice, k) result(text)
        class(precision_plan_t), intent(in) :: self
        type(method_choice_t), intent(in) :: choice !! method and formulation
        integer, intent(in) :: k !! number of the setting
        character(:), allocatable :: text
        text = '-'
        if (self%takes_steps(choice)) then
            text = 'steps ' // to_text(self%steps(k))
        else if (choice%method%adaptive) then
            text = 'tolerance ' // to_text(self%tolerances(k))
        end if
    end function setting_text

    !> The largest number of intervals, not above `most_intervals`, that divides all numbers of steps.
    pure integer function common_intervals(steps) result(intervals)
        integer, intent(in) :: steps(:)
        do intervals = most_intervals, 2, -1
            if (all(mod(steps, intervals) == 0)) return
        end do
        intervals = 1
    end function common_intervals

end module spintop_precision_plan
