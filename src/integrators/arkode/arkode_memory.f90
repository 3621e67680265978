!> A run inside SUNDIALS ARKODE: its memory on the C side, and its callbacks.
!>
!> Explicit tables also use ARKStep: ERKStep of SUNDIALS 6.4 loses orders for tables whose last stage is at
!> the end of the step without being the first stage of the next step. Each memory has its own SUNContext, so
!> that runs in several threads share nothing.
module spintop_arkode_memory
    use, intrinsic :: iso_c_binding, only: c_double, c_funloc, c_int, c_loc, &
        c_long, c_null_funptr, c_null_ptr, c_associated, c_f_pointer, c_ptr
    use, intrinsic :: iso_fortran_env, only: int64
    use farkode_arkstep_mod, only: &
        FARKStepCreate, FARKStepEvolve, FARKStepFree, FARKStepGetCurrentStep, &
        FARKStepGetNumJacEvals, FARKStepGetNumStepAttempts, FARKStepGetNumSteps, FARKStepReset, &
        FARKStepWFtolerances, FARKStepSetAdaptivityMethod, FARKStepSetDeduceImplicitRhs, &
        FARKStepSetFixedStep, FARKStepSetInitStep, &
        FARKStepSetInterpolantDegree, FARKStepSetJacEvalFrequency, FARKStepSetLSetupFrequency, &
        FARKStepSetLinearSolver, FARKStepSetMaxConvFails, FARKStepSetMaxErrTestFails, &
        FARKStepSetMaxNonlinIters, FARKStepSetMaxNumSteps, FARKStepSetNonlinConvCoef, &
        FARKStepSetNonlinRDiv, FARKStepSetNonlinearSolver, FARKStepSetPostprocessStepFn, &
        FARKStepSetStopTime, FARKStepSetTableNum, FARKStepSetUserData
    use farkode_mod, only: ARK_ADAPT_I, ARK_MEM_FAIL, ARK_ONE_STEP, ARKODE_DIRK_NONE, ARKODE_ERK_NONE
    use fnvector_serial_mod, only: FN_VMake_Serial
    use fsunlinsol_dense_mod, only: FSUNLinSol_Dense
    use fsunmatrix_dense_mod, only: FSUNDenseMatrix
    use fsunnonlinsol_fixedpoint_mod, only: FSUNNonlinSol_FixedPoint
    use fsunnonlinsol_newton_mod, only: FSUNNonlinSol_Newton
    use spintop_arkode_stages, only: judge_correction, stage_history_t
    use spintop_arkode_tables, only: arkode_table_t, set_own_table
    use spintop_compare, only: is_equal, is_finite
    use spintop_error_tolerances, only: error_weight_t
    use spintop_dense_output, only: dense_output_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_kinds, only: dp
    use spintop_status, only: is_ok, status_non_finite, status_ok, status_outside
    use spintop_stepper, only: controls_t, counts_t, run_state_t
    use spintop_tableau, only: tableau_t
    use spintop_sundials, only: FN_VDestroy, FN_VGetArrayPointer, FSUNContext_Free, FSUNLinSolFree, FSUNMatDestroy, &
        FSUNNonlinSolFree, FSUNNonlinSolSetConvTestFn, N_Vector, SUNLinearSolver, SUNMatrix, SUNNonlinearSolver, &
        create_context, index_kind, silence
    implicit none
    private
    public :: arkode_memory_t

    !> One run. It must not move in memory, because ARKODE stores its address. ARKODE computes in the units of the state,
    !> `formulation_t%units`, so that its linear equations do not depend on those of mass, length and time.
    type :: arkode_memory_t
        !> Time, state, slope and counts as ARKODE has them.
        type(run_state_t) :: now
        !> Admissible error of a step, as a root mean square.
        type(error_weight_t), private :: weight
        !> Status of the last evaluation of the right-hand side.
        integer :: status = status_ok
        !> A copy: dense output also needs the equations, where no formulation is available.
        class(formulation_t), allocatable, private :: formulation
        !> First failure of a call to SUNDIALS, negative.
        integer(c_int), private :: flag = 0
        integer, private :: states = 0
        logical, private :: adaptive = .true.
        !> Storage of the vector that ARKODE writes to: the state in these units.
        real(c_double), private :: state(max_states) = 0, unit(max_states) = 1
        !> Slope before the last step, and the polynomial over that step if dense output was needed.
        real(dp), private :: slope_last(max_states) = 0
        type(dense_output_t), private :: dense
        logical, private :: dense_is_known = .false.
        !> Cost of the run before this memory was created: ARKODE counts from there.
        type(counts_t), private :: earlier
        !> Ends the iterations for stages with a fixed step size.
        type(stage_history_t), private :: stage_history
        type(c_ptr), private :: context = c_null_ptr, integrator = c_null_ptr
        type(N_Vector), pointer, private :: state_vector => null()
        type(SUNMatrix), pointer, private :: matrix => null()
        type(SUNLinearSolver), pointer, private :: linear_solver => null()
        type(SUNNonlinearSolver), pointer, private :: nonlinear_solver => null()
    contains
        procedure :: create
        procedure :: restart
        procedure :: set_fixed_step
        procedure :: set_stop_time
        procedure :: take_step
        procedure :: last_step_tried
        procedure :: interpolate
        procedure :: destroy
    end type arkode_memory_t

    !> Maximum number of consecutive failures of a step in ARKODE: enough to reduce the step from the length
    !> of the span to the rounding error of the time.
    integer(c_int), parameter :: most_failures = 60
    !> Maximum number of Newton or fixed-point iterations per stage.
    integer(c_int), parameter :: newton_limit = 30, fixed_point_limit = 200
    !> Growth of a correction in fixed-point iteration that does not count as divergence.
    real(c_double), parameter :: growth_allowed = 100
    !> Accepted residual of the equation of a stage, relative to the tolerance.
    real(c_double), parameter :: stage_share = 1.0e-2_c_double
    !> The tolerance for ARKODE with a fixed step size, where it has no effect.
    real(c_double), parameter :: fixed_step_tolerance = 1.0e-12_c_double
    !> Return values of a callback: continue, retry with a shorter step, fail.
    integer(c_int), parameter :: go_on = 0, retry = 1, give_up = -1

