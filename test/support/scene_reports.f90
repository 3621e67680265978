!> Scenes for suites, and what the checks say of them.
module scene_reports
    use spintop_case, only: case_t, make_case
    use spintop_diagnostics, only: diagnostics_t
    use spintop_kinds, only: dp
    use spintop_parameters, only: parameter_table_t
    use spintop_plan, only: plan_t
    use spintop_planning, only: make_plan
    use spintop_problems, only: problems_t
    use spintop_scene_keys, only: scene_t, describe_scene
    use known_tops, only: upright_theta
    implicit none
    private
    public :: slow_scene, report_on

contains

    !> Example 1 over one nutation.
    pure type(scene_t) function slow_scene() result(scene)
        scene%mass = 1
        scene%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
        scene%length = sqrt(0.75_dp)
        scene%angle(2) = upright_theta
        scene%rate(3) = 1
        scene%nutations = 1
    end function slow_scene

    !> Makes the case and the plan of a scene; returns the errors and warnings, with what would be
    !> right, or nothing.
    subroutine report_on(scene, report, case, plan)
        type(scene_t), intent(in) :: scene
        character(:), allocatable, intent(out) :: report
        type(case_t), intent(out), optional :: case
        type(plan_t), intent(out), optional :: plan
        type(scene_t), allocatable, target :: own
        type(parameter_table_t) :: table
        type(problems_t) :: problems
        type(diagnostics_t) :: diagnostics
        type(case_t) :: own_case
        type(plan_t) :: own_plan

        allocate (own, source=scene)
        call describe_scene(own, table)
        call make_case(own, own_case, problems)
        if (.not. problems%any()) call make_plan(own, own_case, own_plan, problems)
        call problems%report_to(table, diagnostics)
        report = ''
        if (diagnostics%has_errors() .or. diagnostics%has_warnings()) report = diagnostics%report()
        if (present(case)) case = own_case
        if (present(plan)) plan = own_plan
    end subroutine report_on

end module scene_reports
