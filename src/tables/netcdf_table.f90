!> A table as a NetCDF file of the classic format with 64-bit offsets, by the CF conventions: every column is
!> a variable over the grid of the cases. Its layout is fixed when it is started, and it contains no time
!> stamp of the library. The rows are written to `NAME.part`, which is renamed to the table when all data are
!> on the disk.
!>
!> The calls of the library are in the submodule `netcdf_written`; a build without it has `netcdf_absent`
!> instead, and no table can be started.
module spintop_netcdf_table
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_provenance, only: fact_t
    use spintop_row_block, only: row_block_t
    use spintop_row_table, only: row_table_t
    use spintop_table_file, only: table_file_t
    use spintop_text, only: string_t
    implicit none
    private
    public :: netcdf_table_t, has_netcdf

    !> A table of a sweep as a NetCDF file.
    type, extends(row_table_t) :: netcdf_table_t
        integer, private :: id = -1
        integer, allocatable, private :: variables(:)
        integer, allocatable, private :: extent(:) !! of the grid; the first varies fastest
        !> Rows that are not yet written, one column each.
        real(dp), allocatable, private :: pending(:, :)
        integer, private :: held = 0
        integer(int64), private :: written = 0
        type(table_file_t), private :: file
    contains
        procedure :: start
        procedure :: put
        procedure :: finish
        procedure :: abandon
    end type netcdf_table_t

    interface
        !> Whether this build contains the library.
        pure logical module function has_netcdf()
        end function has_netcdf

        !> Starts a table with the current columns over a grid. Columns along an axis are its coordinate.
        module subroutine start(self, path, facts, input, axes, error)
            class(netcdf_table_t), intent(inout) :: self
            character(*), intent(in) :: path !! path of the table
            type(fact_t), intent(in) :: facts(:)   !! attributes of the whole file, and
            type(string_t), intent(in) :: input(:) !! another one, the resolved namelist
            type(netcdf_axis_t), intent(in) :: axes(:) !! axes of the grid
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine start

        !> Adds rows.
        module subroutine put(self, block, error)
            class(netcdf_table_t), intent(inout) :: self
            type(row_block_t), intent(in) :: block !! rows in their order
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine put

        !> Renames the file to the table, when it is on the disk.
        module subroutine finish(self, error)
            class(netcdf_table_t), intent(inout) :: self
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine finish

        !> Removes the file: it has no journal with which a later run could resume.
        module subroutine abandon(self, error)
            class(netcdf_table_t), intent(inout) :: self
            type(error_t), intent(inout) :: error !! its message is completed
        end subroutine abandon
    end interface

end module spintop_netcdf_table