contains

    !> Prepares ARKODE for a run from `run%t`, `run%y` and `run%slope`. A failure is reported by the first
    !> step.
    subroutine create(self, formulation, run, table, controls, own)
        class(arkode_memory_t), intent(inout), target :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(run_state_t), intent(in) :: run !! span, time, state and slope at the start of the run
        type(arkode_table_t), intent(in) :: table !! Butcher table of ARKODE, or what it has to know of another one
        type(controls_t), intent(in) :: controls !! settings of the method
        type(tableau_t), intent(in), optional :: own !! a table that is not of ARKODE's own
        type(formulation_info_t) :: info
        integer(index_kind) :: n

        info = formulation%info()
        self%states = info%states
        n = int(self%states, index_kind)
        allocate (self%formulation, source=formulation)
        self%adaptive = controls%steps == 0
        self%now%t = run%t
        self%now%y = run%y
        self%now%slope = run%slope
        self%now%counts = run%counts
        self%earlier = run%counts
        self%now%projection = run%projection
        self%unit = formulation%units()
        self%state = run%y / self%unit
        call self%dense%set_order(table%order)
        call keep(self, create_context(self%context))
        if (self%flag < 0) return
        self%state_vector => FN_VMake_Serial(n, self%state, self%context)
        if (table%implicit) then
            self%integrator = FARKStepCreate(c_null_funptr, c_funloc(rhs), run%t, &
                                             self%state_vector, self%context)
        else
            self%integrator = FARKStepCreate(c_funloc(rhs), c_null_funptr, run%t, &
                                             self%state_vector, self%context)
        end if
        if (.not. c_associated(self%integrator)) call keep(self, ARK_MEM_FAIL)
        if (self%flag < 0) return
        ! This comes first, so that no later call prints.
        call keep(self, silence(self%integrator))
        if (present(own)) then
            call keep(self, set_own_table(self%integrator, own))
        else if (table%implicit) then
            call keep(self, FARKStepSetTableNum(self%integrator, table%id, ARKODE_ERK_NONE))
        else
            call keep(self, FARKStepSetTableNum(self%integrator, ARKODE_DIRK_NONE, table%id))
        end if
        call set_options(self, controls)
        if (table%implicit) call set_implicit_options(self, controls)
    end subroutine create

    !> Remembers the first failure of a call to SUNDIALS.
    subroutine keep(self, flag)
        class(arkode_memory_t), intent(inout) :: self
        integer(c_int), intent(in) :: flag
        if (self%flag >= 0) self%flag = flag
    end subroutine keep

    !> Options of every run.
    subroutine set_options(self, controls)
        type(arkode_memory_t), intent(inout), target :: self
        type(controls_t), intent(in) :: controls
        real(c_double) :: relative, absolute, unused(3)

        associate (ark => self%integrator)
            call keep(self, FARKStepSetUserData(ark, c_loc(self)))
            relative = fixed_step_tolerance
            absolute = fixed_step_tolerance
            if (self%adaptive) then
                ! ARKODE limits the root mean square of the errors of the components. With this factor no
                ! component exceeds its tolerance, as with ode45.
                relative = controls%relative_tolerance / sqrt(real(self%states, dp))
                absolute = controls%absolute_tolerance / sqrt(real(self%states, dp))
            end if
            call self%weight%set(self%formulation, relative, absolute)
            call keep(self, FARKStepWFtolerances(ark, c_funloc(find_weights)))
            ! The I controller: for this smooth motion it needs one sixth fewer evaluations than the default
            ! of ARKODE.
            unused = 0
            call keep(self, FARKStepSetAdaptivityMethod(ark, ARK_ADAPT_I, 1_c_int, 0_c_int, unused))
            call keep(self, FARKStepSetMaxNumSteps(ark, -1_c_long))
            call keep(self, FARKStepSetMaxErrTestFails(ark, most_failures))
            call keep(self, FARKStepSetMaxConvFails(ark, most_failures))
            call keep(self, FARKStepSetPostprocessStepFn(ark, c_funloc(finish_step)))
            ! Higher interpolants evaluate the right-hand side at every stop time, and they have no advantage
            ! here: that of degree 5 has the error of one of degree 4 (seen in 6.4 and 7.5).
            call keep(self, FARKStepSetInterpolantDegree(ark, 3_c_int))
        end associate
    end subroutine set_options

    !> Options of implicit tables: the solver for the equations of the stages.
    subroutine set_implicit_options(self, controls)
        type(arkode_memory_t), intent(inout), target :: self
        type(controls_t), intent(in) :: controls
        integer(index_kind) :: n

        n = int(self%states, index_kind)
        self%stage_history%scale = self%formulation%scale / self%unit
        self%stage_history%cyclic = self%formulation%cyclic
        if (controls%fixed_point) self%stage_history%divergence = growth_allowed
        associate (ark => self%integrator)
            if (controls%fixed_point) then
                self%nonlinear_solver => FSUNNonlinSol_FixedPoint(self%state_vector, 0_c_int, &
                                                                  self%context)
                call keep(self, FARKStepSetNonlinearSolver(ark, self%nonlinear_solver))
                call keep(self, FARKStepSetMaxNonlinIters(ark, fixed_point_limit))
                ! A correction of an angle causes a larger one of its rate before both decrease.
                call keep(self, FARKStepSetNonlinRDiv(ark, growth_allowed))
            else
                self%nonlinear_solver => FSUNNonlinSol_Newton(self%state_vector, self%context)
                call keep(self, FARKStepSetNonlinearSolver(ark, self%nonlinear_solver))
                self%matrix => FSUNDenseMatrix(n, n, self%context)
                self%linear_solver => FSUNLinSol_Dense(self%state_vector, self%matrix, self%context)
                call keep(self, FARKStepSetLinearSolver(ark, self%linear_solver, self%matrix))
                ! By default a Jacobian is used for 50 steps and a factorisation for 20, and the estimate of
                ! the resulting error fails at tight tolerances.
                call keep(self, FARKStepSetLSetupFrequency(ark, 1_c_int))
                call keep(self, FARKStepSetJacEvalFrequency(ark, 1_c_long))
                call keep(self, FARKStepSetMaxNonlinIters(ark, newton_limit))
            end if
            call keep(self, FARKStepSetNonlinConvCoef(ark, stage_share))
            if (.not. self%adaptive) call keep(self, FSUNNonlinSolSetConvTestFn( &
                self%nonlinear_solver, c_funloc(judge_correction), c_loc(self%stage_history)))
            call keep(self, FARKStepSetDeduceImplicitRhs(ark, 1_c_int))
        end associate
    end subroutine set_implicit_options

    !> Resets ARKODE to `now`, with a first step of size `h` if given.
    subroutine restart(self, h)
        class(arkode_memory_t), intent(inout) :: self
        real(dp), intent(in), optional :: h !! size of the first step, s
        self%state = self%now%y / self%unit
        call keep(self, FARKStepReset(self%integrator, self%now%t, self%state_vector))
        if (present(h)) call keep(self, FARKStepSetInitStep(self%integrator, h))
    end subroutine restart

    !> Turns step control off: the following steps have this size. With 0, step control is on again.
    subroutine set_fixed_step(self, h)
        class(arkode_memory_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s; 0 for step control
        call keep(self, FARKStepSetFixedStep(self%integrator, h))
    end subroutine set_fixed_step

    !> Time that the next step must not pass.
    subroutine set_stop_time(self, t)
        class(arkode_memory_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        call keep(self, FARKStepSetStopTime(self%integrator, t))
    end subroutine set_stop_time

    !> One step, which updates `now`. On failure (negative `flag`) only the counts change.
    subroutine take_step(self, t_end, flag)
        ! A target, because the callbacks change it.
        class(arkode_memory_t), intent(inout), target :: self
        real(dp), intent(in) :: t_end !! end of the span, s
        integer(c_int), intent(out) :: flag !! return value of ARKODE; negative on failure
        type(run_state_t) :: before
        real(c_double) :: t_reached(1)
        integer(c_long) :: attempts(1), steps(1), jacobians(1)
        integer(c_int) :: ignored
        integer(int64) :: evaluations

        flag = self%flag
        if (flag < 0) return
        before = self%now
        self%stage_history%y = self%now%y / self%unit
        self%status = status_ok
        flag = FARKStepEvolve(self%integrator, t_end, self%state_vector, t_reached, ARK_ONE_STEP)
        if (flag < 0) then
            evaluations = self%now%counts%evaluations
            self%now = before
            self%now%counts%evaluations = evaluations
        else
            self%slope_last = before%slope
            self%dense_is_known = .false.
        end if
        ignored = FARKStepGetNumStepAttempts(self%integrator, attempts)
        ignored = FARKStepGetNumSteps(self%integrator, steps)
        self%now%counts%rejected = self%earlier%rejected + attempts(1) - steps(1)
        if (.not. associated(self%linear_solver)) return
        ignored = FARKStepGetNumJacEvals(self%integrator, jacobians)
        self%now%counts%jacobians = self%earlier%jacobians + jacobians(1)
    end subroutine take_step

    !> Step size of the last trial.
    real(dp) function last_step_tried(self) result(h)
        class(arkode_memory_t), intent(inout) :: self
        real(c_double) :: current(1)
        integer(c_int) :: flag
        flag = FARKStepGetCurrentStep(self%integrator, current)
        h = merge(current(1), 0.0_c_double, flag >= 0)
    end function last_step_tried

    !> The state at a fraction of the last step.
    function interpolate(self, fraction) result(y)
        class(arkode_memory_t), intent(inout) :: self
        real(dp), intent(in) :: fraction !! position in the step, from 0 to 1
        real(dp) :: y(max_states)
        if (.not. self%dense_is_known) then
            call self%dense%fit(self%formulation, self%now, self%slope_last)
        end if
        self%dense_is_known = .true.
        y = self%dense%at(fraction)
    end function interpolate

    !> Frees all memory.
    subroutine destroy(self)
        class(arkode_memory_t), intent(inout) :: self
        integer(c_int) :: ignored
        if (c_associated(self%integrator)) call FARKStepFree(self%integrator)
        if (associated(self%nonlinear_solver)) ignored = FSUNNonlinSolFree(self%nonlinear_solver)
        if (associated(self%linear_solver)) ignored = FSUNLinSolFree(self%linear_solver)
        if (associated(self%matrix)) call FSUNMatDestroy(self%matrix)
        if (associated(self%state_vector)) call FN_VDestroy(self%state_vector)
        if (c_associated(self%context)) ignored = FSUNContext_Free(self%context)
    end subroutine destroy

    !> The callback that computes y' = f(t, y). The slope at the state reached is known and costs nothing.
    integer(c_int) function rhs(t, y_vector, slope_vector, data) bind(C, name='')
        real(c_double), value :: t
        type(N_Vector), intent(inout) :: y_vector, slope_vector
        type(c_ptr), value :: data
        type(arkode_memory_t), pointer :: self
        real(c_double), pointer :: y_now(:), slope_now(:)
        real(dp) :: y(max_states), slope(max_states)
        logical :: known

        call c_f_pointer(data, self)
        y_now => FN_VGetArrayPointer(y_vector)
        slope_now => FN_VGetArrayPointer(slope_vector)
        y = 0
        y(1:self%states) = y_now * self%unit(1:self%states)
        known = all(is_equal(y, self%now%y))
        if (self%formulation%depends_on_time) known = known .and. is_equal(t, self%now%t)
        if (known) then
            self%status = status_ok
            slope = self%now%slope
        else
            call self%now%evaluate(self%formulation, t, y, slope, self%status)
        end if
        slope_now = slope(1:self%states) / self%unit(1:self%states)
        rhs = go_on
        if (is_ok(self%status)) return
        rhs = give_up
        if (self%adaptive .or. self%status == status_outside) rhs = retry
    end function rhs

    !> The callback that computes the weights by which errors are multiplied in a norm.
    integer(c_int) function find_weights(y_vector, weight_vector, data) bind(C, name='')
        type(N_Vector), intent(inout) :: y_vector, weight_vector
        type(c_ptr), value :: data
        type(arkode_memory_t), pointer :: self
        real(c_double), pointer :: y_now(:), weights(:)
        real(dp) :: y(max_states), allowed(max_states)

        call c_f_pointer(data, self)
        y_now => FN_VGetArrayPointer(y_vector)
        weights => FN_VGetArrayPointer(weight_vector)
        y = 0
        y(1:self%states) = y_now * self%unit(1:self%states)
        allowed = self%weight%allowed(y, y)
        weights = self%unit(1:self%states) / allowed(1:self%states)
        find_weights = merge(go_on, give_up, all(allowed(1:self%states) > 0))
    end function find_weights

    !> The callback after an accepted step to `t`. ARKODE continues from the state that the formulation makes
    !> of it.
    integer(c_int) function finish_step(t, y_vector, data) bind(C, name='')
        real(c_double), value :: t
        type(N_Vector), intent(inout) :: y_vector
        type(c_ptr), value :: data
        type(arkode_memory_t), pointer :: self
        real(c_double), pointer :: y_now(:)
        real(dp) :: y(max_states)
        logical :: changed

        call c_f_pointer(data, self)
        y_now => FN_VGetArrayPointer(y_vector)
        y = 0
        y(1:self%states) = y_now * self%unit(1:self%states)
        finish_step = give_up
        self%status = status_non_finite
        if (.not. all(is_finite(y))) return
        call self%now%accept_step(self%formulation, t, y, changed)
        if (changed) y_now = self%now%y(1:self%states) / self%unit(1:self%states)
        call self%now%evaluate(self%formulation, t, self%now%y, self%now%slope, self%status)
        if (is_ok(self%status)) finish_step = go_on
    end function finish_step

end module spintop_arkode_memory
