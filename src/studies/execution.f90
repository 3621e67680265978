!> Runs or explains prepared jobs; runs an input for a Fortran program.
module spintop_execution
    use spintop_errors, only: error_t
    use spintop_exit_codes, only: exit_ok
    use spintop_files, only: make_folder
    use spintop_job, only: job_t, print_input
    use spintop_options, only: options_t
    use spintop_preparation, only: prepare_jobs, prepared_t, protect_interrupted
    use spintop_study, only: study_t
    use spintop_summary, only: summary_t
    use spintop_terminal, only: output_width
    use spintop_text, only: string_t, append, append_wrapped, line_width
    !$ use omp_lib, only: omp_set_num_threads
    implicit none
    private
    public :: run_job, explain_job, run_study

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

        code = exit_ok
        if (options%ranks%is_writer()) call make_folder(options%output, error)
        call options%ranks%agree(error)
        if (allocated(error)) return
        !$ if (options%threads > 0) call omp_set_num_threads(options%threads)
        if (.not. (study%info%shares_ranks .or. options%ranks%is_writer())) return
        call study%run(job, options, summary, code, error)
        call summary%print('', options%verbose, lines)
    end subroutine run_job

    !> The resolved input, which can be run, and below it a description of the computation and its reasons.
    subroutine explain_job(study, job, options, lines)
        class(study_t), intent(in) :: study !! the kind of study
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(string_t), allocatable, intent(out) :: lines(:) !! lines of text
        type(summary_t) :: summary
        character(:), allocatable :: outputs

        call print_input(job, lines)
        call append(lines, '')
        outputs = ' -> ' // job%files%table
        if (job%files%statistics /= '') outputs = outputs // ', its statistics -> ' // job%files%statistics
        if (job%files%events /= '') outputs = outputs // ', its events -> ' // job%files%events
        call summary%headline(job%input%path // ': ' // study%phrase // outputs)
        if (options%shard%is_part()) call summary%add('shard', options%shard%line(study%count))
        if (allocated(job%plan%reason)) call summary%describe_plan(job%plan)
        if (study%info%has_case) call summary%describe_motion(job%case)
        if (job%axes%cases > 0) call summary%describe_axes(job%axes)
        if (job%statistics%is_wanted) call summary%describe_statistics(job%statistics)
        call study%forecast(job, options, summary)
        call summary%print('! ', .true., lines)
        if (allocated(job%plan%reason)) then
            call append(lines, '!')
            call append_wrapped(lines, '! ', job%plan%reason, 0, min(line_width, output_width()))
        end if
    end subroutine explain_job

    !> Runs an input, as the program does. Its table is written to a folder, which is made if missing.
    subroutine run_study(input, folder, table, error, overrides)
        character(*), intent(in) :: input !! path of the namelist
        character(*), intent(in) :: folder !! for the results
        character(:), allocatable, intent(out) :: table !! path of the table
        type(error_t), allocatable, intent(out) :: error !! the input is wrong, or a case failed, or a file
        type(string_t), intent(in), optional :: overrides(:) !! `group.key=value`, as --set takes them
        type(prepared_t), allocatable, target :: prepared(:)
        type(options_t) :: options
        type(string_t), allocatable :: summary(:)
        type(string_t) :: inputs(1)
        integer :: code

        table = ''
        inputs(1)%text = input
        options%output = folder
        options%command = 'spintop'
        options%quiet = .true.
        allocate (options%overrides(0))
        if (present(overrides)) options%overrides = overrides
        call prepare_jobs(inputs, options, prepared, error)
        if (.not. allocated(error)) call protect_interrupted(prepared, options, error)
        if (allocated(error)) return
        call run_job(prepared(1)%study, prepared(1)%job, options, summary, code, error)
        if (allocated(error)) return
        table = prepared(1)%job%files%table
        if (code /= 0) error = error_t(code, input // ': some cases failed; their rows have the status')
    end subroutine run_study

end module spintop_execution
