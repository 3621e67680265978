!> Errors as values: a message and the exit code that it leads to.
module spintop_errors
    use spintop_exit_codes, only: exit_input, exit_internal, exit_output
    implicit none
    private
    public :: error_t, input_error, output_error, internal_error

    !> An error; not allocated if there is none.
    type :: error_t
        !> Exit code of a program that ends with this error.
        integer :: code = exit_internal
        !> What is wrong and what to do, ready to print; may have several lines.
        character(:), allocatable :: message
        !> The first place in an input that is wrong: the name of the input, its line and column (0 if there is none).
        character(:), allocatable :: source
        integer :: line = 0, column = 0
    end type error_t

contains

    !> Wrong usage or input.
    pure type(error_t) function input_error(message)
        character(*), intent(in) :: message !! what is wrong, and what to do
        input_error = error_t(exit_input, message)
    end function input_error

    !> A result could not be written.
    pure type(error_t) function output_error(message)
        character(*), intent(in) :: message !! what is wrong, and what to do
        output_error = error_t(exit_output, message)
    end function output_error

    !> An internal error: the program violated one of its own rules.
    pure type(error_t) function internal_error(message)
        character(*), intent(in) :: message !! what is wrong, and what to do
        internal_error = error_t(exit_internal, message)
    end function internal_error

end module spintop_errors
