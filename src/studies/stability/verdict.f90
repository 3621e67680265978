!> What a computed motion is worth, in a word and with the reason.
module spintop_verdict
    use spintop_kinds, only: dp
    use spintop_status, only: status_meanings, status_ok
    use spintop_summary, only: rounded
    use spintop_text, only: to_text
    use spintop_trial, only: trial_t
    implicit none
    private
    public :: verdict_names, verdict_meaning, judge_trial, explain_trial
    public :: verdict_accurate, verdict_drifts, verdict_wrong, verdict_failed, verdict_unsuitable

    !> The verdicts, from best to worst, and one for methods that are not for such a body.
    integer, parameter :: verdict_accurate = 1, verdict_drifts = 2, verdict_wrong = 3, &
        verdict_failed = 4, verdict_unsuitable = 5
    character(*), parameter :: verdict_names(*) = [character(10) :: &
        'accurate', 'drifts', 'wrong', 'failed', 'unsuitable']

    !> Orientation errors, rad: accurate up to the first, which grows with what rounding of the data
    !> does; wrong beyond the second.
    real(dp), parameter :: accurate_below = 1.0e-6_dp, floors = 100, wrong_above = 0.1_dp

contains

    !> What a verdict means.
    function verdict_meaning(verdict) result(meaning)
        integer, intent(in) :: verdict
        character(:), allocatable :: meaning
        select case (verdict)
        case (verdict_accurate)
            meaning = 'attitude within ' // to_text(accurate_below) // ' rad and ' // to_text(nint(floors)) &
                      // ' times what rounding of the data does'
        case (verdict_drifts)
            meaning = 'attitude within ' // to_text(wrong_above) // ' rad'
        case (verdict_wrong)
            meaning = 'attitude off by more than ' // to_text(wrong_above) // ' rad'
        case (verdict_failed)
            meaning = 'the method stopped before the end, and said why'
        case default
            meaning = 'the method or its equations are not for such a body'
        end select
    end function verdict_meaning

    !> The verdict on a trial; `floor` is how far rounding of the data turns the attitude, rad.
    pure integer function judge_trial(trial, floor) result(verdict)
        type(trial_t), intent(in) :: trial
        real(dp), intent(in) :: floor
        if (trial%status /= status_ok) then
            verdict = verdict_failed
        else if (trial%errors%orientation <= accurate_below + floors * floor) then
            verdict = verdict_accurate
        else if (trial%errors%orientation <= wrong_above) then
            verdict = verdict_drifts
        else
            verdict = verdict_wrong
        end if
    end function judge_trial

    !> The reason for a verdict; empty for an accurate trial.
    function explain_trial(trial, verdict) result(reason)
        type(trial_t), intent(in) :: trial
        integer, intent(in) :: verdict
        character(:), allocatable :: reason
        !> An invariant kept to that share of the orientation error hides it.
        real(dp), parameter :: hidden = 1.0e-3_dp
        character(:), allocatable :: invariants

        reason = ''
        select case (verdict)
        case (verdict_failed)
            reason = 'at t = ' // rounded(trial%t) // ' s: ' // trim(status_meanings(trial%status))
        case (verdict_drifts, verdict_wrong)
            associate (errors => trial%errors)
                reason = 'attitude off by ' // scientific(errors%orientation) // ' rad'
                invariants = 'energy off by ' // scientific(errors%energy) // ' and momenta by ' &
                             // scientific(max(errors%vertical, errors%axial))
                if (max(errors%energy, errors%vertical, errors%axial) < hidden * errors%orientation) then
                    reason = reason // ' though ' // invariants // ' only'
                else
                    reason = reason // '; ' // invariants
                end if
            end associate
        end select
    end function explain_trial

    !> A number with two digits.
    function scientific(value) result(text)
        real(dp), intent(in) :: value
        character(:), allocatable :: text
        character(16) :: buffer
        write (buffer, '(es9.1e3)') value
        text = trim(adjustl(buffer))
    end function scientific

end module spintop_verdict
