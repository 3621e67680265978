!> A table of rows as a NetCDF file: every column is a variable over the grid of the cases. The file is made of a part of
!> the table (spintop_resumable_table) that is complete, and is read row by row:
!>
!>     call write_netcdf_table(path, description, part, checksum, error)
!>     call table%open(path, error)
!>     do while (table%next_rows(cells, error)); ...; end do
!>     problem = table%problem()
module spintop_netcdf_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_checksum, only: checksum_width
    use spintop_errors, only: error_t, input_error
    use spintop_files, only: file_size, input_file_t
    use spintop_kinds, only: dp, no_number
    use spintop_netcdf_file, only: is_netcdf, netcdf_contents_t, netcdf_file_t, whole_file, write_netcdf
    use spintop_netcdf_grid, only: find_box, netcdf_axis_t, netcdf_name, own_unit
    use spintop_provenance, only: header_of, fact_t
    use spintop_shard, only: read_shard_line, shard_t
    use spintop_status, only: last_status
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_reals, status_column, table_column_t
    use spintop_table_end, only: place_of_summary, status_of_ending, table_end_t
    use spintop_table_head, only: read_head
    use spintop_text, only: join, split, string_t
    implicit none
    private
    public :: netcdf_description_t, netcdf_table_t, write_netcdf_table, check_netcdf_table, head_of_table

    !> Name of the attribute that says how many rows there are, and their checksum.
    character(*), parameter :: end_key = 'end'
    !> Rows that are written, or read, at once.
    integer, parameter :: rows_at_once = 16384

    !> All but the rows.
    type :: netcdf_description_t
        !> Attributes of the whole file, and another one: the lines of the resolved input.
        type(fact_t), allocatable :: facts(:)
        type(string_t), allocatable :: input(:)
        type(table_column_t), allocatable :: columns(:)
        !> The axes of the grid, of which the last varies fastest from row to row. Columns along an axis are its
        !> coordinate.
        type(netcdf_axis_t), allocatable :: axes(:)
        !> The line that names a part of a sweep; '' if the file contains the whole. The rows of a part are no grid: they
        !> are stored along one dimension, and the axes are those of the whole.
        character(:), allocatable :: part
        !> Level of the compression, or -1: see `netcdf_file_t`.
        integer :: compression = -1
    contains
        procedure :: head
        procedure :: extent
        procedure, private :: along
    end type netcdf_description_t

    !> A file that is being read.
    type :: netcdf_table_t
        type(netcdf_description_t) :: description
        type(netcdf_file_t), private :: file
        !> What the file says of its rows, and what it would say of those read so far.
        character(:), allocatable, private :: said
        type(table_end_t), private :: ending
        integer, allocatable, private :: extent(:) !! of the grid; the first varies fastest
    contains
        procedure :: open => open_table
        procedure :: next_rows
        procedure :: problem
        procedure :: close => close_table
    end type netcdf_table_t

    !> What is written.
    type, extends(netcdf_contents_t) :: table_contents_t
        type(netcdf_description_t) :: description
        !> The part: its header, and then the rows as they are in memory.
        character(:), allocatable :: part
        character(2 * checksum_width) :: checksum = ''
        !> What the file says of the rows; '' until they were read.
        character(:), allocatable :: summary
    contains
        procedure :: put => put_table
    end type table_contents_t

