!> Explicit interfaces of the LAPACK routines that are used. Arguments have the names of the LAPACK manual.
module spintop_lapack
    use spintop_kinds, only: dp
    implicit none
    private
    public :: dgetrf, dgetrs, dgeev, dgelsy, dgesvd, dpotrf

    interface
        !> LU factorisation with partial pivoting.
        subroutine dgetrf(m, n, a, lda, ipiv, info)
            import :: dp
            integer, intent(in) :: m, n, lda !! numbers of rows and columns; leading dimension of `a`
            real(dp), intent(inout) :: a(lda, *) !! matrix on entry; overwritten
            integer, intent(out) :: ipiv(*), info !! pivots; 0 on success
        end subroutine dgetrf

        !> Solution of A X = B with the factors of `dgetrf`.
        subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
            import :: dp
            character, intent(in) :: trans
                !! 'N', 'T' or 'C': the system with A, its transpose or its conjugate transpose
            integer, intent(in) :: n, nrhs, lda, ipiv(*), ldb
                !! order; number of right-hand sides; leading dimension of `a`; pivots of the factorisation;
                !! leading dimension of `b`
            real(dp), intent(in) :: a(lda, *) !! matrix
            real(dp), intent(inout) :: b(ldb, *) !! right-hand sides on entry, solutions on return
            integer, intent(out) :: info !! 0 on success
        end subroutine dgetrs

        !> Cholesky factorisation of a symmetric positive definite matrix.
        subroutine dpotrf(uplo, n, a, lda, info)
            import :: dp
            character, intent(in) :: uplo !! 'L' or 'U': the triangle that is given and overwritten
            integer, intent(in) :: n, lda !! order; leading dimension of `a`
            real(dp), intent(inout) :: a(lda, *) !! matrix on entry; its factor on return
            integer, intent(out) :: info !! 0 on success; the order of the first minor that is not positive
        end subroutine dpotrf

        !> Eigenvalues and eigenvectors of a general matrix.
        subroutine dgeev(jobvl, jobvr, n, a, lda, wr, wi, vl, ldvl, vr, ldvr, work, lwork, info)
            import :: dp
            character, intent(in) :: jobvl, jobvr !! 'V' or 'N': whether left and right eigenvectors are computed
            integer, intent(in) :: n, lda, ldvl, ldvr, lwork
                !! order; leading dimensions of `a`, `vl` and `vr`; size of `work`
            real(dp), intent(inout) :: a(lda, *) !! matrix on entry; overwritten
            real(dp), intent(out) :: wr(*), wi(*), vl(ldvl, *), vr(ldvr, *), work(*)
                !! eigenvalues, real and imaginary parts; left and right eigenvectors; workspace
            integer, intent(out) :: info !! 0 on success
        end subroutine dgeev

        !> Minimum-norm solution of a linear system or a least-squares problem of any rank.
        subroutine dgelsy(m, n, nrhs, a, lda, b, ldb, jpvt, rcond, rank, work, lwork, info)
            import :: dp
            integer, intent(in) :: m, n, nrhs, lda, ldb, lwork
                !! numbers of rows, columns and right-hand sides; leading dimensions; size of `work`
            real(dp), intent(inout) :: a(lda, *), b(ldb, *)
                !! matrix, overwritten; right-hand sides on entry, solutions on return
            integer, intent(inout) :: jpvt(*) !! column permutation; 0 for a free column
            real(dp), intent(in) :: rcond !! reciprocal condition number that determines the rank
            integer, intent(out) :: rank, info !! rank of the matrix; 0 on success
            real(dp), intent(out) :: work(*) !! workspace
        end subroutine dgelsy

        !> Singular values and vectors of a general matrix.
        subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
            import :: dp
            character, intent(in) :: jobu, jobvt !! which singular vectors are computed ('A', 'S', 'O' or 'N')
            integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
                !! numbers of rows and columns; leading dimensions; size of `work`
            real(dp), intent(inout) :: a(lda, *) !! matrix on entry; overwritten
            real(dp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *), work(*)
                !! singular values; left and right singular vectors; workspace
            integer, intent(out) :: info !! 0 on success
        end subroutine dgesvd
    end interface

end module spintop_lapack
