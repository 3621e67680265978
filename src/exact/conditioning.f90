!> Inherent error: the error of the attitude that is due to rounding of the data to double precision.
!>
!> No method avoids it. It is small for a steady precession, and very large for a top that stays near the
!> upright for a long time. The inherent error at a time is the rotation angle by which the attitude changes
!> if each datum changes by half a unit in the last place, combined as independent errors. It is computed from
!> the exact solutions for slightly displaced data.
module spintop_conditioning
    use spintop_kinds, only: dp, pi, epsilon_dp, no_number
    use spintop_status, only: status_ok
    use spintop_attitude, only: rotation_angle
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t, motion_from_angles
    use spintop_regular_start, only: rates_describe
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    implicit none
    private
    public :: conditioning_t, prepare_conditioning, inherent_error

    !> Relative displacement of each datum: large enough that the rounding error of the attitude does not
    !> matter, small enough for inherent errors up to `hopeless`, rad. For larger errors the displaced motions
    !> are unrelated.
    real(dp), parameter :: displacement = 8 * epsilon_dp, hopeless = 0.1_dp
    !> Relative error of a rounded datum.
    real(dp), parameter :: rounding = epsilon_dp / 2
    !> Maximum number of data of a start: four of the attitude, three rates.
    integer, parameter :: most_data = 3 + 7

    !> The exact solution of a start, and the exact solutions for its displaced data.
    type :: conditioning_t
        private
        type(exact_motion_t) :: exact
        integer :: count = 0
        type(exact_motion_t) :: displaced(most_data)
        real(dp) :: weight(most_data) = 0
        !> Part of the inherent error that is constant in time: phi and psi at the start, rad.
        real(dp) :: constant = 0
        !> Time of the start, s, and its angular velocity, rad/s.
        real(dp) :: time = 0, rate = 0
    contains
        procedure :: floor_at
    end type conditioning_t

contains

    !> Sets up the displaced motions. `status` as in `prepare_exact_motion`.
    pure subroutine prepare_conditioning(body, start, conditioning, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(conditioning_t), intent(out) :: conditioning !! exact solutions of the start and of displaced data
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(body_t) :: displaced

        call prepare_exact_motion(body, start, conditioning%exact, status)
        if (status /= status_ok) return

        conditioning%time = start%t
        conditioning%rate = norm2(start%omega)
        if (body%is_lagrange()) then
            call displace_inertia(conditioning, body, start, 1, 2)
            call displace_inertia(conditioning, body, start, 3, 3)
            ! Mass, gravity and height of the centre of mass act through their product only.
            displaced = body
            displaced%gravity = displaced_value(body%gravity)
            call add(conditioning, displaced, start, sqrt(3.0_dp))
        else
            call displace_inertia(conditioning, body, start, 1, 1)
            call displace_inertia(conditioning, body, start, 2, 2)
            call displace_inertia(conditioning, body, start, 3, 3)
        end if

        if (rates_describe(start)) then
            call displace_angles(conditioning, body, start)
        else
            call displace_quaternion(conditioning, body, start)
        end if
    end subroutine prepare_conditioning

    !> Moments of inertia that are equal and stay so.
    pure subroutine displace_inertia(conditioning, body, start, first, last)
        type(conditioning_t), intent(inout) :: conditioning
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        integer, intent(in) :: first, last
        type(body_t) :: displaced
        displaced = body
        displaced%inertia(first:last) = displaced_value(body%inertia(first:last))
        call add(conditioning, displaced, start, 1.0_dp)
    end subroutine displace_inertia

    !> Data of a start that is given by angles and rates.
    pure subroutine displace_angles(conditioning, body, start)
        type(conditioning_t), intent(inout) :: conditioning
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp) :: angle(3), rate(3)
        integer :: n
        angle = start%angle
        angle(2) = displaced_value(angle(2))
        ! In the other direction if the axis would pass the pole and phi would jump.
        if (angle(2) > pi) angle(2) = start%angle(2) * (1 - displacement)
        call add(conditioning, body, motion_from_angles(start%t, angle, start%rate), 1.0_dp)
        do n = 1, 3
            rate = start%rate
            rate(n) = displaced_value(rate(n))
            call add(conditioning, body, motion_from_angles(start%t, start%angle, rate), 1.0_dp)
        end do
        conditioning%constant = rounding * hypot(start%angle(1), start%angle(3))
    end subroutine displace_angles

    !> Data of a start that is given by quaternion and omega.
    pure subroutine displace_quaternion(conditioning, body, start)
        type(conditioning_t), intent(inout) :: conditioning
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        type(motion_t) :: displaced
        integer :: n
        do n = 1, 4
            displaced = start
            displaced%quaternion(n) = displaced_value(start%quaternion(n))
            call add(conditioning, body, displaced, 1.0_dp)
        end do
        do n = 1, 3
            displaced = start
            displaced%omega(n) = displaced_value(start%omega(n))
            call add(conditioning, body, displaced, 1.0_dp)
        end do
    end subroutine displace_quaternion

    !> Adds the exact solution of displaced data.
    pure subroutine add(conditioning, body, start, weight)
        type(conditioning_t), intent(inout) :: conditioning
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in) :: weight
        integer :: status, n
        n = conditioning%count + 1
        call prepare_exact_motion(body, start, conditioning%displaced(n), status)
        if (status /= status_ok) return
        conditioning%count = n
        conditioning%weight(n) = weight * rounding / displacement
    end subroutine add

    elemental real(dp) function displaced_value(x)
        real(dp), intent(in) :: x
        displaced_value = x * (1 + displacement)
    end function displaced_value

    !> Inherent error of the attitude at time t (s), rad; NaN where the time is not finite.
    pure real(dp) function floor_at(self, t) result(angle)
        class(conditioning_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: q(4), turned(most_data), turning
        integer :: n
        q = self%exact%quaternion_at(t)
        turned = 0
        do n = 1, self%count
            turned(n) = self%weight(n) * rotation_angle(q, self%displaced(n)%quaternion_at(t))
        end do
        angle = hypot(norm2(turned), self%constant)
        ! After displacements by whole turns motions may agree by chance.
        turning = rounding * self%rate * abs(t - self%time)
        if (turning > hopeless) angle = max(angle, turning)
        if (angle > pi) angle = pi ! unlike min, keeps a NaN
    end function floor_at

    !> Inherent error of the attitude at time t (s), rad; NaN for data without an exact solution
    !> (`prepare_conditioning` says why). For many times, prepare once.
    pure real(dp) function inherent_error(body, start, t) result(angle)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t !! time, s
        type(conditioning_t) :: conditioning
        integer :: status
        call prepare_conditioning(body, start, conditioning, status)
        angle = no_number
        if (status == status_ok) angle = conditioning%floor_at(t)
    end function inherent_error

end module spintop_conditioning
