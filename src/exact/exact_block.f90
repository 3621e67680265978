!> The exact motion of many symmetric tops without damping at once, in double precision.
!>
!> Form 2a of the closed solution (theta functions in circular functions of time, see
!> `circular_form`) as stages, each a loop over lanes that the compiler turns into vector
!> instructions: no branches, no calls. The nome's series go up to q = 0.28, k^2 = 0.993. Symbols
!> as in `turning_points` and `circular_form`. A case that the stages cannot give to
!> `block_accuracy` goes to the scalar routine, which works in extended precision everywhere.
!>
!> A case has the same bits wherever it stands in a block and whatever its neighbours are.
!>
!> Sources: Klein and Sommerfeld, Ueber die Theorie des Kreisels, chapter VI; Whittaker and Watson,
!> A Course of Modern Analysis, chapters XXI and XXII; W. J. Cody and W. Waite, Software Manual for
!> the Elementary Functions, 1980.
module spintop_exact_block
    use spintop_kinds, only: dp, pi
    use spintop_status, only: status_ok
    use spintop_exact_lane, only: lane_t, compute_lane
    implicit none
    private
    public :: exact_block_t, block_size, block_accuracy

    !> Cases in a block.
    integer, parameter :: block_size = 512
    !> Relative error of a quantity, or absolute error in radians, whichever is larger, where the
    !> rounding of long phases (rate times time) does not outweigh it.
    real(dp), parameter :: block_accuracy = 5.0e-13_dp

    !> Lanes that go through all stages together: their intermediate results fit the first cache.
    integer, parameter :: lanes = 64
    !> Largest nome for which the series below are complete to 3e-14.
    real(dp), parameter :: largest_nome = 0.28_dp
    !> Largest argument of the theta functions that the reduction by quadrants takes, rad.
    real(dp), parameter :: largest_argument = 1.0e6_dp
    !> Where b - a (or b + a), the distance at which the axis passes a pole, keeps less than this
    !> of the terms it is the difference of, its digits are gone.
    real(dp), parameter :: least_difference = 1.0e-3_dp
    !> A theta function smaller than this, squared and relative to its largest value, is close to
    !> its zero, a pole of the sphere, where phi and psi turn too fast for double precision.
    real(dp), parameter :: least_theta = 1.0e-5_dp

    !> Cases, one per element of each array, SI units and radians. Whoever has many cases keeps one
    !> such block per thread, sets `n` and the data, and calls `compute`.
    type :: exact_block_t
        !> Number of cases, up to `block_size`.
        integer :: n = 0
        !> Data: moments of inertia about the pivot (kg m^2), m g l (N m), inclination (rad), rates
        !> of phi and theta (rad/s), angular velocity about the body axis (rad/s), phi and psi
        !> (rad), the end of the span (s), and a time at which phi is wanted (s).
        real(dp), dimension(block_size) :: inertia1, inertia3, mgl, theta, phi_rate, theta_rate, &
            omega3, phi, psi, t_end, t_period
        !> Turning angles (rad), the cosine of the larger and their difference's.
        real(dp), dimension(block_size) :: theta_min, theta_max, u_min, delta_u
        !> Nutation period (s), what it adds to phi (rad), mean precession rate, and the value of
        !> phi' largest in size (rad/s).
        real(dp), dimension(block_size) :: period, precession, precession_rate, phi_rate_max
        !> Angles (rad) and nutation rate (rad/s) at `t_end`, and how much the energy there differs
        !> from the energy at the start, relative to the start's kinetic energy plus m g l.
        real(dp), dimension(block_size) :: theta_end, phi_end, psi_end, theta_rate_end, energy_error
        !> phi at `t_period` less phi at the start, rad.
        real(dp), dimension(block_size) :: phi_at_period
        !> How each case ended: `status_ok` or what `prepare_exact_motion` says. Without
        !> `status_ok` the case's results mean nothing.
        integer, dimension(block_size) :: status = status_ok
        !> Cases that went to the scalar routine.
        integer :: fallbacks = 0
    contains
        procedure :: compute
        procedure, private :: fill_last_strip
        procedure, private :: compute_alone
    end type exact_block_t

    !> A pole of the sphere as seen by the motion: its theta function
    !> Theta = least + 2 h P(c) + i side Q(c) sin 2z, polynomials P and Q (coefficients `even` and
    !> `odd`) in c = cos 2z and h = sin(z)^2 for theta = pi, c = -cos 2z, h = cos(z)^2 for theta = 0.
    type :: pole_t
        !> The datum that places the pole in the complex argument ("eps"), and the factor of its
        !> sc function, times sqrt(k').
        real(dp), dimension(lanes) :: excess, scale
        !> Theta where the axis is nearest to the pole, and where it is farthest; the slope of the
        !> latter's logarithm times it ("D S"), and the same where it is nearest ("D' S'").
        real(dp), dimension(lanes) :: least, largest, slope, slope_nearest
        real(dp), dimension(lanes, 0:4) :: even, odd
        !> The sign of the turn about the pole.
        real(dp), dimension(lanes) :: side
        !> Factor of |Theta|^2 in 1 + u (1 - u), up to a common one.
        real(dp), dimension(lanes) :: weight
    end type pole_t

    !> A strip of cases on its way through the stages.
    type :: strip_t
        !> 0 for the cases that the stages serve well.
        real(dp), dimension(lanes) :: doubt
        !> 1 - u0, 1 + u0; a, beta; phi0' sin^2, K0 and b -+ a.
        real(dp), dimension(lanes) :: sh, ch, a, beta, turn, k0, b_minus_a, b_plus_a
        !> The cubic beta y^3 + g2 y^2 + g1 y + g0 of y = u - u0: its roots y1 <= 0 <= y2, their
        !> difference, and y3 times beta.
        real(dp), dimension(lanes) :: g0, g1, g2, y1, y2, d, beta_y3
        !> 1 - u1, 1 - u2, 1 + u1, 1 + u2.
        real(dp), dimension(lanes) :: m1, d2, p1, p2
        !> Modulus, nome, and rate of the argument.
        real(dp), dimension(lanes) :: k2, kc, sqrt_kc, q, omega, zeta
        !> Argument at the start.
        real(dp), dimension(lanes) :: z0
        !> Mean rates of phi and psi, and the arguments of the theta functions at the start that
        !> belong to them.
        real(dp), dimension(lanes) :: phi_speed, psi_speed, phi_start, psi_start
        !> u' = swing sum/(sum of the poles' weight |Theta|^2)^2.
        real(dp), dimension(lanes) :: swing
        type(pole_t) :: bottom, top
    end type strip_t

    !> The theta functions at one time.
    type :: instant_t
        real(dp), dimension(lanes) :: z, sine2, cosine2, sine_of_2z
        !> Real and imaginary parts for the two poles.
        real(dp), dimension(lanes) :: bottom_re, bottom_im, top_re, top_im
        !> Sum and difference of their arguments.
        real(dp), dimension(lanes) :: phi, psi
    end type instant_t

contains

    !> Computes all cases of the block: the quantities of the whole nutation, with `wants_end` the
    !> motion at `t_end` and with `wants_period` phi at `t_period`.
    subroutine compute(self, wants_end, wants_period)
        class(exact_block_t), intent(inout) :: self
        logical, intent(in) :: wants_end, wants_period
        type(strip_t) :: strip
        integer :: first, i

        call self%fill_last_strip()
        self%fallbacks = 0
        do first = 0, self%n - 1, lanes
            call describe_start(self, first, strip)
            call find_roots(strip)
            if (any(strip%g0 > 0)) call find_roots_of_moving(strip)
        end do
        i = 0
        if (wants_end .and. wants_period) i = 1
        if (i > 1) call self%compute_alone(i, wants_end, wants_period)
    end subroutine compute
