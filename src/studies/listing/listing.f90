!> What `spintop list` shows: the registries themselves, as aligned text or as JSON. An item is a line
!> of text (its name, a second column, and what it is) and an object of JSON, for scripts, where what does not exist is null.
module spintop_listing
    use spintop_arkode, only: arkode_table_names
    use spintop_benchmark_study, only: benchmarks
    use spintop_body, only: body_t
    use spintop_errors, only: error_t, input_error, exit_codes
    use spintop_event_recorder, only: named_events, event_grammar
    use spintop_formulation, only: formulation_info_t, formulation_t
    use spintop_formulations, only: create_formulation, formulation_infos
    use spintop_stability_study, only: hard_cases
    use spintop_json, only: json_t
    use spintop_kinds, only: dp
    use spintop_methods, only: can_run, create_stepper, exact_info, method_infos, method_aliases
    use spintop_parameter, only: kind_integer, kind_logical, kind_long, kind_real
    use spintop_parameter_print, only: list_parameters
    use spintop_parameters, only: parameter_table_t
    use spintop_provenance, only: program_version
    use spintop_scene_keys, only: scene_t, describe_scene
    use spintop_shapes, only: part_infos, shape_infos, shape_by_inertia
    use spintop_status, only: is_good_end, status_names, status_meanings, is_ok
    use spintop_stepper, only: method_info_t, stepper_t
    use spintop_studies, only: create_study, listed_studies
    use spintop_study, only: study_t
    use spintop_study_column, only: categorical
    use spintop_terminal, only: output_width
    use spintop_text, only: string_t, did_you_mean, join, append, to_text, wrapped
    use spintop_units, only: find_unit, suffixes_of
    implicit none
    private
    public :: list_topic, topic_names

    !> Lists of items, as text and as members of a JSON object.
    type :: listing_t
        type(string_t), allocatable :: text(:)
        type(json_t) :: json
    contains
        procedure :: add_line
        procedure :: begin_item
        procedure :: end_item
    end type listing_t

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

    !> Number of the layout of the JSON. A member that is new does not change it.
    integer, parameter :: json_format = 1

