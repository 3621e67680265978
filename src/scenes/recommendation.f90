!> The stepper that costs least for a tolerance, as work-precision studies measured it.
!>
!> The closed form comes first: where there is one nothing else is chosen unless it is asked for. (A span
!> that one or two steps cover costs a microsecond less by steps.) The rows below were found with the hard
!> cases (`spintop list cases`) and are checked on other bodies and tops by `input/recommendation.nml` and
!> `input/recommendation_lagrange.nml`, whose summaries tell how far from the cheapest they are:
!>
!> * Taylor's method is the cheapest at any tolerance where the equations have a power series; at worst,
!>   for 1e-2 rad of some bodies without symmetry, splitting costs a fifth less.
!> * Below 1e-15 double precision gains nothing any more.
!> * Without a series ode45 costs a half to the same as dop853 down to errors of 1e-4 rad, which it
!>   reaches at tolerances of about 1e-5, and two to ten times as much at 1e-8 rad.
!> * In equal steps splitting_6 costs half as much as dop853 on the slow top of Example 1
!>   (`spintop --set work_precision.methods=dop853,splitting_6 --set work_precision.steps=40,80,160,320
!>   input/work_precision_slow_top.nml`), and more on the one body without symmetry that was tried.
module spintop_recommendation
    use spintop_formulation, only: formulation_info_t, structure_split
    use spintop_kinds, only: dp
    use spintop_methods, only: create_stepper
    use spintop_stepper, only: stepper_t
    use spintop_suitability, only: has_structure
    implicit none
    private
    public :: recommend_adaptive, recommend_steps

    !> A method, the tolerance from which on it is recommended, and why.
    type :: recommendation_t
        character(20) :: method
        real(dp) :: least
        character(96) :: why
    end type recommendation_t

    !> The first that the equations can carry, and whose least tolerance is not above the one wanted.
    type(recommendation_t), parameter :: recommendations(*) = [ &
        recommendation_t('taylor', 1.0e-15_dp, 'the cheapest at any tolerance where the equations have a power series'), &
        recommendation_t('taylor_quadruple', 0.0_dp, 'double precision cannot keep a tolerance below 1e-15'), &
        recommendation_t('ode45', 1.0e-5_dp, 'the cheapest at tolerances from 1e-5 on without a power series'), &
        recommendation_t('dop853', 0.0_dp, 'of high order, so cheap where the motion is smooth and the tolerance tight')]

    !> For equal steps: of symmetric tops whose equations can be split, and of others.
    type(recommendation_t), parameter :: for_split_tops = recommendation_t( &
        'splitting_6', 0.0_dp, 'the cheapest in equal steps where symmetric tops are split, and without drift'), &
        for_steps = recommendation_t( &
        'dop853', 0.0_dp, 'the cheapest in equal steps, of high order')

contains

    !> The stepper for a tolerance with these equations.
    subroutine recommend_adaptive(tolerance, info, stepper, why)
        real(dp), intent(in) :: tolerance
        type(formulation_info_t), intent(in) :: info
        class(stepper_t), allocatable, intent(out) :: stepper
        character(:), allocatable, intent(out) :: why
        integer :: i

        do i = 1, size(recommendations)
            if (tolerance < recommendations(i)%least) cycle
            call create_stepper(recommendations(i)%method, stepper)
            why = trim(recommendations(i)%why)
            if (has_structure(info, stepper%info)) return
        end do
    end subroutine recommend_adaptive

    !> The stepper for equal steps with these equations.
    subroutine recommend_steps(info, stepper, why)
        type(formulation_info_t), intent(in) :: info
        class(stepper_t), allocatable, intent(out) :: stepper
        character(:), allocatable, intent(out) :: why
        type(recommendation_t) :: recommendation
        recommendation = for_steps
        if (info%symmetric_only .and. info%offers(structure_split)) recommendation = for_split_tops
        call create_stepper(recommendation%method, stepper)
        why = trim(recommendation%why)
    end subroutine recommend_steps

end module spintop_recommendation
