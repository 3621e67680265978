!> Geometric methods: explicit ones of order 4 on the rotation group, and splitting methods.
!>
!> Each step of the former ends on the group, so the norm of a quaternion is conserved. An element of the algebra is a rotation
!> vector of the attitude, about body or space axes, and changes of the variables behind the quaternion, cyclically; elements are
!> applied in the order of time. The motion of a state is y' = d/ds move(y, s xi) at s = 0: velocities xi take the place of the
!> slopes of a Runge-Kutta method.
!>
!> The latter are compositions of the flows of drift and kick. They are symmetric, and conserve what both flows conserve: the
!> symplectic form, the norm of a quaternion, the momentum about the vertical. The energy error stays bounded. For equations
!> y'' = g(y) they are symplectic Runge-Kutta-Nystrom methods (Hairer, Lubich and Wanner, Geometric Numerical Integration, II.5
!> and IX.3).
module spintop_geometric
    use spintop_attitude, only: quaternion_product, rotation_minus_one
    use spintop_fixed_step, only: fixed_step_t
    use spintop_formulation, only: formulation_t, max_states
    use spintop_kinds, only: dp, cross
    use spintop_runge_kutta, only: butcher_t, max_stages, stage_sum
    use spintop_status, only: is_ok, status_ok
    use spintop_stepper, only: run_state_t
    implicit none
    private
    public :: munthe_kaas_t, commutator_free_t, velocity, bracket, move, splitting_table_t, splitting_table, splitting_t

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

    !> Maximum number of drifts of a table.
    integer, parameter :: max_flows = 17

    !> A splitting method.
    type :: splitting_table_t
        !> Number of drifts, and of kicks with a nonzero coefficient.
        integer :: stages = 0, kicks = 0
        real(dp) :: kick(0:max_flows) = 0, drift(max_flows) = 0
    end type splitting_table_t

    !> Two methods of one order: one for any drift and kick, and one for Nystrom splits.
    type, extends(fixed_step_t) :: splitting_t
        type(splitting_table_t) :: table(2)
    contains
        procedure :: step => step_by_flows
    end type splitting_t

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

    !> The method of an order. Those for Nystrom splits only are shorter; there is none of order 8, and the other serves.
    elemental type(splitting_table_t) function splitting_table(order, is_nystrom) result(table)
        integer, intent(in) :: order !! 2, 4, 6 or 8
        logical, intent(in) :: is_nystrom !! whether it is for Nystrom splits only
        real(dp), parameter :: outer = 1 / (4 - 4**(1.0_dp / 3))

        if (is_nystrom .and. order == 4) then
            ! Method SRKN_6^b of Blanes and Moan (J. Comput. Appl. Math. 142, 2002). Here and below their 15 decimals are extended
            ! by Newton's method for the order conditions.
            table = mirrored( &
                [0.08298440641740501883834748_dp, 0.3963098014983680770949115_dp, &
                 -0.03905630492234843517086529_dp], &
                [0.2452989571842711626039324_dp, 0.6048726657110799749608927_dp])
        else if (is_nystrom .and. order == 6) then
            ! Method SRKN_14^a of the same authors; it begins with a drift.
            table = mirrored( &
                [0.0_dp, 0.09171915262446201798118323_dp, 0.1839831700050048984914766_dp, &
                 -0.05653436583288910439527704_dp, 0.004914688774711885640205616_dp, &
                 0.1437611271683616823873745_dp, 0.3285676937468041402004813_dp], &
                [0.03785931984061094144702118_dp, 0.1026356331024365528470823_dp, &
                 -0.02586788826655833316394696_dp, 0.3142414030714464341471425_dp, &
                 -0.1301444595174151138496151_dp, 0.1064177003695413680222801_dp, &
                 -0.008794243128510204394069428_dp])
        else if (order == 2) then
            ! Kick, drift, kick (Stoermer, Verlet, Strang).
            table = composition([real(dp) ::])
        else if (order == 4) then
            ! Five steps of order 2 (Suzuki, Phys. Lett. A 146, 1990).
            table = composition([outer, outer])
        else if (order == 6) then
            ! Nine steps of order 2 (Kahan and Li, Math. Comp. 66, 1997).
            table = composition( &
                [0.39216144400731413927925056_dp, 0.33259913678935943859974864_dp, &
                 -0.70624617255763935980996482_dp, 0.08221359629355080023149045_dp])
        else
            ! Seventeen steps of order 2 (Kahan and Li).
            table = composition( &
                [0.13020248308889008087881763_dp, 0.56116298177510838456196441_dp, &
                 -0.38947496264484728640807860_dp, 0.15884190655515560089621075_dp, &
                 -0.39590389413323757733623154_dp, 0.18453964097831570709183254_dp, &
                 0.25837438768632204729397911_dp, 0.29501172360931029087096624_dp])
        end if
    end function splitting_table

    !> The composition of steps kick, drift, kick of the sizes `step` h, for any drift that is symmetric.
    pure type(splitting_table_t) function composition(step) result(table)
        real(dp), intent(in) :: step(:)
        table = mirrored((eoshift(step, -1) + step) / 2, step)
    end function composition

    !> The table of which this is the first half, without the last kick and the last drift; one of these is in
    !> the middle, the other next to it.
    pure type(splitting_table_t) function mirrored(kick, drift) result(table)
        real(dp), intent(in) :: kick(:), drift(:)
        logical :: kick_in_middle
        associate (kicks => size(kick), drifts => size(drift), stages => size(kick) + size(drift) + 1)
            kick_in_middle = mod(stages, 2) == 0
            table%stages = stages
            table%kick(:kicks - 1) = kick
            table%kick(kicks) = 0.5_dp - sum(kick)
            if (kick_in_middle) table%kick(kicks) = 1 - 2 * sum(kick)
            table%drift(:drifts) = drift
            table%drift(drifts + 1) = 0.5_dp - sum(drift)
            if (.not. kick_in_middle) table%drift(drifts + 1) = 1 - 2 * sum(drift)
            table%kick(stages:stages - kicks:-1) = table%kick(:kicks)
            table%drift(stages:stages - drifts:-1) = table%drift(:drifts + 1)
            table%kicks = count(abs(table%kick) > 0)
        end associate
    end function mirrored

    !> One step of flows. The change is summed from zero, so that rounding errors are relative to the change and not to the state.
    subroutine step_by_flows(self, h, change, status)
        class(splitting_t), intent(inout) :: self
        real(dp), intent(in) :: h !! step size, s
        real(dp), intent(out) :: change(max_states) !! change of the state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        integer :: i
        change = 0
        associate (table => self%table(merge(2, 1, self%formulation%splits_as_nystrom)), form => self%formulation)
            if (abs(table%kick(0)) > 0) call form%kick(self%y, h * table%kick(0), change)
            do i = 1, table%stages
                call form%drift(self%y, h * table%drift(i), change)
                if (abs(table%kick(i)) > 0) call form%kick(self%y, h * table%kick(i), change)
            end do
            self%counts%evaluations = self%counts%evaluations + table%kicks
        end associate
        status = status_ok
    end subroutine step_by_flows

end module spintop_geometric
