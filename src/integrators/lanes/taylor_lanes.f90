!> Taylor's method for many rigid bodies at once, one in each lane of a vector.
!>
!> Each lane has its own time, step size and end, so its result does not depend on the other lanes. The state
!> is omega, Gamma and the angle xi = psi + s phi (`spintop_lane_series`). When the body of a lane leaves one
!> side for the other, s changes between two steps. The other angle, (s phi - psi)/2, follows from Gamma
!> except for its turns, which are counted. Cases are assigned to the lanes:
!>
!>     call integrate_many(controls, bodies, starts, t_end, ends, outcomes)
!>     if (is_ok(outcomes(i)%status)) then; ... = ends(i)%quaternion
!>
!> A monitor exists for each quantity of a motion that is needed between the ends of its steps. It keeps its own
!> numbers for each lane, and at the end of a case stores its result in the measures of that. The numbers of a lane do not
!> depend on the other lanes.
module spintop_taylor_lanes
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_intptr_t, c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: nearest_turn, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_body_numbers, only: kinds_of, numbers_of
    use spintop_caller, only: stop_is_wanted
    use spintop_kinds, only: dp, qp, pi, is_finite
    use spintop_event, only: margin, noise_of_tolerance, rounding_distance
    use spintop_effects, only: kernel_effects
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_formulation, only: max_series_order
    use spintop_integration, only: outcome_t
    use spintop_kernel_types, only: lane_body_t, lane_constants, more_rows, motion_kinds_t
    use spintop_lane_series, only: expand, expand_affected, lanes, parts, rows, set_effects
    use spintop_lane_steps, only: add_steps, border, choose_durations, end_before_reversals, follow, lane_numbers_t, &
        largest_turn, non_finite, sharp, turns_far, walk, watch_poles
    use spintop_measures, only: measures_t
    use spintop_methods, only: controls_status
    use spintop_motion, only: motion_from_quaternion, motion_t, passages_t
    use spintop_pole_passages, only: in_pole, through_pole
    use spintop_poles, only: reach_of
    use spintop_quantities, only: angular_acceleration, motion_scales, motion_scales_t
    use spintop_status, only: is_ok, status_bad_input, status_bad_span, status_non_finite, status_ok, &
        status_step_limit, status_step_too_small, status_unsuitable
    use spintop_stepper, only: controls_t, looks_per_step, smallest_spacings
    use spintop_taylor, only: largest_growth, order_for, safety, stretch, taylor_info
    use spintop_validity, only: body_status, motion_status
    implicit none
    private
    public :: taylor_lanes_t, lanes, lane_order, lane_monitor_t, monitor_slot_t, integrate_many, set_body

    !> By how much of the tolerance a motion is off within some steps: measured.
    real(dp), parameter :: share_of_tolerance = 0.004_dp

    !> Numbers per cache line.
    integer, parameter :: line = 8

    !> The lanes: `set`, `load` some, then `advance` all and examine `now` and `status`.
    type :: taylor_lanes_t
        integer :: order = 0
        !> The numbers of the lanes, and the coefficients of the last step (lane, row, term from 0 on).
        !> They begin at a cache line: otherwise each vector would lie in two cache lines, and a step would take
        !> half as long again.
        type(lane_numbers_t), pointer :: now => null()
        real(dp), pointer, contiguous :: c(:, :, :) => null()
        !> Which effects there are on the bodies, if any, and the coefficients of their rows, likewise; the constants of the lanes.
        type(motion_kinds_t), allocatable :: effects
        real(dp), pointer, contiguous :: more(:, :, :) => null()
        real(dp), private :: constants(lanes, lane_constants) = 0
        !> Powers of the length of the last step, s, for what looks at its polynomials over the step as the unit interval,
        !> where no power of the terms overflows: see `find_powers`.
        real(dp) :: power(lanes, 0:max_series_order) = 1
        !> `status_ok`, or the reason why a lane does not continue.
        integer :: status(lanes) = status_ok
        integer(int64) :: steps(lanes) = 0
        !> How far the motions may be from those without errors of the method, relatively.
        real(dp) :: method_noise = rounding_distance
        !> The passages through poles so far, and before the last step.
        type(passages_t) :: passed(lanes) = passages_t(), passed_last(lanes) = passages_t()
        !> What a step adds to the error of a motion, rad, at the most, 0 of one that passes through poles.
        real(dp), private :: error_of_step(lanes) = 0
        !> Whether there is a drag on a lane that changes its direction with that of the angular velocity at once.
        logical, private :: has_cusps(lanes) = .false.
        !> The centre of mass of a body on which a drag force acts, m; otherwise 0.
        real(dp), private :: dragged(lanes, 3) = 0
        type(controls_t), private :: controls
        !> Memory for both.
        real(dp), allocatable, private :: room(:)
    contains
        procedure :: set
        procedure :: load
        procedure :: advance
        procedure :: stop => stop_lane
        procedure :: find_powers
        procedure :: motion
        procedure :: find_other_angle
        procedure :: find_angles
        procedure :: angles_at
    end type taylor_lanes_t

    !> Orders of least cost, found by measurement. They are lower than for a single body, because other lanes
    !> are computed while a term waits for the last one.
    real(dp), parameter :: order_at_one = 9, order_a_digit = 0.92_dp

    !> Monitors one family of quantities in all lanes.
    type, abstract :: lane_monitor_t
    contains
        procedure(begin), deferred :: begin
        procedure(observe), deferred :: observe
        procedure(finish), deferred :: finish
    end type lane_monitor_t

    !> An element of a list of monitors.
    type :: monitor_slot_t
        class(lane_monitor_t), allocatable :: monitor
    end type monitor_slot_t

    abstract interface
        !> A case begins in a lane.
        subroutine begin(self, run, lane, body, start)
            import :: body_t, lane_monitor_t, motion_t, taylor_lanes_t
            class(lane_monitor_t), intent(inout) :: self
            type(taylor_lanes_t), intent(in) :: run !! the lanes
            integer, intent(in) :: lane !! index of the lane
            type(body_t), intent(in) :: body !! mass properties of the body
            type(motion_t), intent(in) :: start !! the motion at the start
        end subroutine begin

        !> All lanes have taken a step, from `t_last` to `t`; lanes at rest took one of no length. A monitor may end a
        !> lane within the step (`stop`): those behind it in the list see the step up to there.
        subroutine observe(self, run)
            import :: lane_monitor_t, taylor_lanes_t
            class(lane_monitor_t), intent(inout) :: self
            type(taylor_lanes_t), intent(inout) :: run !! the lanes
        end subroutine observe

        !> The case in a lane is at its end.
        subroutine finish(self, run, lane, last, found)
            import :: lane_monitor_t, measures_t, motion_t, taylor_lanes_t
            class(lane_monitor_t), intent(inout) :: self
            type(taylor_lanes_t), intent(in) :: run !! the lanes
            integer, intent(in) :: lane !! index of the lane
            type(motion_t), intent(in) :: last !! the motion at the end
            type(measures_t), intent(inout) :: found !! what is measured of the case
        end subroutine finish
    end interface

    !> Cases that are not integrated, and bodies without effects.
    integer, parameter :: refused = 0, plain = 1

