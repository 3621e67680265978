!> Any rigid body with a fixed point: attitude quaternion and angular momentum in body axes.
!>
!> No attitude is singular. The equations take the quaternion for the attitude that it points to,
!> whatever its length: they keep the length constant, and integrators nearly so.
module spintop_rigid_body
    use spintop_kinds, only: dp
    use spintop_attitude, only: quaternion_product, rotation_minus_one, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_capabilities, only: group_action_t, max_states
    use spintop_effects_series_quadruple, only: body_quadruple_t
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motion_slopes, only: verticals
    use spintop_motions, only: instants, motions_t
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_rigid_body_flows, only: rigid_body_flows_t
    use spintop_rigid_body_series, only: rigid_body_series_t
    use spintop_rigid_body_stages, only: rigid_body_stages_t
    use spintop_status, only: status_ok
    use spintop_vectors, only: cross
    implicit none
    private
    public :: rigid_body_t, body_turns_t

    !> State y = (q0, q1, q2, q3, Pi1, Pi2, Pi3).
    type, extends(formulation_t) :: rigid_body_t
        private
        !> Gravitational torque m g r, N m.
        real(dp) :: moment(3) = 0
        !> What couples the momenta in Pi x omega: see `momentum_coupling`.
        real(dp) :: coupling(3) = 0
    contains
        procedure :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: motion_without_angles
        procedure :: find_motions
        procedure :: find_turning
        procedure :: invariants
    end type rigid_body_t

    interface rigid_body_t
        module procedure new_rigid_body
    end interface rigid_body_t

    !> Turns about body axes, and sums of momenta.
    type, extends(group_action_t) :: body_turns_t
        private
        real(dp) :: inertia(3) = 1
    contains
        procedure :: set_body => set_turns
        procedure :: velocity
        procedure, nopass :: bracket
        procedure, nopass :: move
    end type body_turns_t

