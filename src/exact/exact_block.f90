!> The exact solution of many undamped symmetric tops together, in double precision.
!>
!> A kernel computes the solution in circular functions (`closed_form.h`), up to k^2 = 0.99, of as many cases at once as the
!> processor has room for. A case that it may not compute to `block_accuracy` is computed by the scalar routine, which works
!> in extended precision and in all forms. The result of a case has the same bits at every position in a block and for all
!> neighbours.
!>
!>     block%n = 2;  block%theta(1:2) = ...
!>     call compute_block(block, wants_end=.true., wants_period=.false.)
!>     if (is_ok(block%status(1))) then; ... = block%theta_max(1)
module spintop_exact_block
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_kinds, only: dp, is_finite
    use spintop_kernel_types, only: block_size, exact_block_t
    use spintop_body, only: body_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t, motion_from_angles
    use spintop_quantities, only: kinetic_energy, potential_energy
    use spintop_status, only: is_ok, status_bad_input, status_non_finite, status_ok
    implicit none
    private
    public :: exact_block_t, block_size, block_accuracy, compute_block

    !> Largest error of a quantity, relative or in radians, whichever is larger, in addition to the effect of
    !> a change of all rates (or of the time) by four rounding errors.
    real(dp), parameter :: block_accuracy = 5.0e-13_dp

    interface
        subroutine find_tops(wants_end, wants_period, block) bind(C, name='spintop_find_tops')
            import :: c_int, exact_block_t
            integer(c_int), value :: wants_end, wants_period
            type(exact_block_t), intent(inout) :: block
        end subroutine find_tops
    end interface

contains

    !> Computes all cases of the block: the quantities of a whole nutation; with `wants_end` the motion at
    !> `t_end`; with `wants_period` phi at `t_period`. If `n` is not a possible number of cases, nothing is
    !> computed and every status is `status_bad_input`.
    subroutine compute_block(block, wants_end, wants_period)
        type(exact_block_t), intent(inout) :: block !! the cases
        logical, intent(in) :: wants_end, wants_period !! whether the motion at `t_end` and phi at `t_period` are needed
        integer :: i

        block%fallbacks = 0
        if (block%n < 0 .or. block%n > block_size) then
            block%status = status_bad_input
            return
        end if
        call find_tops(merge(1_c_int, 0_c_int, wants_end), merge(1_c_int, 0_c_int, wants_period), block)
        do i = 1, block%n
            block%status(i) = status_ok
            if (block%doubt(i) /= 0) call compute_alone(block, i, wants_end, wants_period)
        end do
    end subroutine compute_block

    !> Computes case i by the scalar routine: the quantities of a whole nutation; with `wants_end` the motion
    !> at `t_end`; with `wants_period` phi at `t_period`.
    subroutine compute_alone(block, i, wants_end, wants_period)
        type(exact_block_t), intent(inout) :: block
        integer, intent(in) :: i
        logical, intent(in) :: wants_end, wants_period
        type(body_t) :: body
        type(motion_t) :: start, motion
        type(exact_motion_t) :: exact
        real(dp) :: energy, total

        block%fallbacks = block%fallbacks + 1
        body%inertia = [block%inertia1(i), block%inertia1(i), block%inertia3(i)]
        body%gravity = block%mgl(i)
        body%centre_of_mass(3) = 1
        start = motion_from_angles(0.0_dp, [block%phi(i), block%theta(i), block%psi(i)], &
            [block%phi_rate(i), block%theta_rate(i), &
             block%omega3(i) - block%phi_rate(i) * cos(block%theta(i))])
        call prepare_exact_motion(body, start, exact, block%status(i))
        if (.not. is_ok(block%status(i))) return

        associate (nutation => exact%nutation)
            block%theta_min(i) = nutation%theta_min
            block%theta_max(i) = nutation%theta_max
            block%u_min(i) = cos(nutation%theta_max)
            block%delta_u(i) = nutation%delta_u
            block%period(i) = nutation%period
            block%precession(i) = nutation%precession
            block%precession_rate(i) = nutation%precession_rate
            block%phi_rate_max(i) = nutation%phi_rate_max
        end associate
        if (wants_end) then
            motion = exact%at(block%t_end(i))
            block%phi_end(i) = motion%angle(1)
            block%theta_end(i) = motion%angle(2)
            block%psi_end(i) = motion%angle(3)
            block%theta_rate_end(i) = motion%rate(2)
            energy = kinetic_energy(body, start) + potential_energy(body, start)
            block%energy_error(i) = abs(kinetic_energy(body, motion) &
                + potential_energy(body, motion) - energy)
            if (block%energy_error(i) > 0) block%energy_error(i) = block%energy_error(i) &
                / (kinetic_energy(body, start) + block%mgl(i))
        end if
        if (wants_period) then
            motion = exact%at(block%t_period(i))
            block%phi_at_period(i) = motion%angle(1) - block%phi(i)
        end if
        ! Only the period, and the change of phi per period, may be infinite.
        total = block%theta_min(i) + block%theta_max(i) + block%precession_rate(i) &
                + block%phi_rate_max(i)
        if (wants_end) total = total + block%theta_end(i) + block%phi_end(i) + block%psi_end(i) &
                               + block%theta_rate_end(i) + block%energy_error(i)
        if (wants_period) total = total + block%phi_at_period(i)
        if (.not. is_finite(total)) block%status(i) = status_non_finite
    end subroutine compute_alone

end module spintop_exact_block
