!> The columns of a trajectory table: a line of the registry each, with the vector of the motion of which the column is a
!> component. A scalar is a vector with one component. The help, the choice of columns, the units in the header and the rows
!> derive from the registry.
module spintop_trajectory_columns
    use spintop_attitude, only: rotation_angle, to_space, vertical_from_quaternion
    use spintop_certificate, only: proof_count, proof_of_omega1, proof_of_omega3, proof_of_orientation, proof_of_phi, &
        proof_of_psi, proof_of_q0, proof_of_q1, proof_of_q2, proof_of_q3, proof_of_theta
    use spintop_kinds, only: dp
    use spintop_loads, only: work_damping, work_drag, work_friction, work_rotor, work_torque, work_vibration, works
    use spintop_motion, only: motion_t
    use spintop_motion_view, only: motion_view_t
    use spintop_quantities, only: axial_momentum, axis_height_rate, axis_tip, euler_residuals, &
        goryachev_integral, kovalevskaya_integral, vertical_momentum, specific_force
    use spintop_measures, only: watch_centre_height, watch_energy, watch_kinetic_energy, watch_nothing, &
        watch_omega, watch_phi, watch_potential_energy, watch_psi, watch_spin_momentum, watch_theta, &
        watch_turning, watch_vertical, watch_vertical_momentum
    use spintop_study_column, only: chosen_column_t, place_of, proof_group, study_column_t
    use spintop_table_column, only: column_length
    implicit none
    private
    public :: trajectory_column_t, trajectory_columns, trajectory_columns_at, find_trajectory_column, angle_group
    public :: fill_vector, longest, vectors

    !> The vectors by their numbers.
    integer, parameter :: vector_time = 1, vector_angles = 2, vector_rates = 3, vector_omega = 4, vector_quaternion = 5, &
        vector_vertical = 6, vector_axis = 7, vector_centre = 8, vector_energies = 9, vector_energy_error = 10, &
        vector_momenta = 11, vector_residuals = 12, vector_changes = 13, vector_force = 14, &
        vector_force_beside_axis = 15, vector_errors = 16, vector_inherent_error = 17, vector_norm_error = 18, &
        vector_axis_z_rate = 19, vector_kovalevskaya = 20, vector_goryachev = 21, vector_accelerometer = 22, &
        vector_work = 23, vector_bounds = 24, vector_proof = 25, vector_omega_in_space = 26, vectors = 26

    !> Number of components of the longest vector.
    integer, parameter :: longest = max(proof_count, works + 1)

    !> The group of the columns of the time, the angles and their rates, which need nothing else of a motion.
    character(*), parameter :: angle_group = 'angles'
    !> Groups of columns that need no angles nor their rates.
    character(*), parameter :: groups_free_of_angles(*) = [character(8) :: 'rates', 'attitude', 'energy', 'momenta']

    !> A column of a trajectory.
    type, extends(study_column_t) :: trajectory_column_t
        !> The number of a vector (`vector_...`), and the component of it that is the value of the column.
        integer :: vector = 0, component = 1
        !> What passes a value of the column in a polynomial of each step, if anything does (spintop_measures).
        integer :: passing = watch_nothing
        !> It is in the table when the input names no columns.
        logical :: is_default = .false.
        !> It needs the exact motion; and compares the computed one with that.
        logical :: needs_exact_motion = .false., compares = .false.
        !> It is for bodies with effects.
        logical :: needs_effects = .false.
        !> It contains the work of effects, which is known in the rows of a motion only.
        logical :: needs_work = .false.
        !> Near a pole it may vary much faster than the attitude turns: it depends on phi or psi.
        logical :: varies_near_poles = .false.
        !> At a pole it does not exist.
        logical :: ends_at_poles = .false.
        !> Its cells are words: `unproved` and `proved` for the values 0 and 1.
        logical :: is_proof = .false.
        !> In a table: the quantity is the number in it times the size of its unit, and its name here, which is without a unit.
        real(dp) :: size = 1
        character(column_length), private :: name_of_quantity = ''
    contains
        procedure :: is_free_of_angles
        procedure :: quantity
        procedure :: value
    end type trajectory_column_t

    !> The registry of the columns.
    type(trajectory_column_t), parameter :: registry(*) = [ &
        trajectory_column_t('t', 's', 'time', angle_group, vector_time, 1, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('phi', 'rad', 'precession angle, continuous', angle_group, vector_angles, 1, watch_phi, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('theta', 'rad', 'inclination of body z to the vertical', angle_group, vector_angles, 2, &
                            watch_theta, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('psi', 'rad', 'spin angle, continuous', angle_group, vector_angles, 3, watch_psi, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('phi_rate', 'rad/s', 'precession rate', angle_group, vector_rates, 1, &
                            is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
        trajectory_column_t('theta_rate', 'rad/s', 'nutation rate', angle_group, vector_rates, 2, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('psi_rate', 'rad/s', 'spin rate', angle_group, vector_rates, 3, &
                            is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
        trajectory_column_t('omega1', 'rad/s', 'angular velocity about body x', 'rates', vector_omega, 1, watch_omega), &
        trajectory_column_t('omega2', 'rad/s', 'angular velocity about body y', 'rates', vector_omega, 2, watch_omega), &
        trajectory_column_t('omega3', 'rad/s', 'angular velocity about body z', 'rates', vector_omega, 3, watch_omega), &
        trajectory_column_t('q0', '', 'attitude quaternion, scalar part', 'attitude', vector_quaternion, 1), &
        trajectory_column_t('q1', '', 'attitude quaternion, x', 'attitude', vector_quaternion, 2), &
        trajectory_column_t('q2', '', 'attitude quaternion, y', 'attitude', vector_quaternion, 3), &
        trajectory_column_t('q3', '', 'attitude quaternion, z', 'attitude', vector_quaternion, 4), &
        trajectory_column_t('gamma1', '', 'upward vertical in body axes, x', 'attitude', vector_vertical, 1, &
                            watch_vertical), &
        trajectory_column_t('gamma2', '', 'upward vertical in body axes, y', 'attitude', vector_vertical, 2, &
                            watch_vertical), &
        trajectory_column_t('gamma3', '', 'upward vertical in body axes, z', 'attitude', vector_vertical, 3, &
                            watch_vertical), &
        trajectory_column_t('axis_x', '', 'body z in space axes, x', 'attitude', vector_axis, 1), &
        trajectory_column_t('axis_y', '', 'body z in space axes, y', 'attitude', vector_axis, 2), &
        trajectory_column_t('axis_z', '', 'body z in space axes, z', 'attitude', vector_axis, 3, watch_vertical), &
        trajectory_column_t('com_x', 'm', 'centre of mass in space axes, x', 'attitude', vector_centre, 1, &
                            is_default=.true.), &
        trajectory_column_t('com_y', 'm', 'centre of mass in space axes, y', 'attitude', vector_centre, 2, &
                            is_default=.true.), &
        trajectory_column_t('com_z', 'm', 'centre of mass in space axes, z (height above the pivot)', &
                            'attitude', vector_centre, 3, watch_centre_height, is_default=.true.), &
        trajectory_column_t('kinetic', 'J', 'kinetic energy', 'energy', vector_energies, 1, watch_kinetic_energy, &
                            is_default=.true.), &
        trajectory_column_t('potential', 'J', 'potential energy above the height of the pivot, with -O.IO/2 - O.h &
                            &where the Earth turns (O its rate, h of a rotor)', &
                            'energy', vector_energies, 2, watch_potential_energy, is_default=.true.), &
        trajectory_column_t('energy', 'J', 'total energy', 'energy', vector_energies, 3, watch_energy, is_default=.true.), &
        trajectory_column_t('energy_error', '', &
                            'change of energy since the start over (kinetic at start + m g |r|)', &
                            'energy', vector_energy_error, 1, needs_work=.true.), &
        trajectory_column_t('lz', 'J s', 'angular momentum about the vertical', 'momenta', vector_momenta, 1, &
                            watch_vertical_momentum), &
        trajectory_column_t('l3', 'J s', 'angular momentum about body z', 'momenta', vector_momenta, 2, &
                            watch_spin_momentum), &
        trajectory_column_t('R1', 'N m', "residual of Euler's first equation (Eq 51)", &
                            'residuals', vector_residuals, 1, is_default=.true.), &
        trajectory_column_t('R2', 'N m', "residual of Euler's second equation (Eq 51)", &
                            'residuals', vector_residuals, 2, is_default=.true.), &
        trajectory_column_t('R3', 'J s', 'change of Lz since the start (Eq 51)', 'residuals', vector_changes, 1, &
                            is_default=.true.), &
        trajectory_column_t('R4', 'J', 'change of energy since the start (Eq 51)', 'residuals', vector_changes, 2, &
                            is_default=.true.), &
        trajectory_column_t('force_x', 'N', 'support force on the body, x', 'force', vector_force, 1, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('force_y', 'N', 'support force on the body, y', 'force', vector_force, 2, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('force_z', 'N', 'support force on the body, z', 'force', vector_force, 3, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('force_r', 'N', 'support force away from the vertical, in the plane of the axis', &
                            'force', vector_force_beside_axis, 1, varies_near_poles=.true.), &
        trajectory_column_t('force_n', 'N', 'support force along the line of nodes', &
                            'force', vector_force_beside_axis, 2, varies_near_poles=.true.), &
        trajectory_column_t('orientation_error', 'rad', 'rotation angle from the exact attitude', &
                            'errors', vector_errors, 1, is_default=.true., needs_exact_motion=.true., compares=.true.), &
        trajectory_column_t('tip_error', '', 'distance of the axis tip from the exact one', &
                            'errors', vector_errors, 2, needs_exact_motion=.true., compares=.true.), &
        trajectory_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
                            'errors', vector_inherent_error, 1, is_default=.true., needs_exact_motion=.true.), &
        trajectory_column_t('norm_error', '', 'norm error abs(q) - 1 of the computed quaternion', &
                            'errors', vector_norm_error, 1), &
        trajectory_column_t('omega_x', 'rad/s', 'angular velocity about space x', 'rates', vector_omega_in_space, 1), &
        trajectory_column_t('omega_y', 'rad/s', 'angular velocity about space y', 'rates', vector_omega_in_space, 2), &
        trajectory_column_t('omega_z', 'rad/s', 'angular velocity about space z', 'rates', vector_omega_in_space, 3), &
        trajectory_column_t('axis_z_rate', '1/s', 'rate of axis_z, zero at the turning points of theta', &
                            'attitude', vector_axis_z_rate, 1, watch_turning), &
        trajectory_column_t('kovalevskaya', '1/s^4', 'Kovalevskaya integral; constant for I1 = I2 = 2 I3 and ' // &
                            'centre of mass in body x y', 'momenta', vector_kovalevskaya, 1), &
        trajectory_column_t('goryachev', '1/s^3', 'integral of Goryachev and Chaplygin; constant for I1 = I2 = 4 I3, ' // &
                            'Lz = 0 and centre of mass in body x y', 'momenta', vector_goryachev, 1), &
        trajectory_column_t('accelerometer1', 'm/s^2', 'reading of an accelerometer at the centre of mass, body x', &
                            'force', vector_accelerometer, 1), &
        trajectory_column_t('accelerometer2', 'm/s^2', 'reading of an accelerometer at the centre of mass, body y', &
                            'force', vector_accelerometer, 2), &
        trajectory_column_t('accelerometer3', 'm/s^2', 'reading of an accelerometer at the centre of mass, body z', &
                            'force', vector_accelerometer, 3), &
        trajectory_column_t('work', 'J', 'work of all effects since the start', 'energy', vector_work, works + 1, &
                            is_default=.true., needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_damping', 'J', 'work of viscous damping', 'energy', vector_work, work_damping, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_friction', 'J', 'work of dry friction', 'energy', vector_work, work_friction, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_drag', 'J', 'work of the air', 'energy', vector_work, work_drag, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_vibration', 'J', 'work of the moving pivot', 'energy', vector_work, work_vibration, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_torque', 'J', 'work of given torques', 'energy', vector_work, work_torque, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_rotor', 'J', 'work of the drive of the rotor', 'energy', vector_work, work_rotor, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('q0_bound', '', 'upper bound of the error of q0, proved', &
                            proof_group, vector_bounds, proof_of_q0), &
        trajectory_column_t('q1_bound', '', 'upper bound of the error of q1, proved', &
                            proof_group, vector_bounds, proof_of_q1), &
        trajectory_column_t('q2_bound', '', 'upper bound of the error of q2, proved', &
                            proof_group, vector_bounds, proof_of_q2), &
        trajectory_column_t('q3_bound', '', 'upper bound of the error of q3, proved', &
                            proof_group, vector_bounds, proof_of_q3), &
        trajectory_column_t('theta_bound', 'rad', 'upper bound of the error of theta, proved', &
                            proof_group, vector_bounds, proof_of_theta), &
        trajectory_column_t('phi_bound', 'rad', 'upper bound of the error of phi, proved', &
                            proof_group, vector_bounds, proof_of_phi), &
        trajectory_column_t('psi_bound', 'rad', 'upper bound of the error of psi, proved', &
                            proof_group, vector_bounds, proof_of_psi), &
        trajectory_column_t('omega1_bound', 'rad/s', 'upper bound of the error of omega1, proved', &
                            proof_group, vector_bounds, proof_of_omega1), &
        trajectory_column_t('omega2_bound', 'rad/s', 'upper bound of the error of omega2, proved', &
                            proof_group, vector_bounds, proof_of_omega1 + 1), &
        trajectory_column_t('omega3_bound', 'rad/s', 'upper bound of the error of omega3, proved', &
                            proof_group, vector_bounds, proof_of_omega3), &
        trajectory_column_t('orientation_bound', 'rad', &
                            'upper bound of the rotation angle from the true attitude, proved', &
                            proof_group, vector_bounds, proof_of_orientation), &
        trajectory_column_t('proof', '', 'proved, or unproved if a bound of the row is infinite', &
                            proof_group, vector_proof, 1, is_proof=.true.)]

    !> All columns, in the order of the table's documentation. A variable, since flang 19 fails at components of constants.
    type(trajectory_column_t), protected :: trajectory_columns(size(registry)) = registry

contains

    !> Whether the value follows from the attitude, the angular velocity and its rate.
    elemental logical function is_free_of_angles(self)
        class(trajectory_column_t), intent(in) :: self
        is_free_of_angles = any(groups_free_of_angles == self%group)
    end function is_free_of_angles

    !> The name of the quantity: `theta` of the column `theta_deg`.
    elemental character(column_length) function quantity(self)
        class(trajectory_column_t), intent(in) :: self
        quantity = self%name_of_quantity
        if (quantity == '') quantity = self%name
    end function quantity

    !> The columns of a table.
    function trajectory_columns_at(chosen) result(columns)
        type(chosen_column_t), intent(in) :: chosen(:) !! as they were chosen
        type(trajectory_column_t) :: columns(size(chosen))
        columns = trajectory_columns(chosen%place)
        columns%name_of_quantity = columns%name
        columns%name = chosen%name
        columns%unit = chosen%unit
        columns%size = chosen%size
    end function trajectory_columns_at

    !> The value of the column for the current motion.
    real(dp) function value(self, now)
        class(trajectory_column_t), intent(in) :: self
        type(motion_view_t), intent(inout) :: now !! the motion
        real(dp) :: vector(longest)
        call fill_vector(self%vector, now, vector)
        value = vector(self%component)
    end function value

    !> The column of that name that is a quantity of the motion, in its own unit; `found` tells whether there is one.
    subroutine find_trajectory_column(name, column, found)
        character(*), intent(in) :: name !! name of the sought column
        type(trajectory_column_t), intent(out) :: column !! the column; as by default if it was not found
        logical, intent(out) :: found !! whether it was found
        integer :: place
        place = place_of(trajectory_columns, name)
        found = place > 0
        if (found) found = trajectory_columns(place)%group /= proof_group
        if (found) column = trajectory_columns(place)
    end subroutine find_trajectory_column

    !> The components of a vector for the current motion; those that it does not have are left as they were.
    subroutine fill_vector(which, now, vector)
        integer, intent(in) :: which !! number of the vector
        type(motion_view_t), intent(inout) :: now !! the motion
        real(dp), intent(inout) :: vector(longest) !! its components are set
        select case (which)
        case (vector_time)
            vector(1) = now%motion%t
        case (vector_angles)
            vector(:3) = now%motion%angle
        case (vector_rates)
            vector(:3) = now%motion%rate
        case (vector_omega)
            vector(:3) = now%motion%omega
        case (vector_omega_in_space)
            vector(:3) = to_space(now%motion%quaternion, now%motion%omega)
        case (vector_quaternion)
            vector(:4) = now%motion%quaternion
        case (vector_vertical) ! upward, in body axes
            vector(:3) = vertical_from_quaternion(now%motion%quaternion)
        case (vector_axis)
            vector(:3) = to_space(now%motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
        case (vector_centre)
            vector(:3) = to_space(now%motion%quaternion, now%body%centre_of_mass)
        case (vector_energies) ! kinetic, potential, and their sum
            vector(:2) = now%energies()
            vector(3) = sum(vector(:2))
        case (vector_energy_error)
            vector(1) = now%energy_error()
        case (vector_momenta) ! about the vertical, and about body z
            vector(1) = vertical_momentum(now%body, now%motion)
            vector(2) = axial_momentum(now%body, now%motion)
        case (vector_residuals) ! of Euler's equations
            vector(:3) = euler_residuals(now%body, now%motion)
        case (vector_changes) ! of the vertical momentum and of the energy
            vector(:2) = [now%momentum_change(), now%energy_change()]
        case (vector_force)
            vector(:3) = now%force()
        case (vector_force_beside_axis)
            call fill_force_beside_axis(now, vector)
        case (vector_errors)
            call fill_errors(now, vector)
        case (vector_inherent_error)
            vector(1) = now%inherent_error()
        case (vector_norm_error)
            vector(1) = now%motion%norm_error
        case (vector_axis_z_rate)
            vector(1) = axis_height_rate(now%motion)
        case (vector_kovalevskaya)
            vector(1) = kovalevskaya_integral(now%body, now%motion)
        case (vector_goryachev)
            vector(1) = goryachev_integral(now%body, now%motion)
        case (vector_accelerometer) ! at the centre of mass, in body axes
            vector(:3) = specific_force(now%body, now%motion)
        case (vector_work) ! the parts, and their sum
            vector(:works) = now%work
            vector(works + 1) = sum(now%work)
        case (vector_bounds) ! one for each quantity (spintop_certificate)
            vector(:proof_count) = now%proof%bounds
        case (vector_proof) ! 1 where all bounds of the row are proved
            vector(1) = merge(1, 0, now%proof%is_proved())
        end select
    end subroutine fill_vector

    !> The force along (sin phi, -cos phi, 0), and along the line of nodes (cos phi, sin phi, 0).
    subroutine fill_force_beside_axis(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        real(dp) :: force(3)
        force = now%force()
        associate (phi => now%motion%angle(1))
            vector(1) = force(1) * sin(phi) - force(2) * cos(phi)
            vector(2) = force(1) * cos(phi) + force(2) * sin(phi)
        end associate
    end subroutine fill_force_beside_axis

    !> The errors of the attitude, and of the axis tip.
    subroutine fill_errors(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        type(motion_t) :: exact
        exact = now%exact()
        vector(1) = rotation_angle(exact%quaternion, now%computed%quaternion)
        vector(2) = norm2(axis_tip(now%turned_body, now%computed) - axis_tip(now%turned_body, exact))
    end subroutine fill_errors

end module spintop_trajectory_columns
