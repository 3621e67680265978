!> Events that end the motions in lanes: the n-th passage of a value by an angle, by the rate of cos(theta), or by a form of the
!> angular velocity and of the vertical in the axes of the body: a component, a height, a momentum, an energy.
module spintop_stop_lanes
    use spintop_kinds, only: dp, pi
    use spintop_body, only: body_t
    use spintop_constancy, only: driven_rate
    use spintop_formulation, only: max_series_order
    use spintop_instants, only: greatest_fall_rate, time_of_start
    use spintop_lane_series, only: rows
    use spintop_motion, only: motion_t
    use spintop_quantities, only: axis_height_rate
    use spintop_root_monitor, only: find_height_rates, of_interval, root_monitor_t, rounding
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: stop_lanes_t

    !> What may pass a value: nothing; phi and psi, in the order of `angles_at`; the rate of cos(theta), by zero; theta;
    !> components of the angular velocity and of the vertical in body axes; the height of the centre of mass; energies and
    !> momenta. The last ones, from `passing_spin_momentum` on, are those of a body without effects.
    integer, parameter, public :: passing_nothing = 0, passing_phi = 1, passing_psi = 2, passing_turning = 3, &
        passing_theta = 4, passing_omega = 5, &
        passing_vertical = 6, passing_centre_height = 7, passing_kinetic_energy = 8, passing_spin_momentum = 9, &
            passing_vertical_momentum = 10, &
        passing_potential_energy = 11, passing_energy = 12

    !> A value so close to its level at the start, relatively, is at the level.
    real(dp), parameter :: start_rounding = 16 * epsilon(1.0_dp)

    !> Ends a motion at the n-th event. Handed over before the other monitors, which then see no more than the motion up to
    !> there.
    type, extends(root_monitor_t) :: stop_lanes_t
        !> What passes, one of those above, and which component of a vector.
        integer :: passing = passing_nothing, component = 1
        !> The value, in the unit of what passes it; and which passages count: those rising, those falling.
        real(dp) :: level = 0
        logical :: rising = .true., falling = .true.
        !> Number of the event that ends the motion.
        integer :: wanted = 1
        !> An angle in any turn; full turns from the start instead of the angle, each of which is met once, either way.
        logical :: every_turn = .false., turn_by_turn = .false.
        !> Whether the event occurred, of each case.
        logical, allocatable :: event_occurred(:)
        integer, private :: left(lanes) = 0
        !> Times up to which a passage is the start itself, s.
        real(dp), private :: started(lanes) = 0
        !> The level of an angle, and the full turns so far.
        real(dp), private :: goal(lanes) = 0, turns(lanes) = 0
        !> The form and its level: linear in omega and Gamma, and in the products omega_i omega_i and omega_i Gamma_i.
        real(dp), private :: linear(lanes, 6) = 0, squares(lanes, 3) = 0, products(lanes, 3) = 0, threshold(lanes) = 0
        !> What its rounding is relative to, by powers of the angular velocity; the rows it contains; whether it is linear.
        real(dp), private :: sizes(lanes, 0:2) = 0
        logical, private :: contains_row(6) = .false., is_linear = .true.
    contains
        procedure :: prepare
        procedure :: begin
        procedure :: find_polynomials
        procedure :: record_roots
        procedure :: finish
    end type stop_lanes_t

