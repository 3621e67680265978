!> Factors of the products of vectors in which the series of one body are written: body_series.h, effects_series.h.
module spintop_body_products
    use, intrinsic :: iso_c_binding, only: c_double
    use spintop_body, only: body_t
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_formulation, only: max_states
    implicit none
    private
    public :: body_products_t, products_of

    !> Factors of the three products of body_vectors.h, of damping and torque, as in body_series.h.
    type, bind(C) :: body_products_t
        real(c_double), dimension(max_states) :: first = 0, second = 0, third = 0, decay = 0, pull = 0, swing = 0
    end type body_products_t

contains

    !> The factors of a body, in the order of the products.
    pure type(body_products_t) function products_of(body) result(of)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(c_double) :: v(3), moment(3)

        v = 1 / body%inertia
        moment = body%weight_moment()
        of%first(:3) = momentum_coupling(body)
        of%first(5:7) = v([3, 1, 2])
        of%second(:4) = -v([3, 2, 3, 1]) / 2
        of%second(5:7) = -v([2, 3, 1])
        of%third = [-1, 1, 1, 1, -1, 1, 1, 1] * v([1, 1, 2, 3, 2, 3, 1, 2]) / 2
        of%decay(:3) = body%damping * v
        of%pull(:3) = moment([3, 1, 2])
        of%swing(:3) = moment([2, 3, 1])
    end function products_of

end module spintop_body_products
