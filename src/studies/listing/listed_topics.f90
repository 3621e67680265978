!> What `spintop list` shows of each registry: a procedure per topic adds its items.
module spintop_listed_topics
    use spintop_benchmark_cases, only: benchmarks
    use spintop_exit_codes, only: exit_codes
    use spintop_event_text, only: named_events, event_grammar
    use spintop_hard_cases, only: hard_cases
    use spintop_json, only: json_t
    use spintop_kinds, only: dp
    use spintop_listed_items, only: listing_t
    use spintop_listed_methods, only: add_formulations, add_methods
    use spintop_parameter, only: kind_integer, kind_logical, kind_long, kind_real, parameter_t
    use spintop_parameter_print, only: list_parameters
    use spintop_parameters, only: parameter_table_t
    use spintop_scene_keys, only: scene_t, describe_scene
    use spintop_shapes, only: part_infos, shape_infos, shape_by_inertia
    use spintop_status, only: is_good_end, status_names, status_meanings
    use spintop_studies, only: create_study, listed_studies
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_text, only: append, join, string_t, to_text
    use spintop_units, only: find_unit, suffixes_of
    implicit none
    private
    public :: topics, add_topic

    !> What can be listed, in the order of the help text.
    type :: topic_t
        character(12) :: name
        character(56) :: what
    end type topic_t

    type(topic_t), parameter :: topics(*) = [ &
        topic_t('methods', 'methods of integration, and the exact solution'), &
        topic_t('formulations', 'equations of motion'), &
        topic_t('columns', 'columns of the tables, with their units'), &
        topic_t('events', 'events that a motion can be searched for'), &
        topic_t('shapes', 'shapes of bodies, and their dimensions'), &
        topic_t('parts', 'parts of bodies, and their dimensions'), &
        topic_t('parameters', 'keys of the input, with ranges and default values'), &
        topic_t('cases', 'hard cases of the stability study'), &
        topic_t('benchmarks', 'published benchmarks'), &
        topic_t('studies', 'kinds of studies'), &
        topic_t('statuses', 'how a motion can end'), &
        topic_t('exit_codes', 'exit codes of the program')]

    !> Columns of words that tables have beside those of the registries: of sweeps, events, and statistics.
    character(6), parameter :: other_words(*) = [character(6) :: 'column', 'event', 'factor', 'notes', 'status']

