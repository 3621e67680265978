!> Turning points of theta along a motion: when they were, and how far the motion went in them.
module spintop_turning_record
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_compare, only: is_zero
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_quantities, only: axis_height_rate
    use spintop_vectors, only: cross
    implicit none
    private
    public :: turning_points_t, count_end, upper, lower

    !> Kinds of turning points: where theta turns from falling to rising, and from rising to falling.
    integer, parameter :: upper = 1, lower = 2

    !> A turning point is at the end of a motion if it is nearer to it, relative to the time since the one before.
    real(dp), parameter :: at_end = 1.0e-9_dp

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

    !> Counts the end of a motion that ends in a turning point, as at an event: whether rounding errors put it before or
    !> after the end does not matter. The motions are in the axes in which the body was given.
    pure subroutine count_end(turns, start, last, omega_rate)
        type(turning_points_t), intent(inout) :: turns(upper:lower) !! those before the end
        type(motion_t), intent(in) :: start, last !! start and end of the motion
        real(dp), intent(in) :: omega_rate(3) !! angular acceleration at the end, rad/s^2
        real(dp) :: gamma(3), gamma_rate(3), bend, since
        integer :: kind, before

        gamma = vertical_from_quaternion(last%quaternion)
        gamma_rate = cross(gamma, last%omega)
        bend = gamma_rate(1) * last%omega(2) - gamma_rate(2) * last%omega(1) &
               + gamma(1) * omega_rate(2) - gamma(2) * omega_rate(1)
        kind = merge(upper, lower, bend < 0)
        before = upper + lower - kind
        since = last%t - start%t
        if (turns(before)%n > 0) since = last%t - turns(before)%last(1)
        if (.not. abs(gamma_rate(3)) < at_end * abs(bend) * since) return
        if (turns(kind)%n > 0) then
            ! The last one may be this one.
            if (turns(before)%n == 0 .or. turns(kind)%last(1) > turns(before)%last(1)) return
        end if
        if (turns(before)%n == 0 .and. is_zero(axis_height_rate(start))) call turns(before)%take(start)
        call turns(kind)%take(last)
    end subroutine count_end

    !> Takes the extremes.
    pure subroutine count_in(self, motion)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        self%n = self%n + 1
        self%theta = [min(self%theta(1), motion%angle(2)), max(self%theta(2), motion%angle(2))]
        self%rate = [min(self%rate(1), motion%rate(1)), max(self%rate(2), motion%rate(1))]
    end subroutine count_in

end module spintop_turning_record
