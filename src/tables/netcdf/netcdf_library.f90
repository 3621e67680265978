#ifdef SPINTOP_NETCDF
!> NetCDF files by netcdf-fortran.
submodule(spintop_netcdf_file) netcdf_library
    use, intrinsic :: iso_fortran_env, only: int8
    use netcdf, only: nf90_64bit_offset, nf90_byte, nf90_char, nf90_clobber, nf90_close, nf90_create, nf90_def_dim, nf90_def_var, &
        nf90_double, nf90_ehdferr, nf90_enddef, nf90_get_att, nf90_get_var, nf90_global, nf90_inq_attname, nf90_inq_dimid, &
        nf90_inq_varid, nf90_inquire, nf90_inquire_attribute, nf90_inquire_dimension, nf90_inquire_variable, nf90_int, &
        nf90_max_name, nf90_noerr, nf90_nofill, nf90_nowrite, nf90_open, nf90_put_att, nf90_put_var, nf90_set_fill, &
        nf90_strerror, nf90_sync
#ifdef SPINTOP_NETCDF4
    use netcdf, only: nf90_def_var_chunking, nf90_def_var_deflate, nf90_format_netcdf4, nf90_format_netcdf4_classic, &
        nf90_inq_var_deflate, nf90_netcdf4
#endif
    use spintop_errors, only: input_error
    use spintop_netcdf_grid, only: size_of_chunk
    use spintop_process, only: expect_crash, leave_libraries
    implicit none

    !> Bytes that the library writes at once.
    integer, parameter :: bytes_at_once = 65536
    !> The types of the kinds of columns.
    integer, parameter :: types(4) = [nf90_double, nf90_int, nf90_byte, nf90_int]

contains

    module procedure open_file
        integer :: status, chunk, old_mode

        if (allocated(self%error)) deallocate (self%error)
        self%path = path
        self%is_there = is_there
        self%lengths = [integer ::]
        self%in_definitions = .not. is_there
        self%compression = -1
        if (present(compression)) self%compression = compression
        if (is_there) then
            status = nf90_open(path, nf90_nowrite, self%id)
            if (status == nf90_noerr) self%compression = compression_of(self%id)
        else if (self%compression >= 0) then
            status = create_netcdf4(path, self%id)
        else
            chunk = bytes_at_once
            status = nf90_create(path, ior(nf90_clobber, nf90_64bit_offset), self%id, chunksize=chunk)
        end if
        if (status /= nf90_noerr) self%id = -1
        ! Every value is written, so filling the file beforehand would write it twice.
        if (status == nf90_noerr .and. .not. is_there) status = nf90_set_fill(self%id, nf90_nofill, old_mode)
        call check(self, status)
    end procedure open_file

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

    module procedure add_text
        character(:), allocatable :: found
        if (allocated(self%error) .or. text == '') return
        if (self%is_there) then
            call self%read_text(variable, name, found)
            if (found /= text .or. len(found) /= len(text)) call self%refuse()
        else
            call check(self, nf90_put_att(self%id, variable, name, text))
        end if
    end procedure add_text

    module procedure add_numbers
        real(dp), allocatable :: found(:)
        if (allocated(self%error)) return
        if (self%is_there) then
            call self%read_numbers(variable, name, found)
            if (.not. are_same(found, numbers)) call self%refuse()
            return
        end if
        select case (kind)
        case (column_of_reals)
            call check(self, nf90_put_att(self%id, variable, name, numbers))
        case (column_of_words)
            call check(self, nf90_put_att(self%id, variable, name, int(numbers, int8)))
        case default
            call check(self, nf90_put_att(self%id, variable, name, int(numbers)))
        end select
    end procedure add_numbers

    module procedure add_dimension
        integer :: status, found
        dimension = -1
        if (allocated(self%error)) return
        found = length
        if (self%is_there) then
            status = nf90_inq_dimid(self%id, name, dimension)
            if (status == nf90_noerr) status = nf90_inquire_dimension(self%id, dimension, len=found)
        else
            status = nf90_def_dim(self%id, name, length, dimension)
        end if
        call check(self, status)
        if (found /= length) call self%refuse()
        self%lengths = [self%lengths, length]
    end procedure add_dimension

    module procedure define_variable
        integer :: status
        variable = -1
        if (allocated(self%error)) return
        if (self%is_there) then
            status = nf90_inq_varid(self%id, name, variable)
        else
            status = nf90_def_var(self%id, name, types(kind), dimensions, variable)
            if (self%compression > 0 .and. status == nf90_noerr) status = compress()
        end if
        call check(self, status)

    contains

        !> Has the variable compressed, in chunks of consecutive elements.
        integer function compress() result(status)
            status = nf90_noerr
#ifdef SPINTOP_NETCDF4
            if (any(self%lengths(dimensions) == 0)) return
            status = nf90_def_var_chunking(self%id, variable, 0, size_of_chunk(self%lengths(dimensions)))
            if (status == nf90_noerr) status = nf90_def_var_deflate(self%id, variable, 1, 1, self%compression)
