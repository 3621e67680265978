!> Lagrange's equations in four variables (Provatidis 2012, Eqs 41-45).
module spintop_lagrange
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_formulation, only: formulation_t, formulation_info_t, max_invariants, max_states
    use spintop_symmetric_top, only: symmetric_top_t, at_pole
    use spintop_status, only: status_ok, status_pole
    implicit none
    private
    public :: lagrange_t

    !> State y = (phi, theta, theta', psi); both momenta are constants.
    type, extends(formulation_t) :: lagrange_t
        type(symmetric_top_t) :: top = symmetric_top_t()
    contains
        procedure, nopass :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: invariants
    end type lagrange_t

contains

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('lagrange', &
            "Lagrange's equations, (phi, theta, theta', psi) with both momenta constant (Eqs 41-45)", &
            4, invariants=1)
    end function describe

    !> Constants of the motion and initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(lagrange_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        self%body = body
        call self%top%set(body, start)
        call self%set_capabilities(body, start)
        y = 0
        y(1:4) = [start%angle(1), start%angle(2), start%rate(2), start%angle(3)]
        scales = motion_scales(body, start)
        self%scale(3) = scales%rate
        self%cyclic([1, 4]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare

    !> Eqs 41, 42 and 44.
    pure subroutine derivative(self, t, y, dy, status)
        class(lagrange_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        dy = 0
        status = status_pole
        if (at_pole(y(2))) return
        dy(1) = self%top%precession_rate(y(2))
        dy(2) = y(3)
        dy(3) = self%top%theta_acceleration(y(2), dy(1))
        dy(4) = self%top%omega3 - dy(1) * cos(y(2))
        status = status_ok
    end subroutine derivative

    !> The motion, with theta'' of Eq 42 and phi'' from Eq 41.
    pure type(motion_t) function motion(self, t, y, near)
        class(lagrange_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        call self%derivative(t, y, dy, status)
        motion = self%top%complete(t, [y(1), y(2), y(4)], [dy(1), dy(2), dy(4)], &
                                   self%top%phi_acceleration(y(2), dy(1), dy(2)), dy(3))
    end function motion

    !> Twice the energy over I1, without the part of the spin.
    pure subroutine invariants(self, y, values)
        class(lagrange_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        values = 0
        values(1) = y(3)**2 + (sin(y(2)) * self%top%precession_rate(y(2)))**2 + self%top%beta * cos(y(2))
    end subroutine invariants

end module spintop_lagrange
