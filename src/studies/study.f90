!> The interface of all kinds of study. The registry is in `studies.f90`.
module spintop_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_job, only: job_t
    use spintop_options, only: options_t
    use spintop_problems, only: problems_t
    use spintop_study_column, only: study_column_t
    use spintop_summary, only: summary_t
    implicit none
    private
    public :: study_info_t, study_t

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
        !> Whether it can vary parameters.
        logical :: takes_axes = .false.
        !> Whether output.columns selects its columns.
        logical :: takes_columns = .false.
        !> Whether it is a list of cases that can be computed in parts.
        logical :: has_parts = .false.
        !> Whether the ranks share its cases; otherwise the first computes it alone, so that its times are true.
        logical :: shares_ranks = .false.
        !> Whether it can be resumed after an interruption.
        logical :: resumes = .false.
        !> Whether it can compute statistics of its rows.
        logical :: has_statistics = .false.
        !> Whether its table can be NetCDF.
        logical :: has_netcdf = .false.
        !> Whether it can write a table of events.
        logical :: has_events = .false.
        !> Whether its events may use the exact solution.
        logical :: keeps_exact_motion = .true.
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
        !> Plans a job whose input has been read: axes, case, plan, and data of the study with its phrase.
        subroutine check_i(self, job, problems, diagnostics)
            import :: study_t, job_t, problems_t, diagnostics_t
            implicit none
            class(study_t), intent(inout) :: self
            type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
            type(problems_t), intent(inout) :: problems !! problems of the scene
            type(diagnostics_t), intent(inout) :: diagnostics !! errors in files that the scene names
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

end module spintop_study
