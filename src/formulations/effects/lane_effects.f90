!> Taylor series of the motions of many bodies with analytic effects, one in each lane of a vector.
!>
!> The state is that of `spintop_lane_series`, (omega, Gamma, xi); omega is relative to the frame. Every vector S that is
!> constant in space turns as Gamma does, S' = S x omega: the rotation O of the frame, and the torque M in space axes. The
!> acceleration B of a pivot that vibrates with the rate W, and C = R^T (R B)'/W, obey B' = B x omega + W C and
!> C' = C x omega - W B, whatever the amplitudes and phases. With w = omega + O and the momentum h of the rotor,
!>
!>     I w' = (I w) x w + h x w + m (g Gamma + B) x r - damping omega + M + torque - h' - D y u,   omega' = w' - O'
!>
!> A drag has u = Q omega, s = omega . u and y = s^b: u = omega for the moment of the air, and u = r x (omega x r) for the
!> force on the centre of mass. Dry friction and tables of torques have no place here.
module spintop_lane_effects
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_compare, only: is_zero
    use spintop_effects, only: effects_t
    use spintop_kernel_types, only: lane_constants_t, lane_kinds_t, lanes, more_rows, rows
    use spintop_kinds, only: dp
    use spintop_lane_series, only: parts
    use spintop_series_shares, only: share_rest, short_share
    implicit none
    private
    public :: lane_effects_t, kinds_of
    public :: row_frame, row_torque, row_push, row_drags, rows_of_drag, row_moment

    !> The first of some further rows of a term: rotation of the frame, torque in space axes, acceleration of
    !> the pivot, drags; of a drag, v = y u is from its row `row_moment` on. lane_rows.h repeats them.
    integer, parameter :: row_frame = 1, row_torque = 4, row_push = 7, row_drags = 16, rows_of_drag = 9, row_moment = 6

    !> The effects in all lanes.
    type :: lane_effects_t
        type(lane_kinds_t) :: kinds
        type(lane_constants_t) :: of
    contains
        procedure :: set_lane
        procedure :: expand
    end type lane_effects_t

    interface
        pure subroutine c_expand(order, kinds, effects, t, side, state, share, share_rest, c, more) &
            bind(C, name='spintop_expand_affected_lanes')
            import :: c_double, c_int, lane_constants_t, lane_kinds_t
            integer(c_int), value :: order
            type(lane_kinds_t), intent(in) :: kinds
            type(lane_constants_t), intent(in) :: effects
            real(c_double), dimension(*), intent(in) :: t, side, state, share, share_rest
            real(c_double), dimension(*), intent(inout) :: c, more
        end subroutine c_expand
    end interface

contains

    !> Which effects a body has. Bodies are in lanes together only if they have the same, so that the sums of a body do not
    !> depend on its neighbours.
    pure type(lane_kinds_t) function kinds_of(body) result(kinds)
        type(body_t), intent(in) :: body !! a body with effects
        associate (effects => body%effects)
            kinds%turns = merge(0, 1, all(is_zero(effects%frame_rate)))
            kinds%twists = merge(0, 1, all(is_zero(effects%torque_space)))
            kinds%vibrates = merge(0, 1, all(is_zero(effects%vibration_amplitude)))
            kinds%drags = merge(1, 0, has_drag_moment(effects)) + merge(1, 0, has_drag_force(body))
        end associate
    end function kinds_of

    !> Whether the air has a moment that is not linear in the angular velocity.
    pure logical function has_drag_moment(effects)
        type(effects_t), intent(in) :: effects !! effects on a body
        has_drag_moment = any(effects%drag_moment > 0) .and. .not. is_zero(effects%drag_exponent - 1)
    end function has_drag_moment

    !> Whether the air acts on the centre of mass, which is not at the pivot.
    pure logical function has_drag_force(body)
        type(body_t), intent(in) :: body !! a body with effects
        has_drag_force = body%effects%drag_force > 0 .and. any(abs(body%centre_of_mass) > 0)
    end function has_drag_force

    !> Sets the constants of a lane for a body with effects.
    pure subroutine set_lane(self, lane, body)
        class(lane_effects_t), intent(inout) :: self
        integer, intent(in) :: lane !! index of the lane
        type(body_t), intent(in) :: body !! mass properties and effects of the body
        real(dp) :: arm(3)
        arm = body%mass * body%centre_of_mass
        associate (of => self%of, inertia => body%inertia, effects => body%effects)
            of%coupling(lane, :) = (cshift(inertia, 1) - cshift(inertia, 2)) / inertia
            of%decay(lane, :) = body%damping / inertia
            of%pull(lane, :) = cshift(arm, -1) / inertia
            of%swing(lane, :) = cshift(arm, 1) / inertia
            of%gravity(lane) = body%gravity
            of%inverse_inertia(lane, :) = 1 / inertia
            of%torque(lane, :) = (effects%torque_body - effects%rotor_torque) / inertia
            of%rotor(lane, :, 1) = cshift(effects%rotor_momentum, 1) / inertia
            of%rotor(lane, :, 2) = cshift(effects%rotor_momentum, -1) / inertia
            of%drive(lane, :, 1) = cshift(effects%rotor_torque, 1) / inertia
            of%drive(lane, :, 2) = cshift(effects%rotor_torque, -1) / inertia
            of%frame_rate(lane, :) = effects%frame_rate
            of%torque_space(lane, :) = effects%torque_space
            of%amplitude(lane, :) = effects%vibration_amplitude
            of%phase(lane, :) = effects%vibration_phase
            of%rate(lane) = effects%vibration_rate
        end associate
        call set_drags(self, lane, body)
    end subroutine set_lane

    !> The same for the drags. A moment that is linear in omega is damping.
    pure subroutine set_drags(self, lane, body)
        class(lane_effects_t), intent(inout) :: self
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        integer :: n
        n = 0
        associate (of => self%of, inertia => body%inertia, effects => body%effects, r => body%centre_of_mass)
            if (has_drag_moment(effects)) then
                n = n + 1
                of%drag(n)%speed(lane, :) = [1, 1, 1, 0, 0, 0]
                of%drag(n)%moment(lane, :) = effects%drag_moment / inertia
                of%drag(n)%power(lane) = (effects%drag_exponent - 1) / 2
            else
                of%decay(lane, :) = of%decay(lane, :) + effects%drag_moment / inertia
            end if
            if (has_drag_force(body)) then
                n = n + 1
                of%drag(n)%speed(lane, :3) = cshift(r, 1)**2 + cshift(r, 2)**2
                of%drag(n)%speed(lane, 4:) = -cshift(r, 1) * cshift(r, 2)
                of%drag(n)%moment(lane, :) = effects%drag_force / inertia
                of%drag(n)%power(lane) = 0.5_dp
            end if
        end associate
    end subroutine set_drags

    !> Taylor coefficients of the motions at their states, as by `expand` of `spintop_lane_series`, and the further rows. Where
    !> there is no series, as for a drag at rest, they are not finite.
    pure subroutine expand(self, order, t, side, state, c, more)
        class(lane_effects_t), intent(in) :: self
        integer, intent(in) :: order !! 1 to `max_series_order`
        real(dp), intent(in) :: t(lanes), side(lanes), state(lanes, parts) !! times, s; sides; (omega, Gamma, xi)
        real(dp), intent(inout) :: c(lanes, rows, 0:order), more(lanes, more_rows, 0:order)
            !! Taylor coefficients, and the further rows (lane, row, term)
        call c_expand(order, self%kinds, self%of, t, side, state, short_share, share_rest, c, more)
    end subroutine expand

end module spintop_lane_effects
