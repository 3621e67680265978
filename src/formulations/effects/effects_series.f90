!> Power series of the motion of any rigid body with a fixed point under effects, in double and in quadruple precision:
!> motion_series.h has the equations. Here is what they take of the effects.
module spintop_effects_series
    use, intrinsic :: iso_c_binding, only: c_double, c_int, c_loc, c_ptr
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_series_order, max_states, quadruple_series_t, series_t
    use spintop_compare, only: is_zero
    use spintop_effects, only: effects_t
    use spintop_kernel_types, only: body_numbers_t, motion_kinds_t, one_constants
    use spintop_kinds, only: dp, no_number, qp
    use spintop_loads, only: find_kinematics, loads_t
    use spintop_motion, only: motion_t
    use spintop_quadruple_start, only: quadruple_attitude, quadruple_omega
    use spintop_series_shares, only: share_rest, short_share
    implicit none
    private
    public :: effects_series_t, body_quadruple_t, kinds_of, numbers_of, has_drag_force, has_drag_moment

    !> The Taylor series of the motion.
    type, extends(series_t) :: effects_series_t
        private
        type(body_t) :: body
        type(motion_kinds_t) :: kinds
        real(dp) :: constants(one_constants) = 0
    contains
        procedure :: set
        procedure :: expand
    end type effects_series_t

    !> The same in quadruple precision, also of bodies without effects.
    type, extends(quadruple_series_t) :: body_quadruple_t
        private
        type(body_t) :: body
        type(motion_t) :: start
    contains
        procedure :: set => set_quadruple
        procedure :: y_start
        procedure :: expand => expand_quadruple
    end type body_quadruple_t

    interface
        pure subroutine c_set(body, constants) bind(C, name='spintop_set_one')
            import :: body_numbers_t, c_double
            type(body_numbers_t), intent(in) :: body
            real(c_double), intent(inout) :: constants(*)
        end subroutine c_set

        pure subroutine c_expand(order, kinds, constants, t, state, table, law, share, share_rest, c, exists) &
            bind(C, name='spintop_expand_effects')
            import :: c_double, c_int, motion_kinds_t
            integer(c_int), value :: order
            type(motion_kinds_t), intent(in) :: kinds
            real(c_double), value :: t
            real(c_double), dimension(*), intent(in) :: constants, state, table, law, share, share_rest
            real(c_double), intent(inout) :: c(*)
            integer(c_int), intent(out) :: exists
        end subroutine c_expand

        ! Numbers of quadruple precision have no type that Fortran and C are sure to share.
        pure subroutine c_expand_quadruple(order, kinds, body, t, state, table, law, c, exists) &
            bind(C, name='spintop_expand_quadruple')
            import :: body_numbers_t, c_double, c_int, c_ptr, motion_kinds_t
            integer(c_int), value :: order
            type(motion_kinds_t), intent(in) :: kinds
            type(body_numbers_t), intent(in) :: body
            type(c_ptr), value :: state, c
            real(c_double), value :: t
            real(c_double), dimension(*), intent(in) :: table, law
            integer(c_int), intent(out) :: exists
        end subroutine c_expand_quadruple
    end interface

