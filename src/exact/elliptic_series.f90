!> The nome of an elliptic modulus and the few series of it that the exact motion needs.
!>
!> The exact motion uses a modulus only up to k^2 = 1/2 (beyond, the complementary one), so every
!> nome is at most exp(-pi) = 0.0433 and a handful of terms reaches extended precision.
!> Source: Whittaker and Watson, A Course of Modern Analysis, chapters XXI and XXII.
module spintop_elliptic_series
    use spintop_kinds, only: xp
    implicit none
    private
    public :: nome, theta3_constant, quotient

    !> Coefficients of the nome's series in the fourth power of its leading term: enough for
    !> extended precision up to k^2 = 1/2.
    real(xp), parameter :: nome_coefficients(0:5) = [real(xp) :: 1, 2, 15, 150, 1707, 20910]

contains

    !> Nome q = exp(-pi K'/K) from k^2 <= 1/2 and the complementary modulus k'.
    elemental real(xp) function nome(k_squared, complement) result(q)
        real(xp), intent(in) :: k_squared, complement
        real(xp) :: leading, t
        integer :: n
        leading = k_squared / (2 * (1 + complement) * (1 + sqrt(complement))**2)
        t = leading**4
        q = 0
        do n = ubound(nome_coefficients, 1), 0, -1
            q = nome_coefficients(n) + q * t
        end do
        q = leading * q
    end function nome

    !> The constant theta_3(q) = 1 + 2 q + 2 q^4 + 2 q^9 + ...
    elemental real(xp) function theta3_constant(q)
        real(xp), intent(in) :: q
        theta3_constant = 1 + 2 * (q + q**4 + q**9)
    end function theta3_constant

    !> a/b, where 0/0 is 0: the limits of the exact motion at rest, on a pole and without gravity.
    elemental real(xp) function quotient(a, b)
        real(xp), intent(in) :: a, b
        quotient = 0
        if (abs(a) > 0) quotient = a / b
    end function quotient

end module spintop_elliptic_series
