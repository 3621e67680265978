!> Turning points of theta along a motion: when they were, and how far the motion went in them.
module spintop_turning_record
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: turning_points_t, upper, lower

    !> Kinds of turning points: where theta turns from falling to rising, and from rising to falling.
    integer, parameter :: upper = 1, lower = 2

    !> What the turning points of one kind were.
    type :: turning_points_t
        integer :: n = 0
        !> Time, s, phi and psi, rad, of the first and the last.
        real(dp), dimension(3) :: first = 0, last = 0
        !> Extremes of theta, rad, and of the precession rate there, rad/s.
        real(dp) :: theta(2) = [huge(1.0_dp), -huge(1.0_dp)]
        real(dp) :: rate(2) = [huge(1.0_dp), -huge(1.0_dp)]
    contains
        procedure :: take
        procedure :: take_before
    end type turning_points_t

contains

    !> Takes the next turning point.
    pure subroutine take(self, motion)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at the turning point
        self%last = [motion%t, motion%angle(1), motion%angle(3)]
        if (self%n == 0) self%first = self%last
        call count_in(self, motion)
    end subroutine take

    !> Takes one before all others.
    pure subroutine take_before(self, motion)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at the turning point
        self%first = [motion%t, motion%angle(1), motion%angle(3)]
        if (self%n == 0) self%last = self%first
        call count_in(self, motion)
    end subroutine take_before

    !> Takes the extremes.
    pure subroutine count_in(self, motion)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        self%n = self%n + 1
        self%theta = [min(self%theta(1), motion%angle(2)), max(self%theta(2), motion%angle(2))]
        self%rate = [min(self%rate(1), motion%rate(1)), max(self%rate(2), motion%rate(1))]
    end subroutine count_in

end module spintop_turning_record
