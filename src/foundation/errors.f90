!> Errors as values: what went wrong, where, and the exit code it leads to.
module spintop_errors
    implicit none
    private
    public :: error_t, input_error, output_error, internal_error
    public :: exit_ok, exit_input, exit_failed, exit_output, exit_internal

    !> Exit codes of the program; an error carries the one it leads to.
    integer, parameter :: exit_ok = 0
    !> Wrong usage or input: nothing was computed or overwritten.
    integer, parameter :: exit_input = 2
    !> Some cases failed; the rest is written and the failed are marked.
    integer, parameter :: exit_failed = 3
    !> A result could not be written.
    integer, parameter :: exit_output = 4
    !> The program broke one of its own rules.
    integer, parameter :: exit_internal = 5

    !> An error; unallocated means none.
    type :: error_t
        !> Exit code of a program that ends with it.
        integer :: code = exit_internal
        !> What is wrong and what would be right, ready to print (may hold several lines).
        character(:), allocatable :: message
    end type error_t

contains

    !> Wrong usage or input.
    pure type(error_t) function input_error(message)
        character(*), intent(in) :: message
        input_error = error_t(exit_input, message)
    end function input_error

    !> A result could not be written.
    pure type(error_t) function output_error(message)
        character(*), intent(in) :: message
        output_error = error_t(exit_output, message)
    end function output_error

    !> A broken rule of the program itself.
    pure type(error_t) function internal_error(message)
        character(*), intent(in) :: message
        internal_error = error_t(exit_internal, message)
    end function internal_error

end module spintop_errors
