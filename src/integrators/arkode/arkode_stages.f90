!> Convergence test for the iteration of a stage in ARKODE, down to rounding errors. The test of ARKODE needs
!> a tolerance, which is not known in advance with a fixed step size.
module spintop_arkode_stages
    use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
    use spintop_formulation, only: max_states
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_sundials, only: FN_VGetArrayPointer, FSUNNonlinSolGetCurIter, N_Vector, SUN_NLS_CONTINUE, &
        SUN_NLS_CONV_RECVR, SUN_NLS_SUCCESS, SUNNonlinearSolver
    implicit none
    private
    public :: stage_history_t, judge_correction

    !> Data of the step, and of the iteration so far.
    type :: stage_history_t
        !> State at the beginning of the step, and the scales of its variables; cyclic variables may have any
        !> magnitude.
        real(dp) :: y(max_states) = 0, scale(max_states) = 1
        logical :: cyclic(max_states) = .false.
        !> Growth of a correction that indicates divergence.
        real(dp) :: divergence = 2
        !> The last and the smallest correction, in units of the variables; the ratio of the last correction
        !> to the one before; and the number of corrections since the smallest.
        real(dp), private :: previous = 0, smallest = 0, rate = 1
        integer, private :: idle = 0
    end type stage_history_t

    !> An iteration has converged to rounding if its next correction is below the first value, or if the
    !> correction no longer decreases and is below the second.
    real(dp), parameter :: negligible = epsilon_dp / 128, acceptable = 1.0e-12_dp

contains

    !> The callback that judges a correction `del` of a stage whose increment over the state is `change`.
    integer(c_int) function judge_correction(solver, change, del, tolerance, weights, data) &
        result(verdict) bind(C, name='')
        type(SUNNonlinearSolver), intent(inout) :: solver !! its counter of iterations is read
        type(N_Vector), intent(inout) :: change !! sum of all corrections
        type(N_Vector), intent(inout) :: del !! the last correction
        real(c_double), value :: tolerance !! tolerance of ARKODE, not used
        type(N_Vector), intent(inout) :: weights !! weights of ARKODE, not used
        type(c_ptr), value :: data !! a `stage_history_t`
        type(stage_history_t), pointer :: history
        real(c_double), pointer :: total(:), last(:)
        real(dp) :: magnitude, rate
        integer(c_int) :: iteration(1), failure
        integer :: n
        !> Value of `rate` before the second correction.
        real(dp), parameter :: first_rate = 0

        call c_f_pointer(data, history)
        total => FN_VGetArrayPointer(change)
        last => FN_VGetArrayPointer(del)
        n = size(last)
        magnitude = maxval(abs(last) / max(history%scale(:n), abs(total), &
            merge(0.0_dp, abs(history%y(:n)), history%cyclic(:n))))
        failure = FSUNNonlinSolGetCurIter(solver, iteration)
        if (iteration(1) == 0) then
            history%previous = huge(magnitude)
            history%smallest = huge(magnitude)
            history%idle = 0
            history%rate = first_rate
        end if
        ! The larger of two successive rates, because a correction of an angle causes one of its rate.
        rate = merge(1.0_dp, magnitude / history%previous, iteration(1) == 0)
        history%idle = merge(0, history%idle + 1, magnitude < history%smallest)
        history%smallest = min(history%smallest, magnitude)
        verdict = SUN_NLS_CONTINUE
        if (min(max(rate, history%rate), 1.0_dp) * magnitude <= negligible &
            .or. history%idle > 1 .and. magnitude <= acceptable) then
            verdict = SUN_NLS_SUCCESS
        else if (.not. magnitude <= max(history%divergence * history%previous, acceptable)) then
            verdict = SUN_NLS_CONV_RECVR
        end if
        history%previous = magnitude
        history%rate = rate
    end function judge_correction

end module spintop_arkode_stages