#endif
        end function compress

    end procedure define_variable

    module procedure put
        real(dp), allocatable :: found(:)
        if (allocated(self%error) .or. size(values) == 0) return
        if (self%is_there) then
            allocate (found(size(values)))
            call self%get(variable, found, start, extent)
            if (.not. are_same(found, values)) call self%refuse()
            return
        end if
        call end_definitions(self)
        if (.not. allocated(self%error)) call check(self, nf90_put_var(self%id, variable, values, start, extent))
    end procedure put

    !> Called after the last definition, before the first number.
    subroutine end_definitions(self)
        class(netcdf_file_t), intent(inout) :: self
        if (self%in_definitions .and. .not. allocated(self%error)) call check(self, nf90_enddef(self%id))
        self%in_definitions = .false.
    end subroutine end_definitions

    module procedure get
        values = 0
        if (allocated(self%error) .or. size(values) == 0) return
        call check(self, nf90_get_var(self%id, variable, values, start, extent))
    end procedure get

    !> Whether numbers are the same, bit for bit.
    pure logical function are_same(a, b)
        real(dp), intent(in) :: a(:), b(:)
        integer :: i
        are_same = size(a) == size(b)
        do i = 1, min(size(a), size(b))
            are_same = are_same .and. transfer(a(i), 0_int64) == transfer(b(i), 0_int64)
        end do
    end function are_same

    module procedure read_text
        integer :: length, kind
        text = ''
        if (allocated(self%error)) return
        if (nf90_inquire_attribute(self%id, variable, name, xtype=kind, len=length) /= nf90_noerr) return
        if (kind /= nf90_char) return
        deallocate (text)
        allocate (character(length) :: text)
        call check(self, nf90_get_att(self%id, variable, name, text))
    end procedure read_text

    module procedure read_numbers
        integer :: length, kind
        length = 0
        if (.not. allocated(self%error)) then
            if (nf90_inquire_attribute(self%id, variable, name, xtype=kind, len=length) /= nf90_noerr) length = 0
        end if
        allocate (numbers(length))
        if (length > 0) call check(self, nf90_get_att(self%id, variable, name, numbers))
    end procedure read_numbers

    module procedure read_facts
        character(nf90_max_name) :: name
        type(fact_t), allocatable :: found(:)
        integer :: i, all, n, kind
        all = 0
        n = 0
        if (.not. allocated(self%error)) call check(self, nf90_inquire(self%id, nAttributes=all))
        allocate (found(all))
        do i = 1, all
            if (.not. allocated(self%error)) call check(self, nf90_inq_attname(self%id, nf90_global, i, name))
            if (.not. allocated(self%error)) call check(self, nf90_inquire_attribute(self%id, nf90_global, name, xtype=kind))
            if (allocated(self%error)) exit
            if (kind /= nf90_char) cycle
            n = n + 1
            found(n)%key = trim(name)
            call self%read_text(nf90_global, found(n)%key, found(n)%value)
        end do
        facts = found(:n)
    end procedure read_facts

    module procedure read_layout
        integer :: n, variables, i, kind
        n = 0
        variables = 0
        if (.not. allocated(self%error)) call check(self, nf90_inquire(self%id, nDimensions=n, nVariables=variables))
        allocate (axes(n), kinds(variables))
        do i = 1, n
            if (allocated(self%error)) return
            call check(self, nf90_inquire_dimension(self%id, i, axes(i)%name, axes(i)%length))
        end do
        do i = 1, variables
            if (allocated(self%error)) return
            call check(self, nf90_inquire_variable(self%id, i, xtype=kind))
            kinds(i) = findloc(types, kind, dim=1)
        end do
    end procedure read_layout

    module procedure close_file
        integer :: status
        if (self%id >= 0) then
            ! The library does not tell whether the last writes fail when the file is closed.
            call end_definitions(self)
            if (.not. (self%is_there .or. allocated(self%error))) call check(self, nf90_sync(self%id))
            if (allocated(self%error) .and. self%compression >= 0 .and. .not. self%is_there) then
                call leave_libraries()
            else
                ! netCDF crashes where HDF5 cannot close a file.
                if (self%compression >= 0) call expect_crash(message_on(self, nf90_ehdferr) // new_line('a'))
                status = nf90_close(self%id)
                if (self%compression >= 0) call expect_crash('')
                if (.not. self%is_there) call check(self, status)
            end if
        end if
        self%id = -1
        call move_alloc(self%error, error)
    end procedure close_file

    !> Makes an error from a status of the library.
    subroutine check(self, status)
        class(netcdf_file_t), intent(inout) :: self
        integer, intent(in) :: status
        if (status == nf90_noerr .or. allocated(self%error)) return
        if (self%is_there) then
            self%error = input_error(message_on(self, status))
        else
            self%error = output_error(message_on(self, status))
        end if
    end subroutine check

    !> Says what cannot be done, and why.
    function message_on(self, status) result(message)
        class(netcdf_file_t), intent(in) :: self
        integer, intent(in) :: status
        character(:), allocatable :: message
        message = trim(merge('cannot read ', 'cannot write', self%is_there)) // ' ' // self%path // ': ' // &
                  trim(nf90_strerror(status))
    end function message_on

end submodule netcdf_library
#endif
