!> The rows of a motion: the motion is computed, in closed form or step by step, and each of its rows goes to a table,
!> or is kept. The motions at all nodes of a key, whose rows belong together by their numbers, give derivatives.
module spintop_motion_rows
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_case, only: case_t
    use spintop_certificate, only: proof_words
    use spintop_differences, only: nodes_t
    use spintop_errors, only: error_t, exit_internal
    use spintop_event_recorder, only: event_recorder_t, exact_path_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, outcome_t, observer_t
    use spintop_job, only: job_t, study_head
    use spintop_kinds, only: dp, no_number
    use spintop_motion, only: motion_t
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_planning, only: plan_t, sample_time
    use spintop_progress, only: progress_t
    use spintop_row_table, only: row_table_t
    use spintop_row_block, only: row_block_t
    use spintop_trajectory_columns, only: row_maker_t
    use spintop_scene_keys, only: scene_t
    use spintop_sensitivity, only: varied_motions_t
    use spintop_status, only: is_good_end, is_ok, status_non_finite, status_ok, status_step_limit
    use spintop_stepper, only: looks_per_step
    use spintop_study_column, only: needs_work, study_column_t, categorical
    use spintop_table_column, only: status_column
    use spintop_text, only: append, escaped
    implicit none
    private
    public :: writer_t, compute_motion, find_sensitivities

    !> The quantity that is the coordinate of the rows in NetCDF, and the dimension where that is not chosen.
    character(*), parameter :: time_column = 't', row_dimension = 'row'

    !> Rows that are passed on at once.
    integer, parameter :: rows_at_once = 1024

    !> Writes a row for each motion, or keeps it.
    type, extends(observer_t) :: writer_t
        type(row_maker_t) :: columns
        type(study_column_t), allocatable :: chosen(:)
        !> The table, CSV or NetCDF; its path and header, and rows that are passed on at once.
        type(row_table_t) :: table
        character(:), allocatable, private :: table_path, head
        type(row_block_t), private :: block
        !> The values of row i, where rows are kept: `kept(:, i)`. Otherwise they go to the table.
        real(dp), allocatable :: kept(:, :)
        !> The times of the rows where they are asked for, s: in any order of an exact motion, which is prepared in advance.
        real(dp), allocatable :: asked(:)
        type(exact_path_t), allocatable :: path
        !> How far such a time may be from the end of a step of fixed size, s, and whether one was between steps.
        real(dp) :: slack = 0
        logical :: has_missed = .false.
        type(progress_t) :: progress
        real(dp) :: t_end = 0
        !> Time after which no row is written, s.
        real(dp) :: t_stop = huge(1.0_dp)
        !> Number of rows of the whole table.
        integer(int64) :: total = 0
        integer :: rows = 0
        !> The motion of the last row, in the axes of the computation.
        type(motion_t) :: last
        !> Whether a value of a motion overflowed or is NaN, and the time, s.
        logical :: is_undefined = .false.
        real(dp) :: t_undefined = 0
        type(error_t), allocatable :: error
    contains
        procedure :: observe
        procedure :: set_columns
        procedure :: describe
        procedure :: start
        procedure :: add_row
        procedure :: finish
        procedure, private :: write_row, keep_row
    end type writer_t

    !> The motions of a job with other values of its keys.
    type, extends(varied_motions_t) :: trajectories_t
        type(job_t), pointer :: job => null()
        type(study_column_t), allocatable :: columns(:)
    contains
        procedure :: find
    end type trajectories_t

