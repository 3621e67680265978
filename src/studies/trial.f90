!> One motion computed by one method, measured against a reference.
module spintop_trial
    use spintop_kinds, only: dp
    use spintop_attitude, only: rotation_angle
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t
    use spintop_quantities, only: axial_momentum, axis_tip, kinetic_energy, potential_energy, &
        vertical_momentum
    use spintop_reference_motion, only: reference_t
    use spintop_status, only: status_ok
    use spintop_stepper, only: counts_t
    use spintop_system, only: seconds
    implicit none
    private
    public :: trial_t, errors_t, run_trial

    !> Largest differences from the reference at its times.
    type :: errors_t
        !> Angle of the turn between the attitudes, rad, and distance of the axis tips.
        real(dp) :: orientation = 0, tip = 0
        !> Energy over (kinetic energy at the start + m g |r|), momenta about the vertical and about
        !> body z over (momentum at the start + square root of m g |r| times largest inertia).
        real(dp) :: energy = 0, vertical = 0, axial = 0
        !> Length of the quaternion less 1.
        real(dp) :: quaternion = 0
    end type errors_t

    !> What became of a computation.
    type :: trial_t
        integer :: status = status_ok
        !> Time reached, s.
        real(dp) :: t = 0
        type(errors_t) :: errors
        !> Orientation error at the last time seen, rad.
        real(dp) :: orientation_end = 0
        type(counts_t) :: counts
        !> Seconds it took.
        real(dp) :: time = 0
    end type trial_t

    !> Compares the motion it is shown with the reference, time by time.
    type, extends(observer_t) :: judge_t
        type(case_t) :: case
        type(reference_t) :: reference
        integer :: seen = 0
        real(dp) :: energy_scale = 1, momentum_scale = 1
        type(errors_t) :: errors
        real(dp) :: orientation_end = 0
    contains
        procedure :: observe
    end type judge_t

contains

    !> Computes a case as planned, with steps at or dense output for the times of the reference.
    subroutine run_trial(case, plan, reference, trial)
        type(case_t), intent(in) :: case
        type(plan_t), intent(inout) :: plan
        type(reference_t), intent(in) :: reference
        type(trial_t), intent(out) :: trial
        type(judge_t) :: judge
        type(outcome_t) :: outcome
        real(dp) :: began, weight

        judge%case = case
        judge%reference = reference
        weight = case%body%mass * case%body%gravity * norm2(case%body%centre_of_mass)
        judge%energy_scale = kinetic_energy(case%body, case%start) + weight
        judge%momentum_scale = norm2(case%body%inertia * case%start%omega) &
                               + sqrt(weight * maxval(case%body%inertia))
        began = seconds()
        call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, &
                       reference%motions%t, judge, outcome)
        trial%time = seconds() - began
        trial%status = outcome%status
        trial%t = outcome%t
        trial%counts = outcome%counts
        trial%errors = judge%errors
        trial%orientation_end = judge%orientation_end
    end subroutine run_trial

    !> Compares a state with the reference at its time.
    subroutine observe(self, formulation, t, y, near)
        class(judge_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        type(motion_t) :: motion
        type(body_t) :: body

        if (self%seen == size(self%reference%motions)) return
        self%seen = self%seen + 1
        motion = formulation%motion(t, y, near)
        body = self%case%body
        associate (truth => self%reference%motions(self%seen), errors => self%errors)
            self%orientation_end = rotation_angle(truth%quaternion, motion%quaternion)
            call enlarge(errors%orientation, self%orientation_end)
            call enlarge(errors%tip, norm2(axis_tip(body, motion) - axis_tip(body, truth)))
            call enlarge(errors%energy, (energy(body, motion) - energy(body, truth)) / self%energy_scale)
            call enlarge(errors%vertical, (vertical_momentum(body, motion) &
                                           - vertical_momentum(body, truth)) / self%momentum_scale)
            call enlarge(errors%axial, (axial_momentum(body, motion) - axial_momentum(body, truth)) &
                                       / self%momentum_scale)
            call enlarge(errors%quaternion, motion%quaternion_drift)
        end associate
    end subroutine observe

    !> The larger of an error and a new one; one that is not a number is the largest of all.
    pure subroutine enlarge(error, difference)
        real(dp), intent(inout) :: error
        real(dp), intent(in) :: difference
        if (.not. abs(difference) <= error) error = min(abs(difference), huge(error))
    end subroutine enlarge

    !> Total energy, J.
    pure real(dp) function energy(body, motion)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        energy = kinetic_energy(body, motion) + potential_energy(body, motion)
    end function energy

end module spintop_trial
