!> The terminal: whether there is one, its width, and whether it takes colours.
module spintop_terminal
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_posix, only: c_is_terminal
    use spintop_wrapping, only: default_width
    implicit none
    private
    public :: error_is_terminal, error_takes_colour, message_width, output_width

    !> Minimum width: on a narrower terminal every line would be a single word.
    integer, parameter :: least_width = 40

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
        error_is_terminal = c_is_terminal(2_c_int) /= 0
    end function error_is_terminal

    !> Whether messages on standard error may have colours: it is a terminal that is not dumb, and NO_COLOR is
    !> not set (https://no-color.org).
    logical function error_takes_colour()
        character(8) :: kind
        integer :: length
        error_takes_colour = error_is_terminal()
        if (.not. error_takes_colour) return
        call get_environment_variable('NO_COLOR', length=length)
        call get_environment_variable('TERM', kind)
        error_takes_colour = length == 0 .and. kind /= 'dumb'
    end function error_takes_colour

end module spintop_terminal
