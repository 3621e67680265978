!> Effects on a body beside gravity and viscous damping: dry friction of the pivot, drag of the air, a moving pivot,
!> the rotation of the Earth, a rotor, given torques. Their values only; `spintop_loads` has their moments.
module spintop_effects
    use spintop_compare, only: is_finite, is_zero
    use spintop_kinds, only: dp, pi
    use spintop_torque_table, only: torque_table_t
    implicit none
    private
    public :: effects_t, harmonic_t, earth_rotation

    !> A vector over time, even cos(rate t) - odd sin(rate t): with a_i cos(f_i) and a_i sin(f_i) as components of `even` and
    !> `odd` its components are a_i cos(rate t + f_i).
    type :: harmonic_t
        real(dp) :: even(3) = 0, odd(3) = 0
        !> Angular frequency, rad/s.
        real(dp) :: rate = 1
    contains
        procedure :: at => harmonic_at
    end type harmonic_t

    !> The effects on a body. Body axes are the principal ones; an effect with zeros is none.
    type :: effects_t
        !> Dry moment of the pivot without load, N m.
        real(dp) :: friction_torque = 0
        !> Coefficient of friction times the radius of the pivot's ball, m: the dry moment per newton of load.
        real(dp) :: friction_arm = 0
        !> Angular velocity, rad/s, below which dry friction is smoothed; 0 is the exact law.
        real(dp) :: friction_smoothing = 0
        !> Friction about an axis of the body by the angular velocity about it, and that axis.
        type(torque_table_t), allocatable :: friction_table
        real(dp) :: friction_axis(3) = [0.0_dp, 0.0_dp, 1.0_dp]
        !> Coefficients k_i of the moment -k_i |w|^(p - 1) w_i of the air, N m s^p, and p.
        real(dp) :: drag_moment(3) = 0, drag_exponent = 2
        !> Coefficient c of the force -c |v| v on the centre of mass, kg/m.
        real(dp) :: drag_force = 0
        !> Motion of the pivot along space x, y, z: amplitude cos(rate t + phase), m, rad/s, rad.
        real(dp) :: vibration_amplitude(3) = 0, vibration_rate = 1, vibration_phase(3) = 0
        !> Angular velocity of the frame in space axes, rad/s: that of the Earth.
        real(dp) :: frame_rate(3) = 0
        !> Angular momentum of the rotor in body axes at the start, J s, and the torque that drives it, N m.
        real(dp) :: rotor_momentum(3) = 0, rotor_torque(3) = 0
        !> Constant torques in body and in space axes, N m.
        real(dp) :: torque_body(3) = 0, torque_space(3) = 0
        !> Harmonic torques in body and in space axes, N m; not allocated without amplitude.
        type(harmonic_t), allocatable :: harmonic_body, harmonic_space
        !> A torque over time, in body or in space axes.
        type(torque_table_t), allocatable :: table
        logical :: table_in_space = .false.
    contains
        procedure :: is_any
        procedure :: is_valid
        procedure :: is_dry
        procedure :: is_harmonic
        procedure :: has_cusps
        procedure :: has_friction
        procedure :: have_kernels
        procedure :: do_work
        procedure :: only_brake
        procedure :: depends_on_time
        procedure :: shifts_angles
        procedure :: friction_by_table
        procedure :: slack_of_spin
    end type effects_t

