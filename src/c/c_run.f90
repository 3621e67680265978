!> Studies and lists for C. These calls read and make texts: they wait for each other, because gfortran keeps the
!> length of the result of a text function in memory that all threads share.
module spintop_c_run
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_funptr, c_int, c_loc, &
        c_null_char, c_null_ptr, c_ptr, c_size_t
    use spintop_arithmetic, only: default_arithmetic_t
    use spintop_axes_of_table, only: given_axis_t
    use spintop_caller, only: begin_call, end_call, set_caller
    use spintop_c_error, only: c_text_t, hand_error, is_any_null, is_empty, is_wrong, read_c_text, read_c_texts
    use spintop_c_result, only: hand_result
    use spintop_errors, only: error_t
    use spintop_execution, only: memory_run_t, run_in_memory
    use spintop_listing, only: list_topic
    use spintop_options, only: most_threads, options_t
    use spintop_provenance, only: program_version
    use spintop_text, only: join, string_t
    implicit none
    private

    !> Number of the interface: it changes when a program that was linked with an earlier one no longer works.
    integer(c_int), parameter :: interface_number = 1
    character(c_char), target :: version(len(program_version) + 1) = &
        transfer(program_version // c_null_char, [character(c_char) ::])
    !> Most cases of a sweep from arrays.
    integer(c_size_t), parameter :: most_cases = huge(1_c_int)

    interface
        !> Memory that C frees.
        type(c_ptr) function c_allocate(bytes) bind(C, name='malloc')
            import :: c_ptr, c_size_t
            integer(c_size_t), value :: bytes
        end function c_allocate
    end interface

contains

    !> Number of the interface.
    integer(c_int) function interface_version() bind(C, name='spintop_interface')
        interface_version = interface_number
    end function interface_version

    !> Version of the library, as `0.1.0`.
    type(c_ptr) function library_version() bind(C, name='spintop_version')
        library_version = c_loc(version)
    end function library_version

    !> Sets the function that runs of this thread ask whether they are to stop.
    subroutine on_progress(asks, data) bind(C, name='spintop_on_progress')
        type(c_funptr), value :: asks !! int (double share, void *data); null for none
        type(c_ptr), value :: data !! its second argument
        call set_caller(asks, data)
    end subroutine on_progress

    !> Runs an input.
    type(c_ptr) function run_input(input, name, folder, threads, error) bind(C, name='spintop_run') result(handle)
        type(c_ptr), value :: input, name !! the text, and its name in messages; a null name is `input`
        type(c_ptr), value :: folder !! for tables that stay; null for tables in memory only
        integer(c_int), value :: threads !! number of threads; 0 for all cores
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        call arithmetic%begin()
        !$omp critical (library)
        call run_text(input, name, folder, threads, error, handle)
        !$omp end critical (library)
    end function run_input

    !> Runs a sweep over arrays.
    type(c_ptr) function run_sweep(input, count, names, values, cases, threads, error) bind(C, name='spintop_sweep') &
            result(handle)
        type(c_ptr), value :: input !! the namelist, as in an input file
        integer(c_int), value :: count !! number of parameters that vary
        type(c_ptr), value :: names, values !! their names, and an array of values for each
        integer(c_size_t), value :: cases !! values in each array
        integer(c_int), value :: threads !! number of threads; 0 for all cores
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(given_axis_t), allocatable :: given(:)
        call arithmetic%begin()
        !$omp critical (library)
        handle = c_null_ptr
        if (are_arrays(count, names, values, cases, error)) then
            call read_axes(count, names, values, cases, given)
            call run_text(input, c_null_ptr, c_null_ptr, threads, error, handle, given)
        end if
        !$omp end critical (library)
    end function run_sweep

    !> Whether the arrays of a sweep can be read; what is wrong is handed over.
    logical function are_arrays(count, names, values, cases, error)
        integer(c_int), intent(in) :: count
        type(c_ptr), intent(in) :: names, values
        integer(c_size_t), intent(in) :: cases
        type(c_ptr), intent(in) :: error
        are_arrays = .false.
        if (is_wrong(count < 0, 'the number of parameters is negative', error)) return
        ! A size_t beyond the range of Fortran's integers is negative here.
        if (is_wrong(cases < min(1, count) .or. cases > most_cases, 'a sweep over arrays has 1 to 2147483647 cases', error)) return
        if (is_wrong(is_any_null(names, int(count)), 'the name of a parameter is a null pointer', error)) return
        if (is_wrong(is_any_null(values, int(count)), 'the array of a parameter is a null pointer', error)) return
        are_arrays = .true.
    end function are_arrays

    subroutine run_text(input, name, folder, threads, place, handle, given)
        type(c_ptr), intent(in) :: input, name, folder
        integer(c_int), intent(in) :: threads
        type(c_ptr), intent(in) :: place
        type(c_ptr), intent(out) :: handle
        type(given_axis_t), allocatable, intent(in), optional :: given(:)
        type(options_t) :: options
        type(memory_run_t) :: run
        type(error_t), allocatable :: error
        character(:), allocatable :: text, name_of_text

        handle = c_null_ptr
        if (is_wrong(.not. c_associated(input), 'the input is a null pointer', place)) return
        if (is_wrong(is_empty(name), 'the name of the input is empty', place)) return
        if (is_wrong(is_empty(folder), 'the name of the folder is empty', place)) return
        if (is_wrong(threads < 0, 'the number of threads is negative', place)) return
        call read_c_text(input, text)
        call read_c_text(name, name_of_text)
        call read_c_text(folder, options%output)
        if (name_of_text == '') name_of_text = 'input'
        options%threads = min(threads, most_threads)
        call begin_call()
        call run_in_memory(text, name_of_text, options, run, error, given)
        call end_call(error)
        if (allocated(error)) then
            call hand_error(error, place)
        else
            handle = hand_result(run)
        end if
    end subroutine run_text

    !> Reads the arrays of a sweep.
    subroutine read_axes(count, names, values, cases, given)
        integer(c_int), intent(in) :: count
        type(c_ptr), intent(in) :: names, values
        integer(c_size_t), intent(in) :: cases
        type(given_axis_t), allocatable, intent(out) :: given(:)
        type(string_t), allocatable :: texts(:)
        type(c_ptr), pointer :: arrays(:)
        real(c_double), pointer :: array(:)
        integer :: i

        allocate (texts(0), given(count))
        call read_c_texts(names, int(count), texts)
        if (count == 0) return
        call c_f_pointer(values, arrays, [count])
        do i = 1, count
            call c_f_pointer(arrays(i), array, [cases])
            given(i)%name = texts(i)%text
            given(i)%values = array
        end do
    end subroutine read_axes

    !> Lists a registry, as `spintop list` does.
    type(c_ptr) function list(topic, as_json, error) bind(C, name='spintop_list') result(handle)
        type(c_ptr), value :: topic !! its name; null for the topics, or as JSON for all of them
        integer(c_int), value :: as_json !! not 0: as JSON
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        call arithmetic%begin()
        !$omp critical (library)
        call list_text(topic, as_json /= 0, error, handle)
        !$omp end critical (library)
    end function list

    subroutine list_text(topic, as_json, place, handle)
        type(c_ptr), intent(in) :: topic
        logical, intent(in) :: as_json
        type(c_ptr), intent(in) :: place
        type(c_ptr), intent(out) :: handle
        type(string_t), allocatable :: lines(:)
        type(error_t), allocatable :: error
        character(:), allocatable :: name
        character(c_char), pointer :: letters(:)
        type(c_text_t) :: text

        handle = c_null_ptr
        if (is_wrong(is_empty(topic), 'the name of the topic is empty', place)) return
        call read_c_text(topic, name)
        call list_topic(name, as_json, lines, error)
        if (allocated(error)) then
            call hand_error(error, place)
            return
        end if
        call text%set(join(lines, new_line('a')))
        handle = c_allocate(size(text%letters, kind=c_size_t))
        if (.not. c_associated(handle)) return
        call c_f_pointer(handle, letters, [size(text%letters)])
        letters = text%letters
    end subroutine list_text

end module spintop_c_run
