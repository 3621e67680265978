!> Any rigid body with a fixed point under effects: the equations of `rigid_body` with the momentum P = I w_a + h, which
!> contains that of the frame and of the rotor, and all moments of `spintop_loads`.
!>
!> A type of its own, so that a body without effects pays nothing for them: by these equations a run of ode45, dop853 or
!> Taylor takes two to three times as long without effects as by those of `rigid_body`. It has no invariants, as effects do
!> work and turn the momentum, and no bound of its angular velocity, which is not that of the momentum.
module spintop_body_with_effects
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_attitude, only: quaternion_product
    use spintop_body, only: body_t
    use spintop_body_numbers, only: kinds_of, look_up, numbers_of
    use spintop_body_quadruple, only: quaternion_body_t
    use spintop_compare, only: is_zero
    use spintop_effects, only: effects_t, kernel_effects, series_effects, timeless_effects
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_formulation, only: formulation_info_t, max_aside, max_series_order, max_states, structure_group, &
        structure_quadruple, structure_series
    use spintop_kernel_types, only: body_numbers_t, motion_kinds_t, one_constants, stage_effects_t, share_rest, &
        short_share
    use spintop_kinds, only: dp, no_number
    use spintop_loads, only: acceleration, find_kinematics, find_loads, loads_t, torque_series, total_momentum
    use spintop_motion, only: motion_t
    use spintop_quantities, only: motion_scales_t, motion_scales
    use spintop_status, only: status_ok
    use spintop_vectors, only: cross
    implicit none
    private
    public :: body_with_effects_t

    !> State y = (q0, q1, q2, q3, P1, P2, P3).
    type, extends(quaternion_body_t) :: body_with_effects_t
        private
        type(effects_t) :: effects
        !> Constants of stages; which parts of the equations there are, and constants of the series.
        type(stage_effects_t) :: stage
        type(motion_kinds_t) :: kinds
        real(dp) :: constants(one_constants) = 0
        !> Whether the series have all effects.
        logical :: has_series = .true.
    contains
        procedure :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: kinematics
        procedure :: find_stages
        procedure :: expand
    end type body_with_effects_t

    interface
        pure subroutine c_find_stages(from, to, effects, t, y, h, a, stride, c, k) bind(C, name='spintop_find_effects_stages')
            import :: c_double, c_int, stage_effects_t
            integer(c_int), value :: from, to, stride
            type(stage_effects_t), intent(in) :: effects
            real(c_double), value :: t, h
            real(c_double), intent(in) :: y(*), a(*), c(*)
            real(c_double), intent(inout) :: k(*)
        end subroutine c_find_stages

        pure subroutine c_set_series(body, constants) bind(C, name='spintop_set_one')
            import :: body_numbers_t, c_double
            type(body_numbers_t), intent(in) :: body
            real(c_double), intent(inout) :: constants(*)
        end subroutine c_set_series

        pure subroutine c_expand(order, kinds, constants, t, state, table, law, given, share, share_rest, c, exists) &
            bind(C, name='spintop_expand_effects')
            import :: c_double, c_int, motion_kinds_t
            integer(c_int), value :: order
            type(motion_kinds_t), intent(in) :: kinds
            real(c_double), value :: t
            real(c_double), dimension(*), intent(in) :: constants, state, table, law, given, share, share_rest
            real(c_double), intent(inout) :: c(*)
            integer(c_int), intent(out) :: exists
        end subroutine c_expand
    end interface

