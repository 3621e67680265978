!> The interface of integrators: one step at a time through any formulation.
!>
!> A stepper holds settings only and is immutable during a run; what changes sits in a workspace.
!> So one stepper serves all threads, each with a workspace of its own.
module spintop_stepper
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_error_weight, only: error_weight_t
    use spintop_formulation, only: formulation_t, max_states, structure_none
    use spintop_projection, only: projection_t, project_nothing
    use spintop_status, only: status_ok, status_non_finite
    implicit none
    private
    public :: stepper_t, method_info_t, controls_t, workspace_t, counts_t, looks_per_step

    !> This many evaluations of the motion within steps count as one step towards `max_steps`.
    integer, parameter :: looks_per_step = 16

    !> Registry entry of a method.
    type :: method_info_t
        !> Name, as it stands in inputs.
        character(20) :: name = ''
        !> What it is, in a few words.
        character(112) :: what = ''
        !> Order of convergence; 0 where it depends on the Butcher table chosen by name.
        integer :: order = 0
        !> Has a variant with a fixed step size.
        logical :: fixed_step = .false.
        !> Has a variant with adaptive steps, chosen by tolerances.
        logical :: adaptive = .false.
        !> Has equations to solve in each step.
        logical :: implicit = .false.
        !> Unchanged when h and the ends of the step are exchanged, so reversible in time.
        logical :: symmetric = .false.
        !> The structure that a formulation must offer to it.
        integer :: needs = structure_none
        !> Takes a Butcher table by name.
        logical :: takes_table = .false.
        !> Tolerances of its own where the user gives none (0: the program's).
        real(dp) :: relative_tolerance = 0, absolute_tolerance = 0
        !> Smallest relative tolerance that its arithmetic resolves.
        real(dp) :: finest_tolerance = 1.0e-17_dp
        !> Caught at a turning point where the speed is reset after each step: see `passes_turns`.
        logical :: caught_by_reset = .false.
        !> Output points per step by its own convention (ode45: 4); 0 without one.
        integer :: refine = 0
    end type method_info_t

    !> What a user may set on a method.
    type :: controls_t
        !> Number of steps of fixed size; 0 lets an adaptive method choose its steps.
        integer :: steps = 0
        !> Error that a step may make: as a share of each state variable (of a radian, for angles that
        !> count their turns and on which nothing depends), and beside that, in radians for the attitude
        !> and as a share of the motion's largest rate and largest momentum for those. With `ode45` and
        !> the paper's formulations the second has MATLAB's meaning: in the unit of each variable.
        real(dp) :: relative_tolerance = 1.0e-9_dp, absolute_tolerance = 1.0e-12_dp
        !> Most work of one run, in steps: tried or taken, and for so many looks within steps one each.
        integer(int64) :: max_steps = 1000000
        !> Solve implicit steps by fixed-point iteration instead of Newton's.
        logical :: fixed_point = .false.
        !> What is projected after each step: see `spintop_projection`.
        integer :: project = project_nothing
        !> Name of a Butcher table; empty for the method's default.
        character(40) :: table = ''
    end type controls_t

    !> What a run cost.
    type :: counts_t
        !> Accepted and rejected steps.
        integer(int64) :: steps = 0, rejected = 0
        !> Evaluations of the motion within steps, to find events and the turns of angles.
        integer(int64) :: looks = 0
        !> Evaluations of the right-hand side and of the Jacobian matrix.
        integer(int64) :: evaluations = 0, jacobians = 0
        !> Inadmissible values that `after_step` had to cut.
        integer(int64) :: clipped = 0
    contains
        procedure :: add
    end type counts_t

    !> A run in progress.
    type :: workspace_t
        !> The span, s.
        real(dp) :: t_begin = 0, t_end = 0
        !> Time and state reached, and the slope y' there.
        real(dp) :: t = 0, y(max_states) = 0, slope(max_states) = 0
        !> Compensation term of the state (Kahan): the state is y + rest.
        real(dp) :: rest(max_states) = 0
        !> Time, state and slope before the last step.
        real(dp) :: t_last = 0, y_last(max_states) = 0, slope_last(max_states) = 0
        !> Size of the next step, s.
        real(dp) :: h = 0
        !> Steps done on the grid of a fixed-step method; -1 once it has left the grid.
        integer :: grid = 0
        !> Weights of step errors, set as an adaptive method begins.
        type(error_weight_t) :: weight
        !> Projection of each new state.
        type(projection_t) :: projection
        !> What the run has cost so far.
        type(counts_t) :: counts
    contains
        procedure :: evaluate
        procedure :: is_spent
        procedure :: settle
        procedure :: settle_change
    end type workspace_t

    !> A method of integration.
    type, abstract :: stepper_t
        !> What the method is.
        type(method_info_t) :: info = method_info_t()
        !> What its user set.
        type(controls_t) :: controls = controls_t()
    contains
        procedure(new_workspace), deferred :: new_workspace
        procedure(begin), deferred :: begin
        procedure(advance), deferred :: advance
        procedure(interpolate), deferred :: interpolate
        procedure :: order
        procedure :: set_weight
    end type stepper_t

    abstract interface
        !> A workspace of the kind this method needs.
        subroutine new_workspace(self, work)
            import :: stepper_t, workspace_t
            class(stepper_t), intent(in) :: self
            class(workspace_t), allocatable, intent(out) :: work
        end subroutine new_workspace

        !> Begins a run at `work%t`, `work%y` (set by the caller, with the span).
        subroutine begin(self, formulation, work, status)
            import :: stepper_t, workspace_t, formulation_t
            class(stepper_t), intent(in) :: self
            class(formulation_t), intent(in) :: formulation
            class(workspace_t), intent(inout) :: work
            integer, intent(out) :: status
        end subroutine begin

        !> Takes one step, never beyond `work%t_end`. On failure the state is the last good one.
        subroutine advance(self, formulation, work, status)
            import :: stepper_t, workspace_t, formulation_t
            class(stepper_t), intent(in) :: self
            class(formulation_t), intent(in) :: formulation
            class(workspace_t), intent(inout) :: work
            integer, intent(out) :: status
        end subroutine advance

        !> The state at a time within the last step.
        function interpolate(self, formulation, work, t) result(y)
            import :: stepper_t, workspace_t, formulation_t, dp, max_states
            class(stepper_t), intent(in) :: self
            class(formulation_t), intent(in) :: formulation
            class(workspace_t), intent(inout) :: work
            real(dp), intent(in) :: t
            real(dp) :: y(max_states)
        end function interpolate
    end interface

contains

    !> Adds what another run cost.
    pure subroutine add(self, other)
        class(counts_t), intent(inout) :: self
        type(counts_t), intent(in) :: other
        self%steps = self%steps + other%steps
        self%rejected = self%rejected + other%rejected
        self%looks = self%looks + other%looks
        self%evaluations = self%evaluations + other%evaluations
        self%jacobians = self%jacobians + other%jacobians
        self%clipped = self%clipped + other%clipped
    end subroutine add

    !> Order of convergence with the settings made.
    integer function order(self)
        class(stepper_t), intent(in) :: self
        order = self%info%order
    end function order

    !> Prepares the run's error control for the tolerances.
    pure subroutine set_weight(self, formulation, work)
        class(stepper_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation
        class(workspace_t), intent(inout) :: work
        call work%weight%set(formulation, self%controls%relative_tolerance, self%controls%absolute_tolerance)
    end subroutine set_weight

    !> Evaluates the right-hand side and counts it; an infinite or undefined slope is `status_non_finite`.
    subroutine evaluate(self, formulation, y, dy, status)
        class(workspace_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: dy(max_states)
        integer, intent(out) :: status
        self%counts%evaluations = self%counts%evaluations + 1
        call formulation%derivative(y, dy, status)
        ! Not by is_finite: a call for each component would cost as much as a right-hand side.
        if (status == status_ok .and. .not. all(abs(dy) <= huge(1.0_dp))) status = status_non_finite
    end subroutine evaluate

    !> Whether the maximum number of steps is reached: accepted, rejected, and evaluations within steps.
    pure logical function is_spent(self, max_steps)
        class(workspace_t), intent(in) :: self
        integer(int64), intent(in) :: max_steps
        associate (counts => self%counts)
            is_spent = counts%steps + counts%rejected + counts%looks / looks_per_step >= max_steps
        end associate
    end function is_spent

    !> Accepts the state `y_new` at `t_new`, after formulation and projection have projected it;
    !> `changed` says whether they changed it. The slope is the caller's to renew.
    subroutine settle(self, formulation, t_new, y_new, changed)
        class(workspace_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t_new, y_new(max_states)
        logical, intent(out) :: changed
        logical :: clipped, projected

        self%t_last = self%t
        self%y_last = self%y
        self%slope_last = self%slope
        self%t = t_new
        self%y = y_new
        call formulation%after_step(self%y, changed, clipped)
        call self%projection%apply(formulation, self%y, projected)
        changed = changed .or. projected
        if (changed) self%rest = 0
        self%counts%steps = self%counts%steps + 1
        if (clipped) self%counts%clipped = self%counts%clipped + 1
    end subroutine settle

    !> Accepts the state reached by a change, summed with compensation (Kahan, Comm. ACM 8, 1965):
    !> the compensation term is kept for the next step.
    subroutine settle_change(self, formulation, t_new, change, changed)
        class(workspace_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t_new, change(max_states)
        logical, intent(out) :: changed
        real(dp) :: total(max_states), y_new(max_states)
        total = change + self%rest
        y_new = self%y + total
        self%rest = total - (y_new - self%y)
        call self%settle(formulation, t_new, y_new, changed)
    end subroutine settle_change

end module spintop_stepper
