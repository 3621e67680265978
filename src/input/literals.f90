!> Values as they are written in a namelist, with what is wrong with those that cannot be read.
module spintop_literals
    use spintop_compare, only: is_equal
    use spintop_kinds, only: dp
    use spintop_text, only: abbreviate, lower_case, to_text
    implicit none
    private
    public :: read_real, read_integer, read_logical

    character(*), parameter :: digits = '0123456789'

contains

    !> Reads a real as Fortran writes it: `1`, `-.5`, `2e-3`, `2d-3`.
    subroutine read_real(text, value, problem, hint)
        character(*), intent(in) :: text
        real(dp), intent(out) :: value
        character(:), allocatable, intent(out) :: problem !! what is wrong, or ''
        character(:), allocatable, intent(out) :: hint    !! what would be right, or ''
        character(:), allocatable :: lower
        integer :: exponent, status

        value = 0
        problem = ''
        hint = ''
        lower = lower_case(text)
        exponent = scan(lower // 'e', 'edq')
        if (.not. is_mantissa(lower(:exponent - 1)) .or. .not. is_exponent(lower(exponent:))) then
            problem = 'not a number: ' // abbreviate(text)
            if (is_infinite_or_nan(lower)) then
                hint = 'it must be finite'
            else if (index(lower, '_') > 0) then
                hint = 'a kind suffix is not allowed'
            else if (verify(lower, digits // '+-.*/^()epid') == 0) then
                hint = 'a number, not an expression'
            else
                hint = 'expected a number such as 1.5 or 2e-3'
            end if
            return
        end if
        if (exponent <= len(lower)) lower(exponent:exponent) = 'e'
        read (lower, *, iostat=status) value
        ! The largest number itself stands for "not given".
        if (status /= 0 .or. abs(value) >= huge(value)) then
            problem = 'the number ' // abbreviate(text) // ' is too large'
            hint = 'its magnitude must be below 1.79e308'
        else if (abs(value) < tiny(value) .and. scan(lower(:exponent - 1), '123456789') > 0) then
            problem = 'the number ' // abbreviate(text) // ' is too small'
            hint = 'its magnitude must be 0 or above 2.23e-308'
        end if
    end subroutine read_real

    !> Reads an integer.
    subroutine read_integer(text, value, problem, hint)
        character(*), intent(in) :: text
        integer, intent(out) :: value
        character(:), allocatable, intent(out) :: problem, hint
        character(:), allocatable :: real_problem
        real(dp) :: number

        value = 0
        problem = ''
        call read_real(text, number, real_problem, hint)
        if (verify(text, digits // '+-') > 0 .or. real_problem /= '') then
            problem = 'not an integer: ' // abbreviate(text)
            hint = 'expected a whole number'
            if (real_problem == '' .and. is_equal(number, anint(number)) .and. &
                abs(number) < huge(1)) hint = 'a whole number is written ' // to_text(nint(number))
        else if (abs(number) >= huge(1)) then
            problem = 'the integer ' // abbreviate(text) // ' is too large'
            hint = 'its magnitude must be below ' // to_text(huge(1))
        else
            value = nint(number)
        end if
    end subroutine read_integer

    !> Reads a logical: `.true.`, `.false.`, `true`, `false`, `t`, `f`, `.t.`, `.f.`.
    subroutine read_logical(text, value, problem, hint)
        character(*), intent(in) :: text
        logical, intent(out) :: value
        character(:), allocatable, intent(out) :: problem, hint

        problem = ''
        hint = ''
        value = .false.
        select case (lower_case(text))
        case ('.true.', 'true', 't', '.t.')
            value = .true.
        case ('.false.', 'false', 'f', '.f.')
            value = .false.
        case default
            problem = 'neither true nor false: ' // abbreviate(text)
            hint = 'expected .true. or .false.'
        end select
    end subroutine read_logical

    !> `1`, `-1.`, `+.5`
    pure logical function is_mantissa(text)
        character(*), intent(in) :: text
        integer :: first, point
        first = verify(text(:min(1, len(text))) // '0', '+-')
        point = index(text // '.', '.')
        is_mantissa = scan(text, digits) > 0 .and. first <= point
        if (is_mantissa) is_mantissa = verify(text(first:point - 1), digits) == 0 .and. &
            verify(text(point + 1:), digits) == 0
    end function is_mantissa

    !> Nothing, or `e-3`
    pure logical function is_exponent(text)
        character(*), intent(in) :: text
        integer :: first
        is_exponent = len(text) == 0
        if (is_exponent) return
        first = 1 + verify(text(2:min(2, len(text))) // '0', '+-')
        is_exponent = first <= len(text) .and. verify(text(first:), digits) == 0
    end function is_exponent

    pure logical function is_infinite_or_nan(lower)
        character(*), intent(in) :: lower
        integer :: first
        first = verify(lower(:min(1, len(lower))) // '0', '+-')
        is_infinite_or_nan = index(lower(first:), 'nan') == 1 .or. index(lower(first:), 'inf') == 1
    end function is_infinite_or_nan

end module spintop_literals
