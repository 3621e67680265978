!> The method of least cost for a tolerance, from work-precision studies.
!>
!> The exact solution comes first: where it exists, another method is used only on request. (For a span of one
!> or two steps a numerical method costs a microsecond less.) The rows below were determined with the hard
!> cases (`spintop list cases`). They are checked with other bodies and tops by `input/recommendation.nml` and
!> `input/recommendation_lagrange.nml`, whose summaries give the ratio to the cheapest method:
!>
!> * Taylor's method is the cheapest at any tolerance where the equations have a power series; at worst, for
!>   errors of 1e-2 rad of some bodies without symmetry, splitting costs one fifth less.
!> * Below 1e-15 double precision is not sufficient.
!> * Without a series dop853 is the cheapest: ode45 costs 1.4 times as much for errors of 0.1 rad (the median of 36 tops, from
!>   0.7 to 1.6 times), twice as much for 1e-5 rad, and two to ten times as much for 1e-8 rad.
!> * With a fixed step size splitting_6 costs half as much as dop853 for the slow top of Example 1 (`spintop
!>   --set work_precision.methods=dop853,splitting_6 --set work_precision.steps=40,80,160,320
!>   input/work_precision_slow_top.nml`), and more for the one body without symmetry that was tested.
module spintop_automatic_method
    use spintop_formulation, only: formulation_info_t, structure_split, formulation_t
    use spintop_kinds, only: dp
    use spintop_methods, only: create_stepper
    use spintop_stepper, only: stepper_t, controls_t
    use spintop_suitability, only: has_structure
    use spintop_body, only: body_t
    use spintop_formulations, only: create_formulation
    use spintop_parameters, only: is_set, unset_integer
    use spintop_plan, only: plan_t
    use spintop_scene_keys, only: scene_t
    implicit none
    private
    public :: choose_automatically, recommend_adaptive, recommend_steps
    public :: known_for, free_body, solvable_effects, solved_for, of_symmetric_tops, of_any_body

    !> Description of the bodies for which `body_t%is_lagrange` is true, and of those that have a closed form.
    character(*), parameter :: known_for = 'an undamped symmetric top with its centre of mass on &
        &body z, at or above the pivot', free_body = 'an undamped body without gravitational torque', &
        solvable_effects = 'a rotor with constant momentum on the axis of an undamped symmetric top, and the rotation of &
        &the Earth at a pole', &
        solved_for = known_for // ', and ' // free_body
    !> The default formulations.
    character(*), parameter :: of_symmetric_tops = 'space_frame', of_any_body = 'rigid_body '

    !> A method, the smallest tolerance for which it is recommended, and the reason.
    type :: recommendation_t
        character(20) :: method
        real(dp) :: least
        character(96) :: why
    end type recommendation_t

    !> The first one is used that the equations support and whose smallest tolerance is not above the
    !> requested one.
    type(recommendation_t), parameter :: recommendations(*) = [ &
        recommendation_t('taylor', 1.0e-15_dp, 'the cheapest at any tolerance where the equations have a power series'), &
        recommendation_t('taylor_quadruple', 0.0_dp, 'double precision cannot reach a tolerance below 1e-15'), &
        recommendation_t('dop853', 0.0_dp, 'the cheapest at any tolerance where the equations have no power series')]

    !> For a fixed step size: symmetric tops whose equations can be split, and others.
    type(recommendation_t), parameter :: for_split_tops = recommendation_t( &
        'splitting_6', 0.0_dp, 'the cheapest with a fixed step size for tops that can be split, without energy drift'), &
        for_steps = recommendation_t( &
        'dop853', 0.0_dp, 'the cheapest with a fixed step size, of high order')

