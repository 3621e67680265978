!> Passages that end the motions in lanes, of quantities that are forms of the angular velocity and of the vertical in
!> the axes of the body: components, heights, momenta, energies.
module spintop_form_stop_lanes
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order
    use spintop_kinds, only: dp
    use spintop_lane_series, only: rows
    use spintop_motion, only: motion_t
    use spintop_root_watch, only: of_interval, rounding
    use spintop_stop_lanes, only: stop_lanes_t
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: form_stop_lanes_t, form_columns

    !> The columns that are such forms.
    character(*), parameter :: form_columns(*) = [character(9) :: 'omega1', 'omega2', 'omega3', 'gamma1', 'gamma2', &
                                                  'gamma3', 'axis_z', 'com_z', 'l3', 'lz', 'kinetic', &
                                                  'potential', 'energy']
    !> A value so close to its level at the start, relatively, is at the level.
    real(dp), parameter :: start_rounding = 16 * epsilon(1.0_dp)

    !> Ends a motion at the n-th passage of a level. `set_form`, then hand it over.
    type, extends(stop_lanes_t) :: form_stop_lanes_t
        character(len(form_columns)), private :: column = ''
        real(dp), private :: threshold = 0
        !> The form: linear in omega and Gamma, and in the products omega_i omega_i and omega_i Gamma_i.
        real(dp), private :: linear(lanes, 6) = 0, squares(lanes, 3) = 0, products(lanes, 3) = 0
        logical, private :: is_linear = .true.
    contains
        procedure :: set_form
        procedure :: begin
        procedure :: find_polynomials
    end type form_stop_lanes_t

contains

    !> The n-th passage of a value.
    pure subroutine set_form(self, column, level, rising, falling, n)
        class(form_stop_lanes_t), intent(inout) :: self
        character(*), intent(in) :: column !! one of `form_columns`
        real(dp), intent(in) :: level !! in the unit of the column
        logical, intent(in) :: rising, falling !! which passages count
        integer, intent(in) :: n !! number of the event that ends the motion
        self%column = column
        self%threshold = level
        self%is_linear = .not. (column == 'lz' .or. column == 'kinetic' .or. column == 'energy')
        call self%count_passages(rising, falling, n)
    end subroutine set_form

    !> A case begins in a lane. The start itself is no event.
    subroutine begin(self, run, lane, body, start)
        class(form_stop_lanes_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties of the body
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: value, sizes(lanes)
        call self%stop_lanes_t%begin(run, lane, body, start)
        call take_form(self, lane, body)
        associate (w => run%now%state(lane, 1:3), g => run%now%state(lane, 4:6))
            value = sum(self%linear(lane, :) * [w, g]) + sum(self%squares(lane, :) * w**2) &
                + sum(self%products(lane, :) * w * g)
        end associate
        sizes = sizes_of_terms(self, run%now%state(:, 1:3))
        self%sign(lane) = 0
        if (abs(value - self%threshold) > start_rounding * sizes(lane)) then
            self%sign(lane) = sign(1.0_dp, value - self%threshold)
        end if
    end subroutine begin

    !> The form of the column, of a body.
    pure subroutine take_form(self, lane, body)
        class(form_stop_lanes_t), intent(inout) :: self
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        associate (linear => self%linear, squares => self%squares, products => self%products)
            linear(lane, :) = 0
            squares(lane, :) = 0
            products(lane, :) = 0
            select case (self%column)
            case ('omega1')
                linear(lane, 1) = 1
            case ('omega2')
                linear(lane, 2) = 1
            case ('omega3')
                linear(lane, 3) = 1
            case ('gamma1')
                linear(lane, 4) = 1
            case ('gamma2')
                linear(lane, 5) = 1
            case ('gamma3', 'axis_z')
                linear(lane, 6) = 1
            case ('com_z')
                linear(lane, 4:6) = body%centre_of_mass
            case ('l3')
                linear(lane, 3) = body%inertia(3)
            case ('lz')
                products(lane, :) = body%inertia
            case ('kinetic')
                squares(lane, :) = body%inertia / 2
            case ('potential')
                linear(lane, 4:6) = body%mass * body%gravity * body%centre_of_mass
            case ('energy')
                squares(lane, :) = body%inertia / 2
                linear(lane, 4:6) = body%mass * body%gravity * body%centre_of_mass
            end select
        end associate
    end subroutine take_form

    !> What the rounding of the form and its level is relative to: each component of a vector has that of the whole vector.
    pure function sizes_of_terms(self, omega) result(sizes)
        class(form_stop_lanes_t), intent(in) :: self
        real(dp), intent(in) :: omega(lanes, 3)
        real(dp) :: sizes(lanes)
        sizes = abs(self%threshold) + sum(abs(self%linear(:, 4:6)), 2) + sum(self%squares, 2) * sum(omega**2, 2) &
            + (sum(abs(self%linear(:, 1:3)), 2) + sum(self%products, 2)) * sqrt(sum(omega**2, 2))
    end function sizes_of_terms

    !> The form above the level.
    subroutine find_polynomials(self, run, degree, a, noise)
        class(form_stop_lanes_t), intent(in) :: self
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        integer, intent(out) :: degree !! degree of the polynomials
        real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of errors beside the rounding of their terms
        degree = run%order
        call find_form(self, degree, run%c, a)
        a(:, 0) = a(:, 0) - self%threshold
        call of_interval(degree, run%power, a)
        noise = rounding * sizes_of_terms(self, run%c(:, 1:3, 0))
    end subroutine find_polynomials

    !> The series of the form.
    pure subroutine find_form(self, degree, c, a)
        class(form_stop_lanes_t), intent(in) :: self
        integer, intent(in) :: degree
        real(dp), intent(in) :: c(lanes, rows, 0:degree)
        real(dp), intent(out) :: a(lanes, 0:max_series_order)
        integer :: i, k, m
        do k = 0, degree
            !$omp simd
            do i = 1, lanes
                a(i, k) = self%linear(i, 1) * c(i, 1, k) + self%linear(i, 2) * c(i, 2, k) + self%linear(i, 3) * c(i, 3, k) &
                    + self%linear(i, 4) * c(i, 4, k) + self%linear(i, 5) * c(i, 5, k) + self%linear(i, 6) * c(i, 6, k)
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

end module spintop_form_stop_lanes
