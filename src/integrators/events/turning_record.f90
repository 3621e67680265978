!> Turning points of theta along a motion: when they were, and how far the motion went in them.
module spintop_turning_record
    use spintop_attitude, only: vertical_from_quaternion
    use spintop_compare, only: is_zero
    use spintop_constancy, only: margin, rounding_distance
    use spintop_kinds, only: dp, pi
    use spintop_motion, only: motion_t
    use spintop_pole_passages, only: half_turns
    use spintop_quantities, only: axis_height_rate
    use spintop_vectors, only: cross
    implicit none
    private
    public :: turning_points_t, count_end, interrupt, turns_at, upper, lower

    !> Kinds of turning points: where theta turns from falling to rising, and from rising to falling.
    integer, parameter :: upper = 1, lower = 2

    !> A turning point is at the end of a motion if it is nearer to it, relative to the time since the one before.
    real(dp), parameter :: at_end = 1.0e-9_dp

    !> What the turning points of one kind were. One that is within the noise of the motion interrupts the count of both kinds,
    !> but counts for the extremes: the count ends there, or begins anew if no whole nutation was counted before.
    type :: turning_points_t
        integer :: n = 0
        logical :: is_interrupted = .false., has_ended = .false.
        !> Time, s, phi and psi without the half turns at poles, rad, of the first and the last.
        real(dp), dimension(3) :: first = 0, last = 0
        !> Extremes of theta, rad, and of the precession rate there, rad/s.
        real(dp) :: theta(2) = [huge(1.0_dp), -huge(1.0_dp)]
        real(dp) :: rate(2) = [huge(1.0_dp), -huge(1.0_dp)]
    contains
        procedure :: add
        procedure :: count_in
        procedure :: add_before
    end type turning_points_t

contains

    !> Adds the next turning point.
    pure subroutine add(self, motion)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at the turning point
        call self%count_in(motion)
        if (self%has_ended) return
        self%last = time_and_angles(motion)
        if (self%n == 0) self%first = self%last
        self%n = self%n + 1
    end subroutine add

    !> Time, s, phi and psi without the half turns at poles, rad.
    pure function time_and_angles(motion) result(values)
        type(motion_t), intent(in) :: motion
        real(dp) :: values(3)
        values = [motion%t, motion%angle(1:3:2) - pi * half_turns(motion%passed)]
    end function time_and_angles

    !> Adds a turning point before all others.
    pure subroutine add_before(self, motion)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at the turning point
        self%first = time_and_angles(motion)
        if (self%n == 0) self%last = self%first
        self%n = self%n + 1
        call self%count_in(motion)
    end subroutine add_before

    !> A turning point within the noise of the motion.
    pure subroutine interrupt(turns)
        type(turning_points_t), intent(inout) :: turns(upper:lower) !! those before
        turns%is_interrupted = .true.
        turns%has_ended = any(turns%n > 1)
        if (.not. turns(upper)%has_ended) turns%n = 0
    end subroutine interrupt

    !> Counts the end of a motion that ends in a turning point, as at an event: whether rounding errors put it before or
    !> after the end does not matter. The motions are in the axes in which the body was given.
    pure subroutine count_end(turns, start, last, omega_rate)
        type(turning_points_t), intent(inout) :: turns(upper:lower) !! those before the end
        type(motion_t), intent(in) :: start, last !! start and end of the motion
        real(dp), intent(in) :: omega_rate(3) !! angular acceleration at the end, rad/s^2
        real(dp) :: slope, terms(4), bend, since
        integer :: kind, before

        if (any(turns%is_interrupted)) return
        call find_bend(last, omega_rate, slope, terms)
        bend = sum(terms)
        kind = merge(upper, lower, bend < 0)
        before = upper + lower - kind
        since = last%t - start%t
        if (turns(before)%n > 0) since = last%t - turns(before)%last(1)
        if (.not. abs(slope) < at_end * abs(bend) * since) return
        if (turns(kind)%n > 0) then
            ! The last one may be this one.
            if (turns(before)%n == 0 .or. turns(kind)%last(1) > turns(before)%last(1)) return
        end if
        if (turns(before)%n == 0 .and. is_zero(axis_height_rate(start))) call turns(before)%add(start)
        call turns(kind)%add(last)
    end subroutine count_end

    !> Whether theta turns at a motion: its rate is zero to rounding, and its acceleration is not.
    pure logical function turns_at(motion, omega_rate)
        type(motion_t), intent(in) :: motion !! the motion in the axes in which the body was given
        real(dp), intent(in) :: omega_rate(3) !! its angular acceleration, rad/s^2
        real(dp) :: slope, terms(4)
        turns_at = is_zero(axis_height_rate(motion))
        if (.not. turns_at) return
        call find_bend(motion, omega_rate, slope, terms)
        turns_at = abs(sum(terms)) > margin * rounding_distance * sum(abs(terms))
    end function turns_at

    !> The slope of the height of body z, and the terms of its second derivative.
    pure subroutine find_bend(motion, omega_rate, slope, terms)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: omega_rate(3)
        real(dp), intent(out) :: slope, terms(4)
        real(dp) :: gamma(3), gamma_rate(3)
        gamma = vertical_from_quaternion(motion%quaternion)
        gamma_rate = cross(gamma, motion%omega)
        slope = gamma_rate(3)
        terms = [gamma_rate(1) * motion%omega(2), -gamma_rate(2) * motion%omega(1), &
                 gamma(1) * omega_rate(2), -gamma(2) * omega_rate(1)]
    end subroutine find_bend

    !> Updates the extremes.
    pure subroutine count_in(self, motion)
        class(turning_points_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at the turning point
        self%theta = [min(self%theta(1), motion%angle(2)), max(self%theta(2), motion%angle(2))]
        self%rate = [min(self%rate(1), motion%rate(1)), max(self%rate(2), motion%rate(1))]
    end subroutine count_in

end module spintop_turning_record
