!> Studies and lists for C. These calls read and make texts: they wait for each other, because gfortran keeps the
!> length of the result of a text function in memory that all threads share.
module spintop_c_run
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_funptr, c_int, c_loc, c_null_char, &
        c_null_ptr, c_ptr, c_size_t
    use spintop_caller, only: default_arithmetic_t, begin_call, end_call, set_caller
    use spintop_axes_of_table, only: given_axis_t
    use spintop_c_error, only: failed, is_empty, read_c_text, read_c_texts, read_input, refuse, take_pointers
    use spintop_c_result, only: hand_result
    use spintop_errors, only: error_t
    use spintop_execution, only: memory_run_t, run_in_memory
    use spintop_listing, only: list_topic
    use spintop_study, only: most_threads, options_t
    use spintop_provenance, only: program_version
    use spintop_text, only: join, string_t
    implicit none
    private

    character(c_char), target :: version(len(program_version) + 1) = &
        transfer(program_version // c_null_char, [character(c_char) ::])
    !> Most cases of a sweep from arrays.
    integer(c_size_t), parameter :: most_cases = huge(1_c_int)

    interface
        !> A copy of a text, in memory that C frees.
        type(c_ptr) function c_copy(text) bind(C, name='strdup')
            import :: c_char, c_ptr
            character(c_char), intent(in) :: text(*)
        end function c_copy
    end interface

contains

    !> Number of the interface: it changes when a program that was linked with an earlier one no longer works.
    integer(c_int) function interface_version() bind(C, name='spintop_interface')
        interface_version = 1
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
        handle = run_text(input, name, folder, threads, error)
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
        handle = run_text(input, c_null_ptr, c_null_ptr, threads, error, count, names, values, cases)
    end function run_sweep

    !> Runs a text; with the last arguments as a sweep over arrays.
    type(c_ptr) function run_text(input, name, folder, threads, place, count, names, values, cases) result(handle)
        type(c_ptr), intent(in) :: input, name, folder
        integer(c_int), intent(in) :: threads
        type(c_ptr), intent(in) :: place
        integer(c_int), intent(in), optional :: count
        type(c_ptr), intent(in), optional :: names, values
        integer(c_size_t), intent(in), optional :: cases
        type(default_arithmetic_t) :: arithmetic
        type(options_t) :: options
        type(memory_run_t) :: run
        type(given_axis_t), allocatable :: given(:)
        type(error_t), allocatable :: error
        character(:), allocatable :: text, name_of_text

        call arithmetic%begin()
        handle = c_null_ptr
        !$omp critical (library)
        if (present(count)) call read_axes(count, names, values, cases, given, error)
        call read_input(input, name, text, name_of_text, error)
        call refuse(is_empty(folder), 'the name of the folder is empty', error)
        call refuse(threads < 0, 'the number of threads is negative', error)
        if (.not. allocated(error)) then
            call read_c_text(folder, options%output)
            options%threads = min(threads, most_threads)
            call begin_call()
            call run_in_memory(text, name_of_text, options, run, error, given)
            call end_call(error)
        end if
        if (.not. failed(error, place)) handle = hand_result(run)
        !$omp end critical (library)
    end function run_text

    !> Reads the arrays of a sweep.
    subroutine read_axes(count, names, values, cases, given, error)
        integer(c_int), intent(in) :: count
        type(c_ptr), intent(in) :: names, values
        integer(c_size_t), intent(in) :: cases
        type(given_axis_t), allocatable, intent(out) :: given(:)
        type(error_t), allocatable, intent(inout) :: error
        type(string_t), allocatable :: texts(:)
        type(c_ptr), pointer :: arrays(:)
        real(c_double), pointer :: array(:)
        integer :: i

        call refuse(count < 0, 'the number of parameters is negative', error)
        ! A size_t beyond the range of Fortran's integers is negative here.
        call refuse(cases < min(1, count) .or. cases > most_cases, 'a sweep over arrays has 1 to 2147483647 cases', error)
        call read_c_texts(names, count, 'the name of a parameter', texts, error)
        call take_pointers(values, count, 'the array of a parameter', arrays, error)
        if (allocated(error)) return
        allocate (given(count))
        do i = 1, count
            call c_f_pointer(arrays(i), array, [cases])
            given(i)%name = texts(i)%text
            given(i)%values = array
        end do
    end subroutine read_axes

    !> Lists a registry, as `spintop list` does.
    type(c_ptr) function list(topic, as_json, place) bind(C, name='spintop_list') result(handle)
        type(c_ptr), value :: topic !! its name; null for the topics, or as JSON for all of them
        integer(c_int), value :: as_json !! not 0: as JSON
        type(c_ptr), value :: place !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(string_t), allocatable :: lines(:)
        type(error_t), allocatable :: error
        character(:), allocatable :: name

        call arithmetic%begin()
        handle = c_null_ptr
        !$omp critical (library)
        call read_c_text(topic, name)
        call refuse(is_empty(topic), 'the name of the topic is empty', error)
        if (.not. allocated(error)) call list_topic(name, as_json /= 0, lines, error)
        if (.not. failed(error, place)) handle = c_copy(join(lines, new_line('a')) // c_null_char)
        !$omp end critical (library)
    end function list

end module spintop_c_run
