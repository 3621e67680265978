!> Makes jobs of inputs: each is read, checked and planned by its study, before any is run.
module spintop_preparation
    use spintop_column_choice, only: choose_columns
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_event_choice, only: choose_events
    use spintop_job, only: job_t
    use spintop_job_files, only: name_job, name_outputs, refuse_overwriting
    use spintop_named_units, only: convert_named_units
    use spintop_namelist, only: read_namelist
    use spintop_netcdf_file, only: has_compression, has_netcdf
    use spintop_netcdf_grid, only: most_netcdf_rows
    use spintop_options, only: options_t
    use spintop_parameters, only: unset_integer
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: describe_scene
    use spintop_studies, only: create_study
    use spintop_study, only: study_info_t, study_t
    use spintop_table_file, only: refuse_to_discard_idle
    use spintop_terminal, only: message_width
    use spintop_text, only: string_t, to_text
    use spintop_own_butcher_tables, only: read_tables
    use spintop_torques_of_scene, only: read_friction_table, read_torques
    implicit none
    private
    public :: prepared_t, prepare_jobs, prepare_job, protect_interrupted

    !> A job, and the study that runs it.
    type :: prepared_t
        type(job_t), allocatable :: job ! too large for copies on the stack
        class(study_t), allocatable :: study
    end type prepared_t

