!> One motion computed by one method, compared with a reference; and the time that it takes.
module spintop_trial
    use spintop_process, only: seconds
    use spintop_kinds, only: dp, pi, no_number, is_finite
    use spintop_attitude, only: rotation_angle, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_formulation, only: formulation_t, max_states
    use spintop_pole_passages, only: through_pole
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_planning, only: plan_t
    use spintop_quantities, only: axial_momentum, axis_tip, energy_scale, kinetic_energy, potential_energy, &
        vertical_momentum
    use spintop_reference_motion, only: collect_motions, collector_t, reference_t
    use spintop_status, only: is_good_end, status_ok
    use spintop_stepper, only: counts_t
    implicit none
    private
    public :: trial_t, run_trial, time_trial, no_errors, error_orientation, error_tip, error_energy, error_lz, &
        error_l3, error_norm, error_phi, error_theta, error_psi, error_phi_rate, error_theta_rate, error_psi_rate

    !> Magnitudes of the differences from the reference, as places in a list: the rotation angle between the attitudes, rad, and
    !> the distance of the axis tips; the error of the energy over (kinetic energy at the start + m g |r|), those of the momenta
    !> about the vertical and about body z over (momentum at the start + square root of m g |r| times the largest inertia); the
    !> norm error abs(q) - 1 of the quaternion; phi, theta, psi, rad, phi and psi within half a turn, and their rates, rad/s.
    enum, bind(C)
        enumerator :: error_orientation = 1, error_tip, error_energy, error_lz, error_l3, error_norm
        enumerator :: error_phi, error_theta, error_psi, error_phi_rate, error_theta_rate, error_psi_rate
    end enum
    !> The errors before the first comparison. In a pole only theta exists; what never did is NaN.
    real(dp), parameter :: no_errors(error_psi_rate) = [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, no_number, no_number, &
                                                        no_number, no_number, no_number, no_number]

    !> Result of a computation.
    type :: trial_t
        integer :: status = status_ok
        !> Time reached, s.
        real(dp) :: t = 0
        !> Largest errors at the times of the reference, and errors at the last time reached.
        real(dp), dimension(size(no_errors)) :: errors = no_errors, last = no_errors
        type(counts_t) :: counts
        !> Computing time without comparisons, s.
        real(dp) :: time = 0
    end type trial_t

    !> Keeps the last motion, and the state that it is made of.
    type, extends(observer_t) :: arrival_t
        type(motion_t) :: motion
        real(dp) :: t = 0, y(max_states) = 0, near(3) = 0
    contains
        procedure :: observe => observe_arrival
    end type arrival_t

    !> Minimum duration of a measurement, which consists of consecutive calls, and approximate maximum of all
    !> repeats together, s.
    real(dp), parameter :: shortest = 2.0e-4_dp, longest = 2.0_dp

