!> Inherent error: the error of the attitude that is due to rounding of the data to double precision.
!>
!> No method avoids it. It is small for a steady precession, and very large for a top that stays near the
!> upright for a long time. The inherent error at a time is the rotation angle by which the attitude changes
!> if each datum changes by half a unit in the last place, combined as independent errors. It is computed from
!> the exact solutions for slightly displaced data.
!>
!> A rotor on the axis of a top, and a frame that turns about the vertical, add to the rates of phi and psi (`given_axes_t`).
!> The data are then those of the body as it was given, with the momentum of the rotor and the rotation of the frame.
!> The exact solution is that with the rotor: the angle by which it differs from that of the faster top is common to all.
module spintop_conditioning
    use spintop_kinds, only: dp, pi, epsilon_dp, no_number
    use spintop_compare, only: is_zero
    use spintop_status, only: is_ok
    use spintop_attitude, only: quaternion_product, rotation_angle
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t, motion_from_angles
    use spintop_regular_start, only: rates_describe
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_given_axes, only: about_z, unshifted
    implicit none
    private
    public :: conditioning_t, prepare_conditioning, inherent_error

    !> Relative displacement of each datum: large enough that the rounding error of the attitude does not
    !> matter, small enough for inherent errors up to `hopeless`, rad. For larger errors the displaced motions
    !> are unrelated.
    real(dp), parameter :: displacement = 8 * epsilon_dp, hopeless = 0.1_dp
    !> Largest relative error of a rounded number.
    real(dp), parameter :: rounding = epsilon_dp / 2
    !> Maximum number of data: three of the body, two of effects, and of a start four of the attitude, three rates.
    integer, parameter :: most_data = 3 + 2 + 7

    !> What is displaced: the body, its start, the rotation of the frame, rad/s, and the momentum of the rotor, kg m^2/s.
    type :: data_t
        type(body_t) :: body
        type(motion_t) :: start
        real(dp) :: frame = 0, rotor = 0
    end type data_t

    !> The exact solution of a start, and the exact solutions for its displaced data.
    type :: conditioning_t
        private
        type(exact_motion_t) :: exact
        integer :: count = 0
        type(exact_motion_t) :: displaced(most_data)
        real(dp) :: weight(most_data) = 0
        !> By how much the rotation of the frame is displaced, rad/s.
        real(dp) :: frame_change(most_data) = 0
        !> Part of the inherent error that is constant in time: phi and psi at the start, rad.
        real(dp) :: constant = 0
        !> Time of the start, s, and its angular velocity, rad/s.
        real(dp) :: time = 0, rate = 0
    contains
        procedure :: floor_at
    end type conditioning_t

