!> Studies as a user asks for them: inputs made into jobs, jobs checked, explained and run.
module spintop_studies
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t, exit_ok, exit_failed, input_error
    use spintop_files, only: make_folder
    use spintop_interrupted_run, only: refuse_to_discard_idle
    use spintop_job, only: job_t, options_t, prepare_job
    use spintop_line_list, only: line_list_t
    use spintop_parameter_print, only: print_namelist
    use spintop_stability, only: run_stability
    use spintop_status, only: status_ok, last_status
    use spintop_summary, only: summary_t
    use spintop_sweep, only: run_sweep
    use spintop_sweep_columns, only: sweep_columns, group_nutation, group_fast_top
    use spintop_text, only: string_t, to_text
    use spintop_trajectory, only: run_trajectory
    use spintop_work_precision, only: run_work_precision
    !$ use omp_lib, only: omp_set_num_threads
    implicit none
    private
    public :: prepare_jobs, protect_interrupted, run_job, explain_job

contains

    !> Reads and checks all inputs before any is run; the error tells of all that is wrong. It is the
    !> same in all ranks.
    subroutine prepare_jobs(inputs, options, jobs, error)
        type(string_t), intent(in) :: inputs(:)
        type(options_t), intent(in) :: options
        type(job_t), allocatable, target, intent(out) :: jobs(:)
        type(error_t), allocatable, intent(out) :: error
        type(error_t), allocatable :: problem
        integer :: i, k

        allocate (jobs(size(inputs)))
        do i = 1, size(inputs)
            call prepare_job(inputs(i)%text, options, jobs(i), problem)
            if (.not. allocated(problem)) then
                do k = 1, i - 1
                    if (.not. allocated(jobs(k)%output)) cycle
                    if (jobs(k)%output == jobs(i)%output .or. jobs(k)%output == jobs(i)%event_output &
                        .or. jobs(k)%event_output == jobs(i)%output) then
                        problem = input_error(inputs(i)%text // ': error: its table ' // jobs(i)%output &
                            // ' is also that of ' // inputs(k)%text // '; set output.file in one of them')
                    end if
                end do
            end if
            if (.not. allocated(problem)) cycle
            if (allocated(error)) then
                error%message = error%message // new_line('a') // problem%message
                error%code = max(error%code, problem%code)
            else
                error = problem
            end if
        end do
        call options%ranks%agree(error)
    end subroutine prepare_jobs

    !> An error, the same in all ranks, if the jobs would discard what interrupted runs have left, and nobody
    !> has asked for that.
    subroutine protect_interrupted(jobs, options, error)
        type(job_t), intent(in) :: jobs(:)
        type(options_t), intent(in) :: options
        type(error_t), allocatable, intent(out) :: error
        integer :: i

        if (options%ranks%is_writer() .and. .not. (options%resume .or. options%restart)) then
            do i = 1, size(jobs)
                call refuse_to_discard_idle(jobs(i)%output, error)
                if (.not. allocated(error) .and. jobs(i)%event_output /= '') then
                    call refuse_to_discard_idle(jobs(i)%event_output, error)
                end if
                if (allocated(error)) exit
            end do
        end if
        call options%ranks%agree(error)
    end subroutine protect_interrupted

    !> Runs a job, shows its progress, and gives the lines of its summary and its exit code.
    subroutine run_job(job, options, lines, code, error)
        type(job_t), target, intent(inout) :: job
        type(options_t), intent(in) :: options
        type(string_t), allocatable, intent(out) :: lines(:)
        integer, intent(out) :: code
        type(error_t), allocatable, intent(out) :: error
        type(summary_t) :: summary
        integer(int64) :: counts(0:last_status)
        integer :: status, failures

        code = exit_ok
        if (options%ranks%is_writer()) call make_folder(options%output, error)
        call options%ranks%agree(error)
        if (allocated(error)) return
        !$ if (options%threads > 0) call omp_set_num_threads(options%threads)
        select case (job%scene%kind)
        case ('sweep')
            call run_sweep(job, options, summary, counts, error)
            if (any(counts(status_ok + 1:) > 0)) code = exit_failed
        case ('work_precision')
            call run_work_precision(job, options, summary, failures, error)
            if (failures > 0) code = exit_failed
        case ('stability')
            call run_stability(job, options, summary, error)
        case default
            call run_trajectory(job, options, summary, status, error)
            if (status /= status_ok) code = exit_failed
        end select
        if (allocated(summary%lines)) call move_alloc(summary%lines, lines)
    end subroutine run_job

    !> The resolved input, complete and runnable, headed by what will be computed and why.
    subroutine explain_job(job, options, lines)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        type(string_t), allocatable, intent(out) :: lines(:)
        type(summary_t) :: summary
        type(string_t), allocatable :: input(:)
        type(line_list_t) :: text
        integer :: i

        call summary%headline(job%input // ': ' // what())
        if (options%shard%is_part()) call summary%add('shard', options%shard%line(job%axes%cases))
        if (allocated(job%plan%reason)) call summary%describe_plan(job%plan)
        if (job%scene%kind /= 'stability') call summary%describe_motion(job%case)
        if (job%axes%cases > 0) call summary%describe_axes(job%axes)
        do i = 1, size(summary%lines)
            call text%add('! ' // summary%lines(i)%text)
        end do
        call text%add('!')
        if (allocated(job%plan%reason)) then
            call text%add_paragraph('! ', job%plan%reason // remark_on_columns())
            call text%add('')
        end if
        call print_namelist(job%table, input)
        do i = 1, size(input)
            call text%add(input(i)%text)
        end do
        call text%get(lines)

    contains

        function what()
            character(:), allocatable :: what
            select case (job%scene%kind)
            case ('sweep')
                what = 'a sweep of ' // to_text(job%axes%cases) // ' cases, of which this is the first'
            case ('work_precision')
                what = 'the cost of ' // to_text(sum(job%precision%settings(job%precision%choices))) &
                       // ' methods and settings at their errors'
            case ('stability')
                what = 'the stability of ' // to_text(size(job%stability%methods)) // ' methods on ' &
                       // to_text(size(job%stability%cases)) // ' cases'
            case default
                what = 'a trajectory of ' // to_text(job%plan%samples) // ' rows over ' &
                       // to_text(job%case%t_end) // ' s'
            end select
            what = what // ' -> ' // job%output
            if (job%event_output /= '') what = what // ', its events -> ' // job%event_output
        end function what

        !> Whether a sweep follows its cases in time.
        function remark_on_columns() result(remark)
            character(:), allocatable :: remark
            remark = ''
            if (job%scene%kind /= 'sweep' .or. .not. job%case%body%is_lagrange()) return
            associate (groups => sweep_columns(job%columns)%group)
                if (all(groups == group_nutation .or. groups == group_fast_top)) then
                    remark = ' The columns asked for need the whole nutation only: no case is followed in time.'
                end if
            end associate
        end function remark_on_columns

    end subroutine explain_job

end module spintop_studies
