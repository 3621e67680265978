!> The symmetric top in space axes: angular momentum and the attitude without the spin.
!>
!> The momentum about the vertical is constant, and the spin about the axis, relative to axes that
!> turn with the angular velocity L/I1, is linear in time. It is split off: q = p exp(k sigma t/2).
!> What is left is bilinear, has no trigonometric functions and no singular attitude. With the axis
!> e, a quadratic form of p, L' = m g l (-e2, e1, 0) and e' = L x e/I1.
module spintop_space_frame
    use spintop_kinds, only: dp, epsilon_dp, xp
    use spintop_attitude, only: conjugate_quaternion, quaternion_product, rotation_minus_one, to_space
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants, max_states, structure_group, structure_split
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_small_turn, only: half_turn
    use spintop_space_frame_series, only: space_frame_quadruple_t, space_frame_series_t
    use spintop_status, only: status_ok
    use spintop_vectors, only: cross
    implicit none
    private
    public :: space_frame_t

    !> State y = (L1, L2, p0, p1, p2, p3).
    type, extends(formulation_t) :: space_frame_t
        private
        !> Momentum about the vertical.
        real(dp) :: vertical = 0
        !> sigma in extended precision, for its phase.
        real(xp) :: spin_rate = 0
        real(dp) :: mgl = 0, i1 = 1
    contains
        procedure :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: motion_without_angles
        procedure :: find_turning
        procedure :: invariants
        procedure :: drift
        procedure :: kick
        procedure :: velocity
        procedure, nopass :: bracket
        procedure, nopass :: move
    end type space_frame_t

    interface space_frame_t
        module procedure new_space_frame
    end interface space_frame_t

