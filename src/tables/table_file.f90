!> CSV tables that are either complete or absent. The rows are written to `NAME.part`, which is renamed to the
!> table when all data are on the disk.
!>
!>     call table%create('output/scene.csv', table_head(comments, ['t    ', 'theta']), error)
!>     call table%add_row([0.0_dp, 0.3_dp], error)    ! a row of numbers, or
!>     call table%append(text, error)                 ! rows made elsewhere
!>     call table%finish(trailer, error)
!>
!> After an error call `discard`, or `abandon` if the part is to be kept.
!>
!> The journal of a growing table records how many bytes of its part are on the disk. It
!> is the file `NAME.journal` next to the part and is replaced as a whole. The header of the part identifies
!> the table: program, build, input and shard.
!>
!>     spintop journal 4
!>     bytes: 1048701
!>     checksum: 6A09E667F3BCC908        (of these bytes)
!>     rows: 2171 0 12 0 0 0 0 0 0 0 0   (of each status)
!>     state: 1 BB67AE8584CAA73B         (only where the rows are gathered: a file of what was, and its checksum)
!>     end: BB67AE8584CAA73B             (checksum of the lines above)
module spintop_table_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: refuse_if_stopped
    use spintop_checksum, only: checksum_of, checksum_width
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: check_target, file_exists, input_file_t, output_file_t, read_file, remove_file, replace_file, &
        sync_folder_of
    use spintop_kinds, only: dp
    use spintop_status, only: last_status
    use spintop_table_end, only: table_end_t
    use spintop_table_head, only: comment_lines
    use spintop_text, only: string_t, to_text
    use spintop_row_block, only: text_buffer_t
    implicit none
    private
    public :: table_file_t, part_of, stem_of, refuse_to_discard
    public :: journal_entry_t, journal_of, write_journal, read_journal, remove_journal, state_of

    character, parameter :: nl = new_line('a')

    !> Bytes that are collected before they are written, and that are read at once.
    integer, parameter :: block_size = 1024 * 1024

    !> The format of a journal is the number in the first line. It increases when a status is added, for the rows are counted
    !> by status, and when the checksum is another one.
    character(*), parameter :: first_words = 'spintop journal ', first_line = first_words // '4'

    !> The line of the state.
    character(*), parameter :: state_key = 'state: ', state_format = '(ss, i1, 1x, a)'

    !> An entry: the bytes of a part that are on the disk.
    type :: journal_entry_t
        integer(int64) :: bytes = 0
        character(2 * checksum_width) :: checksum = '' !! of these bytes
        integer(int64) :: counts(0:last_status) = 0 !! rows of each status
        !> Number of the file with what was gathered of these rows (0: none), and its checksum.
        integer :: state = 0
        character(checksum_width) :: state_checksum = ''
    end type journal_entry_t

    !> A CSV table that is being written.
    type :: table_file_t
        character(:), allocatable :: path     !! of the complete table
        integer(int64) :: bytes = 0           !! written so far, header included
        type(table_end_t) :: ending           !! the checksum of the bytes written so far, for the last line
        type(output_file_t) :: file           !! the part
        type(text_buffer_t), private :: pending
    contains
        procedure :: create
        procedure :: create_beside
        procedure :: reserve
        procedure :: begin
        procedure :: go_on
        procedure :: add_row
        procedure :: append
        procedure :: write_pending
        procedure :: finish
        procedure :: discard
        procedure :: abandon
        procedure, private :: clear
    end type table_file_t

