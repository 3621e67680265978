!> The process: its processor, standard streams, messages on signals, limits, and its end.
module spintop_process
    use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_int, c_long_long, c_null_char
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: c_close, c_write, check_call, up_to_null
    use spintop_text, only: to_text
    implicit none
    private
    public :: begin_process, end_process, check_stacks, print_text, complain_of, end_output
    public :: watch_signals, keep_rows, stop_watching_signals, set_journal_thread, end_is_wanted, end_by_signal
    public :: expect_crash, leave_libraries
    public :: host_name, peak_memory, physical_memory, check_level, processor_level_name

    !> Numbers of the standard streams.
    integer(c_int), parameter :: standard_output = 1, standard_error = 2

    !> Minimum stack of a thread, bytes: twice the 224 kB measured for the most demanding sweep.
    integer(int64), parameter :: least_stack = 448 * 1024

    !> The variable of the environment that chooses a lower level of the processor, and the lowest level that has a build.
    character(*), parameter :: level_variable = 'SPINTOP_LEVEL'
    integer, parameter :: lowest_level = 2

    ! Functions of process.c, processor.c and posix.c, which describe them.
    abstract interface
        integer(c_int) function c_number() bind(C)
            import :: c_int
        end function c_number

        subroutine c_command() bind(C)
        end subroutine c_command

        integer(c_long_long) function c_amount() bind(C)
            import :: c_long_long
        end function c_amount
    end interface

    !> Opens closed standard streams, so that no other file takes their numbers; makes an exceeded file-size limit an error of
    !> writing; and installs the handlers of signals and of errors of the run-time libraries. To be called once, before any
    !> file is opened.
    procedure(c_command), bind(C, name='spintop_begin_process') :: begin_process
    !> Ends the process by the signal that wants it to end.
    procedure(c_command), bind(C, name='spintop_end_by_signal') :: end_by_signal
    !> At its end the process does nothing more in its libraries: one of them is in a state that it does not expect.
    procedure(c_command), bind(C, name='spintop_leave_libraries') :: leave_libraries
    !> Ends the messages on signals.
    procedure(c_command), bind(C, name='spintop_watch_no_more') :: stop_watching_signals
    !> Peak memory of the process so far, and memory of the machine, bytes.
    procedure(c_amount), bind(C, name='spintop_peak_memory') :: peak_memory
    procedure(c_amount), bind(C, name='spintop_physical_memory') :: physical_memory
    procedure(c_amount), bind(C, name='spintop_stack_limit') :: c_stack_limit
    procedure(c_amount), bind(C, name='spintop_thread_stack') :: c_thread_stack

    !> The level of the processor by which the kernels choose one of their builds, and the highest that it has; 0 where all
    !> kernels have the flags of the build.
    procedure(c_number), bind(C, name='spintop_processor_level') :: c_level
    procedure(c_number), bind(C, name='spintop_highest_level') :: c_highest_level

    interface
        !> Ends the process with an exit code.
        subroutine end_process(code) bind(C, name='spintop_end_process')
            import :: c_int
            integer(c_int), value :: code !! exit code
        end subroutine end_process

        !> Sets whether a thread of this process looks for `end_is_wanted`, keeps what is to be kept, and then calls
        !> `end_by_signal`. After a signal it has nine tenths of a second. Without such a thread, and at a second signal, the
        !> process ends at once.
        subroutine set_journal_thread(there_is_one) bind(C, name='spintop_set_journal_thread')
            import :: c_bool
            logical(c_bool), value :: there_is_one !! whether there is such a thread
        end subroutine set_journal_thread

        !> Whether a signal wants the process to end.
        logical(c_bool) function end_is_wanted() bind(C, name='spintop_end_is_wanted')
            import :: c_bool
        end function end_is_wanted

        subroutine c_watch(head, tail, rows) bind(C, name='spintop_watch')
            import :: c_char, c_long_long
            character(c_char), intent(in) :: head(*), tail(*)
            integer(c_long_long), value :: rows
        end subroutine c_watch

        !> Sets the number of kept rows in the message of `watch_signals`. Any thread may call it.
        subroutine keep_rows(rows) bind(C, name='spintop_keep')
            import :: c_long_long
            integer(c_long_long), value :: rows !! number of kept rows
        end subroutine keep_rows

        subroutine c_expect_crash(text) bind(C, name='spintop_expect_crash')
            import :: c_char
            character(c_char), intent(in) :: text(*)
        end subroutine c_expect_crash

        subroutine c_host(text, room) bind(C, name='spintop_host')
            import :: c_char, c_int
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_host
    end interface

