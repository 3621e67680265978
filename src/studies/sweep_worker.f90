!> One thread's share of a sweep: makes cases, computes them, and writes their rows to memory.
module spintop_sweep_worker
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t, make_case
    use spintop_compare, only: is_finite
    use spintop_exact_block, only: exact_block_t, block_size
    use spintop_job, only: job_t
    use spintop_nutation, only: class_names
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t
    use spintop_plan, only: plan_t, make_plan
    use spintop_problems, only: problems_t
    use spintop_row_block, only: row_block_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_status, only: status_ok, status_bad_input, status_names
    use spintop_sweep_axes, only: put_values
    use spintop_sweep_batch, only: sweep_batch_t, goes_in_batch
    use spintop_sweep_columns, only: sweep_columns, sweep_groups, quantities, group_end, group_energy, &
        group_period, q_motion_class, q_phi_end, q_psi_end
    use spintop_sweep_exact, only: load_lane, unload_lane, kernel_runs, stop_exactly
    use spintop_sweep_quantities, only: no_values, note_no_stop
    use spintop_sweep_stepping, only: compute_stepping
    use spintop_system, only: seconds
    use spintop_text, only: string_t
    use spintop_text_buffer, only: text_buffer_t
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
        type(case_t), private :: case
        type(plan_t), private :: plan
        !> The swept parameters leave the body, or the plan, as it is.
        logical, private :: same_body = .false., same_plan = .false.
        !> Whether the plan was made for a top whose exact motion is known.
        logical, private :: for_lagrange = .false.
        !> Which groups of quantities are wanted.
        logical, private :: wanted(sweep_groups) = .false.
        !> The cases of a block: status, note, quantities, and lane in the block of the exact motion
        !> (0 for cases without).
        type(case_t), private :: cases(block_size)
        integer, private :: status(block_size) = status_ok, lane(block_size) = 0
        type(string_t), private :: note(block_size)
        !> Whether the event came that was to end the motion.
        logical, private :: came(block_size) = .true.
        real(dp), private :: values(quantities, block_size) = 0
        type(exact_block_t), private :: block
        type(sweep_batch_t), private :: batch
        !> Seconds spent on making, computing and formatting cases.
        real(dp) :: making = 0, computing = 0, formatting = 0
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
        worker%scene = job%scene
        call describe_scene(worker%scene, table)
        allocate (worker%slots, source=job%axes%slots_in(table))
        worker%case = job%case
        worker%plan = job%plan
        worker%same_body = .not. job%axes%varies('top')
        worker%same_plan = .not. job%axes%varies('integration')
        worker%for_lagrange = job%case%body%is_lagrange()
        worker%wanted(sweep_columns(job%columns)%group) = .true.
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
                else if (goes_in_batch(job, worker%case, worker%plan)) then
                    call worker%batch%add(worker%case, worker%plan, k)
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
            if (worker%batch%n > 0) then
                call worker%batch%compute(worker%cases, worker%wanted, any(job%columns == q_phi_end .or. &
                    job%columns == q_psi_end), worker%values, worker%status, worker%note)
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
                call rows%text%put_integer(first + k - 1)
                call rows%text%put_reals(job%axes%values_of(first + k - 1))
                call rows%text%put_text(trim(status_names(worker%status(k))))
                call put_quantities(job%columns, worker%values(:, k), rows%text)
                call rows%text%put_text(worker%note(k)%text)
                call rows%text%end_row()
                rows%counts(worker%status(k)) = rows%counts(worker%status(k)) + 1
            end do
            worker%formatting = worker%formatting + (seconds() - moment)
        end associate
    end subroutine compute_rows

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
        class(sweep_worker_t), intent(inout) :: worker
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

end module spintop_sweep_worker
