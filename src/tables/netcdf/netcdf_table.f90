!> A table that grows as a NetCDF file, with a journal as that of a CSV table (spintop_resumable_table). The part has the
!> classic format, in which rows that are on the disk stay valid whatever happens later; a file in the format NetCDF-4
!> is made of it when all rows are there.
!>
!>     table%description = description
!>     call table%start(path, description%head(), resume, restart, error)   ! then as in spintop_row_table
module spintop_netcdf_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_output
    use spintop_files, only: output_file_t
    use spintop_resumable_table, only: resumable_table_t
    use spintop_journal, only: journal_entry_t
    use spintop_kinds, only: dp
    use spintop_netcdf_description, only: netcdf_description_t
    use spintop_netcdf_file, only: confirm_netcdf, head_of_netcdf, netcdf_file_t
    use spintop_row_block, only: row_block_t
    use spintop_status, only: last_status
    use spintop_status_counts, only: status_of_ending
    use spintop_table_column, only: status_column
    use spintop_table_end, only: table_end_t
    use spintop_table_file, only: changed_after, part_of
    implicit none
    private
    public :: netcdf_table_t, end_problem

    !> Rows that are read at once.
    integer, parameter :: rows_at_once = 4096

    !> A table as a NetCDF file.
    type, extends(resumable_table_t) :: netcdf_table_t
        !> All but the rows; to be set before the start.
        type(netcdf_description_t) :: description
        type(netcdf_file_t), private :: file
        !> Whether the part is that of an earlier run: the library leaves bytes without a meaning at its end.
        logical, private :: is_continued = .false.
        !> What the file says of its rows.
        type(table_end_t), private :: ending
    contains
        procedure :: format => leave_cells
        procedure :: begin_part
        procedure :: append_to_part
        procedure :: flush_part
        procedure :: check_part
        procedure :: finish_part
        procedure, nopass :: read_head => head_of_netcdf
        procedure :: check_complete
        procedure :: abandon
        procedure :: discard
        procedure, private :: is_as_wanted, confirm, convert
    end type netcdf_table_t

