!> Progress of a long computation on standard error: one line that is overwritten on a terminal, or a line
!> every few seconds in a log. The caller of the library is told of it, too.
module spintop_progress
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: stop_is_wanted, tell_share
    use spintop_process, only: seconds
    use spintop_kinds, only: dp
    use spintop_files, only: complain_of
    use spintop_terminal, only: error_is_terminal, message_width
    use spintop_text, only: characters, escaped, to_text
    implicit none
    private
    public :: progress_t, progress_text, bar, fitted

    !> Seconds between two lines.
    real(dp), parameter :: terminal_pause = 0.2_dp, log_pause = 10

    !> The time left is that of the mean rate, or between it and that of the recent rate where they differ by
    !> more than this factor.
    real(dp), parameter :: uneven = 1.5_dp
    !> Recent is a part of the elapsed time: at least one and at most two of these, and at least so many seconds.
    real(dp), parameter :: recent_part = 0.2_dp, recent_least = 1

    !> Characters of the bar, and the fewest where the line has no room for more.
    integer, parameter :: bar_length = 20, least_bar_length = 5

    integer, parameter :: silent = 0, terminal = 1, log = 2

    !> Progress of one computation. Only one thread at a time may update it.
    type :: progress_t
        private
        character(:), allocatable :: name, noun
        integer(int64) :: total = 0, before = 0
        integer :: mode = silent
        real(dp) :: started = 0, shown = 0
        !> Times of two marks, and the number of finished items at each.
        real(dp) :: marked(2) = 0
        integer(int64) :: done_at_mark(2) = 0
    contains
        procedure :: start
        procedure :: note
        procedure :: update
        procedure :: finish
    end type progress_t

