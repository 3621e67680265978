!> The batch program: reads inputs, runs their studies, and ends with an exit code. With several ranks only
!> the writer prints messages and answers requests other than studies.
program spintop_main
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_command_line, only: describe_usage, read_command_line, request_t
    use spintop_errors, only: error_t, exit_ok, exit_output
    use spintop_execution, only: explain_job, run_job
    use spintop_files, only: complain_of, end_output, print_text, replace_file
    use spintop_listing, only: list_topic
    use spintop_merge, only: merge_parts
    use spintop_preparation, only: prepare_jobs, prepared_t, protect_interrupted, tables_written
    use spintop_process, only: begin_process, check_level, check_stacks, end_process
    use spintop_provenance, only: program_revision, program_version
    use spintop_ranks, only: end_ranks, ranks_t, start_ranks
    use spintop_terminal, only: in_colour
    use spintop_text, only: append, join, string_t, to_text, visible
    use spintop_verification, only: verify_table
    implicit none
    type(ranks_t) :: ranks
    type(request_t) :: request
    type(prepared_t), allocatable, target :: prepared(:)
    type(string_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    character(:), allocatable :: written
    character, parameter :: nl = new_line('a')
    integer(int64) :: cases
    integer :: code, worst, i

    call begin_process()
    call start_ranks(ranks, error)
    if (.not. allocated(error)) call check_stacks(error)
    if (.not. allocated(error)) call check_level(error)
    call ranks%agree(error)
    call end_on(error)
    call read_command_line(request, error)
    call end_on(error)
    if (request%action /= 'run' .and. .not. ranks%is_writer()) call leave(exit_ok)
    select case (request%action)
    case ('help')
        call describe_usage(lines)
    case ('version')
        call append(lines, 'spintop ' // program_version // ' (revision ' // program_revision() // ')')
    case ('list')
        call list_topic(request%topic, request%as_json, lines, error)
        call end_on(error)
    case ('merge')
        call merge_parts(request%merged, request%inputs, cases, error)
        call end_on(error)
        call append(lines, to_text(size(request%inputs)) // ' parts, ' // to_text(cases) // ' cases -> ' // request%merged)
    end select
    if (all(request%action /= [character(7) :: 'run', 'check', 'verify'])) then
        code = exit_ok
        call print_lines(lines, code)
        call leave(code)
    end if

    if (request%action == 'run') request%options%ranks = ranks
    call prepare_jobs(request%inputs, request%options, prepared, error)
    call end_on(error)
    if (request%action == 'run') call protect_interrupted(prepared, request%options, error)
    call end_on(error)
    worst = exit_ok
    written = ''
    do i = 1, size(prepared)
        call complain(prepared(i)%job%warnings)
        code = exit_ok
        if (request%action == 'check') then
            call explain_job(prepared(i)%study, prepared(i)%job, request%options, lines)
        else if (request%action == 'verify') then
            call verify_table(prepared(i)%job, request%options%strict, lines, code, error)
        else
            call run_job(prepared(i)%study, prepared(i)%job, request%options, lines, code, error)
            call complain(prepared(i)%job%late_warnings)
            if (request%written /= '' .and. ranks%is_writer() .and. .not. allocated(error)) then
                written = written // tables_written(prepared(i)%job) ! those of all inputs so far
                call replace_file(request%written, written, error)
            end if
        end if
        if (allocated(error)) then
            call complain(error%message)
            code = error%code
        end if
        call print_lines(lines, code)
        worst = max(worst, code)
    end do
    call leave(worst)

contains

    !> Writes a text to standard error, unless it is empty. It may quote bytes of a damaged file.
    subroutine complain(text)
        character(*), intent(in) :: text
        if (text /= '' .and. ranks%is_writer()) call complain_of(in_colour(visible(text)) // nl)
    end subroutine complain

    !> Writes lines to standard output. If that fails, `code` is raised to the code of an output error.
    subroutine print_lines(lines, code)
        type(string_t), allocatable, intent(in) :: lines(:)
        integer, intent(inout) :: code
        type(error_t), allocatable :: problem
        if (.not. allocated(lines) .or. .not. ranks%is_writer()) return
        call print_text(visible(join(lines, nl)) // nl, problem)
        if (.not. allocated(problem)) return
        call complain(problem%message)
        code = max(code, problem%code)
    end subroutine print_lines

    !> Ends the program if there is an error.
    subroutine end_on(error)
        type(error_t), allocatable, intent(in) :: error
        if (.not. allocated(error)) return
        call complain(error%message)
        call leave(error%code)
    end subroutine end_on

    !> Ends the program with an exit code: that of the writer in all ranks, because a launcher may end all
    !> ranks as soon as one of them has a nonzero code.
    subroutine leave(code)
        integer, intent(in) :: code
        type(error_t), allocatable :: problem
        integer :: last_code
        last_code = code
        ! If an earlier output has failed, that has been reported.
        if (code /= exit_output) call end_output(problem)
        if (allocated(problem)) then
            call complain(problem%message)
            last_code = max(code, problem%code)
        end if
        call end_ranks()
        call end_process(merge(last_code, exit_ok, ranks%is_writer()))
    end subroutine leave

end program spintop_main
