!> A watch that looks for the roots of a polynomial in each step: turning points, extremes, passages of levels.
!>
!> What extends it gives the polynomials of a step and takes the roots. One root in a lane is found by
!> Newton's method in all lanes at once, several in the lanes that have them. A root at the end of a step is
!> found once: the sign there is carried to the next.
module spintop_root_watch
    use spintop_kinds, only: dp
    use spintop_formulation, only: max_series_order
    use spintop_lane_polynomials, only: find_changes, find_roots, most_roots, refine_root, rounding
    use spintop_lane_series, only: parts, rows
    use spintop_lane_steps, only: terms_at
    use spintop_lane_watch, only: lane_watch_t
    use spintop_taylor_lanes, only: lanes, taylor_lanes_t
    implicit none
    private
    public :: root_watch_t, find_derivatives, find_height_rates, find_row, of_interval, rounding, states_at

    !> A watch for roots.
    type, abstract, extends(lane_watch_t) :: root_watch_t
        !> Sign of the polynomial at the end of the last step; `begin` sets that of the start, 0 where it is none.
        real(dp) :: sign(lanes) = 0
    contains
        procedure(find_polynomials), deferred :: find_polynomials
        procedure(take), deferred :: take
        procedure :: look
    end type root_watch_t

    abstract interface
        !> The polynomials over the step as the unit interval, of degree `order` - 1 or `order`, and how much they are off
        !> beside the rounding of their terms.
        subroutine find_polynomials(self, run, degree, a, noise)
            import :: dp, lanes, max_series_order, root_watch_t, taylor_lanes_t
            class(root_watch_t), intent(in) :: self
            type(taylor_lanes_t), intent(in) :: run !! the lanes
            integer, intent(out) :: degree !! degree of the polynomials
            real(dp), intent(out) :: a(lanes, 0:max_series_order), noise(lanes)
            !! coefficients, and a bound of further errors
        end subroutine find_polynomials

        !> Takes the roots at the shares `u` of the step: where the polynomial rises `slope` is positive, where it
        !> falls negative, and where there is no root zero. Those of a lane come in rising order.
        subroutine take(self, run, u, slope)
            import :: dp, lanes, root_watch_t, taylor_lanes_t
            class(root_watch_t), intent(inout) :: self
            type(taylor_lanes_t), intent(inout) :: run !! the lanes
            real(dp), intent(in) :: u(lanes), slope(lanes)
            !! roots as fractions of the step; sign of the slope at each, 0 in lanes without a root
        end subroutine take
    end interface

contains

    !> Finds the roots in the last step.
    subroutine look(self, run)
        class(root_watch_t), intent(inout) :: self
        type(taylor_lanes_t), intent(inout) :: run !! the lanes
        real(dp) :: a(lanes, 0:max_series_order)
        real(dp), dimension(lanes) :: noise, before, changes, u, doubt, slope
        real(dp) :: roots(most_roots), signs(most_roots)
        integer :: lane, k, found, degree

        call self%find_polynomials(run, degree, a, noise)
        before = self%sign
        call find_changes(degree, a, noise, self%sign, changes, u)
        if (.not. maxval(changes) > 0) return
        call refine_root(degree, a, u, doubt)
        slope = merge(self%sign, 0.0_dp, changes > 0 .and. changes < 2 .and. .not. doubt > 0)
        call self%take(run, u, slope)
        do lane = 1, lanes
            if (.not. (changes(lane) > 1 .or. (changes(lane) > 0 .and. doubt(lane) > 0))) cycle
            self%sign(lane) = before(lane)
            call find_roots(a(lane, :degree), noise(lane), self%sign(lane), roots, signs, found)
            do k = 1, found
                u = 0
                slope = 0
                u(lane) = roots(k)
                slope(lane) = signs(k)
                call self%take(run, u, slope)
            end do
        end do
    end subroutine look

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

    !> The series of Gamma3', by the time since the step began, and what cancels in its first term.
    pure subroutine find_height_rates(order, c, degree, x, noise)
        integer, intent(in) :: order, degree !! order of the series, last term
        real(dp), intent(in) :: c(lanes, rows, 0:order) !! series
        real(dp), intent(out) :: x(lanes, 0:degree), noise(lanes) !! coefficients of Gamma3'; its rounding
        integer :: i, k
        do k = 0, degree
            !$omp simd
            do i = 1, lanes
                x(i, k) = (k + 1) * c(i, 6, k + 1)
            end do
        end do
        noise = rounding * (abs(c(:, 4, 0) * c(:, 2, 0)) + abs(c(:, 5, 0) * c(:, 1, 0)))
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

end module spintop_root_watch
