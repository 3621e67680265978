!> A job: one input file read, checked and planned, ready to run.
module spintop_job
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_axes_of_scene, only: count_axes, make_axes
    use spintop_axes_of_table, only: read_axes
    use spintop_body, only: body_t
    use spintop_body_of_scene, only: make_body
    use spintop_case, only: case_t, make_case
    use spintop_column_choice, only: choose_columns
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_event_choice, only: choose_events
    use spintop_event_text, only: column_event_t
    use spintop_namelist, only: read_namelist
    use spintop_netcdf_grid, only: most_netcdf_rows
    use spintop_netcdf_table, only: has_netcdf
    use spintop_number_slot, only: number_slot_t
    use spintop_parameters, only: parameter_table_t, unset_integer
    use spintop_plan, only: plan_t, make_plan
    use spintop_precision_plan, only: make_precision_plan, precision_plan_t, read_reference
    use spintop_problems, only: problems_t
    use spintop_ranks, only: ranks_t
    use spintop_scene, only: scene_t, describe_scene
    use spintop_shard, only: shard_t
    use spintop_stability_plan, only: make_stability_plan, stability_plan_t
    use spintop_sweep_axes, only: axes_t, put_values
    use spintop_terminal, only: message_width
    use spintop_text, only: string_t, to_text
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
        call choose_columns(job%scene, job%case, job%plan%exact, job%columns, problems)
        call choose_events(job%scene, job%case, job%events, problems)
        if (job%scene%stop_after /= unset_integer) job%stop_after = job%scene%stop_after
        call problems%report_to(job%table, diagnostics)
        call diagnostics%raise(error, message_width())
        if (allocated(error)) return
        job%warnings = ''
        if (diagnostics%has_warnings()) job%warnings = diagnostics%report(message_width())
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
        if (has_axes .or. job%scene%kind == 'sweep') then
            if (job%axes%varies('top')) call warn_of_bodies(first, job%axes%slots_in(first_table), job%axes, problems)
        end if
    end subroutine plan_job

    !> Passes on what is odd about the body of a later case, the first such of all cases or, of very many, of
    !> some evenly among them. The scene is left as that case has it.
    subroutine warn_of_bodies(scene, slots, axes, problems)
        type(scene_t), intent(in) :: scene
        type(number_slot_t), intent(in) :: slots(:) !! of the scene
        type(axes_t), intent(in) :: axes
        type(problems_t), intent(inout) :: problems
        integer(int64), parameter :: most_looked_at = 1000000
        type(problems_t) :: of_case
        type(body_t) :: body
        integer(int64) :: number
        logical :: found

        do number = 1, axes%cases, max(1_int64, axes%cases / most_looked_at)
            call put_values(slots, axes%values_of(number))
            of_case = problems_t()
            call make_body(scene, body, of_case)
            if (number == 1) then
                ! What is odd about the first case was said when it was made.
                if (of_case%any_warning()) return
                cycle
            end if
            call problems%take_warnings(of_case, 'case ' // to_text(number) // ': ', found)
            if (found) return
        end do
    end subroutine warn_of_bodies

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
