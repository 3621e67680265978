!> Searches for the events of a scene, writes or keeps the table of events, and ends the motion; the exact
!> solution of a case is a path on which they are sought.
module spintop_event_recorder
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_errors, only: error_t
    use spintop_event_text, only: column_event_t
    use spintop_events, only: event_search_t, path_t
    use spintop_exact_motion, only: exact_motion_t, prepare_exact_motion
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_row_block, only: text_buffer_t
    use spintop_trajectory_columns, only: row_maker_t, is_free_of_angles
    use spintop_scene_keys, only: scene_t
    use spintop_status, only: status_step_limit, status_too_many_events
    use spintop_stepper, only: looks_per_step
    use spintop_study_column, only: near_poles, study_column_t
    use spintop_table_column, only: column_t
    use spintop_table_file, only: table_file_t
    use spintop_text, only: string_t
    implicit none
    private
    public :: event_recorder_t, event_columns, exact_path_t

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
        type(table_file_t), private :: file
        !> Row i of the table, where it is kept in memory in place of a file: index of the event, its number, the columns.
        real(dp), allocatable :: kept(:, :)
    contains
        procedure :: set
        procedure :: search_exactly
        procedure :: keep_table
        procedure :: open_table
        procedure :: close_table
        procedure :: discard_table
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
        call self%begin(case%body, path%exact%at(0.0_dp))
        call self%judge(case%body, case%start)
        call self%find_events(path, case%t_end)
        t_end = case%t_end
        if (self%has_enough) then
            t_end = self%t
        else if (self%t < t_end) then
            status = merge(status_too_many_events, status_step_limit, self%is_full)
        end if
    end subroutine search_exactly

    !> Starts a table of the listed events in memory, with these columns of the trajectory.
    subroutine keep_table(self, columns, case, scene)
        class(event_recorder_t), intent(inout) :: self
        type(study_column_t), intent(in) :: columns(:) !! columns of the trajectory, which follow those of the events
        type(case_t), intent(in) :: case !! the case of the motion, from which the columns get their values
        type(scene_t), intent(in) :: scene !! contents of the input
        integer, parameter :: first_rows = 16
        call self%row%set(columns, case, scene)
        allocate (self%kept(size(event_columns) + size(columns), first_rows))
    end subroutine keep_table

    !> Starts the table of the listed events, with these columns of the trajectory.
    subroutine open_table(self, path, head, columns, case, scene, error)
        class(event_recorder_t), intent(inout) :: self
        character(*), intent(in) :: path, head !! path of the table, and its header
        type(study_column_t), intent(in) :: columns(:) !! columns of the trajectory, which follow those of the events
        type(case_t), intent(in) :: case !! the case of the motion, from which the columns get their values
        type(scene_t), intent(in) :: scene !! contents of the input
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        call self%row%set(columns, case, scene)
        call self%file%create(path, head, error)
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
        call self%row%close()
    end subroutine close_table

    !> Discards the table.
    subroutine discard_table(self)
        class(event_recorder_t), intent(inout) :: self
        call self%file%discard()
    end subroutine discard_table

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
