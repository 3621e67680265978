!> The table of a trajectory, as CSV or NetCDF: a row per sample, and how the motion ended. From time to time the state of
!> the run is written to one of two files in turn, of which the journal names the one that belongs to its rows.
module spintop_motion_table
    use spintop_archive, only: archive_t
    use spintop_certificate, only: proof_words
    use spintop_checksum, only: checksum_of
    use spintop_errors, only: error_t
    use spintop_files, only: file_exists, read_file, replace_file
    use spintop_resumable_table, only: resumable_table_t, refusal
    use spintop_job, only: job_t
    use spintop_journal, only: journal_entry_t, journal_of, state_of
    use spintop_kinds, only: dp
    use spintop_netcdf_description, only: netcdf_description_t
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_netcdf_table, only: netcdf_table_t
    use spintop_provenance, only: fact_count, fact_t
    use spintop_row_block, only: row_block_t
    use spintop_status, only: status_ok
    use spintop_study_head, only: study_facts, study_head
    use spintop_table_column, only: column_of_words, status_column, table_column_t
    use spintop_text, only: append
    use spintop_trajectory_columns, only: trajectory_column_t
    implicit none
    private
    public :: motion_table_t

    !> The quantity that is the coordinate of the rows in NetCDF, and the dimension where that is not chosen.
    character(*), parameter :: time_column = 't', row_dimension = 'row'

    !> The value of the line, or the attribute, that says how the motion ended for one that is complete.
    character(*), parameter :: complete = 'ok'

    !> Rows that are passed on at once.
    integer, parameter :: rows_at_once = 1024

    !> Seconds to the first entry of the journal: shorter runs have none.
    real(dp), parameter :: first_pause = 0.5_dp
    !> Bytes of a file that may be a state.
    integer, parameter :: most_bytes = 1024 * 1024

    !> A table that is being written.
    type :: motion_table_t
        !> The table: CSV or NetCDF, with its header.
        class(resumable_table_t), allocatable :: rows_table
        character(:), allocatable, private :: path, head
        type(row_block_t), private :: block
    contains
        procedure :: describe
        procedure :: create
        procedure :: add_row
        procedure :: wants_state
        procedure :: keep_state
        procedure :: recall_state
        procedure :: ended_with
        procedure :: finish
        procedure :: discard
        procedure :: abandon
    end type motion_table_t

