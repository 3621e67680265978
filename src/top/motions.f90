!> The motion of a body at several instants at once: each number is a vector over the instants, so that all are computed by
!> the same instructions.
module spintop_motions
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: motions_t, instants

    !> Number of instants.
    integer, parameter :: instants = 8

    !> Attitudes, angular velocities and their rates. They are not set at first, which would take longer than what most are for.
    type :: motions_t
        real(dp) :: t(instants) !! s
        real(dp) :: quaternion(instants, 4) !! unit quaternions, body to space
        real(dp) :: omega(instants, 3) !! angular velocities in body axes, rad/s
        real(dp) :: omega_rate(instants, 3) !! their time derivatives in body axes, rad/s^2
    contains
        procedure :: fill
        procedure :: set_motion
        procedure :: motion
    end type motions_t

contains

    !> Sets the motion at all instants to the same one.
    pure subroutine fill(self, motion)
        class(motions_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion
        integer :: k
        self%t = motion%t
        do k = 1, 4
            self%quaternion(:, k) = motion%quaternion(k)
        end do
        do k = 1, 3
            self%omega(:, k) = motion%omega(k)
            self%omega_rate(:, k) = motion%omega_rate(k)
        end do
    end subroutine fill

    !> Sets the motion at an instant.
    pure subroutine set_motion(self, i, motion)
        class(motions_t), intent(inout) :: self
        integer, intent(in) :: i !! number of the instant
        type(motion_t), intent(in) :: motion !! the motion
        self%t(i) = motion%t
        self%quaternion(i, :) = motion%quaternion
        self%omega(i, :) = motion%omega
        self%omega_rate(i, :) = motion%omega_rate
    end subroutine set_motion

    !> The motion at an instant, without angles.
    pure type(motion_t) function motion(self, i)
        class(motions_t), intent(in) :: self
        integer, intent(in) :: i !! number of the instant
        motion%t = self%t(i)
        motion%quaternion = self%quaternion(i, :)
        motion%omega = self%omega(i, :)
        motion%omega_rate = self%omega_rate(i, :)
    end function motion

end module spintop_motions
