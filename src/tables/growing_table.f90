!> A table that grows for a long time and survives an interrupted run: a signal, a full disk, a power
!> cut. The journal beside its part says how much of the part is on the disk; a later run cuts the part
!> back to that and resumes there.
!>
!>     call table%start(path, head, resume, restart, error)   ! and on as in spintop_row_table
module spintop_growing_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_checksum, only: add_to_checksum, checksum_t, checksum_text
    use spintop_clock, only: seconds
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_exists, input_file_t
    use spintop_interrupted_run, only: refuse_to_discard
    use spintop_journal, only: journal_entry_t, journal_of, read_journal, remove_journal, write_journal
    use spintop_kinds, only: dp
    use spintop_process, only: keep_rows
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_table_file, only: part_of, table_file_t
    use spintop_table_head, only: compare_heads
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: growing_table_t

    !> Seconds between two entries of the journal, or, where the disk is slow, so many times what
    !> the last entry took: they cost one thread less than a twentieth of its time.
    real(dp), parameter :: first_pause = 0.05_dp, entry_pause = 0.5_dp, entry_times_pause = 20

    !> Bytes that are read at once.
    integer, parameter :: block_size = 1024 * 1024

    !> A table of a sweep as CSV, with its journal.
    type, extends(row_table_t) :: growing_table_t
        type(table_file_t), private :: table
        !> When the next entry is due; whether one is being written, and since when.
        real(dp), private :: due = 0, entry_began = 0
        logical, private :: in_entry = .false.
    contains
        procedure :: start
        procedure :: format => format_block
        procedure :: put
        procedure :: take_entry
        procedure :: keep_entry
        procedure :: end_entry
        procedure :: finish
        procedure :: abandon
        procedure, private :: start_anew
        procedure, private :: resume
    end type growing_table_t

