!> One top for C: an opaque object made from an input, its motion at any times with derivatives, and its events.
!> `include/spintop.h` describes the functions. An object does not change after it was made, so threads may share it; those
!> that ask for the motion do not wait for each other.
module spintop_c_top
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, c_null_ptr, &
        c_ptr, c_size_t
    use spintop_arithmetic, only: default_arithmetic_t
    use spintop_c_derivatives, only: asked_derivatives_t
    use spintop_c_error, only: describe_status, hand_error, hand_status, is_null, is_wrong, longest_message
    use spintop_c_motion, only: asked_motion_t
    use spintop_c_result, only: c_column_t, described_column_t, hand_result
    use spintop_c_text, only: c_text_t, is_empty, read_c_text
    use spintop_data_table, only: data_table_t
    use spintop_errors, only: error_t, input_error
    use spintop_exit_codes, only: exit_input, exit_ok
    use spintop_event_recorder, only: event_columns, event_recorder_t
    use spintop_in_memory, only: memory_run_t
    use spintop_integration, only: outcome_t
    use spintop_kinds, only: dp
    use spintop_motion_rows, only: compute_motion, writer_t
    use spintop_options, only: options_t
    use spintop_plan, only: plan_t
    use spintop_preparation, only: prepare_job, prepared_t
    use spintop_scene_words, only: kind_trajectory, study_kinds
    use spintop_status, only: code_of
    use spintop_study_column, only: study_column_t
    use spintop_table_column, only: column_t
    implicit none
    private

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
        if (is_null(input, 'the input', error)) return
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
        if (is_null(handle, 'the top', error)) return
        code = exit_ok
        if (n == 0) return
        code = exit_input
        ! A size_t beyond the range of Fortran's integers is negative here.
        if (is_wrong(n < 0 .or. n > most_times, 'there are more than 2147483647 times', error)) return
        if (is_null(t, 'the array of times', error)) return
        if (is_null(cells, 'the array of cells', error)) return
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
        if (is_null(handle, 'the top', error)) return
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

    !> Deletes a top.
    subroutine delete_top(handle) bind(C, name='spintop_top_delete')
        type(c_ptr), value :: handle !! the top; may be null
        type(top_t), pointer :: top
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, top)
        deallocate (top)
    end subroutine delete_top

end module spintop_c_top
