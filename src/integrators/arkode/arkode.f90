!> Runge-Kutta methods of SUNDIALS ARKODE, explicit and diagonally implicit, with a table of the library or of a user, adaptive
!> or with a fixed step size. arkode.c calls the library; here are the equations and the end of a step.
!>
!> Reynolds, Gardner, Woodward and Chinomona, ACM TOMS 49 (2023).
module spintop_arkode
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_int64_t, c_loc, &
        c_null_char, c_null_ptr, c_ptr
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp, is_equal, is_finite
    use spintop_fixed_step, only: advance_on_grid, begin_on_grid, grid_stepper_t, longest_step
    use spintop_formulation, only: formulation_info_t, max_states
    use spintop_status, only: is_ok, status_integrator, status_non_finite, status_not_converged, status_ok, &
        status_outside, status_step_too_small
    use spintop_stepper, only: run_state_t
    use spintop_text, only: lower_case, string_t
    implicit none
    private
    public :: arkode_table_t, arkode_table_names, find_arkode_table, find_orders, max_arkode_stages, arkode_t

    !> Maximum number of stages.
    integer, parameter :: max_arkode_stages = 16

    !> A table: k_i = f(t + c_i h, y + h sum_j a_ji k_j), y+ = y + h sum_i b_i k_i. Columns of a are stages.
    type, bind(C) :: arkode_table_t
        !> Not 0 if a stage depends on itself.
        integer(c_int) :: implicit = 0
        !> Orders of the method, and of the embedded one, with which step control compares it; 0 if there is none.
        integer(c_int) :: stages = 0, order = 0, embedded_order = 0
        real(c_double) :: a(max_arkode_stages, max_arkode_stages) = 0
        real(c_double), dimension(max_arkode_stages) :: b = 0, embedded = 0, c = 0
    end type arkode_table_t

    interface
        integer(c_int) function name_of_table(implicit, i, name) bind(C, name='spintop_arkode_name')
            import :: c_char, c_int
            integer(c_int), value :: implicit, i
            character(kind=c_char), intent(out) :: name(*)
        end function name_of_table

        pure subroutine find_table(name, implicit, table, found) bind(C, name='spintop_arkode_find')
            import :: arkode_table_t, c_char, c_int
            character(kind=c_char), intent(in) :: name(*)
            integer(c_int), intent(in), value :: implicit
            type(arkode_table_t), intent(inout) :: table
            integer(c_int), intent(out) :: found
        end subroutine find_table

        !> The orders that the coefficients of a table have, as far as conditions are checked: up to 6.
        subroutine find_orders(table, order, embedded_order) bind(C, name='spintop_arkode_orders')
            import :: arkode_table_t, c_int
            type(arkode_table_t), intent(in) :: table !! the table
            integer(c_int), intent(out) :: order, embedded_order !! those of the method and of the embedded one
        end subroutine find_orders

        type(c_ptr) function create_run(n, t, y, unit, scale, absolute, relative, cyclic, table, is_adaptive, by_insertion) &
            bind(C, name='spintop_arkode_create')
            import :: arkode_table_t, c_double, c_int, c_ptr
            integer(c_int), value :: n, is_adaptive, by_insertion
            real(c_double), value :: t
            real(c_double), dimension(*), intent(in) :: y, unit, scale, absolute, relative
            integer(c_int), intent(in) :: cyclic(*)
            type(arkode_table_t), intent(in) :: table
        end function create_run

        integer(c_int) function step_of_run(run, current, h, t_end, t_stop, rejected, jacobians) &
            bind(C, name='spintop_arkode_step')
            import :: c_double, c_int, c_int64_t, c_ptr
            type(c_ptr), value :: run, current
            real(c_double), value :: h, t_end, t_stop
            integer(c_int64_t), intent(inout) :: rejected, jacobians
        end function step_of_run

        subroutine restart_run(run, t, y, h) bind(C, name='spintop_arkode_restart')
            import :: c_double, c_ptr
            type(c_ptr), value :: run
            real(c_double), value :: t, h
            real(c_double), intent(in) :: y(*)
        end subroutine restart_run

        real(c_double) function last_trial(run) bind(C, name='spintop_arkode_last_trial')
            import :: c_double, c_ptr
            type(c_ptr), value :: run
        end function last_trial

        subroutine destroy_run(run) bind(C, name='spintop_arkode_destroy')
            import :: c_ptr
            type(c_ptr), value :: run
        end subroutine destroy_run
    end interface

    !> What the functions that ARKODE calls during a step need.
    type :: step_t
        type(run_state_t), pointer :: run => null()
        logical :: adaptive = .true.
        !> Status of the last evaluation of the right-hand side.
        integer :: status = status_ok
    end type step_t

    !> The run on the side of C. It has no default value: gfortran 14 takes the allocation of a finalizable type with default
    !> values for a structure constructor, which Fortran 2008 would finalize.
    type :: handle_t
        type(c_ptr) :: address
    contains
        final :: release
    end type handle_t

    !> ARKStep with an explicit or, if `info%implicit`, a diagonally implicit table.
    type, extends(grid_stepper_t) :: arkode_t
        !> A table that is not of ARKODE's own.
        type(arkode_table_t), allocatable :: own
        type(handle_t), allocatable :: handle
        type(step_t) :: current = step_t()
        !> The state as ARKODE has it.
        real(dp) :: y_known(max_states) = 0
    contains
        procedure :: begin
        procedure :: advance
        procedure :: try_step
        procedure :: order
    end type arkode_t

    !> Factor of the step size after a failure of the right-hand side.
    real(dp), parameter :: cut = 0.25_dp
    !> ARKODE does not control steps shorter than this, in units of the spacing of the end of the span: it treats so close a stop
    !> time as reached.
    real(dp), parameter :: smallest_spacings = 512
    !> The tolerance for ARKODE with a fixed step size, where it has no effect.
    real(dp), parameter :: fixed_step_tolerance = 1.0e-12_dp
    !> Return values of the functions that ARKODE calls: continue, retry with a shorter step, fail.
    integer(c_int), parameter :: go_on = 0, retry = 1, give_up = -1
    !> What its steps return.
    integer, parameter :: status_of(0:3) = [status_ok, status_step_too_small, status_not_converged, status_integrator]