contains

    !> The formulation with all that it offers.
    function new_space_frame() result(new)
        type(space_frame_t) :: new
        allocate (space_frame_series_t :: new%series)
        allocate (space_frame_quadruple_t :: new%quadruple_series)
    end function new_space_frame

    !> Name and properties.
    pure function describe(self) result(info)
        class(space_frame_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('space_frame', &
            'momentum in space axes and quaternion without spin, for symmetric tops; no pole is singular', &
            6, singular_at_poles=.false., invariants=3, quaternion=3)
        info%offers([structure_split, structure_group]) = .true.
    end function describe

    !> Constants of the motion and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(space_frame_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        real(dp) :: momentum(3)
        self%body = body
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%vertical = momentum(3)
        self%i1 = body%inertia(1)
        self%spin_rate = (real(body%inertia(1), xp) - body%inertia(3)) * start%omega(3) / body%inertia(1)
        self%sigma = real(self%spin_rate, dp)
        self%splits_as_nystrom = .true.
        self%mgl = body%mgl()
        call self%set_capabilities(body, start)
        y = 0
        y(1:2) = momentum(1:2)
        y(3:6) = start%quaternion
        scales = motion_scales(body, start)
        self%scale(1:2) = scales%momentum
        self%scale(3:6) = 0.5_dp
        status = status_ok
    end subroutine prepare

    !> p' = (0, L/(2 I1)) p, and the gravitational torque.
    pure subroutine derivative(self, t, y, dy, status)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: w1, w2, w3, pull

        ! The products are written out: with function calls a step would take twice the time.
        associate (p0 => y(3), p1 => y(4), p2 => y(5), p3 => y(6))
            w1 = y(1) / (2 * self%i1)
            w2 = y(2) / (2 * self%i1)
            w3 = self%vertical / (2 * self%i1)
            pull = 2 * self%mgl / ((p0**2 + p3**2) + (p1**2 + p2**2))
            dy(1) = -pull * (p2 * p3 - p0 * p1)
            dy(2) = pull * (p1 * p3 + p0 * p2)
            dy(3) = -(w1 * p1 + w2 * p2 + w3 * p3)
            dy(4) = w1 * p0 + w2 * p3 - w3 * p2
            dy(5) = w2 * p0 + w3 * p1 - w1 * p3
            dy(6) = w3 * p0 + w1 * p2 - w2 * p1
            dy(7:8) = 0
        end associate
        status = status_ok
    end subroutine derivative

    !> The motion; the angular velocity in space axes is L/I1 + sigma e.
    pure type(motion_t) function motion(self, t, y, near)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        type(motion_t) :: here
        here = self%motion_without_angles(t, y)
        motion = motion_from_quaternion(t, here%quaternion, here%omega, near)
        motion%norm_error = here%norm_error
        motion%omega_rate = here%omega_rate
    end function motion

    !> The same without angles and their rates.
    pure function motion_without_angles(self, t, y) result(motion)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(motion_t) :: motion
        real(dp) :: dy(max_states), q(4), back(4), momentum(3), axis(3), omega(3), norm
        integer :: status

        norm = sqrt(sum(y(3:6)**2))
        q = with_spin(self, t, y(3:6) / norm)
        back = conjugate_quaternion(q)
        momentum = [y(1:2), self%vertical]
        omega = to_space(back, momentum) / self%i1
        omega(3) = omega(3) + self%sigma
        motion%t = t
        motion%quaternion = q
        motion%omega = omega
        motion%norm_error = norm - 1
        call self%derivative(t, y, dy, status)
        axis = to_space(q, [0.0_dp, 0.0_dp, 1.0_dp])
        motion%omega_rate = to_space(back, [dy(1:2), 0.0_dp] + self%sigma * cross(momentum, axis)) / self%i1
    end function motion_without_angles

    !> Unit quaternion of the attitude, from that without the spin.
    pure function with_spin(self, t, p) result(q)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, p(4)
        real(dp) :: q(4)
        real(xp) :: half
        real(dp), parameter :: small = sqrt(epsilon_dp)
        real(dp) :: phase, rest, c, s, rest_c, rest_s
        ! After many turns a phase in double precision is not accurate enough: its rest is a rotation, mostly small.
        half = self%spin_rate * t / 2
        phase = real(half, dp)
        rest = real(half - phase, dp)
        c = cos(phase)
        s = sin(phase)
        rest_c = 1
        rest_s = rest
        if (abs(rest) > small) then
            rest_c = cos(rest)
            rest_s = sin(rest)
        end if
        q = quaternion_product(p, [c * rest_c - s * rest_s, 0.0_dp, 0.0_dp, s * rest_c + c * rest_s])
    end function with_spin

    !> The angular velocity L/I1 in the axes of p, and its rate L'/I1.
    pure subroutine find_turning(self, t, y, omega, rate)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in body axes, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        real(dp) :: dy(max_states)
        integer :: status
        omega = to_space(conjugate_quaternion(y(3:6)), [y(1:2), self%vertical]) / self%i1
        if (.not. present(rate)) return
        call self%derivative(t, y, dy, status)
        rate = to_space(conjugate_quaternion(y(3:6)), [dy(1:2), 0.0_dp]) / self%i1
    end subroutine find_turning

    !> Squared norm of the quaternion, energy of the motion without its spin, and momentum about the axis.
    pure subroutine invariants(self, y, values)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        real(dp) :: axis(3)
        axis = to_space(y(3:6) / norm2(y(3:6)), [0.0_dp, 0.0_dp, 1.0_dp])
        values = 0
        values(1) = sum(y(3:6)**2)
        values(2) = sum(y(1:2)**2) / (2 * self%i1) + self%mgl * axis(3)
        values(3) = y(1) * axis(1) + y(2) * axis(2) + self%vertical * axis(3)
    end subroutine invariants

    !> In the drift, the top without weight, L is constant and p turns about it; the kick is the gravitational
    !> torque at rest. (The split of Dullweber, Leimkuhler and McLachlan, J. Chem. Phys. 107, 1997, in
    !> the axes in which free symmetric tops turn uniformly.)
    !>
    !> p rotates by the angle h |L|/I1 about L: p+ = exp(h (0, L)/(2 I1)) p.
    pure subroutine drift(self, y, h, change)
        class(space_frame_t), intent(in) :: self
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
        class(space_frame_t), intent(in) :: self
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
        class(space_frame_t), intent(in) :: self
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

end module spintop_space_frame
