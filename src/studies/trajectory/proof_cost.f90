!> What the proof of a motion costs, measured in the running process: it goes step by step.
module spintop_proof_cost
    use spintop_certificate, only: proof_count, proof_of_q0
    use spintop_clock, only: seconds
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_row_proof, only: row_proof_t, wanted_proofs
    use spintop_summary, only: decimal, rounded, summary_t
    use spintop_trajectory_columns, only: trajectory_column_t
    use spintop_uncertainties, only: data_radii
    implicit none
    private
    public :: describe_proof_cost

    !> The proof of the first part of the motion is measured: a part that takes so long, s, or all of it.
    real(dp), parameter :: long_enough = 0.1_dp
    integer, parameter :: halvings = 10

contains

    !> Adds a line on the time that the proof takes, if anything is to be proved. A motion that amplifies errors takes longer in
    !> its later parts, which need more bits.
    subroutine describe_proof_cost(job, columns, summary)
        type(job_t), intent(in) :: job !! the job of the motion
        type(trajectory_column_t), intent(in) :: columns(:) !! its columns
        type(summary_t), intent(inout) :: summary !! lines are added
        type(row_proof_t) :: proof
        real(dp) :: printed(proof_count), began, time, part
        logical :: wanted(proof_count)
        integer :: i

        wanted = wanted_proofs(columns%quantity(), job%input%scene%certified)
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

end module spintop_proof_cost
