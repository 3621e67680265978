!> Taylor's method: each step sums the power series of the motion, found by recurrences.
!>
!> A step is as long as the last two terms of the series are within the tolerance, and the order at
!> which a tolerance costs least grows with the digits asked for (Jorba and Zou, Experimental
!> Mathematics 14, 2005; they give 1 - ln(tolerance)/2, but here coefficients of high order are
!> cheap). The series is its own dense output. The state is summed with compensation.
module spintop_taylor
    use spintop_kinds, only: dp
    use spintop_compare, only: is_finite
    use spintop_formulation, only: formulation_t, max_series_order, max_states
    use spintop_status, only: status_ok, status_non_finite, status_step_too_small
    use spintop_stepper, only: stepper_t, workspace_t
    implicit none
    private
    public :: taylor_t, order_for, safety, largest_growth, smallest_spacings, stretch

    !> Taylor's method of an order that the tolerance sets.
    type, extends(stepper_t) :: taylor_t
    contains
        procedure :: new_workspace
        procedure :: begin
        procedure :: advance
        procedure :: interpolate
        procedure :: order
    end type taylor_t

    !> Keeps the series of the last step.
    type, extends(workspace_t) :: taylor_workspace_t
        integer :: order = 0
        real(dp) :: coefficient(max_states, 0:max_series_order) = 0
    end type taylor_workspace_t

    !> Orders in use are found by measurement: for the tolerance 1, for each digit more, and the lowest.
    real(dp), parameter :: order_at_one = 12, order_a_digit = 1.15_dp
    integer, parameter :: lowest_order = 8
    !> Share of the step with which the last terms reach the tolerance.
    real(dp), parameter :: safety = 0.9_dp
    !> A step is at most so many times the last.
    real(dp), parameter :: largest_growth = 4
    !> Smallest step in units of the spacing of the time.
    real(dp), parameter :: smallest_spacings = 16
    !> A step that so many times its length would bring to the end is stretched to it.
    real(dp), parameter :: stretch = 1.01_dp

contains

    !> Order in use.
    integer function order(self)
        class(taylor_t), intent(in) :: self
        order = order_for(self%controls%relative_tolerance, order_at_one, order_a_digit)
    end function order

    !> Order that costs least for a relative tolerance, a line over its digits.
    pure integer function order_for(tolerance, at_one, a_digit) result(order)
        real(dp), intent(in) :: tolerance
        real(dp), intent(in) :: at_one, a_digit !! for the tolerance 1, and for each digit more
        order = nint(at_one - a_digit * log10(tolerance))
        order = min(max(order, lowest_order), max_series_order)
    end function order_for

    !> A workspace with room for a series.
    subroutine new_workspace(self, work)
        class(taylor_t), intent(in) :: self
        class(workspace_t), allocatable, intent(out) :: work
        associate (unused => self)
        end associate
        allocate (taylor_workspace_t :: work)
    end subroutine new_workspace

    !> First slope, the order, and the span as the longest step.
    subroutine begin(self, formulation, work, status)
        class(taylor_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        integer, intent(out) :: status

        call self%set_weight(formulation, work)
        call work%evaluate(formulation, work%y, work%slope, status)
        select type (work)
        class is (taylor_workspace_t)
            work%order = self%order()
            work%h = work%t_end - work%t
        end select
    end subroutine begin

    !> One step, as long as the last terms of the series allow.
    subroutine advance(self, formulation, work, status)
        class(taylor_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        integer, intent(out) :: status
        real(dp) :: h, t_new, change(max_states)
        logical :: changed

        associate (unused => self)
        end associate
        select type (work)
        class is (taylor_workspace_t)
            call formulation%series(work%y, work%order, work%coefficient)
            work%counts%evaluations = work%counts%evaluations + work%order
            h = length_of_step(work)
            status = status_non_finite
            if (.not. is_finite(h)) return
            status = status_step_too_small
            if (h <= smallest_spacings * spacing(work%t)) return
            work%h = h
            t_new = work%t + h
            if (stretch * h >= work%t_end - work%t) t_new = work%t_end
            change = sum_of_terms(work, t_new - work%t)
            call formulation%unfold(work%y, t_new - work%t, change)
            ! Terms that are no number do not show in the magnitude of the largest.
            status = status_non_finite
            if (.not. all(abs(change) <= huge(1.0_dp))) return
            call work%settle_change(formulation, t_new, change, changed)
            status = status_ok
        end select
    end subroutine advance

    !> The time after which one of the last two terms reaches the tolerance.
    pure real(dp) function length_of_step(work) result(h)
        type(taylor_workspace_t), intent(in) :: work
        real(dp) :: allowed, last, before, share, growth
        integer :: i

        last = 0
        before = 0
        associate (c => work%coefficient, p => work%order, w => work%weight)
            !$omp simd reduction(max: last, before)
            do i = 1, max_states
                ! A component that passes zero is as large as it was or will be a step away.
                allowed = w%absolute(i) + w%relative(i) * (abs(c(i, 0)) + min(abs(c(i, 1)) * work%h, w%scale(i)))
                share = 1 / allowed
                last = max(last, abs(c(i, p)) * share)
                before = max(before, abs(c(i, p - 1)) * share)
            end do
            growth = -huge(growth)
            if (last > 0) growth = log(last) / p
            if (before > 0) growth = max(growth, log(before) / (p - 1))
            h = min(largest_growth * work%h, safety * exp(-growth))
            if (.not. (is_finite(last) .and. is_finite(before))) h = last + before
        end associate
    end function length_of_step

    !> Change of the variables of the series after a time h, by Horner's rule: terms of odd and of even
    !> order by themselves, as each waits for the last.
    pure function sum_of_terms(work, h) result(change)
        type(taylor_workspace_t), intent(in) :: work
        real(dp), intent(in) :: h
        real(dp) :: change(max_states), odd(max_states), even(max_states), square
        integer :: k
        square = h**2
        odd = 0
        do k = work%order - mod(work%order + 1, 2), 1, -2
            odd = odd * square + work%coefficient(:, k)
        end do
        even = 0
        do k = work%order - mod(work%order, 2), 2, -2
            even = even * square + work%coefficient(:, k)
        end do
        change = odd * h + even * square
    end function sum_of_terms

    !> The state at a time within the last step.
    function interpolate(self, formulation, work, t) result(y)
        class(taylor_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        real(dp), intent(in) :: t
        real(dp) :: y(max_states), change(max_states)
        associate (unused => self)
        end associate
        y = work%y
        if (t >= work%t) return
        select type (work)
        class is (taylor_workspace_t)
            change = sum_of_terms(work, t - work%t_last)
            call formulation%unfold(work%y_last, t - work%t_last, change)
            y = work%y_last + change
        end select
    end function interpolate

end module spintop_taylor
