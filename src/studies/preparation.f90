!> Makes jobs of inputs: each is read, checked and planned by its study, before any is run. Numbers whose unit is that
!> of something that the input names elsewhere are converted: the ends of an axis have the unit of its parameter, the standard
!> deviation of a sensor that of its column. No file that a job writes may replace one that is read, or that another job writes.
!> Events and columns are selected by the texts of a scene.
module spintop_preparation
    use spintop_axes_of_scene, only: find_in_unit
    use spintop_case, only: case_t
    use spintop_certificate, only: balls_hint, balls_missing, has_balls
    use spintop_diagnostics, only: diagnostics_t
    use spintop_effects_of_scene, only: read_effect_tables
    use spintop_errors, only: error_t, input_error
    use spintop_event, only: occasion_knot, occasion_slip, occasion_stuck
    use spintop_event_recorder, only: column_event_t, read_event
    use spintop_files, only: file_exists, is_same_file, path_from
    use spintop_fit_study, only: residual_path
    use spintop_job, only: job_t
    use spintop_kinds, only: dp
    use spintop_namelist, only: read_namelist
    use spintop_netcdf_grid, only: most_netcdf_rows
    use spintop_netcdf_table, only: has_compression, has_netcdf
    use spintop_study, only: options_t, study_info_t, study_t
    use spintop_own_butcher_tables, only: read_tables, path_of_table
    use spintop_parameter, only: parameter_t
    use spintop_parameters, only: unset_integer, parameter_table_t
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: describe_scene, scene_t, reference_names
    use spintop_sensitivity, only: is_sensitivity, split_name
    use spintop_statistics_output, only: path_beside
    use spintop_studies, only: create_study, listed_studies
    use spintop_study_column, only: find_column, needs_effects, needs_exact, needs_work, study_column_t, by_default, &
        categorical, compares, is_end, proof_group
    use spintop_sweep_result, only: sweep_columns
    use spintop_journaled_table, only: refuse_to_discard, stem_of
    use spintop_terminal, only: message_width
    use spintop_sweep_axes, only: base_of
    use spintop_text, only: append, escaped, string_t, to_text, join
    use spintop_trajectory_columns, only: trajectory_columns
    use spintop_uncertainties, only: check_uncertainties
    use spintop_units, only: convert_unit, units_of
    implicit none
    private
    public :: prepared_t, prepare_jobs, prepare_job, protect_interrupted, convert_named_units, name_job, name_outputs, &
        refuse_overwriting, tables_written, choose_events

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

        if (.not. allocated(job)) allocate (job)
        job%input%path = input
        call name_job(job)
        call describe_scene(job%input%scene, job%input%table)
        call job%input%table%verify(error)
        if (allocated(error)) return
        call read_namelist(input, options%overrides, job%input%table, diagnostics, error, text, options%verifies)
        if (allocated(error)) return
        if (.not. diagnostics%has_errors()) call convert_named_units(job%input%scene, job%input%table, diagnostics)
        call read_effect_tables(input, job%input%scene%effects, problems)
        call read_tables(input, job%input%scene, problems)
        call create_study(trim(job%input%scene%kind), study)
        job%has_case = study%info%has_case
        call refuse_for_kind(study%info, job, problems)
        allocate (job%axes%axis(0))
        if (study%info%needs_axes .or. (study%info%takes_axes .and. job%names_axes())) call job%make_axes(problems, diagnostics)
        call study%check(job, problems)
        call refuse_run(study%info, job, options, problems)
        call choose_columns(study, job, problems)
        call study%complete(job, problems)
        call choose_events(study%info, job%input%scene, job%case, job%events, problems)
        if (job%input%scene%stop_after /= unset_integer) job%stop_after = job%input%scene%stop_after
        call problems%report_to(job%input%table, diagnostics)
        call diagnostics%raise(error, message_width())
        if (allocated(error)) return
        job%warnings = ''
        job%late_warnings = ''
        if (diagnostics%has_warnings()) job%warnings = diagnostics%report(message_width())
        call name_outputs(options, job)
    end subroutine prepare_job

    !> Reports what no study may ask for, and what this kind cannot do: it has no axes, or no statistics.
    subroutine refuse_for_kind(info, job, problems)
        type(study_info_t), intent(in) :: info
        type(job_t), intent(in) :: job
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: sweep = "set study.kind = 'sweep'"

        if (scan(trim(job%input%scene%file), '/') > 0) call problems%add( &
            'output.file', 'the name of the table contains a slash', 'name the folder with --output')
        if (job%names_axes() .and. .not. info%takes_axes) call problems%add('sweep', info%phrase // ' has no axes', sweep)
        if (job%names_statistics() .and. .not. info%has_statistics) call problems%add( &
            'statistics', info%phrase // ' has no statistics', 'omit the group, or ' // sweep)
        if (job%input%scene%rows /= '' .and. .not. info%has_statistics) call problems%add( &
            'output.rows', info%phrase // ' always has its rows', 'omit it')
    end subroutine refuse_for_kind

    !> Reports parts of studies without such, a resumed run of those that keep nothing of an interrupted one, and a NetCDF table
    !> that a study, or this build, cannot write.
    subroutine refuse_run(info, job, options, problems)
        type(study_info_t), intent(in) :: info
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: key = 'output.format', hint = "set output.format = 'csv'", &
            key_of_level = 'output.compression'

        if (options%shard%is_part() .and. .not. info%has_parts) call problems%add( &
            'study.kind', '--shard is not for ' // info%plural // ', which have no parts', 'omit --shard')
        if (options%resume .and. .not. info%resumes) call problems%add('study.kind', &
            '--resume is for sweeps and trajectories: this study is always computed as a whole', 'omit --resume')
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
            call problems%add(key, 'this build has no NetCDF', &
                              'SPINTOP_NETCDF=1 scripts/setup installs it, and the next scripts/run builds with it')
        else if (.not. info%has_netcdf) then
            call problems%add(key, 'the table of ' // info%phrase // ' cannot be NetCDF', hint)
        else if (job%keeps_rows() .and. job%axes%cases > most_netcdf_rows) then
            call problems%add(key, 'a NetCDF table holds ' // to_text(most_netcdf_rows) // ' cases at most', hint)
        else if (job%plan%samples > most_netcdf_rows) then
            call problems%add(key, 'a NetCDF table holds ' // to_text(most_netcdf_rows) // ' rows at most', hint)
        end if
    end subroutine refuse_run

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
                    call refuse_to_discard(job%files%table, error, is_ours=.false.)
                    if (.not. allocated(error) .and. job%files%events /= '') then
                        call refuse_to_discard(job%files%events, error, is_ours=.false.)
                    end if
                end associate
                if (allocated(error)) exit
            end do
        end if
        call options%ranks%agree(error)
    end subroutine protect_interrupted

    !> Converts the numbers that were given with a unit to that which they have to have; what cannot be converted is an error.
    subroutine convert_named_units(scene, table, diagnostics)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(parameter_table_t), intent(inout) :: table !! its parameters, all read
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        integer :: i, row, column

        do i = 1, table%count
            if (.not. allocated(table%parameters(i)%units)) cycle
            do row = 1, table%parameters(i)%extents(1)
                do column = 1, table%parameters(i)%extents(2)
                    if (.not. allocated(table%parameters(i)%units(row, column)%text)) cycle
                    if (table%parameters(i)%units(row, column)%text == '') cycle
                    call convert_element(scene, table, table%parameters(i), row, column, diagnostics)
                end do
            end do
        end do
    end subroutine convert_named_units

    !> Converts one element.
    subroutine convert_element(scene, table, parameter, row, column, diagnostics)
        type(scene_t), intent(in) :: scene
        type(parameter_table_t), intent(in) :: table
        type(parameter_t), intent(inout) :: parameter
        integer, intent(in) :: row, column
        type(diagnostics_t), intent(inout) :: diagnostics
        character(:), allocatable :: name, unit, problem, of
        real(dp) :: factor
        integer :: number
        logical :: is_known

        number = column
        if (parameter%rank == 2) number = row
        associate (names => table%parameters(table%find(parameter%unit_of)), given => parameter%units(row, column)%text)
            name = names%text_at(number)
            name = trim(name(:scan(name // '=', '=') - 1)) ! of a mapped column of a fit
            of = names%name // '(' // to_text(number) // ')'
            if (name == '') then
                call diagnostics%error(parameter%places(row, column), parameter%element_name(row, column) // &
                                       ' has a unit, but ' // of // ' is not given', 'its unit is that of ' // of)
                parameter%faulty = .true.
                return
            end if
            call find_unit_of(name, table, unit, is_known)
            if (.not. is_known) return ! The name is refused elsewhere.
            if (parameter%name == 'sweep.mean' .or. parameter%name == 'sweep.deviation') then
                if (scene%distribution(number) == 'lognormal') then
                    unit = ''
                    name = 'the logarithm of ' // name
                end if
            end if
            call convert_unit(given, unit, factor, problem)
            if (problem /= '') then
                call diagnostics%error(parameter%places(row, column), name // ': ' // problem, units_of(unit))
                parameter%faulty = .true.
            else
                parameter%reals(row, column) = parameter%reals(row, column) * factor
                call parameter%set_unit(row, column, '')
            end if
        end associate
    end subroutine convert_element

    !> The unit of a number of the input, of a column of trajectories or sweeps, or of the offset or scale of a sensor.
    subroutine find_unit_of(name, table, unit, is_known)
        character(*), intent(in) :: name !! as `initial.omega3`, `theta_deg`, `offset.theta_deg`
        type(parameter_table_t), intent(in) :: table
        character(:), allocatable, intent(out) :: unit
        logical, intent(out) :: is_known
        character(*), parameter :: offset = 'offset.'
        type(study_column_t) :: found
        character(:), allocatable :: key, problem, hint
        real(dp) :: factor

        unit = ''
        is_known = .true.
        if (index(name, 'scale.') == 1) return
        call find_in_unit(name, table, key, unit, factor, hint)
        if (index(name, 'mounting(') == 1) call find_in_unit('fit.mounting', table, key, unit, factor, hint)
        if (index(name, 'lever_arm(') == 1) call find_in_unit('fit.lever_arm', table, key, unit, factor, hint)
        if (table%find(base_of(key)) > 0) return
        associate (column => name(merge(len(offset), 0, index(name, offset) == 1) + 1:))
            call find_column(trajectory_columns, column, found, problem, hint)
            if (found%place == 0) call find_column(sweep_columns, column, found, problem, hint)
        end associate
        is_known = found%place > 0
        unit = trim(found%unit)
    end subroutine find_unit_of

    !> Names a job after its input.
    subroutine name_job(job)
        type(job_t), intent(inout) :: job !! the job, with the path of its input
        integer :: dot
        job%name = job%input%path(index(job%input%path, '/', back=.true.) + 1:)
        dot = index(job%name, '.', back=.true.)
        if (dot > 1) job%name = job%name(:dot - 1)
    end subroutine name_job

    !> Sets the names of the files that a job writes.
    subroutine name_outputs(options, job)
        type(options_t), intent(in) :: options !! options of the command line
        type(job_t), intent(inout) :: job !! the job, named after its input
        character(6) :: ending
        if (job%input%scene%file /= '') job%name = stem_of(trim(job%input%scene%file))
        associate (stem => options%output // '/' // job%name // options%shard%suffix())
            ending = merge('.nc ', '.csv', job%input%scene%format == 'netcdf')
            job%files%table = stem // trim(ending)
            job%files%statistics = ''
            if (job%statistics%is_wanted) then
                if (options%shard%is_part()) ending = '.state'
                job%files%statistics = stem // '.statistics' // trim(ending)
            end if
            if (.not. job%keeps_rows()) then
                job%files%table = job%files%statistics
                job%files%statistics = ''
            end if
            job%files%log = stem // '.log'
            job%files%events = ''
            if (any(job%events%is_listed)) job%files%events = stem // '.events.csv'
        end associate
    end subroutine name_outputs

    !> Returns an error if a job would replace a file that another one writes, or either of them one that is read.
    subroutine refuse_overwriting(job, other, is_other, error)
        type(job_t), intent(in) :: job, other !! the jobs
        logical, intent(in) :: is_other !! whether they are two
        type(error_t), allocatable, intent(inout) :: error !! not allocated if all is well
        type(string_t), allocatable :: written(:), theirs(:)
        integer :: i, k

        allocate (written, source=files_written(job))
        allocate (theirs, source=files_written(other))
        do i = 1, size(written)
            do k = 1, size(theirs)
                if (.not. is_other .or. written(i)%text /= theirs(k)%text) cycle
                call refuse(job, written(i)%text, 'is also that of ' // escaped(other%input%path))
                return
            end do
        end do
        call compare(job, written, files_read(other))
        if (.not. allocated(error)) call compare(other, theirs, files_read(job))

    contains

        !> Refuses to replace what is read.
        subroutine compare(writer, files, sources)
            type(job_t), intent(in) :: writer
            type(string_t), intent(in) :: files(:), sources(:)
            integer :: i, k
            do i = 1, size(files)
                do k = 1, size(sources)
                    if (allocated(error)) return
                    associate (file => files(i)%text, source => sources(k)%text)
                        if (.not. is_same_file(file, source)) cycle
                        call refuse(writer, file, 'would replace the file that is read as ' // escaped(source))
                    end associate
                end do
            end do
        end subroutine compare

        !> Makes the error.
        subroutine refuse(writer, file, what)
            type(job_t), intent(in) :: writer
            character(*), intent(in) :: file, what
            error = input_error(escaped(writer%input%path) // ': error: its table ' // escaped(file) // ' ' // what // &
                                '; set output.file, or name another folder with --output')
        end subroutine refuse

    end subroutine refuse_overwriting

    !> The names of the tables of a job that was run, each with a null character behind it.
    function tables_written(job) result(names)
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: names
        type(string_t), allocatable :: files(:)
        integer :: i
        names = ''
        allocate (files, source=files_written(job))
        do i = 1, size(files)
            if (files(i)%text == job%files%log .or. .not. file_exists(files(i)%text)) cycle
            names = names // files(i)%text // achar(0)
        end do
    end function tables_written

    !> The files that a job may write.
    function files_written(job) result(files)
        type(job_t), intent(in) :: job
        type(string_t), allocatable :: files(:)
        character(:), allocatable :: statistics
        integer :: i

        call append(files, job%files%table)
        if (job%axes%cases > 0) call append(files, job%files%log)
        if (job%files%events /= '') call append(files, job%files%events)
        do i = 1, count(job%input%scene%fit%data /= '')
            call append(files, residual_path(job%files%table, i))
        end do
        if (.not. job%statistics%is_wanted) return
        statistics = job%files%table
        if (job%files%statistics /= '') statistics = job%files%statistics
        call append(files, statistics)
        call append(files, path_beside(statistics, 'histogram'))
        call append(files, path_beside(statistics, 'indices'))
    end function files_written

    !> The files that a job reads.
    function files_read(job) result(files)
        type(job_t), intent(in) :: job
        type(string_t), allocatable :: files(:)
        integer :: i
        associate (scene => job%input%scene)
            call append(files, job%input%path)
            if (scene%sweep_table /= '') call append(files, path_from(job%input%path, scene%sweep_table))
            if (scene%effects%friction_table /= '') call append(files, path_from(job%input%path, scene%effects%friction_table))
            if (scene%effects%torque_table /= '') call append(files, path_from(job%input%path, scene%effects%torque_table))
            do i = 1, size(scene%tableaus)
                call append(files, path_from(job%input%path, path_of_table(scene%tableaus(i)%key)))
            end do
            do i = 1, count(scene%fit%data /= '')
                call append(files, path_from(job%input%path, scene%fit%data(i)))
            end do
            if (all(reference_names /= scene%precision_reference)) then
                call append(files, path_from(job%input%path, scene%precision_reference))
            end if
        end associate
    end function files_read

    !> The events for the table, and those that end the motion. An event that is both occurs once.
    subroutine choose_events(study, scene, case, events, problems)
        type(study_info_t), intent(in) :: study !! the kind of study
        type(scene_t), intent(in) :: scene !! contents of the input
        type(case_t), intent(in) :: case !! the case: whether its body has effects decides which events it can have
        type(column_event_t), allocatable, intent(out) :: events(:) !! events to search for
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(column_event_t), allocatable :: some(:)
        character(*), parameter :: stop_key = 'span.stop_at'
        character(:), allocatable :: key
        integer :: i, k

        allocate (events(0))
        if ((.not. study%has_events) .and. any(scene%events /= '')) then
            call problems%add('output.events', 'only a trajectory has a table of events', &
                              "omit it, or set study.kind = 'trajectory'")
            return
        end if
        do i = 1, size(scene%events)
            if (scene%events(i) == '') cycle
            key = 'output.events(' // to_text(i) // ')'
            call read_text(key, scene%events(i))
            do k = 1, size(some)
                if (any(events%event%name == some(k)%event%name)) then
                    call problems%add(key, 'event ''' // trim(some(k)%event%name) // ''' is named twice', &
                                      'name it once')
                    exit
                end if
                some(k)%is_listed = .true.
                events = [events, some(k)]
            end do
        end do
        if (scene%stop_at == '') then
            if (scene%stop_after /= unset_integer) then
                call problems%add('span.stop_after', 'there is no event to stop at', 'give stop_at')
            end if
            return
        end if
        call read_text(stop_key, scene%stop_at)
        do k = 1, size(some)
            if (all(events%event%name /= some(k)%event%name)) events = [events, some(k)]
            where (events%event%name == some(k)%event%name) events%ends = .true.
        end do

    contains

        !> Reads the text of one parameter into `some`.
        subroutine read_text(name, text)
            character(*), intent(in) :: name, text
            character(:), allocatable :: problem, hint
            call read_event(text, some, problem, hint)
            if (problem == '' .and. any(some%column%is(needs_exact))) then
                if (.not. study%keeps_exact_motion .or. .not. (problems%any() .or. case%body%has_closed_form())) then
                    problem = 'this event needs the exact solution, which '
                    if (study%keeps_exact_motion) then
                        problem = problem // 'this body does not have'
                    else
                        problem = problem // study%phrase // ' does not use'
                    end if
                    hint = 'use another column'
                end if
            end if
            if (problem == '' .and. .not. problems%any()) call check_events(case, some, problem, hint)
            if (problem /= '') call problems%add(name, problem, hint)
        end subroutine read_text

    end subroutine choose_events

    !> Why a body cannot have events. The work of effects is known in the rows of a motion, not where events are sought; only dry
    !> friction by the exact law stops a body, and only a table has rows.
    subroutine check_events(case, some, problem, hint)
        type(case_t), intent(in) :: case
        type(column_event_t), intent(in) :: some(:)
        character(:), allocatable, intent(inout) :: problem, hint
        logical :: is_affected, is_dry, has_table
        is_affected = allocated(case%given_body%effects)
        is_dry = .false.
        has_table = .false.
        if (is_affected) then
            is_dry = case%given_body%effects%is_dry()
            has_table = allocated(case%given_body%effects%table)
        end if
        hint = 'use another column'
        if (any(some%column%is(needs_effects)) .and. .not. is_affected) then
            problem = 'this event needs effects, and the body has none'
        else if (any(some%column%is(needs_work)) .and. is_affected) then
            problem = 'this event needs the work of effects, which is computed for the rows of a motion only'
        else if (.not. is_dry .and. any(some%event%occasion == occasion_stuck .or. some%event%occasion == occasion_slip)) then
            problem = 'only a body with dry friction that is not smoothed sticks and slips'
            hint = 'give effects.friction_torque or friction_coefficient, without friction_smoothing'
        else if (.not. has_table .and. any(some%event%occasion == occasion_knot)) then
            problem = 'this event needs a table of torques'
            hint = 'give effects.torque_table'
        end if
    end subroutine check_events

    !> Selects the columns of a job: the named ones, all, or the default set; problems are reported.
    subroutine choose_columns(study, job, problems)
        class(study_t), intent(in) :: study !! the kind of study
        type(job_t), target, intent(inout) :: job !! with a plan
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(study_column_t), allocatable :: chosen(:)
        integer :: i

        if (job%input%scene%certified) then
            if (.not. study%info%takes_columns) then
                call problems%add('output.certified', study%info%phrase // ' has no certified numbers', 'omit it')
            else if (.not. has_balls()) then
                call problems%add('output.certified', balls_missing, balls_hint)
            end if
        end if
        if (allocated(job%axes%axis)) then
            if (job%axes%varies('uncertainty')) call problems%add('sweep', 'radii are the same in all cases', &
                                                                  'give them in the group uncertainty')
        end if
        associate (named => job%input%scene%columns)
            if (.not. study%info%takes_columns) then
                call check_uncertainties(job%input%scene, .false., problems)
                if (any(named /= '')) then
                    call problems%add('output.columns', 'the columns of this study are fixed', 'omit it')
                end if
                return
            end if
            chosen = pack(study%columns, can_have(study%columns, job%case))
            if (all(named == '')) then
                ! The exact solution is not compared with itself, and the span ends where no event may end the motion earlier.
                chosen = pack(chosen, chosen%is(by_default) .and. .not. (job%plan%exact .and. chosen%is(compares)) .and. &
                              .not. (job%input%scene%stop_at == '' .and. chosen%is(is_end)))
            else
                chosen = pack(chosen, named(1) == 'all' .and. chosen%group /= proof_group)
                do i = merge(2, 1, named(1) == 'all'), size(named)
                    if (is_sensitivity(named(i))) then
                        call add_sensitivity(study, job, i, problems)
                    else if (named(i) /= '') then
                        call add_column(study, job, i, chosen, problems)
                    end if
                end do
            end if
        end associate
        call check_uncertainties(job%input%scene, any(chosen%group == proof_group), problems)
        call move_alloc(chosen, job%columns)
    end subroutine choose_columns

    !> Adds the column that element `i` of the list in the scene names.
    subroutine add_column(study, job, i, columns, problems)
        class(study_t), intent(in) :: study
        type(job_t), intent(in) :: job
        integer, intent(in) :: i
        type(study_column_t), allocatable, intent(inout) :: columns(:)
        type(problems_t), intent(inout) :: problems
        type(study_column_t) :: found
        character(:), allocatable :: name, key

        name = trim(job%input%scene%columns(i))
        key = 'output.columns(' // to_text(i) // ')'
        call find_named(study, job, key, name, found, problems)
        if (found%place == 0) return
        if (any(columns%name == found%name)) then
            call problems%add(key, "column '" // name // "' is named twice", 'name it once')
        else if (found%group == proof_group .and. .not. has_balls()) then
            call problems%add(key, "column '" // name // "': " // balls_missing, balls_hint)
        else
            call check_column(job, key, found, 'omit it', problems)
            columns = [columns, found]
        end if
    end subroutine add_column

    !> Adds the derivative of a column that element `i` of the list in the scene names.
    subroutine add_sensitivity(study, job, i, problems)
        class(study_t), intent(in) :: study
        type(job_t), target, intent(inout) :: job
        integer, intent(in) :: i
        type(problems_t), intent(inout) :: problems
        type(study_column_t) :: found
        character(:), allocatable :: column, name_of_key, key, problem, hint
        integer :: place_of_key
        logical :: is_new

        key = 'output.columns(' // to_text(i) // ')'
        call split_name(trim(job%input%scene%columns(i)), column, name_of_key)
        call find_named(study, job, key, column, found, problems)
        if (found%place > 0) then
            if (found%is(categorical) .or. found%group == proof_group) then
                call problems%add(key, "column '" // column // "' has no derivatives", 'name a column of numbers')
                found%place = 0
            else
                call check_column(job, key, found, 'omit its derivative', problems)
            end if
        end if
        call job%sensitivities%find_key(name_of_key, job%input%table, job%axes, place_of_key, problem, hint)
        if (problem /= '') call problems%add(key, problem, hint)
        if (found%place == 0 .or. place_of_key == 0) return
        call job%sensitivities%add(found, place_of_key, is_new)
        if (.not. is_new) call problems%add(key, "column '" // trim(job%input%scene%columns(i)) // "' is named twice", &
                                            'name it once')
    end subroutine add_sensitivity

    !> Reports a column that the case cannot have, unless other problems leave open what it is.
    subroutine check_column(job, key, column, hint, problems)
        type(job_t), intent(in) :: job
        character(*), intent(in) :: key, hint
        type(study_column_t), intent(in) :: column
        type(problems_t), intent(inout) :: problems
        character(:), allocatable :: need
        if (problems%any()) return
        if (can_have(column, job%case)) return
        need = 'the exact solution'
        if (column%is(needs_effects)) need = 'effects'
        call problems%add(key, "column '" // trim(column%quantity()) // "' needs " // need // &
                          ', which this body does not have', hint)
    end subroutine check_column

    !> Whether the table of a case can have a column.
    elemental logical function can_have(column, case)
        type(study_column_t), intent(in) :: column
        type(case_t), intent(in) :: case
        can_have = (case%body%has_closed_form() .or. .not. column%is(needs_exact)) .and. &
                   (allocated(case%given_body%effects) .or. .not. column%is(needs_effects))
    end function can_have

    !> The column of a name; a problem if there is none: the study that has it, its unit, or a similar name. Numbers that are
    !> proved are so in their own unit only.
    subroutine find_named(study, job, key, name, found, problems)
        class(study_t), intent(in) :: study
        type(job_t), intent(in) :: job
        character(*), intent(in) :: key, name
        type(study_column_t), intent(out) :: found !! its place is 0 if there is a problem
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: ending = '_bound'
        class(study_t), allocatable :: other
        type(study_column_t) :: theirs
        type(string_t), allocatable :: owners(:)
        character(:), allocatable :: problem, hint, ignored, ignored_hint
        integer :: last, i

        call find_column(study%columns, name, found, problem, hint)
        if (found%place > 0) then
            if (.not. found%is_converted()) return
            if (.not. job%input%scene%certified .and. found%group /= proof_group) return
            call problems%add(key, "column '" // name // "': a number is proved in the unit of the column only", &
                              "use '" // trim(found%quantity()) // "', which is in " // &
                              trim(study%columns(found%place)%unit))
            found%place = 0
            return
        end if
        allocate (owners(0))
        do i = 1, size(listed_studies)
            call create_study(listed_studies(i), other)
            call find_column(other%columns, name, theirs, ignored, ignored_hint)
            if (theirs%place > 0) call append(owners, other%info%plural)
        end do
        if (size(owners) > 0) then
            last = size(owners)
            if (last > 1) owners(last)%text = join(owners(:last - 1), ', ') // ' and ' // owners(last)%text
            call problems%add(key, study%info%phrase // " has no column '" // name // "': " // owners(last)%text // ' have it', &
                              "omit it, or set another study.kind; `spintop list columns` shows each study's")
            return
        end if
        if (hint == '') hint = '`spintop list columns` shows them all'
        ! Proofs enclose the motion at a time.
        last = max(0, len(name) - len(ending))
        if (name(last + 1:) == ending .and. any(study%columns%name == name(:last))) then
            problem = "column '" // name // "': proofs bound the attitude and the angular velocity at a time, not " // name(:last)
            hint = 'omit it; `spintop list columns` shows the bounds that there are'
        end if
        call problems%add(key, problem, hint, is_certain=.true.)
    end subroutine find_named

end module spintop_preparation
