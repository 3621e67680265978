!> A case of a sweep that is followed step by step.
module spintop_sweep_stepping
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_compare, only: is_finite
    use spintop_attitude, only: rotation_angle
    use spintop_case, only: case_t
    use spintop_conditioning, only: inherent_error
    use spintop_event_text, only: column_event_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, find_nutation
    use spintop_nutation_watch, only: nutation_watch_t
    use spintop_plan, only: plan_t, sample_times
    use spintop_quantities, only: energy_scale, kinetic_energy, potential_energy
    use spintop_status, only: status_ok, status_meanings
    use spintop_sweep_columns, only: quantities, group_nutation, group_fast_top, group_period, &
        group_end, group_energy, group_oracle, group_cost, group_inherent, group_details, sweep_groups, &
        q_orientation_error, q_inherent_error, q_evaluations
    use spintop_sweep_notes, only: note_t, note_no_extremes, note_no_stop
    use spintop_sweep_quantities, only: no_values, put_nutation, put_measured, put_fast_top, put_azimuth, put_end, &
        put_details, precession_period
    use spintop_sweep_stability, only: put_stability
    implicit none
    private
    public :: compute_stepping

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

    !> The quantities of a case: those of the whole nutation from the closed form where there is
    !> one, the others from the trajectory, which ends at the n-th of the events.
    subroutine compute_stepping(case, plan, wanted, events, n, values, status, note)
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        logical, intent(in) :: wanted(sweep_groups)
        type(column_event_t), intent(in) :: events(:)
        integer, intent(in) :: n
        real(dp), intent(out) :: values(quantities)
        integer, intent(out) :: status
        type(note_t), intent(inout) :: note
        type(nutation_watch_t), allocatable :: watch
        type(nutation_t) :: nutation
        integer(int64) :: max_steps
        integer :: stability
        logical :: measures

        values = no_values()
        status = status_ok
        if (case%body%is_lagrange()) then
            if (wanted(group_nutation)) then
                call find_nutation(case%body, case%start, nutation, status)
                if (status == status_ok) call put_nutation(case, nutation, values, note)
            end if
            if (wanted(group_details)) call put_details(case, values, note)
        end if
        max_steps = plan%stepper%controls%max_steps
        call put_stability(case, wanted, max_steps, values, stability, note)
        if (stability /= status_ok) status = stability
        if (wanted(group_fast_top)) call put_fast_top(case, values, note)

        measures = any(wanted([group_nutation, group_details])) .and. .not. case%body%is_lagrange()
        if (.not. (measures .or. any(wanted([group_period, group_end, group_energy, group_oracle, group_cost])))) return
        if (measures .or. size(events) > 0) then
            allocate (watch)
            call watch%set(events, n, case)
            if (measures) call watch%measure_nutation(case)
        end if
        call follow(case, plan, max_steps, wanted, watch, values, status, note)
        if (status /= status_ok) return
        status = stability
        if (measures) call put_measured(case, watch, values, note)
        if (measures .and. wanted(group_details)) then
            call note%add(note_no_extremes, 'they are not measured')
        end if
        if (size(events) > 0) then
            if (watch%ended_by == 0) call note%add(note_no_stop)
        end if
    end subroutine compute_stepping

    !> Follows the motion to the end of its span, or to the event that ends it, with the work that is left.
    subroutine follow(case, plan, max_steps, wanted, watch, values, status, note)
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        integer(int64), intent(in) :: max_steps
        logical, intent(in) :: wanted(sweep_groups)
        type(nutation_watch_t), intent(inout), optional :: watch
        real(dp), intent(inout) :: values(quantities)
        integer, intent(out) :: status
        type(note_t), intent(inout) :: note
        type(witness_t) :: witness
        type(outcome_t) :: outcome
        real(dp), allocatable :: times(:)
        integer(int64) :: all_steps

        call plan%fit_steps(case%t_end)
        call begin_witness(case, witness)
        witness%counts_turns = any(wanted([group_period, group_end]))
        times = [case%t_end]
        if (wanted(group_energy)) times = sample_times(case%t_end, rows(plan))
        if (wanted(group_period)) times = with_time(times, witness%period)
        all_steps = plan%stepper%controls%max_steps
        plan%stepper%controls%max_steps = max_steps
        call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, times, &
                       witness, outcome, watch)
        plan%stepper%controls%max_steps = all_steps
        status = outcome%status
        values(q_evaluations) = real(outcome%counts%evaluations, dp)
        if (wanted(group_period)) then
            call put_azimuth(witness%saw_period, witness%azimuth_at_period, values, note)
        end if
        if (status /= status_ok) then
            call note%explain(trim(status_meanings(status)))
            return
        end if
        call put_end(case, witness%last, witness%energy_error, values)
        if (case%body%is_lagrange()) call compare_with_exact(case, wanted, witness%last, values)
    end subroutine follow

    !> The error of the end against the exact motion, and what the data allow.
    subroutine compare_with_exact(case, wanted, last, values)
        type(case_t), intent(in) :: case
        logical, intent(in) :: wanted(sweep_groups)
        type(motion_t), intent(in) :: last
        real(dp), intent(inout) :: values(quantities)
        type(exact_motion_t) :: exact
        integer :: status
        if (wanted(group_oracle)) then
            call prepare_exact_motion(case%body, case%start, exact, status)
            if (status == status_ok) then
                values(q_orientation_error) = rotation_angle(exact%quaternion_at(last%t), last%quaternion)
            end if
        end if
        if (wanted(group_inherent)) then
            values(q_inherent_error) = inherent_error(case%body, case%start, last%t)
        end if
    end subroutine compare_with_exact

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
        witness%energy_scale = energy_scale(case%body, case%start)
    end subroutine begin_witness

    !> Looks at a state of a formulation.
    subroutine observe(self, formulation, t, y, near)
        class(witness_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        call self%look(formulation%motion(t, y, near))
    end subroutine observe

    !> Looks at a motion.
    subroutine look(self, motion)
        class(witness_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        real(dp) :: energy
        self%last = motion
        energy = kinetic_energy(self%case%body, motion) + potential_energy(self%case%body, motion)
        energy = abs(energy - self%energy) / self%energy_scale
        ! What is not finite stays.
        if (is_finite(self%energy_error) .and. .not. energy <= self%energy_error) self%energy_error = energy
        if (matches(motion%t, self%period)) then
            self%saw_period = .true.
            self%azimuth_at_period = motion%angle(1) - self%case%start%angle(1)
        end if
    end subroutine look

end module spintop_sweep_stepping
