!> Constants of power series: tables that depend on the number of a term, made by the compiler.
module spintop_series_shares
    use, intrinsic :: iso_fortran_env, only: sp => real32
    use spintop_kernel_types, only: max_series_order => highest_order
    use spintop_kinds, only: dp, qp
    implicit none
    private
    public :: short_share, share_rest, acceleration_share, acceleration_rest, per_binomial

    !> Indices in the tables: no compiler need know a type within a constructor.
    integer :: k, n
    !> 1/k as a number in single precision and a remainder. A factor that is rounded in the same way in every
    !> step would make energy and momentum drift. A remainder of a double would be smaller than the rounding
    !> error of the product, and therefore lost where products and sums are not fused.
    real(dp), parameter :: short_share(*) = [(real(1 / real(k, sp), dp), k=1, max_series_order)]
    real(dp), parameter :: share_rest(*) = [(real(1 / real(k, qp) - 1 / real(k, sp), dp), k=1, max_series_order)]
    !> The same of 1/((k + 1) (k + 2)), by which coefficient k of a second derivative becomes the next but one of the state.
    real(dp), parameter :: acceleration_share(0:*) = [(real(1 / real((k + 1) * (k + 2), sp), dp), k=0, max_series_order)]
    real(dp), parameter :: acceleration_rest(0:*) = &
        [(real(1 / real((k + 1) * (k + 2), qp) - 1 / real((k + 1) * (k + 2), sp), dp), k=0, max_series_order)]
    !> 1 over the binomial coefficient n over k.
    real(dp), parameter :: per_binomial(0:max_series_order, 0:max_series_order) = reshape( &
        [((gamma(real(k + 1, dp)) * gamma(real(max(n - k, 0) + 1, dp)) / gamma(real(n + 1, dp)), &
           k=0, max_series_order), n=0, max_series_order)], [max_series_order + 1, max_series_order + 1])

end module spintop_series_shares
