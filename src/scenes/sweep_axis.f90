!> One axis of a sweep: a parameter, and the values that it takes.
module spintop_sweep_axis
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_text, only: to_text
    implicit none
    private
    public :: axis_t

    !> The values of one parameter: listed, or those of an interval.
    type :: axis_t
        character(:), allocatable :: name
        !> Number of values; 0 for an interval from which values are drawn.
        integer :: count = 0
        real(dp), allocatable :: listed(:)
        real(dp) :: from = 0, to = 0
        !> Equal ratios in place of equal differences.
        logical :: logarithmic = .false.
        !> The parameter is an integer.
        logical :: whole = .false.
    contains
        procedure :: value
        procedure :: unrounded
        procedure :: draw
        procedure :: is_discrete
        procedure :: in_words
    end type axis_t

contains

    !> Value number k.
    elemental real(dp) function value(self, k)
        class(axis_t), intent(in) :: self
        integer, intent(in) :: k
        value = self%unrounded(k)
        if (self%whole) value = anint(value)
    end function value

    !> Value number k as list or spacing have it, which rounding may keep from being whole.
    elemental real(dp) function unrounded(self, k) result(value)
        class(axis_t), intent(in) :: self
        integer, intent(in) :: k
        if (allocated(self%listed)) then
            value = self%listed(k)
        else if (k == self%count .and. k > 1) then
            value = self%to
        else
            value = between(self%from, self%to, self%logarithmic, real(k - 1, dp) / max(1, self%count - 1))
        end if
    end function unrounded

    !> The value below which a fraction in (0, 1) of all draws lie: uniform over the interval (over its
    !> logarithm). Of a list each value is as likely. Of an integer parameter the draw is uniform from
    !> the least whole number to the one after the largest, and rounded down: each is as likely (k as
    !> log(1 + 1/k)).
    elemental real(dp) function draw(self, fraction)
        class(axis_t), intent(in) :: self
        real(dp), intent(in) :: fraction
        real(dp) :: least, largest
        if (allocated(self%listed)) then
            draw = self%listed(min(size(self%listed), 1 + int(fraction * size(self%listed))))
            return
        end if
        least = min(self%from, self%to)
        largest = max(self%from, self%to)
        if (self%whole) then
            draw = real(floor(between(least, largest + 1, self%logarithmic, fraction), int64), dp)
        else
            draw = between(self%from, self%to, self%logarithmic, fraction)
        end if
        draw = min(max(draw, least), largest)
    end function draw

    !> The number at a fraction of the way from one to another (of the ratio).
    elemental real(dp) function between(from, to, logarithmic, fraction)
        real(dp), intent(in) :: from, to, fraction
        logical, intent(in) :: logarithmic
        if (logarithmic) then
            between = from * (to / from)**fraction
        else
            between = from + (to - from) * fraction
        end if
    end function between

    !> Whether the axis has a number of values, and not an interval.
    elemental logical function is_discrete(self)
        class(axis_t), intent(in) :: self
        is_discrete = allocated(self%listed) .or. self%whole
    end function is_discrete

    !> What the axis is, for a reader.
    function in_words(self) result(text)
        class(axis_t), intent(in) :: self
        character(:), allocatable :: text
        text = self%name // ': '
        if (allocated(self%listed)) then
            text = text // plural(size(self%listed), 'listed value')
            return
        end if
        if (self%count > 0) then
            text = text // plural(self%count, 'value')
        else if (self%whole) then
            text = text // 'whole numbers'
        else
            text = text // 'any value'
        end if
        text = text // ' from ' // to_text(self%from) // ' to ' // to_text(self%to)
        if (self%logarithmic) text = text // ', spaced by their logarithm'
    end function in_words

    pure function plural(number, noun) result(text)
        integer, intent(in) :: number
        character(*), intent(in) :: noun
        character(:), allocatable :: text
        text = to_text(number) // ' ' // noun
        if (number /= 1) text = text // 's'
    end function plural

end module spintop_sweep_axis