contains

    !> Name and properties: a variant of `rigid_body`.
    pure function info(self)
        class(body_with_effects_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('rigid_body', &
            'quaternion and body momentum, for any body with effects; no pole is singular', 7, &
            symmetric_only=.false., singular_at_poles=.false., quaternion=1, takes_effects=.true., &
            runs_in_lanes=.true.)
        info%offers(structure_group) = .true.
        info%offers([structure_series, structure_quadruple]) = .true.
        ! An effect that only the loads know has no series.
        if (allocated(self%body%effects)) info%offers([structure_series, structure_quadruple]) = &
            self%body%effects%only(series_effects)
    end function info

    !> Initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(body_with_effects_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        self%body = body
        self%start = start
        self%effects = effects_t()
        if (allocated(body%effects)) self%effects = body%effects
        self%depends_on_time = .not. self%effects%only(timeless_effects)
        self%attitude = 1
        self%has_stages = self%effects%only(kernel_effects)
        call set_stages(self)
        self%kinds = kinds_of(body)
        self%has_series = self%effects%only(series_effects)
        call c_set_series(numbers_of(body), self%constants)
        if (.not. allocated(self%action)) allocate (self%action)
        call self%action%set(body)
        y = 0
        y(1:4) = start%quaternion
        y(5:7) = total_momentum(body, 0.0_dp, start%quaternion, start%omega)
        scales = motion_scales(body, start)
        self%scale(1:4) = 0.5_dp
        self%scale(5:7) = max(scales%momentum, norm2(y(5:7)))
        status = status_ok
    end subroutine prepare

    !> q' = q (0, w)/2, and P' as in `spintop_loads`.
    pure subroutine derivative(self, t, y, dy, status)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp), parameter :: none(1) = 0
        type(loads_t) :: loads
        status = status_ok
        ! A slope is a first stage.
        if (self%has_stages) then
            call c_find_stages(0, 0, self%stage, t, y, 0.0_dp, none, 1, none, dy)
            return
        end if
        call find_loads(self%body, self%effects, t, y(1:4), y(5:7), loads)
        dy(1:4) = quaternion_product(y(1:4), [0.0_dp, loads%omega]) / 2
        dy(5:7) = loads%rate
        dy(8) = 0
    end subroutine derivative

    !> The angular velocity and, if it is wanted, its rate.
    pure subroutine kinematics(self, t, y, omega, rate)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in body axes, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        type(loads_t) :: loads
        if (present(rate)) then
            call find_loads(self%body, self%effects, t, y(1:4), y(5:7), loads)
            rate = acceleration(self%body, loads)
        else
            call find_kinematics(self%body, self%effects, t, y(1:4), y(5:7), loads)
        end if
        omega = loads%omega
    end subroutine kinematics

    !> Constants of the stages.
    pure subroutine set_stages(self)
        class(body_with_effects_t), intent(inout) :: self
        real(dp), dimension(3) :: even, odd

        self%stage = stage_effects_t()
        associate (of => self%stage, body => self%body, effects => self%effects, o => self%effects%frame_rate, &
                   rate => self%effects%vibration_rate)
            of%mobility(:3) = 1 / body%inertia
            of%coupling(:3) = momentum_coupling(body)
            of%damping(:3) = body%damping
            of%weight(:3) = body%mass * body%centre_of_mass
            of%arm(:3) = body%centre_of_mass
            of%gravity = body%gravity
            of%drag_force = effects%drag_force
            if (is_zero(effects%drag_exponent - 1)) then
                of%damping(:3) = of%damping(:3) + effects%drag_moment
            else
                of%drag(:3) = effects%drag_moment
                of%drag_power = (effects%drag_exponent - 1) / 2
            end if
            of%torque_body(:3) = effects%torque_body
            of%torque_space(:3) = effects%torque_space
            of%rotor(:3) = effects%rotor_momentum
            of%drive(:3) = effects%rotor_torque
            of%frame(:3) = o
            of%rate = rate
            even = effects%vibration_amplitude * cos(effects%vibration_phase)
            odd = effects%vibration_amplitude * sin(effects%vibration_phase)
            of%swing(:3, 1) = -rate**2 * even - 2 * rate * cross(o, odd) + cross(o, cross(o, even))
            of%swing(:3, 2) = rate**2 * odd - 2 * rate * cross(o, even) - cross(o, cross(o, odd))
            of%has_rotor = flag([of%rotor, of%drive])
            of%has_drag = flag(of%drag)
            of%vibrates = flag(effects%vibration_amplitude)
            of%turns = flag(o)
            of%has_sides = flag([o(:2), effects%torque_space(:2), of%swing(:2, 1), of%swing(:2, 2)])
        end associate
    end subroutine set_stages

    !> 1 if any value is not zero.
    pure integer(c_int) function flag(values)
        real(dp), intent(in) :: values(:)
        flag = merge(0, 1, all(is_zero(values)))
    end function flag

    !> Stages of a step for effects that are analytic, by effects_stages.h.
    !>
    !> Within a step the quaternion has the norm |q| = N of its beginning, as in `spintop_rigid_body`. With U = P - h the
    !> equations of `spintop_loads` are
    !>
    !>     P' = U x w_a + h x w_a + m (g G + a) x r - d w - k |w|^(p - 1) w + c |v| v x r + M_b + R^T M_s,   v = w x r,
    !>
    !> and a in space axes is a sum of cos(W t) and sin(W t), each times a constant vector. Stages need nothing but the slopes.
    pure subroutine find_stages(self, from, to, t, y, h, stages, a, since, c, k, aside)
        class(body_with_effects_t), intent(in) :: self
        integer, intent(in) :: from, to, stages, since(stages)
        real(dp), intent(in) :: t, y(max_states), h, a(stages, stages), c(stages)
        real(dp), intent(inout) :: k(max_states, stages), aside(max_aside, stages)
        call c_find_stages(from - 1, to - 1, self%stage, t, y, h, a, stages, c, k)
    end subroutine find_stages

    !> Taylor coefficients of the motion, by motion_series.h. Where there is no series, as for dry friction at rest, they are NaN.
    pure subroutine expand(self, t, y, order, coefficient)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order)
        real(dp) :: table(3, 0:3), law(5, 2), given(3, 0:order)
        integer(c_int) :: exists
        if (self%kinds%table + self%kinds%law > 0) call look_up(self%body, t, y, table, law)
        if (self%kinds%given > 0) given = real(torque_series(self%effects, t, order), dp)
        call c_expand(order, self%kinds, self%constants, t, y, table, law, given, short_share, share_rest, coefficient, exists)
        if (exists == 0 .or. .not. self%has_series) coefficient(:, 1:order) = no_number
    end subroutine expand

end module spintop_body_with_effects