contains

    !> Describes the table of a job, before it is created.
    subroutine describe(self, job, columns)
        class(motion_table_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        type(trajectory_column_t), intent(in) :: columns(:) !! columns of the table
        type(table_column_t) :: described(size(columns))
        integer :: i, k

        self%path = job%files%table
        do i = 1, size(columns)
            described(i) = table_column_t(columns(i)%name, columns(i)%unit, columns(i)%what)
            if (.not. columns(i)%is_proof) cycle
            described(i)%kind = column_of_words
            do k = 0, 1
                call append(described(i)%words, trim(proof_words(k)))
            end do
        end do
        if (job%input%scene%format == 'netcdf') then
            allocate (netcdf_table_t :: self%rows_table)
        else
            allocate (resumable_table_t :: self%rows_table)
            self%head = study_head(job, columns)
        end if
        self%rows_table%has_states = .true.
        allocate (self%rows_table%columns, source=described)
        select type (table => self%rows_table)
        type is (netcdf_table_t)
            call describe_file(table%description)
            self%head = table%description%head()
        end select

    contains

        !> The description of a NetCDF file.
        subroutine describe_file(description)
            type(netcdf_description_t), intent(inout) :: description
            type(fact_t) :: facts(fact_count)
            call study_facts(job, facts, description%input)
            allocate (description%facts(fact_count + 1))
            description%facts(:fact_count) = facts
            description%facts(fact_count + 1)%key = status_column
            description%facts(fact_count + 1)%value = complete
            allocate (description%columns, source=described)
            allocate (description%axes(1))
            description%axes(1) = netcdf_axis_t(row_dimension, job%plan%samples)
            do i = 1, size(columns)
                if (columns(i)%quantity() /= time_column) cycle
                description%columns(i)%axis = 1
                description%axes(1)%name = trim(columns(i)%name)
                exit
            end do
            description%part = ''
            if (job%input%scene%compression >= 0) description%compression = job%input%scene%compression
        end subroutine describe_file

    end subroutine describe

    !> Starts the table, or resumes one (`resume`); or starts it anew after `discard`. The rows of an interrupted run are
    !> discarded only on request (`restart`).
    subroutine create(self, resume, restart, error)
        class(motion_table_t), intent(inout) :: self
        logical, intent(in) :: resume, restart !! whether to resume, or to discard, an interrupted run
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%rows_table%counts = 0
        call self%block%reserve(size(self%rows_table%columns), rows_at_once)
        call self%rows_table%start(self%path, self%head, resume, restart, error)
        if (allocated(error)) return
        if (.not. self%rows_table%is_complete) call self%rows_table%set_pause(first_pause)
    end subroutine create

    !> Adds a row.
    subroutine add_row(self, values, error)
        class(motion_table_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: values(:) !! a number for each column, of a word its number from 0
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%block%rows = self%block%rows + 1
        self%block%cells(:, self%block%rows) = values
        if (self%block%rows == rows_at_once) call append_block(self, error)
    end subroutine add_row

    !> Passes the next rows on.
    subroutine append_block(self, error)
        class(motion_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        self%block%counts(status_ok) = self%block%rows
        call self%rows_table%format(self%block)
        call self%rows_table%append(self%block, error)
        call self%block%clear()
    end subroutine append_block

    !> Whether it is time to keep the state of the run.
    logical function wants_state(self)
        class(motion_table_t), intent(in) :: self
        wants_state = self%rows_table%is_due()
    end function wants_state

    !> Keeps the state of the run with the rows so far.
    subroutine keep_state(self, archive, error)
        class(motion_table_t), intent(inout) :: self
        type(archive_t), intent(in) :: archive !! the state
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(journal_entry_t) :: entry
        character(:), allocatable :: path, bytes
        logical :: due

        call append_block(self, error)
        call self%rows_table%make_entry_if_due(entry, due, error)
        if (.not. due) return
        call self%rows_table%begin_state(entry%state, path)
        bytes = archive%bytes()
        call replace_file(path, bytes, error)
        entry%state_checksum = checksum_of(bytes)
        if (.not. allocated(error)) call self%rows_table%keep_entry(entry, error)
        call self%rows_table%end_entry()
    end subroutine keep_state

    !> The state with which the kept rows end; not allocated where the motion starts from its beginning.
    subroutine recall_state(self, archive, error)
        class(motion_table_t), intent(in) :: self
        type(archive_t), allocatable, intent(out) :: archive !! gives the state back
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: text

        associate (entry => self%rows_table%resumed)
            if (entry%state == 0 .and. self%rows_table%rows() == 0) return
            if (entry%state == 0) then
                error = refusal(self%path, 'its journal names no state of the motion')
                return
            end if
            call read_file(state_of(self%path, entry%state), most_bytes, text, error)
            if (allocated(error)) then
                error = refusal(self%path, error%message)
                return
            end if
            if (checksum_of(text) /= entry%state_checksum) then
                error = refusal(self%path, state_of(self%path, entry%state) // ' was changed after it was written')
                return
            end if
        end associate
        allocate (archive)
        call archive%load(text)
    end subroutine recall_state

    !> How the motion of a complete table ended: a status.
    pure integer function ended_with(self)
        class(motion_table_t), intent(in) :: self
        ended_with = findloc(self%rows_table%counts > 0, .true., dim=1) - 1
    end function ended_with

    !> Finishes the table, with how the motion ended.
    subroutine finish(self, status, error)
        class(motion_table_t), intent(inout) :: self
        character(*), intent(in) :: status !! `ok`, or the reason and the time of the end
        type(error_t), allocatable, intent(out) :: error !! not allocated on success

        call append_block(self, error)
        if (allocated(error)) return
        allocate (self%rows_table%trailer(0))
        call append(self%rows_table%trailer, status_column // ': ' // status)
        select type (table => self%rows_table)
        type is (netcdf_table_t)
            table%description%facts(size(table%description%facts))%value = status
            table%description%axes(1)%length = int(table%rows())
        end select
        call self%rows_table%finish(error)
    end subroutine finish

    !> Discards the table: nothing of it is left.
    subroutine discard(self)
        class(motion_table_t), intent(inout) :: self
        call self%rows_table%discard()
    end subroutine discard

    !> Keeps what a later run can resume, and adds that to the message of the error; if there is nothing, nothing is left.
    subroutine abandon(self, is_kept, error)
        class(motion_table_t), intent(inout) :: self
        logical, intent(out) :: is_kept !! whether a later run can resume it
        type(error_t), intent(inout) :: error !! its message is completed
        is_kept = file_exists(journal_of(self%path))
        if (is_kept) then
            call self%rows_table%abandon(error)
        else
            call self%discard()
        end if
    end subroutine abandon

end module spintop_motion_table
