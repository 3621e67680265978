!> Numbers with a unit in an input, as '20 deg'.
module spintop_quantity_text
    use spintop_kinds, only: dp
    use spintop_literals, only: is_real_literal, read_real
    use spintop_parameter, only: parameter_t, quoted
    use spintop_text, only: abbreviate
    use spintop_units, only: convert_unit, units_of
    implicit none
    private
    public :: read_quantity, names_a_unit, has_unit

contains

    !> Whether any of the values of a list, which are separated by commas, has a unit.
    pure logical function names_a_unit(text)
        character(*), intent(in) :: text !! the values
        integer :: first, last
        names_a_unit = .false.
        first = 1
        do while (first <= len(text) .and. .not. names_a_unit)
            last = first + index(text(first:) // ',', ',') - 2
            names_a_unit = has_unit(text(first:last))
            first = last + 2
        end do
    end function names_a_unit

    !> Whether a text is a number and a unit.
    pure logical function has_unit(text)
        character(*), intent(in) :: text !! any text
        character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'
        character(:), allocatable :: unit
        integer :: last
        unit = adjustl(text)
        last = length_of_number(unit)
        unit = trim(adjustl(unit(last + 1:)))
        has_unit = last > 0 .and. (scan(unit, letters) == 1 .or. index(unit, '1/') == 1) .and. index(unit, '=') == 0
    end function has_unit

    !> Length of the longest number with which a text begins; 0 if there is none.
    pure integer function length_of_number(text) result(last)
        character(*), intent(in) :: text
        integer, parameter :: longest = 64
        do last = min(len(text), longest), 1, -1
            if (is_real_literal(text(:last))) return
        end do
    end function length_of_number

    !> Reads a number with its unit, in the unit of its key; without one it is none.
    subroutine read_quantity(parameter, text, number, unit, problem, hint)
        type(parameter_t), intent(in) :: parameter !! the key
        character(*), intent(in) :: text !! without quotes
        real(dp), intent(out) :: number !! in the unit of the key, or in its own if that is not known yet
        character(:), allocatable, intent(out) :: unit !! its unit, if that of the key is not known yet, or ''
        character(:), allocatable, intent(out) :: problem, hint !! what is wrong, and what is expected; '' without an error
        real(dp) :: factor
        integer :: last

        unit = ''
        last = length_of_number(text)
        if (last == 0 .or. last == len(text)) then
            problem = quoted(abbreviate(text)) // ' is not a valid value for ' // parameter%key
            hint = 'expected a value without quotes'
            if (parameter%unit_of /= '') hint = hint // ', or one with a unit, as ' // quoted('20 deg')
            if (parameter%unit /= '') hint = hint // ', or one with a unit, as ' // quoted('1 ' // trim(parameter%unit))
            number = 0
            return
        end if
        call read_real(text(:last), number, problem, hint)
        if (problem /= '') return
        if (verify(text(last + 1:), ', ') > 0 .and. scan(text(last + 1:), ',') == 1) then
            problem = 'a comma in the number ' // quoted(abbreviate(text))
            hint = 'decimals follow a point, as in 25.5'
            return
        end if
        if (parameter%unit_of /= '') then
            unit = trim(adjustl(text(last + 1:)))
            return
        end if
        call convert_unit(text(last + 1:), trim(parameter%unit), factor, problem)
        if (problem /= '') hint = units_of(trim(parameter%unit))
        number = number * factor
    end subroutine read_quantity

end module spintop_quantity_text
