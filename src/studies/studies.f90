!> The registry of studies. Checks, lists and messages use it.
module spintop_studies
    use spintop_benchmark_study, only: benchmark_study_t
    use spintop_fit_study, only: fit_study_t
    use spintop_precision_study, only: precision_study_t
    use spintop_scene_words, only: study_kinds, kind_trajectory, kind_sweep, kind_precision, kind_stability, kind_benchmark, &
        kind_fit
    use spintop_stability_study, only: stability_study_t
    use spintop_study, only: study_t
    use spintop_sweep_study, only: sweep_study_t
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
        case (study_kinds(kind_stability))
            allocate (stability_study_t :: study)
        case (study_kinds(kind_precision))
            allocate (precision_study_t :: study)
        case (study_kinds(kind_benchmark))
            allocate (benchmark_study_t :: study)
        case (study_kinds(kind_fit))
            allocate (fit_study_t :: study)
        case default
            allocate (trajectory_study_t :: study)
        end select
    end subroutine create_study

end module spintop_studies
