!> Cases of a sweep that are followed step by step, many at once: bodies without a closed form, of
!> which the table shows the end of the span only.
module spintop_sweep_batch
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_exact_block, only: block_size
    use spintop_integration, only: outcome_t
    use spintop_job, only: job_t
    use spintop_many_bodies, only: integrate_many
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t
    use spintop_projection, only: project_nothing
    use spintop_rigid_body, only: rigid_body_t
    use spintop_status, only: status_ok, status_meanings
    use spintop_stepper, only: controls_t
    use spintop_sweep_columns, only: group_nutation, group_fast_top, group_period, &
        group_energy, group_details, sweep_columns, sweep_groups, q_energy_error_max, q_evaluations
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_quantities, only: no_values, put_fast_top, put_end
    use spintop_sweep_stability, only: put_stability
    use spintop_taylor, only: taylor_t
    implicit none
    private
    public :: sweep_batch_t, goes_in_batch

    !> Quantities that take more than the end of the motion.
    integer, parameter :: groups_on_the_way(*) = [group_nutation, group_period, group_energy, group_details]

    !> Cases that wait, with the same plan, and where they stand in their block.
    type :: sweep_batch_t
        integer :: n = 0
        type(controls_t), private :: controls
        integer, allocatable, private :: place(:)
        type(body_t), allocatable, private :: bodies(:)
        type(motion_t), allocatable, private :: starts(:)
        real(dp), allocatable, private :: t_end(:)
        !> What comes of them.
        type(motion_t), allocatable, private :: ends(:)
        type(outcome_t), allocatable, private :: outcomes(:)
    contains
        procedure :: add
        procedure :: compute
    end type sweep_batch_t

contains

    !> Whether a case is computed together with others: a body without a closed form, by Taylor's
    !> method on the equations of any body, under a plan that is the same for all, and nothing wanted
    !> that happens before the end.
    logical function goes_in_batch(job, case, plan)
        type(job_t), intent(in) :: job
        type(case_t), intent(in) :: case
        type(plan_t), intent(in) :: plan
        integer :: i
        goes_in_batch = .false.
        if (plan%exact .or. case%body%is_lagrange()) return
        if (size(job%events) > 0 .or. job%axes%varies('integration')) return
        do i = 1, size(job%columns)
            if (any(sweep_columns(job%columns(i))%group == groups_on_the_way)) return
        end do
        if (plan%stepper%controls%project /= project_nothing) return
        select type (stepper => plan%stepper)
        type is (taylor_t)
            select type (formulation => plan%formulation)
            type is (rigid_body_t)
                goes_in_batch = .true.
            end select
        end select
    end function goes_in_batch

    !> Puts a case, the k-th of its block, to those that wait.
    subroutine add(self, case, plan, k)
        class(sweep_batch_t), intent(inout) :: self
        type(case_t), intent(in) :: case
        type(plan_t), intent(in) :: plan
        integer, intent(in) :: k
        if (.not. allocated(self%place)) then
            allocate (self%place(block_size), self%bodies(block_size), self%starts(block_size), &
                      self%t_end(block_size), self%ends(block_size), self%outcomes(block_size))
        end if
        self%n = self%n + 1
        self%controls = plan%stepper%controls
        self%place(self%n) = k
        self%bodies(self%n) = case%body
        self%starts(self%n) = case%start
        self%t_end(self%n) = case%t_end
    end subroutine add

    !> The quantities of the cases that wait, in their places of the block; none waits then.
    subroutine compute(self, cases, wanted, values, status, note)
        class(sweep_batch_t), intent(inout) :: self
        type(case_t), intent(in) :: cases(:)
        logical, intent(in) :: wanted(sweep_groups)
        real(dp), intent(inout) :: values(:, :) !! quantities, cases
        integer, intent(inout) :: status(:)
        type(note_t), intent(inout) :: note(:)
        integer(int64) :: max_steps
        integer :: i, k, stability

        associate (n => self%n)
            call integrate_many(self%controls, self%bodies(:n), self%starts(:n), self%t_end(:n), &
                                self%ends(:n), self%outcomes(:n))
        end associate
        do i = 1, self%n
            k = self%place(i)
            status(k) = self%outcomes(i)%status
            values(:, k) = no_values()
            call note(k)%clear()
            max_steps = self%controls%max_steps - self%outcomes(i)%counts%steps
            call put_stability(cases(k), wanted, max_steps, values(:, k), stability, note(k))
            if (status(k) == status_ok) status(k) = stability
            if (wanted(group_fast_top)) call put_fast_top(cases(k), values(:, k), note(k))
            values(q_evaluations, k) = real(self%outcomes(i)%counts%evaluations, dp)
            if (status(k) == status_ok) then
                call put_end(cases(k), self%ends(i), values(q_energy_error_max, k), values(:, k))
            else
                call note(k)%explain(trim(status_meanings(status(k))))
            end if
        end do
        self%n = 0
    end subroutine compute

end module spintop_sweep_batch
