!> The quantities of `spintop_measures` along motions: polynomials of each step in lanes that pass zero where a quantity passes its
!> level, or where its slope passes zero, and values at states, of single motions as well.
module spintop_watched_quantities
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_constancy, only: driven_rate, greatest_fall_rate
    use spintop_formulation, only: max_series_order
    use spintop_kernel_types, only: lane_body_t
    use spintop_kinds, only: dp, cross
    use spintop_bernstein, only: multiply, multiply_slopes, rounding, square
    use spintop_lane_series, only: numerator, parts, rows
    use spintop_measures, only: watch_centre_height, watch_energy, watch_kinetic_energy, watch_nothing, watch_nutation_rate, &
        watch_omega, watch_phi, watch_potential_energy, watch_precession_rate, watch_psi, watch_spin_momentum, watch_theta, &
        watch_total_force, watch_turning, watch_vertical, watch_vertical_force, watch_vertical_momentum
    use spintop_pole_passages, only: through_pole
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: watched_t

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

    !> The quantity of a body in a lane, and its level.
    pure subroutine set_lane(self, lane, body, omega, level)
        class(watched_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        real(dp), intent(in) :: omega(3), level !! angular velocity at the start, rad/s, and the level
        real(dp) :: linear(3), squares(3), products(3)

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
        if (self%quantity == watch_total_force) then
            self%axes(lane, :, :) = axes_along(body%centre_of_mass)
            self%arm(lane) = norm2(body%centre_of_mass)
        end if
    end subroutine set_lane

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

    !> The noise of a quantity: attitude and angular velocity are known to rounding (`spintop_constancy`).
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

    !> The form, or of lower degree its derivatives.
    pure subroutine find_form(self, order, c, degree, power, a)
        class(watched_t), intent(in) :: self
        integer, intent(in) :: order, degree
        real(dp), intent(in) :: c(lanes, rows, 0:order), power(lanes, 0:order)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes, 0:max_series_order) :: w, x, product
        integer :: i, m
        call find_linear(order, c, self%row, self%linear, degree, power, a)
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

    !> A linear form of three rows, times powers. Here and below the series come as an array of known shape: behind a pointer they
    !> would be read number by number.
    pure subroutine find_linear(order, c, row, factor, degree, power, a)
        integer, intent(in) :: order, row, degree
        real(dp), intent(in) :: c(lanes, rows, 0:order), factor(lanes, 3), power(lanes, 0:order)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        real(dp) :: of_derivative
        integer :: i, k, m, n
        n = order - degree
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
    end subroutine find_linear

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

end module spintop_watched_quantities
