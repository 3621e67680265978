!> The work-precision study as a kind of study.
module spintop_precision_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, exit_failed, exit_ok
    use spintop_job, only: job_t
    use spintop_options, only: options_t
    use spintop_precision_columns, only: precision_columns
    use spintop_precision_plan, only: make_precision_plan, precision_plan_t, read_reference
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_scene_words, only: kind_precision, study_kinds
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_summary, only: summary_t
    use spintop_text, only: to_text
    use spintop_work_precision, only: problems_of, run_work_precision
    implicit none
    private
    public :: precision_study_t

    !> Methods and settings on one problem, or on each problem of the axes.
    type, extends(study_t) :: precision_study_t
        private
        type(precision_plan_t) :: plan
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: cases
        procedure :: check
        procedure :: explain
        procedure :: run
    end type precision_study_t

contains

    !> Properties of work-precision studies.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_precision)), 'a work-precision study', 'work-precision studies', &
                            ', before the swept parameters', &
                            'error of each method and setting, against time and RHS evaluations', takes_axes=.true., &
                            has_parts=.true.)
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        allocate (columns, source=precision_columns())
    end function columns

    !> Number of problems.
    integer(int64) function cases(self, job)
        class(precision_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        associate (unused => self)
        end associate
        cases = problems_of(job)
    end function cases

    !> Makes the first problem, the methods and their settings.
    subroutine check(self, job, problems, diagnostics)
        class(precision_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scene_t), allocatable :: first

        if (job%names_axes()) then
            call job%make_axes(problems, diagnostics)
            if (job%axes%cases == 0) return
        end if
        call job%make_first_case(first, problems, planned=.false.)
        if (.not. allocated(first)) return
        call make_precision_plan(first, self%plan, problems)
        if (problems%any()) return
        call read_reference(job%input, job%scene, job%case, self%plan, problems, diagnostics)
        if (.not. job%names_axes()) return
        if (allocated(self%plan%stored)) then
            call problems%add('work_precision.reference', 'a stored motion cannot be the reference of several cases', &
                              "use reference = 'auto'")
        end if
        call job%warn_of_bodies(problems)
    end subroutine check

    !> Number of trials of a problem.
    function explain(self, job) result(phrase)
        class(precision_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        associate (unused => job)
        end associate
        phrase = 'errors and costs of ' // to_text(sum(self%plan%settings(self%plan%choices))) &
                 // ' methods and settings'
    end function explain

    !> Runs all trials; the study fails if a problem has no rows.
    subroutine run(self, job, options, summary, code, error)
        class(precision_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: failures

        call run_work_precision(job, self%plan, options, summary, failures, error)
        code = merge(exit_failed, exit_ok, failures > 0)
    end subroutine run

end module spintop_precision_study
