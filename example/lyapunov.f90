!> Lyapunov exponents of a chaotic body, without and with damping, and of a symmetric top.
program lyapunov
    use spintop
    implicit none
    type(body_t) :: body

    body%mass = 10
    body%gravity = 10
    body%inertia = [1.0_dp, 1.5_dp, 2.25_dp]
    body%centre_of_mass = [0.01_dp, 0.005_dp, 0.02_dp]
    call print_results('chaotic body')
    body%damping = 0.1_dp
    call print_results('with damping')
    body = body_t(inertia=[0.875_dp, 0.875_dp, 0.25_dp], centre_of_mass=[0.0_dp, 0.0_dp, sqrt(0.75_dp)])
    call print_results('symmetric top')

contains

    !> Prints the largest exponent, and the largest growth factor of a perturbation.
    subroutine print_results(name)
        character(*), intent(in) :: name
        real(dp), parameter :: span = 200 ! s
        type(motion_t) :: start
        real(dp) :: exponent, factor
        integer :: status

        start = motion_from_quaternion(0.0_dp, [0.8_dp, 0.6_dp, 0.0_dp, 0.0_dp], [0.5_dp, 0.5_dp, 1.0_dp], &
                                       [0.0_dp, 0.0_dp, 0.0_dp])
        call find_lyapunov(body, start, span, exponent, status)
        if (status == status_ok) call find_largest_singular_value(body, start, span, factor, status)
        if (status /= status_ok) error stop 'no exponent'
        print '(a13, a, f9.5, a, es9.2)', name, ': largest exponent', exponent, ' 1/s, growth in 200 s by', factor
    end subroutine print_results
end program lyapunov
