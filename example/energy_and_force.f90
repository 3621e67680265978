!> Energy, momenta and support force along a motion, and the extremes of the force over a nutation.
program energy_and_force
    use spintop
    implicit none
    type(body_t) :: body
    type(motion_t) :: motion
    type(exact_motion_t) :: exact
    type(force_extremes_t) :: extremes
    real(dp) :: force(3)
    integer :: status, i

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
    body%centre_of_mass(3) = sqrt(0.75_dp)
    motion = motion_from_angles(0.0_dp, [0.0_dp, 0.2_dp, 0.0_dp], [0.0_dp, 0.0_dp, 1.0_dp])
    call prepare_exact_motion(body, motion, exact, status)
    if (status == status_ok) call find_force_extremes(body, motion, extremes, status)
    if (status /= status_ok) error stop 'there is no exact motion'
    print '(a)', ' t, s  energy, J      Lz, J s       L3, J s       upward force, N   residual, N m'
    do i = 0, 4
        motion = exact%at(0.25_dp * i * exact%nutation%period)
        force = support_force(body, motion)
        print '(f6.3, 3f14.10, f16.9, es12.1)', motion%t, kinetic_energy(body, motion) + potential_energy(body, motion), &
            vertical_momentum(body, motion), axial_momentum(body, motion), force(3), norm2(euler_residuals(body, motion))
    end do
    print '(a, f13.9, a, f13.9, a)', 'upward force from', extremes%lowest_vertical, ' N to', extremes%highest_vertical, ' N'
end program energy_and_force
