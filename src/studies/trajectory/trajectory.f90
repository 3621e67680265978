!> The trajectory study: one motion, one table.
module spintop_trajectory
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: seconds
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_case, only: case_t
    use spintop_columns, only: column_computer_t, column_t, trajectory_columns
    use spintop_errors, only: error_t, exit_internal
    use spintop_event_recorder, only: event_recorder_t, event_columns, exact_path_t
    use spintop_exact_cost, only: measure_exact_cost
    use spintop_exact_motion, only: prepare_exact_motion
    use spintop_formulation, only: formulation_t, max_states
    use spintop_integration, only: integrate, observer_t, outcome_t
    use spintop_job, only: job_t, options_t
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t, sample_time
    use spintop_progress, only: progress_t
    use spintop_parameter_print, only: print_namelist
    use spintop_provenance, only: describe_provenance, fact_count, fact_t, gather_facts
    use spintop_status, only: status_ok, status_non_finite, status_step_limit, status_name, status_meaning
    use spintop_stepper, only: looks_per_step
    use spintop_summary, only: summary_t, decimal, rounded
    use spintop_table_file, only: table_file_t
    use spintop_table_head, only: table_head
    use spintop_text, only: to_text, string_t
    implicit none
    private
    public :: run_trajectory

    !> Writes a row for each motion it is shown.
    type, extends(observer_t) :: writer_t
        type(column_computer_t) :: columns
        type(table_file_t) :: file
        type(progress_t) :: progress
        real(dp) :: t_end = 0
        !> No row is wanted after this time, s.
        real(dp) :: t_stop = huge(1.0_dp)
        !> Rows of the whole table.
        integer(int64) :: total = 0
        integer :: rows = 0
        !> A motion had a value that overflowed or is not a number, and when, s.
        logical :: is_undefined = .false.
        real(dp) :: t_undefined = 0
        type(error_t), allocatable :: error
    contains
        procedure :: observe
        procedure :: write_row
    end type writer_t

