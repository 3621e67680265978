!> Numbers of an input whose unit is that of something that the input names elsewhere: the ends of an axis of a sweep have the
!> unit of its parameter, the standard deviation of a sensor that of its column.
module spintop_named_units
    use spintop_diagnostics, only: diagnostics_t
    use spintop_kinds, only: dp
    use spintop_parameter, only: parameter_t
    use spintop_parameters, only: parameter_table_t
    use spintop_scene_keys, only: scene_t
    use spintop_study_column, only: chosen_column_t, find_column
    use spintop_sweep_columns, only: sweep_columns
    use spintop_text, only: to_text
    use spintop_trajectory_columns, only: trajectory_columns
    use spintop_units, only: convert_unit, units_of
    implicit none
    private
    public :: convert_named_units

contains

    !> Converts the numbers that were given with a unit to that which they have to have; what cannot be converted is an error.
    subroutine convert_named_units(scene, table, diagnostics)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(parameter_table_t), intent(inout) :: table !! its parameters, all read
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        integer :: i, row, column

        do i = 1, table%count
            if (.not. allocated(table%parameters(i)%units)) cycle
            do row = 1, table%parameters(i)%extents(1)
                do column = 1, table%parameters(i)%extents(2)
                    if (.not. allocated(table%parameters(i)%units(row, column)%text)) cycle
                    if (table%parameters(i)%units(row, column)%text == '') cycle
                    call convert_element(scene, table, table%parameters(i), row, column, diagnostics)
                end do
            end do
        end do
    end subroutine convert_named_units

    !> Converts one element.
    subroutine convert_element(scene, table, parameter, row, column, diagnostics)
        type(scene_t), intent(in) :: scene
        type(parameter_table_t), intent(in) :: table
        type(parameter_t), intent(inout) :: parameter
        integer, intent(in) :: row, column
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: name, unit, problem, of
        real(dp) :: factor
        integer :: number
        logical :: is_known

        number = column
        if (parameter%rank == 2) number = row
        associate (names => table%parameters(table%find(parameter%unit_of)), given => parameter%units(row, column)%text)
            name = trim(names%text_at(number))
            of = names%name // '(' // to_text(number) // ')'
            if (name == '') then
                call diagnostics%error(parameter%places(row, column), parameter%element_name(row, column) // &
                                       ' has a unit, but ' // of // ' is not given', 'its unit is that of ' // of)
                parameter%faulty = .true.
                return
            end if
            call find_unit_of(name, table, unit, is_known)
            if (.not. is_known) return ! The name is refused elsewhere.
            if (is_of_logarithm(scene, parameter, number)) then
                unit = ''
                name = 'the logarithm of ' // name
            end if
            call convert_unit(given, unit, factor, problem)
            if (problem /= '') then
                call diagnostics%error(parameter%places(row, column), name // ': ' // problem, units_of(unit))
                parameter%faulty = .true.
            else
                parameter%reals(row, column) = parameter%reals(row, column) * factor
                call parameter%set_unit(row, column, '')
            end if
        end associate
    end subroutine convert_element

    !> Whether a number is one of the logarithm of what varies.
    pure logical function is_of_logarithm(scene, parameter, number)
        type(scene_t), intent(in) :: scene
        type(parameter_t), intent(in) :: parameter
        integer, intent(in) :: number
        is_of_logarithm = parameter%name == 'sweep.mean' .or. parameter%name == 'sweep.deviation'
        if (is_of_logarithm) is_of_logarithm = scene%distribution(number) == 'lognormal'
    end function is_of_logarithm

    !> The unit of a number of the input, of a column of trajectories or sweeps, or of the offset or scale of a sensor.
    subroutine find_unit_of(name, table, unit, is_known)
        character(*), intent(in) :: name !! as `initial.omega3`, `theta_deg`, `offset.theta_deg`
        type(parameter_table_t), intent(in) :: table
        character(:), allocatable, intent(out) :: unit
        logical, intent(out) :: is_known
        character(*), parameter :: offset = 'offset.'
        type(chosen_column_t) :: found
        character(:), allocatable :: problem, hint
        integer :: place

        unit = ''
        is_known = .true.
        if (index(name, 'scale.') == 1) return
        place = table%find(name(:index(name // '(', '(') - 1))
        if (index(name, 'mounting(') == 1) place = table%find('fit.mounting')
        if (place > 0) then
            unit = trim(table%parameters(place)%unit)
            return
        end if
        associate (column => name(merge(len(offset), 0, index(name, offset) == 1) + 1:))
            call find_column(trajectory_columns, column, found, problem, hint)
            if (found%place == 0) call find_column(sweep_columns(), column, found, problem, hint)
        end associate
        is_known = found%place > 0
        unit = trim(found%unit)
    end subroutine find_unit_of

end module spintop_named_units
