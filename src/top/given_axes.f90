!> The axes in which a body was given, as seen from those of the computation.
module spintop_given_axes
    use spintop_attitude, only: conjugate_quaternion, quaternion_product, to_space, vertical_from_quaternion
    use spintop_kinds, only: dp, cross
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: given_axes_t, about_z, unshifted

    !> The axes in which a body was given.
    type :: given_axes_t
        !> Whether body z is another axis there, so that phi and psi have turns of their own.
        logical :: differ = .false.
        !> The quaternion of the rotation to the axes of the computation, and what is added to the rates of phi and psi in
        !> these, rad/s.
        real(dp) :: p(4) = [1, 0, 0, 0], phi_shift = 0, psi_shift = 0
    contains
        procedure :: seen
    end type given_axes_t

contains

    !> A motion of the computation in the given axes, but for its angles and their rates.
    pure type(motion_t) function seen(self, motion)
        class(given_axes_t), intent(in) :: self
        type(motion_t), intent(in) :: motion !! in the axes of the computation
        seen = unshifted(self%phi_shift, self%psi_shift, motion)
        seen%quaternion = quaternion_product(seen%quaternion, self%p)
        seen%omega = to_space(conjugate_quaternion(self%p), seen%omega)
        seen%omega_rate = to_space(conjugate_quaternion(self%p), seen%omega_rate)
    end function seen

    !> A motion whose rates of phi and psi are smaller, with the angular acceleration.
    pure type(motion_t) function unshifted(phi_shift, psi_shift, motion) result(other)
        real(dp), intent(in) :: phi_shift, psi_shift !! what the rates of phi and psi lose, rad/s
        type(motion_t), intent(in) :: motion !! the motion
        real(dp) :: phi, psi, gamma(3), total(3)
        other = motion
        phi = phi_shift * motion%t
        psi = psi_shift * motion%t
        other%angle = motion%angle - [phi, 0.0_dp, psi]
        other%rate = motion%rate - [phi_shift, 0.0_dp, psi_shift]
        other%quaternion = quaternion_product(about_z(-phi), quaternion_product(motion%quaternion, about_z(-psi)))
        gamma = vertical_from_quaternion(other%quaternion)
        total = components(motion%omega, psi)
        other%omega = total - phi_shift * gamma
        other%omega(3) = other%omega(3) - psi_shift
        other%omega_rate = components(motion%omega_rate, psi) + psi_shift * [-total(2), total(1), 0.0_dp] &
            - phi_shift * cross(gamma, other%omega)
    end function unshifted

    !> The rotation about z by an angle.
    pure function about_z(angle) result(q)
        real(dp), intent(in) :: angle !! rotation angle, rad
        real(dp) :: q(4)
        q = [cos(angle / 2), 0.0_dp, 0.0_dp, sin(angle / 2)]
    end function about_z

    !> Components of a vector in axes that are turned back about z by an angle.
    pure function components(v, angle) result(w)
        real(dp), intent(in) :: v(3), angle
        real(dp) :: w(3)
        w = [v(1) * cos(angle) - v(2) * sin(angle), v(1) * sin(angle) + v(2) * cos(angle), v(3)]
    end function components

end module spintop_given_axes
