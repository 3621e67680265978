!> Words, numbers, lists of words and of lines as text; and texts that are safe on a terminal or fit into one line.
module spintop_text
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_long_long
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    implicit none
    private
    public :: string_t, append, lower_case, nearest_word, did_you_mean, join, split, to_text, counted, replace_all, abbreviate
    public :: strings_of, end_of_line, append_words, append_wrapped, line_width, wrapped, characters, default_width
    public :: write_reals, write_integer, fixed_text, real_width
    public :: visible, escaped, is_plain

    !> Width of a text that is not written to a terminal, in columns; lines of lists are broken before a smaller one.
    integer, parameter :: default_width = 100, line_width = 96
    !> Minimum number of columns for words beside an indentation.
    integer, parameter :: least_room = 24
    !> Maximum number of characters of a real number.
    integer, parameter :: real_width = 24

    !> A text of any length, as an element of a list.
    type :: string_t
        character(:), allocatable :: text !! as long as it has characters
    end type string_t

    !> A number as text: a real in the shortest form that gives the same bits when it is read (`nan`, `inf`,
    !> `-inf` if it is not finite), an integer without blanks.
    interface to_text
        procedure real_to_text, integer_to_text, long_integer_to_text
    end interface to_text

    !> `join(words, separator)`: the words as one text.
    interface join
        procedure join_strings, join_words
    end interface join

    !> `did_you_mean(word, candidates)`: "did you mean 'mass'?", or '' if no candidate is similar.
    interface did_you_mean
        procedure did_you_mean_string, did_you_mean_word
    end interface did_you_mean

    interface
        !> Writes an integer to the start of a text of `real_width` characters or more; the number of characters written.
        integer(c_int) function write_integer(value, text, capacity) bind(C, name='spintop_integer_to_text')
            import :: c_char, c_int, c_long_long
            integer(c_long_long), value :: value !! the integer to write
            character(c_char), intent(inout) :: text(*) !! the digits are at its beginning
            integer(c_int), value :: capacity !! length of the text
        end function write_integer

        !> Writes numbers, separated by commas, to the start of a text with room for `(real_width + 1)*count` characters; the
        !> number of characters written. This is the fast way to make a row of a table.
        integer(c_int) function write_reals(values, count, text, capacity) bind(C, name='spintop_reals_to_text')
            import :: c_char, c_double, c_int
            real(c_double), intent(in) :: values(*) !! numbers
            integer(c_int), value :: count, capacity !! how many there are; length of the text
            character(c_char), intent(inout) :: text(*) !! the numbers are at its beginning
        end function write_reals
    end interface

