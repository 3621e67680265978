!> Runge-Kutta methods of SUNDIALS ARKODE, explicit and diagonally implicit, with the Butcher table
!> chosen by name, adaptive or with a fixed step size.
!>
!> Reynolds, Gardner, Woodward and Chinomona, ACM TOMS 49 (2023).
module spintop_arkode
    use, intrinsic :: iso_c_binding, only: c_int, c_loc
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_archive, only: archive_t
    use spintop_arkode_memory, only: arkode_memory_t
    use spintop_arkode_tables, only: arkode_table_t, find_arkode_table
    use spintop_compare, only: is_equal
    use spintop_fixed_step, only: advance_on_grid, begin_on_grid, grid_stepper_t, longest_step
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_status, only: status_ok, status_outside, status_not_converged, &
        status_step_too_small, status_integrator
    use spintop_stepper, only: workspace_t
    use farkode_mod, only: ARK_CONV_FAILURE, ARK_ERR_FAILURE, ARK_LSETUP_FAIL, ARK_LSOLVE_FAIL, &
        ARK_TOO_MUCH_ACC, ARK_TOO_MUCH_WORK
    implicit none
    private
    public :: arkode_t

    !> ARKStep with an explicit or, if `info%implicit`, a diagonally implicit table.
    type, extends(grid_stepper_t) :: arkode_t
    contains
        procedure :: new_workspace
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

    !> A run in progress.
    type, extends(workspace_t) :: arkode_workspace_t
        type(arkode_memory_t), pointer :: memory => null()
        type(memory_owner_t), allocatable :: owner
    contains
        procedure :: may_keep
        procedure :: carry
    end type arkode_workspace_t

    !> After so many steps ARKODE begins anew, in every run, because its memory cannot be kept.
    integer(int64), parameter :: steps_of_memory = 20000

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
        call find_arkode_table(self%controls%table, self%info%implicit, table, found)
        order = table%order
    end function order

    !> A workspace without a run.
    subroutine new_workspace(self, work)
        class(arkode_t), intent(in) :: self
        class(workspace_t), allocatable, intent(out) :: work !! workspace of the type that the method needs
        associate (unused => self)
        end associate
        allocate (arkode_workspace_t :: work)
    end subroutine new_workspace

    !> First slope, and a new memory of ARKODE. It is created for every run, because the result of a run must
    !> not depend on earlier runs.
    subroutine begin(self, formulation, work, status)
        class(arkode_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(arkode_table_t) :: table
        logical :: found

        call begin_on_grid(self, formulation, work, status)
        if (status /= status_ok) return
        call find_arkode_table(self%controls%table, self%info%implicit, table, found)
        status = status_integrator
        if (.not. found) return
        select type (work)
        class is (arkode_workspace_t)
            if (allocated(work%owner)) deallocate (work%owner)
            allocate (work%memory, work%owner)
            work%owner%memory => work%memory
            call work%memory%create(formulation, work, table, self%controls)
            status = status_ok
        end select
    end subroutine begin

    !> One accepted step; rejected steps are counted.
    subroutine advance(self, formulation, work, status)
        class(arkode_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)

        status = status_ok
        select type (work)
        class is (arkode_workspace_t)
            if (work%may_keep()) call self%begin(formulation, work, status)
            if (status == status_ok) call adopt_state(formulation, work, status)
            if (status /= status_ok) return
            if (self%controls%steps > 0) then
                call advance_on_grid(self, formulation, work, status)
            else
                call advance_adaptively(formulation, work, status)
            end if
        end select
    end subroutine advance

    !> Continues from `work%y` if the caller has changed it since the last step.
    subroutine adopt_state(formulation, work, status)
        class(formulation_t), intent(in) :: formulation
        class(arkode_workspace_t), intent(inout) :: work
        integer, intent(out) :: status

        status = status_ok
        associate (now => work%memory%now)
            if (all(is_equal(work%y, now%y))) return
            now%t = work%t
            now%y = work%y
            call now%evaluate(formulation, now%t, now%y, now%slope, status)
        end associate
        call work%memory%restart()
    end subroutine adopt_state

    !> A step on the grid of fixed step size, or where it ends.
    subroutine try_step(self, formulation, work, h, t_new, status)
        class(arkode_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        real(dp), intent(in) :: h, t_new !! step size, s, and time at its end, s
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        associate (unused => self, also_unused => formulation)
        end associate
        status = status_integrator
        select type (work)
        class is (arkode_workspace_t)
            call work%memory%set_fixed_step(h)
            call take_step(work, t_new, status)
            if (status == status_ok) call set_time(work, t_new)
            if (status == status_outside) call work%memory%restart()
        end select
    end subroutine try_step

    !> A step whose size ARKODE chooses. With an explicit table ARKODE fails at once if the right-hand side
    !> fails within the step; the step is then repeated with a smaller size.
    subroutine advance_adaptively(formulation, work, status)
        class(formulation_t), intent(in) :: formulation
        class(arkode_workspace_t), intent(inout) :: work
        integer, intent(out) :: status
        real(dp) :: stop_time, h, h_smallest

        h_smallest = smallest_spacings * spacing(work%t_end)
        stop_time = min(work%t_end, work%t + longest_step(formulation, work%y))
        if (stop_time - work%t <= h_smallest) then
            call take_tiny_step(work, stop_time, status)
            return
        end if
        do
            call work%memory%set_stop_time(stop_time)
            call take_step(work, work%t_end, status)
            if (status == status_ok .or. work%memory%status == status_ok) exit
            h = cut * work%memory%last_step_tried()
            if (.not. h > 0) h = cut**2 * (stop_time - work%t)
            if (h <= h_smallest) exit
            call work%memory%restart(h)
        end do
    end subroutine advance_adaptively

    !> A step that is too short for step control.
    subroutine take_tiny_step(work, t_new, status)
        class(arkode_workspace_t), intent(inout) :: work
        real(dp), intent(in) :: t_new
        integer, intent(out) :: status

        status = status_step_too_small
        if (t_new <= work%t) return
        call work%memory%restart()
        call work%memory%set_fixed_step(t_new - work%t)
        call take_step(work, t_new, status)
        call work%memory%set_fixed_step(0.0_dp)
        if (status == status_ok) call set_time(work, t_new)
    end subroutine take_tiny_step

    !> One step of ARKODE towards `t_end`, and its status.
    subroutine take_step(work, t_end, status)
        class(arkode_workspace_t), intent(inout) :: work
        real(dp), intent(in) :: t_end
        integer, intent(out) :: status
        integer(c_int) :: flag

        call work%memory%take_step(t_end, flag)
        status = status_of(flag)
        if (status /= status_ok .and. work%memory%status /= status_ok) status = work%memory%status
        associate (now => work%memory%now)
            call take_counts(work)
            if (status /= status_ok) return
            work%t_last = work%t
            work%y_last = work%y
            work%t = now%t
            work%y = now%y
            work%slope = now%slope
        end associate
    end subroutine take_step

    !> Takes the costs inside ARKODE. Evaluations within steps are counted outside.
    subroutine take_counts(work)
        class(arkode_workspace_t), intent(inout) :: work
        integer(int64) :: looks
        looks = work%counts%looks
        work%counts = work%memory%now%counts
        work%counts%looks = looks
    end subroutine take_counts

    !> Sets the end of a step to the intended time: ARKODE sums its steps, with rounding errors.
    subroutine set_time(work, t)
        class(arkode_workspace_t), intent(inout) :: work
        real(dp), intent(in) :: t
        work%t = t
        work%memory%now%t = t
    end subroutine set_time

    !> The state at a time within the last step, to the order of the table (at least 4, at most 8).
    function state_within(self, formulation, work, t) result(y)
        class(arkode_t), intent(in) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
        class(workspace_t), intent(inout) :: work !! state and workspace of the run
        real(dp), intent(in) :: t !! time, s
        real(dp) :: y(max_states)
        associate (unused => self, also_unused => formulation)
        end associate
        y = work%y
        select type (work)
        class is (arkode_workspace_t)
            y = work%memory%interpolate((t - work%t_last) / (work%t - work%t_last))
            call take_counts(work)
        end select
    end function state_within

    !> Whether ARKODE is about to begin anew.
    logical function may_keep(self)
        class(arkode_workspace_t), intent(in) :: self
        may_keep = self%counts%steps > 0 .and. mod(self%counts%steps, steps_of_memory) == 0
    end function may_keep

    !> Carries the workspace without the memory of ARKODE.
    subroutine carry(self, archive)
        class(arkode_workspace_t), target, intent(inout) :: self
        type(archive_t), intent(inout) :: archive !! stores the state, or gives it back
        call archive%carry(c_loc(self%t_begin), storage_size(self%workspace_t))
    end subroutine carry

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
