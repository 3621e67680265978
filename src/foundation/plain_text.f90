!> Texts that are safe on a terminal, and texts that fit into one line of a table.
module spintop_plain_text
    implicit none
    private
    public :: visible, escaped, is_plain

contains

    !> The text as a terminal may show it: a tab becomes a blank; other control characters, and bytes that are
    !> not UTF-8, become '?'; line ends are kept.
    pure function visible(text) result(shown)
        character(*), intent(in) :: text !! any bytes
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

    !> The text on one line, as a terminal may show it: a line end as \n, a tab as \t, and each byte that
    !> is not UTF-8 or is a control character as \x and two digits, as shells write it in $'...'.
    pure function escaped(text) result(shown)
        character(*), intent(in) :: text !! any bytes
        character(:), allocatable :: shown
        character(*), parameter :: digits = '0123456789abcdef'
        character(:), allocatable :: room
        integer :: i, n, length, code

        allocate (character(4 * len(text)) :: room)
        n = 0
        i = 1
        do while (i <= len(text))
            length = utf8_length(text(i:))
            code = iachar(text(i:i))
            if (code == 10) then
                call append(room, n, '\n')
            else if (code == 9) then
                call append(room, n, '\t')
            else if (length == 0 .or. code == 127 .or. code < 32) then
                call append(room, n, '\x' // digits(code / 16 + 1:code / 16 + 1) // digits(mod(code, 16) + 1:mod(code, 16) + 1))
                length = 1
            else
                call append(room, n, text(i:i + length - 1))
            end if
            i = i + length
        end do
        shown = room(:n)
    end function escaped

    !> Appends a piece to the first `n` characters of a text that has room for it.
    pure subroutine append(room, n, piece)
        character(*), intent(inout) :: room
        integer, intent(inout) :: n
        character(*), intent(in) :: piece
        room(n + 1:n + len(piece)) = piece
        n = n + len(piece)
    end subroutine append

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

    !> Number of bytes of the character at the beginning of a text; 0 if it is not UTF-8, or is a control
    !> character.
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
            if (i < 160) length = 0 ! overlong encoding
        case (226)
            if (turns_writing(i, iachar(text(3:3)))) length = 0
        case (237)
            if (i > 159) length = 0 ! a surrogate
        case (240)
            if (i < 144) length = 0 ! overlong encoding
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
