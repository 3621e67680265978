!> Drift and kick of any rigid body with a fixed point: the free turning, and the torques at rest.
!>
!> The kinetic energy is that of a symmetric body with the axis k and the moments I_i, I_i, I_k, which turns
!> by h Pi/I_i and then by h (1/I_k - 1/I_i) Pi_k about k, and the rest (1/I_j - 1/I_i) Pi_j^2/2, a turn
!> about j, of which one half comes before and one after (Touma and Wisdom, Astron. J. 107, 1994; Fasso,
!> J. Comput. Phys. 189, 2003). For a symmetric body the rest vanishes, and the drift is exact.
module spintop_rigid_body_flows
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_capabilities, only: flows_t, max_states
    use spintop_compare, only: is_zero
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_small_turn, only: half_turn
    implicit none
    private
    public :: rigid_body_flows_t

    !> Flows of the state y = (q0, q1, q2, q3, Pi1, Pi2, Pi3).
    type, extends(flows_t) :: rigid_body_flows_t
        private
        type(body_t) :: body = body_t()
        !> Gravitational torque m g r, N m, and what couples the momenta: see `momentum_coupling`.
        real(dp) :: moment(3) = 0, coupling(3) = 0
        !> Axis k of the symmetric body in the drift.
        integer :: axis = 3
        logical :: damped = .false.
    contains
        procedure :: set_body
        procedure :: drift
        procedure :: kick
    end type rigid_body_flows_t

