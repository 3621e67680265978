!> Reads a namelist file, and overrides from the command line, into a table of parameters.
!>
!> The rules are those of Fortran, but stricter where Fortran accepts likely mistakes. Every group and every
!> key must be known and may occur once; a group of parts may be repeated. Only comments are allowed between
!> groups. Texts are in quotes, on one line. No value may be empty. A list is given by `key = a, b`, by elements
!> `key(2) = a` and ranges `key(2:3) = a, b`, or, if it has rows, by `key(1,:) = a, b`. All errors are collected;
!> reading continues after an error.
module spintop_namelist
    use spintop_assignment, only: assignment_t
    use spintop_completeness, only: missing_element
    use spintop_diagnostics, only: diagnostics_t, place_t
    use spintop_errors, only: error_t
    use spintop_files, only: read_file
    use spintop_foreign_characters, only: find_foreign
    use spintop_overrides, only: read_override
    use spintop_parameter, only: one_per_group, parameter_t, quoted
    use spintop_parameters, only: parameter_table_t
    use spintop_scanner, only: scanner_t, token_close, token_colon, token_comma, token_end, token_equals, &
        token_group, token_open, token_other, token_slash, token_t, token_word
    use spintop_suggestions, only: homes_of, suggest_group, suggest_key
    use spintop_table_input, only: input_of_table
    use spintop_text, only: abbreviate, lower_case, string_t, to_text
    use spintop_value_list, only: read_values, skip_values
    implicit none
    private
    public :: read_namelist

    !> Largest size of an input, bytes.
    integer, parameter :: largest_file = 1024 * 1024
    !> The same of a table.
    integer, parameter :: largest_table = 2**30 - 1

