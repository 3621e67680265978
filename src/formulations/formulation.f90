!> The interface between formulations of the equations of motion, y' = f(y), and integrators.
!>
!> A formulation is set up once for a body and a start and is immutable afterwards, so that one
!> serves all threads. States sit in arrays of fixed size; unused components stay zero.
module spintop_formulation
    use spintop_kinds, only: dp, qp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: formulation_t, formulation_info_t, max_states, max_series_order, max_invariants
    public :: structure_none, structure_split, structure_group, structure_series, &
        structure_quadruple, structure_names

    !> Largest number of state variables of any formulation, of its invariants, and highest order of
    !> its Taylor series.
    integer, parameter :: max_states = 8, max_invariants = 5, max_series_order = 30

    !> Structures that a formulation may offer to integrators beside its right-hand side:
    !> drift and kick, the two parts of the motion with flows of their own;
    !> motion on a Lie group; Taylor coefficients of the motion; the same in quadruple precision.
    integer, parameter :: structure_none = 0, structure_split = 1, structure_group = 2, &
        structure_series = 3, structure_quadruple = 4
    character(*), parameter :: structure_names(structure_split:structure_quadruple) = &
        [character(32) :: 'drift and kick', 'Lie-group motion', 'Taylor series', &
         'quadruple Taylor series']

    !> Registry entry of a formulation.
    type :: formulation_info_t
        !> Name, as it stands in inputs.
        character(16) :: name = ''
        !> What it is, in a few words.
        character(112) :: what = ''
        !> Number of state variables in use.
        integer :: states = 0
        !> Holds only for a symmetric undamped top with its centre of mass on body z.
        logical :: symmetric_only = .true.
        !> Singular where sin(theta) = 0.
        logical :: singular_at_poles = .true.
        !> Takes theta' anew from the energy after each step.
        logical :: resets_speed = .false.
        !> Structures offered.
        logical :: offers(structure_split:structure_quadruple) = .false.
        !> Number of invariants that the state should keep.
        integer :: invariants = 0
        !> First of the four components that hold the attitude as a quaternion, of unit length at
        !> the start; 0 without one.
        integer :: quaternion = 0
    end type formulation_info_t

    !> A form of the equations of motion.
    type, abstract :: formulation_t
        !> The body that it was set up for.
        type(body_t) :: body = body_t()
        !> How large each state variable becomes, in the motion's own units, set by `prepare`: a radian
        !> for angles (half of it for quaternions), the largest rate and the largest momentum.
        !> Tolerances are relative to it.
        real(dp) :: scale(max_states) = 1
        !> State variables that may count any number of turns and on which nothing else depends: their
        !> magnitude says nothing of the motion.
        logical :: cyclic(max_states) = .false.
        !> Drift and kick are flows, the kick changes rates by a function of the attitude alone, and the
        !> drift turns by rates to which it is linear: the ground of Runge-Kutta-Nystrom tables.
        logical :: splits_as_nystrom = .true.
    contains
        procedure(info_of), deferred, nopass :: info
        procedure(prepare), deferred :: prepare
        procedure(derivative), deferred :: derivative
        procedure(motion_of), deferred :: motion
        procedure :: invariants => no_invariants
        procedure :: drift => no_flow
        procedure :: kick => no_flow
        procedure :: compose => compose_flows
        procedure :: group_velocity => no_group_velocity
        procedure :: group_bracket => no_group_bracket
        procedure :: group_move => no_group_move
        procedure :: series => no_series
        procedure :: unfold => keep_change
        procedure :: series_quadruple => no_series_quadruple
        procedure :: after_step => keep_state
        procedure :: follow => keep_angles
        procedure :: time_left => unlimited
        procedure :: depart => nowhere_to_depart
        procedure :: arrive => nowhere_to_arrive
    end type formulation_t

    abstract interface
        !> Name and properties.
        pure function info_of() result(info)
            import :: formulation_info_t
            type(formulation_info_t) :: info
        end function info_of

        !> Sets the constants of the motion and gives the initial state.
        pure subroutine prepare(self, body, start, y, status)
            import :: formulation_t, body_t, motion_t, dp, max_states
            class(formulation_t), intent(inout) :: self
            type(body_t), intent(in) :: body
            type(motion_t), intent(in) :: start
            real(dp), intent(out) :: y(max_states)
            integer, intent(out) :: status
        end subroutine prepare

        !> The right-hand side y' = f(y). A status other than `status_ok` says why there is none;
        !> `status_outside` is recoverable by a shorter step.
        pure subroutine derivative(self, y, dy, status)
            import :: formulation_t, dp, max_states
            class(formulation_t), intent(in) :: self
            real(dp), intent(in) :: y(max_states)
            real(dp), intent(out) :: dy(max_states)
            integer, intent(out) :: status
        end subroutine derivative

        !> The motion at time t in state y, accelerations from the formulation's own second
        !> derivatives; angles that the state holds only modulo a turn are taken next to `near`.
        pure function motion_of(self, t, y, near) result(motion)
            import :: formulation_t, motion_t, dp, max_states
            class(formulation_t), intent(in) :: self
            real(dp), intent(in) :: t, y(max_states), near(3)
            type(motion_t) :: motion
        end function motion_of
    end interface

