!> A monitor that finds the roots of a polynomial in each step: turning points, extremes, passages of levels.
!>
!> What extends it gives the polynomials of a step and takes the roots. One root in a lane is found by
!> Newton's method in all lanes at once, several in the lanes that have them. A root at the end of a step is
!> found once: the sign there is carried to the next.
module spintop_root_monitor
    use spintop_constancy, only: margin
    use spintop_kinds, only: dp
    use spintop_formulation, only: max_series_order
    use spintop_lane_polynomials, only: find_changes, find_roots, most_roots, refine_root, rounding
    use spintop_lane_series, only: parts, rows
    use spintop_lane_steps, only: terms_at
    use spintop_lane_monitor, only: lane_monitor_t
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: root_monitor_t, find_derivatives, find_height_rates, find_row, of_interval, rounding, states_at

    !> A monitor of roots.
    type, abstract, extends(lane_monitor_t) :: root_monitor_t
        !> Sign of the polynomial at the end of the last step; `begin` sets that of the start, 0 where it is none.
        real(dp) :: sign(lanes) = 0
        !> What the weight adds to omega in a radian (`driven_rate`), rad/s: set by `begin` where the noise depends on it.
        real(dp) :: driven(lanes) = 0
        !> For `record_roots`: whether a root is one of noise: since the one before, or before that one, the polynomial was
        !> within it.
        logical :: is_noise(lanes) = .false.
        !> Whether the polynomial is zero to rounding; how large it was since the last root, where it was seen.
        logical, private :: is_constant(lanes) = .false., was_noise(lanes) = .false.
        !> Whether either is so in any lane.
        logical, private :: has_constant = .false., had_noise = .false.
        real(dp), private :: far(lanes) = 0
    contains
        procedure(find_polynomials), deferred :: find_polynomials
        procedure(record_roots), deferred :: record_roots
        procedure :: observe
    end type root_monitor_t

    abstract interface
        !> The polynomials over the step as the unit interval, of degree `order` - 1 or `order`, and how much they are off
        !> beside the rounding of their terms.
        subroutine find_polynomials(self, run, degree, a, noise)
            import :: dp, lanes, max_series_order, root_monitor_t, taylor_lanes_t
            class(root_monitor_t), intent(in) :: self
            type(taylor_lanes_t), intent(in) :: run !! the lanes
            integer, intent(out) :: degree !! degree of the polynomials
            real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of further errors
        end subroutine find_polynomials

        !> Records the roots at the shares `u` of the step: where the polynomial rises `slope` is positive, where it falls
        !> negative, and where there is no root zero. Those of a lane come in rising order.
        subroutine record_roots(self, run, u, slope)
            import :: dp, lanes, root_monitor_t, taylor_lanes_t
            class(root_monitor_t), intent(inout) :: self
            type(taylor_lanes_t), intent(inout) :: run !! the lanes
            real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        end subroutine record_roots
    end interface

