!> The energy-rate equations (scenario 1 of the paper): theta' from the energy, Eq 46.
!>
!> They hold between two turning points of theta. At a turning point theta' = 0 is an equilibrium of the
!> equation, though not of the top. A motion leaves a start there by a Taylor series, and ends with a status
!> at the next one.
module spintop_energy_rate
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_motion, only: motion_t
    use spintop_formulation, only: formulation_t, formulation_info_t, max_states
    use spintop_symmetric_top, only: at_pole
    use spintop_status, only: status_ok, status_pole, status_outside
    implicit none
    private
    public :: energy_rate_t

    !> State y = (phi, theta, psi).
    type, extends(formulation_t) :: energy_rate_t
    contains
        procedure, nopass :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
    end type energy_rate_t

    interface energy_rate_t
        module procedure new_energy_rate
    end interface energy_rate_t

contains

    !> The formulation with its ends.
    function new_energy_rate() result(new)
        type(energy_rate_t) :: new
        allocate (new%ends)
    end function new_energy_rate

    !> Name and properties.
    pure function describe() result(info)
        type(formulation_info_t) :: info
        info = formulation_info_t('energy_rate', &
            "(phi, theta, psi) with theta' from the energy, to the next turning point (Eq 46, scenario 1)", 3)
    end function describe

    !> Constants of the motion, the branch, and the initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(energy_rate_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        self%body = body
        call self%set_capabilities(body, start)
        y = 0
        y(1:3) = start%angle
        self%cyclic([1, 3]) = .true.
        status = merge(status_pole, status_ok, at_pole(start%angle(2)))
    end subroutine prepare

    !> The right-hand side.
    pure subroutine derivative(self, t, y, dy, status)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        call self%ends%rates(y, dy, status)
    end subroutine derivative

    !> The motion, with theta'' of Eq 42 (half the derivative of the radicand by theta).
    pure type(motion_t) function motion(self, t, y, near)
        class(energy_rate_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        real(dp) :: dy(max_states)
        integer :: status
        call self%ends%rates(y, dy, status)
        if (status == status_outside) dy = self%ends%at_turning_point(y)
        associate (top => self%ends%top)
            motion = top%complete(t, y(1:3), dy(1:3), top%phi_acceleration(y(2), dy(1), dy(2)), &
                                  top%theta_acceleration(y(2), dy(1)))
        end associate
    end function motion

end module spintop_energy_rate
