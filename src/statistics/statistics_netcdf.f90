!> The result of statistics as a NetCDF file of the classic format with 64-bit offsets, by the CF conventions: every
!> column is a variable over the grid of the bins, with their middles as coordinates and their ends as bounds. A
!> variable `all_NAME` is that of all cases. The histogram of a column is a variable over its intervals.
!>
!> The calls of the library are in the submodule `statistics_netcdf_written`; a build without it has
!> `statistics_netcdf_absent` instead.
module spintop_statistics_netcdf
    use spintop_accumulators, only: accumulators_t
    use spintop_errors, only: error_t
    use spintop_statistics_plan, only: statistics_plan_t
    implicit none
    private
    public :: write_statistics_netcdf

    interface
        !> Writes the file, under another name until it is complete.
        module subroutine write_statistics_netcdf(path, head, plan, accumulators, error)
            character(*), intent(in) :: path !! path of the file
            character(*), intent(in) :: head !! header of the result as a table has it
            type(statistics_plan_t), intent(in) :: plan !! what is gathered
            type(accumulators_t), intent(inout) :: accumulators !! the statistics; only sorted
            type(error_t), allocatable, intent(out) :: error !! not allocated on success
        end subroutine write_statistics_netcdf
    end interface

end module spintop_statistics_netcdf