contains

    !> Starts the clock. Nothing is shown if `quiet`, or if standard error is not a terminal and `forced` is
    !> false.
    subroutine start(self, name, noun, total, quiet, forced, before)
        class(progress_t), intent(inout) :: self
        character(*), intent(in) :: name          !! stands before the progress
        character(*), intent(in) :: noun          !! what is counted: `cases`
        integer(int64), intent(in) :: total !! number of all items
        logical, intent(in) :: quiet, forced !! whether to show nothing; whether to show progress without a terminal
        integer(int64), intent(in), optional :: before !! of the total, done by an earlier run

        self%name = escaped(name)
        self%noun = noun
        self%total = total
        self%before = 0
        if (present(before)) self%before = before
        self%mode = merge(log, silent, forced)
        if (error_is_terminal()) self%mode = terminal
        if (quiet) self%mode = silent
        self%started = seconds()
        self%shown = self%started
        self%marked = self%started
        self%done_at_mark = self%before
    end subroutine start

    !> Shows a line that is not overwritten, where progress is shown.
    subroutine note(self, text)
        class(progress_t), intent(in) :: self
        character(*), intent(in) :: text !! the line to show
        if (self%mode == silent) return
        call print_line(self, self%name // ': ' // text)
        if (self%mode == terminal) call complain_of(new_line('a'))
    end subroutine note

    !> Shows the progress, if the last line is old enough, and tells the caller.
    subroutine update(self, done)
        class(progress_t), intent(inout) :: self
        integer(int64), intent(in) :: done !! number of finished items
        character(:), allocatable :: text
        real(dp) :: now
        integer :: room
        logical :: stops

        if (self%total > 0) call tell_share(real(done, dp) / self%total)
        stops = stop_is_wanted()
        if (stops .or. self%mode == silent) return
        now = seconds()
        if (now - self%shown < merge(terminal_pause, log_pause, self%mode == terminal)) return
        self%shown = now
        text = progress_text(done, self%total, now - self%started, self%noun, self%before, &
                             (done - self%done_at_mark(1)) / max(now - self%marked(1), tiny(now)))
        if (self%mode == terminal) then
            room = message_width() - 1 - characters(self%name // ': [] ' // text)
            if (room >= least_bar_length) text = bar(done, self%total, min(room, bar_length)) // ' ' // text
        end if
        call print_line(self, self%name // ': ' // text)
        if (now - self%marked(2) < max(recent_least, recent_part * (now - self%started))) return
        self%marked = [self%marked(2), now]
        self%done_at_mark = [self%done_at_mark(2), done]
    end subroutine update

    !> Removes the line from a terminal.
    subroutine finish(self)
        class(progress_t), intent(inout) :: self
        if (self%mode == terminal .and. self%shown > self%started) call print_line(self, '')
        self%mode = silent
    end subroutine finish

    subroutine print_line(self, line)
        class(progress_t), intent(in) :: self
        character(*), intent(in) :: line
        character(*), parameter :: carriage_return = achar(13), erase_line = achar(27) // '[K'
        if (self%mode == terminal) then
            call complain_of(carriage_return // fitted(line, message_width() - 1) // erase_line)
        else
            call complain_of(line // new_line('a'))
        end if
    end subroutine print_line

    !> `[#########...........]`
    pure function bar(done, total, length) result(text)
        integer(int64), intent(in) :: done, total !! number of finished items, and of all
        integer, intent(in) :: length !! characters between the brackets
        character(length + 2) :: text
        integer :: full
        full = int(length * (real(min(done, total), dp) / max(total, 1_int64)))
        text = '[' // repeat('#', full) // repeat('.', length - full) // ']'
    end function bar

    !> The beginning of a line that has room in so many columns: a longer line could not be overwritten.
    pure function fitted(line, columns) result(text)
        character(*), intent(in) :: line !! in UTF-8
        integer, intent(in) :: columns !! room for it
        character(:), allocatable :: text
        integer :: i, used
        used = 0
        do i = 1, len(line)
            if (iand(iachar(line(i:i)), 192) /= 128) used = used + 1 ! the first byte of a character
            if (used > columns) exit
        end do
        text = line(:i - 1)
    end function fitted

    !> `45 %, 450 of 1000 cases, 120 cases/s, 0:04 left`; where items take longer or less long of late, from the
    !> one estimate of the time left to the other: `0:04 to 0:12 left`.
    function progress_text(done, total, elapsed, noun, before, recent) result(text)
        integer(int64), intent(in) :: done, total !! number of finished items, and of all
        real(dp), intent(in) :: elapsed      !! seconds
        character(*), intent(in) :: noun !! name of the items: `cases`
        integer(int64), intent(in) :: before !! done when the time began
        real(dp), intent(in), optional :: recent !! items per second of late
        character(:), allocatable :: text
        real(dp) :: rate, slow, fast

        rate = (done - before) / max(elapsed, tiny(elapsed))
        text = to_text(int(100 * real(done, dp) / max(total, 1_int64))) // ' %, ' // &
            to_text(done) // ' of ' // to_text(total) // ' ' // noun
        if (done == before .or. elapsed <= 0) return
        slow = rate
        if (present(recent)) slow = min(rate, recent)
        fast = rate
        if (present(recent)) fast = max(rate, recent)
        text = text // ', ' // rate_text(rate) // ' ' // noun // '/s, '
        if (done == total .or. fast <= uneven * slow) then
            text = text // duration_text((total - done) / rate) // ' left'
        else if (slow <= 0) then
            text = text // 'more than ' // duration_text((total - done) / rate) // ' left'
        else
            text = text // duration_text((total - done) / fast) // ' to ' // duration_text((total - done) / slow) // ' left'
        end if
    end function progress_text

    !> A rate with three digits.
    function rate_text(rate) result(text)
        real(dp), intent(in) :: rate
        character(:), allocatable :: text
        character(16) :: room

        write (room, '(ss, f0.2)') rate
        text = trim(room)
        if (text(1:1) == '.') text = '0' // text
        if (rate >= 100) text = to_text(nint(rate, int64))
    end function rate_text

    !> `0:04`, `12:30`, `3:02:01`
    function duration_text(duration) result(text)
        real(dp), intent(in) :: duration !! seconds
        character(:), allocatable :: text
        character(32) :: room
        integer(int64) :: whole

        whole = nint(min(duration, 1e9_dp), int64)
        write (room, '(ss, i0, 2(":", i2.2))') whole / 3600, mod(whole / 60, 60_int64), mod(whole, 60_int64)
        if (whole < 3600) write (room, '(ss, i0, ":", i2.2)') whole / 60, mod(whole, 60_int64)
        text = trim(room)
    end function duration_text

end module spintop_progress
