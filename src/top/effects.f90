!> Effects on a body beside gravity and viscous damping: dry friction of the pivot, drag of the air, a moving pivot,
!> the rotation of the Earth, a rotor, given torques. Their values only; `spintop_loads` has their moments.
module spintop_effects
    use spintop_kinds, only: dp, pi, is_equal, is_finite, is_zero
    use spintop_torque_table, only: torque_table_t
    implicit none
    private
    public :: effects_t, harmonic_t
    public :: effect_friction, effect_friction_table, effect_drag, effect_lift, effect_shake, effect_frame, effect_upright_frame
    public :: effect_rotor, effect_axial_rotor, effect_drive, effect_torque, effect_harmonic, effect_table, effect_bits
    public :: kernel_effects, series_effects, timeless_effects, braking_effects

    !> What may act, as bits of `acting`. Who does not have every effect names those that he admits, so that another one is
    !> refused until it is admitted. A pivot is lifted along the vertical and shaken across it. A frame and a rotor that are
    !> not about the vertical and body z have both of their bits.
    integer, parameter :: effect_friction = 1, effect_friction_table = 2, effect_drag = 4, effect_lift = 8, effect_shake = 16, &
        effect_upright_frame = 32, effect_frame = 64 + effect_upright_frame, effect_axial_rotor = 128, &
        effect_rotor = 256 + effect_axial_rotor, effect_drive = 512, effect_torque = 1024, effect_harmonic = 2048, &
        effect_table = 4096, effect_bits(13) = 2**[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]
    !> Those that the vector kernels have, those with which a body has series, those that do not depend on the time, and those
    !> that act against the motion.
    integer, parameter :: &
        kernel_effects = effect_drag + effect_lift + effect_shake + effect_frame + effect_rotor + effect_drive + effect_torque, &
        series_effects = kernel_effects + effect_friction + effect_friction_table + effect_harmonic + effect_table, &
        timeless_effects = effect_friction + effect_friction_table + effect_drag + effect_frame + effect_rotor + effect_torque, &
        braking_effects = effect_friction + effect_friction_table + effect_drag

    !> A vector over time with the components amplitude cos(rate t + phase).
    type :: harmonic_t
        real(dp) :: amplitude(3) = 0, phase(3) = 0
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
        !> The rate, rad/s, and the latitude from which it was rounded (`turn_with_earth`); 0 if it is given itself.
        real(dp) :: earth_rate = 0, latitude = 0
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
        procedure :: acting
        procedure :: only
        procedure :: is_valid
        procedure :: is_dry
        procedure :: has_cusps
        procedure :: has_friction
        procedure :: friction_by_table
        procedure :: slack_of_spin
        procedure :: turn_with_earth
    end type effects_t

    !> The length of an axis differs from 1 by no more.
    real(dp), parameter :: unit_slack = 1.0e-6_dp

