!> The work of one thread in a sweep: makes cases, computes them, and fills their rows.
module spintop_sweep_worker
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_clock, only: processor_seconds, seconds
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_body_of_scene, only: is_set
    use spintop_case, only: attitude_parameters, case_t, kept_parts_t, make_case
    use spintop_certificate, only: proof_count
    use spintop_compare, only: is_finite, is_zero
    use spintop_exact_block, only: exact_block_t, block_size
    use spintop_job, only: job_t
    use spintop_motion, only: motion_t
    use spintop_plan, only: plan_t, make_plan
    use spintop_problems, only: problems_t
    use spintop_regular_start, only: rates_describe
    use spintop_row_block, only: row_block_t
    use spintop_status, only: is_good_end, status_bad_input, status_meanings, status_ok
    use spintop_sweep_axes, only: axes_t, swept_scene_t
    use spintop_sweep_batch, only: sweep_batch_t, goes_in_batch
    use spintop_sweep_column, only: sweep_column_t
    use spintop_sweep_columns, only: sweep_columns, work_for
    use spintop_sweep_exact, only: load_lane, unload_lane, kernel_runs, stop_exactly
    use spintop_sweep_free, only: goes_in_free_block, sweep_free_t
    use spintop_sweep_notes, only: note_t, note_no_stop
    use spintop_sweep_proof, only: prove_case, sweep_proofs
    use spintop_sweep_result, only: asks_for_span, kinds_of_work, of_details, of_end, of_energy, of_nutation, of_period, of_proof, &
        sweep_result_t
    use spintop_sweep_stability, only: put_perturbations
    use spintop_sweep_stepping, only: compute_stepping
    use spintop_sweep_table, only: cells_of_row, put_rows
    implicit none
    private
    public :: sweep_worker_t, size_of_block, making, computing, filling

    !> Cases per block if each is expensive. Otherwise a block has as many cases as the exact solution
    !> computes at once.
    integer, parameter :: block_of_stepping = 16

    !> Kinds of body, for each of which there is a plan: symmetric tops and free bodies, which have a closed form,
    !> others without damping, with damping, with effects.
    integer, parameter :: symmetric_top = 1, free_body = 2, undamped = 3, damped = 4, affected = 5

    !> The plan for bodies of one kind.
    type :: kept_plan_t
        logical :: is_made = .false.
        type(plan_t) :: plan
        !> Why there is no such plan; not allocated if there is one.
        character(:), allocatable :: problem
    end type kept_plan_t

    !> What is done with a case, of which the costs are counted.
    integer, parameter :: making = 1, computing = 2, filling = 3

    !> Data of a thread for making and computing cases.
    type :: sweep_worker_t
        type(swept_scene_t), private :: swept
        type(kept_plan_t), private :: plans(affected)
        !> Whether the body, the attitude at the start, or the plans are the same in all cases.
        logical, private :: same_body = .false., same_attitude = .false., same_plans = .false.
        !> Whether nothing depends on a span in nutations.
        logical, private :: skips_nutations = .false.
        !> Selected groups of quantities.
        logical, private :: wanted(kinds_of_work) = .false.
        !> Which quantities are to be proved.
        logical, private :: proofs(proof_count) = .false.
        !> The columns of the table.
        type(sweep_column_t), allocatable, private :: columns(:)
        !> The cases of a block, each of which overwrites one of the last block and keeps what does not
        !> change; status, note, quantities, and lane in the block of the exact solution (0 if there is none).
        type(case_t), allocatable, private :: cases(:)
        integer, allocatable, private :: status(:), lane(:)
        !> The kind of body of each case.
        integer, allocatable, private :: kind(:)
        type(note_t), allocatable, private :: note(:)
        !> Remaining work of each case, in steps.
        integer(int64), allocatable, private :: max_steps(:)
        !> Whether the event that ends the motion occurred.
        logical, allocatable, private :: came(:)
        !> Values of the swept parameters of each case, one per axis; the first axis whose value is not that of the case
        !> before; and the first of the last axes on which the attitude does not depend.
        real(dp), allocatable, private :: parameters(:, :)
        integer, allocatable, private :: changed(:)
        integer, private :: first_without_attitude = 1
        type(sweep_result_t), allocatable, private :: values(:)
        type(exact_block_t), allocatable, private :: block
        type(sweep_batch_t), private :: batch
        type(sweep_free_t), private :: free
        !> Time of the processor for making and computing cases, and for filling their rows, s.
        real(dp) :: costs(filling) = 0
        !> The same of the block, as elapsed time, and since when time was not yet counted.
        real(dp), private :: spent(filling) = 0, since = 0
    contains
        procedure :: prepare
        procedure :: compute_rows
    end type sweep_worker_t

