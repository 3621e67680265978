!> Power series of the motion of any rigid body with a fixed point: quaternion q and body momentum Pi.
!>
!> The upward vertical Gamma in body axes is expanded beside them,
!>
!>     Pi' = Pi x omega + m g Gamma x r - damping omega,   Gamma' = Gamma x omega,   q' = q (0, omega)/2
!>
!> (Euler and Poisson). These are 21 products of two components, as Cauchy products of their series; Gamma from the
!> quaternion would take more, and make each term wait longer for the last. An angle xi about a body axis instead
!> of the quaternion (`spintop_lane_series`) would save eight of them, but it is a quotient, whose series converges
!> over shorter steps.
module spintop_rigid_body_series
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_body_products, only: products_of
    use spintop_capabilities, only: max_series_order, max_states, series_t
    use spintop_kernel_types, only: body_products_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_series_shares, only: share_rest, short_share
    implicit none
    private
    public :: rigid_body_series_t

    !> The Taylor series of the motion.
    type, extends(series_t) :: rigid_body_series_t
        private
        type(body_products_t) :: products = body_products_t()
    contains
        procedure :: set
        procedure :: expand
    end type rigid_body_series_t

    interface
        pure subroutine c_expand(order, body, state, share, share_rest, c) bind(C, name='spintop_expand_body')
            import :: body_products_t, c_double, c_int
            integer(c_int), value :: order
            type(body_products_t), intent(in) :: body
            real(c_double), intent(in) :: state(*), share(*), share_rest(*)
            real(c_double), intent(out) :: c(*)
        end subroutine c_expand
    end interface

contains

    !> Constants of the series.
    pure subroutine set(self, body, start)
        class(rigid_body_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%products = products_of(body)
    end subroutine set

    !> Taylor coefficients of the motion.
    pure subroutine expand(self, t, y, order, coefficient)
        class(rigid_body_series_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        integer, intent(in) :: order !! order of the highest coefficient
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        call c_expand(order, self%products, y, short_share, share_rest, coefficient)
    end subroutine expand

end module spintop_rigid_body_series
