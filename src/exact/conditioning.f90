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
    use spintop_kinds, only: dp, pi, epsilon_dp, no_number, is_zero
    use spintop_status, only: is_ok, status_ok
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
    !> Number of data, of which a case has some: three moments of inertia, the weight, rotor and frame, and of a start four of
    !> the attitude and three rates.
    integer, parameter :: most_data = 3 + 1 + 2 + 7

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
        real(dp) :: weight
        integer :: n

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
        associate (angle => given%start%angle(1:3:2))
            if (rates_describe(given%start)) conditioning%constant = norm2(half_unit(angle) * angle)
        end associate
        do n = 1, most_data
            other = given
            call displace(other, n, weight)
            if (.not. weight > 0) cycle
            associate (k => conditioning%count + 1)
                call prepare(other, conditioning%displaced(k), status)
                if (.not. is_ok(status)) cycle
                conditioning%weight(k) = weight / displacement
                conditioning%frame_change(k) = other%frame - given%frame
            end associate
            conditioning%count = conditioning%count + 1
        end do
        status = status_ok
    end subroutine prepare_conditioning

    !> Displaces the n-th of the data, and gives its relative rounding error: zero if it is zero, or if there is none. Moments
    !> of inertia that are equal stay so; mass, gravity and height of the centre of mass act through their product only.
    pure subroutine displace(given, n, weight)
        type(data_t), intent(inout) :: given
        integer, intent(in) :: n
        real(dp), intent(out) :: weight
        real(dp) :: x(most_data)
        logical :: is_top, by_rates
        is_top = given%body%is_lagrange()
        by_rates = rates_describe(given%start)
        associate (body => given%body, start => given%start)
            x = [body%inertia, body%gravity, given%rotor, given%frame, start%quaternion, start%omega]
            if (by_rates) x(7:) = [start%angle(2), start%rate, 0.0_dp, 0.0_dp, 0.0_dp]
            weight = half_unit(x(n))
            if (n == 4) weight = norm2(half_unit([body%mass, body%gravity, body%centre_of_mass(3)]))
            if (merge(n == 2, n == 4, is_top)) weight = 0
            if (.not. weight > 0) return
            x(n) = x(n) * (1 + displacement)
            ! In the other direction if the axis would pass the pole and phi would jump.
            if (by_rates .and. x(7) > pi) x(7) = start%angle(2) * (1 - displacement)
            if (is_top) x(2) = x(1)
            body%inertia = x(1:3)
            body%gravity = x(4)
            given%rotor = x(5)
            given%frame = x(6)
            if (n > 6 .and. by_rates) then
                start = motion_from_angles(start%t, [start%angle(1), x(7), start%angle(3)], x(8:10))
            else if (n > 6) then
                start%quaternion = x(7:10)
                start%omega = x(11:13)
            end if
        end associate
    end subroutine displace

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
