!> Options of the command line for studies.
module spintop_options
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_process, only: watch_signals
    use spintop_ranks, only: ranks_t
    use spintop_row_table, only: row_table_t
    use spintop_table_head, only: shard_t
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: options_t, most_threads, shell_word

    !> Threads that may be asked for.
    integer, parameter :: most_threads = 4096

    !> Options of the command line for all inputs, and the processes of the run.
    type :: options_t
        !> Folder for results.
        character(:), allocatable :: output
        !> Overrides `group.key=value`, in the given order.
        type(string_t), allocatable :: overrides(:)
        !> Number of threads; 0 for all cores.
        integer :: threads = 0
        logical :: quiet = .false.
        logical :: progress = .false.
        !> Whether the summary of a run has all its lines.
        logical :: verbose = .false.
        !> The part of a sweep, and whether an interrupted run is resumed or discarded.
        type(shard_t) :: shard
        logical :: resume = .false., restart = .false.
        !> Whether the inputs are tables, whose headers have them, to be verified; and whether each number must be proved.
        logical :: verifies = .false., strict = .false.
        !> The program and its options in the syntax of a shell, without the inputs and those two options.
        character(:), allocatable :: command
        type(ranks_t) :: ranks
    contains
        procedure :: announce_signals
    end type options_t

contains

    !> Sets the message of a signal that ends a run: the number of kept rows, and the command that resumes it.
    subroutine announce_signals(self, input, path, table, rows)
        class(options_t), intent(in) :: self
        character(*), intent(in) :: input, path !! the input, and the path of its table
        class(row_table_t), intent(in) :: table !! the table
        integer(int64), intent(in) :: rows !! number of rows of the whole table
        character, parameter :: nl = new_line('a')
        character(:), allocatable :: command

        if (.not. table%is_resumable) then
            call watch_signals('', 'spintop: interrupted: nothing is kept of ' // path // nl, -1_int64)
            return
        end if
        command = 'the same command with --resume'
        if (self%ranks%count == 1 .and. allocated(self%command)) then
            command = self%command // ' --resume '
            if (index(input, '-') == 1) command = command // '-- '
            command = command // shell_word(input)
        end if
        call watch_signals('spintop: interrupted: ', ' of ' // to_text(rows) // ' rows of ' // path // &
                           ' are kept' // nl // 'to resume: ' // command // nl, table%rows())
    end subroutine announce_signals

    !> A text as a word of the shell.
    pure function shell_word(text) result(word)
        character(*), intent(in) :: text !! any text, such as a path
        character(:), allocatable :: word
        character(*), parameter :: plain = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,:+@%-'
        integer :: i
        word = text
        if (text /= '' .and. verify(text, plain) == 0) return
        word = ''''
        do i = 1, len(text)
            if (text(i:i) == '''') then
                word = word // '''\'''''
            else
                word = word // text(i:i)
            end if
        end do
        word = word // ''''
    end function shell_word

end module spintop_options
