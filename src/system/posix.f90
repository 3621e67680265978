!> Interfaces of the functions of posix.c. Those that can fail return 0, or a number from which `check_call`
!> makes an error.
module spintop_posix
    use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long_long, c_null_char
    use spintop_errors, only: error_t, output_error
    use spintop_exit_codes, only: exit_input
    implicit none
    private
    public :: c_open, c_open_own, c_open_locked, c_remove_lock_file, c_check_target, c_check_written, &
        c_write, c_read, c_sync, c_sync_folder, c_truncate, c_close, c_rename, &
        c_remove, c_remove_folder, c_make_folder, c_make_private_folder, c_inspect, c_is_same_file, c_is_terminal, check_call, &
        up_to_null

    interface
        !> Opens a file for reading; with `only_regular` (nonzero) anything but a regular file is an error.
        integer(c_int) function c_open(path, only_regular, file) bind(C, name='spintop_open')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
            integer(c_int), value :: only_regular !! nonzero: a FIFO or a device, which may never answer, is an error
            integer(c_int), intent(out) :: file !! file descriptor
        end function c_open

        !> Opens a file for appending, and creates it if it is missing. Links and special files are errors.
        integer(c_int) function c_open_own(path, file) bind(C, name='spintop_open_own')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
            integer(c_int), intent(out) :: file !! file descriptor
        end function c_open_own

        !> The same, and locks the file until it is closed.
        integer(c_int) function c_open_locked(path, file) bind(C, name='spintop_open_locked')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
            integer(c_int), intent(out) :: file !! file descriptor
        end function c_open_locked

        !> Removes the file that was made in place of a lock, if one was made.
        subroutine c_remove_lock_file(path) bind(C, name='spintop_remove_lock_file')
            import :: c_char
            character(c_char), intent(in) :: path(*) !! path of the locked file, terminated by a null character
        end subroutine c_remove_lock_file

        !> Checks that a file may be replaced: that it is no device and no FIFO.
        integer(c_int) function c_check_target(path) bind(C, name='spintop_check_target')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
        end function c_check_target

        !> Checks that an open file still has its name and its size.
        integer(c_int) function c_check_written(file, path, size) bind(C, name='spintop_check_written')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file !! file descriptor
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
            integer(c_long_long), value :: size !! bytes written; -1 if they are not known
        end function c_check_written

        !> Writes `count` bytes.
        integer(c_int) function c_write(file, bytes, count) bind(C, name='spintop_write')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file !! file descriptor
            character(c_char), intent(in) :: bytes(*) !! the bytes
            integer(c_long_long), value :: count !! number of bytes
        end function c_write

        !> Reads up to `room` bytes; fewer only at the end of the file.
        integer(c_int) function c_read(file, bytes, room, count) bind(C, name='spintop_read')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file !! file descriptor
            character(c_char), intent(inout) :: bytes(*) !! the bytes
            integer(c_long_long), value :: room !! maximum number of bytes
            integer(c_long_long), intent(out) :: count !! number of bytes that were read
        end function c_read

        !> Waits until the written bytes are on the disk.
        integer(c_int) function c_sync(file) bind(C, name='spintop_sync')
            import :: c_int
            integer(c_int), value :: file !! file descriptor
        end function c_sync

        !> Waits until the entries of a folder are on the disk.
        integer(c_int) function c_sync_folder(path) bind(C, name='spintop_sync_folder')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
        end function c_sync_folder

        !> Truncates a file to a size in bytes.
        integer(c_int) function c_truncate(file, size) bind(C, name='spintop_truncate')
            import :: c_int, c_long_long
            integer(c_int), value :: file !! file descriptor
            integer(c_long_long), value :: size !! size in bytes
        end function c_truncate

        !> Closes a file.
        integer(c_int) function c_close(file) bind(C, name='spintop_close')
            import :: c_int
            integer(c_int), value :: file !! file descriptor
        end function c_close

        !> Renames a file; an existing file of the new name is replaced.
        integer(c_int) function c_rename(from, to) bind(C, name='spintop_rename')
            import :: c_char, c_int
            character(c_char), intent(in) :: from(*), to(*) !! old and new path, terminated by a null character
        end function c_rename

        !> Removes a file.
        integer(c_int) function c_remove(path) bind(C, name='spintop_remove')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
        end function c_remove

        !> Removes a folder and the files in it.
        integer(c_int) function c_remove_folder(path) bind(C, name='spintop_remove_folder')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
        end function c_remove_folder

        !> Makes a folder that no other process has.
        integer(c_int) function c_make_private_folder(path) bind(C, name='spintop_make_private_folder')
            import :: c_char, c_int
            character(c_char), intent(inout) :: path(*) !! ends with XXXXXX, which become its name, and a null character
        end function c_make_private_folder

        !> Creates a folder.
        integer(c_int) function c_make_folder(path) bind(C, name='spintop_make_folder')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
        end function c_make_folder

        !> Size in bytes, or -1 if the file does not exist; and whether it is a folder.
        subroutine c_inspect(path, size, is_folder) bind(C, name='spintop_inspect')
            import :: c_char, c_int, c_long_long
            character(c_char), intent(in) :: path(*) !! path, terminated by a null character
            integer(c_long_long), intent(out) :: size !! size in bytes; -1 if there is no such file
            integer(c_int), intent(out) :: is_folder !! nonzero for a folder
        end subroutine c_inspect

        !> Nonzero if two paths name one file, which exists.
        integer(c_int) function c_is_same_file(a, b) bind(C, name='spintop_is_same_file')
            import :: c_char, c_int
            character(c_char), intent(in) :: a(*), b(*) !! the paths, terminated by null characters
        end function c_is_same_file

        !> Nonzero if the file is a terminal.
        integer(c_int) function c_is_terminal(file) bind(C, name='spintop_is_terminal')
            import :: c_int
            integer(c_int), value :: file !! file descriptor
        end function c_is_terminal

        !> Message for a number that one of these functions returned, terminated by a null character.
        subroutine c_reason(number, text, room) bind(C, name='spintop_reason')
            import :: c_char, c_int
            integer(c_int), value :: number
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_reason
    end interface

contains

    !> Makes an error of a nonzero returned number: an input error if `reading`, else an output error.
    subroutine check_call(number, action, path, error, reading)
        integer(c_int), intent(in) :: number         !! what a function of posix.c returned
        character(*), intent(in) :: action, path     !! for the message: cannot ACTION PATH
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: reading !! whether the call was one of reading
        ! This is also called by threads: see `status_names` in spintop_status.
        character(256) :: reason
        if (number == 0) return
        call c_reason(number, reason, len(reason))
        error = output_error('cannot ' // action // ' ' // path // ': ' // up_to_null(reason))
        if (.not. present(reading)) return
        if (reading) error%code = exit_input
    end subroutine check_call

    !> The text before the first null character, or all of it.
    pure function up_to_null(room) result(text)
        character(*), intent(in) :: room !! characters, terminated by a null character
        character(:), allocatable :: text
        text = room(:index(room // c_null_char, c_null_char) - 1)
    end function up_to_null

end module spintop_posix
