#ifndef SPINTOP_NETCDF
!> NetCDF files in a build without the library: none can be created or opened, and nothing is done after that error.
submodule(spintop_netcdf_file) netcdf_absent
    implicit none

contains

    module procedure open_file
        self%path = path
        self%error = output_error('cannot open ' // path // ': this build has no NetCDF')
    end procedure open_file

    module procedure add_text
    end procedure add_text

    module procedure add_numbers
    end procedure add_numbers

    module procedure add_dimension
        dimension = -1
    end procedure add_dimension

    module procedure define_variable
        variable = -1
    end procedure define_variable

    module procedure put
    end procedure put

    module procedure get
        values = 0
    end procedure get

    module procedure read_text
        text = ''
    end procedure read_text

    module procedure read_facts
        allocate (facts(0))
    end procedure read_facts

    module procedure read_numbers
        allocate (numbers(0))
    end procedure read_numbers

    module procedure read_layout
        allocate (axes(0), kinds(0))
    end procedure read_layout

    module procedure close_file
        call move_alloc(self%error, error)
    end procedure close_file

end submodule netcdf_absent
#endif
