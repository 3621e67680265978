!> Permanent rotations of an asymmetric body about vertical axes of Staude's cone, and their largest growth rate.
program permanent_rotation
    use spintop
    implicit none
    real(dp), parameter :: parameters(4) = [-1.0_dp, 0.2_dp, 0.6_dp, 1.2_dp] ! kg m^2
    type(body_t) :: body
    type(motion_t) :: motion
    complex(dp) :: eigenvalues(6)
    real(dp) :: vertical(3), rate, same_rate
    integer :: i, status

    body%inertia = [0.9_dp, 0.7_dp, 0.4_dp]
    body%centre_of_mass = [0.1_dp, 0.2_dp, 0.5_dp]
    do i = 1, size(parameters)
        call find_permanent_rotation(body, parameters(i), vertical, rate, status)
        if (status /= status_ok) error stop 'there is no such rotation'
        call permanent_rate(body, vertical, same_rate, status)
        if (status /= status_ok) error stop 'the axis is not on the cone'
        motion = motion_from_quaternion(0.0_dp, upright(vertical), rate * vertical, [0.0_dp, 0.0_dp, 0.0_dp])
        call find_equilibrium_eigenvalues(body, motion, eigenvalues, status)
        if (status /= status_ok) error stop 'the motion is no equilibrium'
        print '(a, 3f10.6, 2(a, f14.10), a, f9.6, a)', 'axis', vertical, ': rate', rate, ' =', same_rate, &
            ' rad/s, growth', maxval(real(eigenvalues)), ' 1/s'
    end do

contains

    !> An attitude in which a direction of the body is up: the shortest rotation that takes it there.
    pure function upright(direction) result(q)
        real(dp), intent(in) :: direction(3) !! unit vector in body axes
        real(dp) :: q(4)
        q = [1 + direction(3), direction(2), -direction(1), 0.0_dp]
        q = q / norm2(q)
    end function upright

end program permanent_rotation
