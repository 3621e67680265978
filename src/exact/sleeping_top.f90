!> Stability of the sleeping top: upright, spinning about the vertical.
module spintop_sleeping_top
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    implicit none
    private
    public :: critical_omega3

contains

    !> Least omega3 at which a symmetric top sleeps stably, rad/s: sqrt(4 mgl I1)/I3.
    pure real(dp) function critical_omega3(body)
        type(body_t), intent(in) :: body
        critical_omega3 = 2 * sqrt(body%mgl() * body%inertia(1)) / body%inertia(3)
    end function critical_omega3

end module spintop_sleeping_top
