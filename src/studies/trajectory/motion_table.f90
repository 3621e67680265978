!> The table of a trajectory, as CSV or NetCDF: a row per sample, and how the motion ended.
module spintop_motion_table
    use spintop_certificate, only: proof_words
    use spintop_errors, only: error_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_netcdf_table, only: netcdf_table_t
    use spintop_provenance, only: fact_count, fact_t
    use spintop_row_block, only: row_block_t
    use spintop_study_head, only: study_facts, study_head
    use spintop_table_column, only: column_of_words, table_column_t
    use spintop_table_file, only: table_file_t
    use spintop_text, only: string_t
    use spintop_text_buffer, only: text_buffer_t
    use spintop_trajectory_column, only: trajectory_column_t
    implicit none
    private
    public :: motion_table_t

    !> Name of the column that is the coordinate of the rows in NetCDF, and of the dimension where that is not chosen.
    character(*), parameter :: time_column = 't', row_dimension = 'row'

    !> Key of the line, or the attribute, that says how the motion ended; its value for one that is complete.
    character(*), parameter :: status_key = 'status', complete = 'ok'

    !> Rows of a NetCDF table that are passed on at once.
    integer, parameter :: rows_at_once = 1024

    !> A table that is being written.
    type :: motion_table_t
        private
        character(:), allocatable :: path
        type(table_column_t), allocatable :: columns(:)
        !> The CSV table and its header, or the NetCDF table and its next rows.
        type(table_file_t) :: text
        character(:), allocatable :: head
        type(netcdf_table_t), allocatable :: netcdf
        type(row_block_t) :: block
        integer :: rows = 0
    contains
        procedure :: describe
        procedure :: create
        procedure :: add_row
        procedure :: finish
        procedure :: discard
        procedure, private :: put_block
    end type motion_table_t

contains

    !> Takes what the table of a job is, before it is created.
    subroutine describe(self, job, columns)
        class(motion_table_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        type(trajectory_column_t), intent(in) :: columns(:) !! columns of the table
        type(fact_t) :: facts(fact_count)
        integer :: i

        self%path = job%output
        allocate (self%columns(size(columns)))
        do i = 1, size(columns)
            self%columns(i) = table_column_t(columns(i)%name, columns(i)%unit, columns(i)%what)
            if (.not. columns(i)%is_proof) cycle
            self%columns(i)%kind = column_of_words
            self%columns(i)%words = [string_t(trim(proof_words(0))), string_t(trim(proof_words(1)))]
        end do
        if (job%scene%format /= 'netcdf') then
            self%head = study_head(job, columns)
            return
        end if
        allocate (self%netcdf)
        associate (description => self%netcdf%description)
            call study_facts(job, facts, description%input)
            allocate (description%facts(fact_count + 1))
            description%facts(:fact_count) = facts
            description%facts(fact_count + 1)%key = status_key
            description%facts(fact_count + 1)%value = complete
            allocate (description%columns, source=self%columns)
            allocate (description%axes(1))
            description%axes(1) = netcdf_axis_t(row_dimension, job%plan%samples)
            do i = 1, size(columns)
                if (columns(i)%name /= time_column) cycle
                description%columns(i)%axis = 1
                description%axes(1)%name = time_column
            end do
            description%part = ''
            if (job%scene%compression >= 0) description%compression = job%scene%compression
        end associate
    end subroutine describe

    !> Starts the table, or starts it anew after `discard`.
    subroutine create(self, error)
        class(motion_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%rows = 0
        if (.not. allocated(self%netcdf)) then
            call self%text%create(self%path, self%head, error)
            return
        end if
        call self%netcdf%start(self%path, self%netcdf%description%head(), .false., .true., error)
        call self%block%reserve(size(self%netcdf%description%columns), rows_at_once)
    end subroutine create

    !> Adds a row.
    subroutine add_row(self, values, error)
        class(motion_table_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: values(:) !! a number for each column, of a word its number from 0
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(text_buffer_t) :: line
        integer :: i

        if (.not. (allocated(self%netcdf) .or. any(self%columns%kind == column_of_words))) then
            call self%text%add_row(values, error)
            return
        else if (.not. allocated(self%netcdf)) then
            do i = 1, size(values)
                if (self%columns(i)%kind == column_of_words) then
                    call line%put_text(self%columns(i)%words(nint(values(i)) + 1)%text)
                else
                    call line%put_reals(values(i:i))
                end if
            end do
            call line%end_row()
            call self%text%put(line%contents(), error)
            return
        end if
        self%rows = self%rows + 1
        self%block%rows = self%block%rows + 1
        self%block%cells(:, self%block%rows) = values
        if (self%block%rows == rows_at_once) call self%put_block(error)
    end subroutine add_row

    !> Passes the next rows to the NetCDF table.
    subroutine put_block(self, error)
        class(motion_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        call self%netcdf%put(self%block, error)
        call self%block%clear()
    end subroutine put_block

    !> Finishes the table, with how the motion ended.
    subroutine finish(self, status, error)
        class(motion_table_t), intent(inout) :: self
        character(*), intent(in) :: status !! `ok`, or the reason and the time of the end
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(string_t) :: trailer(1)

        if (.not. allocated(self%netcdf)) then
            trailer(1)%text = status_key // ': ' // status
            call self%text%finish(trailer, error)
            return
        end if
        call self%put_block(error)
        if (allocated(error)) return
        associate (description => self%netcdf%description)
            description%facts(size(description%facts))%value = status
            description%axes(1)%length = self%rows
        end associate
        call self%netcdf%finish(error)
    end subroutine finish

    !> Discards the table: nothing of it is left.
    subroutine discard(self)
        class(motion_table_t), intent(inout) :: self
        if (allocated(self%netcdf)) then
            call self%netcdf%discard()
        else
            call self%text%discard()
        end if
    end subroutine discard

end module spintop_motion_table
