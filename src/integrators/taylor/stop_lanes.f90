!> Events that end the motions in lanes: theta passes a value, or turns.
module spintop_stop_lanes
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_constancy, only: driven_rate
    use spintop_formulation, only: max_series_order
    use spintop_instants, only: greatest_fall_rate, time_of_start
    use spintop_motion, only: motion_t
    use spintop_quantities, only: axis_height_rate
    use spintop_root_watch, only: find_height_rates, find_row, of_interval, root_watch_t, rounding
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: stop_lanes_t

    !> Ends a motion at the n-th event. `set`, then hand it over before the other watches, which then see
    !> no more than the motion up to there.
    type, extends(root_watch_t) :: stop_lanes_t
        !> Whether the event came, of each case.
        logical, allocatable :: came(:)
        !> The event is a passage of this Gamma3, or else of zero by its rate.
        logical, private :: is_level = .true.
        real(dp), private :: level = 0
        !> Which passages count: those rising, those falling.
        logical, private :: rising = .true., falling = .true.
        integer, private :: wanted = 1
        integer, private :: left(lanes) = 0
        !> Times up to which a passage is the start itself, s.
        real(dp), private :: started(lanes) = 0
    contains
        procedure :: set_level
        procedure :: set_turning
        procedure :: count_passages
        procedure :: counts
        procedure :: prepare
        procedure :: begin
        procedure :: find_polynomials
        procedure :: take
        procedure :: finish
    end type stop_lanes_t

contains

    !> The n-th passage of an inclination.
    pure subroutine set_level(self, theta, rising, falling, n)
        class(stop_lanes_t), intent(inout) :: self
        real(dp), intent(in) :: theta !! rad
        logical, intent(in) :: rising, falling !! which passages of theta count
        integer, intent(in) :: n !! number of the event that ends the motion
        self%is_level = .true.
        self%level = cos(theta)
        call self%count_passages(rising=falling, falling=rising, n=n)
    end subroutine set_level

    !> The n-th turning point of theta.
    pure subroutine set_turning(self, upper, lower, n)
        class(stop_lanes_t), intent(inout) :: self
        logical, intent(in) :: upper, lower !! which of them count
        integer, intent(in) :: n !! number of the event that ends the motion
        self%is_level = .false.
        call self%count_passages(rising=lower, falling=upper, n=n)
    end subroutine set_turning

    !> Which passages of zero by the polynomials count.
    pure subroutine count_passages(self, rising, falling, n)
        class(stop_lanes_t), intent(inout) :: self
        logical, intent(in) :: rising, falling !! whether passages in that sense count
        integer, intent(in) :: n !! number of the one that ends the motion
        self%rising = rising
        self%falling = falling
        self%wanted = n
    end subroutine count_passages

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(stop_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%came)) deallocate (self%came)
        allocate (self%came(cases), source=.false.)
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
        value = axis_height_rate(start)
        if (self%is_level) then
            value = run%now%state(lane, 6) - self%level
            if (abs(value) <= 2 * rounding) value = 0
        end if
        self%sign(lane) = merge(sign(1.0_dp, value), 0.0_dp, abs(value) > 0)
        self%driven(lane) = driven_rate(greatest_fall_rate(body), start%omega)
        self%left(lane) = self%wanted
        self%started(lane) = start%t + time_of_start(body, start)
    end subroutine begin

    !> Gamma3 above the level, or its rate.
    subroutine find_polynomials(self, run, degree, a, noise)
        class(stop_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        if (self%is_level) then
            degree = run%order
            call find_row(run%order, run%c, 6, degree, run%power, a)
            a(:, 0) = a(:, 0) - self%level
            noise = rounding
        else
            degree = run%order - 1
            call find_height_rates(run%order, run%c, self%driven, degree, a, noise)
            call of_interval(degree, run%power, a)
        end if
    end subroutine find_polynomials

    !> Takes passages, and ends the lanes that have enough.
    subroutine take(self, run, u, slope)
        class(stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: t
        integer :: lane
        do lane = 1, lanes
            if (.not. ((slope(lane) > 0 .and. self%rising) .or. (slope(lane) < 0 .and. self%falling))) cycle
            if (self%is_noise(lane)) cycle
            t = run%now%t_last(lane) + u(lane) * (run%now%t(lane) - run%now%t_last(lane))
            if (self%left(lane) <= 0 .or. t <= self%started(lane)) cycle
            if (.not. self%counts(run, lane, u(lane))) cycle
            self%left(lane) = self%left(lane) - 1
            if (self%left(lane) == 0) call run%stop(lane, t)
        end do
    end subroutine take

    !> Whether a root is a passage: all are, here.
    logical function counts(self, run, lane, u)
        class(stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        real(dp), intent(in) :: u !! the root, as a fraction of the step
        associate (unused => self, also_unused => run, unused_lane => lane, unused_u => u)
        end associate
        counts = .true.
    end function counts

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        associate (unused => run)
        end associate
        self%came(case) = self%left(lane) <= 0
    end subroutine finish

end module spintop_stop_lanes
