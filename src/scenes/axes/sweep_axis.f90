!> An axis of a sweep: the values of one parameter.
module spintop_sweep_axis
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_distributions, only: attitude_at, direction_at, inclination_at, law_lognormal, law_normal, law_uniform, &
        sphere_attitude, sphere_direction, sphere_inclination, sphere_turn, turn_at
    use spintop_kinds, only: dp
    use spintop_number_slot, only: number_slot_t
    use spintop_text, only: counted, to_text
    implicit none
    private
    public :: axis_t

    !> The values of one parameter: a list, an interval, or a distribution.
    type :: axis_t
        character(:), allocatable :: name
        !> Where its value stands in the scene that describes the axes.
        type(number_slot_t) :: slot
        !> Number of values; 0 for an interval of random values.
        integer :: count = 0
        real(dp), allocatable :: listed(:)
        real(dp) :: from = 0, to = 0
        !> Whether the spacing is logarithmic.
        logical :: logarithmic = .false.
        !> The parameter is an integer.
        logical :: whole = .false.
        !> Distribution of random values; without a list and besides the uniform one these have parameters: mean and
        !> standard deviation of the value or of its logarithm, or what lies on a sphere, and its magnitude.
        integer :: law = law_uniform, sphere = 0
        real(dp) :: mean = 0, deviation = 0
        !> The values of a vector are drawn together: which component this one is, from 1, and of how many.
        integer :: component = 1, components = 1
    contains
        procedure :: value
        procedure :: unrounded
        procedure :: list_values
        procedure :: draw
        procedure :: draw_on_sphere
        procedure :: dimensions
        procedure :: is_discrete
        procedure :: in_words => axis_in_words
    end type axis_t

contains

    !> Value number k.
    elemental real(dp) function value(self, k)
        class(axis_t), intent(in) :: self
        integer, intent(in) :: k !! number of the value, from 1
        value = self%unrounded(k)
        if (self%whole) value = anint(value)
    end function value

    !> Value number k of the list or of the spacing, before rounding to an integer.
    elemental real(dp) function unrounded(self, k) result(value)
        class(axis_t), intent(in) :: self
        integer, intent(in) :: k !! number of the value, from 1
        if (allocated(self%listed)) then
            value = self%listed(k)
        else if (k == self%count .and. k > 1) then
            value = self%to
        else
            value = between(self%from, self%to, self%logarithmic, real(k - 1, dp) / max(1, self%count - 1))
        end if
    end function unrounded

    !> Consecutive values, from a number on.
    pure subroutine list_values(self, first, values)
        class(axis_t), intent(in) :: self
        integer, intent(in) :: first !! number of the first of them, from 1
        real(dp), intent(out) :: values(:) !! as many values from that number on, in the unit of the parameter
        integer :: k
        do k = 1, size(values)
            values(k) = self%value(first + k - 1)
        end do
    end subroutine list_values

    !> The quantile of a fraction in (0, 1): uniform over the interval (or over its logarithm). All values of
    !> a list have the same probability. For an integer parameter the quantile is that of a uniform
    !> distribution from the smallest integer to the one after the largest, rounded down: all integers have
    !> the same probability (with logarithmic spacing k has a probability proportional to log(1 + 1/k)).
    elemental real(dp) function draw(self, fraction)
        class(axis_t), intent(in) :: self
        real(dp), intent(in) :: fraction !! probability of a smaller value, in (0, 1)
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

    !> What is uniform on a sphere: the value of the axis, or those of all components of a vector.
    pure subroutine draw_on_sphere(self, fractions, values)
        class(axis_t), intent(in) :: self
        real(dp), intent(in) :: fractions(:) !! a point of the unit cube
        real(dp), intent(out) :: values(:) !! as many as the vector has components
        logical :: in_degrees
        in_degrees = index(self%name, '_deg') > 0
        select case (self%sphere)
        case (sphere_attitude)
            values = attitude_at(fractions)
        case (sphere_direction)
            values = self%mean * direction_at(fractions)
        case (sphere_inclination)
            values = inclination_at(fractions, in_degrees)
        case (sphere_turn)
            values = turn_at(fractions, in_degrees)
        end select
    end subroutine draw_on_sphere

    !> The number at a fraction of the interval between two numbers (or between their logarithms).
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

    !> Coordinates of a point that its value takes; those of a vector belong to its first component.
    elemental integer function dimensions(self)
        class(axis_t), intent(in) :: self
        dimensions = merge(1, 0, self%component == 1)
        if (self%component == 1 .and. self%components > 1) dimensions = self%components - 1
    end function dimensions

    !> What the axis is, for a reader.
    function axis_in_words(self) result(text)
        class(axis_t), intent(in) :: self
        character(:), allocatable :: text
        text = self%name // ': '
        if (allocated(self%listed)) then
            text = text // counted(size(self%listed), 'listed value')
            return
        end if
        if (self%law /= law_uniform) then
            text = text // law_in_words(self)
            return
        end if
        if (self%count > 0) then
            text = text // counted(self%count, 'value')
        else if (self%whole) then
            text = text // 'whole numbers'
        else
            text = text // 'any value'
        end if
        text = text // ' from ' // to_text(self%from) // ' to ' // to_text(self%to)
        if (self%logarithmic) text = text // ', logarithmic spacing'
    end function axis_in_words

    !> A distribution that is not uniform over an interval.
    function law_in_words(axis) result(text)
        type(axis_t), intent(in) :: axis
        character(:), allocatable :: text
        select case (axis%law)
        case (law_normal)
            text = 'normal, mean ' // to_text(axis%mean) // ', deviation ' // to_text(axis%deviation)
        case (law_lognormal)
            text = 'log-normal, mean ' // to_text(axis%mean) // ' and deviation ' // to_text(axis%deviation) &
                   // ' of its logarithm'
        case default
            select case (axis%sphere)
            case (sphere_attitude)
                text = 'of a random attitude'
            case (sphere_direction)
                text = 'of a vector of random direction and magnitude ' // to_text(axis%mean)
            case (sphere_inclination)
                text = 'inclination of a random direction'
            case default
                text = 'any angle of a full turn'
            end select
        end select
    end function law_in_words

end module spintop_sweep_axis
