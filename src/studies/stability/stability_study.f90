!> The stability study as a kind of study.
module spintop_stability_study
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t, exit_ok
    use spintop_job, only: job_t
    use spintop_options, only: options_t
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_scene_words, only: kind_stability, study_kinds
    use spintop_stability, only: run_stability
    use spintop_stability_columns, only: stability_columns
    use spintop_stability_plan, only: make_stability_plan, stability_plan_t
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_summary, only: summary_t
    use spintop_text, only: to_text
    implicit none
    private
    public :: stability_study_t

    !> Methods on motions that are difficult to integrate.
    type, extends(study_t) :: stability_study_t
        private
        type(stability_plan_t) :: plan
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: cases
        procedure :: check
        procedure :: explain
        procedure :: run
    end type stability_study_t

contains

    !> Properties of stability studies.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_stability)), 'a stability study', 'stability studies', '', &
                            'methods on a catalogue of hard motions, with a verdict on each', has_parts=.true., &
                            shares_ranks=.true., has_case=.false.)
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        allocate (columns, source=stability_columns())
    end function columns

    !> Number of cases.
    integer(int64) function cases(self, job)
        class(stability_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        associate (unused => job)
        end associate
        cases = size(self%plan%cases)
    end function cases

    !> Finds the cases and the methods; checks the case of the input if it is one of them.
    subroutine check(self, job, problems, diagnostics)
        class(stability_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scene_t), allocatable :: scene

        associate (unused => diagnostics)
        end associate
        call make_stability_plan(job%scene, self%plan, problems)
        if (problems%any() .or. all(self%plan%cases > 0)) return
        call job%make_first_case(scene, problems, planned=.false.)
    end subroutine check

    !> Number of methods and cases.
    function explain(self, job) result(phrase)
        class(stability_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        associate (unused => job)
        end associate
        phrase = 'the stability of ' // to_text(size(self%plan%methods)) // ' methods on ' &
                 // to_text(size(self%plan%cases)) // ' cases'
    end function explain

    !> Runs all methods on all cases. A failure of a method is a result, not a failure of the study.
    subroutine run(self, job, options, summary, code, error)
        class(stability_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        code = exit_ok
        call run_stability(job, self%plan, options, summary, error)
    end subroutine run

end module spintop_stability_study
