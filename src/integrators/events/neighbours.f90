!> Motions that differ from another by rounding: what a quantity changes between them is its rounding error.
module spintop_neighbours
    use spintop_attitude, only: quaternion_product
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t, motion_from_quaternion
    implicit none
    private
    public :: early, neighbours, neighbour

    !> Number of neighbours, and how far they are, relatively.
    integer, parameter :: neighbours = 6
    real(dp), parameter :: distance = 8 * epsilon(1.0_dp)
    !> A motion is near its start for so many times of that within which an event is the start itself.
    real(dp), parameter :: early = 1.0e6_dp

contains

    !> A motion that is turned about a body axis, or whose angular velocity is changed along one.
    type(motion_t) function neighbour(motion, i) result(near)
        type(motion_t), intent(in) :: motion !! the motion
        integer, intent(in) :: i !! number of the neighbour: 1 to 3 turned, 4 to 6 with another angular velocity
        real(dp) :: turn(4), omega(3)
        turn = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
        omega = motion%omega
        if (i <= 3) then
            turn(1 + i) = distance / 2
        else
            omega(i - 3) = omega(i - 3) + distance * norm2(omega)
        end if
        near = motion_from_quaternion(motion%t, quaternion_product(motion%quaternion, turn), omega, motion%angle)
        near%omega_rate = motion%omega_rate
        near%given_angle = motion%given_angle
        near%norm_error = motion%norm_error
    end function neighbour

end module spintop_neighbours