contains

    !> Sets up the displaced motions. `status` as in `prepare_exact_motion`.
    pure subroutine prepare_conditioning(body, start, conditioning, status, rotor)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(conditioning_t), intent(out) :: conditioning !! exact solutions of the start and of displaced data
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(in), optional :: rotor(3) !! constant momentum of a rotor, body axes, kg m^2/s
        type(data_t) :: given, other

        if (present(rotor)) then
            call prepare_exact_motion(body, start, conditioning%exact, status, rotor)
            if (.not. is_ok(status)) return
        end if
        given = data_t(body, start, body%given%phi_shift, body%inertia(3) * body%given%psi_shift)
        if (present(rotor)) given%rotor = given%rotor + rotor(3)
        if (.not. (is_zero(given%frame) .and. is_zero(body%given%psi_shift))) then
            given%start = unshifted(given%frame, body%given%psi_shift, start)
        end if
        call prepare(given, conditioning%exact, status)
        if (.not. is_ok(status)) return

        conditioning%time = start%t
        conditioning%rate = norm2(given%start%omega)
        if (body%is_lagrange()) then
            call displace_inertia(conditioning, given, 1, 2)
            call displace_inertia(conditioning, given, 3, 3)
            ! Mass, gravity and height of the centre of mass act through their product only.
            other = given
            other%body%gravity = displaced_value(body%gravity)
            call add(conditioning, given, other, norm2(half_unit([body%mass, body%gravity, body%centre_of_mass(3)])))
        else
            call displace_inertia(conditioning, given, 1, 1)
            call displace_inertia(conditioning, given, 2, 2)
            call displace_inertia(conditioning, given, 3, 3)
        end if
        other = given
        other%rotor = displaced_value(given%rotor)
        if (.not. is_zero(given%rotor)) call add(conditioning, given, other, half_unit(given%rotor))
        other = given
        other%frame = displaced_value(given%frame)
        if (.not. is_zero(given%frame)) call add(conditioning, given, other, half_unit(given%frame))

        if (rates_describe(given%start)) then
            call displace_angles(conditioning, given)
        else
            call displace_quaternion(conditioning, given)
        end if
    end subroutine prepare_conditioning

    !> Moments of inertia that are equal and stay so.
    pure subroutine displace_inertia(conditioning, given, first, last)
        type(conditioning_t), intent(inout) :: conditioning
        type(data_t), intent(in) :: given
        integer, intent(in) :: first, last
        type(data_t) :: other
        other = given
        other%body%inertia(first:last) = displaced_value(given%body%inertia(first:last))
        call add(conditioning, given, other, half_unit(given%body%inertia(first)))
    end subroutine displace_inertia

    !> Data of a start that is given by angles and rates.
    pure subroutine displace_angles(conditioning, given)
        type(conditioning_t), intent(inout) :: conditioning
        type(data_t), intent(in) :: given
        type(data_t) :: other
        real(dp) :: angle(3), rate(3)
        integer :: n
        other = given
        associate (start => given%start)
            angle = start%angle
            angle(2) = displaced_value(angle(2))
            ! In the other direction if the axis would pass the pole and phi would jump.
            if (angle(2) > pi) angle(2) = start%angle(2) * (1 - displacement)
            other%start = motion_from_angles(start%t, angle, start%rate)
            call add(conditioning, given, other, half_unit(start%angle(2)))
            do n = 1, 3
                rate = start%rate
                rate(n) = displaced_value(rate(n))
                other%start = motion_from_angles(start%t, start%angle, rate)
                call add(conditioning, given, other, half_unit(start%rate(n)))
            end do
            conditioning%constant = norm2(half_unit(start%angle(1:3:2)) * start%angle(1:3:2))
        end associate
    end subroutine displace_angles

    !> Data of a start that is given by quaternion and omega.
    pure subroutine displace_quaternion(conditioning, given)
        type(conditioning_t), intent(inout) :: conditioning
        type(data_t), intent(in) :: given
        type(data_t) :: other
        integer :: n
        do n = 1, 4
            other = given
            other%start%quaternion(n) = displaced_value(given%start%quaternion(n))
            call add(conditioning, given, other, half_unit(given%start%quaternion(n)))
        end do
        do n = 1, 3
            other = given
            other%start%omega(n) = displaced_value(given%start%omega(n))
            call add(conditioning, given, other, half_unit(given%start%omega(n)))
        end do
    end subroutine displace_quaternion

    !> Adds the exact solution of displaced data, of which `weight` is the relative error.
    pure subroutine add(conditioning, given, other, weight)
        type(conditioning_t), intent(inout) :: conditioning
        type(data_t), intent(in) :: given, other
        real(dp), intent(in) :: weight
        integer :: status, n
        n = conditioning%count + 1
        call prepare(other, conditioning%displaced(n), status)
        if (.not. is_ok(status)) return
        conditioning%count = n
        conditioning%weight(n) = weight / displacement
        conditioning%frame_change(n) = other%frame - given%frame
    end subroutine add

    !> Prepares the exact solution of data, as seen from a frame that does not turn.
    pure subroutine prepare(given, exact, status)
        type(data_t), intent(in) :: given
        type(exact_motion_t), intent(out) :: exact
        integer, intent(out) :: status
        type(motion_t) :: start
        start = given%start
        if (.not. is_zero(given%frame)) start = unshifted(-given%frame, 0.0_dp, start)
        call prepare_exact_motion(given%body, start, exact, status, [0.0_dp, 0.0_dp, given%rotor])
    end subroutine prepare

    !> Half a unit in the last place of a number, relative to the number; zero for zero.
    elemental real(dp) function half_unit(x)
        real(dp), intent(in) :: x !! the number
        half_unit = 0
        if (abs(x) > 0) half_unit = spacing(x) / (2 * abs(x))
    end function half_unit

    elemental real(dp) function displaced_value(x)
        real(dp), intent(in) :: x
        displaced_value = x * (1 + displacement)
    end function displaced_value

    !> Inherent error of the attitude at time t (s), rad; NaN where the time is not finite.
    pure real(dp) function floor_at(self, t) result(angle)
        class(conditioning_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: q(4), other(4), turned(most_data), turning
        integer :: n
        q = self%exact%quaternion_at(t)
        turned = 0
        do n = 1, self%count
            other = self%displaced(n)%quaternion_at(t)
            if (abs(self%frame_change(n)) > 0) other = quaternion_product(about_z(-self%frame_change(n) * t), other)
            turned(n) = self%weight(n) * rotation_angle(q, other)
        end do
        angle = hypot(norm2(turned), self%constant)
        ! After displacements by whole turns motions may agree by chance.
        turning = rounding * self%rate * abs(t - self%time)
        if (turning > hopeless) angle = max(angle, turning)
        if (angle > pi) angle = pi ! unlike min, keeps a NaN
    end function floor_at

    !> Inherent error of the attitude at time t (s), rad; NaN for data without an exact solution
    !> (`prepare_conditioning` says why). For many times, prepare once.
    pure real(dp) function inherent_error(body, start, t, rotor) result(angle)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(in) :: t !! time, s
        real(dp), intent(in), optional :: rotor(3) !! constant momentum of a rotor, body axes, kg m^2/s
        type(conditioning_t) :: conditioning
        integer :: status
        call prepare_conditioning(body, start, conditioning, status, rotor)
        angle = no_number
        if (is_ok(status)) angle = conditioning%floor_at(t)
    end function inherent_error

end module spintop_conditioning
