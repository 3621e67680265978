!> One thread's share of a sweep: makes cases, computes them, and fills their rows.
module spintop_sweep_worker
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: seconds
    use spintop_kinds, only: dp
    use spintop_case, only: case_t, make_case
    use spintop_compare, only: is_finite
    use spintop_exact_block, only: exact_block_t, block_size
    use spintop_job, only: job_t
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t
    use spintop_plan, only: plan_t, make_plan
    use spintop_problems, only: problems_t
    use spintop_row_block, only: row_block_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_start_of_scene, only: attitude_parameters
    use spintop_status, only: status_ok, status_bad_input, status_meanings
    use spintop_sweep_axes, only: put_values
    use spintop_sweep_batch, only: sweep_batch_t, goes_in_batch
    use spintop_sweep_columns, only: sweep_columns, sweep_groups, quantities, group_end, group_energy, &
        group_period
    use spintop_sweep_exact, only: load_lane, unload_lane, kernel_runs, stop_exactly
    use spintop_sweep_notes, only: note_t, note_no_stop
    use spintop_sweep_quantities, only: no_values, note_missing, told_last
    use spintop_sweep_stepping, only: compute_stepping
    use spintop_sweep_table, only: put_row, reserve_rows
    implicit none
    private
    public :: sweep_worker_t, size_of_block

    !> Cases that a thread computes before it hands in their rows, where each costs much; where they
    !> are computed together these are as many as the exact motion takes at once.
    integer, parameter :: block_of_stepping = 16

    !> What a thread needs of its own to make and compute cases.
    type :: sweep_worker_t
        type(scene_t), private :: scene
        type(number_slot_t), allocatable, private :: slots(:)
        type(plan_t), private :: plan
        !> The swept parameters leave the body, the attitude at the start, or the plan as it is.
        logical, private :: same_body = .false., same_attitude = .false., same_plan = .false.
        !> Whether the plan was made for a top whose exact motion is known.
        logical, private :: for_lagrange = .false.
        !> Which groups of quantities are wanted.
        logical, private :: wanted(sweep_groups) = .false.
        !> Those of the table whose lack nothing else tells.
        integer, allocatable, private :: told_last(:)
        !> The cases of a block, each made in the place of one of the last block, from which it keeps what is the
        !> same; status, note, quantities, and lane in the block of the exact motion (0 for
        !> cases without).
        type(case_t), allocatable, private :: cases(:)
        integer, allocatable, private :: status(:), lane(:)
        type(note_t), allocatable, private :: note(:)
        !> What is left of the work that a case may take, in steps.
        integer(int64), allocatable, private :: max_steps(:)
        !> Whether the event came that was to end the motion.
        logical, allocatable, private :: came(:)
        !> The swept parameters of each case, as many as there are axes.
        real(dp), allocatable, private :: parameters(:, :)
        real(dp), allocatable, private :: values(:, :)
        type(exact_block_t), allocatable, private :: block
        type(sweep_batch_t), private :: batch
        !> Seconds spent on making and computing cases, and on filling their rows.
        real(dp) :: making = 0, computing = 0, filling = 0
    contains
        procedure :: prepare
        procedure :: compute_rows
    end type sweep_worker_t

