!> The paper's formulas for a fast top released at rest (Eqs 29-32 and 54).
!>
!> They hold where (I3 omega3)^2 is much greater than 2 I1 mgl; the paper's own criterion,
!> I3 omega3^2/2 much greater than 2 mgl (Eqs 28, 53), lacks the factor I3/I1.
module spintop_fast_top
    use spintop_kinds, only: dp, pi
    use spintop_body, only: body_t
    implicit none
    private
    public :: fast_top_t, fast_top

    !> Approximate motion of a fast top; infinite or zero where a divisor vanishes.
    type :: fast_top_t
        !> Range of cos(theta), Eq 29.
        real(dp) :: delta_u
        !> Nutation frequency, rad/s, Eq 30.
        real(dp) :: nutation_rate
        !> Mean precession rate, rad/s, Eq 32.
        real(dp) :: precession_rate
        !> Nutations in a full turn of precession, Eq 54.
        real(dp) :: nutations_per_turn
        !> Time of a full turn at the mean precession rate, s ("T_p").
        real(dp) :: precession_period
        !> (I3 omega3)^2/(2 I1 mgl): large for a fast top.
        real(dp) :: ratio
        !> I3 omega3^2/(4 mgl): the paper's measure.
        real(dp) :: ratio_of_paper
    end type fast_top_t

contains

    !> The formulas for a start at inclination `theta` with axial angular velocity `omega3`.
    elemental type(fast_top_t) function fast_top(body, theta, omega3) result(motion)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: theta, omega3 !! inclination at the start, rad; axial angular velocity, rad/s
        associate (mgl => body%mgl(), i1 => body%inertia(1), i3 => body%inertia(3))
            motion%delta_u = (i1 / i3) * (2 * mgl / (i3 * omega3**2)) * sin(theta)**2
            motion%nutation_rate = i3 * omega3 / i1
            motion%precession_rate = mgl / (i3 * omega3)
            motion%nutations_per_turn = (i3 * omega3)**2 / (i1 * mgl)
            motion%precession_period = 2 * pi * i3 * omega3 / mgl
            motion%ratio = (i3 * omega3)**2 / (2 * i1 * mgl)
            motion%ratio_of_paper = i3 * omega3**2 / (4 * mgl)
        end associate
    end function fast_top

end module spintop_fast_top
