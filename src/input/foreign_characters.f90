!> Characters that have no meaning in a namelist, and what is meant by them: those of other languages, and those that word
!> processors and web pages put in the place of quotes, blanks and minus signs.
module spintop_foreign_characters
    implicit none
    private
    public :: find_foreign

contains

    !> Finds the first such character of a text.
    subroutine find_foreign(text, at, width, hint)
        character(*), intent(in) :: text !! some of a namelist, without its texts in quotes
        integer, intent(out) :: at       !! its first byte, or 0 if there is none
        integer, intent(out) :: width    !! its number of bytes
        character(:), allocatable, intent(out) :: hint !! what to write in its place
        hint = ''
        do at = 1, len(text)
            do width = 1, min(3, len(text) - at + 1)
                hint = meant_by(text(at:at + width - 1))
                if (hint /= '') return
            end do
        end do
        at = 0
    end subroutine find_foreign

    !> What to write in the place of a character; '' if it is not known.
    pure function meant_by(character) result(hint)
        character(*), intent(in) :: character
        character(:), allocatable :: hint
        integer :: bytes(3)
        integer :: i, n

        n = len(character)
        bytes = [(merge(iachar(character(min(i, n):min(i, n))), 0, i <= n), i=1, 3)]
        hint = ''
        select case (256 * (256 * bytes(1) + bytes(2)) + bytes(3))
        case (0:256**2 * 31)
            hint = 'a control character: remove it'
        case (256**2 * iachar('['), 256**2 * iachar(']'))
            hint = 'a subscript is in parentheses, as key(1)'
        case (256**2 * iachar('#'))
            hint = 'a comment starts with !'
        case (256**2 * iachar(';'))
            hint = 'values are separated by commas'
        case (256**2 * iachar(':'))
            hint = 'a key is followed by =, and a text is in quotes'
        case (256**2 * iachar('`'), int(z'C2AB00'), int(z'C2B400'), int(z'C2BB00'), int(z'E28098'):int(z'E2809F'))
            hint = 'a text is in straight quotes, as ''text'''
        case (int(z'C2A000'), int(z'E28080'):int(z'E2808B'), int(z'E280AF'), int(z'E38080'))
            hint = 'write an ordinary blank in the place of this one'
        case (int(z'E28090'):int(z'E28095'), int(z'E28892'))
            hint = 'a minus sign is -'
        end select
    end function meant_by

end module spintop_foreign_characters
