!> Runs or explains prepared jobs; runs an input for a Fortran program.
module spintop_execution
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_axes_of_table, only: given_axis_t
    use spintop_errors, only: error_t, exit_ok
    use spintop_files, only: file_exists, make_folder, make_private_folder, remove_folder
    use spintop_fit_study, only: residual_path
    use spintop_job, only: job_t, print_input, study_head
    use spintop_loaded_table, only: data_table_t, load_table
    use spintop_study, only: options_t, study_t
    use spintop_preparation, only: prepare_job, prepare_jobs, prepared_t, protect_interrupted
    use spintop_row_table, only: row_table_t
    use spintop_scene_keys, only: kind_fit, kind_sweep, study_kinds
    use spintop_statistics_output, only: path_beside
    use spintop_summary, only: summary_t
    use spintop_sweep_study, only: compute_cases
    use spintop_sweep_worker, only: describe_columns
    use spintop_terminal, only: output_width
    use spintop_text, only: append, append_wrapped, join, line_width, string_t
    use spintop_thread_team, only: team_t
    !$ use omp_lib, only: omp_set_num_threads, omp_get_max_threads
    implicit none
    private
    public :: run_job, explain_job, run_study, memory_run_t, run_in_memory

    !> What a run gives.
    type :: memory_run_t
        !> Its tables: `rows`, and where the input asks for them `events`, `statistics` with `histogram` and `indices`, or
        !> `residuals`.
        type(data_table_t), allocatable :: table(:)
        !> Warnings of the input and of the run, and the summary of the run, for a reader; either may be empty.
        character(:), allocatable :: warnings, summary
        !> `exit_ok`, or `exit_failed` where the motion, or some cases, failed.
        integer :: code = exit_ok
    end type memory_run_t

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

    !> Runs an input. A sweep without statistics is computed in memory; the tables of other studies are written to a
    !> private folder, read and removed. With `options%output` all tables are written to that folder, and stay.
    subroutine run_in_memory(text, name, options, run, error, given)
        character(*), intent(in) :: text !! the namelist groups
        character(*), intent(in) :: name !! of the text, for messages
        type(options_t), intent(inout) :: options !! `output` may be '' or not allocated
        type(memory_run_t), intent(out) :: run !! tables and summary
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(given_axis_t), intent(in), optional :: given(:) !! values of parameters, in place of axes of a sweep
        type(prepared_t), allocatable, target :: prepared(:)
        type(error_t), allocatable :: ignored
        type(row_table_t) :: table
        type(team_t) :: team
        integer :: threads

        threads = 1
        !$ threads = omp_get_max_threads()
        options%quiet = .true.
        options%verbose = .true.
        if (.not. allocated(options%output)) options%output = ''
        if (.not. allocated(options%overrides)) allocate (options%overrides(0))
        allocate (prepared(1))
        allocate (prepared(1)%job)
        associate (job => prepared(1)%job)
            if (present(given)) job%given = given
            call prepare_job(name, options, prepared(1)%job, prepared(1)%study, error, text)
            if (allocated(error)) return
            run%warnings = job%warnings
            run%summary = ''
            if (options%output /= '') then
                call protect_interrupted(prepared, options, error)
                if (.not. allocated(error)) call run_in_files(prepared(1), options, .true., run, error)
            else if (job%input%scene%kind == study_kinds(kind_sweep) .and. .not. job%statistics%is_wanted) then
                !$ if (options%threads > 0) call omp_set_num_threads(options%threads)
                call describe_columns(job, table%columns)
                allocate (table%memory)
                call table%memory%begin(table%columns, job%axes%cases, error)
                if (.not. allocated(error)) then
                    call team%progress%start(job%name, 'cases', job%axes%cases, options%quiet, options%progress)
                    call compute_cases(job, options%ranks, [1_int64, job%axes%cases], table, team, run%code, error)
                end if
                if (.not. allocated(error)) then
                    allocate (run%table(1))
                    table%memory%frame = study_head(job, table%columns, part=options%shard%line(job%axes%cases))
                    call move_table(table%memory, run%table(1))
                end if
            else
                ! In a folder whose files nobody else is to see.
                call make_private_folder(options%output, error)
                if (.not. allocated(error)) then
                    job%files%table = options%output // job%files%table
                    job%files%log = options%output // job%files%log
                    if (job%files%events /= '') job%files%events = options%output // job%files%events
                    if (job%files%statistics /= '') job%files%statistics = options%output // job%files%statistics
                    call run_in_files(prepared(1), options, .false., run, error)
                    call remove_folder(options%output, ignored)
                    options%output = ''
                end if
            end if
        end associate
        !$ call omp_set_num_threads(threads)
    end subroutine run_in_memory

    !> Moves the columns of a table.
    subroutine move_table(from, to)
        type(data_table_t), intent(inout) :: from
        type(data_table_t), intent(inout) :: to
        to%name = from%name
        to%rows = from%rows
        call move_alloc(from%column, to%column)
        call move_alloc(from%frame, to%frame)
    end subroutine move_table

    !> Runs a job, and loads its tables. Those of NetCDF are not loaded.
    subroutine run_in_files(prepared, options, stay, run, error)
        type(prepared_t), target, intent(inout) :: prepared
        type(options_t), intent(in) :: options
        logical, intent(in) :: stay !! whether the files stay: then the summary names them, in its first lines
        type(memory_run_t), intent(inout) :: run
        type(error_t), allocatable, intent(out) :: error
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: statistics, name
        integer :: first, i

        allocate (lines(0), run%table(0))
        call run_job(prepared%study, prepared%job, options, lines, run%code, error)
        if (allocated(error) .or. .not. allocated(lines)) return
        first = 1
        do while (.not. stay .and. first < size(lines))
            if (scan(lines(first)%text, 'abcdefghijklmnopqrstuvwxyz') == 3 .and. lines(first)%text(:2) == '') exit
            first = first + 1
        end do
        run%summary = join(lines(first:), new_line('a'))
        if (prepared%job%late_warnings /= '') then
            if (run%warnings /= '') run%warnings = run%warnings // new_line('a')
            run%warnings = run%warnings // prepared%job%late_warnings
        end if
        associate (job => prepared%job)
            statistics = job%files%statistics
            if (.not. job%keeps_rows()) statistics = job%files%table
            if (job%keeps_rows()) call add_table(job%files%table, 'rows', run, error)
            call add_table(job%files%events, 'events', run, error)
            call add_table(statistics, 'statistics', run, error)
            if (job%statistics%is_wanted) call add_table(path_beside(statistics, 'histogram'), 'histogram', run, error)
            if (job%statistics%is_wanted) call add_table(path_beside(statistics, 'indices'), 'indices', run, error)
            do i = 1, merge(count(job%input%scene%fit%data /= ''), 0, job%input%scene%kind == study_kinds(kind_fit))
                name = residual_path('', i)
                call add_table(residual_path(job%files%table, i), name(2:len(name) - len('.csv')), run, error)
            end do
        end associate
    end subroutine run_in_files

    !> Loads a table, if there is one, and was no error before.
    subroutine add_table(path, name, run, error)
        character(*), intent(in) :: path, name
        type(memory_run_t), intent(inout) :: run
        type(error_t), allocatable, intent(inout) :: error
        type(data_table_t), allocatable :: more(:)
        integer :: i

        if (allocated(error) .or. len(path) < 4) return
        if (path(len(path) - 3:) /= '.csv' .or. .not. file_exists(path)) return
        allocate (more(size(run%table) + 1))
        do i = 1, size(run%table)
            call move_table(run%table(i), more(i))
        end do
        call load_table(path, name, more(size(more)), error)
        call move_alloc(more, run%table)
    end subroutine add_table

end module spintop_execution
