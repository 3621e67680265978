!> The exit codes of the program, and what they mean.
module spintop_exit_codes
    implicit none
    private
    public :: exit_ok, exit_input, exit_failed, exit_output, exit_internal, exit_code_t, exit_codes

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

end module spintop_exit_codes
