!> The interface of what receives a motion at its sample times.
module spintop_observer
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp
    use spintop_loads, only: works
    implicit none
    private
    public :: observer_t

    !> Receives the motion at the sample times.
    type, abstract :: observer_t
        !> Set by the observer to end the run.
        logical :: has_enough = .false.
        !> Whether phi and psi count their turns, which requires an evaluation in every step; otherwise the
        !> angles are the values nearest to those of the start.
        logical :: counts_turns = .true.
        !> Whether the end of each step is observed too.
        logical :: sees_steps = .false.
        !> Whether the work of effects is wanted; then it is set before each motion is observed, J, by its parts.
        logical :: wants_work = .false.
        real(dp) :: work(works) = 0
        !> Where the body was given in other axes, the angles there, set before each motion is observed, rad.
        real(dp) :: given_angle(3) = 0
    contains
        procedure(observe), deferred :: observe
    end type observer_t

    abstract interface
        !> Receives the state `y` of a formulation at time `t`, and angles near those of the motion. The times
        !> are increasing.
        subroutine observe(self, formulation, t, y, near)
            import :: observer_t, formulation_t, dp, max_states
            class(observer_t), intent(inout) :: self
            class(formulation_t), intent(in) :: formulation !! the equations of motion, prepared for body and start
            real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        end subroutine observe
    end interface

end module spintop_observer