contains

    !> Adds the list of a topic.
    subroutine add_topic(list, topic)
        type(listing_t), intent(inout) :: list !! the items are added
        character(*), intent(in) :: topic !! name of one of `topics`
        call list%json%open_list(topic)
        select case (topic)
        case ('methods')
            call add_methods(list)
        case ('formulations')
            call add_formulations(list)
        case ('columns')
            call add_columns(list)
        case ('events')
            call add_events(list)
        case ('shapes')
            call add_shapes(list)
        case ('parts')
            call add_parts(list)
        case ('parameters')
            call add_parameters(list)
        case ('cases')
            call add_cases(list)
        case ('benchmarks')
            call add_benchmarks(list)
        case ('studies')
            call add_studies(list)
        case ('statuses')
            call add_statuses(list)
        case ('exit_codes')
            call add_exit_codes(list)
        end select
        call list%json%close()
        if (topic == 'columns') then
            call list%json%add('other_words', other_words)
            call add_units(list)
        end if
        if (topic == 'events') call list%json%add('event_grammar', event_grammar)
    end subroutine add_topic

    !> The columns of all kinds of study; `words`: whether the cells are words. `other_words` are columns of words that
    !> no list of columns has.
    subroutine add_columns(list)
        type(listing_t), intent(inout) :: list
        class(study_t), allocatable :: study
        type(listed_column_t), allocatable :: columns(:)
        type(study_info_t) :: info
        integer :: i, k

        do i = 1, size(listed_studies)
            call create_study(listed_studies(i), study)
            info = study%info()
            columns = study%columns()
            if (i > 1) call append(list%text, '')
            call append(list%text, 'columns of ' // info%phrase // info%remark)
            do k = 1, size(columns)
                call list%add_line(columns(k)%name, columns(k)%what, columns(k)%unit)
                call list%json%open_object()
                call list%json%add('study', info%name)
                call list%json%add('name', columns(k)%name)
                call list%json%add('group', columns(k)%group)
                call list%json%add('unit', columns(k)%unit)
                call list%json%add('words', columns(k)%words)
                call list%end_item(columns(k)%what)
            end do
        end do
    end subroutine add_columns

    !> The units in which columns can be: what follows the name of a column of the unit `of`, and the `size` of the unit in that.
    subroutine add_units(list)
        type(listing_t), intent(inout) :: list
        class(study_t), allocatable :: study
        type(study_info_t) :: info
        type(listed_column_t), allocatable :: columns(:)
        type(string_t), allocatable :: known(:), suffixes(:)
        character(:), allocatable :: unit, problem
        real(dp) :: factor
        integer :: i, k

        allocate (known(0))
        do i = 1, size(listed_studies)
            call create_study(listed_studies(i), study)
            info = study%info()
            if (.not. info%takes_columns) cycle
            columns = study%columns()
            do k = 1, size(columns)
                if (.not. is_in(known, trim(columns(k)%unit))) call append(known, trim(columns(k)%unit))
            end do
        end do
        call append(list%text, '')
        call append(list%text, 'a column in another unit: its name, _ and a suffix for its unit, as in t_ms, theta_deg, omega3_rpm')
        call list%json%open_list('column_units')
        do i = 1, size(known)
            call suffixes_of(known(i)%text, suffixes)
            if (size(suffixes) == 0) cycle
            call append(list%text, '    ' // known(i)%text // ': ' // join(suffixes, ', '))
            do k = 1, size(suffixes)
                call find_unit(suffixes(k)%text, known(i)%text, unit, factor, problem)
                call list%json%open_object()
                call list%json%add('of', known(i)%text)
                call list%json%add('suffix', suffixes(k)%text)
                call list%json%add('unit', unit)
                call list%json%add('size', factor)
                call list%json%close()
            end do
        end do
        call list%json%close()
    end subroutine add_units

    !> Whether a text is one of others.
    pure logical function is_in(texts, text)
        type(string_t), intent(in) :: texts(:)
        character(*), intent(in) :: text
        integer :: i
        is_in = any([(texts(i)%text == text, i=1, size(texts))])
    end function is_in

    !> The events with names, what their rows are called in a table, and the grammar of the others.
    subroutine add_events(list)
        type(listing_t), intent(inout) :: list
        integer :: i
        do i = 1, size(named_events)
            if (named_events(i)%what == '') cycle
            call list%begin_item(named_events(i)%name, named_events(i)%what)
            call list%json%add('in_table', pack(named_events%in_table, named_events%name == named_events(i)%name))
            call list%end_item(named_events(i)%what)
        end do
        call append(list%text, '  ' // event_grammar)
    end subroutine add_events

    !> The shapes; `needs` are the keys of &top, beside a mass or a density.
    subroutine add_shapes(list)
        type(listing_t), intent(inout) :: list
        character(12), parameter :: dimensions(*) = [character(12) :: 'radius', 'inner_radius', 'thickness', 'rod_length']
        logical :: needs(size(dimensions))
        integer :: i

        call list%begin_item(shape_by_inertia, 'given by mass, inertia(3) and length or centre_of_mass(3) (the default)')
        call list%json%add('needs', ['inertia'])
        call list%end_item('given by its mass properties')
        do i = 1, size(shape_infos)
            associate (shape => shape_infos(i))
                needs = [.true., shape%needs_inner_radius, shape%needs_thickness, shape%needs_rod_length]
                call list%begin_item(shape%name, trim(shape%what) // '; needs mass or density' // listed(dimensions, needs))
                call list%json%add('needs', pack(dimensions, needs))
                call list%end_item(shape%what)
            end associate
        end do
    end subroutine add_shapes

    !> The parts of bodies; `needs` and `takes` are the keys of &part that a part must and may have, beside its mass.
    subroutine add_parts(list)
        type(listing_t), intent(inout) :: list
        character(12), parameter :: dimensions(*) = [character(12) :: 'radius', 'inner_radius', 'thickness']
        logical :: may_have(size(dimensions))
        integer :: i

        do i = 1, size(part_infos)
            associate (part => part_infos(i))
                may_have = part%takes .and. .not. part%needs
                call list%begin_item(part%name, trim(part%what) // '; needs mass or density' // &
                                     listed(dimensions, part%needs) // listed(dimensions, may_have, ' (', ')'))
                call list%json%add('needs', pack(dimensions, part%needs))
                call list%json%add('takes', pack(dimensions, may_have))
                call list%end_item(part%what)
            end associate
        end do
    end subroutine add_parts

    !> Some of a list of names, each after a comma, or with what is before and after it.
    pure function listed(names, chosen, before, after) result(text)
        character(*), intent(in) :: names(:)
        logical, intent(in) :: chosen(:)
        character(*), intent(in), optional :: before, after
        character(:), allocatable :: text
        integer :: i
        text = ''
        do i = 1, size(names)
            if (.not. chosen(i)) cycle
            if (present(before) .and. present(after)) then
                text = text // before // trim(names(i)) // after
            else
                text = text // ', ' // trim(names(i))
            end if
        end do
    end function listed

    !> The parameters of an input.
    subroutine add_parameters(list)
        type(listing_t), intent(inout) :: list
        type(scene_t), allocatable, target :: scene
        type(parameter_table_t) :: table
        type(string_t), allocatable :: lines(:)
        integer :: i

        allocate (scene)
        call describe_scene(scene, table)
        call list_parameters(table, lines)
        do i = 1, size(lines)
            call append(list%text, lines(i)%text)
        end do
        do i = 1, table%count
            call add_parameter(list%json, table%parameters(i))
        end do
    end subroutine add_parameters

    !> A parameter: `default` as in a namelist, `extents` of an array, `lower` and `upper` of its range,
    !> which belong to it unless the range is open there, and the words that it may be.
    subroutine add_parameter(json, parameter)
        type(json_t), intent(inout) :: json
        type(parameter_t), intent(in) :: parameter
        character(7) :: kind

        kind = 'text'
        if (parameter%kind == kind_real) kind = 'real'
        if (any(parameter%kind == [kind_integer, kind_long])) kind = 'integer'
        if (parameter%kind == kind_logical) kind = 'logical'
        call json%open_object()
        call json%add('name', parameter%name)
        call json%add('group', parameter%group)
        call json%add('key', parameter%key)
        call json%add('type', kind)
        call json%add('full_name', parameter%full_name())
        call json%add('unit', parameter%unit)
        if (parameter%default == '') call json%add_null('default')
        if (parameter%default /= '') call json%add('default', parameter%default)
        call json%add('range', parameter%rule)
        call add_bound(json, 'lower', parameter%range%lower, parameter%range%lower_open)
        call add_bound(json, 'upper', parameter%range%upper, parameter%range%upper_open)
        call json%add('choices', parameter%choices)
        call json%add('description', parameter%what)
        call json%close()
    end subroutine add_parameter

    !> An end of a range, and whether it is open; null where there is none.
    subroutine add_bound(json, key, bound, is_open)
        type(json_t), intent(inout) :: json
        character(*), intent(in) :: key
        real(dp), intent(in) :: bound
        logical, intent(in) :: is_open
        if (abs(bound) < huge(bound)) then
            call json%add(key, bound)
            call json%add(key // '_open', is_open)
        else
            call json%add_null(key)
            call json%add_null(key // '_open')
        end if
    end subroutine add_bound

    !> The cases of the catalogue of hard motions.
    subroutine add_cases(list)
        type(listing_t), intent(inout) :: list
        integer :: i
        do i = 1, size(hard_cases)
            call list%begin_item(hard_cases(i)%name, hard_cases(i)%what)
            call list%json%add('is_long', hard_cases(i)%is_long)
            call list%end_item(hard_cases(i)%what)
        end do
    end subroutine add_cases

    !> The published benchmarks.
    subroutine add_benchmarks(list)
        type(listing_t), intent(inout) :: list
        integer :: i
        do i = 1, size(benchmarks)
            call list%begin_item(benchmarks(i)%name, trim(benchmarks(i)%what) // ': ' // benchmarks(i)%source)
            call list%json%add('description', benchmarks(i)%what)
            call list%json%add('source', benchmarks(i)%source)
            call list%json%close()
        end do
    end subroutine add_benchmarks

    !> The kinds of study, and what each can do.
    subroutine add_studies(list)
        type(listing_t), intent(inout) :: list
        class(study_t), allocatable :: study
        type(study_info_t) :: info
        integer :: i

        do i = 1, size(listed_studies)
            call create_study(listed_studies(i), study)
            info = study%info()
            call list%begin_item(info%name, info%what)
            call list%json%add('takes_axes', info%takes_axes)
            call list%json%add('takes_columns', info%takes_columns)
            call list%json%add('has_parts', info%has_parts)
            call list%json%add('has_netcdf', info%has_netcdf)
            call list%json%add('has_events', info%has_events)
            call list%end_item(info%what)
        end do
    end subroutine add_studies

    !> The statuses of a computation, by their numbers in NetCDF tables.
    subroutine add_statuses(list)
        type(listing_t), intent(inout) :: list
        integer :: i
        do i = lbound(status_names, 1), ubound(status_names, 1)
            call list%begin_item(status_names(i), status_meanings(i))
            call list%json%add('number', i)
            call list%json%add('good', is_good_end(i))
            call list%end_item(status_meanings(i))
        end do
    end subroutine add_statuses

    !> The exit codes of the program.
    subroutine add_exit_codes(list)
        type(listing_t), intent(inout) :: list
        integer :: i
        do i = 1, size(exit_codes)
            call list%add_line(to_text(exit_codes(i)%code), exit_codes(i)%what)
            call list%json%open_object()
            call list%json%add('code', exit_codes(i)%code)
            call list%end_item(exit_codes(i)%what)
        end do
    end subroutine add_exit_codes

end module spintop_listed_topics
