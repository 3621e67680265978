!> The columns of a trajectory table: a line of the registry each, with the vector of which the column is a component. The
!> help, the choice of columns, the units in the header and the rows derive from it.
module spintop_trajectory_columns
    use spintop_certificate, only: proof_of_orientation, proof_of_phi, proof_of_psi, proof_of_q0, proof_of_q1, proof_of_q2, &
        proof_of_q3, proof_of_theta
    use spintop_kinds, only: dp
    use spintop_loads, only: work_damping, work_drag, work_friction, work_rotor, work_torque, work_vibration, works
    use spintop_motion_view, only: motion_view_t
    use spintop_stop_lanes, only: passing_centre_height, passing_energy, passing_kinetic_energy, passing_nothing, &
        passing_omega, passing_phi, passing_potential_energy, passing_psi, passing_spin_momentum, passing_theta, &
        passing_turning, passing_vertical, passing_vertical_momentum
    use spintop_study_column, only: place_of, proof_group, study_column_t
    use spintop_trajectory_vectors, only: &
        longest, put_vector, of_accelerometer, of_angles, of_axis, of_axis_z_rate, of_bounds, of_centre, of_changes, &
        of_energies, of_energy_error, of_errors, of_force, of_force_beside_axis, of_goryachev, of_inherent_error, &
        of_kovalevskaya, of_momenta, of_norm_error, of_omega, of_proof, of_quaternion, of_rates, of_residuals, of_time, &
        of_vertical, of_work
    implicit none
    private
    public :: trajectory_column_t, trajectory_columns, find_trajectory_column, angle_group

    !> The group of the columns of the time, the angles and their rates, which need nothing else of a motion.
    character(*), parameter :: angle_group = 'angles'
    !> Groups of columns that need no angles nor their rates.
    character(*), parameter :: groups_free_of_angles(*) = [character(8) :: 'rates', 'attitude', 'energy', 'momenta']

    !> A column of a trajectory.
    type, extends(study_column_t) :: trajectory_column_t
        !> The number of a vector (`of_...`), and the component of it that is the value of the column.
        integer :: vector = 0, component = 1
        !> What passes a value of the column in a polynomial of each step, if anything does (spintop_stop_lanes).
        integer :: passing = passing_nothing
        !> It is in the table when the input names no columns.
        logical :: is_default = .false.
        !> It compares with the exact motion.
        logical :: needs_exact_motion = .false.
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
    contains
        procedure :: is_free_of_angles
        procedure :: value
    end type trajectory_column_t

    !> All columns, in the order of the table's documentation.
    type(trajectory_column_t), parameter :: trajectory_columns(*) = [ &
        trajectory_column_t('t', 's', 'time', angle_group, of_time, 1, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('phi', 'rad', 'precession angle, continuous', angle_group, of_angles, 1, passing_phi, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('theta', 'rad', 'inclination of body z to the vertical', angle_group, of_angles, 2, passing_theta, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('psi', 'rad', 'spin angle, continuous', angle_group, of_angles, 3, passing_psi, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('phi_rate', 'rad/s', 'precession rate', angle_group, of_rates, 1, &
                            is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
        trajectory_column_t('theta_rate', 'rad/s', 'nutation rate', angle_group, of_rates, 2, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('psi_rate', 'rad/s', 'spin rate', angle_group, of_rates, 3, &
                            is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
        trajectory_column_t('omega1', 'rad/s', 'angular velocity about body x', 'rates', of_omega, 1, passing_omega), &
        trajectory_column_t('omega2', 'rad/s', 'angular velocity about body y', 'rates', of_omega, 2, passing_omega), &
        trajectory_column_t('omega3', 'rad/s', 'angular velocity about body z', 'rates', of_omega, 3, passing_omega), &
        trajectory_column_t('q0', '', 'attitude quaternion, scalar part', 'attitude', of_quaternion, 1), &
        trajectory_column_t('q1', '', 'attitude quaternion, x', 'attitude', of_quaternion, 2), &
        trajectory_column_t('q2', '', 'attitude quaternion, y', 'attitude', of_quaternion, 3), &
        trajectory_column_t('q3', '', 'attitude quaternion, z', 'attitude', of_quaternion, 4), &
        trajectory_column_t('gamma1', '', 'upward vertical in body axes, x', 'attitude', of_vertical, 1, passing_vertical), &
        trajectory_column_t('gamma2', '', 'upward vertical in body axes, y', 'attitude', of_vertical, 2, passing_vertical), &
        trajectory_column_t('gamma3', '', 'upward vertical in body axes, z', 'attitude', of_vertical, 3, passing_vertical), &
        trajectory_column_t('axis_x', '', 'body z in space axes, x', 'attitude', of_axis, 1), &
        trajectory_column_t('axis_y', '', 'body z in space axes, y', 'attitude', of_axis, 2), &
        trajectory_column_t('axis_z', '', 'body z in space axes, z', 'attitude', of_axis, 3, passing_vertical), &
        trajectory_column_t('com_x', 'm', 'centre of mass in space axes, x', 'attitude', of_centre, 1, &
                            is_default=.true.), &
        trajectory_column_t('com_y', 'm', 'centre of mass in space axes, y', 'attitude', of_centre, 2, &
                            is_default=.true.), &
        trajectory_column_t('com_z', 'm', 'centre of mass in space axes, z (height above the pivot)', &
                            'attitude', of_centre, 3, passing_centre_height, is_default=.true.), &
        trajectory_column_t('kinetic', 'J', 'kinetic energy', 'energy', of_energies, 1, passing_kinetic_energy, &
                            is_default=.true.), &
        trajectory_column_t('potential', 'J', 'potential energy above the height of the pivot, with -O.IO/2 - O.h &
                            &where the Earth turns (O its rate, h of a rotor)', &
                            'energy', of_energies, 2, passing_potential_energy, is_default=.true.), &
        trajectory_column_t('energy', 'J', 'total energy', 'energy', of_energies, 3, passing_energy, is_default=.true.), &
        trajectory_column_t('energy_error', '', &
                            'change of energy since the start over (kinetic at start + m g |r|)', &
                            'energy', of_energy_error, 1, needs_work=.true.), &
        trajectory_column_t('lz', 'J s', 'angular momentum about the vertical', 'momenta', of_momenta, 1, &
                            passing_vertical_momentum), &
        trajectory_column_t('l3', 'J s', 'angular momentum about body z', 'momenta', of_momenta, 2, passing_spin_momentum), &
        trajectory_column_t('R1', 'N m', "residual of Euler's first equation (Eq 51)", &
                            'residuals', of_residuals, 1, is_default=.true.), &
        trajectory_column_t('R2', 'N m', "residual of Euler's second equation (Eq 51)", &
                            'residuals', of_residuals, 2, is_default=.true.), &
        trajectory_column_t('R3', 'J s', 'change of Lz since the start (Eq 51)', 'residuals', of_changes, 1, &
                            is_default=.true.), &
        trajectory_column_t('R4', 'J', 'change of energy since the start (Eq 51)', 'residuals', of_changes, 2, &
                            is_default=.true.), &
        trajectory_column_t('force_x', 'N', 'support force on the body, x', 'force', of_force, 1, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('force_y', 'N', 'support force on the body, y', 'force', of_force, 2, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('force_z', 'N', 'support force on the body, z', 'force', of_force, 3, &
                            is_default=.true., varies_near_poles=.true.), &
        trajectory_column_t('force_r', 'N', 'support force away from the vertical, in the plane of the axis', &
                            'force', of_force_beside_axis, 1, varies_near_poles=.true.), &
        trajectory_column_t('force_n', 'N', 'support force along the line of nodes', &
                            'force', of_force_beside_axis, 2, varies_near_poles=.true.), &
        trajectory_column_t('orientation_error', 'rad', 'rotation angle from the exact attitude', &
                            'errors', of_errors, 1, is_default=.true., needs_exact_motion=.true.), &
        trajectory_column_t('tip_error', '', 'distance of the axis tip from the exact one', &
                            'errors', of_errors, 2, needs_exact_motion=.true.), &
        trajectory_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
                            'errors', of_inherent_error, 1, is_default=.true., needs_exact_motion=.true.), &
        trajectory_column_t('norm_error', '', 'norm error abs(q) - 1 of the computed quaternion', &
                            'errors', of_norm_error, 1), &
        trajectory_column_t('axis_z_rate', '1/s', 'rate of axis_z, zero at the turning points of theta', &
                            'attitude', of_axis_z_rate, 1, passing_turning), &
        trajectory_column_t('kovalevskaya', '1/s^4', 'Kovalevskaya integral; constant for I1 = I2 = 2 I3 and ' // &
                            'centre of mass in body x y', 'momenta', of_kovalevskaya, 1), &
        trajectory_column_t('goryachev', '1/s^3', 'integral of Goryachev and Chaplygin; constant for I1 = I2 = 4 I3, ' // &
                            'Lz = 0 and centre of mass in body x y', 'momenta', of_goryachev, 1), &
        trajectory_column_t('accelerometer1', 'm/s^2', 'reading of an accelerometer at the centre of mass, body x', &
                            'force', of_accelerometer, 1), &
        trajectory_column_t('accelerometer2', 'm/s^2', 'reading of an accelerometer at the centre of mass, body y', &
                            'force', of_accelerometer, 2), &
        trajectory_column_t('accelerometer3', 'm/s^2', 'reading of an accelerometer at the centre of mass, body z', &
                            'force', of_accelerometer, 3), &
        trajectory_column_t('work', 'J', 'work of all effects since the start', 'energy', of_work, works + 1, &
                            is_default=.true., needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_damping', 'J', 'work of viscous damping', 'energy', of_work, work_damping, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_friction', 'J', 'work of dry friction', 'energy', of_work, work_friction, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_drag', 'J', 'work of the air', 'energy', of_work, work_drag, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_vibration', 'J', 'work of the moving pivot', 'energy', of_work, work_vibration, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_torque', 'J', 'work of given torques', 'energy', of_work, work_torque, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('work_rotor', 'J', 'work of the drive of the rotor', 'energy', of_work, work_rotor, &
                            needs_effects=.true., needs_work=.true.), &
        trajectory_column_t('q0_bound', '', 'upper bound of the error of q0, proved', &
                            proof_group, of_bounds, proof_of_q0), &
        trajectory_column_t('q1_bound', '', 'upper bound of the error of q1, proved', &
                            proof_group, of_bounds, proof_of_q1), &
        trajectory_column_t('q2_bound', '', 'upper bound of the error of q2, proved', &
                            proof_group, of_bounds, proof_of_q2), &
        trajectory_column_t('q3_bound', '', 'upper bound of the error of q3, proved', &
                            proof_group, of_bounds, proof_of_q3), &
        trajectory_column_t('theta_bound', 'rad', 'upper bound of the error of theta, proved', &
                            proof_group, of_bounds, proof_of_theta), &
        trajectory_column_t('phi_bound', 'rad', 'upper bound of the error of phi, proved', &
                            proof_group, of_bounds, proof_of_phi), &
        trajectory_column_t('psi_bound', 'rad', 'upper bound of the error of psi, proved', &
                            proof_group, of_bounds, proof_of_psi), &
        trajectory_column_t('orientation_bound', 'rad', &
                            'upper bound of the rotation angle from the true attitude, proved', &
                            proof_group, of_bounds, proof_of_orientation), &
        trajectory_column_t('proof', '', 'proved, or unproved if a bound of the row is infinite', &
                            proof_group, of_proof, 1, is_proof=.true.)]

contains

    !> Whether the value follows from the attitude, the angular velocity and its rate.
    elemental logical function is_free_of_angles(self)
        class(trajectory_column_t), intent(in) :: self
        is_free_of_angles = any(groups_free_of_angles == self%group)
    end function is_free_of_angles

    !> The value of the column for the motion that is looked at.
    real(dp) function value(self, now)
        class(trajectory_column_t), intent(in) :: self
        type(motion_view_t), intent(inout) :: now !! the motion
        real(dp) :: vector(longest)
        call put_vector(self%vector, now, vector)
        value = vector(self%component)
    end function value

    !> The column of that name that is a quantity of the motion; `found` tells whether there is one.
    subroutine find_trajectory_column(name, column, found)
        character(*), intent(in) :: name !! its name
        type(trajectory_column_t), intent(out) :: column !! column
        logical, intent(out) :: found !! whether it was found
        integer :: place
        place = place_of(trajectory_columns, name)
        found = place > 0
        if (found) found = trajectory_columns(place)%group /= proof_group
        if (found) column = trajectory_columns(place)
    end subroutine find_trajectory_column

end module spintop_trajectory_columns
