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
    use spintop_body, only: body_t
    use spintop_body_numbers, only: numbers_of
    use spintop_kernel_types, only: body_numbers_t, lane_body_t, lane_constants, lanes, more_rows, motion_kinds_t, &
        rows, share_rest, short_share
    use spintop_kinds, only: dp
    implicit none
    private
    public :: expand, lanes, parts, quotient, numerator, rows, carry_tangents, components
    public :: lane_effects_t, row_frame, row_torque, row_push, row_drags, rows_of_drag, row_moment

    !> Components of a state: omega, Gamma, xi; they are followed by the quotient Q and omega1 Gamma1 + omega2 Gamma2.
    integer, parameter :: parts = 7, quotient = 8, numerator = 9

    !> Components of a perturbation: delta, epsilon. lane_series.h repeats their number.
    integer, parameter :: components = 6
    !> The first of some further rows of a term: rotation of the frame, torque in space axes, acceleration of
    !> the pivot, drags; of a drag, v = y u is from its row `row_moment` on. kernels.h repeats them.
    integer, parameter :: row_frame = 1, row_torque = 4, row_push = 7, row_drags = 16, rows_of_drag = 9, row_moment = 6

    !> The effects in all lanes.
    type :: lane_effects_t
        type(motion_kinds_t) :: kinds
        real(c_double), private :: constants(lanes, lane_constants) = 0
    contains
        procedure :: set_lane
        procedure :: expand => expand_affected
    end type lane_effects_t

    interface
        pure subroutine c_expand(order, body, side, state, share, share_rest, c) bind(C, name='spintop_expand_lanes')
            import :: c_double, c_int, lane_body_t
            integer(c_int), value :: order
            type(lane_body_t), intent(in) :: body
            real(c_double), dimension(*), intent(in) :: side, state, share, share_rest
            real(c_double), intent(out) :: c(*)
        end subroutine c_expand

        pure subroutine c_set(body, lane, constants) bind(C, name='spintop_set_lane')
            import :: body_numbers_t, c_double, c_int
            type(body_numbers_t), intent(in) :: body
            integer(c_int), value :: lane
            real(c_double), intent(inout) :: constants(*)
        end subroutine c_set

        pure subroutine c_expand_affected(order, kinds, constants, t, side, state, share, share_rest, c, more) &
            bind(C, name='spintop_expand_affected_lanes')
            import :: c_double, c_int, motion_kinds_t
            integer(c_int), value :: order
            type(motion_kinds_t), intent(in) :: kinds
            real(c_double), dimension(*), intent(in) :: constants, t, side, state, share, share_rest
            real(c_double), dimension(*), intent(inout) :: c, more
        end subroutine c_expand_affected

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

    !> Sets the constants of a lane for a body with effects.
    pure subroutine set_lane(self, lane, body)
        class(lane_effects_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties and effects of the body
        call c_set(numbers_of(body), lane - 1, self%constants)
    end subroutine set_lane

    !> Taylor coefficients of the motions at their states, as by `expand`, and the further rows. Where
    !> there is no series, as for a drag at rest, they are not finite.
    pure subroutine expand_affected(self, order, t, side, state, c, more)
        class(lane_effects_t), intent(in) :: self
        integer, intent(in) :: order !! 1 to `max_series_order`
        real(dp), intent(in) :: t(lanes), side(lanes), state(lanes, parts) !! times, s; sides; (omega, Gamma, xi)
        real(dp), intent(inout) :: c(lanes, rows, 0:order), more(lanes, more_rows, 0:order)
            !! Taylor coefficients, and the further rows (lane, row, term)
        call c_expand_affected(order, self%kinds, self%constants, t, side, state, short_share, share_rest, c, more)
    end subroutine expand_affected

end module spintop_lane_series
