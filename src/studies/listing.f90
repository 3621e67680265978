!> What `spintop list` shows: the registries and tables themselves, as aligned text.
module spintop_listing
    use spintop_arkode_tables, only: arkode_table_names
    use spintop_columns, only: trajectory_columns
    use spintop_errors, only: error_t, input_error
    use spintop_event_text, only: named_events, event_grammar
    use spintop_formulations, only: formulation_infos
    use spintop_hard_cases, only: hard_cases
    use spintop_formulation, only: formulation_info_t
    use spintop_methods, only: exact_info, method_infos
    use spintop_parameter_print, only: list_parameters
    use spintop_parameters, only: parameter_table_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_shapes, only: shape_infos, shape_by_inertia
    use spintop_precision_table, only: precision_columns
    use spintop_stability, only: stability_columns
    use spintop_stepper, only: method_info_t
    use spintop_sweep_columns, only: sweep_columns
    use spintop_terminal, only: output_width
    use spintop_text, only: string_t, nearest_word, join, to_text
    use spintop_wrapping, only: wrapped
    implicit none
    private
    public :: list_topic, topics

    !> What can be listed.
    character(*), parameter :: topics(*) = [character(12) :: &
        'methods', 'formulations', 'columns', 'events', 'shapes', 'parameters', 'cases']

contains

    !> The lines of a topic.
    subroutine list_topic(topic, lines, error)
        character(*), intent(in) :: topic
        type(string_t), allocatable, intent(out) :: lines(:)
        type(error_t), allocatable, intent(out) :: error
        type(scene_t), allocatable, target :: scene
        type(parameter_table_t) :: table
        type(string_t), allocatable :: known(:)
        character(:), allocatable :: hint
        integer :: i

        allocate (lines(0), scene)
        select case (topic)
        case ('methods')
            call list_methods(lines)
        case ('formulations')
            call list_formulations(lines)
        case ('columns')
            lines = [string_t('columns of a trajectory')]
            do i = 1, size(trajectory_columns)
                call add(lines, trajectory_columns(i)%name, trajectory_columns(i)%unit, &
                         trajectory_columns(i)%what)
            end do
            lines = [lines, string_t(''), string_t('columns of a sweep, besides case, the swept &
                     &parameters, status and notes')]
            do i = 1, size(sweep_columns)
                call add(lines, sweep_columns(i)%name, sweep_columns(i)%unit, sweep_columns(i)%what)
            end do
            lines = [lines, string_t(''), string_t('columns of a stability study')]
            do i = 1, size(stability_columns)
                call add(lines, stability_columns(i)%name, stability_columns(i)%unit, stability_columns(i)%what)
            end do
            lines = [lines, string_t(''), string_t('columns of a work-precision study, before the swept parameters')]
            do i = 1, size(precision_columns)
                call add(lines, precision_columns(i)%name, precision_columns(i)%unit, precision_columns(i)%what)
            end do
        case ('events')
            do i = 1, size(named_events)
                if (named_events(i)%what /= '') call add(lines, named_events(i)%name, '', named_events(i)%what)
            end do
            lines = [lines, string_t('  ' // event_grammar)]
        case ('shapes')
            call add(lines, shape_by_inertia, '', &
                     'given by mass, inertia(3) and length or centre_of_mass(3) (the default)')
            do i = 1, size(shape_infos)
                call add(lines, shape_infos(i)%name, '', trim(shape_infos(i)%what) // &
                         '; needs mass or density, radius' // &
                         trim(merge(', inner_radius', '              ', shape_infos(i)%needs_inner_radius)) // &
                         trim(merge(', thickness', '           ', shape_infos(i)%needs_thickness)) // &
                         trim(merge(', rod_length', '            ', shape_infos(i)%needs_rod_length)))
            end do
        case ('cases')
            do i = 1, size(hard_cases)
                call add(lines, hard_cases(i)%name, '', hard_cases(i)%what)
            end do
        case ('parameters')
            call describe_scene(scene, table)
            call list_parameters(table, lines)
        case default
            allocate (known(size(topics)))
            do i = 1, size(topics)
                known(i)%text = trim(topics(i))
            end do
            hint = nearest_word(topic, known)
            if (hint /= '') hint = "; did you mean '" // hint // "'?"
            error = input_error("spintop: cannot list '" // topic // "'" // hint // &
                                ' (there are ' // join(known, ', ') // ')')
        end select
        call fit_lines(output_width(), lines)
    end subroutine list_topic

    !> Breaks lines that are longer than a terminal is wide; what goes on stands below its own column.
    subroutine fit_lines(width, lines)
        integer, intent(in) :: width
        type(string_t), intent(inout) :: lines(:)
        integer :: i, last_column
        do i = 1, size(lines)
            associate (text => lines(i)%text)
                if (len_trim(text) <= width) cycle
                last_column = index(text, '  ', back=.true.)
                lines(i)%text = wrapped(text, 0, width, indent=max(4, last_column + 1))
            end associate
        end do
    end subroutine fit_lines

    subroutine list_methods(lines)
        type(string_t), allocatable, intent(inout) :: lines(:)
        type(method_info_t), allocatable :: methods(:)
        integer :: i

        allocate (methods, source=method_infos())
        call add(lines, 'auto', '', 'the cheapest adequate one (the default)')
        call add(lines, exact_info%name, '', exact_info%what)
        do i = 1, size(methods)
            call add(lines, methods(i)%name, kind_of(methods(i)), methods(i)%what)
        end do
        lines = [lines, string_t(''), &
                 string_t('tables of arkode_erk:  ' // join(arkode_table_names(.false.), ', ')), &
                 string_t('tables of arkode_dirk: ' // join(arkode_table_names(.true.), ', '))]
    end subroutine list_methods

    !> Order and kind of steps in a word.
    function kind_of(method) result(text)
        type(method_info_t), intent(in) :: method
        character(:), allocatable :: text
        text = ''
        if (method%order > 0) text = 'order ' // to_text(method%order)
        if (method%adaptive) text = text // ' adaptive'
        if (method%fixed_step) text = text // ' fixed'
        text = trim(adjustl(text))
    end function kind_of

    subroutine list_formulations(lines)
        type(string_t), allocatable, intent(inout) :: lines(:)
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i
        allocate (forms, source=formulation_infos())
        call add(lines, 'auto', '', 'the one that suits the method and the body (the default)')
        do i = 1, size(forms)
            call add(lines, forms(i)%name, '', forms(i)%what)
        end do
    end subroutine list_formulations

    !> A line of name, second column and meaning.
    subroutine add(lines, name, second, what)
        type(string_t), allocatable, intent(inout) :: lines(:)
        character(*), intent(in) :: name, second, what
        character(28) :: first_column
        character(24) :: second_column
        first_column = name
        second_column = second
        if (second == '') then
            lines = [lines, string_t('  ' // first_column // trim(what))]
        else
            lines = [lines, string_t('  ' // first_column // second_column // trim(what))]
        end if
    end subroutine add

end module spintop_listing