contains

    !> Computes a trajectory and writes its table. A motion that fails on the way has its rows so
    !> far; `status` says how it ended.
    subroutine run_trajectory(job, options, summary, status, error)
        type(job_t), intent(inout) :: job
        type(options_t), intent(in) :: options
        type(summary_t), intent(out) :: summary
        integer, intent(out) :: status
        type(error_t), allocatable, intent(out) :: error
        type(writer_t) :: writer
        type(event_recorder_t), allocatable :: watch
        type(outcome_t) :: outcome
        type(string_t), allocatable :: input(:), header(:)
        type(string_t) :: trailer(1)
        real(dp), allocatable :: times(:)
        character(:), allocatable :: head
        real(dp) :: began, elapsed, setup, sample

        status = status_ok
        call take_times(job, times, error)
        if (allocated(error)) return
        associate (case => job%case, plan => job%plan)
            writer%t_end = case%t_end
            writer%total = plan%samples
            writer%counts_turns = any(trajectory_columns(job%columns)%name == 'phi' &
                                      .or. trajectory_columns(job%columns)%name == 'psi')
            call writer%progress%start(job%name, 'rows', writer%total, options%quiet, options%progress)
            call writer%columns%set(job%columns, case)
            associate (columns => trajectory_columns(job%columns))
                call print_namelist(job%table, input)
                call describe_table(job, input, columns, header)
                head = table_head(header, columns%name)
                call writer%file%create(job%output, head, error)
                if (allocated(error)) return
                if (size(job%events) > 0) then
                    allocate (watch)
                    call watch%set(job%events, job%stop_after, case)
                end if
                if (job%event_output /= '') then
                    call describe_table(job, input, [event_columns, columns], header)
                    call watch%open_table(job%event_output, &
                        table_head(header, [character(20) :: event_columns%name, columns%name]), &
                        job%columns, case, error)
                end if
            end associate
            if (allocated(error)) then
                call writer%file%discard()
                return
            end if

            began = seconds()
            if (plan%exact) then
                call sample_exactly(case, plan, writer, outcome, watch)
            else
                call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, &
                               times, writer, outcome, watch)
                if (allocated(watch)) then
                    if (watch%ended_by > 0 .and. plan%is_adaptive()) call compute_again(job, head, times, writer, outcome)
                end if
            end if
            call check_values(writer, outcome)
            elapsed = seconds() - began
            call writer%progress%finish()
            status = outcome%status
            if (allocated(writer%error)) then
                call move_alloc(writer%error, error)
            else
                trailer(1)%text = status_line(outcome)
                if (job%event_output /= '') call watch%close_table(trailer, error)
                if (.not. allocated(error)) call writer%file%finish(trailer, error)
            end if
            if (allocated(error)) then
                if (allocated(watch)) call watch%discard_table()
                call writer%file%discard()
                return
            end if

            call summary%headline(job%input // ': trajectory of ' // to_text(writer%rows) // ' rows -> ' // job%output)
            call summary%describe_plan(plan)
            call summary%describe_motion(case)
            if (job%event_output /= '') then
                call summary%add('events', to_text(watch%rows) // ' -> ' // job%event_output)
            end if
            if (plan%exact) then
                call measure_exact_cost(case, setup, sample)
                call summary%add('cost', rounded(1.0e6_dp * setup) // ' us for the set-up, ' &
                                 // rounded(1.0e6_dp * sample) // ' us a sample')
            else
                call summary%describe_cost(outcome%counts, plan%stepper%info%refine)
            end if
            call summary%add('time', rounded(elapsed) // ' s for ' // decimal(outcome%t) // ' s of motion')
            call summary%add('status', status_name(status) // ' at t = ' // to_text(outcome%t) // ': ' &
                             // status_meaning(status))
            if (job%scene%stop_at /= '' .and. status == status_ok) call summary%add('end', what_ended(job, watch))
        end associate
    end subroutine run_trajectory

    !> The instants of the rows; none where the exact motion is sampled, which takes them as they come.
    subroutine take_times(job, times, error)
        type(job_t), intent(in) :: job
        real(dp), allocatable, intent(out) :: times(:)
        type(error_t), allocatable, intent(out) :: error
        integer :: i, status

        allocate (times(merge(0, job%plan%samples, job%plan%exact)), stat=status)
        if (status /= 0) then
            error = error_t(exit_internal, job%input // ': there is no memory for the instants of ' &
                            // to_text(job%plan%samples) // ' rows; take fewer span.samples')
            return
        end if
        do i = 1, size(times)
            times(i) = sample_time(job%case%t_end, size(times), i)
        end do
    end subroutine take_times

    !> Computes a motion that an event ended once more, in the same steps, up to there: its rows are spread
    !> over what was run, and the last is the motion at the event.
    subroutine compute_again(job, head, times, writer, outcome)
        type(job_t), intent(inout) :: job
        character(*), intent(in) :: head
        real(dp), intent(inout) :: times(:) !! instants of the rows
        type(writer_t), intent(inout) :: writer
        type(outcome_t), intent(inout) :: outcome
        type(outcome_t) :: first
        integer :: i

        if (writer%has_enough) return
        first = outcome
        call writer%file%discard()
        call writer%file%create(job%output, head, writer%error)
        if (allocated(writer%error)) return
        writer%rows = 0
        call writer%columns%set(job%columns, job%case)
        do i = 1, size(times)
            times(i) = sample_time(first%t, size(times), i)
        end do
        associate (case => job%case, plan => job%plan)
            writer%t_stop = first%t
            call integrate(plan%formulation, plan%stepper, case%body, case%start, case%t_end, &
                           times, writer, outcome)
        end associate
        if (outcome%status == status_ok) outcome%t = first%t
        call outcome%counts%add(first%counts)
    end subroutine compute_again

    !> A motion is not well that has values which are none.
    subroutine check_values(writer, outcome)
        type(writer_t), intent(in) :: writer
        type(outcome_t), intent(inout) :: outcome
        if (.not. writer%is_undefined) return
        outcome%status = status_non_finite
        outcome%t = writer%t_undefined
    end subroutine check_values

    !> The head of a table with these columns, made from this resolved input.
    subroutine describe_table(job, input, columns, header)
        type(job_t), intent(in) :: job
        type(string_t), intent(in) :: input(:)
        type(column_t), intent(in) :: columns(:)
        type(string_t), allocatable, intent(out) :: header(:)
        type(fact_t) :: facts(fact_count)

        call gather_facts(job%scene%title, job%plan%model, job%plan%method, dated=.true., facts=facts, &
                          body=body_in_words(job%case%given_body))
        call describe_provenance(facts, input, columns%name, columns%unit, columns%what, header)
    end subroutine describe_table

    !> The mass properties of a body, in its own axes as they were given.
    function body_in_words(body) result(text)
        type(body_t), intent(in) :: body
        character(:), allocatable :: text
        text = 'mass ' // to_text(body%mass) // ' kg; inertia ' // listed(body%inertia) // &
               ' kg m^2 about the pivot; centre of mass ' // listed(body%centre_of_mass) // ' m'

    contains

        function listed(x) result(list)
            real(dp), intent(in) :: x(3)
            character(:), allocatable :: list
            list = to_text(x(1)) // ', ' // to_text(x(2)) // ', ' // to_text(x(3))
        end function listed

    end function body_in_words

    !> Whether it was an event that ended the motion.
    function what_ended(job, watch) result(text)
        type(job_t), intent(in) :: job
        type(event_recorder_t), intent(in) :: watch
        character(:), allocatable :: text
        if (watch%ended_by > 0) then
            text = trim(watch%events(watch%ended_by)%name) // ', as stop_at asks'
        else
            text = 'not at an event: ''' // trim(job%scene%stop_at) // ''' came less than ' &
                   // to_text(job%stop_after) // ' times in the span'
            if (job%stop_after == 1) text = 'not at an event: ''' // trim(job%scene%stop_at) &
                // ''' did not come in the span'
        end if
    end function what_ended

    !> The exact motion at equally spaced times, up to the event that ends it.
    subroutine sample_exactly(case, plan, writer, outcome, watch)
        type(case_t), intent(in) :: case
        type(plan_t), intent(in) :: plan
        type(writer_t), intent(inout) :: writer
        type(outcome_t), intent(out) :: outcome
        type(event_recorder_t), intent(inout), optional :: watch
        type(exact_path_t) :: path
        real(dp) :: t_end, t_known, t
        integer :: i

        associate (exact => path%exact)
            call prepare_exact_motion(case%body, case%start, exact, outcome%status)
            if (outcome%status /= status_ok) return
            t_end = case%t_end
            t_known = t_end
            if (present(watch)) then
                path%most_looks = looks_per_step * plan%max_steps
                call watch%begin(case%body, exact%at(0.0_dp))
                call watch%look(path, t_end)
                t_known = watch%t
                if (watch%has_enough) then
                    t_end = watch%t
                else if (watch%t < t_end) then
                    outcome%status = status_step_limit
                end if
            end if
            do i = 1, plan%samples
                t = sample_time(t_end, plan%samples, i)
                if (outcome%status == status_step_limit .and. t > t_known) exit
                call writer%write_row(exact%at(t))
                if (writer%has_enough) exit
                outcome%t = t
            end do
            if (outcome%status == status_step_limit) outcome%t = t_known
        end associate
    end subroutine sample_exactly

    !> Last line of a trajectory table.
    function status_line(outcome) result(line)
        type(outcome_t), intent(in) :: outcome
        character(:), allocatable :: line
        line = 'status: ' // status_name(outcome%status)
        if (outcome%status /= status_ok) line = line // ' at t = ' // to_text(outcome%t)
    end function status_line

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
        associate (values => self%columns%row(motion, is_start=self%rows == 0))
            self%is_undefined = .not. self%columns%is_defined(values)
            self%t_undefined = motion%t
            self%has_enough = self%is_undefined
            if (self%is_undefined) return
            self%rows = self%rows + 1
            call self%file%add_row(values, self%error)
        end associate
        self%has_enough = allocated(self%error) .or. motion%t >= self%t_stop
        call self%progress%update(int(motion%t / self%t_end * self%total, int64))
    end subroutine write_row

end module spintop_trajectory