contains

    !> The header as a table of text has it.
    function head(self) result(text)
        class(netcdf_description_t), intent(in) :: self
        character(:), allocatable :: text
        text = header_of(self%part, self%facts, self%input, self%columns)
    end function head

    !> The extent of the grid; the first varies fastest. Of a part it is the number of rows, 0 if its line is damaged.
    function extent(self)
        class(netcdf_description_t), intent(in) :: self
        integer, allocatable :: extent(:)
        type(shard_t) :: shard
        integer(int64) :: cases
        logical :: valid
        if (self%part == '') then
            extent = self%axes(size(self%axes):1:-1)%length
        else
            call read_shard_line(self%part, shard, cases, valid)
            extent = [merge(int(shard%last(cases) - shard%first(cases) + 1), 0, valid)]
        end if
    end function extent

    !> The dimension along which a column varies, counted from the fastest; 0 if it varies from row to row.
    pure integer function along(self, column)
        class(netcdf_description_t), intent(in) :: self
        integer, intent(in) :: column
        along = 0
        if (self%part == '' .and. self%columns(column)%axis > 0) along = size(self%axes) - self%columns(column)%axis + 1
    end function along

    !> Writes a table of which a part has all rows, behind the header.
    subroutine write_netcdf_table(path, description, part, checksum, error)
        character(*), intent(in) :: path, part !! paths of the table and of the part
        type(netcdf_description_t), intent(in) :: description !! all but the rows
        character(2 * checksum_width), intent(in) :: checksum !! of the bytes of the part, as `table_end_t` has it
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(table_contents_t) :: contents
        contents%description = description
        contents%part = part
        contents%checksum = checksum
        contents%summary = place_of_summary(product(int(description%extent(), int64)))
        call write_netcdf(path, contents, description%compression, error)
    end subroutine write_netcdf_table

    !> Puts a table to a file.
    subroutine put_table(self, file)
        class(table_contents_t), intent(inout) :: self
        type(netcdf_file_t), intent(inout) :: file !! the open file
        type(input_file_t) :: part
        type(table_end_t) :: ending, of_part
        character(:), allocatable :: bytes, head
        real(dp), allocatable :: cells(:, :)
        integer, allocatable :: extent(:), variables(:)
        integer(int64) :: first, rows, before
        integer :: columns, bytes_of_row, length, i, k, n

        associate (description => self%description)
            call define_table(description, file, self%summary, variables)
            allocate (extent, source=description%extent())
            rows = product(int(extent, int64))
            columns = size(variables)
            bytes_of_row = columns * (storage_size(0.0_dp) / 8)
            before = file_size(self%part) - rows * bytes_of_row
            if (before < 0 .and. .not. allocated(file%error)) then
                file%error = input_error(self%part // ' has not all rows of the table')
            end if
            allocate (character(max(0_int64, before)) :: head)
            if (.not. allocated(file%error)) call part%open(self%part, file%error)
            if (.not. allocated(file%error)) call part%read(head, length, file%error)
            call of_part%add(head)
            allocate (character(bytes_of_row * int(min(rows, int(rows_at_once, int64)))) :: bytes)
            allocate (cells(columns, rows_at_once))
            do first = 1, rows, rows_at_once
                if (allocated(file%error)) exit
                n = int(min(int(rows_at_once, int64), rows - first + 1))
                call part%read(bytes(:n * bytes_of_row), length, file%error)
                call of_part%add(bytes(:n * bytes_of_row))
                cells(:, :n) = reshape(transfer(bytes(:n * bytes_of_row), cells, size=columns * n), [columns, n])
                call ending%add_cells(cells(:, :n))
                do i = 1, columns
                    k = description%along(i)
                    if (k > 0) then
                        call put_coordinate(file, variables(i), extent, k, first, cells(i, :n))
                    else
                        call put_boxes(file, variables(i), extent, first, cells(i, :n))
                    end if
                end do
            end do
            call part%close()
            if (of_part%checksum() /= self%checksum .and. .not. allocated(file%error)) then
                file%error = input_error(self%part // ' was changed after it was written')
            end if
            self%summary = ending%summary()
            call file%add_text(whole_file, end_key, self%summary)
        end associate
    end subroutine put_table

    !> Defines attributes, dimensions and variables of a table. The number of the case is an auxiliary coordinate of a grid.
    subroutine define_table(description, file, summary, variables)
        type(netcdf_description_t), intent(in) :: description
        type(netcdf_file_t), intent(inout) :: file
        character(*), intent(in) :: summary !! as long as that which the file will have
        integer, allocatable, intent(out) :: variables(:)
        integer, allocatable :: extent(:), dimensions(:)
        logical :: has_auxiliary
        integer :: i, k

        allocate (extent, source=description%extent())
        allocate (dimensions(size(extent)), variables(size(description%columns)))
        associate (columns => description%columns, axes => description%axes, is_part => description%part /= '')
            call file%add_text(whole_file, 'Conventions', 'CF-1.8')
            do i = 1, size(description%facts)
                call file%add_text(whole_file, description%facts(i)%key, description%facts(i)%value)
            end do
            call file%add_text(whole_file, 'input', join(description%input, new_line('a')))
            if (is_part) then
                call file%add_text(whole_file, 'part', description%part)
                call file%add_text(whole_file, 'grid', join(axes%name, ' '))
                call file%add_numbers(whole_file, 'grid_lengths', real(axes%length, dp), column_of_integers)
            end if
            ! Later no attribute may become longer.
            call file%add_text(whole_file, end_key, summary)
            if (is_part) then
                call file%add_dimension(netcdf_name(columns(1)%name), extent(1), dimensions(1))
            else
                do i = 1, size(axes)
                    call file%add_dimension(netcdf_name(axes(i)%name), axes(i)%length, dimensions(size(axes) - i + 1))
                end do
            end if
            has_auxiliary = columns(1)%kind == column_of_integers .and. all(axes%name /= columns(1)%name) .and. .not. is_part
            do i = 1, size(columns)
                k = description%along(i)
                call file%add_variable(netcdf_name(columns(i)%name), columns(i), &
                                       dimensions(merge(k, 1, k > 0):merge(k, size(extent), k > 0)), variables(i))
                if (columns(i)%kind == column_of_reals .and. columns(i)%axis == 0) then
                    call file%add_numbers(variables(i), '_FillValue', [no_number], column_of_reals)
                end if
                if (i > 1 .and. has_auxiliary .and. k == 0) then
                    call file%add_text(variables(i), 'coordinates', netcdf_name(columns(1)%name))
                end if
            end do
        end associate
    end subroutine define_table

    !> Puts the cells of consecutive rows of a column over the whole grid.
    subroutine put_boxes(file, variable, extent, first, values)
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: variable, extent(:)
        integer(int64), intent(in) :: first !! number of the first row
        real(dp), intent(in) :: values(:)
        integer :: start(size(extent)), count(size(extent)), done

        done = 0
        do while (done < size(values))
            call find_box(extent, first + done, int(size(values) - done, int64), start, count)
            call file%put(variable, values(done + 1:done + product(count)), start, count)
            done = done + product(count)
        end do
    end subroutine put_boxes

    !> Puts the new values of the coordinate of an axis: at rows that are the first with their value.
    subroutine put_coordinate(file, variable, extent, along, first, values)
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: variable, extent(:), along !! the dimension of the axis
        integer(int64), intent(in) :: first !! number of the first row
        real(dp), intent(in) :: values(:)
        integer(int64) :: stride, from, to, row

        stride = product(int(extent(:along - 1), int64))
        from = (first - 1 + stride - 1) / stride
        to = min(int(extent(along), int64), (first - 1 + size(values) + stride - 1) / stride) - 1
        if (from > to) return
        row = from * stride - first + 2
        call file%put(variable, values(row:row + (to - from) * stride:stride), [int(from) + 1], [int(to - from) + 1])
    end subroutine put_coordinate

    !> Opens a file, and reads its description.
    subroutine open_table(self, path, error)
        class(netcdf_table_t), intent(out) :: self
        character(*), intent(in) :: path !! path of the file
        type(error_t), allocatable, intent(out) :: error !! not allocated on success; then the file is closed
        type(netcdf_axis_t), allocatable :: axes(:)
        integer, allocatable :: kinds(:)
        integer :: i

        call self%file%open(path, .true.)
        self%description%compression = self%file%compression
        call read_attributes(self)
        call self%file%read_layout(axes, kinds)
        self%extent = axes(size(axes):1:-1)%length
        allocate (self%description%columns(size(kinds)))
        do i = 1, size(kinds)
            call read_column(self%file, i, kinds(i), self%description%columns(i))
        end do
        associate (description => self%description)
            if (description%part == '') description%axes = axes
            call find_axes(description)
            if (min(size(description%facts), size(kinds), size(axes)) == 0 .or. any(description%columns%name == '')) then
                if (.not. allocated(self%file%error)) then
                    self%file%error = input_error('cannot read ' // path // ': it is no table of spintop')
                end if
            end if
        end associate
        if (allocated(self%file%error)) call self%file%close(error)
    end subroutine open_table

    !> Reads the attributes of the whole file.
    subroutine read_attributes(self)
        type(netcdf_table_t), intent(inout) :: self
        type(fact_t), allocatable :: facts(:)
        type(string_t), allocatable :: words(:)
        real(dp), allocatable :: lengths(:)
        integer :: i, n

        self%said = ''
        call self%file%read_facts(facts)
        n = 0
        allocate (words(0)) ! or gfortran warns of bounds without values
        associate (description => self%description)
            allocate (description%input(0))
            description%part = ''
            do i = 1, size(facts)
                select case (facts(i)%key)
                case ('Conventions')
                case ('input')
                    call split(facts(i)%value, new_line('a'), description%input, keeps_blanks=.true.)
                case (end_key)
                    self%said = facts(i)%value
                case ('part')
                    description%part = facts(i)%value
                case ('grid')
                    call split(facts(i)%value, ' ', words)
                case default
                    n = n + 1
                    facts(n) = facts(i)
                end select
            end do
            description%facts = facts(:n)
            ! The axes of the whole, in the file of a part.
            call self%file%read_numbers(whole_file, 'grid_lengths', lengths)
            description%axes = [(netcdf_axis_t(words(i)%text, nint(lengths(i))), i=1, min(size(words), size(lengths)))]
        end associate
    end subroutine read_attributes

    !> What a column is, except for its axis.
    subroutine read_column(file, variable, kind, column)
        type(netcdf_file_t), intent(inout) :: file
        integer, intent(in) :: variable, kind !! as the type of the variable has it
        type(table_column_t), intent(out) :: column
        character(:), allocatable :: text

        call file%read_text(variable, 'column', text)
        column%name = text
        call file%read_text(variable, 'long_name', text)
        column%what = text
        call file%read_text(variable, 'units', text)
        column%unit = own_unit(text)
        call file%read_text(variable, 'flag_meanings', text)
        column%kind = merge(kind, column_of_integers, kind > 0)
        if (text == '') return
        if (column%kind == column_of_integers) column%kind = column_of_notes
        call split(text, ' ', column%words)
    end subroutine read_column

    !> Finds the columns that are the axes: each dimension has a coordinate, or is that of the cases.
    subroutine find_axes(description)
        type(netcdf_description_t), intent(inout) :: description
        integer :: i, k
        do i = 1, size(description%axes)
            do k = 1, size(description%columns)
                associate (column => description%columns(k), axis => description%axes(i))
                    if (netcdf_name(trim(column%name)) /= netcdf_name(trim(axis%name))) cycle
                    axis%name = column%name
                    if (column%kind == column_of_reals) column%axis = i
                end associate
            end do
        end do
    end subroutine find_axes

    !> Reads the next rows; false behind the last, or after an error.
    logical function next_rows(self, cells, error) result(found)
        class(netcdf_table_t), intent(inout) :: self
        real(dp), allocatable, intent(inout) :: cells(:, :) !! the cell of column i in row k is `cells(i, k)`
        type(error_t), allocatable, intent(inout) :: error !! not allocated on success
        integer(int64) :: first, left
        integer :: i, k

        first = self%ending%rows() + 1
        left = product(int(self%extent, int64)) - first + 1
        found = left > 0 .and. .not. allocated(error)
        if (.not. found) return
        if (allocated(cells)) deallocate (cells)
        allocate (cells(size(self%description%columns), min(left, int(rows_at_once, int64))))
        do i = 1, size(cells, 1)
            k = self%description%along(i)
            if (k > 0) then
                call get_coordinate(self, i, k, first, cells(i, :))
            else
                call get_boxes(self, i, first, cells(i, :))
            end if
        end do
        call self%ending%add_cells(cells)
        if (allocated(self%file%error)) error = self%file%error
        found = .not. allocated(error)
    end function next_rows

    !> The cells of a column over the whole grid.
    subroutine get_boxes(self, column, first, values)
        type(netcdf_table_t), intent(inout) :: self
        integer, intent(in) :: column
        integer(int64), intent(in) :: first
        real(dp), intent(inout) :: values(:)
        integer :: start(size(self%extent)), count(size(self%extent)), done

        done = 0
        do while (done < size(values))
            call find_box(self%extent, first + done, int(size(values) - done, int64), start, count)
            call self%file%get(column, values(done + 1:done + product(count)), start, count)
            done = done + product(count)
        end do
    end subroutine get_boxes

    !> The cells of the coordinate of an axis.
    subroutine get_coordinate(self, column, along, first, values)
        type(netcdf_table_t), intent(inout) :: self
        integer, intent(in) :: column, along !! the dimension of the axis
        integer(int64), intent(in) :: first
        real(dp), intent(inout) :: values(:)
        real(dp), allocatable :: coordinate(:)
        integer(int64) :: stride, length, lowest, highest
        integer :: k

        length = self%extent(along)
        stride = product(int(self%extent(:along - 1), int64))
        lowest = mod((first - 1) / stride, length)
        highest = lowest + (first + size(values) - 2) / stride - (first - 1) / stride
        if (highest >= length) then
            ! The rows go on with the first value.
            lowest = 0
            highest = length - 1
        end if
        allocate (coordinate(lowest:highest))
        call self%file%get(column, coordinate, [int(lowest) + 1], [int(highest - lowest) + 1])
        do k = 1, size(values)
            values(k) = coordinate(mod((first + k - 2) / stride, length))
        end do
    end subroutine get_coordinate

    !> How the end that the file names differs from the rows that were read; '' if it does not.
    function problem(self)
        class(netcdf_table_t), intent(in) :: self
        character(:), allocatable :: problem
        problem = ''
        if (self%said == self%ending%summary()) return
        problem = self%file%path // ' was changed after it was written: its attribute end is "' // self%said // &
                  '", that of its rows "' // self%ending%summary() // '"'
        if (self%said == '') problem = self%file%path // ' is not known to be complete: it has no attribute end, as files &
                                       &of earlier versions'
    end function problem

    !> Closes the file.
    subroutine close_table(self)
        class(netcdf_table_t), intent(inout) :: self
        type(error_t), allocatable :: ignored
        call self%file%close(ignored)
    end subroutine close_table

    !> Checks that a file has all its rows, and that they are as they were written; and counts them by their status, or the
    !> motion by the attribute that tells how it ended.
    subroutine check_netcdf_table(path, problem, counts)
        character(*), intent(in) :: path !! path of the file
        character(:), allocatable, intent(out) :: problem !! what is wrong; '' if nothing is
        integer(int64), intent(inout) :: counts(0:last_status) !! increased by the number of rows with each status
        type(netcdf_table_t) :: table
        type(error_t), allocatable :: error
        real(dp), allocatable :: cells(:, :)
        integer :: i, column, status

        call table%open(path, error)
        if (.not. allocated(error)) then
            column = findloc(table%description%columns%name == status_column, .true., dim=1)
            do while (table%next_rows(cells, error))
                if (column == 0) cycle
                counts = counts + [(count(nint(cells(column, :)) == status, kind=int64), status=0, last_status)]
            end do
            problem = table%problem()
            associate (facts => table%description%facts)
                do i = 1, size(facts)
                    if (facts(i)%key /= status_column) cycle
                    status = status_of_ending(facts(i)%value)
                    if (status >= 0) counts(status) = counts(status) + 1
                end do
            end associate
            call table%close()
        end if
        if (allocated(error)) problem = error%message
    end subroutine check_netcdf_table

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
        head = table%description%head()
        call table%close()
    end subroutine head_of_table

end module spintop_netcdf_table
