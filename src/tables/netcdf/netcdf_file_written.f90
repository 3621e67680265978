#ifdef SPINTOP_NETCDF
!> Writing NetCDF files by netcdf-fortran.
submodule(spintop_netcdf_file) netcdf_file_written
    use, intrinsic :: iso_fortran_env, only: int8
    use netcdf, only: nf90_64bit_offset, nf90_byte, nf90_close, nf90_clobber, nf90_create, nf90_def_dim, nf90_def_var, &
        nf90_double, nf90_ehdferr, nf90_enddef, nf90_global, nf90_int, nf90_noerr, nf90_nofill, nf90_put_att, nf90_put_var, &
        nf90_set_fill, nf90_strerror, nf90_sync
#ifdef SPINTOP_NETCDF4
    use netcdf, only: nf90_def_var_chunking, nf90_def_var_deflate, nf90_netcdf4
#endif
    use spintop_errors, only: output_error
    use spintop_kinds, only: no_number
    use spintop_netcdf_grid, only: find_box, netcdf_name, netcdf_unit, size_of_chunk
    use spintop_process, only: expect_crash, leave_libraries
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_words, table_column_t
    use spintop_table_end, only: place_of_summary
    use spintop_text, only: join, replace_all, to_text
    implicit none

    !> Rows that are collected before they are written: enough for long pieces of each variable, and few
    !> enough that the other threads find room for their rows meanwhile; and bytes that the library writes at
    !> once.
    integer, parameter :: most_pending = 16384, bytes_at_once = 65536

contains

    module procedure has_netcdf
        has_netcdf = .true.
    end procedure has_netcdf

    module procedure has_compression
#ifdef SPINTOP_NETCDF4
        has_compression = .true.
#else
        has_compression = .false.
#endif
    end procedure has_compression

    module procedure create
        integer, allocatable :: dimensions(:)
        integer :: status, chunk, old_mode

        self%path = path
        self%description = description
        self%held = 0
        self%rows = 0
        self%is_written = .true.
        self%failure = nf90_noerr
        if (description%is_part()) then
            self%extent = [description%rows_of_part()]
        else
            self%extent = description%axes(size(description%axes):1:-1)%length
        end if
        self%room = product(int(self%extent, int64))
        if (description%compression < 0) then
            chunk = bytes_at_once
            status = nf90_create(path, ior(nf90_clobber, nf90_64bit_offset), self%id, chunksize=chunk)
        else
            status = create_netcdf4(path, self%id)
        end if
        ! Every value is written, so filling the file beforehand would write it twice.
        if (status == nf90_noerr) status = nf90_set_fill(self%id, nf90_nofill, old_mode)
        call add_attributes(self%id, description, status)
        ! Later no attribute may become longer.
        call add_text(self%id, nf90_global, end_key, place_of_summary(self%room), status)
        call define_dimensions(self, dimensions, status)
        call define_variables(self, dimensions, status)
        if (status == nf90_noerr) status = nf90_enddef(self%id)
        call check(self, status, error)
    end procedure create

    !> Creates an empty file in the format NetCDF-4, where the library has it.
    integer function create_netcdf4(path, id) result(status)
        character(*), intent(in) :: path
        integer, intent(out) :: id
#ifdef SPINTOP_NETCDF4
        status = nf90_create(path, ior(nf90_clobber, nf90_netcdf4), id)
        ! The library does not know why, and names a reason of the system.
        if (status > 0) status = nf90_ehdferr
#else
        status = nf90_create(path, ior(nf90_clobber, nf90_64bit_offset), id)
