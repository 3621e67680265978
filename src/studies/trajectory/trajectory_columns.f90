!> The columns of a trajectory table: a line of the registry each, with a procedure that gives a vector, of which the column is
!> a component. The help, the choice of columns, the units in the header and the rows derive from it.
module spintop_trajectory_columns
    use spintop_accelerometer_columns, only: accelerometer_columns
    use spintop_attitude, only: rotation_angle, to_space, vertical_from_quaternion
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_motion_view, only: motion_view_t
    use spintop_quantities, only: axial_momentum, axis_height_rate, axis_tip, goryachev_integral, kovalevskaya_integral, &
        vertical_momentum
    use spintop_proof_columns, only: proof_columns
    use spintop_stop_lanes, only: of_centre_height, of_energy, of_kinetic_energy, of_omega, of_phi, of_potential_energy, &
        of_psi, of_spin_momentum, of_theta, of_turning, of_vertical, of_vertical_momentum
    use spintop_study_column, only: place_of, proof_group
    use spintop_trajectory_column, only: angle_group, longest, trajectory_column_t
    use spintop_work_columns, only: work_columns
    implicit none
    private
    public :: trajectory_column_t, trajectory_columns, find_trajectory_column

contains

    !> All columns, in the order of the table's documentation.
    function trajectory_columns() result(columns)
        type(trajectory_column_t), allocatable :: columns(:)
        columns = [ &
            trajectory_column_t('t', 's', 'time', angle_group, put_time, 1, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('phi', 'rad', 'precession angle, continuous', angle_group, put_angles, 1, of_phi, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('theta', 'rad', 'inclination of body z to the vertical', angle_group, put_angles, 2, of_theta, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('psi', 'rad', 'spin angle, continuous', angle_group, put_angles, 3, of_psi, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('phi_rate', 'rad/s', 'precession rate', angle_group, put_rates, 1, &
                                is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
            trajectory_column_t('theta_rate', 'rad/s', 'nutation rate', angle_group, put_rates, 2, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('psi_rate', 'rad/s', 'spin rate', angle_group, put_rates, 3, &
                                is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
            trajectory_column_t('omega1', 'rad/s', 'angular velocity about body x', 'rates', put_omega, 1, of_omega), &
            trajectory_column_t('omega2', 'rad/s', 'angular velocity about body y', 'rates', put_omega, 2, of_omega), &
            trajectory_column_t('omega3', 'rad/s', 'angular velocity about body z', 'rates', put_omega, 3, of_omega), &
            trajectory_column_t('q0', '', 'attitude quaternion, scalar part', 'attitude', put_quaternion, 1), &
            trajectory_column_t('q1', '', 'attitude quaternion, x', 'attitude', put_quaternion, 2), &
            trajectory_column_t('q2', '', 'attitude quaternion, y', 'attitude', put_quaternion, 3), &
            trajectory_column_t('q3', '', 'attitude quaternion, z', 'attitude', put_quaternion, 4), &
            trajectory_column_t('gamma1', '', 'upward vertical in body axes, x', 'attitude', put_vertical, 1, of_vertical), &
            trajectory_column_t('gamma2', '', 'upward vertical in body axes, y', 'attitude', put_vertical, 2, of_vertical), &
            trajectory_column_t('gamma3', '', 'upward vertical in body axes, z', 'attitude', put_vertical, 3, of_vertical), &
            trajectory_column_t('axis_x', '', 'body z in space axes, x', 'attitude', put_axis, 1), &
            trajectory_column_t('axis_y', '', 'body z in space axes, y', 'attitude', put_axis, 2), &
            trajectory_column_t('axis_z', '', 'body z in space axes, z', 'attitude', put_axis, 3, of_vertical), &
            trajectory_column_t('com_x', 'm', 'centre of mass in space axes, x', 'attitude', put_centre, 1, &
                                is_default=.true.), &
            trajectory_column_t('com_y', 'm', 'centre of mass in space axes, y', 'attitude', put_centre, 2, &
                                is_default=.true.), &
            trajectory_column_t('com_z', 'm', 'centre of mass in space axes, z (height above the pivot)', &
                                'attitude', put_centre, 3, of_centre_height, is_default=.true.), &
            trajectory_column_t('kinetic', 'J', 'kinetic energy', &
                                'energy', put_energies, 1, of_kinetic_energy, is_default=.true.), &
            trajectory_column_t('potential', 'J', 'potential energy above the height of the pivot, with -O.IO/2 - O.h &
                                &where the Earth turns (O its rate, h of a rotor)', &
                                'energy', put_energies, 2, of_potential_energy, is_default=.true.), &
            trajectory_column_t('energy', 'J', 'total energy', 'energy', put_energies, 3, of_energy, is_default=.true.), &
            trajectory_column_t('energy_error', '', &
                                'change of energy since the start over (kinetic at start + m g |r|)', &
                                'energy', put_energy_error, 1, needs_work=.true.), &
            trajectory_column_t('lz', 'J s', 'angular momentum about the vertical', &
                                'momenta', put_momenta, 1, of_vertical_momentum), &
            trajectory_column_t('l3', 'J s', 'angular momentum about body z', 'momenta', put_momenta, 2, of_spin_momentum), &
            trajectory_column_t('R1', 'N m', "residual of Euler's first equation (Eq 51)", &
                                'residuals', put_residuals, 1, is_default=.true.), &
            trajectory_column_t('R2', 'N m', "residual of Euler's second equation (Eq 51)", &
                                'residuals', put_residuals, 2, is_default=.true.), &
            trajectory_column_t('R3', 'J s', 'change of Lz since the start (Eq 51)', 'residuals', put_changes, 1, &
                                is_default=.true.), &
            trajectory_column_t('R4', 'J', 'change of energy since the start (Eq 51)', 'residuals', put_changes, 2, &
                                is_default=.true.), &
            trajectory_column_t('force_x', 'N', 'support force on the body, x', 'force', put_force, 1, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('force_y', 'N', 'support force on the body, y', 'force', put_force, 2, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('force_z', 'N', 'support force on the body, z', 'force', put_force, 3, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('force_r', 'N', 'support force away from the vertical, in the plane of the axis', &
                                'force', put_force_beside_axis, 1, varies_near_poles=.true.), &
            trajectory_column_t('force_n', 'N', 'support force along the line of nodes', &
                                'force', put_force_beside_axis, 2, varies_near_poles=.true.), &
            trajectory_column_t('orientation_error', 'rad', 'rotation angle from the exact attitude', &
                                'errors', put_errors, 1, is_default=.true., needs_exact_motion=.true.), &
            trajectory_column_t('tip_error', '', 'distance of the axis tip from the exact one', &
                                'errors', put_errors, 2, needs_exact_motion=.true.), &
            trajectory_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
                                'errors', put_inherent_error, 1, is_default=.true., needs_exact_motion=.true.), &
            trajectory_column_t('norm_error', '', 'norm error abs(q) - 1 of the computed quaternion', &
                                'errors', put_norm_error, 1), &
            trajectory_column_t('axis_z_rate', '1/s', 'rate of axis_z, zero at the turning points of theta', &
                                'attitude', put_axis_z_rate, 1, of_turning), &
            trajectory_column_t('kovalevskaya', '1/s^4', 'Kovalevskaya integral; constant for I1 = I2 = 2 I3 and ' // &
                                'centre of mass in body x y', 'momenta', put_kovalevskaya, 1), &
            trajectory_column_t('goryachev', '1/s^3', 'integral of Goryachev and Chaplygin; constant for I1 = I2 = 4 I3, ' // &
                                'Lz = 0 and centre of mass in body x y', 'momenta', put_goryachev, 1), &
            accelerometer_columns(), work_columns(), proof_columns()]
    end function trajectory_columns

    !> The column of that name that is a quantity of the motion; `found` tells whether there is one.
    subroutine find_trajectory_column(name, column, found)
        character(*), intent(in) :: name !! its name
        type(trajectory_column_t), intent(out) :: column !! column
        logical, intent(out) :: found !! whether it was found
        type(trajectory_column_t), allocatable :: columns(:)
        integer :: place
        allocate (columns, source=trajectory_columns())
        place = place_of(columns, name)
        found = place > 0
        if (found) found = columns(place)%group /= proof_group
        if (found) column = columns(place)
    end subroutine find_trajectory_column

    subroutine put_time(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = now%motion%t
    end subroutine put_time

    subroutine put_angles(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = now%motion%angle
    end subroutine put_angles

    subroutine put_rates(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = now%motion%rate
    end subroutine put_rates

    subroutine put_omega(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = now%motion%omega
    end subroutine put_omega

    subroutine put_quaternion(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:4) = now%motion%quaternion
    end subroutine put_quaternion

    !> The upward vertical in body axes.
    subroutine put_vertical(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = vertical_from_quaternion(now%motion%quaternion)
    end subroutine put_vertical

    subroutine put_axis(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = to_space(now%motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
    end subroutine put_axis

    subroutine put_centre(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = now%centre()
    end subroutine put_centre

    !> Kinetic, potential, and their sum.
    subroutine put_energies(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:2) = now%energies()
        vector(3) = sum(vector(:2))
    end subroutine put_energies

    subroutine put_energy_error(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = now%energy_error()
    end subroutine put_energy_error

    !> About the vertical, and about body z.
    subroutine put_momenta(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = vertical_momentum(now%body, now%motion)
        vector(2) = axial_momentum(now%body, now%motion)
    end subroutine put_momenta

    !> The first of them are those of Euler's equations.
    subroutine put_residuals(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = now%residuals()
    end subroutine put_residuals

    !> Of the vertical momentum and of the energy.
    subroutine put_changes(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:2) = [now%momentum_change(), now%energy_change()]
    end subroutine put_changes

    subroutine put_force(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(:3) = now%force()
    end subroutine put_force

    !> Along (sin phi, -cos phi, 0), and along the line of nodes (cos phi, sin phi, 0).
    subroutine put_force_beside_axis(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        real(dp) :: force(3)
        force = now%force()
        associate (phi => now%motion%angle(1))
            vector(1) = force(1) * sin(phi) - force(2) * cos(phi)
            vector(2) = force(1) * cos(phi) + force(2) * sin(phi)
        end associate
    end subroutine put_force_beside_axis

    !> Of the attitude, and of the axis tip.
    subroutine put_errors(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        type(motion_t) :: exact
        exact = now%exact()
        vector(1) = rotation_angle(exact%quaternion, now%computed%quaternion)
        vector(2) = norm2(axis_tip(now%turned_body, now%computed) - axis_tip(now%turned_body, exact))
    end subroutine put_errors

    subroutine put_inherent_error(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = now%inherent_error()
    end subroutine put_inherent_error

    subroutine put_norm_error(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = now%motion%norm_error
    end subroutine put_norm_error

    subroutine put_axis_z_rate(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = axis_height_rate(now%motion)
    end subroutine put_axis_z_rate

    subroutine put_kovalevskaya(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = kovalevskaya_integral(now%body, now%motion)
    end subroutine put_kovalevskaya

    subroutine put_goryachev(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        vector(1) = goryachev_integral(now%body, now%motion)
    end subroutine put_goryachev

end module spintop_trajectory_columns
