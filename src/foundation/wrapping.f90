!> Breaks long texts into lines.
module spintop_wrapping
    implicit none
    private
    public :: wrapped, characters, default_width

    !> Width of a text that is not written to a terminal, in columns.
    integer, parameter :: default_width = 100
    !> Minimum number of columns for words beside an indentation.
    integer, parameter :: least_room = 24

contains

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

end module spintop_wrapping