contains

    !> Checks that the stacks of all threads are large enough.
    subroutine check_stacks(error)
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer(int64) :: limit

        limit = c_stack_limit()
        if (limit >= 0 .and. limit < least_stack) then
            error = input_error('spintop: the stack limit is ' // kilobytes(limit) // ', but up to ' // &
                                kilobytes(least_stack) // ' are needed; raise the limit with `ulimit -s 8192`')
            return
        end if
        limit = c_thread_stack()
        if (limit >= 0 .and. limit < least_stack) then
            error = input_error('spintop: OMP_STACKSIZE gives each thread a stack of ' // kilobytes(limit) // &
                                ', but up to ' // kilobytes(least_stack) // ' are needed; unset OMP_STACKSIZE')
        end if

    contains

        function kilobytes(bytes) result(text)
            integer(int64), intent(in) :: bytes
            character(:), allocatable :: text
            text = to_text(bytes / 1024) // ' kB'
        end function kilobytes

    end subroutine check_stacks

    !> Writes a text to standard output.
    subroutine print_text(text, error)
        character(*), intent(in) :: text !! the text to write, with its line ends
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_write(standard_output, text, len(text, int64)), 'write to', 'standard output', error)
    end subroutine print_text

    !> Writes a text to standard error; a failure is ignored.
    subroutine complain_of(text)
        character(*), intent(in) :: text !! the message, with its line ends
        type(error_t), allocatable :: ignored
        call check_call(c_write(standard_error, text, len(text, int64)), 'write to', 'standard error', ignored)
    end subroutine complain_of

    !> Flushes standard output, and reports delayed errors of writing.
    subroutine end_output(error)
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_close(standard_output), 'write to', 'standard output', error)
    end subroutine end_output

    !> Sets the message that a signal prints when it ends the process: `head ROWS tail`, or only `tail` if
    !> `rows` is negative. A process has one message, for one table at a time.
    subroutine watch_signals(head, tail, rows)
        character(*), intent(in) :: head, tail !! text before and after the number of rows
        integer(int64), intent(in) :: rows !! number of kept rows; negative for a message without it
        call c_watch(head // c_null_char, tail // c_null_char, int(rows, c_long_long))
    end subroutine watch_signals

    !> Sets the message with which an invalid access to memory ends the program, with the exit code of an output error: for
    !> calls of a library that does not stand its own failures. '' ends that. In a process of somebody else it does nothing.
    subroutine expect_crash(text)
        character(*), intent(in) :: text !! the message
        call c_expect_crash(text // c_null_char)
    end subroutine expect_crash

    !> Name of the machine on which the process runs.
    function host_name() result(text)
        character(:), allocatable :: text
        character(256) :: room
        call c_host(room, len(room))
        text = up_to_null(room)
    end function host_name

    !> The name of the level in use, such as `x86-64-v3`; `as built` where all kernels have the flags of the build.
    function processor_level_name() result(name)
        character(:), allocatable :: name
        name = 'as built'
        if (c_level() > 0) name = 'x86-64-v' // to_text(int(c_level()))
    end function processor_level_name

    !> Checks that SPINTOP_LEVEL names a level of this processor, if it is set.
    subroutine check_level(error)
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: levels
        character(64) :: wanted
        integer :: length, level

        call get_environment_variable(level_variable, wanted, length)
        if (length == 0) return
        levels = ''
        do level = lowest_level, int(c_highest_level())
            if (wanted == 'v' // to_text(level)) return
            levels = levels // ', v' // to_text(level)
        end do
        if (levels == '') levels = ', none'
        error = input_error('spintop: ' // level_variable // ' is ''' // trim(wanted) // &
                            ''', but the levels of this processor are: ' // levels(3:))
    end subroutine check_level

end module spintop_process