contains

    !> Finds the roots in the last step.
    subroutine observe(self, run)
        class(root_monitor_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes) :: noise, of_method, before, changes, u, doubt, slope, last
        real(dp) :: roots(most_roots), signs(most_roots)
        integer :: lane, k, found, degree

        call self%find_polynomials(run, degree, a, noise)
        if (any(run%steps == 1)) call judge(self, run, degree, a, noise)
        if (self%has_constant) noise = merge(sqrt(huge(noise)), noise, self%is_constant)
        before = self%sign
        call find_changes(degree, a, noise, self%sign, changes, u)
        self%far = max(self%far, abs(a(:, 0)))
        if (.not. maxval(changes) > 0) return
        call refine_root(degree, a, u, doubt)
        slope = merge(self%sign, 0.0_dp, changes > 0 .and. changes < 2 .and. .not. doubt > 0)
        of_method = noise * (run%method_noise / rounding)
        last = 0
        call find_noise(self, degree, a, of_method, u, slope, last)
        call self%record_roots(run, u, slope)
        do lane = 1, lanes
            if (.not. (changes(lane) > 1 .or. (changes(lane) > 0 .and. doubt(lane) > 0))) cycle
            self%sign(lane) = before(lane)
            call find_roots(a(lane, :degree), noise(lane), self%sign(lane), roots, signs, found)
            do k = 1, found
                u = 0
                slope = 0
                u(lane) = roots(k)
                slope(lane) = signs(k)
                call find_noise(self, degree, a, of_method, u, slope, last)
                call self%record_roots(run, u, slope)
            end do
        end do
    end subroutine observe

    !> Judges, in lanes that took their first step, whether the polynomial is zero to rounding: over as much of the step as the
    !> body turns by a radian.
    pure subroutine judge(self, run, degree, a, noise)
        class(root_monitor_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: degree
        real(dp), intent(in) :: a(lanes, 0:max_series_order), noise(lanes)
        real(dp) :: share, total
        integer :: lane, k
        do lane = 1, lanes
            if (run%steps(lane) /= 1) cycle
            share = 1 / max(1.0_dp, sqrt(run%now%rate(lane)) * run%power(lane, 1))
            total = 0
            do k = degree, 0, -1
                total = total * share + abs(a(lane, k))
            end do
            self%is_constant(lane) = total <= margin * noise(lane)
            self%far(lane) = 0
            self%was_noise(lane) = .false.
        end do
        self%has_constant = any(self%is_constant)
        self%had_noise = any(self%was_noise)
    end subroutine judge

    !> Notes which roots are those of noise. `last` is the root before in this step, or its beginning.
    pure subroutine find_noise(self, degree, a, noise, u, slope, last)
        class(root_monitor_t), intent(inout) :: self
        integer, intent(in) :: degree
        real(dp), intent(in) :: a(lanes, 0:max_series_order), noise(lanes), u(lanes), slope(lanes)
        real(dp), intent(inout) :: last(lanes)
        real(dp), dimension(lanes) :: before, after
        real(dp) :: doubt
        logical :: is_root, is_near
        integer :: i
        call find_values(degree, a, (u + 1) / 2, after)
        ! Mostly the polynomial was beyond its noise since the root before.
        doubt = merge(1.0_dp, 0.0_dp, self%had_noise)
        !$omp simd reduction(max: doubt)
        do i = 1, lanes
            doubt = max(doubt, merge(1.0_dp, 0.0_dp, abs(slope(i)) > 0 .and. self%far(i) <= noise(i)))
        end do
        if (.not. doubt > 0) then
            self%is_noise = .false.
            !$omp simd
            do i = 1, lanes
                self%far(i) = merge(abs(after(i)), self%far(i), abs(slope(i)) > 0)
                last(i) = merge(u(i), last(i), abs(slope(i)) > 0)
            end do
            return
        end if
        call find_values(degree, a, (last + u) / 2, before)
        !$omp simd private(is_root, is_near)
        do i = 1, lanes
            is_root = abs(slope(i)) > 0
            is_near = max(self%far(i), abs(before(i))) <= noise(i)
            self%is_noise(i) = is_root .and. (is_near .or. self%was_noise(i))
            self%was_noise(i) = merge(is_near, self%was_noise(i), is_root)
            self%far(i) = merge(abs(after(i)), self%far(i), is_root)
            last(i) = merge(u(i), last(i), is_root)
        end do
        self%had_noise = any(self%was_noise)
    end subroutine find_noise

    !> Values of the polynomials: even and odd powers side by side.
    pure subroutine find_values(degree, a, u, x)
        integer, intent(in) :: degree
        real(dp), intent(in) :: a(lanes, 0:max_series_order), u(lanes)
        real(dp), intent(out) :: x(lanes)
        real(dp) :: odd(lanes)
        integer :: i, k
        x = 0
        odd = 0
        if (mod(degree, 2) == 0) x = a(:, degree)
        do k = degree - 1 - mod(degree + 1, 2), 0, -2
            !$omp simd
            do i = 1, lanes
                x(i) = x(i) * u(i)**2 + a(i, k)
                odd(i) = odd(i) * u(i)**2 + a(i, k + 1)
            end do
        end do
        x = x + u * odd
    end subroutine find_values

    !> A row of the series over the steps as the unit interval. Here and below the series come as an array of known shape:
    !> behind a pointer they would be read number by number.
    pure subroutine find_row(order, c, row, degree, power, x)
        integer, intent(in) :: order, row, degree !! order of the series, index of the row, last term
        real(dp), intent(in) :: c(lanes, rows, 0:order), power(lanes, 0:degree) !! series; powers of the durations
        real(dp), intent(out) :: x(lanes, 0:degree) !! coefficients of the row
        integer :: i, k
        do k = 0, degree
            !$omp simd
            do i = 1, lanes
                x(i, k) = c(i, row, k) * power(i, k)
            end do
        end do
    end subroutine find_row

    !> The series of a derivative of r.Gamma, by the time since the step began.
    pure subroutine find_derivatives(order, c, r, n, degree, x)
        integer, intent(in) :: order, n, degree !! order of the series, of the derivative, last term
        real(dp), intent(in) :: c(lanes, rows, 0:order), r(lanes, 3) !! series; constant vectors in body axes
        real(dp), intent(out) :: x(lanes, 0:degree) !! coefficients of the derivative
        real(dp) :: factor
        integer :: i, k, m
        do k = 0, degree
            factor = 1
            do m = 1, n
                factor = factor * (k + m)
            end do
            !$omp simd
            do i = 1, lanes
                x(i, k) = factor * (r(i, 1) * c(i, 4, k + n) + r(i, 2) * c(i, 5, k + n) + r(i, 3) * c(i, 6, k + n))
            end do
        end do
    end subroutine find_derivatives

    !> The series of Gamma3', by the time since the step began, and its noise: attitude and angular velocity are known to
    !> rounding (`spintop_constancy`).
    pure subroutine find_height_rates(order, c, driven, degree, x, noise)
        integer, intent(in) :: order, degree !! order of the series, last term
        real(dp), intent(in) :: c(lanes, rows, 0:order), driven(lanes) !! series; see `root_monitor_t`, rad/s
        real(dp), intent(out) :: x(lanes, 0:degree), noise(lanes) !! coefficients of Gamma3'; its noise
        real(dp) :: tilt, across
        integer :: i, k
        do k = 0, degree
            !$omp simd
            do i = 1, lanes
                x(i, k) = (k + 1) * c(i, 6, k + 1)
            end do
        end do
        ! Of Gamma and omega across body z. Not by a function of another module, which costs as much as the series.
        !$omp simd private(tilt, across)
        do i = 1, lanes
            tilt = abs(c(i, 4, 0)) + abs(c(i, 5, 0))
            across = abs(c(i, 1, 0)) + abs(c(i, 2, 0))
            noise(i) = rounding * (across + (tilt + rounding) * (across + driven(i)))
        end do
    end subroutine find_height_rates

    !> A polynomial of the time since the step began, over the step as the unit interval.
    pure subroutine of_interval(degree, power, a)
        integer, intent(in) :: degree !! degree of the polynomials
        real(dp), intent(in) :: power(lanes, 0:degree) !! powers of the durations of the steps
        real(dp), intent(inout) :: a(lanes, 0:degree) !! coefficients, of the powers of t and then of u
        integer :: i, k
        do k = 1, degree
            !$omp simd
            do i = 1, lanes
                a(i, k) = a(i, k) * power(i, k)
            end do
        end do
    end subroutine of_interval

    !> The states t after the beginning of the step.
    pure subroutine states_at(run, t, states)
        type(taylor_lanes_t), intent(in) :: run !! the lanes
        real(dp), intent(in) :: t(lanes) !! times since the beginning of the step, s
        real(dp), intent(out) :: states(lanes, parts) !! the states
        call terms_at(run%order, run%c, t, states)
        call add_changes(run%c, t, states)
    end subroutine states_at

    !> Adds the first terms of the series to changes of the states over the times t, which are divided by these.
    pure subroutine add_changes(c, t, states)
        real(dp), intent(in) :: c(lanes, rows, 0:0), t(lanes)
        real(dp), intent(inout) :: states(lanes, parts)
        integer :: i, m
        do m = 1, parts
            !$omp simd
            do i = 1, lanes
                states(i, m) = c(i, m, 0) + t(i) * states(i, m)
            end do
        end do
    end subroutine add_changes

end module spintop_root_monitor
