!> Taylor's method in quadruple precision: for reference motions, and for motions that amplify rounding errors
!> so much that double precision cannot follow them.
!>
!> The state is the sum of two numbers in double precision, `y + rest`, 106 bits. Series and sums are in
!> quadruple precision.
module spintop_taylor_quadruple
    use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_value
    use spintop_kinds, only: dp, qp
    use spintop_compare, only: is_finite, is_zero
    use spintop_formulation, only: formulation_info_t, max_series_order, max_states
    use spintop_status, only: status_ok, status_non_finite, status_step_too_small
    use spintop_stepper, only: stepper_t
    use spintop_taylor, only: safety, smallest_spacings, stretch
    implicit none
    private
    public :: taylor_quadruple_t

    !> Taylor's method of the highest order, in quadruple precision.
    type, extends(stepper_t) :: taylor_quadruple_t
        real(qp) :: coefficient(max_states, 0:max_series_order) = 0
        !> Index of the first component of the quaternion, and number of components in use.
        integer :: attitude = 1, states = max_states
    contains
        procedure :: begin
        procedure :: advance
        procedure :: state_within
    end type taylor_quadruple_t

contains

    !> First slope.
    subroutine begin(self, status)
        class(taylor_quadruple_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(formulation_info_t) :: info
        call self%set_weight()
        info = self%formulation%info()
        self%attitude = info%quaternion
        self%states = info%states
        associate (exact => self%formulation%quadruple_start())
            if (is_zero(self%t) .and. any(abs(exact) > 0)) self%rest = real(exact - self%y, dp)
        end associate
        call self%evaluate(self%t, self%y, self%slope, status)
    end subroutine begin

    !> One step, of the size that the last terms of the series allow.
    subroutine advance(self, status)
        class(taylor_quadruple_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(qp) :: y(max_states)
        real(dp) :: h, t_new, y_new(max_states), rest(max_states)
        logical :: changed

        y = self%rest + real(self%y, qp)
        call self%formulation%expand_quadruple(self%t, y, max_series_order, self%coefficient)
        self%counts%evaluations = self%counts%evaluations + max_series_order
        self%slope = real(self%coefficient(:, 1), dp)
        h = length_of_step(self)
        status = status_non_finite
        if (.not. is_finite(h)) return
        status = status_step_too_small
        if (h <= smallest_spacings * spacing(self%t)) return
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
    end subroutine advance

    !> The time at which one of the last two terms reaches the tolerance, relative to the magnitude of the
    !> attitude, or of the momentum; not finite if a term is not.
    pure real(dp) function length_of_step(self) result(h)
        class(taylor_quadruple_t), intent(in) :: self
        integer :: i
        h = self%t_end - self%t
        associate (q => self%attitude)
            call shorten(self, [(i, i=q, q + 3)], h)
            call shorten(self, [(i, i=1, q - 1), (i, i=q + 4, self%states)], h)
        end associate
    end function length_of_step

    !> Reduces a step to the size that components of equal units allow.
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
    function state_within(self, t) result(y)
        class(taylor_quadruple_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        y = real(self%coefficient(:, 0) + sum_of_terms(self, t - real(self%t_last, qp)), dp)
    end function state_within

end module spintop_taylor_quadruple
