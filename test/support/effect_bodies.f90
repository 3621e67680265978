!> A body under each analytic effect, and attitudes, for tests of its equations.
module effect_bodies
    use spintop_body, only: body_t
    use spintop_effects, only: effects_t
    use spintop_kinds, only: dp
    implicit none
    private
    public :: attitude, body_with, kinds

    !> An attitude above the horizontal and one below it, and a quaternion that is not a unit one.
    real(dp), parameter :: attitude(4, 3) = reshape( &
        [0.8_dp, 0.36_dp, -0.48_dp, 0.0_dp, 0.1_dp, 0.7_dp, -0.7_dp, 0.1_dp, 0.3_dp, 0.2_dp, 0.1_dp, -0.4_dp], [4, 3])
    !> Kinds of effects; the last is all of them together.
    integer, parameter :: kinds = 14

contains

    !> A body without symmetry, with damping, and one effect of each kind; the last has all of them.
    function body_with(kind) result(body)
        integer, intent(in) :: kind
        type(body_t) :: body
        type(effects_t) :: e
        logical :: has(kinds)

        has = .false.
        has(kind) = .true.
        if (kind == kinds) has = .true.
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
        body%inertia = [1.0_dp, 1.3_dp, 0.8_dp]
        body%centre_of_mass = [0.1_dp, -0.2_dp, 0.5_dp]
        body%damping = [0.1_dp, 0.2_dp, 0.05_dp]
        body%effects = e
    end function body_with

end module effect_bodies
