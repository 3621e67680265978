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
    use spintop_formulation, only: formulation_info_t, structure_split
    use spintop_kinds, only: dp
    use spintop_methods, only: create_stepper
    use spintop_stepper, only: stepper_t
    use spintop_suitability, only: has_structure
    implicit none
    private
    public :: recommend_adaptive, recommend_steps

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
