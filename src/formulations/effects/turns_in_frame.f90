!> Turns about body axes for a body under effects, whose angular velocity is that of the attitude, not of the momentum.
module spintop_turns_in_frame
    use spintop_attitude, only: conjugate_quaternion, quaternion_product
    use spintop_capabilities, only: max_states
    use spintop_kinds, only: dp
    use spintop_rigid_body, only: body_turns_t
    implicit none
    private
    public :: turns_in_frame_t

    !> The turns of `rigid_body` with another angular velocity.
    type, extends(body_turns_t) :: turns_in_frame_t
    contains
        procedure :: velocity
    end type turns_in_frame_t

contains

    !> The angular velocity, from the rate of the attitude, and the rate of the momentum.
    pure subroutine velocity(self, y, dy, xi)
        class(turns_in_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), dy(max_states) !! the state and its rate
        real(dp), intent(out) :: xi(max_states) !! the velocity
        real(dp) :: spin(4)
        spin = 2 * quaternion_product(conjugate_quaternion(y(1:4)), dy(1:4)) / sum(y(1:4)**2)
        xi(1:3) = spin(2:4)
        xi(4:6) = dy(5:7)
        xi(7:8) = 0
    end subroutine velocity

end module spintop_turns_in_frame
