!> The terminal: whether there is one, and how wide lines may be.
module spintop_terminal
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_posix, only: c_is_terminal
    use spintop_wrapping, only: default_width
    implicit none
    private
    public :: error_is_terminal, message_width, output_width

    !> Smallest width used: on a narrower terminal every line would be a single word.
    integer, parameter :: least_width = 40

    interface
        integer(c_int) function c_terminal_width(file) bind(C, name='spintop_terminal_width')
            import :: c_int
            integer(c_int), value :: file
        end function c_terminal_width
    end interface

contains

    !> Columns of the terminal that standard error is; the same everywhere for a file or a pipe.
    integer function message_width()
        message_width = c_terminal_width(2_c_int)
        if (message_width <= 0) message_width = default_width
        message_width = max(message_width, least_width)
    end function message_width

    !> Columns of the terminal that standard output is; no bound for a file or a pipe, whose lines others read.
    integer function output_width()
        output_width = c_terminal_width(1_c_int)
        if (output_width <= 0) output_width = huge(output_width)
        output_width = max(output_width, least_width)
    end function output_width

    !> Whether standard error is a terminal.
    logical function error_is_terminal()
        error_is_terminal = c_is_terminal(2_c_int) /= 0
    end function error_is_terminal

end module spintop_terminal
