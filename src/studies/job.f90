!> A job: one input file read, checked and planned, ready to run.
module spintop_job
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_axes_of_scene, only: count_axes, make_axes
    use spintop_axes_of_table, only: read_axes
    use spintop_case, only: case_t, make_case
    use spintop_columns, only: trajectory_columns, default_trajectory_columns, needs_exact_motion
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_event_choice, only: choose_events
    use spintop_event_text, only: column_event_t
    use spintop_namelist, only: read_namelist
    use spintop_netcdf_axis, only: most_netcdf_rows
    use spintop_netcdf_table, only: has_netcdf
    use spintop_parameters, only: parameter_table_t, unset_integer
    use spintop_plan, only: plan_t, make_plan
    use spintop_precision_plan, only: make_precision_plan, precision_plan_t, read_reference
    use spintop_problems, only: problems_t
    use spintop_ranks, only: ranks_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_shard, only: shard_t
    use spintop_stability_plan, only: make_stability_plan, stability_plan_t
    use spintop_sweep_axes, only: axes_t, put_values
    use spintop_sweep_columns, only: sweep_columns, costly_groups
    use spintop_text, only: string_t, nearest_word, to_text
    implicit none
    private
    public :: job_t, options_t, prepare_job, shell_word

    !> What the command line says for all inputs, and the processes that carry it out.
    type :: options_t
        !> Folder for results.
        character(:), allocatable :: output
        !> Overrides `group.key=value`, in the order given.
        type(string_t), allocatable :: overrides(:)
        !> 0: all cores.
        integer :: threads = 0
        logical :: quiet = .false.
        logical :: progress = .false.
        !> Which part of a sweep, and whether to resume an interrupted one or to discard it.
        type(shard_t) :: shard
        logical :: resume = .false., restart = .false.
        !> The program with these options, as a shell takes them, but for the inputs and those two.
        character(:), allocatable :: command
        type(ranks_t) :: ranks
    end type options_t

    !> An input made ready. The table points into the scene: a job must stay where it was prepared.
    type :: job_t
        !> The input's path, and its name without folder and ending.
        character(:), allocatable :: input, name
        !> Path of the table to write, and of the summary that a sweep keeps beside it.
        character(:), allocatable :: output, log
        !> Path of the table of events; empty without one.
        character(:), allocatable :: event_output
        type(scene_t) :: scene
        type(parameter_table_t) :: table
        type(case_t) :: case
        type(plan_t) :: plan
        type(axes_t) :: axes
        type(stability_plan_t) :: stability
        type(precision_plan_t) :: precision
        !> Chosen columns by their place in the list of all columns of the study.
        integer, allocatable :: columns(:)
        !> Events to look for.
        type(column_event_t), allocatable :: events(:)
        !> The one of those that end the motion which does.
        integer :: stop_after = 1
        !> Warnings on the input, ready to print; empty without any.
        character(:), allocatable :: warnings
    end type job_t