contains

    !> Computes a case with a plan, with steps at, or dense output for, the times of the reference, and compares the motions.
    subroutine run_trial(case, plan, reference, trial)
        type(case_t), intent(in) :: case !! the case to compute
        type(plan_t), intent(inout) :: plan !! model, method and settings
        type(reference_t), intent(in) :: reference !! the reference motion
        type(trial_t), intent(out) :: trial !! result of the computation
        type(collector_t) :: collector
        type(outcome_t) :: outcome
        real(dp) :: began, weight, momentum_scale
        integer :: i

        collector%counts_turns = .false.
        began = seconds()
        call collect_motions(case, plan, reference%motions%t, collector, outcome)
        trial%time = seconds() - began - collector%collecting
        trial%status = outcome%status
        if (is_good_end(outcome%status)) trial%status = status_ok
        trial%t = outcome%t
        trial%counts = outcome%counts
        weight = case%body%mass * case%body%gravity * norm2(case%body%centre_of_mass)
        ! A body at rest without weight has no momentum.
        momentum_scale = max(norm2(case%body%inertia * case%start%omega) + sqrt(weight) * sqrt(maxval(case%body%inertia)), &
                             tiny(weight))
        do i = 1, collector%count
            call compare(case, collector%motions(i), reference%motions(i), energy_scale(case%body, case%start), momentum_scale, &
                         trial)
        end do
    end subroutine run_trial

    !> Compares a motion with that of the reference at its time.
    subroutine compare(case, motion, truth, energy_scale, momentum_scale, trial)
        type(case_t), intent(in) :: case
        type(motion_t), intent(in) :: motion, truth
        real(dp), intent(in) :: energy_scale, momentum_scale !! J, J s
        type(trial_t), intent(inout) :: trial
        real(dp) :: differences(size(no_errors))
        logical :: exists(size(no_errors))

        associate (body => case%body)
            differences(error_orientation) = rotation_angle(truth%quaternion, motion%quaternion)
            differences(error_tip) = norm2(axis_tip(body, motion) - axis_tip(body, truth))
            differences(error_energy) = (energy(body, motion) - energy(body, truth)) / energy_scale
            differences(error_lz) = (vertical_momentum(body, motion) - vertical_momentum(body, truth)) / momentum_scale
            differences(error_l3) = (axial_momentum(body, motion) - axial_momentum(body, truth)) / momentum_scale
            differences(error_norm) = motion%norm_error
        end associate
        exists = .true.
        call compare_angles(case, motion, truth, differences(error_phi:), exists(error_phi:))
        trial%last = merge(enlarged(no_errors, differences), no_errors, exists)
        where (exists) trial%errors = enlarged(trial%errors, trial%last)
    end subroutine compare

    !> Compares angles and rates, in the axes in which the body was given: their differences, and which of them exist.
    subroutine compare_angles(case, motion, truth, differences, exists)
        type(case_t), intent(in) :: case
        type(motion_t), intent(in) :: motion, truth
        real(dp), intent(out) :: differences(6)
        logical, intent(out) :: exists(6)
        type(motion_t) :: computed, true
        real(dp) :: gamma(3)

        ! Angles of a state may have left 0 <= theta <= pi; those of the attitude have not.
        computed = motion_from_quaternion(motion%t, motion%quaternion, motion%omega, motion%angle)
        computed = case%turn%back(computed, case%given_start%angle)
        true = case%turn%back(truth, case%given_start%angle)
        differences = [computed%angle - true%angle, computed%rate - true%rate]
        differences(:3) = differences(:3) - 2 * pi * anint(differences(:3) / (2 * pi))
        exists = [.true., .true., .true., is_finite(true%rate)]
        ! In a pole only theta exists.
        gamma = vertical_from_quaternion(true%quaternion)
        if (norm2(gamma(1:2)) <= through_pole) exists = [.false., .true., .false., .false., .false., .false.]
    end subroutine compare_angles

    !> The larger of an error, which may not exist yet, and a difference, of which NaN counts as the largest.
    elemental real(dp) function enlarged(error, difference)
        real(dp), intent(in) :: error, difference
        enlarged = abs(difference)
        if (.not. is_finite(difference)) enlarged = huge(error)
        if (error > enlarged) enlarged = error
    end function enlarged

    !> Total energy, J.
    pure real(dp) function energy(body, motion)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        energy = kinetic_energy(body, motion) + potential_energy(body, motion)
    end function energy

    !> The minimum time of `repeats` computations of a case with a plan, s, for attitude and rates at the end of the span. It is
    !> that of elapsed times: what else the processor does can only lengthen them. The processor time of a thread is no such
    !> bound: a virtual machine takes the time that its host withheld from where it notices, and may so count nothing for a
    !> short run. A similar computation, which took about `expected` seconds, should have run just before as a warm-up. If the
    !> repeats would take longer than two seconds there are fewer of them, but at least one. `counts` is the cost of one.
    subroutine time_trial(case, plan, expected, repeats, time, counts, motion, status)
        type(case_t), intent(in) :: case !! the case whose computation is timed
        type(plan_t), intent(inout) :: plan !! model, method and settings
        real(dp), intent(in) :: expected !! expected time of one computation, s
        integer, intent(in) :: repeats !! maximum number of measurements
        real(dp), intent(out) :: time !! minimum time, s
        type(counts_t), intent(out) :: counts !! cost of one computation
        type(motion_t), intent(out), optional :: motion !! the end of the span, in the axes of the computation
        integer, intent(out), optional :: status !! how the last computation ended (spintop_status)
        type(exact_motion_t) :: exact
        type(arrival_t) :: arrival
        type(outcome_t) :: outcome
        real(dp) :: began, start
        integer :: calls, repeat, i, ended

        arrival%counts_turns = .false.
        calls = 1 + int(shortest / max(expected, shortest / 1000))
        time = huge(time)
        start = seconds()
        do repeat = 1, repeats
            began = seconds()
            do i = 1, calls
                if (plan%exact) then
                    call prepare_exact_motion(case%body, case%start, exact, ended)
                    arrival%motion = exact%at(case%t_end)
                else
                    call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, [case%t_end], arrival, &
                                   outcome)
                    ended = outcome%status
                end if
            end do
            time = min(time, (seconds() - began) / calls)
            if (seconds() - start > longest) exit
        end do
        counts = outcome%counts
        if (present(motion)) then
            motion = arrival%motion
            if (.not. plan%exact) motion = plan%formulation%motion(arrival%t, arrival%y, arrival%near)
        end if
        if (present(status)) status = ended
    end subroutine time_trial

    !> Keeps the motion: attitude and rates, without the angles that describe the attitude.
    subroutine observe_arrival(self, formulation, t, y, near)
        class(arrival_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        self%motion = formulation%motion_without_angles(t, y)
        self%t = t
        self%y = y
        self%near = near
    end subroutine observe_arrival

end module spintop_trial
