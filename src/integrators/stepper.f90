!> The interface of integrators: one step at a time through any formulation.
!>
!> A stepper contains its settings and the state of its run, of which there is one at a time: each thread has its own.
module spintop_stepper
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_formulation, only: formulation_info_t, formulation_t, max_invariants, max_states, structure_none
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_lapack, only: dgelsy
    use spintop_motions, only: instants
    use spintop_status, only: is_ok, status_non_finite
    implicit none
    private
    public :: stepper_t, method_info_t, controls_t, run_state_t, counts_t, looks_per_step, smallest_spacings, smallest_step
    public :: name_of_method
    public :: projection_names, project_nothing, project_unit, project_invariants

    !> The admissible errors, prepared for a run.
    type :: error_weight_t
        !> Absolute part of the admissible error of each component, and the part relative to its magnitude, the larger of both ends
        !> of a step.
        real(dp) :: absolute(max_states) = 0, relative(max_states) = 0
        !> MATLAB's rule (Shampine and Reichelt, SIAM J. Sci. Comput. 18, 1997): the magnitude below which the error of a component
        !> is absolute. The error is divided by the larger one before it is compared with the relative tolerance.
        real(dp) :: threshold(max_states) = 0
        !> Number of components in use.
        integer :: states = 0
    end type error_weight_t

    !> Smallest error that can be required, relative to a number.
    real(dp), parameter :: rounding = 8 * epsilon_dp

    !> Smallest step in units of the spacing of the time.
    real(dp), parameter :: smallest_spacings = 16
    !> So many evaluations of the motion within steps count as one step of `max_steps`.
    integer, parameter :: looks_per_step = 16

    !> Kinds of projection onto the invariants of the motion: none, onto unit quaternions, onto all invariants. The drift of an
    !> invariant is a measure of the quality of a computation, so nothing is projected without a request.
    integer, parameter :: project_nothing = 0, project_unit = 1, project_invariants = 2
    character(*), parameter :: projection_names(project_nothing:project_invariants) = &
        [character(10) :: 'none', 'unit', 'invariants']

    !> Maximum number of corrections in one projection.
    integer, parameter :: most_corrections = 3

    !> Most letters of the name of a method: of the registry, or of a file with a Butcher table.
    integer, parameter :: name_of_method = 48

    !> Registry entry of a method.
    type :: method_info_t
        !> Name, as it stands in inputs.
        character(name_of_method) :: name = ''
        !> Short description.
        character(112) :: what = ''
        !> Order of convergence; 0 if it depends on the selected Butcher table.
        integer :: order = 0
        !> Has a variant with a fixed step size.
        logical :: fixed_step = .false.
        !> Has a variant with adaptive steps, chosen by tolerances.
        logical :: adaptive = .false.
        !> Solves equations in each step.
        logical :: implicit = .false.
        !> Symmetric, that is reversible in time: a step back from the end leads to the beginning.
        logical :: symmetric = .false.
        !> Structure that a formulation must offer.
        integer :: needs = structure_none
        !> Takes a Butcher table by name.
        logical :: takes_table = .false.
        !> Default tolerances of the method (0: those of the program).
        real(dp) :: relative_tolerance = 0, absolute_tolerance = 0
        !> Smallest relative tolerance that its arithmetic resolves.
        real(dp) :: finest_tolerance = 1.0e-17_dp
        !> By how much of its tolerance a motion is off within some steps of an adaptive method: measured.
        real(dp) :: share = 2
        !> Stays at a turning point if the speed is reset after each step: see `passes_turns`.
        logical :: caught_by_reset = .false.
        !> Output points per step by its own convention (ode45: 4); 0 if there is none.
        integer :: refine = 0
        !> Computes many motions together in vector lanes, with equations that do (`formulation_info_t`).
        logical :: runs_in_lanes = .false.
        !> Methods that are alike, for lists and figures; the registry sets it.
        character(24) :: family = ''
    end type method_info_t

    !> Settings of a method.
    type :: controls_t
        !> Number of steps of fixed size; 0 lets an adaptive method choose its steps.
        integer :: steps = 0
        !> Admissible error of a step: the relative part, with respect to each state variable (to one radian,
        !> for angles that count turns and on which the motion does not depend); and the absolute part, in
        !> radians for the attitude, and relative to the largest rate and momentum of the motion for those.
        !> With `ode45` and the formulations of the paper the absolute part has MATLAB's meaning: in the unit
        !> of each variable.
        real(dp) :: relative_tolerance = 1.0e-9_dp, absolute_tolerance = 1.0e-12_dp
        !> Maximum work of one run, in steps: accepted and rejected ones; so many evaluations within steps
        !> count as one.
        integer(int64) :: max_steps = 1000000
        !> Solve implicit steps by fixed-point iteration instead of Newton's.
        logical :: fixed_point = .false.
        !> Projection after each step.
        integer :: project = project_nothing
        !> Name of a Butcher table; blank for the default of the method.
        character(40) :: table = ''
    end type controls_t

    !> Cost of a run.
    type :: counts_t
        !> Accepted and rejected steps.
        integer(int64) :: steps = 0, rejected = 0
        !> Evaluations of the motion within steps, for events and for the turns of angles.
        integer(int64) :: looks = 0
        !> Evaluations of the right-hand side and of its Jacobian.
        integer(int64) :: evaluations = 0, jacobians = 0
        !> Inadmissible values that the reset of a formulation had to clip.
        integer(int64) :: clipped = 0
    contains
        procedure :: add
        procedure :: work => work_done
    end type counts_t

    !> The state of a run.
    type :: run_state_t
        !> The equations of motion, prepared for body and start.
        class(formulation_t), pointer :: formulation => null()
        !> Settings of the user.
        type(controls_t) :: controls = controls_t()
        !> The span, s.
        real(dp) :: t_begin = 0, t_end = 0
        !> Current time and state, and the slope y' there.
        real(dp) :: t = 0, y(max_states) = 0, slope(max_states) = 0
        !> Compensation term of the state (Kahan): the state is y + rest.
        real(dp) :: rest(max_states) = 0
        !> Time, state and slope before the last step.
        real(dp) :: t_last = 0, y_last(max_states) = 0, slope_last(max_states) = 0
        !> Size of the next step, s.
        real(dp) :: h = 0
        !> Number of steps on the grid of a fixed-step method; -1 after it has left the grid.
        integer :: grid = 0
        !> Weights of step errors, set at the beginning of a run of an adaptive method.
        type(error_weight_t) :: weight = error_weight_t()
        !> The invariants at the start, for the projection of each new state.
        real(dp) :: invariants(max_invariants) = 0
        !> Cost of the run so far.
        type(counts_t) :: counts = counts_t()
    contains
        procedure :: start_over
        procedure :: evaluate
        procedure :: accept_step
        procedure :: accept_change
        procedure :: project
        procedure :: go_on_from
    end type run_state_t

    !> A method of integration, and its run.
    type, abstract, extends(run_state_t) :: stepper_t
        !> Properties of the method.
        type(method_info_t) :: info = method_info_t()
    contains
        procedure(begin), deferred :: begin
        procedure(advance), deferred :: advance
        procedure(state_within), deferred :: state_within
        procedure :: finish
        procedure :: states_within
        procedure :: bound_of_changes
        procedure, non_overridable :: interpolate
        procedure :: order
        procedure :: set_weight
        procedure :: is_spent
    end type stepper_t

    abstract interface
        !> Begins a run at the time `t` in the state `y`, set by the caller with the span.
        subroutine begin(self, status)
            import :: stepper_t
            class(stepper_t), intent(inout) :: self
            integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        end subroutine begin

        !> Takes one step, never beyond `t_end`. On failure the state is the last valid one.
        subroutine advance(self, status)
            import :: stepper_t
            class(stepper_t), intent(inout) :: self
            integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        end subroutine advance

        !> The state at a time before the end of the last step.
        function state_within(self, t) result(y)
            import :: stepper_t, dp, max_states
            class(stepper_t), intent(inout) :: self
            real(dp), intent(in) :: t !! time, s
            real(dp) :: y(max_states)
        end function state_within
    end interface

