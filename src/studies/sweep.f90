!> The sweep study: a case for each combination of the axes, one row each, on all cores.
module spintop_sweep
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_kinds, only: dp
    use spintop_case, only: case_t, make_case
    use spintop_errors, only: error_t
    use spintop_job, only: job_t, options_t
    use spintop_parameters, only: parameter_table_t
    use spintop_plan, only: plan_t, make_plan
    use spintop_problems, only: problems_t
    use spintop_progress, only: progress_t
    use spintop_parameter_print, only: print_namelist
    use spintop_provenance, only: describe_provenance
    use spintop_scene, only: scene_t, describe_scene
    use spintop_status, only: status_ok, status_bad_input, status_name, status_meaning, last_status
    use spintop_summary, only: summary_t, digits
    use spintop_sweep_axes, only: axes_t
    use spintop_sweep_case, only: compute_case, quantities
    use spintop_sweep_columns, only: sweep_column_t, sweep_columns, sweep_groups
    use spintop_system, only: seconds
    use spintop_table_file, only: table_file_t
    use spintop_text, only: to_text, string_t
    use spintop_text_buffer, only: text_buffer_t
    implicit none
    private
    public :: run_sweep

    !> Cases that a thread computes before it hands in their rows.
    integer(int64), parameter :: block_size = 64

    !> What a thread needs of its own to make and compute cases.
    type :: worker_t
        type(scene_t) :: scene
        type(parameter_table_t) :: table
        type(plan_t) :: plan
        !> Swept parameters are among those that a plan is made of.
        logical :: replan = .false.
        !> Whether the plan was made for a top whose exact motion is known.
        logical :: for_lagrange = .false.
    end type worker_t

contains

    !> Computes all cases and writes the table; `failures` counts the cases of each status.
    subroutine run_sweep(job, options, summary, failures, error)
        type(job_t), intent(inout) :: job
        type(options_t), intent(in) :: options
        type(summary_t), intent(out) :: summary
        integer(int64), intent(out) :: failures(0:last_status)
        type(error_t), allocatable, intent(out) :: error
        type(table_file_t) :: file
        type(progress_t) :: progress
        type(worker_t), allocatable, target :: worker
        type(text_buffer_t) :: rows
        type(string_t) :: no_lines(0)
        integer(int64) :: block, blocks, counts(0:last_status)
        real(dp) :: began, elapsed
        logical :: wanted(sweep_groups), broken
        integer :: status

        failures = 0
        call create_table(job, file, error)
        if (allocated(error)) return
        wanted = .false.
        wanted(sweep_columns(job%columns)%group) = .true.
        call progress%start(job%name, 'cases', job%axes%cases, options%quiet, options%progress)
        broken = .false.
        counts = 0
        blocks = (job%axes%cases + block_size - 1) / block_size
        began = seconds()
        !$omp parallel private(worker, rows) reduction(+:counts)
        allocate (worker)
        call prepare_worker(job, worker)
        !$omp do schedule(dynamic) ordered
        do block = 1, blocks
            if (.not. broken) call compute_block(job, worker, wanted, block, rows, counts)
            !$omp ordered
            if (.not. broken) call file%put_block(rows, error)
            broken = allocated(error)
            call progress%update(min(block * block_size, job%axes%cases))
            !$omp end ordered
        end do
        !$omp end do
        !$omp end parallel
        call progress%finish()
        elapsed = seconds() - began
        if (.not. allocated(error)) call file%finish(no_lines, error)
        if (allocated(error)) then
            call file%discard()
            return
        end if
        failures = counts

        call summary%headline(job%input // ': sweep of ' // to_text(job%axes%cases) // ' cases -> ' // job%output)
        call summary%describe_plan(job%plan)
        call summary%add('time', digits(elapsed) // ' s, ' // digits(job%axes%cases / elapsed) // ' cases/s')
        do status = status_ok, last_status
            if (counts(status) == 0) cycle
            call summary%add('status', to_text(counts(status)) // ' ' // status_name(status) // ': ' &
                             // status_meaning(status))
        end do
    end subroutine run_sweep

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
        call describe_provenance(job%scene%title, input, columns%name, columns%unit, columns%what, &
                                 dated=.false., lines=header)
        call file%create(job%output, header, columns%name, error)
    end subroutine create_table

    !> Name of a parameter without its subscript.
    pure function base_of(name) result(base)
        character(*), intent(in) :: name
        character(:), allocatable :: base
        base = name(:index(name // '(', '(') - 1)
    end function base_of

    !> A scene and a plan of the thread's own.
    subroutine prepare_worker(job, worker)
        type(job_t), intent(in) :: job
        type(worker_t), target, intent(inout) :: worker
        integer :: i
        worker%scene = job%scene
        call describe_scene(worker%scene, worker%table)
        worker%plan = job%plan
        worker%for_lagrange = job%case%body%is_lagrange()
        do i = 1, size(job%axes%axis)
            worker%replan = worker%replan .or. index(job%axes%axis(i)%name, 'integration.') == 1
        end do
    end subroutine prepare_worker

    !> Rows of the cases of a block.
    subroutine compute_block(job, worker, wanted, block, rows, counts)
        type(job_t), intent(in) :: job
        type(worker_t), target, intent(inout) :: worker
        logical, intent(in) :: wanted(sweep_groups)
        integer(int64), intent(in) :: block
        type(text_buffer_t), intent(inout) :: rows
        integer(int64), intent(inout) :: counts(0:last_status)
        real(dp) :: values(quantities)
        character(:), allocatable :: note
        integer(int64) :: number
        integer :: status

        call rows%clear()
        do number = (block - 1) * block_size + 1, min(block * block_size, job%axes%cases)
            call job%axes%apply(number, worker%table)
            call make_and_compute(worker, wanted, values, status, note)
            call rows%put_integer(number)
            call rows%put_reals(job%axes%values_of(number))
            call rows%put_text(status_name(status))
            call rows%put_reals(values(job%columns))
            call rows%put_text(note)
            call rows%end_row()
            counts(status) = counts(status) + 1
        end do
    end subroutine compute_block

    !> Makes the case of the worker's scene and computes it.
    subroutine make_and_compute(worker, wanted, values, status, note)
        type(worker_t), intent(inout) :: worker
        logical, intent(in) :: wanted(sweep_groups)
        real(dp), intent(out) :: values(quantities)
        integer, intent(out) :: status
        character(:), allocatable, intent(out) :: note
        type(case_t) :: case
        type(problems_t) :: problems

        call make_case(worker%scene, case, problems)
        if (.not. problems%any()) then
            if (worker%replan .or. (case%body%is_lagrange() .neqv. worker%for_lagrange)) then
                call make_plan(worker%scene, case, worker%plan, problems)
                worker%for_lagrange = case%body%is_lagrange()
                ! After a plan that failed the next case needs one of its own.
                if (problems%any()) worker%for_lagrange = .not. worker%for_lagrange
            end if
        end if
        if (problems%any()) then
            values = ieee_value(0.0_dp, ieee_quiet_nan)
            status = status_bad_input
            note = problems%first()
        else
            call compute_case(case, worker%plan, wanted, values, status, note)
        end if
    end subroutine make_and_compute

end module spintop_sweep
