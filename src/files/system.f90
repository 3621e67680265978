!> The operating system: files that are surely written, folders, clocks, the terminal.
module spintop_system
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_long_long, c_null_char
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, input_error, output_error
    use spintop_kinds, only: dp
    implicit none
    private
    public :: output_file_t, read_file, file_exists, is_folder, file_size
    public :: make_folder, rename_file, remove_file, sync_folder_of
    public :: error_is_terminal, seconds, pause_for, utc_now, host_name, peak_memory

    integer, parameter :: standard_error = 2
    integer, parameter :: no_file = -1

    !> A file open for writing. It must be closed: that is when the last errors show.
    type :: output_file_t
        character(:), allocatable :: path
        integer(c_int), private :: descriptor = no_file
    contains
        procedure :: create
        procedure :: reopen
        procedure :: write => write_bytes
        procedure :: truncate
        procedure :: sync
        procedure :: close => close_file
        procedure :: is_open
    end type output_file_t

    interface
        integer(c_int) function c_open(path, for_writing, file) bind(C, name='spintop_open')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
            integer(c_int), value :: for_writing
            integer(c_int), intent(out) :: file
        end function c_open

        integer(c_int) function c_reopen(path, file) bind(C, name='spintop_reopen')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
            integer(c_int), intent(out) :: file
        end function c_reopen

        integer(c_int) function c_write(file, bytes, count) bind(C, name='spintop_write')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file
            character(c_char), intent(in) :: bytes(*)
            integer(c_long_long), value :: count
        end function c_write

        integer(c_int) function c_read(file, bytes, room, count) bind(C, name='spintop_read')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file
            character(c_char), intent(inout) :: bytes(*)
            integer(c_long_long), value :: room
            integer(c_long_long), intent(out) :: count
        end function c_read

        integer(c_int) function c_sync(file) bind(C, name='spintop_sync')
            import :: c_int
            integer(c_int), value :: file
        end function c_sync

        integer(c_int) function c_truncate(file, size) bind(C, name='spintop_truncate')
            import :: c_int, c_long_long
            integer(c_int), value :: file
            integer(c_long_long), value :: size
        end function c_truncate

        integer(c_int) function c_close(file) bind(C, name='spintop_close')
            import :: c_int
            integer(c_int), value :: file
        end function c_close

        integer(c_int) function c_rename(from, to) bind(C, name='spintop_rename')
            import :: c_char, c_int
            character(c_char), intent(in) :: from(*), to(*)
        end function c_rename

        integer(c_int) function c_remove(path) bind(C, name='spintop_remove')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
        end function c_remove

        integer(c_int) function c_make_folder(path) bind(C, name='spintop_make_folder')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
        end function c_make_folder

        subroutine c_inspect(path, size, is_folder) bind(C, name='spintop_inspect')
            import :: c_char, c_int, c_long_long
            character(c_char), intent(in) :: path(*)
            integer(c_long_long), intent(out) :: size
            integer(c_int), intent(out) :: is_folder
        end subroutine c_inspect

        integer(c_int) function c_is_terminal(file) bind(C, name='spintop_is_terminal')
            import :: c_int
            integer(c_int), value :: file
        end function c_is_terminal

        real(c_double) function c_seconds() bind(C, name='spintop_seconds')
            import :: c_double
        end function c_seconds

        subroutine c_pause(seconds) bind(C, name='spintop_pause')
            import :: c_double
            real(c_double), value :: seconds
        end subroutine c_pause

        subroutine c_utc(text, room) bind(C, name='spintop_utc')
            import :: c_char, c_int
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_utc

        subroutine c_host(text, room) bind(C, name='spintop_host')
            import :: c_char, c_int
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_host

        integer(c_long_long) function c_peak_memory() bind(C, name='spintop_peak_memory')
            import :: c_long_long
        end function c_peak_memory

        subroutine c_reason(number, text, room) bind(C, name='spintop_reason')
            import :: c_char, c_int
            integer(c_int), value :: number
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_reason
    end interface