contains

    !> Describes the table of a job, before it is created.
    subroutine describe(self, job)
        class(writer_t), intent(inout) :: self
        type(job_t), intent(in) :: job !! the job
        integer :: i

        self%table_path = job%files%table
        allocate (self%table%columns(size(job%columns) + 2 * job%sensitivities%count))
        self%table%columns%column_t = [job%columns%column_t, job%sensitivities%table_columns()]
        do i = 1, size(job%columns)
            if (job%columns(i)%is(categorical)) call self%table%columns(i)%set_words(proof_words(0:1))
        end do
        self%head = study_head(job, self%table%columns)
        self%table%has_journal = .false.
        if (job%input%scene%format /= 'netcdf') return
        allocate (self%table%netcdf)
        self%table%netcdf%axes = [netcdf_axis_t(row_dimension, job%plan%samples)]
        if (job%input%scene%compression >= 0) self%table%netcdf%compression = job%input%scene%compression
        i = findloc(job%columns%quantity(), time_column, dim=1)
        if (i == 0) return
        self%table%columns(i)%axis = 1
        self%table%netcdf%axes(1)%name = job%columns(i)%name
    end subroutine describe

    !> Starts the table, unless it is to be left where it is complete (`resume`); or starts it anew after `discard`.
    subroutine start(self, resume, restart, error)
        class(writer_t), intent(inout) :: self
        logical, intent(in) :: resume, restart !! the options of the command line
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%table%counts = 0
        call self%block%reserve(size(self%table%columns), rows_at_once)
        call self%table%start(self%table_path, self%head, resume, restart, error)
    end subroutine start

    !> Adds a row.
    subroutine add_row(self, values, error)
        class(writer_t), intent(inout) :: self
        real(dp), intent(in), contiguous :: values(:) !! a number for each column, of a word its number from 0
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        self%block%rows = self%block%rows + 1
        self%block%cells(:, self%block%rows) = values
        if (self%block%rows == rows_at_once) call append_block(self, error)
    end subroutine add_row

    !> Passes the next rows on.
    subroutine append_block(self, error)
        class(writer_t), intent(inout) :: self
        type(error_t), allocatable, intent(out) :: error
        self%block%counts(status_ok) = self%block%rows
        call self%table%format(self%block)
        call self%table%append(self%block, error)
        call self%block%clear()
    end subroutine append_block

    !> Finishes the table, with how the motion ended.
    subroutine finish(self, status, error)
        class(writer_t), intent(inout) :: self
        character(*), intent(in) :: status !! `ok`, or the reason and the time of the end
        type(error_t), allocatable, intent(out) :: error !! not allocated on success

        call append_block(self, error)
        if (allocated(error)) return
        call append(self%table%trailer, status_column // ': ' // status)
        if (allocated(self%table%netcdf)) self%table%netcdf%axes(1)%length = int(self%table%rows())
        call self%table%finish(error)
    end subroutine finish

    !> Sets the columns of the rows, and the motion of which they are.
    subroutine set_columns(self, columns, case, scene)
        class(writer_t), intent(inout) :: self
        type(study_column_t), intent(in) :: columns(:) !! the columns
        type(case_t), intent(in) :: case !! the case of the motion; the rows end with its span
        type(scene_t), intent(in), optional :: scene !! contents of the input, if numbers may be proved
        self%chosen = columns
        self%counts_turns = any(columns%quantity() == 'phi' .or. columns%quantity() == 'psi')
        self%wants_work = any(columns%is(needs_work))
        self%t_end = case%t_end
        call self%columns%set(columns, case, scene)
    end subroutine set_columns

    !> Computes the motion, in closed form or step by step, up to the event that ends it.
    subroutine compute_motion(case, plan, times, writer, outcome, recorder, scene)
        type(case_t), intent(in) :: case !! the case whose motion is computed
        type(plan_t), intent(inout) :: plan !! model and method
        real(dp), intent(inout) :: times(:) !! times of the rows; not needed for the exact solution
        type(writer_t), intent(inout) :: writer !! what takes the rows
        type(outcome_t), intent(out) :: outcome !! how the motion ended
        type(event_recorder_t), intent(inout), optional :: recorder !! search for events
        type(scene_t), intent(in), optional :: scene !! contents of the input, for a search
        type(outcome_t) :: first
        logical :: is_again
        integer :: i

        if (plan%exact) then
            call sample_exactly(case, plan, writer, outcome, recorder)
        else
            call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, times, writer, &
                outcome, recorder)
            is_again = .false.
            if (present(recorder)) is_again = recorder%ended_by > 0 .and. plan%is_adaptive() .and. .not. writer%has_enough
            ! A motion that an event ended is computed once more, in the same steps, up to there: its rows are spread over what was
            ! run, and the last is the motion at the event. Both computations share the work of the case.
            if (is_again .and. .not. allocated(writer%kept)) then
                call writer%table%discard()
                call writer%start(.false., .true., writer%error)
                is_again = .not. allocated(writer%error)
            end if
            if (is_again) then
                first = outcome
                writer%rows = 0
                call writer%columns%set(writer%chosen, case, scene)
                times = [(sample_time(first%t, size(times), i), i=1, size(times))]
                writer%t_stop = first%t
                associate (max_steps => plan%stepper%controls%max_steps)
                    max_steps = max_steps - first%counts%work()
                    call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, times, writer, outcome)
                    max_steps = max_steps + first%counts%work()
                end associate
                if (is_good_end(outcome%status)) then
                    outcome%status = first%status
                    outcome%t = first%t
                    outcome%t_stuck = first%t_stuck
                end if
                call outcome%counts%add(first%counts)
            end if
        end if
        if (writer%is_undefined) then
            outcome%status = status_non_finite
            outcome%t = writer%t_undefined
        end if
        call writer%progress%finish()
    end subroutine compute_motion

    !> The exact solution at equally spaced times, up to the event that ends the motion.
    subroutine sample_exactly(case, plan, writer, outcome, recorder)
        type(case_t), intent(in) :: case
        type(plan_t), intent(in) :: plan
        type(writer_t), target, intent(inout) :: writer
        type(outcome_t), intent(out) :: outcome
        type(event_recorder_t), intent(inout), optional :: recorder
        type(exact_path_t) :: path
        type(motion_t) :: motion
        real(dp) :: t_end, t_known, t, values(size(writer%chosen))
        logical :: are_angles, has_rows
        integer :: i, rows

        if (allocated(writer%path)) then
            path = writer%path
        else
            call path%begin(case, looks_per_step * plan%max_steps, outcome%status)
        end if
        if (.not. is_ok(outcome%status)) return
        t_end = case%t_end
        t_known = t_end
        if (present(recorder)) then
            ! No end is sought of a motion that has no first row: where it overflows the search would take all of its work.
            has_rows = allocated(writer%asked) .or. writer%columns%is_defined(writer%columns%row(path%exact%at(0.0_dp)))
            if (has_rows) call recorder%search_exactly(path, case, t_end, outcome%status)
            t_known = recorder%t
        end if
        ! The rows have a budget of their own.
        rows = plan%samples
        if (allocated(writer%asked)) rows = size(writer%asked)
        call path%restart(case, looks_per_step * plan%max_steps + rows)
        path%counts_turns = writer%counts_turns
        are_angles = writer%columns%wants_angles_of(path%exact)
        do i = 1, rows
            t = sample_time(t_end, rows, i)
            if (allocated(writer%asked)) t = writer%asked(i)
            if (.not. is_ok(outcome%status) .and. t > t_known) exit
            if (are_angles) then
                call writer%columns%find_exact_row(path%exact, t, values)
                call writer%keep_row(t, values)
            else
                call path%at(t, motion)
                if (path%is_spent()) then
                    outcome%status = status_step_limit
                    t_known = outcome%t
                    exit
                end if
                call writer%write_row(motion)
            end if
            if (writer%has_enough) exit
            outcome%t = t
        end do
        if (.not. is_ok(outcome%status)) outcome%t = t_known
    end subroutine sample_exactly

    !> Writes the row of a state of a formulation.
    subroutine observe(self, formulation, t, y, near)
        class(writer_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        type(motion_t) :: motion
        if (allocated(self%asked)) then
            do while (self%rows + 1 < size(self%asked))
                if (self%asked(self%rows + 1) >= t - self%slack) exit
                self%has_missed = .true.
                self%rows = self%rows + 1
            end do
            ! The end of the equations, which is shown too, was not asked for.
            if (self%rows == size(self%asked)) return
            if (abs(self%asked(self%rows + 1) - t) > self%slack) return
        end if
        motion = formulation%motion(t, y, near)
        motion%given_angle = self%given_angle
        call self%write_row(motion)
    end subroutine observe

    !> Writes the row of a motion.
    subroutine write_row(self, motion)
        class(writer_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        if (self%has_enough) return
        self%last = motion
        call self%keep_row(motion%t, self%columns%row(motion, work=self%work))
    end subroutine write_row

    !> Writes the values of a row at a time t, s.
    subroutine keep_row(self, t, values)
        class(writer_t), intent(inout) :: self
        real(dp), intent(in) :: t, values(:)
        self%is_undefined = .not. self%columns%is_defined(values)
        self%t_undefined = t
        self%has_enough = self%is_undefined
        if (self%is_undefined) return
        self%rows = self%rows + 1
        if (allocated(self%kept)) then
            self%kept(:, self%rows) = values
        else
            call self%add_row(values, self%error)
        end if
        self%has_enough = allocated(self%error) .or. t >= self%t_stop
        if (allocated(self%asked)) self%has_enough = self%rows == size(self%asked)
        call self%progress%update(int(t / self%t_end * self%total, int64))
    end subroutine keep_row

    !> The derivatives and their errors in each row.
    subroutine find_sensitivities(job, columns, base, cells, error)
        type(job_t), target, intent(in) :: job !! the job
        type(study_column_t), intent(in) :: columns(:) !! the columns of which there are derivatives
        real(dp), intent(in) :: base(:, :) !! their values in each row of the motion itself
        real(dp), intent(out) :: cells(:, :) !! two for each derivative in each row; NaN where it does not exist
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(trajectories_t) :: motions
        integer :: i, status

        motions%job => job
        motions%columns = columns
        associate (wanted => job%sensitivities)
            call wanted%find_derivatives([(wanted%keys(i)%nodes(wanted%keys(i)%slot%get()), i=1, size(wanted%keys))], &
                                         motions, base, cells, status)
        end associate
        if (status /= 0) error = error_t(exit_internal, escaped(job%input%path) // ': not enough memory for the derivatives &
                                         &in all rows; use fewer span.samples')
    end subroutine find_sensitivities

    !> The rows of the motion with another value of a key. Rows that it does not have stay as they are.
    subroutine find(self, key, nodes, i, values, accuracy)
        class(trajectories_t), intent(in) :: self
        integer, intent(in) :: key, i !! index of the key, and that of the node
        type(nodes_t), intent(in) :: nodes !! the values of the key
        real(dp), intent(inout) :: values(:, :) !! the columns (rows) in each row of the table
        integer, intent(in), optional :: accuracy !! the number of another accuracy
        type(scene_t), allocatable, target :: scene
        type(event_recorder_t), allocatable :: recorder
        type(writer_t), allocatable :: writer
        type(outcome_t) :: outcome
        type(case_t) :: case
        type(plan_t) :: plan
        real(dp), allocatable :: times(:)
        logical :: exists
        integer :: row, stride

        associate (job => self%job)
            call job%sensitivities%keys(key)%plan_at(job%input%scene, nodes%x(i), scene, case, plan, exists, job%plan, accuracy)
            if (.not. exists) return
            ! Where each step is a row, smaller steps are more rows.
            stride = max(1, (plan%samples - 1) / (job%plan%samples - 1))
            if (plan%samples - 1 /= stride * (job%plan%samples - 1) .or. stride > 1 .and. .not. present(accuracy)) return
            if (scene%stop_at /= '') then
                allocate (recorder)
                call recorder%set(job%events, job%stop_after, case)
            end if
        end associate
        allocate (writer)
        call writer%set_columns(self%columns, case, scene)
        allocate (writer%kept(size(self%columns), plan%samples), source=no_number)
        times = [(sample_time(case%t_end, plan%samples, row), row=1, merge(0, plan%samples, plan%exact))]
        call compute_motion(case, plan, times, writer, outcome, recorder, scene)
        do row = 1, size(values, 2)
            if (1 + stride * (row - 1) <= writer%rows) values(:, row) = writer%kept(:, 1 + stride * (row - 1))
        end do
        ! The last row is that of the event which ends the motion.
        if (stride > 1 .and. allocated(recorder) .and. writer%rows > 0) values(:, size(values, 2)) = writer%kept(:, writer%rows)
        call writer%columns%proof%close()
    end subroutine find

end module spintop_motion_rows
