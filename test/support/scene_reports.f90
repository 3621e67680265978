!> Scenes for suites, and what the checks say of them.
module scene_reports
    use spintop_benchmark_study, only: benchmarks
    use spintop_body, only: body_t
    use spintop_case, only: case_t, make_case
    use spintop_comparison, only: make_scene_of_settings
    use spintop_diagnostics, only: diagnostics_t
    use spintop_errors, only: error_t
    use spintop_kinds, only: dp
    use spintop_motion, only: motion_t
    use spintop_parameters, only: parameter_table_t
    use spintop_planning, only: make_plan, plan_t
    use spintop_problems, only: problems_t
    use spintop_stability_study, only: hard_cases, settings_of
    use spintop_scene_keys, only: scene_t, describe_scene
    use known_tops, only: upright_theta
    implicit none
    private
    public :: slow_scene, scene_of, report_on, report_of, plain_case, catalogue_case

    !> Example 1 in parts, as settings of an input: its body, its start, and one nutation.
    character(*), parameter, public :: slow_body = 'top.mass=1;top.inertia=0.875,0.875,0.25;top.length=0.8660254037844386;', &
        slow_settings = slow_body // 'initial.theta=0.19634954084936207;initial.psi_rate=1;span.nutations=1;'

contains

    !> A body in its own axes as a case.
    type(case_t) function plain_case(body, start, t_end) result(case)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(in), optional :: t_end
        case%body = body
        case%start = start
        case%given_body = body
        case%given_start = start
        if (present(t_end)) case%t_end = t_end
    end function plain_case

    !> Example 1 over one nutation.
    pure type(scene_t) function slow_scene() result(scene)
        scene%mass = 1
        scene%inertia = [0.875_dp, 0.875_dp, 0.25_dp]
        scene%length = sqrt(0.75_dp)
        scene%angle(2) = upright_theta
        scene%rate(3) = 1
        scene%nutations = 1
    end function slow_scene

    !> The scene of settings as in an input: `group.key=value`, separated by semicolons.
    type(scene_t) function scene_of(settings) result(scene)
        character(*), intent(in) :: settings
        type(error_t), allocatable :: error
        call read_settings(settings, scene, error)
        if (.not. allocated(error)) return
        print '(a)', settings // ': ' // error%message
        error stop 'scene_reports: these are no settings'
    end function scene_of

    !> A case of the catalogue of benchmarks or of hard cases; `message` is what is wrong with it, or ''.
    subroutine catalogue_case(name, case, message, steps)
        character(*), intent(in) :: name
        type(case_t), intent(out) :: case
        character(:), allocatable, intent(out) :: message
        integer, intent(out), optional :: steps
        type(scene_t), allocatable :: scene
        type(problems_t) :: problems
        type(error_t), allocatable :: error
        integer :: i
        allocate (scene)
        i = findloc(benchmarks%name == name, .true., dim=1)
        if (i > 0) then
            call make_scene_of_settings(benchmarks(i)%settings, scene, error)
        else
            i = findloc(hard_cases%name == name, .true., dim=1)
            call make_scene_of_settings(settings_of(hard_cases(i)), scene, error)
        end if
        if (allocated(error)) then
            message = error%message
            return
        end if
        call make_case(scene, case, problems)
        message = problems%first()
        if (present(steps)) steps = scene%steps
    end subroutine catalogue_case

    !> What the checks say of settings.
    function report_of(settings) result(report)
        character(*), intent(in) :: settings
        character(:), allocatable :: report
        type(scene_t) :: scene
        type(error_t), allocatable :: error
        call read_settings(settings, scene, error)
        if (allocated(error)) then
            report = error%message
        else
            call report_on(scene, report)
        end if
    end function report_of

    !> Reads settings; a semicolon may end them.
    subroutine read_settings(settings, scene, error)
        character(*), intent(in) :: settings
        type(scene_t), intent(out) :: scene
        type(error_t), allocatable, intent(out) :: error
        type(scene_t), allocatable, target :: own
        integer :: last
        last = len_trim(settings)
        if (last > 0) last = last - merge(1, 0, settings(last:last) == ';')
        allocate (own)
        call make_scene_of_settings(settings(:last), own, error)
        scene = own
    end subroutine read_settings

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
