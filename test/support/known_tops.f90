!> Tops that several suites use: bodies and starts of the paper's two examples.
module known_tops
    use spintop_kinds, only: dp, pi
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t, motion_from_angles
    implicit none
    private
    public :: slow_top, slow_start, paper_wheel, upright_theta

    !> Inclination at which both examples are released, rad.
    real(dp), parameter :: upright_theta = pi / 16

contains

    !> Body of Example 1; `length` is from the pivot to the centre of mass (default sqrt(3)/2 m).
    pure type(body_t) function slow_top(length) result(body)
        real(dp), intent(in), optional :: length
        body%mass = 1
        body%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
        body%centre_of_mass = [0.0_dp, 0.0_dp, sqrt(0.75_dp)]
        if (present(length)) body%centre_of_mass(3) = length
        body%gravity = 9.81_dp
    end function slow_top

    !> Start of Example 1: released at pi/16 with a spin rate of 1 rad/s.
    pure type(motion_t) function slow_start() result(start)
        start = motion_from_angles(0.0_dp, [0.0_dp, upright_theta, 0.0_dp], [0.0_dp, 0.0_dp, 1.0_dp])
    end function slow_start

    !> Body of Example 2 with the moments of inertia that the author used: those about the centre.
    pure type(body_t) function paper_wheel() result(body)
        real(dp), parameter :: radius = 0.1_dp, thickness = 0.01_dp, density = 7800
        body%mass = density * pi * radius**2 * thickness
        body%inertia(1:2) = body%mass * (3 * radius**2 + thickness**2) / 12
        body%inertia(3) = body%mass * radius**2 / 2
        body%centre_of_mass = [0.0_dp, 0.0_dp, 1.0_dp]
        body%gravity = 9.81_dp
    end function paper_wheel

end module known_tops
