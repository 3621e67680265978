!> The functions of posix.c. Those that can fail return 0, or a number of which `check_call` makes an error.
module spintop_posix
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_long_long, c_null_char
    use spintop_errors, only: error_t, exit_input, output_error
    implicit none
    private
    public :: c_open, c_open_locked, c_write, c_read, c_sync, c_sync_folder, c_truncate, c_close, c_rename, &
        c_remove, c_make_folder, c_inspect, c_is_terminal, c_seconds, c_pause, c_utc, &
        c_host, c_peak_memory, check_call, up_to_null

    interface
        !> Opens a file for reading.
        integer(c_int) function c_open(path, file) bind(C, name='spintop_open')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
            integer(c_int), intent(out) :: file
        end function c_open

        !> Opens a file for writing at its end, makes it where it is missing, and locks it until it is closed.
        integer(c_int) function c_open_locked(path, file) bind(C, name='spintop_open_locked')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
            integer(c_int), intent(out) :: file
        end function c_open_locked

        !> Writes so many bytes.
        integer(c_int) function c_write(file, bytes, count) bind(C, name='spintop_write')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file
            character(c_char), intent(in) :: bytes(*)
            integer(c_long_long), value :: count
        end function c_write

        !> Reads until the end of the file or until the room is full.
        integer(c_int) function c_read(file, bytes, room, count) bind(C, name='spintop_read')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file
            character(c_char), intent(inout) :: bytes(*)
            integer(c_long_long), value :: room
            integer(c_long_long), intent(out) :: count
        end function c_read

        !> Returns when what was written is on the disk.
        integer(c_int) function c_sync(file) bind(C, name='spintop_sync')
            import :: c_int
            integer(c_int), value :: file
        end function c_sync

        !> Returns when the names in a folder are on the disk.
        integer(c_int) function c_sync_folder(path) bind(C, name='spintop_sync_folder')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
        end function c_sync_folder

        !> Cuts a file to a size, bytes.
        integer(c_int) function c_truncate(file, size) bind(C, name='spintop_truncate')
            import :: c_int, c_long_long
            integer(c_int), value :: file
            integer(c_long_long), value :: size
        end function c_truncate

        !> Closes a file.
        integer(c_int) function c_close(file) bind(C, name='spintop_close')
            import :: c_int
            integer(c_int), value :: file
        end function c_close

        !> Gives a file another name; one of that name is replaced.
        integer(c_int) function c_rename(from, to) bind(C, name='spintop_rename')
            import :: c_char, c_int
            character(c_char), intent(in) :: from(*), to(*)
        end function c_rename

        !> Removes a file.
        integer(c_int) function c_remove(path) bind(C, name='spintop_remove')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
        end function c_remove

        !> Makes a folder.
        integer(c_int) function c_make_folder(path) bind(C, name='spintop_make_folder')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
        end function c_make_folder

        !> Size in bytes, -1 where there is nothing of that name, and whether it is a folder.
        subroutine c_inspect(path, size, is_folder) bind(C, name='spintop_inspect')
            import :: c_char, c_int, c_long_long
            character(c_char), intent(in) :: path(*)
            integer(c_long_long), intent(out) :: size
            integer(c_int), intent(out) :: is_folder
        end subroutine c_inspect

        !> Not 0 for a file that is a terminal.
        integer(c_int) function c_is_terminal(file) bind(C, name='spintop_is_terminal')
            import :: c_int
            integer(c_int), value :: file
        end function c_is_terminal

        !> A monotonic clock, s.
        real(c_double) function c_seconds() bind(C, name='spintop_seconds')
            import :: c_double
        end function c_seconds

        !> Waits, s.
        subroutine c_pause(seconds) bind(C, name='spintop_pause')
            import :: c_double
            real(c_double), value :: seconds
        end subroutine c_pause

        !> Date and time (UTC), ended by a zero byte.
        subroutine c_utc(text, room) bind(C, name='spintop_utc')
            import :: c_char, c_int
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_utc

        !> Name of this machine, ended by a zero byte.
        subroutine c_host(text, room) bind(C, name='spintop_host')
            import :: c_char, c_int
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_host

        !> Peak memory of the program, bytes.
        integer(c_long_long) function c_peak_memory() bind(C, name='spintop_peak_memory')
            import :: c_long_long
        end function c_peak_memory

        !> What a number returned by one of these means, ended by a zero byte.
        subroutine c_reason(number, text, room) bind(C, name='spintop_reason')
            import :: c_char, c_int
            integer(c_int), value :: number
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_reason
    end interface

contains

    !> Makes an error of a returned number that is not 0: an output error unless it came in reading.
    subroutine check_call(number, action, path, error, reading)
        integer(c_int), intent(in) :: number         !! what a function of posix.c returned
        character(*), intent(in) :: action, path     !! for the message: cannot ACTION PATH
        type(error_t), allocatable, intent(out) :: error
        logical, intent(in), optional :: reading
        ! Threads write, too: see `status_names` in spintop_status.
        character(256) :: reason
        if (number == 0) return
        call c_reason(number, reason, len(reason))
        error = output_error('cannot ' // action // ' ' // path // ': ' // up_to_null(reason))
        if (present(reading)) error%code = exit_input
    end subroutine check_call

    !> The text before the zero byte that ends it, or all of it.
    pure function up_to_null(room) result(text)
        character(*), intent(in) :: room
        character(:), allocatable :: text
        text = room(:index(room // c_null_char, c_null_char) - 1)
    end function up_to_null

end module spintop_posix
