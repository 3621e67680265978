!> Taylor's method: each step sums the power series of the motion, whose coefficients follow from recurrences.
!>
!> The step size is such that the last two terms of the series are within the tolerance. The order of least
!> cost grows with the required digits (Jorba and Zou, Experimental Mathematics 14, 2005; they give
!> 1 - ln(tolerance)/2, but here coefficients of high order are cheap). The series is its own dense output.
!> The state is summed with compensation.
!>
!> In quadruple precision: for reference motions, and for motions that amplify rounding errors so much that double precision
!> cannot follow them. There the state is the sum of two numbers in double precision, `y + rest`, 106 bits. Series and sums are
!> in quadruple precision.
module spintop_taylor
    use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp, qp, is_finite, is_zero
    use spintop_formulation, only: max_series_order, max_states, structure_series
    use spintop_motions, only: instants
    use spintop_status, only: status_non_finite, status_ok, status_step_too_small
    use spintop_stepper, only: method_info_t, smallest_step, stepper_t
    implicit none
    private
    public :: taylor_t, taylor_quadruple_t, taylor_info, order_for, safety, largest_growth, stretch

    !> Taylor's method, with an order that depends on the tolerance.
    type, extends(stepper_t) :: taylor_t
        !> Order of the series of the last step, and that series.
        integer :: degree = 0
        real(dp), allocatable :: coefficient(:, :)
        !> What a coefficient may have lost by underflow, its own or that of products in it.
        real(dp) :: least = 0
    contains
        procedure :: begin
        procedure :: advance
        procedure :: state_within
        procedure :: states_within
        procedure :: bound_of_changes
        procedure :: order
    end type taylor_t

    !> Its properties, for single motions and in lanes.
    type(method_info_t), parameter :: taylor_info = method_info_t( &
        'taylor', 'Taylor series of order 8 to 30, chosen by the tolerance', adaptive=.true., needs=structure_series, &
        finest_tolerance=1.0e-20_dp, share=0.02_dp, runs_in_lanes=.true.)
    !> The order, found by measurement: that for the tolerance 1, its increase per digit, and the lowest.
    real(dp), parameter :: order_at_one = 12, order_a_digit = 1.15_dp
    integer, parameter :: lowest_order = 8
    !> Fraction of the step size at which the last terms reach the tolerance.
    real(dp), parameter :: safety = 0.9_dp
    !> Largest ratio of a step to the one before.
    real(dp), parameter :: largest_growth = 4
    !> A step is stretched to the end if this factor suffices.
    real(dp), parameter :: stretch = 1.01_dp

    ! What is done with the terms of a series: kernel_list.h.
    interface
        real(c_double) function c_take_step(order, of_denominator, turn_rate, coefficient, absolute, relative, scale, least, &
            last_h, safety, growth, stretch, t, t_end, y, rest, t_new, y_new, rest_new) bind(C, name='spintop_take_step')
            import :: c_double, c_int
            integer(c_int), value :: order, of_denominator
            real(c_double), value :: turn_rate, least, last_h, safety, growth, stretch, t, t_end
            real(c_double), dimension(*), intent(in) :: coefficient, absolute, relative, scale, y, rest
            real(c_double), intent(out) :: t_new, y_new(*), rest_new(*)
        end function c_take_step

        subroutine c_add_terms(order, of_denominator, turn_rate, coefficient, y, h, change) bind(C, name='spintop_add_terms')
            import :: c_double, c_int
            integer(c_int), value :: order, of_denominator
            real(c_double), value :: turn_rate, h
            real(c_double), intent(in) :: coefficient(*), y(*)
            real(c_double), intent(out) :: change(*)
        end subroutine c_add_terms

        subroutine c_add_terms_at(order, of_denominator, turn_rate, coefficient, y, h, change) &
            bind(C, name='spintop_add_terms_at')
            import :: c_double, c_int
            integer(c_int), value :: order, of_denominator
            real(c_double), value :: turn_rate
            real(c_double), intent(in) :: coefficient(*), y(*), h(*)
            real(c_double), intent(out) :: change(*)
        end subroutine c_add_terms_at
    end interface

    !> Taylor's method of the highest order, in quadruple precision.
    type, extends(stepper_t) :: taylor_quadruple_t
        real(qp) :: coefficient(max_states, 0:max_series_order) = 0
    contains
        procedure :: begin => begin_quadruple
        procedure :: advance => advance_quadruple
        procedure :: state_within => state_in_quadruple
    end type taylor_quadruple_t

