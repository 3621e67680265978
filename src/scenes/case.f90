!> A case: what a scene means, in numbers ready to compute with.
module spintop_case
    use spintop_kinds, only: dp, pi
    use spintop_compare, only: is_zero, is_finite
    use spintop_body, only: body_t
    use spintop_body_turn, only: body_turn_t, find_body_turn
    use spintop_body_of_scene, only: make_body, is_set
    use spintop_motion, only: motion_t
    use spintop_nutation, only: nutation_t, find_nutation
    use spintop_problems, only: problems_t
    use spintop_quantities, only: kinetic_energy
    use spintop_scene, only: scene_t
    use spintop_start_of_scene, only: make_start
    use spintop_status, only: status_ok
    implicit none
    private
    public :: case_t, make_case

    !> A body, its start, and how long to follow it.
    type :: case_t
        !> Body and start in the axes of the computation.
        type(body_t) :: body
        type(motion_t) :: start
        !> Body and start in the axes in which they were given, and the turn from those.
        type(body_t) :: given_body
        type(motion_t) :: given_start
        type(body_turn_t) :: turn
        !> Time span, s.
        real(dp) :: t_end = 0
    end type case_t

contains

    !> The case of a scene; without errors in `problems`, empty at first, it is complete. With `same_body` the body
    !> that the case has is kept, with `same_attitude` the attitude of its start.
    subroutine make_case(scene, case, problems, same_body, same_attitude)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(inout) :: case
        type(problems_t), intent(inout) :: problems
        logical, intent(in), optional :: same_body, same_attitude
        logical :: keep

        keep = .false.
        if (present(same_body)) keep = same_body
        if (.not. keep) then
            call make_body(scene, case%given_body, problems)
            if (.not. problems%any()) then
                case%turn = find_body_turn(case%given_body)
                case%body = case%turn%turned_body(case%given_body)
            end if
        end if
        call make_start(scene, case%given_body, .not. problems%any(), case%given_start, problems, same_attitude)
        if (.not. problems%any()) call check_magnitudes(case, problems)
        if (.not. problems%any()) then
            if (case%turn%is_turned()) then
                case%start = case%turn%turned_motion(case%given_start)
            else
                case%start = case%given_start
            end if
        end if
        call make_span(scene, case, problems)
    end subroutine make_case

    !> Energies beyond the largest number are no motion that numbers could follow.
    subroutine check_magnitudes(case, problems)
        type(case_t), intent(in) :: case
        type(problems_t), intent(inout) :: problems
        if (.not. (all(is_finite(case%given_body%weight_moment())) .and. all(is_finite(case%given_body%inertia)))) then
            call problems%add('top', 'the weight times its distance, or the inertia, is too large for a number', &
                              'use moderate units')
        else if (.not. is_finite(kinetic_energy(case%given_body, case%given_start))) then
            call problems%add('initial', 'the kinetic energy is too large for a number', 'use moderate units')
        end if
    end subroutine check_magnitudes

    !> The time span, in seconds or in periods of the motion.
    subroutine make_span(scene, case, problems)
        type(scene_t), intent(in) :: scene
        type(case_t), intent(inout) :: case
        type(problems_t), intent(inout) :: problems
        character(*), parameter :: ways = 'give exactly one of t_end, nutations and precessions'

        select case (count(is_set([scene%t_end, scene%nutations, scene%precessions])))
        case (0)
            call problems%add('span', 'the time span is not given', ways)
        case (1)
            if (is_set(scene%t_end)) case%t_end = scene%t_end
            if (problems%any()) return ! the other spans need a body and a start
            if (is_set(scene%nutations)) call count_nutations(scene%nutations, case, problems)
            if (is_set(scene%precessions)) call count_precessions(scene%precessions, case, problems)
        case default
            call problems%add(merge('span.precessions', 'span.nutations  ', is_set(scene%precessions)), &
                              'the time span is given more than once', ways)
        end select
    end subroutine make_span

    !> Span of so many nutation periods.
    subroutine count_nutations(nutations, case, problems)
        real(dp), intent(in) :: nutations
        type(case_t), intent(inout) :: case
        type(problems_t), intent(inout) :: problems
        type(nutation_t) :: nutation
        integer :: status
        if (.not. case%body%is_lagrange()) then
            call problems%add('span.nutations', 'the nutation period is known for an undamped symmetric &
                &top about body z', 'give t_end')
            return
        end if
        call find_nutation(case%body, case%start, nutation, status)
        case%t_end = nutations * nutation%period
        if (status /= status_ok .or. .not. is_finite(case%t_end)) then
            call problems%add('span.nutations', 'this motion has no finite nutation period', 'give t_end')
        end if
    end subroutine count_nutations

    !> Span of so many of the paper's precession periods T_p.
    subroutine count_precessions(precessions, case, problems)
        real(dp), intent(in) :: precessions
        type(case_t), intent(inout) :: case
        type(problems_t), intent(inout) :: problems
        associate (momentum => case%body%inertia(3) * case%start%omega(3), mgl => case%body%mgl())
            if (is_zero(momentum) .or. is_zero(mgl)) then
                call problems%add('span.precessions', 'the period 2 pi I3 omega3/(m g l) needs a spin and &
                    &a weight', 'give t_end')
                return
            end if
            case%t_end = precessions * abs(2 * pi * momentum / mgl)
        end associate
    end subroutine count_precessions

end module spintop_case
