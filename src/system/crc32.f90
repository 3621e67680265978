!> The CRC-32 of bytes that are given in pieces, and their number of lines; see crc32.c.
module spintop_crc32
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int32_t, c_int64_t, c_long_long
    implicit none
    private
    public :: crc32_t, add_to_crc32, add_reals_to_crc32, crc32_text

    !> A CRC-32, and the number of lines that do not begin with `#`. A copy continues independently.
    type, bind(C) :: crc32_t
        !> Number of lines.
        integer(c_int64_t) :: lines = 0
        integer(c_int32_t) :: state = 0     !! the CRC-32
        integer(c_int32_t) :: in_line = 0   !! nonzero in the midst of a line
    end type crc32_t

    interface
        subroutine c_add(self, bytes, count) bind(C, name='spintop_add_to_crc32')
            import :: c_char, c_long_long, crc32_t
            type(crc32_t), intent(inout) :: self
            character(c_char), intent(in) :: bytes(*)
            integer(c_long_long), value :: count
        end subroutine c_add

        subroutine c_add_reals(self, values, count) bind(C, name='spintop_add_reals_to_crc32')
            import :: c_double, c_long_long, crc32_t
            type(crc32_t), intent(inout) :: self
            real(c_double), intent(in) :: values(*)
            integer(c_long_long), value :: count
        end subroutine c_add_reals
    end interface

contains

    !> Adds bytes.
    subroutine add_to_crc32(self, text)
        type(crc32_t), intent(inout) :: self !! the CRC-32
        character(*), intent(in) :: text !! bytes
        call c_add(self, text, len(text, c_long_long))
    end subroutine add_to_crc32

    !> Adds the bytes of numbers, which are no lines.
    subroutine add_reals_to_crc32(self, values)
        type(crc32_t), intent(inout) :: self !! the CRC-32
        real(c_double), intent(in), contiguous :: values(:, :) !! numbers
        call c_add_reals(self, values, size(values, kind=c_long_long))
    end subroutine add_reals_to_crc32

    !> The CRC-32 of all bytes so far, as hexadecimal digits.
    function crc32_text(self) result(text)
        type(crc32_t), intent(in) :: self !! the CRC-32
        character(8) :: text
        write (text, '(z8.8)') self%state
    end function crc32_text

end module spintop_crc32
