!> Many undamped symmetric tops together for C, from arrays to arrays. `include/spintop.h` describes the function.
module spintop_c_tops
    use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_long_long, c_ptr
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_caller, only: default_arithmetic_t
    use spintop_c_error, only: failed, read_c_texts, refuse, take_pointers
    use spintop_errors, only: error_t, exit_input, exit_ok
    use spintop_exact_block, only: block_size, compute_block, exact_block_t
    use spintop_kinds, only: dp, no_number
    use spintop_study, only: most_threads
    use spintop_status, only: is_ok
    use spintop_text, only: string_t
    !$ use omp_lib, only: omp_get_max_threads
    implicit none
    private

    integer, parameter :: name_length = 24

    !> Names of the data, and of the quantities, in the order of `arrays_of`.
    character(*), parameter :: data_names(*) = [character(name_length) :: 'inertia1', 'inertia3', 'mgl', 'theta', 'phi_rate', &
        'theta_rate', 'omega3', 'phi', 'psi', 't_end']
    character(*), parameter :: quantity_names(*) = [character(name_length) :: 'theta_min', 'theta_max', 'delta_u', &
        'nutation_period', 'precession_per_nutation', 'precession_rate', 'phi_rate_max', 'theta_end', 'phi_end', 'psi_end', &
        'theta_rate_end', 'energy_error']
    !> The first of the quantities for which the motion at the end is computed.
    integer, parameter :: first_of_end = 8
    !> Most elements of an array: its size in bytes is a number of C.
    integer(int64), parameter :: most_elements = 2_int64**59
    !> So many of the data must be given; the others are 0 by default.
    integer, parameter :: needed = 4

    !> An array of C.
    type :: array_t
        integer :: place = 0
        !> Elements from one top to the next: 0 for a value of all tops.
        integer(int64) :: stride = 0
        real(c_double), pointer :: values(:) => null()
    end type array_t

    !> An array of a block.
    type :: block_array_t
        real(dp), pointer, contiguous :: values(:) => null()
    end type block_array_t

    !> What C asks for.
    type :: request_t
        integer(int64) :: n = 0
        type(array_t), allocatable :: given(:), wanted(:)
        integer(c_int), pointer :: status(:) => null()
        logical :: wants_end = .false.
    end type request_t

