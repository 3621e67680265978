!> The registry of studies, one line each. Checks, lists and messages use it.
module spintop_studies
    use spintop_benchmark_study, only: benchmark_study_t
    use spintop_fit_study, only: fit_study_t
    use spintop_precision_study, only: precision_study_t
    use spintop_stability_study, only: stability_study_t
    use spintop_study, only: study_info_t, study_t
    use spintop_sweep_study, only: sweep_study_t
    use spintop_trajectory_study, only: trajectory_study_t
    implicit none
    private
    public :: study_entry_t, list_studies, create_study

    !> A study in the registry.
    type :: study_entry_t
        class(study_t), allocatable :: study
    end type study_entry_t

contains

    !> All kinds of study, in the order in which they are listed.
    subroutine list_studies(known)
        type(study_entry_t), allocatable, intent(inout) :: known(:) !! not allocated before
        allocate (known(6))
        allocate (trajectory_study_t :: known(1)%study)
        allocate (sweep_study_t :: known(2)%study)
        allocate (stability_study_t :: known(3)%study)
        allocate (precision_study_t :: known(4)%study)
        allocate (benchmark_study_t :: known(5)%study)
        allocate (fit_study_t :: known(6)%study)
    end subroutine list_studies

    !> The study of a name in `study_kinds`; a trajectory for other names.
    subroutine create_study(name, study)
        character(*), intent(in) :: name !! name of the kind (study.kind)
        class(study_t), allocatable, intent(out) :: study !! the study, without a plan
        type(study_entry_t), allocatable :: known(:)
        type(study_info_t) :: info
        integer :: i

        call list_studies(known)
        do i = size(known), 2, -1
            info = known(i)%study%info()
            if (info%name == name) exit
        end do
        allocate (study, source=known(i)%study)
    end subroutine create_study

end module spintop_studies
