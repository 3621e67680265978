!> The plan of a computation: model, method, steps and rows.
module spintop_plan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_formulation, only: formulation_info_t, formulation_t
    use spintop_stepper, only: stepper_t
    implicit none
    private
    public :: plan_t, default_samples, sample_time, sample_times

    !> Number of rows of a trajectory of an adaptive method, if it is not given.
    integer, parameter :: default_samples = 1001
    !> Maximum number of fixed steps.
    real(dp), parameter :: most_steps = 1.0e9_dp
    !> A span that is this close to an integer number of steps has that number.
    real(dp), parameter :: step_slack = 1.0e-9_dp

    !> The settings of a computation.
    type :: plan_t
        !> Whether the exact solution is used, without formulation and stepper.
        logical :: exact = .false.
        class(formulation_t), allocatable :: formulation
        class(stepper_t), allocatable :: stepper
        !> Largest fixed step size, s; 0 if the number of steps is given.
        real(dp) :: step = 0
        !> Number of rows of the table.
        integer :: samples = default_samples
        !> Maximum work of a case, in steps (`controls_t`).
        integer(int64) :: max_steps = 1000000
        !> Selected model and method, and the reasons, in sentences.
        character(:), allocatable :: model, method, reason
    contains
        procedure :: fit_steps
        procedure :: has_too_many_steps
        procedure :: is_adaptive
        procedure :: formulation_name
    end type plan_t

contains

    !> Number of steps of fixed size in a span, if their largest size is given, and the limit on the work of a case, which does
    !> not count them. Where they are too many, the limit stays that of adaptive methods, and ends the case.
    pure subroutine fit_steps(self, t_end)
        class(plan_t), intent(inout) :: self
        real(dp), intent(in) :: t_end !! length of the span, s
        if (self%step > 0) then
            self%stepper%controls%steps = max(1, ceiling(min(t_end / self%step * (1 - step_slack), &
                                                             most_steps)))
        end if
        associate (controls => self%stepper%controls)
            controls%max_steps = self%max_steps
            if (.not. self%has_too_many_steps(t_end)) controls%max_steps = self%max_steps + controls%steps
        end associate
    end subroutine fit_steps

    !> Whether a span has more steps of the given size than any run takes.
    pure logical function has_too_many_steps(self, t_end)
        class(plan_t), intent(in) :: self
        real(dp), intent(in) :: t_end !! length of the span, s
        has_too_many_steps = self%step > 0 .and. t_end > most_steps * self%step
    end function has_too_many_steps

    !> Whether rows may lie between steps.
    pure logical function is_adaptive(self)
        class(plan_t), intent(in) :: self
        is_adaptive = self%exact
        if (allocated(self%stepper)) is_adaptive = self%stepper%controls%steps == 0
    end function is_adaptive

    !> Name of the formulation; '' if there is none.
    function formulation_name(self) result(name)
        class(plan_t), intent(in) :: self
        character(16) :: name
        type(formulation_info_t) :: info
        name = ''
        if (.not. allocated(self%formulation)) return
        info = self%formulation%info()
        name = info%name
    end function formulation_name

    !> Time of row `i` of `samples` equally spaced rows from 0 to `t_end`, both included.
    elemental real(dp) function sample_time(t_end, samples, i)
        real(dp), intent(in) :: t_end !! end of the span, s
        integer, intent(in) :: samples, i !! number of rows, and index of the row, from 1
        sample_time = t_end
        if (i < samples) sample_time = t_end * (i - 1) / (samples - 1)
    end function sample_time

    !> The times of all rows.
    pure function sample_times(t_end, samples) result(times)
        real(dp), intent(in) :: t_end !! end of the span, s
        integer, intent(in) :: samples !! number of rows
        real(dp), allocatable :: times(:)
        integer :: i
        times = [(sample_time(t_end, samples, i), i=1, samples)]
    end function sample_times

end module spintop_plan
