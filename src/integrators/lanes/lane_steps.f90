!> The steps of many bodies in lanes, from the Taylor coefficients of their motions: how long they are, and where they end.
!> Each lane for itself, by lane_steps.h.
module spintop_lane_steps
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_lane_series, only: lanes, rows
    use spintop_motions, only: instants
    use spintop_stepper, only: controls_t, smallest_spacings
    use spintop_taylor, only: largest_growth, safety, stretch
    implicit none
    private
    public :: choose_durations, end_before_reversals, add_steps, states_at, step_underflow, non_finite

    !> Reasons for which a lane takes no step: its size underflows or no more steps are allowed; a number is
    !> not finite.
    integer(int64), parameter :: step_underflow = 1, non_finite = 2
    !> No reason. As wide as the numbers beside which they are found, so that both are in one vector.
    integer(int64), parameter :: no_reason = 0

    !> A step is halved so often before a drag reverses, at the most; and once more.
    integer, parameter :: most_halvings = 30

    interface
        pure subroutine c_choose(order, absolute, relative, growth, safety, stretch, c, scale, t, t_end, h, duration, size) &
            bind(C, name='spintop_choose_durations')
            import :: c_double, c_int
            integer(c_int), value :: order
            real(c_double), value :: absolute, relative, growth, safety, stretch
            real(c_double), dimension(*), intent(in) :: c, scale, t, t_end
            real(c_double), dimension(*), intent(inout) :: h, duration, size
        end subroutine c_choose

        !> The states at times after the beginning of the step.
        pure subroutine states_at(order, c, t, states) bind(C, name='spintop_states_at')
            import :: c_double, c_int
            integer(c_int), value :: order !! order of the series
            real(c_double), intent(in) :: c(*), t(*) !! Taylor coefficients (lane, row, term); times, s
            real(c_double), intent(inout) :: states(*) !! states then (lane, part)
        end subroutine states_at

        !> The angular velocities then.
        pure subroutine rates_at(order, c, t, rates) bind(C, name='spintop_rates_at')
            import :: c_double, c_int
            integer(c_int), value :: order
            real(c_double), intent(in) :: c(*), t(*)
            real(c_double), intent(inout) :: rates(*)
        end subroutine rates_at

        !> Adds to the states their change over the steps. Lanes whose step has no length stay as they are.
        pure subroutine add_steps(order, c, duration, t_end, t_last, t, state, rest) bind(C, name='spintop_add_steps')
            import :: c_double, c_int
            integer(c_int), value :: order !! order of the series
            real(c_double), dimension(*), intent(in) :: c, duration, t_end !! coefficients; lengths of steps, ends of spans, s
            real(c_double), dimension(*), intent(inout) :: t_last, t, state, rest
                !! time before the step, and time reached, s; states and their compensation terms
        end subroutine add_steps
    end interface

