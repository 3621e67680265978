!> The journal of a growing table: how much of its part is on the disk. It is the file `NAME.journal`
!> beside the part and is replaced as a whole. The header of the part itself identifies the table:
!> program, build, input and shard.
!>
!>     spintop journal 1
!>     bytes: 1048701
!>     checksum: 6A09E667F3BCC908        (of these bytes)
!>     rows: 2171 0 12 0 0 0 0 0 0 0 0   (of each status)
!>     end: BB67AE8584CAA73B             (checksum of the lines above)
module spintop_journal
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_checksum, only: add_to_checksum, checksum_t, checksum_text, checksum_width
    use spintop_errors, only: error_t
    use spintop_files, only: file_exists, read_file, remove_file, replace_file, sync_folder_of
    use spintop_status, only: last_status
    implicit none
    private
    public :: journal_entry_t, journal_of, write_journal, read_journal, remove_journal

    character(*), parameter :: first_line = 'spintop journal 1'

    !> How much of a part is on the disk.
    type :: journal_entry_t
        integer(int64) :: bytes = 0
        character(checksum_width) :: checksum = ''  !! of these bytes
        integer(int64) :: counts(0:last_status) = 0 !! rows of each status
    end type journal_entry_t

contains

    !> The name of the journal of a table.
    pure function journal_of(path) result(journal)
        character(*), intent(in) :: path
        character(:), allocatable :: journal
        journal = path // '.journal'
    end function journal_of

    !> Writes an entry in the place of the last one, and waits until it is on the disk.
    subroutine write_journal(path, entry, error)
        character(*), intent(in) :: path !! of the table
        type(journal_entry_t), intent(in) :: entry
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: text
        call compose(entry, text)
        call replace_file(journal_of(path), text, error)
    end subroutine write_journal

    !> Reads the entry of a table; `problem` says why there is none, and is empty if there is one.
    subroutine read_journal(path, entry, problem)
        character(*), intent(in) :: path !! of the table
        type(journal_entry_t), intent(out) :: entry
        character(:), allocatable, intent(out) :: problem
        type(error_t), allocatable :: error
        character(:), allocatable :: text, again
        integer, parameter :: longest = 65536
        integer :: status

        problem = ''
        call read_file(journal_of(path), longest, text, error)
        if (allocated(error)) then
            problem = error%message
            return
        end if
        read (text(behind('bytes:'):), *, iostat=status) entry%bytes
        if (status == 0) read (text(behind('checksum: '):), '(a)', iostat=status) entry%checksum
        if (status == 0) read (text(behind('rows:'):), *, iostat=status) entry%counts
        ! Only what this program would write is taken for an entry.
        call compose(entry, again)
        if (status /= 0 .or. text /= again .or. len(text) /= len(again)) problem = journal_of(path) // ' is damaged'

    contains

        !> Where the value of a key begins; the end of the text where it has no such key.
        integer function behind(key)
            character(*), intent(in) :: key
            behind = index(text, key) + len(key)
            if (index(text, key) == 0) behind = len(text) + 1
        end function behind

    end subroutine read_journal

    !> Removes the journal of a table that needs it no more.
    subroutine remove_journal(path, error)
        character(*), intent(in) :: path !! of the table
        type(error_t), allocatable, intent(out) :: error
        if (.not. file_exists(journal_of(path))) return
        call remove_file(journal_of(path), error)
        if (.not. allocated(error)) call sync_folder_of(path, error)
    end subroutine remove_journal

    !> The text of an entry.
    subroutine compose(entry, text)
        type(journal_entry_t), intent(in) :: entry
        character(:), allocatable, intent(out) :: text
        character(1024) :: room
        type(checksum_t) :: checksum
        character, parameter :: nl = new_line('a')
        integer :: i

        text = first_line // nl
        write (room, '("bytes: ", i0)') entry%bytes
        text = text // trim(room) // nl // 'checksum: ' // entry%checksum // nl
        write (room, '("rows:", *(1x, i0))') (entry%counts(i), i=0, last_status)
        text = text // trim(room) // nl
        call add_to_checksum(checksum, text)
        text = text // 'end: ' // checksum_text(checksum) // nl
    end subroutine compose

end module spintop_journal
