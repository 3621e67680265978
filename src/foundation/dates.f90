!> Dates and times of day, as tables of other programs contain them.
module spintop_dates
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_finite, no_number
    implicit none
    private
    public :: is_date, read_date

    character(*), parameter :: digits = '0123456789'

contains

    !> Whether a cell looks like a date or a time of day.
    pure logical function is_date(cell)
        character(*), intent(in) :: cell !! any text
        integer(int64) :: day
        real(dp) :: seconds
        call read_date(cell, day, seconds)
        is_date = is_finite(seconds)
    end function is_date

    !> Reads an instant: `2026-05-31T13:05:22.123+02:00`, `31.05.2026 13:05:22`, or `13:05:22.123`, which is of day 0.
    pure subroutine read_date(cell, day, seconds)
        character(*), intent(in) :: cell !! the text, without blanks around it
        integer(int64), intent(out) :: day !! a number of the day
        real(dp), intent(out) :: seconds !! of the day; NaN if the cell is no instant
        character(:), allocatable :: clock, date
        integer :: fields(3), parts, status, zone, at

        seconds = no_number
        day = 0
        at = index(cell, ':')
        if (at < 2) return
        at = scan(cell(:at), 'Tt _', back=.true.)
        clock = trim(cell(at + 1:))
        date = cell(:verify(cell(:at), 'Tt _', back=.true.))
        if (date /= '') then
            call read_fields(date, '-/.', fields, parts, status)
            if (status /= 0 .or. parts /= 3) return
            if (fields(1) < 1000 .and. scan(date, '.') > 0) fields = fields(3:1:-1)
            associate (y => fields(1), m => fields(2), d => fields(3))
                if (y < 1000 .or. m < 1 .or. m > 12 .or. d < 1 .or. d > 31) return
                ! The Julian day of Fliegel and van Flandern (1968).
                day = 367_int64 * y - 7 * (y + (m + 9) / 12) / 4 - 3 * ((y + (m - 9) / 7) / 100 + 1) / 4 + 275 * m / 9 + d + &
                      1721029
            end associate
        end if
        zone = 0
        at = scan(clock, 'Z+-')
        if (at > 0) then
            if (clock(at:at) /= 'Z') then
                call read_fields(clock(at + 1:), ':', fields, parts, status)
                if (status /= 0) return
                if (parts == 1 .and. fields(1) > 99) fields(:2) = [fields(1) / 100, mod(fields(1), 100)]
                zone = merge(-1, 1, clock(at:at) == '-') * (60 * fields(1) + fields(2))
            else if (at < len(clock)) then
                return
            end if
            clock = clock(:at - 1)
        end if
        at = scan(clock // '.', '.,')
        call read_fields(clock(:at - 1), ':', fields, parts, status)
        if (status /= 0 .or. parts /= 3 .or. fields(2) > 59 .or. fields(3) > 60) return
        clock = '0.' // clock(min(at, len(clock)) + 1:) // '0'
        if (verify(clock(3:), digits) > 0) return
        read (clock, *) seconds
        seconds = seconds + 3600.0_dp * fields(1) + 60 * fields(2) + fields(3) - 60.0_dp * zone
    end subroutine read_date

    !> Reads whole numbers between separators; status is not 0 where there are others, or too many.
    pure subroutine read_fields(text, marks, fields, parts, status)
        character(*), intent(in) :: text, marks
        integer, intent(out) :: fields(3), parts, status
        integer :: at, after
        fields = 0
        parts = 0
        status = 1
        at = 1
        do while (at <= len_trim(text) + 1)
            after = at - 1 + scan(text(at:) // marks, marks)
            if (parts == size(fields) .or. after == at .or. after - at > 4) return
            if (verify(text(at:after - 1), digits) > 0) return
            parts = parts + 1
            read (text(at:after - 1), *) fields(parts)
            at = after + 1
        end do
        status = merge(0, 1, parts > 0)
    end subroutine read_fields

end module spintop_dates
