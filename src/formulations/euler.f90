!> Euler's equations in five variables (Provatidis 2012, Eqs 35-40).
module spintop_euler
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants, max_states
    use spintop_symmetric_top, only: symmetric_top_t, at_pole
    use spintop_status, only: status_ok, status_pole
    implicit none
    private
    public :: euler_t

    !> State y = (phi, phi', theta, theta', psi); omega3 is constant.
    type, extends(formulation_t) :: euler_t
        private
        type(symmetric_top_t) :: top = symmetric_top_t()
    contains
        procedure, nopass :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: invariants
    end type euler_t

contains

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('euler', &
            "Euler's equations, (phi, phi', theta, theta', psi) by a 2x2 system (Eqs 35-40)", 5, &
            invariants=2)
    end function describe

    !> Constants of the motion and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(euler_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        self%body = body
        call self%top%set(body, start)
        y = 0
        y(1:5) = [start%angle(1), start%rate(1), start%angle(2), start%rate(2), start%angle(3)]
        scales = motion_scales(body, start)
        self%scale(1:5) = [1.0_dp, scales%rate, 1.0_dp, scales%rate, 1.0_dp]
        self%cyclic([1, 5]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare

    !> Solves the first two of Euler's equations for phi'' and theta'' (Eqs 36-40).
    pure subroutine derivative(self, t, y, dy, status)
        class(euler_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        real(dp) :: s3, c3, s5, c5, psi_rate, mgl, a(2, 2), b(2), determinant

        dy = 0
        status = status_pole
        if (at_pole(y(3))) return
        s3 = sin(y(3))
        c3 = cos(y(3))
        s5 = sin(y(5))
        c5 = cos(y(5))
        mgl = self%body%mgl()
        psi_rate = self%top%omega3 - y(2) * c3
        ! Divided by I1 and by I2: products of moments of inertia might underflow.
        associate (i1 => self%body%inertia(1), i2 => self%body%inertia(2), &
                   i3 => self%body%inertia(3), w3 => self%top%omega3)
            a(1, :) = [s5 * s3, c5]
            a(2, :) = [c5 * s3, -s5]
            b(1) = mgl / i1 * s3 * c5 &
                   - (c5 * s3 * y(2) * psi_rate + s5 * c3 * y(2) * y(4) - s5 * y(4) * psi_rate) &
                   - w3 * ((i3 - i2) / i1) * (c5 * s3 * y(2) - s5 * y(4))
            b(2) = -mgl / i2 * s3 * s5 &
                   - (c5 * c3 * y(2) * y(4) - s5 * s3 * y(2) * psi_rate - c5 * y(4) * psi_rate) &
                   + w3 * ((i3 - i1) / i2) * (s5 * s3 * y(2) + c5 * y(4))
        end associate
        determinant = a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)
        dy(1) = y(2)
        dy(2) = (b(1) * a(2, 2) - b(2) * a(1, 2)) / determinant
        dy(3) = y(4)
        dy(4) = (a(1, 1) * b(2) - a(2, 1) * b(1)) / determinant
        dy(5) = psi_rate
        status = status_ok
    end subroutine derivative

    !> The motion, with phi'' and theta'' of the 2x2 system.
    pure type(motion_t) function motion(self, t, y, near)
        class(euler_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        call self%derivative(t, y, dy, status)
        motion = self%top%complete(t, [y(1), y(3), y(5)], [y(2), y(4), dy(5)], dy(2), dy(4))
    end function motion

    !> Twice the energy over I1, and the momentum about the vertical over I1, without the part of the spin.
    pure subroutine invariants(self, y, values)
        class(euler_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        values = 0
        values(1) = y(4)**2 + (sin(y(3)) * y(2))**2 + self%top%beta * cos(y(3))
        values(2) = y(2) * sin(y(3))**2 + self%top%a * cos(y(3))
    end subroutine invariants

end module spintop_euler
