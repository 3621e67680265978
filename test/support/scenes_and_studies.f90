!> The words of scenes and studies that several suites use, of their mechanics, texts and tables, and the jobs that suites
!> have for them.
module scenes_and_studies
    use mechanics
    use texts_and_tables
    use spintop_axes_of_scene
    use spintop_case
    use spintop_comparison
    use spintop_event_recorder
    use spintop_stability_study, only: hard_case_t, hard_cases, settings_of
    use spintop_job
    use spintop_study
    use spintop_planning, only: plan_t, sample_time, sample_times
    use spintop_preparation
    use spintop_trial, only: check_reference, find_reference, read_motion, reference_t
    use spintop_scene_keys
    use spintop_study_column
    use spintop_summary
    use spintop_sweep_axes
    use spintop_sweep_worker
    use spintop_trajectory_columns
    use spintop_trajectory_study
    use prepared_jobs
    use scene_reports
    implicit none
    public
end module scenes_and_studies
