!> Free rigid bodies and their starts, drawn in all regimes of the motion.
module drawn_free_bodies
    use random_stream, only: random_stream_t
    use runs, only: start_from
    use spintop_body, only: body_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: draw, free_body

contains

    !> A body without gravity.
    type(body_t) function free_body(inertia) result(body)
        real(dp), intent(in) :: inertia(3) !! principal moments, kg m^2
        body%gravity = 0
        body%inertia = inertia
    end function free_body

    !> A drawn body in one of the regimes: any; near the separatrix; near a stable axis; nearly a sphere;
    !> nearly symmetric.
    subroutine draw(stream, n, body, start)
        type(random_stream_t), intent(inout) :: stream !! the numbers
        integer, intent(in) :: n !! its remainder by six is the regime
        type(body_t), intent(out) :: body !! the body
        type(motion_t), intent(out) :: start !! its start
        real(dp) :: inertia(3), omega(3), q(4), small
        small = 10.0_dp**(-15 * stream%share())
        inertia = stream%several(3, 1.0_dp, 2.0_dp)
        omega = stream%several(3, -3.0_dp, 3.0_dp)
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
        q = stream%several(4, -1.0_dp, 1.0_dp)
        body = free_body(inertia)
        start = start_from(q / norm2(q), omega)
    end subroutine draw

end module drawn_free_bodies
