!> Watches a quantity along the motions in lanes: ends a motion where it passes a level, keeps its extremes, or counts turning
!> points.
!>
!> All are roots of a polynomial in each step (`spintop_watched_quantities`). One root in a lane is found by Newton's method in
!> all lanes at once, several in the lanes that have them. A root at the end of a step is found once: the sign there is carried
!> to the next.
module spintop_lane_watch
    use spintop_bernstein, only: find_changes, find_roots, most_roots, refine_root, rounding
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, pi, is_finite
    use spintop_constancy, only: margin, time_of_start
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: per_binomial
    use spintop_lane_series, only: parts
    use spintop_lane_steps, only: states_at
    use spintop_measures, only: lower, measures_t, upper, watch_phi, watch_precession_rate, watch_psi
    use spintop_motion, only: motion_t, passages_t
    use spintop_pole_passages, only: half_turns, through_pole
    use spintop_poles, only: polar_precession_rate
    use spintop_quantities, only: angular_acceleration
    use spintop_taylor_lanes, only: lane_monitor_t, lanes, taylor_lanes_t
    use spintop_watched_quantities, only: watched_t
    implicit none
    private
    public :: lane_watch_t

    !> What is done at a root: the n-th passage of the level ends the motion; the values that are extreme are kept; the turning
    !> points, those of `watch_turning`, are counted.
    integer, parameter, public :: stop_motion = 1, keep_extremes = 2, count_turns = 3

    !> Newton's iterations in lanes, and the length of the last from which on the root is right to rounding.
    integer, parameter :: iterations = 3
    real(dp), parameter :: still = 1.0e-6_dp
    !> Sine of the inclination below which body z is near a pole.
    real(dp), parameter :: near_pole = 0.03_dp

    !> What an end of a motion has in place of slopes at roots.
    real(dp), parameter :: no_slope(lanes) = 0

    !> A watch. One that ends motions is handed over before other monitors, which then see no more than the motion up to there.
    type, extends(lane_monitor_t) :: lane_watch_t
        type(watched_t) :: of
        integer :: action = stop_motion
        !> Which passages count, those rising, those falling; number of the one that ends the motion.
        logical :: rising = .true., falling = .true.
        integer :: wanted = 1
        !> An angle in any turn; full turns from the start instead of the angle, each of which is met once, either way.
        logical :: every_turn = .false., turn_by_turn = .false.
        !> Passages up to the end; times up to which a passage is the start itself, s; the level, which full turns count from the
        !> start, and the full turns so far.
        integer, private :: left(lanes) = 0
        real(dp), dimension(lanes), private :: started = 0, goal = 0, full_turns = 0
        !> What is measured up to now of the case in each lane. Turning points have a measure in place of theta: tan(theta/2) up to
        !> a right angle, and then 2 - cot(theta/2).
        type(measures_t), private :: found(lanes) = measures_t()
        !> Sign of the polynomial at the end of the last step; 0 where it is none, as at the start.
        real(dp), private :: sign(lanes) = 0
        !> How large the polynomial was since the last root, where it was seen; whether it was within its noise before that root;
        !> whether it is zero to rounding.
        real(dp), private :: far(lanes) = 0
        logical, private :: was_noise(lanes) = .false., is_constant(lanes) = .false.
    contains
        procedure :: begin
        procedure :: observe
        procedure :: finish
    end type lane_watch_t

