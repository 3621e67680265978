!> What an event is: a passage of a quantity through a level, or an occasion that the equations of motion know; the interface of a
!> motion along which it is searched, at any time within an interval; and whether a quantity varies at all, or is constant to
!> rounding: the one judgement of events, turning points and lanes.
!>
!> A quantity is made of the attitude and the angular velocity, which are known to rounding. Its *noise* is what it changes by
!> between a motion and its neighbours, which differ by that. A quantity that is at the level of an event, and on the first part
!> of the motion further from it than its noise nowhere, stays there: the equations have no other solution. The first part is
!> computed for this, from the start, by steps whose error is below rounding. So the judgement does not depend on the method by
!> which the motion is integrated, nor on its tolerance.
!>
!> Where a motion is integrated to a tolerance, a quantity has the noise of that, too. A passage counts only if the quantity was
!> beyond its noise since the one before (`spintop_events`).
module spintop_event
    use, intrinsic :: iso_fortran_env, only: int64
    use spintop_attitude, only: quaternion_product
    use spintop_body, only: body_t
    use spintop_runge_kutta, only: dop853_table, dop853_table_t, main_stages
    use spintop_effects, only: timeless_effects
    use spintop_kinds, only: dp, pi, is_finite
    use spintop_loads, only: works
    use spintop_motion, only: motion_from_quaternion, motion_t
    use spintop_motions, only: instants, motions_t
    use spintop_quantities, only: angular_acceleration
    implicit none
    private
    public :: event_t, event_quantities_t, occasion_none, occasion_stuck, occasion_slip, occasion_knot, path_t
    public :: find_constant, find_noise, driven_rate, greatest_fall_rate, find_noise_of_steps, noise_of_tolerance, time_of_start
    public :: margin, rounding_distance

    !> What an event is: a passage; dry friction stops the body; the torques overcome dry friction, and the body begins
    !> to move; a row of a table of torques.
    integer, parameter :: occasion_none = 0, occasion_stuck = 1, occasion_slip = 2, occasion_knot = 3

    !> An event to search for, and the number of its occurrences.
    type :: event_t
        !> Name in tables.
        character(80) :: name = ''
        !> 1 if the quantity rises through the level, -1 if it falls, 0 for both.
        integer :: direction = 1
        !> The level, in the unit of the quantity.
        real(dp) :: level = 0
        !> Whether the levels are `level` + 2 pi n for all integers n.
        logical :: every_turn = .false.
        !> Whether the levels are 2 pi, 4 pi, ..., each met once, in this order.
        logical :: turn_by_turn = .false.
        !> Number of events so far.
        integer :: count = 0
        !> The occasion, if the event is not a passage; its quantity then never reaches its level.
        integer :: occasion = occasion_none
    end type event_t

    !> Quantities of a motion, one for each event. An extension defines them.
    type, abstract :: event_quantities_t
        !> The events to search for.
        type(event_t), allocatable :: events(:)
        !> Whether a quantity takes the angles or their rates from the motion; otherwise they are not computed there.
        logical :: needs_angles = .true.
        !> Whether `quantities_of_several` gives all quantities; then none needs the angles.
        logical :: takes_several = .false.
    contains
        procedure(quantities), deferred :: quantities
        procedure :: quantities_of_several
    end type event_quantities_t

    abstract interface
        !> The quantities of all events. While a quantity is not finite, its events are not found.
        subroutine quantities(self, motion, values)
            import :: event_quantities_t, motion_t, dp
            class(event_quantities_t), intent(inout) :: self
            type(motion_t), intent(in) :: motion !! the motion at an instant
            real(dp), intent(out) :: values(:) !! one value for each event
        end subroutine quantities
    end interface

    !> An extension defines the motion, and how many evaluations are allowed.
    type, abstract :: path_t
        !> A bound of the angular velocity along the path, rad/s; 0 if none is known.
        real(dp) :: greatest_rate = 0
        !> Evaluations so far, and how many are allowed.
        integer(int64) :: looks = 0, most_looks = huge(1_int64)
    contains
        procedure(at), deferred :: at
        procedure :: at_several
        procedure :: work_until
        procedure :: is_spent
    end type path_t

    abstract interface
        !> The motion at a time, with angles and their rates unless they are not needed and it is cheaper without.
        subroutine at(self, t, motion, with_angles)
            import :: path_t, motion_t, dp
            class(path_t), intent(inout) :: self
            real(dp), intent(in) :: t !! time, s
            type(motion_t), intent(out) :: motion !! the motion at that time
            logical, intent(in), optional :: with_angles !! whether they are needed, which is so without it
        end subroutine at
    end interface

    !> How far neighbours are, relatively, and their number: turned about each body axis, or with another angular velocity.
    real(dp), parameter :: rounding_distance = 8 * epsilon(1.0_dp)
    integer, parameter :: neighbours = 6
    !> A quantity within so many times its noise of a level may be there.
    real(dp), parameter :: margin = 4

    !> An event sooner after the start than this fraction of the time of one radian is the start.
    real(dp), parameter :: start_share = 1.0e-9_dp
    !> The first part of a motion, in which the body turns by two radians at most: number of steps, and the turn in one, rad.
    integer, parameter :: steps = 40
    real(dp), parameter :: turn_of_step = 0.05_dp

