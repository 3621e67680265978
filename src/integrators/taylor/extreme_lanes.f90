!> Extremes of the precession rate, of the nutation rate and of the height of the centre of mass along the motions in
!> lanes.
module spintop_extreme_lanes
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_formulation, only: max_series_order
    use spintop_lane_series, only: numerator, parts
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: through_pole
    use spintop_poles, only: polar_precession_rate, precession_is_lost
    use spintop_quantities, only: angular_acceleration
    use spintop_lane_products, only: multiply, multiply_slopes, square
    use spintop_root_watch, only: find_derivatives, find_row, of_interval, root_watch_t, states_at
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: precession_lanes_t, nutation_rate_lanes_t, height_lanes_t

    !> Sine of the inclination below which body z is near a pole.
    real(dp), parameter :: near_pole = 0.03_dp

    !> Watches an extreme of one quantity.
    type, abstract, extends(root_watch_t) :: extreme_lanes_t
        !> The extreme of each case; and up to now, of the case in each lane.
        real(dp), allocatable :: extreme(:)
        real(dp), private :: so_far(lanes) = 0
    contains
        procedure :: prepare
    end type extreme_lanes_t

    !> Watches the precession rate: its value that is largest in magnitude, rad/s.
    type, extends(extreme_lanes_t) :: precession_lanes_t
    contains
        procedure :: begin => begin_precession
        procedure :: find_polynomials => find_precession_slopes
        procedure :: take => take_precession
        procedure :: finish => finish_precession
    end type precession_lanes_t

    !> Watches the nutation rate: its largest magnitude, rad/s.
    type, extends(extreme_lanes_t) :: nutation_rate_lanes_t
    contains
        procedure :: begin => begin_nutation
        procedure :: find_polynomials => find_nutation_slopes
        procedure :: take => take_nutation
        procedure :: finish => finish_nutation
    end type nutation_rate_lanes_t

    !> Watches the height of the centre of mass: its minimum, m.
    type, extends(extreme_lanes_t) :: height_lanes_t
        real(dp), private :: centre(lanes, 3) = 0
    contains
        procedure :: begin => begin_height
        procedure :: find_polynomials => find_height_slopes
        procedure :: take => take_height
        procedure :: finish => finish_height
    end type height_lanes_t

