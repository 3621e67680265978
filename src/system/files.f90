!> Files, folders and standard streams: reading, and writing with confirmation that the data are on the disk.
module spintop_files
    use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long_long, c_null_char
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, exit_input, input_error, output_error
    implicit none
    private
    public :: input_file_t, output_file_t, read_file, replace_file, file_exists, is_folder, is_same_file, file_size, path_from
    public :: check_target, sync_file, make_folder, make_private_folder, remove_folder, rename_file, remove_file, sync_folder_of
    public :: print_text, complain_of, end_output, utc_now, host_name

    !> Where a file is sought that an input names.
    character(*), parameter, public :: beside_input = 'its path is relative to the folder of the input, or of the table that &
        &has the input in its header'

    integer, parameter :: no_file = -1
    !> Numbers of the standard streams.
    integer(c_int), parameter :: standard_output = 1, standard_error = 2
    !> Characters of a text that posix.c makes, at most, with the null character behind it.
    integer, parameter :: room_of_text = 4096

    !> A file open for reading, from its beginning.
    type :: input_file_t
        character(:), allocatable :: path
        integer(c_int), private :: descriptor = no_file
        !> Whether it is a text of any system, whether its beginning is to be read, and whether its lines end in CR LF.
        logical, private :: is_text = .false., is_new = .true., has_returns = .false.
    contains
        procedure :: open => open_input
        procedure :: read => read_bytes
        procedure :: close => close_input
    end type input_file_t

    !> A file open for appending: a regular file with this name only, so that nothing elsewhere is changed. It must be
    !> closed, because the system may report an error of writing only then.
    type :: output_file_t
        character(:), allocatable :: path
        integer(c_int), private :: descriptor = no_file
    contains
        procedure :: open => open_output
        procedure :: create
        procedure :: write => write_bytes
        procedure :: truncate
        procedure :: sync
        procedure :: finish_as
        procedure :: close => close_file
        procedure :: discard => discard_file
        procedure :: is_open
    end type output_file_t

    ! Functions of posix.c, which describes them. Those that can fail return 0, or a number from which `check_call` makes an
    ! error. Paths end with a null character. Numbers of files and of bytes are passed by reference, so that functions with the
    ! same arguments have one interface: gfortran 12 may pass values by reference to what is declared by an abstract interface.
    abstract interface
        integer(c_int) function c_on_path(path) bind(C)
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
        end function c_on_path

        integer(c_int) function c_on_paths(path, other) bind(C)
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*), other(*)
        end function c_on_paths

        integer(c_int) function c_opening(path, file) bind(C)
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
            integer(c_int), intent(out) :: file
        end function c_opening

        integer(c_int) function c_on_file(file) bind(C)
            import :: c_int
            integer(c_int), intent(in) :: file
        end function c_on_file

        integer(c_int) function c_on_bytes(file, bytes, count) bind(C)
            import :: c_char, c_int, c_long_long
            integer(c_int), intent(in) :: file
            character(c_char), intent(in) :: bytes(*)
            integer(c_long_long), intent(in) :: count
        end function c_on_bytes

        integer(c_int) function c_saying(text) bind(C)
            import :: c_char, c_int
            character(c_char), intent(inout) :: text(*) !! room for `room_of_text` characters
        end function c_saying
    end interface

    procedure(c_on_path), bind(C, name='spintop_check_target') :: c_check_target
    procedure(c_on_path), bind(C, name='spintop_sync_folder') :: c_sync_folder
    procedure(c_on_path), bind(C, name='spintop_remove') :: c_remove
    procedure(c_on_path), bind(C, name='spintop_remove_folder') :: c_remove_folder
    procedure(c_on_path), bind(C, name='spintop_make_folder') :: c_make_folder
    procedure(c_on_path), bind(C, name='spintop_is_folder') :: c_is_folder
    procedure(c_on_paths), bind(C, name='spintop_rename') :: c_rename
    procedure(c_on_paths), bind(C, name='spintop_is_same_file') :: c_is_same_file
    procedure(c_opening), bind(C, name='spintop_open') :: c_open
    procedure(c_opening), bind(C, name='spintop_open_regular') :: c_open_regular
    procedure(c_opening), bind(C, name='spintop_open_own') :: c_open_own
    procedure(c_opening), bind(C, name='spintop_open_locked') :: c_open_locked
    procedure(c_on_file), bind(C, name='spintop_sync') :: c_sync
    procedure(c_on_file), bind(C, name='spintop_close') :: c_close
    procedure(c_on_bytes), bind(C, name='spintop_write') :: c_write
    procedure(c_on_bytes), bind(C, name='spintop_check_written') :: c_check_written
    procedure(c_saying), bind(C, name='spintop_private_folder') :: c_private_folder
    procedure(c_saying), bind(C, name='spintop_utc') :: c_utc
    procedure(c_saying), bind(C, name='spintop_host') :: c_host

    interface
        integer(c_int) function c_read(file, bytes, room, count) bind(C, name='spintop_read')
            import :: c_char, c_int, c_long_long
            integer(c_int), value :: file
            character(c_char), intent(inout) :: bytes(*)
            integer(c_long_long), value :: room
            integer(c_long_long), intent(out) :: count
        end function c_read

        integer(c_int) function c_truncate(file, size) bind(C, name='spintop_truncate')
            import :: c_int, c_long_long
            integer(c_int), value :: file
            integer(c_long_long), value :: size
        end function c_truncate

        integer(c_long_long) function c_file_size(path) bind(C, name='spintop_file_size')
            import :: c_char, c_long_long
            character(c_char), intent(in) :: path(*)
        end function c_file_size

        subroutine c_reason(number, text, room) bind(C, name='spintop_reason')
            import :: c_char, c_int
            integer(c_int), value :: number, room
            character(c_char), intent(inout) :: text(*)
        end subroutine c_reason

        subroutine c_remove_lock_file(path) bind(C, name='spintop_remove_lock_file')
            import :: c_char
            character(c_char), intent(in) :: path(*)
        end subroutine c_remove_lock_file
    end interface

