!> The growth rate of a sleeping top, below and above its threshold spin.
program stability
    use spintop
    implicit none
    type(body_t) :: body
    type(motion_t) :: sleeping
    complex(dp) :: eigenvalues(6)
    real(dp) :: threshold
    integer :: status, percent

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
    body%centre_of_mass(3) = sqrt(0.75_dp)
    threshold = critical_omega3(body)
    print '(a, f13.9, a)', 'threshold spin', threshold, ' rad/s'
    do percent = 80, 120, 20
        sleeping = motion_from_quaternion(0.0_dp, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], &
                                          [0.0_dp, 0.0_dp, threshold * percent / 100], [0.0_dp, 0.0_dp, 0.0_dp])
        call find_equilibrium_eigenvalues(body, sleeping, eigenvalues, status)
        if (status /= status_ok) error stop 'this is no equilibrium'
        print '(i4, a, f13.9, a)', percent, ' % of it: growth rate', maxval(real(eigenvalues, dp)), ' 1/s'
    end do
end program stability
