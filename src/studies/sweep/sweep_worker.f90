!> The work of one thread in a sweep: makes cases, computes them, proves their numbers, and fills their rows. Threads make texts
!> one at a time, as those of `spintop_thread_team` do. The table of a sweep has the columns case, swept parameters, status,
!> quantities, notes.
module spintop_sweep_worker
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_body, only: body_t
    use spintop_case, only: attitude_parameters, case_t, kept_parts_t, make_case
    use spintop_certificate, only: proof_count, proof_of_phi, proof_of_psi, proof_of_theta, proof_reasons, proof_words
    use spintop_differences, only: node_count, nodes_t
    use spintop_effects, only: series_effects
    use spintop_exact_block, only: block_size
    use spintop_job, only: job_t, study_head
    use spintop_kinds, only: dp, is_finite, no_number, is_equal, is_zero
    use spintop_methods, only: exact_info
    use spintop_netcdf_grid, only: netcdf_axis_t
    use spintop_nutation, only: class_names
    use spintop_parameters, only: unset_integer, is_set
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_process, only: processor_seconds, seconds
    use spintop_row_block, only: row_block_t
    use spintop_row_proof, only: row_proof_t, wanted_proofs
    use spintop_row_table, only: row_table_t
    use spintop_scene_keys, only: combine_grid, scene_t, combine_zip
    use spintop_sensitivity, only: other_accuracies, other_value, set_other_accuracy
    use spintop_statistics_output, only: result_columns
    use spintop_statistics_table, only: statistics_table_t
    use spintop_status, only: is_good_end, status_names, status_non_finite, is_ok, status_bad_input, status_ok
    use spintop_study_column, only: always, proof_group, study_column_t
    use spintop_sweep_axes, only: case_scene_t
    use spintop_sweep_quantities, only: slot_t, engine_entry_t, lacks_motion, lacks_nothing, lacks_perturbations, &
        run_engines, task_t, explain_missing, set_threshold
    use spintop_sweep_exact, only: sweep_exact_t
    use spintop_sweep_lanes, only: sweep_lanes_t
    use spintop_sweep_one_by_one, only: sweep_stepping_t, perturbations_t
    use spintop_sweep_result, only: at_motion_class, at_proof, note_names, note_no_turns_known, proof_cells, &
        at_nutation_period, at_theta_end, at_phi_end, at_psi_end, at_t_end, at_theta_end_bound, at_phi_end_bound, &
        at_psi_end_bound, note_t, asks_for_span, of_proof, of_threshold, sweep_result_t, work_for, note_no_derivative
    use spintop_table_column, only: column_of_integers, column_of_notes, status_column, table_column_t
    use spintop_table_head, only: shard_t
    use spintop_thread_team, only: work_of_computing, work_of_formatting, work_of_making, block_worker_t
    use spintop_uncertainties, only: data_radii
    implicit none
    private
    public :: describe_table, describe_columns, cells_of_row, sweep_worker_t, size_of_block, prove_case, sweep_rows_t

    !> Name of the column with the number of the case.
    character(*), parameter :: case_column = 'case'

    !> The quantities of sweeps that have bounds, and the places of these.
    integer, parameter :: quantities(3) = [proof_of_theta, proof_of_phi, proof_of_psi], &
        bounds(3) = [at_theta_end_bound, at_phi_end_bound, at_psi_end_bound]

    !> Cases per block if each is expensive, and in closed form, where few enough stay in the second cache. Otherwise a block has as
    !> many as there is room for.
    integer, parameter :: block_of_stepping = 16, block_of_tops = 128

    !> Kinds of body, for each of which there is a plan: symmetric tops and free bodies, which have a closed form,
    !> others without damping, with damping, with effects, with effects without series.
    integer, parameter :: symmetric_top = 1, free_body = 2, undamped = 3, damped = 4, affected = 5, &
        without_series = 6, kinds_of_body = without_series

    !> What is known of a case at first. A constant, as the value of a constructor is copied twice.
    type(sweep_result_t), parameter :: nothing = sweep_result_t()

    !> Number of engines, and which of them computes cases one by one.
    integer, parameter :: engine_count = 4, stepping = 3

    !> The plan for bodies of one kind.
    type :: kept_plan_t
        logical :: is_made = .false.
        type(plan_t) :: plan
        !> Why there is no such plan; not allocated if there is one.
        character(:), allocatable :: problem
    end type kept_plan_t

    !> Data of a thread for making and computing cases.
    type :: sweep_worker_t
        type(case_scene_t), private :: swept
        !> What is asked of the cases, and those who compute it.
        type(task_t), private :: task
        type(engine_entry_t), allocatable, private :: engines(:)
        !> The cases of a block, each of which overwrites one of the last block and keeps what does not change.
        type(slot_t), allocatable, private :: slots(:)
        !> The plans of the kinds of body; where plans differ from case to case, those of the slots.
        type(kept_plan_t), allocatable, private :: plans(:)
        integer, private :: kind_of_first = symmetric_top
        !> Whether the body, or the plans, are the same in all cases.
        logical, private :: same_body = .false., same_plans = .false.
        !> Whether nothing depends on a span in nutations.
        logical, private :: skips_nutations = .false.
        !> Which quantities are to be proved.
        logical, private :: proofs(proof_count) = .false.
        !> Values of the swept parameters of each case, one per axis; and the last axis on which the attitude depends, 0 if it
        !> is the same in all cases.
        real(dp), allocatable, private :: parameters(:, :)
        integer, private :: last_of_attitude = 0
        !> Time of the processor for making and computing the cases of the last block, and for formatting their rows, s.
        real(dp) :: costs(work_of_formatting) = 0
    contains
        procedure :: prepare
        procedure :: compute_rows
    end type sweep_worker_t

    !> A sweep over nodes of a case: the axes of the sweep of the table, then the other keys. It must stay where it was prepared,
    !> and be a target there. A class is copied and freed by a procedure of its own; for a type gfortran writes out all that is
    !> in it at each place. But gfortran 14 has two jobs on the stack where one is allocated as a class.
    type :: node_sweep_t
        type(job_t), allocatable :: job
        class(sweep_worker_t), allocatable :: worker
        type(row_block_t) :: rows
        integer :: cases_of_block = 1
        !> Quantities at the nodes of the keys.
        real(dp), allocatable :: values(:, :, :)
    contains
        procedure :: prepare => prepare_nodes
        procedure :: compute => compute_nodes
    end type node_sweep_t

    !> Data of a thread; it must stay where it was prepared, and be a target there.
    type, extends(block_worker_t) :: sweep_rows_t
        type(job_t), pointer, private :: job => null()
        type(sweep_worker_t), private :: worker
        !> The sweep over the nodes of the keys of derivatives, and the same with other accuracies, in which the error of the method
        !> shows.
        class(node_sweep_t), allocatable, private :: own, other(:)
        !> The axis of each key in these sweeps.
        integer, allocatable, private :: axis(:)
        !> The difference on which each derivative rests.
        integer, allocatable, private :: best(:)
        !> The nodes of the keys, and which of them are needed.
        type(nodes_t), allocatable, private :: nodes(:)
        logical, allocatable, private :: is_needed(:, :)
    contains
        procedure :: prepare => prepare_rows
        procedure :: compute_rows => compute_all_rows
    end type sweep_rows_t