contains

    !> Adds the cost of another run.
    pure subroutine add(self, other)
        class(counts_t), intent(inout) :: self
        type(counts_t), intent(in) :: other !! cost of the other run
        self%steps = self%steps + other%steps
        self%rejected = self%rejected + other%rejected
        self%looks = self%looks + other%looks
        self%evaluations = self%evaluations + other%evaluations
        self%jacobians = self%jacobians + other%jacobians
        self%clipped = self%clipped + other%clipped
    end subroutine add

    !> Makes ready for another run, from t = 0 to `t_end`.
    subroutine start_over(self, formulation, t_end)
        class(run_state_t), intent(inout) :: self
        class(formulation_t), target, intent(in) :: formulation !! the equations of motion
        real(dp), intent(in) :: t_end !! end of the span, s
        self%formulation => formulation
        self%t_begin = 0
        self%t_end = t_end
        self%t = 0
        self%rest = 0
        self%h = 0
        self%grid = 0
        self%counts = counts_t()
    end subroutine start_over

    !> Ends a run: a method that has something of another library, of which no copy may be made, gives it back.
    subroutine finish(self)
        class(stepper_t), intent(inout) :: self
    end subroutine finish

    !> The state at a time within the last step.
    function interpolate(self, t) result(y)
        class(stepper_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        if (t < self%t) then
            y = self%state_within(t)
        else
            y = self%y
        end if
    end function interpolate

    !> The states at several times within the last step.
    subroutine states_within(self, t, y)
        class(stepper_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times, s
        real(dp), intent(out) :: y(instants, max_states) !! states
        integer :: i
        do i = 1, instants
            y(i, :) = self%interpolate(t(i))
        end do
    end subroutine states_within

    !> Bounds of the change of each state variable from the beginning of the last step to any time in it, where the step is a
    !> series; otherwise `huge`.
    pure function bound_of_changes(self) result(bound)
        class(stepper_t), intent(in) :: self
        real(dp) :: bound(max_states)
        bound = huge(self%y)
    end function bound_of_changes

    !> The work that counts towards `max_steps`.
    pure integer(int64) function work_done(self)
        class(counts_t), intent(in) :: self
        work_done = self%steps + self%rejected + self%looks / looks_per_step
    end function work_done

    !> Order of convergence with these settings.
    integer function order(self)
        class(stepper_t), intent(in) :: self
        order = self%info%order
    end function order

    !> Prepares the error control of the run for tolerances.
    pure subroutine set_weight(self, relative, absolute)
        class(stepper_t), intent(inout) :: self
        real(dp), intent(in) :: relative, absolute !! mostly those of the settings
        type(formulation_info_t) :: info

        info = self%formulation%info()
        associate (weight => self%weight, cyclic => self%formulation%cyclic, scale => self%formulation%scale)
            weight%states = info%states
            weight%absolute = merge(absolute + relative, absolute, cyclic) * scale
            weight%relative = merge(rounding, relative, cyclic)
            weight%threshold = absolute / relative
            ! The formulations of the paper have angles as a state, and no quaternion. For them MATLAB's rule has
            ! its original meaning, in SI units.
            if (info%quaternion > 0) weight%threshold = weight%threshold * scale
        end associate
    end subroutine set_weight

    !> Size of the smallest step at a time, exactly only if a step of size h might be smaller: `spacing` takes longer than the
    !> control of a step.
    pure real(dp) function smallest_step(h, t)
        real(dp), intent(in) :: h, t !! s
        smallest_step = smallest_spacings * max(epsilon(t) * t, tiny(t))
        if (h <= smallest_step) smallest_step = smallest_spacings * spacing(t)
    end function smallest_step

    !> Evaluates the right-hand side and counts it; an infinite or undefined slope is `status_non_finite`.
    subroutine evaluate(self, t, y, dy, status)
        class(run_state_t), intent(inout) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! that of the right-hand side, or `status_non_finite`
        self%counts%evaluations = self%counts%evaluations + 1
        call self%formulation%derivative(t, y, dy, status)
        ! Not with is_finite: a call for each component would cost as much as an RHS evaluation.
        if (is_ok(status) .and. .not. all(abs(dy) <= huge(1.0_dp))) status = status_non_finite
    end subroutine evaluate

    !> Whether the maximum number of steps is reached: accepted, rejected, and evaluations within steps.
    pure logical function is_spent(self)
        class(stepper_t), intent(in) :: self
        is_spent = self%counts%work() >= self%controls%max_steps
    end function is_spent

    !> Accepts the state `y_new` at `t_new` after the reset of the formulation and the projection; `changed` reports whether
    !> they changed it. The caller renews the slope.
    subroutine accept_step(self, t_new, y_new, changed)
        class(run_state_t), intent(inout) :: self
        real(dp), intent(in) :: t_new, y_new(max_states) !! time, s, and state
        logical, intent(out) :: changed !! whether the state was changed
        logical :: clipped, projected

        self%t_last = self%t
        self%y_last = self%y
        self%slope_last = self%slope
        self%t = t_new
        self%y = y_new
        self%counts%steps = self%counts%steps + 1
        changed = self%formulation%resets_speed
        if (changed) then
            call self%formulation%reset_speed(self%y, clipped)
            if (clipped) self%counts%clipped = self%counts%clipped + 1
        end if
        if (self%controls%project /= project_nothing) then
            call self%project(projected)
            changed = changed .or. projected
        end if
        if (changed) self%rest = 0
    end subroutine accept_step

    !> Accepts the state reached by a change, summed with compensation.
    subroutine accept_change(self, t_new, change, changed)
        class(run_state_t), intent(inout) :: self
        real(dp), intent(in) :: t_new, change(max_states) !! time, s, and change of the state
        logical, intent(out) :: changed !! whether the state was changed
        real(dp) :: total(max_states), y_new(max_states)
        total = change + self%rest
        y_new = self%y + total
        self%rest = total - (y_new - self%y)
        call self%accept_step(t_new, y_new, changed)
    end subroutine accept_change

    !> Goes on from where another stepper is; after that it must begin.
    subroutine go_on_from(self, other)
        class(run_state_t), intent(inout) :: self
        class(run_state_t), intent(in) :: other !! the other stepper, in the same run
        self%t = other%t
        self%y = other%y
        self%rest = 0
        self%grid = other%grid
        self%counts = other%counts
    end subroutine go_on_from

    !> Projects the state; `changed` reports whether it changed.
    subroutine project(self, changed)
        class(run_state_t), intent(inout) :: self
        logical, intent(out) :: changed !! whether the state was changed
        type(formulation_info_t) :: info

        changed = self%controls%project /= project_nothing
        if (.not. changed) return
        info = self%formulation%info()
        if (self%controls%project == project_unit) then
            associate (quaternion => self%y(info%quaternion:info%quaternion + 3))
                quaternion = quaternion / norm2(quaternion)
            end associate
        else
            call restore_invariants(self%formulation, info, self%invariants, self%y)
        end if
    end subroutine project

    !> The nearest state with the given invariants, by Newton's method, with each variable in units of its
    !> scale. Each correction is the minimum-norm solution of the linearised conditions (Hairer, Lubich and
    !> Wanner, Geometric Numerical Integration, IV.4). An invariant that is stationary at the state, such as
    !> the energy of a sleeping top, is not a condition.
    subroutine restore_invariants(formulation, info, wanted, y)
        class(formulation_t), intent(in) :: formulation
        type(formulation_info_t), intent(in) :: info
        real(dp), intent(in) :: wanted(max_invariants)
        real(dp), intent(inout) :: y(max_states)
        !> Conditions that are linearly dependent to this tolerance are not independent: at an extremum of the
        !> energy, for example.
        real(dp), parameter :: dependent = 1.0e-6_dp
        real(dp) :: values(max_invariants), matrix(max_invariants, max_states)
        real(dp) :: correction(max_states), noise(max_invariants), row_norm, work(64)
        integer :: iteration, i, columns(max_states), rank, failure

        do iteration = 1, most_corrections
            call formulation%invariants(y, values)
            call find_gradients(formulation, info%states, y, matrix, noise)
            correction(:max_invariants) = wanted - values
            do i = 1, info%invariants
                row_norm = norm2(matrix(i, :info%states))
                if (row_norm <= noise(i)) then
                    matrix(i, :) = 0
                    correction(i) = 0
                    cycle
                end if
                matrix(i, :) = matrix(i, :) / row_norm
                correction(i) = correction(i) / row_norm
            end do
            columns = 0
            call dgelsy(info%invariants, info%states, 1, matrix, max_invariants, correction, &
                        max_states, columns, dependent, rank, work, size(work), failure)
            if (failure /= 0) return
            y(:info%states) = y(:info%states) + correction(:info%states) * formulation%scale(:info%states)
            if (maxval(abs(correction(:info%states))) <= epsilon_dp) return
        end do
    end subroutine restore_invariants

    !> Gradients of the invariants with respect to the variables in units of their scales, one per row, by
    !> central differences; and a bound of the computed gradient of a stationary invariant, due to second
    !> derivatives and rounding errors.
    subroutine find_gradients(formulation, states, y, gradient, noise)
        class(formulation_t), intent(in) :: formulation
        integer, intent(in) :: states
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: gradient(max_invariants, max_states)
        real(dp), intent(out) :: noise(max_invariants)
        real(dp) :: moved(max_states), shift
        real(dp), dimension(max_invariants) :: here, above, below
        integer :: j

        gradient = 0
        noise = 0
        call formulation%invariants(y, here)
        do j = 1, states
            if (formulation%cyclic(j)) cycle
            shift = epsilon_dp**(1.0_dp / 3)
            moved = y
            moved(j) = y(j) + shift * formulation%scale(j)
            call formulation%invariants(moved, above)
            moved(j) = y(j) - shift * formulation%scale(j)
            call formulation%invariants(moved, below)
            gradient(:, j) = (above - below) / (2 * shift)
            noise = max(noise, (abs(above - 2 * here + below) + 8 * epsilon_dp * abs(here)) / (2 * shift))
        end do
    end subroutine find_gradients

end module spintop_stepper
