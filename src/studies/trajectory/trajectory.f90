!> The trajectory study: one motion, one table.
module spintop_trajectory
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: seconds
    use spintop_kinds, only: dp
    use spintop_case, only: case_t
    use spintop_errors, only: error_t, exit_internal
    use spintop_event_recorder, only: event_recorder_t, event_columns, exact_path_t
    use spintop_exact_cost, only: measure_exact_cost
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_job, only: job_t
    use spintop_motion_table, only: motion_table_t
    use spintop_motion, only: motion_t
    use spintop_options, only: options_t
    use spintop_plan, only: plan_t, sample_time
    use spintop_plain_text, only: escaped
    use spintop_progress, only: progress_t
    use spintop_row_maker, only: row_maker_t
    use spintop_status, only: is_good_end, status_at_rest, status_ok, status_non_finite, status_step_limit, &
        status_too_many_events, status_name, status_meaning
    use spintop_stepper, only: looks_per_step
    use spintop_study_head, only: study_head
    use spintop_summary, only: summary_t, decimal, rounded
    use spintop_text, only: to_text, string_t
    use spintop_trajectory_column, only: trajectory_column_t
    use spintop_trajectory_columns, only: trajectory_columns
    implicit none
    private
    public :: run_trajectory

    !> Writes a row for each motion.
    type, extends(observer_t) :: writer_t
        type(row_maker_t) :: columns
        type(trajectory_column_t), allocatable :: chosen(:)
        type(motion_table_t) :: table
        type(progress_t) :: progress
        real(dp) :: t_end = 0
        !> Time after which no row is written, s.
        real(dp) :: t_stop = huge(1.0_dp)
        !> Number of rows of the whole table.
        integer(int64) :: total = 0
        integer :: rows = 0
        !> Whether a value of a motion overflowed or is NaN, and the time, s.
        logical :: is_undefined = .false.
        real(dp) :: t_undefined = 0
        type(error_t), allocatable :: error
    contains
        procedure :: observe
        procedure :: write_row
    end type writer_t

