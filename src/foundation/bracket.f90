!> A root between two arguments where a function has opposite signs (Chandrupatla, Adv. Eng. Software
!> 28, 1997): inverse quadratic interpolation where it is safe, else bisection. The caller evaluates:
!>
!>     call bracket%begin(a, f(a), b, f(b), tolerance)
!>     do while (.not. bracket%found)
!>         call bracket%take(f(bracket%trial))
!>     end do                                        ! the root is bracket%trial
module spintop_bracket
    use spintop_kinds, only: dp
    use spintop_compare, only: is_zero
    implicit none
    private
    public :: bracket_t

    !> A root on its way: between `a`, the argument taken last, and `b`.
    type :: bracket_t
        !> Where the function is wanted next, or the root once it is found.
        real(dp) :: trial = 0
        logical :: found = .false.
        !> The function at the root.
        real(dp) :: residual = 0
        real(dp), private :: a = 0, fa = 0, b = 0, fb = 0, tolerance = 0
    contains
        procedure :: begin
        procedure :: take
        procedure, private :: aim
    end type bracket_t

contains

    !> Starts between `a` and `b`, where the function has the values `fa` and `fb` of opposite signs,
    !> one of them perhaps zero. The root will be known to `tolerance`.
    pure subroutine begin(self, a, fa, b, fb, tolerance)
        class(bracket_t), intent(inout) :: self
        real(dp), intent(in) :: a, fa, b, fb, tolerance
        self%a = a
        self%fa = fa
        self%b = b
        self%fb = fb
        self%tolerance = tolerance
        call self%aim(0.5_dp)
    end subroutine begin

    !> Takes the value of the function at `trial`.
    pure subroutine take(self, value)
        class(bracket_t), intent(inout) :: self
        real(dp), intent(in) :: value
        real(dp) :: c, fc, share, place, height

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
        if (height**2 < place .and. (1 - height)**2 < 1 - place) then
            share = self%fa / (self%fb - self%fa) * (fc / (self%fb - fc)) &
                + (c - self%a) / (self%b - self%a) * (self%fa / (fc - self%fa)) * (self%fb / (fc - self%fb))
        end if
        call self%aim(share)
    end subroutine take

    !> Sets the next trial a share of the way from `a` to `b`, or ends at the better of the two.
    pure subroutine aim(self, share)
        class(bracket_t), intent(inout) :: self
        real(dp), intent(in) :: share
        real(dp) :: least
        logical :: a_is_better

        a_is_better = abs(self%fa) <= abs(self%fb)
        self%residual = merge(self%fa, self%fb, a_is_better)
        self%found = abs(self%b - self%a) <= 2 * self%tolerance .or. is_zero(self%residual)
        if (self%found) then
            self%trial = merge(self%a, self%b, a_is_better)
        else
            least = self%tolerance / abs(self%b - self%a)
            self%trial = self%a + min(1 - least, max(least, share)) * (self%b - self%a)
        end if
    end subroutine aim

end module spintop_bracket
