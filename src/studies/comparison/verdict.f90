!> Verdicts on computed motions, with reasons.
module spintop_verdict
    use spintop_kinds, only: dp
    use spintop_status, only: is_ok, status_meanings
    use spintop_summary, only: rounded
    use spintop_text, only: to_text
    use spintop_trial, only: trial_t
    implicit none
    private
    public :: verdict_names, verdict_meaning, judge_trial, explain_trial
    public :: verdict_accurate, verdict_drifts, verdict_wrong, verdict_failed, verdict_unsuitable, verdict_no_reference

    !> The verdicts, from best to worst, one for methods that are not for such a body, and one for cases
    !> whose motion is not known.
    integer, parameter :: verdict_accurate = 1, verdict_drifts = 2, verdict_wrong = 3, &
        verdict_failed = 4, verdict_unsuitable = 5, verdict_no_reference = 6
    character(*), parameter :: verdict_names(*) = [character(12) :: &
        'accurate', 'drifts', 'wrong', 'failed', 'unsuitable', 'no_reference']

    !> Orientation errors, rad: accurate up to the first one, which increases with the inherent error; wrong
    !> beyond the second.
    real(dp), parameter :: accurate_below = 1.0e-6_dp, floors = 100, wrong_above = 0.1_dp

contains

    !> Meaning of a verdict.
    function verdict_meaning(verdict) result(meaning)
        integer, intent(in) :: verdict !! one of the verdict constants
        character(:), allocatable :: meaning
        select case (verdict)
        case (verdict_accurate)
            meaning = 'orientation error at most ' // to_text(accurate_below) // ' rad plus ' // to_text(nint(floors)) &
                      // ' times the inherent error'
        case (verdict_drifts)
            meaning = 'orientation error at most ' // to_text(wrong_above) // ' rad'
        case (verdict_wrong)
            meaning = 'orientation error above ' // to_text(wrong_above) // ' rad'
        case (verdict_failed)
            meaning = 'the method ended before the end of the span, with a status'
        case (verdict_no_reference)
            meaning = 'there is no motion to compare with, or it is not known to ' // to_text(wrong_above) // ' rad'
        case default
            meaning = 'the method or its equations do not apply to the body'
        end select
    end function verdict_meaning

    !> The verdict on a trial; `floor` is the inherent error of the attitude, rad, and `uncertainty` that of the reference.
    pure integer function judge_trial(trial, floor, uncertainty) result(verdict)
        type(trial_t), intent(in) :: trial !! result of the computation
        real(dp), intent(in) :: floor, uncertainty !! inherent error of the attitude, and error of the reference, rad
        if (.not. is_ok(trial%status)) then
            verdict = verdict_failed
        else if (accurate_below + floors * floor > wrong_above .or. uncertainty > wrong_above) then
            verdict = verdict_no_reference
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
        type(trial_t), intent(in) :: trial !! result of the computation
        integer, intent(in) :: verdict !! one of the verdict constants
        character(:), allocatable :: reason
        !> If the relative error of an invariant is below this fraction of the orientation error, the
        !> invariant does not show that error.
        real(dp), parameter :: hidden = 1.0e-3_dp
        character(:), allocatable :: invariants

        reason = ''
        select case (verdict)
        case (verdict_failed)
            reason = 'at t = ' // rounded(trial%t) // ' s: ' // trim(status_meanings(trial%status))
        case (verdict_no_reference)
            reason = 'the motion is not known to ' // to_text(wrong_above) // ' rad'
        case (verdict_drifts, verdict_wrong)
            associate (errors => trial%errors)
                reason = 'orientation error ' // scientific(errors%orientation) // ' rad'
                invariants = 'energy error ' // scientific(errors%energy) // ', momentum error ' &
                             // scientific(max(errors%vertical, errors%axial))
                if (max(errors%energy, errors%vertical, errors%axial) < hidden * errors%orientation) then
                    reason = reason // ', although ' // invariants
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
        write (buffer, '(ss, es9.1e3)') value
        text = trim(adjustl(buffer))
    end function scientific

end module spintop_verdict
