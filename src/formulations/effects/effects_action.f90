!> What effects do to a body beside changing its equations: their work, rows of tables, vectors at whose zeros nothing is
!> smooth, and rest under dry friction.
module spintop_effects_action
    use spintop_attitude, only: quaternion_product, rotation_minus_one
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, pi, is_zero, cross
    use spintop_effects, only: effect_frame, effect_rotor, timeless_effects
    use spintop_kernel_types, only: max_states => numbers
    use spintop_loads, only: acceleration, find_kinematics, find_loads, loads_t, total_momentum, works
    use spintop_motions, only: instants
    use spintop_powers, only: find_powers
    implicit none
    private
    public :: effects_action_t, turning_t, reach_t, row_interval_t, directions, direction_omega, direction_velocity, direction_force

    !> Vectors at whose zeros effects are not smooth (`directions_at`).
    integer, parameter :: direction_omega = 1, direction_velocity = 2, direction_force = 3, directions = 3

    !> What effects do, with the state of the formulation `rigid_body` with effects.
    type :: effects_action_t
        !> Whether dry friction may hold the body, and whether it may let it go again by itself; whether the series of a
        !> motion ends where it reverses; whether friction depends on the support force; whether any effect does work.
        logical :: may_stick = .false., may_slip = .false., may_turn = .false., has_load = .false., does_work = .true.
        !> Whether friction follows a table.
        logical :: has_rows = .false.
        !> The body with its effects.
        type(body_t), private :: body
    contains
        procedure :: set
        procedure :: find_powers => find_powers_of_action
        procedure :: next_knot
        procedure :: smooth_until
        procedure :: after_jump
        procedure :: turning_at
        procedure :: interval_of_rows
        procedure :: spin_of_rows
        procedure :: directions_at
        procedure :: reach_of
        procedure :: drag_turns
        procedure :: at_rest
        procedure :: excess
        procedure :: pause
    end type effects_action_t

    !> The angular velocity at a time.
    type :: turning_t
        !> Time, s; magnitude of the angular velocity, rad/s, and how fast it decreases, rad/s^2; the part of it across the
        !> acceleration, rad/s, which is left where a motion reverses.
        real(dp) :: t = -1, speed = 0, slowing = 0, across = 0
    end type turning_t

    !> Two rows of a table of friction between which an angular velocity is, rad/s; what is rounding of it is included.
    type :: row_interval_t
        real(dp) :: lower = 0, upper = 0
    end type row_interval_t

    !> How far the angular velocity may move away in a time.
    type :: reach_t
        !> Its magnitude in space at the beginning, and a bound of its change, rad/s: it keeps a share of its magnitude if the
        !> change is less than that share of `speed`; and the velocity of the dragged centre of mass does if the change is less
        !> than that share of `dragged`.
        real(dp) :: speed = 0, change = 0, dragged = 0
    end type reach_t

    !> Relative size of what a cross product loses in rounding.
    real(dp), parameter :: rounding = 1.0e-14_dp
    !> So often in a period of a vibration or of a torque a resting body is looked at.
    integer, parameter :: looks_per_period = 64

