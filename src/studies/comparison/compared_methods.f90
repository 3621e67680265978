!> Methods and formulations as they are named in an input for a comparison, `method` or `method/formulation`; and their
!> settings.
module spintop_compared_methods
    use spintop_formulation, only: formulation_info_t
    use spintop_formulations, only: formulation_infos
    use spintop_kinds, only: dp
    use spintop_method_aliases, only: method_aliases
    use spintop_parameters, only: is_set, unset, unset_integer
    use spintop_problems, only: problems_t
    use spintop_projection, only: project_nothing, projection_names
    use spintop_scene_keys, only: scene_t
    use spintop_stepper, only: method_info_t
    use spintop_suggestions, only: own_name
    use spintop_text, only: did_you_mean, to_text
    implicit none
    private
    public :: method_choice_t, setting_t, add_methods, find_cases, set_method

    !> A method with a formulation.
    type :: method_choice_t
        type(method_info_t) :: method
        character(16) :: formulation = 'auto'
    end type method_choice_t

    !> A number of steps of fixed size, or a relative tolerance; with neither, the method has its own.
    type :: setting_t
        integer :: steps = unset_integer
        real(dp) :: tolerance = unset
    contains
        procedure :: text => setting_text
    end type setting_t

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

    !> Sets a method with its setting in a scene. Keys of &integration that the method does not use are cleared.
    pure subroutine set_method(scene, choice, setting)
        type(scene_t), intent(inout) :: scene !! method and setting are set
        type(method_choice_t), intent(in) :: choice !! method and formulation
        type(setting_t), intent(in) :: setting !! its steps or tolerance
        scene%method = choice%method%name
        scene%formulation = choice%formulation
        scene%step = unset
        scene%steps = setting%steps
        scene%relative_tolerance = setting%tolerance
        if (setting%steps /= unset_integer .or. .not. choice%method%adaptive) scene%absolute_tolerance = unset
        if (setting%steps == unset_integer .and. .not. choice%method%adaptive) scene%project = projection_names(project_nothing)
        if (.not. choice%method%takes_table) scene%table = ''
        if (.not. choice%method%implicit) scene%solver = 'newton'
    end subroutine set_method

    !> Description of a setting.
    function setting_text(self) result(text)
        class(setting_t), intent(in) :: self
        character(:), allocatable :: text
        text = '-'
        if (self%steps /= unset_integer) text = 'steps ' // to_text(self%steps)
        if (is_set(self%tolerance)) text = 'tolerance ' // to_text(self%tolerance)
    end function setting_text

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
