!> The registry of studies: what each kind is and can do, and its columns. Checks, lists and messages use it.
module spintop_studies
    use spintop_benchmark_study, only: benchmark_columns, benchmark_study_t
    use spintop_fit_study, only: fit_study_t, fit_columns
    use spintop_precision_study, only: precision_columns, precision_study_t
    use spintop_scene_keys, only: study_kinds, kind_trajectory, kind_sweep, kind_precision, kind_stability, &
        kind_benchmark, kind_fit
    use spintop_stability_study, only: stability_columns, stability_study_t
    use spintop_study, only: study_info_t, study_t
    use spintop_sweep_result, only: sweep_columns
    use spintop_sweep_study, only: sweep_study_t
    use spintop_trajectory_columns, only: trajectory_columns
    use spintop_trajectory_study, only: trajectory_study_t
    implicit none
    private
    public :: listed_studies, create_study

    !> The names of all kinds of study, in the order in which they are listed.
    character(*), parameter :: listed_studies(*) = study_kinds( &
        [kind_trajectory, kind_sweep, kind_stability, kind_precision, kind_benchmark, kind_fit])

contains

    !> The study of a name; a trajectory for other names.
    subroutine create_study(name, study)
        character(*), intent(in) :: name !! name of the kind (study.kind)
        class(study_t), allocatable, intent(out) :: study !! the study, without a plan
        select case (name)
        case (study_kinds(kind_sweep))
            allocate (sweep_study_t :: study)
            study%info = study_info_t(name, 'a sweep', 'sweeps', &
                ', besides case, the swept parameters, status and notes', &
                'many motions: a row of quantities per combination of parameters', takes_axes=.true., &
                needs_axes=.true., takes_columns=.true., has_parts=.true., shares_ranks=.true., resumes=.true., &
                has_statistics=.true., has_netcdf=.true., keeps_exact_motion=.false.)
            study%columns = sweep_columns
        case (study_kinds(kind_stability))
            allocate (stability_study_t :: study)
            study%info = study_info_t(name, 'a stability study', 'stability studies', '', &
                'methods on a catalogue of hard motions, with a verdict on each', has_parts=.true., &
                shares_ranks=.true., has_case=.false.)
            study%columns = stability_columns
        case (study_kinds(kind_precision))
            allocate (precision_study_t :: study)
            study%info = study_info_t(name, 'a work-precision study', 'work-precision studies', &
                ', before the swept parameters', &
                'error of each method and setting, against time and RHS evaluations', takes_axes=.true., &
                has_parts=.true.)
            study%columns = precision_columns
        case (study_kinds(kind_benchmark))
            allocate (benchmark_study_t :: study)
            study%info = study_info_t(name, 'a study of benchmarks', 'studies of benchmarks', '', &
                'published benchmark tops: true values, and the errors of the published figures', &
                has_parts=.true., has_case=.false.)
            study%columns = benchmark_columns
        case (study_kinds(kind_fit))
            allocate (fit_study_t :: study)
            study%info = study_info_t(name, 'a fit', 'fits', ', besides a covariance__KEY per sought parameter', &
                'numbers of the input from measurements of the motion')
            study%columns = fit_columns
        case default
            allocate (trajectory_study_t :: study)
            study%info = study_info_t(trim(study_kinds(kind_trajectory)), 'a trajectory', 'trajectories', '', &
                'one motion: a row per sample in time', takes_columns=.true., has_netcdf=.true., has_events=.true., &
                resumes=.true.)
            study%columns = trajectory_columns
        end select
    end subroutine create_study

end module spintop_studies
