!> A NetCDF file by the CF conventions. What one contains is told once, by an extension of `netcdf_contents_t`:
!> `write_netcdf` has it written, and then, in the file that was closed, compared with what is read.
!>
!>     call file%add_text(whole_file, 'title', 'A grid')
!>     call file%add_dimension('bin', 10, bins)
!>     call file%add_variable('theta', column, [bins], variable)
!>     call file%put(variable, values, [1], [10])
!>
!> After the first error nothing more is done. The calls of the library are in the submodule `netcdf_library`; a build
!> without it has `netcdf_absent` instead, and no file can be created or opened.
module spintop_netcdf_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, output_error
    use spintop_exit_codes, only: exit_output
    use spintop_files, only: input_file_t, output_file_t
    use spintop_kinds, only: dp
    use spintop_netcdf_grid, only: netcdf_axis_t, netcdf_unit
    use spintop_provenance, only: fact_t
    use spintop_table_column, only: column_of_integers, column_of_notes, column_of_reals, column_of_words, table_column_t
    use spintop_text, only: replace_all
    implicit none
    private
    public :: netcdf_file_t, netcdf_contents_t, has_netcdf, has_compression, is_netcdf, whole_file, write_netcdf

    !> What has the attributes of the whole file, in place of the number of a variable.
    integer, parameter :: whole_file = 0

    !> An open file. All numbers are given, and read, as reals.
    type :: netcdf_file_t
        !> The first error.
        type(error_t), allocatable :: error
        character(:), allocatable :: path
        !> Whether the file is there, and what is put to it is only compared with it.
        logical :: is_there = .false.
        !> Level of the compression, 0 to 9: a file in the format NetCDF-4. Without one (-1) it has the classic format.
        integer :: compression = -1
        integer, private :: id = -1
        logical, private :: in_definitions = .false.
        !> The lengths of the dimensions.
        integer, allocatable, private :: lengths(:)
    contains
        procedure :: open => open_file
        procedure :: add_text
        procedure :: add_numbers
        procedure :: add_dimension
        procedure :: add_variable
        procedure :: define_variable
        procedure :: put
        procedure :: get
        procedure :: read_text
        procedure :: read_facts
        procedure :: read_numbers
        procedure :: read_layout
        procedure :: close => close_file
        procedure, private :: refuse
    end type netcdf_file_t

    !> What a file contains.
    type, abstract :: netcdf_contents_t
    contains
        procedure(put_all), deferred :: put
    end type netcdf_contents_t

    abstract interface
        !> Puts all of it to a file, which is open; called twice, with the same result.
        subroutine put_all(self, file)
            import :: netcdf_contents_t, netcdf_file_t
            class(netcdf_contents_t), intent(inout) :: self
            type(netcdf_file_t), intent(inout) :: file !! the file; its error may come from here
        end subroutine put_all
    end interface

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

    interface
        !> Creates a file, or opens one that is there; then `compression` is what that has.
        module subroutine open_file(self, path, is_there, compression)
            class(netcdf_file_t), intent(inout) :: self
            character(*), intent(in) :: path
            logical, intent(in) :: is_there
            integer, intent(in), optional :: compression !! of a new file
        end subroutine open_file

        !> Adds an attribute, unless it is empty. One that is there is replaced; when the definitions have ended, by one
        !> that is not longer.
        module subroutine add_text(self, variable, name, text)
            class(netcdf_file_t), intent(inout) :: self
            integer, intent(in) :: variable
            character(*), intent(in) :: name, text
        end subroutine add_text

        !> Adds an attribute of numbers of a kind of columns.
        module subroutine add_numbers(self, variable, name, numbers, kind)
            class(netcdf_file_t), intent(inout) :: self
            integer, intent(in) :: variable, kind
            character(*), intent(in) :: name
            real(dp), intent(in) :: numbers(:)
        end subroutine add_numbers

        !> Adds a dimension; `dimension` is its number.
        module subroutine add_dimension(self, name, length, dimension)
            class(netcdf_file_t), intent(inout) :: self
            character(*), intent(in) :: name
            integer, intent(in) :: length
            integer, intent(out) :: dimension
        end subroutine add_dimension

        !> Adds a variable of a kind of columns over dimensions, of which the first varies fastest, without attributes.
        module subroutine define_variable(self, name, kind, dimensions, variable)
            class(netcdf_file_t), intent(inout) :: self
            character(*), intent(in) :: name
            integer, intent(in) :: kind, dimensions(:)
            integer, intent(out) :: variable !! its number
        end subroutine define_variable

        !> Puts the numbers of a box of a variable, after all definitions.
        module subroutine put(self, variable, values, start, extent)
            class(netcdf_file_t), intent(inout) :: self
            integer, intent(in) :: variable, start(:), extent(:) !! where the box begins, and its size
            real(dp), intent(in) :: values(:) !! the first dimension varies fastest
        end subroutine put

        !> Reads the numbers of a box of a variable.
        module subroutine get(self, variable, values, start, extent)
            class(netcdf_file_t), intent(inout) :: self
            integer, intent(in) :: variable, start(:), extent(:) !! as for `put`
            real(dp), intent(out) :: values(:) !! 0 after an error
        end subroutine get

        !> Reads an attribute that is a text; '' if there is none.
        module subroutine read_text(self, variable, name, text)
            class(netcdf_file_t), intent(inout) :: self
            integer, intent(in) :: variable
            character(*), intent(in) :: name
            character(:), allocatable, intent(out) :: text
        end subroutine read_text

        !> Reads the attributes of the whole file that are texts, in their order.
        module subroutine read_facts(self, facts)
            class(netcdf_file_t), intent(inout) :: self
            type(fact_t), allocatable, intent(out) :: facts(:)
        end subroutine read_facts

        !> Reads an attribute of numbers; none if there is no such attribute.
        module subroutine read_numbers(self, variable, name, numbers)
            class(netcdf_file_t), intent(inout) :: self
            integer, intent(in) :: variable
            character(*), intent(in) :: name
            real(dp), allocatable, intent(out) :: numbers(:)
        end subroutine read_numbers

        !> Reads the dimensions, as they were added, and the kind of each variable.
        module subroutine read_layout(self, axes, kinds)
            class(netcdf_file_t), intent(inout) :: self
            type(netcdf_axis_t), allocatable, intent(out) :: axes(:)
            integer, allocatable, intent(out) :: kinds(:)
        end subroutine read_layout

        !> Closes the file, and gives its first error. After an error of writing a file in the format NetCDF-4 is left open,
        !> because HDF5 ends the process where it cannot close it.
        module subroutine close_file(self, error)
            class(netcdf_file_t), intent(inout) :: self
            type(error_t), allocatable, intent(out) :: error !! not allocated if there was none
        end subroutine close_file
    end interface

