!> Methods and formulations as they are named in an input for a comparison: `method` or `method/formulation`.
module spintop_compared_methods
    use spintop_formulation, only: formulation_info_t
    use spintop_formulations, only: formulation_infos
    use spintop_kinds, only: dp
    use spintop_methods, only: method_aliases
    use spintop_parameters, only: unset, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t
    use spintop_stepper, only: method_info_t
    use spintop_suggestions, only: own_name
    use spintop_text, only: did_you_mean, to_text
    implicit none
    private
    public :: method_choice_t, add_methods, find_cases, set_adaptive, set_steps

    !> A method with a formulation.
    type :: method_choice_t
        type(method_info_t) :: method
        character(16) :: formulation = 'auto'
    end type method_choice_t

contains

    !> Finds the named methods, and adds them to the choices. A method without a formulation is combined with
    !> each of `formulations`.
    subroutine add_methods(key, names, known, formulations, choices, problems)
        character(*), intent(in) :: key !! parameter with the list of names
        character(*), intent(in) :: names(:) !! blank ones are skipped
        type(method_info_t), intent(in) :: known(:) !! all methods
        character(*), intent(in) :: formulations(:) !! names of formulations for methods without one
        type(method_choice_t), allocatable, intent(inout) :: choices(:) !! the choices are appended
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(formulation_info_t), allocatable :: forms(:)
        character(16) :: formulation
        integer :: i, k, slash, place

        allocate (forms, source=formulation_infos())
        do i = 1, size(names)
            if (names(i) == '') cycle
            slash = index(trim(names(i)) // '/', '/')
            place = findloc(known%name == names(i)(:slash - 1), .true., dim=1)
            if (place == 0 .and. names(i)(:slash - 1) == 'exact') then
                call problems%add(key // '(' // to_text(i) // ')', 'the exact solution is not among the compared methods', &
                                  'name methods of integration')
            else if (place == 0) then
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
    end subroutine add_methods

    !> Finds the named cases of a catalogue: the place of each; 0 for one that does not exist, which is reported.
    subroutine find_cases(key, noun, names, known, places, problems)
        character(*), intent(in) :: key, noun !! parameter with the list of names; what they should be, such as 'case'
        character(*), intent(in) :: names(:), known(:) !! blank ones are skipped; those of the catalogue
        integer, allocatable, intent(out) :: places(:) !! in the catalogue
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        integer :: i, place

        allocate (places(0))
        do i = 1, size(names)
            if (names(i) == '') cycle
            place = findloc(known == names(i), .true., dim=1)
            if (place == 0) call refuse_name(key // '(' // to_text(i) // ')', noun, trim(names(i)), known, problems)
            places = [places, place]
        end do
    end subroutine find_cases

    !> Sets an adaptive method in a scene; an unset tolerance means the default of the method.
    pure subroutine set_adaptive(scene, choice, tolerance)
        type(scene_t), intent(inout) :: scene !! method and tolerances are set
        type(method_choice_t), intent(in) :: choice !! method and formulation
        real(dp), intent(in) :: tolerance !! relative tolerance
        scene%method = choice%method%name
        scene%formulation = choice%formulation
        scene%steps = unset_integer
        scene%step = unset
        scene%relative_tolerance = tolerance
    end subroutine set_adaptive

    !> Sets a method with a fixed step size in a scene.
    pure subroutine set_steps(scene, choice, steps)
        type(scene_t), intent(inout) :: scene !! method and number of steps are set
        type(method_choice_t), intent(in) :: choice !! method and formulation
        integer, value :: steps !! a copy, because it may be that of the scene
        call set_adaptive(scene, choice, unset)
        scene%absolute_tolerance = unset
        scene%steps = steps
    end subroutine set_steps

    !> Reports a case, method or formulation that does not exist.
    subroutine refuse_name(key, noun, name, known, problems)
        character(*), intent(in) :: key, noun, name, known(:)
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: hint
        hint = ''
        if (noun == 'method') hint = own_name(name, method_aliases)
        if (hint /= '') hint = did_you_mean(hint, [character(len(hint)) :: hint])
        if (hint == '') hint = did_you_mean(name, known)
        if (hint == '') hint = '`spintop list ' // noun // 's` shows them all'
        call problems%add(key, 'there is no ' // noun // " '" // name // "'", hint)
    end subroutine refuse_name

end module spintop_compared_methods
