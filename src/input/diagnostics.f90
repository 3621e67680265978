!> The errors and warnings of an input, each shown with its source line:
!>
!>     scene.nml:12:5: error: unknown key 'mas' in group &top
!>        |
!>     12 |     mas = 1.5
!>        |     ^^^ did you mean 'mass'?
module spintop_diagnostics
    use spintop_errors, only: error_t, input_error
    use spintop_text, only: characters, counted, default_width, escaped, to_text, visible, wrapped
    implicit none
    private
    public :: diagnostics_t, place_t

    !> Problems beyond this number are counted, not shown.
    integer, parameter :: most_shown = 100
    !> Maximum length of the part of a source line that is shown.
    integer, parameter :: widest_line = 100, least_window = 20

    !> A place in a source. By default there is no place.
    type :: place_t
        integer :: source = 0 !! number of the source, 0 for none
        integer :: line = 0   !! from 1; 0 means the source as a whole
        integer :: column = 1 !! byte in the line, from 1
        integer :: width = 1  !! bytes that are marked
    end type place_t

    type :: source_t
        character(:), allocatable :: name, text
    end type source_t

    type :: problem_t
        type(place_t) :: place
        character(:), allocatable :: severity, message, hint
    end type problem_t

    !> The problems of one input, in the order of their places.
    type :: diagnostics_t
        private
        type(source_t), allocatable :: sources(:)
        type(problem_t), allocatable :: problems(:)
        integer :: errors = 0, warnings = 0
    contains
        procedure :: add_source
        procedure :: error
        procedure :: warning
        procedure :: has_errors
        procedure :: has_warnings
        procedure :: report
        procedure :: raise
    end type diagnostics_t