#endif
    end function create_netcdf4

    !> Adds the attributes of the whole file.
    subroutine add_attributes(id, description, status)
        integer, intent(in) :: id
        type(netcdf_description_t), intent(in) :: description
        integer, intent(inout) :: status
        character(:), allocatable :: names
        integer :: i

        call add_text(id, nf90_global, 'Conventions', 'CF-1.8', status)
        do i = 1, size(description%facts)
            call add_text(id, nf90_global, description%facts(i)%key, description%facts(i)%value, status)
        end do
        call add_text(id, nf90_global, 'input', join(description%input, new_line('a')), status)
        if (.not. description%is_part()) return
        call add_text(id, nf90_global, 'part', description%part, status)
        names = ''
        do i = 1, size(description%axes)
            names = names // ' ' // trim(description%axes(i)%name)
        end do
        call add_text(id, nf90_global, 'grid', names(2:), status)
        if (status == nf90_noerr) status = nf90_put_att(id, nf90_global, 'grid_lengths', description%axes%length)
    end subroutine add_attributes

    !> Defines the dimensions, in the order of Fortran, which is the reverse of that of the file.
    subroutine define_dimensions(self, dimensions, status)
        type(netcdf_file_t), intent(in) :: self
        integer, allocatable, intent(out) :: dimensions(:)
        integer, intent(inout) :: status
        integer :: i

        allocate (dimensions(size(self%extent)), source=-1)
        associate (axes => self%description%axes, n => size(dimensions))
            do i = 1, n
                if (status /= nf90_noerr) exit
                if (self%description%is_part()) then
                    status = nf90_def_dim(self%id, netcdf_name(self%description%columns(1)%name), self%extent(1), dimensions(1))
                else
                    status = nf90_def_dim(self%id, netcdf_name(axes(i)%name), axes(i)%length, dimensions(n - i + 1))
                end if
            end do
        end associate
    end subroutine define_dimensions

    !> Defines the variables. The number of the case is an auxiliary coordinate of a grid.
    subroutine define_variables(self, dimensions, status)
        type(netcdf_file_t), intent(inout) :: self
        integer, intent(in) :: dimensions(:)
        integer, intent(inout) :: status
        logical :: has_auxiliary
        integer :: i, along

        associate (columns => self%description%columns, axes => self%description%axes)
            if (allocated(self%variables)) deallocate (self%variables)
            allocate (self%variables(size(columns)))
            has_auxiliary = columns(1)%kind == column_of_integers .and. all(axes%name /= columns(1)%name) &
                            .and. .not. self%description%is_part()
            do i = 1, size(columns)
                along = along_axis(self, i)
                if (along > 0) then
                    call define_variable(self, columns(i), [dimensions(along)], [self%extent(along)], self%variables(i), status)
                else
                    call define_variable(self, columns(i), dimensions, self%extent, self%variables(i), status)
                end if
                if (i > 1 .and. has_auxiliary .and. along == 0) then
                    call add_text(self%id, self%variables(i), 'coordinates', netcdf_name(columns(1)%name), status)
                end if
            end do
        end associate
    end subroutine define_variables

    !> Defines a variable over the whole grid, or along an axis of it.
    subroutine define_variable(self, column, dimensions, extent, variable, status)
        type(netcdf_file_t), intent(in) :: self
        type(table_column_t), intent(in) :: column
        integer, intent(in) :: dimensions(:), extent(:) !! of the variable; the first varies fastest
        integer, intent(out) :: variable
        integer, intent(inout) :: status
        integer, parameter :: types(4) = [nf90_double, nf90_int, nf90_byte, nf90_int]

        variable = -1
        if (status /= nf90_noerr) return
        status = nf90_def_var(self%id, netcdf_name(column%name), types(column%kind), dimensions, variable)
        if (self%description%compression > 0) call compress(self, extent, variable, status)
        call add_text(self%id, variable, 'column', trim(column%name), status)
        call add_text(self%id, variable, 'long_name', trim(column%what), status)
        select case (column%kind)
        case (column_of_words)
            call add_flags(self%id, variable, column, 'flag_values', status)
        case (column_of_notes)
            call add_flags(self%id, variable, column, 'flag_masks', status)
        case (column_of_integers)
        case default
            call add_text(self%id, variable, 'units', netcdf_unit(column%unit), status)
            if (column%axis > 0 .or. status /= nf90_noerr) return
            status = nf90_put_att(self%id, variable, '_FillValue', no_number)
        end select
    end subroutine define_variable

    !> Has a variable compressed, in chunks of consecutive rows.
    subroutine compress(self, extent, variable, status)
        type(netcdf_file_t), intent(in) :: self
        integer, intent(in) :: extent(:), variable
        integer, intent(inout) :: status
