!> Theta functions of a free rigid body: what the circular and the hyperbolic series share.
!>
!> With k and k' the modulus and the complementary modulus of the momentum's elliptic functions sn, cn, dn, the
!> attitude needs theta functions of the square of the nome (circular series, k' >= 0.17) or of the square root
!> of the complementary nome (hyperbolic series, k' below that, and k' = 0). So a few terms suffice for extended
!> precision.
!> Source: Whittaker and Watson, A Course of Modern Analysis, chapters XXI and XXII.
module spintop_free_theta
    use spintop_kinds, only: dp, xp, pi_xp
    implicit none
    private
    public :: free_values_t, sum_a, sum_b, normalize, unit, last_elliptic, most_iterations

    !> Index of the last term of series in powers n (n+1) of the nome of the elliptic functions.
    integer, parameter :: last_elliptic = 5
    !> Bound of the iterations for a constant; each gains two digits or more.
    integer, parameter :: most_iterations = 60

    !> The theta functions at one time: the Cayley-Klein components q0 + i q3 and q1 + i q2 relative to the momentum,
    !> and (cn, sn, dn).
    type :: free_values_t
        complex(dp) :: upper = 1, lower = 0
        real(dp) :: elliptic(3) = 0
    end type free_values_t

contains

    !> A = 1 + sum (-1)^n p^(n^2+n) A_n, A_n = sin((2n+1)v)/sin(v).
    pure real(xp) function sum_a(p, v)
        real(xp), intent(in) :: p, v !! nome, and argument
        sum_a = alternating_sum(p, cos(2 * v), 1, -1)
    end function sum_a

    !> B = 1 + sum p^(n^2+n) B_n, B_n = cos((2n+1)v)/cos(v).
    pure real(xp) function sum_b(p, v)
        real(xp), intent(in) :: p, v !! nome, and argument
        sum_b = alternating_sum(p, cos(2 * v), -1, 1)
    end function sum_b

    !> 1 + sum signs^n p^(n^2+n) x_n, x_0 = 1, x_1 = 2f + offset, x_(n+1) = 2f x_n - x_(n-1).
    pure real(xp) function alternating_sum(p, f, offset, signs)
        real(xp), intent(in) :: p, f
        integer, intent(in) :: offset, signs
        real(xp) :: before, now, next
        integer :: n
        alternating_sum = 1
        before = 1
        now = 2 * f + offset
        do n = 1, last_elliptic
            alternating_sum = alternating_sum + signs**n * p**(n * (n + 1)) * now
            next = 2 * f * now - before
            before = now
            now = next
        end do
    end function alternating_sum

    !> exp(i chi) (F+, F-)/norm.
    pure subroutine normalize(chi, upper, lower, values)
        real(xp), intent(in) :: chi !! phase, rad; reduced before it is rounded
        complex(dp), intent(in) :: upper, lower !! F+ and F-
        type(free_values_t), intent(inout) :: values !! the components are set
        complex(dp) :: turn
        real(dp) :: norm
        turn = unit(chi)
        norm = sqrt(real(upper, dp)**2 + aimag(upper)**2 + real(lower, dp)**2 + aimag(lower)**2)
        values%upper = turn * upper / norm
        values%lower = turn * lower / norm
    end subroutine normalize

    !> exp(i angle), the angle reduced before it is rounded.
    pure complex(dp) function unit(angle)
        real(xp), intent(in) :: angle !! the angle, rad
        real(dp) :: reduced
        reduced = real(angle - (2 * pi_xp) * anint(angle / (2 * pi_xp)), dp)
        unit = cmplx(cos(reduced), sin(reduced), dp)
    end function unit

end module spintop_free_theta
