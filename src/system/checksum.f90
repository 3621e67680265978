!> The CRC-32 of bytes that are given in pieces, and their number of lines; see checksum.c.
module spintop_checksum
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int32_t, c_int64_t, c_long_long
    implicit none
    private
    public :: checksum_t, add_to_checksum, add_reals_to_checksum, checksum_text, checksum_of, checksum_width

    !> Number of characters of a checksum as text.
    integer, parameter :: checksum_width = 8

    !> A CRC-32, and the number of lines that do not begin with `#`. A copy continues independently.
    type, bind(C) :: checksum_t
        !> Number of lines.
        integer(c_int64_t) :: lines = 0
        integer(c_int32_t) :: state = 0     !! the CRC-32
        integer(c_int32_t) :: in_line = 0   !! nonzero in the midst of a line
    end type checksum_t

    interface
        subroutine c_add(self, bytes, count) bind(C, name='spintop_add_to_checksum')
            import :: c_char, c_long_long, checksum_t
            type(checksum_t), intent(inout) :: self
            character(c_char), intent(in) :: bytes(*)
            integer(c_long_long), value :: count
        end subroutine c_add

        !> Adds the bytes of numbers, which are no lines.
        subroutine add_reals_to_checksum(self, values, count) bind(C, name='spintop_add_reals_to_checksum')
            import :: c_double, c_long_long, checksum_t
            type(checksum_t), intent(inout) :: self !! the CRC-32
            real(c_double), intent(in) :: values(*) !! numbers
            integer(c_long_long), value :: count !! how many there are
        end subroutine add_reals_to_checksum
    end interface

contains

    !> Adds bytes.
    subroutine add_to_checksum(self, text)
        type(checksum_t), intent(inout) :: self !! the CRC-32
        character(*), intent(in) :: text !! bytes
        call c_add(self, text, len(text, c_long_long))
    end subroutine add_to_checksum

    !> The CRC-32 of all bytes so far, as hexadecimal digits.
    function checksum_text(self) result(text)
        type(checksum_t), intent(in) :: self !! the CRC-32
        character(checksum_width) :: text
        write (text, '(z8.8)') self%state
    end function checksum_text

    !> The CRC-32 of a text.
    function checksum_of(text)
        character(*), intent(in) :: text !! all bytes
        character(checksum_width) :: checksum_of
        type(checksum_t) :: checksum
        call add_to_checksum(checksum, text)
        checksum_of = checksum_text(checksum)
    end function checksum_of

end module spintop_checksum
