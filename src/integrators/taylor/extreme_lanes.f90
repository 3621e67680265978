!> Extremes of the precession rate and of the height of the centre of mass along the motions in lanes.
module spintop_extreme_lanes
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_lane_series, only: numerator, parts, rows
    use spintop_motion, only: motion_t
    use spintop_root_watch, only: of_interval, root_watch_t, rounding, states_at
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: precession_lanes_t, height_lanes_t

    !> Watches the precession rate: its value that is largest in magnitude, rad/s.
    type, extends(root_watch_t) :: precession_lanes_t
        real(dp), allocatable :: rate_max(:)
        real(dp), private :: largest(lanes) = 0
    contains
        procedure :: prepare => prepare_precession
        procedure :: begin => begin_precession
        procedure :: find_polynomials => find_precession_slopes
        procedure :: take => take_precession
        procedure :: finish => finish_precession
    end type precession_lanes_t

    !> Watches the height of the centre of mass: its minimum, m.
    type, extends(root_watch_t) :: height_lanes_t
        real(dp), allocatable :: height_min(:)
        real(dp), private :: least(lanes) = 0
        real(dp), private :: centre(lanes, 3) = 0
    contains
        procedure :: prepare => prepare_height
        procedure :: begin => begin_height
        procedure :: find_polynomials => find_height_slopes
        procedure :: take => take_height
        procedure :: finish => finish_height
    end type height_lanes_t

contains

    !> Makes room for so many cases.
    subroutine prepare_precession(self, cases)
        class(precession_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%rate_max)) deallocate (self%rate_max)
        allocate (self%rate_max(cases), source=0.0_dp)
        self%sign = 0
    end subroutine prepare_precession

    !> A case begins in a lane.
    subroutine begin_precession(self, run, lane, body, start)
        class(precession_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        associate (unused => run, also_unused => body)
        end associate
        self%sign(lane) = 0
        self%largest(lane) = merge(start%rate(1), 0.0_dp, abs(start%rate(1)) <= huge(1.0_dp))
    end subroutine begin_precession

    !> The slope of phi' = n/d times d^2, where n = Gamma1 omega1 + Gamma2 omega2 and d = Gamma1^2 + Gamma2^2: smooth
    !> at the poles.
    subroutine find_precession_slopes(self, run, degree, a, noise)
        class(precession_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of their rounding errors
        real(dp) :: n(lanes, 0:max_series_order), d(lanes, 0:max_series_order), rounded(lanes)
        integer :: k
        associate (unused => self)
        end associate
        degree = run%order - 1
        do k = 0, degree
            n(:, k) = run%c(:, numerator, k)
        end do
        call add_squares(degree, run%c, d)
        ! On the unit interval, so that no power overflows.
        call of_interval(degree, run%now%t - run%now%t_last, n, rounded)
        call of_interval(degree, run%now%t - run%now%t_last, d, rounded)
        call find_slopes(degree - 1, n, d, a)
        degree = degree - 1
        noise = 0
        do k = 0, degree
            noise = noise + rounding * abs(a(:, k))
        end do
    end subroutine find_precession_slopes

    !> Takes extremes of the precession rate.
    subroutine take_precession(self, run, u, slope)
        class(precession_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: x(lanes, parts), rate
        integer :: i
        call states_at(run, u * (run%now%t - run%now%t_last), x)
        !$omp simd private(rate)
        do i = 1, lanes
            rate = (x(i, 4) * x(i, 1) + x(i, 5) * x(i, 2)) / (x(i, 4)**2 + x(i, 5)**2)
            self%largest(i) = merge(rate, self%largest(i), abs(slope(i)) > 0 .and. abs(rate) > abs(self%largest(i)) &
                                    .and. abs(rate) <= huge(rate))
        end do
    end subroutine take_precession

    !> The case in a lane is at its end.
    subroutine finish_precession(self, run, lane, case)
        class(precession_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        real(dp) :: rate
        associate (x => run%now%state(lane, :))
            rate = (x(4) * x(1) + x(5) * x(2)) / (x(4)**2 + x(5)**2)
        end associate
        self%rate_max(case) = merge(rate, self%largest(lane), abs(rate) > abs(self%largest(lane)) &
                                    .and. abs(rate) <= huge(rate))
    end subroutine finish_precession

    !> Makes room for so many cases.
    subroutine prepare_height(self, cases)
        class(height_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%height_min)) deallocate (self%height_min)
        allocate (self%height_min(cases), source=0.0_dp)
        self%sign = 0
    end subroutine prepare_height

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
        self%least(lane) = dot_product(body%centre_of_mass, run%now%state(lane, 4:6))
    end subroutine begin_height

    !> The rate of the height.
    subroutine find_height_slopes(self, run, degree, a, noise)
        class(height_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of their rounding errors
        integer :: i, k
        degree = run%order - 1
        associate (r => self%centre, c => run%c)
            do k = 0, degree
                !$omp simd
                do i = 1, lanes
                    a(i, k) = (k + 1) * (r(i, 1) * c(i, 4, k + 1) + r(i, 2) * c(i, 5, k + 1) + r(i, 3) * c(i, 6, k + 1))
                end do
            end do
        end associate
        call of_interval(degree, run%now%t - run%now%t_last, a, noise)
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
            self%least(i) = merge(height, self%least(i), slope(i) > 0 .and. height < self%least(i))
        end do
    end subroutine take_height

    !> The case in a lane is at its end.
    subroutine finish_height(self, run, lane, case)
        class(height_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        self%height_min(case) = min(self%least(lane), dot_product(self%centre(lane, :), run%now%state(lane, 4:6)))
    end subroutine finish_height

    !> Gamma1^2 + Gamma2^2.
    pure subroutine add_squares(degree, c, d)
        integer, intent(in) :: degree
        real(dp), intent(in) :: c(lanes, rows, 0:degree)
        real(dp), intent(out) :: d(lanes, 0:degree)
        real(dp) :: first, second
        integer :: i, j, k
        do k = 0, degree
            !$omp simd private(first, second, j)
            do i = 1, lanes
                first = 0
                second = 0
                do j = 0, max(k, 0)
                    first = first + c(i, 4, j) * c(i, 4, k - j)
                    second = second + c(i, 5, j) * c(i, 5, k - j)
                end do
                d(i, k) = first + second
            end do
        end do
    end subroutine add_squares

    !> The series of n' d - n d'; that of n' has (k + 1) n_(k+1) as its term k.
    pure subroutine find_slopes(degree, n, d, a)
        integer, intent(in) :: degree
        real(dp), intent(in) :: n(lanes, 0:degree + 1), d(lanes, 0:degree + 1)
        real(dp), intent(out) :: a(lanes, 0:degree)
        real(dp) :: n_rate(lanes, 0:degree + 1), d_rate(lanes, 0:degree + 1), first, second
        integer :: i, j, k
        do k = 0, degree + 1
            !$omp simd
            do i = 1, lanes
                n_rate(i, k) = k * n(i, k)
                d_rate(i, k) = k * d(i, k)
            end do
        end do
        do k = 0, degree
            !$omp simd private(first, second, j)
            do i = 1, lanes
                first = 0
                second = 0
                do j = 0, max(k, 0)
                    first = first + n_rate(i, k + 1 - j) * d(i, j)
                    second = second + n(i, j) * d_rate(i, k + 1 - j)
                end do
                a(i, k) = first - second
            end do
        end do
    end subroutine find_slopes

end module spintop_extreme_lanes