contains

    !> The table of a job in its format, not yet started, and its header as text: tables with equal headers
    !> are equal. The header of a part is the header of the whole, after a line that names the part.
    subroutine describe_table(job, shard, table, head)
        type(job_t), intent(in) :: job !! the job
        type(shard_t), intent(in) :: shard !! the part
        class(row_table_t), allocatable, intent(out) :: table !! not yet started
        character(:), allocatable, intent(out) :: head !! the header
        type(statistics_table_t), allocatable :: with_statistics
        type(table_column_t), allocatable :: columns(:)
        integer :: i

        if (job%statistics%is_wanted) then
            allocate (with_statistics)
            with_statistics%keeps_rows = job%keeps_rows()
            with_statistics%plan = job%statistics
            with_statistics%is_part = shard%is_part()
            with_statistics%result_path = job%files%table
            if (job%keeps_rows()) with_statistics%result_path = job%files%statistics
            ! In a variable, since gfortran 12 fails at the result of a function as an argument of a class.
            allocate (columns, source=result_columns(with_statistics%plan))
            with_statistics%result_head = study_head(job, columns, part=shard%line(job%axes%cases))
            if (.not. job%keeps_rows()) head = with_statistics%result_head
            call move_alloc(with_statistics, table)
        else
            allocate (row_table_t :: table)
        end if
        call describe_columns(job, table%columns)
        if (job%input%scene%format == 'netcdf' .and. job%keeps_rows()) then
            allocate (table%netcdf)
            table%netcdf%axes = [netcdf_axis_t(case_column, int(job%axes%cases))]
            if (job%axes%combination == combine_grid) table%netcdf%axes = &
                [(netcdf_axis_t(job%axes%axis(i)%name, job%axes%axis(i)%count), i=1, size(job%axes%axis))]
            if (job%input%scene%compression /= unset_integer) table%netcdf%compression = job%input%scene%compression
        end if
        if (job%keeps_rows()) head = study_head(job, table%columns, part=shard%line(job%axes%cases))
    end subroutine describe_table

    !> What the cells of a row are; `add_rows` has them in this order.
    subroutine describe_columns(job, columns)
        type(job_t), intent(in) :: job !! the job
        type(table_column_t), allocatable, intent(out) :: columns(:) !! one for each cell
        integer :: i, axes

        axes = size(job%axes%axis)
        allocate (columns(cells_of_row(job)))
        columns(1) = table_column_t(case_column, '', 'number of the case', column_of_integers)
        do i = 1, axes
            columns(1 + i)%column_t = job%axis_column(i)
            if (job%axes%combination == combine_grid) columns(1 + i)%axis = i
        end do
        columns(axes + 2) = table_column_t(status_column, '', 'ok, or the reason of the failure')
        call columns(axes + 2)%set_words([status_names])
        do i = 1, size(job%columns)
            associate (source => job%columns(i)%source, column => columns(axes + 2 + i))
                column%column_t = job%columns(i)%column_t
                if (source == at_motion_class) call column%set_words([character(len(class_names)) :: 'none', class_names])
                if (source == at_proof) call column%set_words(proof_cells)
            end associate
        end do
        columns(size(columns) - 2 * job%sensitivities%count:size(columns) - 1)%column_t = job%sensitivities%table_columns()
        columns(size(columns)) = table_column_t('notes', '', 'reasons why quantities do not exist')
        call columns(size(columns))%set_words(note_names, column_of_notes)
    end subroutine describe_columns

    !> Cells of a row: number of the case, swept parameters, status, quantities, sensitivities, notes.
    pure integer function cells_of_row(job) result(cells)
        type(job_t), intent(in) :: job !! the job
        cells = size(job%axes%axis) + size(job%columns) + 2 * job%sensitivities%count + 3
    end function cells_of_row

    !> Adds the rows of cases to a block. What a case does not have is a NaN with a note; what overflowed is a
    !> failure.
    subroutine add_rows(columns, first, parameters, slots, rows)
        type(study_column_t), intent(in) :: columns(:) !! the columns
        integer(int64), intent(in) :: first !! number of the first case
        real(dp), intent(in) :: parameters(:, :) !! the swept ones of each case
        type(slot_t), intent(inout) :: slots(:) !! the cases of the block
        type(row_block_t), intent(inout) :: rows !! the rows of the block
        real(dp) :: sizes(size(columns))
        logical :: is_infinite
        integer :: place(size(columns)), i, k, axes, final_status

        sizes = columns%size
        axes = size(parameters, 1)
        place = columns%source
        associate (cells => rows%cells(:, rows%rows + 1:rows%rows + size(slots)))
            do k = 1, size(slots)
                associate (slot => slots(k), values => cells(axes + 3:axes + 2 + size(columns), k))
                    final_status = slot%status
                    values = slot%result%of(place) / sizes
                    if (is_good_end(final_status) .and. .not. all(abs(values) <= huge(values))) then
                        ! It is a failure where a quantity is infinite, or one undefined that every case has; an infinite bound
                        ! says itself what it is. What else the case lacks is noted.
                        do i = 1, size(columns)
                            if (is_finite(values(i))) cycle
                            is_infinite = abs(values(i)) > huge(values)
                            if (columns(i)%group == proof_group .and. is_infinite) cycle
                            if (columns(i)%missing > 0) call explain_missing(columns(i)%missing, slot%case, slot%note)
                            if (columns(i)%group == proof_group) cycle
                            if (is_infinite .or. columns(i)%is(always)) final_status = status_non_finite
                        end do
                    end if
                    cells(1, k) = real(first + k - 1, dp)
                    cells(2:axes + 1, k) = parameters(:, k)
                    cells(axes + 2, k) = final_status
                    cells(size(cells, 1), k) = slot%note%flags
                    if (slot%note%has(note_no_turns_known)) rows%doubtful = rows%doubtful + 1
                    rows%rows = rows%rows + 1
                    call rows%set_note(slot%note%text)
                    rows%counts(final_status) = rows%counts(final_status) + 1
                end associate
            end do
        end associate
    end subroutine add_rows

    !> Number of cases in a block of a sweep.
    integer function size_of_block(job)
        type(job_t), target, intent(in) :: job !! the job
        type(engine_entry_t) :: engines(engine_count)
        type(slot_t) :: first
        type(task_t) :: task
        integer :: i
        call make_engines(engines)
        first%case = job%case
        first%plan => job%plan
        task = task_of(job)
        size_of_block = block_of_stepping
        do i = stepping - 1, 1, -1
            if (engines(i)%engine%takes(first, task)) size_of_block = merge(block_of_tops, block_size, i == 1)
        end do
    end function size_of_block

    !> What a job asks of its cases.
    type(task_t) function task_of(job) result(task)
        type(job_t), intent(in) :: job
        task = task_t(work_for(job%columns), job%events, job%stop_after)
    end function task_of

    !> Makes the engines, in the order in which they are asked.
    subroutine make_engines(engines)
        type(engine_entry_t), intent(out) :: engines(engine_count)
        allocate (sweep_exact_t :: engines(1)%engine)
        allocate (sweep_lanes_t :: engines(2)%engine)
        allocate (sweep_stepping_t :: engines(stepping)%engine)
        allocate (perturbations_t :: engines(4)%engine)
        engines(4)%engine%gives = lacks_perturbations
    end subroutine make_engines

    !> Makes the scene, the slots and the plan of the thread.
    subroutine prepare(worker, job)
        class(sweep_worker_t), target, intent(inout) :: worker !! prepared for the job
        type(job_t), target, intent(in) :: job !! the job
        integer :: k

        call worker%swept%copy(job%input%scene, job%axes)
        worker%same_body = .not. (job%axes%varies('top') .or. job%axes%varies('part') .or. job%axes%varies('effects'))
        worker%last_of_attitude = job%axes%last_of(attitude_parameters)
        worker%same_plans = .not. job%axes%varies('integration')
        ! Not on the stack, which may be small.
        allocate (worker%slots(block_size), worker%engines(engine_count))
        do k = 1, block_size
            worker%slots(k)%case = job%case
        end do
        call make_engines(worker%engines)
        allocate (worker%parameters(size(job%axes%axis), block_size))
        allocate (worker%plans(merge(kinds_of_body, block_size, worker%same_plans)))
        worker%kind_of_first = kind_of(job%case%body)
        if (worker%same_plans) worker%plans(worker%kind_of_first) = kept_plan_t(.true., job%plan)
        worker%task = task_of(job)
        associate (wanted => worker%task%wanted)
            worker%skips_nutations = job%plan%exact .and. size(job%events) == 0 .and. .not. asks_for_span(wanted) &
                                     .and. .not. wanted(of_proof)
        end associate
        worker%proofs = wanted_proofs(job%columns%quantity(), job%input%scene%certified, '_end')
    end subroutine prepare

    !> Rows of the cases from `first` to `last`, at most `block_size`.
    subroutine compute_rows(worker, job, first, last, rows)
        class(sweep_worker_t), target, intent(inout) :: worker !! data of the thread
        type(job_t), intent(in) :: job !! the job
        integer(int64), intent(in) :: first, last !! first and last case
        type(row_block_t), intent(inout) :: rows !! the rows of the cases
        type(note_t) :: note
        real(dp) :: began, moments(0:work_of_formatting), spent(work_of_formatting)
        integer :: k, n

        began = processor_seconds()
        moments(0) = seconds()
        n = int(last - first + 1)
        call job%axes%find_block(first, worker%parameters(:, :n))
        do k = 1, n
            call begin_case(worker, job, k)
        end do
        moments(work_of_making) = seconds()
        associate (slots => worker%slots(:n))
            call run_engines(worker%engines, slots, worker%task)
            do k = 1, merge(n, 0, worker%skips_nutations .and. is_set(job%input%scene%nutations))
                ! A case without a period, of which its span is a number, is refused.
                if (.not. is_ok(slots(k)%status) .or. is_finite(slots(k)%result%of(at_nutation_period))) cycle
                note = slots(k)%note
                call slots(k)%note%clear()
                call worker%swept%set_values(worker%parameters(:, k))
                call make_worker_case(worker, job, k, kept_parts_t(worker%same_body))
                if (is_ok(slots(k)%status)) then
                    slots(k)%note = note
                else
                    slots(k)%result = nothing
                end if
            end do
            if (any(worker%proofs)) then
                do k = 1, n
                    if (is_good_end(slots(k)%status)) call prove_case(slots(k), worker%proofs, job%input%scene)
                end do
            end if
            moments(work_of_computing) = seconds()
            call rows%reserve(cells_of_row(job), block_size)
            call add_rows(job%columns, first, worker%parameters(:, :n), slots, rows)
        end associate
        moments(work_of_formatting) = seconds()
        ! The time of the processor takes a call of the system, which may cost as much as a case: it is asked for once a block.
        spent = moments(1:) - moments(:work_of_formatting - 1)
        worker%costs = spent * ((processor_seconds() - began) / max(sum(spent), tiny(began)))
    end subroutine compute_rows

    !> Makes the k-th case of the block.
    subroutine begin_case(worker, job, k)
        class(sweep_worker_t), target, intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer, intent(in) :: k
        logical :: keeps_attitude
        integer :: first !! the first axis whose value is not that of the case before

        first = 1
        if (k > 1) then
            do while (first < size(worker%parameters, 1))
                if (.not. is_equal(worker%parameters(first, k), worker%parameters(first, k - 1))) exit
                first = first + 1
            end do
        end if
        associate (slot => worker%slots(k))
            call slot%note%clear()
            slot%result = nothing
            slot%growth_until = 0
            call worker%swept%set_values(worker%parameters(:, k), first)
            ! The attitude of the case before is at hand, if that is the one.
            keeps_attitude = worker%last_of_attitude == 0
            if (k > 1 .and. first > worker%last_of_attitude .and. .not. keeps_attitude) then
                if (is_ok(worker%slots(k - 1)%status)) then
                    slot%case%given_start = worker%slots(k - 1)%case%given_start
                    slot%case%circular = worker%slots(k - 1)%case%circular
                    keeps_attitude = .true.
                end if
            end if
            call make_worker_case(worker, job, k, kept_parts_t(worker%same_body, keeps_attitude, worker%skips_nutations))
            slot%lacks = merge(lacks_motion, lacks_nothing, is_ok(slot%status))
            if (.not. is_ok(slot%status)) return
            slot%max_steps = slot%plan%max_steps
            if (worker%task%wanted(of_threshold)) call set_threshold(slot)
        end associate
    end subroutine begin_case

    !> Makes the k-th case of the block from the scene of the worker, and the plan for it if there is none yet.
    subroutine make_worker_case(worker, job, k, kept)
        class(sweep_worker_t), target, intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer, intent(in) :: k
        type(kept_parts_t), intent(in) :: kept !! parts that the case has
        type(problems_t) :: problems
        type(case_t), allocatable :: one_of_kind ! large, and mostly not needed
        integer :: outside, place

        associate (slot => worker%slots(k))
            slot%status = status_bad_input
            outside = job%axes%out_of_range(worker%parameters(:, k))
            if (outside == 0) call make_case(worker%swept%scene, slot%case, problems, kept)
            if (outside > 0 .or. problems%any()) then
                !$omp critical (queue)
                if (outside == 0) then
                    call slot%note%explain(problems%first())
                else
                    associate (axis => job%axes%axis(outside))
                        call slot%note%explain(axis%name // ' ' // axis%slot%refusal(worker%parameters(outside, k)))
                    end associate
                end if
                !$omp end critical (queue)
                return
            end if
            place = k
            if (worker%same_plans) then
                place = worker%kind_of_first
                if (.not. worker%same_body) place = kind_of(slot%case%body)
            end if
            associate (known => worker%plans(place))
                if (.not. (known%is_made .and. worker%same_plans)) then
                    ! A plan that is kept for later cases depends on nothing else of this one than its kind of body: rows do not
                    ! depend on the cases that the thread had before.
                    one_of_kind = slot%case
                    if (worker%same_plans) one_of_kind%t_end = job%case%t_end
                    known%is_made = .true.
                    if (allocated(known%problem)) deallocate (known%problem)
                    !$omp critical (queue)
                    call make_plan(worker%swept%scene, one_of_kind, known%plan, problems)
                    if (problems%any()) known%problem = problems%first()
                    !$omp end critical (queue)
                end if
                slot%plan => worker%plans(place)%plan
                if (.not. allocated(known%problem)) slot%status = status_ok
                if (allocated(known%problem)) call slot%note%explain(known%problem)
            end associate
        end associate
    end subroutine make_worker_case

    !> The kind of a body.
    pure integer function kind_of(body) result(kind)
        type(body_t), intent(in) :: body
        kind = damped
        if (all(is_zero(body%damping))) kind = merge(free_body, undamped, body%is_free())
        if (body%is_lagrange()) kind = symmetric_top
        if (allocated(body%effects)) kind = merge(affected, without_series, body%effects%only(series_effects))
    end function kind_of

    !> Bounds of the wanted numbers of a case, which has ended well. What the case does not have needs no proof.
    subroutine prove_case(slot, wanted, scene)
        type(slot_t), intent(inout) :: slot !! a case, and what is known of it
        logical, intent(in) :: wanted(proof_count) !! which quantities are to be proved
        type(scene_t), intent(in) :: scene !! contents of the input
        type(row_proof_t) :: proof
        real(dp) :: printed(proof_count)

        associate (case => slot%case, values => slot%result)
            printed = 0
            printed(quantities) = [values%of(at_theta_end), values%of(at_phi_end), values%of(at_psi_end)]
            call proof%open(wanted .and. is_finite(printed), scene%certified, case%given_body, case%given_start, &
                            data_radii(scene))
            call proof%prove(merge(values%of(at_t_end), case%t_end, is_finite(values%of(at_t_end))), printed)
            call proof%close()
            if (scene%certified) then
                values%of(at_theta_end) = printed(proof_of_theta)
                values%of(at_phi_end) = printed(proof_of_phi)
                values%of(at_psi_end) = printed(proof_of_psi)
            end if
            where (proof%wanted(quantities)) values%of(bounds) = proof%bounds(quantities)
            values%of(at_proof) = findloc(proof_cells, proof_words(merge(1, 0, proof%is_proved())), dim=1) - 1
            if (.not. proof%is_proved()) call slot%note%explain('unproved: ' // trim(proof_reasons(proof%outcome())))
        end associate
    end subroutine prove_case

    !> Makes what the thread needs. It makes many texts, which only one thread at a time may do: see `status_names`.
    subroutine prepare_rows(self, job)
        class(sweep_rows_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        integer :: i, n

        self%job => job
        call self%worker%prepare(job)
        if (job%sensitivities%count == 0) return
        n = size(job%axes%axis)
        associate (wanted => job%sensitivities)
            self%axis = wanted%keys%axis
            do i = 1, size(self%axis)
                if (self%axis(i) > 0) cycle
                n = n + 1
                self%axis(i) = n
            end do
            allocate (self%best(wanted%count))
            allocate (self%nodes(size(self%axis)), self%is_needed(node_count, size(self%axis)))
        end associate
        allocate (self%own)
        call self%own%prepare(job, self%axis, n)
        if (job%input%scene%method == exact_info%name) return
        allocate (self%other(other_accuracies))
        do i = 1, other_accuracies
            call self%other(i)%prepare(job, self%axis, n, accuracy=i)
        end do
    end subroutine prepare_rows

    !> Computes the rows of some cases, and the derivatives in them. What has no derivative is NaN, with a note.
    subroutine compute_all_rows(self, first, last, rows)
        class(sweep_rows_t), target, intent(inout) :: self
        integer(int64), intent(in) :: first, last !! first and last case, at most those of a block
        type(row_block_t), intent(inout) :: rows !! their rows
        type(note_t) :: note
        real(dp) :: began
        integer :: k, axes, before

        call self%worker%compute_rows(self%job, first, last, rows)
        self%costs = self%costs + self%worker%costs
        if (self%job%sensitivities%count == 0) return
        began = processor_seconds()
        axes = size(self%job%axes%axis)
        before = axes + 2 + size(self%job%columns)
        do k = 1, rows%rows
            associate (cells => rows%cells(before + 1:before + 2 * self%job%sensitivities%count, k))
                cells = no_number
                if (.not. is_good_end(nint(rows%cells(axes + 2, k)))) cycle
                call find_derivatives(self, self%job, rows%cells(2:axes + 1, k), cells)
                if (all(abs(cells(1::2)) <= huge(1.0_dp))) cycle
            end associate
            associate (flags => rows%cells(size(rows%cells, 1), k))
                note = note_t(nint(flags))
                if (note%has(note_no_derivative)) cycle
                if (allocated(rows%notes(k)%text)) note%text = rows%notes(k)%text
                call note%add(note_no_derivative)
                flags = note%flags
            end associate
            rows%notes(k)%text = note%text
        end do
        self%costs(work_of_computing) = self%costs(work_of_computing) + (processor_seconds() - began)
    end subroutine compute_all_rows

    !> Makes the sweep over the nodes.
    subroutine prepare_nodes(self, job, axis, axes, accuracy)
        class(node_sweep_t), target, intent(inout) :: self
        type(job_t), target, intent(in) :: job !! the job
        integer, intent(in) :: axis(:), axes !! the axis of each key, and the number of axes
        integer, intent(in), optional :: accuracy !! the number of another accuracy than that of the job
        type(problems_t) :: problems
        integer :: i

        allocate (self%job, self%worker)
        associate (own => self%job, wanted => job%sensitivities)
            own%input%scene = job%input%scene
            own%input%scene%certified = .false.
            own%case = job%case
            own%plan = job%plan
            if (present(accuracy)) then
                call set_other_accuracy(own%input%scene, job%plan, accuracy, keeps_rows=.false.)
                call make_plan(own%input%scene, own%case, own%plan, problems)
            end if
            own%events = job%events
            own%stop_after = job%stop_after
            own%columns = wanted%columns()
            allocate (own%axes%axis(axes))
            do i = 1, size(job%axes%axis)
                own%axes%axis(i)%key = job%axes%axis(i)%key
                own%axes%axis(i)%whole = job%axes%axis(i)%whole
                own%axes%axis(i)%slot = job%axes%axis(i)%slot
            end do
            do i = 1, size(axis)
                own%axes%axis(axis(i))%key = wanted%keys(i)%name
                own%axes%axis(axis(i))%slot = wanted%keys(i)%slot
            end do
            own%axes%combination = combine_zip
            own%axes%cases = size(axis) * node_count
            do i = 1, axes
                own%axes%axis(i)%count = int(own%axes%cases)
                allocate (own%axes%axis(i)%listed(own%axes%axis(i)%count), source=0.0_dp)
            end do
            allocate (self%values(size(own%columns), node_count, size(axis)))
        end associate
        call self%worker%prepare(self%job)
        self%cases_of_block = size_of_block(self%job)
    end subroutine prepare_nodes

    !> Finds the derivatives of a case, each followed by the estimate of its error.
    subroutine find_derivatives(self, job, parameters, cells)
        class(sweep_rows_t), target, intent(inout) :: self
        type(job_t), intent(in) :: job
        real(dp), intent(in) :: parameters(:) !! the values of the axes of the sweep in that case
        real(dp), intent(inout) :: cells(:)
        real(dp), allocatable :: others(:, :, :)
        real(dp) :: relative
        integer :: i, k

        associate (wanted => job%sensitivities, keys => job%sensitivities%keys)
            do i = 1, size(keys)
                if (keys(i)%axis == 0) then
                    self%nodes(i) = keys(i)%nodes(keys(i)%slot%get())
                else
                    self%nodes(i) = keys(i)%nodes(parameters(keys(i)%axis) * job%axes%axis(keys(i)%axis)%slot%size)
                end if
                self%is_needed(:, i) = self%nodes(i)%is_valid
            end do
            call self%own%compute(self%nodes, self%is_needed, self%axis, parameters)
            self%is_needed = .false.
            do i = 1, size(keys)
                call wanted%differentiate(i, self%nodes(i), self%own%values(:, :, i), cells, self%best, self%is_needed(:, i))
            end do
            if (.not. (allocated(self%other) .and. any(self%best > 0))) return
            relative = 1
            if (allocated(job%plan%stepper)) relative = job%plan%stepper%controls%relative_tolerance
            i = findloc([(job%axes%axis(i)%name == 'integration.relative_tolerance', i=1, size(parameters))], .true., dim=1)
            if (i > 0) relative = parameters(i)
            do k = 1, other_accuracies
                call self%other(k)%compute(self%nodes, self%is_needed, self%axis, [(other_value(job%axes%axis(i)%name, &
                    parameters(i), relative, k), i=1, size(parameters))])
            end do
            allocate (others(size(self%own%values, 1), node_count, other_accuracies))
            do i = 1, size(keys)
                do k = 1, other_accuracies
                    others(:, :, k) = self%other(k)%values(:, :, i)
                end do
                call wanted%add_changes(i, self%nodes(i), self%own%values(:, :, i), others, self%best, cells)
            end do
        end associate
    end subroutine find_derivatives

    !> Computes the quantities of a case at the nodes that are needed. They are NaN at the others.
    subroutine compute_nodes(self, nodes, is_needed, axis, parameters)
        class(node_sweep_t), target, intent(inout) :: self
        type(nodes_t), intent(in) :: nodes(:) !! of each key
        logical, intent(in) :: is_needed(:, :) !! which of them
        integer, intent(in) :: axis(:) !! the axis of each key
        real(dp), intent(in) :: parameters(:) !! the values of the axes of the sweep in that case
        integer :: place(2, size(is_needed)), i, n, first, last, row, cells_before

        self%values = no_number
        n = 0
        associate (axes => self%job%axes)
            do i = 1, size(axis)
                do row = 1, node_count
                    if (.not. is_needed(row, i)) cycle
                    n = n + 1
                    place(:, n) = [row, i]
                end do
            end do
            do i = 1, size(parameters)
                axes%axis(i)%listed(:n) = parameters(i)
            end do
            ! Every key has its value in the nodes of the others.
            do i = 1, size(axis)
                axes%axis(axis(i))%listed(:n) = nodes(i)%x(1)
            end do
            do i = 1, n
                axes%axis(axis(place(2, i)))%listed(i) = nodes(place(2, i))%x(place(1, i))
            end do
            cells_before = size(axes%axis) + 2
        end associate
        do first = 1, n, self%cases_of_block
            last = min(first + self%cases_of_block - 1, n)
            call self%worker%compute_rows(self%job, int(first, int64), int(last, int64), self%rows)
            do row = 1, self%rows%rows
                if (.not. is_good_end(nint(self%rows%cells(cells_before, row)))) cycle
                associate (to => place(:, first + row - 1))
                    self%values(:, to(1), to(2)) = self%rows%cells(cells_before + 1:cells_before + size(self%values, 1), row)
                end associate
            end do
        end do
    end subroutine compute_nodes

end module spintop_sweep_worker