contains

    !> Names of the explicit or of the implicit tables: those of SUNDIALS in lower case.
    function arkode_table_names(implicit_tables) result(names)
        logical, intent(in) :: implicit_tables !! true for the implicit tables, false for the explicit ones
        type(string_t), allocatable :: names(:)
        character(40) :: name
        integer(c_int) :: i, group
        group = merge(1_c_int, 0_c_int, implicit_tables)
        i = 0
        do while (name_of_table(group, i + 1, name) /= 0)
            i = i + 1
        end do
        allocate (names(i))
        do i = 1, size(names)
            if (name_of_table(group, i, name) /= 0) names(i)%text = lower_case(name(:index(name, c_null_char) - 1))
        end do
    end function arkode_table_names

    !> The explicit or implicit table of a name ('' for the default); `found` reports whether it exists.
    pure subroutine find_arkode_table(name, implicit_table, table, found)
        character(*), intent(in) :: name !! name of the table; '' for the default
        logical, intent(in) :: implicit_table !! whether a diagonally implicit table is requested
        type(arkode_table_t), intent(out) :: table !! the table, if it was found
        logical, intent(out) :: found !! whether it was found
        integer(c_int) :: is_found
        call find_table(trim(name) // c_null_char, merge(1_c_int, 0_c_int, implicit_table), table, is_found)
        found = is_found /= 0
    end subroutine find_arkode_table

    !> Order of the selected table; 0 if there is no table of that name.
    integer function order(self)
        class(arkode_t), intent(in) :: self
        type(arkode_table_t) :: table
        logical :: found
        call find_own_table(self, table, found)
        order = table%order
    end function order

    !> The selected table, or the one that is given.
    subroutine find_own_table(self, table, found)
        class(arkode_t), intent(in) :: self
        type(arkode_table_t), intent(out) :: table
        logical, intent(out) :: found
        found = allocated(self%own)
        if (found) then
            table = self%own
        else
            call find_arkode_table(self%controls%table, self%info%implicit, table, found)
        end if
    end subroutine find_own_table

    !> First slope, and a new run of ARKODE, because the result must not depend on earlier runs. A failure in the library is
    !> reported by the first step.
    subroutine begin(self, status)
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(arkode_table_t) :: table
        type(formulation_info_t) :: info
        real(dp) :: tolerances(2)
        logical :: found

        call begin_on_grid(self, status)
        if (.not. is_ok(status)) return
        status = status_integrator
        call find_own_table(self, table, found)
        if (.not. found) return
        info = self%formulation%info()
        self%current = step_t(adaptive=self%controls%steps == 0)
        tolerances = fixed_step_tolerance
        if (self%current%adaptive) then
            ! ARKODE limits the root mean square of the errors of the components. With this factor no component exceeds its
            ! tolerance, as with ode45.
            tolerances = [self%controls%relative_tolerance, self%controls%absolute_tolerance] / sqrt(real(info%states, dp))
        end if
        call self%set_weight(tolerances(1), tolerances(2))
        self%y_known = self%y
        if (allocated(self%handle)) deallocate (self%handle)
        allocate (self%handle)
        self%handle%address = create_run(int(info%states, c_int), self%t, self%y, self%formulation%units(), &
            self%formulation%scale, self%weight%absolute, self%weight%relative, merge(1_c_int, 0_c_int, self%formulation%cyclic), &
            table, merge(1_c_int, 0_c_int, self%current%adaptive), merge(1_c_int, 0_c_int, self%controls%fixed_point))
        if (c_associated(self%handle%address)) status = status_ok
    end subroutine begin

    !> One accepted step; rejected steps are counted.
    subroutine advance(self, status)
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        status = status_ok
        if (.not. all(is_equal(self%y, self%y_known))) then
            ! The caller has changed the state since the last step.
            call self%evaluate(self%t, self%y, self%slope, status)
            call restart(self, 0.0_dp)
        end if
        if (.not. is_ok(status)) return
        if (self%current%adaptive) then
            call advance_adaptively(self, status)
        else
            call advance_on_grid(self, status)
        end if
    end subroutine advance

    !> Makes ARKODE go on from the state, with a first step of size `h` if that is not 0.
    subroutine restart(self, h)
        class(arkode_t), intent(inout) :: self
        real(dp), intent(in) :: h
        self%y_known = self%y
        call restart_run(self%handle%address, self%t, self%y, h)
    end subroutine restart

    !> A step on the grid of fixed step size, or where it ends.
    subroutine try_step(self, h, t_new, status)
        class(arkode_t), intent(inout) :: self
        real(dp), intent(in) :: h, t_new !! step size, s, and time at its end, s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call take_step(self, h, t_new, t_new, status)
        ! ARKODE sums its steps, with rounding errors.
        if (is_ok(status)) self%t = t_new
        if (status == status_outside) call restart(self, 0.0_dp)
    end subroutine try_step

    !> A step whose size ARKODE chooses. With an explicit table ARKODE fails at once if the right-hand side fails within the
    !> step; the step is then repeated with a smaller size.
    subroutine advance_adaptively(self, status)
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status
        real(dp) :: stop_time, h, h_smallest

        h_smallest = smallest_spacings * spacing(self%t_end)
        stop_time = min(self%t_end, self%t + longest_step(self%formulation, self%y))
        if (stop_time - self%t <= h_smallest) then
            ! Too short for step control.
            status = status_step_too_small
            if (stop_time <= self%t) return
            call restart(self, 0.0_dp)
            call take_step(self, stop_time - self%t, stop_time, stop_time, status)
            if (is_ok(status)) self%t = stop_time
            return
        end if
        do
            call take_step(self, 0.0_dp, self%t_end, stop_time, status)
            if (is_ok(status) .or. is_ok(self%current%status)) exit
            h = cut * last_trial(self%handle%address)
            if (.not. h > 0) h = cut**2 * (stop_time - self%t)
            if (h <= h_smallest) exit
            call restart(self, h)
        end do
    end subroutine advance_adaptively

    !> One step of ARKODE, of the size `h` if that is not 0, and its status. After a failure the state is the one before.
    subroutine take_step(self, h, t_end, t_stop, status)
        class(arkode_t), intent(inout), target :: self
        real(dp), intent(in) :: h, t_end, t_stop
        integer, intent(out) :: status
        type(run_state_t) :: before
        integer(c_int64_t) :: rejected, jacobians
        integer(int64) :: evaluations

        before = self%run_state_t
        rejected = 0
        jacobians = 0
        self%current%run => self%run_state_t
        self%current%status = status_ok
        status = status_of(step_of_run(self%handle%address, c_loc(self%current), h, t_end, t_stop, rejected, jacobians))
        if (.not. is_ok(status)) then
            evaluations = self%counts%evaluations
            self%run_state_t = before
            self%counts%evaluations = evaluations
            if (.not. is_ok(self%current%status)) status = self%current%status
        end if
        self%y_known = self%y
        self%counts%rejected = self%counts%rejected + rejected
        self%counts%jacobians = self%counts%jacobians + jacobians
    end subroutine take_step

    subroutine release(self)
        type(handle_t), intent(inout) :: self
        call destroy_run(self%address)
        self%address = c_null_ptr
    end subroutine release

    !> y' = f(t, y), called by ARKODE. The slope at the state reached is known and costs nothing.
    integer(c_int) function find_slope(current, t, y, slope) bind(C, name='spintop_arkode_rhs') result(verdict)
        type(c_ptr), value :: current
        real(c_double), value :: t
        real(c_double), intent(in) :: y(max_states)
        real(c_double), intent(inout) :: slope(max_states)
        type(step_t), pointer :: now
        logical :: known

        call c_f_pointer(current, now)
        known = all(is_equal(y, now%run%y))
        if (now%run%formulation%depends_on_time) known = known .and. is_equal(t, now%run%t)
        if (known) then
            now%status = status_ok
            slope = now%run%slope
        else
            call now%run%evaluate(t, y, slope, now%status)
        end if
        verdict = go_on
        if (is_ok(now%status)) return
        verdict = give_up
        if (now%adaptive .or. now%status == status_outside) verdict = retry
    end function find_slope

    !> After an accepted step to `t`, called by ARKODE, which continues from the state that the formulation makes of it.
    integer(c_int) function finish_step(current, t, y) bind(C, name='spintop_arkode_finish') result(verdict)
        type(c_ptr), value :: current
        real(c_double), value :: t
        real(c_double), intent(inout) :: y(max_states)
        type(step_t), pointer :: now
        logical :: changed

        call c_f_pointer(current, now)
        verdict = give_up
        now%status = status_non_finite
        if (.not. all(is_finite(y))) return
        call now%run%accept_step(t, y, changed)
        y = now%run%y
        call now%run%evaluate(t, now%run%y, now%run%slope, now%status)
        if (is_ok(now%status)) verdict = go_on
    end function finish_step

end module spintop_arkode
