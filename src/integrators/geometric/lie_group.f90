!> Explicit Lie-group methods of order 4. Each step ends on the group, so the norm of a quaternion is
!> conserved.
!>
!> Elements of the algebra are applied in the order of time. A formulation defines their action and their
!> bracket. Velocities xi take the place of the slopes of a Runge-Kutta method.
module spintop_lie_group
    use spintop_kinds, only: dp
    use spintop_butcher, only: butcher_t, max_stages
    use spintop_fixed_step, only: fixed_step_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_runge_kutta, only: stage_sum
    use spintop_status, only: is_ok
    use spintop_stepper, only: run_state_t
    implicit none
    private
    public :: munthe_kaas_t, commutator_free_t

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
        real(dp) :: k(max_states, max_stages), u(max_states), xi(max_states)
        integer :: i

        change = 0
        do i = 1, self%table%stages
            u = h * stage_sum(k, self%table%a(:, i), i - 1)
            call self%formulation%move(self%y, u, change)
            call find_velocity(self%run_state_t, self%t + self%table%c(i) * h, self%y + change, xi, status)
            if (.not. is_ok(status)) return
            k(:, i) = xi + algebra_correction(self%formulation, u, xi)
        end do
        call self%formulation%move(self%y, h * stage_sum(k, self%table%b, self%table%stages), change)
    end subroutine step_on_algebra

    !> dexp^-1_u xi - xi for elements applied in the order of time, to the terms needed for order 4: [u,
    !> xi]/2 + [u, [u, xi]]/12.
    function algebra_correction(formulation, u, xi) result(correction)
        class(formulation_t), intent(in) :: formulation
        real(dp), intent(in) :: u(max_states), xi(max_states)
        real(dp) :: correction(max_states), bracket(max_states)
        bracket = formulation%bracket(u, xi)
        correction = bracket / 2 + formulation%bracket(u, bracket) / 12
    end function algebra_correction

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
        call self%formulation%move(self%y, h / 2 * k1, to_second)
        call find_velocity(self%run_state_t, self%t + h / 2, self%y + to_second, k2, status)
        if (.not. is_ok(status)) return
        call self%formulation%move(self%y, h / 2 * k2, change)
        call find_velocity(self%run_state_t, self%t + h / 2, self%y + change, k3, status)
        if (.not. is_ok(status)) return
        change = to_second
        call move_on(self%run_state_t, h * (k3 - k1 / 2), change)
        call find_velocity(self%run_state_t, self%t + h, self%y + change, k4, status)
        if (.not. is_ok(status)) return
        call self%formulation%move(self%y, h / 12 * (3 * k1 + 2 * (k2 + k3) - k4), change)
        call move_on(self%run_state_t, h / 12 * (3 * k4 + 2 * (k2 + k3) - k1), change)
    end subroutine step_by_moves

    !> Moves the state that a change has led to.
    subroutine move_on(run, u, change)
        class(run_state_t), intent(in) :: run
        real(dp), intent(in) :: u(max_states)
        real(dp), intent(inout) :: change(max_states)
        real(dp) :: more(max_states)
        call run%formulation%move(run%y + change, u, more)
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
        call run%formulation%velocity(y, dy, xi)
    end subroutine find_velocity

end module spintop_lie_group
