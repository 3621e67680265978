!> The interface of all kinds of study, and the options of the command line with which they run. The registry is in
!> `studies.f90`.
module spintop_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_errors, only: error_t
    use spintop_job, only: job_t
    use spintop_problems, only: problems_t
    use spintop_process, only: watch_signals
    use spintop_ranks, only: ranks_t
    use spintop_row_table, only: row_table_t
    use spintop_study_column, only: study_column_t
    use spintop_summary, only: summary_t
    use spintop_table_head, only: shard_t
    use spintop_text, only: string_t, to_text
    implicit none
    private
    public :: study_info_t, study_t, options_t, most_threads, shell_word

    !> Threads that may be asked for.
    integer, parameter :: most_threads = 4096

    !> Options of the command line for all inputs, and the processes of the run.
    type :: options_t
        !> Folder for results.
        character(:), allocatable :: output
        !> Overrides `group.key=value`, in the given order.
        type(string_t), allocatable :: overrides(:)
        !> Number of threads; 0 for all cores.
        integer :: threads = 0
        logical :: quiet = .false., progress = .false.
        !> Whether the summary of a run has all its lines.
        logical :: verbose = .false.
        !> The part of a sweep, and whether an interrupted run is resumed or discarded.
        type(shard_t) :: shard
        logical :: resume = .false., restart = .false.
        !> Whether the inputs are tables, whose headers have them, to be verified; and whether each number must be proved.
        logical :: verifies = .false., strict = .false.
        !> The program and its options in the syntax of a shell, without the inputs and those two options.
        character(:), allocatable :: command
        type(ranks_t) :: ranks
    contains
        procedure :: announce_signals
    end type options_t

    !> Properties of a kind of study, which do not depend on the input.
    type :: study_info_t
        !> Its name in an input: study.kind.
        character(:), allocatable :: name
        !> Singular with an article, and plural, for messages: 'a sweep', 'sweeps'.
        character(:), allocatable :: phrase, plural
        !> Remark in the heading of the list of its columns.
        character(:), allocatable :: remark
        !> What it computes, in a few words.
        character(:), allocatable :: what
        !> Whether it can vary parameters, and whether it must.
        logical :: takes_axes = .false., needs_axes = .false.
        !> Whether output.columns selects its columns, and whether its table can be NetCDF.
        logical :: takes_columns = .false., has_netcdf = .false.
        !> Whether it is a list of cases that can be computed in parts, and can be resumed after an interruption.
        logical :: has_parts = .false., resumes = .false.
        !> Whether the ranks share its cases; otherwise the first computes it alone, so that its times are true.
        logical :: shares_ranks = .false.
        !> Whether it can compute statistics of its rows.
        logical :: has_statistics = .false.
        !> Whether it can write a table of events, and whether events may use the exact solution.
        logical :: has_events = .false., keeps_exact_motion = .true.
        !> Whether it computes the case of the input, and not a catalogue.
        logical :: has_case = .true.
    end type study_info_t

    !> A kind of study, with its plan for one job.
    type, abstract :: study_t
        type(study_info_t) :: info
        !> What a job computes, in a phrase, and how many cases of which a part has some; `check` sets both.
        character(:), allocatable :: phrase
        integer(int64) :: count = 1
        !> All columns of its table, in their order.
        type(study_column_t), allocatable :: columns(:)
    contains
        procedure(check_i), deferred :: check
        procedure(run_i), deferred :: run
        procedure :: complete
        procedure :: forecast
    end type study_t

    abstract interface
        !> Plans a job whose input has been read, with its axes: case, plan, and data of the study with its phrase.
        subroutine check_i(self, job, problems)
            import :: study_t, job_t, problems_t
            implicit none
            class(study_t), intent(inout) :: self
            type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
            type(problems_t), intent(inout) :: problems !! problems of the scene
        end subroutine check_i

        !> Runs a checked job, and writes its tables.
        subroutine run_i(self, job, options, summary, code, error)
            import :: study_t, job_t, options_t, summary_t, error_t
            implicit none
            class(study_t), intent(inout) :: self
            type(job_t), target, intent(inout) :: job !! the job
            type(options_t), intent(in) :: options !! options of the command line
            type(summary_t), intent(out) :: summary !! lines for standard output
            integer, intent(out) :: code !! exit code: whether all cases succeeded
            type(error_t), allocatable, intent(out) :: error !! if the tables could not be written
        end subroutine run_i
    end interface

contains

    !> Completes a job whose columns are chosen; nothing is left to do unless the kind overrides this.
    subroutine complete(self, job, problems)
        class(study_t), intent(in) :: self
        type(job_t), intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
    end subroutine complete

    !> Adds lines on what the computation will need to the output of --check; none unless the kind overrides this.
    subroutine forecast(self, job, options, summary)
        class(study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job; unchanged at the end
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(inout) :: summary !! lines are added
    end subroutine forecast

    !> Sets the message of a signal that ends a run: the number of kept rows, and the command that resumes it.
    subroutine announce_signals(self, input, path, table, rows)
        class(options_t), intent(in) :: self
        character(*), intent(in) :: input, path !! the input, and the path of its table
        class(row_table_t), intent(in) :: table !! the table
        integer(int64), intent(in) :: rows !! number of rows of the whole table
        character, parameter :: nl = new_line('a')
        character(:), allocatable :: command

        if (.not. table%is_resumable) then
            call watch_signals('', 'spintop: interrupted: nothing is kept of ' // path // nl, -1_int64)
            return
        end if
        command = 'the same command with --resume'
        if (self%ranks%count == 1 .and. allocated(self%command)) then
            command = self%command // ' --resume '
            if (index(input, '-') == 1) command = command // '-- '
            command = command // shell_word(input)
        end if
        call watch_signals('spintop: interrupted: ', ' of ' // to_text(rows) // ' rows of ' // path // &
                           ' are kept' // nl // 'to resume: ' // command // nl, table%rows())
    end subroutine announce_signals

    !> A text as a word of the shell.
    pure function shell_word(text) result(word)
        character(*), intent(in) :: text !! any text, such as a path
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

end module spintop_study
