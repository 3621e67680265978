!> Factors of the products of vectors in which the series of one body are written: body_series.h.
module spintop_body_products
    use spintop_body, only: body_t
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_kernel_types, only: body_products_t
    use spintop_kinds, only: dp
    implicit none
    private
    public :: products_of

contains

    !> The factors of a body, in the order of the products.
    pure type(body_products_t) function products_of(body) result(of)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp) :: v(3), moment(3), coupling(3)

        v = 1 / body%inertia
        moment = body%weight_moment()
        coupling = momentum_coupling(body)
        of%first(:3) = coupling
        of%is_steady(:3) = merge(1.0_dp, 0.0_dp, abs(coupling([2, 3, 1])) < abs(coupling([3, 1, 2])))
        of%first(5:7) = v([3, 1, 2])
        of%second(:4) = -v([3, 2, 3, 1]) / 2
        of%second(5:7) = -v([2, 3, 1])
        of%third = [-1, 1, 1, 1, -1, 1, 1, 1] * v([1, 1, 2, 3, 2, 3, 1, 2]) / 2
        of%decay(:3) = body%damping * v
        of%pull(:3) = moment([3, 1, 2])
        of%swing(:3) = moment([2, 3, 1])
    end function products_of

end module spintop_body_products
