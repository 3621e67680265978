!> Other accuracies of the method of a scene, from which the error of the method shows: a tenth and a hundredth of its
!> tolerances, or a half and a quarter of its step size. Tolerances that would become finer than rounding are larger instead.
!> There are two, because one may have the same error by chance.
module spintop_other_accuracy
    use spintop_kinds, only: dp
    use spintop_parameters, only: is_set, unset, unset_integer
    use spintop_plan, only: plan_t
    use spintop_scene_keys, only: scene_t
    implicit none
    private
    public :: set_other_accuracy, other_value, other_accuracies

    !> Number of other accuracies.
    integer, parameter :: other_accuracies = 2

    !> Tolerances below this do not make a motion more accurate; it is also taken for that of an unknown method.
    real(dp), parameter :: finest = 1.0e-15_dp
    !> Factors of the tolerances, of those that cannot be smaller, of the number of steps, and of its limit.
    real(dp), parameter :: smaller(other_accuracies) = [0.1_dp, 0.01_dp], larger(other_accuracies) = [10.0_dp, 3.0_dp]
    integer, parameter :: more(other_accuracies) = [2, 4], of_limit = 8

contains

    !> Changes the accuracy that a scene asks for. With the exact solution nothing changes.
    pure subroutine set_other_accuracy(scene, plan, number, keeps_rows)
        type(scene_t), intent(inout) :: scene !! contents of the input
        type(plan_t), intent(in) :: plan !! the plan of the scene
        integer, intent(in) :: number !! which of the accuracies
        logical, intent(in) :: keeps_rows !! its rows are those of the plan: the steps of fixed size are counted
        real(dp) :: relative

        if (scene%method == 'exact') return
        scene%max_steps = int(min(real(scene%max_steps, dp) * of_limit, real(huge(scene%max_steps) - 1, dp)))
        if (plan%is_adaptive()) then
            relative = finest
            if (is_set(scene%relative_tolerance)) relative = scene%relative_tolerance
            if (allocated(plan%stepper)) relative = plan%stepper%controls%relative_tolerance
            scene%relative_tolerance = other_value('integration.relative_tolerance', relative, relative, number)
            if (is_set(scene%absolute_tolerance)) scene%absolute_tolerance = &
                other_value('integration.absolute_tolerance', scene%absolute_tolerance, relative, number)
            return
        end if
        if (keeps_rows) then
            scene%samples = plan%samples
            scene%steps = plan%stepper%controls%steps
            scene%step = unset
        end if
        if (scene%steps /= unset_integer) scene%steps = more(number) * scene%steps
        if (is_set(scene%step)) scene%step = scene%step / more(number)
    end subroutine set_other_accuracy

    !> The value of a number of the input with another accuracy.
    pure real(dp) function other_value(name, value, relative, number) result(other)
        character(*), intent(in) :: name !! the number, as `integration.steps`
        real(dp), intent(in) :: value !! its value
        real(dp), intent(in) :: relative !! the relative tolerance
        integer, intent(in) :: number !! which of the accuracies
        other = value
        select case (name)
        case ('integration.relative_tolerance', 'integration.absolute_tolerance')
            other = value * smaller(number)
            if (relative * smaller(number) < finest) other = value * larger(number)
        case ('integration.steps')
            other = value * more(number)
        case ('integration.step')
            other = value / more(number)
        case ('integration.max_steps')
            other = value * of_limit
        end select
    end function other_value

end module spintop_other_accuracy
