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
    use spintop_lane_products, only: add_squares, multiply, square
    use spintop_lane_series, only: parts, rows
    use spintop_motion, only: motion_t
    use spintop_root_watch, only: find_derivatives, find_powers, of_interval, root_watch_t, rounding, states_at
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    use spintop_vectors, only: cross
    implicit none
    private
    public :: vertical_force_lanes_t, force_lanes_t

    !> Degree of the slope of the squared force, as a share of the order of the states, and at least: the products cost as
    !> the square of it. Where the slope is off by e, relative to its size, an extreme is off by e^2 only. Not so for
    !> rates of angles, which peak next to a pole.
    real(dp), parameter :: degree_share = 0.7_dp
    integer, parameter :: least_degree = 12

    !> What both watches know of the bodies.
    type, abstract, extends(root_watch_t) :: body_watch_t
        real(dp), private :: mass(lanes) = 1, gravity(lanes) = 0, centre(lanes, 3) = 0
        !> Unit vectors, two beside r and one along it, and |r|.
        real(dp), private :: axes(lanes, 3, 3) = 0, arm(lanes) = 0
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
        self%axes(lane, :, :) = axes_along(body%centre_of_mass)
        self%arm(lane) = norm2(body%centre_of_mass)
        call self%forces(run, run%now%state, force)
        self%least(lane) = force(lane)
        self%largest(lane) = force(lane)
    end subroutine begin

    !> Two unit vectors and that along a vector, at right angles and right-handed.
    pure function axes_along(r) result(axes)
        real(dp), intent(in) :: r(3)
        real(dp) :: axes(3, 3), other(3)
        axes(:, 3) = [0.0_dp, 0.0_dp, 1.0_dp]
        if (norm2(r) > 0) axes(:, 3) = r / norm2(r)
        other = 0
        other(minloc(abs(axes(:, 3)), dim=1)) = 1
        axes(:, 1) = cross(axes(:, 3), other)
        axes(:, 1) = axes(:, 1) / norm2(axes(:, 1))
        axes(:, 2) = cross(axes(:, 3), axes(:, 1))
    end function axes_along

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
            !! coefficients, and a bound of errors beside the rounding of their terms
        degree = run%order - 3
        call find_derivatives(run%order, run%c, self%centre, 3, degree, a)
        call of_interval(degree, run%now%t - run%now%t_last, a)
        noise = 0
    end subroutine find_vertical_slopes

    !> The slope of the square of the force over the mass. With omega = (u, v, w) in the axes beside r and along it, there the
    !> force over the mass is
    !>
    !>     f = |r| (w u + v', w v - u', -u^2 - v^2) + g Gamma.
    subroutine find_total_slopes(self, run, degree, a, noise)
        class(force_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        real(dp), dimension(lanes, 0:max_series_order) :: power, product, total
        real(dp), dimension(lanes, 0:max_series_order, 3) :: w, f
        integer :: k, m

        degree = min(max(nint(degree_share * run%order), least_degree), run%order - 2)
        ! On the unit interval, so that no power overflows.
        call find_powers(degree + 1, run%now%t - run%now%t_last, power)
        call turn_rows(self%axes, run%order, run%c, 1, degree + 2, w)
        call turn_rows(self%axes, run%order, run%c, 4, degree + 1, f)
        associate (arm => self%arm)
            do k = 0, degree + 1
                f(:, k, 1) = power(:, k) * (self%gravity * f(:, k, 1) + (k + 1) * arm * w(:, k + 1, 2))
                f(:, k, 2) = power(:, k) * (self%gravity * f(:, k, 2) - (k + 1) * arm * w(:, k + 1, 1))
                f(:, k, 3) = power(:, k) * self%gravity * f(:, k, 3)
                do m = 1, 3
                    w(:, k, m) = power(:, k) * w(:, k, m)
                end do
            end do
            call multiply(degree + 1, w(:, :, 3), w(:, :, 1), product)
            call add_to(f(:, :, 1), 1.0_dp)
            call multiply(degree + 1, w(:, :, 3), w(:, :, 2), product)
            call add_to(f(:, :, 2), 1.0_dp)
            call add_squares(degree + 1, w(:, :, 1), w(:, :, 2), product)
            call add_to(f(:, :, 3), -1.0_dp)
        end associate
        call add_squares(degree + 1, f(:, :, 1), f(:, :, 2), total)
        call square(degree + 1, f(:, :, 3), product)
        do k = 0, degree
            a(:, k) = (k + 1) * (total(:, k + 1) + product(:, k + 1))
        end do
        ! The square of the force itself is known to rounding.
        noise = rounding * (total(:, 0) + product(:, 0))

    contains

        !> Adds the product, times |r| and a sign, to a component of the force.
        subroutine add_to(component, sign)
            real(dp), intent(inout) :: component(lanes, 0:max_series_order)
            real(dp), intent(in) :: sign
            do k = 0, degree + 1
                component(:, k) = component(:, k) + sign * self%arm * product(:, k)
            end do
        end subroutine add_to

    end subroutine find_total_slopes

    !> The series of a vector in the axes beside r and along it, from its three rows of the states.
    pure subroutine turn_rows(axes, order, c, row, degree, x)
        integer, intent(in) :: order, row, degree
        real(dp), intent(in) :: axes(lanes, 3, 3), c(lanes, rows, 0:order)
        real(dp), intent(inout) :: x(lanes, 0:max_series_order, 3)
        real(dp) :: c1, c2, c3
        integer :: i, k
        do k = 0, degree
            !$omp simd private(c1, c2, c3)
            do i = 1, lanes
                c1 = c(i, row, k)
                c2 = c(i, row + 1, k)
                c3 = c(i, row + 2, k)
                x(i, k, 1) = axes(i, 1, 1) * c1 + axes(i, 2, 1) * c2 + axes(i, 3, 1) * c3
                x(i, k, 2) = axes(i, 1, 2) * c1 + axes(i, 2, 2) * c2 + axes(i, 3, 2) * c3
                x(i, k, 3) = axes(i, 1, 3) * c1 + axes(i, 2, 3) * c2 + axes(i, 3, 3) * c3
            end do
        end do
    end subroutine turn_rows

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