contains

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(extreme_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%extreme)) deallocate (self%extreme)
        allocate (self%extreme(cases), source=0.0_dp)
        self%sign = 0
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin_precession(self, run, lane, body, start)
        class(precession_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        type(motion_t) :: here
        self%sign(lane) = 0
        self%so_far(lane) = 0
        if (norm2(run%now%state(lane, 4:5)) <= through_pole) then
            here = start
            here%omega_rate = angular_acceleration(body, start)
            self%so_far(lane) = polar_precession_rate(here)
            if (.not. is_finite(self%so_far(lane))) self%so_far(lane) = 0
        else
            call take_state(self, lane, run%now%state(lane, :5))
        end if
    end subroutine begin_precession

    !> The slope of phi' = n/d times d^2, where n = Gamma1 omega1 + Gamma2 omega2 and d = Gamma1^2 + Gamma2^2: smooth
    !> at the poles.
    subroutine find_precession_slopes(self, run, degree, a, noise)
        class(precession_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        real(dp), dimension(lanes, 0:max_series_order) :: n, height, d
        associate (unused => self)
        end associate
        degree = run%order - 2
        call find_row(run%order, run%c, numerator, degree + 1, run%power, n)
        call find_row(run%order, run%c, 6, degree + 1, run%power, height)
        call find_sine2(degree + 1, run%c(:, 4:5, 0), height, d)
        call multiply_slopes(degree, n, d, a)
        noise = 0
    end subroutine find_precession_slopes

    !> Takes extremes of the precession rate.
    subroutine take_precession(self, run, u, slope)
        class(precession_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: x(lanes, parts), h(lanes), t(lanes), sine2
        logical :: is_near(lanes)
        integer :: i
        h = run%now%t - run%now%t_last
        t = u * h
        call states_at(run, t, x)
        call take_rates(self, x, slope)
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
        call states_at(run, t, x)
        call take_rates(self, x, merge(slope, 0.0_dp, is_near))
    end subroutine take_precession

    !> Takes the precession rates of states, in lanes where `slope` is not zero.
    pure subroutine take_rates(self, x, slope)
        class(precession_lanes_t), intent(inout) :: self
        real(dp), intent(in) :: x(lanes, parts), slope(lanes)
        integer :: i
        do i = 1, lanes
            if (abs(slope(i)) > 0) call take_state(self, i, x(i, :5))
        end do
    end subroutine take_rates

    !> Takes the precession rate of a state in a lane.
    pure subroutine take_state(self, lane, x)
        class(precession_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: x(5)
        real(dp) :: rate
        rate = (x(4) * x(1) + x(5) * x(2)) / (x(4)**2 + x(5)**2)
        if (.not. (abs(rate) > abs(self%so_far(lane)) .and. abs(rate) <= huge(rate))) return
        if (.not. precession_is_lost(x(4:5), x(1:2))) self%so_far(lane) = rate
    end subroutine take_state

    !> The case in a lane is at its end.
    subroutine finish_precession(self, run, lane, case)
        class(precession_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        call take_state(self, lane, run%now%state(lane, :5))
        self%extreme(case) = self%so_far(lane)
    end subroutine finish_precession

    !> A case begins in a lane.
    subroutine begin_nutation(self, run, lane, body, start)
        class(nutation_rate_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: rate(lanes)
        associate (unused => body, also_unused => start)
        end associate
        self%sign(lane) = 0
        call find_nutation_rates(run%now%state, rate)
        self%so_far(lane) = rate(lane)
    end subroutine begin_nutation

    !> With w = Gamma3' and d = Gamma1^2 + Gamma2^2, theta'^2 = w^2/d has the slope 2 w (w' d + Gamma3 w^2)/d^2. The
    !> roots of w, turning points, are none of the largest; the other factor is smooth at the poles.
    subroutine find_nutation_slopes(self, run, degree, a, noise)
        class(nutation_rate_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        real(dp), dimension(lanes, 0:max_series_order) :: height, w, w_rate, w2, d, product
        integer :: k
        associate (unused => self)
        end associate
        degree = run%order - 2
        call find_row(run%order, run%c, 6, degree + 2, run%power, height)
        do k = 0, degree + 1
            w(:, k) = (k + 1) * height(:, k + 1)
        end do
        do k = 0, degree
            w_rate(:, k) = (k + 1) * w(:, k + 1)
        end do
        call find_sine2(degree, run%c(:, 4:5, 0), height, d)
        call multiply(degree, w_rate, d, a)
        call square(degree, w, w2)
        call multiply(degree, height, w2, product)
        noise = 0
        do k = 0, degree
            a(:, k) = a(:, k) + product(:, k)
        end do
    end subroutine find_nutation_slopes

    !> Takes extremes of the nutation rate.
    subroutine take_nutation(self, run, u, slope)
        class(nutation_rate_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: x(lanes, parts), rate(lanes)
        call states_at(run, u * (run%now%t - run%now%t_last), x)
        call find_nutation_rates(x, rate)
        self%so_far = merge(rate, self%so_far, abs(slope) > 0 .and. rate > self%so_far .and. rate <= huge(rate))
    end subroutine take_nutation

    !> The case in a lane is at its end.
    subroutine finish_nutation(self, run, lane, case)
        class(nutation_rate_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        real(dp) :: rate(lanes)
        call find_nutation_rates(run%now%state, rate)
        self%extreme(case) = max(self%so_far(lane), rate(lane))
    end subroutine finish_nutation

    !> Magnitudes of theta'; at a pole, where theta' has two signs, its limit.
    pure subroutine find_nutation_rates(x, rate)
        real(dp), intent(in) :: x(lanes, parts)
        real(dp), intent(out) :: rate(lanes)
        real(dp) :: sine
        integer :: i
        !$omp simd private(sine)
        do i = 1, lanes
            sine = sqrt(x(i, 4)**2 + x(i, 5)**2)
            rate(i) = merge(abs(x(i, 4) * x(i, 2) - x(i, 5) * x(i, 1)) / max(sine, tiny(sine)), &
                            sqrt(x(i, 1)**2 + x(i, 2)**2), sine > through_pole)
        end do
    end subroutine find_nutation_rates

    !> The series of Gamma1^2 + Gamma2^2 over the unit interval: its changes are those of -Gamma3^2. The terms of Gamma3 are as
    !> small next to a pole as those of what turns there, but for the first.
    pure subroutine find_sine2(degree, across, height, d)
        integer, intent(in) :: degree
        real(dp), intent(in) :: across(lanes, 2), height(lanes, 0:degree)
        real(dp), intent(out) :: d(lanes, 0:degree)
        call square(degree, height, d)
        d(:, 1:) = -d(:, 1:)
        d(:, 0) = across(:, 1)**2 + across(:, 2)**2
    end subroutine find_sine2

    !> A case begins in a lane.
    subroutine begin_height(self, run, lane, body, start)
        class(height_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        associate (unused => start)
        end associate
        self%sign(lane) = 0
        self%centre(lane, :) = body%centre_of_mass
        self%so_far(lane) = dot_product(body%centre_of_mass, run%now%state(lane, 4:6))
    end subroutine begin_height

    !> The rate of the height.
    subroutine find_height_slopes(self, run, degree, a, noise)
        class(height_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        degree = run%order - 1
        call find_derivatives(run%order, run%c, self%centre, 1, degree, a)
        call of_interval(degree, run%power, a)
        noise = 0
    end subroutine find_height_slopes

    !> Takes minima of the height.
    subroutine take_height(self, run, u, slope)
        class(height_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: x(lanes, parts), height
        integer :: i
        call states_at(run, u * (run%now%t - run%now%t_last), x)
        !$omp simd private(height)
        do i = 1, lanes
            height = self%centre(i, 1) * x(i, 4) + self%centre(i, 2) * x(i, 5) + self%centre(i, 3) * x(i, 6)
            self%so_far(i) = merge(height, self%so_far(i), slope(i) > 0 .and. height < self%so_far(i))
        end do
    end subroutine take_height

    !> The case in a lane is at its end.
    subroutine finish_height(self, run, lane, case)
        class(height_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        self%extreme(case) = min(self%so_far(lane), dot_product(self%centre(lane, :), run%now%state(lane, 4:6)))
    end subroutine finish_height

end module spintop_extreme_lanes
