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
        associate (unused => self, also_unused => description)
        end associate
        error = output_error('cannot write ' // path // ': ' // reason)
    end procedure create

    module procedure open_file
        associate (unused => self, also_unused => to_continue)
        end associate
        error = output_error('cannot read ' // path // ': ' // reason)
    end procedure open_file

    module procedure put
        associate (unused => self, also_unused => cells)
        end associate
        error = output_error(reason)
    end procedure put

    module procedure close_netcdf
        associate (unused => id, also_unused => failure, nor => uses_hdf)
        end associate
        error = output_error('cannot write ' // path // ': ' // reason)
    end procedure close_netcdf

    module procedure get
        associate (unused => self, also_unused => first)
        end associate
        cells = 0
        error = output_error(reason)
    end procedure get

    module procedure seal
        associate (unused => self, also_unused => summary)
        end associate
        error = output_error(reason)
    end procedure seal

    module procedure flush_file
        associate (unused => self)
        end associate
        error = output_error(reason)
    end procedure flush_file

    module procedure close_file
        associate (unused => self)
        end associate
        if (allocated(error)) return
    end procedure close_file

end submodule netcdf_file_absent
#endif
