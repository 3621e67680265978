!> Where a step ends at which the equations are not analytic: before a vector vanishes of which effects have the direction or the
!> magnitude, the angular velocity under friction and drag, the velocity of a dragged centre of mass, the support force; and just
!> beyond the row of a table of friction that the angular velocity passes first.
!>
!> A series, in which a direction is constant or a magnitude has its sign, goes on beyond a zero; such a step ends before. It has
!> the polynomial between two rows, and goes on with it beyond them, so that its state there is right; a step of another method
!> that leads across a row is wrong as a whole, and is taken again.
module spintop_step_ends
    use spintop_effects_action, only: direction_force, direction_omega, directions, reach_t, row_interval_t
    use spintop_formulation, only: max_states
    use spintop_kinds, only: dp
    use spintop_motions, only: instants
    use spintop_status, only: is_ok, status_step_too_small
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: check_direction, end_step_at, may_reverse, end_before_reversal, end_at_row

    !> A time at which a vector reverses, or a row is passed, is found up to so many spacings of the time.
    real(dp), parameter :: spacings = 4
    !> A vector that is not below this share of what it was at the beginning of the step passes zero at a distance. There the
    !> series has a small radius of convergence; a step to this part of the way is well within.
    real(dp), parameter :: vanishing = 1.0e-12_dp, part_of_way = 0.5_dp
    !> The cosine of the largest angle by which the support force turns in a step: where it passes zero at a distance it turns
    !> by half a turn, and the terms of a step that leads across do not tell.
    real(dp), parameter :: turned = 0.5_dp
    !> A vector that changes by less than this share of its magnitude is far from a reversal.
    real(dp), parameter :: share = 0.5_dp

    !> A row within this share of a step is passed at its beginning: the step is as good as behind it.
    real(dp), parameter :: shortest = 1.0e-6_dp

