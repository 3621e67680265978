!> Data and results of many undamped symmetric tops, and the scalar routine for one of them.
!>
!> The scalar routine uses the exact solution in extended precision and in all its forms. The vector loops of
!> `exact_block` are faster; they leave to it the cases that they cannot compute accurately.
module spintop_exact_cases
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_compare, only: is_finite
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t, motion_from_angles
    use spintop_quantities, only: kinetic_energy, potential_energy
    use spintop_status, only: is_ok, status_non_finite, status_ok
    implicit none
    private
    public :: exact_cases_t, compute_alone, block_size

    !> Maximum number of cases.
    integer, parameter :: block_size = 512

    !> Cases, one per element of each array, SI units and radians.
    type :: exact_cases_t
        !> Number of cases, up to `block_size`.
        integer :: n = 0
        !> Data: moments of inertia about the pivot (kg m^2), m g l (N m), inclination (rad), rates of phi and
        !> theta (rad/s), angular velocity about the body axis (rad/s), phi and psi (rad), end of the span
        !> (s), and a time for which phi is needed (s).
        real(dp), dimension(block_size) :: inertia1, inertia3, mgl, theta, phi_rate, theta_rate, &
            omega3, phi, psi, t_end, t_period
        !> Turning angles (rad), cos(theta_max), and cos(theta_min) - cos(theta_max) without cancellation.
        real(dp), dimension(block_size) :: theta_min, theta_max, u_min, delta_u
        !> Nutation period (s), change of phi per nutation (rad), mean precession rate, and the value of phi'
        !> that is largest in magnitude (rad/s).
        real(dp), dimension(block_size) :: period, precession, precession_rate, phi_rate_max
        !> Angles (rad) and nutation rate (rad/s) at `t_end`, and the change of energy since the start,
        !> relative to the kinetic energy at the start plus m g l.
        real(dp), dimension(block_size) :: theta_end, phi_end, psi_end, theta_rate_end, energy_error
        !> Change of phi from the start to `t_period`, rad.
        real(dp), dimension(block_size) :: phi_at_period
        !> Status of each case: `status_ok`, a status of `prepare_exact_motion`, or `status_non_finite` if a
        !> result is not finite. The period and the change of phi per period may be infinite (on the
        !> separatrix, and for an axis at rest).
        integer, dimension(block_size) :: status = status_ok
        !> Number of cases that were computed by the scalar routine.
        integer :: fallbacks = 0
    end type exact_cases_t

contains

    !> Computes case i by the scalar routine: the quantities of a whole nutation; with `wants_end` the motion
    !> at `t_end`; with `wants_period` phi at `t_period`. An index outside 1..n has no effect.
    subroutine compute_alone(self, i, wants_end, wants_period)
        class(exact_cases_t), intent(inout) :: self
        integer, intent(in) :: i !! the case, from 1 to `n`
        logical, intent(in) :: wants_end, wants_period !! whether the motion at `t_end` and phi at `t_period` are needed
        type(body_t) :: body
        type(motion_t) :: start, motion
        type(exact_motion_t) :: exact
        real(dp) :: energy, total

        if (i < 1 .or. i > min(self%n, block_size)) return
        self%fallbacks = self%fallbacks + 1
        body%inertia = [self%inertia1(i), self%inertia1(i), self%inertia3(i)]
        body%gravity = self%mgl(i)
        body%centre_of_mass(3) = 1
        start = motion_from_angles(0.0_dp, [self%phi(i), self%theta(i), self%psi(i)], &
            [self%phi_rate(i), self%theta_rate(i), &
             self%omega3(i) - self%phi_rate(i) * cos(self%theta(i))])
        call prepare_exact_motion(body, start, exact, self%status(i))
        if (.not. is_ok(self%status(i))) return

        associate (nutation => exact%nutation)
            self%theta_min(i) = nutation%theta_min
            self%theta_max(i) = nutation%theta_max
            self%u_min(i) = cos(nutation%theta_max)
            self%delta_u(i) = nutation%delta_u
            self%period(i) = nutation%period
            self%precession(i) = nutation%precession
            self%precession_rate(i) = nutation%precession_rate
            self%phi_rate_max(i) = nutation%phi_rate_max
        end associate
        if (wants_end) then
            motion = exact%at(self%t_end(i))
            self%phi_end(i) = motion%angle(1)
            self%theta_end(i) = motion%angle(2)
            self%psi_end(i) = motion%angle(3)
            self%theta_rate_end(i) = motion%rate(2)
            energy = kinetic_energy(body, start) + potential_energy(body, start)
            self%energy_error(i) = abs(kinetic_energy(body, motion) &
                + potential_energy(body, motion) - energy)
            if (self%energy_error(i) > 0) self%energy_error(i) = self%energy_error(i) &
                / (kinetic_energy(body, start) + self%mgl(i))
        end if
        if (wants_period) then
            motion = exact%at(self%t_period(i))
            self%phi_at_period(i) = motion%angle(1) - self%phi(i)
        end if
        ! Only the period, and the change of phi per period, may be infinite.
        total = self%theta_min(i) + self%theta_max(i) + self%precession_rate(i) &
                + self%phi_rate_max(i)
        if (wants_end) total = total + self%theta_end(i) + self%phi_end(i) + self%psi_end(i) &
                               + self%theta_rate_end(i) + self%energy_error(i)
        if (wants_period) total = total + self%phi_at_period(i)
        if (.not. is_finite(total)) self%status(i) = status_non_finite
    end subroutine compute_alone

end module spintop_exact_cases
