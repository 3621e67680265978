!> What a formulation may offer to integrators beside y' = f(t, y): each capability is a type.
!>
!> A formulation has a capability or has it not (`formulation_t`); `can_run` asks for those that a
!> method needs. A capability has constants of its own, set for a body and a start, and is immutable
!> afterwards.
module spintop_capabilities
    use spintop_kinds, only: dp, qp
    use spintop_body, only: body_t
    use spintop_kernel_types, only: highest_order, numbers, set_aside
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants
    implicit none
    private
    public :: capability_t, stages_t, series_t, quadruple_series_t
    public :: max_states, max_series_order, max_aside
    public :: structure_none, structure_split, structure_group, structure_series, &
        structure_quadruple, structure_names

    !> Largest number of state variables of any formulation, and highest order of its Taylor series.
    integer, parameter :: max_states = numbers, max_series_order = highest_order
    !> How many numbers a stage may leave aside, of variables that follow from the state and have stages of their own.
    integer, parameter :: max_aside = set_aside

    !> Capabilities that a method may need: drift and kick, the two parts of the motion with flows of
    !> their own; motion on a Lie group; Taylor coefficients of the motion; the same in quadruple precision.
    integer, parameter :: structure_none = 0, structure_split = 1, structure_group = 2, &
        structure_series = 3, structure_quadruple = 4
    character(*), parameter :: structure_names(structure_split:structure_quadruple) = &
        [character(32) :: 'drift and kick', 'Lie-group motion', 'Taylor series', &
         'quadruple Taylor series']

    !> Any capability.
    type, abstract :: capability_t
    contains
        procedure :: set
        procedure :: set_body
    end type capability_t

    !> The stages of an explicit Runge-Kutta step in one call, cheaper than one by one. Equations with these hold for any
    !> state.
    type, abstract, extends(capability_t) :: stages_t
        !> Whether the body has such equations.
        logical :: holds = .true.
    contains
        procedure(find_stages), deferred :: find
    end type stages_t

    !> The motion as a Taylor series.
    type, abstract, extends(capability_t) :: series_t
    contains
        procedure(expand), deferred :: expand
        procedure :: unfold => keep_change
        procedure :: unfold_several => keep_changes
    end type series_t

    !> The same in quadruple precision, whose arithmetic takes longer than a short run in double precision: nothing is computed
    !> before it is asked for.
    type, abstract, extends(capability_t) :: quadruple_series_t
    contains
        procedure :: y_start => rounded_start
        procedure(expand_quadruple), deferred :: expand
    end type quadruple_series_t

    abstract interface
        !> Stages of a step of size h from the state y.
        pure subroutine find_stages(self, from, to, t, y, h, stages, a, since, c, k, aside)
            import :: stages_t, dp, max_aside, max_states
            class(stages_t), intent(in) :: self
            integer, intent(in) :: from, to !! first and last stage; there is at least one before
            real(dp), intent(in) :: t, y(max_states), h !! time and state at the beginning of the step, and its size, s
            integer, intent(in) :: stages !! their number in the table of the method
            real(dp), intent(in) :: a(stages, stages) !! column i contains the weights of the stages before stage i
            integer, intent(in) :: since(stages) !! stage i depends on the first one and on those from `since(i)` on
            real(dp), intent(in) :: c(stages) !! times of the stages in the step, over its size
            real(dp), intent(inout) :: k(max_states, stages) !! slopes: column i is that of stage i
            real(dp), intent(inout) :: aside(max_aside, stages) !! column i is what stage i leaves aside
        end subroutine find_stages

        !> Taylor coefficients of the motion that passes through `y` at the time `t`:
        !> y(t + h) = sum_k coefficient(:, k) h^k, k = 0 .. order, or of other variables that begin as `y`
        !> does and from which `unfold` makes the state.
        pure subroutine expand(self, t, y, order, coefficient)
            import :: series_t, dp, max_states, max_series_order
            class(series_t), intent(in) :: self
            real(dp), intent(in) :: t, y(max_states) !! time, s, and state about which the series is
            integer, intent(in) :: order !! at most `max_series_order`
            real(dp), intent(out) :: coefficient(max_states, 0:max_series_order) !! columns to `order` are set
        end subroutine expand

        !> Taylor coefficients of the state that is `y` at the time `t`, in quadruple precision.
        pure subroutine expand_quadruple(self, t, y, order, coefficient)
            import :: quadruple_series_t, dp, qp, max_states, max_series_order
            class(quadruple_series_t), intent(in) :: self
            real(dp), intent(in) :: t !! s
            real(qp), intent(in) :: y(max_states) !! state about which the series is
            integer, intent(in) :: order !! at most `max_series_order`
            real(qp), intent(out) :: coefficient(max_states, 0:max_series_order) !! columns to `order` are set
        end subroutine expand_quadruple
    end interface

contains

    !> Sets the constants for a body and its start; by default those of the body.
    pure subroutine set(self, body, start)
        class(capability_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        call self%set_body(body)
    end subroutine set

    !> Sets the constants for a body, where the start does not matter; by default there are none.
    pure subroutine set_body(self, body)
        class(capability_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
    end subroutine set_body

    !> The state at the start in quadruple precision; zero if it is the one in double precision.
    pure function rounded_start(self) result(y)
        class(quadruple_series_t), intent(in) :: self
        real(qp) :: y(max_states)
        y = 0
    end function rounded_start

    !> Makes the change of the state `y` after a time `h` of that of the variables of the series. Where
    !> these are the state, nothing is left to do.
    pure subroutine keep_change(self, y, h, change)
        class(series_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step; time, s
        real(dp), intent(inout) :: change(max_states) !! of the variables, then of the state
    end subroutine keep_change

    !> The same at several instants. What overrides one overrides the other.
    pure subroutine keep_changes(self, y, h, change)
        class(series_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h(instants) !! state at the beginning of the step; times, s
        real(dp), intent(inout) :: change(instants, max_states) !! of the variables, then of the state
    end subroutine keep_changes

end module spintop_capabilities