contains

    !> Writes a file under another name until it is confirmed: the library does not tell of all failures. A short read
    !> gives zeros, and a write that fails when a file is closed is no error.
    subroutine write_netcdf(path, contents, compression, error)
        character(*), intent(in) :: path !! path of the file
        class(netcdf_contents_t), intent(inout) :: contents
        integer, intent(in) :: compression !! its level, or -1
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(netcdf_file_t) :: file
        type(output_file_t) :: output
        logical :: is_there

        call output%create(path // '.new', error)
        is_there = .false.
        do while (.not. allocated(error))
            call file%open(output%path, is_there, compression)
            call contents%put(file)
            call file%close(error)
            if (is_there) exit
            is_there = .true.
        end do
        if (.not. allocated(error)) call output%finish_as(path, -1_int64, error)
        if (allocated(error)) error%code = exit_output
        call output%discard()
    end subroutine write_netcdf

    !> Adds a variable that tells of a column.
    subroutine add_variable(self, name, column, dimensions, variable)
        class(netcdf_file_t), intent(inout) :: self
        character(*), intent(in) :: name
        type(table_column_t), intent(in) :: column
        integer, intent(in) :: dimensions(:) !! the first varies fastest
        integer, intent(out) :: variable !! its number
        character(:), allocatable :: words
        real(dp), allocatable :: values(:)
        integer :: k

        call self%define_variable(name, column%kind, dimensions, variable)
        call self%add_text(variable, 'column', trim(column%name))
        call self%add_text(variable, 'long_name', trim(column%what))
        select case (column%kind)
        case (column_of_reals)
            call self%add_text(variable, 'units', netcdf_unit(column%unit))
        case (column_of_words, column_of_notes)
            ! The meanings of the values, or of the bits of notes.
            words = ''
            do k = 1, size(column%words)
                words = words // ' ' // replace_all(trim(column%words(k)%text), ' ', '_')
            end do
            call self%add_text(variable, 'flag_meanings', words(2:))
            values = [(real(merge(shiftl(1, k), k, column%kind == column_of_notes), dp), k=0, size(column%words) - 1)]
            call self%add_numbers(variable, trim(merge('flag_masks ', 'flag_values', column%kind == column_of_notes)), &
                                  values, column%kind)
        case (column_of_integers)
        end select
    end subroutine add_variable

    !> Makes the error of a file in which is not what was written.
    subroutine refuse(self)
        class(netcdf_file_t), intent(inout) :: self
        if (allocated(self%error)) return
        self%error = output_error('cannot write ' // self%path // ': what is read from it is not what was written')
    end subroutine refuse

    !> Whether a file begins as one in a format of NetCDF; false as well if it cannot be read.
    logical function is_netcdf(path)
        character(*), intent(in) :: path !! path of the file
        type(input_file_t) :: file
        type(error_t), allocatable :: error
        character(4) :: magic
        integer :: length
        length = 0
        call file%open(path, error)
        if (.not. allocated(error)) call file%read(magic, length, error)
        call file%close()
        is_netcdf = .false.
        if (length == len(magic)) is_netcdf = magic(:3) == 'CDF' .or. magic(2:) == 'HDF'
    end function is_netcdf

end module spintop_netcdf_file