contains

    !> Whether there is any effect.
    pure logical function is_any(self)
        class(effects_t), intent(in) :: self
        is_any = self%has_friction() .or. allocated(self%friction_table) .or. self%depends_on_time() .or. self%drag_force > 0 &
            .or. .not. all(is_zero([self%drag_moment, self%frame_rate, self%rotor_momentum, self%torque_body, &
                                    self%torque_space]))
    end function is_any

    !> Whether the numbers are finite, and those that must not be negative are not.
    pure logical function is_valid(self)
        class(effects_t), intent(in) :: self
        real(dp) :: amounts(7)
        amounts = [self%friction_torque, self%friction_arm, self%friction_smoothing, self%drag_moment, self%drag_force]
        is_valid = is_finite_harmonic(self%harmonic_body) .and. is_finite_harmonic(self%harmonic_space) &
            .and. all(amounts >= 0 .and. is_finite(amounts)) .and. self%drag_exponent >= 1 .and. self%drag_exponent <= 3 &
            .and. all(is_finite([self%vibration_amplitude, self%vibration_rate, self%vibration_phase, self%frame_rate, &
                                 self%rotor_momentum, self%rotor_torque, self%torque_body, self%torque_space]))
    end function is_valid

    !> Whether there is dry friction.
    pure logical function has_friction(self)
        class(effects_t), intent(in) :: self
        has_friction = self%friction_torque > 0 .or. self%friction_arm > 0
    end function has_friction

    !> Whether the vector kernels have all effects: all but dry friction, harmonic torques and tables.
    pure logical function have_kernels(self)
        class(effects_t), intent(in) :: self
        have_kernels = .not. (self%has_friction() .or. allocated(self%friction_table) .or. allocated(self%table) &
                              .or. self%is_harmonic())
    end function have_kernels

    !> Whether there is a harmonic torque.
    pure logical function is_harmonic(self)
        class(effects_t), intent(in) :: self
        is_harmonic = allocated(self%harmonic_body) .or. allocated(self%harmonic_space)
    end function is_harmonic

    !> Whether there is dry friction by the exact law, under which the body may stick.
    pure logical function is_dry(self)
        class(effects_t), intent(in) :: self
        is_dry = self%has_friction() .and. is_zero(self%friction_smoothing)
    end function is_dry

    !> Whether any effect does work: all but a rotor with constant momentum, and the rotation of the frame.
    pure logical function do_work(self)
        class(effects_t), intent(in) :: self
        do_work = self%has_friction() .or. allocated(self%friction_table) .or. self%depends_on_time() .or. self%drag_force > 0 &
            .or. .not. all(is_zero([self%drag_moment, self%torque_body, self%torque_space]))
    end function do_work

    !> Whether all effects act against the motion: friction and drag.
    pure logical function only_brake(self)
        class(effects_t), intent(in) :: self
        only_brake = .not. self%depends_on_time() &
            .and. all(is_zero([self%frame_rate, self%rotor_momentum, self%torque_body, self%torque_space]))
    end function only_brake

    !> Whether the air acts with a power of a speed that is not smooth where the speed is zero; or dry friction, which is
    !> smoothed, but changes there as fast as one likes.
    pure logical function has_cusps(self)
        class(effects_t), intent(in) :: self
        has_cusps = self%drag_force > 0 .or. (self%has_friction() .and. .not. self%is_dry())
        if (any(self%drag_moment > 0)) has_cusps = has_cusps .or. &
            .not. (is_zero(self%drag_exponent - 1) .or. is_zero(self%drag_exponent - 3))
    end function has_cusps

    !> Whether an effect depends on the time.
    pure logical function depends_on_time(self)
        class(effects_t), intent(in) :: self
        depends_on_time = allocated(self%table) .or. self%is_harmonic() &
            .or. .not. all(is_zero([self%vibration_amplitude, self%rotor_torque]))
    end function depends_on_time

    !> Whether the effects on a symmetric top about body z only add constants to the rates of phi and psi: a rotor
    !> that is not driven on the axis, and a frame that turns about the vertical.
    pure logical function shifts_angles(self)
        class(effects_t), intent(in) :: self
        shifts_angles = .not. (self%has_friction() .or. allocated(self%friction_table) .or. self%depends_on_time() &
                               .or. self%drag_force > 0) &
            .and. all(is_zero([self%drag_moment, self%torque_body, self%torque_space, self%frame_rate(1:2), &
                               self%rotor_momentum(1:2)]))
    end function shifts_angles

    !> The moment of a table of friction, N m; zero without one.
    pure function friction_by_table(self, omega) result(moment)
        class(effects_t), intent(in) :: self
        real(dp), intent(in) :: omega(3) !! angular velocity in body axes, rad/s
        real(dp) :: moment(3), torque(3)
        moment = 0
        if (.not. allocated(self%friction_table)) return
        torque = self%friction_table%at(dot_product(self%friction_axis, omega))
        moment = torque(3) * self%friction_axis
    end function friction_by_table

    !> What is rounding of the angular velocity about an axis, rad/s.
    pure real(dp) function slack_of_spin(self, omega) result(slack)
        class(effects_t), intent(in) :: self
        real(dp), intent(in) :: omega(3) !! angular velocity in body axes, rad/s
        real(dp), parameter :: spacings = 16
        slack = spacings * epsilon(slack) * (norm2(omega) + norm2(self%frame_rate))
    end function slack_of_spin

    !> The vector at a time.
    pure function harmonic_at(self, t) result(vector)
        class(harmonic_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: vector(3)
        vector = self%even * cos(self%rate * t) - self%odd * sin(self%rate * t)
    end function harmonic_at

    !> Whether a vector over time, if there is one, has finite numbers.
    pure logical function is_finite_harmonic(harmonic)
        type(harmonic_t), allocatable, intent(in) :: harmonic
        is_finite_harmonic = .true.
        if (allocated(harmonic)) is_finite_harmonic = all(is_finite([harmonic%even, harmonic%odd, harmonic%rate]))
    end function is_finite_harmonic

    !> Angular velocity of the Earth in axes that point east, north and up, rad/s. At a pole it is vertical.
    pure function earth_rotation(rate, latitude) result(rotation)
        real(dp), intent(in) :: rate, latitude !! rad/s; rad
        real(dp) :: rotation(3)
        rotation = rate * [0.0_dp, cos(latitude), sin(latitude)]
        if (abs(latitude) >= pi / 2 * (1 - epsilon(latitude))) then
            rotation = rate * [0.0_dp, 0.0_dp, sign(1.0_dp, latitude)]
        end if
    end function earth_rotation

end module spintop_effects
