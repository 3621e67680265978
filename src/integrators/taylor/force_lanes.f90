!> Extremes of the support force along the motions in lanes: of its vertical part and of its magnitude.
!>
!> With the centre of mass r in body axes the force over the mass is, in body axes,
!>
!>     f = omega' x r + omega (omega.r) - r omega^2 + g Gamma.
!>
!> Its vertical part is g + (Gamma.r)''.
module spintop_force_lanes
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: lane_arm_t
    use spintop_kinds, only: dp
    use spintop_lane_series, only: parts
    use spintop_motion, only: motion_t
    use spintop_root_watch, only: find_derivatives, of_interval, root_watch_t, rounding, states_at
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
        real(dp), private :: mass(lanes) = 1, centre(lanes, 3) = 0
        type(lane_arm_t), private :: arm
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

    interface
        !> The slope of the squared force over the mass, over the step as the unit interval, and the square where it begins.
        pure subroutine c_find_force_slopes(degree, arm, power, c, slope, first) bind(C, name='spintop_find_force_slopes')
            import :: lane_arm_t, c_double, c_int
            integer(c_int), value :: degree
            type(lane_arm_t), intent(in) :: arm
            real(c_double), intent(in) :: power(*), c(*)
            real(c_double), intent(inout) :: slope(*), first(*)
        end subroutine c_find_force_slopes
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
        self%arm%gravity(lane) = body%gravity
        self%centre(lane, :) = body%centre_of_mass
        self%arm%axes(lane, :, :) = axes_along(body%centre_of_mass)
        self%arm%length(lane) = norm2(body%centre_of_mass)
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
        associate (now => run%now, r => self%centre, g => self%arm%gravity)
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
        call of_interval(degree, run%power, a)
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
        real(dp) :: first(lanes)
        degree = min(max(nint(degree_share * run%order), least_degree), run%order - 2)
        call c_find_force_slopes(int(degree, c_int), self%arm, run%power, run%c, a, first)
        ! The square of the force itself is known to rounding.
        noise = rounding * first
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
