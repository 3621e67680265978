!> The ends of many motions at once: cases queue for the lanes of Taylor's method.
!>
!>     call integrate_many(controls, bodies, starts, t_end, ends, outcomes)
!>     if (outcomes(i)%status == status_ok) then; ... = ends(i)%quaternion
module spintop_many_bodies
    use spintop_kinds, only: dp
    use spintop_body, only: body_t
    use spintop_euler_poisson, only: euler_poisson_rate
    use spintop_integration, only: outcome_t
    use spintop_motion, only: motion_t
    use spintop_stepper, only: controls_t
    use spintop_taylor_lanes, only: taylor_lanes_t, lanes
    implicit none
    private
    public :: integrate_many

contains

    !> Follows each of the bodies from its start over its span and gives the motions at the ends and
    !> how they were reached, phi and psi with all their turns. `controls` are the tolerances and the
    !> most steps of a case. Any body will do, damped or not, and any attitude. What a case gives does
    !> not depend on the others. A case that fails gives the last motion that it reached.
    subroutine integrate_many(controls, bodies, starts, t_end, ends, outcomes)
        type(controls_t), intent(in) :: controls
        type(body_t), intent(in) :: bodies(:)
        type(motion_t), intent(in) :: starts(size(bodies))
        real(dp), intent(in) :: t_end(size(bodies)) !! s
        type(motion_t), intent(out) :: ends(size(bodies))
        type(outcome_t), intent(out) :: outcomes(size(bodies))
        type(taylor_lanes_t) :: run
        integer :: case_in(lanes), next, lane

        call run%set(controls)
        case_in = 0
        next = 1
        do
            do lane = 1, lanes
                do while (.not. run%t(lane) < run%t_end(lane))
                    if (case_in(lane) > 0) then
                        call unload(run, lane, bodies(case_in(lane)), ends(case_in(lane)), outcomes(case_in(lane)))
                    end if
                    case_in(lane) = 0
                    if (next > size(bodies)) exit
                    call run%load(lane, bodies(next), starts(next), t_end(next))
                    case_in(lane) = next
                    next = next + 1
                end do
            end do
            if (all(case_in == 0)) exit
            call run%advance()
        end do
    end subroutine integrate_many

    !> The motion in a lane, and how it was reached.
    subroutine unload(run, lane, body, motion, outcome)
        type(taylor_lanes_t), intent(in) :: run
        integer, intent(in) :: lane
        type(body_t), intent(in) :: body
        type(motion_t), intent(out) :: motion
        type(outcome_t), intent(out) :: outcome
        real(dp) :: rate(6)

        outcome%status = run%status(lane)
        outcome%t = run%t(lane)
        outcome%counts%steps = run%steps(lane)
        outcome%counts%evaluations = run%order * run%steps(lane)
        motion = run%motion(lane)
        rate = euler_poisson_rate(body, [run%state(lane, 4:6), body%inertia * motion%omega])
        motion%omega_rate = rate(4:6) / body%inertia
    end subroutine unload

end module spintop_many_bodies
