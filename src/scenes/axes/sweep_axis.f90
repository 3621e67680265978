!> An axis of a sweep: the values of one parameter, which may follow a distribution.
module spintop_sweep_axis
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, degree, pi
    use spintop_lapack, only: dpotrf
    use spintop_probability, only: normal_quantile
    use spintop_number_slot, only: number_slot_t
    use spintop_text, only: counted, to_text
    implicit none
    private
    public :: axis_t, law_names, law_uniform, law_normal, law_lognormal, law_sphere, sphere_attitude
    public :: sphere_direction, sphere_inclination, sphere_turn, normal_value, attitude_at, direction_at
    public :: inclination_at, turn_at, factor_covariance

    !> Laws of the values of an axis, by their places in `law_names`.
    integer, parameter :: law_uniform = 1, law_normal = 2, law_lognormal = 3, law_sphere = 4
    !> The words for these in an input (sweep.distribution).
    character(*), parameter :: law_names(4) = [character(9) :: 'uniform', 'normal', 'lognormal', 'sphere']

    !> What is uniform on a sphere: an attitude (four components of a quaternion), a vector (three), the angle between
    !> the vertical and a direction, an angle about the vertical.
    integer, parameter :: sphere_attitude = 1, sphere_direction = 2, sphere_inclination = 3, sphere_turn = 4

    !> The values of one parameter: a list, an interval, or a distribution.
    type :: axis_t
        !> Its name, which may end in a unit, as `initial.omega3_rpm`; the key, as `initial.omega3`; the unit of the values.
        character(:), allocatable :: name, key, unit
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
        character(*), parameter :: on_sphere(4) = [character(51) :: 'of a random attitude', &
            'of a vector of random direction and magnitude', 'inclination of a random direction', 'any angle of a full turn']

        if (allocated(self%listed)) then
            text = counted(size(self%listed), 'listed value')
        else if (self%law == law_sphere) then
            text = trim(on_sphere(self%sphere))
            if (self%sphere == sphere_direction) text = text // ' ' // to_text(self%mean)
        else if (self%law == law_normal) then
            text = 'normal, mean ' // to_text(self%mean) // ', deviation ' // to_text(self%deviation)
        else if (self%law == law_lognormal) then
            text = 'log-normal, mean ' // to_text(self%mean) // ' and deviation ' // to_text(self%deviation) // &
                   ' of its logarithm'
        else
            text = 'any value'
            if (self%whole) text = 'whole numbers'
            if (self%count > 0) text = counted(self%count, 'value')
            text = text // ' from ' // to_text(self%from) // ' to ' // to_text(self%to)
            if (self%logarithmic) text = text // ', logarithmic spacing'
        end if
        text = self%name // ': ' // text
    end function axis_in_words

    !> The standard normal value at a fraction; a fraction that was rounded to 0 or 1 counts as the nearest inside.
    elemental real(dp) function normal_value(fraction)
        real(dp), intent(in) :: fraction !! in [0, 1]
        real(dp), parameter :: least = 0.25_dp * epsilon(1.0_dp)
        normal_value = normal_quantile(min(max(fraction, least), 1 - 2 * least))
    end function normal_value

    !> An attitude: unit quaternions that are uniform on the group of rotations for uniform fractions (K. Shoemake,
    !> "Uniform random rotations", Graphics Gems III, 1992).
    pure function attitude_at(fractions) result(quaternion)
        real(dp), intent(in) :: fractions(3) !! a point of the unit cube
        real(dp) :: quaternion(4)
        associate (one => 2 * pi * fractions(2), two => 2 * pi * fractions(3))
            quaternion = [sqrt(1 - fractions(1)) * [sin(one), cos(one)], sqrt(fractions(1)) * [sin(two), cos(two)]]
        end associate
    end function attitude_at

    !> A unit vector, uniform on the sphere for uniform fractions.
    pure function direction_at(fractions) result(direction)
        real(dp), intent(in) :: fractions(2) !! a point of the unit square
        real(dp) :: direction(3)
        associate (radius => 2 * sqrt(fractions(1) * (1 - fractions(1))), turn => 2 * pi * fractions(2))
            direction = [radius * cos(turn), radius * sin(turn), 1 - 2 * fractions(1)]
        end associate
    end function direction_at

    !> The angle from the vertical of such a direction, in radians or degrees.
    elemental real(dp) function inclination_at(fraction, in_degrees)
        real(dp), intent(in) :: fraction !! in [0, 1]
        logical, intent(in) :: in_degrees !! whether the angle is in degrees
        inclination_at = 2 * asin(min(1.0_dp, sqrt(fraction)))
        if (in_degrees) inclination_at = min(inclination_at / degree, 180.0_dp)
    end function inclination_at

    !> A full turn, in radians or degrees.
    elemental real(dp) function turn_at(fraction, in_degrees)
        real(dp), intent(in) :: fraction !! in [0, 1]
        logical, intent(in) :: in_degrees !! whether the angle is in degrees
        turn_at = merge(360.0_dp, 2 * pi, in_degrees) * fraction
    end function turn_at

    !> The lower triangular factor L of a covariance matrix, L L^T, by the factor of its matrix of correlations, which
    !> does not depend on the units of the variables; `positive` is false if the matrix is not positive definite.
    subroutine factor_covariance(covariance, factor, positive)
        real(dp), intent(in) :: covariance(:, :) !! a symmetric matrix
        real(dp), intent(out) :: factor(:, :) !! the factor; 0 above the diagonal
        logical, intent(out) :: positive !! whether there is one
        real(dp) :: deviation(size(covariance, 1))
        integer :: i, j, n, info

        n = size(covariance, 1)
        factor = 0
        positive = all([(covariance(i, i) > 0, i=1, n)])
        if (.not. positive) return
        deviation = [(sqrt(covariance(i, i)), i=1, n)]
        do j = 1, n
            factor(j, j) = 1
            do i = j + 1, n
                factor(i, j) = covariance(i, j) / deviation(i) / deviation(j)
            end do
        end do
        call dpotrf('L', n, factor, n, info)
        positive = info == 0
        do j = 1, n
            factor(j:, j) = deviation(j:) * factor(j:, j)
        end do
    end subroutine factor_covariance

end module spintop_sweep_axis
