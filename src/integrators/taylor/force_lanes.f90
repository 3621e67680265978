!> Extremes of the support force along the motions in lanes: of its vertical part and of its magnitude.
!>
!> With the centre of mass r in body axes the force over the mass is, in body axes,
!>
!>     f = omega' x r + omega (omega.r) - r omega^2 + g Gamma.
!>
!> Its vertical part is g + (Gamma.r)''.
module spintop_force_lanes
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_kinds, only: dp
    use spintop_lane_products, only: add_squares, multiply
    use spintop_lane_series, only: parts
    use spintop_motion, only: motion_t
    use spintop_root_watch, only: of_interval, root_watch_t, rounding, states_at
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: vertical_force_lanes_t, force_lanes_t

    !> What both watches know of the bodies.
    type, abstract, extends(root_watch_t) :: body_watch_t
        real(dp), private :: mass(lanes) = 1, gravity(lanes) = 0, centre(lanes, 3) = 0
        real(dp), dimension(lanes), private :: least = 0, largest = 0
    contains
        procedure :: begin
        procedure :: take
        procedure, private :: find_forces
        procedure(forces_i), deferred :: forces
    end type body_watch_t

    !> Watches the vertical force: its smallest and largest value, N.
    type, extends(body_watch_t) :: vertical_force_lanes_t
        real(dp), allocatable :: force_min(:), force_max(:)
    contains
        procedure :: prepare => prepare_vertical
        procedure :: find_polynomials => find_vertical_slopes
        procedure :: forces => vertical_forces
        procedure :: finish => finish_vertical
    end type vertical_force_lanes_t

    !> Watches the magnitude of the force: its largest value, N.
    type, extends(body_watch_t) :: force_lanes_t
        real(dp), allocatable :: force_max(:)
    contains
        procedure :: prepare => prepare_total
        procedure :: find_polynomials => find_total_slopes
        procedure :: forces => total_forces
        procedure :: finish => finish_total
    end type force_lanes_t

    abstract interface
        !> The forces at the states, N.
        pure subroutine forces_i(self, run, x, force)
            import :: body_watch_t, dp, lanes, parts, taylor_lanes_t
            class(body_watch_t), intent(in) :: self
            type(taylor_lanes_t), intent(in) :: run !! the lanes
            real(dp), intent(in) :: x(lanes, parts) !! the states
            real(dp), intent(out) :: force(lanes) !! the forces, N
        end subroutine forces_i
    end interface

