#ifndef SPINTOP_NETCDF
!> NetCDF tables in a build without the library: none can be started.
submodule(spintop_netcdf_table) netcdf_absent
    use spintop_errors, only: output_error
    implicit none

contains

    module procedure has_netcdf
        has_netcdf = .false.
    end procedure has_netcdf

    module procedure start
        associate (unused => self, a => facts, b => input, c => axes)
        end associate
        error = output_error('cannot write ' // path // ': this build has no NetCDF')
    end procedure start

    module procedure put
        associate (unused => self, also_unused => block)
        end associate
        error = output_error('this build has no NetCDF')
    end procedure put

    module procedure finish
        associate (unused => self)
        end associate
        error = output_error('this build has no NetCDF')
    end procedure finish

    module procedure abandon
        associate (unused => self, also_unused => error)
        end associate
    end procedure abandon

end submodule netcdf_absent
#endif
