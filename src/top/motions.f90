!> The motion of a body at several instants at once: each number is a vector over the instants, so that all are computed by
!> the same instructions. And the slopes of its heights, rates and forces, which vanish where there is an extreme.
module spintop_motions
    use spintop_body, only: body_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: motions_t, instants
    public :: axis_slopes, centre_slopes, precession_slopes, nutation_slopes, find_force_slopes, verticals

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

    !> The slope of the height of body z, over its length: it vanishes at the turning points of theta.
    pure function axis_slopes(motions) result(slope)
        type(motions_t), intent(in) :: motions !! the motion in the axes in which the body was given
        real(dp) :: slope(instants), gamma(instants, 3)
        gamma = verticals(motions%quaternion)
        slope = gamma(:, 1) * motions%omega(:, 2) - gamma(:, 2) * motions%omega(:, 1)
    end function axis_slopes

    !> The slope of the height of the centre of mass.
    pure function centre_slopes(body, motions) result(slope)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motions_t), intent(in) :: motions !! the motion in principal axes
        real(dp) :: slope(instants), gamma1(instants, 3)
        gamma1 = cross_of_all(verticals(motions%quaternion), motions%omega)
        associate (r => body%centre_of_mass)
            slope = r(1) * gamma1(:, 1) + r(2) * gamma1(:, 2) + r(3) * gamma1(:, 3)
        end associate
    end function centre_slopes

    !> Angular acceleration of phi times sin(theta)^4, which is smooth at the poles; from phi' = (gamma1
    !> omega1 + gamma2 omega2)/sin(theta)^2.
    pure function precession_slopes(motions) result(slope)
        type(motions_t), intent(in) :: motions !! the motion in the axes in which the body was given
        real(dp), dimension(instants) :: slope, turn, sine2
        real(dp), dimension(instants, 3) :: gamma, gamma1
        gamma = verticals(motions%quaternion)
        gamma1 = cross_of_all(gamma, motions%omega)
        associate (w => motions%omega, b => motions%omega_rate)
            turn = gamma(:, 1) * w(:, 1) + gamma(:, 2) * w(:, 2)
            sine2 = gamma(:, 1)**2 + gamma(:, 2)**2
            slope = ((gamma1(:, 1) * w(:, 1) + gamma1(:, 2) * w(:, 2)) + (gamma(:, 1) * b(:, 1) + gamma(:, 2) * b(:, 2))) &
                    * sine2 - 2 * turn * (gamma(:, 1) * gamma1(:, 1) + gamma(:, 2) * gamma1(:, 2))
        end associate
    end function precession_slopes

    !> The slope of the nutation rate, but for a positive factor and its sign: with w = gamma3' and d = gamma1^2 +
    !> gamma2^2, theta'^2 = w^2/d.
    pure function nutation_slopes(motions) result(slope)
        type(motions_t), intent(in) :: motions !! the motion in the axes in which the body was given
        real(dp), dimension(instants) :: slope, bend
        real(dp), dimension(instants, 3) :: gamma, gamma1
        gamma = verticals(motions%quaternion)
        gamma1 = cross_of_all(gamma, motions%omega)
        associate (w => motions%omega, b => motions%omega_rate)
            bend = gamma1(:, 1) * w(:, 2) - gamma1(:, 2) * w(:, 1) + gamma(:, 1) * b(:, 2) - gamma(:, 2) * b(:, 1)
            slope = bend * (gamma(:, 1)**2 + gamma(:, 2)**2) + gamma(:, 3) * gamma1(:, 3)**2
        end associate
    end function nutation_slopes

    !> The slopes of the vertical force and of the square of the force, over mass and twice its square.
    pure subroutine find_force_slopes(body, motions, vertical, square)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motions_t), intent(in) :: motions !! the motion in principal axes
        real(dp), dimension(instants), intent(out) :: vertical, square !! slopes of the vertical force, and of the squared force
        real(dp), dimension(instants, 3) :: w, b, r, gamma, gamma1, gamma3, b1, wr, br, force, force1
        integer :: m

        w = motions%omega
        b = motions%omega_rate
        do m = 1, 3
            r(:, m) = body%centre_of_mass(m)
        end do
        gamma = verticals(motions%quaternion)
        gamma1 = cross_of_all(gamma, w)
        b1 = cross_of_all(momenta(b), w) + cross_of_all(momenta(w), b) + body%mass * body%gravity * cross_of_all(gamma1, r)
        do m = 1, 3
            b1(:, m) = (b1(:, m) - body%damping(m) * b(:, m)) / body%inertia(m)
        end do
        gamma3 = cross_of_all(cross_of_all(gamma1, w) + cross_of_all(gamma, b), w) + 2 * cross_of_all(gamma1, b) &
                 + cross_of_all(gamma, b1)
        wr = cross_of_all(w, r)
        br = cross_of_all(b, r)
        force = br + cross_of_all(w, wr) + body%gravity * gamma
        force1 = cross_of_all(b1, r) + cross_of_all(b, wr) + cross_of_all(w, br) + body%gravity * gamma1
        vertical = r(:, 1) * gamma3(:, 1) + r(:, 2) * gamma3(:, 2) + r(:, 3) * gamma3(:, 3)
        square = force(:, 1) * force1(:, 1) + force(:, 2) * force1(:, 2) + force(:, 3) * force1(:, 3)

    contains

        !> Products with the moments of inertia.
        pure function momenta(rates)
            real(dp), intent(in) :: rates(instants, 3)
            real(dp) :: momenta(instants, 3)
            integer :: k
            do k = 1, 3
                momenta(:, k) = body%inertia(k) * rates(:, k)
            end do
        end function momenta

    end subroutine find_force_slopes

    !> Upward vertical in body axes.
    pure function verticals(q) result(gamma)
        real(dp), intent(in) :: q(instants, 4) !! quaternions, scalar part first
        real(dp) :: gamma(instants, 3)
        gamma(:, 1) = 2 * (q(:, 2) * q(:, 4) - q(:, 1) * q(:, 3))
        gamma(:, 2) = 2 * (q(:, 3) * q(:, 4) + q(:, 1) * q(:, 2))
        gamma(:, 3) = (q(:, 1)**2 + q(:, 4)**2) - (q(:, 2)**2 + q(:, 3)**2)
    end function verticals

    !> Vector products.
    pure function cross_of_all(a, b) result(c)
        real(dp), intent(in) :: a(instants, 3), b(instants, 3) !! vectors
        real(dp) :: c(instants, 3)
        c(:, 1) = a(:, 2) * b(:, 3) - a(:, 3) * b(:, 2)
        c(:, 2) = a(:, 3) * b(:, 1) - a(:, 1) * b(:, 3)
        c(:, 3) = a(:, 1) * b(:, 2) - a(:, 2) * b(:, 1)
    end function cross_of_all

end module spintop_motions
