!> Cases of a sweep that are computed one by one: integrated numerically, or followed along their closed form; and what
!> perturbations of their motions tell, found together in lanes for the cases of a block, however their motions were computed.
module spintop_sweep_one_by_one
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: rotation_angle
    use spintop_case, only: case_t
    use spintop_kinds, only: dp, is_finite
    use spintop_conditioning, only: inherent_error
    use spintop_event_recorder, only: exact_path_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_lyapunov, only: find_growth
    use spintop_measures, only: growth_t, quantities, watch_nutation_rate, watch_precession_rate, watch_turning
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, find_nutation
    use spintop_nutation_recorder, only: nutation_recorder_t
    use spintop_poles, only: nearly_plane, swings_over_poles
    use spintop_quantities, only: energy_scale, kinetic_energy, potential_energy
    use spintop_status, only: is_good_end, is_ok, status_meanings, status_step_limit
    use spintop_stepper, only: looks_per_step
    use spintop_sweep_quantities, only: engine_t, slot_t, task_t, find_free_constants, set_nutation, set_measured, &
        set_fast_top, set_azimuth, set_end, set_details, precession_period, watched_for, compute_stability
    use spintop_sweep_result, only: at_orientation_error, at_inherent_error, at_evaluations, at_t_end, &
        at_t_stuck, note_t, note_no_details, note_no_stop, kinds_of_work, of_class, of_cost, of_details, of_end, &
        of_energy, of_fast_top, of_fastest, of_growth, of_inherent, of_lyapunov, of_measured, of_multiplier, &
        of_nutation, of_oracle, of_period, of_singular, of_turns
    implicit none
    private
    public :: sweep_stepping_t, perturbations_t

    !> The engine for every case.
    type, extends(engine_t) :: sweep_stepping_t
    contains
        procedure :: compute
    end type sweep_stepping_t

    !> Quantities of a trajectory.
    type, extends(observer_t) :: witness_t
        type(case_t) :: case
        !> A time of interest before the end, s.
        real(dp) :: period = 0
        logical :: saw_period = .false.
        real(dp) :: azimuth_at_period = 0
        real(dp) :: energy = 0, energy_scale = 1, energy_error = 0
        !> The last motion. That of a formulation is made at the end, of the last state.
        type(motion_t) :: last
        real(dp) :: t = 0, y(max_states) = 0, near(3) = 0
    contains
        procedure :: observe
    end type witness_t

    !> The engine for perturbations of motions that have been computed.
    type, extends(engine_t) :: perturbations_t
    contains
        procedure :: compute => compute_perturbations
        procedure, nopass :: shares_lanes
    end type perturbations_t

