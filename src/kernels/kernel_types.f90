!> Sizes and types of the arguments of the kernels in C, as kernels.h has them (`test/program/kernel_types_test.py` compares).
!>
!> A kernel is declared where it is called: in the module of the formulation or the method that it belongs to.
module spintop_kernel_types
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    implicit none
    private
    public :: numbers, half, set_aside, highest_order, lanes, rows, more_rows, most_drags
    public :: body_products_t, stage_factors_t, symmetric_top_t, drag_t, series_effects_t, stage_effects_t
    public :: lane_body_t, lane_kinds_t, lane_drag_t, lane_constants_t

    !> Numbers in a state and in a term of a series, room of a vector of three components, what a stage sets aside, and the
    !> highest order of a series.
    integer, parameter :: numbers = 8, half = numbers / 2, set_aside = 3 * half, highest_order = 30
    !> Number of lanes: that of doubles in the widest vectors of current processors. Rows of a term in lanes, further rows with
    !> effects, and drags.
    integer, parameter :: lanes = 8, rows = 9, more_rows = 33, most_drags = 2

    !> Factors of the three products of body_vectors.h, of damping and torque.
    type, bind(C) :: body_products_t
        real(c_double), dimension(numbers) :: first = 0, second = 0, third = 0, decay = 0, pull = 0, swing = 0
        !> 1 where the factor a0 of the first product is steadier than b0.
        real(c_double) :: is_steady(numbers) = 0
    end type body_products_t

    !> Constants of the equations of omega for stages: those of momenta over I.
    type, bind(C) :: stage_factors_t
        real(c_double), dimension(half) :: inertia = 0, mobility = 0, coupling = 0, decay = 0, pull = 0, swing = 0
    end type stage_factors_t

    !> A symmetric top in space axes: I1, m g l/I1, and the rate w3 = L_z/I1 of the turn about the vertical.
    type, bind(C) :: symmetric_top_t
        real(c_double) :: inertia = 1, pull = 0, turn_rate = 0
    end type symmetric_top_t

    !> A drag: matrices that make x and z of w, and b.
    type, bind(C) :: drag_t
        real(c_double) :: speed(half, 3) = 0, moment(half, 3) = 0, power = 1
    end type drag_t

    !> Constants of the equations of one body with effects.
    type, bind(C) :: series_effects_t
        !> Factors of the products of vectors, as in `body_products_t`; then those of X and Y with U.
        real(c_double), dimension(numbers) :: first = 0, second = 0, third = 0, turn_first = 0, turn_second = 0
        !> The rotation of the frame in the rates of the quaternion, and of X and Y.
        real(c_double) :: frame(half, 3) = 0, side_frame(numbers, 2) = 0
        real(c_double), dimension(half) :: coupling = 0, is_steady = 0, inverse_inertia = 0, damping = 0, arm = 0, &
            frame_rate = 0
        real(c_double), dimension(half) :: torque_body = 0, torque_space = 0, rotor_torque = 0
        type(drag_t) :: drag(most_drags) = drag_t()
        real(c_double) :: gravity = 0, circle = 0
        integer(c_int) :: drags = 0, has_sides = 0, turns = 0, is_driven = 0, vibrates = 0
    end type series_effects_t

    !> The same for stages.
    type, bind(C) :: stage_effects_t
        real(c_double), dimension(half) :: mobility = 0, coupling = 0, damping = 0, weight = 0, arm = 0, drag = 0, &
            torque_body = 0, rotor = 0, drive = 0, torque_space = 0, frame = 0
        real(c_double) :: swing(half, 2) = 0
        real(c_double) :: gravity = 0, drag_power = 0, drag_force = 0, rate = 0
        integer(c_int) :: has_sides = 0, has_rotor = 0, has_drag = 0, vibrates = 0, turns = 0
    end type stage_effects_t

    !> Bodies in lanes, or changes of them: the numbers by which their motions are expanded. (I2 - I3)/I1 and cyclic;
    !> damping/I, 1/s; m g (r3/I1, r1/I2, r2/I3) and m g (r2/I1, r3/I2, r1/I3), 1/s^2.
    type, bind(C) :: lane_body_t
        real(c_double), dimension(lanes, 3) :: coupling = 0, decay = 0, pull = 0, swing = 0
    end type lane_body_t

    !> Which effects the bodies of all lanes have.
    type, bind(C) :: lane_kinds_t
        integer(c_int) :: turns = 0, twists = 0, vibrates = 0, drags = 0
    end type lane_kinds_t

    !> Drags in lanes: Q as 11, 22, 33, 23, 31, 12; D, the coefficients over I; and b.
    type, bind(C) :: lane_drag_t
        real(c_double) :: speed(lanes, 6) = 0, moment(lanes, 3) = 0, power(lanes) = 1
    end type lane_drag_t

    !> Constants of the equations of bodies with effects in lanes.
    type, bind(C) :: lane_constants_t
        !> (I2 - I3)/I1 and cyclic, damping/I, m (r3/I1, r1/I2, r2/I3) and m (r2/I1, r3/I2, r1/I3), and g.
        real(c_double), dimension(lanes, 3) :: coupling = 0, decay = 0, pull = 0, swing = 0
        real(c_double) :: gravity(lanes) = 0
        !> 1/I; the constant torque in body axes less that of the rotor's drive, over I.
        real(c_double), dimension(lanes, 3) :: inverse_inertia = 0, torque = 0
        !> (h2/I1, h3/I2, h1/I3) and (h3/I1, h1/I2, h2/I3) at the start, and their rates.
        real(c_double), dimension(lanes, 3, 2) :: rotor = 0, drive = 0
        !> Rotation of the frame, and torque, both in space axes; motion of the pivot.
        real(c_double), dimension(lanes, 3) :: frame_rate = 0, torque_space = 0, amplitude = 0, phase = 0
        real(c_double) :: rate(lanes) = 1
        type(lane_drag_t) :: drag(most_drags) = lane_drag_t()
    end type lane_constants_t

end module spintop_kernel_types
