!> Methods and formulations as an input names them for a comparison: `method` or `method/formulation`.
module spintop_method_choice
    use spintop_formulation, only: formulation_info_t
    use spintop_formulations, only: formulation_infos
    use spintop_kinds, only: dp
    use spintop_method_aliases, only: method_aliases
    use spintop_parameters, only: unset, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_stepper, only: method_info_t
    use spintop_suggestions, only: own_name
    use spintop_text, only: string_t, nearest_word, to_text
    implicit none
    private
    public :: method_choice_t, take_methods, refuse_name, set_adaptive, set_steps

    !> A method under a formulation.
    type :: method_choice_t
        type(method_info_t) :: method
        character(16) :: formulation = 'auto'
    end type method_choice_t

contains

    !> Finds the methods that are named, and adds them to the choices. What has no formulation of its
    !> own is taken under each of `formulations`.
    subroutine take_methods(key, names, known, formulations, choices, problems)
        character(*), intent(in) :: key !! list that holds the names
        character(*), intent(in) :: names(:) !! blank ones are left out
        type(method_info_t), intent(in) :: known(:)
        character(*), intent(in) :: formulations(:)
        type(method_choice_t), allocatable, intent(inout) :: choices(:)
        type(problems_t), intent(inout) :: problems
        type(formulation_info_t), allocatable :: forms(:)
        character(16) :: formulation
        integer :: i, k, slash, place

        allocate (forms, source=formulation_infos())
        do i = 1, size(names)
            if (names(i) == '') cycle
            slash = index(trim(names(i)) // '/', '/')
            place = findloc(known%name == names(i)(:slash - 1), .true., dim=1)
            if (place == 0) then
                call refuse_name(key // '(' // to_text(i) // ')', 'method', names(i)(:slash - 1), known%name, problems)
            else if (slash < len_trim(names(i))) then
                formulation = names(i)(slash + 1:)
                if (.not. any(forms%name == formulation)) then
                    call refuse_name(key // '(' // to_text(i) // ')', 'formulation', trim(formulation), forms%name, problems)
                end if
                choices = [choices, method_choice_t(known(place), formulation)]
            else
                choices = [choices, (method_choice_t(known(place), formulations(k)), k=1, size(formulations))]
            end if
        end do
    end subroutine take_methods

    !> Has a scene computed by a method that chooses its steps; a tolerance that is unset is the method's own.
    pure subroutine set_adaptive(scene, choice, tolerance)
        type(scene_t), intent(inout) :: scene
        type(method_choice_t), intent(in) :: choice
        real(dp), intent(in) :: tolerance
        scene%method = choice%method%name
        scene%formulation = choice%formulation
        scene%steps = unset_integer
        scene%step = unset
        scene%relative_tolerance = tolerance
    end subroutine set_adaptive

    !> Has a scene computed by a method in equal steps.
    pure subroutine set_steps(scene, choice, steps)
        type(scene_t), intent(inout) :: scene
        type(method_choice_t), intent(in) :: choice
        integer, value :: steps !! a copy, for it may be that of the scene
        call set_adaptive(scene, choice, unset)
        scene%absolute_tolerance = unset
        scene%steps = steps
    end subroutine set_steps

    !> There is no such case, method or formulation.
    subroutine refuse_name(key, noun, name, known, problems)
        character(*), intent(in) :: key, noun, name, known(:)
        type(problems_t), intent(inout) :: problems
        type(string_t) :: words(size(known))
        character(:), allocatable :: hint
        integer :: i
        do i = 1, size(known)
            words(i)%text = trim(known(i))
        end do
        hint = ''
        if (noun == 'method') hint = own_name(name, method_aliases)
        if (hint == '') hint = nearest_word(name, words)
        if (hint /= '') hint = "did you mean '" // hint // "'?"
        if (hint == '') hint = '`spintop list ' // noun // 's` shows them all'
        call problems%add(key, 'there is no ' // noun // " '" // name // "'", hint)
    end subroutine refuse_name

end module spintop_method_choice
