!> Watches a quantity along the motions in lanes: ends a motion where it passes a level, keeps its extremes, or counts turning
!> points.
!>
!> All are roots of a polynomial in each step, which is zero where a quantity of `spintop_measures` passes its level, or where its
!> slope is zero. Values at states are those of single motions as well. One root in a lane is found by Newton's method in
!> all lanes at once, several in the lanes that have them. A root at the end of a step is found once: the sign there is carried
!> to the next.
module spintop_lane_watch
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_bernstein, only: find_changes, find_roots, most_roots, multiply, multiply_slopes, refine_root, rounding, square
    use spintop_body, only: body_t
    use spintop_event, only: driven_rate, greatest_fall_rate, margin, time_of_start
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: lane_body_t, per_binomial
    use spintop_kinds, only: dp, cross, pi, is_finite
    use spintop_lane_series, only: numerator, parts, rows
    use spintop_lane_steps, only: rows_at
    use spintop_measures, only: lower, measures_t, upper, watch_centre_height, watch_energy, watch_kinetic_energy, &
        watch_nothing, watch_nutation_rate, watch_omega, watch_phi, watch_potential_energy, watch_precession_rate, watch_psi, &
        watch_spin_momentum, watch_theta, watch_total_force, watch_turning, watch_vertical, watch_vertical_force, &
        watch_vertical_momentum
    use spintop_motion, only: motion_t, passages_t
    use spintop_pole_passages, only: half_turns, through_pole
    use spintop_poles, only: polar_precession_rate
    use spintop_quantities, only: angular_acceleration
    use spintop_taylor_lanes, only: lane_monitor_t, lanes, taylor_lanes_t
    implicit none
    private
    public :: lane_watch_t, watched_t

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

    !> Degree of the slope of the squared force, as a share of the order of the states, and at least: the products cost as
    !> the square of it. Where the slope is off by e, relative to its size, an extreme is off by e^2 only. Not so for
    !> rates of angles, which peak next to a pole.
    real(dp), parameter :: degree_share = 0.7_dp
    integer, parameter :: least_degree = 12

    !> What is watched: a quantity, the component if it is a vector, and the level that it passes, in its unit.
    type :: watched_t
        integer :: quantity = watch_nothing, component = 1
        real(dp) :: level = 0
        !> The quantity as a form: linear in three rows of the series from `row` on, those of omega or of Gamma, and in the products
        !> omega_i omega_i and omega_i Gamma_i; and the level of the form.
        integer, private :: row = 4
        real(dp), dimension(lanes, 3), private :: linear = 0, squares = 0, products = 0
        real(dp), private :: threshold(lanes) = 0
        logical, private :: is_linear = .true.
        !> What its rounding is relative to, by powers of the angular velocity; what the weight adds to that in a radian
        !> (`driven_rate`), rad/s.
        real(dp), private :: sizes(lanes, 0:2) = 0, driven(lanes) = 0
        !> Of forces: mass and gravity; unit vectors, two beside the centre of mass and one along it, and its distance.
        real(dp), private :: mass(lanes) = 1, gravity(lanes) = 0, axes(lanes, 3, 3) = 0, arm(lanes) = 0
    contains
        procedure :: set_lane
        procedure :: find_polynomials
        procedure :: find_values
    end type watched_t

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

    interface
        !> The slope of the squared force over the mass, over the step as the unit interval, and the square where it begins.
        pure subroutine c_find_force_slopes(degree, axes, arm, gravity, power, c, slope, first) &
            bind(C, name='spintop_find_force_slopes')
            import :: c_double, c_int
            integer(c_int), value :: degree
            real(c_double), intent(in) :: axes(*), arm(*), gravity(*), power(*), c(*)
            real(c_double), intent(inout) :: slope(*), first(*)
        end subroutine c_find_force_slopes
    end interface

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

        if (self%action == keep_extremes) then
            call keep_roots(self, run, u, slope)
            return
        end if
        ! A root is one of noise if since the one before, or before that one, the polynomial was within the noise of the method.
        before = values_at(degree, a, (last + u) / 2)
        behind = values_at(degree, a, (u + 1) / 2)
        !$omp simd private(is_root, is_near)
        do i = 1, lanes
            is_root = abs(slope(i)) > 0
            is_near = max(self%far(i), abs(before(i))) <= noise(i) * (run%method_noise / rounding)
            is_noise(i) = is_root .and. (is_near .or. self%was_noise(i))
            self%was_noise(i) = merge(is_near, self%was_noise(i), is_root)
            self%far(i) = merge(abs(behind(i)), self%far(i), is_root)
            last(i) = merge(u(i), last(i), is_root)
        end do
        if (self%action == stop_motion) call pass(self, run, u, slope, is_noise)
        if (self%action == count_turns) call count_roots(self, run, u, slope, is_noise)
    end subroutine act

    !> Values of the polynomials.
    pure function values_at(degree, a, u) result(x)
        integer, intent(in) :: degree
        real(dp), intent(in) :: a(lanes, 0:max_series_order), u(lanes)
        real(dp) :: x(lanes)
        integer :: k
        x = a(:, degree)
        do k = degree - 1, 0, -1
            x = x * u + a(:, k)
        end do
    end function values_at

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
        call rows_at(parts, run%order, run%c, t, x)
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
        call rows_at(parts, run%order, run%c, t, x)
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
        call rows_at(parts, run%order, run%c, h, x)
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

    !> The quantity of a body in a lane, and its level.
    pure subroutine set_lane(self, lane, body, omega, level)
        class(watched_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        real(dp), intent(in) :: omega(3), level !! angular velocity at the start, rad/s, and the level
        real(dp) :: linear(3), squares(3), products(3), axes(3, 3), other(3)

        linear = 0
        squares = 0
        products = 0
        self%threshold(lane) = level
        select case (self%quantity)
        case (watch_phi, watch_psi)
            ! (Gamma1, Gamma2) = sin(theta) (sin(psi), cos(psi)): sin(theta) times the sine of the distance of psi from the level.
            linear(:2) = [cos(level), -sin(level)]
            self%threshold(lane) = 0
        case (watch_turning)
            linear(3) = 1
            self%driven(lane) = driven_rate(greatest_fall_rate(body), omega)
        case (watch_theta)
            ! Where theta rises, -Gamma3 does.
            linear(3) = -1
            self%threshold(lane) = -cos(level)
        case (watch_omega, watch_vertical)
            linear(self%component) = 1
        case (watch_spin_momentum)
            linear(3) = body%inertia(3)
        case (watch_vertical_momentum)
            products = body%inertia
        case (watch_potential_energy, watch_energy)
            linear = body%weight_moment()
        case (watch_centre_height, watch_vertical_force, watch_total_force)
            linear = body%centre_of_mass
        end select
        if (any(self%quantity == [watch_kinetic_energy, watch_energy])) squares = body%inertia / 2
        self%is_linear = .not. any([squares, products] > 0)
        self%row = merge(1, 4, any(self%quantity == [watch_omega, watch_spin_momentum]))
        self%linear(lane, :) = linear
        self%squares(lane, :) = squares
        self%products(lane, :) = products
        ! Each component of a vector has the rounding of the whole vector.
        self%sizes(lane, :) = [abs(self%threshold(lane)), sum(products), sum(squares)]
        associate (size => self%sizes(lane, merge(1, 0, self%row == 1)))
            size = size + sum(abs(linear))
        end associate
        self%mass(lane) = body%mass
        self%gravity(lane) = body%gravity
        if (self%quantity /= watch_total_force) return
        ! Two unit vectors beside the centre of mass and that along it, at right angles and right-handed.
        self%arm(lane) = norm2(body%centre_of_mass)
        axes(:, 3) = [0.0_dp, 0.0_dp, 1.0_dp]
        if (self%arm(lane) > 0) axes(:, 3) = body%centre_of_mass / self%arm(lane)
        other = 0
        other(minloc(abs(axes(:, 3)), dim=1)) = 1
        axes(:, 1) = cross(axes(:, 3), other)
        axes(:, 1) = axes(:, 1) / norm2(axes(:, 1))
        axes(:, 2) = cross(axes(:, 3), axes(:, 1))
        self%axes(lane, :, :) = axes
    end subroutine set_lane

    !> The polynomials over the last step as the unit interval, and how much they are off beside the rounding of their terms: of
    !> the quantity less its level; of sin(theta) times the sine of the distance of an angle from its level, which is smooth at
    !> the poles; or of the slope of the quantity times what does not change its sign.
    subroutine find_polynomials(self, run, of_slope, degree, a, noise)
        class(watched_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        logical, intent(in) :: of_slope !! whether the roots are extremes, not passages of the level
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes) !! coefficients, and a bound of further errors
        real(dp) :: first(lanes)

        degree = run%order
        if (of_slope) degree = degree - 1
        noise = 0
        select case (self%quantity)
        case (watch_phi)
            call find_azimuth(run%order, run%c, run%now%side_last * self%linear(:, 1), -self%linear(:, 2), run%power, a)
        case (watch_precession_rate, watch_nutation_rate)
            degree = run%order - 2
            call find_rate_slopes(self%quantity, run%order, run%c, run%power, a)
        case (watch_total_force)
            degree = min(max(nint(degree_share * run%order), least_degree), run%order - 2)
            call c_find_force_slopes(int(degree, c_int), self%axes, self%arm, self%gravity, run%power, run%c, a, first)
            ! The square of the force itself is known to rounding.
            noise = rounding * first
        case default
            ! Of the rate of Gamma3, and of the force less the weight, which is the mass times (Gamma.r)''.
            if (self%quantity == watch_turning) degree = degree - 1
            if (self%quantity == watch_vertical_force) degree = degree - 2
            call find_form(self, run%order, run%c, degree, run%power, a)
        end select
        if (.not. of_slope) call find_noise(self, run%c(:, :, 0), noise)
    end subroutine find_polynomials

    !> The noise of a quantity: attitude and angular velocity are known to rounding (`spintop_event`).
    pure subroutine find_noise(self, c, noise)
        class(watched_t), intent(in) :: self
        real(dp), intent(in) :: c(lanes, rows)
        real(dp), intent(out) :: noise(lanes)
        real(dp) :: tilt, across
        integer :: i
        select case (self%quantity)
        case (watch_phi, watch_psi)
            ! What cancels in the first term is rounding.
            noise = rounding * (abs(c(:, 4)) + abs(c(:, 5)))
        case (watch_turning)
            ! Of Gamma and omega across body z. Not by a function of another module, which costs as much as the series.
            !$omp simd private(tilt, across)
            do i = 1, lanes
                tilt = abs(c(i, 4)) + abs(c(i, 5))
                across = abs(c(i, 1)) + abs(c(i, 2))
                noise(i) = rounding * (across + (tilt + rounding) * (across + self%driven(i)))
            end do
        case default
            noise = c(:, 1)**2 + c(:, 2)**2 + c(:, 3)**2
            noise = rounding * (self%sizes(:, 0) + self%sizes(:, 2) * noise + self%sizes(:, 1) * sqrt(noise))
        end select
    end subroutine find_noise

    !> The form, or of lower degree its derivatives: first its linear part. Here and below the series come as an array of known
    !> shape: behind a pointer they would be read number by number.
    pure subroutine find_form(self, order, c, degree, power, a)
        class(watched_t), intent(in) :: self
        integer, intent(in) :: order, degree
        real(dp), intent(in) :: c(lanes, rows, 0:order), power(lanes, 0:order)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes, 0:max_series_order) :: w, x, product
        real(dp) :: of_derivative
        integer :: i, k, m, n
        n = order - degree
        associate (factor => self%linear, row => self%row)
            do k = 0, degree
                of_derivative = 1
                do m = 1, n
                    of_derivative = of_derivative * (k + m)
                end do
                !$omp simd
                do i = 1, lanes
                    a(i, k) = of_derivative * (factor(i, 1) * c(i, row, k + n) + factor(i, 2) * c(i, row + 1, k + n) &
                                               + factor(i, 3) * c(i, row + 2, k + n)) * power(i, k)
                end do
            end do
        end associate
        do m = 1, merge(0, 3, self%is_linear)
            w(:, :order) = c(:, m, :) * power
            do i = 0, order
                x(:, i) = self%squares(:, m) * w(:, i) + self%products(:, m) * c(:, 3 + m, i) * power(:, i)
            end do
            call multiply(order, w, x, product)
            a(:, :order) = a(:, :order) + product(:, :order)
        end do
        if (degree == order) a(:, 0) = a(:, 0) - self%threshold
    end subroutine find_form

    !> Of phi = s (xi - psi) at the level l, with the series of cos(xi) and sin(xi): s cos(l) (Gamma2 sin(xi) - Gamma1 cos(xi))
    !> - sin(l) (Gamma2 cos(xi) + Gamma1 sin(xi)), of which `cosine` is s cos(l) and `sine` is sin(l).
    pure subroutine find_azimuth(order, c, cosine, sine, power, a)
        integer, intent(in) :: order
        real(dp), intent(in) :: c(lanes, rows, 0:order), cosine(lanes), sine(lanes), power(lanes, 0:order)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes, 0:max_series_order) :: xi_rate, cosines, sines, x, y
        real(dp) :: first, second
        integer :: i, j, k
        cosines(:, 0) = cos(c(:, 7, 0))
        sines(:, 0) = sin(c(:, 7, 0))
        do k = 0, order
            !$omp simd
            do i = 1, lanes
                xi_rate(i, k) = k * c(i, 7, k) * power(i, k)
                x(i, k) = (-cosine(i) * c(i, 4, k) - sine(i) * c(i, 5, k)) * power(i, k)
                y(i, k) = (cosine(i) * c(i, 5, k) - sine(i) * c(i, 4, k)) * power(i, k)
            end do
        end do
        do k = 1, order
            !$omp simd private(first, second, j)
            do i = 1, lanes
                first = 0
                second = 0
                do j = 1, max(k, 1)
                    first = first + xi_rate(i, j) * sines(i, k - j)
                    second = second + xi_rate(i, j) * cosines(i, k - j)
                end do
                cosines(i, k) = -first / k
                sines(i, k) = second / k
            end do
        end do
        call multiply(order, cosines, x, a)
        call multiply(order, sines, y, x)
        a(:, :order) = a(:, :order) + x(:, :order)
    end subroutine find_azimuth

    !> Of phi' = n/d, where n = Gamma1 omega1 + Gamma2 omega2 and d = Gamma1^2 + Gamma2^2, the slope times d^2: smooth at the
    !> poles. Of theta'^2 = w^2/d with w = Gamma3' it is 2 w (w' d + Gamma3 w^2)/d^2: the roots of w, turning points, are none
    !> of the largest; the other factor is smooth at the poles.
    pure subroutine find_rate_slopes(quantity, order, c, power, a)
        integer, intent(in) :: quantity, order
        real(dp), intent(in) :: c(lanes, rows, 0:order), power(lanes, 0:order)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes, 0:max_series_order) :: height, d, x, w, y
        integer :: degree, k
        degree = order - 2
        height(:, :order) = c(:, 6, :) * power
        ! The changes of d are those of -Gamma3^2. The terms of Gamma3 are as small next to a pole as those of what turns there,
        ! but for the first.
        call square(degree + 1, height, d)
        d(:, 1:degree + 1) = -d(:, 1:degree + 1)
        d(:, 0) = c(:, 4, 0)**2 + c(:, 5, 0)**2
        if (quantity == watch_precession_rate) then
            x(:, :degree + 1) = c(:, numerator, :degree + 1) * power(:, :degree + 1)
            call multiply_slopes(degree, x, d, a)
            return
        end if
        do k = 0, degree + 1
            w(:, k) = (k + 1) * height(:, k + 1)
        end do
        do k = 0, degree
            x(:, k) = (k + 1) * w(:, k + 1)
        end do
        call multiply(degree, x, d, a)
        call square(degree, w, x)
        call multiply(degree, height, x, y)
        a(:, :degree) = a(:, :degree) + y(:, :degree)
    end subroutine find_rate_slopes

    !> Values at states, of quantities whose extremes are watched: rad/s, m or N; of theta', which has two signs at a pole, the
    !> magnitude.
    pure subroutine find_values(self, body, x, value)
        class(watched_t), intent(in) :: self
        type(lane_body_t), intent(in) :: body !! the bodies
        real(dp), intent(in) :: x(lanes, parts) !! states
        real(dp), intent(out) :: value(lanes) !! values
        real(dp) :: f(lanes, 3), sine
        integer :: i
        select case (self%quantity)
        case (watch_precession_rate)
            !$omp simd
            do i = 1, lanes
                value(i) = (x(i, 4) * x(i, 1) + x(i, 5) * x(i, 2)) / max(x(i, 4)**2 + x(i, 5)**2, tiny(sine))
            end do
        case (watch_nutation_rate)
            !$omp simd private(sine)
            do i = 1, lanes
                sine = sqrt(x(i, 4)**2 + x(i, 5)**2)
                value(i) = merge(abs(x(i, 4) * x(i, 2) - x(i, 5) * x(i, 1)) / max(sine, tiny(sine)), &
                                 sqrt(x(i, 1)**2 + x(i, 2)**2), sine > through_pole)
            end do
        case (watch_centre_height)
            value = 0
            do i = 1, 3
                value = value + self%linear(:, i) * x(:, 3 + i)
            end do
        case (watch_vertical_force)
            call find_forces(body, self%linear, self%gravity, x, f)
            value = self%mass * (f(:, 1) * x(:, 4) + f(:, 2) * x(:, 5) + f(:, 3) * x(:, 6))
        case (watch_total_force)
            call find_forces(body, self%linear, self%gravity, x, f)
            value = self%mass * sqrt(f(:, 1)**2 + f(:, 2)**2 + f(:, 3)**2)
        end select
    end subroutine find_values

    !> Support forces over the masses in body axes, at states: with the centre of mass r in body axes,
    !>
    !>     f = omega' x r + omega (omega.r) - r omega^2 + g Gamma.
    !>
    !> Its vertical part is g + (Gamma.r)''. With omega = (u, v, w) in the axes beside r and along it, in these
    !>
    !>     f = |r| (w u + v', w v - u', -u^2 - v^2) + g Gamma,
    !>
    !> of which `c_find_force_slopes` finds the slope of the square.
    pure subroutine find_forces(of, r, g, x, f)
        type(lane_body_t), intent(in) :: of
        real(dp), intent(in) :: r(lanes, 3), g(lanes), x(lanes, parts)
        real(dp), intent(out) :: f(lanes, 3)
        real(dp) :: b1, b2, b3, along, rate2
        integer :: i
        !$omp simd private(b1, b2, b3, along, rate2)
        do i = 1, lanes
            ! The angular acceleration by Euler's equations, see `expand`.
            b1 = of%coupling(i, 1) * x(i, 2) * x(i, 3) - of%decay(i, 1) * x(i, 1) &
                + (of%pull(i, 1) * x(i, 5) - of%swing(i, 1) * x(i, 6))
            b2 = of%coupling(i, 2) * x(i, 3) * x(i, 1) - of%decay(i, 2) * x(i, 2) &
                + (of%pull(i, 2) * x(i, 6) - of%swing(i, 2) * x(i, 4))
            b3 = of%coupling(i, 3) * x(i, 1) * x(i, 2) - of%decay(i, 3) * x(i, 3) &
                + (of%pull(i, 3) * x(i, 4) - of%swing(i, 3) * x(i, 5))
            along = x(i, 1) * r(i, 1) + x(i, 2) * r(i, 2) + x(i, 3) * r(i, 3)
            rate2 = x(i, 1)**2 + x(i, 2)**2 + x(i, 3)**2
            f(i, 1) = b2 * r(i, 3) - b3 * r(i, 2) + x(i, 1) * along - r(i, 1) * rate2 + g(i) * x(i, 4)
            f(i, 2) = b3 * r(i, 1) - b1 * r(i, 3) + x(i, 2) * along - r(i, 2) * rate2 + g(i) * x(i, 5)
            f(i, 3) = b1 * r(i, 2) - b2 * r(i, 1) + x(i, 3) * along - r(i, 3) * rate2 + g(i) * x(i, 6)
        end do
    end subroutine find_forces

end module spintop_lane_watch