contains

    !> A number of things in words: `1 case`, `2 cases`.
    pure function counted(number, one, many) result(text)
        integer, intent(in) :: number !! of the things
        character(*), intent(in) :: one !! what one of them is called
        character(*), intent(in), optional :: many !! what more of them are called (`one` with an s)
        character(:), allocatable :: text
        text = to_text(number) // ' ' // one
        if (number == 1) return
        text = text // 's'
        if (present(many)) text = to_text(number) // ' ' // many
    end function counted

    !> The text with ASCII capital letters in lower case.
    pure function lower_case(text) result(lower)
        character(*), intent(in) :: text !! a text; letters beyond ASCII stay
        character(len(text)) :: lower
        integer :: i
        lower = text
        do i = 1, len(text)
            if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') lower(i:i) = achar(iachar(text(i:i)) + 32)
        end do
    end function lower_case

    !> The candidate that is most similar to the word, or '' if none is: at most a third of its letters (at
    !> least one) may be inserted, omitted, changed or exchanged.
    pure function nearest_word(word, candidates) result(best)
        character(*), intent(in) :: word !! the word that was written
        type(string_t), intent(in) :: candidates(:) !! possible words
        character(:), allocatable :: best
        integer :: i, found, least

        best = ''
        ! Much longer than any name: nothing is similar, and the comparison would be slow.
        if (len_trim(word) > 100) return
        least = max(1, (len_trim(word) + 1) / 3) + 1
        do i = 1, size(candidates)
            if (abs(len_trim(word) - len(candidates(i)%text)) >= least) cycle
            found = edit_distance(lower_case(trim(word)), lower_case(candidates(i)%text))
            if (found < least .and. found < len(candidates(i)%text)) then
                least = found
                best = candidates(i)%text
            end if
        end do
    end function nearest_word

    !> The question for the most similar of texts.
    pure function did_you_mean_string(word, candidates) result(question)
        character(*), intent(in) :: word !! the word that was written
        type(string_t), intent(in) :: candidates(:) !! possible words
        character(:), allocatable :: question
        question = nearest_word(word, candidates)
        if (question /= '') question = "did you mean '" // question // "'?"
    end function did_you_mean_string

    !> The question for the most similar of words of one length.
    pure function did_you_mean_word(word, candidates) result(question)
        character(*), intent(in) :: word, candidates(:) !! the word; possible words
        character(:), allocatable :: question
        question = did_you_mean_string(word, strings_of(candidates))
    end function did_you_mean_word

    !> Damerau-Levenshtein distance (optimal string alignment: no part is edited twice).
    pure integer function edit_distance(a, b) result(distance)
        character(*), intent(in) :: a, b
        integer :: table(-1:len(a), -1:len(b))
        integer :: i, j
        logical :: swapped

        ! The extra row and column keep the look-up for a transposition inside the table.
        table = len(a) + len(b)
        table(0:, 0) = [(i, i=0, len(a))]
        table(0, 0:) = [(j, j=0, len(b))]
        do j = 1, len(b)
            do i = 1, len(a)
                table(i, j) = min(table(i - 1, j) + 1, table(i, j - 1) + 1, &
                    table(i - 1, j - 1) + merge(0, 1, a(i:i) == b(j:j)))
                swapped = a(i:i) == b(max(1, j - 1):max(1, j - 1)) .and. &
                    a(max(1, i - 1):max(1, i - 1)) == b(j:j)
                if (swapped) table(i, j) = min(table(i, j), table(i - 2, j - 2) + 1)
            end do
        end do
        distance = table(len(a), len(b))
    end function edit_distance

    !> Joins texts of any length.
    pure function join_strings(words, separator) result(text)
        type(string_t), intent(in) :: words(:) !! the words
        character(*), intent(in) :: separator !! text between two parts
        character(:), allocatable :: text
        integer :: i, last

        last = max(0, size(words) - 1) * len(separator) + sum([(len(words(i)%text), i=1, size(words))])
        allocate (character(last) :: text)
        last = 0
        do i = 1, size(words)
            if (i > 1) text(last + 1:last + len(separator)) = separator
            if (i > 1) last = last + len(separator)
            text(last + 1:last + len(words(i)%text)) = words(i)%text
            last = last + len(words(i)%text)
        end do
    end function join_strings

    !> Joins words of one length, without their trailing blanks.
    pure function join_words(words, separator) result(text)
        character(*), intent(in) :: words(:), separator !! the words, and the text between two of them
        character(:), allocatable :: text
        text = join_strings(strings_of(words), separator)
    end function join_words

    !> Words of one length as texts, without their trailing blanks.
    pure function strings_of(words) result(strings)
        character(*), intent(in) :: words(:) !! the words
        type(string_t) :: strings(size(words))
        integer :: i
        do i = 1, size(words)
            strings(i)%text = trim(words(i))
        end do
    end function strings_of

    !> The parts of a text between separators, without surrounding blanks; none if the text is blank.
    pure subroutine split(text, separator, parts, keeps_blanks)
        character(*), intent(in) :: text !! the text with the separators
        character, intent(in) :: separator !! character between two parts
        type(string_t), allocatable, intent(out) :: parts(:) !! the parts
        logical, intent(in), optional :: keeps_blanks !! whether blanks around the parts stay; false by default
        integer :: i, part, first

        allocate (parts(merge(0, 1 + count([(text(i:i) == separator, i = 1, len(text))]), text == '')))
        first = 1
        do part = 1, size(parts)
            i = first + index(text(first:) // separator, separator) - 1
            parts(part)%text = text(first:i - 1)
            first = i + 1
            if (present(keeps_blanks)) then
                if (keeps_blanks) cycle
            end if
            parts(part)%text = trim(adjustl(parts(part)%text))
        end do
    end subroutine split

    !> The last byte of the line that begins at a place.
    pure integer function end_of_line(text, first) result(last)
        character(*), intent(in) :: text !! any lines
        integer, intent(in) :: first !! the place
        last = first + index(text(first:), new_line('a')) - 2
        if (last < first - 1) last = len(text)
    end function end_of_line

    !> Adds a text to a list. The constructor `[list, string_t(text)]` of gfortran does not free its parts.
    pure subroutine append(list, text)
        type(string_t), allocatable, intent(inout) :: list(:) !! the list; empty if it is not allocated
        character(*), intent(in) :: text !! the text; none of the list
        type(string_t), allocatable :: longer(:)
        integer :: i, n

        n = 0
        if (allocated(list)) n = size(list)
        allocate (longer(n + 1))
        do i = 1, n
            call move_alloc(list(i)%text, longer(i)%text)
        end do
        longer(n + 1)%text = text
        call move_alloc(longer, list)
    end subroutine append

    !> Adds words as a list with commas after a beginning, on as many lines as needed.
    pure subroutine append_words(lines, start, words)
        type(string_t), allocatable, intent(inout) :: lines(:) !! the lines so far
        character(*), intent(in) :: start !! beginning of the first line
        type(string_t), intent(in) :: words(:) !! the items of the list
        character(:), allocatable :: line, word
        integer :: i

        line = start
        do i = 1, size(words)
            word = words(i)%text
            if (i < size(words)) word = word // ','
            if (i > 1 .and. len(line) + len(word) > line_width) then
                call append(lines, trim(line))
                line = repeat(' ', len(start))
            end if
            line = line // word // ' '
        end do
        call append(lines, trim(line))
    end subroutine append_words

    !> Adds a text that is broken at blanks, so that no line is longer than `width` if possible. All lines begin
    !> with `start`, and the second and further ones have `indent` blanks after it.
    pure subroutine append_wrapped(lines, start, text, indent, width)
        type(string_t), allocatable, intent(inout) :: lines(:) !! the lines so far
        character(*), intent(in) :: start, text !! beginning of each line, and text
        integer, intent(in) :: indent, width !! blanks, and columns of a line
        character(:), allocatable :: broken
        type(string_t), allocatable :: parts(:)
        integer :: i

        broken = text
        if (characters(text) > width - len(start)) broken = wrapped(text, 0, width - len(start), indent=indent)
        call split(broken, new_line('a'), parts, keeps_blanks=.true.)
        do i = 1, size(parts)
            call append(lines, start // parts(i)%text)
        end do
        if (size(parts) == 0) call append(lines, start // text)
    end subroutine append_wrapped

    !> A text broken at blanks, so that no line is longer than `width` if possible. The first line begins at
    !> column `start + 1`. The other lines are indented as far, or by `indent` if it is present. Line ends of
    !> the text are kept.
    pure function wrapped(text, start, width, indent) result(lines)
        character(*), intent(in) :: text !! may contain line ends
        integer, intent(in) :: start !! columns in use before the first word
        integer, intent(in) :: width !! columns of a line
        integer, intent(in), optional :: indent !! blanks before the other lines
        character(:), allocatable :: lines
        character, parameter :: line_feed = new_line('a')
        integer :: at, next, used, blanks, length

        blanks = start
        if (present(indent)) blanks = indent
        if (width - blanks < least_room) blanks = min(blanks, 4)
        lines = ''
        used = start
        at = 1
        do while (at <= len(text))
            next = at + verify(text(at:) // 'x', ' ') - 1
            if (next > len(text)) exit
            length = scan(text(next:) // ' ', ' ' // line_feed) - 1
            if (lines /= '' .and. used + (next - at) + characters(text(next:next + length - 1)) > width) then
                lines = lines // line_feed // repeat(' ', blanks)
                used = blanks
            else
                lines = lines // text(at:next - 1)
                used = used + (next - at)
            end if
            lines = lines // text(next:next + length - 1)
            used = used + characters(text(next:next + length - 1))
            at = next + length
            if (at > len(text)) exit
            if (text(at:at) /= line_feed) cycle
            lines = lines // line_feed // repeat(' ', blanks)
            used = blanks
            at = at + 1
        end do
    end function wrapped

    !> Number of characters of a UTF-8 text (continuation bytes do not count).
    pure integer function characters(text)
        character(*), intent(in) :: text !! in UTF-8
        integer :: i
        characters = count([(iand(iachar(text(i:i)), 192) /= 128, i=1, len(text))])
    end function characters

    !> The text with every occurrence of one character replaced.
    pure function replace_all(text, old, new) result(replaced)
        character(*), intent(in) :: text, new !! the text, and the characters that replace `old`
        character, intent(in) :: old !! the character to be replaced
        character(:), allocatable :: replaced
        type(string_t), allocatable :: parts(:)
        call split('x' // text, old, parts, keeps_blanks=.true.) ! of a blank text there are no parts
        replaced = join(parts, new)
        replaced = replaced(2:)
    end function replace_all

    !> The text, shortened if necessary for a message.
    pure function abbreviate(text) result(short)
        character(*), intent(in) :: text !! a text of any length
        character(:), allocatable :: short
        integer, parameter :: longest = 60
        short = text
        if (len(text) > longest) short = text(:longest) // '...'
    end function abbreviate

    !> A real in the shortest form that gives the same bits.
    function real_to_text(value) result(text)
        real(dp), intent(in) :: value !! the number, finite or not
        character(:), allocatable :: text
        text = trim(fixed_text(value))
    end function real_to_text

    !> The same with blanks after it, for threads: see `status_names`.
    function fixed_text(value) result(text)
        real(dp), intent(in) :: value !! the value
        character(real_width) :: text
        integer :: length
        length = write_reals([value], 1, text, real_width)
        text(length + 1:) = ''
    end function fixed_text

    !> An integer without blanks.
    pure function integer_to_text(value) result(text)
        integer, intent(in) :: value !! the integer, of either sign
        character(:), allocatable :: text
        text = long_integer_to_text(int(value, int64))
    end function integer_to_text

    !> A 64-bit integer without blanks.
    pure function long_integer_to_text(value) result(text)
        integer(int64), intent(in) :: value !! the integer, of either sign
        character(:), allocatable :: text
        character(real_width) :: room
        write (room, '(ss, i0)') value
        text = trim(room)
    end function long_integer_to_text

    !> The text as a terminal may show it: a tab becomes a blank; other control characters, and bytes that are
    !> not UTF-8, become '?'; line ends are kept.
    pure function visible(text, escapes) result(shown)
        character(*), intent(in) :: text !! any bytes
        logical, intent(in), optional :: escapes !! whether it is the text of `escaped`; false by default
        character(:), allocatable :: shown, room
        character(*), parameter :: digits = '0123456789abcdef'
        character(4) :: piece
        integer :: i, n, length, code, next
        logical :: is_escaped

        is_escaped = .false.
        if (present(escapes)) is_escaped = escapes
        allocate (character(4 * len(text)) :: room)
        n = 0
        i = 1
        do while (i <= len(text))
            length = utf8_length(text(i:))
            next = i + max(1, length)
            code = iachar(text(i:i))
            if (length > 0) then
                piece = text(i:next - 1)
            else if (code == 9 .or. code == 10) then
                piece = merge(merge('\t', '\n', code == 9), merge('  ', new_line('a') // ' ', code == 9), is_escaped)
                length = merge(2, 1, is_escaped)
            else
                piece = '?'
                if (is_escaped) piece = '\x' // digits(code / 16 + 1:code / 16 + 1) // digits(mod(code, 16) + 1:mod(code, 16) + 1)
                length = merge(4, 1, is_escaped)
            end if
            room(n + 1:n + length) = piece
            n = n + length
            i = next
        end do
        shown = room(:n)
    end function visible

    !> The text on one line, as a terminal may show it: a line end as \n, a tab as \t, and each byte that
    !> is not UTF-8 or is a control character as \x and two digits, as shells write it in $'...'.
    pure function escaped(text) result(shown)
        character(*), intent(in) :: text !! any bytes
        character(:), allocatable :: shown
        shown = visible(text, escapes=.true.)
    end function escaped

    !> Whether every program reads a text as a single line: it has no control character, no byte that is not
    !> UTF-8, and none of the two Unicode line separators.
    pure logical function is_plain(text)
        character(*), intent(in) :: text !! any bytes
        character(*), parameter :: line_separator = char(226) // char(128) // char(168), &
            paragraph_separator = char(226) // char(128) // char(169)
        is_plain = index(text, new_line('a')) == 0
        if (is_plain) is_plain = visible(text) == text
        if (is_plain) is_plain = index(text, line_separator) == 0 .and. index(text, paragraph_separator) == 0
    end function is_plain

    !> Number of bytes of the character at the beginning of a text; 0 if it is not UTF-8, is a control character, or changes
    !> the direction of writing, so that a line would show another order than it has.
    pure integer function utf8_length(text) result(length)
        character(*), intent(in) :: text
        integer :: first, least, most, i

        first = iachar(text(1:1))
        length = 0
        if (first >= 32 .and. first /= 127) length = 1
        if (first >= 128) length = merge(2, 0, first >= 194) + merge(1, 0, first >= 224) + merge(1, 0, first >= 240)
        if (length > len(text) .or. first > 244) length = 0
        ! Of the second byte: without C1 controls, overlong encodings, surrogates, and what is beyond Unicode.
        least = merge(160, 128, first == 194 .or. first == 224) + merge(16, 0, first == 240)
        most = 191 - merge(32, 0, first == 237) - merge(48, 0, first == 244)
        do i = 2, length
            if (iachar(text(i:i)) < merge(least, 128, i == 2) .or. iachar(text(i:i)) > merge(most, 191, i == 2)) then
                length = 0
                return
            end if
        end do
        if (first /= 226 .or. length == 0) return
        select case (256 * iachar(text(2:2)) + iachar(text(3:3)))
        case (32910:32911, 32938:32942, 33190:33193) ! U+200E, 200F, 202A to 202E, 2066 to 2069
            length = 0
        end select
    end function utf8_length

end module spintop_text
