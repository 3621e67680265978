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
        integer :: fields(3), parts, colon, status, sign_of_zone, zone, after
        integer :: y, m, d

        seconds = no_number
        day = 0
        colon = index(cell, ':')
        if (colon < 2) return
        clock = trim(adjustl(cell(max(1, scan(cell(:colon), 'Tt _', back=.true.)):)))
        if (scan(clock(1:1), 'Tt_') > 0) clock = clock(2:)
        date = cell(:len_trim(cell) - len_trim(clock))
        if (date /= '') then
            call read_fields(date(:verify(date, 'Tt _', back=.true.)), '-/.', fields, parts, status)
            if (status /= 0 .or. parts /= 3) return
            if (fields(1) > 999) then
                y = fields(1)
                m = fields(2)
                d = fields(3)
            else if (fields(3) > 999 .and. scan(date, '.') > 0) then
                y = fields(3)
                m = fields(2)
                d = fields(1)
            else
                return
            end if
            if (m < 1 .or. m > 12 .or. d < 1 .or. d > 31) return
            ! The Julian day of Fliegel and van Flandern (1968).
            day = 367_int64 * y - 7 * (y + (m + 9) / 12) / 4 - 3 * ((y + (m - 9) / 7) / 100 + 1) / 4 + 275 * m / 9 + d + 1721029
        end if
        zone = 0
        after = scan(clock, 'Z+-')
        if (after > 0) then
            if (clock(after:after) /= 'Z') then
                sign_of_zone = merge(-1, 1, clock(after:after) == '-')
                call read_fields(clock(after + 1:), ':', fields, parts, status)
                if (status /= 0) return
                if (parts == 1 .and. fields(1) > 99) fields(:2) = [fields(1) / 100, mod(fields(1), 100)]
                zone = sign_of_zone * (60 * fields(1) + fields(2))
            else if (after < len_trim(clock)) then
                return
            end if
            clock = clock(:after - 1)
        end if
        after = scan(clock // '.', '.,')
        call read_fields(clock(:after - 1), ':', fields, parts, status)
        if (status /= 0 .or. parts /= 3 .or. fields(2) > 59 .or. fields(3) > 60) return
        if (verify(clock(min(after + 1, len(clock) + 1):), digits) > 0) return
        seconds = 0
        if (after < len(clock)) then
            clock = '0.' // clock(after + 1:)
            read (clock, *, iostat=status) seconds
        end if
        if (status /= 0) seconds = no_number
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
