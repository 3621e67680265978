!> Events as a user names them: `turning_points`, `theta_deg = 30 rising`, `psi = 0 every turn`.
!>
!> Each is a column of the trajectory table that passes a value, rising or falling. A name stands for
!> events of the table below; a text without a direction stands for two, one of each.
module spintop_event_text
    use spintop_kinds, only: dp, degree
    use spintop_columns, only: trajectory_columns, place_of_column
    use spintop_events, only: event_t
    use spintop_literals, only: read_real
    use spintop_text, only: string_t, lower_case, nearest_word, join
    implicit none
    private
    public :: column_event_t, read_event, named_event_t, named_events, event_grammar

    !> An event of a column.
    type :: column_event_t
        type(event_t) :: event
        !> Place in `trajectory_columns`.
        integer :: column = 0
        !> Whether it has a row in the table of events, and whether it ends the motion.
        logical :: is_listed = .false., ends = .false.
    end type column_event_t

    !> An event with a name of its own, and what it stands for.
    type :: named_event_t
        character(20) :: name
        character(20) :: in_table
        character(12) :: column
        integer :: direction
        logical :: turn_by_turn
        character(72) :: what
    end type named_event_t

    !> A name may stand for several.
    type(named_event_t), parameter :: named_events(*) = [ &
        named_event_t('turning_points', 'upper_turning_point', 'axis_z_rate', -1, .false., &
                      'both of the next two'), &
        named_event_t('turning_points', 'lower_turning_point', 'axis_z_rate', 1, .false., ''), &
        named_event_t('upper_turning_points', 'upper_turning_point', 'axis_z_rate', -1, .false., &
                      'theta turns from falling to rising'), &
        named_event_t('lower_turning_points', 'lower_turning_point', 'axis_z_rate', 1, .false., &
                      'theta turns from rising to falling'), &
        named_event_t('azimuth_turns', 'azimuth_turn', 'phi', 1, .true., &
                      'phi is one more full turn away from its start, on either side')]

    !> What else may be written, for help and messages.
    character(*), parameter :: event_grammar = &
        'COLUMN = VALUE [every turn] [rising|falling], COLUMN one of a trajectory or phi_deg, theta_deg, psi_deg'

    character(*), parameter :: suffix = '_deg', turning_columns(*) = [character(3) :: 'phi', 'psi']
    character(*), parameter :: direction_names(-1:1) = [character(8) :: ' falling', '', ' rising']

contains

    !> The events that a text stands for; or else what is wrong, and what would be right.
    subroutine read_event(text, events, problem, hint)
        character(*), intent(in) :: text
        type(column_event_t), allocatable, intent(out) :: events(:)
        character(:), allocatable, intent(out) :: problem, hint
        character(:), allocatable :: left, right
        integer :: equals

        problem = ''
        hint = ''
        allocate (events(0))
        equals = index(text, '=')
        if (equals == 0) then
            call take_named(trim(adjustl(lower_case(text))), events, problem, hint)
        else
            left = trim(adjustl(text(:equals - 1)))
            right = trim(adjustl(lower_case(text(equals + 1:))))
            call take_column(left, right, events, problem, hint)
        end if
    end subroutine read_event

    !> The events of a name.
    subroutine take_named(name, events, problem, hint)
        character(*), intent(in) :: name
        type(column_event_t), allocatable, intent(inout) :: events(:)
        character(:), allocatable, intent(inout) :: problem, hint
        type(column_event_t) :: one
        type(named_event_t) :: row
        integer :: i

        do i = 1, size(named_events)
            row = named_events(i)
            if (row%name /= name) cycle
            one%event = event_t(row%in_table, row%direction, turn_by_turn=row%turn_by_turn)
            one%column = place_of_column(row%column)
            events = [events, one]
        end do
        if (size(events) > 0) return
        problem = "there is no event '" // name // "'"
        hint = meant(name, named_events%name)
        if (hint == '') hint = 'an event is ' // join(pack(named_events%name, named_events%what /= ''), ', ') &
                               // ' or ' // event_grammar
    end subroutine take_named

    !> The events of `COLUMN = VALUE [every turn] [rising|falling]`.
    subroutine take_column(left, right, events, problem, hint)
        character(*), intent(in) :: left, right
        type(column_event_t), allocatable, intent(inout) :: events(:)
        character(:), allocatable, intent(inout) :: problem, hint
        type(column_event_t) :: one
        character(:), allocatable :: column, number, rest, label
        real(dp) :: unit
        integer :: last, direction

        column = left
        unit = 1
        last = len(left) - len(suffix)
        if (last > 0 .and. place_of_column(left) == 0) then
            if (left(last + 1:) == suffix .and. index(' phi theta psi ', ' ' // left(:last) // ' ') > 0) then
                column = left(:last)
                unit = degree
            end if
        end if
        one%column = place_of_column(column)
        if (one%column == 0) then
            problem = "there is no column '" // left // "'"
            hint = meant(left, trajectory_columns%name)
            if (hint == '') hint = '`spintop list columns` shows them all'
            return
        end if

        number = right(:index(right // ' ', ' ') - 1)
        rest = trim(adjustl(right(len(number) + 1:)))
        call read_real(number, one%event%level, problem, hint)
        if (problem /= '') return
        one%event%level = one%event%level * unit
        label = left // '=' // number
        if (index(rest // ' ', 'every turn ') == 1) then
            one%event%every_turn = .true.
            label = label // ' every turn'
            rest = trim(adjustl(rest(len('every turn') + 1:)))
            if (all(turning_columns /= column)) then
                problem = "'every turn' is for the angles that turn, " // join(turning_columns, ' and ')
                hint = "leave 'every turn' out"
                return
            end if
        end if
        if (rest /= '' .and. rest /= 'rising' .and. rest /= 'falling') then
            problem = "'" // rest // "' is no direction"
            hint = meant(rest, [character(10) :: 'rising', 'falling', 'every turn'])
            if (hint == '') hint = 'an event is ' // event_grammar
            return
        end if
        do direction = 1, -1, -2
            if (rest == merge('falling', 'rising ', direction > 0)) cycle
            one%event%direction = direction
            one%event%name = label // direction_names(direction)
            events = [events, one]
        end do
    end subroutine take_column

    !> `did you mean ...?`, or nothing where no word is near.
    function meant(word, words) result(hint)
        character(*), intent(in) :: word, words(:)
        character(:), allocatable :: hint
        type(string_t) :: known(size(words))
        integer :: i
        do i = 1, size(words)
            known(i)%text = trim(words(i))
        end do
        hint = nearest_word(word, known)
        if (hint /= '') hint = "did you mean '" // hint // "'?"
    end function meant

end module spintop_event_text