#ifdef SPINTOP_NETCDF4
        integer, parameter :: chunked = 0, with_shuffle = 1, with_deflate = 1
        if (status /= nf90_noerr .or. any(extent == 0)) return
        status = nf90_def_var_chunking(self%id, variable, chunked, size_of_chunk(extent))
        if (status /= nf90_noerr) return
        status = nf90_def_var_deflate(self%id, variable, with_shuffle, with_deflate, self%description%compression)
#else
#endif
    end subroutine compress

    !> Adds the meanings of the values of a categorical column, or of the bits of notes.
    subroutine add_flags(id, variable, column, name, status)
        integer, intent(in) :: id, variable
        type(table_column_t), intent(in) :: column
        character(*), intent(in) :: name
        integer, intent(inout) :: status
        character(:), allocatable :: words
        integer, allocatable :: values(:)
        integer :: k

        words = ''
        do k = 1, size(column%words)
            words = words // ' ' // replace_all(trim(column%words(k)%text), ' ', '_')
        end do
        call add_text(id, variable, 'flag_meanings', words(2:), status)
        values = [(k, k=0, size(column%words) - 1)]
        if (column%kind == column_of_notes) values = shiftl(1, values)
        if (status /= nf90_noerr) return
        if (column%kind == column_of_notes) then
            status = nf90_put_att(id, variable, name, values)
        else
            status = nf90_put_att(id, variable, name, int(values, int8))
        end if
    end subroutine add_flags

    !> Adds an attribute to a variable, unless it is empty.
    subroutine add_text(id, variable, name, text, status)
        integer, intent(in) :: id, variable
        character(*), intent(in) :: name, text
        integer, intent(inout) :: status
        if (status == nf90_noerr .and. text /= '') status = nf90_put_att(id, variable, name, text)
    end subroutine add_text

    module procedure append
        integer :: first, last, i

        if (self%rows + size(cells, 2) > self%room) then
            error = output_error('cannot write ' // self%path // ': it has room for ' // to_text(self%room) // ' rows')
            return
        end if
        if (.not. allocated(self%pending)) allocate (self%pending(most_pending, size(cells, 1)))
        first = 1
        do while (first <= size(cells, 2))
            if (self%held == most_pending) call write_pending(self, error)
            if (allocated(error)) return
            last = min(size(cells, 2), first + most_pending - self%held - 1)
            do i = 1, size(cells, 1)
                self%pending(self%held + 1:self%held + last - first + 1, i) = cells(i, first:last)
            end do
            self%held = self%held + last - first + 1
            self%rows = self%rows + last - first + 1
            first = last + 1
        end do
    end procedure append

    !> Writes the collected rows, one variable after the other.
    subroutine write_pending(self, error)
        type(netcdf_file_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        integer :: i, status

        status = nf90_noerr
        do i = 1, size(self%variables)
            if (status /= nf90_noerr .or. self%held == 0) exit
            if (along_axis(self, i) > 0) then
                call write_coordinate(self, i, status)
            else
                call write_boxes(self, i, status)
            end if
        end do
        call check(self, status, error)
        self%held = 0
    end subroutine write_pending

    !> The dimension along which a column varies, counted from the fastest; 0 if it varies from row to row.
    pure integer function along_axis(self, column)
        type(netcdf_file_t), intent(in) :: self
        integer, intent(in) :: column
        along_axis = 0
        if (self%description%is_part()) return
        associate (axis => self%description%columns(column)%axis)
            if (axis > 0) along_axis = size(self%extent) - axis + 1
        end associate
    end function along_axis

    !> Writes a column over the whole grid.
    subroutine write_boxes(self, column, status)
        type(netcdf_file_t), intent(in) :: self
        integer, intent(in) :: column
        integer, intent(inout) :: status
        integer :: start(size(self%extent)), count(size(self%extent)), done

        done = 0
        do while (done < self%held .and. status == nf90_noerr)
            call find_box(self%extent, self%rows - self%held + done + 1, int(self%held - done, int64), start, count)
            status = nf90_put_var(self%id, self%variables(column), self%pending(done + 1:done + product(count), column), &
                                  start, count)
            done = done + product(count)
        end do
    end subroutine write_boxes

    !> Writes the new values of the coordinate of an axis: at rows that are the first with their value.
    subroutine write_coordinate(self, column, status)
        type(netcdf_file_t), intent(in) :: self
        integer, intent(in) :: column
        integer, intent(inout) :: status
        integer(int64) :: stride, first, last, row, before

        before = self%rows - self%held
        associate (along => along_axis(self, column))
            stride = product(int(self%extent(:along - 1), int64))
            first = (before + stride - 1) / stride
            last = min(int(self%extent(along), int64), (before + self%held + stride - 1) / stride) - 1
        end associate
        if (first > last) return
        row = first * stride - before + 1
        status = nf90_put_var(self%id, self%variables(column), &
                              self%pending(row:row + (last - first) * stride:stride, column), &
                              [int(first) + 1], [int(last - first) + 1])
    end subroutine write_coordinate

    module procedure seal
        call check(self, nf90_put_att(self%id, nf90_global, end_key, summary), error)
    end procedure seal

    module procedure flush_file
        call write_pending(self, error)
        if (.not. allocated(error)) call check(self, nf90_sync(self%id), error)
    end procedure flush_file

    module procedure close_file
        type(error_t), allocatable :: problem
        integer :: ignored
        if (self%id < 0) return
        if (.not. self%is_written) then
            ignored = guarded_close(self%path, self%id, self%description%compression >= 0)
            self%id = -1
            return
        end if
        if (self%failure == nf90_noerr) call write_pending(self, error)
        call close_netcdf(self%path, self%id, self%failure, self%description%compression >= 0, problem)
        if (.not. allocated(error)) call move_alloc(problem, error)
    end procedure close_file

    module procedure close_netcdf
        integer :: status, status_of_close
        status = failure
        ! The library does not tell whether the last writes fail when the file is closed.
        if (status == nf90_noerr) status = nf90_sync(id)
        if (status /= nf90_noerr .and. uses_hdf) then
            call leave_libraries()
        else
            status_of_close = guarded_close(path, id, uses_hdf)
            if (status == nf90_noerr) status = status_of_close
        end if
        id = -1
        if (status /= nf90_noerr) error = output_error(message_on(path, status))
    end procedure close_netcdf

    !> Closes a file. netCDF crashes where HDF5 cannot close one.
    integer function guarded_close(path, id, uses_hdf) result(status)
        character(*), intent(in) :: path
        integer, intent(in) :: id
        logical, intent(in) :: uses_hdf
        if (uses_hdf) call expect_crash(message_on(path, nf90_ehdferr) // new_line('a'))
        status = nf90_close(id)
        if (uses_hdf) call expect_crash('')
    end function guarded_close

    !> Makes an error from a status of the library.
    subroutine check(self, status, error)
        type(netcdf_file_t), intent(inout) :: self
        integer, intent(in) :: status
        type(error_t), allocatable, intent(out) :: error
        if (status == nf90_noerr) return
        self%failure = status
        error = output_error(message_on(self%path, status))
    end subroutine check

    !> Says that a file cannot be written.
    function message_on(path, status) result(message)
        character(*), intent(in) :: path
        integer, intent(in) :: status
        character(:), allocatable :: message
        message = 'cannot write ' // path // ': ' // trim(nf90_strerror(status))
    end function message_on

end submodule netcdf_file_written
#endif