contains

    !> Chooses the closed form where the body has one and the input does not ask for steps, else the cheapest method.
    subroutine choose_automatically(scene, body, plan)
        type(scene_t), intent(in) :: scene !! contents of the input
        type(body_t), intent(in) :: body !! the body of the case
        type(plan_t), intent(inout) :: plan !! receives the method and the reason for it
        character(*), parameter :: default_with_table = 'arkode_erk'
        plan%exact = body%has_closed_form() .and. .not. any([scene%formulation /= 'auto', &
            scene%table /= '', scene%steps /= unset_integer, is_set(scene%step)])
        if (plan%exact) then
            plan%reason = 'The body is ' // known_for
            if (.not. body%is_lagrange()) plan%reason = 'The body is ' // free_body
            plan%reason = plan%reason // ', so the motion is computed in closed form: &
                &accurate to rounding at any time, at a cost that does not depend on the time span, without steps.'
        else
            plan%reason = why_integrated(body)
            if (scene%table == '') then
                call choose_default(scene, body, plan)
            else
                call create_stepper(default_with_table, plan%stepper)
                plan%reason = plan%reason // ' ' // default_with_table // ' uses the named table.'
            end if
        end if
    end subroutine choose_automatically

    !> Why a motion is integrated numerically, without a method that the input names.
    function why_integrated(body) result(reason)
        type(body_t), intent(in) :: body
        character(:), allocatable :: reason
        if (body%has_closed_form()) then
            reason = 'The input names a formulation, a table or steps, so the motion is integrated numerically, although a &
                &closed form exists.'
        else if (allocated(body%effects)) then
            reason = 'The body has effects (&effects), so there is no closed form and the motion is integrated numerically; &
                &a closed form exists only with ' // solvable_effects // '. Splitting methods, projection onto invariants &
                &and quantities of the undisturbed top are excluded.'
        else
            reason = 'The body is neither ' // known_for // ' nor ' // free_body // ', so there is no closed form and the &
                &motion is integrated numerically.'
        end if
    end function why_integrated

    !> The cheapest adaptive stepper or, on request, the cheapest one with a fixed step size.
    subroutine choose_default(scene, body, plan)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        type(plan_t), intent(inout) :: plan
        type(controls_t), parameter :: defaults = controls_t()
        class(formulation_t), allocatable :: formulation
        character(:), allocatable :: why
        real(dp) :: tolerance

        tolerance = defaults%relative_tolerance
        ! Zero is the finest tolerance of the method, whichever it is.
        if (is_set(scene%relative_tolerance) .and. scene%relative_tolerance > 0) tolerance = scene%relative_tolerance
        call create_formulation(trim(likely_formulation(scene, body)), formulation, body=body)
        if (scene%steps /= unset_integer .or. is_set(scene%step)) then
            call recommend_steps(formulation%info(), plan%stepper, why)
        else
            call recommend_adaptive(tolerance, formulation%info(), plan%stepper, why)
        end if
        plan%reason = plan%reason // ' ' // trim(plan%stepper%info%name) // ' is the default: ' // why // '.'
    end subroutine choose_default

    !> The named formulation, or the default one for methods that it supports.
    pure function likely_formulation(scene, body) result(name)
        type(scene_t), intent(in) :: scene
        type(body_t), intent(in) :: body
        character(len(scene%formulation)) :: name
        name = scene%formulation
        if (name == 'auto') name = merge(of_symmetric_tops, of_any_body, body%is_lagrange())
    end function likely_formulation

    !> The stepper for a tolerance with these equations.
    subroutine recommend_adaptive(tolerance, info, stepper, why)
        real(dp), intent(in) :: tolerance !! relative tolerance
        type(formulation_info_t), intent(in) :: info !! properties of the formulation
        class(stepper_t), allocatable, intent(out) :: stepper !! the recommended method
        character(:), allocatable, intent(out) :: why !! reason for the recommendation
        integer :: i

        do i = 1, size(recommendations)
            if (tolerance < recommendations(i)%least) cycle
            call create_stepper(recommendations(i)%method, stepper)
            why = trim(recommendations(i)%why)
            if (has_structure(info, stepper%info)) return
        end do
    end subroutine recommend_adaptive

    !> The stepper for a fixed step size with these equations.
    subroutine recommend_steps(info, stepper, why)
        type(formulation_info_t), intent(in) :: info !! properties of the formulation
        class(stepper_t), allocatable, intent(out) :: stepper !! the recommended method
        character(:), allocatable, intent(out) :: why !! reason for the recommendation
        type(recommendation_t) :: recommendation
        recommendation = for_steps
        if (info%symmetric_only .and. info%offers(structure_split)) recommendation = for_split_tops
        call create_stepper(recommendation%method, stepper)
        why = trim(recommendation%why)
    end subroutine recommend_steps

end module spintop_automatic_method
