!> Stability of the sleeping top: upright, spinning about the vertical.
module spintop_sleeping_top
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_errors, only: error_t, internal_error
    use spintop_lapack, only: dgeev
    implicit none
    private
    public :: critical_omega3, sleeping_eigenvalues

contains

    !> Least omega3 at which a symmetric top sleeps stably, rad/s: sqrt(4 mgl I1)/I3.
    pure real(dp) function critical_omega3(body)
        type(body_t), intent(in) :: body
        critical_omega3 = 2 * sqrt(body%mgl() * body%inertia(1)) / body%inertia(3)
    end function critical_omega3

    !> Eigenvalues of the motion linearised about the upright, 1/s. With x, y the horizontal
    !> components of the axis, I1 x'' = mgl x - I3 omega3 y', I1 y'' = mgl y + I3 omega3 x'.
    !> Stable if no real part is positive.
    subroutine sleeping_eigenvalues(body, omega3, eigenvalues, error)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: omega3
        complex(dp), intent(out) :: eigenvalues(4)
        type(error_t), allocatable, intent(out) :: error
        integer, parameter :: n = 4
        real(dp) :: matrix(n, n), re(n), im(n), left(1, n), right(1, n), scratch(8 * n)
        integer :: failure

        associate (pull => body%mgl() / body%inertia(1), &
                   gyration => body%inertia(3) * omega3 / body%inertia(1))
            matrix = 0
            matrix(1, 3) = 1
            matrix(2, 4) = 1
            matrix(3, [1, 4]) = [pull, -gyration]
            matrix(4, [2, 3]) = [pull, gyration]
        end associate
        call dgeev('N', 'N', n, matrix, n, re, im, left, 1, right, 1, scratch, size(scratch), failure)
        eigenvalues = cmplx(re, im, dp)
        if (failure /= 0) error = internal_error('LAPACK dgeev found no eigenvalues of the sleeping top')
    end subroutine sleeping_eigenvalues

end module spintop_sleeping_top