contains

    !> Writes a text to standard output.
    subroutine print_text(text, error)
        character(*), intent(in) :: text !! the text to write, with its line ends
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_write(standard_output, text, len(text, int64)), 'write to', 'standard output', error)
    end subroutine print_text

    !> Writes a text to standard error; a failure is ignored.
    subroutine complain_of(text)
        character(*), intent(in) :: text !! the message, with its line ends
        integer(c_int) :: ignored
        ignored = c_write(standard_error, text, len(text, int64))
    end subroutine complain_of

    !> Flushes standard output, and reports delayed errors of writing.
    subroutine end_output(error)
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_close(standard_output), 'write to', 'standard output', error)
    end subroutine end_output

    !> Opens a file for appending, creates it if it is missing, and locks it: it is an error if another run has it open.
    subroutine open_output(self, path, error)
        class(output_file_t), intent(inout) :: self
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%path = path
        call check_call(c_open_locked(path // c_null_char, self%descriptor), 'write', path, error)
    end subroutine open_output

    !> Creates an empty file, or empties an existing one. It is not locked.
    subroutine create(self, path, error)
        class(output_file_t), intent(inout) :: self
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%path = path
        call check_call(c_open_own(path // c_null_char, self%descriptor), 'write', path, error)
        if (.not. allocated(error)) call self%truncate(0_int64, error)
    end subroutine create

    !> Appends a text.
    subroutine write_bytes(self, text, error)
        class(output_file_t), intent(in) :: self
        character(*), intent(in) :: text !! the bytes to append
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_write(self%descriptor, text, len(text, int64)), 'write', self%path, error)
    end subroutine write_bytes

    !> Truncates the file to a size in bytes.
    subroutine truncate(self, size, error)
        class(output_file_t), intent(in) :: self
        integer(int64), intent(in) :: size !! size in bytes
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_truncate(self%descriptor, size), 'truncate', self%path, error)
    end subroutine truncate

    !> Waits until the written bytes are on the disk.
    subroutine sync(self, error)
        class(output_file_t), intent(in) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_sync(self%descriptor), 'write', self%path, error)
    end subroutine sync

    !> Renames the file when it is on the disk, and closes it. What another program has changed meanwhile is not renamed.
    subroutine finish_as(self, path, size, error)
        class(output_file_t), intent(inout) :: self
        character(*), intent(in) :: path !! new path; a file that is there is replaced
        integer(int64), intent(in) :: size !! bytes of the file; -1 if they are not known
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%sync(error)
        if (.not. allocated(error)) call check_call(c_check_written(self%descriptor, self%path // c_null_char, size), &
                                                    'finish', self%path, error)
        ! Renamed before it is closed: otherwise another run might lock and empty it under its new name.
        if (.not. allocated(error)) call rename_file(self%path, path, error)
        if (.not. allocated(error)) call self%close(error)
        if (.not. allocated(error)) call sync_folder_of(path, error)
    end subroutine finish_as

    !> Closes the file, and reports delayed errors of writing.
    subroutine close_file(self, error)
        class(output_file_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (.not. self%is_open()) return
        call check_call(c_close(self%descriptor), 'write', self%path, error)
        call c_remove_lock_file(self%path // c_null_char)
        self%descriptor = no_file
    end subroutine close_file

    !> Closes the file and removes it, unless another one has its name now.
    subroutine discard_file(self)
        class(output_file_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        if (.not. self%is_open()) return
        if (c_check_written(self%descriptor, self%path // c_null_char, -1_int64) == 0) call remove_file(self%path, ignored)
        call self%close(ignored)
    end subroutine discard_file

    !> Whether the file is open.
    pure logical function is_open(self)
        class(output_file_t), intent(in) :: self
        is_open = self%descriptor >= 0
    end function is_open

    !> Waits until the directory entry of a file is on the disk.
    subroutine sync_folder_of(path, error)
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: folder
        folder = path(:index(path, '/', back=.true.)) // '.'
        call check_call(c_sync_folder(folder // c_null_char), 'write to folder', folder, error)
    end subroutine sync_folder_of

    !> Waits until a file that was closed, and its name, are on the disk.
    subroutine sync_file(path, error)
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(output_file_t) :: file
        type(error_t), allocatable :: problem
        file%path = path
        call check_call(c_open_own(path // c_null_char, file%descriptor), 'write', path, error)
        if (.not. allocated(error)) call file%sync(error)
        call file%close(problem)
        if (.not. allocated(error)) call move_alloc(problem, error)
        if (.not. allocated(error)) call sync_folder_of(path, error)
    end subroutine sync_file

    !> An error if a file of that name is a folder, a device or a FIFO, which no file may replace.
    subroutine check_target(path, error)
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated if it may be created or replaced
        call check_call(c_check_target(path // c_null_char), 'create', path, error)
        if (is_folder(path)) error = output_error('cannot create ' // path // ': it is a folder')
    end subroutine check_target

    !> Renames a file; an existing file of the new name is replaced.
    subroutine rename_file(from, to, error)
        character(*), intent(in) :: from, to !! old and new path
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_rename(from // c_null_char, to // c_null_char), 'create', to, error)
    end subroutine rename_file

    !> Removes a file.
    subroutine remove_file(path, error)
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_remove(path // c_null_char), 'remove', path, error)
    end subroutine remove_file

    !> Removes a folder and the files in it.
    subroutine remove_folder(path, error)
        character(*), intent(in) :: path !! path of the folder
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call check_call(c_remove_folder(path // c_null_char), 'remove', path, error)
    end subroutine remove_folder

    !> Makes a new folder for files that are soon removed, in TMPDIR or in /tmp. No other process has it.
    subroutine make_private_folder(path, error)
        character(:), allocatable, intent(out) :: path !! path of the folder
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(room_of_text) :: room
        integer(c_int) :: status
        status = c_private_folder(room)
        path = up_to_null(room)
        call check_call(status, 'make a folder in', path(:index(path, '/', back=.true.) - 1), error)
    end subroutine make_private_folder

    !> Creates a folder and its missing parents, and waits until they are on the disk.
    subroutine make_folder(path, error)
        character(*), intent(in) :: path !! path of the folder
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: i
        integer(c_int) :: status

        status = 0
        do i = 2, len(path) + 1
            if (i <= len(path)) then
                if (path(i:i) /= '/') cycle
            end if
            if (is_folder(path(:i - 1))) cycle
            status = c_make_folder(path(:i - 1) // c_null_char)
            ! Another process may have created the folder meanwhile.
            if (is_folder(path(:i - 1))) status = 0
            if (status /= 0) exit
            call sync_folder_of(path(:i - 1), error)
            if (allocated(error)) return
        end do
        call check_call(status, 'make folder', path, error)
    end subroutine make_folder

    !> Replaces the contents of a file. After a crash the file has either its old contents or all of the text.
    subroutine replace_file(path, text, error)
        character(*), intent(in) :: path, text !! path of the file, and its new contents
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(output_file_t) :: file

        call file%create(path // '.new', error)
        if (.not. allocated(error)) call file%write(text, error)
        if (.not. allocated(error)) call file%finish_as(path, len(text, int64), error)
        call file%discard()
    end subroutine replace_file

    !> A path that is relative to the folder of another file.
    pure function path_from(file, path) result(whole)
        character(*), intent(in) :: file !! path of the other file
        character(*), intent(in) :: path !! an absolute path, which stays as it is, or a relative one
        character(:), allocatable :: whole
        whole = trim(path)
        if (index(whole, '/') /= 1) whole = file(:index(file, '/', back=.true.)) // whole
    end function path_from

    !> Whether two paths name one file, which exists.
    logical function is_same_file(a, b)
        character(*), intent(in) :: a, b !! the paths
        is_same_file = c_is_same_file(a // c_null_char, b // c_null_char) /= 0
    end function is_same_file

    !> Opens a file for reading. Its errors are input errors. A FIFO, of which one waits for the writer, must be allowed.
    subroutine open_input(self, path, error, may_wait, is_text)
        class(input_file_t), intent(inout) :: self
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: may_wait !! whether it may be a FIFO or a device; false by default
        logical, intent(in), optional :: is_text
            !! whether it is read as text: without a byte order mark, and with LF for CR LF if the first line ends so
        integer(c_int) :: status
        logical :: waits
        self%is_text = .false.
        if (present(is_text)) self%is_text = is_text
        self%is_new = .true.
        self%has_returns = .false.
        waits = .false.
        if (present(may_wait)) waits = may_wait
        self%path = path
        if (is_folder(path)) then
            error = input_error('cannot read ' // path // ': it is a folder')
            return
        end if
        if (waits) status = c_open(path // c_null_char, self%descriptor)
        if (.not. waits) status = c_open_regular(path // c_null_char, self%descriptor)
        call check_call(status, 'read', path, error, exit_input)
    end subroutine open_input

    !> Reads from the current position into a text. `length` is less than its length only at the end of the
    !> file.
    subroutine read_bytes(self, text, length, error)
        class(input_file_t), intent(inout) :: self
        character(*), intent(inout) :: text !! the bytes are at its beginning
        integer, intent(out) :: length !! bytes read
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer(c_long_long) :: got, kept
        length = 0
        do
            call check_call(c_read(self%descriptor, text(length + 1:), len(text, c_long_long) - length, got), 'read', &
                            self%path, error, exit_input)
            kept = got
            if (self%is_text) call make_plain(self, text(length + 1:), kept)
            length = length + int(kept)
            if (allocated(error) .or. kept == got) exit ! else there is room for more
        end do
    end subroutine read_bytes

    !> Takes the byte order mark and the carriage returns from a block of a text.
    subroutine make_plain(file, block, length)
        type(input_file_t), intent(inout) :: file
        character(*), intent(inout) :: block
        integer(c_long_long), intent(inout) :: length
        character, parameter :: carriage_return = achar(13)
        character(*), parameter :: byte_order_mark = char(239) // char(187) // char(191)
        integer(c_long_long) :: i, n, first, break
        if (file%is_new) then
            break = index(block(:length), new_line('a'), kind=c_long_long)
            if (break > 1) file%has_returns = block(break - 1:break - 1) == carriage_return
        end if
        first = 1
        if (file%is_new .and. index(block(:length), byte_order_mark) == 1) first = first + len(byte_order_mark)
        file%is_new = .false.
        if (first == 1 .and. .not. file%has_returns) return
        n = 0
        do i = first, length
            if (file%has_returns .and. block(i:i) == carriage_return) cycle
            n = n + 1
            block(n:n) = block(i:i)
        end do
        length = n
    end subroutine make_plain

    !> Closes the file.
    subroutine close_input(self)
        class(input_file_t), intent(inout) :: self
        integer(c_int) :: ignored
        if (self%descriptor >= 0) ignored = c_close(self%descriptor)
        self%descriptor = no_file
    end subroutine close_input

    !> Reads a whole file of at most `limit` bytes. Errors are input errors.
    subroutine read_file(path, limit, text, error, may_wait, is_text)
        character(*), intent(in) :: path !! path of the file
        integer, intent(in) :: limit !! maximum size, bytes
        character(:), allocatable, intent(out) :: text !! contents of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: may_wait !! whether it may be a FIFO or a device; false by default
        logical, intent(in), optional :: is_text !! whether it is read as text, as `open` says; false by default
        type(input_file_t) :: file
        character(:), allocatable :: block, more
        integer, parameter :: first_room = 65536
        integer :: length, got

        text = ''
        call file%open(path, error, may_wait, is_text)
        if (allocated(error)) return
        allocate (character(first_room) :: block)
        length = 0
        do
            call file%read(block(length + 1:), got, error)
            length = length + got
            if (allocated(error) .or. length < len(block) .or. length > limit) exit
            allocate (character(2 * len(block)) :: more)
            more(:length) = block
            call move_alloc(more, block)
        end do
        call file%close()
        if (allocated(error)) return
        if (length > limit) then
            error = input_error('cannot read ' // path // ': it is too large for an input')
        else
            text = block(:length)
        end if
    end subroutine read_file

    !> Whether a file or a folder of that name exists.
    logical function file_exists(path)
        character(*), intent(in) :: path !! path of the file
        file_exists = file_size(path) >= 0
    end function file_exists

    !> Size of a file in bytes; -1 if it does not exist.
    integer(int64) function file_size(path)
        character(*), intent(in) :: path !! path of the file
        file_size = c_file_size(path // c_null_char)
    end function file_size

    !> Whether a folder of that name exists.
    logical function is_folder(path)
        character(*), intent(in) :: path !! path of the folder
        is_folder = c_is_folder(path // c_null_char) /= 0
    end function is_folder

    !> Date and time in UTC: `2024-05-31T12:34:56Z`.
    function utc_now() result(text)
        character(:), allocatable :: text
        character(room_of_text) :: room
        if (c_utc(room) == 0) text = up_to_null(room)
    end function utc_now

    !> Name of the machine on which the process runs.
    function host_name() result(text)
        character(:), allocatable :: text
        character(room_of_text) :: room
        if (c_host(room) == 0) text = up_to_null(room)
    end function host_name

    !> Makes an error of a nonzero returned number: an output error, unless another code is given.
    subroutine check_call(number, action, path, error, code)
        integer(c_int), intent(in) :: number         !! what a function of posix.c returned
        character(*), intent(in) :: action, path     !! for the message: cannot ACTION PATH
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer, intent(in), optional :: code !! exit code of the error
        ! This is also called by threads: see `status_names` in spintop_status.
        character(256) :: reason
        if (number == 0) return
        call c_reason(number, reason, len(reason))
        error = output_error('cannot ' // action // ' ' // path // ': ' // up_to_null(reason))
        if (present(code)) error%code = code
    end subroutine check_call

    !> The text before the first null character, or all of it.
    pure function up_to_null(room) result(text)
        character(*), intent(in) :: room !! characters, terminated by a null character
        character(:), allocatable :: text
        text = room(:index(room // c_null_char, c_null_char) - 1)
    end function up_to_null

end module spintop_files