contains

    !> A case begins in a lane. The start itself is no passage.
    subroutine begin(self, run, lane, body, start)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        type(motion_t) :: here
        real(dp) :: value
        integer :: i

        self%goal(lane) = self%of%level
        if (self%turn_by_turn) self%goal(lane) = start%angle(merge(1, 3, self%of%quantity == watch_phi))
        call self%of%set_lane(lane, body, start%omega, self%goal(lane))
        self%sign(lane) = 0
        self%found(lane) = measures_t()
        select case (self%action)
        case (stop_motion)
            self%left(lane) = self%wanted
            self%started(lane) = start%t + time_of_start(body, start)
            self%full_turns(lane) = 0
        case (count_turns)
            associate (turns => self%found(lane)%turns)
                call turns%begin(start, angular_acceleration(body, start))
                turns%start(4) = measure_of(run%now%state(lane, 4:6))
            end associate
        case (keep_extremes)
            if (self%of%quantity == watch_precession_rate .and. norm2(run%now%state(lane, 4:5)) <= through_pole) then
                here = start
                here%omega_rate = angular_acceleration(body, start)
                value = polar_precession_rate(here)
                if (is_finite(value)) self%found(lane)%largest(watch_precession_rate) = value
            else
                call keep(self, run, run%now%state, no_slope, [(i == lane, i=1, lanes)])
            end if
        end select
    end subroutine begin

    !> Finds the roots in the last step.
    subroutine observe(self, run)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes) :: noise, before, changes, u, doubt, slope, last
        real(dp) :: roots(most_roots), signs(most_roots)
        integer :: lane, k, found, degree

        call self%of%find_polynomials(run, self%action == keep_extremes, degree, a, noise)
        if (any(run%steps == 1)) call judge(self, run, degree, a, noise)
        noise = merge(sqrt(huge(noise)), noise, self%is_constant)
        before = self%sign
        call find_changes(degree, per_binomial(:, degree), rounding, a, noise, self%sign, changes, u)
        self%far = max(self%far, abs(a(:, 0)))
        if (.not. maxval(changes) > 0) return
        call refine_root(degree, iterations, still, a, u, doubt)
        slope = merge(self%sign, 0.0_dp, changes > 0 .and. changes < 2 .and. .not. doubt > 0)
        last = 0
        call act(self, run, degree, a, noise, u, slope, last)
        do lane = 1, lanes
            if (.not. (changes(lane) > 1 .or. (changes(lane) > 0 .and. doubt(lane) > 0))) cycle
            self%sign(lane) = before(lane)
            call find_roots(a(lane, :degree), noise(lane), self%sign(lane), roots, signs, found)
            do k = 1, found
                u = 0
                slope = 0
                u(lane) = roots(k)
                slope(lane) = signs(k)
                call act(self, run, degree, a, noise, u, slope, last)
            end do
        end do
    end subroutine observe

    !> Judges, in lanes that took their first step, whether the polynomial is zero to rounding: over as much of the step as the
    !> body turns by a radian.
    pure subroutine judge(self, run, degree, a, noise)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: degree
        real(dp), intent(in) :: a(lanes, 0:max_series_order), noise(lanes)
        real(dp) :: radian, total
        integer :: lane, k
        do lane = 1, lanes
            if (run%steps(lane) /= 1) cycle
            radian = 1 / max(1.0_dp, sqrt(run%now%rate(lane)) * run%power(lane, 1))
            total = 0
            do k = degree, 0, -1
                total = total * radian + abs(a(lane, k))
            end do
            self%is_constant(lane) = total <= margin * noise(lane)
            self%far(lane) = 0
            self%was_noise(lane) = .false.
        end do
    end subroutine judge

    !> Does what is to be done at the roots `u`: where the polynomial rises `slope` is positive, where it falls negative, and where
    !> there is no root zero. Those of a lane come in rising order; `last` is the one before in this step, or its beginning.
    subroutine act(self, run, degree, a, noise, u, slope, last)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run
        integer, intent(in) :: degree
        real(dp), intent(in) :: a(lanes, 0:max_series_order), noise(lanes), u(lanes), slope(lanes)
        real(dp), intent(inout) :: last(lanes)
        real(dp), dimension(lanes) :: before, behind
        logical :: is_noise(lanes), is_root, is_near
        integer :: i

        ! A root is one of noise if since the one before, or before that one, the polynomial was within the noise of the method.
        call find_values(degree, a, (last + u) / 2, before)
        call find_values(degree, a, (u + 1) / 2, behind)
        !$omp simd private(is_root, is_near)
        do i = 1, lanes
            is_root = abs(slope(i)) > 0
            is_near = max(self%far(i), abs(before(i))) <= noise(i) * (run%method_noise / rounding)
            is_noise(i) = is_root .and. (is_near .or. self%was_noise(i))
            self%was_noise(i) = merge(is_near, self%was_noise(i), is_root)
            self%far(i) = merge(abs(behind(i)), self%far(i), is_root)
            last(i) = merge(u(i), last(i), is_root)
        end do
        select case (self%action)
        case (stop_motion)
            call pass(self, run, u, slope, is_noise)
        case (keep_extremes)
            call keep_roots(self, run, u, slope)
        case (count_turns)
            call count_roots(self, run, u, slope, is_noise)
        end select
    end subroutine act

    !> Values of the polynomials: even and odd powers side by side.
    pure subroutine find_values(degree, a, u, x)
        integer, intent(in) :: degree
        real(dp), intent(in) :: a(lanes, 0:max_series_order), u(lanes)
        real(dp), intent(out) :: x(lanes)
        real(dp) :: odd(lanes)
        integer :: i, k
        x = 0
        odd = 0
        if (mod(degree, 2) == 0) x = a(:, degree)
        do k = degree - 1 - mod(degree + 1, 2), 0, -2
            !$omp simd
            do i = 1, lanes
                x(i) = x(i) * u(i)**2 + a(i, k)
                odd(i) = odd(i) * u(i)**2 + a(i, k + 1)
            end do
        end do
        x = x + u * odd
    end subroutine find_values

    !> Counts passages, and ends the lanes that have enough.
    subroutine pass(self, run, u, slope, is_noise)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run
        real(dp), intent(in) :: u(lanes), slope(lanes)
        logical, intent(in) :: is_noise(lanes)
        real(dp) :: t
        logical :: rises, falls
        integer :: lane
        ! Of full turns both senses count.
        rises = self%rising .or. self%turn_by_turn
        falls = self%falling .or. self%turn_by_turn
        do lane = 1, lanes
            if (.not. ((slope(lane) > 0 .and. rises) .or. (slope(lane) < 0 .and. falls))) cycle
            t = run%now%t_last(lane) + u(lane) * (run%now%t(lane) - run%now%t_last(lane))
            if (is_noise(lane) .or. self%left(lane) <= 0 .or. t <= self%started(lane)) cycle
            if (.not. counts(self, run, lane, t)) cycle
            self%left(lane) = self%left(lane) - 1
            if (self%left(lane) == 0) call run%stop(lane, t)
        end do
    end subroutine pass

    !> Whether a root at a time is a passage of the level: not by the opposite angle, or in another turn.
    logical function counts(self, run, lane, t)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        real(dp), intent(in) :: t
        real(dp) :: angles(2), distance, turns
        counts = .true.
        if (self%of%quantity /= watch_phi .and. self%of%quantity /= watch_psi) return
        angles = run%angles_at(lane, t)
        distance = angles(self%of%quantity) - self%goal(lane)
        turns = anint(distance / (2 * pi))
        counts = abs(distance - 2 * pi * turns) < pi / 2
        if (.not. counts .or. self%every_turn) return
        if (self%turn_by_turn) then
            counts = nint(abs(turns) - self%full_turns(lane)) == 1
            if (counts) self%full_turns(lane) = abs(turns)
        else
            counts = .not. abs(turns) > 0
        end if
    end function counts

    !> Keeps extremes.
    subroutine keep_roots(self, run, u, slope)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: u(lanes), slope(lanes)
        real(dp) :: x(lanes, parts), h(lanes), t(lanes), sine2
        logical :: is_near(lanes)
        integer :: i
        h = run%now%t - run%now%t_last
        t = u * h
        call states_at(run%order, run%c, t, x)
        call keep(self, run, x, slope, abs(slope) > 0)
        if (self%of%quantity /= watch_precession_rate) return
        ! Near a pole the terms that the series leave out are large beside the distance. There the rate is largest where body z is
        ! nearest, whose velocity is all but constant.
        !$omp simd private(sine2)
        do i = 1, lanes
            sine2 = x(i, 4)**2 + x(i, 5)**2
            is_near(i) = abs(slope(i)) > 0 .and. sine2 < near_pole**2
            t(i) = t(i) + x(i, 6) * (x(i, 4) * x(i, 2) - x(i, 5) * x(i, 1)) / max(x(i, 1)**2 + x(i, 2)**2, tiny(sine2))
            t(i) = min(max(t(i), 0.0_dp), h(i))
        end do
        if (.not. any(is_near)) return
        call states_at(run%order, run%c, t, x)
        call keep(self, run, x, slope, is_near)
    end subroutine keep_roots

    !> Keeps the values at states, in the lanes where they are wanted.
    pure subroutine keep(self, run, x, slope, is_wanted)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: x(lanes, parts), slope(lanes)
        logical, intent(in) :: is_wanted(lanes)
        real(dp) :: value(lanes)
        integer :: i
        call self%of%find_values(run%now%body, x, value)
        do i = 1, lanes
            if (is_wanted(i)) call self%found(i)%keep(self%of%quantity, value(i), slope(i), x(i, 4:5), x(i, 1:2))
        end do
    end subroutine keep

    !> Counts turning points: a lower one where Gamma3' rises, an upper one where it falls.
    pure subroutine count_roots(self, run, u, slope, is_noise)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: u(lanes), slope(lanes)
        logical, intent(in) :: is_noise(lanes)
        real(dp) :: h(lanes), x(lanes, parts), angles(2), rate
        type(passages_t) :: passed
        integer :: i

        h = u * (run%now%t - run%now%t_last)
        call states_at(run%order, run%c, h, x)
        do i = 1, lanes
            if (.not. abs(slope(i)) > 0) cycle
            call run%find_angles(i, h(i), x(i, 4:), angles, passed)
            rate = (x(i, 1) * x(i, 4) + x(i, 2) * x(i, 5)) / (x(i, 4)**2 + x(i, 5)**2)
            call self%found(i)%turns%add(merge(lower, upper, slope(i) > 0), [run%now%t_last(i) + h(i), &
                angles - pi * half_turns(passed), measure_of(x(i, 4:6)), rate], is_noise(i))
        end do
    end subroutine count_roots

    !> The measure that stands for theta, as an arc tangent would take as long as the rest; and theta of it.
    pure real(dp) function measure_of(gamma) result(measure)
        real(dp), intent(in) :: gamma(3)
        measure = sqrt(gamma(1)**2 + gamma(2)**2) / (1 + abs(gamma(3)))
        measure = merge(measure, 2 - measure, gamma(3) >= 0)
    end function measure_of

    elemental real(dp) function inclined(measure) result(theta)
        real(dp), intent(in) :: measure
        theta = merge(2 * atan(measure), pi - 2 * atan(2 - measure), measure <= 1)
    end function inclined

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, last, found)
        class(lane_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(motion_t), intent(in) :: last !! the motion at the end
        type(measures_t), intent(inout) :: found !! what is measured of the case
        integer :: i
        select case (self%action)
        case (stop_motion)
            found%event_occurred = self%left(lane) <= 0
        case (keep_extremes)
            call keep(self, run, run%now%state, no_slope, [(i == lane, i=1, lanes)])
            found%least(self%of%quantity) = self%found(lane)%least(self%of%quantity)
            found%largest(self%of%quantity) = self%found(lane)%largest(self%of%quantity)
        case (count_turns)
            found%turns = self%found(lane)%turns
            associate (turns => found%turns)
                turns%start(4) = inclined(turns%start(4))
                do i = upper, lower
                    if (.not. turns%of(i)%theta(1) > turns%of(i)%theta(2)) turns%of(i)%theta = inclined(turns%of(i)%theta)
                end do
                call turns%count_end(last, last%omega_rate)
            end associate
        end select
        self%sign(lane) = 0
    end subroutine finish

end module spintop_lane_watch
