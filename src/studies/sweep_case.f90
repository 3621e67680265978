!> One case of a sweep: its quantities, from closed forms and from its trajectory.
module spintop_sweep_case
    use spintop_kinds, only: dp, pi, degree
    use spintop_compare, only: is_finite
    use spintop_attitude, only: rotation_angle
    use spintop_case, only: case_t
    use spintop_conditioning, only: double_floor
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_fast_top, only: fast_top_t, fast_top
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, find_nutation
    use spintop_plan, only: plan_t, sample_times
    use spintop_quantities, only: kinetic_energy, potential_energy
    use spintop_status, only: status_ok, status_meaning
    use spintop_sweep_columns
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    implicit none
    private
    public :: compute_case

    !> What the trajectory of a case shows.
    type, extends(observer_t) :: witness_t
        type(case_t) :: case
        !> Time of interest before the end, s.
        real(dp) :: period = 0
        logical :: saw_period = .false.
        real(dp) :: azimuth_at_period = 0
        real(dp) :: energy = 0, energy_scale = 1, energy_error = 0
        !> Motion last seen.
        type(motion_t) :: last
    contains
        procedure :: observe
        procedure :: look
    end type witness_t

contains

    !> The quantities of a case, in the order of `sweep_columns`; those of groups not wanted are
    !> left NaN, and those that do not exist are NaN with the reason in `note`.
    subroutine compute_case(case, plan, wanted, values, status, note)
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        logical, intent(in) :: wanted(sweep_groups)
        real(dp), intent(out) :: values(quantities)
        integer, intent(out) :: status
        character(:), allocatable, intent(out) :: note

        values = ieee_value(0.0_dp, ieee_quiet_nan)
        note = ''
        status = status_ok
        if (wanted(group_nutation)) call describe_nutation(case, values, note)
        if (wanted(group_fast_top)) call describe_fast_top(case, values, note)
        if (wanted(group_floor) .and. case%body%is_lagrange()) then
            values(q_double_floor) = double_floor(case%body, case%start, case%t_end)
        end if
        if (any(wanted([group_period, group_end, group_energy, group_oracle, group_cost]))) then
            call follow(case, plan, wanted, values, status, note)
        end if
    end subroutine compute_case


    !> The whole nutation, from the closed form; for bodies that have none it does not exist.
    subroutine describe_nutation(case, values, note)
        type(case_t), intent(in) :: case
        real(dp), intent(inout) :: values(quantities)
        character(:), allocatable, intent(inout) :: note
        type(nutation_t) :: nutation
        integer :: status

        if (.not. case%body%is_lagrange()) then
            call add_note(note, 'no nutation: the body is no undamped symmetric top')
            return
        end if
        call find_nutation(case%body, case%start, nutation, status)
        if (status /= status_ok) then
            call add_note(note, 'no nutation: ' // status_meaning(status))
            return
        end if
        values(q_theta_min) = nutation%theta_min
        values(q_theta_max) = nutation%theta_max
        if (case%turn%flipped) then
            values(q_theta_min) = pi - nutation%theta_max
            values(q_theta_max) = pi - nutation%theta_min
        end if
        values(q_delta_u) = nutation%delta_u
        values(q_phi_rate_max) = nutation%phi_rate_max
        values(q_com_z_min) = case%body%centre_of_mass(3) * cos(nutation%theta_max)
        if (.not. is_finite(nutation%period)) then
            call add_note(note, 'no nutation period: the axis approaches the upright for ever')
            return
        end if
        values(q_nutation_period) = nutation%period
        values(q_nutation_rate) = 2 * pi / nutation%period
        values(q_precession_per_nutation) = nutation%precession
        values(q_precession_rate) = nutation%precession_rate
        if (abs(nutation%precession) > 0) then
            values(q_nutations_per_turn) = 2 * pi / abs(nutation%precession)
        else
            call add_note(note, 'no nutations per turn: no precession')
        end if
        if (precession_period(case) > 0) then
            values(q_nutations_in_period) = precession_period(case) / nutation%period
        end if
    end subroutine describe_nutation

    !> The paper's formulas for a fast top.
    subroutine describe_fast_top(case, values, note)
        type(case_t), intent(in) :: case
        real(dp), intent(inout) :: values(quantities)
        character(:), allocatable, intent(inout) :: note
        type(fast_top_t) :: motion

        if (.not. precession_period(case) > 0) then
            call add_note(note, 'no fast-top formulas: they need a spin and a weight')
            return
        end if
        motion = fast_top(case%body, case%start%angle(2), case%start%omega(3))
        values(q_delta_u_fast_top) = motion%delta_u
        values(q_nutation_rate_fast_top) = motion%nutation_rate
        values(q_precession_rate_fast_top) = motion%precession_rate
        values(q_nutations_per_turn_fast_top) = motion%nutations_per_turn
        values(q_precession_period) = precession_period(case)
        values(q_fast_top_ratio) = motion%ratio
    end subroutine describe_fast_top

    !> The paper's T_p, s; 0 without spin or weight, negative for no top.
    pure real(dp) function precession_period(case)
        type(case_t), intent(in) :: case
        precession_period = 0
        if (.not. case%body%mgl() > 0) return
        precession_period = 2 * pi * abs(case%body%inertia(3) * case%start%omega(3)) / case%body%mgl()
    end function precession_period

    !> Follows the motion to the end of its span.
    subroutine follow(case, plan, wanted, values, status, note)
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        logical, intent(in) :: wanted(sweep_groups)
        real(dp), intent(inout) :: values(quantities)
        integer, intent(out) :: status
        character(:), allocatable, intent(inout) :: note
        type(witness_t) :: witness
        type(exact_motion_t) :: exact
        type(motion_t) :: truth, seen
        type(outcome_t) :: outcome
        real(dp), allocatable :: times(:)
        integer :: i, exact_status

        call plan%fit_steps(case%t_end)
        call begin_witness(case, witness)
        times = [case%t_end]
        if (wanted(group_energy) .and. .not. plan%exact) times = sample_times(case%t_end, rows(plan))
        if (wanted(group_period)) times = with_time(times, witness%period)

        exact_status = status_ok
        if (plan%exact .or. (wanted(group_oracle) .and. case%body%is_lagrange())) then
            call prepare_exact_motion(case%body, case%start, exact, exact_status)
        end if
        if (plan%exact) then
            outcome%status = exact_status
            if (exact_status == status_ok) then
                do i = 1, size(times)
                    call witness%look(exact%at(times(i)))
                end do
            end if
        else
            call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, times, &
                           witness, outcome)
        end if

        status = outcome%status
        values(q_evaluations) = real(outcome%counts%evaluations, dp)
        if (witness%saw_period) then
            values(q_azimuth_after_period_deg) = witness%azimuth_at_period / degree
        else if (wanted(group_period)) then
            call add_note(note, 'no azimuth after a period: the span does not reach T_p at a step')
        end if
        if (status /= status_ok) then
            call add_note(note, status_meaning(status))
            return
        end if
        seen = case%turn%back(witness%last, case%given_start%angle)
        values(q_theta_end) = seen%angle(2)
        values(q_phi_end) = seen%angle(1)
        values(q_psi_end) = seen%angle(3)
        values(q_theta_rate_end) = seen%rate(2)
        values(q_energy_error_max) = witness%energy_error
        if (wanted(group_oracle) .and. case%body%is_lagrange() .and. exact_status == status_ok) then
            truth = exact%at(case%t_end)
            values(q_orientation_error) = rotation_angle(truth%quaternion, witness%last%quaternion)
        end if
    end subroutine follow

    !> Rows over which the largest energy error is sought.
    pure integer function rows(plan)
        type(plan_t), intent(in) :: plan
        rows = plan%samples
        if (.not. plan%is_adaptive()) rows = plan%stepper%controls%steps + 1
    end function rows

    !> Times with one more in its place, if it lies within them.
    pure function with_time(times, extra) result(more)
        real(dp), intent(in) :: times(:), extra
        real(dp), allocatable :: more(:)
        more = times
        if (extra > 0 .and. extra <= times(size(times)) .and. .not. any(matches(times, extra))) then
            more = [pack(times, times < extra), extra, pack(times, times > extra)]
        end if
    end function with_time

    !> Whether two times are the same to rounding.
    elemental logical function matches(a, b)
        real(dp), intent(in) :: a, b
        matches = abs(a - b) <= 4 * spacing(max(a, b))
    end function matches

    subroutine begin_witness(case, witness)
        type(case_t), intent(in) :: case
        type(witness_t), intent(out) :: witness
        witness%case = case
        witness%last = case%start
        witness%period = precession_period(case)
        witness%energy = kinetic_energy(case%body, case%start) + potential_energy(case%body, case%start)
        witness%energy_scale = kinetic_energy(case%body, case%start) &
            + case%body%mass * case%body%gravity * norm2(case%body%centre_of_mass)
    end subroutine begin_witness

    !> Looks at a state of a formulation.
    subroutine observe(self, formulation, t, y)
        class(witness_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states)
        call self%look(formulation%motion(t, y, self%last%angle))
    end subroutine observe

    !> Looks at a motion.
    subroutine look(self, motion)
        class(witness_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        real(dp) :: energy
        self%last = motion
        energy = kinetic_energy(self%case%body, motion) + potential_energy(self%case%body, motion)
        self%energy_error = max(self%energy_error, abs(energy - self%energy) / self%energy_scale)
        if (matches(motion%t, self%period)) then
            self%saw_period = .true.
            self%azimuth_at_period = motion%angle(1) - self%case%start%angle(1)
        end if
    end subroutine look

    !> Adds a reason to the notes of a case.
    subroutine add_note(note, reason)
        character(:), allocatable, intent(inout) :: note
        character(*), intent(in) :: reason
        if (note /= '') note = note // '; '
        note = note // reason
    end subroutine add_note

end module spintop_sweep_case