contains

    !> Cases in a block of a sweep.
    integer function size_of_block(job)
        type(job_t), intent(in) :: job
        size_of_block = merge(block_size, block_of_stepping, &
                              job%plan%exact .or. goes_in_batch(job, job%case, job%plan))
    end function size_of_block

    !> A scene, a case and a plan of the thread's own.
    subroutine prepare(worker, job)
        class(sweep_worker_t), target, intent(inout) :: worker
        type(job_t), intent(in) :: job
        type(parameter_table_t) :: table
        integer :: i
        worker%scene = job%scene
        call describe_scene(worker%scene, table)
        allocate (worker%slots, source=job%axes%slots_in(table))
        ! Not on the stack, which may be small.
        allocate (worker%cases(block_size), source=job%case)
        allocate (worker%status(block_size), worker%lane(block_size), worker%came(block_size), worker%max_steps(block_size))
        allocate (worker%parameters(size(job%axes%axis), block_size), worker%values(quantities, block_size))
        allocate (worker%note(block_size), worker%block)
        worker%status = status_ok
        worker%lane = 0
        worker%came = .true.
        worker%parameters = 0
        worker%values = 0
        worker%plan = job%plan
        worker%same_body = .not. job%axes%varies('top')
        worker%same_attitude = .not. job%axes%varies_any(attitude_parameters)
        worker%same_plan = .not. job%axes%varies('integration')
        worker%for_lagrange = job%case%body%is_lagrange()
        worker%wanted(sweep_columns(job%columns)%group) = .true.
        worker%told_last = pack(told_last, [(any(job%columns == told_last(i)), i=1, size(told_last))])
    end subroutine prepare

    !> Rows of the cases from `first` to `last`, at most `block_size`. Cases known in closed form are
    !> computed together, and so are those of which the end alone is wanted; the others each when it
    !> is made, while its plan stands.
    subroutine compute_rows(worker, job, first, last, rows)
        class(sweep_worker_t), target, intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: first, last
        type(row_block_t), intent(inout) :: rows
        real(dp) :: moment
        integer :: k

        associate (n => int(last - first + 1), block => worker%block)
            moment = seconds()
            block%n = 0
            do k = 1, n
                call worker%note(k)%clear()
                call job%axes%find_values(first + k - 1, worker%parameters(:, k))
                call put_values(worker%slots, worker%parameters(:, k))
                call make_worker_case(worker, k)
                worker%max_steps(k) = worker%plan%max_steps
                if (worker%plan%exact .and. worker%status(k) == status_ok .and. size(job%events) > 0) then
                    call stop_exactly(worker%cases(k), job%events, job%stop_after, worker%max_steps(k), &
                                      worker%status(k), worker%came(k))
                    if (worker%status(k) /= status_ok) then
                        call worker%note(k)%explain(trim(status_meanings(worker%status(k))))
                    end if
                end if
                worker%lane(k) = 0
                if (worker%status(k) /= status_ok) then
                    worker%values(:, k) = no_values()
                else if (worker%plan%exact) then
                    block%n = block%n + 1
                    worker%lane(k) = block%n
                    call load_lane(worker%cases(k), block, block%n)
                else if (goes_in_batch(job, worker%cases(k), worker%plan)) then
                    call worker%batch%add(worker%cases(k), worker%plan, k)
                else
                    worker%making = worker%making + (seconds() - moment)
                    moment = seconds()
                    call compute_stepping(worker%cases(k), worker%plan, worker%wanted, job%events, job%stop_after, &
                                          worker%values(:, k), worker%status(k), worker%note(k))
                    worker%computing = worker%computing + (seconds() - moment)
                    moment = seconds()
                end if
            end do
            worker%making = worker%making + (seconds() - moment)

            moment = seconds()
            if (any(worker%lane(:n) > 0) .and. kernel_runs(worker%wanted)) then
                call block%compute(any(worker%wanted([group_end, group_energy])), worker%wanted(group_period))
            end if
            if (worker%batch%n > 0) then
                call worker%batch%compute(worker%cases, worker%wanted, worker%values, worker%status, worker%note)
            end if
            do k = 1, n
                if (worker%lane(k) == 0) cycle
                call unload_lane(worker%cases(k), block, worker%lane(k), worker%wanted, worker%max_steps(k), &
                                 worker%values(:, k), worker%status(k), worker%note(k))
                if (worker%status(k) == status_ok .and. .not. worker%came(k)) call worker%note(k)%add(note_no_stop)
            end do
            worker%computing = worker%computing + (seconds() - moment)

            moment = seconds()
            call reserve_rows(job, block_size, rows)
            do k = 1, n
                if (worker%status(k) == status_ok) call complete_note(worker, k)
                call put_row(job, first + k - 1, worker%parameters(:, k), worker%status(k), worker%values(:, k), &
                             worker%note(k), rows)
            end do
            worker%filling = worker%filling + (seconds() - moment)
        end associate
    end subroutine compute_rows

    !> Notes what the k-th case of the block lacks and nothing has told yet.
    subroutine complete_note(worker, k)
        class(sweep_worker_t), intent(inout) :: worker
        integer, intent(in) :: k
        integer :: i
        do i = 1, size(worker%told_last)
            associate (quantity => worker%told_last(i))
                if (.not. is_finite(worker%values(quantity, k))) call note_missing(worker%cases(k), quantity, worker%note(k))
            end associate
        end do
    end subroutine complete_note

    !> Makes the case of the worker's scene, the k-th of the block, and a plan where the last one does not fit it.
    subroutine make_worker_case(worker, k)
        class(sweep_worker_t), intent(inout) :: worker
        integer, intent(in) :: k
        type(problems_t) :: problems

        worker%status(k) = status_ok
        call make_case(worker%scene, worker%cases(k), problems, worker%same_body, worker%same_attitude)
        associate (is_lagrange => worker%cases(k)%body%is_lagrange())
            if (.not. problems%any() .and. worker%same_plan .and. (is_lagrange .eqv. worker%for_lagrange)) return
            ! Plans and problems are made of texts: see `status_names`.
            !$omp critical (texts)
            if (.not. problems%any()) then
                call make_plan(worker%scene, worker%cases(k), worker%plan, problems)
                ! After a plan that failed the next case needs one of its own.
                worker%for_lagrange = is_lagrange .neqv. problems%any()
            end if
            if (problems%any()) then
                worker%status(k) = status_bad_input
                call worker%note(k)%explain(problems%first())
            end if
            !$omp end critical (texts)
        end associate
    end subroutine make_worker_case

end module spintop_sweep_worker
