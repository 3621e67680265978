!> A table that grows for a long time and survives an interrupted run: a signal, a full disk, a power failure.
!> The journal next to the part records how many bytes of the part are on the disk. A later run truncates the
!> part to that size and resumes there. What is there when a table is started, and what comes of it:
!>
!>     part and journal, `resume`     rows go on behind the last entry ----+--> finish: the table, nothing beside it
!>     anything else, or `restart`    a new part, an entry of no rows -----+--> abandon: part and journal
!>     the table, `resume`            is_complete: nothing is to be done
!>     part and journal, neither      an error: the rows would be lost
!>
!> A NetCDF table grows like one of text: its rows are in the part as they are in memory, and the file is made of them at
!> the end. A table that stays in memory (`memory`) is no file, and nothing of it survives.
!>
!> Rows that are there are kept, failed cases as well. What comes after them is computed by the study: `begin_table` in
!> sweep_study.f90. A table without a journal is not resumed: what an interrupted run has left of it is discarded.
!>
!> The rows are added in the order of their cases, block by block:
!>
!>     call table%start(path, head, resume, restart, error)
!>     call table%format(block)                      ! by any thread
!>     call table%append(block, error)               ! by one thread at a time, as
!>     call table%make_entry_if_due(entry, due, error)      ! this and `end_entry` are called;
!>     if (due) call table%keep_entry(entry, error)  ! this without holding up the others
!>     if (due) call table%end_entry()
!>     call table%finish(error)                      ! or, after an error, table%abandon(error)
module spintop_row_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_exists, file_size, remove_file
    use spintop_kinds, only: dp
    use spintop_loaded_table, only: data_table_t
    use spintop_netcdf_table, only: check_whole_table, head_of_table, netcdf_layout_t, write_netcdf_table
    use spintop_process, only: keep_rows, seconds
    use spintop_row_block, only: row_block_t
    use spintop_status, only: last_status
    use spintop_table_column, only: status_column, table_column_t
    use spintop_table_file, only: journal_entry_t, journal_of, part_of, read_journal, refuse_to_discard, &
        remove_journal, state_of, table_file_t, write_journal
    use spintop_table_head, only: comment_lines, compare_heads
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: row_table_t, refusal, remove_leftovers

    !> Seconds between two entries of the journal, or, if the disk is slow, this multiple of the duration of
    !> the last entry: entries take less than a twentieth of the time of one thread.
    real(dp), parameter :: first_pause = 0.05_dp, entry_pause = 0.5_dp, entry_times_pause = 20

    !> A table of rows, with its journal.
    type :: row_table_t
        type(table_column_t), allocatable :: columns(:)
        !> Grid and compression of a NetCDF table, to be set before the start; not allocated for one of text.
        type(netcdf_layout_t), allocatable :: netcdf
        !> The table in memory, begun in place of `start`; not allocated for a file.
        type(data_table_t), allocatable :: memory
        !> Whether the rows are written. Otherwise the part has only the header, the journal still counts the rows,
        !> and another file is made of them, which `finish` leaves as it is.
        logical :: keeps_rows = .true.
        !> Whether a journal is kept, and whether the rows of an interrupted run are.
        logical :: has_journal = .true., is_resumable = .false.
        !> Number of rows with each status: written so far, and those of them from an earlier run.
        integer(int64) :: counts(0:last_status) = 0, taken_over(0:last_status) = 0
        !> Number of rows of this run that a note makes doubtful.
        integer(int64) :: doubtful = 0
        !> Whether the table already exists and is complete.
        logical :: is_complete = .false.
        !> Whether an entry of the journal is wanted at once, however old the last one is; whether one is being written.
        logical :: entry_wanted = .false., in_entry = .false.
        !> A remark on earlier runs, ready to print; may be empty.
        character(:), allocatable :: remark
        character(:), allocatable, private :: head
        !> Comment lines after the last row.
        type(string_t), allocatable :: trailer(:)
        !> The entry with which the table was resumed.
        type(journal_entry_t) :: resumed
        !> The part.
        type(table_file_t) :: table
        !> Time at which the next entry is due; when the work for the present one began (0: there is none), so that the pause
        !> after it is as long as all of it asks for.
        real(dp) :: due = 0, entry_began = 0
        !> Rows in the last entry, and number of the file with the last state.
        integer(int64), private :: kept = 0
        integer :: last_state = 0
    contains
        procedure :: rows
        procedure :: start
        procedure :: format => format_block
        procedure :: append
        procedure :: make_entry_if_due
        procedure :: keep_entry
        procedure :: end_entry
        procedure :: finish
        procedure :: abandon
        procedure :: discard
        procedure, private :: resume, flush_part
    end type row_table_t