contains

    !> The quantities at several instants: what an extension that sets `takes_several` overrides.
    subroutine quantities_of_several(self, motions, values)
        class(event_quantities_t), intent(inout) :: self
        type(motions_t), intent(in) :: motions !! the motion at several instants
        real(dp), intent(out) :: values(:, :) !! a column for each event
        real(dp) :: one(size(values, 2))
        integer :: i
        do i = 1, instants
            call self%quantities(motions%motion(i), one)
            values(i, :) = one
        end do
    end subroutine quantities_of_several

    !> The motion, without angles, at several instants. By default one after the other.
    subroutine at_several(self, t, used, motions)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t(instants) !! times, s
        integer, intent(in) :: used !! how many of them are different: those that count as work
        type(motions_t), intent(out) :: motions !! the motion at these times
        type(motion_t) :: motion
        integer :: i
        do i = 1, instants
            if (i <= used) call self%at(t(i), motion, with_angles=.false.)
            call motions%set_motion(i, motion)
        end do
    end subroutine at_several

    !> The work of effects from the start to a time, by its parts, J; by default there are none.
    function work_until(self, t) result(work)
        class(path_t), intent(inout) :: self
        real(dp), intent(in) :: t !! time, s
        real(dp) :: work(works)
        work = 0
    end function work_until

    !> Whether the allowed number of evaluations is used up.
    logical function is_spent(self)
        class(path_t), intent(in) :: self
        is_spent = self%looks >= self%most_looks
    end function is_spent

    !> Which events have a quantity that is at its level, and constant to rounding.
    subroutine find_constant(search, body, start, is_constant)
        class(event_quantities_t), intent(inout) :: search !! the events and their quantities
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the motion at the start
        logical, intent(out) :: is_constant(:) !! one for each event
        type(dop853_table_t) :: table
        type(motion_t) :: motion
        real(dp), dimension(size(is_constant)) :: values, distance, noise
        real(dp) :: fall, h
        integer :: i

        fall = greatest_fall_rate(body)
        is_constant = search%events%occasion == occasion_none .and. .not. search%events%turn_by_turn
        h = largest_rate(body, start)
        motion = start
        do i = 0, steps
            if (i == 1) then
                if (changes_later(body)) is_constant = .false.
                if (.not. (h > 0 .and. is_finite(h) .and. any(is_constant))) return
                h = turn_of_step / h
                table = dop853_table()
            end if
            if (i > 0) call step(table, body, h, motion)
            call search%quantities(motion, values)
            distance = abs(values - search%events%level)
            where (search%events%every_turn)
                distance = abs(values - search%events%level - 2 * pi * anint((values - search%events%level) / (2 * pi)))
            end where
            is_constant = is_constant .and. is_finite(distance)
            if (any(is_constant)) then
                call find_noise(search, fall, motion, noise)
                is_constant = is_constant .and. distance <= margin * noise
            end if
            if (i > 0 .and. .not. any(is_constant)) exit
        end do
        ! The angles of the next motion are near those of the last one that was seen.
        call search%quantities(start, values)
    end subroutine find_constant

    !> Whether what acts on a body may change at once, after any time: by a row of a table, or where friction lets it go.
    pure logical function changes_later(body)
        type(body_t), intent(in) :: body
        changes_later = allocated(body%effects)
        if (changes_later) changes_later = allocated(body%effects%table) &
            .or. (body%effects%is_dry() .and. .not. body%effects%only(timeless_effects))
    end function changes_later

    !> A rate that exceeds those of the motion, rad/s.
    pure real(dp) function largest_rate(body, motion) result(rate)
        type(body_t), intent(in) :: body
        type(motion_t), intent(in) :: motion
        rate = norm2(motion%omega) + 2 * greatest_fall_rate(body)
        if (.not. allocated(body%effects)) return
        rate = rate + norm2(body%effects%frame_rate) + norm2(body%effects%rotor_momentum / body%inertia)
        if (any(abs(body%effects%vibration_amplitude) > 0)) rate = rate + abs(body%effects%vibration_rate)
    end function largest_rate

    !> One step of the motion, h in s.
    subroutine step(table, body, h, motion)
        type(dop853_table_t), intent(in) :: table
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: h
        type(motion_t), intent(inout) :: motion
        type(motion_t) :: stage
        real(dp) :: k(7, main_stages), y(7), given(3)
        integer :: i

        do i = 1, main_stages
            y = 0
            if (i > 1) y = h * matmul(k(:, :i - 1), table%a(:i - 1, i))
            stage = motion
            stage%t = motion%t + table%c(i) * h
            stage%quaternion = motion%quaternion + y(:4)
            stage%omega = motion%omega + y(5:)
            k(:4, i) = quaternion_product(stage%quaternion, [0.0_dp, stage%omega]) / 2
            stage%quaternion = stage%quaternion / norm2(stage%quaternion)
            k(5:, i) = angular_acceleration(body, stage)
        end do
        y = h * matmul(k, table%b(:main_stages))
        y(:4) = motion%quaternion + y(:4)
        given = motion%given_angle
        motion = motion_from_quaternion(motion%t + h, y(:4) / norm2(y(:4)), motion%omega + y(5:), motion%angle)
        motion%given_angle = given
        motion%omega_rate = angular_acceleration(body, motion)
    end subroutine step

    !> What quantities change by between a motion and its neighbours: their rounding errors.
    subroutine find_noise(search, fall, motion, noise)
        class(event_quantities_t), intent(inout) :: search !! the quantities
        real(dp), intent(in) :: fall !! `greatest_fall_rate` of the body, rad/s
        type(motion_t), intent(in) :: motion !! the motion
        real(dp), intent(out) :: noise(:) !! one for each quantity
        real(dp), dimension(size(noise)) :: values, change
        integer :: i
        call search%quantities(motion, values)
        noise = 0
        do i = 1, neighbours
            call search%quantities(neighbour(fall, motion, i), change)
            change = abs(change - values)
            where (is_finite(change)) noise = max(noise, change)
        end do
    end subroutine find_noise

    !> A motion that is turned about a body axis, or whose angular velocity is changed along one. That across body z has the
    !> rounding of its own terms, however fast the body spins: each of its terms has a factor of it, or is a torque.
    type(motion_t) function neighbour(fall, motion, i) result(near)
        real(dp), intent(in) :: fall
        type(motion_t), intent(in) :: motion
        integer, intent(in) :: i
        real(dp) :: turn(4), omega(3)
        turn = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
        omega = motion%omega
        if (i <= 3) then
            turn(1 + i) = rounding_distance / 2
        else if (i <= 5) then
            omega(i - 3) = omega(i - 3) + rounding_distance * (hypot(omega(1), omega(2)) + driven_rate(fall, motion%omega))
        else
            omega(3) = omega(3) + rounding_distance * (norm2(omega) + driven_rate(fall, motion%omega))
        end if
        near = motion_from_quaternion(motion%t, quaternion_product(motion%quaternion, turn), omega, motion%angle)
        near%omega_rate = motion%omega_rate
        near%given_angle = motion%given_angle
        near%norm_error = motion%norm_error
    end function neighbour

    !> The time after the start within which an event is the start itself, s.
    pure real(dp) function time_of_start(body, start) result(time)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp) :: pace
        pace = norm2(start%omega) + 2 * greatest_fall_rate(body)
        time = 0
        if (pace > 0) time = start_share / pace
    end function time_of_start

    !> A rate whose square the angular acceleration due to the weight does not exceed, rad/s.
    pure real(dp) function greatest_fall_rate(body) result(rate)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        real(dp) :: arm(3)
        associate (r => body%centre_of_mass)
            arm = sqrt([r(2)**2 + r(3)**2, r(3)**2 + r(1)**2, r(1)**2 + r(2)**2])
        end associate
        rate = sqrt(norm2(body%mass * body%gravity * arm / body%inertia))
    end function greatest_fall_rate

    !> What the weight changes of the angular velocity while the body turns by a radian, rad/s.
    pure real(dp) function driven_rate(fall, omega)
        real(dp), intent(in) :: fall, omega(3) !! `greatest_fall_rate` of the body, and its angular velocity, rad/s
        driven_rate = 0
        if (fall > 0) driven_rate = fall * (fall / (norm2(omega) + 2 * fall))
    end function driven_rate

    !> How far a motion that is integrated to a tolerance may be from that without errors of the method, relatively.
    elemental real(dp) function noise_of_tolerance(tolerance, share) result(distance)
        real(dp), intent(in) :: tolerance, share !! relative tolerance, and the share of it that the method takes
        distance = max(rounding_distance, share * tolerance)
    end function noise_of_tolerance

    !> How far a method with steps of a fixed size may lead from the motion without its errors, relatively: in a step as the first
    !> term of its series that the method leaves out, but for the derivative; within a step as the error of the polynomial, of a
    !> degree that suits the order of the method. Most of the latter is common to all vectors of the body: measured.
    pure subroutine find_noise_of_steps(body, start, h, order, of_step, within)
        type(body_t), intent(in) :: body !! mass properties about the fixed point
        type(motion_t), intent(in) :: start !! the motion at the start
        real(dp), intent(in) :: h !! size of the step, s
        integer, intent(in) :: order !! order of the method
        real(dp), intent(out) :: of_step, within !! how far each step leads from the motion; how far off it is within a step
        real(dp), parameter :: share = 5.0e-5_dp
        real(dp) :: turn
        turn = (norm2(start%omega) + greatest_fall_rate(body)) * h
        of_step = max(rounding_distance, min(turn**(order + 1) / gamma(order + 2.0_dp), 1.0_dp))
        within = max(rounding_distance, share * min(turn, 1.0_dp)**min(max(order, 4), 8))
    end subroutine find_noise_of_steps

end module spintop_event
