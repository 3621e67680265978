!> How a computation ended: small integers inside loops, names in tables.
module spintop_status
    implicit none
    private
    public :: status_name, status_meaning, status_names, status_meanings
    public :: status_ok, status_pole, status_non_finite, status_step_limit, status_not_converged
    public :: status_step_too_small, status_turning_point, status_outside, status_unsuitable
    public :: status_integrator, status_bad_input, last_status

    integer, parameter :: status_ok = 0
    integer, parameter :: status_pole = 1
    integer, parameter :: status_non_finite = 2
    integer, parameter :: status_step_limit = 3
    integer, parameter :: status_not_converged = 4
    integer, parameter :: status_step_too_small = 5
    integer, parameter :: status_turning_point = 6
    integer, parameter :: status_outside = 7
    integer, parameter :: status_unsuitable = 8
    integer, parameter :: status_integrator = 9
    integer, parameter :: status_bad_input = 10
    integer, parameter :: last_status = 10

    !> Names as they stand in tables, and a sentence for each. Threads take them from here: gfortran
    !> keeps the length that a function of deferred length returns in memory shared by all threads.
    character(*), parameter :: status_names(0:last_status) = [character(16) :: &
        'ok', 'pole', 'non_finite', 'step_limit', 'not_converged', 'step_too_small', &
        'turning_point', 'outside', 'unsuitable', 'integrator', 'bad_input']

    character(*), parameter :: status_meanings(0:last_status) = [character(96) :: &
        'completed', &
        'the axis is at a pole (sin theta = 0), where these equations are singular', &
        'a value overflowed or is not a number', &
        'the work allowed (integration.max_steps) is used up', &
        'the equations of an implicit step could not be solved', &
        'the step size fell to the rounding of the time', &
        'reached a turning point of theta, where the energy-rate equations end', &
        'the state left the region where the equations hold (negative radicand)', &
        'the equations do not hold for this body or start', &
        'the integrator library reported a failure of its own', &
        'the parameters of the case describe no top or no motion']

contains

    !> Name of a status as it stands in tables.
    pure function status_name(status) result(name)
        integer, intent(in) :: status
        character(:), allocatable :: name
        name = trim(status_names(status))
    end function status_name

    !> One sentence that explains a status.
    pure function status_meaning(status) result(meaning)
        integer, intent(in) :: status
        character(:), allocatable :: meaning
        meaning = trim(status_meanings(status))
    end function status_meaning

end module spintop_status
