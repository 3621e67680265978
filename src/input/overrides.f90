!> Overrides from the command line: `group.key=value`, with the checks of a namelist file.
module spintop_overrides
    use spintop_assignment, only: assignment_t
    use spintop_diagnostics, only: diagnostics_t
    use spintop_parameter, only: kind_real, kind_text, parameter_t, quoted
    use spintop_parameters, only: parameter_table_t
    use spintop_quantity_text, only: names_a_unit
    use spintop_scanner, only: scanner_t, token_end, token_equals, token_string, token_t, token_word
    use spintop_suggestions, only: homes_of, suggest_group, suggest_key
    use spintop_text, only: abbreviate, lower_case
    use spintop_value_list, only: read_values
    implicit none
    private
    public :: read_override

    !> Quotes around texts.
    character(*), parameter :: quotes = '''"'

contains

    !> Reads one override. Quotes around a word, or a number with its unit, may be omitted, and the values of a list are
    !> separated by commas. It replaces a value from the file or from an earlier override.
    subroutine read_override(text, table, diagnostics)
        character(*), intent(in) :: text !! `group.key=value`
        type(parameter_table_t), intent(inout) :: table !! the parameters of an input
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scanner_t) :: scanner
        type(assignment_t) :: assignment
        type(token_t) :: token
        character(:), allocatable :: rest
        integer :: source, number

        call diagnostics%add_source('--set', text, source)
        call scanner%start(text, source, comments=.false.)
        call scanner%next(token)
        if (token%kind /= token_word .or. index(text, '=') == 0) then
            call diagnostics%error(token%place, 'an override is GROUP.KEY=VALUE')
            return
        end if
        call find_parameter(lower_case(scanner%word(token)), token, table, diagnostics, number)
        if (number == 0) return

        assignment%place = token%place
        assignment%quotes_optional = .true.
        associate (parameter => table%parameters(number))
            call assignment%read_subscripts(parameter, scanner, diagnostics)
            call scanner%next(token)
            if (token%kind /= token_equals) then
                call assignment%refuse(parameter, diagnostics, token%place, &
                    'expected an equals sign', 'an override is GROUP.KEY=VALUE')
                return
            end if
            call assignment%begin(parameter, diagnostics)
            rest = scanner%rest()
            if (scan(adjustl(rest), quotes) /= 1 .and. (parameter%kind == kind_text .or. &
                                                        (parameter%kind == kind_real .and. names_a_unit(rest)))) then
                call read_plain_words(text, len(text) - len(rest), parameter, assignment, diagnostics)
            else
                call read_values(scanner, '', table, parameter, assignment, diagnostics)
                call scanner%peek(token)
                if (token%kind /= token_end) call assignment%refuse(parameter, diagnostics, token%place, &
                    'unexpected text after the value', 'use one --set for each GROUP.KEY=VALUE')
            end if
            call assignment%finish(parameter, diagnostics)
        end associate
    end subroutine read_override

    subroutine find_parameter(name, token, table, diagnostics, number)
        character(*), intent(in) :: name
        type(token_t), intent(in) :: token
        type(parameter_table_t), intent(in) :: table
        type(diagnostics_t), intent(inout) :: diagnostics
        integer, intent(out) :: number
        character(:), allocatable :: group, key

        number = table%find(name)
        if (number > 0) return
        group = name(:index(name // '.', '.') - 1)
        key = name(min(len(name), len(group) + 1) + 1:)
        if (table%find_group(group) > 0) then
            call diagnostics%error(token%place, 'unknown key ' // quoted(abbreviate(key)) // &
                ' in group &' // group, suggest_key(table, group, key))
        else if (key == '' .and. homes_of(table, name) /= '') then
            call diagnostics%error(token%place, 'an override names the group too', &
                'it belongs to ' // homes_of(table, name))
        else
            call diagnostics%error(token%place, 'unknown group &' // abbreviate(group), &
                suggest_group(table, group))
        end if
    end subroutine find_parameter

    !> Texts without quotes around the first. In a list each ends at the next comma that is neither within parentheses, as in
    !> `theta__top.inertia_tensor(1,2)`, nor within quotes.
    subroutine read_plain_words(text, start, parameter, assignment, diagnostics)
        character(*), intent(in) :: text
        integer, intent(in) :: start !! number of bytes before the words
        type(parameter_t), intent(inout) :: parameter
        type(assignment_t), intent(inout) :: assignment
        type(diagnostics_t), intent(inout) :: diagnostics
        type(token_t) :: token
        character(:), allocatable :: word
        integer :: first, last

        last = start
        if (text(start + 1:) == '') return
        do while (last < len(text))
            first = last + 1
            last = len(text) + 1
            if (parameter%rank > 0) last = end_of_word(text, first)
            word = trim(adjustl(text(first:last - 1)))
            token%kind = token_word
            token%closed = .true.
            token%place = assignment%place
            token%place%column = first + verify(text(first:last - 1) // '.', ' ') - 1
            token%place%width = len(word)
            if (parameter%rank > 0 .and. scan(word, quotes) == 1) then
                call remove_quotes(word, token)
                if (token%kind /= token_string) then
                    call assignment%refuse(parameter, diagnostics, token%place, 'text after the closing quote')
                    return
                end if
            end if
            call assignment%store_values(parameter, token, word, 1, diagnostics)
        end do
    end subroutine read_plain_words

    !> The place of the comma after the text that begins at `first`, or one after the end.
    pure integer function end_of_word(text, first) result(last)
        character(*), intent(in) :: text
        integer, intent(in) :: first
        character :: here, quote
        integer :: begin, depth, i
        logical :: in_quotes

        last = len(text) + 1
        begin = first + verify(text(first:) // '.', ' ') - 1
        if (begin > len(text)) return
        quote = text(begin:begin)
        in_quotes = .false.
        depth = 0
        do i = begin, len(text)
            here = text(i:i)
            if (here == quote .and. scan(quote, quotes) == 1) then
                ! A doubled quote ends the text in quotes, and begins it again.
                in_quotes = .not. in_quotes
            else if (.not. in_quotes) then
                if (here == '(') depth = depth + 1
                if (here == ')') depth = max(depth - 1, 0)
                if (here == ',' .and. depth == 0) last = i
            end if
            if (last <= len(text)) return
        end do
    end function end_of_word

    !> Removes the quotes around a word, which begins with one; the token becomes a string unless text follows.
    subroutine remove_quotes(word, token)
        character(:), allocatable, intent(inout) :: word
        type(token_t), intent(inout) :: token
        type(scanner_t) :: scanner
        type(token_t) :: found
        call scanner%start(word, token%place%source, comments=.false.)
        call scanner%next(found)
        if (found%last < len(word)) return
        token%kind = token_string
        token%closed = found%closed
        word = scanner%string(found)
    end subroutine remove_quotes

end module spintop_overrides
