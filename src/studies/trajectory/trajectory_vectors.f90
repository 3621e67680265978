!> The vectors of a motion of which the columns of a trajectory are components. A scalar is a vector with one component.
module spintop_trajectory_vectors
    use spintop_attitude, only: rotation_angle, to_space, vertical_from_quaternion
    use spintop_certificate, only: proof_count
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    use spintop_motion, only: motion_t
    use spintop_motion_view, only: motion_view_t
    use spintop_quantities, only: axial_momentum, axis_height_rate, axis_tip, euler_residuals, goryachev_integral, &
        kovalevskaya_integral, specific_force, vertical_momentum
    implicit none
    private
    public :: put_vector, longest, vectors
    public :: of_accelerometer, of_angles, of_axis, of_axis_z_rate, of_bounds, of_centre, of_changes, of_energies, &
        of_energy_error, of_errors, of_force, of_force_beside_axis, of_goryachev, of_inherent_error, of_kovalevskaya, &
        of_momenta, of_norm_error, of_omega, of_proof, of_quaternion, of_rates, of_residuals, of_time, of_vertical, of_work

    !> The vectors by their numbers.
    integer, parameter :: of_time = 1, of_angles = 2, of_rates = 3, of_omega = 4, of_quaternion = 5, of_vertical = 6, &
        of_axis = 7, of_centre = 8, of_energies = 9, of_energy_error = 10, of_momenta = 11, of_residuals = 12, &
        of_changes = 13, of_force = 14, of_force_beside_axis = 15, of_errors = 16, of_inherent_error = 17, &
        of_norm_error = 18, of_axis_z_rate = 19, of_kovalevskaya = 20, of_goryachev = 21, of_accelerometer = 22, &
        of_work = 23, of_bounds = 24, of_proof = 25, vectors = 25

    !> Number of components of the longest vector.
    integer, parameter :: longest = max(proof_count, works + 1)

contains

    !> The components of a vector for the motion that is looked at; those that it does not have are left as they were.
    subroutine put_vector(which, now, vector)
        integer, intent(in) :: which !! number of the vector
        type(motion_view_t), intent(inout) :: now !! the motion
        real(dp), intent(inout) :: vector(longest) !! its components are set
        select case (which)
        case (of_time)
            vector(1) = now%motion%t
        case (of_angles)
            vector(:3) = now%motion%angle
        case (of_rates)
            vector(:3) = now%motion%rate
        case (of_omega)
            vector(:3) = now%motion%omega
        case (of_quaternion)
            vector(:4) = now%motion%quaternion
        case (of_vertical) ! upward, in body axes
            vector(:3) = vertical_from_quaternion(now%motion%quaternion)
        case (of_axis)
            vector(:3) = to_space(now%motion%quaternion, [0.0_dp, 0.0_dp, 1.0_dp])
        case (of_centre)
            vector(:3) = to_space(now%motion%quaternion, now%body%centre_of_mass)
        case (of_energies) ! kinetic, potential, and their sum
            vector(:2) = now%energies()
            vector(3) = sum(vector(:2))
        case (of_energy_error)
            vector(1) = now%energy_error()
        case (of_momenta) ! about the vertical, and about body z
            vector(1) = vertical_momentum(now%body, now%motion)
            vector(2) = axial_momentum(now%body, now%motion)
        case (of_residuals) ! of Euler's equations
            vector(:3) = euler_residuals(now%body, now%motion)
        case (of_changes) ! of the vertical momentum and of the energy
            vector(:2) = [now%momentum_change(), now%energy_change()]
        case (of_force)
            vector(:3) = now%force()
        case (of_force_beside_axis)
            call put_force_beside_axis(now, vector)
        case (of_errors)
            call put_errors(now, vector)
        case (of_inherent_error)
            vector(1) = now%inherent_error()
        case (of_norm_error)
            vector(1) = now%motion%norm_error
        case (of_axis_z_rate)
            vector(1) = axis_height_rate(now%motion)
        case (of_kovalevskaya)
            vector(1) = kovalevskaya_integral(now%body, now%motion)
        case (of_goryachev)
            vector(1) = goryachev_integral(now%body, now%motion)
        case (of_accelerometer) ! at the centre of mass, in body axes
            vector(:3) = specific_force(now%body, now%motion)
        case (of_work) ! the parts, and their sum
            vector(:works) = now%work
            vector(works + 1) = sum(now%work)
        case (of_bounds) ! one for each quantity (spintop_certificate)
            vector(:proof_count) = now%proof%bounds
        case (of_proof) ! 1 where all bounds of the row are proved
            vector(1) = merge(1, 0, now%proof%is_proved())
        end select
    end subroutine put_vector

    !> The force along (sin phi, -cos phi, 0), and along the line of nodes (cos phi, sin phi, 0).
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

    !> The errors of the attitude, and of the axis tip.
    subroutine put_errors(now, vector)
        type(motion_view_t), intent(inout) :: now
        real(dp), intent(inout) :: vector(longest)
        type(motion_t) :: exact
        exact = now%exact()
        vector(1) = rotation_angle(exact%quaternion, now%computed%quaternion)
        vector(2) = norm2(axis_tip(now%turned_body, now%computed) - axis_tip(now%turned_body, exact))
    end subroutine put_errors

end module spintop_trajectory_vectors