contains

    !> The effects that act, as a sum of bits: this is the only list of them.
    pure integer function acting(self)
        class(effects_t), intent(in) :: self
        acting = sum(effect_bits, mask=[ &
            self%has_friction(), allocated(self%friction_table), acts([self%drag_moment, self%drag_force]), &
            acts(self%vibration_amplitude(3:)), acts(self%vibration_amplitude(:2)), acts(self%frame_rate(3:)), &
            acts(self%frame_rate(:2)), acts(self%rotor_momentum(3:)), acts(self%rotor_momentum(:2)), acts(self%rotor_torque), &
            acts([self%torque_body, self%torque_space]), allocated(self%harmonic_body) .or. allocated(self%harmonic_space), &
            allocated(self%table)])

    contains

        !> Whether one of some numbers is not zero.
        pure logical function acts(numbers)
            real(dp), intent(in) :: numbers(:)
            acts = .not. all(is_zero(numbers))
        end function acts

    end function acting

    !> Whether nothing acts but what is admitted.
    pure logical function only(self, admitted)
        class(effects_t), intent(in) :: self
        integer, intent(in) :: admitted !! a sum of effects
        only = iand(self%acting(), not(admitted)) == 0
    end function only

    !> Whether the numbers are finite, and those that must not be negative are not; and whether the rate of the frame is the one
    !> of the latitude, if that is given.
    pure logical function is_valid(self)
        class(effects_t), intent(in) :: self
        type(effects_t) :: earth
        real(dp) :: amounts(7)
        amounts = [self%friction_torque, self%friction_arm, self%friction_smoothing, self%drag_moment, self%drag_force]
        is_valid = is_finite_harmonic(self%harmonic_body) .and. is_finite_harmonic(self%harmonic_space) &
            .and. all(amounts >= 0 .and. is_finite(amounts)) .and. self%drag_exponent >= 1 .and. self%drag_exponent <= 3 &
            .and. all(is_finite([self%vibration_amplitude, self%vibration_rate, self%vibration_phase, self%frame_rate, &
                                 self%rotor_momentum, self%rotor_torque, self%torque_body, self%torque_space]))
        if (allocated(self%table)) is_valid = is_valid .and. self%table%is_valid()
        if (allocated(self%friction_table)) is_valid = is_valid .and. self%friction_table%is_valid() &
            .and. abs(norm2(self%friction_axis) - 1) <= unit_slack
        if (is_zero(self%earth_rate) .and. is_zero(self%latitude)) return
        call earth%turn_with_earth(self%earth_rate, self%latitude)
        is_valid = is_valid .and. all(is_equal(earth%frame_rate, self%frame_rate))
    end function is_valid

    !> Whether there is dry friction.
    pure logical function has_friction(self)
        class(effects_t), intent(in) :: self
        has_friction = self%friction_torque > 0 .or. self%friction_arm > 0
    end function has_friction

    !> Whether there is dry friction by the exact law, under which the body may stick.
    pure logical function is_dry(self)
        class(effects_t), intent(in) :: self
        is_dry = self%has_friction() .and. is_zero(self%friction_smoothing)
    end function is_dry

    !> Whether the air acts with a power of a speed that is not smooth where the speed is zero; or dry friction, which is
    !> smoothed, but changes there as fast as one likes.
    pure logical function has_cusps(self)
        class(effects_t), intent(in) :: self
        has_cusps = self%drag_force > 0 .or. (self%has_friction() .and. .not. self%is_dry())
        if (any(self%drag_moment > 0)) has_cusps = has_cusps .or. &
            .not. (is_zero(self%drag_exponent - 1) .or. is_zero(self%drag_exponent - 3))
    end function has_cusps

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
        vector = self%amplitude
        where (abs(vector) > 0) vector = vector * cos(self%rate * t + self%phase)
    end function harmonic_at

    !> Whether a vector over time, if there is one, has finite numbers.
    pure logical function is_finite_harmonic(harmonic)
        type(harmonic_t), allocatable, intent(in) :: harmonic
        is_finite_harmonic = .true.
        if (allocated(harmonic)) is_finite_harmonic = all(is_finite([harmonic%amplitude, harmonic%phase, harmonic%rate]))
    end function is_finite_harmonic

    !> Turns the frame with the Earth; its axes point east, north and up. At a pole its rotation is vertical.
    pure subroutine turn_with_earth(self, rate, latitude)
        class(effects_t), intent(inout) :: self
        real(dp), intent(in) :: rate, latitude !! rad/s; rad
        self%frame_rate = rate * [0.0_dp, 0.0_dp, sign(1.0_dp, latitude)]
        self%earth_rate = 0
        self%latitude = 0
        if (abs(latitude) >= pi / 2 * (1 - epsilon(latitude))) return
        self%frame_rate = rate * [0.0_dp, cos(latitude), sin(latitude)]
        self%earth_rate = rate
        self%latitude = latitude
    end subroutine turn_with_earth

end module spintop_effects
