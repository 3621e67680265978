!> The events of a scene. In the notation of the input: `turning_points`, `theta_deg = 30 rising`, `psi = 0 every turn`. Each is
!> a column of the trajectory that passes a value, rising or falling, or an occasion such as rest. A name stands for events of
!> the table below; a text without a direction stands for two events, one for each direction.
!>
!> They are searched for, written to a table or kept, and end the motion; the exact solution of a case is a path on which
!> they are sought.
module spintop_event_recorder
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_errors, only: error_t
    use spintop_event, only: event_t, occasion_knot, occasion_none, occasion_slip, occasion_stuck
    use spintop_events, only: event_search_t, path_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_kinds, only: dp
    use spintop_literals, only: read_real
    use spintop_motion, only: motion_t
    use spintop_row_block, only: text_buffer_t
    use spintop_scene_keys, only: scene_t
    use spintop_status, only: status_step_limit, status_too_many_events
    use spintop_stepper, only: looks_per_step
    use spintop_study_column, only: find_column, place_of, proof_group, study_column_t, near_poles
    use spintop_table_column, only: column_t
    use spintop_journaled_table, only: table_file_t
    use spintop_text, only: lower_case, did_you_mean, join, string_t
    use spintop_trajectory_columns, only: trajectory_columns, row_maker_t, is_free_of_angles
    implicit none
    private
    public :: column_event_t, read_event, named_event_t, named_events, event_grammar, event_recorder_t, event_columns, &
        exact_path_t

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

    !> The columns of a table of events before those of the trajectory.
    type(column_t), parameter :: event_columns(*) = [ &
        column_t('event', '', 'the event'), &
        column_t('number', '', 'number of this event so far')]

    !> Searches for events of columns.
    type, extends(event_search_t) :: event_recorder_t
        !> Number of events in the table.
        integer :: rows = 0
        !> An error of writing, which also ends the motion.
        type(error_t), allocatable :: error
        !> Index of the event that ended the motion; 0 if there is none.
        integer :: ended_by = 0
        logical, allocatable, private :: is_listed(:), ends(:)
        !> Number of events until the motion ends.
        integer, private :: left = 1
        !> Computers of the quantities of the events and of the row of the table, and the azimuth of the
        !> start.
        type(row_maker_t), private :: quantity, row
        real(dp), private :: azimuth = 0
        type(table_file_t) :: file
        !> Row i of the table, where it is kept in memory in place of a file: index of the event, its number, the columns.
        real(dp), allocatable :: kept(:, :)
    contains
        procedure :: set
        procedure :: search_exactly
        procedure :: open_table
        procedure :: close_table
        procedure :: quantities
        procedure :: handle_event
    end type event_recorder_t

    !> The exact solution as a path; its evaluations are counted.
    type, extends(path_t) :: exact_path_t
        type(exact_motion_t) :: exact
        !> Whether phi and psi count their turns, which takes steps of their own for a free body and for one that was given
        !> in other axes; otherwise its angles are the values nearest to those of the start.
        logical :: counts_turns = .true.
        !> The last instant; the turns of the angles are counted from there.
        type(motion_t), private :: last
    contains
        procedure :: begin
        procedure :: restart
        procedure :: at
    end type exact_path_t

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

    !> Sets the events of a case. The motion ends at the n-th event that may end it.
    subroutine set(self, events, n, case)
        class(event_recorder_t), intent(inout) :: self
        type(column_event_t), intent(in) :: events(:) !! the events
        integer, intent(in) :: n !! number of the event that ends the motion
        type(case_t), intent(in) :: case !! the case whose motion is searched
        self%events = events%event
        self%is_listed = events%is_listed
        self%ends = events%ends
        self%left = n
        self%ended_by = 0
        self%azimuth = case%given_start%angle(1)
        call self%quantity%set(events%column, case)
        self%needs_angles = .not. all(is_free_of_angles(events%column))
        self%pole_axis = 0
        if (any(events%column%is(near_poles))) then
            self%pole_axis = case%turn%vector([0.0_dp, 0.0_dp, 1.0_dp])
        end if
    end subroutine set

    !> Searches the exact motion of a case for its events, up to the end of its span or the event that ends the motion.
    subroutine search_exactly(self, path, case, t_end, status)
        class(event_recorder_t), intent(inout) :: self
        class(exact_path_t), intent(inout) :: path !! the motion, at its start; the search is part of its work
        type(case_t), intent(in) :: case !! the case of that motion
        real(dp), intent(out) :: t_end !! where the motion ends, s
        integer, intent(inout) :: status !! why the search, at the time `self%t`, did not come to that end; else unchanged
        call self%begin(case%body, path%exact%at(0.0_dp), case%start)
        call self%find_events(path, case%t_end)
        t_end = case%t_end
        if (self%has_enough) then
            t_end = self%t
        else if (self%t < t_end) then
            status = merge(status_too_many_events, status_step_limit, self%is_full)
        end if
    end subroutine search_exactly

    !> Starts the table of the listed events, with these columns of the trajectory: in a file, or without a path in memory.
    subroutine open_table(self, columns, case, scene, error, path, head)
        class(event_recorder_t), intent(inout) :: self
        type(study_column_t), intent(in) :: columns(:) !! columns of the trajectory, which follow those of the events
        type(case_t), intent(in) :: case !! the case of the motion, from which the columns get their values
        type(scene_t), intent(in) :: scene !! contents of the input
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(*), intent(in), optional :: path, head !! path of the table, and its header
        integer, parameter :: first_rows = 16
        call self%row%set(columns, case, scene)
        if (present(path)) then
            call self%file%create(path, head, error)
        else
            allocate (self%kept(size(event_columns) + size(columns), first_rows))
        end if
    end subroutine open_table

    !> Ends the table.
    subroutine close_table(self, trailer, error)
        class(event_recorder_t), intent(inout) :: self
        type(string_t), intent(in) :: trailer(:) !! comment lines after the last row
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        if (allocated(self%error)) then
            error = self%error
        else
            call self%file%finish(trailer, error)
        end if
        call self%row%proof%close()
    end subroutine close_table

    !> The columns of the events, or the change of azimuth since the start.
    subroutine quantities(self, motion, values)
        class(event_recorder_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion !! the motion at an instant
        real(dp), intent(out) :: values(:) !! one value for each event
        values = self%quantity%row(motion, as_computed=.true.)
        where (self%events(:size(values))%turn_by_turn) values = abs(values - self%azimuth)
    end subroutine quantities

    !> Writes an event, and ends the motion if this is the event that ends it.
    subroutine handle_event(self, number, motion)
        class(event_recorder_t), intent(inout) :: self
        integer, intent(in) :: number !! index of the event in `events`
        type(motion_t), intent(in) :: motion !! the motion at the event
        type(text_buffer_t) :: line
        real(dp), allocatable :: more(:, :)

        if (self%is_noise) return
        if (self%is_listed(number) .and. allocated(self%kept)) then
            if (self%rows == size(self%kept, 2)) then
                allocate (more(size(self%kept, 1), 2 * self%rows))
                more(:, :self%rows) = self%kept
                call move_alloc(more, self%kept)
            end if
            self%rows = self%rows + 1
            self%kept(:, self%rows) = [real(dp) :: number, self%events(number)%count, self%row%row(motion, work=self%work)]
        else if (self%is_listed(number)) then
            call line%add_text(trim(self%events(number)%name))
            call line%add_integer(int(self%events(number)%count, int64))
            call self%row%write_row(self%row%row(motion, work=self%work), line)
            call line%end_row()
            call self%file%append(line%contents(), self%error)
            self%rows = self%rows + 1
        end if
        if (self%ends(number)) then
            self%left = self%left - 1
            if (self%left == 0) self%ended_by = number
        end if
        self%has_enough = self%ended_by > 0 .or. allocated(self%error)
    end subroutine handle_event

    !> Prepares the exact solution of a case; the work is at most `most_looks` instants.
    subroutine begin(self, case, most_looks, status)
        class(exact_path_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! the case; its body must have a closed form
        integer(int64), intent(in) :: most_looks !! bound of the work
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call prepare_exact_motion(case%body, case%start, self%exact, status)
        self%greatest_rate = 0
        if (allocated(self%exact%free)) self%greatest_rate = self%exact%free%greatest_rate
        call self%restart(case, most_looks)
    end subroutine begin

    !> Returns to the start of the case, with a new bound of the work.
    subroutine restart(self, case, most_looks)
        class(exact_path_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! the case to whose start the path returns
        integer(int64), intent(in) :: most_looks !! bound of the work
        self%looks = 0
        self%most_looks = most_looks
        self%last = case%start
    end subroutine restart

    !> The exact solution at a time. A step that only counts turns is a step of the case.
    subroutine at(self, t, motion, with_angles)
        class(exact_path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        type(motion_t), intent(out) :: motion !! the motion at that time
        logical, intent(in), optional :: with_angles !! they are there in any case
        integer(int64) :: steps, most_steps
        self%looks = self%looks + 1
        if (self%counts_turns) then
            steps = 0
            most_steps = (self%most_looks - self%looks + looks_per_step - 1) / looks_per_step
            call self%exact%follow(self%last, t, motion, steps, most_steps)
            self%looks = self%looks + looks_per_step * steps
            if (.not. self%is_spent()) self%last = motion
        else
            motion = self%exact%at(t)
        end if
    end subroutine at

end module spintop_event_recorder
