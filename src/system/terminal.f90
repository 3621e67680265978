!> The terminal: whether there is one, its width, and the colours of messages on it: of the words `error` and `warning`, and of
!> the marks below a quoted line.
module spintop_terminal
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_text, only: default_width, join, split, string_t
    implicit none
    private
    public :: error_is_terminal, message_width, output_width, in_colour, coloured

    !> Minimum width: on a narrower terminal every line would be a single word.
    integer, parameter :: least_width = 40

    character(*), parameter :: escape = achar(27) // '['
    character(*), parameter :: red = escape // '1;31m', magenta = escape // '1;35m', green = escape // '1;32m'
    character(*), parameter :: plain = escape // '0m'

    interface
        integer(c_int) function c_terminal_width(file) bind(C, name='spintop_terminal_width')
            import :: c_int
            integer(c_int), value :: file
        end function c_terminal_width
    end interface

contains

    !> Width of lines on standard error, columns: that of the terminal, or `default_width` for a file or a
    !> pipe.
    integer function message_width()
        message_width = c_terminal_width(2_c_int)
        if (message_width <= 0) message_width = default_width
        message_width = max(message_width, least_width)
    end function message_width

    !> Width of lines on standard output, columns: that of the terminal; unlimited for a file or a pipe, which
    !> other programs read.
    integer function output_width()
        output_width = c_terminal_width(1_c_int)
        if (output_width <= 0) output_width = huge(output_width)
        output_width = max(output_width, least_width)
    end function output_width

    !> Whether standard error is a terminal.
    logical function error_is_terminal()
        error_is_terminal = c_terminal_width(2_c_int) >= 0
    end function error_is_terminal

    !> A message for standard error: with colours where that is a terminal that takes them, else as it is. One that is dumb
    !> takes none, nor is there one with NO_COLOR (https://no-color.org).
    function in_colour(message) result(text)
        character(*), intent(in) :: message !! one or more lines
        character(:), allocatable :: text
        character(8) :: kind
        integer :: length
        text = message
        call get_environment_variable('NO_COLOR', length=length)
        call get_environment_variable('TERM', kind)
        if (error_is_terminal() .and. length == 0 .and. kind /= 'dumb') text = coloured(message)
    end function in_colour

    !> A message with colours.
    pure function coloured(message) result(text)
        character(*), intent(in) :: message !! one or more lines
        character(:), allocatable :: text, line
        type(string_t), allocatable :: lines(:)
        integer :: i, first, last
        call split(message, new_line('a'), lines, keeps_blanks=.true.)
        do i = 1, size(lines)
            line = lines(i)%text
            first = index(line, '^')
            if (index(line(:max(0, first - 1)), '|') > 0 .and. verify(line(:max(0, first - 1)), ' |') == 0) then
                last = first + verify(line(first:) // ' ', '^') - 2
                lines(i)%text = line(:first - 1) // green // line(first:last) // plain // line(last + 1:)
            else
                call paint(': error: ', red, lines(i)%text)
                call paint(': warning: ', magenta, lines(i)%text)
            end if
        end do
        text = join(lines, new_line('a'))
    end function coloured

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

end module spintop_terminal
