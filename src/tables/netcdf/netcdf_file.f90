!> A table as a NetCDF file, by the CF conventions: every column is a variable over the grid of the cases. The layout is
!> fixed when the file is created, and it contains no time stamp of the library. The file is written from its first
!> row to the last, or continued behind any row, and can be read at the same time.
!>
!> A file that is being written has the classic format with 64-bit offsets: after `flush` its first rows are valid
!> whatever happens later. A complete one may be copied to the format NetCDF-4, with compression.
!>
!> The calls of the library are in the submodule `netcdf_file_written`; a build without it has `netcdf_file_absent`
!> instead, and no file can be created or opened.
module spintop_netcdf_file
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, output_error
    use spintop_files, only: input_file_t
    use spintop_kinds, only: dp
    use spintop_netcdf_description, only: netcdf_description_t
    use spintop_table_head, only: read_head
    implicit none
    private
    public :: netcdf_file_t, has_netcdf, has_compression, is_netcdf, close_netcdf, confirm_netcdf
    public :: head_of_table, head_of_netcdf

    !> Name of the attribute that says how many rows there are, and their checksum.
    character(*), parameter :: end_key = 'end'

    !> An open file.
    type :: netcdf_file_t
        type(netcdf_description_t) :: description
        !> Number of rows that the file has room for, and of those put so far.
        integer(int64) :: room = 0, rows = 0
        character(:), allocatable, private :: path
        integer, private :: id = -1
        integer, allocatable, private :: variables(:)
        integer, allocatable, private :: extent(:) !! of the grid; the first varies fastest
        !> Rows that are not yet written, one column each.
        real(dp), allocatable, private :: pending(:, :)
        integer, private :: held = 0
        !> Whether the file is written; and what the library said when that failed.
        logical, private :: is_written = .false.
        integer, private :: failure = 0
    contains
        procedure :: create
        procedure :: open => open_file
        procedure :: append
        procedure :: get
        procedure :: flush => flush_file
        procedure :: seal
        procedure :: close => close_file
    end type netcdf_file_t

    interface
        !> Whether this build contains the library.
        pure logical module function has_netcdf()
        end function has_netcdf

        !> Whether the library of this build has the format NetCDF-4.
        pure logical module function has_compression()
        end function has_compression

        !> Creates a file with room for the rows of a description.
        module subroutine create(self, path, description, error)
            class(netcdf_file_t), intent(inout) :: self
            character(*), intent(in) :: path !! path of the file
            type(netcdf_description_t), intent(in) :: description !! all but the rows
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine create

        !> Opens a file and reads its description. To continue it set `rows`.
        module subroutine open_file(self, path, to_continue, error)
            class(netcdf_file_t), intent(inout) :: self
            character(*), intent(in) :: path !! path of the file
            logical, intent(in) :: to_continue !! whether rows are to be appended
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine open_file

        !> Appends rows.
        module subroutine append(self, cells, error)
            class(netcdf_file_t), intent(inout) :: self
            real(dp), intent(in) :: cells(:, :) !! the cell of column i in row k is `cells(i, k)`
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine append

        !> Closes a file that was written. After a failure a file in the format NetCDF-4 is left open, because HDF5 ends the
        !> process where it cannot close it.
        module subroutine close_netcdf(path, id, failure, uses_hdf, error)
            character(*), intent(in) :: path !! path of the file
            integer, intent(inout) :: id !! its number in the library
            integer, intent(in) :: failure !! what the library said to the last call; 0 for success
            logical, intent(in) :: uses_hdf !! whether its format is NetCDF-4
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine close_netcdf

        !> Reads rows, which are written already.
        module subroutine get(self, first, cells, error)
            class(netcdf_file_t), intent(in) :: self
            integer(int64), intent(in) :: first !! number of the first row
            real(dp), intent(out) :: cells(:, :) !! the rows, one column each
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine get

        !> Has the file say how many rows there are, and their checksum, when it has all of them.
        module subroutine seal(self, summary, error)
            class(netcdf_file_t), intent(inout) :: self
            character(*), intent(in) :: summary !! that of spintop_table_end
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine seal

        !> Passes all rows to the system.
        module subroutine flush_file(self, error)
            class(netcdf_file_t), intent(inout) :: self
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine flush_file

        !> Writes all rows, and closes the file.
        module subroutine close_file(self, error)
            class(netcdf_file_t), intent(inout) :: self
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine close_file
    end interface

contains

    !> Has a closed file confirmed before it gets its name: what is read from it is what was written. The library does not
    !> tell of all failures: a short read gives zeros, and a write that fails when a file is closed is no error.
    subroutine confirm_netcdf(path, is_same, error)
        character(*), intent(in) :: path !! path of the file
        logical, intent(in) :: is_same !! whether what is read is what was written
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (is_same) return
        error = output_error('cannot write ' // path // ': what is read from it is not what was written')
    end subroutine confirm_netcdf

    !> The header of a table in either format, as text.
    subroutine head_of_table(path, head, error)
        character(*), intent(in) :: path !! path of the table
        character(:), allocatable, intent(out) :: head !! the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (is_netcdf(path)) then
            call head_of_netcdf(path, head, error)
        else
            call read_head(path, head, error)
        end if
    end subroutine head_of_table

    !> The header of a NetCDF file, as a table of text has it.
    subroutine head_of_netcdf(path, head, error)
        character(*), intent(in) :: path !! path of the file
        character(:), allocatable, intent(out) :: head !! the header
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(netcdf_file_t) :: file
        type(error_t), allocatable :: ignored
        head = ''
        call file%open(path, .false., error)
        if (.not. allocated(error)) head = file%description%head()
        call file%close(ignored)
    end subroutine head_of_netcdf

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
