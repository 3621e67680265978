!> Runge-Kutta methods of SUNDIALS ARKODE, explicit and diagonally implicit, with the Butcher table
!> chosen by name, adaptive or with a fixed step size.
!>
!> Reynolds, Gardner, Woodward and Chinomona, ACM TOMS 49 (2023).
module spintop_arkode
    use, intrinsic :: iso_c_binding, only: c_int
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_arkode_memory, only: arkode_memory_t
    use spintop_arkode_tables, only: arkode_table_t, find_arkode_table
    use spintop_tableau, only: tableau_t
    use spintop_compare, only: is_equal
    use spintop_fixed_step, only: advance_on_grid, begin_on_grid, grid_stepper_t, longest_step
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_status, only: is_ok, status_integrator, status_not_converged, status_ok, status_outside, status_step_too_small
    use farkode_mod, only: ARK_CONV_FAILURE, ARK_ERR_FAILURE, ARK_LSETUP_FAIL, ARK_LSOLVE_FAIL, &
        ARK_TOO_MUCH_ACC, ARK_TOO_MUCH_WORK
    implicit none
    private
    public :: arkode_t

    !> ARKStep with an explicit or, if `info%implicit`, a diagonally implicit table.
    type, extends(grid_stepper_t) :: arkode_t
        type(arkode_memory_t), pointer :: memory => null()
        type(memory_owner_t), allocatable :: owner
        !> A table that is not of ARKODE's own.
        type(tableau_t), allocatable :: own
    contains
        procedure :: begin
        procedure :: advance
        procedure :: try_step
        procedure :: state_within
        procedure :: order
    end type arkode_t

    !> Owns the memory that ARKODE allocates for a run. It has no default values: gfortran 14 takes the
    !> allocation of a finalizable type with default values for a structure constructor, which Fortran 2008
    !> would finalize.
    type :: memory_owner_t
        ! allow(C101): this type must not have a default value
        type(arkode_memory_t), pointer :: memory
    contains
        final :: release
    end type memory_owner_t

    !> Factor of the step size after a failure of the right-hand side.
    real(dp), parameter :: cut = 0.25_dp
    !> ARKODE does not control steps shorter than this, in units of the spacing of the end of the span: it
    !> treats so close a stop time as reached.
    real(dp), parameter :: smallest_spacings = 512

