!> The plan of a computation, as data: model, method, steps and rows.
module spintop_run_plan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_formulation, only: formulation_t
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: plan_t, default_samples, sample_time, sample_times

    !> Rows of a trajectory of an adaptive method when their number is not given.
    integer, parameter :: default_samples = 1001
    !> More fixed steps than this are not counted.
    real(dp), parameter :: most_steps = 1.0e9_dp
    !> A span this close to a whole number of steps has that number.
    real(dp), parameter :: step_slack = 1.0e-9_dp

    !> How a case is computed.
    type :: plan_t
        !> By the exact motion; without formulation and stepper then.
        logical :: exact = .false.
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        !> Largest size of fixed steps, s; 0 if their number is given.
        real(dp) :: step = 0
        !> Rows of the table.
        integer :: samples = default_samples
        !> Most work of a case, in steps (`controls_t`).
        integer(int64) :: max_steps = 1000000
        !> What was chosen, and why, in sentences.
        character(:), allocatable :: model, method, reason
    contains
        procedure :: fit_steps
        procedure :: is_adaptive
    end type plan_t

contains

    !> Number of equal steps of a span when their largest size is given.
    pure subroutine fit_steps(self, t_end)
        class(plan_t), intent(inout) :: self
        real(dp), intent(in) :: t_end
        if (self%step > 0) then
            self%stepper%controls%steps = max(1, ceiling(min(t_end / self%step * (1 - step_slack), &
                                                             most_steps)))
        end if
    end subroutine fit_steps

    !> Whether rows can lie anywhere between steps.
    pure logical function is_adaptive(self)
        class(plan_t), intent(in) :: self
        is_adaptive = self%exact
        if (allocated(self%stepper)) is_adaptive = self%stepper%controls%steps == 0
    end function is_adaptive

    !> Time of row `i` of `samples` equally spaced ones from 0 to `t_end`, both included.
    elemental real(dp) function sample_time(t_end, samples, i)
        real(dp), intent(in) :: t_end
        integer, intent(in) :: samples, i
        sample_time = t_end
        if (i < samples) sample_time = t_end * (i - 1) / (samples - 1)
    end function sample_time

    !> The times of all rows.
    pure function sample_times(t_end, samples) result(times)
        real(dp), intent(in) :: t_end
        integer, intent(in) :: samples
        real(dp), allocatable :: times(:)
        integer :: i
        allocate (times(samples))
        do i = 1, samples
            times(i) = sample_time(t_end, samples, i)
        end do
    end function sample_times

end module spintop_run_plan
