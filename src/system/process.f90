!> The process: its processor, its clock, messages on signals, limits, and its end.
module spintop_process
    use, intrinsic :: iso_c_binding, only: c_bool, c_char, c_double, c_int, c_long_long, c_null_char
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, input_error
    use spintop_text, only: to_text
    implicit none
    private
    public :: begin_process, end_process, check_stacks, seconds, processor_seconds, pause_for
    public :: watch_signals, keep_rows, stop_watching_signals, set_journal_thread, end_is_wanted, end_by_signal
    public :: expect_crash, leave_libraries
    public :: peak_memory, physical_memory, check_level, processor_level_name

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

        real(c_double) function c_time() bind(C)
            import :: c_double
        end function c_time
    end interface

    !> Opens closed standard streams, so that no other file takes their numbers; makes an exceeded file-size limit an error of
    !> writing; and installs the handlers of signals and of errors of the run-time libraries. To be called once, before any
    !> file is opened.
    procedure(c_command), bind(C, name='spintop_begin_process') :: begin_process
    !> Ends the process by the signal that wants it to end.
    procedure(c_command), bind(C, name='spintop_end_by_signal') :: end_by_signal
    !> At its end the process does nothing more in its libraries: one of them is in a state that it does not expect.
    procedure(c_command), bind(C, name='spintop_leave_libraries') :: leave_libraries
    !> Time of a monotonic clock, s; and processor time of the calling thread, without the time that other programs take.
    procedure(c_time), bind(C, name='spintop_seconds') :: seconds
    procedure(c_time), bind(C, name='spintop_processor_seconds') :: processor_seconds
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

        !> Suspends the calling thread, so that others can use the processor.
        subroutine pause_for(seconds) bind(C, name='spintop_pause')
            import :: c_double
            real(c_double), value :: seconds !! length of the pause, s
        end subroutine pause_for
    end interface

contains

    !> Checks that the stacks of all threads are large enough.
    subroutine check_stacks(error)
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_stack(c_thread_stack(), 'OMP_STACKSIZE gives each thread a stack of ', 'unset OMP_STACKSIZE')
        call check_stack(c_stack_limit(), 'the stack limit is ', 'raise the limit with `ulimit -s 8192`')

    contains

        subroutine check_stack(bytes, what, remedy)
            integer(int64), intent(in) :: bytes
            character(*), intent(in) :: what, remedy
            if (bytes >= 0 .and. bytes < least_stack) error = input_error('spintop: ' // what // to_text(bytes / 1024) // &
                ' kB, but up to ' // to_text(least_stack / 1024) // ' kB are needed; ' // remedy)
        end subroutine check_stack

    end subroutine check_stacks

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
        error = input_error('spintop: ' // level_variable // ' is ''' // wanted(:min(length, len(wanted))) // &
                            ''', but the levels of this processor are: ' // levels(3:))
    end subroutine check_level

end module spintop_process
