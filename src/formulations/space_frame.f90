!> The symmetric top in space axes: angular momentum and the attitude without the spin.
!>
!> The momentum about the vertical is constant, and the spin about the axis, relative to axes that
!> turn with the angular velocity L/I1, is linear in time. It is split off: q = p exp(k sigma t/2).
!> What is left is bilinear, has no trigonometric functions and no singular attitude. With the axis
!> e, a quadratic form of p, L' = m g l (-e2, e1, 0) and e' = L x e/I1.
!>
!> In the drift, the top without weight, L is constant and p turns about it; the kick is the gravitational
!> torque at rest. (The split of Dullweber, Leimkuhler and McLachlan, J. Chem. Phys. 107, 1997, in
!> the axes in which free symmetric tops turn uniformly.)
module spintop_space_frame
    use spintop_kinds, only: dp, qp, xp
    use spintop_attitude, only: follow_angles, conjugate_quaternion, quaternion_product, to_space, &
        rotation_minus_one
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants, max_series_order, &
        max_states, structure_group, structure_quadruple, structure_series, structure_split
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_small_turn, only: half_turn
    use spintop_status, only: status_ok
    use spintop_vectors, only: cross
    implicit none
    private
    public :: space_frame_t

    !> State y = (L1, L2, p0, p1, p2, p3).
    type, extends(formulation_t) :: space_frame_t
        private
        !> Momentum about the vertical, spin rate about the axis, and sigma, its part split off.
        real(dp) :: vertical = 0, omega3 = 0, sigma = 0
        !> sigma with the digits that its phase needs.
        real(xp) :: spin_rate = 0
        real(dp) :: mgl = 0, i1 = 1
        type(motion_t) :: start = motion_t()
    contains
        procedure, nopass :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: drift
        procedure :: kick
        procedure :: motion
        procedure :: follow
        procedure :: invariants
        procedure :: series
        procedure :: unfold
        procedure :: series_quadruple
        procedure :: group_velocity
        procedure :: group_bracket
        procedure :: group_move
    end type space_frame_t

