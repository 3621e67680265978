!> The registries as JSON: a list of objects per topic, for scripts. What does not exist is null.
module spintop_listed_json
    use spintop_benchmark_cases, only: benchmarks
    use spintop_arkode_tables, only: arkode_table_names
    use spintop_body, only: body_t
    use spintop_errors, only: exit_codes
    use spintop_event_text, only: named_events, event_grammar
    use spintop_formulation, only: formulation_info_t, formulation_t
    use spintop_formulations, only: create_formulation, formulation_infos
    use spintop_hard_cases, only: hard_cases
    use spintop_json, only: json_t
    use spintop_kinds, only: dp
    use spintop_method_aliases, only: method_aliases
    use spintop_methods, only: create_stepper, exact_info, method_infos
    use spintop_parameter, only: kind_integer, kind_logical, kind_long, kind_real, parameter_t
    use spintop_parameters, only: parameter_table_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_shapes, only: part_infos, shape_infos, shape_by_inertia
    use spintop_status, only: is_good_end, status_names, status_meanings, status_ok
    use spintop_stepper, only: method_info_t, stepper_t
    use spintop_studies, only: list_studies, study_entry_t
    use spintop_study, only: study_info_t
    use spintop_study_column, only: listed_column_t
    use spintop_suitability, only: can_run
    implicit none
    private
    public :: tell_benchmarks, tell_cases, tell_columns, tell_events, tell_exit_codes, tell_formulations, tell_methods, &
        tell_parameters, tell_parts, tell_shapes, tell_statuses, tell_studies

    !> Columns of words that tables have beside those of the registries: of sweeps, events, and statistics.
    character(6), parameter :: other_words(*) = [character(6) :: 'column', 'event', 'factor', 'notes', 'status']