contains

    !> Computes the cases one by one, step by step.
    subroutine compute(self, slots, list, task)
        class(sweep_stepping_t), intent(inout) :: self
        type(slot_t), intent(inout) :: slots(:) !! the block
        integer, intent(in) :: list(:) !! the places of the cases
        type(task_t), intent(in) :: task !! what is asked of them
        integer :: i
        do i = 1, size(list)
            call compute_alone(slots(list(i)), task)
        end do
    end subroutine compute

    !> The quantities of a case: those of the whole nutation from the closed form where it exists, the others
    !> from the trajectory, which may end at an event.
    subroutine compute_alone(slot, task)
        type(slot_t), intent(inout) :: slot
        type(task_t), intent(in) :: task
        type(nutation_recorder_t), allocatable :: recorder
        type(nutation_t) :: nutation
        integer, allocatable :: which(:)
        type(note_t) :: before
        logical :: measures, for_class
        integer :: status

        associate (case => slot%case, wanted => task%wanted, stops => size(task%events) > 0)
            if (case%body%has_closed_nutation()) then
                if (wanted(of_nutation)) then
                    call find_nutation(case%body, case%start, nutation, status)
                    if (is_ok(status)) then
                        call set_nutation(slot, nutation, wanted)
                    else
                        call slot%note%explain(trim(status_meanings(status)))
                    end if
                    slot%status = status
                end if
                if (wanted(of_details)) call set_details(slot)
            end if
            if (wanted(of_fast_top)) call set_fast_top(slot)

            measures = (wanted(of_nutation) .or. wanted(of_details)) .and. .not. case%body%has_closed_nutation()
            if (case%body%is_free()) measures = measures .and. (wanted(of_measured) .or. case%turn%to_principal_axes)
            if (.not. (measures .or. any(wanted([of_period, of_end, of_energy, of_oracle, of_cost, of_inherent])) .or. &
                       (stops .and. any(wanted(of_growth:of_multiplier))))) then
                call compute_stability(slot, case%t_end, wanted)
                call find_free_constants(slot, wanted)
                return
            end if
            which = watched_for(wanted)
            if (allocated(case%body%effects)) then
                if (measures .and. any(quantities(which)%needs_plain_body)) call slot%note%add(note_no_details, &
                    'extremes of the nutation rate and of the support force are not measured for bodies with effects')
                which = pack(which, .not. quantities(which)%needs_plain_body)
            end if
            if (any(which == watch_nutation_rate) .and. all(which /= watch_turning)) then
                if (swings_over_poles(case%body, case%start, nearly_plane)) which = [watch_turning, which]
            end if
            ! The search for the largest precession rate costs more than the motion. For the class the turning points suffice,
            ! unless there may be a cusp.
            for_class = wanted(of_class) .and. .not. wanted(of_fastest)
            if (for_class) which = pack(which, which /= watch_precession_rate)
            before = slot%note
            do
                if (measures .or. stops) then
                    if (allocated(recorder)) deallocate (recorder)
                    allocate (recorder)
                    call recorder%set(task%events, task%stop_after, case)
                    if (measures) call recorder%measure_nutation(case, which)
                end if
                call follow(slot, wanted, recorder)
                if (.not. is_good_end(slot%status)) return
                if (measures) call recorder%include_end()
                if (.not. (measures .and. for_class)) exit
                if (recorder%knows_class()) exit
                which = [which, watch_precession_rate]
                slot%note = before
            end do
            call compute_stability(slot, slot%result%of(at_t_end), wanted)
            if (measures) call set_measured(slot, recorder%found, wanted)
            call find_free_constants(slot, wanted)
            if (stops) then
                if (recorder%ended_by == 0) call slot%note%add(note_no_stop)
            end if
        end associate
    end subroutine compute_alone

    !> Integrates the motion to the end of its span, or to the event that ends it, within the remaining work.
    subroutine follow(slot, wanted, recorder)
        type(slot_t), intent(inout) :: slot
        logical, intent(in) :: wanted(kinds_of_work)
        type(nutation_recorder_t), intent(inout), optional :: recorder
        type(witness_t) :: witness
        type(outcome_t) :: outcome
        type(exact_motion_t), allocatable :: exact ! large, and a thread may have a small stack
        real(dp), allocatable :: times(:)
        integer :: status

        associate (case => slot%case, plan => slot%plan, values => slot%result)
            if (.not. plan%exact) call plan%fit_steps(case%t_end)
            witness%case = case
            witness%last = case%start
            witness%period = precession_period(case%body, case%start)
            witness%energy = kinetic_energy(case%body, case%start) + potential_energy(case%body, case%start)
            witness%energy_scale = energy_scale(case%body, case%start)
            witness%counts_turns = wanted(of_turns)
            witness%sees_steps = wanted(of_energy)
            witness%wants_work = wanted(of_energy) .and. allocated(case%body%effects)
            times = [case%t_end]
            if (wanted(of_period) .and. witness%period > 0 .and. witness%period <= case%t_end) then
                if (.not. matches(case%t_end, witness%period)) times = [witness%period, case%t_end]
            end if
            if (plan%exact) then
                call walk(case, plan%max_steps, times, witness, outcome%status, recorder)
            else
                call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, times, &
                               witness, outcome, recorder)
                if (is_good_end(outcome%status)) then
                    witness%last = plan%formulation%motion(witness%t, witness%y, witness%near)
                    witness%last%given_angle = witness%given_angle
                end if
            end if
            slot%status = outcome%status
            values%of(at_evaluations) = real(outcome%counts%evaluations, dp)
            if (wanted(of_period)) call set_azimuth(slot, witness%saw_period, witness%azimuth_at_period)
            if (.not. is_good_end(slot%status)) then
                call slot%fail(slot%status)
                return
            end if
            values%of(at_t_stuck) = outcome%t_stuck
            call set_end(slot, witness%last, witness%energy_error)
            call slot%explain_turns(outcome%doubtful_passages, wanted)
            if (.not. case%body%has_closed_form()) return
            associate (last => witness%last)
                if (wanted(of_oracle)) then
                    allocate (exact)
                    call prepare_exact_motion(case%body, case%start, exact, status)
                    if (is_ok(status)) values%of(at_orientation_error) = &
                        rotation_angle(exact%quaternion_at(last%t), last%quaternion)
                end if
                if (wanted(of_inherent)) values%of(at_inherent_error) = inherent_error(case%body, case%start, last%t)
            end associate
        end associate
    end subroutine follow

    !> Follows the closed form at the times and to the end, or to the event that ends the motion.
    subroutine walk(case, max_steps, times, witness, status, recorder)
        type(case_t), intent(in) :: case
        integer(int64), intent(in) :: max_steps
        real(dp), intent(in) :: times(:)
        type(witness_t), intent(inout) :: witness
        integer, intent(out) :: status
        type(nutation_recorder_t), intent(inout), optional :: recorder
        ! Large, and a thread may have a small stack.
        type(exact_path_t), allocatable :: path
        type(motion_t) :: motion
        real(dp) :: t_end
        integer :: i

        allocate (path)
        call path%begin(case, looks_per_step * max_steps, status)
        if (.not. is_ok(status)) return
        t_end = case%t_end
        if (present(recorder)) then
            call recorder%search_exactly(path, case, t_end, status)
            if (.not. is_ok(status)) return
            call path%restart(case, looks_per_step * max_steps)
        end if
        path%counts_turns = witness%counts_turns
        associate (instants => [pack(times, times < t_end), t_end])
            do i = 1, size(instants)
                call path%at(instants(i), motion)
                if (path%is_spent()) status = status_step_limit
                if (.not. is_ok(status)) return
                call record_motion(witness, motion)
            end do
        end associate
    end subroutine walk

    !> Whether two times are equal to rounding.
    elemental logical function matches(a, b)
        real(dp), intent(in) :: a, b
        matches = abs(a - b) <= 4 * spacing(max(a, b))
    end function matches

    !> Receives a state of a formulation.
    subroutine observe(self, formulation, t, y, near)
        class(witness_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        if (self%period > 0 .and. matches(t, self%period)) then
            call record_motion(self, formulation%motion(t, y, near))
        else
            call update_energy_error(self, formulation%motion_without_angles(t, y))
        end if
        self%t = t
        self%y = y
        self%near = near
    end subroutine observe

    !> Receives a motion.
    subroutine record_motion(self, motion)
        class(witness_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        self%last = motion
        call update_energy_error(self, motion)
        if (self%period > 0 .and. matches(motion%t, self%period)) then
            self%saw_period = .true.
            self%azimuth_at_period = motion%angle(1) - self%case%start%angle(1)
        end if
    end subroutine record_motion

    !> Receives the energy error of a motion, whose angles need not be set.
    subroutine update_energy_error(self, motion)
        class(witness_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        real(dp) :: energy
        energy = kinetic_energy(self%case%body, motion) + potential_energy(self%case%body, motion)
        energy = abs(energy - self%energy - sum(self%work)) / max(self%energy_scale, sum(abs(self%work)))
        ! A value that is not finite is kept.
        if (is_finite(self%energy_error) .and. .not. energy <= self%energy_error) self%energy_error = energy
    end subroutine update_energy_error

    !> Cases of one limit of work share lanes.
    logical function shares_lanes(a, b)
        type(slot_t), intent(in) :: a, b !! the cases
        shares_lanes = a%max_steps == b%max_steps
    end function shares_lanes

    !> Computes what perturbations of the cases have to tell: their growth. A status reports work that was not finished, or
    !> overflow.
    subroutine compute_perturbations(self, slots, list, task)
        class(perturbations_t), intent(inout) :: self
        type(slot_t), intent(inout) :: slots(:) !! the block
        integer, intent(in) :: list(:) !! the places of the cases
        type(task_t), intent(in) :: task !! what is asked of them
        type(growth_t), allocatable :: growth(:)
        integer, allocatable :: places(:)
        integer :: i

        places = pack(list, slots(list)%growth_until > 0)
        if (size(places) == 0) return
        allocate (growth(size(places)))
        associate (wanted => task%wanted)
            call find_growth(slots(places)%case%body, slots(places)%case%start, slots(places)%growth_until, &
                             wanted(of_lyapunov), wanted(of_singular), max(slots(places(1))%max_steps, 1_int64), growth)
            do i = 1, size(places)
                call slots(places(i))%store_growth(growth(i), wanted)
            end do
        end associate
    end subroutine compute_perturbations

end module spintop_sweep_one_by_one
