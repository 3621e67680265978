!> A body under each effect, and attitudes, for tests of its equations.
module effect_bodies
    use spintop_body, only: body_t
    use spintop_effects, only: effect_axial_rotor, effect_drag, effect_drive, effect_frame, effect_friction, &
        effect_friction_table, effect_harmonic, effect_lift, effect_rotor, effect_shake, effect_table, effect_torque, &
        effect_upright_frame, effects_t, harmonic_t
    use spintop_kinds, only: dp
    use spintop_torque_table, only: by_lines, by_monotone, make_friction_table, make_torque_table
    implicit none
    private
    public :: any_body, attitude, body_with, every_kind, kinds, bits_of

    !> An attitude above the horizontal and one below it, and a quaternion that is not a unit one.
    real(dp), parameter :: attitude(4, 3) = reshape( &
        [0.8_dp, 0.36_dp, -0.48_dp, 0.0_dp, 0.1_dp, 0.7_dp, -0.7_dp, 0.1_dp, 0.3_dp, 0.2_dp, 0.1_dp, -0.4_dp], [4, 3])
    !> Kinds of analytic effects, of which the last is all of them together; and with the others, each alone.
    integer, parameter :: kinds = 14, every_kind = 22
    !> What acts in each.
    integer, parameter :: bits_of(every_kind) = [spread(effect_drag, 1, 5), effect_lift, effect_lift + effect_shake, &
        effect_upright_frame, effect_frame, effect_rotor, effect_drive, effect_torque, effect_torque, effect_drag + effect_lift &
        + effect_shake + effect_frame + effect_rotor + effect_drive + effect_torque, effect_friction, effect_friction, &
        effect_friction_table, effect_table, effect_harmonic, effect_harmonic, effect_frame, effect_axial_rotor]

contains

    !> A body without symmetry, with damping, and one effect of each kind, or all that are analytic.
    function body_with(kind) result(body)
        integer, intent(in) :: kind
        type(body_t) :: body
        type(effects_t) :: e
        logical :: has(every_kind)

        has = .false.
        has(kind) = .true.
        if (kind == kinds) has(:kinds) = .true.
        if (has(1)) e%drag_exponent = 1
        if (has(3)) e%drag_exponent = 3
        if (has(4)) e%drag_exponent = 1.5_dp
        if (has(2)) e%drag_exponent = 2
        if (any(has(1:4))) e%drag_moment = [0.02_dp, 0.03_dp, 0.01_dp]
        if (has(5)) e%drag_force = 0.3_dp
        if (has(6)) e%vibration_amplitude(3) = 0.02_dp
        if (has(7)) e%vibration_amplitude = [0.01_dp, -0.02_dp, 0.03_dp]
        e%vibration_rate = 3
        e%vibration_phase = [0.4_dp, 1.7_dp, 5.0_dp]
        if (has(8)) e%frame_rate = [0.0_dp, 0.0_dp, 0.7_dp]
        if (has(9)) e%frame_rate = [0.2_dp, -0.4_dp, 0.5_dp]
        if (has(10)) e%rotor_momentum = [0.3_dp, -0.5_dp, 0.8_dp]
        if (has(11)) e%rotor_torque = [-0.1_dp, 0.2_dp, 0.05_dp]
        if (has(12)) e%torque_body = [0.3_dp, -0.2_dp, 0.1_dp]
        if (has(13)) e%torque_space = [-0.2_dp, 0.4_dp, 0.3_dp]
        if (has(15)) e%friction_torque = 0.1_dp
        if (has(16)) e%friction_arm = 0.01_dp
        if (has(17)) then
            allocate (e%friction_table)
            call make_friction_table([0.0_dp, 2.0_dp, 9.0_dp], [0.0_dp, 0.1_dp, 0.5_dp], by_lines, e%friction_table)
        end if
        if (has(18)) then
            allocate (e%table)
            call make_torque_table([0.0_dp, 1.0_dp, 9.0_dp], reshape([0.1_dp, -0.2_dp, 0.3_dp, 0.2_dp, 0.1_dp, -0.1_dp, 0.0_dp, &
                                                                      0.1_dp, 0.2_dp], [3, 3]), by_monotone, e%table)
        end if
        if (has(19)) e%harmonic_body = harmonic_t([0.3_dp, -0.2_dp, 0.1_dp], [0.4_dp, 1.7_dp, 5.0_dp], 3.0_dp)
        if (has(20)) e%harmonic_space = harmonic_t([-0.2_dp, 0.4_dp, 0.3_dp], [2.0_dp, 0.1_dp, -1.0_dp], 2.5_dp)
        if (has(21)) call e%turn_with_earth(0.5_dp, 0.7_dp)
        if (has(22)) e%rotor_momentum(3) = 0.8_dp
        body = any_body()
        body%effects = e
    end function body_with

    !> A body without symmetry, with damping.
    pure type(body_t) function any_body() result(body)
        body%inertia = [1.0_dp, 1.3_dp, 0.8_dp]
        body%centre_of_mass = [0.1_dp, -0.2_dp, 0.5_dp]
        body%damping = [0.1_dp, 0.2_dp, 0.05_dp]
    end function any_body

end module effect_bodies
