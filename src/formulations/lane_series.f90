!> Taylor series of the motions of many rigid bodies, one in each lane of a vector.
!>
!> A state is the angular velocity omega and the upward vertical Gamma in body axes, and an angle chi
!> that tells the rest of the attitude,
!>
!>     I omega' = (I omega) x omega + m g Gamma x r - damping omega,   Gamma' = Gamma x omega,
!>     chi = phi + s psi,   chi' = s omega3 + (omega1 Gamma1 + omega2 Gamma2)/(1 + s Gamma3)
!>
!> (Euler and Poisson; phi and psi are Euler's angles). With the side s = +1 the angle chi is regular
!> but where Gamma3 = -1, with s = -1 but where Gamma3 = 1. All terms are linear, or products of two
!> components and a quotient: twelve products; another direction in space instead of chi would take fifteen,
!> and a quaternion twenty.
module spintop_lane_series
    use, intrinsic :: iso_fortran_env, only: sp => real32
    use spintop_kinds, only: dp, qp
    use spintop_formulation, only: max_series_order
    implicit none
    private
    public :: expand, lanes, parts, quotient

    !> Bodies at once: as many as the widest vectors of today's processors hold numbers.
    integer, parameter :: lanes = 8
    !> Components of a state: omega, Gamma, chi; behind them stands the quotient in chi'.
    integer, parameter :: parts = 7, quotient = 8

    !> Counts in the tables that follow.
    integer :: divisor
    !> 1/k in single precision, and the rest: a share rounded alike in every step would make energy and
    !> momentum drift. The rest of a share in double precision would be below the rounding of its product,
    !> and so be lost wherever products are not fused with sums.
    real(dp), parameter :: share(*) = [(real(1 / real(divisor, sp), dp), divisor=1, max_series_order)]
    real(dp), parameter :: share_rest(*) = [(real(1 / real(divisor, qp) - 1 / real(divisor, sp), dp), &
                                             divisor=1, max_series_order)]

contains

    !> Taylor coefficients of the motion. Those of the quotient q = n/(1 + s Gamma3) obey
    !> q_k (1 + s Gamma3_0) = n_k - s sum over j = 1..k of Gamma3_j q_(k-j).
    pure subroutine expand(order, coupling, mobility, decay, moment, side, state, c)
        integer, intent(in) :: order
        real(dp), dimension(lanes, 3), intent(in) :: coupling, mobility, decay, moment
        real(dp), intent(in) :: side(lanes), state(lanes, parts)
        real(dp), intent(inout) :: c(lanes, quotient, 0:order)
        real(dp) :: sums(lanes, 8), d1, d2, d3, q, inverse(lanes)
        integer :: k, i

        c(:, :parts, 0) = state
        c(:, quotient, 0) = 0
        inverse = 1 / (1 + side * state(:, 6))
        do k = 0, order - 1
            call sum_products(k, c, sums)
            !$omp simd private(d1, d2, d3, q)
            do i = 1, lanes
                d1 = coupling(i, 1) * sums(i, 1) - decay(i, 1) * c(i, 1, k) + mobility(i, 1) &
                    * (c(i, 5, k) * moment(i, 3) - c(i, 6, k) * moment(i, 2))
                d2 = coupling(i, 2) * sums(i, 2) - decay(i, 2) * c(i, 2, k) + mobility(i, 2) &
                    * (c(i, 6, k) * moment(i, 1) - c(i, 4, k) * moment(i, 3))
                d3 = coupling(i, 3) * sums(i, 3) - decay(i, 3) * c(i, 3, k) + mobility(i, 3) &
                    * (c(i, 4, k) * moment(i, 2) - c(i, 5, k) * moment(i, 1))
                c(i, 1, k + 1) = share(k + 1) * d1 + share_rest(k + 1) * d1
                c(i, 2, k + 1) = share(k + 1) * d2 + share_rest(k + 1) * d2
                c(i, 3, k + 1) = share(k + 1) * d3 + share_rest(k + 1) * d3
                d1 = sums(i, 4)
                d2 = sums(i, 5)
                d3 = sums(i, 6)
                c(i, 4, k + 1) = share(k + 1) * d1 + share_rest(k + 1) * d1
                c(i, 5, k + 1) = share(k + 1) * d2 + share_rest(k + 1) * d2
                c(i, 6, k + 1) = share(k + 1) * d3 + share_rest(k + 1) * d3
                ! A coefficient of the quotient that is not known yet counts as zero in the sums.
                q = (sums(i, 7) - side(i) * sums(i, 8)) * inverse(i)
                d1 = side(i) * c(i, 3, k) + q
                c(i, 7, k + 1) = share(k + 1) * d1 + share_rest(k + 1) * d1
                c(i, quotient, k) = q
                c(i, quotient, k + 1) = 0
            end do
        end do
    end subroutine expand

    !> Coefficients k of the products: (omega x omega) without the signs of its terms, in the order 23, 31,
    !> 12; Gamma x omega; omega1 Gamma1 + omega2 Gamma2; and Gamma3 q, where a coefficient of the quotient
    !> that is not known yet counts as zero. By Cauchy's rule, with the terms j and k - j side by side, so
    !> that each coefficient read serves twice.
    pure subroutine sum_products(k, c, sums)
        integer, intent(in) :: k
        real(dp), intent(in) :: c(lanes, quotient, 0:k)
        real(dp), intent(out) :: sums(lanes, 8)
        real(dp) :: v1, v2, v3, e1, e2, e3, p, w1, w2, w3, g1, g2, g3, q
        real(dp) :: w12, w23, w31, g12, g21, g23, g32, g31, g13, n1, n2, qg, excess
        integer :: j, i

        ! A term in the middle stands beside itself, once too often: the sums begin with its
        ! negative. (That is cheaper than a case of its own, on which no loop becomes vectors.)
        excess = mod(k, 2) - 1
        !$omp simd private(v1, v2, v3, e1, e2, e3, p, w1, w2, w3, g1, g2, g3, q, &
        !$omp w12, w23, w31, g12, g21, g23, g32, g31, g13, n1, n2, qg, j)
        do i = 1, lanes
            ! Sums in registers: as arrays they would go to memory and back with every term.
            w1 = c(i, 1, k / 2)
            w2 = c(i, 2, k / 2)
            w3 = c(i, 3, k / 2)
            v1 = excess * w1
            v2 = excess * w2
            v3 = excess * w3
            g1 = c(i, 4, k / 2)
            g2 = c(i, 5, k / 2)
            g3 = c(i, 6, k / 2)
            w12 = v1 * w2
            w23 = v2 * w3
            w31 = v3 * w1
            g12 = g1 * v2
            g21 = g2 * v1
            g23 = g2 * v3
            g32 = g3 * v2
            g31 = g3 * v1
            g13 = g1 * v3
            n1 = g1 * v1
            n2 = g2 * v2
            qg = excess * g3 * c(i, quotient, k / 2)
            do j = 0, k / 2
                v1 = c(i, 1, j)
                v2 = c(i, 2, j)
                v3 = c(i, 3, j)
                e1 = c(i, 4, j)
                e2 = c(i, 5, j)
                e3 = c(i, 6, j)
                p = c(i, quotient, j)
                w1 = c(i, 1, k - j)
                w2 = c(i, 2, k - j)
                w3 = c(i, 3, k - j)
                g1 = c(i, 4, k - j)
                g2 = c(i, 5, k - j)
                g3 = c(i, 6, k - j)
                q = c(i, quotient, k - j)
                w12 = w12 + v1 * w2 + w1 * v2
                w23 = w23 + v2 * w3 + w2 * v3
                w31 = w31 + v3 * w1 + w3 * v1
                g12 = g12 + e1 * w2 + g1 * v2
                g21 = g21 + e2 * w1 + g2 * v1
                g23 = g23 + e2 * w3 + g2 * v3
                g32 = g32 + e3 * w2 + g3 * v2
                g31 = g31 + e3 * w1 + g3 * v1
                g13 = g13 + e1 * w3 + g1 * v3
                n1 = n1 + e1 * w1 + g1 * v1
                n2 = n2 + e2 * w2 + g2 * v2
                qg = qg + p * g3 + q * e3
            end do
            sums(i, 1) = w23
            sums(i, 2) = w31
            sums(i, 3) = w12
            sums(i, 4) = g23 - g32
            sums(i, 5) = g31 - g13
            sums(i, 6) = g12 - g21
            sums(i, 7) = n1 + n2
            sums(i, 8) = qg
        end do
    end subroutine sum_products

end module spintop_lane_series
