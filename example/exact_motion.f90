!> The exact motion of a symmetric top at three instants.
program exact_motion
    use spintop
    implicit none
    type(body_t) :: body
    type(motion_t) :: motion
    type(exact_motion_t) :: exact
    integer :: status, i

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp] ! kg m^2, about the fixed point
    body%centre_of_mass(3) = sqrt(0.75_dp)       ! m
    motion = motion_from_angles(0.0_dp, [0.0_dp, 0.2_dp, 0.0_dp], [0.0_dp, 0.0_dp, 1.0_dp])
    call prepare_exact_motion(body, motion, exact, status)
    if (status /= status_ok) error stop 'there is no exact motion'
    do i = 1, 3
        motion = exact%at(0.5_dp * i)
        print '(a, f4.1, a, 3f12.8)', 't =', motion%t, ' s: phi, theta, psi =', motion%angle
    end do
end program exact_motion
