!> Explicit Lie-group methods of order 4. Each step ends on the group, so the norm of a quaternion is
!> conserved.
!>
!> An element of the algebra is a rotation vector of the attitude, about body or space axes, and changes of the variables
!> behind the quaternion, cyclically; elements are applied in the order of time. The motion of a state is y' = d/ds move(y, s
!> xi) at s = 0: velocities xi take the place of the slopes of a Runge-Kutta method.
module spintop_lie_group
    use spintop_attitude, only: quaternion_product, rotation_minus_one
    use spintop_kinds, only: dp, cross
    use spintop_runge_kutta, only: butcher_t, max_stages, stage_sum
    use spintop_fixed_step, only: fixed_step_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_status, only: is_ok
    use spintop_stepper, only: run_state_t
    implicit none
    private
    public :: munthe_kaas_t, commutator_free_t, velocity, bracket, move

    !> The method of Munthe-Kaas (Applied Numerical Mathematics 29, 1999; Iserles, Munthe-Kaas, Norsett and
    !> Zanna, Acta Numerica 9, 2000): a Runge-Kutta method on the algebra, whose element u moves the state
    !> from the beginning of the step to a stage.
    type, extends(fixed_step_t) :: munthe_kaas_t
        type(butcher_t) :: table
    contains
        procedure :: step => step_on_algebra
    end type munthe_kaas_t

    !> The commutator-free method of order 4 (Celledoni, Marthinsen and Owren, Future Generation
    !> Computer Systems 19, 2003): five moves, no bracket.
    type, extends(fixed_step_t) :: commutator_free_t
    contains
        procedure :: step => step_by_moves
    end type commutator_free_t

contains

    !> One step of the classical Runge-Kutta method for u' = dexp^-1_u xi.
    subroutine step_on_algebra(self, h, change, status)
        class(munthe_kaas_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: k(max_states, max_stages), u(max_states), xi(max_states), turned(max_states)
        integer :: i

        change = 0
        do i = 1, self%table%stages
            u = h * stage_sum(k, self%table%a(:, i), i - 1)
            call move(self%formulation, self%y, u, change)
            call find_velocity(self%run_state_t, self%t + self%table%c(i) * h, self%y + change, xi, status)
            if (.not. is_ok(status)) return
            ! dexp^-1_u xi for elements applied in the order of time, to the terms needed for order 4.
            turned = bracket(self%formulation, u, xi)
            k(:, i) = xi + (turned / 2 + bracket(self%formulation, u, turned) / 12)
        end do
        call move(self%formulation, self%y, h * stage_sum(k, self%table%b, self%table%stages), change)
    end subroutine step_on_algebra

    !> One step of five moves, two of which end it.
    subroutine step_by_moves(self, h, change, status)
        class(commutator_free_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), dimension(max_states) :: k1, k2, k3, k4, to_second

        change = 0
        call find_velocity(self%run_state_t, self%t, self%y, k1, status)
        if (.not. is_ok(status)) return
        call move(self%formulation, self%y, h / 2 * k1, to_second)
        call find_velocity(self%run_state_t, self%t + h / 2, self%y + to_second, k2, status)
        if (.not. is_ok(status)) return
        call move(self%formulation, self%y, h / 2 * k2, change)
        call find_velocity(self%run_state_t, self%t + h / 2, self%y + change, k3, status)
        if (.not. is_ok(status)) return
        change = to_second
        call move_on(self%run_state_t, h * (k3 - k1 / 2), change)
        call find_velocity(self%run_state_t, self%t + h, self%y + change, k4, status)
        if (.not. is_ok(status)) return
        call move(self%formulation, self%y, h / 12 * (3 * k1 + 2 * (k2 + k3) - k4), change)
        call move_on(self%run_state_t, h / 12 * (3 * k4 + 2 * (k2 + k3) - k1), change)
    end subroutine step_by_moves

    !> Moves the state that a change has led to.
    subroutine move_on(run, u, change)
        class(run_state_t), intent(in) :: run
        real(dp), intent(in) :: u(max_states)
        real(dp), intent(inout) :: change(max_states)
        real(dp) :: more(max_states)
        call move(run%formulation, run%y + change, u, more)
        change = change + more
    end subroutine move_on

    !> Velocity on the group.
    subroutine find_velocity(run, t, y, xi, status)
        class(run_state_t), intent(inout) :: run
        real(dp), intent(in) :: t, y(max_states)
        real(dp), intent(out) :: xi(max_states)
        integer, intent(out) :: status
        real(dp) :: dy(max_states)
        call run%evaluate(t, y, dy, status)
        xi = velocity(run%formulation, y, dy)
    end subroutine find_velocity

    !> The element of the algebra along which a state moves whose slope is `dy`; finite where these are.
    pure function velocity(formulation, y, dy) result(xi)
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        real(dp), intent(in) :: y(max_states), dy(max_states) !! state and slope
        real(dp) :: xi(max_states), v(3), dv(3), across(3)
        integer :: i
        ! The imaginary part of q* q' or of q' q*, written out: with function calls a step would take longer.
        associate (a => formulation%attitude)
            v = y(a + 1:a + 3)
            dv = dy(a + 1:a + 3)
            across = [v(2) * dv(3) - v(3) * dv(2), v(3) * dv(1) - v(1) * dv(3), v(1) * dv(2) - v(2) * dv(1)]
            if (.not. formulation%turns_in_space) across = -across
            xi(1:3) = (2 / (y(a)**2 + v(1)**2 + v(2)**2 + v(3)**2)) * (y(a) * dv - dy(a) * v + across)
            do i = 4, 7
                xi(i) = dy(1 + mod(a + i - 1, max_states))
            end do
            xi(8) = 0
        end associate
    end function velocity

    !> The bracket [a, b] of two elements: a move by a followed by a move by b is the move by a + b + [a, b]/2 + ... Rotations
    !> about body axes are composed from left to right, those about space axes from right to left; changes add up.
    pure function bracket(formulation, a, b)
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        real(dp), intent(in) :: a(max_states), b(max_states) !! elements, in the order of time
        real(dp) :: bracket(max_states)
        bracket = 0
        bracket(1:3) = cross(a(1:3), b(1:3))
        if (formulation%turns_in_space) bracket = -bracket
    end function bracket

    !> Change of a state by the exponential of an element.
    pure subroutine move(formulation, y, xi, change)
        class(formulation_t), intent(in) :: formulation !! the equations of motion
        real(dp), intent(in) :: y(max_states), xi(max_states) !! state and element
        real(dp), intent(out) :: change(max_states) !! of the state
        real(dp) :: turn(4)
        integer :: i
        turn = rotation_minus_one(xi(1:3))
        associate (a => formulation%attitude)
            if (formulation%turns_in_space) then
                change(a:a + 3) = quaternion_product(turn, y(a:a + 3))
            else
                change(a:a + 3) = quaternion_product(y(a:a + 3), turn)
            end if
            ! With a shift of the array a step would take half as long again.
            do i = 4, 7
                change(1 + mod(a + i - 1, max_states)) = xi(i)
            end do
        end associate
    end subroutine move

end module spintop_lie_group
