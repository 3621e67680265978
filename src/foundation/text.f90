!> Words and numbers as text.
module spintop_text
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_long_long
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    implicit none
    private
    public :: string_t, append, lower_case, nearest_word, did_you_mean, join, split, to_text, counted, replace_all, abbreviate
    public :: strings_of
    public :: write_reals, write_integer, fixed_text, real_width

    !> Maximum number of characters of a real number.
    integer, parameter :: real_width = 24

    !> A text of any length, as an element of a list.
    type :: string_t
        character(:), allocatable :: text
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
        integer(c_int) function c_real_to_text(value, text, capacity) &
                bind(C, name='spintop_real_to_text')
            import :: c_char, c_double, c_int
            real(c_double), value :: value
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: capacity
        end function c_real_to_text

        integer(c_int) function c_integer_to_text(value, text, capacity) &
            bind(C, name='spintop_integer_to_text')
            import :: c_char, c_int, c_long_long
            integer(c_long_long), value :: value
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: capacity
        end function c_integer_to_text

        integer(c_int) function c_reals_to_text(values, count, text, capacity) &
                bind(C, name='spintop_reals_to_text')
            import :: c_char, c_double, c_int
            real(c_double), intent(in) :: values(*)
            integer(c_int), value :: count, capacity
            character(c_char), intent(inout) :: text(*)
        end function c_reals_to_text
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
        least = max(1, len_trim(word) / 3) + 1
        do i = 1, size(candidates)
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
        integer :: i, first, last

        last = max(0, size(words) - 1) * len(separator)
        do i = 1, size(words)
            last = last + len(words(i)%text)
        end do
        allocate (character(last) :: text)
        last = 0
        do i = 1, size(words)
            first = last + 1
            last = last + len(words(i)%text)
            text(first:last) = words(i)%text
            if (i == size(words)) exit
            text(last + 1:last + len(separator)) = separator
            last = last + len(separator)
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

        if (len_trim(text) == 0) then
            allocate (parts(0))
            return
        end if
        allocate (parts(1 + count([(text(i:i) == separator, i = 1, len(text))])))
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

    !> The text with every occurrence of one character replaced.
    pure function replace_all(text, old, new) result(replaced)
        character(*), intent(in) :: text, new !! the text, and the characters that replace `old`
        character, intent(in) :: old !! the character to be replaced
        character(:), allocatable :: replaced
        integer :: i, n, found

        found = count([(text(i:i) == old, i=1, len(text))])
        allocate (character(len(text) + found * (len(new) - 1)) :: replaced)
        n = 0
        do i = 1, len(text)
            if (text(i:i) == old) then
                replaced(n + 1:n + len(new)) = new
                n = n + len(new)
            else
                n = n + 1
                replaced(n:n) = text(i:i)
            end if
        end do
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
        length = c_real_to_text(value, text, real_width)
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

    !> Writes an integer to the start of a text of `real_width` characters or more.
    subroutine write_integer(value, text, length)
        integer(int64), intent(in) :: value !! the integer to write
        character(*), intent(inout) :: text !! the digits are at its beginning
        integer, intent(out) :: length !! characters written
        length = c_integer_to_text(value, text, len(text))
    end subroutine write_integer

    !> Writes numbers, separated by commas, to the start of a text with room for `(real_width +
    !> 1)*size(values)` characters. This is the fast way to make a row of a table.
    subroutine write_reals(values, text, length)
        real(dp), intent(in), contiguous :: values(:) !! numbers
        character(*), intent(inout) :: text !! the numbers are at its beginning
        integer, intent(out) :: length !! characters written
        length = c_reals_to_text(values, size(values), text, len(text))
    end subroutine write_reals

end module spintop_text