contains

    !> Invariants (first integrals) of the motion: the first `info%invariants` values (energy J, momenta J s, squared
    !> length of a quaternion, ...), smooth functions of the state.
    pure subroutine no_invariants(self, y, values)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: values(max_invariants)
        associate (unused => self, also_unused => y)
        end associate
        values = 0
    end subroutine no_invariants

    !> A drift (`drift`) or a kick (`kick`) over `h` seconds, of either sign, from the state y + change:
    !> adds to `change` what it does.
    !> The two together are the motion: the sum of their right-hand sides is `derivative`. The kick is
    !> an exact flow; the drift is one or, without `splits_as_nystrom`, may be an approximation that is
    !> symmetric in h and of order 2.
    pure subroutine no_flow(self, y, h, change)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        associate (unused => self, also_unused => y, a => h, b => change)
        end associate
    end subroutine no_flow

    !> How kicks over `kicks` h and drifts over `drifts` h seconds, in turn and beginning with a kick,
    !> change the state. Formulations whose flows cost less than their calls bring one of their own.
    !>
    !> The change is summed from zero, so that rounding errors are relative to the change and not to the
    !> state.
    pure subroutine compose_flows(self, y, h, kicks, drifts, change)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h, kicks(0:), drifts(:)
        real(dp), intent(out) :: change(max_states)
        integer :: i
        change = 0
        if (abs(kicks(0)) > 0) call self%kick(y, h * kicks(0), change)
        do i = 1, size(drifts)
            call self%drift(y, h * drifts(i), change)
            if (abs(kicks(i)) > 0) call self%kick(y, h * kicks(i), change)
        end do
    end subroutine compose_flows

    !> The element of the Lie algebra along which the state moves: y' = d/ds group_move(y, s xi) at
    !> s = 0 equals `derivative`.
    pure subroutine no_group_velocity(self, y, xi, status)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: xi(max_states)
        integer, intent(out) :: status
        call self%derivative(y, xi, status)
    end subroutine no_group_velocity

    !> The bracket [a, b] of two elements of the algebra, such that moving by a, then b, is moving
    !> by a + b + [a, b]/2 + ...
    pure function no_group_bracket(self, a, b) result(bracket)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: a(max_states), b(max_states)
        real(dp) :: bracket(max_states)
        associate (unused => self, also_unused => a, unused_too => b)
        end associate
        bracket = 0
    end function no_group_bracket

    !> How the exponential of an element of the algebra changes the state.
    pure subroutine no_group_move(self, y, xi, change)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), xi(max_states)
        real(dp), intent(out) :: change(max_states)
        associate (unused => self, also_unused => y)
        end associate
        change = xi
    end subroutine no_group_move

    !> Taylor coefficients of the motion that passes through `y`:
    !> y(t + h) = sum_k coefficient(:, k) h^k, k = 0 .. order, or of other variables that begin as `y` does and
    !> from which `unfold` makes the state.
    pure subroutine no_series(self, y, order, coefficient)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order)
        associate (unused => self, also_unused => order)
        end associate
        coefficient = 0
        coefficient(:, 0) = y
    end subroutine no_series

    !> Makes the change of the state `y` after a time `h` of that of the variables of the series.
    pure subroutine keep_change(self, y, h, change)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        associate (unused => self, also_unused => y, nor_used => h, kept => change)
        end associate
    end subroutine keep_change

    !> The same in quadruple precision, for a state in quadruple precision.
    pure subroutine no_series_quadruple(self, y, order, coefficient)
        class(formulation_t), intent(in) :: self
        real(qp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order)
        associate (unused => self, also_unused => order)
        end associate
        coefficient = 0
        coefficient(:, 0) = y
    end subroutine no_series_quadruple

    !> Called after each accepted step: may project the state onto its constraints.
    !> `changed` says whether it did, `clipped` that it clipped an inadmissible value.
    pure subroutine keep_state(self, y, changed, clipped)
        class(formulation_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states)
        logical, intent(out) :: changed, clipped
        associate (unused => self, also_unused => y)
        end associate
        changed = .false.
        clipped = .false.
    end subroutine keep_state

    !> Carries angles along the motion from one time and state to a later one, so that those that
    !> the state holds only modulo a turn stay continuous; unless `sure`, more states between are
    !> needed. States that hold the angles themselves need none.
    pure subroutine keep_angles(self, t_last, y_last, t, y, angle, sure)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t_last, y_last(max_states), t, y(max_states)
        real(dp), intent(inout) :: angle(3)
        logical, intent(out) :: sure
        associate (unused => self, a => t_last, b => y_last, c => t, d => y, e => angle)
        end associate
        sure = .true.
    end subroutine keep_angles

    !> Estimate of the time left until the equations end, s; its error goes with its cube.
    pure real(dp) function unlimited(self, y)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        associate (unused => self, also_unused => y)
        end associate
        unlimited = huge(1.0_dp)
    end function unlimited

    !> Leaves a start where the right-hand side alone would stay for ever: on return `departed` is
    !> true and `y` the state a time `h` later by Taylor's series; with `h` = 0 the formulation
    !> chooses a short one itself.
    pure subroutine nowhere_to_depart(self, y, h, departed)
        class(formulation_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states), h
        logical, intent(out) :: departed
        associate (unused => self, also_unused => y, unused_too => h)
        end associate
        departed = .false.
    end subroutine nowhere_to_depart

    !> Where the equations end: `y`, with little time left, becomes the state at their end and
    !> `left` the time to it, by Taylor's series.
    pure subroutine nowhere_to_arrive(self, y, left)
        class(formulation_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states)
        real(dp), intent(out) :: left
        associate (also_unused => y)
        end associate
        left = self%time_left(y)
    end subroutine nowhere_to_arrive

end module spintop_formulation