contains

    !> Number of rows so far.
    pure integer(int64) function rows(self)
        class(row_table_t), intent(in) :: self
        rows = sum(self%counts)
    end function rows

    !> Starts a table, or resumes one (`resume`): its header, which contains program, build and input, must
    !> then be that of the earlier run. The rows of an interrupted run are discarded only on request
    !> (`restart`).
    subroutine start(self, path, head, resume, restart, error)
        class(row_table_t), intent(inout) :: self
        character(*), intent(in) :: path, head !! path of the table, and its header
        logical, intent(in) :: resume, restart !! whether to resume, or to discard, an interrupted run
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: problem
        logical :: had_part
        integer :: column

        self%remark = ''
        self%head = head
        self%is_resumable = self%has_journal
        had_part = file_exists(part_of(path))
        if (resume .and. had_part .and. file_exists(journal_of(path))) then
            call self%table%reserve(path, error)
            if (.not. allocated(error)) call self%resume(head, error)
        else if (resume .and. file_exists(path)) then
            problem = difference_from(path, head)
            column = 0
            if (allocated(self%columns)) column = findloc(self%columns%name == status_column, .true., dim=1)
            if (problem == '' .and. self%keeps_rows) call check_whole_table(path, problem, self%counts, column)
            if (problem /= '') then
                error = refusal(path, problem)
                return
            end if
            self%is_complete = .true.
            self%remark = 'nothing was computed: the table is already complete'
            call remove_leftovers(path)
        else
            call self%table%reserve(path, error)
            if (had_part .and. .not. (allocated(error) .or. restart)) then
                call refuse_to_discard(path, error, is_ours=.true.)
                if (allocated(error)) call self%table%abandon()
            end if
            if (.not. allocated(error)) call start_anew(self, head, resume, error)
        end if
        self%due = seconds() + first_pause
    end subroutine start

    !> Removes what interrupted runs have left beside a complete table, unless another run is writing it.
    subroutine remove_leftovers(path)
        character(*), intent(in) :: path !! path of the table
        type(table_file_t) :: part
        type(error_t), allocatable :: problem
        integer :: i
        if (.not. any([file_exists(part_of(path)), file_exists(journal_of(path)), file_exists(journal_of(path) // '.new'), &
                       file_exists(path // '.new'), (file_exists(state_of(path, i)), i=1, 2)])) return
        call part%reserve(path, problem)
        if (allocated(problem)) return
        call remove_journal(path, problem, is_over=.true.)
        if (file_exists(path // '.new')) call remove_file(path // '.new', problem)
        call part%discard()
    end subroutine remove_leftovers

    !> Starts from the beginning, with an entry of no rows. The rows of an earlier run are discarded.
    subroutine start_anew(self, head, resume, error)
        class(row_table_t), intent(inout) :: self
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
            ! A journal must never record more bytes than its part has.
            call remove_journal(path, error)
            if (.not. allocated(error)) call self%table%begin(head, error)
            if (self%has_journal .and. .not. allocated(error)) then
                call self%flush_part(entry, error)
                if (.not. allocated(error)) call self%table%file%sync(error)
            end if
            if (self%has_journal .and. .not. allocated(error)) then
                entry%counts = self%counts
                call write_journal(path, entry, error)
            end if
            if (allocated(error)) call self%table%discard()
        end associate
    end subroutine start_anew

    !> Resumes at the size in the journal, if the bytes of the part have the checksum in the journal.
    subroutine resume(self, head, error)
        class(row_table_t), intent(inout) :: self
        character(*), intent(in) :: head
        type(error_t), allocatable, intent(out) :: error
        type(journal_entry_t) :: entry
        character(:), allocatable :: problem

        associate (path => self%table%path)
            problem = difference_from(part_of(path), head)
            if (problem == '') call read_journal(path, entry, problem)
            if (problem == '') call self%table%go_on(entry, problem, error)
            if (problem /= '') error = refusal(path, problem)
            if (allocated(error)) then
                call self%table%abandon()
                return
            end if
        end associate
        self%resumed = entry
        self%last_state = entry%state
        self%counts = entry%counts
        self%taken_over = entry%counts
        self%kept = self%rows()
        self%remark = 'resumes after ' // to_text(sum(entry%counts)) // ' rows of an interrupted run'
    end subroutine resume

    !> Formats the rows of a block as they are in the part.
    subroutine format_block(self, block)
        class(row_table_t), intent(in) :: self
        type(row_block_t), intent(inout) :: block !! its cells become text
        if (allocated(self%memory)) return
        if (.not. self%keeps_rows) then
            block%rows = 0
        else if (allocated(self%netcdf)) then
            call block%format_as_in_memory()
        else
            call block%format(self%columns)
        end if
    end subroutine format_block

    !> Adds rows.
    subroutine append(self, block, error)
        class(row_table_t), intent(inout) :: self
        type(row_block_t), intent(in) :: block !! rows in their order
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (allocated(self%memory)) then
            call self%memory%add(block)
        else if (self%keeps_rows) then
            call self%table%append(block%text%room(:block%text%length), error)
        end if
        self%counts = self%counts + block%counts
        self%doubtful = self%doubtful + block%doubtful
    end subroutine append

    !> Makes an entry of the current size, if there are new rows and the last entry is old enough.
    subroutine make_entry_if_due(self, entry, due, error)
        class(row_table_t), intent(inout) :: self
        type(journal_entry_t), intent(inout) :: entry !! the current size of the table, if an entry is due
        logical, intent(out) :: due !! whether an entry is due
        type(error_t), allocatable, intent(inout) :: error !! not changed if it is allocated on entry

        due = .false.
        if (.not. self%is_resumable .or. self%in_entry .or. allocated(error) .or. self%rows() == self%kept) return
        if (seconds() < self%due .and. .not. self%entry_wanted) return
        if (.not. self%entry_began > 0) self%entry_began = seconds()
        call self%flush_part(entry, error)
        if (allocated(error)) return
        due = .true.
        self%in_entry = .true.
        self%kept = self%rows()
        entry%counts = self%counts
    end subroutine make_entry_if_due

    !> Waits until the rows of an entry are on the disk, and then writes the entry. Other threads may add rows
    !> meanwhile.
    subroutine keep_entry(self, entry, error)
        class(row_table_t), intent(in) :: self
        type(journal_entry_t), intent(in) :: entry !! entry of the journal
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%table%file%sync(error)
        if (.not. allocated(error)) call write_journal(self%table%path, entry, error)
        if (.not. allocated(error)) call keep_rows(sum(entry%counts))
    end subroutine keep_entry

    !> Called after an entry was written: sets the time of the next one.
    subroutine end_entry(self)
        class(row_table_t), intent(inout) :: self
        self%due = seconds() + max(entry_pause, entry_times_pause * (seconds() - self%entry_began))
        self%entry_began = 0
        self%in_entry = .false. ! last: other threads ask meanwhile whether one is due
    end subroutine end_entry

    !> Renames the part to the table, or makes a NetCDF file of it, and removes the journal.
    subroutine finish(self, error)
        class(row_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: head
        logical :: is_left
        integer :: at
        if (allocated(self%memory)) return
        is_left = allocated(self%netcdf) .or. .not. self%keeps_rows
        if (.not. allocated(self%trailer)) allocate (self%trailer(0))
        if (.not. is_left) then
            call self%table%finish(self%trailer, error)
        else if (self%keeps_rows) then
            call self%table%write_pending(error)
            ! What stands below the rows of a text is one more item of the metadata.
            at = index(self%head, '# input:' // new_line('a'))
            head = self%head(:at - 1) // comment_lines(self%trailer) // self%head(at:)
            if (.not. allocated(error)) call write_netcdf_table(self%table%path, head, self%columns, self%netcdf, &
                                                                part_of(self%table%path), self%table%ending%checksum(), error)
        end if
        if (.not. allocated(error)) call remove_journal(self%table%path, error, is_over=.true.)
        if (is_left .and. .not. allocated(error)) call self%table%discard()
    end subroutine finish

    !> Keeps part and journal for a later run, and adds that to the message of the error.
    subroutine abandon(self, error)
        class(row_table_t), intent(inout) :: self
        type(error_t), intent(inout) :: error !! its message is completed
        if (allocated(self%memory)) return
        call self%table%abandon()
        if (.not. file_exists(journal_of(self%table%path))) return
        error%message = error%message // new_line('a') // 'the complete rows of ' // self%table%path // &
                        ' are kept; --resume resumes the run'
    end subroutine abandon

    !> Removes part and journal: nothing is to be resumed.
    subroutine discard(self)
        class(row_table_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        call remove_journal(self%table%path, ignored, is_over=.true.)
        call self%table%discard()
    end subroutine discard

    !> Passes all rows to the system; `entry` gets their bytes and checksum.
    subroutine flush_part(self, entry, error)
        class(row_table_t), intent(inout) :: self
        type(journal_entry_t), intent(out) :: entry !! without the numbers of rows
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%table%write_pending(error)
        entry%bytes = self%table%bytes
        entry%checksum = self%table%ending%checksum()
    end subroutine flush_part

    !> How the header of a file differs from another one; '' if it does not. A file may end before its line of names.
    function difference_from(path, head) result(problem)
        character(*), intent(in) :: path, head
        character(:), allocatable :: problem, found
        type(error_t), allocatable :: error
        call head_of_table(path, found, error)
        if (allocated(error)) then
            problem = error%message
            if (len(found) /= file_size(path)) return
        end if
        problem = compare_heads(found, 'there', head, 'here')
        if (problem /= '') problem = path // ' was made by another program, build or input' // problem
    end function difference_from

    !> The error of a run that cannot be resumed.
    type(error_t) function refusal(path, problem) result(error)
        character(*), intent(in) :: path, problem !! path of the table, and the reason
        error = input_error('cannot resume ' // path // ': ' // problem // new_line('a') // &
                            '--restart discards it and computes all from the beginning')
    end function refusal

end module spintop_row_table
