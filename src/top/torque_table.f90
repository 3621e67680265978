!> A torque that a table gives over time, or friction over the angular velocity: broken lines, or cubics through its rows.
!>
!> Between two rows (knots) the torque is a polynomial of the time since the first of them. Before the first row
!> and after the last one the outermost polynomials continue; inputs are checked to need neither. Two rows of one time are a
!> jump, between two pieces that are interpolated each by itself; at its time the torque is that of the second row.
!>
!> Friction is a torque over the angular velocity about an axis in the place of the time, along that axis, which is the third
!> component. It is odd, and constant beyond the last row.
module spintop_torque_table
    use spintop_kinds, only: dp, is_equal, is_finite
    implicit none
    private
    public :: torque_table_t, make_torque_table, make_friction_table, driving_row
    public :: interpolation_names, fewest_rows, last_of_piece
    public :: by_lines, by_monotone, by_spline, max_degree

    !> Interpolations: broken lines; cubics that are monotone where the rows are; the cubic spline.
    integer, parameter :: by_lines = 1, by_monotone = 2, by_spline = 3
    character(*), parameter :: interpolation_names(by_spline) = [character(8) :: 'linear', 'monotone', 'spline']
    !> Smallest number of rows of each.
    integer, parameter :: fewest_rows(by_spline) = [2, 3, 4]
    !> Highest degree of the polynomials.
    integer, parameter :: max_degree = 3

    !> The torque over time.
    type :: torque_table_t
        !> Times of the rows, s, each once, and whether the torque jumps there.
        real(dp), allocatable :: knots(:)
        logical, allocatable :: is_jump(:)
        !> Coefficients by power of the time since the knot, component, and interval.
        real(dp), allocatable :: coefficient(:, :, :)
        !> One of the interpolations.
        integer :: interpolation = by_lines
    contains
        procedure :: is_valid
        procedure :: at
        procedure :: expansion
        procedure :: interval_towards
        procedure :: next_knot
        procedure :: smooth_until
        procedure :: after_jump
        procedure :: pace
    end type torque_table_t

    !> A step towards a jump ends so many spacings of its time before it, so that all of its stages are there, with rounding;
    !> the next one begins at the jump. A time within `beside` is at it.
    integer, parameter :: before = 8, beside = 16
    !> Beyond the last row friction is constant up to this angular velocity, rad/s: always.
    real(dp), parameter :: endless = huge(1.0_dp) / 4

