!> Any rigid body with a fixed point: attitude quaternion and angular momentum in body axes.
!>
!> No attitude is singular. The equations take the quaternion for the attitude that it points to,
!> whatever its length: they keep the length constant, and integrators nearly so.
!>
!> With effects the momentum P = I w_a + h contains that of the frame and of the rotor, and all moments of `spintop_loads` act. Then
!> there are no invariants, as effects do work and turn the momentum, no drift and kick, and no bound of the angular velocity, which
!> is not that of the momentum. Slopes and stages of a body without effects have equations of their own, so that it pays nothing for
!> them: by those with effects a run takes twice as long.
module spintop_rigid_body
    use, intrinsic :: iso_c_binding, only: c_double, c_int, c_loc, c_ptr
    use spintop_attitude, only: half_turn, quaternion_product, vertical_from_quaternion
    use spintop_body, only: body_t
    use spintop_body_numbers, only: kinds_of, look_up, numbers_of
    use spintop_kinds, only: dp, qp, no_number, is_zero
    use spintop_effects, only: effects_t, kernel_effects, series_effects, timeless_effects
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_formulation, only: formulation_info_t, formulation_t, max_aside, max_invariants, max_series_order, &
        max_states, motions_one_by_one, structure_group, structure_quadruple, structure_series, structure_split
    use spintop_kernel_types, only: body_numbers_t, motion_kinds_t, one_constants
    use spintop_loads, only: acceleration, find_kinematics, find_loads, loads_t, torque_series, total_momentum
    use spintop_motion, only: motion_t
    use spintop_motions, only: instants, motions_t, verticals
    use spintop_quadruple_start, only: quadruple_attitude, quadruple_omega, vector
    use spintop_quantities, only: motion_scales_t, motion_scales
    use spintop_status, only: status_ok
    implicit none
    private
    public :: rigid_body_t

    !> State y = (q0, q1, q2, q3, P1, P2, P3).
    type, extends(formulation_t) :: rigid_body_t
        private
        !> Gravitational torque m g r, N m.
        real(dp) :: moment(3) = 0
        !> What couples the momenta in P x omega: see `momentum_coupling`.
        real(dp) :: coupling(3) = 0
        !> Axis k of the symmetric body in the drift.
        integer :: axis = 3
        logical :: damped = .false.
        !> Which effects there are, and whether the series have all of them; constants of the kernels.
        type(motion_kinds_t) :: kinds = motion_kinds_t()
        logical :: has_effects = .false., has_series = .true.
        real(dp) :: constants(one_constants) = 0
    contains
        procedure :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: kinematics
        procedure :: find_motions
        procedure :: invariants
        procedure :: find_stages
        procedure :: expand
        procedure :: quadruple_start
        procedure :: expand_quadruple
        procedure :: drift
        procedure :: kick
    end type rigid_body_t

    interface
        pure subroutine c_find_stages(from, to, is_affected, kinds, constants, t, y, h, stages, a, since, c, k, aside) &
            bind(C, name='spintop_find_stages')
            import :: c_double, c_int, motion_kinds_t
            integer(c_int), value :: from, to, is_affected, stages
            type(motion_kinds_t), intent(in) :: kinds
            real(c_double), value :: t, h
            real(c_double), intent(in) :: constants(*), y(*), a(*), c(*)
            integer(c_int), intent(in) :: since(*)
            real(c_double), intent(inout) :: k(*), aside(*)
        end subroutine c_find_stages

        pure subroutine c_set(body, lane, constants) bind(C, name='spintop_one_set')
            import :: body_numbers_t, c_double, c_int
            type(body_numbers_t), intent(in) :: body
            integer(c_int), value :: lane
            real(c_double), intent(inout) :: constants(*)
        end subroutine c_set

        pure subroutine c_expand(order, kinds, constants, t, state, table, law, given, c, exists) &
            bind(C, name='spintop_expand_body')
            import :: c_double, c_int, motion_kinds_t
            integer(c_int), value :: order
            type(motion_kinds_t), intent(in) :: kinds
            real(c_double), value :: t
            real(c_double), dimension(*), intent(in) :: constants, state, table, law, given
            real(c_double), intent(inout) :: c(*)
            integer(c_int), intent(out) :: exists
        end subroutine c_expand

        ! Numbers of quadruple precision have no type that Fortran and C are sure to share.
        pure subroutine c_expand_quadruple(order, kinds, body, t, state, table, law, given, c, exists) &
            bind(C, name='spintop_expand_quadruple')
            import :: body_numbers_t, c_double, c_int, c_ptr, motion_kinds_t
            integer(c_int), value :: order
            type(motion_kinds_t), intent(in) :: kinds
            type(body_numbers_t), intent(in) :: body
            type(c_ptr), value :: state, given, c
            real(c_double), value :: t
            real(c_double), dimension(*), intent(in) :: table, law
            integer(c_int), intent(out) :: exists
        end subroutine c_expand_quadruple
    end interface

