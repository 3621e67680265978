!> Taylor series of the motions of many rigid bodies, one in each lane of a vector.
!>
!> A state contains the angular velocity omega and the upward vertical Gamma in body axes, and an angle xi
!> that completes the attitude,
!>
!>     I omega' = (I omega) x omega + m g Gamma x r - damping omega,   Gamma' = Gamma x omega,
!>     xi = psi + s phi,   xi' = omega3 + Q,   Q = s (omega1 Gamma1 + omega2 Gamma2)/(1 + s Gamma3)
!>
!> (Euler and Poisson; phi and psi are Euler angles). For the side s = +1 the angle xi is regular except at
!> Gamma3 = -1, for s = -1 except at Gamma3 = 1. All terms are linear, or products of two components and a
!> quotient: twelve products. A second vector fixed in space instead of xi would need fifteen, a quaternion
!> twenty.
module spintop_lane_series
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kernel_types, only: lane_body_t, lanes, rows
    use spintop_kinds, only: dp
    use spintop_series_shares, only: share_rest, short_share
    implicit none
    private
    public :: expand, lanes, parts, quotient, numerator, rows

    !> Components of a state: omega, Gamma, xi; they are followed by the quotient Q and omega1 Gamma1 + omega2 Gamma2.
    integer, parameter :: parts = 7, quotient = 8, numerator = 9

    interface
        pure subroutine c_expand(order, body, side, state, share, share_rest, c) bind(C, name='spintop_expand_lanes')
            import :: c_double, c_int, lane_body_t
            integer(c_int), value :: order
            type(lane_body_t), intent(in) :: body
            real(c_double), dimension(*), intent(in) :: side, state, share, share_rest
            real(c_double), intent(out) :: c(*)
        end subroutine c_expand
    end interface

contains

    !> Taylor coefficients of the motions at their states. Those of the quotient obey
    !> Q_k (1 + s Gamma3_0)/s = n_k - sum over j = 1..k of Gamma3_j Q_(k-j), with n = omega1 Gamma1 + omega2 Gamma2;
    !> they and n are known up to order - 1, and the next are zero.
    pure subroutine expand(order, body, side, state, c)
        integer, intent(in) :: order !! 1 to `max_series_order`
        type(lane_body_t), intent(in) :: body !! the bodies
        real(dp), intent(in) :: side(lanes), state(lanes, parts) !! s; (omega, Gamma, xi)
        real(dp), intent(out) :: c(lanes, rows, 0:order) !! Taylor coefficients (lane, row, term)
        call c_expand(order, body, side, state, short_share, share_rest, c)
    end subroutine expand

end module spintop_lane_series
