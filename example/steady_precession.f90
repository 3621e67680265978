!> Slow and fast steady precession of a top at 60 degrees, with the force at its support.
program steady_precession
    use spintop
    implicit none
    real(dp), parameter :: theta = acos(0.5_dp), omega3 = 40 ! rad, rad/s
    type(body_t) :: body
    type(motion_t) :: motion
    type(exact_motion_t) :: exact
    real(dp) :: rates(2), force(3)
    integer :: number, status, i

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
    body%centre_of_mass(3) = sqrt(0.75_dp)
    call steady_rates(body, theta, omega3, rates, number, status)
    if (status /= status_ok) error stop 'this is no symmetric top'
    do i = 1, number
        motion = motion_from_angles(0.0_dp, [0.0_dp, theta, 0.0_dp], [rates(i), 0.0_dp, omega3 - rates(i) * cos(theta)])
        call prepare_exact_motion(body, motion, exact, status)
        if (status /= status_ok) error stop 'there is no exact motion'
        motion = exact%at(1.0_dp)
        force = support_force(body, motion)
        print '(a, f13.9, a, f13.10, 2(a, f14.8), a)', 'precession', rates(i), ' rad/s: theta', motion%angle(2), &
            ', support force', force(3), ' N upwards,', norm2(force(1:2)), ' N horizontally'
    end do
end program steady_precession
