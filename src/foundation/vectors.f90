!> Products of vectors of three components.
module spintop_vectors
    use spintop_kinds, only: dp
    implicit none
    private
    public :: cross, skew

contains

    !> Vector product a x b.
    pure function cross(a, b) result(c)
        real(dp), intent(in) :: a(3), b(3) !! vectors
        real(dp) :: c(3)
        c(1) = a(2) * b(3) - a(3) * b(2)
        c(2) = a(3) * b(1) - a(1) * b(3)
        c(3) = a(1) * b(2) - a(2) * b(1)
    end function cross

    !> The matrix of the vector product: skew(a) b = a x b.
    pure function skew(a) result(matrix)
        real(dp), intent(in) :: a(3) !! vector
        real(dp) :: matrix(3, 3)
        matrix(:, 1) = [0.0_dp, a(3), -a(2)]
        matrix(:, 2) = [-a(3), 0.0_dp, a(1)]
        matrix(:, 3) = [a(2), -a(1), 0.0_dp]
    end function skew

end module spintop_vectors
