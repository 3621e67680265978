!> Stages of a Runge-Kutta step for a body with effects that are analytic, by effects_stages.h.
!>
!> Within a step the quaternion has the norm |q| = N of its beginning, as in `spintop_rigid_body_stages`. With U = P - h the
!> equations of `spintop_loads` are
!>
!>     P' = U x w_a + h x w_a + m (g G + a) x r - d w - k |w|^(p - 1) w + c |v| v x r + M_b + R^T M_s,   v = w x r,
!>
!> and a in space axes is a sum of cos(W t) and sin(W t), each times a constant vector.
module spintop_effects_stages
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_aside, max_states, stages_t
    use spintop_compare, only: is_zero
    use spintop_effects, only: effects_t, kernel_effects
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_kernel_types, only: stage_effects_t
    use spintop_kinds, only: dp
    use spintop_vectors, only: cross
    implicit none
    private
    public :: effects_stages_t

    !> Stages of the state y = (q0, q1, q2, q3, P1, P2, P3).
    type, extends(stages_t) :: effects_stages_t
        private
        type(stage_effects_t) :: of
    contains
        procedure :: set_body
        procedure :: find
        procedure :: slope
    end type effects_stages_t

    interface
        pure subroutine c_find(from, to, effects, t, y, h, a, stride, c, k) bind(C, name='spintop_find_effects_stages')
            import :: c_double, c_int, stage_effects_t
            integer(c_int), value :: from, to, stride
            type(stage_effects_t), intent(in) :: effects
            real(c_double), value :: t, h
            real(c_double), intent(in) :: y(*), a(*), c(*)
            real(c_double), intent(inout) :: k(*)
        end subroutine c_find
    end interface

contains

    !> Constants of the body and its effects.
    pure subroutine set_body(self, body)
        class(effects_stages_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(effects_t) :: effects
        real(dp), dimension(3) :: even, odd

        if (allocated(body%effects)) effects = body%effects
        self%holds = effects%only(kernel_effects)
        self%of = stage_effects_t()
        associate (of => self%of, o => effects%frame_rate, rate => effects%vibration_rate)
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
    end subroutine set_body

    !> 1 if any value is not zero.
    pure integer(c_int) function flag(values)
        real(dp), intent(in) :: values(:)
        flag = merge(0, 1, all(is_zero(values)))
    end function flag

    !> Stages `from` to `to` of a step.
    pure subroutine find(self, from, to, t, y, h, stages, a, since, c, k, aside)
        class(effects_stages_t), intent(in) :: self
        integer, intent(in) :: from, to !! first and last stage; there is at least one before
        real(dp), intent(in) :: t, y(max_states), h !! time and state at the beginning of the step, and its size, s
        integer, intent(in) :: stages !! their number in the table of the method
        real(dp), intent(in) :: a(stages, stages) !! column i contains the weights of the stages before stage i
        integer, intent(in) :: since(stages) !! stage i depends on the first one and on those from `since(i)` on
        real(dp), intent(in) :: c(stages) !! times of the stages in the step, over its size
        real(dp), intent(inout) :: k(max_states, stages) !! slopes: column i is that of stage i
        real(dp), intent(inout) :: aside(max_aside, stages) !! not used: stages need nothing but the slopes
        call c_find(from - 1, to - 1, self%of, t, y, h, a, stages, c, k)
    end subroutine find

    !> The slope in a state, which is a first stage.
    pure subroutine slope(self, t, y, dy)
        class(effects_stages_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        real(dp), parameter :: none(1) = 0
        call c_find(0, 0, self%of, t, y, 0.0_dp, none, 1, none, dy)
    end subroutine slope

end module spintop_effects_stages
