!> The format of the journal of a growing table, which records how many bytes of its part are on the disk. It
!> is the file `NAME.journal` next to the part and is replaced as a whole. The header of the part identifies
!> the table: program, build, input and shard.
!>
!>     spintop journal 4
!>     bytes: 1048701
!>     checksum: 6A09E667F3BCC908        (of these bytes)
!>     rows: 2171 0 12 0 0 0 0 0 0 0 0   (of each status)
!>     state: 1 BB67AE8584CAA73B         (only where the rows are gathered: a file of what was, and its checksum)
!>     end: BB67AE8584CAA73B             (checksum of the lines above)
module spintop_journal
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_checksum, only: checksum_of, checksum_width
    use spintop_errors, only: error_t
    use spintop_files, only: file_exists, read_file, remove_file, replace_file, sync_folder_of
    use spintop_status, only: last_status
    implicit none
    private
    public :: journal_entry_t, journal_of, write_journal, read_journal, remove_journal, state_of

    !> The format is the number in the first line. It increases when a status is added, for the rows are counted
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

contains

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
        found = text(:index(text // new_line('a'), new_line('a')) - 1)
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
        character, parameter :: nl = new_line('a')
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

end module spintop_journal