contains

    !> Makes an empty file, or empties the one that is there.
    subroutine create(self, path, error)
        class(output_file_t), intent(inout) :: self
        character(*), intent(in) :: path
        type(error_t), allocatable, intent(out) :: error
        self%path = path
        call check(c_open(path // c_null_char, 1_c_int, self%descriptor), 'create', path, error)
    end subroutine create

    !> Opens a file that is there, to write at its end.
    subroutine reopen(self, path, error)
        class(output_file_t), intent(inout) :: self
        character(*), intent(in) :: path
        type(error_t), allocatable, intent(out) :: error
        self%path = path
        call check(c_reopen(path // c_null_char, self%descriptor), 'open', path, error)
    end subroutine reopen

    !> Writes all of a text.
    subroutine write_bytes(self, text, error)
        class(output_file_t), intent(in) :: self
        character(*), intent(in) :: text
        type(error_t), allocatable, intent(out) :: error
        call check(c_write(self%descriptor, text, len(text, int64)), 'write', self%path, error)
    end subroutine write_bytes

    !> Cuts the file to a size in bytes.
    subroutine truncate(self, size, error)
        class(output_file_t), intent(in) :: self
        integer(int64), intent(in) :: size
        type(error_t), allocatable, intent(out) :: error
        call check(c_truncate(self%descriptor, size), 'truncate', self%path, error)
    end subroutine truncate

    !> Waits until what was written is on the disk.
    subroutine sync(self, error)
        class(output_file_t), intent(in) :: self
        type(error_t), allocatable, intent(out) :: error
        call check(c_sync(self%descriptor), 'write', self%path, error)
    end subroutine sync

    subroutine close_file(self, error)
        class(output_file_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        if (.not. self%is_open()) return
        call check(c_close(self%descriptor), 'write', self%path, error)
        self%descriptor = no_file
    end subroutine close_file

    pure logical function is_open(self)
        class(output_file_t), intent(in) :: self
        is_open = self%descriptor >= 0
    end function is_open

    !> Waits until the entry of a file in its folder is on the disk.
    subroutine sync_folder_of(path, error)
        character(*), intent(in) :: path
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: folder
        integer(c_int) :: descriptor, status, ignored

        folder = path(:index(path, '/', back=.true.)) // '.'
        status = c_open(folder // c_null_char, 0_c_int, descriptor)
        if (status == 0) then
            status = c_sync(descriptor)
            ignored = c_close(descriptor)
        end if
        call check(status, 'write to folder', folder, error)
    end subroutine sync_folder_of

    !> Renames a file; one that had the new name is gone.
    subroutine rename_file(from, to, error)
        character(*), intent(in) :: from, to
        type(error_t), allocatable, intent(out) :: error
        call check(c_rename(from // c_null_char, to // c_null_char), 'create', to, error)
    end subroutine rename_file

    subroutine remove_file(path, error)
        character(*), intent(in) :: path
        type(error_t), allocatable, intent(out) :: error
        call check(c_remove(path // c_null_char), 'remove', path, error)
    end subroutine remove_file

    !> Makes a folder and those above it, where they are missing.
    subroutine make_folder(path, error)
        character(*), intent(in) :: path
        type(error_t), allocatable, intent(out) :: error
        integer :: i
        integer(c_int) :: status

        status = 0
        do i = 2, len(path) + 1
            if (i <= len(path)) then
                if (path(i:i) /= '/') cycle
            end if
            if (is_folder(path(:i - 1))) cycle
            status = c_make_folder(path(:i - 1) // c_null_char)
            ! Another process may have been faster.
            if (is_folder(path(:i - 1))) status = 0
            if (status /= 0) exit
        end do
        call check(status, 'make folder', path, error)
    end subroutine make_folder

    !> Reads a whole file, or all that a pipe gives, of at most `limit` bytes. Its errors are
    !> input errors.
    subroutine read_file(path, limit, text, error)
        character(*), intent(in) :: path
        integer, intent(in) :: limit
        character(:), allocatable, intent(out) :: text
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: block, more
        integer, parameter :: first_room = 65536
        integer(c_int) :: descriptor, status, ignored
        integer(c_long_long) :: got
        integer :: length

        text = ''
        if (is_folder(path)) then
            error = input_error('cannot read ' // path // ': it is a folder')
            return
        end if
        status = c_open(path // c_null_char, 0_c_int, descriptor)
        length = 0
        if (status == 0) then
            allocate (character(first_room) :: block)
            do
                status = c_read(descriptor, block(length + 1:), int(len(block) - length, c_long_long), &
                    got)
                length = length + int(got)
                if (status /= 0 .or. length < len(block) .or. length > limit) exit
                allocate (character(2 * len(block)) :: more)
                more(:length) = block
                call move_alloc(more, block)
            end do
            ignored = c_close(descriptor)
        end if
        if (status /= 0) then
            error = input_error('cannot read ' // path // ': ' // reason(status))
        else if (length > limit) then
            error = input_error('cannot read ' // path // ': it is too large for an input')
        else
            text = block(:length)
        end if
    end subroutine read_file

    logical function file_exists(path)
        character(*), intent(in) :: path
        file_exists = file_size(path) >= 0
    end function file_exists

    !> Size in bytes; -1 if there is nothing of that name.
    integer(int64) function file_size(path)
        character(*), intent(in) :: path
        integer(c_int) :: folder
        call c_inspect(path // c_null_char, file_size, folder)
    end function file_size

    logical function is_folder(path)
        character(*), intent(in) :: path
        integer(c_long_long) :: size
        integer(c_int) :: folder
        call c_inspect(path // c_null_char, size, folder)
        is_folder = folder /= 0
    end function is_folder

    !> Whether standard error is a terminal.
    logical function error_is_terminal()
        error_is_terminal = c_is_terminal(int(standard_error, c_int)) /= 0
    end function error_is_terminal

    !> Seconds of a clock that never goes back.
    real(dp) function seconds()
        seconds = c_seconds()
    end function seconds

    !> Lets others have the processor for so many seconds.
    subroutine pause_for(seconds)
        real(dp), intent(in) :: seconds
        call c_pause(seconds)
    end subroutine pause_for

    !> Date and time: `2024-05-31T12:34:56Z`.
    function utc_now() result(text)
        character(:), allocatable :: text
        character(64) :: room
        call c_utc(room, len(room))
        text = up_to_null(room)
    end function utc_now

    !> Name of this machine.
    function host_name() result(text)
        character(:), allocatable :: text
        character(256) :: room
        call c_host(room, len(room))
        text = up_to_null(room)
    end function host_name

    !> Most bytes of memory held so far.
    integer(int64) function peak_memory()
        peak_memory = c_peak_memory()
    end function peak_memory

    !> Makes an output error of a status that is not 0.
    subroutine check(status, action, path, error)
        integer(c_int), intent(in) :: status
        character(*), intent(in) :: action, path
        type(error_t), allocatable, intent(out) :: error
        if (status /= 0) error = output_error('cannot ' // action // ' ' // path // ': ' // &
            reason(status))
    end subroutine check

    !> What the system says of an error number.
    function reason(number) result(text)
        integer(c_int), intent(in) :: number
        character(:), allocatable :: text
        character(256) :: room
        call c_reason(number, room, len(room))
        text = up_to_null(room)
    end function reason

    pure function up_to_null(room) result(text)
        character(*), intent(in) :: room
        character(:), allocatable :: text
        text = room(:index(room // c_null_char, c_null_char) - 1)
    end function up_to_null

end module spintop_system
