!> Stages of a Runge-Kutta step for any rigid body with a fixed point, by body_stages.c.
!>
!> Within a step the quaternion has the norm |q| = N of its beginning, as in the motion. The equations are therefore
!>
!>     q' = q (0, omega)/2,   Pi' = Pi x omega + m g Gamma x r - damping omega,
!>     Gamma = 2/N^2 (q1 q3 - q0 q2, q2 q3 + q0 q1, q0^2 + q3^2 - N^2/2),
!>
!> without a quotient in the stages. On the way from a state they have the same solution as those of `rigid_body_t`, so
!> the order of a method is the same.
module spintop_rigid_body_stages
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_states, stages_t
    use spintop_euler_poisson, only: momentum_coupling
    use spintop_motion, only: motion_t
    implicit none
    private
    public :: rigid_body_stages_t

    !> Stages of the state y = (q0, q1, q2, q3, Pi1, Pi2, Pi3).
    type, extends(stages_t) :: rigid_body_stages_t
        private
        !> Constants of body_stages.c: 1/I, `momentum_coupling`, the gravitational torque, damping/I.
        real(dp) :: of(3, 4) = 0
    contains
        procedure :: set
        procedure :: find
    end type rigid_body_stages_t

    interface
        pure subroutine c_find(from, to, body, y, h, a, stride, k) bind(C, name='spintop_find_stages')
            import :: c_double, c_int
            integer(c_int), value :: from, to, stride
            real(c_double), value :: h
            real(c_double), intent(in) :: body(*), y(*), a(*)
            real(c_double), intent(inout) :: k(*)
        end subroutine c_find
    end interface

contains

    !> Constants of the body; the start has no say.
    pure subroutine set(self, body, start)
        class(rigid_body_stages_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        associate (unused => start)
        end associate
        self%of(:, 1) = 1 / body%inertia
        self%of(:, 2) = momentum_coupling(body)
        self%of(:, 3) = body%weight_moment()
        self%of(:, 4) = body%damping / body%inertia
    end subroutine set

    !> Stages `from` to `to` of a step.
    pure subroutine find(self, from, to, t, y, h, a, c, k)
        class(rigid_body_stages_t), intent(in) :: self
        integer, intent(in) :: from, to !! first and last stage; there is at least one before
        real(dp), intent(in) :: t, y(max_states), h !! time and state at the beginning of the step, and its size, s
        real(dp), contiguous, intent(in) :: a(:, :) !! column i contains the weights of the stages before stage i
        real(dp), contiguous, intent(in) :: c(:) !! times of the stages in the step, over its size
        real(dp), contiguous, intent(inout) :: k(:, :) !! slopes: column i is that of stage i
        associate (unused => t, also_unused => c)
        end associate
        call c_find(from - 1, to - 1, self%of, y, h, a, size(a, 1), k)
    end subroutine find

end module spintop_rigid_body_stages