contains

    !> Registers a source, so that places in it can be shown; `number` identifies it.
    subroutine add_source(self, name, text, number)
        class(diagnostics_t), intent(inout) :: self
        character(*), intent(in) :: name !! stands before line and column: a file name, `--set`
        character(*), intent(in) :: text !! contents of the source
        integer, intent(out) :: number !! identifies the source in places
        type(source_t), allocatable :: larger(:)

        number = 1
        if (allocated(self%sources)) number = size(self%sources) + 1
        allocate (larger(number))
        if (number > 1) larger(:number - 1) = self%sources
        larger(number)%name = name
        larger(number)%text = text
        call move_alloc(larger, self%sources)
    end subroutine add_source

    !> Adds an error: what is wrong, and what is expected.
    subroutine error(self, place, message, hint)
        class(diagnostics_t), intent(inout) :: self
        type(place_t), intent(in) :: place !! place in the source
        character(*), intent(in) :: message !! what is wrong
        character(*), intent(in), optional :: hint !! what is expected
        self%errors = self%errors + 1
        call add(self, place, 'error', message, hint)
    end subroutine error

    !> Adds a warning.
    subroutine warning(self, place, message, hint)
        class(diagnostics_t), intent(inout) :: self
        type(place_t), intent(in) :: place !! place in the source
        character(*), intent(in) :: message !! what is wrong
        character(*), intent(in), optional :: hint !! what is expected
        self%warnings = self%warnings + 1
        call add(self, place, 'warning', message, hint)
    end subroutine warning

    !> Whether there is an error among them.
    pure logical function has_errors(self)
        class(diagnostics_t), intent(in) :: self
        has_errors = self%errors > 0
    end function has_errors

    !> Whether there is a warning among them.
    pure logical function has_warnings(self)
        class(diagnostics_t), intent(in) :: self
        has_warnings = self%warnings > 0
    end function has_warnings

    !> Makes one error with the whole report, and the place of the first error, if there are errors.
    subroutine raise(self, error, width)
        class(diagnostics_t), intent(in) :: self
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer, intent(in), optional :: width !! of its lines, in columns
        integer :: i

        if (.not. self%has_errors()) return
        error = input_error(self%report(width))
        do i = 1, size(self%problems)
            associate (problem => self%problems(i))
                if (problem%severity /= 'error' .or. problem%place%source == 0) cycle
                error%source = self%sources(problem%place%source)%name
                error%line = problem%place%line
                if (error%line > 0) error%column = problem%place%column
                exit
            end associate
        end do
    end subroutine raise

    !> The text of all problems, errors and warnings, and a last line with their number. A line with a place
    !> is never broken, because other tools read it.
    function report(self, width) result(text)
        class(diagnostics_t), intent(in) :: self
        integer, intent(in), optional :: width !! of its lines, in columns
        character(:), allocatable :: text
        integer :: i, columns

        columns = default_width
        if (present(width)) columns = width
        text = ''
        if (.not. allocated(self%problems)) return
        do i = 1, size(self%problems)
            text = text // problem_text(self, self%problems(i), columns) // new_line('a') // new_line('a')
        end do
        if (self%errors > 0) text = text // counted(self%errors, 'error')
        if (self%errors > 0 .and. self%warnings > 0) text = text // ', '
        if (self%warnings > 0) text = text // counted(self%warnings, 'warning')
        if (self%errors + self%warnings > size(self%problems)) then
            text = text // ' (the first ' // to_text(size(self%problems)) // ' are shown)'
        end if
    end function report

    !> Inserts a problem in the order of the places.
    subroutine add(self, place, severity, message, hint)
        class(diagnostics_t), intent(inout) :: self
        type(place_t), intent(in) :: place
        character(*), intent(in) :: severity, message
        character(*), intent(in), optional :: hint
        type(problem_t), allocatable :: larger(:)
        integer :: i, known

        if (.not. allocated(self%problems)) allocate (self%problems(0))
        known = size(self%problems)
        if (known == most_shown) return
        allocate (larger(known + 1))
        do i = known, 1, -1
            if (.not. stands_after(self%problems(i)%place, place)) exit
            larger(i + 1) = self%problems(i)
        end do
        larger(:i) = self%problems(:i)
        larger(i + 1)%place = place
        larger(i + 1)%severity = severity
        larger(i + 1)%message = message
        larger(i + 1)%hint = ''
        if (present(hint)) larger(i + 1)%hint = hint
        call move_alloc(larger, self%problems)
    end subroutine add

    pure logical function stands_after(a, b)
        type(place_t), intent(in) :: a, b
        if (a%source /= b%source) then
            stands_after = a%source > b%source
        else if (a%line /= b%line) then
            stands_after = a%line > b%line
        else
            stands_after = a%line > 0 .and. a%column > b%column
        end if
    end function stands_after

    function problem_text(self, problem, width) result(text)
        class(diagnostics_t), intent(in) :: self
        type(problem_t), intent(in) :: problem
        integer, intent(in) :: width
        character(:), allocatable :: text, line, before, marked, number, margin
        character(*), parameter :: indent = '  '
        type(place_t) :: place
        integer :: start

        place = problem%place
        text = problem%severity // ': ' // visible(problem%message)
        if (place%source > 0) then
            associate (source => self%sources(place%source))
                if (place%line > 0) then
                    line = line_of(source%text, place%line)
                    place%column = min(place%column, len(line) + 1)
                    before = visible(line(:place%column - 1))
                    text = escaped(source%name) // ':' // to_text(place%line) // ':' // &
                        to_text(characters(before) + 1) // ': ' // text
                else
                    text = escaped(source%name) // ': ' // text
                end if
            end associate
        end if
        if (.not. allocated(line)) then
            if (problem%hint /= '') text = text // new_line('a') // indent // &
                wrapped(visible(problem%hint), len(indent), width)
            return
        end if

        call cut_to_window(line, place, width - len(to_text(place%line)) - 3)
        before = visible(line(:place%column - 1))
        marked = visible(line(place%column:min(len(line), place%column + place%width - 1)))
        number = to_text(place%line)
        margin = repeat(' ', len(number)) // ' | '
        text = text // new_line('a') // margin(:len(margin) - 1) // new_line('a') // &
            number // ' | ' // visible(line) // new_line('a') // margin // &
            repeat(' ', characters(before)) // repeat('^', max(1, characters(marked)))
        if (problem%hint == '') return
        start = len(margin) + characters(before) + max(1, characters(marked)) + 1
        if (start + characters(visible(problem%hint)) <= width) then
            text = text // ' ' // visible(problem%hint)
        else
            text = text // new_line('a') // indent // wrapped(visible(problem%hint), len(indent), width)
        end if
    end function problem_text

    !> The line with a number, without its line end.
    pure function line_of(text, number) result(line)
        character(*), intent(in) :: text
        integer, intent(in) :: number
        character(:), allocatable :: line
        integer :: i, first, length

        first = 1
        do i = 2, number
            first = first + index(text(first:), new_line('a'))
        end do
        length = index(text(first:), new_line('a')) - 1
        if (length < 0) length = len(text) - first + 1
        line = text(first:first + length - 1)
        if (length > 0) then
            if (line(length:) == achar(13)) line = line(:length - 1)
        end if
    end function line_of

    !> Keeps the part of a very long line around the place.
    pure subroutine cut_to_window(line, place, room)
        character(:), allocatable, intent(inout) :: line
        type(place_t), intent(inout) :: place
        integer, intent(in) :: room !! columns for it
        character(*), parameter :: gap = '...'
        integer :: first, last, widest

        if (len(line) <= min(room, widest_line)) return
        widest = max(min(widest_line, room) - 2 * len(gap), least_window)
        first = max(1, min(place%column - widest / 2, len(line) - widest + 1))
        last = min(len(line), first + widest - 1)
        place%width = min(place%width, last - place%column + 1)
        if (last < len(line)) line = line(:last) // gap
        if (first > 1) then
            line = gap // line(first:)
            place%column = place%column - first + 1 + len(gap)
        end if
    end subroutine cut_to_window

end module spintop_diagnostics
