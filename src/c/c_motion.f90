!> A motion that is asked for its columns at any times: in closed form, or integrated up to the last of them. It does not
!> change after it was prepared, so threads may share it.
module spintop_c_motion
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp, no_number
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_plan, only: plan_t
    use spintop_trajectory_columns, only: row_maker_t
    use spintop_status, only: is_good_end, is_ok, status_bad_samples, status_non_finite, status_ok
    use spintop_stepper, only: looks_per_step
    use spintop_study_column, only: study_column_t
    implicit none
    private
    public :: asked_motion_t

    !> A motion, and the columns for which it is asked.
    type :: asked_motion_t
        !> Number of the columns.
        integer :: columns = 0
        type(case_t), private :: case
        type(plan_t), private :: plan
        !> Makes the rows; each call uses a copy.
        type(writer_t), private :: writer
        !> Why there is no exact motion, if there is none.
        integer, private :: status = status_ok
    contains
        procedure :: prepare
        procedure :: find
    end type asked_motion_t

    !> A time asked of a fixed-step method within this fraction of a step is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp

contains

    !> Prepares a motion by its plan.
    subroutine prepare(self, case, plan, columns)
        class(asked_motion_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! body and start
        type(plan_t), intent(in) :: plan !! model and method
        type(study_column_t), intent(in) :: columns(:) !! the columns
        self%case = case
        self%plan = plan
        self%columns = size(columns)
        call self%writer%set_columns(columns, case)
        if (.not. plan%exact) return
        allocate (self%writer%path)
        call self%writer%path%begin(case, looks_per_step * plan%max_steps, self%status)
        self%writer%counts_turns = self%writer%counts_turns .or. .not. case%turn%exchanges_axes()
    end subroutine prepare

    !> Finds the columns at some times; those that are not reached are NaN.
    subroutine find(self, t, cells, status, t_reached)
        class(asked_motion_t), intent(in) :: self
        real(dp), intent(in) :: t(:) !! the times, s
        real(dp), intent(out) :: cells(:, :) !! a column for each time
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(out) :: t_reached !! up to there the motion was found, s
        type(writer_t), allocatable :: writer
        type(outcome_t) :: outcome
        type(case_t) :: case
        type(plan_t) :: plan
        real(dp), allocatable :: times(:)

        cells = no_number
        t_reached = 0
        status = self%status
        if (.not. all(is_finite(t))) status = status_bad_samples
        if (.not. is_ok(status)) return
        if (allocated(self%writer%path)) then
            if (.not. self%writer%path%exact%has_to_follow()) then
                call find_directly(self%writer, t, cells, status, t_reached)
                return
            end if
        end if
        allocate (writer, source=self%writer)
        writer%asked = t
        allocate (writer%kept(self%columns, size(t)), source=no_number)
        case = self%case
        plan = self%plan
        times = t
        if (.not. plan%exact) then
            ! A method with fixed steps takes them over the span of the input.
            if (plan%is_adaptive()) case%t_end = t(size(t))
            if (.not. plan%is_adaptive()) writer%slack = grid_slack * case%t_end / plan%stepper%controls%steps
        end if
        call compute_motion(case, plan, times, writer, outcome)
        cells = writer%kept
        t_reached = outcome%t
        status = outcome%status
        if (is_good_end(status) .and. writer%has_missed) status = status_bad_samples
    end subroutine find

    !> The same of an exact motion of which no turns have to be counted: without a copy of the writer.
    subroutine find_directly(writer, t, cells, status, t_reached)
        type(writer_t), intent(in) :: writer
        real(dp), intent(in) :: t(:)
        real(dp), intent(inout) :: cells(:, :), t_reached
        integer, intent(out) :: status
        type(row_maker_t) :: maker
        logical :: are_angles
        integer :: i

        status = status_ok
        maker = writer%columns
        are_angles = maker%wants_angles_of(writer%path%exact)
        do i = 1, size(t)
            if (are_angles) then
                call maker%find_exact_row(writer%path%exact, t(i), cells(:, i))
            else
                cells(:, i) = maker%row(writer%path%exact%at(t(i)))
            end if
            if (.not. maker%is_defined(cells(:, i))) then
                cells(:, i) = no_number
                status = status_non_finite
            end if
            t_reached = t(i)
            if (.not. is_ok(status)) return
        end do
    end subroutine find_directly

end module spintop_c_motion
