!> CSV tables that are either complete or absent. The rows are written to `NAME.part`, which is renamed to the
!> table when all data are on the disk.
!>
!>     call table%create('output/scene.csv', table_head(comments, ['t    ', 'theta']), error)
!>     call table%add_row([0.0_dp, 0.3_dp], error)    ! a row of numbers, or
!>     call table%append(text, error)                 ! rows made elsewhere
!>     call table%finish(trailer, error)
!>
!> After an error call `discard`, or `abandon` if the part is to be kept.
module spintop_table_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: refuse_if_stopped
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: check_target, file_exists, input_file_t, output_file_t
    use spintop_journal, only: journal_entry_t, journal_of, read_journal, remove_journal
    use spintop_kinds, only: dp
    use spintop_table_end, only: table_end_t
    use spintop_table_head, only: comment_lines
    use spintop_text, only: string_t, to_text
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: table_file_t, part_of, stem_of, refuse_to_discard, refuse_to_discard_idle

    !> Bytes that are collected before they are written, and that are read at once.
    integer, parameter :: block_size = 1024 * 1024

    !> A CSV table that is being written.
    type :: table_file_t
        character(:), allocatable :: path     !! of the complete table
        integer(int64) :: bytes = 0           !! written so far, header included
        type(table_end_t) :: ending           !! the checksum of the bytes written so far, for the last line
        type(output_file_t), private :: file
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
        procedure :: sync
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
        call self%clear((self%path))
        self%bytes = entry%bytes
        call check_bytes(part_of(self%path), entry, self%ending, problem)
        if (problem == '') call self%file%truncate(entry%bytes, error)
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

    !> Waits until all written bytes are on the disk. Other threads may continue to add rows.
    subroutine sync(self, error)
        class(table_file_t), intent(in) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%file%sync(error)
    end subroutine sync

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

    !> Whether a part has the bytes of an entry.
    subroutine check_bytes(part, entry, ending, problem)
        character(*), intent(in) :: part !! path of the part
        type(journal_entry_t), intent(in) :: entry !! entry of the journal
        type(table_end_t), intent(out) :: ending !! their checksum
        character(:), allocatable, intent(out) :: problem !! why it has not; '' if it has
        type(input_file_t) :: file
        type(error_t), allocatable :: error
        character(:), allocatable :: block
        integer(int64) :: left
        integer :: length

        problem = ''
        allocate (character(block_size) :: block)
        left = entry%bytes
        call file%open(part, error)
        do while (left > 0 .and. .not. allocated(error))
            call file%read(block(:min(left, len(block, int64))), length, error)
            if (length == 0) exit
            call ending%add(block(:length))
            left = left - length
        end do
        call file%close()
        if (allocated(error)) then
            problem = error%message
        else if (left > 0) then
            problem = part // ' is shorter than its journal records'
        else if (ending%checksum() /= entry%checksum) then
            problem = part // ' was changed after it was written: its checksum differs from that in its journal'
        end if
    end subroutine check_bytes

    !> Returns an error if an interrupted run has left rows of a table, or a journal that cannot be read.
    subroutine refuse_to_discard(path, error)
        character(*), intent(in) :: path !! of the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(journal_entry_t) :: entry
        character(:), allocatable :: problem, rows

        if (.not. (file_exists(part_of(path)) .and. file_exists(journal_of(path)))) return
        call read_journal(path, entry, problem)
        if (problem == '' .and. sum(entry%counts) == 0 .and. entry%state == 0) return
        rows = to_text(sum(entry%counts)) // ' rows are kept'
        if (problem /= '') rows = problem
        error = input_error('an interrupted run of ' // path // ' is there: ' // rows // new_line('a') // &
                            '--resume resumes it; --restart discards it and computes all from the beginning')
    end subroutine refuse_to_discard

    !> The same, except if a run is writing the table: its rows are not in danger, and it cannot be resumed.
    subroutine refuse_to_discard_idle(path, error)
        character(*), intent(in) :: path !! of the table
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(error_t), allocatable :: in_use
        type(table_file_t) :: table

        call refuse_to_discard(path, error)
        if (.not. allocated(error)) return
        call table%reserve(path, in_use)
        call table%abandon()
        if (allocated(in_use)) deallocate (error)
    end subroutine refuse_to_discard_idle

end module spintop_table_file