contains

    !> Makes all lanes empty. A copy of the lanes is to be set again.
    subroutine set(self, controls, body)
        class(taylor_lanes_t), target, intent(inout) :: self
        type(controls_t), intent(in) :: controls !! tolerances and maximum number of steps
        type(body_t), intent(in), optional :: body !! one with the effects that all have; without it there are none
        type(lane_numbers_t) :: empty
        integer, parameter :: bits = storage_size(1.0_dp), numbers = storage_size(empty) / bits
        integer(c_intptr_t) :: address
        integer :: first, terms, others

        self%controls = controls
        self%method_noise = noise_of_tolerance(controls%relative_tolerance, share_of_tolerance)
        self%order = lane_order(controls%relative_tolerance)
        terms = lanes * rows * (self%order + 1)
        others = 0
        if (allocated(self%effects)) deallocate (self%effects)
        if (present(body)) then
            if (allocated(body%effects)) self%effects = kinds_of(body)
        end if
        if (allocated(self%effects)) others = lanes * more_rows * (self%order + 1)
        if (allocated(self%room)) deallocate (self%room)
        allocate (self%room(terms + others + numbers + line), source=0.0_dp)
        address = transfer(c_loc(self%room(1)), address)
        first = 1 + int(modulo(-address / (bits / 8), int(line, c_intptr_t)))
        self%c(1:lanes, 1:rows, 0:self%order) => self%room(first:first + terms - 1)
        call c_f_pointer(c_loc(self%room(first + terms)), self%now)
        self%now = empty
        first = first + terms + numbers
        if (others > 0) self%more(1:lanes, 1:more_rows, 0:self%order) => self%room(first:first + others - 1)
    end subroutine set

    !> The order of series for a tolerance.
    pure integer function lane_order(tolerance) result(order)
        real(dp), intent(in) :: tolerance !! relative tolerance of the motions
        order = order_for(tolerance, order_at_one, order_a_digit)
    end function lane_order

    !> Puts a body and its start into a lane.
    subroutine load(self, lane, body, start, t_end)
        class(taylor_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body, with the effects that all have
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp), intent(in) :: t_end !! end of the span, s
        real(dp) :: q(4), vertical(3), side, half, turns, reach(2)
        type(motion_scales_t) :: scales

        scales = motion_scales(body, start)
        q = start%quaternion / norm2(start%quaternion)
        vertical = vertical_from_quaternion(q)
        side = sign(1.0_dp, vertical(3))
        half = merge(atan2(q(4), q(1)), atan2(q(3), q(2)), side > 0)
        turns = anint((half - (start%angle(1) + side * start%angle(3)) / 2) / pi)
        half = side * (half - pi * turns)
        associate (now => self%now)
            now%scale(lane) = scales%rate
            now%t(lane) = 0
            now%t_last(lane) = 0
            now%t_end(lane) = t_end
            now%h(lane) = t_end
            now%side(lane) = side
            now%sense(lane) = 1 - 2 * modulo(turns, 2.0_dp)
            now%state(lane, :) = [start%omega, vertical, 2 * half]
            now%other(lane) = half - start%angle(3)
            now%rest(lane, :) = 0
            call set_body(now%body, lane, body)
        end associate
        if (allocated(self%effects)) then
            call set_effects(numbers_of(body), lane - 1, self%constants)
            self%has_cusps(lane) = body%effects%has_cusps()
            self%dragged(lane, :) = 0
            if (body%effects%drag_force > 0) self%dragged(lane, :) = body%centre_of_mass
        end if
        self%passed(lane) = passages_t()
        reach = reach_of(body, start)
        self%now%reach(lane) = reach(1)
        self%now%in_pole2(lane) = (in_pole * reach(1))**2
        self%error_of_step(lane) = merge(margin * self%method_noise, 0.0_dp, reach(1) <= through_pole)
        self%steps(lane) = 0
        self%status(lane) = status_ok
    end subroutine load

    !> Puts the constants of a body into a lane.
    pure subroutine set_body(of, lane, body)
        type(lane_body_t), intent(inout) :: of !! the bodies
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        associate (inertia => body%inertia, moment => body%weight_moment())
            ! Exactly zero for equal moments, so that a symmetric body keeps its spin to the last digit.
            of%coupling(lane, :) = (cshift(inertia, 1) - cshift(inertia, 2)) / inertia
            of%decay(lane, :) = body%damping / inertia
            of%pull(lane, :) = cshift(moment, -1) / inertia
            of%swing(lane, :) = cshift(moment, 1) / inertia
        end associate
    end subroutine set_body

    !> One step in every lane, as long as the last terms of its series allow. A lane that can take
    !> none gets a status that says why, and an end where it is.
    subroutine advance(self)
        class(taylor_lanes_t), intent(inout) :: self
        integer(int64) :: trouble(lanes), doubt(lanes), worst
        logical :: reverses(lanes), is_known
        integer :: lane

        associate (now => self%now, c => self%c)
            if (allocated(self%effects)) then
                call expand_affected(self%order, self%effects, self%constants, now%t, now%side, now%state, c, self%more)
            else
                call expand(self%order, now%body, now%side, now%state, c)
            end if
            associate (own => self%controls)
                call choose_durations(self%order, own%absolute_tolerance, own%relative_tolerance, largest_growth, safety, stretch, &
                                      smallest_spacings * epsilon(now%t), own%max_steps, c, now%scale, now%t, now%t_end, &
                                      self%steps, now%h, now%duration, trouble)
            end associate
            worst = maxval(trouble)
            if (any(self%has_cusps)) then
                call end_before_reversals(self%order, c, self%has_cusps, self%dragged, now%duration, reverses)
                where (reverses) trouble = max(trouble, non_finite)
                worst = max(worst, maxval(trouble))
            end if
            if (worst > 0) call end_lanes(self, trouble)
            call add_steps(self%order, c, now%duration, now%t_end, now%t_last, now%t, now%state, now%rest)
            self%steps = self%steps + merge(1, 0, now%duration > 0)
            now%error = self%error_of_step * self%steps
            now%side_last = now%side
            now%other_last = now%other
            self%passed_last = self%passed
            call follow(self%order, c, now, doubt, worst)
            now%other_then = now%other
            do lane = 1, merge(0, lanes, worst == 0)
                if (doubt(lane) >= turns_far) then
                    call self%find_other_angle(lane, now%t(lane), now%other(lane), self%passed(lane), is_known)
                    now%other_then(lane) = now%other(lane)
                    if (.not. is_known) then
                        ! The body turned too often to be followed: the lane ends where the step began.
                        call self%stop(lane, now%t_last(lane))
                        self%status(lane) = status_step_limit
                    end if
                end if
                if (now%side(lane) * now%state(lane, 6) < border) call change_side(self, lane)
            end do
            call watch_poles(now%error, now%state, self%passed)
        end associate
    end subroutine advance

    !> Ends a lane at a time within the last step: its motion is that then.
    pure subroutine stop_lane(self, lane, t)
        class(taylor_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: t !! time within the last step, s
        associate (now => self%now)
            call self%find_other_angle(lane, t, now%other_then(lane), self%passed(lane))
            now%other(lane) = now%other_then(lane)
            now%side(lane) = now%side_last(lane)
            now%state(lane, :) = state_at(self, lane, t - now%t_last(lane))
            now%rest(lane, :) = 0
            now%t(lane) = t
            now%t_end(lane) = t
        end associate
        call self%find_powers()
    end subroutine stop_lane

    !> Finds the powers of the lengths of the last steps.
    pure subroutine find_powers(self)
        class(taylor_lanes_t), intent(inout) :: self
        integer :: i, k
        self%power(:, 1) = self%now%t - self%now%t_last
        ! A chain of products would wait for each.
        do k = 2, self%order
            !$omp simd
            do i = 1, lanes
                self%power(i, k) = self%power(i, k / 2) * self%power(i, k - k / 2)
            end do
        end do
    end subroutine find_powers

    !> Sets the statuses of lanes that can take no step, and ends these where they are.
    pure subroutine end_lanes(self, trouble)
        class(taylor_lanes_t), intent(inout) :: self
        integer(int64), intent(in) :: trouble(lanes)
        integer :: lane
        associate (now => self%now)
            do lane = 1, lanes
                if (.not. trouble(lane) > 0) cycle
                now%duration(lane) = 0
                if (.not. now%t(lane) < now%t_end(lane)) cycle
                self%status(lane) = status_non_finite
                if (trouble(lane) < non_finite) self%status(lane) = status_step_too_small
                if (self%steps(lane) >= self%controls%max_steps) self%status(lane) = status_step_limit
                now%t_end(lane) = now%t(lane)
            end do
        end associate
    end subroutine end_lanes

    !> The other angle in a lane at a time within the last step, and the passages through poles up to there.
    pure subroutine find_other_angle(self, lane, t, other, passed, is_known)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: t !! time within the last step, s
        real(dp), intent(out) :: other !! the other angle, (s phi - psi)/2, rad
        type(passages_t), intent(out) :: passed !! the passages
        logical, intent(out), optional :: is_known !! whether the turns of the step could be followed
        integer(int64) :: looks
        real(dp) :: from, gamma(2), angle
        from = self%now%t_last(lane)
        gamma = self%c(lane, 4:5, 0)
        angle = self%now%other_last(lane)
        passed = self%passed_last(lane)
        looks = looks_per_step * self%controls%max_steps
        call walk(self%now, lane, self%order, self%c(lane, :, :), t, looks, from, gamma, angle, passed)
        other = angle
        if (present(is_known)) is_known = looks > 0
    end subroutine find_other_angle

    !> phi and psi in a lane at a time h after the beginning of the last step, with all their turns, and the passages through poles
    !> up to there: from the nearer end of the step if it is followed from there with certainty, or else by a walk. In a pole only
    !> the other angle is known.
    pure subroutine find_angles(self, lane, h, place, angles, passed)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: h, place(4) !! time, s; (Gamma, xi) then
        real(dp), intent(out) :: angles(2) !! phi and psi, rad
        type(passages_t), intent(out) :: passed !! the passages
        real(dp) :: other, near(2), away(2)
        logical :: is_known
        integer :: i

        passed = self%passed(lane)
        is_known = sum(place(1:2)**2) > self%now%in_pole2(lane) .and. .not. (passed%arrived .or. self%passed_last(lane)%arrived &
            .or. any(passed%odd .neqv. self%passed_last(lane)%odd))
        associate (now => self%now)
            near = [now%other_last(lane), now%other_then(lane)]
            away = [h, now%t(lane) - now%t_last(lane) - h]
            do i = 1, merge(2, 0, is_known)
                other = nearest_turn(place(4) / 2 - atan2(place(1), place(2)), near(i))
                is_known = abs(other - near(i)) <= sharp .and. away(i)**2 * now%rate(lane) <= largest_turn**2
                if (is_known) exit
            end do
            if (.not. is_known) then
                call self%find_other_angle(lane, now%t_last(lane) + h, other, passed)
                if (any(abs(place(1:2)) > 0) .and. .not. passed%arrived) then
                    other = nearest_turn(place(4) / 2 - atan2(place(1), place(2)), other)
                end if
            end if
            angles = [now%side_last(lane) * (place(4) / 2 + other), place(4) / 2 - other]
        end associate
    end subroutine find_angles

    !> phi and psi in a lane at a time within the last step, with all their turns.
    pure function angles_at(self, lane, t) result(angles)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: t !! time within the last step, s
        real(dp) :: angles(2), state(parts)
        type(passages_t) :: passed
        state = state_at(self, lane, t - self%now%t_last(lane))
        call self%find_angles(lane, t - self%now%t_last(lane), state(4:), angles, passed)
    end function angles_at

    !> The state in a lane at a time h after the beginning of the last step.
    pure function state_at(self, lane, h) result(state)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: h
        real(dp) :: state(parts)
        integer :: k
        state = 0
        do k = self%order, 1, -1
            state = (state + self%c(lane, :parts, k)) * h
        end do
        state = self%c(lane, :parts, 0) + state
    end function state_at

    !> Describes the attitude in a lane by the angle of the other side.
    pure subroutine change_side(self, lane)
        class(taylor_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        !> 2 pi, and what its rounding left.
        real(dp), parameter :: turn = 2 * pi, turn_rest = real(6.283185307179586476925286766559005768_qp - turn, dp)
        real(dp) :: precise, turns
        associate (now => self%now, s => self%now%side(lane), xi => self%now%state(lane, 7), other => self%now%other(lane))
            precise = xi / 2 - atan2(now%state(lane, 4), now%state(lane, 5))
            turns = anint((other - precise) * (1 / turn))
            precise = precise + turns * turn + turns * turn_rest
            other = -xi / 2
            xi = -2 * precise
            s = -s
            now%rest(lane, 7) = 0
        end associate
    end subroutine change_side

    !> The motion in a lane, but for the acceleration.
    pure type(motion_t) function motion(self, lane)
        class(taylor_lanes_t), intent(in) :: self
        integer, intent(in) :: lane !! index of the lane
        real(dp) :: q(4), near(3), along, half(2)

        associate (now => self%now, gamma => self%now%state(lane, 4:6), s => self%now%side(lane), xi => self%now%state(lane, 7))
            ! The two halves of the quaternion: that of xi, and the other, turned by psi from it.
            along = sqrt((1 + s * gamma(3)) / 2)
            half = [cos(xi / 2), sin(xi / 2)]
            q([1, 4]) = along * [half(1), s * half(2)]
            q([2, 3]) = [half(1) * gamma(2) + half(2) * gamma(1), s * (half(2) * gamma(2) - half(1) * gamma(1))] / (2 * along)
            if (s < 0) q = q([2, 1, 4, 3])
            near = [s * (xi / 2 + now%other(lane)), 0.0_dp, xi / 2 - now%other(lane)]
            q = now%sense(lane) * q / norm2(q)
            motion = motion_from_quaternion(now%t(lane), q, now%state(lane, 1:3), near)
            motion%passed = self%passed(lane)
            ! In a pole the attitude does not tell phi and psi.
            if (motion%passed%arrived) motion%angle(1:3:2) = near(1:3:2)
        end associate
    end function motion

    !> Integrates each body from its start over its span, and returns the motions at the ends and their
    !> outcomes. phi and psi count all their turns. `controls` contains the tolerances and the maximum number
    !> of steps per case. Any body is possible, damped or undamped, in any attitude, and with effects but dry friction and
    !> tables of torques (`status_unsuitable`). The result of a case does not depend on the others. A case that fails
    !> returns the last motion that it reached, also where a drag has no series because a speed is zero, or nearly so while the
    !> body reverses (`status_non_finite`, `status_step_too_small`); a case that is refused (`status_non_finite`, `status_bad_body`,
    !> `status_bad_start`, `status_bad_span`) returns its start. All cases are refused if the settings are not valid, or if
    !> the sizes of the arrays differ.
    subroutine integrate_many(controls, bodies, starts, t_end, ends, outcomes, monitors, measures)
        type(controls_t), intent(in) :: controls !! settings of the method
        type(body_t), intent(in) :: bodies(:) !! mass properties, one for each case
        type(motion_t), intent(in) :: starts(:) !! starts, one for each case
        real(dp), intent(in) :: t_end(:) !! ends of the spans, one for each case, s
        type(motion_t), intent(out) :: ends(:) !! motions at the end of the span, one for each case
        type(outcome_t), intent(out) :: outcomes(:) !! status, time reached and cost of each case
        type(monitor_slot_t), intent(inout), optional :: monitors(:) !! measure quantities along the motions
        type(measures_t), intent(out), optional :: measures(:) !! what they measure, one for each case
        integer :: kind(size(bodies)), i

        outcomes%status = controls_status(taylor_info, controls)
        if (any([size(starts), size(t_end), size(ends), size(outcomes)] /= size(bodies))) then
            outcomes%status = status_bad_input
            return
        end if
        if (any(.not. is_ok(outcomes%status))) return
        do i = 1, size(bodies)
            outcomes(i)%status = case_status(bodies(i), starts(i), t_end(i))
            kind(i) = kind_of(bodies(i))
            if (is_ok(outcomes(i)%status)) cycle
            kind(i) = refused
            ends(i) = starts(i)
        end do
        do while (any(kind /= refused))
            i = maxval(kind)
            call integrate_kind(controls, pack([(i, i=1, size(kind))], kind == i), bodies, starts, t_end, ends, &
                                outcomes, monitors, measures)
            where (kind == i) kind = refused
        end do
    end subroutine integrate_many

    !> Whether the equations hold for a case.
    pure integer function case_status(body, start, t_end) result(status)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: t_end
        status = body_status(body)
        if (is_ok(status) .and. allocated(body%effects)) then
            if (.not. body%effects%only(kernel_effects)) status = status_unsuitable
        end if
        if (is_ok(status)) status = motion_status(start, body)
        if (is_ok(status) .and. .not. (t_end >= 0 .and. is_finite(t_end))) status = status_bad_span
    end function case_status

    !> A number of the effects on a body: `plain` without any, and the same for bodies with the same effects. Those are
    !> integrated together, so that no sum of a body depends on the effects on others.
    pure integer function kind_of(body) result(kind)
        type(body_t), intent(in) :: body
        type(motion_kinds_t) :: kinds
        kind = plain
        if (.not. allocated(body%effects)) return
        kinds = kinds_of(body)
        kind = plain + 1 + kinds%frame + 3 * (kinds%torque + 3 * (kinds%push + 3 * (kinds%rotor + 2 * kinds%drags)))
    end function kind_of

    !> Integrates the cases with the same effects.
    subroutine integrate_kind(controls, cases, bodies, starts, t_end, ends, outcomes, monitors, measures)
        type(controls_t), intent(in) :: controls
        integer, intent(in) :: cases(:) !! their numbers
        type(body_t), intent(in) :: bodies(:)
        type(motion_t), intent(in) :: starts(:)
        real(dp), intent(in) :: t_end(:)
        type(motion_t), intent(inout) :: ends(:)
        type(outcome_t), intent(inout) :: outcomes(:)
        type(monitor_slot_t), intent(inout), optional :: monitors(:)
        type(measures_t), intent(inout), optional :: measures(:)
        type(taylor_lanes_t), target :: run
        integer :: case_in(lanes), number, next, lane, i

        call run%set(controls, bodies(cases(1)))
        number = 0
        if (present(monitors)) number = size(monitors)
        case_in = 0
        next = 1
        do
            do lane = 1, lanes
                do while (.not. run%now%t(lane) < run%now%t_end(lane))
                    if (case_in(lane) > 0) then
                        call unload(run, lane, bodies(case_in(lane)), ends(case_in(lane)), outcomes(case_in(lane)))
                        do i = 1, number
                            call monitors(i)%monitor%finish(run, lane, ends(case_in(lane)), measures(case_in(lane)))
                        end do
                    end if
                    case_in(lane) = 0
                    if (next > size(cases)) exit
                    associate (case => cases(next))
                        call run%load(lane, bodies(case), starts(case), t_end(case))
                        do i = 1, number
                            call monitors(i)%monitor%begin(run, lane, bodies(case), starts(case))
                        end do
                        case_in(lane) = case
                    end associate
                    next = next + 1
                end do
            end do
            if (all(case_in == 0)) exit
            if (stop_is_wanted()) then
                run%now%t_end = run%now%t
                cycle
            end if
            call run%advance()
            if (number > 0) call run%find_powers()
            do i = 1, number
                call monitors(i)%monitor%observe(run)
            end do
        end do
    end subroutine integrate_kind

    !> The motion in a lane, and its outcome.
    subroutine unload(run, lane, body, motion, outcome)
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        type(motion_t), intent(out) :: motion
        type(outcome_t), intent(out) :: outcome
        real(dp) :: rate(6)

        outcome%status = run%status(lane)
        outcome%t = run%now%t(lane)
        outcome%counts%steps = run%steps(lane)
        outcome%counts%evaluations = run%order * run%steps(lane)
        outcome%doubtful_passages = run%passed(lane)%doubtful
        motion = run%motion(lane)
        if (allocated(body%effects)) then
            motion%omega_rate = angular_acceleration(body, motion)
            return
        end if
        rate = euler_poisson_rate(body, [run%now%state(lane, 4:6), body%inertia * motion%omega])
        motion%omega_rate = rate(4:6) / body%inertia
    end subroutine unload

end module spintop_taylor_lanes
