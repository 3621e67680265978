!> Free bodies of a sweep, many at once: cases wait until their block is complete and are computed together by their
!> closed form.
module spintop_sweep_free
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_conditioning, only: inherent_error
    use spintop_free_block, only: block_size, free_block_t
    use spintop_job, only: job_t
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t
    use spintop_quantities, only: energy_scale, kinetic_energy
    use spintop_status, only: status_meanings, status_ok
    use spintop_sweep_notes, only: note_t
    use spintop_sweep_quantities, only: put_azimuth, put_end, put_fast_top, put_free_constants
    use spintop_sweep_result, only: kinds_of_work, of_end, of_energy, of_fast_top, of_inherent, of_measured, &
        of_period, of_range, of_turns, sweep_result_t
    use spintop_sweep_stability, only: put_stability
    implicit none
    private
    public :: sweep_free_t, goes_in_free_block

    !> The cases that wait, and their positions in the block of the sweep.
    type :: sweep_free_t
        integer :: n = 0
        integer, allocatable, private :: place(:)
        type(free_block_t), allocatable, private :: block
    contains
        procedure :: add
        procedure :: compute
    end type sweep_free_t

contains

    !> Whether a case can be computed together with others: a free body without symmetry about body z, by its closed
    !> form, up to the end of its span, and without quantities that are measured along the motion.
    logical function goes_in_free_block(job, case, plan, wanted)
        type(job_t), intent(in) :: job !! the job
        type(case_t), intent(in) :: case !! body, start and span
        type(plan_t), intent(in) :: plan !! model, method and settings
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        goes_in_free_block = plan%exact .and. case%body%is_free() .and. .not. case%body%is_lagrange() &
                             .and. size(job%events) == 0 .and. .not. wanted(of_measured) &
                             .and. .not. (case%body%given%differ .and. (wanted(of_turns) .or. wanted(of_range)))
    end function goes_in_free_block

    !> Adds a case, the k-th of its block.
    subroutine add(self, case, max_steps, k)
        class(sweep_free_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! body, start and span
        integer(int64), intent(in) :: max_steps !! work of the case, in steps
        integer, intent(in) :: k !! position of the case in its block
        if (.not. allocated(self%block)) allocate (self%block, self%place(block_size))
        self%n = self%n + 1
        self%place(self%n) = k
        associate (block => self%block, n => self%n)
            block%inertia(n, :) = case%body%inertia
            block%omega(n, :) = case%start%omega
            block%quaternion(n, :) = case%start%quaternion
            block%angle(n, :) = case%start%angle
            block%t_end(n) = case%t_end
            block%most_steps(n) = max_steps
        end associate
    end subroutine add

    !> Computes the quantities of the waiting cases, at their positions in the block; the list is then empty.
    subroutine compute(self, cases, wanted, max_steps, values, status, note)
        class(sweep_free_t), intent(inout) :: self
        type(case_t), intent(in) :: cases(:) !! cases of the block
        logical, intent(in) :: wanted(kinds_of_work) !! selected groups of quantities
        integer(int64), intent(in) :: max_steps(:) !! largest number of steps of each case
        type(sweep_result_t), intent(inout) :: values(:) !! the values
        integer, intent(inout) :: status(:) !! statuses of the cases of the block
        type(note_t), intent(inout) :: note(:) !! notes on the cases of the block
        integer :: i

        if (self%n == 0) return
        self%block%n = self%n
        call self%block%compute(wanted(of_end) .or. wanted(of_energy), wanted(of_turns))
        do i = 1, self%n
            associate (k => self%place(i))
                call take(self%block, i, cases(k), wanted, max_steps(k), values(k), status(k), note(k))
            end associate
        end do
        self%n = 0
    end subroutine compute

    !> The quantities of a case, the i-th of a computed block.
    subroutine take(block, i, case, wanted, max_steps, values, status, note)
        type(free_block_t), intent(in) :: block
        integer, intent(in) :: i
        type(case_t), intent(in) :: case
        logical, intent(in) :: wanted(kinds_of_work)
        integer(int64), intent(in) :: max_steps
        type(sweep_result_t), intent(out) :: values
        integer, intent(out) :: status
        type(note_t), intent(inout) :: note
        type(motion_t) :: last
        real(dp) :: change

        values = sweep_result_t()
        status = block%status(i)
        if (status /= status_ok) then
            call note%explain(trim(status_meanings(status)))
            return
        end if
        call put_stability(case, case%t_end, wanted, max_steps, values, note)
        if (wanted(of_fast_top)) call put_fast_top(case, values, note)
        if (wanted(of_period)) call put_azimuth(.false., 0.0_dp, values, note)
        if (wanted(of_end) .or. wanted(of_energy)) then
            last%t = case%t_end
            last%omega = block%omega_end(i, :)
            last%quaternion = block%quaternion_end(i, :)
            last%angle = block%angle_end(i, :)
            last%rate(2) = block%theta_rate_end(i)
            change = kinetic_energy(case%body, last) - kinetic_energy(case%body, case%start)
            call put_end(case, last, abs(change) / energy_scale(case%body, case%start), values)
        end if
        values%evaluations = 0
        values%orientation_error = 0
        if (wanted(of_inherent)) values%inherent_error = inherent_error(case%body, case%start, case%t_end)
        call put_free_constants(case, block%constants(i), wanted, values, note)
    end subroutine take

end module spintop_sweep_free