contains

    !> The methods: `kind` is exact, fixed, adaptive or both; `order` is null where the tolerance or the
    !> Butcher table decides; `formulations` are those that the method can integrate for a Lagrange top.
    subroutine tell_methods(json)
        type(json_t), intent(inout) :: json !! the item is appended
        type(method_info_t), allocatable :: methods(:)
        integer :: i

        allocate (methods, source=[exact_info, method_infos()])
        call json%open_list('methods')
        do i = 1, size(methods)
            call tell_method(json, methods(i))
        end do
        call json%close()
    end subroutine tell_methods

    subroutine tell_method(json, method)
        type(json_t), intent(inout) :: json
        type(method_info_t), intent(in) :: method
        character(8) :: kind

        kind = 'exact'
        if (method%fixed_step) kind = 'fixed'
        if (method%adaptive) kind = merge('both    ', 'adaptive', method%fixed_step)
        call json%open_object()
        call json%add('name', method%name)
        call json%add('family', method%family)
        if (method%order > 0) then
            call json%add('order', method%order)
        else
            call json%add_null('order')
        end if
        call json%add('kind', kind)
        call json%add('implicit', method%implicit)
        call json%add('symmetric', method%symmetric)
        call json%add('description', method%what)
        call json%add('formulations', formulations_of(method))
        call json%add('aliases', aliases_of(method%name))
        if (method%takes_table) then
            call json%add('tables', arkode_table_names(method%implicit))
        else
            call json%add_null('tables')
        end if
        call json%close()
    end subroutine tell_method

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
                runs(i) = can_run(stepper, formulation, top) == status_ok
            end do
        end if
        allocate (names(count(runs)))
        names = pack(forms%name, runs)
    end function formulations_of

    !> Other names of a method.
    pure function aliases_of(name) result(others)
        character(*), intent(in) :: name
        character(40), allocatable :: others(:)
        integer :: i, equals
        logical :: is_other(size(method_aliases))
        do i = 1, size(method_aliases)
            is_other(i) = method_aliases(i)(index(method_aliases(i), '=') + 1:) == name
        end do
        allocate (others(count(is_other)))
        others = pack(method_aliases, is_other)
        do i = 1, size(others)
            equals = index(others(i), '=')
            others(i) = others(i)(:equals - 1)
        end do
    end function aliases_of

    !> The formulations.
    subroutine tell_formulations(json)
        type(json_t), intent(inout) :: json !! the item is appended
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i

        allocate (forms, source=formulation_infos())
        call json%open_list('formulations')
        do i = 1, size(forms)
            call json%open_object()
            call json%add('name', forms(i)%name)
            call json%add('states', forms(i)%states)
            call json%add('symmetric_only', forms(i)%symmetric_only)
            call json%add('singular_at_poles', forms(i)%singular_at_poles)
            call json%add('description', forms(i)%what)
            call json%close()
        end do
        call json%close()
    end subroutine tell_formulations

    !> The columns of all kinds of study; `words`: whether the cells are words. `other_words` are columns of words that
    !> no list of columns has.
    subroutine tell_columns(json)
        type(json_t), intent(inout) :: json !! the item is appended
        type(study_entry_t), allocatable :: known(:)
        type(listed_column_t), allocatable :: columns(:)
        type(study_info_t) :: info
        integer :: i, k

        call list_studies(known)
        call json%open_list('columns')
        do i = 1, size(known)
            info = known(i)%study%info()
            columns = known(i)%study%columns()
            do k = 1, size(columns)
                call json%open_object()
                call json%add('study', info%name)
                call json%add('name', columns(k)%name)
                call json%add('group', columns(k)%group)
                call json%add('unit', columns(k)%unit)
                call json%add('words', columns(k)%words)
                call json%add('description', columns(k)%what)
                call json%close()
            end do
        end do
        call json%close()
        call json%add('other_words', other_words)
    end subroutine tell_columns

    !> The events with names, what their rows are called in a table, and the grammar of the others.
    subroutine tell_events(json)
        type(json_t), intent(inout) :: json !! the item is appended
        integer :: i
        call json%open_list('events')
        do i = 1, size(named_events)
            if (named_events(i)%what == '') cycle
            call json%open_object()
            call json%add('name', named_events(i)%name)
            call json%add('in_table', pack(named_events%in_table, named_events%name == named_events(i)%name))
            call json%add('description', named_events(i)%what)
            call json%close()
        end do
        call json%close()
        call json%add('event_grammar', event_grammar)
    end subroutine tell_events

    !> The shapes; `needs` are the keys of &top, beside a mass or a density.
    subroutine tell_shapes(json)
        type(json_t), intent(inout) :: json !! the item is appended
        character(12), parameter :: dimensions(*) = [character(12) :: 'radius', 'inner_radius', 'thickness', 'rod_length']
        integer :: i

        call json%open_list('shapes')
        call json%open_object()
        call json%add('name', shape_by_inertia)
        call json%add('needs', [character(12) :: 'inertia'])
        call json%add('description', 'given by its mass properties')
        call json%close()
        do i = 1, size(shape_infos)
            associate (shape => shape_infos(i))
                call json%open_object()
                call json%add('name', shape%name)
                call json%add('needs', pack(dimensions, [.true., shape%needs_inner_radius, shape%needs_thickness, &
                                                         shape%needs_rod_length]))
                call json%add('description', shape%what)
                call json%close()
            end associate
        end do
        call json%close()
    end subroutine tell_shapes

    !> The parts of bodies; `needs` and `takes` are the keys of &part that a part must and may have, beside its mass.
    subroutine tell_parts(json)
        type(json_t), intent(inout) :: json !! the item is appended
        character(12), parameter :: dimensions(*) = [character(12) :: 'radius', 'inner_radius', 'thickness']
        integer :: i

        call json%open_list('parts')
        do i = 1, size(part_infos)
            associate (part => part_infos(i))
                call json%open_object()
                call json%add('name', part%name)
                call json%add('needs', pack(dimensions, part%needs))
                call json%add('takes', pack(dimensions, part%takes .and. .not. part%needs))
                call json%add('description', part%what)
                call json%close()
            end associate
        end do
        call json%close()
    end subroutine tell_parts

    !> The parameters of an input.
    subroutine tell_parameters(json)
        type(json_t), intent(inout) :: json !! the item is appended
        type(scene_t), allocatable, target :: scene
        type(parameter_table_t) :: table
        integer :: i

        allocate (scene)
        call describe_scene(scene, table)
        call json%open_list('parameters')
        do i = 1, size(table%parameters)
            call tell_parameter(json, table%parameters(i))
        end do
        call json%close()
    end subroutine tell_parameters

    !> A parameter: `default` as in a namelist, `extents` of an array, `lower` and `upper` of its range,
    !> which belong to it unless the range is open there, and the words that it may be.
    subroutine tell_parameter(json, parameter)
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
        call json%add_optional('default', parameter%default)
        call json%add('range', parameter%rule)
        call tell_bound(json, 'lower', parameter%range%lower, parameter%range%lower_open)
        call tell_bound(json, 'upper', parameter%range%upper, parameter%range%upper_open)
        call json%add('choices', parameter%choices)
        call json%add('description', parameter%what)
        call json%close()
    end subroutine tell_parameter

    !> An end of a range, and whether it is open; null where there is none.
    subroutine tell_bound(json, key, bound, is_open)
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
    end subroutine tell_bound

    !> The cases of the catalogue of hard motions, with their settings as on a command line.
    subroutine tell_cases(json)
        type(json_t), intent(inout) :: json !! the item is appended
        integer :: i
        call json%open_list('cases')
        do i = 1, size(hard_cases)
            call json%open_object()
            call json%add('name', hard_cases(i)%name)
            call json%add('is_long', hard_cases(i)%is_long)
            call json%add('description', hard_cases(i)%what)
            call json%close()
        end do
        call json%close()
    end subroutine tell_cases

    !> The published benchmarks.
    subroutine tell_benchmarks(json)
        type(json_t), intent(inout) :: json !! the item is appended
        integer :: i
        call json%open_list('benchmarks')
        do i = 1, size(benchmarks)
            call json%open_object()
            call json%add('name', benchmarks(i)%name)
            call json%add('description', benchmarks(i)%what)
            call json%add('source', benchmarks(i)%source)
            call json%close()
        end do
        call json%close()
    end subroutine tell_benchmarks

    !> The kinds of study, and what each can do.
    subroutine tell_studies(json)
        type(json_t), intent(inout) :: json !! the item is appended
        type(study_entry_t), allocatable :: known(:)
        type(study_info_t) :: info
        integer :: i

        call list_studies(known)
        call json%open_list('studies')
        do i = 1, size(known)
            info = known(i)%study%info()
            call json%open_object()
            call json%add('name', info%name)
            call json%add('takes_axes', info%takes_axes)
            call json%add('takes_columns', info%takes_columns)
            call json%add('has_parts', info%has_parts)
            call json%add('has_netcdf', info%has_netcdf)
            call json%add('has_events', info%has_events)
            call json%add('description', info%what)
            call json%close()
        end do
        call json%close()
    end subroutine tell_studies

    !> The statuses of a computation, by their numbers in NetCDF tables.
    subroutine tell_statuses(json)
        type(json_t), intent(inout) :: json !! the item is appended
        integer :: i
        call json%open_list('statuses')
        do i = lbound(status_names, 1), ubound(status_names, 1)
            call json%open_object()
            call json%add('name', status_names(i))
            call json%add('number', i)
            call json%add('good', is_good_end(i))
            call json%add('description', status_meanings(i))
            call json%close()
        end do
        call json%close()
    end subroutine tell_statuses

    !> The exit codes of the program.
    subroutine tell_exit_codes(json)
        type(json_t), intent(inout) :: json !! the item is appended
        integer :: i
        call json%open_list('exit_codes')
        do i = 1, size(exit_codes)
            call json%open_object()
            call json%add('code', exit_codes(i)%code)
            call json%add('description', exit_codes(i)%what)
            call json%close()
        end do
        call json%close()
    end subroutine tell_exit_codes

end module spintop_listed_json
