!> The interface between formulations of the equations of motion, y' = f(t, y), and integrators.
!>
!> A formulation is prepared once for a body and a start and does not change afterwards, so threads may share
!> it. States are arrays of fixed size; unused components are zero.
module spintop_formulation
    use, intrinsic :: iso_c_binding, only: c_int
    use spintop_attitude, only: quaternion_product
    use spintop_kinds, only: dp, epsilon_dp, qp, xp
    use spintop_body, only: body_t
    use spintop_effects_action, only: effects_action_t
    use spintop_kernel_types, only: max_aside => set_aside, max_series_order => highest_order, max_states => numbers
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_motions, only: instants, motions_t
    implicit none
    private
    public :: formulation_t, formulation_info_t, motions_one_by_one, max_states, max_series_order, max_invariants, max_aside
    public :: structure_none, structure_split, structure_group, structure_series, structure_quadruple, structure_names

    !> What a method may need beside y' = f(t, y), and a formulation may offer: drift and kick, the two parts of the motion with
    !> flows of their own; motion on a Lie group; Taylor coefficients of the motion; the same in quadruple precision.
    integer, parameter :: structure_none = 0, structure_split = 1, structure_group = 2, &
        structure_series = 3, structure_quadruple = 4
    character(*), parameter :: structure_names(structure_split:structure_quadruple) = &
        [character(32) :: 'drift and kick', 'Lie-group motion', 'Taylor series', 'quadruple Taylor series']
    !> Largest number of invariants of any formulation.
    integer, parameter :: max_invariants = 5

    !> Registry entry of a formulation.
    type :: formulation_info_t
        !> Name, as it stands in inputs.
        character(16) :: name = ''
        !> Short description.
        character(112) :: what = ''
        !> Number of state variables in use.
        integer :: states = 0
        !> Valid only for an undamped symmetric top with its centre of mass on body z.
        logical :: symmetric_only = .true.
        !> Singular where sin(theta) = 0.
        logical :: singular_at_poles = .true.
        !> Number of invariants.
        integer :: invariants = 0
        !> Index of the first of the four components that contain the attitude quaternion, of unit norm at the
        !> start; 0 if there is none.
        integer :: quaternion = 0
        !> Takes theta' anew from the energy after each step.
        logical :: resets_speed = .false.
        !> Structures offered.
        logical :: offers(structure_split:structure_quadruple) = .false.
        !> Holds for a body with effects.
        logical :: takes_effects = .false.
        !> Has its motions computed together in vector lanes, by methods that do: the equations of any body.
        logical :: runs_in_lanes = .false.
    end type formulation_info_t

    !> A form of the equations of motion.
    type, abstract :: formulation_t
        !> The body and the start for which it was prepared.
        type(body_t) :: body = body_t()
        type(motion_t) :: start = motion_t()
        !> Scale of each state variable in this motion, set by `prepare`: 1 rad for angles (1/2 for
        !> quaternions), the largest rate, the largest momentum. Tolerances are relative to it.
        real(dp) :: scale(max_states) = 1
        !> State variables that count turns and on which the motion does not depend; step control ignores
        !> their magnitude.
        logical :: cyclic(max_states) = .false.
        !> Whether f depends on t, set by `prepare`.
        logical :: depends_on_time = .false.
        !> Index of the first of three components of the state that are the angular momentum in body axes; 0 if there are none.
        integer :: momentum = 0
        !> The quaternion of `info`, by which angles are counted; 0 if the state contains the angles themselves. Its spin may be
        !> less than that of the body by a separated rate, rad/s, in extended precision for its phase.
        integer :: attitude = 0
        real(xp) :: sigma = 0
        !> With `structure_group` the motion is that on the group of rotations and of additions to the other variables; whether the
        !> angular velocity by which the quaternion turns changes it in space axes, from the left, and not in body axes.
        logical :: turns_in_space = .false.
        !> Whether `find_stages` holds: the stages of an explicit Runge-Kutta step in one call, from any state.
        logical :: has_stages = .false.
        !> Whether the equations hold between two turning points only: `time_left`, `depart` and `arrive`; whether a change of the
        !> state, `reset_speed`, belongs to the equations and follows each accepted step.
        logical :: has_ends = .false., resets_speed = .false.
        !> With `structure_series`: where the terms of the common denominator of all variables are among those of the series, from 1
        !> on, and the rate at which the axes of the first two of them turn, rad/s; zeros if there are none.
        integer(c_int) :: of_denominator = 0
        real(dp) :: turn_rate = 0
        !> With `structure_split`: whether drift and kick are exact flows, the kick changes rates by a function of the attitude
        !> alone, and the drift is linear in the rates. Runge-Kutta-Nystrom tables need this.
        logical :: splits_as_nystrom = .false.
        !> What effects do beside changing f.
        type(effects_action_t), allocatable :: action
    contains
        procedure(describe), deferred :: info
        procedure(prepare), deferred :: prepare
        procedure(derivative), deferred :: derivative
        procedure :: kinematics => no_kinematics
        procedure :: motion
        procedure, non_overridable :: motion_without_angles
        procedure :: find_motions => motions_one_by_one
        procedure, non_overridable :: find_attitude
        procedure, non_overridable :: units
        procedure :: invariants => no_invariants
        procedure :: find_stages => find_no_stages
        procedure :: expand => no_series
        procedure :: quadruple_start => rounded_start
        procedure :: expand_quadruple => no_quadruple_series
        procedure :: drift => no_flow
        procedure :: kick => no_flow
        procedure :: time_left => endless
        procedure :: depart => stay
        procedure :: arrive => arrive_nowhere
        procedure :: reset_speed => keep_speed
    end type formulation_t

    abstract interface
        !> Name and properties.
        pure function describe(self) result(info)
            import :: formulation_t, formulation_info_t
            class(formulation_t), intent(in) :: self
            type(formulation_info_t) :: info
        end function describe

        !> Sets the constants of the motion, and returns the initial state.
        pure subroutine prepare(self, body, start, y, status)
            import :: formulation_t, body_t, motion_t, dp, max_states
            class(formulation_t), intent(inout) :: self
            type(body_t), intent(in) :: body !! mass properties about the fixed point
            type(motion_t), intent(in) :: start !! attitude and angular velocity at the start
            real(dp), intent(out) :: y(max_states) !! initial state
            integer, intent(out) :: status !! `status_ok`, or why the start has no state
        end subroutine prepare

        !> The right-hand side y' = f(t, y). A status other than `status_ok` says why there is none;
        !> `status_outside` is recoverable by a shorter step.
        pure subroutine derivative(self, t, y, dy, status)
            import :: formulation_t, dp, max_states
            class(formulation_t), intent(in) :: self
            real(dp), intent(in) :: t, y(max_states) !! time, s, and state
            real(dp), intent(out) :: dy(max_states) !! rate of the state, y'
            integer, intent(out) :: status !! `status_ok`, or why there is no slope
        end subroutine derivative
    end interface

