!> Moments and forces of all effects on a body at an instant, and the rate of its momentum.
!>
!>     w_a = w + O,   P = I w_a + h,   P' = P x w_a + m (g G + a) x r - d w + M_friction + M_drag + M_given
!>
!> in body axes: w is the angular velocity relative to a frame that turns with O, a the acceleration of the pivot, h
!> the momentum of a rotor, G the upward vertical, r the centre of mass.
module spintop_loads
    use spintop_body, only: body_t
    use spintop_kinds, only: dp, qp, epsilon_dp, is_zero, cross
    use spintop_effects, only: effects_t
    use spintop_torque_table, only: max_degree
    implicit none
    private
    public :: loads_t, acceleration, find_loads, torque_series, find_kinematics, total_momentum, rotor_momentum_at
    public :: momentum_rate, frame_energy, friction_jams, works
    public :: work_damping, work_friction, work_drag, work_vibration, work_torque, work_rotor

    !> The parts of the work on a body.
    integer, parameter :: work_damping = 1, work_friction = 2, work_drag = 3, work_vibration = 4, work_torque = 5, &
        work_rotor = 6, works = 6

    !> What acts on a body at an instant, in body axes.
    type :: loads_t
        !> Rows of the rotation: space x, y, z in body axes; the last is the upward vertical.
        real(dp) :: rows(3, 3) = 0
        !> Angular velocity relative to the frame, that of the frame, and their sum, rad/s.
        real(dp) :: omega(3) = 0, frame(3) = 0, total(3) = 0
        !> Acceleration of the pivot, and the same with gravity, m/s^2.
        real(dp) :: pivot(3) = 0, lift(3) = 0
        !> Drag on the centre of mass, N.
        real(dp) :: drag(3) = 0
        !> Moments that do the parts of the work, N m: damping to torque.
        real(dp) :: moment(3, work_damping:work_torque) = 0
        !> Torque of the rotor's drive, N m.
        real(dp) :: drive(3) = 0
        !> Rate of the momentum P, N m.
        real(dp) :: rate(3) = 0
        !> Support force, N.
        real(dp) :: force(3) = 0
        !> Largest dry moment, and the torque that it balances where the body is at rest, N m.
        real(dp) :: dry = 0, pull(3) = 0
        !> Whether the body is at rest, and whether friction holds it.
        logical :: rests = .false., sticks = .false.
    contains
        procedure :: power
    end type loads_t

    !> Iterations for the load of the pivot when a body starts from rest, and for the rate of the start.
    integer, parameter :: most_iterations = 100

