!> Runs or explains prepared jobs.
module spintop_execution
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_ok
    use spintop_job, only: job_t
    use spintop_line_list, only: line_list_t, line_width
    use spintop_options, only: options_t
    use spintop_study, only: study_info_t, study_t
    use spintop_study_head, only: print_input
    use spintop_summary, only: summary_t, text_column
    use spintop_terminal, only: output_width
    use spintop_files, only: make_folder
    use spintop_text, only: string_t
    !$ use omp_lib, only: omp_set_num_threads
    implicit none
    private
    public :: run_job, explain_job

contains

    !> Runs a job with a display of its progress, and returns the lines of its summary and its exit code.
    subroutine run_job(study, job, options, lines, code, error)
        class(study_t), intent(inout) :: study !! the kind of study
        type(job_t), target, intent(inout) :: job !! a checked job
        type(options_t), intent(in) :: options !! options of the command line
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(summary_t) :: summary
        type(line_list_t) :: text
        type(study_info_t) :: info
        integer :: i

        code = exit_ok
        if (options%ranks%is_writer()) call make_folder(options%output, error)
        call options%ranks%agree(error)
        if (allocated(error)) return
        !$ if (options%threads > 0) call omp_set_num_threads(options%threads)
        info = study%info()
        if (.not. (info%shares_ranks .or. options%ranks%is_writer())) return
        call study%run(job, options, summary, code, error)
        if (.not. allocated(summary%lines)) return
        do i = 1, size(summary%lines)
            call text%add_wrapped('', summary%lines(i)%text, text_column, output_width())
        end do
        call text%get(lines)
    end subroutine run_job

    !> The resolved input, which can be run, and below it a description of the computation and its reasons.
    subroutine explain_job(study, job, options, lines)
        class(study_t), intent(in) :: study !! the kind of study
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(summary_t) :: summary
        type(study_info_t) :: info
        type(string_t), allocatable :: input(:)
        type(line_list_t) :: text
        character(:), allocatable :: outputs
        integer :: i

        info = study%info()
        call print_input(job, input)
        do i = 1, size(input)
            call text%add(input(i)%text)
        end do
        call text%add('')
        outputs = ' -> ' // job%files%table
        if (job%files%statistics /= '') outputs = outputs // ', its statistics -> ' // job%files%statistics
        if (job%files%events /= '') outputs = outputs // ', its events -> ' // job%files%events
        call summary%headline(job%input%path // ': ' // study%explain(job) // outputs)
        if (options%shard%is_part()) call summary%add('shard', options%shard%line(study%cases(job)))
        if (allocated(job%plan%reason)) call summary%describe_plan(job%plan)
        if (info%has_case) call summary%describe_motion(job%case)
        if (job%axes%cases > 0) call summary%describe_axes(job%axes)
        if (job%statistics%is_wanted) call summary%describe_statistics(job%statistics)
        call study%forecast(job, options, summary)
        do i = 1, size(summary%lines)
            call text%add_wrapped('! ', summary%lines(i)%text, text_column, output_width())
        end do
        if (allocated(job%plan%reason)) then
            call text%add('!')
            call text%add_wrapped('! ', job%plan%reason // study%remark(job), 0, min(line_width, output_width()))
        end if
        call text%get(lines)
    end subroutine explain_job

end module spintop_execution
