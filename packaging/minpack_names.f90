! The routines of MINPACK that spintop calls, by their classic names, from the module of fortran-lang's minpack.

subroutine qrfac(m, n, a, lda, pivot, ipvt, lipvt, rdiag, acnorm, wa)
    use, intrinsic :: iso_fortran_env, only: real64
    use minpack_module, only: module_qrfac => qrfac
    implicit none
    integer, intent(in) :: m, n, lda, lipvt
    real(real64), intent(inout) :: a(lda, n)
    logical, intent(in) :: pivot
    integer, intent(out) :: ipvt(lipvt)
    real(real64), intent(out) :: rdiag(n), acnorm(n), wa(n)
    call module_qrfac(m, n, a, lda, pivot, ipvt, lipvt, rdiag, acnorm, wa)
end subroutine qrfac

subroutine lmpar(n, r, ldr, ipvt, diag, qtb, delta, par, x, sdiag, wa1, wa2)
    use, intrinsic :: iso_fortran_env, only: real64
    use minpack_module, only: module_lmpar => lmpar
    implicit none
    integer, intent(in) :: n, ldr, ipvt(n)
    real(real64), intent(inout) :: r(ldr, n), par, wa1(n), wa2(n)
    real(real64), intent(in) :: diag(n), qtb(n), delta
    real(real64), intent(out) :: x(n), sdiag(n)
    call module_lmpar(n, r, ldr, ipvt, diag, qtb, delta, par, x, sdiag, wa1, wa2)
end subroutine lmpar
