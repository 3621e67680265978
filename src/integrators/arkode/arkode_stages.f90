!> Convergence test of ARKODE's iteration for a stage, down to the rounding error: its own test needs a
!> tolerance, which is not known in advance with a fixed step size.
module spintop_arkode_stages
    use, intrinsic :: iso_c_binding, only: c_double, c_f_pointer, c_int, c_ptr
    use spintop_formulation, only: max_states
    use spintop_kinds, only: dp, epsilon_dp
    use spintop_sundials, only: FN_VGetArrayPointer, FSUNNonlinSolGetCurIter, N_Vector, SUN_NLS_CONTINUE, &
        SUN_NLS_CONV_RECVR, SUN_NLS_SUCCESS, SUNNonlinearSolver
    implicit none
    private
    public :: stage_watch_t, judge_correction

    !> What the test knows of the step and of the iteration so far.
    type :: stage_watch_t
        !> State at the beginning of the step, and the scales of its variables; cyclic ones have any magnitude.
        real(dp) :: y(max_states) = 0, scale(max_states) = 1
        logical :: cyclic(max_states) = .false.
        !> Growth of a correction that shows divergence.
        real(dp) :: divergence = 2
        !> The last correction and the smallest, in units of the variables; what share of the one before
        !> it the last was, and corrections since the smallest.
        real(dp), private :: previous = 0, smallest = 0, rate = 1
        integer, private :: idle = 0
    end type stage_watch_t

    !> An iteration is at rounding when its next correction is below the first, or when it does not
    !> shrink any more and is below the second.
    real(dp), parameter :: negligible = epsilon_dp / 128, acceptable = 1.0e-12_dp

contains

    !> The callback that judges a correction `del` of a stage that lies `change` from the state.
    integer(c_int) function judge_correction(solver, change, del, tolerance, weights, data) &
        result(verdict) bind(C, name='')
        type(SUNNonlinearSolver), intent(inout) :: solver !! has made the correction
        type(N_Vector), intent(inout) :: change !! all corrections so far
        type(N_Vector), intent(inout) :: del !! the last of them
        real(c_double), value :: tolerance !! ARKODE's
        type(N_Vector), intent(inout) :: weights !! ARKODE's
        type(c_ptr), value :: data !! a `stage_watch_t`
        type(stage_watch_t), pointer :: watch
        real(c_double), pointer :: total(:), last(:)
        real(dp) :: magnitude, rate
        integer(c_int) :: iteration(1), failure
        integer :: n
        !> Before there is another.
        real(dp), parameter :: first_rate = 0

        associate (unused => tolerance, also_unused => weights)
        end associate
        call c_f_pointer(data, watch)
        total => FN_VGetArrayPointer(change)
        last => FN_VGetArrayPointer(del)
        n = size(last)
        magnitude = maxval(abs(last) / max(watch%scale(:n), abs(total), &
            merge(0.0_dp, abs(watch%y(:n)), watch%cyclic(:n))))
        failure = FSUNNonlinSolGetCurIter(solver, iteration)
        if (iteration(1) == 0) then
            watch%previous = huge(magnitude)
            watch%smallest = huge(magnitude)
            watch%idle = 0
            watch%rate = first_rate
        end if
        ! Two rates in a row: a correction of an angle makes one of its rate.
        rate = merge(1.0_dp, magnitude / watch%previous, iteration(1) == 0)
        watch%idle = merge(0, watch%idle + 1, magnitude < watch%smallest)
        watch%smallest = min(watch%smallest, magnitude)
        verdict = SUN_NLS_CONTINUE
        if (min(max(rate, watch%rate), 1.0_dp) * magnitude <= negligible &
            .or. watch%idle > 1 .and. magnitude <= acceptable) then
            verdict = SUN_NLS_SUCCESS
        else if (.not. magnitude <= max(watch%divergence * watch%previous, acceptable)) then
            verdict = SUN_NLS_CONV_RECVR
        end if
        watch%previous = magnitude
        watch%rate = rate
    end function judge_correction

end module spintop_arkode_stages
