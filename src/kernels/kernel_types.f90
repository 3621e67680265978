!> Sizes and types of the arguments of the kernels in C, as kernels.h has them (`test/program/kernel_types_test.py` compares), and
!> constants of power series: tables that depend on the number of a term, made by the compiler.
!>
!> A kernel is declared where it is called: in the module of the formulation or the method that it belongs to.
module spintop_kernel_types
    use, intrinsic :: iso_c_binding, only: c_double, c_int, c_long_long
    use, intrinsic :: iso_fortran_env, only: sp => real32
    use spintop_kinds, only: dp, qp
    implicit none
    private
    public :: one_constants, lane_constants, numbers, half, set_aside, highest_order, lanes, rows, more_rows, most_drags
    public :: symmetric_top_t, body_numbers_t, motion_kinds_t, lane_body_t, exact_block_t, block_size
    public :: acceleration_share, acceleration_rest, per_binomial

    !> Numbers in a state and in a term of a series, room of a vector of three components, what a stage sets aside, and the
    !> highest order of a series.
    integer, parameter :: numbers = 8, half = numbers / 2, set_aside = 3 * half, highest_order = 30
    !> Number of lanes: that of doubles in the widest vectors of current processors. Rows of a term in lanes, further rows with
    !> effects, and drags.
    integer, parameter :: lanes = 8, rows = 9, more_rows = 36, most_drags = 2
    !> Numbers that series and stages keep of a body: of one body, and in each lane.
    integer, parameter :: one_constants = 99, lane_constants = 69

    !> A symmetric top in space axes: I1, m g l/I1, and the rate w3 = L_z/I1 of the turn about the vertical.
    type, bind(C) :: symmetric_top_t
        real(c_double) :: inertia = 1, pull = 0, turn_rate = 0
    end type symmetric_top_t

    !> A body and what acts on it. Of what vibrates: of the pivot, of a torque in space axes, of one in body axes.
    type, bind(C) :: body_numbers_t
        real(c_double), dimension(3) :: inertia = 1, centre = 0, damping = 0, axis = 0, drag_moment = 0, rotor = 0, drive = 0, &
            torque_body = 0, torque_space = 0, frame = 0
        real(c_double), dimension(3, 3) :: amplitude = 0, phase = 0
        real(c_double) :: rate(3) = 0
        real(c_double) :: mass = 1, gravity = 0, friction_torque = 0, friction_arm = 0, smoothing = 0, drag_exponent = 1, &
            drag_force = 0, earth_rate = 0, latitude = 0
    end type body_numbers_t

    !> Which parts of the equations there are, for the series: a rotor, or a torque that is constant in body axes; the rotation of
    !> the frame, the torque in space axes and the motion of the pivot, 1 along the vertical, 2 in any direction; drags, 1 by the
    !> angular velocity, 2 of the centre of mass, 3 both; harmonic torques, 1 in space axes, 2 in body axes, 3 both; a table of
    !> torques in space axes; dry friction, 2 with load; friction by a table; torques over time in body axes whose terms are given.
    type, bind(C) :: motion_kinds_t
        integer(c_int) :: rotor = 0, frame = 0, torque = 0, push = 0, drags = 0, harmonic = 0, table = 0, friction = 0, law = 0, &
            given = 0
    end type motion_kinds_t

    !> Bodies in lanes, or changes of them: the numbers by which their motions are expanded. (I2 - I3)/I1 and cyclic;
    !> damping/I, 1/s; m g (r3/I1, r1/I2, r2/I3) and m g (r2/I1, r3/I2, r1/I3), 1/s^2.
    type, bind(C) :: lane_body_t
        real(c_double), dimension(lanes, 3) :: coupling = 0, decay = 0, pull = 0, swing = 0
    end type lane_body_t

    !> Maximum number of cases of a block.
    integer, parameter :: block_size = 512

    !> Undamped symmetric tops to be computed together (spintop_exact_block), one per element of each array, SI units and radians.
    type, bind(C) :: exact_block_t
        !> The data, moments of inertia about the pivot (kg m^2), m g l (N m), inclination (rad), rates of phi and
        !> theta (rad/s), angular velocity about the body axis (rad/s), phi and psi (rad), end of the span
        !> (s), and a time for which phi is needed (s).
        real(c_double), dimension(block_size) :: inertia1, inertia3, mgl, theta, phi_rate, theta_rate, &
            omega3, phi, psi, t_end, t_period
        !> Turning angles (rad), cos(theta_max), and cos(theta_min) - cos(theta_max) without cancellation.
        real(c_double), dimension(block_size) :: theta_min, theta_max, u_min, delta_u
        !> Nutation period (s), change of phi per nutation (rad), mean precession rate, and the value of phi'
        !> that is largest in magnitude (rad/s).
        real(c_double), dimension(block_size) :: period, precession, precession_rate, phi_rate_max
        !> Angles (rad) and nutation rate (rad/s) at `t_end`, and the change of energy since the start,
        !> relative to the kinetic energy at the start plus m g l.
        real(c_double), dimension(block_size) :: theta_end, phi_end, psi_end, theta_rate_end, energy_error
        !> Change of phi from the start to `t_period`, rad.
        real(c_double), dimension(block_size) :: phi_at_period
        !> Not 0 where the kernel may not have reached `block_accuracy`.
        integer(c_long_long) :: doubt(block_size)
        !> Status of each case: `status_ok`, a status of `prepare_exact_motion`, or `status_non_finite` if a
        !> result is not finite. The period and the change of phi per period may be infinite (on the
        !> separatrix, and for an axis at rest).
        integer(c_int) :: status(block_size) = 0
        !> Number of cases, up to `block_size`, and of those that were computed by the scalar routine.
        integer(c_int) :: n = 0, fallbacks = 0
    end type exact_block_t

    !> Indices in the tables: no compiler need know a type within a constructor.
    integer :: k, n
    !> 1/((k + 1) (k + 2)), by which coefficient k of a second derivative becomes the next but one of the state, as a number in
    !> single precision and a remainder (vectors.h).
    real(dp), parameter :: acceleration_share(0:*) = [(real(1 / real((k + 1) * (k + 2), sp), dp), k=0, highest_order)]
    real(dp), parameter :: acceleration_rest(0:*) = &
        [(real(1 / real((k + 1) * (k + 2), qp) - 1 / real((k + 1) * (k + 2), sp), dp), k=0, highest_order)]
    !> 1 over the binomial coefficient n over k.
    real(dp), parameter :: per_binomial(0:highest_order, 0:highest_order) = reshape( &
        [((gamma(real(k + 1, dp)) * gamma(real(max(n - k, 0) + 1, dp)) / gamma(real(n + 1, dp)), &
           k=0, highest_order), n=0, highest_order)], [highest_order + 1, highest_order + 1])

end module spintop_kernel_types