contains

    !> Reads a file and then the overrides (`group.key=value`; the last one for a key counts) into the
    !> variables of the table. Problems of the input are added to the diagnostics; an error means that the
    !> table itself is wrong. With `in_table` the file is a table of results, whose header has the input.
    subroutine read_namelist(path, overrides, table, diagnostics, error, given, in_table)
        character(*), intent(in) :: path !! path of the file, or the name of the given text
        type(string_t), intent(in) :: overrides(:) !! overrides `group.key=value`
        type(parameter_table_t), intent(inout) :: table !! the parameters of an input
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(*), intent(in), optional :: given !! the text, in place of that of a file
        logical, intent(in), optional :: in_table !! whether the input is that of a table
        type(error_t), allocatable :: unreadable
        character(:), allocatable :: text
        logical :: is_table
        integer :: i

        call table%verify(error)
        if (allocated(error)) return
        is_table = .false.
        if (present(in_table)) is_table = in_table
        if (present(given)) then
            text = given
        else
            call read_file(path, merge(largest_table, largest_file, is_table), text, unreadable, &
                           may_wait=.true., is_text=.true.)
        end if
        if (allocated(unreadable)) then
            call diagnostics%error(place_t(), unreadable%message)
            return
        end if
        if (is_table) text = input_of_table(text)
        call diagnostics%add_source(path, text, table%place%source)
        call read_groups(text, table, diagnostics)
        do i = 1, size(overrides)
            call read_override(overrides(i)%text, table, diagnostics)
        end do
        do i = 1, table%count
            call check_complete(table%parameters(i), diagnostics)
        end do
    end subroutine read_namelist

    !> The place of byte `i` of a source.
    pure type(place_t) function place_of_byte(text, i, source) result(place)
        character(*), intent(in) :: text
        integer, intent(in) :: i, source
        integer :: k
        place%source = source
        place%line = 1 + count([(text(k:k) == new_line('a'), k=1, i - 1)])
        place%column = i - index(text(:i - 1), new_line('a'), back=.true.)
    end function place_of_byte

    subroutine read_groups(text, table, diagnostics)
        character(*), intent(in) :: text
        type(parameter_table_t), intent(inout) :: table
        type(diagnostics_t), intent(inout) :: diagnostics
        type(scanner_t) :: scanner
        type(token_t) :: token
        logical :: any_group

        if (index(text, char(0)) > 0) then
            call diagnostics%error(place_of_byte(text, index(text, char(0)), table%place%source), &
                'not a text file: it has NUL bytes', 'expected a namelist in ASCII or UTF-8')
            return
        end if
        call scanner%start(text, table%place%source, comments=.true.)
        call refuse_foreign(scanner, diagnostics)
        if (diagnostics%has_errors()) return
        call scanner%start(text, table%place%source, comments=.true.)
        any_group = .false.
        call scanner%next(token)
        do while (token%kind /= token_end)
            if (token%kind == token_group) then
                any_group = .true.
                call read_group(scanner, token, table, diagnostics)
                call scanner%next(token)
            else
                call diagnostics%error(token%place, 'text outside a group', &
                    'a group is &name ... /, a comment starts with !')
                any_group = .true.
                do while (token%kind /= token_group .and. token%kind /= token_end)
                    call scanner%next(token)
                end do
            end if
        end do
        if (.not. any_group) call diagnostics%error(table%place, 'the file has no group', &
            'it should start with &' // table%groups(1)%name)
    end subroutine read_groups

    !> Reports characters that have no meaning in a namelist, the first of each line; a colon has one within parentheses.
    subroutine refuse_foreign(scanner, diagnostics)
        type(scanner_t), intent(inout) :: scanner
        type(diagnostics_t), intent(inout) :: diagnostics
        type(token_t) :: token
        character(:), allocatable :: word, hint
        integer :: line, first, width
        logical :: has_subscripts

        line = 0
        has_subscripts = .false.
        do
            call scanner%next(token)
            select case (token%kind)
            case (token_end)
                return
            case (token_open)
                has_subscripts = .true.
            case (token_close, token_slash, token_group)
                has_subscripts = .false.
            case (token_word, token_colon, token_other)
                if (token%place%line == line .or. (token%kind == token_colon .and. has_subscripts)) cycle
                word = scanner%word(token)
                call find_foreign(word, first, width, hint)
                if (first == 0) cycle
                line = token%place%line
                token%place%column = token%place%column + first - 1
                token%place%width = width
                call diagnostics%error(token%place, 'unexpected ' // quoted(word(first:first + width - 1)), hint)
            end select
        end do
    end subroutine refuse_foreign

    !> Reads a group, from the end of its name to its slash.
    subroutine read_group(scanner, start, table, diagnostics)
        type(scanner_t), intent(inout) :: scanner
        type(token_t), intent(in) :: start
        type(parameter_table_t), intent(inout) :: table
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: name, before
        type(token_t) :: token
        integer :: number

        name = scanner%word(start)
        name = lower_case(name(2:))
        call open_group(name, start%place, table, diagnostics, number)
        do
            call scanner%peek(token)
            select case (token%kind)
            case (token_end, token_group)
                if (is_legacy_end(scanner, token)) then
                    call scanner%next(token)
                    call diagnostics%error(token%place, 'a group ends with /', 'write / here')
                else
                    before = 'line ' // to_text(token%place%line)
                    if (token%kind == token_end) before = 'the end of the file'
                    call diagnostics%error(start%place, 'group &' // name // &
                        ' has no closing slash', 'a line with / is missing before ' // before)
                end if
                return
            case (token_slash)
                call scanner%next(token)
                call close_group(scanner, diagnostics)
                return
            case (token_comma)
                call scanner%next(token)
                call diagnostics%error(token%place, 'a comma without a value')
            case default
                call read_assignment(scanner, name, number, table, diagnostics)
            end select
        end do
    end subroutine read_group

    subroutine open_group(name, place, table, diagnostics, number)
        character(*), intent(in) :: name
        type(place_t), intent(in) :: place
        type(parameter_table_t), intent(inout) :: table
        type(diagnostics_t), intent(inout) :: diagnostics
        integer, intent(out) :: number !! which of the groups of this name it is; 0 if it is unknown, or one too many
        integer :: i, most

        number = 0
        i = table%find_group(name)
        if (i == 0) then
            call diagnostics%error(place, 'unknown group &' // abbreviate(name), &
                suggest_group(table, name))
            return
        end if
        most = most_groups(table, name)
        associate (group => table%groups(i))
            if (group%count < most) then
                group%count = group%count + 1
                if (group%count == 1) group%place = place
                number = group%count
            else if (most == 1) then
                call diagnostics%error(place, 'group &' // name // ' is given a second time', &
                    'first on line ' // to_text(group%place%line))
            else
                call diagnostics%error(place, 'too many groups &' // name, 'at most ' // to_text(most))
            end if
        end associate
    end subroutine open_group

    !> How often a group may occur.
    pure integer function most_groups(table, name) result(most)
        type(parameter_table_t), intent(in) :: table
        character(*), intent(in) :: name
        integer :: i
        do i = 1, table%count
            if (table%parameters(i)%group == name) exit
        end do
        most = table%parameters(i)%most_groups()
    end function most_groups

    logical function is_legacy_end(scanner, token)
        type(scanner_t), intent(in) :: scanner
        type(token_t), intent(in) :: token
        is_legacy_end = token%kind == token_group
        if (is_legacy_end) is_legacy_end = lower_case(scanner%word(token)) == '&end'
    end function is_legacy_end

    !> After the slash the line must be empty, or another group begins.
    subroutine close_group(scanner, diagnostics)
        type(scanner_t), intent(inout) :: scanner
        type(diagnostics_t), intent(inout) :: diagnostics
        type(token_t) :: token

        call scanner%peek(token)
        if (token%starts_line .or. token%kind == token_end .or. token%kind == token_group) return
        call diagnostics%error(token%place, 'text after the slash that ends the group', &
            'a comment starts with !')
        call skip_line(scanner, token_group)
    end subroutine close_group

    !> Reads `key = values`; key and values of an unknown group are skipped.
    subroutine read_assignment(scanner, group, group_number, table, diagnostics)
        type(scanner_t), intent(inout) :: scanner
        character(*), intent(in) :: group
        integer, intent(in) :: group_number !! which of the groups of this name it is; 0 if it is not to be read
        type(parameter_table_t), intent(inout) :: table
        type(diagnostics_t), intent(inout) :: diagnostics
        type(assignment_t) :: assignment
        type(token_t) :: token
        integer :: number
        logical :: has_equals

        has_equals = scanner%key_follows()
        call scanner%next(token)
        if (token%kind /= token_word) then
            call diagnostics%error(token%place, 'expected a key here', 'key = value, or / to end')
            call skip_line(scanner, token_slash)
            return
        end if
        number = 0
        if (group_number > 0) call find_key(scanner%word(token), group, token%place, table, diagnostics, number)
        if (number > 0 .and. .not. has_equals) then
            call diagnostics%error(token%place, 'no = after ' // scanner%word(token))
            table%parameters(number)%faulty = .true.
        end if
        if (number == 0 .or. .not. has_equals) then
            call skip_values(scanner, group, table)
            return
        end if
        assignment%place = token%place
        associate (parameter => table%parameters(number))
            if (parameter%elements == one_per_group) assignment%group = group_number
            call assignment%read_subscripts(parameter, scanner, diagnostics)
            do while (token%kind /= token_equals)
                call scanner%next(token)
            end do
            call assignment%begin(parameter, diagnostics)
            call read_values(scanner, group, table, parameter, assignment, diagnostics)
            call assignment%finish(parameter, diagnostics)
        end associate
    end subroutine read_assignment

    !> Finds a key of a group; 0 and an error if the group has no such key.
    subroutine find_key(word, group, place, table, diagnostics, number)
        character(*), intent(in) :: word, group
        type(place_t), intent(in) :: place
        type(parameter_table_t), intent(in) :: table
        type(diagnostics_t), intent(inout) :: diagnostics
        integer, intent(out) :: number
        character(:), allocatable :: key
        integer :: last_part

        key = lower_case(word)
        number = table%find(group // '.' // key)
        if (number > 0) return
        last_part = scan(key, '.%', back=.true.) + 1
        if (table%find(group // '.' // key(last_part:)) > 0) then
            call diagnostics%error(place, 'a key stands without its group', &
                'write ' // key(last_part:))
        else if (homes_of(table, key) /= '') then
            call diagnostics%error(place, 'key ' // quoted(key) // ' is not in group &' // group, &
                'it belongs to ' // homes_of(table, key))
        else
            call diagnostics%error(place, 'unknown key ' // quoted(abbreviate(word)) // &
                ' in group &' // group, suggest_key(table, group, key))
        end if
    end subroutine find_key

    !> Moves to the next line, or to a token of a kind before that.
    subroutine skip_line(scanner, kind)
        type(scanner_t), intent(inout) :: scanner
        integer, intent(in) :: kind
        type(token_t) :: token
        do
            call scanner%peek(token)
            if (token%starts_line .or. token%kind == kind .or. token%kind == token_end) return
            call scanner%next(token)
        end do
    end subroutine skip_line

    !> Checks that no element is missing that other elements require.
    subroutine check_complete(parameter, diagnostics)
        type(parameter_t), intent(inout) :: parameter
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: missing

        if (parameter%faulty) return
        missing = missing_element(parameter)
        if (missing == '') return
        call diagnostics%error(parameter%key_place, missing // ' is missing', 'the elements that are given require it')
        parameter%faulty = .true.
    end subroutine check_complete

end module spintop_namelist
