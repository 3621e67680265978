!> The trajectory as a kind of study.
module spintop_trajectory_study
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_job, only: job_t
    use spintop_options, only: options_t
    use spintop_problems, only: problems_t
    use spintop_scene, only: scene_t
    use spintop_scene_words, only: kind_trajectory, study_kinds
    use spintop_status, only: code_of
    use spintop_study, only: study_info_t, study_t
    use spintop_study_column, only: listed_column_t
    use spintop_summary, only: summary_t
    use spintop_text, only: to_text
    use spintop_trajectory, only: run_trajectory
    use spintop_trajectory_column, only: trajectory_column_t
    use spintop_trajectory_columns, only: trajectory_columns
    implicit none
    private
    public :: trajectory_study_t

    !> One motion, one table.
    type, extends(study_t) :: trajectory_study_t
    contains
        procedure, nopass :: info
        procedure, nopass :: columns
        procedure :: check
        procedure :: explain
        procedure :: run
    end type trajectory_study_t

contains

    !> Properties of trajectories.
    function info()
        type(study_info_t) :: info
        info = study_info_t(trim(study_kinds(kind_trajectory)), 'a trajectory', 'trajectories', '', &
                            'one motion: a row per sample in time', takes_columns=.true., has_netcdf=.true., has_events=.true., &
                            resumes=.true.)
    end function info

    !> All columns.
    function columns()
        type(listed_column_t), allocatable :: columns(:)
        allocate (columns(size(trajectory_columns)))
        columns%study_column_t = trajectory_columns%study_column_t
        columns%words = trajectory_columns%is_proof
        columns%is_default = trajectory_columns%is_default
        columns%needs_exact_motion = trajectory_columns%needs_exact_motion
        columns%needs_effects = trajectory_columns%needs_effects
    end function columns

    !> Plans the motion.
    subroutine check(self, job, problems, diagnostics)
        class(trajectory_study_t), intent(inout) :: self
        type(job_t), target, intent(inout) :: job !! the job; completed by this procedure
        type(problems_t), intent(inout) :: problems !! problems of the scene are added
        type(diagnostics_t), intent(inout) :: diagnostics !! errors with their places are added
        type(scene_t), allocatable :: scene

        associate (unused => self, also_unused => diagnostics)
        end associate
        call job%make_first_case(scene, problems, planned=.true.)
    end subroutine check

    !> Number of rows, and time span.
    function explain(self, job) result(phrase)
        class(trajectory_study_t), intent(in) :: self
        type(job_t), intent(in) :: job !! the job
        character(:), allocatable :: phrase
        associate (unused => self)
        end associate
        phrase = 'a trajectory of ' // to_text(job%plan%samples) // ' rows over ' // to_text(job%case%t_end) // ' s'
    end function explain

    !> Computes the motion; the study fails if it ends early.
    subroutine run(self, job, options, summary, code, error)
        class(trajectory_study_t), intent(in) :: self
        type(job_t), target, intent(inout) :: job !! the job
        type(options_t), intent(in) :: options !! options of the command line
        type(summary_t), intent(out) :: summary !! lines for standard output
        integer, intent(out) :: code !! exit code
        type(error_t), allocatable, intent(out) :: error !! not allocated on success
        integer :: status

        associate (unused => self)
        end associate
        call run_trajectory(job, options, summary, status, error)
        code = code_of(status)
    end subroutine run

end module spintop_trajectory_study
