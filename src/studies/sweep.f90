!> The sweep study: a case for each combination of the axes, one row each, on all cores.
module spintop_sweep
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t, make_case
    use spintop_compare, only: is_finite
    use spintop_errors, only: error_t
    use spintop_exact_block, only: exact_block_t, block_size
    use spintop_job, only: job_t, options_t
    use spintop_nutation, only: class_names
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t
    use spintop_plan, only: plan_t, make_plan
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_parameter_print, only: print_namelist
    use spintop_provenance, only: describe_provenance
    use spintop_row_queue, only: row_queue_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_status, only: status_ok, status_bad_input, status_name, status_names, status_meaning, &
        last_status
    use spintop_summary, only: summary_t, rounded
    use spintop_sweep_axes, only: put_values
    use spintop_sweep_columns, only: sweep_column_t, sweep_columns, sweep_groups, quantities, &
        group_end, group_energy, group_period, q_motion_class
    use spintop_sweep_exact, only: load_lane, unload_lane, kernel_runs, stop_exactly
    use spintop_sweep_quantities, only: no_values, note_no_stop
    use spintop_sweep_stepping, only: compute_stepping
    use spintop_system, only: seconds, pause_for, peak_memory
    use spintop_table_file, only: table_file_t
    use spintop_text, only: to_text, string_t
    use spintop_text_buffer, only: text_buffer_t
    !$ use omp_lib, only: omp_get_num_threads
    implicit none
    private
    public :: run_sweep

    !> Cases that a thread computes before it hands in their rows, where cases cost much; where they
    !> cost little these are as many as the exact motion takes at once.
    integer, parameter :: block_of_stepping = 16
    !> Blocks a thread that a fast thread may be ahead of a slow one, and how long it waits then, s.
    integer, parameter :: blocks_ahead = 8
    real(dp), parameter :: pause_when_ahead = 1.0e-4_dp

    !> What a thread needs of its own to make and compute cases.
    type :: worker_t
        type(scene_t) :: scene
        type(number_slot_t), allocatable :: slots(:)
        type(case_t) :: case
        type(plan_t) :: plan
        !> The swept parameters leave the body, or the plan, as it is.
        logical :: same_body = .false., same_plan = .false.
        !> Whether the plan was made for a top whose exact motion is known.
        logical :: for_lagrange = .false.
        !> Which groups of quantities are wanted.
        logical :: wanted(sweep_groups) = .false.
        !> The cases of a block: status, note, quantities, and lane in the block of the exact motion
        !> (0 for cases without).
        type(case_t) :: cases(block_size)
        integer :: status(block_size) = status_ok, lane(block_size) = 0
        type(string_t) :: note(block_size)
        !> Whether the event came that was to end the motion.
        logical :: came(block_size) = .true.
        real(dp) :: values(quantities, block_size) = 0
        type(exact_block_t) :: block
        !> Cases of each status, and seconds spent on making, computing and formatting them.
        integer(int64) :: counts(0:last_status) = 0
        real(dp) :: making = 0, computing = 0, formatting = 0
    end type worker_t

