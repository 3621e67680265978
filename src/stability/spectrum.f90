!> Eigenvalues of a matrix of which some are known in advance.
!>
!> Invariants and symmetries of a motion give its linearisation multiple eigenvalues, with fewer eigenvectors
!> than eigenvalues. LAPACK returns these with errors of the order of the square root of the rounding error,
!> or larger. They are deflated first, so that the other eigenvalues keep their accuracy.
module spintop_spectrum
    use spintop_kinds, only: dp, is_finite
    use spintop_lapack, only: dgeev, dgesvd
    use spintop_status, only: status_ok, status_non_finite, status_not_converged
    implicit none
    private
    public :: find_spectrum

    !> Largest residual of an eigenvector relative to the matrix; and the sine of the angle below which two
    !> eigenvectors count as one.
    real(dp), parameter :: slack = 1.0e-9_dp, least_angle = 1.0e-8_dp

contains

    !> All eigenvalues of a square matrix A, with those equal to `known` last. Candidates for their
    !> eigenvectors are the columns c of `forms`, c^T A = known c^T, and v of `directions`, A v = known v with
    !> c^T v = 0 for every form. Candidates that are not eigenvectors are ignored. `unit` contains the scale
    !> of each component, by which components are compared.
    subroutine find_spectrum(matrix, unit, known, forms, directions, eigenvalues, status)
        real(dp), intent(in) :: matrix(:, :), unit(:), known, forms(:, :), directions(:, :)
            !! n x n; n scales; known eigenvalue; n x any; n x any
        complex(dp), intent(out) :: eigenvalues(size(matrix, 1)) !! all eigenvalues, those equal to `known` last
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: scaled(size(matrix, 1), size(matrix, 1)), vectors(size(matrix, 1), size(forms, 2) + size(directions, 2))
        real(dp) :: basis(size(matrix, 1), size(matrix, 1)), singular(size(matrix, 1))
        real(dp), allocatable :: rest(:, :)
        real(dp) :: re(size(matrix, 1)), im(size(matrix, 1)), unused(1, 2), scratch(16 * size(matrix, 1))
        integer :: n, left, taken, failure, i

        n = size(matrix, 1)
        eigenvalues = known
        status = status_ok
        do i = 1, n
            scaled(:, i) = matrix(:, i) * unit(i) / unit
        end do
        if (.not. all(is_finite(scaled))) status = status_non_finite
        if (status /= status_ok) return
        taken = 0
        do i = 1, size(forms, 2)
            call accept(forms(:, i) * unit, matmul(forms(:, i) * unit, scaled))
        end do
        do i = 1, size(directions, 2)
            call accept(directions(:, i) / unit, matmul(scaled, directions(:, i) / unit))
        end do

        basis = 0
        do i = 1, n
            basis(i, i) = 1
        end do
        ! In an orthonormal basis that begins with these vectors the matrix is block triangular.
        call dgesvd('A', 'N', n, taken, vectors, n, singular, basis, n, unused, 1, scratch, &
                    size(scratch), failure)
        if (failure /= 0) status = status_not_converged
        if (status /= status_ok) return
        taken = count(singular(:min(taken, n)) > least_angle)
        left = n - taken
        allocate (rest(left, left))
        rest = matmul(transpose(basis(:, taken + 1:)), matmul(scaled, basis(:, taken + 1:)))
        if (left > 0) then
            call dgeev('N', 'N', left, rest, left, re, im, unused(:, 1), 1, unused(:, 2), 1, scratch, &
                       size(scratch), failure)
        end if
        if (failure /= 0) status = status_not_converged
        if (status == status_ok) eigenvalues(:left) = cmplx(re(:left), im(:left), dp)

    contains

        !> Accepts a candidate, given its image, if it is an eigenvector.
        subroutine accept(vector, image)
            real(dp), intent(in) :: vector(:), image(:)
            real(dp) :: length
            length = norm2(vector)
            if (.not. length > 0) return
            if (norm2(image - known * vector) > slack * norm2(scaled) * length) return
            taken = taken + 1
            vectors(:, taken) = vector / length
        end subroutine accept

    end subroutine find_spectrum

end module spintop_spectrum
