!> The level of the processor, by which the kernels choose one of their builds when the program starts.
module spintop_processor
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_errors, only: error_t, input_error
    use spintop_text, only: to_text
    implicit none
    private
    public :: check_level, processor_level_name

    !> The variable of the environment that chooses a lower level.
    character(*), parameter :: variable = 'SPINTOP_LEVEL'

    !> The lowest level of x86-64 that has a build.
    integer, parameter :: lowest_level = 2

    interface
        !> The level in use, or 0 where all kernels have the flags of the build.
        integer(c_int) function c_level() bind(C, name='spintop_processor_level')
            import :: c_int
        end function c_level

        !> The highest level of the processor, or 0.
        integer(c_int) function c_highest_level() bind(C, name='spintop_highest_level')
            import :: c_int
        end function c_highest_level
    end interface

contains

    !> The name of the level in use, such as `x86-64-v3`; `as built` where all kernels have the flags of the build.
    function processor_level_name() result(name)
        character(:), allocatable :: name
        name = 'as built'
        if (c_level() > 0) name = 'x86-64-v' // to_text(int(c_level()))
    end function processor_level_name

    !> Checks that SPINTOP_LEVEL names a level of this processor, if it is set.
    subroutine check_level(error)
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(:), allocatable :: wanted, levels
        integer :: length, level

        call get_environment_variable(variable, length=length)
        if (length == 0) return
        allocate (character(length) :: wanted)
        call get_environment_variable(variable, wanted)
        levels = ''
        do level = lowest_level, int(c_highest_level())
            if (wanted == 'v' // to_text(level)) return
            levels = levels // ', v' // to_text(level)
        end do
        if (levels == '') levels = ', none'
        error = input_error('spintop: ' // variable // ' is ''' // wanted // &
                            ''', but the levels of this processor are: ' // levels(3:))
    end subroutine check_level

end module spintop_processor
