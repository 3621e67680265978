!> The process itself: its standard streams, its message on a signal, its limits, and how it ends.
module spintop_process
    use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long_long, c_null_char
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, input_error
    use spintop_posix, only: c_close, c_host, c_peak_memory, c_write, check_call, up_to_null
    use spintop_text, only: to_text
    implicit none
    private
    public :: begin_process, end_process, check_stacks, show_text, complain_of, end_output
    public :: watch_signals, keep_rows, watch_no_more
    public :: host_name, peak_memory

    !> Numbers of the standard streams.
    integer(c_int), parameter :: standard_output = 1, standard_error = 2

    !> Least stack of a thread, bytes: twice the 224 kB that the costliest sweep was seen to take.
    integer(int64), parameter :: least_stack = 448 * 1024

    interface
        !> Makes sure that no file replaces a closed standard stream, that a file that may not grow is an
        !> error of writing, and that signals and errors of the run-time libraries end the process as is
        !> documented. To be called once, before anything is opened.
        subroutine begin_process() bind(C, name='spintop_begin_process')
        end subroutine begin_process

        subroutine c_end_process(code) bind(C, name='spintop_end_process')
            import :: c_int
            integer(c_int), value :: code
        end subroutine c_end_process

        subroutine c_watch(head, tail, rows) bind(C, name='spintop_watch')
            import :: c_char, c_long_long
            character(c_char), intent(in) :: head(*), tail(*)
            integer(c_long_long), value :: rows
        end subroutine c_watch

        subroutine c_keep(rows) bind(C, name='spintop_keep')
            import :: c_long_long
            integer(c_long_long), value :: rows
        end subroutine c_keep

        !> Signals print no message any more.
        subroutine watch_no_more() bind(C, name='spintop_watch_no_more')
        end subroutine watch_no_more

        integer(c_long_long) function c_stack_limit() bind(C, name='spintop_stack_limit')
            import :: c_long_long
        end function c_stack_limit

        integer(c_long_long) function c_thread_stack() bind(C, name='spintop_thread_stack')
            import :: c_long_long
        end function c_thread_stack
    end interface

contains

    !> Ends the process with an exit code.
    subroutine end_process(code)
        integer, intent(in) :: code
        call c_end_process(int(code, c_int))
    end subroutine end_process

    !> Whether the stacks of all threads are large enough.
    subroutine check_stacks(error)
        type(error_t), allocatable, intent(out) :: error
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
    subroutine show_text(text, error)
        character(*), intent(in) :: text
        type(error_t), allocatable, intent(out) :: error
        call check_call(c_write(standard_output, text, len(text, int64)), 'write to', 'standard output', error)
    end subroutine show_text

    !> Writes a text to standard error; a failure is ignored.
    subroutine complain_of(text)
        character(*), intent(in) :: text
        type(error_t), allocatable :: ignored
        call check_call(c_write(standard_error, text, len(text, int64)), 'write to', 'standard error', ignored)
    end subroutine complain_of

    !> Flushes standard output: delayed errors of the system appear here.
    subroutine end_output(error)
        type(error_t), allocatable, intent(out) :: error
        call check_call(c_close(standard_output), 'write to', 'standard output', error)
    end subroutine end_output

    !> From now on a signal that ends the process prints how many rows are kept, `head ROWS tail`; where
    !> `rows` is negative, the tail only. The texts are of one process: one table at a time.
    subroutine watch_signals(head, tail, rows)
        character(*), intent(in) :: head, tail
        integer(int64), intent(in) :: rows
        call c_watch(head // c_null_char, tail // c_null_char, int(rows, c_long_long))
    end subroutine watch_signals

    !> So many rows are kept now. Any thread may call it.
    subroutine keep_rows(rows)
        integer(int64), intent(in) :: rows
        call c_keep(int(rows, c_long_long))
    end subroutine keep_rows

    !> Name of the machine on which the process runs.
    function host_name() result(text)
        character(:), allocatable :: text
        character(256) :: room
        call c_host(room, len(room))
        text = up_to_null(room)
    end function host_name

    !> Most memory that the process has held so far, bytes.
    integer(int64) function peak_memory()
        peak_memory = c_peak_memory()
    end function peak_memory

end module spintop_process
