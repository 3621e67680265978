!> Power series of the motion of any rigid body with a fixed point: quaternion q and body momentum Pi.
!>
!> In double precision the upward vertical Gamma in body axes is expanded beside them,
!>
!>     Pi' = Pi x omega + m g Gamma x r - damping omega,   Gamma' = Gamma x omega,   q' = q (0, omega)/2
!>
!> (Euler and Poisson). These are 21 products of two components, as Cauchy products of their series; Gamma from the
!> quaternion would take more, and make each term wait longer for the last. An angle xi about a body axis instead
!> of the quaternion (`spintop_lane_series`) would save eight of them, but it is a quotient, whose series converges
!> over shorter steps.
module spintop_rigid_body_series
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp, qp
    use spintop_body, only: body_t
    use spintop_kernel_types, only: body_products_t
    use spintop_formulation, only: max_series_order, max_states
    use spintop_series_shares, only: of_rate
    implicit none
    private
    public :: find_series, find_quadruple_series

    interface
        pure subroutine c_expand(order, body, state, share, c) bind(C, name='spintop_expand_body')
            import :: body_products_t, c_double, c_int
            integer(c_int), value :: order
            type(body_products_t), intent(in) :: body
            real(c_double), intent(in) :: state(*), share(*)
            real(c_double), intent(out) :: c(*)
        end subroutine c_expand
    end interface

contains

    !> Taylor coefficients of the motion.
    pure subroutine find_series(products, y, order, coefficient)
        type(body_products_t), intent(in) :: products !! the equations of the body
        real(dp), intent(in) :: y(max_states) !! state
        integer, intent(in) :: order !! order of the highest coefficient
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        call c_expand(order, products, y, of_rate, coefficient)
    end subroutine find_series

    !> Taylor coefficients of the motion in quadruple precision.
    pure subroutine find_quadruple_series(body, y, order, coefficient)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(qp), intent(in) :: y(max_states) !! state in quadruple precision
        integer, intent(in) :: order !! order of the highest coefficient
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        real(qp) :: omega(3, 0:max_series_order), by_q0(4), by_q3(4), by_omega(7, 3)
        real(qp) :: inertia(3), moment(3), twice, gamma(3)
        integer :: k, j, axis

        inertia = body%inertia
        moment = real(body%mass, qp) * body%gravity * body%centre_of_mass
        twice = 2 / sum(y(1:4)**2)
        coefficient(:, 0) = y
        associate (c => coefficient, r => moment, w => by_omega)
            do k = 0, order - 1
                omega(:, k) = c(5:7, k) / inertia
                by_q0 = 0
                by_q3 = 0
                by_omega = 0
                do j = 0, k
                    by_q0 = by_q0 + c(1, j) * c(1:4, k - j)
                    by_q3 = by_q3 + c(4, j) * c(1:4, k - j)
                    do axis = 1, 3
                        by_omega(:, axis) = by_omega(:, axis) + omega(axis, j) * c(1:7, k - j)
                    end do
                end do
                gamma = twice * [by_q3(2) - by_q0(3), by_q3(3) + by_q0(2), by_q0(1) + by_q3(4)]
                if (k == 0) gamma(3) = gamma(3) - 1
                c(1:4, k + 1) = [-w(2, 1) - w(3, 2) - w(4, 3), w(1, 1) + w(3, 3) - w(4, 2), &
                                 w(1, 2) + w(4, 1) - w(2, 3), w(1, 3) + w(2, 2) - w(3, 1)] / 2
                c(5:7, k + 1) = [w(6, 3) - w(7, 2), w(7, 1) - w(5, 3), w(5, 2) - w(6, 1)] &
                    + [gamma(2) * r(3) - gamma(3) * r(2), gamma(3) * r(1) - gamma(1) * r(3), &
                       gamma(1) * r(2) - gamma(2) * r(1)] - body%damping * omega(:, k)
                c(8, k + 1) = 0
                c(:, k + 1) = c(:, k + 1) / (k + 1)
            end do
        end associate
    end subroutine find_quadruple_series

end module spintop_rigid_body_series
