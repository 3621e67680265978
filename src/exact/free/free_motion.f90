!> The exact motion of a free rigid body: no damping, and no gravitational torque about the fixed point O
!> (Euler's and Poinsot's case).
!>
!> The momentum L in body axes circulates about the principal axis of smallest or of largest inertia, here
!> axis z of the axes x, y, z; in units of |L| it is (s a cn, b sn, c dn), up to signs. Relative to the momentum
!> the attitude is
!>
!>     (q0 + i q3, q1 + i q2) = exp(i chi) (F+, F-)/norm,    chi = kappa t
!>
!> with two theta functions of one argument z, which grows uniformly with time: a series in circular functions
!> while the complementary modulus k' is not small, one in hyperbolic functions otherwise, the separatrix k' = 0
!> included. No integral of the third kind is summed, and no phase is followed.
!> Sources: Jacobi, Sur la rotation d'un corps, Crelle 39, 1849; Whittaker, Analytical Dynamics, chapter VI, 1937;
!> van Zon and Schofield, J. Comput. Phys. 225, 2007.
module spintop_free_motion
    use spintop_kinds, only: dp, xp, pi, is_equal, is_finite, is_zero, cross
    use spintop_attitude, only: angles_from_quaternion, quaternion_product, rates_from_omega
    use spintop_body, only: body_t
    use spintop_free_series, only: circular_series_t, least_complement, prepare_circular_series, &
        hyperbolic_series_t, prepare_hyperbolic_series, free_values_t
    use spintop_momentum_path, only: find_momentum_path, momentum_path_t
    use spintop_motion, only: motion_t
    use spintop_status, only: is_ok, status_unsuitable
    use spintop_validity, only: body_status, start_status
    implicit none
    private
    public :: free_motion_t, prepare_free_motion, inclination_range

    !> The exact motion of one start.
    type :: free_motion_t
        !> Smallest and largest angular velocity, rad/s.
        real(dp) :: least_rate = 0, greatest_rate = 0
        !> Smallest and largest angle between body z and the momentum, rad.
        real(dp) :: axis_angle(2) = 0
        !> Period of the momentum in the body, s (infinite on the separatrix, zero for a steady rotation), and the
        !> angle by which axis z turns about the momentum in that time, rad.
        real(dp) :: period = 0, turn = 0
        !> Number of the body axis about which the momentum circulates; the direction of its motion is that of s.
        integer :: about = 0
        !> Time of the start, s, its attitude, and its angles, rad.
        real(dp), private :: time = 0, start(4) = 0, angle(3) = 0
        !> Moments of inertia, kg m^2, and angular velocity of the start, rad/s, in body axes.
        real(dp), private :: inertia(3) = 1, omega(3) = 0
        !> Whether the body turns about one fixed axis; the series that applies otherwise.
        logical, private :: is_steady = .true., is_circular = .true.
        type(circular_series_t), private :: circular
        type(hyperbolic_series_t), private :: hyperbolic
        !> The body axes x, y, z, and their signs.
        integer, private :: axis(3) = [1, 2, 3]
        real(dp), private :: sign_of(3) = 1
        !> Largest components of the angular velocity along x, y, z, rad/s.
        real(dp), private :: greatest(3) = 0
        !> The conjugate of the attitude relative to the momentum at the start, in the axes x, y, z.
        real(dp), private :: unturn(4) = 0
        !> Angular momentum, kg m^2/s.
        real(dp) :: momentum = 0
    contains
        procedure :: at
        procedure :: quaternion_at
    end type free_motion_t