contains

    !> Ends a step by series earlier, at a time and in a state within it.
    subroutine end_step_at(stepper, t, y, status)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        logical :: changed
        stepper%t = t
        stepper%y = y
        stepper%rest = 0
        call stepper%projection%apply(stepper%formulation, stepper%y, changed)
        call stepper%begin(status)
    end subroutine end_step_at

    !> Whether the angular velocity, and the velocity on which drag depends, are far from any reversal in a step by series:
    !> they change by less than `share` of their magnitude, as all terms of its series together are less. Then the step is also
    !> shorter than half of the time to rest.
    subroutine check_direction(stepper, is_kept, speed)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        logical, intent(out) :: is_kept !! whether they are
        real(dp), intent(out) :: speed(2) !! magnitude of the angular velocity at the ends of the step, if they are, rad/s
        real(dp) :: span, change(max_states)
        type(reach_t) :: first, last

        speed = 0
        change = stepper%bound_of_changes()
        is_kept = .false.
        if (stepper%formulation%action%has_load .or. .not. all(change < huge(change))) return
        span = stepper%t - stepper%t_last
        first = stepper%formulation%action%reach_of(stepper%t_last, stepper%y_last, span, change)
        is_kept = first%change < share * min(first%speed, first%dragged)
        if (.not. is_kept .and. first%change < share * first%speed) is_kept = .not. turns_back()
        if (.not. is_kept) return
        last = stepper%formulation%action%reach_of(stepper%t, stepper%y, 0.0_dp, change)
        speed = [first%speed, last%speed]

    contains

        !> Whether the velocity on which drag depends reverses.
        logical function turns_back()
            real(dp) :: t(0:instants), y(0:instants, max_states)
            integer :: i
            t = stepper%t_last + span * [(real(i, dp) / instants, i=0, instants)]
            y(0, :) = stepper%y_last
            call stepper%states_within(t(1:), y(1:, :))
            turns_back = stepper%formulation%action%drag_turns(t, y)
        end function turns_back

    end subroutine check_direction

    !> Whether one of the vectors may vanish in a step: always under friction that is dry or depends on the support, and under a
    !> drag where one turns by more than a right angle in half of the step.
    logical function may_reverse(stepper)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        real(dp) :: middle, first(3, directions), at_middle(3, directions), last(3, directions)
        may_reverse = stepper%formulation%action%may_stick
        if (may_reverse .or. .not. stepper%formulation%action%may_turn) return
        middle = stepper%t_last + (stepper%t - stepper%t_last) / 2
        at_middle = stepper%formulation%action%directions_at(middle, stepper%interpolate(middle))
        first = stepper%formulation%action%directions_at(stepper%t_last, stepper%y_last)
        last = stepper%formulation%action%directions_at(stepper%t, stepper%y)
        may_reverse = norm2(at_middle(:, direction_force)) > 0 .or. which_reversed(first, first, at_middle) > 0 .or. &
            which_reversed(first, at_middle, last) > 0
    end function may_reverse

    !> Which vector reverses; 0 if none does: it differs by more than a right angle from what it was before, or, of the support
    !> force, by less from what it was at first.
    pure integer function which_reversed(first, before, now) result(which)
        real(dp), intent(in) :: first(3, directions), before(3, directions), now(3, directions)
        do which = 1, directions
            if (has_reversed(which, first, before, now)) return
        end do
        which = 0
    end function which_reversed

    pure logical function has_reversed(which, first, before, now)
        integer, intent(in) :: which
        real(dp), intent(in) :: first(3, directions), before(3, directions), now(3, directions)
        if (which == direction_force) then
            has_reversed = dot_product(first(:, which), now(:, which)) < turned * norm2(first(:, which)) * norm2(now(:, which))
        else
            has_reversed = dot_product(before(:, which), now(:, which)) < 0
        end if
    end function has_reversed

    !> Ends a step before a vector reverses in it. Where the angular velocity does, a plane motion comes to rest; that of a
    !> motion that is nearly plane reverses too, as far as its terms can tell. Where another vector vanishes, a step without
    !> series must follow, from there: `must_cross`. If that is the beginning of the step, the step is undone and the status
    !> is that of a step that is too small.
    subroutine end_before_reversal(stepper, must_cross, status)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        logical, intent(out) :: must_cross !! whether a step without series must follow
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: span, times(instants), y(instants, max_states), lower
        real(dp) :: first(3, directions), before(3, directions), now(3, directions)
        integer :: i, which

        must_cross = .false.
        span = stepper%t - stepper%t_last
        first = stepper%formulation%action%directions_at(stepper%t_last, stepper%y_last)
        do
            times = stepper%t_last + span * [(real(i, dp) / instants, i=1, instants)]
            call stepper%states_within(times, y)
            before = first
            do i = 1, instants
                now = stepper%formulation%action%directions_at(times(i), y(i, :))
                which = which_reversed(first, before, now)
                if (which > 0) exit
                before = now
            end do
            ! Not within the first part, or at once.
            if (i > 1 .or. which /= direction_omega .or. .not. times(1) > stepper%t_last) exit
            span = span / instants
        end do
        if (which == 0) return
        lower = stepper%t_last
        if (i > 1) lower = times(i - 1)
        if (which == direction_omega) then
            if (i > 1) call end_step_at(stepper, lower, y(i - 1, :), status)
            return
        end if
        call approach(stepper, which, first, lower, times(i), must_cross)
        if (lower - stepper%t_last > spacings * spacing(lower)) then
            call end_step_at(stepper, lower, stepper%state_within(lower), status)
        else
            must_cross = .false.
            stepper%t = stepper%t_last
            stepper%y = stepper%y_last
            stepper%rest = 0
            status = status_step_too_small
        end if
    end subroutine end_before_reversal

    !> Moves the lower of two times, between which a vector reverses, to the last at which it has not; if it does not vanish
    !> there, to a part of the way to that.
    subroutine approach(stepper, which, first, lower, upper, vanishes)
        class(stepper_t), intent(inout) :: stepper
        integer, intent(in) :: which
        real(dp), intent(in) :: first(3, directions)
        real(dp), intent(inout) :: lower
        real(dp), intent(in) :: upper
        logical, intent(out) :: vanishes
        real(dp) :: last, times(instants), y(instants, max_states), before(3, directions), now(3, directions)
        integer :: i

        last = upper
        before = stepper%formulation%action%directions_at(lower, stepper%state_within(lower))
        do while (last - lower > spacings * spacing(last))
            times = lower + (last - lower) * [(real(i, dp) / instants, i=1, instants)]
            times(instants) = last
            call stepper%states_within(times, y)
            do i = 1, instants - 1
                now = stepper%formulation%action%directions_at(times(i), y(i, :))
                if (has_reversed(which, first, before, now)) exit
            end do
            last = times(i)
            if (i > 1) lower = times(i - 1)
        end do
        now = stepper%formulation%action%directions_at(lower, stepper%state_within(lower))
        vanishes = norm2(now(:, which)) <= vanishing * norm2(first(:, which))
        if (.not. vanishes) lower = stepper%t_last + part_of_way * (lower - stepper%t_last)
    end subroutine approach

    !> Ends a step just after the first instant at which the angular velocity is beyond a row.
    subroutine end_at_row(stepper, is_series, status)
        class(stepper_t), intent(inout) :: stepper !! the method, after a step
        logical, intent(in) :: is_series !! whether the step is by series
        integer, intent(inout) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(row_interval_t) :: rows
        real(dp) :: spin(2), t, y(max_states)
        integer :: row
        logical :: passes

        rows = stepper%formulation%action%interval_of_rows(stepper%t_last, stepper%y_last)
        if (.not. is_series) then
            ! States within a step cost evaluations of f, and few steps come near a row.
            spin(1) = stepper%formulation%action%spin_of_rows(stepper%t_last, stepper%y_last)
            spin(2) = stepper%formulation%action%spin_of_rows(stepper%t, stepper%y)
            if (min(rows%upper - maxval(spin), minval(spin) - rows%lower) > abs(spin(2) - spin(1))) return
        end if
        t = stepper%t_last
        ! One row may be passed at the beginning.
        do row = 1, 2
            call find_row(stepper, rows, t, y, passes)
            if (.not. passes) return
            if (is_series) then
                call end_step_at(stepper, t, y, status)
                return
            else if (t - stepper%t_last > shortest * (stepper%t - stepper%t_last)) then
                call take_again(stepper, t, status)
                return
            end if
            rows = stepper%formulation%action%interval_of_rows(t, y)
        end do
    end subroutine end_at_row

    !> Finds the first instant from `t` on at which the angular velocity is beyond the rows, and the state then.
    subroutine find_row(stepper, rows, t, y, passes)
        class(stepper_t), intent(inout) :: stepper
        type(row_interval_t), intent(in) :: rows
        real(dp), intent(inout) :: t
        real(dp), intent(out) :: y(max_states)
        logical, intent(out) :: passes
        real(dp) :: lower, upper, times(0:instants), states(0:instants, max_states), spin(0:instants)
        integer :: i, peak

        passes = .false.
        i = 0
        lower = t
        upper = stepper%t
        do while (upper - lower > spacings * spacing(upper))
            times = lower + (upper - lower) * [(real(i, dp) / instants, i=0, instants)]
            times(instants) = upper
            states(0, :) = stepper%state_within(lower)
            call stepper%states_within(times(1:), states(1:, :))
            do i = 0, instants
                spin(i) = stepper%formulation%action%spin_of_rows(times(i), states(i, :))
            end do
            i = findloc(spin(1:) > rows%upper .or. spin(1:) < rows%lower, .true., dim=1)
            if (i > 0) then
                lower = times(i - 1)
                upper = times(i)
                cycle
            end if
            peak = place_of_peak(spin, rows)
            if (peak == 0) return
            lower = times(peak - 1)
            upper = times(peak + 1)
        end do
        passes = i > 0 .and. upper < stepper%t
        if (.not. passes) return
        t = upper
        y = states(i, :)
    end subroutine find_row

    !> Takes a step again, up to a time within it.
    subroutine take_again(stepper, t, status)
        class(stepper_t), intent(inout) :: stepper
        real(dp), intent(in) :: t
        integer, intent(out) :: status
        stepper%t = stepper%t_last
        stepper%y = stepper%y_last
        stepper%rest = 0
        stepper%t_end = t
        call stepper%begin(status)
        if (.not. is_ok(status)) return
        stepper%h = t - stepper%t
        call stepper%advance(status)
    end subroutine take_again

    !> The inner instant at which the angular velocity is an extreme that may pass a row before or after it; 0 if there is none.
    pure integer function place_of_peak(spin, rows) result(peak)
        real(dp), intent(in) :: spin(0:instants)
        type(row_interval_t), intent(in) :: rows
        real(dp) :: rise, fall
        do peak = 1, instants - 1
            rise = spin(peak) - min(spin(peak - 1), spin(peak + 1))
            fall = max(spin(peak - 1), spin(peak + 1)) - spin(peak)
            if (min(spin(peak) - spin(peak - 1), spin(peak) - spin(peak + 1)) >= 0 .and. spin(peak) + rise > rows%upper) return
            if (max(spin(peak) - spin(peak - 1), spin(peak) - spin(peak + 1)) <= 0 .and. spin(peak) - fall < rows%lower) return
        end do
        peak = 0
    end function place_of_peak

end module spintop_step_ends