contains

    !> Computes all cases and writes the table; `counts` are the cases of each status.
    subroutine run_sweep(job, options, summary, counts, error)
        type(job_t), intent(inout) :: job
        type(options_t), intent(in) :: options
        type(summary_t), intent(out) :: summary
        integer(int64), intent(out) :: counts(0:last_status)
        type(error_t), allocatable, intent(out) :: error
        type(table_file_t) :: file
        type(progress_t) :: progress
        type(worker_t), allocatable, target :: worker
        type(text_buffer_t) :: rows
        type(string_t) :: no_lines(0)
        type(row_queue_t) :: queue
        integer(int64) :: block, blocks, taken, size_of_block
        real(dp) :: began, moment, writing, times(3)
        logical :: accepted
        integer :: threads

        counts = 0
        call create_table(job, file, error)
        if (allocated(error)) return
        call progress%start(job%name, 'cases', job%axes%cases, options%quiet, options%progress)
        size_of_block = merge(block_size, block_of_stepping, job%plan%exact)
        blocks = (job%axes%cases + size_of_block - 1) / size_of_block
        taken = 0
        times = 0
        writing = 0
        threads = 1
        began = seconds()
        !$omp parallel private(worker, rows, block, accepted, moment) reduction(+:counts, times, writing)
        !$omp single
        !$ threads = omp_get_num_threads()
        call queue%start(blocks_ahead * threads)
        !$omp end single
        allocate (worker)
        call prepare_worker(job, worker)
        do
            !$omp critical (queue)
            taken = taken + 1
            block = taken
            if (allocated(queue%error)) block = blocks + 1
            !$omp end critical (queue)
            if (block > blocks) exit
            call compute_block(job, worker, (block - 1) * size_of_block + 1, &
                               min(block * size_of_block, job%axes%cases), rows)
            do
                !$omp critical (queue)
                moment = seconds()
                call queue%hand_in(block, rows, file, accepted)
                call progress%update(min(queue%written * size_of_block, job%axes%cases))
                writing = writing + (seconds() - moment)
                !$omp end critical (queue)
                if (accepted) exit
                call pause_for(pause_when_ahead)
            end do
        end do
        counts = counts + worker%counts
        times = times + [worker%making, worker%computing, worker%formatting]
        !$omp end parallel
        call progress%finish()
        moment = seconds()
        call move_alloc(queue%error, error)
        if (.not. allocated(error)) call file%finish(no_lines, error)
        if (allocated(error)) then
            call file%discard()
            return
        end if
        writing = writing + (seconds() - moment)
        call describe_sweep(job, counts, threads, seconds() - began, times, writing, summary)
    end subroutine run_sweep

    !> The summary: plan, cases by status, time by part.
    subroutine describe_sweep(job, counts, threads, elapsed, times, writing, summary)
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: counts(0:last_status)
        integer, intent(in) :: threads
        real(dp), intent(in) :: elapsed, times(3), writing
        type(summary_t), intent(out) :: summary
        integer :: status

        call summary%headline(job%input // ': sweep of ' // to_text(job%axes%cases) // ' cases -> ' // job%output)
        call summary%describe_plan(job%plan)
        call summary%add('time', rounded(elapsed) // ' s on ' // to_text(threads) // ' threads, ' &
            // rounded(job%axes%cases / elapsed) // ' cases/s')
        call summary%add('parts', 'making cases ' // rounded(times(1)) // ' s, computing ' &
            // rounded(times(2)) // ' s (' // rounded(job%axes%cases / times(2)) // ' cases/s a thread), formatting ' &
            // rounded(times(3)) // ' s, all threads together; writing ' // rounded(writing) // ' s')
        call summary%add('memory', rounded(peak_memory() / 1.0e6_dp) // ' MB at most')
        do status = status_ok, last_status
            if (counts(status) == 0) cycle
            call summary%add('status', to_text(counts(status)) // ' ' // status_name(status) // ': ' &
                             // status_meaning(status))
        end do
    end subroutine describe_sweep

    !> Starts the table: case, swept parameters, status, quantities, notes.
    subroutine create_table(job, file, error)
        type(job_t), intent(in) :: job
        type(table_file_t), intent(inout) :: file
        type(error_t), allocatable, intent(out) :: error
        type(string_t), allocatable :: input(:), header(:)
        type(sweep_column_t), allocatable :: columns(:)
        integer :: i, axes

        axes = size(job%axes%axis)
        allocate (columns(axes + size(job%columns) + 3))
        columns(1) = sweep_column_t('case', '', 'number of the case', 0)
        do i = 1, axes
            associate (name => job%axes%axis(i)%name)
                associate (parameter => job%table%parameters(job%table%find(base_of(name))))
                    columns(1 + i) = sweep_column_t(name, parameter%unit, parameter%what, 0)
                end associate
            end associate
        end do
        columns(axes + 2) = sweep_column_t('status', '', 'ok, or what failed', 0)
        columns(axes + 3:size(columns) - 1) = sweep_columns(job%columns)
        columns(size(columns)) = sweep_column_t('notes', '', 'why a quantity does not exist', 0)
        call print_namelist(job%table, input)
        call describe_provenance(job%scene%title, job%plan%model, job%plan%method, input, columns%name, &
                                 columns%unit, columns%what, dated=.false., lines=header)
        call file%create(job%output, header, columns%name, error)
    end subroutine create_table

    !> Name of a parameter without its subscript.
    pure function base_of(name) result(base)
        character(*), intent(in) :: name
        character(:), allocatable :: base
        base = name(:index(name // '(', '(') - 1)
    end function base_of

    !> A scene, a case and a plan of the thread's own.
    subroutine prepare_worker(job, worker)
        type(job_t), intent(in) :: job
        type(worker_t), target, intent(inout) :: worker
        type(parameter_table_t) :: table
        worker%scene = job%scene
        call describe_scene(worker%scene, table)
        allocate (worker%slots, source=job%axes%slots_in(table))
        worker%case = job%case
        worker%plan = job%plan
        worker%same_body = .not. job%axes%varies('top')
        worker%same_plan = .not. job%axes%varies('integration')
        worker%for_lagrange = job%case%body%is_lagrange()
        worker%wanted(sweep_columns(job%columns)%group) = .true.
    end subroutine prepare_worker

    !> Rows of the cases from `first` to `last`. Cases known in closed form are computed together,
    !> the others each when it is made, while its plan stands.
    subroutine compute_block(job, worker, first, last, rows)
        type(job_t), intent(in) :: job
        type(worker_t), target, intent(inout) :: worker
        integer(int64), intent(in) :: first, last
        type(text_buffer_t), intent(inout) :: rows
        real(dp) :: moment
        integer :: k

        associate (n => int(last - first + 1), block => worker%block)
            moment = seconds()
            block%n = 0
            do k = 1, n
                call put_values(worker%slots, job%axes%values_of(first + k - 1))
                call make_worker_case(worker, worker%status(k), worker%note(k)%text)
                if (worker%plan%exact .and. worker%status(k) == status_ok .and. size(job%events) > 0) then
                    call stop_exactly(worker%case, job%events, job%stop_after, worker%came(k))
                end if
                worker%cases(k) = worker%case
                worker%lane(k) = 0
                if (worker%status(k) /= status_ok) then
                    worker%values(:, k) = no_values()
                else if (worker%plan%exact) then
                    block%n = block%n + 1
                    worker%lane(k) = block%n
                    call load_lane(worker%case, block, block%n)
                else
                    worker%making = worker%making + (seconds() - moment)
                    moment = seconds()
                    call compute_stepping(worker%case, worker%plan, worker%wanted, job%events, job%stop_after, &
                                          worker%values(:, k), worker%status(k), worker%note(k)%text)
                    worker%computing = worker%computing + (seconds() - moment)
                    moment = seconds()
                end if
            end do
            worker%making = worker%making + (seconds() - moment)

            moment = seconds()
            if (any(worker%lane(:n) > 0) .and. kernel_runs(worker%wanted)) then
                call block%compute(any(worker%wanted([group_end, group_energy])), worker%wanted(group_period))
            end if
            worker%computing = worker%computing + (seconds() - moment)

            moment = seconds()
            call rows%clear()
            do k = 1, n
                if (worker%lane(k) > 0) then
                    call unload_lane(worker%cases(k), block, worker%lane(k), worker%wanted, &
                                     worker%values(:, k), worker%status(k), worker%note(k)%text)
                    if (worker%status(k) == status_ok .and. .not. worker%came(k)) call note_no_stop(worker%note(k)%text)
                end if
                call rows%put_integer(first + k - 1)
                call rows%put_reals(job%axes%values_of(first + k - 1))
                call rows%put_text(trim(status_names(worker%status(k))))
                call put_quantities(job%columns, worker%values(:, k), rows)
                call rows%put_text(worker%note(k)%text)
                call rows%end_row()
                worker%counts(worker%status(k)) = worker%counts(worker%status(k)) + 1
            end do
            worker%formatting = worker%formatting + (seconds() - moment)
        end associate
    end subroutine compute_block

    !> The cells of the chosen quantities: numbers, and the class of the motion as a word.
    subroutine put_quantities(columns, values, rows)
        integer, intent(in) :: columns(:)
        real(dp), intent(in) :: values(quantities)
        type(text_buffer_t), intent(inout) :: rows
        integer :: i, class
        if (all(columns /= q_motion_class)) then
            call rows%put_reals(values(columns))
            return
        end if
        do i = 1, size(columns)
            if (columns(i) /= q_motion_class) then
                call rows%put_reals(values(columns(i:i)))
            else if (is_finite(values(columns(i)))) then
                class = nint(values(columns(i)))
                call rows%put_text(trim(class_names(class)))
            else
                call rows%put_text('none')
            end if
        end do
    end subroutine put_quantities

    !> Makes the case of the worker's scene, and a plan where the last one does not fit it.
    subroutine make_worker_case(worker, status, note)
        type(worker_t), intent(inout) :: worker
        integer, intent(out) :: status
        character(:), allocatable, intent(out) :: note
        type(problems_t) :: problems

        status = status_ok
        call make_case(worker%scene, worker%case, problems, worker%same_body)
        associate (is_lagrange => worker%case%body%is_lagrange())
            if (.not. problems%any() .and. worker%same_plan .and. (is_lagrange .eqv. worker%for_lagrange)) return
            ! Plans and problems are made of texts: see `status_names`.
            !$omp critical (texts)
            if (.not. problems%any()) then
                call make_plan(worker%scene, worker%case, worker%plan, problems)
                ! After a plan that failed the next case needs one of its own.
                worker%for_lagrange = is_lagrange .neqv. problems%any()
            end if
            if (problems%any()) then
                status = status_bad_input
                note = problems%first()
            end if
            !$omp end critical (texts)
        end associate
    end subroutine make_worker_case

end module spintop_sweep
