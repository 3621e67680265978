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
!>
!> With effects omega is relative to the frame, and motion_series.h has the equations; dry friction, harmonic torques and tables
!> have no place here.
!>
!> A perturbation is a small rotation epsilon of the body, in body axes, and a change delta of its angular
!> velocity. With the motion (omega, Gamma) and the change gamma = Gamma x epsilon of the vertical
!>
!>     epsilon' = delta + epsilon x omega,   I delta' = (I delta) x omega + (I omega) x delta + m g gamma x r
!>                                                      - damping delta
!>
!> The length of the vertical does not change. A rotation about the vertical, epsilon = a Gamma, changes nothing else
!> and stays the same for all times.
module spintop_lane_series
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kernel_types, only: body_numbers_t, lane_body_t, lanes, motion_kinds_t, rows
    implicit none
    private
    public :: expand, expand_affected, set_effects, lanes, parts, quotient, numerator, rows, carry_tangents, components
    public :: row_frame, row_torque, row_push, row_drags, rows_of_drag, row_moment

    !> Components of a state: omega, Gamma, xi; they are followed by the quotient Q and omega1 Gamma1 + omega2 Gamma2.
    integer, parameter :: parts = 7, quotient = 8, numerator = 9

    !> Components of a perturbation: delta, epsilon. lane_series.h repeats their number.
    integer, parameter :: components = 6
    !> The first of some further rows of a term: rotation of the frame, torque in space axes, acceleration of
    !> the pivot, drags; of a drag, v = y u is from its row `row_moment` on. kernels.h repeats them.
    integer, parameter :: row_frame = 1, row_torque = 4, row_push = 7, row_drags = 16, rows_of_drag = 9, row_moment = 6

    interface
        !> Taylor coefficients of the motions at their states. Those of the quotient obey
        !> Q_k (1 + s Gamma3_0)/s = n_k - sum over j = 1..k of Gamma3_j Q_(k-j), with n = omega1 Gamma1 + omega2 Gamma2;
        !> they and n are known up to order - 1, and the next are zero.
        pure subroutine expand(order, body, side, state, c) bind(C, name='spintop_expand_lanes')
            import :: c_double, c_int, lane_body_t
            integer(c_int), value :: order !! 1 to `max_series_order`
            type(lane_body_t), intent(in) :: body !! the bodies
            real(c_double), intent(in) :: side(*), state(*) !! s; (omega, Gamma, xi)
            real(c_double), intent(out) :: c(*) !! Taylor coefficients (lane, row, term)
        end subroutine expand

        !> Sets the constants of a lane for a body with effects.
        pure subroutine set_effects(body, lane, constants) bind(C, name='spintop_lanes_set')
            import :: body_numbers_t, c_double, c_int
            type(body_numbers_t), intent(in) :: body !! the body and what acts on it
            integer(c_int), value :: lane !! index of the lane, from zero on
            real(c_double), intent(inout) :: constants(*) !! those of all lanes
        end subroutine set_effects

        !> Taylor coefficients of motions with effects, as by `expand`, and the further rows. Where there is no series, as for a
        !> drag at rest, they are not finite.
        pure subroutine expand_affected(order, kinds, constants, t, side, state, c, more) &
            bind(C, name='spintop_expand_affected_lanes')
            import :: c_double, c_int, motion_kinds_t
            integer(c_int), value :: order !! 1 to `max_series_order`
            type(motion_kinds_t), intent(in) :: kinds !! which effects all bodies have
            real(c_double), dimension(*), intent(in) :: constants, t, side, state
                !! constants of the bodies; times, s; sides; (omega, Gamma, xi)
            real(c_double), dimension(*), intent(inout) :: c, more
                !! Taylor coefficients, and the further rows (lane, row, term)
        end subroutine expand_affected

        !> Propagates perturbations along the motions. `whole` is the sum of the magnitudes of their components, those of
        !> delta in units of `pace`, and `last` the same of the last two terms of their series.
        pure subroutine carry_tangents(order, body, c, duration, pace, number, before, after, whole, last) &
            bind(C, name='spintop_carry_tangents')
            import :: c_double, c_int, lane_body_t, lanes
            integer(c_int), value :: order !! order of the series, up to that of the motions
            type(lane_body_t), intent(in) :: body !! the bodies
            real(c_double), intent(in) :: c(*) !! Taylor coefficients of the motions (lane, row, term)
            real(c_double), intent(in) :: duration(lanes), pace(lanes) !! s; rad/s
            integer(c_int), value :: number !! of perturbations
            real(c_double), intent(in) :: before(*) !! the perturbations (lane, component, number): delta, epsilon
            real(c_double), intent(inout) :: after(*) !! the same after the duration
            real(c_double), intent(out) :: whole(lanes), last(lanes) !! their size before it, and that of the last two terms
        end subroutine carry_tangents
    end interface

end module spintop_lane_series
