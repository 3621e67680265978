!> Measures the cost of the exact solution in the running process: preparation and sample.
module spintop_exact_cost
    use spintop_clock, only: seconds
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: measure_exact_cost

    !> Each time is the minimum of several repeats, each of several calls.
    integer, parameter :: repeats = 7, setups = 50, samples = 500

contains

    !> Time of a preparation, and of one sample (angles, rates, quaternion, acceleration), s.
    subroutine measure_exact_cost(case, setup, sample)
        type(case_t), intent(in) :: case !! the case, whose body must have a closed form
        real(dp), intent(out) :: setup, sample !! time of a preparation, and of one sample, s
        type(exact_motion_t) :: exact
        type(motion_t) :: motion
        real(dp) :: began, unused
        integer :: repeat, i, status

        setup = huge(setup)
        sample = huge(sample)
        unused = 0
        do repeat = 1, repeats
            began = seconds()
            do i = 1, setups
                call prepare_exact_motion(case%body, case%start, exact, status)
            end do
            setup = min(setup, (seconds() - began) / setups)
            began = seconds()
            do i = 1, samples
                motion = exact%at(case%t_end * i / samples)
                unused = unused + motion%quaternion(1)
            end do
            sample = min(sample, (seconds() - began) / samples)
        end do
        ! The sum is used, so that the compiler does not remove the computation.
        if (unused > huge(unused)) sample = unused
    end subroutine measure_exact_cost

end module spintop_exact_cost