contains

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(stop_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%event_occurred)) deallocate (self%event_occurred)
        allocate (self%event_occurred(cases), source=.false.)
        self%sign = 0
    end subroutine prepare

    !> A case begins in a lane. The start itself is no event.
    subroutine begin(self, run, lane, body, start)
        class(stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: value
        select case (self%passing)
        case (passing_phi, passing_psi)
            call begin_angle(self, lane, start%angle(merge(1, 3, self%passing == passing_phi)), run%now%state(lane, 4:5), value)
        case (passing_turning)
            value = axis_height_rate(start)
            self%driven(lane) = driven_rate(greatest_fall_rate(body), start%omega)
        case default
            call begin_form(self, lane, body, run%now%state(lane, 1:3), run%now%state(lane, 4:6), value)
        end select
        self%sign(lane) = merge(sign(1.0_dp, value), 0.0_dp, abs(value) > 0)
        self%left(lane) = self%wanted
        self%started(lane) = start%t + time_of_start(body, start)
    end subroutine begin

    !> An angle begins at a value: its sine from the level, or zero where it is at the level, or in a pole.
    pure subroutine begin_angle(self, lane, angle, gamma, value)
        class(stop_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: angle, gamma(2)
        real(dp), intent(out) :: value
        real(dp) :: distance, half_turns
        self%turns(lane) = 0
        self%goal(lane) = merge(angle, self%level, self%turn_by_turn)
        distance = angle - self%goal(lane)
        half_turns = anint(distance / pi)
        distance = distance - half_turns * pi
        value = 0
        if (.not. sum(abs(gamma)) > 0) return
        if (abs(distance) <= start_rounding * (abs(angle) + abs(self%goal(lane)))) return
        value = sign(1.0_dp, distance) * (1 - 2 * modulo(half_turns, 2.0_dp))
    end subroutine begin_angle

    !> The form of a body, and its value above the level at the start, zero where it is at the level. Where theta rises, -Gamma3
    !> does.
    pure subroutine begin_form(self, lane, body, w, g, value)
        class(stop_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: w(3), g(3) !! angular velocity, vertical
        real(dp), intent(out) :: value
        self%linear(lane, :) = 0
        self%squares(lane, :) = 0
        self%products(lane, :) = 0
        self%threshold(lane) = self%level
        select case (self%passing)
        case (passing_theta)
            self%linear(lane, 6) = -1
            self%threshold(lane) = -cos(self%level)
        case (passing_omega)
            self%linear(lane, self%component) = 1
        case (passing_vertical)
            self%linear(lane, 3 + self%component) = 1
        case (passing_centre_height)
            self%linear(lane, 4:6) = body%centre_of_mass
        case (passing_spin_momentum)
            self%linear(lane, 3) = body%inertia(3)
        case (passing_vertical_momentum)
            self%products(lane, :) = body%inertia
        end select
        if (any(self%passing == [passing_potential_energy, passing_energy])) self%linear(lane, 4:6) = body%weight_moment()
        if (any(self%passing == [passing_kinetic_energy, passing_energy])) self%squares(lane, :) = body%inertia / 2
        self%contains_row = any(abs(self%linear) > 0, 1)
        self%is_linear = .not. (any(self%squares > 0) .or. any(self%products > 0))
        ! Each component of a vector has the rounding of the whole vector.
        self%sizes(lane, :) = [abs(self%threshold(lane)) + sum(abs(self%linear(lane, 4:6))), &
                               sum(abs(self%linear(lane, 1:3))) + sum(self%products(lane, :)), sum(self%squares(lane, :))]
        value = sum(self%linear(lane, :) * [w, g]) + sum(self%squares(lane, :) * w**2) + sum(self%products(lane, :) * w * g) &
            - self%threshold(lane)
        if (abs(value) <= start_rounding * (self%sizes(lane, 0) + self%sizes(lane, 2) * sum(w**2) &
                                            + self%sizes(lane, 1) * sqrt(sum(w**2)))) value = 0
    end subroutine begin_form

    !> What passes zero: a form less its level; the rate of Gamma3; or sin(theta) times the sine of the distance of an angle
    !> from its level, which is smooth at the poles.
    subroutine find_polynomials(self, run, degree, a, noise)
        class(stop_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        real(dp) :: square(lanes)
        degree = run%order
        select case (self%passing)
        case (passing_phi, passing_psi)
            if (self%passing == passing_psi) then
                call find_spin_polynomials(degree, run%c, cos(self%goal), sin(self%goal), a)
            else
                call find_azimuth_polynomials(degree, run%c, run%now%side_last * cos(self%goal), sin(self%goal), a)
            end if
            ! What cancels in the first term is rounding.
            noise = rounding * (abs(run%c(:, 4, 0)) + abs(run%c(:, 5, 0)))
        case (passing_turning)
            degree = run%order - 1
            call find_height_rates(run%order, run%c, self%driven, degree, a, noise)
        case default
            call find_form(self, degree, run%c, a)
            a(:, 0) = a(:, 0) - self%threshold
            square = run%c(:, 1, 0)**2 + run%c(:, 2, 0)**2 + run%c(:, 3, 0)**2
            noise = rounding * (self%sizes(:, 0) + self%sizes(:, 2) * square + self%sizes(:, 1) * sqrt(square))
        end select
        call of_interval(degree, run%power, a)
    end subroutine find_polynomials

    !> Of psi at the level l: Gamma1 cos(l) - Gamma2 sin(l), with (Gamma1, Gamma2) = sin(theta) (sin(psi), cos(psi)).
    pure subroutine find_spin_polynomials(degree, c, cosine, sine, a)
        integer, intent(in) :: degree
        real(dp), intent(in) :: c(lanes, rows, 0:degree), cosine(lanes), sine(lanes)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        integer :: i, k
        do k = 0, degree
            !$omp simd
            do i = 1, lanes
                a(i, k) = c(i, 4, k) * cosine(i) - c(i, 5, k) * sine(i)
            end do
        end do
    end subroutine find_spin_polynomials

    !> Of phi = s (xi - psi) at the level l, with the series of cos(xi) and sin(xi): s cos(l) (Gamma2 sin(xi) - Gamma1 cos(xi))
    !> - sin(l) (Gamma2 cos(xi) + Gamma1 sin(xi)), of which `cosine` is s cos(l) and `sine` is sin(l).
    pure subroutine find_azimuth_polynomials(degree, c, cosine, sine, a)
        integer, intent(in) :: degree
        real(dp), intent(in) :: c(lanes, rows, 0:degree), cosine(lanes), sine(lanes)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes, 0:max_series_order) :: of_cosine, of_sine, xi_rate, with_cosine, with_sine
        real(dp) :: first, second
        integer :: i, j, k
        with_cosine(:, 0) = cos(c(:, 7, 0))
        with_sine(:, 0) = sin(c(:, 7, 0))
        xi_rate(:, 0) = 0
        do k = 0, degree
            !$omp simd
            do i = 1, lanes
                xi_rate(i, k) = k * c(i, 7, k)
                of_cosine(i, k) = -cosine(i) * c(i, 4, k) - sine(i) * c(i, 5, k)
                of_sine(i, k) = cosine(i) * c(i, 5, k) - sine(i) * c(i, 4, k)
            end do
        end do
        do k = 1, degree
            !$omp simd private(first, second, j)
            do i = 1, lanes
                first = 0
                second = 0
                do j = 1, max(k, 1)
                    first = first + xi_rate(i, j) * with_sine(i, k - j)
                    second = second + xi_rate(i, j) * with_cosine(i, k - j)
                end do
                with_cosine(i, k) = -first / k
                with_sine(i, k) = second / k
            end do
        end do
        do k = 0, degree
            !$omp simd private(first, second, j)
            do i = 1, lanes
                first = 0
                second = 0
                do j = 0, max(k, 0)
                    first = first + with_cosine(i, j) * of_cosine(i, k - j)
                    second = second + with_sine(i, j) * of_sine(i, k - j)
                end do
                a(i, k) = first + second
            end do
        end do
    end subroutine find_azimuth_polynomials

    !> The series of the form.
    pure subroutine find_form(self, degree, c, a)
        class(stop_lanes_t), intent(in) :: self
        integer, intent(in) :: degree
        real(dp), intent(in) :: c(lanes, rows, 0:degree)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        integer :: i, k, m
        a(:, :degree) = 0
        do m = 1, 6
            if (.not. self%contains_row(m)) cycle
            do k = 0, degree
                !$omp simd
                do i = 1, lanes
                    a(i, k) = a(i, k) + self%linear(i, m) * c(i, m, k)
                end do
            end do
        end do
        if (self%is_linear) return
        do m = 1, 3
            call add_product(degree, self%squares(:, m), c, m, m, a)
            call add_product(degree, self%products(:, m), c, m, 3 + m, a)
        end do
    end subroutine find_form

    !> Adds the product of two rows of the series.
    pure subroutine add_product(degree, factor, c, x, y, a)
        integer, intent(in) :: degree, x, y
        real(dp), intent(in) :: factor(lanes), c(lanes, rows, 0:degree)
        real(dp), intent(inout) :: a(lanes, 0:max_series_order)
        real(dp) :: total
        integer :: i, j, k
        if (.not. any(abs(factor) > 0)) return
        do k = 0, degree
            !$omp simd private(total, j)
            do i = 1, lanes
                total = 0
                do j = 0, max(k, 0)
                    total = total + c(i, x, j) * c(i, y, k - j)
                end do
                a(i, k) = a(i, k) + factor(i) * total
            end do
        end do
    end subroutine add_product

    !> Records passages, and ends the lanes that have enough.
    subroutine record_roots(self, run, u, slope)
        class(stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: t
        logical :: rises, falls
        integer :: lane
        ! Of full turns both senses count.
        rises = self%rising .or. self%turn_by_turn
        falls = self%falling .or. self%turn_by_turn
        do lane = 1, lanes
            if (.not. ((slope(lane) > 0 .and. rises) .or. (slope(lane) < 0 .and. falls))) cycle
            if (self%is_noise(lane)) cycle
            t = run%now%t_last(lane) + u(lane) * (run%now%t(lane) - run%now%t_last(lane))
            if (self%left(lane) <= 0 .or. t <= self%started(lane)) cycle
            if (.not. counts(self, run, lane, u(lane))) cycle
            self%left(lane) = self%left(lane) - 1
            if (self%left(lane) == 0) call run%stop(lane, t)
        end do
    end subroutine record_roots

    !> Whether a root is a passage of the level: not by the opposite angle, or in another turn.
    logical function counts(self, run, lane, u)
        class(stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        real(dp), intent(in) :: u !! the root, as a fraction of the step
        real(dp) :: angles(2), distance, turns
        counts = .true.
        if (.not. any(self%passing == [passing_phi, passing_psi])) return
        associate (now => run%now)
            angles = run%angles_at(lane, now%t_last(lane) + u * (now%t(lane) - now%t_last(lane)))
        end associate
        distance = angles(self%passing) - self%goal(lane)
        turns = anint(distance / (2 * pi))
        counts = abs(distance - 2 * pi * turns) < pi / 2
        if (.not. counts .or. self%every_turn) return
        if (self%turn_by_turn) then
            counts = nint(abs(turns) - self%turns(lane)) == 1
            if (counts) self%turns(lane) = abs(turns)
        else
            counts = .not. abs(turns) > 0
        end if
    end function counts

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        self%event_occurred(case) = self%left(lane) <= 0
    end subroutine finish

end module spintop_stop_lanes
