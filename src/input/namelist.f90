!> Reads a namelist file, and overrides from the command line, into a table of parameters.
!>
!> The rules are those of Fortran, but stricter where Fortran accepts likely mistakes. Every group and every
!> key must be known and may occur once; a group of parts may be repeated. Only comments are allowed between
!> groups. Texts are in quotes, on one line. No value may be empty. A list is given by `key = a, b`, by elements
!> `key(2) = a` and ranges `key(2:3) = a, b`, or, if it has rows, by `key(1,:) = a, b`. All errors are collected;
!> reading continues after an error.
module spintop_namelist
    use spintop_assignment, only: assignment_t, names_a_unit, reader_t
    use spintop_diagnostics, only: diagnostics_t, place_t
    use spintop_errors, only: error_t
    use spintop_files, only: read_file
    use spintop_parameter, only: one_per_group, quoted, kind_real, kind_text
    use spintop_parameters, only: missing_element, parameter_table_t
    use spintop_scanner, only: scanner_t, token_close, token_colon, token_comma, token_end, token_equals, &
        token_group, token_open, token_other, token_slash, token_t, token_word, token_string
    use spintop_suggestions, only: homes_of, refuse_group, refuse_key
    use spintop_text, only: end_of_line, lower_case, string_t, to_text
    implicit none
    private
    public :: read_namelist, read_override

    !> Quotes around texts.
    character(*), parameter :: quotes = '''"'

    character, parameter :: nl = new_line('a')
    !> Largest size of an input, bytes.
    integer, parameter :: largest_file = 1024 * 1024
    !> The same of a table.
    integer, parameter :: largest_table = 2**30 - 1

contains

    !> Reads a file and then the overrides (`group.key=value`; the last one for a key counts) into the
    !> variables of the table. Problems of the input are added to the diagnostics; an error means that the
    !> table itself is wrong. A file `NAME.csv`, or any with `in_table`, is a table of results, whose header has the input.
    subroutine read_namelist(path, overrides, table, diagnostics, error, given, in_table)
        character(*), intent(in) :: path !! path of the file, or the name of the given text
        type(string_t), intent(in) :: overrides(:) !! overrides `group.key=value`
        type(parameter_table_t), target, intent(inout) :: table !! the parameters of an input
        type(diagnostics_t), target, intent(inout) :: diagnostics !! errors with their places are added
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(*), intent(in), optional :: given !! the text, in place of that of a file
        logical, intent(in), optional :: in_table !! whether the input is that of a table
        type(error_t), allocatable :: unreadable
        type(reader_t) :: reader
        character(:), allocatable :: text, missing
        logical :: is_table
        integer :: i

        call table%verify(error)
        if (allocated(error)) return
        is_table = index(path // nl, '.csv' // nl) > 0
        if (present(in_table)) is_table = is_table .or. in_table
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
        reader%table => table
        reader%diagnostics => diagnostics
        call read_groups(reader, text)
        do i = 1, size(overrides)
            call read_override(overrides(i)%text, table, diagnostics)
        end do
        do i = 1, table%count
            associate (parameter => table%parameters(i))
                if (parameter%faulty) cycle
                missing = missing_element(parameter)
                if (missing == '') cycle
                call diagnostics%error(parameter%key_place, missing // ' is missing', &
                                       'the elements that are given require it')
                parameter%faulty = .true.
            end associate
        end do
    end subroutine read_namelist

    !> Reads all groups of a source, unless it has characters without a meaning.
    subroutine read_groups(reader, text)
        type(reader_t), intent(inout) :: reader
        character(*), intent(in) :: text
        type(token_t) :: token
        type(place_t) :: place
        logical :: any_group
        integer :: nul, k

        associate (scanner => reader%scanner, diagnostics => reader%diagnostics, source => reader%table%place%source)
            nul = index(text, char(0))
            if (nul > 0) then
                place = place_t(source, 1 + count([(text(k:k) == new_line('a'), k=1, nul - 1)]), &
                                nul - index(text(:nul - 1), new_line('a'), back=.true.))
                call diagnostics%error(place, 'not a text file: it has NUL bytes', 'expected a namelist in ASCII or UTF-8')
                return
            end if
            call scanner%start(text, source, comments=.true.)
            call refuse_foreign(scanner, diagnostics)
            if (diagnostics%has_errors()) return
            call scanner%start(text, source, comments=.true.)
            any_group = .false.
            call scanner%next(token)
            do while (token%kind /= token_end)
                any_group = .true.
                if (token%kind == token_group) then
                    call read_group(reader, token)
                    call scanner%next(token)
                else
                    call diagnostics%error(token%place, 'text outside a group', &
                                           'a group is &name ... /, a comment starts with !')
                    do while (token%kind /= token_group .and. token%kind /= token_end)
                        call scanner%next(token)
                    end do
                end if
            end do
            if (.not. any_group) call diagnostics%error(reader%table%place, 'the file has no group', &
                                                        'it should start with &' // reader%table%groups(1)%name)
        end associate
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
                found: do first = 1, len(word)
                    do width = 1, min(3, len(word) - first + 1)
                        hint = meant_by(word(first:first + width - 1))
                        if (hint /= '') exit found
                    end do
                end do found
                if (first > len(word)) cycle
                line = token%place%line
                token%place%column = token%place%column + first - 1
                token%place%width = width
                call diagnostics%error(token%place, 'unexpected ' // quoted(word(first:first + width - 1)), hint)
            end select
        end do
    end subroutine refuse_foreign

    !> Reads a group, from the end of its name to its slash.
    subroutine read_group(reader, start)
        type(reader_t), intent(inout) :: reader
        type(token_t), intent(in) :: start
        character(:), allocatable :: before
        type(token_t) :: token
        integer :: number

        before = reader%scanner%word(start)
        reader%group = lower_case(before(2:))
        call open_group(reader, start%place, number)
        associate (scanner => reader%scanner, diagnostics => reader%diagnostics)
            do
                call scanner%peek(token)
                select case (token%kind)
                case (token_end, token_group)
                    if (lower_case(scanner%word(token)) == '&end') then
                        call scanner%next(token)
                        call diagnostics%error(token%place, 'a group ends with /', 'write / here')
                    else
                        before = 'line ' // to_text(token%place%line)
                        if (token%kind == token_end) before = 'the end of the file'
                        call diagnostics%error(start%place, 'group &' // reader%group // ' has no closing slash', &
                                               'a line with / is missing before ' // before)
                    end if
                    return
                case (token_slash)
                    call scanner%next(token)
                    ! After it the line must be empty, or another group begins.
                    call scanner%peek(token)
                    if (token%starts_line .or. token%kind == token_end .or. token%kind == token_group) return
                    call diagnostics%error(token%place, 'text after the slash that ends the group', 'a comment starts with !')
                    call skip_line(scanner, token_group)
                    return
                case (token_comma)
                    call scanner%next(token)
                    call diagnostics%error(token%place, 'a comma without a value')
                case default
                    call read_assignment(reader, number)
                end select
            end do
        end associate
    end subroutine read_group

    !> Finds the group that begins, and counts it.
    subroutine open_group(reader, place, number)
        type(reader_t), intent(inout) :: reader
        type(place_t), intent(in) :: place
        integer, intent(out) :: number !! which of the groups of this name it is; 0 if it is unknown, or one too many
        integer :: i

        number = 0
        associate (name => reader%group, table => reader%table, diagnostics => reader%diagnostics)
            i = table%find_group(name)
            if (i == 0) then
                call refuse_group(table, name, place, diagnostics)
            else if (table%groups(i)%count < table%groups(i)%most) then
                number = table%groups(i)%count + 1
                table%groups(i)%count = number
                if (number == 1) table%groups(i)%place = place
            else if (table%groups(i)%most == 1) then
                call diagnostics%error(place, 'group &' // name // ' is given a second time', &
                                       'first on line ' // to_text(table%groups(i)%place%line))
            else
                call diagnostics%error(place, 'too many groups &' // name, 'at most ' // to_text(table%groups(i)%most))
            end if
        end associate
    end subroutine open_group

    !> Reads `key = values`; key and values of an unknown group are skipped.
    subroutine read_assignment(reader, group_number)
        type(reader_t), intent(inout) :: reader
        integer, intent(in) :: group_number !! which of the groups of this name it is; 0 if it is not to be read
        type(token_t) :: token
        integer :: number
        logical :: has_equals

        has_equals = reader%scanner%key_follows()
        call reader%scanner%next(token)
        if (token%kind /= token_word) then
            call reader%diagnostics%error(token%place, 'expected a key here', 'key = value, or / to end')
            call skip_line(reader%scanner, token_slash)
            return
        end if
        number = 0
        if (group_number > 0) call find_key(reader, token, number)
        if (number > 0 .and. .not. has_equals) then
            call reader%diagnostics%error(token%place, 'no = after ' // reader%scanner%word(token))
            reader%table%parameters(number)%faulty = .true.
        end if
        if (number == 0 .or. .not. has_equals) then
            do while (.not. reader%at_end_of_values(words_expected=.true.))
                call reader%scanner%next(token)
            end do
            return
        end if
        reader%parameter => reader%table%parameters(number)
        reader%now = assignment_t(token%place)
        if (reader%parameter%elements == one_per_group) reader%now%group = group_number
        call reader%read_subscripts()
        do while (token%kind /= token_equals)
            call reader%scanner%next(token)
        end do
        call reader%begin()
        call reader%read_values()
        call reader%finish()
    end subroutine read_assignment

    !> Finds a key of the group; 0 and an error if the group has no such key.
    subroutine find_key(reader, token, number)
        type(reader_t), intent(inout) :: reader
        type(token_t), intent(in) :: token !! the key
        integer, intent(out) :: number
        character(:), allocatable :: key
        integer :: last_part

        key = lower_case(reader%scanner%word(token))
        associate (group => reader%group, table => reader%table, diagnostics => reader%diagnostics)
            number = table%find(group // '.' // key)
            if (number > 0) return
            last_part = scan(key, '.%', back=.true.) + 1
            if (table%find(group // '.' // key(last_part:)) > 0) then
                call diagnostics%error(token%place, 'a key stands without its group', 'write ' // key(last_part:))
            else if (homes_of(table, key) /= '') then
                call diagnostics%error(token%place, 'key ' // quoted(key) // ' is not in group &' // group, &
                                       'it belongs to ' // homes_of(table, key))
            else
                call refuse_key(table, group, key, reader%scanner%word(token), token%place, diagnostics)
            end if
        end associate
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

    !> What to write in the place of a character; '' if it is not known.
    pure function meant_by(character) result(hint)
        character(*), intent(in) :: character
        character(:), allocatable :: hint
        integer :: bytes(3)
        integer :: i, n

        n = len(character)
        bytes = [(merge(iachar(character(min(i, n):min(i, n))), 0, i <= n), i=1, 3)]
        hint = ''
        select case (256 * (256 * bytes(1) + bytes(2)) + bytes(3))
        case (0:256**2 * 31)
            hint = 'a control character: remove it'
        case (256**2 * iachar('['), 256**2 * iachar(']'))
            hint = 'a subscript is in parentheses, as key(1)'
        case (256**2 * iachar('#'))
            hint = 'a comment starts with !'
        case (256**2 * iachar(';'))
            hint = 'values are separated by commas'
        case (256**2 * iachar(':'))
            hint = 'a key is followed by =, and a text is in quotes'
        case (256**2 * iachar('`'), int(z'C2AB00'), int(z'C2B400'), int(z'C2BB00'), int(z'E28098'):int(z'E2809F'))
            hint = 'a text is in straight quotes, as ''text'''
        case (int(z'C2A000'), int(z'E28080'):int(z'E2808B'), int(z'E280AF'), int(z'E38080'))
            hint = 'write an ordinary blank in the place of this one'
        case (int(z'E28090'):int(z'E28095'), int(z'E28892'))
            hint = 'a minus sign is -'
        end select
    end function meant_by

    !> The text of a table as an input: the lines below `# input:` without their `#`, and an empty line for each other
    !> line of the header, so that lines keep their numbers.
    pure function input_of_table(table) result(input)
        character(*), intent(in) :: table !! text of a table
        character(:), allocatable :: input
        character(*), parameter :: title = '# input:', mark = '#     '
        integer :: first, length, written
        logical :: is_input

        allocate (character(len(table)) :: input)
        written = 0
        is_input = .false.
        first = 1
        do while (first <= len(table))
            if (table(first:first) /= '#') exit
            length = end_of_line(table, first) - first + 1
            associate (line => table(first:first + length - 1))
                is_input = (is_input .and. index(line, mark) == 1) .or. line == title
                if (is_input .and. line /= title) then
                    input(written + 1:written + length) = ' ' // line(2:)
                    written = written + length
                end if
            end associate
            input(written + 1:written + 1) = new_line('a')
            written = written + 1
            first = first + length + 1
        end do
        input = input(:min(written, len(input)))
    end function input_of_table

    !> Reads one override. Quotes around a word, or a number with its unit, may be omitted, and the values of a list are
    !> separated by commas. It replaces a value from the file or from an earlier override.
    subroutine read_override(text, table, diagnostics)
        character(*), intent(in) :: text !! `group.key=value`
        type(parameter_table_t), target, intent(inout) :: table !! the parameters of an input
        type(diagnostics_t), target, intent(inout) :: diagnostics !! errors with their places are added
        type(reader_t) :: reader
        type(token_t) :: token
        character(:), allocatable :: name, group, key, rest
        integer :: source, number

        reader%table => table
        reader%diagnostics => diagnostics
        reader%group = ''
        call diagnostics%add_source('--set', text, source)
        call reader%scanner%start(text, source, comments=.false.)
        call reader%scanner%next(token)
        if (token%kind /= token_word .or. index(text, '=') == 0) then
            call diagnostics%error(token%place, 'an override is GROUP.KEY=VALUE')
            return
        end if
        name = lower_case(reader%scanner%word(token))
        number = table%find(name)
        if (number == 0) then
            group = name(:index(name // '.', '.') - 1)
            key = name(min(len(name), len(group) + 1) + 1:)
            if (table%find_group(group) > 0) then
                call refuse_key(table, group, key, key, token%place, diagnostics)
            else if (key == '' .and. homes_of(table, name) /= '') then
                call diagnostics%error(token%place, 'an override names the group too', 'it belongs to ' // homes_of(table, name))
            else
                call refuse_group(table, group, token%place, diagnostics)
            end if
            return
        end if

        reader%parameter => table%parameters(number)
        reader%now = assignment_t(token%place, quotes_optional=.true.)
        call reader%read_subscripts()
        call reader%scanner%next(token)
        if (token%kind /= token_equals) then
            call reader%refuse(token%place, 'expected an equals sign', 'an override is GROUP.KEY=VALUE')
            return
        end if
        call reader%begin()
        if (.not. reader%now%refused) call table%unset_twin(number, reader%now%row, reader%now%first, reader%now%last)
        rest = reader%scanner%rest()
        if (scan(adjustl(rest), quotes) /= 1 .and. (reader%parameter%kind == kind_text .or. &
                                                    (reader%parameter%kind == kind_real .and. names_a_unit(rest)))) then
            call read_plain_words(reader, text, len(text) - len(rest))
        else
            call reader%read_values()
            call reader%scanner%peek(token)
            if (token%kind /= token_end) call reader%refuse(token%place, 'unexpected text after the value', &
                                                            'use one --set for each GROUP.KEY=VALUE')
        end if
        call reader%finish()
    end subroutine read_override

    !> Texts without quotes around the first. In a list each ends at the next comma that is neither within parentheses, as in
    !> `theta__top.inertia_tensor(1,2)`, nor within quotes.
    subroutine read_plain_words(reader, text, start)
        type(reader_t), intent(inout) :: reader
        character(*), intent(in) :: text
        integer, intent(in) :: start !! number of bytes before the words
        type(scanner_t) :: scanner
        type(token_t) :: token, found
        character(:), allocatable :: word
        integer :: first, last

        last = start
        if (text(start + 1:) == '') return
        do while (last < len(text))
            first = last + 1
            last = len(text) + 1
            if (reader%parameter%rank > 0) last = end_of_word(text, first)
            word = trim(adjustl(text(first:last - 1)))
            token%kind = token_word
            token%closed = .true.
            token%place = reader%now%place
            token%place%column = first + verify(text(first:last - 1) // '.', ' ') - 1
            token%place%width = len(word)
            if (reader%parameter%rank > 0 .and. scan(word, quotes) == 1) then
                call scanner%start(word, token%place%source, comments=.false.)
                call scanner%next(found)
                if (found%last < len(word)) then
                    call reader%refuse(token%place, 'text after the closing quote')
                    return
                end if
                token%kind = token_string
                token%closed = found%closed
                word = scanner%string(found)
            end if
            call reader%store_values(token, word, 1)
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

end module spintop_namelist