contains

    !> The rows stay cells.
    subroutine leave_cells(self, block)
        class(netcdf_table_t), intent(in) :: self
        type(row_block_t), intent(inout) :: block !! not changed
    end subroutine leave_cells

    !> Creates the part.
    subroutine begin_part(self, head, error)
        class(netcdf_table_t), intent(inout) :: self
        character(*), intent(in) :: head !! the header, that of the description
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(netcdf_description_t) :: of_part
        of_part = self%description
        of_part%compression = -1
        self%ending = table_end_t()
        call self%file%create(part_of(self%table%path), of_part, error)
    end subroutine begin_part

    !> Adds rows to the part.
    subroutine append_to_part(self, block, error)
        class(netcdf_table_t), intent(inout) :: self
        type(row_block_t), intent(in) :: block !! rows in their order
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%ending%add_cells(block%cells(:, :block%rows))
        call self%file%append(block%cells(:, :block%rows), error)
    end subroutine append_to_part

    !> Passes all rows to the system; `entry` gets the bytes of their cells, and their checksum.
    subroutine flush_part(self, entry, error)
        class(netcdf_table_t), intent(inout) :: self
        type(journal_entry_t), intent(out) :: entry !! without the numbers of rows
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%file%flush(error)
        entry%bytes = self%file%rows * size(self%description%columns) * (storage_size(0.0_dp) / 8)
        entry%checksum = self%ending%checksum()
    end subroutine flush_part

    !> Checks that the part has the rows of an entry: writing continues behind them.
    subroutine check_part(self, entry, problem, error)
        class(netcdf_table_t), intent(inout) :: self
        type(journal_entry_t), intent(in) :: entry !! entry of the journal
        character(:), allocatable, intent(out) :: problem !! why the part is not the right one; '' if it is
        type(error_t), allocatable, intent(out) :: error !! not allocated on success

        problem = ''
        call self%file%open(part_of(self%table%path), .true., error)
        if (.not. allocated(error)) call walk_rows(self%file, sum(entry%counts), self%ending, error)
        if (allocated(error)) return
        self%file%rows = sum(entry%counts)
        self%is_continued = .true.
        if (self%ending%checksum() /= entry%checksum) problem = changed_after(part_of(self%table%path))
    end subroutine check_part

    !> Renames the part to the table, when it is confirmed; or makes the table of it in another format.
    subroutine finish_part(self, error)
        class(netcdf_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (self%is_as_wanted()) then
            call self%file%seal(self%ending%summary(), error)
            if (.not. allocated(error)) call self%file%close(error)
            if (.not. allocated(error)) call self%confirm(part_of(self%table%path), error)
            if (.not. allocated(error)) call self%table%finish_part(-1_int64, error)
            return
        end if
        call self%file%flush(error)
        if (.not. allocated(error)) call self%convert(error)
        if (.not. allocated(error)) call self%file%close(error)
        if (.not. allocated(error)) call self%table%discard()
    end subroutine finish_part

    !> Reads a closed file, which has the whole table, and has it confirmed.
    subroutine confirm(self, path, error)
        class(netcdf_table_t), intent(in) :: self
        character(*), intent(in) :: path
        type(error_t), allocatable, intent(out) :: error
        type(netcdf_file_t) :: file
        type(table_end_t) :: ending
        type(error_t), allocatable :: ignored

        call file%open(path, .false., error)
        if (.not. allocated(error)) call walk_rows(file, self%file%rows, ending, error)
        if (allocated(error)) then
            error%code = exit_output
        else
            call confirm_netcdf(path, file%description%head() == self%description%head() .and. file%description%ending == &
                                self%ending%summary() .and. ending%summary() == self%ending%summary(), error)
        end if
        call file%close(ignored)
    end subroutine confirm

    !> Whether the part is what the table is to be.
    logical function is_as_wanted(self)
        class(netcdf_table_t), intent(in) :: self
        is_as_wanted = self%description%compression < 0 .and. self%file%rows == self%file%room .and. .not. self%is_continued
        if (is_as_wanted) is_as_wanted = self%file%description%head() == self%description%head()
    end function is_as_wanted

    !> Makes the table of the rows of the part, under another name until it is confirmed.
    subroutine convert(self, error)
        class(netcdf_table_t), intent(in) :: self
        type(error_t), allocatable, intent(out) :: error
        type(netcdf_file_t) :: to
        type(output_file_t) :: output
        type(table_end_t) :: ending
        type(error_t), allocatable :: problem

        call output%create(self%table%path // '.new', error)
        if (.not. allocated(error)) call to%create(output%path, self%description, error)
        if (.not. allocated(error)) call walk_rows(self%file, self%file%rows, ending, error, to)
        if (.not. allocated(error)) call to%seal(ending%summary(), error)
        call to%close(problem)
        if (.not. allocated(error)) call move_alloc(problem, error)
        if (.not. allocated(error)) call self%confirm(output%path, error)
        if (.not. allocated(error)) call output%finish_as(self%table%path, -1_int64, error)
        if (allocated(error)) error%code = exit_output
        call output%discard()
    end subroutine convert

    !> Reads the first rows of a file: what its end says of them; puts them to another file, if there is one, or counts them
    !> by their status.
    subroutine walk_rows(from, rows, ending, error, to, counts)
        type(netcdf_file_t), intent(in) :: from
        integer(int64), intent(in) :: rows
        type(table_end_t), intent(out) :: ending
        type(error_t), allocatable, intent(out) :: error
        type(netcdf_file_t), intent(inout), optional :: to
        integer(int64), intent(inout), optional :: counts(0:last_status)
        real(dp), allocatable :: cells(:, :)
        integer(int64) :: first
        integer :: column, status

        column = findloc(from%description%columns%name == status_column, .true., dim=1)
        do first = 1, rows, rows_at_once
            allocate (cells(size(from%description%columns), min(int(rows_at_once, int64), rows - first + 1)))
            call from%get(first, cells, error)
            if (present(to) .and. .not. allocated(error)) call to%append(cells, error)
            if (allocated(error)) return
            call ending%add_cells(cells)
            if (present(counts) .and. column > 0) then
                counts = counts + [(count(nint(cells(column, :)) == status, kind=int64), status=0, last_status)]
            end if
            deallocate (cells)
        end do
    end subroutine walk_rows

    !> Checks that a file has all its rows, and that they are as they were written; and counts them by their status, or the
    !> motion by the attribute that tells how it ended.
    subroutine check_complete(self, path, problem)
        class(netcdf_table_t), intent(inout) :: self
        character(*), intent(in) :: path !! path of the file
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        type(netcdf_file_t) :: file
        type(table_end_t) :: ending
        type(error_t), allocatable :: error, ignored
        integer :: i, status

        call file%open(path, .false., error)
        if (.not. allocated(error)) call walk_rows(file, file%room, ending, error, counts=self%counts)
        if (allocated(error)) then
            problem = error%message
        else
            problem = end_problem(path, file, ending)
            do i = 1, size(file%description%facts)
                if (file%description%facts(i)%key /= status_column) cycle
                status = status_of_ending(file%description%facts(i)%value)
                if (status >= 0) self%counts(status) = self%counts(status) + 1
            end do
        end if
        call file%close(ignored)
    end subroutine check_complete

    !> How the end that a file names differs from its rows; '' if it does not.
    function end_problem(path, file, ending) result(problem)
        character(*), intent(in) :: path !! path of the file
        type(netcdf_file_t), intent(in) :: file !! the open file
        type(table_end_t), intent(in) :: ending !! of the rows that were read
        character(:), allocatable :: problem
        problem = ''
        if (file%description%ending == ending%summary()) return
        problem = path // ' was changed after it was written: its attribute end is "' // file%description%ending // &
                  '", that of its rows "' // ending%summary() // '"'
        if (file%description%ending == '') problem = path // ' is not known to be complete: it has no attribute end, as files &
                                                     &of earlier versions'
    end function end_problem

    !> Keeps part and journal for a later run, and adds that to the message of the error.
    subroutine abandon(self, error)
        class(netcdf_table_t), intent(inout) :: self
        type(error_t), intent(inout) :: error !! its message is completed
        type(error_t), allocatable :: ignored
        call self%file%close(ignored)
        call self%resumable_table_t%abandon(error)
    end subroutine abandon

    !> Removes part and journal.
    subroutine discard(self)
        class(netcdf_table_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        call self%file%close(ignored)
        call self%resumable_table_t%discard()
    end subroutine discard

end module spintop_netcdf_table
