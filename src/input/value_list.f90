!> The values after an equals sign.
module spintop_value_list
    use spintop_assignment, only: assignment_t
    use spintop_diagnostics, only: diagnostics_t
    use spintop_literals, only: read_integer
    use spintop_parameter, only: kind_text, parameter_t, quoted
    use spintop_parameters, only: parameter_table_t
    use spintop_scanner, only: scanner_t, token_comma, token_end, token_group, token_slash, &
        token_string, token_t, token_word
    use spintop_text, only: abbreviate, lower_case
    implicit none
    private
    public :: read_values, skip_values

contains

    !> Reads the values after an equals sign into the parameter.
    subroutine read_values(scanner, group, table, parameter, assignment, diagnostics)
        type(scanner_t), intent(inout) :: scanner !! the scanner, after the equals sign
        character(*), intent(in) :: group !! name of the group that has the key
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(parameter_t), intent(inout) :: parameter !! the parameter
        type(assignment_t), intent(inout) :: assignment !! the assignment
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(token_t) :: token
        logical :: after_value

        after_value = .false.
        do
            if (at_end_of_values(scanner, group, table, parameter%kind == kind_text)) return
            call scanner%next(token)
            select case (token%kind)
            case (token_word)
                call read_word(scanner, token, parameter, assignment, diagnostics)
            case (token_string)
                call assignment%store_values(parameter, token, scanner%string(token), 1, diagnostics)
            case (token_comma)
                if (.not. after_value) call assignment%refuse(parameter, diagnostics, &
                    token%place, 'no value before the comma')
            case (token_slash)
                call assignment%refuse(parameter, diagnostics, token%place, &
                    'a slash inside a value', 'a number, not an expression; a text in quotes')
            case default
                call assignment%refuse(parameter, diagnostics, token%place, &
                    'unexpected ' // quoted(scanner%word(token)))
            end select
            after_value = token%kind /= token_comma
        end do
    end subroutine read_values

    !> Reads a value without quotes, or a repeated one: `3*0.0`, `2*'ode45'`.
    subroutine read_word(scanner, token, parameter, assignment, diagnostics)
        type(scanner_t), intent(inout) :: scanner
        type(token_t), intent(inout) :: token
        type(parameter_t), intent(inout) :: parameter
        type(assignment_t), intent(inout) :: assignment
        type(diagnostics_t), intent(inout) :: diagnostics
        type(token_t) :: after
        character(:), allocatable :: word, problem, hint
        integer :: star, repeats

        word = scanner%word(token)
        star = index(word, '*')
        if (star < 2 .or. verify(word(:max(0, star - 1)), '0123456789') > 0) then
            call assignment%store_values(parameter, token, word, 1, diagnostics)
            return
        end if
        call read_integer(word(:star - 1), repeats, problem, hint)
        call scanner%peek(after)
        if (problem /= '' .or. repeats == 0) then
            call assignment%refuse(parameter, diagnostics, token%place, 'bad repeat count')
        else if (star < len(word)) then
            call assignment%store_values(parameter, token, word(star + 1:), repeats, diagnostics)
        else if (after%kind == token_string .and. after%touches) then
            call scanner%next(token)
            call assignment%store_values(parameter, token, scanner%string(token), repeats, diagnostics)
        else
            call assignment%refuse(parameter, diagnostics, token%place, &
                'no value after ' // abbreviate(word))
        end if
    end subroutine read_word

    !> Skips values of an unknown key.
    subroutine skip_values(scanner, group, table)
        type(scanner_t), intent(inout) :: scanner !! the scanner, after the equals sign
        character(*), intent(in) :: group !! name of the group that has the key
        type(parameter_table_t), intent(in) :: table !! the parameters of an input
        type(token_t) :: token
        do while (.not. at_end_of_values(scanner, group, table, .true.))
            call scanner%next(token)
        end do
    end subroutine skip_values

    !> Whether the values of an assignment end here: at the end of the group, at the next `key =`, or at a
    !> name at the beginning of a line that cannot be a value (its equals sign is missing).
    logical function at_end_of_values(scanner, group, table, words_expected) result(at_end)
        type(scanner_t), intent(inout) :: scanner
        character(*), intent(in) :: group
        type(parameter_table_t), intent(in) :: table
        logical, intent(in) :: words_expected
        type(token_t) :: token

        at_end = .false.
        call scanner%peek(token)
        select case (token%kind)
        case (token_end, token_group)
            at_end = .true.
        case (token_slash)
            at_end = .not. scanner%is_inside_word()
        case (token_word)
            at_end = scanner%key_follows()
            if (at_end .or. .not. token%starts_line .or. .not. scanner%is_name(token)) return
            select case (lower_case(scanner%word(token)))
            case ('t', 'f', 'true', 'false', 'nan', 'inf', 'infinity')
                at_end = .false.
            case default
                at_end = .not. words_expected .or. &
                    table%find(group // '.' // lower_case(scanner%word(token))) > 0
            end select
        end select
    end function at_end_of_values

end module spintop_value_list