contains

    !> Number of cases in a block of a sweep.
    integer function size_of_block(job)
        type(job_t), intent(in) :: job !! the job
        type(sweep_column_t), allocatable :: known(:)
        allocate (known, source=sweep_columns())
        size_of_block = merge(block_size, block_of_stepping, job%plan%exact &
                              .or. goes_in_batch(job, job%case, job%plan, work_for(known(job%columns))))
    end function size_of_block

    !> Makes the scene, the case and the plan of the thread.
    subroutine prepare(worker, job)
        class(sweep_worker_t), target, intent(inout) :: worker !! prepared for the job
        type(job_t), target, intent(in) :: job !! the job
        type(sweep_column_t), allocatable :: known(:)
        call worker%swept%copy(job%scene, job%axes)
        ! Not on the stack, which may be small.
        allocate (worker%cases(block_size), source=job%case)
        allocate (worker%status(block_size), worker%lane(block_size), worker%came(block_size), worker%max_steps(block_size))
        allocate (worker%kind(block_size), source=kind_of(job%case%body))
        allocate (worker%parameters(size(job%axes%axis), block_size), worker%values(block_size))
        allocate (worker%note(block_size), worker%block, worker%changed(block_size))
        worker%status = status_ok
        worker%lane = 0
        worker%came = .true.
        worker%parameters = 0
        worker%plans(kind_of(job%case%body)) = kept_plan_t(.true., job%plan)
        worker%same_body = .not. (job%axes%varies('top') .or. job%axes%varies('part') .or. job%axes%varies('effects'))
        worker%same_attitude = .not. job%axes%varies_any(attitude_parameters)
        worker%first_without_attitude = find_first_without_attitude(job%axes)
        worker%same_plans = .not. job%axes%varies('integration')
        allocate (known, source=sweep_columns())
        worker%columns = known(job%columns)
        worker%wanted = work_for(worker%columns)
        worker%skips_nutations = job%plan%exact .and. size(job%events) == 0 .and. .not. asks_for_span(worker%wanted) &
                                 .and. .not. worker%wanted(of_proof)
        worker%proofs = sweep_proofs(worker%columns, job%scene%certified)
    end subroutine prepare

    !> The first of the last axes on which the attitude does not depend.
    pure integer function find_first_without_attitude(axes) result(first)
        type(axes_t), intent(in) :: axes
        integer :: i
        first = 1
        do i = 1, size(axes%axis)
            associate (name => axes%axis(i)%name)
                if (any(attitude_parameters == name(:index(name // '(', '(') - 1))) first = i + 1
            end associate
        end do
    end function find_first_without_attitude

    !> Rows of the cases from `first` to `last`, at most `block_size`. Cases with a closed form are computed
    !> together, and so are bodies in lanes. The others are computed one by one when
    !> they are made, while their plan exists.
    subroutine compute_rows(worker, job, first, last, rows)
        class(sweep_worker_t), target, intent(inout) :: worker !! data of the thread
        type(job_t), intent(in) :: job !! the job
        integer(int64), intent(in) :: first, last !! first and last case
        type(row_block_t), intent(inout) :: rows !! the rows of the cases
        real(dp) :: began
        integer :: k, n

        began = processor_seconds()
        worker%since = seconds()
        worker%spent = 0
        n = int(last - first + 1)
        call job%axes%find_block(first, worker%parameters(:, :n), worker%changed(:n))
        worker%block%n = 0
        do k = 1, n
            call worker%note(k)%clear()
            worker%status(k) = status_ok
            worker%lane(k) = 0
            call begin_case(worker, job, k)
        end do
        call charge(worker, making)
        call compute_together(worker, job, n)
        if (worker%skips_nutations .and. is_set(job%scene%nutations)) call refuse_endless(worker, job, n)
        if (any(worker%proofs)) call prove_cases(worker, job, n)
        call charge(worker, computing)
        call fill_rows(worker, job, first, n, rows)
        call charge(worker, filling)
        worker%costs = worker%costs + worker%spent * ((processor_seconds() - began) / max(sum(worker%spent), tiny(began)))
    end subroutine compute_rows

    !> Adds the time since the last call to one of the costs of the block. The time of the processor takes a call of the system,
    !> which may cost as much as a case: it is asked for once a block.
    subroutine charge(worker, cost)
        class(sweep_worker_t), intent(inout) :: worker
        integer, intent(in) :: cost
        real(dp) :: now
        now = seconds()
        worker%spent(cost) = worker%spent(cost) + (now - worker%since)
        worker%since = now
    end subroutine charge

    !> Makes the k-th case of the block, and computes it or puts it to those that are computed together.
    subroutine begin_case(worker, job, k)
        class(sweep_worker_t), target, intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer, intent(in) :: k
        type(plan_t), pointer :: plan
        logical :: in_lanes  !! whether the closed form is computed for many cases at once
        logical :: keeps_attitude
        integer :: first

        associate (case => worker%cases(k), status => worker%status(k), note => worker%note(k))
            first = worker%changed(k)
            call worker%swept%put(worker%parameters(:, k), first)
            ! The attitude of the case before is at hand, if that is the one.
            keeps_attitude = worker%same_attitude
            if (first >= worker%first_without_attitude .and. first > 1) then
                if (worker%status(k - 1) == status_ok) then
                    case%given_start = worker%cases(k - 1)%given_start
                    case%circular = worker%cases(k - 1)%circular
                    keeps_attitude = .true.
                end if
            end if
            call make_worker_case(worker, job, k, keeps_attitude, worker%skips_nutations)
            plan => worker%plans(worker%kind(k))%plan
            worker%max_steps(k) = plan%max_steps
            in_lanes = plan%exact .and. worker%kind(k) == symmetric_top .and. suits_lanes(case%start) .and. &
                (case%body%has_closed_nutation() .or. .not. (worker%wanted(of_nutation) .or. worker%wanted(of_details)))
            if (in_lanes .and. status == status_ok .and. size(job%events) > 0) then
                call stop_exactly(case, job%events, job%stop_after, worker%max_steps(k), status, worker%came(k))
                if (status /= status_ok) call note%explain(trim(status_meanings(status)))
            end if
            if (status /= status_ok) then
                worker%values(k) = sweep_result_t()
            else if (in_lanes) then
                worker%block%n = worker%block%n + 1
                worker%lane(k) = worker%block%n
                call load_lane(case, worker%wanted, worker%block, worker%lane(k))
            else if (goes_in_free_block(job, case, plan, worker%wanted)) then
                call worker%free%add(case, plan%max_steps, k)
            else if (goes_in_batch(job, case, plan, worker%wanted)) then
                call worker%batch%add(case, plan, k)
            else
                call charge(worker, making)
                call compute_stepping(case, plan, worker%wanted, job%events, job%stop_after, worker%values(k), &
                                      status, note)
                call charge(worker, computing)
            end if
        end associate
    end subroutine begin_case

    !> Whether the closed form can be computed in lanes, which begin with angles and rates: these do not exist at a pole,
    !> and close to it they lose digits of a quaternion and omega.
    pure logical function suits_lanes(start)
        type(motion_t), intent(in) :: start
        real(dp), parameter :: close_to_pole = 1.0e-2_dp
        suits_lanes = rates_describe(start) .or. &
            (all(is_finite(start%rate)) .and. sin(start%angle(2)) > close_to_pole)
    end function suits_lanes

    !> Computes those of `n` cases that are computed together.
    subroutine compute_together(worker, job, n)
        class(sweep_worker_t), intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer, intent(in) :: n
        integer :: i, k

        associate (wanted => worker%wanted)
            if (any(worker%lane(:n) > 0) .and. kernel_runs(wanted)) then
                call worker%block%compute(wanted(of_end) .or. wanted(of_energy), wanted(of_period))
            end if
            call worker%free%compute(worker%cases, wanted, worker%max_steps, worker%values, worker%status, worker%note)
            if (worker%batch%n > 0) then
                call worker%batch%compute(job, worker%cases, wanted, worker%values, worker%status, worker%note)
                do i = 1, worker%batch%n_left
                    k = worker%batch%left(i)
                    call worker%note(k)%clear()
                    call compute_stepping(worker%cases(k), worker%plans(worker%kind(k))%plan, wanted, job%events, &
                                          job%stop_after, worker%values(k), worker%status(k), worker%note(k))
                end do
            end if
            do k = 1, n
                if (worker%lane(k) == 0) cycle
                call unload_lane(worker%cases(k), worker%block, worker%lane(k), wanted, worker%max_steps(k), &
                                 worker%values(k), worker%status(k), worker%note(k))
                if (worker%status(k) == status_ok .and. .not. worker%came(k)) call worker%note(k)%add(note_no_stop)
            end do
            call put_perturbations(worker%cases(:n), wanted, worker%values(:n), worker%status(:n), worker%note(:n))
        end associate
    end subroutine compute_together

    !> Refuses those of `n` cases that have no period, of which their spans are a number.
    subroutine refuse_endless(worker, job, n)
        class(sweep_worker_t), intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer, intent(in) :: n
        type(note_t) :: note
        integer :: k
        do k = 1, n
            if (worker%status(k) /= status_ok .or. is_finite(worker%values(k)%nutation_period)) cycle
            call worker%swept%put(worker%parameters(:, k))
            note = worker%note(k)
            call worker%note(k)%clear()
            call make_worker_case(worker, job, k, .false., .false.)
            if (worker%status(k) == status_ok) then
                worker%note(k) = note
            else
                worker%values(k) = sweep_result_t()
            end if
        end do
    end subroutine refuse_endless

    !> Proves the numbers of `n` cases.
    subroutine prove_cases(worker, job, n)
        type(sweep_worker_t), intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer, intent(in) :: n
        integer :: k
        do k = 1, n
            if (.not. is_good_end(worker%status(k))) cycle
            call prove_case(worker%cases(k), worker%proofs, job%scene, worker%values(k), worker%note(k))
        end do
    end subroutine prove_cases

    !> Fills the rows of `n` cases.
    subroutine fill_rows(worker, job, first, n, rows)
        class(sweep_worker_t), intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer(int64), intent(in) :: first !! number of the first case
        integer, intent(in) :: n
        type(row_block_t), intent(inout) :: rows
        call rows%reserve(cells_of_row(job), block_size)
        call put_rows(worker%columns, first, worker%parameters(:, :n), worker%status(:n), worker%values(:n), &
                      worker%cases(:n), worker%note(:n), rows)
    end subroutine fill_rows

    !> Makes the k-th case of the block from the scene of the worker, and the plan for its kind of body if there is
    !> none yet.
    subroutine make_worker_case(worker, job, k, keeps_attitude, keeps_nutations)
        class(sweep_worker_t), intent(inout) :: worker
        type(job_t), intent(in) :: job
        integer, intent(in) :: k
        logical, intent(in) :: keeps_attitude !! that which the start of the case has
        logical, intent(in) :: keeps_nutations !! whether nothing depends on a span in nutations
        type(problems_t) :: problems
        integer :: outside

        worker%status(k) = status_ok
        outside = job%axes%out_of_range(worker%parameters(:, k))
        if (outside > 0) then
            worker%status(k) = status_bad_input
            !$omp critical (texts)
            associate (axis => job%axes%axis(outside))
                call worker%note(k)%explain(axis%name // ' ' // axis%slot%refusal(worker%parameters(outside, k)))
            end associate
            !$omp end critical (texts)
            return
        end if
        call make_case(worker%swept%scene, worker%cases(k), problems, &
                       kept_parts_t(worker%same_body, keeps_attitude, keeps_nutations))
        if (problems%any()) then
            worker%status(k) = status_bad_input
            ! Threads create texts: see `status_names`.
            !$omp critical (texts)
            call worker%note(k)%explain(problems%first())
            !$omp end critical (texts)
            return
        end if
        if (.not. worker%same_body) worker%kind(k) = kind_of(worker%cases(k)%body)
        associate (kept => worker%plans(worker%kind(k)))
            if (.not. (kept%is_made .and. worker%same_plans)) call keep_plan(worker, job, worker%cases(k), kept)
            if (.not. allocated(kept%problem)) return
            worker%status(k) = status_bad_input
            call worker%note(k)%explain(kept%problem)
        end associate
    end subroutine make_worker_case

    !> Makes the plan for bodies of the kind that a case has. If it is kept for later cases, it depends on nothing
    !> else of this one: rows do not depend on the cases that the thread had before.
    subroutine keep_plan(worker, job, case, kept)
        class(sweep_worker_t), intent(in) :: worker
        type(job_t), intent(in) :: job
        type(case_t), intent(in) :: case
        type(kept_plan_t), intent(out) :: kept
        type(case_t) :: one_of_kind
        type(problems_t) :: problems

        one_of_kind = case
        if (worker%same_plans) one_of_kind%t_end = job%case%t_end
        kept%is_made = .true.
        ! Plans and problems create texts: see `status_names`.
        !$omp critical (texts)
        call make_plan(worker%swept%scene, one_of_kind, kept%plan, problems)
        if (problems%any()) kept%problem = problems%first()
        !$omp end critical (texts)
    end subroutine keep_plan

    !> The kind of a body.
    pure integer function kind_of(body) result(kind)
        type(body_t), intent(in) :: body
        kind = damped
        if (all(is_zero(body%damping))) kind = merge(free_body, undamped, body%is_free())
        if (body%is_lagrange()) kind = symmetric_top
        if (allocated(body%effects)) kind = affected
    end function kind_of

end module spintop_sweep_worker
