!> Explicit interfaces of the MINPACK routines that are used. They are those below `lmder`, which calls a procedure that has
!> no data of its own, so that threads could not use it. Arguments have the names of the MINPACK guide (ANL-80-74).
module spintop_minpack
    use spintop_kinds, only: dp
    implicit none
    private
    public :: qrfac, lmpar

    interface
        !> QR factorisation with column pivoting.
        subroutine qrfac(m, n, a, lda, pivot, ipvt, lipvt, rdiag, acnorm, wa)
            import :: dp
            integer, intent(in) :: m, n, lda, lipvt !! numbers of rows and columns; leading dimension; size of `ipvt`
            real(dp), intent(inout) :: a(lda, *) !! matrix on entry; the factors but the diagonal of R on return
            logical, intent(in) :: pivot !! whether columns are exchanged
            integer, intent(out) :: ipvt(*) !! the permutation
            real(dp), intent(out) :: rdiag(*), acnorm(*), wa(*) !! diagonal of R; norms of the columns; work space
        end subroutine qrfac

        !> The Levenberg-Marquardt parameter, and the step that belongs to it.
        subroutine lmpar(n, r, ldr, ipvt, diag, qtb, delta, par, x, sdiag, wa1, wa2)
            import :: dp
            integer, intent(in) :: n, ldr, ipvt(*) !! order of R; leading dimension; permutation
            real(dp), intent(inout) :: r(ldr, *) !! R; its lower triangle is overwritten
            real(dp), intent(in) :: diag(*), qtb(*), delta !! scales; (Q transpose) b; bound of the scaled step
            real(dp), intent(inout) :: par !! the parameter: an estimate on entry
            real(dp), intent(out) :: x(*), sdiag(*), wa1(*), wa2(*) !! the step, negative; work space
        end subroutine lmpar
    end interface

end module spintop_minpack
