!> A rigid body without weight that torques in body axes drive, each a cosine of time: equations
!> y' = f(t, y), with the group action of `rigid_body` and a Taylor series of their own.
module driven_body
    use spintop_body, only: body_t
    use spintop_formulation, only: formulation_info_t, formulation_t, max_series_order, max_states, structure_group, &
        structure_quadruple, structure_series
    use spintop_kinds, only: dp, qp
    use spintop_motion, only: motion_t
    use spintop_rigid_body, only: rigid_body_t
    implicit none
    private
    public :: driven_body_t, create_driven_body

    !> The torques, N m: amplitude cos(rate t + phase).
    type :: drive_t
        real(dp) :: amplitude(3) = 0, rate = 1, phase(3) = 0
    contains
        procedure :: torque
    end type drive_t

    !> State y = (q0, q1, q2, q3, Pi1, Pi2, Pi3).
    type, extends(rigid_body_t) :: driven_body_t
        type(drive_t) :: drive
    contains
        procedure :: info
        procedure :: prepare
        procedure :: derivative
        procedure :: expand
        procedure :: quadruple_start
        procedure :: expand_quadruple
    end type driven_body_t

contains

    !> A driven body that has what `rigid_body` has but drift and kick.
    subroutine create_driven_body(amplitude, rate, phase, formulation)
        real(dp), intent(in) :: amplitude(3), rate, phase(3)
        class(formulation_t), allocatable, intent(out) :: formulation
        allocate (formulation, source=driven_body_t(drive=drive_t(amplitude, rate, phase)))
    end subroutine create_driven_body

    !> Name and properties.
    pure function info(self)
        class(driven_body_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('driven_body', 'a body under torques of time', 7, symmetric_only=.false., &
                                  singular_at_poles=.false., quaternion=1)
        info%offers([structure_group, structure_series, structure_quadruple]) = .true.
    end function info

    pure subroutine prepare(self, body, start, y, status)
        class(driven_body_t), intent(inout) :: self
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: start
        real(dp), intent(out) :: y(max_states)
        integer, intent(out) :: status
        call self%rigid_body_t%prepare(body, start, y, status)
        self%depends_on_time = .true.
        self%has_stages = .false.
    end subroutine prepare

    pure subroutine derivative(self, t, y, dy, status)
        class(driven_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        real(dp), intent(out) :: dy(max_states)
        integer, intent(out) :: status
        call self%rigid_body_t%derivative(t, y, dy, status)
        dy(5:7) = dy(5:7) + real(self%drive%torque(t, 0), dp)
    end subroutine derivative

    !> Taylor coefficient k of the torques, N m/s^k.
    pure function torque(self, t, k)
        class(drive_t), intent(in) :: self
        real(dp), intent(in) :: t
        integer, intent(in) :: k
        real(qp) :: torque(3), rate
        real(qp), parameter :: quarter = 1.5707963267948966192313216916397514421_qp
        integer :: j
        rate = self%rate
        torque = self%amplitude * cos(rate * t + self%phase + k * quarter)
        do j = 1, k
            torque = torque * rate / j
        end do
    end function torque

    pure function quadruple_start(self) result(y)
        class(driven_body_t), intent(in) :: self
        real(qp) :: y(max_states)
        y = 0
    end function quadruple_start

    pure subroutine expand_quadruple(self, t, y, order, coefficient)
        class(driven_body_t), intent(in) :: self
        real(dp), intent(in) :: t
        real(qp), intent(in) :: y(max_states)
        integer, intent(in) :: order
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order)
        real(qp) :: w(3, 0:max_series_order), rate(7)
        integer :: j, k
        coefficient = 0
        coefficient(:, 0) = y
        associate (c => coefficient)
            do k = 0, order - 1
                w(:, k) = c(5:7, k) / self%body%inertia
                rate = 0
                rate(5:7) = self%drive%torque(t, k)
                do j = 0, k
                    associate (q => c(1:4, k - j) / 2, p => c(5:7, k - j), v => w(:, j))
                        rate(1:4) = rate(1:4) + [-q(2) * v(1) - q(3) * v(2) - q(4) * v(3), &
                            q(1) * v(1) + q(3) * v(3) - q(4) * v(2), q(1) * v(2) + q(4) * v(1) - q(2) * v(3), &
                            q(1) * v(3) + q(2) * v(2) - q(3) * v(1)]
                        rate(5:7) = rate(5:7) + [p(2) * v(3) - p(3) * v(2), p(3) * v(1) - p(1) * v(3), &
                                                 p(1) * v(2) - p(2) * v(1)]
                    end associate
                end do
                c(1:7, k + 1) = rate / (k + 1)
            end do
        end associate
    end subroutine expand_quadruple

    pure subroutine expand(self, t, y, order, coefficient)
        class(driven_body_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        integer, intent(in) :: order
        real(dp), intent(out) :: coefficient(max_states, 0:max_series_order)
        real(qp) :: fine(max_states, 0:max_series_order)
        call self%expand_quadruple(t, real(y, qp), order, fine)
        coefficient = real(fine, dp)
    end subroutine expand

end module driven_body
