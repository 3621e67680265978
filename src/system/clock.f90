!> The clock: elapsed time, processor time and the date.
module spintop_clock
    use spintop_kinds, only: dp
    use spintop_posix, only: c_pause, c_processor_seconds, c_seconds, c_utc, up_to_null
    implicit none
    private
    public :: seconds, processor_seconds, pause_for, utc_now

contains

    !> Time of a monotonic clock, s.
    real(dp) function seconds()
        seconds = c_seconds()
    end function seconds

    !> Processor time of the calling thread, s: what it computes, without the time that other programs take.
    real(dp) function processor_seconds()
        processor_seconds = c_processor_seconds()
    end function processor_seconds

    !> Suspends the calling thread, so that others can use the processor.
    subroutine pause_for(seconds)
        real(dp), intent(in) :: seconds !! s
        call c_pause(seconds)
    end subroutine pause_for

    !> Date and time in UTC: `2024-05-31T12:34:56Z`.
    function utc_now() result(text)
        character(:), allocatable :: text
        character(64) :: room
        call c_utc(room, len(room))
        text = up_to_null(room)
    end function utc_now

end module spintop_clock