contains

    !> Starts a table, or resumes one (`resume`): the header, which names program, build and input, must
    !> then be that of the earlier run. The rows of an interrupted run are discarded on request only
    !> (`restart`).
    subroutine start(self, path, head, resume, restart, error)
        class(growing_table_t), intent(inout) :: self
        character(*), intent(in) :: path, head
        logical, intent(in) :: resume, restart
        type(error_t), allocatable, intent(out) :: error
        character(:), allocatable :: problem
        logical :: had_part

        self%remark = ''
        self%is_resumable = .true.
        had_part = file_exists(part_of(path))
        if (resume .and. had_part .and. file_exists(journal_of(path))) then
            call self%table%reserve(path, error)
            if (.not. allocated(error)) call self%resume(head, error)
        else if (resume .and. file_exists(path)) then
            call compare_with_file(path, head, problem)
            if (problem /= '') then
                error = refusal(path, problem)
                return
            end if
            self%is_complete = .true.
            self%remark = 'nothing was computed: the table is already complete'
            if (.not. file_exists(part_of(path))) call remove_journal(path, error)
        else
            call self%table%reserve(path, error)
            if (had_part .and. .not. (allocated(error) .or. restart)) then
                call refuse_to_discard(path, error)
                if (allocated(error)) call self%table%abandon()
            end if
            if (.not. allocated(error)) call self%start_anew(head, resume, error)
        end if
        self%due = seconds() + first_pause
    end subroutine start

    !> Starts from the beginning, with an entry that says so. The rows of an earlier run are discarded.
    subroutine start_anew(self, head, resume, error)
        class(growing_table_t), intent(inout) :: self
        character(*), intent(in) :: head
        logical, intent(in) :: resume
        type(error_t), allocatable, intent(out) :: error
        type(journal_entry_t) :: entry
        character(:), allocatable :: problem

        associate (path => self%table%path)
            if (resume) then
                self%remark = 'nothing to resume: the run starts from the beginning'
            else if (file_exists(journal_of(path))) then
                call read_journal(path, entry, problem)
                self%remark = 'discards an interrupted run of ' // to_text(sum(entry%counts)) // ' rows'
            end if
            ! A journal must never say more than its part has.
            call remove_journal(path, error)
            if (.not. allocated(error)) call self%table%begin(head, error)
            if (.not. allocated(error)) call self%table%sync(error)
            if (.not. allocated(error)) then
                entry = journal_entry_t(self%table%bytes, checksum_text(self%table%checksum), self%counts)
                call write_journal(path, entry, error)
            end if
            if (allocated(error)) call self%table%discard()
        end associate
    end subroutine start_anew

    !> Resumes where the journal says, if the part holds the bytes that the journal says.
    subroutine resume(self, head, error)
        class(growing_table_t), intent(inout) :: self
        character(*), intent(in) :: head
        type(error_t), allocatable, intent(out) :: error
        type(journal_entry_t) :: entry
        type(checksum_t) :: checksum
        character(:), allocatable :: problem

        associate (path => self%table%path)
            call compare_with_file(part_of(path), head, problem)
            if (problem == '') call read_journal(path, entry, problem)
            if (problem == '') call check_part(part_of(path), entry, checksum, problem)
            if (problem /= '') then
                error = refusal(path, problem)
            else
                call self%table%go_on(entry%bytes, checksum, error)
            end if
            if (allocated(error)) then
                call self%table%abandon()
                return
            end if
        end associate
        self%counts = entry%counts
        self%taken_over = entry%counts
        self%remark = 'resumes after ' // to_text(sum(entry%counts)) // ' rows of an interrupted run'
    end subroutine resume

    !> Makes the text of a block.
    subroutine format_block(self, block)
        class(growing_table_t), intent(in) :: self
        type(row_block_t), intent(inout) :: block
        call block%format(self%columns)
    end subroutine format_block

    !> Adds rows.
    subroutine put(self, block, error)
        class(growing_table_t), intent(inout) :: self
        type(row_block_t), intent(in) :: block
        type(error_t), allocatable, intent(out) :: error
        call self%table%put(block%text%room(:block%text%length), error)
        self%counts = self%counts + block%counts
    end subroutine put

    !> Notes how far the table is, where the last entry is old enough.
    subroutine take_entry(self, entry, due, error)
        class(growing_table_t), intent(inout) :: self
        type(journal_entry_t), intent(inout) :: entry
        logical, intent(out) :: due
        type(error_t), allocatable, intent(inout) :: error

        due = .false.
        if (self%in_entry .or. allocated(error)) return
        self%entry_began = seconds()
        if (self%entry_began < self%due) return
        call self%table%write_pending(error)
        if (allocated(error)) return
        due = .true.
        self%in_entry = .true.
        entry = journal_entry_t(self%table%bytes, checksum_text(self%table%checksum), self%counts)
    end subroutine take_entry

    !> Makes sure that the rows of an entry are on the disk, and then the entry. Other threads may
    !> put rows meanwhile.
    subroutine keep_entry(self, entry, error)
        class(growing_table_t), intent(in) :: self
        type(journal_entry_t), intent(in) :: entry
        type(error_t), allocatable, intent(out) :: error
        call self%table%sync(error)
        if (.not. allocated(error)) call write_journal(self%table%path, entry, error)
        if (.not. allocated(error)) call keep_rows(sum(entry%counts))
    end subroutine keep_entry

    !> The entry taken is kept: sets the time of the next one.
    subroutine end_entry(self)
        class(growing_table_t), intent(inout) :: self
        self%in_entry = .false.
        self%due = seconds() + max(entry_pause, entry_times_pause * (seconds() - self%entry_began))
    end subroutine end_entry

    !> Gives the table its name and removes the journal.
    subroutine finish(self, error)
        class(growing_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        type(string_t) :: no_lines(0)
        call self%table%finish(no_lines, error)
        if (.not. allocated(error)) call remove_journal(self%table%path, error)
    end subroutine finish

    !> Keeps part and journal for a later run, and adds that to the message of the error.
    subroutine abandon(self, error)
        class(growing_table_t), intent(inout) :: self
        type(error_t), intent(inout) :: error
        call self%table%abandon()
        if (.not. file_exists(journal_of(self%table%path))) return
        error%message = error%message // new_line('a') // 'the complete rows of ' // self%table%path // &
                        ' are kept; --resume resumes the run'
    end subroutine abandon

    !> Whether a file begins with a header; `problem` says where it differs, and is empty if it does not.
    subroutine compare_with_file(path, head, problem)
        character(*), intent(in) :: path, head
        character(:), allocatable, intent(out) :: problem
        type(input_file_t) :: file
        type(error_t), allocatable :: error
        character(:), allocatable :: found
        integer :: length

        length = 0
        allocate (character(len(head)) :: found)
        call file%open(path, error)
        if (.not. allocated(error)) call file%read(found, length, error)
        call file%close()
        if (allocated(error)) then
            problem = error%message
        else
            problem = compare_heads(found(:length), 'there', head, 'here')
            if (problem /= '') problem = path // ' was made by another program, build or input' // problem
        end if
    end subroutine compare_with_file

    !> Whether a part has the bytes of an entry. `checksum` has taken them all.
    subroutine check_part(part, entry, checksum, problem)
        character(*), intent(in) :: part
        type(journal_entry_t), intent(in) :: entry
        type(checksum_t), intent(out) :: checksum
        character(:), allocatable, intent(out) :: problem
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
            call add_to_checksum(checksum, block(:length))
            left = left - length
        end do
        call file%close()
        if (allocated(error)) then
            problem = error%message
        else if (left > 0) then
            problem = part // ' is shorter than its journal says'
        else if (checksum_text(checksum) /= entry%checksum) then
            problem = part // ' was changed after it was written: its checksum differs from that in its journal'
        end if
    end subroutine check_part

    type(error_t) function refusal(path, problem) result(error)
        character(*), intent(in) :: path, problem
        error = input_error('cannot resume ' // path // ': ' // problem // new_line('a') // &
                            '--restart discards it and computes all from the beginning')
    end function refusal

end module spintop_growing_table
