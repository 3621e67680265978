#ifndef SPINTOP_NETCDF
!> NetCDF files in a build without the library: none can be created or opened.
submodule(spintop_netcdf_file) netcdf_file_absent
    use spintop_errors, only: output_error
    implicit none

    character(*), parameter :: reason = 'this build has no NetCDF'

contains

    module procedure has_netcdf
        has_netcdf = .false.
    end procedure has_netcdf

    module procedure has_compression
        has_compression = .false.
    end procedure has_compression

    module procedure create
        error = output_error('cannot write ' // path // ': ' // reason)
    end procedure create

    module procedure open_file
        error = output_error('cannot read ' // path // ': ' // reason)
    end procedure open_file

    module procedure append
        error = output_error(reason)
    end procedure append

    module procedure close_netcdf
        error = output_error('cannot write ' // path // ': ' // reason)
    end procedure close_netcdf

    module procedure get
        cells = 0
        error = output_error(reason)
    end procedure get

    module procedure seal
        error = output_error(reason)
    end procedure seal

    module procedure flush_file
        error = output_error(reason)
    end procedure flush_file

    module procedure close_file
    end procedure close_file

end submodule netcdf_file_absent
#endif