contains

    !> Constants of the body.
    pure subroutine set_body(self, body)
        class(rigid_body_flows_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        self%body = body
        self%moment = body%weight_moment()
        self%coupling = momentum_coupling(body)
        ! The axis about which the body is closest to symmetric.
        self%axis = minloc(abs(self%coupling), dim=1)
        self%damped = any(abs(body%damping) > 0)
        self%splits_as_nystrom = is_zero(self%coupling(self%axis)) .and. .not. self%damped
    end subroutine set_body

    !> The axis after a given one in the order x, y, z, x.
    elemental integer function next(axis)
        integer, intent(in) :: axis
        next = mod(axis, 3) + 1
    end function next

    !> Free rotation. In body axes the momentum rotates by the same angle in the opposite direction.
    pure subroutine drift(self, y, h, change)
        class(rigid_body_flows_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states)
            !! change of the state since the beginning of the step, to which the effect is added
        real(dp) :: turn(4), q0, q1, q2, q3, rest
        integer :: i, j

        turn = 0
        associate (k => self%axis, p => y(5:7), lag => change(5:7))
            i = next(k)
            j = next(i)
            rest = h / 2 * self%coupling(k)
            if (abs(rest) > 0) call turn_about(j, rest, p, lag, turn)
            call turn_along(h / 2 / self%body%inertia(i), p, lag, turn)
            call turn_about(k, -h * self%coupling(j), p, lag, turn)
            if (abs(rest) > 0) call turn_about(j, rest, p, lag, turn)
        end associate
        q0 = y(1) + change(1)
        q1 = y(2) + change(2)
        q2 = y(3) + change(3)
        q3 = y(4) + change(4)
        change(1) = change(1) + (q0 * turn(1) - q1 * turn(2) - q2 * turn(3) - q3 * turn(4))
        change(2) = change(2) + (q0 * turn(2) + q1 * turn(1) + q2 * turn(4) - q3 * turn(3))
        change(3) = change(3) + (q0 * turn(3) - q1 * turn(4) + q2 * turn(1) + q3 * turn(2))
        change(4) = change(4) + (q0 * turn(4) + q1 * turn(3) - q2 * turn(2) + q3 * turn(1))
    end subroutine drift

    !> Continues a rotation by a rotation about a body axis, by `h` times the momentum about it. `turn` is the
    !> quaternion of the whole rotation minus 1, `lag` the change of the momentum `p` in body axes.
    pure subroutine turn_about(axis, h, p, lag, turn)
        integer, intent(in) :: axis
        real(dp), intent(in) :: h, p(3)
        real(dp), intent(inout) :: lag(3), turn(4)
        real(dp) :: half, sinc, half_sine, half_drop, sine, drop, along, across
        real(dp) :: t0, ti, tj, tk
        integer :: i, j

        i = next(axis)
        j = next(i)
        half = h / 2 * (p(axis) + lag(axis))
        call half_turn(half**2, sinc, half_drop)
        half_sine = sinc * half
        drop = -2 * half_sine**2
        sine = 2 * half_sine * (1 + half_drop)
        along = p(i) + lag(i)
        across = p(j) + lag(j)
        lag(i) = lag(i) + (drop * along + sine * across)
        lag(j) = lag(j) + (drop * across - sine * along)
        t0 = turn(1)
        ti = turn(1 + i)
        tj = turn(1 + j)
        tk = turn(1 + axis)
        turn(1) = t0 + (half_drop * t0 - half_sine * tk + half_drop)
        turn(1 + axis) = tk + (half_drop * tk + half_sine * t0 + half_sine)
        turn(1 + i) = ti + (half_drop * ti + half_sine * tj)
        turn(1 + j) = tj + (half_drop * tj - half_sine * ti)
    end subroutine turn_about

    !> Continues a rotation by a rotation about the momentum, by 2 `scale` times its magnitude.
    pure subroutine turn_along(scale, p, lag, turn)
        real(dp), intent(in) :: scale, p(3), lag(3)
        real(dp), intent(inout) :: turn(4)
        real(dp) :: sinc, drop, w1, w2, w3, t0, t1, t2, t3

        w1 = scale * (p(1) + lag(1))
        w2 = scale * (p(2) + lag(2))
        w3 = scale * (p(3) + lag(3))
        call half_turn(w1**2 + w2**2 + w3**2, sinc, drop)
        w1 = sinc * w1
        w2 = sinc * w2
        w3 = sinc * w3
        t0 = turn(1)
        t1 = turn(2)
        t2 = turn(3)
        t3 = turn(4)
        turn(1) = t0 + (t0 * drop - (t1 * w1 + t2 * w2 + t3 * w3) + drop)
        turn(2) = t1 + (t1 * drop + (t0 * w1 + t2 * w3 - t3 * w2) + w1)
        turn(3) = t2 + (t2 * drop + (t0 * w2 + t3 * w1 - t1 * w3) + w2)
        turn(4) = t3 + (t3 * drop + (t0 * w3 + t1 * w2 - t2 * w1) + w3)
    end subroutine turn_along

    !> Changes the momentum by the torques of gravity, constant at rest, and of damping: Pi' = m g Gamma x
    !> r - d Pi/I.
    pure subroutine kick(self, y, h, change)
        class(rigid_body_flows_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states)
            !! change of the state since the beginning of the step, to which the effect is added
        real(dp) :: q0, q1, q2, q3, g1, g2, g3, scale, push(3)

        q0 = y(1) + change(1)
        q1 = y(2) + change(2)
        q2 = y(3) + change(3)
        q3 = y(4) + change(4)
        scale = h / ((q0**2 + q3**2) + (q1**2 + q2**2))
        g1 = 2 * (q1 * q3 - q0 * q2)
        g2 = 2 * (q2 * q3 + q0 * q1)
        g3 = (q0**2 + q3**2) - (q1**2 + q2**2)
        associate (r => self%moment)
            push(1) = scale * (g2 * r(3) - g3 * r(2))
            push(2) = scale * (g3 * r(1) - g1 * r(3))
            push(3) = scale * (g1 * r(2) - g2 * r(1))
        end associate
        if (self%damped) then
            associate (x => h * self%body%damping / self%body%inertia)
                push = (push - x * (y(5:7) + change(5:7))) * decay_mean(x)
            end associate
        end if
        change(5) = change(5) + push(1)
        change(6) = change(6) + push(2)
        change(7) = change(7) + push(3)
    end subroutine kick

    !> Mean of exp(-s) over s from 0 to x: (1 - exp(-x))/x.
    elemental real(dp) function decay_mean(x)
        real(dp), intent(in) :: x
        real(dp), parameter :: small = 1
        if (abs(x) > small) then
            decay_mean = (1 - exp(-x)) / x
        else if (abs(x) > 0) then
            decay_mean = exp(-x / 2) * sinh(x / 2) / (x / 2)
        else
            decay_mean = 1
        end if
    end function decay_mean

end module spintop_rigid_body_flows
