!> Sine and cosine of half a rotation angle, as splitting methods need them: small angles, known by
!> their squares, and cos(x) - 1 without cancellation.
module spintop_small_turn
    use spintop_kinds, only: dp
    implicit none
    private
    public :: half_turn

    !> Largest square of an angle for which the Taylor series, with as many terms, are exact to rounding.
    real(dp), parameter :: largest_square = 1
    !> (-1)^k/(2 k + 1)! and (-1)^k/(2 k)!: sin(x)/x and cos(x) are the sums of these times x^(2 k).
    real(dp), parameter :: s1 = -1 / 6.0_dp, s2 = -s1 / 20, s3 = -s2 / 42, s4 = -s3 / 72, &
        s5 = -s4 / 110, s6 = -s5 / 156, s7 = -s6 / 210, s8 = -s7 / 272, s9 = -s8 / 342
    real(dp), parameter :: c1 = -1 / 2.0_dp, c2 = -c1 / 12, c3 = -c2 / 30, c4 = -c3 / 56, &
        c5 = -c4 / 90, c6 = -c5 / 132, c7 = -c6 / 182, c8 = -c7 / 240, c9 = -c8 / 306

contains

    !> For the square of an angle x: `sinc` = sin(x)/x and `drop` = cos(x) - 1.
    pure subroutine half_turn(square, sinc, drop)
        real(dp), intent(in) :: square !! square of the angle x, rad^2
        real(dp), intent(out) :: sinc, drop !! sin(x)/x and cos(x) - 1
        real(dp) :: x, x4, x8

        if (square > largest_square) then
            x = sqrt(square)
            sinc = sin(x) / x
            drop = -2 * sin(x / 2)**2
        else
            ! In the order of Estrin: half the latency of Horner's.
            x4 = square**2
            x8 = x4**2
            sinc = ((1 + s1 * square) + (s2 + s3 * square) * x4) &
                   + x8 * (((s4 + s5 * square) + (s6 + s7 * square) * x4) + x8 * (s8 + s9 * square))
            drop = square * (((c1 + c2 * square) + (c3 + c4 * square) * x4) &
                + x8 * (((c5 + c6 * square) + (c7 + c8 * square) * x4) + x8 * c9))
        end if
    end subroutine half_turn

end module spintop_small_turn
