!> Bodies drawn at random, always the same.
module drawn_bodies
    use runs, only: unit_body
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, pi
    use spintop_motion, only: motion_from_angles, motion_t
    implicit none
    private
    public :: draw_case, draw_cases

contains

    !> The case of a number: any shape and damping, slow and so fast that it turns several times in a step, released at
    !> rest, hanging, next to the poles.
    subroutine draw_case(i, body, start, t_end)
        integer, intent(in) :: i !! number of the case
        type(body_t), intent(out) :: body
        type(motion_t), intent(out) :: start
        real(dp), intent(out) :: t_end
        real(dp) :: x(12), angle(3), rate(3)
        integer :: k
        do k = 1, size(x)
            x(k) = modulo(sin(12.9898_dp * i + 78.233_dp * k) * 43758.5453_dp, 1.0_dp)
        end do
        body = unit_body(0.2_dp + 0.5_dp * (sum(x(1:3)) - 0.9_dp * x(1:3)), x(4:6) - [0.5_dp, 0.5_dp, 0.2_dp])
        body%damping = 0.02_dp * x(7) * body%inertia
        angle = [0.3_dp, 0.05_dp + 3 * x(8), -0.4_dp]
        rate = [2 * x(9) - 1, x(10) - 0.5_dp, 0.5_dp * 60**x(11)]
        if (mod(i, 5) == 0) rate(1:2) = 0
        if (mod(i, 11) == 0) angle(2) = 1.0e-3_dp
        if (mod(i, 13) == 0) angle(2) = pi - 1.0e-3_dp
        start = motion_from_angles(0.0_dp, angle, rate)
        t_end = 2 + 6 * x(12)
    end subroutine draw_case

    !> The first cases.
    subroutine draw_cases(bodies, starts, t_end)
        type(body_t), intent(out) :: bodies(:)
        type(motion_t), intent(out) :: starts(:)
        real(dp), intent(out) :: t_end(:)
        integer :: i
        do i = 1, size(bodies)
            call draw_case(i, bodies(i), starts(i), t_end(i))
        end do
    end subroutine draw_cases

end module drawn_bodies
