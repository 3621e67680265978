!> Texts that are safe on a terminal, and texts that fit on one line of a table.
module spintop_plain_text
    implicit none
    private
    public :: visible, is_plain

contains

    !> The text as a terminal may show it: a tab as a blank, other control characters and
    !> bytes that are no UTF-8 as '?', line ends kept.
    pure function visible(text) result(shown)
        character(*), intent(in) :: text
        character(:), allocatable :: shown
        integer :: i, length, code

        allocate (character(len(text)) :: shown)
        shown(:) = text
        i = 1
        do while (i <= len(text))
            length = utf8_length(text(i:))
            code = iachar(text(i:i))
            if (code == 9) then
                shown(i:i) = ' '
            else if (length == 0 .or. code == 127 .or. (code < 32 .and. code /= 10)) then
                shown(i:i) = '?'
            end if
            i = i + max(1, length)
        end do
    end function visible

    !> Whether a text stands on one line, and every program sees that line: no control character, no byte
    !> that is not UTF-8, and none of the two characters of Unicode that part lines.
    pure logical function is_plain(text)
        character(*), intent(in) :: text
        character(*), parameter :: line_separator = char(226) // char(128) // char(168), &
            paragraph_separator = char(226) // char(128) // char(169)
        is_plain = index(text, new_line('a')) == 0
        if (is_plain) is_plain = visible(text) == text
        if (is_plain) is_plain = index(text, line_separator) == 0 .and. index(text, paragraph_separator) == 0
    end function is_plain

    !> Bytes of the character that the text starts with; 0 if that is not UTF-8, or one that a terminal
    !> obeys.
    pure integer function utf8_length(text) result(length)
        character(*), intent(in) :: text
        integer :: code, i

        code = iachar(text(1:1))
        select case (code)
        case (0:127)
            length = 1
        case (194:223)
            length = 2
        case (224:239)
            length = 3
        case (240:244)
            length = 4
        case default
            length = 0
        end select
        if (length > len(text)) length = 0
        do i = 2, length
            if (iand(iachar(text(i:i)), 192) /= 128) then
                length = 0
                return
            end if
        end do
        if (length < 2) return
        i = iachar(text(2:2))
        select case (code)
        case (194)
            if (i < 160) length = 0 ! a C1 control
        case (224)
            if (i < 160) length = 0 ! longer than need be
        case (226)
            if (turns_writing(i, iachar(text(3:3)))) length = 0
        case (237)
            if (i > 159) length = 0 ! a surrogate
        case (240)
            if (i < 144) length = 0 ! longer than need be
        case (244)
            if (i > 143) length = 0 ! beyond Unicode
        end select
    end function utf8_length

    !> Whether the character of bytes 226, `second` and `third` changes the direction of writing, so that
    !> a line would show another order than it has (U+200E, 200F, 202A to 202E, 2066 to 2069).
    pure logical function turns_writing(second, third)
        integer, intent(in) :: second, third
        turns_writing = (second == 128 .and. (third == 142 .or. third == 143 .or. &
            (third >= 170 .and. third <= 174))) .or. (second == 129 .and. third >= 166 .and. third <= 169)
    end function turns_writing

end module spintop_plain_text