contains

    !> Durations of the steps, s: until one of the last two terms of the series reaches the tolerance, relative
    !> to the magnitude of omega, to the unit vector and to a radian. The absolute tolerance is a fraction of the
    !> largest angular velocity, `scale`, and in radians. `trouble` is zero for lanes that can step.
    pure subroutine choose_durations(order, controls, c, scale, t, t_end, steps, h, duration, trouble, worst)
        integer, intent(in) :: order !! order of the series
        type(controls_t), intent(in) :: controls !! tolerances and maximum number of steps
        real(dp), intent(in) :: c(lanes, rows, 0:order), scale(lanes), t(lanes), t_end(lanes)
            !! Taylor coefficients; largest angular velocity, rad/s; time and end of the span, s
        integer(int64), intent(in) :: steps(lanes) !! number of steps so far
        real(dp), intent(inout) :: h(lanes), duration(lanes)
            !! step sizes of the last step, replaced by those of this one, s; durations of the steps, s
        integer(int64), intent(out) :: trouble(lanes), worst
            !! `step_underflow`, `non_finite` or 0, and the largest of these
        real(dp) :: size(lanes)
        integer(int64) :: max_steps
        integer :: i

        max_steps = controls%max_steps
        call c_choose(order, controls%absolute_tolerance, controls%relative_tolerance, largest_growth, safety, stretch, c, scale, &
                      t, t_end, h, duration, size)
        !$omp simd
        do i = 1, lanes
            trouble(i) = merge(no_reason, step_underflow, h(i) > smallest_spacings * epsilon(t) * t(i))
            trouble(i) = merge(trouble(i), step_underflow, steps(i) < max_steps)
            trouble(i) = merge(trouble(i), non_finite, size(i) <= huge(t))
        end do
        worst = maxval(trouble)
    end subroutine choose_durations

    !> Ends the coming steps before a drag reverses, as its series would go on with the drag of the old direction: where the
    !> angular velocity turns by more than a right angle in half of the step there is none; where the velocity of a dragged centre
    !> of mass does in an eighth of it, the step is halved. A motion that passes such a point at a distance goes on by short steps.
    pure subroutine end_before_reversals(order, c, has_cusps, r, duration, reverses)
        integer, intent(in) :: order !! order of the series
        real(dp), intent(in) :: c(lanes, rows, 0:order) !! their coefficients: lane, variable, order
        logical, intent(in) :: has_cusps(lanes) !! lanes with a drag that turns with the angular velocity at once
        real(dp), intent(in) :: r(lanes, 3) !! centre of mass that is dragged, m; 0 if none is
        real(dp), intent(inout) :: duration(lanes) !! coming step, s
        logical, intent(out) :: reverses(lanes) !! lanes in which no step is short enough
        real(dp), dimension(lanes, 3) :: middle, last
        logical :: turns(lanes), is_halved(lanes)
        integer :: i

        call rates_at(order, c, duration / 2, middle)
        call rates_at(order, c, duration, last)
        reverses = has_cusps .and. (product_of(middle, c(:, 1:3, 0)) < 0 .or. product_of(middle, last) < 0)
        if (.not. any(abs(r) > 0)) return
        is_halved = .false.
        do i = 0, most_halvings
            call find_turns(order, c, duration, r, turns)
            if (.not. any(turns)) exit
            is_halved = is_halved .or. turns
            where (turns) duration = duration / 2
        end do
        where (is_halved) duration = duration / 2
        reverses = reverses .or. turns
    end subroutine end_before_reversals

    !> Whether the velocity of a dragged centre of mass turns so much.
    pure subroutine find_turns(order, c, duration, r, turns)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order), duration(lanes), r(lanes, 3)
        logical, intent(out) :: turns(lanes)
        !> Square of the sine of an angle between angular velocity and centre of mass that is lost in rounding.
        real(dp), parameter :: lost = 1.0e-26_dp
        real(dp) :: w(lanes, 3), v(lanes, 3), before(lanes, 3), least(lanes)
        integer :: k
        w = c(:, 1:3, 0)
        before = cross_of(w, r)
        least = -lost * product_of(w, w) * product_of(r, r)
        turns = .false.
        do k = 1, instants
            call rates_at(order, c, duration * k / instants, w)
            v = cross_of(w, r)
            turns = turns .or. product_of(v, before) < least
            before = v
        end do
    end subroutine find_turns

    !> Scalar products of vectors in each lane.
    pure function product_of(a, b) result(product)
        real(dp), intent(in) :: a(lanes, 3), b(lanes, 3)
        real(dp) :: product(lanes)
        product = a(:, 1) * b(:, 1) + a(:, 2) * b(:, 2) + a(:, 3) * b(:, 3)
    end function product_of

    !> Vector products of these.
    pure function cross_of(a, b) result(product)
        real(dp), intent(in) :: a(lanes, 3), b(lanes, 3)
        real(dp) :: product(lanes, 3)
        product(:, 1) = a(:, 2) * b(:, 3) - a(:, 3) * b(:, 2)
        product(:, 2) = a(:, 3) * b(:, 1) - a(:, 1) * b(:, 3)
        product(:, 3) = a(:, 1) * b(:, 2) - a(:, 2) * b(:, 1)
    end function cross_of

end module spintop_lane_steps
