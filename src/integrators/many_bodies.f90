!> The ends of many motions at once: cases queue for the lanes of Taylor's method.
!>
!>     call integrate_many(controls, bodies, starts, t_end, .false., ends, outcomes)
!>     if (outcomes(i)%status == status_ok) then; ... = ends(i)%quaternion
module spintop_many_bodies
    use spintop_kinds, only: dp, pi
    use spintop_attitude, only: follow_angles, quaternion_from_axes
    use spintop_body, only: body_t
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_integration, only: outcome_t
    use spintop_motion, only: motion_t, motion_from_quaternion
    use spintop_stepper, only: controls_t
    use spintop_taylor_lanes, only: taylor_lanes_t, lanes, parts
    implicit none
    private
    public :: integrate_many

    !> The angles of a motion, followed on its way.
    type :: follower_t
        real(dp) :: t = 0, omega(3) = 0, quaternion(4) = 0, angle(3) = 0
    contains
        procedure :: walk_to
    end type follower_t

    !> Turn between two attitudes over which the sign of the quaternion is certain, rad.
    real(dp), parameter :: largest_turn = pi / 2
    !> A pole passed within this share of a step is passed on either side.
    real(dp), parameter :: shortest_pace = 1.0e-12_dp

contains

    !> Follows each of the bodies from its start over its span and gives the motions at the ends and
    !> how they were reached. `controls` are the tolerances and the most steps of a case. Any body
    !> will do, damped or not, and any attitude. phi and psi are continuous along the motion with
    !> `follows_angles`, with which a run takes about three times as long; else they are the values
    !> next to those of the start. What a case gives does not depend on the others. A case that fails
    !> gives the last motion that it reached.
    subroutine integrate_many(controls, bodies, starts, t_end, follows_angles, ends, outcomes)
        type(controls_t), intent(in) :: controls
        type(body_t), intent(in) :: bodies(:)
        type(motion_t), intent(in) :: starts(size(bodies))
        real(dp), intent(in) :: t_end(size(bodies)) !! s
        logical, intent(in) :: follows_angles
        type(motion_t), intent(out) :: ends(size(bodies))
        type(outcome_t), intent(out) :: outcomes(size(bodies))
        type(taylor_lanes_t) :: run
        type(follower_t) :: follower(lanes)
        integer :: case_in(lanes), next, lane

        call run%set(controls)
        case_in = 0
        next = 1
        do
            do lane = 1, lanes
                do
                    if (case_in(lane) > 0) then
                        if (follows_angles) call follower(lane)%walk_to(run, lane, run%t(lane))
                        if (run%t(lane) < run%t_end(lane)) exit
                        call unload(run, lane, bodies(case_in(lane)), follower(lane), ends(case_in(lane)), &
                                    outcomes(case_in(lane)))
                    end if
                    case_in(lane) = 0
                    if (next > size(bodies)) exit
                    call run%load(lane, bodies(next), starts(next), t_end(next))
                    follower(lane) = follower_t(0.0_dp, starts(next)%omega, starts(next)%quaternion, &
                                                starts(next)%angle)
                    case_in(lane) = next
                    next = next + 1
                end do
            end do
            if (all(case_in == 0)) exit
            call run%advance()
        end do
    end subroutine integrate_many

    !> The motion in a lane, and how it was reached.
    subroutine unload(run, lane, body, follower, motion, outcome)
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        type(follower_t), intent(in) :: follower
        type(motion_t), intent(out) :: motion
        type(outcome_t), intent(out) :: outcome
        real(dp) :: state(parts), rate(6)

        outcome%status = run%status(lane)
        outcome%t = run%t(lane)
        outcome%counts%steps = run%steps(lane)
        outcome%counts%evaluations = run%order * run%steps(lane)
        state = run%state(lane, :)
        motion = motion_from_quaternion(run%t(lane), attitude(state, follower%quaternion), state(1:3), follower%angle)
        rate = euler_poisson_rate(body, [state(4:6), body%inertia * state(1:3)])
        motion%omega_rate = rate(4:6) / body%inertia
    end subroutine unload

    !> The quaternion of a state that has the sign of one nearby.
    pure function attitude(state, near) result(q)
        real(dp), intent(in) :: state(parts), near(4)
        real(dp) :: q(4)
        q = quaternion_from_axes(horizontal=state(7:9), vertical=state(4:6))
        q = sign(1.0_dp, dot_product(q, near)) * q
    end function attitude

    !> Goes on to a time within the last step, in paces short enough to tell the turns of the body,
    !> and on which side the axis passes a pole.
    recursive subroutine walk_to(self, run, lane, t)
        class(follower_t), intent(inout) :: self
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        real(dp), intent(in) :: t
        real(dp) :: state(parts), q(4), angle(3), pace
        logical :: is_shortest, sure

        pace = t - self%t
        if (.not. pace > 0) return
        is_shortest = pace <= max(shortest_pace * (run%t(lane) - run%t_last(lane)), 2 * spacing(t))
        state = run%state(lane, :)
        if (t < run%t(lane)) state = run%at(lane, t)
        q = attitude(state, self%quaternion)
        angle = self%angle
        sure = pace * max(norm2(self%omega), norm2(state(1:3))) <= largest_turn
        if (sure .or. is_shortest) then
            call follow_angles(self%quaternion, self%omega, q, state(1:3), pace, angle, sure)
        end if
        if (sure .or. is_shortest) then
            self%t = t
            self%omega = state(1:3)
            self%quaternion = q
            self%angle = angle
        else
            call self%walk_to(run, lane, self%t + pace / 2)
            call self%walk_to(run, lane, t)
        end if
    end subroutine walk_to

end module spintop_many_bodies
