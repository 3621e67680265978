!> A table of rows as a NetCDF file by the CF conventions: every column is a variable over the grid of the cases. The file
!> is made of finished rows, under another name until it was closed, read again and found to be what was written: the
!> library does not tell of all failures. A short read gives zeros, and a write that fails when a file is closed is no
!> error. It is read row by row:
!>
!>     call table%create(path, head, columns, layout, error)
!>     call table%add_rows(cells)
!>     call table%finish(error)
!>
!>     call table%open(path, error)
!>     do while (table%next_rows(cells, error)); ...; end do
!>     problem = table%problem()
!>
!> A build without the library can neither create nor open one.
module spintop_netcdf_table
    use, intrinsic :: iso_fortran_env, only: int64, int8
#ifdef SPINTOP_NETCDF
    use netcdf, only: nf90_64bit_offset, nf90_byte, nf90_char, nf90_clobber, nf90_close, nf90_create, nf90_def_dim, &
        nf90_def_var, nf90_double, nf90_ehdferr, nf90_enddef, nf90_get_att, nf90_get_var, nf90_global, nf90_inq_attname, &
        nf90_inquire, nf90_inquire_attribute, nf90_inquire_dimension, nf90_inquire_variable, nf90_int, nf90_max_name, &
        nf90_noerr, nf90_nofill, nf90_nowrite, nf90_open, nf90_put_att, nf90_put_var, nf90_set_fill, nf90_strerror, nf90_sync
#endif
#ifdef SPINTOP_NETCDF4
    use netcdf, only: nf90_def_var_chunking, nf90_def_var_deflate, nf90_format_netcdf4, nf90_format_netcdf4_classic, &
        nf90_inq_var_deflate, nf90_netcdf4
#endif
    use spintop_checksum, only: checksum_width
    use spintop_errors, only: error_t, input_error, output_error, exit_output
    use spintop_files, only: file_size, input_file_t, output_file_t
    use spintop_kinds, only: dp, no_number
    use spintop_netcdf_grid, only: find_box, netcdf_axis_t, netcdf_name, other_unit, size_of_chunk
    use spintop_process, only: expect_crash, leave_libraries
    use spintop_provenance, only: fact_t, header_of
    use spintop_status, only: last_status
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_reals, column_of_words, status_column, &
        table_column_t
    use spintop_table_end, only: check_table, place_of_summary, status_of_ending, table_end_t
    use spintop_table_head, only: first_line_of, is_netcdf, read_head, value_of, read_shard_line, shard_t
    use spintop_text, only: join, replace_all, split, string_t
    implicit none
    private
    public :: netcdf_layout_t, netcdf_table_t, write_netcdf_table, check_whole_table, head_of_table
    public :: has_netcdf, has_compression

    !> Whether this build contains the library, and whether that has the format NetCDF-4.
#ifdef SPINTOP_NETCDF
    logical, parameter :: has_netcdf = .true.
#else
    logical, parameter :: has_netcdf = .false.
#endif
#ifdef SPINTOP_NETCDF4
    logical, parameter :: has_compression = .true.
#else
    logical, parameter :: has_compression = .false.
#endif

    !> Name of the attribute that says how many rows there are, and their checksum.
    character(*), parameter :: end_key = 'end'
    character, parameter :: nl = new_line('a')
    !> Rows that are written, or read, at once.
    integer, parameter :: rows_at_once = 16384

    !> What a file has beside a table of text.
    type :: netcdf_layout_t
        !> The axes of the grid, of which the last varies fastest from row to row. Columns along an axis are its
        !> coordinate. The rows of a part of a sweep are no grid: they are stored along one dimension, and the axes are
        !> those of the whole.
        type(netcdf_axis_t), allocatable :: axes(:)
        !> Level of the compression, 0 to 9: a file in the format NetCDF-4. Without one (-1) it has the classic format.
        integer :: compression = -1
    end type netcdf_layout_t

    !> The values of the coordinate of an axis.
    type :: coordinate_t
        real(dp), allocatable :: values(:)
    end type coordinate_t

    !> A file that is being written or read. Its variables are the columns, in their order.
    type :: netcdf_table_t
        !> The header as a table of text has it; of a motion with the line that says how it ended.
        character(:), allocatable :: head
        type(table_column_t), allocatable :: columns(:)
        type(netcdf_layout_t) :: layout
        character(:), allocatable, private :: path
        logical, private :: is_read = .false., is_part = .false.
        integer, private :: id = -1
        !> The first error, after which nothing more is done.
        type(error_t), allocatable, private :: error
        integer, allocatable, private :: extent(:) !! of the grid; the first varies fastest
        !> Of each column the dimension along which alone it varies, counted from the fastest (0: from row to row), and
        !> its values along that.
        integer, allocatable, private :: along(:)
        type(coordinate_t), allocatable, private :: coordinates(:)
        !> What the file says of its rows, and what it would say of those so far.
        character(:), allocatable, private :: said
        type(table_end_t), private :: ending
        !> The file that gets the name of the table at the end.
        type(output_file_t), private :: output
    contains
        procedure :: create
        procedure :: add_rows => carry_rows
        procedure :: finish
        procedure :: open => open_table
        procedure :: next_rows
        procedure :: problem
        procedure :: close => close_library
        procedure, private :: place_columns
    end type netcdf_table_t

