!> What the formulations of any rigid body with a fixed point have in common, with effects and without: power series of the
!> motion in quadruple precision. motion_series.h has the equations. They take longer than a short run in double precision, so
!> nothing is kept.
module spintop_body_quadruple
    use, intrinsic :: iso_c_binding, only: c_double, c_int, c_loc, c_ptr
    use spintop_body_numbers, only: kinds_of, look_up, numbers_of
    use spintop_effects, only: effects_t, series_effects
    use spintop_formulation, only: formulation_t, max_series_order, max_states
    use spintop_kernel_types, only: body_numbers_t, motion_kinds_t
    use spintop_kinds, only: dp, no_number, qp
    use spintop_loads, only: torque_series
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: quaternion_body_t, quadruple_attitude, quadruple_omega, vector

    !> A formulation whose state begins with the attitude quaternion and the momentum in body axes.
    type, abstract, extends(formulation_t) :: quaternion_body_t
    contains
        procedure :: quadruple_start
        procedure :: expand_quadruple
    end type quaternion_body_t

    interface
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

    !> The quaternion of a start.
    pure function quadruple_attitude(start) result(q)
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(qp) :: q(4), theta, plus, minus
        q = start%quaternion
        if (start%gives_quaternion .or. .not. start%is_given) return
        theta = real(start%angle(2), qp) / 2
        plus = (real(start%angle(1), qp) + start%angle(3)) / 2
        minus = (real(start%angle(1), qp) - start%angle(3)) / 2
        q = [cos(theta) * cos(plus), sin(theta) * cos(minus), sin(theta) * sin(minus), cos(theta) * sin(plus)]
        if (dot_product(q, start%quaternion) < 0) q = -q
    end function quadruple_attitude

    !> Its angular velocity in body axes, rad/s: the rate of phi about the vertical, that of theta about the line of nodes,
    !> that of psi about body z.
    pure function quadruple_omega(start) result(omega)
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(qp) :: omega(3), q(4), vertical(3), node(2), psi
        omega = start%omega
        if (start%gives_omega .or. .not. start%is_given) return
        q = quadruple_attitude(start)
        vertical = [2 * (q(2) * q(4) - q(1) * q(3)), 2 * (q(3) * q(4) + q(1) * q(2)), &
                    (q(1)**2 + q(4)**2) - (q(2)**2 + q(3)**2)] / sum(q**2)
        psi = start%angle(3)
        node = [cos(psi), -sin(psi)]
        if (start%gives_quaternion .and. any(abs(vertical(1:2)) > 0)) then
            node = [vertical(2), -vertical(1)] / norm2(vertical(1:2))
        end if
        omega(1:2) = start%rate(1) * vertical(1:2) + start%rate(2) * node
        if (.not. start%gives_omega3) omega(3) = start%rate(1) * vertical(3) + start%rate(3)
    end function quadruple_omega

    !> The state at the start.
    pure function quadruple_start(self) result(y)
        class(quaternion_body_t), intent(in) :: self
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

    !> Vector product.
    pure function vector(a, b) result(c)
        real(qp), intent(in) :: a(3), b(3) !! the factors
        real(qp) :: c(3)
        c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
    end function vector

    !> Taylor coefficients of the motion.
    pure subroutine expand_quadruple(self, t, y, order, coefficient)
        class(quaternion_body_t), intent(in) :: self
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
            call c_expand_quadruple(order, kinds_of(body), numbers_of(body), t, c_loc(state), table, law, c_loc(given), &
                                    c_loc(c), exists)
            coefficient(:, 0:order) = c
            undefined = no_number
            if (allocated(body%effects)) exists = merge(exists, 0_c_int, body%effects%only(series_effects))
            if (exists == 0) coefficient(:, 1:order) = undefined
        end associate
    end subroutine expand_quadruple

end module spintop_body_quadruple
