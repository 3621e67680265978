!> A free body that rotates about each of its principal axes: Floquet multipliers of one turn.
program floquet
    use spintop
    implicit none
    real(dp), parameter :: turn = 2 * acos(-1.0_dp), rate = 1 ! rad, rad/s
    type(body_t) :: body
    type(motion_t) :: start
    complex(dp) :: multipliers(6)
    real(dp) :: omega(3)
    integer :: status, axis

    body%inertia = [1.0_dp, 2.0_dp, 3.0_dp] ! its weight acts at the fixed point
    do axis = 1, 3
        omega = 0
        omega(axis) = rate
        start = motion_from_quaternion(0.0_dp, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], omega, [0.0_dp, 0.0_dp, 0.0_dp])
        call find_multipliers(body, start, turn / rate, multipliers, status)
        if (status /= status_ok) error stop 'the motion does not return'
        print '(a, i0, a, f15.9, a)', 'axis ', axis, ': a perturbation grows by up to', maxval(abs(multipliers)), ' per turn'
    end do
end program floquet
