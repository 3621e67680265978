#ifdef SPINTOP_NETCDF
!> NetCDF tables by netcdf-fortran.
submodule(spintop_netcdf_table) netcdf_written
    use, intrinsic :: iso_fortran_env, only: int8
    use netcdf, only: nf90_64bit_offset, nf90_byte, nf90_close, nf90_clobber, nf90_create, nf90_def_dim, nf90_def_var, &
        nf90_double, nf90_enddef, nf90_global, nf90_int, nf90_noerr, nf90_nofill, nf90_put_att, nf90_put_var, &
        nf90_set_fill, nf90_strerror
    use spintop_errors, only: output_error
    use spintop_kinds, only: no_number
    use spintop_netcdf_grid, only: find_box, netcdf_name, netcdf_unit, netcdf_word
    use spintop_table_column, only: column_of_notes, column_of_reals, column_of_words, table_column_t
    use spintop_table_file, only: part_of
    use spintop_text, only: join
    implicit none

    !> Rows that are collected before they are written: enough for long pieces of each variable, and few
    !> enough that the other threads find room for their rows meanwhile; and bytes that the library writes at
    !> once.
    integer, parameter :: most_pending = 16384, bytes_at_once = 65536

contains

    module procedure has_netcdf
        has_netcdf = .true.
    end procedure has_netcdf

    !> Starts a table with the current columns over a grid. Columns along an axis are its coordinate.
    module procedure start
        integer :: dimensions(size(axes)), i, status, chunk, old_mode

        self%remark = ''
        allocate (self%variables(size(self%columns)), self%pending(most_pending, size(self%columns)))
        self%extent = axes(size(axes):1:-1)%length
        call self%file%reserve(path, error)
        if (allocated(error)) return
        chunk = bytes_at_once
        status = nf90_create(part_of(path), ior(nf90_clobber, nf90_64bit_offset), self%id, chunksize=chunk)
        ! Every value is written, so filling the file beforehand would write it twice.
        if (status == nf90_noerr) status = nf90_set_fill(self%id, nf90_nofill, old_mode)
        call add_text(self%id, nf90_global, 'Conventions', 'CF-1.8', status)
        do i = 1, size(facts)
            call add_text(self%id, nf90_global, facts(i)%key, facts(i)%value, status)
        end do
        call add_text(self%id, nf90_global, 'input', join(input, new_line('a')), status)
        do i = 1, size(axes)
            if (status /= nf90_noerr) exit
            ! In the order of Fortran, which is the reverse of that of the file.
            status = nf90_def_dim(self%id, netcdf_name(axes(i)%name), axes(i)%length, dimensions(size(axes) - i + 1))
        end do
        do i = 1, size(self%columns)
            call define_variable(self%id, self%columns(i), dimensions, self%variables(i), status)
            ! The number of the case is an auxiliary coordinate of the grid.
            if (i > 1 .and. self%columns(i)%axis == 0 .and. all(axes%name /= self%columns(1)%name)) then
                call add_text(self%id, self%variables(i), 'coordinates', netcdf_name(self%columns(1)%name), status)
            end if
        end do
        if (status == nf90_noerr) status = nf90_enddef(self%id)
        call check(self, status, error)
        if (allocated(error)) call self%abandon(error)
    end procedure start

    !> Defines a variable over the whole grid, or along an axis of it.
    subroutine define_variable(id, column, dimensions, variable, status)
        integer, intent(in) :: id            !! of the file
        type(table_column_t), intent(in) :: column
        integer, intent(in) :: dimensions(:) !! of the grid; the first varies fastest
        integer, intent(out) :: variable
        integer, intent(inout) :: status
        integer, parameter :: types(4) = [nf90_double, nf90_int, nf90_byte, nf90_int]
        character(*), parameter :: flags(4) = [character(11) :: '', '', 'flag_values', 'flag_masks']

        variable = -1
        if (status /= nf90_noerr) return
        if (column%axis > 0) then
            status = nf90_def_var(id, netcdf_name(column%name), nf90_double, &
                                  [dimensions(size(dimensions) - column%axis + 1)], variable)
        else
            status = nf90_def_var(id, netcdf_name(column%name), types(column%kind), dimensions, variable)
        end if
        call add_text(id, variable, 'column', trim(column%name), status)
        call add_text(id, variable, 'long_name', trim(column%what), status)
        select case (column%kind)
        case (column_of_reals)
            call add_text(id, variable, 'units', netcdf_unit(column%unit), status)
            if (column%axis > 0 .or. status /= nf90_noerr) return
            status = nf90_put_att(id, variable, '_FillValue', no_number)
        case (column_of_words, column_of_notes)
            call add_flags(id, variable, column, trim(flags(column%kind)), status)
        end select
    end subroutine define_variable

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
            words = words // ' ' // netcdf_word(column%words(k)%text)
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

    !> Adds rows.
    module procedure put
        integer :: i

        if (self%held + block%rows > size(self%pending, 1)) call write_pending(self, error)
        if (allocated(error)) return
        do i = 1, size(self%pending, 2)
            self%pending(self%held + 1:self%held + block%rows, i) = block%cells(i, :block%rows)
        end do
        self%held = self%held + block%rows
        self%counts = self%counts + block%counts
    end procedure put

    !> Writes the collected rows, one variable after the other.
    subroutine write_pending(self, error)
        type(netcdf_table_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        integer :: i, status

        status = nf90_noerr
        do i = 1, size(self%columns)
            if (status /= nf90_noerr) exit
            if (self%columns(i)%axis > 0) then
                call write_coordinate(self, i, status)
            else
                call write_boxes(self, i, status)
            end if
        end do
        call check(self, status, error)
        self%written = self%written + self%held
        self%held = 0
    end subroutine write_pending

    !> Writes a column over the whole grid.
    subroutine write_boxes(self, column, status)
        type(netcdf_table_t), intent(in) :: self
        integer, intent(in) :: column
        integer, intent(inout) :: status
        integer :: start(size(self%extent)), count(size(self%extent)), done

        done = 0
        do while (done < self%held .and. status == nf90_noerr)
            call find_box(self%extent, self%written + done + 1, int(self%held - done, int64), start, count)
            status = nf90_put_var(self%id, self%variables(column), self%pending(done + 1:done + product(count), column), &
                                  start, count)
            done = done + product(count)
        end do
    end subroutine write_boxes

    !> Writes the new values of the coordinate of an axis: at rows that are the first with their value.
    subroutine write_coordinate(self, column, status)
        type(netcdf_table_t), intent(in) :: self
        integer, intent(in) :: column
        integer, intent(inout) :: status
        integer(int64) :: stride, first, last, row

        associate (along => size(self%extent) - self%columns(column)%axis + 1)
            stride = product(int(self%extent(:along - 1), int64))
            first = (self%written + stride - 1) / stride
            last = min(int(self%extent(along), int64), (self%written + self%held + stride - 1) / stride) - 1
        end associate
        if (first > last) return
        row = first * stride - self%written + 1
        status = nf90_put_var(self%id, self%variables(column), &
                              self%pending(row:row + (last - first) * stride:stride, column), &
                              [int(first) + 1], [int(last - first) + 1])
    end subroutine write_coordinate

    !> Renames the file to the table, when it is on the disk.
    module procedure finish
        type(string_t) :: no_lines(0)
        integer :: status
        call write_pending(self, error)
        if (allocated(error)) return
        status = nf90_close(self%id)
        self%id = -1
        call check(self, status, error)
        if (.not. allocated(error)) call self%file%finish(no_lines, error)
    end procedure finish

    !> Removes the file: it has no journal with which a later run could resume.
    module procedure abandon
        integer :: ignored
        if (self%id >= 0) ignored = nf90_close(self%id)
        self%id = -1
        call self%file%discard()
        error%message = error%message // new_line('a') // 'nothing is kept of ' // self%file%path
    end procedure abandon

    !> Makes an error from a status of the library.
    subroutine check(self, status, error)
        type(netcdf_table_t), intent(in) :: self
        integer, intent(in) :: status
        type(error_t), allocatable, intent(out) :: error
        if (status == nf90_noerr) return
        error = output_error('cannot write ' // part_of(self%file%path) // ': ' // trim(nf90_strerror(status)))
    end subroutine check

end submodule netcdf_written
#endif