contains

    !> The name of a table before it is complete.
    pure function part_of(path) result(part)
        character(*), intent(in) :: path !! path of the table
        character(:), allocatable :: part
        part = path // '.part'
    end function part_of

    !> The name of a table without the ending of its format, which it may have.
    pure function stem_of(file) result(name)
        character(*), intent(in) :: file !! the name, or a path
        character(:), allocatable :: name
        character(4), parameter :: endings(2) = ['.csv', '.nc ']
        integer :: i, length
        name = file
        do i = 1, size(endings)
            length = len(file) - len_trim(endings(i))
            if (length < 1) cycle
            if (file(length + 1:) == trim(endings(i))) name = file(:length)
        end do
    end function stem_of

    !> Starts a table. An existing table of that name is not changed before `finish`.
    subroutine create(self, path, head, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: path !! path of the table
        character(*), intent(in) :: head !! ready to write
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%reserve(path, error)
        ! The journal of another kind of run would record more bytes than the part has.
        if (.not. allocated(error)) call remove_journal(path, error)
        if (.not. allocated(error)) call self%begin(head, error)
        if (allocated(error)) call self%discard()
    end subroutine create

    !> Starts a table beside a growing one, which has the part and the journal: it is `NAME.new` until it is complete.
    subroutine create_beside(self, path, head, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: path !! path of the table
        character(*), intent(in) :: head !! ready to write
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%clear(path)
        call check_target(path, error)
        if (.not. allocated(error)) call self%file%create(path // '.new', error)
        if (.not. allocated(error)) call self%append(head, error)
    end subroutine create_beside

    !> Forgets an earlier table.
    subroutine clear(self, path)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: path
        self%path = path
        self%bytes = 0
        self%ending = table_end_t()
        call self%pending%clear()
    end subroutine clear

    !> Opens and locks the part, without changing it; no other run can write it meanwhile. It is created if it
    !> is missing.
    subroutine reserve(self, path, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: path !! path of the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%clear(path)
        call check_target(path, error)
        if (.not. allocated(error)) call self%file%open(part_of(path), error)
    end subroutine reserve

    !> Empties the part, and writes the header. A folder that is not writable is detected here, not after the
    !> computation.
    subroutine begin(self, head, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: head !! the header, ready to write
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%file%truncate(0_int64, error)
        if (.not. allocated(error)) call self%append(head, error)
        if (.not. allocated(error)) call self%write_pending(error)
    end subroutine begin

    !> Checks that the part has the bytes of an entry, and truncates it to them: writing continues there.
    subroutine go_on(self, entry, problem, error)
        class(table_file_t), intent(inout) :: self
        type(journal_entry_t), intent(in) :: entry !! entry of the journal
        character(:), allocatable, intent(out) :: problem !! why the part has not these bytes; '' if it has
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(input_file_t) :: file
        character(:), allocatable :: block, part
        integer(int64) :: left
        integer :: length

        call self%clear((self%path))
        self%bytes = entry%bytes
        problem = ''
        part = part_of(self%path)
        allocate (character(block_size) :: block)
        left = entry%bytes
        call file%open(part, error)
        do while (left > 0 .and. .not. allocated(error))
            call file%read(block(:min(left, len(block, int64))), length, error)
            if (length == 0) exit
            call self%ending%add(block(:length))
            left = left - length
        end do
        call file%close()
        if (allocated(error)) then
            problem = error%message
            deallocate (error)
        else if (left > 0) then
            problem = part // ' is shorter than its journal records'
        else if (self%ending%checksum() /= entry%checksum) then
            problem = part // ' was changed after it was written: its checksum differs from that in its journal'
        else
            call self%file%truncate(entry%bytes, error)
        end if
    end subroutine go_on

    !> Adds a row of numbers.
    subroutine add_row(self, values, error)
        class(table_file_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: values(:) !! numbers
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: before

        before = self%pending%length
        call self%pending%add_reals(values)
        call self%pending%end_row()
        self%bytes = self%bytes + self%pending%length - before
        if (self%pending%length >= block_size) call self%write_pending(error)
    end subroutine add_row

    !> Adds rows as text; of a call that is to stop none are.
    subroutine append(self, text, error)
        class(table_file_t), intent(inout) :: self
        character(*), intent(in) :: text !! whole rows, with their line ends
        type(error_t), allocatable, intent(out) :: error !! not allocated on success

        call refuse_if_stopped(error)
        if (allocated(error)) return
        call self%pending%append(text)
        self%bytes = self%bytes + len(text)
        if (self%pending%length >= block_size) call self%write_pending(error)
    end subroutine append

    !> Passes all collected bytes to the system.
    subroutine write_pending(self, error)
        class(table_file_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (self%pending%length == 0) return
        call self%file%write(self%pending%room(:self%pending%length), error)
        call self%ending%add(self%pending%room(:self%pending%length))
        call self%pending%clear()
    end subroutine write_pending

    !> Ends the table with comment lines and the line of its end, and renames it when it is on the disk.
    subroutine finish(self, trailer, error)
        class(table_file_t), intent(inout) :: self
        type(string_t), intent(in) :: trailer(:) !! comment lines, without the `#`
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_end_t) :: whole

        call self%append(comment_lines(trailer), error)
        if (allocated(error)) return
        whole = self%ending
        call whole%add(self%pending%contents())
        call self%append(whole%line(), error)
        if (.not. allocated(error)) call self%write_pending(error)
        if (.not. allocated(error)) call self%file%finish_as(self%path, self%bytes, error)
    end subroutine finish

    !> Discards the table: the part is removed, if possible.
    subroutine discard(self)
        class(table_file_t), intent(inout) :: self
        call self%file%discard()
    end subroutine discard

    !> Closes the part and keeps it, so that a later run can resume it.
    subroutine abandon(self)
        class(table_file_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        call self%file%close(ignored)
    end subroutine abandon

    !> Returns an error if an interrupted run has left rows of a table, or a journal that cannot be read. Rows of a table that
    !> a run is writing are in no danger, and it cannot be resumed.
    subroutine refuse_to_discard(path, error, is_ours)
        character(*), intent(in) :: path !! of the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in) :: is_ours !! whether this run has reserved the table, so that no other writes it
        type(journal_entry_t) :: entry
        type(table_file_t) :: table
        type(error_t), allocatable :: in_use
        character(:), allocatable :: problem, rows

        if (.not. (file_exists(part_of(path)) .and. file_exists(journal_of(path)))) return
        call read_journal(path, entry, problem)
        if (problem == '' .and. sum(entry%counts) == 0 .and. entry%state == 0) return
        rows = to_text(sum(entry%counts)) // ' rows are kept'
        if (problem /= '') rows = problem
        error = input_error('an interrupted run of ' // path // ' is there: ' // rows // nl // &
                            '--resume resumes it; --restart discards it and computes all from the beginning')
        if (is_ours) return
        call table%reserve(path, in_use)
        call table%abandon()
        if (allocated(in_use)) deallocate (error)
    end subroutine refuse_to_discard

    !> The name of the journal of a table.
    pure function journal_of(path) result(journal)
        character(*), intent(in) :: path !! path of the table
        character(:), allocatable :: journal
        journal = path // '.journal'
    end function journal_of

    !> Replaces the entry of a table, and waits until the new one is on the disk.
    subroutine write_journal(path, entry, error)
        character(*), intent(in) :: path !! of the table
        type(journal_entry_t), intent(in) :: entry !! entry of the journal
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: text
        call compose(entry, text)
        call replace_file(journal_of(path), text, error)
    end subroutine write_journal

    !> Reads the entry of a table; `problem` is the reason why there is none, or empty.
    subroutine read_journal(path, entry, problem)
        character(*), intent(in) :: path !! of the table
        type(journal_entry_t), intent(out) :: entry !! entry of the journal
        character(:), allocatable, intent(out) :: problem !! why there is no entry; '' if there is one
        type(error_t), allocatable :: error
        character(:), allocatable :: text, again, found, number
        integer, parameter :: longest = 65536
        integer :: status

        problem = ''
        call read_file(journal_of(path), longest, text, error)
        if (allocated(error)) then
            problem = error%message
            return
        end if
        found = text(:index(text // nl, nl) - 1)
        number = found(min(len(first_words), len(found)) + 1:)
        if (index(found, first_words) == 1 .and. number /= '' .and. verify(number, '0123456789') == 0 &
            .and. found /= first_line) then
            problem = journal_of(path) // ' has another format (' // found // ') than this program reads (' // first_line // ')'
            return
        end if
        read (text(behind('bytes:'):), *, iostat=status) entry%bytes
        if (status == 0) read (text(behind('checksum: '):), '(a)', iostat=status) entry%checksum
        if (status == 0) read (text(behind('rows:'):), *, iostat=status) entry%counts
        if (status == 0 .and. index(text, state_key) > 0) then
            read (text(behind(state_key):), state_format, iostat=status) entry%state, entry%state_checksum
        end if
        ! Only a text that this program would write is accepted as an entry.
        call compose(entry, again)
        if (status /= 0 .or. text /= again .or. len(text) /= len(again)) problem = journal_of(path) // ' is damaged'

    contains

        !> Position of the value of a key; the end of the text if there is no such key.
        integer function behind(key)
            character(*), intent(in) :: key
            behind = index(text, key) + len(key)
            if (index(text, key) == 0) behind = len(text) + 1
        end function behind

    end subroutine read_journal

    !> The path of a state: there are two, which are written in turn.
    pure function state_of(path, number) result(state)
        character(*), intent(in) :: path !! path of the table
        integer, intent(in) :: number !! 1 or 2
        character(:), allocatable :: state
        state = path // '.state' // merge('1', '2', number == 1)
    end function state_of

    !> Removes the journal of a table, and then the states, if there are any.
    subroutine remove_journal(path, error, is_over)
        character(*), intent(in) :: path !! of the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        logical, intent(in), optional :: is_over !! whether no entry follows: then one that was interrupted goes as well
        integer :: i
        if (present(is_over)) then
            if (is_over .and. file_exists(journal_of(path) // '.new')) call remove_file(journal_of(path) // '.new', error)
        end if
        if (file_exists(journal_of(path)) .and. .not. allocated(error)) then
            call remove_file(journal_of(path), error)
            if (.not. allocated(error)) call sync_folder_of(path, error)
        end if
        do i = 1, 2
            if (file_exists(state_of(path, i)) .and. .not. allocated(error)) call remove_file(state_of(path, i), error)
            if (file_exists(state_of(path, i) // '.new') .and. .not. allocated(error)) then
                call remove_file(state_of(path, i) // '.new', error)
            end if
        end do
    end subroutine remove_journal

    !> The text of an entry.
    subroutine compose(entry, text)
        type(journal_entry_t), intent(in) :: entry
        character(:), allocatable, intent(out) :: text
        character(1024) :: room
        integer :: i

        text = first_line // nl
        write (room, '(ss, "bytes: ", i0)') entry%bytes
        text = text // trim(room) // nl // 'checksum: ' // entry%checksum // nl
        write (room, '(ss, "rows:", *(1x, i0))') (entry%counts(i), i=0, last_status)
        text = text // trim(room) // nl
        if (entry%state > 0) then
            write (room, state_format) entry%state, entry%state_checksum
            text = text // state_key // trim(room) // nl
        end if
        text = text // 'end: ' // checksum_of(text) // nl
    end subroutine compose

end module spintop_table_file