contains

    !> The momentum of the rotor, J s.
    pure function rotor_momentum_at(effects, t) result(momentum)
        type(effects_t), intent(in) :: effects !! effects on the body
        real(dp), intent(in) :: t !! time, s
        real(dp) :: momentum(3)
        momentum = effects%rotor_momentum + effects%rotor_torque * t
    end function rotor_momentum_at

    !> Space x, y, z in body axes, as rows; the quaternion may have any norm.
    pure function space_in_body(q) result(rows)
        real(dp), intent(in) :: q(4)
        real(dp) :: rows(3, 3), twice
        twice = 2 / ((q(1)**2 + q(4)**2) + (q(2)**2 + q(3)**2))
        rows(1, :) = twice * [q(1)**2 + q(2)**2, q(2) * q(3) - q(1) * q(4), q(2) * q(4) + q(1) * q(3)]
        rows(2, :) = twice * [q(2) * q(3) + q(1) * q(4), q(1)**2 + q(3)**2, q(3) * q(4) - q(1) * q(2)]
        rows(3, :) = twice * [q(2) * q(4) - q(1) * q(3), q(3) * q(4) + q(1) * q(2), q(1)**2 + q(4)**2]
        rows(1, 1) = rows(1, 1) - 1
        rows(2, 2) = rows(2, 2) - 1
        rows(3, 3) = rows(3, 3) - 1
    end function space_in_body

    !> A vector in space axes, in body axes.
    pure function in_body(rows, vector)
        real(dp), intent(in) :: rows(3, 3), vector(3)
        real(dp) :: in_body(3)
        in_body = vector(1) * rows(1, :) + vector(2) * rows(2, :) + vector(3) * rows(3, :)
    end function in_body

    !> Attitude, angular velocities and the motion of the pivot at a time, of a body with effects.
    pure subroutine find_kinematics(body, effects, t, q, momentum, loads)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(effects_t), intent(in) :: effects !! effects on the body
        real(dp), intent(in) :: t, q(4), momentum(3) !! s; attitude; P, J s
        type(loads_t), intent(out) :: loads !! its kinematic part is set
        real(dp) :: slack
        loads%rows = space_in_body(q)
        loads%frame = in_body(loads%rows, effects%frame_rate)
        loads%total = (momentum - rotor_momentum_at(effects, t)) / body%inertia
        loads%omega = loads%total - loads%frame
        loads%pivot = in_body(loads%rows, pivot_acceleration(effects, t))
        loads%lift = loads%pivot + body%gravity * loads%rows(3, :)
        slack = 16 * epsilon_dp * (norm2(loads%frame) + norm2(rotor_momentum_at(effects, t) / body%inertia))
        loads%rests = norm2(loads%omega) <= slack
        if (loads%rests) loads%omega = 0
    end subroutine find_kinematics

    !> Acceleration of the pivot in space axes, in the frame that turns: z'' + 2 O x z' + O x (O x z).
    pure function pivot_acceleration(effects, t) result(acceleration)
        type(effects_t), intent(in) :: effects
        real(dp), intent(in) :: t
        real(dp) :: acceleration(3), phase(3), place(3), velocity(3)
        acceleration = 0
        if (all(is_zero(effects%vibration_amplitude))) return
        associate (rate => effects%vibration_rate, o => effects%frame_rate)
            phase = rate * t + effects%vibration_phase
            place = effects%vibration_amplitude * cos(phase)
            velocity = -rate * effects%vibration_amplitude * sin(phase)
            acceleration = -rate**2 * place + 2 * cross(o, velocity) + cross(o, cross(o, place))
        end associate
    end function pivot_acceleration

    !> Everything that acts on a body with effects.
    pure subroutine find_loads(body, effects, t, q, momentum, loads)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(effects_t), intent(in) :: effects !! effects on the body
        real(dp), intent(in) :: t, q(4), momentum(3) !! s; attitude; P, J s
        type(loads_t), intent(out) :: loads !! moments, forces, and the rate of the momentum
        real(dp) :: table(3), given(3), speed, velocity(3)

        call find_kinematics(body, effects, t, q, momentum, loads)
        associate (w => loads%omega, r => body%centre_of_mass)
            loads%drive = effects%rotor_torque
            loads%moment(:, work_damping) = -body%damping * w
            if (any(effects%drag_moment > 0)) then
                speed = norm2(w)
                if (speed > 0) loads%moment(:, work_drag) = -effects%drag_moment * speed**(effects%drag_exponent - 1) * w
            end if
            if (effects%drag_force > 0) then
                velocity = cross(w, r)
                loads%drag = -effects%drag_force * norm2(velocity) * velocity
                loads%moment(:, work_drag) = loads%moment(:, work_drag) + cross(r, loads%drag)
            end if
            loads%moment(:, work_friction) = effects%friction_by_table(w)
            loads%moment(:, work_vibration) = body%mass * cross(loads%pivot, r)
            given = effects%torque_space
            loads%moment(:, work_torque) = effects%torque_body
            if (allocated(effects%harmonic_space)) given = given + effects%harmonic_space%at(t)
            if (allocated(effects%harmonic_body)) then
                loads%moment(:, work_torque) = loads%moment(:, work_torque) + effects%harmonic_body%at(t)
            end if
            if (allocated(effects%table)) then
                table = effects%table%at(t)
                if (effects%table_in_space) then
                    given = given + table
                else
                    loads%moment(:, work_torque) = loads%moment(:, work_torque) + table
                end if
            end if
            loads%moment(:, work_torque) = loads%moment(:, work_torque) + in_body(loads%rows, given)
            loads%rate = cross(momentum, loads%total) + body%torque(loads%rows(3, :)) + loads%moment(:, work_damping) &
                + loads%moment(:, work_friction) + loads%moment(:, work_drag) + loads%moment(:, work_vibration) &
                + loads%moment(:, work_torque)
        end associate
        if (effects%has_friction()) call add_friction(body, effects, loads)
        loads%force = force_at(body, effects, loads, loads%rate)
    end subroutine find_loads

    !> The power series about a time of the torques over time in body axes, but for harmonic ones, of which the kernels have series.
    pure function torque_series(effects, t, order) result(terms)
        type(effects_t), intent(in) :: effects !! effects on the body
        real(dp), intent(in) :: t !! time, s
        integer, intent(in) :: order !! order of the highest term
        real(qp) :: terms(3, 0:order) !! coefficients of powers of the time after t, N m/s^k
        real(dp) :: table(3, 0:max_degree)
        integer :: k
        terms = 0
        if (.not. allocated(effects%table) .or. effects%table_in_space) return
        table = effects%table%expansion(t)
        do k = 0, min(order, max_degree)
            terms(:, k) = table(:, k)
        end do
    end function torque_series

    !> The support force where P has a rate, in body axes, N.
    pure function force_at(body, effects, loads, rate) result(force)
        type(body_t), intent(in) :: body
        type(effects_t), intent(in) :: effects
        type(loads_t), intent(in) :: loads
        real(dp), intent(in) :: rate(3)
        real(dp) :: force(3)
        associate (r => body%centre_of_mass, w => loads%total)
            force = body%mass * (loads%lift + cross((rate - effects%rotor_torque) / body%inertia, r) &
                                 + cross(w, cross(w, r))) - loads%drag
        end associate
    end function force_at

    !> Adds dry friction: -(Mc + mu rho N) u, where u is along the angular velocity and N the magnitude of the support
    !> force, which depends on the friction itself. At rest it balances the other torques up to that moment; beyond,
    !> the body starts.
    pure subroutine add_friction(body, effects, loads)
        type(body_t), intent(in) :: body
        type(effects_t), intent(in) :: effects
        type(loads_t), intent(inout) :: loads
        real(dp) :: direction(3), length, moment(3)

        length = sqrt(sum(loads%omega**2) + effects%friction_smoothing**2)
        if (.not. loads%rests .or. effects%friction_smoothing > 0) then
            direction = loads%omega / length
            loads%dry = dry_moment(body, effects, loads, direction)
            moment = -loads%dry * direction
        else
            loads%pull = loads%rate - effects%rotor_torque
            loads%dry = effects%friction_torque
            if (effects%friction_arm > 0) loads%dry = loads%dry + effects%friction_arm * &
                norm2(force_at(body, effects, loads, effects%rotor_torque))
            loads%sticks = norm2(loads%pull) <= loads%dry
            if (loads%sticks) then
                moment = -loads%pull
            else
                call start_moving(body, effects, loads, moment)
            end if
        end if
        loads%moment(:, work_friction) = loads%moment(:, work_friction) + moment
        loads%rate = loads%rate + moment
    end subroutine add_friction

    !> The dry moment for a direction of the angular velocity, N m: with F = F0 - N B, where F0 is the support force
    !> without friction by load, N = |F| is the root of a quadratic equation.
    pure real(dp) function dry_moment(body, effects, loads, direction) result(moment)
        type(body_t), intent(in) :: body
        type(effects_t), intent(in) :: effects
        type(loads_t), intent(in) :: loads
        real(dp), intent(in) :: direction(3)
        real(dp) :: unloaded(3), lever(3), along, rest
        moment = effects%friction_torque
        if (.not. effects%friction_arm > 0) return
        unloaded = force_at(body, effects, loads, loads%rate - effects%friction_torque * direction)
        lever = body%mass * effects%friction_arm * cross(direction / body%inertia, body%centre_of_mass)
        along = dot_product(unloaded, lever)
        rest = 1 - sum(lever**2)
        moment = moment + effects%friction_arm * (sqrt(along**2 + rest * sum(unloaded**2)) - along) / rest
    end function dry_moment

    !> The start from rest with w' = lambda u, where u_i = T_i/(lambda I_i + M) and |u| = 1.
    pure subroutine start_moving(body, effects, loads, moment)
        type(body_t), intent(in) :: body
        type(effects_t), intent(in) :: effects
        type(loads_t), intent(inout) :: loads
        real(dp), intent(out) :: moment(3) !! of friction, N m
        real(dp) :: direction(3), last
        integer :: i
        direction = start_direction(body%inertia, loads%pull, loads%dry)
        do i = 1, most_iterations
            last = loads%dry
            loads%dry = dry_moment(body, effects, loads, direction)
            direction = start_direction(body%inertia, loads%pull, loads%dry)
            if (abs(loads%dry - last) <= 2 * epsilon_dp * loads%dry) exit
        end do
        moment = -loads%dry * direction
    end subroutine start_moving

    !> The direction u of the start from rest under the torque T against the dry moment M < |T|: the root lambda > 0 of
    !> |u| = 1 by Newton's method for 1/|u|, which is nearly linear.
    pure function start_direction(inertia, pull, dry) result(u)
        real(dp), intent(in) :: inertia(3), pull(3), dry
        real(dp) :: u(3), rate, length, step
        integer :: i
        if (.not. dry > 0) then
            u = pull / inertia
            u = u / norm2(u)
            return
        end if
        rate = 0
        do i = 1, most_iterations
            u = pull / (rate * inertia + dry)
            length = norm2(u)
            step = (length - 1) * length**2 / sum(inertia * u**2 / (rate * inertia + dry))
            rate = max(rate + step, 0.0_dp)
            if (abs(step) <= 2 * epsilon_dp * rate) exit
        end do
        u = pull / (rate * inertia + dry)
        u = u / norm2(u)
    end function start_direction

    !> The angular acceleration under the loads, w' = I^-1 (P' - h') - O x w, rad/s^2.
    pure function acceleration(body, loads)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(loads_t), intent(in) :: loads !! what acts on it
        real(dp) :: acceleration(3)
        acceleration = (loads%rate - loads%drive) / body%inertia - cross(loads%frame, loads%omega)
    end function acceleration

    !> Power of each part of the work, W.
    pure function power(self)
        class(loads_t), intent(in) :: self
        real(dp) :: power(works)
        integer :: i
        do i = work_damping, work_torque
            power(i) = dot_product(self%omega, self%moment(:, i))
        end do
        power(work_rotor) = -dot_product(self%total, self%drive)
    end function power

    !> The momentum P = I w_a + h of a body, J s.
    pure function total_momentum(body, t, q, omega) result(momentum)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: t, q(4), omega(3) !! s; attitude; angular velocity in body axes, rad/s
        real(dp) :: momentum(3)
        momentum = body%momentum(omega)
        if (.not. allocated(body%effects)) return
        momentum = body%momentum(omega + in_body(space_in_body(q), body%effects%frame_rate)) &
            + rotor_momentum_at(body%effects, t)
    end function total_momentum

    !> The rate P' of the momentum at an angular acceleration w', of a body with effects: I (w' + O x w) + h'.
    pure function momentum_rate(body, q, omega, omega_rate) result(rate)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: q(4), omega(3), omega_rate(3) !! attitude; in body axes, rad/s and rad/s^2
        real(dp) :: rate(3)
        rate = body%momentum(omega_rate + cross(in_body(space_in_body(q), body%effects%frame_rate), omega)) &
            + body%effects%rotor_torque
    end function momentum_rate

    !> Potential energy of the motion of the frame, -O.IO/2 - O.h, J.
    pure real(dp) function frame_energy(body, t, q) result(energy)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: t, q(4) !! s; attitude
        real(dp) :: frame(3)
        frame = in_body(space_in_body(q), body%effects%frame_rate)
        energy = -dot_product(frame, body%momentum(frame) / 2 + rotor_momentum_at(body%effects, t))
    end function frame_energy

    !> Whether friction by load may jam the body: m mu rho |[r]x I^-1| is 1 or more, so that N need not exist.
    pure logical function friction_jams(body, arm)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp), intent(in) :: arm !! coefficient of friction times radius, m
        real(dp) :: square(3, 3), column(3, 3), trace, minor
        integer :: i
        ! The largest eigenvalue of the square, a matrix of rank 2.
        do i = 1, 3
            column(:, i) = 0
            column(i, i) = 1 / body%inertia(i)
            column(:, i) = cross(column(:, i), body%centre_of_mass)
        end do
        square = matmul(transpose(column), column)
        trace = square(1, 1) + square(2, 2) + square(3, 3)
        minor = square(1, 1) * square(2, 2) - square(1, 2)**2 + square(1, 1) * square(3, 3) - square(1, 3)**2 &
            + square(2, 2) * square(3, 3) - square(2, 3)**2
        friction_jams = body%mass * arm * sqrt((trace + sqrt(max(trace**2 - 4 * minor, 0.0_dp))) / 2) >= 1
    end function friction_jams

end module spintop_loads