contains

    !> Sets the constants for a body.
    pure subroutine set(self, body)
        class(effects_action_t), intent(inout) :: self
        type(body_t), intent(in) :: body !! mass properties about the fixed point, and its effects
        self%body = body
        self%may_stick = self%body%effects%is_dry()
        self%may_slip = self%may_stick .and. .not. self%body%effects%only(timeless_effects)
        self%may_turn = self%body%effects%has_cusps()
        self%has_rows = allocated(self%body%effects%friction_table)
        self%has_load = self%body%effects%friction_arm > 0
        self%does_work = .not. self%body%effects%only(effect_frame + effect_rotor) .or. any(body%damping > 0)
    end subroutine set

    !> Power of each part of the work (`spintop_loads`) at several instants.
    pure subroutine find_powers_of_action(self, t, y, power)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t(instants), y(instants, max_states) !! times, s, and states
        real(dp), intent(out) :: power(instants, works) !! of each part at each instant, W
        call find_powers(self%body, self%body%effects, t, y(:, 1:4), y(:, 5:7), power)
    end subroutine find_powers_of_action

    !> The first time after `t` at which f is not smooth, that of the next knot of the table of torques, s; `huge` if there is
    !> none.
    pure real(dp) function next_knot(self, t)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        next_knot = huge(t)
        if (allocated(self%body%effects%table)) next_knot = self%body%effects%table%next_knot(t)
    end function next_knot

    !> The time up to which a step from `t` may reach in which f is smooth, as far as the table of torques tells, s.
    pure real(dp) function smooth_until(self, t)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        smooth_until = huge(t)
        if (allocated(self%body%effects%table)) smooth_until = self%body%effects%table%smooth_until(t)
    end function smooth_until

    !> The time of a jump of the torques at which a step has ended, s; otherwise `t`.
    pure real(dp) function after_jump(self, t)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        after_jump = t
        if (allocated(self%body%effects%table)) after_jump = self%body%effects%table%after_jump(t)
    end function after_jump

    !> |w| and -|w|'.
    pure type(turning_t) function turning_at(self, t, y) result(turning)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp) :: rate(3)
        type(loads_t) :: loads
        call find_loads(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
        rate = acceleration(self%body, loads)
        turning = turning_t(t, norm2(loads%omega), across=norm2(loads%omega))
        if (.not. (turning%speed > 0 .and. norm2(rate) > 0)) return
        turning%slowing = -dot_product(loads%omega / turning%speed, rate)
        turning%across = norm2(cross(loads%omega, rate / norm2(rate)))
    end function turning_at

    !> The rows of the table of friction between which the motion in a state is, or into whose interval it moves.
    pure type(row_interval_t) function interval_of_rows(self, t, y) result(rows)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp) :: slack
        type(loads_t) :: loads
        integer :: i
        call find_loads(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
        associate (axis => self%body%effects%friction_axis, table => self%body%effects%friction_table)
            slack = self%body%effects%slack_of_spin(loads%omega)
            i = table%interval_towards(dot_product(axis, loads%omega), dot_product(axis, acceleration(self%body, loads)), slack)
            rows = row_interval_t(table%knots(i) - slack, table%knots(i + 1) + slack)
        end associate
    end function interval_of_rows

    !> The angular velocity about the axis of the table of friction, rad/s.
    pure real(dp) function spin_of_rows(self, t, y) result(spin)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(loads_t) :: loads
        call find_kinematics(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
        spin = dot_product(self%body%effects%friction_axis, loads%omega)
    end function spin_of_rows

    !> Vectors at whose zeros f is not smooth: w, rad/s, in body axes; w x r, m/s, likewise, if it is dragged; the support
    !> force, N, in space axes, if friction depends on it. Others are zero.
    pure function directions_at(self, t, y) result(vectors)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp) :: vectors(3, directions)
        type(loads_t) :: loads
        vectors = 0
        if (self%has_load) then
            call find_loads(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
            vectors(:, direction_force) = matmul(loads%rows, loads%force)
        else
            call find_kinematics(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
        end if
        vectors(:, direction_omega) = loads%omega
        if (.not. self%body%effects%drag_force > 0) return
        associate (w => loads%omega, r => self%body%centre_of_mass)
            vectors(:, direction_velocity) = cross(w, r)
            ! Of a body that turns about r, rounding has any direction.
            if (norm2(vectors(:, direction_velocity)) <= rounding * norm2(w) * norm2(r)) vectors(:, direction_velocity) = 0
        end associate
    end function directions_at

    !> The reach of the angular velocity in `span` seconds, in which the state variables change by `change` at most: that of w
    !> + O and that of w, as O, of constant magnitude, turns by any angle, and is missing in w at the beginning. A change of w
    !> is one of w across r at the most. Nothing bounds the support force.
    pure type(reach_t) function reach_of(self, t, y, span, change) result(reach)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), span, change(max_states) !! time, s; state; s; bounds of its change
        real(dp) :: omega(3)
        associate (effects => self%body%effects, inertia => self%body%inertia, r => self%body%centre_of_mass)
            omega = (y(5:7) - (effects%rotor_momentum + effects%rotor_torque * t)) / inertia
            reach%speed = norm2(omega)
            reach%dragged = reach%speed
            if (effects%drag_force > 0 .and. norm2(r) > 0) reach%dragged = norm2(cross(omega, r / norm2(r)))
            reach%change = norm2((change(5:7) + abs(effects%rotor_torque) * span) / inertia) + 3 * norm2(effects%frame_rate)
        end associate
    end function reach_of

    !> Whether w x r turns by more than a right angle from one state to the next, in body axes, which turn by less in the
    !> meantime.
    pure logical function drag_turns(self, t, y)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t(0:instants), y(0:instants, max_states) !! times, s, and states
        real(dp) :: w(0:instants, 3), v(0:instants, 3), least
        type(loads_t) :: loads
        integer :: i
        associate (effects => self%body%effects, r => self%body%centre_of_mass)
            do i = 1, 3
                w(:, i) = (y(:, 4 + i) - (effects%rotor_momentum(i) + effects%rotor_torque(i) * t)) / self%body%inertia(i)
            end do
            if (any(abs(effects%frame_rate) > 0)) then
                do i = 0, instants
                    call find_kinematics(self%body, effects, t(i), y(i, 1:4), y(i, 5:7), loads)
                    w(i, :) = loads%omega
                end do
            end if
            v(:, 1) = w(:, 2) * r(3) - w(:, 3) * r(2)
            v(:, 2) = w(:, 3) * r(1) - w(:, 1) * r(3)
            v(:, 3) = w(:, 1) * r(2) - w(:, 2) * r(1)
            least = -rounding**2 * sum(w(0, :)**2) * sum(r**2)
        end associate
        drag_turns = any(v(1:, 1) * v(:instants - 1, 1) + v(1:, 2) * v(:instants - 1, 2) + v(1:, 3) * v(:instants - 1, 3) < least)
    end function drag_turns

    !> The state at rest at a time, with the attitude that the motion in a state reaches after `left` seconds of constant
    !> deceleration to rest.
    pure function at_rest(self, t, y, left) result(resting)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), left !! time, s; state; time to rest, s
        real(dp) :: resting(max_states)
        type(loads_t) :: loads
        real(dp), parameter :: still(3) = 0
        resting = y
        if (left > 0) then
            call find_kinematics(self%body, self%body%effects, t - left, y(1:4), y(5:7), loads)
            resting(1:4) = y(1:4) + quaternion_product(y(1:4), rotation_minus_one(loads%omega * left / 2))
        end if
        resting(5:7) = total_momentum(self%body, t, resting(1:4), still)
    end function at_rest

    !> By how much the torques exceed what dry friction can balance at rest, |T| - M, N m: it holds where they do not.
    pure real(dp) function excess(self, t, y)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and a state at rest
        type(loads_t) :: loads
        call find_loads(self%body, self%body%effects, t, y(1:4), y(5:7), loads)
        excess = norm2(loads%pull) - loads%dry
        if (loads%sticks) excess = min(excess, 0.0_dp)
    end function excess

    !> A time in which the torques on a resting body change little: a part of a period of the vibration or of a harmonic
    !> torque, or of the interval of the table up to the next knot; for a driven rotor, in which the torque grows steadily, all
    !> the time there is.
    pure real(dp) function pause(self, t) result(time)
        class(effects_action_t), intent(in) :: self
        real(dp), intent(in) :: t !! time, s
        time = huge(t)
        if (.not. all(is_zero(self%body%effects%vibration_amplitude))) then
            time = 2 * pi / self%body%effects%vibration_rate / looks_per_period
        end if
        associate (effects => self%body%effects)
            if (allocated(effects%harmonic_body)) time = min(time, 2 * pi / effects%harmonic_body%rate / looks_per_period)
            if (allocated(effects%harmonic_space)) time = min(time, 2 * pi / effects%harmonic_space%rate / looks_per_period)
        end associate
        if (.not. self%next_knot(t) < huge(t)) return
        time = min(time, self%smooth_until(t) - t, self%body%effects%table%pace(t))
    end function pause

end module spintop_effects_action
