!> Events in the notation of the input: `turning_points`, `theta_deg = 30 rising`, `psi = 0 every turn`.
!>
!> Each is a column of the trajectory that passes a value, rising or falling, or an occasion such as rest. A name stands
!> for events of the table below; a text without a direction stands for two events, one for each direction.
module spintop_event_text
    use spintop_kinds, only: dp
    use spintop_event, only: event_t, occasion_knot, occasion_none, occasion_slip, occasion_stuck
    use spintop_literals, only: read_real
    use spintop_study_column, only: find_column, place_of, proof_group, study_column_t
    use spintop_text, only: lower_case, did_you_mean, join
    use spintop_trajectory_columns, only: trajectory_columns
    implicit none
    private
    public :: column_event_t, read_event, named_event_t, named_events, event_grammar

    !> An event of a column.
    type :: column_event_t
        type(event_t) :: event
        type(study_column_t) :: column
        !> Whether it is written to the table of events, and whether it ends the motion.
        logical :: is_listed = .false., ends = .false.
    end type column_event_t

    !> An event with a name, and the event it stands for.
    type :: named_event_t
        character(20) :: name
        character(20) :: in_table
        character(12) :: column
        integer :: direction
        logical :: turn_by_turn
        character(72) :: what
        integer :: occasion = occasion_none
    end type named_event_t

    !> A name may stand for several events.
    type(named_event_t), parameter :: named_events(*) = [ &
        named_event_t('turning_points', 'upper_turning_point', 'axis_z_rate', -1, .false., &
                      'both kinds of turning points'), &
        named_event_t('turning_points', 'lower_turning_point', 'axis_z_rate', 1, .false., ''), &
        named_event_t('upper_turning_points', 'upper_turning_point', 'axis_z_rate', -1, .false., &
                      'theta changes from falling to rising'), &
        named_event_t('lower_turning_points', 'lower_turning_point', 'axis_z_rate', 1, .false., &
                      'theta changes from rising to falling'), &
        named_event_t('azimuth_turns', 'azimuth_turn', 'phi', 1, .true., &
                      'phi completes another full turn from its start, either way'), &
        named_event_t('stuck', 'stuck', 't', 1, .false., 'dry friction stops the body', occasion_stuck), &
        named_event_t('slip', 'slip', 't', 1, .false., 'other torques overcome dry friction: a body at rest begins to move', &
                      occasion_slip), &
        named_event_t('knot', 'knot', 't', 1, .false., 'a row of the table of torques', occasion_knot)]

    !> A level that the time never reaches.
    real(dp), parameter :: never = -1

    !> The general notation, for help and messages.
    character(*), parameter :: event_grammar = &
        'COLUMN = VALUE [every turn] [rising|falling], COLUMN one of a trajectory, also in a unit, as theta_deg'

    character(*), parameter :: turning_columns(*) = [character(3) :: 'phi', 'psi']
    character(*), parameter :: direction_names(-1:1) = [character(8) :: ' falling', '', ' rising']

contains

    !> The events for a text; or else an error and the expected text.
    subroutine read_event(text, events, problem, hint)
        character(*), intent(in) :: text !! the event in the notation of the input
        type(column_event_t), allocatable, intent(out) :: events(:) !! the events; not allocated on an error
        character(:), allocatable, intent(out) :: problem, hint
            !! what is wrong, and what is expected; '' without an error
        type(column_event_t) :: one
        type(named_event_t) :: row
        character(:), allocatable :: name
        integer :: equals, i

        problem = ''
        hint = ''
        allocate (events(0))
        equals = index(text, '=')
        if (equals > 0) then
            call find_column_events(trim(adjustl(text(:equals - 1))), trim(adjustl(lower_case(text(equals + 1:)))), events, &
                                    problem, hint)
            return
        end if
        name = trim(adjustl(lower_case(text)))
        do i = 1, size(named_events)
            row = named_events(i)
            if (row%name /= name) cycle
            one%event = event_t(row%in_table, row%direction, turn_by_turn=row%turn_by_turn, occasion=row%occasion)
            if (row%occasion /= occasion_none) one%event%level = never
            one%column = trajectory_columns(place_of(trajectory_columns, row%column))
            events = [events, one]
        end do
        if (size(events) > 0) return
        problem = "there is no event '" // name // "'"
        hint = did_you_mean(name, named_events%name)
        if (hint == '') hint = 'an event is ' // join(pack(named_events%name, named_events%what /= ''), ', ') &
                               // ' or ' // event_grammar
    end subroutine read_event

    !> The events for `COLUMN = VALUE [every turn] [rising|falling]`.
    subroutine find_column_events(left, right, events, problem, hint)
        character(*), intent(in) :: left, right
        type(column_event_t), allocatable, intent(inout) :: events(:)
        character(:), allocatable, intent(inout) :: problem, hint
        type(column_event_t) :: one
        type(study_column_t) :: chosen
        character(:), allocatable :: number, rest, label
        integer :: direction

        call find_column(trajectory_columns, left, chosen, problem, hint)
        if (chosen%place > 0) then
            one%column = trajectory_columns(chosen%place)
            if (one%column%group == proof_group) problem = "there is no event of the column '" // left // "'"
        end if
        if (problem /= '') then
            if (hint == '') hint = '`spintop list columns` shows them all'
            return
        end if

        number = right(:index(right // ' ', ' ') - 1)
        rest = trim(adjustl(right(len(number) + 1:)))
        call read_real(number, one%event%level, problem, hint)
        if (problem /= '') return
        one%event%level = one%event%level * chosen%size
        label = left // '=' // number
        if (index(rest // ' ', 'every turn ') == 1) then
            one%event%every_turn = .true.
            label = label // ' every turn'
            rest = trim(adjustl(rest(len('every turn') + 1:)))
            if (all(turning_columns /= one%column%name)) then
                problem = "'every turn' is only for " // join(turning_columns, ' and ')
                hint = "omit 'every turn'"
                return
            end if
        end if
        if (rest /= '' .and. rest /= 'rising' .and. rest /= 'falling') then
            problem = "'" // rest // "' is not a direction"
            hint = did_you_mean(rest, [character(10) :: 'rising', 'falling', 'every turn'])
            if (hint == '') hint = 'an event is ' // event_grammar
            return
        end if
        do direction = 1, -1, -2
            if (rest == merge('falling', 'rising ', direction > 0)) cycle
            one%event%direction = direction
            one%event%name = label // direction_names(direction)
            events = [events, one]
        end do
    end subroutine find_column_events

end module spintop_event_text