contains

    !> The names of all topics, with a separator between them.
    function topic_names(separator) result(names)
        character(*), intent(in) :: separator !! text between two parts
        character(:), allocatable :: names
        names = join(topics%name, separator)
    end function topic_names

    !> The list of a topic, or of all: as a JSON document, or as lines as wide as the terminal, without a topic the topics.
    subroutine list_topic(topic, as_json, lines, error)
        character(*), intent(in) :: topic !! one of `topics`, or ''
        logical, intent(in) :: as_json !! whether the list is for scripts
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(error_t), allocatable, intent(out) :: error !! there is no such topic
        type(listing_t) :: list
        character(:), allocatable :: hint
        integer :: i, last_column

        if (topic /= '' .and. .not. any(topics%name == topic)) then
            hint = did_you_mean(topic, topics%name)
            if (hint /= '') hint = '; ' // hint
            error = input_error("spintop: cannot list '" // topic // "'" // hint // ' (there are ' // topic_names(', ') // ')')
            return
        end if
        call list%json%begin()
        call list%json%add('format', json_format)
        call list%json%add('version', program_version)
        do i = 1, size(topics)
            if (topic == topics(i)%name .or. (topic == '' .and. as_json)) call add_topic(list, trim(topics(i)%name))
        end do
        if (as_json) then
            call list%json%finish(lines)
            return
        else if (topic == '') then
            call append(list%text, 'spintop list TOPIC lists one of these; with --json for scripts, without a topic all of them')
            call append(list%text, '')
            do i = 1, size(topics)
                call append(list%text, '  ' // topics(i)%name // '  ' // trim(topics(i)%what))
            end do
        end if
        call move_alloc(list%text, lines)
        do i = 1, size(lines)
            if (len_trim(lines(i)%text) <= output_width()) cycle
            ! Continuation lines are below their own column.
            last_column = index(lines(i)%text, '  ', back=.true.)
            lines(i)%text = wrapped(lines(i)%text, 0, output_width(), indent=max(4, last_column + 1))
        end do
    end subroutine list_topic

    !> Adds the list of a topic.
    subroutine add_topic(list, topic)
        type(listing_t), intent(inout) :: list !! the items are added
        character(*), intent(in) :: topic !! name of one of `topics`
        class(study_t), allocatable :: study
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i

        call list%json%open_list(topic)
        select case (topic)
        case ('methods')
            call add_methods(list)
        case ('formulations')
            allocate (forms, source=formulation_infos())
            call list%add_line('auto', 'the one that suits the method and the body (the default)')
            do i = 1, size(forms)
                call list%begin_item(forms(i)%name, forms(i)%what)
                call list%json%add('states', forms(i)%states)
                call list%json%add('symmetric_only', forms(i)%symmetric_only)
                call list%json%add('singular_at_poles', forms(i)%singular_at_poles)
                call list%end_item(forms(i)%what)
            end do
        case ('columns')
            call add_columns(list)
        case ('events') ! those with names, what their rows are called in a table, and the grammar of the others
            do i = 1, size(named_events)
                if (named_events(i)%what == '') cycle
                call list%begin_item(named_events(i)%name, named_events(i)%what)
                call list%json%add('in_table', pack(named_events%in_table, named_events%name == named_events(i)%name))
                call list%end_item(named_events(i)%what)
            end do
            call append(list%text, '  ' // event_grammar)
        case ('shapes')
            call add_shapes(list)
        case ('parts')
            call add_parts(list)
        case ('parameters')
            call add_parameters(list)
        case ('cases')
            do i = 1, size(hard_cases)
                call list%begin_item(hard_cases(i)%name, hard_cases(i)%what)
                call list%json%add('is_long', hard_cases(i)%is_long)
                call list%end_item(hard_cases(i)%what)
            end do
        case ('benchmarks')
            do i = 1, size(benchmarks)
                call list%begin_item(benchmarks(i)%name, trim(benchmarks(i)%what) // ': ' // benchmarks(i)%source)
                call list%json%add('description', benchmarks(i)%what)
                call list%json%add('source', benchmarks(i)%source)
                call list%json%close()
            end do
        case ('studies') ! and what each can do
            do i = 1, size(listed_studies)
                call create_study(listed_studies(i), study)
                call list%begin_item(study%info%name, study%info%what)
                call list%json%add('takes_axes', study%info%takes_axes)
                call list%json%add('takes_columns', study%info%takes_columns)
                call list%json%add('has_parts', study%info%has_parts)
                call list%json%add('has_netcdf', study%info%has_netcdf)
                call list%json%add('has_events', study%info%has_events)
                call list%end_item(study%info%what)
            end do
        case ('statuses') ! by their numbers in NetCDF tables
            do i = lbound(status_names, 1), ubound(status_names, 1)
                call list%begin_item(status_names(i), status_meanings(i))
                call list%json%add('number', i)
                call list%json%add('good', is_good_end(i))
                call list%end_item(status_meanings(i))
            end do
        case ('exit_codes')
            do i = 1, size(exit_codes)
                call list%add_line(to_text(exit_codes(i)%code), exit_codes(i)%what)
                call list%json%open_object()
                call list%json%add('code', exit_codes(i)%code)
                call list%end_item(exit_codes(i)%what)
            end do
        end select
        call list%json%close()
        if (topic == 'columns') call add_units(list)
        if (topic == 'events') call list%json%add('event_grammar', event_grammar)
    end subroutine add_topic

    !> The columns of all kinds of study; `words`: whether the cells are words. `other_words` are columns of words that
    !> no list of columns has.
    subroutine add_columns(list)
        type(listing_t), intent(inout) :: list
        class(study_t), allocatable :: study
        integer :: i, k

        do i = 1, size(listed_studies)
            call create_study(listed_studies(i), study)
            if (i > 1) call append(list%text, '')
            call append(list%text, 'columns of ' // study%info%phrase // study%info%remark)
            do k = 1, size(study%columns)
                call list%add_line(study%columns(k)%name, study%columns(k)%what, study%columns(k)%unit)
                call list%json%open_object()
                call list%json%add('study', study%info%name)
                call list%json%add('name', study%columns(k)%name)
                call list%json%add('group', study%columns(k)%group)
                call list%json%add('unit', study%columns(k)%unit)
                call list%json%add('words', study%columns(k)%is(categorical))
                call list%end_item(study%columns(k)%what)
            end do
        end do
    end subroutine add_columns

    !> The units in which columns can be: what follows the name of a column of the unit `of`, and the `size` of the unit in that.
    subroutine add_units(list)
        type(listing_t), intent(inout) :: list
        class(study_t), allocatable :: study
        type(string_t), allocatable :: known(:), suffixes(:)
        character(:), allocatable :: unit, problem
        real(dp) :: factor
        integer :: kind, i, k

        allocate (known(0))
        do kind = 1, size(listed_studies)
            call create_study(listed_studies(kind), study)
            if (.not. study%info%takes_columns) cycle
            do k = 1, size(study%columns)
                if (any([(known(i)%text == study%columns(k)%unit, i=1, size(known))])) cycle
                call append(known, trim(study%columns(k)%unit))
            end do
        end do
        call list%json%add('other_words', other_words)
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
                call list%begin_item(shape%name, trim(shape%what) // '; needs mass or density' // &
                                     listed(dimensions, needs, ', ', ''))
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
                                     listed(dimensions, part%needs, ', ', '') // listed(dimensions, may_have, ' (', ')'))
                call list%json%add('needs', pack(dimensions, part%needs))
                call list%json%add('takes', pack(dimensions, may_have))
                call list%end_item(part%what)
            end associate
        end do
    end subroutine add_parts

    !> Some of a list of names, each with what is before and after it.
    pure function listed(names, chosen, before, after) result(text)
        character(*), intent(in) :: names(:), before, after
        logical, intent(in) :: chosen(:)
        character(:), allocatable :: text
        text = ''
        if (any(chosen)) text = before // join(pack(names, chosen), after // before) // after
    end function listed

    !> The parameters of an input: `default` as in a namelist, `extents` of an array, `lower` and `upper` of its range, which belong
    !> to it unless the range is open there, and the words that it may be.
    subroutine add_parameters(list)
        type(listing_t), intent(inout) :: list
        type(scene_t), allocatable, target :: scene
        type(parameter_table_t) :: table
        type(string_t), allocatable :: lines(:)
        character(7) :: kind
        integer :: i

        allocate (scene)
        call describe_scene(scene, table)
        call list_parameters(table, lines)
        do i = 1, size(lines)
            call append(list%text, lines(i)%text)
        end do
        do i = 1, table%count
            associate (parameter => table%parameters(i), json => list%json)
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
                call json%add('range', parameter%range%rule)
                call add_bound(json, 'lower', parameter%range%lower, parameter%range%lower_open)
                call add_bound(json, 'upper', parameter%range%upper, parameter%range%upper_open)
                call json%add('choices', parameter%choices)
                call json%add('description', parameter%what)
                call json%close()
            end associate
        end do
    end subroutine add_parameters

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

    !> The methods: `kind` is exact, fixed, adaptive or both; `order` is null where the tolerance or the
    !> Butcher table decides; `formulations` are those that the method can integrate for a Lagrange top.
    subroutine add_methods(list)
        type(listing_t), intent(inout) :: list !! the items are added
        type(method_info_t), allocatable :: methods(:)
        character(40), allocatable :: aliases(:)
        character(:), allocatable :: steps
        character(8) :: kind
        integer :: i, k, equals

        allocate (methods, source=[exact_info, method_infos()])
        call list%add_line('auto', 'the cheapest adequate one (the default)')
        do i = 1, size(methods)
            associate (method => methods(i), json => list%json)
                kind = 'exact'
                if (method%fixed_step) kind = 'fixed'
                if (method%adaptive) kind = merge('both    ', 'adaptive', method%fixed_step)
                aliases = [character(40) ::]
                do k = 1, size(method_aliases)
                    equals = index(method_aliases(k), '=')
                    if (method_aliases(k)(equals + 1:) /= method%name) cycle
                    aliases = [character(40) :: aliases, method_aliases(k)(:equals - 1)]
                end do
                steps = ''
                if (method%order > 0) steps = 'order ' // to_text(method%order)
                if (method%adaptive) steps = steps // ' adaptive'
                if (method%fixed_step) steps = steps // ' fixed'
                call list%begin_item(method%name, method%what, adjustl(steps))
                call json%add('family', method%family)
                if (method%order > 0) call json%add('order', method%order)
                if (.not. method%order > 0) call json%add_null('order')
                call json%add('kind', kind)
                call json%add('implicit', method%implicit)
                call json%add('symmetric', method%symmetric)
                call json%add('description', method%what)
                call json%add('formulations', formulations_of(method))
                call json%add('aliases', aliases)
                if (method%takes_table) call json%add('tables', arkode_table_names(method%implicit))
                if (.not. method%takes_table) call json%add_null('tables')
                call json%close()
            end associate
        end do
        call append(list%text, '')
        call append(list%text, 'tables of arkode_erk, for integration.table:  ' // join(arkode_table_names(.false.), ', '))
        call append(list%text, 'tables of arkode_dirk, for integration.table: ' // join(arkode_table_names(.true.), ', '))
    end subroutine add_methods

    !> The formulations under which a method can integrate a Lagrange top.
    function formulations_of(method) result(names)
        type(method_info_t), intent(in) :: method
        character(16), allocatable :: names(:)
        type(formulation_info_t), allocatable :: forms(:)
        logical, allocatable :: runs(:)
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        type(body_t) :: top
        integer :: i

        allocate (forms, source=formulation_infos())
        allocate (runs(size(forms)), source=.false.)
        call create_stepper(method%name, stepper)
        ! The exact solution has none.
        if (allocated(stepper)) then
            if (.not. method%adaptive) stepper%controls%steps = 1
            stepper%controls%relative_tolerance = max(stepper%controls%relative_tolerance, method%finest_tolerance)
            top%inertia = [2.0_dp, 2.0_dp, 1.0_dp]
            top%centre_of_mass(3) = 1
            do i = 1, size(forms)
                call create_formulation(forms(i)%name, formulation)
                runs(i) = is_ok(can_run(stepper, formulation, top))
            end do
        end if
        allocate (names(count(runs)))
        names = pack(forms%name, runs)
    end function formulations_of

    !> Adds a line of text: a name, a second column if it is not blank, and a meaning.
    subroutine add_line(self, name, what, second)
        class(listing_t), intent(inout) :: self
        character(*), intent(in) :: name !! the first column
        character(*), intent(in) :: what !! the meaning
        character(*), intent(in), optional :: second !! the second column
        character(30) :: first_column
        character(24) :: second_column
        first_column = name
        second_column = ''
        if (present(second)) second_column = second
        if (second_column == '') then
            call append(self%text, '  ' // first_column // trim(what))
        else
            call append(self%text, '  ' // first_column // second_column // trim(what))
        end if
    end subroutine add_line

    !> Adds the line of an item, and opens its object with its name. Its other members follow.
    subroutine begin_item(self, name, what, second)
        class(listing_t), intent(inout) :: self
        character(*), intent(in) :: name !! the first column
        character(*), intent(in) :: what !! the meaning
        character(*), intent(in), optional :: second !! the second column
        call self%add_line(name, what, second)
        call self%json%open_object()
        call self%json%add('name', name)
    end subroutine begin_item

    !> Adds the description of an item as the last member of its object.
    subroutine end_item(self, what)
        class(listing_t), intent(inout) :: self
        character(*), intent(in) :: what !! the description
        call self%json%add('description', what)
        call self%json%close()
    end subroutine end_item

end module spintop_listing
