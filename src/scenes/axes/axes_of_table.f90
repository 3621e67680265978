!> The axes of a sweep from arrays of a caller, or from a CSV table: its columns are parameters, its rows are cases.
!>
!>     # drawn elsewhere
!>     initial.spin_ratio, "top.inertia(2)"
!>     0.5,                0.875
module spintop_axes_of_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_axes_of_scene, only: count_axes, find_axis
    use spintop_checksum, only: checksum_of
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_files, only: beside_input
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: table_t
    use spintop_parameters, only: parameter_table_t, unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t, combination_names, combine_grid, combine_zip
    use spintop_sweep_axes, only: axes_t, axis_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: read_axes, given_axis_t, make_axes_of_arrays

    !> The values of a parameter, one for each case.
    type :: given_axis_t
        !> Its name, as `initial.spin_ratio`.
        character(:), allocatable :: name
        real(dp), allocatable :: values(:)
    end type given_axis_t

contains

    !> Reads the table of a scene. Errors in the table are added to the diagnostics, errors of the scene to
    !> the problems; the axes then have no cases. A missing checksum is set in the scene.
    subroutine read_axes(input, scene, table, axes, problems, diagnostics)
        character(*), intent(in) :: input !! path of the input: the table's is relative to it
        type(scene_t), intent(inout) :: scene !! its checksum is set if it is missing
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(axes_t), intent(out) :: axes !! the axes; without cases if there are problems
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(table_t) :: cases
        type(error_t), allocatable :: error

        if (count_axes(scene) > 0) then
            call problems%add('sweep.table', 'the cases are given twice', 'give either axes or a table')
        else if (scene%combine /= combination_names(combine_grid)) then
            call problems%add('sweep.combine', 'the rows of the table are the cases', 'omit it')
        else if (scene%cases /= unset_integer) then
            call problems%add('sweep.cases', 'the rows of the table are the cases', 'omit it')
        end if
        call cases%open(input, scene%sweep_table, diagnostics, error)
        if (allocated(error)) then
            call problems%add('sweep.table', error%message, beside_input)
            return
        end if
        if (scene%sweep_table_checksum == '') then
            scene%sweep_table_checksum = checksum_of(cases%text)
        else if (scene%sweep_table_checksum /= checksum_of(cases%text)) then
            call problems%add('sweep.table_checksum', 'the table has changed: its checksum is ' &
                              // checksum_of(cases%text), 'omit the checksum to accept any table')
        end if
        if (.not. allocated(cases%names)) return
        call find_parameters(cases, table, axes%axis, diagnostics)
        if (size(axes%axis) > 0) call read_values(cases, axes%axis, diagnostics)
        if (problems%any() .or. .not. cases%is_valid) return
        call axes%combine(combine_zip, int(axes%axis(1)%count, int64), int(scene%seed, int64))
    end subroutine read_axes

    !> Makes an axis for each column; none if a comma parts a name.
    subroutine find_parameters(cases, table, axis, diagnostics)
        type(table_t), intent(inout) :: cases
        type(parameter_table_t), intent(in) :: table
        type(axis_t), allocatable, intent(out) :: axis(:)
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: problem, hint
        integer :: i

        allocate (axis(size(cases%names)))
        do i = 1, size(axis)
            axis(i)%name = cases%names(i)%text
            if (index(axis(i)%name, '(') > 0 .and. index(axis(i)%name, ')') == 0) then
                call cases%refuse(diagnostics, i, 0, 'a comma parts the name ' // axis(i)%name, &
                                  'put a name with a comma in double quotes: "top.inertia_tensor(1,2)"')
                deallocate (axis)
                allocate (axis(0))
                return
            end if
            call find_axis(axis(i), axis(:i - 1), table, problem, hint)
            if (problem == '') cycle
            if (axis(i)%name == '') problem = 'a column has no name'
            call cases%refuse(diagnostics, i, 0, problem, hint)
        end do
    end subroutine find_parameters

    !> Reads the rows into the axes. Values of refused columns are not checked.
    subroutine read_values(cases, axis, diagnostics)
        type(table_t), intent(inout) :: cases
        type(axis_t), intent(inout) :: axis(:)
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: problem, hint
        integer :: row, i

        call cases%read_rows(diagnostics)
        if (cases%rows == 0 .and. cases%is_valid) then
            call cases%refuse(diagnostics, 1, 0, 'the table has no rows', 'each row is a case')
        end if
        do i = 1, size(axis)
            allocate (axis(i)%listed(cases%rows))
            axis(i)%count = cases%rows
        end do
        do row = 1, cases%rows
            do i = 1, size(axis)
                associate (value => axis(i)%listed(row))
                    call cases%read_number(i, row, value, problem, hint)
                    ! A refused column has no rule.
                    if (problem == '' .and. allocated(axis(i)%slot%range%rule)) then
                        problem = axis(i)%slot%refusal(value)
                        if (problem /= '') problem = axis(i)%name // ' ' // problem
                    end if
                end associate
                if (problem == '') cycle
                call cases%refuse(diagnostics, i, row, problem, hint)
            end do
        end do
    end subroutine read_values

    !> The axes of some arrays, which have the same length. Without any, there is one case: that of the scene. With
    !> problems the axes have no cases.
    subroutine make_axes_of_arrays(given, scene, table, axes, problems)
        type(given_axis_t), intent(in) :: given(:) !! names of the parameters, and a value of each for every case
        type(scene_t), intent(in) :: scene !! contents of the input
        type(parameter_table_t), intent(in) :: table !! its parameters
        type(axes_t), intent(out) :: axes !! the axes; without cases if there are problems
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        character(:), allocatable :: problem, hint
        integer :: i, k

        if (count_axes(scene) > 0 .or. scene%sweep_table /= '') then
            call problems%add('sweep', 'the cases are given twice', 'give either arrays or a group &sweep')
        end if
        allocate (axes%axis(size(given)))
        do i = 1, size(given)
            associate (axis => axes%axis(i))
                axis%name = given(i)%name
                call find_axis(axis, axes%axis(:i - 1), table, problem, hint)
                if (problem /= '') then
                    call problems%add('sweep', problem, hint)
                    cycle
                end if
                axis%listed = given(i)%values
                axis%count = size(axis%listed)
                k = findloc(axis%slot%accepts(axis%listed), .false., dim=1)
                if (k > 0) call problems%add('sweep', 'element ' // to_text(k) // ' of ' // axis%name // ' ' // &
                                             axis%slot%refusal(axis%listed(k)), 'give a value in the range')
            end associate
        end do
        if (problems%any()) return
        axes%combination = combine_zip
        if (size(given) == 0) then
            axes%cases = 1
        else
            call axes%combine(combine_zip, int(axes%axis(1)%count, int64), 1_int64)
        end if
    end subroutine make_axes_of_arrays

end module spintop_axes_of_table
