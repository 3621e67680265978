!> Exact comparisons of reals, where exactness is meant.
module spintop_compare
    use spintop_kinds, only: dp
    implicit none
    private
    public :: is_zero, is_equal, is_finite

contains

    !> Whether x is exactly zero (of either sign).
    elemental logical function is_zero(x)
        real(dp), intent(in) :: x !! any number, also infinite or NaN
        is_zero = abs(x) <= 0
    end function is_zero

    !> Whether two numbers are exactly equal.
    elemental logical function is_equal(a, b)
        real(dp), intent(in) :: a, b !! the two numbers
        is_equal = a <= b .and. a >= b
    end function is_equal

    !> Whether x is neither infinite nor a NaN.
    elemental logical function is_finite(x)
        real(dp), intent(in) :: x !! any number, also infinite or NaN
        is_finite = abs(x) <= huge(x)
    end function is_finite

end module spintop_compare
