!> Free rigid bodies and their starts, drawn in all regimes of the motion.
module drawn_free_bodies
    use random_stream, only: random_stream_t
    use spintop_body, only: body_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t, motion_from_quaternion
    implicit none
    private
    public :: draw, free_body, start_of

contains

    !> A body without gravity.
    type(body_t) function free_body(inertia) result(body)
        real(dp), intent(in) :: inertia(3) !! principal moments, kg m^2
        body%gravity = 0
        body%inertia = inertia
    end function free_body

    !> A start from quaternion and angular velocity.
    type(motion_t) function start_of(quaternion, omega) result(start)
        real(dp), intent(in) :: quaternion(4), omega(3) !! attitude, and rad/s in body axes
        start = motion_from_quaternion(0.0_dp, quaternion, omega, [0.0_dp, 0.0_dp, 0.0_dp])
    end function start_of

    !> A drawn body in one of the regimes: any; near the separatrix; near a stable axis; nearly a sphere;
    !> nearly symmetric.
    subroutine draw(stream, n, body, start)
        type(random_stream_t), intent(inout) :: stream !! the numbers
        integer, intent(in) :: n !! its remainder by six is the regime
        type(body_t), intent(out) :: body !! the body
        type(motion_t), intent(out) :: start !! its start
        real(dp) :: inertia(3), omega(3), q(4), small
        small = 10.0_dp**(-15 * stream%share())
        inertia = [stream%between(1.0_dp, 2.0_dp), stream%between(1.0_dp, 2.0_dp), stream%between(1.0_dp, 2.0_dp)]
        omega = [stream%between(-3.0_dp, 3.0_dp), stream%between(-3.0_dp, 3.0_dp), stream%between(-3.0_dp, 3.0_dp)]
        select case (mod(n, 6))
        case (1)
            ! On the separatrix but for a small part.
            inertia = [3, 4, 6]
            omega(1) = 2 * omega(3) * (1 + small)
        case (2)
            inertia = [0.5_dp, 0.7_dp, 0.9_dp]
            omega([1, 3]) = small * omega([1, 3])
        case (3)
            omega([1, 2]) = small * omega([1, 2])
        case (4)
            inertia = inertia(1) * [1.0_dp, 1 + small, 1 + small * inertia(3)]
        case (5)
            inertia(2) = inertia(1) * (1 + small)
        end select
        q = [stream%between(-1.0_dp, 1.0_dp), stream%between(-1.0_dp, 1.0_dp), stream%between(-1.0_dp, 1.0_dp), &
             stream%between(-1.0_dp, 1.0_dp)]
        body = free_body(inertia)
        start = start_of(q / norm2(q), omega)
    end subroutine draw

end module drawn_free_bodies