contains

    !> Reads and checks all inputs before any is run. The error contains all problems, and is the same in all
    !> ranks.
    subroutine prepare_jobs(inputs, options, prepared, error)
        type(string_t), intent(in) :: inputs(:) !! their paths
        type(options_t), intent(in) :: options !! options of the command line
        type(prepared_t), allocatable, target, intent(out) :: prepared(:) !! the jobs with their studies
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        type(error_t), allocatable :: problem
        logical :: is_faulty(size(inputs))
        integer :: i, k

        is_faulty = .false.
        allocate (prepared(size(inputs)))
        do i = 1, size(inputs)
            call prepare_job(inputs(i)%text, options, prepared(i)%job, prepared(i)%study, problem)
            do k = 1, i
                if (allocated(problem) .or. is_faulty(k) .or. options%verifies) cycle
                call refuse_overwriting(prepared(i)%job, prepared(k)%job, k < i, problem)
            end do
            is_faulty(i) = allocated(problem)
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

    !> Reads an input with the overrides of the command line, makes its case, plan and columns, and reports
    !> all its problems at once.
    subroutine prepare_job(input, options, job, study, error, text)
        character(*), intent(in) :: input !! its path, or the name of the text
        type(options_t), intent(in) :: options !! options of the command line
        type(job_t), allocatable, target, intent(inout) :: job !! the job, which is allocated; it may have values of parameters
        class(study_t), allocatable, intent(out) :: study !! the kind of study
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        character(*), intent(in), optional :: text !! the input itself, in place of a file
        type(diagnostics_t) :: diagnostics
        type(problems_t) :: problems
        type(study_info_t) :: info

        if (.not. allocated(job)) allocate (job)
        job%input%path = input
        call name_job(job)
        call describe_scene(job%input%scene, job%input%table)
        call job%input%table%verify(error)
        if (allocated(error)) return
        call read_namelist(input, options%overrides, job%input%table, diagnostics, error, text, options%verifies)
        if (allocated(error)) return
        if (.not. diagnostics%has_errors()) call convert_named_units(job%input%scene, job%input%table, diagnostics)
        call read_torques(input, job%input%scene%effects, problems)
        call read_friction_table(input, job%input%scene%effects, problems)
        call read_tables(input, job%input%scene, problems)
        call create_study(trim(job%input%scene%kind), study)
        info = study%info()
        job%has_case = info%has_case
        call check_job(study, job, problems, diagnostics)
        call refuse_parts(info, options, problems)
        call refuse_netcdf(info, job, problems)
        call choose_columns(study, job, problems)
        call study%complete(job, problems)
        call choose_events(info, job%input%scene, job%case, job%events, problems)
        if (job%input%scene%stop_after /= unset_integer) job%stop_after = job%input%scene%stop_after
        call problems%report_to(job%input%table, diagnostics)
        call diagnostics%raise(error, message_width())
        if (allocated(error)) return
        job%warnings = ''
        job%late_warnings = ''
        if (diagnostics%has_warnings()) job%warnings = diagnostics%report(message_width())
        call name_outputs(options, job)
    end subroutine prepare_job

    !> Checks that are common to all studies, then those of the study.
    subroutine check_job(study, job, problems, diagnostics)
        class(study_t), intent(inout) :: study
        type(job_t), target, intent(inout) :: job
        type(problems_t), intent(inout) :: problems
        type(diagnostics_t), intent(inout) :: diagnostics
        type(study_info_t) :: info

        info = study%info()
        if (scan(trim(job%input%scene%file), '/') > 0) then
            call problems%add('output.file', 'the name of the table contains a slash', &
                              'name the folder with --output')
        end if
        if (job%names_axes() .and. .not. info%takes_axes) then
            call problems%add('sweep', info%phrase // ' has no axes', "set study.kind = 'sweep'")
        end if
        if (.not. info%has_statistics) then
            if (job%names_statistics()) call problems%add('statistics', info%phrase // ' has no statistics', &
                                                          "omit the group, or set study.kind = 'sweep'")
            if (job%input%scene%rows /= '') call problems%add('output.rows', info%phrase // ' always has its rows', 'omit it')
        end if
        allocate (job%axes%axis(0))
        call study%check(job, problems, diagnostics)
    end subroutine check_job

    !> Reports shards of studies without parts, and a resumed run of those that keep nothing of an interrupted one.
    subroutine refuse_parts(info, options, problems)
        type(study_info_t), intent(in) :: info
        type(options_t), intent(in) :: options
        type(problems_t), intent(inout) :: problems
        if (options%shard%is_part() .and. .not. info%has_parts) then
            call problems%add('study.kind', '--shard is not for ' // info%plural // ', which have no parts', 'omit --shard')
        end if
        if (options%resume .and. .not. info%resumes) then
            call problems%add('study.kind', '--resume is for sweeps and trajectories: this study is always computed as a whole', &
                              'omit --resume')
        end if
    end subroutine refuse_parts

    !> Reports a NetCDF table that a study, or this build, cannot write.
    subroutine refuse_netcdf(info, job, problems)
        type(study_info_t), intent(in) :: info
        type(job_t), intent(in) :: job
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: key = 'output.format', hint = "set output.format = 'csv'", &
            key_of_level = 'output.compression'
        if (job%input%scene%compression /= unset_integer) then
            if (job%input%scene%format /= 'netcdf') then
                call problems%add(key_of_level, 'only a NetCDF table can be compressed', "set output.format = 'netcdf'")
            else if (.not. job%keeps_rows()) then
                call problems%add(key_of_level, 'there are no rows to compress', 'omit it')
            else if (has_netcdf .and. .not. has_compression) then
                call problems%add(key_of_level, 'the NetCDF library of this build has no format NetCDF-4', 'omit it')
            end if
        end if
        if (job%input%scene%format /= 'netcdf') return
        if (.not. has_netcdf) then
            call problems%add(key, 'this build has no NetCDF', 'SPINTOP_NETCDF=1 scripts/run ... makes a build with NetCDF')
        else if (.not. info%has_netcdf) then
            call problems%add(key, 'the table of ' // info%phrase // ' cannot be NetCDF', hint)
        else if (job%keeps_rows() .and. job%axes%cases > most_netcdf_rows) then
            call problems%add(key, 'a NetCDF table holds ' // to_text(most_netcdf_rows) // ' cases at most', hint)
        else if (job%plan%samples > most_netcdf_rows) then
            call problems%add(key, 'a NetCDF table holds ' // to_text(most_netcdf_rows) // ' rows at most', hint)
        end if
    end subroutine refuse_netcdf

    !> Returns an error, the same in all ranks, if the jobs would discard rows of interrupted runs without a
    !> request.
    subroutine protect_interrupted(prepared, options, error)
        type(prepared_t), intent(in) :: prepared(:) !! the jobs with their studies
        type(options_t), intent(in) :: options !! options of the command line
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: i

        if (options%ranks%is_writer() .and. .not. (options%resume .or. options%restart)) then
            do i = 1, size(prepared)
                associate (job => prepared(i)%job)
                    call refuse_to_discard_idle(job%files%table, error)
                    if (.not. allocated(error) .and. job%files%events /= '') then
                        call refuse_to_discard_idle(job%files%events, error)
                    end if
                end associate
                if (allocated(error)) exit
            end do
        end if
        call options%ranks%agree(error)
    end subroutine protect_interrupted

end module spintop_preparation