contains

    !> Creates a file for so many rows as its grid, or the line of a part in the header, says.
    subroutine create(self, path, head, columns, layout, error)
        class(netcdf_table_t), intent(out) :: self
        character(*), intent(in) :: path !! path of the table
        character(*), intent(in) :: head !! as a table of text has it; a motion's line of its end may follow
        type(table_column_t), intent(in) :: columns(:)
        type(netcdf_layout_t), intent(in) :: layout
        type(error_t), allocatable, intent(out) :: error !! not allocated on success

        self%path = path
        self%head = head
        self%columns = columns
        self%layout = layout
        call self%place_columns()
        self%said = place_of_summary(product(int(self%extent, int64)))
        call self%output%create(path // '.new', self%error)
        if (.not. allocated(self%error)) call define_table(self)
        if (allocated(self%error)) call self%finish(error)
    end subroutine create

    !> Finds out the extent of the grid, which of a part is its number of rows, and along which dimensions columns vary.
    subroutine place_columns(self)
        class(netcdf_table_t), intent(inout) :: self
        type(shard_t) :: shard
        integer(int64) :: cases
        integer :: n, i
        call read_shard_line(first_line_of(self%head), shard, cases, self%is_part)
        n = size(self%layout%axes)
        if (self%is_part) then
            self%extent = [int(shard%last(cases) - shard%first(cases) + 1)]
        else
            self%extent = self%layout%axes(n:1:-1)%length
        end if
        ! The coordinate of the only dimension varies from row to row.
        self%along = merge(n - self%columns%axis + 1, 0, self%columns%axis > 0 .and. .not. self%is_part .and. n > 1)
        allocate (self%coordinates(size(self%columns)))
        do i = 1, size(self%columns)
            if (self%along(i) > 0) allocate (self%coordinates(i)%values(self%extent(self%along(i))), source=0.0_dp)
        end do
    end subroutine place_columns

    !> Closes the file that has all its rows, compares it with what was written, and gives it the name of the table; or
    !> discards it after an error.
    subroutine finish(self, error)
        class(netcdf_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(netcdf_table_t) :: written
        real(dp), allocatable :: cells(:, :)

        self%said = self%ending%summary()
        call self%close()
        if (allocated(self%error)) then
            call move_alloc(self%error, error)
        else
            call written%open(self%output%path, error)
            do while (written%next_rows(cells, error))
                cycle
            end do
            if (.not. allocated(error)) then
                if (written%head /= self%head .or. written%said /= self%said .or. written%problem() /= '') then
                    error = output_error('cannot write ' // self%output%path // ': what is read from it is not what was written')
                end if
                call written%close()
            end if
            if (.not. allocated(error)) call self%output%finish_as(self%path, -1_int64, error)
        end if
        if (allocated(error)) error%code = exit_output
        call self%output%discard()
    end subroutine finish

    !> Reads the next rows; false behind the last, or after an error.
    logical function next_rows(self, cells, error) result(found)
        class(netcdf_table_t), intent(inout) :: self
        real(dp), allocatable, intent(inout) :: cells(:, :) !! the cell of column i in row k is `cells(i, k)`
        type(error_t), allocatable, intent(inout) :: error !! not allocated on success
        integer(int64) :: left

        found = .false.
        if (allocated(error)) return
        left = product(int(self%extent, int64)) - self%ending%rows()
        if (left <= 0) return
        if (allocated(cells)) deallocate (cells)
        allocate (cells(size(self%columns), min(left, int(rows_at_once, int64))), source=0.0_dp)
        call carry_rows(self, cells)
        if (allocated(self%error)) error = self%error
        found = .not. allocated(error)
    end function next_rows

    !> How the end that the file names differs from the rows that were read; '' if it does not.
    function problem(self)
        class(netcdf_table_t), intent(in) :: self
        character(:), allocatable :: problem
        problem = ''
        if (self%said == self%ending%summary()) return
        problem = self%path // ' was changed after it was written: its attribute end is "' // self%said // &
                  '", that of its rows "' // self%ending%summary() // '"'
        if (self%said == '') problem = self%path // ' is not known to be complete: it has no attribute end, as files &
                                       &of earlier versions'
    end function problem

    !> Writes a table of which a part (spintop_table_file) has all rows, as they are in memory, behind the header.
    subroutine write_netcdf_table(path, head, columns, layout, part, checksum, error)
        character(*), intent(in) :: path, part !! paths of the table and of the part
        character(*), intent(in) :: head !! as for `create`
        type(table_column_t), intent(in) :: columns(:)
        type(netcdf_layout_t), intent(in) :: layout
        character(2 * checksum_width), intent(in) :: checksum !! of the bytes of the part, as `table_end_t` has it
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(netcdf_table_t) :: table
        type(input_file_t) :: file
        type(table_end_t) :: of_part
        character(:), allocatable :: bytes
        real(dp), allocatable :: cells(:, :)
        integer(int64) :: first, rows, before
        integer :: bytes_of_row, length, n

        call table%create(path, head, columns, layout, error)
        if (allocated(error)) return
        rows = product(int(table%extent, int64))
        bytes_of_row = size(columns) * (storage_size(cells) / 8)
        before = file_size(part) - rows * bytes_of_row
        if (before < 0) table%error = input_error(part // ' has not all rows of the table')
        if (.not. allocated(table%error)) call file%open(part, table%error)
        allocate (character(max(0_int64, before)) :: bytes)
        if (.not. allocated(table%error)) call file%read(bytes, length, table%error)
        call of_part%add(bytes)
        do first = 1, rows, rows_at_once
            if (allocated(table%error)) exit
            n = int(min(int(rows_at_once, int64), rows - first + 1))
            if (len(bytes) /= n * bytes_of_row .or. .not. allocated(cells)) then
                deallocate (bytes)
                allocate (character(n * bytes_of_row) :: bytes)
            end if
            call file%read(bytes, length, table%error)
            call of_part%add(bytes)
            cells = reshape(transfer(bytes, cells, size=size(columns) * n), [size(columns), n])
            call table%add_rows(cells)
        end do
        call file%close()
        if (of_part%checksum() /= checksum .and. .not. allocated(table%error)) then
            table%error = input_error(part // ' was changed after it was written')
        end if
        call table%finish(error)
    end subroutine write_netcdf_table

    !> Checks that a table in either format has all its rows, and that they are as they were written; and counts them by their
    !> status, or the motion by what tells how it ended.
    subroutine check_whole_table(path, problem, counts, status_place)
        character(*), intent(in) :: path !! path of the file
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        integer(int64), intent(inout) :: counts(0:last_status) !! increased by the number of rows with each status
        integer, intent(in), optional :: status_place !! number of the column of the statuses in a table of text, if it has one
        type(netcdf_table_t) :: table
        type(error_t), allocatable :: error
        real(dp), allocatable :: cells(:, :)
        integer :: column, status

        if (.not. is_netcdf(path)) then
            column = 0
            if (present(status_place)) column = status_place
            call check_table(path, problem, column, counts)
            return
        end if
        call table%open(path, error)
        if (.not. allocated(error)) then
            column = findloc(table%columns%name == status_column, .true., dim=1)
            do while (table%next_rows(cells, error))
                if (column == 0) cycle
                counts = counts + [(count(nint(cells(column, :)) == status, kind=int64), status=0, last_status)]
            end do
            problem = table%problem()
            status = status_of_ending(value_of(status_column, table%head))
            if (status >= 0) counts(status) = counts(status) + 1
            call table%close()
        end if
        if (allocated(error)) problem = error%message
    end subroutine check_whole_table

    !> The header of a table in either format, as text.
    subroutine head_of_table(path, head, error)
        character(*), intent(in) :: path !! path of the table
        character(:), allocatable, intent(out) :: head !! the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(netcdf_table_t) :: table

        if (.not. is_netcdf(path)) then
            call read_head(path, head, error)
            return
        end if
        head = ''
        call table%open(path, error)
        if (allocated(error)) return
        head = table%head
        call table%close()
    end subroutine head_of_table

#ifdef SPINTOP_NETCDF
    !> Defines attributes, dimensions and variables. The number of the case is an auxiliary coordinate of a grid.
    subroutine define_table(self)
        type(netcdf_table_t), intent(inout) :: self
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: input
        logical :: has_auxiliary
        integer :: i, k, id

        call create_file(self)
        call put_text(self, nf90_global, 'Conventions', 'CF-1.8')
        call split(self%head, nl, lines, keeps_blanks=.true.)
        input = ''
        do i = merge(2, 1, self%is_part), size(lines)
            if (lines(i)%text == '# input:') exit
            k = index(lines(i)%text, ': ')
            if (k > 0) call put_text(self, nf90_global, lines(i)%text(len('# ') + 1:k - 1), lines(i)%text(k + 2:))
        end do
        do i = i + 1, size(lines)
            if (lines(i)%text == '# columns:') exit
            input = input // lines(i)%text(min(len('#     '), len(lines(i)%text)) + 1:) // nl
        end do
        associate (axes => self%layout%axes, columns => self%columns, is_part => self%is_part)
            call put_text(self, nf90_global, 'input', input(:len(input) - len(nl)))
            if (is_part) then
                call put_text(self, nf90_global, 'part', lines(1)%text(len('# ') + 1:))
                call put_text(self, nf90_global, 'grid', join(axes%name, ' '))
                call check(self, nf90_put_att(self%id, nf90_global, 'grid_lengths', axes%length))
            end if
            ! Later no attribute may become longer.
            call put_text(self, nf90_global, end_key, self%said)
            do i = 1, size(self%extent)
                if (is_part) call check(self, nf90_def_dim(self%id, netcdf_name(columns(1)%name), self%extent(1), id))
                if (.not. is_part) call check(self, nf90_def_dim(self%id, netcdf_name(axes(i)%name), axes(i)%length, id))
            end do
            has_auxiliary = columns(1)%kind == column_of_integers .and. all(axes%name /= columns(1)%name) .and. .not. is_part
            do i = 1, size(columns)
                call define_variable(self, i)
                if (i > 1 .and. has_auxiliary .and. columns(i)%axis == 0) then
                    call put_text(self, i, 'coordinates', netcdf_name(columns(1)%name))
                end if
            end do
        end associate
        call check(self, nf90_enddef(self%id))
    end subroutine define_table

    !> Creates an empty file. Every value is written, so filling the file beforehand would write it twice.
    subroutine create_file(self)
        type(netcdf_table_t), intent(inout) :: self
        integer, parameter :: bytes_at_once = 65536
        integer :: status, chunk, old_mode
        chunk = bytes_at_once
        if (self%layout%compression < 0 .or. .not. has_compression) then
            status = nf90_create(self%output%path, ior(nf90_clobber, nf90_64bit_offset), self%id, chunksize=chunk)
        else
#ifdef SPINTOP_NETCDF4
            status = nf90_create(self%output%path, ior(nf90_clobber, nf90_netcdf4), self%id)
            ! The library does not know why, and names a reason of the system.
            if (status > 0) status = nf90_ehdferr
#endif
        end if
        if (status /= nf90_noerr) self%id = -1
        if (status == nf90_noerr) status = nf90_set_fill(self%id, nf90_nofill, old_mode)
        call check(self, status)
    end subroutine create_file

    !> Defines the variable of a column, compressed in chunks of consecutive elements where compression is asked for.
    subroutine define_variable(self, i)
        type(netcdf_table_t), intent(inout) :: self
        integer, intent(in) :: i !! number of the column, and of the variable
        integer, allocatable :: own(:), values(:)
        integer :: types(4), id, k
        character(:), allocatable :: words

        types = [nf90_double, nf90_int, nf90_byte, nf90_int]
        ! Dimensions were defined from the last one on.
        allocate (own, source=[(k, k=1, size(self%extent))])
        if (self%along(i) > 0) own = [self%along(i)]
        associate (column => self%columns(i), dimensions => size(self%extent) + 1 - own, lengths => self%extent(own))
            call check(self, nf90_def_var(self%id, netcdf_name(column%name), types(column%kind), dimensions, id))
#ifdef SPINTOP_NETCDF4
            if (self%layout%compression > 0 .and. all(lengths > 0)) then
                call check(self, nf90_def_var_chunking(self%id, i, 0, size_of_chunk(lengths)))
                call check(self, nf90_def_var_deflate(self%id, i, 1, 1, self%layout%compression))
            end if
#endif
            call put_text(self, i, 'column', trim(column%name))
            call put_text(self, i, 'long_name', trim(column%what))
            select case (column%kind)
            case (column_of_reals)
                call put_text(self, i, 'units', other_unit(column%unit, is_own=.true.))
                if (column%axis == 0) call check(self, nf90_put_att(self%id, i, '_FillValue', [no_number]))
            case (column_of_words, column_of_notes)
                ! The meanings of the values, or of the bits of notes.
                words = ''
                do k = 1, size(column%words)
                    words = words // ' ' // replace_all(trim(column%words(k)%text), ' ', '_')
                end do
                call put_text(self, i, 'flag_meanings', words(2:))
                allocate (values, source=[(k, k=0, size(column%words) - 1)])
                if (column%kind == column_of_notes) then
                    call check(self, nf90_put_att(self%id, i, 'flag_masks', shiftl(1, values)))
                else
                    call check(self, nf90_put_att(self%id, i, 'flag_values', int(values, int8)))
                end if
            case (column_of_integers)
            end select
        end associate
    end subroutine define_variable

    !> Adds an attribute, unless it is empty.
    subroutine put_text(self, variable, name, text)
        type(netcdf_table_t), intent(inout) :: self
        integer, intent(in) :: variable
        character(*), intent(in) :: name, text
        if (.not. allocated(self%error) .and. text /= '') call check(self, nf90_put_att(self%id, variable, name, text))
    end subroutine put_text

    !> Puts the next rows, or gets them. Columns along one axis are kept until the file is closed, and are known since it was
    !> opened.
    subroutine carry_rows(self, cells)
        class(netcdf_table_t), intent(inout) :: self
        real(dp), intent(inout) :: cells(:, :) !! the cell of column i in row k is `cells(i, k)`
        real(dp) :: values(size(cells, 2))
        integer :: start(size(self%extent)), extent(size(self%extent)), i, row, done, place
        integer(int64) :: first, stride

        first = self%ending%rows() + 1
        do i = 1, size(cells, 1)
            if (allocated(self%error)) return
            if (self%along(i) > 0) then
                stride = product(int(self%extent(:self%along(i) - 1), int64))
                associate (coordinate => self%coordinates(i)%values)
                    do row = 1, size(cells, 2)
                        place = int(mod((first + row - 2) / stride, size(coordinate, kind=int64))) + 1
                        if (self%is_read) cells(i, row) = coordinate(place)
                        if (.not. self%is_read) coordinate(place) = cells(i, row)
                    end do
                end associate
                cycle
            end if
            values = cells(i, :)
            done = 0
            do while (done < size(values))
                call find_box(self%extent, first + done, int(size(values) - done, int64), start, extent)
                associate (box => values(done + 1:done + product(extent)))
                    if (self%is_read) call check(self, nf90_get_var(self%id, i, box, start, extent))
                    if (.not. self%is_read) call check(self, nf90_put_var(self%id, i, box, start, extent))
                end associate
                done = done + product(extent)
            end do
            if (self%is_read) cells(i, :) = values
        end do
        call self%ending%add_cells(cells)
    end subroutine carry_rows

    !> Opens a file, and reads all but its rows.
    subroutine open_table(self, path, error)
        class(netcdf_table_t), intent(out) :: self
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success; then the file is closed
        type(netcdf_axis_t), allocatable :: axes(:)
        integer :: dimensions, variables, i, k

        self%path = path
        self%is_read = .true.
        dimensions = 0
        variables = 0
        call check(self, nf90_open(self%path, nf90_nowrite, self%id))
        if (allocated(self%error)) self%id = -1
        if (.not. allocated(self%error)) call check(self, nf90_inquire(self%id, nDimensions=dimensions, nVariables=variables))
        self%layout%compression = compression_of(self%id)
        allocate (axes(dimensions), self%columns(variables))
        do i = 1, dimensions
            if (.not. allocated(self%error)) call check(self, nf90_inquire_dimension(self%id, i, axes(i)%name, axes(i)%length))
        end do
        do i = 1, variables
            if (.not. allocated(self%error)) call read_column(self, i, self%columns(i))
        end do
        call read_attributes(self, axes)
        if (min(variables, dimensions) == 0 .or. any(self%columns%name == '') .or. index(self%head, ': ') == 0) then
            if (.not. allocated(self%error)) self%error = input_error('cannot read ' // path // ': it is no table of spintop')
        end if
        if (allocated(self%error)) then
            call self%close()
            call move_alloc(self%error, error)
            return
        end if
        ! Each dimension has a coordinate, or is that of the cases.
        do i = 1, size(axes)
            do k = 1, size(self%columns)
                if (netcdf_name(trim(self%columns(k)%name)) /= netcdf_name(trim(axes(i)%name))) cycle
                axes(i)%name = self%columns(k)%name
                if (self%columns(k)%kind == column_of_reals) self%columns(k)%axis = i
            end do
        end do
        self%layout%axes = axes
        call self%place_columns()
        do i = 1, size(self%columns)
            if (self%along(i) > 0) call check(self, nf90_get_var(self%id, i, self%coordinates(i)%values))
        end do
        if (allocated(self%error)) call self%close()
        call move_alloc(self%error, error)
    end subroutine open_table

    !> Reads the attributes of the whole file, which make up the header. Of a part the axes are those of the whole.
    subroutine read_attributes(self, axes)
        type(netcdf_table_t), intent(inout) :: self
        type(netcdf_axis_t), allocatable, intent(inout) :: axes(:)
        character(nf90_max_name) :: name
        character(:), allocatable :: part, text
        type(fact_t), allocatable :: facts(:)
        type(string_t), allocatable :: input(:), words(:)
        integer, allocatable :: lengths(:)
        integer :: i, n, all, length, kind

        self%said = ''
        part = ''
        n = 0
        all = 0
        allocate (input(0), words(0), lengths(0))
        if (.not. allocated(self%error)) call check(self, nf90_inquire(self%id, nAttributes=all))
        allocate (facts(all))
        do i = 1, all
            if (allocated(self%error)) exit
            call check(self, nf90_inq_attname(self%id, nf90_global, i, name))
            if (allocated(self%error)) exit
            call check(self, nf90_inquire_attribute(self%id, nf90_global, name, xtype=kind, len=length))
            if (name == 'grid_lengths') then
                deallocate (lengths)
                allocate (lengths(length), source=0)
                call check(self, nf90_get_att(self%id, nf90_global, name, lengths))
            end if
            if (kind /= nf90_char) cycle
            text = text_of(self, nf90_global, trim(name))
            select case (name)
            case ('Conventions')
            case ('input')
                call split(text, nl, input, keeps_blanks=.true.)
            case (end_key)
                self%said = text
            case ('part')
                part = text
            case ('grid')
                call split(text, ' ', words)
            case default
                n = n + 1
                facts(n)%key = trim(name)
                facts(n)%value = text
            end select
        end do
        self%head = header_of(part, facts(:n), input, self%columns)
        if (part /= '') axes = [(netcdf_axis_t(words(i)%text, lengths(i)), i=1, min(size(words), size(lengths)))]
    end subroutine read_attributes

    !> What a column is, except for its axis.
    subroutine read_column(self, i, column)
        type(netcdf_table_t), intent(inout) :: self
        integer, intent(in) :: i !! number of the column, and of the variable
        type(table_column_t), intent(out) :: column
        character(:), allocatable :: words
        integer :: kind

        call check(self, nf90_inquire_variable(self%id, i, xtype=kind))
        column%name = text_of(self, i, 'column')
        column%what = text_of(self, i, 'long_name')
        column%unit = other_unit(text_of(self, i, 'units'), is_own=.false.)
        words = text_of(self, i, 'flag_meanings')
        column%kind = column_of_integers
        if (kind == nf90_double) column%kind = column_of_reals
        if (kind == nf90_byte) column%kind = column_of_words
        if (words == '') return
        if (kind == nf90_int) column%kind = column_of_notes
        call split(words, ' ', column%words)
    end subroutine read_column

    !> An attribute that is a text; '' if there is none.
    function text_of(self, variable, name) result(text)
        type(netcdf_table_t), intent(inout) :: self
        integer, intent(in) :: variable
        character(*), intent(in) :: name
        character(:), allocatable :: text
        integer :: length, kind
        text = ''
        if (allocated(self%error)) return
        if (nf90_inquire_attribute(self%id, variable, name, xtype=kind, len=length) /= nf90_noerr) return
        if (kind /= nf90_char) return
        text = repeat(' ', length)
        call check(self, nf90_get_att(self%id, variable, name, text))
    end function text_of

    !> The level of the compression of all variables; -1 in the classic format.
    integer function compression_of(id) result(level)
        integer, intent(in) :: id
        level = -1
#ifdef SPINTOP_NETCDF4
        block
            integer :: format, shuffled, deflated, level_of_first
            if (nf90_inquire(id, formatNum=format) /= nf90_noerr) return
            if (all(format /= [nf90_format_netcdf4, nf90_format_netcdf4_classic])) return
            level = 0
            if (nf90_inq_var_deflate(id, 1, shuffled, deflated, level_of_first) /= nf90_noerr) return
            if (deflated /= 0) level = level_of_first
        end block
#endif
    end function compression_of

    !> Closes the file; one that is written has then its coordinates and what is said of its rows. After an error of writing
    !> a file in the format NetCDF-4 is left open, because HDF5 ends the process where it cannot close it.
    subroutine close_library(self)
        class(netcdf_table_t), intent(inout) :: self
        integer :: status, i
        if (self%id < 0) return
        if (.not. self%is_read) then
            do i = 1, size(self%columns)
                if (self%along(i) > 0 .and. .not. allocated(self%error)) then
                    call check(self, nf90_put_var(self%id, i, self%coordinates(i)%values))
                end if
            end do
            call put_text(self, nf90_global, end_key, self%said)
            ! The library does not tell whether the last writes fail when the file is closed.
            if (.not. allocated(self%error)) call check(self, nf90_sync(self%id))
        end if
        if (allocated(self%error) .and. self%layout%compression >= 0 .and. .not. self%is_read) then
            call leave_libraries()
        else
            ! netCDF crashes where HDF5 cannot close a file.
            if (self%layout%compression >= 0) call expect_crash(message_on(self, nf90_ehdferr) // nl)
            status = nf90_close(self%id)
            if (self%layout%compression >= 0) call expect_crash('')
            if (.not. self%is_read) call check(self, status)
        end if
        self%id = -1
    end subroutine close_library

    !> Makes an error from a status of the library.
    subroutine check(self, status)
        type(netcdf_table_t), intent(inout) :: self
        integer, intent(in) :: status
        if (status == nf90_noerr .or. allocated(self%error)) return
        self%error = output_error(message_on(self, status))
        if (self%is_read) self%error = input_error(message_on(self, status))
    end subroutine check

    !> Says what cannot be done, and why.
    function message_on(self, status) result(message)
        type(netcdf_table_t), intent(in) :: self
        integer, intent(in) :: status
        character(:), allocatable :: message
        if (self%is_read) then
            message = 'cannot read ' // self%path
        else
            message = 'cannot write ' // self%output%path
        end if
        message = message // ': ' // trim(nf90_strerror(status))
    end function message_on
#else
    !> The error of this build.
    subroutine define_table(self)
        type(netcdf_table_t), intent(inout) :: self
        self%error = output_error('cannot open ' // self%path // ': this build has no NetCDF')
    end subroutine define_table

    !> Opens no file.
    subroutine open_table(self, path, error)
        class(netcdf_table_t), intent(out) :: self
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! the error of this build
        self%path = path
        error = input_error('cannot open ' // path // ': this build has no NetCDF')
    end subroutine open_table

    !> Carries nothing.
    subroutine carry_rows(self, cells)
        class(netcdf_table_t), intent(inout) :: self
        real(dp), intent(inout) :: cells(:, :) !! set to zero
        cells = 0
        if (allocated(self%error)) return
    end subroutine carry_rows

    !> No file is open.
    subroutine close_library(self)
        class(netcdf_table_t), intent(inout) :: self
        self%id = -1
    end subroutine close_library
#endif

end module spintop_netcdf_table
