!> A checksum of bytes that are given in pieces of any size; see checksum.c.
module spintop_checksum
    use, intrinsic :: iso_c_binding, only: c_char, c_int64_t, c_long_long
    implicit none
    private
    public :: checksum_t, add_to_checksum, checksum_text, checksum_of, checksum_width

    !> Number of characters of a checksum as text.
    integer, parameter :: checksum_width = 16

    !> State of a checksum. A copy continues independently.
    type, bind(C) :: checksum_t
        private
        integer(c_int64_t) :: lane(4) = [1_c_int64_t, 2_c_int64_t, 3_c_int64_t, 4_c_int64_t]
        integer(c_int64_t) :: length = 0
        character(c_char) :: tail(32) = ' '
    end type checksum_t

    interface
        subroutine c_add(self, bytes, count) bind(C, name='spintop_add_to_checksum')
            import :: c_char, c_long_long, checksum_t
            type(checksum_t), intent(inout) :: self
            character(c_char), intent(in) :: bytes(*)
            integer(c_long_long), value :: count
        end subroutine c_add

        integer(c_int64_t) function c_value(self) bind(C, name='spintop_checksum_value')
            import :: c_int64_t, checksum_t
            type(checksum_t), intent(in) :: self
        end function c_value
    end interface

contains

    !> Adds bytes to the checksum.
    subroutine add_to_checksum(self, text)
        type(checksum_t), intent(inout) :: self !! the checksum
        character(*), intent(in) :: text !! bytes
        call c_add(self, text, len(text, c_long_long))
    end subroutine add_to_checksum

    !> The checksum of all bytes so far, as hexadecimal digits.
    function checksum_text(self) result(text)
        type(checksum_t), intent(in) :: self !! the checksum
        character(checksum_width) :: text
        write (text, '(z16.16)') c_value(self)
    end function checksum_text

    !> The checksum of a text.
    function checksum_of(text)
        character(*), intent(in) :: text !! all bytes
        character(checksum_width) :: checksum_of
        type(checksum_t) :: checksum
        call add_to_checksum(checksum, text)
        checksum_of = checksum_text(checksum)
    end function checksum_of

end module spintop_checksum
