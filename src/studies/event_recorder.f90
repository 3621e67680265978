!> Looks for the events that a scene asks for, writes those of its table, and ends the motion.
module spintop_event_recorder
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_columns, only: column_t, column_computer_t, trajectory_columns, varies_near_poles
    use spintop_errors, only: error_t
    use spintop_event_text, only: column_event_t
    use spintop_events, only: event_watch_t, path_t
    use spintop_exact_motion, only: exact_motion_t
    use spintop_motion, only: motion_t
    use spintop_table_file, only: table_file_t
    use spintop_text, only: string_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: event_recorder_t, exact_path_t, event_columns

    !> The columns of a table of events before those of the trajectory.
    type(column_t), parameter :: event_columns(*) = [ &
        column_t('event', '', 'what happened', 0), &
        column_t('number', '', 'how often by then', 0)]

    !> Looks for events of columns.
    type, extends(event_watch_t) :: event_recorder_t
        !> Events written to the table.
        integer :: rows = 0
        !> An error in writing; it ends the motion, too.
        type(error_t), allocatable :: error
        !> Number of the event that ended the motion; 0 if none did.
        integer :: ended_by = 0
        logical, allocatable, private :: is_listed(:), ends(:)
        !> Events left until the motion ends.
        integer, private :: left = 1
        !> The quantities of the events, the azimuth of the start, and the row of the table.
        type(column_computer_t), private :: quantity, row
        real(dp), private :: azimuth = 0
        type(table_file_t), private :: file
    contains
        procedure :: set
        procedure :: open_table
        procedure :: close_table
        procedure :: discard_table
        procedure :: quantities
        procedure :: meet
    end type event_recorder_t

    !> The exact motion, any time; looks at it are counted.
    type, extends(path_t) :: exact_path_t
        type(exact_motion_t) :: exact
        integer(int64) :: looks = 0, most_looks = huge(1_int64)
    contains
        procedure :: at
        procedure :: is_spent
    end type exact_path_t

contains

    !> Looks for these events of a case; the motion ends at the n-th that ends it.
    subroutine set(self, events, n, case)
        class(event_recorder_t), intent(inout) :: self
        type(column_event_t), intent(in) :: events(:)
        integer, intent(in) :: n
        type(case_t), intent(in) :: case
        self%events = events%event
        self%is_listed = events%is_listed
        self%ends = events%ends
        self%left = n
        self%ended_by = 0
        self%azimuth = case%given_start%angle(1)
        call self%quantity%set(events%column, case)
        self%pole_axis = 0
        if (any(varies_near_poles(trajectory_columns(events%column)))) then
            self%pole_axis = case%turn%vector([0.0_dp, 0.0_dp, 1.0_dp])
        end if
    end subroutine set

    !> Starts the table of the listed events, with these columns of the trajectory.
    subroutine open_table(self, path, head, columns, case, error)
        class(event_recorder_t), intent(inout) :: self
        character(*), intent(in) :: path, head
        integer, intent(in) :: columns(:)
        type(case_t), intent(in) :: case
        type(error_t), allocatable, intent(out) :: error
        call self%row%set(columns, case)
        call self%file%create(path, head, error)
    end subroutine open_table

    !> Ends the table.
    subroutine close_table(self, trailer, error)
        class(event_recorder_t), intent(inout) :: self
        type(string_t), intent(in) :: trailer(:)
        type(error_t), allocatable, intent(out) :: error
        if (allocated(self%error)) then
            error = self%error
        else
            call self%file%finish(trailer, error)
        end if
    end subroutine close_table

    !> Gives the table up.
    subroutine discard_table(self)
        class(event_recorder_t), intent(inout) :: self
        call self%file%discard()
    end subroutine discard_table

    !> The columns, or how far the azimuth is from its start.
    subroutine quantities(self, motion, values)
        class(event_recorder_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        real(dp), intent(out) :: values(:)
        values = self%quantity%row(motion)
        where (self%events(:size(values))%turn_by_turn) values = abs(values - self%azimuth)
    end subroutine quantities

    !> Writes an event, and ends the motion if it is time.
    subroutine meet(self, number, motion)
        class(event_recorder_t), intent(inout) :: self
        integer, intent(in) :: number
        type(motion_t), intent(in) :: motion
        type(text_buffer_t) :: line

        if (self%is_listed(number)) then
            call self%row%come_near(self%quantity)
            call line%put_text(trim(self%events(number)%name))
            call line%put_integer(int(self%events(number)%count, int64))
            call line%put_reals(self%row%row(motion))
            call line%end_row()
            call self%file%put(line%contents(), self%error)
            self%rows = self%rows + 1
        end if
        if (self%ends(number)) then
            self%left = self%left - 1
            if (self%left == 0) self%ended_by = number
        end if
        self%has_enough = self%ended_by > 0 .or. allocated(self%error)
    end subroutine meet

    !> The exact motion at a time.
    subroutine at(self, t, motion)
        class(exact_path_t), intent(inout) :: self
        real(dp), intent(in) :: t
        type(motion_t), intent(out) :: motion
        motion = self%exact%at(t)
        self%looks = self%looks + 1
    end subroutine at

    !> Whether the work of the case is used up.
    logical function is_spent(self)
        class(exact_path_t), intent(in) :: self
        is_spent = self%looks >= self%most_looks
    end function is_spent

end module spintop_event_recorder
