!> The registries as aligned text, a line per item: its name, a second column, and what it is.
module spintop_listed_text
    use spintop_benchmark_cases, only: benchmarks
    use spintop_arkode_tables, only: arkode_table_names
    use spintop_errors, only: exit_codes
    use spintop_event_text, only: named_events, event_grammar
    use spintop_formulation, only: formulation_info_t
    use spintop_formulations, only: formulation_infos
    use spintop_hard_cases, only: hard_cases
    use spintop_line_list, only: line_list_t
    use spintop_methods, only: exact_info, method_infos
    use spintop_parameter_print, only: list_parameters
    use spintop_parameters, only: parameter_table_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_shapes, only: part_infos, shape_infos, shape_by_inertia
    use spintop_status, only: status_names, status_meanings
    use spintop_stepper, only: method_info_t
    use spintop_studies, only: list_studies, study_entry_t
    use spintop_study, only: study_info_t
    use spintop_study_column, only: listed_column_t
    use spintop_text, only: string_t, join, to_text
    implicit none
    private
    public :: show_benchmarks, show_cases, show_columns, show_events, show_exit_codes, show_formulations, show_methods, &
        show_parameters, show_parts, show_shapes, show_statuses, show_studies

contains

    !> The methods, with their order and kind of steps, and the Butcher tables of ARKODE.
    subroutine show_methods(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        type(method_info_t), allocatable :: methods(:)
        integer :: i

        allocate (methods, source=method_infos())
        call add(text, 'auto', '', 'the cheapest adequate one (the default)')
        call add(text, exact_info%name, '', exact_info%what)
        do i = 1, size(methods)
            call add(text, methods(i)%name, kind_of(methods(i)), methods(i)%what)
        end do
        call text%add('')
        call text%add('tables of arkode_erk:  ' // join(arkode_table_names(.false.), ', '))
        call text%add('tables of arkode_dirk: ' // join(arkode_table_names(.true.), ', '))
        call text%get(lines)
    end subroutine show_methods

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

    !> The formulations.
    subroutine show_formulations(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        type(formulation_info_t), allocatable :: forms(:)
        integer :: i

        allocate (forms, source=formulation_infos())
        call add(text, 'auto', '', 'the one that suits the method and the body (the default)')
        do i = 1, size(forms)
            call add(text, forms(i)%name, '', forms(i)%what)
        end do
        call text%get(lines)
    end subroutine show_formulations

    !> The columns of each kind of study.
    subroutine show_columns(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        type(study_entry_t), allocatable :: known(:)
        type(listed_column_t), allocatable :: columns(:)
        type(study_info_t) :: info
        integer :: i, k

        call list_studies(known)
        do i = 1, size(known)
            info = known(i)%study%info()
            columns = known(i)%study%columns()
            if (i > 1) call text%add('')
            call text%add('columns of ' // info%phrase // info%remark)
            do k = 1, size(columns)
                call add(text, columns(k)%name, columns(k)%unit, columns(k)%what)
            end do
        end do
        call text%get(lines)
    end subroutine show_columns

    !> The events with names, and the grammar of the others.
    subroutine show_events(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        integer :: i
        do i = 1, size(named_events)
            if (named_events(i)%what /= '') call add(text, named_events(i)%name, '', named_events(i)%what)
        end do
        call text%add('  ' // event_grammar)
        call text%get(lines)
    end subroutine show_events

    !> The shapes, with the dimensions that they need.
    subroutine show_shapes(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        integer :: i
        call add(text, shape_by_inertia, '', &
                 'given by mass, inertia(3) and length or centre_of_mass(3) (the default)')
        do i = 1, size(shape_infos)
            call add(text, shape_infos(i)%name, '', trim(shape_infos(i)%what) // &
                     '; needs mass or density, radius' // &
                     trim(merge(', inner_radius', '              ', shape_infos(i)%needs_inner_radius)) // &
                     trim(merge(', thickness', '           ', shape_infos(i)%needs_thickness)) // &
                     trim(merge(', rod_length', '            ', shape_infos(i)%needs_rod_length)))
        end do
        call text%get(lines)
    end subroutine show_shapes

    !> The parts of bodies, with the dimensions that they need and those that they may have.
    subroutine show_parts(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        character(14), parameter :: dimensions(*) = [character(14) :: ', radius', ', inner_radius', ', thickness']
        type(line_list_t) :: text
        character(160) :: what
        integer :: i, k
        do i = 1, size(part_infos)
            associate (part => part_infos(i))
                what = trim(part%what) // '; needs mass or density'
                do k = 1, size(dimensions)
                    if (part%needs(k)) what = trim(what) // dimensions(k)
                end do
                do k = 1, size(dimensions)
                    if (part%takes(k) .and. .not. part%needs(k)) what = trim(what) // ' (' // trim(dimensions(k) (3:)) // ')'
                end do
                call add(text, part%name, '', trim(what))
            end associate
        end do
        call text%get(lines)
    end subroutine show_parts

    !> The parameters of an input.
    subroutine show_parameters(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(scene_t), allocatable, target :: scene
        type(parameter_table_t) :: table
        allocate (scene)
        call describe_scene(scene, table)
        call list_parameters(table, lines)
    end subroutine show_parameters

    !> The cases of the catalogue of hard motions.
    subroutine show_cases(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        integer :: i
        do i = 1, size(hard_cases)
            call add(text, hard_cases(i)%name, '', hard_cases(i)%what)
        end do
        call text%get(lines)
    end subroutine show_cases

    !> The published benchmarks.
    subroutine show_benchmarks(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        integer :: i
        do i = 1, size(benchmarks)
            call add(text, benchmarks(i)%name, '', trim(benchmarks(i)%what) // ': ' // benchmarks(i)%source)
        end do
        call text%get(lines)
    end subroutine show_benchmarks

    !> The kinds of study.
    subroutine show_studies(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        type(study_entry_t), allocatable :: known(:)
        type(study_info_t) :: info
        integer :: i
        call list_studies(known)
        do i = 1, size(known)
            info = known(i)%study%info()
            call add(text, info%name, '', info%what)
        end do
        call text%get(lines)
    end subroutine show_studies

    !> The statuses of a computation.
    subroutine show_statuses(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        integer :: i
        do i = lbound(status_names, 1), ubound(status_names, 1)
            call add(text, status_names(i), '', status_meanings(i))
        end do
        call text%get(lines)
    end subroutine show_statuses

    !> The exit codes of the program.
    subroutine show_exit_codes(lines)
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(line_list_t) :: text
        integer :: i
        do i = 1, size(exit_codes)
            call add(text, to_text(exit_codes(i)%code), '', exit_codes(i)%what)
        end do
        call text%get(lines)
    end subroutine show_exit_codes

    !> Adds a line of name, second column and meaning.
    subroutine add(text, name, second, what)
        type(line_list_t), intent(inout) :: text
        character(*), intent(in) :: name, second, what
        character(30) :: first_column
        character(24) :: second_column
        first_column = name
        second_column = second
        if (second == '') then
            call text%add('  ' // first_column // trim(what))
        else
            call text%add('  ' // first_column // second_column // trim(what))
        end if
    end subroutine add

end module spintop_listed_text
