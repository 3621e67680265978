!> A root between two arguments at which a function has opposite signs, by Chandrupatla's method (Adv. Eng.
!> Software 28, 1997): inverse quadratic interpolation where it is safe, else bisection. The caller evaluates
!> the function:
!>
!>     call bracket%begin(a, f(a), b, f(b), tolerance)
!>     do while (.not. bracket%found)
!>         call bracket%add_value(f(bracket%trial))
!>     end do                                        ! the root is bracket%trial, if bracket%status is ok
!>
!> The search ends for any function: after `patience` values it bisects.
module spintop_bracket
    use spintop_kinds, only: dp, is_finite, is_zero
    use spintop_status, only: status_ok, status_bad_input, status_non_finite
    implicit none
    private
    public :: bracket_t

    !> Interpolation is over long before so many values, or is of no use.
    integer, parameter :: patience = 100

    !> State of a search: the root lies between `a`, the latest argument, and `b`.
    type :: bracket_t
        !> Next argument at which the function is needed; the root once `found` is true.
        real(dp) :: trial = 0
        logical :: found = .false.
        !> `status_ok`; `status_bad_input`: not two finite arguments with finite values of opposite signs;
        !> `status_non_finite`: the function has a value that is not finite. With these it is `found` that there is
        !> no root to be had.
        integer :: status = status_ok
        !> Value of the function at the root.
        real(dp) :: residual = 0
        real(dp), private :: a = 0, fa = 0, b = 0, fb = 0, tolerance = 0
        !> Number of values of the function so far.
        integer, private :: taken = 0
    contains
        procedure :: begin
        procedure :: add_value
    end type bracket_t

contains

    !> Starts between `a` and `b`, where the function has the values `fa` and `fb` of opposite signs,
    !> one of them perhaps zero. The root will be known to `tolerance`, or to the spacing of the numbers there.
    pure subroutine begin(self, a, fa, b, fb, tolerance)
        class(bracket_t), intent(inout) :: self
        real(dp), intent(in) :: a, fa, b, fb, tolerance !! two arguments with the values there; tolerance of the root
        self%a = a
        self%fa = fa
        self%b = b
        self%fb = fb
        self%tolerance = 0
        if (tolerance > 0) self%tolerance = tolerance
        self%taken = 0
        self%status = status_ok
        if (.not. all(is_finite([a, fa, b, fb])) .or. (fa > 0 .and. fb > 0) .or. (fa < 0 .and. fb < 0)) then
            self%status = status_bad_input
        end if
        self%found = self%status /= status_ok
        if (.not. self%found) call aim(self, 0.5_dp)
    end subroutine begin

    !> Adds the value of the function at `trial`.
    pure subroutine add_value(self, value)
        class(bracket_t), intent(inout) :: self
        real(dp), intent(in) :: value !! value of the function at `trial`
        real(dp) :: c, fc, share, place, height

        if (.not. is_finite(value)) then
            self%status = status_non_finite
            self%residual = value
            self%found = .true.
            return
        end if
        self%taken = self%taken + 1
        if ((value > 0) .eqv. (self%fa > 0)) then
            c = self%a
            fc = self%fa
        else
            c = self%b
            fc = self%fb
            self%b = self%a
            self%fb = self%fa
        end if
        self%a = self%trial
        self%fa = value
        share = 0.5_dp
        place = (self%a - self%b) / (c - self%b)
        height = (self%fa - self%fb) / (fc - self%fb)
        if (self%taken < patience .and. height**2 < place .and. (1 - height)**2 < 1 - place) then
            share = self%fa / (self%fb - self%fa) * (fc / (self%fb - fc)) &
                + (c - self%a) / (self%b - self%a) * (self%fa / (fc - self%fa)) * (self%fb / (fc - self%fb))
        end if
        call aim(self, share)
    end subroutine add_value

    !> Sets the next trial at a fraction of the way from `a` to `b`, or ends at the better of the two.
    pure subroutine aim(self, share)
        class(bracket_t), intent(inout) :: self
        real(dp), intent(in) :: share
        real(dp) :: width, least
        logical :: a_is_better

        a_is_better = abs(self%fa) <= abs(self%fb)
        self%residual = merge(self%fa, self%fb, a_is_better)
        width = abs(self%b - self%a)
        self%found = width <= 2 * self%tolerance .or. width <= spacing(max(abs(self%a), abs(self%b))) &
                     .or. is_zero(self%residual)
        if (self%found) then
            self%trial = merge(self%a, self%b, a_is_better)
        else if (.not. is_finite(width) .or. .not. (share > 0 .and. share < 1)) then
            self%trial = self%a / 2 + self%b / 2
        else
            least = self%tolerance / width
            self%trial = self%a + min(1 - least, max(least, share)) * (self%b - self%a)
        end if
    end subroutine aim

end module spintop_bracket
