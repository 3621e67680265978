!> Taylor series of the motions of many bodies with analytic effects, one in each lane of a vector.
!>
!> The state is that of `spintop_lane_series`, (omega, Gamma, xi); omega is relative to the frame. motion_series.h has the
!> equations. Dry friction, harmonic torques and tables have no place here.
module spintop_lane_effects
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_body_numbers, only: numbers_of
    use spintop_kernel_types, only: body_numbers_t, lane_constants, lanes, more_rows, motion_kinds_t, rows
    use spintop_kinds, only: dp
    use spintop_lane_series, only: parts
    use spintop_series_shares, only: share_rest, short_share
    implicit none
    private
    public :: lane_effects_t
    public :: row_frame, row_torque, row_push, row_drags, rows_of_drag, row_moment

    !> The first of some further rows of a term: rotation of the frame, torque in space axes, acceleration of
    !> the pivot, drags; of a drag, v = y u is from its row `row_moment` on. lane_rows.h repeats them.
    integer, parameter :: row_frame = 1, row_torque = 4, row_push = 7, row_drags = 16, rows_of_drag = 9, row_moment = 6

    !> The effects in all lanes.
    type :: lane_effects_t
        type(motion_kinds_t) :: kinds
        real(c_double), private :: constants(lanes, lane_constants) = 0
    contains
        procedure :: set_lane
        procedure :: expand
    end type lane_effects_t

    interface
        pure subroutine c_set(body, lane, constants) bind(C, name='spintop_set_lane')
            import :: body_numbers_t, c_double, c_int
            type(body_numbers_t), intent(in) :: body
            integer(c_int), value :: lane
            real(c_double), intent(inout) :: constants(*)
        end subroutine c_set

        pure subroutine c_expand(order, kinds, constants, t, side, state, share, share_rest, c, more) &
            bind(C, name='spintop_expand_affected_lanes')
            import :: c_double, c_int, motion_kinds_t
            integer(c_int), value :: order
            type(motion_kinds_t), intent(in) :: kinds
            real(c_double), dimension(*), intent(in) :: constants, t, side, state, share, share_rest
            real(c_double), dimension(*), intent(inout) :: c, more
        end subroutine c_expand
    end interface

contains

    !> Sets the constants of a lane for a body with effects.
    pure subroutine set_lane(self, lane, body)
        class(lane_effects_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties and effects of the body
        call c_set(numbers_of(body), lane - 1, self%constants)
    end subroutine set_lane

    !> Taylor coefficients of the motions at their states, as by `expand` of `spintop_lane_series`, and the further rows. Where
    !> there is no series, as for a drag at rest, they are not finite.
    pure subroutine expand(self, order, t, side, state, c, more)
        class(lane_effects_t), intent(in) :: self
        integer, intent(in) :: order !! 1 to `max_series_order`
        real(dp), intent(in) :: t(lanes), side(lanes), state(lanes, parts) !! times, s; sides; (omega, Gamma, xi)
        real(dp), intent(inout) :: c(lanes, rows, 0:order), more(lanes, more_rows, 0:order)
            !! Taylor coefficients, and the further rows (lane, row, term)
        call c_expand(order, self%kinds, self%constants, t, side, state, short_share, share_rest, c, more)
    end subroutine expand

end module spintop_lane_effects
