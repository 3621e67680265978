!> The formulas for a fast top, compared with the exact nutation: their errors decrease as the spin increases.
program fast_top_formulas
    use spintop
    implicit none
    real(dp), parameter :: theta = 0.5_dp, pi = acos(-1.0_dp)
    type(body_t) :: body
    type(nutation_t) :: exact
    type(fast_top_t) :: approximate
    real(dp) :: spin
    integer :: status, i

    body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
    body%centre_of_mass(3) = sqrt(0.75_dp)
    do i = 5, 9
        spin = 2.0_dp**i
        approximate = fast_top(body, theta, spin)
        call find_nutation(body, motion_from_angles(0.0_dp, [0.0_dp, theta, 0.0_dp], [0.0_dp, 0.0_dp, spin]), exact, status)
        if (status /= status_ok) error stop 'there is no nutation'
        print '(a, f6.1, 2(a, f12.7, a, f12.7), a)', 'spin', spin, ' rad/s: nutation', 2 * pi / exact%period, ', about', &
            approximate%nutation_rate, ' rad/s; precession', exact%precession_rate, ', about', &
            approximate%precession_rate, ' rad/s'
    end do
end program fast_top_formulas
