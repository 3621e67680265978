!> What the symmetric top in space axes offers to splitting and Lie-group methods: drift and kick, and the
!> action of turns.
!>
!> In the drift, the top without weight, L is constant and p turns about it; the kick is the gravitational
!> torque at rest. (The split of Dullweber, Leimkuhler and McLachlan, J. Chem. Phys. 107, 1997, in
!> the axes in which free symmetric tops turn uniformly.)
module spintop_space_frame_flows
    use spintop_kinds, only: dp
    use spintop_attitude, only: quaternion_product, rotation_minus_one, to_space
    use spintop_body, only: body_t
    use spintop_capabilities, only: flows_t, group_action_t, max_states
    use spintop_motion, only: motion_t
    use spintop_small_turn, only: half_turn
    use spintop_vectors, only: cross
    implicit none
    private
    public :: space_frame_flows_t, space_turns_t

    !> Flows of the state y = (L1, L2, p0, p1, p2, p3).
    type, extends(flows_t) :: space_frame_flows_t
        private
        !> Momentum about the vertical, m g l and I1.
        real(dp) :: vertical = 0, mgl = 0, i1 = 1
    contains
        procedure :: set => set_flows
        procedure :: drift
        procedure :: kick
    end type space_frame_flows_t

    !> Turns about space axes, and sums of momenta.
    type, extends(group_action_t) :: space_turns_t
        private
        !> Momentum about the vertical, and I1.
        real(dp) :: vertical = 0, i1 = 1
    contains
        procedure :: set => set_turns
        procedure :: velocity
        procedure, nopass :: bracket
        procedure, nopass :: move
    end type space_turns_t

contains

    !> Constants of the flows.
    pure subroutine set_flows(self, body, start)
        class(space_frame_flows_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp) :: momentum(3)
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%vertical = momentum(3)
        self%mgl = body%mgl()
        self%i1 = body%inertia(1)
    end subroutine set_flows

    !> Constants of the group action.
    pure subroutine set_turns(self, body, start)
        class(space_turns_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp) :: momentum(3)
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%vertical = momentum(3)
        self%i1 = body%inertia(1)
    end subroutine set_turns

    !> p rotates by the angle h |L|/I1 about L: p+ = exp(h (0, L)/(2 I1)) p.
    pure subroutine drift(self, y, h, change)
        class(space_frame_flows_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states)
            !! change of the state since the beginning of the step, to which the effect is added
        real(dp) :: w1, w2, w3, p0, p1, p2, p3, drop, scale, sinc

        scale = h / (2 * self%i1)
        w1 = scale * (y(1) + change(1))
        w2 = scale * (y(2) + change(2))
        w3 = scale * self%vertical
        call half_turn(w1**2 + w2**2 + w3**2, sinc, drop)
        p0 = y(3) + change(3)
        p1 = y(4) + change(4)
        p2 = y(5) + change(5)
        p3 = y(6) + change(6)
        change(3) = change(3) + (drop * p0 - sinc * (w1 * p1 + w2 * p2 + w3 * p3))
        change(4) = change(4) + (drop * p1 + sinc * (w1 * p0 + w2 * p3 - w3 * p2))
        change(5) = change(5) + (drop * p2 + sinc * (w2 * p0 + w3 * p1 - w1 * p3))
        change(6) = change(6) + (drop * p3 + sinc * (w3 * p0 + w1 * p2 - w2 * p1))
    end subroutine drift

    !> L changes by the gravitational torque.
    pure subroutine kick(self, y, h, change)
        class(space_frame_flows_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states)
            !! change of the state since the beginning of the step, to which the effect is added
        real(dp) :: p0, p1, p2, p3, pull
        p0 = y(3) + change(3)
        p1 = y(4) + change(4)
        p2 = y(5) + change(5)
        p3 = y(6) + change(6)
        pull = 2 * h * self%mgl / ((p0**2 + p3**2) + (p1**2 + p2**2))
        change(1) = change(1) - pull * (p2 * p3 - p0 * p1)
        change(2) = change(2) + pull * (p1 * p3 + p0 * p2)
    end subroutine kick

    !> The angular velocity L/I1 and the rate of the momentum, in space axes: xi = (L/I1, L1', L2').
    pure subroutine velocity(self, y, dy, xi)
        class(space_turns_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), dy(max_states) !! state, and its rate
        real(dp), intent(out) :: xi(max_states) !! element of the Lie algebra
        xi(1) = y(1) / self%i1
        xi(2) = y(2) / self%i1
        xi(3) = self%vertical / self%i1
        xi(4:5) = dy(1:2)
        xi(6:8) = 0
    end subroutine velocity

    !> Rotations about space axes are composed from right to left; momenta add up.
    pure function bracket(a, b)
        real(dp), intent(in) :: a(max_states), b(max_states) !! elements of the Lie algebra
        real(dp) :: bracket(max_states)
        bracket = 0
        bracket(1:3) = cross(b(1:3), a(1:3))
    end function bracket

    !> Rotates the attitude about a vector in space axes, and adds to the momentum.
    pure subroutine move(y, xi, change)
        real(dp), intent(in) :: y(max_states), xi(max_states) !! state, and element of the Lie algebra
        real(dp), intent(out) :: change(max_states) !! change of the state
        change(1:2) = xi(4:5)
        change(3:6) = quaternion_product(rotation_minus_one(xi(1:3)), y(3:6))
        change(7:8) = 0
    end subroutine move

end module spintop_space_frame_flows
