!> Status of a computation: an integer inside loops, a name in tables.
module spintop_status
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: exit_failed, exit_ok
    implicit none
    private
    public :: status_name, status_number, status_meaning, status_names, status_meanings
    public :: status_ok, status_pole, status_non_finite, status_step_limit, status_not_converged
    public :: status_step_too_small, status_turning_point, status_outside, status_unsuitable
    public :: status_integrator, status_bad_input, status_bad_body, status_bad_start, status_bad_tolerance
    public :: status_bad_span, status_bad_samples, status_bad_events, status_bad_projection
    public :: status_no_steps, status_no_structure, status_stuck_at_turn, status_unknown_name, status_too_many_events
    public :: status_at_rest, status_bad_steps, status_no_fixed_steps, status_bad_table
    public :: last_status, is_good_end, is_ok, is_refusal, code_of, count_failed

    !> Outcomes of a computation, of which `status_meaning` gives a sentence for each; `is_refusal` tells those for
    !> which a call is refused before the computation. A body that dry friction holds has a good end: `status_at_rest`.
    enum, bind(C)
        enumerator :: status_ok = 0, status_pole, status_non_finite, status_step_limit, status_not_converged
        enumerator :: status_step_too_small, status_turning_point, status_outside, status_unsuitable, status_integrator
        enumerator :: status_bad_input, status_bad_body, status_bad_start, status_bad_tolerance, status_bad_span
        enumerator :: status_bad_samples, status_bad_events, status_bad_projection, status_no_steps, status_no_structure
        enumerator :: status_stuck_at_turn, status_unknown_name, status_too_many_events, status_at_rest
        enumerator :: status_bad_steps, status_no_fixed_steps, status_bad_table
    end enum
    !> The last of them.
    integer, parameter :: last_status = status_bad_table

    !> Names in tables, and a sentence for each. Threads use these constants: gfortran keeps the length of the
    !> result of a function of deferred length in memory that all threads share.
    character(*), parameter :: status_names(0:last_status) = [character(16) :: &
        'ok', 'pole', 'non_finite', 'step_limit', 'not_converged', 'step_too_small', &
        'turning_point', 'outside', 'unsuitable', 'integrator', 'bad_input', 'bad_body', 'bad_start', &
        'bad_tolerance', 'bad_span', 'bad_samples', 'bad_events', 'bad_projection', 'no_steps', &
        'no_structure', 'stuck_at_turn', 'unknown_name', 'too_many_events', 'at_rest', 'bad_steps', 'no_fixed_steps', 'bad_table']

    character(*), parameter :: status_meanings(0:last_status) = [character(112) :: &
        'completed', &
        'the axis is at a pole (sin theta = 0), where these equations are singular', &
        'a value overflowed or is not a number', &
        'the maximum number of steps (integration.max_steps) is reached', &
        'the equations of an implicit step could not be solved', &
        'step underflow: the step size fell to the rounding error of the time', &
        'reached a turning point of theta, where the energy-rate equations end', &
        'the state left the region where the equations hold (negative radicand)', &
        'the equations do not hold for this body or start', &
        'the integrator library reported a failure of its own', &
        'the arguments, or the parameters of the case, do not describe a top and its motion', &
        'the mass is not positive, a moment of inertia or a damping coefficient is negative, or m g l underflows', &
        'the quaternion is zero or contradicts the angles, the rates contradict omega, or I omega^2 underflows', &
        'a tolerance is not a positive number, or is below the finest one of the method', &
        'the end of the span is not a finite time at or after the start', &
        'a sample time is not finite, not in increasing order within the span, or not the time of a fixed step', &
        'an event has a level that is not finite, or no direction', &
        'the formulation lacks, or the damped body does not conserve, the invariants to project on', &
        'a method without step control (info%adaptive) needs a number of steps', &
        'the method needs a structure that the formulation does not offer', &
        'this method cannot leave a turning point of theta where theta_rate is reset from the energy', &
        'the name is unknown', &
        'there are more events than can be counted or kept', &
        'dry friction holds the body at rest', &
        'the number of steps is negative, or max_steps is not positive', &
        'steps are given, and the method has none of fixed size (info%fixed_step)', &
        'the method takes no Butcher table by name, or has none of this name']

contains

    !> Whether a computation with this status goes on: it did not fail, and has not ended early. How a motion ended is another
    !> question: see `is_good_end`.
    elemental logical function is_ok(status)
        integer, intent(in) :: status !! number of a status
        is_ok = status == status_ok
    end function is_ok

    !> Whether a motion with this status was computed to its end. Everything that tells motions that succeeded from
    !> those that failed asks this, in the end: `spintop list statuses --json` has it as `good`.
    elemental logical function is_good_end(status)
        integer, intent(in) :: status !! number of a status
        is_good_end = status == status_ok .or. status == status_at_rest
    end function is_good_end

    !> Whether this status refuses a computation before it begins.
    elemental logical function is_refusal(status)
        integer, intent(in) :: status !! number of a status
        is_refusal = (status >= status_bad_input .and. status <= status_unknown_name) .or. status >= status_bad_steps
    end function is_refusal

    !> The exit code of a run of one motion.
    elemental integer function code_of(status) result(code)
        integer, intent(in) :: status !! how the motion ended
        code = merge(exit_ok, exit_failed, is_good_end(status))
    end function code_of

    !> Number of cases that did not have a good end.
    pure integer(int64) function count_failed(counts) result(count)
        integer(int64), intent(in) :: counts(0:last_status) !! number of cases with each status
        integer :: i
        count = sum(counts, mask=.not. is_good_end([(i, i=0, last_status)]))
    end function count_failed

    !> Number of a status by its name in tables; -1 if there is none of that name.
    pure integer function status_number(name) result(number)
        character(*), intent(in) :: name !! name of a status
        number = findloc(status_names == name, .true., dim=1) - 1
    end function status_number

    !> Name of a status in tables; 'unknown' for a number that is not a status.
    pure function status_name(status) result(name)
        integer, intent(in) :: status !! number of a status
        character(:), allocatable :: name
        name = 'unknown'
        if (status >= 0 .and. status <= last_status) name = trim(status_names(status))
    end function status_name

    !> One sentence that explains a status.
    pure function status_meaning(status) result(meaning)
        integer, intent(in) :: status !! number of a status
        character(:), allocatable :: meaning
        meaning = 'this number is not a status'
        if (status >= 0 .and. status <= last_status) meaning = trim(status_meanings(status))
    end function status_meaning

end module spintop_status