contains

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(body_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: force(lanes)
        associate (unused => start)
        end associate
        self%sign(lane) = 0
        self%mass(lane) = body%mass
        self%gravity(lane) = body%gravity
        self%centre(lane, :) = body%centre_of_mass
        call self%forces(run, run%now%state, force)
        self%least(lane) = force(lane)
        self%largest(lane) = force(lane)
    end subroutine begin

    !> Takes extremes.
    subroutine take(self, run, u, slope)
        class(body_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: x(lanes, parts), force(lanes)
        call states_at(run, u * (run%now%t - run%now%t_last), x)
        call self%forces(run, x, force)
        self%least = merge(force, self%least, slope > 0 .and. force < self%least)
        self%largest = merge(force, self%largest, slope < 0 .and. force > self%largest)
    end subroutine take

    !> Forces over the masses in body axes, at the states.
    pure subroutine find_forces(self, run, x, f)
        class(body_watch_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: x(lanes, parts)
        real(dp), intent(out) :: f(lanes, 3)
        real(dp) :: b1, b2, b3, along, rate2
        integer :: i
        associate (now => run%now, r => self%centre, g => self%gravity)
            !$omp simd private(b1, b2, b3, along, rate2)
            do i = 1, lanes
                ! The angular acceleration by Euler's equations, see `expand`.
                b1 = now%coupling(i, 1) * x(i, 2) * x(i, 3) - now%decay(i, 1) * x(i, 1) &
                    + (now%pull(i, 1) * x(i, 5) - now%swing(i, 1) * x(i, 6))
                b2 = now%coupling(i, 2) * x(i, 3) * x(i, 1) - now%decay(i, 2) * x(i, 2) &
                    + (now%pull(i, 2) * x(i, 6) - now%swing(i, 2) * x(i, 4))
                b3 = now%coupling(i, 3) * x(i, 1) * x(i, 2) - now%decay(i, 3) * x(i, 3) &
                    + (now%pull(i, 3) * x(i, 4) - now%swing(i, 3) * x(i, 5))
                along = x(i, 1) * r(i, 1) + x(i, 2) * r(i, 2) + x(i, 3) * r(i, 3)
                rate2 = x(i, 1)**2 + x(i, 2)**2 + x(i, 3)**2
                f(i, 1) = b2 * r(i, 3) - b3 * r(i, 2) + x(i, 1) * along - r(i, 1) * rate2 + g(i) * x(i, 4)
                f(i, 2) = b3 * r(i, 1) - b1 * r(i, 3) + x(i, 2) * along - r(i, 2) * rate2 + g(i) * x(i, 5)
                f(i, 3) = b1 * r(i, 2) - b2 * r(i, 1) + x(i, 3) * along - r(i, 3) * rate2 + g(i) * x(i, 6)
            end do
        end associate
    end subroutine find_forces

    !> Vertical forces.
    pure subroutine vertical_forces(self, run, x, force)
        class(vertical_force_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp), intent(in) :: x(lanes, parts) !! the states
        real(dp), intent(out) :: force(lanes) !! the forces, N
        real(dp) :: f(lanes, 3)
        call self%find_forces(run, x, f)
        force = self%mass * (f(:, 1) * x(:, 4) + f(:, 2) * x(:, 5) + f(:, 3) * x(:, 6))
    end subroutine vertical_forces

    !> Magnitudes of the forces.
    pure subroutine total_forces(self, run, x, force)
        class(force_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp), intent(in) :: x(lanes, parts) !! the states
        real(dp), intent(out) :: force(lanes) !! the forces, N
        real(dp) :: f(lanes, 3)
        call self%find_forces(run, x, f)
        force = self%mass * sqrt(f(:, 1)**2 + f(:, 2)**2 + f(:, 3)**2)
    end subroutine total_forces

    !> The third derivative of the height of the centre of mass.
    subroutine find_vertical_slopes(self, run, degree, a, noise)
        class(vertical_force_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of their rounding errors
        integer :: i, k
        degree = run%order - 3
        associate (r => self%centre, c => run%c)
            do k = 0, degree
                !$omp simd
                do i = 1, lanes
                    a(i, k) = ((k + 1) * (k + 2) * (k + 3)) &
                        * (r(i, 1) * c(i, 4, k + 3) + r(i, 2) * c(i, 5, k + 3) + r(i, 3) * c(i, 6, k + 3))
                end do
            end do
        end associate
        call of_interval(degree, run%now%t - run%now%t_last, a, noise)
    end subroutine find_vertical_slopes

    !> The slope of the square of the force over the mass.
    subroutine find_total_slopes(self, run, degree, a, noise)
        class(force_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of their rounding errors
        real(dp), dimension(lanes, 0:max_series_order) :: along, rate2, total
        real(dp), dimension(lanes, 0:max_series_order, 3) :: w, slope, f
        integer :: k, m, next, last

        degree = run%order - 2
        do m = 1, 3
            do k = 0, run%order - 1
                w(:, k, m) = run%c(:, m, k)
                slope(:, k, m) = (k + 1) * run%c(:, m, k + 1)
            end do
            ! On the unit interval, so that no power overflows.
            call of_interval(run%order - 1, run%now%t - run%now%t_last, w(:, :run%order - 1, m), noise)
            call of_interval(run%order - 1, run%now%t - run%now%t_last, slope(:, :run%order - 1, m), noise)
        end do
        call add_squares(degree + 1, w(:, :, 1), w(:, :, 2), rate2)
        call multiply(degree + 1, w(:, :, 3), w(:, :, 3), total)
        do k = 0, degree + 1
            rate2(:, k) = rate2(:, k) + total(:, k)
            along(:, k) = self%centre(:, 1) * w(:, k, 1) + self%centre(:, 2) * w(:, k, 2) + self%centre(:, 3) * w(:, k, 3)
        end do
        do m = 1, 3
            next = mod(m, 3) + 1
            last = mod(m + 1, 3) + 1
            call multiply(degree + 1, w(:, :, m), along, f(:, :, m))
            a(:, :degree + 1) = run%c(:, 3 + m, :degree + 1)
            call of_interval(degree + 1, run%now%t - run%now%t_last, a, noise)
            do k = 0, degree + 1
                f(:, k, m) = f(:, k, m) + slope(:, k, next) * self%centre(:, last) &
                    - slope(:, k, last) * self%centre(:, next) - self%centre(:, m) * rate2(:, k) + self%gravity * a(:, k)
            end do
        end do
        call add_squares(degree + 1, f(:, :, 1), f(:, :, 2), total)
        call multiply(degree + 1, f(:, :, 3), f(:, :, 3), along)
        total(:, :degree + 1) = total(:, :degree + 1) + along(:, :degree + 1)
        noise = 0
        do k = 0, degree
            a(:, k) = (k + 1) * total(:, k + 1)
            noise = noise + rounding * abs(a(:, k))
        end do
        ! The square of the force itself is known to rounding.
        noise = noise + rounding * abs(total(:, 0))
    end subroutine find_total_slopes

    !> Makes room for so many cases.
    subroutine prepare_vertical(self, cases)
        class(vertical_force_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%force_min)) deallocate (self%force_min, self%force_max)
        allocate (self%force_min(cases), self%force_max(cases), source=0.0_dp)
        self%sign = 0
    end subroutine prepare_vertical

    !> The case in a lane is at its end.
    subroutine finish_vertical(self, run, lane, case)
        class(vertical_force_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        real(dp) :: force(lanes)
        call self%forces(run, run%now%state, force)
        self%force_min(case) = min(self%least(lane), force(lane))
        self%force_max(case) = max(self%largest(lane), force(lane))
    end subroutine finish_vertical

    !> Makes room for so many cases.
    subroutine prepare_total(self, cases)
        class(force_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%force_max)) deallocate (self%force_max)
        allocate (self%force_max(cases), source=0.0_dp)
        self%sign = 0
    end subroutine prepare_total

    !> The case in a lane is at its end.
    subroutine finish_total(self, run, lane, case)
        class(force_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        real(dp) :: force(lanes)
        call self%forces(run, run%now%state, force)
        self%force_max(case) = max(self%largest(lane), force(lane))
    end subroutine finish_total

end module spintop_force_lanes
