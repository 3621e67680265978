!> The path of the angular momentum of a free body in the body, an intersection of a sphere with an ellipsoid of energy.
!>
!> The momentum circulates about the principal axis of smallest or of largest inertia, here axis z of the axes x, y, z; in
!> units of its magnitude it is (s a cn, b sn, c dn), up to signs.
module spintop_momentum_path
    use spintop_kinds, only: dp, pi_xp, xp
    implicit none
    private
    public :: momentum_path_t, find_momentum_path

    !> The path, and the axes in which it is described.
    type :: momentum_path_t
        !> Numbers of the body axes x, y, z.
        integer :: axis(3) = [1, 2, 3]
        !> Signs of the components at the start along x and z, and that of y which leaves the axes right-handed.
        real(dp) :: sign_of(3) = 1
        !> Side s: +1 about the axis of largest inertia, -1 about that of smallest inertia.
        real(xp) :: side = 1
        !> Moments of inertia along x, y, z, kg m^2, and the magnitude of the momentum, kg m^2/s.
        real(xp) :: inertia(3) = 1, total = 0
        !> Components at the start in units of the magnitude, with their signs.
        real(xp) :: part(3) = 0
        !> Differences of the inverse moments |1/I_x - 1/I_z| and |1/I_y - 1/I_z|.
        real(xp) :: d_xz = 0, d_yz = 0
        !> Largest components, modulus k and complementary modulus k' of the elliptic functions.
        real(xp) :: a = 0, b = 0, c = 0, modulus = 0, complement = 1
        !> Rate of the argument of the elliptic functions, rad/s; a/(1+c); twice the steady part of the phase's rate, rad/s.
        real(xp) :: frequency = 0, ratio = 0, spin = 0
    contains
        procedure :: geometric_turn
    end type momentum_path_t

contains

    !> The path of a momentum that is not along a principal axis of the body.
    pure type(momentum_path_t) function find_momentum_path(body_inertia, body_omega) result(path)
        real(dp), intent(in) :: body_inertia(3) !! moments of inertia in body axes, kg m^2; not all equal
        real(dp), intent(in) :: body_omega(3) !! angular velocity in body axes, rad/s
        real(xp) :: inertia(3), omega(3), momentum(3), excess, d_xy
        integer :: axis(3)

        ! The body axes in the order of their inertia.
        axis([1, 3]) = [minloc(body_inertia, dim=1), maxloc(body_inertia, dim=1, back=.true.)]
        axis(2) = 6 - axis(1) - axis(3)
        inertia = body_inertia(axis)
        omega = body_omega(axis)
        ! The only difference of products: its sign is the class of the motion, its zero the separatrix.
        excess = inertia(3) * (inertia(3) - inertia(2)) * omega(3)**2 &
                 - inertia(1) * (inertia(2) - inertia(1)) * omega(1)**2
        if (excess < 0 .or. (.not. excess > 0 .and. .not. inertia(3) > inertia(2))) then
            path%side = -1
            axis([1, 3]) = axis([3, 1])
            excess = -excess
            inertia = body_inertia(axis)
            omega = body_omega(axis)
        end if
        path%axis = axis
        path%inertia = inertia
        momentum = inertia * omega
        path%total = sqrt(sum(momentum**2))
        path%sign_of(1) = real(path%side * sign(1.0_xp, momentum(1)), dp)
        path%sign_of(3) = real(sign(1.0_xp, momentum(3)), dp)
        path%sign_of(2) = path%sign_of(1) * path%sign_of(3) * merge(1, -1, modulo(axis(2) - axis(1), 3) == 1)
        path%part = [abs(momentum(1)), path%sign_of(2) * momentum(2), abs(momentum(3))] / path%total

        d_xy = abs(inertia(1) - inertia(2)) / (inertia(1) * inertia(2))
        path%d_xz = abs(inertia(1) - inertia(3)) / (inertia(1) * inertia(3))
        path%d_yz = abs(inertia(2) - inertia(3)) / (inertia(2) * inertia(3))
        associate (part => path%part, d_xz => path%d_xz, d_yz => path%d_yz)
            path%a = sqrt(part(1)**2 + part(2)**2 * (d_yz / d_xz))
            path%b = sqrt(part(2)**2 + part(1)**2 * (d_xz / d_yz))
            path%c = sqrt(part(3)**2 + part(2)**2 * (d_xy / d_xz))
            path%modulus = path%b * sqrt(d_xy / d_xz) / path%c
        end associate
        path%frequency = path%total * path%c * sqrt(path%d_xz * path%d_yz)
        path%ratio = path%a / (1 + path%c)
        path%spin = path%total * (path%c / inertia(3) + path%ratio * path%a / inertia(1))
        path%complement = sqrt(inertia(3) * excess / abs(inertia(3) - inertia(2))) / (path%total * path%c)
    end function find_momentum_path

    !> The geometric phase, rad: the turn of axis z about the momentum in a period, less 2 E T/L (Montgomery, How much does the
    !> rigid body rotate?, Am. J. Phys. 59, 1991). It is the integral of L_z/L over the angle of the momentum about axis z, that
    !> is 2 pi less the solid angle of the path about axis z, with the sign of s:
    !>
    !>     4 s c nu times the integral of dn^2/(cn^2 + nu^2 sn^2) over a quarter of the period,    nu = b/a,
    !>
    !> a complete elliptic integral of positive terms. Not on the separatrix, where the period is infinite.
    pure real(xp) function geometric_turn(self) result(turn)
        class(momentum_path_t), intent(in) :: self
        real(xp) :: ratio
        ratio = self%d_xz / self%d_yz
        turn = 4 * self%side * self%c * sqrt(ratio) * complete_integral(self%complement, ratio, 1.0_xp, self%complement**2)
    end function geometric_turn

    !> The integral of (a cos^2 + b sin^2)/((cos^2 + p sin^2) sqrt(cos^2 + kc^2 sin^2)) from 0 to pi/2
    !> (Bulirsch, Numerical calculation of elliptic integrals and elliptic functions III, Numer. Math. 13, 1969: cel).
    pure real(xp) function complete_integral(complement, p_given, a_given, b_given) result(integral)
        real(xp), intent(in) :: complement !! kc, above zero
        real(xp), intent(in) :: p_given, a_given, b_given !! p, a and b, which are not negative
        integer, parameter :: most_iterations = 60
        real(xp) :: kc, p, a, b, e, f, g, m
        integer :: iteration
        kc = complement
        e = kc
        m = 1
        p = sqrt(p_given)
        a = a_given
        b = b_given / p
        do iteration = 1, most_iterations
            f = a
            a = a + b / p
            g = e / p
            b = 2 * (b + f * g)
            p = p + g
            g = m
            m = m + kc
            if (abs(g - kc) <= g * sqrt(epsilon(g))) exit
            kc = 2 * sqrt(e)
            e = kc * m
        end do
        integral = pi_xp / 2 * (b + a * m) / (m * (m + p))
    end function complete_integral

end module spintop_momentum_path
