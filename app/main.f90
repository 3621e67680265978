!> The batch program: reads inputs, has their studies carried out, and ends with an exit code. Of
!> several ranks only the writer talks to the user, and it alone does what is no study.
program spintop_main
    use, intrinsic :: iso_fortran_env, only: int64, output_unit, error_unit
    use spintop_command_line, only: request_t, read_command_line, describe_usage, action_run, action_check, &
        action_list, action_help, action_merge, action_version
    use spintop_diagnostics, only: visible
    use spintop_errors, only: error_t, exit_ok
    use spintop_job, only: job_t
    use spintop_listing, only: list_topic
    use spintop_merge, only: merge_tables
    use spintop_provenance, only: program_version, program_revision
    use spintop_ranks, only: ranks_t, start_ranks, end_ranks
    use spintop_studies, only: prepare_jobs, run_job, explain_job
    use spintop_text, only: string_t, to_text
    implicit none
    type(ranks_t) :: ranks
    type(request_t) :: request
    type(job_t), allocatable, target :: jobs(:)
    type(string_t), allocatable :: lines(:)
    type(error_t), allocatable :: error
    integer(int64) :: cases
    integer :: code, worst, i

    call start_ranks(ranks, error)
    call end_on(error)
    call read_command_line(request, error)
    call end_on(error)
    if (request%action /= action_run .and. .not. ranks%is_writer()) call leave(exit_ok)
    select case (request%action)
    case (action_help)
        call describe_usage(lines)
        call show(lines)
        call leave(exit_ok)
    case (action_version)
        write (output_unit, '(a)') 'spintop ' // program_version // ' (revision ' // program_revision() // ')'
        call leave(exit_ok)
    case (action_list)
        call list_topic(request%topic, lines, error)
        call end_on(error)
        call show(lines)
        call leave(exit_ok)
    case (action_merge)
        call merge_tables(request%merged, request%inputs, cases, error)
        call end_on(error)
        write (output_unit, '(a)') to_text(size(request%inputs)) // ' parts, ' // to_text(cases) // ' cases -> ' &
            // visible(request%merged)
        call leave(exit_ok)
    end select

    if (request%action == action_run) request%options%ranks = ranks
    call prepare_jobs(request%inputs, request%options, jobs, error)
    call end_on(error)
    worst = exit_ok
    do i = 1, size(jobs)
        call complain(jobs(i)%warnings)
        if (request%action == action_check) then
            call explain_job(jobs(i), request%options, lines)
            code = exit_ok
        else
            call run_job(jobs(i), request%options, lines, code, error)
            if (allocated(error)) then
                call complain(error%message)
                code = error%code
            end if
        end if
        call show(lines)
        worst = max(worst, code)
    end do
    call leave(worst)

contains

    !> Writes a text to standard error, if there is one. It may quote bytes of a damaged file.
    subroutine complain(text)
        character(*), intent(in) :: text
        if (text /= '' .and. ranks%is_writer()) write (error_unit, '(a)') visible(text)
    end subroutine complain

    !> Writes lines to standard output.
    subroutine show(lines)
        type(string_t), allocatable, intent(in) :: lines(:)
        integer :: line
        if (.not. allocated(lines) .or. .not. ranks%is_writer()) return
        do line = 1, size(lines)
            write (output_unit, '(a)') visible(lines(line)%text)
        end do
    end subroutine show

    !> Ends the program if there is an error.
    subroutine end_on(error)
        type(error_t), allocatable, intent(in) :: error
        if (.not. allocated(error)) return
        call complain(error%message)
        call leave(error%code)
    end subroutine end_on

    !> Ends the program with an exit code, without the notes that STOP may print. The code is that of
    !> the writer: a launcher may end all ranks as soon as one has another than 0.
    subroutine leave(code)
        integer, intent(in) :: code
        interface
            subroutine c_exit(code) bind(c, name='exit')
                use, intrinsic :: iso_c_binding, only: c_int
                integer(c_int), value :: code
            end subroutine c_exit
        end interface
        flush (output_unit)
        flush (error_unit)
        call end_ranks()
        call c_exit(merge(code, exit_ok, ranks%is_writer()))
    end subroutine leave

end program spintop_main