contains

    !> Prepares the exact motion of a free body. `status` is `status_unsuitable` if the body is not free or
    !> has no inertia about an axis, or `status_non_finite`, `status_bad_body` or `status_bad_start`.
    pure subroutine prepare_free_motion(body, start, free, status)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        type(free_motion_t), intent(out) :: free !! the exact motion; evaluated with `free%at(t)`
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        status = body_status(body)
        if (is_ok(status)) status = start_status(start, body)
        if (is_ok(status) .and. .not. (body%is_free() .and. all(body%inertia > 0))) status = status_unsuitable
        if (.not. is_ok(status)) return
        free%time = start%t
        free%start = start%quaternion / norm2(start%quaternion)
        free%angle = start%angle
        free%inertia = body%inertia
        free%omega = start%omega
        free%momentum = norm2(body%inertia * start%omega)
        free%is_steady = is_steady(body%inertia, start%omega)
        free%greatest_rate = norm2(start%omega)
        free%least_rate = free%greatest_rate
        associate (momentum => body%inertia * start%omega)
            free%axis_angle = atan2(norm2(momentum(1:2)), momentum(3))
        end associate
        if (.not. free%is_steady) call set_series(free)
    end subroutine prepare_free_motion

    !> Whether the momentum has the direction of the angular velocity: then both stay as they are.
    pure logical function is_steady(inertia, omega)
        real(dp), intent(in) :: inertia(3), omega(3)
        integer :: i, j
        is_steady = .true.
        do i = 1, 3
            j = mod(i, 3) + 1
            is_steady = is_steady .and. (is_equal(inertia(i), inertia(j)) .or. is_zero(omega(i)) .or. is_zero(omega(j)))
        end do
    end function is_steady

    !> Chooses the series, and finds the constants.
    pure subroutine set_series(free)
        type(free_motion_t), intent(inout) :: free
        type(momentum_path_t) :: path
        real(xp) :: period
        type(free_values_t) :: values

        path = find_momentum_path(free%inertia, free%omega)
        free%axis = path%axis
        free%about = path%axis(3)
        free%sign_of = path%sign_of
        associate (total => path%total, inertia => path%inertia, a => path%a, b => path%b, c => path%c)
            free%greatest = real(total * [path%side * a, b, c] / inertia, dp)
            free%greatest_rate = norm2(free%greatest([1, 3]))
            free%least_rate = real(total * sqrt((b / inertia(2))**2 + (path%complement * c / inertia(3))**2), dp)
            free%axis_angle = angle_range(path%axis, real([a, b, c, path%complement * c], dp), free%sign_of(3))

            free%is_circular = path%complement >= least_complement
            if (free%is_circular) then
                call prepare_circular_series(free%circular, path)
                period = free%circular%period
            else
                call prepare_hyperbolic_series(free%hyperbolic, path)
                period = free%hyperbolic%period
            end if
            ! The dynamic phase, 2 E T/L, and the geometric one, which there is not on the separatrix.
            free%period = real(period, dp)
            free%turn = free%period
            if (is_finite(free%period)) free%turn = real(total * sum(path%part**2 / inertia) * period + path%geometric_turn(), dp)
        end associate
        call find_values(free, 0.0_xp, values)
        free%unturn = [real(values%upper, dp), -real(values%lower, dp), -aimag(values%lower), -aimag(values%upper)]
    end subroutine set_series

    !> Smallest and largest angle between body z and the momentum, rad.
    pure function angle_range(axis, part, sign_of_z) result(range)
        integer, intent(in) :: axis(3)
        real(dp), intent(in) :: part(4) !! largest parts of the momentum along x, y, z, and the smallest along z
        real(dp), intent(in) :: sign_of_z
        real(dp) :: range(2)
        if (axis(3) == 3) then
            range = [atan2(part(1), part(3)), atan2(part(2), part(4))]
            if (sign_of_z < 0) range = pi - range([2, 1])
        else
            range(1) = merge(atan2(part(3), part(1)), atan2(part(4), part(2)), axis(1) == 3)
            range(2) = pi - range(1)
        end if
    end function angle_range

    !> Bounds of the inclination of body z, rad, from those of its angle with the momentum. Body z turns about the
    !> momentum again and again, so it comes arbitrarily close to them, except on the separatrix, and where its turns
    !> fit into the period.
    pure function inclination_range(axis_angle, tilt) result(range)
        real(dp), intent(in) :: axis_angle(2) !! smallest and largest angle between body z and the momentum, rad
        real(dp), intent(in) :: tilt !! inclination of the momentum, rad
        real(dp) :: range(2)
        range(1) = max(0.0_dp, axis_angle(1) - tilt, tilt - axis_angle(2))
        range(2) = pi - max(0.0_dp, axis_angle(1) - (pi - tilt), (pi - tilt) - axis_angle(2))
    end function inclination_range

    !> The theta functions at a time since the start.
    pure subroutine find_values(free, elapsed, values)
        type(free_motion_t), intent(in) :: free
        real(xp), intent(in) :: elapsed
        type(free_values_t), intent(out) :: values
        if (free%is_circular) then
            call free%circular%evaluate(elapsed, values)
        else
            call free%hyperbolic%evaluate(elapsed, values)
        end if
    end subroutine find_values

    !> The unit quaternion at time t, s; continuous in time.
    pure function quaternion_at(self, t) result(q)
        class(free_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: q(4), omega(3)
        call find_state(self, t, q, omega)
    end function quaternion_at

    !> Attitude and angular velocity in body axes, rad/s, at time t, s.
    pure subroutine find_state(self, t, q, omega)
        type(free_motion_t), intent(in) :: self
        real(dp), intent(in) :: t
        real(dp), intent(out) :: q(4), omega(3)
        type(free_values_t) :: values
        real(dp) :: r(4), turned(4)
        omega = self%omega
        if (self%is_steady) then
            q = quaternion_product(self%start, steady_turn(self%omega, real(t, xp) - self%time))
            return
        end if
        call find_values(self, real(t, xp) - self%time, values)
        r = quaternion_product(self%unturn, [real(values%upper, dp), real(values%lower, dp), &
                                             aimag(values%lower), aimag(values%upper)])
        turned(1) = r(1)
        turned(1 + self%axis) = self%sign_of * r(2:4)
        q = quaternion_product(self%start, turned)
        omega(self%axis) = self%sign_of * self%greatest * values%elliptic
    end subroutine find_state

    !> The rotation by a constant angular velocity. Its angle is reduced before it is rounded.
    pure function steady_turn(omega, elapsed) result(q)
        real(dp), intent(in) :: omega(3)
        real(xp), intent(in) :: elapsed
        real(dp) :: q(4)
        real(xp) :: rate, half
        q = [1, 0, 0, 0]
        rate = sqrt(sum(real(omega, xp)**2))
        if (.not. rate > 0) return
        half = rate * elapsed / 2
        q = [real(cos(half), dp), real(sin(half) * (omega / rate), dp)]
    end function steady_turn

    !> The motion at time t, s. phi and psi are those nearest to the start: how often they turned in between
    !> is not counted.
    elemental type(motion_t) function at(self, t) result(motion)
        class(free_motion_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        motion%t = t
        call find_state(self, t, motion%quaternion, motion%omega)
        motion%omega_rate = cross(self%inertia * motion%omega, motion%omega) / self%inertia
        motion%angle = angles_from_quaternion(motion%quaternion, self%angle)
        motion%rate = rates_from_omega(motion%angle, motion%omega)
    end function at

end module spintop_free_motion
