!> The clock: elapsed time, processor time and the date.
module spintop_clock
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
    use spintop_files, only: up_to_null
    implicit none
    private
    public :: seconds, processor_seconds, pause_for, utc_now

    abstract interface
        real(c_double) function c_time() bind(C)
            import :: c_double
        end function c_time
    end interface

    !> Time of a monotonic clock, s.
    procedure(c_time), bind(C, name='spintop_seconds') :: seconds
    !> Processor time of the calling thread, s: what it computes, without the time that other programs take.
    procedure(c_time), bind(C, name='spintop_processor_seconds') :: processor_seconds

    interface
        !> Suspends the calling thread, so that others can use the processor.
        subroutine pause_for(seconds) bind(C, name='spintop_pause')
            import :: c_double
            real(c_double), value :: seconds !! length of the pause, s
        end subroutine pause_for

        subroutine c_utc(text, room) bind(C, name='spintop_utc')
            import :: c_char, c_int
            character(c_char), intent(inout) :: text(*)
            integer(c_int), value :: room
        end subroutine c_utc
    end interface

contains

    !> Date and time in UTC: `2024-05-31T12:34:56Z`.
    function utc_now() result(text)
        character(:), allocatable :: text
        character(64) :: room
        call c_utc(room, len(room))
        text = up_to_null(room)
    end function utc_now

end module spintop_clock
