!> Any rigid body with a fixed point under effects: the equations of `rigid_body` with the momentum P = I w_a + h, which
!> contains that of the frame and of the rotor, and all moments of `spintop_loads`.
!>
!> A type of its own, so that a body without effects pays nothing for them: by these equations a run of ode45, dop853 or
!> Taylor takes two to three times as long without effects as by those of `rigid_body`. It has no invariants, as effects do
!> work and turn the momentum, and no bound of its angular velocity, which is not that of the momentum.
module spintop_body_with_effects
    use spintop_attitude, only: conjugate_quaternion, quaternion_product
    use spintop_body, only: body_t
    use spintop_capabilities, only: max_states
    use spintop_effects, only: effects_t, timeless_effects
    use spintop_effects_action, only: effects_action_t
    use spintop_effects_series, only: body_quadruple_t, effects_series_t
    use spintop_effects_stages, only: effects_stages_t
    use spintop_formulation, only: formulation_info_t, formulation_t, structure_group
    use spintop_kinds, only: dp
    use spintop_loads, only: acceleration, find_kinematics, find_loads, loads_t, total_momentum
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_motion_scales, only: motion_scales_t, motion_scales
    use spintop_rigid_body, only: bracket_of_turns, move_by_turns
    use spintop_status, only: status_ok
    implicit none
    private
    public :: body_with_effects_t

    !> State y = (q0, q1, q2, q3, P1, P2, P3).
    type, extends(formulation_t) :: body_with_effects_t
        type(effects_t) :: effects
    contains
        procedure :: describe
        procedure :: prepare
        procedure :: derivative
        procedure :: motion
        procedure :: motion_without_angles
        procedure :: find_turning
        procedure :: velocity
        procedure, nopass :: bracket => bracket_of_turns
        procedure, nopass :: move => move_by_turns
    end type body_with_effects_t

    interface body_with_effects_t
        module procedure new_body
    end interface body_with_effects_t

contains

    !> The formulation with all that it offers.
    function new_body() result(new)
        type(body_with_effects_t) :: new
        allocate (effects_stages_t :: new%stages)
        allocate (effects_series_t :: new%series)
        allocate (body_quadruple_t :: new%quadruple_series)
        allocate (effects_action_t :: new%action)
    end function new_body

    !> Name and properties: a variant of `rigid_body`.
    pure function describe(self) result(info)
        class(body_with_effects_t), intent(in) :: self
        type(formulation_info_t) :: info
        info = formulation_info_t('rigid_body', &
            'quaternion and body momentum, for any body with effects; no pole is singular', 7, &
            symmetric_only=.false., singular_at_poles=.false., quaternion=1, takes_effects=.true., &
            runs_in_lanes=.true.)
        info%offers(structure_group) = .true.
    end function describe

    !> Initial state.
    pure subroutine prepare(self, body, start, y, status)
        class(body_with_effects_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
        real(dp), intent(out) :: y(max_states) !! initial state
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(motion_scales_t) :: scales
        self%body = body
        self%effects = effects_t()
        if (allocated(body%effects)) self%effects = body%effects
        self%depends_on_time = .not. self%effects%only(timeless_effects)
        call self%set_capabilities(body, start)
        y = 0
        y(1:4) = start%quaternion
        y(5:7) = total_momentum(body, 0.0_dp, start%quaternion, start%omega)
        scales = motion_scales(body, start)
        self%scale(1:4) = 0.5_dp
        self%scale(5:7) = max(scales%momentum, norm2(y(5:7)))
        status = status_ok
    end subroutine prepare

    !> What acts in a state.
    pure subroutine loads_at(self, t, y, loads)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states)
        type(loads_t), intent(out) :: loads
        call find_loads(self%body, self%effects, t, y(1:4), y(5:7), loads)
    end subroutine loads_at

    !> q' = q (0, w)/2, and P' as in `spintop_loads`.
    pure subroutine derivative(self, t, y, dy, status)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
        integer, intent(out) :: status !! `status_ok`, or the reason of a failure (spintop_status)
        type(loads_t) :: loads
        status = status_ok
        if (self%stages%holds) then
            select type (stages => self%stages)
            type is (effects_stages_t)
                call stages%slope(t, y, dy)
                return
            end select
        end if
        call loads_at(self, t, y, loads)
        dy(1:4) = quaternion_product(y(1:4), [0.0_dp, loads%omega]) / 2
        dy(5:7) = loads%rate
        dy(8) = 0
    end subroutine derivative

    !> The motion, with the angular acceleration of the derivative.
    pure type(motion_t) function motion(self, t, y, near)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        type(loads_t) :: loads
        call loads_at(self, t, y, loads)
        motion = motion_from_quaternion(t, y(1:4) / norm2(y(1:4)), loads%omega, near)
        motion%norm_error = norm2(y(1:4)) - 1
        motion%omega_rate = acceleration(self%body, loads)
    end function motion

    !> The same without angles and their rates.
    pure function motion_without_angles(self, t, y) result(motion)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(motion_t) :: motion
        type(loads_t) :: loads
        call loads_at(self, t, y, loads)
        motion%t = t
        motion%quaternion = y(1:4) / norm2(y(1:4))
        motion%norm_error = norm2(y(1:4)) - 1
        motion%omega = loads%omega
        motion%omega_rate = acceleration(self%body, loads)
    end function motion_without_angles

    !> The angular velocity of the attitude in the state, and its rate.
    pure subroutine find_turning(self, t, y, omega, rate)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in body axes, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        type(loads_t) :: loads
        if (present(rate)) then
            call loads_at(self, t, y, loads)
            rate = acceleration(self%body, loads)
        else
            call find_kinematics(self%body, self%effects, t, y(1:4), y(5:7), loads)
        end if
        omega = loads%omega
    end subroutine find_turning

    !> The angular velocity, from the rate of the attitude, and the rate of the momentum.
    pure subroutine velocity(self, y, dy, xi)
        class(body_with_effects_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), dy(max_states) !! the state and its rate
        real(dp), intent(out) :: xi(max_states) !! the velocity
        real(dp) :: spin(4)
        spin = 2 * quaternion_product(conjugate_quaternion(y(1:4)), dy(1:4)) / sum(y(1:4)**2)
        xi(1:3) = spin(2:4)
        xi(4:6) = dy(5:7)
        xi(7:8) = 0
    end subroutine velocity

end module spintop_body_with_effects