contains

    !> Order of the selected table; 0 if there is no table of that name.
    integer function order(self)
        class(arkode_t), intent(in) :: self
        type(arkode_table_t) :: table
        logical :: found
        call find_table(self, table, found)
        order = table%order
    end function order

    !> The selected table, or what ARKODE has to know about one that is given.
    subroutine find_table(self, table, found)
        class(arkode_t), intent(in) :: self
        type(arkode_table_t), intent(out) :: table !! the table, if it was found
        logical, intent(out) :: found !! whether it exists
        if (allocated(self%own)) then
            table = arkode_table_t(self%own%name, 0, self%info%implicit, self%own%stages, self%own%order, self%own%embedded_order)
            found = .true.
        else
            call find_arkode_table(self%controls%table, self%info%implicit, table, found)
        end if
    end subroutine find_table

    !> First slope, and a new memory of ARKODE. It is created for every run, because the result of a run must
    !> not depend on earlier runs.
    subroutine begin(self, formulation, status)
        class(arkode_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(arkode_table_t) :: table
        logical :: found

        call begin_on_grid(self, formulation, status)
        if (.not. is_ok(status)) return
        call find_table(self, table, found)
        status = status_integrator
        if (.not. found) return
        if (allocated(self%owner)) deallocate (self%owner)
        allocate (self%memory, self%owner)
        self%owner%memory => self%memory
        call self%memory%create(formulation, self%run_state_t, table, self%controls, self%own)
        status = status_ok
    end subroutine begin

    !> One accepted step; rejected steps are counted.
    subroutine advance(self, formulation, status)
        class(arkode_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        status = status_ok
        call adopt_state(formulation, self, status)
        if (.not. is_ok(status)) return
        if (self%controls%steps > 0) then
            call advance_on_grid(self, formulation, status)
        else
            call advance_adaptively(formulation, self, status)
        end if
    end subroutine advance

    !> Continues from `y` if the caller has changed it since the last step.
    subroutine adopt_state(formulation, self, status)
        class(formulation_t), intent(in) :: formulation
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status

        status = status_ok
        associate (now => self%memory%now)
            if (all(is_equal(self%y, now%y))) return
            now%t = self%t
            now%y = self%y
            call now%evaluate(formulation, now%t, now%y, now%slope, status)
        end associate
        call self%memory%restart()
    end subroutine adopt_state

    !> A step on the grid of fixed step size, or where it ends.
    subroutine try_step(self, formulation, h, t_new, status)
        class(arkode_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(in) :: h, t_new !! step size, s, and time at its end, s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        status = status_integrator
        call self%memory%set_fixed_step(h)
        call take_step(self, t_new, status)
        if (is_ok(status)) call set_time(self, t_new)
        if (status == status_outside) call self%memory%restart()
    end subroutine try_step

    !> A step whose size ARKODE chooses. With an explicit table ARKODE fails at once if the right-hand side
    !> fails within the step; the step is then repeated with a smaller size.
    subroutine advance_adaptively(formulation, self, status)
        class(formulation_t), intent(in) :: formulation
        class(arkode_t), intent(inout) :: self
        integer, intent(out) :: status
        real(dp) :: stop_time, h, h_smallest

        h_smallest = smallest_spacings * spacing(self%t_end)
        stop_time = min(self%t_end, self%t + longest_step(formulation, self%y))
        if (stop_time - self%t <= h_smallest) then
            call take_tiny_step(self, stop_time, status)
            return
        end if
        do
            call self%memory%set_stop_time(stop_time)
            call take_step(self, self%t_end, status)
            if (is_ok(status) .or. is_ok(self%memory%status)) exit
            h = cut * self%memory%last_step_tried()
            if (.not. h > 0) h = cut**2 * (stop_time - self%t)
            if (h <= h_smallest) exit
            call self%memory%restart(h)
        end do
    end subroutine advance_adaptively

    !> A step that is too short for step control.
    subroutine take_tiny_step(self, t_new, status)
        class(arkode_t), intent(inout) :: self
        real(dp), intent(in) :: t_new
        integer, intent(out) :: status

        status = status_step_too_small
        if (t_new <= self%t) return
        call self%memory%restart()
        call self%memory%set_fixed_step(t_new - self%t)
        call take_step(self, t_new, status)
        call self%memory%set_fixed_step(0.0_dp)
        if (is_ok(status)) call set_time(self, t_new)
    end subroutine take_tiny_step

    !> One step of ARKODE towards `t_end`, and its status.
    subroutine take_step(self, t_end, status)
        class(arkode_t), intent(inout) :: self
        real(dp), intent(in) :: t_end
        integer, intent(out) :: status
        integer(c_int) :: flag

        call self%memory%take_step(t_end, flag)
        status = status_of(flag)
        if (.not. is_ok(status) .and. .not. is_ok(self%memory%status)) status = self%memory%status
        associate (now => self%memory%now)
            call update_counts(self)
            if (.not. is_ok(status)) return
            self%t_last = self%t
            self%y_last = self%y
            self%t = now%t
            self%y = now%y
            self%slope = now%slope
        end associate
    end subroutine take_step

    !> Updates the costs by those inside ARKODE. Evaluations within steps are counted outside.
    subroutine update_counts(self)
        class(arkode_t), intent(inout) :: self
        integer(int64) :: looks
        looks = self%counts%looks
        self%counts = self%memory%now%counts
        self%counts%looks = looks
    end subroutine update_counts

    !> Sets the end of a step to the intended time: ARKODE sums its steps, with rounding errors.
    subroutine set_time(self, t)
        class(arkode_t), intent(inout) :: self
        real(dp), intent(in) :: t
        self%t = t
        self%memory%now%t = t
    end subroutine set_time

    !> The state at a time within the last step, to the order of the table (at least 4, at most 8).
    function state_within(self, formulation, t) result(y)
        class(arkode_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        y = self%memory%interpolate((t - self%t_last) / (self%t - self%t_last))
        call update_counts(self)
    end function state_within

    !> Status for a return value of ARKODE.
    pure integer function status_of(flag)
        integer(c_int), intent(in) :: flag
        select case (flag)
        case (0:)
            status_of = status_ok
        case (ARK_ERR_FAILURE, ARK_TOO_MUCH_WORK, ARK_TOO_MUCH_ACC)
            status_of = status_step_too_small
        case (ARK_CONV_FAILURE, ARK_LSETUP_FAIL, ARK_LSOLVE_FAIL)
            status_of = status_not_converged
        case default
            status_of = status_integrator
        end select
    end function status_of

    subroutine release(self)
        type(memory_owner_t), intent(inout) :: self
        call self%memory%destroy()
        deallocate (self%memory)
    end subroutine release

end module spintop_arkode
