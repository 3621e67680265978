#ifdef SPINTOP_NETCDF
!> Reading NetCDF files by netcdf-fortran.
submodule(spintop_netcdf_file) netcdf_file_read
    use netcdf, only: nf90_byte, nf90_char, nf90_double, nf90_get_att, nf90_get_var, nf90_global, nf90_inq_attname, nf90_inquire, &
        nf90_inquire_attribute, nf90_inquire_dimension, nf90_inquire_variable, nf90_max_name, nf90_noerr, nf90_nofill, &
        nf90_nowrite, nf90_open, nf90_set_fill, nf90_strerror, nf90_write
#ifdef SPINTOP_NETCDF4
    use netcdf, only: nf90_format_netcdf4, nf90_format_netcdf4_classic, nf90_inq_var_deflate
#endif
    use spintop_errors, only: input_error
    use spintop_netcdf_grid, only: find_box, netcdf_axis_t, netcdf_name, own_unit
    use spintop_provenance, only: fact_t
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_reals, column_of_words, table_column_t
    use spintop_text, only: split, string_t
    implicit none

contains

    module procedure open_file
        integer :: status, old_mode, variables, i

        self%path = path
        self%held = 0
        self%rows = 0
        self%is_written = to_continue
        self%failure = nf90_noerr
        status = nf90_open(path, merge(nf90_write, nf90_nowrite, to_continue), self%id)
        if (status /= nf90_noerr) self%id = -1
        if (status == nf90_noerr .and. to_continue) status = nf90_set_fill(self%id, nf90_nofill, old_mode)
        call read_attributes(self%id, self%description, status)
        if (status == nf90_noerr) status = nf90_inquire(self%id, nVariables=variables)
        if (status == nf90_noerr) then
            allocate (self%description%columns(variables))
            self%variables = [(i, i=1, variables)]
            do i = 1, variables
                call read_column(self%id, i, self%description%columns(i), status)
            end do
            call read_extent(self, status)
        end if
        if (status == nf90_noerr) self%description%compression = compression_of(self)
        if (status /= nf90_noerr) then
            error = input_error('cannot read ' // path // ': ' // trim(nf90_strerror(status)))
        else if (.not. is_table(self)) then
            error = input_error('cannot read ' // path // ': it is no table of spintop')
        end if
    end procedure open_file

    !> The level of the compression of all variables; -1 in the classic format.
    integer function compression_of(self) result(level)
        type(netcdf_file_t), intent(in) :: self
        level = -1
#ifdef SPINTOP_NETCDF4
        block
            integer :: format, shuffled, deflated, level_of_first
            if (nf90_inquire(self%id, formatNum=format) /= nf90_noerr) return
            if (all(format /= [nf90_format_netcdf4, nf90_format_netcdf4_classic])) return
            level = 0
            if (nf90_inq_var_deflate(self%id, self%variables(1), shuffled, deflated, level_of_first) /= nf90_noerr) return
            if (deflated /= 0) level = level_of_first
        end block
#else
#endif
    end function compression_of

    !> Whether all is there that a table of this program has.
    pure logical function is_table(self)
        type(netcdf_file_t), intent(in) :: self
        associate (description => self%description)
            is_table = size(description%facts) > 0 .and. size(description%columns) > 0 .and. size(self%extent) > 0
            if (is_table) is_table = all(description%columns%name /= '')
        end associate
    end function is_table

    !> The attributes of the whole file.
    subroutine read_attributes(id, description, status)
        integer, intent(in) :: id
        type(netcdf_description_t), intent(out) :: description
        integer, intent(inout) :: status
        character(nf90_max_name) :: name
        character(:), allocatable :: text
        type(fact_t), allocatable :: facts(:)
        integer :: i, attributes, n

        allocate (description%facts(0), description%input(0), description%axes(0))
        description%part = ''
        description%ending = ''
        attributes = 0
        n = 0
        if (status == nf90_noerr) status = nf90_inquire(id, nAttributes=attributes)
        allocate (facts(attributes))
        do i = 1, attributes
            if (status == nf90_noerr) status = nf90_inq_attname(id, nf90_global, i, name)
            if (status /= nf90_noerr) return
            call read_text(id, nf90_global, trim(name), text, status)
            select case (name)
            case ('Conventions', 'grid_lengths')
            case ('input')
                call split(text, new_line('a'), description%input, keeps_blanks=.true.)
            case (end_key)
                description%ending = text
            case ('part')
                description%part = text
            case ('grid')
                call read_grid(id, text, description%axes, status)
            case default
                n = n + 1
                facts(n)%key = trim(name)
                facts(n)%value = text
            end select
        end do
        description%facts = facts(:n)
    end subroutine read_attributes

    !> The axes of the whole, in the file of a part.
    subroutine read_grid(id, names, axes, status)
        integer, intent(in) :: id
        character(*), intent(in) :: names
        type(netcdf_axis_t), allocatable, intent(out) :: axes(:)
        integer, intent(inout) :: status
        type(string_t), allocatable :: words(:)
        integer, allocatable :: lengths(:)
        integer :: i, n

        allocate (words(0)) ! or gfortran warns of bounds without values
        call split(names, ' ', words)
        n = 0
        if (status == nf90_noerr) status = nf90_inquire_attribute(id, nf90_global, 'grid_lengths', len=n)
        allocate (lengths(n))
        if (status == nf90_noerr) status = nf90_get_att(id, nf90_global, 'grid_lengths', lengths)
        allocate (axes(min(n, size(words))))
        do i = 1, size(axes)
            axes(i) = netcdf_axis_t(words(i)%text, lengths(i))
        end do
    end subroutine read_grid

    !> What a column is, except for its axis.
    subroutine read_column(id, variable, column, status)
        integer, intent(in) :: id, variable
        type(table_column_t), intent(out) :: column
        integer, intent(inout) :: status
        character(:), allocatable :: text
        integer :: kind

        kind = nf90_double
        if (status == nf90_noerr) status = nf90_inquire_variable(id, variable, xtype=kind)
        call read_text(id, variable, 'column', text, status)
        column%name = text
        call read_text(id, variable, 'long_name', text, status)
        column%what = text
        call read_text(id, variable, 'units', text, status)
        column%unit = own_unit(text)
        call read_text(id, variable, 'flag_meanings', text, status)
        column%kind = column_of_integers
        if (kind == nf90_double) column%kind = column_of_reals
        if (kind == nf90_byte) column%kind = column_of_words
        if (text == '') return
        if (column%kind == column_of_integers) column%kind = column_of_notes
        call split(text, ' ', column%words)
    end subroutine read_column

    !> The extent of the grid, and the axes: each dimension has a coordinate, or is that of the cases.
    subroutine read_extent(self, status)
        type(netcdf_file_t), intent(inout) :: self
        integer, intent(inout) :: status
        character(nf90_max_name) :: name
        integer :: i, k, n, length

        n = 0
        if (status == nf90_noerr) status = nf90_inquire(self%id, nDimensions=n)
        if (allocated(self%extent)) deallocate (self%extent)
        allocate (self%extent(n), source=0)
        associate (description => self%description)
            do i = 1, n
                if (status == nf90_noerr) status = nf90_inquire_dimension(self%id, i, name, length)
                if (status /= nf90_noerr) return
                self%extent(n - i + 1) = length
                if (description%is_part()) cycle
                do k = 1, size(description%columns)
                    if (netcdf_name(trim(description%columns(k)%name)) == name) name = description%columns(k)%name
                end do
                description%axes = [description%axes, netcdf_axis_t(name(:len(description%axes%name)), length)]
            end do
            do k = 1, size(description%columns)
                if (description%columns(k)%kind /= column_of_reals) cycle
                do i = 1, size(description%axes)
                    if (description%axes(i)%name == description%columns(k)%name) description%columns(k)%axis = i
                end do
            end do
        end associate
        self%room = product(int(self%extent, int64))
    end subroutine read_extent

    module procedure get
        integer :: i, status

        status = nf90_noerr
        do i = 1, size(self%variables)
            if (status /= nf90_noerr) exit
            if (self%description%columns(i)%axis > 0 .and. .not. self%description%is_part()) then
                call get_coordinate(self, i, first, cells(i, :), status)
            else
                call get_boxes(self, i, first, cells(i, :), status)
            end if
        end do
        if (status /= nf90_noerr) error = input_error('cannot read ' // self%path // ': ' // trim(nf90_strerror(status)))
    end procedure get

    !> The cells of a column over the whole grid.
    subroutine get_boxes(self, column, first, values, status)
        type(netcdf_file_t), intent(in) :: self
        integer, intent(in) :: column
        integer(int64), intent(in) :: first
        real(dp), intent(inout) :: values(:)
        integer, intent(inout) :: status
        real(dp) :: box(size(values))
        integer :: start(size(self%extent)), count(size(self%extent)), done

        done = 0
        do while (done < size(values) .and. status == nf90_noerr)
            call find_box(self%extent, first + done, int(size(values) - done, int64), start, count)
            status = nf90_get_var(self%id, self%variables(column), box(:product(count)), start, count)
            values(done + 1:done + product(count)) = box(:product(count))
            done = done + product(count)
        end do
    end subroutine get_boxes

    !> The cells of the coordinate of an axis.
    subroutine get_coordinate(self, column, first, values, status)
        type(netcdf_file_t), intent(in) :: self
        integer, intent(in) :: column
        integer(int64), intent(in) :: first
        real(dp), intent(inout) :: values(:)
        integer, intent(inout) :: status
        real(dp), allocatable :: coordinate(:)
        integer(int64) :: stride, length, lowest, highest
        integer :: along, k

        along = size(self%extent) - self%description%columns(column)%axis + 1
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
        status = nf90_get_var(self%id, self%variables(column), coordinate, [int(lowest) + 1], [int(highest - lowest) + 1])
        do k = 1, size(values)
            values(k) = coordinate(mod((first + k - 2) / stride, length))
        end do
    end subroutine get_coordinate

    !> An attribute that is a text; '' if there is none.
    subroutine read_text(id, variable, name, text, status)
        integer, intent(in) :: id, variable
        character(*), intent(in) :: name
        character(:), allocatable, intent(out) :: text
        integer, intent(inout) :: status
        integer :: length, kind

        length = 0
        kind = nf90_double
        text = ''
        if (status /= nf90_noerr) return
        if (nf90_inquire_attribute(id, variable, name, xtype=kind, len=length) /= nf90_noerr) return
        if (kind /= nf90_char) return
        deallocate (text)
        allocate (character(length) :: text)
        status = nf90_get_att(id, variable, name, text)
    end subroutine read_text

end submodule netcdf_file_read
#endif
