!> One top for C: an opaque object made from an input, its motion at any times with derivatives, and its events.
!> `include/spintop.h` describes the functions. An object does not change after it was made, so threads may share it; those
!> that ask for the motion do not wait for each other.
module spintop_c_top
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, c_null_ptr, &
        c_ptr, c_size_t
    use spintop_arithmetic, only: default_arithmetic_t
    use spintop_c_error, only: c_text_t, describe_status, hand_error, hand_status, is_empty, is_wrong, &
        longest_message, read_c_text
    use spintop_c_result, only: c_column_t, described_column_t, hand_result
    use spintop_case, only: case_t
    use spintop_compare, only: is_finite
    use spintop_loaded_table, only: data_table_t
    use spintop_differences, only: node_count, nodes_t
    use spintop_errors, only: error_t, input_error
    use spintop_exit_codes, only: exit_input, exit_ok
    use spintop_event_recorder, only: event_columns, event_recorder_t
    use spintop_execution, only: memory_run_t
    use spintop_integration, only: outcome_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, no_number
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_options, only: options_t
    use spintop_plan, only: plan_t
    use spintop_preparation, only: prepare_job, prepared_t
    use spintop_scene_keys, only: scene_t
    use spintop_scene_words, only: kind_trajectory, study_kinds
    use spintop_sensitivity, only: other_accuracies, sensitive_key_t, sensitivities_t, varied_motions_t
    use spintop_status, only: code_of, is_good_end, is_ok, status_bad_samples, status_non_finite, status_ok
    use spintop_stepper, only: looks_per_step
    use spintop_study_column, only: study_column_t
    use spintop_table_column, only: column_t
    use spintop_text, only: escaped
    use spintop_trajectory_columns, only: row_maker_t
    implicit none
    private

    !> A motion, and the columns for which it is asked.
    type :: asked_motion_t
        !> Number of the columns.
        integer :: columns = 0
        type(case_t), private :: case
        type(plan_t), private :: plan
        !> Makes the rows; each call uses a copy.
        type(writer_t), private :: writer
        !> Why there is no exact motion, if there is none.
        integer, private :: status = status_ok
    contains
        procedure :: prepare => prepare_asked
        procedure :: find => find_asked
    end type asked_motion_t

    !> The motions with other values of a key (column 0), and the same with other accuracies. A class is copied and freed by a
    !> procedure of its own; for a type gfortran writes out all that is in it at each place.
    type :: varied_key_t
        class(asked_motion_t), allocatable :: motion(:, :)
        logical :: exists(node_count, 0:other_accuracies) = .false.
    end type varied_key_t

    !> The motions with other values of all keys, and the times for which they are asked, s.
    type, extends(varied_motions_t) :: asked_motions_t
        type(varied_key_t), pointer :: keys(:) => null()
        real(dp), allocatable :: t(:)
    contains
        procedure :: find => find_varied
    end type asked_motions_t

    !> The derivatives, two columns for each: `count` of them, of some columns with respect to some keys.
    type :: asked_derivatives_t
        integer :: count = 0
        type(sensitivities_t), private :: wanted
        type(nodes_t), allocatable, private :: nodes(:)
        type(varied_key_t), allocatable, private :: keys(:)
    contains
        procedure :: prepare
        procedure :: find
    end type asked_derivatives_t

    !> A top: its motion, the columns of that, and the derivatives of some. Classes are quicker to compile: see `varied_key_t`.
    type :: top_t
        class(asked_motion_t), allocatable :: motion
        type(asked_derivatives_t) :: derivatives
        type(described_column_t), allocatable :: described(:)
        type(c_column_t), allocatable :: columns(:)
        !> Warnings of the input.
        type(c_text_t) :: warnings
        !> The input, if it has events; and the columns of their table.
        class(prepared_t), allocatable :: prepared
        type(study_column_t), allocatable :: chosen(:)
    end type top_t

    !> A time asked of a fixed-step method within this fraction of a step is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp
    !> Most times of a call.
    integer(c_size_t), parameter :: most_times = huge(1_c_int)
    character(*), parameter :: small_memory = 'the memory is too small for so many times'
    !> The text ''.
    character(c_char), target :: no_text = c_null_char