contains

    !> Which parts of the equations a body has. Bodies are in lanes together only if they have the same, so that the sums of a
    !> body do not depend on its neighbours.
    pure type(motion_kinds_t) function kinds_of(body) result(kinds)
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            kinds%rotor = merge(0, 1, all(is_zero([effects%rotor_momentum, effects%rotor_torque, effects%torque_body])))
            kinds%frame = direction_of(effects%frame_rate)
            kinds%torque = direction_of(effects%torque_space)
            kinds%push = direction_of(effects%vibration_amplitude)
            ! A frame that does not turn about the vertical accelerates a pivot across it.
            if (kinds%push > 0) kinds%push = max(kinds%push, kinds%frame)
            kinds%drags = merge(1, 0, has_drag_moment(effects)) + merge(2, 0, has_drag_force(body))
            kinds%harmonic = merge(1, 0, allocated(effects%harmonic_space)) + merge(2, 0, allocated(effects%harmonic_body))
            if (allocated(effects%table)) kinds%table = merge(1, 2, effects%table_in_space)
            if (effects%has_friction()) kinds%friction = merge(2, 1, effects%friction_arm > 0)
            kinds%law = merge(1, 0, allocated(effects%friction_table))
        end associate
    end function kinds_of

    !> 1 if a vector in space is along the vertical, 2 in another direction, 0 if it is zero.
    pure integer(c_int) function direction_of(vector)
        real(dp), intent(in) :: vector(3)
        direction_of = merge(0, 1, is_zero(vector(3)))
        if (.not. all(is_zero(vector(:2)))) direction_of = 2
    end function direction_of

    !> Whether the air has a moment that is not linear in the angular velocity.
    pure logical function has_drag_moment(effects)
        type(effects_t), intent(in) :: effects !! effects on a body
        has_drag_moment = any(effects%drag_moment > 0) .and. .not. is_zero(effects%drag_exponent - 1)
    end function has_drag_moment

    !> Whether the air acts on the centre of mass, which is not at the pivot.
    pure logical function has_drag_force(body)
        type(body_t), intent(in) :: body !! a body with effects
        has_drag_force = body%effects%drag_force > 0 .and. any(abs(body%centre_of_mass) > 0)
    end function has_drag_force

    !> The numbers of a body and of what acts on it.
    pure type(body_numbers_t) function numbers_of(body) result(of)
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        of%inertia = body%inertia
        of%centre = body%centre_of_mass
        of%damping = body%damping
        of%mass = body%mass
        of%gravity = body%gravity
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            of%axis = effects%friction_axis
            of%friction_torque = effects%friction_torque
            of%friction_arm = effects%friction_arm
            of%smoothing = effects%friction_smoothing
            of%drag_moment = effects%drag_moment
            of%drag_exponent = effects%drag_exponent
            if (has_drag_force(body)) of%drag_force = effects%drag_force
            of%rotor = effects%rotor_momentum
            of%drive = effects%rotor_torque
            of%torque_body = effects%torque_body
            of%torque_space = effects%torque_space
            of%frame = effects%frame_rate
            of%earth_rate = effects%earth_rate
            of%latitude = effects%latitude
            of%amplitude(:, 1) = effects%vibration_amplitude
            of%phase(:, 1) = effects%vibration_phase
            of%rate(1) = effects%vibration_rate
            if (allocated(effects%harmonic_space)) then
                of%amplitude(:, 2) = effects%harmonic_space%amplitude
                of%phase(:, 2) = effects%harmonic_space%phase
                of%rate(2) = effects%harmonic_space%rate
            end if
            if (allocated(effects%harmonic_body)) then
                of%amplitude(:, 3) = effects%harmonic_body%amplitude
                of%phase(:, 3) = effects%harmonic_body%phase
                of%rate(3) = effects%harmonic_body%rate
            end if
        end associate
    end function numbers_of

    !> What tables say at a time in a state: terms of the torque over time, and of the laws of friction about the axis towards
    !> smaller and larger angular velocities, after the one that these are about.
    pure subroutine look_up(body, t, y, table, law)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: t, y(max_states)
        real(dp), intent(out) :: table(3, 0:3), law(5, 2)
        type(loads_t) :: loads
        real(dp) :: slack
        integer :: side, i
        table = 0
        law = 0
        if (.not. allocated(body%effects)) return
        associate (effects => body%effects)
            if (allocated(effects%table)) table = effects%table%expansion(t)
            if (.not. allocated(effects%friction_table)) return
            call find_kinematics(body, effects, t, y(1:4), y(5:7), loads)
            slack = effects%slack_of_spin(loads%omega)
            do side = 1, 2
                i = effects%friction_table%interval_towards(dot_product(effects%friction_axis, loads%omega), &
                                                            real(2 * side - 3, dp), slack)
                law(:, side) = [effects%friction_table%knots(i), effects%friction_table%coefficient(:, 3, i)]
            end do
        end associate
    end subroutine look_up

    !> Constants of the series.
    pure subroutine set(self, body, start)
        class(effects_series_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%body = body
        self%kinds = kinds_of(body)
        self%constants = 0
        call c_set(numbers_of(body), self%constants)
    end subroutine set

    !> Taylor coefficients of the motion. Where there is no series, as for dry friction at rest, they are NaN.
    pure subroutine expand(self, t, y, order, coefficient)
        class(effects_series_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        integer, intent(in) :: order !! order of the highest coefficient
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        real(dp) :: table(3, 0:3), law(5, 2)
        integer(c_int) :: exists
        if (self%kinds%table + self%kinds%law > 0) call look_up(self%body, t, y, table, law)
        call c_expand(order, self%kinds, self%constants, t, y, table, law, short_share, share_rest, coefficient, exists)
        if (exists == 0) coefficient(:, 1:order) = no_number
    end subroutine expand

    !> Keeps body and start.
    pure subroutine set_quadruple(self, body, start)
        class(body_quadruple_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point, with its effects
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        self%body = body
        self%start = start
    end subroutine set_quadruple

    !> The state at the start.
    pure function y_start(self)
        class(body_quadruple_t), intent(in) :: self
        real(qp) :: y_start(max_states), q(4), omega(3), o(3), rotor(3)
        q = quadruple_attitude(self%start)
        omega = quadruple_omega(self%start)
        rotor = 0
        if (allocated(self%body%effects)) then
            o = frame_of(self%body%effects)
            rotor = self%body%effects%rotor_momentum
            if (any(abs(o) > 0)) omega = omega + 2 * (q(1)**2 * o - q(1) * vector(q(2:4), o) &
                + q(2:4) * dot_product(q(2:4), o)) / sum(q**2) - o
        end if
        y_start = [q, self%body%inertia * omega + rotor, 0.0_qp]
    end function y_start

    !> The rotation of the frame; its rate itself was rounded.
    pure function frame_of(effects) result(rate)
        type(effects_t), intent(in) :: effects
        real(qp) :: rate(3)
        rate = effects%frame_rate
        if (abs(effects%earth_rate) > 0) rate(2:3) = effects%earth_rate * [cos(real(effects%latitude, qp)), &
                                                                           sin(real(effects%latitude, qp))]
    end function frame_of

    !> Vector product.
    pure function vector(a, b) result(c)
        real(qp), intent(in) :: a(3), b(3)
        real(qp) :: c(3)
        c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
    end function vector

    !> Taylor coefficients of the motion.
    pure subroutine expand_quadruple(self, t, y, order, coefficient)
        class(body_quadruple_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(qp), intent(in) :: y(max_states) !! state
        integer, intent(in) :: order !! order of the highest coefficient
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order) !! column k is the coefficient of h^k
        real(qp), target :: state(max_states), c(max_states, 0:order)
        real(dp) :: table(3, 0:3), law(5, 2), undefined
        integer(c_int) :: exists
        call look_up(self%body, t, real(y, dp), table, law)
        state = y
        call c_expand_quadruple(order, kinds_of(self%body), numbers_of(self%body), t, c_loc(state), table, law, c_loc(c), exists)
        coefficient(:, 0:order) = c
        undefined = no_number
        if (exists == 0) coefficient(:, 1:order) = undefined
    end subroutine expand_quadruple

end module spintop_effects_series