contains

    !> The table of rows in increasing order of time, two at a jump, as many in each piece as the interpolation needs.
    pure subroutine make_torque_table(t, torque, interpolation, table)
        real(dp), intent(in) :: t(:), torque(:, :) !! times, s; components and rows, N m
        integer, intent(in) :: interpolation !! one of the interpolations
        type(torque_table_t), intent(out) :: table !! the torque over time
        logical :: repeats(size(t))
        integer :: first, last, interval

        repeats = [.false., is_equal(t(2:), t(:size(t) - 1))]
        table%knots = pack(t, .not. repeats)
        table%is_jump = pack(eoshift(repeats, 1), .not. repeats)
        table%interpolation = interpolation
        allocate (table%coefficient(0:max_degree, 3, size(table%knots) - 1), source=0.0_dp)
        first = 1
        interval = 1
        do while (first < size(t))
            last = last_of_piece(t, first)
            call set_piece(t(first:last), torque(:, first:last), interpolation, &
                           table%coefficient(:, :, interval:interval + last - first - 1))
            interval = interval + last - first
            first = last + 1
        end do
    end subroutine make_torque_table

    !> The friction of rows in increasing order of the angular velocity, from zero, without its value there, which is dry: as a
    !> torque against the rotation in either direction.
    pure subroutine make_friction_table(omega, friction, interpolation, table)
        real(dp), intent(in) :: omega(:), friction(:) !! angular velocities, rad/s, and moments against them, N m
        integer, intent(in) :: interpolation !! one of the interpolations
        type(torque_table_t), intent(out) :: table !! the torque over the angular velocity, in its third component
        type(torque_table_t) :: forward
        real(dp) :: coefficient(3, 0:max_degree)
        integer :: i, k, n

        n = size(omega)
        call make_torque_table(omega, along_axis(friction - friction(1)), interpolation, forward)
        table%interpolation = interpolation
        table%knots = [-endless, -omega(n:2:-1), omega, endless]
        allocate (table%is_jump(2 * n + 1), source=.false.)
        allocate (table%coefficient(0:max_degree, 3, 2 * n), source=0.0_dp)
        table%coefficient(0, 3, 1) = friction(n) - friction(1)
        do i = 1, n - 1
            coefficient = forward%expansion(omega(i + 1), i)
            table%coefficient(:, 3, n + 1 - i) = [(coefficient(3, k) * (-1)**k, k=0, max_degree)]
            table%coefficient(:, 3, n + i) = -forward%coefficient(:, 3, i)
        end do
        table%coefficient(0, 3, 2 * n) = friction(1) - friction(n)
    end subroutine make_friction_table

    !> Whether this is a table of finite numbers, with rows in increasing order.
    pure logical function is_valid(self)
        class(torque_table_t), intent(in) :: self
        integer :: n
        is_valid = allocated(self%knots) .and. allocated(self%is_jump) .and. allocated(self%coefficient)
        if (.not. is_valid) return
        n = size(self%knots)
        is_valid = n > 1 .and. size(self%is_jump) == n .and. all(shape(self%coefficient) == [max_degree + 1, 3, n - 1]) &
            .and. all(is_finite(self%knots)) .and. all(is_finite(self%coefficient)) .and. all(self%knots(2:) > self%knots(:n - 1))
    end function is_valid

    !> Numbers as vectors along the third axis.
    pure function along_axis(values) result(vectors)
        real(dp), intent(in) :: values(:)
        real(dp) :: vectors(3, size(values))
        vectors = 0
        vectors(3, :) = values
    end function along_axis

    !> The row from which on friction is negative, up to the next row, so that it would drive the body; 0 if it nowhere is.
    pure integer function driving_row(omega, friction, interpolation) result(row)
        real(dp), intent(in) :: omega(:), friction(:) !! of the rows, rad/s and N m, as of `make_friction_table`
        integer, intent(in) :: interpolation !! one of the interpolations
        type(torque_table_t) :: table
        real(dp) :: least
        call make_torque_table(omega, along_axis(friction), interpolation, table)
        least = -beside * spacing(maxval(abs(friction)))
        do row = 1, size(omega) - 1
            if (least_value(table%coefficient(:, 3, row), omega(row + 1) - omega(row)) < least) return
        end do
        row = 0
    end function driving_row

    !> The least value of a cubic from 0 to h.
    pure real(dp) function least_value(c, h) result(least)
        real(dp), intent(in) :: c(0:max_degree), h
        real(dp) :: places(4), radicand, root
        places = [0.0_dp, h, 0.0_dp, 0.0_dp]
        radicand = c(2)**2 - 3 * c(1) * c(3)
        if (radicand > 0) then
            root = -(c(2) + sign(sqrt(radicand), c(2)))
            if (abs(root) < 3 * abs(c(3)) * h) places(3) = root / (3 * c(3))
            if (abs(c(1)) < abs(root) * h) places(4) = c(1) / root
        end if
        places = min(max(places, 0.0_dp), h)
        least = minval(c(0) + places * (c(1) + places * (c(2) + places * c(3))))
    end function least_value

    !> The last row before the jump that follows a row, or the last of all.
    pure integer function last_of_piece(t, first) result(last)
        real(dp), intent(in) :: t(:) !! times of the rows, s
        integer, intent(in) :: first !! the row
        do last = first, size(t) - 1
            if (is_equal(t(last), t(last + 1))) return
        end do
        last = size(t)
    end function last_of_piece

    !> The polynomials between rows without a jump.
    pure subroutine set_piece(t, torque, interpolation, coefficient)
        real(dp), intent(in) :: t(:), torque(:, :)
        integer, intent(in) :: interpolation
        real(dp), intent(inout) :: coefficient(0:, :, :)
        real(dp) :: slope(size(t)), chord(size(t) - 1), h(size(t) - 1)
        integer :: axis, n

        n = size(t)
        h = t(2:) - t(:n - 1)
        do axis = 1, 3
            chord = (torque(axis, 2:) - torque(axis, :n - 1)) / h
            coefficient(0, axis, :) = torque(axis, :n - 1)
            coefficient(1, axis, :) = chord
            if (interpolation == by_lines) cycle
            if (interpolation == by_monotone) then
                slope = monotone_slopes(h, chord)
            else
                slope = spline_slopes(h, chord)
            end if
            coefficient(1, axis, :) = slope(:n - 1)
            coefficient(2, axis, :) = (3 * chord - 2 * slope(:n - 1) - slope(2:)) / h
            coefficient(3, axis, :) = (slope(:n - 1) + slope(2:) - 2 * chord) / h**2
        end do
    end subroutine set_piece

    !> Slopes of Fritsch and Butland (A method for constructing local monotone piecewise cubic interpolants, SIAM J.
    !> Sci. Stat. Comput. 5, 1984): weighted harmonic means of the neighbouring chords; at the ends a three-point
    !> formula, limited so that the cubic stays monotone.
    pure function monotone_slopes(h, chord) result(slope)
        real(dp), intent(in) :: h(:), chord(:)
        real(dp) :: slope(size(h) + 1), weight
        integer :: i, n
        n = size(h) + 1
        slope = 0
        do i = 2, n - 1
            if (.not. chord(i - 1) * chord(i) > 0) cycle
            weight = (h(i - 1) + 2 * h(i)) / (3 * (h(i - 1) + h(i)))
            slope(i) = chord(i - 1) * chord(i) / (weight * chord(i) + (1 - weight) * chord(i - 1))
        end do
        slope(1) = limited_end(h(1), h(2), chord(1), chord(2))
        slope(n) = limited_end(h(n - 1), h(n - 2), chord(n - 1), chord(n - 2))
    end function monotone_slopes

    !> Slope at an end: that of the parabola through three rows, as far as the cubic stays monotone.
    pure real(dp) function limited_end(h, h_next, chord, chord_next) result(slope)
        real(dp), intent(in) :: h, h_next, chord, chord_next
        slope = ((2 * h + h_next) * chord - h * chord_next) / (h + h_next)
        if (.not. slope * chord > 0) then
            slope = 0
        else if (chord * chord_next <= 0 .and. abs(slope) > 3 * abs(chord)) then
            slope = 3 * chord
        end if
    end function limited_end

    !> Slopes of the cubic spline that is one cubic in the first two and in the last two intervals (not-a-knot), by
    !> elimination in the tridiagonal equations (de Boor, A Practical Guide to Splines, 1978, chapter IV).
    pure function spline_slopes(h, chord) result(slope)
        real(dp), intent(in) :: h(:), chord(:)
        real(dp) :: slope(size(h) + 1), diagonal(size(h) + 1), above(size(h) + 1), below, ratio
        integer :: i, n
        n = size(h) + 1
        diagonal(1) = h(2)
        above(1) = h(1) + h(2)
        slope(1) = ((h(1) + 2 * above(1)) * chord(1) * h(2) + h(1)**2 * chord(2)) / above(1)
        do i = 2, n - 1
            ratio = -h(i) / diagonal(i - 1)
            slope(i) = ratio * slope(i - 1) + 3 * (h(i - 1) * chord(i) + h(i) * chord(i - 1))
            diagonal(i) = ratio * above(i - 1) + 2 * (h(i - 1) + h(i))
            above(i) = h(i - 1)
        end do
        below = h(n - 2) + h(n - 1)
        ratio = -below / diagonal(n - 1)
        slope(n) = (h(n - 1)**2 * chord(n - 2) + (2 * below + h(n - 1)) * h(n - 2) * chord(n - 1)) / below
        diagonal(n) = ratio * above(n - 1) + h(n - 2)
        slope(n) = (ratio * slope(n - 1) + slope(n)) / diagonal(n)
        do i = n - 1, 1, -1
            slope(i) = (slope(i) - above(i) * slope(i + 1)) / diagonal(i)
        end do
    end function spline_slopes

    !> The torque at a time, N m.
    pure function at(self, t) result(torque)
        class(torque_table_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: torque(3), h
        integer :: i
        i = interval_at(self%knots, t)
        h = t - self%knots(i)
        associate (c => self%coefficient)
            torque = c(0, :, i) + h * (c(1, :, i) + h * (c(2, :, i) + h * c(3, :, i)))
        end associate
    end function at

    !> Its Taylor coefficients about a time, of the polynomial that follows it, or of another one.
    pure function expansion(self, t, interval) result(coefficient)
        class(torque_table_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        integer, intent(in), optional :: interval !! the number of the knot at which the polynomial begins
        real(dp) :: coefficient(3, 0:max_degree), h
        integer :: i
        if (present(interval)) then
            i = interval
        else
            i = interval_at(self%knots, t)
        end if
        h = t - self%knots(i)
        associate (c => self%coefficient)
            coefficient(:, 0) = c(0, :, i) + h * (c(1, :, i) + h * (c(2, :, i) + h * c(3, :, i)))
            coefficient(:, 1) = c(1, :, i) + h * (2 * c(2, :, i) + h * 3 * c(3, :, i))
            coefficient(:, 2) = c(2, :, i) + h * 3 * c(3, :, i)
            coefficient(:, 3) = c(3, :, i)
        end associate
    end function expansion

    !> The interval of an angular velocity with a rate: at a knot, or within rounding of it, that into which it moves.
    pure integer function interval_towards(self, omega, rate, slack) result(interval)
        class(torque_table_t), intent(in) :: self
        real(dp), intent(in) :: omega, rate !! angular velocity, rad/s, and its rate, rad/s^2
        real(dp), intent(in) :: slack !! what is rounding of it, rad/s
        interval = interval_at(self%knots, omega + sign(slack, rate))
    end function interval_towards

    !> The first knot after a time, s; `huge` if there is none.
    pure real(dp) function next_knot(self, t)
        class(torque_table_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        integer :: next
        next = place_after(self%knots, t)
        next_knot = huge(t)
        if (next <= size(self%knots)) next_knot = self%knots(next)
    end function next_knot

    !> The time up to which a step from `t` may reach, s: to the next knot, just before it if the torque jumps there; `huge` if
    !> there is none. From just before a jump it is the knot after that.
    pure real(dp) function smooth_until(self, t)
        class(torque_table_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        integer :: next
        next = place_after(self%knots, max(t, self%after_jump(t)))
        smooth_until = huge(t)
        if (next > size(self%knots)) return
        smooth_until = self%knots(next)
        if (self%is_jump(next)) smooth_until = smooth_until - before * spacing(smooth_until)
    end function smooth_until

    !> The time of a jump just after `t`, where a step to it ends, s; otherwise `t`.
    pure real(dp) function after_jump(self, t)
        class(torque_table_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        integer :: next
        after_jump = t
        next = place_after(self%knots, t)
        if (next > size(self%knots)) return
        associate (knot => self%knots(next))
            if (self%is_jump(next) .and. knot - t <= beside * spacing(knot)) after_jump = knot
        end associate
    end function after_jump

    !> A time in which the torque between two knots changes little, s; of broken lines the ends are enough.
    pure real(dp) function pace(self, t)
        class(torque_table_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        integer, parameter :: parts = 16
        integer :: i
        pace = huge(t)
        if (self%interpolation == by_lines) return
        i = interval_at(self%knots, t)
        pace = (self%knots(i + 1) - self%knots(i)) / parts
    end function pace

    !> The place of the first knot after a time, one beyond the last if there is none.
    pure integer function place_after(knots, t) result(next)
        real(dp), intent(in) :: knots(:), t
        next = interval_at(knots, t)
        if (.not. knots(next) > t) next = next + 1
        if (.not. knots(next) > t) next = next + 1
    end function place_after

    !> The interval that a time is in, or begins, by bisection.
    pure integer function interval_at(knots, t) result(first)
        real(dp), intent(in) :: knots(:), t
        integer :: last, middle
        first = 1
        last = size(knots)
        do while (last - first > 1)
            middle = (first + last) / 2
            if (knots(middle) <= t) then
                first = middle
            else
                last = middle
            end if
        end do
    end function interval_at

end module spintop_torque_table