contains

    !> Makes a top.
    type(c_ptr) function make_top(input, name, error) bind(C, name='spintop_top_new') result(handle)
        type(c_ptr), value :: input, name !! the input of a trajectory, and its name in messages; a null name is `input`
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(top_t), pointer :: top
        type(error_t), allocatable :: problem

        call arithmetic%begin()
        handle = c_null_ptr
        if (is_wrong(.not. c_associated(input), 'the input is a null pointer', error)) return
        if (is_wrong(is_empty(name), 'the name of the input is empty', error)) return
        allocate (top)
        allocate (top%motion)
        !$omp critical (library)
        call prepare_top(input, name, top, problem)
        if (allocated(problem)) call hand_error(problem, error)
        !$omp end critical (library)
        if (allocated(problem)) then
            deallocate (top)
        else
            handle = c_loc(top)
        end if
    end function make_top

    subroutine prepare_top(input, name, top, error)
        type(c_ptr), intent(in) :: input, name
        type(top_t), target, intent(inout) :: top
        type(error_t), allocatable, intent(out) :: error
        type(prepared_t), allocatable, target :: prepared
        type(column_t), allocatable :: shown(:)
        type(options_t) :: options
        character(:), allocatable :: text, name_of_text
        integer :: i

        call read_c_text(input, text)
        call read_c_text(name, name_of_text)
        if (name_of_text == '') name_of_text = 'input'
        options%output = ''
        allocate (options%overrides(0), prepared)
        call prepare_job(name_of_text, options, prepared%job, prepared%study, error, text)
        if (allocated(error)) return
        associate (job => prepared%job)
            if (job%input%scene%kind /= study_kinds(kind_trajectory)) then
                error = input_error(name_of_text // ': the input of a top is that of a trajectory')
                return
            end if
            call top%warnings%set(job%warnings)
            top%chosen = job%columns
            ! The motion itself is also asked for the columns of which there are derivatives.
            call top%derivatives%prepare(job, error)
            if (allocated(error)) return
            call top%motion%prepare(job%case, job%plan, [top%chosen, &
                                    job%sensitivities%columns()])
            allocate (shown, source=[top%chosen%column_t, job%sensitivities%table_columns()])
        end associate
        allocate (top%described(size(shown)), top%columns(size(shown)))
        do i = 1, size(shown)
            call top%described(i)%describe(shown(i), top%columns(i))
        end do
        if (size(prepared%job%events) > 0) call move_alloc(prepared, top%prepared)
    end subroutine prepare_top

    !> Number of columns of a top.
    integer(c_int) function count_columns(handle) bind(C, name='spintop_top_column_count') result(columns)
        type(c_ptr), value :: handle !! the top; a null pointer has no columns
        type(top_t), pointer :: top
        columns = 0
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        columns = size(top%columns)
    end function count_columns

    !> The columns of a top.
    type(c_ptr) function list_columns(handle) bind(C, name='spintop_top_columns') result(columns)
        type(c_ptr), value :: handle !! the top; a null pointer has no columns
        type(top_t), pointer :: top
        columns = c_null_ptr
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        columns = c_loc(top%columns)
    end function list_columns

    !> Warnings of the input of a top.
    type(c_ptr) function top_warnings(handle) bind(C, name='spintop_top_warnings') result(warnings)
        type(c_ptr), value :: handle !! the top; a null pointer has no warnings
        type(top_t), pointer :: top
        warnings = c_loc(no_text)
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        warnings = top%warnings%at()
    end function top_warnings

    !> Finds the motion of a top at some times, column by column.
    integer(c_int) function find_motion(handle, n, t, cells, error) bind(C, name='spintop_top_at') result(code)
        type(c_ptr), value :: handle !! the top
        integer(c_size_t), value :: n !! number of times
        type(c_ptr), value :: t, cells !! the times, s; the values of the first column, of the second, and so on
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(top_t), pointer :: top
        real(c_double), pointer, contiguous :: times(:), found(:, :)
        real(dp), allocatable :: values(:, :)
        real(dp) :: t_reached
        logical :: lacks_memory
        integer :: status

        call arithmetic%begin()
        code = exit_input
        if (is_wrong(.not. c_associated(handle), 'the top is a null pointer', error)) return
        code = exit_ok
        if (n == 0) return
        code = exit_input
        ! A size_t beyond the range of Fortran's integers is negative here.
        if (is_wrong(n < 0 .or. n > most_times, 'there are more than 2147483647 times', error)) return
        if (is_wrong(.not. c_associated(t), 'the array of times is a null pointer', error)) return
        if (is_wrong(.not. c_associated(cells), 'the array of cells is a null pointer', error)) return
        call c_f_pointer(handle, top)
        call c_f_pointer(t, times, [n])
        call c_f_pointer(cells, found, [n, size(top%columns, kind=c_size_t)])
        allocate (values(top%motion%columns, n), stat=status)
        if (is_wrong(status /= 0, small_memory, error)) return
        call top%motion%find(times, values, status, t_reached)
        associate (own => size(top%chosen))
            found(:, :own) = transpose(values(:own, :))
            if (top%derivatives%count > 0) then
                call top%derivatives%find(times, values(own + 1:, :), found(:, own + 1:), lacks_memory)
                if (is_wrong(lacks_memory, small_memory, error)) return
            end if
        end associate
        code = hand_status(status, t_reached, error)
    end function find_motion

    !> Finds the events of a top in the span of its input.
    type(c_ptr) function find_events(handle, error) bind(C, name='spintop_top_events') result(found)
        type(c_ptr), value :: handle !! the top
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(top_t), pointer :: top
        type(memory_run_t) :: run

        call arithmetic%begin()
        found = c_null_ptr
        if (is_wrong(.not. c_associated(handle), 'the top is a null pointer', error)) return
        call c_f_pointer(handle, top)
        !$omp critical (library)
        if (allocated(top%prepared)) then
            call record_events(top, run)
            found = hand_result(run)
        else
            call hand_error(input_error('the input of the top has no events: name them in output.events'), error)
        end if
        !$omp end critical (library)
    end function find_events

    !> Computes the motion up to its end or the event that ends it. Its rows are only those at both ends.
    subroutine record_events(top, run)
        type(top_t), target, intent(in) :: top
        type(memory_run_t), intent(inout) :: run
        type(event_recorder_t), allocatable, target :: recorder
        type(writer_t) :: writer
        type(outcome_t) :: outcome
        type(plan_t) :: plan
        real(dp), allocatable :: times(:)
        character(longest_message) :: message

        associate (job => top%prepared%job)
            plan = job%plan
            plan%samples = 2
            times = [0.0_dp, job%case%t_end]
            if (plan%exact) times = times(:0)
            allocate (recorder)
            call recorder%set(job%events, job%stop_after, job%case)
            call recorder%keep_table(top%chosen, job%case, job%input%scene)
            call writer%set_columns(top%chosen, job%case, job%input%scene)
            allocate (writer%kept(size(top%chosen), plan%samples))
            call compute_motion(job%case, plan, times, writer, outcome, recorder, job%input%scene)
        end associate
        call writer%columns%close()
        call describe_status(outcome%status, outcome%end_time(), message)
        run%summary = message
        run%warnings = ''
        run%code = code_of(outcome%status)
        allocate (run%table(1))
        call make_event_table(recorder, top%chosen, run%table(1))
    end subroutine record_events

    !> Makes the table of events: their names are words.
    subroutine make_event_table(recorder, columns, table)
        type(event_recorder_t), intent(inout) :: recorder
        type(study_column_t), intent(in) :: columns(:)
        type(data_table_t), intent(inout) :: table
        type(column_t), allocatable :: shown(:)
        integer :: i

        allocate (shown, source=[event_columns, columns%column_t])
        table%name = 'events'
        table%rows = recorder%rows
        recorder%kept(1, :) = recorder%kept(1, :) - 1 ! words are counted from 0
        allocate (table%column(size(shown)))
        do i = 1, size(shown)
            table%column(i)%column_t = shown(i)
            table%column(i)%values = recorder%kept(i, :recorder%rows)
        end do
        allocate (table%column(1)%words(size(recorder%events)))
        do i = 1, size(recorder%events)
            table%column(1)%words(i)%text = trim(recorder%events(i)%name)
        end do
    end subroutine make_event_table

    !> Prepares a motion by its plan.
    subroutine prepare_asked(self, case, plan, columns)
        class(asked_motion_t), intent(inout) :: self
        type(case_t), intent(in) :: case !! body and start
        type(plan_t), intent(in) :: plan !! model and method
        type(study_column_t), intent(in) :: columns(:) !! the columns
        self%case = case
        self%plan = plan
        self%columns = size(columns)
        call self%writer%set_columns(columns, case)
        if (.not. plan%exact) return
        allocate (self%writer%path)
        call self%writer%path%begin(case, looks_per_step * plan%max_steps, self%status)
        self%writer%counts_turns = self%writer%counts_turns .or. .not. case%turn%exchanges_axes()
    end subroutine prepare_asked

    !> Finds the columns at some times; those that are not reached are NaN.
    subroutine find_asked(self, t, cells, status, t_reached)
        class(asked_motion_t), intent(in) :: self
        real(dp), intent(in) :: t(:) !! the times, s
        real(dp), intent(out) :: cells(:, :) !! a column for each time
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), intent(out) :: t_reached !! up to there the motion was found, s
        type(writer_t), allocatable :: writer
        type(outcome_t) :: outcome
        type(case_t) :: case
        type(plan_t) :: plan
        real(dp), allocatable :: times(:)

        cells = no_number
        t_reached = 0
        status = self%status
        if (.not. all(is_finite(t))) status = status_bad_samples
        if (.not. is_ok(status)) return
        if (allocated(self%writer%path)) then
            if (.not. self%writer%path%exact%has_to_follow()) then
                call find_directly(self%writer, t, cells, status, t_reached)
                return
            end if
        end if
        allocate (writer, source=self%writer)
        writer%asked = t
        allocate (writer%kept(self%columns, size(t)), source=no_number)
        case = self%case
        plan = self%plan
        times = t
        if (.not. plan%exact) then
            ! A method with fixed steps takes them over the span of the input.
            if (plan%is_adaptive()) case%t_end = t(size(t))
            if (.not. plan%is_adaptive()) writer%slack = grid_slack * case%t_end / plan%stepper%controls%steps
        end if
        call compute_motion(case, plan, times, writer, outcome)
        cells = writer%kept
        t_reached = outcome%t
        status = outcome%status
        if (is_good_end(status) .and. writer%has_missed) status = status_bad_samples
    end subroutine find_asked

    !> The same of an exact motion of which no turns have to be counted: without a copy of the writer.
    subroutine find_directly(writer, t, cells, status, t_reached)
        type(writer_t), intent(in) :: writer
        real(dp), intent(in) :: t(:)
        real(dp), intent(inout) :: cells(:, :), t_reached
        integer, intent(out) :: status
        type(row_maker_t) :: maker
        logical :: are_angles
        integer :: i

        status = status_ok
        maker = writer%columns
        are_angles = maker%wants_angles_of(writer%path%exact)
        do i = 1, size(t)
            if (are_angles) then
                call maker%find_exact_row(writer%path%exact, t(i), cells(:, i))
            else
                cells(:, i) = maker%row(writer%path%exact%at(t(i)))
            end if
            if (.not. maker%is_defined(cells(:, i))) then
                cells(:, i) = no_number
                status = status_non_finite
            end if
            t_reached = t(i)
            if (.not. is_ok(status)) return
        end do
    end subroutine find_directly

    !> Prepares the derivatives of a job.
    subroutine prepare(self, job, error)
        class(asked_derivatives_t), intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: i

        self%count = job%sensitivities%count
        if (self%count == 0) return
        self%wanted = job%sensitivities
        associate (keys => job%sensitivities%keys)
            allocate (self%nodes(size(keys)), self%keys(size(keys)))
            do i = 1, size(keys)
                call prepare_key(self%keys(i), self%nodes(i), job, keys(i), &
                                 job%sensitivities%columns(), error)
                if (allocated(error)) return
            end do
        end associate
    end subroutine prepare

    !> Prepares the motions with other values of a key. The values that no motion has are left out; there must be others.
    subroutine prepare_key(self, nodes, job, key, columns, error)
        type(varied_key_t), intent(inout) :: self
        type(nodes_t), intent(out) :: nodes
        type(job_t), target, intent(in) :: job
        type(sensitive_key_t), intent(in) :: key
        type(study_column_t), intent(in) :: columns(:)
        type(error_t), allocatable, intent(out) :: error
        integer, allocatable :: accuracy
        integer :: i, k

        if (key%name(:index(key%name, '.')) == 'span.') then
            error = input_error(escaped(job%input%path) // ': output.columns: the times of a top are given, so nothing depends &
                                &on ' // key%name // '; the derivatives with respect to time are columns, as theta_rate')
            return
        end if
        nodes = key%nodes(key%slot%get())
        allocate (self%motion(node_count, 0:other_accuracies))
        do k = 0, other_accuracies
            if (k > 0) accuracy = k ! else it is absent
            do i = merge(2, 1, k == 0), node_count
                if (nodes%is_valid(i)) call prepare_motion(self%motion(i, k), job, key, nodes%x(i), columns, &
                                                           self%exists(i, k), accuracy)
            end do
            if (k == 0) call nodes%limit_to(self%exists(:, 0) .or. [(i == 1, i=1, node_count)])
        end do
        if (any(nodes%is_valid(2:))) return
        error = input_error(escaped(job%input%path) // ': output.columns: with another ' // key%name // ' there is no motion by &
                            &this method, and so no derivative; integrate by a method and formulation for any body')
    end subroutine prepare_key

    !> Prepares the motion with another value of a key, if there is one.
    subroutine prepare_motion(motion, job, key, value, columns, exists, accuracy)
        type(asked_motion_t), intent(inout) :: motion
        type(job_t), target, intent(in) :: job
        type(sensitive_key_t), intent(in) :: key
        real(dp), intent(in) :: value
        type(study_column_t), intent(in) :: columns(:)
        logical, intent(out) :: exists
        integer, intent(in), optional :: accuracy !! the number of another accuracy
        type(scene_t), allocatable, target :: scene
        type(case_t) :: case
        type(plan_t) :: plan

        call key%plan_at(job%input%scene, value, scene, case, plan, exists, job%plan, accuracy)
        if (.not. exists) return
        case%t_end = job%case%t_end ! steps of fixed size stay where they are
        call motion%prepare(case, plan, columns)
    end subroutine prepare_motion

    !> Finds the derivatives at some times, each followed by the estimate of its error.
    subroutine find(self, t, base, cells, lacks_memory)
        class(asked_derivatives_t), target, intent(in) :: self
        real(dp), intent(in) :: t(:) !! the times, s
        real(dp), intent(in) :: base(:, :) !! the columns (rows) of which there are derivatives at each time
        real(dp), intent(out) :: cells(:, :) !! for each time, two for each derivative; NaN where there is none
        logical, intent(out) :: lacks_memory !! whether the memory is too small for so many times
        type(asked_motions_t) :: motions
        real(dp), allocatable :: found(:, :)
        integer :: status
        motions%keys => self%keys
        motions%t = t
        allocate (found(size(cells, 2), size(t)), stat=status)
        if (status == 0) call self%wanted%find_derivatives(self%nodes, motions, base, found, status)
        lacks_memory = status /= 0
        if (.not. lacks_memory) cells = transpose(found)
    end subroutine find

    !> The columns of a motion with another value of a key.
    subroutine find_varied(self, key, nodes, i, values, accuracy)
        class(asked_motions_t), intent(in) :: self
        integer, intent(in) :: key, i !! index of the key, and that of the node
        type(nodes_t), intent(in) :: nodes !! the values of the key
        real(dp), intent(inout) :: values(:, :) !! the columns (rows) at each time
        integer, intent(in), optional :: accuracy !! the number of another accuracy
        real(dp) :: t_reached
        integer :: k, status
        k = 0
        if (present(accuracy)) k = accuracy
        associate (varied => self%keys(key))
            if (varied%exists(i, k)) call varied%motion(i, k)%find(self%t, values, status, t_reached)
        end associate
    end subroutine find_varied

    !> Deletes a top.
    subroutine delete_top(handle) bind(C, name='spintop_top_delete')
        type(c_ptr), value :: handle !! the top; may be null
        type(top_t), pointer :: top
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        deallocate (top)
    end subroutine delete_top

end module spintop_c_top
