!> Stages of a Runge-Kutta step for any rigid body with a fixed point, by body_stages.h.
!>
!> The angular velocity omega and the vertical Gamma in body axes start from the momentum and the quaternion, and have stages of
!> their own,
!>
!>     I omega' = (I omega) x omega + m g Gamma x r - damping omega,   Gamma' = Gamma x omega,
!>
!> for which the next stage waits half as long as for a vertical that is found from the quaternion in each stage. From a state
!> on all of these have the same solution, and at the end of the step omega and Gamma are dropped, so the order of a method is
!> the same.
module spintop_rigid_body_stages
    use, intrinsic :: iso_c_binding, only: c_double, c_int
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_aside, max_states, stages_t
    use spintop_kernel_types, only: stage_factors_t
    implicit none
    private
    public :: rigid_body_stages_t

    !> Stages of the state y = (q0, q1, q2, q3, Pi1, Pi2, Pi3).
    type, extends(stages_t) :: rigid_body_stages_t
        private
        type(stage_factors_t) :: of = stage_factors_t()
    contains
        procedure :: set_body
        procedure :: find
    end type rigid_body_stages_t

    interface
        pure subroutine c_find(from, to, body, y, h, stages, a, since, k, aside) bind(C, name='spintop_find_stages')
            import :: c_double, c_int, stage_factors_t
            integer(c_int), value :: from, to, stages
            type(stage_factors_t), intent(in) :: body
            real(c_double), value :: h
            real(c_double), intent(in) :: y(*), a(*)
            integer(c_int), intent(in) :: since(*)
            real(c_double), intent(inout) :: k(*), aside(*)
        end subroutine c_find
    end interface

contains

    !> Constants of the body.
    pure subroutine set_body(self, body)
        class(rigid_body_stages_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp) :: moment(3)
        moment = body%weight_moment()
        associate (of => self%of, i => body%inertia)
            of%inertia(:3) = i
            of%mobility(:3) = 1 / i
            of%coupling(:3) = (i([2, 3, 1]) - i([3, 1, 2])) / i
            of%decay(:3) = body%damping / i
            of%pull(:3) = moment([3, 1, 2]) / i
            of%swing(:3) = moment([2, 3, 1]) / i
        end associate
    end subroutine set_body

    !> Stages `from` to `to` of a step. Aside are the changes of q, omega and Gamma over the step at the slopes.
    pure subroutine find(self, from, to, t, y, h, stages, a, since, c, k, aside)
        class(rigid_body_stages_t), intent(in) :: self
        integer, intent(in) :: from, to !! first and last stage; there is at least one before
        real(dp), intent(in) :: t, y(max_states), h !! time and state at the beginning of the step, and its size, s
        integer, intent(in) :: stages !! their number in the table of the method
        real(dp), intent(in) :: a(stages, stages) !! column i contains the weights of the stages before stage i
        integer, intent(in) :: since(stages) !! stage i depends on the first one and on those from `since(i)` on
        real(dp), intent(in) :: c(stages) !! times of the stages in the step, over its size
        real(dp), intent(inout) :: k(max_states, stages) !! slopes: column i is that of stage i
        real(dp), intent(inout) :: aside(max_aside, stages) !! column i is what stage i leaves aside
        call c_find(from - 1, to - 1, self%of, y, h, stages, a, since, k, aside)
    end subroutine find

end module spintop_rigid_body_stages