contains

    !> Name and properties.
    pure function info()
        type(formulation_info_t) :: info
        info = formulation_info_t('space_frame', &
            'momentum in space axes and quaternion without spin, for symmetric tops; no pole is singular', &
            6, singular_at_poles=.false., invariants=3, quaternion=3)
        info%offers([structure_split, structure_group, structure_series, structure_quadruple]) = .true.
    end function info

    !> Constants of the motion and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(space_frame_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(out) :: y(max_states)
        integer, intent(out) :: status
        type(motion_scales_t) :: scales
        real(dp) :: momentum(3)
        self%body = body
        momentum = to_space(start%quaternion, body%inertia * start%omega)
        self%vertical = momentum(3)
        self%start = start
        self%omega3 = start%omega(3)
        self%i1 = body%inertia(1)
        self%spin_rate = (real(body%inertia(1), xp) - body%inertia(3)) * start%omega(3) / body%inertia(1)
        self%sigma = real(self%spin_rate, dp)
        self%mgl = body%mgl()
        y = 0
        y(1:2) = momentum(1:2)
        y(3:6) = start%quaternion
        scales = motion_scales(body, start)
        self%scale(1:2) = scales%momentum
        self%scale(3:6) = 0.5_dp
        status = status_ok
    end subroutine prepare

    !> p' = (0, L/(2 I1)) p, and the gravitational torque.
    pure subroutine derivative(self, y, dy, status)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: dy(max_states)
        integer, intent(out) :: status
        real(dp) :: w1, w2, w3, pull

        ! Products are written out: a step by calls of functions would take twice the time.
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

    !> p turns by the angle h |L|/I1 about L: p+ = exp(h (0, L)/(2 I1)) p.
    pure subroutine drift(self, y, h, change)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
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
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        real(dp) :: p0, p1, p2, p3, pull
        p0 = y(3) + change(3)
        p1 = y(4) + change(4)
        p2 = y(5) + change(5)
        p3 = y(6) + change(6)
        pull = 2 * h * self%mgl / ((p0**2 + p3**2) + (p1**2 + p2**2))
        change(1) = change(1) - pull * (p2 * p3 - p0 * p1)
        change(2) = change(2) + pull * (p1 * p3 + p0 * p2)
    end subroutine kick

    !> The motion; the angular velocity in space axes is L/I1 + sigma e.
    pure type(motion_t) function motion(self, t, y, near)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3)
        real(dp) :: dy(max_states), q(4), momentum(3), axis(3), omega(3)
        integer :: status

        q = with_spin(self, t, y)
        omega = body_omega(self, t, y)
        motion = motion_from_quaternion(t, q, omega, near)
        motion%norm_error = norm2(y(3:6)) - 1
        call self%derivative(y, dy, status)
        momentum = [y(1:2), self%vertical]
        axis = to_space(q, [0.0_dp, 0.0_dp, 1.0_dp])
        motion%omega_rate = to_space(conjugate_quaternion(q), &
            [dy(1:2), 0.0_dp] + self%sigma * cross(momentum, axis)) / self%i1
    end function motion

    !> Unit quaternion of the attitude.
    pure function with_spin(self, t, y) result(q)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        real(dp) :: q(4)
        real(xp) :: half
        ! Of many turns a phase in double has no digit to spare.
        half = self%spin_rate * t / 2
        q = quaternion_product(y(3:6) / norm2(y(3:6)), [real(cos(half), dp), 0.0_dp, 0.0_dp, real(sin(half), dp)])
    end function with_spin

    !> Angular velocity in body axes.
    pure function body_omega(self, t, y) result(omega)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        real(dp) :: omega(3)
        omega = to_space(conjugate_quaternion(with_spin(self, t, y)), [y(1:2), self%vertical]) / self%i1
        omega(3) = omega(3) + self%sigma
    end function body_omega

    !> Angles of a later state; the spin split off turns psi by sigma t.
    pure subroutine follow(self, t_last, y_last, t, y, angle, sure)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: t_last, y_last(max_states), t, y(max_states)
        real(dp), intent(inout) :: angle(3)
        logical, intent(out) :: sure
        ! The attitude without spin has the angles less sigma t, from whenever t is counted.
        call follow_angles(y_last(3:6), without_spin(self, y_last), y(3:6), &
                           without_spin(self, y), t - t_last, angle, sure)
        angle(3) = angle(3) + self%sigma * (t - t_last)
    end subroutine follow

    !> Angular velocity L/I1, in the axes that p turns.
    pure function without_spin(self, y) result(omega)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp) :: omega(3)
        omega = to_space(conjugate_quaternion(y(3:6)), [y(1:2), self%vertical]) / self%i1
    end function without_spin

    !> Squared length of the quaternion, energy of the motion without its spin, and momentum about
    !> the axis.
    pure subroutine invariants(self, y, values)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: values(max_invariants)
        real(dp) :: axis(3)
        axis = to_space(y(3:6) / norm2(y(3:6)), [0.0_dp, 0.0_dp, 1.0_dp])
        values = 0
        values(1) = sum(y(3:6)**2)
        values(2) = sum(y(1:2)**2) / (2 * self%i1) + self%mgl * axis(3)
        values(3) = y(1) * axis(1) + y(2) * axis(2) + self%vertical * axis(3)
    end subroutine invariants

    !> Taylor coefficients of the motion, with L in axes that turn about the vertical with L_z/(2 I1).
    !>
    !> With m = m g l/I1, w = L/I1, the height u = e3 = u0 + v of the axis and the constants of the motion put
    !> in, as the state has them, the equations are, differentiated once more, linear but for v:
    !>     L'' = (m u0 - w3^2/4) L + m v L,
    !>     p'' = ((m u0 - w.w/2)/2 -+ m/2) p + m v p,  - for p0 and p3, + for p1 and p2,
    !>     v'' = v''(0) + (4 m u0 - w.w) v + 3 m v^2,
    !> with w.w at the start. (w.w/2 + m u and w.e are constant, k x e = k e + u and e p = p k as
    !> quaternions.) So a term needs one product only, with v, and a coefficient but the last but one.
    pure subroutine series(self, y, order, coefficient)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order)
        integer, parameter :: v = 7 !! place of v in what is below, beside the state
        integer :: j, k
        real(dp), parameter :: share(max_series_order) = [(1.0_dp / j, j=1, max_series_order)]
        !> The series, the factors of their linear terms and of their products, and sums of these.
        real(dp) :: c(max_states, 0:max_series_order)
        real(dp) :: linear(max_states), weight(max_states), odd(max_states), even(max_states)
        real(dp) :: m, w(3), axis(3), upper, lower, both, square

        m = self%mgl / self%i1
        w = [y(1:2), self%vertical] / self%i1
        square = w(1)**2 + w(2)**2 + w(3)**2
        associate (p0 => y(3), p1 => y(4), p2 => y(5), p3 => y(6))
            upper = p0**2 + p3**2
            lower = p1**2 + p2**2
            both = upper + lower
            axis = [2 * (p1 * p3 + p0 * p2), 2 * (p2 * p3 - p0 * p1), upper - lower] / both
            c(1, 1) = w(3) / 2 * y(2) - m * axis(2) * self%i1
            c(2, 1) = m * axis(1) * self%i1 - w(3) / 2 * y(1)
            c(3, 1) = -(w(1) * p1 + w(2) * p2 + w(3) * p3) / 2
            c(4, 1) = (w(1) * p0 + w(2) * p3 - w(3) * p2) / 2
            c(5, 1) = (w(2) * p0 + w(3) * p1 - w(1) * p3) / 2
            c(6, 1) = (w(3) * p0 + w(1) * p2 - w(2) * p1) / 2
        end associate
        c(v, 1) = w(1) * axis(2) - w(2) * axis(1)
        c(8, 1) = 0
        linear = [m * axis(3) - w(3)**2 / 4, m * axis(3) - w(3)**2 / 4, &
                  m / both * [-lower, upper, upper, -lower] - square / 4, 4 * m * axis(3) - square, 0.0_dp]
        weight = m * [1, 1, 1, 1, 1, 1, 3, 0]
        c(:, 0) = y
        c(7:8, 0) = 0
        c(:, 2) = linear * c(:, 0) / 2
        c(v, 2) = (w(3) * (w(1) * axis(1) + w(2) * axis(2)) - axis(3) * (w(1)**2 + w(2)**2) &
                   - m * (axis(1)**2 + axis(2)**2)) / 2
        do k = 1, order - 2
            ! Two sums: in one each product would wait for the last.
            odd = 0
            even = 0
            do j = 1, k, 2
                odd = odd + c(v, j) * c(:, k - j)
            end do
            do j = 2, k, 2
                even = even + c(v, j) * c(:, k - j)
            end do
            odd = weight * (odd + even) + linear * c(:, k)
            c(:, k + 2) = odd * (share(k + 1) * share(k + 2))
        end do
        c(v, :order) = 0
        coefficient(:, :order) = c(:, :order)
    end subroutine series

    !> Turns L back into axes at rest.
    pure subroutine unfold(self, y, h, change)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h
        real(dp), intent(inout) :: change(max_states)
        real(dp) :: angle, sinc, drop, l1, l2

        angle = self%vertical / self%i1 * h / 2
        call half_turn(angle**2, sinc, drop)
        l1 = y(1) + change(1)
        l2 = y(2) + change(2)
        change(1) = change(1) + (drop * l1 - angle * sinc * l2)
        change(2) = change(2) + (drop * l2 + angle * sinc * l1)
    end subroutine unfold

    !> The angular velocity L/I1 and the moment, in space axes: xi = (L/I1, L1', L2').
    pure subroutine group_velocity(self, y, xi, status)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states)
        real(dp), intent(out) :: xi(max_states)
        integer, intent(out) :: status
        real(dp) :: dy(max_states)
        call self%derivative(y, dy, status)
        xi = 0
        xi(1:3) = [y(1:2), self%vertical] / self%i1
        xi(4:5) = dy(1:2)
    end subroutine group_velocity

    !> Turns about space axes follow each other from right to left; momenta add up.
    pure function group_bracket(self, a, b) result(bracket)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: a(max_states), b(max_states)
        real(dp) :: bracket(max_states)
        associate (unused => self)
        end associate
        bracket = 0
        bracket(1:3) = cross(b(1:3), a(1:3))
    end function group_bracket

    !> Turns the attitude about a vector in space axes and adds to the momentum.
    pure subroutine group_move(self, y, xi, change)
        class(space_frame_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), xi(max_states)
        real(dp), intent(out) :: change(max_states)
        associate (unused => self)
        end associate
        change(1:2) = xi(4:5)
        change(3:6) = quaternion_product(rotation_minus_one(xi(1:3)), y(3:6))
        change(7:8) = 0
    end subroutine group_move

    !> Momentum about the vertical, the quaternion taken for the attitude that it points to. Near the
    !> upright its difference from that about the axis decides on the motion.
    pure real(qp) function vertical_momentum(body, start)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(qp) :: q(4), momentum(3)
        q = start%quaternion
        momentum = real(body%inertia, qp) * start%omega
        vertical_momentum = (2 * ((q(2) * q(4) - q(1) * q(3)) * momentum(1) &
                                  + (q(3) * q(4) + q(1) * q(2)) * momentum(2)) &
                             + (q(1)**2 + q(4)**2 - q(2)**2 - q(3)**2) * momentum(3)) / sum(q**2)
    end function vertical_momentum

    !> Taylor coefficients of the motion in quadruple precision.
    pure subroutine series_quadruple(self, y, order, coefficient)
        class(space_frame_t), intent(in) :: self
        real(qp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order)
        real(qp) :: by_l1(4), by_l2(4), by_p0(2), by_p3(2), half, vertical, pull
        integer :: k, j

        half = 1 / (2 * real(self%i1, qp))
        vertical = vertical_momentum(self%body, self%start) * half
        pull = 2 * real(self%body%mass, qp) * self%body%gravity * self%body%centre_of_mass(3) / sum(y(3:6)**2)
        coefficient(:, 0) = y
        associate (c => coefficient)
            do k = 0, order - 1
                by_l1 = 0
                by_l2 = 0
                by_p0 = 0
                by_p3 = 0
                do j = 0, k
                    by_l1 = by_l1 + c(1, j) * c(3:6, k - j)
                    by_l2 = by_l2 + c(2, j) * c(3:6, k - j)
                    by_p0 = by_p0 + c(3, j) * c(4:5, k - j)
                    by_p3 = by_p3 + c(6, j) * c(4:5, k - j)
                end do
                c(1, k + 1) = pull * (by_p0(1) - by_p3(2))
                c(2, k + 1) = pull * (by_p0(2) + by_p3(1))
                c(3, k + 1) = -half * (by_l1(2) + by_l2(3)) - vertical * c(6, k)
                c(4, k + 1) = half * (by_l1(1) + by_l2(4)) - vertical * c(5, k)
                c(5, k + 1) = half * (by_l2(1) - by_l1(4)) + vertical * c(4, k)
                c(6, k + 1) = half * (by_l1(3) - by_l2(2)) + vertical * c(3, k)
                c(7:8, k + 1) = 0
                c(:, k + 1) = c(:, k + 1) / (k + 1)
            end do
        end associate
    end subroutine series_quadruple

end module spintop_space_frame
