!> A body and what acts on it as the kernels take it: its numbers, and which parts of the equations of motion_series.h it has.
module spintop_body_numbers
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, is_zero
    use spintop_effects, only: effects_t
    use spintop_kernel_types, only: body_numbers_t, motion_kinds_t
    use spintop_loads, only: find_kinematics, loads_t
    implicit none
    private
    public :: kinds_of, numbers_of, look_up, has_drag_moment

contains

    !> Which parts of the equations a body has. Bodies are in lanes together only if they have the same, so that the sums of a
    !> body do not depend on its neighbours.
    pure type(motion_kinds_t) function kinds_of(body) result(kinds)
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            kinds%rotor = merge(0, 1, all(is_zero([effects%rotor_momentum, effects%rotor_torque, effects%torque_body])))
            kinds%frame = direction_of(effects%frame_rate)
            kinds%torque = direction_of(effects%torque_space)
            kinds%push = direction_of(effects%vibration_amplitude)
            ! A frame that does not turn about the vertical accelerates a pivot across it.
            if (kinds%push > 0) kinds%push = max(kinds%push, kinds%frame)
            kinds%drags = merge(1, 0, has_drag_moment(effects)) + merge(2, 0, has_drag_force(body))
            kinds%harmonic = merge(1, 0, allocated(effects%harmonic_space)) + merge(2, 0, allocated(effects%harmonic_body))
            if (allocated(effects%table)) kinds%table = merge(1, 0, effects%table_in_space)
            kinds%given = merge(1, 0, allocated(effects%table) .and. .not. effects%table_in_space)
            if (effects%has_friction()) kinds%friction = merge(2, 1, effects%friction_arm > 0)
            kinds%law = merge(1, 0, allocated(effects%friction_table))
        end associate
    end function kinds_of

    !> 1 if a vector in space is along the vertical, 2 in another direction, 0 if it is zero.
    pure integer(c_int) function direction_of(vector)
        real(dp), intent(in) :: vector(3)
        direction_of = merge(0, 1, is_zero(vector(3)))
        if (.not. all(is_zero(vector(:2)))) direction_of = 2
    end function direction_of

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

    !> The numbers of a body and of what acts on it.
    pure type(body_numbers_t) function numbers_of(body) result(of)
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        of%inertia = body%inertia
        of%centre = body%centre_of_mass
        of%damping = body%damping
        of%mass = body%mass
        of%gravity = body%gravity
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            of%axis = effects%friction_axis
            of%friction_torque = effects%friction_torque
            of%friction_arm = effects%friction_arm
            of%smoothing = effects%friction_smoothing
            of%drag_moment = effects%drag_moment
            of%drag_exponent = effects%drag_exponent
            if (has_drag_force(body)) of%drag_force = effects%drag_force
            of%rotor = effects%rotor_momentum
            of%drive = effects%rotor_torque
            of%torque_body = effects%torque_body
            of%torque_space = effects%torque_space
            of%frame = effects%frame_rate
            of%earth_rate = effects%earth_rate
            of%latitude = effects%latitude
            of%amplitude(:, 1) = effects%vibration_amplitude
            of%phase(:, 1) = effects%vibration_phase
            of%rate(1) = effects%vibration_rate
            if (allocated(effects%harmonic_space)) then
                of%amplitude(:, 2) = effects%harmonic_space%amplitude
                of%phase(:, 2) = effects%harmonic_space%phase
                of%rate(2) = effects%harmonic_space%rate
            end if
            if (allocated(effects%harmonic_body)) then
                of%amplitude(:, 3) = effects%harmonic_body%amplitude
                of%phase(:, 3) = effects%harmonic_body%phase
                of%rate(3) = effects%harmonic_body%rate
            end if
        end associate
    end function numbers_of

    !> What tables say at a time in a state: terms of the torque over time, for that in space axes, and of the laws of friction
    !> about the axis towards smaller and larger angular velocities, after the one that these are about.
    pure subroutine look_up(body, t, y, table, law)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: t, y(:)
        real(dp), intent(out) :: table(3, 0:3), law(5, 2)
        type(loads_t) :: loads
        real(dp) :: slack
        integer :: side, i
        table = 0
        law = 0
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            if (allocated(effects%table)) table = effects%table%expansion(t)
            if (.not. allocated(effects%friction_table)) return
            call find_kinematics(body, effects, t, y(1:4), y(5:7), loads)
            slack = effects%slack_of_spin(loads%omega)
            do side = 1, 2
                i = effects%friction_table%interval_towards(dot_product(effects%friction_axis, loads%omega), &
                                                            real(2 * side - 3, dp), slack)
                law(:, side) = [effects%friction_table%knots(i), effects%friction_table%coefficient(:, 3, i)]
            end do
        end associate
    end subroutine look_up

end module spintop_body_numbers
