!> Passages of an azimuth or of a spin angle that end the motions in lanes.
module spintop_angle_stop_lanes
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_kinds, only: dp, pi
    use spintop_lane_series, only: rows
    use spintop_motion, only: motion_t
    use spintop_root_watch, only: of_interval, rounding
    use spintop_stop_lanes, only: stop_lanes_t
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: angle_stop_lanes_t, of_phi, of_psi

    !> The angles, in the order of `angles_at`.
    integer, parameter :: of_phi = 1, of_psi = 2
    !> An angle so close to its level at the start, relatively, is at the level.
    real(dp), parameter :: start_rounding = 16 * epsilon(1.0_dp)

    !> Ends a motion at the n-th passage: of an angle, of that in any turn, or of full turns from the start, each of
    !> which is met once, either way. What passes zero is sin(theta) times the sine of the distance from the level,
    !> a polynomial of the step: smooth at the poles. `set_angle`, then hand it over.
    type, extends(stop_lanes_t) :: angle_stop_lanes_t
        integer, private :: which = of_psi
        real(dp), private :: angle = 0
        logical, private :: every_turn = .false., turn_by_turn = .false.
        !> The level, and the full turns so far.
        real(dp), private :: goal(lanes) = 0, turns(lanes) = 0
    contains
        procedure :: set_angle
        procedure :: begin
        procedure :: find_polynomials
        procedure :: counts
    end type angle_stop_lanes_t

contains

    !> The n-th passage of an angle.
    pure subroutine set_angle(self, which, angle, every_turn, turn_by_turn, rising, falling, n)
        class(angle_stop_lanes_t), intent(inout) :: self
        integer, intent(in) :: which !! `of_phi` or `of_psi`
        real(dp), intent(in) :: angle !! rad
        logical, intent(in) :: every_turn !! the angle in any turn
        logical, intent(in) :: turn_by_turn !! full turns from the start, instead of the angle
        logical, intent(in) :: rising, falling !! which passages of the angle count; of full turns, both do
        integer, intent(in) :: n !! number of the event that ends the motion
        self%which = which
        self%angle = angle
        self%every_turn = every_turn
        self%turn_by_turn = turn_by_turn
        call self%count_passages(rising .or. turn_by_turn, falling .or. turn_by_turn, n)
    end subroutine set_angle

    !> A case begins in a lane. The start itself is no event.
    subroutine begin(self, run, lane, body, start)
        class(angle_stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: angle, distance, half_turns
        call self%stop_lanes_t%begin(run, lane, body, start)
        angle = start%angle(merge(1, 3, self%which == of_phi))
        self%turns(lane) = 0
        self%goal(lane) = merge(angle, self%angle, self%turn_by_turn)
        distance = angle - self%goal(lane)
        half_turns = anint(distance / pi)
        distance = distance - half_turns * pi
        self%sign(lane) = 0
        if (.not. sum(abs(run%now%state(lane, 4:5))) > 0) return
        if (abs(distance) <= start_rounding * (abs(angle) + abs(self%goal(lane)))) return
        self%sign(lane) = sign(1.0_dp, distance) * (1 - 2 * modulo(half_turns, 2.0_dp))
    end subroutine begin

    !> sin(theta) sin(psi - level) of (Gamma1, Gamma2) = sin(theta) (sin(psi), cos(psi)); or that with phi =
    !> s (xi - psi), with the series of cos(xi) and sin(xi).
    subroutine find_polynomials(self, run, degree, a, noise)
        class(angle_stop_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        real(dp), dimension(lanes) :: cosine, sine
        degree = run%order
        cosine = cos(self%goal)
        sine = sin(self%goal)
        if (self%which == of_psi) then
            call find_spin_polynomials(degree, run%c, cosine, sine, a)
        else
            call find_azimuth_polynomials(degree, run%c, run%now%side_last * cosine, sine, a)
        end if
        call of_interval(degree, run%power, a)
        ! What cancels in the first term is rounding.
        noise = rounding * (abs(run%c(:, 4, 0)) + abs(run%c(:, 5, 0)))
    end subroutine find_polynomials

    !> Gamma1 cos(l) - Gamma2 sin(l).
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

    !> s cos(l) (Gamma2 sin(xi) - Gamma1 cos(xi)) - sin(l) (Gamma2 cos(xi) + Gamma1 sin(xi)), of which `cosine` is
    !> s cos(l) and `sine` is sin(l).
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

    !> Whether a root is a passage of the level, and not of the opposite angle or in another turn.
    logical function counts(self, run, lane, u)
        class(angle_stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: u !! the root, as a fraction of the step
        real(dp) :: angles(2), distance, turns
        associate (now => run%now)
            angles = run%angles_at(lane, now%t_last(lane) + u * (now%t(lane) - now%t_last(lane)))
        end associate
        distance = angles(self%which) - self%goal(lane)
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

end module spintop_angle_stop_lanes