contains

    !> Computes a trajectory and writes its table. A motion that fails has the rows up to the failure;
    !> `status` is the reason of its end.
    subroutine run_trajectory(job, options, summary, status, error)
        type(job_t), intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(writer_t) :: writer
        type(event_recorder_t), allocatable :: watch
        type(outcome_t) :: outcome
        real(dp), allocatable :: times(:)
        real(dp) :: began, elapsed

        status = status_ok
        call take_times(job, times, error)
        if (allocated(error)) return
        call begin_tables(job, options, writer, watch, error)
        if (allocated(error)) return
        began = seconds()
        call compute_motion(job, times, writer, outcome, watch)
        elapsed = seconds() - began
        status = outcome%status
        call finish_tables(job, outcome, writer, watch, error)
        if (allocated(error)) return
        call describe_run(job, writer%rows, outcome, elapsed, watch, summary)
        if (writer%columns%proof_summary() /= '') call summary%add('proof', writer%columns%proof_summary())
        call writer%columns%close()
    end subroutine run_trajectory

    !> Begins the table of the motion, and that of its events if there is to be one. `watch` looks for the events; it
    !> is not allocated where there are none to look for. After an error there is no table.
    subroutine begin_tables(job, options, writer, watch, error)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        type(writer_t), intent(inout) :: writer
        type(event_recorder_t), allocatable, intent(out) :: watch
        type(error_t), allocatable, intent(out) :: error

        writer%t_end = job%case%t_end
        writer%total = job%plan%samples
        call chosen_columns(job, writer%chosen)
        associate (columns => writer%chosen)
            writer%counts_turns = any(columns%name == 'phi' .or. columns%name == 'psi')
            writer%wants_work = any(columns%needs_work)
            call writer%progress%start(job%name, 'rows', writer%total, options%quiet, options%progress)
            call writer%columns%set(columns, job%case, job%scene)
            call writer%table%describe(job, columns)
            call writer%table%create(error)
            if (allocated(error)) return
            if (size(job%events) > 0) then
                allocate (watch)
                call watch%set(job%events, job%stop_after, job%case)
            end if
            if (job%event_output == '') return
            call watch%open_table(job%event_output, study_head(job, [event_columns, columns%column_t]), columns, &
                                  job%case, job%scene, error)
        end associate
        if (allocated(error)) call writer%table%discard()
    end subroutine begin_tables

    !> The columns of the table.
    subroutine chosen_columns(job, chosen)
        type(job_t), intent(in) :: job
        type(trajectory_column_t), allocatable, intent(out) :: chosen(:)
        type(trajectory_column_t), allocatable :: known(:)
        allocate (known, source=trajectory_columns())
        allocate (chosen, source=known(job%columns))
    end subroutine chosen_columns

    !> Computes the motion, in closed form or step by step, up to the event that ends it.
    subroutine compute_motion(job, times, writer, outcome, watch)
        type(job_t), intent(inout) :: job
        real(dp), intent(inout) :: times(:) !! times of the rows
        type(writer_t), intent(inout) :: writer
        type(outcome_t), intent(out) :: outcome
        type(event_recorder_t), allocatable, intent(inout) :: watch

        associate (case => job%case, plan => job%plan)
            if (plan%exact) then
                call sample_exactly(case, plan, writer, outcome, watch)
            else
                call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, &
                               times, writer, outcome, watch)
                if (allocated(watch)) then
                    if (watch%ended_by > 0 .and. plan%is_adaptive()) call compute_again(job, times, writer, outcome)
                end if
            end if
        end associate
        call check_values(writer, outcome)
        call writer%progress%finish()
    end subroutine compute_motion

    !> Finishes the tables with a line on how the motion ended; after an error they are discarded.
    subroutine finish_tables(job, outcome, writer, watch, error)
        type(job_t), intent(in) :: job
        type(outcome_t), intent(in) :: outcome
        type(writer_t), intent(inout) :: writer
        type(event_recorder_t), allocatable, intent(inout) :: watch
        type(error_t), allocatable, intent(out) :: error
        type(string_t) :: trailer(1)

        if (allocated(writer%error)) then
            call move_alloc(writer%error, error)
        else
            trailer(1)%text = 'status: ' // ending_of(outcome)
            if (job%event_output /= '') call watch%close_table(trailer, error)
            if (.not. allocated(error)) call writer%table%finish(ending_of(outcome), error)
        end if
        if (.not. allocated(error)) return
        if (allocated(watch)) call watch%discard_table()
        call writer%table%discard()
    end subroutine finish_tables

    !> The summary: plan, motion, events, cost, and how the motion ended.
    subroutine describe_run(job, rows, outcome, elapsed, watch, summary)
        type(job_t), intent(in) :: job
        integer, intent(in) :: rows
        type(outcome_t), intent(in) :: outcome
        real(dp), intent(in) :: elapsed !! seconds that the motion took
        type(event_recorder_t), allocatable, intent(in) :: watch
        type(summary_t), intent(inout) :: summary
        real(dp) :: setup, sample

        call summary%headline(job%input // ': trajectory of ' // to_text(rows) // ' rows -> ' // job%output)
        call summary%describe_plan(job%plan)
        call summary%describe_motion(job%case)
        if (job%event_output /= '') then
            call summary%add('events', to_text(watch%rows) // ' -> ' // job%event_output)
        end if
        if (job%plan%exact) then
            call measure_exact_cost(job%case, setup, sample)
            call summary%add('cost', rounded(1.0e6_dp * setup) // ' us for the set-up, ' &
                             // rounded(1.0e6_dp * sample) // ' us per sample')
        else
            call summary%describe_cost(outcome%counts, job%plan%stepper%info%refine)
        end if
        call summary%add('time', rounded(elapsed) // ' s for ' // decimal(outcome%t) // ' s of motion')
        associate (status => outcome%status)
            call summary%add('status', status_name(status) // ' at t = ' // to_text(end_time(outcome)) // ': ' &
                             // status_meaning(status))
            if (job%scene%stop_at /= '' .and. is_good_end(status)) call summary%add('end', what_ended(job, watch))
        end associate
    end subroutine describe_run

    !> The times of the rows; none for the exact solution, which computes them one by one.
    subroutine take_times(job, times, error)
        type(job_t), intent(in) :: job
        real(dp), allocatable, intent(out) :: times(:)
        type(error_t), allocatable, intent(out) :: error
        integer :: i, status

        allocate (times(merge(0, job%plan%samples, job%plan%exact)), stat=status)
        if (status /= 0) then
            error = error_t(exit_internal, escaped(job%input) // ': not enough memory for the times of ' &
                            // to_text(job%plan%samples) // ' rows; use fewer span.samples')
            return
        end if
        do i = 1, size(times)
            times(i) = sample_time(job%case%t_end, size(times), i)
        end do
    end subroutine take_times

    !> Computes a motion that an event ended once more, in the same steps, up to there: its rows are spread
    !> over what was run, and the last is the motion at the event. Both computations share the work of the case.
    subroutine compute_again(job, times, writer, outcome)
        type(job_t), intent(inout) :: job
        real(dp), intent(inout) :: times(:) !! instants of the rows
        type(writer_t), intent(inout) :: writer
        type(outcome_t), intent(inout) :: outcome
        type(outcome_t) :: first
        integer :: i

        if (writer%has_enough) return
        first = outcome
        call writer%table%discard()
        call writer%table%create(writer%error)
        if (allocated(writer%error)) return
        writer%rows = 0
        call writer%columns%set(writer%chosen, job%case, job%scene)
        do i = 1, size(times)
            times(i) = sample_time(first%t, size(times), i)
        end do
        associate (case => job%case, plan => job%plan, max_steps => job%plan%stepper%controls%max_steps)
            writer%t_stop = first%t
            max_steps = max_steps - first%counts%work()
            call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, &
                           times, writer, outcome)
            max_steps = max_steps + first%counts%work()
        end associate
        if (is_good_end(outcome%status)) then
            outcome%status = first%status
            outcome%t = first%t
        end if
        call outcome%counts%add(first%counts)
    end subroutine compute_again

    !> Sets the status of a motion with undefined values.
    subroutine check_values(writer, outcome)
        type(writer_t), intent(in) :: writer
        type(outcome_t), intent(inout) :: outcome
        if (.not. writer%is_undefined) return
        outcome%status = status_non_finite
        outcome%t = writer%t_undefined
    end subroutine check_values

    !> Description of the event that ended the motion.
    function what_ended(job, watch) result(text)
        type(job_t), intent(in) :: job
        type(event_recorder_t), intent(in) :: watch
        character(:), allocatable :: text
        if (watch%ended_by > 0) then
            text = trim(watch%events(watch%ended_by)%name) // ' (stop_at)'
        else
            text = 'not at an event: ''' // trim(job%scene%stop_at) // ''' occurred fewer than ' &
                   // to_text(job%stop_after) // ' times in the span'
            if (job%stop_after == 1) text = 'not at an event: ''' // trim(job%scene%stop_at) &
                // ''' did not occur in the span'
        end if
    end function what_ended

    !> The exact solution at equally spaced times, up to the event that ends the motion.
    subroutine sample_exactly(case, plan, writer, outcome, watch)
        type(case_t), intent(in) :: case
        type(plan_t), intent(in) :: plan
        type(writer_t), intent(inout) :: writer
        type(outcome_t), intent(out) :: outcome
        type(event_recorder_t), intent(inout), optional :: watch
        type(exact_path_t) :: path
        type(motion_t) :: motion
        real(dp) :: t_end, t_known, t
        integer :: i

        call path%begin(case, looks_per_step * plan%max_steps, outcome%status)
        if (outcome%status /= status_ok) return
        t_end = case%t_end
        t_known = t_end
        if (present(watch)) then
            call watch%begin(case%body, path%exact%at(0.0_dp))
            call watch%look(path, t_end)
            t_known = watch%t
            if (watch%has_enough) then
                t_end = watch%t
            else if (watch%t < t_end) then
                outcome%status = merge(status_too_many_events, status_step_limit, watch%is_full)
            end if
        end if
        ! The rows have a budget of their own.
        call path%restart(case, looks_per_step * plan%max_steps + plan%samples)
        path%counts_turns = writer%counts_turns
        do i = 1, plan%samples
            t = sample_time(t_end, plan%samples, i)
            if (outcome%status /= status_ok .and. t > t_known) exit
            call path%at(t, motion)
            if (path%is_spent()) then
                outcome%status = status_step_limit
                t_known = outcome%t
                exit
            end if
            call writer%write_row(motion)
            if (writer%has_enough) exit
            outcome%t = t
        end do
        if (outcome%status /= status_ok) outcome%t = t_known
    end subroutine sample_exactly

    !> How a motion ended, and when if it is not complete.
    function ending_of(outcome) result(text)
        type(outcome_t), intent(in) :: outcome
        character(:), allocatable :: text
        text = status_name(outcome%status)
        if (outcome%status /= status_ok) text = text // ' at t = ' // to_text(end_time(outcome))
    end function ending_of

    !> The time of the end of a motion: that at which it came to rest, s.
    pure real(dp) function end_time(outcome)
        type(outcome_t), intent(in) :: outcome
        end_time = outcome%t
        if (outcome%status == status_at_rest) end_time = outcome%t_stuck
    end function end_time

    !> Writes the row of a state of a formulation.
    subroutine observe(self, formulation, t, y, near)
        class(writer_t), intent(inout) :: self
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: t, y(max_states), near(3)
        call self%write_row(formulation%motion(t, y, near))
    end subroutine observe

    !> Writes the row of a motion.
    subroutine write_row(self, motion)
        class(writer_t), intent(inout) :: self
        type(motion_t), intent(in) :: motion
        if (self%has_enough) return
        associate (values => self%columns%row(motion, self%rows == 0, self%work))
            self%is_undefined = .not. self%columns%is_defined(values)
            self%t_undefined = motion%t
            self%has_enough = self%is_undefined
            if (self%is_undefined) return
            self%rows = self%rows + 1
            call self%table%add_row(values, self%error)
        end associate
        self%has_enough = allocated(self%error) .or. motion%t >= self%t_stop
        call self%progress%update(int(motion%t / self%t_end * self%total, int64))
    end subroutine write_row

end module spintop_trajectory