contains

    !> The angular velocity of the quaternion in the state and, if it is wanted, its rate: equations in angles have none.
    pure subroutine no_kinematics(self, t, y, omega, rate)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        real(dp), intent(out) :: omega(3) !! in body axes, rad/s
        real(dp), intent(out), optional :: rate(3) !! its rate, rad/s^2
        omega = 0
        if (present(rate)) rate = 0
    end subroutine no_kinematics

    !> The motion at time t in state y, with accelerations from the second derivatives of the formulation. Angles that the state
    !> contains only modulo a turn are the values nearest to those of `near`.
    pure function motion(self, t, y, near)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states), near(3) !! time, s; state; angles near those of the motion, rad
        type(motion_t) :: motion, here
        here = self%motion_without_angles(t, y)
        motion = motion_from_quaternion(t, here%quaternion, here%omega, near)
        motion%norm_error = here%norm_error
        motion%omega_rate = here%omega_rate
    end function motion

    !> The motion whose angles and their rates need not be set, for what depends on the attitude, the angular velocity
    !> and its rate.
    pure function motion_without_angles(self, t, y) result(motion)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(motion_t) :: motion
        real(dp), parameter :: any_angles(3) = 0
        if (self%attitude == 0) then
            motion = self%motion(t, y, any_angles)
            return
        end if
        call self%find_attitude(t, y, motion)
        if (abs(self%sigma) > 0) call add_spin(self%sigma, motion)
    end function motion_without_angles

    !> The attitude that is in the state, without the separated spin, its angular velocity, and the rate of that.
    pure subroutine find_attitude(self, t, y, motion)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state
        type(motion_t), intent(inout) :: motion !! its angles are not set
        real(dp) :: length
        associate (q => y(self%attitude:self%attitude + 3))
            length = sqrt(q(1)**2 + q(2)**2 + q(3)**2 + q(4)**2)
            motion%t = t
            motion%quaternion = q / length
            motion%norm_error = length - 1
        end associate
        call self%kinematics(t, y, motion%omega, motion%omega_rate)
    end subroutine find_attitude

    !> Adds the separated spin to a motion: a turn about body z, at a constant rate.
    pure subroutine add_spin(sigma, motion)
        real(xp), intent(in) :: sigma
        type(motion_t), intent(inout) :: motion
        real(xp) :: half
        real(dp), parameter :: small = sqrt(epsilon_dp)
        real(dp) :: phase, rest, c, s, rest_c, rest_s, rate(3)
        ! After many turns a phase in double precision is not accurate enough: its rest is a rotation, mostly small.
        half = sigma * motion%t / 2
        phase = real(half, dp)
        rest = real(half - phase, dp)
        rest_c = 1
        rest_s = rest
        if (abs(rest) > small) then
            rest_c = cos(rest)
            rest_s = sin(rest)
        end if
        c = cos(phase) * rest_c - sin(phase) * rest_s
        s = sin(phase) * rest_c + cos(phase) * rest_s
        motion%quaternion = quaternion_product(motion%quaternion, [c, 0.0_dp, 0.0_dp, s])
        associate (w => motion%omega)
            rate = motion%omega_rate + real(sigma, dp) * [w(2), -w(1), 0.0_dp]
            motion%omega_rate = turned(rate)
            w = turned(w)
            w(3) = w(3) + real(sigma, dp)
        end associate

    contains

        !> Components in the axes after the spin.
        pure function turned(v)
            real(dp), intent(in) :: v(3)
            real(dp) :: turned(3)
            turned(1) = (c**2 - s**2) * v(1) + 2 * c * s * v(2)
            turned(2) = (c**2 - s**2) * v(2) - 2 * c * s * v(1)
            turned(3) = v(3)
        end function turned

    end subroutine add_spin

    !> Units of the state variables: the powers of two next to their scales. Linear equations for a state are solved in these
    !> units, so that their pivots, and all rounding errors, do not depend on the units of mass, length and time.
    pure function units(self)
        class(formulation_t), intent(in) :: self
        real(dp) :: units(max_states)
        units = set_exponent(1.0_dp, exponent(self%scale))
    end function units

    !> The motion without angles at several instants, one after another.
    pure subroutine motions_one_by_one(self, t, y, motions)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t(instants), y(instants, max_states) !! times, s, and states
        type(motions_t), intent(out) :: motions !! the motion at these times
        integer :: i
        do i = 1, instants
            call motions%set_motion(i, self%motion_without_angles(t(i), y(i, :)))
        end do
    end subroutine motions_one_by_one

    !> Invariants (first integrals) of the motion: `info%invariants` values (energy J, momenta J s, squared
    !> norm of a quaternion, ...), which are smooth functions of the state.
    pure subroutine no_invariants(self, y, values)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        real(dp), intent(out) :: values(max_invariants) !! values of the invariants
        values = 0
    end subroutine no_invariants

    !> Stages of an explicit Runge-Kutta step of size h from the state y, cheaper than one by one, where `has_stages`.
    pure subroutine find_no_stages(self, from, to, t, y, h, stages, a, since, c, k, aside)
        class(formulation_t), intent(in) :: self
        integer, intent(in) :: from, to !! first and last stage; there is at least one before
        real(dp), intent(in) :: t, y(max_states), h !! time and state at the beginning of the step, and its size, s
        integer, intent(in) :: stages !! their number in the table of the method
        real(dp), intent(in) :: a(stages, stages) !! column i contains the weights of the stages before stage i
        integer, intent(in) :: since(stages) !! stage i depends on the first one and on those from `since(i)` on
        real(dp), intent(in) :: c(stages) !! times of the stages in the step, over its size
        real(dp), intent(inout) :: k(max_states, stages) !! slopes: column i is that of stage i
        real(dp), intent(inout) :: aside(max_aside, stages)
            !! column i is what stage i leaves aside, of variables that follow from the state and have stages of their own
    end subroutine find_no_stages

    !> With `structure_series`, Taylor coefficients of the motion that passes through `y` at the time `t`:
    !> y(t + h) = sum_k coefficient(:, k) h^k, k = 0 .. order, in axes that turn and with a denominator, if there are such. Where
    !> there is no series they are NaN.
    pure subroutine no_series(self, t, y, order, coefficient)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t, y(max_states) !! time, s, and state about which the series is
        integer, intent(in) :: order !! at most `max_series_order`
        real(dp), intent(out) :: coefficient(max_states, 0:order) !! the coefficient of h^k in column k
        coefficient = 0
    end subroutine no_series

    !> With `structure_quadruple`, the state at the start in quadruple precision; zero if it is the one in double precision.
    pure function rounded_start(self) result(y)
        class(formulation_t), intent(in) :: self
        real(qp) :: y(max_states)
        y = 0
    end function rounded_start

    !> Taylor coefficients of the state that is `y` at the time `t`, in quadruple precision.
    pure subroutine no_quadruple_series(self, t, y, order, coefficient)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: t !! s
        real(qp), intent(in) :: y(max_states) !! state about which the series is
        integer, intent(in) :: order !! at most `max_series_order`
        real(qp), intent(out) :: coefficient(max_states, 0:max_series_order) !! columns to `order` are set
        coefficient = 0
    end subroutine no_quadruple_series

    !> A drift or a kick over `h` seconds, of either sign, from the state y + change: adds to `change` what it does. Together they
    !> are the motion: the sum of their right-hand sides is `derivative`, and does not depend on t. The kick is an exact flow; the
    !> drift is one or, without `splits_as_nystrom`, may be an approximation that is symmetric in h and of order 2.
    pure subroutine no_flow(self, y, h, change)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states), h !! state at the beginning of the step; time, s
        real(dp), intent(inout) :: change(max_states) !! since the beginning of the step
        change = 0
    end subroutine no_flow

    !> Time to the next turning point while theta slows down, s, where the equations end; `huge` where they do not end.
    pure real(dp) function endless(self, y) result(left)
        class(formulation_t), intent(in) :: self
        real(dp), intent(in) :: y(max_states) !! state
        left = huge(left)
    end function endless

    !> Leaves a start at which the right-hand side alone would stay for ever.
    pure subroutine stay(self, y, h, departed)
        class(formulation_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states), h
            !! state, and time of the departure, s; 0 on entry: chosen by this procedure
        logical, intent(out) :: departed !! whether the state is one after a departure
        departed = .false.
    end subroutine stay

    !> Goes to the turning point at which the equations end.
    pure subroutine arrive_nowhere(self, y, left)
        class(formulation_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states) !! state, then that at the turning point
        real(dp), intent(out) :: left !! time to it, s
        left = huge(left)
    end subroutine arrive_nowhere

    !> Takes theta' anew from the energy.
    pure subroutine keep_speed(self, y, clipped)
        class(formulation_t), intent(in) :: self
        real(dp), intent(inout) :: y(max_states) !! state
        logical, intent(out) :: clipped !! whether the energy had no such speed
        clipped = .false.
    end subroutine keep_speed

end module spintop_formulation