contains

    !> Name and properties.
    pure function info(self)
        class(rigid_body_t), intent(in) :: self
        type(formulation_info_t) :: info
        logical :: has_effects
        has_effects = allocated(self%body%effects)
        info = formulation_info_t('rigid_body', &
            'quaternion and body momentum, for any body, damped or not; no pole is singular', 7, &
            symmetric_only=.false., singular_at_poles=.false., invariants=merge(0, 4, has_effects), quaternion=1, &
            takes_effects=.true., runs_in_lanes=.true.)
        info%offers([structure_group, structure_series, structure_quadruple]) = .true.
        info%offers(structure_split) = .not. has_effects
        if (.not. has_effects) return
        info%what = 'quaternion and body momentum, for any body with effects; no pole is singular'
        ! An effect that only the loads know has no series.
        info%offers([structure_series, structure_quadruple]) = self%body%effects%only(series_effects)
    end function info

    !> Initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(rigid_body_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        self%body = body
        self%start = start
        self%moment = body%weight_moment()
        self%coupling = momentum_coupling(body)
        ! The axis about which the body is closest to symmetric.
        self%axis = minloc(abs(self%coupling), dim=1)
        self%damped = any(abs(body%damping) > 0)
        self%has_effects = allocated(body%effects)
        self%attitude = 1
        self%kinds = kinds_of(body)
        call c_set(numbers_of(body), 0, self%constants)
        y = 0
        y(1:4) = start%quaternion
        y(5:7) = body%inertia * start%omega
        scales = motion_scales(body, start)
        self%scale(1:4) = 0.5_dp
        self%scale(5:7) = scales%momentum
        status = status_ok
        self%has_stages = .true.
        if (.not. self%has_effects) then
            self%momentum = 5
            self%splits_as_nystrom = is_zero(self%coupling(self%axis)) .and. .not. self%damped
            return
        end if
        self%depends_on_time = .not. body%effects%only(timeless_effects)
        self%has_stages = body%effects%only(kernel_effects)
        self%has_series = body%effects%only(series_effects)
        if (.not. allocated(self%action)) allocate (self%action)
        call self%action%set(body)
        y(5:7) = total_momentum(body, 0.0_dp, start%quaternion, start%omega)
        self%scale(5:7) = max(scales%momentum, norm2(y(5:7)))
    end subroutine prepare

    !> q' = q (0, omega)/2, P' = P x omega + m g Gamma x r - damping (Euler-Poisson equations); with effects as in `spintop_loads`.
    pure subroutine derivative(self, t, y, dy, status)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), parameter :: none(1) = 0
        integer, parameter :: first(1) = 1
        real(dp) :: gamma(3), w(3), unused(max_aside)

        status = status_ok
        if (self%has_effects) then
            if (self%has_stages) then
                ! A slope is a first stage.
                call c_find_stages(0, 0, 1, self%kinds, self%constants, t, y, 0.0_dp, 1, none, first, none, dy, unused)
            else
                block
                    type(loads_t) :: loads ! is initialized: not in calls that have no use for it
                    call find_loads(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
                    dy(1:4) = quaternion_product(y(1:4), [0.0_dp, loads%omega]) / 2
                    dy(5:7) = loads%rate
                    dy(8) = 0
                end block
            end if
            return
        end if
        ! The products are written out: with function calls a step would take twice the time.
        w = y(5:7) / self%body%inertia
        associate (q0 => y(1), q1 => y(2), q2 => y(3), q3 => y(4), r => self%moment, &
                   d => self%body%damping, s => self%coupling)
            gamma(1) = 2 * (q1 * q3 - q0 * q2)
            gamma(2) = 2 * (q2 * q3 + q0 * q1)
            gamma(3) = (q0**2 + q3**2) - (q1**2 + q2**2)
            gamma = gamma / ((q0**2 + q3**2) + (q1**2 + q2**2))
            dy(1) = -(q1 * w(1) + q2 * w(2) + q3 * w(3)) / 2
            dy(2) = (q0 * w(1) + q2 * w(3) - q3 * w(2)) / 2
            dy(3) = (q0 * w(2) + q3 * w(1) - q1 * w(3)) / 2
            dy(4) = (q0 * w(3) + q1 * w(2) - q2 * w(1)) / 2
            dy(5) = s(1) * y(6) * y(7) + gamma(2) * r(3) - gamma(3) * r(2) - d(1) * w(1)
            dy(6) = s(2) * y(7) * y(5) + gamma(3) * r(1) - gamma(1) * r(3) - d(2) * w(2)
            dy(7) = s(3) * y(5) * y(6) + gamma(1) * r(2) - gamma(2) * r(1) - d(3) * w(3)
            dy(8) = 0
        end associate
    end subroutine derivative

    !> The angular velocity and, if it is wanted, its rate.
    pure subroutine kinematics(self, t, y, omega, rate)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in body axes, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        real(dp) :: dy(max_states)
        integer :: status
        if (self%has_effects) then
            block
                type(loads_t) :: loads
                if (present(rate)) then
                    call find_loads(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
                    rate = acceleration(self%body, loads)
                else
                    call find_kinematics(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
                end if
                omega = loads%omega
            end block
            return
        end if
        omega = y(5:7) / self%body%inertia
        if (.not. present(rate)) return
        call self%derivative(t, y, dy, status)
        rate = dy(5:7) / self%body%inertia
    end subroutine kinematics

    !> The motion at several instants.
    pure subroutine find_motions(self, t, y, motions)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t(instants), y(instants, max_states) !! times, s, and states
        type(motions_t), intent(out) :: motions !! the motion at these times
        real(dp) :: share(instants), gamma(instants, 3), inverse(3)
        integer :: m

        if (self%has_effects) then
            call motions_one_by_one(self, t, y, motions)
            return
        end if
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

    !> Stages of a step, by body_stages.h.
    !>
    !> Without effects the angular velocity omega and the vertical Gamma in body axes start from the momentum and the quaternion,
    !> and have stages of their own,
    !>
    !>     I omega' = (I omega) x omega + m g Gamma x r - damping omega,   Gamma' = Gamma x omega,
    !>
    !> for which the next stage waits half as long as for a vertical that is found from the quaternion in each stage. From a
    !> state on all of these have the same solution, and at the end of the step omega and Gamma are dropped, so the order of a
    !> method is the same. Aside are the changes of q, omega and Gamma over the step at the slopes.
    !>
    !> With effects that are analytic the quaternion has the norm of its beginning within a step. With U = P - h the equations of
    !> `spintop_loads` are
    !>
    !>     P' = U x w_a + h x w_a + m (g G + a) x r - d w - k |w|^(p - 1) w + c |v| v x r + M_b + R^T M_s,   v = w x r,
    !>
    !> and a in space axes is a sum of cos(W t) and sin(W t), each times a constant vector. Stages need nothing but the slopes.
    pure subroutine find_stages(self, from, to, t, y, h, stages, a, since, c, k, aside)
        class(rigid_body_t), intent(in) :: self
        integer, intent(in) :: from, to, stages, since(stages)
        real(dp), intent(in) :: t, y(max_states), h, a(stages, stages), c(stages)
        real(dp), intent(inout) :: k(max_states, stages), aside(max_aside, stages)
        call c_find_stages(from - 1, to - 1, merge(1, 0, self%has_effects), self%kinds, self%constants, t, y, h, stages, a, &
                           since, c, k, aside)
    end subroutine find_stages

    !> Taylor coefficients of the motion, by motion_series.h. Where there is no series, as for dry friction at rest, they are NaN.
    !>
    !> The upward vertical Gamma in body axes is expanded beside quaternion and momentum: Gamma from the quaternion would take
    !> more products, and make each term wait longer for the last. An angle xi about a body axis instead of the quaternion
    !> (`spintop_lane_series`) would save eight of them, but it is a quotient, whose series converges over shorter steps.
    pure subroutine expand(self, t, y, order, coefficient)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:order)
        real(dp) :: table(3, 0:3), law(5, 2), given(3, 0:max_series_order)
        integer(c_int) :: exists
        if (self%kinds%table + self%kinds%law > 0) call look_up(self%body, t, y, table, law)
        if (self%kinds%given > 0) given(:, :order) = real(torque_series(self%body%effects, t, order), dp)
        call c_expand(order, self%kinds, self%constants, t, y, table, law, given, coefficient, exists)
        if (exists == 0 .or. .not. self%has_series) coefficient(:, 1:order) = no_number
    end subroutine expand

    !> The state at the start.
    pure function quadruple_start(self) result(y)
        class(rigid_body_t), intent(in) :: self
        real(qp) :: y(max_states), q(4), omega(3), o(3), rotor(3)
        q = quadruple_attitude(self%start)
        omega = quadruple_omega(self%start)
        rotor = 0
        if (allocated(self%body%effects)) then
            o = frame_of(self%body%effects)
            rotor = self%body%effects%rotor_momentum
            if (any(abs(o) > 0)) omega = omega + 2 * (q(1)**2 * o - q(1) * vector(q(2:4), o) &
                + q(2:4) * dot_product(q(2:4), o)) / sum(q**2) - o
        end if
        y = [q, self%body%inertia * omega + rotor, 0.0_qp]
    end function quadruple_start

    !> The rotation of the frame; its rate itself was rounded.
    pure function frame_of(effects) result(rate)
        type(effects_t), intent(in) :: effects
        real(qp) :: rate(3)
        rate = effects%frame_rate
        if (abs(effects%earth_rate) > 0) rate(2:3) = effects%earth_rate * [cos(real(effects%latitude, qp)), &
                                                                           sin(real(effects%latitude, qp))]
    end function frame_of

    !> Taylor coefficients of the motion in quadruple precision. They take longer than a short run in double precision, so no
    !> constants are kept.
    pure subroutine expand_quadruple(self, t, y, order, coefficient)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(qp), intent(in) :: y(max_states) !! state
        integer, intent(in) :: order !! order of the highest coefficient
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        real(qp), target :: state(max_states), c(max_states, 0:order), given(3, 0:order)
        real(dp) :: table(3, 0:3), law(5, 2), undefined
        integer(c_int) :: exists
        associate (body => self%body)
            call look_up(body, t, real(y, dp), table, law)
            state = y
            given = 0
            if (allocated(body%effects)) given = torque_series(body%effects, t, order)
            call c_expand_quadruple(order, self%kinds, numbers_of(body), t, c_loc(state), table, law, c_loc(given), &
                                    c_loc(c), exists)
            coefficient(:, 0:order) = c
            undefined = no_number
            if (exists == 0 .or. .not. self%has_series) coefficient(:, 1:order) = undefined
        end associate
    end subroutine expand_quadruple

    !> Free rotation. In body axes the momentum rotates by the same angle in the opposite direction.
    !>
    !> The kinetic energy is that of a symmetric body with the axis k and the moments I_i, I_i, I_k, which turns
    !> by h Pi/I_i and then by h (1/I_k - 1/I_i) Pi_k about k, and the rest (1/I_j - 1/I_i) Pi_j^2/2, a turn
    !> about j, of which one half comes before and one after (Touma and Wisdom, Astron. J. 107, 1994; Fasso,
    !> J. Comput. Phys. 189, 2003). For a symmetric body the rest vanishes, and the drift is exact.
    pure subroutine drift(self, y, h, change)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states) !! since the beginning of the step; the effect is added
        real(dp) :: turn(4), q(4), rest
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
        q = y(1:4) + change(1:4)
        change(1) = change(1) + (q(1) * turn(1) - q(2) * turn(2) - q(3) * turn(3) - q(4) * turn(4))
        change(2) = change(2) + (q(1) * turn(2) + q(2) * turn(1) + q(3) * turn(4) - q(4) * turn(3))
        change(3) = change(3) + (q(1) * turn(3) - q(2) * turn(4) + q(3) * turn(1) + q(4) * turn(2))
        change(4) = change(4) + (q(1) * turn(4) + q(2) * turn(3) - q(3) * turn(2) + q(4) * turn(1))
    end subroutine drift

    !> The axis after a given one in the order x, y, z, x.
    elemental integer function next(axis)
        integer, intent(in) :: axis
        next = mod(axis, 3) + 1
    end function next

    !> Continues a rotation by a rotation about a body axis, by `h` times the momentum about it. `turn` is the
    !> quaternion of the whole rotation minus 1, `lag` the change of the momentum `p` in body axes.
    pure subroutine turn_about(axis, h, p, lag, turn)
        integer, intent(in) :: axis
        real(dp), intent(in) :: h, p(3)
        real(dp), intent(inout) :: lag(3), turn(4)
        real(dp) :: half, sinc, half_sine, half_drop, sine, drop, along, across, t(4)
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
        t = turn
        turn(1) = t(1) + (half_drop * t(1) - half_sine * t(1 + axis) + half_drop)
        turn(1 + axis) = t(1 + axis) + (half_drop * t(1 + axis) + half_sine * t(1) + half_sine)
        turn(1 + i) = t(1 + i) + (half_drop * t(1 + i) + half_sine * t(1 + j))
        turn(1 + j) = t(1 + j) + (half_drop * t(1 + j) - half_sine * t(1 + i))
    end subroutine turn_about

    !> Continues a rotation by a rotation about the momentum, by 2 `scale` times its magnitude.
    pure subroutine turn_along(scale, p, lag, turn)
        real(dp), intent(in) :: scale, p(3), lag(3)
        real(dp), intent(inout) :: turn(4)
        real(dp) :: sinc, drop, w1, w2, w3, t(4)

        w1 = scale * (p(1) + lag(1))
        w2 = scale * (p(2) + lag(2))
        w3 = scale * (p(3) + lag(3))
        call half_turn(w1**2 + w2**2 + w3**2, sinc, drop)
        w1 = sinc * w1
        w2 = sinc * w2
        w3 = sinc * w3
        t = turn
        turn(1) = t(1) + (t(1) * drop - (t(2) * w1 + t(3) * w2 + t(4) * w3) + drop)
        turn(2) = t(2) + (t(2) * drop + (t(1) * w1 + t(3) * w3 - t(4) * w2) + w1)
        turn(3) = t(3) + (t(3) * drop + (t(1) * w2 + t(4) * w1 - t(2) * w3) + w2)
        turn(4) = t(4) + (t(4) * drop + (t(1) * w3 + t(2) * w2 - t(3) * w1) + w3)
    end subroutine turn_along

    !> Changes the momentum by the torques of gravity, constant at rest, and of damping: Pi' = m g Gamma x
    !> r - d Pi/I.
    pure subroutine kick(self, y, h, change)
        class(rigid_body_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step, and time, s
        real(dp), intent(inout) :: change(max_states) !! since the beginning of the step; the effect is added
        real(dp) :: q(4), g1, g2, g3, scale, push(3)

        q = y(1:4) + change(1:4)
        scale = h / ((q(1)**2 + q(4)**2) + (q(2)**2 + q(3)**2))
        g1 = 2 * (q(2) * q(4) - q(1) * q(3))
        g2 = 2 * (q(3) * q(4) + q(1) * q(2))
        g3 = (q(1)**2 + q(4)**2) - (q(2)**2 + q(3)**2)
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
        change(5:7) = change(5:7) + push
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

end module spintop_rigid_body