contains

    !> Reads an input with the overrides of the command line, makes its case, plan and columns, and
    !> reports everything that is wrong with it at once.
    subroutine prepare_job(input, options, job, error)
        character(*), intent(in) :: input
        type(options_t), intent(in) :: options
        type(job_t), target, intent(inout) :: job
        type(error_t), allocatable, intent(out) :: error
        type(diagnostics_t) :: diagnostics
        type(problems_t) :: problems

        job%input = input
        job%name = base_name(input)
        call describe_scene(job%scene, job%table)
        call job%table%verify(error)
        if (allocated(error)) return
        call read_namelist(input, options%overrides, job%table, diagnostics, error)
        if (allocated(error)) return
        call plan_job(job, problems, diagnostics)
        if (job%scene%kind /= 'sweep') call refuse_for_sweeps_only(options, problems)
        if (job%scene%format == 'netcdf') call refuse_for_netcdf(job, options, problems)
        call choose_columns(job, problems)
        call choose_events(job%scene, job%case, job%events, problems)
        if (job%scene%stop_after /= unset_integer) job%stop_after = job%scene%stop_after
        call problems%tell(job%table, diagnostics)
        call diagnostics%raise(error)
        if (allocated(error)) return
        job%warnings = ''
        if (diagnostics%has_warnings()) job%warnings = diagnostics%report()
        if (job%scene%file /= '') job%name = base_name(trim(job%scene%file))
        associate (stem => options%output // '/' // job%name // options%shard%suffix())
            job%output = stem // '.csv'
            if (job%scene%format == 'netcdf') job%output = stem // '.nc'
            job%log = stem // '.log'
            job%event_output = ''
            if (any(job%events%is_listed)) job%event_output = stem // '.events.csv'
        end associate
    end subroutine prepare_job

    !> Options and ranks mean something for sweeps only.
    subroutine refuse_for_sweeps_only(options, problems)
        type(options_t), intent(in) :: options
        type(problems_t), intent(inout) :: problems
        if (options%shard%is_part()) then
            call problems%add('study.kind', '--shard is for sweeps: this study has no parts', 'leave --shard out')
        end if
        if (options%resume) then
            call problems%add('study.kind', '--resume is for sweeps: this study is always computed as a whole', &
                              'leave --resume out')
        end if
        if (options%ranks%count > 1) then
            call problems%add('study.kind', 'MPI is for sweeps: this study is computed by one process', &
                              'run it without mpirun')
        end if
    end subroutine refuse_for_sweeps_only

    !> What a NetCDF table cannot be.
    subroutine refuse_for_netcdf(job, options, problems)
        type(job_t), intent(in) :: job
        type(options_t), intent(in) :: options
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: key = 'output.format', hint = "set output.format = 'csv'"
        if (.not. has_netcdf()) then
            call problems%add(key, 'this build has no NetCDF', 'SPINTOP_NETCDF=1 scripts/run ... builds one that has')
        else if (job%scene%kind /= 'sweep') then
            call problems%add(key, 'only the table of a sweep can be NetCDF', hint)
        else if (options%shard%is_part() .or. options%resume) then
            call problems%add(key, 'a NetCDF table is written as a whole: it knows no --shard and no --resume', hint)
        else if (job%axes%cases > most_netcdf_rows) then
            call problems%add(key, 'a NetCDF table holds ' // to_text(most_netcdf_rows) // ' cases at most', hint)
        end if
    end subroutine refuse_for_netcdf

    !> Case, axes and plan. The case of a sweep is its first; the others are made as they come.
    subroutine plan_job(job, problems, diagnostics)
        type(job_t), target, intent(inout) :: job
        type(problems_t), intent(inout) :: problems
        type(diagnostics_t), intent(inout) :: diagnostics
        type(scene_t), allocatable, target :: first
        type(parameter_table_t) :: first_table
        logical :: has_axes

        if (scan(trim(job%scene%file), '/') > 0) then
            call problems%add('output.file', 'the name of the table holds a slash', &
                              'name the folder with --output')
        end if
        has_axes = count_axes(job%scene) > 0 .or. job%scene%sweep_table /= ''
        if (has_axes .and. (job%scene%kind == 'trajectory' .or. job%scene%kind == 'stability')) then
            call problems%add('sweep', 'a ' // trim(merge('trajectory     ', 'stability study', &
                              job%scene%kind == 'trajectory')) // ' has no axes', "set study.kind = 'sweep'")
            has_axes = .false.
        end if
        allocate (job%axes%axis(0))
        if (job%scene%kind == 'stability') then
            call make_stability_plan(job%scene, job%stability, problems)
            if (problems%any() .or. all(job%stability%cases > 0)) return
        end if
        allocate (first, source=job%scene)
        if (job%scene%kind == 'sweep' .or. has_axes) then
            if (job%scene%sweep_table == '') then
                call make_axes(job%scene, job%table, job%axes, problems)
            else
                call read_axes(job%input, job%scene, job%table, job%axes, problems, diagnostics)
            end if
            if (job%axes%cases == 0) return
            call describe_scene(first, first_table)
            call put_values(job%axes%slots_in(first_table), job%axes%values_of(1_int64))
        end if
        call make_case(first, job%case, problems)
        select case (job%scene%kind)
        case ('work_precision')
            call make_precision_plan(first, job%precision, problems)
            if (problems%any()) return
            call read_reference(job%input, job%scene, job%case, job%precision, problems, diagnostics)
            if (allocated(job%precision%stored) .and. has_axes) then
                call problems%add('work_precision.reference', 'one motion is the reference of many cases', &
                                  "take reference = 'auto'")
            end if
        case ('trajectory', 'sweep')
            if (.not. problems%any()) call make_plan(first, job%case, job%plan, problems)
        end select
    end subroutine plan_job

    !> The columns named, all of them, or the default set.
    subroutine choose_columns(job, problems)
        type(job_t), intent(inout) :: job
        type(problems_t), intent(inout) :: problems
        type(string_t), allocatable :: known(:)
        integer :: i

        if (job%scene%kind == 'stability' .or. job%scene%kind == 'work_precision') then
            if (any(job%scene%columns /= '')) then
                call problems%add('output.columns', 'the table of this study has columns of its own', 'leave it out')
            end if
            return
        end if
        if (job%scene%kind == 'sweep') then
            call take_names(sweep_columns%name)
        else
            call take_names(trajectory_columns%name)
        end if

        if (all(job%scene%columns == '')) then
            if (job%scene%kind == 'sweep') then
                job%columns = [(i, i=1, size(known))]
                job%columns = pack(job%columns, [(all(sweep_columns(i)%group /= costly_groups), i=1, size(known))])
            else
                job%columns = [(place_of(default_trajectory_columns(i)), &
                                i=1, size(default_trajectory_columns))]
                job%columns = pack(job%columns, can_have(job%columns))
            end if
            ! The exact motion compared with itself says nothing.
            if (job%plan%exact) job%columns = pack(job%columns, job%columns /= place_of('orientation_error'))
            ! Nor does the end of the span where nothing may end it sooner.
            if (job%scene%stop_at == '') job%columns = pack(job%columns, job%columns /= place_of('t_end'))
        else if (job%scene%columns(1) == 'all') then
            job%columns = [(i, i=1, size(known))]
            if (job%scene%kind /= 'sweep') job%columns = pack(job%columns, can_have(job%columns))
        else
            allocate (job%columns(0))
            do i = 1, size(job%scene%columns)
                if (job%scene%columns(i) == '') cycle
                call take_column(trim(job%scene%columns(i)))
            end do
        end if

    contains

        subroutine take_names(names)
            character(*), intent(in) :: names(:)
            allocate (known(size(names)))
            do i = 1, size(names)
                known(i)%text = trim(names(i))
            end do
        end subroutine take_names

        !> Place of a column among the known ones, 0 if there is none.
        integer function place_of(name)
            character(*), intent(in) :: name
            do place_of = size(known), 1, -1
                if (known(place_of)%text == name) return
            end do
        end function place_of

        !> Whether the trajectory can have a column: some compare with an exact motion.
        elemental logical function can_have(place)
            integer, intent(in) :: place
            can_have = job%case%body%is_lagrange() &
                       .or. .not. needs_exact_motion(trajectory_columns(place))
        end function can_have

        subroutine take_column(name)
            character(*), intent(in) :: name
            character(:), allocatable :: hint
            integer :: place
            place = place_of(name)
            if (place == 0) then
                hint = nearest_word(name, known)
                if (hint /= '') hint = "did you mean '" // hint // "'?"
                if (hint == '') hint = '`spintop list columns` shows them all'
                call problems%add('output.columns', "there is no column '" // name // "'", hint)
            else if (any(job%columns == place)) then
                call problems%add('output.columns', "column '" // name // "' is named twice", &
                                  'name it once')
            else
                if (job%scene%kind /= 'sweep' .and. .not. problems%any()) then
                    if (.not. can_have(place)) then
                        call problems%add('output.columns', "column '" // name // "' compares with the exact &
                            &motion, and this body has none", 'leave it out')
                    end if
                end if
                job%columns = [job%columns, place]
            end if
        end subroutine take_column

    end subroutine choose_columns

    !> A text as a word of the shell.
    pure function shell_word(text) result(word)
        character(*), intent(in) :: text
        character(:), allocatable :: word
        character(*), parameter :: plain = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,:+@%-'
        integer :: i
        word = text
        if (text /= '' .and. verify(text, plain) == 0) return
        word = ''''
        do i = 1, len(text)
            if (text(i:i) == '''') then
                word = word // '''\'''''
            else
                word = word // text(i:i)
            end if
        end do
        word = word // ''''
    end function shell_word

    !> Name of a file without its folder and its ending.
    pure function base_name(path) result(name)
        character(*), intent(in) :: path
        character(:), allocatable :: name
        integer :: dot
        name = path(index(path, '/', back=.true.) + 1:)
        dot = index(name, '.', back=.true.)
        if (dot > 1) name = name(:dot - 1)
    end function base_name

end module spintop_job
