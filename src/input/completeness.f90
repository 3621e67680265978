!> Which elements of a parameter are missing: others that have values require them.
module spintop_completeness
    use spintop_parameter, only: all_elements, leading_elements, one_per_group, parameter_t
    use spintop_parameters, only: parameter_table_t
    use spintop_text, only: string_t
    implicit none
    private
    public :: missing_element, find_missing_beside

contains

    !> Name of the first element that the others require, without the group; '' if none is missing.
    function missing_element(parameter, filled) result(name)
        type(parameter_t), intent(in) :: parameter !! a parameter of an input
        logical, intent(in), optional :: filled(:, :) !! its elements that get their values elsewhere, by row and column
        character(:), allocatable :: name
        logical :: has_value(parameter%extents(1), parameter%extents(2))
        logical :: concerned
        integer :: row, column, needed

        name = ''
        concerned = parameter%is_given()
        has_value = reshape([((parameter%is_set(row, column), row=1, parameter%extents(1)), column=1, parameter%extents(2))], &
                            shape(has_value))
        if (present(filled)) then
            concerned = concerned .or. any(filled)
            has_value = has_value .or. filled
        end if
        if (.not. concerned) return
        do row = 1, parameter%extents(1)
            needed = 0
            if (parameter%elements == all_elements) needed = parameter%extents(2)
            if (parameter%elements == one_per_group .and. parameter%rank == 2 .and. any(has_value(row, :))) then
                needed = parameter%extents(2)
            end if
            if (parameter%elements == leading_elements) needed = findloc(has_value(row, :), .true., dim=1, back=.true.)
            column = findloc(has_value(row, :needed), .false., dim=1)
            if (column == 0) cycle
            name = parameter%element_name(row, column)
            return
        end do
    end function missing_element

    !> Finds the first element that is missing beside those that get their values elsewhere, as the axes of a sweep give
    !> them.
    subroutine find_missing_beside(table, names, missing, given)
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(string_t), intent(in) :: names(:) !! the elements with values from elsewhere, as `top.inertia(2)`; all are known
        character(:), allocatable, intent(out) :: missing !! its full name; '' if none is missing
        integer, intent(out) :: given !! which of `names` requires it; 0 if none is missing
        character(:), allocatable :: problem
        integer :: at(3, size(names)), i

        do i = 1, size(names)
            call table%locate(names(i)%text, at(1, i), at(2, i), at(3, i), problem)
        end do
        given = 0
        missing = ''
        do i = 1, size(names)
            missing = missing_in(table%parameters(at(1, i)), at(2:, :), at(1, :) == at(1, i))
            if (missing == '') cycle
            given = i
            missing = table%parameters(at(1, i))%group // '.' // missing
            return
        end do
    end subroutine find_missing_beside

    !> What is missing in a parameter of which some elements get their values elsewhere.
    function missing_in(parameter, places, is_here) result(missing)
        type(parameter_t), intent(in) :: parameter
        integer, intent(in) :: places(:, :) !! row and column of elements
        logical, intent(in) :: is_here(:) !! which of them are of this parameter
        character(:), allocatable :: missing
        logical :: filled(parameter%extents(1), parameter%extents(2))
        integer :: i

        filled = .false.
        do i = 1, size(is_here)
            if (is_here(i)) filled(places(1, i), places(2, i)) = .true.
        end do
        missing = missing_element(parameter, filled)
    end function missing_in

end module spintop_completeness
