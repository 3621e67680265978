!> Values as they are written in a namelist, with a description of the error if they are not valid.
module spintop_literals
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_equal
    use spintop_text, only: abbreviate, lower_case, to_text
    implicit none
    private
    public :: read_real, read_integer, read_long, read_logical, read_subscript, is_real_literal, is_number_cell

    character(*), parameter :: digits = '0123456789'
    !> Integers of so many binary digits are exact as reals.
    integer, parameter :: digits_of_real = 53

contains

    !> Reads a real as Fortran writes it: `1`, `-.5`, `2e-3`, `2d-3`.
    subroutine read_real(text, value, problem, hint)
        character(*), intent(in) :: text !! the literal
        real(dp), intent(out) :: value !! the value, if there is no problem
        character(:), allocatable, intent(out) :: problem !! what is wrong, or ''
        character(:), allocatable, intent(out) :: hint    !! what would be right, or ''
        character(:), allocatable :: lower
        integer :: exponent, status

        value = 0
        problem = ''
        hint = ''
        lower = lower_case(text)
        exponent = scan(lower // 'e', 'edq')
        if (.not. is_real_literal(text)) then
            problem = 'not a number: ' // abbreviate(text)
            if (index(without_sign(lower), 'nan') == 1 .or. index(without_sign(lower), 'inf') == 1) then
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
        ! The largest number itself means "not given".
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
        character(*), intent(in) :: text !! the literal
        integer, intent(out) :: value !! the value, if there is no problem
        character(:), allocatable, intent(out) :: problem, hint
            !! what is wrong, and what is expected; '' without an error
        integer(int64) :: long
        call read_long(text, long, problem, hint, int(huge(1), int64))
        value = int(long)
    end subroutine read_integer

    !> Reads an integer of 64 bits that is also an exact real.
    subroutine read_long(text, value, problem, hint, least_too_large)
        character(*), intent(in) :: text !! the literal
        integer(int64), intent(out) :: value !! the value, if there is no problem
        character(:), allocatable, intent(out) :: problem, hint
            !! what is wrong, and what is expected; '' without an error
        integer(int64), intent(in), optional :: least_too_large !! a smaller magnitude that is too large, below 2**53
        character(:), allocatable :: real_problem
        integer(int64) :: limit
        real(dp) :: number

        limit = 2_int64**digits_of_real
        if (present(least_too_large)) limit = least_too_large
        value = 0
        problem = ''
        call read_real(text, number, real_problem, hint)
        if (verify(text, digits // '+-') > 0 .or. real_problem /= '') then
            problem = 'not an integer: ' // abbreviate(text)
            hint = 'expected a whole number'
            if (real_problem == '' .and. is_equal(number, anint(number)) .and. &
                abs(number) < limit) hint = 'a whole number is written ' // to_text(nint(number, int64))
        else if (abs(number) >= limit) then
            problem = 'the integer ' // abbreviate(text) // ' is too large'
            hint = 'its magnitude must be below ' // to_text(limit)
        else
            value = nint(number, int64)
        end if
    end subroutine read_long

    !> Reads a subscript: a positive number of at most nine digits; 0 if it is none.
    pure subroutine read_subscript(text, value)
        character(*), intent(in) :: text !! the literal
        integer, intent(out) :: value !! the subscript; 0 if the text is none
        value = 0
        if (text == '' .or. len(text) > 9 .or. verify(text, digits) > 0) return
        read (text, '(i9)') value
    end subroutine read_subscript

    !> Reads a logical: `.true.`, `.false.`, `true`, `false`, `t`, `f`, `.t.`, `.f.`.
    subroutine read_logical(text, value, problem, hint)
        character(*), intent(in) :: text !! the literal
        logical, intent(out) :: value !! the value, if there is no problem
        character(:), allocatable, intent(out) :: problem, hint
            !! what is wrong, and what is expected; '' without an error

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

    !> Whether a text has the form of a real, whatever its magnitude: `1`, `-1.`, `+.5`, `1e-3`.
    pure logical function is_real_literal(text)
        character(*), intent(in) :: text !! the literal
        character(:), allocatable :: lower, mantissa
        integer :: exponent
        lower = lower_case(text)
        exponent = scan(lower // 'e', 'edq')
        mantissa = without_sign(lower(:exponent - 1))
        is_real_literal = scan(mantissa, digits) > 0 .and. verify(mantissa, digits // '.') == 0 .and. &
            index(mantissa, '.') == index(mantissa, '.', back=.true.)
        if (exponent > len(lower)) return
        is_real_literal = is_real_literal .and. len(without_sign(lower(exponent + 1:))) > 0 .and. &
            verify(without_sign(lower(exponent + 1:)), digits) == 0
    end function is_real_literal

    !> Whether the cell of a table is a number; `nan` and `inf` are, as tables contain them.
    pure logical function is_number_cell(text)
        character(*), intent(in) :: text !! the cell
        is_number_cell = is_real_literal(text) .or. any(lower_case(text) == [character(4) :: 'nan', 'inf', '+inf', '-inf'])
    end function is_number_cell

    !> A text without the sign at its beginning.
    pure function without_sign(text) result(rest)
        character(*), intent(in) :: text
        character(:), allocatable :: rest
        rest = text(verify(text(:min(1, len(text))) // '0', '+-'):)
    end function without_sign

end module spintop_literals
