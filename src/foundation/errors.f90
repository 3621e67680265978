!> Errors as values: a message and the exit code that it leads to; and what these codes mean.
module spintop_errors
    implicit none
    private
    public :: error_t, input_error, output_error, internal_error
    public :: exit_ok, exit_input, exit_failed, exit_output, exit_internal, exit_codes

    !> Success.
    integer, parameter :: exit_ok = 0
    !> Wrong usage or input: nothing was computed or overwritten.
    integer, parameter :: exit_input = 2
    !> Some cases failed; the rest is written and the failed are marked.
    integer, parameter :: exit_failed = 3
    !> A result could not be written.
    integer, parameter :: exit_output = 4
    !> The memory is exhausted, or the program broke one of its own rules.
    integer, parameter :: exit_internal = 5

    !> What an exit code means.
    type :: exit_code_t
        integer :: code
        character(72) :: what
    end type exit_code_t

    !> All exit codes. A signal N ends the program with 128 + N.
    type(exit_code_t), parameter :: exit_codes(*) = [ &
        exit_code_t(exit_ok, 'success'), &
        exit_code_t(exit_input, 'wrong usage or input: nothing was computed or overwritten'), &
        exit_code_t(exit_failed, 'some cases failed; all rows are written, and failed cases are marked'), &
        exit_code_t(exit_output, 'a result could not be written'), &
        exit_code_t(exit_internal, 'memory exhausted, or an internal error')]

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
