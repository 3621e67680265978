!> Progress of a long computation, on standard error: one line that is overwritten on a terminal,
!> or plain lines every so often in a log.
module spintop_progress
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: seconds
    use spintop_plain_text, only: visible
    use spintop_kinds, only: dp
    use spintop_process, only: complain_of
    use spintop_terminal, only: error_is_terminal
    use spintop_text, only: to_text
    implicit none
    private
    public :: progress_t, progress_text

    !> Seconds between two lines.
    real(dp), parameter :: terminal_pause = 0.2_dp, log_pause = 10

    integer, parameter :: silent = 0, terminal = 1, log = 2

    !> To be updated by one thread at a time.
    type :: progress_t
        private
        character(:), allocatable :: name, noun
        integer(int64) :: total = 0, before = 0
        integer :: mode = silent
        real(dp) :: started = 0, shown = 0
    contains
        procedure :: start
        procedure :: note
        procedure :: update
        procedure :: finish
    end type progress_t

contains

    !> Starts the clock. Nothing is shown if `quiet`, nor where standard error is no terminal
    !> unless `forced`.
    subroutine start(self, name, noun, total, quiet, forced, before)
        class(progress_t), intent(inout) :: self
        character(*), intent(in) :: name          !! stands before the progress
        character(*), intent(in) :: noun          !! what is counted: `cases`
        integer(int64), intent(in) :: total
        logical, intent(in) :: quiet, forced
        integer(int64), intent(in), optional :: before !! of the total, done by an earlier run

        self%name = name
        self%noun = noun
        self%total = total
        self%before = 0
        if (present(before)) self%before = before
        self%mode = silent
        if (.not. quiet) then
            if (error_is_terminal()) then
                self%mode = terminal
            else if (forced) then
                self%mode = log
            end if
        end if
        self%started = seconds()
        self%shown = self%started
    end subroutine start

    !> Shows a line that stays, where progress is shown.
    subroutine note(self, text)
        class(progress_t), intent(in) :: self
        character(*), intent(in) :: text
        if (self%mode == silent) return
        call show(self, visible(self%name) // ': ' // text)
        if (self%mode == terminal) call complain_of(new_line('a'))
    end subroutine note

    !> Shows how much is done, if the last line is old enough.
    subroutine update(self, done)
        class(progress_t), intent(inout) :: self
        integer(int64), intent(in) :: done
        real(dp) :: now

        if (self%mode == silent) return
        now = seconds()
        if (now - self%shown < merge(terminal_pause, log_pause, self%mode == terminal)) return
        self%shown = now
        call show(self, visible(self%name) // ': ' // &
            progress_text(done, self%total, now - self%started, self%noun, self%before))
    end subroutine update

    !> Removes the line from a terminal.
    subroutine finish(self)
        class(progress_t), intent(inout) :: self
        if (self%mode == terminal .and. self%shown > self%started) call show(self, '')
        self%mode = silent
    end subroutine finish

    subroutine show(self, line)
        class(progress_t), intent(in) :: self
        character(*), intent(in) :: line
        character(*), parameter :: carriage_return = achar(13), erase_line = achar(27) // '[K'
        if (self%mode == terminal) then
            call complain_of(carriage_return // line // erase_line)
        else
            call complain_of(line // new_line('a'))
        end if
    end subroutine show

    !> `45 %, 450 of 1000 cases, 120 cases/s, 0:04 left`
    function progress_text(done, total, elapsed, noun, before) result(text)
        integer(int64), intent(in) :: done, total
        real(dp), intent(in) :: elapsed      !! seconds
        character(*), intent(in) :: noun
        integer(int64), intent(in) :: before !! done when the time began
        character(:), allocatable :: text
        real(dp) :: rate

        rate = (done - before) / max(elapsed, tiny(elapsed))
        text = to_text(int(100 * real(done, dp) / max(total, 1_int64))) // ' %, ' // &
            to_text(done) // ' of ' // to_text(total) // ' ' // noun
        if (done == before .or. elapsed <= 0) return
        text = text // ', ' // rate_text(rate) // ' ' // noun // '/s, ' // &
            duration_text((total - done) / rate) // ' left'
    end function progress_text

    !> Three digits are enough.
    function rate_text(rate) result(text)
        real(dp), intent(in) :: rate
        character(:), allocatable :: text
        character(16) :: room

        if (rate >= 100) then
            text = to_text(nint(rate, int64))
        else
            write (room, '(f0.2)') rate
            text = trim(room)
            if (text(1:1) == '.') text = '0' // text
        end if
    end function rate_text

    !> `0:04`, `12:30`, `3:02:01`
    function duration_text(duration) result(text)
        real(dp), intent(in) :: duration !! seconds
        character(:), allocatable :: text
        character(32) :: room
        integer(int64) :: whole

        whole = nint(min(duration, 1e9_dp), int64)
        if (whole >= 3600) then
            write (room, '(i0, 2(":", i2.2))') whole / 3600, mod(whole / 60, 60_int64), &
                mod(whole, 60_int64)
        else
            write (room, '(i0, ":", i2.2)') whole / 60, mod(whole, 60_int64)
        end if
        text = trim(room)
    end function duration_text

end module spintop_progress
