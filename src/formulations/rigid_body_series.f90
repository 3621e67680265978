!> Power series of the motion of any rigid body with a fixed point: quaternion and body momentum.
module spintop_rigid_body_series
    use spintop_kinds, only: dp, qp
    use spintop_body, only: body_t
    use spintop_formulation, only: max_series_order, max_states
    implicit none
    private
    public :: find_series, find_quadruple_series

contains

    !> Taylor coefficients of the motion. All terms of the equations are products of two components,
    !> the length of the quaternion being constant; coefficients of products follow Cauchy's rule.
    !> `moment` is m g r, N m; `coupling` are ((I2-I3)/(I2 I3), ...), so that Pi1' = coupling_1 Pi2 Pi3.
    pure subroutine find_series(body, moment, coupling, y, order, coefficient)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: moment(3), coupling(3)
        real(dp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order)
        !> Products of q0, q3 and the momentum with the whole state.
        real(dp) :: by_q0(max_states), by_q3(max_states)
        real(dp) :: by_p1(max_states), by_p2(max_states), by_p3(max_states)
        real(dp) :: twice, gamma(3), v1, v2, v3, share
        integer :: k, j, i

        v1 = 1 / body%inertia(1)
        v2 = 1 / body%inertia(2)
        v3 = 1 / body%inertia(3)
        twice = 2 / sum(y(1:4)**2)
        coefficient(:, 0) = y
        associate (c => coefficient, r => moment, d => body%damping, s => coupling)
            do k = 0, order - 1
                by_q0 = 0
                by_q3 = 0
                by_p1 = 0
                by_p2 = 0
                by_p3 = 0
                do j = k, 0, -1
                    !$omp simd
                    do i = 1, max_states
                        by_q0(i) = by_q0(i) + c(1, j) * c(i, k - j)
                        by_q3(i) = by_q3(i) + c(4, j) * c(i, k - j)
                        by_p1(i) = by_p1(i) + c(5, j) * c(i, k - j)
                        by_p2(i) = by_p2(i) + c(6, j) * c(i, k - j)
                        by_p3(i) = by_p3(i) + c(7, j) * c(i, k - j)
                    end do
                end do
                gamma(1) = twice * (by_q3(2) - by_q0(3))
                gamma(2) = twice * (by_q3(3) + by_q0(2))
                gamma(3) = twice * (by_q0(1) + by_q3(4))
                if (k == 0) gamma(3) = gamma(3) - 1
                share = 1.0_dp / (k + 1)
                c(1, k + 1) = -share / 2 * (v1 * by_p1(2) + v2 * by_p2(3) + v3 * by_p3(4))
                c(2, k + 1) = share / 2 * (v1 * by_p1(1) + v3 * by_p3(3) - v2 * by_p2(4))
                c(3, k + 1) = share / 2 * (v2 * by_p2(1) + v1 * by_p1(4) - v3 * by_p3(2))
                c(4, k + 1) = share / 2 * (v3 * by_p3(1) + v2 * by_p2(2) - v1 * by_p1(3))
                c(5, k + 1) = share * (s(1) * by_p3(6) + gamma(2) * r(3) - gamma(3) * r(2) &
                                       - d(1) * v1 * c(5, k))
                c(6, k + 1) = share * (s(2) * by_p1(7) + gamma(3) * r(1) - gamma(1) * r(3) &
                                       - d(2) * v2 * c(6, k))
                c(7, k + 1) = share * (s(3) * by_p2(5) + gamma(1) * r(2) - gamma(2) * r(1) &
                                       - d(3) * v3 * c(7, k))
                c(8, k + 1) = 0
            end do
        end associate
    end subroutine find_series

    !> Taylor coefficients of the motion in quadruple precision.
    pure subroutine find_quadruple_series(body, y, order, coefficient)
        type(body_t), intent(in) :: body
        real(qp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order)
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