contains

    !> Computes many tops.
    integer(c_int) function compute_tops(n, given_count, given_names, given, strides, wanted_count, wanted_names, wanted, &
                                         statuses, threads, error) bind(C, name='spintop_tops') result(code)
        integer(c_long_long), value :: n !! number of tops
        integer(c_int), value :: given_count !! number of arrays of data
        type(c_ptr), value :: given_names, given, strides !! their names, the arrays, and their strides in elements
        integer(c_int), value :: wanted_count !! number of arrays of quantities
        type(c_ptr), value :: wanted_names, wanted !! their names, and the arrays
        type(c_ptr), value :: statuses !! a status for each top; may be null
        integer(c_int), value :: threads !! number of threads; 0 for all cores
        type(c_ptr), value :: error !! where C wants its pointer to an error; may be null
        type(default_arithmetic_t) :: arithmetic
        type(request_t) :: request
        integer(c_long_long), pointer :: steps(:)
        type(c_ptr), pointer :: data(:), quantities(:)
        type(error_t), allocatable :: problem
        integer :: i

        call arithmetic%begin()
        request%n = n
        call take_pointers(given, merge(given_count, 0, n > 0), 'an array of values', data, problem)
        call take_pointers(wanted, merge(wanted_count, 0, n > 0), 'an array of values', quantities, problem)
        call refuse(min(given_count, wanted_count, threads) < 0, 'the number of threads, or of arrays, is negative', problem)
        call refuse(given_count > 0 .and. .not. c_associated(strides), 'the array of strides is a null pointer', problem)
        call find_arrays(given_count, given_names, data_names, request%given, problem)
        call find_arrays(wanted_count, wanted_names, quantity_names, request%wanted, problem)
        if (given_count > 0 .and. .not. allocated(problem)) then
            call c_f_pointer(strides, steps, [given_count])
            request%given%stride = steps
        end if
        call refuse(n < 0 .or. any(request%given%stride < 0), 'the number of tops, or a stride, is negative', problem)
        call refuse(n > most_elements / max(1_int64, maxval(request%given%stride)), &
                    'the arrays are larger than the memory of any machine', problem)
        do i = 1, needed
            call refuse(all(request%given%place /= i), trim(data_names(i)) // ' is not given', problem)
        end do
        code = exit_input
        if (failed(problem, error)) return
        code = exit_ok
        if (n == 0) return
        do i = 1, size(request%given)
            call c_f_pointer(data(i), request%given(i)%values, [(n - 1) * request%given(i)%stride + 1])
        end do
        do i = 1, size(request%wanted)
            call c_f_pointer(quantities(i), request%wanted(i)%values, [n])
        end do
        if (c_associated(statuses)) call c_f_pointer(statuses, request%status, [n])
        request%wants_end = any(request%wanted%place >= first_of_end)
        call compute_blocks(request, int(threads))
    end function compute_tops

    !> Finds arrays by their names among the known ones, each of which may be there once.
    subroutine find_arrays(count, names, known, arrays, problem)
        integer(c_int), intent(in) :: count
        type(c_ptr), intent(in) :: names
        character(*), intent(in) :: known(:)
        type(array_t), allocatable, intent(out) :: arrays(:)
        type(error_t), allocatable, intent(inout) :: problem
        type(string_t), allocatable :: texts(:)
        character(name_length) :: name
        integer :: i, k

        allocate (arrays(max(0, count)))
        call read_c_texts(names, count, 'the name of an array', texts, problem)
        if (allocated(problem)) return
        do i = 1, count
            arrays(i)%place = findloc(known == texts(i)%text, .true., dim=1)
            name = texts(i)%text
            call refuse(any(arrays(:i - 1)%place == arrays(i)%place), "'" // trim(name) // "' is given twice", problem)
            if (arrays(i)%place > 0 .or. allocated(problem)) cycle
            if (len(texts(i)%text) > name_length) name(name_length - 2:) = '...'
            call refuse(.true., "'" // trim(name) // "' is none of " // trim(known(1)), problem)
            do k = 2, size(known)
                problem%message = problem%message // ', ' // trim(known(k))
            end do
        end do
    end subroutine find_arrays

    !> Computes the tops block by block.
    subroutine compute_blocks(request, wanted_threads)
        type(request_t), intent(in) :: request
        integer, intent(in) :: wanted_threads
        type(exact_block_t), allocatable :: block
        integer(int64) :: first
        integer :: threads

        threads = 1
        !$ threads = omp_get_max_threads()
        if (wanted_threads > 0) threads = wanted_threads
        threads = int(min(int(min(threads, most_threads), int64), (request%n - 1) / block_size + 1))
        !$omp parallel num_threads(threads) private(block)
        allocate (block)
        !$omp do schedule(dynamic, 4)
        do first = 0, request%n - 1, block_size
            block%n = int(min(int(block_size, int64), request%n - first))
            call load(request, first, block)
            call compute_block(block, request%wants_end, .false.)
            call unload(request, first, block)
        end do
        !$omp end do
        deallocate (block)
        !$omp end parallel
    end subroutine compute_blocks

    !> Puts the data of the tops after the first ones into a block.
    subroutine load(request, first, block)
        type(request_t), intent(in) :: request
        integer(int64), intent(in) :: first
        type(exact_block_t), target, intent(inout) :: block
        type(block_array_t) :: arrays(size(data_names) + size(quantity_names))
        real(dp), pointer, contiguous :: room(:)
        integer :: i, k

        arrays = arrays_of(block)
        do k = 1, size(data_names)
            room => arrays(k)%values
            room(:block%n) = 0
            do i = 1, size(request%given)
                if (request%given(i)%place /= k) cycle
                associate (stride => request%given(i)%stride, values => request%given(i)%values)
                    if (stride == 0) then
                        room(:block%n) = values(1)
                    else
                        room(:block%n) = values(first * stride + 1:(first + block%n - 1) * stride + 1:stride)
                    end if
                end associate
            end do
        end do
    end subroutine load

    !> Hands over the quantities of a block; those of a top that could not be computed are NaN.
    subroutine unload(request, first, block)
        type(request_t), intent(in) :: request
        integer(int64), intent(in) :: first
        type(exact_block_t), target, intent(inout) :: block
        type(block_array_t) :: arrays(size(data_names) + size(quantity_names))
        integer :: i
        logical :: any_failed

        arrays = arrays_of(block)
        associate (n => block%n)
            any_failed = any(.not. is_ok(block%status(:n)))
            do i = 1, size(request%wanted)
                request%wanted(i)%values(first + 1:first + n) = arrays(size(data_names) + request%wanted(i)%place)%values(:n)
                if (any_failed) where (.not. is_ok(block%status(:n))) &
                    request%wanted(i)%values(first + 1:first + n) = no_number
            end do
            if (associated(request%status)) request%status(first + 1:first + n) = block%status(:n)
        end associate
    end subroutine unload

    !> The arrays of a block: those of the data, and those of the quantities, in the order of their names.
    function arrays_of(cases) result(arrays)
        type(exact_block_t), target, intent(inout) :: cases
        type(block_array_t) :: arrays(size(data_names) + size(quantity_names))
        arrays = [block_array_t(cases%inertia1), block_array_t(cases%inertia3), block_array_t(cases%mgl), &
                  block_array_t(cases%theta), block_array_t(cases%phi_rate), block_array_t(cases%theta_rate), &
                  block_array_t(cases%omega3), block_array_t(cases%phi), block_array_t(cases%psi), block_array_t(cases%t_end), &
                  block_array_t(cases%theta_min), block_array_t(cases%theta_max), block_array_t(cases%delta_u), &
                  block_array_t(cases%period), block_array_t(cases%precession), block_array_t(cases%precession_rate), &
                  block_array_t(cases%phi_rate_max), block_array_t(cases%theta_end), block_array_t(cases%phi_end), &
                  block_array_t(cases%psi_end), block_array_t(cases%theta_rate_end), block_array_t(cases%energy_error)]
    end function arrays_of

end module spintop_c_tops
