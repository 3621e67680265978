!> Extremes of quantities along the motions in lanes: the values at the ends, and where a polynomial of each step, the slope of
!> the quantity times what does not change its sign, passes zero.
module spintop_extreme_lanes
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: lane_arm_t
    use spintop_lane_series, only: numerator, parts
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: through_pole
    use spintop_poles, only: polar_precession_rate, precession_is_lost
    use spintop_quantities, only: angular_acceleration
    use spintop_lane_products, only: multiply, multiply_slopes, square
    use spintop_root_monitor, only: find_derivatives, find_row, of_interval, root_monitor_t, rounding, states_at
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    use spintop_vectors, only: cross
    implicit none
    private
    public :: extreme_lanes_t

    !> The quantities. Of rates of angles the value is kept that is largest in magnitude, of the others the range.
    integer, parameter, public :: precession_rate = 1, nutation_rate = 2, centre_height = 3, vertical_force = 4, &
        total_force = 5

    !> Sine of the inclination below which body z is near a pole.
    real(dp), parameter :: near_pole = 0.03_dp
    !> Degree of the slope of the squared force, as a share of the order of the states, and at least: the products cost as
    !> the square of it. Where the slope is off by e, relative to its size, an extreme is off by e^2 only. Not so for
    !> rates of angles, which peak next to a pole.
    real(dp), parameter :: degree_share = 0.7_dp
    integer, parameter :: least_degree = 12

    !> Watches a quantity.
    type, extends(root_monitor_t) :: extreme_lanes_t
        !> The quantity, one of those above.
        integer :: quantity = centre_height
        !> Its least and its largest value, or in magnitude the largest, in each case: rad/s, m or N.
        real(dp), allocatable :: least(:), largest(:)
        !> Those up to now, of the case in each lane.
        real(dp), dimension(lanes), private :: low = 0, high = 0
        real(dp), private :: mass(lanes) = 1, centre(lanes, 3) = 0
        type(lane_arm_t), private :: arm = lane_arm_t()
    contains
        procedure :: prepare
        procedure :: begin
        procedure :: find_polynomials
        procedure :: record_roots
        procedure :: finish
    end type extreme_lanes_t

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

    !> Makes room for so many cases.
    subroutine prepare(self, cases)
        class(extreme_lanes_t), intent(inout) :: self
        integer, intent(in) :: cases !! number of cases
        if (allocated(self%least)) deallocate (self%least, self%largest)
        allocate (self%least(cases), self%largest(cases), source=0.0_dp)
        self%sign = 0
    end subroutine prepare

    !> A case begins in a lane.
    subroutine begin(self, run, lane, body, start)
        class(extreme_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        type(motion_t) :: here
        real(dp) :: rate
        self%sign(lane) = 0
        self%mass(lane) = body%mass
        self%centre(lane, :) = body%centre_of_mass
        self%arm%gravity(lane) = body%gravity
        if (self%quantity == total_force) then
            self%arm%axes(lane, :, :) = axes_along(body%centre_of_mass)
            self%arm%length(lane) = norm2(body%centre_of_mass)
        end if
        self%low(lane) = huge(rate)
        self%high(lane) = merge(0.0_dp, -huge(rate), self%quantity <= nutation_rate)
        if (self%quantity == precession_rate .and. norm2(run%now%state(lane, 4:5)) <= through_pole) then
            here = start
            here%omega_rate = angular_acceleration(body, start)
            rate = polar_precession_rate(here)
            if (is_finite(rate)) self%high(lane) = rate
        else
            call keep_end(self, run, lane)
        end if
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

    !> The slopes. Those of the height and of the vertical force are derivatives of the height of the centre of mass.
    subroutine find_polynomials(self, run, degree, a, noise)
        class(extreme_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        real(dp) :: first(lanes)
        noise = 0
        select case (self%quantity)
        case (precession_rate)
            degree = run%order - 2
            call find_precession_slopes(run, degree, a)
        case (nutation_rate)
            degree = run%order - 2
            call find_nutation_slopes(run, degree, a)
        case (total_force)
            degree = min(max(nint(degree_share * run%order), least_degree), run%order - 2)
            call c_find_force_slopes(int(degree, c_int), self%arm, run%power, run%c, a, first)
            ! The square of the force itself is known to rounding.
            noise = rounding * first
        case default
            degree = run%order - merge(1, 3, self%quantity == centre_height)
            call find_derivatives(run%order, run%c, self%centre, run%order - degree, degree, a)
            call of_interval(degree, run%power, a)
        end select
    end subroutine find_polynomials

    !> The slope of phi' = n/d times d^2, where n = Gamma1 omega1 + Gamma2 omega2 and d = Gamma1^2 + Gamma2^2: smooth
    !> at the poles.
    pure subroutine find_precession_slopes(run, degree, a)
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: degree
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes, 0:max_series_order) :: n, height, d
        call find_row(run%order, run%c, numerator, degree + 1, run%power, n)
        call find_row(run%order, run%c, 6, degree + 1, run%power, height)
        call find_sine2(degree + 1, run%c(:, 4:5, 0), height, d)
        call multiply_slopes(degree, n, d, a)
    end subroutine find_precession_slopes

    !> With w = Gamma3' and d = Gamma1^2 + Gamma2^2, theta'^2 = w^2/d has the slope 2 w (w' d + Gamma3 w^2)/d^2. The
    !> roots of w, turning points, are none of the largest; the other factor is smooth at the poles.
    pure subroutine find_nutation_slopes(run, degree, a)
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: degree
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes, 0:max_series_order) :: height, w, w_rate, w2, d, product
        integer :: k
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
        do k = 0, degree
            a(:, k) = a(:, k) + product(:, k)
        end do
    end subroutine find_nutation_slopes

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

    !> Records extremes.
    subroutine record_roots(self, run, u, slope)
        class(extreme_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        real(dp) :: x(lanes, parts), h(lanes), t(lanes), sine2
        logical :: is_near(lanes)
        integer :: i
        h = run%now%t - run%now%t_last
        t = u * h
        call record_at(self, run, t, slope, x)
        if (self%quantity /= precession_rate) return
        ! Near a pole the terms that the series leave out are large beside the distance. There the rate is largest where body z is
        ! nearest, whose velocity is all but constant.
        !$omp simd private(sine2)
        do i = 1, lanes
            sine2 = x(i, 4)**2 + x(i, 5)**2
            is_near(i) = abs(slope(i)) > 0 .and. sine2 < near_pole**2
            t(i) = t(i) + x(i, 6) * (x(i, 4) * x(i, 2) - x(i, 5) * x(i, 1)) / max(x(i, 1)**2 + x(i, 2)**2, tiny(sine2))
            t(i) = min(max(t(i), 0.0_dp), h(i))
        end do
        if (any(is_near)) call record_at(self, run, t, merge(slope, 0.0_dp, is_near), x)
    end subroutine record_roots

    !> Takes the values at the times t after the beginning of the step, in lanes where `slope` is not zero.
    subroutine record_at(self, run, t, slope, x)
        class(extreme_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: t(lanes), slope(lanes)
        real(dp), intent(out) :: x(lanes, parts) !! the states there
        real(dp) :: value(lanes)
        integer :: i
        call states_at(run, t, x)
        call find_values(self, run, x, value)
        do i = 1, lanes
            if (abs(slope(i)) > 0) call keep(self, i, x, value(i), slope(i))
        end do
    end subroutine record_at

    !> Keeps the value at an end of the motion in a lane.
    pure subroutine keep_end(self, run, lane)
        class(extreme_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        real(dp) :: value(lanes)
        call find_values(self, run, run%now%state, value)
        call keep(self, lane, run%now%state, value(lane), 0.0_dp)
    end subroutine keep_end

    !> Keeps a value in a lane where it is the least or the largest up to now: where the slope rises the least, where it falls
    !> the largest, at an end of the motion either.
    pure subroutine keep(self, lane, x, value, slope)
        class(extreme_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        real(dp), intent(in) :: x(lanes, parts), value, slope
            !! states, and the value in the lane; sign of the slope of the polynomial, or 0 at an end
        if (self%quantity <= nutation_rate) then
            if (.not. (abs(value) > abs(self%high(lane)) .and. abs(value) <= huge(value))) return
            if (self%quantity == precession_rate) then
                if (precession_is_lost(x(lane, 4:5), x(lane, 1:2))) return
            end if
            self%high(lane) = value
        else
            if (value < self%low(lane) .and. slope >= 0) self%low(lane) = value
            if (value > self%high(lane) .and. slope <= 0) self%high(lane) = value
        end if
    end subroutine keep

    !> The case in a lane is at its end.
    subroutine finish(self, run, lane, case)
        class(extreme_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane, case !! index of the lane, and of its case
        call keep_end(self, run, lane)
        self%least(case) = self%low(lane)
        self%largest(case) = self%high(lane)
    end subroutine finish

    !> The values of the quantity at states; of theta', which has two signs at a pole, the magnitude.
    pure subroutine find_values(self, run, x, value)
        class(extreme_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: x(lanes, parts)
        real(dp), intent(out) :: value(lanes)
        real(dp) :: f(lanes, 3), sine
        integer :: i
        select case (self%quantity)
        case (precession_rate)
            !$omp simd
            do i = 1, lanes
                value(i) = (x(i, 4) * x(i, 1) + x(i, 5) * x(i, 2)) / max(x(i, 4)**2 + x(i, 5)**2, tiny(sine))
            end do
        case (nutation_rate)
            !$omp simd private(sine)
            do i = 1, lanes
                sine = sqrt(x(i, 4)**2 + x(i, 5)**2)
                value(i) = merge(abs(x(i, 4) * x(i, 2) - x(i, 5) * x(i, 1)) / max(sine, tiny(sine)), &
                                 sqrt(x(i, 1)**2 + x(i, 2)**2), sine > through_pole)
            end do
        case (centre_height)
            value = 0
            do i = 1, 3
                value = value + self%centre(:, i) * x(:, 3 + i)
            end do
        case (vertical_force)
            call find_forces(self, run, x, f)
            value = self%mass * (f(:, 1) * x(:, 4) + f(:, 2) * x(:, 5) + f(:, 3) * x(:, 6))
        case (total_force)
            call find_forces(self, run, x, f)
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
    pure subroutine find_forces(self, run, x, f)
        class(extreme_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run
        real(dp), intent(in) :: x(lanes, parts)
        real(dp), intent(out) :: f(lanes, 3)
        real(dp) :: b1, b2, b3, along, rate2
        integer :: i
        associate (of => run%now%body, r => self%centre, g => self%arm%gravity)
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
        end associate
    end subroutine find_forces

end module spintop_extreme_lanes
