!> One top for C: an opaque object made from an input, its motion at any times with derivatives, and its events.
!> `include/spintop.h` describes the functions. An object does not change after it was made, so threads may share it; those
!> that ask for the motion do not wait for each other.
module spintop_c_top
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, &
        c_null_ptr, c_ptr, c_size_t
    use spintop_c_error, only: describe_status, failed, hand_status, longest_message, read_input, refuse
    use spintop_c_result, only: columns_t, hand_result
    use spintop_caller, only: default_arithmetic_t
    use spintop_case, only: case_t
    use spintop_differences, only: node_count, nodes_t
    use spintop_errors, only: error_t, exit_input, exit_ok, input_error
    use spintop_event_recorder, only: event_columns, event_recorder_t
    use spintop_execution, only: memory_run_t
    use spintop_integration, only: outcome_t
    use spintop_job, only: job_t
    use spintop_kinds, only: dp, is_finite, no_number
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_study, only: options_t
    use spintop_planning, only: plan_t
    use spintop_preparation, only: prepare_job, prepared_t
    use spintop_scene_keys, only: scene_t, kind_trajectory, study_kinds
    use spintop_sensitivity, only: other_accuracies, sensitive_key_t, sensitivities_t, varied_motions_t
    use spintop_status, only: code_of, is_good_end, is_ok, status_bad_samples, status_non_finite, status_ok
    use spintop_stepper, only: looks_per_step
    use spintop_study_column, only: study_column_t
    use spintop_text, only: escaped, strings_of
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

    !> A top: its motion, and the columns of that; and the derivatives of some with respect to some keys, two columns for each.
    !> Classes are quicker to compile: see `varied_key_t`.
    type :: top_t
        class(asked_motion_t), allocatable :: motion
        type(study_column_t), allocatable :: chosen(:)
        type(sensitivities_t) :: derivatives
        type(nodes_t), allocatable :: nodes(:)
        type(varied_key_t), allocatable :: keys(:)
        !> All columns.
        type(columns_t) :: columns
        !> Warnings of the input; and the input, if it has events.
        character(:), allocatable :: warnings
        class(prepared_t), allocatable :: prepared
    end type top_t

    !> A time asked of a fixed-step method within this fraction of a step is at the step.
    real(dp), parameter :: grid_slack = 1.0e-6_dp
    !> Most times of a call.
    integer(c_size_t), parameter :: most_times = huge(1_c_int)
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
        character(:), allocatable :: text, name_of_text

        call arithmetic%begin()
        allocate (top)
        handle = c_loc(top)
        !$omp critical (library)
        call read_input(input, name, text, name_of_text, problem)
        if (.not. allocated(problem)) call prepare_top(text, name_of_text, top, problem)
        if (failed(problem, error)) then
            deallocate (top)
            handle = c_null_ptr
        end if
        !$omp end critical (library)
    end function make_top

    subroutine prepare_top(text, name, top, error)
        character(*), intent(in) :: text, name
        type(top_t), target, intent(inout) :: top
        type(error_t), allocatable, intent(out) :: error
        type(prepared_t), allocatable, target :: prepared
        type(options_t) :: options
        integer :: i

        options%output = ''
        allocate (options%overrides(0), prepared, top%motion)
        call prepare_job(name, options, prepared%job, prepared%study, error, text)
        if (allocated(error)) return
        associate (job => prepared%job)
            if (job%input%scene%kind /= study_kinds(kind_trajectory)) then
                error = input_error(name // ': the input of a top is that of a trajectory')
                return
            end if
            top%warnings = trim(job%warnings) // c_null_char
            top%chosen = job%columns
            top%derivatives = job%sensitivities
            if (.not. allocated(job%sensitivities%keys)) allocate (job%sensitivities%keys(0))
            allocate (top%nodes(size(job%sensitivities%keys)), top%keys(size(job%sensitivities%keys)))
            do i = 1, size(top%keys)
                call prepare_key(top%keys(i), top%nodes(i), job, job%sensitivities%keys(i), job%sensitivities%columns(), error)
                if (allocated(error)) return
            end do
            ! The motion itself is also asked for the columns of which there are derivatives.
            call top%motion%prepare(job%case, job%plan, [top%chosen, job%sensitivities%columns()])
            call top%columns%describe([top%chosen%column_t, job%sensitivities%table_columns()])
            if (size(job%events) == 0) return
        end associate
        call move_alloc(prepared, top%prepared)
    end subroutine prepare_top

    !> Number of columns of a top.
    integer(c_int) function count_columns(handle) bind(C, name='spintop_top_column_count') result(columns)
        type(c_ptr), value :: handle !! the top; a null pointer has no columns
        type(top_t), pointer :: top
        columns = 0
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        columns = size(top%columns%face)
    end function count_columns

    !> The columns of a top.
    type(c_ptr) function list_columns(handle) bind(C, name='spintop_top_columns') result(columns)
        type(c_ptr), value :: handle !! the top; a null pointer has no columns
        type(top_t), pointer :: top
        columns = c_null_ptr
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        columns = c_loc(top%columns%face)
    end function list_columns

    !> Warnings of the input of a top.
    type(c_ptr) function top_warnings(handle) bind(C, name='spintop_top_warnings') result(warnings)
        type(c_ptr), value :: handle !! the top; a null pointer has no warnings
        type(top_t), pointer :: top
        warnings = c_loc(no_text)
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        warnings = c_loc(top%warnings)
    end function top_warnings

    !> Finds the motion of a top at some times, column by column.
    integer(c_int) function find_motion(handle, n, t, cells, error) bind(C, name='spintop_top_at') result(code)
        type(c_ptr), value :: handle !! the top
        integer(c_size_t), value :: n !! number of times
        type(c_ptr), value :: t, cells !! the times, s; the values of the first column, of the second, and so on
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(error_t), allocatable :: problem
        type(top_t), pointer :: top
        type(asked_motions_t) :: motions
        real(c_double), pointer, contiguous :: times(:), found(:, :)
        real(dp), allocatable :: values(:, :), derivatives(:, :)
        real(dp) :: t_reached
        integer :: status, lacks_memory

        call arithmetic%begin()
        call refuse(.not. c_associated(handle), 'the top is a null pointer', problem)
        ! A size_t beyond the range of Fortran's integers is negative here.
        call refuse(n < 0 .or. n > most_times, 'there are more than 2147483647 times', problem)
        call refuse(n /= 0 .and. .not. c_associated(t), 'the array of times is a null pointer', problem)
        call refuse(n /= 0 .and. .not. c_associated(cells), 'the array of cells is a null pointer', problem)
        code = exit_input
        if (failed(problem, error)) return
        code = exit_ok
        if (n == 0) return
        call c_f_pointer(handle, top)
        call c_f_pointer(t, times, [n])
        call c_f_pointer(cells, found, [n, size(top%columns%face, kind=c_size_t)])
        associate (own => size(top%chosen), others => 2 * top%derivatives%count)
            allocate (values(top%motion%columns, n), stat=lacks_memory)
            if (lacks_memory == 0) allocate (derivatives(others, n), stat=lacks_memory)
            if (lacks_memory == 0) then
                call top%motion%find(times, values, status, t_reached)
                found(:, :own) = transpose(values(:own, :))
                if (others > 0) then
                    motions%keys => top%keys
                    motions%t = times
                    call top%derivatives%find_derivatives(top%nodes, motions, values(own + 1:, :), derivatives, lacks_memory)
                    found(:, own + 1:) = transpose(derivatives)
                end if
            end if
        end associate
        call refuse(lacks_memory /= 0, 'the memory is too small for so many times', problem)
        code = exit_input
        if (.not. failed(problem, error)) code = hand_status(status, t_reached, error)
    end function find_motion

    !> Finds the events of a top in the span of its input.
    type(c_ptr) function find_events(handle, error) bind(C, name='spintop_top_events') result(found)
        type(c_ptr), value :: handle !! the top
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(top_t), pointer :: top
        type(memory_run_t) :: run
        type(event_recorder_t), allocatable, target :: recorder
        type(writer_t) :: writer
        type(outcome_t) :: outcome
        type(plan_t) :: plan
        type(error_t), allocatable :: problem
        real(dp), allocatable :: times(:)
        character(longest_message) :: message
        integer :: i

        call arithmetic%begin()
        found = c_null_ptr
        call refuse(.not. c_associated(handle), 'the top is a null pointer', problem)
        if (failed(problem, error)) return
        call c_f_pointer(handle, top)
        call refuse(.not. allocated(top%prepared), 'the input of the top has no events: name them in output.events', problem)
        if (failed(problem, error)) return
        !$omp critical (library)
        ! The motion up to its end or the event that ends it. Its rows are only those at both ends.
        associate (job => top%prepared%job)
            plan = job%plan
            plan%samples = 2
            times = [0.0_dp, job%case%t_end]
            if (plan%exact) times = times(:0)
            allocate (recorder)
            call recorder%set(job%events, job%stop_after, job%case)
            call recorder%open_table(top%chosen, job%case, job%input%scene, problem)
            call writer%set_columns(top%chosen, job%case, job%input%scene)
            allocate (writer%kept(size(top%chosen), plan%samples))
            call compute_motion(job%case, plan, times, writer, outcome, recorder, job%input%scene)
        end associate
        call writer%columns%proof%close()
        call describe_status(outcome%status, outcome%end_time(), message)
        run%summary = message
        run%warnings = ''
        run%code = code_of(outcome%status)
        allocate (run%table(1))
        associate (table => run%table(1))
            table%name = 'events'
            table%rows = recorder%rows
            allocate (table%column(size(recorder%kept, 1)))
            table%column%column_t = [event_columns, top%chosen%column_t]
            do i = 1, size(table%column)
                table%column(i)%values = recorder%kept(i, :recorder%rows)
            end do
            table%column(1)%values = table%column(1)%values - 1 ! words are counted from 0
            table%column(1)%words = strings_of(recorder%events%name)
        end associate
        found = hand_result(run)
        !$omp end critical (library)
    end function find_events

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

    !> Prepares the motions with other values of a key. The values that no motion has are left out; there must be others.
    subroutine prepare_key(self, nodes, job, key, columns, error)
        type(varied_key_t), intent(inout) :: self
        type(nodes_t), intent(out) :: nodes
        type(job_t), target, intent(in) :: job
        type(sensitive_key_t), intent(in) :: key
        type(study_column_t), intent(in) :: columns(:)
        type(error_t), allocatable, intent(out) :: error
        type(scene_t), allocatable, target :: scene
        type(case_t) :: case
        type(plan_t) :: plan
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
                if (.not. nodes%is_valid(i)) cycle
                call key%plan_at(job%input%scene, nodes%x(i), scene, case, plan, self%exists(i, k), job%plan, accuracy)
                if (.not. self%exists(i, k)) cycle
                case%t_end = job%case%t_end ! steps of fixed size stay where they are
                call self%motion(i, k)%prepare(case, plan, columns)
            end do
            if (k == 0) call nodes%limit_to(self%exists(:, 0) .or. [(i == 1, i=1, node_count)])
        end do
        if (any(nodes%is_valid(2:))) return
        error = input_error(escaped(job%input%path) // ': output.columns: with another ' // key%name // ' there is no motion by &
                            &this method, and so no derivative; integrate by a method and formulation for any body')
    end subroutine prepare_key

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
