!> The columns of a trajectory table: a line of the registry and a procedure each. The help, the choice of
!> columns, the units in the header and the rows derive from it.
module spintop_trajectory_columns
    use spintop_accelerometer_columns, only: accelerometer_columns
    use spintop_attitude, only: rotation_angle, to_space, vertical_from_quaternion
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_motion_view, only: motion_view_t
    use spintop_quantities, only: axial_momentum, axis_height_rate, axis_tip, goryachev_integral, kovalevskaya_integral, &
        vertical_momentum
    use spintop_proof_columns, only: proof_columns
    use spintop_study_column, only: place_of, proof_group
    use spintop_trajectory_column, only: angle_group, trajectory_column_t
    use spintop_work_columns, only: work_columns
    implicit none
    private
    public :: trajectory_column_t, trajectory_columns, find_trajectory_column

contains

    !> All columns, in the order of the table's documentation.
    function trajectory_columns() result(columns)
        type(trajectory_column_t), allocatable :: columns(:)
        columns = [ &
            trajectory_column_t('t', 's', 'time', angle_group, value_of_t, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('phi', 'rad', 'precession angle, continuous', angle_group, value_of_phi, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('theta', 'rad', 'inclination of body z to the vertical', angle_group, value_of_theta, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('psi', 'rad', 'spin angle, continuous', angle_group, value_of_psi, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('phi_rate', 'rad/s', 'precession rate', angle_group, value_of_phi_rate, &
                                is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
            trajectory_column_t('theta_rate', 'rad/s', 'nutation rate', angle_group, value_of_theta_rate, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('psi_rate', 'rad/s', 'spin rate', angle_group, value_of_psi_rate, &
                                is_default=.true., varies_near_poles=.true., ends_at_poles=.true.), &
            trajectory_column_t('omega1', 'rad/s', 'angular velocity about body x', 'rates', value_of_omega1), &
            trajectory_column_t('omega2', 'rad/s', 'angular velocity about body y', 'rates', value_of_omega2), &
            trajectory_column_t('omega3', 'rad/s', 'angular velocity about body z', 'rates', value_of_omega3), &
            trajectory_column_t('q0', '', 'attitude quaternion, scalar part', 'attitude', value_of_q0), &
            trajectory_column_t('q1', '', 'attitude quaternion, x', 'attitude', value_of_q1), &
            trajectory_column_t('q2', '', 'attitude quaternion, y', 'attitude', value_of_q2), &
            trajectory_column_t('q3', '', 'attitude quaternion, z', 'attitude', value_of_q3), &
            trajectory_column_t('gamma1', '', 'upward vertical in body axes, x', 'attitude', value_of_gamma1), &
            trajectory_column_t('gamma2', '', 'upward vertical in body axes, y', 'attitude', value_of_gamma2), &
            trajectory_column_t('gamma3', '', 'upward vertical in body axes, z', 'attitude', value_of_gamma3), &
            trajectory_column_t('axis_x', '', 'body z in space axes, x', 'attitude', value_of_axis_x), &
            trajectory_column_t('axis_y', '', 'body z in space axes, y', 'attitude', value_of_axis_y), &
            trajectory_column_t('axis_z', '', 'body z in space axes, z', 'attitude', value_of_axis_z), &
            trajectory_column_t('com_x', 'm', 'centre of mass in space axes, x', 'attitude', value_of_com_x, &
                                is_default=.true.), &
            trajectory_column_t('com_y', 'm', 'centre of mass in space axes, y', 'attitude', value_of_com_y, &
                                is_default=.true.), &
            trajectory_column_t('com_z', 'm', 'centre of mass in space axes, z (height above the pivot)', &
                                'attitude', value_of_com_z, is_default=.true.), &
            trajectory_column_t('kinetic', 'J', 'kinetic energy', 'energy', value_of_kinetic, is_default=.true.), &
            trajectory_column_t('potential', 'J', 'potential energy above the height of the pivot, with -O.IO/2 - O.h &
                                &where the Earth turns (O its rate, h of a rotor)', &
                                'energy', value_of_potential, is_default=.true.), &
            trajectory_column_t('energy', 'J', 'total energy', 'energy', value_of_energy, is_default=.true.), &
            trajectory_column_t('energy_error', '', &
                                'change of energy since the start over (kinetic at start + m g |r|)', &
                                'energy', value_of_energy_error, needs_work=.true.), &
            trajectory_column_t('lz', 'J s', 'angular momentum about the vertical', 'momenta', value_of_lz), &
            trajectory_column_t('l3', 'J s', 'angular momentum about body z', 'momenta', value_of_l3), &
            trajectory_column_t('R1', 'N m', "residual of Euler's first equation (Eq 51)", &
                                'residuals', value_of_R1, is_default=.true.), &
            trajectory_column_t('R2', 'N m', "residual of Euler's second equation (Eq 51)", &
                                'residuals', value_of_R2, is_default=.true.), &
            trajectory_column_t('R3', 'J s', 'change of Lz since the start (Eq 51)', 'residuals', value_of_R3, &
                                is_default=.true.), &
            trajectory_column_t('R4', 'J', 'change of energy since the start (Eq 51)', 'residuals', value_of_R4, &
                                is_default=.true.), &
            trajectory_column_t('force_x', 'N', 'support force on the body, x', 'force', value_of_force_x, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('force_y', 'N', 'support force on the body, y', 'force', value_of_force_y, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('force_z', 'N', 'support force on the body, z', 'force', value_of_force_z, &
                                is_default=.true., varies_near_poles=.true.), &
            trajectory_column_t('force_r', 'N', 'support force away from the vertical, in the plane of the axis', &
                                'force', value_of_force_r, varies_near_poles=.true.), &
            trajectory_column_t('force_n', 'N', 'support force along the line of nodes', &
                                'force', value_of_force_n, varies_near_poles=.true.), &
            trajectory_column_t('orientation_error', 'rad', 'rotation angle from the exact attitude', &
                                'errors', value_of_orientation_error, is_default=.true., needs_exact_motion=.true.), &
            trajectory_column_t('tip_error', '', 'distance of the axis tip from the exact one', &
                                'errors', value_of_tip_error, needs_exact_motion=.true.), &
            trajectory_column_t('inherent_error', 'rad', 'error of the attitude due to rounding of the data', &
                                'errors', value_of_inherent_error, is_default=.true., needs_exact_motion=.true.), &
            trajectory_column_t('norm_error', '', 'norm error abs(q) - 1 of the computed quaternion', &
                                'errors', value_of_norm_error), &
            trajectory_column_t('axis_z_rate', '1/s', 'rate of axis_z, zero at the turning points of theta', &
                                'attitude', value_of_axis_z_rate), &
            trajectory_column_t('kovalevskaya', '1/s^4', 'Kovalevskaya integral; constant for I1 = I2 = 2 I3 and ' // &
                                'centre of mass in body x y', 'momenta', value_of_kovalevskaya), &
            trajectory_column_t('goryachev', '1/s^3', 'integral of Goryachev and Chaplygin; constant for I1 = I2 = 4 I3, ' // &
                                'Lz = 0 and centre of mass in body x y', 'momenta', value_of_goryachev), &
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

    real(dp) function value_of_t(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%t
    end function value_of_t

    real(dp) function value_of_phi(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%angle(1)
    end function value_of_phi

    real(dp) function value_of_theta(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%angle(2)
    end function value_of_theta

    real(dp) function value_of_psi(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%angle(3)
    end function value_of_psi

    real(dp) function value_of_phi_rate(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%rate(1)
    end function value_of_phi_rate

    real(dp) function value_of_theta_rate(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%rate(2)
    end function value_of_theta_rate

    real(dp) function value_of_psi_rate(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%rate(3)
    end function value_of_psi_rate

    real(dp) function value_of_omega1(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%omega(1)
    end function value_of_omega1

    real(dp) function value_of_omega2(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%omega(2)
    end function value_of_omega2

    real(dp) function value_of_omega3(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%omega(3)
    end function value_of_omega3

    real(dp) function value_of_q0(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%quaternion(1)
    end function value_of_q0

    real(dp) function value_of_q1(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%quaternion(2)
    end function value_of_q1

    real(dp) function value_of_q2(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%quaternion(3)
    end function value_of_q2

    real(dp) function value_of_q3(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%quaternion(4)
    end function value_of_q3

    real(dp) function value_of_gamma1(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = vertical_from_quaternion(now%motion%quaternion)
        value = vector(1)
    end function value_of_gamma1

    real(dp) function value_of_gamma2(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = vertical_from_quaternion(now%motion%quaternion)
        value = vector(2)
    end function value_of_gamma2

    real(dp) function value_of_gamma3(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = vertical_from_quaternion(now%motion%quaternion)
        value = vector(3)
    end function value_of_gamma3

    real(dp) function value_of_axis_x(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = to_space(now%motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
        value = vector(1)
    end function value_of_axis_x

    real(dp) function value_of_axis_y(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = to_space(now%motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
        value = vector(2)
    end function value_of_axis_y

    real(dp) function value_of_axis_z(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = to_space(now%motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
        value = vector(3)
    end function value_of_axis_z

    real(dp) function value_of_com_x(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%centre()
        value = vector(1)
    end function value_of_com_x

    real(dp) function value_of_com_y(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%centre()
        value = vector(2)
    end function value_of_com_y

    real(dp) function value_of_com_z(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%centre()
        value = vector(3)
    end function value_of_com_z

    real(dp) function value_of_kinetic(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: energies(2)
        energies = now%energies()
        value = energies(1)
    end function value_of_kinetic

    real(dp) function value_of_potential(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: energies(2)
        energies = now%energies()
        value = energies(2)
    end function value_of_potential

    real(dp) function value_of_energy(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = sum(now%energies())
    end function value_of_energy

    real(dp) function value_of_energy_error(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%energy_error()
    end function value_of_energy_error

    real(dp) function value_of_lz(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = vertical_momentum(now%body, now%motion)
    end function value_of_lz

    real(dp) function value_of_l3(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = axial_momentum(now%body, now%motion)
    end function value_of_l3

    real(dp) function value_of_R1(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%residuals()
        value = vector(1)
    end function value_of_R1

    real(dp) function value_of_R2(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%residuals()
        value = vector(2)
    end function value_of_R2

    real(dp) function value_of_R3(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%momentum_change()
    end function value_of_R3

    real(dp) function value_of_R4(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%energy_change()
    end function value_of_R4

    real(dp) function value_of_force_x(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%force()
        value = vector(1)
    end function value_of_force_x

    real(dp) function value_of_force_y(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%force()
        value = vector(2)
    end function value_of_force_y

    real(dp) function value_of_force_z(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: vector(3)
        vector = now%force()
        value = vector(3)
    end function value_of_force_z

    !> Along (sin phi, -cos phi, 0).
    real(dp) function value_of_force_r(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: force(3)
        force = now%force()
        associate (phi => now%motion%angle(1))
            value = force(1) * sin(phi) - force(2) * cos(phi)
        end associate
    end function value_of_force_r

    !> Along the line of nodes (cos phi, sin phi, 0).
    real(dp) function value_of_force_n(now) result(value)
        type(motion_view_t), intent(inout) :: now
        real(dp) :: force(3)
        force = now%force()
        associate (phi => now%motion%angle(1))
            value = force(1) * cos(phi) + force(2) * sin(phi)
        end associate
    end function value_of_force_n

    real(dp) function value_of_orientation_error(now) result(value)
        type(motion_view_t), intent(inout) :: now
        type(motion_t) :: exact
        exact = now%exact()
        value = rotation_angle(exact%quaternion, now%computed%quaternion)
    end function value_of_orientation_error

    real(dp) function value_of_tip_error(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = norm2(axis_tip(now%turned_body, now%computed) - axis_tip(now%turned_body, now%exact()))
    end function value_of_tip_error

    real(dp) function value_of_inherent_error(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%inherent_error()
    end function value_of_inherent_error

    real(dp) function value_of_norm_error(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = now%motion%norm_error
    end function value_of_norm_error

    real(dp) function value_of_axis_z_rate(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = axis_height_rate(now%motion)
    end function value_of_axis_z_rate

    real(dp) function value_of_kovalevskaya(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = kovalevskaya_integral(now%body, now%motion)
    end function value_of_kovalevskaya

    real(dp) function value_of_goryachev(now) result(value)
        type(motion_view_t), intent(inout) :: now
        value = goryachev_integral(now%body, now%motion)
    end function value_of_goryachev

end module spintop_trajectory_columns
