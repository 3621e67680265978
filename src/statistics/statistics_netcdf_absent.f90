#ifndef SPINTOP_NETCDF
!> Statistics as NetCDF in a build without the library: none can be written.
submodule(spintop_statistics_netcdf) statistics_netcdf_absent
    use spintop_errors, only: output_error
    implicit none

contains

    module procedure write_statistics_netcdf
        error = output_error('cannot write ' // path // ': this build has no NetCDF')
    end procedure write_statistics_netcdf

end submodule statistics_netcdf_absent
#endif
