!> Colours of messages on a terminal: the words `error` and `warning`, and the marks below a quoted line.
module spintop_colour
    use spintop_terminal, only: error_takes_colour
    use spintop_text, only: join, split, string_t
    implicit none
    private
    public :: coloured, in_colour

    character(*), parameter :: escape = achar(27) // '['
    character(*), parameter :: red = escape // '1;31m', magenta = escape // '1;35m', green = escape // '1;32m'
    character(*), parameter :: plain = escape // '0m'

contains

    !> A message for standard error: with colours where that is a terminal that takes them, else as it is.
    function in_colour(message) result(text)
        character(*), intent(in) :: message !! one or more lines
        character(:), allocatable :: text
        if (error_takes_colour()) then
            text = coloured(message)
        else
            text = message
        end if
    end function in_colour

    !> A message with colours.
    pure function coloured(message) result(text)
        character(*), intent(in) :: message !! one or more lines
        character(:), allocatable :: text
        type(string_t), allocatable :: lines(:)
        integer :: i
        call split(message, new_line('a'), lines, keeps_blanks=.true.)
        do i = 1, size(lines)
            lines(i)%text = coloured_line(lines(i)%text)
        end do
        text = join(lines, new_line('a'))
    end function coloured

    pure function coloured_line(line) result(text)
        character(*), intent(in) :: line
        character(:), allocatable :: text
        integer :: first, last

        text = line
        first = index(line, '^')
        if (first > 1) then
            if (verify(line(:first - 1), ' |') == 0 .and. index(line(:first - 1), '|') > 0) then
                last = first + verify(line(first:) // ' ', '^') - 2
                text = line(:first - 1) // green // line(first:last) // plain // line(last + 1:)
                return
            end if
        end if
        call paint(': error: ', red, text)
        call paint(': warning: ', magenta, text)
    end function coloured_line

    !> Gives the first occurrence of a word in a line a colour; the word has a separator and a blank at its
    !> ends, which are left as they are.
    pure subroutine paint(word, colour, line)
        character(*), intent(in) :: word, colour
        character(:), allocatable, intent(inout) :: line
        integer :: first, last
        first = index(line, word)
        if (first == 0) return
        last = first + len(word) - 2
        line = line(:first + 1) // colour // line(first + 2:last) // plain // line(last + 1:)
    end subroutine paint

end module spintop_colour
