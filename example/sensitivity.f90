!> The sensitivity of a motion to the spin at its start: by the variational equations, and by a difference.
program sensitivity
    use spintop
    implicit none
    real(dp), parameter :: spin = 5, step = 1.0e-4_dp, span = 2 ! rad/s, rad/s, s
    type(body_t) :: body
    real(dp) :: columns(6, 2), differences(6)
    integer :: status, i

    body%inertia = [0.9_dp, 0.7_dp, 0.25_dp]
    body%centre_of_mass = [0.05_dp, 0.0_dp, 0.8_dp]
    columns(:, 1) = start_with(spin) ! the vertical and the angular momentum in body axes
    columns(:, 2) = start_with(spin + 1) - start_with(spin) ! the state is linear in the spin
    call propagate_tangents(body, span, columns, status)
    if (status /= status_ok) error stop 'the motion failed'
    differences = (end_of(spin + step) - end_of(spin - step)) / (2 * step)
    do i = 1, 6
        print '(a, i0, a, f14.9, a, f14.9)', 'state ', i, ': derivative', columns(i, 2), ', difference quotient', differences(i)
    end do

contains

    function start_with(spin) result(state)
        real(dp), intent(in) :: spin
        real(dp) :: state(6)
        state = euler_poisson_state(body, motion_from_angles(0.0_dp, [0.0_dp, 0.2_dp, 0.0_dp], [0.0_dp, 0.0_dp, spin]))
    end function start_with

    function end_of(spin) result(state)
        real(dp), intent(in) :: spin
        real(dp) :: state(6), column(6, 1)
        integer :: status
        column(:, 1) = start_with(spin)
        call propagate_tangents(body, span, column, status)
        if (status /= status_ok) error stop 'the motion failed'
        state = column(:, 1)
    end function end_of
end program sensitivity
