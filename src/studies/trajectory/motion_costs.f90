!> What a motion costs, measured in the running process: preparation and samples of the exact solution; and its proof, which goes
!> step by step.
module spintop_motion_costs
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_count, proof_of_q0
    use spintop_clock, only: seconds
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_row_proof, only: row_proof_t, wanted_proofs
    use spintop_summary, only: decimal, rounded, summary_t
    use spintop_uncertainties, only: data_radii
    implicit none
    private
    public :: describe_proof_cost, measure_exact_cost

    !> The proof of the first part of the motion is measured: a part that takes so long, s, or all of it.
    real(dp), parameter :: long_enough = 0.1_dp
    integer, parameter :: halvings = 10

    !> Each time is the minimum of several repeats, each of several calls.
    integer, parameter :: repeats = 7, setups = 50, samples = 500

contains

    !> Adds a line on the time that the proof takes, if anything is to be proved. A motion that amplifies errors takes longer in
    !> its later parts, which need more bits.
    subroutine describe_proof_cost(job, summary)
        type(job_t), intent(in) :: job !! the job of the motion
        type(summary_t), intent(inout) :: summary !! lines are added
        type(row_proof_t) :: proof
        real(dp) :: printed(proof_count), began, time, part
        logical :: wanted(proof_count)
        integer :: i

        wanted = wanted_proofs(job%columns%quantity(), job%input%scene%certified)
        if (.not. any(wanted)) return
        printed = 0
        printed(proof_of_q0) = 1
        began = seconds()
        call proof%open(wanted, .false., job%case%given_body, job%case%given_start, data_radii(job%input%scene))
        do i = halvings, 0, -1
            part = 0.5_dp**i
            call proof%prove(part * job%case%t_end, printed)
            time = seconds() - began
            if (time > long_enough .or. .not. proof%is_proved()) exit
        end do
        call proof%close()
        if (proof%is_proved()) then
            call summary%add('proof', 'about ' // rounded(time / part) // ' s, from the first ' // &
                             decimal(part * job%case%t_end) // ' s of motion')
        else
            call summary%add('proof', 'at t = ' // decimal(part * job%case%t_end) // ': ' // proof%summary())
        end if
    end subroutine describe_proof_cost

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

end module spintop_motion_costs