contains

    !> Order in use.
    integer function order(self)
        class(taylor_t), intent(in) :: self
        order = order_for(self%controls%relative_tolerance, order_at_one, order_a_digit)
    end function order

    !> Order of least cost for a relative tolerance: a linear function of its digits.
    pure integer function order_for(tolerance, at_one, a_digit) result(order)
        real(dp), intent(in) :: tolerance !! relative tolerance
        real(dp), intent(in) :: at_one, a_digit !! for the tolerance 1, and for each digit more
        order = nint(at_one - a_digit * log10(tolerance))
        order = min(max(order, lowest_order), max_series_order)
    end function order_for

    !> First slope, the order, and the span as the longest step.
    subroutine begin(self, status)
        class(taylor_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        real(dp) :: rate

        call self%set_weight(self%controls%relative_tolerance, self%controls%absolute_tolerance)
        call self%evaluate(self%t, self%y, self%slope, status)
        self%degree = self%order()
        ! A run that goes on from within a step still needs the series of that step, which is of the same order.
        if (allocated(self%coefficient)) then
            if (ubound(self%coefficient, 2) /= self%degree) deallocate (self%coefficient)
        end if
        if (.not. allocated(self%coefficient)) allocate (self%coefficient(max_states, 0:self%degree))
        ! Products of two variables are multiplied by a rate over a momentum at most, or by a torque.
        associate (n => self%weight%states, scale => self%formulation%scale)
            rate = maxval(abs(self%slope(:n)) / scale(:n))
            self%least = tiny(self%least) * max(1.0_dp, rate / minval(scale(:n)), rate * maxval(scale(:n)))
        end associate
        self%h = self%t_end - self%t
    end subroutine begin

    !> One step, of the size that the last terms of the series allow.
    subroutine advance(self, status)
        class(taylor_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: h, t_new, y_new(max_states), rest(max_states)
        logical :: changed

        call self%formulation%expand(self%t, self%y, self%degree, self%coefficient)
        self%counts%evaluations = self%counts%evaluations + self%degree
        associate (w => self%weight, series => self%formulation)
            h = c_take_step(self%degree, series%of_denominator, series%turn_rate, self%coefficient, w%absolute, w%relative, &
                            series%scale, self%least, self%h, safety, largest_growth, stretch, self%t, self%t_end, self%y, &
                            self%rest, t_new, y_new, rest)
        end associate
        status = status_non_finite
        if (.not. abs(h) <= huge(h)) return
        status = status_step_too_small
        if (h <= smallest_step(h, self%t)) return
        self%h = h
        ! Terms that are NaN do not show in the largest magnitude.
        status = status_non_finite
        if (.not. all(abs(y_new) <= huge(h))) return
        self%rest = rest
        call self%accept_step(t_new, y_new, changed)
        status = status_ok
    end subroutine advance

    !> The state at a time within the last step.
    function state_within(self, t) result(y)
        class(taylor_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states), change(max_states)
        associate (series => self%formulation)
            call c_add_terms(self%degree, series%of_denominator, series%turn_rate, self%coefficient, self%y_last, &
                             t - self%t_last, change)
        end associate
        y = self%y_last + change
    end function state_within

    !> The states at several times within the last step, all by the same instructions.
    subroutine states_within(self, t, y)
        class(taylor_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times, s
        real(dp), intent(out) :: y(instants, max_states) !! states
        integer :: n

        associate (series => self%formulation)
            call c_add_terms_at(self%degree, series%of_denominator, series%turn_rate, self%coefficient, self%y_last, &
                                t - self%t_last, y)
        end associate
        do n = 1, max_states
            y(:, n) = self%y_last(n) + y(:, n)
        end do
    end subroutine states_within

    !> Bounds of the changes within the last step, where the variables of the series are the state: the sums of the magnitudes
    !> of all terms at its end.
    pure function bound_of_changes(self) result(bound)
        class(taylor_t), intent(in) :: self
        real(dp) :: bound(max_states), h
        integer :: k, n
        bound = 0
        h = self%t - self%t_last
        do k = self%degree, 1, -1
            !$omp simd
            do n = 1, max_states
                bound(n) = (bound(n) + abs(self%coefficient(n, k))) * h
            end do
        end do
    end function bound_of_changes

    !> First slope.
    subroutine begin_quadruple(self, status)
        class(taylor_quadruple_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call self%set_weight(self%controls%relative_tolerance, self%controls%absolute_tolerance)
        associate (exact => self%formulation%quadruple_start())
            if (is_zero(self%t) .and. any(abs(exact) > 0)) self%rest = real(exact - self%y, dp)
        end associate
        call self%evaluate(self%t, self%y, self%slope, status)
    end subroutine begin_quadruple

    !> One step, of the size that the last terms of the series allow.
    subroutine advance_quadruple(self, status)
        class(taylor_quadruple_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(qp) :: y(max_states)
        real(dp) :: h, t_new, y_new(max_states), rest(max_states)
        integer :: i
        logical :: changed

        y = self%rest + real(self%y, qp)
        call self%formulation%expand_quadruple(self%t, y, max_series_order, self%coefficient)
        self%counts%evaluations = self%counts%evaluations + max_series_order
        self%slope = real(self%coefficient(:, 1), dp)
        h = self%t_end - self%t
        associate (q => self%formulation%attitude)
            call shorten(self, [(i, i=q, q + 3)], h)
            call shorten(self, [(i, i=1, q - 1), (i, i=q + 4, self%weight%states)], h)
        end associate
        status = status_non_finite
        if (.not. is_finite(h)) return
        status = status_step_too_small
        if (h <= smallest_step(h, self%t)) return
        t_new = self%t + h
        if (stretch * h >= self%t_end - self%t) t_new = self%t_end
        y = y + sum_of_terms(self, t_new - real(self%t, qp))
        y_new = real(y, dp)
        status = status_non_finite
        if (.not. all(abs(y_new) <= huge(1.0_dp))) return
        rest = real(y - y_new, dp)
        call self%accept_step(t_new, y_new, changed)
        if (.not. changed) self%rest = rest
        status = status_ok
    end subroutine advance_quadruple

    !> Reduces a step to the time at which one of the last two terms reaches the tolerance, relative to the magnitude of components
    !> of equal units, attitude or momentum; not finite if a term is not.
    pure subroutine shorten(self, like, h)
        class(taylor_quadruple_t), intent(in) :: self
        integer, intent(in) :: like(:)
        real(dp), intent(inout) :: h
        real(qp) :: allowed, term
        integer :: k

        if (.not. is_finite(h)) return
        associate (c => self%coefficient, weight => self%weight)
            allowed = maxval(weight%absolute(like)) + maxval(weight%relative(like)) * maxval(abs(c(like, 0)))
            do k = max_series_order - 1, max_series_order
                term = maxval(abs(c(like, k)))
                if (.not. all(abs(c(like, k)) <= huge(term))) h = ieee_value(h, ieee_positive_inf)
                if (.not. is_finite(h)) return
                if (term > 0) h = min(h, real(safety * exp((log(allowed) - log(term)) / k), dp))
            end do
        end associate
    end subroutine shorten

    !> Change of the state after a time h, by Horner's rule.
    pure function sum_of_terms(self, h) result(change)
        class(taylor_quadruple_t), intent(in) :: self
        real(qp), intent(in) :: h
        real(qp) :: change(max_states)
        integer :: k
        change = 0
        do k = max_series_order, 1, -1
            change = (change + self%coefficient(:, k)) * h
        end do
    end function sum_of_terms

    !> The state at a time within the last step.
    function state_in_quadruple(self, t) result(y)
        class(taylor_quadruple_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        y = real(self%coefficient(:, 0) + sum_of_terms(self, t - real(self%t_last, qp)), dp)
    end function state_in_quadruple

end module spintop_taylor