contains

    !> The formulation with all that it offers.
    function new_rigid_body() result(new)
        type(rigid_body_t) :: new
        allocate (rigid_body_flows_t :: new%flows)
        allocate (rigid_body_stages_t :: new%stages)
        allocate (body_turns_t :: new%group)
        allocate (rigid_body_series_t :: new%series)
        allocate (body_quadruple_t :: new%quadruple_series)
    end function new_rigid_body

    !> Name and properties.
    pure function describe(self) result(info)
        class(rigid_body_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('rigid_body', &
            'quaternion and body momentum, for any body, damped or not; no pole is singular', 7, &
            symmetric_only=.false., singular_at_poles=.false., invariants=4, quaternion=1, runs_in_lanes=.true.)
    end function describe

    !> Initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(rigid_body_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        self%body = body
        self%moment = body%weight_moment()
        self%coupling = momentum_coupling(body)
        self%momentum = 5
        call self%set_capabilities(body, start)
        y = 0
        y(1:4) = start%quaternion
        y(5:7) = body%inertia * start%omega
        scales = motion_scales(body, start)
        self%scale(1:4) = 0.5_dp
        self%scale(5:7) = scales%momentum
        status = status_ok
    end subroutine prepare

    !> q' = q (0, omega)/2, Pi' = Pi x omega + m g Gamma x r - damping (Euler-Poisson equations).
    pure subroutine derivative(self, t, y, dy, status)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: gamma(3), w1, w2, w3

        ! The products are written out: with function calls a step would take twice the time.
        associate (q0 => y(1), q1 => y(2), q2 => y(3), q3 => y(4), r => self%moment, &
                   d => self%body%damping, s => self%coupling)
            w1 = y(5) / self%body%inertia(1)
            w2 = y(6) / self%body%inertia(2)
            w3 = y(7) / self%body%inertia(3)
            gamma(1) = 2 * (q1 * q3 - q0 * q2)
            gamma(2) = 2 * (q2 * q3 + q0 * q1)
            gamma(3) = (q0**2 + q3**2) - (q1**2 + q2**2)
            gamma = gamma / ((q0**2 + q3**2) + (q1**2 + q2**2))
            dy(1) = -(q1 * w1 + q2 * w2 + q3 * w3) / 2
            dy(2) = (q0 * w1 + q2 * w3 - q3 * w2) / 2
            dy(3) = (q0 * w2 + q3 * w1 - q1 * w3) / 2
            dy(4) = (q0 * w3 + q1 * w2 - q2 * w1) / 2
            dy(5) = s(1) * y(6) * y(7) + gamma(2) * r(3) - gamma(3) * r(2) - d(1) * w1
            dy(6) = s(2) * y(7) * y(5) + gamma(3) * r(1) - gamma(1) * r(3) - d(2) * w2
            dy(7) = s(3) * y(5) * y(6) + gamma(1) * r(2) - gamma(2) * r(1) - d(3) * w3
            dy(8) = 0
        end associate
        status = status_ok
    end subroutine derivative

    !> The motion, with the angular acceleration of the derivative.
    pure type(motion_t) function motion(self, t, y, near)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        motion = motion_from_quaternion(t, y(1:4) / norm2(y(1:4)), y(5:7) / self%body%inertia, near)
        motion%norm_error = norm2(y(1:4)) - 1
        call self%derivative(t, y, dy, status)
        motion%omega_rate = dy(5:7) / self%body%inertia
    end function motion

    !> The same without angles and their rates, in a fraction of the time.
    pure function motion_without_angles(self, t, y) result(motion)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(motion_t) :: motion
        real(dp) :: length, q(4), gamma(3), w(3)
        length = sqrt(y(1)**2 + y(2)**2 + y(3)**2 + y(4)**2)
        q = y(1:4) / length
        w = y(5:7) / self%body%inertia
        gamma = vertical_from_quaternion(q)
        motion%t = t
        motion%quaternion = q
        motion%norm_error = length - 1
        motion%omega = w
        associate (r => self%moment, d => self%body%damping, s => self%coupling)
            motion%omega_rate(1) = s(1) * y(6) * y(7) + gamma(2) * r(3) - gamma(3) * r(2) - d(1) * w(1)
            motion%omega_rate(2) = s(2) * y(7) * y(5) + gamma(3) * r(1) - gamma(1) * r(3) - d(2) * w(2)
            motion%omega_rate(3) = s(3) * y(5) * y(6) + gamma(1) * r(2) - gamma(2) * r(1) - d(3) * w(3)
        end associate
        motion%omega_rate = motion%omega_rate / self%body%inertia
    end function motion_without_angles

    !> The same at several instants.
    pure subroutine find_motions(self, t, y, motions)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t(instants), y(instants, max_states) !! times, s, and states
        type(motions_t), intent(out) :: motions !! the motion at these times
        real(dp) :: share(instants), gamma(instants, 3), inverse(3)
        integer :: m

        inverse = 1 / self%body%inertia
        share = 1 / sqrt((y(:, 1)**2 + y(:, 2)**2) + (y(:, 3)**2 + y(:, 4)**2))
        do m = 1, 4
            motions%quaternion(:, m) = y(:, m) * share
        end do
        do m = 1, 3
            motions%omega(:, m) = y(:, 4 + m) * inverse(m)
        end do
        gamma = verticals(motions%quaternion)
        motions%t = t
        associate (r => self%moment, d => self%body%damping, s => self%coupling, w => motions%omega, rate => motions%omega_rate)
            rate(:, 1) = s(1) * y(:, 6) * y(:, 7) + gamma(:, 2) * r(3) - gamma(:, 3) * r(2) - d(1) * w(:, 1)
            rate(:, 2) = s(2) * y(:, 7) * y(:, 5) + gamma(:, 3) * r(1) - gamma(:, 1) * r(3) - d(2) * w(:, 2)
            rate(:, 3) = s(3) * y(:, 5) * y(:, 6) + gamma(:, 1) * r(2) - gamma(:, 2) * r(1) - d(3) * w(:, 3)
        end associate
        do m = 1, 3
            motions%omega_rate(:, m) = motions%omega_rate(:, m) * inverse(m)
        end do
    end subroutine find_motions

    !> The angular velocity of the attitude in the state, and its rate.
    pure subroutine find_turning(self, t, y, omega, rate)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in body axes, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        real(dp) :: dy(max_states)
        integer :: status
        omega = y(5:7) / self%body%inertia
        if (.not. present(rate)) return
        call self%derivative(t, y, dy, status)
        rate = dy(5:7) / self%body%inertia
    end subroutine find_turning

    !> Squared norm of the quaternion, energy, momentum about the vertical and, for a symmetric top, about its
    !> axis.
    pure subroutine invariants(self, y, values)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        real(dp) :: gamma(3)
        gamma = vertical_from_quaternion(y(1:4) / norm2(y(1:4)))
        values = 0
        values(1) = sum(y(1:4)**2)
        values(2) = sum(y(5:7)**2 / self%body%inertia) / 2 + dot_product(self%moment, gamma)
        values(3) = dot_product(y(5:7), gamma)
        if (self%body%is_lagrange()) values(4) = y(7)
    end subroutine invariants

    !> Constants of the group action.
    pure subroutine set_turns(self, body)
        class(body_turns_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        self%inertia = body%inertia
    end subroutine set_turns

    !> The angular velocity in body axes and the rate of the momentum: xi = (omega, Pi').
    pure subroutine velocity(self, y, dy, xi)
        class(body_turns_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), dy(max_states) !! state and slope
        real(dp), intent(out) :: xi(max_states) !! element of the algebra
        xi(1:3) = y(5:7) / self%inertia
        xi(4:6) = dy(5:7)
        xi(7:8) = 0
    end subroutine velocity

    !> Rotations about body axes are composed from left to right; momenta add up.
    pure function bracket(a, b)
        real(dp), intent(in) :: a(max_states), b(max_states) !! elements, in the order of time
        real(dp) :: bracket(max_states)
        bracket = 0
        bracket(1:3) = cross(a(1:3), b(1:3))
    end function bracket

    !> Rotates the attitude about a vector in body axes, and adds to the momentum.
    pure subroutine move(y, xi, change)
        real(dp), intent(in) :: y(max_states), xi(max_states) !! state, and element of the algebra
        real(dp), intent(out) :: change(max_states) !! of the state
        change(1:4) = quaternion_product(y(1:4), rotation_minus_one(xi(1:3)))
        change(5:7) = xi(4:6)
        change(8) = 0
    end subroutine move

end module spintop_rigid_body
