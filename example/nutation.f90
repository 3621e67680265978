!> The nutation of a top: its class, its extent and its period.
program nutation
    use spintop
    implicit none
    type(body_t) :: body
    type(nutation_t) :: whole
    real(dp) :: spin
    integer :: status, i

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
    body%centre_of_mass(3) = sqrt(0.75_dp)
    do i = 0, 3
        spin = 10.0_dp * i
        call find_nutation(body, motion_from_angles(0.0_dp, [0.0_dp, 0.5_dp, 0.0_dp], [0.0_dp, 0.0_dp, spin]), &
                           whole, status)
        if (status /= status_ok) error stop 'there is no nutation'
        print '(a, f5.1, 2(a, f12.9), a, f13.9, 2a)', 'spin', spin, ' rad/s: theta from', whole%theta_min, ' to', &
            whole%theta_max, ' rad and back in', whole%period, ' s, ', class_name(whole%class)
    end do
end program nutation
