!> What a thread needs to compute the rows of a sweep: its cases, and their sensitivities.
module spintop_sweep_rows
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: processor_seconds
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_row_block, only: row_block_t
    use spintop_sweep_sensitivities, only: sweep_sensitivities_t
    use spintop_sweep_worker, only: sweep_worker_t
    use spintop_thread_team, only: block_worker_t, work_of_computing
    implicit none
    private
    public :: sweep_rows_t

    !> Data of a thread; it must stay where it was prepared, and be a target there.
    type, extends(block_worker_t) :: sweep_rows_t
        type(job_t), pointer, private :: job => null()
        type(sweep_worker_t), private :: worker
        type(sweep_sensitivities_t), private :: sensitivities
    contains
        procedure :: prepare
        procedure :: compute_rows
    end type sweep_rows_t

contains

    !> Makes what the thread needs. It makes many texts, which only one thread at a time may do: see `status_names`.
    subroutine prepare(self, job)
        class(sweep_rows_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        self%job => job
        call self%worker%prepare(job)
        call self%sensitivities%prepare(job)
    end subroutine prepare

    !> Computes the rows of some cases, block by block.
    subroutine compute_rows(self, first, last, rows)
        class(sweep_rows_t), target, intent(inout) :: self
        integer(int64), intent(in) :: first, last !! first and last case, at most those of a block
        type(row_block_t), intent(inout) :: rows !! their rows
        real(dp) :: began
        call self%worker%compute_rows(self%job, first, last, rows)
        began = processor_seconds()
        call self%sensitivities%fill(self%job, rows)
        self%costs = self%costs + self%worker%costs
        self%costs(work_of_computing) = self%costs(work_of_computing) + (processor_seconds() - began)
    end subroutine compute_rows

end module spintop_sweep_rows
