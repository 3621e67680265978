!> The table of a trajectory, as CSV or NetCDF: a row per sample, and how the motion ended. Nothing is kept of a run that
!> is interrupted.
module spintop_motion_table
    use spintop_certificate, only: proof_words
    use spintop_errors, only: error_t
    use spintop_resumable_table, only: resumable_table_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_netcdf_table, only: netcdf_description_t
    use spintop_provenance, only: fact_count, fact_t
    use spintop_row_block, only: row_block_t
    use spintop_status, only: status_ok
    use spintop_study_column, only: categorical
    use spintop_study_head, only: study_facts, study_head
    use spintop_table_column, only: status_column, table_column_t
    use spintop_text, only: append
    implicit none
    private
    public :: motion_table_t

    !> The quantity that is the coordinate of the rows in NetCDF, and the dimension where that is not chosen.
    character(*), parameter :: time_column = 't', row_dimension = 'row'

    !> The value of the line, or the attribute, that says how the motion ended for one that is complete.
    character(*), parameter :: complete = 'ok'

    !> Rows that are passed on at once.
    integer, parameter :: rows_at_once = 1024

    !> A table that is being written.
    type :: motion_table_t
        !> The table: CSV or NetCDF, with its header.
        type(resumable_table_t) :: rows_table
        character(:), allocatable, private :: path, head
        type(row_block_t), private :: block
    contains
        procedure :: describe
        procedure :: create
        procedure :: add_row
        procedure :: ended_with
        procedure :: finish
        procedure :: discard
    end type motion_table_t

contains

    !> Describes the table of a job, before it is created.
    subroutine describe(self, job)
        class(motion_table_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        type(table_column_t), allocatable :: described(:)
        integer :: i

        self%path = job%files%table
        allocate (described(size(job%columns) + 2 * job%sensitivities%count))
        described%column_t = [job%columns%column_t, job%sensitivities%table_columns()]
        do i = 1, size(job%columns)
            if (job%columns(i)%is(categorical)) call described(i)%set_words(proof_words(0:1))
        end do
        self%rows_table%has_journal = .false.
        allocate (self%rows_table%columns, source=described)
        if (job%input%scene%format == 'netcdf') then
            allocate (self%rows_table%netcdf)
            call describe_file(self%rows_table%netcdf)
            self%head = self%rows_table%netcdf%head()
        else
            self%head = study_head(job, described)
        end if

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
            i = findloc(job%columns%quantity(), time_column, dim=1)
            if (i > 0) then
                description%columns(i)%axis = 1
                description%axes(1)%name = trim(described(i)%name)
            end if
            description%part = ''
            if (job%input%scene%compression >= 0) description%compression = job%input%scene%compression
        end subroutine describe_file

    end subroutine describe

    !> Starts the table, unless it is to be left where it is complete (`resume`); or starts it anew after `discard`.
    subroutine create(self, resume, restart, error)
        class(motion_table_t), intent(inout) :: self
        logical, intent(in) :: resume, restart !! the options of the command line
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%rows_table%counts = 0
        call self%block%reserve(size(self%rows_table%columns), rows_at_once)
        call self%rows_table%start(self%path, self%head, resume, restart, error)
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
        if (allocated(self%rows_table%netcdf)) then
            associate (description => self%rows_table%netcdf)
                description%facts(size(description%facts))%value = status
                description%axes(1)%length = int(self%rows_table%rows())
            end associate
        end if
        call self%rows_table%finish(error)
    end subroutine finish

    !> Discards the table: nothing of it is left.
    subroutine discard(self)
        class(motion_table_t), intent(inout) :: self
        call self%rows_table%discard()
    end subroutine discard

end module spintop_motion_table
